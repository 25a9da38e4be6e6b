//! Sensors without noise against closed forms, by all solvers.

mod common;

use common::{
    BOX, G, PENDULUM, SOLVERS, askew, body, close, eye, floating, near, pendulum, read, resting,
    simulate, two,
};
use glam::{DQuat, DVec3};
use kinetarium_sensors::{Axes, Mount, Noise, Sensor, SensorKind, Sensors};
use model::{Actuator, BodyId, Builder, Drive, Geometry, JointId, Pose, Shape};
use rigid::Dynamics;
use sim::{Simulation, SimulationSettings, SolverKind};
use std::f64::consts::{FRAC_PI_2, PI};

fn imu(body: BodyId, pose: Pose) -> SensorKind {
    let mount = Mount::on(body).at(pose);
    SensorKind::Imu { mount }
}

/// At rest, a = 0: an accelerometer reads −g, which is 9.81 m/s² upwards, in its own axes. The box has had
/// 3 s to come to rest; what is left is rounding over the step of 2 ms.
#[test]
fn an_accelerometer_at_rest_reads_g_upwards() {
    let up = askew().orientation.conjugate() * DVec3::new(0.0, G, 0.0);
    for solver in SOLVERS {
        let mut simulation = simulate::<f64>(&resting(), solver, 1, 0.002);
        simulation.step(1500);
        let [a, w] = two(&read(&mut simulation, imu(BodyId(0), askew())));
        near(solver.name(), a, up, 1e-9);
        near(solver.name(), w, DVec3::ZERO, 1e-9);
    }
    let mut simulation = simulate::<f64>(&resting(), SolverKind::Featherstone, 1, 0.002);
    let mount = Mount::in_world(askew());
    let [a, _] = two(&read(&mut simulation, SensorKind::Imu { mount }));
    near("in the world", a, up, 1e-14);
}

/// A world with a gravity of its own: what hangs at rest there reads that.
#[test]
fn an_accelerometer_knows_the_gravity_of_its_world() {
    let mut parts = pendulum().into_parts();
    parts.gravity = DVec3::new(0.0, -1.6, 0.0);
    let moon = model::Model::new(parts).unwrap();
    for solver in SOLVERS {
        let mut simulation = simulate::<f64>(&pendulum(), solver, 2, 0.001);
        simulation.set_world_model(1, &moon).unwrap();
        simulation.step(3);
        let found = read(&mut simulation, imu(BodyId(0), Pose::IDENTITY));
        for (world, g) in [G, 1.6].into_iter().enumerate() {
            let [a, _] = two(&found[6 * world..]);
            near(solver.name(), a, DVec3::new(0.0, g, 0.0), 1e-9);
        }
    }
}

/// What sleeps is at rest.
#[test]
fn what_sleeps_is_felt_as_what_rests() {
    let settings = SimulationSettings {
        threads: 1,
        solver: SolverKind::Impulse,
        ..SimulationSettings::new(1, 0.002)
    };
    let mut simulation = Simulation::<f64>::new(resting(), settings).unwrap();
    simulation.step(1500);
    let body = BodyId(0);
    assert!(simulation.outputs().asleep(0, body));
    let [a, _] = two(&read(&mut simulation, imu(body, Pose::IDENTITY)));
    near("asleep", a, DVec3::new(0.0, G, 0.0), 1e-9);
    let touch = read(&mut simulation, SensorKind::Touch { body });
    close("asleep", touch[0], BOX * G, 1e-3 * BOX * G);
}

