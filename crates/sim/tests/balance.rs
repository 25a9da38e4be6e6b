//! What contacts tell of their forces f and torques t at x is what they do, over every step and over every blow:
//!
//! ```text
//! Δp = h (Σ f + m g)     ΔL = h Σ (t + x × f)  about the vertical through the centre of mass
//! ```

use glam::{DQuat, DVec3};
use kinetarium_sim::{
    Contact, Event, EventKind, Quantity, Simulation, SimulationSettings, SolverKind, Watch,
};
use model::{BodyId, Builder, Geometry, JointId, Material, Model, Pose, Shape, ShapeId};

const H: f64 = 0.004;
const G: f64 = 9.81;
const MASS: f64 = 2.0;
/// Of sums of 400 contacts' forces [N·s].
const ROUNDING: f64 = 1e-9;
const SOLVERS: [SolverKind; 3] = [
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];

/// A surface that bounces.
fn bouncing(restitution: f64) -> Material {
    Material {
        restitution,
        ..Material::default()
    }
}

/// A body and the ground.
fn scene(geometry: Geometry, material: Material) -> Model {
    let mut world = Builder::new("scene");
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    let ground = Shape::new(plane).with_material(material);
    world.object("ground").scenery(ground);
    let things = world.object("things");
    let shape = Shape::new(geometry).with_material(material);
    let body = things.body("body").shape(shape).mass(MASS).handle();
    things.free("float", body);
    world.build().unwrap()
}

/// The body thrown and spun from a height.
fn thrown(model: Model, solver: SolverKind, height: f64, velocity: [f64; 6]) -> Simulation<f64> {
    let settings = SimulationSettings {
        solver,
        ..SimulationSettings::new(1, H)
    };
    let mut simulation = Simulation::new(model, settings).unwrap();
    let place = [0.0, height, 0.0, 0.0, 0.0, 0.0, 1.0];
    simulation.set_joint_state(0, &place, &velocity).unwrap();
    simulation
}

/// Boxes, balls and capsules that fall, bounce, slide, tumble and come to rest.
#[test]
fn momentum_changes_by_what_is_told() {
    let forms = [
        Geometry::Sphere { radius: 0.1 },
        Geometry::Box {
            half: DVec3::new(0.1, 0.05, 0.2),
        },
        Geometry::Capsule {
            radius: 0.05,
            half_height: 0.1,
        },
    ];
    for solver in SOLVERS {
        for form in &forms {
            for restitution in [0.0, 0.5, 1.0] {
                let velocity = [1.0, 0.0, -0.5, 3.0, 2.0, -4.0];
                let mut sim = thrown(
                    scene(form.clone(), bouncing(restitution)),
                    solver,
                    0.4,
                    velocity,
                );
                let mut before = sim.outputs().momentum(0);
                let mut wrench = [0.0; 6];
                let (mut worst, mut pressed) = (0.0_f64, 0);
                for _ in 0..400 {
                    sim.step(1);
                    let now = sim.outputs().momentum(0);
                    sim.read(Quantity::ContactWrench, &mut wrench).unwrap();
                    let force = DVec3::from_slice(&wrench);
                    let told = H * (force - MASS * G * DVec3::Y);
                    worst = worst.max((now - before - told).length());
                    pressed += usize::from(force != DVec3::ZERO);
                    before = now;
                }
                let what = format!("{solver:?} {form:?} e={restitution}: {worst}");
                assert!(pressed > 1, "{what}");
                assert!(worst < ROUNDING, "{what}");
            }
        }
    }
}

