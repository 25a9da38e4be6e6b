//! World-steps per second on a graphics card, as a Markdown table.
//!
//! `cargo xtask gpu-bench`, or the program that it built, which needs nothing but the card's driver (and NVRTC for
//! CUDA): `cards [--device gpu|gpu:NAME|cuda|cuda:NUMBER] [--worlds COUNT,COUNT…] [--only SCENES]`.
//! Without a name any card is taken, but no program that stands in for one; of scenes those whose names begin so.

mod alone;
mod contacts;
mod copies;
mod ground;

use alone::{Alone, alone, recorded};
use contacts::solving;
use copies::bandwidth;
use ground::on_the_ground;
use kinetarium::DeviceChoice;
use kinetarium::cuda::Cuda;
use kinetarium::formats::{self, InMemory, Options};
use kinetarium::gpu::Gpu;
use kinetarium::model::examples::{self, Start, bowl, chain, pyramid, towers};
use kinetarium::model::{Model, ModelError};
use kinetarium::numbers::trace::Work;
use kinetarium::rigid::Settings;
use kinetarium::sim::{
    Control, Device, Quantity, Simulation, SimulationError, SimulationSettings, SolverKind, Stage,
};
use std::error::Error;
use std::time::Instant;

const HUMANOID: &str = include_str!("../../session/models/humanoid.xml");
const WORLDS: [usize; 5] = [1, 64, 1024, 8192, 65536];
/// Measured so many times, for at least so long [s] each.
const REPETITIONS: usize = 5;
const SECONDS: f64 = 0.1;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let option = |name: &str| {
        let at = arguments.iter().position(|a| a == name)?;
        arguments.get(at + 1)
    };
    let choice: DeviceChoice = option("--device").map_or("auto", |name| name).parse()?;
    let counts: Vec<_> = option("--worlds").map_or(Ok(WORLDS.to_vec()), |counts| {
        counts.split(',').map(str::parse).collect()
    })?;
    let only = option("--only").map_or("", |only| only);
    let open = |name: &str| {
        let Ok(choice) = name.parse();
        Gpu::open(&choice)
    };
    match choice {
        DeviceChoice::Processor => Err("name a graphics card".into()),
        DeviceChoice::Card(name) => measure(&open(&name)?, &counts, only),
        DeviceChoice::Cuda(number) => measure(&Cuda::open(number)?, &counts, only),
        DeviceChoice::Auto => match Cuda::open(0) {
            Ok(card) => measure(&card, &counts, only),
            Err(_) => measure(&open("")?, &counts, only),
        },
    }
}

fn measure<C: piles::Card + Device<f32>>(
    card: &C,
    counts: &[usize],
    only: &str,
) -> Result<(), Box<dyn Error>> {
    let bandwidth = bandwidth(card)?;
    println!(
        "{}: world-steps per second, medians of {REPETITIONS}. It copies {:.0} GB/s, read and written.\n",
        Device::name(card),
        bandwidth * 1e-9
    );
    println!(
        "| scene | worlds | many steps a call | one, torques set, joints read | reports of everything, read \
         | first step | bytes a world | operations a step | bytes moved a step | GB/s | of a copy's |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|");
    let files = InMemory::new([("humanoid.xml", HUMANOID)]);
    let humanoid = formats::parse(HUMANOID, "humanoid.xml", &files, &Options::default())?.model;
    let scenes = [
        ("chain of 10", damped_chain(10)?, 0.002),
        ("chain of 30", damped_chain(30)?, 0.002),
        (
            "humanoid on the ground",
            on_the_ground(humanoid.clone())?,
            0.003,
        ),
        ("humanoid, all contacts", humanoid, 0.003),
    ];
    for (name, model, time_step) in scenes.clone() {
        if name.starts_with(only) {
            table(card, bandwidth, (name, &model, time_step), counts)?;
        }
    }
    println!("\nKernels by themselves, launched one after the other; medians of {REPETITIONS}.\n");
    println!("| scene | worlds | kernel | microseconds | bytes a world | GB/s | of a copy's |");
    println!("|---|--:|---|--:|--:|--:|--:|");
    for (name, model, time_step) in scenes {
        let most = counts.iter().max().filter(|_| name.starts_with(only));
        if let Some(count) = most {
            let worlds = started(card, &model, &Settings::new(time_step), *count)?;
            kernels(card, bandwidth, name, worlds)?;
        }
    }
    large_piles(card, bandwidth, only)?;
    many_piles(card, bandwidth, only, counts)
}

