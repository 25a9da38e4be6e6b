//! Robots and free bodies push each other: what one gets the other gives.

use crate::common::{G, close, near};
use glam::{DMat3, DQuat, DVec3};
use kinetarium_sim::{Contact, Simulation, SimulationSettings, SolverKind};
use model::{BodyId, Builder, Combine, Drive, Geometry, Material, Model, Pose, Shape, ShapeId};
use std::f64::consts::FRAC_PI_2;

/// Step [s].
const H: f64 = 1e-3;
/// The solvers of robots.
const SOLVERS: [SolverKind; 2] = [SolverKind::Featherstone, SolverKind::Xpbd];
const PLANE: Geometry = Geometry::Plane {
    half_x: 0.0,
    half_z: 0.0,
};

fn simulate(model: &Model, solver: SolverKind) -> Simulation<f64> {
    let settings = SimulationSettings {
        solver,
        threads: 1,
        ..SimulationSettings::new(1, H)
    };
    Simulation::new(model.clone(), settings).unwrap()
}

/// Of two surfaces the less rough one counts.
fn surface(friction: f64) -> Material {
    Material {
        friction,
        combine: Combine::Minimum,
        ..Material::default()
    }
}

/// The force [N] of one body's shapes on another's, or of the world's.
fn force(sim: &mut Simulation<f64>, from: Option<BodyId>, on: BodyId) -> DVec3 {
    let model = sim.model().clone();
    let of = |shape: ShapeId| model.shapes[shape.0].body;
    let part = |c: Contact| match c.shapes.map(of) {
        [a, b] if a == from && b == Some(on) => c.force,
        [a, b] if b == from && a == Some(on) => -c.force,
        _ => DVec3::ZERO,
    };
    sim.outputs().contacts(0).map(part).sum()
}

const FRICTION: f64 = 0.5;
/// Of the box that is pushed, a cube of 20 cm [kg].
const LOAD: f64 = 2.0;
const SIDE: f64 = 0.1;

/// Ground, and a box on it.
fn floor_with_box(world: &mut Builder) {
    let rough = surface(FRICTION);
    let ground = Shape::new(PLANE).with_material(rough);
    world.object("ground").scenery(ground);
    let half = DVec3::splat(SIDE);
    let shape = Shape::new(Geometry::Box { half }).with_material(rough);
    let load = world.object("load").body("load").shape(shape);
    load.at(Pose::at(DVec3::Y * SIDE)).mass(LOAD);
}

fn tip() -> Shape {
    let ball = Geometry::Sphere { radius: 0.02 };
    Shape::new(ball).with_material(surface(0.0))
}

/// Mass of the hand [kg].
const HAND: f64 = 1.0;

/// A hand on a slide along x, which touches the box at the height of its centre.
fn slide(drive: Drive) -> Model {
    let mut world = Builder::new("slide");
    floor_with_box(&mut world);
    let robot = world.object("robot");
    let at = Pose::at(DVec3::new(-SIDE - 0.02, SIDE, 0.0));
    let hand = robot.body("hand").at(at).shape(tip()).mass(HAND).handle();
    let rail = robot.prismatic("rail", hand, DVec3::X).at(at);
    rail.drive(drive);
    world.build().unwrap()
}

/// By what share friction may be off. `featherstone` settles the cone to some per cent where what slides sets off.
fn off(solver: SolverKind, sets_off: bool) -> f64 {
    match (solver, sets_off) {
        (SolverKind::Featherstone, true) => 0.05,
        _ => 2e-3,
    }
}

/// A hand that a drive pushes on at v meets the box's friction, μ m g: in the contact, in the drive, d (v − q̇), and in
/// the joint, which besides bears the hand's weight.
#[test]
fn a_hand_that_pushes_a_box_feels_its_friction() {
    let drive = Drive {
        damping: 2000.0,
        target_velocity: 0.2,
        ..Drive::default()
    };
    let (model, friction) = (slide(drive), FRICTION * LOAD * G);
    let [load, hand] = ["load", "hand"].map(|name| model.body(name).unwrap());
    let rail = model.joint("rail").unwrap();
    let dof = model.dof_range(rail).start;
    for solver in SOLVERS {
        let mut sim = simulate(&model, solver);
        sim.step(1000);
        let pushed = force(&mut sim, Some(hand), load);
        let most = off(solver, false) * friction;
        near(
            format!("{solver:?}: contact"),
            pushed,
            DVec3::X * friction,
            most,
        );
        let speed = sim.outputs().dof_velocity(0, dof);
        let driven = drive.damping * (drive.target_velocity - speed);
        close(format!("{solver:?}: drive"), driven, friction, most);
        let borne = sim.outputs().reaction(0, rail).0;
        let expected = DVec3::new(friction, HAND * G, 0.0);
        near(format!("{solver:?}: joint"), borne, expected, most);
        let ground = force(&mut sim, None, load);
        let expected = DVec3::new(-friction, LOAD * G, 0.0);
        near(format!("{solver:?}: ground"), ground, expected, most);
    }
}

