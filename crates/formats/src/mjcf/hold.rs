//! A joint that is held at a value: `<equality>`'s `<joint>` without a second one (XML reference, "equality/joint").
//!
//! MuJoCo's constraint is a limit's [law](crate::limit) that pulls as it pushes: to the inertia m of the degree of freedom
//!
//! ```text
//! (m + m') a = m a₀ − m' (k r + b v)
//! ```
//!
//! is a spring of stiffness m' k, a damper m' b and an armature m', with the impedance at half the width, whatever the load.

use super::joint::solref;
use super::option::Physics;
use crate::error::FormatError;
use crate::impedance::Impedance;
use crate::limit::Softness;
use crate::xml::Element;
use model::Dof;

/// What makes it soft.
pub(super) const KNOWN: &[&str] = &["solref", "solimp"];
pub(super) const UNUSED: &[(&str, &str)] = &[("torquescale", "of welds only")];

/// Holds a degree of freedom that shows `inertia` [kg or kg·m²], beside a spring that it may have.
pub(super) fn at(
    element: &Element,
    value: f64,
    inertia: f64,
    physics: &Physics,
    dof: &mut Dof,
) -> Result<(), FormatError> {
    let softness = Softness {
        reference: solref(element, "solref")?,
        impedance: Impedance::read(element, "solimp")?,
    };
    let law = softness.limit((value, value), inertia, physics.least_time());
    let moment = dof.stiffness * dof.rest + law.stiffness * value;
    dof.stiffness += law.stiffness;
    if dof.stiffness > 0.0 {
        dof.rest = moment / dof.stiffness;
    }
    dof.damping += law.damping;
    dof.armature += law.inertia;
    Ok(())
}
