//! What the ray-caster sees: closed forms, every shape against every pixel, and one image of many.

mod common;

use collide::ray::Line;
use common::{HALF, all, camera, hill, medley, scenery, solids};
use glam::{DQuat, DVec2, DVec3, Vec3};
use kinetarium_render::{Camera, Channels, Lens, RenderError, Scene, View, ray_caster};
use model::{BodyId, CameraMode, Geometry, Lamp, LampKind, Model, Pose, Shape, TriangleMesh};
use std::f64::consts::{FRAC_PI_2, PI};

/// Depth, shape and normal of a pixel.
fn seen(model: &Model, camera: Camera, (column, row): (usize, usize)) -> (f32, i32, DVec3) {
    let images = all(model, camera, &[]);
    let i = row * camera.width + column;
    let normal = &images.normal.unwrap()[3 * i..3 * i + 3];
    let normal = DVec3::new(normal[0].into(), normal[1].into(), normal[2].into());
    (images.depth.unwrap()[i], images.shape.unwrap()[i], normal)
}

/// A camera of 3 × 3 pixels at a point, looking at the origin.
fn towards_origin(eye: DVec3) -> Camera {
    let up = if eye.x == 0.0 && eye.z == 0.0 {
        DVec3::X
    } else {
        DVec3::Y
    };
    Camera::new(3, 3, 1e-3).looking(eye, DVec3::ZERO, up)
}

#[test]
fn solids_are_met_where_closed_forms_say() {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let [sphere, capsule, cylinder, cone, cuboid, ellipsoid, _] = solids();
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    let diagonal = (x + y).normalize();
    // Of an ellipsoid along a unit vector d: 1 / |d / a|, normal d / a².
    let reach = 1.0 / (diagonal / HALF).length();
    let cases = [
        (plane, 4.0 * diagonal, 4.0, y),
        (sphere, 4.0 * diagonal, 3.7, diagonal),
        (capsule.clone(), 4.0 * y, 3.5, y),
        (capsule, 4.0 * z, 3.7, z),
        (cylinder.clone(), 4.0 * y, 3.5, y),
        (cylinder, -4.0 * x, 3.7, -x),
        // At the height of the origin a cone has half of its radius; its side leans by r / 2h.
        (
            cone.clone(),
            4.0 * x,
            3.85,
            DVec3::new(1.0, 0.3, 0.0).normalize(),
        ),
        (cone, -4.0 * y, 3.5, -y),
        (cuboid.clone(), 4.0 * x, 3.5, x),
        (cuboid, -4.0 * z, 3.6, -z),
        (
            ellipsoid,
            4.0 * diagonal,
            4.0 - reach,
            (diagonal / (HALF * HALF)).normalize(),
        ),
    ];
    for (geometry, eye, depth, normal) in cases {
        let name = format!("{geometry:?} from {eye}");
        let found = seen(
            &scenery([Shape::new(geometry)]),
            towards_origin(eye),
            (1, 1),
        );
        assert!(
            (f64::from(found.0) - depth).abs() < 1e-6,
            "{name}: {}",
            found.0
        );
        assert_eq!(found.1, 0, "{name}");
        assert!(found.2.abs_diff_eq(normal, 1e-6), "{name}: {}", found.2);
    }
}

#[test]
fn surfaces_are_seen_from_outside_only() {
    let inside = Camera::new(3, 3, 1.0);
    for geometry in solids() {
        let model = scenery([Shape::new(geometry)]);
        assert_eq!(
            seen(&model, inside, (1, 1)),
            (f32::INFINITY, -1, DVec3::ZERO)
        );
    }
    let square = [[0.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.0, 1.0, -1.0]].map(DVec3::from);
    let front = TriangleMesh::new(&square, &[[0, 1, 2]]).unwrap();
    let back = TriangleMesh::new(&square, &[[0, 2, 1]]).unwrap();
    let to_the_right = inside.looking(DVec3::ZERO, DVec3::new(0.2, 0.2, -1.0), DVec3::Y);
    let shape = |mesh| scenery([Shape::new(Geometry::Mesh(mesh))]);
    assert_eq!(seen(&shape(front), to_the_right, (1, 1)).1, 0);
    assert_eq!(seen(&shape(back), to_the_right, (1, 1)).1, -1);
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    let below = towards_origin(-DVec3::Y);
    assert_eq!(seen(&scenery([Shape::new(plane)]), below, (1, 1)).1, -1);
}

