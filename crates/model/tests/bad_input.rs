//! Every fault of a model is refused with a message that names the culprit and the remedy.

use glam::{DMat3, DQuat, DVec3};
use kinetarium_model::{
    Actuator, Axis, Body, BodyId, BodyKind, Builder, Camera, CameraMode, ContactPair, Coupling,
    Drive, Geometry, Joint, JointId, JointKind, Keyframe, Lamp, LampKind, Limit, Material,
    Measurand, Model, ModelError, Mount, Parts, Pose, Sensor, Shape, ShapeId, Softness, examples,
};

/// A base, two links on a hinge and a slider, a loop to close, and one of everything else.
fn sound() -> Parts {
    let base = Body {
        kind: BodyKind::Static,
        ..Body::new("base")
    };
    let bodies = vec![base, Body::new("upper"), Body::new("lower")];
    let joint = |name: &str, kind, parent, child, axis| {
        Joint::new(name, kind, Some(BodyId(parent)), BodyId(child), vec![axis])
    };
    let hinge = joint("hinge", JointKind::Revolute, 0, 1, Axis::angular(DVec3::Z));
    let slider = joint("slider", JointKind::Prismatic, 1, 2, Axis::linear(DVec3::X));
    let mut strut = joint("strut", JointKind::Revolute, 0, 2, Axis::angular(DVec3::Z));
    strut.closes_loop = true;
    Parts {
        name: "machine".into(),
        bodies,
        shapes: vec![Shape {
            body: Some(BodyId(1)),
            ..Shape::new(Geometry::Sphere { radius: 0.1 }).named("knob")
        }],
        joints: vec![hinge, slider, strut],
        couplings: vec![Coupling {
            name: "gears".into(),
            joint: JointId(0),
            other: JointId(1),
            ratio: 2.0,
            offset: 0.0,
        }],
        actuators: vec![Actuator::motor("motor", JointId(0))],
        keyframes: vec![Keyframe {
            name: "home".into(),
            joint_position: vec![0.0; 2],
            joint_velocity: vec![0.0; 2],
            control: vec![0.0],
        }],
        cameras: vec![Camera {
            name: "eye".into(),
            body: Some(BodyId(2)),
            mode: CameraMode::Fixed,
            pose: Pose::IDENTITY,
            field_of_view: 1.0,
            size: Some([640, 480]),
        }],
        ..Parts::default()
    }
}

type Case = (fn(&mut Parts), &'static str);

fn refuses(cases: &[Case]) {
    for (spoil, message) in cases {
        let mut parts = sound();
        spoil(&mut parts);
        let error = Model::new(parts).expect_err(message);
        assert_eq!(error.to_string(), *message);
    }
}

fn diagonal(x: f64, y: f64, z: f64) -> DMat3 {
    DMat3::from_diagonal(DVec3::new(x, y, z))
}

#[test]
fn accepts_the_sound_model() {
    Model::new(sound()).unwrap();
}

#[test]
fn settings() {
    refuses(&[
        (
            |p| p.time_step = 0.0,
            "model \"machine\": time step [s] is 0; it must be above zero",
        ),
        (
            |p| p.time_step = -1e-3,
            "model \"machine\": time step [s] is -0.001; it must be above zero",
        ),
        (
            |p| p.time_step = f64::NAN,
            "model \"machine\": time step [s] is NaN; give a finite number",
        ),
        (
            |p| p.gravity.y = f64::NEG_INFINITY,
            "model \"machine\": gravity [m/s²] is -inf; give a finite number",
        ),
        (
            |p| p.worlds = 0,
            "the model asks for 0 worlds; ask for at least 1",
        ),
    ]);
}

#[test]
fn absurd_sizes() {
    refuses(&[
        (
            |p| p.worlds = usize::MAX,
            "the model has 18446744073709551615 worlds, more than the 10000000 it may have; \
             check the number, or split the model",
        ),
        (
            |p| p.bodies = vec![Body::new("b"); 1_000_001],
            "the model has 1000001 bodies, more than the 1000000 it may have; \
             check the number, or split the model",
        ),
        (
            |p| p.shapes = vec![Shape::new(Geometry::Sphere { radius: 1.0 }); 1_000_001],
            "the model has 1000001 shapes, more than the 1000000 it may have; \
             check the number, or split the model",
        ),
    ]);
}

#[test]
fn names() {
    refuses(&[
        (
            |p| p.bodies[1].name.clear(),
            "body number 1 has no name; give it one",
        ),
        (
            |p| p.joints[0].name.clear(),
            "joint number 0 has no name; give it one",
        ),
        (
            |p| p.joints[1].dofs[0].name.clear(),
            "degree of freedom number 1 has no name; give it one",
        ),
        (
            |p| p.keyframes[0].name.clear(),
            "keyframe number 0 has no name; give it one",
        ),
        (
            |p| p.bodies[2].name = "upper".into(),
            "two of kind body are named \"upper\"; rename one",
        ),
        (
            |p| p.joints[1].name = "hinge".into(),
            "two of kind joint are named \"hinge\"; rename one",
        ),
        (
            |p| p.joints[1].dofs[0].name = "hinge".into(),
            "two of kind degree of freedom are named \"hinge\"; rename one",
        ),
        (
            |p| p.actuators.push(p.actuators[0].clone()),
            "two of kind actuator are named \"motor\"; rename one",
        ),
        (
            |p| p.couplings.push(p.couplings[0].clone()),
            "two of kind coupling are named \"gears\"; rename one",
        ),
        (
            |p| p.keyframes.push(p.keyframes[0].clone()),
            "two of kind keyframe are named \"home\"; rename one",
        ),
    ]);
}

#[test]
fn masses() {
    refuses(&[
        (
            |p| p.bodies[1].mass = 0.0,
            "body \"upper\": mass [kg] is 0; it must be above zero",
        ),
        (
            |p| p.bodies[1].mass = -2.0,
            "body \"upper\": mass [kg] is -2; it must be above zero",
        ),
        (
            |p| p.bodies[1].mass = f64::NAN,
            "body \"upper\": mass [kg] is NaN; give a finite number",
        ),
        (
            |p| p.bodies[1].center.z = f64::INFINITY,
            "body \"upper\": centre of mass [m] is inf; give a finite number",
        ),
        (
            |p| p.bodies[1].inertia.x_axis.x = f64::NAN,
            "body \"upper\": inertia [kg·m²] is NaN; give a finite number",
        ),
        (
            |p| p.bodies[1].inertia.x_axis.y = 0.25,
            "body \"upper\": its inertia matrix is not symmetric (entries differ by 0.25); \
             write equal products of inertia on both sides",
        ),
        (
            |p| p.bodies[1].inertia = diagonal(1.0, -0.5, 1.0),
            "body \"upper\": its smallest principal moment of inertia is -0.5 kg·m², but all three \
             must be above zero; check the signs and units",
        ),
        (
            |p| p.bodies[1].inertia = DMat3::ZERO,
            "body \"upper\": its smallest principal moment of inertia is 0 kg·m², but all three \
             must be above zero; check the signs and units",
        ),
        (
            |p| p.bodies[1].inertia = diagonal(3.0, 1.0, 1.0),
            "body \"upper\": its principal moments of inertia [1.0, 1.0, 3.0] kg·m² belong to no \
             solid: the largest exceeds the sum of the others by more than 1e-6 of itself; correct \
             them (files written with few digits sometimes violate this slightly; setting all \
             three to their mean also helps)",
        ),
    ]);
}

#[test]
fn inertia_of_few_digits_passes() {
    let mut parts = sound();
    parts.bodies[1].inertia = diagonal(2.000001, 1.0, 1.0);
    Model::new(parts).unwrap();
}

#[test]
fn poses_and_worlds() {
    refuses(&[
        (
            |p| p.bodies[0].pose.position.x = f64::NAN,
            "body \"base\": pose is NaN; give a finite number",
        ),
        (
            |p| p.bodies[0].pose.orientation = DQuat::from_xyzw(0.0, 0.0, 0.0, 2.0),
            "body \"base\": quaternion of its pose has length 2; normalise it (1 within 1e-6)",
        ),
        (
            |p| p.bodies[0].pose.orientation = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0),
            "body \"base\": quaternion of its pose has length zero and so no direction; give one; no rotation is (0, 0, 0, 1)",
        ),
        (
            |p| p.bodies[1].world = -2,
            "body \"upper\": world is -2; it must lie from -1 to 2147483647",
        ),
        (
            |p| p.bodies[2].world = 1,
            "joint \"slider\": its parent stands in world 0, its child in world 1; put both in \
             one world, or the parent in world -1, which all share",
        ),
    ]);
}

