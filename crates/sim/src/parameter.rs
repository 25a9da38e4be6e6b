//! Numbers of the model that may differ from world to world, by name.

use crate::Simulation;
use crate::error::{SimulationError, index, length};
use model::{Dof, Joint, Model, Parts};
use numbers::Float;
use rayon::prelude::*;
use std::sync::Arc;

/// A number of every body, shape, degree of freedom or actuator that a world may have for itself: a row for
/// each, of [`width`](Parameter::width) numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// Gravity [m/s²]: one row of 3.
    Gravity,
    /// Masses of the bodies [kg].
    BodyMass,
    /// Centres of mass in the bodies' frames [m], 3 each.
    BodyCenter,
    /// Inertias about the centres of mass [kg·m²], along the bodies' axes, row by row, 9 each.
    BodyInertia,
    /// Reflected inertias of motors [kg or kg·m²], per degree of freedom.
    Armature,
    /// Viscous damping [N·s/m or N·m·s/rad], per degree of freedom.
    Damping,
    /// Stiffness of springs [N/m or N·m/rad], per degree of freedom.
    Stiffness,
    /// Coordinates at which springs are slack [m or rad], per degree of freedom.
    Rest,
    /// Dry friction [N or N·m], per degree of freedom.
    FrictionLoss,
    /// Stiffness of drives [N/m or N·m/rad], per degree of freedom.
    DriveStiffness,
    /// Damping of drives [N·s/m or N·m·s/rad], per degree of freedom.
    DriveDamping,
    /// Largest efforts of drives [N or N·m], per degree of freedom.
    EffortLimit,
    /// Coulomb friction coefficients of the shapes. Contact pairs that have a [friction of their own](model::Whose::Own)
    /// keep it.
    Friction,
    /// Restitutions of the shapes; of pairs as above.
    Restitution,
    /// Gears of the actuators.
    Gear,
    /// Gains of the actuators.
    Gain,
    /// Biases of the actuators, 3 each.
    Bias,
}

fn dofs(joints: &mut [Joint]) -> impl Iterator<Item = &mut Dof> {
    let in_state = joints.iter_mut().filter(|j| !j.closes_loop);
    in_state.flat_map(|j| &mut j.dofs)
}

impl Parameter {
    /// Numbers in a row.
    pub fn width(self) -> usize {
        match self {
            Self::Gravity | Self::BodyCenter | Self::Bias => 3,
            Self::BodyInertia => 9,
            _ => 1,
        }
    }
    fn name(self) -> &'static str {
        match self {
            Self::Gravity => "gravity",
            Self::BodyMass => "body mass",
            Self::BodyCenter => "body center",
            Self::BodyInertia => "body inertia",
            Self::Armature => "armature",
            Self::Damping => "damping",
            Self::Stiffness => "stiffness",
            Self::Rest => "rest",
            Self::FrictionLoss => "friction loss",
            Self::DriveStiffness => "drive stiffness",
            Self::DriveDamping => "drive damping",
            Self::EffortLimit => "effort limit",
            Self::Friction => "friction",
            Self::Restitution => "restitution",
            Self::Gear => "gear",
            Self::Gain => "gain",
            Self::Bias => "bias",
        }
    }

    /// Where the numbers lie, row after row.
    fn places(self, parts: &mut Parts) -> Vec<&mut f64> {
        let bodies = parts.bodies.iter_mut();
        let joints = &mut parts.joints;
        let shapes = parts.shapes.iter_mut();
        let actuators = parts.actuators.iter_mut();
        match self {
            Self::Gravity => parts.gravity.as_mut().iter_mut().collect(),
            Self::BodyMass => bodies.map(|b| &mut b.mass).collect(),
            Self::BodyCenter => bodies.flat_map(|b| b.center.as_mut()).collect(),
            // A symmetric matrix: its columns are its rows.
            Self::BodyInertia => bodies.flat_map(|b| b.inertia.as_mut()).collect(),
            Self::Armature => dofs(joints).map(|d| &mut d.armature).collect(),
            Self::Damping => dofs(joints).map(|d| &mut d.damping).collect(),
            Self::Stiffness => dofs(joints).map(|d| &mut d.stiffness).collect(),
            Self::Rest => dofs(joints).map(|d| &mut d.rest).collect(),
            Self::FrictionLoss => dofs(joints).map(|d| &mut d.friction_loss).collect(),
            Self::DriveStiffness => dofs(joints).map(|d| &mut d.drive.stiffness).collect(),
            Self::DriveDamping => dofs(joints).map(|d| &mut d.drive.damping).collect(),
            Self::EffortLimit => dofs(joints).map(|d| &mut d.drive.effort_limit).collect(),
            Self::Friction => shapes.map(|s| &mut s.material.friction).collect(),
            Self::Restitution => shapes.map(|s| &mut s.material.restitution).collect(),
            Self::Gear => actuators.map(|a| &mut a.gear).collect(),
            Self::Gain => actuators.map(|a| &mut a.gain).collect(),
            Self::Bias => actuators.flat_map(|a| &mut a.bias).collect(),
        }
    }

    /// The numbers of a model, row after row.
    pub fn of(self, model: &Model) -> Vec<f64> {
        let mut parts = (**model).clone();
        self.places(&mut parts).into_iter().map(|x| *x).collect()
    }
}

