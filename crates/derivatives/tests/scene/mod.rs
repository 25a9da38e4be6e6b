//! Models to differentiate, and their states at random.

// Every test program uses its part.
#![allow(dead_code)]

use fastrand::Rng;
use glam::{DQuat, DVec3};
use kinetarium_derivatives::Linearization;
use model::{
    Axis, BodyHandle, Builder, Drive, Geometry, JointId, JointKind, Limit, Model, ModelError,
    Object, Pose, Shape,
};
use rigid::Integrator;
use sim::{Simulation, SimulationSettings, SolverKind};

/// Time step [s].
pub const STEP: f64 = 0.004;

pub const INTEGRATORS: [Integrator; 4] = [
    Integrator::SemiImplicitEuler,
    Integrator::ExplicitEuler,
    Integrator::Verlet,
    Integrator::RungeKutta4,
];

/// Half the length of a rod [m].
const HALF: f64 = 0.2;
/// The ends of a rod.
const TOP: Pose = Pose {
    position: DVec3::new(0.0, HALF, 0.0),
    orientation: DQuat::IDENTITY,
};
const BOTTOM: Pose = Pose {
    position: DVec3::new(0.0, -HALF, 0.0),
    orientation: DQuat::IDENTITY,
};

fn rod(object: &mut Object, name: &str, mass: f64) -> BodyHandle {
    let shape = Geometry::Capsule {
        radius: 0.03,
        half_height: HALF,
    };
    object.body(name).shape(shape).mass(mass).handle()
}

/// A rod on a damped hinge that turns without end, with a motor.
pub fn pendulum() -> Result<Model, ModelError> {
    let mut world = Builder::new("pendulum");
    let object = world.object("pendulum");
    let body = rod(object, "rod", 1.3);
    let hinge = object.revolute("hinge", body, DVec3::Z);
    let hinge = hinge.frames(Pose::IDENTITY, TOP).damping(0.05).handle();
    object.motor("motor", hinge).gear(0.7);
    world.build()
}

/// Two rods on a cart, with a motor, a position servo and a velocity servo.
pub fn double_pendulum_on_a_cart() -> Result<Model, ModelError> {
    let mut world = Builder::new("double_pendulum_on_a_cart");
    let object = world.object("cart");
    let half = DVec3::new(0.1, 0.05, 0.05);
    let cart = object
        .body("cart")
        .shape(Geometry::Box { half })
        .mass(2.0)
        .handle();
    let [lower, upper] = ["lower", "upper"].map(|name| rod(object, name, 0.5));
    let slide = object
        .prismatic("slide", cart, DVec3::X)
        .damping(0.3)
        .handle();
    let first = object.revolute("first", lower, DVec3::Z);
    let first = first
        .parent(cart)
        .frames(Pose::IDENTITY, BOTTOM)
        .armature(0.003)
        .handle();
    let second = object.revolute("second", upper, DVec3::Z);
    let second = second.parent(lower).frames(TOP, BOTTOM).handle();
    object.motor("push", slide).gear(40.0);
    object.position_servo("hold", first, 30.0, 1.0);
    object.velocity_servo("turn", second, 0.4);
    world.build()
}

/// Two rods upright on a cart, which alone is pushed.
pub fn inverted_double_pendulum() -> Result<Model, ModelError> {
    let mut world = Builder::new("inverted_double_pendulum");
    let object = world.object("cart");
    let half = DVec3::new(0.1, 0.05, 0.05);
    let cart = object
        .body("cart")
        .shape(Geometry::Box { half })
        .mass(2.0)
        .handle();
    let [lower, upper] = ["lower", "upper"].map(|name| rod(object, name, 0.5));
    let slide = object.prismatic("slide", cart, DVec3::X).handle();
    let first = object.revolute("first", lower, DVec3::Z).parent(cart);
    first.frames(Pose::IDENTITY, BOTTOM);
    object
        .revolute("second", upper, DVec3::Z)
        .parent(lower)
        .frames(TOP, BOTTOM);
    object.motor("push", slide);
    world.build()
}

