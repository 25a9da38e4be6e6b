//! How easily degrees of freedom and bodies give way: the inverse mass matrix.
//!
//! H is the mass matrix in joint coordinates, at the initial coordinates, where the joint frames of
//! parent and child coincide. With the world's origin as reference point, the motion of degree of
//! freedom i is the twist (ωᵢ, vᵢ), and with (m, h = m c, I) of the subtree that it moves
//! (composite-rigid-body algorithm; Featherstone 2008, Rigid Body Dynamics Algorithms, §6.2)
//!
//! ```text
//! H_ij = ωᵢ · (I ωⱼ + h × vⱼ) + vᵢ · (m vⱼ + ωⱼ × h),    j at or below i.
//! ```
//!
//! H = Lᵀ L, with L as sparse as the tree has branches (§6.5), so for a direction with the Jacobian J,
//! J H⁻¹ Jᵀ = |L⁻ᵀ Jᵀ|², and (H⁻¹)ᵢᵢ = |L⁻ᵀ eᵢ|².

use glam::{DMat3, DVec3};
use model::{AxisKind, Body, BodyId, Joint, JointKind, Parts};

/// The inverse mass matrix of a model.
pub(crate) struct JointSpace(Chain);

impl JointSpace {
    /// Of a tree whose bodies stand after their parents, at its initial coordinates.
    pub fn new(parts: &Parts) -> Self {
        let mut chain = Chain::new(parts);
        chain.factor();
        Self(chain)
    }

    /// (H⁻¹)ᵢᵢ [1/kg or 1/(kg·m²)] of a joint's degree of freedom: acceleration per force.
    /// Zero where nothing that has mass moves.
    pub fn mobility(&self, joint: usize, dof: usize) -> f64 {
        let row = self.0.start[joint] + dof;
        self.0.inverse(row, |k| f64::from(u8::from(k == row)))
    }

    /// Acceleration per force [1/kg] of a point that goes with a body, the mean of all directions (of the trace of
    /// J H⁻¹ Jᵀ). Zero where nothing that has mass moves it. At its centre of mass MuJoCo's `body_invweight0`.
    pub fn translation(&self, body: BodyId, point: DVec3) -> f64 {
        let Some(last) = self.0.last[body.0] else {
            return 0.0;
        };
        let along = |axis: DVec3| {
            self.0.inverse(last, |k| {
                let twist = self.0.twists[k];
                axis.dot(twist.linear + twist.angular.cross(point))
            })
        };
        DVec3::AXES.iter().map(|axis| along(*axis)).sum::<f64>() / 3.0
    }

    /// The inertia [kg or kg·m²] a degree of freedom shows to a force on it alone, 1/(H⁻¹)ᵢᵢ.
    pub fn effective_inertia(&self, joint: usize, dof: usize) -> f64 {
        let mobility = self.mobility(joint, dof);
        if mobility > 0.0 { 1.0 / mobility } else { 0.0 }
    }
}

#[derive(Clone, Copy)]
struct Twist {
    angular: DVec3,
    linear: DVec3,
}

/// Mass, mass times centre, and inertia about the world's origin; they add.
#[derive(Clone, Copy, Default)]
struct Composite {
    mass: f64,
    moment: DVec3,
    inertia: DMat3,
}

impl Composite {
    fn of(body: &Body) -> Self {
        let center = body.pose.point(body.center);
        let r = DMat3::from_quat(body.pose.orientation);
        let c2 = DMat3::from_diagonal(DVec3::splat(center.length_squared()));
        let outer = DMat3::from_cols(center * center.x, center * center.y, center * center.z);
        let inertia = r * body.inertia * r.transpose() + body.mass * (c2 - outer);
        Self {
            mass: body.mass,
            moment: body.mass * center,
            inertia,
        }
    }

    fn add(&mut self, other: Self) {
        self.mass += other.mass;
        self.moment += other.moment;
        self.inertia += other.inertia;
    }

    /// ωᵢ · (I ωⱼ + h × vⱼ) + vᵢ · (m vⱼ + ωⱼ × h)
    fn couples(&self, i: Twist, j: Twist) -> f64 {
        let angular = self.inertia * j.angular + self.moment.cross(j.linear);
        let linear = self.mass * j.linear + j.angular.cross(self.moment);
        i.angular.dot(angular) + i.linear.dot(linear)
    }
}

/// The degrees of freedom, each with the one before it on the way to the root.
struct Chain {
    start: Vec<usize>,
    /// The last degree of freedom that moves each body.
    last: Vec<Option<usize>>,
    twists: Vec<Twist>,
    parent: Vec<Option<usize>>,
    /// H, then L: row i holds the entries of i, its parent, and so on to the root.
    rows: Vec<Vec<f64>>,
}

impl Chain {
    fn new(parts: &Parts) -> Self {
        let composites = composites(parts);
        let mut chain = Self {
            start: Vec::new(),
            last: vec![None; parts.bodies.len()],
            twists: Vec::new(),
            parent: Vec::new(),
            rows: Vec::new(),
        };
        for joint in &parts.joints {
            chain.start.push(chain.twists.len());
            if joint.closes_loop {
                continue;
            }
            let mut parent = joint.parent.and_then(|body| chain.last[body.0]);
            for (twist, dof) in motions(joint, parts).into_iter().zip(&joint.dofs) {
                let i = chain.twists.len();
                chain.twists.push(twist);
                chain.parent.push(parent);
                let subtree = composites[joint.child.0];
                let path = chain.path(i);
                let mut row: Vec<f64> = path
                    .map(|k| subtree.couples(chain.twists[k], twist))
                    .collect();
                row[0] += dof.armature;
                chain.rows.push(row);
                parent = Some(i);
            }
            chain.last[joint.child.0] = parent;
        }
        chain
    }

