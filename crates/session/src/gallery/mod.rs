//! The examples that a page offers: each a scene, what it can be built with, and what to look at.

mod bodies;
mod joints;
mod robots;

use crate::SessionError;
use crate::form::Form;
use crate::protocol::{self, Field};
use crate::stage::Stage;
use std::fmt;

/// An example of the gallery.
#[derive(Clone, Copy)]
pub struct Example {
    /// Name, as a word.
    pub name: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// What there is to see, in a line.
    pub about: &'static str,
    /// Two or three sentences: what to try, and what to observe.
    pub guide: &'static str,
    /// What it can be built with.
    pub(crate) build: fn() -> Vec<Field>,
    /// Builds it.
    pub(crate) make: fn(&Form) -> Result<Stage, SessionError>,
}

impl fmt::Debug for Example {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Example({})", self.name)
    }
}

/// All of them.
pub static EXAMPLES: [Example; 20] = [
    joints::PENDULA,
    joints::PRISMATIC,
    joints::BALL_JOINT,
    bodies::BALLS,
    bodies::BILLIARDS,
    bodies::COLLIDE,
    bodies::DOMINOES,
    bodies::TOWER,
    bodies::PYRAMID,
    bodies::CARD_HOUSE,
    bodies::ARCH,
    bodies::PILE,
    bodies::TERRAIN,
    bodies::RINGS,
    robots::RAGDOLLS,
    robots::ROOM,
    robots::LINKAGE,
    robots::HUMANOID,
    robots::ANT,
    robots::GRID,
];

impl Example {
    /// The example of that name.
    ///
    /// # Errors
    /// There is none.
    pub fn find(name: &str) -> Result<&'static Self, SessionError> {
        let found = EXAMPLES.iter().find(|example| example.name == name);
        found.ok_or_else(|| SessionError::Example {
            name: name.into(),
            known: EXAMPLES.map(|example| example.name).join(", "),
        })
    }
    /// What it can be built with, at its defaults.
    pub(crate) fn form(&self) -> Form {
        Form::new((self.build)())
    }
    /// Builds it, with its defaults but for the values given.
    ///
    /// # Errors
    /// Values that it does not take.
    pub fn stage(&self, values: &protocol::Values) -> Result<Stage, SessionError> {
        (self.make)(&self.form().with(values)?)
    }
    /// What a page is told of it.
    pub(crate) fn describe(&self) -> protocol::Example {
        protocol::Example {
            name: self.name.into(),
            title: self.title.into(),
            about: self.about.into(),
            guide: self.guide.into(),
            build: (self.build)(),
        }
    }
}

/// Nothing to choose.
fn no_fields() -> Vec<Field> {
    Vec::new()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::{FieldKind, Values};

    #[test]
    fn every_example_is_built_with_its_least_and_most_and_is_found_by_its_name() {
        for example in &EXAMPLES {
            assert_eq!(Example::find(example.name).unwrap().title, example.title);
            assert!(
                (60..=600).contains(&example.guide.len()),
                "{}",
                example.name
            );
            let fields = (example.build)();
            let end = |most: bool| -> Values {
                let value = |field: &Field| match &field.kind {
                    FieldKind::Number { min, max, .. } | FieldKind::Integer { min, max } => {
                        if most { *max } else { *min }
                    }
                    FieldKind::Flag => f64::from(most),
                    FieldKind::Choice { names } => f64::from(most) * (names.len() - 1) as f64,
                };
                fields.iter().map(|f| (f.name.clone(), value(f))).collect()
            };
            for values in [Values::new(), end(false), end(true)] {
                let stage = example.stage(&values);
                let stage = stage.unwrap_or_else(|e| panic!("{}: {e}", example.name));
                let known = crate::quantity::quantities(&stage.model);
                for plot in &stage.plots {
                    let is = known.iter().any(|(_, q)| q.label == *plot);
                    assert!(is, "{}: no quantity `{plot}`", example.name);
                }
                for joint in &stage.sliders {
                    stage.model.joint(joint).unwrap();
                }
            }
        }
    }

    #[test]
    fn an_unknown_example_is_refused_with_those_there_are() {
        let error = Example::find("towr").unwrap_err().to_string();
        assert!(
            error.contains("`towr`") && error.contains("tower"),
            "{error}"
        );
    }
}
