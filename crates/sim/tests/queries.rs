//! What swept shapes meet, what is near a point, what overlaps: closed forms, certificates, and brute force.

mod solids;

use fastrand::Rng;
use glam::{DQuat, DVec2, DVec3};
use kinetarium_sim::{
    PlacedShape, QueryHit, Seen, ShapeCast, Simulation, SimulationError, SimulationSettings,
    SolverKind,
};
use model::examples::square_pyramid;
use model::{BodyId, Builder, Geometry, Hull, Model, Pose, Shape, ShapeId, TriangleMesh};
use solids::{
    BOX, CAPSULE, CONE, CYLINDER, ELLIPSOID, PLANE, scenery, simulate, somewhere, turn, within,
};

fn sphere(radius: f64) -> Geometry {
    Geometry::Sphere { radius }
}

fn corners(rng: &mut Rng) -> Vec<DVec3> {
    (0..20).map(|_| within(rng)).collect()
}

fn hull(rng: &mut Rng) -> Geometry {
    Geometry::Hull(Hull::new(&corners(rng)).unwrap())
}

/// The surface of a hull as a closed mesh.
fn shell(rng: &mut Rng) -> Geometry {
    let hull = Hull::new(&corners(rng)).unwrap();
    Geometry::Mesh(TriangleMesh::new(hull.vertices(), hull.triangles()).unwrap())
}

/// A height field off the origin of its frame.
fn hills() -> Geometry {
    let height = |r: i32, c: i32| 0.5 + 0.3 * (1.3 * f64::from(r)).sin() + 0.2 * f64::from(c).cos();
    let row = |r| (0..9).map(|c| height(r, c)).collect();
    let heights: Vec<Vec<_>> = (0..12).map(row).collect();
    Geometry::Mesh(TriangleMesh::height_field(&heights, DVec2::new(0.3, 0.3)).unwrap())
}

/// One of each kind that a query may have.
fn solids(rng: &mut Rng) -> [Geometry; 7] {
    [
        sphere(0.5),
        CAPSULE,
        CYLINDER,
        CONE,
        BOX,
        ELLIPSOID,
        hull(rng),
    ]
}

fn one(geometry: Geometry, pose: Pose) -> Simulation<f64> {
    simulate(scenery([Shape::new(geometry).at(pose).without_contact()]))
}

/// The level of a solid, or the distance of a mesh.
fn level(geometry: &Geometry, p: DVec3) -> f64 {
    match geometry {
        Geometry::Mesh(mesh) => nearest_of_all(mesh, p),
        _ => solids::level(geometry, p),
    }
}

/// The distance of the nearest of all triangles: from the foot on its plane where that is inside, else from an edge.
fn nearest_of_all(mesh: &TriangleMesh, p: DVec3) -> f64 {
    let from_edge = |a: DVec3, b: DVec3| {
        let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        p.distance(a.lerp(b, t))
    };
    let distance = |[a, b, c]: [DVec3; 3]| {
        let n = (b - a).cross(c - a).normalize();
        let inside = [[a, b], [b, c], [c, a]]
            .iter()
            .all(|[u, v]| n.cross(v - u).dot(p - u) >= 0.0);
        let edges = from_edge(a, b).min(from_edge(b, c)).min(from_edge(c, a));
        if inside { n.dot(p - a).abs() } else { edges }
    };
    mesh.faces().map(distance).fold(f64::INFINITY, f64::min)
}

fn at(geometry: &Geometry, pose: &Pose, p: DVec3) -> f64 {
    level(geometry, pose.inverse().point(p))
}

/// The largest n · p over the points p of a solid.
fn reach(geometry: &Geometry, pose: &Pose, n: DVec3) -> f64 {
    let d = pose.inverse().direction(n);
    let flat = DVec3::new(d.x, 0.0, d.z).normalize_or_zero();
    let farthest = |points: &[DVec3]| points.iter().map(|p| p.dot(d)).fold(f64::MIN, f64::max);
    let far = match *geometry {
        Geometry::Sphere { radius } => radius,
        Geometry::Capsule {
            radius,
            half_height,
        } => radius + (half_height - radius) * d.y.abs(),
        Geometry::Cylinder {
            radius,
            half_height,
        } => radius * flat.dot(d) + half_height * d.y.abs(),
        Geometry::Cone {
            radius,
            half_height: h,
        } => (h * d.y).max(radius * flat.dot(d) - h * d.y),
        Geometry::Box { half } => half.dot(d.abs()),
        Geometry::Ellipsoid { half } => (half * d).length(),
        Geometry::Hull(ref hull) => farthest(hull.vertices()),
        Geometry::Mesh(ref mesh) => farthest(mesh.vertices()),
        // Its top, where n is its normal.
        _ => 0.0,
    };
    n.dot(pose.position) + far
}

/// In the frame of the shape met: that shape, radius and centre of a sphere, its direction; way and normal.
type Case = (Geometry, f64, DVec3, DVec3, Option<(f64, DVec3)>);

