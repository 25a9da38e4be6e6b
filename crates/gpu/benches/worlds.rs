//! World-steps per second on a graphics card, as a Markdown table.
//!
//! `cargo xtask gpu-bench`, or the program that it built, which needs nothing but the card's driver:
//! `worlds [--card NAME] [--most WORLDS]`. Without a name any card is taken, but no program that stands in for one.

use formats::{InMemory, Options};
use kinetarium_gpu::{Choice, Gpu, GpuError, Report, Worlds};
use model::Model;
use model::examples::{Start, chain};
use numbers::Memory;
use rigid::{Featherstone, InputTables, Kernels, Settings, TouchingFeatherstone};
use std::error::Error;
use std::time::Instant;

const HUMANOID: &str = include_str!("../../session/models/humanoid.xml");
const WORLDS: [usize; 5] = [1, 64, 1024, 8192, 65536];
/// Measured so many times, for at least so long [s] each.
const REPETITIONS: usize = 5;
const SECONDS: f64 = 0.2;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let option = |name: &str| {
        let at = arguments.iter().position(|a| a == name)?;
        arguments.get(at + 1)
    };
    let name = option("--card").map_or("", |name| name);
    let most = option("--most").map_or(Ok(usize::MAX), |most| most.parse())?;
    let card = Gpu::open(&name.parse::<Choice>()?)?;
    println!(
        "{}: world-steps per second, medians of {REPETITIONS}.\n",
        card.name()
    );
    println!(
        "| scene | worlds | steps | first step | bytes a world | reports, of motion | of everything |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|");
    for links in [10, 30] {
        let model = chain(links, Start::Horizontal)?;
        let kernels = Featherstone::new(&model, &Settings::new(0.002))?;
        table(&card, &model, &kernels, most)?;
    }
    let files = InMemory::new([("humanoid.xml", HUMANOID)]);
    let humanoid = formats::parse(HUMANOID, "humanoid.xml", &files, &Options::default())?.model;
    let kernels = TouchingFeatherstone::new(&humanoid, &Settings::new(0.003))?;
    table(&card, &humanoid, &kernels, most)?;
    Ok(())
}

fn table(
    card: &Gpu,
    model: &Model,
    kernels: &impl Kernels,
    most: usize,
) -> Result<(), Box<dyn Error>> {
    for count in WORLDS.into_iter().filter(|count| *count <= most) {
        let mut worlds = started(card, model, kernels, count)?;
        let begin = Instant::now();
        worlds.step(1)?;
        finish(&worlds, kernels)?;
        let first = begin.elapsed().as_secs_f64();
        let steps = rate(&mut worlds, kernels, |worlds, n| worlds.step(n))?;
        let mut reported = |report| {
            let each = |worlds: &mut Worlds, n| (0..n).try_for_each(|_| worlds.report(report));
            rate(&mut worlds, kernels, each)
        };
        let (motion, everything) = (reported(Report::Motion)?, reported(Report::Everything)?);
        println!(
            "| {} | {count} | {:.3e} | {first:.2} s | {} | {:.3e} | {:.3e} |",
            model.name,
            steps * count as f64,
            worlds.bytes() / count as u64,
            motion * count as f64,
            everything * count as f64,
        );
    }
    Ok(())
}

/// Worlds that begin alike, with torques that differ.
fn started(
    card: &Gpu,
    model: &Model,
    kernels: &impl Kernels,
    count: usize,
) -> Result<Worlds, GpuError> {
    let mut worlds = Worlds::new(card, kernels, count)?;
    let (lengths, width) = (kernels.lengths(), worlds.width());
    let at_rest = vec![0.0; model.degrees_of_freedom()];
    let start = kernels.initial(model, &model.initial_position(), &at_rest);
    let mut state = Memory::new(count, lengths.state, width);
    for (i, x) in start.iter().enumerate() {
        state.fill(i, *x as f32);
    }
    let tables = InputTables::new(model);
    let mut input = Memory::new(count, lengths.input.max(1), width);
    for (i, x) in tables.initial(model).iter().enumerate() {
        input.fill(i, *x as f32);
    }
    for world in 0..count {
        for dof in 0..model.degrees_of_freedom() {
            let torque = (world as f32 + 0.7 * dof as f32).sin();
            input.set(world, tables.force.at(dof, 0), torque);
        }
    }
    worlds.write_state(&state);
    worlds.write_input(&input);
    Ok(worlds)
}

/// Waits until the card has done all that it was asked for.
fn finish(worlds: &Worlds, kernels: &impl Kernels) -> Result<(), GpuError> {
    let length = kernels.lengths().state;
    let mut state = Memory::new(worlds.worlds(), length, worlds.width());
    let alive = kernels.alive();
    worlds.read_state(alive..alive + 1, &mut state)
}

/// Median number of calls' work per second.
fn rate(
    worlds: &mut Worlds,
    kernels: &impl Kernels,
    mut run: impl FnMut(&mut Worlds, usize) -> Result<(), GpuError>,
) -> Result<f64, GpuError> {
    let mut timed = |worlds: &mut Worlds, n: usize| -> Result<f64, GpuError> {
        let begin = Instant::now();
        run(worlds, n)?;
        finish(worlds, kernels)?;
        Ok(begin.elapsed().as_secs_f64())
    };
    let mut n = 1;
    while timed(worlds, n)? < SECONDS {
        n *= 2;
    }
    let mut rates = Vec::new();
    for _ in 0..REPETITIONS {
        rates.push(n as f64 / timed(worlds, n)?);
    }
    rates.sort_by(f64::total_cmp);
    Ok(rates[REPETITIONS / 2])
}
