//! The builder: replicas, placements, joints placed in an object, and what each call sets.

use glam::{DMat3, DQuat, DVec3};
use kinetarium_model::{
    Axis, BodyHandle, BodyId, Builder, Drive, Geometry, JointHandle, JointKind, Keyframe, Limit,
    Material, Model, Object, Pose, Shape, ShapeId, Softness, UpAxis,
};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

const BALL: Geometry = Geometry::Sphere { radius: 0.1 };

fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose::at(DVec3::new(x, y, z))
}

/// A post, and a flag on a hinge at its top.
fn flag_post(world: &mut Builder) -> (&mut Object, BodyHandle, JointHandle) {
    let object = world.object("flag post");
    let post = object.body("post").shape(BALL).immovable().handle();
    let flag = object
        .body("flag")
        .shape(BALL)
        .at(at(1.0, 2.0, 0.0))
        .handle();
    let hinge = object
        .revolute("hinge", flag, DVec3::Y)
        .parent(post)
        .at(at(0.0, 2.0, 0.0))
        .handle();
    object.motor("motor", hinge);
    (object, flag, hinge)
}

#[track_caller]
fn assert_near(found: DVec3, expected: DVec3) {
    assert!(
        found.abs_diff_eq(expected, 1e-12),
        "{found} is not {expected}"
    );
}

fn position(model: &Model, body: &str) -> DVec3 {
    model.bodies[model.body(body).unwrap().0].pose.position
}

#[test]
fn a_joint_placed_in_the_object_leaves_bodies_where_they_were_placed() {
    let mut world = Builder::new("w");
    flag_post(&mut world);
    let model = world.build().unwrap();
    let hinge = &model.joints[0];
    assert_near(hinge.parent_frame.position, DVec3::new(0.0, 2.0, 0.0));
    assert_near(hinge.child_frame.position, DVec3::new(-1.0, 0.0, 0.0));
    assert_near(position(&model, "flag"), DVec3::new(1.0, 2.0, 0.0));
}

#[test]
fn replicas_have_their_own_names_rows_and_places() {
    let mut world = Builder::new("w");
    let (object, flag, hinge) = flag_post(&mut world);
    object.replicate(3);
    object.replica(1).unwrap().translate_by(DVec3::X);
    object
        .replica(2)
        .unwrap()
        .rotate_around_by(DVec3::ZERO, DVec3::Y, FRAC_PI_2);
    world.object("other").body("stone").shape(BALL);
    let model = world.build().unwrap();
    assert_eq!(model.bodies.len(), 7);
    for k in 0..3 {
        let body = world.body_replica(flag, k).unwrap();
        let joint = world.joint_replica(hinge, k).unwrap();
        assert_eq!(model.bodies[body.0].name, format!("flag_{k}"));
        assert_eq!(model.joints[joint.0].name, format!("hinge_{k}"));
        assert_eq!(model.joints[joint.0].dofs[0].name, format!("hinge_{k}"));
        assert_eq!(model.joints[joint.0].child, body);
        assert_eq!(model.actuators[k].name, format!("motor_{k}"));
        assert_eq!(model.actuators[k].joint, joint);
        let owned = model.shapes.iter().filter(|s| s.body == Some(body)).count();
        assert_eq!(owned, 1);
    }
    assert_near(position(&model, "flag_0"), DVec3::new(1.0, 2.0, 0.0));
    assert_near(position(&model, "flag_1"), DVec3::new(2.0, 2.0, 0.0));
    assert_near(position(&model, "flag_2"), DVec3::new(0.0, 2.0, -1.0));
    assert_eq!(model.body("stone").unwrap(), BodyId(6));
    assert!(world.body_replica(flag, 3).is_err());
}

#[test]
fn an_object_replicated_zero_times_is_left_out() {
    let mut world = Builder::new("w");
    flag_post(&mut world).0.replicate(0);
    assert_eq!(world.build().unwrap().bodies.len(), 0);
}

