//! What the tables of a model must fulfil one by one, before joints are followed from body to body.

use super::check::{Subject, names};
use super::joints;
use crate::mass::{LEAST_MOMENT, principal_moments};
use crate::{
    Actuator, Body, BodyKind, Camera, Coupling, Geometry, JointId, JointKind, Keyframe, Material,
    Measurand, ModelError, Parts, Sensor, Shape, Softness,
};
use glam::DMat3;
use std::collections::HashMap;

/// Most rows of a table: enough for any scene, few enough to stop a slip of the keyboard.
pub(crate) const MOST_ROWS: usize = 1_000_000;
/// Most worlds of a model.
const MOST_WORLDS: usize = 10_000_000;
/// Largest impedance of a contact: an added mass of ten thousand masses.
const MOST_IMPEDANCE: f64 = 0.9999;
/// Angles that a camera's image may have [rad].
const FIELDS_OF_VIEW: [f64; 2] = [1e-6, std::f64::consts::PI - 1e-6];
/// Most pixels of a row of a camera's image, and most rows.
const MOST_PIXELS: f64 = 16384.0;
/// Most lamps of a model: each is asked for every pixel.
const MOST_LAMPS: usize = 256;
/// Relative slack for inertia matrices, which files give with few digits.
const INERTIA_TOLERANCE: f64 = 1e-6;

/// Checks everything but keyframes, whose length depends on joints still to be added.
pub(super) fn parts(parts: &Parts) -> Result<(), ModelError> {
    counts(parts)?;
    settings(parts)?;
    all_names(parts)?;
    parts.bodies.iter().try_for_each(body)?;
    parts
        .shapes
        .iter()
        .try_for_each(|s| shape(s, parts.bodies.len()))?;
    parts
        .joints
        .iter()
        .try_for_each(|j| joints::joint(j, &parts.bodies))?;
    exclusions(parts)?;
    contact_pairs(parts)?;
    parts
        .couplings
        .iter()
        .try_for_each(|c| coupling(c, parts))?;
    parts
        .actuators
        .iter()
        .try_for_each(|a| actuator(a, parts))?;
    parts.sensors.iter().try_for_each(|s| sensor(s, parts))?;
    parts
        .cameras
        .iter()
        .try_for_each(|c| camera(c, parts.bodies.len()))?;
    parts
        .lamps
        .iter()
        .try_for_each(|l| l.check(parts.bodies.len()))
}

fn counts(parts: &Parts) -> Result<(), ModelError> {
    let tables = [
        ("bodies", parts.bodies.len(), MOST_ROWS),
        ("shapes", parts.shapes.len(), MOST_ROWS),
        ("joints", parts.joints.len(), MOST_ROWS),
        ("exclusions", parts.exclusions.len(), MOST_ROWS),
        ("contact pairs", parts.contact_pairs.len(), MOST_ROWS),
        ("couplings", parts.couplings.len(), MOST_ROWS),
        ("actuators", parts.actuators.len(), MOST_ROWS),
        ("sensors", parts.sensors.len(), MOST_ROWS),
        ("keyframes", parts.keyframes.len(), MOST_ROWS),
        ("cameras", parts.cameras.len(), MOST_ROWS),
        ("lamps", parts.lamps.len(), MOST_LAMPS),
        ("worlds", parts.worlds, MOST_WORLDS),
    ];
    match tables.into_iter().find(|&(_, count, most)| count > most) {
        Some((what, count, most)) => Err(ModelError::TooMany { what, count, most }),
        None => Ok(()),
    }
}

fn settings(parts: &Parts) -> Result<(), ModelError> {
    let subject = Subject {
        kind: "model",
        name: &parts.name,
    };
    subject.positive("time step [s]", parts.time_step)?;
    subject.all_finite("gravity [m/s²]", &parts.gravity.to_array())?;
    if parts.worlds == 0 {
        return Err(ModelError::NoWorlds);
    }
    Ok(())
}

fn all_names(parts: &Parts) -> Result<(), ModelError> {
    names("body", parts.bodies.iter().map(|b| b.name.as_str()))?;
    names("joint", parts.joints.iter().map(|j| j.name.as_str()))?;
    let dofs = parts.joints.iter().flat_map(|j| &j.dofs);
    names("degree of freedom", dofs.map(|d| d.name.as_str()))?;
    names("coupling", parts.couplings.iter().map(|c| c.name.as_str()))?;
    names("actuator", parts.actuators.iter().map(|a| a.name.as_str()))?;
    names("sensor", parts.sensors.iter().map(|s| s.name.as_str()))?;
    names("keyframe", parts.keyframes.iter().map(|k| k.name.as_str()))?;
    names("camera", parts.cameras.iter().map(|c| c.name.as_str()))?;
    names("lamp", parts.lamps.iter().map(|l| l.name.as_str()))
}