#[test]
fn shapes() {
    refuses(&[
        (
            |p| p.shapes[0].body = Some(BodyId(7)),
            "shape \"knob\": its body is number 7, but the model has 3, numbered from 0; \
             use a number below 3",
        ),
        (
            |p| p.shapes[0].geometry = Geometry::Sphere { radius: 0.0 },
            "shape \"knob\": radius [m] is 0; it must be above zero",
        ),
        (
            |p| {
                p.shapes[0].geometry = Geometry::Plane {
                    half_x: -1.0,
                    half_z: 1.0,
                }
            },
            "shape \"knob\": half size along x [m] is -1; it must not be negative",
        ),
        (
            |p| {
                p.shapes[0].geometry = Geometry::Cylinder {
                    radius: 1.0,
                    half_height: -1.0,
                }
            },
            "shape \"knob\": half height [m] is -1; it must be above zero",
        ),
        (
            |p| {
                p.shapes[0].geometry = Geometry::Cone {
                    radius: f64::NAN,
                    half_height: 1.0,
                }
            },
            "shape \"knob\": radius [m] is NaN; give a finite number",
        ),
        (
            |p| {
                p.shapes[0].geometry = Geometry::Capsule {
                    radius: 1.0,
                    half_height: 1.0,
                }
            },
            "shape \"knob\": the capsule's half height 1, caps included, must be at least 1.01 \
             times its radius 1; lengthen it or use a sphere",
        ),
        (
            |p| {
                p.shapes[0].geometry = Geometry::Box {
                    half: DVec3::new(1.0, 0.0, 1.0),
                }
            },
            "shape \"knob\": half extent [m] is 0; it must be above zero",
        ),
        (
            |p| {
                p.shapes[0].geometry = Geometry::Ellipsoid {
                    half: DVec3::new(1.0, 1.0, -1.0),
                }
            },
            "shape \"knob\": half axis [m] is -1; it must be above zero",
        ),
        (
            |p| {
                p.shapes[0].geometry = Geometry::MeshFile {
                    file: String::new(),
                    scale: DVec3::ONE,
                }
            },
            "shape \"knob\": the mesh names no file; give its path",
        ),
        (
            |p| {
                p.shapes[0].geometry = Geometry::MeshFile {
                    file: "a.stl".into(),
                    scale: DVec3::X,
                }
            },
            "shape \"knob\": scale without its sign is 0; it must be above zero",
        ),
        (
            |p| {
                p.shapes[0].name.clear();
                p.shapes[0].density = -1.0;
            },
            "shape: density [kg/m³] is -1; it must not be negative",
        ),
        (
            |p| p.shapes[0].material.friction = -0.1,
            "shape \"knob\": friction is -0.1; it must not be negative",
        ),
        (
            |p| p.shapes[0].material.static_friction = Some(f64::NAN),
            "shape \"knob\": static friction is NaN; give a finite number",
        ),
        (
            |p| p.shapes[0].material.static_friction = Some(-0.5),
            "shape \"knob\": static friction is -0.5; it must not be negative",
        ),
        (
            |p| p.shapes[0].material.static_friction = Some(0.4),
            "shape \"knob\": static friction is 0.4, less than the friction 0.5 of what slides; \
             give at least that, or none",
        ),
        (
            |p| p.shapes[0].material.restitution = 1.5,
            "shape \"knob\": restitution is 1.5; it must lie from 0 to 1",
        ),
        (
            |p| p.shapes[0].material.margin = f64::INFINITY,
            "shape \"knob\": margin [m] is inf; give a finite number",
        ),
        (
            |p| p.shapes[0].color = Some([0.5, 0.5, 0.5, 2.0]),
            "shape \"knob\": colour is 2; it must lie from 0 to 1",
        ),
        (
            |p| p.shapes[0].color = Some([f32::NAN, 0.5, 0.5, 1.0]),
            "shape \"knob\": colour is NaN; give a finite number",
        ),
    ]);
}

