//! Derivatives of a step against central differences of fourth order of the simulation's own step.
//!
//! (8 (F(e) − F(−e)) − (F(2e) − F(−2e))) / 12 e has the error e⁴ F⁽⁵⁾ / 30, at e = 1e-3 about 1e-13 of
//! F⁽⁵⁾, and that of rounding, some 1e-16 / e of what F is made of: states of 1 to 10, and velocities
//! that forces of up to 100 times the mass add h to.

mod scene;

use fastrand::Rng;
use glam::{DQuat, DVec3};
use kinetarium_derivatives::{Linearization, linearize};
use model::Model;
use rigid::Integrator;
use scene::{
    INTEGRATORS, State, chain_of_everything, models, pendulum, put, quaternions, random, settings,
    touching,
};
use sim::{Simulation, SimulationSettings};
use std::f64::consts::TAU;

/// Difference of entries allowed, relative to the largest of their column and to 1.
const TOLERANCE: f64 = 1e-6;
/// Width of the differences.
const WIDTH: f64 = 1e-3;
/// States of each model, integrator and number of substeps.
const STATES: usize = 6;

/// What is varied: the state's tangent, or an input.
#[derive(Clone, Copy, Debug)]
enum Variable {
    Position(usize),
    Velocity(usize),
    Input(usize),
}

/// A state with one of its numbers moved.
fn moved(model: &Model, state: &State, variable: Variable, by: f64) -> State {
    let mut state = state.clone();
    match variable {
        Variable::Velocity(v) => state.velocity[v] += by,
        Variable::Input(i) => state.input[i] += by,
        Variable::Position(v) => {
            let turns = quaternions(model);
            match turns
                .iter()
                .find(|[_, first]| (*first..first + 3).contains(&v))
            {
                Some(&[q, first]) => {
                    let mut turn = [0.0; 3];
                    turn[v - first] = by;
                    let now = DQuat::from_slice(&state.position[q..]);
                    let turned = now * DQuat::from_scaled_axis(turn.into());
                    state.position[q..q + 4].copy_from_slice(&turned.to_array());
                }
                None => {
                    let before = turns.iter().filter(|[_, first]| *first < v).count();
                    state.position[v + before] += by;
                }
            }
        }
    }
    state
}

/// Coordinates and velocities after one step.
fn next(simulation: &mut Simulation<f64>, state: &State) -> [Vec<f64>; 2] {
    put(simulation, state);
    assert!(simulation.step(1).is_empty());
    let outputs = simulation.outputs();
    [outputs.joint_position(0), outputs.joint_velocity(0)]
}

/// The rotation vector of a unit quaternion, small ones too: 2 atan2(|v|, w) v / |v|.
fn rotation_vector(q: DQuat) -> DVec3 {
    let q = if q.w < 0.0 { -q } else { q };
    let sine = q.xyz().length();
    let factor = if sine > 0.0 {
        2.0 * sine.atan2(q.w) / sine
    } else {
        2.0
    };
    factor * q.xyz()
}

/// The way in tangent space from one state to another.
fn way(model: &Model, [q0, v0]: &[Vec<f64>; 2], [q1, v1]: &[Vec<f64>; 2]) -> Vec<f64> {
    let turns = quaternions(model);
    let mut way = Vec::new();
    let mut row = 0;
    while row < q0.len() {
        if turns.iter().any(|[q, _]| *q == row) {
            let [from, to] = [q0, q1].map(|q| DQuat::from_slice(&q[row..]));
            way.extend(rotation_vector(from.conjugate() * to).to_array());
            row += 4;
        } else {
            let apart = q1[row] - q0[row];
            way.push(apart - TAU * (apart / TAU).round());
            row += 1;
        }
    }
    way.extend(v0.iter().zip(v1).map(|(a, b)| b - a));
    way
}

/// A column of differences.
fn difference(
    simulation: &mut Simulation<f64>,
    state: &State,
    variable: Variable,
    width: f64,
) -> Vec<f64> {
    let model = simulation.model().clone();
    let mut at = |by: f64| next(simulation, &moved(&model, state, variable, by));
    let near = way(&model, &at(-width), &at(width));
    let far = way(&model, &at(-2.0 * width), &at(2.0 * width));
    let slope = |(near, far): (&f64, &f64)| (8.0 * near - far) / (12.0 * width);
    near.iter().zip(&far).map(slope).collect()
}

/// A column of a row-major matrix.
fn column(matrix: &[f64], columns: usize, j: usize) -> Vec<f64> {
    matrix.chunks(columns).map(|row| row[j]).collect()
}

