//! What a page is told of a model.

use crate::protocol::{Actuator, Beam, Body, Camera, Dof, Geometry, Joint, Lamp, Placement, Shape};
use crate::sliders;
use glam::DVec3;
use model::{
    BodyId, BodyKind, JointId, JointKind, LampKind, MassProperties, Model, Pose, default_color,
};

impl From<Pose> for Placement {
    fn from(pose: Pose) -> Self {
        Self {
            position: pose.position.to_array(),
            orientation: pose.orientation.to_array(),
        }
    }
}

/// Row of a body; −1 for the world.
fn row_of(body: Option<BodyId>) -> i32 {
    body.map_or(-1, |body| body.0 as i32)
}

/// Bodies, in the model's order.
pub(crate) fn bodies(model: &Model) -> Vec<Body> {
    let body = |(i, body): (usize, &model::Body)| {
        let carrier = model.carrier(BodyId(i));
        let mass = MassProperties {
            mass: body.mass,
            center: body.center,
            inertia: body.inertia,
        };
        let (moments, axes) = mass.principal();
        Body {
            name: body.name.clone(),
            dynamic: body.kind == BodyKind::Dynamic,
            mass: body.mass,
            inertial: Pose::new(body.center, axes).into(),
            inertia: moments.to_array(),
            joint: carrier.map_or(-1, |joint| joint.0 as i32),
            color: default_color(Some(BodyId(i))),
        }
    };
    model.bodies.iter().enumerate().map(body).collect()
}

/// Shapes, in the model's order. `opens` says whether files of meshes that are only seen are opened.
pub(crate) fn shapes(model: &Model, opens: bool) -> Vec<Shape> {
    let shape = |shape: &model::Shape| Shape {
        name: shape.name.clone(),
        body: row_of(shape.body),
        placement: shape.pose.into(),
        geometry: geometry(&shape.geometry, opens),
        collides: shape.collides,
        sensor: shape.sensor,
        color: shape.color,
    };
    model.shapes.iter().map(shape).collect()
}

fn geometry(geometry: &model::Geometry, opens: bool) -> Geometry {
    use model::Geometry as Is;
    match *geometry {
        Is::Plane { half_x, half_z } => Geometry::Plane {
            half: (half_x > 0.0 || half_z > 0.0).then_some([half_x, half_z].map(to_horizon)),
        },
        Is::Sphere { radius } => Geometry::Sphere { radius },
        Is::Capsule {
            radius,
            half_height,
        } => Geometry::Capsule {
            radius,
            half_height,
        },
        Is::Cylinder {
            radius,
            half_height,
        } => Geometry::Cylinder {
            radius,
            half_height,
        },
        Is::Cone {
            radius,
            half_height,
        } => Geometry::Cone {
            radius,
            half_height,
        },
        Is::Box { half } => Geometry::Box {
            half: half.to_array(),
        },
        Is::Ellipsoid { half } => Geometry::Ellipsoid {
            half: half.to_array(),
        },
        Is::Hull(ref hull) => mesh(hull.vertices(), hull.triangles(), true),
        Is::Mesh(ref surface) => mesh(surface.vertices(), surface.triangles(), false),
        Is::MeshFile { ref file, scale } if opens => match collide::mesh::load(file, scale) {
            Ok(surface) => mesh(surface.vertices(), surface.triangles(), false),
            Err(_) => unseen(),
        },
        Is::MeshFile { .. } => unseen(),
    }
}

/// Half of what is drawn of a plane along an axis [m], along which it may be endless.
fn to_horizon(half: f64) -> f64 {
    if half > 0.0 { half } else { 1000.0 }
}

/// Of a file that is not read there is nothing to see.
fn unseen() -> Geometry {
    mesh(&[], &[], false)
}

fn mesh(vertices: &[DVec3], triangles: &[[u32; 3]], flat: bool) -> Geometry {
    let numbers = vertices.iter().flat_map(|v| v.as_vec3().to_array());
    Geometry::Mesh {
        positions: numbers.collect(),
        triangles: triangles.iter().flatten().copied().collect(),
        flat,
    }
}

