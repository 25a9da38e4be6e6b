//! What a simulation tells of its contacts and limits.

use glam::DVec3;
use kinetarium_sim::{Event, EventKind, Simulation, SimulationSettings, Watch};
use model::{Builder, Geometry, Limit, Material, Model, Shape, ShapeId};

const H: f64 = 0.002;
const MASS: f64 = 2.0;
const BALL_ON_GROUND: [ShapeId; 2] = [ShapeId(0), ShapeId(1)];

/// A ball that falls on the ground from 0.2 m; beside it, a pendulum that swings against its stops.
fn scene(restitution: f64) -> Model {
    let mut world = Builder::new("scene");
    let material = Material {
        restitution,
        ..Material::default()
    };
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    let ground = Shape::new(plane).with_material(material);
    world.object("ground").scenery(ground);
    let things = world.object("things");
    let ball = Shape::new(Geometry::Sphere { radius: 0.1 }).with_material(material);
    let ball = things.body("ball").shape(ball).mass(MASS).handle();
    things
        .free("float", ball)
        .initial(&[0.0, 0.3, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let bob = things
        .body("bob")
        .inertia(1.0, DVec3::Y * -0.5, glam::DMat3::IDENTITY * 0.01)
        .handle();
    things
        .revolute("hinge", bob, DVec3::Z)
        .initial(&[0.4])
        .limit(Limit {
            lower: -0.3,
            upper: 0.5,
            stiffness: 1e4,
            damping: 0.0,
        });
    world.build().unwrap()
}

fn events(restitution: f64, worlds: usize, threads: usize, watch: Watch) -> Vec<Event> {
    let settings = SimulationSettings {
        threads,
        ..SimulationSettings::new(worlds, H)
    };
    let mut simulation = Simulation::<f32>::new(scene(restitution), settings).unwrap();
    simulation.watch(watch);
    simulation.step(600);
    simulation.drain_events()
}

/// Up to its stop, and what gravity adds meanwhile, the ball's momentum m √(2 g h) is given back
/// twice: a bounce with e = 1.
#[test]
fn a_bounce_begins_and_ends_with_its_impulse() {
    let watch = Watch {
        contacts: true,
        ..Watch::default()
    };
    let told = events(1.0, 1, 1, watch);
    let [first, second, ..] = told.as_slice() else {
        panic!("{told:?}");
    };
    let EventKind::ContactBegins { shapes, impulse } = first.kind else {
        panic!("{first:?}");
    };
    assert_eq!(shapes, BALL_ON_GROUND);
    let (fall, g) = (0.2, 9.81);
    let speed = f64::sqrt(2.0 * g * fall);
    assert!(
        (impulse.y - 2.0 * MASS * speed).abs() < 0.03 * impulse.y,
        "{impulse}"
    );
    assert!((first.time - speed / g).abs() < 2.0 * H, "{first:?}");
    let ends = EventKind::ContactEnds { shapes };
    assert_eq!((second.kind, second.world), (ends, 0));
    assert!((second.time - first.time - H).abs() < 1e-9, "{second:?}");
}

#[test]
fn a_contact_that_persists_is_told_in_every_step() {
    let told = events(0.0, 1, 1, Watch::ALL);
    let begin = told
        .iter()
        .position(|e| matches!(e.kind, EventKind::ContactBegins { .. }))
        .unwrap();
    let persists = |e: &&Event| matches!(e.kind, EventKind::ContactPersists { .. });
    let last = told[begin..].iter().rfind(persists).unwrap();
    let EventKind::ContactPersists { impulse, .. } = last.kind else {
        unreachable!("filtered");
    };
    assert!((last.time - 600.0 * H).abs() < 1e-9);
    assert!((impulse.y - MASS * 9.81 * H).abs() < 1e-3 * impulse.y);
}

#[test]
fn a_pendulum_reaches_its_lower_stop() {
    let watch = Watch {
        limits: true,
        ..Watch::default()
    };
    let told = events(0.0, 1, 1, watch);
    let lower = EventKind::LimitReached {
        dof: 6,
        upper: false,
    };
    assert!(
        !told.is_empty() && told.iter().all(|e| e.kind == lower),
        "{told:?}"
    );
    // A quarter of its period at small angles, √(l/g) π/2, brings it down; the stop is a little beyond.
    assert!((0.2..0.6).contains(&told[0].time), "{told:?}");
}

#[test]
fn the_order_is_the_same_whatever_the_threads() {
    let one = events(0.5, 40, 1, Watch::ALL);
    assert_eq!(one, events(0.5, 40, 2, Watch::ALL));
    assert!(one.is_sorted_by(|a, b| (a.time, a.world) <= (b.time, b.world)));
}

#[test]
fn a_subscriber_hears_the_same() {
    let mut simulation = Simulation::<f32>::new(scene(0.5), SimulationSettings::new(3, H)).unwrap();
    simulation.watch(Watch::ALL);
    let mut heard = Vec::new();
    simulation.step_with(600, |event| heard.push(*event));
    let drained = events(0.5, 3, 1, Watch::ALL);
    assert_eq!(heard.len(), drained.len());
    for (a, b) in heard.iter().zip(&drained) {
        assert_eq!((a.world, a.kind), (b.world, b.kind));
        assert!((a.time - b.time).abs() < 1e-9);
    }
}

/// A reset world is not told to have left the ground, and touches it anew.
#[test]
fn a_reset_is_no_event() {
    let mut simulation = Simulation::<f32>::new(scene(0.0), SimulationSettings::new(1, H)).unwrap();
    let watch = Watch {
        contacts: true,
        ..Watch::default()
    };
    simulation.watch(watch);
    simulation.step(300);
    assert_eq!(simulation.drain_events().len() % 2, 1, "it lies there");
    simulation.reset_all();
    simulation.step(20);
    assert_eq!(simulation.drain_events(), []);
}

#[test]
fn nothing_is_told_unasked() {
    let mut simulation = Simulation::<f32>::new(scene(0.0), SimulationSettings::new(1, H)).unwrap();
    simulation.step(300);
    assert_eq!(simulation.drain_events(), []);
}
