//! The keywords that bodies take.

use crate::count::mask;
use crate::keywords::{Keywords, Place};
use glam::{DMat3, DVec3};
use kinetarium::model::{BodyDraft, Shape};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Their names, as in the type stubs' `BodyOptions`.
const KNOWN: [&str; 10] = [
    "position",
    "orientation",
    "mass",
    "inertia",
    "center",
    "static",
    "group",
    "membership",
    "collides_with",
    "world",
];

/// What a body is given, checked before it is made or changed.
pub struct BodyOptions {
    shapes: Vec<Shape>,
    place: Place,
    mass: Option<f64>,
    /// About the centre.
    inertia: Option<(DVec3, DMat3)>,
    immovable: bool,
    group: Option<i32>,
    membership: Option<u32>,
    collides_with: Option<u32>,
    world: Option<i32>,
}

impl BodyOptions {
    /// For a body that stands already, or not yet.
    pub fn read(
        name: &str,
        shapes: Option<&Bound<'_, PyAny>>,
        options: Option<&Bound<'_, PyDict>>,
        stands: Option<&BodyDraft>,
    ) -> PyResult<Self> {
        let what = format!("body {name:?}");
        let keywords = Keywords::new(&what, "option of bodies", &KNOWN, options)?;
        let was_static = stands.is_some_and(BodyDraft::is_static);
        let is_static = keywords.get("static")?.unwrap_or(was_static);
        if was_static && !is_static {
            return Err(keywords.refused("it is static, and stays so: make another body"));
        }
        let mass = keywords.get("mass")?;
        Ok(Self {
            shapes: shapes.map_or_else(|| Ok(Vec::new()), |s| crate::shape::shapes(s, &what))?,
            place: keywords.place()?,
            mass,
            inertia: inertia(&keywords, is_static, mass.is_some())?,
            immovable: is_static && !was_static,
            group: keywords.get("group")?,
            membership: bits(&keywords, &what, "membership")?,
            collides_with: bits(&keywords, &what, "collides_with")?,
            world: keywords.get("world")?,
        })
    }

    /// Gives the body all of it.
    pub fn shape(self, draft: &mut BodyDraft) {
        draft.at(self.place.moved(draft.pose()));
        for shape in self.shapes {
            draft.shape(shape);
        }
        match (self.mass, self.inertia) {
            (Some(mass), Some((center, inertia))) => draft.inertia(mass, center, inertia),
            (Some(mass), None) => draft.mass(mass),
            (None, _) => draft,
        };
        if self.immovable {
            draft.immovable();
        }
        if let Some(group) = self.group {
            draft.group(group);
        }
        if self.membership.is_some() || self.collides_with.is_some() {
            let (membership, collides_with) = draft.masks().unwrap_or((1, 1));
            draft.collision_masks(
                self.membership.unwrap_or(membership),
                self.collides_with.unwrap_or(collides_with),
            );
        }
        if let Some(world) = self.world {
            draft.world(world);
        }
    }
}

/// Centre of mass and inertia, which go with a mass; what is static has none of them.
fn inertia(
    keywords: &Keywords<'_, '_>,
    is_static: bool,
    mass: bool,
) -> PyResult<Option<(DVec3, DMat3)>> {
    let inertia: Option<[[f64; 3]; 3]> = keywords.numbers("inertia", "3 rows of 3 numbers")?;
    let center: Option<[f64; 3]> = keywords.numbers("center", "3 numbers")?;
    if is_static && (mass || inertia.is_some() || center.is_some()) {
        return Err(keywords.refused("it is static: leave out mass, inertia and center"));
    }
    if inertia.is_some() && !mass {
        return Err(keywords.refused("it has an inertia and no mass: give both"));
    }
    if center.is_some() && inertia.is_none() {
        let why = "it has a center and no inertia: give mass, center and inertia, or let the center follow from the \
                   shapes";
        return Err(keywords.refused(why));
    }
    Ok(inertia.map(|rows| {
        let center = DVec3::from_array(center.unwrap_or_default());
        (center, DMat3::from_cols_array_2d(&rows).transpose())
    }))
}

/// Kinds, a bit each.
fn bits(keywords: &Keywords<'_, '_>, what: &str, name: &'static str) -> PyResult<Option<u32>> {
    let bits: Option<i64> = keywords.get(name)?;
    bits.map(|bits| mask(what, name, bits)).transpose()
}
