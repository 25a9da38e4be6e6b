//! What runs on a card is the kernel that runs on the CPU, to rounding.
//!
//! On whatever card there is, or on the program that `KINETARIUM_GPU` names, such as Mesa's `llvmpipe`.

extern crate rigid as kinetarium_rigid;

#[path = "../../rigid/tests/scene/mod.rs"]
mod scene;

use kinetarium_gpu::{Choice, Gpu, GpuError, Report, Worlds};
use model::Model;
use model::examples::{Start, chain};
use numbers::Memory;
use rigid::{Featherstone, Integrator, Kernels, Settings, TouchingFeatherstone, Xpbd, body};
use scene::{World, heap, looped, mixed, parameters};
use std::ops::Range;

const H: f64 = 0.002;

fn card() -> Gpu {
    let name = std::env::var("KINETARIUM_GPU").unwrap_or_default();
    Gpu::open(&name.parse().unwrap()).unwrap()
}

/// Worlds in motion, each a little faster than the one before; and the same on a card.
struct Pair<'k, K> {
    kernels: &'k K,
    parameters: Vec<f32>,
    cpu: Vec<World<f32>>,
    gpu: Worlds,
}

impl<'k, K: Kernels> Pair<'k, K> {
    fn new(card: &Gpu, kernels: &'k K, model: &Model, worlds: usize) -> Self {
        let mut cpu = vec![World::new(kernels, model); worlds];
        let force = rigid::InputTables::new(model).force;
        for (w, world) in cpu.iter_mut().enumerate() {
            world.input[force.at(0, 0)] += 0.1 * (w % 8) as f32;
        }
        let mut gpu = Worlds::new(card, kernels, worlds).unwrap();
        let lengths = kernels.lengths();
        gpu.write_input(&memory(&cpu, lengths.input, gpu.width(), |w| &w.input));
        let mut pair = Self {
            kernels,
            parameters: parameters(kernels),
            cpu,
            gpu,
        };
        pair.put();
        pair
    }
    /// Brings the worlds on the card to the state of those on the CPU.
    fn put(&mut self) {
        let length = self.kernels.lengths().state;
        let state = memory(&self.cpu, length, self.gpu.width(), |w| &w.state);
        self.gpu.write_state(&state);
    }
    fn step(&mut self, steps: usize) {
        for world in &mut self.cpu {
            for _ in 0..steps {
                let mut cpu = world.cpu(&self.parameters, self.kernels.links());
                self.kernels.step_in_parts(&mut cpu);
            }
        }
        self.gpu.step(steps).unwrap();
    }
    fn report(&mut self) {
        for world in &mut self.cpu {
            let mut cpu = world.cpu(&self.parameters, self.kernels.links());
            self.kernels.report(&mut cpu);
        }
        self.gpu.report(Report::Everything).unwrap();
    }
    fn state(&self) -> Memory<f32> {
        let length = self.kernels.lengths().state;
        let mut state = Memory::new(self.cpu.len(), length, self.gpu.width());
        self.gpu.read_state(0..length, &mut state).unwrap();
        state
    }
    fn output(&self) -> Memory<f32> {
        let length = self.kernels.lengths().output;
        let mut output = Memory::new(self.cpu.len(), length, self.gpu.width());
        self.gpu.read_output(0..length, &mut output).unwrap();
        output
    }
    /// How far the states are apart.
    fn apart(&self) -> f64 {
        let all = 0..self.kernels.lengths().state;
        apart(all, &self.cpu, &self.state(), |world| &world.state)
    }
}

fn memory(
    worlds: &[World<f32>],
    length: usize,
    width: usize,
    numbers: impl Fn(&World<f32>) -> &Vec<f32>,
) -> Memory<f32> {
    let mut memory = Memory::new(worlds.len(), length.max(1), width);
    for (w, world) in worlds.iter().enumerate() {
        for (i, x) in numbers(world).iter().enumerate() {
            memory.set(w, i, *x);
        }
    }
    memory
}

