//! `<tendon>` (XML reference, "tendon"): only such as exert no force, which are left out.

use super::Context;
use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;

/// Attributes by which a tendon acts.
const ACTING: &[&str] = &["stiffness", "damping", "frictionloss", "armature"];

/// Notes tendons that exert no force, and refuses those that do.
pub(super) fn check(
    root: &Element,
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
    }
    Ok(())
}