#[test]
fn new_replicas_stand_where_the_first_does_and_others_stay() {
    let mut world = Builder::new("w");
    let object = world.object("o");
    object.body("b").shape(BALL);
    object
        .replicate(2)
        .replica(0)
        .unwrap()
        .translate_to(DVec3::X);
    object.replicate(3);
    let model = world.build().unwrap();
    assert_near(position(&model, "b_0"), DVec3::X);
    assert_near(position(&model, "b_1"), DVec3::ZERO);
    assert_near(position(&model, "b_2"), DVec3::X);
}

#[test]
fn joints_reach_into_other_objects() {
    let mut world = Builder::new("w");
    let shared = world.object("shared").body("hub").shape(BALL).handle();
    let hubs = world.object("hubs");
    let own = hubs.body("own hub").shape(BALL).handle();
    hubs.replicate(2).replica(1).unwrap().translate_by(DVec3::X);
    let spokes = world.object("spokes");
    let a = spokes.body("a").shape(BALL).handle();
    let b = spokes.body("b").shape(BALL).handle();
    spokes.ball("to shared", a).parent(shared);
    spokes.ball("to own", b).parent(own);
    spokes
        .replicate(2)
        .replica(1)
        .unwrap()
        .translate_by(DVec3::new(1.0, 1.0, 0.0));
    let model = world.build().unwrap();
    let parent = |joint: &str| model.joints[model.joint(joint).unwrap().0].parent.unwrap();
    let name = |joint: &str| model.bodies[parent(joint).0].name.clone();
    assert_eq!(name("to shared_0"), "hub");
    assert_eq!(name("to shared_1"), "hub");
    assert_eq!(name("to own_0"), "own hub_0");
    assert_eq!(name("to own_1"), "own hub_1");
    assert_near(position(&model, "b_1"), DVec3::new(1.0, 1.0, 0.0));
}

#[test]
fn moving_an_object_moves_all_that_hangs_in_it() {
    let mut world = Builder::new("w");
    let object = world.object("o");
    object.scenery(Shape::new(BALL).at(at(0.0, 0.0, 1.0)));
    object.body("loose").shape(BALL).at(at(1.0, 0.0, 0.0));
    let hung = object.body("hung").shape(BALL).handle();
    object
        .revolute("hook", hung, DVec3::Z)
        .frames(at(0.0, 3.0, 0.0), at(0.0, 1.0, 0.0));
    object
        .replicas()
        .translate_by(DVec3::Y)
        .rotate_around_by(DVec3::ZERO, DVec3::Y, PI);
    let model = world.build().unwrap();
    assert_near(position(&model, "loose"), DVec3::new(-1.0, 1.0, 0.0));
    assert_near(position(&model, "hung"), DVec3::new(0.0, 3.0, 0.0));
    let scenery = model.shapes.last().unwrap();
    assert_eq!(scenery.body, None);
    assert_near(scenery.pose.position, DVec3::new(0.0, 1.0, -1.0));
}

/// Where an object ends up whose origin starts at (1, 2, 3), turned by 0.4 about z.
fn moved(by: impl Fn(&mut Object)) -> Pose {
    let mut world = Builder::new("w");
    let object = world.object("o");
    object.body("b").shape(BALL);
    object
        .replicas()
        .rotate_around_to(DVec3::ZERO, DVec3::Z, 0.4)
        .translate_to(DVec3::new(1.0, 2.0, 3.0));
    by(object);
    world.build().unwrap().bodies[0].pose
}

