//! What pages ask of a simulation, and what they are told of it.

use crate::batch::Batch;
use crate::card::Card;
use crate::error::{SessionError, count, row, within};
use crate::form::Form;
use crate::frame::Frame;
use crate::gallery::{EXAMPLES, Example};
use crate::hands::{Hands, Subject};
use crate::physics::Physics;
use crate::play::{Numbers, Origin, Play, keeper, steps, time_step};
use crate::protocol::{self, Command, Message, PROTOCOL, Scene, Status, Values};
use crate::pull::{Grab, Push};
use crate::session::Outgoing;
use crate::stage::Stage;
use crate::wardrobe::Wardrobe;
use glam::DVec3;
use model::{BodyId, BodyKind, JointId, JointKind, Parts};
use numbers::Float;
use sim::{Simulation, SimulationError};
use std::collections::VecDeque;
use std::sync::Arc;

/// Share of a slice of time that steps made at once may take.
const AT_ONCE: f64 = 0.25;
/// What they may take on a graphics card [s].
const ON_CARD: f64 = 0.075;
/// Largest stiffness and damping of a drive, in SI units.
const STIFFEST: f64 = 1e9;
/// Largest control of an actuator that has no range, in its own unit.
const STRONGEST: f64 = 1e9;
/// From one frame to the next [s].
const FRAME: f64 = 1.0 / 60.0;
/// Share of a program's time that pages may take to see what it does.
const WATCHING: f64 = 0.1;
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

/// All of a session but its subject, which is handed in.
#[derive(Debug)]
pub(crate) struct Steering {
    clock: fn() -> f64,
    /// Longest stretch of computing at once [s].
    slice: f64,
    /// What the session began with, if that was no example; and its name among them.
    own: Option<(String, Stage)>,
    play: Play,
    shown: Vec<usize>,
    /// Controls of the first world shown, as pages know them.
    known: Numbers,
    /// Rows of the quantities that are plotted.
    plots: Vec<usize>,
    /// Samples of the plotted quantities since the last frame: when [s], and what.
    samples: VecDeque<(f64, Vec<f32>)>,
    running: bool,
    /// Simulated seconds a second of the clock.
    speed: Option<f64>,
    /// Time steps to be made; fractions of one while running.
    owed: f64,
    batch: Batch,
    /// When the session last looked at the clock.
    looked: f64,
    /// When the next frame may be made, and when the last status was sent [s].
    next_frame: f64,
    told: f64,
    pace: Pace,
    scenes: u32,
    frames: u32,
    /// How often other worlds were chosen to be shown.
    choices: u32,
    /// Whether something has changed since the last frame.
    stale: bool,
    /// How often the program had taken its simulation when it was last looked at.
    changes: u64,
    /// Whether it has done so since the last status.
    untold: bool,
    /// What it has cost since the last frame to look at what the program does [s].
    watching: f64,
    pub wardrobe: Arc<Wardrobe>,
    /// What was worn when the last frame was begun.
    dressed: u64,
    pub outbox: VecDeque<Outgoing>,
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

impl Steering {
    pub fn new<T: Float>(
        play: Play,
        simulation: &mut Simulation<T>,
        slice: f64,
        clock: fn() -> f64,
    ) -> Self {
        let now = clock();
        let wardrobe = Wardrobe::new(0, &play.name, simulation.model());
        let mut steering = Self {
            clock,
            slice,
            own: match play.origin {
                Origin::File => Some((play.name.clone(), play.stage.clone())),
                Origin::Example(_) | Origin::Program(_) => None,
            },
            play,
            shown: Vec::new(),
            known: controls(simulation, 0),
            plots: Vec::new(),
            samples: VecDeque::new(),
            running: false,
            speed: Some(1.0),
            owed: 0.0,
            batch: Batch::default(),
            looked: now,
            next_frame: f64::NEG_INFINITY,
            told: f64::NEG_INFINITY,
            pace: Pace::default(),
            scenes: 0,
            frames: 0,
            choices: 0,
            stale: true,
            changes: 0,
            untold: false,
            watching: 0.0,
            wardrobe: Arc::new(wardrobe),
            dressed: 0,
            outbox: VecDeque::new(),
        };
        steering.begin(simulation);
        // Who comes is greeted with a frame.
        steering.stale = false;
        steering
    }

    /// Has pages choose a card.
    pub fn offer<T: Float>(&mut self, card: &Card<T>) {
        self.play.physics = Physics::new(&self.play.stage, card);
    }

