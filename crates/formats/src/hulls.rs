//! Meshes as their convex hulls, where the user asks for them.

use crate::Meshes;
use crate::error::FormatError;
use crate::files::Files;
use crate::xml::Element;
use collide::mesh::TriangleMesh;
use glam::DVec3;
use model::{Geometry, Hull};
use std::cell::RefCell;
use std::collections::HashMap;

/// How far above its file a package is looked for.
const MOST_FOLDERS: usize = 8;

/// The hulls of a file's meshes; each mesh is read once.
pub(crate) struct Hulls<'a> {
    files: &'a dyn Files,
    meshes: Meshes,
    /// By file and the bits of the scale.
    known: RefCell<HashMap<(String, [u64; 3]), Hull>>,
}

impl<'a> Hulls<'a> {
    pub fn new(files: &'a dyn Files, meshes: Meshes) -> Self {
        Self {
            files,
            meshes,
            known: RefCell::default(),
        }
    }

    /// The hull of a mesh that an element uses; `None` for what is no mesh, and where meshes are to
    /// stay what they are.
    pub fn of(&self, element: &Element, mesh: &Geometry) -> Result<Option<Hull>, FormatError> {
        let (Geometry::Mesh { file, scale }, Meshes::ConvexHull) = (mesh, self.meshes) else {
            return Ok(None);
        };
        let key = (file.clone(), scale.to_array().map(f64::to_bits));
        if let Some(hull) = self.known.borrow().get(&key) {
            return Ok(Some(hull.clone()));
        }
        let hull = self
            .read(file, *scale)
            .map_err(|problem| FormatError::Mesh {
                place: element.place.clone(),
                element: element.name.clone(),
                problem,
            })?;
        self.known.borrow_mut().insert(key, hull.clone());
        Ok(Some(hull))
    }

    fn read(&self, file: &str, scale: DVec3) -> Result<Hull, String> {
        let file = &self.found(file)?;
        let path = self.files.path(file);
        let unread = |e| format!("the mesh {path} cannot be read ({e}); check the path");
        let bytes = self.files.bytes(file).map_err(unread)?;
        let mesh = TriangleMesh::parse(&bytes, &path, scale).map_err(|e| e.to_string())?;
        let hull = mesh.convex_hull();
        hull.map_err(|e| format!("the mesh {path} has no convex hull: {e}"))
    }

    /// The name of a mesh as a file. A ROS package is a folder of its name, beside the file or above.
    fn found(&self, name: &str) -> Result<String, String> {
        let Some((scheme, inside)) = name.split_once("://") else {
            return Ok(name.to_owned());
        };
        let mut beside = (0..=MOST_FOLDERS).map(|above| "../".repeat(above) + inside);
        let is_there = |file: &String| self.files.bytes(file).is_ok();
        let found = if scheme == "package" {
            beside.find(is_there)
        } else {
            None
        };
        found.ok_or_else(|| {
            let remedy = "write its path, relative to this file";
            format!("the mesh {name} lies in no folder beside this file or above; {remedy}")
        })
    }
}
