//! What the contacts must be, from other code than the kernels': support functions of the
//! solids written anew, and parry's GJK and EPA.
//!
//! For a unit vector n the gap is g(n) = min n·b − max n·a over the points b of B and a of A.
//! The distance of two convex solids is the maximum of g over all n, the normal where it is.
//! So the gap along *any* n bounds the distance from below, whoever found that n.

use super::{Pair, Solid, V};
use kinetarium_collide::kind;
use numbers::Pose;
use parry3d_f64::math;
use parry3d_f64::query::details::contact_support_map_support_map;
use parry3d_f64::shape::SupportMap;

/// The point of a solid farthest along `d`, in its frame.
pub fn support(solid: &Solid, d: V) -> V {
    let V { x, y, z } = solid.size;
    let unit = |v: V| v * v.length().max(1e-300).recip();
    let side = |s: f64| if s < 0.0 { -1.0 } else { 1.0 };
    let disc = |r: f64, y: f64| unit(V::new(d.x, 0.0, d.z)) * r + V::new(0.0, y, 0.0);
    let farther = |a: V, b: V| if d.dot(a) > d.dot(b) { a } else { b };
    match solid.kind {
        kind::SPHERE => unit(d) * x,
        kind::CAPSULE => unit(d) * x + V::new(0.0, side(d.y) * (y - x), 0.0),
        kind::CYLINDER => disc(x, side(d.y) * y),
        kind::CONE => farther(V::new(0.0, y, 0.0), disc(x, -y)),
        kind::BOX => V::new(side(d.x) * x, side(d.y) * y, side(d.z) * z),
        kind::ELLIPSOID => solid.size.times(unit(solid.size.times(d))),
        kind::HULL => solid.vertices.iter().copied().reduce(farther).unwrap(),
        _ => unreachable!("not bounded"),
    }
}

/// The point of a placed solid farthest along `d`.
fn placed_support(solid: &Solid, pose: Pose<f64>, d: V) -> V {
    pose.point(support(solid, pose.q.rotate_inverse(d)))
}

/// The gap along a unit vector.
pub fn gap(pair: &Pair, n: V) -> f64 {
    let [a, b] = &pair.solids;
    let [p, q] = pair.poses;
    let top = if a.kind == kind::PLANE {
        n.dot(p.p)
    } else {
        n.dot(placed_support(a, p, n))
    };
    n.dot(placed_support(b, q, -n)) - top
}

/// The largest gap along any unit vector, or a little less.
pub fn best_gap(pair: &Pair) -> f64 {
    let [a, b] = &pair.solids;
    let [p, q] = pair.poses;
    if a.kind == kind::PLANE {
        return gap(pair, p.q.rotate(V::new(0.0, 1.0, 0.0)));
    }
    let between = p.inverse() * q;
    contact_support_map_support_map(&pose(between), &Peer(a), &Peer(b), f64::MAX).map_or(
        f64::NEG_INFINITY,
        |c| {
            let n = p.q.rotate(vector(c.normal1));
            gap(pair, n * n.length().recip())
        },
    )
}

/// How far a point is outside of a solid; zero inside.
pub fn outside(solid: &Solid, at: Pose<f64>, x: V) -> f64 {
    let x = at.inverse().point(x);
    if solid.kind == kind::PLANE {
        return x.y.max(0.0);
    }
    let point = Solid::new(kind::SPHERE, 0.0, 0.0, 0.0);
    let there = Pose::new(x, numbers::Quat::identity());
    contact_support_map_support_map(&pose(there), &Peer(solid), &Peer(&point), f64::MAX)
        .map_or(0.0, |c| c.dist.max(0.0))
}

struct Peer<'a>(&'a Solid);

impl SupportMap for Peer<'_> {
    fn local_support_point(&self, d: math::Vector) -> math::Vector {
        let V { x, y, z } = support(self.0, vector(d));
        math::Vector::new(x, y, z)
    }
}

fn vector(v: math::Vector) -> V {
    V::new(v.x, v.y, v.z)
}

fn pose(p: Pose<f64>) -> math::Pose {
    let (t, q) = (p.p, p.q);
    math::Pose::from_parts(
        math::Vector::new(t.x, t.y, t.z),
        math::Rotation::from_xyzw(q.x, q.y, q.z, q.w).normalize(),
    )
}
