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
    pub velocity: Vec<f64>,
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
/// A step of length h is off by up to v h / 2. What else there is in the world, and what it falls on, do not matter.
pub fn soft_landings() -> impl Iterator<Item = Landing> {
    let steps = [2e-3, 1e-3, 5e-4, 1e-4].into_iter();
    let phases = steps.flat_map(|h| [0.1, 0.4, 0.7].map(|p| (h, p)));
    let slides = phases.flat_map(|(h, p)| [0.0, 10.0].map(|slide| (h, p, slide)));
    slides.flat_map(|(h, p, slide)| {
        [On::Plane, On::PlaneInCompany, On::Slab].map(|on| soft_landing([h, p, slide], on))
    })
}

/// What a ball lands on.
#[derive(Clone, Copy, Debug, PartialEq)]
enum On {
    Plane,
    /// The same, where there is another ball, which it may touch.
    PlaneInCompany,
    /// A free body a million times as heavy, where nothing weighs anything.
    Slab,
}

fn soft_landing([step, phase, slide]: [f64; 3], on: On) -> Landing {
    let g = if on == On::Slab { 0.0 } else { 9.81 };
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
    let start = radius + speed * touches + 0.5 * g * touches * touches;
    let (t, v) = (end - touches, speed + g * touches);
    let sag = -(1.0 - impedance) * g * constant * constant;
    let depth = sag - (sag + (sag / constant + v) * t) * (-t / constant).exp();

    let mut world = Builder::new("landing");
    world.gravity(-g * DVec3::Y);
    let ball = |density| {
        Shape::new(Geometry::Sphere { radius })
            .with_material(material)
            .with_density(density)
    };
    let mut velocity = vec![slide, -speed, 0.0, 0.0, 0.0, 0.0];
    let object = world.object("");
    let falls = Pose::at(DVec3::Y * start);
    object.body("body").at(falls).shape(ball(1000.0));
    if on == On::PlaneInCompany {
        let away = Pose::at(DVec3::new(0.0, 1.0, 5.0));
        object.body("other").at(away).shape(ball(1000.0));
    }
    if on == On::Slab {
        let half = DVec3::new(10.0, 0.5, 10.0);
        let slab = Shape::new(Geometry::Box { half }).with_material(material);
        let below = Pose::at(-half.y * DVec3::Y);
        let slab = slab.with_density(2e4);
        object.body("slab").at(below).shape(slab);
    } else {
        let ground = Shape::new(plane()).with_material(material);
        world.object("ground").scenery(ground);
    }
    if on != On::Plane {
        velocity.extend([0.0; 6]);
    }
    Landing {
        model: world.build().unwrap(),
        velocity,
        step,
        steps: (end / step).round() as usize,
        height: radius + depth,
        error: 0.5 * v * step,
        name: format!("step {step}, phase {phase}, slides at {slide}, {on:?}"),
    }
}
