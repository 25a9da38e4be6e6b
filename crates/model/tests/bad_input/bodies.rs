//! Masses, inertias and poses.

use crate::common::{refuses, sound};
use glam::{DMat3, DQuat, DVec3};
use kinetarium_model::{Model, Pose};

fn diagonal(x: f64, y: f64, z: f64) -> DMat3 {
    DMat3::from_diagonal(DVec3::new(x, y, z))
}

#[test]
fn masses() {
    refuses(&[
        (
            |p| p.bodies[1].mass = 0.0,
            "body \"upper\": mass [kg] is 0; it must be above zero",
        ),
        (
            |p| p.bodies[1].mass = -2.0,
            "body \"upper\": mass [kg] is -2; it must be above zero",
        ),
        (
            |p| p.bodies[1].mass = f64::NAN,
            "body \"upper\": mass [kg] is NaN; give a finite number",
        ),
        (
            |p| p.bodies[1].center.z = f64::INFINITY,
            "body \"upper\": centre of mass [m] is inf; give a finite number",
        ),
        (
            |p| p.bodies[1].inertia.x_axis.x = f64::NAN,
            "body \"upper\": inertia [kg·m²] is NaN; give a finite number",
        ),
        (
            |p| p.bodies[1].inertia.x_axis.y = 0.25,
            "body \"upper\": its inertia matrix is not symmetric (entries differ by 0.25); \
             write equal products of inertia on both sides",
        ),
        (
            |p| p.bodies[1].inertia = diagonal(1.0, -0.5, 1.0),
            "body \"upper\": its smallest principal moment of inertia is -0.5 kg·m², but all three \
             must be above zero; check the signs and units",
        ),
        (
            |p| p.bodies[1].inertia = DMat3::ZERO,
            "body \"upper\": its smallest principal moment of inertia is 0 kg·m², but all three \
             must be above zero; check the signs and units",
        ),
        (
            |p| p.bodies[1].inertia = diagonal(3.0, 1.0, 1.0),
            "body \"upper\": its principal moments of inertia [1.0, 1.0, 3.0] kg·m² belong to no \
             solid: the largest exceeds the sum of the others by more than 1e-6 of itself; correct \
             them (files written with few digits sometimes violate this slightly; setting all \
             three to their mean also helps)",
        ),
    ]);
}

#[test]
fn inertia_of_few_digits_passes() {
    let mut parts = sound();
    parts.bodies[1].inertia = diagonal(2.000001, 1.0, 1.0);
    Model::new(parts).unwrap();
}

#[test]
fn poses_and_worlds() {
    refuses(&[
        (
            |p| p.bodies[0].pose.position.x = f64::NAN,
            "body \"base\": pose is NaN; give a finite number",
        ),
        (
            |p| p.bodies[0].pose.orientation = DQuat::from_xyzw(0.0, 0.0, 0.0, 2.0),
            "body \"base\": quaternion of its pose has length 2; normalise it (1 within 1e-6)",
        ),
        (
            |p| p.bodies[0].pose.orientation = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0),
            "body \"base\": quaternion of its pose has length zero and so no direction; give one; no rotation is (0, 0, 0, 1)",
        ),
        (
            |p| p.bodies[1].world = -2,
            "body \"upper\": world is -2; it must lie from -1 to 2147483647",
        ),
        (
            |p| p.bodies[2].world = 1,
            "joint \"slider\": its parent stands in world 0, its child in world 1; put both in \
             one world, or the parent in world -1, which all share",
        ),
    ]);
}

#[test]
fn poses_with_nan_are_invalid() {
    assert!(Pose::IDENTITY.is_valid());
    assert!(!Pose::at(DVec3::new(0.0, f64::NAN, 0.0)).is_valid());
    assert!(!Pose::new(DVec3::ZERO, DQuat::from_xyzw(0.0, 0.0, 0.0, 1.1)).is_valid());
}
