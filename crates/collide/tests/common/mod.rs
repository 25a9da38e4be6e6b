//! Solids, their contacts by the kernels, and an independent reference.

#![allow(dead_code)] // Each test uses its own part.

pub mod kernel;
pub mod reference;
pub mod world;

use fastrand::Rng;
use kinetarium_collide::kind;

use numbers::{Pose, Quat, Vec3};

pub type V = Vec3<f64>;

/// A solid in its own frame.
#[derive(Clone, Debug)]
pub struct Solid {
    pub kind: usize,
    pub size: V,
    pub vertices: Vec<V>,
}

/// Two placed solids, the one of the lower kind first.
#[derive(Clone, Debug)]
pub struct Pair {
    pub solids: [Solid; 2],
    pub poses: [Pose<f64>; 2],
}

impl Solid {
    pub fn new(kind: usize, x: f64, y: f64, z: f64) -> Self {
        Self {
            kind,
            size: V::new(x, y, z),
            vertices: Vec::new(),
        }
    }

    /// The hull of points.
    pub fn hull(vertices: Vec<V>) -> Self {
        let (mut x, mut y, mut z) = (0f64, 0f64, 0f64);
        for v in &vertices {
            (x, y, z) = (x.max(v.x.abs()), y.max(v.y.abs()), z.max(v.z.abs()));
        }
        Self {
            kind: kind::HULL,
            size: V::new(x, y, z),
            vertices,
        }
    }

    /// Sizes from 0.1 to 1.
    pub fn random(kind: usize, rng: &mut Rng) -> Self {
        let mut size = || 0.1 + 0.9 * rng.f64();
        let (x, y, z) = (size(), size(), size());
        match kind {
            kind::CAPSULE => Self::new(kind, x, x * 1.01 + y, 0.0),
            kind::HULL => {
                let vertex = |_| unit(rng).times(V::new(x, y, z));
                Self::hull((0..12).map(vertex).collect())
            }
            _ => Self::new(kind, x, y, z),
        }
    }

    /// Radius of a ball about its origin that holds it.
    pub fn reach(&self) -> f64 {
        let V { x, y, z } = self.size;
        match self.kind {
            kind::PLANE => 0.0,
            kind::SPHERE => x,
            kind::CAPSULE => y,
            kind::CYLINDER | kind::CONE => x.hypot(y),
            kind::ELLIPSOID => x.max(y).max(z),
            _ => self.size.length(),
        }
    }
}

impl Pair {
    /// Turned at random, from concentric to a little apart.
    pub fn random(kinds: [usize; 2], rng: &mut Rng) -> Self {
        let solids = kinds.map(|kind| Solid::random(kind, rng));
        let reach = solids[0].reach() + solids[1].reach();
        let first = Pose::new(unit(rng) * 2.0, turn(rng));
        let way = if kinds[0] == kind::PLANE {
            let (x, z) = (rng.f64() - 0.5, rng.f64() - 0.5);
            first
                .q
                .rotate(V::new(x, 2.4 * (rng.f64() - 0.5) * reach, z))
        } else {
            unit(rng) * (1.1 * reach * rng.f64())
        };
        let second = Pose::new(first.p + way, turn(rng));
        Self {
            solids,
            poses: [first, second],
        }
    }

    /// The same with A and B exchanged.
    pub fn swapped(&self) -> Self {
        let [a, b] = self.solids.clone();
        let [p, q] = self.poses;
        Self {
            solids: [b, a],
            poses: [q, p],
        }
    }

    /// The length that tolerances are measured by.
    pub fn scale(&self) -> f64 {
        let at = |i: usize| self.solids[i].reach() + self.poses[i].p.length();
        at(0).max(at(1))
    }
}

/// A random unit vector.
pub fn unit(rng: &mut Rng) -> V {
    loop {
        let mut x = || 2.0 * rng.f64() - 1.0;
        let v = V::new(x(), x(), x());
        if (0.01..1.0).contains(&v.length()) {
            return v * v.length().recip();
        }
    }
}

/// A random orientation.
pub fn turn(rng: &mut Rng) -> Quat<f64> {
    Quat::from_axis_angle(unit(rng), rng.f64() * 6.3)
}
