//! Gauges read what follows from what a simulation reports, world by world.

#[path = "../../rigid/tests/scene/every_gauge.rs"]
mod every_gauge;
#[path = "../../rigid/tests/scene/models.rs"]
mod models;

use every_gauge::every_gauge;
use glam::{DQuat, DVec3};
use kinetarium_sim::{
    Effort, FLAGS, Gauge, Gauges, Outputs, Report, Simulation, SimulationError, SimulationSettings,
    SolverKind,
};
use model::{Axes, BodyId, BodyKind, JointId, Model, Mount, Pose, ShapeId};
use numbers::Float;
use std::ops::Range;

/// A world, as its outputs tell it.
struct Look<'a, T: Float> {
    simulation: &'a Simulation<T>,
    outputs: &'a Outputs<'a, T>,
    world: usize,
}

impl<T: Float> Look<'_, T> {
    fn pose(&self, body: BodyId) -> Pose {
        let pose = self.outputs.body_pose(self.world, body);
        Pose::new(pose.position, pose.orientation.normalize())
    }
    fn placed(&self, mount: &Mount) -> Pose {
        mount.body.map_or(Pose::IDENTITY, |b| self.pose(b)) * mount.pose
    }
    fn turn(&self, axes: Axes, own: Pose) -> DQuat {
        match axes {
            Axes::World => DQuat::IDENTITY,
            Axes::Own => own.orientation.conjugate(),
        }
    }
    /// Velocity and angular velocity, then acceleration, of a frame.
    fn motion(&self, mount: &Mount) -> [DVec3; 3] {
        let Some(body) = mount.body else {
            return [DVec3::ZERO; 3];
        };
        let (o, w) = (self.outputs, self.world);
        let arm = self.pose(body).direction(mount.pose.position);
        let turning = o.body_angular_velocity(w, body);
        let linear = o.body_velocity(w, body) + turning.cross(arm);
        let acceleration = o.body_acceleration(w, body)
            + o.body_angular_acceleration(w, body).cross(arm)
            + turning.cross(turning.cross(arm));
        [linear, turning, acceleration]
    }
    fn effort(&self) -> Effort<'_, T> {
        Effort {
            simulation: self.simulation,
            outputs: self.outputs,
            world: self.world,
        }
    }
    /// Normals of contacts of a body, and forces on it.
    fn contacts(&self, body: BodyId) -> Vec<(DVec3, DVec3)> {
        let shapes = &self.simulation.model().shapes;
        let of = |shape: usize| shapes[shape].body == Some(body);
        let now = self.outputs.contacts(self.world);
        now.filter_map(|c| match c.shapes {
            [_, second] if of(second.0) => Some((c.normal, c.force)),
            [first, _] if of(first.0) => Some((c.normal, -c.force)),
            _ => None,
        })
        .collect()
    }
    fn wrench(&self, joint: JointId, frame: Option<Pose>) -> [DVec3; 2] {
        let of_world = &self.simulation.world_model(self.world).joints[joint.0];
        let child = self.pose(of_world.child);
        let at = child * frame.unwrap_or(of_world.child_frame);
        let (force, torque) = self.outputs.reaction(self.world, joint);
        let arm = child.point(of_world.child_frame.position) - at.position;
        let own = at.orientation.conjugate();
        [own * force, own * (torque + arm.cross(force))]
    }
    fn carried(&self, model: &Model, of: Option<BodyId>, id: BodyId) -> bool {
        let parent = || model.joints[model.carrier(id)?.0].parent;
        of.is_none() || of == Some(id) || parent().is_some_and(|p| self.carried(model, of, p))
    }
    fn center(&self, of: Option<BodyId>) -> DVec3 {
        let model = self.simulation.world_model(self.world);
        let (mut mass, mut sum) = (0.0, DVec3::ZERO);
        for (row, body) in model.bodies.iter().enumerate() {
            let id = BodyId(row);
            if body.kind == BodyKind::Dynamic && self.carried(model, of, id) {
                mass += body.mass;
                sum += body.mass * self.pose(id).point(body.center);
            }
        }
        match of {
            Some(body) if mass == 0.0 => self.pose(body).position,
            _ => sum / mass,
        }
    }
    fn expected(&self, gauge: &Gauge) -> Vec<f64> {
        let model = self.simulation.model();
        let (o, w) = (self.outputs, self.world);
        let vectors = |v: &[DVec3]| v.iter().flat_map(|v| v.to_array()).collect();
        match gauge {
            Gauge::JointPosition(joints) => {
                let rows = joints.iter().flat_map(|j| model.coordinate_range(*j));
                rows.map(|row| o.coordinate(w, row)).collect()
            }
            Gauge::JointVelocity(joints) => {
                let dofs = joints.iter().flat_map(|j| model.dof_range(*j));
                dofs.map(|dof| o.dof_velocity(w, dof)).collect()
            }
            Gauge::JointEffort(joints) => {
                let mut forces = vec![];
                for joint in joints {
                    self.effort().of_joint(*joint, |force| forces.push(force));
                }
                forces
            }
            Gauge::ActuatorForce(rows) => {
                rows.iter().map(|a| self.effort().of_actuator(*a)).collect()
            }
            Gauge::Imu(mount) => {
                let [_, turning, acceleration] = self.motion(mount);
                let own = self.placed(mount).orientation.conjugate();
                let gravity = self.simulation.world_model(w).gravity;
                vectors(&[own * (acceleration - gravity), own * turning])
            }
            Gauge::ForceTorque(joint, frame) => vectors(&self.wrench(*joint, *frame)),
            Gauge::Touch(body) => {
                let contacts = self.contacts(*body).into_iter();
                vec![contacts.map(|(n, f)| n.dot(f).abs()).sum()]
            }
            Gauge::ContactForce(body, axes) => {
                let sum = self
                    .contacts(*body)
                    .into_iter()
                    .map(|(_, f)| f)
                    .sum::<DVec3>();
                vectors(&[self.turn(*axes, self.pose(*body)) * sum])
            }
            Gauge::FramePose([frame, relative]) => {
                let pose = self.placed(relative).inverse() * self.placed(frame);
                let [p, q] = [
                    pose.position.to_array().to_vec(),
                    pose.orientation.to_array().into(),
                ];
                [p, q].concat()
            }
            Gauge::FrameVelocity(mount, axes) => {
                let turn = self.turn(*axes, self.placed(mount));
                let [linear, turning, _] = self.motion(mount);
                vectors(&[turn * linear, turn * turning])
            }
            Gauge::CenterOfMass(of) => vectors(&[self.center(*of)]),
            Gauge::Pressing(pairs) => {
                let presses = |pair| self.between(pair).any(|(_, force)| force != DVec3::ZERO);
                flags(pairs.iter().map(|&pair| presses(pair)))
            }
            Gauge::Overlapping(pairs) => {
                let overlap = |pair| self.between(pair).any(|(distance, _)| distance <= 0.0);
                flags(pairs.iter().map(|&pair| overlap(pair)))
            }
            Gauge::PairForce(pairs) => {
                let sum = |&pair| self.between(pair).map(|(_, force)| force).sum::<DVec3>();
                vectors(&Vec::from_iter(pairs.iter().map(sum)))
            }
            Gauge::AtEnd(joints) => flags(joints.iter().flat_map(|joint| self.ends(*joint))),
        }
    }
    /// Distances and forces of the contacts of two shapes, on the second.
    fn between(&self, [a, b]: [ShapeId; 2]) -> impl Iterator<Item = (f64, DVec3)> {
        let contacts = self.outputs.contacts(self.world);
        contacts.filter_map(move |c| match c.shapes {
            shapes if shapes == [a, b] => Some((c.distance, c.force)),
            shapes if shapes == [b, a] => Some((c.distance, -c.force)),
            _ => None,
        })
    }
    /// Whether each degree of freedom of a joint is at its upper end, and at its lower.
    fn ends(&self, joint: JointId) -> Vec<bool> {
        let model = self.simulation.world_model(self.world);
        let coordinates = model.coordinate_range(joint);
        let is_axis = coordinates.len() == model.dof_range(joint).len();
        let x = |row: usize| self.outputs.coordinate(self.world, coordinates.start + row);
        let dofs = model.joints[joint.0].dofs.iter().enumerate();
        let ends = dofs.flat_map(|(row, dof)| match dof.limit.filter(|_| is_axis) {
            Some(limit) => [x(row) >= limit.upper, x(row) <= limit.lower],
            None => [false; 2],
        });
        ends.collect()
    }
}

