//! Both sides mean the same by every message: the page's tests read the same file.

use kinetarium_session::protocol::{Command, Message};
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::BTreeSet;

#[derive(serde::Deserialize)]
struct Samples {
    commands: Vec<Value>,
    messages: Vec<Value>,
}

fn samples() -> Samples {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../web/tests/messages.json");
    serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap()
}

/// Reads every sample, and finds a sample of every type there is.
fn covers<T: DeserializeOwned + std::fmt::Debug>(samples: &[Value], types: &[&str]) {
    let mut seen = BTreeSet::new();
    for sample in samples {
        let read = serde_json::from_value::<T>(sample.clone());
        assert!(read.is_ok(), "{sample}: {}", read.unwrap_err());
        seen.insert(sample["type"].as_str().unwrap());
    }
    let known: BTreeSet<_> = types.iter().copied().collect();
    assert_eq!(seen, known);
}

/// What serde names when it is asked for a type that is not there.
fn types<T: DeserializeOwned + std::fmt::Debug>() -> Vec<String> {
    let error = serde_json::from_str::<T>(r#"{"type": "?"}"#)
        .unwrap_err()
        .to_string();
    let names = error.split('`').skip(1).step_by(2).skip(1);
    names.map(str::to_owned).collect()
}

#[test]
fn every_command_of_the_page_is_understood() {
    let types = types::<Command>();
    let types: Vec<_> = types.iter().map(String::as_str).collect();
    assert!(types.len() > 10);
    covers::<Command>(&samples().commands, &types);
}

#[test]
fn every_message_to_the_page_is_written_as_it_is_read() {
    let types = types::<Message>();
    let types: Vec<_> = types.iter().map(String::as_str).collect();
    covers::<Message>(&samples().messages, &types);
    for sample in samples().messages {
        let message: Message = serde_json::from_value(sample.clone()).unwrap();
        // Numbers may be written in another way: 1 and 1.0.
        let again: Message =
            serde_json::from_value(serde_json::to_value(&message).unwrap()).unwrap();
        assert_eq!(again, message);
        let names = |value: &Value| {
            value
                .as_object()
                .unwrap()
                .keys()
                .cloned()
                .collect::<BTreeSet<_>>()
        };
        assert_eq!(
            names(&serde_json::to_value(&message).unwrap()),
            names(&sample),
            "{sample}"
        );
    }
}
