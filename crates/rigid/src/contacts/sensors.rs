//! What sensors touch.

use super::Places;
use super::tables::{ContactTables, slot, slot_link};
use crate::output::contact;
use collide::FAR;
use numbers::machine::space::State;
use numbers::{Machine, Real, Table};

/// Keeps what the narrow phase found of sensors in the state, to be reported: contacts without force.
#[inline(always)]
pub(crate) fn sense<M: Machine>(
    k: &mut M,
    t: &ContactTables,
    places: &impl Places<M>,
    touch: Table<State, { contact::WIDTH }>,
) {
    let (far, half, zero) = (M::R::lit(FAR), M::R::lit(0.5 * FAR), M::R::zero());
    for s in k.range(k.index(t.sensed), k.index(t.slots)) {
        let distance = k.load(t.slot, s, slot::DISTANCE);
        let kept = k.load(touch, s, contact::DISTANCE);
        if let Some(_branch) = k.if_any(distance.min(kept).lt(half)) {
            let [x, y, z, l, m, n, _, feature] = k.read(t.slot, s, 0);
            let origin = places.origin(k, k.link(t.slot_links, s, slot_link::GROUP));
            let distance = M::R::select(distance.lt(half), distance, far);
            let [x, y, z] = [x + origin.x, y + origin.y, z + origin.z];
            let row = [x, y, z, l, m, n, distance, feature, zero, zero, zero];
            k.write(touch, s, 0, row);
        }
    }
}
