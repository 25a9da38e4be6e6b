//! What the builder is told.

use glam::DVec3;
use kinetarium_model::{Builder, Geometry, ModelError, Shape};

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
