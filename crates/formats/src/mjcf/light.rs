//! `<light>` (XML reference, "light"): the one that shines from one direction is the sun.

use super::Context;
use super::content::Content;
use super::tree::Tree;
use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;
use glam::DVec3;
use model::BodyId;

/// A light, and the direction to it where it could be the sun.
pub(super) struct Light {
    element: Element,
    to_sun: Option<DVec3>,
}

/// Remembers a light of a body, or of the world.
pub(super) fn read(
    content: &Content,
    body: Option<BodyId>,
    tree: &mut Tree,
    context: &Context<'_>,
) -> Result<(), FormatError> {
    let defaults = &context.defaults;
    let element = defaults.apply(content.element, content.class, &["light"])?;
    let parallel = element.truth("directional")?.unwrap_or(false)
        || element.get("type") == Some("directional");
    let shines = parallel && element.truth("active")?.unwrap_or(true);
    // A sun does not turn with a robot.
    let stays = body.is_none() && !element.has("target");
    let along = element.vector("dir")?.unwrap_or(DVec3::NEG_Z);
    let to_sun = -content.frame.direction(along);
    let is_sun = shines && stays && to_sun.length() > 0.0;
    tree.lights.push(Light {
        element,
        to_sun: is_sun.then_some(to_sun),
    });
    Ok(())
}

/// Makes the light that is parallel the sun, if there is one only, and notes what is not read.
pub(super) fn finish(tree: &mut Tree, report: &mut Report) {
    let mut suns = tree.lights.iter().filter_map(|light| light.to_sun);
    tree.parts.sun = suns.next().filter(|_| suns.next().is_none());
    let one = tree.parts.sun.is_some();
    for Light { element, to_sun } in &tree.lights {
        if one && to_sun.is_some() {
            report.note(element, "the sun", "only its direction is read");
        } else {
            report.note(element, "lights", "only for seeing; not read");
        }
    }
}
