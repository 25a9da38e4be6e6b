//! `<include file="…"/>`: one document out of several files (XML reference, "include").

use crate::error::FormatError;
use crate::files::Files;
use crate::xml::{self, Element};
use std::collections::HashSet;
use std::io;

/// What is included, and the folder of the file that includes it.
struct Part {
    root: Element,
    folder: String,
}

/// Replaces every include below `root` by the children of the root of the file that it names.
///
/// Each file may be included once, as in MuJoCo, so that includes cannot go in circles.
pub(super) fn assemble(root: Element, files: &dyn Files) -> Result<Element, FormatError> {
    let mut included = HashSet::from([plain(&root.place.file)]);
    let folder = String::new();
    expand(Part { root, folder }, files, &mut included, 1)
}

fn expand(
    part: Part,
    files: &dyn Files,
    included: &mut HashSet<String>,
    depth: usize,
) -> Result<Element, FormatError> {
    let Part { mut root, folder } = part;
    root.check_depth(depth)?;
    for child in std::mem::take(&mut root.children) {
        if child.name == "include" {
            let part = expand(
                open(&child, &folder, files, included)?,
                files,
                included,
                depth + 1,
            )?;
            root.children.extend(part.children);
        } else {
            let folder = folder.clone();
            let part = Part {
                root: child,
                folder,
            };
            root.children
                .push(expand(part, files, included, depth + 1)?);
        }
    }
    Ok(root)
}

/// The file that an include names: beside the main one, or else in `folder`, beside that which includes it.
fn open(
    include: &Element,
    folder: &str,
    files: &dyn Files,
    included: &mut HashSet<String>,
) -> Result<Part, FormatError> {
    let written = include.require("file")?;
    let mut name = plain(written);
    let mut read = files.read(&name);
    if !folder.is_empty() && is_missing(&read) {
        let beside = plain(&format!("{folder}/{written}"));
        let other = files.read(&beside);
        if !is_missing(&other) {
            (name, read) = (beside, other);
        }
    }
    let path = files.path(&name);
    if !included.insert(plain(&path)) {
        return Err(include.invalid_attribute(
            "file",
            &format!("names `{written}`, which is already part of the model"),
            "include each file once, and no file from within itself",
        ));
    }
    let text = read.map_err(|problem| {
        include.invalid_attribute(
            "file",
            &format!("names `{path}`, which cannot be read ({problem})"),
            "give its path relative to the folder of the main file, or of the one that includes it",
        )
    })?;
    let root = xml::parse(&text, &path)?;
    if root.children.is_empty() {
        return Err(root.invalid("the included file is empty", "remove the include"));
    }
    let folder = name
        .rsplit_once('/')
        .map_or("", |(folder, _)| folder)
        .to_owned();
    Ok(Part { root, folder })
}

fn is_missing(read: &io::Result<String>) -> bool {
    matches!(read, Err(error) if error.kind() == io::ErrorKind::NotFound)
}

/// A path without the parts that lead nowhere: `a/../b` is `b`.
fn plain(path: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match parts.last() {
            _ if part == "." => {}
            Some(last) if part == ".." && !["", ".."].contains(last) => drop(parts.pop()),
            _ => parts.push(part),
        }
    }
    parts.join("/")
}