    /// What a page that comes now must know.
    pub fn greeting<T: Float>(
        &mut self,
        subject: &mut Subject<T>,
    ) -> ([Message; 3], Option<Frame>) {
        let frame = self.frame(subject);
        let simulation = &mut subject.simulation;
        let examples = match self.play.origin {
            Origin::Program(_) => Vec::new(),
            Origin::Example(_) | Origin::File => self.gallery(),
        };
        let welcome = Message::Welcome {
            protocol: PROTOCOL,
            examples,
        };
        let scene = Message::Scene(Box::new(self.scene(simulation)));
        let status = Message::Status(self.status(simulation));
        ([welcome, scene, status], frame)
    }

    /// What pages can open: what the session began with, if that was no example, and the examples.
    fn gallery(&self) -> Vec<protocol::Example> {
        let own = self.own.iter().map(|(name, stage)| protocol::Example {
            name: name.clone(),
            title: stage.model.name.clone(),
            about: "What this page was opened with.".into(),
            guide: String::new(),
            build: Vec::new(),
        });
        own.chain(EXAMPLES.iter().map(Example::describe)).collect()
    }

    /// Does what a page says; what is refused is answered.
    pub fn receive<T: Float>(&mut self, subject: &mut Subject<T>, command: &str) {
        let kind = |command: &Command| {
            let value = serde_json::to_value(command).ok()?;
            Some(value.get("type")?.as_str()?.to_owned())
        };
        let read = serde_json::from_str(command).map_err(|e| SessionError::Command {
            reason: e.to_string(),
        });
        let asked = read.as_ref().ok().and_then(kind);
        let news = read.as_ref().ok().filter(|command| command.sets()).cloned();
        match read.and_then(|command| self.perform(subject, command)) {
            Ok(()) => {
                self.stale = true;
                self.tell_status(&subject.simulation);
                match news {
                    Some(command) => self.tell_others(&mut subject.simulation, command),
                    None => self.tell_controls(&mut subject.simulation),
                }
            }
            Err(error) => {
                // A card that has failed is found out by the next frame.
                self.stale |= error.is_of_card();
                let refusal = Message::Error {
                    message: error.to_string(),
                    refused: asked,
                };
                self.outbox.push_back(Outgoing::Refusal(refusal.to_json()));
            }
        }
    }
    /// Tells all pages what nobody has asked for.
    fn tell(&mut self, message: String) {
        let refused = None;
        let message = Message::Error { message, refused };
        self.outbox.push_back(Outgoing::text(&message));
    }
    /// Values of the physics, but for a card that is missing, which pages are told.
    fn settled<T: Float>(&mut self, card: &Card<T>, mut values: Values) -> Values {
        if let Some(reason) = card.settle(&mut values) {
            self.tell(format!(
                "It runs on the processor, not on a graphics card: {reason}"
            ));
        }
        values
    }

    fn perform<T: Float>(
        &mut self,
        subject: &mut Subject<T>,
        command: Command,
    ) -> Result<(), SessionError> {
        let Subject {
            simulation,
            hands,
            card,
        } = subject;
        match command {
            Command::Open {
                example,
                build,
                physics,
            } => {
                self.play.not_of_program("what is simulated")?;
                let own = self.own.as_ref().filter(|(name, _)| *name == example);
                let opened = if let Some(stage) = own.map(|(_, stage)| stage.clone()) {
                    Form::new(Vec::new()).with(&build)?;
                    let physics = self.settled(card, physics);
                    Play::of_model(stage, &physics, card)?
                } else {
                    let example = Example::find(&example)?;
                    let form = example.form().with(&build)?;
                    let physics = self.settled(card, physics);
                    Play::of_example(example, form, &physics, card)?
                };
                self.open(subject, opened);
            }
            Command::File { name, text } => {
                self.play.not_of_program("what is simulated")?;
                let opened = Play::of_file(&name, &text, card)?;
                self.open(subject, opened);
            }
            Command::Rebuild { build } => self.rebuild(subject, &build)?,
            Command::Physics { values } => {
                let values = self.settled(card, values);
                self.set_physics(subject, &values)?;
            }
            Command::Run {} => self.run(),
            Command::Stop {} => self.stop(),
            Command::Step { steps } => self.step(steps)?,
            Command::Restart {} => {
                self.stop();
                self.samples.clear();
                hands.forget();
                self.play.restart(simulation, &self.shown)?;
            }
            Command::Speed { factor } => self.set_speed(factor)?,
            Command::Show { worlds } => self.show(simulation, &worlds)?,
            Command::Joint {
                dof,
                position,
                stiffness,
                velocity,
                damping,
            } => {
                let values = [position, stiffness, velocity, damping];
                self.set_drive(subject, dof as usize, values)?;
            }
            Command::Control { actuator, value } => {
                self.set_control(simulation, actuator as usize, value)?;
            }
            Command::Grab {
                world,
                body,
                point,
                to,
            } => {
                let (world, body, point) = moving_point(simulation, world, body, point)?;
                let to = finite("the point to draw to", to)?;
                hands.grab = Some(Grab {
                    world,
                    body,
                    point,
                    to,
                });
            }
            Command::Release {} => hands.grab = None,
            Command::Push {
                world,
                body,
                point,
                impulse,
            } => {
                let (world, body, point) = moving_point(simulation, world, body, point)?;
                let impulse = finite("impulse", impulse)?;
                hands.push(Push {
                    world,
                    body,
                    point,
                    impulse,
                })?;
            }
            Command::Plot { quantities } => self.plot(&quantities)?,
            Command::Scrub { time } => self.scrub(subject, time)?,
        }
        Ok(())
    }

