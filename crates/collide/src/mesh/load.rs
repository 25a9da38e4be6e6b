//! Meshes from files: Wavefront OBJ, STL (text and binary) and GLB.

use super::{MeshError, TriangleMesh};
use glam::{DMat4, DVec3};
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
    #[error("the mesh {path} has no known ending: use .obj, .stl or .glb", path = path.display())]
    Unknown {
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

type Soup = (Vec<DVec3>, Vec<[u32; 3]>);

impl TriangleMesh {
    /// Reads an `.obj`, `.stl` or `.glb` file, by its ending. All objects in it become one mesh,
    /// scaled along each axis; a scale that mirrors keeps the outside out.
    ///
    /// # Errors
    /// A file that cannot be read or is broken, an unknown ending, or triangles that are no mesh.
    pub fn load(path: impl AsRef<Path>, scale: DVec3) -> Result<Self, LoadError> {
        let path = path.as_ref();
        let read = |source| LoadError::Read {
            path: path.to_owned(),
            source,
        };
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let parse = match ending.as_deref() {
            Some("obj") => obj,
            Some("stl") => stl,
            Some("glb") => glb,
            _ => {
                let path = path.to_owned();
                return Err(LoadError::Unknown { path });
            }
        };
        let bytes = std::fs::read(path).map_err(read)?;
        let (vertices, triangles) = parse(&bytes).map_err(|what| LoadError::Broken {
            path: path.to_owned(),
            what,
        })?;
        let vertices: Vec<_> = vertices.into_iter().map(|v| v * scale).collect();
        let mirrored = scale.element_product() < 0.0;
        let facing_out = |[a, b, c]: [u32; 3]| if mirrored { [a, c, b] } else { [a, b, c] };
        let triangles: Vec<_> = triangles.into_iter().map(facing_out).collect();
        Self::new(&vertices, &triangles).map_err(|source| LoadError::Mesh {
            path: path.to_owned(),
            source,
        })
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

fn glb(bytes: &[u8]) -> Result<Soup, String> {
    check_positions(bytes)?;
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(bytes).map_err(|e| e.to_string())?;
    let scene = document
        .default_scene()
        .or_else(|| document.scenes().next());
    let scene = scene.ok_or("it has no scene")?;
    let mut reading = Reading {
        blob: blob.as_deref(),
        nodes_left: document.nodes().len(),
        soup: Soup::default(),
    };
    for node in scene.nodes() {
        reading.add_node(&node, DMat4::IDENTITY)?;
    }
    Ok(reading.soup)
}

/// That positions are where the file says they are, which `gltf` takes for granted.
fn check_positions(bytes: &[u8]) -> Result<(), String> {
    let unchecked = gltf::Gltf::from_slice_without_validation(bytes).map_err(|e| e.to_string())?;
    let root = unchecked.document.into_json();
    let primitives = root.meshes.iter().flat_map(|m| &m.primitives);
    for accessor in primitives.flat_map(|p| p.attributes.values()) {
        if accessor.value() >= root.accessors.len() {
            return Err(format!("there is no accessor {}", accessor.value()));
        }
    }
    Ok(())
}

/// That accessors hold what they are used for, which `gltf` takes for granted.
fn check_kinds(primitive: &gltf::Primitive<'_>) -> Result<(), String> {
    use gltf::Semantic::Positions;
    use gltf::accessor::{DataType, Dimensions};
    let positions = primitive.get(&Positions);
    let positions = positions.map(|a| (a.data_type(), a.dimensions()));
    if positions.is_some_and(|kind| kind != (DataType::F32, Dimensions::Vec3)) {
        return Err("its positions are not three floating-point numbers each".to_owned());
    }
    let whole = [DataType::U8, DataType::U16, DataType::U32];
    let indices = primitive.indices();
    let indices =
        indices.map(|a| whole.contains(&a.data_type()) && a.dimensions() == Dimensions::Scalar);
    match indices {
        Some(false) => Err("its indices are not whole numbers".to_owned()),
        _ => Ok(()),
    }
}

/// A scene being read.
struct Reading<'a> {
    blob: Option<&'a [u8]>,
    /// How many nodes may still come: in a tree, none comes twice.
    nodes_left: usize,
    soup: Soup,
}

impl Reading<'_> {
    /// Adds what hangs on a node, placed by `parent` and by all nodes in between.
    fn add_node(&mut self, node: &gltf::Node<'_>, parent: DMat4) -> Result<(), String> {
        let left = self.nodes_left.checked_sub(1);
        self.nodes_left = left.ok_or("its nodes are no tree")?;
        let own = node.transform().matrix();
        let place = parent * DMat4::from_cols_array_2d(&own.map(|column| column.map(f64::from)));
        for primitive in node.mesh().iter().flat_map(gltf::Mesh::primitives) {
            self.add_primitive(&primitive, place)?;
        }
        node.children()
            .try_for_each(|child| self.add_node(&child, place))
    }

    fn add_primitive(
        &mut self,
        primitive: &gltf::Primitive<'_>,
        place: DMat4,
    ) -> Result<(), String> {
        if primitive.mode() != gltf::mesh::Mode::Triangles {
            return Err(format!("{:?} where triangles are needed", primitive.mode()));
        }
        check_kinds(primitive)?;
        let reader = primitive.reader(|buffer| match buffer.source() {
            gltf::buffer::Source::Bin => self.blob,
            gltf::buffer::Source::Uri(_) => None,
        });
        let positions = reader.read_positions();
        let positions = positions.ok_or("it has no positions of its own, or they are cut short")?;
        let (vertices, triangles) = &mut self.soup;
        let first = vertices.len() as u32;
        vertices.extend(positions.map(|p| place.transform_point3(DVec3::from(p.map(f64::from)))));
        let indices: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices
                .into_u32()
                .map(|v| first.saturating_add(v))
                .collect(),
            None => (first..vertices.len() as u32).collect(),
        };
        let (corners, rest) = indices.as_chunks::<3>();
        if !rest.is_empty() {
            return Err("its last triangle is cut short".to_owned());
        }
        let mirrored = place.determinant() < 0.0;
        let facing_out = |&[a, b, c]: &[u32; 3]| if mirrored { [a, c, b] } else { [a, b, c] };
        triangles.extend(corners.iter().map(facing_out));
        Ok(())
    }
}
