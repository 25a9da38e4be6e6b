//! Contacts of reduced coordinates with what does not move, against closed forms.

use crate::ground::{cube, on_plane, plane, soft_landings, surface};
use crate::run;
use glam::{DMat3, DQuat, DVec3};
use kinetarium_rigid::{
    Settings, TouchingFeatherstone, body as of_body, contact as of_contact,
    reaction as of_reaction, total as of_total,
};
use model::{Builder, Geometry, Material, Model, Object, Pose, Shape, Softness};

/// Gravity of the models [m/s²].
const G: f64 = 9.81;
/// Step [s].
const H: f64 = 0.002;

type Run = run::Run<TouchingFeatherstone>;

impl Run {
    fn new(model: &Model, velocity: &[f64], settings: &Settings) -> Self {
        let kernels = TouchingFeatherstone::new(model, settings).unwrap();
        Self::of(kernels, model, velocity)
    }
    /// Force [N] and torque [N·m] of a joint on its child.
    fn reaction(&self, joint: usize) -> [DVec3; 2] {
        let row = self.tables.reaction.at(joint, 0);
        [
            self.vec3(row + of_reaction::FORCE),
            self.vec3(row + of_reaction::TORQUE),
        ]
    }
    /// Sum of the contact forces [N], and the deepest penetration [m].
    fn contacts(&self) -> (DVec3, f64) {
        let row = |slot| self.tables.contact.at(slot, 0);
        (0..self.tables.contacts).fold((DVec3::ZERO, 0.0), |(force, depth), slot| {
            let distance = self.world.output[row(slot) + of_contact::DISTANCE];
            let f = self.vec3(row(slot) + of_contact::FORCE);
            (force + f, f64::max(depth, -distance))
        })
    }
}

#[test]
fn a_soft_landing_follows_its_law_from_the_first_step() {
    for landing in soft_landings() {
        let mut run = Run::new(
            &landing.model,
            &landing.velocity,
            &Settings::new(landing.step),
        );
        run.step(landing.steps);
        let error = run.position().y - landing.height;
        assert!(error.abs() < landing.error, "{}: {error}", landing.name);
    }
}

/// A surface whose added mass is as much as rests on it, and a time constant [s].
fn heavy_surface(constant: f64) -> Material {
    let softness = Softness::Time {
        constant,
        ratio: 1.0,
        impedance: 0.5,
        mass: None,
    };
    Material {
        softness,
        ..surface(1.0, 0.0)
    }
}

/// What rolls is borne at the height at which it rests, as its contacts go along with its axis. Where they stand still, or
/// go along with the surface, m' feels ω² R too much, which is 92 times g.
#[test]
fn what_rolls_on_added_mass_does_not_sink_in() {
    let (radius, constant, turn) = (0.1, 0.02, 95.0);
    let half_height = 0.05;
    let solids = [
        Geometry::Sphere { radius },
        Geometry::Capsule {
            radius,
            half_height: 0.2,
        },
        Geometry::Cylinder {
            radius,
            half_height,
        },
        Geometry::Ellipsoid {
            half: DVec3::new(radius, 0.2, radius),
        },
    ];
    for solid in solids {
        let mut world = Builder::new("rolls");
        let material = heavy_surface(constant);
        world
            .object("ground")
            .scenery(Shape::new(plane()).with_material(material));
        let side = Pose::new(
            DVec3::ZERO,
            DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2),
        );
        let shape = Shape::new(solid.clone()).at(side).with_material(material);
        let body = world.object("").body("body");
        body.at(Pose::at(radius * DVec3::Y)).shape(shape);
        let model = world.build().unwrap();
        let [rests, rolls] = [0.0, turn].map(|turn| {
            let velocity = [radius * turn, 0.0, 0.0, 0.0, 0.0, -turn];
            let mut run = Run::new(&model, &velocity, &Settings::new(5e-4));
            run.step(400);
            run.position().y
        });
        let sag = radius - rests;
        assert!(sag > 0.0, "{solid:?}");
        assert!(
            (rests - rolls).abs() < 0.01 * sag,
            "{solid:?}: {rests} {rolls}"
        );
    }
}

