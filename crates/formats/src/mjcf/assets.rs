//! `<asset>`: meshes and colours that geoms refer to by name.

use super::compiler::Compiler;
use super::defaults::Defaults;
use super::orientation;
use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;
use glam::DVec3;
use model::{Geometry, Pose};
use std::collections::HashMap;

const MESH: &[&str] = &[
    "name",
    "content_type",
    "file",
    "vertex",
    "normal",
    "texcoord",
    "face",
    "refpos",
    "refquat",
    "scale",
    "smoothnormal",
    "maxhullvert",
    "inertia",
    "builtin",
    "params",
    "material",
];

const HEIGHT_FIELD: &[&str] = &[
    "name",
    "content_type",
    "file",
    "nrow",
    "ncol",
    "elevation",
    "size",
];

/// A mesh file, and where its origin lies in the geom that uses it.
pub(super) struct Mesh {
    pub geometry: Geometry,
    pub origin: Pose,
}

#[derive(Default)]
pub(super) struct Assets {
    /// Meshes by name; `None`, one that is not read from a file.
    pub meshes: HashMap<String, Option<Mesh>>,
    /// Height fields by name, not read yet.
    pub height_fields: HashMap<String, Element>,
    /// Colours of the materials that have one.
    pub colors: HashMap<String, [f32; 4]>,
}

impl Assets {
    pub fn read(
        root: &Element,
        compiler: &Compiler,
        defaults: &Defaults,
        report: &mut Report,
    ) -> Result<Self, FormatError> {
        let mut assets = Self::default();
        for asset in root
            .children_named("asset")
            .flat_map(|section| &section.children)
        {
            match asset.name.as_str() {
                "mesh" => {
                    let element = defaults.apply(asset, None, &["mesh"])?;
                    report.check_attributes(&element, MESH, &[])?;
                    let (name, mesh) = mesh(&element, compiler)?;
                    assets.meshes.insert(name, mesh);
                }
                "material" => {
                    let element = defaults.apply(asset, None, &["material"])?;
                    if let Some(color) = color(&element)? {
                        assets
                            .colors
                            .insert(element.require("name")?.to_owned(), color);
                    }
                    note_finish(&element, report);
                }
                "texture" => report.note(asset, "textures", "only seen; not read"),
                "skin" => report.note(asset, "skins", "only seen; not read"),
                "hfield" => {
                    report.check_attributes(asset, HEIGHT_FIELD, &[])?;
                    let name = name_or_stem(asset)?;
                    assets.height_fields.insert(name, asset.clone());
                }
                "model" => {
                    let remedy = "write the model's elements into this file, or include them";
                    report.refuse(asset, "attaching another model", remedy)?;
                }
                _ => return Err(asset.invalid("this is no asset", "correct its spelling")),
            }
        }
        Ok(assets)
    }
}

fn note_finish(material: &Element, report: &mut Report) {
    let finish = |name: &str| !["name", "rgba"].contains(&name);
    if material.attributes.iter().any(|a| finish(&a.name)) {
        report.note(
            material,
            "texture and finish",
            "only seen; the colour alone is read",
        );
    }
}

fn mesh(element: &Element, compiler: &Compiler) -> Result<(String, Option<Mesh>), FormatError> {
    let name = name_or_stem(element)?;
    let Some(file) = element.get("file") else {
        return Ok((name, None));
    };
    let geometry = Geometry::MeshFile {
        file: compiler.mesh_path(file),
        scale: element.vector("scale")?.unwrap_or(DVec3::ONE),
    };
    Ok((
        name,
        Some(Mesh {
            geometry,
            origin: reference(element)?.inverse(),
        }),
    ))
}

/// Its name, or that of its file without folder and ending.
fn name_or_stem(element: &Element) -> Result<String, FormatError> {
    let (Some(file), None) = (element.get("file"), element.get("name")) else {
        return Ok(element.require("name")?.to_owned());
    };
    let stem = file.rsplit(['/', '\\']).next().unwrap_or(file);
    Ok(stem
        .rsplit_once('.')
        .map_or(stem, |(stem, _)| stem)
        .to_owned())
}

/// The frame that a mesh is centred at, `refpos` and `refquat`.
fn reference(mesh: &Element) -> Result<Pose, FormatError> {
    let position = mesh.vector("refpos")?.unwrap_or(DVec3::ZERO);
    let quat = mesh
        .numbers::<4>("refquat")?
        .unwrap_or([1.0, 0.0, 0.0, 0.0]);
    Ok(Pose::new(
        position,
        orientation::from_quat(mesh, "refquat", quat)?,
    ))
}

/// The attribute `rgba`.
pub(super) fn color(element: &Element) -> Result<Option<[f32; 4]>, FormatError> {
    let rgba = element.numbers::<4>("rgba")?;
    Ok(rgba.map(|rgba| rgba.map(|c| c.clamp(0.0, 1.0) as f32)))
}
