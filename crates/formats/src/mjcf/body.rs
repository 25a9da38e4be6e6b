//! `<worldbody>` and `<body>`: the kinematic tree (XML reference, "(world)body").

use super::Context;
use super::align;
use super::camera;
use super::content::{self, Content};
use super::geom::{Geom, Weight};
use super::inertial;
use super::joint;
use super::light;
use super::orientation::pose;
use super::site;
use super::tree::Tree;
use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;
use glam::DVec3;
use model::{Body, BodyId, BodyKind, Geometry, MassProperties, Pose};

const KNOWN: &[&str] = &[
    "name",
    "childclass",
    "mocap",
    "pos",
    "quat",
    "axisangle",
    "xyaxes",
    "zaxis",
    "euler",
    "gravcomp",
    "sleep",
    "simple",
    "fuse",
    "user",
];
/// Elements that MuJoCo's compiler turns into others.
pub(super) const GENERATORS: &[&str] = &["attach", "replicate", "composite", "flexcomp", "plugin"];

/// A body that is still to be read.
struct Visit<'a> {
    element: &'a Element,
    parent: Option<BodyId>,
    /// The frame the body stands in, in its parent.
    frame: Pose,
    class: Option<&'a str>,
}

/// Reads all bodies, every parent before its children.
pub(super) fn read(
    root: &Element,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<Tree, FormatError> {
    let mut tree = Tree::new();
    for world in root.children_named("worldbody") {
        let mut waiting = read_world(world, &mut tree, context, report)?;
        while let Some(visit) = waiting.pop() {
            waiting.extend(read_body(&visit, &mut tree, context, report)?);
        }
    }
    Ok(tree)
}

/// Reads what stands directly in the world; gives its bodies, the last one first.
fn read_world<'a>(
    world: &'a Element,
    tree: &mut Tree,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<Vec<Visit<'a>>, FormatError> {
    let class = content::class(world, None, context)?;
    let contents = content::of(world, class, context, report)?;
    if let Some(wrong) = contents
        .iter()
        .find(|c| c.is(&["joint", "freejoint", "inertial"]))
    {
        let remedy = "put this into a body";
        return Err(wrong
            .element
            .invalid("the world does not move and has no mass", remedy));
    }
    tree.add_shapes(
        content::geoms(&contents, Weight::Unused, context, report)?,
        None,
    )?;
    read_others(&contents, None, tree, context, report)?;
    Ok(visits(&contents, None))
}

/// Reads a body without its child bodies; gives those, the last one first.
fn read_body<'a>(
    visit: &Visit<'a>,
    tree: &mut Tree,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<Vec<Visit<'a>>, FormatError> {
    let element = visit.element;
    report.check_attributes(element, KNOWN, &[])?;
    let class = content::class(element, visit.class, context)?;
    let mut contents = content::of(element, class, context, report)?;
    let joints = content::joints(&contents, context, report)?;
    let moves = tree.moves(visit.parent) || !joints.is_empty();
    check_physics(element, visit.parent, moves, context, report)?;
    let (mut mass, mut geoms) = weigh(element, &contents, moves, context, report)?;
    let aligned = align::apply(&joints, &mut contents, &mut geoms, &mut mass, context)?;
    let local = visit.frame * pose(element, &context.compiler)? * aligned;
    let pose = tree.pose(visit.parent) * local;
    let body = Body {
        kind: if moves {
            BodyKind::Dynamic
        } else {
            BodyKind::Static
        },
        pose,
        mass: mass.mass,
        center: mass.center,
        inertia: mass.inertia,
        group: if moves { 1 } else { -1 },
        ..Body::new(element.get("name").unwrap_or_default())
    };
    let id = tree.add_body(body, visit.parent, element)?;
    if moves {
        note_planes(&geoms, report);
        let joint = joint::assemble(element, &joints, (visit.parent, id), local, pose)?;
        tree.add_joint(joint, joints)?;
    }
    tree.add_shapes(geoms, Some(id))?;
    read_others(&contents, Some(id), tree, context, report)?;
    Ok(visits(&contents, Some(id)))
}

fn check_physics(
    element: &Element,
    parent: Option<BodyId>,
    moves: bool,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<(), FormatError> {
    let has_weight = moves && context.physics.gravity != DVec3::ZERO;
    if element.number("gravcomp")?.unwrap_or(0.0) != 0.0 && has_weight {
        report.refuse(element, "gravity compensation", "set gravcomp to 0")?;
    }
    if element.truth("mocap")? == Some(true) {
        if parent.is_some() {
            let remedy = "move the body to the world";
            return Err(element.invalid_attribute("mocap", "is for children of the world", remedy));
        }
        if moves {
            let remedy = "remove its joints, or `mocap`";
            return Err(element.invalid_attribute("mocap", "is for bodies without joints", remedy));
        }
        report.note(element, "mocap", "the body is static");
    }
    Ok(())
}

fn note_planes(geoms: &[Geom], report: &mut Report) {
    let is_plane = |geom: &&Geom| matches!(geom.shape.geometry, Geometry::Plane { .. });
    for plane in geoms.iter().filter(is_plane) {
        let meaning = "a half space that goes along with it; MuJoCo refuses it";
        report.note(&plane.element, "a plane of a body that moves", meaning);
    }
}

/// A body's mass properties, and its geoms.
fn weigh(
    body: &Element,
    contents: &[Content],
    moves: bool,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<(MassProperties, Vec<Geom>), FormatError> {
    let inertials: Vec<_> = contents.iter().filter(|c| c.is(&["inertial"])).collect();
    if let [_, second, ..] = inertials[..] {
        return Err(second
            .element
            .invalid("the body has two of these", "keep one"));
    }
    let inertial = inertials.first().map(|c| (c.element, c.frame));
    let weight = match inertial::from_geoms(&context.compiler, inertial.is_some()) {
        false => Weight::Unused,
        // A total that is set is that of static bodies, too.
        true if moves || context.compiler.total_mass.is_some() => Weight::Needed,
        true => Weight::Wanted,
    };
    let geoms = content::geoms(contents, weight, context, report)?;
    let mass = inertial::of_body(body, inertial, &geoms, &context.compiler, report)?;
    Ok((mass, geoms))
}

/// Reads sites and cameras, and notes or refuses what else a body holds.
fn read_others(
    contents: &[Content],
    body: Option<BodyId>,
    tree: &mut Tree,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<(), FormatError> {
    for content in contents {
        let element = content.element;
        match element.name.as_str() {
            "body" | "geom" | "joint" | "freejoint" | "inertial" => {}
            "site" => site::read(content, body, tree, context, report)?,
            "camera" => camera::read(content, body, tree, context, report)?,
            "light" => light::read(content, body, tree, context, report)?,
            name if GENERATORS.contains(&name) => {
                let remedy = "load the file with MuJoCo and save it: that writes it out";
                report.refuse(element, &format!("<{name}>"), remedy)?;
            }
            _ => return Err(element.invalid("a body holds no such element", "remove it")),
        }
    }
    Ok(())
}

fn visits<'a>(contents: &[Content<'a>], parent: Option<BodyId>) -> Vec<Visit<'a>> {
    let bodies = contents
        .iter()
        .rev()
        .filter(|content| content.is(&["body"]));
    let visit = |c: &Content<'a>| Visit {
        element: c.element,
        parent,
        frame: c.frame,
        class: c.class,
    };
    bodies.map(visit).collect()
}
