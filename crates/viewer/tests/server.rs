//! The server as browsers and strangers see it.

use kinetarium_viewer::{Access, Viewer, clock, serve, show};
use model::BodyId;
use model::examples::Start;
use numbers::Float;
use serde_json::Value;
use session::frame::HEADER;
use session::{Gauge, Session, Shared, Skin, SkinFile};
use sim::{Simulation, SimulationSettings};
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};
use tungstenite::client::IntoClientRequest;
use tungstenite::http::HeaderValue;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Error, Message, WebSocket, connect};

type Page = WebSocket<MaybeTlsStream<TcpStream>>;

/// Serves an example on a free port of this machine, for as long as the tests run.
fn server(example: &str, access: Access) -> SocketAddr {
    let session = Session::example(example, clock).unwrap();
    let server = serve(session, SocketAddr::from(([127, 0, 0, 1], 0)), access).unwrap();
    let address = server.address();
    thread::spawn(|| server.run());
    address
}

fn open() -> Access {
    Access::for_address([127, 0, 0, 1].into()).unwrap()
}

fn page(address: SocketAddr) -> Page {
    connect(format!("ws://{address}/session")).unwrap().0
}

fn say(page: &mut Page, command: &str) {
    page.send(Message::text(command)).unwrap();
}

/// The next text message of a type; frames and others are passed over.
fn hear(page: &mut Page, kind: &str) -> Value {
    loop {
        if let Message::Text(text) = page.read().unwrap() {
            let message: Value = serde_json::from_str(&text).unwrap();
            if message["type"] == kind {
                return message;
            }
        }
    }
}

/// The status code with which a connection is refused.
fn refusal(address: SocketAddr, path: &str, header: Option<(&'static str, &'static str)>) -> u16 {
    let mut request = format!("ws://{address}{path}")
        .into_client_request()
        .unwrap();
    if let Some((name, value)) = header {
        request
            .headers_mut()
            .insert(name, HeaderValue::from_static(value));
    }
    match connect(request) {
        Err(Error::Http(response)) => response.status().as_u16(),
        other => panic!("{path}, {header:?}: {other:?}"),
    }
}

