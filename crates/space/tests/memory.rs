//! What structures hold does not grow as objects move.

use glam::Vec3;
use kinetarium_space::{
    Aabb, Auto, Bsp, Bvh, Grid, KdTree, Octree, Space, Structure, SweepAndPrune,
};

/// A crowd of small objects about a point, and two that mark the ends of the world.
fn crowd(about: Vec3) -> Vec<Aabb> {
    let mut random = fastrand::Rng::with_seed(3);
    let mut offset = || 0.1 * Vec3::from_array([(); 3].map(|()| random.f32()));
    let small = |center| Aabb::around(center, Vec3::splat(1e-3));
    let ends = [-100.0, 100.0].map(|x| small(Vec3::splat(x)));
    let crowd = (0..500).map(|_| small(about + offset()));
    ends.into_iter().chain(crowd).collect()
}

fn stays_small<S: Structure>() {
    let mut random = fastrand::Rng::with_seed(4);
    let mut anywhere = || 90.0 * Vec3::from_array([(); 3].map(|()| 2.0 * random.f32() - 1.0));
    let mut space = Space::<S>::new(&crowd(anywhere())).unwrap();
    let built = space.structure().memory();
    for step in 0..20 {
        let boxes = crowd(anywhere());
        if step % 2 == 0 {
            space.update(&boxes).unwrap();
        } else {
            let moved = (0..).zip(boxes);
            moved.for_each(|(object, aabb)| space.relocate(object, aabb).unwrap());
        }
        let memory = space.structure().memory();
        assert!(
            memory < 4 * built,
            "{}: {memory} bytes after step {step}, of {built}",
            S::NAME
        );
    }
}

#[test]
fn a_crowd_that_moves_takes_no_more_memory() {
    stays_small::<Auto>();
    stays_small::<Bsp>();
    stays_small::<Bvh>();
    stays_small::<Grid>();
    stays_small::<KdTree>();
    stays_small::<Octree>();
    stays_small::<SweepAndPrune>();
}
