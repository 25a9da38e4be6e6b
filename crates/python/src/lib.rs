//! The module `kinetarium._engine`: the engine in Python.
//!
//! It translates and has no logic of its own: numbers, names and errors go through, arrays are copied to and
//! from the blocks in which worlds lie. What users see of a simulation is the class `kinetarium.Simulation`
//! (`python/kinetarium`), which keeps the arrays.

// `cargo test --lib` builds a test of all libraries, also of those that say they have none.
#![cfg(not(test))]
#![deny(unsafe_code)]

mod body_options;
mod builder;
mod camera;
mod count;
mod device_array;
mod dynamics;
mod error;
mod examples;
mod geometry;
mod joint;
mod joint_options;
mod keywords;
mod material;
mod model;
mod names;
mod object;
mod pickled;
mod queries;
mod range;
mod replica;
mod sensors;
mod shape;
mod shape_handle;
mod simulation;
mod skin;
mod vector;
mod viewer;

use pyo3::prelude::*;

#[pymodule]
mod _engine {
    use super::*;

    #[pymodule_export]
    use crate::builder::{Body, Builder, Joint};
    #[pymodule_export]
    use crate::camera::{View, framing, looking, png, render_view};
    #[pymodule_export]
    use crate::device_array::DeviceArray;
    #[pymodule_export]
    use crate::dynamics::Dynamics;
    #[pymodule_export]
    use crate::examples::{
        arch, ball_joint, balls, billiards, card_house, dominoes, linkage, n_pendula, pile,
        prismatic, pyramid, ragdolls, rings, room, rover,
    };
    #[pymodule_export]
    use crate::geometry::Geometry;
    #[pymodule_export]
    use crate::joint::{Axis, Dof, Drive, Limit};
    #[pymodule_export]
    use crate::material::{Material, Softness};
    #[pymodule_export]
    use crate::model::{Model, load, parse};
    #[pymodule_export]
    use crate::object::Object;
    #[pymodule_export]
    use crate::replica::Replica;
    #[pymodule_export]
    use crate::sensors::{Disturbance, Measurement, SensorArray};
    #[pymodule_export]
    use crate::shape::Shape;
    #[pymodule_export]
    use crate::shape_handle::ShapeHandle;
    #[pymodule_export]
    use crate::simulation::Engine;
    #[pymodule_export]
    use crate::skin::Skin;
    #[pymodule_export]
    use crate::viewer::{Viewer, run_program, show};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
