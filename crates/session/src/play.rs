//! What a session simulates now.

use crate::card::Card;
use crate::describe;
use crate::error::SessionError;
use crate::form::Form;
use crate::frame::Frame;
use crate::gallery::Example;
use crate::hands::Subject;
use crate::history::{History, Moment};
use crate::physics::Physics;
use crate::protocol::{Command, Scene, Values};
use crate::quantity::{Measure, quantities, unlisted};
use crate::stage::Stage;
use crate::wander::Wander;
use formats::{Files, Meshes, Options};
use model::{BodyId, Model, Parts};
use numbers::Float;
use sim::{Simulation, SimulationError, Snapshot};
use std::io;

/// Worlds of a program that are shown at first.
const MOST_SHOWN: usize = 64;

/// What is simulated, but for the simulation.
pub(crate) struct Play {
    pub name: String,
    pub title: String,
    pub guide: String,
    pub origin: Origin,
    pub build: Form,
    pub stage: Stage,
    /// Whether meshes that are only seen are opened: those that a page names are not.
    pub opens_meshes: bool,
    pub physics: Physics,
    /// The stage's model, with gravity and gains of drives as the page has set them.
    pub parts: Parts,
    /// Of each degree of freedom, the target position and velocity that the page has set, if it has.
    pub targets: Vec<[Option<f64>; 2]>,
    /// Of each actuator, the control that the page has set, if it has.
    pub control: Vec<Option<f64>>,
    pub measures: Vec<Measure>,
    /// Since the start.
    pub steps: u64,
    /// The world whose steps these are, of a program's.
    pub keeper: usize,
    pub history: History,
    pub wander: Wander,
}

/// Where it comes from.
pub(crate) enum Origin {
    Example(&'static Example),
    File,
    /// A program, which steps it, too; and the state in which the session found it.
    Program(Snapshot),
}

impl std::fmt::Debug for Play {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Play")
            .field("name", &self.name)
            .field("steps", &self.steps)
            .finish_non_exhaustive()
    }
}

/// What a robot file of a page may name: nothing.
struct Alone;
/// Why.
const ALONE: &str = "a page gives one file; open it with `kinetarium view`, which finds others";

impl Files for Alone {
    fn read(&self, _: &str) -> io::Result<String> {
        Err(io::Error::new(io::ErrorKind::NotFound, ALONE))
    }
    fn bytes(&self, name: &str) -> io::Result<Vec<u8>> {
        Ok(self.read(name)?.into_bytes())
    }
    fn exists(&self, _: &str) -> bool {
        false
    }
    fn remedy(&self) -> &str {
        ALONE
    }
    fn path(&self, name: &str) -> String {
        name.to_owned()
    }
}

/// Length of a time step [s].
pub(crate) fn time_step<T: Float>(simulation: &Simulation<T>) -> f64 {
    simulation.settings().step.time_step
}

/// The world whose time counts: the first of those shown that runs.
pub(crate) fn keeper<T: Float>(simulation: &Simulation<T>, shown: &[usize]) -> usize {
    let stopped = simulation.diverged();
    let runs = |world: &&usize| stopped.iter().all(|diverged| diverged.world != **world);
    *shown.iter().find(runs).unwrap_or(&shown[0])
}
/// Steps of a world since the start of what may be stepped by others.
pub(crate) fn steps<T: Float>(simulation: &Simulation<T>, world: usize) -> u64 {
    (simulation.time(world) / time_step(simulation)).round() as u64
}