impl<T: Float> Simulation<T> {
    /// Gives a world other numbers, each parameter row after row; what
    /// [`set_world_model`](Simulation::set_world_model) says of them holds.
    ///
    /// # Errors
    /// As there; arrays of the wrong length; numbers that no model may have.
    pub fn set_parameters(
        &mut self,
        world: usize,
        parameters: &[(Parameter, &[f64])],
    ) -> Result<(), SimulationError> {
        index("world", world, self.worlds())?;
        let model = self.model_with(world, parameters)?;
        self.give_model(world, model)
    }

    /// Gives several worlds other numbers of one parameter, of which `numbers` has as many for each world; or none of
    /// them, where those of one are refused. As [`set_parameters`](Simulation::set_parameters) else.
    ///
    /// # Errors
    /// As there, with the world.
    pub fn set_parameter(
        &mut self,
        parameter: Parameter,
        worlds: &[usize],
        numbers: &[f64],
    ) -> Result<(), SimulationError> {
        self.set_parameters_of(worlds, &[(parameter, numbers)])
    }

    /// As [`set_parameter`](Simulation::set_parameter), of several parameters at once, also where these can be had only
    /// together.
    ///
    /// # Errors
    /// As there.
    pub fn set_parameters_of(
        &mut self,
        worlds: &[usize],
        parameters: &[(Parameter, &[f64])],
    ) -> Result<(), SimulationError> {
        let mut tables = Vec::with_capacity(parameters.len());
        for &(parameter, numbers) in parameters {
            let columns = parameter.of(self.model()).len();
            length(parameter.name(), numbers.len(), worlds.len() * columns)?;
            tables.push((parameter, numbers, columns));
        }
        let own = |(i, &world): (usize, &usize)| {
            index("world", world, self.worlds())?;
            let rows = tables.iter().map(|&(parameter, numbers, columns)| {
                (parameter, &numbers[i * columns..][..columns])
            });
            let own = Vec::from_iter(rows);
            let own = self
                .model_with(world, &own)
                .and_then(|model| self.compiled_alike(world, model));
            let own = own.map_err(|why| {
                let why = match (why, parameters) {
                    (SimulationError::Structure { .. }, &[(parameter, _)]) => {
                        SimulationError::Parameter {
                            parameter: parameter.name(),
                        }
                    }
                    // It names the world itself.
                    (why @ SimulationError::Structure { .. }, _) => return why,
                    (why, _) => why,
                };
                let why = Box::new(why);
                SimulationError::InWorld { world, why }
            })?;
            Ok::<_, SimulationError>((world, own))
        };
        // All, so that of several faults the first one is told.
        let models = worlds.par_iter().enumerate().map(own);
        let models = self.threads.run(|| models.collect::<Vec<_>>());
        self.give_own(models.into_iter().collect::<Result<_, _>>()?)
    }

    /// A world's model with other numbers.
    fn model_with(
        &self,
        world: usize,
        parameters: &[(Parameter, &[f64])],
    ) -> Result<Arc<Model>, SimulationError> {
        let mut parts = (***self.world_model(world)).clone();
        for (parameter, numbers) in parameters {
            let places = parameter.places(&mut parts);
            length(parameter.name(), numbers.len(), places.len())?;
            for (place, x) in places.into_iter().zip(*numbers) {
                *place = *x;
            }
        }
        Ok(Arc::new(Model::new(parts)?))
    }
}