/// In free fall a = g: an accelerometer at the centre of mass reads 0, spinning or not.
#[test]
fn an_accelerometer_in_free_fall_reads_nothing() {
    let model = floating();
    let center = Pose::at(model.bodies[0].center);
    for solver in SOLVERS {
        let mut simulation = simulate::<f64>(&model, solver, 1, 0.001);
        let velocity = [1.0, 2.0, -0.5, 0.0, 0.0, 0.0];
        simulation
            .set_joint_state(0, &model.initial_position(), &velocity)
            .unwrap();
        simulation.step(100);
        let [a, _] = two(&read(&mut simulation, imu(BodyId(0), center)));
        near(solver.name(), a, DVec3::ZERO, 1e-9);
    }
    let mut simulation = simulate::<f64>(&model, SolverKind::Featherstone, 1, 0.001);
    let spinning = [1.0, 2.0, -0.5, 3.0, -2.0, 4.0];
    simulation
        .set_joint_state(0, &model.initial_position(), &spinning)
        .unwrap();
    let [a, _] = two(&read(&mut simulation, imu(BodyId(0), center)));
    near("spinning", a, DVec3::ZERO, 1e-12);
}

/// At angle θ and rate ω of a pendulum, α = −m g l sin θ / (I + m l²). A point r below the hinge has, in
/// the pendulum's axes, the proper acceleration
///
/// ```text
/// along x: α r + g sin θ      along y: ω² r + g cos θ
/// ```
///
/// `featherstone` has it at once; the mean over a step h of the others is ½ h ȧ behind.
#[test]
fn a_bob_feels_its_weight_and_its_centripetal_acceleration() {
    let (m, l, i) = PENDULUM;
    let r = 0.7;
    let expected = |angle: f64, rate: f64| {
        let turning = -m * G * l * angle.sin() / (i + m * l * l);
        DVec3::new(
            turning * r + G * angle.sin(),
            rate * rate * r + G * angle.cos(),
            0.0,
        )
    };
    let at = Pose::at(DVec3::new(0.0, -r, 0.0));
    let mut simulation = simulate::<f64>(&pendulum(), SolverKind::Featherstone, 1, 0.001);
    simulation.set_joint_state(0, &[0.8], &[3.0]).unwrap();
    let [a, w] = two(&read(&mut simulation, imu(BodyId(0), at)));
    near("featherstone", a, expected(0.8, 3.0), 1e-12);
    near("featherstone", w, DVec3::new(0.0, 0.0, 3.0), 1e-12);
    for solver in SOLVERS {
        let h = 1e-4;
        let mut simulation = simulate::<f64>(&pendulum(), solver, 1, h);
        simulation.set_joint_state(0, &[0.8], &[3.0]).unwrap();
        simulation.step(2000);
        let outputs = simulation.outputs();
        let (angle, rate) = (outputs.coordinate(0, 0), outputs.dof_velocity(0, 0));
        let [a, w] = two(&read(&mut simulation, imu(BodyId(0), at)));
        // |ȧ| is at most (m g l / (I + m l²) + g) ω + 3 ω |α| r ≈ 300 m/s³.
        near(solver.name(), a, expected(angle, rate), h * 300.0);
        near(solver.name(), w, DVec3::new(0.0, 0.0, rate), 1e-6);
    }
}

/// A gyroscope reads the angular velocity in its own axes: of a free body, the rates of its joint, which
/// are in the body's axes.
#[test]
fn a_gyroscope_reads_the_spin_in_its_own_axes() {
    let model = floating();
    let spin = DVec3::new(1.0, -2.0, 0.5);
    for solver in SOLVERS {
        let mut simulation = simulate::<f64>(&model, solver, 1, 0.001);
        let mut position = model.initial_position();
        let turn = DQuat::from_scaled_axis(DVec3::new(-0.3, 0.8, 1.1));
        position[3..].copy_from_slice(&turn.to_array());
        let velocity = [0.0, 0.0, 0.0, spin.x, spin.y, spin.z];
        simulation.set_joint_state(0, &position, &velocity).unwrap();
        let [_, w] = two(&read(&mut simulation, imu(BodyId(0), askew())));
        let expected = askew().orientation.conjugate() * spin;
        near(solver.name(), w, expected, 1e-12);
    }
}

