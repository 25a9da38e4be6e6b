//! Names for what a file leaves unnamed: a model needs one for each thing.

use model::{Dof, Parts};
use std::collections::HashSet;

/// Names that are taken.
#[derive(Default)]
pub(crate) struct Taken(HashSet<String>);

impl Taken {
    pub fn by<'a>(names: impl Iterator<Item = &'a String>) -> Self {
        Self(names.filter(|name| !name.is_empty()).cloned().collect())
    }

    /// Fills an empty name with `wish`, with a number behind it where that is taken.
    pub fn fill(&mut self, name: &mut String, wish: &str) {
        if name.is_empty() {
            let numbered = (2..).map(|i| format!("{wish}_{i}"));
            let mut wishes = std::iter::once(wish.to_owned()).chain(numbered);
            *name = wishes
                .find(|wish| !self.0.contains(wish))
                .unwrap_or_default();
            self.0.insert(name.clone());
        }
    }
}

/// Fills every empty name. A body is called by its row, a joint after its child, a degree of
/// freedom after its joint, an actuator after what it drives, a coupling, a keyframe, a camera and a lamp by its row.
pub(crate) fn complete(parts: &mut Parts) {
    let mut taken = Taken::by(parts.bodies.iter().map(|b| &b.name));
    for (i, body) in parts.bodies.iter_mut().enumerate() {
        taken.fill(&mut body.name, &format!("body_{}", i + 1));
    }
    let mut taken = Taken::by(parts.joints.iter().map(|j| &j.name));
    for joint in &mut parts.joints {
        taken.fill(&mut joint.name, &parts.bodies[joint.child.0].name);
    }
    complete_dofs(parts);
    let mut taken = Taken::by(parts.actuators.iter().map(|a| &a.name));
    for actuator in &mut parts.actuators {
        let dof = &parts.joints[actuator.joint.0].dofs[actuator.dof];
        taken.fill(&mut actuator.name, &dof.name);
    }
    let mut taken = Taken::by(parts.couplings.iter().map(|c| &c.name));
    for (i, coupling) in parts.couplings.iter_mut().enumerate() {
        taken.fill(&mut coupling.name, &format!("coupling_{i}"));
    }
    let mut taken = Taken::by(parts.keyframes.iter().map(|k| &k.name));
    for (i, keyframe) in parts.keyframes.iter_mut().enumerate() {
        taken.fill(&mut keyframe.name, &format!("key_{i}"));
    }
    let mut taken = Taken::by(parts.cameras.iter().map(|c| &c.name));
    for (i, camera) in parts.cameras.iter_mut().enumerate() {
        taken.fill(&mut camera.name, &format!("camera_{i}"));
    }
    let mut taken = Taken::by(parts.lamps.iter().map(|l| &l.name));
    for (i, lamp) in parts.lamps.iter_mut().enumerate() {
        taken.fill(&mut lamp.name, &format!("lamp_{i}"));
    }
}

fn complete_dofs(parts: &mut Parts) {
    let mut taken = Taken::by(
        parts
            .joints
            .iter()
            .flat_map(|j| j.dofs.iter().map(|d| &d.name)),
    );
    for joint in &mut parts.joints {
        let single = joint.dofs.len() == 1;
        for (i, Dof { name, .. }) in joint.dofs.iter_mut().enumerate() {
            let numbered = format!("{}_{i}", joint.name);
            taken.fill(name, if single { &joint.name } else { &numbered });
        }
    }
}