/// A ball that falls from different heights meets the ground at all moments of a step: the impulses of its blow add up
/// to m v (1 + e), and what its weight gives meanwhile.
#[test]
fn a_blow_has_the_impulse_of_its_bounce() {
    for solver in SOLVERS {
        for restitution in [0.0, 0.5, 1.0] {
            for phase in 0..8 {
                let fall = 0.2 + 1e-3 * f64::from(phase);
                let radius = 0.1;
                let form = Geometry::Sphere { radius };
                let model = scene(form, bouncing(restitution));
                let mut sim = thrown(model, solver, radius + fall, [0.0; 6]);
                sim.watch(Watch::ALL);
                let speed = (2.0 * G * fall).sqrt();
                // Beyond the first bounce of e = 0.5, v/g after the first blow, nothing counts.
                let steps = ((speed / G + 0.5 * speed / G) / H) as usize;
                sim.step(steps);
                let impulse = |event: &Event| match event.kind {
                    EventKind::ContactBegins { impulse, .. }
                    | EventKind::ContactPersists { impulse, .. } => impulse.y,
                    _ => 0.0,
                };
                let told = sim.drain_events();
                let given: f64 = told.iter().map(impulse).sum();
                let began = told
                    .iter()
                    .find(|e| matches!(e.kind, EventKind::ContactBegins { .. }));
                let began = began.expect("it met the ground").time;
                let at_rest = if restitution == 0.0 {
                    MASS * G * (steps as f64 * H - began)
                } else {
                    0.0
                };
                let blow = MASS * speed * (1.0 + restitution);
                let step = MASS * G * H;
                assert!(
                    (given - at_rest - blow).abs() < 0.02 * blow + 2.0 * step,
                    "{solver:?} e={restitution} phase {phase}: {} of {blow}",
                    given - at_rest
                );
            }
        }
    }
}

/// A ball that spins and rolls, and a box that turns on its face, are slowed by torques of their surfaces.
#[test]
fn angular_momentum_changes_by_what_is_told() {
    let rough = Material {
        torsional_friction: 0.01,
        rolling_friction: 0.02,
        ..Material::default()
    };
    let ball = Geometry::Sphere { radius: 0.1 };
    let flat = Geometry::Box {
        half: DVec3::new(0.1, 0.05, 0.2),
    };
    let cases = [
        (SolverKind::Featherstone, &ball, 0.1, rough),
        (SolverKind::Xpbd, &ball, 0.1, rough),
        (SolverKind::Impulse, &ball, 0.1, rough),
        (SolverKind::Featherstone, &flat, 0.05, rough),
        (SolverKind::Xpbd, &flat, 0.05, rough),
        (SolverKind::Impulse, &flat, 0.05, rough),
    ];
    for (solver, form, height, material) in cases {
        let model = scene(form.clone(), material);
        let mut sim = thrown(model, solver, height, [0.0, 0.0, 0.0, 0.0, 8.0, 0.0]);
        let mut wrench = [0.0; 6];
        let mut before = sim.outputs().angular_momentum(0).y;
        let first = before;
        for step in 0..200 {
            sim.step(1);
            let now = sim.outputs().angular_momentum(0).y;
            sim.read(Quantity::ContactWrench, &mut wrench).unwrap();
            let told = H * wrench[4];
            let what = format!(
                "{solver:?} {form:?}, step {step}: {} of {told}",
                now - before
            );
            assert!((now - before - told).abs() < 1e-4 * first, "{what}");
            before = now;
        }
        assert!(
            before.abs() < 0.5 * first,
            "{solver:?} {form:?}: {before} of {first}"
        );
        let (force, torque) = sim.outputs().pair_wrench(0, ShapeId(0), ShapeId(1));
        let summed = [force.to_array(), torque.to_array()].concat();
        let against = sim.outputs().pair_wrench(0, ShapeId(1), ShapeId(0));
        assert_eq!(against, (-force, -torque));
        let close = |(a, b): (&f64, &f64)| (a - b).abs() < ROUNDING;
        assert!(
            summed.iter().zip(&wrench).all(close),
            "{summed:?} {wrench:?}"
        );
    }
}

/// How much the momentum of each body is off what was told in a step [N·s], by contacts and by joints.
struct Ledger {
    masses: Vec<f64>,
    shapes: Vec<Option<usize>>,
    joints: Vec<(JointId, Option<usize>, usize)>,
    before: Vec<DVec3>,
}