/// A sphere stops where a ray from its centre would meet the shape grown by its radius.
#[test]
fn a_sphere_stops_at_closed_forms() {
    let v = DVec3::new;
    let (x, y) = (DVec3::X, DVec3::Y);
    let slope = v(1.0, 0.5, 0.0).normalize();
    let cases: &[Case] = &[
        (PLANE, 0.5, v(0.0, 2.0, 0.0), -y, Some((1.5, y))),
        (
            PLANE,
            0.5,
            v(0.0, 2.0, 0.0),
            v(0.8, -0.6, 0.0),
            Some((2.5, y)),
        ),
        (PLANE, 0.5, v(0.0, 2.0, 0.0), x, None),
        (PLANE, 0.5, v(0.0, 0.2, 0.0), x, Some((0.0, y))),
        (
            sphere(0.5),
            0.75,
            v(3.0, 0.75, 0.0),
            -x,
            Some((2.0, v(0.8, 0.6, 0.0))),
        ),
        (sphere(0.5), 0.75, v(3.0, 1.26, 0.0), -x, None),
        (CAPSULE, 0.75, v(3.0, 0.7, 0.0), -x, Some((1.75, x))),
        (
            CAPSULE,
            0.75,
            v(0.75, 5.0, 0.0),
            -y,
            Some((3.0, v(0.6, 0.8, 0.0))),
        ),
        (CAPSULE, 0.75, v(3.0, 0.5, 1.26), -x, None),
        // A face, an edge, and a corner of the box.
        (BOX, 0.5, v(4.0, 1.0, 2.0), -x, Some((2.5, x))),
        (
            BOX,
            0.5,
            v(4.0, 2.3, 0.0),
            -x,
            Some((2.6, v(0.8, 0.6, 0.0))),
        ),
        (
            BOX,
            0.7,
            v(4.0, 2.3, 3.2),
            -x,
            Some((2.4, v(0.6, 0.3, 0.2))),
        ),
        (BOX, 0.7, v(4.0, 2.6, 3.5), -x, None),
        (CYLINDER, 0.25, v(3.0, 0.7, 0.0), -x, Some((2.25, x))),
        (
            CYLINDER,
            0.25,
            v(0.7, 4.0, 0.0),
            -y,
            Some((2.85, v(0.2, 0.15, 0.0))),
        ),
        (CONE, 0.5, v(0.0, 4.0, 0.0), -y, Some((2.5, y))),
        // Beside the slant, by r/cos of it.
        (
            CONE,
            0.5,
            v(4.0, 0.0, 0.0),
            -x,
            Some((3.5 - 0.5 / slope.x, slope)),
        ),
        (ELLIPSOID, 0.5, v(9.0, 0.0, 0.0), -x, Some((7.5, x))),
    ];
    let mut rng = Rng::with_seed(1);
    for (geometry, radius, center, direction, expected) in cases {
        for i in 0..20 {
            let pose = if i == 0 {
                Pose::IDENTITY
            } else {
                somewhere(&mut rng)
            };
            let ball = sphere(*radius);
            let mut simulation = one(geometry.clone(), pose);
            let cast = ShapeCast {
                geometry: &ball,
                pose: Pose::new(pose.point(*center), turn(&mut rng)),
                direction: 3.0 * pose.direction(*direction),
                max_distance: 100.0,
            };
            let case = format!("{geometry:?}: {cast:?}");
            let mut until = |max_distance| {
                let cast = ShapeCast {
                    max_distance,
                    ..cast
                };
                simulation.cast_shape(0, cast, &Seen::default()).unwrap()
            };
            let hit = until(100.0);
            let Some((distance, normal)) = expected else {
                assert_eq!(hit, None, "{case}");
                continue;
            };
            let hit = hit.expect(&case);
            let normal = pose.direction(normal.normalize());
            let wrong = (hit.distance - distance).abs();
            assert!(wrong < 1e-11, "{case}: {hit:?}, {wrong:e}");
            // 1e-16 over the 1e-8 of the sizes at which the normal is taken.
            assert!((hit.normal - normal).length() < 1e-6, "{case}: {hit:?}");
            assert_eq!((hit.shape, hit.body), (ShapeId(0), None));
            if *distance > 0.0 {
                let moved = cast.pose.position + *distance * pose.direction(*direction);
                let position = moved - *radius * normal;
                let off = (hit.position - position).length();
                assert!(off < 1e-6, "{case}: {hit:?}, {off:e}");
                assert!(until(distance + 1e-9).is_some() && until(distance - 1e-9).is_none());
            }
        }
    }
}

