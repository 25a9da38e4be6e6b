//! What the tests of many worlds share: models, methods, worlds that all differ, and their bits.

// Every test program uses its part.
#![allow(dead_code)]

use glam::{DQuat, DVec3};
use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::examples::n_pendula;
use model::{
    Axis, BodyHandle, Builder, Drive, Geometry, Hull, JointKind, Limit, Model, Object, Pose, Shape,
};
use numbers::Float;
use rigid::Integrator;

/// Solver and integrator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    Featherstone(Integrator),
    Xpbd,
    /// Featherstone with contacts.
    Touching,
    TouchingXpbd,
    /// Bodies that touch.
    Impulse,
    /// Jointed bodies that do not.
    Impulses,
}

/// All for bodies that touch nothing.
pub const METHODS: [Method; 5] = [
    Method::Featherstone(Integrator::SemiImplicitEuler),
    Method::Featherstone(Integrator::ExplicitEuler),
    Method::Featherstone(Integrator::Verlet),
    Method::Featherstone(Integrator::RungeKutta4),
    Method::Xpbd,
];

/// All for bodies that touch.
pub const TOUCHING: [Method; 3] = [Method::Touching, Method::TouchingXpbd, Method::Impulse];

/// One of each solver.
pub const BOTH: [Method; 2] = [METHODS[0], Method::Xpbd];

/// Time step [s].
pub const TIME_STEP: f64 = 0.002;

impl Method {
    /// Settings of so many worlds in one thread.
    pub fn settings(self, worlds: usize) -> SimulationSettings {
        let mut settings = SimulationSettings::new(worlds, TIME_STEP);
        settings.threads = 1;
        match self {
            Self::Featherstone(integrator) => {
                settings.solver = SolverKind::Featherstone;
                settings.step.integrator = integrator;
                settings.contacts = false;
            }
            Self::Touching => settings.solver = SolverKind::Featherstone,
            Self::TouchingXpbd => settings.solver = SolverKind::Xpbd,
            Self::Impulse => settings.solver = SolverKind::Impulse,
            Self::Impulses => {
                settings.solver = SolverKind::Impulse;
                settings.contacts = false;
            }
            Self::Xpbd => {
                settings.solver = SolverKind::Xpbd;
                settings.contacts = false;
                settings.step.substeps = 2;
                settings.step.iterations = 2;
            }
        }
        settings
    }

    /// A heap that the method can simulate.
    pub fn heap(self) -> Model {
        match self {
            Self::Impulse => loose_heap(),
            _ => heap(),
        }
    }
}

/// A chain of five links.
pub fn chain() -> Model {
    n_pendula(5).unwrap()
}

fn rod(object: &mut Object, name: &str, mass: f64) -> BodyHandle {
    let shape = Geometry::Capsule {
        radius: 0.03,
        half_height: 0.2,
    };
    object.body(name).shape(shape).mass(mass).handle()
}