/// Rods on ball joints, hinges and a slider: with springs, dampers, drives (one of which follows its
/// target slowly), and limits; nothing of it at its bounds.
pub fn chain_of_everything() -> Result<Model, ModelError> {
    let mut world = Builder::new("chain_of_everything");
    let chain = world.object("chain");
    let rods = ["a", "b", "c", "d", "e"].map(|name| rod(chain, name, 0.8));
    let drive = Drive {
        stiffness: 6.0,
        damping: 0.3,
        target_position: 0.2,
        ..Drive::default()
    };
    let tilted = Pose::new(DVec3::new(0.1, -0.2, 0.05), DQuat::from_rotation_x(0.6));
    chain
        .ball("hip", rods[0])
        .frames(Pose::IDENTITY, TOP)
        .drive(drive)
        .damping(0.05);
    let limit = Limit {
        lower: -2.0,
        upper: 2.0,
        stiffness: 500.0,
        damping: 3.0,
        inertia: 0.1,
    };
    let knee = chain.revolute("knee", rods[1], DVec3::Z).parent(rods[0]);
    knee.frames(tilted, TOP)
        .limit(limit)
        .spring(4.0, 0.3)
        .damping(0.1);
    let slow = Drive {
        control_time: 0.02,
        ..drive
    };
    let slide = chain.prismatic("slide", rods[2], DVec3::Y).parent(rods[1]);
    slide
        .frames(BOTTOM, TOP)
        .drive(slow)
        .spring(90.0, 0.0)
        .armature(0.2);
    chain
        .ball("wrist", rods[3])
        .parent(rods[2])
        .frames(BOTTOM, tilted)
        .damping(0.02);
    let axes = [Axis::angular(DVec3::X), Axis::angular(DVec3::Z)];
    let cross = chain.d6("cross", rods[4], &axes).parent(rods[3]);
    cross.frames(BOTTOM, TOP).damping(0.03).armature(0.01);
    world.build()
}

/// A trunk that floats, an arm on a hinge, a leg on a ball.
pub fn floating() -> Result<Model, ModelError> {
    let mut world = Builder::new("floating");
    let robot = world.object("robot");
    let [trunk, arm, leg] = ["trunk", "arm", "leg"].map(|name| rod(robot, name, 1.1));
    robot.free("float", trunk);
    let tilted = Pose::new(DVec3::new(0.1, -0.2, 0.05), DQuat::from_rotation_x(0.6));
    let shoulder = robot.revolute("shoulder", arm, DVec3::Z).parent(trunk);
    let shoulder = shoulder.frames(tilted, TOP).damping(0.1).handle();
    robot.ball("hip", leg).parent(trunk).frames(BOTTOM, tilted);
    robot.motor("shoulder_motor", shoulder).gear(3.0);
    world.build()
}

/// A ball, a block and a leg of two rods, each a little within the ground or within what it lies on.
pub fn touching() -> Result<Model, ModelError> {
    let mut world = Builder::new("touching");
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    world.object("ground").scenery(Shape::new(plane));
    let bodies = world.object("bodies");
    let half = DVec3::new(0.15, 0.1, 0.2);
    let block = bodies.body("block").shape(Geometry::Box { half }).mass(2.0);
    block.at(Pose::at(DVec3::Y * 0.0995));
    let ball = bodies
        .body("ball")
        .shape(Geometry::Sphere { radius: 0.1 })
        .mass(0.7);
    ball.at(Pose::at(DVec3::new(0.05, 0.299, 0.03)));
    let (thigh, shank) = (rod(bodies, "thigh", 1.0), rod(bodies, "shank", 0.8));
    let lying = DQuat::from_rotation_z(1.3);
    let hip = bodies.free("hip", thigh);
    let lying = lying.to_array();
    hip.initial(&[&[1.0, 0.4, 0.0][..], &lying].concat());
    let knee = bodies.revolute("knee", shank, DVec3::Z).parent(thigh);
    knee.frames(BOTTOM, TOP).initial(&[-0.9]).damping(0.1);
    world.build()
}

/// All that touch nothing.
pub fn models() -> [Model; 4] {
    [
        pendulum(),
        double_pendulum_on_a_cart(),
        chain_of_everything(),
        floating(),
    ]
    .map(|model| model.expect("a model"))
}

/// One world of `featherstone` without contacts.
pub fn settings(integrator: Integrator, substeps: usize) -> SimulationSettings {
    let mut settings = SimulationSettings::new(1, STEP);
    settings.solver = SolverKind::Featherstone;
    settings.contacts = false;
    settings.threads = 1;
    settings.step.integrator = integrator;
    settings.step.substeps = substeps;
    settings
}

/// Coordinates, velocities and controls of one world.
#[derive(Clone, Debug)]
pub struct State {
    pub position: Vec<f64>,
    pub velocity: Vec<f64>,
    /// As [`sim::Controls::of_world`] has them.
    pub input: Vec<f64>,
}

