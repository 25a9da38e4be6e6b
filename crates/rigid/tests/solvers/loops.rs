//! Closed loops in reduced coordinates.

use crate::run;
use crate::xpbd_contact::rods;
use glam::{DMat3, DQuat, DVec3};
use kinetarium_rigid::{
    InputTables, Settings, TouchingFeatherstone, body as of_body, reaction as of_reaction,
};
use model::examples::linkage;
use model::{Axis, Builder, Model, Pose};

const G: f64 = 9.81;

type Run = run::Run<TouchingFeatherstone>;

fn run_at(model: &Model, h: f64, velocity: &[f64]) -> Run {
    let mut settings = Settings::new(h);
    settings.contact_iterations = 50;
    let kernels = TouchingFeatherstone::without_contacts(model, &settings).unwrap();
    Run::of(kernels, model, velocity)
}

const KINDS: [&str; 7] = [
    "fixed",
    "revolute",
    "prismatic",
    "ball",
    "universal",
    "cylindrical",
    "plane",
];

/// Second axis of the universal joint.
const SECOND: DVec3 = DVec3::new(0.0, 0.8, 0.6);

/// Where the joint of [`pair`] is on either body.
const FRAMES: [Pose; 2] = [
    Pose {
        position: DVec3::new(0.1, -0.25, 0.05),
        orientation: DQuat::from_xyzw(0.0, 0.6, 0.0, 0.8),
    },
    Pose {
        position: DVec3::new(0.02, 0.2, -0.04),
        orientation: DQuat::from_xyzw(0.0, 0.0, 0.28, 0.96),
    },
];

/// Two bodies, the first on a ball, that a joint of a kind ties: as part of the tree, or as what closes a
/// loop, with the second body free.
fn pair(kind: &str, closes: bool) -> Model {
    let mut world = Builder::new(kind);
    let object = world.object("pair");
    let one = object
        .body("one")
        .inertia(
            1.3,
            DVec3::ZERO,
            DMat3::from_diagonal(DVec3::new(0.02, 0.03, 0.015)),
        )
        .handle();
    let other = object
        .body("other")
        .inertia(
            0.8,
            DVec3::ZERO,
            DMat3::from_diagonal(DVec3::new(0.012, 0.006, 0.01)),
        )
        .handle();
    let top = Pose::at(DVec3::new(-0.05, 0.3, 0.0));
    object.ball("top", one).frames(Pose::IDENTITY, top);
    if closes {
        let at = top.inverse() * FRAMES[0] * FRAMES[1].inverse();
        let (p, q) = (at.position, at.orientation);
        object
            .free("float", other)
            .initial(&[p.x, p.y, p.z, q.x, q.y, q.z, q.w]);
    }
    let joint = match kind {
        "fixed" => object.fixed("joint", other),
        "revolute" => object.revolute("joint", other, DVec3::Z),
        "prismatic" => object.prismatic("joint", other, DVec3::X),
        "ball" => object.ball("joint", other),
        "universal" => object.d6(
            "joint",
            other,
            &[Axis::angular(DVec3::X), Axis::angular(SECOND)],
        ),
        "cylindrical" => object.d6(
            "joint",
            other,
            &[Axis::linear(DVec3::Y), Axis::angular(DVec3::Y)],
        ),
        "plane" => object.plane_xz("joint", other),
        _ => panic!("{kind}"),
    };
    let joint = joint.parent(one).frames(FRAMES[0], FRAMES[1]);
    if closes {
        joint.closes_loop(true);
    }
    world.build().unwrap()
}

/// Where a body's frame is.
fn pose(run: &Run, body: usize) -> Pose {
    let at = run.tables.body.at(body, of_body::ORIENTATION);
    let q = DQuat::from_slice(&run.world.output[at..][..4]);
    Pose::new(run.body(body, of_body::POSITION), q)
}

