//! Derivatives of a step that are known in symbols, and what every step must keep.

mod scene;

use fastrand::Rng;
use kinetarium_derivatives::linearize;
use model::examples::{Start, chain};
use rigid::{Dynamics, Integrator};
use scene::{
    INTEGRATORS, Matrix, STEP, State, control_matrix, models, pendulum, put, random, settings,
    state_matrix,
};
use sim::Simulation;

/// Largest difference of two matrices.
fn apart(a: &Matrix, b: &Matrix) -> f64 {
    a.plus(-1.0, b).size()
}

fn simulation(
    model: &model::Model,
    integrator: Integrator,
    step: f64,
    substeps: usize,
) -> Simulation<f64> {
    let mut settings = settings(integrator, substeps);
    settings.step.time_step = step;
    Simulation::new(model.clone(), settings).expect("a simulation")
}

/// A rod of mass m whose centre is at l from its hinge, about which its inertia is J, damped by d and
/// driven by g u:
///
/// ```text
/// (J + h d) q̈ = −m G l sin q − d q̇ + g u + τ        q̇' = q̇ + h q̈        q' = q + h q̇'
///
/// a = ∂q̇'/∂q = −h m G l cos q / (J + h d)           b = ∂q̇'/∂q̇ = J / (J + h d)
/// A = [1 + h a, h b; a, b]                           B = g [h c; c],  c = h / (J + h d)
/// ```
#[test]
fn a_pendulum_has_the_derivatives_of_its_equation() {
    let model = pendulum().expect("a model");
    let (body, dof) = (&model.bodies[0], &model.joints[0].dofs[0]);
    let (h, l, d, gear) = (STEP, 0.2, dof.damping, model.actuators[0].gear);
    let inertia = body.inertia.z_axis.z + body.mass * l * l;
    let weight = -body.mass * model.gravity.y * l;
    let mut simulation = simulation(&model, Integrator::SemiImplicitEuler, h, 1);
    for q in [0.0, 0.7, -2.0, 3.1] {
        simulation
            .set_joint_state(0, &[q], &[1.5])
            .expect("a state");
        let step = linearize(&mut simulation, 0).expect("a linearisation");
        let c = h / (inertia + h * d);
        let (a, b) = (-c * weight * f64::cos(q), inertia / (inertia + h * d));
        let expected = Matrix::new(2, 2, vec![1.0 + h * a, h * b, a, b]);
        assert!(apart(&state_matrix(&step), &expected) < 1e-13);
        let expected = Matrix::new(2, 1, vec![gear * h * c, gear * c]);
        assert!(apart(&control_matrix(&step), &expected) < 1e-13);
        let force = Matrix::new(2, 1, step.force);
        assert!(apart(&force, &Matrix::new(2, 1, vec![h * c, c])) < 1e-13);
    }
}

/// Without a damper b is 1, and det A = (1 + h a) b − h b a = 1: the map keeps areas.
#[test]
fn semi_implicit_euler_keeps_the_areas_of_a_pendulum() {
    let model = chain(1, Start::Horizontal).expect("a model");
    let mut simulation = simulation(&model, Integrator::SemiImplicitEuler, 0.05, 1);
    simulation
        .set_joint_state(0, &[0.4], &[3.0])
        .expect("a state");
    let step = linearize(&mut simulation, 0).expect("a linearisation");
    let a = state_matrix(&step);
    let determinant = a.at(0, 0) * a.at(1, 1) - a.at(0, 1) * a.at(1, 0);
    assert!((determinant - 1.0).abs() < 1e-12, "{determinant}");
}

/// F of n substeps is F of one, n times over: A = Aₙ … A₁, B = Σ Aₙ … Aᵢ₊₁ Bᵢ.
#[test]
fn substeps_multiply() {
    const SUBSTEPS: usize = 4;
    let mut rng = Rng::with_seed(5);
    for model in models() {
        for integrator in INTEGRATORS {
            let state = random(&model, &mut rng);
            let mut whole = simulation(&model, integrator, STEP, SUBSTEPS);
            put(&mut whole, &state);
            let whole = linearize(&mut whole, 0).expect("a linearisation");
            let mut part = simulation(&model, integrator, STEP / SUBSTEPS as f64, 1);
            put(&mut part, &state);
            let n = 2 * whole.dofs;
            let mut a = Matrix::of(n, n, |i, j| f64::from(u8::from(i == j)));
            let mut b = Matrix::of(n, whole.controls, |_, _| 0.0);
            for _ in 0..SUBSTEPS {
                let step = linearize(&mut part, 0).expect("a linearisation");
                let next = state_matrix(&step);
                a = next.times(&a);
                b = next.times(&b).plus(1.0, &control_matrix(&step));
                part.step(1);
            }
            let size = a.size().max(b.size());
            assert!(
                apart(&a, &state_matrix(&whole)) < 1e-12 * size,
                "{}",
                model.name
            );
            assert!(
                apart(&b, &control_matrix(&whole)) < 1e-12 * size,
                "{}",
                model.name
            );
        }
    }
}

