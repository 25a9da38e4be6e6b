//! Massless bodies and point masses: fused with what they are fixed to.
//!
//! Files use bodies without mass as mere frames: URDF's `base_footprint`, the mounts of sensors; and bodies without
//! inertia as loads. A model's bodies have both, for solvers divide by them. A body that lacks one and that a `fixed`
//! joint ties to its parent becomes part of the parent; one that moves takes up the bodies that are fixed to it. The
//! motion stays the same; the names that are gone are listed.

use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;
use model::{Body, BodyId, BodyKind, CameraMode, JointId, JointKind, MassProperties, Parts, Pose};

/// What is said of bodies that were taken up.
const FUSED: &str = "bodies that are fixed to each other become one where either has no mass or no inertia (give it both to \
                     keep it); these names are gone, with position [m] and quaternion x y z w in what has them";

/// For each body of a model, whether it was fused, and with which. Bodies stand after their parents.
pub(crate) struct Fusion {
    /// The body that takes a body up; itself where nothing does.
    into: Vec<usize>,
}

impl Fusion {
    /// Decides; `elements` are the bodies' elements in the file.
    ///
    /// # Errors
    /// A body moves, and neither it nor anything that is fixed to it has mass.
    pub fn plan(parts: &Parts, elements: &[Element]) -> Result<Self, FormatError> {
        let mut into: Vec<usize> = (0..parts.bodies.len()).collect();
        let in_world = |body: &Body| mass_properties(body).placed(&body.pose);
        let mut mass: Vec<MassProperties> = parts.bodies.iter().map(in_world).collect();
        // Leaves first: a body that cannot move alone takes up its fixed children, whether they can or not.
        for (parent, child) in fixed(parts).rev() {
            if !(mass[child].is_definite() && mass[parent].is_definite()) {
                into[child] = parent;
                mass[parent] = both(&mass[parent], &mass[child]);
            }
        }
        for (i, body) in parts.bodies.iter().enumerate() {
            if body.kind == BodyKind::Dynamic && into[i] == i && mass[i].mass <= 0.0 {
                return Err(elements[i].invalid(
                    "the body moves but has no mass",
                    "give it an inertial element or solid shapes with density, or fix it to a \
                     body with mass",
                ));
            }
        }
        // A body taken up by one that was itself taken up ends in the last of them.
        for i in 0..into.len() {
            into[i] = into[into[i]];
        }
        Ok(Self { into })
    }

    /// Whether a body is taken up by another.
    pub fn takes_up(&self, body: BodyId) -> bool {
        self.into[body.0] != body.0
    }

    /// Lists the bodies that are taken up whose elements give them names; `parts` are named, and as planned.
    pub fn tell(&self, parts: &Parts, elements: &[Element], report: &mut Report) {
        for (i, &into) in self.into.iter().enumerate() {
            let name = elements[i].get("name").filter(|name| !name.is_empty());
            if let Some(name) = name.filter(|_| into != i) {
                let pose = self.relative_pose(parts, i);
                let position = written(&pose.position.to_array());
                let turn = written(&pose.orientation.to_array());
                let carrier = &parts.bodies[into].name;
                let item = format!("\"{name}\" in \"{carrier}\" at ({position}), ({turn})");
                report.list(&elements[i], FUSED, &item);
            }
        }
    }

    /// Carries the plan out.
    pub fn apply(&self, parts: &mut Parts) {
        if self.into.iter().enumerate().all(|(i, into)| i == *into) {
            return;
        }
        let placed: Vec<Pose> = (0..self.into.len())
            .map(|i| self.relative_pose(parts, i))
            .collect();
        for (i, pose) in placed.iter().enumerate() {
            if self.into[i] != i {
                let taken_up = mass_properties(&parts.bodies[i]).placed(pose);
                take_up(&mut parts.bodies[self.into[i]], &taken_up);
            }
        }
        self.move_references(parts, &placed);
        self.remove(parts);
    }

    /// A body's pose in the body that takes it up.
    fn relative_pose(&self, parts: &Parts, i: usize) -> Pose {
        match self.into[i] {
            into if into == i => Pose::IDENTITY,
            into => parts.bodies[into].pose.inverse() * parts.bodies[i].pose,
        }
    }

