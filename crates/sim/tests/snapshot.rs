//! A snapshot brings back every bit, in lanes of any width, and refuses what does not fit.

use glam::{DMat3, DQuat, DVec3};
use kinetarium_sim::{
    Simulation, SimulationError, SimulationSettings, Snapshot, SnapshotError, SolverKind,
};
use model::examples::n_pendula;
use model::{BodyId, Builder, Geometry, JointId, Material, Model, Pose, Shape};
use numbers::Float;

const WORLDS: usize = 21;

fn settings() -> SimulationSettings {
    SimulationSettings::new(WORLDS, 0.002)
}

/// Worlds that start apart, the 17th of them at a speed at which it diverges, after some steps.
fn moved<T: Float>(settings: SimulationSettings) -> Simulation<T> {
    let mut simulation = Simulation::new(n_pendula(3).unwrap(), settings).unwrap();
    for world in 0..settings.worlds {
        let speed = if world == 17 { 1e6 } else { 0.1 * world as f64 };
        simulation
            .set_joint_state(world, &[0.1, 0.2, 0.3], &[speed, 0.0, 0.0])
            .unwrap();
        simulation
            .controls()
            .set_dof_force(world, 1, 0.5 * world as f64)
            .unwrap();
    }
    simulation.step(40);
    simulation
}

/// Everything that can be seen of a simulation.
fn seen<T: Float>(simulation: &mut Simulation<T>) -> Vec<Vec<u64>> {
    let times: Vec<f64> = (0..simulation.worlds())
        .map(|w| simulation.time(w))
        .collect();
    let diverged: Vec<f64> = simulation
        .diverged()
        .iter()
        .flat_map(|d| [d.world as f64, d.time])
        .collect();
    let outputs = simulation.outputs();
    let worlds = (0..outputs.worlds()).map(|w| {
        let velocity = outputs.joint_velocity(w);
        [
            outputs.joint_position(w),
            velocity,
            outputs.joint_acceleration(w),
        ]
        .concat()
    });
    let all = worlds.chain([times, diverged]);
    all.map(|row| row.into_iter().map(f64::to_bits).collect())
        .collect()
}

fn goes_on_as_before<T: Float>(from: SimulationSettings, into: SimulationSettings) {
    let mut original = moved::<T>(from);
    assert_eq!(original.diverged().len(), 1);
    let bytes = original.snapshot().to_bytes();
    let at_snapshot = seen(&mut original);
    original.step(30);

    let mut other = Simulation::<T>::new(n_pendula(3).unwrap(), into).unwrap();
    other.step(7);
    other
        .restore(&Snapshot::from_bytes(&bytes).unwrap())
        .unwrap();
    assert_eq!(seen(&mut other), at_snapshot);
    other.step(30);
    assert_eq!(seen(&mut other), seen(&mut original));
}

#[test]
fn restored_worlds_go_on_to_the_bit() {
    goes_on_as_before::<f32>(settings(), settings());
    goes_on_as_before::<f64>(settings(), settings());
}

#[test]
fn lanes_restore_into_scalars_and_back() {
    let scalar = SimulationSettings {
        scalar: true,
        ..settings()
    };
    goes_on_as_before::<f32>(settings(), scalar);
    goes_on_as_before::<f32>(scalar, settings());
}

/// On a slope a box that sticks, and a ball that rolling friction holds; above them a beam in a wall, and a stone on a
/// rope.
fn at_rest() -> Model {
    let down = DQuat::from_rotation_z(0.05) * DVec3::NEG_Y;
    let mut world = Builder::new("at rest");
    world.gravity(9.81 * down);
    let rough = Material {
        rolling_friction: 0.02,
        ..Material::default()
    };
    let shape = |geometry| Shape::new(geometry).with_material(rough);
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    world.object("ground").scenery(shape(plane));
    let things = world.object("things");
    let half = DVec3::splat(0.1);
    let cube = things.body("box").at(Pose::at(DVec3::Y * 0.1));
    cube.shape(shape(Geometry::Box { half }));
    let ball = things.body("ball").at(Pose::at(DVec3::new(1.0, 0.1, 0.0)));
    ball.shape(shape(Geometry::Sphere { radius: 0.1 }));
    let [beam, stone] = ["beam", "stone"].map(|name| {
        let body = things.body(name);
        body.inertia(1.0, DVec3::ZERO, 0.01 * DMat3::IDENTITY)
            .handle()
    });
    let end = Pose::at(DVec3::NEG_X * 0.3);
    let wall = things.fixed("wall", beam);
    wall.frames(Pose::at(DVec3::Y * 2.0), end);
    let (hook, length) = (DVec3::new(2.0, 2.0, 0.0), 0.5);
    let [x, y, z] = (hook + length * down).to_array();
    let flight = things.free("flight", stone);
    flight.initial(&[x, y, z, 0.0, 0.0, 0.0, 1.0]);
    let rope = things.distance("rope", stone, length);
    rope.frames(Pose::at(hook), Pose::IDENTITY);
    world.build().unwrap()
}

