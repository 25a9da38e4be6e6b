//! A simulation that a page watches and steers.

use crate::describe::control_range;
use crate::error::{SessionError, row, within};
use crate::frame::Frame;
use crate::gallery::{EXAMPLES, Example};
use crate::physics::Physics;
use crate::play::Play;
use crate::protocol::{Command, Message, PROTOCOL, Scene, Status, Values};
use crate::pull::{Grab, Push, add_force};
use crate::stage::Stage;
use glam::DVec3;
use model::{BodyId, BodyKind, JointId, JointKind};
use std::collections::VecDeque;

/// Longest stretch of computing between two looks at what the page says [s].
const SLICE: f64 = 0.012;
/// Steps between two looks at the clock, at most.
const MOST_AT_ONCE: u64 = 1 << 16;
/// Blows that wait for the next step, at most.
const MOST_PUSHES: usize = 256;
/// Largest stiffness and damping of a drive, in SI units.
const STIFFEST: f64 = 1e9;
/// From one frame to the next [s].
const FRAME: f64 = 1.0 / 60.0;
/// From one sample of the plotted quantities to the next, in simulated seconds.
const SAMPLE: f64 = 1.0 / 60.0;
/// Samples that wait for a frame; older ones go.
const MOST_SAMPLES: usize = 2048;
/// From one status to the next while running [s].
const STATUS: f64 = 0.25;
/// Frames show no more worlds than this.
const MOST_SHOWN: usize = 256;
/// And plot no more quantities.
const MOST_PLOTS: usize = 16;
/// Steps that one command may ask for.
const MOST_STEPS: u32 = 100_000;

/// What goes to the page.
#[derive(Clone, Debug, PartialEq)]
pub enum Outgoing {
    /// A [`Message`] as JSON.
    Text(String),
    /// A [`Message::Error`] as JSON: an answer to what the page has just said.
    Refusal(String),
    /// A [`Frame`] as bytes.
    Frame(Vec<u8>),
}

/// A simulation that pages watch and steer: commands go in, messages and frames come out.
///
/// It knows no transport and no clock of its own: `clock` tells seconds since any moment.
#[derive(Debug)]
pub struct Session {
    clock: fn() -> f64,
    play: Play,
    grab: Option<Grab>,
    pushes: Vec<Push>,
    shown: Vec<usize>,
    /// Rows of the quantities that are plotted.
    plots: Vec<usize>,
    /// Samples of the plotted quantities since the last frame: when [s], and what.
    samples: VecDeque<(f64, Vec<f32>)>,
    running: bool,
    /// Simulated seconds a second of the clock.
    speed: Option<f64>,
    /// Time steps to be made; fractions of one while running.
    owed: f64,
    /// When the session last looked at the clock.
    looked: f64,
    /// When the last frame and the last status were sent.
    sent: [f64; 2],
    pace: Pace,
    scenes: u32,
    frames: u32,
    /// Whether something has changed since the last frame.
    stale: bool,
    outbox: VecDeque<Outgoing>,
}

/// How fast it goes, of late.
#[derive(Clone, Copy, Debug, Default)]
struct Pace {
    steps: u64,
    computing: f64,
    since: f64,
    pace: f64,
    rate: f64,
}

impl Session {
    /// The first example of the gallery, stopped. `clock` tells seconds.
    ///
    /// # Errors
    /// None; the examples are tested.
    pub fn gallery(clock: fn() -> f64) -> Result<Self, SessionError> {
        Self::example(EXAMPLES[0].name, clock)
    }
    /// An example of the gallery, stopped. `clock` tells seconds.
    ///
    /// # Errors
    /// There is none of that name.
    pub fn example(name: &str, clock: fn() -> f64) -> Result<Self, SessionError> {
        let example = Example::find(name)?;
        let play = Play::of_example(example, example.form(), &Values::new())?;
        Ok(Self::new(play, clock))
    }
    /// A stage of one's own, stopped. `clock` tells seconds.
    ///
    /// # Errors
    /// A stage that no simulation takes.
    pub fn of(stage: Stage, clock: fn() -> f64) -> Result<Self, SessionError> {
        Ok(Self::new(Play::of_model(stage)?, clock))
    }

