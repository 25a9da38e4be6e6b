//! What light makes of what a ray meets.
//!
//! A surface scatters light evenly (Lambert), and shines a little where it faces half way between
//! a light and the eye (Blinn). Colours are linear until they are encoded.

use super::placed::Ray;
use super::sampling::{disc, hemisphere, turn};
use super::tile::Tile;
use super::world::{Hit, Seen};
use crate::lamp::PlacedLamp;
use crate::scene::Form;
use glam::{DVec2, DVec3, Vec3};
use std::cell::LazyCell;
use std::sync::LazyLock;

/// Brightness of the middle of the sun's reflection, against the sun.
const SHINE: f32 = 0.12;
/// Of every other square of a checker pattern, against the colour of the plane.
const DARKER: f32 = 0.86;
/// Where rays are steeper than this sine, endless planes are seen as they are; the flatter, the more
/// they look like the horizon.
const FLAT: f64 = 0.08;
/// Share of the light from behind below which it changes no colour by a step of its 8 bits.
const UNSEEN: f32 = 1e-4;
/// Share of the scene's size up to which things keep the sky from each other.
const OCCLUSION_REACH: f64 = 0.5;

/// The light on what one sample of each pixel of a tile meets.
pub(super) struct Lit<'a> {
    tile: &'a Tile<'a>,
    /// What may be between the points and the sun.
    casters: Vec<usize>,
    /// And between them and each lamp.
    lamps: Vec<Vec<usize>>,
    /// What may be between the points and the sky.
    occluders: Vec<usize>,
    part: usize,
    reach: f64,
    /// To the middle of the sun, a unit vector.
    sun: DVec3,
}

impl<'a> Lit<'a> {
    pub fn new(
        tile: &'a Tile<'a>,
        points: impl Iterator<Item = DVec3> + Clone,
        part: usize,
    ) -> Self {
        let world = tile.world;
        let reach = OCCLUSION_REACH * world.scene.extent;
        let any = points.clone().next().is_some();
        let those = |counts: &dyn Fn(&Seen) -> bool| {
            let shapes = world.shapes.iter().enumerate();
            let counted = shapes.filter(|(_, seen)| counts(seen));
            counted.map(|(i, _)| i).collect()
        };
        let mut casters = Vec::new();
        if any && world.light.shadows {
            let lit = Tile::around(points.clone().map(|p| world.sun * p));
            casters = those(&|seen| seen.shadows(lit, world.sun_spread()));
        }
        let around = LazyCell::new(|| Tile::around(points.clone()));
        let of_lamp = |lamp: &PlacedLamp| {
            if any && lamp.lamp.shadows {
                those(&|seen| lamp.is_before(&seen.placed, *around))
            } else {
                Vec::new()
            }
        };
        let lamps = world.lamps.iter().map(of_lamp).collect();
        let mut occluders = Vec::new();
        if any && world.view.occlusion > 0 {
            occluders = those(&|seen| seen.is_near(*around, reach));
        }
        Self {
            tile,
            casters,
            lamps,
            occluders,
            part,
            reach,
            sun: world.sun.row(2),
        }
    }

    /// What is seen along a ray of a pixel (column, row) that first meets this: surface after surface, until too
    /// little of what is behind shines through.
    pub fn color(&self, ray: &Ray, first: Option<&Hit>, pixel: (usize, usize)) -> Vec3 {
        let (scene, world) = (self.tile.world.scene, self.tile.world);
        let (mut color, mut left) = (Vec3::ZERO, 1.0);
        let (mut hit, mut lit, mut behind) = (first.copied(), self, None);
        while let Some(met) = hit {
            let opacity = world.shapes[met.shape].placed.item.opacity;
            color += left * opacity * lit.surface(ray, &met, pixel);
            left *= 1.0 - opacity;
            if left < UNSEEN {
                return color;
            }
            let rest = Ray {
                from: met.distance,
                ..*ray
            };
            hit = world.first(&rest, &self.tile.shapes);
            let point = hit.map(|hit| ray.at(hit.distance));
            lit = behind.insert(Self::new(self.tile, point.into_iter(), self.part));
        }
        color + left * world.light.background(ray.direction, scene.up)
    }

