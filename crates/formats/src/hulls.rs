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
        let (path, bytes) = self.contents(file)?;
        let mesh = TriangleMesh::parse(&bytes, &path, scale).map_err(|e| e.to_string())?;
        let hull = mesh.convex_hull();
        hull.map_err(|e| format!("the mesh {path} has no convex hull: {e}"))
    }

    /// The path of a mesh's file, and what is in it. A ROS package is a folder of its name, beside the
    /// main file or above.
    fn contents(&self, name: &str) -> Result<(String, Vec<u8>), String> {
        let path = |file: &str| self.files.path(file);
        let Some((scheme, inside)) = name.split_once("://") else {
            let unread = |e| {
                format!(
                    "the mesh {} cannot be read ({e}); check the path",
                    path(name)
                )
            };
            return Ok((path(name), self.files.bytes(name).map_err(unread)?));
        };
        let mut beside = (0..=MOST_FOLDERS).map(|above| "../".repeat(above) + inside);
        let read = |file: String| Some((path(&file), self.files.bytes(&file).ok()?));
        let found = if scheme == "package" {
            beside.find_map(read)
        } else {
            None
        };
        found.ok_or_else(|| {
            let remedy = "write its path, relative to this file";
            format!("the mesh {name} lies in no folder beside this file or above; {remedy}")
        })
    }
}
