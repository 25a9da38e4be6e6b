//! Models with something of everything.

use glam::{DMat3, DQuat, DVec3};
use model::{
    Axis, BodyHandle, Builder, Drive, Geometry, Hull, Limit, Material, Model, ModelError, Object,
    Pose, Shape,
};
use std::f64::consts::FRAC_PI_2;

fn rod(object: &mut Object, name: &str, mass: f64) -> BodyHandle {
    let shape = Geometry::Capsule {
        radius: 0.03,
        half_height: 0.2,
    };
    object.body(name).shape(shape).mass(mass).handle()
}

/// Two trees with joints of every kind that a tree can have, and everything
/// that acts along a degree of freedom; `reduced` with what only reduced
/// coordinates take: hinges that do not meet, armature and a motor on a ball.
pub fn mixed(reduced: bool) -> Result<Model, ModelError> {
    let (top, bottom) = (Pose::at(DVec3::Y * 0.2), Pose::at(DVec3::Y * -0.2));
    let tilted = Pose::new(DVec3::new(0.1, -0.2, 0.05), DQuat::from_rotation_x(0.6));
    let mut world = Builder::new("mixed");
    let robot = world.object("robot");

    let trunk = rod(robot, "trunk", 2.0);
    robot
        .free("float", trunk)
        .initial(&[0.1, 1.0, -0.2, 0.0, 0.6, 0.0, 0.8]);

    let arm = rod(robot, "arm", 1.0);
    let drive = Drive {
        stiffness: 30.0,
        damping: 2.0,
        target_position: 0.4,
        effort_limit: 8.0,
        control_time: 0.02,
        ..Drive::default()
    };
    let limit = Limit {
        lower: -0.3,
        upper: 0.3,
        stiffness: 50.0,
        damping: 1.0,
        inertia: 0.0,
    };
    let shoulder = robot
        .revolute("shoulder", arm, DVec3::Z)
        .parent(trunk)
        .frames(tilted, top);
    shoulder
        .initial(&[0.35])
        .armature(0.02)
        .limit(limit)
        .drive(drive)
        .friction_loss(0.1);
    let shoulder = shoulder.handle();

    let fist = Geometry::Sphere { radius: 0.1 };
    let hand = robot.body("hand").shape(fist).mass(0.5).handle();
    let drive = Drive {
        stiffness: 4.0,
        damping: 0.2,
        target_position: 0.3,
        ..Drive::default()
    };
    let wrist = robot.ball("wrist", hand).parent(arm).frames(bottom, top);
    let wrist = wrist
        .initial(&[0.36, 0.0, 0.48, 0.8])
        .damping(0.05)
        .drive(drive)
        .armature(if reduced { 0.01 } else { 0.0 })
        .handle();

    let tail = rod(robot, "tail", 0.7);
    let limit = Limit {
        lower: -0.05,
        upper: 0.1,
        stiffness: 900.0,
        damping: 3.0,
        inertia: 0.3,
    };
    let slide = robot
        .prismatic("slide", tail, DVec3::X)
        .parent(trunk)
        .frames(bottom, tilted);
    let slide = slide
        .initial(&[0.02])
        .limit(limit)
        .spring(200.0, 0.03)
        .handle();

    let tag = rod(robot, "tag", 0.1);
    robot.fixed("weld", tag).parent(tail).frames(bottom, tilted);

    let fin = rod(robot, "fin", 0.4);
    let last = Axis {
        anchor: if reduced { DVec3::X * 0.1 } else { DVec3::ZERO },
        ..Axis::angular(DVec3::Z)
    };
    let axes = [Axis::linear(DVec3::X), Axis::angular(DVec3::Y), last];
    let d6 = robot.d6("d6", fin, &axes).parent(tag).frames(bottom, top);
    d6.initial(&[0.01, 0.2, -0.3]).damping(0.3).armature(0.01);

    let wheel = rod(robot, "wheel", 0.3);
    let axle = robot
        .revolute("axle", wheel, DVec3::X)
        .parent(trunk)
        .frames(top, bottom);
    let axle = axle.initial(&[2.9]).armature(0.01).handle();

    robot
        .motor("shoulder_motor", shoulder)
        .gear(3.0)
        .control_range(-0.5, 0.5);
    robot
        .position_servo("slide_servo", slide, 80.0, 2.0)
        .force_range(-5.0, 5.0);
    robot.velocity_servo("axle_servo", axle, 0.6);
    if reduced {
        robot.motor("wrist_motor", wrist).dof(1).gear(0.2);
    }

    let cart = world.object("cart");
    let body = rod(cart, "body", 1.5);
    let drive = Drive {
        damping: 0.7,
        target_velocity: 4.0,
        ..Drive::default()
    };
    let ground = cart
        .plane_xz("ground", body)
        .initial(&[0.3, 0.1, 3.0])
        .armature(0.01);
    ground.dofs_mut()[2].drive = drive;
    let inertia = DMat3::from_diagonal(DVec3::new(0.01, 0.02, 0.025));
    cart.body("block")
        .inertia(1.0, DVec3::new(0.02, 0.0, 0.01), inertia);
    cart.body("wall").immovable();
    world.build()
}

