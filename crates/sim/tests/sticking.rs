//! Static friction μₛ and sliding friction μ against closed forms.

use glam::{DQuat, DVec3};
use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::{BodyId, Builder, Geometry, Material, Model, Pose, Shape};

const SOLVERS: [SolverKind; 3] = [
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];
const G: f64 = 9.81;
const H: f64 = 0.002;
const MASS: f64 = 2.0;
const STICKING: f64 = 0.6;
const SLIDING: f64 = 0.4;
/// By what share friction of what slides may be off its limit.
const EXCESS: f64 = 0.002;
/// By what share `featherstone` lets more than static friction stick.
const BREAKS: f64 = 0.02;
/// What slides more slowly sticks yet [m/s]: what static friction could stop within a step.
const SLOW: f64 = STICKING * G * H;

const SURFACE: Material = Material {
    friction: SLIDING,
    static_friction: Some(STICKING),
    torsional_friction: 0.0,
    rolling_friction: 0.0,
    restitution: 0.0,
    softness: model::Softness::Time {
        constant: 0.002,
        ratio: 1.0,
        impedance: 0.0,
        mass: None,
    },
    margin: 0.0,
    combine: model::Combine::Average,
};

/// What lies below the block.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Below {
    /// A plane that leans by an angle [rad].
    Plane(f64),
    /// A slab of 100 kg, free, on a smooth plane: so that both move.
    Slab,
}

/// A flat block on what lies below.
fn scene(below: Below, material: Material) -> Model {
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    let angle = match below {
        Below::Plane(angle) => angle,
        Below::Slab => 0.0,
    };
    let turn = Pose::new(DVec3::ZERO, DQuat::from_rotation_z(-angle));
    let mut world = Builder::new("sticking");
    let floor = if below == Below::Slab {
        Material {
            friction: 0.0,
            static_friction: None,
            combine: model::Combine::Minimum,
            ..material
        }
    } else {
        material
    };
    let ground = Shape::new(plane).with_material(floor).at(turn);
    world.object("ground").scenery(ground);
    let things = world.object("things");
    let half = DVec3::new(0.2, 0.05, 0.2);
    let block = Shape::new(Geometry::Box { half }).with_material(material);
    let at = Pose::at(DVec3::Y * if below == Below::Slab { 0.15 } else { 0.05 });
    let block = things.body("block").at(turn * at).shape(block).mass(MASS);
    let block = block.handle();
    if below == Below::Slab {
        let half = DVec3::new(2.0, 0.05, 2.0);
        let slab = Shape::new(Geometry::Box { half }).with_material(material);
        let slab = things
            .body("slab")
            .at(Pose::at(DVec3::Y * 0.05))
            .shape(slab)
            .mass(100.0)
            .handle();
        things.free("drift", slab);
    }
    things.free("float", block);
    world.build().unwrap()
}

fn simulation(model: Model, solver: SolverKind) -> Simulation<f64> {
    let mut settings = SimulationSettings {
        solver,
        threads: 1,
        ..SimulationSettings::new(1, H)
    };
    settings.step.sleep_speed = 0.0;
    Simulation::new(model, settings).unwrap()
}

fn block(sim: &mut Simulation<f64>) -> (DVec3, DVec3) {
    let outputs = sim.outputs();
    let body = BodyId(0);
    (
        outputs.body_position(0, body),
        outputs.body_velocity(0, body),
    )
}

/// Up to tan θ = μₛ it stays; beyond, it slides with a = g (sin θ − μ cos θ) as soon as it has come, at
/// g (sin θ − μₛ cos θ), to the speed at which it sticks no more: in a time of up to t, on a way of up to v t / 2.
#[test]
fn a_block_on_an_incline_stays_up_to_static_friction() {
    for solver in SOLVERS {
        for (slope, slides) in [(0.5, false), (0.58, false), (0.7, true), (0.9, true)] {
            let angle = f64::atan(slope);
            let mut sim = simulation(scene(Below::Plane(angle), SURFACE), solver);
            let start = block(&mut sim).0;
            sim.step(500);
            let way = (block(&mut sim).0 - start).length();
            let pull = |friction: f64| G * (angle.sin() - friction * angle.cos());
            let a = pull(SLIDING);
            let latest = 1.0 - SLOW / pull(STICKING).max(1e-9);
            // A step more or less at the end of it is v H, and friction keeps to its limit.
            let near = 2.0 * a * H + EXCESS * 0.5 * G * SLIDING;
            let range = 0.5 * a * latest * latest - near..0.5 * a + near;
            let what = format!("{solver:?} at {slope}: {way} m in {range:?}");
            if slides {
                assert!(range.contains(&way), "{what}");
            } else {
                assert!(way < 1e-3, "{what}");
            }
        }
    }
}