/// The largest difference of some numbers, in parts of the larger of a number and 1.
fn apart(
    range: Range<usize>,
    cpu: &[World<f32>],
    gpu: &Memory<f32>,
    numbers: impl Fn(&World<f32>) -> &Vec<f32>,
) -> f64 {
    let mut most = 0.0_f64;
    for (w, world) in cpu.iter().enumerate() {
        for i in range.clone() {
            let (x, y) = (f64::from(numbers(world)[i]), f64::from(gpu.get(w, i)));
            let difference = (x - y).abs() / x.abs().max(1.0);
            assert!(!difference.is_nan(), "number {i} of world {w}: {x}, {y}");
            most = most.max(difference);
        }
    }
    most
}

/// One step within `once`, bodies after a hundred, and the whole report of one state.
fn agrees(card: &Gpu, kernels: &impl Kernels, model: &Model, once: f64) {
    let mut pair = Pair::new(card, kernels, model, 5);
    pair.step(1);
    let name = format!("{} of {}", kernels.name(), model.name);
    let apart_once = pair.apart();
    assert!(apart_once < once, "{name}: {apart_once:e} after a step");
    pair.step(99);
    pair.report();
    let table = kernels.outputs().body;
    for id in 0..model.bodies.len() {
        let pose = table.at(id, body::POSITION)..table.at(id, body::VELOCITY);
        let moved = apart(pose, &pair.cpu, &pair.output(), |world| &world.output);
        assert!(moved < 1e-3, "{name}: body {id} is {moved:e} off after 100");
    }
    pair.put();
    pair.report();
    let all = 0..kernels.lengths().output;
    let reported = apart(all, &pair.cpu, &pair.output(), |world| &world.output);
    // Sums of forces in which most cancels.
    assert!(reported < 1e-3, "{name}: {reported:e} in the report");
}

fn settings(integrator: Integrator) -> Settings {
    Settings {
        integrator,
        ..Settings::new(H)
    }
}

#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn articulated_bodies_agree_with_the_cpu() {
    let card = card();
    for model in [chain(6, Start::Horizontal), mixed(true)] {
        let model = model.unwrap();
        for integrator in [
            Integrator::SemiImplicitEuler,
            Integrator::ExplicitEuler,
            Integrator::Verlet,
            Integrator::RungeKutta4,
        ] {
            let kernels = Featherstone::new(&model, &settings(integrator)).unwrap();
            agrees(&card, &kernels, &model, 1e-5);
        }
    }
}

#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn position_based_dynamics_agrees_with_the_cpu() {
    let card = card();
    for model in [chain(6, Start::Horizontal), mixed(false), looped()] {
        let model = model.unwrap();
        // Velocities take up corrections of positions over h, and with them their rounding.
        let once = 1e-5 + 2.0 * f64::from(f32::EPSILON) / H;
        let kernels = Xpbd::new(&model, &Settings::new(H)).unwrap();
        agrees(&card, &kernels, &model, once);
    }
}

/// Bodies that touch part ways, as rounding decides who slips first: a step agrees, and where they come to rest.
fn rests_alike(card: &Gpu, kernels: &impl Kernels, model: &Model) {
    let mut pair = Pair::new(card, kernels, model, 3);
    let table = kernels.outputs().body;
    let bodies = table.start()..table.at(model.bodies.len(), 0);
    // The fall, and the first touches.
    for step in 0..100 {
        pair.put();
        pair.step(1);
        pair.report();
        let output = pair.output();
        let apart = apart(bodies.clone(), &pair.cpu, &output, |world| &world.output);
        assert!(
            apart < 1e-3,
            "{}: {apart:e} after step {step}",
            kernels.name()
        );
    }
    pair.step(1400);
    pair.report();
    let (output, alive) = (pair.output(), kernels.alive());
    for (w, world) in pair.cpu.iter().enumerate() {
        assert_eq!(pair.state().get(w, alive), 1.0);
        for id in 0..model.bodies.len() {
            let at = table.at(id, body::POSITION + 1);
            let (cpu, gpu) = (world.output[at], output.get(w, at));
            assert!(
                (cpu - gpu).abs() < 0.01 * cpu.abs().max(0.1),
                "{} body {id} of world {w} rests at {cpu} m, on the card at {gpu} m",
                kernels.name()
            );
        }
    }
}

