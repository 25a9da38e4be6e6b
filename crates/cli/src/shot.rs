//! A picture of a scene, without a window.

use crate::arguments::{Shot, Viewpoint};
use crate::error::Error;
use crate::output::print;
use crate::view;
use kinetarium::model::{BodyId, Pose};
use render::{Camera, RenderError, Renderer, View};
use session::Stage;
use std::fs::{File, OpenOptions};
use std::io::BufWriter;
use std::path::Path;

/// Rays of a pixel, at least, that tell how much of the sky is seen.
const SKY_RAYS: usize = 16;

/// Simulates to a time and draws what is there then.
pub fn shot(arguments: &Shot) -> Result<(), Error> {
    let stage = stage(arguments)?;
    try_out(&arguments.out)?;
    let poses = poses(&stage, arguments.time)?;
    let renderer = Renderer::new(render::Scene::new(&stage.model)?, &arguments.device)?;
    let scene = renderer.scene();
    let (width, height) = arguments.size;
    let framed = Camera::framing(scene, &poses, width, height);
    let camera = match &arguments.camera {
        None => framed,
        Some(Viewpoint::Points([eye, target])) => framed.looking(*eye, *target, scene.up()),
        Some(Viewpoint::Named(name)) => Camera::of(stage.model.camera(name)?, width, height),
    };
    let rays = renderer.device() == "cpu";
    let samples = arguments.samples.unwrap_or(if rays { 4 } else { 2 });
    let occlusion = if rays {
        SKY_RAYS.div_ceil(samples * samples)
    } else {
        0
    };
    let view = View::new(camera)
        .with_samples(samples)
        .with_occlusion(occlusion);
    let images = renderer.render(&view, &[&poses])?;
    write(
        &arguments.out,
        &images.rgb.unwrap_or_default(),
        (width, height),
    )?;
    let (name, time, out) = (&stage.model.name, arguments.time, arguments.out.display());
    print(&format!("{name} at {time} s, {width} × {height}: {out}\n"));
    Ok(())
}

/// What is to be seen, in one world.
fn stage(arguments: &Shot) -> Result<Stage, Error> {
    let mut stage = view::stage(&arguments.scene, &arguments.reading)?;
    if let Some(name) = &arguments.keyframe {
        stage.keyframe = Some(stage.model.keyframe(name)?.clone());
    }
    stage.worlds = 1;
    Ok(stage)
}

/// Where the bodies are at a time [s].
fn poses(stage: &Stage, seconds: f64) -> Result<Vec<Pose>, Error> {
    let time_step = stage.model.time_step;
    let steps = (seconds / time_step).round();
    if steps > MOST_STEPS {
        return Err(Error::ShotTime { seconds, time_step });
    }
    let mut simulation = stage.simulation()?;
    stage.run(&mut simulation, steps as u64)?;
    if !simulation.diverged().is_empty() {
        return Err(Error::ShotDiverged { seconds });
    }
    let outputs = simulation.outputs();
    let bodies = (0..stage.model.bodies.len()).map(BodyId);
    Ok(bodies.map(|body| outputs.body_pose(0, body)).collect())
}

/// Most time steps before the picture.
const MOST_STEPS: f64 = 1e9;

/// Tries whether the picture can be written before the work is done, and leaves all as it is.
fn try_out(path: &Path) -> Result<(), Error> {
    let failed = |reason| Error::Picture {
        path: path.to_owned(),
        reason,
    };
    let there = path.exists();
    let opened = OpenOptions::new().append(true).create(true).open(path);
    opened.map(drop).map_err(failed)?;
    if !there {
        // The work may be refused.
        std::fs::remove_file(path).map_err(failed)?;
    }
    Ok(())
}

fn write(path: &Path, rgb: &[u8], (width, height): (usize, usize)) -> Result<(), Error> {
    let written = || -> Result<(), RenderError> {
        let file = File::create(path).map_err(|e| RenderError::Picture(e.into()))?;
        render::write_png(BufWriter::new(file), rgb, width, height)
    };
    written().map_err(|reason| Error::Write {
        path: path.to_owned(),
        reason: match reason {
            RenderError::Picture(why) => why.into(),
            other => other.into(),
        },
    })
}
