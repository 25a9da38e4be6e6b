//! `<worldbody>` and `<body>`: the kinematic tree (XML reference, "(world)body").

use super::Context;
use super::geom::{self, Geom, Weight};
use super::inertial;
use super::joint::{self, FileJoint, Kind};
use super::orientation::pose;
use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;
use model::{Body, BodyId, BodyKind, JointId, Parts, Pose};
use std::collections::HashMap;

const KNOWN: &[&str] = &[
    "name", "childclass", "mocap", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler",
    "gravcomp", "sleep", "simple", "fuse", "user",
];
const FRAME: &[&str] =
    &["name", "childclass", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler"];

/// The tree as it is read, with what other sections look up in it.
pub(super) struct Tree {
    pub parts: Parts,
    /// The element of each body.
    pub elements: Vec<Element>,
    /// Joints in MuJoCo's order, which is also the order of the coordinates.
    pub joints: Vec<TreeJoint>,
    pub sites: HashMap<String, (Option<BodyId>, Pose)>,
    bodies: HashMap<String, Option<BodyId>>,
    joint_rows: HashMap<String, usize>,
    /// contype and conaffinity of the colliding geoms, and whether they move.
    pub masks: Vec<(i64, i64, bool)>,
}

/// A joint of the file, and where it is in the model.
pub(super) struct TreeJoint {
    pub file: FileJoint,
    pub joint: JointId,
    /// The first of its degrees of freedom in that joint.
    pub dof: usize,
}

/// A body that is still to be read.
struct Visit<'a> {
    element: &'a Element,
    parent: Option<BodyId>,
    /// The parent's pose in the world.
    parent_pose: Pose,
    /// The frame the body stands in, in its parent.
    frame: Pose,
    class: Option<&'a str>,
}

/// A child of a body, out of the frames that wrap it.
struct Content<'a> {
    element: &'a Element,
    frame: Pose,
    class: Option<&'a str>,
}

impl Tree {
    pub fn read(
        root: &Element,
        context: &Context,
        report: &mut Report,
    ) -> Result<Self, FormatError> {
        let mut tree = Self {
            parts: Parts::default(),
            elements: Vec::new(),
            joints: Vec::new(),
            sites: HashMap::new(),
            bodies: HashMap::from([("world".to_owned(), None)]),
            joint_rows: HashMap::new(),
            masks: Vec::new(),
        };
        for world in root.children_named("worldbody") {
            let mut waiting = tree.read_world(world, context, report)?;
            while let Some(visit) = waiting.pop() {
                waiting.extend(tree.read_body(&visit, context, report)?);
            }
        }
        Ok(tree)
    }