#[test]
fn relative_and_absolute_moves() {
    let start = moved(|_| ());
    assert_near(start.position, DVec3::new(1.0, 2.0, 3.0));
    let shifted = moved(|o| {
        o.replicas().translate_by(DVec3::X);
    });
    assert_near(shifted.position, DVec3::new(2.0, 2.0, 3.0));
    let along = moved(|o| {
        o.replicas().move_on_axis_by(2.0 * DVec3::Y, 5.0);
    });
    assert_near(along.position, DVec3::new(1.0, 7.0, 3.0));
    let to = moved(|o| {
        o.replicas().move_on_axis_to(2.0 * DVec3::Y, 5.0);
    });
    assert_near(to.position, DVec3::new(1.0, 5.0, 3.0));
    let turned = moved(|o| {
        o.replicas().rotate_around_by(DVec3::X, DVec3::Z, FRAC_PI_2);
    });
    assert_near(turned.position, DVec3::new(-1.0, 0.0, 3.0));
    assert!((turned.orientation.to_scaled_axis().z - 0.4 - FRAC_PI_2).abs() < 1e-12);
    let set = moved(|o| {
        o.replicas()
            .rotate_around_to(DVec3::X, DVec3::Z, 0.4 + FRAC_PI_2);
    });
    assert_near(set.position, turned.position);
    for pose in [shifted, along, to] {
        assert!(pose.orientation.abs_diff_eq(start.orientation, 1e-12));
    }
}

proptest! {
    /// Whatever the orientation before, its twist about the axis is the angle asked for.
    #[test]
    fn absolute_turns_reach_their_angle(
        before in prop::array::uniform3(-2.0..2.0_f64),
        axis in prop::array::uniform3(0.1..1.0_f64),
        angle in -3.0..3.0_f64,
    ) {
        let (before, axis) = (DVec3::from(before), DVec3::from(axis));
        let mut world = Builder::new("w");
        let object = world.object("o");
        object.body("b").shape(BALL);
        object
            .replicas()
            .rotate_around_by(DVec3::ONE, before + DVec3::splat(2.5), before.length())
            .rotate_around_to(DVec3::X, axis, angle);
        let q = world.build().unwrap().bodies[0].pose.orientation;
        let twist = 2.0 * q.xyz().dot(axis.normalize()).atan2(q.w);
        let off = (twist - angle).rem_euclid(2.0 * PI);
        prop_assert!(off.min(2.0 * PI - off) < 1e-9, "{twist} is not {angle}");
    }
}

#[test]
fn masses_from_densities_from_a_total_or_as_given() {
    let mut world = Builder::new("w");
    let object = world.object("o");
    let cube = Geometry::Box {
        half: DVec3::splat(0.5),
    };
    object
        .body("dense")
        .shape(Shape::new(cube.clone()).with_density(12.0));
    object
        .body("total")
        .shape(
            Shape::new(cube.clone())
                .at(at(-1.0, 0.0, 0.0))
                .with_density(1.0),
        )
        .shape(
            Shape::new(cube.clone())
                .at(at(1.0, 0.0, 0.0))
                .with_density(3.0),
        )
        .mass(8.0);
    let inertia = DMat3::from_diagonal(DVec3::new(1.0, 2.0, 2.5));
    object
        .body("given")
        .shape(cube)
        .inertia(3.0, DVec3::Y, inertia);
    let model = world.build().unwrap();
    let [dense, total, given] = &model.bodies[..] else {
        panic!("three bodies")
    };
    assert!((dense.mass - 12.0).abs() < 1e-12);
    assert!((dense.inertia.y_axis.y - 2.0).abs() < 1e-12);
    assert!((total.mass - 8.0).abs() < 1e-12);
    assert_near(total.center, DVec3::new(0.5, 0.0, 0.0));
    // 8/6 about the cubes' own centres, and 2·1.5² + 6·0.5² from their distance.
    assert!((total.inertia.y_axis.y - (8.0 / 6.0 + 6.0)).abs() < 1e-12);
    assert_eq!(
        (given.mass, given.center, given.inertia),
        (3.0, DVec3::Y, inertia)
    );
}

