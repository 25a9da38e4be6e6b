//! Meshes as what the user asks for: themselves, their convex hulls, or convex pieces.

use crate::Meshes;
use crate::error::FormatError;
use crate::files::Files;
use crate::mesh_paths;
use crate::pieces::Pieces;
use crate::report::Report;
use crate::xml::Element;
use collide::mesh::{self, LoadError};
use glam::DVec3;
use model::{Geometry, Hull, Shape, TriangleMesh};
use std::cell::RefCell;
use std::collections::HashMap;

/// How far above its file a package is looked for.
const MOST_FOLDERS: usize = 8;
/// What is said of a file whose package is not found.
const NOWHERE: &str =
    "lies in no folder beside this file or above; write its path, relative to this file";
/// Of opacity zero.
pub(crate) const UNSEEN: [f32; 4] = [0.0; 4];

/// The formats that this build reads.
fn formats() -> &'static str {
    match mesh::is_known("a.glb") {
        true => ".obj, .stl or .glb",
        false => ".obj or .stl",
    }
}

/// Where a path in a package may be: the package beside the file, or above.
fn beside(inside: &str) -> impl Iterator<Item = String> + '_ {
    (0..=MOST_FOLDERS).map(|above| "../".repeat(above) + inside)
}

/// A mesh that was read.
#[derive(Clone)]
pub(crate) struct Read {
    /// What messages call it.
    name: String,
    /// Its triangles, as they are given.
    pub surface: TriangleMesh,
    /// What it becomes.
    pub geometry: Geometry,
}

/// What becomes of a file's meshes; each is read once.
pub(crate) struct MeshReader<'a> {
    files: &'a dyn Files,
    meshes: Meshes,
    /// By file and the bits of the scale.
    known: RefCell<HashMap<(String, [u64; 3]), Read>>,
    /// Of the meshes that are to come apart.
    pub pieces: Pieces,
}

impl<'a> MeshReader<'a> {
    pub fn new(files: &'a dyn Files, meshes: Meshes) -> Self {
        Self {
            files,
            meshes,
            known: RefCell::default(),
            pieces: Pieces::default(),
        }
    }

    /// What the mesh of an element that touches becomes; `None` for what is no mesh, and where meshes are to
    /// stay names of files. Pieces are found of these alone, as it may take minutes.
    pub fn of(&self, element: &Element, mesh: &Geometry) -> Result<Option<Geometry>, FormatError> {
        let Some(Read { name, geometry, .. }) = self.read(element, mesh)? else {
            return Ok(None);
        };
        if self.meshes == Meshes::Pieces
            && let Geometry::Mesh(surface) = &geometry
        {
            let found = self.pieces.find(&name, surface);
            found.map_err(|problem| broken(element, problem))?;
        }
        Ok(Some(geometry))
    }

    /// The mesh that an element uses, with what it becomes; `None` as for that.
    pub fn read(&self, element: &Element, mesh: &Geometry) -> Result<Option<Read>, FormatError> {
        match mesh {
            Geometry::MeshFile { .. } if self.meshes == Meshes::Named => Ok(None),
            _ => self.open(element, mesh),
        }
    }

    /// The mesh that an element uses, whatever meshes are to become; `None` for what is no mesh.
    pub fn open(&self, element: &Element, mesh: &Geometry) -> Result<Option<Read>, FormatError> {
        let read = match mesh {
            Geometry::MeshFile { file, scale } => self.file(file, *scale),
            Geometry::Mesh(surface) => self.turn(name(element), surface.clone()),
            Geometry::Hull(hull) => convex(name(element), hull),
            _ => return Ok(None),
        };
        read.map(Some).map_err(|problem| broken(element, problem))
    }

