//! Images per second of a limp person on a floor, in one world and in many, as a Markdown table.
//!
//! `cargo bench --package kinetarium-render --bench frames --features gpu`: of the ray-caster, and of a card, or of the
//! program that `KINETARIUM_GPU` names.

use kinetarium_render::{Camera, Channels, Device, Images, Renderer, Scene, View, ray_caster};
use model::{Pose, examples};
use std::hint::black_box;
use std::time::Instant;

const SIZES: [(usize, usize); 3] = [(64, 64), (256, 256), (640, 480)];
const WORLDS: [usize; 2] = [1, 256];
/// At least so many repetitions, and for at least so long [s].
const REPETITIONS: usize = 5;
const SECONDS: f64 = 1.0;

fn main() {
    let model = examples::ragdolls(1).expect("a scene of its own");
    let scene = Scene::new(&model).expect("no meshes");
    let poses: Vec<Pose> = model.bodies.iter().map(|body| body.pose).collect();
    println!("Images per second, medians; one sample a pixel, with shadows.\n");
    println!("| renderer | worlds | image | colours | depth and ids |\n|---|--:|--:|--:|--:|");
    let cast = |view: &View, worlds: &[&[Pose]]| ray_caster::render(&scene, view, worlds).unwrap();
    table("ray-caster", &scene, &poses, cast);
    let name = std::env::var("KINETARIUM_GPU").unwrap_or_default();
    match Renderer::new(scene.clone(), &Device::Card(name)) {
        Ok(card) => {
            let draw = |view: &View, worlds: &[&[Pose]]| card.render(view, worlds).unwrap();
            table(&card.device(), &scene, &poses, draw);
        }
        Err(error) => println!("\n{error}"),
    }
}

fn table(name: &str, scene: &Scene, poses: &[Pose], render: impl Fn(&View, &[&[Pose]]) -> Images) {
    let geometry = Channels {
        depth: true,
        body: true,
        shape: true,
        ..Channels::NONE
    };
    for worlds in WORLDS {
        for (width, height) in SIZES {
            let view = View::new(Camera::framing(scene, poses, width, height));
            let rate = |channels| {
                let view = view.clone().with_channels(channels);
                worlds as f64 / median(|| render(&view, &vec![poses; worlds]))
            };
            let (rgb, geometry) = (rate(Channels::RGB), rate(geometry));
            println!("| {name} | {worlds} | {width} × {height} | {rgb:.0} | {geometry:.0} |");
        }
    }
}

/// Median duration [s].
fn median(run: impl Fn() -> Images) -> f64 {
    black_box(run());
    let start = Instant::now();
    let mut durations = Vec::new();
    while durations.len() < REPETITIONS || start.elapsed().as_secs_f64() < SECONDS {
        let begin = Instant::now();
        black_box(run());
        durations.push(begin.elapsed().as_secs_f64());
    }
    durations.sort_by(f64::total_cmp);
    durations[durations.len() / 2]
}
