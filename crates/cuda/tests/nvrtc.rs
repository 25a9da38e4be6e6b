//! What NVRTC makes of kernels. Needs no card: `pip install nvidia-cuda-nvrtc-cu12`, and its folder in `LD_LIBRARY_PATH`.

#[path = "../../rigid/tests/scene/every_gauge.rs"]
mod every_gauge;
#[path = "../../rigid/tests/scene/models.rs"]
#[allow(dead_code)]
mod models;
#[path = "../../rigid/tests/scene/surroundings.rs"]
#[allow(dead_code)]
mod surroundings;

use every_gauge::every_gauge;
use kinetarium_cuda::{ptx, ptx_of_wgsl};
use model::examples::{Scene, Start, chain};
use model::{Model, Mount};
use numbers::machine::space::State;
use numbers::trace::{self, Members, PrintOptions, Program};
use numbers::{Machine, Real, Table};
use records::{PilePrograms, Programs, instrument};
use rigid::Report::Everything;
use rigid::impulse::{ContactTables, row};
use rigid::{
    Featherstone, Gauges, InputTables, Instrument, Kernels, Lengths, OutputTables, Rangefinder,
    Reported, Settings, Solver, TouchingFeatherstone, Xpbd,
};
use surroundings::{directions, surroundings};

/// No operation is approximate, and no subnormal is flushed.
fn is_exact(program: &Program, lengths: Lengths) {
    let ptx = ptx(program, lengths.scratch, lengths.state).unwrap();
    assert!(ptx.contains(".visible .entry step("));
    nothing_is_loose(&ptx);
}

fn nothing_is_loose(ptx: &str) {
    for loose in [".approx", ".full", ".ftz"] {
        assert!(!ptx.contains(loose), "{loose}");
    }
}

fn are_exact(solver: Solver<'_>) {
    let programs = Programs::record(solver).unwrap();
    is_exact(&programs.step, programs.lengths);
    is_exact(programs.report(Everything), programs.lengths);
}

fn scene(name: &str) -> Model {
    Scene::find(name).unwrap().model().unwrap()
}

#[test]
#[ignore = "needs NVRTC"]
fn articulated_bodies_are_compiled_exactly() {
    let model = chain(10, Start::Horizontal).unwrap();
    let kernels = Featherstone::new(&model, &Settings::new(0.002)).unwrap();
    are_exact(Solver::Featherstone(&kernels));
}

#[test]
#[ignore = "needs NVRTC"]
fn articulated_bodies_that_touch_are_compiled_exactly() {
    let kernels = TouchingFeatherstone::new(&scene("ragdolls"), &Settings::new(0.002)).unwrap();
    are_exact(Solver::TouchingFeatherstone(&kernels));
}

#[test]
#[ignore = "needs NVRTC"]
fn a_pile_of_all_shapes_is_compiled_exactly() {
    let kernels = Xpbd::touching(&scene("pile"), &Settings::new(0.002)).unwrap();
    are_exact(Solver::Xpbd(&kernels));
}

#[test]
#[ignore = "needs NVRTC"]
fn rays_are_compiled_exactly() {
    let model = surroundings();
    let (mount, outputs) = (Mount::default(), OutputTables::new(&model));
    let finder = Rangefinder::new(&model, &outputs, &mount, &directions(5), 9.0).unwrap();
    let finder = Instrument::Rangefinder(finder);
    is_exact(&instrument(&finder).unwrap(), finder.sheet().lengths);
}

#[test]
#[ignore = "needs NVRTC"]
fn gauges_are_compiled_exactly() {
    let model = models::mixed(false).unwrap();
    let kernels = TouchingFeatherstone::new(&model, &Settings::new(0.002)).unwrap();
    let reported = Reported {
        outputs: &kernels.outputs(),
        inputs: &InputTables::new(&model),
        contact_shapes: kernels.contact_shapes(),
        acting: &vec![1.0; model.degrees_of_freedom()],
    };
    let gauges = Gauges::new(&model, &reported, &every_gauge(&model));
    let gauges = Instrument::Gauges(gauges);
    is_exact(&instrument(&gauges).unwrap(), gauges.sheet().lengths);
}

/// What lies between the kernels of piles, and kernels whose members are contacts and joints.
#[test]
#[ignore = "needs NVRTC"]
fn piles_are_compiled_exactly() {
    for worlds in [1, 2] {
        for text in piles::texts(worlds) {
            let ptx = ptx_of_wgsl(&text).unwrap();
            assert!(ptx.contains(".visible .entry entry_"));
            assert!(!ptx.contains("call.uni"), "all is inlined");
            assert!(!ptx.contains("fma"), "nothing here is fused");
            nothing_is_loose(&ptx);
        }
    }
    let seats = PrintOptions {
        members: Members::Seats {
            bodies: row::PREPARED as u32,
            state: ContactTables::new().length as u32,
        },
        ..PrintOptions::default()
    };
    let runs = PrintOptions {
        parameters_per_world: true,
        members: Members::Runs,
        ..PrintOptions::default()
    };
    let programs = PilePrograms::record().unwrap();
    for (program, options) in [
        (&programs.prepare, seats),
        (&programs.push, seats),
        (&programs.advance, runs),
    ] {
        let ptx = ptx_of_wgsl(&program.to_wgsl(&options).unwrap()).unwrap();
        assert!(ptx.contains(".visible .entry entry_main("));
        nothing_is_loose(&ptx);
    }
}

/// What a kernel fuses is fused, and nothing else.
#[test]
#[ignore = "needs NVRTC"]
fn products_and_sums_stay_apart() {
    fn kernel<M: Machine>(k: &mut M, row: Table<State, 3>, fused: bool) {
        let zero = k.index(0);
        let [x, y, z] = k.read(row, zero, 0);
        let sum = if fused { x.fma(y, z) } else { x * y + z };
        k.store(row, zero, 0, sum);
    }
    let row = Table::place(&mut 0, 1);
    let [apart, fused] = [false, true].map(|fused| {
        let program = trace::record(|k| kernel(k, row, fused)).unwrap();
        ptx(&program, 0, 3).unwrap()
    });
    assert!(fused.contains("fma.rn.f32"));
    assert!(!apart.contains("fma"));
}