/// A random shape cast at a random shape. Where it ends, the point of the hit is in both: they touch. Before, the plane
/// across its normal is between them. Where it does not end, no ray from the one meets the other.
#[test]
fn casts_end_where_shapes_touch_and_no_sooner() {
    let mut rng = Rng::with_seed(2);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..12 {
        let casting = solids(&mut rng);
        let others = solids(&mut rng)
            .into_iter()
            .chain([PLANE, hills(), shell(&mut rng)]);
        for target in others {
            let pose = somewhere(&mut rng);
            let mut simulation = one(target.clone(), pose);
            for geometry in &casting {
                let aim = pose.point(2.5 * within(&mut rng));
                let direction = within(&mut rng).normalize();
                let start = Pose::new(aim - 15.0 * direction, turn(&mut rng));
                let cast = ShapeCast {
                    geometry,
                    pose: start,
                    direction,
                    max_distance: 40.0,
                };
                let case = format!("{cast:?} at {target:?}, {pose:?}");
                let found = simulation.cast_shape(0, cast, &Seen::default()).unwrap();
                check_against_rays(&cast, &target, &pose, found, &mut rng);
                let Some(hit) = found else {
                    misses += 1;
                    continue;
                };
                if hit.distance == 0.0 {
                    assert_eq!(target, PLANE, "{case}");
                    continue;
                }
                hits += 1;
                let moved = Pose::new(start.position + hit.distance * direction, start.orientation);
                let (ours, theirs) = (
                    at(geometry, &moved, hit.position),
                    at(&target, &pose, hit.position),
                );
                // The position is that of 1e-8 of the sizes before; an edge and a rim may stop 1e-6 m too early.
                let speed = -hit.normal.dot(direction);
                assert!(speed > 0.0, "{case}: {hit:?}");
                assert!(
                    ours < 5e-6 / speed && theirs < 1e-9,
                    "{case}: {ours:e}, {theirs:e}"
                );
                if !matches!(target, Geometry::Mesh(_)) {
                    let between = -reach(geometry, &moved, -hit.normal);
                    let left = between - reach(&target, &pose, hit.normal);
                    // The normal errs by 1e-8, and the gap by that times the extents.
                    assert!(left > -1e-6, "{left:e} beyond: {case}");
                }
            }
        }
    }
    assert!(hits > 400 && misses > 80, "{hits} hits, {misses} misses");
}

/// Rays along the way from points of the moving shape's surface, and back from those of the other's: none is shorter than
/// the way.
fn check_against_rays(
    cast: &ShapeCast<'_>,
    target: &Geometry,
    pose: &Pose,
    found: Option<QueryHit>,
    rng: &mut Rng,
) {
    let most = found.map_or(cast.max_distance, |hit| hit.distance);
    for (of, its, other, others, way) in [
        (cast.geometry, &cast.pose, target, pose, cast.direction),
        (target, pose, cast.geometry, &cast.pose, -cast.direction),
    ] {
        if *of == PLANE {
            continue;
        }
        let points = surface(of, its, rng);
        let mut simulation = one(other.clone(), *others);
        let rays = points.map(|origin| kinetarium_sim::Ray {
            origin,
            direction: way,
            max_distance: 80.0,
        });
        let rays = Vec::from_iter(rays);
        for (ray, met) in rays.iter().zip(simulation.cast_rays(0, &rays).unwrap()) {
            let shortest = met.map_or(f64::INFINITY, |met| met.distance);
            assert!(
                shortest > most - 1e-9,
                "a ray of {shortest}, a cast of {most}: {cast:?} at {target:?}, {pose:?}, {ray:?}"
            );
        }
    }
}

/// Points of a shape's surface: corners, and where rays from outside meet it.
fn surface(geometry: &Geometry, pose: &Pose, rng: &mut Rng) -> impl Iterator<Item = DVec3> + use<> {
    let mut simulation = one(geometry.clone(), Pose::IDENTITY);
    let middle = geometry.center();
    let rays = (0..60).map(|_| {
        let out = within(rng).normalize();
        kinetarium_sim::Ray {
            origin: middle + 10.0 * out,
            direction: within(rng) - 10.0 * out,
            max_distance: 20.0,
        }
    });
    let rays = Vec::from_iter(rays);
    let mut points: Vec<_> = simulation.cast_rays(0, &rays).unwrap();
    let corners: &[DVec3] = match geometry {
        Geometry::Hull(hull) => hull.vertices(),
        Geometry::Mesh(mesh) => mesh.vertices(),
        _ => &[],
    };
    let met = points.drain(..).flatten().map(|hit| hit.position);
    let all: Vec<_> = met.chain(corners.iter().copied()).collect();
    let pose = *pose;
    all.into_iter().map(move |p| pose.point(p))
}

