//! Solids that are fitted to a mesh (XML reference, "body/geom", attributes `mesh` and `fitscale`).
//!
//! They stand in the mesh's [principal frame](principal_frame), whose z is the axis of the least moment, at its centre of
//! mass, and have their sizes from the box of its volume (or surface) m and moments I, of half sizes
//! hᵢ² = 3/2 (Iⱼ + Iₖ − Iᵢ)/m; with the compiler's `fitaabb`, at the middle of the box about it in that frame, and from the
//! half sizes h of that:
//!
//! ```text
//!                    sphere             capsule                        cylinder           ellipsoid, box
//! box of inertia     (hx + hy + hz)/3   r = (hx + hy)/2,  hz − r/2     r, hz              h
//! box about it       max h              r = max(hx, hy),  hz − r       r, hz              h
//! ```

use super::Context;
use super::geom::mesh_asset;
use super::mesh_mass::{self, Purpose};
use super::orientation::pose;
use super::principal_frame;
use crate::error::FormatError;
use crate::meshes::Read;
use crate::report::Report;
use crate::xml::Element;
use glam::DVec3;
use model::{MassProperties, Pose};

/// The sizes of a solid as MuJoCo has them, and its frame; `None` where it was left out.
pub(super) fn to_mesh(
    element: &Element,
    kind: &str,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<Option<(Vec<f64>, Pose)>, FormatError> {
    if kind == "plane" {
        let remedy = "remove it, or write type=\"mesh\"";
        return Err(element.invalid_attribute("mesh", "is given for a plane", remedy));
    }
    if element.has("fromto") {
        return Err(element.invalid_attribute(
            "fromto",
            "stands beside `mesh`",
            "keep one of them",
        ));
    }
    let Some(mesh) = mesh_asset(element, context, report)? else {
        return Ok(None);
    };
    let Some(read) = context.meshes.open(element, &mesh.geometry)? else {
        return Ok(None);
    };
    let unit = mesh_mass::of_read(element, &read, mesh.inertia, Purpose::Size, report)?;
    let Some(unit) = unit.map(|unit| unit.placed(&mesh.origin)) else {
        return Ok(None);
    };
    let bounds = context.compiler.fit_to_bounds;
    let (frame, half) = match bounds {
        true => bounding_box(&read, mesh.origin, unit),
        false => inertia_box(unit),
    };
    let scale = element.number("fitscale")?.unwrap_or(1.0);
    let sizes = sizes(kind, scale * half, bounds);
    check(element, kind, &sizes)?;
    let local = pose(element, &context.compiler)?;
    Ok(Some((sizes, local * frame)))
}

fn inertia_box(unit: MassProperties) -> (Pose, DVec3) {
    let (moments, axes) = principal_frame::of(unit.inertia);
    let squares = 1.5 / unit.mass * (DVec3::splat(moments.element_sum()) - 2.0 * moments);
    let half = squares.max(DVec3::ZERO).map(f64::sqrt);
    (Pose::new(unit.center, axes), half)
}

fn bounding_box(read: &Read, origin: Pose, unit: MassProperties) -> (Pose, DVec3) {
    let (_, axes) = principal_frame::of(unit.inertia);
    let frame = Pose::new(unit.center, axes);
    let to_frame = frame.inverse() * origin;
    let vertices = read.surface.vertices().iter().map(|v| to_frame.point(*v));
    let bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let [low, high] = vertices.fold(bounds, |[low, high], v| [low.min(v), high.max(v)]);
    (frame * Pose::at(0.5 * (low + high)), 0.5 * (high - low))
}

fn sizes(kind: &str, half: DVec3, bounds: bool) -> Vec<f64> {
    let DVec3 { x, y, z } = half;
    let (ball, radius, cap) = match bounds {
        true => (half.max_element(), x.max(y), x.max(y)),
        false => ((x + y + z) / 3.0, (x + y) / 2.0, (x + y) / 4.0),
    };
    match kind {
        "sphere" => vec![ball],
        "capsule" => vec![radius, z - cap],
        "cylinder" => vec![radius, z],
        _ => vec![x, y, z],
    }
}

fn check(element: &Element, kind: &str, sizes: &[f64]) -> Result<(), FormatError> {
    match sizes.iter().find(|size| **size <= 0.0) {
        None => Ok(()),
        Some(size) => {
            let problem = format!("fits a {kind} of size {size}");
            let remedy = "write another type, or `size` instead of `mesh`";
            Err(element.invalid_attribute("mesh", &problem, remedy))
        }
    }
}
