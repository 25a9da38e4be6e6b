//! Files of several files.

use glam::DVec3;
use kinetarium_formats::{Files, Folder, InMemory, Options, load, parse};
use model::Geometry;

#[test]
fn includes_are_spliced_in() {
    let files = InMemory::new([
        (
            "arm.xml",
            r#"<mujoco><body name="arm"><joint/><include file="hand.xml"/></body></mujoco>"#,
        ),
        ("hand.xml", r#"<any><geom name="hand" size="0.1"/></any>"#),
    ]);
    let text = r#"<mujoco><worldbody><include file="arm.xml"/></worldbody></mujoco>"#;
    let loaded = parse(text, "robot.xml", &files, &Options::default()).expect("a model");
    assert_eq!(loaded.model.bodies[0].name, "arm");
    assert_eq!(loaded.model.shapes[0].name, "hand");
}

/// MuJoCo 4.0 takes a file beside the main one, and else one beside that which includes it.
#[test]
fn includes_are_relative_to_the_main_file_or_to_the_including_one() {
    let body =
        |name: &str| format!("<any><body name='{name}'><joint/><geom size='0.1'/></body></any>");
    let include = |file: &str| format!("<any><include file='{file}'/></any>");
    let found = |files: &[(&str, String)]| {
        let files = InMemory::new(files.iter().cloned());
        let text = "<mujoco><worldbody><include file='sub/a.xml'/></worldbody></mujoco>";
        parse(text, "robot.xml", &files, &Options::default())
            .map(|loaded| loaded.model.bodies[0].name.clone())
            .map_err(|error| error.to_string())
    };
    let inner = ("sub/b.xml", body("inner"));
    let outer = ("b.xml", body("outer"));
    let by = ("sub/a.xml", include("b.xml"));
    assert_eq!(found(&[by.clone(), inner.clone()]), Ok("inner".into()));
    assert_eq!(
        found(&[by.clone(), inner.clone(), outer.clone()]),
        Ok("outer".into())
    );
    let up = ("sub/a.xml", include("../b.xml"));
    assert_eq!(found(&[up, outer.clone()]), Ok("outer".into()));
    let from_main = ("sub/a.xml", include("sub/b.xml"));
    assert_eq!(found(&[from_main, inner]), Ok("inner".into()));
    let deep = [
        ("sub/a.xml", include("c/d.xml")),
        ("sub/c/d.xml", include("e.xml")),
    ];
    let last = ("sub/c/e.xml", body("deep"));
    assert_eq!(found(&[&deep[..], &[last]].concat()), Ok("deep".into()));
    // Not beside those that include the including one.
    let halfway = ("sub/e.xml", body("halfway"));
    let missing = found(&[&deep[..], &[halfway]].concat()).expect_err("no file");
    assert!(
        missing.starts_with("sub/c/d.xml:1:15: <include>: attribute `file` names `e.xml`"),
        "{missing}"
    );
    let itself = found(&[("sub/a.xml", include("a.xml"))]).expect_err("a circle");
    assert!(itself.contains("already part of the model"), "{itself}");
}

#[test]
fn a_file_is_read_with_the_files_beside_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let robot = folder.path().join("robot.xml");
    let text = r#"<mujoco>
        <compiler meshdir="meshes"/>
        <asset><mesh name="m" file="m.stl" scale="2 2 2"/></asset>
        <worldbody>
          <include file="more.xml"/>
          <geom type="mesh" mesh="m"/>
        </worldbody>
      </mujoco>"#;
    std::fs::write(&robot, text).expect("written");
    std::fs::write(folder.path().join("more.xml"), "<x><geom size='1'/></x>").expect("written");
    let model = load(&robot, &Options::default()).expect("a model").model;
    assert_eq!(model.name, "robot");
    let file = folder
        .path()
        .join("meshes/m.stl")
        .to_string_lossy()
        .into_owned();
    assert_eq!(
        model.shapes[1].geometry,
        Geometry::MeshFile {
            file,
            scale: DVec3::splat(2.0)
        }
    );

    std::fs::write(folder.path().join("more.xml"), "<x>\n<geom size='0'/></x>").expect("written");
    let error = load(&robot, &Options::default())
        .expect_err("a size of zero")
        .to_string();
    assert!(
        error.starts_with(&format!("{}/more.xml:2:7: ", folder.path().display())),
        "{error}"
    );
    let missing = load(&folder.path().join("none.xml"), &Options::default()).expect_err("no file");
    assert!(
        missing.to_string().contains("none.xml: cannot be read"),
        "{missing}"
    );
    let not_text = folder.path().join("noise.xml");
    std::fs::write(&not_text, [0xff, 0xfe, 0x00]).expect("written");
    assert!(load(&not_text, &Options::default()).is_err());
    assert!(Folder::new(folder.path()).read("absent").is_err());
}
