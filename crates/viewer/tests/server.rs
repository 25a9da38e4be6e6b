//! The server as browsers and strangers see it.

use kinetarium_viewer::{Access, clock, serve};
use serde_json::Value;
use session::Session;
use std::net::{SocketAddr, TcpStream};
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

#[test]
fn a_page_that_does_not_read_slows_nobody() {
    let address = server("grid", open());
    let _deaf = page(address);
    let mut page = page(address);
    say(&mut page, r#"{"type": "run"}"#);
    let (mut frames, start) = (0, Instant::now());
    let mut last = 0.0;
    while start.elapsed() < Duration::from_secs(4) {
        match page.read().unwrap() {
            Message::Binary(_) => frames += 1,
            Message::Text(text) => {
                let message: Value = serde_json::from_str(&text).unwrap();
                last = message["time"].as_f64().unwrap_or(last);
            }
            _ => {}
        }
    }
    // 64 humanoids, 150 kB a frame: sockets of the deaf page are full after a few.
    assert!(frames > 20, "{frames} frames");
    assert!(last > 0.2, "{last} s");
}