/// 1e8 m away a double has 1.5e-8 m between its values.
#[test]
fn from_afar_only_the_digits_of_the_place_are_lost() {
    let mut rng = Rng::with_seed(3);
    let targets = solids(&mut rng)
        .into_iter()
        .chain([hills(), shell(&mut rng)]);
    for target in targets {
        let mut simulation = one(target.clone(), Pose::IDENTITY);
        let direction = DVec3::new(-0.8, -0.6, 0.0);
        let near = target.center() - 8.0 * direction;
        let mut cast = |position| {
            let cast = ShapeCast {
                geometry: &CAPSULE,
                pose: Pose::at(position),
                direction,
                max_distance: f64::INFINITY,
            };
            simulation
                .cast_shape(0, cast, &Seen::default())
                .unwrap()
                .unwrap()
        };
        let (near_hit, far_hit) = (cast(near), cast(near - 1e8 * direction));
        let longer = far_hit.distance - near_hit.distance - 1e8;
        assert!(longer.abs() < 1e-7, "{target:?}: {longer:e}");
    }
}

/// The nearest point is on the surface, the way to it as long as is said, and no other point of the surface is nearer.
#[test]
fn no_point_of_a_surface_is_nearer_than_the_closest() {
    let mut rng = Rng::with_seed(4);
    let (mut inside, mut outside) = (0, 0);
    for _ in 0..6 {
        let shapes = solids(&mut rng)
            .into_iter()
            .chain([PLANE, hills(), shell(&mut rng)]);
        for geometry in shapes {
            let pose = somewhere(&mut rng);
            let mut simulation = one(geometry.clone(), pose);
            let samples = if geometry == PLANE {
                Vec::new()
            } else {
                Vec::from_iter(surface(&geometry, &pose, &mut rng))
            };
            let points = (0..50).map(|_| pose.point(geometry.center() + 2.0 * within(&mut rng)));
            let points = Vec::from_iter(points);
            let found = simulation.closest_points(0, &points, f64::INFINITY, &Seen::default());
            for (point, found) in points.iter().zip(found.unwrap()) {
                let [hit] = found[..] else {
                    panic!("{found:?}");
                };
                let case = format!("{geometry:?}, {pose:?}, {point}: {hit:?}");
                let way = point - hit.position;
                assert!((way - hit.distance * hit.normal).length() < 1e-12, "{case}");
                assert!(at(&geometry, &pose, hit.position).abs() < 1e-9, "{case}");
                assert!((hit.normal.length() - 1.0).abs() < 1e-12, "{case}");
                let solid = !matches!(geometry, Geometry::Mesh(_));
                if solid {
                    assert!(
                        hit.distance * at(&geometry, &pose, *point) > -1e-15,
                        "{case}"
                    );
                }
                for sample in &samples {
                    assert!(
                        point.distance(*sample) > hit.distance.abs() - 1e-9,
                        "{case}, {sample}"
                    );
                }
                *(if hit.distance < 0.0 {
                    &mut inside
                } else {
                    &mut outside
                }) += 1;
            }
        }
    }
    assert!(inside > 300 && outside > 1000, "{inside}, {outside}");
}

/// The surface of a hull, as a closed mesh, has the hull's own distances, inside too: where the nearest point is in a
/// face, on an edge, in a corner.
#[test]
fn a_closed_mesh_has_an_inside() {
    let mut rng = Rng::with_seed(5);
    for _ in 0..10 {
        let points = corners(&mut rng);
        let hull = Hull::new(&points).unwrap();
        let mesh = TriangleMesh::new(hull.vertices(), hull.triangles()).unwrap();
        let pose = somewhere(&mut rng);
        let shapes = [Geometry::Hull(hull.clone()), Geometry::Mesh(mesh)];
        let mut worlds = shapes.map(|geometry| one(geometry, pose));
        let beyond = hull.vertices().iter().map(|v| 1.5 * *v);
        let near = (0..200).map(|_| 1.2 * within(&mut rng)).chain(beyond);
        let near: Vec<_> = near.map(|p| pose.point(p)).collect();
        let [of_hull, of_mesh] = worlds.each_mut().map(|world| {
            world
                .closest_points(0, &near, f64::INFINITY, &Seen::default())
                .unwrap()
        });
        for ((p, a), b) in near.iter().zip(of_hull).zip(of_mesh) {
            let off = (a[0].distance - b[0].distance).abs();
            assert!(off < 1e-12, "{p}: {a:?}, {b:?}");
            assert!((a[0].normal - b[0].normal).length() < 1e-6 || a[0].distance < 0.0);
        }
    }
}

/// A heap of shapes of all kinds, some of moving bodies.
fn heap(rng: &mut Rng) -> Model {
    let mut world = Builder::new("heap");
    let object = world.object("things");
    object.scenery(Shape::new(PLANE).at(Pose::at(-2.0 * DVec3::Y)));
    for _ in 0..4 {
        let shapes = solids(rng).into_iter().chain([hills(), shell(rng)]);
        for geometry in shapes {
            object.scenery(Shape::new(geometry).at(somewhere(rng)).without_contact());
        }
    }
    let cubes = world.object("cubes");
    for i in 0..30 {
        let place = DVec3::new(0.3 * f64::from(i % 5), 0.3 * f64::from(i / 5), 0.0);
        let half = DVec3::splat(0.1);
        cubes
            .body(format!("cube_{i}"))
            .at(Pose::at(place))
            .shape(Geometry::Box { half });
    }
    world.build().unwrap()
}

