//! Sessions that run on a card: one that interprets the records of the kernels, world after world, and that fails
//! when it is told to.

use kinetarium_session::protocol::{Command, Message, Scene, Status};
use kinetarium_session::{Outgoing, Session, Shared};
use numbers::trace::Program;
use numbers::{Cpu, Memory};
use records::Programs;
use rigid::{Report, Solver};
use sim::{Device, DeviceError, DeviceWorlds, Processor, Simulation, SimulationSettings};
use std::cell::Cell;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

thread_local! {
    static NOW: Cell<f64> = const { Cell::new(0.0) };
}

/// A clock that goes by a millisecond whenever somebody looks at it.
fn clock() -> f64 {
    NOW.with(|now| {
        now.set(now.get() + 1e-3);
        now.get()
    })
}

#[derive(Clone, Default)]
struct Interpreter(Arc<AtomicBool>);

impl Interpreter {
    fn check(&self) -> Result<(), DeviceError> {
        if self.0.load(Relaxed) {
            return Err(DeviceError::new("the interpreter is lost"));
        }
        Ok(())
    }
}

struct Worlds {
    device: Interpreter,
    programs: Programs,
    parameters: Vec<f32>,
    /// Of each world: state, input, output.
    worlds: Vec<[Vec<f32>; 3]>,
}

impl Device<f32> for Interpreter {
    fn name(&self) -> String {
        "interpreter".into()
    }
    fn place(
        &self,
        solver: Solver<'_>,
        worlds: usize,
    ) -> Result<Box<dyn DeviceWorlds<f32>>, DeviceError> {
        self.check()?;
        let programs = Programs::record(solver).map_err(DeviceError::new)?;
        let l = programs.lengths;
        let world = [l.state, l.input, l.output].map(|length| vec![0.0; length]);
        Ok(Box::new(Worlds {
            device: self.clone(),
            parameters: programs.parameters.iter().map(|x| *x as f32).collect(),
            programs,
            worlds: vec![world; worlds],
        }))
    }
}

impl Worlds {
    fn run(&mut self, program: impl Fn(&Programs) -> &Program) -> Result<(), DeviceError> {
        self.device.check()?;
        let mut scratch = vec![0.0; self.programs.lengths.scratch];
        for [state, input, output] in &mut self.worlds {
            let mut machine = Cpu {
                state,
                input,
                output,
                scratch: &mut scratch,
                parameters: numbers::Shared(&self.parameters),
                links: &self.programs.links,
            };
            let run = program(&self.programs).interpret(&mut machine);
            run.map_err(DeviceError::new)?;
        }
        Ok(())
    }
    fn write(&mut self, kind: usize, rows: Range<usize>, memory: &Memory<f32>) {
        for (world, memories) in self.worlds.iter_mut().enumerate() {
            let numbers = memories[kind].iter_mut().enumerate();
            for (row, number) in numbers.filter(|(row, _)| rows.contains(row)) {
                *number = memory.get(world, row);
            }
        }
    }
    fn read(
        &self,
        kind: usize,
        rows: &[Range<usize>],
        memory: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        for (world, memories) in self.worlds.iter().enumerate() {
            for row in rows.iter().cloned().flatten() {
                memory.set(world, row, memories[kind][row]);
            }
        }
        self.device.check()
    }
}

impl DeviceWorlds<f32> for Worlds {
    fn write_state(&mut self, state: &Memory<f32>) -> Result<(), DeviceError> {
        self.write(0, 0..state.length(), state);
        self.device.check()
    }
    fn write_worlds(&mut self, worlds: &[usize], state: &Memory<f32>) -> Result<(), DeviceError> {
        for &world in worlds {
            for (row, number) in self.worlds[world][0].iter_mut().enumerate() {
                *number = state.get(world, row);
            }
        }
        self.device.check()
    }
    fn write_input(&mut self, rows: Range<usize>, input: &Memory<f32>) -> Result<(), DeviceError> {
        self.write(1, rows, input);
        self.device.check()
    }
    fn write_parameters(&mut self, _: &[usize], _: &Memory<f32>) -> Result<(), DeviceError> {
        Err(DeviceError::new("all worlds are alike here"))
    }
    fn step(&mut self, substeps: usize, _: &mut Processor<'_, f32>) -> Result<(), DeviceError> {
        (0..substeps).try_for_each(|_| self.run(|programs| &programs.step))
    }
    fn report(&mut self, report: Report) -> Result<(), DeviceError> {
        self.run(|programs| programs.report(report))
    }
    fn read_state(
        &mut self,
        rows: &[Range<usize>],
        state: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        self.read(0, rows, state)
    }
    fn read_output(
        &mut self,
        rows: &[Range<usize>],
        output: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        self.read(2, rows, output)
    }
}

/// A session, and what its page was told last.
struct Page {
    session: Session,
    scene: Option<Scene>,
    status: Option<Status>,
    errors: Vec<String>,
    changed: Vec<Command>,
}

