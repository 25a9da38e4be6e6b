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

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use std::fs;

    fn hill(height: f64) -> Shape {
        let heights = [vec![0.0, 0.0], vec![0.0, height]];
        let mesh = TriangleMesh::height_field(&heights, DVec2::ONE).unwrap();
        Shape::new(Geometry::Mesh(mesh))
    }

    #[test]
    fn meshes_that_nothing_holds_any_more_are_let_go() {
        let mut meshes = Meshes::default();
        let held = meshes.of(&hill(1.0)).unwrap();
        let other = Arc::downgrade(&meshes.of(&hill(2.0)).unwrap());
        assert!(other.upgrade().is_some());
        meshes.drop_unused();
        assert!(other.upgrade().is_none());
        assert!(Arc::ptr_eq(&held, &meshes.of(&hill(1.0)).unwrap()));
    }

    #[test]
    fn files_are_kept_while_their_mesh_is_held() {
        let file = std::env::temp_dir().join(format!("kinetarium-{}.obj", std::process::id()));
        fs::write(&file, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        let named = Shape::new(Geometry::MeshFile {
            file: file.to_str().unwrap().into(),
            scale: DVec3::ONE,
        });
        let mut meshes = Meshes::default();
        let held = meshes.read(&named).unwrap().unwrap();
        fs::remove_file(&file).unwrap();
        meshes.drop_unused();
        assert!(Arc::ptr_eq(&held, &meshes.read(&named).unwrap().unwrap()));
        drop(held);
        meshes.drop_unused();
        assert!(meshes.read(&named).is_err(), "it is looked for once more");
    }
}
