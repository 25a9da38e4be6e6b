//! One gauge of each kind for all that a model has.

use model::{Axes, BodyId, JointId, JointKind, Model, Mount, Pose, ShapeId};
use rigid::Gauge;

/// Somewhere on a body.
fn mount(body: usize) -> Mount {
    let at = glam::DVec3::new(0.3, -0.1 * body as f64, 0.2);
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 0.3 + body as f64, -0.7);
    Mount::on(BodyId(body)).at(Pose::new(at, turn))
}

/// Every two shapes, some of them the other way round.
fn pairs(model: &Model) -> Vec<[ShapeId; 2]> {
    let all = 0..model.shapes.len();
    let pairs = all.flat_map(|b| (0..b).map(move |a| [ShapeId(a), ShapeId(b)]));
    let turned = |(i, [a, b]): (usize, [ShapeId; 2])| if i % 3 == 2 { [b, a] } else { [a, b] };
    pairs.enumerate().map(turned).collect()
}

pub fn every_gauge(model: &Model) -> Vec<Gauge> {
    let joints = |has: &dyn Fn(JointId) -> usize| -> Vec<JointId> {
        let all = (0..model.joints.len()).map(JointId);
        all.filter(|joint| has(*joint) > 0).collect()
    };
    let moving = joints(&|joint| model.dof_range(joint).len());
    // A drive that follows its target with a lag knows alone where that is.
    let prompt = |joint: &JointId| {
        let dofs = &model.joints[joint.0].dofs;
        dofs.iter().all(|dof| dof.drive.control_time == 0.0)
    };
    let driven = moving.iter().copied().filter(prompt).collect();
    let standing = Mount {
        body: None,
        ..mount(3)
    };
    let mut list = vec![
        Gauge::JointPosition(joints(&|joint| model.coordinate_range(joint).len())),
        Gauge::JointVelocity(moving.clone()),
        Gauge::AtEnd(moving),
        Gauge::Pressing(pairs(model)),
        Gauge::Overlapping(pairs(model)),
        Gauge::PairForce(pairs(model)),
        Gauge::JointEffort(driven),
        Gauge::ActuatorForce((0..model.actuators.len()).rev().collect()),
        Gauge::Imu(standing),
        Gauge::FrameVelocity(standing, Axes::World),
        Gauge::CenterOfMass(None),
    ];
    let bodies = model.bodies.len();
    for row in 0..bodies {
        let (body, next) = (BodyId(row), mount((row + 1) % bodies));
        list.extend([
            Gauge::Imu(mount(row)),
            Gauge::Touch(body),
            Gauge::ContactForce(body, Axes::World),
            Gauge::ContactForce(body, Axes::Own),
            Gauge::FramePose([mount(row), next]),
            Gauge::FramePose([standing, mount(row)]),
            Gauge::FramePose([mount(row), Mount::default()]),
            Gauge::FrameVelocity(mount(row), Axes::World),
            Gauge::FrameVelocity(mount(row), Axes::Own),
            Gauge::CenterOfMass(Some(body)),
        ]);
    }
    for (row, joint) in model.joints.iter().enumerate() {
        if joint.kind != JointKind::Free {
            list.push(Gauge::ForceTorque(JointId(row), None));
            let frame = Some(mount(row).pose);
            list.push(Gauge::ForceTorque(JointId(row), frame));
        }
    }
    list
}
