//! Small models, one for each group of MJCF features, against what MuJoCo makes of them.
//!
//! The references `models/*.json` are written by `models/reference.py`.

mod common;
#[path = "common/sizes.rs"]
mod sizes;

use common::{
    TOLERANCE, close, compare_contacts, coordinates, impedances, law, number, poses, quaternion,
    vector,
};
use glam::{DMat3, DQuat, DVec3};
use kinetarium_formats::{self as formats, Options};
use model::{Body, Dof, Geometry, Model, Pose};
use serde_json::Value;
use sizes::sizes;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models")
}

fn load(name: &str) -> (Model, Value) {
    let path = folder().join(format!("{name}.xml"));
    let model = formats::load(&path, &Options::default())
        .unwrap_or_else(|e| panic!("{e}"))
        .model;
    let text = std::fs::read_to_string(path.with_extension("json")).expect("a reference");
    let reference: Value = serde_json::from_str(&text).expect("JSON");
    compare_bodies(&model, &reference);
    compare_poses(&model, &reference);
    compare_contacts(&model, &reference, name);
    close(model.time_step, number(&reference["timestep"]), name);
    assert!(
        model
            .gravity
            .abs_diff_eq(vector(&reference["gravity"]), TOLERANCE)
    );
    (model, reference)
}

fn matrix(rows: &Value) -> DMat3 {
    DMat3::from_cols(vector(&rows[0]), vector(&rows[1]), vector(&rows[2])).transpose()
}

fn compare_bodies(model: &Model, reference: &Value) {
    assert_eq!(
        model.bodies.len() + 1,
        reference["body_name"].as_array().unwrap().len()
    );
    for (i, body) in model.bodies.iter().enumerate() {
        let of = |field: &str| &reference[field][i + 1];
        assert_eq!(of("body_name"), body.name.as_str());
        close(body.mass, number(of("body_mass")), &body.name);
        assert!(
            body.center.abs_diff_eq(vector(of("body_ipos")), TOLERANCE),
            "{}",
            body.name
        );
        let inertia = matrix(of("body_inertia"));
        let scale = inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z;
        assert!(
            body.inertia.abs_diff_eq(inertia, TOLERANCE * scale),
            "{}",
            body.name
        );
    }
}

fn compare_poses(model: &Model, reference: &Value) {
    for (i, state) in reference["states"].as_array().unwrap().iter().enumerate() {
        let poses = poses(model, &coordinates(model, &state["qpos"]));
        for (row, (body, pose)) in model.bodies.iter().zip(&poses).enumerate() {
            let at = vector(&state["xpos"][row + 1]);
            assert!(
                pose.position.abs_diff_eq(at, TOLERANCE),
                "{} at {at}",
                body.name
            );
            let turn = quaternion(&state["xquat"][row + 1]);
            assert!(
                pose.orientation.dot(turn).abs() > 1.0 - TOLERANCE,
                "{}",
                body.name
            );
            if i == 0 {
                assert!(
                    body.pose.position.abs_diff_eq(at, TOLERANCE),
                    "{}",
                    body.name
                );
            }
        }
        for (row, shape) in model.shapes.iter().enumerate() {
            let body = shape.body.map_or(Pose::IDENTITY, |id| poses[id.0]);
            let pose = body * standing_along_z(shape.pose, &shape.geometry);
            assert!(
                pose.position
                    .abs_diff_eq(vector(&state["geom_xpos"][row]), TOLERANCE)
            );
            let m: Vec<f64> = state["geom_xmat"][row]
                .as_array()
                .unwrap()
                .iter()
                .map(number)
                .collect();
            let m = DMat3::from_cols_slice(&m).transpose();
            let own = DMat3::from_quat(pose.orientation);
            assert!(
                own.abs_diff_eq(m, TOLERANCE),
                "shape {row}: {own} is not {m}"
            );
        }
    }
}

/// A solid's pose if it stood along z, as MuJoCo's do.
fn standing_along_z(pose: Pose, geometry: &Geometry) -> Pose {
    let quarter = DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2);
    match geometry {
        Geometry::Capsule { .. } | Geometry::Cylinder { .. } | Geometry::Plane { .. } => {
            pose * Pose::new(DVec3::ZERO, quarter)
        }
        _ => pose,
    }
}

