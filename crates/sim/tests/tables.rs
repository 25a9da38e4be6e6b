//! Tables of all worlds at once are what is told of each world; parameters of one world are its own.

use glam::DVec3;
use kinetarium_sim::{
    Control, Parameter, Quantity, Simulation, SimulationError, SimulationSettings, SolverKind,
};
use model::{BodyId, Builder, Geometry, JointId, Model, ModelError, Pose, Shape, examples};

const WORLDS: usize = 19;
const SOLVERS: [SolverKind; 3] = [
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];

/// Worlds that differ by the velocity of a joint, after some steps.
fn simulation(model: &Model, solver: SolverKind) -> Simulation<f32> {
    let settings = SimulationSettings {
        solver,
        ..SimulationSettings::new(WORLDS, 0.002)
    };
    let mut sim = Simulation::new(model.clone(), settings).unwrap();
    let dofs = model.degrees_of_freedom();
    for world in 0..WORLDS {
        let mut velocity = vec![0.0; dofs];
        velocity[0] = 0.1 * world as f64;
        sim.set_joint_state(world, &model.initial_position(), &velocity)
            .unwrap();
    }
    sim.step(5);
    sim
}

fn read(sim: &mut Simulation<f32>, quantity: Quantity) -> Vec<Vec<f32>> {
    let [rows, width] = quantity.shape(sim.model());
    let mut out = vec![f32::NAN; WORLDS * rows * width];
    sim.read(quantity, &mut out).unwrap();
    out.chunks(rows * width).map(<[f32]>::to_vec).collect()
}

#[test]
fn quantities_are_what_is_told_of_each_world() {
    let models = [examples::n_pendula(3), examples::ball_joint()].map(Result::unwrap);
    let cases = models
        .iter()
        .flat_map(|model| SOLVERS.map(|solver| (model, solver)));
    for (model, solver) in cases {
        let mut sim = simulation(model, solver);
        let single = |x: Vec<f64>| x.into_iter().map(|x| x as f32).collect::<Vec<_>>();
        // Joints first, then motion: they are reported by themselves.
        let positions = read(&mut sim, Quantity::JointPosition);
        let velocities = read(&mut sim, Quantity::JointVelocity);
        let bodies = read(&mut sim, Quantity::BodyPosition);
        let forces = read(&mut sim, Quantity::ReactionForce);
        let orientations = read(&mut sim, Quantity::BodyOrientation);
        let energies = read(&mut sim, Quantity::KineticEnergy);
        let accelerations = read(&mut sim, Quantity::JointAcceleration);
        let outputs = sim.outputs();
        for world in 0..WORLDS {
            assert_eq!(positions[world], single(outputs.joint_position(world)));
            assert_eq!(velocities[world], single(outputs.joint_velocity(world)));
            assert_eq!(
                accelerations[world],
                single(outputs.joint_acceleration(world))
            );
            assert_eq!(energies[world], [outputs.kinetic_energy(world) as f32]);
            for b in 0..model.bodies.len() {
                let (at, turn) = (&bodies[world][3 * b..], &orientations[world][4 * b..]);
                let pose = outputs.body_pose(world, BodyId(b));
                assert_eq!(at[..3], pose.position.as_vec3().to_array());
                assert_eq!(turn[..4], pose.orientation.as_quat().to_array());
            }
            for j in 0..model.joints.len() {
                let force = outputs.reaction(world, JointId(j)).0.as_vec3();
                assert_eq!(forces[world][3 * j..][..3], force.to_array());
            }
        }
        assert_ne!(bodies[0], bodies[1]);
    }
}

/// There is nothing of it but sums, which are zero.
#[test]
fn all_quantities_of_scenery_alone_are_read() {
    let mut world = Builder::new("room");
    let room = world.object("room");
    for x in [0.0, 0.5] {
        let ball = Shape::new(Geometry::Sphere { radius: 1.0 });
        room.scenery(ball.at(Pose::at(x * DVec3::X)));
    }
    let model = world.build().unwrap();
    for solver in SOLVERS {
        let settings = SimulationSettings {
            solver,
            ..SimulationSettings::new(WORLDS, 0.002)
        };
        let mut sim = Simulation::<f32>::new(model.clone(), settings).unwrap();
        sim.step(1);
        for quantity in Quantity::ALL {
            let [rows, width] = quantity.shape(&model);
            let mut out = vec![f32::NAN; WORLDS * rows * width];
            sim.read(quantity, &mut out).unwrap();
            assert!(out.iter().all(|x| *x == 0.0), "{solver:?}, {quantity:?}");
        }
    }
}