#[test]
fn softness_of_contacts() {
    refuses(&[
        (
            |p| p.shapes[0].material.softness = time(0.0, 1.0, 0.0),
            "shape \"knob\": time constant of contact [s] is 0; it must be above zero",
        ),
        (
            |p| p.shapes[0].material.softness = time(0.02, -1.0, 0.0),
            "shape \"knob\": damping ratio of contact is -1; it must be above zero",
        ),
        (
            |p| p.shapes[0].material.softness = time(f64::NAN, 1.0, 0.0),
            "shape \"knob\": time constant of contact [s] is NaN; give a finite number",
        ),
        (
            |p| p.shapes[0].material.softness = time(0.02, 1.0, 1.0),
            "shape \"knob\": impedance of contact is 1; it must lie from 0 to 0.9999",
        ),
        (
            |p| p.shapes[0].material.softness = time(0.02, 1.0, -0.1),
            "shape \"knob\": impedance of contact is -0.1; it must lie from 0 to 0.9999",
        ),
        (
            |p| p.shapes[0].material.softness = spring(0.0, 1.0),
            "shape \"knob\": stiffness of contact [N/m] is 0; it must be above zero",
        ),
        (
            |p| p.shapes[0].material.softness = spring(f64::INFINITY, 1.0),
            "shape \"knob\": stiffness of contact [N/m] is inf; give a finite number",
        ),
        (
            |p| p.shapes[0].material.softness = spring(1e4, -1.0),
            "shape \"knob\": damping of contact [N·s/m] is -1; it must not be negative",
        ),
        (
            |p| p.shapes[0].material.softness = weighing(0.0),
            "shape \"knob\": mass of contact [kg] is 0; it must be above zero",
        ),
    ]);
}

fn time(constant: f64, ratio: f64, impedance: f64) -> Softness {
    Softness::Time {
        constant,
        ratio,
        impedance,
        mass: None,
    }
}

fn weighing(mass: f64) -> Softness {
    Softness::Time {
        constant: 0.1,
        ratio: 1.0,
        impedance: 0.0,
        mass: Some(mass),
    }
}

fn spring(stiffness: f64, damping: f64) -> Softness {
    Softness::Spring { stiffness, damping }
}

#[test]
fn exclusions() {
    refuses(&[
        (
            |p| p.exclusions = vec![(Some(BodyId(0)), BodyId(2)), (None, BodyId(3))],
            "exclusion \"1\": its body is number 3, but the model has 3, numbered from 0; use a \
             number below 3",
        ),
        (
            |p| p.exclusions = vec![(Some(BodyId(9)), BodyId(1))],
            "exclusion \"0\": its body is number 9, but the model has 3, numbered from 0; use a \
             number below 3",
        ),
        (
            |p| p.exclusions = vec![(Some(BodyId(1)), BodyId(1))],
            "exclusion \"0\": both of its bodies are \"upper\"; name two different bodies",
        ),
    ]);
}

fn contact_pair(a: usize, b: usize) -> ContactPair {
    ContactPair::new((ShapeId(a), ShapeId(b)), Material::default())
}

fn pair_up(parts: &mut Parts, pairs: Vec<ContactPair>) {
    parts.shapes.push(parts.shapes[0].clone().named("other"));
    parts.contact_pairs = pairs;
}

#[test]
fn contact_pairs() {
    refuses(&[
        (
            |p| pair_up(p, vec![contact_pair(0, 2)]),
            "contact pair \"0\": its shape is number 2, but the model has 2, numbered from 0; use \
             a number below 2",
        ),
        (
            |p| pair_up(p, vec![contact_pair(1, 1)]),
            "contact pair \"0\": both of its shapes are number 1; name two different shapes",
        ),
        (
            |p| pair_up(p, vec![contact_pair(0, 1), contact_pair(1, 0)]),
            "contact pairs 0 and 1 are of the same two shapes; remove one",
        ),
        (
            |p| {
                let mut pair = contact_pair(0, 1);
                pair.material.friction = -0.1;
                pair_up(p, vec![pair]);
            },
            "contact pair \"0\": friction is -0.1; it must not be negative",
        ),
    ]);
}

#[test]
fn the_shortest_capsule_passes() {
    for radius in [0.1, 0.3, 1.0, 7.0] {
        let mut parts = sound();
        parts.shapes[0].geometry = Geometry::Capsule {
            radius,
            half_height: 1.01 * radius,
        };
        Model::new(parts).unwrap();
    }
}

