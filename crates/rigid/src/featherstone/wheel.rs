//! Wheels and rollers: what turns about its own axis.

use super::tables::motion;
use glam::DVec3;
use model::{Geometry, Pose};

/// How far its surface may be off where it is touched, in parts of its radius, and its axis turned [rad], as axes of files
/// are.
const OFF: f64 = 1e-2;

/// Whether a motion of a node, of a [kind](motion) and about an axis through its origin, turns a shape there about its own
/// axis, so that wherever it is touched, it stays where it is.
pub(super) fn rolls(kind: usize, axis: DVec3, geometry: &Geometry, at: Pose) -> bool {
    let center = at.position;
    let off = match kind {
        motion::REVOLUTE => (center - axis * axis.dot(center)).length(),
        motion::BALL => center.length(),
        _ => return false,
    };
    match *geometry {
        Geometry::Sphere { radius } => off < OFF * radius,
        Geometry::Capsule {
            radius,
            half_height,
        }
        | Geometry::Cylinder {
            radius,
            half_height,
        }
        | Geometry::Cone {
            radius,
            half_height,
        } => {
            let turned = axis.cross(at.direction(DVec3::Y)).length();
            let off = half_height.mul_add(turned, off);
            kind == motion::REVOLUTE && off < OFF * radius && turned < OFF
        }
        _ => false,
    }
}