/// So are wheels on hinges, and a ball in its socket, of a carriage that only slides; also where the model names what they
/// touch, and they touch nothing else.
#[test]
fn wheels_on_added_mass_do_not_sink_in() {
    let (radius, constant, turn) = (0.1, 0.02, 95.0);
    let side = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let half_height = 0.05;
    for (solid, in_socket, named) in [
        (
            Geometry::Cylinder {
                radius,
                half_height,
            },
            false,
            false,
        ),
        (
            Geometry::Capsule {
                radius,
                half_height: 0.2,
            },
            false,
            true,
        ),
        (Geometry::Sphere { radius }, false, false),
        (Geometry::Sphere { radius }, true, false),
    ] {
        let mut world = Builder::new("rolls");
        let material = heavy_surface(constant);
        let ground = world.object("ground");
        ground.scenery(Shape::new(plane()).with_material(material));
        let floor = ground.id().scenery(0);
        let object = world.object("cart");
        let frame = |object: &mut Object, name: &str, mass| {
            let body = object.body(name);
            body.at(Pose::at(radius * DVec3::Y));
            body.inertia(mass, DVec3::ZERO, DMat3::IDENTITY * 0.01 * mass);
            body.handle()
        };
        let carriage = frame(object, "carriage", 0.5);
        let lift = frame(object, "lift", 3.0);
        let shape = Shape::new(solid.clone()).at(Pose::new(DVec3::ZERO, side));
        let shape = if named {
            shape.without_contact()
        } else {
            shape
        };
        let wheel = object.body("wheel");
        wheel.at(Pose::at(radius * DVec3::Y));
        let wheel = wheel.shape(shape.with_material(material)).handle();
        object.prismatic("along", carriage, DVec3::X);
        object.prismatic("up", lift, DVec3::Y).parent(carriage);
        let at = Pose::at(radius * DVec3::Y);
        let hinge = if in_socket {
            object.ball("axle", wheel)
        } else {
            object.revolute("axle", wheel, DVec3::Z)
        };
        hinge.parent(lift).at(at);
        if named {
            world.contact_pair(wheel.shape(0), floor).unwrap();
        }
        let model = world.build().unwrap();
        let [rests, rolls] = [0.0, turn].map(|turn| {
            let mut velocity = vec![0.0; model.degrees_of_freedom()];
            velocity[0] = radius * turn;
            velocity[model.degrees_of_freedom() - 1] = -turn;
            let mut run = Run::new(&model, &velocity, &Settings::new(5e-4));
            run.step(400);
            run.body(2, of_body::POSITION).y
        });
        let sag = radius - rests;
        assert!(sag > 1e-4, "{solid:?}: {sag}");
        assert!(
            (rests - rolls).abs() < 0.01 * sag,
            "{solid:?}: {rests} {rolls}"
        );
    }
}