/// Where a model's quaternions begin among its coordinates, and their rates among its velocities.
pub fn quaternions(model: &Model) -> Vec<[usize; 2]> {
    let turns = |joint: &model::Joint| matches!(joint.kind, JointKind::Ball | JointKind::Free);
    let joints = model.joints.iter().enumerate();
    joints
        .filter(|(_, joint)| turns(joint))
        .map(|(i, _)| {
            [
                model.coordinate_range(JointId(i)).end - 4,
                model.dof_range(JointId(i)).end - 3,
            ]
        })
        .collect()
}

/// A random state: coordinates within ±1.5, all orientations, velocities within ±3, inputs within ±1.
pub fn random(model: &Model, rng: &mut Rng) -> State {
    let mut within = |n: usize, most: f64| -> Vec<f64> {
        (0..n).map(|_| most * (2.0 * rng.f64() - 1.0)).collect()
    };
    let mut position = within(model.coordinates(), 1.5);
    let velocity = within(model.degrees_of_freedom(), 3.0);
    let input = within(3 * velocity.len() + model.actuators.len(), 1.0);
    for [q, _] in quaternions(model) {
        let unit = DQuat::from_slice(&position[q..]).normalize();
        position[q..q + 4].copy_from_slice(&unit.to_array());
    }
    State {
        position,
        velocity,
        input,
    }
}

/// Puts a state into world 0.
pub fn put(simulation: &mut Simulation<f64>, state: &State) {
    let set = simulation.set_joint_state(0, &state.position, &state.velocity);
    set.expect("a state");
    let set = simulation.controls().set_world(0, &state.input);
    set.expect("controls");
}

/// A matrix, row-major.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    pub rows: usize,
    pub columns: usize,
    pub numbers: Vec<f64>,
}

impl Matrix {
    pub fn new(rows: usize, columns: usize, numbers: Vec<f64>) -> Self {
        assert_eq!(numbers.len(), rows * columns);
        Self {
            rows,
            columns,
            numbers,
        }
    }
    pub fn of(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let all = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
        Self::new(rows, columns, all.map(|(i, j)| entry(i, j)).collect())
    }
    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.numbers[i * self.columns + j]
    }
    pub fn transposed(&self) -> Self {
        Self::of(self.columns, self.rows, |i, j| self.at(j, i))
    }
    pub fn times(&self, other: &Self) -> Self {
        assert_eq!(self.columns, other.rows);
        let entry = |i, j| {
            (0..self.columns)
                .map(|k| self.at(i, k) * other.at(k, j))
                .sum()
        };
        Self::of(self.rows, other.columns, entry)
    }
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        Self::of(self.rows, self.columns, |i, j| {
            self.at(i, j) + factor * other.at(i, j)
        })
    }
    /// Largest magnitude of an entry.
    pub fn size(&self) -> f64 {
        self.numbers.iter().fold(0.0, |m, x| x.abs().max(m))
    }
    /// The solution X of self · X = right, by Gauss–Jordan elimination with pivots.
    pub fn solve(&self, right: &Self) -> Self {
        let (n, m) = (self.rows, right.columns);
        let mut rows: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                let left = &self.numbers[i * n..][..n];
                [left, &right.numbers[i * m..][..m]].concat()
            })
            .collect();
        for i in 0..n {
            let larger = |a: &usize, b: &usize| rows[*a][i].abs().total_cmp(&rows[*b][i].abs());
            let pivot = (i..n).max_by(larger).expect("a row");
            rows.swap(i, pivot);
            let row = rows[i].clone();
            for (k, other) in rows.iter_mut().enumerate() {
                let factor = if k == i {
                    1.0 - 1.0 / row[i]
                } else {
                    other[i] / row[i]
                };
                other
                    .iter_mut()
                    .zip(&row)
                    .for_each(|(x, r)| *x -= factor * r);
            }
        }
        Self::of(n, m, |i, j| rows[i][n + j])
    }
}

/// A of a linearisation.
pub fn state_matrix(step: &Linearization) -> Matrix {
    Matrix::new(2 * step.dofs, 2 * step.dofs, step.state.clone())
}
/// B of a linearisation.
pub fn control_matrix(step: &Linearization) -> Matrix {
    Matrix::new(2 * step.dofs, step.controls, step.control.clone())
}