/// Hinges side by side, an axis between, and inertia of its own tell how far each of two parallel axes moves.
#[test]
fn parallel_axes_that_are_apart_are_taken() {
    let turn = |anchor: DVec3| {
        let mut axis = Axis::angular(DVec3::Z);
        axis.anchor = anchor;
        axis
    };
    let across = Axis::angular(DVec3::X);
    let refused = |axes: Vec<Axis>, armature: f64| {
        let mut parts = sound();
        parts.joints[0] = Joint::new("hinge", JointKind::D6, None, BodyId(1), axes);
        parts.joints[0].dofs[1].armature = armature;
        matches!(Model::new(parts), Err(ModelError::SameAxis { .. }))
    };
    let origin = DVec3::ZERO;
    assert!(
        refused(vec![turn(origin), turn(DVec3::Z)], 0.0),
        "the same line"
    );
    assert!(!refused(vec![turn(origin), turn(DVec3::X)], 0.0), "apart");
    assert!(
        !refused(vec![turn(origin), across, turn(origin)], 0.0),
        "with another between"
    );
    assert!(
        !refused(vec![turn(origin), turn(origin)], 0.1),
        "with a mass of its own"
    );
}

#[test]
fn joint_ends() {
    refuses(&[
        (
            |p| p.joints[0].child = BodyId(3),
            "joint \"hinge\": its child body is number 3, but the model has 3, numbered from 0; \
             use a number below 3",
        ),
        (
            |p| p.joints[0].parent = Some(BodyId(9)),
            "joint \"hinge\": its parent body is number 9, but the model has 3, numbered from 0; \
             use a number below 3",
        ),
        (
            |p| p.joints[1].parent = Some(BodyId(2)),
            "joint \"slider\": body \"lower\" is both parent and child; name two different bodies",
        ),
        (
            |p| p.joints[0].child = BodyId(0),
            "joint \"hinge\": its child \"base\" is static; make the body dynamic, or swap parent \
             and child",
        ),
        (
            |p| p.joints[2].closes_loop = false,
            "joint \"strut\": its child \"lower\" already hangs on joint \"slider\"; mark the \
             joint closes_loop, merge the two into one d6 joint, or swap its parent and child",
        ),
        (
            |p| p.joints[0].parent = Some(BodyId(2)),
            "the bodies \"upper\", \"lower\" hang on one another in a circle; mark one of their \
             joints closes_loop",
        ),
    ]);
}

#[test]
fn joint_frames_and_numbers() {
    refuses(&[
        (
            |p| p.joints[0].parent_frame.position.y = f64::NAN,
            "joint \"hinge\": parent frame is NaN; give a finite number",
        ),
        (
            |p| p.joints[0].child_frame.orientation = DQuat::from_xyzw(0.5, 0.0, 0.0, 0.0),
            "joint \"hinge\": quaternion of its child frame has length 0.5; normalise it (1 within 1e-6)",
        ),
        (
            |p| p.joints[0].linear_compliance = -1.0,
            "joint \"hinge\": linear compliance [m/N] is -1; it must not be negative",
        ),
        (
            |p| p.joints[0].angular_compliance = f64::INFINITY,
            "joint \"hinge\": angular compliance [rad/(N·m)] is inf; give a finite number",
        ),
        (
            |p| {
                let mut rope = Joint::new("rope", JointKind::Distance, None, BodyId(1), vec![]);
                rope.length = -0.5;
                p.joints.push(rope);
            },
            "joint \"rope\": length [m] is -0.5; it must not be negative",
        ),
    ]);
}

#[test]
fn axes() {
    refuses(&[
        (
            |p| p.joints[0].axes.clear(),
            "joint \"hinge\": a revolute joint needs exactly one angular axis, but it has 0 linear \
             and 0 angular",
        ),
        (
            |p| p.joints[0].axes = vec![Axis::linear(DVec3::X)],
            "joint \"hinge\": a revolute joint needs exactly one angular axis, but it has 1 linear \
             and 0 angular",
        ),
        (
            |p| p.joints[1].axes = vec![Axis::linear(DVec3::X); 2],
            "joint \"slider\": a prismatic joint needs exactly one linear axis, but it has 2 \
             linear and 0 angular",
        ),
        (
            |p| p.joints[0].kind = JointKind::Ball,
            "joint \"hinge\": a ball joint takes no axes, but it has 0 linear and 1 angular",
        ),
        (
            |p| p.joints[0].kind = JointKind::PlaneXz,
            "joint \"hinge\": a plane_xz joint needs two linear axes and an angular one, but it \
             has 0 linear and 1 angular",
        ),
        (
            |p| {
                let mut axes = Joint::plane_xz_axes();
                axes.swap(0, 1);
                p.joints[0] = Joint::new("hinge", JointKind::PlaneXz, None, BodyId(1), axes);
            },
            "joint \"hinge\": the axes of a plane_xz joint are linear x, linear z and angular y, \
             in this order; use Joint::plane_xz_axes and turn the joint frames instead",
        ),
        (
            |p| {
                let axes = vec![Axis::angular(DVec3::X); 4];
                p.joints[0] = Joint::new("hinge", JointKind::D6, None, BodyId(1), axes);
            },
            "joint \"hinge\": a d6 joint needs 1 to 6 axes, at most 3 linear and at most 3 \
             angular, but it has 0 linear and 4 angular",
        ),
        (
            |p| {
                let axes = [DVec3::X, DVec3::Z, -DVec3::Z].map(Axis::angular).to_vec();
                p.joints[0] = Joint::new("hinge", JointKind::D6, None, BodyId(1), axes);
            },
            "joint \"hinge\": its axes 1 and 2 are the same line, so that nothing tells how far each of them moves: \
             leave one out, or give one an armature",
        ),
        (
            |p| p.joints[0].axes[0].direction = DVec3::new(1.0, 1.0, 0.0),
            "joint \"hinge\": axis direction has length 1.4142135623730951; normalise it (1 within \
             1e-6)",
        ),
        (
            |p| p.joints[0].axes[0].direction = DVec3::ZERO,
            "joint \"hinge\": axis direction has length zero and so no direction; give one, such \
             as (0, 1, 0)",
        ),
        (
            |p| p.joints[0].axes[0].anchor.x = f64::NAN,
            "joint \"hinge\": axis anchor [m] is NaN; give a finite number",
        ),
        (
            |p| p.joints[0].axes[0].reference = f64::NAN,
            "joint \"hinge\": axis reference is NaN; give a finite number",
        ),
    ]);
}