/// A plane that is tilted slowly, seen from it: the force along it grows until the block breaks away at μₛ m g, and then
/// slides against μ m g. The same on a slab that could go along.
#[test]
fn a_push_breaks_a_block_away_at_static_friction() {
    for solver in SOLVERS {
        for below in [Below::Plane(0.0), Below::Slab] {
            let mut sim = simulation(scene(below, SURFACE), solver);
            let dof = sim
                .model()
                .dof_range(sim.model().carrier(BodyId(0)).unwrap())
                .start;
            let (weight, rate) = (MASS * G, 0.1 * MASS * G);
            sim.step(100);
            let slab = |sim: &mut Simulation<f64>| match below {
                Below::Plane(_) => DVec3::ZERO,
                Below::Slab => sim.outputs().body_velocity(0, BodyId(1)),
            };
            // What both do together needs less than all of the push: m / (m + M).
            let share = if below == Below::Slab {
                MASS / (MASS + 100.0)
            } else {
                0.0
            };
            let mut broke = None;
            for step in 0..4000 {
                let force = rate * H * f64::from(step);
                sim.controls().set_dof_force(0, dof, force).unwrap();
                sim.step(1);
                let speed = (block(&mut sim).1 - slab(&mut sim)).x;
                if speed > 0.05 {
                    broke = Some((force, speed, step));
                    break;
                }
            }
            let (force, ..) = broke.expect("it breaks away in the end");
            let needed = STICKING * weight / (1.0 - share);
            let what = format!("{solver:?} {below:?}: {force} N for {needed} N");
            // While the push grows by r t, it comes to the speed at which it slides in t²/2 = m v / r, and then to
            // 0.05 m/s in 0.05 / (g (μₛ − μ)).
            let late = (2.0 * MASS * SLOW * rate).sqrt() + rate * 0.05 / (G * (STICKING - SLIDING));
            assert!(force > needed * (1.0 - 0.01), "{what}");
            assert!(force < needed * (1.0 + BREAKS) + late, "{what}");

            // A push between the two keeps it going, and would not have set it off.
            let push = 0.5 * (STICKING + SLIDING) * weight;
            sim.controls().set_dof_force(0, dof, push).unwrap();
            let before = block(&mut sim).1.x;
            sim.step(250);
            let gained = block(&mut sim).1.x - before;
            let ideal = 0.5 * (push / MASS - SLIDING * G);
            let what = format!("{solver:?} {below:?}: {gained} m/s for {ideal} m/s");
            assert!(
                (gained - ideal).abs() < 0.05 * ideal + 2.0 * EXCESS * SLIDING * G * 0.5,
                "{what}"
            );
        }
    }
}

/// What slides stops after v²/2μg, and then sticks: it bears a push that would have kept it going.
#[test]
fn what_has_stopped_sticks() {
    for solver in SOLVERS {
        let mut sim = simulation(scene(Below::Plane(0.0), SURFACE), solver);
        let dof = sim
            .model()
            .dof_range(sim.model().carrier(BodyId(0)).unwrap())
            .start;
        let position = sim.outputs().joint_position(0);
        let speed = 1.5;
        let velocity = [speed, 0.0, 0.0, 0.0, 0.0, 0.0];
        sim.set_joint_state(0, &position, &velocity).unwrap();
        sim.step(300);
        let way = block(&mut sim).0.x;
        let ideal = speed * speed / (2.0 * SLIDING * G);
        assert!(
            (way - ideal).abs() < speed * H + 0.01 * ideal,
            "{solver:?}: {way} for {ideal}"
        );
        let push = 0.5 * (STICKING + SLIDING) * MASS * G;
        sim.controls().set_dof_force(0, dof, push).unwrap();
        sim.step(250);
        let crept = block(&mut sim).0.x - way;
        assert!(crept.abs() < 1e-3, "{solver:?}: {crept} m");
    }
}

/// Without static friction of its own a surface sticks as it slides: as with as much of it, to the bit.
#[test]
fn as_much_static_friction_is_none() {
    for solver in SOLVERS {
        let runs = [None, Some(SLIDING)].map(|static_friction| {
            let material = Material {
                static_friction,
                ..SURFACE
            };
            let mut sim = simulation(scene(Below::Plane(0.35), material), solver);
            sim.step(200);
            block(&mut sim)
        });
        assert_eq!(runs[0], runs[1], "{solver:?}");
    }
}