impl Play {
    pub fn of_example<T: Float>(
        example: &'static Example,
        build: Form,
        physics: &Values,
        card: &Card<T>,
    ) -> Result<(Self, Simulation<T>), SessionError> {
        let stage = (example.make)(&build)?;
        let physics = Physics::new(&stage, card).with(physics)?;
        let play = Self {
            name: example.name.into(),
            title: example.title.into(),
            guide: example.guide.into(),
            build,
            ..Self::new(Origin::Example(example), stage, physics)
        };
        play.simulated(card)
    }
    /// A model that is no example, under a name that none has.
    pub fn of_model<T: Float>(
        stage: Stage,
        physics: &Values,
        card: &Card<T>,
    ) -> Result<(Self, Simulation<T>), SessionError> {
        let physics = Physics::new(&stage, card).with(physics)?;
        let mut play = Self::new(Origin::File, stage, physics);
        let left_out = play.stage.left_out.iter();
        let lines: String = left_out.map(|line| format!("\n{line}")).collect();
        if !lines.is_empty() {
            play.guide = String::from("Not supported, and left out:") + &lines;
        }
        if Example::find(&play.name).is_ok() {
            play.name.insert_str(0, "own_");
        }
        play.simulated(card)
    }
    /// A robot file, without the files that it may name.
    pub fn of_file<T: Float>(
        name: &str,
        text: &str,
        card: &Card<T>,
    ) -> Result<(Self, Simulation<T>), SessionError> {
        let options = Options {
            meshes: Meshes::ConvexHull,
            ..Options::default()
        };
        let read = formats::parse(text, name, &Alone, &options).map_err(Box::new)?;
        let (mut play, simulation) = Self::of_model(Stage::loaded(read), &Values::new(), card)?;
        (play.name, play.opens_meshes) = (name.into(), false);
        Ok((play, simulation))
    }
    /// Panics where its worlds are on a device that fails.
    pub fn of_program<T: Float>(simulation: &mut Simulation<T>) -> Self {
        let worlds = simulation.worlds();
        let stage = Stage {
            worlds,
            shown: worlds.min(MOST_SHOWN),
            ..Stage::new(simulation.model().as_ref().clone())
        };
        let start = simulation.snapshot();
        let mut play = Self::new(Origin::Program(start.clone()), stage, Physics::of_program());
        play.keeper = keeper(simulation, &Vec::from_iter(0..play.stage.shown));
        play.steps = steps(simulation, play.keeper);
        play.begin_history(simulation, start);
        play
    }

    /// Named as its model, and not yet simulated.
    fn new(origin: Origin, stage: Stage, physics: Physics) -> Self {
        let model = &stage.model;
        let measures = quantities(model).into_iter().map(|(m, _)| m);
        Self {
            name: model.name.clone(),
            title: model.name.clone(),
            guide: String::new(),
            origin,
            build: Form::new(Vec::new()),
            physics,
            opens_meshes: true,
            parts: model.clone().into_parts(),
            targets: vec![[None; 2]; model.degrees_of_freedom()],
            control: vec![None; model.actuators.len()],
            measures: measures.collect(),
            steps: 0,
            keeper: 0,
            history: History::new(1.0, 0),
            wander: Wander::new(stage.wander),
            stage,
        }
    }
    /// With a simulation of it, at its start.
    fn simulated<T: Float>(
        mut self,
        card: &Card<T>,
    ) -> Result<(Self, Simulation<T>), SessionError> {
        self.physics.change(&mut self.parts);
        let model = Model::new(self.parts.clone())?;
        let mut simulation = self.physics.simulate(model, &self.stage, card)?;
        self.restart(&mut simulation, &[0])?;
        Ok((self, simulation))
    }

    /// Refuses what only a program may do where the simulation is its own.
    pub fn not_of_program(&self, what: &'static str) -> Result<(), SessionError> {
        match self.origin {
            Origin::Program(_) => Err(SessionError::Program { what }),
            Origin::Example(_) | Origin::File => Ok(()),
        }
    }
    /// Simulated seconds since the start.
    pub fn time<T: Float>(&self, simulation: &Simulation<T>) -> f64 {
        self.steps as f64 * time_step(simulation)
    }

    /// The initial state, with what the page has set; its time is that of the worlds shown.
    pub fn restart<T: Float>(
        &mut self,
        simulation: &mut Simulation<T>,
        shown: &[usize],
    ) -> Result<(), SessionError> {
        match &self.origin {
            Origin::Program(start) => simulation.restore(start)?,
            Origin::Example(_) | Origin::File => self.stage.place(simulation)?,
        }
        self.aim(simulation)?;
        self.keeper = keeper(simulation, shown);
        self.steps = steps(simulation, self.keeper);
        self.wander = Wander::new(self.stage.wander);
        let start = simulation.try_snapshot()?;
        self.begin_history(simulation, start);
        Ok(())
    }

    /// Goes by the time of these worlds, if it is a program's, which may reset each by itself. What is recorded by
    /// another time is forgotten.
    pub fn go_by<T: Float>(
        &mut self,
        simulation: &mut Simulation<T>,
        shown: &[usize],
    ) -> Result<(), SimulationError> {
        self.keeper = keeper(simulation, shown);
        let steps = steps(simulation, self.keeper);
        if self.not_of_program("").is_err() && steps != self.steps {
            let now = simulation.try_snapshot()?;
            self.steps = steps;
            self.begin_history(simulation, now);
        }
        Ok(())
    }