/// A box that tips over an edge is a pendulum on a spring. With θ its turn from where its centre is above the edge at a
/// distance r, x the height of the edge, which sticks, I its moment about the edge, and M = m + m':
///
/// ```text
/// I θ̈ = m r sin θ (ẍ + g)
/// M ẍ = −k x − d ẋ − m g + m r (θ̈ sin θ + θ̇² cos θ)
/// ```
///
/// Were m' to feel the centre's acceleration θ̇² r, x would be off by m' θ̇² r / k = T² θ̇² r / 2. Steps of length h go on with
/// the velocity at their end, and leave the arc by h θ̇² r / 2 a second, which the damper holds with 2 T of that, T h θ̇² r.
#[test]
fn a_box_that_pivots_on_added_mass_does_not_feel_its_centre_turn() {
    let (half, constant, turn, end) = (0.1, 0.02, 5.0, 0.06);
    let material = heavy_surface(constant);
    let r = half * std::f64::consts::SQRT_2;
    let geometry = Geometry::Box {
        half: DVec3::splat(half),
    };
    let m = on_plane(geometry.clone(), material, DVec3::Y, 0.0).bodies[0].mass;
    // Both corners of the edge bear the box, each as if alone.
    let [k, d] = <[f64; 2]>::from(material.softness.spring(m)).map(|x| 2.0 * x);
    let added = 2.0 * material.softness.added_mass(m);
    let about_edge = m * half * half * (2.0 / 3.0 + 2.0);
    let depth = m * (G - turn * turn * r) / k;

    let rates = |[x, v, angle, turn]: [f64; 4]| {
        let (s, c) = angle.sin_cos();
        let lever = m * r * s;
        let inertia = m + added - lever * lever / about_edge;
        let force = -k * x - d * v - m * G + m * r * turn * turn * c;
        let a = (force + lever * lever * G / about_edge) / inertia;
        [v, a, turn, lever * (a + G) / about_edge]
    };
    let (mut state, n) = ([-depth, 0.0, 0.0, turn], 6000);
    let dt = end / f64::from(n);
    for _ in 0..n {
        let ahead = |rate: [f64; 4], h: f64| std::array::from_fn(|i| state[i] + h * rate[i]);
        let a = rates(state);
        let b = rates(ahead(a, 0.5 * dt));
        let c = rates(ahead(b, 0.5 * dt));
        let e = rates(ahead(c, dt));
        let sum = std::array::from_fn(|i| (a[i] + 2.0 * b[i] + 2.0 * c[i] + e[i]) / 6.0);
        state = ahead(sum, dt);
    }
    let [x, ..] = state;

    for h in [1e-3, 5e-4, 1e-4] {
        let mut world = Builder::new("pivots");
        world
            .object("ground")
            .scenery(Shape::new(plane()).with_material(material));
        let tilt = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_4);
        let shape = Shape::new(geometry.clone()).with_material(material);
        let body = world.object("").body("body");
        body.at(Pose::new((r - depth) * DVec3::Y, tilt))
            .shape(shape);
        let model = world.build().unwrap();
        let mut run = Run::new(
            &model,
            &[turn * r, 0.0, 0.0, 0.0, 0.0, -turn],
            &Settings::new(h),
        );
        run.step((end / h).round() as usize);
        let error = -run.contacts().1 - x;
        let late = constant * h * turn * turn * r;
        assert!(error.abs() < late, "{h}: {error} of {depth}");
    }
}

/// A resting body is borne by contact forces that sum to its weight.
#[test]
fn a_resting_body_weighs_what_it_weighs() {
    let solids = [
        (cube(), 0.05),
        (Geometry::Sphere { radius: 0.1 }, 0.1),
        (
            Geometry::Cylinder {
                radius: 0.1,
                half_height: 0.05,
            },
            0.05,
        ),
    ];
    for (solid, height) in solids {
        let model = on_plane(solid, surface(0.6, 0.0), DVec3::Y * height, 0.0);
        let weight = model.bodies[0].mass * G;
        let mut run = Run::new(&model, &[0.0; 6], &Settings::new(H));
        run.step(1000);
        let (force, depth) = run.contacts();
        assert!(
            (force - DVec3::Y * weight).length() < 1e-6 * weight,
            "{force}"
        );
        assert!(run.velocity().length() < 1e-9, "{}", run.velocity());
        // k φ = m g / n with k = m / T²: φ = g T² / n
        assert!(depth < G * 0.002 * 0.002 * 1.001, "{depth}");
    }
}