impl Ledger {
    fn new(sim: &mut Simulation<f64>) -> Self {
        let model = sim.model().clone();
        let joints = model.joints.iter().enumerate();
        let joints =
            joints.map(|(j, joint)| (JointId(j), joint.parent.map(|p| p.0), joint.child.0));
        let mut ledger = Self {
            masses: model.bodies.iter().map(|body| body.mass).collect(),
            shapes: model.shapes.iter().map(|s| s.body.map(|b| b.0)).collect(),
            joints: joints.collect(),
            before: Vec::new(),
        };
        ledger.before = ledger.momenta(sim);
        ledger
    }
    fn momenta(&self, sim: &mut Simulation<f64>) -> Vec<DVec3> {
        let outputs = sim.outputs();
        let bodies = self.masses.iter().enumerate();
        let momenta = bodies.map(|(b, m)| *m * outputs.body_velocity(0, BodyId(b)));
        momenta.collect()
    }
    fn miss(&mut self, sim: &mut Simulation<f64>) -> f64 {
        let mut forces: Vec<_> = self.masses.iter().map(|m| DVec3::NEG_Y * *m * G).collect();
        let outputs = sim.outputs();
        for contact in outputs.contacts(0) {
            for (shape, sign) in contact.shapes.into_iter().zip([-1.0, 1.0]) {
                if let Some(body) = self.shapes[shape.0] {
                    forces[body] += sign * contact.force;
                }
            }
        }
        for &(joint, parent, child) in &self.joints {
            let (force, _) = outputs.reaction(0, joint);
            forces[child] += force;
            if let Some(parent) = parent {
                forces[parent] -= force;
            }
        }
        let now = self.momenta(sim);
        let changes = now.iter().zip(&self.before).zip(&forces);
        let miss = changes.map(|((now, before), force)| (now - before - H * force).length());
        let worst = miss.fold(0.0, f64::max);
        self.before = now;
        worst
    }
}

/// A box that spins on a corner at 300 rad/s, alone and with another on a ball joint, for which steps are cut into four
/// and eight parts: what a part gives is told, also where the contact is gone in the next, or has other points.
#[test]
fn steps_that_are_cut_tell_of_all_their_parts() {
    for (jointed, restitution) in [(false, 0.0), (false, 0.7), (true, 0.0), (true, 0.7)] {
        let surface = bouncing(restitution);
        let mut world = Builder::new("tops");
        let plane = Geometry::Plane {
            half_x: 0.0,
            half_z: 0.0,
        };
        let ground = Shape::new(plane).with_material(surface);
        world.object("ground").scenery(ground);
        let half = DVec3::splat(0.1);
        let form = Shape::new(Geometry::Box { half }).with_material(surface);
        let things = world.object("things");
        let top = things.body("top").shape(form.clone()).mass(MASS).handle();
        if jointed {
            let other = things.body("other").at(Pose::at(DVec3::X * 0.3));
            let other = other.shape(form).mass(MASS).handle();
            let socket = Pose::at(DVec3::X * 0.15);
            things.ball("socket", other).parent(top).at(socket);
        }
        things.free("float", top);
        let model = world.build().unwrap();
        let (coordinates, dofs) = (model.coordinates(), model.degrees_of_freedom());
        let free = model.joints.iter().position(|j| j.child.0 == 0).unwrap();
        let (place, spin) = (
            model.coordinate_range(JointId(free)).start,
            model.dof_range(JointId(free)).start,
        );
        let mut position = model.initial_position();
        let mut velocity = vec![0.0; dofs];
        assert_eq!(position.len(), coordinates);
        position[place + 1] = 0.12;
        velocity[spin + 3..spin + 6].copy_from_slice(&[15.0, 300.0, -10.0]);
        let settings = SimulationSettings {
            solver: SolverKind::Impulse,
            ..SimulationSettings::new(1, H)
        };
        let mut sim = Simulation::new(model, settings).unwrap();
        sim.set_joint_state(0, &position, &velocity).unwrap();
        let mut ledger = Ledger::new(&mut sim);
        let (mut worst, mut pressed) = (0.0_f64, 0);
        for _ in 0..300 {
            sim.step(1);
            worst = worst.max(ledger.miss(&mut sim));
            pressed += usize::from(sim.outputs().contacts(0).any(|c| c.force != DVec3::ZERO));
        }
        let what = format!("jointed: {jointed}, e = {restitution}: {worst}, {pressed}");
        assert_eq!(sim.diverged(), [], "{what}");
        assert!(pressed > 10 && worst < 1e3 * ROUNDING, "{what}");
    }
}

