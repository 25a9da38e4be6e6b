//! What sensors touch.

use super::Places;
use super::kept::Kept;
use super::tables::{ContactTables, found};
use numbers::{Machine, Vec3};

/// Keeps what the narrow phase found of sensors in the state, to be reported: contacts without force.
#[inline(always)]
pub(crate) fn sense<M: Machine>(
    k: &mut M,
    t: &ContactTables,
    places: &impl Places<M>,
    kept: &Kept,
) {
    for place in t.found.places(k, k.index(found::SENSED)) {
        let s = t.found.row(k, place);
        let touch = t.touch(k, places, s, Vec3::zero());
        kept.keep(k, s, touch);
    }
}