    fn surface(&self, ray: &Ray, hit: &Hit, pixel: (usize, usize)) -> Vec3 {
        let world = self.tile.world;
        let light = &world.light;
        let seen = &world.shapes[hit.shape];
        let point = ray.at(hit.distance);
        let open = self.open_sky(hit, point, pixel);
        let mut arriving = open * light.ambient(hit.normal, world.scene.up);
        let mut shine = Vec3::ZERO;
        let glossy = !matches!(seen.placed.item.form, Form::Plane);
        let mut add = |direction: DVec3, light: Vec3| {
            arriving += hit.normal.dot(direction) as f32 * light;
            if glossy {
                let half_way = (direction - ray.direction).normalize();
                shine += SHINE * (hit.normal.dot(half_way) as f32).powi(48) * light;
            }
        };
        let to_sun = self.to_sun(pixel);
        if hit.normal.dot(to_sun) > 0.0 && light.sun != Vec3::ZERO {
            add(to_sun, self.sunlight(hit, point, to_sun) * light.sun);
        }
        for (lamp, casters) in world.lamps.iter().zip(&self.lamps) {
            let arriving = lamp.at(point);
            if let Some(of) = arriving.filter(|of| hit.normal.dot(of.direction) > 0.0) {
                let way = off_surface(hit, point, of.direction, of.distance);
                add(of.direction, self.passing(hit, &way, casters) * of.light);
            }
        }
        match seen.placed.item.form {
            Form::Plane => self.plane(ray, hit, point, arriving),
            _ => seen.placed.item.color * arriving + shine,
        }
    }

    fn plane(&self, ray: &Ray, hit: &Hit, point: DVec3, arriving: Vec3) -> Vec3 {
        let world = self.tile.world;
        let placed = &world.shapes[hit.shape].placed;
        let steep = -ray.direction.dot(hit.normal);
        let mut color = placed.item.color * arriving;
        if world.checker > 0.0 {
            let view = world.view;
            // In squares.
            let scale = 1.0 / world.checker;
            let p = scale * placed.inside(point);
            let width = scale * hit.distance * world.pixel / view.samples as f64;
            let slant = (1.0 / steep) * placed.along(ray.direction).abs();
            let size = width * (DVec2::ONE + DVec2::new(slant.x, slant.z));
            let dark = checker(DVec2::new(p.x, p.z), size);
            color *= 1.0 - dark as f32 * (1.0 - DARKER);
        }
        if placed.radius.is_finite() {
            return color;
        }
        let x = (steep / FLAT).min(1.0);
        world
            .light
            .horizon
            .lerp(color, (x * x * (3.0 - 2.0 * x)) as f32)
    }

    /// Towards a point of the sun; towards its middle for a single sample.
    fn to_sun(&self, pixel: (usize, usize)) -> DVec3 {
        let world = self.tile.world;
        let parts = world.view.samples * world.view.samples;
        if parts == 1 {
            return self.sun;
        }
        let p = world.sun_spread() * disc(self.part, parts, turn(pixel));
        (world.sun.transpose() * p.extend(1.0)).normalize()
    }

    /// Share of the sun's light that arrives.
    fn sunlight(&self, hit: &Hit, point: DVec3, to_sun: DVec3) -> f32 {
        if self.casters.is_empty() {
            return 1.0;
        }
        let world = self.tile.world;
        let ray = off_surface(hit, point, to_sun, f64::INFINITY);
        let point = world.sun * point;
        let shadows = |i: &&usize| world.shapes[**i].shadows([point; 2], world.sun_spread());
        self.passing(hit, &ray, self.casters.iter().filter(shadows))
    }

    /// Share of light that comes along a ray from a surface, past some shapes.
    fn passing<'b>(
        &self,
        hit: &Hit,
        ray: &Ray,
        shapes: impl IntoIterator<Item = &'b usize>,
    ) -> f32 {
        let world = self.tile.world;
        let convex = world.shapes[hit.shape].placed.item.is_convex();
        let mut light = 1.0;
        for &i in shapes {
            let placed = &world.shapes[i].placed;
            let itself = convex && i == hit.shape;
            if !itself && placed.blocks(ray) {
                light *= 1.0 - placed.item.opacity;
            }
            if light == 0.0 {
                break;
            }
        }
        light
    }

    /// Share of the sky that a surface sees; what is far keeps less from it.
    fn open_sky(&self, hit: &Hit, point: DVec3, pixel: (usize, usize)) -> f32 {
        let world = self.tile.world;
        let rays = world.view.occlusion;
        if rays == 0 {
            return 1.0;
        }
        let count = rays * world.view.samples * world.view.samples;
        let open = (0..rays).map(|i| {
            let direction = hemisphere(hit.normal, self.part * rays + i, count, turn(pixel));
            let ray = off_surface(hit, point, direction, self.reach);
            let met = self
                .occluders
                .iter()
                .filter_map(|i| world.shapes[*i].placed.meet(&ray));
            let nearest = met.map(|(distance, _)| distance).fold(self.reach, f64::min);
            nearest / self.reach
        });
        (open.sum::<f64>() / rays as f64) as f32
    }
}

