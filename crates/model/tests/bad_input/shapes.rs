//! Shapes, their materials, and which of them touch.

use crate::common::{refuses, sound};
use glam::DVec3;
use kinetarium_model::{BodyId, ContactPair, Geometry, Material, Model, Parts, ShapeId, Softness};

#[test]
fn shapes() {
    refuses(&[
        (
            |p| p.shapes[0].body = Some(BodyId(7)),
            "shape \"knob\": its body is number 7, but the model has 3, numbered from 0; \
             use a number below 3",
        ),
        (
            |p| p.shapes[0].geometry = Geometry::Sphere { radius: 0.0 },
            "shape \"knob\": radius [m] is 0; it must be above zero",
        ),
        (
            |p| {
                p.shapes[0].geometry = Geometry::Plane {
                    half_x: -1.0,
                    half_z: 1.0,
                }
            },
            "shape \"knob\": half size along x [m] is -1; it must not be negative",
        ),
        (
            |p| {
                p.shapes[0].geometry = Geometry::Cylinder {
                    radius: 1.0,
                    half_height: -1.0,
                }
            },
            "shape \"knob\": half height [m] is -1; it must be above zero",
        ),
        (
            |p| {
                p.shapes[0].geometry = Geometry::Cone {
                    radius: f64::NAN,
                    half_height: 1.0,
                }
            },
            "shape \"knob\": radius [m] is NaN; give a finite number",
        ),
        (
            |p| {
                p.shapes[0].geometry = Geometry::Capsule {
                    radius: 1.0,
                    half_height: 1.0,
                }
            },
            "shape \"knob\": the capsule's half height 1, caps included, must be at least 1.01 \
             times its radius 1; lengthen it or use a sphere",
        ),
        (
            |p| {
                p.shapes[0].geometry = Geometry::Box {
                    half: DVec3::new(1.0, 0.0, 1.0),
                }
            },
            "shape \"knob\": half extent [m] is 0; it must be above zero",
        ),
        (
            |p| {
                p.shapes[0].geometry = Geometry::Ellipsoid {
                    half: DVec3::new(1.0, 1.0, -1.0),
                }
            },
            "shape \"knob\": half axis [m] is -1; it must be above zero",
        ),
        (
            |p| {
                p.shapes[0].geometry = Geometry::MeshFile {
                    file: String::new(),
                    scale: DVec3::ONE,
                }
            },
            "shape \"knob\": the mesh names no file; give its path",
        ),
        (
            |p| {
                p.shapes[0].geometry = Geometry::MeshFile {
                    file: "a.stl".into(),
                    scale: DVec3::X,
                }
            },
            "shape \"knob\": scale without its sign is 0; it must be above zero",
        ),
        (
            |p| {
                p.shapes[0].name.clear();
                p.shapes[0].density = -1.0;
            },
            "shape: density [kg/m³] is -1; it must not be negative",
        ),
        (
            |p| p.shapes[0].material.friction = -0.1,
            "shape \"knob\": friction is -0.1; it must not be negative",
        ),
        (
            |p| p.shapes[0].material.static_friction = Some(f64::NAN),
            "shape \"knob\": static friction is NaN; give a finite number",
        ),
        (
            |p| p.shapes[0].material.static_friction = Some(-0.5),
            "shape \"knob\": static friction is -0.5; it must not be negative",
        ),
        (
            |p| p.shapes[0].material.static_friction = Some(0.4),
            "shape \"knob\": static friction is 0.4, less than the friction 0.5 of what slides; \
             give at least that, or none",
        ),
        (
            |p| p.shapes[0].material.restitution = 1.5,
            "shape \"knob\": restitution is 1.5; it must lie from 0 to 1",
        ),
        (
            |p| p.shapes[0].material.margin = f64::INFINITY,
            "shape \"knob\": margin [m] is inf; give a finite number",
        ),
        (
            |p| p.shapes[0].color = Some([0.5, 0.5, 0.5, 2.0]),
            "shape \"knob\": colour is 2; it must lie from 0 to 1",
        ),
        (
            |p| p.shapes[0].color = Some([f32::NAN, 0.5, 0.5, 1.0]),
            "shape \"knob\": colour is NaN; give a finite number",
        ),
    ]);
}

