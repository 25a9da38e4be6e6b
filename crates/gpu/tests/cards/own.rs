//! What wgpu alone has: buffers that are too small for all worlds, cards that are named.

use crate::card::{card, small};
use crate::pair::Pair;
use crate::worlds::{H, settings};
use ::piles::Card as _;
use kinetarium_gpu::{Choice, Gpu, GpuError, Worlds};
use model::Model;
use model::examples::{Start, chain};
use numbers::Memory;
use records::Programs;
use rigid::{Featherstone, Kernels, Lengths, Settings, Solver};
use sim::{DeviceWorlds, Simulation, SimulationSettings, SolverKind};
use std::process::Command;

#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn worlds_beyond_one_buffer_lie_in_several() {
    let (card, model) = (small(1 << 23), chain(50, Start::Horizontal).unwrap());
    let kernels = Featherstone::new(&model, &Settings::new(H)).unwrap();
    let widest = card.most_bytes() as usize / size_of::<f32>() / kernels.lengths().longest();
    let worlds = 2 * widest + 1;
    let programs = Programs::record(Solver::Featherstone(&kernels)).unwrap();
    let told = Worlds::new(&small(1 << 12), programs.clone(), 1).unwrap_err();
    assert!(matches!(told, GpuError::TooLarge { .. }), "{told}");
    let width = Worlds::new(&card, programs, worlds);
    assert_eq!(worlds.div_ceil(width.unwrap().width()), 3);
    let mut pair = Pair::new(&card, &model, settings(worlds));
    let start = pair.cpu.model().initial_position();
    // Of each part, and some worlds that are set again by themselves.
    for round in [1.0, 2.0] {
        let every = if round == 1.0 { 1 } else { widest / 3 };
        for simulation in pair.both() {
            for world in (0..worlds).step_by(every) {
                let mut position = start.clone();
                position[0] += round * 1e-3 * (world % 1000) as f64;
                let velocity = vec![0.0; position.len()];
                simulation
                    .set_joint_state(world, &position, &velocity)
                    .unwrap();
            }
        }
        pair.step(1);
        let moved = pair.moved_apart();
        // Neighbours are ten times as far apart.
        assert!(moved < 1e-4, "{moved:e}");
    }
}

/// Scratch that does not last for a workgroup lasts for parts of fewer worlds.
#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn worlds_of_much_scratch_lie_in_narrow_parts() {
    let model = chain(6, Start::Horizontal).unwrap();
    let kernels = Featherstone::new(&model, &Settings::new(H)).unwrap();
    let lengths = kernels.lengths();
    assert!(lengths.longest() < lengths.scratch);
    let card = small((10 * lengths.scratch * size_of::<f32>()) as u64);
    let programs = Programs::record(Solver::Featherstone(&kernels)).unwrap();
    assert_eq!(Worlds::new(&card, programs, 25).unwrap().width(), 9);
    let mut pair = Pair::new(&card, &model, settings_apart(25));
    pair.step(5);
    let apart = pair.apart();
    assert!(apart < 1e-4, "{apart:e}");
}

/// Of worlds in which nothing touches.
fn settings_apart(worlds: usize) -> SimulationSettings {
    SimulationSettings {
        contacts: false,
        ..settings(worlds)
    }
}

/// Constants of worlds' own take more room than what all worlds share. What is refused leaves all as it was.
#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn constants_of_worlds_own_that_do_not_fit_are_refused() {
    const WORLDS: usize = 512;
    let model = chain(6, Start::Horizontal).unwrap();
    let kernels = Featherstone::new(&model, &Settings::new(H)).unwrap();
    let [longest, constants] = [kernels.lengths().longest(), kernels.parameters().len()];
    assert!(longest < constants);
    let between = WORLDS / 2 * (longest + constants);
    let card = small((between * size_of::<f32>()) as u64);
    let mut pair = Pair::new(&card, &model, settings_apart(WORLDS));
    pair.step(5);
    let mut parts = (*model).clone();
    parts.gravity *= 0.5;
    let lighter = Model::new(parts).unwrap();
    for _ in 0..2 {
        let told = pair.gpu.set_world_model(1, &lighter).unwrap_err();
        assert!(
            told.to_string().contains("constants of their own"),
            "{told}"
        );
        pair.step(5);
        let apart = pair.apart();
        assert!(apart < 1e-4, "{apart:e}");
    }
}

