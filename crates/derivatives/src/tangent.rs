//! Small changes of a state, one number for each degree of freedom.
//!
//! Coordinates along axes change by sums, orientations by rotation vectors δ in the child's axes, as
//! velocities do: q ⊕ δ = q exp(δ), with exp(δ) = (sin(½ |δ|) δ / |δ|, cos(½ |δ|)). At δ = 0
//!
//! ```text
//! dq = ½ q δ                into a quaternion, δ as a quaternion without real part
//! δ = 2 vec(q* dq)          out of it, for |q| = 1, of which q* is the inverse
//! ```

use model::{JointId, JointKind, Model};
use numbers::{Dual, Quat, Real, Vec3};

/// What a degree of freedom moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Coordinate {
    /// The coordinate in this row.
    Axis(usize),
    /// The quaternion that begins in this row, about one of its three axes.
    Turn(usize, usize),
}

/// What each degree of freedom of a model moves.
pub(crate) fn coordinates(model: &Model) -> Vec<Coordinate> {
    let joints = model.joints.iter().enumerate();
    let carrying = joints.filter(|(_, joint)| !joint.closes_loop);
    let of_joint = |(i, joint): (usize, &model::Joint)| {
        let range = model.coordinate_range(JointId(i));
        let quaternion = match joint.kind {
            JointKind::Ball | JointKind::Free => range.end - 4,
            _ => range.end,
        };
        let turns = if quaternion < range.end { 3 } else { 0 };
        let axes = (range.start..quaternion).map(Coordinate::Axis);
        axes.chain((0..turns).map(move |axis| Coordinate::Turn(quaternion, axis)))
    };
    carrying.flat_map(of_joint).collect()
}

impl Coordinate {
    /// Rows, and the slopes there, of a change by 1 at these coordinates.
    pub fn seeds(self, position: &[f64]) -> Vec<(usize, f64)> {
        match self {
            Self::Axis(row) => vec![(row, 1.0)],
            Self::Turn(row, axis) => {
                let [x, y, z, w] = std::array::from_fn(|i| position[row + i]);
                let half = Vec3::from_array(std::array::from_fn(|i| f64::from(i == axis) * 0.5));
                let d = Quat::new(x, y, z, w) * Quat::from_parts(half, 0.0);
                (row..).zip([d.x, d.y, d.z, d.w]).collect()
            }
        }
    }
    /// The change along the degree of freedom that the slopes of the coordinates stand for.
    #[inline(always)]
    pub fn change<R: Real>(self, position: &[Dual<R>]) -> R {
        match self {
            Self::Axis(row) => position[row].slope,
            Self::Turn(row, axis) => {
                let [x, y, z, w] = std::array::from_fn(|i| position[row + i]);
                let q = Quat::new(x.value, y.value, z.value, w.value);
                let d = Quat::new(x.slope, y.slope, z.slope, w.slope);
                let turn = (q.conjugate() * d).vector().to_array();
                turn[axis] + turn[axis]
            }
        }
    }
}