/// A weight m on a hinge about x, its centre r along x and d below: the hinge holds it up with m g, and
/// with m g r about z, which it locks.
#[test]
fn a_hinge_carries_the_weight_and_its_moment() {
    let (m, r, d) = (1.2, 0.5, 0.3);
    let mut world = Builder::new("weight");
    let object = world.object("");
    let weight = body(
        object,
        "weight",
        m,
        DVec3::new(r, -d, 0.0),
        DVec3::splat(0.02),
    );
    let hinge = object.revolute("hinge", weight, DVec3::X);
    hinge.frames(Pose::at(DVec3::Y), Pose::IDENTITY);
    let model = world.build().unwrap();
    for solver in SOLVERS {
        let mut simulation = simulate::<f64>(&model, solver, 1, 0.001);
        simulation.step(20);
        let mut at = |frame| {
            let joint = JointId(0);
            two(&read(
                &mut simulation,
                SensorKind::ForceTorque { joint, frame },
            ))
        };
        let [force, torque] = at(None);
        near(solver.name(), force, DVec3::new(0.0, m * G, 0.0), 1e-8);
        near(solver.name(), torque, DVec3::new(0.0, 0.0, m * G * r), 1e-8);

        // About the centre of mass the force alone has that torque, and holds it.
        let center = Pose::new(DVec3::new(r, -d, 0.0), askew().orientation);
        let [force, torque] = at(Some(center));
        let up = askew().orientation.conjugate() * DVec3::new(0.0, m * G, 0.0);
        near(solver.name(), force, up, 1e-8);
        near(solver.name(), torque, DVec3::ZERO, 1e-8);
    }
}

/// What lies on the ground is held by its weight: m g upwards.
#[test]
fn a_resting_box_touches_with_its_weight() {
    for solver in SOLVERS {
        let mut simulation = simulate::<f64>(&resting(), solver, 1, 0.002);
        let body = BodyId(0);
        simulation.step(1500);
        let touch = read(&mut simulation, SensorKind::Touch { body });
        close(solver.name(), touch[0], BOX * G, 1e-9);
        for axes in [Axes::World, Axes::Own] {
            let force = read(&mut simulation, SensorKind::ContactForce { body, axes });
            let up = DVec3::new(0.0, BOX * G, 0.0);
            near(solver.name(), DVec3::from_slice(&force), up, 1e-9);
        }
    }
}

/// A frame on a body is X_body X_mount; a point r from the body's origin moves with v + ω × r.
#[test]
fn frames_are_where_their_bodies_carry_them() {
    let model = floating();
    for solver in SOLVERS {
        let mut simulation = simulate::<f64>(&model, solver, 1, 0.001);
        let body = Pose::new(
            DVec3::new(3.0, -1.0, 2.0),
            DQuat::from_scaled_axis(DVec3::new(-0.3, 0.8, 1.1)),
        );
        let position = [&body.position.to_array()[..], &body.orientation.to_array()].concat();
        let (v, spin) = (DVec3::new(0.5, 1.5, -2.0), DVec3::new(1.0, -2.0, 0.5));
        let velocity = [v.to_array(), spin.to_array()].concat();
        simulation.set_joint_state(0, &position, &velocity).unwrap();
        let mount = Mount::on(BodyId(0)).at(askew());
        let expected = body * askew();
        let mut pose = |relative_to| {
            let found = read(
                &mut simulation,
                SensorKind::FramePose { mount, relative_to },
            );
            Pose::new(DVec3::from_slice(&found), DQuat::from_slice(&found[3..]))
        };
        let found = pose(Mount::default());
        near(solver.name(), found.position, expected.position, 1e-12);
        assert!(found.orientation.dot(expected.orientation).abs() > 1.0 - 1e-12);
        let found = pose(Mount::on(BodyId(0)));
        near(solver.name(), found.position, askew().position, 1e-12);
        assert!(found.orientation.dot(askew().orientation).abs() > 1.0 - 1e-12);

        let angular = body.orientation * spin;
        let linear = v + angular.cross(body.orientation * askew().position);
        for (axes, turn) in [
            (Axes::World, DQuat::IDENTITY),
            (Axes::Own, expected.orientation.conjugate()),
        ] {
            let found = read(&mut simulation, SensorKind::FrameVelocity { mount, axes });
            let [v, w] = two(&found);
            near(solver.name(), v, turn * linear, 1e-12);
            near(solver.name(), w, turn * angular, 1e-12);
        }
    }
}

