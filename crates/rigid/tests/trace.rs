//! Whole solvers recorded: loops stay loops, the record prints as valid WGSL, and
//! run step by step it keeps the bits of the kernel.

mod scene;

use glam::DVec3;
use kinetarium_rigid::{Featherstone, Integrator, Kernels, Settings};
use model::Model;
use model::examples::{Start, chain};
use numbers::trace::{self, Operations, Program, WgslOptions};
use scene::{World, mixed, parameters};

const INTEGRATORS: [Integrator; 4] = [
    Integrator::SemiImplicitEuler,
    Integrator::ExplicitEuler,
    Integrator::Verlet,
    Integrator::RungeKutta4,
];

/// The articulated-body algorithm with each integrator.
fn featherstones(model: &Model) -> impl Iterator<Item = Featherstone> {
    INTEGRATORS.into_iter().map(|integrator| {
        let settings = Settings {
            integrator,
            ..Settings::new(0.002)
        };
        Featherstone::new(model, &settings).unwrap()
    })
}

/// Step and report, recorded.
struct Records {
    step: Program,
    report: Program,
}

impl Records {
    fn new(kernels: &impl Kernels) -> Self {
        Self {
            step: trace::record(|k| kernels.step(k)).unwrap(),
            report: trace::record(|k| kernels.report(k)).unwrap(),
        }
    }
    fn operations(&self) -> [Operations; 2] {
        [self.step.operations(), self.report.operations()]
    }
}

/// Parses and validates a shader as wgpu would.
fn validate(program: &Program) {
    for parameters_per_world in [false, true] {
        let options = WgslOptions {
            parameters_per_world,
            ..WgslOptions::default()
        };
        let shader = program.to_wgsl(&options).unwrap();
        let module = naga::front::wgsl::parse_str(&shader)
            .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&shader)));
        let flags = naga::valid::ValidationFlags::all();
        naga::valid::Validator::new(flags, naga::valid::Capabilities::default())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&shader)));
    }
}

/// What a kernel can write, as bits, every NaN as the same NaN.
fn bits(world: &World<f32>) -> Vec<u32> {
    let canonical = |x: &f32| if x.is_nan() { f32::NAN } else { *x }.to_bits();
    [&world.state, &world.output, &world.scratch]
        .into_iter()
        .flatten()
        .map(canonical)
        .collect()
}

/// Steps and reports a world by the kernel and by its record, which must agree to the bit.
fn run(kernels: &impl Kernels, mut world: World<f32>, steps: usize) -> World<f32> {
    let records = Records::new(kernels);
    let (parameters, links) = (parameters(kernels), kernels.links());
    let mut copy = world.clone();
    for step in 0..steps {
        kernels.step(&mut world.cpu(&parameters, links));
        records
            .step
            .interpret(&mut copy.cpu(&parameters, links))
            .unwrap();
        kernels.report(&mut world.cpu(&parameters, links));
        records
            .report
            .interpret(&mut copy.cpu(&parameters, links))
            .unwrap();
        assert_eq!(
            bits(&world),
            bits(&copy),
            "{} after step {step}",
            kernels.name()
        );
    }
    world
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

#[test]
fn a_longer_chain_records_as_many_operations() {
    let (short, long) = (chain(5, Start::Horizontal), chain(50, Start::Horizontal));
    for (short, long) in featherstones(&short.unwrap()).zip(featherstones(&long.unwrap())) {
        assert_eq!(
            Records::new(&short).operations(),
            Records::new(&long).operations()
        );
    }
}

#[test]
fn the_articulated_body_algorithm_prints_as_valid_wgsl() {
    for model in [chain(5, Start::Horizontal), mixed(DVec3::X * 0.1)] {
        for kernels in featherstones(&model.unwrap()) {
            let records = Records::new(&kernels);
            validate(&records.step);
            validate(&records.report);
        }
    }
}

#[test]
fn what_a_shader_reads_is_finite() {
    let model = mixed(DVec3::X * 0.1).unwrap();
    for kernels in featherstones(&model) {
        let world = World::<f32>::new(&kernels, &model);
        let read = [&world.state, &world.input, &parameters(&kernels)];
        assert!(read.into_iter().flatten().all(|x| x.is_finite()));
    }
}

#[test]
fn a_chain_keeps_its_bits() {
    let model = chain(5, Start::Horizontal).unwrap();
    featherstones(&model).for_each(|kernels| keeps_the_bits(&kernels, &model, 500));
}

#[test]
fn a_tree_of_all_joints_keeps_its_bits() {
    let model = mixed(DVec3::X * 0.1).unwrap();
    featherstones(&model).for_each(|kernels| keeps_the_bits(&kernels, &model, 300));
}

#[test]
fn a_world_that_diverges_stays_at_its_last_state() {
    let model = mixed(DVec3::X * 0.1).unwrap();
    for kernels in featherstones(&model) {
        let mut world = World::new(&kernels, &model);
        world.input[3] = f32::MAX;
        let start = world.state.clone();
        let end = run(&kernels, world, 3);
        assert!(end.scratch.iter().any(|x| x.is_nan()), "the step met NaN");
        assert_eq!(end.state[kernels.alive()], 0.0);
        let n = model.coordinates() + model.degrees_of_freedom();
        assert_eq!(start[..n], end.state[..n]);
    }
}