/// Below tan θ = μ a block sticks, above it slides with g (sin θ − μ cos θ).
#[test]
fn a_block_on_an_incline_sticks_or_slides() {
    let theta = 0.4_f64;
    for share in [0.5, 0.9, 1.1, 1.5] {
        let friction = theta.tan() / share;
        let model = on_plane(cube(), surface(friction, 0.0), DVec3::Y * 0.0495, theta);
        let mut run = Run::new(&model, &[0.0; 6], &Settings::new(H));
        run.step(100);
        let (from, speed) = (run.position(), run.velocity().length());
        run.step(500);
        let (time, way) = (500.0 * H, (run.position() - from).length());
        if share < 1.0 {
            // fₜ / cₜ = g sin θ h / 300
            let creep = G * theta.sin() * H / 300.0;
            assert!(way < 1.5 * creep * time, "{share}: {way}");
        } else {
            let a = G * (theta.sin() - friction * theta.cos());
            let expected = speed * time + 0.5 * a * time * time;
            // The cone is settled to 2 % of the friction, which is nearly as large as the pull.
            let tolerance = 0.02 * share.recip() / (1.0 - share.recip());
            assert!(
                (way / expected - 1.0).abs() < tolerance,
                "{share}: {way} {expected}"
            );
        }
    }
}

/// A block that slides at v stops after v² / (2 μ g).
#[test]
fn a_sliding_block_stops_where_it_should() {
    let (v, friction) = (3.0, 0.8);
    let model = on_plane(cube(), surface(friction, 0.0), DVec3::Y * 0.0495, 0.0);
    let direction = DVec3::new(0.6, 0.0, 0.8);
    let u = direction * v;
    let mut run = Run::new(&model, &[u.x, u.y, u.z, 0.0, 0.0, 0.0], &Settings::new(H));
    let from = run_start(&mut run);
    run.step(600);
    let way = run.position() - from;
    let expected = v * v / (2.0 * friction * G);
    // A step's share: the first step's speed lasts for h/2 more or less.
    assert!(
        (way.dot(direction) - expected).abs() < v * H + 0.01 * expected,
        "{way} {expected}"
    );
    assert!(way.cross(direction).y.abs() < 1e-3 * expected, "{way}");
}

fn run_start(run: &mut Run) -> DVec3 {
    run.step(0);
    run.position()
}

/// Each bounce reaches e² of the height before, and never more. An impedance of N m / h instead of a rigid one takes
/// (w + v)/N of the speed v, which is 2 (1 + 1/e)/N of the height.
///
/// Without restitution the ball lands on the surface's spring and damper. A critically damped one,
/// x = v t exp(−ω t), lets go where its force ends, at t = 2/ω, with exp(−2) of the speed.
#[test]
fn a_ball_bounces_to_e_squared_of_its_height() {
    /// N.
    const HARD: f64 = 1e4;
    for e in [0.0, 0.25, 0.5, 0.75, 0.9, 1.0] {
        let radius = 0.1;
        let (drop, h) = (1.0, 0.002);
        let ball = Geometry::Sphere { radius };
        let model = on_plane(ball, surface(0.3, e), DVec3::Y * (radius + drop), 0.0);
        let mut run = Run::new(&model, &[0.0; 6], &Settings::new(h));
        run.step(0);
        let (mut energy, mut before, mut peak) = (run.energy(), drop, 0.0_f64);
        let mut bounces = 0;
        for _ in 0..20_000 {
            run.step(1);
            let (height, speed) = (run.position().y - radius, run.velocity().y);
            if speed > 0.0 {
                peak = peak.max(height);
            } else if peak > 0.0 {
                bounces += 1;
                let ideal = e * e * before;
                let lost = 2.0 * (e * e + e) / HARD * before;
                // What is seen misses the top by up to half of a step.
                let missed = G * h * h / 8.0;
                let landing = if e == 0.0 {
                    (-4.0_f64).exp() * drop
                } else {
                    1e-9
                };
                let range = ideal - lost - missed * (1.0 + e * e)..ideal + missed + landing;
                assert!(range.contains(&peak), "{e}: {peak} in {range:?}");
                let most = energy + model.total_mass() * G * missed;
                assert!(run.energy() < most, "{e}: {}", run.energy());
                (energy, before, peak) = (run.energy(), peak, 0.0);
            }
            // Lower than 2 g h (1 − e²)/e² comes it goes down first, and loses more.
            let slow = 2.0 * G * h * (1.0 / (e * e) - 1.0).max(1.0);
            if bounces == 10 || before < slow * slow / (2.0 * G) || before < 1e-2 {
                break;
            }
        }
        assert!(e < 0.5 || bounces >= 3, "{e}: {bounces}");
    }
}

