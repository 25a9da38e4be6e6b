//! Rays that a card casts go as far as the processor's.

use crate::card::card;
use crate::pair::Pair;
use crate::surroundings::{directions, flights, somewhere, surroundings};
use crate::worlds::settings;
use model::{BodyId, Mount, Pose};
use sim::{Simulation, SimulationSettings, SolverKind};

const RAYS: usize = 63;

/// How far the rays of all worlds get from a mount.
fn distances(simulation: &mut Simulation<f32>, mount: Mount, range: f64) -> Vec<f32> {
    let worlds: Vec<_> = (0..simulation.worlds()).collect();
    let mut finder = simulation
        .rangefinder(mount, &directions(RAYS - 3), range)
        .unwrap();
    let mut distances = vec![0.0; worlds.len() * RAYS];
    simulation
        .measure_ranges(&mut finder, &worlds, &mut distances)
        .unwrap();
    distances
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn rays_go_as_far_as_the_processors() {
    let model = surroundings();
    let mount = Mount {
        body: Some(BodyId(0)),
        pose: somewhere(50),
    };
    let fixed = Mount {
        body: None,
        ..mount
    };
    for (solver, worlds) in [
        (SolverKind::Featherstone, 70),
        (SolverKind::Xpbd, 20),
        // Its rays are the processor's.
        (SolverKind::Impulse, 10),
    ] {
        let settings = SimulationSettings {
            solver,
            contacts: true,
            ..settings(worlds)
        };
        let mut pair = Pair::at_rest(&card(), &model, settings);
        for world in 0..worlds {
            let position = flights(world, model.bodies.len());
            let velocity = vec![0.1; model.degrees_of_freedom()];
            let set = pair.cpu.set_joint_state(world, &position, &velocity);
            set.unwrap();
        }
        pair.put();
        for (mount, range) in [(mount, f64::INFINITY), (fixed, 4.0), (mount, f64::INFINITY)] {
            let [cpu, gpu] = pair.both().map(|s| distances(s, mount, range));
            let met = cpu.iter().filter(|x| f64::from(**x) < range).count();
            assert!(met > cpu.len() / 8, "{met} are met");
            // One along the floor, some metres below, goes by its square farther on a rounding.
            // What is no number is apart, too.
            let apart = |(a, b): &(&f32, &f32)| {
                let near = (*a - *b).abs() <= 1e-5 * b.max(1.0).powi(2);
                a != b && !near
            };
            // One that just passes an edge may meet it there; one that touches a ball goes on by the root of a rounding.
            let others = cpu.iter().zip(&gpu).filter(apart).count();
            assert!(others * 500 <= cpu.len(), "{others} of {}", cpu.len());
            // CUDA rounds as processors do.
            let exact = pair.gpu.device().unwrap().contains("CUDA");
            assert!(!exact || cpu == gpu, "{others} of {}", cpu.len());
            pair.step(2);
            pair.put();
        }
    }
}

/// They see where bodies are now, and a simulation goes on as if nobody had asked.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn asking_changes_nothing() {
    let model = surroundings();
    let mount = Mount {
        body: Some(BodyId(0)),
        pose: Pose::IDENTITY,
    };
    let of = |asks: bool| {
        let mut simulation = Simulation::on(&card(), model.clone(), settings(4)).unwrap();
        for _ in 0..3 {
            simulation.try_step(2).unwrap();
            if asks {
                distances(&mut simulation, mount, 9.0);
            }
        }
        simulation.try_snapshot().unwrap().to_bytes()
    };
    assert!(of(true) == of(false));
}
