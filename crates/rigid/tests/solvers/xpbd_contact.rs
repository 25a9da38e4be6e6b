//! Contacts of position-based dynamics, against closed forms.

use crate::ground::{cube, on_plane, plane, soft_landings, surface};
use crate::run;
use glam::{DQuat, DVec3};
use kinetarium_rigid::{
    Kernels, Settings, Xpbd, body as of_body, contact as of_contact, total as of_total,
};
use model::{Builder, Combine, Geometry, Material, Model, Pose, Shape, Softness};

/// Gravity of the models [m/s²].
const G: f64 = 9.81;
/// Substep [s].
const H: f64 = 0.001;

type Run = run::Run<Xpbd>;

impl Run {
    fn new(model: &Model, velocity: &[f64], h: f64) -> Self {
        Self::with(model, velocity, &Settings::new(h))
    }
    fn with(model: &Model, velocity: &[f64], settings: &Settings) -> Self {
        let kernels = Xpbd::touching(model, settings).unwrap();
        let mut run = Self::of(kernels, model, velocity);
        run.step(0);
        run
    }
    fn at_rest(model: &Model) -> Self {
        Self::new(model, &vec![0.0; model.degrees_of_freedom()], H)
    }
    /// Lets the first of the bodies go on from where it is, turned to the world's axes, with this
    /// velocity and spin.
    fn go(&mut self, velocity: DVec3, spin: DVec3) {
        let position = self.position();
        let q = [&position.to_array()[..], &[0.0, 0.0, 0.0, 1.0]].concat();
        let v = [velocity.to_array(), spin.to_array()].concat();
        self.kernels.place(&q, &v, &mut self.world.state);
    }
    fn total(&self, field: usize) -> DVec3 {
        self.vec3(self.tables.total.at(0, field))
    }
    /// Position, distance and force of each contact.
    fn contacts(&self) -> impl Iterator<Item = (DVec3, f64, DVec3)> {
        (0..self.tables.contacts).map(|slot| {
            let row = self.tables.contact.at(slot, 0);
            let distance = self.world.output[row + of_contact::DISTANCE];
            let position = self.vec3(row + of_contact::POSITION);
            (position, distance, self.vec3(row + of_contact::FORCE))
        })
    }
}

#[test]
fn a_soft_landing_follows_its_law_from_the_first_substep() {
    for landing in soft_landings() {
        let mut run = Run::new(&landing.model, &landing.velocity, landing.step);
        run.step(landing.steps);
        let error = run.position().y - landing.height;
        assert!(error.abs() < landing.error, "{}: {error}", landing.name);
    }
}

/// A resting body is borne by contact forces that sum to its weight; a ball sinks by m g / k, which
/// is (1 − d) g T² for an impedance d.
#[test]
fn a_resting_body_weighs_what_it_weighs() {
    let (ball, cylinder) = (
        Geometry::Sphere { radius: 0.1 },
        Geometry::Cylinder {
            radius: 0.1,
            half_height: 0.05,
        },
    );
    let bodies = [(ball, 0.1, 1.0), (cube(), 0.05, 4.0), (cylinder, 0.05, 4.0)];
    for (solid, height, points) in bodies {
        for impedance in [0.0, 0.9] {
            let constant = 0.002;
            let material = Material {
                softness: Softness::Time {
                    constant,
                    ratio: 1.0,
                    impedance,
                    mass: None,
                },
                ..surface(0.6, 0.0)
            };
            let model = on_plane(solid.clone(), material, DVec3::Y * height, 0.0);
            let weight = model.bodies[0].mass * G;
            let mut run = Run::at_rest(&model);
            run.step(2000);
            let force: DVec3 = run.contacts().map(|c| c.2).sum();
            assert!(
                (force - DVec3::Y * weight).length() < 1e-6 * weight,
                "{force} {weight}"
            );
            assert!(run.velocity().length() < 1e-9, "{}", run.velocity());
            let depth = run.contacts().fold(0.0, |depth, c| f64::max(depth, -c.1));
            let expected = (1.0 - impedance) * G * constant * constant / points;
            assert!((depth / expected - 1.0).abs() < 1e-3, "{depth} {expected}");
        }
    }
}

