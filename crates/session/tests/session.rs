//! Sessions as a page sees them.

use kinetarium_session::frame::{CONTACT, HEADER};
use kinetarium_session::protocol::{Command, Geometry, Message, Scene, Status, Values};
use kinetarium_session::{EXAMPLES, Outgoing, Session, Shared, Stage};
use model::Model;
use model::examples::{self, Start};
use sim::{Simulation, SimulationSettings};
use std::cell::Cell;
use std::sync::Arc;

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

/// A session, and what it has said last.
struct Page {
    session: Session,
    scene: Option<Scene>,
    status: Option<Status>,
    frame: Vec<u8>,
    /// When [s], and the first plotted quantity.
    samples: Vec<(f64, f64)>,
    errors: Vec<String>,
    /// What other pages would be told.
    news: Vec<String>,
    /// What somebody else has set.
    changed: Vec<Command>,
}

impl Page {
    fn open(example: &str) -> Self {
        let mut page = Self::of(Session::gallery(clock).unwrap());
        page.say(&format!(r#"{{"type": "open", "example": "{example}"}}"#));
        assert!(page.errors.is_empty(), "{:?}", page.errors);
        page
    }
    fn of(session: Session) -> Self {
        Self {
            session,
            scene: None,
            status: None,
            frame: Vec::new(),
            samples: Vec::new(),
            errors: Vec::new(),
            news: Vec::new(),
            changed: Vec::new(),
        }
    }
    fn listen(&mut self) {
        while let Some(outgoing) = self.session.outgoing() {
            let text = match outgoing {
                Outgoing::Frame(frame) => {
                    self.frame = frame;
                    self.take_samples();
                    continue;
                }
                Outgoing::Text(text) | Outgoing::Refusal(text) => text,
                Outgoing::News(text) => {
                    self.news.push(text);
                    continue;
                }
            };
            match serde_json::from_str(&text).unwrap() {
                Message::Scene(scene) => self.scene = Some(*scene),
                Message::Status(status) => self.status = Some(status),
                Message::Error { message, .. } => self.errors.push(message),
                Message::Changed { commands } => self.changed.extend(commands),
                Message::Welcome { examples, .. } => assert_eq!(examples.len(), EXAMPLES.len()),
                Message::SkinFile(_) | Message::Dress { .. } => panic!("no program dresses"),
            }
        }
    }
    fn take_samples(&mut self) {
        let [plots, samples] = [48, 56].map(|at| self.word(at));
        let time = f64::from_le_bytes(self.frame[16..24].try_into().unwrap());
        let past = self.frame.len() - 4 * (1 + plots) * samples;
        for at in (0..samples).map(|i| past + 4 * (1 + plots) * i) {
            self.samples
                .push((time - self.number(at), self.number(at + 4)));
        }
        let particles = 12 * self.word(52);
        self.samples
            .push((time, self.number(past - particles - 4 * plots)));
    }
    fn say(&mut self, command: &str) {
        self.session.receive(command);
        self.listen();
    }
    fn step(&mut self, steps: u32) {
        self.say(&format!(r#"{{"type": "step", "steps": {steps}}}"#));
        while self.session.advance() {}
        self.listen();
    }
    fn run(&mut self, rounds: usize) {
        self.say(r#"{"type": "run"}"#);
        for _ in 0..rounds {
            self.session.advance();
        }
        self.listen();
    }
    fn status(&self) -> &Status {
        self.status.as_ref().unwrap()
    }
    fn scene(&self) -> &Scene {
        self.scene.as_ref().unwrap()
    }
    fn word(&self, at: usize) -> usize {
        u32::from_le_bytes(self.frame[at..at + 4].try_into().unwrap()) as usize
    }
    fn number(&self, at: usize) -> f64 {
        f32::from_bits(self.word(at) as u32).into()
    }
    /// Position of a body of the first world shown [m].
    fn position(&self, body: usize) -> [f64; 3] {
        [0, 1, 2].map(|i| self.number(HEADER + 4 * (7 * body + i)))
    }
    /// A coordinate of the first world shown.
    fn coordinate(&self, i: usize) -> f64 {
        let poses = 7 * self.word(28) * self.word(32);
        self.number(HEADER + 4 * (poses + CONTACT * self.word(36) + i))
    }
    fn body(&self, name: &str) -> usize {
        let bodies = &self.scene().bodies;
        bodies.iter().position(|body| body.name == name).unwrap()
    }
    /// Refuses a command with a message that holds these words, and goes on as before.
    fn refuses(&mut self, command: &str, words: &str) {
        let before = (self.session.frame().poses, self.status.clone());
        self.say(command);
        let error = self
            .errors
            .pop()
            .unwrap_or_else(|| panic!("{command} was done"));
        assert!(error.contains(words), "{command}: {error}");
        assert_eq!(before.0, self.session.frame().poses);
        assert_eq!(before.1, self.status);
    }
}

#[test]
fn every_example_steps_and_no_world_diverges() {
    for example in &EXAMPLES {
        let mut page = Page::open(example.name);
        page.step(100);
        let status = page.status();
        assert_eq!(
            (status.steps, status.running),
            (100, false),
            "{}",
            example.name
        );
        assert!(status.diverged.is_empty(), "{}", example.name);
        let numbers = page.frame[HEADER..].chunks_exact(4);
        let mut numbers = numbers.map(|b| f32::from_le_bytes(b.try_into().unwrap()));
        assert!(numbers.all(f32::is_finite), "{}", example.name);
    }
}

#[test]
fn many_steps_at_once_bring_samples_of_what_is_plotted() {
    let mut page = Page::open("prismatic");
    page.samples.clear();
    page.step(1000);
    // Sixty a second of 2 s, and the frames themselves.
    let samples = &page.samples;
    assert!((120..=140).contains(&samples.len()), "{}", samples.len());
    let gaps = samples.windows(2).map(|pair| pair[1].0 - pair[0].0);
    assert!(
        gaps.into_iter().all(|gap| (1e-4..0.034).contains(&gap)),
        "{samples:?}"
    );
    // The carriage overshoots its target of 0.5 m, and comes to rest there.
    let most = samples.iter().map(|s| s.1).fold(f64::MIN, f64::max);
    let last = samples.last().unwrap().1;
    assert!(most > 0.7 && (last - 0.5).abs() < 0.1, "{most}, {last}");
}

#[test]
fn a_run_keeps_pace_with_the_clock() {
    let mut page = Page::open("pendula");
    page.run(10);
    let (start, steps) = (clock(), page.status().time);
    page.run(400);
    page.say(r#"{"type": "stop"}"#);
    let (passed, simulated) = (clock() - start, page.status().time - steps);
    assert!(
        (simulated / passed - 1.0).abs() < 0.05,
        "{simulated} s in {passed} s"
    );
    assert!(!page.status().running);
}

#[test]
fn half_speed_is_half_as_fast() {
    let mut page = Page::open("prismatic");
    page.say(r#"{"type": "speed", "factor": 0.5}"#);
    let start = clock();
    page.run(400);
    page.say(r#"{"type": "stop"}"#);
    let pace = page.status().time / (clock() - start);
    assert!((pace - 0.5).abs() < 0.03, "{pace}");
}

#[test]
fn restart_returns_to_the_same_bits() {
    let mut page = Page::open("ragdolls");
    let start = page.session.frame().poses;
    page.step(200);
    let once = page.session.frame().poses;
    page.say(r#"{"type": "restart"}"#);
    assert_eq!(page.session.frame().poses, start);
    page.step(200);
    assert_eq!(page.session.frame().poses, once);
    assert_ne!(start, once);
}

#[test]
fn scrubbing_returns_to_the_past_to_the_bit_and_runs_on_from_there() {
    let mut page = Page::open("dominoes");
    let every = (1.0 / 30.0 / page.scene().time_step).round() as u32;
    page.step(3 * every);
    let then = page.session.frame().poses;
    let time = page.status().time;
    page.step(5 * every);
    let end = page.session.frame().poses;
    page.say(&format!(r#"{{"type": "scrub", "time": {time}}}"#));
    assert_eq!(page.session.frame().poses, then);
    assert_eq!(
        page.status().recorded[1],
        8.0 * f64::from(every) * page.scene().time_step
    );
    page.step(5 * every);
    assert_eq!(page.session.frame().poses, end);
}

/// The past stays where another simulation takes its states: counted in its own time steps.
#[test]
fn what_is_recorded_outlives_another_stiffness_gravity_and_time_step() {
    let mut page = Page::open("prismatic");
    let h = page.scene().time_step;
    let every = (1.0 / 30.0 / h).round() as u32;
    page.step(20 * every);
    let then = page.session.frame().poses;
    let time = page.status().time;
    page.step(20 * every);
    let recorded = page.status().recorded;
    for command in [
        r#"{"type": "joint", "dof": 0, "stiffness": 500, "damping": 60}"#.to_owned(),
        r#"{"type": "physics", "values": {"gravity": 1.62}}"#.to_owned(),
        format!(
            r#"{{"type": "physics", "values": {{"time_step": {}}}}}"#,
            0.5 * h
        ),
    ] {
        page.say(&command);
        assert_eq!(page.status().recorded, recorded, "{command}");
    }
    assert_eq!(page.status().steps, u64::from(80 * every));
    page.say(&format!(r#"{{"type": "scrub", "time": {time}}}"#));
    assert_eq!(page.session.frame().poses, then);
    page.step(100);
    assert!(page.status().recorded[1] < recorded[1]);
    // Another solver has other states.
    page.say(r#"{"type": "physics", "values": {"solver": 2}}"#);
    assert_eq!(page.status().recorded, [0.0, 0.0]);
}

#[test]
fn a_target_is_followed_and_stiffness_changes_without_a_jump() {
    let mut page = Page::open("prismatic");
    page.say(r#"{"type": "joint", "dof": 0, "position": -0.25}"#);
    page.step(5000);
    assert!(
        (page.coordinate(0) + 0.25).abs() < 1e-3,
        "{}",
        page.coordinate(0)
    );
    let before = page.position(0);
    page.say(r#"{"type": "joint", "dof": 0, "position": 0.4, "stiffness": 500, "damping": 60}"#);
    assert!(page.errors.is_empty(), "{:?}", page.errors);
    page.step(1);
    assert!((page.position(0)[0] - before[0]).abs() < 0.01);
    page.step(3000);
    assert!(
        (page.coordinate(0) - 0.4).abs() < 1e-3,
        "{}",
        page.coordinate(0)
    );
}

#[test]
fn a_rebuilt_chain_has_as_many_links_as_asked() {
    let mut page = Page::open("pendula");
    let first = page.scene().id;
    page.say(r#"{"type": "rebuild", "build": {"links": 7}}"#);
    assert_eq!(page.scene().bodies.len(), 7);
    assert_eq!(page.scene().id, first + 1);
    page.step(10);
    assert_eq!((page.word(4), page.word(32)), (first as usize + 1, 7));
}

#[test]
fn a_body_is_drawn_to_the_hand_and_falls_when_let_go() {
    let mut page = Page::open("humanoid");
    let torso = page.body("torso");
    let to = [0.0, 0.0, 1.6];
    page.say(&format!(
        r#"{{"type": "grab", "world": 0, "body": {torso}, "point": [0, 0, 0.2], "to": {to:?}}}"#
    ));
    page.step(2000);
    let height = page.position(torso)[2];
    // It hangs where the spring ω² M carries its weight: g/ω² = 68 mm below the hand.
    assert!(
        (height + 0.2 - (1.6 - 9.81 / 144.0)).abs() < 0.02,
        "{height}"
    );
    page.say(r#"{"type": "release"}"#);
    page.step(500);
    assert!(page.position(torso)[2] < height - 0.3);
}

#[test]
fn a_blow_gives_its_momentum() {
    let mut page = Page::open("billiards");
    let ball = page.body("oblique_hit");
    page.say(&format!(
        r#"{{"type": "push", "world": 0, "body": {ball}, "point": [0, 0, 0], "impulse": [0, 0, -0.1]}}"#
    ));
    let mass = page.scene().bodies[ball].mass;
    page.step(1);
    let start = page.position(ball)[2];
    page.step(100);
    let speed = (page.position(ball)[2] - start) / 0.1;
    assert!((speed + 0.1 / mass).abs() < 0.01 * 0.1 / mass, "{speed}");
}

#[test]
fn blows_that_wait_are_few_and_do_not_outlive_a_restart() {
    let mut page = Page::open("billiards");
    let push =
        r#"{"type": "push", "world": 0, "body": 0, "point": [0, 0, 0], "impulse": [0, 0, 1]}"#;
    for _ in 0..256 {
        page.say(push);
    }
    page.refuses(push, "pushes that wait");
    page.say(r#"{"type": "restart"}"#);
    page.step(10);
    let pushed = page.session.frame().poses;
    let mut calm = Page::open("billiards");
    calm.step(10);
    assert_eq!(pushed, calm.session.frame().poses);
}

#[test]
fn a_long_step_is_told_as_running_and_can_be_stopped() {
    let mut page = Page::open("grid");
    page.say(r#"{"type": "step", "steps": 100000}"#);
    assert!(page.status().running);
    page.session.advance();
    page.say(r#"{"type": "stop"}"#);
    assert!(!page.status().running && page.status().steps < 100_000);
}

#[test]
fn a_control_that_is_set_stays_among_random_ones() {
    let mut page = Page::open("grid");
    page.say(r#"{"type": "control", "actuator": 3, "value": 0.75}"#);
    page.step(200);
    page.say(r#"{"type": "physics", "values": {"solver": 2}}"#);
    assert_eq!(page.scene().actuators[3].value, 0.75);
}

/// Every example steps in three worlds, which set off at other velocities, as each of them alone, to the bit.
#[test]
fn every_example_steps_in_three_worlds_as_alone() {
    for example in &EXAMPLES {
        let stage = example.stage(&Values::new()).unwrap();
        let run = |speeds: &[f64]| {
            let stage = Stage {
                worlds: speeds.len(),
                perturb: 0.0,
                wander: 0.0,
                ..stage.clone()
            };
            let mut simulation = stage.simulation().unwrap();
            let place = simulation.outputs().joint_position(0);
            for (world, &speed) in speeds.iter().enumerate() {
                let velocity = vec![speed; stage.model.degrees_of_freedom()];
                simulation
                    .set_joint_state(world, &place, &velocity)
                    .unwrap();
            }
            stage.run(&mut simulation, 25).unwrap();
            assert!(simulation.diverged().is_empty(), "{}", example.name);
            let outputs = simulation.outputs();
            let state = |world| [outputs.joint_position(world), outputs.joint_velocity(world)];
            (0..speeds.len()).map(state).collect::<Vec<_>>()
        };
        let speeds = [0.05, 0.1, -0.1];
        for (together, speed) in run(&speeds).iter().zip(speeds) {
            assert_eq!(*together, run(&[speed])[0], "{} at {speed}", example.name);
        }
    }
}

/// A cart with a motor that names no range, and one that names one.
const MOTORS: &str = r#"<mujoco model="cart"><worldbody><body name="cart" pos="0 0 1">
  <joint name="x" type="slide" axis="1 0 0"/><geom type="box" size=".1 .1 .1"/></body></worldbody>
  <actuator><motor name="free" joint="x"/><motor name="held" joint="x" ctrlrange="-2 2"/></actuator></mujoco>"#;

#[test]
fn a_control_goes_as_far_as_its_actuator_takes_it() {
    let mut page = Page::open("tower");
    page.say(&file("cart.xml", MOTORS));
    let [free, held] = [0, 1].map(|i| &page.scene().actuators[i].slider);
    assert_eq!((free.unit.as_str(), free.strict), ("N", false));
    assert_eq!((held.min, held.max, held.strict), (-2.0, 2.0, true));
    page.refuses(
        r#"{"type": "control", "actuator": 1, "value": 2.5}"#,
        "from -2 to 2",
    );
    page.say(r#"{"type": "control", "actuator": 0, "value": 80}"#);
    assert!(page.errors.is_empty(), "{:?}", page.errors);
    // It weighs 8 kg: 80 N for a second are 5 m.
    page.step(500);
    let way = page.position(0)[0];
    assert!((way - 5.0).abs() < 0.05, "{way}");
}

#[test]
fn physics_changes_while_the_state_stays_or_the_scene_begins_anew() {
    let mut page = Page::open("tower");
    page.step(50);
    let before = page.session.frame().poses;
    page.say(r#"{"type": "physics", "values": {"gravity": 1.62}}"#);
    assert_eq!(page.session.frame().poses, before);
    let id = page.scene().id;
    page.say(r#"{"type": "physics", "values": {"solver": 2}}"#);
    assert_eq!(
        (page.scene().id, page.scene().solver.as_str()),
        (id + 1, "xpbd")
    );
    let gravity = page.scene().physics.iter().find(|f| f.name == "gravity");
    assert_eq!(gravity.unwrap().value, 1.62);
}

/// Pendula of `featherstone` are made for Runge–Kutta, which others do not have: the form says so.
#[test]
fn the_integrator_of_a_scene_is_told_and_can_be_changed() {
    let mut page = Page::open("pendula");
    let told = |page: &Page| {
        let fields = page.scene().physics.iter();
        let mut found = fields.filter(|field| field.name == "integrator");
        found.next().map(|field| field.value)
    };
    assert_eq!(told(&page), Some(3.0));
    page.step(100);
    let accurate = page.session.frame().poses;
    page.say(r#"{"type": "restart"}"#);
    page.say(r#"{"type": "physics", "values": {"integrator": 0}}"#);
    page.step(100);
    assert_ne!(page.session.frame().poses, accurate);
    page.say(r#"{"type": "physics", "values": {"solver": 2}}"#);
    assert_eq!(told(&page), None);
    page.say(r#"{"type": "physics", "values": {"solver": 1}}"#);
    assert_eq!(told(&page), Some(0.0));
    assert!(page.errors.is_empty(), "{:?}", page.errors);
}

#[test]
fn every_solver_takes_a_scene_that_wishes_for_an_integrator() {
    let mut page = Page::open("pendula");
    for (number, name) in (1..).zip(["featherstone", "xpbd", "impulse"]) {
        page.say(&format!(
            r#"{{"type": "physics", "values": {{"solver": {number}}}}}"#
        ));
        assert!(page.errors.is_empty(), "{:?}", page.errors);
        assert_eq!(page.scene().solver, name);
        page.step(10);
    }
}

#[test]
fn what_one_page_sets_is_news_to_others_unless_it_is_refused() {
    let mut page = Page::open("prismatic");
    for command in [
        r#"{"type":"physics","values":{"gravity":1.62}}"#,
        r#"{"type":"joint","dof":0,"position":0.25,"stiffness":null,"velocity":null,"damping":null}"#,
    ] {
        page.say(command);
        let news = page.news.pop().unwrap();
        assert_eq!(
            news,
            format!(r#"{{"type":"changed","commands":[{command}]}}"#)
        );
    }
    // What a page has set is told to nobody as set by somebody else.
    page.step(10);
    assert_eq!(page.changed, []);
    page.say(r#"{"type": "run"}"#);
    page.say(r#"{"type": "joint", "dof": 0, "stiffness": -1}"#);
    assert!(page.news.is_empty(), "{:?}", page.news);
}

/// A cart on springs in a file that has a light, too, of which not all is read.
const CART: &str = r#"<mujoco model="cart"><worldbody><light pos="0 0 3" specular="1 1 1"/><body name="cart" pos="0 0 1">
  <joint name="x" type="slide" axis="1 0 0" stiffness="10"/><geom type="box" size=".1 .1 .1"/>
</body></worldbody></mujoco>"#;

fn file(name: &str, text: &str) -> String {
    serde_json::json!({"type": "file", "name": name, "text": text}).to_string()
}

#[test]
fn a_robot_file_opens_and_what_it_cannot_say_is_told() {
    let mut page = Page::open("tower");
    page.say(&file("cart.xml", CART));
    let scene = page.scene();
    assert_eq!(
        (scene.name.as_str(), scene.title.as_str(), scene.up),
        ("cart.xml", "cart", 'z')
    );
    assert_eq!((scene.bodies.len(), scene.build.len()), (1, 0));
    assert_eq!((scene.lamps.len(), scene.sun), (1, -1));
    assert!(
        scene.guide.contains("cart.xml:1: <light>"),
        "{}",
        scene.guide
    );
    page.step(10);
    assert_eq!(page.word(24), 10);
    page.say(r#"{"type": "restart"}"#);
    assert_eq!(page.errors, [""; 0]);
    let meshes = CART.replace(
        "</mujoco>",
        r#"<asset><mesh name="m" file="m.obj"/></asset></mujoco>"#,
    );
    let meshes = meshes.replace(r#"type="box" size=".1 .1 .1""#, r#"type="mesh" mesh="m""#);
    page.refuses(
        &file("cart.xml", &meshes),
        "m.obj cannot be read (a page gives one file",
    );
    page.refuses(&file("cart.xml", "<mujoco><worldbody>"), "cart.xml");
    page.refuses(&file("notes.xml", "<notes/>"), "<mujoco>, URDF");
    assert_eq!(page.scene().name, "cart.xml");
}

/// A model that bears an example's name can be told from it.
#[test]
fn pages_return_to_the_model_that_they_were_opened_with() {
    let mut parts = examples::n_pendula(3).unwrap().into_parts();
    parts.name = "tower".into();
    let stage = Stage::new(Model::new(parts).unwrap());
    let mut page = Page::of(Session::of(stage, clock).unwrap());
    let greeting = page.session.greeting();
    let Outgoing::Text(welcome) = &greeting[0] else {
        panic!("{greeting:?}")
    };
    let Message::Welcome { examples, .. } = serde_json::from_str(welcome).unwrap() else {
        panic!("{welcome}")
    };
    assert_eq!(examples.len(), EXAMPLES.len() + 1);
    let own = &examples[0];
    assert_eq!((&*own.name, &*own.title), ("own_tower", "tower"));

    page.say(r#"{"type": "open", "example": "tower"}"#);
    assert!(page.scene().build.len() > 1);
    page.say(r#"{"type": "open", "example": "own_tower", "physics": {"gravity": 1.5}}"#);
    assert_eq!(page.errors, [""; 0]);
    let scene = page.scene();
    assert_eq!((&*scene.name, scene.bodies.len()), ("own_tower", 3));
    assert!(
        scene
            .physics
            .iter()
            .any(|field| field.name == "gravity" && field.value == 1.5)
    );
    page.say(r#"{"type": "open", "example": "own_tower", "build": {"links": 4}}"#);
    assert!(page.errors[0].contains("links"), "{:?}", page.errors);
}

/// As of one that is dropped on the page.
#[test]
fn what_of_a_file_was_left_out_is_told_wherever_it_comes_from() {
    let options = formats::Options::default();
    let files = formats::InMemory::default();
    let loaded = formats::parse(CART, "cart.xml", &files, &options).unwrap();
    let mut page = Page::of(Session::of(Stage::loaded(loaded), clock).unwrap());
    page.say(r#"{"type": "open", "example": "cart"}"#);
    let told = "Not supported, and left out:\ncart.xml:1: <light>";
    assert!(
        page.scene().guide.starts_with(told),
        "{}",
        page.scene().guide
    );
}

/// A mesh of one triangle.
const LEAF: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// Meshes that are only seen lie in other files, which are there.
#[test]
fn no_file_is_opened_that_a_dropped_one_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("leaf.obj");
    std::fs::write(&path, LEAF).unwrap();
    let path = path.to_str().unwrap();
    let leaf = format!(
        r#"<asset><mesh name="leaf" file="{path}"/></asset>
        <worldbody><geom type="mesh" mesh="leaf" contype="0" conaffinity="0"/>"#
    );
    let cart = CART.replace("<worldbody>", &leaf);
    let arm = format!(
        r#"<robot name="arm"><link name="base"/><link name="arm">
          <inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
          <visual><geometry><mesh filename="{path}"/></geometry></visual>
        </link>
        <joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/></joint></robot>"#
    );
    let told = format!(
        "a page gives one file; open it with `kinetarium view`, which finds others: {path}"
    );
    let mut page = Page::open("tower");
    // A geom of MJCF stays, out of sight; a visual of URDF does not.
    for (name, text, left) in [("cart.xml", cart, 1), ("arm.urdf", arm, 0)] {
        page.say(&file(name, &text));
        assert_eq!(page.errors, [""; 0]);
        let scene = page.scene();
        assert_eq!(scene.name, name);
        assert!(scene.guide.contains(&told), "{}", scene.guide);
        assert_eq!(scene.guide.matches(path).count(), 1, "{}", scene.guide);
        let mut meshes = 0;
        for shape in &scene.shapes {
            if let Geometry::Mesh { triangles, .. } = &shape.geometry {
                assert!(triangles.is_empty(), "{name}");
                meshes += 1;
            }
        }
        assert_eq!(meshes, left, "{name}");
    }
}

#[test]
fn a_mesh_of_a_file_is_seen_where_it_can_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("leaf.obj");
    std::fs::write(&path, LEAF).unwrap();
    let scene = |file: &std::path::Path| {
        let mut world = model::Builder::new("leaf");
        let file = file.to_str().unwrap().to_owned();
        let scale = glam::DVec3::splat(2.0);
        let leaf = model::Geometry::MeshFile { file, scale };
        let leaf = model::Shape::new(leaf).without_contact();
        world.object("leaf").scenery(leaf);
        let mut session = Session::of(Stage::new(world.build().unwrap()), clock).unwrap();
        let greeting = session.greeting();
        let Outgoing::Text(scene) = &greeting[1] else {
            panic!("{greeting:?}")
        };
        let Message::Scene(scene) = serde_json::from_str(scene).unwrap() else {
            panic!("{scene}")
        };
        scene.shapes[0].geometry.clone()
    };
    let seen = Geometry::Mesh {
        positions: vec![0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0],
        triangles: vec![0, 1, 2],
        flat: false,
    };
    assert_eq!(scene(&path), seen);
    let Geometry::Mesh { triangles, .. } = scene(&folder.path().join("none.obj")) else {
        panic!("no mesh")
    };
    assert!(triangles.is_empty());
}

/// Motors that nobody has set are moved by chance, and sliders with them, a few times a second.
#[test]
fn random_controls_are_told_and_those_that_are_set_are_not() {
    let mut page = Page::open("ant");
    page.say(r#"{"type": "rebuild", "build": {"wander": 1}}"#);
    page.say(r#"{"type": "control", "actuator": 3, "value": 0.5}"#);
    page.run(3000);
    let told = |actuator: u32| {
        let of = |command: &&Command| matches!(command, Command::Control { actuator: a, .. } if *a == actuator);
        page.changed.iter().filter(of).count()
    };
    assert_eq!(told(3), 0);
    let seconds = page.status().time;
    assert!(
        (4..=(4.0 * seconds) as usize + 2).contains(&told(2)),
        "{} in {seconds} s",
        told(2)
    );
}

#[test]
fn replicas_are_shown_as_asked() {
    let mut page = Page::open("grid");
    page.step(20);
    assert_eq!(page.word(28), 64);
    let bodies = page.word(32);
    let all = page.session.frame().poses;
    page.say(r#"{"type": "show", "worlds": [5]}"#);
    let one = page.session.frame().poses;
    assert_eq!(one, all[5 * 7 * bodies..6 * 7 * bodies]);
}

#[test]
fn what_makes_no_sense_is_refused_and_changes_nothing() {
    let mut page = Page::open("pendula");
    page.step(10);
    page.refuses("", "no command");
    page.refuses("[1, 2", "no command");
    page.refuses(r#"{"type": "fly"}"#, "unknown variant");
    page.refuses(r#"{"type": "run", "fast": 1}"#, "unknown field");
    page.refuses(
        r#"{"type": "open", "example": "moon"}"#,
        "no example `moon`",
    );
    page.refuses(
        r#"{"type": "rebuild", "build": {"links": 1e9}}"#,
        "from 1 to 30",
    );
    page.refuses(
        r#"{"type": "rebuild", "build": {"legs": 2}}"#,
        "no field `legs`",
    );
    page.refuses(r#"{"type": "step", "steps": 0}"#, "from 1 to 100000");
    page.refuses(r#"{"type": "step", "steps": -1}"#, "no command");
    page.refuses(r#"{"type": "speed", "factor": 0}"#, "from 0.001");
    page.refuses(r#"{"type": "show", "worlds": []}"#, "from 1 to 256");
    page.refuses(r#"{"type": "show", "worlds": [99]}"#, "no world 99");
    page.refuses(
        r#"{"type": "joint", "dof": 3, "position": 1}"#,
        "there are 3",
    );
    page.refuses(
        r#"{"type": "joint", "dof": 0, "position": 1e300}"#,
        "target position",
    );
    page.refuses(
        r#"{"type": "joint", "dof": 0, "stiffness": -1}"#,
        "stiffness",
    );
    page.refuses(
        r#"{"type": "joint", "dof": 0, "stiffness": 1e300}"#,
        "stiffness",
    );
    page.refuses(
        r#"{"type": "control", "actuator": 0, "value": 1}"#,
        "no actuator 0",
    );
    page.refuses(
        r#"{"type": "plot", "quantities": [9999]}"#,
        "no quantity 9999",
    );
    page.refuses(r#"{"type": "scrub", "time": -1}"#, "time");
    page.refuses(
        r#"{"type": "grab", "world": 0, "body": 7, "point": [0,0,0], "to": [0,0,0]}"#,
        "no body 7",
    );
    page.refuses(
        r#"{"type": "push", "world": 0, "body": 0, "point": [0,0,0], "impulse": [1e300,0,0]}"#,
        "impulse",
    );
    page.refuses(
        r#"{"type": "physics", "values": {"time_step": 0}}"#,
        "time_step",
    );
}

/// A program's simulation with its own forces and targets, and a session about it.
fn of_program(model: Model) -> (Arc<Shared<f64>>, Session<f64>) {
    let simulation = Simulation::new(model, SimulationSettings::new(2, 0.002)).unwrap();
    let shared = Shared::new(simulation);
    let session = Session::of_program(&shared, clock);
    (shared, session)
}

/// Says something that is not refused, and lets the session do it.
fn ask(session: &mut Session<f64>, command: &str) {
    session.receive(command);
    for _ in 0..100 {
        session.advance();
    }
    while let Some(outgoing) = session.outgoing() {
        assert!(!matches!(outgoing, Outgoing::Refusal(_)), "{outgoing:?}");
    }
}

fn refused(session: &mut Session<f64>, command: &str) -> String {
    session.receive(command);
    loop {
        match session.outgoing() {
            Some(Outgoing::Refusal(text)) => return text,
            Some(_) => {}
            None => panic!("{command} was done"),
        }
    }
}

#[test]
fn a_program_s_forces_and_targets_outlive_what_the_page_does() {
    let (shared, mut session) = of_program(examples::prismatic().unwrap());
    {
        let mut simulation = shared.change();
        simulation.controls().set_dof_force(0, 0, 0.25).unwrap();
        simulation.controls().set_target(1, 0, 0.125).unwrap();
    }
    let before = shared.read().controls().of_world(0).unwrap();
    ask(
        &mut session,
        r#"{"type": "grab", "world": 0, "body": 0, "point": [0, 0, 0], "to": [1, 0, 0]}"#,
    );
    ask(&mut session, r#"{"type": "step", "steps": 10}"#);
    assert_eq!(shared.read().controls().of_world(0).unwrap(), before);
    ask(&mut session, r#"{"type": "restart"}"#);
    assert_eq!(shared.read().time(0), 0.0);
    ask(
        &mut session,
        r#"{"type": "joint", "dof": 0, "position": 0.5}"#,
    );
    for world in 0..2 {
        assert_eq!(shared.read().controls().of_world(world).unwrap()[1], 0.5);
    }
}

/// A blow J on a ball of mass m, and nothing else along it: a speed J/m, in the program's steps, too.
#[test]
fn hands_act_while_the_program_steps() {
    let (shared, mut session) = of_program(examples::billiards().unwrap());
    let model = shared.read().model().clone();
    let ball = model.body("oblique_hit").unwrap();
    ask(
        &mut session,
        &format!(
            r#"{{"type": "push", "world": 1, "body": {}, "point": [0, 0, 0], "impulse": [0, 0, -0.1]}}"#,
            ball.0
        ),
    );
    shared.change().step(10);
    let speed = |world| shared.read().outputs().body_velocity(world, ball).z;
    let expected = -0.1 / model.bodies[ball.0].mass;
    assert!(
        (speed(1) - speed(0) - expected).abs() < 1e-3 * expected.abs(),
        "{}",
        speed(1)
    );
    let to = [0.0, 3.0, 0.0];
    ask(
        &mut session,
        &format!(
            r#"{{"type": "grab", "world": 0, "body": {}, "point": [0, 0, 0], "to": {to:?}}}"#,
            ball.0
        ),
    );
    shared.change().step(2000);
    // It hangs g/ω² = 68 mm below the hand.
    let height = shared.read().outputs().body_position(0, ball).y;
    assert!((height - (3.0 - 9.81 / 144.0)).abs() < 0.02, "{height}");
    session.release();
    shared.change().step(500);
    assert!(shared.read().outputs().body_position(0, ball).y < 2.0);
}

#[test]
fn what_the_page_has_not_set_of_a_program_s_simulation_stays_as_the_program_set_it_last() {
    let (shared, mut session) = of_program(examples::chain(2, Start::Horizontal).unwrap());
    shared.change().controls().set_target(0, 1, -0.5).unwrap();
    ask(
        &mut session,
        r#"{"type": "joint", "dof": 0, "position": 0.5}"#,
    );
    shared.change().controls().set_target(0, 0, 0.75).unwrap();
    ask(
        &mut session,
        r#"{"type": "joint", "dof": 1, "velocity": 2}"#,
    );
    let numbers = shared.read().controls().of_world(0).unwrap();
    assert_eq!(numbers[2..6], [0.75, -0.5, 0.0, 2.0]);
}

/// Pages follow what the program sets, in few messages, the last of which has the last word.
#[test]
fn what_the_program_sets_is_told() {
    let (shared, mut session) = of_program(examples::chain(2, Start::Horizontal).unwrap());
    let told = |session: &mut Session<f64>| {
        let mut told = Vec::new();
        while let Some(outgoing) = session.outgoing() {
            let Outgoing::Text(text) = outgoing else {
                continue;
            };
            if let Message::Changed { commands } = serde_json::from_str(&text).unwrap() {
                told.push(commands);
            }
        }
        told
    };
    ask(&mut session, r#"{"type": "stop"}"#);
    for i in 1..=1000 {
        let mut simulation = shared.change();
        simulation
            .controls()
            .set_target(0, 1, 1e-3 * f64::from(i))
            .unwrap();
        // Of a world that is not shown first.
        simulation
            .controls()
            .set_target(1, 0, 1e-3 * f64::from(i))
            .unwrap();
        drop(simulation);
        session.advance();
    }
    for _ in 0..300 {
        session.advance();
    }
    let all = told(&mut session);
    // The clock goes on by at least 1 ms a round.
    assert!((4..50).contains(&all.len()), "{}", all.len());
    let last = |position| Command::Joint {
        dof: 1,
        position: Some(position),
        stiffness: None,
        velocity: Some(0.0),
        damping: None,
    };
    assert_eq!(all.last().unwrap(), &[last(1.0)]);
    assert!(all.windows(2).all(|pair| pair[0] != pair[1]));
    // A page that sets something else meanwhile hears of both.
    shared.change().controls().set_target(0, 1, 2.0).unwrap();
    session.receive(r#"{"type": "joint", "dof": 0, "position": 0.5}"#);
    session.receive(r#"{"type": "show", "worlds": [0]}"#);
    assert_eq!(told(&mut session), [[last(2.0)]]);
    // Another world has other controls.
    session.receive(r#"{"type": "show", "worlds": [1]}"#);
    assert_eq!(told(&mut session), [[last(0.0)]]);
}

#[test]
fn a_program_s_steps_are_recorded_and_its_page_returns_to_them() {
    let (shared, mut session) = of_program(examples::chain(2, Start::Horizontal).unwrap());
    shared.change().step(7);
    let start = shared.read().snapshot();
    let mut session_of_later = Session::of_program(&shared, clock);
    let mut middle = None;
    for round in 0..10 {
        shared.change().step(50);
        ask(&mut session, r#"{"type": "release"}"#);
        if round == 4 {
            middle = Some(shared.read().snapshot());
        }
    }
    ask(&mut session, r#"{"type": "scrub", "time": 0.514}"#);
    assert_eq!(Some(shared.read().snapshot()), middle);
    // Restart returns to where the session found it.
    ask(&mut session_of_later, r#"{"type": "restart"}"#);
    assert_eq!(shared.read().snapshot(), start);
    assert_eq!(session_of_later.frame().steps, 7);
}

/// A program resets replicas one by one, and those that diverge stand still.
#[test]
fn pages_go_by_the_time_of_a_replica_that_is_shown_and_runs() {
    let (shared, mut session) = of_program(examples::chain(2, Start::Horizontal).unwrap());
    let steps_after = |session: &mut Session<f64>, command: &str| {
        ask(session, command);
        session.frame().steps
    };
    let nothing = r#"{"type": "release"}"#;
    let force = shared.change().controls().set_dof_force(0, 1, 1e30);
    force.unwrap();
    shared.change().step(100);
    assert_eq!(shared.read().diverged().len(), 1);
    assert_eq!(steps_after(&mut session, nothing), 100);
    shared.change().step(50);
    assert_eq!(steps_after(&mut session, nothing), 150);

    ask(&mut session, r#"{"type": "show", "worlds": [1]}"#);
    shared.change().reset(&[0]).unwrap();
    assert_eq!(steps_after(&mut session, nothing), 150);
    shared.change().step(50);
    assert_eq!(steps_after(&mut session, nothing), 200);
    // The past is still recorded.
    let back = r#"{"type": "scrub", "time": 0.3}"#;
    assert_eq!(steps_after(&mut session, back), 150);
    assert!((shared.read().time(1) - 0.3).abs() < 1e-9);

    // Another replica has another time, and no past by that.
    shared.change().reset(&[0]).unwrap();
    assert_eq!(steps_after(&mut session, nothing), 150);
    let other = r#"{"type": "show", "worlds": [0, 1]}"#;
    assert_eq!(steps_after(&mut session, other), 0);
    assert_eq!(steps_after(&mut session, back), 0);

    // Nor has the one that is asked from then on, as the first has diverged.
    shared.change().step(10);
    assert_eq!(steps_after(&mut session, nothing), 10);
    let force = shared.change().controls().set_dof_force(0, 1, 1e30);
    force.unwrap();
    shared.change().step(1);
    assert_eq!(steps_after(&mut session, nothing), 161);
    assert_eq!(
        steps_after(&mut session, r#"{"type": "scrub", "time": 0.02}"#),
        161
    );
}

#[test]
fn what_is_the_program_s_is_refused() {
    let (_shared, mut session) = of_program(examples::prismatic().unwrap());
    for command in [
        r#"{"type": "open", "example": "tower"}"#,
        r#"{"type": "rebuild", "build": {}}"#,
        r#"{"type": "physics", "values": {}}"#,
        r#"{"type": "joint", "dof": 0, "stiffness": 7}"#,
    ] {
        let message = refused(&mut session, command);
        assert!(message.contains("is a program's"), "{message}");
    }
    refused(
        &mut session,
        r#"{"type": "joint", "dof": 0, "position": 1e300}"#,
    );
}

#[test]
fn a_session_whose_program_has_gone_is_over() {
    let (shared, mut session) = of_program(examples::prismatic().unwrap());
    ask(&mut session, r#"{"type": "run"}"#);
    assert!(!session.over());
    drop(shared);
    assert!(session.over() && !session.advance());
    session.receive(r#"{"type": "step", "steps": 1}"#);
    assert_eq!(session.greeting().len(), 1);
    assert!(session.frame().poses.is_empty());
}
