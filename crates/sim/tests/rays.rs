//! What rays meet: closed forms, a march through the solids, and one ray against many.

mod solids;

use fastrand::Rng;
use glam::{DMat3, DVec2, DVec3};
use kinetarium_sim::{Ray, RayHit, Simulation, SimulationError, SimulationSettings, SolverKind};
use model::examples::square_pyramid;
use model::{Builder, Geometry, Hull, Pose, Shape, ShapeId, TriangleMesh};
use solids::{
    BOX, CAPSULE, CONE, CYLINDER, ELLIPSOID, PLANE, level, scenery, simulate, somewhere, within,
};
use std::f64::consts::SQRT_2;

const SPHERE: Geometry = Geometry::Sphere { radius: 0.5 };

/// Seven corners about a point beside the origin, which is inside.
fn hull() -> Geometry {
    let corners = [
        [1.2, 0.1, 0.2],
        [-0.7, 0.0, 0.3],
        [0.2, 1.5, -0.1],
        [0.1, -0.9, 0.2],
        [0.4, 0.2, 1.1],
        [0.3, 0.1, -0.8],
        [0.9, 0.8, 0.7],
    ];
    Geometry::Hull(Hull::new(&corners.map(DVec3::from)).unwrap())
}

fn one(geometry: Geometry, pose: Pose) -> Simulation<f64> {
    simulate(scenery([Shape::new(geometry).at(pose)]))
}

/// In the solid's own frame: origin, direction; distance, normal.
type Case = (Geometry, DVec3, DVec3, Option<(f64, DVec3)>);

#[test]
fn closed_forms() {
    let v = DVec3::new;
    let (x, y) = (DVec3::X, DVec3::Y);
    let cases: &[Case] = &[
        (
            PLANE,
            v(0.0, 2.0, 0.0),
            v(1.0, -1.0, 0.0),
            Some((2.0 * SQRT_2, y)),
        ),
        (PLANE, v(0.0, 2.0, 0.0), v(1.0, 0.1, 0.0), None),
        (PLANE, v(0.0, 2.0, 0.0), x, None),
        (SPHERE, v(3.0, 0.3, 0.0), -x, Some((2.6, v(0.8, 0.6, 0.0)))),
        (SPHERE, v(3.0, 0.51, 0.0), -x, None),
        (SPHERE, v(3.0, 0.3, 0.0), x, None),
        (CAPSULE, v(3.0, 0.7, 0.0), -x, Some((2.5, x))),
        (CAPSULE, v(0.3, 5.0, 0.0), -y, Some((3.6, v(0.6, 0.8, 0.0)))),
        (CAPSULE, v(0.0, -5.0, 0.0), y, Some((3.5, -y))),
        (CAPSULE, v(0.4, 3.0, 0.4), -y, None),
        (
            CYLINDER,
            v(3.0, 0.7, 0.3),
            -x,
            Some((2.6, v(0.8, 0.0, 0.6))),
        ),
        (CYLINDER, v(0.2, 4.0, 0.0), -y, Some((3.0, y))),
        (CYLINDER, v(0.2, -4.0, 0.0), y, Some((3.0, -y))),
        (CYLINDER, v(0.6, 4.0, 0.0), -y, None),
        (CYLINDER, v(3.0, 1.01, 0.0), -x, None),
        (CONE, v(3.0, 0.0, 0.0), -x, Some((2.5, v(1.0, 0.5, 0.0)))),
        (CONE, v(0.3, -4.0, 0.0), y, Some((3.0, -y))),
        (CONE, v(0.0, 4.0, 0.0), -y, Some((3.0, DVec3::ZERO))),
        (CONE, v(0.4, 4.0, 0.0), -y, Some((3.8, v(1.0, 0.5, 0.0)))),
        // Parallel to a generator.
        (
            CONE,
            v(-2.0, 4.0, 0.0),
            v(1.0, -2.0, 0.0),
            Some((5.0_f64.sqrt() * 1.75, v(-1.0, 0.5, 0.0))),
        ),
        // In the half of the double cone that is not there.
        (CONE, v(3.0, 2.0, 0.0), -x, None),
        (ELLIPSOID, v(5.0, 0.0, 0.0), -x, Some((4.0, x))),
        (
            ELLIPSOID,
            v(0.6, 9.0, 0.0),
            -y,
            Some((7.4, v(0.6, 0.4, 0.0))),
        ),
        (
            BOX,
            v(4.0, 4.0, 0.0),
            v(-1.0, -1.0, 0.0),
            Some((3.0 * SQRT_2, x)),
        ),
        (BOX, v(0.5, 9.0, -2.9), -y, Some((7.0, y))),
        (BOX, v(0.5, 9.0, -3.1), -y, None),
    ];
    let mut rng = Rng::with_seed(1);
    for (geometry, origin, direction, expected) in cases {
        for i in 0..20 {
            let pose = if i == 0 {
                Pose::IDENTITY
            } else {
                somewhere(&mut rng)
            };
            let case = format!("{geometry:?} from {origin} along {direction}, {pose:?}");
            let mut simulation = one(geometry.clone(), pose);
            let (from, along) = (pose.point(*origin), pose.direction(*direction));
            let hit = simulation.cast_ray(0, from, 3.0 * along, 1e3).unwrap();
            let Some((distance, normal)) = expected else {
                assert_eq!(hit, None, "{case}");
                continue;
            };
            let hit = hit.expect(&case);
            assert!((hit.distance - distance).abs() < 1e-12, "{case}: {hit:?}");
            // A tip has no normal.
            if let Some(normal) = normal.try_normalize() {
                let off = (hit.normal - pose.direction(normal)).length();
                assert!(off < 1e-12, "{case}: {hit:?}");
            }
            let position = from + *distance * along.normalize();
            assert!(
                (hit.position - position).length() < 1e-12,
                "{case}: {hit:?}"
            );
            let mut until = |most| simulation.cast_ray(0, from, along, most).unwrap();
            assert!(until(distance + 1e-9).is_some() && until(distance - 1e-9).is_none());
        }
    }
}

