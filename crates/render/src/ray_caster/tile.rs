//! A row of tiles of one image.

use super::color;
use super::sampling::within_pixel;
use super::world::{Hit, World};
use crate::view::Images;
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Edge of a tile [pixel].
pub(super) const EDGE: usize = 16;
/// Numbers that a thread fills, at least.
const FILLED_AT_ONCE: usize = 1 << 16;

/// Pixels of a few rows, in all channels that are wanted; the others are empty.
pub(super) struct Band<'a> {
    rgb: &'a mut [u8],
    depth: &'a mut [f32],
    body: &'a mut [i32],
    shape: &'a mut [i32],
    normal: &'a mut [f32],
}

/// A part of an image, and what may be in it.
pub(super) struct Tile<'a> {
    pub world: &'a World<'a>,
    columns: Range<usize>,
    rows: Range<usize>,
    /// In the order of the world.
    pub shapes: Vec<usize>,
}

impl<'a> Band<'a> {
    /// All rows of images that have room for them: nothing is seen yet.
    pub fn all(images: &'a mut Images) -> Self {
        let pixels = images.worlds * images.width * images.height;
        Self {
            rgb: fill(&mut images.rgb, 0, 3 * pixels),
            depth: fill(&mut images.depth, f32::INFINITY, pixels),
            body: fill(&mut images.body, -1, pixels),
            shape: fill(&mut images.shape, -1, pixels),
            normal: fill(&mut images.normal, 0.0, 3 * pixels),
        }
    }

    /// The next rows of a world, which are no longer of this one.
    pub fn split_off(&mut self, world: &World, rows: usize) -> Self {
        let pixels = world.view.camera.width * rows;
        Self {
            rgb: self.rgb.split_off_mut(..3 * pixels).unwrap_or_default(),
            depth: self.depth.split_off_mut(..pixels).unwrap_or_default(),
            body: self.body.split_off_mut(..pixels).unwrap_or_default(),
            shape: self.shape.split_off_mut(..pixels).unwrap_or_default(),
            normal: self.normal.split_off_mut(..3 * pixels).unwrap_or_default(),
        }
    }

    /// What is seen in some rows of a world.
    pub fn render(&mut self, world: &World, rows: Range<usize>) {
        let width = world.view.camera.width;
        let (top, bottom) = (rows.start as f64, rows.end as f64);
        let inside = |i: &usize| world.shapes[*i].low.y <= bottom && world.shapes[*i].high.y >= top;
        let shapes: Vec<usize> = (0..world.shapes.len()).filter(inside).collect();
        for left in (0..width).step_by(EDGE) {
            let columns = left..width.min(left + EDGE);
            let tile = Tile::new(world, columns, rows.clone(), &shapes);
            self.fill(&tile, width);
        }
    }

    fn fill(&mut self, tile: &Tile, width: usize) {
        let view = tile.world.view;
        let place = |(column, row): (usize, usize)| (row - tile.rows.start) * width + column;
        let places: Vec<usize> = tile.pixels().map(place).collect();
        let mut samples = Vec::with_capacity(places.len());
        if view.channels.geometric() || view.samples == 1 {
            tile.trace(DVec2::splat(0.5), &mut samples);
            for (sample, place) in samples.iter().zip(&places) {
                self.set_geometry(tile, sample, *place);
            }
        }
        if !view.channels.rgb {
            return;
        }
        let parts = view.samples * view.samples;
        let mut colors = vec![Vec3::ZERO; places.len()];
        for part in 0..parts {
            if view.samples > 1 {
                tile.trace(within_pixel(part, view.samples), &mut samples);
            }
            let points = samples.iter().filter_map(|sample| sample.point(tile.world));
            let lit = color::Lit::new(tile, points, part);
            for ((color, sample), pixel) in colors.iter_mut().zip(&samples).zip(tile.pixels()) {
                *color += lit.color(&tile.world.ray(sample.towards), sample.hit.as_ref(), pixel);
            }
        }
        for (color, place) in colors.into_iter().zip(places) {
            let mean = color::encode(color / parts as f32);
            self.rgb[3 * place..3 * place + 3].copy_from_slice(&mean);
        }
    }

    fn set_geometry(&mut self, tile: &Tile, sample: &Sample, place: usize) {
        let Some(hit) = &sample.hit else {
            return;
        };
        let item = tile.world.shapes[hit.shape].placed.item;
        if let Some(depth) = self.depth.get_mut(place) {
            *depth = (hit.distance / sample.towards.1) as f32;
        }
        if let Some(body) = self.body.get_mut(place) {
            *body = item.body.map_or(-1, |body| body.0 as i32);
        }
        if let Some(shape) = self.shape.get_mut(place) {
            *shape = item.shape.0 as i32;
        }
        if let Some(normal) = self.normal.get_mut(3 * place..3 * place + 3) {
            normal.copy_from_slice(&hit.normal.as_vec3().to_array());
        }
    }
}

/// The numbers of an image, if it is wanted: so many, all alike.
fn fill<T: Copy + Send + Sync>(image: &mut Option<Vec<T>>, with: T, numbers: usize) -> &mut [T] {
    let Some(image) = image else {
        return &mut [];
    };
    // By all threads: memory that is written to for the first time is slow.
    let all = rayon::iter::repeat_n(with, numbers);
    image.par_extend(all.with_min_len(FILLED_AT_ONCE));
    image
}

/// A ray of a pixel and what it meets.
struct Sample {
    /// Unit vector from the camera, and how far along it [m] depth is 1 m.
    towards: (DVec3, f64),
    hit: Option<Hit>,
}

impl Sample {
    /// Of what it meets, in the world [m].
    fn point(&self, world: &World) -> Option<DVec3> {
        let distance = self.hit.as_ref()?.distance;
        Some(world.eye + distance * self.towards.0)
    }
}

impl<'a> Tile<'a> {
    /// With those of some shapes that may be in it.
    fn new(
        world: &'a World<'a>,
        columns: Range<usize>,
        rows: Range<usize>,
        shapes: &[usize],
    ) -> Self {
        let (left, right) = (columns.start as f64, columns.end as f64);
        let inside =
            |i: &&usize| world.shapes[**i].low.x <= right && world.shapes[**i].high.x >= left;
        let shapes = shapes.iter().filter(inside).copied().collect();
        Self {
            world,
            columns,
            rows,
            shapes,
        }
    }

    /// Column and row of each pixel, row by row.
    fn pixels(&self) -> impl Iterator<Item = (usize, usize)> {
        let columns = self.columns.clone();
        self.rows
            .clone()
            .flat_map(move |row| columns.clone().map(move |column| (column, row)))
    }

    /// What the rays through a point of each pixel meet, from the pixel's upper left corner.
    fn trace(&self, at: DVec2, samples: &mut Vec<Sample>) {
        samples.clear();
        for (column, row) in self.pixels() {
            let pixel = DVec2::new(column as f64, row as f64);
            let towards = self.world.towards(pixel + at);
            let hit = self.world.first(&self.world.ray(towards), &self.shapes);
            samples.push(Sample { towards, hit });
        }
    }

    /// Lower and upper corner of the box about points.
    pub fn around(points: impl Iterator<Item = DVec3>) -> [DVec3; 2] {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for point in points {
            low = low.min(point);
            high = high.max(point);
        }
        [low, high]
    }
}