/// Each kernel of worlds of robots that have fallen.
fn kernels(
    card: &dyn Device<f32>,
    bandwidth: f64,
    name: &str,
    mut worlds: Simulation<f32>,
) -> Result<(), Box<dyn Error>> {
    let count = worlds.worlds();
    worlds.try_step(FALL)?;
    for Alone {
        kernel,
        seconds,
        bytes,
    } in alone(card, &mut worlds)?
    {
        let speed = (count as u64 * bytes) as f64 / seconds;
        println!(
            "| {name} | {count} | {kernel} | {:.1} | {bytes} | {:.1} | {:.0} % |",
            1e6 * seconds,
            speed * 1e-9,
            100.0 * speed / bandwidth,
        );
    }
    Ok(())
}

fn large_piles(card: &dyn Device<f32>, bandwidth: f64, only: &str) -> Result<(), Box<dyn Error>> {
    println!(
        "\nOne world of many bodies that touch, steps per second; of these, left to the processor.\n"
    );
    println!("| pile | bodies | steps per second | left | first step |");
    println!("|---|--:|--:|--:|--:|");
    let mut stages = Vec::new();
    for model in [towers(100, 10)?, towers(1000, 10)?, bowl(10_000)?] {
        if model.name.starts_with(only) {
            let figures = pile(card, &model)
                .unwrap_or_else(|told| (format!("{told} | | |"), Stages::default()));
            println!("| {} | {} | {}", model.name, model.bodies.len(), figures.0);
            stages.push((model.name.clone(), figures.1));
        }
    }
    print_stages(bandwidth, &stages);
    Ok(())
}

fn many_piles(
    card: &dyn Device<f32>,
    bandwidth: f64,
    only: &str,
    counts: &[usize],
) -> Result<(), Box<dyn Error>> {
    println!("\nMany worlds of few bodies that touch, world-steps per second.\n");
    println!("| pile | worlds | many steps a call | one | left | first step |");
    println!("|---|--:|--:|--:|--:|--:|");
    let mut stages = Vec::new();
    for model in [pyramid(3)?, examples::pile(30)?] {
        for &worlds in counts.iter().filter(|_| model.name.starts_with(only)) {
            let figures = piles(card, &model, worlds)
                .unwrap_or_else(|told| (format!("{told} | | | |"), Stages::default()));
            println!("| {} | {worlds} | {}", model.name, figures.0);
            stages.push((format!("{worlds} of {}", model.name), figures.1));
        }
    }
    print_stages(bandwidth, &stages);
    Ok(())
}

fn print_stages(bandwidth: f64, piles: &[(String, Stages)]) {
    println!(
        "\nThe stages of a step, by the card's clock, in microseconds (launches); and what tells of it.\n"
    );
    for (
        pile,
        Stages {
            step,
            told,
            solving,
        },
    ) in piles
    {
        let all: f64 = step.iter().map(|stage| stage.seconds).sum();
        let [step, told] = [step, told].map(|stages| {
            let each = stages
                .iter()
                .map(|it| format!("{} {:.1} ({})", it.name, 1e6 * it.seconds, it.launches));
            Vec::from_iter(each).join(", ")
        });
        println!("- {pile}: {:.1}: {step}. {told}.", 1e6 * all);
        for (name, bytes, seconds) in solving {
            let speed = bytes / seconds;
            println!(
                "  - {name} moves {:.2} MB, at {:.0} GB/s, {:.1} % of a copy's",
                bytes * 1e-6,
                speed * 1e-9,
                100.0 * speed / bandwidth
            );
        }
    }
}

/// Steps before a pile is measured: in these it comes to rest, or most of it.
const SETTLING: usize = 250;

/// Steps before worlds are measured: in these robots have fallen.
const FALL: usize = 400;

