//! A linear-quadratic regulator from A and B balances two rods on a cart.
//!
//! The control u = −K x that makes Σ xᵀQx + uᵀRu least for x' = A x + B u has
//!
//! ```text
//! K = (R + BᵀPB)⁻¹ BᵀPA        P = Q + AᵀP (A − B K)
//! ```
//!
//! with P the limit of that recursion from P = Q (Kalman 1960; Anderson & Moore 1990, §2.4).

mod scene;

use kinetarium_derivatives::linearize;
use model::ModelError;
use rigid::Integrator;
use scene::{Matrix, STEP, control_matrix, inverted_double_pendulum, settings, state_matrix};
use sim::Simulation;

/// Initial lean of the lower rod [rad].
const TILT: f64 = 0.1;
/// How long it is to stand [s].
const DURATION: f64 = 5.0;

/// K, with Q = 1 and R = 0.01.
fn gain(a: &Matrix, b: &Matrix) -> Matrix {
    let one = |n| Matrix::of(n, n, |i, j| f64::from(u8::from(i == j)));
    let (q, r) = (one(a.rows), one(b.columns));
    let r = r.plus(0.01 - 1.0, &r);
    let mut p = q.clone();
    loop {
        let weighted = b.transposed().times(&p);
        let k = r.plus(1.0, &weighted.times(b)).solve(&weighted.times(a));
        let closed = a.plus(-1.0, &b.times(&k));
        let next = q.plus(1.0, &a.transposed().times(&p).times(&closed));
        let change = next.plus(-1.0, &p).size();
        if change < 1e-9 * next.size() {
            return k;
        }
        assert!(next.size() < 1e12, "no control holds it");
        p = next;
    }
}

/// Steps from the tilt under u = −K x, or no control; returns the largest lean [rad], and the state at
/// the end.
fn lean(simulation: &mut Simulation<f64>, gain: Option<&Matrix>) -> (f64, Vec<f64>) {
    let set = simulation.set_joint_state(0, &[0.0, TILT, 0.0], &[0.0; 3]);
    set.expect("a state");
    let mut largest = 0.0f64;
    let mut state = Vec::new();
    for _ in 0..(DURATION / STEP).round() as usize {
        let outputs = simulation.outputs();
        state = [outputs.joint_position(0), outputs.joint_velocity(0)].concat();
        largest = largest.max(state[1].abs()).max((state[1] + state[2]).abs());
        if let Some(gain) = gain {
            let control = gain.times(&Matrix::new(6, 1, state.clone()));
            let set = simulation.controls().set_control(0, &[-control.at(0, 0)]);
            set.expect("a control");
        }
        assert!(simulation.step(1).is_empty());
    }
    (largest, state)
}

#[test]
fn a_double_pendulum_is_balanced_by_the_derivatives_of_its_step() -> Result<(), ModelError> {
    let settings = settings(Integrator::SemiImplicitEuler, 1);
    let simulation = Simulation::<f64>::new(inverted_double_pendulum()?, settings);
    let mut simulation = simulation.expect("a simulation");
    let step = linearize(&mut simulation, 0).expect("a linearisation");
    let gain = gain(&state_matrix(&step), &control_matrix(&step));

    let (fallen, _) = lean(&mut simulation, None);
    assert!(fallen > 1.5, "without control it falls: {fallen} rad");
    let (largest, end) = lean(&mut simulation, Some(&gain));
    assert!(largest < 0.3, "it leans by {largest} rad");
    assert!(
        end.iter().all(|x| x.abs() < 1e-2),
        "it stands still: {end:?}"
    );
    Ok(())
}
