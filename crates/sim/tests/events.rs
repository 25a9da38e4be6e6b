//! What a simulation tells of its contacts, sensors, limits, sleepers and divergence.

use glam::DVec3;
use kinetarium_sim::{Event, EventKind, Simulation, SimulationSettings, SolverKind, Watch};
use model::{BodyId, Builder, Geometry, Limit, Material, Model, Pose, Shape, ShapeId};

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
            inertia: 0.0,
        });
    world.build().unwrap()
}

/// With `featherstone`, whose contacts tell the impulse of the whole step.
fn reduced(worlds: usize) -> SimulationSettings {
    SimulationSettings {
        solver: SolverKind::Featherstone,
        ..SimulationSettings::new(worlds, H)
    }
}

fn events(restitution: f64, worlds: usize, threads: usize, watch: Watch) -> Vec<Event> {
    let settings = SimulationSettings {
        threads,
        ..reduced(worlds)
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

/// A ball of e = 0.8 that falls by s bounces first at t = √(2 s / g) and then every 2 eⁿ t; with each solver a contact
/// begins there, ends some steps later, and does not begin again before the next bounce.
#[test]
fn contacts_begin_and_end_with_every_solver() {
    let (fall, e) = (0.2, 0.8);
    for solver in SOLVERS {
        let settings = SimulationSettings {
            solver,
            threads: 1,
            ..SimulationSettings::new(3, H)
        };
        let mut simulation = Simulation::<f32>::new(scene(e), settings).unwrap();
        simulation.watch(Watch {
            contacts: true,
            ..Watch::default()
        });
        simulation.step(600);
        let told = simulation.drain_events();
        let told: Vec<_> = told.iter().filter(|event| event.world == 1).collect();
        let first = f64::sqrt(2.0 * fall / 9.81);
        let bounce = |n: i32| first * (1.0 + (1..=n).map(|i| 2.0 * e.powi(i)).sum::<f64>());
        // What a bounce loses of its height, v h, shortens its flight by 2 h, and each later one by e of that.
        let late = |n: i32| {
            let shorter = |k| (1.0 - e.powi(k)) / (1.0 - e);
            2.0 * H * (1.0 + (1..=n).map(shorter).sum::<f64>())
        };
        let bounces = (0..).take_while(|n| bounce(*n) < 600.0 * H - 0.05);
        let mut count = 0;
        for (n, pair) in bounces.zip(told.chunks_exact(2)) {
            let what = format!("{solver:?}, bounce {n}: {pair:?}");
            assert!(
                matches!(pair[0].kind, EventKind::ContactBegins { shapes, .. } if shapes == BALL_ON_GROUND),
                "{what}"
            );
            let shapes = BALL_ON_GROUND;
            assert_eq!(pair[1].kind, EventKind::ContactEnds { shapes }, "{what}");
            let off = pair[0].time - bounce(n);
            assert!(off.abs() < late(n), "{what}: off by {off} s");
            let lasts = pair[1].time - pair[0].time;
            assert!(lasts > 0.0 && lasts < 5.0 * H, "{what}");
            count += 1;
        }
        assert!(count >= 4, "{solver:?}: {told:?}");
    }
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

/// By x = 0.4 cos(ω t), ω² = m g l / I = 9.81 · 0.5 / 0.26, the pendulum is at 0.1 after 0.30 s, and at -0.3 after
/// 0.56 s.
#[test]
fn limits_are_those_of_each_world() {
    let mut parts = scene(0.0).into_parts();
    parts.joints[1].dofs[0].limit.as_mut().unwrap().lower = 0.1;
    let own = Model::new(parts).unwrap();
    let watch = Watch {
        limits: true,
        ..Watch::default()
    };
    let cases = SOLVERS.map(|solver| [(solver, true), (solver, false)]);
    for (solver, watched_before) in cases.into_iter().flatten() {
        let settings = SimulationSettings {
            solver,
            ..SimulationSettings::new(2, H)
        };
        let mut simulation = Simulation::<f32>::new(scene(0.0), settings).unwrap();
        if watched_before {
            simulation.watch(watch);
            simulation.step(5);
        }
        simulation.set_world_model(1, &own).unwrap();
        if !watched_before {
            simulation.watch(watch);
        }
        simulation.step(200);
        let told = simulation.drain_events();
        let [event] = told.as_slice() else {
            panic!("{solver:?}: {told:?}");
        };
        let lower = EventKind::LimitReached {
            dof: 6,
            upper: false,
        };
        assert_eq!((event.world, event.kind), (1, lower));
        assert!((0.28..0.33).contains(&event.time), "{solver:?}: {event:?}");
    }
}

#[test]
fn the_order_is_the_same_whatever_the_threads() {
    let one = events(0.5, 40, 1, Watch::ALL);
    assert_eq!(one, events(0.5, 40, 2, Watch::ALL));
    assert!(one.is_sorted_by(|a, b| (a.time, a.world) <= (b.time, b.world)));
}

/// Towers of boxes, more than one thread takes for itself, of which some are pushed over and out of a zone, while the
/// others fall asleep.
fn towers_and_zone(threads: usize) -> Simulation<f32> {
    let mut simulation = sensing(SolverKind::Impulse, [1, threads], |world| {
        let plane = Geometry::Plane {
            half_x: 0.0,
            half_z: 0.0,
        };
        let zone = zone(0.5).at(Pose::at(DVec3::new(0.75, 0.5, 0.0)));
        let ground = world.object("ground");
        ground.scenery(Shape::new(plane)).scenery(zone);
        let half = DVec3::splat(0.05);
        let things = world.object("things");
        for (tower, floor) in (0..24).flat_map(|t| (0..8).map(move |f| (t, f))) {
            let place = DVec3::new(
                0.3 * f64::from(tower % 6),
                0.05 + 0.1 * f64::from(floor),
                0.3 * f64::from(tower / 6),
            );
            let body = things
                .body(format!("box_{tower}_{floor}"))
                .at(Pose::at(place));
            body.shape(Shape::new(Geometry::Box { half }));
        }
    });
    let position = simulation.outputs().joint_position(0);
    let mut velocity = vec![0.0; simulation.model().degrees_of_freedom()];
    for (body, v) in velocity.chunks_exact_mut(6).enumerate() {
        // The upper half of every third tower.
        if body / 8 % 3 == 0 && body % 8 > 3 {
            (v[0], v[2]) = (1.7, 0.4);
        }
    }
    simulation.set_joint_state(0, &position, &velocity).unwrap();
    simulation
}

#[test]
fn the_order_is_the_same_where_threads_share_a_world() {
    let events = |threads| {
        let mut simulation = towers_and_zone(threads);
        simulation.watch(Watch::ALL);
        simulation.step(800);
        // What sleeps by then is pushed over, too.
        let mut velocity = simulation.outputs().joint_velocity(0);
        for (body, v) in velocity.chunks_exact_mut(6).enumerate() {
            if simulation.outputs().asleep(0, BodyId(body)) {
                v[0] = 0.3;
            }
        }
        let pushed = simulation.set_joint_velocities([(0, &velocity[..])]);
        pushed.unwrap();
        simulation.step(100);
        simulation.drain_events()
    };
    let one = events(1);
    let count = |of: fn(&EventKind) -> bool| one.iter().filter(|e| of(&e.kind)).count();
    let counts = [
        count(|kind| matches!(kind, EventKind::ContactBegins { .. })),
        count(|kind| matches!(kind, EventKind::ContactEnds { .. })),
        count(|kind| matches!(kind, EventKind::SensorEnds { .. })),
        count(|kind| matches!(kind, EventKind::FallsAsleep { .. })),
        count(|kind| matches!(kind, EventKind::Wakes { .. })),
    ];
    println!("{counts:?} of {}", one.len());
    assert!(counts.iter().all(|n| *n > 2), "{counts:?}");
    for threads in [2, 3] {
        assert!(events(threads) == one, "{threads} threads");
    }
}

#[test]
fn a_subscriber_hears_the_same() {
    let mut simulation = Simulation::<f32>::new(scene(0.5), reduced(3)).unwrap();
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
    let mut simulation = Simulation::<f32>::new(scene(0.0), reduced(1)).unwrap();
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
    let mut simulation = Simulation::<f32>::new(scene(0.0), reduced(1)).unwrap();
    simulation.step(300);
    assert_eq!(simulation.drain_events(), []);
}

const SLEEP: Watch = Watch {
    contacts: false,
    persisting_contacts: false,
    sensors: false,
    limits: false,
    sleep: true,
    divergence: false,
};

/// A cube of 20 cm at rest on the ground, with a second 0.5 m above it, for `impulse`.
fn cubes() -> Simulation<f32> {
    let mut world = Builder::new("cubes");
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    world.object("ground").scenery(Shape::new(plane));
    let cube = Shape::new(Geometry::Box {
        half: DVec3::splat(0.1),
    });
    let things = world.object("things");
    for (name, height) in [("low", 0.1), ("high", 0.8)] {
        let place = Pose::at(DVec3::Y * height);
        things.body(name).at(place).shape(cube.clone());
    }
    let settings = SimulationSettings {
        solver: SolverKind::Impulse,
        threads: 1,
        ..SimulationSettings::new(2, H)
    };
    Simulation::new(world.build().unwrap(), settings).unwrap()
}

/// World 0 as it was built; in world 1 the upper cube lies elsewhere.
fn apart(simulation: &mut Simulation<f32>) {
    let mut position = simulation.outputs().joint_position(1);
    let upper = position.len() - 7;
    position[upper..][..2].copy_from_slice(&[3.0, 0.1]);
    let still = vec![0.0; simulation.model().degrees_of_freedom()];
    simulation.set_joint_state(1, &position, &still).unwrap();
}

/// Each for itself after half a second; together half a second after the one has hit the other.
#[test]
fn islands_fall_asleep_together() {
    let mut simulation = cubes();
    simulation.watch(SLEEP);
    apart(&mut simulation);
    simulation.step(1000);
    let told = simulation.drain_events();
    let both = [0, 1].map(|i| EventKind::FallsAsleep { body: BodyId(i) });
    for world in [0, 1] {
        let own: Vec<_> = told.iter().filter(|e| e.world == world).collect();
        assert!(own.iter().map(|e| &e.kind).eq(&both), "{own:?}");
        assert_eq!(own[0].time, own[1].time);
        let expected = if world == 0 { 0.9 } else { 0.5 };
        assert!((own[0].time - expected).abs() < 0.15, "{own:?}");
        let outputs = simulation.outputs();
        assert!([0, 1].iter().all(|&i| outputs.asleep(world, BodyId(i))));
    }
}

/// In the substep in which the force acts, and nothing else does.
#[test]
fn a_push_wakes() {
    let mut simulation = cubes();
    apart(&mut simulation);
    simulation.step(500);
    simulation.watch(SLEEP);
    simulation.step(10);
    assert_eq!(simulation.drain_events(), [], "they slept before");
    let time = simulation.time(1);
    simulation.controls().set_dof_force(1, 1, 1e3).unwrap();
    simulation.step(5);
    let told = simulation.drain_events();
    let [event] = told.as_slice() else {
        panic!("{told:?}");
    };
    let kind = EventKind::Wakes { body: BodyId(0) };
    assert_eq!((event.world, event.kind), (1, kind));
    assert!((event.time - time - H).abs() < 1e-9, "{event:?}");
    let outputs = simulation.outputs();
    assert!(!outputs.asleep(1, BodyId(0)) && outputs.asleep(1, BodyId(1)));
}

#[test]
fn a_sleeper_that_is_set_does_not_wake_but_never_slept() {
    let mut simulation = cubes();
    simulation.watch(SLEEP);
    apart(&mut simulation);
    simulation.step(500);
    assert_ne!(simulation.drain_events(), []);
    apart(&mut simulation);
    simulation.step(10);
    assert_eq!(simulation.drain_events(), []);
    assert!(!simulation.outputs().asleep(1, BodyId(0)));
}

/// In the substep in which it happens, once, and nothing after it; other worlds go on.
#[test]
fn a_world_diverges_once() {
    for solver in SOLVERS {
        let mut settings = SimulationSettings {
            solver,
            threads: 1,
            ..SimulationSettings::new(3, H)
        };
        settings.step.speed_limit = 50.0;
        settings.step.substeps = 4;
        let mut simulation = Simulation::<f32>::new(scene(0.0), settings).unwrap();
        simulation.watch(Watch::ALL);
        // Upwards with gravity and 2 kg: the limit of 50 m/s is passed 50 / (10¹ · 10²) s later.
        let force = MASS * (1000.0 + 9.81);
        simulation.controls().set_dof_force(1, 1, force).unwrap();
        simulation.step(300);
        let told = simulation.drain_events();
        let ends: Vec<_> = told.iter().filter(|e| e.world == 1).collect();
        let [end] = ends.as_slice() else {
            panic!("{solver:?}: {ends:?}");
        };
        assert_eq!(end.kind, EventKind::Diverged);
        assert!((end.time - 0.05).abs() < 0.6 * H, "{solver:?}: {end:?}");
        assert!(told.iter().any(|e| e.world == 2 && e.time > 0.5));
        simulation.reset_all();
        simulation.step(10);
        assert_eq!(simulation.drain_events(), [], "{solver:?}");
    }
}

const SOLVERS: [SolverKind; 3] = [
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];

/// Worlds of a scene of its own, in threads; `build` adds the shapes and bodies.
fn sensing(
    solver: SolverKind,
    [worlds, threads]: [usize; 2],
    build: impl FnOnce(&mut Builder),
) -> Simulation<f32> {
    let mut world = Builder::new("sensors");
    build(&mut world);
    let settings = SimulationSettings {
        solver,
        threads,
        ..SimulationSettings::new(worlds, H)
    };
    Simulation::new(world.build().unwrap(), settings).unwrap()
}

fn ball() -> Shape {
    Shape::new(Geometry::Sphere { radius: 0.1 })
}

fn zone(half: f64) -> Shape {
    let half = DVec3::splat(half);
    Shape::new(Geometry::Box { half }).named("zone").as_sensor()
}

/// From 2 m, through a zone from 1.2 to 0.8 m: in at √(2 · 0.7 / g), out at √(2 · 1.3 / g), as if
/// nothing were there.
#[test]
fn a_ball_falls_through_a_sensor() {
    for solver in SOLVERS {
        for worlds in [1, 3] {
            falls_through_a_sensor(solver, worlds);
        }
    }
}

fn falls_through_a_sensor(solver: SolverKind, worlds: usize) {
    let mut simulation = sensing(solver, [worlds, 1], |world| {
        let zone = zone(0.2).at(Pose::at(DVec3::Y));
        world.object("zone").scenery(zone);
        let things = world.object("things");
        let high = Pose::at(2.0 * DVec3::Y);
        things.body("ball").at(high).shape(ball());
    });
    let last = worlds - 1;
    simulation.watch(Watch::ALL);
    let mut touched = 0;
    for _ in 0..300 {
        simulation.step(1);
        let outputs = simulation.outputs();
        touched += outputs.contacts(last).filter(|c| c.distance < 0.0).count();
        assert!(outputs.contacts(last).all(|c| c.force == DVec3::ZERO));
    }
    let told = simulation.drain_events();
    let told: Vec<_> = told.iter().filter(|e| e.world == last).collect();
    let shapes = [ShapeId(0), ShapeId(1)];
    let kinds = [
        EventKind::SensorBegins { shapes },
        EventKind::SensorEnds { shapes },
    ];
    assert!(
        told.iter().map(|e| &e.kind).eq(&kinds),
        "{solver:?}: {told:?}"
    );
    for (event, way) in told.iter().zip([0.7, 1.3]) {
        let time = f64::sqrt(2.0 * way / 9.81);
        assert!((event.time - time).abs() < 2.0 * H, "{event:?}, not {time}");
    }
    assert!(touched > 60, "{solver:?}: {touched}");
    let (time, outputs) = (simulation.time(last), simulation.outputs());
    assert!((outputs.body_velocity(last, BodyId(0)).y + 9.81 * time).abs() < 1e-4);
}

/// A ghost falls through a cube that sleeps in a zone, and on through the ground: the cube sleeps on,
/// and stays in the zone.
#[test]
fn sensors_wake_nobody() {
    let mut simulation = sensing(SolverKind::Impulse, [1, 1], |world| {
        let plane = Geometry::Plane {
            half_x: 0.0,
            half_z: 0.0,
        };
        let ground = world.object("ground");
        ground.scenery(Shape::new(plane)).scenery(zone(0.3));
        let cube = Shape::new(Geometry::Box {
            half: DVec3::splat(0.1),
        });
        let things = world.object("things");
        let low = Pose::at(0.1 * DVec3::Y);
        things.body("cube").at(low).shape(cube);
        let high = Pose::at(4.0 * DVec3::Y);
        let ghost = ball().as_sensor();
        things.body("ghost").at(high).shape(ghost);
    });
    let [ground, zone, cube, ghost] = [0, 1, 2, 3].map(ShapeId);
    simulation.watch(Watch {
        sensors: true,
        ..SLEEP
    });
    simulation.step(500);
    let told = simulation.drain_events();
    let pair = |shapes: [ShapeId; 2]| {
        let [a, b] = shapes;
        [a.min(b), a.max(b)]
    };
    let of = |kind: &EventKind| match *kind {
        EventKind::SensorBegins { shapes } => (true, pair(shapes)),
        EventKind::SensorEnds { shapes } => (false, pair(shapes)),
        EventKind::FallsAsleep { body } => (true, [ShapeId(usize::MAX), ShapeId(body.0)]),
        _ => panic!("{told:?}"),
    };
    let expected = [
        (true, [zone, cube]),
        (true, [ShapeId(usize::MAX), ShapeId(0)]),
        (true, [zone, ghost]),
        (true, [cube, ghost]),
        (true, [ground, ghost]),
        (false, [cube, ghost]),
        (false, [zone, ghost]),
    ];
    let kinds: Vec<_> = told.iter().map(|e| of(&e.kind)).collect();
    assert_eq!(kinds, expected);
    assert!(simulation.outputs().asleep(0, BodyId(0)));
}

/// A motor turns an arm about an upright axis against a light cube that lies on the ground. With `sensors`, there
/// is a zone about the cube, and a ball at the arm's hand that both pass through.
fn sweep(sensors: bool) -> Model {
    let mut world = Builder::new("sweep");
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    let place = Pose::at(DVec3::new(0.0, 0.1, -0.6));
    let ground = world.object("ground").scenery(Shape::new(plane));
    if sensors {
        ground.scenery(zone(0.15).at(place));
    }
    let things = world.object("things");
    let cube = Shape::new(Geometry::Box {
        half: DVec3::splat(0.1),
    });
    things.body("cube").at(place).shape(cube).mass(0.2);
    let arm = Geometry::Capsule {
        radius: 0.04,
        half_height: 0.3,
    };
    let height = Pose::at(DVec3::Y * 0.1);
    let lying = Pose::new(
        DVec3::X * 0.3,
        glam::DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2),
    );
    let arm = things
        .body("arm")
        .at(height)
        .shape(Shape::new(arm).at(lying))
        .mass(1.0);
    if sensors {
        let hand = ball().at(Pose::at(DVec3::X * 0.6)).as_sensor();
        arm.shape(hand.with_density(0.0));
    }
    let arm = arm.handle();
    let hinge = things.revolute("hinge", arm, DVec3::Y);
    let hinge = hinge.at(height).damping(0.1).handle();
    things.motor("motor", hinge);
    world.build().unwrap()
}

/// The hand enters zone and cube, and leaves them; the arm pushes the cube out of the zone, and all is to the bit as
/// without sensors.
#[test]
fn sensors_of_robots_change_nothing() {
    assert_eq!(
        SolverKind::Auto.pick(&sweep(true), true),
        SolverKind::Featherstone
    );
    for solver in [SolverKind::Featherstone, SolverKind::Xpbd] {
        let settings = SimulationSettings {
            solver,
            threads: 1,
            ..SimulationSettings::new(3, H)
        };
        let run = |sensors| {
            let mut simulation = Simulation::<f64>::new(sweep(sensors), settings).unwrap();
            let watch = Watch {
                sensors: true,
                ..Watch::default()
            };
            simulation.watch(watch);
            for world in 0..3 {
                let push = 1.0 + 0.05 * world as f64;
                simulation.controls().set_control(world, &[push]).unwrap();
            }
            simulation.step(1000);
            let outputs = simulation.outputs();
            let state = [outputs.joint_position(1), outputs.joint_velocity(1)].concat();
            let pressing = outputs
                .contacts(1)
                .filter(|c| c.force != DVec3::ZERO)
                .count();
            (state, pressing, simulation.drain_events())
        };
        let (plain, sensing) = (run(false), run(true));
        assert_eq!((&plain.0, plain.1), (&sensing.0, sensing.1), "{solver:?}");
        assert!(plain.1 > 0, "the cube lies on the ground");
        let [cube, hand] = sensing_shapes(&sweep(true));
        let zone = ShapeId(1);
        let count = |begins: bool, pair: [ShapeId; 2]| {
            let same = |shapes: &[ShapeId; 2]| pair.iter().all(|shape| shapes.contains(shape));
            let of = |e: &&Event| match &e.kind {
                EventKind::SensorBegins { shapes } => begins && same(shapes),
                EventKind::SensorEnds { shapes } => !begins && same(shapes),
                _ => false,
            };
            let told = sensing.2.iter().filter(|e| e.world == 1);
            told.filter(of).count()
        };
        for pair in [[zone, hand], [cube, hand]] {
            assert!(
                count(true, pair) > 0,
                "{solver:?}: {pair:?}: {:?}",
                sensing.2
            );
            assert!(
                count(false, pair) > 0,
                "{solver:?}: {pair:?}: {:?}",
                sensing.2
            );
        }
        let lies = [true, false].map(|begins| count(begins, [zone, cube]));
        assert_eq!(lies, [1, 1], "{solver:?}: it is pushed out");
    }
}

/// The shape of the cube, and that of the hand.
fn sensing_shapes(model: &Model) -> [ShapeId; 2] {
    let cube = model.body("cube").unwrap();
    let row = model
        .shapes
        .iter()
        .position(|s| s.body == Some(cube))
        .unwrap();
    let moves = |s: &Shape| s.sensor && s.body.is_some();
    let hand = model.shapes.iter().position(moves).unwrap();
    [ShapeId(row), ShapeId(hand)]
}