#[test]
fn controls_are_written_as_they_are_read() {
    let model = examples::n_pendula(3).unwrap();
    let mut sim = simulation(&model, SolverKind::Featherstone);
    let force: Vec<f32> = (0..3 * WORLDS).map(|i| i as f32).collect();
    let mut controls = sim.controls();
    assert_eq!(controls.count(Control::Force), 3);
    assert_eq!(controls.count(Control::Actuator), 0);
    controls.write(Control::Force, &force).unwrap();
    let mut found = vec![0.0; force.len()];
    controls.read(Control::Force, &mut found).unwrap();
    assert_eq!(found, force);
    assert_eq!(controls.of_world(7).unwrap()[..3], [21.0, 22.0, 23.0]);
    let mut wrong = force.clone();
    wrong[3 * 11 + 1] = f32::NAN;
    let error = controls.write(Control::Force, &wrong).unwrap_err();
    assert_eq!(
        error.to_string(),
        "world 11: force[1] is NaN: it must be a finite number"
    );
    wrong[3 * 11 + 1] = 1e10;
    assert!(controls.write(Control::TargetPosition, &wrong).is_err());
    assert!(controls.write(Control::Force, &force[1..]).is_err());
    controls.read(Control::Force, &mut found).unwrap();
    assert_eq!(found, force, "what is refused changes nothing");
}

#[test]
fn parameters_are_a_worlds_own() {
    let model = examples::n_pendula(3).unwrap();
    let mut sim = simulation(&model, SolverKind::Featherstone);
    let mut twin = simulation(&model, SolverKind::Featherstone);
    let masses = Parameter::BodyMass.of(&model);
    let heavy: Vec<f64> = masses.iter().map(|m| 2.0 * m).collect();
    let moon = [0.0, -1.62, 0.0];
    sim.set_parameters(
        4,
        &[(Parameter::BodyMass, &heavy), (Parameter::Gravity, &moon)],
    )
    .unwrap();
    assert_eq!(Parameter::BodyMass.of(sim.world_model(4)), heavy);
    assert_eq!(Parameter::Gravity.of(sim.world_model(4)), moon);
    assert_eq!(Parameter::BodyMass.of(sim.world_model(5)), masses);
    sim.step(50);
    twin.step(50);
    let (own, shared) = (
        read(&mut sim, Quantity::JointPosition),
        read(&mut twin, Quantity::JointPosition),
    );
    assert_ne!(own[4], shared[4]);
    assert_eq!(own[5], shared[5]);

    let refused = sim.set_parameters(4, &[(Parameter::BodyMass, &[-1.0; 3])]);
    let negative = SimulationError::Model(ModelError::NotPositive {
        what: "body \"link0\"".into(),
        quantity: "mass [kg]",
        value: -1.0,
    });
    assert_eq!(refused.unwrap_err().to_string(), negative.to_string());
    assert!(
        sim.set_parameters(4, &[(Parameter::Gravity, &[1.0])])
            .is_err()
    );
    assert!(sim.set_parameters(WORLDS, &[]).is_err());
    assert_eq!(Parameter::BodyMass.of(sim.world_model(4)), heavy);
}

