//! Every misuse of a simulation is refused with a message that says what, where and the remedy,
//! and leaves the simulation as it was.

mod scene;

use glam::DVec3;
use kinetarium_sim::{
    Controls, OutputPart, Outputs, Simulation, SimulationError, SimulationSettings, SolverKind,
};
use model::examples::n_pendula;
use model::{
    Axis, BodyId, Builder, Geometry, JointHandle, JointId, Limit, Model, ModelError, Object, Parts,
};
use rigid::Integrator;
use scene::{Method, chain, hashes, mixed, scattered};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::Command;

type Spoil<T> = fn(&mut T);

/// Asserts the message of an error.
#[track_caller]
fn says<E: std::fmt::Display>(result: Result<impl Sized, E>, message: &str) {
    match result {
        Ok(_) => panic!("not refused: {message}"),
        Err(error) => assert_eq!(error.to_string(), message),
    }
}

#[test]
fn settings_out_of_range() {
    let cases: &[(Spoil<SimulationSettings>, &str)] = &[
        (
            |s| s.worlds = 0,
            "worlds is 0: it must be from 1 to 16777216",
        ),
        (
            |s| s.worlds = 1 << 30,
            "worlds is 1073741824: it must be from 1 to 16777216",
        ),
        (
            |s| s.threads = 5000,
            "threads is 5000: it must be at most 1024, or 0 for all processors",
        ),
        (
            |s| s.step.time_step = 0.0,
            "time step is 0: it must be from 1e-9 to 1e3, in seconds",
        ),
        (
            |s| s.step.time_step = -0.1,
            "time step is -0.1: it must be from 1e-9 to 1e3, in seconds",
        ),
        (
            |s| s.step.time_step = f64::NAN,
            "time step is NaN: it must be from 1e-9 to 1e3, in seconds",
        ),
        (
            |s| s.step.time_step = 2e3,
            "time step is 2000: it must be from 1e-9 to 1e3, in seconds",
        ),
        (
            |s| s.step.substeps = 0,
            "substeps is 0: it must be from 1 to 10000",
        ),
        (
            |s| s.step.substeps = 20_000,
            "substeps is 20000: it must be from 1 to 10000",
        ),
        (
            |s| s.step.iterations = 0,
            "iterations is 0: it must be from 1 to 10000",
        ),
        (
            |s| s.step.iterations = usize::MAX,
            "iterations is 18446744073709552000: it must be from 1 to 10000",
        ),
        (
            |s| s.step.speed_limit = 0.0,
            "speed limit is 0: it must be above zero and at most 1e9",
        ),
        (
            |s| s.step.speed_limit = f64::INFINITY,
            "speed limit is inf: it must be above zero and at most 1e9",
        ),
        (
            |s| s.step.speed_limit = f64::NAN,
            "speed limit is NaN: it must be above zero and at most 1e9",
        ),
        (
            |s| s.step.relaxation = 0.0,
            "relaxation is 0: it must be above 0 and below 2",
        ),
        (
            |s| s.step.relaxation = 2.0,
            "relaxation is 2: it must be above 0 and below 2",
        ),
        (
            |s| s.step.angular_damping = -1.0,
            "angular damping is -1: it must be from 0 to 1e9, in 1/s",
        ),
        (
            |s| s.step.angular_damping = f64::NAN,
            "angular damping is NaN: it must be from 0 to 1e9, in 1/s",
        ),
        (
            |s| s.step.displacement_cap = 0.0,
            "displacement cap is 0: it must be above zero, in metres",
        ),
        (
            |s| s.step.displacement_cap = f64::NAN,
            "displacement cap is NaN: it must be above zero, in metres",
        ),
        (
            |s| s.step.force_cap = -5.0,
            "force cap is -5: it must be above zero, in newtons",
        ),
        (
            |s| s.step.force_cap = f64::NAN,
            "force cap is NaN: it must be above zero, in newtons",
        ),
    ];
    for (spoil, message) in cases {
        let mut settings = SimulationSettings::new(2, 0.002);
        spoil(&mut settings);
        says(Simulation::<f32>::new(chain(), settings), message);
    }
    let bounds = SimulationSettings::new(1, 1e-9);
    assert!(Simulation::<f32>::new(chain(), bounds).is_ok());
}

