//! What a session simulates: a model, and how it starts.

use crate::SessionError;
use crate::describe;
use crate::perturb::perturb;
use crate::protocol::Camera;
use crate::wander::Wander;
use fastrand::Rng;
use formats::Loaded;
use model::{Keyframe, Model};
use numbers::Float;
use rigid::{Integrator, Settings};
use sim::{Simulation, SimulationSettings, SolverKind};

/// A model, and how it is started, driven and shown at first.
#[derive(Clone, Debug)]
pub struct Stage {
    /// The model.
    pub model: Model,
    /// Where it starts; none is the model's own state.
    pub keyframe: Option<Keyframe>,
    /// Number of worlds.
    pub worlds: usize,
    /// Solver.
    pub solver: SolverKind,
    /// How a step advances the state, where the solver is `featherstone`.
    pub integrator: Integrator,
    /// Substeps a time step; none are those that the solver usually takes.
    pub substeps: Option<usize>,
    /// How far each world but the first starts from the model's state [rad or m].
    pub perturb: f64,
    /// Size of random controls of the actuators, as a share of their ranges; 0: none.
    pub wander: f64,
    /// Joints whose drives have sliders.
    pub sliders: Vec<String>,
    /// Labels of the quantities that are plotted at first.
    pub plots: Vec<String>,
    /// Cameras that see for a robot: the model's at first.
    pub cameras: Vec<Camera>,
    /// Number of worlds that are shown at first.
    pub shown: usize,
    /// What of the model's file was left out, a line each.
    pub left_out: Vec<String>,
}

impl Stage {
    /// A model in as many worlds as it asks for, the first of which is shown, with energies plotted.
    pub fn new(model: Model) -> Self {
        let plots = ["Kinetic energy", "Potential energy", "Energy"];
        Self {
            keyframe: None,
            cameras: describe::cameras(&model),
            worlds: model.worlds,
            model,
            solver: SolverKind::Auto,
            integrator: Integrator::SemiImplicitEuler,
            substeps: None,
            perturb: 0.0,
            wander: 0.0,
            sliders: Vec::new(),
            plots: plots.map(str::to_owned).to_vec(),
            shown: 1,
            left_out: Vec::new(),
        }
    }

    /// The same of a file that was read, with what of it was left out.
    pub fn loaded(Loaded { model, warnings }: Loaded) -> Self {
        Self {
            left_out: warnings.iter().map(ToString::to_string).collect(),
            ..Self::new(model)
        }
    }

    /// The same, starting from the model's first keyframe, if it has one.
    pub fn at_first_keyframe(self) -> Self {
        Self {
            keyframe: self.model.keyframes.first().cloned(),
            ..self
        }
    }

    /// Its worlds at their start.
    ///
    /// # Errors
    /// A model that the solver does not take.
    pub fn simulation(&self) -> Result<Simulation<f32>, SessionError> {
        let (solver, time_step) = (self.solver, self.model.time_step);
        let settings = self.settings(solver, time_step, self.substeps(solver));
        let mut simulation = Simulation::new(self.model.clone(), settings)?;
        self.place(&mut simulation)?;
        Ok(simulation)
    }

    /// Makes so many steps of a simulation at its start, under the stage's random controls.
    ///
    /// # Errors
    /// A simulation of another model; a device that fails.
    pub fn run(&self, simulation: &mut Simulation<f32>, steps: u64) -> Result<(), SessionError> {
        let mut wander = Wander::new(self.wander);
        let unset = vec![None; self.model.actuators.len()];
        let mut done = 0;
        while done < steps {
            let next = wander.steer(simulation, done, &unset)?.min(steps - done);
            simulation.try_step(next as usize)?;
            done += next;
        }
        Ok(())
    }

    /// Settings of a simulation, of a solver, with so many substeps a time step [s].
    pub(crate) fn settings(
        &self,
        solver: SolverKind,
        time_step: f64,
        substeps: usize,
    ) -> SimulationSettings {
        SimulationSettings {
            solver,
            step: Settings {
                substeps,
                integrator: solver.usual_integrator(&self.model, true, self.integrator),
                ..Settings::new(time_step)
            },
            ..SimulationSettings::new(self.worlds, time_step)
        }
    }

    /// Substeps a time step for a solver, as long as nobody says otherwise.
    pub(crate) fn substeps(&self, solver: SolverKind) -> usize {
        let usual = || solver.usual_substeps(&self.model, true);
        self.substeps.unwrap_or_else(usual)
    }

    /// Puts all worlds at the start, and moves all but the first apart.
    pub(crate) fn place<T: Float>(
        &self,
        simulation: &mut Simulation<T>,
    ) -> Result<(), SessionError> {
        simulation.reset_all();
        let keyframe = self.keyframe.as_ref();
        let at_rest = vec![0.0; self.model.degrees_of_freedom()];
        let (position, velocity) = match keyframe {
            Some(frame) => (frame.joint_position.clone(), &frame.joint_velocity),
            None => (self.model.initial_position(), &at_rest),
        };
        let mut rng = Rng::with_seed(1);
        for world in 0..self.worlds {
            let near = match world {
                0 => position.clone(),
                _ => perturb(&self.model, &position, self.perturb, &mut rng),
            };
            simulation.set_joint_state(world, &near, velocity)?;
            if let Some(frame) = keyframe.filter(|frame| !frame.control.is_empty()) {
                simulation.controls().set_control(world, &frame.control)?;
            }
        }
        Ok(())
    }
}
