//! Which of the frames along the principal axes of an inertia MuJoCo takes (`mju_eig3`).
//!
//! Jacobi's method, on quaternions, the largest product of inertia first: about the axis across p and q by −θ, of which
//! t = tan θ is the smaller root of t² + 2 τ t − 1 = 0, τ = (A_qq − A_pp)/2A_pq; by θ about y, which goes from z to x. Then
//! quarter turns put the largest moment first and the least one last. So what is diagonal in this order is not turned.

use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::FRAC_PI_2;

/// Rotations that are more than enough.
const MOST: usize = 500;
/// What counts as zero of the largest moment.
const ZERO: f64 = 1e-12;

/// Principal moments, the largest first, and the orientation of their axes.
pub(super) fn of(inertia: DMat3) -> (DVec3, DQuat) {
    let mut turn = DQuat::IDENTITY;
    for _ in 0..MOST {
        let Some(rotation) = rotation(seen(inertia, turn)) else {
            break;
        };
        turn = (turn * rotation).normalize();
    }
    let mut moments = diagonal(seen(inertia, turn));
    for i in [0, 1, 0] {
        if moments[i] + ZERO * moments.max_element() < moments[i + 1] {
            (moments[i], moments[i + 1]) = (moments[i + 1], moments[i]);
            let quarter = DQuat::from_axis_angle(DVec3::AXES[(i + 2) % 3], FRAC_PI_2);
            turn = (turn * quarter).normalize();
        }
    }
    (moments, turn)
}

/// The orientation of the axes of an inertia that was worked out in axes turned like this.
pub(super) fn along(inertia: DMat3, turn: DQuat) -> DQuat {
    turn * of(seen(inertia, turn)).1
}

/// Along turned axes.
fn seen(inertia: DMat3, turn: DQuat) -> DMat3 {
    let r = DMat3::from_quat(turn);
    r.transpose() * inertia * r
}

fn diagonal(a: DMat3) -> DVec3 {
    DVec3::new(a.x_axis.x, a.y_axis.y, a.z_axis.z)
}

/// What takes away the largest product of inertia; `None` where there is none.
fn rotation(a: DMat3) -> Option<DQuat> {
    let product = |(p, q): (usize, usize)| a.col(q)[p];
    let pairs = [(1, 2), (0, 2), (0, 1)];
    // Of equal ones that about the first axis.
    let axis = (0..3).rev().max_by(|i, j| {
        let [i, j] = [*i, *j].map(|axis| product(pairs[axis]).abs());
        i.total_cmp(&j)
    })?;
    let (p, q) = pairs[axis];
    let a_pq = product(pairs[axis]);
    if a_pq.abs() <= ZERO * diagonal(a).max_element() {
        return None;
    }
    let tau = (a.col(q)[q] - a.col(p)[p]) / (2.0 * a_pq);
    let sign = if tau >= 0.0 { 1.0 } else { -1.0 };
    let theta = (sign / (tau.abs() + tau.hypot(1.0))).atan();
    let angle = if axis == 1 { theta } else { -theta };
    Some(DQuat::from_axis_angle(DVec3::AXES[axis], angle))
}