#[test]
fn a_page_is_welcomed_and_steps() {
    let mut page = page(server("dominoes", open()));
    let welcome = hear(&mut page, "welcome");
    assert_eq!(welcome["protocol"], 1);
    assert_eq!(hear(&mut page, "scene")["name"], "dominoes");
    say(&mut page, r#"{"type": "step", "steps": 100}"#);
    while hear(&mut page, "status")["steps"] != 100 {}
}

#[test]
fn pages_share_the_worlds_and_refusals_go_to_who_asked() {
    let address = server("balls", open());
    let (mut first, mut second) = (page(address), page(address));
    hear(&mut first, "status");
    hear(&mut second, "status");
    say(&mut first, r#"{"type": "fly"}"#);
    assert!(
        hear(&mut first, "error")["message"]
            .as_str()
            .unwrap()
            .contains("fly")
    );
    say(&mut first, r#"{"type": "open", "example": "tower"}"#);
    loop {
        let Message::Text(text) = second.read().unwrap() else {
            continue;
        };
        let message: Value = serde_json::from_str(&text).unwrap();
        assert_ne!(message["type"], "error");
        if message["type"] == "scene" {
            assert_eq!(message["name"], "tower");
            return;
        }
    }
}

#[test]
fn what_one_page_sets_is_told_to_the_others() {
    let address = server("balls", open());
    let (mut first, mut second) = (page(address), page(address));
    hear(&mut first, "status");
    hear(&mut second, "status");
    say(
        &mut first,
        r#"{"type": "physics", "values": {"gravity": 1.62}}"#,
    );
    assert_eq!(
        hear(&mut second, "changed")["commands"][0]["values"]["gravity"],
        1.62
    );
    say(&mut second, r#"{"type": "step", "steps": 3}"#);
    loop {
        if let Message::Text(text) = first.read().unwrap() {
            let message: Value = serde_json::from_str(&text).unwrap();
            assert_ne!(message["type"], "changed", "an echo");
            if message["steps"] == 3 {
                return;
            }
        }
    }
}

#[test]
fn what_nobody_sees_stands_still() {
    let address = server("balls", open());
    let mut first = page(address);
    say(&mut first, r#"{"type": "run"}"#);
    while hear(&mut first, "status")["time"].as_f64().unwrap() < 0.1 {}
    drop(first);
    thread::sleep(Duration::from_secs(2));
    let time = hear(&mut page(address), "status")["time"].as_f64().unwrap();
    assert!((0.1..1.2).contains(&time), "{time} s");
}

#[test]
fn a_page_that_takes_nothing_for_long_is_let_go() {
    let address = server("grid", open());
    let mut deaf = page(address);
    let mut talker = page(address);
    say(&mut talker, r#"{"type": "run"}"#);
    let end = Instant::now() + Duration::from_secs(14);
    while Instant::now() < end {
        talker.read().unwrap();
    }
    // What was on its way comes, and then nothing more.
    while deaf.read().is_ok() {
        assert!(
            Instant::now() < end + Duration::from_secs(20),
            "still connected"
        );
    }
    hear(&mut talker, "status");
}

#[test]
fn strangers_are_refused() {
    let address = server("balls", open());
    assert_eq!(
        refusal(address, "/session", Some(("origin", "http://evil.example"))),
        403
    );
    assert_eq!(
        refusal(address, "/session", Some(("host", "evil.example"))),
        403
    );
    let closed = server("balls", Access::with_token("secret"));
    assert_eq!(refusal(closed, "/session", None), 403);
    assert_eq!(refusal(closed, "/session?token=wrong", None), 403);
    assert_eq!(refusal(closed, "/", None), 403);
    let (mut page, _) = connect(format!("ws://{closed}/session?token=secret")).unwrap();
    hear(&mut page, "welcome");
}

#[test]
fn ten_thousand_malformed_messages_are_survived() {
    let address = server("tower", open());
    let mut watcher = page(address);
    say(&mut watcher, r#"{"type": "run"}"#);
    let mut pest = page(address);
    let MaybeTlsStream::Plain(socket) = pest.get_ref() else {
        panic!("no TLS was asked for");
    };
    let mut answers = socket.try_clone().unwrap();
    thread::spawn(move || std::io::copy(&mut answers, &mut std::io::sink()));
    for i in 0..10_000_u32 {
        let message = match i % 5 {
            0 => Message::text("{"),
            1 => Message::text(r#"{"type": "open", "example": 7}"#),
            2 => Message::binary(i.to_le_bytes().to_vec()),
            3 => Message::text("\u{0}".repeat((i % 300) as usize)),
            _ => Message::text(
                r#"{"type": "grab", "world": 4294967295, "body": 0, "point": [], "to": []}"#,
            ),
        };
        pest.send(message).unwrap();
    }
    let before = hear(&mut watcher, "status")["time"].as_f64().unwrap();
    let after = (0..8).map(|_| hear(&mut watcher, "status")["time"].as_f64().unwrap());
    assert!(after.last().unwrap() > before, "the simulation stands");
}

#[test]
fn a_message_that_is_too_long_ends_its_connection_and_nothing_else() {
    let address = server("balls", open());
    let (mut long, mut other) = (page(address), page(address));
    let command = format!(r#"{{"type": "{}"}}"#, "a".repeat(1 << 20));
    // The server may hang up before all of it is sent.
    let _ = long.send(Message::text(command));
    let end = Instant::now() + Duration::from_secs(20);
    while long.read().is_ok() {
        assert!(Instant::now() < end, "still connected");
    }
    say(&mut other, r#"{"type": "step", "steps": 3}"#);
    while hear(&mut other, "status")["steps"] != 3 {}
}

/// Frames that come in so many seconds, and the simulated time that passes.
fn watched(page: &mut Page, seconds: f64) -> (usize, f64) {
    let (mut frames, start) = (0, Instant::now());
    let mut times: Vec<f64> = Vec::new();
    while start.elapsed() < Duration::from_secs_f64(seconds) {
        if let Message::Binary(bytes) = page.read().unwrap() {
            frames += 1;
            times.push(f64::from_le_bytes(bytes[16..24].try_into().unwrap()));
        }
    }
    (frames, times[frames - 1] - times[0])
}

#[test]
fn a_page_that_does_not_read_slows_nobody() {
    let address = server("grid", open());
    let mut page = page(address);
    say(&mut page, r#"{"type": "run"}"#);
    watched(&mut page, 1.0);
    let before = watched(&mut page, 3.0);
    let deaf = self::page(address);
    // 64 humanoids, 150 kB a frame: its sockets are full after a few.
    watched(&mut page, 1.0);
    let meanwhile = watched(&mut page, 3.0);
    drop(deaf);
    let after = watched(&mut page, 3.0);
    // Other programs take of the machine what they like, before and after, too.
    let told = format!("{before:?}, {meanwhile:?}, {after:?}");
    assert!(2 * meanwhile.0 > before.0.min(after.0), "{told}");
    assert!(2.0 * meanwhile.1 > before.1.min(after.1), "{told}");
}

/// A line that is slow carries a few frames at a time, so that what a page sees is never late.
#[test]
fn frames_wait_for_answers() {
    let address = server("grid", open());
    let (mut late, mut talker) = (page(address), page(address));
    say(&mut talker, r#"{"type": "run"}"#);
    let end = Instant::now() + Duration::from_secs(4);
    while Instant::now() < end {
        talker.read().unwrap();
    }
    // What waits in the connection is all from the beginning; then those come that are new.
    let mut times = Vec::new();
    while times.len() < 20 {
        if let Message::Binary(bytes) = late.read().unwrap() {
            times.push(f64::from_le_bytes(bytes[16..24].try_into().unwrap()));
        }
    }
    let old = times.iter().filter(|time| **time < times[19] / 2.0).count();
    assert!(old <= 5, "{times:?}");
}

/// A pendulum of four worlds that a program holds.
fn pendulum<T: Float>() -> Arc<Shared<T>> {
    let model = model::examples::chain(1, Start::Horizontal).unwrap();
    Shared::new(Simulation::new(model, SimulationSettings::new(4, 0.002)).unwrap())
}

/// The next frame's time [s] and where its first body is [m], at least so late.
fn frame(page: &mut Page, least: f64) -> (f64, [f32; 3]) {
    loop {
        let Message::Binary(bytes) = page.read().unwrap() else {
            continue;
        };
        let time = f64::from_le_bytes(bytes[16..24].try_into().unwrap());
        if time >= least - 1e-9 {
            let number = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
            return (time, [0, 4, 8].map(|at| number(HEADER + at)));
        }
    }
}

#[test]
fn what_the_program_sets_is_told_to_all_pages() {
    let shared = pendulum::<f32>();
    let viewer = show(&shared, None, None).unwrap();
    let mut pages = [page(viewer.address()), page(viewer.address())];
    for page in &mut pages {
        hear(page, "status");
    }
    let set = |target| shared.change().controls().set_target(0, 0, target).unwrap();
    (0..100).for_each(|i| set(f64::from(i)));
    set(0.5);
    for page in &mut pages {
        while hear(page, "changed")["commands"][0]["position"] != 0.5 {}
    }
}

/// Who wears what, as a page is told next.
fn outfits(page: &mut Page) -> Value {
    hear(page, "dress")["outfits"].take()
}

#[test]
fn what_bodies_wear_is_told_to_all_pages_and_to_who_comes_later() {
    let shared = pendulum::<f32>();
    let viewer = show(&shared, None, None).unwrap();
    let mut first = page(viewer.address());
    hear(&mut first, "status");
    let bytes = b"\x89PNG\r\n\x1a\n";
    let file = SkinFile::new("white.png", bytes).unwrap();
    let skin = Skin::File { file, fitted: true };
    viewer.dress_all(skin).unwrap();
    let file = hear(&mut first, "skin_file");
    assert_eq!(file["name"], "white.png");
    assert_eq!(outfits(&mut first)[0]["skin"]["file"], file["id"]);
    let name = shared.read().model().bodies[0].name.clone();
    viewer.dress(&[&name], Skin::Gauge(Gauge::Spin)).unwrap();
    let spin = outfits(&mut first);
    assert_eq!(spin[0]["skin"]["gauge"], "spin");
    assert_eq!(spin.as_array().unwrap().len(), 1);
    let mut second = page(viewer.address());
    assert_eq!(hear(&mut second, "skin_file"), file);
    let worn = outfits(&mut second);
    assert_eq!(worn[0]["bodies"], Value::Null);
    assert_eq!(worn[1], spin[0]);
    // The simulation is as it was.
    assert_eq!(shared.read().time(0), 0.0);
    viewer.dress(&["nobody"], Skin::Plain).unwrap_err();
}

/// Ten thousand colours do not wait for a page, nor lose it: it hears of the last.
#[test]
fn a_page_that_does_not_read_hears_of_the_last_colour() {
    let shared = pendulum::<f32>();
    let viewer = show(&shared, None, None).unwrap();
    let mut page = page(viewer.address());
    hear(&mut page, "status");
    let name = shared.read().model().bodies[0].name.clone();
    let shade = |i: u32| Skin::Color([i as f32 / 10_000.0, 0.0, 0.0, 1.0]);
    let mut longest = Duration::ZERO;
    for i in 0..=10_000 {
        let start = Instant::now();
        viewer.dress(&[&name], shade(i)).unwrap();
        longest = longest.max(start.elapsed());
        thread::sleep(Duration::from_micros(200));
    }
    assert!(longest < Duration::from_millis(500), "{longest:?}");
    let mut heard = 0;
    while outfits(&mut page)[0]["skin"]["color"][0] != 1.0 {
        heard += 1;
    }
    assert!(heard < 1000, "{heard}");
}

/// What a page is told last, before the server ends the connection.
fn last_words(mut page: Page) -> String {
    let mut last = String::new();
    loop {
        match page.read() {
            Ok(Message::Text(text)) => last = text.to_string(),
            Ok(_) => {}
            Err(Error::ConnectionClosed) => return last,
            Err(error) => panic!("not closed as it should be: {error}"),
        }
    }
}

fn a_program_and_its_pages_see_what_each_other_do<T: Float>() {
    let shared = pendulum::<T>();
    let viewer = show(&shared, None, None).unwrap();
    assert!(viewer.url().starts_with("http://127.0.0.1:"));
    let (mut first, mut second) = (page(viewer.address()), page(viewer.address()));
    for page in [&mut first, &mut second] {
        assert_eq!(hear(page, "welcome")["examples"], Value::Array(Vec::new()));
        let scene = hear(page, "scene");
        assert_eq!(scene["physics"], Value::Array(Vec::new()));
        assert_eq!(scene["build"], Value::Array(Vec::new()));
        assert_eq!(frame(page, 0.0).0, 0.0);
    }
    shared.change().step(100);
    let at = shared.read().outputs().body_position(0, BodyId(0));
    for page in [&mut first, &mut second] {
        assert_eq!(frame(page, 0.2).1, at.as_vec3().to_array());
    }
    say(&mut second, r#"{"type": "step", "steps": 50}"#);
    frame(&mut first, 0.3);
    assert!((shared.read().time(3) - 0.3).abs() < 1e-9);
    // What the program resets, pages see begin again.
    shared.change().reset_all();
    while frame(&mut first, 0.0).0 > 0.0 {}
    say(
        &mut first,
        r#"{"type": "physics", "values": {"gravity": 1.62}}"#,
    );
    let refusal = hear(&mut first, "error");
    assert!(refusal["message"].as_str().unwrap().contains("a program's"));
}

#[test]
fn a_program_and_its_pages_see_what_each_other_do_in_single_precision() {
    a_program_and_its_pages_see_what_each_other_do::<f32>();
}

#[test]
fn a_program_and_its_pages_see_what_each_other_do_in_double_precision() {
    a_program_and_its_pages_see_what_each_other_do::<f64>();
}

#[test]
fn a_page_that_runs_a_program_s_simulation_lets_the_program_in() {
    let shared = pendulum::<f32>();
    let viewer = show(&shared, None, None).unwrap();
    let mut page = page(viewer.address());
    say(&mut page, r#"{"type": "speed", "factor": null}"#);
    say(&mut page, r#"{"type": "run"}"#);
    frame(&mut page, 0.1);
    let mut waits: Vec<_> = (0..200)
        .map(|_| {
            thread::sleep(Duration::from_micros(300));
            let start = Instant::now();
            drop(shared.change());
            start.elapsed()
        })
        .collect();
    waits.sort();
    // Slices of 4 ms; some are longer on a machine that is busy with other things.
    assert!(waits[100] < Duration::from_millis(50), "{waits:?}");
}

#[test]
fn a_program_that_never_rests_is_seen() {
    let shared = pendulum::<f32>();
    let viewer = show(&shared, None, None).unwrap();
    let mut page = page(viewer.address());
    let stop = Arc::new(AtomicBool::new(false));
    let program = thread::spawn({
        let (shared, stop) = (shared.clone(), stop.clone());
        move || {
            while !stop.load(Ordering::Relaxed) {
                shared.change().step(10);
            }
        }
    });
    let start = Instant::now();
    let times: Vec<_> = (0..30).map(|_| frame(&mut page, 0.0).0).collect();
    stop.store(true, Ordering::Relaxed);
    program.join().unwrap();
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
    assert!(start.elapsed() < Duration::from_secs(10));
}

#[test]
fn a_page_that_goes_lets_go() {
    let shared = pendulum::<f64>();
    let viewer = show(&shared, None, None).unwrap();
    let (mut holder, mut watcher) = (page(viewer.address()), page(viewer.address()));
    say(
        &mut holder,
        r#"{"type": "grab", "world": 0, "body": 0, "point": [0, 0, 0], "to": [0, 9, 0]}"#,
    );
    let energy = |shared: &Shared<f64>| shared.read().outputs().energy(0);
    let rest = energy(&shared);
    hear(&mut holder, "status");
    hear(&mut holder, "status");
    shared.change().step(50);
    assert!(energy(&shared) > rest + 1.0, "not held");
    drop(holder);
    say(&mut watcher, r#"{"type": "restart"}"#);
    thread::sleep(Duration::from_millis(100));
    shared.change().reset_all();
    shared.change().step(50);
    // What falls freely keeps its energy, but for the error of the step.
    assert!((energy(&shared) - rest).abs() < 0.1, "{}", energy(&shared));
}

#[test]
fn what_stands_still_sends_no_frames() {
    let shared = pendulum::<f32>();
    let viewer = show(&shared, None, None).unwrap();
    let mut page = page(viewer.address());
    frame(&mut page, 0.0);
    thread::sleep(Duration::from_millis(200));
    // Nor does looking.
    shared.read().outputs();
    thread::sleep(Duration::from_millis(200));
    say(&mut page, "none");
    loop {
        match page.read().unwrap() {
            Message::Text(text) if text.contains("no command") => return,
            Message::Binary(_) => panic!("a frame of nothing new"),
            _ => {}
        }
    }
}

#[test]
fn pages_are_told_when_a_program_drops_its_simulation() {
    let shared = pendulum::<f32>();
    let viewer = show(&shared, None, None).unwrap();
    let (mut first, second) = (page(viewer.address()), page(viewer.address()));
    say(&mut first, r#"{"type": "run"}"#);
    frame(&mut first, 0.01);
    drop(shared);
    for page in [first, second] {
        assert!(last_words(page).contains("ended this simulation"));
    }
    ends(&viewer);
}

#[test]
fn a_view_that_nobody_watches_ends_with_its_simulation() {
    let shared = pendulum::<f32>();
    let viewer = show(&shared, None, None).unwrap();
    drop(shared);
    ends(&viewer);
}

/// Is not open soon, nor does it listen then.
fn ends(viewer: &Viewer) {
    let end = Instant::now() + Duration::from_secs(10);
    while viewer.is_open() {
        assert!(Instant::now() < end, "still open");
        thread::sleep(Duration::from_millis(2));
    }
    TcpStream::connect(viewer.address()).unwrap_err();
}

#[test]
fn pages_are_told_when_a_program_closes_the_view_and_nothing_steps_after_that() {
    let shared = pendulum::<f32>();
    let viewer = show(&shared, None, None).unwrap();
    let address = viewer.address();
    let mut page = page(address);
    say(&mut page, r#"{"type": "run"}"#);
    frame(&mut page, 0.01);
    let last = thread::spawn(|| last_words(page));
    viewer.close();
    let time = shared.read().time(0);
    assert!(last.join().unwrap().contains("closed this view"));
    assert_eq!(shared.read().time(0), time);
    TcpStream::connect(address).unwrap_err();
    drop(show(&shared, Some(address), None).unwrap());
}

#[test]
fn a_program_may_ask_for_a_token() {
    let shared = pendulum::<f32>();
    let viewer = show(&shared, None, Some("secret")).unwrap();
    assert!(viewer.url().ends_with("/?token=secret"));
    assert_eq!(refusal(viewer.address(), "/session", None), 403);
    for token in ["", "a b", "a&b=c"] {
        let error = show(&shared, None, Some(token)).unwrap_err().to_string();
        assert!(error.contains("letters, digits"), "{error}");
    }
}