/// By how much the joint of [`pair`] is off: the shifts and turns that its kind locks.
fn error(run: &Run, kind: &str) -> f64 {
    let [a, b] = [0, 1].map(|body| pose(run, body) * FRAMES[body]);
    let off = a.inverse() * b;
    let (p, q) = (off.position, off.orientation);
    let p = match kind {
        "prismatic" => DVec3::new(0.0, p.y, p.z),
        "cylindrical" => DVec3::new(p.x, 0.0, p.z),
        "plane" => DVec3::new(0.0, p.y, 0.0),
        _ => p,
    };
    let turn = match kind {
        "fixed" | "prismatic" => 2.0 * q.xyz().length(),
        "revolute" => (q * DVec3::Z - DVec3::Z).length(),
        "cylindrical" | "plane" => (q * DVec3::Y - DVec3::Y).length(),
        "universal" => (q * SECOND).x.abs(),
        _ => 0.0,
    };
    p.length() + turn
}

/// Both step by semi-implicit Euler, in other coordinates: they differ by the order of h. The joint itself is held
/// to the order of h³.
#[test]
fn a_joint_that_closes_a_loop_holds_as_one_that_carries() {
    for kind in KINDS {
        let (tree, closed) = (pair(kind, false), pair(kind, true));
        let halves = [2e-3, 1e-3].map(|h| {
            let steps = (0.5 / h) as usize;
            let mut carried = run_at(&tree, h, &vec![0.0; tree.degrees_of_freedom()]);
            let mut held = run_at(&closed, h, &vec![0.0; closed.degrees_of_freedom()]);
            carried.step(steps);
            held.step(steps);
            let away = |field| (carried.body(1, field) - held.body(1, field)).length();
            let reaction = |r: &Run, joint, field| r.vec3(r.tables.reaction.at(joint, field));
            let differ = |joints: [usize; 2], field| {
                let [one, other] = joints;
                (reaction(&carried, one, field) - reaction(&held, other, field)).length()
            };
            let passes = differ([1, 2], of_reaction::FORCE) + differ([1, 2], of_reaction::TORQUE);
            let top = differ([0, 0], of_reaction::FORCE);
            [away(of_body::POSITION), passes, top, error(&held, kind)]
        });
        let [[far, passes, top, off], [near, less, lower, finer]] = halves;
        let order = |coarse: f64, fine: f64| (coarse / fine).log2();
        assert!((order(far, near) - 1.0).abs() < 0.1, "{kind}: {far} {near}");
        assert!(near < 4e-3, "{kind}: {near}");
        assert!(
            (order(passes, less) - 1.0).abs() < 0.2,
            "{kind}: {passes} {less}"
        );
        assert!(
            (order(top, lower) - 1.0).abs() < 0.2,
            "{kind}: {top} {lower}"
        );
        assert!(
            (2.7..3.3).contains(&order(off, finer)) || off < 1e-12,
            "{kind}: {off} {finer}"
        );
        assert!(off < 1e-6, "{kind}: {off}");
    }
}

