//! `<geom>`: what a body looks and collides like, and often weighs (XML reference, "body/geom").

use super::Context;
use super::assets::{Mesh, color};
use super::fitted;
use super::height_field;
use super::mesh_mass;
use super::orientation::{least_rotation_from_z, pose};
use super::principal_frame;
use super::shell;
use super::surface::Surface;
use crate::error::FormatError;
use crate::meshes::UNSEEN;
use crate::report::Report;
use crate::xml::Element;
use glam::{DQuat, DVec3};
use model::{Geometry, MassProperties, Pose, Shape};
use std::f64::consts::FRAC_1_SQRT_2;

pub(super) const KNOWN: &[&str] = &[
    "name",
    "type",
    "contype",
    "conaffinity",
    "group",
    "size",
    "material",
    "friction",
    "mass",
    "density",
    "shellinertia",
    "fromto",
    "pos",
    "quat",
    "axisangle",
    "xyaxes",
    "zaxis",
    "euler",
    "hfield",
    "mesh",
    "fitscale",
    "rgba",
    "castshadow",
    "user",
    "condim",
    "priority",
    "solmix",
    "solref",
    "solimp",
    "margin",
    "gap",
    "surfacevel",
    "adhesion",
    "fluidshape",
    "fluidcoef",
];

const TYPES: &[&str] = &[
    "plane",
    "hfield",
    "sphere",
    "capsule",
    "ellipsoid",
    "cylinder",
    "box",
    "mesh",
    "sdf",
];

/// MuJoCo's solids and planes stand along z, the model's along y: a rotation about x from y to z.
const Y_TO_Z: DQuat = DQuat::from_xyzw(FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2);

/// MuJoCo's viewer shows groups 0 to 2 at first (modeling guide, "Visualization": `mjvOption.geomgroup`).
const LAST_SHOWN_GROUP: i64 = 2;

/// A geom of a body, in the body's frame.
pub(super) struct Geom {
    /// Its element, with inherited attributes.
    pub element: Element,
    pub shape: Shape,
    /// What it adds to the body's mass; `None` where it has none.
    pub solid: Option<MassProperties>,
    /// The axes of that in the body, as MuJoCo has them.
    pub axes: Option<DQuat>,
    pub surface: Surface,
}

/// What its body asks of a geom.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Weight {
    /// Nothing: the body has its mass from elsewhere.
    Unused,
    /// Mass, where that is easily had: the body never moves, and no total is set.
    Wanted,
    /// Mass.
    Needed,
}

