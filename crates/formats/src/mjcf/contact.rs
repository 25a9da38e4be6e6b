//! Which pairs of geoms may touch: `<contact>`, and the geoms' contype and conaffinity.

use super::tree::Tree;
use crate::report::Report;
use crate::xml::Element;
use std::collections::HashSet;

/// Notes pairs that the file keeps apart, or together, and the model's collision groups do not.
pub(super) fn check(root: &Element, tree: &Tree, report: &mut Report) {
    for rule in root
        .children_named("contact")
        .flat_map(|section| &section.children)
    {
        let meaning = match rule.name.as_str() {
            "exclude" => "the two bodies may touch",
            _ => "the two geoms touch as any others do",
        };
        report.note(rule, "pair of its own", meaning);
    }
    let masks: HashSet<_> = tree.masks.iter().collect();
    let apart = masks.iter().any(|a| {
        let mut others = masks.iter().filter(|b| a.2 || b.2);
        others.any(|b| (a.0 & b.1) == 0 && (b.0 & a.1) == 0)
    });
    if apart {
        let world = root.child("worldbody").unwrap_or(root);
        report.note(
            world,
            "contype and conaffinity",
            "geoms that they keep apart may touch",
        );
    }
}