/// Two cranks of a parallelogram and the rod between them, which keeps its direction, are a pendulum:
/// (2 I + m l²) θ̈ = −g sin θ (2 mᵪ l/2 + m l). The loop is closed by a hinge, of whose five rows the tree holds three.
#[test]
fn a_parallelogram_swings_as_a_pendulum() {
    let (crank, rod, length) = (0.4, 0.7, 0.3);
    let inertia = crank * length * length / 12.0;
    let mut world = Builder::new("parallelogram");
    let object = world.object("parallelogram");
    let bar = |object: &mut model::Object, name: &str, mass: f64| {
        let thin = DMat3::from_diagonal(DVec3::new(inertia, 1e-4, inertia));
        object.body(name).inertia(mass, DVec3::ZERO, thin).handle()
    };
    let [left, right] = ["left", "right"].map(|name| bar(object, name, crank));
    let across = bar(object, "across", rod);
    let (top, bottom) = (Pose::at(DVec3::Y * 0.15), Pose::at(DVec3::Y * -0.15));
    let ends = [Pose::at(DVec3::X * -0.25), Pose::at(DVec3::X * 0.25)];
    let start = 1.2;
    for (name, body, end) in [("left_top", left, ends[0]), ("right_top", right, ends[1])] {
        let hinge = object.revolute(name, body, DVec3::Z).frames(end, top);
        hinge.initial(&[start]);
    }
    let hinge = object
        .revolute("left_bottom", across, DVec3::Z)
        .parent(left);
    hinge.frames(bottom, ends[0]).initial(&[-start]);
    let hinge = object
        .revolute("right_bottom", across, DVec3::Z)
        .parent(right);
    hinge.frames(bottom, ends[1]).closes_loop(true);
    let model = world.build().unwrap();

    let about_pivot = inertia + crank * length * length / 4.0;
    let pull = G * (crank * length + rod * length) / (2.0 * about_pivot + rod * length * length);
    let end = pendulum(start, pull, 2.0);
    let errors = [1e-3, 5e-4].map(|h| {
        let mut run = run_at(&model, h, &[0.0; 3]);
        run.step(0);
        let energy = run.energy();
        run.step((2.0 / h) as usize);
        let change = (run.energy() - energy).abs();
        assert!(change < 40.0 * h, "{h}: {energy} J changes by {change}");
        let angle = run.world.output[run.tables.position.at(0, 0)];
        (angle - end).abs()
    });
    assert!((errors[0] / errors[1]).log2() > 0.8, "{errors:?}");
    assert!(errors[1] < 2e-3, "{errors:?}");
}

/// θ of θ̈ = −pull sin θ after `seconds`, by the classical Runge–Kutta method in fine steps.
fn pendulum(start: f64, pull: f64, seconds: f64) -> f64 {
    let steps = 20_000;
    let h = seconds / f64::from(steps);
    let rate = |[x, v]: [f64; 2]| [v, -pull * x.sin()];
    let at = |[x, v]: [f64; 2], [dx, dv]: [f64; 2], h: f64| [x + h * dx, v + h * dv];
    let mut y = [start, 0.0];
    for _ in 0..steps {
        let one = rate(y);
        let two = rate(at(y, one, h / 2.0));
        let three = rate(at(y, two, h / 2.0));
        let four = rate(at(y, three, h));
        y = std::array::from_fn(|i| {
            y[i] + h / 6.0 * (one[i] + 2.0 * two[i] + 2.0 * three[i] + four[i])
        });
    }
    y[0]
}

/// A weight on a spring of stiffness 1/α hangs α m g lower; one on a rigid distance stays on its sphere, to the
/// order of h³, and swings as a pendulum does.
#[test]
fn a_distance_gives_way_by_its_compliance() {
    let hung = |compliance: f64, start: DVec3| {
        let mut world = Builder::new("hung");
        let object = world.object("weight");
        let weight = object.body("weight");
        let weight = weight.inertia(2.0, DVec3::ZERO, DMat3::IDENTITY).handle();
        let [x, y, z] = start.to_array();
        let float = object.free("float", weight);
        float.initial(&[x, y, z, 0.0, 0.0, 0.0, 1.0]);
        float.dofs_mut()[1].damping = if compliance > 0.0 { 20.0 } else { 0.0 };
        object
            .distance("rope", weight, 0.5)
            .compliance(compliance, 0.0);
        world.build().unwrap()
    };
    let model = hung(1e-3, DVec3::Y * -0.5);
    let mut run = run_at(&model, 1e-3, &[0.0; 6]);
    run.step(5000);
    let stretch = -run.position().y - 0.5;
    assert!((stretch - 1e-3 * 2.0 * G).abs() < 1e-6, "{stretch}");
    let force = run.vec3(run.tables.reaction.at(1, of_reaction::FORCE));
    assert!((force - DVec3::Y * 2.0 * G).length() < 1e-3, "{force}");

    let side = DVec3::new(0.3, -0.4, 0.0);
    let model = hung(0.0, side);
    let lengths = [2e-3, 1e-3].map(|h| {
        let mut run = run_at(&model, h, &[0.0; 6]);
        let mut worst = 0.0_f64;
        for _ in 0..20 {
            run.step((0.05 / h) as usize);
            worst = worst.max((run.position().length() - 0.5).abs());
        }
        let angle = run.position().x.atan2(-run.position().y);
        let end = pendulum(0.75_f64.atan(), G / 0.5, 1.0);
        assert!((angle - end).abs() < 5.0 * h, "{h}: {angle} {end}");
        worst
    });
    assert!(
        lengths[0] < 1e-6 && lengths[0] / lengths[1] > 6.0,
        "{lengths:?}"
    );
}

