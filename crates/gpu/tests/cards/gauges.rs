//! Gauges that a card reads, read what the processor's do.

use crate::card::card;
use crate::every_gauge::every_gauge;
use crate::models;
use crate::pair::Pair;
use crate::worlds::settings;
use model::Model;
use sim::{Gauge, Simulation, SimulationSettings, SolverKind};
use std::ops::Range;

/// What all gauges of all worlds read, gauge after gauge.
fn read(simulation: &mut Simulation<f32>) -> Vec<Vec<f32>> {
    let worlds: Vec<_> = (0..simulation.worlds()).collect();
    let mut gauges = simulation.gauges(every_gauge(simulation.model())).unwrap();
    simulation.read_gauges(&mut gauges, &worlds).unwrap();
    let of = |numbers: &Range<usize>| {
        let mut read = vec![0.0; worlds.len() * numbers.len()];
        let rows = read.chunks_exact_mut(numbers.len().max(1)).zip(&worlds);
        rows.for_each(|(row, world)| gauges.copy(*world, numbers.start, row));
        read
    };
    gauges.numbers().iter().map(of).collect()
}

/// Expects the same of both, to roundings in parts of the largest number of a gauge. CUDA rounds as processors do, but where
/// it tells of piles.
fn agree(pair: &mut Pair) {
    let exact = pair.gpu.device().unwrap().contains("CUDA") && pair.gpu.solver() != "impulse";
    let [cpu, gpu] = pair.both().map(read);
    let list = every_gauge(pair.cpu.model());
    for ((a, b), gauge) in cpu.iter().zip(&gpu).zip(list) {
        assert!(!exact || a == b, "{gauge:?}: {a:?}, {b:?}");
        let size = match gauge {
            Gauge::Pressing(_) | Gauge::Overlapping(_) | Gauge::AtEnd(_) => 1.0,
            _ => a.iter().fold(1.0_f32, |most, x| most.max(x.abs())),
        };
        for (x, y) in a.iter().zip(b) {
            assert!((x - y).abs() < 2e-5 * size, "{gauge:?}: {x}, {y} of {size}");
        }
    }
    assert!(cpu.iter().flatten().any(|x| *x != 0.0));
}

fn worlds(model: &Model, (solver, worlds): (SolverKind, usize)) -> Pair {
    let settings = SimulationSettings {
        solver,
        ..settings(worlds)
    };
    let mut pair = Pair::new(&card(), model, settings);
    pair.cpu.step(20);
    pair.put();
    pair
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn gauges_read_what_the_processors_read() {
    for (model, of) in [
        (
            models::mixed(false).unwrap(),
            (SolverKind::Featherstone, 70),
        ),
        (models::heap().unwrap(), (SolverKind::Xpbd, 20)),
        // Its gauges are the processor's.
        (models::heap().unwrap(), (SolverKind::Impulse, 3)),
    ] {
        let mut pair = worlds(&model, of);
        agree(&mut pair);
        pair.cpu.step(1);
        pair.put();
        agree(&mut pair);
    }
}

/// Of few worlds nothing else is read, and what is read has the same bits; also once each has constants of its own.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn few_worlds_are_read_alone() {
    const WORLDS: usize = 300;
    let model = models::mixed(false).unwrap();
    let mut simulation = worlds(&model, (SolverKind::Featherstone, WORLDS)).gpu;
    let list = every_gauge(&model);
    let few = [299, 3, 64, 3];
    for times in [1.0, 2.0] {
        if times != 1.0 {
            let mut own = model.clone().into_parts();
            own.gravity *= times;
            let own = Model::new(own).unwrap();
            simulation.set_world_model(64, &own).unwrap();
        }
        let [mut all, mut alone] = [0; 2].map(|_| simulation.gauges(list.clone()).unwrap());
        let every = Vec::from_iter(0..WORLDS);
        simulation.read_gauges(&mut all, &every).unwrap();
        simulation.read_gauges(&mut alone, &few).unwrap();
        for world in every {
            let [all, alone] = [&all, &alone].map(|gauges| {
                let mut numbers = vec![0.0_f32; gauges.length()];
                gauges.copy(world, 0, &mut numbers);
                numbers.into_iter().map(f32::to_bits).collect::<Vec<_>>()
            });
            let read = few.contains(&world);
            assert!(!read || all == alone, "world {world}");
            assert!(read || alone.iter().all(|x| *x == 0), "world {world}");
        }
        simulation.reset(&few[..2]).unwrap();
    }
}

/// Constants that worlds have for themselves are those of the gauges, too, from when they have them.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn worlds_are_read_by_their_own_numbers() {
    let model = models::mixed(false).unwrap();
    let mut pair = worlds(&model, (SolverKind::Featherstone, 5));
    agree(&mut pair);
    for times in [2.0, 3.0] {
        for simulation in pair.both() {
            let mut own = model.clone().into_parts();
            own.gravity *= times;
            let own = Model::new(own).unwrap();
            simulation.set_world_model(2, &own).unwrap();
        }
        agree(&mut pair);
    }
}
