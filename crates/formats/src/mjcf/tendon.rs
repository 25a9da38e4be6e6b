//! `<tendon>` (XML reference, "tendon"): only such as exert no force, which are left out.

use super::Context;
use super::joint::Kind;
use super::tree::Tree;
use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;

pub(super) const KNOWN: &[&str] = &[
    "name",
    "class",
    "group",
    "limited",
    "actuatorfrclimited",
    "range",
    "actuatorfrcrange",
    "solreflimit",
    "solimplimit",
    "solreffriction",
    "solimpfriction",
    "margin",
    "frictionloss",
    "springlength",
    "springyield",
    "width",
    "material",
    "rgba",
    "stiffness",
    "damping",
    "armature",
    "user",
];
/// Attributes by which a tendon acts.
const ACTING: &[&str] = &["stiffness", "damping", "frictionloss", "armature"];

/// Notes tendons that exert no force, and refuses those that do.
pub(super) fn check(
    root: &Element,
    tree: &Tree,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<(), FormatError> {
    for tendon in root
        .children_named("tendon")
        .flat_map(|section| &section.children)
    {
        if tendon.name != "fixed" && tendon.name != "spatial" {
            return Err(tendon.invalid("this is no tendon", "write <fixed> or <spatial>"));
        }
        let merged = context.defaults.apply(tendon, None, &["tendon"])?;
        report.check_attributes(&merged, KNOWN, &[])?;
        let range = context.compiler.range(&merged, "limited", "range")?;
        let mut acts = range.is_some();
        for name in ACTING {
            let numbers = merged.list(name, 1, 3)?;
            acts |= numbers.is_some_and(|numbers| numbers.iter().any(|x| *x != 0.0));
        }
        if acts {
            let remedy = "remove the tendon's stiffness, damping, friction, armature and range";
            report.refuse(tendon, "a tendon that exerts force", remedy)?;
        } else {
            report.note(tendon, "tendons", "exert no force; not read");
        }
        // What a path leads along may have been left out of a lenient model.
        if !report.is_lenient() {
            let mut path = tendon.children.iter();
            path.try_for_each(|part| check_path(part, tree))?;
        }
    }
    Ok(())
}

/// Refuses a part of a path along what is not there.
fn check_path(part: &Element, tree: &Tree) -> Result<(), FormatError> {
    match part.name.as_str() {
        "joint" => {
            let joint = tree.joint(part, "joint")?;
            if !matches!(joint.file.kind, Kind::Hinge | Kind::Slide) {
                let problem = "names a ball or free joint";
                return Err(part.invalid_attribute("joint", problem, "name a hinge or a slide"));
            }
            part.require("coef").map(|_| ())
        }
        "site" => tree.site(part, "site").map(|_| ()),
        "geom" => {
            tree.geom(part, "geom")?;
            match part.has("sidesite") {
                true => tree.site(part, "sidesite").map(|_| ()),
                false => Ok(()),
            }
        }
        _ => Ok(()),
    }
}
