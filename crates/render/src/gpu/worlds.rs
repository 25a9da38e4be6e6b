//! Worlds as shaders read them, and what is drawn of each.

use super::device::Gpu;
use super::pipelines::Pipelines;
use super::shapes::{self, WORDS, is_mesh};
use super::targets::{Grid, Target};
use crate::scene::{Form, Item, Scene};
use crate::view::View;
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4, Vec3};
use model::Pose;
use std::ops::Range;

/// Shapes that are drawn together.
#[derive(Clone, Debug)]
pub(super) struct Drawn {
    /// The row of the item, if it is one and a mesh.
    pub mesh: Option<usize>,
    /// In the buffer of shapes.
    pub shapes: Range<u32>,
}

/// What is drawn of a world.
#[derive(Debug, Default)]
pub(super) struct World {
    /// Of its numbers in their buffer [byte].
    pub offset: u32,
    pub solid: Vec<Drawn>,
    /// What is seen through, the farthest first.
    pub clear: Vec<Drawn>,
    /// What throws shadows.
    pub casting: Vec<Drawn>,
}

/// All worlds that are drawn at once.
#[derive(Debug)]
pub(super) struct Worlds {
    pub all: Vec<World>,
    /// Of numbers and shapes.
    pub bindings: wgpu::BindGroup,
    pub sun: SunImage,
}

/// What the sun sees.
#[derive(Debug)]
pub(super) struct SunImage {
    pub grid: Grid,
    pub target: Target,
    pub bindings: wgpu::BindGroup,
}

/// Bytes from the numbers of a world to those of the next, a multiple of what cards ask for.
const STRIDE: usize = 512;
/// Edge of the sun's images of all worlds together [texel], about; and of one at most.
const SUN_TEXELS: usize = 4096;
const MOST_SUN_TEXELS: usize = 2048;
/// Texels of the sun's image for each pixel of the camera's, along an edge, and no fewer than these.
const SUN_DETAIL: usize = 3;
const LEAST_SUN_TEXELS: usize = 256;

/// Edge of the sun's image of each of so many worlds [texel].
fn sun_texels(view: &View, worlds: usize) -> usize {
    if !view.channels.rgb {
        return 1;
    }
    let detail = SUN_DETAIL * view.camera.width.max(view.camera.height);
    let room = SUN_TEXELS / (worlds as f64).sqrt().ceil() as usize;
    let wanted = detail.clamp(LEAST_SUN_TEXELS, MOST_SUN_TEXELS);
    wanted.min(room).max(16)
}

impl Worlds {
    pub fn new(
        gpu: &Gpu,
        pipelines: &Pipelines,
        scene: &Scene,
        view: &View,
        worlds: &[&[Pose]],
    ) -> Self {
        let edge = sun_texels(view, worlds.len());
        let grid = Grid::of(worlds.len(), (edge, edge), gpu);
        let (mut numbers, mut words, mut all) = (Vec::new(), Vec::new(), Vec::new());
        for ((i, bodies), tile) in worlds.iter().enumerate().zip(grid.shares()) {
            let eye = view.camera.placed(bodies);
            let eye = Pose::new(eye.position, eye.orientation.normalize());
            numbers.resize(i * STRIDE / 4, 0.0);
            numbers.extend(self::numbers(scene, view, bodies, &eye, edge, tile));
            let first = (words.len() / WORDS) as u32;
            let order = Order::new(scene, bodies, eye.position);
            let shapes = order
                .rows()
                .map(|row| shapes::words(&scene.items[row], bodies, eye.position));
            words.extend(shapes.flatten());
            all.push(World {
                offset: (i * STRIDE) as u32,
                ..order.drawn(first)
            });
        }
        numbers.resize(worlds.len() * STRIDE / 4, 0.0);
        words.resize(words.len().max(WORDS), 0);
        let numbers = gpu.buffer(bytemuck::cast_slice(&numbers), wgpu::BufferUsages::UNIFORM);
        let shapes = gpu.buffer(bytemuck::cast_slice(&words), wgpu::BufferUsages::STORAGE);
        Self {
            all,
            bindings: bindings(gpu, pipelines, &numbers, &shapes),
            sun: SunImage::new(gpu, pipelines, grid),
        }
    }
}