#[test]
fn a_point_is_seen_where_the_formula_says() {
    let mut camera = Camera::new(64, 48, FRAC_PI_2);
    // 45° up is the upper edge.
    assert!(camera.focal().abs_diff_eq(DVec2::splat(24.0), 1e-12));
    let upper = camera.project(DVec3::new(0.0, 3.0, -3.0)).unwrap();
    assert!(upper.abs_diff_eq(DVec2::new(32.0, 0.0), 1e-9));
    assert_eq!(camera.project(DVec3::Z), None);
    camera.lens = Lens::Pixels {
        focal: DVec2::new(50.0, 40.0),
        principal: DVec2::new(20.5, 30.5),
    };
    let point = DVec3::new(0.6, 0.3, -2.0);
    let pixel = camera.project(point).unwrap();
    assert!(pixel.abs_diff_eq(DVec2::new(20.5 + 15.0, 30.5 - 6.0), 1e-12));
    assert!((2.0 * camera.unproject(pixel)).abs_diff_eq(point, 1e-12));

    // A pea covers the pixel of its middle, and those beside it at most.
    let pea = Geometry::Sphere { radius: 0.02 };
    let images = all(&scenery([Shape::new(pea).at(Pose::at(point))]), camera, &[]);
    let shapes = images.shape.unwrap();
    assert_eq!(shapes[24 * 64 + 35], 0);
    assert!(shapes.iter().filter(|shape| **shape == 0).count() <= 4);
}

#[test]
fn depth_is_along_the_axis_and_ends_at_near_and_far() {
    let wall = Geometry::Box {
        half: DVec3::new(9.0, 9.0, 0.5),
    };
    let model = scenery([Shape::new(wall).at(Pose::at(DVec3::new(0.0, 0.0, -3.5)))]);
    let camera = Camera::new(20, 10, 1.5);
    let depth = all(&model, camera, &[]).depth.unwrap();
    assert!(depth.iter().all(|d| (d - 3.0).abs() < 1e-6));
    for (near, far) in [(3.1, 9.0), (0.1, 2.9)] {
        let depth = all(
            &model,
            Camera {
                near,
                far,
                ..camera
            },
            &[],
        )
        .depth
        .unwrap();
        assert!(depth.iter().all(|d| d.is_infinite()));
    }
}

