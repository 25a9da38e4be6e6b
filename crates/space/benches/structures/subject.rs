//! What is measured.

use crate::scene::Scene;
use glam::Vec3;
use kinetarium_space::{Aabb, Cast, Space, Structure};

/// A structure at work. What it cannot do it answers with nothing; otherwise with
/// a number by which answers are compared.
pub trait Subject {
    const NAME: &'static str;
    fn build(scene: &Scene) -> Self;
    /// All objects have moved.
    fn update(&mut self, moved: &[Aabb]) -> Option<()>;
    /// All objects are somewhere else. How many pairs overlap then.
    fn jump(&mut self, boxes: &[Aabb]) -> Option<usize>;
    /// How many pairs overlap.
    fn pairs(&self) -> Option<usize>;
    /// How many rays hit something, one after the other.
    fn rays(&self, rays: &[Cast]) -> Option<usize>;
    /// The same, all at once.
    fn ray_batch(&self, rays: &[Cast]) -> Option<usize>;
    /// How many rays of an image hit something, in the fastest way.
    fn camera(&self, rays: &[Cast]) -> Option<usize>;
    /// How many points have an object within 1 m.
    fn nearest(&self, points: &[Vec3]) -> Option<usize>;
    fn bytes(&self) -> Option<usize>;
}

impl<S: Structure> Subject for Space<S> {
    const NAME: &'static str = S::NAME;

    fn build(scene: &Scene) -> Self {
        Self::new(&scene.boxes).expect("finite boxes")
    }
    fn update(&mut self, moved: &[Aabb]) -> Option<()> {
        self.update(moved).ok()
    }
    fn jump(&mut self, boxes: &[Aabb]) -> Option<usize> {
        self.update(boxes).ok().map(|()| self.pairs().len())
    }
    fn pairs(&self) -> Option<usize> {
        Some(self.pairs().len())
    }
    fn rays(&self, rays: &[Cast]) -> Option<usize> {
        Some(
            rays.iter()
                .filter(|ray| self.cast(ray, self.boxes()).is_some())
                .count(),
        )
    }
    fn ray_batch(&self, rays: &[Cast]) -> Option<usize> {
        Some(self.cast_batch(rays, self.boxes()).iter().flatten().count())
    }
    fn camera(&self, rays: &[Cast]) -> Option<usize> {
        self.ray_batch(rays)
    }
    fn nearest(&self, points: &[Vec3]) -> Option<usize> {
        let near = |p: &&Vec3| {
            self.closest(**p, 1e9, self.boxes())
                .is_some_and(|n| n.distance_squared <= 1.0)
        };
        Some(points.iter().filter(near).count())
    }
    fn bytes(&self) -> Option<usize> {
        Some(self.structure().memory())
    }
}
