//! Robot files: reading one, and showing what is in it.

use crate::arguments::{Info, RobotFile};
use crate::error::Error;
use crate::output::print;
use crate::summary::{contents, reason};
use crate::view;
use kinetarium::formats::{Loaded, Options};
use kinetarium::model::examples::Scene;
use kinetarium::model::{BodyId, BodyKind, CollisionFilter, Geometry, Joint, Model};
use kinetarium::sim::SolverKind;
use session::Example;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

/// Reads a file; what it uses and is not supported goes to the terminal, unless `quiet`.
pub fn load(file: &RobotFile, quiet: bool) -> Result<Loaded, Error> {
    let loaded = read(file)?;
    if !quiet {
        let warnings = loaded.warnings.iter();
        warnings.for_each(|warning| eprintln!("warning: {warning}"));
    }
    Ok(loaded)
}

/// Name of a file without folder and extension.
pub fn stem(path: &Path) -> String {
    path.file_stem()
        .map_or("robot".into(), |stem| stem.to_string_lossy().into_owned())
}

/// Shows what is in a file.
pub fn info(arguments: &Info) -> Result<(), Error> {
    print(&describe(&read(&arguments.file)?));
    Ok(())
}

fn read(file: &RobotFile) -> Result<Loaded, Error> {
    if let Some((name, command)) = example(&file.path) {
        return Err(Error::NoFile {
            name: name.into(),
            command,
        });
    }
    let reading = &file.reading;
    let options = Options {
        lenient: reading.lenient,
        meshes: reading.meshes.into(),
        floating_base: reading.floating_base,
    };
    Ok(kinetarium::formats::load(&file.path, &options)?)
}

/// The name of an example where a file was meant, and the command that takes it.
fn example(path: &Path) -> Option<(&str, &'static str)> {
    let name = view::example(path)?;
    let is_shown = Example::find(name).is_ok();
    match Scene::find(name) {
        Some(_) => Some((name, "example")),
        None => is_shown.then_some((name, "view")),
    }
}

fn describe(loaded: &Loaded) -> String {
    let model = &loaded.model;
    let solver = SolverKind::Auto.pick(model, true).name();
    let names = |names: Vec<&str>| match names.is_empty() {
        true => "none".to_owned(),
        false => names.join(", "),
    };
    let keyframes = model.keyframes.iter().map(|k| k.name.as_str()).collect();
    let cameras = model.cameras.iter().map(|c| c.name.as_str()).collect();
    let mut text = format!("{}\n", contents(model));
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<18}{value}");
    };
    line("mass", format!("{:.6} kg", model.total_mass()));
    line("gravity", format!("{} m/s²", model.gravity));
    line("time step", format!("{} s", model.time_step));
    line("actuators", model.actuators.len().to_string());
    line("sensors", model.sensors.len().to_string());
    line("keyframes", names(keyframes));
    line("cameras", names(cameras));
    line(
        "solver",
        format!("{solver} (auto: {})", reason(model, true)),
    );

    let unread = unread(model);
    if !unread.is_empty() {
        let remedy = "have them read (--meshes exact, or hull)";
        let unread = unread.join(", ");
        line(
            "unread meshes",
            format!("{unread}: solvers refuse that they touch; {remedy}"),
        );
    }

    let bodies = (0..model.bodies.len())
        .map(|b| body_row(model, BodyId(b)))
        .collect();
    text += &table(["body", "kind", "mass [kg]", "parent", "joint"], bodies);
    let joints = model.joints.iter().map(|j| joint_row(model, j)).collect();
    text += &table(["joint", "kind", "parent", "child", "coordinates"], joints);
    if !loaded.warnings.is_empty() {
        text += "\nnot supported, and left out\n";
        loaded
            .warnings
            .iter()
            .for_each(|warning| text += &format!("  {warning}\n"));
    }
    text
}

/// Meshes that may touch something and are but names of files, for people.
fn unread(model: &Model) -> Vec<String> {
    let filter = CollisionFilter::new(model);
    let touching: BTreeSet<_> = filter.pairs().flat_map(|(a, b)| [a.0, b.0]).collect();
    let mesh = |row: usize| {
        let shape = &model.shapes[row];
        let Geometry::MeshFile { file, .. } = &shape.geometry else {
            return None;
        };
        let name = match shape.name.as_str() {
            "" => format!("shape {row}"),
            name => format!("`{name}`"),
        };
        let body = body_name(model, shape.body);
        Some(format!("{name} of {body} ({file})"))
    };
    touching.into_iter().filter_map(mesh).collect()
}

fn body_row(model: &Model, id: BodyId) -> [String; 5] {
    let body = &model.bodies[id.0];
    let joint = model.carrier(id).map(|j| &model.joints[j.0]);
    let (kind, mass) = match body.kind {
        BodyKind::Static => ("static", String::new()),
        BodyKind::Dynamic => ("dynamic", format!("{:.6}", body.mass)),
    };
    let parent = joint.map_or("", |j| body_name(model, j.parent));
    let joint = joint.map_or("", |j| j.name.as_str());
    [
        body.name.clone(),
        kind.into(),
        mass,
        parent.into(),
        joint.into(),
    ]
}

fn joint_row(model: &Model, joint: &Joint) -> [String; 5] {
    let child = &model.bodies[joint.child.0].name;
    let (kind, parent) = (joint.kind.name(), body_name(model, joint.parent));
    let ranges: Vec<String> = joint
        .dofs
        .iter()
        .filter_map(|dof| dof.limit)
        .map(|l| format!("{:.4} … {:.4}", l.lower, l.upper))
        .collect();
    let coordinates = match joint.coordinates() {
        _ if joint.closes_loop => "closes a loop".into(),
        n if ranges.is_empty() => n.to_string(),
        n => format!("{n}, within {}", ranges.join("; ")),
    };
    [
        joint.name.clone(),
        kind.into(),
        parent.into(),
        child.clone(),
        coordinates,
    ]
}

fn body_name(model: &Model, body: Option<BodyId>) -> &str {
    body.map_or("(world)", |b| &model.bodies[b.0].name)
}

/// Columns as wide as their widest cell, with a heading and a blank line before it.
fn table(heading: [&str; 5], rows: Vec<[String; 5]>) -> String {
    let rows: Vec<_> = std::iter::once(heading.map(str::to_owned))
        .chain(rows)
        .collect();
    let width = |c: usize| {
        rows.iter()
            .map(|row| row[c].chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths: [usize; 5] = std::array::from_fn(width);
    rows.iter().fold(String::from("\n"), |text, row| {
        let line: String = row
            .iter()
            .zip(widths)
            .map(|(cell, w)| format!("{cell:<w$}  "))
            .collect();
        text + "  " + line.trim_end() + "\n"
    })
}