/// The same question about each shape of a world alone.
fn each_alone<A>(model: &Model, mut ask: impl FnMut(&mut Simulation<f64>, ShapeId) -> A) -> Vec<A> {
    let shapes = model.shapes.iter().enumerate();
    shapes
        .map(|(i, shape)| {
            let carrier = shape
                .body
                .map_or(Pose::IDENTITY, |b| model.bodies[b.0].pose);
            ask(
                &mut one(shape.geometry.clone(), carrier * shape.pose),
                ShapeId(i),
            )
        })
        .collect()
}

/// Nearest shapes, shapes within a radius, and shapes that overlap, among many: those that are when each is asked alone.
#[test]
fn many_shapes_are_found_as_each_is_alone() {
    let mut rng = Rng::with_seed(6);
    let model = heap(&mut rng);
    let mut simulation = simulate(model.clone());
    let points: Vec<_> = (0..60).map(|_| 4.0 * within(&mut rng)).collect();
    let seen = Seen::default();
    let alone = each_alone(&model, |one, shape| {
        let found = one
            .closest_points(0, &points, f64::INFINITY, &seen)
            .unwrap();
        let named = |hits: Vec<QueryHit>| (hits[0].distance, shape);
        Vec::from_iter(found.into_iter().map(named))
    });
    let near = simulation
        .nearest(0, &points, 7, f64::INFINITY, &seen)
        .unwrap();
    let bounded = simulation.nearest(0, &points, 7, 0.4, &seen).unwrap();
    let around = simulation.closest_points(0, &points, 0.4, &seen).unwrap();
    for i in 0..points.len() {
        let mut all: Vec<_> = alone.iter().map(|found| found[i]).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let within = all.iter().filter(|(d, _)| *d <= 0.4).count();
        check_same(&near[i], &all[..7]);
        check_same(&bounded[i], &all[..within.min(7)]);
        check_same(&around[i], &all[..within]);
    }
    let shapes = solids(&mut rng);
    let placed: Vec<_> = (0..70)
        .map(|i| PlacedShape {
            geometry: &shapes[i % shapes.len()],
            pose: somewhere(&mut rng),
        })
        .collect();
    let alone = each_alone(&model, |one, shape| {
        let found = one.overlaps(0, &placed, &seen).unwrap();
        let named = |hits: Vec<QueryHit>| hits.first().map(|hit| (hit.distance, shape));
        Vec::from_iter(found.into_iter().map(named))
    });
    let together = simulation.overlaps(0, &placed, &seen).unwrap();
    let mut count = 0;
    for (i, found) in together.iter().enumerate() {
        let expected: Vec<_> = alone.iter().filter_map(|found| found[i]).collect();
        check_same(found, &expected);
        count += found.len();
    }
    assert!(count > 200, "{count}");
}

/// Of many shapes, rays and casts meet the first of those that they meet when each is alone.
#[test]
fn rays_and_casts_meet_the_first_of_all_shapes() {
    let mut rng = Rng::with_seed(9);
    let model = heap(&mut rng);
    let mut simulation = simulate(model.clone());
    let shapes = solids(&mut rng);
    let casts: Vec<_> = (0..140)
        .map(|i| {
            let far = [5.0, 50.0][i % 2];
            let start = far * within(&mut rng).normalize();
            ShapeCast {
                geometry: &shapes[i % 7],
                pose: Pose::new(start, turn(&mut rng)),
                direction: 3.0 * within(&mut rng) - start,
                max_distance: [2.0 * far, f64::INFINITY][i / 2 % 2],
            }
        })
        .collect();
    let rays: Vec<_> = casts
        .iter()
        .map(|cast| kinetarium_sim::Ray {
            origin: cast.pose.position,
            direction: cast.direction,
            max_distance: cast.max_distance,
        })
        .collect();
    let seen = Seen::default();
    let alone = each_alone(&model, |one, shape| {
        let met = one.cast_rays(0, &rays).unwrap().into_iter();
        let touched = one.cast_shapes(0, &casts, &seen).unwrap().into_iter();
        let met = met.map(|hit| hit.map(|hit| (hit.distance, shape)));
        let touched = touched.map(|hit| hit.map(|hit| (hit.distance, shape)));
        Vec::from_iter(met.chain(touched))
    });
    let met = simulation.cast_rays(0, &rays).unwrap().into_iter();
    let touched = simulation
        .cast_shapes(0, &casts, &seen)
        .unwrap()
        .into_iter();
    let met = met.map(|hit| hit.map(|hit| (hit.distance, hit.shape)));
    let touched = touched.map(|hit| hit.map(|hit| (hit.distance, hit.shape)));
    let mut kinds = std::collections::BTreeSet::new();
    for (i, found) in met.chain(touched).enumerate() {
        let all = alone.iter().filter_map(|found| found[i]);
        let first = all.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        assert_eq!(found.map(|f| f.1), first.map(|f| f.1), "{i}");
        if let Some(((found, shape), (first, _))) = found.zip(first) {
            assert!((found - first).abs() < 1e-9, "{i}: {found}, {first}");
            kinds.insert(shape);
        }
    }
    assert!(kinds.len() > 12, "{kinds:?}");
}

