//! What a session simulates now.

use crate::describe;
use crate::error::SessionError;
use crate::form::Form;
use crate::frame::Frame;
use crate::gallery::Example;
use crate::history::{History, Moment};
use crate::physics::Physics;
use crate::protocol::{Scene, Values};
use crate::quantity::{Measure, quantities};
use crate::stage::Stage;
use fastrand::Rng;
use model::{BodyId, JointId, Model, Parts};
use sim::{Simulation, SimulationError};

/// From one random control to the next [s].
const WANDER: f64 = 0.1;

/// What is simulated.
pub(crate) struct Play {
    pub name: String,
    pub title: String,
    pub guide: String,
    pub example: Option<&'static Example>,
    pub build: Form,
    pub stage: Stage,
    pub physics: Physics,
    /// The stage's model, with gravity and drives as the page has set them.
    pub parts: Parts,
    /// Of each actuator, the control that the page has set, if it has.
    pub control: Vec<Option<f64>>,
    pub simulation: Simulation<f32>,
    pub measures: Vec<Measure>,
    pub steps: u64,
    pub history: History,
    pub rng: Rng,
}

impl std::fmt::Debug for Play {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Play")
            .field("name", &self.name)
            .field("steps", &self.steps)
            .finish_non_exhaustive()
    }
}

impl Play {
    pub fn of_example(
        example: &'static Example,
        build: Form,
        physics: &Values,
    ) -> Result<Self, SessionError> {
        let stage = (example.make)(&build)?;
        let guide = example.guide.to_owned();
        let names = (example.name.to_owned(), example.title.to_owned(), guide);
        Self::new(names, Some(example), build, stage, physics)
    }
    pub fn of_model(stage: Stage) -> Result<Self, SessionError> {
        let name = stage.model.name.clone();
        let names = (name.clone(), name, String::new());
        Self::new(names, None, Form::new(Vec::new()), stage, &Values::new())
    }

    fn new(
        (name, title, guide): (String, String, String),
        example: Option<&'static Example>,
        build: Form,
        stage: Stage,
        physics: &Values,
    ) -> Result<Self, SessionError> {
        let physics = Physics::new(&stage).with(physics)?;
        let mut parts = stage.model.clone().into_parts();
        physics.change(&mut parts);
        let simulation = simulate(&parts, &stage, &physics)?;
        let actuators = stage.model.actuators.len();
        let measures = quantities(&stage.model)
            .into_iter()
            .map(|(m, _)| m)
            .collect();
        let mut play = Self {
            history: history(&simulation),
            name,
            title,
            guide,
            example,
            build,
            stage,
            physics,
            parts,
            control: vec![None; actuators],
            simulation,
            measures,
            steps: 0,
            rng: Rng::with_seed(1),
        };
        play.restart()?;
        Ok(play)
    }

    pub fn model(&self) -> &Model {
        self.simulation.model()
    }
    pub fn worlds(&self) -> usize {
        self.simulation.worlds()
    }
    pub fn time_step(&self) -> f64 {
        self.simulation.settings().step.time_step
    }
    pub fn time(&self) -> f64 {
        self.steps as f64 * self.time_step()
    }

    /// The initial state, with the targets of the drives as they are now.
    pub fn restart(&mut self) -> Result<(), SessionError> {
        self.stage.place(&mut self.simulation)?;
        self.aim()?;
        self.steps = 0;
        self.rng = Rng::with_seed(1);
        self.history = history(&self.simulation);
        self.record();
        Ok(())
    }

    /// Goes on with other numbers of the model or the settings. The state stays where it fits; where it
    /// does not, answers false and starts again.
    pub fn change(&mut self, parts: Parts, physics: Physics) -> Result<bool, SessionError> {
        let mut simulation = simulate(&parts, &self.stage, &physics)?;
        let time = self.time();
        let stays = simulation.restore(&self.simulation.snapshot()).is_ok();
        if !stays {
            self.stage.place(&mut simulation)?;
        }
        (self.simulation, self.parts, self.physics) = (simulation, parts, physics);
        self.aim()?;
        self.steps = if stays {
            (time / self.time_step()).round() as u64
        } else {
            0
        };
        self.history = history(&self.simulation);
        self.record();
        Ok(stays)
    }

    /// Gives drives and actuators what the page has set last.
    pub fn aim(&mut self) -> Result<(), SimulationError> {
        let model = self.simulation.model().clone();
        let joints = (0..model.joints.len()).map(JointId);
        for id in joints.filter(|id| !model.joints[id.0].closes_loop) {
            for (dof, row) in self.parts.joints[id.0].dofs.iter().zip(model.dof_range(id)) {
                for world in 0..self.simulation.worlds() {
                    let mut controls = self.simulation.controls();
                    controls.set_target(world, row, dof.drive.target_position)?;
                    controls.set_target_velocity(world, row, dof.drive.target_velocity)?;
                }
            }
        }
        for world in 0..self.worlds() {
            let present = self.controls(world)?;
            let set = self.control.iter().zip(present);
            let control: Vec<f64> = set.map(|(set, now)| set.unwrap_or(now)).collect();
            self.simulation.controls().set_control(world, &control)?;
        }
        Ok(())
    }

    /// Controls of a world's actuators.
    pub fn controls(&mut self, world: usize) -> Result<Vec<f64>, SimulationError> {
        let actuators = self.simulation.model().actuators.len();
        let numbers = self.simulation.controls().of_world(world)?;
        Ok(numbers[numbers.len() - actuators..].to_vec())
    }