/// Reads a geom with its inherited attributes; `None` where it was noted and left out. `frame` is
/// the frame that it stands in.
pub(super) fn read(
    element: Element,
    frame: Pose,
    weight: Weight,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<Option<Geom>, FormatError> {
    report.check_attributes(&element, KNOWN, &[])?;
    refuse_contact_physics(&element, report)?;
    let Some(placed) = placed_geometry(&element, context, report)? else {
        return Ok(None);
    };
    let (geometry, local) = placed;
    let (membership, collides_with) = (mask(&element, "contype")?, mask(&element, "conaffinity")?);
    let surface = Surface::of_geom(&element, &context.physics, report)?;
    let mut shape = Shape {
        name: element.get("name").unwrap_or_default().to_owned(),
        pose: frame * local,
        density: 0.0,
        color: own_color(&element, context)?,
        collides: (membership, collides_with) != (0, 0) && context.physics.on("contact"),
        membership,
        collides_with,
        ..Shape::new(geometry)
    };
    let group = element.integer("group")?.unwrap_or(0);
    let (first, last) = context.compiler.inertia_groups;
    let is_paired = context.physics.on("contact") && context.paired.contains(shape.name.as_str());
    let is_mesh = element.get("type") == Some("mesh");
    if is_mesh
        && (shape.collides || is_paired)
        && let Some(read) = context.meshes.of(&element, &shape.geometry)?
    {
        shape.geometry = read;
    }
    if !context.meshes.can_show(&element, &shape, report) {
        // It stays, since sensors, pairs and tendons may name it.
        shape.color = Some(UNSEEN);
    }
    let solid = match weight {
        Weight::Unused => None,
        _ if !(first..=last).contains(&group) => None,
        weight => solid(&element, &shape, weight, context, report)?,
    };
    let turn = frame.orientation * pose(&element, &context.compiler)?.orientation;
    let axes = solid.map(|solid| axes(&shape, &solid, turn));
    shape.density = density(&element, &shape, solid)?;
    lengthen_short_capsule(&element, &mut shape.geometry, report);
    Ok(Some(Geom {
        element,
        shape,
        solid,
        axes,
        surface,
    }))
}

/// A mask of 32 bits, 1 by default; negative numbers are the complements of positive ones.
fn mask(element: &Element, name: &str) -> Result<u32, FormatError> {
    let number = element.integer(name)?.unwrap_or(1);
    let bits = u32::try_from(number).ok();
    bits.or(i32::try_from(number).ok().map(i32::cast_unsigned))
        .ok_or_else(|| {
            let problem = format!("is {number}, which has more than 32 bits");
            let remedy = "write a number from -2147483648 to 4294967295";
            element.invalid_attribute(name, &problem, remedy)
        })
}

fn refuse_contact_physics(element: &Element, report: &mut Report) -> Result<(), FormatError> {
    let nonzero = |name| {
        Ok(element
            .list(name, 1, 6)?
            .is_some_and(|v| v.iter().any(|x| *x != 0.0)))
    };
    if nonzero("surfacevel")? {
        report.refuse(
            element,
            "a surface that moves (`surfacevel`)",
            "set it to 0",
        )?;
    }
    if nonzero("adhesion")? {
        report.refuse(element, "adhesion of contacts", "set it to 0")?;
    }
    Ok(())
}

/// A kind with its article.
fn one(kind: &str) -> String {
    let article = if kind == "ellipsoid" { "an" } else { "a" };
    format!("{article} {kind}")
}

/// The solid and its pose in the geom's frame of reference.
fn placed_geometry(
    element: &Element,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<Option<(Geometry, Pose)>, FormatError> {
    let kind = element.word("type", TYPES)?.unwrap_or("sphere");
    match kind {
        "mesh" => return mesh(element, context, report),
        "hfield" => return height_field(element, context, report).map(Some),
        "sdf" => {
            report.refuse(element, "a shape of type sdf", "use boxes or a mesh")?;
            return Ok(None);
        }
        _ => {}
    }
    let sized = match element.has("mesh") {
        true => fitted::to_mesh(element, kind, context, report)?,
        false => Some(sized(element, kind, context)?),
    };
    let Some((sizes, local)) = sized else {
        return Ok(None);
    };
    let geometry = geometry(element, kind, &sizes)?;
    let turned = match geometry {
        Geometry::Box { .. } | Geometry::Ellipsoid { .. } | Geometry::Sphere { .. } => local,
        _ => local * Pose::new(DVec3::ZERO, Y_TO_Z),
    };
    Ok(Some((geometry, turned)))
}

/// The sizes of a solid as MuJoCo has them, and its frame.
fn sized(
    element: &Element,
    kind: &str,
    context: &Context<'_>,
) -> Result<(Vec<f64>, Pose), FormatError> {
    let sizes = element.list("size", 1, 3)?.unwrap_or_default();
    let Some((local, half)) = between(element, kind)? else {
        return Ok((sizes, pose(element, &context.compiler)?));
    };
    let radius = sizes.first().copied().unwrap_or(0.0);
    let sizes = match kind {
        "box" | "ellipsoid" => vec![radius, radius, half],
        _ => vec![radius, half],
    };
    Ok((sizes, local))
}

/// The frame of a geom or site between the two points of `fromto`, and half their distance: its origin half way,
/// its z from the second to the first, as MuJoCo has it (its reference says otherwise; it matters for the edges of a
/// box).
pub(super) fn between(element: &Element, kind: &str) -> Result<Option<(Pose, f64)>, FormatError> {
    let Some([a, b, c, d, e, f]) = element.numbers::<6>("fromto")? else {
        return Ok(None);
    };
    if !["capsule", "cylinder", "box", "ellipsoid"].contains(&kind) {
        return Err(element.invalid_attribute(
            "fromto",
            &format!("is given for a {kind}"),
            "use it with capsule, cylinder, box or ellipsoid; otherwise give pos and size",
        ));
    }
    let (from, to) = (DVec3::new(a, b, c), DVec3::new(d, e, f));
    let way = from - to;
    if element.vector("pos")?.is_some_and(|pos| pos != DVec3::ZERO) {
        return Err(element.invalid_attribute("pos", "stands beside `fromto`", "keep one of them"));
    }
    if way.length() < 1e-14 {
        let remedy = "give two different points";
        return Err(element.invalid_attribute("fromto", "joins a point to itself", remedy));
    }
    let turn = least_rotation_from_z(way.normalize());
    Ok(Some((
        Pose::new((from + to) / 2.0, turn),
        way.length() / 2.0,
    )))
}

fn geometry(element: &Element, kind: &str, sizes: &[f64]) -> Result<Geometry, FormatError> {
    let (needed, meaning) = match kind {
        "plane" => (0, ""),
        "sphere" => (1, "radius"),
        "capsule" | "cylinder" => (2, "radius half-length"),
        _ => (3, "half-x half-y half-z"),
    };
    let wrong = |problem: &str| {
        let kind = one(kind);
        let remedy = format!("write size=\"{meaning}\" with positive numbers for {kind}");
        element.invalid_attribute("size", problem, &remedy)
    };
    if kind == "plane" {
        let size = |i: usize| sizes.get(i).copied().unwrap_or(0.0).max(0.0);
        return Ok(Geometry::Plane {
            half_x: size(0),
            half_z: size(1),
        });
    }
    if sizes.len() < needed {
        return Err(wrong(&format!("holds {} numbers", sizes.len())));
    }
    if let Some(size) = sizes[..needed].iter().find(|size| **size <= 0.0) {
        return Err(wrong(&format!("holds {size}")));
    }
    Ok(match kind {
        "sphere" => Geometry::Sphere { radius: sizes[0] },
        "capsule" => Geometry::Capsule {
            radius: sizes[0],
            half_height: sizes[0] + sizes[1],
        },
        "cylinder" => Geometry::Cylinder {
            radius: sizes[0],
            half_height: sizes[1],
        },
        "ellipsoid" => Geometry::Ellipsoid {
            half: DVec3::from_slice(sizes),
        },
        _ => Geometry::Box {
            half: DVec3::from_slice(sizes),
        },
    })
}

fn mesh(
    element: &Element,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<Option<(Geometry, Pose)>, FormatError> {
    let Some(mesh) = mesh_asset(element, context, report)? else {
        return Ok(None);
    };
    let local = pose(element, &context.compiler)?;
    Ok(Some((mesh.geometry.clone(), local * mesh.origin)))
}

/// The mesh that a geom names; `None` where it was left out.
pub(super) fn mesh_asset<'a>(
    element: &Element,
    context: &'a Context<'_>,
    report: &mut Report,
) -> Result<Option<&'a Mesh>, FormatError> {
    let name = element.require("mesh")?;
    match context.assets.meshes.get(name) {
        Some(Ok(mesh)) => Ok(Some(mesh)),
        Some(Err(feature)) => {
            report.refuse(element, feature, "store the mesh in a file of its own")?;
            Ok(None)
        }
        None => Err(element.invalid_attribute(
            "mesh",
            &format!("names `{name}`, which is no mesh asset"),
            "define it in <asset>, or correct the name",
        )),
    }
}

fn height_field(
    element: &Element,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<(Geometry, Pose), FormatError> {
    let name = element.require("hfield")?;
    let Some(asset) = context.assets.height_fields.get(name) else {
        return Err(element.invalid_attribute(
            "hfield",
            &format!("names `{name}`, which is no height field"),
            "define it in <asset>, or correct the name",
        ));
    };
    let mesh = height_field::read(asset, context)?;
    let meaning = "solid below in MuJoCo, a surface here: what is under it does not touch it";
    report.note(element, "height fields", meaning);
    let local = pose(element, &context.compiler)? * Pose::new(DVec3::ZERO, Y_TO_Z);
    Ok((Geometry::Mesh(mesh), local))
}

/// Its own colour, or its material's. What is in a group that MuJoCo's viewer does not show is not seen.
fn own_color(element: &Element, context: &Context<'_>) -> Result<Option<[f32; 4]>, FormatError> {
    if element.integer("group")?.unwrap_or(0) > LAST_SHOWN_GROUP {
        return Ok(Some(UNSEEN));
    }
    let of_material = element
        .get("material")
        .and_then(|name| context.assets.colors.get(name));
    Ok(color(element)?.or(of_material.copied()))
}

/// Mass properties in the body's frame; `mass` decides, or else `density`, per volume or per area.
fn solid(
    element: &Element,
    shape: &Shape,
    weight: Weight,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<Option<MassProperties>, FormatError> {
    let mass = element.non_negative("mass")?;
    let density = element.non_negative("density")?.unwrap_or(1000.0);
    if mass.unwrap_or(density) == 0.0 {
        return Ok(None);
    }
    let shell = element.truth("shellinertia")? == Some(true);
    let unit = match &shape.geometry {
        Geometry::MeshFile { .. } | Geometry::Mesh(_) | Geometry::Hull(_)
            if weight != Weight::Needed =>
        {
            return Ok(None);
        }
        Geometry::MeshFile { .. } | Geometry::Mesh(_) | Geometry::Hull(_) => {
            mesh_mass::of(element, context, report)?
        }
        solid if shell => shell::of(solid),
        solid => MassProperties::of(solid, 1.0),
    };
    let placed = unit.map(|unit| unit.placed(&shape.pose));
    Ok(placed.map(|unit| unit.with_mass(mass.unwrap_or(density * unit.mass))))
}

/// The axes that a solid stands along; of a mesh, which is turned like this, the principal ones.
fn axes(shape: &Shape, solid: &MassProperties, turn: DQuat) -> DQuat {
    match shape.geometry {
        Geometry::MeshFile { .. } | Geometry::Mesh(_) | Geometry::Hull(_) => {
            principal_frame::along(solid.inertia, turn)
        }
        Geometry::Capsule { .. } | Geometry::Cylinder { .. } => {
            shape.pose.orientation * Y_TO_Z.inverse()
        }
        _ => shape.pose.orientation,
    }
}

/// Density of the solid: the file's, or what its mass implies.
fn density(
    element: &Element,
    shape: &Shape,
    solid: Option<MassProperties>,
) -> Result<f64, FormatError> {
    let volume = MassProperties::of(&shape.geometry, 1.0).map(|unit| unit.mass);
    Ok(match (solid, volume) {
        (Some(solid), Some(volume)) if volume > 0.0 => solid.mass / volume,
        _ => element.non_negative("density")?.unwrap_or(1000.0),
    })
}

/// The model's capsules have a cylinder of at least 0.01 radii; the mass is already taken.
fn lengthen_short_capsule(element: &Element, geometry: &mut Geometry, report: &mut Report) {
    if let Geometry::Capsule {
        radius,
        half_height,
    } = geometry
    {
        let least = 1.01 * *radius;
        if *half_height < least {
            *half_height = least;
            report.note(
                element,
                "short capsule",
                "drawn and collided 1.01 radii long",
            );
        }
    }
}
