//! The keywords that all joints take.

use crate::builder::Body;
use crate::error;
use crate::geometry::pose;
use crate::joint::{Dof, Drive, Limit};
use kinetarium::model::{JointDraft, ModelError, Pose};
use pyo3::conversion::FromPyObjectOwned;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Their names, as in the type stubs' `JointOptions`.
const KNOWN: [&str; 19] = [
    "parent",
    "position",
    "orientation",
    "parent_frame",
    "child_frame",
    "initial",
    "dofs",
    "limit",
    "drive",
    "damping",
    "stiffness",
    "rest",
    "armature",
    "friction_loss",
    "linear_compliance",
    "angular_compliance",
    "closes_loop",
    "bodies_collide",
    "enabled",
];

/// What a joint is given, checked before it is made.
pub struct JointOptions {
    pub parent: Option<Body>,
    at: Option<Pose>,
    frames: Option<[Pose; 2]>,
    initial: Option<Vec<f64>>,
    dofs: Vec<Dof>,
    linear_compliance: f64,
    angular_compliance: f64,
    closes_loop: bool,
    bodies_collide: bool,
    enabled: bool,
}

impl JointOptions {
    /// For a joint with so many degrees of freedom.
    pub fn read(
        joint: &str,
        degrees_of_freedom: usize,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let keywords = Keywords { joint, options };
        keywords.must_be_known()?;
        Ok(Self {
            parent: keywords.get("parent")?,
            at: keywords.place()?,
            frames: keywords.frames()?,
            initial: keywords.read("initial", |value| {
                let several = value.extract::<Vec<f64>>();
                several.or_else(|_| {
                    let one = value.extract::<f64>().map(|one| vec![one]);
                    one.map_err(|_| {
                        PyTypeError::new_err("give a number, or one for each coordinate")
                    })
                })
            })?,
            dofs: keywords.dofs(degrees_of_freedom)?,
            linear_compliance: keywords.get("linear_compliance")?.unwrap_or(0.0),
            angular_compliance: keywords.get("angular_compliance")?.unwrap_or(0.0),
            closes_loop: keywords.get("closes_loop")?.unwrap_or(false),
            bodies_collide: keywords.get("bodies_collide")?.unwrap_or(false),
            enabled: keywords.get("enabled")?.unwrap_or(true),
        })
    }

    /// Gives the joint all of it.
    pub fn shape(self, draft: &mut JointDraft) {
        if let Some(parent) = self.parent {
            draft.parent(parent.handle);
        }
        if let Some(at) = self.at {
            draft.at(at);
        }
        if let Some([parent, child]) = self.frames {
            draft.frames(parent, child);
        }
        if let Some(initial) = self.initial {
            draft.initial(&initial);
        }
        for (dof, options) in draft.dofs_mut().iter_mut().zip(self.dofs) {
            options.act(dof);
        }
        draft.compliance(self.linear_compliance, self.angular_compliance);
        if self.closes_loop {
            draft.closes_loop();
        }
        if self.bodies_collide {
            draft.bodies_collide();
        }
        if !self.enabled {
            draft.disabled();
        }
    }
}

/// Keywords as they were given; `None` is as if there were none.
struct Keywords<'a, 'py> {
    joint: &'a str,
    options: Option<&'a Bound<'py, PyDict>>,
}

impl<'py> Keywords<'_, 'py> {
    fn must_be_known(&self) -> PyResult<()> {
        for name in self.options.into_iter().flat_map(|options| options.keys()) {
            let name: String = name.extract()?;
            if !KNOWN.contains(&name.as_str()) {
                let known = KNOWN.join(", ");
                let message = format!("joints have no option \"{name}\"; known are {known}");
                return Err(error::raise("UnknownNameError", message));
            }
        }
        Ok(())
    }
    fn read<T>(
        &self,
        name: &str,
        read: impl FnOnce(&Bound<'py, PyAny>) -> PyResult<T>,
    ) -> PyResult<Option<T>> {
        let value = match self.options {
            Some(options) => options.get_item(name)?,
            None => None,
        };
        let Some(value) = value.filter(|value| !value.is_none()) else {
            return Ok(None);
        };
        let read = read(&value).map_err(|e| {
            let why = e.value(value.py());
            PyTypeError::new_err(format!("joint {:?}: option {name}: {why}", self.joint))
        });
        Ok(Some(read?))
    }
    fn get<T: FromPyObjectOwned<'py>>(&self, name: &str) -> PyResult<Option<T>> {
        self.read(name, |value| value.extract().map_err(Into::into))
    }

    /// Where it is in the object.
    fn place(&self) -> PyResult<Option<Pose>> {
        let (position, orientation) = (self.get("position")?, self.get("orientation")?);
        if position.is_none() && orientation.is_none() {
            return Ok(None);
        }
        let no_turn = [0.0, 0.0, 0.0, 1.0];
        let (position, orientation) =
            (position.unwrap_or_default(), orientation.unwrap_or(no_turn));
        Ok(Some(pose(position, orientation)))
    }
    /// Where it is in the parent and in the child.
    fn frames(&self) -> PyResult<Option<[Pose; 2]>> {
        let frame = |name| {
            self.read(name, |value| {
                let [position, orientation]: [Bound<'_, PyAny>; 2] = value.extract()?;
                Ok(pose(position.extract()?, orientation.extract()?))
            })
        };
        let frames = [frame("parent_frame")?, frame("child_frame")?];
        if frames == [None, None] {
            return Ok(None);
        }
        if self.place()?.is_some() {
            let message = "give a joint its frame in the object (position, orientation) or in both bodies \
                           (parent_frame, child_frame), not both";
            return Err(self.refused(message));
        }
        Ok(Some(frames.map(Option::unwrap_or_default)))
    }

    /// What acts along each degree of freedom: what is given for it, and what is given for all.
    fn dofs(&self, count: usize) -> PyResult<Vec<Dof>> {
        let all = Dof {
            name: None,
            limit: self.read("limit", Limit::of)?,
            drive: self.get::<Drive>("drive")?,
            damping: self.get("damping")?,
            stiffness: self.get("stiffness")?,
            rest: self.get("rest")?,
            armature: self.get("armature")?,
            friction_loss: self.get("friction_loss")?,
        };
        if let (0, Some(option)) = (count, all.given().next()) {
            let message = format!(
                "it has no degree of freedom that its {option} could act along; leave it out"
            );
            return Err(self.refused(&message));
        }
        let each = self.get::<Vec<Dof>>("dofs")?;
        let each = each.unwrap_or_else(|| vec![Dof::default(); count]);
        if each.len() != count {
            return Err(error::model(ModelError::WrongLength {
                what: format!("joint {:?}", self.joint),
                quantity: "list of degrees of freedom (dofs)",
                count: each.len(),
                needed: count,
                why: "",
            }));
        }
        let each = each.into_iter().enumerate();
        each.map(|(row, dof)| self.dof(row, dof, &all)).collect()
    }
    fn dof(&self, row: usize, dof: Dof, all: &Dof) -> PyResult<Dof> {
        if let Some(twice) = all.given().find(|option| dof.given().any(|o| o == *option)) {
            let message = format!(
                "{twice} is given for all degrees of freedom, and in dofs for number {row}; give it once"
            );
            return Err(self.refused(&message));
        }
        let dof = dof.or(all);
        if dof.rest.is_some() && dof.stiffness.is_none() {
            return Err(self.refused("a spring has a rest and no stiffness; give both"));
        }
        Ok(dof)
    }
    fn refused(&self, why: &str) -> PyErr {
        error::value(format!("joint {:?}: {why}", self.joint))
    }
}
