//! Meshes from GLB files.

use super::load::Soup;
use glam::{DMat4, DVec3};

/// All triangles of a file's scene.
pub(super) fn read(bytes: &[u8]) -> Result<Soup, String> {
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