    fn new(play: Play, clock: fn() -> f64) -> Self {
        let now = clock();
        let mut session = Self {
            clock,
            play,
            grab: None,
            pushes: Vec::new(),
            shown: Vec::new(),
            plots: Vec::new(),
            samples: VecDeque::new(),
            running: false,
            speed: Some(1.0),
            owed: 0.0,
            looked: now,
            sent: [f64::NEG_INFINITY; 2],
            pace: Pace::default(),
            scenes: 0,
            frames: 0,
            stale: true,
            outbox: VecDeque::new(),
        };
        session.opened();
        session.outbox = session.greeting().into();
        session
    }

    /// What the page is to be sent next, if anything.
    pub fn outgoing(&mut self) -> Option<Outgoing> {
        self.outbox.pop_front()
    }

    /// What a page that comes now must know. The first page is sent it by itself.
    pub fn greeting(&mut self) -> Vec<Outgoing> {
        let welcome = Message::Welcome {
            protocol: PROTOCOL,
            examples: EXAMPLES.iter().map(Example::describe).collect(),
        };
        let scene = Message::Scene(Box::new(self.scene()));
        let status = Message::Status(self.status());
        let mut greeting: Vec<_> = [welcome, scene, status].iter().map(text).collect();
        greeting.push(Outgoing::Frame(self.frame().to_bytes()));
        greeting
    }

    /// Does what a page says, a [`Command`] as JSON. What is refused is answered by a
    /// [`Message::Error`], and changes nothing.
    pub fn receive(&mut self, command: &str) {
        let kind = |command: &Command| {
            let value = serde_json::to_value(command).ok()?;
            Some(value.get("type")?.as_str()?.to_owned())
        };
        let read = serde_json::from_str(command).map_err(|e| SessionError::Command {
            reason: e.to_string(),
        });
        let asked = read.as_ref().ok().and_then(kind);
        match read.and_then(|command| self.perform(command)) {
            Ok(()) => {
                self.stale = true;
                let status = Message::Status(self.status());
                self.outbox.push_back(text(&status));
            }
            Err(error) => {
                let refusal = Message::Error {
                    message: error.to_string(),
                    refused: asked,
                };
                self.outbox.push_back(Outgoing::Refusal(json(&refusal)));
            }
        }
    }

    fn perform(&mut self, command: Command) -> Result<(), SessionError> {
        match command {
            Command::Open {
                example,
                build,
                physics,
            } => {
                let example = Example::find(&example)?;
                let form = example.form().with(&build)?;
                self.open(Play::of_example(example, form, &physics)?);
            }
            Command::Rebuild { build } => self.rebuild(&build)?,
            Command::Physics { values } => self.set_physics(&values)?,
            Command::Run {} => self.run(),
            Command::Stop {} => self.stop(),
            Command::Step { steps } => self.step(steps)?,
            Command::Restart {} => {
                self.stop();
                self.forget();
                self.play.restart()?;
            }
            Command::Speed { factor } => self.set_speed(factor)?,
            Command::Show { worlds } => self.show(&worlds)?,
            Command::Joint {
                dof,
                position,
                stiffness,
                velocity,
                damping,
            } => self.set_drive(dof as usize, [position, stiffness, velocity, damping])?,
            Command::Control { actuator, value } => self.set_control(actuator as usize, value)?,
            Command::Grab {
                world,
                body,
                point,
                to,
            } => {
                let (world, body, point) = self.moving_point(world, body, point)?;
                let to = finite("the point to draw to", to)?;
                let grab = Grab {
                    world,
                    body,
                    point,
                    to,
                };
                self.grab = Some(grab);
            }
            Command::Release {} => self.grab = None,
            Command::Push {
                world,
                body,
                point,
                impulse,
            } => {
                let (world, body, point) = self.moving_point(world, body, point)?;
                let impulse = finite("impulse", impulse)?;
                count("pushes that wait", self.pushes.len() + 1, [0, MOST_PUSHES])?;
                self.pushes.push(Push {
                    world,
                    body,
                    point,
                    impulse,
                });
            }
            Command::Plot { quantities } => self.plot(&quantities)?,
            Command::Scrub { time } => self.scrub(time)?,
        }
        Ok(())
    }

