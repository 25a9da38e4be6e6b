//! Sequential impulses against closed forms: h is a small step, H = 8 h a step.

use glam::{DQuat, DVec3};
use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::{
    BodyHandle, BodyId, Builder, Combine, Geometry, Hull, Material, Model, Pose, Shape, Softness,
};
use numbers::Float;
use rigid::Integrator;

const G: f64 = 9.81;
/// H [s].
const STEP: f64 = 0.002;

const PLANE: Geometry = Geometry::Plane {
    half_x: 0.0,
    half_z: 0.0,
};

fn settings() -> SimulationSettings {
    let mut settings = SimulationSettings::new(1, STEP);
    settings.solver = SolverKind::Impulse;
    settings.threads = 1;
    settings.step.sleep_speed = 0.0;
    settings
}

fn simulate<T: Float>(model: Model) -> Simulation<T> {
    Simulation::new(model, settings()).unwrap()
}

fn smooth() -> Material {
    Material {
        friction: 0.0,
        ..Material::default()
    }
}

/// A body of a shape, resting on a plane through the origin that leans about z by `angle`.
fn on_plane(shape: Shape, height: f64, angle: f64, material: Material) -> (Model, BodyHandle) {
    let turn = Pose::new(DVec3::ZERO, DQuat::from_rotation_z(-angle));
    let mut world = Builder::new("incline");
    let plane = Shape::new(PLANE).with_material(material).at(turn);
    world.object("ground").scenery(plane);
    let body = world
        .object("things")
        .body("thing")
        .at(turn * Pose::at(DVec3::Y * height))
        .shape(shape.with_material(material))
        .handle();
    (world.build().unwrap(), body)
}

fn cube() -> Shape {
    Shape::new(Geometry::Box {
        half: DVec3::splat(0.1),
    })
}

fn body() -> BodyId {
    BodyId(0)
}

#[test]
fn what_rests_presses_with_its_weight() {
    let (model, _) = on_plane(cube(), 0.1, 0.0, Material::default());
    let weight = model.total_mass() * G;
    let mut sim = simulate::<f32>(model);
    sim.step(500);
    let outputs = sim.outputs();
    let force: DVec3 = outputs.contacts(0).map(|c| c.force).sum();
    assert!(
        (force - weight * DVec3::Y).length() < 1e-3 * weight,
        "{force}"
    );
    assert_eq!(outputs.contacts(0).count(), 4);
    assert!(
        outputs
            .contacts(0)
            .all(|c| c.distance.abs() < 1e-4 && c.normal.y > 0.999)
    );
}

/// Below tan θ = μ it stays; above, it slides with a = g (sin θ − μ cos θ), to first order in H.
#[test]
fn a_block_on_an_incline_sticks_or_slides() {
    let material = Material {
        friction: 0.5,
        ..Material::default()
    };
    for (angle, slides) in [(0.45_f64, false), (0.48, true), (0.6, true)] {
        let (model, _) = on_plane(cube(), 0.1, angle, material);
        let mut sim = simulate::<f64>(model);
        let start = sim.outputs().body_position(0, body());
        sim.step(500);
        let way = (sim.outputs().body_position(0, body()) - start).length();
        let a = G * (angle.sin() - 0.5 * angle.cos());
        let expected = if slides { 0.5 * a } else { 0.0 };
        assert!(
            (way - expected).abs() < 2e-4 + 0.005 * expected,
            "{angle}: {way} for {expected}"
        );
    }
}

/// A cube as the hull of its corners, which lie anywhere in the shape's frame.
fn hull_of_cube() -> Shape {
    let away = Pose::new(
        DVec3::new(0.3, -0.2, 0.5),
        DQuat::from_scaled_axis(DVec3::new(0.4, 0.9, -0.3)),
    );
    let side = |i: usize, bit: usize| if i >> bit & 1 == 1 { 0.1 } else { -0.1 };
    let corner = |i| away.point(DVec3::new(side(i, 0), side(i, 1), side(i, 2)));
    let corners: Vec<_> = (0..8).map(corner).collect();
    Shape::new(Geometry::Hull(Hull::new(&corners).unwrap())).at(away.inverse())
}

/// At rest, stuck, sliding, and dropped: in the same place after each step.
#[test]
fn a_hull_in_the_form_of_a_cube_is_the_cube() {
    let material = Material {
        friction: 0.5,
        ..Material::default()
    };
    // A fall makes something of the order of the points. So does the beginning of a slide, by 2e-4 m/s: points are solved in
    // turn, so that they bear unevenly at first, and friction acts where they bear.
    for (height, angle, near) in [
        (0.1, 0.0, 1e-6),
        (0.1, 0.4, 1e-6),
        (0.1, 0.6, 5e-4),
        (0.2, 0.2, 1e-3),
    ] {
        let [mut cuboid, mut hull] = [cube(), hull_of_cube()]
            .map(|shape| simulate::<f64>(on_plane(shape, height, angle, material).0));
        for step in 0..500 {
            cuboid.step(1);
            hull.step(1);
            let places = [&mut cuboid, &mut hull].map(|sim| sim.outputs().body_position(0, body()));
            let off = (places[0] - places[1]).length();
            assert!(off < near, "{angle}, step {step}: {off}");
        }
    }
}