    fn move_references(&self, parts: &mut Parts, placed: &[Pose]) {
        for shape in &mut parts.shapes {
            if let Some(body) = &mut shape.body {
                shape.pose = placed[body.0] * shape.pose;
                body.0 = self.into[body.0];
            }
        }
        let cameras = parts.cameras.iter_mut();
        let cameras = cameras.map(|c| (&mut c.body, c.mode, &mut c.pose));
        let lamps = parts.lamps.iter_mut();
        let lamps = lamps.map(|l| (&mut l.body, l.mode, &mut l.pose));
        for (body, mode, pose) in cameras.chain(lamps) {
            if let Some(body) = body {
                let onto = parts.bodies[self.into[body.0]].pose;
                *pose = match mode {
                    CameraMode::Fixed => placed[body.0] * *pose,
                    // As far from the other body's origin as at first.
                    CameraMode::Track => {
                        let arm = onto.orientation * placed[body.0].position;
                        Pose::new(arm + pose.position, pose.orientation)
                    }
                };
                body.0 = self.into[body.0];
            }
        }
        for joint in &mut parts.joints {
            if let Some(parent) = &mut joint.parent {
                joint.parent_frame = placed[parent.0] * joint.parent_frame;
                parent.0 = self.into[parent.0];
            }
            joint.child_frame = placed[joint.child.0] * joint.child_frame;
            joint.child.0 = self.into[joint.child.0];
        }
        for sensor in &mut parts.sensors {
            for mount in sensor.measurand.mounts_mut() {
                if let Some(body) = &mut mount.body {
                    mount.pose = placed[body.0] * mount.pose;
                    body.0 = self.into[body.0];
                }
            }
            if let Some(body) = sensor.measurand.body_mut() {
                body.0 = self.into[body.0];
            }
        }
        for (other, body) in &mut parts.exclusions {
            *other = other.map(|id| BodyId(self.into[id.0]));
            body.0 = self.into[body.0];
        }
        parts
            .exclusions
            .retain(|(other, body)| *other != Some(*body));
    }

    /// Removes the bodies that were taken up and the joints that tied them, and renumbers the rest.
    fn remove(&self, parts: &mut Parts) {
        let stays = |i: usize| self.into[i] == i;
        let body_row = renumber((0..self.into.len()).map(stays));
        let joint_stays: Vec<bool> = parts
            .joints
            .iter()
            .map(|joint| joint.parent != Some(joint.child))
            .collect();
        let joint_row = renumber(joint_stays.iter().copied());
        let to_body = |id: BodyId| BodyId(body_row[id.0]);
        let to_joint = |id: JointId| JointId(joint_row[id.0]);

        let mut i = 0..;
        parts.bodies.retain(|_| i.next().is_some_and(stays));
        let mut stays = joint_stays.iter();
        parts
            .joints
            .retain(|_| stays.next().is_some_and(|stays| *stays));
        let shapes = parts.shapes.iter_mut().map(|shape| &mut shape.body);
        let cameras = parts.cameras.iter_mut().map(|camera| &mut camera.body);
        let lamps = parts.lamps.iter_mut().map(|lamp| &mut lamp.body);
        for body in shapes.chain(cameras).chain(lamps) {
            *body = body.map(to_body);
        }
        for joint in &mut parts.joints {
            joint.parent = joint.parent.map(to_body);
            joint.child = to_body(joint.child);
        }
        for (other, body) in &mut parts.exclusions {
            (*other, *body) = (other.map(to_body), to_body(*body));
        }
        for coupling in &mut parts.couplings {
            coupling.joint = to_joint(coupling.joint);
            coupling.other = to_joint(coupling.other);
        }
        for actuator in &mut parts.actuators {
            actuator.joint = to_joint(actuator.joint);
        }
        for sensor in &mut parts.sensors {
            for mount in sensor.measurand.mounts_mut() {
                mount.body = mount.body.map(to_body);
            }
            if let Some(body) = sensor.measurand.body_mut() {
                *body = to_body(*body);
            }
            if let Some(joint) = sensor.measurand.joint_mut() {
                *joint = to_joint(*joint);
            }
        }
    }
}

/// Parent and child of every fixed joint of the tree that ties two moving bodies.
fn fixed(parts: &Parts) -> impl DoubleEndedIterator<Item = (usize, usize)> + '_ {
    parts.joints.iter().filter_map(|joint| {
        let parent = joint.parent?.0;
        let ties = joint.kind == JointKind::Fixed && !joint.closes_loop;
        (ties && parts.bodies[parent].kind == BodyKind::Dynamic).then_some((parent, joint.child.0))
    })
}

fn mass_properties(body: &Body) -> MassProperties {
    MassProperties {
        mass: body.mass,
        center: body.center,
        inertia: body.inertia,
    }
}

fn take_up(body: &mut Body, other: &MassProperties) {
    let both = both(&mass_properties(body), other);
    (body.mass, body.center, body.inertia) = (both.mass, both.center, both.inertia);
}

/// Of two bodies together, in one frame; either may have no mass.
fn both(one: &MassProperties, other: &MassProperties) -> MassProperties {
    match (one.mass > 0.0, other.mass > 0.0) {
        (true, true) => one.and(other),
        (false, true) => *other,
        _ => *one,
    }
}

/// Numbers to a millionth, separated by blanks.
fn written(numbers: &[f64]) -> String {
    // −0 is 0.
    let tidy = |x: &f64| format!("{}", (x * 1e6).round() / 1e6 + 0.0);
    numbers.iter().map(tidy).collect::<Vec<_>>().join(" ")
}

/// New row of each row that stays.
fn renumber(stays: impl Iterator<Item = bool>) -> Vec<usize> {
    stays
        .scan(0, |next, stays| {
            let row = *next;
            *next += usize::from(stays);
            Some(row)
        })
        .collect()
}