/// A box falls asleep in some part of a step that a top beside it cuts, and is woken in some part by a ball. It presses
/// with its weight all the time.
#[test]
fn sleepers_beside_a_top_tell_their_weight() {
    for phase in 0..6 {
        let mut world = Builder::new("sleeper");
        let plane = Geometry::Plane {
            half_x: 0.0,
            half_z: 0.0,
        };
        world.object("ground").scenery(Shape::new(plane));
        let cube = Shape::new(Geometry::Box {
            half: DVec3::splat(0.1),
        });
        let ball = Shape::new(Geometry::Sphere { radius: 0.1 });
        let things = world.object("things");
        let shapes = [
            ("box", cube.clone(), DVec3::Y * 0.1),
            ("top", cube, DVec3::new(3.0, 1000.0, 0.0)),
            ("ball", ball, DVec3::Y * (3.3 + 0.01 * f64::from(phase))),
        ];
        for (name, shape, at) in shapes {
            let body = things.body(name).at(Pose::at(at));
            body.shape(shape).mass(MASS);
        }
        let mut settings = SimulationSettings {
            solver: SolverKind::Impulse,
            ..SimulationSettings::new(1, H)
        };
        settings.step.sleep_speed = 0.01;
        let model = world.build().unwrap();
        let position = model.initial_position();
        let mut velocity = vec![0.0; 18];
        velocity[6 + 3] = 300.0;
        let mut sim = Simulation::new(model, settings).unwrap();
        sim.set_joint_state(0, &position, &velocity).unwrap();
        let mut ledger = Ledger::new(&mut sim);
        let mut slept = 0;
        for step in 0..220 {
            sim.step(1);
            let miss = ledger.miss(&mut sim);
            let asleep = sim.outputs().asleep(0, BodyId(0));
            slept += usize::from(asleep);
            // What sleeps is held by what its contacts gave last.
            let what = format!("phase {phase}, step {step}, asleep: {asleep}: {miss}");
            assert!(miss < 1e-3 * MASS * G * H, "{what}");
        }
        assert!(slept > 20 && !sim.outputs().asleep(0, BodyId(0)), "{slept}");
    }
}

/// A smooth bullet that is stopped at a wall before its centre of mass does not turn, and what is told turns nothing: the
/// torque and that of the force about the centre add up to zero.
#[test]
fn what_stops_a_bullet_turns_nothing() {
    let half = DVec3::new(0.0005, 1.0, 1.0);
    let smooth = Material {
        friction: 0.0,
        ..Material::default()
    };
    for solver in SOLVERS {
        let mut world = Builder::new("range");
        world.gravity(DVec3::ZERO);
        let wall = Shape::new(Geometry::Box { half }).with_material(smooth);
        world.object("wall").scenery(wall);
        let bullet = Shape::new(Geometry::Box {
            half: DVec3::new(0.01, 0.02, 0.01),
        });
        let things = world.object("things");
        let body = things.body("bullet").shape(bullet.with_material(smooth));
        let body = body.handle();
        things.free("float", body);
        let settings = SimulationSettings {
            solver,
            ..SimulationSettings::new(1, H)
        };
        let model = world.build().unwrap();
        let mut sim = Simulation::<f64>::new(model, settings).unwrap();
        let turn = DQuat::from_rotation_z(0.5) * DQuat::from_rotation_y(0.3);
        let [i, j, k, w] = turn.to_array();
        let velocity = [100.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        sim.set_joint_state(0, &[-0.6, 0.0, 0.0, i, j, k, w], &velocity)
            .unwrap();
        let mut stopped = false;
        for _ in 0..3 {
            sim.step(1);
            let outputs = sim.outputs();
            let center = outputs.body_position(0, BodyId(0));
            let forces = outputs.contacts(0).map(|c| c.force.length());
            let given = forces.sum::<f64>();
            // Across the wall the centre does not move.
            let turned = |c: Contact| (c.position - center).cross(c.force) + c.torque;
            let turning = outputs.contacts(0).map(turned).sum::<DVec3>();
            let what = format!("{solver:?}: {turning} by {given} N");
            assert!(turning.length() < 1e-9 * given + ROUNDING, "{what}");
            if given > 0.0 {
                stopped = true;
                break;
            }
        }
        assert!(stopped, "{solver:?}");
    }
}