    fn open(&mut self, play: Play) {
        self.stop();
        self.play = play;
        self.opened();
    }
    /// Forgets what belongs to another state: blows that wait, and samples.
    fn forget(&mut self) {
        self.pushes.clear();
        self.samples.clear();
    }
    /// Begins with what is simulated now.
    fn opened(&mut self) {
        self.scenes += 1;
        (self.grab, self.owed) = (None, 0.0);
        self.forget();
        let shown = self.play.stage.shown.clamp(1, MOST_SHOWN);
        self.shown = (0..shown.min(self.play.worlds())).collect();
        self.plots = self.play.first_plots().collect();
        let scene = self.scene();
        self.outbox
            .push_back(text(&Message::Scene(Box::new(scene))));
        self.stale = true;
    }
    fn rebuild(&mut self, build: &Values) -> Result<(), SessionError> {
        let Some(example) = self.play.example else {
            return Err(SessionError::Field {
                name: build.keys().next().cloned().unwrap_or_default(),
                known: "none: this is a file, which is built as it is".into(),
            });
        };
        let form = self.play.build.clone().with(build)?;
        // What the page has changed stays; what follows from the model follows the new one.
        let was = Physics::new(&self.play.stage);
        let kept = self.play.physics.fields().iter().zip(was.fields());
        let changed = kept.filter(|(now, was)| now.value != was.value);
        let physics: Values = changed
            .map(|(now, _)| (now.name.clone(), now.value))
            .collect();
        self.open(Play::of_example(example, form, &physics)?);
        Ok(())
    }

    fn set_physics(&mut self, values: &Values) -> Result<(), SessionError> {
        let physics = self.play.physics.clone().with(values)?;
        let mut parts = self.play.parts.clone();
        physics.change(&mut parts);
        if !self.play.change(parts, physics)? {
            self.stop();
            self.opened();
        }
        Ok(())
    }

    fn run(&mut self) {
        self.running = true;
        self.owed = 0.0;
        self.looked = (self.clock)();
        self.play.history.branch(self.play.steps);
    }
    /// Whether it goes on by itself, or has steps to make.
    fn busy(&self) -> bool {
        self.running || self.owed >= 1.0
    }
    fn stop(&mut self) {
        (self.running, self.owed) = (false, 0.0);
    }
    fn step(&mut self, steps: u32) -> Result<(), SessionError> {
        within("steps", f64::from(steps), 1.0, f64::from(MOST_STEPS))?;
        self.running = false;
        self.owed = f64::from(steps);
        self.play.history.branch(self.play.steps);
        Ok(())
    }
    fn set_speed(&mut self, factor: Option<f64>) -> Result<(), SessionError> {
        if let Some(factor) = factor {
            within("speed", factor, 0.001, 1000.0)?;
        }
        self.speed = factor;
        if self.running {
            self.owed = 0.0;
        }
        Ok(())
    }
    fn show(&mut self, worlds: &[u32]) -> Result<(), SessionError> {
        count("worlds to show", worlds.len(), [1, MOST_SHOWN])?;
        let all = self.play.worlds();
        let worlds = worlds.iter().map(|&w| row("world", w as usize, all));
        self.shown = worlds.collect::<Result<_, _>>()?;
        self.samples.clear();
        Ok(())
    }
    fn plot(&mut self, rows: &[u32]) -> Result<(), SessionError> {
        count("quantities to plot", rows.len(), [0, MOST_PLOTS])?;
        let all = self.play.measures.len();
        let plots = rows.iter().map(|&i| row("quantity", i as usize, all));
        self.plots = plots.collect::<Result<_, _>>()?;
        self.samples.clear();
        Ok(())
    }