    fn file(&self, file: &str, scale: DVec3) -> Result<Read, String> {
        let key = (file.to_owned(), scale.to_array().map(f64::to_bits));
        if let Some(read) = self.known.borrow().get(&key) {
            return Ok(read.clone());
        }
        let (path, bytes) = self.contents("mesh", file)?;
        let surface = mesh::parse(&bytes, &path, scale).map_err(|error| match error {
            LoadError::Unknown { .. } => {
                let formats = formats();
                format!("the mesh {path} has no known ending; convert it to {formats}")
            }
            other => other.to_string(),
        })?;
        let read = self.turn(&path, surface)?;
        self.known.borrow_mut().insert(key, read.clone());
        Ok(read)
    }

    /// What a surface becomes, which is called `name`.
    fn turn(&self, name: &str, surface: TriangleMesh) -> Result<Read, String> {
        let geometry = match self.meshes {
            Meshes::ConvexHull => {
                let hull = surface.convex_hull();
                let hull = hull.map_err(|e| format!("the mesh {name} has no convex hull: {e}"))?;
                Geometry::Hull(hull)
            }
            _ => Geometry::Mesh(surface.clone()),
        };
        Ok(Read {
            name: name.to_owned(),
            surface,
            geometry,
        })
    }

    /// The path of the file of a `thing`, and what is in it. A ROS package is a folder of its name, beside the
    /// main file or above.
    pub fn contents(&self, thing: &str, name: &str) -> Result<(String, Vec<u8>), String> {
        let path = |file: &str| self.files.path(file);
        let Some((scheme, inside)) = name.split_once("://") else {
            let unread = |e| {
                format!(
                    "the {thing} {} cannot be read ({e}); check the path",
                    path(name)
                )
            };
            return Ok((path(name), self.files.bytes(name).map_err(unread)?));
        };
        let mut beside = beside(inside);
        let read = |file: String| Some((path(&file), self.files.bytes(&file).ok()?));
        let found = if scheme == "package" {
            beside.find_map(read)
        } else {
            None
        };
        found.ok_or_else(|| format!("the {thing} {name} {NOWHERE}"))
    }

    /// Gives a mesh that is named by its package the name that it has from here, if it is found.
    pub fn locate(&self, mesh: &mut Geometry) {
        let Geometry::MeshFile { file, .. } = mesh else {
            return;
        };
        let Some((scheme, inside)) = file.split_once("://") else {
            return;
        };
        let there = |file: &String| scheme == "package" && self.files.exists(file);
        let found = beside(inside).find(there);
        if let Some(found) = found {
            *file = found;
        }
    }

    /// Whether pictures can show a shape. A mesh that they would ask for in vain is listed; none is opened here.
    pub fn can_show(&self, element: &Element, shape: &Shape, report: &mut Report) -> bool {
        let Geometry::MeshFile { file, .. } = &shape.geometry else {
            return true;
        };
        let known = mesh::is_known(file);
        let transparent = shape.color.is_some_and(|color| color[3] == 0.0);
        if transparent || known && self.files.exists(file) {
            return true;
        }
        let (why, remedy) = match known {
            true => ("not there", self.files.remedy().to_owned()),
            false => (
                "in no format that is read here",
                format!("convert them to {}", formats()),
            ),
        };
        let what = format!("no picture shows meshes that are {why}; {remedy}");
        report.list(element, &what, &mesh_paths::resolved(file, self.files));
        false
    }
}

/// The name of the mesh that an element uses, where its points are written.
fn name(element: &Element) -> &str {
    element.get("mesh").unwrap_or_default()
}

/// What is convex stays so.
fn convex(name: &str, hull: &Hull) -> Result<Read, String> {
    let surface = TriangleMesh::new(hull.vertices(), hull.triangles());
    Ok(Read {
        name: name.to_owned(),
        surface: surface.map_err(|e| e.to_string())?,
        geometry: Geometry::Hull(hull.clone()),
    })
}

/// An element uses a mesh that is not what it should be.
pub(crate) fn broken(element: &Element, problem: String) -> FormatError {
    FormatError::Mesh {
        place: element.place.clone(),
        element: element.name.clone(),
        problem,
    }
}
