//! People and robots.

use super::Example;
use crate::SessionError;
use crate::protocol::{Camera, Field, Placement};
use crate::stage::Stage;
use formats::{InMemory, Options};
use model::{CameraMode, Model, examples};

/// Reads a model of this program.
fn read(name: &str, text: &str) -> Result<Model, SessionError> {
    let files = InMemory::new([(name, text)]);
    let loaded = formats::parse(text, name, &files, &Options::default()).map_err(Box::new)?;
    Ok(loaded.model)
}

fn humanoid() -> Result<Model, SessionError> {
    read("humanoid.xml", include_str!("../../models/humanoid.xml"))
}

/// How much random controls of all motors use of their range.
fn wander() -> Field {
    Field::number("wander", "Random motors", "", 0.0, [0.0, 1.0])
        .help("Random controls, drawn anew ten times a second, as a share of each motor's range.")
}

pub(super) const RAGDOLLS: Example = Example {
    name: "ragdolls",
    title: "Ragdolls",
    about: "limp people fall on the floor and on each other",
    guide: "Run: joints hold, knees and elbows bend one way only, and the heap comes to rest. \
            Drag somebody out of it by a hand.",
    build: || vec![Field::integer("people", "People", 4, [1, 20]).help("In the heap.")],
    make: |form| Ok(Stage::new(examples::ragdolls(form.integer("people"))?)),
};

pub(super) const ROOM: Example = Example {
    name: "room",
    title: "Room",
    about: "a robot drives through a room, and sees",
    guide: "Run, and steer the robot by the target velocities of its wheels: along x, along z, and turning. \
            The inset shows what it sees from its head, which turns and nods by its own sliders. \
            It pushes the chair, and stops at the wall.",
    build: super::no_fields,
    make: |_| {
        let model = examples::rover()?;
        let head = model.body("head")?;
        let eye = Camera {
            name: "Robot".into(),
            body: head.0 as i32,
            mode: CameraMode::Fixed,
            placement: Placement {
                position: [0.0, 0.0, -0.09],
                orientation: [0.0, 0.0, 0.0, 1.0],
            },
            field_of_view: 1.2,
        };
        Ok(Stage {
            cameras: vec![eye],
            sliders: vec!["wheels".into(), "neck".into()],
            plots: vec!["cart speed".into(), "Contact force".into()],
            ..Stage::new(model)
        })
    },
};

pub(super) const LINKAGE: Example = Example {
    name: "linkage",
    title: "Walking linkage",
    about: "a machine walks on closed loops of bars, which one motor turns",
    guide: "Run: each leg is a linkage of eight links, whose loops turn the crank's circle into a step that is flat \
            below. Set the motor's target velocity, backwards too, and it walks as fast as that says. Look at a foot \
            from the side: while one stands, another swings forward, high above.",
    build: || {
        vec![
            Field::integer("pairs", "Pairs of legs", 3, [2, 3])
                .help("Each at its own phase of the crank."),
        ]
    },
    make: |form| {
        Ok(Stage {
            sliders: vec!["axle".into()],
            plots: vec!["hull height".into(), "Contact force".into()],
            ..Stage::new(examples::linkage(form.integer("pairs"))?)
        })
    },
};

pub(super) const HUMANOID: Example = Example {
    name: "humanoid",
    title: "Humanoid",
    about: "a person of 21 motors, from an MJCF file",
    guide: "Run: without control it stands for a moment and falls. Hold it by the head with the mouse, move the \
            motors' sliders, or rebuild with random motors. It lies still in the end, and its joints keep \
            within their limits.",
    build: || vec![wander()],
    make: |form| {
        Ok(Stage {
            wander: form.number("wander"),
            plots: vec!["torso height".into(), "Contact force".into()],
            ..Stage::new(humanoid()?)
        })
    },
};

pub(super) const ANT: Example = Example {
    name: "ant",
    title: "Ant",
    about: "a walker on four legs, from an MJCF file",
    guide: "Run: it stands on its legs. With random motors it crawls. Move the motors of two legs on one side and \
            see it turn; push it over and see whether it can get up.",
    build: || vec![wander()],
    make: |form| {
        let model = read("ant.xml", include_str!("../../models/ant.xml"))?;
        Ok(Stage {
            wander: form.number("wander"),
            plots: vec!["torso height".into(), "Contact force".into()],
            ..Stage::new(model).at_first_keyframe()
        })
    },
};

pub(super) const GRID: Example = Example {
    name: "grid",
    title: "64 worlds",
    about: "64 humanoids with random motors, side by side",
    guide: "Run: every world is a simulation of its own, stepped side by side in the lanes of the processor. \
            Choose one replica to look at, or show them all; each has other random motors, and none \
            knows of the others.",
    build: || {
        vec![
            Field::integer("worlds", "Worlds", 64, [1, 256]).help("Side by side."),
            Field {
                value: 0.5,
                ..wander()
            },
        ]
    },
    make: |form| {
        let worlds = form.integer("worlds");
        Ok(Stage {
            worlds,
            shown: worlds,
            perturb: 0.05,
            wander: form.number("wander"),
            plots: vec!["torso height".into()],
            ..Stage::new(humanoid()?)
        })
    },
};
