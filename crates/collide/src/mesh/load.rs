//! Meshes from files: Wavefront OBJ, STL (text and binary) and GLB.

use glam::DVec3;
use model::{MeshError, TriangleMesh};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Why a file is no mesh.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// The file cannot be read.
    #[error("cannot read the mesh {path}: {source}", path = path.display())]
    Read {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The name says nothing of the format.
    #[error("the mesh {path} has no known ending: convert it to .obj, .stl or .glb", path = path.display())]
    Unknown {
        /// Which file.
        path: PathBuf,
    },
    /// This build does not read GLB.
    #[cfg(not(feature = "gltf"))]
    #[error(
        "the mesh {path} is a GLB file, which this build does not read: use .obj or .stl, or build with \
         the feature `gltf`", path = path.display()
    )]
    NoGlb {
        /// Which file.
        path: PathBuf,
    },
    /// The file is not of its format.
    #[error("the mesh {path} is broken: {what}; export it again", path = path.display())]
    Broken {
        /// Which file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// The triangles are no surface.
    #[error("in {path}: {source}", path = path.display())]
    Mesh {
        /// Which file.
        path: PathBuf,
        /// What is wrong.
        source: MeshError,
    },
}

pub(super) type Soup = (Vec<DVec3>, Vec<[u32; 3]>);

/// Reads an `.obj`, `.stl` or `.glb` file, by its ending. All objects in it become one mesh, scaled
/// along each axis; a scale that mirrors keeps the outside out.
///
/// # Errors
/// A file that cannot be read or is broken, an unknown ending, or triangles that are no mesh.
pub fn load(path: impl AsRef<Path>, scale: DVec3) -> Result<TriangleMesh, LoadError> {
    let path = path.as_ref();
    let read = reader(path)?;
    let bytes = std::fs::read(path).map_err(|source| LoadError::Read {
        path: path.to_owned(),
        source,
    })?;
    from_soup(read(&bytes), path, scale)
}

/// Whether [`load`] reads files of a path's ending.
pub fn is_known(path: impl AsRef<Path>) -> bool {
    reader(path.as_ref()).is_ok()
}

/// As [`load`], of the contents of a file; `path` names it, and its format.
///
/// # Errors
/// As [`load`].
pub fn parse(
    bytes: &[u8],
    path: impl AsRef<Path>,
    scale: DVec3,
) -> Result<TriangleMesh, LoadError> {
    let path = path.as_ref();
    from_soup(reader(path)?(bytes), path, scale)
}

fn from_soup(
    soup: Result<Soup, String>,
    path: &Path,
    scale: DVec3,
) -> Result<TriangleMesh, LoadError> {
    let (vertices, triangles) = soup.map_err(|what| LoadError::Broken {
        path: path.to_owned(),
        what,
    })?;
    scaled(&vertices, &triangles, scale).map_err(|source| LoadError::Mesh {
        path: path.to_owned(),
        source,
    })
}

/// Triangles over vertices, scaled along each axis; a scale that mirrors keeps the outside out.
///
/// # Errors
/// Triangles that are no mesh.
pub fn scaled(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    scale: DVec3,
) -> Result<TriangleMesh, MeshError> {
    let vertices: Vec<_> = vertices.iter().map(|v| *v * scale).collect();
    let mirrored = scale.element_product() < 0.0;
    let facing_out = |&[a, b, c]: &[u32; 3]| if mirrored { [a, c, b] } else { [a, b, c] };
    let triangles: Vec<_> = triangles.iter().map(facing_out).collect();
    TriangleMesh::new(&vertices, &triangles)
}

type Reader = fn(&[u8]) -> Result<Soup, String>;

/// What reads files of an ending.
fn reader(path: &Path) -> Result<Reader, LoadError> {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let path = || path.to_owned();
    match ending.as_deref() {
        Some("obj") => Ok(obj),
        Some("stl") => Ok(stl),
        #[cfg(feature = "gltf")]
        Some("glb") => Ok(super::glb::read),
        #[cfg(not(feature = "gltf"))]
        Some("glb") => Err(LoadError::NoGlb { path: path() }),
        _ => Err(LoadError::Unknown { path: path() }),
    }
}

fn obj(bytes: &[u8]) -> Result<Soup, String> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..Default::default()
    };
    let no_materials = |_: &Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(bytes), &options, no_materials)
        .map_err(|e| e.to_string())?;
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for model in models {
        let first = vertices.len() as u32;
        let (positions, rest) = model.mesh.positions.as_chunks::<3>();
        let (faces, odd) = model.mesh.indices.as_chunks::<3>();
        if !rest.is_empty() || !odd.is_empty() {
            return Err(format!("object `{}` is cut short", model.name));
        }
        vertices.extend(positions.iter().map(|p| DVec3::from(*p)));
        triangles.extend(faces.iter().map(|f| f.map(|v| first.saturating_add(v))));
    }
    Ok((vertices, triangles))
}

/// Bytes before the triangles of a binary STL, and of each triangle.
const STL: (usize, usize) = (84, 50);

fn stl(bytes: &[u8]) -> Result<Soup, String> {
    // A text file begins with `solid`; so do some binary ones.
    if !bytes.starts_with(b"solid") || stl_length(bytes) == Some(bytes.len()) {
        match stl_length(bytes) {
            Some(length) if length <= bytes.len() => {}
            _ => return Err(format!("it ends after {} bytes", bytes.len())),
        }
    }
    let mesh = stl_io::read_stl(&mut Cursor::new(bytes)).map_err(|e| e.to_string())?;
    let vertex = |v: &stl_io::Vertex| DVec3::new(v[0].into(), v[1].into(), v[2].into());
    let triangle = |t: &stl_io::IndexedTriangle| t.vertices.map(|v| v as u32);
    Ok((
        mesh.vertices.iter().map(vertex).collect(),
        mesh.faces.iter().map(triangle).collect(),
    ))
}

/// How long a binary STL says that it is.
fn stl_length(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..STL.0)?.try_into().ok()?;
    (u32::from_le_bytes(count) as usize)
        .checked_mul(STL.1)?
        .checked_add(STL.0)
}
