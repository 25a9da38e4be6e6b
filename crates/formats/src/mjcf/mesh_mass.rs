//! Mass properties of meshes (XML reference, "asset/mesh", attribute `inertia`).

use super::Context;
use super::shell;
use crate::error::FormatError;
use crate::meshes::broken;
use crate::report::Report;
use crate::xml::Element;
use glam::DVec3;
use model::{Geometry, MassProperties, Shape, TriangleMesh};

/// What of a mesh weighs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Inertia {
    /// What its surface holds; in MuJoCo more, where the surface is [hollow](is_hollow).
    #[default]
    Legacy,
    /// What its surface holds.
    Exact,
    /// Its convex hull.
    Convex,
    /// Its surface.
    Shell,
}

impl Inertia {
    /// Of a `<mesh>`.
    pub fn read(mesh: &Element) -> Result<Self, FormatError> {
        let words = ["legacy", "exact", "convex", "shell"];
        Ok(match mesh.word("inertia", &words)? {
            Some("exact") => Self::Exact,
            Some("convex") => Self::Convex,
            Some("shell") => Self::Shell,
            _ => Self::Legacy,
        })
    }

    /// Of the mesh that a geom uses.
    fn of_geom(geom: &Element, context: &Context<'_>) -> Self {
        let asset = geom
            .get("mesh")
            .and_then(|name| context.assets.meshes.get(name));
        asset
            .and_then(Option::as_ref)
            .map_or(Self::default(), |mesh| mesh.inertia)
    }
}

/// Of a mesh or its hull, of unit density per volume or per area, in the geom's frame.
pub(super) fn of(
    element: &Element,
    shape: &Shape,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<Option<MassProperties>, FormatError> {
    if element.truth("shellinertia")? == Some(true) {
        let remedy = "remove shellinertia from the geom, and write inertia=\"shell\" at its <mesh>";
        report.refuse(element, "mass from the surface of a mesh", remedy)?;
        return Ok(None);
    }
    if element.has("hfield") {
        let remedy = "give the body an <inertial> element, or this geom mass=\"0\"";
        report.refuse(element, "mass from a height field", remedy)?;
        return Ok(None);
    }
    let read = match &shape.geometry {
        file @ Geometry::MeshFile { .. } => context.meshes.of(element, file)?,
        read => Some(read.clone()),
    };
    let inertia = Inertia::of_geom(element, context);
    let unit = match &read {
        Some(Geometry::Mesh(mesh)) => of_mesh(mesh, inertia).map_err(|e| broken(element, e))?,
        Some(Geometry::Hull(hull)) if inertia == Inertia::Shell => shell::of_faces(hull.faces()),
        Some(hull) => MassProperties::of(hull, 1.0),
        None => None,
    };
    let (Some(unit), Some(read)) = (unit, read) else {
        let remedy = "take meshes as they are where their surfaces are closed (--meshes exact), or as their \
                      convex hulls (--meshes hull), give the body an <inertial> element, or this geom mass=\"0\"";
        report.refuse(element, "mass from the volume of a mesh", remedy)?;
        return Ok(None);
    };
    let whose = match (&read, inertia) {
        (Geometry::Hull(_), _) | (_, Inertia::Convex) => "it is that of its convex hull",
        (_, Inertia::Shell) => "it is that of its surface",
        _ => "it is that of what its surface holds",
    };
    report.note(element, "mass from a mesh", whose);
    if let Geometry::Mesh(mesh) = &read
        && inertia == Inertia::Legacy
        && is_hollow(mesh, unit)
    {
        let meaning =
            "MuJoCo counts some of the hollow, too, unless its <mesh> has inertia=\"exact\"";
        report.note(element, "mass from a hollow mesh", meaning);
    }
    Ok(Some(unit))
}

/// `None` for a surface that has to be closed, and is not.
fn of_mesh(mesh: &TriangleMesh, inertia: Inertia) -> Result<Option<MassProperties>, String> {
    Ok(match inertia {
        Inertia::Legacy | Inertia::Exact => MassProperties::of(&Geometry::Mesh(mesh.clone()), 1.0),
        Inertia::Convex => {
            let hull = mesh.convex_hull();
            let hull = hull.map_err(|e| {
                format!(
                    "its convex hull, whose mass inertia=\"convex\" asks for, cannot be made: {e}"
                )
            })?;
            MassProperties::of(&Geometry::Hull(hull), 1.0)
        }
        Inertia::Shell => shell::of_faces(mesh.faces()),
    })
}

/// Whether faces look at the middle of the surface, or at the centre of what it holds: MuJoCo's `legacy` adds the
/// pyramids from there to those faces, instead of taking them away.
fn is_hollow(mesh: &TriangleMesh, solid: MassProperties) -> bool {
    let middle = shell::of_faces(mesh.faces()).map(|shell| shell.center);
    let looks_at = |point: DVec3| {
        mesh.faces().any(|face| {
            let [a, b, c] = face.map(|corner| corner - point);
            a.dot(b.cross(c)) / 6.0 < -1e-9 * solid.mass
        })
    };
    looks_at(solid.center) || middle.is_some_and(looks_at)
}
