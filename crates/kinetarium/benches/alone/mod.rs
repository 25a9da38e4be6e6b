//! Kernels of a solver by themselves: how long a card takes for one, and how many bytes it moves.

use crate::{REPETITIONS, SECONDS};
use kinetarium::numbers::trace::{Program, Work};
use kinetarium::numbers::{Cpu, Memory, Shared};
use kinetarium::rigid::{Report, Solver};
use kinetarium::sim::{Device, DeviceError, DeviceWorlds, Simulation};
use records::Programs;
use std::error::Error;
use std::slice::from_ref;
use std::time::Instant;

const REPORTS: [(&str, Report); 4] = [
    ("report of joints", Report::Joints),
    ("of motion", Report::Motion),
    ("of contacts", Report::Contacts),
    ("of everything", Report::Everything),
];

/// What one launch of a kernel takes.
pub struct Alone {
    pub kernel: &'static str,
    pub seconds: f64,
    /// Bytes that a world moves.
    pub bytes: u64,
}

/// Each kernel of a solver, of all worlds.
pub fn alone(
    card: &dyn Device<f32>,
    simulation: &mut Simulation<f32>,
) -> Result<Vec<Alone>, Box<dyn Error>> {
    let (programs, mut world) = recorded(simulation)?;
    let solver = solver(simulation)?;
    let mut worlds = card.place(solver, simulation.worlds())?;
    let [mut state, mut input] = [programs.lengths.state, programs.lengths.input]
        .map(|length| Memory::new(simulation.worlds(), length, 16));
    for nth in 0..simulation.worlds() {
        let numbers = simulation.numbers_of_world(nth)?;
        for (memory, numbers) in [(&mut state, numbers.state), (&mut input, numbers.input)] {
            let numbers = numbers.iter().take(memory.length()).enumerate();
            numbers.for_each(|(i, x)| memory.set(nth, i, *x as f32));
        }
    }
    worlds.write_state(&state)?;
    worlds.write_input(0..input.length(), &input)?;
    let mut kernels = Vec::new();
    for (kernel, report) in REPORTS {
        let seconds = median(&mut *worlds, &mut state, |worlds| worlds.report(report))?;
        let bytes = moved(world.work(&programs, programs.report(report))?);
        kernels.push(Alone {
            kernel,
            seconds,
            bytes,
        });
    }
    let step = |worlds: &mut dyn DeviceWorlds<f32>| worlds.step(1, &mut |_, _, _| ());
    let seconds = median(&mut *worlds, &mut state, step)?;
    let bytes = moved(world.work(&programs, &programs.step)?);
    let kernel = "step";
    kernels.insert(
        0,
        Alone {
            kernel,
            seconds,
            bytes,
        },
    );
    Ok(kernels)
}

/// Bytes that are read and written.
pub fn moved(work: Work) -> u64 {
    (work.loads + work.stores) * size_of::<f32>() as u64
}

/// How long one launch takes [s] of many, after which the card is waited for.
fn median(
    worlds: &mut dyn DeviceWorlds<f32>,
    state: &mut Memory<f32>,
    launch: impl Fn(&mut dyn DeviceWorlds<f32>) -> Result<(), DeviceError>,
) -> Result<f64, DeviceError> {
    let mut timed = |n: usize| {
        let begin = Instant::now();
        for _ in 0..n {
            launch(worlds)?;
        }
        worlds.read_state(from_ref(&(0..1)), state)?;
        Ok::<_, DeviceError>(begin.elapsed().as_secs_f64())
    };
    let mut n = 1;
    while timed(n)? < SECONDS {
        n *= 2;
    }
    let mut times = Vec::new();
    for _ in 0..REPETITIONS {
        times.push(timed(n)? / n as f64);
    }
    times.sort_by(f64::total_cmp);
    Ok(times[REPETITIONS / 2])
}

/// A world's memories, to run a record in.
pub struct Recorded {
    state: Vec<f32>,
    input: Vec<f32>,
    output: Vec<f32>,
    scratch: Vec<f32>,
    parameters: Vec<f32>,
}

impl Recorded {
    /// What a kernel takes.
    pub fn work(&mut self, programs: &Programs, program: &Program) -> Result<Work, Box<dyn Error>> {
        Ok(program.work(&mut Cpu {
            state: &mut self.state,
            input: &self.input,
            output: &mut self.output,
            scratch: &mut self.scratch,
            parameters: Shared(&self.parameters),
            links: &programs.links,
        })?)
    }
}

fn solver(worlds: &Simulation<f32>) -> Result<Solver<'_>, Box<dyn Error>> {
    let plain = worlds.kernels(0)?.map(Solver::Featherstone);
    let touching = worlds.kernels(0)?.map(Solver::TouchingFeatherstone);
    let either = plain.or(touching);
    either.ok_or_else(|| "the solver has no record".into())
}

/// The records of the solver, and world 0 as it is now.
pub fn recorded(worlds: &mut Simulation<f32>) -> Result<(Programs, Recorded), Box<dyn Error>> {
    let numbers = worlds.numbers_of_world(0)?;
    let programs = Programs::record(solver(worlds)?)?;
    let l = programs.lengths;
    let single = |x: &[f64]| x.iter().map(|x| *x as f32).collect::<Vec<_>>();
    let world = Recorded {
        state: single(&numbers.state),
        input: single(&numbers.input),
        output: vec![0.0; l.output],
        scratch: vec![0.0; l.scratch],
        parameters: single(&programs.parameters),
    };
    Ok((programs, world))
}