/// Forces [N] on the box and the ball, the torque [N·m] on the ball, and what joints give.
fn forces(simulation: &mut Simulation<f64>) -> Vec<DVec3> {
    let joints = simulation.model().joints.len();
    let outputs = simulation.outputs();
    let mut all = vec![DVec3::ZERO; 3];
    for contact in outputs.contacts(0) {
        // The first shape is the ground.
        let body = contact.shapes[1].0 - 1;
        all[body] += contact.force;
        if body == 1 {
            all[2] += contact.torque;
        }
    }
    let reactions = (0..joints).map(|j| outputs.reaction(0, JointId(j)));
    all.extend(reactions.flat_map(|(force, torque)| [force, torque]));
    all
}

/// In steps of another length contacts and joints go on to give what they gave, whether what rests on them sleeps or not.
#[test]
fn a_snapshot_keeps_its_forces_in_shorter_steps() {
    let cases = [
        (SolverKind::Xpbd, 0.0),
        (SolverKind::Impulse, 0.0),
        (SolverKind::Impulse, 0.01),
    ];
    for (solver, sleep_speed) in cases {
        let with = |time_step| {
            let mut settings = SimulationSettings::new(1, time_step);
            settings.solver = solver;
            settings.step.sleep_speed = sleep_speed;
            Simulation::<f64>::new(at_rest(), settings).unwrap()
        };
        let (mut long, mut short) = (with(0.004), with(0.001));
        long.step(500);
        let expected = forces(&mut long);
        let weight = long.model().bodies[0].mass * -long.model().gravity;
        assert!(
            expected[0].distance(weight) < 1e-2 * weight.length(),
            "{solver:?}: {} for {weight}",
            expected[0]
        );
        short.restore(&long.snapshot()).unwrap();
        // What is softer in longer steps has sunk deeper, and settles.
        for (steps, tolerance) in [(0, 1e-9), (1, 0.1)] {
            short.step(steps);
            for (found, expected) in forces(&mut short).iter().zip(&expected) {
                assert!(
                    found.distance(*expected) < tolerance * (expected.length() + 0.1),
                    "{solver:?}, {sleep_speed} m/s, {steps} steps: {found} for {expected}"
                );
            }
        }
    }
}

/// What slept when a snapshot was taken wakes where nothing is to sleep.
#[test]
fn nothing_sleeps_on_where_nothing_may() {
    let with = |sleep_speed| {
        let mut settings = SimulationSettings::new(1, 0.002);
        settings.solver = SolverKind::Impulse;
        settings.step.sleep_speed = sleep_speed;
        Simulation::<f64>::new(at_rest(), settings).unwrap()
    };
    let sleeps = |sim: &mut Simulation<f64>| sim.outputs().asleep(0, BodyId(0));
    let [mut first, mut sleeper, mut awake] = [0.01, 0.01, 0.0].map(with);
    first.step(1000);
    assert!(sleeps(&mut first));
    for (sim, expected) in [(&mut sleeper, true), (&mut awake, false)] {
        sim.restore(&first.snapshot()).unwrap();
        sim.step(1);
        assert_eq!(sleeps(sim), expected);
    }
}