/// Hulls of 4, 6, 8 and 12 corners, some of them side by side in lanes, fall on a plane and on each
/// other: in lanes as one by one, and at rest in the end.
#[test]
fn hulls_of_any_number_of_corners_pile_up() {
    let corners = |n: usize, height: f64| -> Vec<DVec3> {
        let ring = |y: f64| {
            (0..n).map(move |i| {
                let turn = std::f64::consts::TAU * i as f64 / n as f64;
                DVec3::new(0.1 * turn.cos(), y, 0.1 * turn.sin())
            })
        };
        ring(0.0).chain(ring(height)).collect()
    };
    let tetrahedron = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| 0.15 * p);
    let solids = [
        tetrahedron.to_vec(),
        corners(3, 0.1),
        corners(4, 0.08),
        corners(6, 0.12),
    ];
    let mut world = Builder::new("hulls");
    world.object("ground").scenery(Shape::new(PLANE));
    let pile = world.object("pile");
    for i in 0..16 {
        let hull = Hull::new(&solids[i % 4]).unwrap();
        let place = DVec3::new(0.02 * (i % 3) as f64, 0.1 + 0.2 * i as f64, 0.01 * i as f64);
        pile.body(format!("hull_{i}"))
            .at(Pose::at(place))
            .shape(Geometry::Hull(hull));
    }
    let model = world.build().unwrap();
    let weight = model.total_mass() * G;
    let run = |settings: SimulationSettings| {
        let mut sim = Simulation::<f32>::new(model.clone(), settings).unwrap();
        sim.step(1200);
        let outputs = sim.outputs();
        let places: Vec<_> = (0..16)
            .map(|i| outputs.body_position(0, BodyId(i)))
            .collect();
        let ground = outputs.contacts(0).filter(|c| c.shapes[0].0 == 0);
        (places, ground.map(|c| c.force.y).sum::<f64>())
    };
    let (places, force) = run(settings());
    assert!((force / weight - 1.0).abs() < 1e-4, "{force} for {weight}");
    let lies = |p: &DVec3| p.y > -1e-3 && p.y < 1.0 && p.length() < 3.0;
    assert!(places.iter().all(lies), "{places:?}");
    let (mut scalar, mut threads) = (settings(), settings());
    scalar.scalar = true;
    threads.threads = 2;
    assert_eq!([run(scalar).0, run(threads).0], [places.clone(), places]);
}

/// v² / 2 μ g, and at most what a step more makes of it.
#[test]
fn a_block_that_slides_stops_in_time() {
    let (speed, friction) = (3.0, 0.5);
    let material = Material {
        friction,
        ..Material::default()
    };
    let (model, _) = on_plane(cube(), 0.1, 0.0, material);
    let mut sim = simulate::<f64>(model);
    let mut velocity = [0.0; 6];
    velocity[0] = speed;
    sim.set_joint_state(0, &[0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 1.0], &velocity)
        .unwrap();
    sim.step(1000);
    let x = sim.outputs().body_position(0, body()).x;
    let ideal = speed * speed / (2.0 * friction * G);
    assert!((x - ideal).abs() < speed * STEP, "{x} for {ideal}");
    assert!(sim.outputs().body_velocity(0, body()).length() < 1e-6);
}

/// Each bounce reaches e² of the height before, of which what is seen misses the top by up to half of a step: g H² / 8.
#[test]
fn bounces_follow_e_squared() {
    for e in [0.0, 0.1, 0.5, 0.8, 1.0] {
        let material = Material {
            restitution: e,
            ..Material::default()
        };
        let ball = Shape::new(Geometry::Sphere { radius: 0.1 });
        let (model, _) = on_plane(ball, 1.1, 0.0, material);
        let mut sim = simulate::<f64>(model);
        let (mut top, mut rising, mut heights) = (1.0_f64, false, Vec::new());
        let mut last = 1.0;
        for _ in 0..6000 {
            sim.step(1);
            let height = sim.outputs().body_position(0, body()).y - 0.1;
            if height > last {
                (rising, top) = (true, height);
            } else if rising {
                heights.push(top);
                rising = false;
            }
            last = height;
            if heights.len() == 10 {
                break;
            }
        }
        // What comes at less than 2 g H rests.
        let bounces = |height: f64| height > 2.0 * (2.0 * G * STEP).powi(2) / (2.0 * G);
        let mut before = 1.0;
        for height in heights.iter().filter(|height| bounces(**height)) {
            let ideal = e * e * before;
            let missed = G * STEP * STEP / 8.0 * (1.0 + e * e);
            assert!(
                (height - ideal).abs() < missed + 1e-9,
                "e = {e}: {heights:?}"
            );
            before = *height;
        }
        assert!(e < 0.5 || heights.len() > 3, "e = {e}: {heights:?}");
        assert!(e < 1.0 || heights.len() == 10, "{heights:?}");
    }
}

/// Down an incline without slipping: a = g sin θ / (1 + I / m r²): 5/7 for a ball, 2/3 for a cylinder.
#[test]
fn what_rolls_down_an_incline() {
    let angle = 0.3_f64;
    let lying = Pose::new(
        DVec3::ZERO,
        DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2),
    );
    let cylinder = Shape::new(Geometry::Cylinder {
        radius: 0.1,
        half_height: 0.1,
    });
    let ball = Shape::new(Geometry::Sphere { radius: 0.1 });
    for (shape, share) in [(ball, 5.0 / 7.0), (cylinder.at(lying), 2.0 / 3.0)] {
        let (model, _) = on_plane(shape, 0.1, angle, Material::default());
        let mut sim = simulate::<f64>(model);
        let start = sim.outputs().body_position(0, body());
        sim.step(500);
        let way = (sim.outputs().body_position(0, body()) - start).length();
        let ideal = 0.5 * share * G * angle.sin();
        assert!((way - ideal).abs() < 0.01 * ideal, "{way} for {ideal}");
    }
}

