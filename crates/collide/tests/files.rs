//! Meshes from files, and hulls of points: what is read, and what is said of what cannot be.

use fastrand::Rng;
use glam::{DVec2, DVec3};
use kinetarium_collide::mesh::{self, LoadError};
use kinetarium_collide::{Form, kind};
use model::{DistanceFieldError, Geometry, HeightFieldError, Hull, MeshError, Pose, TriangleMesh};
use std::path::PathBuf;
use tempfile::TempDir;

const CORNERS: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
];
const FACES: [[u8; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

fn obj() -> Vec<u8> {
    let vertex = |c: [f32; 3]| format!("v {} {} {}\n", c[0], c[1], c[2]);
    let face = |f: [u8; 3]| format!("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
    let text = CORNERS.map(vertex).concat() + &FACES.map(face).concat();
    text.into_bytes()
}

fn text_stl() -> Vec<u8> {
    let face = |f: [u8; 3]| {
        let vertex = |v: u8| {
            let c = CORNERS[v as usize];
            format!("vertex {} {} {}\n", c[0], c[1], c[2])
        };
        let vertices = f.map(vertex).concat();
        format!("facet normal 0 0 1\nouter loop\n{vertices}endloop\nendfacet\n")
    };
    format!("solid t\n{}endsolid t\n", FACES.map(face).concat()).into_bytes()
}

fn binary_stl() -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((FACES.len() as u32).to_le_bytes());
    for face in FACES {
        bytes.extend([0.0f32; 3].iter().flat_map(|x| x.to_le_bytes()));
        let corners = face.map(|v| CORNERS[v as usize]);
        bytes.extend(corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0, 0]);
    }
    bytes
}

/// A node moved by 10 m along x, of which a mesh hangs on its child.
fn glb() -> Vec<u8> {
    let mut data: Vec<u8> = CORNERS
        .as_flattened()
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    data.extend(FACES.as_flattened());
    let json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
        "nodes":[{"children":[1],"translation":[10,0,0]},{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
        "buffers":[{"byteLength":60}],
        "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},
        {"bufferView":1,"componentType":5121,"count":12,"type":"SCALAR"}]}"#;
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() + 8 + data.len();
    let word = |n: usize| (n as u32).to_le_bytes();
    [
        b"glTF".as_slice(),
        &word(2),
        &word(length),
        &word(json.len()),
        b"JSON",
        &json,
        &word(data.len()),
        b"BIN\0",
        &data,
    ]
    .concat()
}

/// Loads bytes as a file of this name.
fn load(name: &str, bytes: &[u8], scale: DVec3) -> Result<TriangleMesh, LoadError> {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    mesh::load(path, scale)
}

/// Six times the volume inside, positive where triangles face out.
fn volume(mesh: &TriangleMesh) -> f64 {
    let of = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.vertices()[v as usize]);
        a.dot(b.cross(c))
    };
    mesh.triangles().iter().map(of).sum()
}

#[test]
fn a_tetrahedron_of_every_format() {
    let files = [
        ("a.obj", obj()),
        ("a.stl", text_stl()),
        ("b.STL", binary_stl()),
        ("a.glb", glb()),
    ];
    for (name, bytes) in files {
        let mesh = load(name, &bytes, DVec3::new(2.0, 1.0, 1.0)).unwrap();
        assert_eq!(
            (mesh.vertices().len(), mesh.triangles().len()),
            (4, 4),
            "{name}"
        );
        assert!((volume(&mesh) - 2.0).abs() < 1e-6, "{name}");
        let moved = if name == "a.glb" { 20.0 } else { 0.0 };
        let least = mesh.vertices().iter().map(|v| v.x).fold(f64::MAX, f64::min);
        assert_eq!(least, moved, "{name}");
        let mirrored = load(name, &bytes, DVec3::new(-1.0, 1.0, 1.0)).unwrap();
        assert!((volume(&mirrored) - 1.0).abs() < 1e-6, "{name}");
    }
}

#[test]
fn broken_files_say_where_and_what() {
    let one = DVec3::ONE;
    let unknown = load("a.step", b"", one).unwrap_err();
    assert!(matches!(unknown, LoadError::Unknown { .. }));
    assert!(
        unknown.to_string().contains(".obj, .stl or .glb"),
        "{unknown}"
    );
    let missing = mesh::load(PathBuf::from("nowhere/a.obj"), one).unwrap_err();
    assert!(matches!(missing, LoadError::Read { .. }), "{missing}");
    for (name, bytes) in [("a.stl", binary_stl()), ("a.glb", glb())] {
        let short = load(name, &bytes[..bytes.len() - 3], one).unwrap_err();
        assert!(short.to_string().contains(name), "{short}");
    }
    let not_finite = load("a.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", one).unwrap_err();
    assert!(not_finite.to_string().contains("a.obj"), "{not_finite}");
    let empty = load("a.obj", b"", one).unwrap_err();
    assert!(empty.to_string().contains("no triangles"), "{empty}");
    let no_such = load("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", one).unwrap_err();
    assert!(no_such.to_string().contains("a.obj"), "{no_such}");
}

