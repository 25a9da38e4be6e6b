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

/// A mesh file, and where its origin lies in the geom that uses it.
pub(super) struct Mesh {
    pub geometry: Geometry,
    pub origin: Pose,
}

#[derive(Default)]
pub(super) struct Assets {
    /// Meshes by name; `None`, one that is not read from a file.
    pub meshes: HashMap<String, Option<Mesh>>,
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
                "hfield" => report.note(asset, "height fields", "not read"),
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
    let Some(file) = element.get("file") else {
        return Ok((element.require("name")?.to_owned(), None));
    };
    let stem = file.rsplit(['/', '\\']).next().unwrap_or(file);
    let stem = stem.rsplit_once('.').map_or(stem, |(stem, _)| stem);
    let name = element.get("name").unwrap_or(stem).to_owned();
    let geometry = Geometry::Mesh {
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
