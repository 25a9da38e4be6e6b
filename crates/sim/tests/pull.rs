//! Where passes over the contacts run out, a point may be left that pulls. One that was to close a gap
//! within the step then gave its body the energy of that way: a forearm was drawn to the ground with
//! 10⁵ N, while the elbow beside it was pushed off.

use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::examples::ragdolls;

const WORLDS: usize = 512;
const STEPS: usize = 300;
/// Share of the energy at the start that a step may add: limbs that are struck turn by up to 0.2 rad in
/// a step, and lose or gain a share of the order of its square.
const GAIN: f64 = 0.2 * 0.2;

fn energies(simulation: &mut Simulation<f32>) -> Vec<f64> {
    let outputs = simulation.outputs();
    (0..WORLDS).map(|world| outputs.energy(world)).collect()
}

/// A person is thrown at the floor, each time another way up.
#[test]
fn no_step_adds_energy_to_what_is_thrown_down() {
    let model = ragdolls(1).unwrap();
    let dofs = model.degrees_of_freedom();
    let mut position = model.initial_position();
    let mut settings = SimulationSettings::new(WORLDS, 0.003);
    settings.solver = SolverKind::Featherstone;
    let mut simulation = Simulation::<f32>::new(model, settings).unwrap();
    let mut random = fastrand::Rng::with_seed(1);
    for world in 0..WORLDS {
        for q in &mut position[3..7] {
            *q = random.f64() - 0.5;
        }
        let mut velocity: Vec<f64> = (0..dofs).map(|_| 10.0 * (random.f64() - 0.5)).collect();
        velocity[1] -= 5.0;
        let set = simulation.set_joint_state(world, &position, &velocity);
        set.unwrap();
    }
    let start = energies(&mut simulation);
    let mut before = start.clone();
    for step in 0..STEPS {
        assert!(simulation.step(1).is_empty());
        let after = energies(&mut simulation);
        for world in 0..WORLDS {
            let gain = (after[world] - before[world]) / start[world];
            assert!(gain < GAIN, "world {world}, step {step}: {gain}");
        }
        before = after;
    }
}
