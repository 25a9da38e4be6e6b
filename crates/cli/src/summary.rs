//! The few numbers that sum up a run.

use crate::energy::{Drift, exchange};
use kinetarium::model::Model;
use kinetarium::numbers::Float;
use kinetarium::sim::{Simulation, SimulationError, SolverKind};
use std::fmt::Write;
use std::time::Duration;

/// How long a run took.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Time steps of every world.
    pub steps: usize,
    /// Wall time of the stepping alone.
    pub wall: Duration,
}

/// The lines that a run ends with.
pub fn summary<T: Float>(
    simulation: &Simulation<T>,
    effort: Effort,
    drift: Option<Drift>,
    notes: &[Note],
) -> String {
    let (model, settings) = (simulation.model(), simulation.settings());
    let (worlds, wall) = (
        simulation.worlds() as f64,
        effort.wall.as_secs_f64().max(1e-9),
    );
    let simulated = effort.steps as f64 * settings.step.time_step;
    let precision = if T::DOUBLE { "f64" } else { "f32" };
    let picked = match settings.solver {
        SolverKind::Auto => format!(" (auto: {})", reason(model, settings.contacts)),
        _ => String::new(),
    };

    let mut text = String::new();
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<18}{value}");
    };
    line("model", contents(model));
    line("worlds", simulation.worlds().to_string());
    line("solver", format!("{}{picked}", simulation.solver()));
    line(
        "computed with",
        match simulation.device() {
            Some(device) => format!("{precision}, {device}"),
            None => format!(
                "{precision}, {}, {}",
                simulation.isa(),
                threads(simulation.threads())
            ),
        },
    );
    line(
        "simulated",
        format!(
            "{simulated:.3} s in {} steps of {} s",
            effort.steps, settings.step.time_step
        ),
    );
    line("wall time", format!("{wall:.3} s of stepping"));
    line(
        "speed",
        format!(
            "{} world-steps/s",
            rate(worlds * effort.steps as f64 / wall)
        ),
    );
    let real_time = simulated / wall;
    line(
        "real-time factor",
        format!(
            "{} (all worlds), {} (each)",
            rate(worlds * real_time),
            rate(real_time)
        ),
    );
    let (name, value) = energy(drift, exchange(simulation));
    line(name, value);
    line("diverged worlds", diverged(simulation));
    for (name, value) in notes {
        line(name, value.clone());
    }
    text
}

