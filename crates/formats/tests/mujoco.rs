//! Every MJCF model that gymnasium ships, loaded here and by MuJoCo: names, masses, inertias, initial
//! poses, joints, contacts.
//!
//! `cargo xtask peers` writes MuJoCo's view of each model as JSON and names the folder in
//! `KINETARIUM_PEERS`.

mod common;

use common::{TOLERANCE, close, compare_contacts, coordinates, number, poses, quaternion, vector};
use glam::DMat3;
use kinetarium_formats::{self as formats, Options};
use model::Model;
use serde_json::Value;
use std::path::Path;

#[test]
#[ignore = "needs MuJoCo's reference files: cargo xtask peers"]
fn loads_as_mujoco_does() {
    let folder = std::env::var("KINETARIUM_PEERS").expect("KINETARIUM_PEERS names the references");
    let mut models = 0;
    for entry in std::fs::read_dir(&folder).expect("the folder of references") {
        let path = entry.expect("a file").path();
        if path
            .extension()
            .is_some_and(|extension| extension == "json")
        {
            let text = std::fs::read_to_string(&path).expect("a reference");
            compare(&serde_json::from_str(&text).expect("JSON"));
            models += 1;
        }
    }
    assert!(models >= 11, "only {models} references in {folder}");
}

fn compare(reference: &Value) {
    let path = reference["path"].as_str().unwrap();
    let needs_leniency = reference["switched_off"]
        .as_array()
        .unwrap()
        .contains(&"fluid".into());
    let options = Options {
        lenient: needs_leniency,
        ..Options::default()
    };
    let model = formats::load(Path::new(path), &options)
        .unwrap_or_else(|e| panic!("{e}"))
        .model;
    compare_bodies(&model, reference, path);
    compare_joints(&model, reference, path);
    compare_contacts(&model, reference, path);
    close(model.time_step, number(&reference["timestep"]), path);
    assert!(
        model
            .gravity
            .abs_diff_eq(vector(&reference["gravity"]), TOLERANCE),
        "{path}"
    );
    assert_eq!(
        model.actuators.len() as u64,
        reference["nu"].as_u64().unwrap(),
        "{path}"
    );
}

fn compare_bodies(model: &Model, reference: &Value, path: &str) {
    let names = reference["body_name"].as_array().unwrap();
    assert_eq!(model.bodies.len() + 1, names.len(), "{path}");
    for (i, body) in model.bodies.iter().enumerate() {
        let of = |field: &str| &reference[field][i + 1];
        let what = format!("{path}, body {}", body.name);
        if of("body_name") != "" {
            assert_eq!(of("body_name"), body.name.as_str(), "{what}");
        }
        close(body.mass, number(of("body_mass")), &what);
        assert!(
            body.center.abs_diff_eq(vector(of("body_ipos")), TOLERANCE),
            "{what}"
        );
        let r = DMat3::from_quat(quaternion(of("body_iquat")));
        let inertia = r * DMat3::from_diagonal(vector(of("body_inertia"))) * r.transpose();
        let scale = inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z;
        assert!(
            body.inertia.abs_diff_eq(inertia, TOLERANCE * scale),
            "{what}"
        );
    }
}

/// Poses are compared in the reference's states: they place every body at 200 sets of coordinates.
fn compare_joints(model: &Model, reference: &Value, path: &str) {
    assert_eq!(
        model.coordinates() as u64,
        reference["nq"].as_u64().unwrap(),
        "{path}"
    );
    assert_eq!(
        model.degrees_of_freedom() as u64,
        reference["nv"].as_u64().unwrap(),
        "{path}"
    );
    let dofs: Vec<_> = model.joints.iter().flat_map(|joint| &joint.dofs).collect();
    for (dof, armature) in dofs
        .iter()
        .zip(reference["dof_armature"].as_array().unwrap())
    {
        close(
            dof.armature,
            number(armature),
            &format!("{path}, {}", dof.name),
        );
    }
    let states = reference["states"].as_array().unwrap();
    assert_eq!(states.len(), 200, "{path}");
    for state in states {
        let poses = poses(model, &coordinates(model, &state["qpos"]));
        for (i, pose) in poses.iter().enumerate() {
            let what = format!("{path}, body {}", model.bodies[i].name);
            let (position, turn) = (
                vector(&state["xpos"][i + 1]),
                quaternion(&state["xquat"][i + 1]),
            );
            assert!(
                pose.position.abs_diff_eq(position, TOLERANCE),
                "{what}: {pose:?}"
            );
            assert!(
                pose.orientation.dot(turn).abs() > 1.0 - TOLERANCE,
                "{what}: {pose:?}"
            );
        }
    }
}
