//! Armature where it matters which way an axis lies: oblique to what it carries, and where an anchor goes in circles.

use crate::common::*;
use glam::{DMat3, DQuat, DVec3};
use model::{Axis, Builder, Model, Pose};

const H: f64 = 1e-3;

/// All solvers, `impulse` also with the small steps that it takes by default.
const ALL: [Method; 4] = [EULER, Method::Xpbd(4), IMPULSE, Method::Impulse(8)];

const ROD: f64 = 1.4;
/// Principal moments of the rod [kg·m²].
const MOMENTS: DVec3 = DVec3::new(9e-3, 4e-4, 9e-3);
/// From its centre to the hinge [m].
const ANCHOR: DVec3 = DVec3::new(0.05, -0.15, 0.02);

/// A rod on a hinge about an axis that is none of its own, with an armature [kg·m²].
fn hinge(axis: DVec3, armature: f64) -> Model {
    let mut world = Builder::new("hinge");
    let object = world.object("");
    let rod = body(object, "rod", ROD, DVec3::ZERO, MOMENTS);
    let joint = object.revolute("hinge", rod, axis);
    joint.frames(Pose::IDENTITY, Pose::at(ANCHOR));
    joint.armature(armature);
    world.build().unwrap()
}

/// About an upright axis nothing pushes: θ = ω t, however much larger the armature is than the rod's own moment of inertia
/// about its centre, along which the locks would have it turn.
#[test]
fn on_an_upright_hinge_it_turns_on() {
    let (speed, steps) = (2.0, 400);
    for armature in [0.0, 5e-3, 0.05, 1.0] {
        for method in ALL {
            let mut simulation = method.simulate::<f64>(&hinge(DVec3::Y, armature), H);
            simulation.set_joint_state(0, &[0.0], &[speed]).unwrap();
            simulation.step(steps);
            let name = format!("{method:?} with {armature}");
            let outputs = simulation.outputs();
            let (angle, rate) = (outputs.coordinate(0, 0), outputs.dof_velocity(0, 0));
            let (way, within) = (steps as f64 * H, 1e-4 * speed);
            close(format!("{name}: angle"), angle, speed * way, within * way);
            close(format!("{name}: rate"), rate, speed, within);
        }
    }
}

/// About an oblique one it is a pendulum, ½ (I + a) θ̇² + m g y = E, with I = n·J n + m |n × r|².
#[test]
fn on_an_oblique_hinge_it_slows_a_pendulum() {
    let axis = DVec3::ONE.normalize();
    let own = axis.dot(DMat3::from_diagonal(MOMENTS) * axis);
    let moment = own + ROD * axis.cross(ANCHOR).length_squared();
    for armature in [0.0, 5e-3, 0.05, 1.0] {
        for method in ALL {
            let mut simulation = method.simulate::<f64>(&hinge(axis, armature), H);
            simulation.set_joint_state(0, &[0.0], &[2.0]).unwrap();
            let outputs = simulation.outputs();
            let (kinetic, energy) = (outputs.kinetic_energy(0), outputs.energy(0));
            let name = format!("{method:?} with {armature}");
            let expected = 0.5 * (moment + armature) * 4.0;
            close(format!("{name}: at first"), kinetic, expected, 1e-12);
            for _ in 0..100 {
                simulation.step(1);
                let outputs = simulation.outputs();
                let speed = outputs.dof_velocity(0, 0).abs();
                // First order: a step of the power of gravity, which comes back.
                let power = ROD * G * ANCHOR.length() * speed;
                let within = H * power + 1e-4;
                close(format!("{name}: energy"), outputs.energy(0), energy, within);
            }
        }
    }
}

/// A disc that an anchor off its centre lets move in a plane, with an armature [kg] along one of the two ways.
fn disc(axis: usize, armature: f64) -> Model {
    let mut world = Builder::new("disc");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let disc = body(object, "disc", ROD, DVec3::ZERO, DVec3::splat(9e-3));
    let joint = object.plane_xz("anchor", disc);
    joint.frames(Pose::IDENTITY, Pose::at(ANCHOR));
    joint.dofs_mut()[axis].armature = armature;
    world.build().unwrap()
}