fn gradient(geometry: &Geometry, p: DVec3, step: f64) -> DVec3 {
    let along = |axis| (level(geometry, p + step * axis) - level(geometry, p)) / step;
    DVec3::from_array(DVec3::AXES.map(along)).normalize()
}

const MARCH: f64 = 1e-3;

/// Where a march finds the first point inside, to rounding.
fn march(geometry: &Geometry, origin: DVec3, direction: DVec3, far: f64) -> Option<f64> {
    let inside = |t: &f64| level(geometry, origin + *t * direction) <= 0.0;
    let steps = (far / MARCH) as usize;
    let mut high = (0..steps).map(|i| i as f64 * MARCH).find(inside)?;
    let mut low = (high - MARCH).max(0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if inside(&middle) { &mut high } else { &mut low }) = middle;
    }
    Some(high)
}

/// Random rays hit where a march does; where a march steps over a corner, on the surface.
#[test]
fn rays_stop_where_a_march_does() {
    let mut rng = Rng::with_seed(2);
    for geometry in [SPHERE, CAPSULE, CYLINDER, CONE, BOX, ELLIPSOID, hull()] {
        let pose = somewhere(&mut rng);
        let mut simulation = one(geometry.clone(), pose);
        let (mut hits, mut normals) = (0, 0);
        for _ in 0..400 {
            let (from, aim) = (4.0 * within(&mut rng), 1.5 * within(&mut rng));
            let direction = (aim - from).normalize();
            let (origin, along) = (pose.point(from), pose.direction(direction));
            let hit = simulation.cast_ray(0, origin, along, 15.0).unwrap();
            let found = march(&geometry, from, direction, 15.0);
            let case = format!("{geometry:?}: {from} along {direction}: {hit:?}, not {found:?}");
            if let Some(distance) = found {
                let hit = hit.expect(&case);
                assert!((hit.distance - distance).abs() < 1e-9, "{case}");
            }
            let Some(hit) = hit.filter(|hit| hit.distance > 0.0) else {
                continue;
            };
            hits += 1;
            let p = from + hit.distance * direction;
            assert!(level(&geometry, p).abs() < 1e-12, "{case}");
            assert!((hit.normal.length() - 1.0).abs() < 1e-12, "{case}");
            assert!(hit.normal.dot(along) < 1e-9, "{case}");
            let slopes = [1e-6, -1e-6].map(|step| gradient(&geometry, p, step));
            if (slopes[0] - slopes[1]).length() < 1e-3 {
                normals += 1;
                let normal = pose.direction(0.5 * (slopes[0] + slopes[1]));
                assert!((hit.normal - normal).length() < 2e-3, "{case}: {normal}");
            }
        }
        assert!(hits > 50 && normals > hits * 9 / 10, "{hits}, {normals}");
    }
}

