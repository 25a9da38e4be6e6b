//! Contacts as a user of a simulation sees them.

use glam::DVec3;
use kinetarium_sim::{Simulation, SimulationSettings};
use model::{Builder, Geometry, Model, Shape, ShapeId};

const G: f64 = 9.81;
const MASS: f64 = 3.0;

/// A ball a little above the ground, with a post to look at.
fn ball() -> Model {
    let mut world = Builder::new("ball");
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    world.object("ground").scenery(Shape::new(plane));
    let balls = world.object("balls");
    let ball = Geometry::Sphere { radius: 0.1 };
    let body = balls.body("ball").shape(ball).mass(MASS).handle();
    balls
        .free("float", body)
        .initial(&[0.3, 0.11, 0.2, 0.0, 0.0, 0.0, 1.0]);
    world.build().unwrap()
}

fn worlds(count: usize) -> Simulation<f32> {
    Simulation::new(ball(), SimulationSettings::new(count, 0.002)).unwrap()
}

#[test]
fn a_ball_at_rest_presses_with_its_weight() {
    let mut simulation = worlds(3);
    simulation.step(1500);
    let outputs = simulation.outputs();
    for world in 0..3 {
        let contacts: Vec<_> = outputs.contacts(world).collect();
        let [contact] = contacts.as_slice() else {
            panic!("{contacts:?}");
        };
        assert_eq!(contact.shapes, [ShapeId(0), ShapeId(1)]);
        assert_eq!(contact.normal, DVec3::Y);
        let weight = MASS * G * DVec3::Y;
        assert!((contact.force - weight).length() < 1e-3 * weight.length());
        assert!(contact.distance < 0.0 && contact.distance > -0.01);
        let below = DVec3::new(0.3, 0.0, 0.2);
        assert!((contact.position - below).length() < 0.01, "{contact:?}");
    }
}

#[test]
fn a_ball_in_the_air_touches_nothing() {
    let mut simulation = worlds(1);
    simulation
        .set_joint_state(0, &[0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0], &[0.0; 6])
        .unwrap();
    simulation.step(10);
    assert_eq!(simulation.outputs().contacts(0).count(), 0);
}

/// A state that is set has no contacts yet; what the world touched before is forgotten.
#[test]
fn a_new_state_forgets_the_contacts() {
    let mut simulation = worlds(1);
    simulation.step(500);
    assert_eq!(simulation.outputs().contacts(0).count(), 1);
    simulation.reset_all();
    assert_eq!(simulation.outputs().contacts(0).count(), 0);
}

#[test]
fn without_contacts_a_ball_falls_through_the_ground() {
    let settings = SimulationSettings {
        contacts: false,
        ..SimulationSettings::new(1, 0.002)
    };
    let mut simulation = Simulation::<f64>::new(ball(), settings).unwrap();
    simulation.step(500);
    let fallen = simulation.outputs().joint_position(0)[1];
    assert!((fallen - (0.11 - 0.5 * G)).abs() < 0.02, "{fallen}");
    assert_eq!(simulation.outputs().contacts(0).count(), 0);
}