/// A rope that is 0.1 m too long at the start is pulled in at no more than 1 m/s, of what is beyond a 64th of its length a
/// tenth a step, so that the weight stops where the rope is right; also where contacts are given no iterations.
#[test]
fn what_is_open_at_the_start_is_closed() {
    let mut world = Builder::new("slack");
    world.gravity(DVec3::ZERO);
    let object = world.object("weight");
    let weight = object.body("weight");
    let weight = weight.inertia(2.0, DVec3::ZERO, DMat3::IDENTITY).handle();
    let float = object.free("float", weight);
    float.initial(&[0.6, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    object.distance("rope", weight, 0.5);
    let model = world.build().unwrap();
    let (h, size) = (2e-3, 1.5_f64.sqrt());
    let mut settings = Settings::new(h);
    settings.contact_iterations = 0;
    let kernels = TouchingFeatherstone::without_contacts(&model, &settings).unwrap();
    let mut run = Run::of(kernels, &model, &[0.0; 6]);
    let (fastest, mut gap) = (1.0 * h, 0.1_f64);
    let drift = fastest.min(size / 64.0);
    for _ in 0..60 {
        let way = if gap > drift {
            fastest.min(drift + 0.1 * (gap - drift))
        } else {
            gap
        };
        gap -= way;
        run.step(1);
        let (place, speed) = (run.position(), run.velocity());
        assert!(
            (place - DVec3::X * (0.5 + gap)).length() < 1e-12,
            "{place} {gap}"
        );
        assert!(
            (speed + DVec3::X * way / h).length() < 1e-9,
            "{speed} {gap}"
        );
    }
    assert!(gap.abs() < 1e-15 && run.velocity().length() < 1e-9);
}

/// A ring of four rods comes to lie on the ground.
#[test]
fn a_ring_lies_down() {
    let model = rods(4, true);
    let kernels = TouchingFeatherstone::new(&model, &Settings::new(1e-3)).unwrap();
    let mut run = Run::of(kernels, &model, &vec![0.0; model.degrees_of_freedom()]);
    run.step(0);
    let start = run.energy();
    for _ in 0..50 {
        run.step(100);
        assert!(run.energy() < start + 1e-3, "{}", run.energy());
    }
    let weight: f64 = G * model.bodies.iter().map(|b| b.mass).sum::<f64>();
    let force: DVec3 = run.forces().sum();
    assert!(
        (force - DVec3::Y * weight).length() < 1e-3 * weight,
        "{force} {weight}"
    );
    for body in 0..model.bodies.len() {
        let speed = run.body(body, of_body::VELOCITY).length();
        assert!(speed < 1e-3, "{body}: {speed}");
    }
}

/// Gears: (I + ratio² J) q̈ = τ, at once and for good; beyond a turn, too.
#[test]
fn gears_turn_together() {
    let mut world = Builder::new("gears");
    let object = world.object("gears");
    let [driver, follower] = [0.02, 0.005].map(|moment| {
        let inertia = DMat3::from_diagonal(DVec3::splat(moment));
        let name = format!("wheel_{moment}");
        let wheel = object
            .body(&name)
            .inertia(1.0, DVec3::ZERO, inertia)
            .handle();
        object
            .revolute(format!("{name}_axle"), wheel, DVec3::Z)
            .handle()
    });
    object.couple("teeth", follower, driver, -3.0, 0.2);
    object.motor("engine", driver);
    let model = world.build().unwrap();
    let mut run = run_at(&model, 1e-3, &[0.0; 2]);
    run.world.state[run.kernels.position_table().start() + 1] = 0.2;
    let control = InputTables::new(&model).control.start();
    run.world.input[control] = 0.5;
    run.step(2000);
    let speed = |dof| run.world.output[run.tables.velocity.at(dof, 0)];
    let rate = 2.0 * 0.5 / (0.02 + 9.0 * 0.005);
    assert!((speed(0) - rate).abs() < 1e-9, "{} {rate}", speed(0));
    assert!((speed(1) + 3.0 * rate).abs() < 1e-9, "{} {rate}", speed(1));
    let turned = |i| run.world.state[run.kernels.position_table().start() + i];
    assert!(
        (turned(1) - 0.2 + 3.0 * turned(0)).abs() < 1e-9,
        "{} {}",
        turned(0),
        turned(1)
    );
    assert!(turned(0) > 10.0, "{}", turned(0));
}

/// A finger whose outer joint bends with the inner one, which carries it: q₂ = ½ q₁ to rounding. With that, its energy
/// is that of a pendulum of one degree of freedom, and stays as one's.
#[test]
fn a_coupled_finger_keeps_its_energy() {
    let mut world = Builder::new("finger");
    let object = world.object("finger");
    let mut parent = None;
    let mut hinges = Vec::new();
    for (i, length) in [0.2, 0.15].into_iter().enumerate() {
        let thin = DMat3::from_diagonal(DVec3::new(1e-3, 1e-4, 1e-3));
        let body = object.body(format!("phalanx_{i}"));
        let body = body.inertia(0.3, DVec3::Y * (-0.5 * length), thin).handle();
        let hinge = object.revolute(format!("hinge_{i}"), body, DVec3::Z);
        if let Some(parent) = parent.replace(body) {
            hinge
                .parent(parent)
                .frames(Pose::at(DVec3::Y * -0.2), Pose::IDENTITY);
        }
        hinge.initial(&[1.0 / (i + 1) as f64]);
        hinges.push(hinge.handle());
    }
    object.couple("tendon", hinges[1], hinges[0], 0.5, 0.0);
    let model = world.build().unwrap();
    let drift = [1e-3, 5e-4].map(|h| {
        let mut run = run_at(&model, h, &[0.0; 2]);
        run.step(0);
        let start = run.energy();
        let mut worst = 0.0_f64;
        for _ in 0..100 {
            run.step((0.05 / h) as usize);
            worst = worst.max((run.energy() - start).abs());
            let at = |i| run.world.output[run.tables.position.at(i, 0)];
            assert!((at(1) - 0.5 * at(0)).abs() < 1e-12, "{} {}", at(0), at(1));
        }
        worst
    });
    assert!(drift[0] < 5e-3 && drift[0] / drift[1] > 1.8, "{drift:?}");
}

/// A machine on six legs, each of three loops, walks as its crank turns. About the middle of its step a foot goes
/// 0.36 m in a quarter turn (plane geometry: from −0.544 to −0.182 m), 1.45 m a turn; the hull keeps its height. No
/// loop gapes.
#[test]
fn a_linkage_walks() {
    let model = linkage(3).unwrap();
    let kernels = TouchingFeatherstone::new(&model, &Settings::new(2e-3)).unwrap();
    let mut run = Run::of(kernels, &model, &vec![0.0; model.degrees_of_freedom()]);
    run.world.input = InputTables::new(&model).initial(&model);
    run.step(0);
    let (start, turns) = (run.position(), 4.0 * 3.0 / std::f64::consts::TAU);
    let mut gap = 0.0_f64;
    for _ in 0..40 {
        run.step(50);
        assert!(
            (run.position().y - start.y).abs() < 0.1,
            "{}",
            run.position()
        );
        for joint in model.joints.iter().filter(|j| j.closes_loop) {
            let parent = joint.parent.unwrap();
            let ends = [
                pose(&run, parent.0) * joint.parent_frame,
                pose(&run, joint.child.0) * joint.child_frame,
            ];
            gap = gap.max((ends[0].position - ends[1].position).length());
        }
    }
    let way = start.x - run.position().x;
    assert!((way / turns - 1.45).abs() < 0.1, "{way} m in {turns} turns");
    assert!(gap < 1e-5, "{gap}");
}
