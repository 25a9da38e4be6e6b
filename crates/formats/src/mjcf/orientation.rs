//! Frames: position, and orientation in MJCF's five forms (modeling guide, "Frame orientations").

use super::compiler::Compiler;
use crate::error::FormatError;
use crate::xml::Element;
use glam::{DMat3, DQuat, DVec3};
use model::Pose;

/// Attributes that give an orientation.
pub(super) const ORIENTATIONS: &[&str] = &["quat", "axisangle", "xyaxes", "zaxis", "euler"];

/// Shorter vectors have no direction.
const LEAST_LENGTH: f64 = 1e-14;

/// The order of Euler rotations: about which axis, and whether that axis turns with the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EulerSequence([(DVec3, bool); 3]);

impl EulerSequence {
    pub fn read(compiler: &Element) -> Result<Self, FormatError> {
        let text = compiler.get("eulerseq").unwrap_or("xyz");
        let axis = |letter: char| match letter.to_ascii_lowercase() {
            'x' => Some((DVec3::X, letter.is_ascii_lowercase())),
            'y' => Some((DVec3::Y, letter.is_ascii_lowercase())),
            'z' => Some((DVec3::Z, letter.is_ascii_lowercase())),
            _ => None,
        };
        let axes: Option<Vec<_>> = text.chars().map(axis).collect();
        axes.and_then(|axes| axes.try_into().ok())
            .map(Self)
            .ok_or_else(|| {
                compiler.invalid_attribute(
                "eulerseq",
                &format!("is `{text}`"),
                "write three letters of x, y, z (axes that turn along) or X, Y, Z (axes that stay)",
            )
            })
    }

    /// The rotation of three angles [rad].
    pub fn rotation(&self, angles: [f64; 3]) -> DQuat {
        self.0
            .iter()
            .zip(angles)
            .fold(DQuat::IDENTITY, |q, ((axis, turns), angle)| {
                let step = DQuat::from_axis_angle(*axis, angle);
                if *turns { q * step } else { step * q }
            })
    }
}

/// The pose that `pos` and an orientation attribute give.
pub(super) fn pose(element: &Element, compiler: &Compiler) -> Result<Pose, FormatError> {
    let position = element.vector("pos")?.unwrap_or(DVec3::ZERO);
    Ok(Pose::new(position, orientation(element, compiler)?))
}

/// The orientation of an element; none is the identity.
pub(super) fn orientation(element: &Element, compiler: &Compiler) -> Result<DQuat, FormatError> {
    let given: Vec<&str> = ORIENTATIONS
        .iter()
        .copied()
        .filter(|n| element.has(n))
        .collect();
    if let [_, second, ..] = given[..] {
        return Err(element.invalid_attribute(
            second,
            &format!("gives an orientation, and so does `{}`", given[0]),
            "keep one of them",
        ));
    }
    if let Some(quat) = element.numbers::<4>("quat")? {
        return from_quat(element, "quat", quat);
    }
    if let Some([x, y, z, angle]) = element.numbers::<4>("axisangle")? {
        let axis = direction(element, "axisangle", DVec3::new(x, y, z))?;
        return Ok(DQuat::from_axis_angle(axis, angle * compiler.angle));
    }
    if let Some(angles) = element.numbers::<3>("euler")? {
        return Ok(compiler.euler.rotation(angles.map(|a| a * compiler.angle)));
    }
    if let Some([a, b, c, d, e, f]) = element.numbers::<6>("xyaxes")? {
        return from_axes(element, DVec3::new(a, b, c), DVec3::new(d, e, f));
    }
    if let Some(z) = element.vector("zaxis")? {
        return Ok(least_rotation_from_z(direction(element, "zaxis", z)?));
    }
    Ok(DQuat::IDENTITY)
}

/// MuJoCo's w x y z, of any length.
pub(super) fn from_quat(
    element: &Element,
    attribute: &str,
    [w, x, y, z]: [f64; 4],
) -> Result<DQuat, FormatError> {
    let quat = DQuat::from_xyzw(x, y, z, w);
    if quat.length() < LEAST_LENGTH {
        let remedy = "write 1 0 0 0 for no rotation";
        return Err(element.invalid_attribute(attribute, "is a quaternion of length zero", remedy));
    }
    Ok(quat.normalize())
}

fn from_axes(element: &Element, x: DVec3, y: DVec3) -> Result<DQuat, FormatError> {
    let x = direction(element, "xyaxes", x)?;
    let y = direction(element, "xyaxes", y - x * x.dot(y))?;
    Ok(DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y))).normalize())
}

/// The vector at unit length.
pub(super) fn direction(
    element: &Element,
    attribute: &str,
    vector: DVec3,
) -> Result<DVec3, FormatError> {
    if vector.length() > LEAST_LENGTH {
        return Ok(vector.normalize());
    }
    Err(element.invalid_attribute(
        attribute,
        "has no direction",
        "write a vector that is not zero",
    ))
}

/// The smallest rotation that takes z to a unit vector; about x where they are opposite.
pub(super) fn least_rotation_from_z(to: DVec3) -> DQuat {
    let axis = DVec3::Z.cross(to);
    let sine = axis.length();
    let axis = if sine < LEAST_LENGTH {
        DVec3::X
    } else {
        axis / sine
    };
    DQuat::from_axis_angle(axis, sine.atan2(to.z))
}