/// One of each kind.
fn solids() -> [Geometry; 8] {
    [
        PLANE,
        SPHERE,
        CAPSULE,
        CYLINDER,
        CONE,
        BOX,
        ELLIPSOID,
        hull(),
    ]
}

#[test]
fn from_inside_the_distance_is_zero() {
    for geometry in solids() {
        let mut simulation = one(geometry.clone(), Pose::at(DVec3::Y));
        let origin = DVec3::new(0.1, 0.9, 0.05);
        for direction in [DVec3::X, -DVec3::Y, DVec3::new(1.0, 2.0, 3.0)] {
            let hit = simulation.cast_ray(0, origin, direction, 0.0).unwrap();
            let expected = RayHit {
                shape: ShapeId(0),
                distance: 0.0,
                position: origin,
                normal: -direction.normalize(),
            };
            let hit = hit.unwrap_or_else(|| panic!("{geometry:?}"));
            assert!((hit.normal - expected.normal).length() < 1e-15);
            assert_eq!(
                RayHit {
                    normal: expected.normal,
                    ..hit
                },
                expected,
                "{geometry:?}"
            );
        }
    }
}

/// 1e8 m away a double has 1.5e-8 m between its values.
#[test]
fn from_afar_only_the_digits_of_the_origin_are_lost() {
    for geometry in solids() {
        let mut simulation = one(geometry.clone(), Pose::IDENTITY);
        for direction in [-DVec3::Y, DVec3::new(-0.8, -0.6, 0.0)] {
            let near = DVec3::new(0.05, 0.0, 0.03) - 8.0 * direction;
            let mut cast = |origin| {
                let hit = simulation.cast_ray(0, origin, direction, 1e9).unwrap();
                hit.unwrap_or_else(|| panic!("{geometry:?}"))
            };
            let (near_hit, far_hit) = (cast(near), cast(near - 1e8 * direction));
            let apart = (near_hit.position - far_hit.position).length();
            assert!(apart < 1e-7, "{geometry:?}: {apart}");
            assert!((near_hit.normal - far_hit.normal).length() < 1e-6);
        }
    }
}

fn ray(rng: &mut Rng, size: f64) -> Ray {
    let far = [1.0, 10.0, 1e4][rng.usize(0..3)];
    let origin = far * size * within(rng);
    let max_distance = [f64::INFINITY, 2.0 * far * size, 0.5 * size][rng.usize(0..3)];
    let mut direction = size * within(rng) - origin;
    if rng.u8(0..10) == 0 {
        direction = -DVec3::Y;
    }
    Ray {
        origin,
        direction,
        max_distance,
    }
}

