//! Contacts as a user of a simulation sees them.

use glam::DVec3;
use kinetarium_sim::{Quantity, Simulation, SimulationSettings, SolverKind};
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

fn two_boxes() -> Model {
    let mut world = Builder::new("two boxes");
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    world.object("ground").scenery(Shape::new(plane));
    let boxes = world.object("boxes");
    for (i, name) in ["lower", "upper"].into_iter().enumerate() {
        let half = DVec3::splat(0.1);
        let cube = Geometry::Box { half };
        let body = boxes.body(name).shape(cube).mass(MASS).handle();
        let y = 0.1 + 0.2 * i as f64;
        boxes
            .free(format!("{name} float"), body)
            .initial(&[0.3, y, 0.2, 0.0, 0.0, 0.0, 1.0]);
    }
    world.build().unwrap()
}

/// Sum of forces, and of x × f, over the contacts that `Outputs::contacts` tells of.
fn wrenches(simulation: &mut Simulation<f32>, world: usize) -> Vec<[DVec3; 2]> {
    let model = simulation.model().clone();
    let mut sums = vec![[DVec3::ZERO; 2]; model.bodies.len()];
    for contact in simulation.outputs().contacts(world) {
        for (shape, sign) in contact.shapes.into_iter().zip([-1.0, 1.0]) {
            if let Some(body) = model.shapes[shape.0].body {
                sums[body.0][0] += sign * contact.force;
                sums[body.0][1] += sign * contact.position.cross(contact.force);
            }
        }
    }
    sums
}

#[test]
fn contacts_are_summed_for_each_body() {
    // One box on another: the lower one is pressed from both sides; the ground has no row.
    for solver in [
        SolverKind::Featherstone,
        SolverKind::Xpbd,
        SolverKind::Impulse,
    ] {
        let settings = SimulationSettings {
            solver,
            ..SimulationSettings::new(19, 0.002)
        };
        let mut simulation = Simulation::<f32>::new(two_boxes(), settings).unwrap();
        let mut sums = vec![1.0; 19 * 2 * 6];
        simulation.read(Quantity::ContactWrench, &mut sums).unwrap();
        assert!(sums.iter().all(|x| *x == 0.0), "{solver:?}");
        simulation.step(1000);
        simulation.read(Quantity::ContactWrench, &mut sums).unwrap();
        for world in 0..19 {
            let expected = wrenches(&mut simulation, world);
            for (body, [force, torque]) in expected.into_iter().enumerate() {
                let row = &sums[(world * 2 + body) * 6..][..6];
                let row: Vec<f64> = row.iter().map(|x| f64::from(*x)).collect();
                let found = [DVec3::from_slice(&row), DVec3::from_slice(&row[3..])];
                // Rounding of sums of a few terms of up to 60 N in f32: 60 · 2⁻²³ · a few.
                assert!((found[0] - force).length() < 1e-4, "{solver:?} {found:?}");
                assert!((found[1] - torque).length() < 1e-4, "{solver:?} {found:?}");
                // At rest each is held by what it weighs.
                let weight = MASS * G;
                assert!((force.y / weight - 1.0).abs() < 0.02, "{solver:?} {force}");
            }
        }
    }
}
