//! What a program has bodies wear, as pages are told of it.

use kinetarium_session::protocol::{self, FileFormat, Message, Outfit};
use kinetarium_session::{
    Gauge, LONGEST_FILE, Outgoing, Session, Shared, Skin, SkinError, SkinFile, Told, Wardrobe,
};
use model::examples;
use sim::{Simulation, SimulationSettings};
use std::sync::Arc;

const RED: Skin = Skin::Color([1.0, 0.0, 0.0, 1.0]);
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n and so on";

/// A session about dominoes of a program, and their names.
fn dominoes() -> (Arc<Shared<f32>>, Session, Vec<String>) {
    let model = examples::dominoes(5).unwrap();
    let shared = Shared::new(Simulation::new(model, SimulationSettings::new(1, 0.002)).unwrap());
    let session = Session::of_program(&shared, || 0.0);
    let bodies = &shared.read().model().bodies.clone();
    let names = bodies.iter().map(|body| body.name.clone()).collect();
    (shared, session, names)
}

/// What a page is told that shows scene 1.
fn news(wardrobe: &Wardrobe, told: &mut Told) -> Vec<Message> {
    let texts = wardrobe.news(1, told).into_iter();
    texts
        .map(|text| serde_json::from_str(&text).unwrap())
        .collect()
}

/// The same, where it is no file.
fn outfits(wardrobe: &Wardrobe, told: &mut Told) -> Vec<Outfit> {
    match news(wardrobe, told).pop() {
        Some(Message::Dress { outfits, .. }) => outfits,
        None => Vec::new(),
        other => panic!("{other:?}"),
    }
}

fn file(name: &str, bytes: &[u8]) -> Skin {
    let file = SkinFile::new(name, bytes).unwrap();
    Skin::File { file, fitted: true }
}

fn wears(bodies: &[u32], skin: protocol::Skin) -> Outfit {
    let bodies = Some(bodies.to_vec());
    Outfit { bodies, skin }
}

#[test]
fn each_page_is_told_what_is_new_to_it_and_the_last_alone() {
    let (_shared, session, names) = dominoes();
    let wardrobe = session.wardrobe();
    let mut early = Told::default();
    assert_eq!(news(&wardrobe, &mut early), []);
    for i in 0..1000 {
        let shade = i as f32 / 1000.0;
        wardrobe
            .dress(&names[..1], Skin::Color([shade, 0.0, 0.0, 1.0]))
            .unwrap();
    }
    wardrobe.dress(&names[1..3], RED).unwrap();
    let shade = protocol::Skin::Color {
        color: [0.999, 0.0, 0.0, 1.0],
    };
    let red = protocol::Skin::Color {
        color: [1.0, 0.0, 0.0, 1.0],
    };
    let all = [wears(&[0], shade.clone()), wears(&[1, 2], red.clone())];
    assert_eq!(outfits(&wardrobe, &mut early), all);
    assert_eq!(news(&wardrobe, &mut early), []);
    wardrobe
        .dress(&names[2..3], Skin::Gauge(Gauge::Spin))
        .unwrap();
    let spin = protocol::Skin::Gauge { gauge: Gauge::Spin };
    assert_eq!(outfits(&wardrobe, &mut early), [wears(&[2], spin.clone())]);
    // Who comes late hears what is worn now.
    let late = outfits(&wardrobe, &mut Told::default());
    assert_eq!(
        late,
        [wears(&[0], shade), wears(&[1], red), wears(&[2], spin)]
    );
    // And of what all wear, without what was worn before.
    wardrobe.dress_all(Skin::Plain).unwrap();
    wardrobe.dress(&names[4..], Skin::Replica).unwrap();
    let plain = Outfit {
        bodies: None,
        skin: protocol::Skin::Plain {},
    };
    let all = [plain, wears(&[4], protocol::Skin::Replica {})];
    assert_eq!(outfits(&wardrobe, &mut early), all);
    assert_eq!(outfits(&wardrobe, &mut Told::default()), all);
}

#[test]
fn a_file_is_told_once_and_forgotten_when_many_others_were_worn() {
    let (_shared, session, names) = dominoes();
    let wardrobe = session.wardrobe();
    let mut told = Told::default();
    wardrobe.dress(&names[..1], file("white.png", PNG)).unwrap();
    let [Message::SkinFile(white), Message::Dress { outfits, .. }] =
        &news(&wardrobe, &mut told)[..]
    else {
        panic!("no file");
    };
    assert_eq!(
        (white.format, white.name.as_str()),
        (FileFormat::Png, "white.png")
    );
    assert_eq!(white.data, "iVBORw0KGgogYW5kIHNvIG9u");
    let skin = protocol::Skin::File {
        file: white.id.clone(),
        fitted: true,
    };
    assert_eq!(outfits[..], [wears(&[0], skin)]);
    // Equal contents are one file, whoever wears it, also after it was put off.
    wardrobe.dress(&names[1..], file("same.png", PNG)).unwrap();
    assert_eq!(news(&wardrobe, &mut told).len(), 1);
    wardrobe.dress_all(RED).unwrap();
    assert_eq!(news(&wardrobe, &mut told).len(), 1);
    wardrobe.dress_all(file("white.png", PNG)).unwrap();
    assert_eq!(news(&wardrobe, &mut told).len(), 1);
    let mut forgotten = Vec::new();
    for i in 0..20_u8 {
        wardrobe
            .dress_all(file("other.png", &[PNG, &[i]].concat()))
            .unwrap();
        let Some(Message::Dress { forget, .. }) = news(&wardrobe, &mut told).pop() else {
            panic!("nothing new");
        };
        forgotten.extend(forget);
    }
    // Of 21, one is worn and 16 are spare.
    assert_eq!(forgotten.len(), 4);
    assert_eq!(forgotten[0], white.id);
    wardrobe.dress_all(file("white.png", PNG)).unwrap();
    assert_eq!(news(&wardrobe, &mut told).len(), 2);
    assert_eq!(news(&wardrobe, &mut Told::default()).len(), 2);
}