#[test]
fn every_kind_of_joint() {
    let mut world = Builder::new("w");
    let object = world.object("o");
    let bodies: Vec<_> = (0..7)
        .map(|i| object.body(format!("b{i}")).shape(BALL).handle())
        .collect();
    object.fixed("fixed", bodies[0]);
    object.revolute("revolute", bodies[1], DVec3::X);
    object.prismatic("prismatic", bodies[2], DVec3::X);
    object.ball("ball", bodies[3]);
    object.free("free", bodies[4]);
    object.d6(
        "d6",
        bodies[5],
        &[Axis::linear(DVec3::X), Axis::angular(DVec3::Y)],
    );
    object.plane_xz("plane_xz", bodies[6]);
    object
        .distance("distance", bodies[4], 0.5)
        .parent(bodies[3]);
    let model = world.build().unwrap();
    for joint in &model.joints {
        assert_eq!(joint.name, joint.kind.name());
    }
    let dofs: Vec<_> = model
        .joints
        .iter()
        .map(|j| j.degrees_of_freedom())
        .collect();
    assert_eq!(dofs, [0, 1, 1, 3, 6, 2, 3, 0]);
    let distance = model.joints.last().unwrap();
    assert_eq!((distance.kind, distance.length), (JointKind::Distance, 0.5));
}

#[test]
fn joint_settings_reach_every_degree_of_freedom() {
    let limit = Limit {
        lower: -1.0,
        upper: 1.0,
        stiffness: 5.0,
        damping: 6.0,
        inertia: 0.0,
    };
    let drive = Drive {
        stiffness: 7.0,
        target_position: 0.1,
        ..Drive::default()
    };
    let mut world = Builder::new("w");
    let object = world.object("o");
    let body = object.body("b").shape(BALL).handle();
    let axes = [Axis::linear(DVec3::X), Axis::angular(DVec3::Y)];
    let joint = object
        .d6("d6", body, &axes)
        .limit(limit)
        .drive(drive)
        .damping(1.0)
        .spring(2.0, 0.25)
        .armature(3.0)
        .friction_loss(4.0)
        .compliance(1e-6, 1e-5)
        .initial(&[0.5, 0.25])
        .enabled(false);
    joint.dofs_mut()[1].damping = 9.0;
    assert_eq!(joint.dofs()[1].damping, 9.0);
    assert_eq!(joint.compliances(), [1e-6, 1e-5]);
    let joint = joint.handle();
    world.joint_mut(joint).unwrap().dofs_mut()[0].name = "reach".into();
    world.body_mut(body).unwrap().group(3).world(-1);
    let model = world.build().unwrap();
    let built = &model.joints[0];
    for dof in &built.dofs {
        assert_eq!((dof.limit, dof.drive), (Some(limit), drive));
        assert_eq!((dof.stiffness, dof.rest), (2.0, 0.25));
        assert_eq!((dof.armature, dof.friction_loss), (3.0, 4.0));
    }
    assert_eq!((built.dofs[0].damping, built.dofs[1].damping), (1.0, 9.0));
    assert_eq!(
        (built.linear_compliance, built.angular_compliance),
        (1e-6, 1e-5)
    );
    assert!(!built.enabled);
    assert_eq!(model.initial_position(), [0.5, 0.25]);
    assert_eq!(model.dof("reach").unwrap(), 0);
    assert_eq!((model.bodies[0].group, model.bodies[0].world), (3, -1));
}

#[test]
fn actuators_couplings_and_loops() {
    let mut world = Builder::new("w");
    let object = world.object("o");
    let bodies: Vec<_> = (0..2)
        .map(|i| object.body(format!("b{i}")).shape(BALL).handle())
        .collect();
    let first = object.revolute("first", bodies[0], DVec3::X).handle();
    let second = object
        .revolute("second", bodies[1], DVec3::X)
        .parent(bodies[0])
        .handle();
    object
        .fixed("weld", bodies[1])
        .closes_loop(true)
        .bodies_collide(true);
    object.couple("mimic", second, first, 2.0, 0.5);
    object
        .motor("motor", first)
        .gear(3.0)
        .control_range(-1.0, 1.0)
        .force_range(-2.0, 2.0);
    object.position_servo("position", second, 10.0, 1.0);
    object.velocity_servo("velocity", second, 4.0);
    let model = world.build().unwrap();
    assert_eq!(
        model.loops(),
        ["joint \"weld\" closing a loop", "coupling \"mimic\""]
    );
    let let_touch: Vec<_> = model.joints.iter().map(|j| j.bodies_collide).collect();
    assert_eq!(let_touch, [false, false, true]);
    let mimic = &model.couplings[0];
    assert_eq!(model.joints[mimic.joint.0].name, "second");
    assert_eq!((mimic.ratio, mimic.offset), (2.0, 0.5));
    let [motor, position, velocity] = &model.actuators[..] else {
        panic!("three actuators")
    };
    assert_eq!((motor.gear, motor.gain, motor.bias), (3.0, 1.0, [0.0; 3]));
    assert_eq!(motor.control_range, Some((-1.0, 1.0)));
    assert_eq!(motor.force_range, Some((-2.0, 2.0)));
    assert_eq!((position.gain, position.bias), (10.0, [0.0, -10.0, -1.0]));
    assert_eq!((velocity.gain, velocity.bias), (4.0, [0.0, 0.0, -4.0]));
}

