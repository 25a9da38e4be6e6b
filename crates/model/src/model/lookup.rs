//! Finding things by name.

use super::Model;
use crate::{BodyId, Camera, Joint, JointId, JointKind, Keyframe, ModelError};

/// How alike two names must be (Jaro–Winkler, 0 to 1) for one to be offered in place of the other.
const ALIKE: f64 = 0.75;
/// Most names that an error lists.
const MOST_LISTED: usize = 20;

impl Model {
    /// The body of this name.
    ///
    /// # Errors
    /// [`ModelError::UnknownName`], with a name that is alike.
    pub fn body(&self, name: &str) -> Result<BodyId, ModelError> {
        find("body", name, self.bodies.iter().map(|b| b.name.as_str())).map(BodyId)
    }
    /// The joint of this name.
    ///
    /// # Errors
    /// [`ModelError::UnknownName`], with a name that is alike.
    pub fn joint(&self, name: &str) -> Result<JointId, ModelError> {
        find("joint", name, self.joints.iter().map(|j| j.name.as_str())).map(JointId)
    }
    /// Where the degree of freedom of this name lies among the velocities of a state.
    ///
    /// # Errors
    /// [`ModelError::UnknownName`], with a name that is alike.
    pub fn dof(&self, name: &str) -> Result<usize, ModelError> {
        find("degree of freedom", name, self.dof_names())
    }
    /// Row of the actuator of this name.
    ///
    /// # Errors
    /// [`ModelError::UnknownName`], with a name that is alike.
    pub fn actuator(&self, name: &str) -> Result<usize, ModelError> {
        find(
            "actuator",
            name,
            self.actuators.iter().map(|a| a.name.as_str()),
        )
    }
    /// The keyframe of this name.
    ///
    /// # Errors
    /// [`ModelError::UnknownName`], with a name that is alike.
    pub fn keyframe(&self, name: &str) -> Result<&Keyframe, ModelError> {
        let row = find(
            "keyframe",
            name,
            self.keyframes.iter().map(|k| k.name.as_str()),
        )?;
        Ok(&self.keyframes[row])
    }
    /// The camera of this name.
    ///
    /// # Errors
    /// [`ModelError::UnknownName`], with a name that is alike.
    pub fn camera(&self, name: &str) -> Result<&Camera, ModelError> {
        let row = find("camera", name, self.cameras.iter().map(|c| c.name.as_str()))?;
        Ok(&self.cameras[row])
    }

    /// Names of the velocities of a state, in their order.
    pub fn dof_names(&self) -> impl Iterator<Item = &str> {
        let in_state = self.joints.iter().filter(|j| !j.closes_loop);
        in_state.flat_map(|j| &j.dofs).map(|d| d.name.as_str())
    }
    /// Names of the coordinates of a state, in their order.
    ///
    /// A coordinate along or about an axis is named as its degree of freedom; those of ball and
    /// free joints as the joint, with `_position_x` … `_position_z` and `_orientation_x` …
    /// `_orientation_w` behind.
    pub fn coordinate_names(&self) -> Vec<String> {
        self.joints
            .iter()
            .filter(|j| !j.closes_loop)
            .flat_map(coordinate_names)
            .collect()
    }
}

fn coordinate_names(joint: &Joint) -> Vec<String> {
    let named = |quantity: &str, axes: &str| -> Vec<String> {
        axes.chars()
            .map(|axis| format!("{}_{quantity}_{axis}", joint.name))
            .collect()
    };
    match joint.kind {
        JointKind::Ball => named("orientation", "xyzw"),
        JointKind::Free => [named("position", "xyz"), named("orientation", "xyzw")].concat(),
        _ => joint.dofs.iter().map(|d| d.name.clone()).collect(),
    }
}

fn find<'a>(
    kind: &'static str,
    name: &str,
    names: impl Iterator<Item = &'a str>,
) -> Result<usize, ModelError> {
    let names: Vec<_> = names.collect();
    match names.iter().position(|&n| n == name) {
        Some(row) => Ok(row),
        None => Err(ModelError::UnknownName {
            kind,
            name: name.into(),
            hint: hint(name, &names),
        }),
    }
}

/// The name that is most alike, where one is alike enough to be meant.
pub fn similar_name<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let rated = names
        .into_iter()
        .map(|n| (strsim::jaro_winkler(name, n), n));
    let best = rated.max_by(|a, b| a.0.total_cmp(&b.0));
    best.filter(|(alike, _)| *alike > ALIKE).map(|(_, n)| n)
}

/// What to say of a name that is not among those that there are: the one that is most alike; else all of them, or the
/// first of them.
pub fn hint(name: &str, names: &[&str]) -> String {
    match similar_name(name, names.iter().copied()) {
        Some(best) => format!("did you mean \"{best}\"?"),
        None if names.is_empty() => "there are none".into(),
        None if names.len() <= MOST_LISTED => format!("there are {}", names.join(", ")),
        None => format!("there are {}, …", names[..MOST_LISTED].join(", ")),
    }
}
