//! A renderer that needs nothing but processors: a ray for each sample, met exactly by every solid.
//!
//! Images are cut into tiles. What may be in a tile is told by the rectangles about the shapes in
//! the image, what may shade it from the sun by rectangles across the sun's direction (both found once for
//! each world), and from lamps by balls on the way; the few shapes that are left are met one after the other, the nearest first, and
//! the triangles of a mesh by a tree. Threads share the rows of tiles of all worlds. The same input gives
//! the same bytes on any number of threads.

mod color;
mod lamp;
mod placed;
mod sampling;
mod tile;
mod world;

use crate::{Images, RenderError, Scene, View};
use glam::DVec3;
use model::Pose;
use placed::{Placed, Ray};
use rayon::prelude::*;
use tile::Band;
use world::World;

/// Whether nothing that belongs to the world is between two points [m]; bodies are placed so.
pub(crate) fn sees(scene: &Scene, bodies: &[Pose], from: DVec3, to: DVec3) -> bool {
    let way = to - from;
    let ray = Ray {
        origin: from,
        direction: way.normalize_or(DVec3::X),
        from: 0.0,
        to: (1.0 - 1e-6) * way.length(),
    };
    let fixed = scene.items.iter().filter(|item| item.body.is_none());
    !fixed
        .into_iter()
        .any(|item| Placed::new(item, bodies).blocks(&ray))
}

/// What a camera sees in each of several worlds, whose bodies are placed so: `worlds[k][b]` is the
/// pose of body b in world k.
///
/// # Errors
/// Numbers of the camera, the light or the view that are out of range, a body or poses that do not fit
/// the scene, no worlds, or more than 2³¹ pixels in all.
pub fn render(scene: &Scene, view: &View, worlds: &[&[Pose]]) -> Result<Images, RenderError> {
    view.check(scene, worlds)?;
    let placed = worlds
        .par_iter()
        .map(|poses| World::new(scene, view, poses));
    let placed: Vec<World> = placed.collect();
    let mut images = Images::new(view, worlds.len())?;
    let (mut rest, mut bands) = (Band::all(&mut images), Vec::new());
    for world in &placed {
        for first in (0..view.camera.height).step_by(tile::EDGE) {
            let rows = first..view.camera.height.min(first + tile::EDGE);
            bands.push((world, rows.clone(), rest.split_off(world, rows.len())));
        }
    }
    let bands = bands.into_par_iter();
    bands.for_each(|(world, rows, mut band)| band.render(world, rows));
    Ok(images)
}
