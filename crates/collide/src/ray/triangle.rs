//! Where a line crosses a triangle, without gaps between neighbours.
//!
//! Woop, Benthin & Wald, Watertight Ray/Triangle Intersection (2013): axes x, y, z are named so that z
//! is the longest of the line's direction, and sheared so that the line is the z axis. The signed
//! areas of the corners' projections tell on which side of each edge it passes; two triangles compute
//! the same number for the edge they share, of opposite sign, so that no line passes between them:
//!
//! ```text
//! S = (d.x / d.z, d.y / d.z, 1 / d.z)       p' = (p.x − S.x p.z, p.y − S.y p.z)
//! u = c' × b',  v = a' × c',  w = b' × a'   t = S.z (u a.z + v b.z + w c.z) / (u + v + w)
//! ```
//!
//! for corners a, b, c relative to the line's origin. Lines in the triangle's plane do not cross it.

use super::line::Line;
use glam::{DVec2, DVec3};

/// A line as triangles see it.
#[derive(Clone, Copy, Debug)]
pub struct Sheared {
    origin: DVec3,
    /// The axes that are called x, y and z.
    axes: [usize; 3],
    shear: DVec3,
}

impl Sheared {
    /// Of a line whose direction has unit length.
    pub fn new(line: &Line) -> Self {
        let d = line.direction;
        let z = d.abs().max_position();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let [x, y, z] = axes.map(|axis| d[axis]);
        Self {
            origin: line.origin,
            axes,
            shear: DVec3::new(x / z, y / z, 1.0 / z),
        }
    }

    /// The distance [m] along the line at which it crosses a triangle, from either side; edges count.
    pub fn crosses(&self, corners: [DVec3; 3]) -> Option<f64> {
        let seen = corners.map(|p| {
            let p = p - self.origin;
            let [x, y, z] = self.axes.map(|axis| p[axis]);
            let across = DVec2::new(x - self.shear.x * z, y - self.shear.y * z);
            (across, z)
        });
        let [(a, az), (b, bz), (c, cz)] = seen;
        let (u, v, w) = (c.perp_dot(b), a.perp_dot(c), b.perp_dot(a));
        let (least, most) = (u.min(v).min(w), u.max(v).max(w));
        let area = u + v + w;
        if (least < 0.0 && most > 0.0) || area == 0.0 {
            return None;
        }
        Some(self.shear.z * (u * az + v * bz + w * cz) / area)
    }
}