fn camera(camera: &Camera, bodies: usize) -> Result<(), ModelError> {
    let subject = Subject {
        kind: "camera",
        name: &camera.name,
    };
    if let Some(body) = camera.body {
        subject.row("body", body.0, bodies)?;
    }
    subject.pose("pose", &camera.pose)?;
    let [narrowest, widest] = FIELDS_OF_VIEW;
    subject.within(
        "field of view [rad]",
        camera.field_of_view,
        narrowest,
        widest,
    )?;
    let mut sides = camera.size.into_iter().flatten().map(f64::from);
    sides.try_for_each(|side| subject.within("size [pixel]", side, 1.0, MOST_PIXELS))
}

fn body(body: &Body) -> Result<(), ModelError> {
    let subject = Subject {
        kind: "body",
        name: &body.name,
    };
    subject.pose("pose", &body.pose)?;
    if body.world < -1 {
        let (quantity, upper) = ("world", f64::from(i32::MAX));
        return subject.within(quantity, f64::from(body.world), -1.0, upper);
    }
    if body.kind == BodyKind::Static {
        return Ok(());
    }
    subject.positive("mass [kg]", body.mass)?;
    subject.all_finite("centre of mass [m]", &body.center.to_array())?;
    subject.all_finite("inertia [kg·m²]", &body.inertia.to_cols_array())?;
    inertia(&body.name, body.inertia)
}

/// A solid's inertia matrix is symmetric and positive definite, and its principal moments are
/// ∫(y²+z²)dm, ∫(z²+x²)dm, ∫(x²+y²)dm, so that none exceeds the sum of the others.
fn inertia(name: &str, inertia: DMat3) -> Result<(), ModelError> {
    let body = || name.to_owned();
    let size = inertia
        .to_cols_array()
        .iter()
        .fold(0.0, |m: f64, x| m.max(x.abs()));
    let skew = inertia - inertia.transpose();
    let difference = skew
        .to_cols_array()
        .iter()
        .fold(0.0, |m: f64, x| m.max(x.abs()));
    if difference > INERTIA_TOLERANCE * size {
        return Err(ModelError::InertiaNotSymmetric {
            body: body(),
            difference,
        });
    }
    let mut moments = principal_moments(inertia).to_array();
    moments.sort_by(f64::total_cmp);
    let [a, b, c] = moments;
    if a <= LEAST_MOMENT * size {
        return Err(ModelError::InertiaNotPositive {
            body: body(),
            smallest: a,
        });
    }
    if c > (a + b) * (1.0 + INERTIA_TOLERANCE) {
        return Err(ModelError::InertiaTriangle {
            body: body(),
            moments,
        });
    }
    Ok(())
}

fn shape(shape: &Shape, bodies: usize) -> Result<(), ModelError> {
    let subject = shape_subject(shape);
    if let Some(body) = shape.body {
        subject.row("body", body.0, bodies)?;
    }
    subject.pose("pose", &shape.pose)?;
    solid(shape)?;
    material(&subject, &shape.material)?;
    let color = shape.color.iter().flatten();
    color
        .map(|&part| f64::from(part))
        .try_for_each(|part| subject.within("colour", part, 0.0, 1.0))
}

fn shape_subject(shape: &Shape) -> Subject<'_> {
    Subject {
        kind: "shape",
        name: &shape.name,
    }
}

/// What a shape's mass follows from.
pub(crate) fn solid(shape: &Shape) -> Result<(), ModelError> {
    let subject = shape_subject(shape);
    subject.not_negative("density [kg/m³]", shape.density)?;
    geometry(&subject, &shape.geometry)
}