/// From just above a surface.
fn off_surface(hit: &Hit, point: DVec3, direction: DVec3, to: f64) -> Ray {
    let above = 1e-6 * hit.distance;
    Ray {
        origin: point + above * hit.normal,
        direction,
        from: 0.0,
        to,
    }
}

/// Share of a rectangle of a size about a point that odd squares of edge 1 cover: the product of the
/// means of square waves (Quilez, Filterable procedurals, 2017).
fn checker(middle: DVec2, size: DVec2) -> f64 {
    let wave = |x: f64| 2.0 * (fraction(0.5 * x) - 0.5).abs();
    let mean = |x: f64, w: f64| (wave(x - 0.5 * w) - wave(x + 0.5 * w)) / w;
    0.5 - 0.5 * mean(middle.x, size.x) * mean(middle.y, size.y)
}

/// What x is above the whole number below it; for numbers of any use, faster than the library's.
fn fraction(x: f64) -> f64 {
    let fraction = x - (x as i64) as f64;
    if fraction < 0.0 {
        fraction + 1.0
    } else {
        fraction
    }
}

/// Steps of the square root of a part of a colour.
const STEPS: usize = 4096;

/// In sRGB, by the square root.
static ENCODED: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let of = |i: usize| {
        let x = (i as f32 / STEPS as f32).powi(2);
        let encoded = if x <= 0.0031308 {
            12.92 * x
        } else {
            1.055 * x.powf(1.0 / 2.4) - 0.055
        };
        (255.0 * encoded).round() as u8
    };
    (0..=STEPS).map(of).collect()
});

/// As bytes in sRGB. What is brighter than 0.8 is drawn towards 1, which nothing exceeds.
#[inline]
pub(super) fn encode(color: Vec3) -> [u8; 3] {
    let part = |x: f32| {
        let x = if x > 0.8 { 1.0 - 0.04 / (x - 0.6) } else { x };
        ENCODED[(x.max(0.0).sqrt() * STEPS as f32 + 0.5) as usize]
    };
    [part(color.x), part(color.y), part(color.z)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checkers_cover_what_points_counted_in_a_rectangle_do() {
        let odd = |p: DVec2| (p.x.floor() + p.y.floor()).rem_euclid(2.0);
        for (middle, size) in [
            (DVec2::new(0.3, 0.4), DVec2::new(0.1, 0.2)),
            (DVec2::new(-1.1, 2.6), DVec2::new(0.7, 1.3)),
            (DVec2::new(5.9, -7.2), DVec2::new(3.1, 0.4)),
        ] {
            let n = 200;
            let at = |i: usize| DVec2::new((i % n) as f64, (i / n) as f64) + 0.5;
            let points = (0..n * n).map(|i| middle + size * (at(i) / n as f64 - 0.5));
            let counted = points.map(odd).sum::<f64>() / (n * n) as f64;
            let covered = checker(middle, size);
            assert!((covered - counted).abs() < 0.01, "{covered} {counted}");
        }
    }

    #[test]
    fn colours_are_encoded_as_srgb_and_never_wrap() {
        // 0.5 in sRGB is 0.2140 in linear light (IEC 61966-2-1).
        assert_eq!(encode(Vec3::new(0.0, 0.2140, 0.00304)), [0, 128, 10]);
        let bright = [0.8, 0.9, 1.0, 3.0, f32::INFINITY].map(|x| encode(Vec3::splat(x))[0]);
        assert!(bright.is_sorted() && bright[4] == 255, "{bright:?}");
        assert_eq!(encode(Vec3::splat(f32::NAN)), [0; 3]);
    }
}
