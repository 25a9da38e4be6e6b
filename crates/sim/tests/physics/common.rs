//! What the tests share: methods, small models, and how to compare.

use glam::{DMat3, DVec3};
use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::{BodyHandle, Builder, JointDraft, Model, Object};
use numbers::Float;
use rigid::Integrator;

/// Gravity of models that do not say otherwise [m/s²].
pub const G: f64 = 9.81;

/// What decides a trajectory, apart from the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    Featherstone(Integrator),
    /// With so many substeps per step.
    Xpbd(usize),
    /// With so many small steps per step.
    Impulse(usize),
}

pub const EULER: Method = Method::Featherstone(Integrator::SemiImplicitEuler);
pub const EXPLICIT_EULER: Method = Method::Featherstone(Integrator::ExplicitEuler);
pub const VERLET: Method = Method::Featherstone(Integrator::Verlet);
pub const RK4: Method = Method::Featherstone(Integrator::RungeKutta4);
pub const XPBD: Method = Method::Xpbd(1);
pub const IMPULSE: Method = Method::Impulse(1);
/// All solvers as they come.
pub const SOLVERS: [Method; 3] = [EULER, XPBD, IMPULSE];

impl Method {
    /// Settings of so many worlds with a time step h [s].
    pub fn settings(self, worlds: usize, h: f64) -> SimulationSettings {
        let mut settings = SimulationSettings {
            threads: 1,
            ..SimulationSettings::new(worlds, h)
        };
        match self {
            Self::Featherstone(integrator) => {
                settings.solver = SolverKind::Featherstone;
                settings.step.integrator = integrator;
            }
            Self::Xpbd(substeps) => {
                settings.solver = SolverKind::Xpbd;
                settings.contacts = false;
                settings.step.substeps = substeps;
            }
            Self::Impulse(steps) => {
                settings.solver = SolverKind::Impulse;
                settings.contacts = false;
                settings.step.contact_iterations = steps;
                settings.step.sleep_speed = 0.0;
            }
        }
        settings
    }
    /// One world of a model, with a time step h [s].
    pub fn simulate<T: Float>(self, model: &Model, h: f64) -> Simulation<T> {
        Simulation::new(model.clone(), self.settings(1, h)).unwrap()
    }
}

/// Adds a body with principal moments of inertia [kg·m²] along its axes.
pub fn body(
    object: &mut Object,
    name: &str,
    mass: f64,
    center: DVec3,
    moments: DVec3,
) -> BodyHandle {
    object
        .body(name)
        .inertia(mass, center, DMat3::from_diagonal(moments))
        .handle()
}

/// Mass [kg] and moment of inertia [kg·m²] of [`slider`] and [`wheel`].
pub const MASS: f64 = 2.0;

/// A body that slides along x, without gravity.
pub fn slider(configure: impl Fn(&mut JointDraft)) -> Model {
    let mut world = Builder::new("slider");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let cart = body(object, "cart", MASS, DVec3::ZERO, DVec3::ONE);
    configure(object.prismatic("axis", cart, DVec3::X));
    world.build().unwrap()
}

/// A body that turns about z through its centre: along its coordinate it is the [`slider`] again.
pub fn wheel(configure: impl Fn(&mut JointDraft)) -> Model {
    let mut world = Builder::new("wheel");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let wheel = body(
        object,
        "wheel",
        1.0,
        DVec3::ZERO,
        DVec3::new(1.5, 1.2, MASS),
    );
    configure(object.revolute("axis", wheel, DVec3::Z));
    world.build().unwrap()
}

/// Mass [kg], distance of its centre from the hinge [m], and moment about that centre [kg·m²].
pub const PENDULUM: (f64, f64, f64) = (1.5, 0.4, 0.03);

/// A pendulum about z; it hangs at 0.
pub fn pendulum() -> Model {
    let (m, l, i) = PENDULUM;
    let mut world = Builder::new("pendulum");
    let object = world.object("");
    let bob = body(
        object,
        "bob",
        m,
        DVec3::new(0.0, -l, 0.0),
        DVec3::new(i, 0.01, i),
    );
    object.revolute("hinge", bob, DVec3::Z);
    world.build().unwrap()
}

/// Angular frequency of the [`pendulum`]'s small swings [rad/s].
pub fn pendulum_frequency() -> f64 {
    let (m, l, i) = PENDULUM;
    (m * G * l / (i + m * l * l)).sqrt()
}

/// A body on its own, without gravity, with its centre in its origin.
pub fn floating(moments: DVec3) -> Model {
    let mut world = Builder::new("floating");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    body(object, "body", 1.0, DVec3::ZERO, moments);
    world.build().unwrap()
}

/// Arithmetic–geometric mean, by which elliptic integrals are had (Gauss 1799).
pub fn agm(mut a: f64, mut b: f64) -> f64 {
    while (a - b).abs() > 1e-15 * a {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}

/// Complete elliptic integral of the first kind of modulus k.
pub fn elliptic_k(k: f64) -> f64 {
    std::f64::consts::FRAC_PI_2 / agm(1.0, (1.0 - k * k).sqrt())
}

/// Fails where a number is further from what it should be than the tolerance, and says by how much.
#[track_caller]
pub fn close(what: impl std::fmt::Display, found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs();
    println!("{what}: {found:.9e}, error {error:.2e} of {tolerance:.2e}");
    assert!(
        error <= tolerance,
        "{what} is {found}, should be {expected}: error {error:e}, tolerance {tolerance:e}"
    );
}

/// As [`close`], for vectors.
#[track_caller]
pub fn near(what: impl std::fmt::Display, found: DVec3, expected: DVec3, tolerance: f64) {
    let error = found.distance(expected);
    println!("{what}: {found}, error {error:.2e} of {tolerance:.2e}");
    assert!(
        error <= tolerance,
        "{what} is {found}, should be {expected}: error {error:e}, tolerance {tolerance:e}"
    );
}

/// Fails unless an error vanishes like h^order: each halving of h must divide it by 2^order.
///
/// The next power of h lets the measured order differ from the nominal one by O(h); `slack` is
/// what the largest h leaves.
#[track_caller]
pub fn vanishes(
    what: impl std::fmt::Display,
    order: f64,
    slack: f64,
    h: f64,
    error: impl Fn(f64) -> f64,
) {
    let errors = [h, h / 2.0, h / 4.0].map(error);
    let found = [0, 1].map(|i| (errors[i] / errors[i + 1]).log2());
    let errors = errors.map(|e| format!("{e:.3e}")).join(", ");
    println!("{what}: errors {errors}, orders {found:.3?}");
    for found in found {
        assert!(
            (found - order).abs() <= slack,
            "{what} is of order {found:.3}, should be {order} ± {slack}: errors {errors}"
        );
    }
}