#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn bodies_that_touch_come_to_rest_as_on_the_cpu() {
    let (card, model) = (card(), heap().unwrap());
    let kernels = TouchingFeatherstone::new(&model, &Settings::new(H)).unwrap();
    rests_alike(&card, &kernels, &model);
    let kernels = Xpbd::touching(&model, &Settings::new(H)).unwrap();
    rests_alike(&card, &kernels, &model);
}

/// More worlds than one buffer holds.
#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn worlds_beyond_one_buffer_lie_in_several() {
    let (card, model) = (card(), chain(50, Start::Horizontal).unwrap());
    let kernels = Featherstone::new(&model, &Settings::new(H)).unwrap();
    let l = kernels.lengths();
    let longest = [l.state, l.input, l.output, l.scratch]
        .into_iter()
        .max()
        .unwrap();
    let widest = card.most_bytes() as usize / size_of::<f32>() / longest;
    let worlds = 2 * widest + 1;
    if worlds > 100_000 {
        // A card that takes buffers so large holds what anybody simulates in one.
        return;
    }
    let mut pair = Pair::new(&card, &kernels, &model, worlds);
    assert_eq!(worlds.div_ceil(pair.gpu.width()), 3);
    let angles = kernels.position_table().start()..kernels.velocity_table().start();
    for (w, world) in pair.cpu.iter_mut().enumerate() {
        world.state[angles.start] += 1e-3 * (w % 1000) as f32;
    }
    pair.put();
    pair.step(1);
    let apart = apart(angles, &pair.cpu, &pair.state(), |world| &world.state);
    // Neighbours are ten times as far apart.
    assert!(apart < 1e-4, "{apart:e}");
}

#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn a_world_that_diverges_stops_and_harms_no_other() {
    let (card, model) = (card(), mixed(false).unwrap());
    let kernels = Featherstone::new(&model, &Settings::new(H)).unwrap();
    let mut pair = Pair::new(&card, &kernels, &model, 3);
    let force = rigid::InputTables::new(&model).force;
    pair.cpu[1].input[force.at(3, 0)] = f32::MAX;
    let length = kernels.lengths().input;
    let input = memory(&pair.cpu, length, pair.gpu.width(), |w| &w.input);
    pair.gpu.write_input(&input);
    pair.step(50);
    let state = pair.state();
    let alive = |w| state.get(w, kernels.alive());
    assert_eq!([alive(0), alive(1), alive(2)], [1.0, 0.0, 1.0]);
    let apart = pair.apart();
    assert!(apart < 1e-3, "{apart:e}");
}

#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn worlds_can_have_constants_of_their_own() {
    let (card, model) = (card(), mixed(true).unwrap());
    let lighter = {
        let mut parts = (*model).clone();
        parts.gravity *= 0.5;
        Model::new(parts).unwrap()
    };
    let step = Settings::new(H);
    let kernels = Featherstone::new(&model, &step).unwrap();
    let other = Featherstone::new(&lighter, &step).unwrap();
    let mut pair = Pair::new(&card, &kernels, &model, 2);
    let own = [parameters::<f32>(&kernels), parameters::<f32>(&other)];
    let mut all = Memory::new(2, own[0].len(), pair.gpu.width());
    for (w, numbers) in own.iter().enumerate() {
        for (i, x) in numbers.iter().enumerate() {
            all.set(w, i, *x);
        }
    }
    pair.gpu.write_parameters(&all).unwrap();
    pair.gpu.step(20).unwrap();
    for (world, numbers) in pair.cpu.iter_mut().zip(&own) {
        for _ in 0..20 {
            kernels.step_in_parts(&mut world.cpu(numbers, kernels.links()));
        }
    }
    let apart = pair.apart();
    assert!(apart < 1e-4, "{apart:e}");
    assert_ne!(pair.cpu[0].state, pair.cpu[1].state);
}

#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn a_kernel_is_compiled_once_for_a_card() {
    let (card, model) = (card(), chain(6, Start::Horizontal).unwrap());
    let kernels = Featherstone::new(&model, &Settings::new(H)).unwrap();
    for worlds in [1, 7] {
        let mut some = Worlds::new(&card, &kernels, worlds).unwrap();
        some.step(40).unwrap();
        some.report(Report::Motion).unwrap();
    }
    assert_eq!(card.compiled(), 2);
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
