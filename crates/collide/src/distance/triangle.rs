//! The point of a triangle nearest to a point.
//!
//! Ericson, Real-Time Collision Detection (2005), §5.1.5: the plane is cut into the regions that belong to the
//! corners, the edges and the inside, and signs tell in which of them the point lies.

use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The point [m] of a triangle nearest to `p`, and the angle [rad] that the triangle takes up around it: all
/// round inside, half on an edge, in a corner the triangle's own.
pub fn nearest_on_triangle(corners: [DVec3; 3], p: DVec3) -> (DVec3, f64) {
    let [a, b, c] = corners;
    let (ab, ac) = (b - a, c - a);
    let along = |from: DVec3| (ab.dot(p - from), ac.dot(p - from));
    let ((d1, d2), (d3, d4), (d5, d6)) = (along(a), along(b), along(c));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (a, ab.angle_between(ac));
    }
    if d3 >= 0.0 && d4 <= d3 {
        return (b, (a - b).angle_between(c - b));
    }
    if d6 >= 0.0 && d5 <= d6 {
        return (c, (a - c).angle_between(b - c));
    }
    // What the corners c, b and a weigh.
    let (wc, wb, wa) = (d1 * d4 - d3 * d2, d5 * d2 - d1 * d6, d3 * d6 - d5 * d4);
    if wc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (a + d1 / (d1 - d3) * ab, PI);
    }
    if wb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (a + d2 / (d2 - d6) * ac, PI);
    }
    let (past_b, past_c) = (d4 - d3, d5 - d6);
    if wa <= 0.0 && past_b >= 0.0 && past_c >= 0.0 {
        return (b + past_b / (past_b + past_c) * (c - b), PI);
    }
    let all = wa + wb + wc;
    (a + wb / all * ab + wc / all * ac, TAU)
}