/// Twisting slows by α = τ/I with τ = rₜ m g, rolling by the same with rᵣ; both stop.
#[test]
fn torsional_and_rolling_friction_are_lengths_times_the_load() {
    let (torsion, rolling, radius) = (0.01, 0.005, 0.1);
    let material = Material {
        friction: 1.0,
        torsional_friction: torsion,
        rolling_friction: rolling,
        ..Material::default()
    };
    let ball = Shape::new(Geometry::Sphere { radius });
    let (model, _) = on_plane(ball, radius, 0.0, material);
    let mut sim = simulate::<f64>(model);
    let rest = [0.0, radius, 0.0, 0.0, 0.0, 0.0, 1.0];
    let mut velocity = [0.0; 6];
    velocity[4] = 10.0;
    sim.set_joint_state(0, &rest, &velocity).unwrap();
    sim.step(50);
    let spin = sim.outputs().body_angular_velocity(0, body()).y;
    let ideal = 10.0 - 0.1 * torsion * G / (0.4 * radius * radius);
    assert!(
        (spin - ideal).abs() < 0.01 * (10.0 - ideal),
        "{spin} for {ideal}"
    );
    sim.step(1000);
    assert!(sim.outputs().body_angular_velocity(0, body()).length() < 1e-9);

    // m a = −F, I α = F r − τ, a = α r: a (7/5) = −τ / (m r)
    let mut velocity = [0.0; 6];
    (velocity[0], velocity[5]) = (1.0, -1.0 / radius);
    sim.set_joint_state(0, &rest, &velocity).unwrap();
    sim.step(250);
    let speed = sim.outputs().body_velocity(0, body()).x;
    let ideal = 1.0 - 0.5 * rolling * G / radius / 1.4;
    assert!(
        (speed - ideal).abs() < 0.02 * (1.0 - ideal),
        "{speed} for {ideal}"
    );
    sim.step(2000);
    assert!(sim.outputs().body_velocity(0, body()).length() < 1e-9);
}

/// Two bodies without weight.
fn two(shape: Shape, masses: [f64; 2], material: Material, apart: [DVec3; 2]) -> Model {
    let mut world = Builder::new("two");
    world.gravity(DVec3::ZERO);
    let things = world.object("things");
    for (i, (mass, at)) in masses.into_iter().zip(apart).enumerate() {
        let shape = shape.clone().with_material(material);
        things
            .body(format!("thing_{i}"))
            .at(Pose::at(at))
            .shape(shape)
            .mass(mass);
    }
    world.build().unwrap()
}

fn set_velocities<T: Float>(sim: &mut Simulation<T>, velocities: &[f64]) {
    let position = sim.outputs().joint_position(0);
    sim.set_joint_state(0, &position, velocities).unwrap();
}

/// Smooth elastic spheres at any offset: along the line of centres the velocities change as in a
/// collision of points, across it they stay.
#[test]
fn elastic_spheres_part_by_the_law_of_collisions() {
    let material = Material {
        restitution: 1.0,
        ..smooth()
    };
    let (m1, m2, r) = (1.0, 3.0, 0.1);
    for offset in [0.0, 0.05, 0.12, 0.19] {
        let ball = Shape::new(Geometry::Sphere { radius: r });
        let start = [DVec3::new(-0.4, offset, 0.0), DVec3::ZERO];
        let mut sim = simulate::<f64>(two(ball, [m1, m2], material, start));
        let mut velocities = [0.0; 12];
        velocities[0] = 2.0;
        set_velocities(&mut sim, &velocities);
        let before = (sim.outputs().momentum(0), sim.outputs().kinetic_energy(0));
        sim.step(250);
        let outputs = sim.outputs();
        let normal = DVec3::new(-(4.0 * r * r - offset * offset).sqrt(), offset, 0.0) / (2.0 * r);
        let along = DVec3::X.dot(normal) * 2.0;
        let ideal = 2.0 * DVec3::X - normal * along * 2.0 * m2 / (m1 + m2);
        let first = outputs.body_velocity(0, BodyId(0));
        // The normal is that of the step's start: off by up to the angle of a step's way.
        assert!(
            (first - ideal).length() < 2.0 * 2.0 * STEP / r,
            "{offset}: {first} for {ideal}"
        );
        assert!((outputs.momentum(0) - before.0).length() < 1e-12);
        // The arms meet in one point, which wanders by a step's way: second order in H v / r.
        let energy = outputs.kinetic_energy(0) / before.1 - 1.0;
        assert!(
            energy.abs() < (2.0 * STEP / r).powi(2),
            "{offset}: {energy}"
        );
    }
}

/// Boxes that tumble into each other, with friction: both momenta are kept to rounding.
#[test]
fn collisions_keep_both_momenta() {
    let boxes = Shape::new(Geometry::Box {
        half: DVec3::new(0.1, 0.2, 0.05),
    });
    let start = [DVec3::new(-0.5, 0.07, 0.0), DVec3::new(0.0, 0.0, 0.02)];
    let mut sim = simulate::<f64>(two(boxes, [1.0, 2.0], Material::default(), start));
    set_velocities(
        &mut sim,
        &[2.0, 0.0, 0.0, 1.0, 3.0, -2.0, -1.0, 0.3, 0.0, 0.0, 4.0, 1.0],
    );
    let (p, l) = (sim.outputs().momentum(0), sim.outputs().angular_momentum(0));
    let mut touched = false;
    for _ in 0..500 {
        sim.step(1);
        let outputs = sim.outputs();
        touched |= outputs.contacts(0).any(|c| c.force.length() > 0.0);
        assert!((outputs.momentum(0) - p).length() < 1e-12);
        assert!((outputs.angular_momentum(0) - l).length() < 1e-12);
    }
    assert!(touched);
}