#[test]
fn more_worlds_than_any_memory_holds() {
    let settings = SimulationSettings::new(1 << 24, 0.002);
    let error = Simulation::<f64>::new(n_pendula(1000).unwrap(), settings).unwrap_err();
    assert!(
        matches!(
            error,
            SimulationError::Memory {
                worlds: 16_777_216,
                ..
            }
        ),
        "{error}"
    );
    let message = error.to_string();
    assert!(
        message.starts_with("16777216 worlds of this model need "),
        "{message}"
    );
    assert!(
        message.ends_with(" GiB of memory, which are not to be had: ask for fewer"),
        "{message}"
    );
}

#[test]
fn solver_names() {
    says(
        "newton".parse::<SolverKind>(),
        "there is no solver \"newton\"; there are auto, featherstone, xpbd, impulse",
    );
    says(
        "".parse::<SolverKind>(),
        "there is no solver \"\"; there are auto, featherstone, xpbd, impulse",
    );
    says(
        "fetherstone".parse::<SolverKind>(),
        "there is no solver \"fetherstone\"; did you mean \"featherstone\"?",
    );
    assert_eq!("xpbd".parse(), Ok(SolverKind::Xpbd));
}

/// Worlds and a call on them that fails.
type Call = fn(&mut Simulation<f32>) -> Result<(), SimulationError>;

