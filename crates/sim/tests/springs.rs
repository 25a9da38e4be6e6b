//! A surface in N/m is a spring, to every solver: it bears m g at a depth of m g / k, swings with ω = √(k/m), and gives
//! back what it took.
//!
//! All three methods are implicit in the spring, of the first order in s = h ω: an amplitude decays by s²/2 in a step,
//! by π s/2 in half a swing.

use glam::DVec3;
use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::{BodyId, Builder, Combine, Geometry, Material, Model, Shape, Softness};
use std::f64::consts::PI;

const H: f64 = 5e-4;
const G: f64 = 9.81;
const RADIUS: f64 = 0.5;
const SOLVERS: [SolverKind; 3] = [
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];

/// A ball of a mass m [kg], on a plane of k [N/m] and d [N·s/m].
#[derive(Clone, Copy, Debug)]
struct Ball {
    mass: f64,
    stiffness: f64,
    damping: f64,
    gravity: f64,
}

impl Ball {
    fn frequency(self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }
    fn scene(self) -> Model {
        let material = Material {
            softness: Softness::Spring {
                stiffness: self.stiffness,
                damping: self.damping,
            },
            combine: Combine::Average,
            ..Material::default()
        };
        let mut world = Builder::new("spring");
        world.gravity(DVec3::NEG_Y * self.gravity);
        let plane = Geometry::Plane {
            half_x: 0.0,
            half_z: 0.0,
        };
        let ground = Shape::new(plane).with_material(material);
        world.object("ground").scenery(ground);
        let ball = Shape::new(Geometry::Sphere { radius: RADIUS }).with_material(material);
        let balls = world.object("balls");
        balls.body("ball").shape(ball).mass(self.mass);
        world.build().unwrap()
    }
    /// Sunk into the plane by a depth [m], with a speed [m/s] upwards.
    fn begin(self, solver: SolverKind, depth: f64, speed: f64) -> Simulation<f64> {
        let mut settings = SimulationSettings {
            solver,
            ..SimulationSettings::new(1, H)
        };
        settings.step.sleep_speed = 0.0;
        let mut simulation = Simulation::new(self.scene(), settings).unwrap();
        let place = [0.0, RADIUS - depth, 0.0, 0.0, 0.0, 0.0, 1.0];
        let velocity = [0.0, speed, 0.0, 0.0, 0.0, 0.0];
        simulation.set_joint_state(0, &place, &velocity).unwrap();
        simulation
    }
}

/// Depth [m], and speed upwards [m/s].
fn state(simulation: &mut Simulation<f64>) -> (f64, f64) {
    let outputs = simulation.outputs();
    let body = BodyId(0);
    let depth = RADIUS - outputs.body_position(0, body).y;
    (depth, outputs.body_velocity(0, body).y)
}

/// Let go where it touches, it sinks by 2 m g / k in half a swing, less what the method takes.
#[test]
fn it_swings() {
    let ball = Ball {
        mass: 1.0,
        stiffness: 2000.0,
        damping: 0.0,
        gravity: G,
    };
    let half = PI / ball.frequency();
    let s = H * ball.frequency();
    for solver in SOLVERS {
        let mut simulation = ball.begin(solver, 0.0, 0.0);
        let (mut deepest, mut at) = (0.0_f64, 0);
        for step in 1..=(1.5 * half / H) as usize {
            simulation.step(1);
            let (depth, _) = state(&mut simulation);
            if depth > deepest {
                (deepest, at) = (depth, step);
            }
        }
        let share = deepest * ball.stiffness / (2.0 * ball.mass * G);
        assert!(
            share < 1.0 + s && share > 1.0 - PI / 2.0 * s,
            "{solver:?}: {share}"
        );
        let time = at as f64 * H;
        assert!(
            (time - half).abs() < 3.0 * H + s * half,
            "{solver:?}: {time} s"
        );
    }
}

/// Struck at 5 m/s, it sinks by v / ω and gives the speed back, less what the method takes.
#[test]
fn it_gives_back_what_it_took() {
    let speed = 5.0;
    for (mass, stiffness) in [(1.0, 2000.0), (1.0, 2e4), (10.0, 1000.0)] {
        let ball = Ball {
            mass,
            stiffness,
            damping: 0.0,
            gravity: 0.0,
        };
        let s = H * ball.frequency();
        for solver in SOLVERS {
            let mut simulation = ball.begin(solver, -1e-3, -speed);
            let mut deepest = 0.0_f64;
            for _ in 0..(1.5 * PI / ball.frequency() / H) as usize {
                simulation.step(1);
                deepest = deepest.max(state(&mut simulation).0);
            }
            let depth = deepest * ball.frequency() / speed;
            let back = state(&mut simulation).1 / speed;
            let what = format!("{solver:?} {ball:?}: {depth} deep, {back} back");
            assert!(depth < 1.0 + s && depth > 1.0 - PI / 2.0 * s, "{what}");
            assert!(back < 1.0 + s && back > 1.0 - PI * s, "{what}");
        }
    }
}

/// With a damper it comes to rest at m g / k.
#[test]
fn it_bears_a_weight() {
    let ball = Ball {
        mass: 1.0,
        stiffness: 2000.0,
        damping: 20.0,
        gravity: G,
    };
    for solver in SOLVERS {
        let mut simulation = ball.begin(solver, 0.0, 0.0);
        simulation.step((3.0 / H) as usize);
        let (depth, speed) = state(&mut simulation);
        let share = depth * ball.stiffness / (ball.mass * G);
        // e^(−d t / 2 m) is 1e-13 by then.
        let what = format!("{solver:?}: {share}, {speed} m/s");
        assert!((share - 1.0).abs() < 1e-9 && speed.abs() < 1e-9, "{what}");
    }
}

/// What begins where it rests, ten centimetres deep, stays there. Solvers that let forces grow by half in a step, where
/// they push out faster than 3 m/s, miss less than 3 m g h of the first ones: a swing of 3 g h / ω.
#[test]
fn what_rests_deep_stays() {
    let ball = Ball {
        mass: 10.0,
        stiffness: 1000.0,
        damping: 10.0,
        gravity: G,
    };
    let depth = ball.mass * G / ball.stiffness;
    for solver in SOLVERS {
        let mut simulation = ball.begin(solver, depth, 0.0);
        for step in 0..4000 {
            simulation.step(1);
            let off = state(&mut simulation).0 - depth;
            let most = 3.0 * G * H / ball.frequency();
            assert!(off.abs() < most, "{solver:?} step {step}: {off}");
        }
    }
}