/// A body that spins about its middle axis tips over again and again: its spin along that axis of its
/// own changes sign, its momentum is kept to rounding, and its energy to second order in H.
#[test]
fn free_spin_keeps_momentum() {
    let brick = Shape::new(Geometry::Box {
        half: DVec3::new(0.1, 0.2, 0.05),
    });
    let far = [DVec3::ZERO, DVec3::X * 9.0];
    let mut sim = simulate::<f64>(two(brick, [1.0, 1.0], smooth(), far));
    let mut velocities = [0.0; 12];
    velocities[3..6].copy_from_slice(&[5.0, 0.01, 0.0]);
    set_velocities(&mut sim, &velocities);
    let (l, e) = (sim.outputs().angular_momentum(0), sim.outputs().energy(0));
    let mut tipped = false;
    for _ in 0..2500 {
        sim.step(1);
        let axis = sim.outputs().body_orientation(0, body()) * DVec3::X;
        tipped |= axis.x < -0.9;
        let outputs = sim.outputs();
        assert!((outputs.angular_momentum(0) - l).length() < 1e-11 * l.length());
        assert!((outputs.energy(0) - e).abs() < 5e-3 * e);
    }
    assert!(tipped);
}

/// A spring in N/m: a ball on it swings with ω = √(k/m), and sinks m g / k in the end.
#[test]
fn a_surface_in_newtons_per_metre_is_a_spring() {
    let (stiffness, mass) = (2000.0, 1.0);
    let material = Material {
        softness: Softness::Spring {
            stiffness,
            damping: 20.0,
        },
        combine: Combine::Average,
        ..smooth()
    };
    let ball = Shape::new(Geometry::Sphere { radius: 0.1 });
    let (model, _) = on_plane(ball, 0.1, 0.0, material);
    let mut parts = model.into_parts();
    parts.bodies[0].mass = mass;
    let mut sim = simulate::<f64>(Model::new(parts).unwrap());
    let sunk = |sim: &mut Simulation<f64>| 0.1 - sim.outputs().body_position(0, body()).y;
    // Half a swing later it is at its lowest: twice the depth of rest, less what the damper took.
    let half = std::f64::consts::PI / (stiffness / mass).sqrt();
    sim.step((half / STEP).round() as usize);
    let (deep, rest) = (sunk(&mut sim), mass * G / stiffness);
    let damped = 1.0 + (-10.0 * half / mass).exp();
    assert!(
        (deep / rest - damped).abs() < 0.05,
        "{} for {damped}",
        deep / rest
    );
    sim.step(2000);
    assert!((sunk(&mut sim) - rest).abs() < 1e-6 * rest);
}

/// Without a damper a spring gives back what it took: to first order in h ω, 3 % here.
#[test]
fn a_spring_gives_back_what_it_took() {
    let material = Material {
        softness: Softness::Spring {
            stiffness: 2000.0,
            damping: 0.0,
        },
        ..smooth()
    };
    let ball = Shape::new(Geometry::Sphere { radius: 0.1 });
    for phase in 0..5 {
        let height = 0.3 + 1e-3 * f64::from(phase);
        let (model, _) = on_plane(ball.clone(), height, 0.0, material);
        let mut sim = simulate::<f64>(model);
        let mut top = 0.0_f64;
        let mut fallen = false;
        for _ in 0..400 {
            sim.step(1);
            let (y, v) = {
                let outputs = sim.outputs();
                (
                    outputs.body_position(0, body()).y,
                    outputs.body_velocity(0, body()).y,
                )
            };
            fallen |= v > 0.0;
            if fallen {
                top = top.max(y - 0.1);
            }
        }
        let back = top / (height - 0.1);
        assert!(back > 0.9 && back < 1.0, "{back} of {height}");
    }
}

/// A bullet through paper: a ball of 2 cm at 100 m/s, and a sheet of 1 mm.
#[test]
fn a_bullet_hits_a_thin_wall() {
    let mut world = Builder::new("range");
    world.gravity(DVec3::ZERO);
    let wall = Geometry::Box {
        half: DVec3::new(0.0005, 1.0, 1.0),
    };
    world.object("wall").scenery(Shape::new(wall));
    world
        .object("bullet")
        .body("bullet")
        .at(Pose::at(DVec3::X * -1.03))
        .shape(Geometry::Sphere { radius: 0.01 });
    let mut sim = simulate::<f32>(world.build().unwrap());
    let mut velocities = [0.0; 6];
    velocities[0] = 100.0;
    set_velocities(&mut sim, &velocities);
    sim.step(20);
    let x = sim.outputs().body_position(0, body()).x;
    assert!(x < 0.0, "{x}");
}

/// Two cubes in one place come apart, slowly.
/// Balls of 5 cm in a row along x, the first at a speed: in a step it goes farther than any is thick.
fn struck(places: &[f64], wall: Option<f64>, speed: f64) -> Simulation<f32> {
    let mut world = Builder::new("row");
    world.gravity(DVec3::ZERO);
    if let Some(x) = wall {
        let half = DVec3::new(0.0005, 1.0, 1.0);
        let wall = Shape::new(Geometry::Box { half }).at(Pose::at(DVec3::X * x));
        world.object("wall").scenery(wall.with_material(smooth()));
    }
    let balls = world.object("balls");
    let elastic = Material {
        restitution: 1.0,
        ..smooth()
    };
    for (i, x) in places.iter().enumerate() {
        let ball = balls.body(format!("{i}")).at(Pose::at(DVec3::X * *x));
        ball.shape(Shape::new(Geometry::Sphere { radius: 0.05 }).with_material(elastic));
    }
    let mut sim = simulate::<f32>(world.build().unwrap());
    let mut velocities = vec![0.0; 6 * places.len()];
    velocities[0] = speed;
    set_velocities(&mut sim, &velocities);
    sim
}