/// Many rays in threads, and each alone: the same to the bit. In a pyramid, and in a heap of solids of all kinds, two in each place, of which the first is met.
#[test]
fn many_rays_meet_what_each_meets_alone() {
    let mut rng = Rng::with_seed(3);
    let mut world = Builder::new("heap");
    let object = world.object("things");
    object.scenery(Shape::new(PLANE).at(Pose::at(-2.0 * DVec3::Y)));
    for geometry in solids().into_iter().skip(1).chain([hills()]) {
        for _ in 0..4 {
            let pose = somewhere(&mut rng);
            object.scenery(Shape::new(geometry.clone()).at(pose).without_contact());
            object.scenery(Shape::new(geometry.clone()).at(pose).without_contact());
        }
    }
    let cubes = world.object("cubes");
    for i in 0..30 {
        let place = Pose::at(DVec3::new(
            0.2 * f64::from(i % 5),
            0.3 * f64::from(i / 5),
            0.0,
        ));
        let cube = Shape::new(Geometry::Box {
            half: DVec3::splat(0.1),
        });
        cubes.body(format!("cube_{i}")).at(place).shape(cube);
    }
    let heap = (world.build().unwrap(), 4.0);
    for (model, size) in [heap, (square_pyramid(5).unwrap(), 0.5)] {
        let settings = SimulationSettings {
            solver: SolverKind::Impulse,
            threads: 2,
            ..SimulationSettings::new(2, 0.005)
        };
        let mut simulation = Simulation::<f32>::new(model, settings).unwrap();
        simulation.step(100);
        let rays: Vec<_> = (0..5000).map(|_| ray(&mut rng, size)).collect();
        let together = simulation.cast_rays(1, &rays).unwrap();
        let mut shapes = std::collections::BTreeSet::new();
        for (ray, hit) in rays.iter().zip(&together) {
            let alone = simulation.cast_ray(1, ray.origin, ray.direction, ray.max_distance);
            assert_eq!(*hit, alone.unwrap(), "{ray:?}");
            shapes.extend(hit.map(|hit| hit.shape));
        }
        assert!(shapes.len() > 20, "{shapes:?}");
        let second = |shape: &ShapeId| size == 4.0 && shape.0 <= 56 && shape.0.is_multiple_of(2);
        assert!(!shapes.range(ShapeId(1)..).any(second), "{shapes:?}");
    }
    assert_eq!(one(PLANE, Pose::IDENTITY).cast_rays(0, &[]).unwrap(), []);
}

/// A height field off the origin of its frame.
fn hills() -> Geometry {
    let height = |r: i32, c: i32| 3.0 + 0.3 * (1.3 * f64::from(r)).sin() + 0.2 * f64::from(c).cos();
    let row = |r| (0..9).map(|c| height(r, c)).collect();
    let heights: Vec<Vec<_>> = (0..12).map(row).collect();
    Geometry::Mesh(TriangleMesh::height_field(&heights, DVec2::new(0.3, 0.2)).unwrap())
}

/// o + t d = a + u (b − a) + v (c − a), by Cramer's rule, for the first of all triangles.
fn first_of_all(mesh: &TriangleMesh, o: DVec3, d: DVec3) -> Option<(f64, DVec3)> {
    let meets = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        let m = DMat3::from_cols(b - a, c - a, -d);
        let x = m.inverse() * (o - a);
        let inside = x.x >= 0.0 && x.y >= 0.0 && x.x + x.y <= 1.0;
        let normal = (b - a).cross(c - a).normalize();
        let hit = (x.z, -normal * normal.dot(d).signum());
        (m.determinant() != 0.0 && inside && x.z >= 0.0).then_some(hit)
    };
    let hits = (0..mesh.triangles().len()).filter_map(meets);
    hits.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// From above, from below, and from between hills, far away and near.
#[test]
fn the_first_of_all_triangles_is_met() {
    let mut rng = Rng::with_seed(5);
    let (geometry, pose) = (hills(), somewhere(&mut rng));
    let Geometry::Mesh(mesh) = &geometry else {
        panic!("a mesh");
    };
    let mut simulation = one(geometry.clone(), pose);
    let mut hits = [0; 2];
    for _ in 0..3000 {
        let far = [2.0, 100.0][rng.usize(0..2)];
        let origin = mesh.center() + far * within(&mut rng);
        let direction = (mesh.center() + 1.5 * within(&mut rng) - origin).normalize();
        let (from, along) = (pose.point(origin), pose.direction(direction));
        let found = simulation.cast_ray(0, from, 2.0 * along, 1e3).unwrap();
        let expected = first_of_all(mesh, origin, direction);
        assert_eq!(found.is_some(), expected.is_some(), "{origin} {direction}");
        let Some((hit, (distance, normal))) = found.zip(expected) else {
            continue;
        };
        assert!(
            (hit.distance - distance).abs() < 1e-12 * far.max(10.0),
            "{hit:?}, {distance}"
        );
        assert!(
            (hit.normal - pose.direction(normal)).length() < 1e-9,
            "{hit:?}"
        );
        hits[usize::from(pose.inverse().direction(hit.normal).y > 0.0)] += 1;
    }
    assert!(hits.into_iter().all(|n| n > 500), "{hits:?}");
}