fn geometry(subject: &Subject, geometry: &Geometry) -> Result<(), ModelError> {
    match *geometry {
        Geometry::Plane { half_x, half_z } => {
            subject.not_negative("half size along x [m]", half_x)?;
            subject.not_negative("half size along z [m]", half_z)
        }
        Geometry::Sphere { radius } => subject.positive("radius [m]", radius),
        Geometry::Cylinder {
            radius,
            half_height,
        }
        | Geometry::Cone {
            radius,
            half_height,
        } => {
            subject.positive("radius [m]", radius)?;
            subject.positive("half height [m]", half_height)
        }
        Geometry::Capsule {
            radius,
            half_height,
        } => {
            subject.positive("radius [m]", radius)?;
            subject.positive("half height [m]", half_height)?;
            // A factor that rounds down lets 1.01 · radius itself through.
            if half_height < 1.01 * (1.0 - 1e-12) * radius {
                let what = subject.what();
                return Err(ModelError::CapsuleTooShort {
                    what,
                    half_height,
                    radius,
                });
            }
            Ok(())
        }
        Geometry::Box { half } => subject.all_positive("half extent [m]", half),
        Geometry::Ellipsoid { half } => subject.all_positive("half axis [m]", half),
        // Checked when it was made.
        Geometry::Hull(_) | Geometry::Mesh(_) => Ok(()),
        Geometry::MeshFile { ref file, scale } => {
            if file.is_empty() {
                return Err(ModelError::MeshWithoutFile {
                    what: subject.what(),
                });
            }
            // Negative scales mirror, which is how files make a left hand of a right one.
            subject.all_finite("scale", &scale.to_array())?;
            subject.all_positive("scale without its sign", scale.abs())
        }
    }
}

fn softness(subject: &Subject, softness: Softness) -> Result<(), ModelError> {
    match softness {
        Softness::Time {
            constant,
            ratio,
            impedance,
            mass,
        } => {
            subject.positive("time constant of contact [s]", constant)?;
            subject.positive("damping ratio of contact", ratio)?;
            subject.positive("mass of contact [kg]", mass.unwrap_or(1.0))?;
            subject.within("impedance of contact", impedance, 0.0, MOST_IMPEDANCE)
        }
        Softness::Spring { stiffness, damping } => {
            subject.positive("stiffness of contact [N/m]", stiffness)?;
            subject.not_negative("damping of contact [N·s/m]", damping)
        }
    }
}

fn material(subject: &Subject, material: &Material) -> Result<(), ModelError> {
    subject.not_negative("friction", material.friction)?;
    if let Some(sticking) = material.static_friction {
        subject.not_negative("static friction", sticking)?;
        if sticking < material.friction {
            return Err(ModelError::SticksLess {
                what: subject.what(),
                sticking,
                sliding: material.friction,
            });
        }
    }
    subject.not_negative("torsional friction [m]", material.torsional_friction)?;
    subject.not_negative("rolling friction [m]", material.rolling_friction)?;
    subject.within("restitution", material.restitution, 0.0, 1.0)?;
    softness(subject, material.softness)?;
    subject.finite("margin [m]", material.margin)
}

fn exclusions(parts: &Parts) -> Result<(), ModelError> {
    for (row, &(other, body)) in parts.exclusions.iter().enumerate() {
        let name = row.to_string();
        let subject = Subject {
            kind: "exclusion",
            name: &name,
        };
        for id in other.into_iter().chain([body]) {
            subject.row("body", id.0, parts.bodies.len())?;
        }
        if other == Some(body) {
            return Err(ModelError::ExcludedFromItself {
                what: subject.what(),
                body: parts.bodies[body.0].name.clone(),
            });
        }
    }
    Ok(())
}

fn contact_pairs(parts: &Parts) -> Result<(), ModelError> {
    let mut rows = HashMap::new();
    for (row, pair) in parts.contact_pairs.iter().enumerate() {
        let name = row.to_string();
        let subject = Subject {
            kind: "contact pair",
            name: &name,
        };
        let (a, b) = pair.key();
        subject.row("shape", b, parts.shapes.len())?;
        if a == b {
            return Err(ModelError::SameTwice {
                what: subject.what(),
                kind: "shapes",
                index: a,
            });
        }
        if let Some(first) = rows.insert((a, b), row) {
            return Err(ModelError::PairTwice { first, second: row });
        }
        material(&subject, &pair.material)?;
    }
    Ok(())
}

fn coupling(coupling: &Coupling, parts: &Parts) -> Result<(), ModelError> {
    let subject = Subject {
        kind: "coupling",
        name: &coupling.name,
    };
    subject.finite("ratio", coupling.ratio)?;
    subject.finite("offset", coupling.offset)?;
    for id in [coupling.joint, coupling.other] {
        subject.row("joint", id.0, parts.joints.len())?;
        let joint = &parts.joints[id.0];
        if joint.axes.len() != 1 {
            return Err(ModelError::CouplingAxes {
                coupling: coupling.name.clone(),
                joint: joint.name.clone(),
                axes: joint.axes.len(),
            });
        }
    }
    if coupling.joint == coupling.other {
        return Err(ModelError::CouplingToItself {
            coupling: coupling.name.clone(),
            joint: parts.joints[coupling.joint.0].name.clone(),
        });
    }
    Ok(())
}