/// Below tan θ = μ a block stays where it is, above it slides with g (sin θ − μ cos θ).
#[test]
fn a_block_on_an_incline_sticks_or_slides() {
    let theta = 0.4_f64;
    for share in [0.5, 0.9, 0.98, 1.02, 1.1, 1.5] {
        let friction = theta.tan() / share;
        let model = on_plane(cube(), surface(friction, 0.0), DVec3::Y * 0.05, theta);
        let mut run = Run::at_rest(&model);
        run.step(200);
        let (from, speed) = (run.position(), run.velocity().length());
        run.step(1000);
        let (time, way) = (1000.0 * H, (run.position() - from).length());
        if share < 1.0 {
            assert!(way < 1e-6, "{share}: {way}");
        } else {
            let a = G * (theta.sin() - friction * theta.cos());
            let expected = speed * time + 0.5 * a * time * time;
            assert!(
                (way - expected).abs() < 0.002 * expected,
                "{share}: {way} {expected}"
            );
        }
    }
}

/// A block that slides at v stops after v² / (2 μ g), in the direction it had.
#[test]
fn a_sliding_block_stops_where_it_should() {
    let (v, friction) = (3.0, 0.8);
    let model = on_plane(cube(), surface(friction, 0.0), DVec3::Y * 0.05, 0.0);
    let direction = DVec3::new(0.6, 0.0, 0.8);
    let u = direction * v;
    let mut run = Run::new(&model, &[u.x, u.y, u.z, 0.0, 0.0, 0.0], H);
    let from = run.position();
    run.step(1000);
    let way = run.position() - from;
    let expected = v * v / (2.0 * friction * G);
    assert!(
        (way.dot(direction) - expected).abs() < v * H,
        "{way} {expected}"
    );
    assert!(way.cross(direction).length() < 0.01 * expected, "{way}");
    assert!(run.velocity().length() < 1e-9, "{}", run.velocity());
}

/// Each bounce reaches e² of the height before, less a share (1 + 1/e) g h / v, v² = 2 g times that height: velocities
/// lie half a substep before positions. Energy never grows.
#[test]
fn a_ball_bounces_to_e_squared_of_its_height() {
    for e in [0.0, 0.25, 0.5, 0.9, 1.0] {
        let (radius, drop, h) = (0.1, 1.0, 0.0005);
        let ball = Geometry::Sphere { radius };
        let model = on_plane(ball, surface(0.3, e), DVec3::Y * (radius + drop), 0.0);
        let mut run = Run::new(&model, &[0.0; 6], h);
        let (mut energy, mut before, mut peak) = (run.energy(), drop, 0.0_f64);
        let mut bounces = 0;
        while bounces < 10 && before > 1e-2 {
            run.step(1);
            let (height, speed) = (run.position().y - radius, run.velocity().y);
            assert!(
                run.energy() < energy * (1.0 + 1e-9),
                "{e}: {}",
                run.energy()
            );
            if speed > 0.0 {
                peak = peak.max(height);
            } else if peak > 0.0 || (e == 0.0 && speed.abs() < 1e-3) {
                let ideal = e * e * before;
                let lost = if e > 0.0 {
                    ideal * 1.1 * (1.0 + 1.0 / e) * G * h / (2.0 * G * before).sqrt()
                } else {
                    0.0
                };
                // What is seen misses the top by up to half of a substep.
                let missed = G * h * h / 8.0;
                let landing = if e == 0.0 {
                    (-4.0_f64).exp() * drop
                } else {
                    1e-9
                };
                let range = ideal - lost - missed..ideal + missed + landing;
                assert!(range.contains(&peak), "{e}: {peak} in {range:?}");
                bounces += 1;
                (energy, before, peak) = (run.energy(), peak, 0.0);
            }
        }
        assert!(bounces > 0);
    }
}

/// What rolls without slipping down an incline accelerates by g sin θ / (1 + I / (m r²)).
#[test]
fn a_ball_rolls_down_an_incline() {
    let (theta, radius) = (0.3_f64, 0.1);
    let ball = Geometry::Sphere { radius };
    let model = on_plane(ball, surface(0.8, 0.0), DVec3::Y * radius, theta);
    let mut run = Run::at_rest(&model);
    run.step(100);
    let start = run.velocity();
    run.step(1000);
    let a = (run.velocity() - start).length() / (1000.0 * H);
    let expected = 5.0 / 7.0 * G * theta.sin();
    // The ball rolls on what it has sunk by less than its radius.
    assert!((a / expected - 1.0).abs() < 1e-3, "{a} {expected}");
    let slip = run.velocity().length() - run.spin().length() * radius;
    assert!(slip.abs() < 1e-3 * run.velocity().length(), "{slip}");
}

