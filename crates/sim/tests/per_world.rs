//! Worlds with numbers of their own: each moves as if it were alone with its model.

mod scene;

use glam::{DQuat, DVec3};
use kinetarium_sim::{Simulation, SimulationError, SimulationSettings, SolverKind};
use model::examples::n_pendula;
use model::{BodyId, Builder, Drive, Geometry, JointId, Model, Parts, Pose, Shape};
use numbers::Float;
use scene::{
    BOTH, Method, TIME_STEP, TOUCHING, chain, hash, hashes, heap, mixed, motion, scatter, scattered,
};
use std::f64::consts::FRAC_PI_4;

const WORLDS: usize = 19;
const OTHER: usize = 5;
const STEPS: usize = 30;

fn changed(model: Model, change: impl FnOnce(&mut Parts)) -> Model {
    let mut parts = model.into_parts();
    change(&mut parts);
    Model::new(parts).unwrap()
}

/// The mixed tree with one number changed, for every kind of number.
fn variants() -> Vec<(&'static str, Model)> {
    let with = |change: fn(&mut Parts)| changed(mixed(), change);
    vec![
        ("mass", with(|p| p.bodies[1].mass *= 1.5)),
        ("inertia", with(|p| p.bodies[1].inertia *= 2.0)),
        ("centre of mass", with(|p| p.bodies[1].center.x += 0.05)),
        ("gravity", with(|p| p.gravity = DVec3::new(1.0, -3.0, 0.5))),
        (
            "joint frame",
            with(|p| p.joints[1].parent_frame.position.x += 0.1),
        ),
        (
            "friction loss",
            with(|p| p.joints[1].dofs[0].friction_loss = 1.0),
        ),
        ("armature", with(|p| p.joints[1].dofs[0].armature = 0.2)),
        (
            "drive stiffness",
            with(|p| p.joints[1].dofs[0].drive.stiffness = 90.0),
        ),
        (
            "drive damping",
            with(|p| p.joints[1].dofs[0].drive.damping = 9.0),
        ),
        (
            "effort limit",
            with(|p| p.joints[1].dofs[0].drive.effort_limit = 1.0),
        ),
        (
            "control time",
            with(|p| p.joints[1].dofs[0].drive.control_time = 0.5),
        ),
        (
            "ball drive",
            with(|p| {
                p.joints[2]
                    .dofs
                    .iter_mut()
                    .for_each(|d| d.drive.stiffness = 9.0)
            }),
        ),
        (
            "limit",
            with(|p| p.joints[1].dofs[0].limit.as_mut().unwrap().upper = -0.2),
        ),
        ("spring", with(|p| p.joints[3].dofs[0].stiffness = 900.0)),
        ("damping", with(|p| p.joints[4].dofs[1].damping = 2.0)),
        ("gear", with(|p| p.actuators[0].gear = 9.0)),
        (
            "force range",
            with(|p| p.actuators[1].force_range = Some((-1.0, 1.0))),
        ),
    ]
}

/// A world that is given the variant at its start moves as a simulation of the variant alone, and
/// its neighbours as without it.
fn stands_alone<T: Float>(base: &Model, name: &str, variant: &Model, settings: SimulationSettings) {
    let case = format!("{name}, {settings:?}");
    let mut plain = scattered::<T>(base, settings, |w| w);
    plain.step(STEPS);

    let mut simulation = Simulation::<T>::new(base.clone(), settings).unwrap();
    simulation.set_world_model(OTHER, variant).unwrap();
    for world in 0..WORLDS {
        scatter(&mut simulation, world, world);
    }
    simulation.step(STEPS);
    for world in (0..WORLDS).filter(|&w| w != OTHER) {
        assert_eq!(
            hash(&mut simulation, world),
            hash(&mut plain, world),
            "{case}: {world}"
        );
    }
    let alone = SimulationSettings {
        worlds: 1,
        ..settings
    };
    let mut alone = scattered::<T>(variant, alone, |_| OTHER);
    alone.step(STEPS);
    assert_eq!(
        hash(&mut simulation, OTHER),
        hash(&mut alone, 0),
        "{case}: unlike alone"
    );
    assert_ne!(
        hash(&mut simulation, OTHER),
        hash(&mut plain, OTHER),
        "{case}: no effect"
    );
}

