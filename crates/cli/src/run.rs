//! A run from the model to the files.

use crate::arguments::{self, Example, Pendula, Precision};
use crate::energy::Audit;
use crate::error::Error;
use crate::output::{Files, print};
use crate::robot;
use crate::summary::{Effort, notes, rate, summary};
use crate::trajectory::Trajectory;
use fastrand::Rng;
use indicatif::{ProgressBar, ProgressStyle};
use kinetarium::model::{Keyframe, Model, examples};
use kinetarium::numbers::Float;
use kinetarium::rigid::{Integrator, Settings};
use kinetarium::sim::{Setting, Simulation, SimulationSettings, SolverKind};
use session::perturb;
use std::time::{Duration, Instant};

/// What the simulation of a model starts from, where the options leave it open.
struct Start {
    /// Stem of the files' names.
    name: String,
    keyframe: Option<Keyframe>,
    worlds: usize,
    /// How a step advances the state, where the solver has a choice.
    integrator: Integrator,
    perturb: f64,
}

/// Simulates a robot file.
pub fn robot(arguments: &arguments::Run) -> Result<(), Error> {
    let loaded = robot::load(&arguments.file, arguments.simulation.quiet)?.model;
    let keyframe = arguments
        .keyframe
        .as_deref()
        .map(|name| loaded.keyframe(name).cloned());
    let start = Start {
        name: robot::stem(&arguments.file.path),
        keyframe: keyframe.transpose()?,
        worlds: loaded.worlds,
        integrator: Integrator::SemiImplicitEuler,
        perturb: 0.0,
    };
    simulate(loaded, &start, &arguments.simulation)
}

/// Simulates a built-in scene.
pub fn example(arguments: &Example) -> Result<(), Error> {
    let model = arguments.scene.model()?;
    let start = Start {
        name: arguments.scene.name.into(),
        keyframe: model.keyframes.first().cloned(),
        worlds: 1,
        integrator: Integrator::SemiImplicitEuler,
        perturb: 0.0,
    };
    simulate(model, &start, &arguments.simulation)
}

/// Simulates the built-in pendula.
pub fn pendula(arguments: &Pendula) -> Result<(), Error> {
    let model = examples::chain(arguments.links, arguments.start.into())?;
    let start = Start {
        name: "pendula".into(),
        keyframe: None,
        worlds: 1024,
        integrator: Integrator::RungeKutta4,
        perturb: 0.01,
    };
    simulate(model, &start, &arguments.simulation)
}

fn simulate(model: Model, start: &Start, options: &arguments::Simulation) -> Result<(), Error> {
    let solver = SolverKind::from(options.solver);
    let double = options.precision == Precision::F64;
    let contacts = !options.no_contacts;
    let picked = solver.pick(&model, contacts);
    let Some(card) = options.device.open_for(picked, double)? else {
        let settings = settings(&model, solver, start, options);
        return match options.precision {
            Precision::F32 => run(Simulation::<f32>::new(model, settings)?, start, options),
            Precision::F64 => run(Simulation::<f64>::new(model, settings)?, start, options),
        };
    };
    let settings = settings(
        &model,
        solver.pick_on(&*card, &model, contacts),
        start,
        options,
    );
    run(Simulation::on(&*card, model, settings)?, start, options)
}

fn settings(
    model: &Model,
    solver: SolverKind,
    start: &Start,
    options: &arguments::Simulation,
) -> SimulationSettings {
    let contacts = !options.no_contacts;
    let substeps = || solver.usual_substeps(model, contacts);
    let integrator = || solver.usual_integrator(model, contacts, start.integrator);
    let usual = Settings::new(options.time_step.unwrap_or(model.time_step));
    let step = Settings {
        substeps: options.substeps.unwrap_or_else(substeps),
        iterations: options.iterations.unwrap_or(usual.iterations),
        integrator: options.integrator.map_or_else(integrator, Into::into),
        ..usual
    };
    SimulationSettings {
        worlds: options.worlds.unwrap_or(start.worlds),
        solver,
        contacts,
        step,
        threads: options.threads,
        isa: options.isa,
        scalar: false,
    }
}

fn run<T: Float>(
    mut simulation: Simulation<T>,
    start: &Start,
    options: &arguments::Simulation,
) -> Result<(), Error> {
    let (record, worlds) = (options.record, simulation.worlds());
    if record > worlds {
        return Err(Error::Record { record, worlds });
    }
    let iterations = Setting::named("iterations");
    if options.iterations.is_some() && !iterations.is_read_by(simulation.solver()) {
        return Err(Error::Iterations {
            readers: iterations.read_by(),
            solver: simulation.solver().into(),
        });
    }
    let schedule = Schedule::new(options, simulation.settings().step.time_step)?;
    let trajectory = Trajectory::new(simulation.model(), record, schedule.rows())?;
    let files = Files::new(&options.out, &start.name)?;
    place(&mut simulation, start, options)?;

    let bar = if options.quiet {
        ProgressBar::hidden()
    } else {
        progress_bar(schedule)
    };
    let (trajectory, audit, wall) = step(&mut simulation, schedule, trajectory, &bar)?;
    bar.finish_and_clear();

    files.write(&heading(&simulation), &trajectory)?;
    if !options.quiet {
        let drift = audit.drift(simulation.diverged());
        let effort = Effort {
            steps: schedule.steps,
            wall,
        };
        let notes = notes(&mut simulation)?;
        print(&format!(
            "{}\n{files}",
            summary(&simulation, effort, drift, &notes)
        ));
    }
    match simulation.diverged() {
        diverged if diverged.len() == worlds => {
            let time = diverged.iter().map(|d| d.time).fold(0.0, f64::max);
            Err(Error::AllDiverged { worlds, time })
        }
        _ => Ok(()),
    }
}