/// Every shape against every pixel: no box, no tree, no order, triangles by Möller and Trumbore.
fn brute_force(model: &Model, poses: &[Pose], eye: Pose, way: DVec3) -> Option<(f64, usize)> {
    let direction = eye.direction(way);
    let meet = |shape: &Shape| {
        let pose = shape.body.map_or(Pose::IDENTITY, |body| poses[body.0]) * shape.pose;
        let inverse = pose.inverse();
        let (origin, d) = (inverse.point(eye.position), inverse.direction(direction));
        let length = d.length();
        match &shape.geometry {
            Geometry::Plane { half_x, half_z } => {
                let t = -origin.y / d.y;
                let p = origin + t * d;
                let endless = *half_x == 0.0;
                let within = endless || (p.x.abs() <= *half_x && p.z.abs() <= *half_z);
                (d.y < 0.0 && within).then_some(t)
            }
            Geometry::Mesh(mesh) => {
                let triangles = 0..mesh.triangles().len();
                let met = triangles.filter_map(|t| moeller_trumbore(mesh.corners(t), origin, d));
                met.filter(|t| *t > 0.0).reduce(f64::min)
            }
            solid => {
                let direction = d / length;
                let span = Line { origin, direction }.within(solid)?;
                Some(span.enter / length)
            }
        }
    };
    let met = model.shapes.iter().enumerate();
    let met = met.filter_map(|(i, shape)| Some((meet(shape).filter(|t| *t > 0.01)?, i)));
    met.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Where the front of a triangle is met (Möller & Trumbore, Fast minimum storage ray/triangle
/// intersection, 1997).
fn moeller_trumbore([a, b, c]: [DVec3; 3], origin: DVec3, d: DVec3) -> Option<f64> {
    let (e, f) = (b - a, c - a);
    let p = d.cross(f);
    let determinant = e.dot(p);
    let s = origin - a;
    let (u, q) = (s.dot(p) / determinant, s.cross(e));
    let v = d.dot(q) / determinant;
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    (determinant > 0.0 && inside).then(|| f.dot(q) / determinant)
}

#[test]
fn all_shapes_are_seen_as_one_by_one() {
    for seed in 0..6 {
        let (model, poses) = medley(seed);
        let camera = camera(97, 71);
        let images = all(&model, camera, &poses);
        let (depth, shape, body) = (
            images.depth.unwrap(),
            images.shape.unwrap(),
            images.body.unwrap(),
        );
        let mut kinds = std::collections::BTreeSet::new();
        for i in 0..97 * 71 {
            let middle = DVec2::new((i % 97) as f64 + 0.5, (i / 97) as f64 + 0.5);
            let way = camera.unproject(middle);
            match brute_force(&model, &poses, camera.pose, way) {
                Some((distance, row)) => {
                    assert!(
                        (f64::from(depth[i]) - distance).abs() < 1e-5 * distance,
                        "{seed} {i}"
                    );
                    assert_eq!(shape[i], row as i32, "{seed} {i}");
                    let owner = model.shapes[row].body.map_or(-1, |body| body.0 as i32);
                    assert_eq!(body[i], owner);
                    kinds.insert(row);
                }
                None => assert_eq!((depth[i], shape[i]), (f32::INFINITY, -1), "{seed} {i}"),
            }
        }
        assert!(kinds.len() > 10, "{kinds:?}");
    }
}

#[test]
fn a_camera_on_a_body_sees_what_a_free_one_sees_there() {
    let (model, poses) = medley(3);
    let body = BodyId(4);
    let offset = Pose::new(DVec3::new(0.1, 1.0, 2.0), DQuat::from_rotation_x(-0.4));
    let mounted = camera(60, 40).on(body).at(offset);
    let free = camera(60, 40).at(poses[4] * offset);
    let (mounted, free) = (all(&model, mounted, &poses), all(&model, free, &poses));
    assert_eq!(mounted.shape, free.shape);
    assert_eq!(mounted.rgb, free.rgb);
}

#[test]
fn many_worlds_in_one_call_are_those_one_by_one_on_any_number_of_threads() {
    let (model, first) = medley(1);
    let (_, second) = medley(2);
    let scene = Scene::new(&model).unwrap();
    let view = View::new(camera(50, 35).on(BodyId(2)).at(Pose::at(DVec3::Z * 3.0)))
        .with_channels(Channels::ALL)
        .with_samples(2)
        .with_occlusion(1);
    let both = ray_caster::render(&scene, &view, &[&first, &second]).unwrap();
    assert_eq!((both.worlds, both.width, both.height), (2, 50, 35));
    let alone = [&first, &second].map(|p| ray_caster::render(&scene, &view, &[p]).unwrap());
    let [a, b] = &alone;
    let joined =
        |of: fn(&kinetarium_render::Images) -> &Vec<u8>| [of(a).clone(), of(b).clone()].concat();
    assert_eq!(
        both.rgb.as_ref().unwrap(),
        &joined(|i| i.rgb.as_ref().unwrap())
    );
    let shape = |i: &kinetarium_render::Images| i.shape.clone().unwrap();
    assert_eq!(shape(&both), [shape(a), shape(b)].concat());
    assert_ne!(shape(a), shape(b));
    let single = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    let again = single.install(|| ray_caster::render(&scene, &view, &[&first, &second]).unwrap());
    assert_eq!(again, both);
}

#[test]
fn only_what_is_asked_for_is_made() {
    let (model, poses) = medley(1);
    let scene = Scene::new(&model).unwrap();
    let depth = Channels {
        depth: true,
        ..Channels::NONE
    };
    let view = View::new(camera(20, 10)).with_channels(depth);
    let images = ray_caster::render(&scene, &view, &[&poses]).unwrap();
    assert_eq!(images.depth.unwrap().len(), 200);
    assert!(images.rgb.is_none() && images.body.is_none() && images.normal.is_none());
}

#[test]
fn sensors_and_what_is_transparent_are_not_seen() {
    let ball = || Shape::new(Geometry::Sphere { radius: 0.5 });
    let wall = Geometry::Box {
        half: DVec3::new(5.0, 5.0, 0.1),
    };
    let wall = Shape::new(wall)
        .at(Pose::at(-3.0 * DVec3::Z))
        .with_color([1.0, 1.0, 1.0, 1.0]);
    let camera = Camera::new(9, 9, 0.3).at(Pose::at(DVec3::Z * 4.0));
    let shape = |ball: Shape| {
        all(&scenery([ball, wall.clone()]), camera, &[])
            .shape
            .unwrap()[40]
    };
    assert_eq!(shape(ball()), 0);
    assert_eq!(shape(ball().as_sensor()), 1);
    assert_eq!(shape(ball().with_color([1.0, 0.0, 0.0, 0.0])), 1);
    assert_eq!(shape(ball().with_color([1.0, 0.0, 0.0, 0.5])), 0);

    let red = |opacity: f32| {
        let ball = ball().with_color([1.0, 0.0, 0.0, opacity]);
        let mut scene = Scene::new(&scenery([ball, wall.clone()])).unwrap();
        scene.light.shadows = false;
        let images = ray_caster::render(&scene, &View::new(camera), &[&[]]).unwrap();
        let rgb = images.rgb.unwrap();
        rgb[3 * 40 + 1]
    };
    // Half of the wall's green shines through, in linear light.
    let (solid, half, none) = (red(1.0), red(0.5), red(0.0));
    assert_eq!(solid, 0);
    let linear = |x: u8| ((f64::from(x) / 255.0 + 0.055) / 1.055).powf(2.4);
    assert!(
        (linear(half) - 0.5 * linear(none)).abs() < 0.02,
        "{half} {none}"
    );
}

/// Sheets of one colour, one behind the other: all of them together look like a single one that nothing shines through.
#[test]
fn any_number_of_sheets_is_seen_through() {
    let sheet = |i: usize, opacity: f32| {
        let half = DVec3::new(1.0, 1.0, 0.001);
        Shape::new(Geometry::Box { half })
            .at(Pose::at(-0.01 * i as f64 * DVec3::Z))
            .with_color([0.2, 0.5, 0.9, opacity])
    };
    let camera = Camera::new(1, 1, 1e-3).at(Pose::at(DVec3::Z));
    let seen = |sheets: Vec<Shape>| {
        let mut scene = Scene::new(&scenery(sheets)).unwrap();
        scene.light.shadows = false;
        let images = ray_caster::render(&scene, &View::new(camera), &[&[]]).unwrap();
        images.rgb.unwrap()
    };
    let one = seen(vec![sheet(0, 1.0)]);
    // 0.998^5000 = 4e-5.
    let many = seen((0..5000).map(|i| sheet(i, 0.002)).collect());
    let same = one.iter().zip(&many).all(|(a, b)| a.abs_diff(*b) <= 1);
    assert!(same, "{one:?} {many:?}");
}

/// A post of 2 m on a floor, in sunlight from 45°: its shadow is as long as the post.
#[test]
fn a_shadow_is_where_the_sun_throws_it() {
    let post = Geometry::Box {
        half: DVec3::new(0.1, 1.0, 0.1),
    };
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    let model = scenery([Shape::new(plane), Shape::new(post).at(Pose::at(DVec3::Y))]);
    let mut scene = Scene::new(&model).unwrap();
    scene.checker = 0.0;
    scene.light.to_sun = DVec3::new(-1.0, 1.0, 0.0);
    let camera =
        Camera::new(200, 200, FRAC_PI_2).looking(DVec3::Y * 9.0, DVec3::ZERO, DVec3::NEG_Z);
    let mut brightness = |x: f64, shadows: bool| {
        scene.light.shadows = shadows;
        let images = ray_caster::render(&scene, &View::new(camera), &[&[]]).unwrap();
        let at = camera.project(DVec3::new(x, 0.0, -9.0)).unwrap();
        images.rgb.unwrap()[3 * (at.y as usize * 200 + at.x as usize)]
    };
    let (lit, end) = (brightness(-1.0, true), 0.1 + 2.0);
    assert_eq!(brightness(end + 0.1, true), lit);
    let shaded = brightness(end - 0.1, true);
    assert!(
        shaded < lit - 40 && brightness(0.5, true) == shaded,
        "{shaded} {lit}"
    );
    assert_eq!(brightness(end - 0.1, false), lit);
}

/// Of a floor at (x, 0), seen from above, in linear light.
fn floor_brightness(scene: &Scene, poses: &[Pose], x: f64) -> DVec3 {
    let camera =
        Camera::new(400, 400, FRAC_PI_2).looking(DVec3::Y * 9.0, DVec3::ZERO, DVec3::NEG_Z);
    let images = ray_caster::render(scene, &View::new(camera), &[poses]).unwrap();
    let at = camera.project(DVec3::new(x, 0.0, -9.0)).unwrap();
    let first = 3 * (at.y as usize * 400 + at.x as usize);
    let rgb = &images.rgb.unwrap()[first..first + 3];
    let linear = |byte: u8| match f64::from(byte) / 255.0 {
        x if x <= 0.04045 => x / 12.92,
        x => ((x + 0.055) / 1.055).powf(2.4),
    };
    DVec3::new(linear(rgb[0]), linear(rgb[1]), linear(rgb[2]))
}

/// A white floor without sky or sun, under a lamp.
fn under(lamp: Lamp, shapes: impl IntoIterator<Item = Shape>) -> Scene {
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    let floor = Shape {
        color: Some([1.0; 4]),
        ..Shape::new(plane)
    };
    let mut parts = scenery(std::iter::once(floor).chain(shapes)).into_parts();
    parts.lamps.push(lamp);
    let mut scene = Scene::new(&Model::new(parts).unwrap()).unwrap();
    scene.checker = 0.0;
    (scene.light.sky, scene.light.ground) = (Vec3::ZERO, Vec3::ZERO);
    scene
}

/// At height h above a floor, at a distance x: I h / d³ for light that fades by d², d² = h² + x²; of a spot that
/// shines down, (h / d)ᵉ of that up to the cutoff.
#[test]
fn lamps_light_a_floor_as_closed_forms_say() {
    let (h, color) = (2.0, Vec3::new(2.0, 1.0, 0.5));
    let lamp = |kind| Lamp {
        pose: Pose::new(h * DVec3::Y, DQuat::from_rotation_x(-FRAC_PI_2)),
        color,
        attenuation: DVec3::Z,
        ..Lamp::new("lamp", kind)
    };
    let (cutoff, exponent) = (0.9, 3.0);
    let bulb = under(lamp(LampKind::Point), []);
    let spot = under(lamp(LampKind::Spot { cutoff, exponent }), []);
    for x in [0.01, 0.7, 1.5, 2.4, 2.6, 4.0] {
        let d = f64::hypot(h, x);
        let at_all = color.as_dvec3() * h / d.powi(3);
        // A step of 8 bits in sRGB is at most 1 % in linear light, and the point is off by half a pixel.
        let same = |seen: DVec3, expected: DVec3| {
            seen.abs_diff_eq(expected, 0.02 * expected.max_element() + 5e-4)
        };
        let seen = floor_brightness(&bulb, &[], x);
        assert!(same(seen, at_all), "{x}: {seen} {at_all}");
        let within = f64::from((x / h).atan() < cutoff);
        let narrowed = within * (h / d).powf(exponent) * at_all;
        let seen = floor_brightness(&spot, &[], x);
        assert!(same(seen, narrowed), "{x}: {seen} {narrowed}");
    }
}

/// A plate of radius r at height 1 m, midway to a bulb: its shadow has the radius 2r. A ball about the bulb lets its
/// light out.
#[test]
fn what_is_before_a_lamp_throws_a_shadow_and_what_holds_it_does_not() {
    let lamp = |shadows| Lamp {
        pose: Pose::at(2.0 * DVec3::Y),
        shadows,
        ..Lamp::new("bulb", LampKind::Point)
    };
    let plate = Geometry::Cylinder {
        radius: 0.5,
        half_height: 1e-3,
    };
    let plate = Shape::new(plate).at(Pose::at(DVec3::Y));
    let globe = Shape::new(Geometry::Sphere { radius: 0.2 }).at(Pose::at(2.0 * DVec3::Y));
    // The camera looks down past both.
    for shapes in [vec![plate.clone()], vec![plate, globe]] {
        let scene = under(lamp(true), shapes.clone());
        let bright = |x| floor_brightness(&scene, &[], x).x;
        assert!(
            bright(0.9) < 1e-3 && bright(1.1) > 0.7,
            "{} {}",
            bright(0.9),
            bright(1.1)
        );
        let scene = under(lamp(false), shapes);
        assert!(floor_brightness(&scene, &[], 0.9).x > 0.7);
    }
}

/// A lamp of a body goes along with it, and one that tracks does not turn.
#[test]
fn lamps_go_along_with_their_bodies() {
    let (model, mut poses) = medley(0);
    let mut parts = model.into_parts();
    for mode in [CameraMode::Fixed, CameraMode::Track] {
        let lamp = Lamp {
            body: Some(BodyId(0)),
            mode,
            pose: Pose::at(DVec3::X),
            ..Lamp::new("lamp", LampKind::Point)
        };
        let quarter = DQuat::from_rotation_z(FRAC_PI_2);
        poses[0] = Pose::new(DVec3::new(1.0, 2.0, 3.0), quarter);
        let at = lamp.placed(&poses).position;
        let arm = if mode == CameraMode::Fixed {
            DVec3::Y
        } else {
            DVec3::X
        };
        assert!(
            at.abs_diff_eq(DVec3::new(1.0, 2.0, 3.0) + arm, 1e-12),
            "{at}"
        );
    }
    parts.lamps.push(Lamp::new("afar", LampKind::Parallel));
    let light = Scene::new(&Model::new(parts).unwrap()).unwrap().light;
    // The model's only parallel light is the sun.
    assert_eq!(
        (light.to_sun, light.sun, light.lamps.len()),
        (DVec3::Z, Vec3::ONE, 0)
    );
}

#[test]
fn a_framed_model_is_in_the_image_and_fills_it() {
    for name in ["tower", "dominoes", "ragdolls"] {
        let model = model::examples::Scene::find(name).unwrap().model().unwrap();
        let poses: Vec<Pose> = model.bodies.iter().map(|body| body.pose).collect();
        let scene = Scene::new(&model).unwrap();
        let camera = Camera::framing(&scene, &poses, 160, 120);
        let body = all(&model, camera, &poses).body.unwrap();
        let pixels = || {
            (0..body.len())
                .filter(|i| body[*i] >= 0)
                .map(|i| (i % 160, i / 160))
        };
        let edge = |(x, y): (usize, usize)| x == 0 || y == 0 || x == 159 || y == 119;
        assert!(!pixels().any(edge), "{name}");
        let width = pixels().map(|p| p.0).max().unwrap() - pixels().map(|p| p.0).min().unwrap();
        let height = pixels().map(|p| p.1).max().unwrap() - pixels().map(|p| p.1).min().unwrap();
        assert!(width > 110 || height > 80, "{name}: {width} × {height}");
    }
}

#[test]
fn bad_numbers_are_refused_by_name() {
    let (model, poses) = medley(0);
    let scene = Scene::new(&model).unwrap();
    let view = View::new(camera(8, 8));
    let refused = |scene: &Scene, view: &View, worlds: &[&[Pose]]| {
        ray_caster::render(scene, view, worlds)
            .unwrap_err()
            .to_string()
    };
    type Change = fn(&mut Camera);
    let cases: [(Change, &str); 12] = [
        (
            |c| c.width = 0,
            "the camera's width is 0: it must be from 1 to 16384 pixels",
        ),
        (|c| c.height = 16385, "the camera's height is 16385"),
        (
            |c| c.lens = Lens::FieldOfView { vertical: PI },
            "field of view is 3.14",
        ),
        (
            |c| c.lens = Lens::FieldOfView { vertical: 0.0 },
            "field of view is 0",
        ),
        (
            |c| c.lens = Lens::FieldOfView { vertical: f64::NAN },
            "field of view is NaN",
        ),
        (
            |c| {
                c.lens = Lens::Pixels {
                    focal: DVec2::new(9.0, -9.0),
                    principal: DVec2::ZERO,
                }
            },
            "focal length is [9, -9]",
        ),
        (
            |c| {
                c.lens = Lens::Pixels {
                    focal: DVec2::ONE,
                    principal: DVec2::NAN,
                }
            },
            "principal point is [NaN, NaN]",
        ),
        (|c| c.near = 0.0, "near depth is 0"),
        (|c| c.far = 0.001, "far depth is 0.001"),
        (|c| c.far = f64::NAN, "far depth is NaN"),
        (
            |c| c.pose.position.x = f64::INFINITY,
            "the camera's pose is",
        ),
        (
            |c| c.body = Some(BodyId(99)),
            "on body 99, but the scene has 14",
        ),
    ];
    for (change, message) in cases {
        let mut wrong = view.clone();
        change(&mut wrong.camera);
        let error = refused(&scene, &wrong, &[&poses]);
        assert!(error.contains(message), "{error}");
    }
    let few = refused(&scene, &view, &[&poses, &poses[1..]]);
    assert!(
        few.contains("world 1 has 13 poses: give one for each of the 14"),
        "{few}"
    );
    let mut lost = poses.clone();
    lost[5].position.y = f64::NAN;
    assert!(refused(&scene, &view, &[&lost]).contains("body 5 in world 0 is not finite"));
    assert!(refused(&scene, &view, &[]).contains("no worlds"));
    assert!(refused(&scene, &view.clone().with_samples(0), &[&poses]).contains("samples is 0"));
    assert!(refused(&scene, &view.clone().with_occlusion(65), &[&poses]).contains("rays is 65"));
    let mut dark = scene.clone();
    dark.light.to_sun = DVec3::ZERO;
    assert!(refused(&dark, &view, &[&poses]).contains("the direction to the sun is [0, 0, 0]"));
    let huge = View::new(camera(16384, 16384));
    assert!(refused(&scene, &huge, &[&poses[..]; 9]).contains("9 images of 16384 × 16384"));

    let remedies = [
        (
            "nowhere/hand.stl",
            "; correct the path, or give the shape opacity 0",
        ),
        (
            "hand.dae",
            ": convert it to .obj, .stl or .glb; or give the shape opacity 0",
        ),
    ];
    for (file, remedy) in remedies {
        let mesh = Geometry::MeshFile {
            file: file.to_owned(),
            scale: DVec3::ONE,
        };
        let hand = Shape::new(mesh).named("hand").without_contact();
        let error = Scene::new(&scenery([hand])).unwrap_err();
        assert!(matches!(error, RenderError::Mesh { shape: 0, .. }));
        let told = error.to_string();
        assert!(told.contains(file) && told.ends_with(remedy), "{told}");
    }
}

#[test]
fn the_hill_of_the_medley_has_a_front() {
    assert!(hill().normal(0).y > 0.0);
}