/// As a rough [`surface`], with torsional and rolling friction [m].
fn gripping(torsional_friction: f64, rolling_friction: f64) -> Material {
    Material {
        torsional_friction,
        rolling_friction,
        ..surface(1.0, 0.0)
    }
}

/// A ball that spins about the vertical is slowed by rₜ m g, and stops.
#[test]
fn torsional_friction_stops_a_spinning_ball() {
    let (radius, torsion, speed) = (0.1, 0.01, 10.0);
    let ball = Geometry::Sphere { radius };
    let model = on_plane(ball, gripping(torsion, 0.0), DVec3::Y * radius, 0.0);
    let mut run = Run::at_rest(&model);
    run.step(500);
    let slowing = torsion * G / (0.4 * radius * radius);
    run.go(DVec3::ZERO, DVec3::Y * speed);
    run.step(200);
    let expected = speed - 200.0 * H * slowing;
    let error = (run.spin() - DVec3::Y * expected).length();
    assert!(error < 1e-6 * speed, "{} {expected}", run.spin());
    run.step((speed / slowing / H) as usize - 198);
    assert!(run.spin().length() < 1e-9, "{}", run.spin());
}

/// A ball that rolls is slowed by a torque rᵣ m g, m a r = τ / (1 + I / (m r²)), and stops after
/// v² / (2 a), to the way of a substep.
#[test]
fn rolling_friction_stops_a_rolling_ball() {
    let (radius, rolling, v) = (0.1, 0.005, 1.0);
    let ball = Geometry::Sphere { radius };
    let model = on_plane(ball, gripping(0.0, rolling), DVec3::Y * radius, 0.0);
    let mut run = Run::at_rest(&model);
    run.step(500);
    let (from, a) = (run.position(), rolling * G / radius / 1.4);
    run.go(DVec3::X * v, DVec3::NEG_Z * (v / radius));
    run.step((v / a / H) as usize + 10);
    let way = run.position() - from;
    // The ball rolls on what it has sunk by less than its radius.
    let expected = v * v / (2.0 * a);
    assert!(
        (way.x - expected).abs() < v * H + 1e-3 * expected,
        "{way} {expected}"
    );
    assert!(run.velocity().length() < 1e-9, "{}", run.velocity());
}

/// Below tan θ = rᵣ / r a ball stays where it is on an incline, above it rolls down with
/// g (sin θ − rᵣ / r cos θ) / (1 + I / (m r²)).
#[test]
fn a_ball_on_an_incline_stays_or_rolls() {
    let (theta, radius) = (0.2_f64, 0.1);
    for share in [0.5, 0.9, 0.98, 1.02, 1.1, 1.5] {
        let rolling = radius * theta.tan() / share;
        let ball = Geometry::Sphere { radius };
        let model = on_plane(ball, gripping(0.0, rolling), DVec3::Y * radius, theta);
        let mut run = Run::at_rest(&model);
        run.step(300);
        let (from, speed) = (run.position(), run.velocity().length());
        run.step(1000);
        let (time, way) = (1000.0 * H, (run.position() - from).length());
        if share < 1.0 {
            assert!(way < 1e-6, "{share}: {way}");
        } else {
            let a = G * (theta.sin() - rolling / radius * theta.cos()) / 1.4;
            let expected = speed * time + 0.5 * a * time * time;
            // The lever of its weight is shorter by what it has sunk.
            let tolerance = 1e-3 * G * theta.sin() * time * time;
            assert!(
                (way - expected).abs() < tolerance,
                "{share}: {way} {expected}"
            );
        }
    }
}