#[test]
fn what_does_not_fit_is_refused_and_changes_nothing() {
    let snapshot = moved::<f32>(settings()).snapshot();
    let refused = |simulation: &mut Simulation<f32>| {
        let before = seen(simulation);
        let error = simulation.restore(&snapshot).unwrap_err();
        assert_eq!(seen(simulation), before);
        let SimulationError::Snapshot(error) = error else {
            panic!("{error}")
        };
        error
    };
    let fewer = SimulationSettings {
        worlds: 20,
        ..settings()
    };
    let error = refused(&mut Simulation::new(n_pendula(3).unwrap(), fewer).unwrap());
    assert_eq!(
        error,
        SnapshotError::Worlds {
            found: 21,
            expected: 20
        }
    );
    let error = refused(&mut Simulation::new(n_pendula(4).unwrap(), settings()).unwrap());
    assert_eq!(error, SnapshotError::Model);

    let mut double = Simulation::<f64>::new(n_pendula(3).unwrap(), settings()).unwrap();
    let error = double.restore(&snapshot).unwrap_err().to_string();
    assert!(
        error.contains("of f32 numbers, but the simulation computes in f64"),
        "{error}"
    );
}

#[test]
fn colours_are_no_part_of_a_state_or_of_a_structure() {
    let mut plain = moved::<f32>(settings());
    let mut parts = n_pendula(3).unwrap().into_parts();
    parts.shapes[0].color = Some([1.0, 0.0, 0.0, 0.5]);
    let painted = Model::new(parts).unwrap();
    let mut simulation = Simulation::<f32>::new(painted.clone(), settings()).unwrap();
    simulation.restore(&plain.snapshot()).unwrap();
    simulation.set_world_model(3, &painted).unwrap();
    plain.step(10);
    simulation.step(10);
    assert_eq!(seen(&mut simulation), seen(&mut plain));
}

#[test]
fn every_cut_and_every_flipped_bit_is_noticed() {
    let small = SimulationSettings {
        worlds: 2,
        ..settings()
    };
    let bytes = moved::<f32>(small).snapshot().to_bytes();
    assert!(Snapshot::from_bytes(&bytes).is_ok());
    for n in 0..bytes.len() {
        let error = Snapshot::from_bytes(&bytes[..n]).unwrap_err();
        assert!(
            matches!(error, SnapshotError::Truncated { found, .. } if found == n),
            "{n}: {error}"
        );
    }
    for bit in 0..8 * bytes.len() {
        let mut flipped = bytes.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        assert!(Snapshot::from_bytes(&flipped).is_err(), "bit {bit}");
    }
    let longer = [&bytes[..], &[0]].concat();
    assert_eq!(
        Snapshot::from_bytes(&longer).unwrap_err(),
        SnapshotError::Damaged("bytes after its end")
    );
}

/// Also where the checksum is right, as of a file that was written with such numbers.
#[test]
fn a_state_that_is_not_finite_is_refused_and_changes_nothing() {
    let mut simulation = moved::<f32>(settings());
    let (before, bytes) = (seen(&mut simulation), simulation.snapshot().to_bytes());
    for number in [f32::NAN, f32::INFINITY] {
        let mut spoiled = bytes.clone();
        // The first number after the header.
        spoiled[56..60].copy_from_slice(&number.to_le_bytes());
        let (content, checksum) = spoiled.split_last_chunk_mut().unwrap();
        *checksum = crc32fast::hash(content).to_le_bytes();
        let snapshot = Snapshot::from_bytes(&spoiled).unwrap();
        let error = simulation.restore(&snapshot).unwrap_err();
        let SimulationError::Snapshot(error) = error else {
            panic!("{error}")
        };
        let why = SnapshotError::Damaged("a state that is not finite");
        assert_eq!(error, why);
        assert_eq!(seen(&mut simulation), before);
    }
}

#[test]
fn other_files_and_later_versions_are_named() {
    let mut bytes = moved::<f64>(SimulationSettings {
        worlds: 1,
        ..settings()
    })
    .snapshot()
    .to_bytes();
    assert_eq!(
        Snapshot::from_bytes(b"<mujoco/>").unwrap_err(),
        SnapshotError::Magic
    );
    bytes[8] = 2;
    let error = Snapshot::from_bytes(&bytes).unwrap_err();
    assert_eq!(error, SnapshotError::Version { found: 2 });
    assert!(
        error
            .to_string()
            .contains("version 2, but this release reads up to 1"),
        "{error}"
    );
    let absurd = [&b"KNTRMSNP\x01\0\0\0\x04\0\0\0"[..], &[255; 44]].concat();
    assert_eq!(
        Snapshot::from_bytes(&absurd).unwrap_err(),
        SnapshotError::Damaged("impossible sizes")
    );
}
