//! Bodies on the ground.

use glam::{DQuat, DVec3};
use model::{Builder, Geometry, Material, Model, Pose, Shape, Softness};

/// A surface with this friction and restitution; both of a pair are alike.
pub fn surface(friction: f64, restitution: f64) -> Material {
    Material {
        friction,
        restitution,
        ..Material::default()
    }
}

pub fn plane() -> Geometry {
    Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    }
}

/// One free body with its centre at `at`, on a plane whose normal is y turned by `slope` [rad] about z.
pub fn on_plane(geometry: Geometry, material: Material, at: DVec3, slope: f64) -> Model {
    let mut world = Builder::new("contact");
    let tilt = DQuat::from_rotation_z(slope);
    let ground = Shape::new(plane())
        .at(Pose::new(DVec3::ZERO, tilt))
        .with_material(material);
    world.object("ground").scenery(ground);
    let shape = Shape::new(geometry).with_material(material);
    let object = world.object("");
    object
        .body("body")
        .at(Pose::new(tilt * at, tilt))
        .shape(shape);
    world.build().unwrap()
}

pub fn cube() -> Geometry {
    Geometry::Box {
        half: DVec3::new(0.1, 0.05, 0.08),
    }
}

/// A ball that falls on a soft surface.
pub struct Landing {
    pub model: Model,
    pub velocity: [f64; 6],
    /// Length [s] and number of steps to look after.
    pub step: f64,
    pub steps: usize,
    /// Where its centre is then [m].
    pub height: f64,
    /// By how much steps of this length may miss that [m].
    pub error: f64,
    /// What it is called when it fails.
    pub name: String,
}

/// What falls on a surface with an added mass m' is slowed by its law alone, from wherever in a step it
/// touches, and however fast it slides. With T the time constant, ζ = 1 and μ = m + m', the depth is
///
/// ```text
/// μ ẍ = −m g − μ x / T² − 2 μ ẋ / T,   x(0) = 0,   ẋ(0) = −v:
/// x = s − (s + (s / T + v) t) e^(−t / T),   s = −(m / μ) g T²
/// ```
///
/// A step of length h is off by up to v h / 2.
pub fn soft_landings() -> impl Iterator<Item = Landing> {
    let steps = [2e-3, 1e-3, 5e-4, 1e-4].into_iter();
    let phases = steps.flat_map(|h| [0.1, 0.4, 0.7].map(|p| (h, p)));
    phases.flat_map(|(h, p)| [0.0, 10.0].map(|slide| soft_landing(h, p, slide)))
}

fn soft_landing(step: f64, phase: f64, slide: f64) -> Landing {
    const G: f64 = 9.81;
    let (constant, impedance, radius, speed, end) = (0.02, 0.9, 0.1, 2.0, 0.03);
    let softness = Softness::Time {
        constant,
        ratio: 1.0,
        impedance,
        mass: None,
    };
    let material = Material {
        softness,
        ..surface(1.0, 0.0)
    };
    let touches = (4.0 + phase) * step;
    let start = radius + speed * touches + 0.5 * G * touches * touches;
    let (t, v) = (end - touches, speed + G * touches);
    let sag = -(1.0 - impedance) * G * constant * constant;
    let depth = sag - (sag + (sag / constant + v) * t) * (-t / constant).exp();
    Landing {
        model: on_plane(Geometry::Sphere { radius }, material, DVec3::Y * start, 0.0),
        velocity: [slide, -speed, 0.0, 0.0, 0.0, 0.0],
        step,
        steps: (end / step).round() as usize,
        height: radius + depth,
        error: 0.5 * v * step,
        name: format!("step {step}, phase {phase}, slides at {slide}"),
    }
}
