//! `<camera>` (XML reference, "camera").

use super::Context;
use super::content::Content;
use super::orientation::{ORIENTATIONS, pose};
use super::tree::Tree;
use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;
use glam::DVec2;
use model::{BodyId, Camera, CameraMode, Pose};

pub(super) const KNOWN: &[&str] = &[
    "name",
    "class",
    "mode",
    "target",
    "projection",
    "pos",
    "fovy",
    "resolution",
    "sensorsize",
    "focal",
    "focalpixel",
    "user",
];
/// What is left out of a camera, and what that means.
pub(super) const UNUSED: &[(&str, &str)] = &[
    (
        "principal",
        "the optical axis is in the middle of the image",
    ),
    (
        "principalpixel",
        "the optical axis is in the middle of the image",
    ),
    ("ipd", "cameras have one eye"),
    ("output", "channels are chosen when an image is made"),
];
/// MuJoCo's own field of view [°].
const FIELD_OF_VIEW: f64 = 45.0;

/// Adds a camera of a body, or of the world; notes one that cannot be had.
pub(super) fn read(
    content: &Content,
    body: Option<BodyId>,
    tree: &mut Tree,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<(), FormatError> {
    let defaults = &context.defaults;
    let element = defaults.apply(content.element, content.class, &["camera"])?;
    report.check_attributes(&element, &[KNOWN, ORIENTATIONS].concat(), UNUSED)?;
    if element.get("projection") == Some("orthographic") {
        report.note(&element, "orthographic cameras", "not read");
        return Ok(());
    }
    let local = content.frame * pose(&element, &context.compiler)?;
    let Some((mode, pose)) = mounted("cameras", &element, local, body, tree, report)? else {
        return Ok(());
    };
    tree.parts.cameras.push(Camera {
        name: element.get("name").unwrap_or_default().to_owned(),
        body,
        mode,
        pose,
        field_of_view: field_of_view(&element)?,
        size: size(&element)?,
    });
    Ok(())
}

/// How cameras or lights go along with a body, in whose frame they are placed so, and their pose, as that says;
/// notes what cannot be had.
pub(super) fn mounted(
    kind: &str,
    element: &Element,
    local: Pose,
    body: Option<BodyId>,
    tree: &Tree,
    report: &mut Report,
) -> Result<Option<(CameraMode, Pose)>, FormatError> {
    let modes = ["fixed", "track", "trackcom", "targetbody", "targetbodycom"];
    // Its offset and orientation are those of the initial state.
    let track = || (CameraMode::Track, along_world(&tree.pose(body), &local));
    Ok(match element.word("mode", &modes)?.unwrap_or("fixed") {
        "fixed" => Some((CameraMode::Fixed, local)),
        "track" => Some(track()),
        "trackcom" => {
            let meaning = "it goes along with its body's origin, not with the centre of mass";
            report.note(element, "mode `trackcom`", meaning);
            Some(track())
        }
        other => {
            let what = format!("{kind} of mode `{other}`");
            let meaning = format!("not read: {kind} do not turn by themselves");
            report.note(element, &what, &meaning);
            None
        }
    })
}

/// A pose in a body's frame, from the body's origin along world axes.
fn along_world(body: &Pose, local: &Pose) -> Pose {
    let turned = Pose::new(glam::DVec3::ZERO, body.orientation);
    turned * *local
}

/// Angle from the upper to the lower edge [rad]: `fovy`, or, of a sensor of height s behind a lens of focal
/// length f, 2 atan(s/2f).
fn field_of_view(element: &Element) -> Result<f64, FormatError> {
    let pair = |name: &str| Ok(element.numbers::<2>(name)?.map(DVec2::from_array));
    let angle = match pair("sensorsize")? {
        Some(sensor) => {
            let pixels = pair("resolution")?.unwrap_or(DVec2::ONE);
            let focal = match pair("focalpixel")? {
                Some(focal) => Some(focal * sensor / pixels),
                None => pair("focal")?,
            };
            let focal = focal.ok_or_else(|| {
                element.invalid(
                    "the sensor has no focal length",
                    "give `focal` or `focalpixel`",
                )
            })?;
            2.0 * (0.5 * sensor.y).atan2(focal.y)
        }
        // In degrees, whatever other angles are in.
        None => element
            .number("fovy")?
            .unwrap_or(FIELD_OF_VIEW)
            .to_radians(),
    };
    Ok(angle)
}

/// Pixels of a row, and rows, where they are given: MuJoCo's own is one pixel.
fn size(element: &Element) -> Result<Option<[u32; 2]>, FormatError> {
    let size = element.numbers::<2>("resolution")?;
    // A number that is no size becomes 0, which the model refuses.
    Ok(size.map(|size| size.map(|side| side as u32)))
}