#[test]
fn a_world_of_its_own_moves_as_if_alone() {
    for (name, variant) in variants() {
        for method in BOTH {
            let lanes = method.settings(WORLDS);
            stands_alone::<f32>(&mixed(), name, &variant, lanes);
            stands_alone::<f64>(&mixed(), name, &variant, lanes);
            let scalar = SimulationSettings {
                scalar: true,
                threads: 2,
                ..lanes
            };
            stands_alone::<f32>(&mixed(), name, &variant, scalar);
        }
    }
}

/// What only position-based dynamics takes.
#[test]
fn joints_are_switched_off_and_made_soft_world_by_world() {
    let off = changed(chain(), |p| p.joints[2].enabled = false);
    let soft = changed(chain(), |p| p.joints[2].linear_compliance = 1e-3);
    for (name, variant) in [("enabled", off), ("compliance", soft)] {
        stands_alone::<f32>(&chain(), name, &variant, Method::Xpbd.settings(WORLDS));
        stands_alone::<f64>(&chain(), name, &variant, Method::Xpbd.settings(WORLDS));
    }
}

#[test]
fn every_world_can_have_its_own_model() {
    for method in BOTH {
        let own = |w: usize| {
            changed(mixed(), |p| {
                p.bodies[1].mass = 0.5 + 0.1 * w as f64;
                p.gravity.y = -(w as f64);
            })
        };
        let mut simulation = Simulation::<f32>::new(mixed(), method.settings(WORLDS)).unwrap();
        for world in 0..WORLDS {
            simulation.set_world_model(world, &own(world)).unwrap();
            scatter(&mut simulation, world, world);
        }
        simulation.step(STEPS);
        for world in 0..WORLDS {
            let mut alone = scattered::<f32>(&own(world), method.settings(1), |_| world);
            alone.step(STEPS);
            assert_eq!(
                hash(&mut simulation, world),
                hash(&mut alone, 0),
                "{method:?} {world}"
            );
        }
    }
}

/// A model that is set while worlds move leaves state, time and controls.
#[test]
fn a_moving_world_goes_on_with_its_new_model() {
    let heavy = changed(mixed(), |p| p.bodies[1].mass *= 3.0);
    for method in BOTH {
        let mut simulation = scattered::<f64>(&mixed(), method.settings(WORLDS), |w| w);
        simulation.step(STEPS);
        let (before, time) = (motion(&mut simulation, OTHER), simulation.time(OTHER));
        let controls = simulation.controls().of_world(OTHER).unwrap();
        let others = hashes(&mut simulation);

        simulation.set_world_model(OTHER, &heavy).unwrap();
        let after = motion(&mut simulation, OTHER);
        // Position-based dynamics keeps bodies in frames that depend on their masses.
        let slack = if method == Method::Xpbd { 1e-12 } else { 0.0 };
        for (a, b) in after.iter().zip(&before) {
            assert!(
                (a - b).abs() <= slack * (1.0 + b.abs()),
                "{method:?}: {a} was {b}"
            );
        }
        assert_eq!(simulation.time(OTHER), time);
        assert_eq!(simulation.controls().of_world(OTHER).unwrap(), controls);
        for (world, others) in others.into_iter().enumerate().filter(|&(w, _)| w != OTHER) {
            assert_eq!(hash(&mut simulation, world), others, "{method:?}");
        }
        // Back to the first model, featherstone moves as if nothing had been.
        simulation.set_world_model(OTHER, &mixed()).unwrap();
        simulation.step(STEPS);
        let mut plain = scattered::<f64>(&mixed(), method.settings(WORLDS), |w| w);
        plain.step(2 * STEPS);
        if method != Method::Xpbd {
            assert_eq!(hash(&mut simulation, OTHER), hash(&mut plain, OTHER));
        }
    }
}