/// So many in a number, the first of them 1, the next 2, and so on.
fn flags(set: impl Iterator<Item = bool>) -> Vec<f64> {
    let set = Vec::from_iter(set);
    let numbers = set.chunks(FLAGS);
    let number = |flags: &[bool]| {
        flags
            .iter()
            .rev()
            .fold(0.0, |sum, &x| 2.0 * sum + f64::from(u8::from(x)))
    };
    numbers.map(number).collect()
}

/// These numbers of a world, as they were read.
fn read<T: Float>(gauges: &Gauges<T>, world: usize, numbers: &Range<usize>) -> Vec<f64> {
    let mut read = vec![T::zero(); numbers.len()];
    gauges.copy(world, numbers.start, &mut read);
    read.into_iter().map(T::to_f64).collect()
}

/// Reads all gauges in all worlds, and expects what outputs say, to so much in parts of the largest number of a gauge, at
/// least 1; returns how many of the gauges read anything but 0.
fn agree<T: Float>(simulation: &mut Simulation<T>, tolerance: f64) -> usize {
    let list = every_gauge(simulation.model());
    let mut gauges = simulation.gauges(list.clone()).unwrap();
    let worlds: Vec<_> = (0..simulation.worlds()).collect();
    simulation.read_gauges(&mut gauges, &worlds).unwrap();
    let mut busy = vec![false; list.len()];
    let looked = simulation.observe(|simulation, outputs| {
        for world in worlds {
            let look = Look {
                simulation,
                outputs,
                world,
            };
            for ((gauge, numbers), busy) in list.iter().zip(gauges.numbers()).zip(&mut busy) {
                let read = read(&gauges, world, numbers);
                let expected = look.expected(gauge);
                assert_eq!(read.len(), expected.len(), "{gauge:?}");
                let size = match gauge {
                    Gauge::Pressing(_) | Gauge::Overlapping(_) | Gauge::AtEnd(_) => 1.0,
                    _ => expected.iter().fold(1.0_f64, |most, x| most.max(x.abs())),
                };
                for (x, y) in read.iter().zip(&expected) {
                    let off = (x - y).abs() / size;
                    assert!(
                        off < tolerance,
                        "{gauge:?} in {world}: {read:?}, {expected:?}"
                    );
                }
                *busy |= read.iter().any(|x| x.abs() > 1e-6);
            }
        }
    });
    looked.unwrap();
    busy.into_iter().filter(|busy| *busy).count()
}