    fn open<T: Float>(&mut self, subject: &mut Subject<T>, (play, made): (Play, Simulation<T>)) {
        self.stop();
        (self.play, subject.simulation) = (play, made);
        self.opened(subject);
    }
    /// Begins with what is simulated now.
    fn begin<T: Float>(&mut self, simulation: &mut Simulation<T>) {
        self.scenes += 1;
        self.wardrobe
            .open(self.scenes, &self.play.name, simulation.model());
        self.owed = 0.0;
        self.batch = Batch::default();
        self.samples.clear();
        let shown = self.play.stage.shown.clamp(1, MOST_SHOWN);
        self.shown = (0..shown.min(simulation.worlds())).collect();
        self.known = controls(simulation, self.shown[0]);
        self.plots = self.play.first_plots().collect();
        self.stale = true;
    }
    /// Begins with it, and tells pages of it.
    fn opened<T: Float>(&mut self, subject: &mut Subject<T>) {
        subject.hands = Hands::default();
        self.begin(&mut subject.simulation);
        let scene = Message::Scene(Box::new(self.scene(&mut subject.simulation)));
        self.outbox.push_back(Outgoing::text(&scene));
    }
    fn rebuild<T: Float>(
        &mut self,
        subject: &mut Subject<T>,
        build: &Values,
    ) -> Result<(), SessionError> {
        self.play.not_of_program("its model")?;
        let Origin::Example(example) = self.play.origin else {
            return Err(SessionError::Field {
                name: build.keys().next().cloned().unwrap_or_default(),
                known: "none: this is a file, which is built as it is".into(),
            });
        };
        let form = self.play.build.clone().with(build)?;
        // What the page has changed stays; what follows from the model follows the new one.
        let was = Physics::new(&self.play.stage, &subject.card);
        let kept = self.play.physics.fields().iter().zip(was.fields());
        let changed = kept.filter(|(now, was)| now.value != was.value);
        let physics: Values = changed
            .map(|(now, _)| (now.name.clone(), now.value))
            .collect();
        let opened = Play::of_example(example, form, &physics, &subject.card)?;
        self.open(subject, opened);
        Ok(())
    }

