//! What stands in a body, out of the `<frame>`s that wrap it (XML reference, "frame").

use super::Context;
use super::geom::{self, Geom, Weight};
use super::joint::{self, FileJoint};
use super::orientation::pose;
use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;
use model::Pose;

const FRAME: &[&str] = &[
    "name",
    "childclass",
    "pos",
    "quat",
    "axisangle",
    "xyaxes",
    "zaxis",
    "euler",
];

/// A child of a body.
pub(super) struct Content<'a> {
    pub element: &'a Element,
    /// The frame it stands in, in the body.
    pub frame: Pose,
    /// The class it inherits.
    pub class: Option<&'a str>,
}

impl Content<'_> {
    /// Whether it is an element of one of these names.
    pub fn is(&self, names: &[&str]) -> bool {
        names.contains(&self.element.name.as_str())
    }
}

/// The class that the contents of a body or frame inherit.
pub(super) fn class<'a>(
    element: &'a Element,
    outer: Option<&'a str>,
    context: &Context<'_>,
) -> Result<Option<&'a str>, FormatError> {
    let own = element.get("childclass");
    if own.is_some() {
        context.defaults.row(element, "childclass")?;
    }
    Ok(own.or(outer))
}

/// A body's children, those inside frames with the frame's pose and class.
pub(super) fn of<'a>(
    element: &'a Element,
    class_here: Option<&'a str>,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<Vec<Content<'a>>, FormatError> {
    let direct = |element| Content {
        element,
        frame: Pose::IDENTITY,
        class: class_here,
    };
    let mut waiting: Vec<Content> = element.children.iter().rev().map(direct).collect();
    let mut contents = Vec::new();
    while let Some(content) = waiting.pop() {
        if !content.is(&["frame"]) {
            contents.push(content);
            continue;
        }
        report.check_attributes(content.element, FRAME, &[])?;
        let frame = content.frame * pose(content.element, &context.compiler)?;
        let class = class(content.element, content.class, context)?;
        let inner = content.element.children.iter().rev();
        waiting.extend(inner.map(|element| Content {
            element,
            frame,
            class,
        }));
    }
    Ok(contents)
}

/// The geoms among them.
pub(super) fn geoms(
    contents: &[Content],
    weight: Weight,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<Vec<Geom>, FormatError> {
    let mut geoms = Vec::new();
    for content in contents.iter().filter(|content| content.is(&["geom"])) {
        let element = context
            .defaults
            .apply(content.element, content.class, &["geom"])?;
        geoms.extend(geom::read(element, content.frame, weight, context, report)?);
    }
    Ok(geoms)
}

/// The joints among them.
pub(super) fn joints(
    contents: &[Content],
    context: &Context<'_>,
    report: &mut Report,
) -> Result<Vec<FileJoint>, FormatError> {
    let mut joints = Vec::new();
    for content in contents
        .iter()
        .filter(|content| content.is(&["joint", "freejoint"]))
    {
        // A freejoint inherits nothing.
        let element = match content.is(&["freejoint"]) {
            true => content.element.shallow(),
            false => context
                .defaults
                .apply(content.element, content.class, &["joint"])?,
        };
        joints.push(joint::read(element, content.frame, context, report)?);
    }
    Ok(joints)
}
