//! From a model to the engine that steps it.
//!
//! The engines of both precisions are made by functions that are not generic, so that their
//! kernels, which take minutes to compile, are compiled with this crate and never again.

use crate::engine::Engine;
use crate::{SimulationSettings, SolverKind};
use model::Model;
use numbers::Float;
use rigid::{Featherstone, SolverError, Xpbd};
use std::any::Any;

type Compiled<T> = Result<Box<dyn Engine<T>>, SolverError>;

/// Compiles a model for a solver.
pub(crate) fn compile<T: Float>(model: &Model, settings: &SimulationSettings) -> Compiled<T> {
    let engine: Box<dyn Any> = if T::DOUBLE {
        Box::new(double(model, settings)?)
    } else {
        Box::new(single(model, settings)?)
    };
    let engine = engine.downcast::<Box<dyn Engine<T>>>();
    Ok(*engine.expect("numbers are f32 or f64, and DOUBLE tells which"))
}

#[inline(never)]
fn single(model: &Model, settings: &SimulationSettings) -> Compiled<f32> {
    engine(model, settings)
}

#[inline(never)]
fn double(model: &Model, settings: &SimulationSettings) -> Compiled<f64> {
    engine(model, settings)
}

fn engine<T: Float>(model: &Model, settings: &SimulationSettings) -> Compiled<T> {
    let kind = match settings.solver {
        SolverKind::Auto if model.is_tree() => SolverKind::Featherstone,
        SolverKind::Auto => SolverKind::Xpbd,
        named => named,
    };
    Ok(match kind {
        SolverKind::Featherstone => Box::new(Featherstone::new(model, &settings.step)?),
        SolverKind::Xpbd | SolverKind::Auto => Box::new(Xpbd::new(model, &settings.step)?),
    })
}
