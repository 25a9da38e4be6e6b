//! What a graphics card draws, against the ray-caster.
#![cfg(feature = "gpu")]

mod common;

use common::{camera, medley};
use glam::{DQuat, DVec3, Vec3};
use kinetarium_render::gpu::{GpuError, Rasteriser};
use kinetarium_render::{
    Camera, Channels, Device, Images, Light, Renderer, Scene, View, ray_caster,
};
use model::{BodyId, CameraMode, Lamp, LampKind, Model, Pose, examples};

/// Whatever card there is, or the program that `KINETARIUM_GPU` names, such as Mesa's `llvmpipe`.
fn name() -> String {
    std::env::var("KINETARIUM_GPU").unwrap_or_default()
}

/// None where the machine has no card, and none is named.
fn rasteriser(scene: &Scene) -> Option<Rasteriser> {
    let Ok(choice) = name().parse();
    match Rasteriser::new(scene, &choice) {
        Ok(rasteriser) => Some(rasteriser),
        Err(GpuError::NoCard(error)) => {
            assert_eq!(name(), "", "{error}");
            eprintln!("not tested: {error}");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// What differs: share of the pixels that show another shape, and of those that show the same shape as of another body;
/// of pixels amid one shape, the largest
/// difference of depth, against the depth where that is above 1 m, and of normals; and the mean
/// difference of colours.
#[derive(Debug)]
struct Difference {
    shapes: f64,
    bodies: f64,
    depth: f64,
    normal: f64,
    color: f64,
}

fn difference(a: &Images, b: &Images) -> Difference {
    let (width, pixels) = (a.width, a.worlds * a.width * a.height);
    let shape = |i: &Images| i.shape.clone().unwrap();
    let (rows, others) = (shape(a), shape(b));
    let amid = |i: usize| {
        let (x, y) = (i % width, i / width % a.height);
        let inside = x > 0 && y > 0 && x < width - 1 && y < a.height - 1;
        inside && (0..9).all(|n| rows[i + n / 3 * width + n % 3 - width - 1] == rows[i])
    };
    let (depth, other_depth) = (a.depth.as_ref().unwrap(), b.depth.as_ref().unwrap());
    let (normal, other_normal) = (a.normal.as_ref().unwrap(), b.normal.as_ref().unwrap());
    let mut found = Difference {
        shapes: 0.0,
        bodies: 0.0,
        depth: 0.0,
        normal: 0.0,
        color: 0.0,
    };
    let (bodies, other_bodies) = (a.body.as_ref().unwrap(), b.body.as_ref().unwrap());
    for i in 0..pixels {
        if rows[i] == others[i] && bodies[i] != other_bodies[i] {
            found.bodies += 1.0 / pixels as f64;
        }
        if rows[i] != others[i] {
            found.shapes += 1.0 / pixels as f64;
        } else if rows[i] >= 0 && amid(i) {
            let apart = f64::from((depth[i] - other_depth[i]).abs());
            found.depth = found.depth.max(apart / f64::from(depth[i]).max(1.0));
            let apart = (0..3).map(|k| (normal[3 * i + k] - other_normal[3 * i + k]).abs());
            found.normal = found.normal.max(apart.fold(0.0, f32::max).into());
        }
    }
    let (rgb, other) = (a.rgb.as_ref().unwrap(), b.rgb.as_ref().unwrap());
    let apart = rgb
        .iter()
        .zip(other)
        .map(|(x, y)| f64::from(x.abs_diff(*y)));
    found.color = apart.sum::<f64>() / rgb.len() as f64;
    found
}

/// Both renderers of a model; the bodies of the worlds are placed so.
fn both(model: &Model, view: View, worlds: &[&[Pose]]) -> Option<(Images, Images)> {
    let scene = Scene::new(model).unwrap();
    let view = view.with_channels(Channels::ALL);
    let card = rasteriser(&scene)?;
    let drawn = card.render(&view, worlds).unwrap();
    Some((ray_caster::render(&scene, &view, worlds).unwrap(), drawn))
}

#[test]
fn a_card_sees_what_rays_meet() {
    // Where pixels are sampled is finer in Mesa's program than in cards.
    let depth = match name().contains("llvmpipe") {
        true => 1e-4,
        false => 4e-4,
    };
    for seed in 0..4 {
        let (model, poses) = medley(seed);
        let Some((cast, drawn)) = both(&model, View::new(camera(320, 240)), &[&poses]) else {
            return;
        };
        let difference = difference(&cast, &drawn);
        println!("{difference:?}");
        assert!(difference.shapes < 1e-3, "{seed}: {difference:?}");
        assert_eq!(difference.bodies, 0.0, "{seed}");
        assert!(difference.depth < depth, "{seed}: {difference:?}");
        assert!(difference.normal < 2e-3, "{seed}: {difference:?}");
        assert!(difference.color < 3.0, "{seed}: {difference:?}");
    }
}

#[test]
fn the_scenes_look_alike() {
    for scene in &examples::SCENES {
        let model = scene.model().unwrap();
        let poses: Vec<Pose> = model.bodies.iter().map(|body| body.pose).collect();
        let camera = Camera::framing(&Scene::new(&model).unwrap(), &poses, 256, 192);
        let view = View::new(camera).with_samples(2);
        let Some((cast, drawn)) = both(&model, view, &[&poses]) else {
            return;
        };
        let difference = difference(&cast, &drawn);
        println!("{}: {difference:?}", scene.name);
        assert!(difference.shapes < 1e-3, "{}: {difference:?}", scene.name);
        assert_eq!(difference.bodies, 0.0, "{}", scene.name);
        assert!(difference.depth < 1e-3, "{}: {difference:?}", scene.name);
        assert!(difference.color < 4.0, "{}: {difference:?}", scene.name);
    }
}

/// Of a size that does not divide rows into what cards copy.
#[test]
fn many_worlds_are_tiles_of_one_target() {
    let (model, first) = medley(1);
    let (_, second) = medley(2);
    let worlds: Vec<&[Pose]> = (0..7)
        .map(|i| if i % 3 == 0 { &second[..] } else { &first })
        .collect();
    let offset = Pose::at(DVec3::new(0.0, 0.5, 3.0));
    let view = View::new(camera(75, 50).on(BodyId(3)).at(offset)).with_channels(Channels::ALL);
    let scene = Scene::new(&model).unwrap();
    let Some(card) = rasteriser(&scene) else {
        return;
    };
    let all = card.render(&view, &worlds).unwrap();
    assert_eq!((all.worlds, all.width, all.height), (7, 75, 50));
    let difference = difference(&ray_caster::render(&scene, &view, &worlds).unwrap(), &all);
    assert!(
        difference.shapes < 1e-3 && difference.depth < 1e-4,
        "{difference:?}"
    );
    assert_eq!(difference.bodies, 0.0);
}

/// The rows themselves, and not only the same ones of both: bodies 0 to 13 have one shape each, after three of the
/// world.
#[test]
fn bodies_are_those_of_the_shapes() {
    let (model, poses) = medley(3);
    let Some((_, drawn)) = both(&model, View::new(camera(160, 120)), &[&poses]) else {
        return;
    };
    let (bodies, shapes) = (drawn.body.unwrap(), drawn.shape.unwrap());
    let mut seen = std::collections::BTreeSet::new();
    for (body, shape) in bodies.iter().zip(&shapes) {
        assert_eq!(*body, if *shape < 3 { -1 } else { *shape - 3 });
        seen.insert(*body);
    }
    assert!(seen.len() > 7, "{seen:?}");
}

/// Sun and squares of a view, in place of the scene's.
#[test]
fn a_card_takes_the_light_of_a_view() {
    let (model, poses) = medley(2);
    let scene = Scene::new(&model).unwrap();
    let light = Light {
        to_sun: DVec3::new(-0.6, 1.0, 0.3),
        sun: Vec3::new(0.9, 0.5, 0.1),
        ..scene.light
    };
    let view = View::new(camera(160, 120));
    let lit = view.clone().with_light(light).with_checker(0.2);
    let Some((cast, drawn)) = both(&model, lit, &[&poses]) else {
        return;
    };
    let difference = difference(&cast, &drawn);
    assert!(difference.color < 4.0, "{difference:?}");
    let Some((plain, _)) = both(&model, view, &[&poses]) else {
        return;
    };
    let apart = plain.rgb.unwrap().into_iter().zip(cast.rgb.unwrap());
    let apart = apart.map(|(a, b)| f64::from(a.abs_diff(b)));
    assert!(apart.sum::<f64>() / f64::from(3 * 160 * 120) > 4.0);
}

/// A lamp that shines all around, a wide spot on a body, a narrow one, and a second sun; in several worlds, in which the
/// body's is at another place.
#[test]
fn a_card_takes_lamps() {
    let (mut model, poses) = medley(2);
    let lamp = |name: &str, kind, position: DVec3, along: DVec3| Lamp {
        pose: Pose::new(position, DQuat::from_rotation_arc(DVec3::NEG_Z, along)),
        ..Lamp::new(name, kind)
    };
    let spot = |degrees: f64, exponent| LampKind::Spot {
        cutoff: degrees.to_radians(),
        exponent,
    };
    let down = DVec3::NEG_Y;
    let mut parts = model.into_parts();
    parts.lamps = vec![
        Lamp {
            attenuation: DVec3::new(0.0, 0.0, 0.3),
            ..lamp("bulb", LampKind::Point, DVec3::new(0.5, 2.5, 0.5), down)
        },
        Lamp {
            color: Vec3::new(0.8, 0.2, 0.1),
            ..lamp(
                "spot",
                spot(30.0, 2.0),
                DVec3::new(-2.0, 4.0, 1.0),
                DVec3::new(0.5, -1.0, 0.0).normalize(),
            )
        },
        Lamp {
            body: Some(BodyId(1)),
            mode: CameraMode::Track,
            color: Vec3::new(0.1, 0.3, 0.8),
            ..lamp("on a body", spot(85.0, 0.5), 1.5 * DVec3::Y, down)
        },
        Lamp {
            color: Vec3::splat(0.2),
            body: Some(BodyId(0)),
            mode: CameraMode::Track,
            ..lamp(
                "beam",
                LampKind::Parallel,
                DVec3::ZERO,
                DVec3::new(1.0, -1.0, 0.0).normalize(),
            )
        },
    ];
    model = Model::new(parts).unwrap();
    let moved: Vec<Pose> = poses
        .iter()
        .map(|pose| Pose::new(pose.position + 0.2 * DVec3::X, pose.orientation))
        .collect();
    let view = View::new(camera(160, 120)).with_samples(2);
    let Some((cast, drawn)) = both(&model, view.clone(), &[&poses, &moved]) else {
        return;
    };
    let difference = difference(&cast, &drawn);
    assert!(difference.color < 3.0, "{difference:?}");
    // Each of them is seen.
    for row in 0..4 {
        let mut light = Scene::new(&model).unwrap().light;
        light.lamps.remove(row);
        let scene = Scene::new(&model).unwrap();
        let without = view.clone().with_light(light);
        let without = ray_caster::render(&scene, &without, &[&poses, &moved]).unwrap();
        let apart = without
            .rgb
            .unwrap()
            .into_iter()
            .zip(cast.rgb.as_ref().unwrap());
        let apart: f64 = apart.map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
        let mean = apart / (2.0 * 3.0 * 160.0 * 120.0);
        assert!(
            mean > 2.0 * difference.color,
            "{row}: {mean} {difference:?}"
        );
    }
}

#[test]
fn a_renderer_is_the_card_that_is_named_and_by_itself_no_program() {
    let (model, poses) = medley(1);
    let scene = Scene::new(&model).unwrap();
    let view = View::new(camera(64, 48)).with_channels(Channels::ALL);
    let by_itself = Renderer::new(scene.clone(), &Device::Auto).unwrap();
    assert!(!by_itself.device().contains("llvmpipe"));
    // What a card does not do, the ray-caster does.
    let fine = view.clone().with_samples(3).with_occlusion(2);
    let cast = ray_caster::render(&scene, &fine, &[&poses]).unwrap();
    assert_eq!(by_itself.render(&fine, &[&poses]).unwrap(), cast);
    let Some(card) = rasteriser(&scene) else {
        return;
    };
    let named = Renderer::new(scene, &Device::Card(name())).unwrap();
    assert_eq!(named.device(), card.device());
    let drawn = card.render(&view, &[&poses]).unwrap();
    assert_eq!(named.clone().render(&view, &[&poses]).unwrap(), drawn);
    let told = named.render(&fine, &[&poses]).unwrap_err().to_string();
    assert!(
        told.contains("3 samples") || told.contains("2 occlusion rays"),
        "{told}"
    );
}

#[test]
fn what_cards_do_not_do_is_refused() {
    let (model, poses) = medley(1);
    let Some(card) = rasteriser(&Scene::new(&model).unwrap()) else {
        return;
    };
    let view = View::new(camera(8, 8));
    let refused = |view: View| card.render(&view, &[&poses]).unwrap_err().to_string();
    assert!(refused(view.clone().with_samples(3)).contains("3 samples along each edge"));
    assert!(refused(view.with_occlusion(2)).contains("2 occlusion rays"));
    assert!(refused(View::new(camera(0, 8))).contains("the camera's width is 0"));
}
