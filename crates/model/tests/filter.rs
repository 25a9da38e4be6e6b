//! The truth table of the collision filter.

use glam::DVec3;
use kinetarium_model::{
    Body, BodyId, BodyKind, CollisionFilter, Geometry, Joint, JointKind, Model, Parts, Shape,
    ShapeId,
};

fn ball(body: Option<usize>) -> Shape {
    Shape {
        body: body.map(BodyId),
        ..Shape::new(Geometry::Sphere { radius: 0.1 })
    }
}

/// One ball on each body, and last one fixed to the world.
fn filter(bodies: Vec<Body>, joints: Vec<Joint>) -> impl Fn(usize, usize) -> bool {
    let bodies_then_world = (0..bodies.len()).map(Some).chain([None]);
    let shapes = bodies_then_world.map(ball).collect();
    let model = Model::new(Parts {
        bodies,
        joints,
        shapes,
        ..Parts::default()
    })
    .unwrap();
    let filter = CollisionFilter::new(&model);
    move |a, b| {
        let collide = filter.may_collide(ShapeId(a), ShapeId(b));
        assert_eq!(
            collide,
            filter.may_collide(ShapeId(b), ShapeId(a)),
            "not symmetric"
        );
        collide
    }
}

fn in_group(name: &str, group: i32) -> Body {
    Body {
        group,
        ..Body::new(name)
    }
}

#[test]
fn groups() {
    let table = [
        ((1, 1), true),
        ((1, 2), true),
        ((1, -1), true),
        ((2, -3), true),
        ((-1, -1), false),
        ((-1, -2), false),
        ((0, 1), false),
        ((0, -1), false),
        ((0, 0), false),
    ];
    for ((a, b), expected) in table {
        let collide = filter(vec![in_group("a", a), in_group("b", b)], vec![]);
        assert_eq!(collide(0, 1), expected, "groups {a} and {b}");
    }
}

#[test]
fn worlds() {
    let table = [
        ((0, 0), true),
        ((0, 1), false),
        ((-1, 1), true),
        ((-1, -1), true),
    ];
    for ((a, b), expected) in table {
        let body = |name, world| Body {
            world,
            ..Body::new(name)
        };
        let collide = filter(vec![body("a", a), body("b", b)], vec![]);
        assert_eq!(collide(0, 1), expected, "worlds {a} and {b}");
    }
}

#[test]
fn static_bodies_and_the_world() {
    let fixed = |name| Body {
        kind: BodyKind::Static,
        ..in_group(name, 1)
    };
    let collide = filter(
        vec![fixed("floor"), fixed("wall"), Body::new("ball")],
        vec![],
    );
    assert!(!collide(0, 1), "static with static");
    assert!(!collide(0, 3), "static with the world");
    assert!(collide(0, 2), "static with dynamic");
    assert!(collide(2, 3), "dynamic with the world");
}

#[test]
fn shapes_of_one_body_and_shapes_only_seen() {
    let bodies = vec![Body::new("a"), Body::new("b")];
    let shapes = vec![
        ball(Some(0)),
        ball(Some(0)),
        ball(Some(1)).without_contact(),
    ];
    let model = Model::new(Parts {
        bodies,
        shapes,
        ..Parts::default()
    })
    .unwrap();
    let filter = CollisionFilter::new(&model);
    assert!(!filter.may_collide(ShapeId(0), ShapeId(1)), "one body");
    assert!(!filter.may_collide(ShapeId(0), ShapeId(2)), "only seen");
}

#[test]
fn joints() {
    let links = || vec![Body::new("a"), Body::new("b"), Body::new("c")];
    let joint = |kind, parent: usize, child: usize| {
        let name = format!("{parent}_{child}");
        Joint::new(name, kind, Some(BodyId(parent)), BodyId(child), vec![])
    };
    let closing = Joint {
        closes_loop: true,
        ..joint(JointKind::Ball, 2, 1)
    };
    let chained = filter(links(), vec![joint(JointKind::Ball, 0, 1), closing]);
    assert!(!chained(0, 1), "parent with child");
    assert!(
        !chained(1, 2),
        "parent with child of a joint that closes a loop"
    );
    assert!(chained(0, 2), "grandparent with grandchild");
    let free = filter(links(), vec![joint(JointKind::Free, 0, 1)]);
    assert!(free(0, 1), "a free joint restrains nothing");
    let hung = Joint::new("hook", JointKind::Ball, None, BodyId(0), vec![]);
    assert!(
        filter(links(), vec![hung])(0, 3),
        "hung from the world, yet touching its floor"
    );
}

#[test]
fn default_groups_let_a_ball_fall_on_the_floor() {
    use kinetarium_model::{Builder, Pose};
    let mut world = Builder::new("drop");
    let scene = world.object("scene");
    let solid = Geometry::Box {
        half: DVec3::splat(0.5),
    };
    scene.body("floor").shape(solid.clone()).immovable();
    scene
        .body("ball")
        .shape(Geometry::Sphere { radius: 0.1 })
        .at(Pose::at(DVec3::Y));
    scene.scenery(solid);
    let model = world.build().unwrap();
    assert_eq!((model.bodies[0].group, model.bodies[1].group), (-1, 1));
    let filter = CollisionFilter::new(&model);
    let collide = |a, b| filter.may_collide(ShapeId(a), ShapeId(b));
    assert_eq!(
        (collide(0, 1), collide(1, 2), collide(0, 2)),
        (true, true, false)
    );
}
