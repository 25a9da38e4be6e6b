//! A picture of a scene, without a window.

use crate::arguments::{RobotFile, Shot};
use crate::error::Error;
use crate::output::print;
use crate::robot;
use kinetarium::model::examples::{self, SCENES, Scene, Start};
use kinetarium::model::{BodyId, Keyframe, Model, Pose};
use kinetarium::rigid::{Integrator, Settings};
use kinetarium::sim::{Simulation, SimulationSettings};
use render::{Camera, RenderError, View, ray_caster};
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

/// How the pendula are called that are no scene.
const PENDULA: &str = "pendula";
/// Rays of a pixel, at least, that tell how much of the sky is seen.
const SKY_RAYS: usize = 16;

/// Simulates to a time and draws what is there then.
pub fn shot(arguments: &Shot) -> Result<(), Error> {
    let (model, keyframe) = model(arguments)?;
    let poses = poses(&model, keyframe.as_ref(), arguments.time)?;
    let scene = render::Scene::new(&model)?;
    let (width, height) = arguments.size;
    let framed = Camera::framing(&scene, &poses, width, height);
    let camera = arguments.camera.map_or(framed, |[eye, target]| {
        framed.looking(eye, target, scene.up())
    });
    let samples = arguments.samples;
    let view = View::new(camera)
        .with_samples(samples)
        .with_occlusion(SKY_RAYS.div_ceil(samples * samples));
    let images = ray_caster::render(&scene, &view, &[&poses])?;
    write(
        &arguments.out,
        &images.rgb.unwrap_or_default(),
        (width, height),
    )?;
    let (name, time, out) = (&model.name, arguments.time, arguments.out.display());
    print(&format!("{name} at {time} s, {width} × {height}: {out}\n"));
    Ok(())
}

/// The model, and where it starts if not at its own state.
fn model(arguments: &Shot) -> Result<(Model, Option<Keyframe>), Error> {
    let name = &arguments.scene;
    let model = if let Some(scene) = Scene::find(name) {
        scene.model()?
    } else if name == PENDULA {
        examples::chain(3, Start::Horizontal)?
    } else if Path::new(name).extension().is_some() {
        let file = RobotFile {
            path: name.into(),
            lenient: arguments.lenient,
            meshes: arguments.meshes,
            floating_base: false,
        };
        robot::load(&file, false)?
    } else {
        let scenes = SCENES.iter().map(|scene| scene.name);
        let scenes: Vec<&str> = scenes.chain([PENDULA]).collect();
        let (name, scenes) = (name.clone(), scenes.join(", "));
        return Err(Error::NoScene { name, scenes });
    };
    let keyframe = match &arguments.keyframe {
        Some(name) => Some(model.keyframe(name)?.clone()),
        None if Scene::find(name).is_some() => model.keyframes.first().cloned(),
        None => None,
    };
    Ok((model, keyframe))
}

/// Where the bodies are at a time [s].
fn poses(model: &Model, keyframe: Option<&Keyframe>, time: f64) -> Result<Vec<Pose>, Error> {
    if time == 0.0 && keyframe.is_none() {
        return Ok(model.bodies.iter().map(|body| body.pose).collect());
    }
    let settings = SimulationSettings {
        step: Settings {
            substeps: if model.is_tree() { 1 } else { 4 },
            integrator: Integrator::SemiImplicitEuler,
            ..Settings::new(model.time_step)
        },
        ..SimulationSettings::new(1, model.time_step)
    };
    let mut simulation = Simulation::<f32>::new(model.clone(), settings)?;
    if let Some(keyframe) = keyframe {
        simulation.set_joint_state(0, &keyframe.joint_position, &keyframe.joint_velocity)?;
        simulation.controls().set_control(0, &keyframe.control)?;
    }
    let steps = (time / model.time_step).round();
    if steps > MOST_STEPS {
        let (seconds, time_step) = (time, model.time_step);
        return Err(Error::ShotTime { seconds, time_step });
    }
    simulation.step(steps as usize);
    if let Some(diverged) = simulation.diverged().first() {
        let time = diverged.time;
        return Err(Error::AllDiverged { worlds: 1, time });
    }
    let outputs = simulation.outputs();
    let bodies = (0..model.bodies.len()).map(BodyId);
    Ok(bodies.map(|body| outputs.body_pose(0, body)).collect())
}

/// Most time steps before the picture.
const MOST_STEPS: f64 = 1e9;

fn write(path: &Path, rgb: &[u8], (width, height): (usize, usize)) -> Result<(), Error> {
    let written = || -> Result<(), RenderError> {
        let file = File::create(path).map_err(|e| RenderError::Picture(e.into()))?;
        render::write_png(BufWriter::new(file), rgb, width, height)
    };
    written().map_err(|reason| Error::Write {
        path: path.to_owned(),
        reason: reason.into(),
    })
}