/// A room of half sizes 4 × 3 × 5 m about the origin, seen by what stands in a ball, at p: along d the
/// first wall is at the least of (± half − p) / d over the axes.
#[test]
fn a_lidar_in_a_room_reads_the_distances_of_its_walls() {
    let half = DVec3::new(4.0, 3.0, 5.0);
    let mut world = Builder::new("room");
    world.gravity(DVec3::ZERO);
    let room = world.object("room");
    for axis in DVec3::AXES {
        for side in [-1.0, 1.0] {
            let wall = Geometry::Box {
                half: (axis * 0.1).max(DVec3::splat(6.0) * (DVec3::ONE - axis)),
            };
            let middle = side * axis * (half + 0.1);
            room.scenery(Shape::new(wall).at(Pose::at(middle)));
        }
    }
    let object = world.object("robot");
    object
        .body("robot")
        .shape(Geometry::Sphere { radius: 0.5 })
        .at(Pose::at(DVec3::new(1.0, -0.5, 2.0)));
    let model = world.build().unwrap();
    let mut simulation = simulate::<f64>(&model, SolverKind::Featherstone, 3, 0.001);
    simulation.step(1);

    let mount = Mount::on(BodyId(0)).at(askew());
    let azimuths = SensorKind::fan(-PI, FRAC_PI_2, 37);
    let elevations = vec![-0.3, 0.0, 0.7];
    let kind = SensorKind::Lidar {
        mount,
        azimuths: azimuths.clone(),
        elevations: elevations.clone(),
        max_range: 5.5,
    };
    let found = read(&mut simulation, kind);
    let at = Pose::at(DVec3::new(1.0, -0.5, 2.0)) * askew();
    let mut beyond = 0;
    for (row, elevation) in elevations.iter().enumerate() {
        for (column, azimuth) in azimuths.iter().enumerate() {
            let d = DVec3::new(
                elevation.cos() * azimuth.cos(),
                elevation.cos() * azimuth.sin(),
                elevation.sin(),
            );
            let d = at.direction(d);
            let distances = (half * d.signum() - at.position) / d;
            let expected = distances.min_element();
            beyond += usize::from(expected > 5.5);
            for world in 0..3 {
                let i = (3 * world + row) * azimuths.len() + column;
                close("distance", found[i], expected.min(5.5), 1e-9);
            }
        }
    }
    assert!(beyond > 5, "some rays must find nothing");
    let nothing = SensorKind::Rangefinder {
        mount: Mount::in_world(Pose::at(DVec3::new(100.0, 0.0, 0.0))),
        max_range: f64::INFINITY,
    };
    assert_eq!(read(&mut simulation, nothing), [f64::INFINITY; 3]);
}

/// A rangefinder reads what a ray of the simulation meets, in a world whose shapes are its own as well.
#[test]
fn a_rangefinder_reads_what_a_ray_meets() {
    let model = resting();
    let mut simulation = simulate::<f32>(&model, SolverKind::Featherstone, 2, 0.002);
    let mut parts = model.clone().into_parts();
    for shape in &mut parts.shapes {
        if let Geometry::Box { half } = &mut shape.geometry {
            *half *= 1.5;
        }
    }
    let larger = model::Model::new(parts).unwrap();
    simulation.set_world_model(1, &larger).unwrap();
    let down = Pose::new(
        DVec3::new(0.02, 2.0, 0.01),
        DQuat::from_rotation_z(-FRAC_PI_2),
    );
    let kind = SensorKind::Rangefinder {
        mount: Mount::in_world(down),
        max_range: 10.0,
    };
    let found = read(&mut simulation, kind);
    for (world, found) in found.iter().enumerate() {
        let hit = simulation
            .cast_ray(world, down.position, -DVec3::Y, 10.0)
            .unwrap()
            .unwrap();
        close("distance", *found, hit.distance, 1e-6);
    }
    assert!(found[0] > found[1] + 0.04, "{found:?}");
}

