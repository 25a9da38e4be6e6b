//! The shapes of a world where they are now, and a tree of boxes about them.
//!
//! A scene is kept until the bodies may have moved; then its boxes move on with them.

use crate::device::each_once;
use crate::meshes::{Meshes, Triangles};
use crate::{Simulation, SimulationError};
use glam::{DVec3, Vec3};
use model::{BodyId, Geometry, Model, Pose, Shape, ShapeId};
use numbers::Float;
use rayon::prelude::*;
use space::{Aabb, Bvh, Space};
use std::sync::Arc;

/// In single precision origins, directions and times are off by so large a share of all lengths, at
/// most. (Each rounds by 6e-8.)
pub(crate) const ROUNDING: f64 = 1e-6;

/// The scenes of the worlds that were asked about, and what is known of their meshes.
#[derive(Debug, Default)]
pub(crate) struct Scenes {
    meshes: Meshes,
    /// Of each world that was asked about; with the moment at which bodies were as it has them.
    kept: Vec<Option<(u64, Scene)>>,
}

impl Scenes {
    fn is_old(&self, world: usize, moment: u64) -> bool {
        let kept = self.kept.get(world).and_then(Option::as_ref);
        kept.is_none_or(|(made, _)| *made != moment)
    }
}

/// A shape where it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solid<'a> {
    pub shape: ShapeId,
    pub of: &'a Shape,
    /// If it is a mesh.
    pub triangles: Option<&'a Triangles>,
    pub pose: Pose,
}

impl<'a> Solid<'a> {
    pub fn geometry(&self) -> &'a Geometry {
        self.triangles
            .map_or(&self.of.geometry, |triangles| &triangles.geometry)
    }
    /// The frame that a mesh's triangles are in.
    pub fn frame(&self) -> Pose {
        self.pose * Pose::at(self.geometry().center())
    }
    /// Radius of a ball about that frame's origin that holds the mesh [m].
    pub fn radius(&self) -> f64 {
        self.geometry().half_extents().map_or(0.0, DVec3::length)
    }
}

/// Middle and half extents [m] of a box about a geometry in its place; infinite about a plane.
pub(crate) fn around(geometry: &Geometry, pose: &Pose) -> [DVec3; 2] {
    let Some(half) = geometry.half_extents() else {
        return [DVec3::ZERO, DVec3::INFINITY];
    };
    let reach = if matches!(geometry, Geometry::Sphere { .. }) {
        half
    } else {
        // |R| times that along its own axes.
        let axes = DVec3::AXES.map(|axis| pose.direction(axis).abs());
        axes[0] * half.x + axes[1] * half.y + axes[2] * half.z
    };
    [pose.point(geometry.center()), reach]
}

/// The shapes of a world, and the boxes about them. Meshes that are the names of files are read.
#[derive(Debug)]
pub(crate) struct Scene {
    model: Arc<Model>,
    shapes: Vec<(ShapeId, Option<Arc<Triangles>>)>,
    poses: Vec<Pose>,
    /// The other shapes: meshes whose files cannot be read, and why.
    pub unread: Vec<(ShapeId, String)>,
    pub space: Space<Bvh>,
    /// No coordinate of a box that ends is larger [m].
    pub reach: f64,
}

impl Scene {
    /// With bodies placed so, and no boxes yet.
    fn new(model: Arc<Model>, meshes: &mut Meshes) -> Self {
        let (mut shapes, mut unread) = (Vec::new(), Vec::new());
        for (i, shape) in model.shapes.iter().enumerate() {
            match meshes.read(shape) {
                Ok(triangles) => shapes.push((ShapeId(i), triangles)),
                Err(reason) => unread.push((ShapeId(i), reason.to_string())),
            }
        }
        Self {
            unread,
            poses: vec![Pose::IDENTITY; shapes.len()],
            space: Space::new(&[]).expect("no boxes"),
            reach: 0.0,
            shapes,
            model,
        }
    }