/// A ball at rest is thrown at a thin wall by another that strikes it within the step: 40 cm a step, and the wall
/// is 3 cm away.
#[test]
fn what_is_struck_strikes_in_turn() {
    let mut sim = struck(&[-0.3, 0.0], Some(0.08), 200.0);
    for step in 0..20 {
        sim.step(1);
        for ball in [BodyId(0), BodyId(1)] {
            let x = sim.outputs().body_position(0, ball).x;
            assert!(x < 0.08, "step {step}: {ball:?} at {x} m");
        }
    }
}

/// A row of equal balls hands the first one's speed on to the last, though each gets far into the next one within the
/// step in which it is struck.
#[test]
fn a_row_of_balls_hands_a_speed_on() {
    const SPEED: f64 = 20.0;
    let mut sim = struck(&[-0.13, 0.0, 0.11, 0.22], None, SPEED);
    sim.step(8);
    let outputs = sim.outputs();
    let speeds: Vec<_> = (0..4)
        .map(|i| outputs.body_velocity(0, BodyId(i)).x)
        .collect();
    for (speed, expected) in speeds.iter().zip([0.0, 0.0, 0.0, SPEED]) {
        assert!((speed - expected).abs() < 0.02 * SPEED, "{speeds:?}");
    }
}

#[test]
fn a_deep_overlap_comes_apart_without_an_explosion() {
    let start = [DVec3::ZERO, DVec3::new(0.02, 0.01, 0.0)];
    let mut sim = simulate::<f32>(two(cube(), [1.0, 1.0], Material::default(), start));
    let mut fastest = 0.0_f64;
    for _ in 0..500 {
        sim.step(1);
        fastest = fastest.max(sim.outputs().body_velocity(0, body()).length());
    }
    let outputs = sim.outputs();
    let depth = outputs.contacts(0).map(|c| -c.distance).fold(0.0, f64::max);
    assert!(depth < 1e-3, "{depth}");
    assert!(fastest < 1.0, "{fastest} m/s");
}

/// A tower with sleep, and a way to see it: what sleeps has no speed at all.
fn sleeping_tower() -> Simulation<f32> {
    let mut settings = settings();
    settings.step.sleep_speed = 0.01;
    let mut sim = Simulation::new(model::examples::tower(4, 0.0).unwrap(), settings).unwrap();
    sim.step(600);
    assert!((0..4).all(|i| sim.outputs().body_velocity(0, BodyId(i)) == DVec3::ZERO));
    sim
}

#[test]
fn a_tower_sleeps_with_its_contacts_and_its_weight() {
    let mut sim = sleeping_tower();
    let before = sim.outputs().body_position(0, BodyId(3));
    let weight = sim.model().total_mass() * G;
    sim.step(500);
    let outputs = sim.outputs();
    assert_eq!(outputs.body_position(0, BodyId(3)), before);
    assert_eq!(outputs.contacts(0).count(), 16);
    let lowest = outputs.contacts(0).filter(|c| c.position.y < 0.01);
    let force: f64 = lowest.map(|c| c.force.y).sum();
    assert!(
        (force - weight).abs() < 0.01 * weight,
        "{force} of {weight}"
    );
    assert_eq!(sim.outputs().joint_acceleration(0), [0.0; 24]);
}

/// A force on the top box, however small, wakes all; this one lifts it.
#[test]
fn a_force_wakes_a_tower() {
    let mut sim = sleeping_tower();
    let top = BodyId(3);
    let weight = sim.model().bodies[3].mass * G;
    let up = sim
        .model()
        .dof_range(sim.model().carrier(top).unwrap())
        .start
        + 1;
    let start = sim.outputs().body_position(0, top);
    sim.controls().set_dof_force(0, up, 1.05 * weight).unwrap();
    sim.step(250);
    let risen = sim.outputs().body_position(0, top).y - start.y;
    let ideal = 0.5 * 0.05 * G * 0.25;
    assert!((risen - ideal).abs() < 0.02 * ideal, "{risen} for {ideal}");
}

/// What falls onto a sleeping tower wakes it.
#[test]
fn a_touch_wakes_a_tower() {
    let mut parts = model::examples::tower(4, 0.0).unwrap().into_parts();
    let mut last = parts.bodies[3].clone();
    last.name = "late".into();
    last.pose = Pose::at(DVec3::new(0.04, 6.0, 0.0));
    let mut shape = parts.shapes.last().unwrap().clone();
    shape.body = Some(BodyId(4));
    parts.bodies.push(last);
    parts.shapes.push(shape);
    let mut settings = settings();
    settings.step.sleep_speed = 0.01;
    let model = Model::new(parts).unwrap();
    let mut sim = Simulation::<f32>::new(model, settings).unwrap();
    sim.step(500);
    let top = BodyId(3);
    assert_eq!(sim.outputs().body_velocity(0, top), DVec3::ZERO);
    sim.step(80);
    assert!(sim.outputs().body_velocity(0, top).length() > 0.1);
}

/// Nothing sleeps that rests on nothing.
#[test]
fn what_drifts_slowly_goes_on_drifting() {
    let mut world = Builder::new("space");
    world.gravity(DVec3::ZERO);
    world.object("things").body("thing").shape(cube());
    let mut settings = settings();
    settings.step.sleep_speed = 0.01;
    let mut sim = Simulation::<f64>::new(world.build().unwrap(), settings).unwrap();
    set_velocities(&mut sim, &[1e-3, 0.0, 0.0, 0.0, 0.0, 0.0]);
    sim.step(5000);
    let x = sim.outputs().body_position(0, body()).x;
    assert!((x - 0.01).abs() < 1e-9, "{x}");
}

