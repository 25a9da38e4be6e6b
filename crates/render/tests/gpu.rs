//! What a graphics card draws, against the ray-caster.
#![cfg(feature = "gpu")]

mod common;

use common::{camera, medley};
use glam::DVec3;
use kinetarium_render::gpu::{GpuError, Rasteriser};
use kinetarium_render::{Camera, Channels, Images, Scene, View, ray_caster};
use model::{BodyId, Model, Pose, examples};

/// None where the machine has no card and nothing that stands in for one.
fn rasteriser(scene: &Scene) -> Option<Rasteriser> {
    match Rasteriser::new(scene) {
        Ok(rasteriser) => Some(rasteriser),
        Err(GpuError::NoAdapter(error)) => {
            assert!(std::env::var("KINETARIUM_GPU").is_err(), "{error}");
            eprintln!("not tested: {error}");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// What differs: share of the pixels that show another shape; of pixels amid one shape, the largest
/// difference of depth, against the depth where that is above 1 m, and of normals; and the mean
/// difference of colours.
#[derive(Debug)]
struct Difference {
    shapes: f64,
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
        depth: 0.0,
        normal: 0.0,
        color: 0.0,
    };
    for i in 0..pixels {
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
    for seed in 0..4 {
        let (model, poses) = medley(seed);
        let Some((cast, drawn)) = both(&model, View::new(camera(320, 240)), &[&poses]) else {
            return;
        };
        let difference = difference(&cast, &drawn);
        println!("{difference:?}");
        assert!(difference.shapes < 1e-3, "{seed}: {difference:?}");
        assert!(difference.depth < 1e-4, "{seed}: {difference:?}");
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
}

#[test]
fn what_cards_do_not_do_is_refused() {
    let (model, poses) = medley(1);
    let Some(card) = rasteriser(&Scene::new(&model).unwrap()) else {
        return;
    };
    let view = View::new(camera(8, 8));
    let refused = |view: View| card.render(&view, &[&poses]).unwrap_err().to_string();
    assert!(refused(view.with_samples(3)).contains("3 samples along each edge"));
    assert!(refused(view.with_occlusion(2)).contains("2 occlusion rays"));
    assert!(refused(View::new(camera(0, 8))).contains("the camera's width is 0"));
}
