//! The truth table of the collision filter.

use glam::DVec3;
use kinetarium_model::{
    Body, BodyId, BodyKind, CollisionFilter, ContactPair, Geometry, Joint, JointKind, Material,
    Model, Parts, Shape, ShapeId,
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
fn masks() {
    let table = [
        ((1, 1), (1, 1), true),
        ((1, 0), (0, 1), true),
        ((0, 1), (1, 0), true),
        ((1, 2), (1, 2), false),
        ((2, 4), (4, 0), true),
        ((0, 0), (!0, !0), false),
        ((1 << 31, 0), (0, 1 << 31), true),
    ];
    for (a, b, expected) in table {
        let shapes = [(Some(0), a), (None, b)]
            .map(|(body, (of, with))| ball(body).with_masks(of, with))
            .to_vec();
        let model = Model::new(Parts {
            bodies: vec![Body::new("a")],
            shapes,
            ..Parts::default()
        })
        .unwrap();
        let filter = CollisionFilter::new(&model);
        let collide = filter.may_collide(ShapeId(0), ShapeId(1));
        assert_eq!(collide, expected, "masks {a:?} and {b:?}");
        assert_eq!(collide, filter.may_collide(ShapeId(1), ShapeId(0)));
    }
}

/// Three bodies with a ball each, and a ball of the world.
fn four_balls() -> Parts {
    Parts {
        bodies: vec![Body::new("a"), Body::new("b"), Body::new("c")],
        shapes: [Some(0), Some(1), Some(2), None].map(ball).to_vec(),
        ..Parts::default()
    }
}

fn pairs(parts: Parts) -> Vec<(usize, usize)> {
    let filter = CollisionFilter::new(&Model::new(parts).unwrap());
    filter.pairs().map(|(a, b)| (a.0, b.0)).collect()
}

#[test]
fn exclusions() {
    let all = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
    assert_eq!(pairs(four_balls()), all);
    let exclusions = vec![(Some(BodyId(2)), BodyId(0)), (None, BodyId(1))];
    let parts = Parts {
        exclusions,
        ..four_balls()
    };
    assert_eq!(pairs(parts), [(0, 1), (0, 3), (1, 2), (2, 3)]);
}

#[test]
fn named_pairs_touch_whatever_else_holds() {
    let mut parts = four_balls();
    parts.shapes[0].collides = false;
    parts.shapes[1] = ball(Some(1)).with_masks(0, 0);
    parts.shapes[3].membership = 0;
    parts.bodies[2].group = 0;
    parts.exclusions = vec![(Some(BodyId(0)), BodyId(1))];
    assert_eq!(pairs(parts.clone()), []);
    let slippery = Material {
        friction: 0.01,
        ..Material::default()
    };
    let pair = |a, b| ContactPair::new((ShapeId(a), ShapeId(b)), slippery);
    parts.contact_pairs = vec![pair(1, 0), pair(2, 3)];
    assert_eq!(pairs(parts.clone()), [(0, 1), (2, 3)]);
    let model = Model::new(parts.clone()).unwrap();
    assert_eq!(model.contact_material(ShapeId(0), ShapeId(1)), slippery);
    assert_eq!(model.contact_material(ShapeId(1), ShapeId(0)), slippery);
    let usual = model.contact_material(ShapeId(1), ShapeId(2));
    assert_eq!(usual, Material::default());

    parts.contact_pairs[0].filtered = true;
    assert_eq!(pairs(parts.clone()), [(2, 3)]);
    let model = Model::new(parts.clone()).unwrap();
    assert_eq!(model.contact_material(ShapeId(0), ShapeId(1)), slippery);
    parts.contact_pairs[0].filtered = false;

    parts.bodies[0].world = 1;
    parts.bodies[1].world = 2;
    parts.bodies[2].kind = BodyKind::Static;
    assert_eq!(pairs(parts), [], "two worlds; nothing that moves");
}

/// Every pair that the list gives, and no other, may collide; with kinds of all sorts.
#[test]
fn the_list_holds_what_may_collide() {
    let mut parts = Parts::default();
    for i in 0..40 {
        parts.bodies.push(Body {
            kind: if i % 7 == 0 {
                BodyKind::Static
            } else {
                BodyKind::Dynamic
            },
            ..in_group(&format!("body{i}"), [1, -1, 2, 0][i % 4])
        });
        for k in 0..i % 3 {
            let masks = (1 << (i % 3), 1 << (k + i % 2));
            parts
                .shapes
                .push(ball(Some(i)).with_masks(masks.0, masks.1));
        }
        parts.exclusions.push((None, BodyId(i)));
        if i > 4 {
            parts.exclusions.push((Some(BodyId(i)), BodyId(i - 5)));
        }
    }
    parts.shapes.push(ball(None));
    parts.shapes.push(ball(Some(1)).without_contact());
    let filter = CollisionFilter::new(&Model::new(parts.clone()).unwrap());
    let n = parts.shapes.len();
    let mut expected = Vec::new();
    for a in 0..n {
        for b in a + 1..n {
            let (a, b) = (ShapeId(a), ShapeId(b));
            assert_eq!(filter.may_collide(a, b), filter.may_collide(b, a));
            expected.extend(filter.may_collide(a, b).then_some((a, b)));
        }
    }
    assert!(expected.len() > 20, "{}", expected.len());
    assert_eq!(filter.pairs().collect::<Vec<_>>(), expected);
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
    let open = Joint {
        bodies_collide: true,
        ..joint(JointKind::Ball, 0, 1)
    };
    assert!(
        filter(links(), vec![open.clone()])(0, 1),
        "a joint that lets them"
    );
    let second = Joint {
        closes_loop: true,
        ..joint(JointKind::Distance, 1, 0)
    };
    let both = filter(links(), vec![open, second]);
    assert!(!both(0, 1), "two joints, one of which does not let them");
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
