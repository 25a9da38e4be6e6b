//! `<default>`: classes of attributes that elements inherit (modeling guide, "Default settings").

use super::orientation::ORIENTATIONS;
use crate::error::FormatError;
use crate::xml::{Attribute, Element};
use std::collections::HashMap;

/// The outermost class, unless the file names it otherwise.
const MAIN: &str = "main";
/// Lists of which an element may give the first numbers alone: behind them stay those of its class.
const PARTIAL: &[&str] = &[
    "size",
    "friction",
    "solref",
    "solimp",
    "solreflimit",
    "solimplimit",
    "gear",
    "damping",
    "stiffness",
    "surfacevel",
];

struct Class {
    parent: Option<usize>,
    settings: Vec<Element>,
}

/// All classes of a file. The first is the outermost.
pub(super) struct Defaults {
    classes: Vec<Class>,
    rows: HashMap<String, usize>,
}

impl Defaults {
    pub fn read(root: &Element) -> Result<Self, FormatError> {
        let outermost = Class {
            parent: None,
            settings: Vec::new(),
        };
        let rows = HashMap::from([(MAIN.to_owned(), 0)]);
        let mut defaults = Self {
            classes: vec![outermost],
            rows,
        };
        for section in root.children_named("default") {
            if let Some(name) = section.get("class") {
                defaults.rows.insert(name.to_owned(), 0);
            }
            defaults.read_class(section, 0)?;
        }
        Ok(defaults)
    }

    fn read_class(&mut self, element: &Element, row: usize) -> Result<(), FormatError> {
        for child in &element.children {
            if child.name != "default" {
                self.classes[row].settings.push(child.clone());
                continue;
            }
            let name = child.require("class")?;
            let inner = self.classes.len();
            if self.rows.insert(name.to_owned(), inner).is_some() {
                return Err(child.invalid_attribute(
                    "class",
                    &format!("is `{name}`, the name of another class"),
                    "rename one of them",
                ));
            }
            self.classes.push(Class {
                parent: Some(row),
                settings: Vec::new(),
            });
            self.read_class(child, inner)?;
        }
        Ok(())
    }

    /// The settings that an element inherits from its own class, or else `childclass`: those for
    /// elements of `names`, from the outermost class inwards.
    pub fn settings<'a>(
        &'a self,
        element: &Element,
        childclass: Option<&str>,
        names: &[&str],
    ) -> Result<Vec<&'a Element>, FormatError> {
        let mut row = Some(match (element.get("class"), childclass) {
            (Some(_), _) => self.row(element, "class")?,
            (None, Some(class)) => self.rows.get(class).copied().unwrap_or(0),
            (None, None) => 0,
        });
        let mut chain = Vec::new();
        while let Some(i) = row {
            chain.push(i);
            row = self.classes[i].parent;
        }
        let settings = chain.iter().rev().flat_map(|i| &self.classes[*i].settings);
        Ok(settings
            .filter(|setting| names.contains(&setting.name.as_str()))
            .collect())
    }

    /// The class that an attribute of an element names, `class` or `childclass`.
    pub fn row(&self, element: &Element, attribute: &str) -> Result<usize, FormatError> {
        let class = element.require(attribute)?;
        self.rows.get(class).copied().ok_or_else(|| {
            element.invalid_attribute(
                attribute,
                &format!("names the default class `{class}`, which does not exist"),
                "define it in <default>, or correct the name",
            )
        })
    }

    /// The element with the attributes that it inherits, without its children.
    pub fn apply(
        &self,
        element: &Element,
        childclass: Option<&str>,
        names: &[&str],
    ) -> Result<Element, FormatError> {
        let settings = self.settings(element, childclass, names)?;
        Ok(inherit(element, &settings))
    }
}

/// An element with the attributes of `settings`, the later ones winning, and its own above all. An
/// orientation of its own replaces an inherited one of any form; a list that is shorter than the inherited one, the
/// first numbers of it.
pub(super) fn inherit(element: &Element, settings: &[&Element]) -> Element {
    let mut merged = Element {
        name: element.name.clone(),
        attributes: Vec::new(),
        children: Vec::new(),
        place: element.place.clone(),
    };
    for level in settings.iter().copied().chain([element]) {
        let turns = |a: &Attribute| ORIENTATIONS.contains(&a.name.as_str());
        if level.attributes.iter().any(turns) {
            merged.attributes.retain(|a| !turns(a));
        }
        let own = level.attributes.iter().map(|own| completed(own, &merged));
        let own: Vec<_> = own.collect();
        merged.inherit_over(&own);
    }
    merged.attributes.retain(|a| a.name != "class");
    merged
}

/// An attribute with the numbers behind its own that the inherited one has.
fn completed(own: &Attribute, inherited: &Element) -> Attribute {
    let mut completed = own.clone();
    if let Some(list) = inherited.get(&own.name)
        && PARTIAL.contains(&own.name.as_str())
    {
        let given: Vec<_> = own.value.split_ascii_whitespace().collect();
        let rest = list.split_ascii_whitespace().skip(given.len());
        completed.value = given
            .iter()
            .copied()
            .chain(rest)
            .collect::<Vec<_>>()
            .join(" ");
    }
    completed
}