/// Along a straight axis whose anchor goes in circles about the centre of mass, it takes part in what is kept: without
/// forces p = m ẋ_c + a ẋ, and the energy.
#[test]
fn along_an_axis_whose_anchor_circles_it_has_momentum() {
    for (axis, method) in [0, 1].into_iter().flat_map(|axis| ALL.map(|m| (axis, m))) {
        let name = format!("{method:?}, axis {axis}");
        let [free, geared] = [0.0, 0.5].map(|armature| {
            let model = disc(axis, armature);
            let mut simulation = method.simulate::<f64>(&model, H);
            let (start, speed) = (model.initial_position(), [0.5, -0.3, 4.0]);
            simulation.set_joint_state(0, &start, &speed).unwrap();
            let [before, after] = [0, 600].map(|steps| {
                simulation.step(steps);
                let outputs = simulation.outputs();
                let own = outputs.momentum(0).to_array()[2 * axis];
                let momentum = own + armature * outputs.dof_velocity(0, axis);
                [momentum, outputs.kinetic_energy(0)]
            });
            // First order in h ω.
            let within = 2.0 * H * speed[2];
            let name = format!("{name} with {armature}");
            let size = before[0].abs().max(0.5);
            close(
                format!("{name}: momentum"),
                after[0],
                before[0],
                within * size,
            );
            close(
                format!("{name}: energy"),
                after[1],
                before[1],
                within * before[1],
            );
            DVec3::from_array([0, 1, 2].map(|q| simulation.outputs().coordinate(0, q)))
        });
        assert!(free.distance(geared) > 5e-3, "{name}: {free}, {geared}");
    }
}

/// A rod on three axes through one point, askew to it, with an armature [kg·m²] about each: a ball, or three hinges.
fn askew(ball: bool, armature: f64) -> Model {
    let mut world = Builder::new("askew");
    let object = world.object("");
    let moments = DVec3::new(MOMENTS.y, MOMENTS.x, MOMENTS.z);
    let along = DQuat::from_rotation_arc(DVec3::X, DVec3::new(1.0, 1.0, -1.0).normalize());
    let turn = DMat3::from_quat(along);
    let inertia = turn * DMat3::from_diagonal(moments) * turn.transpose();
    let center = along * DVec3::X * 0.2;
    let rod = object.body("rod").inertia(ROD, center, inertia).handle();
    let joint = if ball {
        object.ball("shoulder", rod)
    } else {
        object.d6(
            "shoulder",
            rod,
            &[DVec3::X, DVec3::Y, DVec3::Z].map(Axis::angular),
        )
    };
    joint.armature(armature).damping(0.1);
    world.build().unwrap()
}

/// About three axes at once, far larger than the rod's moment about itself, which all three share: it swings as
/// coordinates have it. Each axis by itself found the impulses so slowly that these, given again, grew without end.
#[test]
fn about_three_axes_askew_to_a_rod_it_swings_on() {
    for (ball, armature) in [true, false]
        .into_iter()
        .flat_map(|b| [5e-3, 0.05, 0.5].map(|a| (b, a)))
    {
        let model = askew(ball, armature);
        let swing = |method: Method, h: f64| {
            let mut simulation = method.simulate::<f64>(&model, h);
            let start = model.initial_position();
            simulation.set_joint_state(0, &start, &[0.3; 3]).unwrap();
            simulation.step((0.5 / h).round() as usize);
            let outputs = simulation.outputs();
            DVec3::from_array([0, 1, 2].map(|i| outputs.dof_velocity(0, i)))
        };
        let expected = swing(RK4, 1e-3);
        for method in [IMPULSE, Method::Impulse(8)] {
            for h in [2e-3, 5e-4] {
                let name = format!("{method:?}, ball {ball}, {armature}, {h}");
                // First order: a few steps of the acceleration that gravity gives.
                near(name, swing(method, h), expected, 5.0 * h * G / 0.2);
            }
        }
    }
}