/// M q̈ + b = τ: without springs, dampers, friction and limits, what drives and actuators do is what it
/// takes to accelerate so.
#[test]
fn effort_is_what_inverse_dynamics_asks_for() {
    let model = driven();
    let joints: Vec<_> = (0..model.joints.len()).map(JointId).collect();
    let mut simulation = simulate::<f64>(&model, SolverKind::Featherstone, 1, 0.001);
    let position = moved(&model);
    let velocity: Vec<f64> = (0..model.degrees_of_freedom())
        .map(|i| 0.3 - 0.2 * i as f64)
        .collect();
    simulation.set_joint_state(0, &position, &velocity).unwrap();
    set_controls(&mut simulation);
    // Drives take up a new target in the next step.
    simulation.step(1);
    let outputs = simulation.outputs();
    let (position, velocity) = (outputs.joint_position(0), outputs.joint_velocity(0));
    let acceleration = outputs.joint_acceleration(0);
    let dynamics = Dynamics::new(&model).unwrap();
    let expected = dynamics
        .inverse_dynamics(&position, &velocity, &acceleration)
        .unwrap();
    let found = read(&mut simulation, SensorKind::JointEffort { joints });
    assert_eq!(found.len(), expected.len());
    for (dof, (found, expected)) in found.iter().zip(&expected).enumerate() {
        close(format!("effort {dof}"), *found, *expected, 1e-9);
    }
    assert!(found.iter().all(|x| x.abs() > 1e-3), "{found:?}");
}

/// Hinges with a drive whose coordinate is a turn off, an effort limit that bites, a motor and a servo with
/// bounds; a ball with a drive.
fn driven() -> model::Model {
    let mut world = Builder::new("driven");
    let object = world.object("");
    let mut parent = None;
    let drive = Drive {
        stiffness: 5.0,
        damping: 0.4,
        target_position: 0.7,
        target_velocity: 0.2,
        ..Drive::default()
    };
    let weak = Drive {
        effort_limit: 0.6,
        ..drive
    };
    let center = DVec3::new(0.0, -0.3, 0.0);
    for name in ["driven", "weak", "motor", "servo", "ball"] {
        let link = body(object, name, 1.0, center, DVec3::splat(0.05));
        let joint = if name == "ball" {
            object.ball(name, link)
        } else {
            object.revolute(name, link, DVec3::Z)
        };
        if let Some(parent) = parent {
            let end = Pose::at(DVec3::new(0.0, -0.6, 0.0));
            joint.parent(parent).frames(end, Pose::IDENTITY);
        }
        match name {
            "driven" | "ball" => joint.drive(drive),
            "weak" => joint.drive(weak),
            _ => joint,
        };
        parent = Some(link);
    }
    let mut parts = world.build().unwrap().into_parts();
    parts.actuators = vec![
        Actuator {
            gear: 2.0,
            control_range: Some((-1.0, 1.0)),
            ..Actuator::motor("motor", JointId(2))
        },
        Actuator {
            gear: 1.5,
            ..Actuator::position("servo", JointId(3), 4.0, 0.3)
        },
        Actuator {
            force_range: Some((-0.4, 0.4)),
            ..Actuator::velocity("weak servo", JointId(2), 3.0)
        },
    ];
    model::Model::new(parts).unwrap()
}

fn moved(model: &model::Model) -> Vec<f64> {
    let ball = DQuat::from_scaled_axis(DVec3::new(0.5, -0.4, 0.9));
    let mut position = vec![6.0, -0.4, 0.3, 0.9];
    position.extend(ball.to_array());
    assert_eq!(position.len(), model.coordinates());
    position
}

fn set_controls(simulation: &mut Simulation<f64>) {
    let mut controls = simulation.controls();
    controls.set_control(0, &[3.0, 0.2, -0.5]).unwrap();
    controls.set_dof_force(0, 1, 0.35).unwrap();
    controls.set_target(0, 4, -0.3).unwrap();
}