/// A world that diverges stops; its neighbours, which use the same workspace after it, do not notice.
#[test]
fn a_lost_world_harms_no_other() {
    let tower = || model::examples::tower(3, 0.01).unwrap();
    let mut alone = simulate::<f32>(tower());
    alone.step(100);
    let expected = alone.outputs().joint_position(0);

    let mut settings = settings();
    settings.worlds = 3;
    let mut sim = Simulation::<f32>::new(tower(), settings).unwrap();
    let position = sim.outputs().joint_position(1);
    let mut velocity = [0.0; 18];
    velocity[3] = 5e8;
    sim.set_joint_state(1, &position, &velocity).unwrap();
    let lost = sim.step(100).to_vec();
    assert_eq!(lost.iter().map(|d| d.world).collect::<Vec<_>>(), [1]);
    for world in [0, 2] {
        assert_eq!(
            sim.outputs().joint_position(world),
            expected,
            "world {world}"
        );
    }
    sim.reset(&[1]).unwrap();
    sim.step(100);
    assert_eq!(sim.outputs().joint_position(1), expected);
}

/// Two cubes whose pair keeps 5 cm apart, which neither would by itself.
#[test]
fn a_pair_keeps_its_margin() {
    let mut parts = model::examples::tower(2, 0.06).unwrap().into_parts();
    let id = |i: usize| model::ShapeId(parts.shapes.len() - 2 + i);
    let apart = Material {
        margin: 0.05,
        ..Material::default()
    };
    parts.contact_pairs = vec![model::ContactPair::new((id(0), id(1)), apart)];
    let mut sim = simulate::<f32>(Model::new(parts).unwrap());
    sim.step(500);
    let mut heights = [0.0; 2];
    for (i, y) in heights.iter_mut().enumerate() {
        *y = sim.outputs().body_position(0, BodyId(i)).y;
    }
    let gap = heights[1] - heights[0] - 0.1;
    assert!((gap - 0.05).abs() < 1e-4, "{gap}");
}

#[test]
fn nothing_at_all_is_simulated() {
    let mut world = Builder::new("ground");
    world.object("ground").scenery(Shape::new(PLANE));
    let mut sim = simulate::<f32>(world.build().unwrap());
    assert!(sim.step(10).is_empty());
    assert_eq!(sim.outputs().contacts(0).count(), 0);
}

#[test]
fn settings_without_sense_are_refused() {
    let mut settings = settings();
    settings.step.contact_iterations = 0;
    let model = || model::examples::tower(1, 0.0).unwrap();
    let error = Simulation::<f32>::new(model(), settings)
        .unwrap_err()
        .to_string();
    assert_eq!(
        error,
        "contact iterations is 0: it must be at least 1 with `impulse`"
    );
    settings.step.contact_iterations = 8;
    settings.step.integrator = Integrator::RungeKutta4;
    let error = Simulation::<f32>::new(model(), settings)
        .unwrap_err()
        .to_string();
    assert_eq!(
        error,
        "integrator is runge_kutta_4 with the solver impulse: it must be semi_implicit_euler, or the solver featherstone"
    );
    settings.step.integrator = Integrator::SemiImplicitEuler;
    settings.step.contact_passes = 0;
    let error = Simulation::<f32>::new(model(), settings)
        .unwrap_err()
        .to_string();
    assert_eq!(error, "contact passes is 0: it must be from 1 to 10000");
    settings.step.contact_passes = 2;
    settings.step.sleep_speed = f64::NAN;
    let error = Simulation::<f32>::new(model(), settings)
        .unwrap_err()
        .to_string();
    assert_eq!(
        error,
        "sleep speed is NaN: it must be from 0 to 1e9, in m/s"
    );
}

/// Smooth elastic balls of 5 cm in a row along x, so far apart; their velocities along x.
fn cradle<T: Float>(
    apart: f64,
    velocities: [f64; 5],
    settings: SimulationSettings,
) -> Simulation<T> {
    let material = Material {
        restitution: 1.0,
        ..smooth()
    };
    let mut world = Builder::new("cradle");
    world.gravity(DVec3::ZERO);
    let balls = world.object("balls");
    let mut x = 0.0;
    for (i, v) in velocities.into_iter().enumerate() {
        let ball = Shape::new(Geometry::Sphere { radius: 0.05 }).with_material(material);
        balls
            .body(format!("ball_{i}"))
            .at(Pose::at(DVec3::X * x))
            .shape(ball);
        let next = velocities.get(i + 1).copied().unwrap_or(v);
        x += 0.1 + if v == next { apart } else { 0.02 };
    }
    let mut sim = Simulation::new(world.build().unwrap(), settings).unwrap();
    let mut all = [0.0; 30];
    for (i, v) in velocities.into_iter().enumerate() {
        all[6 * i] = v;
    }
    set_velocities(&mut sim, &all);
    sim
}

fn velocities<T: Float>(sim: &mut Simulation<T>) -> Vec<DVec3> {
    let bodies = sim.model().bodies.len();
    let outputs = sim.outputs();
    (0..bodies)
        .map(|i| outputs.body_velocity(0, BodyId(i)))
        .collect()
}