/// Poses of bodies and of scenery differ by rounding.
#[track_caller]
fn check_same(found: &[QueryHit], expected: &[(f64, ShapeId)]) {
    let shapes = found.iter().map(|hit| hit.shape);
    assert!(
        shapes.eq(expected.iter().map(|e| e.1)),
        "{found:?}, {expected:?}"
    );
    for (hit, (distance, _)) in found.iter().zip(expected) {
        assert!(
            (hit.distance - distance).abs() < 1e-9,
            "{hit:?}, {distance}"
        );
    }
}

/// What is said to overlap has a point in common, what is not has none that is found.
#[test]
fn shapes_overlap_that_have_points_in_common() {
    let mut rng = Rng::with_seed(7);
    let (mut overlaps, mut apart) = (0, 0);
    for _ in 0..12 {
        let (asked, there) = (solids(&mut rng), solids(&mut rng));
        for target in there.into_iter().chain([PLANE, hills()]) {
            let pose = somewhere(&mut rng);
            let mut simulation = one(target.clone(), pose);
            for geometry in &asked {
                let placed = PlacedShape {
                    geometry,
                    pose: Pose::new(pose.point(3.0 * within(&mut rng)), turn(&mut rng)),
                };
                let found = simulation.overlaps(0, &[placed], &Seen::default()).unwrap();
                let case = format!("{placed:?}, {target:?}, {pose:?}: {found:?}");
                if let [hit] = found[0][..] {
                    overlaps += 1;
                    assert!(hit.distance <= 0.0, "{case}");
                    assert!(at(&target, &pose, hit.position) < 1e-9, "{case}");
                    // The way out of what overlaps deeply may be a longer one.
                    let ours = at(geometry, &placed.pose, hit.position);
                    assert!(ours < 1e-6 || hit.distance < -0.05, "{case}: {ours:e}");
                    continue;
                }
                apart += 1;
                let points = surface(geometry, &placed.pose, &mut rng);
                for p in points.chain([placed.pose.point(geometry.center())]) {
                    let clear = if matches!(target, Geometry::Mesh(_)) {
                        0.0
                    } else {
                        -1e-9
                    };
                    assert!(at(&target, &pose, p) > clear, "{case}: {p}");
                }
                if target != PLANE {
                    for p in surface(&target, &pose, &mut rng) {
                        assert!(at(geometry, &placed.pose, p) > -1e-9, "{case}: {p}");
                    }
                }
            }
        }
    }
    assert!(overlaps > 200 && apart > 200, "{overlaps}, {apart}");
}

/// Two worlds at once, in threads: each query has the answer, to the bit, that it has alone; and answers are of where
/// bodies are after each way of moving them.
#[test]
fn answers_are_of_each_world_as_it_is_now() {
    let settings = SimulationSettings {
        solver: SolverKind::Impulse,
        threads: 2,
        ..SimulationSettings::new(3, 0.005)
    };
    let mut simulation = Simulation::<f32>::new(square_pyramid(5).unwrap(), settings).unwrap();
    let mut rng = Rng::with_seed(8);
    let start = simulation.snapshot();
    for stage in 0..5 {
        match stage {
            1 => {
                simulation.controls().set_dof_force(2, 0, 3.0).unwrap();
                simulation.step(40);
            }
            2 => {
                let mut q = simulation.outputs().joint_position(1);
                q[0] += 0.3;
                let v = vec![0.0; simulation.model().degrees_of_freedom()];
                simulation.set_joint_state(1, &q, &v).unwrap();
            }
            3 => simulation.restore(&start).unwrap(),
            4 => {
                let mut own = (**simulation.model()).clone().into_parts();
                own.shapes[0].color = Some([1.0; 4]);
                let own = Model::new(own).unwrap();
                simulation.set_world_model(2, &own).unwrap();
            }
            _ => {}
        }
        check_worlds(&mut simulation, &mut rng);
    }
}

