//! Whole solvers recorded: loops stay loops, the record prints as valid WGSL, and
//! run step by step it keeps the bits of the kernel.

extern crate kinetarium_rigid as rigid;

#[path = "scene/every_gauge.rs"]
mod every_gauge;
mod scene;
#[path = "../../collide/tests/shader/mod.rs"]
mod shader;

use every_gauge::every_gauge;
use kinetarium_rigid::{
    Featherstone, Gauges, InputTables, Instrument, Integrator, Kernels, OutputTables,
    Report::Everything, Reported, Settings, Solver, TouchingFeatherstone, Xpbd,
};
use model::Model;
use model::examples::{Start, chain};
use numbers::trace::{Operations, PrintOptions, Program};
use numbers::{Cpu, Shared};
use records::Programs;
use scene::{World, heap, looped, mixed, parameters};

const INTEGRATORS: [Integrator; 4] = [
    Integrator::SemiImplicitEuler,
    Integrator::ExplicitEuler,
    Integrator::Verlet,
    Integrator::RungeKutta4,
];

/// The articulated-body algorithm with each integrator.
fn featherstones(model: &Model) -> [Featherstone; 4] {
    INTEGRATORS.map(|integrator| {
        let settings = Settings {
            integrator,
            ..Settings::new(0.002)
        };
        Featherstone::new(model, &settings).unwrap()
    })
}

/// Extended position-based dynamics, plain and with all its options.
fn xpbds(model: &Model) -> [Xpbd; 2] {
    let plain = Settings::new(0.002);
    let full = Settings {
        iterations: 3,
        relaxation: 0.9,
        angular_damping: 0.1,
        displacement_cap: 1e-4,
        force_cap: 50.0,
        ..plain
    };
    [plain, full].map(|settings| Xpbd::new(model, &settings).unwrap())
}

fn record(kernels: &impl Kernels) -> Programs {
    Programs::record(Solver::of(kernels).unwrap()).unwrap()
}

/// Of a step and of a report.
fn operations(kernels: &impl Kernels) -> [Operations; 2] {
    let programs = record(kernels);
    [&programs.step, programs.report(Everything)].map(Program::operations)
}

/// Validates a record, with parameters of both kinds.
fn validate(program: &Program) {
    for parameters_per_world in [false, true] {
        let options = PrintOptions {
            parameters_per_world,
            ..PrintOptions::default()
        };
        shader::validate(program, &options);
    }
}

/// What a kernel tells, as bits, every NaN as the same NaN. Of what lies in scratch meanwhile a record keeps some in
/// registers.
fn bits(world: &World<f32>) -> Vec<u32> {
    let canonical = |x: &f32| if x.is_nan() { f32::NAN } else { *x }.to_bits();
    [&world.state, &world.output]
        .into_iter()
        .flatten()
        .map(canonical)
        .collect()
}

/// Steps and reports a world by the kernel and by its record, which must agree to the bit.
fn run(kernels: &impl Kernels, mut world: World<f32>, steps: usize) -> World<f32> {
    let records = record(kernels);
    let (parameters, links) = (parameters(kernels), kernels.links());
    let mut copy = world.clone();
    for round in 0..steps {
        kernels.step_in_parts(&mut world.cpu(&parameters, links));
        records
            .step
            .interpret(&mut copy.cpu(&parameters, links))
            .unwrap();
        kernels.report(&mut world.cpu(&parameters, links));
        records
            .report(Everything)
            .interpret(&mut copy.cpu(&parameters, links))
            .unwrap();
        assert_eq!(
            bits(&world),
            bits(&copy),
            "{} after step {round}",
            kernels.name()
        );
    }
    world
}

/// A record of a chain is as long whatever the chain.
fn loops_stay_loops<K: Kernels, const N: usize>(solvers: fn(&Model) -> [K; N]) {
    let (short, long) = (chain(5, Start::Horizontal), chain(50, Start::Horizontal));
    for (short, long) in solvers(&short.unwrap())
        .iter()
        .zip(&solvers(&long.unwrap()))
    {
        assert_eq!(operations(short), operations(long));
    }
}

/// The records are valid WGSL, and the numbers they read are finite, as a shader may assume.
fn suits_a_shader(kernels: &impl Kernels, model: &Model) {
    let records = record(kernels);
    validate(&records.step);
    validate(records.report(Everything));
    let world = World::<f32>::new(kernels, model);
    let read = [&world.state, &world.input, &parameters(kernels)];
    assert!(read.into_iter().flatten().all(|x| x.is_finite()));
}

/// A moving world keeps its bits and stays alive.
fn keeps_the_bits(kernels: &impl Kernels, model: &Model, steps: usize) {
    let start = World::new(kernels, model);
    let end = run(kernels, start.clone(), steps);
    assert_ne!(start.state, end.state);
    assert_eq!(
        end.state[kernels.alive()],
        1.0,
        "{} diverged",
        kernels.name()
    );
}