/// A force F at the joint moves hand and box as one: (M + m) a = F − μ m g, and the hand presses with m a + μ m g.
#[test]
fn a_hand_and_a_box_move_as_one() {
    let model = slide(Drive::default());
    let [load, hand] = ["load", "hand"].map(|name| model.body(name).unwrap());
    let dof = model.dof_range(model.joint("rail").unwrap()).start;
    let (friction, given) = (FRICTION * LOAD * G, 14.0);
    let a = (given - friction) / (HAND + LOAD);
    for solver in SOLVERS {
        let mut sim = simulate(&model, solver);
        sim.controls().set_dof_force(0, dof, given).unwrap();
        sim.step(100);
        let start = sim.outputs().momentum(0).x;
        sim.step(400);
        let gained = sim.outputs().momentum(0).x - start;
        let ideal = (given - friction) * 400.0 * H;
        close(
            format!("{solver:?}: momentum"),
            gained,
            ideal,
            off(solver, false) * friction * 400.0 * H,
        );
        let ideal = LOAD * a + friction;
        let pushed = force(&mut sim, Some(hand), load);
        near(
            format!("{solver:?}: contact"),
            pushed,
            DVec3::X * ideal,
            off(solver, false) * friction,
        );
    }
}

/// An arm of length l that hangs beside the box and weighs nothing pushes with τ / l. Up to μ m g the box stays where it
/// is; beyond, it slides with (I / l² + m) a = τ / l − μ m g as long as the arm hangs.
#[test]
fn an_arm_pushes_a_box_with_its_torque() {
    let (length, inertia) = (0.5, 0.05);
    let mut world = Builder::new("arm");
    floor_with_box(&mut world);
    let robot = world.object("robot");
    let shoulder = Pose::at(DVec3::new(-SIDE - 0.02, SIDE + length, 0.0));
    let hand = tip().at(Pose::at(DVec3::NEG_Y * length));
    // Its centre in the shoulder: gravity turns it nowhere.
    let arm = robot.body("arm").at(shoulder).shape(hand);
    let arm = arm.inertia(1.0, DVec3::ZERO, DMat3::IDENTITY * inertia);
    let arm = arm.handle();
    robot.revolute("shoulder", arm, DVec3::Z).at(shoulder);
    let model = world.build().unwrap();
    let [load, arm] = ["load", "arm"].map(|name| model.body(name).unwrap());
    let dof = model.dof_range(model.joint("shoulder").unwrap()).start;
    let friction = FRICTION * LOAD * G;
    for solver in SOLVERS {
        for share in [0.5, 0.9, 1.5, 2.0] {
            let what = format!("{solver:?}, {share} of the friction");
            let push = share * friction;
            let mut sim = simulate(&model, solver);
            // Let the box settle.
            sim.step(200);
            sim.controls().set_dof_force(0, dof, push * length).unwrap();
            let from = sim.outputs().body_position(0, load).x;
            sim.step(100);
            let way = sim.outputs().body_position(0, load).x - from;
            let pressed = force(&mut sim, Some(arm), load).x;
            let a = f64::max(push - friction, 0.0) / (inertia / length / length + LOAD);
            let ideal = LOAD * a + f64::min(push, friction);
            // The arm has turned a little.
            let most = off(solver, true) * friction + 0.01 * ideal;
            close(format!("{what}: contact"), pressed, ideal, most);
            // What gives way under the push; and friction that is off, and half a step early or late.
            let (time, less) = (100.0 * H, off(solver, true) * friction / LOAD);
            let ideal = 0.5 * a * time * time;
            let slides = 0.5 * time * (less * time + a * H);
            let most = 2e-5 + if a > 0.0 { slides } else { 0.0 };
            close(format!("{what}: way"), way, ideal, most);
        }
    }
}