#[test]
fn coordinates() {
    refuses(&[
        (
            |p| p.joints[0].dofs.clear(),
            "joint \"hinge\": its table of degrees of freedom has 0 entries; it needs 1",
        ),
        (
            |p| p.joints[0].initial = vec![0.0, 1.0],
            "joint \"hinge\": its list of initial coordinates has 2 entries; it needs 1",
        ),
        (
            |p| p.joints[0].initial[0] = f64::NAN,
            "joint \"hinge\": initial coordinate is NaN; give a finite number",
        ),
        (
            |p| {
                p.joints[1] = Joint::new("slider", JointKind::Ball, None, BodyId(2), vec![]);
                p.couplings.clear();
                p.joints[1].initial = vec![0.0; 4];
            },
            "joint \"slider\": quaternion of its coordinates has length zero and so no direction; give one; \
             no rotation is (0, 0, 0, 1)",
        ),
        (
            |p| {
                p.joints[1] = Joint::new("slider", JointKind::Free, None, BodyId(2), vec![]);
                p.couplings.clear();
                p.joints[1].initial[6] = 3.0;
            },
            "joint \"slider\": quaternion of its coordinates has length 3; normalise it (1 within 1e-6)",
        ),
    ]);
}

#[test]
fn degrees_of_freedom() {
    refuses(&[
        (
            |p| p.joints[0].dofs[0].stiffness = -1.0,
            "degree of freedom \"hinge\": stiffness is -1; it must not be negative",
        ),
        (
            |p| p.joints[0].dofs[0].damping = -1.0,
            "degree of freedom \"hinge\": damping is -1; it must not be negative",
        ),
        (
            |p| p.joints[0].dofs[0].armature = f64::NAN,
            "degree of freedom \"hinge\": armature is NaN; give a finite number",
        ),
        (
            |p| p.joints[0].dofs[0].friction_loss = -1.0,
            "degree of freedom \"hinge\": friction loss is -1; it must not be negative",
        ),
        (
            |p| p.joints[0].dofs[0].rest = f64::INFINITY,
            "degree of freedom \"hinge\": rest is inf; give a finite number",
        ),
        (
            |p| {
                let limit = Limit {
                    lower: 1.0,
                    upper: -1.0,
                    stiffness: 1.0,
                    damping: 1.0,
                    inertia: 0.0,
                };
                p.joints[0].dofs[0].limit = Some(limit);
            },
            "degree of freedom \"hinge\": the lower end of its limit, 1, is above the upper end, \
             -1; swap them",
        ),
        (
            |p| {
                let limit = Limit {
                    lower: -1.0,
                    upper: 1.0,
                    stiffness: -1.0,
                    damping: 1.0,
                    inertia: 0.0,
                };
                p.joints[0].dofs[0].limit = Some(limit);
            },
            "degree of freedom \"hinge\": limit stiffness is -1; it must not be negative",
        ),
        (
            |p| {
                let limit = Limit {
                    lower: -1.0,
                    upper: 1.0,
                    stiffness: 1.0,
                    damping: 1.0,
                    inertia: f64::NAN,
                };
                p.joints[0].dofs[0].limit = Some(limit);
            },
            "degree of freedom \"hinge\": limit inertia is NaN; give a finite number",
        ),
        (
            |p| p.joints[0].dofs[0].drive.effort_limit = -1.0,
            "degree of freedom \"hinge\": drive effort limit is -1; it must not be negative",
        ),
        (
            |p| p.joints[0].dofs[0].drive.control_time = -0.1,
            "degree of freedom \"hinge\": drive control time [s] is -0.1; it must not be negative",
        ),
        (
            |p| p.joints[0].dofs[0].drive.target_position = f64::NAN,
            "degree of freedom \"hinge\": drive target position is NaN; give a finite number",
        ),
        (
            |p| {
                p.joints[0] = Joint::new("hinge", JointKind::Free, None, BodyId(1), vec![]);
                p.couplings.clear();
                p.joints[0].dofs[2].drive = Drive {
                    damping: 1.0,
                    ..Drive::default()
                };
            },
            "joint \"hinge\": a free joint takes no drive; remove it, or use a d6 joint",
        ),
        (
            |p| {
                p.joints[0] = Joint::new("hinge", JointKind::Free, None, BodyId(1), vec![]);
                p.couplings.clear();
                let limit = Limit {
                    lower: -1.0,
                    upper: 1.0,
                    stiffness: 1.0,
                    damping: 1.0,
                    inertia: 0.0,
                };
                p.joints[0].dofs[2].limit = Some(limit);
            },
            "joint \"hinge\": a free joint takes no limit; remove it, or use a d6 joint",
        ),
    ]);
}

#[test]
fn couplings_and_actuators() {
    refuses(&[
        (
            |p| p.couplings[0].joint = JointId(5),
            "coupling \"gears\": its joint is number 5, but the model has 3, numbered from 0; \
             use a number below 3",
        ),
        (
            |p| p.couplings[0].ratio = f64::NAN,
            "coupling \"gears\": ratio is NaN; give a finite number",
        ),
        (
            |p| p.couplings[0].other = JointId(0),
            "coupling \"gears\": joint \"hinge\" both leads and follows; name two different joints",
        ),
        (
            |p| p.joints[1] = Joint::new("slider", JointKind::Fixed, None, BodyId(2), vec![]),
            "coupling \"gears\": joint \"slider\" has 0 axes; couple joints with exactly one",
        ),
        (
            |p| p.actuators[0].joint = JointId(5),
            "actuator \"motor\": its joint is number 5, but the model has 3, numbered from 0; \
             use a number below 3",
        ),
        (
            |p| p.actuators[0].dof = 1,
            "actuator \"motor\": joint \"hinge\" has 1 degrees of freedom in the state, numbered \
             from 0, so not number 1; choose another",
        ),
        (
            |p| p.actuators[0].joint = JointId(2),
            "actuator \"motor\": joint \"strut\" has 0 degrees of freedom in the state, numbered \
             from 0, so not number 0; choose another joint, for this one closes a loop",
        ),
        (
            |p| p.actuators[0].gear = f64::NAN,
            "actuator \"motor\": gear is NaN; give a finite number",
        ),
        (
            |p| p.actuators[0].control_range = Some((1.0, 0.0)),
            "actuator \"motor\": the lower end of its control range, 1, is above the upper end, 0; \
             swap them",
        ),
        (
            |p| p.actuators[0].force_range = Some((0.0, f64::NAN)),
            "actuator \"motor\": force range is NaN; give a finite number",
        ),
    ]);
}

