//! `align` of a free joint and the compiler's `alignfree` (XML reference, "body/freejoint"): the frame of a body that flies
//! alone is that of its inertia.
//!
//! Coordinates of the joint, and what other sections say in the body's frame, are in that frame, as in MuJoCo; what stands in
//! the body stays where it is.

use super::Context;
use super::content::Content;
use super::geom::Geom;
use super::inertial;
use super::joint::{FileJoint, Kind};
use super::principal_frame;
use crate::error::FormatError;
use glam::DQuat;
use model::{MassProperties, Pose};

/// Where the frame that the body gets lies in the one that it had, in which all this is given, and then no longer.
pub(super) fn apply(
    joints: &[FileJoint],
    contents: &mut [Content],
    geoms: &mut [Geom],
    mass: &mut MassProperties,
    context: &Context<'_>,
) -> Result<Pose, FormatError> {
    if !is_asked(joints, contents, context)? {
        return Ok(Pose::IDENTITY);
    }
    let frame = Pose::new(mass.center, axes(contents, geoms, mass, context)?);
    let seen = frame.inverse();
    *mass = mass.placed(&seen);
    for geom in geoms {
        geom.shape.pose = seen * geom.shape.pose;
    }
    for content in contents {
        content.frame = seen * content.frame;
    }
    Ok(frame)
}

/// Not of bodies that carry others.
fn is_asked(
    joints: &[FileJoint],
    contents: &[Content],
    context: &Context<'_>,
) -> Result<bool, FormatError> {
    let [joint] = joints else {
        return Ok(false);
    };
    let word = joint.element.word("align", &["true", "false", "auto"])?;
    let is_wanted = match word {
        Some("true") => true,
        Some("false") => false,
        _ => context.compiler.align_free,
    };
    let carries = contents.iter().any(|content| content.is(&["body"]));
    Ok(is_wanted && joint.kind == Kind::Free && !carries)
}

/// The principal axes: as they are given, where one element gives them.
fn axes(
    contents: &[Content],
    geoms: &[Geom],
    mass: &MassProperties,
    context: &Context<'_>,
) -> Result<DQuat, FormatError> {
    let heavy: Vec<_> = geoms.iter().filter_map(|geom| geom.axes).collect();
    let inertial = contents.iter().find(|content| content.is(&["inertial"]));
    match (&heavy[..], inertial) {
        ([axes], _) => Ok(*axes),
        ([], Some(given)) => {
            inertial::axes(given.element, given.frame, mass.inertia, &context.compiler)
        }
        _ => Ok(principal_frame::of(mass.inertia).1),
    }
}