/// A tree with joints of many kinds, and everything that acts along a degree of freedom.
pub fn mixed() -> Model {
    let (top, bottom) = (Pose::at(DVec3::Y * 0.2), Pose::at(DVec3::Y * -0.2));
    // Exact numbers, since sines differ between mathematical libraries.
    let tilted = Pose::new(
        DVec3::new(0.1, -0.2, 0.05),
        DQuat::from_xyzw(0.28, 0.0, 0.0, 0.96),
    );
    let limit = |lower, upper| Limit {
        lower,
        upper,
        stiffness: 60.0,
        damping: 1.0,
        inertia: 0.1,
    };
    let mut world = Builder::new("mixed");
    let robot = world.object("robot");

    let trunk = rod(robot, "trunk", 2.0);
    robot
        .free("float", trunk)
        .initial(&[0.1, 1.0, -0.2, 0.0, 0.6, 0.0, 0.8]);

    let arm = rod(robot, "arm", 1.0);
    let shoulder = robot
        .revolute("shoulder", arm, DVec3::Z)
        .parent(trunk)
        .frames(tilted, top);
    let drive = Drive {
        stiffness: 30.0,
        damping: 2.0,
        target_position: 0.4,
        effort_limit: 8.0,
        control_time: 0.02,
        ..Drive::default()
    };
    shoulder
        .limit(limit(-0.3, 0.3))
        .drive(drive)
        .armature(0.02)
        .friction_loss(0.1);
    let shoulder = shoulder.handle();

    let hand = robot
        .body("hand")
        .shape(Geometry::Sphere { radius: 0.1 })
        .mass(0.5)
        .handle();
    let drive = Drive {
        stiffness: 4.0,
        damping: 0.2,
        control_time: 0.01,
        ..Drive::default()
    };
    robot
        .ball("wrist", hand)
        .parent(arm)
        .frames(bottom, top)
        .damping(0.05)
        .drive(drive);

    let tail = rod(robot, "tail", 0.7);
    let slide = robot
        .prismatic("slide", tail, DVec3::X)
        .parent(trunk)
        .frames(bottom, tilted);
    let slide = slide.limit(limit(-0.05, 0.1)).spring(200.0, 0.03).handle();

    let fin = rod(robot, "fin", 0.4);
    let axes = [
        Axis::linear(DVec3::X),
        Axis::angular(DVec3::Y),
        Axis::angular(DVec3::Z),
    ];
    robot
        .d6("twist", fin, &axes)
        .parent(tail)
        .frames(bottom, top)
        .damping(0.3)
        .armature(0.01);

    let wheel = rod(robot, "wheel", 0.3);
    let axle = robot
        .revolute("axle", wheel, DVec3::X)
        .parent(trunk)
        .frames(top, bottom);
    let axle = axle.armature(0.01).friction_loss(0.02).handle();

    robot
        .motor("shoulder_motor", shoulder)
        .gear(3.0)
        .control_range(-0.5, 0.5);
    robot
        .position_servo("slide_servo", slide, 80.0, 2.0)
        .force_range(-5.0, 5.0);
    robot.velocity_servo("axle_servo", axle, 0.6);
    world.build().unwrap()
}

/// Solids and a jointed pair of rods, about to fall on each other and the ground.
pub fn heap() -> Model {
    let mut world = Builder::new("heap");
    let bodies = solids(&mut world);
    let (upper, lower) = (rod(bodies, "upper", 1.0), rod(bodies, "lower", 1.0));
    bodies
        .free("float", upper)
        .initial(&[0.1, 0.9, 0.0, 0.6, 0.0, 0.0, 0.8]);
    let (top, bottom) = (Pose::at(DVec3::Y * 0.2), Pose::at(DVec3::Y * -0.2));
    bodies
        .revolute("elbow", lower, DVec3::Z)
        .parent(upper)
        .frames(bottom, top);
    world.build().unwrap()
}

/// Only the loose ones of a [`heap`].
pub fn loose_heap() -> Model {
    let mut world = Builder::new("loose heap");
    solids(&mut world);
    world.build().unwrap()
}

/// Ground, and solids one above the other.
fn solids(world: &mut Builder) -> &mut Object {
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    world.object("ground").scenery(Shape::new(plane));
    let bodies = world.object("bodies");
    let solids = [
        Geometry::Sphere { radius: 0.1 },
        Geometry::Capsule {
            radius: 0.06,
            half_height: 0.15,
        },
        Geometry::Box {
            half: DVec3::new(0.1, 0.05, 0.08),
        },
        Geometry::Cylinder {
            radius: 0.08,
            half_height: 0.07,
        },
        Geometry::Hull(wedge()),
    ];
    for (i, solid) in solids.into_iter().enumerate() {
        let body = bodies.body(format!("body_{i}")).shape(solid).handle();
        let at = [0.02 * i as f64, 0.15 + 0.2 * i as f64, 0.01 * i as f64];
        bodies
            .free(format!("float_{i}"), body)
            .initial(&[at[0], at[1], at[2], 0.0, 0.0, 0.0, 1.0]);
    }
    bodies
}