#[test]
fn lamps() {
    fn with(p: &mut Parts, change: fn(&mut Lamp)) {
        let (cutoff, exponent) = (0.8, 10.0);
        let mut lamp = Lamp::new("torch", LampKind::Spot { cutoff, exponent });
        change(&mut lamp);
        p.lamps.push(lamp);
    }
    refuses(&[
        (
            |p| (0..2).for_each(|_| with(p, |_| {})),
            "two of kind lamp are named \"torch\"; rename one",
        ),
        (
            |p| with(p, |l| l.body = Some(BodyId(3))),
            "lamp \"torch\": its body is number 3, but the model has 3, numbered from 0; use a number below 3",
        ),
        (
            |p| with(p, |l| l.pose.position.y = f64::NAN),
            "lamp \"torch\": pose is NaN; give a finite number",
        ),
        (
            |p| with(p, |l| l.color.y = -0.1),
            "lamp \"torch\": colour is -0.10000000149011612; it must not be negative",
        ),
        (
            |p| with(p, |l| l.attenuation = DVec3::ZERO),
            "lamp \"torch\": sum of its attenuation is 0; it must be above zero",
        ),
        (
            |p| {
                with(p, |l| {
                    l.kind = LampKind::Spot {
                        cutoff: 0.0,
                        exponent: 1.0,
                    }
                })
            },
            "lamp \"torch\": cutoff [rad] is 0; it must be above zero",
        ),
        (
            |p| {
                with(p, |l| {
                    l.kind = LampKind::Spot {
                        cutoff: 2.0,
                        exponent: 1.0,
                    }
                })
            },
            "lamp \"torch\": cutoff [rad] is 2; it must lie from 0 to 1.5707963267948966",
        ),
        (
            |p| {
                with(p, |l| {
                    l.kind = LampKind::Spot {
                        cutoff: 1.0,
                        exponent: 200.0,
                    }
                })
            },
            "lamp \"torch\": exponent is 200; it must lie from 0 to 128",
        ),
        (
            |p| p.lamps = vec![Lamp::new("torch", LampKind::Point); 300],
            "the model has 300 lamps, more than the 256 it may have; check the number, or split the model",
        ),
    ]);
}

#[test]
fn cameras() {
    refuses(&[
        (
            |p| p.cameras.push(p.cameras[0].clone()),
            "two of kind camera are named \"eye\"; rename one",
        ),
        (
            |p| p.cameras[0].body = Some(BodyId(3)),
            "camera \"eye\": its body is number 3, but the model has 3, numbered from 0; use a number below 3",
        ),
        (
            |p| p.cameras[0].pose.position.y = f64::INFINITY,
            "camera \"eye\": pose is inf; give a finite number",
        ),
        (
            |p| p.cameras[0].field_of_view = 3.2,
            "camera \"eye\": field of view [rad] is 3.2; it must lie from 0.000001 to 3.141591653589793",
        ),
        (
            |p| p.cameras[0].size = Some([640, 0]),
            "camera \"eye\": size [pixel] is 0; it must lie from 1 to 16384",
        ),
    ]);
}

#[test]
fn keyframes() {
    refuses(&[
        (
            |p| p.keyframes[0].joint_position.clear(),
            "keyframe \"home\": its list of joint positions has 0 entries; it needs 2 (bodies \
             without a joint get a free one, last in the order)",
        ),
        (
            |p| p.keyframes[0].joint_velocity.push(0.0),
            "keyframe \"home\": its list of joint velocities has 3 entries; it needs 2 (bodies \
             without a joint get a free one, last in the order)",
        ),
        (
            |p| p.keyframes[0].control.clear(),
            "keyframe \"home\": its list of controls has 0 entries; it needs 1",
        ),
        (
            |p| p.keyframes[0].joint_position[1] = f64::NAN,
            "keyframe \"home\": joint position is NaN; give a finite number",
        ),
        (
            |p| {
                p.joints[1] = Joint::new("slider", JointKind::Ball, None, BodyId(2), vec![]);
                p.couplings.clear();
                p.keyframes[0].joint_position = vec![0.0; 5];
                p.keyframes[0].joint_velocity = vec![0.0; 4];
            },
            "keyframe \"home\": quaternion of its coordinates has length zero and so no direction; give \
             one; no rotation is (0, 0, 0, 1)",
        ),
    ]);
}

#[test]
fn unknown_names() {
    let model = Model::new(sound()).unwrap();
    let message = |error: ModelError| error.to_string();
    assert_eq!(
        message(model.body("uper").unwrap_err()),
        "there is no body named \"uper\"; did you mean \"upper\"?"
    );
    assert_eq!(
        message(model.joint("xyz").unwrap_err()),
        "there is no joint named \"xyz\"; there are hinge, slider, strut"
    );
    assert_eq!(
        message(model.dof("sliders").unwrap_err()),
        "there is no degree of freedom named \"sliders\"; did you mean \"slider\"?"
    );
    assert_eq!(
        message(model.actuator("Motor").unwrap_err()),
        "there is no actuator named \"Motor\"; did you mean \"motor\"?"
    );
    let empty = Model::new(Parts::default()).unwrap();
    assert_eq!(
        message(empty.keyframe("home").unwrap_err()),
        "there is no keyframe named \"home\"; there are none"
    );
    let chain = examples::n_pendula(21).unwrap();
    let told = message(chain.body("zzz").unwrap_err());
    assert!(told.starts_with("there is no body named \"zzz\"; there are link0, link1, "));
    assert!(told.ends_with(", link19, …"), "{told}");
}