/// Newton's cradle without strings, with gaps and without: as many balls as come from one side leave at the other.
///
/// Equal balls exchange their speeds whatever the order of blows, so that what is left is rounding.
#[test]
fn a_push_runs_through_a_row_of_balls() {
    for apart in [0.005, 1e-7, 0.0] {
        for count in 1..5 {
            let mut start = [0.0; 5];
            start[..count].fill(1.0);
            let mut sim = cradle::<f64>(apart, start, settings());
            sim.step(200);
            for (i, v) in velocities(&mut sim).into_iter().enumerate() {
                let ideal = if i + count < 5 { DVec3::ZERO } else { DVec3::X };
                assert!((v - ideal).length() < 1e-9, "{count} in, ball {i}: {v}");
            }
        }
    }
    // From both sides, and in lanes, scalars and threads alike.
    let runs = [(1, false), (1, true), (2, false)].map(|(threads, scalar)| {
        let settings = SimulationSettings {
            threads,
            scalar,
            ..settings()
        };
        let mut sim = cradle::<f32>(0.0, [1.0, 1.0, 0.0, 0.0, -1.0], settings);
        sim.step(100);
        velocities(&mut sim)
    });
    assert_eq!(runs[0], runs[1]);
    assert_eq!(runs[0], runs[2]);
    for (v, ideal) in runs[0].iter().zip([-1.0, 0.0, 0.0, 1.0, 1.0]) {
        assert!((v.x - ideal).abs() < 1e-5, "{:?}", runs[0]);
    }
}

/// A heavy ball strikes two light ones in a row: v₁ = (m − n)/(m + n) v and 2 m/(m + n) v, handed on to the last, and
/// again from what is left.
#[test]
fn unlike_balls_share_a_blow_by_their_masses() {
    let material = Material {
        restitution: 1.0,
        ..smooth()
    };
    let mut world = Builder::new("row");
    world.gravity(DVec3::ZERO);
    let balls = world.object("balls");
    for (i, (x, mass)) in [(-0.13, 3.0), (0.0, 1.0), (0.1, 1.0)]
        .into_iter()
        .enumerate()
    {
        let ball = Shape::new(Geometry::Sphere { radius: 0.05 }).with_material(material);
        let body = balls.body(format!("{i}")).at(Pose::at(DVec3::X * x));
        body.shape(ball).mass(mass);
    }
    let mut sim = simulate::<f64>(world.build().unwrap());
    let mut start = [0.0; 18];
    start[0] = 1.0;
    set_velocities(&mut sim, &start);
    sim.step(100);
    for (v, ideal) in velocities(&mut sim).iter().zip([0.25, 0.75, 1.5]) {
        assert!((v - ideal * DVec3::X).length() < 1e-9, "{v} for {ideal}");
    }
}

/// Balls and boxes that touch each other at random are struck by one more: momentum stays, energy never grows, and of
/// elastic smooth balls not much is lost where nothing approaches any more.
#[test]
fn clusters_that_are_struck_gain_no_energy() {
    for e in [0.0, 0.5, 1.0] {
        for (seed, friction) in [(1, 0.0), (2, 0.0), (3, 0.5), (4, 0.5)] {
            let mut random = fastrand::Rng::with_seed(seed);
            let material = Material {
                restitution: e,
                friction,
                ..Material::default()
            };
            let mut world = Builder::new("cluster");
            world.gravity(DVec3::ZERO);
            let things = world.object("things");
            for i in 0..27 {
                let cell = DVec3::new((i % 3) as f64, (i / 3 % 3) as f64, (i / 9) as f64);
                let shape = if friction > 0.0 && random.bool() {
                    Geometry::Box {
                        half: DVec3::splat(0.05),
                    }
                } else {
                    Geometry::Sphere { radius: 0.05 }
                };
                let body = things.body(format!("{i}")).at(Pose::at(0.1 * cell));
                body.shape(Shape::new(shape).with_material(material))
                    .mass(0.5 + random.f64());
            }
            let bullet = things
                .body("bullet")
                .at(Pose::at(DVec3::new(-0.2, 0.12, 0.09)));
            let ball = Shape::new(Geometry::Sphere { radius: 0.05 });
            bullet.shape(ball.with_material(material)).mass(2.0);
            let mut sim = simulate::<f64>(world.build().unwrap());
            let mut start = vec![0.0; 6 * 28];
            start[6 * 27] = 5.0;
            set_velocities(&mut sim, &start);
            let (first, momentum) = (sim.outputs().kinetic_energy(0), sim.outputs().momentum(0));
            let mut last = first;
            for step in 0..200 {
                sim.step(1);
                let energy = sim.outputs().kinetic_energy(0);
                let what = format!("e = {e}, seed {seed}, step {step}: {energy} J of {last} J");
                // Warm starts that are not settled yet, and of boxes the spin, which is of second order in H ω.
                let order = if friction > 0.0 { 1e-4 } else { 1e-9 };
                assert!(energy <= last + order * first, "{what}");
                assert!((sim.outputs().momentum(0) - momentum).length() < 1e-10);
                last = energy;
            }
            assert!(last > 0.05 * first, "e = {e}: {last} of {first}");
            if e == 1.0 && friction == 0.0 {
                assert!(last > 0.9 * first, "{last} of {first}");
            }
        }
    }
}

/// What falls flat stays flat: a plate of elastic corners rises as it fell, and does not turn.
#[test]
fn a_plate_bounces_flat() {
    let material = Material {
        restitution: 1.0,
        ..smooth()
    };
    let plate = Shape::new(Geometry::Box {
        half: DVec3::new(0.3, 0.02, 0.2),
    });
    let (model, _) = on_plane(plate, 0.52, 0.0, material);
    let mut sim = simulate::<f64>(model);
    let mut top = 0.0_f64;
    for step in 0..800 {
        sim.step(1);
        let outputs = sim.outputs();
        let turned = outputs.body_angular_velocity(0, body()).length();
        assert!(turned < 1e-6, "step {step}: {turned} rad/s");
        if step > 200 {
            top = top.max(outputs.body_position(0, body()).y - 0.02);
        }
    }
    assert!((top - 0.5).abs() < G * STEP * STEP, "{top}");
}