/// Rays that aim at the corners and the edges of triangles, in any direction, do not pass between them.
#[test]
fn there_are_no_gaps_between_triangles() {
    let mut rng = Rng::with_seed(6);
    let ball: Vec<_> = (0..60).map(|_| within(&mut rng).normalize()).collect();
    let hull = Hull::new(&ball).unwrap();
    let mesh = TriangleMesh::new(hull.vertices(), hull.triangles()).unwrap();
    let pose = somewhere(&mut rng);
    let mut simulation = one(Geometry::Mesh(mesh.clone()), pose);
    for t in 0..mesh.triangles().len() {
        let [a, b, _] = mesh.corners(t);
        for aim in [a, 0.5 * (a + b), a.lerp(b, 0.3)] {
            let origin = pose.point(aim * 3.0 + 0.5 * within(&mut rng));
            let aim = pose.point(0.999_999 * aim);
            let hit = simulation.cast_ray(0, origin, aim - origin, 1e3).unwrap();
            assert!(hit.is_some(), "{origin} to {aim}");
        }
    }
}

/// A ball that falls for a second, each world from where it is.
#[test]
fn shapes_are_met_where_they_are_now() {
    let mut world = Builder::new("ball");
    let balls = world.object("balls");
    balls.body("ball").shape(Shape::new(SPHERE));
    let mut simulation =
        Simulation::<f64>::new(world.build().unwrap(), SimulationSettings::new(2, 0.001)).unwrap();
    let still = [0.0; 6];
    let high = [0.0, 100.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    simulation.set_joint_state(1, &high, &still).unwrap();
    simulation.step(1000);
    for (world, height) in [(0, 0.0), (1, 100.0)] {
        let bottom = simulation.outputs().body_position(world, model::BodyId(0)) - 0.5 * DVec3::Y;
        assert!((bottom.y - (height - 0.5 * 9.81 - 0.5)).abs() < 0.01);
        let from = DVec3::Y * -50.0;
        let hit = simulation
            .cast_ray(world, from, DVec3::Y, 1e3)
            .unwrap()
            .unwrap();
        assert!((hit.position - bottom).length() < 1e-12);
    }
}

#[test]
fn rays_pass_through_sensors() {
    let wall = Shape::new(BOX).at(Pose::at(DVec3::X * 9.0));
    let mut simulation = simulate(scenery([Shape::new(SPHERE).as_sensor(), wall]));
    let ray = Ray {
        origin: -2.0 * DVec3::X,
        direction: DVec3::X,
        max_distance: 20.0,
    };
    let hit = simulation.cast_ray(0, ray.origin, ray.direction, ray.max_distance);
    let hit = hit.unwrap().unwrap();
    assert_eq!((hit.shape, hit.distance), (ShapeId(1), 10.0));
    assert_eq!(simulation.cast_rays(0, &[ray]).unwrap(), [Some(hit)]);
}

#[test]
fn a_world_of_its_own_has_shapes_of_its_own() {
    let ball = |radius| scenery([Shape::new(Geometry::Sphere { radius }).without_contact()]);
    let settings = SimulationSettings::new(2, 0.01);
    let mut simulation = Simulation::<f32>::new(ball(0.5), settings).unwrap();
    simulation.set_world_model(1, &ball(0.75)).unwrap();
    let mut distance = |world| {
        let hit = simulation.cast_ray(world, DVec3::X * 2.0, DVec3::NEG_X, 9.0);
        hit.unwrap().map(|hit| hit.distance)
    };
    assert_eq!([distance(0), distance(1)], [Some(1.5), Some(1.25)]);
    simulation.set_world_model(1, &ball(0.5)).unwrap();
    let hit = simulation.cast_ray(1, DVec3::X * 2.0, DVec3::NEG_X, 9.0);
    assert_eq!(hit.unwrap().map(|hit| hit.distance), Some(1.5));
}

#[track_caller]
fn says<T: std::fmt::Debug>(result: Result<T, SimulationError>, message: &str) {
    assert_eq!(result.unwrap_err().to_string(), message);
}

#[test]
fn bad_rays_are_refused() {
    let mut simulation = one(SPHERE, Pose::IDENTITY);
    let (o, d) = (DVec3::ZERO, DVec3::X);
    let mut cast = |origin, direction, most| simulation.cast_ray(0, origin, direction, most);
    says(
        cast(DVec3::new(0.0, f64::NAN, 0.0), d, 1.0),
        "origin of ray 0 is [0, NaN, 0]: it must be finite and within 1e9 m along each axis",
    );
    says(
        cast(DVec3::new(0.0, -2e9, 0.0), d, 1.0),
        "origin of ray 0 is [0, -2000000000, 0]: it must be finite and within 1e9 m along each axis",
    );
    says(
        cast(o, DVec3::ZERO, 1.0),
        "direction of ray 0 is [0, 0, 0]: it must be of a length from 1e-12 to 1e12",
    );
    says(
        cast(o, DVec3::new(1.0, 0.0, f64::NAN), 1.0),
        "direction of ray 0 is [1, 0, NaN]: it must be of a length from 1e-12 to 1e12",
    );
    says(
        cast(o, d, -1.0),
        "largest distance of ray 0 is -1: it must be 0 or more, in metres",
    );
    says(
        cast(o, d, f64::NAN),
        "largest distance of ray 0 is NaN: it must be 0 or more, in metres",
    );
    says(
        simulation.cast_ray(1, o, d, 1.0),
        "world 1 does not exist: there are 1, counted from 0",
    );
    let good = Ray {
        origin: o,
        direction: d,
        max_distance: 1.0,
    };
    let bad = Ray {
        max_distance: -0.5,
        ..good
    };
    says(
        simulation.cast_rays(0, &[good, bad]),
        "largest distance of ray 1 is -0.5: it must be 0 or more, in metres",
    );
    says(
        simulation.cast_rays(7, &[good]),
        "world 7 does not exist: there are 1, counted from 0",
    );
}

#[test]
fn meshes_that_cannot_be_read_are_refused() {
    let mesh = Geometry::MeshFile {
        file: "hull.obj".into(),
        scale: DVec3::ONE,
    };
    let shape = Shape::new(mesh).named("hull").without_contact();
    let mut simulation = simulate(scenery([Shape::new(SPHERE), shape]));
    let message = "rays cannot meet the mesh of shape 1 (`hull`): cannot read the mesh hull.obj: No such file or \
                   directory (os error 2)";
    says(simulation.cast_ray(0, DVec3::ZERO, DVec3::X, 1.0), message);
    says(simulation.cast_rays(0, &[]), message);
}

/// What is only seen stays the name of its file in the model, and is met as the same mesh in it would be.
#[test]
fn meshes_that_are_only_seen_are_read_from_their_files() {
    let file = concat!(env!("CARGO_TARGET_TMPDIR"), "/seen.obj");
    let tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    std::fs::write(file, tetrahedron).unwrap();
    let scale = DVec3::new(1.0, 2.0, 3.0);
    let named = Geometry::MeshFile {
        file: file.into(),
        scale,
    };
    let read = Geometry::Mesh(collide::mesh::load(file, scale).unwrap());
    let [named, read] = [named, read].map(|geometry| {
        let shape = Shape::new(geometry)
            .at(Pose::at(DVec3::Y))
            .without_contact();
        simulate(scenery([Shape::new(SPHERE), shape]))
    });
    let ray = |x: f64, z: f64| Ray {
        origin: DVec3::new(x, 9.0, z),
        direction: DVec3::NEG_Y,
        max_distance: 20.0,
    };
    let places =
        (0..20).flat_map(|i| (0..40).map(move |j| [i, j].map(|n| 0.1 * f64::from(n) - 0.5)));
    let rays = Vec::from_iter(places.map(|[x, z]| ray(x, z)));
    let [named, read] = [named, read].map(|mut simulation| simulation.cast_rays(0, &rays).unwrap());
    assert_eq!(named, read);
    let met = named.iter().flatten().filter(|hit| hit.shape == ShapeId(1));
    assert!(met.count() > 100);
}