/// Joints of a model, with the target positions and velocities of their degrees of freedom. `sliders` names
/// those whose drives have sliders at first, and `gains` says whether these set stiffness and damping, too.
pub(crate) fn joints(
    model: &Model,
    targets: &[[f64; 2]],
    sliders: &[String],
    gains: bool,
) -> Vec<Joint> {
    let joint = |(i, joint): (usize, &model::Joint)| {
        let coordinates = model.coordinate_range(JointId(i));
        let rows = model.dof_range(JointId(i));
        let at_first = sliders.contains(&joint.name);
        let dof = |(k, dof): (usize, &model::Dof)| {
            let (angular, axis, point) = axis(joint, k);
            let [position, velocity] = targets[rows.start + k];
            Dof {
                name: dof.name.clone(),
                dof: (rows.start + k) as u32,
                angular,
                axis: axis.to_array(),
                point: point.to_array(),
                limit: dof.limit.map(|limit| [limit.lower, limit.upper]),
                position,
                stiffness: dof.drive.stiffness,
                velocity,
                damping: dof.drive.damping,
                sliders: at_first,
                drive: match joint.kind {
                    JointKind::Free => Vec::new(),
                    _ => sliders::of_drive(dof, angular, gains),
                },
            }
        };
        let dofs = if joint.closes_loop {
            Vec::new()
        } else {
            joint.dofs.iter().enumerate().map(dof).collect()
        };
        Joint {
            name: joint.name.clone(),
            kind: joint.kind.name().into(),
            parent: row_of(joint.parent),
            child: joint.child.0 as i32,
            parent_frame: joint.parent_frame.into(),
            child_frame: joint.child_frame.into(),
            dofs,
            coordinate: if joint.closes_loop {
                -1
            } else {
                coordinates.start as i32
            },
            coordinates: coordinates.len() as u32,
        }
    };
    model.joints.iter().enumerate().map(joint).collect()
}

/// Whether a degree of freedom turns, its axis, and a point on it, in the joint's frame.
pub(crate) fn axis(joint: &model::Joint, dof: usize) -> (bool, DVec3, DVec3) {
    match joint.kind {
        JointKind::Ball => (true, DVec3::AXES[dof], DVec3::ZERO),
        JointKind::Free => (dof >= 3, DVec3::AXES[dof % 3], DVec3::ZERO),
        _ => {
            let axis = &joint.axes[dof];
            let angular = axis.kind == model::AxisKind::Angular;
            (angular, axis.direction, axis.anchor)
        }
    }
}

/// Actuators, in the model's order, at their controls.
pub(crate) fn actuators(model: &Model, controls: &[f64]) -> Vec<Actuator> {
    let actuator = |(actuator, &value): (&model::Actuator, &f64)| Actuator {
        name: actuator.name.clone(),
        value,
        slider: sliders::of_actuator(model, actuator),
    };
    model.actuators.iter().zip(controls).map(actuator).collect()
}

/// Cameras that the model names.
pub(crate) fn cameras(model: &Model) -> Vec<Camera> {
    let camera = |camera: &model::Camera| Camera {
        name: camera.name.clone(),
        body: row_of(camera.body),
        mode: camera.mode,
        placement: camera.pose.into(),
        field_of_view: camera.field_of_view,
    };
    model.cameras.iter().map(camera).collect()
}

/// Lights of a model.
pub(crate) fn lamps(model: &Model) -> Vec<Lamp> {
    let lamp = |lamp: &model::Lamp| Lamp {
        name: lamp.name.clone(),
        body: row_of(lamp.body),
        mode: lamp.mode,
        placement: lamp.pose.into(),
        beam: match lamp.kind {
            LampKind::Parallel => Beam::Parallel,
            LampKind::Point => Beam::Point,
            LampKind::Spot { cutoff, exponent } => Beam::Spot { cutoff, exponent },
        },
        color: lamp.color.to_array(),
        attenuation: lamp.attenuation.to_array(),
        shadows: lamp.shadows,
    };
    model.lamps.iter().map(lamp).collect()
}

/// A box [m] that holds all that has an end, as the bodies stand in the model.
pub(crate) fn bounds(model: &Model) -> [[f64; 3]; 2] {
    let mut low = DVec3::INFINITY;
    let mut high = -DVec3::INFINITY;
    for shape in &model.shapes {
        let body = shape
            .body
            .map_or(Pose::IDENTITY, |id| model.bodies[id.0].pose);
        let pose = body * shape.pose;
        let Some(half) = shape.geometry.half_extents() else {
            continue;
        };
        let center = pose.point(shape.geometry.center());
        let turned = DVec3::AXES.map(|axis| (pose.orientation.conjugate() * axis).abs().dot(half));
        let reach = DVec3::from_array(turned);
        low = low.min(center - reach);
        high = high.max(center + reach);
    }
    if low.is_finite() && high.is_finite() {
        [low.to_array(), high.to_array()]
    } else {
        [[-1.0; 3], [1.0; 3]]
    }
}
