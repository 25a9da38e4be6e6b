//! What swings on springs: it goes on where steps resolve it, and comes to rest where they do not.

use crate::common::*;
use fastrand::Rng;
use glam::{DMat3, DQuat, DVec3};
use kinetarium_sim::{Effort, Gauge, Simulation};
use model::{Axis, BodyHandle, Builder, Drive, JointId, Model, Pose};

/// Symplectic Euler keeps v² + ω² q² − h ω² q v, ω = √(k/m), to rounding.
#[test]
fn a_spring_that_steps_resolve_keeps_its_energy() {
    let h = 2e-3;
    for (stiffness, seconds) in [(1000.0, 1.0), (1000.0, 100.0), (4e5, 10.0)] {
        for model in [
            slider(|j| _ = j.spring(stiffness, 0.0)),
            wheel(|j| _ = j.spring(stiffness, 0.0)),
        ] {
            for method in SOLVERS {
                let mut simulation = method.simulate::<f64>(&model, h);
                simulation.set_joint_state(0, &[1e-7], &[3e-7]).unwrap();
                let kept = |q: f64, v: f64| v * v + stiffness / MASS * q * (q - h * v);
                let steps = (seconds / h) as usize;
                simulation.step(steps);
                let outputs = simulation.outputs();
                let (q, v) = (outputs.joint_position(0)[0], outputs.joint_velocity(0)[0]);
                let share = kept(q, v) / kept(1e-7, 3e-7);
                let rounding = 1e-14 * steps as f64;
                close(
                    format!("{} {method:?} {stiffness} {seconds}", model.name),
                    share,
                    1.0,
                    rounding,
                );
            }
        }
    }
}

/// A number between two.
fn within(random: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * random.f64()
}

/// The same, evenly in its logarithm.
fn decades(random: &mut Rng, low: f64, high: f64) -> f64 {
    within(random, low.ln(), high.ln()).exp()
}

fn direction(random: &mut Rng) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| within(random, -1.0, 1.0))).normalize()
}

/// Slides, pairs of hinges, and hinges twice as often; with balls; with slides that turn, too.
const PLAIN: usize = 4;
const BALLS: usize = 5;
const ALL: usize = 6;

/// A tree of bodies on springs, of masses, sizes and stiffnesses that differ by decades, on the world or free, with the first of
/// these many kinds of joints. Those beyond [`PLAIN`] have armatures. Balls have drives, as they take no springs.
fn tree(random: &mut Rng, [softest, stiffest]: [f64; 2], kinds: usize) -> Model {
    let mut world = Builder::new("tree");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let mut bodies: Vec<BodyHandle> = Vec::new();
    for i in 0..random.usize(1..7) {
        let (mass, size) = (decades(random, 0.1, 10.0), decades(random, 0.03, 0.3));
        let turn = DMat3::from_quat(DQuat::from_scaled_axis(direction(random)));
        let sides = [0; 3].map(|_| within(random, 0.3, 1.0) * size);
        let [a, b, c] = sides.map(|side| mass * side * side);
        let moments = DMat3::from_diagonal(DVec3::new(b + c, c + a, a + b));
        let inertia = turn * moments * turn.transpose();
        let center = direction(random) * within(random, 0.0, 3.0) * size;
        let body = object.body(format!("body {i}"));
        let body = body.inertia(mass, center, inertia).handle();
        if i > 0 && random.usize(0..5) == 0 {
            bodies.push(body);
            continue;
        }
        let (axis, name) = (direction(random), format!("joint {i}"));
        let across = axis.any_orthonormal_vector();
        let kind = random.usize(0..kinds);
        let joint = match kind {
            0 => object.prismatic(name, body, axis),
            1 => object.d6(name, body, &[Axis::angular(axis), Axis::angular(across)]),
            4 => object.ball(name, body),
            5 => object.d6(name, body, &[Axis::linear(axis), Axis::angular(across)]),
            _ => object.revolute(name, body, axis),
        };
        let stiffness = decades(random, softest, stiffest);
        if kind == 4 {
            joint.drive(Drive {
                stiffness,
                ..Drive::default()
            });
        } else {
            joint.spring(stiffness, 0.0);
        }
        if kinds > PLAIN && kind != 4 {
            joint.armature(decades(random, 1e-6, 1e-1));
        }
        if !bodies.is_empty() && random.usize(0..5) > 0 {
            joint.parent(bodies[random.usize(0..bodies.len())]);
        }
        joint.at(Pose::at(direction(random) * within(random, 0.0, 0.5)));
        bodies.push(body);
    }
    world.build().unwrap()
}