/// A foot that moves at v and stands on a ball with its weight rolls it along at v / 2; the ground bears both, and nothing
/// slows the foot.
#[test]
fn a_foot_rolls_a_ball() {
    let (radius, thick, weight, ball) = (0.1, 0.02, 3.0, 2.0);
    let mut world = Builder::new("foot");
    let rough = surface(0.8);
    let ground = Shape::new(PLANE).with_material(rough);
    world.object("ground").scenery(ground);
    let shape = Shape::new(Geometry::Sphere { radius }).with_material(rough);
    let low = Pose::at(DVec3::Y * radius);
    let thing = world.object("ball").body("ball").shape(shape);
    thing.at(low).mass(ball);
    let robot = world.object("robot");
    let half = DVec3::new(0.4, thick, 0.2);
    let sole = Shape::new(Geometry::Box { half }).with_material(rough);
    let high = Pose::at(DVec3::Y * (2.0 * radius + thick));
    let foot = robot.body("foot").at(high).shape(sole).mass(weight);
    let foot = foot.handle();
    let axes = [DVec3::X, DVec3::Y].map(model::Axis::linear);
    let leg = robot.d6("leg", foot, &axes).at(high);
    let drive = Drive {
        damping: 500.0,
        target_velocity: 0.3,
        ..Drive::default()
    };
    leg.dofs_mut()[0].drive = drive;
    let model = world.build().unwrap();
    let [rolls, foot] = ["ball", "foot"].map(|name| model.body(name).unwrap());
    let dof = model.dof_range(model.joint("leg").unwrap()).start;
    for solver in SOLVERS {
        let mut sim = simulate(&model, solver);
        sim.step(1500);
        let v = drive.target_velocity;
        let outputs = sim.outputs();
        let (way, spin) = (
            outputs.body_velocity(0, rolls),
            outputs.body_angular_velocity(0, rolls),
        );
        near(
            format!("{solver:?}: ball"),
            way,
            DVec3::X * 0.5 * v,
            2e-3 * v,
        );
        let ideal = DVec3::NEG_Z * 0.5 * v / radius;
        near(format!("{solver:?}: spin"), spin, ideal, 2e-3 * v / radius);
        let driven = drive.damping * (v - outputs.dof_velocity(0, dof));
        let all = (weight + ball) * G;
        close(format!("{solver:?}: drive"), driven, 0.0, 2e-3 * all);
        let on_ball = force(&mut sim, Some(foot), rolls);
        near(
            format!("{solver:?}: foot"),
            on_ball,
            DVec3::NEG_Y * weight * G,
            2e-3 * all,
        );
        let ground = force(&mut sim, None, rolls);
        near(
            format!("{solver:?}: ground"),
            ground,
            DVec3::Y * all,
            2e-3 * all,
        );
    }
}

/// A robot on a heavy foot that stands freely, which holds a load on a tray out in front.
fn waiter() -> Model {
    let mut world = Builder::new("waiter");
    let rough = surface(0.8);
    let ground = Shape::new(PLANE).with_material(rough);
    world.object("ground").scenery(ground);
    let robot = world.object("robot");
    let half = DVec3::new(0.3, 0.05, 0.3);
    let base = Shape::new(Geometry::Box { half }).with_material(rough);
    let base = robot.body("base").at(Pose::at(DVec3::Y * 0.05)).shape(base);
    let base = base.mass(20.0).handle();
    let drive = Drive {
        stiffness: 5000.0,
        damping: 200.0,
        ..Drive::default()
    };
    // Two links of 40 cm along x, the second one a tray.
    let (mut parent, mut shoulder) = (base, DVec3::Y * 0.5);
    for (name, mass) in [("upper", 1.5), ("tray", 1.0)] {
        let center = Pose::at(shoulder + DVec3::X * 0.2);
        let half = DVec3::new(0.18, 0.02, 0.1);
        let link = Shape::new(Geometry::Box { half }).with_material(rough);
        let link = robot.body(name).at(center).shape(link).mass(mass).handle();
        let hinge = robot.revolute(format!("{name} hinge"), link, DVec3::Z);
        hinge.parent(parent).at(Pose::at(shoulder)).drive(drive);
        (parent, shoulder) = (link, shoulder + DVec3::X * 0.4);
    }
    let side = DVec3::splat(0.05);
    let load = Shape::new(Geometry::Box { half: side }).with_material(rough);
    let at = Pose::at(DVec3::new(0.62, 0.5 + 0.02 + 0.05, 0.0));
    world
        .object("load")
        .body("load")
        .at(at)
        .shape(load)
        .mass(3.0);
    world.build().unwrap()
}

