//! `<include file="…"/>`: one document out of several files (XML reference, "include").

use crate::error::FormatError;
use crate::files::{self, Files};
use crate::xml::{self, Element};
use std::collections::HashSet;

/// Replaces every include below `root` by the children of the root of the file that it names.
///
/// Each file may be included once, as in MuJoCo, so that includes cannot go in circles.
pub(super) fn assemble(root: Element, files: &dyn Files) -> Result<Element, FormatError> {
    let mut included = HashSet::from([root.place.file.to_string()]);
    expand(root, files, &mut included, 1)
}

fn expand(
    mut element: Element,
    files: &dyn Files,
    included: &mut HashSet<String>,
    depth: usize,
) -> Result<Element, FormatError> {
    element.check_depth(depth)?;
    let children = std::mem::take(&mut element.children);
    for child in children {
        if child.name == "include" {
            let part = expand(open(&child, files, included)?, files, included, depth + 1)?;
            element.children.extend(part.children);
        } else {
            element
                .children
                .push(expand(child, files, included, depth + 1)?);
        }
    }
    Ok(element)
}

fn open(
    include: &Element,
    files: &dyn Files,
    included: &mut HashSet<String>,
) -> Result<Element, FormatError> {
    let name = include.require("file")?;
    let path = files.path(name);
    if !included.insert(path.clone()) {
        return Err(include.invalid_attribute(
            "file",
            &format!("names `{name}`, which is already part of the model"),
            "include each file once, and no file from within itself",
        ));
    }
    let text = files::read(files, name).map_err(|error| match error {
        FormatError::Read { file, source } => include.invalid_attribute(
            "file",
            &format!("names `{file}`, which cannot be read ({source})"),
            "give its path relative to the main file's folder",
        ),
        other => other,
    })?;
    let part = xml::parse(&text, &path)?;
    if part.children.is_empty() {
        return Err(part.invalid("the included file is empty", "remove the include"));
    }
    Ok(part)
}
