//! Lamps as shaders read them, and the pictures of what they see, of which shadows are made.

use super::device::Gpu;
use super::pipelines::Pipelines;
use super::targets::{Grid, Target};
use crate::lamp::PlacedLamp;
use crate::scene::Scene;
use crate::view::View;
use glam::{DMat3, DMat4, DVec3, DVec4};
use model::{Lamp, LampKind, Pose};
use std::f64::consts::FRAC_PI_3;

/// Bytes from a tile to the next where it is a uniform, a multiple of what cards ask for.
const STRIDE: usize = 256;
/// Edge of the pictures of all lamps together [texel], about; and of one at most.
const ALL_TEXELS: usize = 4096;
const MOST_TEXELS: usize = 2048;
/// Texels of a picture for each pixel of the camera's, along an edge, and no fewer than these.
const DETAIL: usize = 3;
const LEAST_TEXELS: usize = 256;
/// A wider spot needs six pictures.
const WIDEST: f64 = FRAC_PI_3;
/// Nearest that is seen from a lamp, against the farthest.
const NEAREST: f64 = 1e-3;

/// What shines in all worlds that are drawn at once.
#[derive(Debug)]
pub(super) struct Lamps {
    /// Of the pictures, those of a world one after the other.
    pub grid: Grid,
    pub target: Target,
    /// Of each world.
    pub tiles: usize,
    /// Of each world.
    pub count: usize,
    /// Of pictures, lamps and tiles, for what is lit.
    pub bindings: wgpu::BindGroup,
    /// Of one tile, at an offset.
    pub onto: wgpu::BindGroup,
}

/// What a lamp sees in one of its pictures.
struct Tile {
    /// From a position to the picture.
    clip: DMat4,
    /// Width of a texel: in metres, or in metres at depth 1 m.
    texel: f64,
}

impl Lamps {
    /// Of some worlds, in which cameras are at these places.
    pub fn new(
        gpu: &Gpu,
        pipelines: &Pipelines,
        scene: &Scene,
        view: &View,
        worlds: &[(&[Pose], DVec3)],
    ) -> Self {
        let mut lamps = view.light(scene).all();
        lamps.retain(|_| view.channels.rgb);
        let tiles: usize = lamps.iter().map(pictures).sum();
        let edge = texels(view, tiles * worlds.len());
        let grid = Grid::of((tiles * worlds.len()).max(1), (edge, edge), gpu);
        let mut shares = grid.shares();
        let (mut lamp_words, mut tile_words, mut uniform) = (Vec::new(), Vec::new(), Vec::new());
        for (bodies, eye) in worlds {
            let seen = Seen::new(scene, bodies, *eye);
            for lamp in &lamps {
                let first = uniform.len() / (STRIDE / 4);
                let lamp = PlacedLamp::new(lamp, bodies);
                let place = place(&lamp, *eye);
                lamp_words.extend(self::lamp_words(&lamp, place, first));
                let tiles = seen.tiles(&lamp, place, edge);
                for (tile, share) in tiles.iter().zip(&mut shares) {
                    let words = self::tile_words(&lamp, place, tile, share);
                    tile_words.extend(words);
                    uniform.extend(words);
                    uniform.resize(uniform.len().next_multiple_of(STRIDE / 4), 0.0);
                }
            }
        }
        let target = Target::depths(gpu, &grid);
        let storage = wgpu::BufferUsages::STORAGE;
        let lamp_buffer = gpu.buffer(bytemuck::cast_slice(&lamp_words), storage);
        let tile_buffer = gpu.buffer(bytemuck::cast_slice(&tile_words), storage);
        let uniform = gpu.buffer(bytemuck::cast_slice(&uniform), wgpu::BufferUsages::UNIFORM);
        Self {
            bindings: bindings(gpu, pipelines, &target, &lamp_buffer, &tile_buffer),
            onto: onto(gpu, pipelines, &uniform),
            tiles,
            count: lamps.len(),
            grid,
            target,
        }
    }

    /// Where a world's tiles lie in the uniform [byte].
    pub fn offsets(&self, world: usize) -> impl Iterator<Item = u32> {
        let first = world * self.tiles;
        (first..first + self.tiles).map(|tile| (tile * STRIDE) as u32)
    }
}

/// Number of pictures that a lamp's shadows are made of.
fn pictures(lamp: &Lamp) -> usize {
    match lamp.kind {
        _ if !lamp.shadows => 0,
        LampKind::Parallel => 1,
        LampKind::Spot { cutoff, .. } if cutoff <= WIDEST => 1,
        LampKind::Point | LampKind::Spot { .. } => 6,
    }
}

/// Edge of each of so many pictures [texel].
fn texels(view: &View, pictures: usize) -> usize {
    if pictures == 0 {
        return 1;
    }
    let detail = DETAIL * view.camera.width.max(view.camera.height);
    let room = ALL_TEXELS / (pictures as f64).sqrt().ceil() as usize;
    let wanted = detail.clamp(LEAST_TEXELS, MOST_TEXELS);
    wanted.min(room).max(16)
}

/// Where a lamp is, from the camera; where parallel light comes from.
fn place(lamp: &PlacedLamp, eye: DVec3) -> DVec3 {
    match lamp.lamp.kind {
        LampKind::Parallel => -lamp.along,
        LampKind::Point | LampKind::Spot { .. } => lamp.position - eye,
    }
}