/// A ball spins on a box that lies on ice: they end up turning as one, with the angular momentum that
/// the ball had.
#[test]
fn torsional_friction_acts_on_both_bodies() {
    let (radius, half, speed) = (0.1, DVec3::new(0.2, 0.1, 0.2), 10.0);
    let grip = Material {
        combine: Combine::Minimum,
        ..gripping(0.02, 0.0)
    };
    let mut world = Builder::new("turntable");
    let ice = Shape::new(plane()).with_material(surface(0.0, 0.0));
    world.object("ground").scenery(ice);
    let object = world.object("");
    let above = DVec3::Y * (2.0 * half.y + radius);
    for (name, solid, at) in [
        ("ball", Geometry::Sphere { radius }, above),
        ("box", Geometry::Box { half }, DVec3::Y * half.y),
    ] {
        let shape = Shape::new(solid).with_material(grip);
        object.body(name).at(Pose::at(at)).shape(shape);
    }
    let model = world.build().unwrap();
    let mut velocity = [0.0; 12];
    velocity[4] = speed;
    let mut run = Run::new(&model, &velocity, H);
    let moments = [
        0.4 * model.bodies[0].mass * radius * radius,
        model.bodies[1].mass * (half.x * half.x + half.z * half.z) / 3.0,
    ];
    let start = run.total(of_total::ANGULAR_MOMENTUM).y;
    run.step(2000);
    let end = run.total(of_total::ANGULAR_MOMENTUM).y;
    assert!((end / start - 1.0).abs() < 1e-9, "{start} {end}");
    let together = speed * moments[0] / (moments[0] + moments[1]);
    for body in 0..2 {
        let spin = run.body(body, of_body::ANGULAR_VELOCITY).y;
        assert!(
            (spin / together - 1.0).abs() < 1e-6,
            "{body}: {spin} {together}"
        );
    }
}

/// Two free balls meet at any offset: linear momentum is kept, and energy where nothing is lost.
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
        let mut run = Run::new(&model, &velocity, h);
        let (momentum, before) = (run.total(of_total::MOMENTUM), run.energy());
        run.step(400);
        let m = model.bodies[0].mass;
        assert!((run.total(of_total::MOMENTUM) - momentum).length() < 1e-12 * m * speed);
        assert!(run.spin().length() < 1e-9, "{}", run.spin());
        // Along the line of centres the relative speed turns round to e of itself; the rest stays.
        let sine: f64 = offset / (2.0 * radius);
        let cosine = (1.0 - sine * sine).sqrt();
        let energy = before - 0.25 * m * (speed * cosine).powi(2) * (1.0 - e * e);
        // The line of centres is that of the substep's start.
        let tolerance = 2.0 * speed * h / radius * before * (1.0 - e * e) + 1e-3 * before;
        assert!(
            (run.energy() - energy).abs() < tolerance,
            "{e} {offset}: {} {energy}",
            run.energy()
        );
        assert!(run.energy() < before * (1.0 + 1e-9), "{e} {offset}");
    }
}

/// Boxes of 10 cm and 1 kg, each on the one before.
fn tower(count: usize) -> Model {
    let mut world = Builder::new("tower");
    world.object("ground").scenery(Shape::new(plane()));
    let object = world.object("");
    let half = DVec3::splat(0.05);
    for i in 0..count {
        let name = format!("box_{i}");
        let at = Pose::at(DVec3::Y * (0.05 + 0.1 * i as f64));
        let body = object.body(name).at(at);
        body.shape(Geometry::Box { half }).mass(1.0);
    }
    world.build().unwrap()
}

/// Ten boxes stand for ten seconds; each contact bears what stands on it.
#[test]
fn a_tower_stands() {
    let model = tower(10);
    let mut run = Run::at_rest(&model);
    let from = |i: usize| DVec3::Y * (0.05 + 0.1 * i as f64);
    for second in 0..10 {
        run.step((1.0 / H) as usize);
        for i in 0..10 {
            let drift = run.body(i, of_body::POSITION) - from(i);
            let speed = run.body(i, of_body::VELOCITY).length();
            assert!(drift.length() < 1e-3, "{i} after {second} s: {drift}");
            assert!(speed < 1e-3, "{i} after {second} s: {speed}");
        }
    }
    for below in 0..10 {
        let height = 0.1 * below as f64;
        let here = run.contacts().filter(|c| (c.0.y - height).abs() < 0.02);
        let borne: f64 = here.map(|c| c.2.y.abs()).sum();
        let expected = (10 - below) as f64 * G;
        assert!(
            (borne / expected - 1.0).abs() < 1e-2,
            "{below}: {borne} {expected}"
        );
    }
}

/// A ball that starts within the ground leaves it no faster than its spring and damper can push it.
#[test]
fn an_overlap_separates_gently() {
    let (radius, depth, constant) = (0.1, 0.03, 0.002);
    let ball = Geometry::Sphere { radius };
    let model = on_plane(ball, surface(0.5, 0.0), DVec3::Y * (radius - depth), 0.0);
    let mut run = Run::at_rest(&model);
    for _ in 0..500 {
        run.step(1);
        // φ = φ₀ (1 + t/T) exp(−t/T) is fastest at t = T.
        let fastest = depth / (constant * std::f64::consts::E);
        assert!(run.velocity().length() < fastest, "{}", run.velocity());
    }
    run.step(2000);
    assert!(
        (run.position().y - radius).abs() < 1e-4,
        "{}",
        run.position()
    );
    assert!(run.velocity().length() < 1e-6, "{}", run.velocity());
}

