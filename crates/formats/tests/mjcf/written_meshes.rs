//! Meshes whose points are written in the file.

use crate::common::{lenient, lines, read, read_with, refused};
use glam::{DMat3, DVec3};
use kinetarium_formats::{InMemory, Loaded, Meshes, Options, parse};
use model::{Geometry, Shape};

/// A cube of half size 1 about (0, 0, 1), with a pit in its upper face.
const VERTICES: [[i32; 3]; 9] = [
    [-1, -1, 0],
    [1, -1, 0],
    [1, 1, 0],
    [-1, 1, 0],
    [-1, -1, 2],
    [1, -1, 2],
    [1, 1, 2],
    [-1, 1, 2],
    [0, 0, 1],
];
const FACES: [[i32; 3]; 14] = [
    [3, 2, 1],
    [3, 1, 0],
    [0, 1, 5],
    [0, 5, 4],
    [1, 2, 6],
    [1, 6, 5],
    [2, 3, 7],
    [2, 7, 6],
    [3, 0, 4],
    [3, 4, 7],
    [4, 5, 8],
    [5, 6, 8],
    [6, 7, 8],
    [7, 4, 8],
];
const SEEN: &str = r#"contype="0" conaffinity="0" mass="0""#;

fn numbers(rows: &[[i32; 3]]) -> String {
    let words = rows.iter().flatten().map(i32::to_string);
    words.collect::<Vec<_>>().join(" ")
}

/// Vertices and faces as attributes.
fn surface() -> String {
    format!(
        r#"vertex="{}" face="{}""#,
        numbers(&VERTICES),
        numbers(&FACES)
    )
}

/// As a file, whose lines count from 1.
fn obj() -> String {
    let vertices = VERTICES.map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let faces = FACES.map(|face| face.map(|v| v + 1));
    let faces = faces.map(|[a, b, c]| format!("f {a} {b} {c}\n"));
    vertices.concat() + &faces.concat()
}

/// A free body of a mesh that touches, and the same mesh, only seen, in the world.
fn with_mesh(mesh: &str) -> String {
    format!(
        r#"<mujoco><asset><mesh name="m" {mesh}/></asset>
        <worldbody><geom name="seen" type="mesh" mesh="m" {SEEN}/>
        <body><freejoint/><geom name="touches" type="mesh" mesh="m"/></body></worldbody></mujoco>"#
    )
}

fn shape<'a>(loaded: &'a Loaded, name: &str) -> &'a Shape {
    let named = |shape: &&Shape| shape.name == name;
    loaded.model.shapes.iter().find(named).expect("a shape")
}

fn taking(meshes: Meshes) -> Options {
    Options {
        meshes,
        ..Options::default()
    }
}

/// The triangles [nm], whatever their order and first corner: readers of files number anew.
fn faces(shape: &Shape) -> Vec<[[i64; 3]; 3]> {
    let corners: Vec<_> = match &shape.geometry {
        Geometry::Mesh(mesh) => mesh.faces().collect(),
        Geometry::Hull(hull) => hull.faces().collect(),
        other => panic!("{other:?}"),
    };
    let rounded = |corner: DVec3| corner.to_array().map(|x| (1e9 * x).round() as i64);
    let from_least = |face: [DVec3; 3]| {
        let mut face = face.map(rounded);
        let least = (0..3).min_by_key(|i| face[*i]).unwrap_or_default();
        face.rotate_left(least);
        face
    };
    let mut faces: Vec<_> = corners.into_iter().map(from_least).collect();
    faces.sort_unstable();
    faces
}