/// What rolls without slipping down an incline accelerates by g sin θ / (1 + I / (m r²)).
#[test]
fn a_ball_and_a_cylinder_roll_down_an_incline() {
    let (theta, radius) = (0.3_f64, 0.1);
    let upright = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
    for (geometry, share) in [
        (Geometry::Sphere { radius }, 5.0 / 7.0),
        (
            Geometry::Cylinder {
                radius,
                half_height: 0.1,
            },
            2.0 / 3.0,
        ),
    ] {
        let mut world = Builder::new("incline");
        let tilt = DQuat::from_rotation_z(theta);
        let material = surface(0.8, 0.0);
        let ground = Shape::new(plane())
            .at(Pose::new(DVec3::ZERO, tilt))
            .with_material(material);
        world.object("ground").scenery(ground);
        let shape = Shape::new(geometry)
            .at(Pose::new(DVec3::ZERO, upright))
            .with_material(material);
        world
            .object("")
            .body("roller")
            .at(Pose::new(tilt * DVec3::Y * (radius - 0.001), tilt))
            .shape(shape);
        let model = world.build().unwrap();
        let mut run = Run::new(&model, &[0.0; 6], &Settings::new(H));
        run.step(100);
        let start = run.velocity();
        run.step(400);
        let a = (run.velocity() - start).length() / (400.0 * H);
        let expected = share * G * theta.sin();
        assert!((a / expected - 1.0).abs() < 0.01, "{a} {expected}");
        let slip = run.velocity().length() - run.spin().length() * radius;
        assert!(slip.abs() < 0.01 * run.velocity().length(), "{slip}");
    }
}

/// Two free balls on a line meet at any offset: momentum is kept, and energy where nothing is lost.
#[test]
fn free_balls_collide() {
    let (radius, speed, h) = (0.1, 2.0, 0.0005);
    for (e, offset) in [(1.0, 0.0), (1.0, 0.1), (0.5, 0.0), (0.5, 0.12), (0.0, 0.05)] {
        let material = surface(0.0, e);
        let mut world = Builder::new("balls");
        world.gravity(DVec3::ZERO);
        let object = world.object("");
        for (name, x, y) in [("a", -0.4, 0.0), ("b", 0.0, offset)] {
            object
                .body(name)
                .at(Pose::at(DVec3::new(x, y, 0.0)))
                .shape(Shape::new(Geometry::Sphere { radius }).with_material(material));
        }
        let model = world.build().unwrap();
        let mut velocity = [0.0; 12];
        velocity[0] = speed;
        let mut run = Run::new(&model, &velocity, &Settings::new(h));
        run.step(0);
        let total = |run: &Run, field| run.vec3(run.tables.total.at(0, field));
        let before = (
            total(&run, of_total::MOMENTUM),
            total(&run, of_total::ANGULAR_MOMENTUM),
            run.energy(),
        );
        run.step(400);
        let m = model.bodies[0].mass;
        let tiny = 1e-12 * m * speed;
        assert!((total(&run, of_total::MOMENTUM) - before.0).length() < tiny);
        let turn = total(&run, of_total::ANGULAR_MOMENTUM) - before.1;
        assert!(turn.length() < tiny, "{turn}");
        // Along the line of centres the relative speed turns round to e of itself; the rest stays.
        let sine: f64 = offset / (2.0 * radius);
        let cosine = (1.0 - sine * sine).sqrt();
        let lost = 0.25 * m * (speed * cosine).powi(2) * (1.0 - e * e);
        let energy = before.2 - lost;
        // The balls are met up to a step's way early, where the line of centres is turned a little.
        let tolerance = 2.0 * speed * h / radius * before.2 + 1e-3 * before.2;
        assert!(
            (run.energy() - energy).abs() < tolerance,
            "{e} {offset}: {} {energy}",
            run.energy()
        );
        if e == 1.0 {
            assert!(run.energy() <= before.2 * (1.0 + 1e-9));
        }
    }
}

