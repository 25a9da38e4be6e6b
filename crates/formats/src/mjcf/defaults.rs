//! `<default>`: classes of attributes that elements inherit (modeling guide, "Default settings").

use super::orientation::ORIENTATIONS;
use super::{actuator, assets, camera, contact, equality, geom, joint, light, site, tendon};
use crate::error::FormatError;
use crate::report::Report;
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
    pub fn read(root: &Element, report: &mut Report) -> Result<Self, FormatError> {
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
            defaults.read_class(section, 0, report)?;
        }
        Ok(defaults)
    }

    fn read_class(
        &mut self,
        element: &Element,
        row: usize,
        report: &mut Report,
    ) -> Result<(), FormatError> {
        report.check_attributes(element, &["class"], &[])?;
        for child in &element.children {
            if child.name != "default" {
                check(child, report)?;
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
            self.read_class(child, inner, report)?;
        }
        Ok(())
    }

    /// The settings that an element inherits from its own class, or else `childclass`: those for
    /// elements of `names`, class by class from the outermost inwards.
    pub fn classes<'a>(
        &'a self,
        element: &Element,
        childclass: Option<&str>,
        names: &[&str],
    ) -> Result<Vec<Vec<&'a Element>>, FormatError> {
        let mut row = Some(match (element.get("class"), childclass) {
            (Some(_), _) => self.row(element, "class")?,
            (None, Some(class)) => self.rows.get(class).copied().unwrap_or(0),
            (None, None) => 0,
        });
        let mut classes = Vec::new();
        while let Some(i) = row {
            let settings = self.classes[i].settings.iter();
            let of_names = settings.filter(|setting| names.contains(&setting.name.as_str()));
            classes.push(of_names.collect());
            row = self.classes[i].parent;
        }
        classes.reverse();
        Ok(classes)
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
        let classes = self.classes(element, childclass, names)?;
        Ok(inherit(element, &classes.concat()))
    }
}

/// Refuses settings, and attributes of them, that no class has, whether anything is of the class or not.
fn check(setting: &Element, report: &mut Report) -> Result<(), FormatError> {
    let known = match setting.name.as_str() {
        "mesh" => with_unused(assets::MESH, assets::MESH_UNUSED),
        "material" => assets::MATERIAL.to_vec(),
        "joint" => with_unused(joint::KNOWN, joint::UNUSED),
        "geom" => geom::KNOWN.to_vec(),
        "site" => [site::KNOWN, ORIENTATIONS].concat(),
        "camera" => with_unused(&[camera::KNOWN, ORIENTATIONS].concat(), camera::UNUSED),
        "light" => with_unused(light::KNOWN, light::UNUSED),
        "pair" => with_unused(contact::PAIR, contact::PAIR_UNUSED),
        "equality" => with_unused(equality::KNOWN, equality::UNUSED),
        "tendon" => tendon::KNOWN.to_vec(),
        kind if actuator::KINDS.contains(&kind) => actuator::known(kind),
        kind if kind == "texture" || actuator::OTHERS.contains(&kind) => return Ok(()),
        _ => {
            let remedy = "correct its spelling, or remove it";
            return Err(setting.invalid("a default class holds no such element", remedy));
        }
    };
    let of_one = ["name", "class"];
    let known: Vec<_> = known
        .into_iter()
        .filter(|name| !of_one.contains(name))
        .collect();
    report.check_attributes(setting, &known, &[])
}

/// Those that are read, and those that are noted where they are used.
fn with_unused<'a>(read: &[&'a str], unused: &[(&'a str, &str)]) -> Vec<&'a str> {
    let unused = unused.iter().map(|(name, _)| *name);
    read.iter().copied().chain(unused).collect()
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