/// Steps a world, whose energy never exceeds what it began with, by more than a part in a thousand.
fn never_gains(mut sim: Simulation<f64>, steps: usize) {
    let lowest = sim.outputs().potential_energy(0);
    let start = sim.outputs().energy(0);
    for step in 0..steps {
        sim.step(1);
        let energy = sim.outputs().energy(0);
        let most = start + 1e-3 * (start - lowest).abs();
        assert!(energy <= most, "step {step}: {energy} J of {start} J");
    }
    assert!(sim.diverged().is_empty());
}

/// A coin on its edge, leaning, spins and rolls round.
#[test]
fn a_spinning_coin_gains_no_energy() {
    let coin = Shape::new(Geometry::Cylinder {
        radius: 0.05,
        half_height: 0.002,
    });
    let (model, _) = on_plane(coin, 0.06, 0.0, Material::default());
    let mut sim = simulate::<f64>(model);
    // Its axis nearly level: x of the coin's frame up, by a turn of 85° about z.
    let q = DQuat::from_rotation_z(85_f64.to_radians());
    let position = [0.0, 0.051, 0.0, q.x, q.y, q.z, q.w];
    let up = q.inverse() * DVec3::Y * 20.0;
    sim.set_joint_state(0, &position, &[0.0, 0.0, 0.0, up.x, up.y, up.z])
        .unwrap();
    never_gains(sim, 5000);
}

/// A rod that spins at 100 rad/s flies into a wall: it comes back, with no more energy, and no part of it
/// is ever deep in the wall.
#[test]
fn a_spinning_rod_does_not_pass_a_wall() {
    let mut world = Builder::new("rod");
    world.gravity(DVec3::ZERO);
    let wall = Geometry::Box {
        half: DVec3::new(0.05, 2.0, 2.0),
    };
    world
        .object("wall")
        .scenery(Shape::new(wall).at(Pose::at(DVec3::X * 0.55)));
    let rod = Geometry::Capsule {
        radius: 0.02,
        half_height: 0.3,
    };
    world.object("rod").body("rod").shape(rod);
    let mut sim = simulate::<f64>(world.build().unwrap());
    set_velocities(&mut sim, &[10.0, 0.0, 0.0, 0.0, 0.0, 100.0]);
    let start = sim.outputs().energy(0);
    for _ in 0..200 {
        sim.step(1);
        let outputs = sim.outputs();
        let pose = outputs.body_pose(0, body());
        let tip = pose.position.x + 0.28 * (pose.orientation * DVec3::Y).x.abs() + 0.02;
        assert!(tip < 0.52, "{tip}");
        assert!(outputs.energy(0) < 1.02 * start);
    }
    assert!(sim.outputs().body_velocity(0, body()).x < 0.0);
}

/// A ball of any mass that hits a wall askew leaves as it came: momentum is rounded with what the ball has of it.
#[test]
fn heavy_things_bounce_as_light_ones_do() {
    let material = Material {
        restitution: 1.0,
        ..smooth()
    };
    for mass in [1e-3, 1.0, 1e6, 1e10] {
        let ball = Shape::new(Geometry::Sphere { radius: 0.1 }).with_material(material);
        let mut world = Builder::new("heavy");
        world.gravity(DVec3::ZERO);
        let lean = Pose::new(DVec3::ZERO, DQuat::from_rotation_z(0.3));
        let wall = Shape::new(PLANE).with_material(material).at(lean);
        world.object("wall").scenery(wall);
        let at = lean * Pose::at(DVec3::Y * 0.15);
        world
            .object("balls")
            .body("ball")
            .at(at)
            .shape(ball)
            .mass(mass);
        let mut sim = simulate::<f32>(world.build().unwrap());
        let normal = lean.direction(DVec3::Y);
        let speed = DVec3::new(4.0, -10.0, 3.0);
        let position = sim.outputs().joint_position(0);
        let velocity = [speed.x, speed.y, speed.z, 0.0, 0.0, 0.0];
        sim.set_joint_state(0, &position, &velocity).unwrap();
        sim.step(100);
        let ideal = speed - 2.0 * normal * normal.dot(speed);
        let now = sim.outputs().body_velocity(0, body());
        assert!(
            (now - ideal).length() < 1e-4,
            "{mass} kg: {now} for {ideal}"
        );
    }
}

/// What lands with 1.2 g H is at rest for it, whatever else of the world spins so fast that steps are cut.
#[test]
fn what_spins_elsewhere_changes_no_bounce() {
    let material = Material {
        restitution: 0.9,
        ..smooth()
    };
    for spin in [0.0, 1000.0] {
        let ball = Shape::new(Geometry::Sphere { radius: 0.1 }).with_material(material);
        let mut world = Builder::new("rotor");
        world.gravity(DVec3::NEG_Y * G);
        world
            .object("ground")
            .scenery(Shape::new(PLANE).with_material(material));
        let object = world.object("object");
        let at = Pose::at(DVec3::Y * 0.1);
        object.body("ball").at(at).shape(ball);
        let at = Pose::at(DVec3::new(5.0, 5.0, 0.0));
        object.body("rotor").at(at).shape(cube());
        let mut sim = simulate::<f64>(world.build().unwrap());
        let position = sim.outputs().joint_position(0);
        let mut velocity = [0.0; 12];
        (velocity[1], velocity[11]) = (-1.2 * G * STEP, spin);
        sim.set_joint_state(0, &position, &velocity).unwrap();
        let mut highest = 0.0_f64;
        for _ in 0..20 {
            sim.step(1);
            highest = highest.max(sim.outputs().body_velocity(0, body()).y);
        }
        assert!(
            highest < 0.1 * G * STEP,
            "{spin} rad/s elsewhere: {highest} m/s"
        );
    }
}