const BALL: Geometry = Geometry::Sphere { radius: 0.1 };

fn build_error(make: impl Fn(&mut Builder) -> Result<(), ModelError>) -> String {
    let mut world = Builder::new("world");
    make(&mut world)
        .and_then(|()| world.build().map(drop))
        .unwrap_err()
        .to_string()
}

#[test]
fn builder_masses() {
    let massless = build_error(|world| {
        world.object("thing").body("ghost");
        Ok(())
    });
    assert_eq!(
        massless,
        "body \"ghost\" is dynamic but has no mass; add a solid shape (a plane, and a mesh that is open or inside out, hold no \
         volume), give mass, centre and inertia, or make it static"
    );
    let pointlike = build_error(|world| {
        world.object("thing").body("dot").mass(1.0);
        Ok(())
    });
    assert_eq!(
        pointlike,
        "body \"dot\" is dynamic but nothing tells its inertia; add a solid shape (a plane, and a mesh \
         that is open or inside out, hold no volume), give mass, centre and inertia, or make it static"
    );
    let unknown = build_error(|world| {
        let radius = f64::NAN;
        let ball = Shape::new(Geometry::Sphere { radius }).named("ball");
        world.object("thing").body("fog").shape(ball);
        Ok(())
    });
    assert_eq!(
        unknown,
        "shape \"ball\": radius [m] is NaN; give a finite number"
    );
    let negative = build_error(|world| {
        world.object("thing").body("hole").shape(BALL).mass(-1.0);
        Ok(())
    });
    assert_eq!(
        negative,
        "body \"hole\": mass [kg] is -1; it must be above zero"
    );
}

#[test]
fn builder_replicas() {
    let absent = build_error(|world| {
        world
            .object("thing")
            .replicate(2)
            .replica(2)?
            .translate_by(DVec3::X);
        Ok(())
    });
    assert_eq!(
        absent,
        "object \"thing\" has 2 replicas, numbered from 0, so not number 2; call replicate first, \
         or use a number below 2"
    );
    let absurd = build_error(|world| {
        world.object("thing").replicate(usize::MAX);
        Ok(())
    });
    assert_eq!(
        absurd,
        "the model has 1000001 replicas, more than the 1000000 it may have; check the number, or \
         split the model"
    );
    let many = build_error(|world| {
        let thing = world.object("thing");
        for name in ["a", "b"] {
            thing.body(name).shape(BALL);
        }
        thing.replicate(600_000);
        Ok(())
    });
    assert_eq!(
        many,
        "the model has 1200000 bodies, more than the 1000000 it may have; check the number, or \
         split the model"
    );
    let unequal = build_error(|world| {
        let parent = world.object("posts").body("post").shape(BALL).handle();
        let posts = world.object_mut(parent.object())?;
        posts.replicate(3);
        let flags = world.object("flags");
        let flag = flags.body("flag").shape(BALL).handle();
        flags.fixed("nail", flag).parent(parent);
        flags.replicate(2);
        Ok(())
    });
    assert_eq!(
        unequal,
        "joint \"nail\": its object has 2 replicas, but that of its parent body, \"posts\", has 3; \
         replicate both alike, or the other not at all"
    );
}

#[test]
fn builder_exclusions() {
    let strange = build_error(|world| {
        let mine = world.object("mine").body("a").shape(BALL).handle();
        let yours = world.object("yours").body("b").shape(BALL).handle();
        world.object_mut(mine.object())?.exclude(yours, mine);
        Ok(())
    });
    assert_eq!(
        strange,
        "exclusion in object \"mine\": its first body belongs to object \"yours\", not to \"mine\"; \
         make it in object \"yours\""
    );
    let unequal = build_error(|world| {
        let mine = world.object("mine").body("a").shape(BALL).handle();
        let yours = world.object("yours").body("b").shape(BALL).handle();
        world.object_mut(yours.object())?.replicate(2);
        let object = world.object_mut(mine.object())?;
        object.exclude(mine, yours).replicate(3);
        Ok(())
    });
    assert_eq!(
        unequal,
        "exclusion in object \"mine\": its object has 3 replicas, but that of its second body, \
         \"yours\", has 2; replicate both alike, or the other not at all"
    );
}

#[test]
fn builder_contact_pairs() {
    let mut world = Builder::new("w");
    let mine = world.object("mine");
    mine.scenery(BALL);
    let floor = mine.id().scenery(0);
    let ball = mine.body("ball").shape(BALL).handle();
    let mut other = Builder::new("other");
    let stranger = other.object("yours").body("b").shape(BALL).handle();
    let mut told = |a, b| world.contact_pair(a, b).map(drop).unwrap_err().to_string();
    let foreign = "contact pair \"0\": no shape of this builder has this handle; use handles that \
                   this builder gave";
    for unknown in [stranger.shape(0), ball.shape(1), floor.object().scenery(1)] {
        assert_eq!(told(unknown, floor), foreign);
        assert_eq!(told(floor, unknown), foreign);
    }
    assert_eq!(
        told(floor, floor),
        "contact pair \"0\": both of its shapes are number 0; name two different shapes"
    );
    world.contact_pair(floor, ball.shape(0)).unwrap();
    let twice = world.contact_pair(ball.shape(0), floor).map(drop);
    assert_eq!(
        twice.unwrap_err().to_string(),
        "contact pairs 0 and 1 are of the same two shapes; remove one"
    );
    assert_eq!(world.build().unwrap().contact_pairs.len(), 1);
    let wrong = build_error(|world| {
        let balls = world.object("balls");
        let (a, b) = (
            balls.body("a").shape(BALL).handle(),
            balls.body("b").shape(BALL).handle(),
        );
        world.contact_pair(a.shape(0), b.shape(0))?.friction(-1.0);
        Ok(())
    });
    assert_eq!(
        wrong,
        "contact pair \"0\": friction is -1; it must not be negative"
    );
    let unequal = build_error(|world| {
        let mine = world.object("mine").body("a").shape(BALL).handle();
        let yours = world.object("yours").body("b").shape(BALL).handle();
        world.object_mut(mine.object())?.replicate(3);
        world.object_mut(yours.object())?.replicate(2);
        world.contact_pair(mine.shape(0), yours.shape(0))?;
        Ok(())
    });
    assert_eq!(
        unequal,
        "contact pair \"0\": its object has 3 replicas, but that of its second shape, \"yours\", \
         has 2; replicate both alike, or the other not at all"
    );
}