/// A loop of four bars with a soft stay across, and a coupled pair of hinges beside it.
pub fn looped() -> Result<Model, ModelError> {
    let (top, bottom) = (Pose::at(DVec3::Y * 0.2), Pose::at(DVec3::Y * -0.2));
    let mut world = Builder::new("looped");
    let frame = world.object("frame");
    let [left, across, right] = ["left", "across", "right"].map(|name| rod(frame, name, 1.0));
    let turned = Pose::new(DVec3::Y * -0.2, DQuat::from_rotation_z(FRAC_PI_2));
    frame
        .revolute("hung", left, DVec3::Z)
        .frames(Pose::IDENTITY, top);
    frame
        .revolute("bent", across, DVec3::Z)
        .parent(left)
        .frames(turned, top);
    frame
        .revolute("bend", right, DVec3::Z)
        .parent(across)
        .frames(turned, top);
    let closing = frame.revolute("closing", right, DVec3::Z).closes_loop(true);
    closing.frames(Pose::at(DVec3::X * 0.4), bottom);
    let stay = frame.distance("stay", right, 0.5).parent(left);
    stay.frames(bottom, bottom).compliance(1e-4, 0.0);

    let gears = world.object("gears");
    let hinges = ["driver", "follower"].map(|name| {
        let wheel = rod(gears, name, 0.5);
        let hinge = gears.revolute(format!("{name}_hinge"), wheel, DVec3::X);
        hinge.at(Pose::at(DVec3::new(1.0, 0.2, 0.0))).handle()
    });
    gears.couple("teeth", hinges[1], hinges[0], -2.0, 0.1);
    gears.motor("engine", hinges[0]);
    world.build()
}

/// A ball, a capsule, a box, a wedge and a hinged pair of capsules above the ground, close together.
#[allow(dead_code)] // one of the tests that share this file needs it
pub fn heap() -> Result<Model, ModelError> {
    let mut world = Builder::new("heap");
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    world.object("ground").scenery(Shape::new(plane));
    let bodies = world.object("bodies");
    let solids = [
        Geometry::Sphere { radius: 0.1 },
        Geometry::Capsule {
            radius: 0.06,
            half_height: 0.15,
        },
        Geometry::Box {
            half: DVec3::new(0.1, 0.05, 0.08),
        },
        Geometry::Hull(wedge()?),
    ];
    for (i, solid) in solids.into_iter().enumerate() {
        let at = DVec3::new(0.02 * i as f64, 0.2 + 0.2 * i as f64, 0.01 * i as f64);
        let name = format!("body_{i}");
        let material = Material {
            torsional_friction: 0.01,
            rolling_friction: 0.002,
            ..Material::default()
        };
        let solid = Shape::new(solid).with_material(material);
        bodies.body(name).at(Pose::at(at)).shape(solid);
    }
    let (upper, lower) = (rod(bodies, "upper", 1.0), rod(bodies, "lower", 1.0));
    bodies
        .free("float", upper)
        .initial(&[0.1, 0.9, 0.0, 0.6, 0.0, 0.0, 0.8]);
    let (top, bottom) = (Pose::at(DVec3::Y * 0.2), Pose::at(DVec3::Y * -0.2));
    bodies
        .revolute("elbow", lower, DVec3::Z)
        .parent(upper)
        .frames(bottom, top);
    world.build()
}

/// Six corners, above the origin.
fn wedge() -> Result<Hull, ModelError> {
    let end = |z| [(-0.1, 0.0), (0.1, 0.0), (0.05, 0.12)].map(|(x, y)| DVec3::new(x, y, z));
    Ok(Hull::new(&[end(-0.06), end(0.07)].concat())?)
}