/// Rows of items in the order in which they are drawn.
struct Order {
    /// Endless planes, then solids that throw shadows.
    endless: Vec<usize>,
    solids: Vec<usize>,
    meshes: Vec<usize>,
    /// What is seen through, the farthest first.
    clear: Vec<(usize, bool)>,
}

impl Order {
    fn new(scene: &Scene, bodies: &[Pose], eye: DVec3) -> Self {
        let mut order = Self {
            endless: Vec::new(),
            solids: Vec::new(),
            meshes: Vec::new(),
            clear: Vec::new(),
        };
        for (row, item) in scene.items.iter().enumerate() {
            let endless = matches!(item.form, Form::Plane) && !item.half.is_finite();
            match item {
                _ if item.opacity < 1.0 => order.clear.push((row, is_mesh(item))),
                _ if endless => order.endless.push(row),
                _ if is_mesh(item) => order.meshes.push(row),
                _ => order.solids.push(row),
            }
        }
        let distance = |item: &Item| item.placed(bodies).point(item.center).distance(eye);
        let distances: Vec<f64> = scene.items.iter().map(distance).collect();
        order
            .clear
            .sort_by(|a, b| distances[b.0].total_cmp(&distances[a.0]));
        order
    }

    fn rows(&self) -> impl Iterator<Item = usize> {
        let clear = self.clear.iter().map(|(row, _)| row);
        let opaque = self.endless.iter().chain(&self.solids).chain(&self.meshes);
        opaque.chain(clear).copied()
    }

    /// Of a world whose first shape has this place in the buffer.
    fn drawn(&self, first: u32) -> World {
        let count = |rows: &[usize]| rows.len() as u32;
        let solids = first + count(&self.endless);
        let meshes = solids + count(&self.solids);
        let clear = meshes + count(&self.meshes);
        let one = |place: u32, mesh| Drawn {
            mesh,
            shapes: place..place + 1,
        };
        let boxes = |shapes| Drawn { mesh: None, shapes };
        let meshes: Vec<Drawn> = (meshes..)
            .zip(&self.meshes)
            .map(|(at, row)| one(at, Some(*row)))
            .collect();
        let seen_through = (clear..).zip(&self.clear);
        let seen_through = seen_through.map(|(at, (row, mesh))| one(at, mesh.then_some(*row)));
        let with = |shapes: Range<u32>| [&[boxes(shapes)], &meshes[..]].concat();
        World {
            offset: 0,
            solid: with(first..solids + count(&self.solids)),
            casting: with(solids..solids + count(&self.solids)),
            clear: seen_through.collect(),
        }
    }
}

/// The `World` of the shader.
fn numbers(
    scene: &Scene,
    view: &View,
    bodies: &[Pose],
    eye: &Pose,
    edge: usize,
    [corner, size]: [[f32; 2]; 2],
) -> Vec<f32> {
    let (camera, light) = (&view.camera, view.light(scene));
    let (width, height) = (camera.width as f64, camera.height as f64);
    let towards = |u, v| eye.direction(camera.unproject(DVec2::new(u, v)));
    let first = towards(0.0, 0.0);
    let to_sun = light.to_sun.normalize();
    let (sun_clip, texel) = sun_clip(scene, to_sun, bodies, eye.position, edge);
    let shadows = light.shadows && light.sun != Vec3::ZERO;
    let samples = view.samples as f64;
    let mut numbers = Vec::with_capacity(STRIDE / 4);
    numbers.extend(clip(view, eye).as_mat4().to_cols_array());
    numbers.extend(sun_clip.as_mat4().to_cols_array());
    let mut row = |v: Vec3, last: f32| numbers.extend([v.x, v.y, v.z, last]);
    row(first.as_vec3(), camera.near as f32);
    row((towards(width, 0.0) - first).as_vec3(), camera.far as f32);
    let pixel = 1.0 / (camera.focal().min_element() * samples);
    row((towards(0.0, height) - first).as_vec3(), pixel as f32);
    row(
        eye.direction(DVec3::NEG_Z).as_vec3(),
        view.checker(scene) as f32,
    );
    row(scene.up.as_vec3(), if shadows { texel as f32 } else { 0.0 });
    row(to_sun.as_vec3(), corner[0]);
    row(light.sun, corner[1]);
    row(light.sky, size[0]);
    row(light.ground, size[1]);
    row(light.zenith, 0.0);
    row(light.horizon, 0.0);
    numbers
}