#[test]
fn settings_of_the_world() {
    let mut world = Builder::new("w");
    let home = Keyframe {
        name: "home".into(),
        ..Keyframe::default()
    };
    world
        .up_axis(UpAxis::Z)
        .time_step(0.01)
        .replicate(64)
        .keyframe(home);
    let model = world.build().unwrap();
    assert_eq!(
        (model.up_axis, model.gravity),
        (UpAxis::Z, DVec3::new(0.0, 0.0, -9.81))
    );
    assert_eq!(
        (model.time_step, model.worlds, model.name.as_str()),
        (0.01, 64, "w")
    );
    assert_eq!(model.keyframe("home").unwrap().name, "home");
    assert_eq!(world.gravity(DVec3::X).build().unwrap().gravity, DVec3::X);
}

#[test]
fn a_built_world_can_be_changed_and_built_again() {
    let mut world = Builder::new("w");
    let (object, flag, _) = flag_post(&mut world);
    let id = object.id();
    assert_eq!(world.build().unwrap().bodies.len(), 2);
    world.object_mut(id).unwrap().replicate(2);
    world
        .body_mut(flag)
        .unwrap()
        .at(Pose::new(DVec3::Z, DQuat::IDENTITY));
    let model = world.build().unwrap();
    assert_eq!(model.bodies.len(), 4);
    assert_near(position(&model, "flag_1"), DVec3::Z);
}

#[test]
fn what_stands_in_drafts_can_be_read() {
    let there = Pose::new(DVec3::Z, DQuat::from_rotation_x(0.5));
    let mut world = Builder::new("w");
    let (_, flag, hinge) = flag_post(&mut world);
    let body = world.body_mut(flag).unwrap();
    assert_eq!((body.is_static(), body.masks()), (false, None));
    body.at(there).immovable().collision_masks(2, 4);
    assert_eq!((body.is_static(), body.masks()), (true, Some((2, 4))));
    assert_eq!(body.pose(), there);
    let joint = world.joint_mut(hinge).unwrap();
    assert_eq!(joint.at(there).pose(), there);
    joint.frames(there, Pose::IDENTITY);
    assert_eq!(joint.pose(), Pose::IDENTITY);
    assert_eq!(joint.body_frames(), [there, Pose::IDENTITY]);
}

#[test]
fn clones_take_the_handles_made_before() {
    let mut world = Builder::new("w");
    let (_, flag, hinge) = flag_post(&mut world);
    let mut other = world.clone();
    other.body_mut(flag).unwrap().mass(3.0);
    other.joint_mut(hinge).unwrap().damping(0.5);
    let mass = |world: &Builder| world.build().unwrap().bodies[1].mass;
    assert!((mass(&other) - 3.0).abs() < 1e-12 && mass(&world) > 3.5);
    let [object] = other.objects() else {
        panic!("one object, not {}", other.objects().len());
    };
    assert_eq!((object.name(), object.id()), ("flag post", flag.object()));
    assert_eq!(object.bodies()[1].handle(), flag);
    assert_eq!(object.joints()[0].name(), "hinge");
}

