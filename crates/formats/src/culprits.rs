//! Where in a file that stands which no model can be made of.

use crate::error::{FormatError, Place};
use crate::xml::Element;
use model::{JointId, ModelError, Parts};

/// Places of bodies and joints, by what a model's errors call them.
pub(crate) struct Culprits(Vec<(String, Place)>);

impl Culprits {
    /// Of named parts; `bodies` are the bodies' elements in the file.
    pub fn new<'a>(
        parts: &Parts,
        bodies: &[Element],
        joints: impl Iterator<Item = (JointId, &'a Element)>,
    ) -> Self {
        let called = |kind: &str, name: &str| format!("{kind} \"{name}\":");
        let bodies = parts.bodies.iter().zip(bodies);
        let bodies = bodies.map(|(body, e)| (called("body", &body.name), e.place.clone()));
        let joints = joints.map(|(id, e)| {
            let name = &parts.joints[id.0].name;
            (called("joint", name), e.place.clone())
        });
        Self(bodies.chain(joints).collect())
    }

    /// The error of a file's model, with the place of what it names.
    pub fn locate(&self, file: &str, source: ModelError) -> FormatError {
        let told = source.to_string();
        let mut known = self.0.iter();
        let place = known.find(|(culprit, _)| told.starts_with(culprit));
        FormatError::Model {
            file: place.map_or(file.to_owned(), |(_, place)| place.to_string()),
            source,
        }
    }
}