fn of_controls(
    simulation: &mut Simulation<f32>,
    call: impl FnOnce(&mut Controls<'_, f32>) -> Result<(), SimulationError>,
) -> Result<(), SimulationError> {
    call(&mut simulation.controls())
}

/// All calls of these leave three chains of five links as they were.
fn refuses(cases: &[(Call, &str)], model: &Model) {
    let settings = Method::Xpbd.settings(3);
    let mut simulation = scattered::<f32>(model, settings, |w| w);
    let mut plain = scattered::<f32>(model, settings, |w| w);
    for (call, message) in cases {
        says(call(&mut simulation), message);
    }
    for _ in 0..2 {
        assert_eq!(hashes(&mut simulation), hashes(&mut plain));
        simulation.step(5);
        plain.step(5);
    }
}

#[test]
fn states_that_are_none() {
    let cases: &[(Call, &str)] = &[
        (
            |s| s.reset(&[3]),
            "world 3 does not exist: there are 3, counted from 0",
        ),
        (
            |s| s.reset(&[0, usize::MAX]),
            "world 18446744073709551615 does not exist: there are 3, counted from 0",
        ),
        (
            |s| s.set_joint_state(7, &[0.0; 5], &[0.0; 5]),
            "world 7 does not exist: there are 3, counted from 0",
        ),
        (
            |s| s.set_joint_state(0, &[0.0; 4], &[0.0; 5]),
            "joint position has 4 numbers, but the model needs 5",
        ),
        (
            |s| s.set_joint_state(0, &[0.0; 5], &[]),
            "joint velocity has 0 numbers, but the model needs 5",
        ),
        (
            |s| s.set_joint_state(0, &[0.0, 0.0, f64::NAN, 0.0, 0.0], &[0.0; 5]),
            "joint position[2] is NaN: it must be a finite number",
        ),
        (
            |s| s.set_joint_state(0, &[0.0; 5], &[f64::INFINITY; 5]),
            "joint velocity[0] is inf: it must be a finite number",
        ),
        (
            |s| s.set_joint_state(0, &[0.0, 2e9, 0.0, 0.0, 0.0], &[0.0; 5]),
            "joint position[1] is 2e9: it must be from -1e9 to 1e9",
        ),
        (
            |s| s.set_joint_state(0, &[0.0; 5], &[-1e300; 5]),
            "joint velocity[0] is -1e300: it must be from -1e9 to 1e9",
        ),
        (
            |s| s.set_world_model(3, &chain()),
            "world 3 does not exist: there are 3, counted from 0",
        ),
        (
            |s| s.set_world_model(1, &mixed()),
            "the model of world 1 has another structure than the simulation's: only numbers may differ between worlds, \
             and what is zero since it is not there (drives, dry friction, springs, dampers) must stay zero",
        ),
    ];
    refuses(cases, &chain());
}

#[test]
fn quaternions_that_are_no_rotation() {
    let cases: &[(Call, &str)] = &[
        (
            |s| {
                let mut position = s.model().initial_position();
                position[3..7].fill(0.0);
                s.set_joint_state(1, &position, &[0.0; 15])
            },
            "joint position: the quaternion of joint `float` is zero: give one of unit length, x, y, z, w",
        ),
        (
            |s| {
                let mut position = s.model().initial_position();
                position[8..12].fill(0.0);
                s.set_joint_state(1, &position, &[0.0; 15])
            },
            "joint position: the quaternion of joint `wrist` is zero: give one of unit length, x, y, z, w",
        ),
    ];
    refuses(cases, &mixed());

    // Others are scaled, in both solvers alike.
    for method in scene::BOTH {
        let mut simulation = Simulation::<f64>::new(mixed(), method.settings(1)).unwrap();
        let mut position = mixed().initial_position();
        position[3..7].copy_from_slice(&[0.0, 0.0, 6.0, 8.0]);
        simulation
            .set_joint_state(0, &position, &[0.0; 15])
            .unwrap();
        let found = simulation.outputs().joint_position(0);
        for (found, expected) in found[3..7].iter().zip([0.0, 0.0, 0.6, 0.8]) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}

#[test]
fn controls_that_are_none() {
    let cases: &[(Call, &str)] = &[
        (
            |s| of_controls(s, |c| c.set_force(3, &[0.0; 15])),
            "world 3 does not exist: there are 3, counted from 0",
        ),
        (
            |s| of_controls(s, |c| c.set_force(0, &[0.0; 14])),
            "force has 14 numbers, but the model needs 15",
        ),
        (
            |s| of_controls(s, |c| c.set_force(0, &[f64::NAN; 15])),
            "force[0] is NaN: it must be a finite number",
        ),
        (
            |s| of_controls(s, |c| c.set_force(0, &[1e31; 15])),
            "force[0] is 1e31: it must be from -1e30 to 1e30",
        ),
        (
            |s| of_controls(s, |c| c.set_dof_force(0, 15, 0.0)),
            "degree of freedom 15 does not exist: there are 15, counted from 0",
        ),
        (
            |s| of_controls(s, |c| c.set_dof_force(9, 0, 0.0)),
            "world 9 does not exist: there are 3, counted from 0",
        ),
        (
            |s| of_controls(s, |c| c.set_dof_force(0, 0, f64::NEG_INFINITY)),
            "force[0] is -inf: it must be a finite number",
        ),
        (
            |s| of_controls(s, |c| c.set_target(0, 99, 0.0)),
            "degree of freedom 99 does not exist: there are 15, counted from 0",
        ),
        (
            |s| of_controls(s, |c| c.set_target(3, 0, 0.0)),
            "world 3 does not exist: there are 3, counted from 0",
        ),
        (
            |s| of_controls(s, |c| c.set_target(0, 0, f64::NAN)),
            "target position[0] is NaN: it must be a finite number",
        ),
        (
            |s| of_controls(s, |c| c.set_target(0, 0, 1e10)),
            "target position[0] is 1e10: it must be from -1e9 to 1e9",
        ),
        (
            |s| of_controls(s, |c| c.set_target_degrees(0, 0, f64::INFINITY)),
            "target position[0] is inf: it must be a finite number",
        ),
        (
            |s| of_controls(s, |c| c.set_target_degrees(0, 15, 90.0)),
            "degree of freedom 15 does not exist: there are 15, counted from 0",
        ),
        (
            |s| of_controls(s, |c| c.set_target_velocity(0, 15, 0.0)),
            "degree of freedom 15 does not exist: there are 15, counted from 0",
        ),
        (
            |s| of_controls(s, |c| c.set_target_velocity(0, 0, f64::NAN)),
            "target velocity[0] is NaN: it must be a finite number",
        ),
        (
            |s| of_controls(s, |c| c.set_target_velocity(0, 0, -2e9)),
            "target velocity[0] is -2e9: it must be from -1e9 to 1e9",
        ),
        (
            |s| of_controls(s, |c| c.set_control(0, &[])),
            "control has 0 numbers, but the model needs 3",
        ),
        (
            |s| of_controls(s, |c| c.set_control(5, &[0.0; 3])),
            "world 5 does not exist: there are 3, counted from 0",
        ),
        (
            |s| of_controls(s, |c| c.set_control(0, &[0.0, f64::NAN, 0.0])),
            "control[1] is NaN: it must be a finite number",
        ),
        (
            |s| of_controls(s, |c| c.of_world(3).map(|_| ())),
            "world 3 does not exist: there are 3, counted from 0",
        ),
        (
            |s| of_controls(s, |c| c.set_world(3, &[0.0; 48])),
            "world 3 does not exist: there are 3, counted from 0",
        ),
        (
            |s| of_controls(s, |c| c.set_world(0, &[0.0; 47])),
            "controls of a world has 47 numbers, but the model needs 48",
        ),
        (
            |s| of_controls(s, |c| c.set_world(0, &[f64::NAN; 48])),
            "controls of a world[0] is NaN: it must be a finite number",
        ),
        (
            |s| of_controls(s, |c| c.set_world(0, &[1e20; 48])),
            "targets of a world[0] is 1e20: it must be from -1e9 to 1e9",
        ),
    ];
    refuses(cases, &mixed());
}

type Read = fn(&Simulation<f32>, &Outputs<'_, f32>) -> f64;

/// Reading panics, as of an array, and gives no number of another table or world.
#[test]
fn reads_of_what_does_not_exist() {
    let cases: &[(&str, Read)] = &[
        ("world 20", |_, o| o.coordinate(20, 0)),
        ("world 20", |s, _| s.inputs().force(20, 0)),
        ("world 20", |_, o| f64::from(o.asleep(20, BodyId(0)))),
        ("coordinate 3", |_, o| o.coordinate(0, 3)),
        ("degree of freedom 3", |_, o| o.dof_velocity(0, 3)),
        ("degree of freedom 3", |s, _| s.inputs().force(0, 3)),
        ("degree of freedom 3", |s, _| s.inputs().target(0, 3)),
        ("degree of freedom 3", |s, _| {
            s.inputs().target_velocity(0, 3)
        }),
        ("actuator 0", |s, _| s.inputs().control(0, 0)),
        ("body 3", |_, o| o.body_position(0, BodyId(3)).x),
        ("body 3", |_, o| o.body_orientation(0, BodyId(3)).x),
        ("body 3", |_, o| o.body_velocity(0, BodyId(3)).x),
        ("body 3", |_, o| o.body_angular_velocity(0, BodyId(3)).x),
        ("body 3", |_, o| o.body_acceleration(0, BodyId(3)).x),
        ("body 3", |_, o| o.body_angular_acceleration(0, BodyId(3)).x),
        ("body 3", |_, o| f64::from(o.asleep(0, BodyId(3)))),
        ("joint 3", |_, o| o.reaction(0, JointId(3)).0.x),
        ("row of contacts", |_, o| {
            let rows = o.contact_rows(|_| true).len();
            o.contact(0, rows).map_or(0.0, |c| c.distance)
        }),
    ];
    for method in scene::TOUCHING {
        let model = n_pendula(3).unwrap();
        let mut simulation = Simulation::<f32>::new(model, method.settings(20)).unwrap();
        let observed = simulation.observe(|simulation, outputs| {
            for (what, read) in cases {
                let read = AssertUnwindSafe(|| read(simulation, outputs));
                let told = catch_unwind(read).expect_err(what);
                let told = told.downcast_ref::<String>().unwrap();
                let says = " does not exist: there are ";
                assert!(told.starts_with(what) && told.contains(says), "{told}");
            }
        });
        observed.unwrap();
    }
}

#[test]
fn parts_of_outputs_that_do_not_exist() {
    let model = n_pendula(3).unwrap();
    let mut simulation = Simulation::<f32>::new(model, SimulationSettings::new(1, 0.004)).unwrap();
    for (what, part) in [
        ("body 3", OutputPart::Motion(BodyId(3))),
        ("body 3", OutputPart::Acceleration(BodyId(3))),
        ("body 3", OutputPart::Asleep(BodyId(3))),
        ("joint 3", OutputPart::Coordinates(JointId(3))),
        ("joint 3", OutputPart::Velocities(JointId(3))),
        ("joint 3", OutputPart::Reaction(JointId(3))),
        ("row of contacts", OutputPart::ContactRow(1000)),
    ] {
        let fetch = AssertUnwindSafe(|| simulation.fetch_parts([part]));
        let told = catch_unwind(fetch).expect_err(what);
        let told = told.downcast_ref::<String>().unwrap();
        assert!(told.starts_with(what), "{told}");
    }
}

#[test]
fn runs_that_have_no_length() {
    let mut idle = |_: f64, _: &kinetarium_sim::Outputs<'_, f32>, _: &mut Controls<'_, f32>| Ok(());
    let mut simulation =
        Simulation::<f32>::new(chain(), SimulationSettings::new(2, 0.002)).unwrap();
    let mut run =
        |seconds, period, message| says(simulation.run(seconds, period, &mut idle), message);
    run(
        0.0,
        0.01,
        "run time [s] is 0: it must be at least one time step, and finite",
    );
    run(
        f64::NAN,
        0.01,
        "run time [s] is NaN: it must be at least one time step, and finite",
    );
    run(
        f64::INFINITY,
        0.01,
        "run time [s] is inf: it must be at least one time step, and finite",
    );
    run(
        1.0,
        -0.01,
        "control period [s] is -0.01: it must be at least one time step, and finite",
    );
    run(
        1.0,
        0.003,
        "control period [s] is 0.003: it must be a whole number of time steps",
    );
    assert_eq!(simulation.time(0), 0.0);
}

/// What is added to an object with two hinges.
type Add = fn(&mut Object, [JointHandle; 2]);

/// Two rods on a hinge each, one at the other, and what a case adds.
fn rods(add: Add) -> Result<Model, ModelError> {
    let mut world = Builder::new("rods");
    let object = world.object("rods");
    let rod = Geometry::Capsule {
        radius: 0.03,
        half_height: 0.2,
    };
    let upper = object.body("upper").shape(rod.clone()).handle();
    let lower = object.body("lower").shape(rod).handle();
    let first = object.revolute("first", upper, DVec3::Z).handle();
    let second = object
        .revolute("second", lower, DVec3::Z)
        .parent(upper)
        .handle();
    add(object, [first, second]);
    world.build()
}

/// A ball, or what a case makes of it, and a body that floats.
fn ball(change: Spoil<Parts>) -> Model {
    let mut world = Builder::new("ball");
    let object = world.object("ball");
    let sphere = Geometry::Sphere { radius: 0.1 };
    let held = object.body("held").shape(sphere.clone()).handle();
    object.ball("socket", held);
    let loose = object.body("loose").shape(sphere).handle();
    object.free("float", loose);
    let mut parts = world.build().unwrap().into_parts();
    change(&mut parts);
    Model::new(parts).unwrap()
}

fn refused_by(solver: SolverKind, model: Model, message: &str) {
    let settings = SimulationSettings {
        solver,
        ..SimulationSettings::new(2, 0.002)
    };
    says(Simulation::<f32>::new(model, settings), message);
}

#[test]
fn featherstone_takes_joints_that_hold() {
    let cases: &[(Add, &str)] = &[
        (
            |o, _| {
                let third = o
                    .body("third")
                    .shape(Geometry::Sphere { radius: 0.1 })
                    .handle();
                o.revolute("off", third, DVec3::Z).enabled(false);
            },
            "joint `off` is disabled, which `featherstone` cannot simulate: use the solver `xpbd`",
        ),
        (
            |o, _| {
                let third = o
                    .body("third")
                    .shape(Geometry::Sphere { radius: 0.1 })
                    .handle();
                o.revolute("soft", third, DVec3::Z).compliance(1e-4, 0.0);
            },
            "featherstone does not support compliance of `soft`: use the solver `xpbd`, or springs along the axes of a d6 joint",
        ),
    ];
    for (add, message) in cases {
        let model = rods(*add).unwrap();
        refused_by(SolverKind::Featherstone, model.clone(), message);
        for solver in [SolverKind::Auto, SolverKind::Xpbd] {
            let settings = SimulationSettings {
                solver,
                ..SimulationSettings::new(2, 0.002)
            };
            let simulation = Simulation::<f32>::new(model.clone(), settings).unwrap();
            assert_ne!(simulation.solver(), "featherstone", "{message}");
        }
    }
}

#[test]
fn loops_that_nothing_could_close() {
    let welded = rods(|o, _| {
        let third = o
            .body("third")
            .shape(Geometry::Sphere { radius: 0.1 })
            .handle();
        let fourth = o
            .body("fourth")
            .shape(Geometry::Sphere { radius: 0.1 })
            .handle();
        o.revolute("hung", third, DVec3::Z);
        o.fixed("weld", fourth).parent(third);
        o.ball("tie", fourth).parent(third).closes_loop(true);
    });
    refused_by(
        SolverKind::Featherstone,
        welded.unwrap(),
        "featherstone does not support a loop of bodies that nothing separates of `tie`: remove the joint",
    );
    let coupled = rods(|o, [first, second]| {
        o.couple("gears", second, first, 2.0, 0.0);
    });
    let mut settings = SimulationSettings {
        solver: SolverKind::Featherstone,
        ..SimulationSettings::new(2, 0.002)
    };
    settings.step.integrator = Integrator::RungeKutta4;
    says(
        Simulation::<f32>::new(coupled.unwrap(), settings),
        "featherstone does not support another integrator than semi-implicit Euler together with the loop or coupling of `gears`: use that integrator, or the solver `xpbd`",
    );
}

#[test]
fn a_world_cannot_be_given_a_loop() {
    let plain = rods(|_, _| ()).unwrap();
    let coupled = rods(|o, [a, b]| {
        o.couple("gears", b, a, 2.0, 0.0);
    })
    .unwrap();
    for solver in [SolverKind::Featherstone, SolverKind::Auto] {
        let settings = SimulationSettings {
            solver,
            ..SimulationSettings::new(2, 0.002)
        };
        let mut simulation = Simulation::<f32>::new(plain.clone(), settings).unwrap();
        says(
            simulation.set_world_model(1, &coupled),
            "the model of world 1 has another structure than the simulation's: only numbers may differ between worlds, \
             and what is zero since it is not there (drives, dry friction, springs, dampers) must stay zero",
        );
    }
}

const LIMIT: Limit = Limit {
    lower: -0.1,
    upper: 0.1,
    stiffness: 10.0,
    damping: 1.0,
    inertia: 0.0,
};

#[test]
fn laws_that_no_solver_has_for_a_ball() {
    let remedy = "use a d6 joint with three angular axes";
    let cases: &[(Spoil<Parts>, &str)] = &[
        (
            |p| p.joints[0].dofs[1].stiffness = 5.0,
            "a spring on the rotations of a ball or free joint of `socket`",
        ),
        (
            |p| p.joints[1].dofs[4].stiffness = 5.0,
            "a spring on the rotations of a ball or free joint of `float`",
        ),
        (
            |p| p.joints[0].dofs[2].limit = Some(LIMIT),
            "limits of a ball joint of `socket`",
        ),
        (
            |p| p.joints[0].dofs[1].drive.stiffness = 3.0,
            "drives that differ between the axes of a ball joint of `socket`",
        ),
    ];
    let solvers = [
        (SolverKind::Featherstone, "featherstone"),
        (SolverKind::Xpbd, "xpbd"),
    ];
    for (kind, name) in solvers {
        for (change, what) in cases {
            refused_by(
                kind,
                ball(*change),
                &format!("{name} does not support {what}: {remedy}"),
            );
        }
        let servo = |p: &mut Parts| {
            p.actuators.push(model::Actuator::position(
                "servo",
                model::JointId(0),
                5.0,
                1.0,
            ));
        };
        let remedy = "use the drive of a ball joint, or a d6 joint with three angular axes";
        let what = "a position servo on a ball or free joint of `servo`";
        refused_by(
            kind,
            ball(servo),
            &format!("{name} does not support {what}: {remedy}"),
        );
    }
}

#[test]
fn laws_that_xpbd_has_not() {
    let remedy = "use the solver `featherstone`, or a d6 joint with three angular axes";
    let cases: &[(Spoil<Parts>, &str)] = &[
        (
            |p| p.joints[0].dofs[0].armature = 0.1,
            "armature on a joint without axes of `socket`",
        ),
        (
            |p| p.joints[0].dofs[0].friction_loss = 0.1,
            "friction loss on a joint without axes of `socket`",
        ),
        (
            |p| p.joints[1].dofs[0].stiffness = 0.1,
            "a spring on a joint without axes of `float`",
        ),
        (
            |p| p.joints[1].dofs[0].damping = 0.1,
            "damping of a free joint of `float`",
        ),
        (
            |p| p.joints[0].dofs[1].damping = 0.1,
            "dampings that differ between the axes of a ball joint of `socket`",
        ),
    ];
    for (change, what) in cases {
        refused_by(
            SolverKind::Xpbd,
            ball(*change),
            &format!("xpbd does not support {what}: {remedy}"),
        );
        let settings = SimulationSettings::new(2, 0.002);
        assert!(
            Simulation::<f32>::new(ball(*change), settings).is_ok(),
            "featherstone takes it: {what}"
        );
    }

    let motor = |p: &mut Parts| {
        p.actuators
            .push(model::Actuator::motor("motor", model::JointId(0)))
    };
    refused_by(
        SolverKind::Xpbd,
        ball(motor),
        "xpbd does not support an actuator on a joint without axes of `motor`: act on it by the force of its degrees of freedom",
    );

    let joint = |axes: &[Axis]| {
        let mut world = Builder::new("d6");
        let object = world.object("d6");
        let body = object
            .body("body")
            .shape(Geometry::Sphere { radius: 0.1 })
            .handle();
        object.d6("joint", body, axes);
        world.build().unwrap()
    };
    let linear_last = joint(&[Axis::angular(DVec3::X), Axis::linear(DVec3::Y)]);
    refused_by(
        SolverKind::Xpbd,
        linear_last,
        "xpbd does not support a linear axis after an angular one of `joint`: order them linear first, or use the solver `featherstone`",
    );
    let apart = Axis {
        anchor: DVec3::X,
        ..Axis::angular(DVec3::Y)
    };
    refused_by(
        SolverKind::Xpbd,
        joint(&[Axis::angular(DVec3::X), apart]),
        "xpbd does not support axes that do not meet of `joint`: split the joint, or use the solver `featherstone`",
    );
}

/// Of its own process, since the variable is of the whole process: the child runs
/// `in_a_process_with_the_variable`.
#[test]
fn an_instruction_set_that_does_not_exist() {
    let run = |name: &str| {
        let mut child = Command::new(std::env::current_exe().unwrap());
        child.args([
            "--exact",
            "in_a_process_with_the_variable",
            "--ignored",
            "--nocapture",
        ]);
        let output = child.env("KINETARIUM_ISA", name).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let unknown = run("sse9");
    let message = "unknown instruction set `sse9`; known are avx512, avx2, neon, simd128, portable";
    assert!(unknown.contains(message), "{unknown}");
    let elsewhere = if cfg!(target_arch = "x86_64") {
        "neon"
    } else {
        "avx2"
    };
    let message =
        format!("instruction set `{elsewhere}` is not available on this machine; available are ");
    assert!(run(elsewhere).contains(&message));
    assert!(run("portable").contains("runs with portable"));
}

#[test]
#[ignore = "run by `an_instruction_set_that_does_not_exist`"]
fn in_a_process_with_the_variable() {
    match Simulation::<f32>::new(chain(), SimulationSettings::new(2, 0.002)) {
        Ok(simulation) => println!("runs with {}", simulation.isa()),
        Err(error) => println!("{error}"),
    }
}

/// A model without bodies, or with none that moves, is no misuse.
#[test]
fn models_in_which_nothing_moves_are_taken() {
    let mut world = Builder::new("room");
    world.object("room").body("wall").immovable();
    for model in [
        Model::new(Parts::default()).unwrap(),
        world.build().unwrap(),
    ] {
        for method in scene::METHODS {
            for worlds in [1, 17] {
                let mut simulation =
                    Simulation::<f32>::new(model.clone(), method.settings(worlds)).unwrap();
                assert_eq!(simulation.step(3), []);
                assert_eq!(simulation.outputs().energy(0), 0.0);
            }
        }
    }
}