/// Several worlds at once are as one after the other, and none is changed where one is refused.
#[test]
fn parameters_of_several_worlds_are_given_together() {
    let model = examples::n_pendula(3).unwrap();
    let mut sim = simulation(&model, SolverKind::Xpbd);
    let mut twin = simulation(&model, SolverKind::Xpbd);
    for s in [&mut sim, &mut twin] {
        s.step(7);
    }
    let masses = [1.5, 2.5, 3.5, 4.5, 5.5, 6.5];
    sim.set_parameter(Parameter::BodyMass, &[6, 2], &masses)
        .unwrap();
    for (world, own) in [(6, &masses[..3]), (2, &masses[3..])] {
        twin.set_parameters(world, &[(Parameter::BodyMass, own)])
            .unwrap();
    }
    for s in [&mut sim, &mut twin] {
        s.step(20);
    }
    let now = read(&mut sim, Quantity::JointPosition);
    assert_eq!(now, read(&mut twin, Quantity::JointPosition));

    let mut wrong = masses;
    wrong[4] = -1.0;
    let refused = sim.set_parameter(Parameter::BodyMass, &[3, 5], &wrong);
    let why = refused.unwrap_err().to_string();
    assert!(why.starts_with("world 5: "), "{why}");
    for world in [3, 5] {
        let untouched = Parameter::BodyMass.of(sim.world_model(world));
        assert_eq!(untouched, Parameter::BodyMass.of(&model));
    }
    assert!(
        sim.set_parameter(Parameter::BodyMass, &[WORLDS], &masses[..3])
            .is_err()
    );
    assert!(
        sim.set_parameter(Parameter::BodyMass, &[1], &masses)
            .is_err()
    );
    let refused = sim.set_parameter(Parameter::Damping, &[4], &[0.1; 3]);
    let why = refused.unwrap_err().to_string();
    assert!(why.starts_with("world 4: with this damping "), "{why}");
}

/// A drive must have stiffness or damping: one that is to have the other instead gets both at once.
#[test]
fn parameters_that_depend_on_each_other_are_given_together() {
    let mut parts = examples::n_pendula(2).unwrap().into_parts();
    for dof in parts.joints.iter_mut().flat_map(|joint| &mut joint.dofs) {
        dof.drive.stiffness = 10.0;
    }
    let model = Model::new(parts).unwrap();
    let mut sim = simulation(&model, SolverKind::Featherstone);
    let (stiffness, damping) = ([0.0; 4], [1.0, 2.0, 3.0, 4.0]);
    let stiffness = (Parameter::DriveStiffness, &stiffness[..]);
    let damping = (Parameter::DriveDamping, &damping[..]);
    let alone = sim.set_parameters_of(&[1, 3], &[stiffness]);
    assert!(alone.unwrap_err().to_string().starts_with("world 1: "));
    sim.set_parameters_of(&[1, 3], &[stiffness, damping])
        .unwrap();
    assert_eq!(Parameter::DriveDamping.of(sim.world_model(3)), [3.0, 4.0]);
    assert_eq!(Parameter::DriveStiffness.of(sim.world_model(1)), [0.0, 0.0]);
}

#[test]
fn joints_are_moved_within_time_and_controls() {
    let model = examples::n_pendula(3).unwrap();
    for solver in SOLVERS {
        let mut sim = simulation(&model, solver);
        sim.controls().set_dof_force(3, 1, 2.0).unwrap();
        let time = sim.time(3);
        sim.move_joints(3, &[0.1, 0.2, 0.3], &[1.0, 0.0, -1.0])
            .unwrap();
        assert_eq!(sim.time(3), time);
        assert_eq!(sim.controls().of_world(3).unwrap()[1], 2.0);
        for (found, set) in sim.outputs().joint_position(3).iter().zip([0.1, 0.2, 0.3]) {
            assert!((found - set).abs() < 1e-6);
        }
        assert!(sim.move_joints(3, &[f64::NAN; 3], &[0.0; 3]).is_err());
        assert!(sim.move_joints(WORLDS, &[0.0; 3], &[0.0; 3]).is_err());
    }
}

#[test]
fn time_does_not_depend_on_how_steps_are_taken() {
    let model = examples::n_pendula(1).unwrap();
    let [mut at_once, mut one_by_one] = [0, 1].map(|_| simulation(&model, SOLVERS[0]));
    at_once.step(500);
    (0..500).for_each(|_| {
        one_by_one.step(1);
    });
    assert_eq!(at_once.time(0), one_by_one.time(0));
}