    /// Reads what stands directly in the world; gives its bodies, the last one first.
    fn read_world<'a>(
        &mut self,
        world: &'a Element,
        context: &Context,
        report: &mut Report,
    ) -> Result<Vec<Visit<'a>>, FormatError> {
        let contents = contents(world, world.get("childclass"), context, report)?;
        if let Some(content) = contents.iter().find(|c| is_joint(c.element) || is_inertial(c)) {
            return Err(content.element.invalid(
                "the world does not move and has no mass",
                "put this into a body",
            ));
        }
        let geoms = geoms(&contents, Weight::Unused, context, report)?;
        self.add_shapes(geoms, None, false);
        self.add_others(&contents, None, context, report)?;
        Ok(visits(&contents, None, Pose::IDENTITY))
    }

    /// Reads a body without its child bodies; gives those, the last one first.
    fn read_body<'a>(
        &mut self,
        visit: &Visit<'a>,
        context: &Context,
        report: &mut Report,
    ) -> Result<Vec<Visit<'a>>, FormatError> {
        let element = visit.element;
        report.check_attributes(element, KNOWN, &[])?;
        check_body_physics(element, visit, report)?;
        let class = class(element, visit.class, context)?;
        let contents = contents(element, class, context, report)?;
        let local = visit.frame * pose(element, &context.compiler)?;
        let pose = visit.parent_pose * local;
        let id = BodyId(self.parts.bodies.len());
        let parent_moves = visit.parent.is_some_and(|p| self.body(p).kind == BodyKind::Dynamic);
        let joints = joints(&contents, context, report)?;
        let moves = parent_moves || !joints.is_empty();

        let inertials: Vec<&Content> = contents.iter().filter(|c| is_inertial(c)).collect();
        if let [_, second, ..] = inertials[..] {
            return Err(second.element.invalid("the body has two of these", "keep one"));
        }
        let inertial = inertials.first().map(|c| (c.element, c.frame));
        let weight = match inertial::from_geoms(&context.compiler, inertial.is_some()) {
            false => Weight::Unused,
            true if moves => Weight::Needed,
            true => Weight::Wanted,
        };
        let geoms = geoms(&contents, weight, context, report)?;
        let properties = inertial::of_body(element, inertial, &geoms, &context.compiler, report)?;
        self.claim_name(element, id)?;
        self.elements.push(shallow(element));
        self.parts.bodies.push(Body {
            kind: if moves { BodyKind::Dynamic } else { BodyKind::Static },
            pose,
            mass: properties.mass,
            center: properties.center,
            inertia: properties.inertia,
            group: if moves { 1 } else { -1 },
            ..Body::new(element.get("name").unwrap_or_default())
        });
        if moves {
            let ends = (visit.parent, id);
            self.parts.joints.push(joint::assemble(element, &joints, ends, local, pose)?);
            self.add_joints(joints)?;
        }
        self.add_shapes(geoms, Some(id), moves);
        self.add_others(&contents, Some(id), context, report)?;
        Ok(visits(&contents, Some(id), pose))
    }

    fn body(&self, id: BodyId) -> &Body {
        &self.parts.bodies[id.0]
    }

    fn claim_name(&mut self, element: &Element, id: BodyId) -> Result<(), FormatError> {
        let Some(name) = element.get("name").filter(|name| !name.is_empty()) else {
            return Ok(());
        };
        match self.bodies.insert(name.to_owned(), Some(id)) {
            None => Ok(()),
            Some(_) => Err(taken(element, "body", name)),
        }
    }

    fn add_joints(&mut self, joints: Vec<FileJoint>) -> Result<(), FormatError> {
        let (joint, mut dof) = (JointId(self.parts.joints.len() - 1), 0);
        for file in joints {
            if let Some(name) = file.element.get("name") {
                let row = self.joints.len();
                if self.joint_rows.insert(name.to_owned(), row).is_some() {
                    return Err(taken(&file.element, "joint", name));
                }
            }
            let first = dof;
            dof += file.kind.degrees_of_freedom();
            self.joints.push(TreeJoint { file, joint, dof: first });
        }
        Ok(())
    }

    fn add_shapes(&mut self, geoms: Vec<Geom>, body: Option<BodyId>, moves: bool) {
        for Geom { mut shape, masks, .. } in geoms {
            shape.body = body;
            if shape.collides {
                self.masks.push((masks.0, masks.1, moves));
            }
            self.parts.shapes.push(shape);
        }
    }

    /// Reads sites, and notes or refuses what else a body holds.
    fn add_others(
        &mut self,
        contents: &[Content],
        body: Option<BodyId>,
        context: &Context,
        report: &mut Report,
    ) -> Result<(), FormatError> {
        for content in contents {
            let element = content.element;
            match element.name.as_str() {
                "body" | "geom" | "joint" | "freejoint" | "inertial" => {}
                "site" => {
                    report.note(element, "sites", "used by equality constraints only");
                    let site = context.defaults.apply(element, content.class, &["site"])?;
                    if let Some(name) = site.get("name") {
                        let pose = content.frame * pose(&site, &context.compiler)?;
                        self.sites.insert(name.to_owned(), (body, pose));
                    }
                }
                "camera" => report.note(element, "cameras", "only for seeing; not read"),
                "light" => report.note(element, "lights", "only for seeing; not read"),
                "attach" | "replicate" | "composite" | "flexcomp" | "plugin" => {
                    let remedy = "load the file with MuJoCo and save it: that writes it out";
                    report.refuse(element, &format!("<{}>", element.name), remedy)?;
                }
                _ => return Err(element.invalid("a body holds no such element", "remove it")),
            }
        }
        Ok(())
    }

    /// The joint that an attribute of an element names.
    pub fn joint(&self, element: &Element, attribute: &str) -> Result<&TreeJoint, FormatError> {
        let name = element.require(attribute)?;
        let row = self.joint_rows.get(name).ok_or_else(|| unknown(element, attribute, "joint"))?;
        Ok(&self.joints[*row])
    }

    /// The body that an attribute names; `None` is the world.
    pub fn body_named(
        &self,
        element: &Element,
        attribute: &str,
    ) -> Result<Option<BodyId>, FormatError> {
        let name = element.require(attribute)?;
        self.bodies.get(name).copied().ok_or_else(|| unknown(element, attribute, "body"))
    }

    /// The site that an attribute names: its body, and its pose there.
    pub fn site(
        &self,
        element: &Element,
        attribute: &str,
    ) -> Result<(Option<BodyId>, Pose), FormatError> {
        let name = element.require(attribute)?;
        self.sites.get(name).copied().ok_or_else(|| unknown(element, attribute, "site"))
    }

    /// The pose of a body, or of the world.
    pub fn pose(&self, body: Option<BodyId>) -> Pose {
        body.map_or(Pose::IDENTITY, |id| self.body(id).pose)
    }

    /// Whether a body moves; the world does not.
    pub fn moves(&self, body: Option<BodyId>) -> bool {
        body.is_some_and(|id| self.body(id).kind == BodyKind::Dynamic)
    }
}