/// A world that diverges within a step, by way of NaN, leaves the bodies where they were.
fn stays_when_it_diverges(kernels: &impl Kernels, model: &Model) {
    let outputs = OutputTables::new(model);
    let bodies = outputs.body.start()..outputs.body_acceleration.start();
    let (parameters, links) = (parameters(kernels), kernels.links());
    let mut start = World::<f32>::new(kernels, model);
    kernels.report(&mut start.cpu(&parameters, links));
    let mut world = start.clone();
    world.input[3] = f32::MAX;
    let end = run(kernels, world, 3);
    assert!(
        end.scratch.iter().any(|x| x.is_nan()),
        "the step met no NaN"
    );
    assert_eq!(end.state[kernels.alive()], 0.0);
    assert_eq!(start.output[bodies.clone()], end.output[bodies]);
}

#[test]
fn the_articulated_body_algorithm_stays_in_loops() {
    loops_stay_loops(featherstones);
}

#[test]
fn position_based_dynamics_stays_in_loops() {
    loops_stay_loops(xpbds);
}

#[test]
fn a_chain_keeps_its_bits() {
    let model = chain(5, Start::Horizontal).unwrap();
    for kernels in featherstones(&model) {
        suits_a_shader(&kernels, &model);
        keeps_the_bits(&kernels, &model, 500);
    }
    for kernels in xpbds(&model) {
        suits_a_shader(&kernels, &model);
        keeps_the_bits(&kernels, &model, 500);
    }
}

/// Bodies that fall on the ground and on each other.
#[test]
fn a_heap_keeps_its_bits() {
    let model = heap().unwrap();
    let kernels = TouchingFeatherstone::new(&model, &Settings::new(0.002)).unwrap();
    suits_a_shader(&kernels, &model);
    keeps_the_bits(&kernels, &model, 300);
    let kernels = Xpbd::touching(&model, &Settings::new(0.002)).unwrap();
    suits_a_shader(&kernels, &model);
    keeps_the_bits(&kernels, &model, 300);
}

#[test]
fn a_tree_of_all_joints_keeps_its_bits() {
    let model = mixed(true).unwrap();
    for kernels in featherstones(&model) {
        suits_a_shader(&kernels, &model);
        keeps_the_bits(&kernels, &model, 300);
    }
    let model = mixed(false).unwrap();
    for kernels in xpbds(&model) {
        suits_a_shader(&kernels, &model);
        keeps_the_bits(&kernels, &model, 300);
    }
}

#[test]
fn a_closed_loop_keeps_its_bits() {
    let model = looped().unwrap();
    for kernels in xpbds(&model) {
        suits_a_shader(&kernels, &model);
        keeps_the_bits(&kernels, &model, 300);
    }
    let kernels = TouchingFeatherstone::without_contacts(&model, &Settings::new(0.002)).unwrap();
    suits_a_shader(&kernels, &model);
    keeps_the_bits(&kernels, &model, 300);
    stays_when_it_diverges(&kernels, &model);
}

#[test]
fn a_world_that_diverges_stays_where_it_was() {
    let model = mixed(false).unwrap();
    for kernels in featherstones(&model) {
        stays_when_it_diverges(&kernels, &model);
    }
    for kernels in xpbds(&model) {
        stays_when_it_diverges(&kernels, &model);
    }
}

/// What gauges of a world read, by their kernel and by its record, which must agree to the bit.
fn measured(kernels: &impl Kernels, model: &Model, world: &mut World<f32>) -> Vec<f32> {
    let reported = Reported {
        outputs: &kernels.outputs(),
        inputs: &InputTables::new(model),
        contact_shapes: kernels.contact_shapes(),
        acting: &vec![1.0; model.degrees_of_freedom()],
    };
    let gauges = Gauges::new(model, &reported, &every_gauge(model));
    let record = records::instrument(&Instrument::Gauges(gauges.clone())).unwrap();
    validate(&record);
    let sheet = gauges.sheet();
    let parameters = Vec::from_iter(sheet.parameters.iter().map(|x| *x as f32));
    let mut read = [(); 2].map(|()| vec![0.0; sheet.lengths.output]);
    let mut scratch = vec![0.0; sheet.lengths.scratch];
    for (recorded, read) in read.iter_mut().enumerate() {
        let mut cpu = Cpu::<f32, _> {
            state: &mut world.input,
            input: &world.output,
            output: read,
            scratch: &mut scratch,
            parameters: Shared(&parameters),
            links: &sheet.links,
        };
        if recorded == 0 {
            gauges.measure(&mut cpu);
        } else {
            record.interpret(&mut cpu).unwrap();
        }
    }
    let [read, copy] = read;
    let bits = |x: &[f32]| Vec::from_iter(x.iter().map(|x| x.to_bits()));
    assert_eq!(bits(&read), bits(&copy), "{}", kernels.name());
    read
}

/// While a heap falls: in the end, more of them read something.
#[test]
fn gauges_keep_their_bits() {
    let model = heap().unwrap();
    let kernels = TouchingFeatherstone::new(&model, &Settings::new(0.002)).unwrap();
    let (parameters, links) = (parameters(&kernels), kernels.links());
    let mut world = World::<f32>::new(&kernels, &model);
    let mut busy = Vec::new();
    for _ in 0..3 {
        for _ in 0..100 {
            kernels.step_in_parts(&mut world.cpu(&parameters, links));
        }
        kernels.report(&mut world.cpu(&parameters, links));
        let read = measured(&kernels, &model, &mut world);
        busy.push(read.iter().filter(|x| **x != 0.0).count());
    }
    assert!(busy[0] < busy[2], "{busy:?}");
}
