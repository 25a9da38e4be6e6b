//! Meshes as their convex hulls: which become them, what they weigh, and what can be wrong.

use glam::DVec3;
use kinetarium_formats::{FormatError, InMemory, Loaded, Meshes, Options, parse};
use model::{Geometry, Hull, MassProperties, Shape};
use std::fs;

/// A cube of half size 1 about (0, 0, 1), with a pit in its upper face that its hull fills.
const CUBE: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0
v -1 -1 2\nv 1 -1 2\nv 1 1 2\nv -1 1 2\nv 0 0 1
f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8
f 5 6 9\nf 6 7 9\nf 7 8 9\nf 8 5 9\n";

const HULLS: Options = Options {
    lenient: false,
    meshes: Meshes::ConvexHull,
    floating_base: false,
};

fn read(text: &str, options: &Options) -> Result<Loaded, FormatError> {
    let flat = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let files = InMemory::new([
        ("meshes/cube.obj", CUBE),
        ("robot/cube.obj", CUBE),
        ("meshes/flat.obj", flat),
        ("meshes/broken.stl", "solid"),
    ]);
    parse(text, "robot.xml", &files, options)
}

fn shape<'a>(loaded: &'a Loaded, name: &str) -> &'a Shape {
    let named = |s: &&Shape| s.name == name;
    loaded.model.shapes.iter().find(named).unwrap()
}

fn is_mesh(shape: &Shape) -> bool {
    matches!(shape.geometry, Geometry::Mesh { .. })
}

fn hull(shape: &Shape) -> &Hull {
    match &shape.geometry {
        Geometry::Hull(hull) => hull,
        other => panic!("{other:?}"),
    }
}

/// Geoms on a body that is free; their mesh is 40 cm × 20 cm × 20 cm.
fn mjcf(geoms: &str) -> String {
    format!(
        r#"<mujoco><compiler meshdir="meshes"/>
        <asset><mesh file="cube.obj" scale=".2 .1 .1"/></asset>
        <worldbody><body><freejoint/>{geoms}</body></worldbody></mujoco>"#
    )
}

const SEEN: &str = r#"name="seen" type="mesh" mesh="cube" contype="0" conaffinity="0""#;

#[test]
fn what_collides_is_a_hull_and_what_is_seen_a_mesh() {
    let solid = r#"<geom name="solid" type="mesh" mesh="cube" pos="0 0 3"/>"#;
    let text = mjcf(&format!(r#"<geom {SEEN} mass="0"/>{solid}"#));
    let loaded = read(&text, &HULLS).unwrap();
    assert!(is_mesh(shape(&loaded, "seen")));
    let solid = shape(&loaded, "solid");
    let center = DVec3::new(0.0, 0.0, 3.1);
    assert_eq!(hull(solid).vertices().len(), 8);
    assert!((solid.density / 1000.0 - 1.0).abs() < 1e-12);
    assert!(
        solid
            .pose
            .point(hull(solid).center())
            .abs_diff_eq(center, 1e-12)
    );
    // The body weighs what a box of that size does.
    let half = DVec3::new(0.2, 0.1, 0.1);
    let cuboid = MassProperties::of(&Geometry::Box { half }, 1000.0).unwrap();
    let body = &loaded.model.bodies[0];
    assert!((body.mass / cuboid.mass - 1.0).abs() < 1e-12);
    assert!(body.center.abs_diff_eq(center, 1e-12));
    assert!(
        body.inertia
            .abs_diff_eq(cuboid.inertia, 1e-12 * cuboid.mass)
    );
    let warnings: Vec<_> = loaded.warnings.iter().map(ToString::to_string).collect();
    let told = "robot.xml:3: <geom>: mass from a mesh: it is that of its convex hull";
    assert_eq!(warnings, [told]);
}

/// A mesh that is only seen can give a body its mass, and stays a mesh.
#[test]
fn what_is_seen_can_weigh() {
    let text = mjcf(&format!(r#"<geom {SEEN} mass="3"/>"#));
    let loaded = read(&text, &HULLS).unwrap();
    assert!(is_mesh(shape(&loaded, "seen")));
    assert!((loaded.model.bodies[0].mass - 3.0).abs() < 1e-12);
    let refused = read(&text, &Options::default()).unwrap_err().to_string();
    let remedy = "make meshes their convex hulls (--meshes hull)";
    assert!(refused.contains(remedy), "{refused}");
}

#[test]
fn geoms_of_one_mesh_share_its_hull() {
    let geom = r#"<geom type="mesh" mesh="cube"/>"#;
    let loaded = read(&mjcf(&geom.repeat(2)), &HULLS).unwrap();
    let corners = [0, 1].map(|i| hull(&loaded.model.shapes[i]).vertices().as_ptr());
    assert_eq!(corners[0], corners[1]);
}

fn urdf(file: &str) -> String {
    let mesh = format!("<geometry><mesh filename='{file}' scale='.1 .1 .1'/></geometry>");
    format!(
        "<robot name='r'><link name='a'><visual name='seen'>{mesh}</visual>\
         <collision name='solid'>{mesh}</collision></link></robot>"
    )
}

#[test]
fn collision_meshes_of_urdf_are_hulls() {
    for file in ["meshes/cube.obj", "package://robot/cube.obj"] {
        let loaded = read(&urdf(file), &HULLS).unwrap();
        assert!(is_mesh(shape(&loaded, "seen")));
        assert_eq!(hull(shape(&loaded, "solid")).vertices().len(), 8);
        let loaded = read(&urdf(file), &Options::default()).unwrap();
        assert!(is_mesh(shape(&loaded, "solid")));
    }
}

/// A package is a folder above the file.
#[test]
fn packages_are_found_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let package = folder.path().join("arm_description");
    for inside in ["urdf/arms", "meshes"] {
        fs::create_dir_all(package.join(inside)).unwrap();
    }
    fs::write(package.join("meshes/cube.obj"), CUBE).unwrap();
    let robot = package.join("urdf/arms/arm.urdf");
    fs::write(&robot, urdf("package://arm_description/meshes/cube.obj")).unwrap();
    let loaded = kinetarium_formats::load(&robot, &HULLS).unwrap();
    assert_eq!(hull(shape(&loaded, "solid")).vertices().len(), 8);
}

#[test]
fn meshes_that_are_no_hulls_say_where_and_why() {
    let none = "lies in no folder beside this file or above; write its path, relative to this file";
    let cases = [
        (
            "none.obj",
            "the mesh none.obj cannot be read (entity not found); check the path",
        ),
        (
            "meshes/flat.obj",
            "has no convex hull: a convex hull needs 4 points or more, and 3",
        ),
        (
            "meshes/broken.stl",
            "the mesh meshes/broken.stl is broken: ",
        ),
        ("a.dae", "cannot be read"),
        ("package://robot/none.obj", none),
        ("http://robot/cube.obj", none),
    ];
    for (file, message) in cases {
        let error = read(&urdf(file), &HULLS).unwrap_err().to_string();
        let place = error.starts_with("robot.xml:1:") && error.contains("<mesh>: the mesh");
        assert!(place && error.contains(message), "{error}");
    }
    let shell = mjcf(r#"<geom type="mesh" mesh="cube" shellinertia="true"/>"#);
    let error = read(&shell, &HULLS).unwrap_err().to_string();
    assert!(error.contains("mass from the surface of a mesh"), "{error}");
}