const ROD: Geometry = Geometry::Capsule {
    radius: 0.03,
    half_height: 0.2,
};

/// A top of 40 kg on four legs of 4 kg, which joints hold, on an incline.
fn table(slope: f64) -> Model {
    let mut world = Builder::new("table");
    let tilt = DQuat::from_rotation_z(slope);
    let ground = Shape::new(plane()).at(Pose::new(DVec3::ZERO, tilt));
    world.object("ground").scenery(ground);
    let table = world.object("table");
    let half = DVec3::new(0.3, 0.05, 0.2);
    let top = table.body("top").shape(Geometry::Box { half }).mass(40.0);
    let top = top.handle();
    let at = tilt * (DVec3::Y * 0.28);
    let initial = [at.x, at.y, at.z, tilt.x, tilt.y, tilt.z, tilt.w];
    table.free("float", top).initial(&initial);
    let corners = [(-0.25, -0.15), (-0.25, 0.15), (0.25, -0.15), (0.25, 0.15)];
    for (i, (x, z)) in corners.into_iter().enumerate() {
        let leg = table.body(format!("leg_{i}")).shape(ROD).mass(4.0).handle();
        let frame = Pose::at(DVec3::new(x, -0.05, z));
        let hip = table.fixed(format!("hip_{i}"), leg).parent(top);
        hip.frames(frame, Pose::IDENTITY);
    }
    world.build().unwrap()
}

/// Rods that hang together by hinges, as a chain or as a ring, some way above the ground.
pub fn rods(count: usize, ring: bool) -> Model {
    let mut world = Builder::new("rods");
    world.object("ground").scenery(Shape::new(plane()));
    let object = world.object("rods");
    let rods: Vec<_> = (0..count)
        .map(|i| {
            let body = object.body(format!("rod_{i}")).shape(ROD);
            body.mass(1.0).handle()
        })
        .collect();
    let initial = [0.0, 0.5, 0.0, 0.6, 0.0, 0.0, 0.8];
    object.free("float", rods[0]).initial(&initial);
    let turn = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
    let (bottom, top) = (Pose::new(DVec3::Y * -0.25, turn), Pose::at(DVec3::Y * 0.25));
    for i in 1..count + usize::from(ring) {
        let child = rods[i % count];
        let hinge = object.revolute(format!("hinge_{i}"), child, DVec3::Z);
        let hinge = hinge.parent(rods[i - 1]).frames(bottom, top);
        if i == count {
            hinge.closes_loop(true);
        }
    }
    world.build().unwrap()
}

/// Bodies that joints hold, as trees or in a ring, come to lie on the ground, which bears their
/// weight; nothing gains energy on the way.
#[test]
fn jointed_bodies_lie_down() {
    let (arm, ring) = (rods(2, false), rods(4, true));
    for (name, model) in [("table", table(0.0)), ("arm", arm), ("ring", ring)] {
        let mut run = Run::at_rest(&model);
        let start = run.energy();
        for _ in 0..50 {
            run.step(100);
            assert!(run.energy() < start + 1e-3, "{name}: {}", run.energy());
        }
        let weight: f64 = G * model.bodies.iter().map(|b| b.mass).sum::<f64>();
        let force: DVec3 = run.contacts().map(|c| c.2).sum();
        assert!(
            (force - DVec3::Y * weight).length() < 1e-4 * weight,
            "{name}: {force} {weight}"
        );
        for body in 0..model.bodies.len() {
            let speed = run.body(body, of_body::VELOCITY).length();
            assert!(speed < 1e-4, "{name} {body}: {speed}");
        }
        let deepest = run.contacts().fold(0.0, |depth, c| f64::max(depth, -c.1));
        assert!(deepest < 1e-4, "{name}: {deepest}");
    }
}

/// What joints carry rests on an incline as if it were one body.
#[test]
fn a_table_sticks_on_an_incline() {
    let model = table(0.3);
    let mut run = Run::at_rest(&model);
    run.step(1000);
    let from = run.position();
    run.step(2000);
    let way = (run.position() - from).length();
    assert!(way < 1e-5, "{way}");
}
