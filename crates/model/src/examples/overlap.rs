//! Whether anything overlaps at the start, by boxes about the shapes.

use crate::{Geometry, Model, Pose, Shape};
use glam::{DMat3, DVec3};

/// Asserts that the boxes about the moving bodies' shapes meet neither each other's nor the scenery's.
pub(super) fn nothing_overlaps(model: &Model) {
    let boxes: Vec<_> = model.shapes.iter().map(|s| bounds(model, s)).collect();
    for (i, moving) in model.shapes.iter().enumerate() {
        if moving.body.is_none() {
            continue;
        }
        let (low, high) = boxes[i];
        for (j, (other_low, other_high)) in boxes.iter().enumerate() {
            let apart = low.cmpgt(*other_high) | high.cmplt(*other_low);
            assert!(
                i == j || apart.any(),
                "shapes {i} and {j} of {}",
                model.name
            );
        }
    }
}

/// The lowest and the highest corner of the box about a shape, along the world's axes.
fn bounds(model: &Model, shape: &Shape) -> (DVec3, DVec3) {
    let body = shape
        .body
        .map_or(Pose::IDENTITY, |b| model.bodies[b.0].pose);
    let pose = body * shape.pose;
    let half = match shape.geometry {
        Geometry::Sphere { radius } => return around(pose.position, DVec3::splat(radius)),
        Geometry::Plane { .. } => {
            return (
                DVec3::NEG_INFINITY,
                DVec3::new(f64::INFINITY, 0.0, f64::INFINITY),
            );
        }
        ref solid => solid
            .half_extents()
            .unwrap_or_else(|| unreachable!("no scene that is measured has {solid:?}")),
    };
    let turn = DMat3::from_quat(pose.orientation);
    let reach =
        turn.x_axis.abs() * half.x + turn.y_axis.abs() * half.y + turn.z_axis.abs() * half.z;
    around(pose.point(shape.geometry.center()), reach)
}

fn around(middle: DVec3, half: DVec3) -> (DVec3, DVec3) {
    (middle - half, middle + half)
}