/// T = ∂(q, p)/∂(q, q̇) with the momenta p = M q̇: [1, 0; N, M], Nᵢⱼ = Σₖ ∂Mᵢₖ/∂qⱼ q̇ₖ, the derivatives of M
/// by differences of fourth order.
fn momenta(dynamics: &Dynamics, q: &[f64], v: &[f64]) -> Matrix {
    const E: f64 = 1e-3;
    let n = q.len();
    let mass = |q: &[f64]| Matrix::new(n, n, dynamics.mass_matrix(q).expect("a mass matrix"));
    let speed = Matrix::new(n, 1, v.to_vec());
    let column = |j: usize| {
        let at = |x: f64| {
            let mut q = q.to_vec();
            q[j] += x;
            mass(&q).times(&speed)
        };
        let near = at(E).plus(-1.0, &at(-E));
        let far = at(2.0 * E).plus(-1.0, &at(-2.0 * E));
        let zero = Matrix::of(n, 1, |_, _| 0.0);
        zero.plus(8.0 / (12.0 * E), &near)
            .plus(-1.0 / (12.0 * E), &far)
    };
    let columns: Vec<_> = (0..n).map(column).collect();
    let m = mass(q);
    Matrix::of(2 * n, 2 * n, |i, j| match (i < n, j < n) {
        (true, _) => f64::from(u8::from(i == j)),
        (false, true) => columns[j].at(i - n, 0),
        (false, false) => m.at(i - n, j - n),
    })
}

/// How far a step of a chain is from keeping dq ∧ dp: the largest entry of AᵀJA − J, relative to that of A.
fn symplectic_defect(integrator: Integrator, h: f64) -> f64 {
    let model = chain(4, Start::Hanging).expect("a model");
    let dynamics = Dynamics::new(&model).expect("a tree");
    let mut simulation = simulation(&model, integrator, h, 1);
    let (q, v) = ([0.4, -0.9, 1.3, 0.2], [1.0, -2.0, 0.5, 1.5]);
    simulation.set_joint_state(0, &q, &v).expect("a state");
    let a = state_matrix(&linearize(&mut simulation, 0).expect("a linearisation"));
    let before = momenta(&dynamics, &q, &v);
    simulation.step(1);
    let outputs = simulation.outputs();
    let after = momenta(
        &dynamics,
        &outputs.joint_position(0),
        &outputs.joint_velocity(0),
    );
    // A in (q, p): T' A T⁻¹, the transpose of the solution X of Tᵀ X = (T' A)ᵀ.
    let right = after.times(&a).transposed();
    let a = before.transposed().solve(&right).transposed();
    let n = q.len();
    let j = Matrix::of(2 * n, 2 * n, |i, j| {
        f64::from(u8::from(i + n == j)) - f64::from(u8::from(j + n == i))
    });
    apart(&a.transposed().times(&j).times(&a), &j) / a.size()
}

/// The flow of a chain that nothing drives keeps dq ∧ dp (Arnold 1978, §38), and so does a step of
/// order p to h^(p+1): with Runge–Kutta's the Jacobian is within 1e-9 at h = 1 ms, and a halved step
/// leaves a thirty-second. Semi-implicit Euler keeps it only where M is constant, as a pendulum's is:
/// forces that depend on velocity are taken at its start. It leaves a quarter.
#[test]
fn a_chain_keeps_its_symplectic_form_to_the_order_of_the_step() {
    let fine = symplectic_defect(Integrator::RungeKutta4, 1e-3);
    assert!(fine < 1e-9, "{fine:e}");
    for (integrator, h, order) in [
        (Integrator::RungeKutta4, 0.02, 5),
        (Integrator::SemiImplicitEuler, 0.002, 2),
    ] {
        let defects = [h, h / 2.0].map(|h| symplectic_defect(integrator, h));
        let found = (defects[0] / defects[1]).log2();
        assert!(
            (found - f64::from(order)).abs() < 0.3,
            "{integrator:?}: {defects:?}, order {found}"
        );
    }
}

/// A number in a state that nothing acts on goes through: a floating body's position.
#[test]
fn a_shift_of_a_floating_body_stays_a_shift() {
    let model = scene::floating().expect("a model");
    for integrator in INTEGRATORS {
        let mut simulation = simulation(&model, integrator, STEP, 1);
        let state: State = random(&model, &mut Rng::with_seed(9));
        put(&mut simulation, &state);
        let a = state_matrix(&linearize(&mut simulation, 0).expect("a linearisation"));
        for j in 0..3 {
            let shift = |i: usize| (a.at(i, j) - f64::from(u8::from(i == j))).abs();
            assert!((0..a.rows).all(|i| shift(i) < 1e-12), "{integrator:?}");
        }
    }
}