/// Six corners, above the origin.
fn wedge() -> Hull {
    let end = |z| [(-0.1, 0.0), (0.1, 0.0), (0.05, 0.12)].map(|(x, y)| DVec3::new(x, y, z));
    Hull::new(&[end(-0.06), end(0.07)].concat()).unwrap()
}

/// The `i`-th number of a world's seed, in [−1, 1): the same on every machine.
fn noise(seed: usize, i: usize) -> f64 {
    // SplitMix64 (Steele, Lea, Flood 2014).
    let mut x = (((seed as u64) << 32) ^ i as u64).wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (x >> 40) as f64 / f64::from(1 << 23) - 1.0
}

/// Gives a world a state and controls that belong to the seed; every third has no forces.
pub fn scatter<T: Float>(simulation: &mut Simulation<T>, world: usize, seed: usize) {
    let model = simulation.model().clone();
    let mut next = (0..).map(|i| noise(seed, i));
    let mut some =
        |n: usize, size: f64| -> Vec<f64> { next.by_ref().take(n).map(|x| size * x).collect() };
    let mut position = Vec::new();
    for joint in &model.joints {
        // Coordinates of a quaternion stay near the initial ones, so that it never vanishes.
        let away = if joint.kind == JointKind::Free {
            0.1
        } else {
            0.3
        };
        let moved = some(joint.coordinates(), away);
        position.extend(joint.initial.iter().zip(moved).map(|(q, x)| q + x));
    }
    let velocity = some(model.degrees_of_freedom(), 1.0);
    simulation
        .set_joint_state(world, &position, &velocity)
        .unwrap();
    let mut controls = simulation.controls();
    let most = if seed.is_multiple_of(3) { 0.0 } else { 0.5 };
    controls
        .set_force(world, &some(velocity.len(), most))
        .unwrap();
    controls
        .set_control(world, &some(model.actuators.len(), 1.0))
        .unwrap();
    for (dof, target) in some(velocity.len(), 0.5).into_iter().enumerate() {
        controls.set_target(world, dof, target).unwrap();
        controls
            .set_target_velocity(world, dof, -0.5 * target)
            .unwrap();
    }
}

/// Worlds that all differ; world w has seed `seed(w)`.
pub fn scattered<T: Float>(
    model: &Model,
    settings: SimulationSettings,
    seed: impl Fn(usize) -> usize,
) -> Simulation<T> {
    let mut simulation = Simulation::new(model.clone(), settings).unwrap();
    for world in 0..settings.worlds {
        scatter(&mut simulation, world, seed(world));
    }
    simulation
}

/// Everything that is reported of a world's motion.
pub fn motion<T: Float>(simulation: &mut Simulation<T>, world: usize) -> Vec<f64> {
    let bodies: Vec<_> = simulation.model().order().to_vec();
    let outputs = simulation.outputs();
    let mut all = [outputs.joint_position(world), outputs.joint_velocity(world)].concat();
    for body in bodies {
        all.extend(outputs.body_position(world, body).to_array());
        all.extend(outputs.body_orientation(world, body).to_array());
        all.extend(outputs.body_velocity(world, body).to_array());
        all.extend(outputs.body_angular_velocity(world, body).to_array());
    }
    all
}

/// FNV-1a (Fowler, Noll, Vo) over the bits of a world's motion.
pub fn hash<T: Float>(simulation: &mut Simulation<T>, world: usize) -> u64 {
    let bytes = motion(simulation, world)
        .into_iter()
        .flat_map(|x| x.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// The hashes of all worlds.
pub fn hashes<T: Float>(simulation: &mut Simulation<T>) -> Vec<u64> {
    (0..simulation.worlds())
        .map(|world| hash(simulation, world))
        .collect()
}