    /// Sets target position, stiffness, target velocity and damping of a drive, where given.
    fn set_drive(&mut self, dof: usize, values: [Option<f64>; 4]) -> Result<(), SessionError> {
        let model = self.play.model().clone();
        row("degree of freedom", dof, model.degrees_of_freedom())?;
        let joints = (0..model.joints.len()).map(JointId);
        let mut holds = joints
            .filter(|&id| !model.joints[id.0].closes_loop && model.dof_range(id).contains(&dof));
        let id = holds.next().expect("a degree of freedom is a joint's");
        let mut parts = self.play.parts.clone();
        let joint = &mut parts.joints[id.0];
        let own = &mut joint.dofs[dof - model.dof_range(id).start];
        if joint.kind == JointKind::Free {
            return Err(SessionError::Undriven {
                dof: own.name.clone(),
            });
        }
        let [position, stiffness, velocity, damping] = values;
        let drive = &mut own.drive;
        let gains = (drive.stiffness, drive.damping);
        drive.target_position = position.unwrap_or(drive.target_position);
        drive.stiffness = stiffness.unwrap_or(drive.stiffness);
        drive.target_velocity = velocity.unwrap_or(drive.target_velocity);
        drive.damping = damping.unwrap_or(drive.damping);
        let drive = *drive;
        within("target position", drive.target_position, -1e9, 1e9)?;
        within("target velocity", drive.target_velocity, -1e9, 1e9)?;
        within("stiffness", drive.stiffness, 0.0, STIFFEST)?;
        within("damping", drive.damping, 0.0, STIFFEST)?;
        if gains == (drive.stiffness, drive.damping) {
            self.play.parts = parts;
            return Ok(self.play.aim()?);
        }
        let physics = self.play.physics.clone();
        if !self.play.change(parts, physics)? {
            self.stop();
            self.opened();
        }
        Ok(())
    }

    fn set_control(&mut self, actuator: usize, value: f64) -> Result<(), SessionError> {
        let model = self.play.model().clone();
        row("actuator", actuator, model.actuators.len())?;
        let (lower, upper) = control_range(&model.actuators[actuator]);
        within(&model.actuators[actuator].name, value, lower, upper)?;
        self.play.control[actuator] = Some(value);
        Ok(self.play.aim()?)
    }

    fn moving_point(
        &self,
        world: u32,
        body: u32,
        point: [f64; 3],
    ) -> Result<(usize, BodyId, DVec3), SessionError> {
        let world = row("world", world as usize, self.play.worlds())?;
        let bodies = &self.play.model().bodies;
        let body = row("body", body as usize, bodies.len())?;
        if bodies[body].kind == BodyKind::Static {
            return Err(SessionError::Immovable {
                body: bodies[body].name.clone(),
            });
        }
        Ok((world, BodyId(body), finite("point", point)?))
    }

    fn scrub(&mut self, time: f64) -> Result<(), SessionError> {
        within("time", time, 0.0, f64::MAX)?;
        self.stop();
        self.forget();
        let steps = (time / self.play.time_step()).round() as u64;
        if let Some(moment) = self.play.history.nearest(steps) {
            self.play.simulation.restore(&moment.snapshot)?;
            self.play.steps = moment.steps;
        }
        Ok(self.play.aim()?)
    }