#[test]
fn what_cannot_be_worn_is_refused_and_changes_nothing() {
    let (_shared, session, names) = dominoes();
    let wardrobe = session.wardrobe();
    let refused = |result: Result<(), SkinError>, why: &str| {
        let error = result.unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
    };
    let some = [names[0].as_str(), "dominoo"];
    refused(wardrobe.dress(&some, RED), "no body named \"dominoo\"");
    refused(wardrobe.dress(&some, RED), "did you mean");
    for wrong in [f32::NAN, -0.1, 1.1, f32::INFINITY] {
        let color = Skin::Color([0.0, wrong, 0.0, 1.0]);
        refused(wardrobe.dress(&names, color.clone()), "each from 0 to 1");
        refused(wardrobe.dress_all(color), "each from 0 to 1");
    }
    assert_eq!(news(&wardrobe, &mut Told::default()), []);
    refused(Skin::named("hight").map(|_| ()), "did you mean \"height\"?");
    refused(
        Skin::named("").map(|_| ()),
        "plain, replica, speed, spin, force, height",
    );
    let folder = tempfile::tempdir().unwrap();
    refused(SkinFile::read(folder.path()).map(|_| ()), "cannot be read");
    let missing = folder.path().join("missing.png");
    refused(
        SkinFile::read(&missing).map(|_| ()),
        "missing.png cannot be read",
    );
    let long = folder.path().join("long.png");
    std::fs::write(&long, [PNG, &vec![0; LONGEST_FILE][..]].concat()).unwrap();
    refused(
        SkinFile::read(&long).map(|_| ()),
        "long.png is longer than 16 MB",
    );
    for wrong in [&b""[..], b"\x89PN", b"RIFF\0\0\0\0WAVE", b"RIFF", b"<svg/>"] {
        refused(SkinFile::new("x", wrong).map(|_| ()), "x is no picture");
    }
}

#[test]
fn a_file_is_what_its_first_bytes_tell() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("misleading.txt");
    let (_shared, session, _) = dominoes();
    let wardrobe = session.wardrobe();
    for (bytes, format) in [
        (PNG, FileFormat::Png),
        (b"\xff\xd8\xff\xe0", FileFormat::Jpeg),
        (b"RIFF\x10\0\0\0WEBPVP8 ", FileFormat::Webp),
        (b"glTF\x02\0\0\0", FileFormat::Glb),
    ] {
        std::fs::write(&path, bytes).unwrap();
        let file = SkinFile::read(&path).unwrap();
        wardrobe
            .dress_all(Skin::File {
                file,
                fitted: false,
            })
            .unwrap();
        let Message::SkinFile(file) = &news(&wardrobe, &mut Told::default())[0] else {
            panic!("no file");
        };
        assert_eq!(
            (file.format, file.name.as_str()),
            (format, "misleading.txt")
        );
    }
}

/// News go with frames: there is one, though nothing moves.
#[test]
fn a_body_that_is_dressed_makes_a_frame_and_no_step() {
    let (shared, mut session, names) = dominoes();
    let wardrobe = session.wardrobe();
    let mut frames = || {
        while session.advance() {}
        let outgoing = std::iter::from_fn(|| session.outgoing());
        outgoing.filter(|o| matches!(o, Outgoing::Frame(_))).count()
    };
    assert_eq!(frames(), 0);
    wardrobe.dress(&names, RED).unwrap();
    assert_eq!(frames(), 1);
    assert_eq!(frames(), 0);
    assert_eq!(shared.read().time(0), 0.0);
}

#[test]
fn another_scene_takes_off_what_single_bodies_wore() {
    let mut session = Session::example("dominoes", || 0.0).unwrap();
    let wardrobe = session.wardrobe();
    let Some(Outgoing::Text(scene)) = session.greeting().into_iter().nth(1) else {
        panic!("no scene");
    };
    let Message::Scene(scene) = serde_json::from_str(&scene).unwrap() else {
        panic!("no scene");
    };
    let name = scene.bodies.last().unwrap().name.clone();
    wardrobe.dress_all(RED).unwrap();
    wardrobe.dress(&[&name], Skin::Replica).unwrap();
    let bodies = |scene: u32| {
        let texts = wardrobe.news(scene, &mut Told::default());
        let dress = texts.last().map(|text| serde_json::from_str(text).unwrap());
        let Some(Message::Dress { outfits, .. }) = dress else {
            return Vec::new();
        };
        outfits.into_iter().map(|outfit| outfit.bodies).collect()
    };
    let row = Some(vec![scene.bodies.len() as u32 - 1]);
    assert_eq!(bodies(scene.id), [None, row]);
    // Who still shows the last scene is told nothing of the next.
    session.receive(r#"{"type": "rebuild", "build": {"count": 2}}"#);
    assert_eq!(bodies(scene.id), []);
    assert_eq!(bodies(scene.id + 1), [None]);
    assert!(wardrobe.dress(&[&name], RED).is_err());
    session.receive(r#"{"type": "open", "example": "balls"}"#);
    assert_eq!(bodies(scene.id + 2), [None]);
}
