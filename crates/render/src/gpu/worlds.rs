//! Worlds as shaders read them, and what is drawn of each.

use super::device::Gpu;
use super::lamps::Lamps;
use super::pipelines::Pipelines;
use super::shapes::{self, WORDS, is_mesh};
use crate::scene::{Form, Item, Scene};
use crate::view::View;
use glam::{DMat4, DVec2, DVec3, DVec4, Vec3};
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
    pub lamps: Lamps,
}

/// Bytes from the numbers of a world to those of the next, a multiple of what cards ask for.
const STRIDE: usize = 512;

impl Worlds {
    pub fn new(
        gpu: &Gpu,
        pipelines: &Pipelines,
        scene: &Scene,
        view: &View,
        worlds: &[&[Pose]],
    ) -> Self {
        let eyes = worlds.iter().map(|bodies| {
            let eye = view.camera.placed(bodies);
            Pose::new(eye.position, eye.orientation.normalize())
        });
        let eyes: Vec<Pose> = eyes.collect();
        let places = eyes.iter().map(|eye| eye.position);
        let seen: Vec<_> = worlds.iter().copied().zip(places).collect();
        let lamps = Lamps::new(gpu, pipelines, scene, view, &seen);
        let (mut numbers, mut words, mut all) = (Vec::new(), Vec::new(), Vec::new());
        for ((i, bodies), eye) in worlds.iter().enumerate().zip(&eyes) {
            numbers.resize(i * STRIDE / 4, 0.0);
            numbers.extend(self::numbers(
                scene,
                view,
                eye,
                [i * lamps.count, lamps.count],
            ));
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
            lamps,
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

/// The `World` of the shader, whose first lamp has this row, and which has so many.
fn numbers(scene: &Scene, view: &View, eye: &Pose, [first_lamp, lamps]: [usize; 2]) -> Vec<f32> {
    let (camera, light) = (&view.camera, view.light(scene));
    let (width, height) = (camera.width as f64, camera.height as f64);
    let towards = |u, v| eye.direction(camera.unproject(DVec2::new(u, v)));
    let first = towards(0.0, 0.0);
    let samples = view.samples as f64;
    let mut numbers = Vec::with_capacity(STRIDE / 4);
    numbers.extend(clip(view, eye).as_mat4().to_cols_array());
    let mut row = |v: Vec3, last: f32| numbers.extend([v.x, v.y, v.z, last]);
    row(first.as_vec3(), camera.near as f32);
    row((towards(width, 0.0) - first).as_vec3(), camera.far as f32);
    let pixel = 1.0 / (camera.focal().min_element() * samples);
    row((towards(0.0, height) - first).as_vec3(), pixel as f32);
    row(
        eye.direction(DVec3::NEG_Z).as_vec3(),
        view.checker(scene) as f32,
    );
    row(scene.up.as_vec3(), first_lamp as f32);
    row(light.sky, lamps as f32);
    row(light.ground, 0.0);
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