/// The joints' own numbers, in the order asked for, and what acts on them by every solver the same laws.
#[test]
fn joints_are_read_in_the_order_asked_for() {
    let model = driven();
    let order = [JointId(4), JointId(1)];
    let mut efforts = Vec::new();
    for solver in SOLVERS {
        // Actuators on axes only, so that all solvers take the model.
        let mut simulation = simulate::<f64>(&model, solver, 2, 0.001);
        let velocity = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7];
        simulation
            .set_joint_state(1, &moved(&model), &velocity)
            .unwrap();
        let joints = order.to_vec();
        let position = read(&mut simulation, SensorKind::JointPosition { joints });
        let expected = [&moved(&model)[4..], &[-0.4]].concat();
        for (found, expected) in position[5..].iter().zip(expected) {
            close(solver.name(), *found, expected, 1e-12);
        }
        let joints = order.to_vec();
        let velocities = read(&mut simulation, SensorKind::JointVelocity { joints });
        for (found, expected) in velocities[4..].iter().zip([0.5, 0.6, 0.7, 0.2]) {
            close(solver.name(), *found, expected, 1e-12);
        }
        let joints = order.to_vec();
        efforts.push(read(&mut simulation, SensorKind::JointEffort { joints }));
    }
    for other in &efforts[1..] {
        for (a, b) in efforts[0].iter().zip(other) {
            close("effort", *a, *b, 1e-9);
        }
    }
}

/// A camera sees what the ray-caster draws, and its images hold from sample to sample.
#[test]
fn a_camera_draws_each_world_when_it_is_due() {
    use kinetarium_sensors::{Camera, Channels, ImageNoise, View};
    let model = resting();
    let mut simulation = simulate::<f32>(&model, SolverKind::Featherstone, 2, 0.01);
    let above = DVec3::new(0.0, 0.5, 2.0);
    let camera = Camera::new(16, 12, 0.6).looking(above, DVec3::ZERO, DVec3::Y);
    let view = View::new(camera).with_channels(Channels::ALL);
    let mut lifted = model.initial_position();
    lifted[1] += 0.2;
    simulation.set_joint_state(1, &lifted, &[0.0; 6]).unwrap();
    let noise = ImageNoise::default();
    let sensor = Sensor::new("eye", eye(view.clone(), noise)).with_rate(10.0);
    let mut sensors = Sensors::new(&mut simulation, vec![sensor], 0).unwrap();
    let before = sensors.images("eye").unwrap().images.clone();

    let scene = render::Scene::new(&model).unwrap();
    let draw = |simulation: &mut Simulation<f32>| {
        let outputs = simulation.outputs();
        let poses = [0, 1].map(|world| [outputs.body_pose(world, BodyId(0))]);
        let poses: Vec<&[Pose]> = poses.iter().map(|p| &p[..]).collect();
        render::ray_caster::render(&scene, &view, &poses).unwrap()
    };
    assert_eq!(before, draw(&mut simulation));
    sensors.step(&mut simulation, 9).unwrap();
    assert_eq!(before, *sensors.images("eye").unwrap().images);
    sensors.step(&mut simulation, 1).unwrap();
    let after = sensors.images("eye").unwrap();
    assert_eq!(*after.images, draw(&mut simulation));
    assert_ne!(*after.images, before);
    assert!(after.time.iter().all(|t| (t - 0.1).abs() < 1e-9));
}

/// Of gear · clamp(gain · u + bias · (1, l, l̇), range) what stands behind the gear, l = gear · q.
#[test]
fn actuators_tell_their_force_before_the_gear() {
    let model = driven();
    let mut simulation = simulate::<f64>(&model, SolverKind::Featherstone, 1, 0.001);
    let velocity = [0.1, 0.2, -0.7, 0.4, 0.0, 0.0, 0.0];
    simulation
        .set_joint_state(0, &moved(&model), &velocity)
        .unwrap();
    set_controls(&mut simulation);
    let actuators = vec![0, 1, 2];
    let found = read(&mut simulation, SensorKind::ActuatorForce { actuators });
    // The control 3 is clamped to 1; 4 (0.2 − 1.5 · 0.9) − 0.3 · 1.5 · 0.4; 3 (−0.5 + 0.7) = 0.6, clamped to 0.4.
    let expected = [1.0, 4.0 * (0.2 - 1.5 * 0.9) - 0.3 * 1.5 * 0.4, 0.4];
    for (found, expected) in found.iter().zip(expected) {
        close("actuator", *found, expected, 1e-14);
    }
}