fn unknown(element: &Element, attribute: &str, kind: &str) -> FormatError {
    let name = element.get(attribute).unwrap_or_default();
    element.invalid_attribute(
        attribute,
        &format!("names `{name}`, but no {kind} has this name"),
        "correct the name",
    )
}

fn taken(element: &Element, kind: &str, name: &str) -> FormatError {
    element.invalid_attribute(
        "name",
        &format!("is `{name}`, the name of another {kind}"),
        "rename one of them",
    )
}

fn is_joint(element: &Element) -> bool {
    element.name == "joint" || element.name == "freejoint"
}

fn is_inertial(content: &Content) -> bool {
    content.element.name == "inertial"
}

fn shallow(element: &Element) -> Element {
    Element {
        name: element.name.clone(),
        attributes: element.attributes.clone(),
        children: Vec::new(),
        place: element.place.clone(),
    }
}

/// The class that the contents of a body or frame inherit.
fn class<'a>(
    element: &'a Element,
    outer: Option<&'a str>,
    context: &Context,
) -> Result<Option<&'a str>, FormatError> {
    let own = element.get("childclass");
    if own.is_some() {
        context.defaults.row(element, "childclass")?;
    }
    Ok(own.or(outer))
}

fn check_body_physics(
    element: &Element,
    visit: &Visit,
    report: &mut Report,
) -> Result<(), FormatError> {
    if element.number("gravcomp")?.unwrap_or(0.0) != 0.0 {
        report.refuse(element, "gravity compensation", "set gravcomp to 0")?;
    }
    if element.truth("mocap")? == Some(true) {
        if visit.parent.is_some() {
            let remedy = "move the body to the world";
            return Err(element.invalid_attribute("mocap", "is for children of the world", remedy));
        }
        report.note(element, "mocap", "the body is static");
    }
    Ok(())
}

/// A body's children, those inside frames with the frame's pose and class.
fn contents<'a>(
    element: &'a Element,
    class_here: Option<&'a str>,
    context: &Context,
    report: &mut Report,
) -> Result<Vec<Content<'a>>, FormatError> {
    let outer = |child| Content { element: child, frame: Pose::IDENTITY, class: class_here };
    let mut waiting: Vec<Content> = element.children.iter().rev().map(outer).collect();
    let mut contents = Vec::new();
    while let Some(content) = waiting.pop() {
        if content.element.name != "frame" {
            contents.push(content);
            continue;
        }
        report.check_attributes(content.element, FRAME, &[])?;
        let frame = content.frame * pose(content.element, &context.compiler)?;
        let class = class(content.element, content.class, context)?;
        let inner = content.element.children.iter().rev();
        waiting.extend(inner.map(|element| Content { element, frame, class }));
    }
    Ok(contents)
}

fn geoms(
    contents: &[Content],
    weight: Weight,
    context: &Context,
    report: &mut Report,
) -> Result<Vec<Geom>, FormatError> {
    let mut geoms = Vec::new();
    for content in contents.iter().filter(|c| c.element.name == "geom") {
        let element = context.defaults.apply(content.element, content.class, &["geom"])?;
        geoms.extend(geom::read(&element, content.frame, weight, context, report)?);
    }
    Ok(geoms)
}

fn joints(
    contents: &[Content],
    context: &Context,
    report: &mut Report,
) -> Result<Vec<FileJoint>, FormatError> {
    let mut joints = Vec::new();
    for content in contents.iter().filter(|c| is_joint(c.element)) {
        let element = match content.element.name.as_str() {
            "freejoint" => shallow(content.element),
            _ => context.defaults.apply(content.element, content.class, &["joint"])?,
        };
        let joint = joint::read(element, content.frame, context, report)?;
        if joint.kind == Kind::Free && content.frame != Pose::IDENTITY {
            let remedy = "put the frame around the body instead";
            return Err(joint.element.invalid("a free joint stands in a frame", remedy));
        }
        joints.push(joint);
    }
    Ok(joints)
}

fn visits<'a>(contents: &[Content<'a>], parent: Option<BodyId>, pose: Pose) -> Vec<Visit<'a>> {
    let bodies = contents.iter().rev().filter(|c| c.element.name == "body");
    bodies
        .map(|content| Visit {
            element: content.element,
            parent,
            parent_pose: pose,
            frame: content.frame,
            class: content.class,
        })
        .collect()
}
