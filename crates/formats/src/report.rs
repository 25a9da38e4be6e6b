//! What a file uses and the reader does not: listed once per kind, refused where it matters.

use crate::error::{FormatError, Place};
use crate::xml::Element;
use std::collections::HashSet;
use std::fmt;

/// Something in a file that was left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// File it is in.
    pub file: String,
    /// Line of its first occurrence, from 1.
    pub line: u32,
    /// Name of the element.
    pub element: String,
    /// What was left out, and what that means.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}:{}: <{}>: {}",
            self.file, self.line, self.element, self.message
        )
    }
}

/// Collects warnings, and turns what would change the physics into errors unless lenient.
pub(crate) struct Report {
    lenient: bool,
    warnings: Vec<Warning>,
    seen: HashSet<(String, String)>,
}

impl Report {
    pub fn new(lenient: bool) -> Self {
        Self {
            lenient,
            warnings: Vec::new(),
            seen: HashSet::new(),
        }
    }

    pub fn is_lenient(&self) -> bool {
        self.lenient
    }

    /// Notes that `what` of an element is left out, the first time that this kind of thing is met.
    pub fn note(&mut self, element: &Element, what: &str, meaning: &str) {
        self.note_at(&element.place, element, what, meaning);
    }

    fn note_at(&mut self, place: &Place, element: &Element, what: &str, meaning: &str) {
        if self.seen.insert((element.name.clone(), what.to_owned())) {
            self.warnings.push(Warning {
                file: place.file.to_string(),
                line: place.line,
                element: element.name.clone(),
                message: format!("{what}: {meaning}"),
            });
        }
    }

    /// Notes one of several things of a kind. All are in one warning for each file, at the line of the first; the others
    /// have their lines behind them.
    pub fn list(&mut self, element: &Element, what: &str, item: &str) {
        let message = format!("{what}: {item}");
        // Whatever element it is met in.
        if !self.seen.insert((String::new(), message.clone())) {
            return;
        }
        let (file, line) = (element.place.file.to_string(), element.place.line);
        let is_list =
            |w: &&mut Warning| w.file == file && w.message.starts_with(&format!("{what}: "));
        match self.warnings.iter_mut().find(is_list) {
            Some(list) => list.message += &format!("; {item} (line {line})"),
            None => self.warnings.push(Warning {
                file,
                line,
                element: element.name.clone(),
                message,
            }),
        }
    }

    /// Refuses a feature that the motion depends on; lenient, it is noted and left out.
    pub fn refuse(
        &mut self,
        element: &Element,
        feature: &str,
        remedy: &str,
    ) -> Result<(), FormatError> {
        self.refuse_at(&element.place, element, feature, remedy)
    }

    fn refuse_at(
        &mut self,
        place: &Place,
        element: &Element,
        feature: &str,
        remedy: &str,
    ) -> Result<(), FormatError> {
        if self.lenient {
            let meaning = "left out although it changes the physics";
            self.note_at(place, element, feature, meaning);
            return Ok(());
        }
        Err(FormatError::Unsupported {
            place: place.clone(),
            element: element.name.clone(),
            feature: feature.to_owned(),
            remedy: remedy.to_owned(),
        })
    }

    /// Checks that every attribute is one of `known`; notes those of `unused`, with the reason given
    /// there, where they stand: inherited ones in the defaults.
    pub fn check_attributes(
        &mut self,
        element: &Element,
        known: &[&str],
        unused: &[(&str, &str)],
    ) -> Result<(), FormatError> {
        for attribute in &element.attributes {
            let name = attribute.name.as_str();
            let what = format!("attribute `{name}`");
            if let Some((_, meaning)) = unused.iter().find(|(n, _)| *n == name) {
                self.note_at(&attribute.place, element, &what, meaning);
            } else if !known.contains(&name) {
                let remedy =
                    "correct its spelling if it is misspelt, remove it if it is not needed";
                self.refuse_at(&attribute.place, element, &what, remedy)?;
            }
        }
        Ok(())
    }

    /// The warnings, by file and line.
    pub fn into_warnings(mut self) -> Vec<Warning> {
        self.warnings
            .sort_by(|a, b| (&a.file, a.line).cmp(&(&b.file, b.line)));
        self.warnings
    }
}
