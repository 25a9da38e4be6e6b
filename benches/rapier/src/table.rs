//! The results in Markdown.

use crate::contest::{DROP_AT, LEAD, Measured, REST_AT, ROUND};
use crate::engine::{OURS, TIME_STEP};
use crate::scene::Scene;
use rapier3d::prelude::IntegrationParameters;

pub fn heading() -> &'static str {
    "| scene | engine | threads | ms/step | ours / Rapier | drop, mean mm | drop, most mm | points | ns/point |\n\
     |---|---|--:|--:|--:|--:|--:|--:|--:|"
}

/// A row for each engine; the ratio is that of our time to its own.
pub fn rows(scene: &Scene, threads: usize, results: &[Measured]) -> Vec<String> {
    let ours = results.iter().find(|m| m.engine == OURS);
    let mut rows = Vec::new();
    for measured in results {
        let seconds = measured.seconds_per_step;
        let ratio = ours.filter(|_| measured.engine != OURS);
        let ratio = ratio.map_or(String::new(), |m| {
            format!("{:.2}", m.seconds_per_step / seconds)
        });
        let (mean, most) = measured.drop.map_or(Default::default(), |drop| {
            (millimetres(drop.mean), millimetres(drop.most))
        });
        let (points, each) = measured.points.map_or(Default::default(), |points| {
            (
                points.to_string(),
                format!("{:.0}", 1e9 * seconds / points as f64),
            )
        });
        rows.push(format!(
            "| {} | {} | {threads} | {:.3} | {ratio} | {mean} | {most} | {points} | {each} |",
            scene.name,
            measured.engine,
            1e3 * seconds,
        ));
    }
    rows
}

pub fn heading_at_rest() -> &'static str {
    "| at rest | threads | ms/step | points | ns/point |\n\
     |---|--:|--:|--:|--:|"
}

/// Our row of a scene at rest.
pub fn row_at_rest(scene: &Scene, threads: usize, measured: &Measured) -> String {
    let (seconds, points) = (measured.seconds_per_step, measured.points.unwrap_or(0));
    format!(
        "| {} | {threads} | {:.3} | {points} | {:.0} |",
        scene.name,
        1e3 * seconds,
        1e9 * seconds / points as f64,
    )
}

pub fn conditions_at_rest() -> String {
    format!("The same after {REST_AT} steps, Kinetarium alone.")
}

fn millimetres(metres: f64) -> String {
    format!("{:.2}", 1e3 * metres)
}

/// What the figures were measured with.
pub fn conditions(rounds: usize) -> String {
    let p = IntegrationParameters::default();
    let (contact, fixed) = (p.contact_softness, p.static_contact_softness);
    format!(
        "Time step {} ms; medians of {rounds} rounds of {ROUND} steps (10 in the largest bowl) after the first {LEAD}, turn about;\n\
         drops after {} s; points of contact that press in the end.\n\
         Rapier {} (f32, `parallel`, {} lanes) at its default integration parameters: {} solver iterations with {} internal and {}\n\
         stabilisation iterations each, contact softness {} Hz and {} (with what is fixed {} Hz and {}), warm start {},\n\
         prediction {} mm, {:?} friction, contact recycling {}, contact clustering {}. No body is put to sleep.\n\
         Unit 0.1 m: the same with `length_unit` at 0.1, which scales tolerances to bodies of that size.",
        1e3 * TIME_STEP,
        DROP_AT as f64 * TIME_STEP,
        rapier3d::VERSION,
        if cfg!(feature = "simd8") { 8 } else { 4 },
        p.num_solver_iterations,
        p.num_internal_pgs_iterations,
        p.num_internal_stabilization_iterations,
        contact.natural_frequency,
        contact.damping_ratio,
        fixed.natural_frequency,
        fixed.damping_ratio,
        p.warmstart_coefficient,
        1e3 * p.prediction_distance(),
        p.friction_model,
        if p.contact_recycling { "on" } else { "off" },
        if p.contact_clustering { "on" } else { "off" },
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contest::Descent;
    use crate::scene::SCENES;

    #[test]
    fn the_peer_has_the_ratio_and_the_drop_is_in_millimetres() {
        let of = |engine, seconds_per_step| Measured {
            engine,
            seconds_per_step,
            drop: Some(Descent {
                mean: 0.01,
                most: 0.0105,
            }),
            points: (engine == OURS).then_some(2000),
        };
        let rows = rows(&SCENES[0], 2, &[of(OURS, 0.001), of("Rapier", 0.002)]);
        let scene = SCENES[0].name;
        assert_eq!(
            rows[0],
            format!("| {scene} | Kinetarium | 2 | 1.000 |  | 10.00 | 10.50 | 2000 | 500 |")
        );
        assert_eq!(
            rows[1],
            format!("| {scene} | Rapier | 2 | 2.000 | 0.50 | 10.00 | 10.50 |  |  |")
        );
        assert_eq!(
            row_at_rest(&SCENES[0], 2, &of(OURS, 0.001)),
            format!("| {scene} | 2 | 1.000 | 2000 | 500 |")
        );
    }
}