#[test]
fn exclusions_follow_the_replicas() {
    let mut world = Builder::new("w");
    let table = world.object("table").body("top").shape(BALL).handle();
    let hand = world.object("hand");
    let palm = hand.body("palm").shape(BALL).handle();
    let tip = hand.body("tip").shape(BALL).handle();
    hand.exclude(tip, palm)
        .exclude(tip, table)
        .exclude(palm, None)
        .replicate(2);
    let model = world.build().unwrap();
    let row = |body, k| world.body_replica(body, k).unwrap();
    let of = |k| {
        [
            (Some(row(palm, k)), row(tip, k)),
            (Some(row(table, 0)), row(tip, k)),
            (None, row(palm, k)),
        ]
    };
    assert_eq!(model.exclusions, [of(0), of(1)].concat());
}

#[test]
fn a_body_gives_its_masks_to_all_its_shapes() {
    let mut world = Builder::new("w");
    let thing = world.object("thing");
    thing
        .body("body")
        .shape(Shape::new(BALL).with_masks(4, 4))
        .collision_masks(2, 6)
        .shape(BALL);
    thing.body("other").shape(BALL);
    let model = world.build().unwrap();
    let masks: Vec<_> = model
        .shapes
        .iter()
        .map(|s| (s.membership, s.collides_with))
        .collect();
    assert_eq!(masks, [(2, 6), (2, 6), (1, 1)]);
}

#[test]
fn contact_pairs_follow_the_replicas() {
    let mut world = Builder::new("w");
    let table = world.object("table");
    table.scenery(BALL).scenery(BALL);
    let top = table.id().scenery(1);
    let hand = world.object("hand");
    let palm = hand.body("palm").shape(BALL).handle();
    let tip = hand.body("tip").shape(BALL).shape(BALL).handle();
    hand.scenery(BALL).replicate(2);
    world
        .contact_pair(tip.shape(1), top)
        .unwrap()
        .friction(0.9)
        .margin(0.01);
    let pair = world.contact_pair(palm.shape(0), tip.shape(0)).unwrap();
    pair.restitution(1.0);
    let model = world.build().unwrap();
    let row = |shape, k| world.shape_replica(shape, k).unwrap();
    let shapes: Vec<_> = model.contact_pairs.iter().map(|pair| pair.shapes).collect();
    let of = |k| (row(tip.shape(1), k), row(top, 0));
    let within = |k| (row(palm.shape(0), k), row(tip.shape(0), k));
    assert_eq!(shapes, [of(0), of(1), within(0), within(1)]);
    // The table's two; then of each hand the palm, the tip's two, and its scenery.
    let tip = |k: usize| ShapeId(2 + 4 * k + 2);
    assert_eq!(shapes[..2], [(tip(0), ShapeId(1)), (tip(1), ShapeId(1))]);
    let surface = model.contact_material(tip(1), ShapeId(1));
    assert_eq!((surface.friction, surface.margin), (0.9, 0.01));
    assert_eq!(surface.restitution, 0.0);
}

/// What is not set is what the materials made of each other when the pair was begun.
#[test]
fn a_contact_pair_begins_with_the_surface_of_its_shapes() {
    let slippery = Material {
        friction: 0.1,
        margin: 0.02,
        ..Material::default()
    };
    let mut world = Builder::new("w");
    let thing = world.object("thing");
    let a = thing.body("a").shape(BALL).handle().shape(0);
    let b = thing
        .body("b")
        .shape(Shape::new(BALL).with_material(slippery))
        .handle();
    let pair = world.contact_pair(a, b.shape(0)).unwrap();
    pair.torsional_friction(0.03).rolling_friction(0.004);
    let expected = Material {
        torsional_friction: 0.03,
        rolling_friction: 0.004,
        ..Material::default().with(&slippery)
    };
    assert_eq!(pair.surface(), expected);
    assert_eq!(pair.shapes(), [a, b.shape(0)]);
    assert_eq!(pair.material(slippery).surface(), slippery);
    let spring = Softness::Spring {
        stiffness: 1e4,
        damping: 10.0,
    };
    assert_eq!(pair.softness(spring).surface().softness, spring);
    assert_eq!(world.clone().contact_pairs().len(), 1);
}