/// Worlds that differ, after some steps.
fn stirred<T: Float>(model: &Model, solver: SolverKind, worlds: usize) -> Simulation<T> {
    let settings = SimulationSettings {
        solver,
        ..SimulationSettings::new(worlds, 0.002)
    };
    let mut simulation = Simulation::new(model.clone(), settings).unwrap();
    let wave = |i: usize| (1.7 * i as f64 + 0.4).sin();
    for world in 0..worlds {
        let dofs = 0..model.degrees_of_freedom();
        let velocity: Vec<_> = dofs.clone().map(|v| 0.5 * wave(v + world)).collect();
        let position = model.initial_position();
        simulation
            .set_joint_state(world, &position, &velocity)
            .unwrap();
        let mut controls = simulation.controls();
        let force: Vec<_> = dofs.map(|v| 0.3 * wave(v + world + 1)).collect();
        controls.set_force(world, &force).unwrap();
        let control: Vec<_> = (0..model.actuators.len())
            .map(|a| wave(a + world))
            .collect();
        controls.set_control(world, &control).unwrap();
    }
    simulation.step(6);
    assert!(
        simulation.diverged().is_empty(),
        "{} by {solver:?}",
        model.name
    );
    simulation
}

const ALL: [SolverKind; 3] = [
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];

#[test]
fn gauges_read_what_outputs_tell() {
    for (name, model) in [
        ("mixed", models::mixed(false).unwrap()),
        ("looped", models::looped().unwrap()),
        ("heap", models::heap().unwrap()),
    ] {
        // `impulse` has no couplings.
        let takes = |solver: &SolverKind| name != "looped" || *solver != SolverKind::Impulse;
        for solver in ALL.into_iter().filter(takes) {
            for worlds in [1, 19] {
                let busy = agree(&mut stirred::<f64>(&model, solver, worlds), 1e-11);
                assert!(busy > every_gauge(&model).len() / 2, "{name}, {solver:?}");
                agree(&mut stirred::<f32>(&model, solver, worlds), 2e-5);
            }
        }
    }
}

