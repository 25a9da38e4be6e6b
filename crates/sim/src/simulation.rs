//! W worlds of one model.

use crate::compile::Compiled;
use crate::controls::Changes;
use crate::device::{Host, Remote};
use crate::engine::{Block, Task};
use crate::error::{MOST_MOTION, SimulationError, bounded, index, length};
use crate::events::Watcher;
use crate::impulse::Piles;
use crate::jobs::Lane;
use crate::queries::scene::Scenes;
use crate::rangefinder::look_alike;
use crate::ranges::Ranges;
use crate::scratch::Scratch;
use crate::threads::Threads;
use crate::{
    Controls, Device, Inputs, OutputPart, Outputs, Quantity, SimulationSettings, Snapshot, Stage,
};
use model::{Model, unit_quaternion};
use numbers::dispatch::Isa;
use numbers::{Float, Memory};
use rayon::prelude::*;
use rigid::{InputTables, Kernels, OutputTables, Report, Solver};
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

/// A world that left the finite numbers, or its speed limit. It stays at its last good state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diverged {
    /// Which world.
    pub world: usize,
    /// End [s] of the call of `step` in which it happened.
    pub time: f64,
}

/// What a world carries along, and what was set: see [`Simulation::numbers_of_world`].
#[derive(Clone, Debug, PartialEq)]
pub struct WorldNumbers {
    /// In the layout of the solver.
    pub state: Vec<f64>,
    /// In the layout of [`InputTables`].
    pub input: Vec<f64>,
}

/// A world, and coordinates and velocities of its joints.
type JointsNow = (usize, Vec<f64>, Vec<f64>);

/// W worlds of one model, advanced together.
///
/// `T` is the precision of all numbers: `f32` (16 worlds a block) or `f64` (8); where the
/// instruction set is `portable`, a block is one world.
/// Calls that fail leave the simulation as it was.
pub struct Simulation<T: Float> {
    model: Arc<Model>,
    settings: SimulationSettings,
    pub(crate) shared: Compiled<T>,
    pub(crate) isa: Isa,
    pub(crate) threads: Threads,
    pub(crate) state: Memory<T>,
    pub(crate) input: Memory<T>,
    pub(crate) output: Memory<T>,
    /// Controls that were set since a device was told.
    pub(crate) changes: Changes,
    /// The constants of the model: one block for all worlds, or one for each.
    parameters: Memory<T>,
    /// The same, a number each, while all worlds have them in common.
    common: Vec<T>,
    scratch: Scratch<T>,
    /// Of the worlds that have numbers of their own.
    own: HashMap<usize, Own<T>>,
    pub(crate) input_tables: InputTables,
    pub(crate) output_tables: OutputTables,
    pub(crate) time: Vec<f64>,
    /// How often each world was set, reset or restored.
    begun: Vec<u64>,
    /// How much of the output is of the present state.
    pub(crate) reported: Option<Report>,
    pub(crate) diverged: Vec<Diverged>,
    pub(crate) watcher: Option<Watcher<T>>,
    /// Changes whenever bodies may have moved.
    pub(crate) moment: u64,
    /// Where shapes were when they were last asked about.
    pub(crate) scenes: Scenes,
    /// The worlds, where they are in the memory of a device.
    pub(crate) remote: Option<Remote<T>>,
}

/// A model that one world has for itself.
pub(crate) struct Own<T> {
    model: Arc<Model>,
    compiled: Compiled<T>,
    /// Whether rays meet what they meet in the simulation's.
    shapes_alike: bool,
}

impl<T: Float> std::fmt::Debug for Simulation<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Simulation")
            .field("model", &self.model.name)
            .field("solver", &self.solver())
            .field("settings", &self.settings)
            .finish_non_exhaustive()
    }
}

/// The same numbers in every lane of so many worlds.
fn in_lanes<T: Float>(x: &[f64], worlds: usize, width: usize) -> Memory<T> {
    let mut memory = Memory::new(worlds, x.len().max(1), width);
    for (i, &x) in x.iter().enumerate() {
        memory.fill(i, T::from_f64(x));
    }
    memory
}

/// A world's numbers at these offsets.
fn numbers_of<T: Float>(memory: &Memory<T>, world: usize, offsets: Range<usize>) -> Vec<f64> {
    offsets.map(|i| memory.get(world, i).to_f64()).collect()
}

/// More than this is a slip of the keyboard.
const MOST_BYTES: u64 = 1 << 40;

/// Refuses worlds that no memory holds, before any of it is taken.
fn affordable<T>(worlds: usize, numbers: usize) -> Result<(), SimulationError> {
    let bytes = worlds
        .saturating_mul(numbers)
        .saturating_mul(size_of::<T>());
    if bytes as u64 > MOST_BYTES || Vec::<u8>::new().try_reserve_exact(bytes).is_err() {
        let gibibytes = bytes as f64 / f64::from(1 << 30);
        return Err(SimulationError::Memory { worlds, gibibytes });
    }
    Ok(())
}

/// Joint coordinates with the quaternions among them scaled to unit length.
fn with_unit_quaternions(model: &Model, position: &[f64]) -> Result<Vec<f64>, SimulationError> {
    let mut position = position.to_vec();
    for (joint, range) in model.quaternions() {
        if !unit_quaternion(&mut position[range]) {
            return Err(SimulationError::NoRotation {
                joint: model.joints[joint.0].name.clone(),
            });
        }
    }
    Ok(position)
}

