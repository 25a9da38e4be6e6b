//! Shapes as shaders read them.

use super::device::Gpu;
use crate::scene::{Form, Item, Scene};
use glam::{DMat3, DVec3, Vec3};
use model::{Geometry, Pose};
use std::ops::Range;

/// The triangles of all meshes and hulls of a scene.
#[derive(Debug)]
pub(super) struct Meshes {
    /// Position and normal of each corner, from the middle of the mesh, six numbers.
    pub vertices: wgpu::Buffer,
    /// Of each item of the scene; empty for one that is no mesh.
    pub ranges: Vec<Range<u32>>,
}

impl Meshes {
    pub fn new(gpu: &Gpu, scene: &Scene) -> Self {
        let mut numbers: Vec<f32> = Vec::new();
        let mut ranges = Vec::new();
        for item in &scene.items {
            let first = numbers.len() as u32 / 6;
            for (corners, normal) in triangles(item) {
                let both =
                    |p: DVec3| [p.as_vec3().to_array(), normal.as_vec3().to_array()].concat();
                numbers.extend(corners.map(both).concat());
            }
            ranges.push(first..numbers.len() as u32 / 6);
        }
        Self {
            vertices: gpu.buffer(bytemuck::cast_slice(&numbers), wgpu::BufferUsages::VERTEX),
            ranges,
        }
    }
}

type Triangle = ([DVec3; 3], DVec3);

/// Corners, from the middle of the item's box, and a normal.
fn triangles(item: &Item) -> Vec<Triangle> {
    match &item.form {
        Form::Mesh(mesh) => mesh.all().collect(),
        Form::Hull { hull, .. } => hull
            .faces()
            .map(|face| {
                let [a, b, c] = face.map(|p| p - item.center);
                ([a, b, c], (b - a).cross(c - a).normalize_or_zero())
            })
            .collect(),
        Form::Solid(_) | Form::Plane => Vec::new(),
    }
}

/// Whether it is drawn as triangles.
pub(super) fn is_mesh(item: &Item) -> bool {
    matches!(item.form, Form::Mesh(_) | Form::Hull { .. })
}

/// Words of a `Shape` in the shader.
pub(super) const WORDS: usize = 24;

/// As the shader reads it, from a camera's place.
pub(super) fn words(item: &Item, bodies: &[Pose], eye: DVec3) -> [u32; WORDS] {
    let pose = item.placed(bodies);
    let axes = DMat3::from_quat(pose.orientation);
    let [x, y, z] = [axes.x_axis, axes.y_axis, axes.z_axis].map(DVec3::as_vec3);
    let center = (pose.point(item.center) - eye).as_vec3();
    let half = item.half.as_vec3();
    let (kind, radius, half_height) = kind(item);
    let mut words = Vec::with_capacity(WORDS);
    let mut row =
        |v: Vec3, last: u32| words.extend([v.x.to_bits(), v.y.to_bits(), v.z.to_bits(), last]);
    row(x, radius.to_bits());
    row(y, half_height.to_bits());
    row(z, kind);
    row(center, item.shape.0 as u32);
    row(half, item.body.map_or(-1, |body| body.0 as i32) as u32);
    row(item.color, item.opacity.to_bits());
    std::array::from_fn(|i| words[i])
}

/// The shader's number of a kind, radius and half height [m] where it has them.
fn kind(item: &Item) -> (u32, f32, f32) {
    let of = |kind, radius: &f64, half_height: &f64| (kind, *radius as f32, *half_height as f32);
    match &item.form {
        Form::Solid(Geometry::Sphere { radius }) => of(0, radius, radius),
        Form::Solid(Geometry::Ellipsoid { .. }) => (1, 0.0, 0.0),
        Form::Solid(Geometry::Capsule {
            radius,
            half_height,
        }) => of(2, radius, half_height),
        Form::Solid(Geometry::Cylinder {
            radius,
            half_height,
        }) => of(3, radius, half_height),
        Form::Solid(Geometry::Cone {
            radius,
            half_height,
        }) => of(4, radius, half_height),
        Form::Solid(_) => (5, 0.0, 0.0),
        Form::Plane if item.half.is_finite() => (6, 0.0, 0.0),
        Form::Plane => (7, 0.0, 0.0),
        Form::Hull { .. } | Form::Mesh(_) => (8, 0.0, 0.0),
    }
}