/// A reset brings a world to the initial state and the targets of its own model.
#[test]
fn a_reset_world_begins_as_its_own_model_says() {
    let own = changed(mixed(), |p| {
        p.joints[1].initial = vec![-0.2];
        p.joints[1].dofs[0].drive.target_position = -0.1;
        p.joints[1].dofs[0].drive.target_velocity = 0.3;
    });
    for method in BOTH {
        let mut simulation = scattered::<f32>(&mixed(), method.settings(WORLDS), |w| w);
        simulation.set_world_model(OTHER, &own).unwrap();
        simulation.step(STEPS);
        simulation.reset_all();
        let mut alone = Simulation::<f32>::new(own.clone(), method.settings(1)).unwrap();
        let mut plain = Simulation::<f32>::new(mixed(), method.settings(1)).unwrap();
        simulation.step(STEPS);
        alone.step(STEPS);
        plain.step(STEPS);
        assert_eq!(
            hash(&mut simulation, OTHER),
            hash(&mut alone, 0),
            "{method:?}"
        );
        assert_eq!(hash(&mut simulation, 4), hash(&mut plain, 0), "{method:?}");
        assert!((simulation.time(OTHER) - STEPS as f64 * TIME_STEP).abs() < 1e-12);
    }
}

/// A cart on a rail, with what the change puts on its slide.
fn cart(change: impl FnOnce(&mut model::Dof)) -> Model {
    let mut world = Builder::new("cart");
    let object = world.object("cart");
    let body = object
        .body("cart")
        .shape(Geometry::Sphere { radius: 0.1 })
        .mass(1.0)
        .handle();
    let slide = object.prismatic("slide", body, DVec3::X);
    change(&mut slide.dofs_mut()[0]);
    world.build().unwrap()
}

#[test]
fn a_model_of_another_structure_is_refused_and_changes_nothing() {
    let drive = Drive {
        stiffness: 5.0,
        ..Drive::default()
    };
    let spring = cart(|dof| dof.stiffness = 50.0);
    let cases = [
        (chain(), n_pendula(4).unwrap(), "fewer links"),
        (chain(), mixed(), "another robot"),
        (
            spring.clone(),
            cart(|dof| dof.drive = drive),
            "a drive for a spring",
        ),
        (spring.clone(), cart(|_| ()), "no spring"),
        (
            spring,
            cart(|dof| (dof.stiffness, dof.friction_loss) = (50.0, 1.0)),
            "friction too",
        ),
    ];
    for method in BOTH {
        for (base, other, case) in &cases {
            let mut simulation = scattered::<f32>(base, method.settings(WORLDS), |w| w);
            simulation.step(3);
            let before = hashes(&mut simulation);
            let error = simulation.set_world_model(OTHER, other).unwrap_err();
            assert!(
                matches!(error, SimulationError::Structure { world: OTHER }),
                "{method:?}, {case}: {error}"
            );
            assert_eq!(hashes(&mut simulation), before, "{method:?}, {case}");
            let mut plain = scattered::<f32>(base, method.settings(WORLDS), |w| w);
            plain.step(6);
            simulation.step(3);
            assert_eq!(
                hashes(&mut simulation),
                hashes(&mut plain),
                "{method:?}, {case}"
            );
        }
    }
}

