//! The Jacobian of a point of a body.
//!
//! J(q) with (ω, ẋ) = J q̇, in world axes: ω the body's angular velocity, ẋ the
//! velocity of the world's point x that moves with the body. Column i is the
//! motion of degree of freedom i where it lies on the path from the body to the
//! world, and 0 elsewhere. Featherstone, *Rigid Body Dynamics Algorithms* (2008),
//! §4.6 (a node's velocity is Σ S_i q̇_i over its path), with the spatial velocity
//! S = (a, l) about O taken to x:
//!
//! ```text
//! J_i = (a_i, l_i + a_i × (x − O))
//! ```

use super::super::tables::frame;
use super::tables::{DynamicsTables, body_path, path_link};
use crate::featherstone::kinematics::kinematics;
use crate::featherstone::tables::{Tables, body_field, body_link, dof};
use numbers::Machine;
use numbers::spatial::Spatial;

/// The Jacobian of the point in `point` of the model's body `body` into `jacobian`.
#[inline(always)]
pub(crate) fn jacobian<M: Machine>(k: &mut M, t: &Tables, d: &DynamicsTables, body: M::I) {
    kinematics(k, t);
    for v in k.count(t.dofs) {
        k.store_spatial(d.jacobian, v, 0, Spatial::zero());
    }
    let row = k.link(d.body_links, body, body_path::ROW);
    let n = k.link(t.body_links, row, body_link::NODE);
    let place = k.pose(t.frame, n, frame::PLACE) * k.pose(t.body, row, body_field::PLACE);
    let x = place.point(k.vec3(d.point, k.index(0), 0));
    let begin = k.link(d.body_links, body, body_path::PATH_BEGIN);
    let end = k.link(d.body_links, body, body_path::PATH_END);
    for p in k.range(begin, end) {
        let v = k.link(d.path_links, p, path_link::DOF);
        let s = k.spatial(t.dof, v, dof::AXIS);
        let column = Spatial::new(s.angular, s.linear + s.angular.cross(x));
        k.store_spatial(d.jacobian, v, 0, column);
    }
}