fn check_worlds(simulation: &mut Simulation<f32>, rng: &mut Rng) {
    let seen = Seen::default();
    let worlds = [2, 0, 1];
    let shapes = solids(rng);
    let casts: Vec<_> = (0..300)
        .map(|i| ShapeCast {
            geometry: &shapes[i % 7],
            pose: Pose::new(3.0 * within(rng) + 6.0 * DVec3::Y, turn(rng)),
            direction: within(rng) - 3.0 * DVec3::Y,
            max_distance: [1.0, f64::INFINITY][i % 2],
        })
        .collect();
    let placed: Vec<_> = casts
        .iter()
        .map(|cast| PlacedShape {
            geometry: cast.geometry,
            pose: cast.pose,
        })
        .collect();
    let points: Vec<_> = casts.iter().map(|cast| cast.pose.position).collect();
    let hits = simulation
        .cast_shapes_in_worlds(&worlds, &casts, &seen)
        .unwrap();
    let near = simulation
        .nearest_in_worlds(&worlds, &points, 3, 9.0, &seen)
        .unwrap();
    let close = simulation
        .closest_points_in_worlds(&worlds, &points, 5.0, &seen)
        .unwrap();
    let touched = simulation
        .overlaps_in_worlds(&worlds, &placed, &seen)
        .unwrap();
    for i in (0..300).step_by(7) {
        let world = worlds[i / 100];
        let alone = simulation.cast_shape(world, casts[i], &seen).unwrap();
        assert_eq!(alone, hits[i]);
        let point = &points[i..=i];
        let alone = simulation.nearest(world, point, 3, 9.0, &seen).unwrap();
        assert_eq!(alone, near[i..=i]);
        let alone = simulation.closest_points(world, point, 5.0, &seen).unwrap();
        assert_eq!(alone, close[i..=i]);
        let alone = simulation.overlaps(world, &placed[i..=i], &seen).unwrap();
        assert_eq!(alone, touched[i..=i]);
    }
    // The nearest shape is where its body is now.
    let outputs = simulation.outputs();
    let bodies: Vec<_> = near
        .iter()
        .enumerate()
        .flat_map(|(i, found)| found.iter().map(move |hit| (worlds[i / 100], hit)))
        .filter_map(|(world, hit)| Some((outputs.body_pose(world, hit.body?), hit)))
        .map(|(pose, hit)| (pose.position.distance(hit.position), *hit))
        .collect();
    assert!(bodies.len() > 100);
    for (away, hit) in bodies {
        // Boxes of 10 cm.
        assert!(away < 0.051 * 3f64.sqrt(), "{away}: {hit:?}");
    }
}

/// Kinds, contacts, sensors and bodies can be left out.
#[test]
fn queries_see_what_they_are_told_to() {
    let ball = || Shape::new(sphere(0.5));
    let mut world = Builder::new("row");
    let object = world.object("row");
    object.scenery(ball().as_sensor().at(Pose::at(DVec3::X)));
    object.scenery(ball().with_masks(2, 1).at(Pose::at(2.0 * DVec3::X)));
    object.scenery(ball().without_contact().at(Pose::at(3.0 * DVec3::X)));
    object
        .body("ball")
        .at(Pose::at(4.0 * DVec3::X))
        .shape(ball());
    let mut simulation = simulate(world.build().unwrap());
    let row = |simulation: &mut Simulation<f64>, seen: &Seen| {
        let probe = sphere(0.4);
        let cast = ShapeCast {
            geometry: &probe,
            pose: Pose::at(-DVec3::X),
            direction: DVec3::X,
            max_distance: 9.0,
        };
        let first = simulation.cast_shape(0, cast, seen).unwrap();
        let near = simulation.nearest(0, &[-DVec3::X], 9, 9.0, seen).unwrap();
        let found: Vec<_> = near[0].iter().map(|hit| hit.shape.0).collect();
        assert_eq!(first.map(|hit| hit.shape.0), found.first().copied());
        // Shapes of bodies come first.
        let touched: Vec<_> = [(1, 1), (2, 2), (3, 3), (4, 0)]
            .into_iter()
            .filter(|(x, shape)| {
                let place = PlacedShape {
                    geometry: &probe,
                    pose: Pose::at(f64::from(*x) * DVec3::X),
                };
                let hits = simulation.overlaps(0, &[place], seen).unwrap();
                hits[0].iter().any(|hit| hit.shape.0 == *shape)
            })
            .map(|(_, shape)| shape)
            .collect();
        assert_eq!(touched, found);
        found
    };
    let all = Seen::default();
    assert_eq!(row(&mut simulation, &all), [2, 3, 0]);
    let sensors = Seen {
        sensors: true,
        ..Seen::default()
    };
    assert_eq!(row(&mut simulation, &sensors), [1, 2, 3, 0]);
    let kind = Seen {
        membership: Some(2),
        ..Seen::default()
    };
    assert_eq!(row(&mut simulation, &kind), [2]);
    let colliding = Seen {
        colliding: true,
        ..Seen::default()
    };
    assert_eq!(row(&mut simulation, &colliding), [2, 0]);
    let except = Seen {
        except: vec![BodyId(0)],
        ..Seen::default()
    };
    assert_eq!(row(&mut simulation, &except), [2, 3]);
}

#[track_caller]
fn says<T: std::fmt::Debug>(result: Result<T, SimulationError>, message: &str) {
    assert_eq!(result.unwrap_err().to_string(), message);
}

