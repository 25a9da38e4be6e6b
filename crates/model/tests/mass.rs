//! Mass properties against quadrature, and the algebra of putting solids together.

use approx::assert_relative_eq;
use glam::{DMat3, DQuat, DVec3};
use kinetarium_model::{Geometry, Hull, MassProperties, Pose, Shape, TriangleMesh};
use proptest::prelude::*;
use std::f64::consts::PI;

/// A slice of a solid at height y: area, ∫x² and ∫z² over it.
struct Slice {
    area: f64,
    xx: f64,
    zz: f64,
}

fn ellipse(a: f64, c: f64) -> Slice {
    Slice {
        area: PI * a * c,
        xx: PI * a * a * a * c / 4.0,
        zz: PI * a * c * c * c / 4.0,
    }
}

fn rectangle(a: f64, c: f64) -> Slice {
    Slice {
        area: 4.0 * a * c,
        xx: 4.0 / 3.0 * a * a * a * c,
        zz: 4.0 / 3.0 * a * c * c * c,
    }
}

fn slice(geometry: &Geometry, y: f64) -> Slice {
    let disc = |r: f64| ellipse(r, r);
    match *geometry {
        Geometry::Sphere { radius } => disc((radius * radius - y * y).sqrt()),
        Geometry::Ellipsoid { half } => {
            let shrink = (1.0 - (y / half.y).powi(2)).sqrt();
            ellipse(half.x * shrink, half.z * shrink)
        }
        Geometry::Box { half } => rectangle(half.x, half.z),
        Geometry::Cylinder { radius, .. } => disc(radius),
        Geometry::Cone {
            radius,
            half_height,
        } => disc(radius * (half_height - y) / (2.0 * half_height)),
        Geometry::Capsule {
            radius,
            half_height,
        } => {
            let into_cap = (y.abs() - (half_height - radius)).max(0.0);
            disc((radius * radius - into_cap * into_cap).sqrt())
        }
        Geometry::Plane { .. }
        | Geometry::Hull(_)
        | Geometry::Mesh(_)
        | Geometry::MeshFile { .. } => {
            unreachable!("not solids of revolution or boxes")
        }
    }
}

/// Midpoint rule over slices; inertia about the centre of mass.
fn by_quadrature(geometry: &Geometry, top: f64, density: f64) -> MassProperties {
    let n = 200_000;
    let dy = 2.0 * top / f64::from(n);
    let (mut mass, mut y1, mut xx, mut yy, mut zz) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for i in 0..n {
        let y = -top + (f64::from(i) + 0.5) * dy;
        let s = slice(geometry, y);
        mass += density * s.area * dy;
        y1 += density * s.area * y * dy;
        yy += density * s.area * y * y * dy;
        xx += density * s.xx * dy;
        zz += density * s.zz * dy;
    }
    let center = y1 / mass;
    yy -= mass * center * center;
    MassProperties {
        mass,
        center: DVec3::new(0.0, center, 0.0),
        inertia: DMat3::from_diagonal(DVec3::new(yy + zz, zz + xx, xx + yy)),
    }
}

fn assert_alike(a: &MassProperties, b: &MassProperties, tolerance: f64) {
    assert_relative_eq!(a.mass, b.mass, max_relative = tolerance);
    assert!(
        a.center.abs_diff_eq(b.center, tolerance),
        "{} against {}",
        a.center,
        b.center
    );
    let scale = b
        .inertia
        .to_cols_array()
        .iter()
        .fold(0.0, |m: f64, x| m.max(x.abs()));
    assert!(
        a.inertia.abs_diff_eq(b.inertia, tolerance * scale),
        "{} against {}",
        a.inertia,
        b.inertia
    );
}

#[test]
fn closed_forms_equal_quadrature() {
    let solids = [
        (Geometry::Sphere { radius: 0.7 }, 0.7),
        (
            Geometry::Ellipsoid {
                half: DVec3::new(0.3, 0.8, 1.2),
            },
            0.8,
        ),
        (
            Geometry::Box {
                half: DVec3::new(0.3, 0.8, 1.2),
            },
            0.8,
        ),
        (
            Geometry::Cylinder {
                radius: 0.4,
                half_height: 1.1,
            },
            1.1,
        ),
        (
            Geometry::Cone {
                radius: 0.4,
                half_height: 1.1,
            },
            1.1,
        ),
        (
            Geometry::Capsule {
                radius: 0.4,
                half_height: 1.1,
            },
            1.1,
        ),
        (
            Geometry::Capsule {
                radius: 1.0,
                half_height: 1.01,
            },
            1.01,
        ),
    ];
    for (geometry, top) in solids {
        let exact = MassProperties::of(&geometry, 3.0).unwrap();
        assert_alike(&exact, &by_quadrature(&geometry, top, 3.0), 1e-7);
    }
}