    fn set_physics<T: Float>(
        &mut self,
        subject: &mut Subject<T>,
        values: &Values,
    ) -> Result<(), SessionError> {
        self.play.not_of_program("its physics")?;
        let physics = self.play.physics.clone().with(values)?;
        let mut parts = self.play.parts.clone();
        physics.change(&mut parts);
        self.change(subject, parts, physics)
    }
    /// Goes on with other numbers of the model or the settings, or starts again with them.
    fn change<T: Float>(
        &mut self,
        subject: &mut Subject<T>,
        parts: Parts,
        physics: Physics,
    ) -> Result<(), SessionError> {
        if !self.play.change(subject, parts, physics)? {
            self.stop();
            self.opened(subject);
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
    fn show<T: Float>(
        &mut self,
        simulation: &mut Simulation<T>,
        worlds: &[u32],
    ) -> Result<(), SessionError> {
        count("worlds to show", worlds.len(), [1, MOST_SHOWN])?;
        let all = simulation.worlds();
        let worlds = worlds.iter().map(|&w| row("world", w as usize, all));
        let shown: Vec<_> = worlds.collect::<Result<_, _>>()?;
        self.play.go_by(simulation, &shown)?;
        self.shown = shown;
        self.choices = self.choices.wrapping_add(1);
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
    fn set_drive<T: Float>(
        &mut self,
        subject: &mut Subject<T>,
        dof: usize,
        [position, stiffness, velocity, damping]: [Option<f64>; 4],
    ) -> Result<(), SessionError> {
        let model = subject.simulation.model().clone();
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
        let drive = &mut own.drive;
        let gains = (drive.stiffness, drive.damping);
        drive.stiffness = stiffness.unwrap_or(drive.stiffness);
        drive.damping = damping.unwrap_or(drive.damping);
        let stays = gains == (drive.stiffness, drive.damping);
        within("stiffness", drive.stiffness, 0.0, STIFFEST)?;
        within("damping", drive.damping, 0.0, STIFFEST)?;
        for (name, target) in [("target position", position), ("target velocity", velocity)] {
            within(name, target.unwrap_or(0.0), -1e9, 1e9)?;
        }
        if !stays {
            self.play.not_of_program("stiffness and damping")?;
        }
        let before = self.play.targets[dof];
        self.play.targets[dof] = [position.or(before[0]), velocity.or(before[1])];
        if stays {
            return Ok(self.play.aim_drive(&mut subject.simulation, dof)?);
        }
        let changed = self.change(subject, parts, self.play.physics.clone());
        if changed.is_err() {
            self.play.targets[dof] = before;
        }
        changed
    }

    fn set_control<T: Float>(
        &mut self,
        simulation: &mut Simulation<T>,
        actuator: usize,
        value: f64,
    ) -> Result<(), SessionError> {
        let model = simulation.model().clone();
        row("actuator", actuator, model.actuators.len())?;
        let own = &model.actuators[actuator];
        let (lower, upper) = own.control_range.unwrap_or((-STRONGEST, STRONGEST));
        within(&own.name, value, lower, upper)?;
        self.play.control[actuator] = Some(value);
        Ok(self.play.aim_actuator(simulation, actuator)?)
    }

    fn scrub<T: Float>(&mut self, subject: &mut Subject<T>, time: f64) -> Result<(), SessionError> {
        within("time", time, 0.0, f64::MAX)?;
        self.stop();
        self.samples.clear();
        subject.hands.forget();
        let simulation = &mut subject.simulation;
        let steps = (time / time_step(simulation)).round() as u64;
        if let Some(moment) = self.play.history.nearest(steps) {
            simulation.restore(&moment.snapshot)?;
            self.play.steps = moment.steps;
        }
        Ok(self.play.aim(simulation)?)
    }

    /// Whether there is anything to do, after a program has taken its simulation so often.
    pub fn wants(&mut self, changes: u64) -> bool {
        let dressed = self.wardrobe.revision();
        // News of skins go with frames.
        self.stale |= dressed != self.dressed;
        self.dressed = dressed;
        if self.busy() {
            return true;
        }
        let now = (self.clock)();
        let news = self.stale || changes != self.changes;
        (news && now >= self.next_frame) || (self.untold && now - self.told >= STATUS)
    }

    /// Takes over what a program has done to its simulation, which it has taken so often.
    pub fn notice<T: Float>(&mut self, simulation: &mut Simulation<T>, changes: u64) {
        if changes == self.changes {
            return;
        }
        let start = (self.clock)();
        (self.changes, self.stale, self.untold) = (changes, true, true);
        let keeper = keeper(simulation, &self.shown);
        let steps = steps(simulation, keeper);
        let back = steps < self.play.steps;
        if steps != self.play.steps {
            self.samples.clear();
        }
        if keeper != self.play.keeper {
            // Where a device fails, the frame that follows tells.
            let _ = self.play.go_by(simulation, &self.shown);
        } else if steps != self.play.steps {
            self.play.steps = steps;
            self.play.history.branch(steps);
        }
        if self.play.history.due(steps) == 0 {
            // Where a device fails, the frame that follows tells.
            let _ = self.play.record(simulation);
        }
        if back {
            self.tell_status(simulation);
        }
        self.watching += (self.clock)() - start;
    }

    /// Makes the steps that are owed, for a slice of time at most, and frames. True where there is more to do
    /// at once.
    pub fn advance<T: Float>(&mut self, subject: &mut Subject<T>) -> bool {
        let now = (self.clock)();
        let elapsed = (now - self.looked).clamp(0.0, 0.1);
        self.looked = now;
        if self.running {
            let steps = self
                .speed
                .map(|speed| speed * elapsed / time_step(&subject.simulation));
            self.owed = steps.map_or(f64::INFINITY, |steps| self.owed + steps);
        }
        let behind = self.owed >= 1.0;
        if behind {
            if let Err(error) = self.work(subject, now) {
                self.fail(subject, &error);
            }
            self.stale = true;
        }
        let now = (self.clock)();
        if self.running {
            // What is not done in time is not made up for: the simulation is slower than asked.
            self.owed = self.owed.min(1.0_f64.max(self.owed.fract()));
        }
        self.report(subject, now, behind);
        behind && self.owed >= 1.0
    }

    /// Stops, and tells why. Where a card has failed, all that it held is lost, and the processor goes on from a
    /// recorded state; the simulation of a program is the program's to mend.
    fn fail<T: Float>(&mut self, subject: &mut Subject<T>, error: &SessionError) {
        self.stop();
        let mends = error.is_of_card() && self.play.not_of_program("").is_ok();
        if !mends {
            return self.tell(error.to_string());
        }
        match self.play.leave_card(&mut subject.simulation) {
            Ok(values) => {
                self.samples.clear();
                subject.hands = Hands::default();
                let time = self.play.time(&subject.simulation);
                self.tell(format!(
                    "{error}. The processor has taken over, at {time:.3} s"
                ));
                let commands = vec![Command::Physics { values }];
                self.outbox
                    .push_back(Outgoing::text(&Message::Changed { commands }));
                self.tell_status(&subject.simulation);
            }
            Err(next) => self.tell(format!("{error}. The processor cannot take over: {next}")),
        }
    }

    /// Makes steps that are owed, until the slice of time is over.
    fn work<T: Float>(&mut self, subject: &mut Subject<T>, start: f64) -> Result<(), SessionError> {
        let most = match subject.simulation.device() {
            Some(_) => ON_CARD,
            None => AT_ONCE * self.slice,
        };
        loop {
            let before = (self.clock)();
            let simulation = &mut subject.simulation;
            let (play, h) = (&mut self.play, time_step(simulation));
            let until = play.wander.steer(simulation, play.steps, &play.control)?;
            let at_once = if subject.hands.rest() {
                self.batch.steps
            } else {
                1
            };
            let steps = self.uninterrupted(at_once.min(until), h);
            subject.step(steps as usize)?;
            let simulation = &mut subject.simulation;
            self.play.steps += steps;
            self.owed -= steps as f64;
            self.pace.steps += steps;
            if self.play.history.due(self.play.steps) == 0 {
                self.play.record(simulation)?;
            }
            if self
                .play
                .steps
                .is_multiple_of(sample_every(time_step(simulation)))
            {
                self.sample(simulation)?;
            }
            let now = (self.clock)();
            self.pace.computing += now - before;
            self.batch.took(steps, now - before, most);
            if self.owed < 1.0 || now - start > self.slice {
                return Ok(());
            }
        }
    }

    /// How many of the steps owed can be made at once, at most so many.
    fn uninterrupted(&self, most: u64, time_step: f64) -> u64 {
        let due = self.play.history.due(self.play.steps).max(1);
        let every = sample_every(time_step);
        let due = due.min(every - self.play.steps % every);
        most.min(due).min(self.owed as u64).max(1)
    }

    fn sample<T: Float>(&mut self, simulation: &mut Simulation<T>) -> Result<(), SessionError> {
        if self.samples.len() == MOST_SAMPLES {
            self.samples.pop_front();
        }
        let shown = self.shown[0];
        let values = self.play.measure(simulation, &self.plots, shown)?;
        self.samples.push_back((self.play.time(simulation), values));
        Ok(())
    }

    /// Sends a frame and a status, if it is time.
    fn report<T: Float>(&mut self, subject: &mut Subject<T>, now: f64, stepped: bool) {
        let done = stepped && !self.running && self.owed < 1.0;
        let tell = done || ((self.running || self.untold) && now - self.told >= STATUS);
        if self.stale && (done || now >= self.next_frame) {
            self.stale = false;
            if let Some(mut frame) = self.frame(subject) {
                self.add_samples(&mut frame);
                self.outbox.push_back(Outgoing::Frame(frame.to_bytes()));
            }
            self.next_frame = now + self.rest(now);
        }
        let simulation = &mut subject.simulation;
        if tell {
            (self.told, self.untold) = (now, false);
            self.measure_pace(simulation, now);
            self.tell_status(simulation);
            self.tell_controls(simulation);
        }
    }

    /// From a frame, begun at `start`, to the next [s].
    fn rest(&mut self, start: f64) -> f64 {
        if !matches!(self.play.origin, Origin::Program(_)) {
            return FRAME;
        }
        let cost = std::mem::take(&mut self.watching) + (self.clock)() - start;
        FRAME.max(cost / WATCHING)
    }

    fn measure_pace<T: Float>(&mut self, simulation: &Simulation<T>, now: f64) {
        let p = &mut self.pace;
        let simulated = p.steps as f64 * time_step(simulation);
        p.pace = simulated / (now - p.since).max(1e-9);
        let steps = p.steps as f64 * simulation.worlds() as f64;
        p.rate = steps / p.computing.max(1e-9);
        (p.steps, p.computing, p.since) = (0, 0.0, now);
    }

    fn tell_status<T: Float>(&mut self, simulation: &Simulation<T>) {
        let status = Message::Status(self.status(simulation));
        self.outbox.push_back(Outgoing::text(&status));
    }
    /// Tells all other pages what one has said.
    fn tell_others<T: Float>(&mut self, simulation: &mut Simulation<T>, command: Command) {
        let now = controls(simulation, self.shown[0]);
        self.known.take(&command, &now);
        let commands = vec![command];
        let news = Message::Changed { commands }.to_json();
        self.outbox.push_back(Outgoing::News(news));
    }
    /// Tells all pages of controls that none of them has set.
    fn tell_controls<T: Float>(&mut self, simulation: &mut Simulation<T>) {
        let now = controls(simulation, self.shown[0]);
        let commands = now.beside(&self.known);
        if !commands.is_empty() {
            self.known = now;
            let news = Message::Changed { commands };
            self.outbox.push_back(Outgoing::text(&news));
        }
    }
    fn status<T: Float>(&self, simulation: &Simulation<T>) -> Status {
        let play = &self.play;
        let diverged = simulation.diverged().iter().map(|d| d.world as u32);
        let seconds = |steps: u64| steps as f64 * time_step(simulation);
        Status {
            running: self.busy(),
            card: simulation.device().map(str::to_owned),
            time: play.time(simulation),
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

    /// The present state, of the worlds that are shown; where a card fails, that which the processor goes on from,
    /// and none where it cannot.
    pub fn frame<T: Float>(&mut self, subject: &mut Subject<T>) -> Option<Frame> {
        let present = self.present(subject).or_else(|error| {
            self.fail(subject, &error.into());
            self.present(subject)
        });
        let mut frame = present.ok()?;
        (frame.scene, frame.number, frame.running) = (self.scenes, self.frames, self.busy());
        frame.choices = self.choices;
        self.frames = self.frames.wrapping_add(1);
        Some(frame)
    }

    fn present<T: Float>(&self, subject: &mut Subject<T>) -> Result<Frame, SimulationError> {
        let simulation = &mut subject.simulation;
        self.play.frame(simulation, &self.shown, &self.plots)
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

    fn scene<T: Float>(&mut self, simulation: &mut Simulation<T>) -> Scene {
        Scene {
            id: self.scenes,
            shown: self.shown.iter().map(|&w| w as u32).collect(),
            ..self.play.scene(simulation, self.shown[0])
        }
    }
}

/// Controls of a world that is shown.
fn controls<T: Float>(simulation: &mut Simulation<T>, world: usize) -> Numbers {
    Numbers::of(simulation, world).expect("the worlds shown are there")
}

/// A point [m] of a body that can move, in its frame.
fn moving_point<T: Float>(
    simulation: &Simulation<T>,
    world: u32,
    body: u32,
    point: [f64; 3],
) -> Result<(usize, BodyId, DVec3), SessionError> {
    let world = row("world", world as usize, simulation.worlds())?;
    let bodies = &simulation.model().bodies;
    let body = row("body", body as usize, bodies.len())?;
    if bodies[body].kind == BodyKind::Static {
        return Err(SessionError::Immovable {
            body: bodies[body].name.clone(),
        });
    }
    Ok((world, BodyId(body), finite("point", point)?))
}

/// Time steps from one sample to the next, of a time step [s].
fn sample_every(time_step: f64) -> u64 {
    ((SAMPLE / time_step).round() as u64).max(1)
}

fn finite(name: &str, numbers: [f64; 3]) -> Result<DVec3, SessionError> {
    for number in numbers {
        within(name, number, -1e9, 1e9)?;
    }
    Ok(DVec3::from_array(numbers))
}
