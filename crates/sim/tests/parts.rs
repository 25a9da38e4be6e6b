//! The unit tests of the library. It has no test target of its own, which would compile all its kernels once more:
//! modules that are private are compiled here by themselves.

#[path = "../src/impulse/colours.rs"]
mod colours;
#[path = "../src/meshes.rs"]
#[expect(dead_code, reason = "only what it keeps is tested here")]
mod meshes;
#[path = "../src/impulse/odometers.rs"]
#[expect(dead_code, reason = "only its geometry is tested here")]
mod odometers;
#[path = "../src/impulse/pace.rs"]
mod pace;
#[path = "../src/ranges.rs"]
mod ranges;
#[path = "../src/impulse/shares.rs"]
mod shares;
#[path = "../src/impulse/team.rs"]
mod team;

use kinetarium_sim::SolverKind;
use model::{Builder, Geometry, Model};

/// Balls on ropes, which are no trees.
fn hanging(balls: usize) -> Model {
    let mut world = Builder::new("balls");
    let object = world.object("balls");
    for i in 0..balls {
        let sphere = Geometry::Sphere { radius: 0.1 };
        let ball = object.body(format!("ball {i}")).shape(sphere).handle();
        object.distance(format!("rope {i}"), ball, 1.0);
    }
    world.build().unwrap()
}

#[test]
fn substeps_are_those_of_the_solver_that_is_picked() {
    let (one, two, many) = (hanging(1), hanging(2), hanging(65));
    assert!(!one.is_tree() && !two.is_tree());
    for (solver, model, contacts, substeps) in [
        // A loop: `featherstone`.
        (SolverKind::Auto, &one, true, 1),
        // Several things that touch: `impulse`.
        (SolverKind::Auto, &two, true, 1),
        (SolverKind::Auto, &two, false, 1),
        // Many loops: `xpbd`.
        (SolverKind::Auto, &many, false, 4),
        (SolverKind::Xpbd, &two, true, 4),
    ] {
        let found = solver.usual_substeps(model, contacts);
        assert_eq!(
            found,
            substeps,
            "{solver:?} of {} balls",
            model.bodies.len()
        );
    }
}
