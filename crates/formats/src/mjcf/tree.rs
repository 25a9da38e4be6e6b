//! The kinematic tree as it grows, and what other sections look up in it by name.

use super::geom::Geom;
use super::joint::FileJoint;
use super::surface::Surface;
use crate::error::FormatError;
use crate::xml::Element;
use model::{Body, BodyId, BodyKind, Joint, JointId, Parts, Pose, ShapeId, similar_name};
use std::collections::{BTreeSet, HashMap};

/// The tree of a file.
pub(super) struct Tree {
    pub parts: Parts,
    /// The element of each body.
    pub elements: Vec<Element>,
    /// Joints in MuJoCo's order, which is also the order of the coordinates.
    pub joints: Vec<TreeJoint>,
    /// The parent of each body; `None` is the world.
    pub parents: Vec<Option<BodyId>>,
    /// The surface of each shape.
    pub surfaces: Vec<Surface>,
    body_names: HashMap<String, Option<BodyId>>,
    joint_names: HashMap<String, usize>,
    geom_names: HashMap<String, ShapeId>,
    sites: HashMap<String, (Option<BodyId>, Pose)>,
}

/// A joint of the file, and where it is in the model.
pub(super) struct TreeJoint {
    pub file: FileJoint,
    pub joint: JointId,
    /// The first of its degrees of freedom in that joint.
    pub dof: usize,
}

impl Tree {
    /// The world, empty.
    pub fn new() -> Self {
        Self {
            parts: Parts::default(),
            elements: Vec::new(),
            joints: Vec::new(),
            parents: Vec::new(),
            surfaces: Vec::new(),
            body_names: HashMap::from([("world".to_owned(), None)]),
            joint_names: HashMap::new(),
            geom_names: HashMap::new(),
            sites: HashMap::new(),
        }
    }

    /// Adds a body and its element.
    pub fn add_body(
        &mut self,
        body: Body,
        parent: Option<BodyId>,
        element: &Element,
    ) -> Result<BodyId, FormatError> {
        let id = BodyId(self.parts.bodies.len());
        let name = body.name.clone();
        self.parts.bodies.push(body);
        self.elements.push(element.shallow());
        self.parents.push(parent);
        if !name.is_empty() && self.body_names.insert(name.clone(), Some(id)).is_some() {
            return Err(taken(element, "body", &name));
        }
        Ok(id)
    }

    /// Adds the joint that a body's joints make together.
    pub fn add_joint(&mut self, joint: Joint, files: Vec<FileJoint>) -> Result<(), FormatError> {
        let id = JointId(self.parts.joints.len());
        self.parts.joints.push(joint);
        let mut next = 0;
        for file in files {
            if let Some(name) = file.element.get("name").filter(|name| !name.is_empty()) {
                let row = self.joints.len();
                if self.joint_names.insert(name.to_owned(), row).is_some() {
                    return Err(taken(&file.element, "joint", name));
                }
            }
            let dof = next;
            next += file.kind.degrees_of_freedom();
            self.joints.push(TreeJoint {
                file,
                joint: id,
                dof,
            });
        }
        Ok(())
    }

    /// Adds the shapes of a body, or of the world.
    pub fn add_shapes(
        &mut self,
        geoms: Vec<Geom>,
        body: Option<BodyId>,
    ) -> Result<(), FormatError> {
        for geom in geoms {
            let id = ShapeId(self.parts.shapes.len());
            let mut shape = geom.shape;
            shape.body = body;
            let name = shape.name.clone();
            if !name.is_empty() && self.geom_names.insert(name.clone(), id).is_some() {
                return Err(taken(&geom.element, "geom", &name));
            }
            self.parts.shapes.push(shape);
            self.surfaces.push(geom.surface);
        }
        Ok(())
    }

    /// Adds a site of a body, or of the world; one without a name is nowhere asked for.
    pub fn add_site(
        &mut self,
        element: &Element,
        body: Option<BodyId>,
        pose: Pose,
    ) -> Result<(), FormatError> {
        let name = element.get("name").unwrap_or_default();
        if !name.is_empty() && self.sites.insert(name.to_owned(), (body, pose)).is_some() {
            return Err(taken(element, "site", name));
        }
        Ok(())
    }

    /// The joint that an attribute of an element names.
    pub fn joint(&self, element: &Element, attribute: &str) -> Result<&TreeJoint, FormatError> {
        let row = self.joint_names.get(element.require(attribute)?);
        let names = self.joint_names.keys().map(String::as_str);
        let row = row.ok_or_else(|| unknown(element, attribute, "joint", names))?;
        Ok(&self.joints[*row])
    }

    /// The body that an attribute names; `None` is the world.
    pub fn body(&self, element: &Element, attribute: &str) -> Result<Option<BodyId>, FormatError> {
        let body = self.body_names.get(element.require(attribute)?);
        let names = self.body_names.keys().map(String::as_str);
        body.copied()
            .ok_or_else(|| unknown(element, attribute, "body", names))
    }

    /// The shape of the geom that an attribute names.
    pub fn geom(&self, element: &Element, attribute: &str) -> Result<ShapeId, FormatError> {
        let shape = self.geom_names.get(element.require(attribute)?);
        let names = self.geom_names.keys().map(String::as_str);
        shape
            .copied()
            .ok_or_else(|| unknown(element, attribute, "geom", names))
    }

    /// The site that an attribute names: its body, and its pose there.
    pub fn site(
        &self,
        element: &Element,
        attribute: &str,
    ) -> Result<(Option<BodyId>, Pose), FormatError> {
        let site = self.sites.get(element.require(attribute)?);
        let names = self.sites.keys().map(String::as_str);
        site.copied()
            .ok_or_else(|| unknown(element, attribute, "site", names))
    }

    /// The pose of a body, or of the world.
    pub fn pose(&self, body: Option<BodyId>) -> Pose {
        body.map_or(Pose::IDENTITY, |id| self.parts.bodies[id.0].pose)
    }

    /// Whether a body moves; the world does not.
    pub fn moves(&self, body: Option<BodyId>) -> bool {
        body.is_some_and(|id| self.parts.bodies[id.0].kind == BodyKind::Dynamic)
    }
}

/// No such name among those that there are.
pub(super) fn unknown<'a>(
    element: &Element,
    attribute: &str,
    kind: &str,
    names: impl Iterator<Item = &'a str>,
) -> FormatError {
    let name = element.get(attribute).unwrap_or_default();
    // In an order of their own, so that of several equally alike names the same is offered each time.
    let names: BTreeSet<&str> = names.collect();
    let remedy = match similar_name(name, names) {
        Some(alike) => format!("did you mean `{alike}`?"),
        None => "correct the name".to_owned(),
    };
    let problem = format!("names `{name}`, but no {kind} has this name");
    element.invalid_attribute(attribute, &problem, &remedy)
}

/// Names are unique among elements of a type.
pub(super) fn taken(element: &Element, kind: &str, name: &str) -> FormatError {
    element.invalid_attribute(
        "name",
        &format!("is `{name}`, the name of another {kind}"),
        "rename one of them",
    )
}