/// All columns of a linearisation, with what they are derivatives by.
fn columns(step: &Linearization) -> Vec<(Variable, Vec<f64>)> {
    let (n, m) = (step.dofs, step.controls);
    let mut all = Vec::new();
    for v in 0..n {
        let inputs = [&step.force, &step.target_position, &step.target_velocity];
        all.push((Variable::Position(v), column(&step.state, 2 * n, v)));
        all.push((Variable::Velocity(v), column(&step.state, 2 * n, n + v)));
        for (i, matrix) in inputs.into_iter().enumerate() {
            all.push((Variable::Input(i * n + v), column(matrix, n, v)));
        }
    }
    for a in 0..m {
        all.push((Variable::Input(3 * n + a), column(&step.control, m, a)));
    }
    all
}

fn check(simulation: &mut Simulation<f64>, state: &State, width: f64) {
    put(simulation, state);
    let step = linearize(simulation, 0).expect("a linearisation");
    for (variable, found) in columns(&step) {
        let expected = difference(simulation, state, variable, width);
        let size = expected.iter().fold(1.0, |m: f64, x| x.abs().max(m));
        for (row, (a, b)) in found.iter().zip(&expected).enumerate() {
            let name = &simulation.model().name;
            let error = (a - b).abs() / size;
            assert!(
                error < TOLERANCE,
                "{name}: {variable:?}, row {row}: {a}, not {b}; {state:?}"
            );
        }
    }
}

/// A simulation of one world.
fn simulation(model: &Model, settings: SimulationSettings) -> Simulation<f64> {
    Simulation::new(model.clone(), settings).expect("a simulation")
}

#[test]
fn derivatives_are_those_of_differences() {
    let mut rng = Rng::with_seed(7);
    for model in models() {
        for integrator in INTEGRATORS {
            for substeps in [1, 4] {
                let mut simulation = simulation(&model, settings(integrator, substeps));
                for _ in 0..STATES {
                    let state = random(&model, &mut rng);
                    check(&mut simulation, &state, WIDTH);
                }
            }
        }
    }
}

#[test]
fn per_world_numbers_are_those_of_the_world() {
    let model = pendulum().expect("a model");
    let mut settings = settings(Integrator::SemiImplicitEuler, 1);
    settings.worlds = 2;
    let mut simulation = simulation(&model, settings);
    let mut parts = model.clone().into_parts();
    parts.gravity *= 2.0;
    let heavier = Model::new(parts).expect("a model");
    simulation.set_world_model(1, &heavier).expect("a world");
    let mut slope = |world| {
        linearize(&mut simulation, world)
            .expect("a linearisation")
            .state[2]
    };
    assert!((slope(1) - 2.0 * slope(0)).abs() < 1e-12 * slope(0).abs());
}

/// Single precision rounds the state, to 6e-8 of it; derivatives of that state are in double.
#[test]
fn single_precision_is_linearised_in_double() {
    let model = chain_of_everything().expect("a model");
    let state = random(&model, &mut Rng::with_seed(3));
    let settings = settings(Integrator::SemiImplicitEuler, 1);
    let mut single = Simulation::<f32>::new(model.clone(), settings).expect("a simulation");
    let set = single.set_joint_state(0, &state.position, &state.velocity);
    set.expect("a state");
    let set = single.controls().set_world(0, &state.input);
    set.expect("controls");
    let mut double = simulation(&model, settings);
    put(&mut double, &state);
    let [a, b] = [linearize(&mut single, 0), linearize(&mut double, 0)]
        .map(|step| step.expect("a step").state);
    let size = b.iter().fold(0.0, |m: f64, x| x.abs().max(m));
    let apart = a
        .iter()
        .zip(&b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    assert!(apart > 0.0 && apart < 1e-5 * size, "{apart:e} of {size}");
}

/// What the integrator does with bodies that lie on the ground and on each other: the branches taken
/// stay the same within the width of the differences.
#[test]
fn contacts_that_last_have_derivatives() {
    let model = touching().expect("a model");
    let mut rng = Rng::with_seed(11);
    for (integrator, substeps) in [
        (Integrator::SemiImplicitEuler, 1),
        (Integrator::SemiImplicitEuler, 4),
        (Integrator::RungeKutta4, 1),
    ] {
        let mut settings = settings(integrator, substeps);
        settings.contacts = true;
        let mut simulation = simulation(&model, settings);
        let mut pressing = 0;
        for _ in 0..4 {
            let mut state = random(&model, &mut rng);
            state.position = model.initial_position();
            state.velocity.iter_mut().for_each(|v| *v *= 0.1);
            put(&mut simulation, &state);
            simulation.step(1);
            let presses = |contact: &sim::Contact| contact.force.length() > 0.0;
            pressing += simulation.outputs().contacts(0).filter(presses).count();
            check(&mut simulation, &state, 1e-6);
        }
        assert!(
            pressing > 8,
            "{pressing} contacts that press in four states"
        );
    }
}