/// The drives that hold an arm bear the moment of all that hangs on it, load included: k (target − q) = Σ m g (x − x₀);
/// the joints bear its weight, and the ground that of the whole.
#[test]
fn a_robot_carries_a_load() {
    let model = waiter();
    let bodies = ["upper", "tray", "load"].map(|name| model.body(name).unwrap());
    let base = model.body("base").unwrap();
    for solver in SOLVERS {
        let mut sim = simulate(&model, solver);
        sim.step(4000);
        let still = sim.outputs().body_velocity(0, bodies[2]).length();
        assert!(still < 1e-4, "{solver:?}: {still} m/s");
        for (i, name) in ["upper hinge", "tray hinge"].into_iter().enumerate() {
            let id = model.joint(name).unwrap();
            let joint = &model.joints[id.0];
            let outputs = sim.outputs();
            let q = outputs.coordinate(0, model.coordinate_range(id).start);
            let pivot = outputs
                .body_pose(0, joint.child)
                .point(joint.child_frame.position);
            let (mut weight, mut moment) = (0.0, 0.0);
            for body in &bodies[i..] {
                let own = &model.bodies[body.0];
                let center = outputs.body_pose(0, *body).point(own.center);
                weight += own.mass * G;
                moment += own.mass * G * (center.x - pivot.x);
            }
            let drive = joint.dofs[0].drive;
            let torque = drive.stiffness * (drive.target_position - q);
            close(
                format!("{solver:?}: torque of {name}"),
                torque,
                moment,
                1e-3 * moment,
            );
            let (force, torque) = outputs.reaction(0, id);
            near(
                format!("{solver:?}: force in {name}"),
                force,
                DVec3::Y * weight,
                1e-3 * weight,
            );
            near(
                format!("{solver:?}: torque in {name}"),
                torque,
                DVec3::Z * moment,
                1e-3 * moment,
            );
        }
        let all = model.total_mass() * G;
        let ground = force(&mut sim, None, base);
        near(
            format!("{solver:?}: ground"),
            ground,
            DVec3::Y * all,
            1e-3 * all,
        );
    }
}

/// A robot of two links that floats freely strikes a ball with one of them: what momentum the ball has gained the robot
/// has lost. `xpbd` keeps both momenta to rounding.
#[test]
fn a_floating_robot_strikes_a_ball() {
    let mut world = Builder::new("striker");
    world.gravity(DVec3::ZERO);
    let rod = || {
        Shape::new(Geometry::Capsule {
            radius: 0.04,
            half_height: 0.25,
        })
    };
    let robot = world.object("robot");
    let trunk = robot.body("trunk").shape(rod()).mass(2.0).handle();
    let elbow = Pose::at(DVec3::Y * 0.25);
    let lying = DQuat::from_rotation_z(-FRAC_PI_2);
    let at = Pose::new(DVec3::new(0.25, 0.25, 0.0), lying);
    let arm = robot.body("arm").at(at).shape(rod()).mass(1.0).handle();
    robot
        .revolute("elbow", arm, DVec3::Z)
        .parent(trunk)
        .at(elbow);
    let ball = Shape::new(Geometry::Sphere { radius: 0.1 });
    let at = Pose::at(DVec3::new(0.4, -0.05, 0.0));
    let things = world.object("things");
    let ball = things.body("ball").at(at).shape(ball).mass(1.0).handle();
    things.free("float", ball);
    let model = world.build().unwrap();
    let ball = model.body("ball").unwrap();
    let elbow = model.dof_range(model.joint("elbow").unwrap()).start;
    for solver in SOLVERS {
        let run = |h: f64| {
            let settings = SimulationSettings {
                solver,
                threads: 1,
                ..SimulationSettings::new(1, h)
            };
            let mut sim = Simulation::<f64>::new(model.clone(), settings).unwrap();
            let mut velocity = vec![0.0; model.degrees_of_freedom()];
            velocity[elbow] = -8.0;
            sim.set_joint_state(0, &model.initial_position(), &velocity)
                .unwrap();
            let outputs = sim.outputs();
            let before = (outputs.momentum(0), outputs.angular_momentum(0));
            sim.step((0.2 / h) as usize);
            let outputs = sim.outputs();
            let hit = outputs.body_velocity(0, ball).length();
            assert!(hit > 0.5, "{solver:?}: the ball is hit: {hit} m/s");
            let linear = (outputs.momentum(0) - before.0).length();
            let angular = (outputs.angular_momentum(0) - before.1).length();
            [linear / before.0.length(), angular / before.1.length()]
        };
        let (coarse, fine) = (run(H), run(0.25 * H));
        println!("{solver:?}: {coarse:?} {fine:?}");
        for (coarse, fine) in coarse.into_iter().zip(fine) {
            if solver == SolverKind::Xpbd {
                assert!(coarse.max(fine) < 1e-11, "{coarse} {fine}");
            } else {
                // First order in h.
                assert!(coarse < 0.02 && fine < 0.5 * coarse, "{coarse} {fine}");
            }
        }
    }
}