/// The `Lamp` of the shader, whose first tile has this row.
fn lamp_words(
    &PlacedLamp { lamp, along, .. }: &PlacedLamp,
    place: DVec3,
    tile: usize,
) -> [u32; 20] {
    let (kind, cutoff, exponent) = match lamp.kind {
        LampKind::Parallel => (0, 0.0, 0.0),
        LampKind::Point => (1, 0.0, 0.0),
        LampKind::Spot { cutoff, exponent } => (2, cutoff.cos(), exponent),
    };
    let number = |x: f64| (x as f32).to_bits();
    let row = |v: DVec3, last: u32| [number(v.x), number(v.y), number(v.z), last];
    let rows = [
        row(place, kind),
        row(along, number(cutoff)),
        row(lamp.color.as_dvec3(), number(exponent)),
        row(lamp.attenuation, tile as u32),
        [pictures(lamp) as u32, 0, 0, 0],
    ];
    std::array::from_fn(|i| rows[i / 4][i % 4])
}

/// The `Tile` of the shader.
fn tile_words(
    lamp: &PlacedLamp,
    place: DVec3,
    tile: &Tile,
    [corner, size]: [[f32; 2]; 2],
) -> [f32; 28] {
    let parallel = f32::from(u8::from(lamp.lamp.kind == LampKind::Parallel));
    let place = place.as_vec3().extend(parallel).to_array();
    let rest = [
        place,
        [corner[0], corner[1], size[0], size[1]],
        [tile.texel as f32, 0.0, 0.0, 0.0],
    ];
    let clip = tile.clip.as_mat4().to_cols_array();
    std::array::from_fn(|i| {
        if i < 16 {
            clip[i]
        } else {
            rest[i / 4 - 4][i % 4]
        }
    })
}

/// The corners of the boxes about all that throws shadows, from the camera.
struct Seen(Vec<DVec3>);

impl Seen {
    fn new(scene: &Scene, bodies: &[Pose], eye: DVec3) -> Self {
        let casting = scene.items.iter().filter(|item| item.half.is_finite());
        let corners = casting.flat_map(|item| item.corners(&item.placed(bodies)));
        Self(corners.map(|p| p - eye).collect())
    }

    fn tiles(&self, lamp: &PlacedLamp, place: DVec3, edge: usize) -> Vec<Tile> {
        // Beside the margin of a tile no shadow is looked for.
        let margin = 1.0 / (1.0 - 6.0 / edge as f64);
        match (pictures(lamp.lamp), lamp.lamp.kind) {
            (0, _) => Vec::new(),
            (_, LampKind::Parallel) => vec![self.seen_from_afar(place, edge)],
            (1, LampKind::Spot { cutoff, .. }) => {
                vec![self.seen_from(place, lamp.along, margin * cutoff.tan(), edge)]
            }
            _ => {
                let sides = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
                sides
                    .map(|along| self.seen_from(place, along, margin, edge))
                    .collect()
            }
        }
    }

    /// As parallel light sees it.
    fn seen_from_afar(&self, to_lamp: DVec3, edge: usize) -> Tile {
        let (a, b) = to_lamp.any_orthonormal_pair();
        let axes = DMat3::from_cols(a, b, to_lamp).transpose();
        let seen = self.0.iter().map(|p| axes * *p).map(|p| [p, p]);
        let bounds = seen.reduce(|[low, high], [p, q]| [low.min(p), high.max(q)]);
        let [low, high] = bounds.unwrap_or([DVec3::NEG_ONE, DVec3::ONE]);
        // A share for the width of texels.
        let half = 0.51 * (high - low).max(DVec3::splat(1e-6));
        let middle = 0.5 * (low + high);
        let across = |axis: DVec3, i: usize| (axis / half[i]).extend(-middle[i] / half[i]);
        let depth = (-0.5 * to_lamp / half.z).extend(0.5 + 0.5 * middle.z / half.z);
        let rows = [across(a, 0), across(b, 1), depth, DVec4::W];
        Tile {
            clip: DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose(),
            texel: 2.0 * half.x.max(half.y) / edge as f64,
        }
    }

    /// As it is seen from a place in a direction, up to an angle of this tangent: with depth d, from n to f,
    /// (d − n) f / (f − n) is drawn, and divided by d.
    fn seen_from(&self, place: DVec3, along: DVec3, tangent: f64, edge: usize) -> Tile {
        let (a, b) = along.any_orthonormal_pair();
        let distances = self.0.iter().map(|p| p.distance(place));
        let far = distances.fold(1e-6, f64::max);
        let near = NEAREST * far;
        let scale = far / (far - near);
        let from_place = |axis: DVec3, more: f64| axis.extend(more - axis.dot(place));
        let rows = [
            from_place(a / tangent, 0.0),
            from_place(b / tangent, 0.0),
            from_place(scale * along, -scale * near),
            from_place(along, 0.0),
        ];
        Tile {
            clip: DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose(),
            texel: 2.0 * tangent / edge as f64,
        }
    }
}

fn bindings(
    gpu: &Gpu,
    pipelines: &Pipelines,
    target: &Target,
    lamps: &wgpu::Buffer,
    tiles: &wgpu::Buffer,
) -> wgpu::BindGroup {
    let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        compare: Some(wgpu::CompareFunction::LessEqual),
        ..Default::default()
    });
    let resources = [
        wgpu::BindingResource::TextureView(&target.depth),
        wgpu::BindingResource::Sampler(&sampler),
        lamps.as_entire_binding(),
        tiles.as_entire_binding(),
    ];
    let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
    let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipelines.lamps,
        entries: &entries,
    })
}

fn onto(gpu: &Gpu, pipelines: &Pipelines, tiles: &wgpu::Buffer) -> wgpu::BindGroup {
    let tile = wgpu::BufferBinding {
        buffer: tiles,
        offset: 0,
        size: std::num::NonZeroU64::new(STRIDE as u64),
    };
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipelines.onto,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(tile),
        }],
    })
}