/// What a run came to that it should not often: its name, and how often.
pub type Note = (&'static str, String);

/// Substeps that a card has left to the processor, caps that have bitten, contacts that were forgotten; of those there were.
///
/// # Errors
/// A device fails.
pub fn notes<T: Float>(simulation: &mut Simulation<T>) -> Result<Vec<Note>, SimulationError> {
    let left = simulation.left_to_processor();
    let solver = simulation.solver();
    let outputs = simulation.try_outputs()?;
    let capped: u64 = (0..outputs.worlds()).map(|w| outputs.capped(w)).sum();
    let of_solver = match solver {
        "impulse" => "contacts forgotten",
        _ => "caps that bit",
    };
    let notes = [
        ("by the processor", left, " substeps of worlds"),
        (of_solver, capped, ""),
    ];
    let there = notes.into_iter().filter(|(_, count, _)| *count > 0);
    Ok(there
        .map(|(name, count, unit)| (name, format!("{count}{unit}")))
        .collect())
}

/// Error of the energy; or, where the model's laws change it, by how much they did.
fn energy(drift: Option<Drift>, exchange: Option<String>) -> (&'static str, String) {
    match (drift, exchange) {
        (Some(drift), None) => ("energy drift", drift.to_string()),
        (Some(drift), Some(causes)) => (
            "energy change",
            format!("{:+.3e} J mean, by {causes}", drift.change),
        ),
        (None, _) => ("energy change", "unknown: all worlds diverged".into()),
    }
}

/// Name and sizes of a model.
pub fn contents(model: &Model) -> String {
    format!(
        "{}: {}, {}, {}",
        model.name,
        counted(model.bodies.len(), "body", "bodies"),
        counted(model.joints.len(), "joint", "joints"),
        counted(
            model.degrees_of_freedom(),
            "degree of freedom",
            "degrees of freedom"
        ),
    )
}

/// Why `auto` picks the solver it picks.
pub fn reason(model: &Model, contacts: bool) -> String {
    if SolverKind::Auto.pick(model, contacts) == SolverKind::Impulse {
        return "several things touch".into();
    }
    match &model.loops()[..] {
        [] => "the joints form a tree".into(),
        [one] => format!("{one} is outside the tree"),
        [first, rest @ ..] => format!("{first} and {} more are outside the tree", rest.len()),
    }
}

fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

fn threads(n: usize) -> String {
    counted(n, "thread", "threads")
}

fn diverged<T: Float>(simulation: &Simulation<T>) -> String {
    const SHOWN: usize = 5;
    let diverged = simulation.diverged();
    if diverged.is_empty() {
        return "none".into();
    }
    let first = diverged
        .iter()
        .take(SHOWN)
        .map(|d| format!("{} at {:.3} s", d.world, d.time));
    let first = first.collect::<Vec<_>>().join(", ");
    let more = if diverged.len() > SHOWN { ", …" } else { "" };
    format!(
        "{} of {}: {first}{more}",
        diverged.len(),
        simulation.worlds()
    )
}

/// Three digits, with thousands and millions.
pub fn rate(x: f64) -> String {
    match x {
        x if x >= 1e9 => format!("{:.2} G", 1e-9 * x),
        x if x >= 1e6 => format!("{:.2} M", 1e-6 * x),
        x if x >= 1e4 => format!("{:.1} k", 1e-3 * x),
        x if x >= 100.0 => format!("{x:.0}"),
        x => format!("{x:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinetarium::model::{Builder, Geometry, Pose, Shape, examples::n_pendula};
    use kinetarium::sim::SimulationSettings;

    #[test]
    fn rates_keep_three_digits() {
        let rates = [0.5, 42.0, 1234.0, 56_789.0, 1.234e6, 5e9].map(rate);
        assert_eq!(rates.join(" "), "0.50 42.00 1234 56.8 k 1.23 M 5.00 G");
    }

    /// A body on forty feet, of whose contacts a small world remembers half.
    #[test]
    fn contacts_that_are_forgotten_are_noted() {
        let mut world = Builder::new("feet");
        let ground = Geometry::Plane {
            half_x: 0.0,
            half_z: 0.0,
        };
        world.object("ground").scenery(ground);
        let body = world.object("many").body("many");
        for i in 0..40 {
            let at = glam::DVec3::new(0.1 * f64::from(i), 0.05, 0.1 * f64::from(i % 2));
            let foot = Shape::new(Geometry::Sphere { radius: 0.05 });
            body.shape(foot.at(Pose::at(at)));
        }
        let settings = SimulationSettings {
            solver: SolverKind::Impulse,
            ..SimulationSettings::new(1, 0.004)
        };
        let model = world.build().unwrap();
        let mut simulation = Simulation::<f32>::new(model, settings).unwrap();
        assert_eq!(notes(&mut simulation).unwrap(), []);
        simulation.try_step(5).unwrap();
        let told = notes(&mut simulation).unwrap();
        let [("contacts forgotten", count)] = &told[..] else {
            panic!("{told:?}");
        };
        assert!(count.parse::<u64>().unwrap() > 0);
    }

    #[test]
    fn the_reason_names_what_closes_a_loop() {
        assert_eq!(
            reason(&n_pendula(2).unwrap(), true),
            "the joints form a tree"
        );
        let mut world = Builder::new("tied");
        let object = world.object("pair");
        let a = object
            .body("a")
            .inertia(1.0, glam::DVec3::ZERO, glam::DMat3::IDENTITY)
            .handle();
        object.distance("rope", a, 1.0);
        let model = world.build().unwrap();
        assert_eq!(
            reason(&model, true),
            "distance joint \"rope\" is outside the tree"
        );
    }
}
