//! Who drives the worlds, and how a drive is recorded and played back.

use crate::error::length;
use crate::{Controls, Diverged, Outputs, Simulation, SimulationError};
use numbers::Float;
use std::ops::Range;

/// Sets the controls of all worlds, once every control period.
///
/// A closure over the same three arguments is a controller.
pub trait Controller<T: Float> {
    /// Reads how the worlds are, and sets what acts on them until the next call.
    ///
    /// `time` is that of the worlds [s]; where they differ, the latest.
    ///
    /// # Errors
    /// Whatever stops the run, such as a control out of range.
    fn control(
        &mut self,
        time: f64,
        outputs: &Outputs<'_, T>,
        controls: &mut Controls<'_, T>,
    ) -> Result<(), SimulationError>;
}

impl<T, F> Controller<T> for F
where
    T: Float,
    F: FnMut(f64, &Outputs<'_, T>, &mut Controls<'_, T>) -> Result<(), SimulationError>,
{
    fn control(
        &mut self,
        time: f64,
        outputs: &Outputs<'_, T>,
        controls: &mut Controls<'_, T>,
    ) -> Result<(), SimulationError> {
        self(time, outputs, controls)
    }
}

impl<T: Float> Simulation<T> {
    /// Advances all worlds by `seconds`, rounded to whole time steps, and returns those that
    /// diverged meanwhile.
    ///
    /// The controller is called before the first step, and then every `period` seconds.
    ///
    /// # Errors
    /// A time that is no positive number, a period that is no whole number of time steps, a device that fails,
    /// and what the controller returns; the worlds then stay where they were at that call.
    pub fn run(
        &mut self,
        seconds: f64,
        period: f64,
        controller: &mut impl Controller<T>,
    ) -> Result<&[Diverged], SimulationError> {
        let time_step = self.settings().step.time_step;
        let mut left = steps("run time [s]", seconds, time_step)?;
        let each = steps("control period [s]", period, time_step)?;
        if (period / time_step - each as f64).abs() > 1e-6 * each as f64 {
            return Err(setting(
                "control period [s]",
                period,
                "a whole number of time steps",
            ));
        }
        let known = self.diverged.len();
        while left > 0 {
            self.consult(controller)?;
            let next = each.min(left);
            self.try_step(next)?;
            left -= next;
        }
        Ok(&self.diverged[known..])
    }

    fn consult(&mut self, controller: &mut impl Controller<T>) -> Result<(), SimulationError> {
        let time = self.time.iter().copied().fold(0.0, f64::max);
        self.try_outputs()?;
        // New controls change the accelerations that were just reported.
        self.reported = None;
        let outputs = Outputs {
            memory: &self.output,
            tables: &self.output_tables,
            shapes: self.shared.engine.contact_shapes(),
        };
        let mut controls = Controls {
            memory: &mut self.input,
            tables: &self.input_tables,
            changes: &mut self.changes,
            // With the outputs they have become known.
            shared: false,
        };
        controller.control(time, &outputs, &mut controls)
    }
}

/// The number of time steps nearest to a time, at least one.
fn steps(what: &'static str, seconds: f64, time_step: f64) -> Result<usize, SimulationError> {
    let steps = (seconds / time_step).round();
    // Beyond 2⁵³ whole numbers are no longer exact.
    if !(1.0..=9_007_199_254_740_992.0).contains(&steps) {
        return Err(setting(what, seconds, "at least one time step, and finite"));
    }
    Ok(steps as usize)
}

fn setting(what: &'static str, value: f64, remedy: &'static str) -> SimulationError {
    SimulationError::Setting {
        what: what.into(),
        value: value.to_string(),
        remedy: remedy.into(),
    }
}

/// The controls of all worlds over time, to the bit: runs, within which each moment is later than the one before.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    moments: Vec<Moment>,
}

/// What was set at one call of a controller.
#[derive(Clone, Debug, PartialEq)]
struct Moment {
    time: f64,
    /// [`Controls::of_world`] of one world after the other.
    numbers: Vec<f64>,
}

impl Recording {
    /// Times [s] at which controls were set, in the order of the calls.
    pub fn times(&self) -> impl Iterator<Item = f64> + '_ {
        self.moments.iter().map(|m| m.time)
    }
    /// The moments of the run that begins with one.
    fn run_from(&self, start: usize) -> Range<usize> {
        let mut runs = self.moments[start..].chunk_by(|a, b| a.time < b.time);
        start..start + runs.next().map_or(0, <[_]>::len)
    }
}

/// Passes on to a controller, and records what it sets.
#[derive(Clone, Debug)]
pub struct Recorder<C> {
    controller: C,
    recording: Recording,
}

impl<C> Recorder<C> {
    /// Records a controller.
    pub fn new(controller: C) -> Self {
        Self {
            controller,
            recording: Recording::default(),
        }
    }
    /// What was recorded.
    pub fn into_recording(self) -> Recording {
        self.recording
    }
}

impl<T: Float, C: Controller<T>> Controller<T> for Recorder<C> {
    fn control(
        &mut self,
        time: f64,
        outputs: &Outputs<'_, T>,
        controls: &mut Controls<'_, T>,
    ) -> Result<(), SimulationError> {
        self.controller.control(time, outputs, controls)?;
        let mut numbers = Vec::new();
        for world in 0..controls.worlds() {
            numbers.extend(controls.of_world(world)?);
        }
        self.recording.moments.push(Moment { time, numbers });
        Ok(())
    }
}

/// Plays a recording: at each call, what was last set at or before that time.
///
/// From the same state, with the same settings, all worlds move as they did, to the bit. A recording that spans resets is
/// played run by run, of which each goes on for as long as time did: first the first; wherever the time of a call is not
/// after that of the last call, the next; after the last one the first again.
#[derive(Clone, Debug)]
pub struct Replay {
    recording: Recording,
    /// The moments of the run that is played.
    run: Range<usize>,
    /// Time [s] of the last call.
    time: f64,
}

impl Replay {
    /// Plays a recording.
    pub fn new(recording: Recording) -> Self {
        Self {
            run: recording.run_from(0),
            recording,
            time: f64::NEG_INFINITY,
        }
    }
    /// What was last set at or before a time [s].
    fn moment(&mut self, time: f64) -> Option<&Moment> {
        let all = &self.recording.moments;
        if time <= self.time {
            let next = self.run.end % all.len().max(1);
            self.run = self.recording.run_from(next);
        }
        self.time = time;
        let run = &all[self.run.clone()];
        run[..run.partition_point(|m| m.time <= time)].last()
    }
}

impl<T: Float> Controller<T> for Replay {
    /// # Errors
    /// The recording is of another model, or of another number of worlds.
    fn control(
        &mut self,
        time: f64,
        _: &Outputs<'_, T>,
        controls: &mut Controls<'_, T>,
    ) -> Result<(), SimulationError> {
        let Some(moment) = self.moment(time) else {
            return Ok(());
        };
        let (worlds, each) = (controls.worlds(), controls.tables.length);
        length("recording", moment.numbers.len(), worlds * each)?;
        (0..worlds).try_for_each(|w| controls.set_world(w, &moment.numbers[w * each..][..each]))
    }
}
