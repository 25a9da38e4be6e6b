//! What is measured on.

use glam::Vec3;
use kinetarium_space::{Aabb, Cast};
use std::fmt;

#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// Boxes of like size, spread evenly.
    Uniform,
    /// A hundredth as many clusters, sizes from 0.1 to 3.
    Clustered,
}

/// Objects before and after a short motion and a jump, and questions about them.
pub struct Scene {
    pub kind: Kind,
    pub boxes: Vec<Aabb>,
    pub moved: Vec<Aabb>,
    /// Each object where another was.
    pub jumped: Vec<Aabb>,
    pub rays: Vec<Cast>,
    /// Rays of an image, in tiles of 4 by 4.
    pub camera: Vec<Cast>,
    pub points: Vec<Vec3>,
}

/// Questions of each kind.
pub const QUESTIONS: usize = 4096;

/// 64 by 64 rays from a point, 60° wide, about another.
fn image(from: Vec3, to: Vec3) -> Vec<Cast> {
    let forward = (to - from).normalize();
    let (right, up) = forward.any_orthonormal_pair();
    let pixel = |i: usize| {
        let (tile, within) = (i / 16, i % 16);
        let (x, y) = (4 * (tile % 16) + within % 4, 4 * (tile / 16) + within / 4);
        let offset = |x: usize| (x as f32 - 31.5) / 31.5 * 0.577;
        Cast::ray(from, forward + offset(x) * right + offset(y) * up).expect("finite")
    };
    (0..QUESTIONS).map(pixel).collect()
}

impl Scene {
    pub fn new(kind: Kind, n: usize) -> Self {
        let mut random = fastrand::Rng::with_seed(n as u64);
        // A box of edge 1 has 8 m³ to itself.
        let side = 2.0 * (n as f32).cbrt();
        let mut vector = |side: f32| side * Vec3::from_array(std::array::from_fn(|_| random.f32()));
        let centers: Vec<Vec3> = (0..n / 100).map(|_| vector(side)).collect();
        let objects: Vec<(Vec3, Vec3)> = (0..n)
            .map(|i| match kind {
                Kind::Uniform => (vector(side), Vec3::splat(0.25) + vector(0.5)),
                Kind::Clustered => {
                    // The sum of three is about normal: 100 boxes within some 5 m.
                    let off = vector(4.0) + vector(4.0) + vector(4.0) - 6.0;
                    let half = 0.05 * 30.0_f32.powf(vector(1.0).x);
                    (centers[i % centers.len()] + off, half * (0.5 + vector(1.0)))
                }
            })
            .collect();
        let moved = objects
            .iter()
            .map(|(c, h)| Aabb::around(c + vector(0.04) - 0.02, *h))
            .collect();
        let direction = |v: Vec3| (v - 1.0).normalize_or(Vec3::X);
        let rays = (0..QUESTIONS)
            .map(|_| Cast::ray(vector(side), direction(vector(2.0))).expect("finite"));
        Self {
            kind,
            camera: image(Vec3::new(0.5, 0.4, -0.3) * side, Vec3::splat(0.5) * side),
            rays: rays.collect(),
            points: (0..QUESTIONS).map(|_| vector(side)).collect(),
            boxes: objects.iter().map(|(c, h)| Aabb::around(*c, *h)).collect(),
            moved,
            jumped: (0..n)
                .map(|i| (i + n / 2) % n)
                .map(|i| Aabb::around(objects[i].0, objects[i].1))
                .collect(),
        }
    }
}

impl fmt::Display for Scene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self.kind {
            Kind::Uniform => "uniform",
            Kind::Clustered => "clustered",
        };
        write!(f, "{kind}, {} objects", self.boxes.len())
    }
}
