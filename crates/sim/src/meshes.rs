//! The triangles of meshes in space, for what asks which of them are near.

use collide::mesh::{self, LoadError, Triangle};
use glam::DVec3;
use model::{Geometry, Shape, TriangleMesh};
use rigid::impulse::pair::Near;
use space::{Aabb, Bvh, Space};
use std::sync::Arc;

/// The meshes of a model's shapes; equal ones are one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Meshes {
    known: Vec<Arc<Triangles>>,
    /// Those of files, by name and scale.
    read: Vec<(String, DVec3, Arc<Triangles>)>,
}

impl Meshes {
    /// The triangles of a shape, if it is a mesh that is known.
    pub fn of(&mut self, shape: &Shape) -> Option<Arc<Triangles>> {
        let Geometry::Mesh(mesh) = &shape.geometry else {
            return None;
        };
        Some(self.triangles(mesh))
    }

    /// The same, and of a mesh that is the name of its file: that is read once.
    ///
    /// # Errors
    /// The file cannot be read, or is no mesh.
    pub fn read(&mut self, shape: &Shape) -> Result<Option<Arc<Triangles>>, LoadError> {
        let Geometry::MeshFile { file, scale } = &shape.geometry else {
            return Ok(self.of(shape));
        };
        let is_same = |(name, by, _): &&(String, DVec3, _)| name == file && by == scale;
        if let Some((_, _, known)) = self.read.iter().find(is_same) {
            return Ok(Some(Arc::clone(known)));
        }
        let triangles = self.triangles(&mesh::load(file, *scale)?);
        let read = (file.clone(), *scale, Arc::clone(&triangles));
        self.read.push(read);
        Ok(Some(triangles))
    }

    /// Lets go of meshes that nothing else holds.
    pub fn drop_unused(&mut self) {
        self.known.retain(|known| {
            let of_files = self.read.iter().map(|(_, _, read)| read);
            let here = 1 + of_files.filter(|read| Arc::ptr_eq(read, known)).count();
            Arc::strong_count(known) > here
        });
        let is_known = |read: &Arc<Triangles>| self.known.iter().any(|one| Arc::ptr_eq(one, read));
        self.read.retain(|(_, _, read)| is_known(read));
    }

    fn triangles(&mut self, mesh: &TriangleMesh) -> Arc<Triangles> {
        let known = self.known.iter().find(|known| known.mesh == *mesh);
        known.cloned().unwrap_or_else(|| {
            let new = Arc::new(Triangles::new(mesh));
            self.known.push(Arc::clone(&new));
            new
        })
    }
}

/// Triangles about the [middle](TriangleMesh::center) of their mesh, and a tree of boxes about them.
#[derive(Clone, Debug)]
pub(crate) struct Triangles {
    mesh: TriangleMesh,
    /// The same, as that of a shape.
    pub geometry: Geometry,
    all: Vec<Triangle>,
    pub space: Space<Bvh>,
    /// Whether the surface ends nowhere.
    pub closed: bool,
}

impl Triangles {
    fn new(mesh: &TriangleMesh) -> Self {
        let all = Triangle::all(mesh);
        let around = |t: &Triangle| {
            let [low, high] = t.bounds();
            Aabb::enclosing(low, high)
        };
        let boxes: Vec<_> = all.iter().map(around).collect();
        Self {
            mesh: mesh.clone(),
            geometry: Geometry::Mesh(mesh.clone()),
            closed: mesh.is_closed(),
            all,
            space: Space::new(&boxes).expect("the vertices of a mesh are finite"),
        }
    }

    /// The corners of one [m].
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        let center = self.mesh.center();
        self.mesh.corners(triangle as usize).map(|p| p - center)
    }

    /// The unit vector out of one, on its front.
    pub fn normal(&self, triangle: u32) -> DVec3 {
        self.mesh.normal(triangle as usize)
    }

    /// The numbers of those whose boxes meet a region, in the order of the mesh.
    pub fn near(&self, region: &Aabb, found: &mut Vec<u32>) {
        found.extend(self.space.overlap(region));
    }

    pub fn triangle(&self, number: u32) -> &Triangle {
        &self.all[number as usize]
    }

    /// Some, as kernels of pairs take them.
    pub fn some<'a>(&'a self, numbers: &'a [u32]) -> Near<'a> {
        Near {
            all: &self.all,
            numbers,
        }
    }
}