#[test]
fn what_is_written_is_as_what_is_in_a_file() {
    let obj = obj();
    let files = InMemory::new([("m.obj", obj.as_str())]);
    let turned = r#"scale=".1 .1 .1" refpos="1 2 3" refquat="1 0 0 1""#;
    for frame in [turned, r#"scale="-.1 .2 .3""#] {
        for inertia in ["exact", "legacy", "convex", "shell"] {
            let mesh =
                |source: &str| with_mesh(&format!(r#"{source} {frame} inertia="{inertia}""#));
            let options = taking(Meshes::Exact);
            let file = parse(&mesh(r#"file="m.obj""#), "robot.xml", &files, &options).unwrap();
            let written = read_with(&mesh(&surface()), &options);
            let [one, other] = [&written, &file].map(|loaded| &loaded.model.bodies[0]);
            assert!((one.mass - other.mass).abs() < 1e-12 * other.mass);
            assert!(one.center.abs_diff_eq(other.center, 1e-12));
            assert!(one.inertia.abs_diff_eq(other.inertia, 1e-12 * other.mass));
            let [one, other] = [&written, &file].map(|loaded| shape(loaded, "touches"));
            assert_eq!(one.pose, other.pose);
            assert_eq!(faces(one), faces(other));
            assert_eq!(shape(&written, "seen").pose, shape(&file, "seen").pose);
            assert_eq!(lines(&written.warnings), lines(&file.warnings));
        }
    }
}

/// There is no file that it could be named by.
#[test]
fn what_is_written_is_read_without_being_asked_for() {
    let loaded = read(&with_mesh(&format!(r#"{} scale=".1 .1 .1""#, surface())));
    let Geometry::Mesh(mesh) = &shape(&loaded, "touches").geometry else {
        panic!("a surface")
    };
    assert_eq!(mesh.triangles().len(), 14);
    assert_eq!(
        shape(&loaded, "seen").geometry,
        Geometry::Mesh(mesh.clone())
    );
    let hull = read_with(&with_mesh(&surface()), &taking(Meshes::ConvexHull));
    let corners = |shape: &Shape| match &shape.geometry {
        Geometry::Hull(hull) => hull.vertices().len(),
        _ => 0,
    };
    assert_eq!(corners(shape(&hull, "touches")), 8);
    assert_eq!(corners(shape(&hull, "seen")), 0);
}

/// Mass, centre and moments of MuJoCo 4.0.
#[test]
fn points_without_faces_are_their_convex_hull() {
    for (inertia, mass, moment) in [
        ("legacy", 8.0, 0.053_333_333_3),
        ("exact", 8.0, 0.053_333_333_3),
        ("convex", 8.0, 0.053_333_333_3),
        ("shell", 240.0, 2.666_666_666_7),
    ] {
        for meshes in [Meshes::Named, Meshes::Exact, Meshes::ConvexHull] {
            let points = numbers(&VERTICES);
            let mesh = format!(r#"vertex="{points}" scale=".1 .1 .1" inertia="{inertia}""#);
            let loaded = read_with(&with_mesh(&mesh), &taking(meshes));
            let body = &loaded.model.bodies[0];
            assert!((body.mass - mass).abs() < 1e-9, "{inertia}: {body:?}");
            assert!(body.center.abs_diff_eq(DVec3::new(0.0, 0.0, 0.1), 1e-12));
            let expected = DMat3::from_diagonal(DVec3::splat(moment));
            assert!(body.inertia.abs_diff_eq(expected, 1e-9), "{body:?}");
            for name in ["touches", "seen"] {
                let solid = &shape(&loaded, name).geometry;
                assert!(matches!(solid, Geometry::Hull(hull) if hull.vertices().len() == 8));
            }
        }
    }
}

/// That needs no feature, nor the minutes that it may take: what is seen or weighed alone, and what others are fitted to.
#[test]
fn what_does_not_touch_stays_whole() {
    let surface = surface();
    let text = format!(
        r#"<mujoco><asset><mesh name="m" {surface}/></asset>
        <worldbody><geom name="seen" type="mesh" mesh="m" {SEEN}/>
        <body><freejoint/><geom name="fitted" type="box" mesh="m"/>
        <geom name="weighed" type="mesh" mesh="m" contype="0" conaffinity="0"/></body></worldbody></mujoco>"#
    );
    let loaded = read_with(&text, &taking(Meshes::Pieces));
    let fitted = &shape(&loaded, "fitted").geometry;
    assert!(matches!(fitted, Geometry::Box { .. }), "{fitted:?}");
    for name in ["seen", "weighed"] {
        let whole = &shape(&loaded, name).geometry;
        assert!(matches!(whole, Geometry::Mesh(_)), "{whole:?}");
    }
}

#[cfg(feature = "decomposition")]
#[test]
fn what_is_written_and_touches_comes_apart() {
    let mesh = format!(r#"{} scale=".1 .1 .1""#, surface());
    let loaded = read_with(&with_mesh(&mesh), &taking(Meshes::Pieces));
    assert!(matches!(shape(&loaded, "seen").geometry, Geometry::Mesh(_)));
    let touching = loaded.model.shapes.iter().filter(|shape| shape.collides);
    let pieces: Vec<_> = touching.map(|shape| &shape.geometry).collect();
    assert!(pieces.len() > 1);
    assert!(
        pieces
            .iter()
            .all(|solid| matches!(solid, Geometry::Hull(_)))
    );
}

#[test]
fn normals_and_texture_coordinates_are_noted() {
    let mesh = format!(r#"{} normal="0 0 1" texcoord="0 0""#, surface());
    let told = lines(&read(&with_mesh(&mesh)).warnings);
    let of_mesh: Vec<_> = told.iter().filter(|line| line.contains("<mesh>")).collect();
    let expected = [
        "robot.xml:1: <mesh>: attribute `normal`: only seen; not read",
        "robot.xml:1: <mesh>: attribute `texcoord`: only seen; not read",
    ];
    assert_eq!(of_mesh, expected);
}

#[test]
fn meshes_that_are_none_say_why() {
    let points = r#"vertex="0 0 0 1 0 0 0 1 0 0 0 1""#;
    for (mesh, told) in [
        (
            "",
            "robot.xml:1:16: <mesh>: it has no points; write `file` or `vertex`",
        ),
        (
            r#"vertex="0 0 0 1""#,
            "<mesh>: attribute `vertex` holds 4 numbers; write three for each",
        ),
        (
            r#"vertex="0 0 0 1 0 0 0 1 0""#,
            "<mesh>: a convex hull needs 4 points or more, and 3 different ones were given",
        ),
        (
            &format!(r#"{points} face="0 1 4""#),
            "<mesh>: triangle 0 of the mesh has the vertex 4, but there are 4, counted from 0",
        ),
        (
            &format!(r#"{points} face="0 1""#),
            "<mesh>: attribute `face` holds 2 numbers; write at least 3, separated by blanks",
        ),
        (
            &format!(r#"{points} face="0 1 2.5""#),
            "<mesh>: attribute `face` holds 2.5, which numbers no vertex; count the vertices from 0",
        ),
        (
            &format!(r#"{points} file="m.obj""#),
            "<mesh>: attribute `vertex` stands beside `file`; keep one of them",
        ),
    ] {
        let error = refused(&with_mesh(mesh));
        assert!(
            error.starts_with("robot.xml:1:") && error.contains(told),
            "{error}"
        );
    }
}

/// Where it is used: a mesh that nothing uses does nothing.
#[test]
fn built_in_meshes_are_refused_by_name() {
    let text = with_mesh(r#"builtin="supersphere" params="9 1 1""#);
    let told = "robot.xml:2:20: <geom>: the built-in mesh `supersphere` is not supported";
    assert!(refused(&text).starts_with(told), "{}", refused(&text));
    assert!(
        lenient(&text.replace("<freejoint/>", "<geom size='1'/>"))
            .model
            .shapes
            .len()
            == 1
    );
    let unused = r#"<mujoco><asset><mesh name="m" builtin="sphere" params="1"/></asset></mujoco>"#;
    assert_eq!(lines(&read(unused).warnings), [""; 0]);
}