    pub fn record(&mut self) {
        self.history.record(Moment {
            steps: self.steps,
            snapshot: self.simulation.snapshot(),
        });
    }

    /// New random controls of all actuators that the page has not set, if it is time.
    pub fn wander(&mut self) -> Result<(), SimulationError> {
        let every = (WANDER / self.time_step()).round().max(1.0) as u64;
        if self.stage.wander == 0.0 || !self.steps.is_multiple_of(every) {
            return Ok(());
        }
        let model = self.simulation.model().clone();
        for world in 0..self.worlds() {
            let control = |(actuator, set): (&model::Actuator, &Option<f64>)| {
                let (lower, upper) = describe::control_range(actuator);
                let (middle, half) = (0.5 * (lower + upper), 0.5 * (upper - lower));
                let drawn = middle + self.stage.wander * half * (2.0 * self.rng.f64() - 1.0);
                set.unwrap_or(drawn)
            };
            let controls = model.actuators.iter().zip(&self.control);
            let control: Vec<f64> = controls.map(control).collect();
            self.simulation.controls().set_control(world, &control)?;
        }
        Ok(())
    }

    /// The present state of some worlds; what the session knows is left open.
    pub fn frame(&mut self, shown: &[usize], plots: &[usize]) -> Frame {
        let time = self.time();
        let model = self.simulation.model().clone();
        let outputs = self.simulation.outputs();
        let mut frame = Frame {
            time,
            steps: self.steps as u32,
            worlds: shown.len() as u32,
            bodies: model.bodies.len() as u32,
            ..Frame::default()
        };
        for (slot, &world) in shown.iter().enumerate() {
            for body in (0..model.bodies.len()).map(BodyId) {
                let at = outputs.body_position(world, body).as_vec3();
                let turned = outputs.body_orientation(world, body).as_quat();
                frame.poses.extend(at.to_array());
                frame.poses.extend(turned.to_array());
            }
            for contact in outputs.contacts(world) {
                frame.contacts.push(slot as f32);
                frame.contacts.extend(contact.position.as_vec3().to_array());
                frame.contacts.extend(contact.force.as_vec3().to_array());
                frame.contacts.push(contact.distance as f32);
                frame.contacts.extend(contact.shapes.map(|s| s.0 as f32));
            }
        }
        let single = |x: Vec<f64>| x.into_iter().map(|x| x as f32).collect();
        frame.positions = single(outputs.joint_position(shown[0]));
        frame.velocities = single(outputs.joint_velocity(shown[0]));
        frame.plots = self.measure(plots, shown[0]);
        frame
    }

    /// Values of some quantities, by their rows, of a world.
    pub fn measure(&mut self, plots: &[usize], world: usize) -> Vec<f32> {
        let model = self.simulation.model().clone();
        let outputs = self.simulation.outputs();
        let values = plots
            .iter()
            .map(|&i| self.measures[i].of(&model, &outputs, world) as f32);
        values.collect()
    }

    /// What a page is told of it; what the session knows is left open.
    pub fn scene(&mut self) -> Scene {
        let model = self.simulation.model().clone();
        let none = || vec![0.0; model.actuators.len()];
        let controls = self.controls(0).unwrap_or_else(|_| none());
        let bounds = describe::bounds(&model);
        let wide = (0..3).map(|i| bounds[1][i] - bounds[0][i]);
        Scene {
            id: 0,
            name: self.name.clone(),
            title: self.title.clone(),
            guide: self.guide.clone(),
            up: match model.up_axis {
                model::UpAxis::Y => 'y',
                model::UpAxis::Z => 'z',
            },
            time_step: self.time_step(),
            worlds: self.worlds() as u32,
            solver: self.simulation.solver().into(),
            isa: self.simulation.isa().to_string(),
            build: self.build.fields().to_vec(),
            physics: self.physics.fields().to_vec(),
            bodies: describe::bodies(&model),
            shapes: describe::shapes(&model),
            joints: describe::joints(&model, &self.parts.joints, &self.stage.sliders),
            actuators: describe::actuators(&model, &controls),
            cameras: self.stage.cameras.clone(),
            quantities: quantities(&model).into_iter().map(|(_, q)| q).collect(),
            plots: self.first_plots().map(|i| i as u32).collect(),
            shown: Vec::new(),
            spacing: (1.25 * wide.fold(0.0, f64::max)).max(0.5),
            bounds,
        }
    }

    /// Rows of the quantities that the stage plots at first.
    pub fn first_plots(&self) -> impl Iterator<Item = usize> {
        let known = quantities(&self.stage.model);
        let row = |plot: &String| known.iter().position(|(_, q)| q.label == *plot);
        let rows: Vec<_> = self.stage.plots.iter().filter_map(row).collect();
        rows.into_iter()
    }
}

fn simulate(
    parts: &Parts,
    stage: &Stage,
    physics: &Physics,
) -> Result<Simulation<f32>, SessionError> {
    let model = Model::new(parts.clone())?;
    Ok(Simulation::new(model, physics.settings(stage))?)
}

fn history(simulation: &Simulation<f32>) -> History {
    let bytes = simulation.bytes_per_world() * simulation.worlds();
    History::new(simulation.settings().step.time_step, bytes)
}