    /// Steps as the clock and the page say, for a hundredth of a second at most, and makes frames.
    /// To be called again and again; true where there is more to do at once.
    pub fn advance(&mut self) -> bool {
        let now = (self.clock)();
        let elapsed = (now - self.looked).clamp(0.0, 0.1);
        self.looked = now;
        if self.running {
            let steps = self
                .speed
                .map(|speed| speed * elapsed / self.play.time_step());
            self.owed = steps.map_or(f64::INFINITY, |steps| self.owed + steps);
        }
        let behind = self.owed >= 1.0;
        if behind {
            if let Err(error) = self.work(now) {
                self.stop();
                let failure = Message::Error {
                    message: error.to_string(),
                    refused: None,
                };
                self.outbox.push_back(text(&failure));
            }
            self.stale = true;
        }
        let now = (self.clock)();
        if self.running {
            // What is not done in time is not made up for: the simulation is slower than asked.
            self.owed = self.owed.min(1.0_f64.max(self.owed.fract()));
        }
        self.report(now, behind);
        behind && self.owed >= 1.0
    }

    /// Makes steps that are owed, until the slice of time is over.
    fn work(&mut self, start: f64) -> Result<(), SessionError> {
        let mut most = 1;
        loop {
            let before = (self.clock)();
            let steps = self.uninterrupted(most);
            let pulled = self.pulled();
            let ready = self
                .pull(&pulled)
                .and(self.play.wander().map_err(Into::into));
            if ready.is_ok() {
                self.play.simulation.step(steps as usize);
            }
            self.let_go(&pulled)?;
            ready?;
            self.play.steps += steps;
            self.owed -= steps as f64;
            self.pace.steps += steps;
            if self.play.history.due(self.play.steps) == 0 {
                self.play.record();
            }
            if self.until_sample() == self.sample_every() {
                self.sample();
            }
            let now = (self.clock)();
            self.pace.computing += now - before;
            if self.owed < 1.0 || now - start > SLICE {
                return Ok(());
            }
            if now - before < 0.1 * SLICE {
                most = (2 * most).min(MOST_AT_ONCE);
            }
        }
    }

    /// How many of the steps owed can be made at once, at most so many.
    fn uninterrupted(&self, most: u64) -> u64 {
        if self.grab.is_some() || !self.pushes.is_empty() || self.play.stage.wander > 0.0 {
            return 1;
        }
        let due = self.play.history.due(self.play.steps).max(1);
        let due = due.min(self.until_sample());
        most.min(due).min(self.owed as u64).max(1)
    }

    /// Time steps from one sample to the next.
    fn sample_every(&self) -> u64 {
        ((SAMPLE / self.play.time_step()).round() as u64).max(1)
    }
    /// Time steps from now to the next sample.
    fn until_sample(&self) -> u64 {
        let every = self.sample_every();
        every - self.play.steps % every
    }
    fn sample(&mut self) {
        if self.samples.len() == MOST_SAMPLES {
            self.samples.pop_front();
        }
        let values = self.play.measure(&self.plots, self.shown[0]);
        self.samples.push_back((self.play.time(), values));
    }

    /// Worlds in which a hand or a blow acts in the next step.
    fn pulled(&self) -> Vec<usize> {
        let mut worlds: Vec<_> = self.pushes.iter().map(|p| p.world).collect();
        worlds.extend(self.grab.map(|g| g.world));
        worlds.sort_unstable();
        worlds.dedup();
        worlds
    }

    /// Sets the forces of hand and blows on these worlds for the next step.
    fn pull(&mut self, worlds: &[usize]) -> Result<(), SessionError> {
        let pushes = std::mem::take(&mut self.pushes);
        let model = self.play.simulation.model().clone();
        let h = self.play.time_step();
        for &world in worlds {
            let mut forces = vec![0.0; model.degrees_of_freedom()];
            let outputs = self.play.simulation.outputs();
            let mut add = |body, point, force| {
                add_force(&model, &outputs, (world, body, point), force, &mut forces);
            };
            if let Some(g) = self.grab.filter(|g| g.world == world) {
                add(g.body, g.point, g.force(&model, &outputs, h));
            }
            for p in pushes.iter().filter(|p| p.world == world) {
                add(p.body, p.point, p.impulse / h);
            }
            self.play.simulation.controls().set_force(world, &forces)?;
        }
        Ok(())
    }