#[test]
fn builder_placements() {
    let nowhere = build_error(|world| {
        world
            .object("thing")
            .replicas()
            .move_on_axis_by(DVec3::ZERO, 1.0);
        Ok(())
    });
    assert_eq!(
        nowhere,
        "object \"thing\": placement is NaN; give a finite number"
    );
}

#[test]
fn builder_handles() {
    let mut elsewhere = Builder::new("elsewhere");
    let far = elsewhere.object("far");
    let stranger = far.body("stranger").shape(BALL).handle();
    let strange_joint = far.fixed("strange", stranger).handle();

    let child = build_error(|world| {
        // A body of its own in the same row.
        let near = world.object("near");
        near.body("own").shape(BALL);
        near.fixed("nail", stranger);
        Ok(())
    });
    assert_eq!(
        child,
        "joint \"nail\": no child body of this builder has this handle; use handles that this \
         builder gave"
    );
    let motor = build_error(|world| {
        world.object("near").motor("motor", strange_joint);
        Ok(())
    });
    assert_eq!(
        motor,
        "actuator \"motor\": no joint of this builder has this handle; use handles that this \
         builder gave"
    );
    let lookup = build_error(|world| world.body_mut(stranger).map(drop));
    assert_eq!(
        lookup,
        "world: no object of this builder has this handle; use handles that this builder gave"
    );
    let other = build_error(|world| {
        let mine = world.object("mine").body("a").shape(BALL).handle();
        world.object("yours").fixed("nail", mine);
        Ok(())
    });
    assert_eq!(
        other,
        "joint \"nail\": its child body belongs to object \"mine\", not to \"yours\"; make it in \
         object \"mine\""
    );
}

#[test]
fn example_sizes() {
    let message = |links| examples::n_pendula(links).unwrap_err().to_string();
    assert_eq!(
        message(0),
        "chain: number of links is 0; it must lie from 1 to 1000000"
    );
    assert_eq!(
        message(2_000_000),
        "chain: number of links is 2000000; it must lie from 1 to 1000000"
    );
}

#[test]
fn poses_with_nan_are_invalid() {
    assert!(Pose::IDENTITY.is_valid());
    assert!(!Pose::at(DVec3::new(0.0, f64::NAN, 0.0)).is_valid());
    assert!(!Pose::new(DVec3::ZERO, DQuat::from_xyzw(0.0, 0.0, 0.0, 1.1)).is_valid());
}

#[test]
fn sensors() {
    fn sensor(parts: &mut Parts, measurand: Measurand) -> &mut Sensor {
        parts.sensors.push(Sensor::new("eye", measurand));
        &mut parts.sensors[0]
    }
    const MOUNT: Mount = Mount {
        body: Some(BodyId(1)),
        pose: Pose::IDENTITY,
    };
    const FALL: Measurand = Measurand::Acceleration { mount: MOUNT };
    const JOINT: JointId = JointId(0);
    let mut parts = sound();
    sensor(&mut parts, FALL);
    Model::new(parts).unwrap();
    refuses(&[
        (
            |p| {
                sensor(p, FALL);
                sensor(p, FALL);
            },
            "two of kind sensor are named \"eye\"; rename one",
        ),
        (
            |p| sensor(p, FALL).noise = -1.0,
            "sensor \"eye\": noise is -1; it must not be negative",
        ),
        (
            |p| sensor(p, FALL).rate = Some(0.0),
            "sensor \"eye\": rate [Hz] is 0; it must be above zero",
        ),
        (
            |p| sensor(p, FALL).cutoff = Some(f64::NAN),
            "sensor \"eye\": cutoff is NaN; give a finite number",
        ),
        (
            |p| {
                let body = Some(BodyId(7));
                sensor(p, Measurand::CenterOfMass { body });
            },
            "sensor \"eye\": its body is number 7, but the model has 3, numbered from 0; use a number below 3",
        ),
        (
            |p| {
                let mount = Mount::on(BodyId(7));
                sensor(p, Measurand::Distance { mount });
            },
            "sensor \"eye\": its body is number 7, but the model has 3, numbered from 0; use a number below 3",
        ),
        (
            |p| {
                sensor(p, Measurand::ActuatorForce { actuator: 1 });
            },
            "sensor \"eye\": its actuator is number 1, but the model has 1, numbered from 0; use a number below 1",
        ),
        (
            |p| {
                sensor(
                    p,
                    Measurand::JointPosition {
                        joint: JOINT,
                        axis: 1,
                    },
                );
            },
            "sensor \"eye\": its axis is number 1, but the model has 1, numbered from 0; use a number below 1",
        ),
        (
            |p| {
                sensor(p, Measurand::BallVelocity { joint: JOINT });
            },
            "sensor \"eye\": joint \"hinge\" has not what it measures; orientations and angular velocities are of ball joints, forces and torques of all but free ones",
        ),
    ]);
}