/// What is larger than a buffer may be is refused before it is asked for: the card would take it for a failure.
#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn what_no_buffer_takes_is_refused() {
    let (card, model) = (small(1 << 20), chain(3, Start::Horizontal).unwrap());
    let kernels = Featherstone::new(&model, &Settings::new(H)).unwrap();
    let programs = Programs::record(Solver::Featherstone(&kernels)).unwrap();
    let (mut constants, mut links) = (programs.clone(), programs);
    constants.parameters.resize(1 << 19, 0.0);
    links.links.resize(1 << 19, 0);
    for programs in [constants, links] {
        let told = Worlds::new(&card, programs, 1).unwrap_err();
        assert!(matches!(told, GpuError::TooLarge { .. }), "{told}");
    }
    let told = card.buffer(1 << 60).unwrap_err().to_string();
    assert!(told.contains("memory"), "{told}");
    let mut few = Simulation::on(&card, model, settings(2)).unwrap();
    few.try_step(1).unwrap();
    assert!(few.diverged().is_empty());
}

/// Of a part, more worlds are set at once than a launch has invocations.
#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn millions_of_worlds_are_set_at_once() {
    const SET: usize = 64 * 65_535 + 1;
    let (card, model) = (card(), chain(1, Start::Horizontal).unwrap());
    let kernels = Featherstone::new(&model, &Settings::new(H)).unwrap();
    let mut programs = Programs::record(Solver::Featherstone(&kernels)).unwrap();
    programs.lengths = Lengths {
        state: 1,
        input: 1,
        output: 1,
        scratch: 1,
    };
    let mut worlds = Worlds::new(&card, programs, SET + 1).unwrap();
    assert_eq!(worlds.width(), SET + 1);
    let [mut given, mut found] = [1.0, 0.0].map(|x| {
        let mut memory = Memory::new(SET + 1, 1, 16);
        memory.fill(0, x);
        memory
    });
    given.set(SET, 0, 2.0);
    let places = Vec::from_iter(1..=SET);
    worlds.write_worlds(&places, &given).unwrap();
    worlds
        .read_state(std::slice::from_ref(&(0..1)), &mut found)
        .unwrap();
    let found = [0, 1, SET - 1, SET].map(|world| found.get(world, 0));
    assert_eq!(found, [0.0, 1.0, 1.0, 2.0]);
}

/// Set where a test runs in a process that has little memory.
const LITTLE: &str = "KINETARIUM_LITTLE_MEMORY";
/// So much: enough for what compiles kernels [KiB].
const LITTLE_MEMORY: usize = 8 << 20;

/// Runs a test in a process of its own that has little memory.
fn in_little_memory(test: &str) {
    let here = std::env::current_exe().unwrap();
    let limited = format!("ulimit -v {LITTLE_MEMORY} && exec \"$0\" --ignored --exact {test}");
    let ran = Command::new("sh")
        .args(["-c", &limited])
        .arg(here)
        .env(LITTLE, "1")
        .output()
        .unwrap();
    let told = [ran.stdout, ran.stderr].map(|out| String::from_utf8_lossy(&out).into_owned());
    let passed = told[0].contains("1 passed");
    assert!(ran.status.success() && passed, "{}", told.concat());
}

/// A card whose memory is full says so, and goes on. What a program has for memory is the machine's: it gets little of it,
/// and so do its callers, so that what steps in what is left is not tried there.
#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn worlds_that_do_not_fit_are_refused() {
    let card = card();
    let is_program = card.name().contains("llvmpipe");
    if is_program && std::env::var_os(LITTLE).is_none() {
        return in_little_memory("own::worlds_that_do_not_fit_are_refused");
    }
    let model = chain(150, Start::Horizontal).unwrap();
    let kernels = Featherstone::new(&model, &Settings::new(H)).unwrap();
    let programs = Programs::record(Solver::Featherstone(&kernels)).unwrap();
    let widest = card.most_bytes() as usize / size_of::<f32>() / kernels.lengths().longest();
    let mut filled = Vec::new();
    let told = loop {
        match Worlds::new(&card, programs.clone(), widest) {
            Ok(worlds) => filled.push(worlds),
            Err(told) => break told,
        }
    };
    assert!(matches!(told, GpuError::Memory { .. }), "{told}");
    let pile = model::examples::towers(100, 10).unwrap();
    let impulse = SimulationSettings {
        solver: SolverKind::Impulse,
        ..SimulationSettings::new(1, 0.004)
    };
    // What little is left may do for some steps.
    if !is_program && let Ok(mut pile) = Simulation::on(&card, pile, impulse) {
        pile.try_step(10).unwrap();
        assert!(pile.diverged().is_empty());
    }
    drop(filled);
    let mut few = Simulation::on(&card, model, settings(2)).unwrap();
    few.try_step(1).unwrap();
    assert!(few.diverged().is_empty());
}

#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn a_card_that_is_not_there_is_refused_with_those_that_are() {
    let name = card().name().to_owned();
    let wanted = Choice::Named("no such card".into());
    let told = Gpu::open(&wanted).unwrap_err();
    assert!(matches!(told, GpuError::NoCard { .. }));
    let bare = name.split(" (").next().unwrap();
    assert!(told.to_string().contains(bare), "{told}");
}
