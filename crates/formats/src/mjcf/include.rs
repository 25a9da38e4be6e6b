//! `<include file="…"/>`: one document out of several files (XML reference, "include").

use crate::error::FormatError;
use crate::files::Files;
use crate::xml::{self, Element};
use std::collections::HashSet;
use std::io;

/// Replaces every include below `root` by the children of the root of the file that it names.
///
/// Each file may be included once, as in MuJoCo, so that includes cannot go in circles.
pub(super) fn assemble(root: Element, files: &dyn Files) -> Result<Element, FormatError> {
    let mut included = HashSet::from([plain(&root.place.file)]);
    expand(root, "", files, &mut included, 1)
}

/// `folder` is that of the element's file, seen from the main one.
fn expand(
    mut element: Element,
    folder: &str,
    files: &dyn Files,
    included: &mut HashSet<String>,
    depth: usize,
) -> Result<Element, FormatError> {
    element.check_depth(depth)?;
    for child in std::mem::take(&mut element.children) {
        if child.name == "include" {
            let (part, folder) = open(&child, folder, files, included)?;
            let part = expand(part, &folder, files, included, depth + 1)?;
            element.children.extend(part.children);
        } else {
            let child = expand(child, folder, files, included, depth + 1)?;
            element.children.push(child);
        }
    }
    Ok(element)
}

/// The file that an include names, and its folder: beside the main one, or else in `folder`, beside that which includes it.
fn open(
    include: &Element,
    folder: &str,
    files: &dyn Files,
    included: &mut HashSet<String>,
) -> Result<(Element, String), FormatError> {
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
    Ok((root, folder))
}

fn is_missing(read: &io::Result<String>) -> bool {
    matches!(read, Err(error) if error.kind() == io::ErrorKind::NotFound)
}

/// A path without the parts that lead nowhere: `a/../b` is `b`, and `a/..` is `.`.
fn plain(path: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match parts.last() {
            _ if part == "." => {}
            Some(last) if part == ".." && !["", ".."].contains(last) => drop(parts.pop()),
            _ => parts.push(part),
        }
    }
    if parts.is_empty() {
        return ".".to_owned();
    }
    parts.join("/")
}
