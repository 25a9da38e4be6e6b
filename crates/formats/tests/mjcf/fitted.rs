//! Solids that are fitted to meshes, with the sizes and places of MuJoCo 4.0, whose vertices have single precision.

use crate::common::{lenient, lines, read, refused};
use crate::sizes::sizes;
use glam::{DQuat, DVec3};
use kinetarium_formats::{InMemory, Options, parse};
use model::{Geometry, MassProperties, Shape};
use std::f64::consts::FRAC_PI_2;

/// Twelve points of which no two principal moments are alike.
const POINTS: &str = "0.712 -0.311 0.342 -0.070 0.109 0.278 -0.506 0.154 0.213 1.097 0.245 0.265 0.016 0.066 0.194 \
                      -0.017 0.296 0.276 0.387 0.160 0.302 0.564 0.309 0.249 0.045 0.308 0.494 0.019 0.151 0.400 \
                      -0.166 0.142 0.388 0.274 0.218 0.367";
/// A cube with a pit in its upper face.
const PIT: &str = "vertex='-1 -1 0 1 -1 0 1 1 0 -1 1 0 -1 -1 2 1 -1 2 1 1 2 -1 1 2 0 0 1' \
                   face='3 2 1 3 1 0 0 1 5 0 5 4 1 2 6 1 6 5 2 3 7 2 7 6 3 0 4 3 4 7 4 5 8 5 6 8 6 7 8 7 4 8'";

fn text(mesh: &str, geom: &str, compiler: &str) -> String {
    format!(
        "<mujoco><compiler {compiler}/><asset><mesh name='m' {mesh}/></asset>
         <worldbody><geom mesh='m' {geom} pos='1 2 3' euler='30 40 50'/></worldbody></mujoco>"
    )
}

fn fitted(mesh: &str, geom: &str, compiler: &str) -> Shape {
    read(&text(mesh, geom, compiler)).model.shapes[0].clone()
}

/// The frame of a solid, if it stood along z.
fn turn(shape: &Shape) -> DQuat {
    match shape.geometry {
        Geometry::Capsule { .. } | Geometry::Cylinder { .. } => {
            shape.pose.orientation * DQuat::from_rotation_x(-FRAC_PI_2)
        }
        _ => shape.pose.orientation,
    }
}

#[test]
fn solids_have_the_size_and_place_of_a_mesh() {
    // MuJoCo's quaternion is w x y z.
    let axes = DQuat::from_xyzw(0.7255251876, 0.0318874595, 0.4067689447, -0.554197995);
    let of_inertia = (
        "",
        DVec3::new(1.2813828192, 2.1693843565, 3.3028480815),
        [
            ("sphere", [0.261377556, 0.0, 0.0]),
            ("capsule", [0.1447164495, 0.4223415444, 0.0]),
            ("cylinder", [0.1447164495, 0.4946997691, 0.0]),
            ("ellipsoid", [0.092514107, 0.196918792, 0.4946997691]),
            ("box", [0.092514107, 0.196918792, 0.4946997691]),
        ],
    );
    let of_bounds = (
        "fitaabb='true'",
        DVec3::new(1.3328623131, 2.1229462315, 3.2587021125),
        [
            ("sphere", [0.791838892, 0.0, 0.0]),
            ("capsule", [0.2974249353, 0.4944139567, 0.0]),
            ("cylinder", [0.2974249353, 0.791838892, 0.0]),
            ("ellipsoid", [0.1437453688, 0.2974249353, 0.791838892]),
            ("box", [0.1437453688, 0.2974249353, 0.791838892]),
        ],
    );
    for (compiler, place, kinds) in [of_inertia, of_bounds] {
        for (kind, expected) in kinds {
            let mesh = format!("vertex='{POINTS}'");
            let shape = fitted(&mesh, &format!("type='{kind}'"), compiler);
            let found = sizes(&shape.geometry);
            let near = found.abs_diff_eq(DVec3::from_array(expected), 1e-7);
            assert!(near, "{kind} {compiler}: {found}");
            assert!(shape.pose.position.abs_diff_eq(place, 1e-7), "{shape:?}");
            let cosine = turn(&shape).dot(axes).abs();
            assert!((cosine - 1.0).abs() < 1e-7, "{kind}: {cosine}");
        }
    }
}

