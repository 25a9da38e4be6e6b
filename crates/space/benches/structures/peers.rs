//! Other people's structures, as their documentation says to use them.

use crate::scene::Scene;
use crate::subject::Subject;
use glam::Vec3;
use kinetarium_space::{Aabb, Cast};
use parry3d::bounding_volume::Aabb as ParryAabb;
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use parry3d::query::{PointQuery, Ray, RayCast};
use rstar::{AABB, PointDistance, RTree, RTreeObject};

fn vector(v: Vec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

fn parry(aabb: &Aabb) -> ParryAabb {
    ParryAabb::new(vector(aabb.min), vector(aabb.max))
}

/// parry3d's binary hierarchy with a binned build.
pub struct Parry {
    bvh: Bvh,
    boxes: Vec<ParryAabb>,
    workspace: BvhWorkspace,
}

impl Subject for Parry {
    const NAME: &'static str = "parry3d::Bvh";

    fn build(scene: &Scene) -> Self {
        let boxes: Vec<ParryAabb> = scene.boxes.iter().map(parry).collect();
        let bvh = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        Self {
            bvh,
            boxes,
            workspace: BvhWorkspace::default(),
        }
    }
    fn update(&mut self, moved: &[Aabb]) -> Option<()> {
        for (i, aabb) in moved.iter().enumerate() {
            self.boxes[i] = parry(aabb);
            self.bvh
                .insert_or_update_partially(self.boxes[i], i as u32, 0.0);
        }
        self.bvh.refit(&mut self.workspace);
        Some(())
    }
    fn jump(&mut self, _: &[Aabb]) -> Option<usize> {
        // A refit alone leaves a tree that would not be fair to time.
        None
    }
    fn pairs(&self) -> Option<usize> {
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        let mut workspace = BvhWorkspace::default();
        self.bvh
            .traverse_bvtt_single_tree::<false>(&mut workspace, &mut |a, b| pairs.push((a, b)));
        Some(pairs.len())
    }
    fn rays(&self, rays: &[Cast]) -> Option<usize> {
        let hits = |cast: &&Cast| {
            let ray = Ray::new(vector(cast.origin()), vector(cast.direction()));
            let exact = |i: u32, limit| self.boxes[i as usize].cast_local_ray(&ray, limit, true);
            self.bvh.cast_ray(&ray, f32::MAX, exact).is_some()
        };
        Some(rays.iter().filter(hits).count())
    }
    fn ray_batch(&self, _: &[Cast]) -> Option<usize> {
        None
    }
    fn camera(&self, rays: &[Cast]) -> Option<usize> {
        self.rays(rays)
    }
    fn nearest(&self, points: &[Vec3]) -> Option<usize> {
        let near = |p: &&Vec3| {
            let p = vector(**p);
            let project = |i: u32, _| Some(self.boxes[i as usize].project_local_point(p, true));
            let found = self.bvh.project_point(p, 1e9, project);
            found.is_some_and(|(_, (distance, _))| distance <= 1.0)
        };
        Some(points.iter().filter(near).count())
    }
    fn bytes(&self) -> Option<usize> {
        Some(self.bvh.heap_memory_size())
    }
}

/// rstar's R*-tree.
pub struct Rstar {
    tree: RTree<Item>,
}

pub struct Item(Aabb);

impl RTreeObject for Item {
    type Envelope = AABB<[f32; 3]>;
    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.0.min.to_array(), self.0.max.to_array())
    }
}

impl PointDistance for Item {
    fn distance_2(&self, point: &[f32; 3]) -> f32 {
        self.0.distance_squared(Vec3::from_array(*point))
    }
}

impl Subject for Rstar {
    const NAME: &'static str = "rstar::RTree";

    fn build(scene: &Scene) -> Self {
        Self {
            tree: RTree::bulk_load(scene.boxes.iter().map(|b| Item(*b)).collect()),
        }
    }
    fn update(&mut self, _: &[Aabb]) -> Option<()> {
        None
    }
    fn jump(&mut self, _: &[Aabb]) -> Option<usize> {
        None
    }
    fn pairs(&self) -> Option<usize> {
        let candidates = self
            .tree
            .intersection_candidates_with_other_tree(&self.tree);
        Some(
            candidates
                .filter(|(a, b)| std::ptr::from_ref(*a) < std::ptr::from_ref(*b))
                .count(),
        )
    }
    fn rays(&self, _: &[Cast]) -> Option<usize> {
        None
    }
    fn ray_batch(&self, _: &[Cast]) -> Option<usize> {
        None
    }
    fn camera(&self, _: &[Cast]) -> Option<usize> {
        None
    }
    fn nearest(&self, points: &[Vec3]) -> Option<usize> {
        let near = |p: &&Vec3| {
            let nearest = self.tree.nearest_neighbor(p.to_array());
            nearest.is_some_and(|i| i.0.distance_squared(**p) <= 1.0)
        };
        Some(points.iter().filter(near).count())
    }
    fn bytes(&self) -> Option<usize> {
        None
    }
}