fn dofs(model: &Model) -> Vec<&Dof> {
    model.joints.iter().flat_map(|joint| &joint.dofs).collect()
}

#[test]
fn orientations() {
    load("orientations");
}

#[test]
fn inertia() {
    let (model, reference) = load("inertia");
    for (row, shape) in model.shapes.iter().enumerate() {
        let size = vector(&reference["geom_size"][row]);
        let own = sizes(&shape.geometry);
        assert!(own.abs_diff_eq(size, TOLERANCE), "shape {row}: {own}");
    }
}

#[test]
fn total_mass() {
    let (model, _) = load("total_mass");
    let mass: f64 = model.bodies.iter().map(|body| body.mass).sum();
    close(mass, 7.0, "total mass");
}

#[test]
fn contacts() {
    let (_, reference) = load("contacts");
    assert_eq!(reference["contacts"].as_array().unwrap().len(), 83);
}

#[test]
fn joints() {
    let (model, reference) = load("joints");
    for (i, dof) in dofs(&model).iter().enumerate() {
        let of = |field: &str| number(&reference[field][i]);
        close(dof.armature, of("dof_armature"), &dof.name);
        close(dof.damping, of("dof_damping"), &dof.name);
        close(dof.friction_loss, of("dof_frictionloss"), &dof.name);
        let joint = reference["dof_jntid"][i].as_u64().unwrap() as usize;
        compare_joint(dof, &reference, joint, of("dof_invweight0"));
    }
    let names: Vec<&str> = model
        .joints
        .iter()
        .map(|joint| joint.name.as_str())
        .collect();
    assert_eq!(
        names,
        ["stack", "socket", "tuned", "welded", "flying", "direct"]
    );
    assert_eq!(model.joints[0].dofs[3].name, "second");
}

/// The limit's stiffness, damping and inertia follow from solref, solimp half way down, and MuJoCo's own estimate of the
/// inertia.
fn compare_joint(dof: &Dof, reference: &Value, joint: usize, inverse_inertia: f64) {
    let of = |field: &str| &reference[field][joint];
    let stiffness = &of("jnt_stiffness");
    close(dof.stiffness, number(stiffness), &dof.name);
    let scalar = number(of("jnt_type")) >= 2.0;
    if scalar && dof.stiffness > 0.0 {
        let address = of("jnt_qposadr").as_u64().unwrap() as usize;
        close(
            dof.rest,
            number(&reference["qpos_spring"][address]),
            &dof.name,
        );
    }
    assert_eq!(
        dof.limit.is_some(),
        of("jnt_limited").as_bool().unwrap(),
        "{}",
        dof.name
    );
    let Some(limit) = dof.limit else { return };
    let margin = number(of("jnt_margin"));
    close(limit.lower - margin, number(&of("jnt_range")[0]), &dof.name);
    close(limit.upper + margin, number(&of("jnt_range")[1]), &dof.name);
    let solref = [0, 1].map(|i| number(&of("jnt_solref")[i]));
    let solimp = of("jnt_solimp");
    assert_eq!((number(&solimp[3]), number(&solimp[4])), (0.5, 2.0));
    let [least, most] = impedances(solimp);
    let (k, b, d) = law(solref, most, 0.5 * (least + most));
    close(limit.stiffness * inverse_inertia, k, &dof.name);
    close(limit.damping * inverse_inertia, b, &dof.name);
    close(limit.inertia * inverse_inertia, d / (1.0 - d), &dof.name);
}

/// Where MuJoCo has each camera, in all states; x, y, z of its frame are the columns of `cam_xmat`.
#[test]
fn cameras() {
    let (model, reference) = load("cameras");
    let names: Vec<_> = model.cameras.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(reference["cam_name"], serde_json::json!(names));
    for (row, camera) in model.cameras.iter().enumerate() {
        let angle = number(&reference["cam_fovy"][row]).to_radians();
        close(camera.field_of_view, angle, &camera.name);
        let size = &reference["cam_resolution"][row];
        let given = camera.size.unwrap_or([1, 1]);
        assert_eq!(*size, serde_json::json!(given), "{}", camera.name);
    }
    compare_cameras(&model, &reference);
}