/// What stages of a step take, and what tells of all worlds; and what solving contacts moves in a step [B], and takes [s].
#[derive(Default)]
struct Stages {
    step: Vec<Stage>,
    told: Vec<Stage>,
    solving: Vec<(&'static str, f64, f64)>,
}
/// Steps that are timed stage by stage.
const TIMED: usize = 32;

/// Steps per second, the share left to the processor, and how long the first step takes; and what the stages of a step
/// take [s].
fn pile(card: &dyn Device<f32>, model: &Model) -> Result<(String, Stages), SimulationError> {
    let (mut world, first) = settled(card, model, 1)?;
    let (steps, share) = pace(&mut world, |world, n| world.try_step(n).map(|_| ()))?;
    let figures = format!("{steps:.3e} | {share:.1} % | {first:.2} s |");
    Ok((figures, stages(&mut world)?))
}

fn stages(worlds: &mut Simulation<f32>) -> Result<Stages, SimulationError> {
    let (_, all) = worlds.time_stages(|worlds| worlds.try_step(TIMED).map(|_| ()))?;
    let of_step = |stage: Stage| Stage {
        seconds: stage.seconds / TIMED as f64,
        launches: stage.launches / TIMED as u64,
        ..stage
    };
    let step = Vec::from_iter(all.into_iter().map(of_step));
    let (_, told) = worlds.time_stages(|worlds| worlds.try_outputs().map(|_| ()))?;
    let moved = solving(worlds)?;
    let solving = moved.into_iter().filter_map(|(name, bytes)| {
        let stage = step.iter().find(|stage| stage.name == name)?;
        Some((name, bytes, stage.seconds))
    });
    Ok(Stages {
        solving: solving.collect(),
        step,
        told,
    })
}

/// World-steps per second, in calls of many and of one, the share left to the processor, and how long the first step
/// takes; and what the stages of a step of all worlds take [s].
fn piles(
    card: &dyn Device<f32>,
    model: &Model,
    count: usize,
) -> Result<(String, Stages), SimulationError> {
    let (mut worlds, first) = settled(card, model, count)?;
    let (many, share) = pace(&mut worlds, |worlds, n| worlds.try_step(n).map(|_| ()))?;
    let (single, _) = pace(&mut worlds, |worlds, n| {
        (0..n).try_for_each(|_| worlds.try_step(1).map(|_| ()))
    })?;
    let [many, single] = [many, single].map(|rate| rate * count as f64);
    let share = share / count as f64;
    let figures = format!("{many:.3e} | {single:.3e} | {share:.1} % | {first:.2} s |");
    Ok((figures, stages(&mut worlds)?))
}

/// Worlds of a pile that has come to rest, or most of it, each thrown by another speed; and how long the first step took [s].
fn settled(
    card: &dyn Device<f32>,
    model: &Model,
    count: usize,
) -> Result<(Simulation<f32>, f64), SimulationError> {
    let settings = SimulationSettings {
        solver: SolverKind::Impulse,
        ..SimulationSettings::new(count, 0.004)
    };
    let mut worlds = Simulation::on(card, model.clone(), settings)?;
    for world in 1..count {
        let mut velocity = vec![0.0; model.degrees_of_freedom()];
        velocity
            .iter_mut()
            .step_by(6)
            .for_each(|v| *v = 0.01 * (world % 50) as f64);
        worlds.set_joint_state(world, &model.initial_position(), &velocity)?;
    }
    let begin = Instant::now();
    worlds.try_step(1)?;
    let first = begin.elapsed().as_secs_f64();
    worlds.try_step(SETTLING)?;
    Ok((worlds, first))
}

/// Steps per second, and the share [%] of one world's that was left to the processor.
fn pace(
    worlds: &mut Simulation<f32>,
    run: impl FnMut(&mut Simulation<f32>, usize) -> Result<(), SimulationError>,
) -> Result<(f64, f64), SimulationError> {
    let (before, time) = (worlds.left_to_processor(), worlds.time(0));
    let steps = rate(worlds, run)?;
    let left = (worlds.left_to_processor() - before) as f64;
    let taken = (worlds.time(0) - time) / worlds.settings().step.time_step;
    Ok((steps, 100.0 * left / taken))
}

/// A chain with damping [N·m·s/rad], without which one that is driven for long whips about until it diverges: worlds that
/// stand still would be measured.
fn damped_chain(links: usize) -> Result<Model, ModelError> {
    let mut parts = chain(links, Start::Horizontal)?.into_parts();
    let dofs = parts.joints.iter_mut().flat_map(|joint| &mut joint.dofs);
    dofs.for_each(|dof| dof.damping = 0.2);
    Model::new(parts)
}

fn table(
    card: &dyn Device<f32>,
    bandwidth: f64,
    (name, model, time_step): (&str, &Model, f64),
    counts: &[usize],
) -> Result<(), Box<dyn Error>> {
    for &count in counts {
        let mut worlds = started(card, model, &Settings::new(time_step), count)?;
        let begin = Instant::now();
        worlds.try_step(1)?;
        let first = begin.elapsed().as_secs_f64();
        worlds.try_step(FALL)?;
        let steps = rate(&mut worlds, |worlds, n| worlds.try_step(n).map(|_| ()))?;
        let torques = torques(model, count);
        let mut positions = vec![0.0; count * model.coordinates()];
        let mut velocities = torques.clone();
        let learned = rate(&mut worlds, |worlds, n| {
            (0..n).try_for_each(|_| {
                worlds.controls().write(Control::Force, &torques)?;
                worlds.try_step(1)?;
                worlds.read(Quantity::JointPosition, &mut positions)?;
                worlds.read(Quantity::JointVelocity, &mut velocities)
            })
        })?;
        let reports = rate(&mut worlds, |worlds, n| {
            (0..n).try_for_each(|_| {
                worlds.controls();
                worlds.try_outputs().map(|_| ())
            })
        })?;
        let diverged = worlds.diverged().len();
        if diverged > 0 {
            return Err(format!("{name}: {diverged} of {count} worlds have diverged").into());
        }
        let (bytes, work) = work(&mut worlds)?;
        let moved = (work.loads + work.stores) * size_of::<f32>() as u64;
        let speed = steps * count as f64 * moved as f64;
        println!(
            "| {name} | {count} | {:.3e} | {:.3e} | {:.3e} | {first:.2} s | {bytes} | {} | {moved} | {:.1} | {:.0} % |",
            steps * count as f64,
            learned * count as f64,
            reports * count as f64,
            work.operations,
            speed * 1e-9,
            100.0 * speed / bandwidth,
        );
    }
    Ok(())
}

/// Bytes of a world in the card's memory, with those of its scratch, which worlds beyond 65,536 share; and what a step of
/// world 0 takes, as it is now.
fn work(worlds: &mut Simulation<f32>) -> Result<(usize, Work), Box<dyn Error>> {
    let (programs, mut world) = recorded(worlds)?;
    let l = programs.lengths;
    let bytes = (l.state + l.input + l.output + l.scratch) * size_of::<f32>();
    Ok((bytes, world.work(&programs, &programs.step)?))
}

/// Of all degrees of freedom of all worlds [N or N·m], all different.
fn torques(model: &Model, worlds: usize) -> Vec<f32> {
    let dofs = model.degrees_of_freedom();
    let of_world = |world| (0..dofs).map(move |dof| (world as f32 + 0.7 * dof as f32).sin());
    (0..worlds).flat_map(of_world).collect()
}

/// Worlds that begin alike, with torques that differ.
fn started(
    card: &dyn Device<f32>,
    model: &Model,
    settings: &Settings,
    worlds: usize,
) -> Result<Simulation<f32>, SimulationError> {
    let settings = SimulationSettings {
        solver: SolverKind::Featherstone,
        step: *settings,
        ..SimulationSettings::new(worlds, settings.time_step)
    };
    let mut simulation = Simulation::on(card, model.clone(), settings)?;
    simulation
        .controls()
        .write(Control::Force, &torques(model, worlds))?;
    Ok(simulation)
}

/// Median number of calls' work per second.
fn rate(
    simulation: &mut Simulation<f32>,
    mut run: impl FnMut(&mut Simulation<f32>, usize) -> Result<(), SimulationError>,
) -> Result<f64, SimulationError> {
    let mut timed = |simulation: &mut Simulation<f32>, n: usize| {
        let begin = Instant::now();
        run(simulation, n)?;
        Ok::<_, SimulationError>(begin.elapsed().as_secs_f64())
    };
    let mut n = 1;
    while timed(simulation, n)? < SECONDS {
        n *= 2;
    }
    let mut rates = Vec::new();
    for _ in 0..REPETITIONS {
        rates.push(n as f64 / timed(simulation, n)?);
    }
    rates.sort_by(f64::total_cmp);
    Ok(rates[REPETITIONS / 2])
}
