//! Many worlds of the same objects: lanes beside one hierarchy a world.

use crate::measure::{figure, median};
use crate::scene::{Kind, Scene};
use kinetarium_space::{Aabb, Bvh, Cast, Space, Worlds};
use numbers::dispatch::Isa;
use std::hint::black_box;

const WORLDS: usize = 4096;
const OBJECTS: usize = 20;
const RAYS: usize = 8;

/// Prints µs a world, in threads, for all pairs and for rays.
pub fn run() {
    let scenes: Vec<Scene> = (0..64)
        .map(|i| Scene::new(Kind::Uniform, 100 + i))
        .collect();
    let boxes = |world: usize| &scenes[world % 64].boxes[..OBJECTS];
    let rays = |world: usize| &scenes[world % 64].rays[..RAYS];
    let isa = Isa::detect();
    let mut worlds = Worlds::<f32>::new(WORLDS, OBJECTS, isa, |_, _| true);
    let mut swept = worlds.rays(RAYS);
    for world in 0..WORLDS {
        for (object, Aabb { min, max }) in boxes(world).iter().enumerate() {
            worlds
                .set(world, object, min.as_dvec3(), max.as_dvec3())
                .expect("a finite box");
        }
        for (i, ray) in rays(world).iter().enumerate() {
            let (from, toward) = (ray.origin().as_dvec3(), ray.direction().as_dvec3());
            swept
                .set(world, i, from, toward, f64::INFINITY)
                .expect("a finite ray");
        }
    }
    let alone: Vec<Space<Bvh>> = (0..WORLDS)
        .map(|w| Space::new(boxes(w)).expect("finite boxes"))
        .collect();
    let cast = |space: &Space<Bvh>, ray: &Cast| space.cast(ray, space.boxes()).is_some();

    println!("\n### {WORLDS} worlds of {OBJECTS} objects\n");
    println!("| | pairs | {RAYS} rays |\n|---|--:|--:|");
    print(
        &format!("lanes, {isa}"),
        &mut || black_box(&worlds).near(0.0).block(0).len(),
        &mut || usize::from(worlds.cast(black_box(&swept)).is_ok()),
    );
    print(
        "a bvh each, one thread",
        &mut || alone.iter().map(|space| space.pairs().len()).sum(),
        &mut || {
            (0..WORLDS)
                .map(|w| rays(w).iter().filter(|ray| cast(&alone[w], ray)).count())
                .sum()
        },
    );
}

fn print(name: &str, pairs: &mut dyn FnMut() -> usize, rays: &mut dyn FnMut() -> usize) {
    let time = |work: &mut dyn FnMut() -> usize| {
        let took = median(&mut || Some(work())).map(|(time, _)| time);
        figure(took.map(|t| 1e6 * t.as_secs_f64() / WORLDS as f64))
    };
    println!("| {name} | {} | {} |", time(pairs), time(rays));
}
