//! Worlds of bodies that touch, free or jointed: the host's side of [`rigid::impulse`].
//!
//! A world of any number of bodies is stepped in the order of `World::step`. Lanes take contacts, or joints, of
//! one colour (`colours`), threads share the batches of each colour and go on when all are done
//! (`team`). Neither changes any number: what is solved side by side shares nothing.

mod ahead;
mod batches;
mod broad_phase;
mod colours;
mod islands;
mod jobs;
mod joints;
mod mid_phase;
mod narrow_phase;
mod odometers;
mod pace;
mod shares;
mod sleep;
mod solve;
mod sums;
mod team;
mod warm_start;
mod world;

use crate::SimulationSettings;
use crate::engine::{Block, Engine, Task};
use crate::jobs::Lane;
use crate::meshes::{Meshes, Triangles};
use broad_phase::BroadPhase;
pub use joints::joint_runs;
use mid_phase::MidPhase;
use model::{CollisionFilter, Model, ShapeId};
use narrow_phase::NarrowPhase;
use numbers::Float;
use pace::Pace;
use rigid::impulse::{Collider, Impulse, State};
use rigid::{Lengths, OutputTables, SolverError};
use std::any::Any;
use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Instant;
use team::attended;
use world::{Workspace, World};

/// What a world keeps from step to step. It changes nothing that is found.
#[derive(Debug, Default)]
struct Kept {
    broad_phase: BroadPhase,
    mid_phase: MidPhase,
    pace: Pace,
}

/// A model at a precision.
pub(crate) struct Piles<T: Float> {
    impulse: Impulse,
    /// Which shapes may touch; none where bodies pass through each other.
    filter: Option<CollisionFilter>,
    narrow_phase: NarrowPhase,
    /// Colliding shapes and the rows of their bodies, in whole registers: filled up with the last one.
    shapes: Vec<u32>,
    carriers: Vec<u32>,
    /// Whether any of them is a sensor.
    senses: bool,
    /// Of colliding shapes that are meshes.
    meshes: Vec<Option<Arc<Triangles>>>,
    /// Of worlds that are not stepped just now.
    workspaces: Mutex<Vec<Workspace<T>>>,
    /// What each world keeps of the shapes that are near each other, from the first step on.
    kept: OnceLock<Vec<Mutex<Kept>>>,
    worlds: usize,
}

impl<T: Float> Piles<T> {
    pub fn new(model: &Model, settings: &SimulationSettings) -> Result<Self, SolverError> {
        let impulse = Impulse::new(model, &settings.step)?;
        let colliders = impulse.shapes();
        let whole = 0..colliders.len().next_multiple_of(T::BLOCK);
        let shapes: Vec<_> = whole.map(|i| i.min(colliders.len() - 1)).collect();
        let mut meshes = Meshes::default();
        let mesh_of = |collider: &Collider| meshes.of(&model.shapes[collider.shape.0]);
        Ok(Self {
            meshes: colliders.iter().map(mesh_of).collect(),
            carriers: shapes.iter().map(|i| colliders[*i].row).collect(),
            shapes: shapes.iter().map(|i| *i as u32).collect(),
            senses: colliders.iter().any(|shape| shape.sensor),
            filter: settings.contacts.then(|| CollisionFilter::new(model)),
            narrow_phase: NarrowPhase::new(&impulse),
            workspaces: Mutex::default(),
            kept: OnceLock::new(),
            worlds: settings.worlds,
            impulse,
        })
    }

    /// The solver, and which shapes may touch; none where bodies pass through each other.
    pub fn kernels(&self) -> &Impulse {
        &self.impulse
    }
    pub fn filter(&self) -> Option<&CollisionFilter> {
        self.filter.as_ref()
    }

    fn step(&self, lane: Lane, team: usize, block: &mut Block<'_, T>, steps: usize) {
        let taken = self.workspaces.lock().map(|mut all| all.pop());
        let mut workspace = taken.ok().flatten().unwrap_or_default();
        let mut kept = self.kept_of(block.number);
        std::mem::swap(&mut workspace.kept, &mut kept);
        let world = World {
            piles: self,
            lane,
            team,
            input: block.input,
            parameters: block.parameters,
            parts: 1,
            first: true,
        };
        let mut advance = || {
            for _ in 0..steps {
                if block.state[self.impulse.alive()] == T::zero() {
                    break;
                }
                // A browser, which has no other threads, has no such clock either.
                if team == 1 {
                    world.step(block.state, &mut workspace);
                    continue;
                }
                let team = workspace.kept.pace.team(team);
                let begin = Instant::now();
                World { team, ..world }.step(block.state, &mut workspace);
                let seconds = begin.elapsed().as_secs_f64();
                workspace.kept.pace.took(seconds, world.team);
            }
        };
        if team > 1 {
            attended(team, advance);
        } else {
            advance();
        }
        std::mem::swap(&mut workspace.kept, &mut kept);
        let mut all = self
            .workspaces
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        all.push(workspace);
    }

    fn kept_of(&self, world: usize) -> MutexGuard<'_, Kept> {
        let all = || (0..self.worlds).map(|_| Mutex::default()).collect();
        let kept = self.kept.get_or_init(all)[world].lock();
        kept.unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T: Float> Engine<T> for Piles<T> {
    fn name(&self) -> &'static str {
        self.impulse.name()
    }
    fn as_any(&self) -> &dyn Any {
        self
    }
    fn lengths(&self) -> Lengths {
        self.impulse.lengths()
    }
    fn outputs(&self) -> OutputTables {
        self.impulse.outputs()
    }
    fn contact_shapes(&self) -> &[[ShapeId; 2]] {
        &[]
    }
    fn parameters(&self) -> &[f64] {
        self.impulse.parameters()
    }
    fn links(&self) -> &[u32] {
        self.impulse.links()
    }
    fn alive(&self) -> usize {
        self.impulse.alive()
    }
    fn shares_a_world(&self) -> bool {
        true
    }
    fn initial(&self, _: &Model, position: &[f64], velocity: &[f64]) -> Vec<f64> {
        self.impulse.initial(position, velocity)
    }
    fn place(&self, position: &[f64], velocity: &[f64], state: &mut [f64]) {
        self.impulse.place(position, velocity, state);
    }
    fn push(&self, position: &[f64], velocities: [&[f64]; 2], state: &mut [f64]) {
        self.impulse.push(position, velocities, state);
    }
    fn motion(&self) -> Vec<Range<usize>> {
        self.impulse.motion()
    }
    fn targets(&self) -> Vec<Range<usize>> {
        self.impulse.targets()
    }
    fn take_over(&self, bodies: &[f64], state: &mut [f64]) {
        self.impulse.take_over(bodies, state);
    }
    fn acting(&self, model: &Model) -> Vec<f64> {
        self.impulse.acting(model)
    }
    fn forget(&self, world: usize) {
        let mut kept = self.kept_of(world);
        *kept = Kept {
            pace: std::mem::take(&mut kept.pace),
            ..Kept::default()
        };
    }
    fn run(&self, lane: Lane, team: usize, mut block: Block<'_, T>, task: Task) {
        match task {
            Task::Step(steps) => self.step(lane, team, &mut block, steps),
            Task::Report(asked) => {
                let state = State {
                    impulse: &self.impulse,
                    state: block.state,
                    parameters: block.parameters,
                };
                self.impulse.report(&state, asked, block.output);
            }
        }
    }
}
