//! What passes through the joints of a tree.
//!
//! A joint passes on what moves all bodies beyond it: λ = Σ M δ over the subtree.

use super::joint::{Ends, within_caps};
use super::tables::{Tables, borne, inbound, joint_field, mass, row_link};
use super::tree::about_centre;
use numbers::machine::Index;
use numbers::spatial::Spatial;
use numbers::{Cell, Machine, Real, Vec3};

/// A cap that takes away less than this share has been met.
const NEARLY: f64 = 1.0 - 1e-5;

/// Empties the sums that [`through`] adds to.
#[inline(always)]
pub(crate) fn clear<M: Machine>(k: &mut M, t: &Tables) {
    for row in k.count(t.rows) {
        k.store_spatial(t.load, row, 0, Spatial::zero());
    }
}

/// Moment and force, times h², through the joint that carries a body, about its anchor; the body
/// has moved as given. Bodies beyond must have had their turn.
#[inline(always)]
pub(crate) fn through<M: Machine>(
    k: &mut M,
    t: &Tables,
    row: M::I,
    moved: Spatial<M::R>,
) -> Spatial<M::R> {
    let pose = k.pose(t.pose, row, 0);
    let m = k.load(t.mass, row, mass::MASS);
    let turn = pose.q.rotate_inverse(moved.angular);
    let own = Spatial::new(
        pose.q
            .rotate(turn.times(k.vec3(t.mass, row, mass::MOMENTS))),
        moved.linear * m,
    );
    let j = k.link(t.row_links, row, row_link::JOINT);
    let acts = k.load(t.joint, j, joint_field::ENABLED);
    let f = (own + k.spatial(t.load, row, 0)) * acts;
    let parent = k.link(t.row_links, row, row_link::PARENT);
    let s = pose.p - k.vec3(t.pose, parent, 0);
    let passed = Spatial::new(f.angular + s.cross(f.linear), f.linear);
    let sum = k.spatial(t.load, parent, 0) + passed;
    k.store_spatial(t.load, parent, 0, sum);
    let arm = pose.q.rotate(k.vec3(t.mass, row, mass::ANCHOR));
    Spatial::new(f.angular - arm.cross(f.linear), f.linear)
}

/// Starts a substep, in which no joint has borne anything yet.
#[inline(always)]
pub(crate) fn unburden<M: Machine>(k: &mut M, t: &Tables) {
    if t.capped_at_all {
        for row in k.count(t.rows) {
            k.store_vec3(t.borne, row, borne::BEFORE, Vec3::zero());
        }
    }
}

/// Starts a pass with all joints correcting their whole error.
#[inline(always)]
pub(crate) fn uncap<M: Machine>(k: &mut M, t: &Tables) {
    if t.capped_at_all {
        for row in k.count(t.rows) {
            k.store(t.share, row, 0, M::R::one());
        }
    }
}

/// Lets joints that push beyond a cap correct a smaller share of their error, when the pass is
/// done again. Returns where there were none.
#[inline(always)]
pub(crate) fn cap<M: Machine>(k: &mut M, t: &Tables, h: M::R) -> <M::R as Real>::Mask {
    let mut worst = k.cell(M::R::one());
    if t.capped_at_all {
        clear(k, t);
        for i in k.range_down(k.index(t.rows - 1)) {
            let row = i.offset(1);
            let kind = k.link(t.row_links, row, row_link::INBOUND);
            if let Some(_branch) = k.when(k.less(kind, k.index(inbound::ROOT))) {
                let force = through(k, t, row, about_centre(k, t, row)).linear;
                let ends = Ends::load(k, t, k.link(t.row_links, row, row_link::JOINT));
                let before = k.vec3(t.borne, row, borne::BEFORE);
                k.store_vec3(t.borne, row, borne::NOW, force);
                let less = within_caps(k, t, h, &ends, [before, force]);
                let met = less.gt(M::R::lit(NEARLY));
                let less = M::R::select(met, M::R::one(), less);
                k.store(t.share, row, 0, k.load(t.share, row, 0) * less);
                worst.write(worst.read().min(less));
            }
        }
    }
    worst.read().same(M::R::one())
}

/// Counts the joints that a cap held back in a pass, and adds up what all have borne.
#[inline(always)]
pub(crate) fn count_capped<M: Machine>(k: &mut M, t: &Tables) {
    if t.capped_at_all {
        let world = k.index(0);
        for row in k.count(t.rows) {
            let held = k.load(t.share, row, 0).lt(M::R::lit(NEARLY));
            let one = M::R::select(held, M::R::one(), M::R::zero());
            k.add(t.capped, world, 0, one);
            let sum = k.vec3(t.borne, row, borne::BEFORE) + k.vec3(t.borne, row, borne::NOW);
            k.store_vec3(t.borne, row, borne::BEFORE, sum);
        }
    }
}
