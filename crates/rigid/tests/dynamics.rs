//! Dynamics as functions, each against the others: the mass matrix and inverse dynamics against the
//! articulated-body algorithm, Jacobians against velocities, weights and momenta.

mod block;
mod scene;
#[path = "../../collide/tests/shader/mod.rs"]
mod shader;

use glam::{DQuat, DVec3};
use kinetarium_rigid::{
    Dynamics, DynamicsError, DynamicsKernels, Featherstone, InputTables, Kernels, OutputTables,
    Settings, SolverError, body,
};
use model::examples::{Start, chain};
use model::{BodyId, JointKind, Model};
use numbers::Machine;
use numbers::dispatch::Isa;
use numbers::trace::{self, PrintOptions, Program};
use scene::{World, looped, mixed, parameters};
use shader::validate;

/// Rounding allowed in `f64`, relative to the norm of what is compared with.
const TOLERANCE: f64 = 1e-10;

/// Numbers in [−1, 1] without a pattern.
fn wave(seed: usize, n: usize) -> Vec<f64> {
    let at = |i: usize| (12.9898 * i as f64 + 78.233 * seed as f64).sin();
    (0..n).map(at).collect()
}

/// Coordinates away from the model's own, with unit quaternions.
fn position(model: &Model, seed: usize) -> Vec<f64> {
    let shift = wave(seed, model.coordinates());
    let mut q = model.initial_position();
    q.iter_mut().zip(&shift).for_each(|(q, x)| *q += x);
    for (i, joint) in model.joints.iter().enumerate() {
        let range = model.coordinate_range(model::JointId(i));
        if matches!(joint.kind, JointKind::Ball | JointKind::Free) {
            let turn = &mut q[range.end - 4..range.end];
            turn.copy_from_slice(&DQuat::from_slice(turn).normalize().to_array());
        }
    }
    q
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[track_caller]
fn close(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    let difference: Vec<_> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
    let error = norm(&difference) / norm(expected).max(1e-300);
    assert!(
        error <= tolerance,
        "relative error {error:e}\n{found:?}\n{expected:?}"
    );
}

/// A row-by-row matrix of `x.len()` columns times `x`.
fn times(matrix: &[f64], x: &[f64]) -> Vec<f64> {
    let dot = |row: &[f64]| row.iter().zip(x).map(|(a, b)| a * b).sum();
    matrix.chunks(x.len()).map(dot).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A model with its dynamics, at a few states in motion.
struct Case {
    model: Model,
    dynamics: Dynamics,
    n: usize,
}

impl Case {
    fn mixed() -> Self {
        // A stop's inertia is no applied force, for it depends on the acceleration.
        let mut parts = mixed(true).unwrap().into_parts();
        for joint in &mut parts.joints {
            for limit in joint.dofs.iter_mut().filter_map(|d| d.limit.as_mut()) {
                limit.inertia = 0.0;
            }
        }
        let model = Model::new(parts).unwrap();
        let dynamics = Dynamics::new(&model).unwrap();
        let n = model.degrees_of_freedom();
        Self { model, dynamics, n }
    }
    fn states(&self) -> impl Iterator<Item = (Vec<f64>, Vec<f64>)> {
        (0..20).map(|seed| (position(&self.model, seed), wave(seed + 100, self.n)))
    }
    /// Mass, and Jacobian of the centre of mass, of every body that moves.
    fn centres(&self, q: &[f64]) -> Vec<(f64, Vec<f64>)> {
        let moving = |id: &BodyId| self.model.carrier(*id).is_some();
        let ids = self.model.order().iter().copied().filter(moving);
        let centre = |id: BodyId| {
            let body = &self.model.bodies[id.0];
            let jacobian = self.dynamics.jacobian(q, id, body.center).unwrap();
            (body.mass, jacobian[3 * self.n..].to_vec())
        };
        ids.map(centre).collect()
    }
}

#[test]
fn the_scene_has_what_is_to_be_tested() {
    let case = Case::mixed();
    let joints = &case.model.joints;
    for kind in [
        JointKind::Ball,
        JointKind::Free,
        JointKind::Prismatic,
        JointKind::D6,
    ] {
        assert!(joints.iter().any(|j| j.kind == kind), "no {kind:?}");
    }
    let mut axes = joints.iter().flat_map(|j| &j.axes);
    assert!(axes.any(|a| a.anchor != DVec3::ZERO));
    let mut dofs = joints.iter().flat_map(|j| &j.dofs);
    assert!(dofs.any(|d| d.armature > 0.0));
}

#[test]
fn mass_times_acceleration_and_bias_is_force() {
    let case = Case::mixed();
    for (q, v) in case.states() {
        let a = wave(7, case.n);
        let m = case.dynamics.mass_matrix(&q).unwrap();
        let bias = case
            .dynamics
            .inverse_dynamics(&q, &v, &vec![0.0; case.n])
            .unwrap();
        let force = case.dynamics.inverse_dynamics(&q, &v, &a).unwrap();
        let sum: Vec<_> = times(&m, &a)
            .iter()
            .zip(&bias)
            .map(|(x, y)| x + y)
            .collect();
        close(&sum, &force, TOLERANCE);
        let found = case.dynamics.forward_dynamics(&q, &v, &force).unwrap();
        close(&found, &a, TOLERANCE);
    }
}

#[test]
fn the_mass_matrix_is_symmetric_and_positive_definite() {
    let case = Case::mixed();
    let n = case.n;
    for (q, _) in case.states() {
        let mut m = case.dynamics.mass_matrix(&q).unwrap();
        for i in 0..n {
            for j in 0..i {
                assert_eq!(m[i * n + j].to_bits(), m[j * n + i].to_bits(), "({i}, {j})");
            }
        }
        // Gauss elimination of a symmetric matrix: it is positive definite if all pivots are positive.
        for p in 0..n {
            assert!(m[p * n + p] > 1e-6, "pivot {p} is {}", m[p * n + p]);
            for i in p + 1..n {
                let factor = m[i * n + p] / m[p * n + p];
                for j in p..n {
                    m[i * n + j] -= factor * m[p * n + j];
                }
            }
        }
    }
}

#[test]
fn a_quaternion_may_have_any_length() {
    let Case {
        model, dynamics, ..
    } = Case::mixed();
    let q = position(&model, 1);
    let mut longer = q.clone();
    for (_, range) in model.quaternions() {
        longer[range].iter_mut().for_each(|x| *x *= 3.0);
    }
    let mass = dynamics.mass_matrix(&q).unwrap();
    close(&dynamics.mass_matrix(&longer).unwrap(), &mass, 1e-12);
}

#[test]
fn kinetic_energy_is_half_the_square_of_velocity_by_mass() {
    let case = Case::mixed();
    for (q, v) in case.states() {
        let m = case.dynamics.mass_matrix(&q).unwrap();
        let totals = case.dynamics.totals(&q, &v).unwrap();
        close(
            &[0.5 * dot(&v, &times(&m, &v))],
            &[totals.kinetic],
            TOLERANCE,
        );
    }
}

#[test]
fn a_jacobian_gives_the_velocity_of_a_point() {
    let case = Case::mixed();
    let point = DVec3::new(0.3, -0.2, 0.1);
    for (q, v) in case.states() {
        let reported = case.dynamics.bodies(&q, &v).unwrap();
        for (id, row) in reported.chunks(body::WIDTH).enumerate() {
            let jacobian = case.dynamics.jacobian(&q, BodyId(id), point).unwrap();
            let turn = DVec3::from_slice(&row[body::ANGULAR_VELOCITY..]);
            let arm = DQuat::from_slice(&row[body::ORIENTATION..]) * point;
            let speed = DVec3::from_slice(&row[body::VELOCITY..]) + turn.cross(arm);
            let expected = [turn.to_array(), speed.to_array()].concat();
            close(&times(&jacobian, &v), &expected, TOLERANCE);
        }
    }
}

/// What moves nothing has no column, so that the static body's Jacobian is 0.
#[test]
fn a_static_body_does_not_move() {
    let case = Case::mixed();
    let mut ids = case.model.order().iter();
    let wall = *ids.find(|id| case.model.carrier(**id).is_none()).unwrap();
    let q = position(&case.model, 1);
    let jacobian = case.dynamics.jacobian(&q, wall, DVec3::ONE).unwrap();
    assert_eq!(jacobian, vec![0.0; 6 * case.n]);
}

/// At rest the bias force carries the weight: b = −Σ m Jᵀ g, J of each centre of mass.
#[test]
fn the_bias_at_rest_is_the_weight() {
    let case = Case::mixed();
    let (n, still) = (case.n, vec![0.0; case.n]);
    for (q, _) in case.states() {
        let bias = case.dynamics.inverse_dynamics(&q, &still, &still).unwrap();
        let mut weight = vec![0.0; n];
        for (m, jacobian) in case.centres(&q) {
            for (row, g) in jacobian.chunks(n).zip(case.model.gravity.to_array()) {
                weight
                    .iter_mut()
                    .zip(row)
                    .for_each(|(w, j)| *w -= m * g * j);
            }
        }
        close(&bias, &weight, TOLERANCE);
    }
}

#[test]
fn momentum_is_mass_times_velocity_of_the_centres() {
    let case = Case::mixed();
    for (q, v) in case.states() {
        let momentum =
            |(m, jacobian): (f64, Vec<f64>)| DVec3::from_slice(&times(&jacobian, &v)) * m;
        let sum: DVec3 = case.centres(&q).into_iter().map(momentum).sum();
        let totals = case.dynamics.totals(&q, &v).unwrap();
        close(&totals.momentum.to_array(), &sum.to_array(), TOLERANCE);
    }
}

/// The solver's own accelerations are forward dynamics under all that acts.
#[test]
fn applied_forces_accelerate_as_the_solver_does() {
    let case = Case::mixed();
    let kernels = Featherstone::new(&case.model, &Settings::new(0.002)).unwrap();
    let mut world = World::<f64>::new(&kernels, &case.model);
    kernels.report(&mut world.cpu(&parameters(&kernels), kernels.links()));
    let output = OutputTables::new(&case.model);
    let reported = &world.output[output.acceleration.at(0, 0)..][..case.n];

    let (q, v) = world.state.split_at(case.model.coordinates());
    let v = &v[..case.n];
    let force = case.dynamics.applied_forces(q, v, &world.input).unwrap();
    let found = case.dynamics.forward_dynamics(q, v, &force).unwrap();
    close(&found, reported, TOLERANCE);
}

/// A block of worlds in every instruction set: accelerations and mass matrices of f64, to f32's rounding.
#[test]
fn lanes_of_f32_agree() {
    let case = Case::mixed();
    let solver = Featherstone::new(&case.model, &Settings::new(0.002)).unwrap();
    let input = InputTables::new(&case.model).initial(&case.model);
    let worlds: Vec<_> = case
        .states()
        .map(|(q, v)| (solver.initial(&case.model, &q, &v), input.clone()))
        .collect();
    let (matrix, output) = (
        case.dynamics.kernels().tables().mass_matrix,
        OutputTables::new(&case.model),
    );
    for isa in Isa::available() {
        let found = block::evaluate(isa, &solver, case.dynamics.kernels(), &worlds);
        for (world, (q, v)) in case.states().enumerate() {
            let read = |start: usize, n: usize| -> Vec<f64> {
                let at = |i| f64::from(found.get(world, start + i));
                (0..n).map(at).collect()
            };
            let m = case.dynamics.mass_matrix(&q).unwrap();
            close(&read(matrix.at(0, 0), m.len()), &m, 1e-5);
            let force = case.dynamics.applied_forces(&q, &v, &input).unwrap();
            let a = case.dynamics.forward_dynamics(&q, &v, &force).unwrap();
            close(&read(output.acceleration.at(0, 0), case.n), &a, 1e-3);
        }
    }
}

/// What a recorded kernel tells, as bits. Of what lies in scratch meanwhile a record keeps some in registers.
fn bits(world: &World<f32>) -> Vec<u32> {
    let numbers = [&world.state, &world.output];
    numbers.into_iter().flatten().map(|x| x.to_bits()).collect()
}

/// The memories of one world for the kernels of dynamics, in motion.
fn world(kernels: &DynamicsKernels, model: &Model) -> World<f32> {
    let lengths = kernels.lengths();
    let (q, v) = (position(model, 3), wave(4, model.degrees_of_freedom()));
    let single = |x: Vec<f64>| x.into_iter().map(|x| x as f32).collect();
    World {
        state: single(kernels.initial(model, &q, &v)),
        input: single(wave(5, lengths.input)),
        output: vec![0.0; lengths.output],
        scratch: vec![0.0; lengths.scratch],
    }
}

/// The kernels of dynamics by name.
#[derive(Clone, Copy, Debug)]
enum Kernel {
    MassMatrix,
    InverseDynamics,
    ForwardDynamics,
    AppliedForces,
    Jacobian,
}

impl Kernel {
    const ALL: [Self; 5] = [
        Self::MassMatrix,
        Self::InverseDynamics,
        Self::ForwardDynamics,
        Self::AppliedForces,
        Self::Jacobian,
    ];
    fn run<M: Machine>(self, kernels: &DynamicsKernels, k: &mut M) {
        match self {
            Self::MassMatrix => kernels.mass_matrix(k),
            Self::InverseDynamics => kernels.inverse_dynamics(k),
            Self::ForwardDynamics => kernels.forward_dynamics(k),
            Self::AppliedForces => kernels.applied_forces(k),
            Self::Jacobian => {
                let body = k.index(2);
                kernels.jacobian(k, body);
            }
        }
    }
    fn record(self, model: &Model) -> (DynamicsKernels, Program) {
        let kernels = DynamicsKernels::new(model).unwrap();
        let program = trace::record(|k| self.run(&kernels, k)).unwrap();
        (kernels, program)
    }
}

#[test]
fn every_kernel_stays_in_loops() {
    let (short, long) = (chain(5, Start::Horizontal), chain(10, Start::Horizontal));
    let (short, long) = (short.unwrap(), long.unwrap());
    for kernel in Kernel::ALL {
        let [short, long] = [&short, &long].map(|model| kernel.record(model).1.operations());
        assert_eq!(short, long, "{kernel:?}");
    }
}

#[test]
fn every_kernel_keeps_its_bits_when_traced() {
    let model = mixed(true).unwrap();
    for kernel in Kernel::ALL {
        let (kernels, program) = kernel.record(&model);
        validate(&program, &PrintOptions::default());
        let parameters: Vec<_> = kernels.parameters().iter().map(|&x| x as f32).collect();
        let start = world(&kernels, &model);
        let (mut plain, mut traced) = (start.clone(), start.clone());
        kernel.run(&kernels, &mut plain.cpu(&parameters, kernels.links()));
        let mut cpu = traced.cpu(&parameters, kernels.links());
        program.interpret(&mut cpu).unwrap();
        assert_eq!(bits(&plain), bits(&traced), "{kernel:?}");
        assert_ne!(bits(&plain), bits(&start), "{kernel:?} writes something");
    }
}

#[test]
fn wrong_questions_are_refused() {
    let Case { model, dynamics, n } = Case::mixed();
    let (q, v) = (model.initial_position(), vec![0.0; n]);
    let message = |e: DynamicsError| e.to_string();
    let c = q.len();
    assert_eq!(
        dynamics.mass_matrix(&q[1..]).map_err(message),
        Err(format!("{} coordinates given: the model has {c}", c - 1))
    );
    assert_eq!(
        dynamics.forward_dynamics(&q, &v[1..], &v).map_err(message),
        Err(format!("{} velocities given: the model has {n}", n - 1))
    );
    assert_eq!(
        dynamics.inverse_dynamics(&q, &v, &[]).map_err(message),
        Err(format!("0 accelerations given: the model has {n}"))
    );
    let mut broken = v.clone();
    broken[3] = f64::NAN;
    assert_eq!(
        dynamics.forward_dynamics(&q, &v, &broken).map_err(message),
        Err("number 3 of the forces is NaN: give finite numbers".into())
    );
    let (_, turned) = model.quaternions().next().unwrap();
    let mut q_zero = q.clone();
    q_zero[turned.clone()].fill(0.0);
    let (first, last) = (turned.start, turned.end - 1);
    assert_eq!(
        dynamics.mass_matrix(&q_zero).map_err(message),
        Err(format!(
            "coordinates {first} to {last} are a quaternion, and zero: give one of unit length, x, y, z, w"
        ))
    );
    let bodies = model.bodies.len();
    assert_eq!(
        dynamics
            .jacobian(&q, BodyId(99), DVec3::ZERO)
            .map_err(message),
        Err(format!(
            "body 99 does not exist: the model has {bodies}, counted from 0"
        ))
    );
    assert_eq!(
        dynamics
            .jacobian(&q, BodyId(0), DVec3::INFINITY)
            .map_err(message),
        Err("number 0 of the coordinates of the point is inf: give finite numbers".into())
    );
    let refusal = Dynamics::new(&looped().unwrap()).unwrap_err();
    assert!(
        matches!(refusal, SolverError::ClosedLoop { .. }),
        "{refusal}"
    );
}
