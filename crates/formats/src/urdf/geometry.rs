//! Frames, solids and colours (urdf/XML/link, "visual" and "collision").

use crate::error::FormatError;
use crate::meshes::MeshReader;
use crate::report::Report;
use crate::xml::Element;
use glam::{DQuat, DVec3};
use model::{Geometry, Pose, Shape};
use std::collections::HashMap;
use std::f64::consts::FRAC_1_SQRT_2;

/// URDF's cylinders stand along z, the model's along y: a rotation about x from y to z.
const Y_TO_Z: DQuat = DQuat::from_xyzw(FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2);

/// What the shapes of all links have in common.
pub(super) struct Looks<'a> {
    pub colors: Colors,
    pub meshes: MeshReader<'a>,
}

/// Colours of the materials that the robot defines for all its links.
pub(super) struct Colors(HashMap<String, [f32; 4]>);

impl Colors {
    pub fn read(root: &Element) -> Result<Self, FormatError> {
        let mut colors = HashMap::new();
        // A material that a link defines may be named by later ones too.
        let visuals = root
            .children_named("link")
            .flat_map(|link| link.children_named("visual"));
        let inner = visuals.filter_map(|visual| visual.child("material"));
        for material in inner.chain(root.children_named("material")) {
            if let Some(color) = color(material)? {
                colors.insert(material.require("name")?.to_owned(), color);
            }
        }
        Ok(Self(colors))
    }

    fn of(&self, visual: &Element) -> Result<Option<[f32; 4]>, FormatError> {
        let Some(material) = visual.child("material") else {
            return Ok(None);
        };
        let own = color(material)?;
        let named = || {
            material
                .get("name")
                .and_then(|name| self.0.get(name))
                .copied()
        };
        Ok(own.or_else(named))
    }
}

fn color(material: &Element) -> Result<Option<[f32; 4]>, FormatError> {
    let Some(color) = material.child("color") else {
        return Ok(None);
    };
    let rgba = color.numbers::<4>("rgba")?;
    Ok(rgba.map(|rgba| rgba.map(|c| c.clamp(0.0, 1.0) as f32)))
}

/// The `<origin>` of an element: position, and fixed-axis rotations roll about x, pitch about y, yaw
/// about z, in this order. None is the identity.
pub(super) fn origin(element: &Element, report: &mut Report) -> Result<Pose, FormatError> {
    let Some(origin) = element.child("origin") else {
        return Ok(Pose::IDENTITY);
    };
    report.check_attributes(origin, &["xyz", "rpy"], &[])?;
    let position = origin.vector("xyz")?.unwrap_or(DVec3::ZERO);
    let [roll, pitch, yaw] = origin.numbers("rpy")?.unwrap_or([0.0; 3]);
    let turn =
        DQuat::from_rotation_z(yaw) * DQuat::from_rotation_y(pitch) * DQuat::from_rotation_x(roll);
    Ok(Pose::new(position, turn))
}

/// A `<visual>` or `<collision>` as a shape; `None` where it was noted and left out, as a visual is that no picture can
/// show.
pub(super) fn shape(
    element: &Element,
    looks: &Looks<'_>,
    report: &mut Report,
) -> Result<Option<Shape>, FormatError> {
    let frame = origin(element, report)?;
    let Some(outer) = element.child("geometry") else {
        let remedy = "add <geometry> with box, cylinder, sphere or mesh";
        return Err(element.invalid("it has no geometry", remedy));
    };
    let Some(inner) = outer.children.first() else {
        let remedy = "add box, cylinder, sphere or mesh";
        return Err(outer.invalid("it is empty", remedy));
    };
    let Some(mut geometry) = geometry(inner, report)? else {
        return Ok(None);
    };
    let collides = element.name == "collision";
    if collides && let Some(read) = looks.meshes.of(inner, &geometry)? {
        geometry = read;
    }
    looks.meshes.locate(&mut geometry);
    let pose = match geometry {
        Geometry::Cylinder { .. } | Geometry::Capsule { .. } => {
            frame * Pose::new(DVec3::ZERO, Y_TO_Z)
        }
        _ => frame,
    };
    let shape = Shape {
        name: element.get("name").unwrap_or_default().to_owned(),
        pose,
        density: 0.0,
        color: looks.colors.of(element)?,
        collides,
        ..Shape::new(geometry)
    };
    let stays = collides || looks.meshes.can_show(inner, &shape, report);
    Ok(stays.then_some(shape))
}

fn geometry(element: &Element, report: &mut Report) -> Result<Option<Geometry>, FormatError> {
    let positive = |name: &str| -> Result<f64, FormatError> {
        element.require(name)?;
        match element.number(name)? {
            Some(size) if size > 0.0 => Ok(size),
            size => Err(element.invalid_attribute(
                name,
                &format!("is {}", size.unwrap_or(0.0)),
                "write a positive number of metres",
            )),
        }
    };
    Ok(Some(match element.name.as_str() {
        "sphere" => Geometry::Sphere {
            radius: positive("radius")?,
        },
        "cylinder" => {
            let (radius, length) = (positive("radius")?, positive("length")?);
            Geometry::Cylinder {
                radius,
                half_height: length / 2.0,
            }
        }
        "capsule" => {
            let (radius, length) = (positive("radius")?, positive("length")?);
            Geometry::Capsule {
                radius,
                half_height: (length / 2.0 + radius).max(1.01 * radius),
            }
        }
        "box" => {
            element.require("size")?;
            let size = element.vector("size")?.unwrap_or(DVec3::ZERO);
            if size.min_element() <= 0.0 {
                let remedy = "write three positive numbers of metres";
                return Err(element.invalid_attribute("size", "is not positive", remedy));
            }
            Geometry::Box { half: size / 2.0 }
        }
        "mesh" => {
            let file = element.require("filename")?;
            let file = file.strip_prefix("file://").unwrap_or(file).to_owned();
            let scale = element.vector("scale")?.unwrap_or(DVec3::ONE);
            Geometry::MeshFile { file, scale }
        }
        other => {
            let feature = format!("geometry of kind `{other}`");
            report.refuse(
                element,
                &feature,
                "use box, cylinder, sphere, capsule or mesh",
            )?;
            return Ok(None);
        }
    }))
}
