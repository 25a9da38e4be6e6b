//! Mass properties of meshes (XML reference, "asset/mesh", attribute `inertia`).

use super::Context;
use super::shell;
use crate::error::FormatError;
use crate::meshes::{Read, broken};
use crate::report::Report;
use crate::xml::Element;
use glam::DVec3;
use model::{Geometry, MassProperties, TriangleMesh};

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

    /// Whose mass it is.
    fn whose(self) -> &'static str {
        match self {
            Self::Convex => "it is that of its convex hull",
            Self::Shell => "it is that of its surface",
            Self::Legacy | Self::Exact => "it is that of what its surface holds",
        }
    }
}

/// Of the mesh that a geom uses, of unit density per volume or per area, in the mesh's frame. What it becomes where it
/// collides does not matter, but that an open surface weighs what its hull does, if that is it.
pub(super) fn of(
    element: &Element,
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
    let name = element.require("mesh")?;
    let Some(Ok(asset)) = context.assets.meshes.get(name) else {
        return Ok(None);
    };
    let Some(read) = context.meshes.read(element, &asset.geometry)? else {
        let remedy = "take meshes as they are where their surfaces are closed (--meshes exact), or as their \
                      convex hulls (--meshes hull), give the body an <inertial> element, or this geom mass=\"0\"";
        report.refuse(element, "mass from the volume of a mesh", remedy)?;
        return Ok(None);
    };
    of_read(element, &read, asset.inertia, Purpose::Mass, report)
}

/// What a geom has of a mesh.
#[derive(Clone, Copy)]
pub(super) enum Purpose {
    Mass,
    Size,
}

impl Purpose {
    /// What that is, and how to give it otherwise.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Mass => ("mass", "give the body an <inertial> element"),
            Self::Size => ("size", "write the geom's `size`, and remove its `mesh`"),
        }
    }
}

/// Of a mesh that was read, in its frame.
pub(super) fn of_read(
    element: &Element,
    read: &Read,
    inertia: Inertia,
    purpose: Purpose,
    report: &mut Report,
) -> Result<Option<MassProperties>, FormatError> {
    let (thing, _) = purpose.words();
    let own = weighed(read, inertia).map_err(|problem| broken(element, problem))?;
    let (unit, what, whose) = match &read.geometry {
        hull @ Geometry::Hull(_) if own.is_none() => {
            let what = "a mesh that is open or inside out";
            (MassProperties::of(hull, 1.0), what, Inertia::Convex.whose())
        }
        _ => (own, "a mesh", inertia.whose()),
    };
    let Some(unit) = unit else {
        let (problem, remedy) = fault(element, &read.surface, purpose);
        if !report.is_lenient() {
            return Err(element.invalid(&problem, &remedy));
        }
        report.note(
            element,
            &problem,
            "left out although it changes the physics",
        );
        return Ok(None);
    };
    report.note(element, &format!("{thing} from {what}"), whose);
    if inertia == Inertia::Legacy && own.is_some() && is_hollow(&read.surface, unit) {
        let meaning =
            "MuJoCo counts some of the hollow, too, unless its <mesh> has inertia=\"exact\"";
        report.note(element, &format!("{thing} from a hollow mesh"), meaning);
    }
    Ok(Some(unit))
}

/// Why the mesh that a geom uses has no mass, and what to do.
fn fault(geom: &Element, mesh: &TriangleMesh, purpose: Purpose) -> (String, String) {
    let (open, volume) = (mesh.open_edges(), mesh.volume());
    let (what, cure) = match open.first() {
        Some([from, to]) => {
            let count = open.len();
            let edges = format!("along {count} edges, such as that from {from} to {to}");
            let what = format!("is open, or has faces wound against their neighbours, {edges}");
            let cure = "mend its file, write inertia=\"convex\" or inertia=\"shell\" at its <mesh>";
            (what, cure)
        }
        None if volume < 0.0 => {
            let what = format!("is inside out: its volume is {volume:.3e} m³");
            let cure = "turn its faces around in its file, write inertia=\"convex\" at its <mesh>";
            (what, cure)
        }
        None => {
            let what = "is flat: its volume is 0".to_owned();
            (what, "correct its file, or `scale` at its <mesh>")
        }
    };
    let name = geom.get("mesh").unwrap_or_default();
    let (thing, otherwise) = purpose.words();
    let problem = format!("its {thing} is that of the mesh `{name}`, which {what}");
    let remedy = format!("{cure}, or {otherwise}");
    (problem, remedy)
}

/// `None` for a surface that has to be closed, and is not, or holds nothing.
fn weighed(read: &Read, inertia: Inertia) -> Result<Option<MassProperties>, String> {
    let mesh = &read.surface;
    Ok(match (inertia, &read.geometry) {
        (Inertia::Legacy | Inertia::Exact, _) => {
            MassProperties::of(&Geometry::Mesh(mesh.clone()), 1.0)
        }
        (Inertia::Convex, hull @ Geometry::Hull(_)) => MassProperties::of(hull, 1.0),
        (Inertia::Convex, _) => {
            let hull = mesh.convex_hull();
            let hull = hull.map_err(|e| {
                format!(
                    "its convex hull, whose mass inertia=\"convex\" asks for, cannot be made: {e}"
                )
            })?;
            MassProperties::of(&Geometry::Hull(hull), 1.0)
        }
        (Inertia::Shell, _) => shell::of_faces(mesh.faces()),
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