/// When to step and when to record, in time steps.
#[derive(Clone, Copy)]
struct Schedule {
    steps: usize,
    every: usize,
    time_step: f64,
}

impl Schedule {
    fn new(options: &arguments::Simulation, time_step: f64) -> Result<Self, Error> {
        const MOST_STEPS: f64 = 1e12;
        let seconds = options.seconds;
        let steps = (seconds / time_step).round();
        if !(1.0..=MOST_STEPS).contains(&steps) {
            return Err(Error::Steps { seconds, time_step });
        }
        let every = (options.every.unwrap_or(1.0 / 60.0) / time_step)
            .round()
            .clamp(1.0, steps);
        Ok(Self {
            steps: steps as usize,
            every: every as usize,
            time_step,
        })
    }
    /// Rows of the trajectory, with the one at the start.
    fn rows(self) -> usize {
        1 + self.steps.div_ceil(self.every)
    }
}

/// Puts all worlds at the keyframe, or at the model's own state, and moves all but the first apart.
fn place<T: Float>(
    simulation: &mut Simulation<T>,
    start: &Start,
    options: &arguments::Simulation,
) -> Result<(), Error> {
    let model = simulation.model().clone();
    let keyframe = start.keyframe.as_ref();
    let position = keyframe.map_or(model.initial_position(), |k| k.joint_position.clone());
    let rest = vec![0.0; model.degrees_of_freedom()];
    let velocity = keyframe.map_or(&rest, |k| &k.joint_velocity);
    let size = options.perturb.unwrap_or(start.perturb);
    let mut rng = Rng::with_seed(options.seed);
    for world in 0..simulation.worlds() {
        let apart = if world == 0 { 0.0 } else { size };
        let position = perturb(&model, &position, apart, &mut rng);
        simulation.set_joint_state(world, &position, velocity)?;
        if let Some(keyframe) = keyframe {
            simulation
                .controls()
                .set_control(world, &keyframe.control)?;
        }
    }
    Ok(())
}

fn step<T: Float>(
    simulation: &mut Simulation<T>,
    schedule: Schedule,
    mut trajectory: Trajectory,
    bar: &ProgressBar,
) -> Result<(Trajectory, Audit, Duration), Error> {
    let mut audit = Audit::new(&simulation.try_outputs()?);
    trajectory.record(0.0, &simulation.try_outputs()?);
    // A device compiles its kernels before the first step.
    simulation.try_step(0)?;
    let (mut done, mut wall) = (0, Duration::ZERO);
    while done < schedule.steps {
        let next = schedule.every.min(schedule.steps - done);
        wall += advance(simulation, next)?;
        done += next;

        let outputs = simulation.try_outputs()?;
        audit.update(&outputs);
        trajectory.record(done as f64 * schedule.time_step, &outputs);
        let world_steps = (done * outputs.worlds()) as f64;
        bar.set_message(format!(
            "{} world-steps/s",
            rate(world_steps / wall.as_secs_f64().max(1e-9))
        ));
        bar.set_position(done as u64);
    }
    trajectory.note(simulation.diverged());
    Ok((trajectory, audit, wall))
}

/// Makes steps, and tells the wall time that they took. Where a world diverges, they are made once more one by one, for a
/// divergence has the time at which its call ends. On a card it keeps that: to look back there costs more than steps do.
fn advance<T: Float>(simulation: &mut Simulation<T>, steps: usize) -> Result<Duration, Error> {
    let known = simulation.diverged().len();
    let before = match simulation.device() {
        None if steps > 1 => Some(simulation.try_snapshot()?),
        _ => None,
    };
    let begin = Instant::now();
    simulation.try_step(steps)?;
    let wall = begin.elapsed();
    if let Some(before) = before.filter(|_| simulation.diverged().len() > known) {
        simulation.restore(&before)?;
        for _ in 0..steps {
            simulation.try_step(1)?;
        }
    }
    Ok(wall)
}

fn progress_bar(schedule: Schedule) -> ProgressBar {
    let style =
        ProgressStyle::with_template("{bar:40.cyan/blue} {percent:>3} %  {msg}  {eta} left");
    let bar = ProgressBar::new(schedule.steps as u64);
    // The default style shows the same, less prettily.
    style.map_or(bar.clone(), |style| bar.with_style(style))
}

fn heading<T: Float>(simulation: &Simulation<T>) -> String {
    let (name, solver) = (&simulation.model().name, simulation.solver());
    match simulation.worlds() {
        1 => format!("{name}  ·  {solver}"),
        worlds => format!("{name}  ·  world 0 of {worlds}  ·  {solver}"),
    }
}