/// No file makes the program stop: cut anywhere, or with bytes changed.
#[test]
fn damaged_files_do_not_panic() {
    let mut rng = Rng::with_seed(31);
    for (name, bytes) in [
        ("a.obj", obj()),
        ("a.stl", text_stl()),
        ("b.stl", binary_stl()),
        ("a.glb", glb()),
    ] {
        for length in (0..bytes.len()).step_by(7) {
            let _ = load(name, &bytes[..length], DVec3::ONE);
        }
        for _ in 0..500 {
            let mut damaged = bytes.clone();
            for _ in 0..1 + rng.usize(0..4) {
                let at = rng.usize(0..damaged.len());
                damaged[at] = if rng.bool() {
                    b'0' + rng.u8(..10)
                } else {
                    rng.u8(..)
                };
            }
            let _ = load(name, &damaged, DVec3::ONE);
        }
    }
}

#[test]
fn meshes_without_a_surface() {
    let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::NAN];
    let not_finite = TriangleMesh::new(&points, &[[0, 1, 2]]).unwrap_err();
    assert!(matches!(not_finite, MeshError::NotFinite { vertex: 3, .. }));
    let far = [DVec3::ZERO, DVec3::X, 2e9 * DVec3::Y];
    let far = TriangleMesh::new(&far, &[[0, 1, 2]]).unwrap_err();
    assert!(matches!(far, MeshError::TooFar { vertex: 2, .. }));
    let no_such = TriangleMesh::new(&points[..3], &[[0, 1, 2], [0, 1, 3]]).unwrap_err();
    assert!(matches!(
        no_such,
        MeshError::NoSuchVertex {
            triangle: 1,
            vertex: 3,
            vertices: 3
        }
    ));
    assert_eq!(TriangleMesh::new(&points[..3], &[]), Err(MeshError::Empty));
    let flat = TriangleMesh::new(&points[..3], &[[0, 1, 1]]);
    assert_eq!(flat, Err(MeshError::NoArea { triangles: 1 }));

    let field = |heights: &[&[f64]], spacing| {
        let heights: Vec<_> = heights.iter().map(|r| r.to_vec()).collect();
        TriangleMesh::height_field(&heights, DVec2::splat(spacing)).unwrap_err()
    };
    assert_eq!(
        field(&[&[0.0, 0.0]], 1.0),
        HeightFieldError::TooSmall {
            rows: 1,
            columns: 2
        }
    );
    assert_eq!(
        field(&[&[0.0, 0.0], &[0.0]], 1.0),
        HeightFieldError::Ragged {
            row: 1,
            found: 1,
            columns: 2
        }
    );
    assert_eq!(
        field(&[&[0.0, 0.0], &[0.0, 0.0]], -1.0),
        HeightFieldError::Spacing(DVec2::splat(-1.0))
    );
    let hole = field(&[&[0.0, f64::INFINITY], &[0.0, 0.0]], 1.0);
    assert!(matches!(
        hole,
        HeightFieldError::Mesh(MeshError::NotFinite { vertex: 1, .. })
    ));
}

/// The hull of an L is no L.
#[test]
fn hulls_fill_what_is_hollow() {
    let outline = [
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
    ];
    let vertices: Vec<_> = [0.0, 1.0]
        .into_iter()
        .flat_map(|z| outline.map(|[x, y]| DVec3::new(x, y, z)))
        .collect();
    let mut triangles = vec![[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 5, 4]];
    triangles.extend([[6, 7, 8], [6, 8, 9], [6, 9, 10], [6, 10, 11]]);
    for i in 0..6 {
        let j = (i + 1) % 6;
        triangles.extend([[i, j, j + 6], [i, j + 6, i + 6]]);
    }
    let mesh = TriangleMesh::new(&vertices, &triangles).unwrap();
    let volume_of =
        |hull: &Hull| volume(&TriangleMesh::new(hull.vertices(), hull.triangles()).unwrap()) / 6.0;
    let filled = volume_of(&mesh.convex_hull().unwrap());
    assert!((filled - 3.5).abs() < 1e-9, "{filled}");
}

/// The samples of a field.
fn samples(n: usize, spacing: f64, distance: impl Fn(DVec3) -> f64) -> Vec<f64> {
    let at = |i: usize| (i as f64 - (n - 1) as f64 / 2.0) * spacing;
    (0..n * n * n)
        .map(|i| distance(DVec3::new(at(i % n), at(i / n % n), at(i / n / n))))
        .collect()
}