/// Far from the origin, differences of frames are as exact as bodies are there.
#[test]
fn frames_far_away_are_told_exactly() {
    let model = models::heap().unwrap();
    let mut simulation = stirred::<f32>(&model, SolverKind::Featherstone, 3);
    let mut far = model.initial_position();
    far.chunks_exact_mut(7).for_each(|pose| pose[0] += 4096.0);
    simulation
        .set_joint_state(1, &far, &vec![0.0; model.degrees_of_freedom()])
        .unwrap();
    let pose = |body: usize| Mount::on(BodyId(body)).at(Pose::at(DVec3::splat(0.1)));
    let gauge = Gauge::FramePose([pose(0), pose(1)]);
    let mut gauges = simulation.gauges(vec![gauge.clone()]).unwrap();
    simulation.read_gauges(&mut gauges, &[1]).unwrap();
    let read = read(&gauges, 1, &(0..7));
    let outputs = simulation.outputs();
    let [a, b] = [0, 1].map(|i| outputs.body_pose(1, BodyId(i)) * pose(i).pose);
    let expected = (b.inverse() * a).position.to_array();
    for (x, y) in read.iter().zip(expected) {
        assert!((x - y).abs() < 2e-6, "{read:?} {expected:?}");
    }
}

/// Worlds with gravity, masses, frames and laws of their own, set before and after the gauges were made.
#[test]
fn worlds_are_read_by_their_own_numbers() {
    let model = models::mixed(true).unwrap();
    let mut simulation = stirred::<f64>(&model, SolverKind::Featherstone, 19);
    let own = |world: usize| {
        let (mut own, by) = (model.clone().into_parts(), 1.0 + 0.1 * world as f64);
        own.gravity *= by;
        own.bodies[1].mass *= by;
        own.bodies[1].center.x += 0.01 * by;
        for dof in own.joints.iter_mut().flat_map(|joint| &mut joint.dofs) {
            dof.drive.stiffness *= by;
        }
        own.actuators[0].gear *= by;
        Model::new(own).unwrap()
    };
    simulation.set_world_model(3, &own(3)).unwrap();
    agree(&mut simulation, 1e-11);
    let list = every_gauge(&model);
    let mut gauges = simulation.gauges(list.clone()).unwrap();
    let worlds: Vec<_> = (0..19).collect();
    simulation.read_gauges(&mut gauges, &worlds).unwrap();
    for world in [3, 5, 18] {
        simulation.set_world_model(world, &own(2 * world)).unwrap();
    }
    simulation.read_gauges(&mut gauges, &worlds).unwrap();
    let mut anew = simulation.gauges(list).unwrap();
    simulation.read_gauges(&mut anew, &worlds).unwrap();
    for world in worlds {
        let all = 0..gauges.length();
        let [read, expected] = [&gauges, &anew].map(|gauges| read(gauges, world, &all));
        assert_eq!(read, expected, "{world}");
    }
    agree(&mut simulation, 1e-11);

    let mut plain = stirred::<f64>(&model, SolverKind::Featherstone, 19);
    let mut anew = plain.gauges(every_gauge(&model)).unwrap();
    for gauges in [&mut gauges, &mut anew] {
        plain.read_gauges(gauges, &[3]).unwrap();
    }
    let all = 0..gauges.length();
    let [known, expected] = [&gauges, &anew].map(|gauges| read(gauges, 3, &all));
    assert_eq!(known, expected, "a simulation without any");

    simulation.set_world_model(5, &own(4)).unwrap();
    let mut anew = simulation.gauges(every_gauge(&model)).unwrap();
    for gauges in [&mut gauges, &mut anew] {
        simulation.read_gauges(gauges, &[5]).unwrap();
    }
    let [known, expected] = [&gauges, &anew].map(|gauges| read(gauges, 5, &all));
    assert_eq!(known, expected, "and the first one again");
}