/// The last energy, and the most, of a tree that begins at its initial place with random speeds, in 4 s, as shares of what it
/// begins with.
fn energies(model: &Model, method: Method, random: &mut Rng) -> [f64; 2] {
    let n = model.degrees_of_freedom();
    let speeds: Vec<_> = (0..n).map(|_| within(random, -1.0, 1.0)).collect();
    let mut simulation = method.simulate::<f64>(model, 2e-3);
    let place = model.initial_position();
    simulation.set_joint_state(0, &place, &speeds).unwrap();
    let before = simulation.outputs().energy(0);
    let shares = (0..100).map(|_| {
        simulation.step(20);
        simulation.outputs().energy(0) / before
    });
    shares.fold([0.0; 2], |[_, most], share| [share, f64::max(most, share)])
}

/// Stable however stiff: what a tree is given, it never has much more of. What steps keep is the energy with up to half as much
/// more or less where ω h = 1, and so energy itself is at most (1 + ½)/(1 − ½) of what it was. By `impulse`, which pushes joints
/// one by one, what springs that are stiff for a small step have not yet passed on is more for a moment.
#[test]
fn no_spring_is_too_stiff() {
    let mut random = Rng::with_seed(7);
    for case in 0..300 {
        let model = tree(&mut random, [1e-2, 1e9], PLAIN);
        for (method, bound) in [(EULER, 3.0), (XPBD, 3.0), (Method::Impulse(8), 5.0)] {
            let [last, most] = energies(&model, method, &mut random);
            let name = format!("{case} {method:?}: {last} {most}");
            assert!(last <= 3.0 && most <= bound, "{name}");
        }
    }
}

/// By `impulse` balls with stiff drives, and by `xpbd` slides that turn on stiff springs, do fly apart.
#[test]
fn no_ball_is_too_stiff_nor_what_an_armature_swings() {
    let mut random = Rng::with_seed(8);
    for case in 0..300 {
        for (method, kinds) in [(EULER, ALL), (EULER, BALLS), (XPBD, BALLS)] {
            let model = tree(&mut random, [1e-2, 1e9], kinds);
            let [_, most] = energies(&model, method, &mut random);
            assert!(most <= 3.0, "{case} {method:?}: {most}");
        }
    }
}

/// Two rods side by side on a slide, the first free: they have 0.09 kg along it where they are level, but a fifth of that
/// 66 mm farther, where they turn about the line between them.
#[test]
fn rods_are_stable_where_a_slide_brings_them_to_turn_about_themselves() {
    let (radius, rod) = (0.01, DVec3::new(-0.111, -0.983, 0.146).normalize());
    let (thin, long) = (0.5 * radius * radius, 1.0 / 12.0 + 0.25 * radius * radius);
    let along = DMat3::from_cols(rod * rod.x, rod * rod.y, rod * rod.z);
    let inertia = DMat3::IDENTITY * long - along * (long - thin);
    let (h, stiffness, rest) = (2e-3, 22988.0, 0.0655);
    for way in [-1.0, 1.0] {
        let mut world = Builder::new("rods");
        world.gravity(DVec3::ZERO);
        let object = world.object("");
        let [first, second] = ["first", "second"].map(|name| {
            let body = object.body(name);
            body.inertia(1.0, DVec3::ZERO, inertia).handle()
        });
        object.free("float", first);
        let slide = object.prismatic("slide", second, DVec3::X);
        let beside = Pose::at(DVec3::Y * 0.607);
        slide.parent(first).frames(beside, Pose::IDENTITY);
        slide.spring(stiffness, way * rest);
        let model = world.build().unwrap();
        for method in SOLVERS {
            let mut simulation = method.simulate::<f64>(&model, h);
            let mut place = model.initial_position();
            let slid = place.len() - 1;
            place[slid] = way * rest + 1e-6;
            let speeds = vec![0.0; model.degrees_of_freedom()];
            simulation.set_joint_state(0, &place, &speeds).unwrap();
            simulation.step(20);
            let off = simulation.outputs().joint_position(0)[slid] - way * rest;
            assert!(off.abs() <= 1.1e-6, "{method:?} {way}: {off}");
        }
    }
}

/// Joints that share a body are pushed one by one, and yet what swings on them goes on, and is fed nothing.
#[test]
fn joints_that_share_a_body_keep_what_swings() {
    let mut random = Rng::with_seed(11);
    let mut kept = Vec::new();
    for case in 0..100 {
        let model = tree(&mut random, [10.0, 1e3], PLAIN);
        let [last, most] = energies(&model, Method::Impulse(8), &mut random);
        assert!(most <= 1.1, "{case}: {most}");
        kept.push(last);
    }
    kept.sort_by(f64::total_cmp);
    // What small steps do not resolve comes to rest.
    assert!(kept[15] > 0.9, "{kept:?}");
}