/// From a place along the world's axes, from the camera, to the image: with x, y and depth d along the
/// camera's axes, (2 cx / W − 1) d + 2 fx / W x, (1 − 2 cy / H) d + 2 fy / H y, near, and d.
fn clip(view: &View, eye: &Pose) -> DMat4 {
    let camera = &view.camera;
    let size = DVec2::new(camera.width as f64, camera.height as f64);
    let (focal, principal) = (2.0 * camera.focal() / size, 2.0 * camera.principal() / size);
    let [right, up, back] = DVec3::AXES.map(|axis| eye.direction(axis));
    let rows = [
        (focal.x * right - (principal.x - 1.0) * back).extend(0.0),
        (focal.y * up - (1.0 - principal.y) * back).extend(0.0),
        DVec4::new(0.0, 0.0, 0.0, camera.near),
        (-back).extend(0.0),
    ];
    DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose()
}

/// From there to the sun's image, which holds all that throws shadows; and a texel's width [m].
fn sun_clip(
    scene: &Scene,
    to_sun: DVec3,
    bodies: &[Pose],
    eye: DVec3,
    edge: usize,
) -> (DMat4, f64) {
    let (a, b) = to_sun.any_orthonormal_pair();
    let axes = DMat3::from_cols(a, b, to_sun).transpose();
    let casting = scene.items.iter().filter(|item| item.half.is_finite());
    let corners = casting.flat_map(|item| item.corners(&item.placed(bodies)));
    let seen = corners.map(|p| axes * (p - eye)).map(|p| [p, p]);
    let bounds = seen.reduce(|[low, high], [p, q]| [low.min(p), high.max(q)]);
    let [low, high] = bounds.unwrap_or([DVec3::NEG_ONE, DVec3::ONE]);
    // A share for the width of texels.
    let half = 0.51 * (high - low).max(DVec3::splat(1e-6));
    let middle = 0.5 * (low + high);
    let across = |axis: DVec3, i: usize| (axis / half[i]).extend(-middle[i] / half[i]);
    let depth = (-0.5 * to_sun / half.z).extend(0.5 + 0.5 * middle.z / half.z);
    let rows = [across(a, 0), across(b, 1), depth, DVec4::W];
    let texel = 2.0 * half.x.max(half.y) / edge as f64;
    (
        DMat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose(),
        texel,
    )
}

fn bindings(
    gpu: &Gpu,
    pipelines: &Pipelines,
    numbers: &wgpu::Buffer,
    shapes: &wgpu::Buffer,
) -> wgpu::BindGroup {
    let world = wgpu::BufferBinding {
        buffer: numbers,
        offset: 0,
        size: std::num::NonZeroU64::new(STRIDE as u64),
    };
    let entries = [
        wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(world),
        },
        wgpu::BindGroupEntry {
            binding: 1,
            resource: shapes.as_entire_binding(),
        },
    ];
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipelines.world,
        entries: &entries,
    })
}

impl SunImage {
    fn new(gpu: &Gpu, pipelines: &Pipelines, grid: Grid) -> Self {
        let target = Target::sun(gpu, &grid);
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::LessEqual),
            ..Default::default()
        });
        let entries = [
            wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&target.depth),
            },
            wgpu::BindGroupEntry {
                binding: 1,
                resource: wgpu::BindingResource::Sampler(&sampler),
            },
        ];
        let bindings = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipelines.sun_image,
            entries: &entries,
        });
        Self {
            grid,
            target,
            bindings,
        }
    }
}