/// The corners of a box are a box, wherever they lie.
#[test]
fn a_hull_in_the_form_of_a_box_weighs_what_the_box_does() {
    let (half, middle) = (DVec3::new(0.3, 0.8, 1.2), DVec3::new(5.0, -2.0, 0.1));
    let turn = DQuat::from_scaled_axis(DVec3::new(0.3, -1.1, 0.4));
    let place = Pose::new(middle, turn);
    let side = |i: u32, bit: u32| f64::from((i >> bit & 1) * 2) - 1.0;
    let corner = |i| place.point(half * DVec3::new(side(i, 0), side(i, 1), side(i, 2)));
    let corners: Vec<_> = (0..8).map(corner).collect();
    let hull = MassProperties::of(&Geometry::Hull(Hull::new(&corners).unwrap()), 3.0).unwrap();
    let cuboid = MassProperties::of(&Geometry::Box { half }, 3.0).unwrap();
    assert_alike(&hull, &cuboid.placed(&place), 1e-13);
}

/// The tetrahedron (0, a, b, c) along the axes: m = ρ abc/6, centre (a, b, c)/4, and about the origin
/// ∫x² dm = m a²/10, ∫xy dm = m ab/20.
#[test]
fn a_tetrahedron_weighs_a_sixth_of_its_box() {
    let (size, density) = (DVec3::new(2.0, 3.0, 5.0), 7.0);
    let [x, y, z] = DVec3::AXES.map(|axis| axis * size);
    let hull = Hull::new(&[DVec3::ZERO, x, y, z]).unwrap();
    let found = MassProperties::of(&Geometry::Hull(hull), density).unwrap();
    let m = density * size.element_product() / 6.0;
    let squares = size * size * m / 10.0;
    let products = -size * DVec3::new(size.y, size.z, size.x) * m / 20.0;
    let [xy, yz, zx] = products.to_array();
    let about_origin = DMat3::from_cols(
        DVec3::new(squares.y + squares.z, xy, zx),
        DVec3::new(xy, squares.z + squares.x, yz),
        DVec3::new(zx, yz, squares.x + squares.y),
    );
    assert_relative_eq!(found.mass, m, max_relative = 1e-14);
    assert!(found.center.abs_diff_eq(size / 4.0, 1e-14));
    let there = found.inertia_about(DVec3::ZERO);
    assert!(there.abs_diff_eq(about_origin, 1e-12 * m), "{there}");
}

/// A closed surface holds what is in it, cavities left out; one that is open or inside out, nothing.
#[test]
fn closed_meshes_have_the_mass_of_what_they_hold() {
    let corner = |half: f64, at: DVec3| {
        move |i: u32| {
            at + half * DVec3::from_array([i, i >> 1, i >> 2].map(|b| f64::from(b & 1) * 2.0 - 1.0))
        }
    };
    let hull = |half: f64, at: DVec3| {
        Hull::new(&(0..8).map(corner(half, at)).collect::<Vec<_>>()).unwrap()
    };
    let (at, hole) = (DVec3::new(3.0, -1.0, 2.0), DVec3::new(3.2, -0.9, 2.1));
    let (outer, inner) = (hull(1.0, at), hull(0.5, hole));
    let turned = |t: &[u32; 3]| [t[0], t[2], t[1]];
    let mesh = |vertices: &[DVec3], triangles: &[[u32; 3]]| {
        Geometry::Mesh(TriangleMesh::new(vertices, triangles).unwrap())
    };
    let full = mesh(outer.vertices(), outer.triangles());
    let expected = MassProperties::of(&Geometry::Hull(outer.clone()), 700.0).unwrap();
    assert_alike(&MassProperties::of(&full, 700.0).unwrap(), &expected, 1e-12);

    let count = outer.vertices().len() as u32;
    let cavity = inner
        .triangles()
        .iter()
        .map(|t| turned(t).map(|v| v + count));
    let hollow = mesh(
        &[outer.vertices(), inner.vertices()].concat(),
        &outer
            .triangles()
            .iter()
            .copied()
            .chain(cavity)
            .collect::<Vec<_>>(),
    );
    let taken = MassProperties::of(&Geometry::Hull(inner), -700.0).unwrap();
    assert_alike(
        &MassProperties::of(&hollow, 700.0).unwrap(),
        &expected.and(&taken),
        1e-12,
    );

    let all = outer.triangles();
    let inside_out: Vec<_> = all.iter().map(turned).collect();
    for triangles in [&all[1..], &inside_out] {
        assert_eq!(
            MassProperties::of(&mesh(outer.vertices(), triangles), 1.0),
            None
        );
    }
}

#[test]
fn planes_and_open_meshes_have_no_mass_of_their_own() {
    let plane = Geometry::Plane {
        half_x: 1.0,
        half_z: 1.0,
    };
    let mesh = Geometry::MeshFile {
        file: "bunny.stl".into(),
        scale: DVec3::ONE,
    };
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let surface = TriangleMesh::new(&corners, &[[0, 1, 2]]).unwrap();
    assert_eq!(MassProperties::of(&Geometry::Mesh(surface), 1.0), None);
    assert_eq!(MassProperties::of(&plane, 1.0), None);
    assert_eq!(MassProperties::of(&mesh, 1.0), None);
    assert_eq!(
        MassProperties::of_shapes(&[Shape::new(plane), Shape::new(mesh)]),
        None
    );
}

