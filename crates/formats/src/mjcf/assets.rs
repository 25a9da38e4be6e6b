//! `<asset>`: meshes and colours that geoms refer to by name.

use super::compiler::Compiler;
use super::defaults::Defaults;
use super::mesh_mass::Inertia;
use super::orientation;
use super::sections::note_skin;
use super::tree::taken;
use super::written_mesh;
use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;
use glam::{DMat3, DQuat, DVec3};
use model::{Geometry, Pose};
use std::collections::HashMap;

pub(super) const MESH: &[&str] = &[
    "name",
    "content_type",
    "file",
    "vertex",
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

pub(super) const MESH_UNUSED: &[(&str, &str)] = &[
    ("normal", "only seen; not read"),
    ("texcoord", "only seen; not read"),
];

pub(super) const MATERIAL: &[&str] = &[
    "name",
    "class",
    "texture",
    "emission",
    "specular",
    "shininess",
    "reflectance",
    "metallic",
    "roughness",
    "rgba",
    "texrepeat",
    "texuniform",
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

/// A mesh, and where its origin lies in the geom that uses it.
pub(super) struct Mesh {
    /// The file's name, or what is written.
    pub geometry: Geometry,
    pub origin: Pose,
    pub inertia: Inertia,
}

#[derive(Default)]
pub(super) struct Assets {
    /// Meshes by name; of those that are not supported, what they are, for they are refused where they are used.
    pub meshes: HashMap<String, Result<Mesh, String>>,
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
                    report.check_attributes(&element, MESH, MESH_UNUSED)?;
                    let name = name_or_stem(&element)?;
                    let mesh = mesh(&element, compiler, report)?;
                    if assets.meshes.insert(name.clone(), mesh).is_some() {
                        return Err(repeated(&element, "mesh", &name));
                    }
                }
                "material" => {
                    let element = defaults.apply(asset, None, &["material"])?;
                    report.check_attributes(&element, MATERIAL, &[])?;
                    if let Some(color) = color(&element)? {
                        assets
                            .colors
                            .insert(element.require("name")?.to_owned(), color);
                    }
                    note_finish(&element, report);
                }
                "texture" => report.note(asset, "textures", "only seen; not read"),
                "skin" => note_skin(asset, report),
                "hfield" => {
                    report.check_attributes(asset, HEIGHT_FIELD, &[])?;
                    let name = name_or_stem(asset)?;
                    let fields = &mut assets.height_fields;
                    if fields.insert(name.clone(), asset.clone()).is_some() {
                        return Err(repeated(asset, "height field", &name));
                    }
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

fn mesh(
    element: &Element,
    compiler: &Compiler,
    report: &mut Report,
) -> Result<Result<Mesh, String>, FormatError> {
    let scale = element.vector("scale")?.unwrap_or(DVec3::ONE);
    let geometry = match source(element)? {
        "file" => Geometry::MeshFile {
            file: compiler.mesh_path(element.require("file")?),
            scale,
        },
        "vertex" => written_mesh::read(element, scale)?,
        "builtin" => {
            let kind = element.require("builtin")?;
            return Ok(Err(format!("the built-in mesh `{kind}`")));
        }
        _ => return Ok(Err("a mesh of a plugin".to_owned())),
    };
    Ok(Ok(Mesh {
        geometry,
        origin: reference(element, scale, report)?.inverse(),
        inertia: Inertia::read(element)?,
    }))
}

/// Where a mesh comes from: the one attribute of these that it has, or a plugin.
fn source(mesh: &Element) -> Result<&'static str, FormatError> {
    let given = ["file", "vertex", "builtin"]
        .into_iter()
        .filter(|name| mesh.has(name));
    match given.collect::<Vec<_>>()[..] {
        [one] => Ok(one),
        [] if mesh.child("plugin").is_some() => Ok("plugin"),
        [] => Err(mesh.invalid("it has no points", "write `file` or `vertex`")),
        [first, second, ..] => {
            let problem = format!("stands beside `{first}`");
            Err(mesh.invalid_attribute(second, &problem, "keep one of them"))
        }
    }
}

/// Its name, or that of its file without folder and ending.
fn name_or_stem(element: &Element) -> Result<String, FormatError> {
    let (Some(file), None) = (element.get("file"), own_name(element)) else {
        return Ok(element.require("name")?.to_owned());
    };
    let stem = file.rsplit(['/', '\\']).next().unwrap_or(file);
    Ok(stem
        .rsplit_once('.')
        .map_or(stem, |(stem, _)| stem)
        .to_owned())
}

/// The name that is written; an empty one is none.
fn own_name(element: &Element) -> Option<&str> {
    element.get("name").filter(|name| !name.is_empty())
}

fn repeated(element: &Element, kind: &str, name: &str) -> FormatError {
    if own_name(element).is_some() {
        return taken(element, kind, name);
    }
    let problem = format!("it is called `{name}` after its file, as another {kind} is");
    element.invalid(&problem, "give one of them a name")
}

/// The frame that a mesh is centred at, `refpos` and `refquat`, in the scaled mesh.
///
/// A vertex v of the file becomes S Rᵀ (v − p), with p, R the frame and S the scale; where these commute, as they
/// do if the scale is the same for all axes, that is Rᵀ (S v − S p).
fn reference(mesh: &Element, scale: DVec3, report: &mut Report) -> Result<Pose, FormatError> {
    let position = mesh.vector("refpos")?.unwrap_or(DVec3::ZERO);
    let quat = mesh
        .numbers::<4>("refquat")?
        .unwrap_or([1.0, 0.0, 0.0, 0.0]);
    let mut turn = orientation::from_quat(mesh, "refquat", quat)?;
    let (r, s) = (DMat3::from_quat(turn), DMat3::from_diagonal(scale));
    if !(r * s).abs_diff_eq(s * r, 1e-12 * scale.abs().max_element()) {
        let feature = "a scale that differs along the axes of `refquat`";
        let remedy = "write the same scale for all axes, or scale the mesh in its file";
        report.refuse(mesh, feature, remedy)?;
        turn = DQuat::IDENTITY;
    }
    Ok(Pose::new(scale * position, turn))
}

/// The attribute `rgba`.
pub(super) fn color(element: &Element) -> Result<Option<[f32; 4]>, FormatError> {
    let rgba = element.numbers::<4>("rgba")?;
    Ok(rgba.map(|rgba| rgba.map(|c| c.clamp(0.0, 1.0) as f32)))
}