/// A wheel that is off its axle in one world, and a foot that comes to lie on it, differ in numbers only.
#[test]
fn wheels_may_be_off_their_axles_in_some_worlds() {
    let rolling = |off: f64| {
        let mut world = Builder::new("cart");
        let flat = Geometry::Plane {
            half_x: 0.0,
            half_z: 0.0,
        };
        world.object("ground").scenery(flat);
        let object = world.object("cart");
        let wheel = Shape::new(Geometry::Sphere { radius: 0.1 }).at(Pose::at(DVec3::X * off));
        let wheel = object.body("wheel").shape(wheel).mass(1.0).handle();
        let axle = object.revolute("axle", wheel, DVec3::Z);
        axle.at(Pose::at(DVec3::Y * 0.09));
        world.build().unwrap()
    };
    for (base, other) in [(0.0, 0.03), (0.03, 0.0)] {
        let settings = SimulationSettings {
            solver: SolverKind::Featherstone,
            ..SimulationSettings::new(WORLDS, TIME_STEP)
        };
        let mut simulation = Simulation::<f64>::new(rolling(base), settings).unwrap();
        simulation.set_world_model(OTHER, &rolling(other)).unwrap();
        let settings = SimulationSettings {
            worlds: 1,
            ..settings
        };
        let mut alone = Simulation::<f64>::new(rolling(other), settings).unwrap();
        simulation.set_joint_state(OTHER, &[-0.1], &[-0.5]).unwrap();
        alone.set_joint_state(0, &[-0.1], &[-0.5]).unwrap();
        for simulation in [&mut simulation, &mut alone] {
            simulation.step(STEPS);
        }
        let [together, alone] = [(&mut simulation, OTHER), (&mut alone, 0)].map(|(s, world)| {
            let outputs = s.outputs();
            let forces = outputs.contacts(world).map(|contact| contact.force);
            (outputs.joint_position(world), forces.sum::<DVec3>())
        });
        assert_eq!(together, alone, "{base} {other}");
        assert!(alone.1.length() > 0.1, "{alone:?}");
    }
}

/// Which bodies touch is the same in all worlds.
#[test]
fn a_model_in_which_other_bodies_touch_is_refused() {
    let touching = changed(heap(), |p| {
        p.joints.iter_mut().for_each(|j| j.bodies_collide = true);
    });
    for method in TOUCHING {
        let mut simulation = Simulation::<f32>::new(heap(), method.settings(WORLDS)).unwrap();
        let error = simulation.set_world_model(OTHER, &touching).unwrap_err();
        assert!(
            matches!(error, SimulationError::Structure { world: OTHER }),
            "{method:?}: {error}"
        );
    }
}

/// By impulses, the torque of a joint is told about the child's frame that the world's own model gives it.
#[test]
fn reactions_are_told_about_frames_of_the_own_model() {
    let own = changed(mixed(), |p| {
        p.joints[1].child_frame.position += DVec3::new(0.1, 0.0, 0.05);
    });
    let method = Method::Impulses;
    let mut simulation = Simulation::<f64>::new(mixed(), method.settings(WORLDS)).unwrap();
    simulation.set_world_model(OTHER, &own).unwrap();
    scatter(&mut simulation, OTHER, OTHER);
    let mut alone = scattered::<f64>(&own, method.settings(1), |_| OTHER);
    for simulation in [&mut simulation, &mut alone] {
        simulation.step(STEPS);
    }
    let told = simulation.outputs().reaction(OTHER, JointId(1));
    assert_eq!(told, alone.outputs().reaction(0, JointId(1)));
    assert!(told.0.length() > 0.1, "{told:?}");
}

/// Two cubes that float beside each other, 2 cm apart, until one of them grows into the other: what was known of
/// the gap, while the boxes about them overlap, is forgotten.
#[test]
fn shapes_that_grow_touch() {
    const APART: f64 = 0.155;
    let cubes = |half: f64| {
        let mut world = Builder::new("cubes");
        world.gravity(DVec3::ZERO);
        let cubes = world.object("cubes");
        let turn = DQuat::from_rotation_z(FRAC_PI_4);
        for (name, at, half) in [("first", 0.0, half), ("second", APART, 0.1)] {
            let half = DVec3::splat(half);
            let pose = Pose::new(DVec3::new(at, at, 0.0), turn);
            cubes.body(name).at(pose).shape(Geometry::Box { half });
        }
        world.build().unwrap()
    };
    let mut simulation =
        Simulation::<f32>::new(cubes(0.1), Method::Impulse.settings(WORLDS)).unwrap();
    simulation.step(5);
    simulation.set_world_model(OTHER, &cubes(0.13)).unwrap();
    simulation.step(5);
    let second = BodyId(1);
    for world in 0..WORLDS {
        let moved = simulation.outputs().body_position(world, second).x - APART;
        assert_eq!(moved > 1e-4, world == OTHER, "world {world}: {moved} m");
    }
}
