//! What solving the contacts of piles moves.

use crate::alone::moved;
use kinetarium::numbers::trace::Program;
use kinetarium::numbers::{Cpu, Shared};
use kinetarium::rigid::impulse::{ContactTables, global, row};
use kinetarium::sim::{Simulation, SimulationError};
use records::PilePrograms;
use std::collections::HashSet;

/// Bytes that the two stages move in a step of all worlds: of contacts as many as there are now, of each as many points as
/// they have on the average.
pub fn solving(worlds: &mut Simulation<f32>) -> Result<[(&'static str, f64); 2], SimulationError> {
    let small_steps = worlds.settings().step.contact_iterations as f64;
    let outputs = worlds.try_outputs()?;
    let (mut points, mut contacts) = (0, 0);
    for world in 0..outputs.worlds() {
        let shapes = outputs.contacts(world).map(|contact| contact.shapes);
        let shapes = Vec::from_iter(shapes);
        points += shapes.len();
        contacts += HashSet::<_>::from_iter(shapes).len();
    }
    let programs = PilePrograms::record().expect("the kernels are recorded");
    let stages = [("pushing", &programs.push), ("relaxing", &programs.relax)];
    Ok(stages.map(|(name, program)| {
        let [one, two] = [1, 2].map(|points| bytes(program, points));
        let all = contacts as f64 * (2.0 * one - two) + points as f64 * (two - one);
        (name, small_steps * all)
    }))
}

/// Of a contact of so many points.
fn bytes(program: &Program, points: u32) -> f64 {
    let work = program.work(&mut Cpu {
        state: &mut vec![0.1; ContactTables::new().length],
        input: &[],
        output: &mut [],
        scratch: &mut [0.1; 2 * row::PREPARED],
        parameters: Shared(&[0.1; global::WIDTH]),
        links: &[points],
    });
    moved(work.expect("the record runs")) as f64
}