#[test]
fn what_a_mesh_weighs_says_what_is_fitted_to_it() {
    for (inertia, size, place) in [
        (
            "exact",
            [0.1438612707, 0.23983851],
            [1.0546369468, 1.9674431112, 3.0563901856],
        ),
        (
            "convex",
            [0.15, 0.225],
            [1.064278761, 1.9616977778, 3.0663413948],
        ),
        (
            "shell",
            [0.1916586562, 0.2547634328],
            [1.0623756187, 1.9628318161, 3.0643771829],
        ),
    ] {
        let mesh = format!("{PIT} scale='.2 .1 .1' inertia='{inertia}'");
        let shape = fitted(&mesh, "type='capsule' fitscale='1.5'", "");
        let (found, [radius, half]) = (sizes(&shape.geometry), size);
        let near = found.abs_diff_eq(DVec3::new(radius, half, 0.0), 1e-7);
        assert!(near, "{inertia}: {found}");
        let place = DVec3::from_array(place);
        assert!(shape.pose.position.abs_diff_eq(place, 1e-7), "{shape:?}");
    }
}

/// Of a cube all axes are principal ones: those of the frame that it is given in are taken.
#[test]
fn a_cube_is_fitted_along_the_axes_of_its_frame() {
    let mesh = "vertex='0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1' refpos='.1 .2 .3' refquat='.8 .6 0 0'";
    let place = DVec3::new(0.8858713766, 2.5225512121, 3.0625690661);
    let axes = DQuat::from_xyzw(0.3600421737, 0.1966282255, 0.4638269103, 0.7852207151);
    for (compiler, across) in [("", 0.5), ("fitaabb='true'", 0.62)] {
        let shape = fitted(mesh, "type='box'", compiler);
        let expected = DVec3::new(0.5, across, across);
        assert!(
            sizes(&shape.geometry).abs_diff_eq(expected, 1e-7),
            "{shape:?}"
        );
        assert!(shape.pose.position.abs_diff_eq(place, 1e-7), "{shape:?}");
        assert!(turn(&shape).dot(axes).abs() > 1.0 - 1e-9, "{shape:?}");
    }
}

/// Whatever meshes become, which here are to stay names.
#[test]
fn files_are_read_to_be_fitted_to() {
    let obj = "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    let files = InMemory::new([("m.obj", obj)]);
    let body = "<mujoco><asset><mesh file='m.obj'/></asset><worldbody><body><freejoint/>\n\
                <geom type='box' mesh='m'/></body></worldbody></mujoco>";
    let loaded = parse(body, "robot.xml", &files, &Options::default()).unwrap();
    let told = "robot.xml:2: <geom>: size from a mesh: it is that of what its surface holds";
    assert_eq!(lines(&loaded.warnings), [told]);
    // It weighs what the box does.
    let shape = &loaded.model.shapes[0];
    let solid = MassProperties::of(&shape.geometry, 1000.0).unwrap();
    assert!((loaded.model.bodies[0].mass / solid.mass - 1.0).abs() < 1e-12);
    let missing = parse(body, "robot.xml", &InMemory::default(), &Options::default());
    let told = "robot.xml:2:1: <geom>: the mesh m.obj cannot be read";
    let error = missing.unwrap_err().to_string();
    assert!(error.starts_with(told), "{error}");
}

#[test]
fn what_does_not_fit_says_why() {
    let points = format!("vertex='{POINTS}'");
    let open = "vertex='0 0 0 1 0 0 0 1 0 0 0 1' face='0 1 2'";
    let flat = format!("{PIT} scale='.1 .1 .01'");
    for (mesh, geom, compiler, told) in [
        (
            points.as_str(),
            "type='plane'",
            "",
            "attribute `mesh` is given for a plane; remove it, or write type=\"mesh\"",
        ),
        (
            points.as_str(),
            "type='box' fromto='0 0 0 1 0 0'",
            "",
            "attribute `fromto` stands beside `mesh`; keep one of them",
        ),
        (
            points.as_str(),
            "type='box' fitscale='0'",
            "",
            "attribute `mesh` fits a box of size 0; write another type, or `size` instead of `mesh`",
        ),
        (
            flat.as_str(),
            "type='capsule'",
            "fitaabb='true'",
            "attribute `mesh` fits a capsule of size ",
        ),
        (
            open,
            "type='sphere'",
            "",
            "its size is that of the mesh `m`, which is open",
        ),
        (
            "builtin='cone' params='9 1'",
            "type='sphere'",
            "",
            "the built-in mesh `cone` is not supported",
        ),
    ] {
        let error = refused(&text(mesh, geom, compiler));
        let place = error.starts_with("robot.xml:2:") && error.contains("<geom>: ");
        assert!(place && error.contains(told), "{error}");
    }
    let left_out = lenient(&text(open, "type='sphere'", ""));
    assert!(left_out.model.shapes.is_empty() && left_out.warnings.len() == 1);
}