    /// The same with bodies placed so.
    fn placed(mut self, bodies: &[Pose]) -> Result<Self, SimulationError> {
        for ((shape, _), pose) in self.shapes.iter().zip(&mut self.poses) {
            let shape = &self.model.shapes[shape.0];
            let carrier = shape.body.map_or(Pose::IDENTITY, |body| bodies[body.0]);
            *pose = carrier * shape.pose;
        }
        let boxes = self.solids().map(|solid| {
            let [middle, half] = around(solid.geometry(), &solid.pose);
            if half.is_finite() {
                Aabb::enclosing(middle - half, middle + half)
            } else {
                Aabb::new(Vec3::NEG_INFINITY, Vec3::INFINITY)
            }
        });
        let boxes = Vec::from_iter(boxes);
        let corners = boxes.iter().flat_map(|b| [b.min, b.max]);
        let sizes = corners.map(|corner| f64::from(corner.abs().max_element()));
        self.reach = sizes.filter(|size| size.is_finite()).fold(0.0, f64::max);
        if self.space.boxes().all().len() == boxes.len() {
            self.space.update(&boxes)?;
        } else {
            self.space = Space::new(&boxes)?;
        }
        Ok(self)
    }

    pub fn solid(&self, row: u32) -> Solid<'_> {
        let (shape, triangles) = &self.shapes[row as usize];
        Solid {
            shape: *shape,
            of: self.shape(*shape),
            triangles: triangles.as_deref(),
            pose: self.poses[row as usize],
        }
    }

    pub fn shape(&self, shape: ShapeId) -> &Shape {
        &self.model.shapes[shape.0]
    }

    fn solids(&self) -> impl Iterator<Item = Solid<'_>> {
        (0..self.shapes.len()).map(|row| self.solid(row as u32))
    }
}

impl<T: Float> Simulation<T> {
    /// The scene of a world that was brought [up to date](Simulation::update_scenes).
    #[inline]
    pub(crate) fn scene(&self, world: usize) -> &Scene {
        let kept = self.scenes.kept[world].as_ref();
        &kept.expect("worlds are brought up to date").1
    }

    /// Brings the scenes of some worlds to where their shapes are now.
    #[inline]
    pub(crate) fn update_scenes(&mut self, worlds: &[usize]) -> Result<(), SimulationError> {
        let is_old = |world: &usize| self.scenes.is_old(*world, self.moment);
        if worlds.iter().any(is_old) {
            self.place_scenes(worlds)?;
        }
        Ok(())
    }

    fn place_scenes(&mut self, worlds: &[usize]) -> Result<(), SimulationError> {
        let moment = self.moment;
        let mut old = worlds.to_vec();
        each_once(&mut old);
        old.retain(|world| self.scenes.is_old(*world, moment));
        self.scenes.kept.resize_with(self.worlds(), || None);
        let mut placed = Vec::with_capacity(old.len());
        let mut new = false;
        for world in old {
            let bodies = self.placements(world)?;
            let model = Arc::clone(self.world_model(world));
            let kept = self.scenes.kept[world].take();
            let kept = kept.map(|(_, scene)| scene);
            let kept = kept.filter(|scene| Arc::ptr_eq(&scene.model, &model));
            new |= kept.is_none();
            let scene = kept.unwrap_or_else(|| Scene::new(model, &mut self.scenes.meshes));
            placed.push((world, scene, bodies));
        }
        let scenes = placed
            .into_par_iter()
            .map(|(world, scene, bodies)| Ok((world, scene.placed(&bodies)?)));
        let scenes = self
            .threads
            .run(|| scenes.collect::<Result<Vec<_>, SimulationError>>());
        for (world, scene) in scenes? {
            self.scenes.kept[world] = Some((moment, scene));
        }
        if new {
            self.scenes.meshes.drop_unused();
        }
        Ok(())
    }

    /// Of each body of a world where it is now, with an orientation of unit length to double precision.
    fn placements(&mut self, world: usize) -> Result<Vec<Pose>, SimulationError> {
        let bodies = (0..self.model().bodies.len()).map(BodyId);
        self.fetch_motion()?;
        let outputs = self.last_reported();
        let placed = |body| {
            let orientation = outputs.body_orientation(world, body).normalize();
            Pose::new(outputs.body_position(world, body), orientation)
        };
        Ok(bodies.map(placed).collect())
    }
}