fn actuator(actuator: &Actuator, parts: &Parts) -> Result<(), ModelError> {
    let subject = Subject {
        kind: "actuator",
        name: &actuator.name,
    };
    subject.row("joint", actuator.joint.0, parts.joints.len())?;
    let joint = &parts.joints[actuator.joint.0];
    let count = joint.degrees_of_freedom();
    if actuator.dof >= count {
        return Err(ModelError::ActuatorDof {
            actuator: actuator.name.clone(),
            joint: joint.name.clone(),
            dof: actuator.dof,
            count,
            closes_loop: joint.closes_loop,
        });
    }
    subject.finite("gear", actuator.gear)?;
    subject.finite("gain", actuator.gain)?;
    subject.all_finite("bias", &actuator.bias)?;
    actuator
        .control_range
        .map_or(Ok(()), |r| subject.range("control range", r))?;
    actuator
        .force_range
        .map_or(Ok(()), |r| subject.range("force range", r))
}

fn sensor(sensor: &Sensor, parts: &Parts) -> Result<(), ModelError> {
    let subject = Subject {
        kind: "sensor",
        name: &sensor.name,
    };
    subject.not_negative("noise", sensor.noise)?;
    let (rate, cutoff) = (sensor.rate, sensor.cutoff);
    rate.map_or(Ok(()), |rate| subject.positive("rate [Hz]", rate))?;
    cutoff.map_or(Ok(()), |cutoff| subject.positive("cutoff", cutoff))?;
    let (bodies, mut measurand) = (parts.bodies.len(), sensor.measurand);
    for mount in measurand.mounts_mut() {
        mount
            .body
            .map_or(Ok(()), |body| subject.row("body", body.0, bodies))?;
        subject.pose("frame", &mount.pose)?;
    }
    if let Some(body) = measurand.body_mut() {
        subject.row("body", body.0, bodies)?;
    }
    match sensor.measurand {
        Measurand::Force { frame, .. } | Measurand::Torque { frame, .. } => {
            subject.pose("frame", &frame)?;
        }
        Measurand::ActuatorForce { actuator } => {
            subject.row("actuator", actuator, parts.actuators.len())?;
        }
        _ => {}
    }
    match measurand.joint_mut() {
        Some(joint) => sensor_joint(&subject, &sensor.measurand, *joint, parts),
        None => Ok(()),
    }
}

/// The joint of a sensor has what is measured of it.
fn sensor_joint(
    subject: &Subject<'_>,
    measurand: &Measurand,
    joint: JointId,
    parts: &Parts,
) -> Result<(), ModelError> {
    subject.row("joint", joint.0, parts.joints.len())?;
    let joint = &parts.joints[joint.0];
    let fits = match *measurand {
        Measurand::JointPosition { axis, .. }
        | Measurand::JointVelocity { axis, .. }
        | Measurand::JointEffort { axis, .. } => {
            return subject.row("axis", axis, joint.axes.len());
        }
        Measurand::BallOrientation { .. } | Measurand::BallVelocity { .. } => {
            joint.kind == JointKind::Ball
        }
        _ => joint.kind != JointKind::Free,
    };
    if fits {
        return Ok(());
    }
    Err(ModelError::SensorJoint {
        sensor: subject.name.to_owned(),
        joint: joint.name.clone(),
    })
}

/// Checks a keyframe against the finished joints: numbers of entries, and quaternions.
pub(super) fn keyframe(
    keyframe: &Keyframe,
    parts: &Parts,
    coordinate_start: &[usize],
    dofs: usize,
) -> Result<(), ModelError> {
    let subject = Subject {
        kind: "keyframe",
        name: &keyframe.name,
    };
    let coordinates = coordinate_start[parts.joints.len()];
    let why = " (bodies without a joint get a free one, last in the order)";
    let position = &keyframe.joint_position;
    subject.length("list of joint positions", position.len(), coordinates, why)?;
    subject.length(
        "list of joint velocities",
        keyframe.joint_velocity.len(),
        dofs,
        why,
    )?;
    subject.length(
        "list of controls",
        keyframe.control.len(),
        parts.actuators.len(),
        "",
    )?;
    subject.all_finite("joint position", position)?;
    subject.all_finite("joint velocity", &keyframe.joint_velocity)?;
    subject.all_finite("control", &keyframe.control)?;
    for (joint, range) in parts.joints.iter().zip(coordinate_start.windows(2)) {
        joints::quaternion(&subject, joint, &position[range[0]..range[1]])?;
    }
    Ok(())
}