#[test]
fn bad_queries_are_refused() {
    let mut simulation = one(sphere(0.5), Pose::IDENTITY);
    let (ball, seen) = (sphere(0.5), Seen::default());
    let good = ShapeCast {
        geometry: &ball,
        pose: Pose::at(DVec3::Y),
        direction: DVec3::X,
        max_distance: 1.0,
    };
    let mut cast = |bad| simulation.cast_shapes(0, &[good, bad], &seen);
    let with = |direction| ShapeCast { direction, ..good };
    says(
        cast(with(DVec3::NAN)),
        "direction of shape cast 1 is [NaN, NaN, NaN]: it must be of a length from 1e-12 to 1e12",
    );
    says(
        cast(with(DVec3::ZERO)),
        "direction of shape cast 1 is [0, 0, 0]: it must be of a length from 1e-12 to 1e12",
    );
    says(
        cast(ShapeCast {
            max_distance: -1.0,
            ..good
        }),
        "largest distance of shape cast 1 is -1: it must be 0 or more, in metres",
    );
    says(
        cast(ShapeCast {
            pose: Pose::at(DVec3::X * 2e9),
            ..good
        }),
        "position of shape cast 1 is [2000000000, 0, 0]: it must be finite and within 1e9 m along each axis",
    );
    says(
        cast(ShapeCast {
            pose: Pose::new(DVec3::ZERO, DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
            ..good
        }),
        "orientation of shape cast 1 is [0, 0, 0, 0]: it must be a quaternion x, y, z, w of a length from 1e-12 to \
         1e12",
    );
    let (inside_out, flat) = (sphere(-0.5), Geometry::Box { half: DVec3::X });
    let (nothing, squat) = (
        sphere(f64::NAN),
        Geometry::Capsule {
            radius: 1.0,
            half_height: 0.5,
        },
    );
    for (geometry, message) in [
        (
            &inside_out,
            "half sizes of shape 0 is [-0.5, -0.5, -0.5]: it must be positive and at most 1e9 m",
        ),
        (
            &flat,
            "half sizes of shape 0 is [1, 0, 0]: it must be positive and at most 1e9 m",
        ),
        (
            &nothing,
            "half sizes of shape 0 is [NaN, NaN, NaN]: it must be positive and at most 1e9 m",
        ),
        (
            &squat,
            "half height of shape 0 is 0.5: it must be at least the radius: it includes the caps",
        ),
        (
            &PLANE,
            "shape of shape 0 is a plane or a surface: it must be a convex solid: a sphere, capsule, cylinder, cone, \
             box, ellipsoid or hull",
        ),
    ] {
        let pose = Pose::IDENTITY;
        says(
            simulation.overlaps(0, &[PlacedShape { geometry, pose }], &seen),
            message,
        );
    }
    let p = [DVec3::ZERO, DVec3::new(0.0, f64::INFINITY, 0.0)];
    says(
        simulation.closest_points(0, &p, 1.0, &seen),
        "position of point 1 is [0, inf, 0]: it must be finite and within 1e9 m along each axis",
    );
    says(
        simulation.closest_points(0, &p[..1], -1.0, &seen),
        "largest distance is -1: it must be 0 or more, in metres",
    );
    says(
        simulation.nearest(0, &p[..1], 0, 1.0, &seen),
        "number of nearest shapes is 0: it must be 1 or more",
    );
    says(
        simulation.nearest(3, &p[..1], 1, 1.0, &seen),
        "world 3 does not exist: there are 1, counted from 0",
    );
    says(
        simulation.nearest_in_worlds(&[0, 0], &[DVec3::ZERO; 3], 1, 1.0, &seen),
        "queries of the worlds has 3 numbers, but the model needs 2",
    );
    let foreign = Seen {
        except: vec![BodyId(7)],
        ..Seen::default()
    };
    says(
        simulation.cast_shape(0, good, &foreign),
        "body 7 does not exist: there are 1, counted from 0",
    );
    assert_eq!(simulation.cast_shapes(0, &[], &seen).unwrap(), []);
    assert_eq!(
        simulation.cast_shapes_in_worlds(&[], &[], &seen).unwrap(),
        []
    );
}

#[test]
fn meshes_that_cannot_be_read_are_refused_where_they_are_seen() {
    let file = Geometry::MeshFile {
        file: "hull.obj".into(),
        scale: DVec3::ONE,
    };
    let shape = Shape::new(file).named("hull").without_contact();
    let mut simulation = simulate(scenery([Shape::new(sphere(0.5)), shape]));
    let message = "points cannot meet the mesh of shape 1 (`hull`): cannot read the mesh hull.obj: No such file or \
                   directory (os error 2)";
    let point = [DVec3::X];
    says(
        simulation.nearest(0, &point, 1, 9.0, &Seen::default()),
        message,
    );
    let colliding = Seen {
        colliding: true,
        ..Seen::default()
    };
    assert_eq!(
        simulation.nearest(0, &point, 2, 9.0, &colliding).unwrap()[0].len(),
        1
    );
}
