//! Derivatives of one step by dual numbers against central differences of fourth order.

use crate::run::report;
use crate::scene::{World, looped, mixed, parameters};
use kinetarium_rigid::{
    Featherstone, Integrator, Kernels, OutputTables, Settings, TouchingFeatherstone, Xpbd,
};
use model::Model;
use model::examples::{Start, chain};
use numbers::Dual;

/// Relative difference allowed between the two derivatives of a column.
const TOLERANCE: f64 = 1e-6;

/// Time step [s].
const STEP: f64 = 0.002;

/// What a step is differentiated with respect to.
#[derive(Clone, Copy, Debug)]
enum Variable {
    /// A coordinate or a velocity.
    State(usize),
    /// A force, target or control.
    Input(usize),
}

/// What is reported after one step, with one number moved by `change`.
fn step<R: numbers::Known>(
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
    let parameters = parameters(kernels);
    kernels.step_in_parts(&mut world.cpu(&parameters, kernels.links()));
    report(kernels, &mut world.cpu(&parameters, kernels.links()));
    world.output
}

/// Compares slopes, relative to the largest, down to the rounding of the differences.
fn compare(found: &[f64], expected: &[f64], rounding: f64, what: &str) {
    let size = expected.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    for (i, (a, b)) in found.iter().zip(expected).enumerate() {
        let error = (a - b).abs();
        assert!(
            error <= TOLERANCE * size + rounding,
            "{what}, row {i}: {a}, not {b}"
        );
    }
}

/// (8 (f(e) − f(−e)) − (f(2e) − f(−2e))) / 12e.
fn difference(kernels: &impl Kernels, start: &World<f64>, variable: Variable, e: f64) -> Vec<f64> {
    let at = |x| step(kernels, start, variable, x);
    let (near, far) = ([at(e), at(-e)], [at(2.0 * e), at(-2.0 * e)]);
    let slope = |i| 8.0 * (near[0][i] - near[1][i]) - (far[0][i] - far[1][i]);
    (0..near[0].len()).map(|i| slope(i) / (12.0 * e)).collect()
}

/// Differentiates coordinates and velocities with respect to every number of the
/// state and of the input.
fn differentiate(kernels: &impl Kernels, model: &Model) {
    let plain = World::<f64>::new(kernels, model);
    let dual = World::<Dual<f64>>::new(kernels, model);
    let output = OutputTables::new(model);
    // A correction of a position by Δx may change a velocity by Δx/h.
    let blocks = [
        (
            output.position.start()..output.velocity.start(),
            8.0 * f64::EPSILON,
        ),
        (
            output.velocity.start()..output.acceleration.start(),
            8.0 * f64::EPSILON / STEP,
        ),
    ];
    let numbers = (0..plain.state.len()).filter(|&i| i != kernels.alive());
    let states = numbers.map(|i| (Variable::State(i), 1e-4));
    let inputs = (0..plain.input.len()).map(|i| (Variable::Input(i), 1e-2));
    let mut largest = 0f64;
    for (variable, e) in states.chain(inputs) {
        let found = step(kernels, &dual, variable, Dual::variable(0.0));
        let found: Vec<_> = found.iter().map(|x| x.slope).collect();
        let expected = difference(kernels, &plain, variable, e);
        for (range, rounding) in &blocks {
            let what = format!("{}: {variable:?}, rows {range:?}", kernels.name());
            compare(
                &found[range.clone()],
                &expected[range.clone()],
                rounding / e,
                &what,
            );
        }
        largest = found.iter().fold(largest, |m, x| m.max(x.abs()));
    }
    assert!(largest > 0.9, "a coordinate moves itself");
}

fn featherstone(model: &Model, integrator: Integrator) -> Featherstone {
    let settings = Settings {
        integrator,
        ..Settings::new(STEP)
    };
    Featherstone::new(model, &settings).unwrap()
}

#[test]
fn a_chain_has_the_slopes_of_differences() {
    let model = chain(5, Start::Horizontal).unwrap();
    differentiate(&featherstone(&model, Integrator::SemiImplicitEuler), &model);
    differentiate(&featherstone(&model, Integrator::RungeKutta4), &model);
    differentiate(&Xpbd::new(&model, &Settings::new(STEP)).unwrap(), &model);
}

#[test]
fn a_tree_of_all_joints_has_the_slopes_of_differences() {
    let model = mixed(true).unwrap();
    differentiate(&featherstone(&model, Integrator::SemiImplicitEuler), &model);
    differentiate(&featherstone(&model, Integrator::ExplicitEuler), &model);
    differentiate(&featherstone(&model, Integrator::Verlet), &model);
    differentiate(&featherstone(&model, Integrator::RungeKutta4), &model);
}

#[test]
fn a_closed_loop_has_the_slopes_of_differences() {
    let model = looped().unwrap();
    let kernels = TouchingFeatherstone::without_contacts(&model, &Settings::new(STEP));
    differentiate(&kernels.unwrap(), &model);
}

#[test]
fn bodies_in_maximal_coordinates_have_the_slopes_of_differences() {
    for model in [mixed(false), looped()] {
        let model = model.unwrap();
        differentiate(&Xpbd::new(&model, &Settings::new(STEP)).unwrap(), &model);
    }
}