    /// Goes on with other numbers of the model or the settings. State and recorded past stay where they fit;
    /// where they do not, answers false and starts again.
    pub fn change<T: Float>(
        &mut self,
        subject: &mut Subject<T>,
        parts: Parts,
        physics: Physics,
    ) -> Result<bool, SessionError> {
        let model = Model::new(parts.clone())?;
        let mut changed = physics.simulate(model, &self.stage, &subject.card)?;
        let before = time_step(&subject.simulation);
        let stays = changed.restore(&subject.simulation.try_snapshot()?).is_ok();
        if !stays {
            self.stage.place(&mut changed)?;
        }
        self.aim(&mut changed)?;
        let after = time_step(&changed);
        let anew = if stays {
            None
        } else {
            Some(changed.try_snapshot()?)
        };
        (subject.simulation, self.parts, self.physics) = (changed, parts, physics);
        match anew {
            None => {
                self.steps = (self.steps as f64 * before / after).round() as u64;
                self.history.rescale(before, after);
            }
            Some(start) => {
                self.steps = 0;
                self.begin_history(&subject.simulation, start);
            }
        }
        Ok(stays)
    }
    /// Goes on on the processor, with the same solver, where a card has failed: from the recorded state nearest
    /// to the present one. What has been set of the physics.
    pub fn leave_card<T: Float>(
        &mut self,
        simulation: &mut Simulation<T>,
    ) -> Result<Values, SessionError> {
        let values = self.physics.on_processor(simulation.solver());
        let physics = self.physics.clone().with(&values)?;
        let model = Model::new(self.parts.clone())?;
        let mut here = physics.simulate(model, &self.stage, &Card::Unasked)?;
        match self.history.nearest(self.steps) {
            Some(moment) => {
                here.restore(&moment.snapshot)?;
                self.steps = moment.steps;
            }
            None => {
                self.stage.place(&mut here)?;
                self.steps = 0;
            }
        }
        self.aim(&mut here)?;
        (*simulation, self.physics) = (here, physics);
        self.history.branch(self.steps);
        Ok(values)
    }

    /// Gives drives and actuators what the page has set last.
    pub fn aim<T: Float>(&self, simulation: &mut Simulation<T>) -> Result<(), SimulationError> {
        let set = |row: &usize| self.targets[*row].iter().any(Option::is_some);
        for dof in (0..self.targets.len()).filter(set) {
            self.aim_drive(simulation, dof)?;
        }
        let set = |row: &usize| self.control[*row].is_some();
        for actuator in (0..self.control.len()).filter(set) {
            self.aim_actuator(simulation, actuator)?;
        }
        Ok(())
    }
    /// Gives a drive the targets that the page has set last, in all worlds.
    pub fn aim_drive<T: Float>(
        &self,
        simulation: &mut Simulation<T>,
        dof: usize,
    ) -> Result<(), SimulationError> {
        let [position, velocity] = self.targets[dof];
        for world in 0..simulation.worlds() {
            let mut controls = simulation.controls();
            if let Some(position) = position {
                controls.set_target(world, dof, position)?;
            }
            if let Some(velocity) = velocity {
                controls.set_target_velocity(world, dof, velocity)?;
            }
        }
        Ok(())
    }
    /// Gives an actuator the control that the page has set last, in all worlds.
    pub fn aim_actuator<T: Float>(
        &self,
        simulation: &mut Simulation<T>,
        actuator: usize,
    ) -> Result<(), SimulationError> {
        for world in 0..simulation.worlds() {
            let mut control = Numbers::of(simulation, world)?.control;
            control[actuator] = self.control[actuator].unwrap_or(control[actuator]);
            simulation.controls().set_control(world, &control)?;
        }
        Ok(())
    }

    fn begin_history<T: Float>(&mut self, simulation: &Simulation<T>, now: Snapshot) {
        let bytes = simulation.bytes_per_world() * simulation.worlds();
        self.history = History::new(time_step(simulation), bytes);
        self.history.record(Moment {
            steps: self.steps,
            snapshot: now,
        });
    }
    pub fn record<T: Float>(
        &mut self,
        simulation: &mut Simulation<T>,
    ) -> Result<(), SimulationError> {
        self.history.record(Moment {
            steps: self.steps,
            snapshot: simulation.try_snapshot()?,
        });
        Ok(())
    }