/// The surface of a ball's field is closed, faces out, and is where the ball is.
#[test]
fn the_surface_of_a_distance_field() {
    let (n, spacing, radius) = (21, 0.1, 0.83);
    let field = samples(n, spacing, |p| p.length() - radius);
    let mesh = TriangleMesh::distance_field([n; 3], spacing, &field).unwrap();
    for v in mesh.vertices() {
        assert!((v.length() - radius).abs() < 0.02 * radius, "{v}");
    }
    let ball = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
    assert!(
        (volume(&mesh) / 6.0 / ball - 1.0).abs() < 0.02,
        "{}",
        volume(&mesh) / 6.0
    );
    // Each edge is walked once each way.
    let edges = mesh
        .triangles()
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let edges: Vec<_> = edges.collect();
    let known: std::collections::HashSet<_> = edges.iter().collect();
    assert_eq!(known.len(), edges.len());
    assert!(edges.iter().all(|&(a, b)| known.contains(&(b, a))));
}

#[test]
fn samples_that_are_no_distance_field() {
    let field = |counts, spacing, distances: &[f64]| {
        TriangleMesh::distance_field(counts, spacing, distances).unwrap_err()
    };
    let few = field([2, 2, 1], 1.0, &[0.0; 4]);
    assert_eq!(
        few,
        DistanceFieldError::Counts {
            counts: [2, 2, 1],
            found: 4
        }
    );
    assert!(few.to_string().contains("2 × 2 × 1"), "{few}");
    assert_eq!(
        field([2; 3], 0.0, &[0.0; 8]),
        DistanceFieldError::Spacing(0.0)
    );
    let hole = field(
        [2; 3],
        1.0,
        &[0.0, 1.0, 2.0, f64::INFINITY, 0.0, 0.0, 0.0, 0.0],
    );
    assert_eq!(
        hole,
        DistanceFieldError::NotFinite {
            index: 3,
            value: f64::INFINITY
        }
    );
    let outside = field([2; 3], 1.0, &[1.0; 8]);
    assert_eq!(outside, DistanceFieldError::Mesh(MeshError::Empty));
}

/// Every geometry of a model but a mesh has a form, and keeps its sizes.
#[test]
fn forms_of_geometries() {
    let half = DVec3::new(1.0, 2.0, 3.0);
    let (radius, half_height) = (0.5, 2.0);
    let forms = [
        (
            Geometry::Plane {
                half_x: 1.0,
                half_z: 0.0,
            },
            kind::PLANE,
            DVec3::ZERO,
        ),
        (Geometry::Sphere { radius }, kind::SPHERE, DVec3::splat(0.5)),
        (
            Geometry::Capsule {
                radius,
                half_height,
            },
            kind::CAPSULE,
            DVec3::new(0.5, 2.0, 0.5),
        ),
        (
            Geometry::Cylinder {
                radius,
                half_height,
            },
            kind::CYLINDER,
            DVec3::new(0.5, 2.0, 0.5),
        ),
        (
            Geometry::Cone {
                radius,
                half_height,
            },
            kind::CONE,
            DVec3::new(0.5, 2.0, 0.5),
        ),
        (Geometry::Box { half }, kind::BOX, half),
        (Geometry::Ellipsoid { half }, kind::ELLIPSOID, half),
    ];
    for (geometry, kind, size) in forms {
        let form = Form::of(&geometry).unwrap();
        assert_eq!(
            (form.kind, form.size, form.pose),
            (kind, size, Pose::IDENTITY)
        );
    }
    let file = "a.obj".to_owned();
    assert_eq!(Form::of(&Geometry::MeshFile { file, scale: half }), None);

    let finite = Form::finite_plane(2.0, 1.0);
    let top = finite.pose.point(DVec3::new(2.0, finite.size.y, 1.0));
    assert_eq!((finite.kind, top), (kind::BOX, DVec3::new(2.0, 0.0, 1.0)));

    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p + half);
    let hull = Hull::new(&corners).unwrap();
    let form = Form::of(&Geometry::Hull(hull)).unwrap();
    assert_eq!((form.kind, form.size), (kind::HULL, DVec3::splat(0.75)));
    let middle = half + DVec3::splat(0.25);
    assert!(form.pose.position.abs_diff_eq(middle, 1e-15));

    let mesh = TriangleMesh::new(&corners, &[[0, 1, 2]]).unwrap();
    let form = Form::of(&Geometry::Mesh(mesh)).unwrap();
    let flat = DVec3::new(0.5, 0.5, 0.0);
    assert_eq!((form.kind, form.size), (kind::MESH, flat));
    assert_eq!(form.pose, Pose::at(half + flat));
}