    /// From a degree of freedom to the root.
    fn path(&self, from: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(from), |i| self.parent[*i])
    }

    /// H ← L with H = Lᵀ L (Featherstone 2008, table 6.3).
    fn factor(&mut self) {
        for k in (0..self.rows.len()).rev() {
            let mut row = std::mem::take(&mut self.rows[k]);
            row[0] = row[0].sqrt();
            let pivot = row[0];
            row[1..].iter_mut().for_each(|entry| *entry /= pivot);
            let ancestors: Vec<usize> = self.path(k).skip(1).collect();
            for (di, i) in ancestors.iter().enumerate() {
                for (target, factor) in self.rows[*i].iter_mut().zip(&row[di + 1..]) {
                    *target -= row[di + 1] * factor;
                }
            }
            self.rows[k] = row;
        }
    }

    /// |x|² with Lᵀ x = Jᵀ, where J is zero off the path from i to the root, as x is then; zero where there is no mass.
    fn inverse(&self, i: usize, jacobian: impl Fn(usize) -> f64) -> f64 {
        let path: Vec<usize> = self.path(i).collect();
        let mut right: Vec<f64> = path.iter().map(|k| jacobian(*k)).collect();
        let mut square = 0.0;
        for (d, k) in path.iter().enumerate() {
            let row = &self.rows[*k];
            let x = right[d] / row[0];
            for (e, entry) in row.iter().enumerate().skip(1) {
                right[d + e] -= entry * x;
            }
            square += x * x;
        }
        if square.is_finite() { square } else { 0.0 }
    }
}

/// What each body's joint moves.
fn composites(parts: &Parts) -> Vec<Composite> {
    let mut composites: Vec<Composite> = parts.bodies.iter().map(Composite::of).collect();
    for joint in parts.joints.iter().rev().filter(|joint| !joint.closes_loop) {
        if let Some(parent) = joint.parent {
            let child = composites[joint.child.0];
            composites[parent.0].add(child);
        }
    }
    composites
}

/// The twist of each of a joint's degrees of freedom, about the world's origin.
fn motions(joint: &Joint, parts: &Parts) -> Vec<Twist> {
    let frame = parts.bodies[joint.child.0].pose * joint.child_frame;
    let slide = |direction: DVec3| Twist {
        angular: DVec3::ZERO,
        linear: frame.direction(direction),
    };
    let turn = |direction: DVec3, anchor: DVec3| {
        let angular = frame.direction(direction);
        Twist {
            angular,
            linear: frame.point(anchor).cross(angular),
        }
    };
    match joint.kind {
        JointKind::Ball => DVec3::AXES.iter().map(|a| turn(*a, DVec3::ZERO)).collect(),
        JointKind::Free => {
            let slides = DVec3::AXES.iter().map(|a| slide(*a));
            slides
                .chain(DVec3::AXES.iter().map(|a| turn(*a, DVec3::ZERO)))
                .collect()
        }
        _ => joint
            .axes
            .iter()
            .map(|axis| match axis.kind {
                AxisKind::Linear => slide(axis.direction),
                AxisKind::Angular => turn(axis.direction, axis.anchor),
            })
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::{Axis, BodyId, Pose};

    /// Two point masses m on massless rods of length l, hanging straight: about the pivots,
    /// H = m l² [[5, 2], [2, 1]], so H⁻¹ = [[1, −2], [−2, 5]] / (m l²).
    #[test]
    fn double_pendulum() {
        let (m, l) = (2.0, 0.5);
        let mut parts = Parts::default();
        for i in 0..2 {
            let mut body = Body::new(format!("rod{i}"));
            body.pose = Pose::at(DVec3::new(0.0, 0.0, -l * i as f64));
            (body.mass, body.center, body.inertia) = (m, DVec3::new(0.0, 0.0, -l), DMat3::ZERO);
            parts.bodies.push(body);
            let axes = vec![Axis::angular(DVec3::Y)];
            let parent = (i > 0).then_some(BodyId(0));
            parts.joints.push(Joint::new(
                format!("pin{i}"),
                JointKind::Revolute,
                parent,
                BodyId(i),
                axes,
            ));
        }
        let space = JointSpace::new(&parts);
        for (i, expected) in [1.0, 5.0].iter().enumerate() {
            let expected = expected / (m * l * l);
            assert!((space.mobility(i, 0) - expected).abs() < 1e-12 * expected);
        }
        // Along the rods nothing moves, nor across their plane; the upper mass moves with l q̇₁, so that
        // l² (H⁻¹)₁₁ = 1/m, and the lower with l (2 q̇₁ + q̇₂): (4 − 2·2·2 + 5)/m = 1/m.
        for (i, height) in [-l, -2.0 * l].into_iter().enumerate() {
            let found = space.translation(BodyId(i), DVec3::new(0.0, 0.0, height));
            assert!((found - 1.0 / (3.0 * m)).abs() < 1e-12, "{found}");
        }
    }

    #[test]
    fn massless_gives_no_inertia() {
        let mut parts = Parts::default();
        let mut body = Body::new("nothing");
        (body.mass, body.inertia) = (0.0, DMat3::ZERO);
        parts.bodies.push(body);
        let axes = vec![Axis::angular(DVec3::Y)];
        parts.joints.push(Joint::new(
            "pin",
            JointKind::Revolute,
            None,
            BodyId(0),
            axes,
        ));
        assert_eq!(JointSpace::new(&parts).effective_inertia(0, 0), 0.0);
    }
}