    /// The present state of some worlds; what the session knows is left open.
    pub fn frame<T: Float>(
        &self,
        simulation: &mut Simulation<T>,
        shown: &[usize],
        plots: &[usize],
    ) -> Result<Frame, SimulationError> {
        let time = self.time(simulation);
        let model = simulation.model().clone();
        let outputs = simulation.try_outputs()?;
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
        frame.plots = self.measure(simulation, plots, shown[0])?;
        Ok(frame)
    }

    /// Values of some quantities, by their rows, of a world.
    pub fn measure<T: Float>(
        &self,
        simulation: &mut Simulation<T>,
        plots: &[usize],
        world: usize,
    ) -> Result<Vec<f32>, SimulationError> {
        let measures = plots.iter().map(|&i| self.measures[i]);
        let measures: Vec<_> = measures.collect();
        simulation.observe(|simulation, outputs| {
            let values = measures
                .iter()
                .map(|m| m.of(simulation, outputs, world) as f32);
            values.collect()
        })
    }

    /// What a page is told of it; what the session knows is left open.
    /// What drives it is that of a world.
    pub fn scene<T: Float>(&self, simulation: &mut Simulation<T>, world: usize) -> Scene {
        let model = simulation.model().clone();
        let numbers = Numbers::of(simulation, world).expect("the worlds shown are there");
        let bounds = describe::bounds(&model);
        let wide = (0..3).map(|i| bounds[1][i] - bounds[0][i]);
        let gains = self.not_of_program("").is_ok();
        Scene {
            id: 0,
            name: self.name.clone(),
            title: self.title.clone(),
            guide: self.guide.clone(),
            up: match model.up_axis {
                model::UpAxis::Y => 'y',
                model::UpAxis::Z => 'z',
            },
            time_step: time_step(simulation),
            worlds: simulation.worlds() as u32,
            solver: simulation.solver().into(),
            isa: simulation.isa().to_string(),
            build: self.build.fields().to_vec(),
            physics: self.physics.fields_of(simulation.solver()),
            bodies: describe::bodies(&model),
            shapes: describe::shapes(&model, self.opens_meshes),
            joints: describe::joints(&model, &numbers.targets, &self.stage.sliders, gains),
            actuators: describe::actuators(&model, &numbers.control),
            cameras: self.stage.cameras.clone(),
            lamps: describe::lamps(&model),
            sun: model::Lamp::sun(&model.lamps).map_or(-1, |row| row as i32),
            quantities: quantities(&model).into_iter().map(|(_, q)| q).collect(),
            unlisted: unlisted(&model),
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

/// The controls of a world.
#[derive(Debug)]
pub(crate) struct Numbers {
    /// Target position and velocity of each degree of freedom.
    targets: Vec<[f64; 2]>,
    /// Of each actuator.
    control: Vec<f64>,
}

impl Numbers {
    pub fn of<T: Float>(
        simulation: &mut Simulation<T>,
        world: usize,
    ) -> Result<Self, SimulationError> {
        let dofs = simulation.model().degrees_of_freedom();
        simulation.fetch_controls()?;
        let numbers = simulation.controls().of_world(world)?;
        let (targets, control) = numbers[dofs..].split_at(2 * dofs);
        let (position, velocity) = targets.split_at(dofs);
        let targets = position.iter().zip(velocity).map(|(&q, &v)| [q, v]);
        Ok(Self {
            targets: targets.collect(),
            control: control.to_vec(),
        })
    }
    /// Commands that make these of others.
    pub fn beside(&self, others: &Self) -> Vec<Command> {
        let targets = self.targets.iter().zip(&others.targets).enumerate();
        let moved = targets.filter(|(_, (own, other))| own != other);
        let joints = moved.map(|(dof, (&[position, velocity], _))| Command::Joint {
            dof: dof as u32,
            position: Some(position),
            stiffness: None,
            velocity: Some(velocity),
            damping: None,
        });
        let control = self.control.iter().zip(&others.control).enumerate();
        let moved = control.filter(|(_, (own, other))| own != other);
        let controls = moved.map(|(actuator, (&value, _))| Command::Control {
            actuator: actuator as u32,
            value,
        });
        joints.chain(controls).collect()
    }
    /// Takes from others what a command sets.
    pub fn take(&mut self, command: &Command, others: &Self) {
        match *command {
            Command::Joint { dof, .. } => self.targets[dof as usize] = others.targets[dof as usize],
            Command::Control { actuator, .. } => {
                self.control[actuator as usize] = others.control[actuator as usize];
            }
            _ => {}
        }
    }
}