/// A point turns without inertia, and masses on a line do about it; three in a triangle do not.
#[test]
fn points_and_lines_cannot_move_alone() {
    let point = |center: DVec3| MassProperties {
        mass: 2.0,
        center,
        inertia: DMat3::ZERO,
    };
    let [a, b, c] = [DVec3::ZERO, DVec3::ONE, DVec3::X].map(point);
    let line = a.and(&b);
    assert!(!a.is_definite() && !line.is_definite());
    assert!(line.and(&c).is_definite());
    let nothing = MassProperties {
        mass: 0.0,
        ..line.and(&c)
    };
    assert!(!nothing.is_definite());
}

#[test]
fn open_edges_are_where_a_surface_ends() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let closed = TriangleMesh::new(&corners, &faces).unwrap();
    assert!(closed.is_closed() && closed.open_edges().is_empty());
    let open = TriangleMesh::new(&corners, &faces[..3]).unwrap();
    let [x, y, z] = DVec3::AXES;
    assert_eq!(open.open_edges(), [[x, y], [x, z], [y, z]]);
}

#[test]
fn weightless_shapes_do_not_count() {
    let ball = Shape::new(Geometry::Sphere { radius: 1.0 });
    let ghost = ball.clone().at(Pose::at(DVec3::X)).with_density(0.0);
    let alone = MassProperties::of_shapes([&ball]);
    assert_eq!(MassProperties::of_shapes([&ghost, &ball, &ghost]), alone);
    assert_eq!(MassProperties::of_shapes([&ghost]), None);
}

#[test]
fn another_mass_scales_the_inertia() {
    let ball = MassProperties::of(&Geometry::Sphere { radius: 2.0 }, 1.0)
        .unwrap()
        .with_mass(5.0);
    assert_eq!(ball.mass, 5.0);
    assert_relative_eq!(ball.inertia.x_axis.x, 0.4 * 5.0 * 4.0, max_relative = 1e-14);
}

#[test]
fn a_diagonal_inertia_is_its_own_principal_frame() {
    let moments = DVec3::new(3.0, 1.0, 2.5);
    let inertia = DMat3::from_diagonal(moments);
    let solid = MassProperties {
        mass: 1.0,
        center: DVec3::ZERO,
        inertia,
    };
    assert_eq!(solid.principal(), (moments, DQuat::IDENTITY));
}

fn vector(range: std::ops::Range<f64>) -> impl Strategy<Value = DVec3> {
    (range.clone(), range.clone(), range).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

fn rotation() -> impl Strategy<Value = DQuat> {
    vector(-3.0..3.0).prop_map(DQuat::from_scaled_axis)
}

proptest! {
    #[test]
    fn a_cut_box_put_together_is_the_box(
        half in vector(0.1..2.0),
        at in vector(-5.0..5.0),
        turn in rotation(),
        cut in -0.9..0.9_f64,
    ) {
        let pose = Pose::new(at, turn);
        let whole = Shape::new(Geometry::Box { half }).at(pose);
        let piece = |from: f64, to: f64| {
            let half = DVec3::new((to - from) / 2.0, half.y, half.z);
            let offset = Pose::at(DVec3::new((from + to) / 2.0, 0.0, 0.0));
            Shape::new(Geometry::Box { half }).at(pose * offset)
        };
        let pieces = [piece(-half.x, cut * half.x), piece(cut * half.x, half.x)];
        let together = MassProperties::of_shapes(&pieces).unwrap();
        assert_alike(&together, &MassProperties::of_shapes([&whole]).unwrap(), 1e-11);
    }

    #[test]
    fn principal_axes_rebuild_the_inertia(moments in vector(1e-3..10.0), turn in rotation()) {
        let r = DMat3::from_quat(turn);
        let inertia = r * DMat3::from_diagonal(moments) * r.transpose();
        let solid = MassProperties { mass: 1.0, center: DVec3::ZERO, inertia };
        let (found, axes) = solid.principal();
        let axes = DMat3::from_quat(axes);
        let rebuilt = axes * DMat3::from_diagonal(found) * axes.transpose();
        prop_assert!(rebuilt.abs_diff_eq(inertia, 1e-13 * moments.max_element().max(1.0) * 10.0));
        let sorted = |v: DVec3| { let mut a = v.to_array(); a.sort_by(f64::total_cmp); a };
        for (a, b) in sorted(found).into_iter().zip(sorted(moments)) {
            prop_assert!((a - b).abs() < 1e-13 * moments.max_element());
        }
    }

    #[test]
    fn turning_a_solid_keeps_its_principal_moments(half in vector(0.1..2.0), turn in rotation()) {
        let solid = MassProperties::of(&Geometry::Ellipsoid { half }, 1.0).unwrap();
        let turned = solid.placed(&Pose::new(DVec3::ONE, turn));
        let trace = |m: &MassProperties| m.principal().0.element_sum();
        prop_assert!((trace(&solid) - trace(&turned)).abs() < 1e-12 * trace(&solid));
        let determinant = |m: &MassProperties| m.inertia.determinant();
        prop_assert!((determinant(&solid) / determinant(&turned) - 1.0).abs() < 1e-10);
    }
}