/// A box on a box on the ground: each contact bears what stands on it.
#[test]
fn stacked_boxes_bear_their_weights() {
    let mut world = Builder::new("stack");
    world.object("ground").scenery(Shape::new(plane()));
    let half = DVec3::splat(0.05);
    let object = world.object("");
    for i in 0..3 {
        object
            .body(format!("box_{i}"))
            .at(Pose::at(DVec3::Y * (0.05 + 0.1 * f64::from(i))))
            .shape(Geometry::Box { half });
    }
    let model = world.build().unwrap();
    let mut run = Run::new(&model, &[0.0; 18], &Settings::new(H));
    run.step(2000);
    let weight = model.bodies[0].mass * G;
    let mut ground = 0.0;
    let mut first = 0.0;
    for slot in 0..run.tables.contacts {
        let row = run.tables.contact.at(slot, 0);
        let force = run.vec3(row + of_contact::FORCE);
        let height = run.world.output[row + of_contact::POSITION + 1];
        if height < 0.01 {
            ground += force.y;
        } else if height < 0.11 {
            first += force.y.abs();
        }
    }
    assert!((ground / weight - 3.0).abs() < 1e-2, "{}", ground / weight);
    assert!((first / weight - 2.0).abs() < 1e-2, "{}", first / weight);
    for i in 0..3 {
        let at = run.vec3(run.tables.body.at(i, of_body::POSITION));
        let from = DVec3::Y * (0.05 + 0.1 * i as f64);
        assert!((at - from).length() < 1e-3, "{i}: {at}");
    }
}

/// A joint carries what the contacts do not: nothing where a body rests freely, half of each weight
/// where two rods of length l, hinged to each other, lie on balls at their far ends.
#[test]
fn joints_carry_what_contacts_do_not() {
    let mut world = Builder::new("lying");
    world.object("ground").scenery(Shape::new(plane()));
    let rods = world.object("rods");
    let (radius, half, mass) = (0.05, 0.5, 2.0);
    let mut rod = |name: &str, side: f64| {
        let foot = Shape::new(Geometry::Sphere { radius });
        let foot = foot.at(Pose::at(DVec3::X * (side * half)));
        let inertia = glam::DMat3::from_diagonal(DVec3::new(0.01, 0.2, 0.2));
        rods.body(name)
            .shape(foot)
            .inertia(mass, DVec3::ZERO, inertia)
            .handle()
    };
    let (left, right) = (rod("left", -1.0), rod("right", 1.0));
    rods.free("float", left)
        .initial(&[-half, radius, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let at = |x: f64| Pose::at(DVec3::X * x);
    rods.revolute("hinge", right, DVec3::Y)
        .parent(left)
        .frames(at(half), at(-half));
    let model = world.build().unwrap();
    let mut run = Run::new(&model, &[0.0; 7], &Settings::new(H));
    run.step(1000);
    let weight = mass * G;
    let [force, torque] = run.reaction(0);
    assert!(force.length() < 1e-6 * weight, "{force}");
    assert!(torque.length() < 1e-6 * weight, "{torque}");
    let (pressing, _) = run.contacts();
    assert!(
        (pressing - DVec3::Y * 2.0 * weight).length() < 1e-4 * weight,
        "{pressing}"
    );
    // The hinge holds against bending; by symmetry no force passes through it.
    let [force, torque] = run.reaction(1);
    assert!(force.length() < 1e-3 * weight, "{force}");
    assert!(
        (torque.length() - half * weight).abs() < 1e-3 * weight,
        "{torque}"
    );
}