impl<T: Float> Simulation<T> {
    /// Makes W worlds, each at the model's initial state.
    ///
    /// # Errors
    /// Settings out of range, a model that the solver cannot take, an instruction
    /// set that is not there.
    pub fn new(
        model: impl Into<Arc<Model>>,
        settings: SimulationSettings,
    ) -> Result<Self, SimulationError> {
        Self::made(None, model.into(), settings)
    }
    /// Makes W worlds in the memory of a device, which keeps them from step to step: controls go there when they
    /// were set, and what is read comes back.
    ///
    /// Results are those of the processor to rounding, not to the bit. Threads and instruction set are of the
    /// work that remains on the processor. Once the device has failed, what it held is lost: [`restore`](Self::restore)
    /// a [`snapshot`](Self::snapshot) into a new simulation.
    ///
    /// # Errors
    /// As [`new`](Self::new); a solver that the device does not run; what the device refuses.
    pub fn on(
        device: &dyn Device<T>,
        model: impl Into<Arc<Model>>,
        settings: SimulationSettings,
    ) -> Result<Self, SimulationError> {
        let model = model.into();
        let picked = settings.solver;
        let solver = picked.pick_on(device, &model, settings.contacts);
        Self::made(
            Some(device),
            model,
            SimulationSettings { solver, ..settings },
        )
    }
    fn made(
        device: Option<&dyn Device<T>>,
        model: Arc<Model>,
        settings: SimulationSettings,
    ) -> Result<Self, SimulationError> {
        settings.check(&model)?;
        let isa = match settings.isa {
            Some(isa) => isa,
            None => Isa::from_env()?,
        };
        let shared = Compiled::<T>::new(&model, &settings)?;
        let threads = Threads::new(settings.threads)?;
        let alone = settings.worlds == 1 || shared.engine.shares_a_world();
        let single = settings.scalar || alone;
        let width = if single { 1 } else { isa.width::<T>() };
        let lengths = shared.engine.lengths();
        affordable::<T>(
            settings.worlds,
            lengths.state + lengths.input + lengths.output,
        )?;
        let memory = |n: usize| Memory::new(settings.worlds, n.max(1), width);
        let mut simulation = Self {
            isa,
            threads,
            state: memory(lengths.state),
            input: memory(lengths.input),
            output: memory(lengths.output),
            changes: Changes::default(),
            parameters: in_lanes(shared.engine.parameters(), width, width),
            common: shared
                .engine
                .parameters()
                .iter()
                .map(|x| T::from_f64(*x))
                .collect(),
            scratch: Scratch::new(lengths.scratch, width),
            own: HashMap::new(),
            begun: vec![0; settings.worlds],
            input_tables: InputTables::new(&model),
            output_tables: shared.engine.outputs(),
            time: vec![0.0; settings.worlds],
            reported: None,
            diverged: Vec::new(),
            watcher: None,
            moment: 0,
            scenes: Scenes::default(),
            remote: None,
            shared,
            settings,
            model,
        };
        simulation.fill_spare_lanes();
        simulation.reset_all();
        if let Some(device) = device {
            simulation.remote = Some(simulation.placed_on(device)?);
            simulation.changes.include(0..lengths.input);
        }
        Ok(simulation)
    }
    fn placed_on(&self, device: &dyn Device<T>) -> Result<Remote<T>, SimulationError> {
        let (engine, worlds) = (&self.shared.engine, self.worlds());
        let placed = if let Some(solver) = Solver::of(engine.as_any()) {
            Some(device.place(solver, worlds)?)
        } else if let Some(piles) = engine.as_any().downcast_ref::<Piles<T>>() {
            device.place_piles(piles.kernels(), &self.model, piles.filter(), worlds)?
        } else {
            None
        };
        let placed = placed.ok_or_else(|| SimulationError::NotOnDevice {
            solver: engine.name(),
            device: device.name(),
        })?;
        let sizes = (worlds, engine.lengths().input);
        Ok(Remote::new(device.name(), placed, sizes))
    }

