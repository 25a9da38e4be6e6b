//! Worlds in lanes answer as each world alone does.

use glam::{DVec3, Vec3};
use kinetarium_space::{Aabb, Bvh, Cast, Pair, ScenePair, Space, SpaceError, Worlds};
use numbers::Float;
use numbers::dispatch::Isa;

const OBJECTS: usize = 12;
const RAYS: usize = 5;

fn random_boxes(random: &mut fastrand::Rng, count: usize) -> Vec<Aabb> {
    let mut vector = |side: f32| side * Vec3::from_array(std::array::from_fn(|_| random.f32()));
    (0..count)
        .map(|_| Aabb::around(vector(8.0), vector(0.6)))
        .collect()
}

/// `count` worlds, and the boxes in each.
fn scene<T: Float>(count: usize, isa: Isa) -> (Worlds<T>, Vec<Vec<Aabb>>) {
    let mut random = fastrand::Rng::with_seed(3);
    let mut worlds = Worlds::new(count, OBJECTS, isa, |a, b| a + 1 != b);
    let boxes: Vec<Vec<Aabb>> = (0..count)
        .map(|_| random_boxes(&mut random, OBJECTS))
        .collect();
    for (world, of_world) in boxes.iter().enumerate() {
        for (object, b) in of_world.iter().enumerate() {
            worlds
                .set(world, object, b.min.as_dvec3(), b.max.as_dvec3())
                .unwrap();
        }
    }
    (worlds, boxes)
}

/// The worlds of each block.
fn blocks<T: Float>(isa: Isa, boxes: &[Vec<Aabb>]) -> std::slice::Chunks<'_, Vec<Aabb>> {
    boxes.chunks(isa.width::<T>())
}

fn near_pairs<T: Float>(count: usize, isa: Isa) {
    let (worlds, boxes) = scene::<T>(count, isa);
    for margin in [0.0_f32, 0.25] {
        let near = worlds.near(T::from_f64(margin.into()));
        for (block, together) in blocks::<T>(isa, &boxes).enumerate() {
            let meets = |p: &&Pair| {
                together
                    .iter()
                    .any(|b| b[p.a as usize].padded(margin).overlaps(&b[p.b as usize]))
            };
            let expected: Vec<Pair> = worlds.candidates().iter().filter(meets).copied().collect();
            // Rounding of the margin may tell apart what is just so far apart; no random pair is.
            assert_eq!(
                near.block(block),
                expected,
                "{isa}, margin {margin}, block {block}"
            );
        }
    }
}

fn near_scene<T: Float>(count: usize, isa: Isa) {
    let (worlds, boxes) = scene::<T>(count, isa);
    let rest = Space::<Bvh>::new(&random_boxes(&mut fastrand::Rng::with_seed(9), 100)).unwrap();
    let near = worlds.near_scene(&rest, T::from_f64(0.25));
    for (block, together) in blocks::<T>(isa, &boxes).enumerate() {
        for object in 0..OBJECTS {
            for b in together {
                for scene in rest.overlap(&b[object].padded(0.25)) {
                    let pair = ScenePair {
                        object: object as u32,
                        scene,
                    };
                    assert!(
                        near.block(block).binary_search(&pair).is_ok(),
                        "{isa}: {pair:?}"
                    );
                }
            }
        }
        assert!(near.block(block).len() < OBJECTS * 100);
    }
}

fn casts<T: Float>(count: usize, isa: Isa) {
    let (worlds, boxes) = scene::<T>(count, isa);
    let mut random = fastrand::Rng::with_seed(5);
    let mut vector = |side: f32| side * Vec3::from_array(std::array::from_fn(|_| random.f32()));
    let mut rays = worlds.rays(RAYS);
    let mut expected = Vec::new();
    for (world, of_world) in boxes.iter().enumerate() {
        let space = Space::<Bvh>::new(of_world).unwrap();
        // The last ray is not set.
        for ray in 0..RAYS - 1 {
            let toward = if ray == 0 { Vec3::Y } else { vector(2.0) - 1.0 };
            let (from, limit) = (vector(8.0), if ray == 1 { 3.0 } else { f32::INFINITY });
            rays.set(world, ray, from.as_dvec3(), toward.as_dvec3(), limit.into())
                .unwrap();
            expected.push((
                world,
                ray,
                space.cast(
                    &Cast::ray(from, toward).unwrap().until(limit),
                    space.boxes(),
                ),
            ));
        }
        expected.push((world, RAYS - 1, None));
    }
    let hits = worlds.cast(&rays).unwrap();
    for (world, ray, expected) in expected {
        let hit = hits.get(world, ray);
        assert_eq!(
            hit.map(|h| h.0),
            expected.map(|h| h.object),
            "{isa}, world {world}, ray {ray}"
        );
        let times = hit.map_or(0.0, |h| h.1.to_f64()) - expected.map_or(0.0, |h| h.time.into());
        assert!(
            times.abs() < 1e-4,
            "{isa}, world {world}, ray {ray}: {times}"
        );
    }
}

#[test]
fn lanes_answer_as_single_worlds() {
    for isa in Isa::available() {
        for count in [1, 16, 37] {
            near_pairs::<f32>(count, isa);
            near_pairs::<f64>(count, isa);
            near_scene::<f32>(count, isa);
            near_scene::<f64>(count, isa);
            casts::<f32>(count, isa);
            casts::<f64>(count, isa);
        }
    }
}

#[test]
fn objects_that_are_not_set_are_nowhere() {
    let worlds = Worlds::<f32>::new(3, 4, Isa::detect(), |_, _| true);
    assert_eq!(worlds.candidates().len(), 6);
    assert!(worlds.near(10.0).block(0).is_empty());
    let mut rays = worlds.rays(1);
    rays.set(1, 0, DVec3::ZERO, DVec3::X, f64::INFINITY)
        .unwrap();
    assert_eq!(worlds.cast(&rays).unwrap().get(1, 0), None);
}

#[test]
fn bad_worlds_and_rays_are_refused() {
    let mut worlds = Worlds::<f32>::new(3, 4, Isa::detect(), |_, _| true);
    let nan = DVec3::new(0.0, f64::NAN, 0.0);
    assert!(matches!(
        worlds.set(0, 2, nan, DVec3::ONE),
        Err(SpaceError::NotANumber { object: 2, .. })
    ));
    assert!(matches!(
        worlds.set(0, 2, DVec3::ONE, DVec3::ZERO),
        Err(SpaceError::InsideOut { object: 2, .. })
    ));
    assert!(worlds.set(0, 4, DVec3::ZERO, DVec3::ONE).is_err());
    assert!(worlds.set(3, 0, DVec3::ZERO, DVec3::ONE).is_err());
    let mut rays = worlds.rays(2);
    assert!(rays.set(0, 0, nan, DVec3::X, 1.0).is_err());
    assert!(rays.set(0, 0, DVec3::ZERO, DVec3::ZERO, 1.0).is_err());
    assert!(rays.set(0, 0, DVec3::ZERO, DVec3::X, f64::NAN).is_err());
    assert!(rays.set(0, 2, DVec3::ZERO, DVec3::X, 1.0).is_err());
    assert!(
        Worlds::<f32>::new(40, 4, Isa::detect(), |_, _| true)
            .cast(&rays)
            .is_err()
    );
}