impl Page {
    fn new(session: Session) -> Self {
        Self {
            session,
            scene: None,
            status: None,
            errors: Vec::new(),
            changed: Vec::new(),
        }
    }
    fn without() -> Self {
        Self::new(Session::gallery(clock).unwrap())
    }
    fn with(card: &Interpreter) -> Self {
        let session = Session::gallery(clock).unwrap();
        Self::new(session.with_card(Ok(Arc::new(card.clone()))))
    }
    fn listen(&mut self) {
        while let Some(outgoing) = self.session.outgoing() {
            let (Outgoing::Text(text) | Outgoing::Refusal(text)) = outgoing else {
                continue;
            };
            match serde_json::from_str(&text).unwrap() {
                Message::Scene(scene) => self.scene = Some(*scene),
                Message::Status(status) => self.status = Some(status),
                Message::Error { message, .. } => self.errors.push(message),
                Message::Changed { commands } => self.changed.extend(commands),
                Message::Welcome { .. } | Message::SkinFile(_) | Message::Dress { .. } => {}
            }
        }
    }
    fn say(&mut self, command: &str) {
        self.session.receive(command);
        self.listen();
    }
    fn does(&mut self, command: &str) {
        self.say(command);
        assert!(self.errors.is_empty(), "{command}: {:?}", self.errors);
    }
    fn open(&mut self, example: &str, runs_on: u32) {
        self.does(&format!(
            r#"{{"type": "open", "example": "{example}", "physics": {{"runs_on": {runs_on}}}}}"#
        ));
    }
    fn step(&mut self, steps: u32) {
        self.does(&format!(r#"{{"type": "step", "steps": {steps}}}"#));
        while self.session.advance() {}
        self.listen();
    }
    fn poses(&mut self) -> Vec<f32> {
        let poses = self.session.frame().poses;
        self.listen();
        poses
    }
    fn card(&self) -> Option<&str> {
        self.status.as_ref().unwrap().card.as_deref()
    }
    fn runs_on(&self) -> f64 {
        let fields = &self.scene.as_ref().unwrap().physics;
        fields.iter().find(|f| f.name == "runs_on").unwrap().value
    }
}

const TO_CARD: &str = r#"{"type": "physics", "values": {"runs_on": 1}}"#;
const TO_PROCESSOR: &str = r#"{"type": "physics", "values": {"runs_on": 0}}"#;

/// An interpreted record does the same as the kernel, to the bit.
#[test]
fn a_session_on_a_card_goes_as_one_on_the_processor() {
    let card = Interpreter::default();
    let (mut here, mut there) = (Page::without(), Page::with(&card));
    here.does(r#"{"type": "open", "example": "pendula"}"#);
    there.open("pendula", 1);
    assert_eq!((there.card(), there.runs_on()), (Some("interpreter"), 1.0));
    let both = |command: &str, pages: &mut [&mut Page; 2]| {
        for page in pages.iter_mut() {
            page.does(command);
            page.step(7);
        }
        let [here, there] = pages;
        assert_eq!(here.poses(), there.poses(), "after {command}");
    };
    let mut pages = [&mut here, &mut there];
    for command in [
        r#"{"type": "show", "worlds": [3, 1]}"#,
        r#"{"type": "grab", "world": 1, "body": 1, "point": [0, 0.1, 0], "to": [0.5, 1, 0]}"#,
        r#"{"type": "release"}"#,
        r#"{"type": "push", "world": 3, "body": 0, "point": [0, 0, 0], "impulse": [0.1, 0, 0]}"#,
        r#"{"type": "joint", "dof": 0, "position": 0.3, "stiffness": 20}"#,
        r#"{"type": "plot", "quantities": [0, 3]}"#,
        r#"{"type": "physics", "values": {"gravity": 1.62}}"#,
        r#"{"type": "scrub", "time": 0.01}"#,
        r#"{"type": "rebuild", "build": {"links": 5}}"#,
        r#"{"type": "restart"}"#,
    ] {
        both(command, &mut pages);
    }
    assert_eq!((there.card(), there.runs_on()), (Some("interpreter"), 1.0));
}

#[test]
fn the_state_moves_to_a_card_and_back() {
    let card = Interpreter::default();
    let (mut here, mut moving) = (Page::without(), Page::with(&card));
    here.does(r#"{"type": "open", "example": "pendula"}"#);
    moving.open("pendula", 0);
    for place in [TO_CARD, TO_PROCESSOR, TO_CARD] {
        moving.does(place);
        for page in [&mut here, &mut moving] {
            page.step(5);
        }
        assert_eq!(here.poses(), moving.poses());
        assert_eq!(moving.card().is_some(), place == TO_CARD);
    }
}

#[test]
fn a_card_that_fails_is_let_go_and_the_processor_goes_on_from_a_recorded_state() {
    let card = Interpreter::default();
    let mut page = Page::with(&card);
    page.open("pendula", 1);
    page.step(100);
    let recorded = page.status.as_ref().unwrap().recorded[1];
    page.does(&format!(r#"{{"type": "scrub", "time": {recorded}}}"#));
    let then = page.poses();
    page.does(r#"{"type": "step", "steps": 10}"#);
    card.0.store(true, Relaxed);
    while page.session.advance() {}
    page.listen();
    let [error] = &page.errors[..] else {
        panic!("{:?}", page.errors)
    };
    assert!(error.contains("the interpreter is lost"), "{error}");
    assert!(error.contains("The processor has taken over"), "{error}");
    page.errors.clear();
    assert_eq!(page.card(), None);
    assert_eq!(page.poses(), then);
    let Some(Command::Physics { values }) = page.changed.last() else {
        panic!("{:?}", page.changed)
    };
    // The solver that ran, so that the state fits.
    assert_eq!((values["runs_on"], values["solver"]), (0.0, 1.0));
    page.step(10);
    assert_ne!(page.poses(), then);
    // The lost card is refused, and all is as before.
    page.say(TO_CARD);
    assert!(page.errors.pop().unwrap().contains("is lost"));
    assert_eq!(page.card(), None);
    card.0.store(false, Relaxed);
    page.does(TO_CARD);
    page.step(10);
    assert_eq!(page.card(), Some("interpreter"));
}

/// However the session finds out.
#[test]
fn a_card_that_fails_between_steps_is_let_go() {
    let find_out: [fn(&mut Page); 4] = [
        |page| drop(page.session.greeting()),
        |page| drop(page.poses()),
        |page| page.say(TO_PROCESSOR),
        |page| page.say(r#"{"type": "joint", "dof": 0, "stiffness": 20}"#),
    ];
    for find_out in find_out {
        let card = Interpreter::default();
        let mut page = Page::with(&card);
        page.open("pendula", 1);
        page.step(10);
        page.does(
            r#"{"type": "push", "world": 0, "body": 0, "point": [0, 0, 0], "impulse": [1, 0, 0]}"#,
        );
        page.step(1);
        page.does(r#"{"type": "restart"}"#);
        card.0.store(true, Relaxed);
        find_out(&mut page);
        // From one frame to the next.
        for _ in 0..20 {
            page.session.advance();
        }
        page.listen();
        assert_eq!(page.card(), None);
        page.errors.clear();
        page.step(10);
        assert_eq!(page.status.as_ref().unwrap().steps, 10);
    }
}

#[test]
fn what_a_card_cannot_run_is_refused() {
    let mut page = Page::with(&Interpreter::default());
    page.open("prismatic", 1);
    page.step(3);
    let before = page.poses();
    page.say(r#"{"type": "physics", "values": {"solver": 3}}"#);
    let error = page.errors.pop().unwrap();
    assert!(
        error.contains("impulse") && error.contains("featherstone"),
        "{error}"
    );
    assert_eq!(page.poses(), before);
    assert_eq!(page.card(), Some("interpreter"));
}

#[test]
fn where_there_is_no_card_the_processor_runs_and_pages_are_told_why() {
    let session = Session::gallery(clock).unwrap();
    let mut page = Page::new(session.with_card(Err("this browser has no WebGPU".into())));
    let open =
        r#"{"type": "open", "example": "pendula", "physics": {"runs_on": 1, "gravity": 1.62}}"#;
    page.say(open);
    let told = page.errors.pop().unwrap();
    assert!(told.contains("runs on the processor") && told.contains("no WebGPU"));
    let scene = page.scene.clone().unwrap();
    let field = |name: &str| scene.physics.iter().find(|f| f.name == name).unwrap();
    assert_eq!(field("gravity").value, 1.62);
    assert_eq!(field("runs_on").value, 0.0);
    let note = field("runs_on").note.as_ref().unwrap();
    assert_eq!(note, "No graphics card: this browser has no WebGPU");
    page.say(TO_CARD);
    assert!(page.errors.pop().unwrap().contains("no WebGPU"));
    assert_eq!(page.card(), None);
    // Where nobody has said anything about cards, pages are not asked.
    let mut page = Page::without();
    page.does(r#"{"type": "open", "example": "pendula"}"#);
    let physics = page.scene.unwrap().physics;
    assert!(physics.iter().all(|field| field.name != "runs_on"));
}

/// The simulation of a program is the program's to mend.
#[test]
fn pages_of_a_program_are_told_of_its_card_that_fails() {
    let card = Interpreter::default();
    let model = model::examples::n_pendula(2).unwrap();
    let settings = SimulationSettings::new(2, 0.002);
    let shared = Shared::new(Simulation::on(&card, model, settings).unwrap());
    let mut page = Page::new(Session::of_program(&shared, clock));
    page.step(3);
    assert_eq!(page.card(), Some("interpreter"));
    let shown = page.poses();
    assert!(!shown.is_empty());
    card.0.store(true, Relaxed);
    page.say(r#"{"type": "step", "steps": 3}"#);
    while page.session.advance() {}
    page.listen();
    assert!(page.errors.iter().all(|e| e == "the interpreter is lost"));
    assert!(!page.errors.is_empty());
    assert!(page.poses().is_empty());
    card.0.store(false, Relaxed);
    page.errors.clear();
    assert_eq!(page.poses(), shown);
}