#[test]
fn softness_of_contacts() {
    refuses(&[
        (
            |p| p.shapes[0].material.softness = time(0.0, 1.0, 0.0),
            "shape \"knob\": time constant of contact [s] is 0; it must be above zero",
        ),
        (
            |p| p.shapes[0].material.softness = time(0.02, -1.0, 0.0),
            "shape \"knob\": damping ratio of contact is -1; it must be above zero",
        ),
        (
            |p| p.shapes[0].material.softness = time(f64::NAN, 1.0, 0.0),
            "shape \"knob\": time constant of contact [s] is NaN; give a finite number",
        ),
        (
            |p| p.shapes[0].material.softness = time(0.02, 1.0, 1.0),
            "shape \"knob\": impedance of contact is 1; it must lie from 0 to 0.9999",
        ),
        (
            |p| p.shapes[0].material.softness = time(0.02, 1.0, -0.1),
            "shape \"knob\": impedance of contact is -0.1; it must lie from 0 to 0.9999",
        ),
        (
            |p| p.shapes[0].material.softness = spring(0.0, 1.0),
            "shape \"knob\": stiffness of contact [N/m] is 0; it must be above zero",
        ),
        (
            |p| p.shapes[0].material.softness = spring(f64::INFINITY, 1.0),
            "shape \"knob\": stiffness of contact [N/m] is inf; give a finite number",
        ),
        (
            |p| p.shapes[0].material.softness = spring(1e4, -1.0),
            "shape \"knob\": damping of contact [N·s/m] is -1; it must not be negative",
        ),
        (
            |p| p.shapes[0].material.softness = weighing(0.0),
            "shape \"knob\": mass of contact [kg] is 0; it must be above zero",
        ),
    ]);
}

fn time(constant: f64, ratio: f64, impedance: f64) -> Softness {
    Softness::Time {
        constant,
        ratio,
        impedance,
        mass: None,
    }
}

fn weighing(mass: f64) -> Softness {
    Softness::Time {
        constant: 0.1,
        ratio: 1.0,
        impedance: 0.0,
        mass: Some(mass),
    }
}

fn spring(stiffness: f64, damping: f64) -> Softness {
    Softness::Spring { stiffness, damping }
}

#[test]
fn exclusions() {
    refuses(&[
        (
            |p| p.exclusions = vec![(Some(BodyId(0)), BodyId(2)), (None, BodyId(3))],
            "exclusion \"1\": its body is number 3, but the model has 3, numbered from 0; use a \
             number below 3",
        ),
        (
            |p| p.exclusions = vec![(Some(BodyId(9)), BodyId(1))],
            "exclusion \"0\": its body is number 9, but the model has 3, numbered from 0; use a \
             number below 3",
        ),
        (
            |p| p.exclusions = vec![(Some(BodyId(1)), BodyId(1))],
            "exclusion \"0\": both of its bodies are \"upper\"; name two different bodies",
        ),
    ]);
}

fn contact_pair(a: usize, b: usize) -> ContactPair {
    ContactPair::new((ShapeId(a), ShapeId(b)), Material::default())
}

fn pair_up(parts: &mut Parts, pairs: Vec<ContactPair>) {
    parts.shapes.push(parts.shapes[0].clone().named("other"));
    parts.contact_pairs = pairs;
}

#[test]
fn contact_pairs() {
    refuses(&[
        (
            |p| pair_up(p, vec![contact_pair(0, 2)]),
            "contact pair \"0\": its shape is number 2, but the model has 2, numbered from 0; use \
             a number below 2",
        ),
        (
            |p| pair_up(p, vec![contact_pair(1, 1)]),
            "contact pair \"0\": both of its shapes are number 1; name two different shapes",
        ),
        (
            |p| pair_up(p, vec![contact_pair(0, 1), contact_pair(1, 0)]),
            "contact pairs 0 and 1 are of the same two shapes; remove one",
        ),
        (
            |p| {
                let mut pair = contact_pair(0, 1);
                pair.material.friction = -0.1;
                pair_up(p, vec![pair]);
            },
            "contact pair \"0\": friction is -0.1; it must not be negative",
        ),
    ]);
}

#[test]
fn the_shortest_capsule_passes() {
    for radius in [0.1, 0.3, 1.0, 7.0] {
        let mut parts = sound();
        parts.shapes[0].geometry = Geometry::Capsule {
            radius,
            half_height: 1.01 * radius,
        };
        Model::new(parts).unwrap();
    }
}
