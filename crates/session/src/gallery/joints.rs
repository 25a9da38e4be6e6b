//! Joints and what drives them.

use super::{Example, no_fields};
use crate::protocol::Field;
use crate::stage::Stage;
use model::examples::{self, Start};
use rigid::Integrator;

const STARTS: [Start; 3] = [Start::Hanging, Start::Horizontal, Start::Upright];

pub(super) const PENDULA: Example = Example {
    name: "pendula",
    title: "N pendula",
    about: "a chain of rods on hinges swings",
    guide: "Press Run. The kinetic and the potential energy change places, and their sum stays. \
            Rebuild with more links, or start upright, and compare the solvers under Physics: \
            from a few links on the motion is chaotic, and yet no energy is lost.",
    build: || {
        vec![
            Field::integer("links", "Links", 3, [1, 30]).help("Rods of the chain, 3 m in all."),
            Field::choice("start", "Start", 1, &["hanging", "horizontal", "upright"])
                .help("How the chain starts."),
            Field::integer("worlds", "Worlds", 16, [1, 64])
                .help("Each world but the first starts a hundredth of a radian apart."),
        ]
    },
    make: |form| {
        let start = STARTS[form.integer("start")];
        let model = examples::chain(form.integer("links"), start)?;
        Ok(Stage {
            worlds: form.integer("worlds"),
            integrator: Integrator::RungeKutta4,
            perturb: 0.01,
            ..Stage::new(model)
        })
    },
};

pub(super) const PRISMATIC: Example = Example {
    name: "prismatic",
    title: "Prismatic joint",
    about: "a motor moves a carriage along a rail",
    guide: "Run, and move the target position: the carriage follows as a mass on a spring and a damper. \
            With 40 N·s/m of damping and 200 N/m it is critical; with less it overshoots. Without \
            stiffness the damping alone follows the target velocity, up to the stop at the rail's end.",
    build: no_fields,
    make: |_| {
        Ok(Stage {
            sliders: vec!["slider".into()],
            plots: vec!["slider".into(), "slider (speed)".into()],
            ..Stage::new(examples::prismatic()?)
        })
    },
};

pub(super) const BALL_JOINT: Example = Example {
    name: "ball_joint",
    title: "Ball joint",
    about: "three motors turn an arm every way",
    guide: "Run, and move the three angles: they are a rotation vector, so that the arm turns about their sum. \
            Less stiffness lets it sag under its weight; less damping lets it swing. Drag the arm with the \
            mouse, and let it go.",
    build: no_fields,
    make: |_| {
        Ok(Stage {
            sliders: vec!["shoulder".into()],
            plots: vec!["arm height".into(), "arm speed".into()],
            ..Stage::new(examples::ball_joint()?)
        })
    },
};