    /// The model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }
    /// Whether this is its model, too. Both are compared once, where they are not the same in memory: what is recognised is
    /// the simulation's own from then on.
    pub fn recognises(&self, model: &mut Arc<Model>) -> bool {
        let same = Arc::ptr_eq(model, &self.model);
        let alike = same || **model == *self.model;
        if alike && !same {
            *model = Arc::clone(&self.model);
        }
        alike
    }
    /// The settings it was made with.
    pub fn settings(&self) -> &SimulationSettings {
        &self.settings
    }
    /// Number of worlds.
    pub fn worlds(&self) -> usize {
        self.settings.worlds
    }
    /// Name of the solver that runs: what `auto` picked.
    pub fn solver(&self) -> &'static str {
        self.shared.engine.name()
    }
    /// Instruction set that runs.
    pub fn isa(&self) -> Isa {
        self.isa
    }
    /// Name of the device that runs, if it is not the processor.
    pub fn device(&self) -> Option<&str> {
        self.remote.as_ref().map(Remote::name)
    }
    /// How many substeps of all worlds together the device has left to the processor: of `impulse` those that are not usual,
    /// of other solvers none.
    pub fn left_to_processor(&self) -> u64 {
        self.remote.as_ref().map_or(0, Remote::left)
    }
    /// Runs something, and tells what the stages of steps of `impulse`, and what tells of its worlds, took by the clock of a
    /// graphics card, in their order; none on the processor, of other solvers, and of cards without a clock. All is slower
    /// while it is timed.
    ///
    /// # Errors
    /// What is run fails.
    pub fn time_stages<R, E>(
        &mut self,
        run: impl FnOnce(&mut Self) -> Result<R, E>,
    ) -> Result<(R, Vec<Stage>), E> {
        if let Some(remote) = &mut self.remote {
            remote.start_clock();
        }
        let result = run(self);
        let times = self.remote.as_mut().map_or(Vec::new(), Remote::stop_clock);
        result.map(|result| (result, times))
    }
    /// Number of threads that run.
    pub fn threads(&self) -> usize {
        self.threads.count()
    }
    /// Time of a world [s]; a world that diverged keeps the time at which it was found.
    ///
    /// Panics where the world does not exist, as an array would.
    pub fn time(&self, world: usize) -> f64 {
        self.time[world]
    }
    /// How often a world was set, reset or restored since the simulation was made: where this number is
    /// the same, its time has only gone on meanwhile, by steps. [Moving joints](Simulation::move_joints) does not
    /// count.
    ///
    /// Panics where the world does not exist, as an array would.
    pub fn begun(&self, world: usize) -> u64 {
        self.begun[world]
    }
    /// Bytes of state and controls per world.
    pub fn bytes_per_world(&self) -> usize {
        (self.state.length() + self.input.length()) * size_of::<T>()
    }

    /// The model's initial coordinates and velocities in all worlds; time, targets and divergence cleared.
    ///
    /// Panics where controls are shared on a device that fails; [`reset`](Self::reset) tells.
    pub fn reset_all(&mut self) {
        let all: Vec<_> = (0..self.worlds()).collect();
        let reset = self.reset(&all);
        reset.unwrap_or_else(|error| panic!("{error}"));
    }
    /// As [`reset_all`](Simulation::reset_all), for the named worlds.
    ///
    /// # Errors
    /// A world that does not exist; controls are shared on a device, and it fails.
    pub fn reset(&mut self, worlds: &[usize]) -> Result<(), SimulationError> {
        worlds
            .iter()
            .try_for_each(|&w| index("world", w, self.worlds()))?;
        self.fetch_controls()?;
        for &world in worlds {
            let state = self.compiled(world).state.clone();
            self.begin(world, &state);
        }
        self.run_again(worlds.iter().copied());
        self.tell_shared()
    }

    /// These have not diverged any more.
    fn run_again(&mut self, worlds: impl Iterator<Item = usize>) {
        if !self.diverged.is_empty() {
            let again: HashSet<_> = worlds.collect();
            self.diverged.retain(|d| !again.contains(&d.world));
        }
    }
    pub(crate) fn compiled(&self, world: usize) -> &Compiled<T> {
        let own = self.own.get(&world);
        own.map_or(&self.shared, |own| &own.compiled)
    }
    /// The model of a world: that of the simulation, or what
    /// [`set_world_model`](Simulation::set_world_model) gave it.
    ///
    /// Panics where the world does not exist, as an array would.
    pub fn world_model(&self, world: usize) -> &Arc<Model> {
        assert!(world < self.worlds(), "world {world} of {}", self.worlds());
        self.own.get(&world).map_or(&self.model, |own| &own.model)
    }
    /// Whether any world has a model of its own.
    pub(crate) fn has_own_models(&self) -> bool {
        !self.own.is_empty()
    }

    /// Sets a world's joint coordinates and velocities; its time starts at 0 again, with the
    /// model's controls.
    ///
    /// Quaternions are scaled to unit length.
    ///
    /// # Errors
    /// A world that does not exist, arrays of the wrong length, numbers not finite or beyond
    /// ±1e9, a quaternion that is zero; controls are shared on a device, and it fails.
    pub fn set_joint_state(
        &mut self,
        world: usize,
        position: &[f64],
        velocity: &[f64],
    ) -> Result<(), SimulationError> {
        self.set_joint_states([(world, position, velocity)])
    }
    /// As [`set_joint_state`](Self::set_joint_state), for several worlds at once: all of them, or none. Of several states
    /// for one world the last counts.
    ///
    /// # Errors
    /// As there.
    pub fn set_joint_states<'a>(
        &mut self,
        states: impl IntoIterator<Item = (usize, &'a [f64], &'a [f64])>,
    ) -> Result<(), SimulationError> {
        let states = self.states_at(states)?;
        self.fetch_controls()?;
        for (world, state) in &states {
            self.begin(*world, state);
        }
        self.run_again(states.iter().map(|(world, _)| *world));
        self.tell_shared()
    }

    /// As [`set_joint_state`](Simulation::set_joint_state), but the world keeps its time, its controls, and the targets that
    /// its drives follow with a lag; one that diverged runs again. Bodies that are moved neither by other coordinates nor by
    /// other velocities stay where they are, to the bit, and held by what they touch. Until the next step contacts are told
    /// as they were.
    ///
    /// # Errors
    /// As there; the device fails.
    pub fn move_joints(
        &mut self,
        world: usize,
        position: &[f64],
        velocity: &[f64],
    ) -> Result<(), SimulationError> {
        self.move_joints_of([(world, position, velocity)])
    }
    /// As [`move_joints`](Self::move_joints), for several worlds at once: all of them, or none. Of several states for one
    /// world the last counts.
    ///
    /// # Errors
    /// As there.
    pub fn move_joints_of<'a>(
        &mut self,
        states: impl IntoIterator<Item = (usize, &'a [f64], &'a [f64])>,
    ) -> Result<(), SimulationError> {
        let states = states.into_iter();
        let valid = states.map(|(w, position, velocity)| {
            let position = self.valid_state(w, position, velocity)?;
            Ok((w, position, velocity))
        });
        let states = valid.collect::<Result<Vec<_>, SimulationError>>()?;
        self.fetch_state()?;
        let motion = Vec::from_iter(self.shared.engine.motion().into_iter().flatten());
        let mut now = match motion.is_empty() {
            true => Vec::new(),
            false => self.joints_now(states.iter().map(|(world, ..)| *world))?,
        };
        for (_, position, _) in &mut now {
            *position = with_unit_quaternions(&self.model, position)?;
        }
        let moved = |(nth, (world, position, velocity)): (usize, (usize, Vec<f64>, &[f64]))| {
            let engine = &self.compiled(world).engine;
            let mut state = self.state_to_move(world);
            let before = now.get(nth).map(|(_, position, velocity)| {
                let mut before = state.clone();
                engine.place(position, velocity, &mut before);
                before
            });
            engine.place(&position, velocity, &mut state);
            if let Some(before) = before {
                for &i in &motion {
                    if before[i] == state[i] {
                        state[i] = self.state.get(world, i).to_f64();
                    }
                }
            }
            (world, state)
        };
        let states = Vec::from_iter(states.into_iter().enumerate().map(moved));
        self.go_on_from(&states);
        for (world, _) in states {
            self.take_for_granted(world);
        }
        Ok(())
    }

    /// What a world goes on from when its joints are moved: its state; of one that diverged no more than its drives' targets.
    fn state_to_move(&self, world: usize) -> Vec<f64> {
        let here = numbers_of(&self.state, world, 0..self.state.length());
        if self.runs(world) {
            return here;
        }
        let Compiled { engine, state, .. } = self.compiled(world);
        let mut state = state.clone();
        for i in engine.targets().into_iter().flatten() {
            state[i] = here[i];
        }
        state
    }

    /// Gives the joints of some worlds other velocities, as a push does: all of them, or none. All else stays: where
    /// bodies are, how they move otherwise than joints let them, what they rest on, time, controls, and the targets that
    /// drives follow with a lag. Worlds that diverged run again. Of several velocities for one world the last count.
    ///
    /// # Errors
    /// A world that does not exist, arrays of the wrong length, numbers not finite or beyond ±1e9; the device fails.
    pub fn set_joint_velocities<'a>(
        &mut self,
        velocities: impl IntoIterator<Item = (usize, &'a [f64])>,
    ) -> Result<(), SimulationError> {
        let velocities = Vec::from_iter(velocities);
        for (world, velocity) in &velocities {
            index("world", *world, self.worlds())?;
            let dofs = self.model.degrees_of_freedom();
            length("joint velocity", velocity.len(), dofs)?;
            bounded("joint velocity", velocity, MOST_MOTION)?;
        }
        self.fetch_state()?;
        let now = self.joints_now(velocities.iter().map(|(world, _)| *world))?;
        let pushed = |((world, velocity), (_, position, before)): ((usize, &[f64]), JointsNow)| {
            let mut state = numbers_of(&self.state, world, 0..self.state.length());
            let engine = &self.compiled(world).engine;
            engine.push(&position, [&before, velocity], &mut state);
            state[engine.alive()] = 1.0;
            (world, state)
        };
        let states = Vec::from_iter(velocities.into_iter().zip(now).map(pushed));
        self.go_on_from(&states);
        Ok(())
    }

    /// Writes states of worlds, which run from now on if they had diverged.
    fn go_on_from(&mut self, states: &[(usize, Vec<f64>)]) {
        for (world, state) in states {
            self.write_state(*world, state);
        }
        self.run_again(states.iter().map(|(world, _)| *world));
    }

    /// Coordinates and velocities of the joints of worlds, with these.
    fn joints_now(
        &mut self,
        worlds: impl IntoIterator<Item = usize>,
    ) -> Result<Vec<JointsNow>, SimulationError> {
        self.fetch(Quantity::JointPosition)?;
        self.fetch(Quantity::JointVelocity)?;
        let outputs = self.last_reported();
        let joints = |w| (w, outputs.joint_position(w), outputs.joint_velocity(w));
        Ok(worlds.into_iter().map(joints).collect())
    }

    /// States of worlds, with their worlds.
    fn states_at<'a>(
        &self,
        states: impl IntoIterator<Item = (usize, &'a [f64], &'a [f64])>,
    ) -> Result<Vec<(usize, Vec<f64>)>, SimulationError> {
        let states = states.into_iter();
        let states =
            states.map(|(w, position, velocity)| Ok((w, self.state_at(w, position, velocity)?)));
        states.collect()
    }

    fn state_at(
        &self,
        world: usize,
        position: &[f64],
        velocity: &[f64],
    ) -> Result<Vec<f64>, SimulationError> {
        let position = self.valid_state(world, position, velocity)?;
        Ok(self.compiled(world).state_at(&position, velocity))
    }

    /// Coordinates of joints, with unit quaternions, if a world's joints may have these and these velocities.
    fn valid_state(
        &self,
        world: usize,
        position: &[f64],
        velocity: &[f64],
    ) -> Result<Vec<f64>, SimulationError> {
        index("world", world, self.worlds())?;
        length("joint position", position.len(), self.model.coordinates())?;
        length(
            "joint velocity",
            velocity.len(),
            self.model.degrees_of_freedom(),
        )?;
        bounded("joint position", position, MOST_MOTION)?;
        bounded("joint velocity", velocity, MOST_MOTION)?;
        with_unit_quaternions(&self.model, position)
    }

    fn write_state(&mut self, world: usize, state: &[f64]) {
        for (i, &x) in state.iter().enumerate() {
            self.state.set(world, i, T::from_f64(x));
        }
        if let Some(remote) = &mut self.remote {
            remote.sets_state(world);
        }
        self.moves();
    }

    /// Bodies may be elsewhere from now on.
    fn moves(&mut self) {
        self.reported = None;
        self.moment += 1;
    }

    /// A state at time 0, with the model's controls.
    fn begin(&mut self, world: usize, state: &[f64]) {
        self.write_state(world, state);
        let own = self.own.get(&world);
        let compiled = own.map_or(&self.shared, |own| &own.compiled);
        let mut controls = Controls {
            memory: &mut self.input,
            tables: &self.input_tables,
            changes: &mut self.changes,
            // Whoever begins has made them known.
            shared: false,
        };
        for (i, &x) in compiled.input.iter().enumerate() {
            controls.put(world, i, T::from_f64(x));
        }
        self.time[world] = 0.0;
        self.begun[world] += 1;
        self.take_for_granted(world);
    }

    /// Lanes without a world run the model's initial state, so that they stay finite.
    fn fill_spare_lanes(&mut self) {
        for (i, &x) in self.shared.state.iter().enumerate() {
            self.state.fill(i, T::from_f64(x));
        }
    }

    /// Gives a world numbers of its own: masses, inertias, frictions, gains, gravity.
    ///
    /// The model must have the structure of the simulation's; only numbers may differ. What is
    /// zero in the one model must be zero in the other where it means that something is not
    /// there, and the solver keeps no room for it: a drive, dry friction, a spring or damper where
    /// no joint has any.
    ///
    /// The world's state, time and controls stay; a reset brings it to the initial state of its
    /// own model. From the first call on, every world has its own copy of the constants, which
    /// costs memory.
    ///
    /// # Errors
    /// A world that does not exist; a model of another structure.
    pub fn set_world_model(&mut self, world: usize, model: &Model) -> Result<(), SimulationError> {
        self.give_model(world, Arc::new(model.clone()))
    }

    pub(crate) fn give_model(
        &mut self,
        world: usize,
        model: Arc<Model>,
    ) -> Result<(), SimulationError> {
        index("world", world, self.worlds())?;
        let own = self.compiled_alike(world, model)?;
        self.give_own(vec![(world, own)])
    }

    /// A model for a world, compiled; it must have the structure of the simulation's.
    pub(crate) fn compiled_alike(
        &self,
        world: usize,
        model: Arc<Model>,
    ) -> Result<Own<T>, SimulationError> {
        let compiled = Compiled::<T>::new(&model, &self.settings)?;
        if compiled.fingerprint() != self.shared.fingerprint() {
            return Err(SimulationError::Structure { world });
        }
        let shapes_alike = look_alike(&self.model.shapes, &model.shapes);
        Ok(Own {
            model,
            compiled,
            shapes_alike,
        })
    }

    /// Whether rays meet the same shapes in all worlds.
    pub(crate) fn shapes_alike(&self) -> bool {
        self.own.values().all(|own| own.shapes_alike)
    }

    /// Gives worlds models of their own. Where all bodies are is reported once, for all of them.
    pub(crate) fn give_own(&mut self, models: Vec<(usize, Own<T>)>) -> Result<(), SimulationError> {
        self.fetch_controls()?;
        // Where joints tell all, bodies stay as these say.
        let places_bodies = !self.shared.engine.motion().is_empty();
        if places_bodies {
            self.fetch_motion()?;
            self.fetch_state()?;
        }
        // So that the device knows what it was given before.
        self.tell()?;
        if let Some(remote) = &self.remote {
            let own = models.iter();
            let own = own.map(|(_, own)| own.compiled.engine.parameters());
            remote.takes(&Vec::from_iter(own))?;
        }
        if self.own.is_empty() {
            let (worlds, width) = (self.worlds(), self.state.width());
            self.parameters = in_lanes(self.shared.engine.parameters(), worlds, width);
            self.common.clear();
        }
        let bodies = self.motion();
        for (world, own) in models {
            for (i, &x) in own.compiled.engine.parameters().iter().enumerate() {
                self.parameters.set(world, i, T::from_f64(x));
            }
            if places_bodies {
                let bodies = numbers_of(&self.output, world, bodies.clone());
                let mut state = numbers_of(&self.state, world, 0..own.compiled.state.len());
                own.compiled.engine.take_over(&bodies, &mut state);
                self.write_state(world, &state);
            }
            self.shared.engine.forget(world);
            self.own.insert(world, own);
            if let Some(remote) = &mut self.remote {
                remote.sets_parameters(world);
            }
        }
        self.moves();
        Ok(())
    }

    /// The controls of all worlds, to be set. What others have set of those that they share on a device is known after
    /// [`fetch_controls`](Self::fetch_controls).
    pub fn controls(&mut self) -> Controls<'_, T> {
        self.reported = None;
        Controls {
            memory: &mut self.input,
            tables: &self.input_tables,
            changes: &mut self.changes,
            shared: self.remote.as_ref().is_some_and(Remote::shares_input),
        }
    }

    /// The controls of all worlds, to be read, as [`controls`](Self::controls).
    pub fn inputs(&self) -> Inputs<'_, T> {
        Inputs {
            memory: &self.input,
            tables: &self.input_tables,
        }
    }

    /// Advances all worlds by `steps` time steps; returns the worlds that diverged meanwhile.
    ///
    /// Panics where worlds are on a device that fails; [`try_step`](Self::try_step) tells.
    pub fn step(&mut self, steps: usize) -> &[Diverged] {
        let stepped = self.try_step(steps);
        stepped.unwrap_or_else(|error| panic!("{error}"))
    }
    /// As [`step`](Self::step).
    ///
    /// # Errors
    /// Worlds are on a device, and it fails.
    pub fn try_step(&mut self, steps: usize) -> Result<&[Diverged], SimulationError> {
        let substeps = steps.saturating_mul(self.settings.step.substeps);
        match self.watcher.take() {
            Some(mut watcher) => {
                let stepped = self.step_watched(&mut watcher, substeps);
                self.watcher = Some(watcher);
                stepped?;
            }
            None => self.perform(Task::Step(substeps))?,
        }
        let known = self.diverged.len();
        let h = self.settings.step.time_step;
        let told: HashSet<_> = self.diverged.iter().map(|d| d.world).collect();
        let mut found = Vec::new();
        for world in 0..self.worlds() {
            if self.runs(world) {
                self.time[world] = later(self.time[world], steps, h);
            } else if !told.contains(&world) {
                self.time[world] = later(self.time[world], steps, h);
                found.push(Diverged {
                    world,
                    time: self.time[world],
                });
            }
        }
        self.diverged.extend(found);
        Ok(&self.diverged[known..])
    }

    /// The kernels that step a world, with the constants of its model in double precision, where its
    /// solver is of this type: [`rigid::Featherstone`], [`rigid::TouchingFeatherstone`] or
    /// [`rigid::Xpbd`]. With [`numbers_of_world`](Self::numbers_of_world), what it takes to run them on
    /// numbers of another sort.
    ///
    /// # Errors
    /// A world that does not exist.
    pub fn kernels<K: Kernels>(&self, world: usize) -> Result<Option<&K>, SimulationError> {
        index("world", world, self.worlds())?;
        Ok(self.compiled(world).engine.as_any().downcast_ref())
    }
    /// A world's state and controls, as its [`kernels`](Self::kernels) read them.
    ///
    /// # Errors
    /// A world that does not exist; a device that fails.
    pub fn numbers_of_world(&mut self, world: usize) -> Result<WorldNumbers, SimulationError> {
        index("world", world, self.worlds())?;
        self.fetch_state()?;
        self.fetch_controls()?;
        Ok(WorldNumbers {
            state: numbers_of(&self.state, world, 0..self.state.length()),
            input: numbers_of(&self.input, world, 0..self.input.length()),
        })
    }

    /// Whether a world has not diverged.
    pub(crate) fn runs(&self, world: usize) -> bool {
        self.state.get(world, self.alive()) != T::zero()
    }
    /// Where a state tells that.
    pub(crate) fn alive(&self) -> usize {
        self.shared.engine.alive()
    }

    /// All worlds that have diverged and were not reset since.
    pub fn diverged(&self) -> &[Diverged] {
        &self.diverged
    }

    /// Placements, velocities, reactions, energies of all worlds at the present state.
    ///
    /// Panics where worlds are on a device that fails; [`try_outputs`](Self::try_outputs) tells.
    pub fn outputs(&mut self) -> Outputs<'_, T> {
        let reported = self.report_everything();
        reported.unwrap_or_else(|error| panic!("{error}"));
        self.last_reported()
    }
    /// As [`outputs`](Self::outputs).
    ///
    /// # Errors
    /// Worlds are on a device, and it fails.
    pub fn try_outputs(&mut self) -> Result<Outputs<'_, T>, SimulationError> {
        self.report_everything()?;
        Ok(self.last_reported())
    }
    fn report_everything(&mut self) -> Result<(), SimulationError> {
        self.fetch_controls()?;
        let all = 0..self.output.length();
        self.fetch_numbers(Report::Everything, [all])
    }

    /// Copies a quantity of all worlds at the present state, `out[world][row][number]`, in the threads of the
    /// simulation; see [`Quantity::shape`]. What tells where bodies and joints are, how they move, and what touches them takes a
    /// fraction of the time that all [`outputs`](Simulation::outputs) take.
    ///
    /// # Errors
    /// An array of the wrong length; a device that fails.
    pub fn read(&mut self, quantity: Quantity, out: &mut [T]) -> Result<(), SimulationError> {
        self.fetch(quantity)?;
        self.copy(quantity, out)
    }
    /// As [`read`](Simulation::read), into columns of a table of any precision that has a row for each world, from
    /// one column on: what is observed of many quantities together needs no copies of each.
    ///
    /// # Errors
    /// A table that does not have as many rows as there are worlds, or not the columns; a device that fails.
    pub fn read_columns<U: Float>(
        &mut self,
        quantity: Quantity,
        table: &mut [U],
        column: usize,
    ) -> Result<(), SimulationError> {
        self.fetch(quantity)?;
        self.copy_columns(quantity, table, column)
    }
    /// Makes what a quantity of the present state is made of known.
    pub(crate) fn fetch(&mut self, quantity: Quantity) -> Result<(), SimulationError> {
        let rows = quantity.made_of(&self.output_tables, &self.model);
        self.fetch_numbers(quantity.needs(), rows)
    }
    /// Makes known where all bodies are, and how they move.
    pub(crate) fn fetch_motion(&mut self) -> Result<(), SimulationError> {
        self.fetch_numbers(Report::Motion, [self.motion()])
    }
    /// Where the output has that.
    fn motion(&self) -> Range<usize> {
        let bodies = self.output_tables.body;
        bodies.start()..bodies.at(self.model.bodies.len(), 0)
    }
    /// Makes these numbers of the output known, for which so much of it has to be of the present state.
    pub(crate) fn fetch_numbers(
        &mut self,
        needs: Report,
        numbers: impl IntoIterator<Item = Range<usize>>,
    ) -> Result<(), SimulationError> {
        self.report(needs)?;
        match &mut self.remote {
            Some(remote) => Ok(remote.read_output(Ranges::of(numbers), &mut self.output)?),
            None => Ok(()),
        }
    }

    /// Brings at least what is needed of the output to the present state, where the worlds are.
    pub(crate) fn report(&mut self, needed: Report) -> Result<(), SimulationError> {
        if self.reported < Some(needed) {
            self.perform(Task::Report(needed))?;
            self.reported = Some(needed);
        }
        Ok(())
    }

    /// The outputs as they were last reported.
    pub(crate) fn last_reported(&self) -> Outputs<'_, T> {
        Outputs {
            memory: &self.output,
            tables: &self.output_tables,
            shapes: self.shared.engine.contact_shapes(),
        }
    }

    /// Looks at the [`outputs`](Simulation::outputs) and at all else that can be read, in the threads of the
    /// simulation: what rayon shares out among threads meanwhile is theirs.
    ///
    /// # Errors
    /// Worlds are on a device, and it fails.
    pub fn observe<R: Send>(
        &mut self,
        look: impl FnOnce(&Self, &Outputs<'_, T>) -> R + Send,
    ) -> Result<R, SimulationError> {
        self.report_everything()?;
        Ok(self.observe_known(look))
    }

    /// As [`observe`](Simulation::observe), of outputs of which only these parts are of the present state.
    ///
    /// # Errors
    /// As [`fetch_parts`](Simulation::fetch_parts).
    pub fn observe_parts<R: Send>(
        &mut self,
        parts: impl IntoIterator<Item = OutputPart>,
        look: impl FnOnce(&Self, &Outputs<'_, T>) -> R + Send,
    ) -> Result<R, SimulationError> {
        self.fetch_parts(parts)?;
        Ok(self.observe_known(look))
    }
    /// Brings parts of the outputs, and all that sets and drives worlds, to the present state. On the processor no more is
    /// worked out than they take, and of a device no more is read.
    ///
    /// Panics where a part does not exist, as an array would.
    ///
    /// # Errors
    /// Worlds are on a device, and it fails.
    pub fn fetch_parts(
        &mut self,
        parts: impl IntoIterator<Item = OutputPart>,
    ) -> Result<(), SimulationError> {
        let mut needs = None;
        let mut numbers = Vec::new();
        for part in parts {
            needs = needs.max(Some(part.needs()));
            let own = part.numbers(&self.output_tables, &self.model);
            if self.remote.is_some() {
                numbers.extend(own);
            }
        }
        self.fetch_controls()?;
        match needs {
            Some(needs) => self.fetch_numbers(needs, numbers),
            None => Ok(()),
        }
    }
    /// As [`observe`](Simulation::observe), of outputs as they are known: those parts are of the present state that were
    /// [fetched](Simulation::fetch_parts) since it was reached.
    pub fn observe_known<R: Send>(
        &self,
        look: impl FnOnce(&Self, &Outputs<'_, T>) -> R + Send,
    ) -> R {
        self.threads.run(|| look(self, &self.last_reported()))
    }

    /// The whole state of all worlds, to the bit.
    ///
    /// Panics where worlds are on a device that fails; [`try_snapshot`](Self::try_snapshot) tells.
    pub fn snapshot(&mut self) -> Snapshot {
        let taken = self.try_snapshot();
        taken.unwrap_or_else(|error| panic!("{error}"))
    }
    /// As [`snapshot`](Self::snapshot).
    ///
    /// # Errors
    /// Worlds are on a device, and it fails.
    pub fn try_snapshot(&mut self) -> Result<Snapshot, SimulationError> {
        self.fetch_state()?;
        self.fetch_controls()?;
        Ok(Snapshot::take(self))
    }
    /// Returns to a snapshot of the same model, solver and number of worlds.
    ///
    /// # Errors
    /// The snapshot does not fit; controls are shared on a device, and it fails.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), SimulationError> {
        snapshot.put_back(self)?;
        self.moves();
        self.changes.include(0..self.input.length());
        for world in 0..self.worlds() {
            if let Some(remote) = &mut self.remote {
                remote.sets_state(world);
            }
            self.begun[world] += 1;
            self.take_for_granted(world);
        }
        self.tell_shared()
    }
    /// What a snapshot must agree on: solver and tables.
    pub(crate) fn fingerprint(&self) -> u64 {
        self.shared.fingerprint()
    }

    /// Performs a task where the worlds are.
    pub(crate) fn perform(&mut self, task: Task) -> Result<(), SimulationError> {
        let steps = matches!(task, Task::Step(_));
        if steps {
            self.moves();
        }
        self.tell()?;
        let (engine, threads, lane) = (&*self.shared.engine, &self.threads, self.lane());
        let shared = self.own.is_empty();
        let Some(remote) = &mut self.remote else {
            self.perform_here(task);
            return Ok(());
        };
        remote.perform(task, &mut |world, substeps, state| {
            let block = Block {
                number: world,
                state,
                input: self.input.block(world),
                output: &mut [],
                scratch: &mut [],
                parameters: self.parameters.block(if shared { 0 } else { world }),
                common: &self.common,
                links: engine.links(),
            };
            let team = threads.count();
            threads.run(|| engine.run(lane, team, block, Task::Step(substeps)));
        })?;
        if steps {
            let alive = engine.alive();
            remote.read_state(alive..alive + 1, &mut self.state)?;
        }
        Ok(())
    }
    /// Tells the device, if worlds are on one, all that was set.
    pub(crate) fn tell(&mut self) -> Result<(), SimulationError> {
        let Some(remote) = &mut self.remote else {
            return Ok(());
        };
        Ok(remote.tell(Host {
            state: &self.state,
            input: &self.input,
            changes: &mut self.changes,
            parameters: &self.parameters,
        })?)
    }
    /// Makes known what other libraries have set of the [controls that they share](Self::control_on_device).
    ///
    /// # Errors
    /// The device fails.
    pub fn fetch_controls(&mut self) -> Result<(), SimulationError> {
        self.tell_shared()?;
        match self.remote.as_mut().filter(|remote| remote.shares_input()) {
            Some(remote) => Ok(remote.read_input(&mut self.input)?),
            None => Ok(()),
        }
    }
    /// Others may have set controls that they share: what depends on these, accelerations and what comes of them, is
    /// reported anew when it is read next.
    pub fn controls_may_differ(&mut self) {
        if self.remote.as_ref().is_some_and(Remote::shares_input) {
            self.reported = None;
        }
    }
    /// Tells the device what was set while others do not set controls: later, theirs would be lost.
    fn tell_shared(&mut self) -> Result<(), SimulationError> {
        match &self.remote {
            Some(remote) if remote.shares_input() => self.tell(),
            _ => Ok(()),
        }
    }
    /// Makes the state of all worlds known.
    fn fetch_state(&mut self) -> Result<(), SimulationError> {
        self.tell()?;
        let Some(remote) = &mut self.remote else {
            return Ok(());
        };
        Ok(remote.read_state(0..self.state.length(), &mut self.state)?)
    }

    fn lane(&self) -> Lane {
        let shares = self.shared.engine.shares_a_world();
        Lane {
            isa: self.isa,
            single: self.settings.scalar || (self.state.width() == 1 && !shares),
        }
    }

    /// Runs a task on all blocks, a run of blocks per thread, each with its own scratch.
    fn perform_here(&mut self, task: Task) {
        let lane = self.lane();
        let engine = &*self.shared.engine;
        let threads = self.threads.count();
        let shared_world = engine.shares_a_world() && self.state.blocks() == 1;
        let team = if shared_world { threads } else { 1 };
        let (input, parameters, common) = (&self.input, &self.parameters, &self.common[..]);
        let shared = self.own.is_empty();
        let run_blocks = |first: usize, state: Blocks<'_, T>, output: Blocks<'_, T>| {
            self.scratch.lend(|scratch| {
                for (i, (state, output)) in state.zip(output).enumerate() {
                    let b = first + i;
                    let parameters = parameters.block(if shared { 0 } else { b });
                    let (input, scratch) = (input.block(b), scratch.scalars_mut());
                    let block = Block {
                        number: b,
                        state,
                        input,
                        output,
                        scratch,
                        parameters,
                        common,
                        links: engine.links(),
                    };
                    engine.run(lane, team, block, task);
                }
            });
        };
        let (s, o, blocks) = (
            self.state.block_size(),
            self.output.block_size(),
            self.state.blocks(),
        );
        let (state, output) = (self.state.scalars_mut(), self.output.scalars_mut());
        if shared_world {
            let all = (state.chunks_exact_mut(s), output.chunks_exact_mut(o));
            return self.threads.run(|| run_blocks(0, all.0, all.1));
        }
        if blocks == 1 {
            return run_blocks(0, state.chunks_exact_mut(s), output.chunks_exact_mut(o));
        }
        let run = blocks.div_ceil(threads * RUNS_PER_THREAD);
        let parts = state
            .par_chunks_mut(s * run)
            .zip(output.par_chunks_mut(o * run))
            .enumerate();
        self.threads.run(|| {
            parts.for_each(|(part, (state, output))| {
                run_blocks(
                    part * run,
                    state.chunks_exact_mut(s),
                    output.chunks_exact_mut(o),
                );
            });
        });
    }
}

/// Runs of blocks per thread: enough to share the load evenly, few enough to keep scratch warm.
pub(crate) const RUNS_PER_THREAD: usize = 4;

/// Consecutive blocks of one memory.
type Blocks<'a, T> = std::slice::ChunksExactMut<'a, T>;

/// The time [s] of so many steps of h later. Steps are counted, since what adding up times rounds would depend on how many
/// are taken at once; a time that is no number of them is gone on from.
pub(crate) fn later(time: f64, steps: usize, h: f64) -> f64 {
    let passed = time / h;
    let whole = passed.round();
    if (passed - whole).abs() < 1e-6 {
        (whole + steps as f64) * h
    } else {
        time + steps as f64 * h
    }
}