/// By `impulse`, drives and servos of a world act with as much of their stiffness as its own model's small steps resolve: with
/// some 10⁴ N·m/rad of a hand of 0.002 kg·m².
#[test]
fn worlds_have_their_own_shares_of_stiffness() {
    let model = models::mixed(false).unwrap();
    let mut simulation = stirred::<f64>(&model, SolverKind::Impulse, 3);
    let mut stiff = model.clone().into_parts();
    for dof in stiff.joints.iter_mut().flat_map(|joint| &mut joint.dofs) {
        dof.drive.stiffness *= 1e6;
    }
    stiff.actuators.iter_mut().for_each(|a| a.bias[1] *= 1e6);
    let stiff = Model::new(stiff).unwrap();
    simulation.set_world_model(1, &stiff).unwrap();
    agree(&mut simulation, 1e-11);
    let wrist = Gauge::JointEffort(vec![model.joint("wrist").unwrap()]);
    let mut gauges = simulation.gauges(vec![wrist]).unwrap();
    simulation.read_gauges(&mut gauges, &[0, 1]).unwrap();
    let [plain, stiff] = [0, 1].map(|world| DVec3::from_slice(&read(&gauges, world, &(0..3))));
    let more = stiff.length() / plain.length();
    assert!((100.0..1e4).contains(&more), "{more}");
}

#[test]
fn what_there_is_not_is_refused() {
    let model = models::mixed(false).unwrap();
    let mut simulation = stirred::<f32>(&model, SolverKind::Featherstone, 2);
    let says = |gauge: Gauge, expected: &str| {
        let told = simulation.gauges(vec![gauge]).unwrap_err().to_string();
        assert!(told.contains(expected), "{told}");
    };
    says(Gauge::Touch(BodyId(99)), "body 99");
    says(Gauge::JointVelocity(vec![JointId(98)]), "joint 98");
    says(Gauge::Pressing(vec![[ShapeId(0), ShapeId(95)]]), "shape 95");
    says(Gauge::ForceTorque(JointId(97), None), "joint 97");
    says(Gauge::ActuatorForce(vec![96]), "actuator 96");
    let nowhere = Mount::default().at(Pose::at(DVec3::NAN));
    says(Gauge::Imu(nowhere), "position");
    let unturned = Pose::new(DVec3::ZERO, DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0));
    says(
        Gauge::FrameVelocity(Mount::default().at(unturned), Axes::Own),
        "orientation",
    );
    let mut late = models::mixed(false).unwrap().into_parts();
    late.joints[1].dofs[0].drive.control_time = 0.1;
    let late = stirred::<f32>(&Model::new(late).unwrap(), SolverKind::Xpbd, 1);
    let told = late.gauges(vec![Gauge::JointEffort(vec![JointId(1)])]);
    let told = told.unwrap_err().to_string();
    assert!(
        told.contains("control time of a drive of gauge 0 is 0.1 s"),
        "{told}"
    );
    let mut gauges = simulation.gauges(vec![Gauge::CenterOfMass(None)]).unwrap();
    let told = simulation.read_gauges(&mut gauges, &[2]).unwrap_err();
    assert!(matches!(told, SimulationError::Index { .. }), "{told}");
    let mut other = stirred::<f32>(&model, SolverKind::Xpbd, 2);
    let told = other.read_gauges(&mut gauges, &[0]).unwrap_err();
    assert!(matches!(told, SimulationError::OtherModel(_)), "{told}");
}

/// Nothing is worked out for pairs where there are none.
#[test]
fn no_pairs_need_no_contacts() {
    let model = models::mixed(false).unwrap();
    let joints = Vec::from_iter((0..model.joints.len()).map(JointId));
    for solver in ALL {
        let simulation = stirred::<f32>(&model, solver, 1);
        let needs = |pairs: Vec<[ShapeId; 2]>| {
            let gauges = simulation.gauges(vec![
                Gauge::Pressing(pairs.clone()),
                Gauge::Overlapping(pairs.clone()),
                Gauge::PairForce(pairs),
                Gauge::AtEnd(joints.clone()),
            ]);
            gauges.unwrap().needs()
        };
        assert_eq!(needs(vec![]), Report::Joints);
        assert_eq!(needs(vec![[ShapeId(0), ShapeId(1)]]), Report::Contacts);
    }
}