    /// No force from outside on these worlds any more.
    fn let_go(&mut self, worlds: &[usize]) -> Result<(), SessionError> {
        let none = vec![0.0; self.play.simulation.model().degrees_of_freedom()];
        for &world in worlds {
            self.play.simulation.controls().set_force(world, &none)?;
        }
        Ok(())
    }

    /// Sends a frame and a status, if it is time.
    fn report(&mut self, now: f64, stepped: bool) {
        let [frame, status] = &mut self.sent;
        let done = stepped && !self.running && self.owed < 1.0;
        let tell = done || (self.running && now - *status >= STATUS);
        if self.stale && (done || now - *frame >= FRAME) {
            *frame = now;
            if tell {
                *status = now;
            }
            self.stale = false;
            let mut frame = self.frame();
            self.add_samples(&mut frame);
            self.outbox.push_back(Outgoing::Frame(frame.to_bytes()));
        } else if tell {
            *status = now;
        }
        if tell {
            self.measure_pace(now);
            let status = Message::Status(self.status());
            self.outbox.push_back(text(&status));
        }
    }

    fn measure_pace(&mut self, now: f64) {
        let p = &mut self.pace;
        let simulated = p.steps as f64 * self.play.time_step();
        p.pace = simulated / (now - p.since).max(1e-9);
        let steps = p.steps as f64 * self.play.worlds() as f64;
        p.rate = steps / p.computing.max(1e-9);
        (p.steps, p.computing, p.since) = (0, 0.0, now);
    }

    fn status(&self) -> Status {
        let play = &self.play;
        let diverged = play.simulation.diverged().iter().map(|d| d.world as u32);
        let seconds = |steps: u64| steps as f64 * play.time_step();
        Status {
            running: self.busy(),
            time: play.time(),
            steps: play.steps,
            speed: self.speed,
            pace: if self.running { self.pace.pace } else { 0.0 },
            rate: self.pace.rate,
            diverged: diverged.collect(),
            shown: self.shown.iter().map(|&w| w as u32).collect(),
            plots: self.plots.iter().map(|&i| i as u32).collect(),
            recorded: play.history.range().map(seconds),
        }
    }

    /// The present state, of the worlds that are shown.
    pub fn frame(&mut self) -> Frame {
        let mut frame = self.play.frame(&self.shown, &self.plots);
        (frame.scene, frame.number, frame.running) = (self.scenes, self.frames, self.busy());
        self.frames = self.frames.wrapping_add(1);
        frame
    }

    /// Moves the samples since the last frame into this one.
    fn add_samples(&mut self, frame: &mut Frame) {
        for (time, values) in self.samples.drain(..) {
            if time < frame.time && values.len() == frame.plots.len() {
                frame.past.push((frame.time - time) as f32);
                frame.past.extend(values);
            }
        }
    }

    fn scene(&mut self) -> Scene {
        Scene {
            id: self.scenes,
            shown: self.shown.iter().map(|&w| w as u32).collect(),
            ..self.play.scene()
        }
    }
}

fn text(message: &Message) -> Outgoing {
    Outgoing::Text(json(message))
}

fn json(message: &Message) -> String {
    serde_json::to_string(message).expect("messages have names for keys")
}

fn finite(name: &str, numbers: [f64; 3]) -> Result<DVec3, SessionError> {
    for number in numbers {
        within(name, number, -1e9, 1e9)?;
    }
    Ok(DVec3::from_array(numbers))
}

fn count(what: &'static str, count: usize, [least, most]: [usize; 2]) -> Result<(), SessionError> {
    if (least..=most).contains(&count) {
        return Ok(());
    }
    Err(SessionError::Count {
        what,
        least,
        most,
        count,
    })
}
