//! Bodies that touch.

use super::{Example, no_fields};
use crate::protocol::Field;
use crate::stage::Stage;
use model::examples::{self, Collide, Form as Solid};

pub(super) const BALLS: Example = Example {
    name: "balls",
    title: "Balls",
    about: "five balls bounce, each by its restitution",
    guide: "Run. From left to right the restitution e is 0, ¼, ½, ¾, 1: each ball comes up again to e² of the \
            height it fell from, and the last one bounces for ever. Plot the heights and measure.",
    build: no_fields,
    make: |_| {
        let heights = ["0", "0.25", "0.5", "0.75", "1"].map(|e| format!("e_{e} height"));
        Ok(Stage {
            plots: heights.to_vec(),
            ..Stage::new(examples::balls()?)
        })
    },
};

pub(super) const BILLIARDS: Example = Example {
    name: "billiards",
    title: "Billiards",
    about: "elastic balls on a smooth table",
    guide: "Run slowly. Head-on, equal balls change places; off centre, they part at a right angle; in the row of \
            five the impact runs through, and the last one leaves. The kinetic energy stays.",
    build: no_fields,
    make: |_| Ok(Stage::new(examples::billiards()?).at_first_keyframe()),
};

pub(super) const COLLIDE: Example = Example {
    name: "collide",
    title: "Collide",
    about: "a pusher drives one solid against another",
    guide: "Run. The pusher stops at the end of its way, and what it pushed slides on, slowed by friction. \
            Choose other solids, masses and friction, rebuild, and see who moves whom: a heavy cube \
            carries a light ball along, a light one stops.",
    build: || {
        const FORMS: [&str; 5] = ["cube", "ball", "cylinder", "cone", "capsule"];
        vec![
            Field::choice("first", "Pushed solid", 0, &FORMS).help("The solid that is pushed."),
            Field::choice("second", "Met solid", 1, &FORMS).help("The solid that it meets."),
            Field::logarithmic("first_mass", "Mass pushed", "kg", 1.0, [0.01, 100.0])
                .help("Mass of the solid that is pushed."),
            Field::logarithmic("second_mass", "Mass met", "kg", 1.0, [0.01, 100.0])
                .help("Mass of the solid that it meets."),
            Field::number("friction", "Friction", "", 0.4, [0.0, 1.5])
                .help("Coulomb's coefficient, of everything."),
            Field::number("restitution", "Restitution", "", 0.3, [0.0, 1.0])
                .help("Speed after the impact over the speed before."),
            Field::number("speed", "Pusher", "m/s", 1.5, [0.0, 5.0]).help("Speed of the pusher."),
        ]
    },
    make: |form| {
        let solid = |name| Solid::ALL[form.integer(name)];
        let model = examples::collide(Collide {
            forms: ["first", "second"].map(solid),
            masses: ["first_mass", "second_mass"].map(|name| form.number(name)),
            friction: form.number("friction"),
            restitution: form.number("restitution"),
            speed: form.number("speed"),
        })?;
        Ok(Stage {
            plots: vec!["pushed speed".into(), "met speed".into()],
            ..Stage::new(model)
        })
    },
};

pub(super) const DOMINOES: Example = Example {
    name: "dominoes",
    title: "Dominoes",
    about: "the first falls, and then all",
    guide: "Run: the wave soon goes at a constant speed. Stop it with the mouse by holding one, or push one from \
            the middle of the row and see the wave run one way only.",
    build: || vec![Field::integer("count", "Dominoes", 20, [2, 200]).help("In the row.")],
    make: |form| Ok(Stage::new(examples::dominoes(form.integer("count"))?)),
};

pub(super) const TOWER: Example = Example {
    name: "tower",
    title: "Tower",
    about: "boxes on each other, at rest",
    guide: "Run: the boxes settle on each other and stand. Push one from the middle, or drag it out slowly. \
            With another solver or a longer step the tower may sway: see what it takes to topple it.",
    build: || {
        vec![
            Field::integer("count", "Boxes", 10, [1, 40]).help("On each other."),
            Field::number("gap", "Gap", "m", 0.001, [0.0, 0.1]).help("Between them at the start."),
        ]
    },
    make: |form| {
        let model = examples::tower(form.integer("count"), form.number("gap"))?;
        Ok(Stage::new(model))
    },
};

pub(super) const PYRAMID: Example = Example {
    name: "pyramid",
    title: "Pyramid",
    about: "a wall of boxes, at rest",
    guide: "Run: it stands. Show contact forces and see the weight grow towards the ground. \
            Pull a box out at the foot, and what was above comes down.",
    build: || vec![Field::integer("rows", "Rows", 6, [1, 25]).help("Of boxes.")],
    make: |form| Ok(Stage::new(examples::pyramid(form.integer("rows"))?)),
};

pub(super) const CARD_HOUSE: Example = Example {
    name: "card_house",
    title: "House of cards",
    about: "leaning cards that stand by friction alone",
    guide: "Run: it stands for as long as you like. A touch is enough to make it fall: \
            push a card at the foot, and restart.",
    build: || vec![Field::integer("storeys", "Storeys", 3, [1, 6]).help("Of the house.")],
    make: |form| Ok(Stage::new(examples::card_house(form.integer("storeys"))?)),
};

pub(super) const ARCH: Example = Example {
    name: "arch",
    title: "Arch",
    about: "wedges of stone that hold each other",
    guide: "Run: nothing but friction and weight holds the stones. Show contact forces to see the line of thrust. \
            Drag the keystone up, and see the arch fall.",
    build: || vec![Field::integer("stones", "Stones", 9, [3, 21]).help("Of the arch.")],
    make: |form| Ok(Stage::new(examples::arch(form.integer("stones"))?)),
};

pub(super) const PILE: Example = Example {
    name: "pile",
    title: "Pile",
    about: "solids of six kinds fall into a bowl",
    guide: "Run: spheres roll to the middle, boxes come to rest on each other. Drag one out from below. \
            Rebuild with more, and watch the rate of steps in the status line.",
    build: || vec![Field::integer("count", "Solids", 40, [1, 400]).help("That fall.")],
    make: |form| Ok(Stage::new(examples::pile(form.integer("count"))?)),
};

pub(super) const TERRAIN: Example = Example {
    name: "terrain",
    title: "Terrain",
    about: "solids tumble down a hillside of triangles",
    guide: "Run: what is round rolls on, what has edges comes to rest. The ball rolls over the seams between \
            triangles without a bump: follow it with the camera.",
    build: || vec![Field::integer("count", "Solids", 15, [1, 50]).help("That tumble.")],
    make: |form| Ok(Stage::new(examples::terrain(form.integer("count"))?)),
};

pub(super) const RINGS: Example = Example {
    name: "rings",
    title: "Rings",
    about: "rings of triangles fall around a peg, and hang as a chain",
    guide: "Run: rings are surfaces of triangles with a hole, and fall around the peg. The chain hangs by nothing but \
            the shape of its links: drag the lowest one, and all follow.",
    build: || vec![Field::integer("count", "Rings", 4, [1, 12]).help("That fall on the peg.")],
    make: |form| Ok(Stage::new(examples::rings(form.integer("count"))?)),
};