/// C = Σ m c / Σ m over a body and what it carries, with each world's own masses.
#[test]
fn centers_of_mass_are_of_what_a_body_carries() {
    let mut world = Builder::new("arm");
    let object = world.object("");
    let link = |object: &mut model::Object, name| {
        body(object, name, 1.0, 0.5 * DVec3::X, DVec3::splat(0.1))
    };
    let (upper, lower) = (link(object, "upper"), link(object, "lower"));
    object.revolute("shoulder", upper, DVec3::Z);
    let elbow = object.revolute("elbow", lower, DVec3::Z).parent(upper);
    elbow.frames(Pose::at(DVec3::X), Pose::IDENTITY);
    let model = world.build().unwrap();
    let mut parts = model.clone().into_parts();
    parts.bodies[1].mass = 3.0;
    let heavy = model::Model::new(parts).unwrap();
    for solver in SOLVERS {
        let mut simulation = simulate::<f64>(&model, solver, 2, 0.001);
        simulation.set_world_model(1, &heavy).unwrap();
        for world in 0..2 {
            // Along x, then down.
            let bent = [0.0, -FRAC_PI_2];
            simulation.set_joint_state(world, &bent, &[0.0; 2]).unwrap();
        }
        let (first, second) = (DVec3::new(0.5, 0.0, 0.0), DVec3::new(1.0, -0.5, 0.0));
        let found = read(&mut simulation, SensorKind::CenterOfMass { body: None });
        near(
            "light",
            DVec3::from_slice(&found),
            0.5 * (first + second),
            1e-12,
        );
        let all = 0.25 * first + 0.75 * second;
        near("heavy", DVec3::from_slice(&found[3..]), all, 1e-12);
        for (body, expected) in [(0, all), (1, second)] {
            let body = Some(BodyId(body));
            let found = read(&mut simulation, SensorKind::CenterOfMass { body });
            near("part", DVec3::from_slice(&found[3..]), expected, 1e-12);
        }
    }
}

/// A part of a sensor's numbers, cut off.
#[test]
fn parts_are_told_alone_and_cut_off() {
    let mut simulation = simulate::<f64>(&floating(), SolverKind::Featherstone, 3, 0.001);
    let position = [1.0, -2.0, 0.5, 0.0, 0.0, 0.6, 0.8];
    let velocity = [0.0, 0.0, 0.0, 3.0, -0.25, -9.0];
    for world in 0..3 {
        simulation
            .set_joint_state(world, &position, &velocity)
            .unwrap();
    }
    let (mount, relative_to) = (Mount::on(BodyId(0)), Mount::default());
    let pose = SensorKind::FramePose { mount, relative_to };
    let list = vec![
        Sensor::new("gyro", SensorKind::Imu { mount })
            .with_part(3..6)
            .with_cutoff(2.0),
        Sensor::new("turn", pose)
            .with_part(3..7)
            .with_noise(Noise::white(0.1)),
    ];
    let sensors = Sensors::new(&mut simulation, list, 0).unwrap();
    let gyro = sensors.reading("gyro").unwrap();
    assert_eq!(gyro.shape, [3, 3]);
    for spin in gyro.numbers.chunks(3) {
        near(
            "gyro",
            DVec3::from_slice(spin),
            DVec3::new(2.0, -0.25, -2.0),
            1e-14,
        );
    }
    let turn = sensors.reading("turn").unwrap();
    assert_eq!(turn.shape, [3, 4]);
    for q in turn.numbers.chunks(4) {
        let q = DQuat::from_slice(q);
        close("length", q.length(), 1.0, 1e-14);
        assert!(q.dot(DQuat::from_slice(&position[3..])) > 0.8 && q.x != 0.0);
    }
}