fn compare_cameras(model: &Model, reference: &Value) {
    for state in reference["states"].as_array().unwrap() {
        let poses = poses(model, &coordinates(model, &state["qpos"]));
        for (row, camera) in model.cameras.iter().enumerate() {
            let body = camera.body.map_or(Pose::IDENTITY, |id| poses[id.0]);
            let placed = camera.mode.placed(&body, &camera.pose);
            let at = vector(&state["cam_xpos"][row]);
            assert!(
                placed.position.abs_diff_eq(at, TOLERANCE),
                "{}",
                camera.name
            );
            let numbers: Vec<_> = (0..9).map(|i| number(&state["cam_xmat"][row][i])).collect();
            let turn = DMat3::from_cols_slice(&numbers).transpose();
            let own = DMat3::from_quat(placed.orientation);
            assert!(own.abs_diff_eq(turn, TOLERANCE), "{}", camera.name);
        }
    }
}

/// Free bodies have the frames of their inertia, the very ones that MuJoCo takes.
#[test]
fn aligned_bodies() {
    let (model, reference) = load("align");
    compare_cameras(&model, &reference);
    let key = coordinates(&model, &reference["key_qpos"][0]);
    assert_eq!(model.keyframes[0].joint_position, key);
    let turned = |body: &&Body| {
        let [x, y, z] = body.inertia.to_cols_array_2d();
        let products = DVec3::new(x[1], y[2], z[0]).abs().max_element();
        products > 1e-12 || body.center.length() > 1e-12
    };
    let turned = model.bodies.iter().filter(turned);
    let names: Vec<_> = turned.map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["kept", "carries", "hinged"]);
}

#[test]
fn keyframes() {
    let (model, reference) = load("joints");
    for (row, key) in model.keyframes.iter().enumerate() {
        let expected = coordinates(&model, &reference["key_qpos"][row]);
        for (own, expected) in key.joint_position.iter().zip(&expected) {
            assert!(
                (own - expected).abs() < TOLERANCE,
                "{}: {own} is not {expected}",
                key.name
            );
        }
        for (i, own) in key.joint_velocity.iter().enumerate() {
            close(*own, number(&reference["key_qvel"][row][i]), &key.name);
        }
    }
    assert_eq!(model.keyframes[1].name, "all");
}

#[test]
fn actuators() {
    let (model, reference) = load("actuators");
    for (i, actuator) in model.actuators.iter().enumerate() {
        let of = |field: &str| &reference[field][i];
        let name = &actuator.name;
        close(actuator.gain, number(&of("actuator_gainprm")[0]), name);
        for (k, bias) in actuator.bias.iter().enumerate() {
            close(*bias, number(&of("actuator_biasprm")[k]), name);
        }
        let gears: Vec<f64> = of("actuator_gear")
            .as_array()
            .unwrap()
            .iter()
            .map(number)
            .collect();
        let acting = gears.iter().position(|gear| *gear != 0.0).unwrap();
        assert_eq!(actuator.gear, gears[acting], "{name}");
        assert_eq!(actuator.dof, acting, "{name}");
        for (range, limited, expected) in [
            (
                actuator.control_range,
                "actuator_ctrllimited",
                "actuator_ctrlrange",
            ),
            (
                actuator.force_range,
                "actuator_forcelimited",
                "actuator_forcerange",
            ),
        ] {
            if name == "hold" && expected == "actuator_forcerange" {
                // −5 … 6 N·m, and with gear 2 the joint's own −3 … 4 N·m.
                assert_eq!(range, Some((-1.5, 2.0)));
                continue;
            }
            assert_eq!(range.is_some(), of(limited).as_bool().unwrap(), "{name}");
            if let Some((lower, upper)) = range {
                close(lower, number(&of(expected)[0]), name);
                close(upper, number(&of(expected)[1]), name);
            }
        }
    }
    let x = dofs(&model)[0];
    close(x.armature, 0.3 * 9.0, "rotor inertia behind gear 3");
    close(x.damping, 0.2 * 9.0, "rotor damping behind gear 3");
    assert_eq!(
        model.keyframes[0].control,
        [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]
    );
}
