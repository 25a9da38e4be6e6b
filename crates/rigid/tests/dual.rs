//! Derivatives of one step by dual numbers against central differences.

mod scene;

use glam::DVec3;
use kinetarium_rigid::{Featherstone, Integrator, Kernels, Settings};
use model::Model;
use model::examples::{Start, chain};
use numbers::Dual;
use scene::{World, mixed, parameters};

/// Relative difference allowed between the two derivatives of a column.
const TOLERANCE: f64 = 1e-6;

/// What a step is differentiated with respect to.
#[derive(Clone, Copy, Debug)]
enum Variable {
    /// A coordinate or a velocity.
    State(usize),
    /// A force, target or control.
    Input(usize),
}

/// The state after one step, with one number moved by `change`.
fn step<R: numbers::Real<Mask: numbers::LanesMask>>(
    kernels: &impl Kernels,
    start: &World<R>,
    variable: Variable,
    change: R,
) -> Vec<R> {
    let mut world = start.clone();
    let place = match variable {
        Variable::State(i) => &mut world.state[i],
        Variable::Input(i) => &mut world.input[i],
    };
    *place += change;
    kernels.step(&mut world.cpu(&parameters(kernels), kernels.links()));
    world.state
}

/// Compares slopes, relative to the largest, down to the rounding of differences over `e`.
fn compare(found: &[f64], expected: &[f64], e: f64, what: &str) {
    let size = expected.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let rounding = 8.0 * f64::EPSILON / e;
    for (i, (a, b)) in found.iter().zip(expected).enumerate() {
        let error = (a - b).abs();
        assert!(
            error <= TOLERANCE * size + rounding,
            "{what}, row {i}: {a}, not {b}"
        );
    }
}

fn differentiate(model: &Model, integrator: Integrator) {
    let settings = Settings {
        integrator,
        ..Settings::new(0.002)
    };
    let kernels = Featherstone::new(model, &settings).unwrap();
    let plain = World::<f64>::new(&kernels, model);
    let dual = World::<Dual<f64>>::new(&kernels, model);
    let (coordinates, dofs) = (model.coordinates(), model.degrees_of_freedom());
    let states = (0..coordinates + dofs).map(|i| (Variable::State(i), 1e-5));
    let inputs = (0..plain.input.len()).map(|i| (Variable::Input(i), 1e-3));
    let mut largest = 0f64;
    for (variable, e) in states.chain(inputs) {
        let found = step(&kernels, &dual, variable, Dual::new(0.0, 1.0));
        let found: Vec<_> = found.iter().map(|x| x.slope).collect();
        let above = step(&kernels, &plain, variable, e);
        let below = step(&kernels, &plain, variable, -e);
        let slope = |(a, b): (&f64, &f64)| (a - b) / (2.0 * e);
        let expected: Vec<_> = above.iter().zip(&below).map(slope).collect();
        let what = |rows| format!("{integrator:?}, {rows} by {variable:?}");
        let (q, v) = (0..coordinates, coordinates..coordinates + dofs);
        compare(&found[q.clone()], &expected[q], e, &what("coordinates"));
        compare(&found[v.clone()], &expected[v], e, &what("velocities"));
        largest = found.iter().fold(largest, |m, x| m.max(x.abs()));
    }
    assert!(largest > 0.9, "a coordinate moves itself");
}

#[test]
fn a_chain_has_the_slopes_of_differences() {
    let model = chain(5, Start::Horizontal).unwrap();
    differentiate(&model, Integrator::SemiImplicitEuler);
    differentiate(&model, Integrator::RungeKutta4);
}

#[test]
fn a_tree_of_all_joints_has_the_slopes_of_differences() {
    let model = mixed(DVec3::X * 0.1).unwrap();
    differentiate(&model, Integrator::SemiImplicitEuler);
    differentiate(&model, Integrator::ExplicitEuler);
    differentiate(&model, Integrator::Verlet);
    differentiate(&model, Integrator::RungeKutta4);
}
