//! From a model to the engine that steps it.
//!
//! The engines of both precisions are made by functions that are not generic, so that their
//! kernels, which take minutes to compile, are compiled with this crate and never again.

use crate::engine::Engine;
use crate::impulse::Piles;
use crate::{SimulationSettings, SolverKind};
use model::{CollisionFilter, Model};
use numbers::Float;
use rigid::{Featherstone, InputTables, SolverError, TouchingFeatherstone, Xpbd};
use std::any::Any;

/// A solver compiled for a model, and how its worlds begin.
pub(crate) struct Compiled<T> {
    pub engine: Box<dyn Engine<T>>,
    /// The state at the model's initial coordinates, at rest.
    pub state: Vec<f64>,
    /// The model's own targets, and no force or control.
    pub input: Vec<f64>,
    /// The share of the stiffness along each degree of freedom that acts.
    pub acting: Vec<f64>,
}

impl<T: Float> Compiled<T> {
    /// Compiles a model for a solver.
    pub fn new(model: &Model, settings: &SimulationSettings) -> Result<Self, SolverError> {
        let engine = compile::<T>(model, settings)?;
        let at_rest = vec![0.0; model.degrees_of_freedom()];
        let state = engine.initial(model, &model.initial_position(), &at_rest);
        let input = InputTables::new(model).initial(model);
        Ok(Self {
            acting: engine.acting(model),
            engine,
            state,
            input,
        })
    }
    /// The state as worlds begin, but at other coordinates and velocities.
    pub fn state_at(&self, position: &[f64], velocity: &[f64]) -> Vec<f64> {
        let mut state = self.state.clone();
        self.engine.place(position, velocity, &mut state);
        state
    }
    /// The same for two models exactly if the numbers of both lie in the same places.
    pub fn fingerprint(&self) -> u64 {
        let lengths = self.engine.lengths();
        let parameters = self.engine.parameters().len();
        let head = [
            lengths.state,
            lengths.input,
            lengths.output,
            lengths.scratch,
            parameters,
        ];
        let head = head.into_iter().map(|n| n as u32);
        let name = self.engine.name().bytes().map(u32::from);
        // FNV-1a (Fowler, Noll, Vo), word by word.
        head.chain(name)
            .chain(self.engine.links().iter().copied())
            .fold(0xcbf2_9ce4_8422_2325, |hash, word| {
                (hash ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3)
            })
    }
}

type Made<T> = Result<Box<dyn Engine<T>>, SolverError>;

fn compile<T: Float>(model: &Model, settings: &SimulationSettings) -> Made<T> {
    let engine: Box<dyn Any> = if T::DOUBLE {
        Box::new(double(model, settings)?)
    } else {
        Box::new(single(model, settings)?)
    };
    let engine = engine.downcast::<Box<dyn Engine<T>>>();
    Ok(*engine.expect("numbers are f32 or f64, and DOUBLE tells which"))
}

#[inline(never)]
fn single(model: &Model, settings: &SimulationSettings) -> Made<f32> {
    engine(model, settings)
}

#[inline(never)]
fn double(model: &Model, settings: &SimulationSettings) -> Made<f64> {
    engine(model, settings)
}

fn engine<T: Float>(model: &Model, settings: &SimulationSettings) -> Made<T> {
    let kind = settings.solver.pick(model, settings.contacts);
    if kind == SolverKind::Impulse {
        return Ok(Box::new(Piles::<T>::new(model, settings)?));
    }
    let touches = settings.contacts && CollisionFilter::new(model).pairs().next().is_some();
    Ok(match (kind, touches) {
        (SolverKind::Featherstone, true) => {
            Box::new(TouchingFeatherstone::new(model, &settings.step)?)
        }
        (SolverKind::Featherstone, false) if model.is_tree() => {
            Box::new(Featherstone::new(model, &settings.step)?)
        }
        (SolverKind::Featherstone, false) => Box::new(TouchingFeatherstone::without_contacts(
            model,
            &settings.step,
        )?),
        (_, true) => Box::new(Xpbd::touching(model, &settings.step)?),
        (_, false) => Box::new(Xpbd::new(model, &settings.step)?),
    })
}
