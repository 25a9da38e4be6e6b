//! `auto` follows the motion.

use glam::Vec3;
use kinetarium_space::{Aabb, Auto, Space};

fn scene(n: usize, side: f32, seed: u64) -> Vec<Aabb> {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut vector = || side * Vec3::from_array(std::array::from_fn(|_| random.f32()));
    (0..n)
        .map(|_| Aabb::around(vector(), Vec3::splat(0.5)))
        .collect()
}

/// The structures in use at rest, after a jump, and at rest again.
fn chosen(n: usize, side: f32) -> [&'static str; 3] {
    let mut space = Space::<Auto>::new(&scene(n, side, 1)).unwrap();
    let at_first = space.structure().chosen();
    space.update(&scene(n, side, 2)).unwrap();
    let jumping = space.structure().chosen();
    space.update(&scene(n, side, 3)).unwrap();
    assert_eq!(space.structure().chosen(), jumping);
    space.update(&scene(n, side, 3)).unwrap();
    [at_first, jumping, space.structure().chosen()]
}

#[test]
fn few_jumping_objects_are_swept_and_pruned() {
    assert_eq!(chosen(300, 15.0), ["bvh", "sweep_and_prune", "bvh"]);
}

#[test]
fn many_jumping_objects_go_into_a_grid() {
    assert_eq!(chosen(5000, 35.0), ["bvh", "grid", "bvh"]);
}

#[test]
fn crowded_jumping_objects_stay_in_the_hierarchy() {
    assert_eq!(chosen(5000, 3.0), ["bvh", "bvh", "bvh"]);
}
