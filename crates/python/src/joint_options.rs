//! The keywords that all joints take.

use crate::builder::Body;
use crate::error;
use crate::joint::{Dof, Drive, Limit};
use crate::keywords::{Keywords, Place};
use kinetarium::model::{self, JointDraft, ModelError, Pose};
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

/// What a joint is given, checked before it is made or changed.
pub struct JointOptions {
    pub parent: Option<Body>,
    place: Place,
    /// In the parent and in the child.
    frames: [Option<Pose>; 2],
    initial: Option<Vec<f64>>,
    /// Limits that it has go.
    unlimited: bool,
    dofs: Vec<Dof>,
    linear_compliance: Option<f64>,
    angular_compliance: Option<f64>,
    closes_loop: Option<bool>,
    bodies_collide: Option<bool>,
    enabled: Option<bool>,
}

impl JointOptions {
    /// For a joint with such degrees of freedom.
    pub fn read(
        name: &str,
        dofs: &[model::Dof],
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let what = format!("joint {name:?}");
        let keywords = Keywords::new(&what, "option of joints", &KNOWN, options)?;
        let (place, frames) = (
            keywords.place()?,
            [
                keywords.frame("parent_frame")?,
                keywords.frame("child_frame")?,
            ],
        );
        if place.is_given() && frames != [None, None] {
            let why = "give a joint its frame in the object (position, orientation) or in both bodies (parent_frame, \
                       child_frame), not both";
            return Err(keywords.refused(why));
        }
        Ok(Self {
            parent: keywords.get("parent")?,
            place,
            frames,
            initial: keywords.read("initial", |value| {
                let several = value.extract::<Vec<f64>>();
                several.or_else(|_| {
                    let one = value.extract::<f64>().map(|one| vec![one]);
                    one.map_err(|_| {
                        PyTypeError::new_err("give a number, or one for each coordinate")
                    })
                })
            })?,
            unlimited: keywords.is_taken_away("limit")?,
            dofs: self::dofs(&keywords, &what, dofs)?,
            linear_compliance: keywords.get("linear_compliance")?,
            angular_compliance: keywords.get("angular_compliance")?,
            closes_loop: keywords.get("closes_loop")?,
            bodies_collide: keywords.get("bodies_collide")?,
            enabled: keywords.get("enabled")?,
        })
    }

    /// Gives the joint all of it.
    pub fn shape(self, draft: &mut JointDraft) {
        if let Some(parent) = self.parent {
            draft.parent(parent.handle);
        }
        if self.place.is_given() {
            draft.at(self.place.moved(draft.pose()));
        }
        if self.frames != [None, None] {
            let ([in_parent, in_child], [parent, child]) = (self.frames, draft.body_frames());
            draft.frames(in_parent.unwrap_or(parent), in_child.unwrap_or(child));
        }
        if let Some(initial) = self.initial {
            draft.initial(&initial);
        }
        for (dof, options) in draft.dofs_mut().iter_mut().zip(self.dofs) {
            dof.limit = dof.limit.filter(|_| !self.unlimited);
            options.act(dof);
        }
        let [linear, angular] = draft.compliances();
        draft.compliance(
            self.linear_compliance.unwrap_or(linear),
            self.angular_compliance.unwrap_or(angular),
        );
        if let Some(closes_loop) = self.closes_loop {
            draft.closes_loop(closes_loop);
        }
        if let Some(bodies_collide) = self.bodies_collide {
            draft.bodies_collide(bodies_collide);
        }
        if let Some(enabled) = self.enabled {
            draft.enabled(enabled);
        }
    }
}

/// What acts along each degree of freedom: what is given for it, and what is given for all.
fn dofs(keywords: &Keywords<'_, '_>, what: &str, stand: &[model::Dof]) -> PyResult<Vec<Dof>> {
    let all = Dof {
        name: None,
        limit: keywords.read("limit", Limit::of)?,
        drive: keywords.get::<Drive>("drive")?,
        damping: keywords.get("damping")?,
        stiffness: keywords.get("stiffness")?,
        rest: keywords.get("rest")?,
        armature: keywords.get("armature")?,
        friction_loss: keywords.get("friction_loss")?,
    };
    if let (true, Some(option)) = (stand.is_empty(), all.given().next()) {
        let why =
            format!("it has no degree of freedom that its {option} could act along; leave it out");
        return Err(keywords.refused(&why));
    }
    let each = keywords.get::<Vec<Dof>>("dofs")?;
    let each = each.unwrap_or_else(|| vec![Dof::default(); stand.len()]);
    if each.len() != stand.len() {
        return Err(error::model(ModelError::WrongLength {
            what: what.into(),
            quantity: "list of degrees of freedom (dofs)",
            count: each.len(),
            needed: stand.len(),
            why: "",
        }));
    }
    let each = each.into_iter().zip(stand).enumerate();
    let each = each.map(|(row, (dof, stands))| self::dof(keywords, row, dof, &all, stands));
    each.collect()
}

fn dof(
    keywords: &Keywords<'_, '_>,
    row: usize,
    dof: Dof,
    all: &Dof,
    stands: &model::Dof,
) -> PyResult<Dof> {
    if let Some(twice) = all.given().find(|option| dof.given().any(|o| o == *option)) {
        let why = format!(
            "{twice} is given for all degrees of freedom, and in dofs for number {row}; give it once"
        );
        return Err(keywords.refused(&why));
    }
    let dof = dof.or(all);
    if dof.rest.is_some() && dof.stiffness.unwrap_or(stands.stiffness) == 0.0 {
        return Err(keywords.refused("a spring has a rest and no stiffness; give both"));
    }
    Ok(dof)
}