/// What a spring may do is told of each world's own masses: a chain that loses half of them again and again stays stable.
#[test]
fn a_world_that_gets_lighter_stays_stable() {
    let chain = |mass: f64| {
        let mut world = Builder::new("chain");
        world.gravity(DVec3::ZERO);
        let object = world.object("");
        let mut last = None;
        for i in 0..6 {
            let moments = DMat3::from_diagonal(DVec3::new(1e-3, 5e-3, 5e-3) * mass);
            let link = object.body(format!("link {i}"));
            let link = link.inertia(mass, DVec3::X * 0.15, moments).handle();
            let joint = object.revolute(format!("hinge {i}"), link, DVec3::Y);
            joint.spring(1e7, 0.0);
            if let Some(parent) = last {
                let at = Pose::at(DVec3::X * 0.3);
                joint.parent(parent).frames(at, Pose::IDENTITY);
            }
            last = Some(link);
        }
        world.build().unwrap()
    };
    let speeds = [1.0, -2.0, 3.0, -1.0, 2.0, -3.0];
    for method in [EULER, XPBD, Method::Impulse(8)] {
        let settings = method.settings(2, 2e-3);
        let mut simulation = Simulation::<f64>::new(chain(1.0), settings).unwrap();
        for halvings in 1..=6 {
            let lighter = chain(0.5_f64.powi(halvings));
            simulation.set_world_model(1, &lighter).unwrap();
            simulation.set_joint_state(1, &[0.0; 6], &speeds).unwrap();
            let before = simulation.outputs().energy(1);
            for _ in 0..50 {
                simulation.step(10);
                let share = simulation.outputs().energy(1) / before;
                assert!(share <= 3.0, "{method:?} {halvings}: {share}");
            }
        }
    }
}

/// Two links in a row, each held out level by a drive, or by a servo with a gear of 2 that is as stiff.
fn held_out([mass, length, moment]: [f64; 3], stiffness: f64, by_servos: bool) -> Model {
    let mut world = Builder::new("arm");
    world.gravity(DVec3::Z * -9.81);
    let object = world.object("");
    let (damping, mut last) = (5.0, None);
    for i in 0..2 {
        let middle = DVec3::X * length * 0.5;
        let inertia = DMat3::from_diagonal(DVec3::splat(moment));
        let link = object.body(format!("link {i}"));
        let link = link.inertia(mass, middle, inertia).handle();
        let joint = object.revolute(format!("hinge {i}"), link, DVec3::Y);
        if let Some(parent) = last {
            let at = Pose::at(DVec3::X * length);
            joint.parent(parent).frames(at, Pose::IDENTITY);
        }
        if by_servos {
            let joint = joint.handle();
            let servo = format!("servo {i}");
            let servo = object.position_servo(servo, joint, stiffness / 4.0, damping / 4.0);
            servo.gear(2.0);
        } else {
            joint.drive(Drive {
                stiffness,
                damping,
                ..Drive::default()
            });
        }
        last = Some(link);
    }
    world.build().unwrap()
}

/// What acts along the last joint, and what its servo does where it has one, twice: as gauges tell it, and by the laws of one
/// world.
fn efforts(simulation: &mut Simulation<f64>, by_servos: bool) -> [Vec<f64>; 2] {
    let joint = Gauge::JointEffort(vec![JointId(1)]);
    let servos = Gauge::ActuatorForce(Vec::from_iter((0..2).filter(|i| by_servos && *i == 1)));
    let mut gauges = simulation.gauges(vec![joint, servos]).unwrap();
    simulation.read_gauges(&mut gauges, &[0]).unwrap();
    let mut read = vec![0.0; gauges.length()];
    gauges.copy(0, 0, &mut read);
    let told = simulation.observe(|simulation, outputs| {
        let effort = Effort {
            simulation,
            outputs,
            world: 0,
        };
        let mut told = Vec::new();
        effort.of_joint(JointId(1), |force| told.push(force));
        if by_servos {
            told.push(effort.of_actuator(1));
        } else {
            assert_eq!(effort.of_drive(JointId(1), 0), told[0]);
        }
        told
    });
    [read, told.unwrap()]
}

/// They come to rest where their stiffness says, or where that is more than a small step resolves, where the largest would hold
/// them that it does; and the effort told is what holds them.
#[test]
fn drives_hold_loads_as_stiffly_as_they_say() {
    let (mass, length, h) = (2.0, 0.3, 2e-3);
    let moment = mass * length * length / 12.0;
    for (steps, stiffness) in [(1, 500.0), (8, 500.0), (8, 3e4), (8, 1e9)] {
        for by_servos in [false, true] {
            let model = held_out([mass, length, moment], stiffness, by_servos);
            let mut simulation = Method::Impulse(steps).simulate::<f64>(&model, h);
            simulation.step(5000);
            let sag = simulation.outputs().joint_position(0)[1];
            let small = h / steps as f64;
            let resolved = 0.5 * moment / (small * small);
            let load = mass * 9.81 * length * 0.5;
            let expected = load / f64::min(stiffness, resolved);
            let name = format!("{steps} {stiffness} {by_servos}");
            close(&name, sag, expected, 1e-3 * expected);
            for told in efforts(&mut simulation, by_servos) {
                close(&name, told[0], -load, 1e-3 * load);
                if by_servos {
                    close(&name, told[1], -0.5 * load, 1e-3 * load);
                }
            }
        }
    }
}
