//! Which contacts with a mesh are kept.
//!
//! Of all points those are kept that lie farthest in the eight corners of the first one's own frame,
//! which span what it rests on, and stay the same while it rests; and the deepest.

use super::piece::is_turned;
use super::tables::{BEHIND, CORNERS, MeshTables, NUMBERS, SLOTS, contact, search};
use crate::{FAR, Manifold, Placed, Point};
use numbers::{Cell, Machine, Real, Vec3};

/// How deep a point counts against how far out it lies.
const DEPTH: f64 = 4.0;
/// What the number of a triangle counts for, against the size: so that rounding does not choose between two that
/// share a corner, and the same is taken in each step.
const PREFERRED: f64 = 1e-4;
/// Contacts closer than this, against the solid's size, with one normal, are one.
const MERGED: f64 = 1e-3;
/// By how much deeper than the least deep a contact has to be, against the solid's size, to be doubted.
const DOUBTED: f64 = 0.01;

/// Nothing is known yet.
#[inline(always)]
pub(super) fn forget<M: Machine>(k: &mut M, meshes: &MeshTables) {
    let first = k.index(0);
    k.store(meshes.search, first, search::GAP, M::R::lit(-FAR));
    k.store(meshes.search, first, search::AGAIN, M::R::zero());
}

/// Nothing is found yet in this round.
#[inline(always)]
pub(super) fn begin<M: Machine>(k: &mut M, meshes: &MeshTables) {
    let first = k.index(0);
    k.store(meshes.search, first, search::PIERCED, M::R::zero());
    for slot in k.count(SLOTS + 1) {
        let mut unused = [M::R::zero(); contact::WIDTH];
        unused[contact::DISTANCE] = M::R::lit(FAR);
        unused[contact::SCORE] = M::R::lit(-FAR);
        k.write(meshes.contacts, slot, 0, unused);
    }
}

/// Puts the points of a manifold where they lie farther out than what was kept; in the lanes of the second
/// mask they are those of a solid behind the triangle.
#[inline(always)]
pub(super) fn keep<M: Machine>(
    k: &mut M,
    meshes: &MeshTables,
    whole: &Placed<M::R>,
    manifold: &Manifold<M::R>,
    number: M::R,
    [mask, behind]: [<M::R as Real>::Mask; 2],
    margin: M::R,
) {
    let n = manifold.normal;
    let preferred = whole.size.length() * number * M::R::lit(PREFERRED / NUMBERS);
    for i in 0..4 {
        let point = manifold.points[i];
        let x = whole.local_point(point.position);
        let near = point.distance.lt(margin);
        let (touches, behind) = (mask & near, behind & near);
        // Sixty-four features a triangle.
        let turns = (point.feature * M::R::lit(1.0 / 64.0)).floor();
        let local = turns.fma(M::R::lit(-64.0), point.feature);
        let feature = number.fma(M::R::lit(64.0), local);
        let p = point.position;
        let new = [p.x, p.y, p.z, n.x, n.y, n.z, point.distance, feature];
        if let Some(_branch) = k.if_any(touches) {
            for slot in 0..CORNERS {
                let (a, b, c) = (slot & 1, slot >> 1 & 1, slot >> 2);
                let score = toward(x.x, a) + toward(x.y, b) + toward(x.z, c);
                let score = point.distance.fma(M::R::lit(-DEPTH), score + preferred);
                offer(k, meshes, slot, new, score, touches);
            }
            let score = preferred - point.distance;
            offer(k, meshes, CORNERS, new, score, touches);
        }
        if let Some(_branch) = k.if_any(behind) {
            offer(k, meshes, BEHIND, new, point.distance, behind);
        }
    }
}

/// Notes a contact of a triangle that is pierced, to be taken where there is no other.
#[inline(always)]
pub(super) fn note<M: Machine>(
    k: &mut M,
    meshes: &MeshTables,
    n: Vec3<M::R>,
    point: &Point<M::R>,
    number: M::R,
    mask: <M::R as Real>::Mask,
) {
    let (p, feature) = (point.position, number * M::R::lit(64.0));
    let new = [p.x, p.y, p.z, n.x, n.y, n.z, point.distance, feature];
    offer(k, meshes, BEHIND, new, point.distance, mask);
}

/// Remembers the normal of a contact with a triangle that the core overlaps, if it is the least deep.
#[inline(always)]
pub(super) fn remember<M: Machine>(
    k: &mut M,
    meshes: &MeshTables,
    n: Vec3<M::R>,
    gap: M::R,
    mask: <M::R as Real>::Mask,
) {
    let first = k.index(0);
    let least = mask & gap.gt(k.load(meshes.search, first, search::GAP));
    for (field, x) in [n.x, n.y, n.z, gap].into_iter().enumerate() {
        k.store_where(least, meshes.search, first, search::NORMAL + field, x);
    }
}

/// Whether no contact is to be doubted; where one is, the next round does.
///
/// A triangle alone may be left in several ways, and the one that lies nearest to its own normal may be far deeper than
/// what frees the solid of it and of its neighbours, too: the contact of one of these tells that.
#[inline(always)]
pub(super) fn review<M: Machine>(
    k: &mut M,
    meshes: &MeshTables,
    whole: &Placed<M::R>,
) -> <M::R as Real>::Mask {
    let (first, deepest) = (k.index(0), k.index(CORNERS));
    let least = k.load(meshes.search, first, search::GAP);
    let most = k.load(meshes.contacts, deepest, contact::DISTANCE);
    let doubted = most.lt(whole.size.length().fma(M::R::lit(-DOUBTED), least));
    let again = M::R::select(doubted, M::R::one(), M::R::zero());
    k.store(meshes.search, first, search::AGAIN, again);
    !doubted
}

/// `x` or `−x`.
#[inline(always)]
fn toward<R: Real>(x: R, side: usize) -> R {
    if side == 0 { -x } else { x }
}

/// Replaces the contact in a slot by one of a higher score.
#[inline(always)]
fn offer<M: Machine>(
    k: &mut M,
    meshes: &MeshTables,
    slot: usize,
    new: [M::R; contact::SCORE],
    score: M::R,
    mask: <M::R as Real>::Mask,
) {
    let row = k.index(slot);
    let old: [M::R; contact::WIDTH] = k.read(meshes.contacts, row, 0);
    let better = mask & score.gt(old[contact::SCORE]);
    let mut chosen = old;
    for f in 0..contact::SCORE {
        chosen[f] = M::R::select(better, new[f], old[f]);
    }
    chosen[contact::SCORE] = M::R::select(better, score, old[contact::SCORE]);
    k.write(meshes.contacts, row, 0, chosen);
}

/// Drops the deepest contact where one in a corner is as deep, within `close`: which of them it is would change
/// from step to step. Takes that of what is behind a triangle where the solid pierces others that have none.
#[inline(always)]
fn complete<M: Machine>(k: &mut M, meshes: &MeshTables, close: M::R) {
    let (first, deepest, behind) = (k.index(0), k.index(CORNERS), k.index(BEHIND));
    let mut least = k.cell(M::R::lit(FAR));
    for slot in k.count(CORNERS) {
        let distance = k.load(meshes.contacts, slot, contact::DISTANCE);
        least.write(least.read().min(distance));
    }
    let (least, distance) = (least.read(), contact::DISTANCE);
    let as_deep = (least - close).lt(k.load(meshes.contacts, deepest, distance));
    k.store_where(as_deep, meshes.contacts, deepest, distance, M::R::lit(FAR));
    let pierced = k.load(meshes.search, first, search::PIERCED);
    let pierced = pierced.gt(M::R::zero());
    let none = least.gt(M::R::lit(0.5 * FAR)) & pierced;
    if let Some(_branch) = k.if_any(none) {
        let contact: [M::R; contact::SCORE] = k.read(meshes.contacts, behind, 0);
        offer(k, meshes, 0, contact, M::R::zero(), none);
    }
}

/// Drops what is kept twice, and turns the rest into world axes.
#[inline(always)]
pub(super) fn finish<M: Machine>(
    k: &mut M,
    meshes: &MeshTables,
    whole: &Placed<M::R>,
    placed: &Placed<M::R>,
) {
    let close = whole.size.length() * M::R::lit(MERGED);
    complete(k, meshes, close);
    for later in 1..SLOTS {
        for earlier in 0..later {
            let (p, q) = (k.index(earlier), k.index(later));
            let p: [M::R; contact::DISTANCE + 1] = k.read(meshes.contacts, p, 0);
            let here: [M::R; contact::DISTANCE + 1] = k.read(meshes.contacts, q, 0);
            let way = Vec3::new(p[0] - here[0], p[1] - here[1], p[2] - here[2]);
            let normals = [
                Vec3::new(p[3], p[4], p[5]),
                Vec3::new(here[3], here[4], here[5]),
            ];
            let twice = p[contact::DISTANCE].lt(M::R::lit(0.5 * FAR))
                & way.length_squared().lt(close.squared())
                & !is_turned(normals[0], normals[1]);
            k.store_where(twice, meshes.contacts, q, contact::DISTANCE, M::R::lit(FAR));
        }
    }
    for slot in k.count(SLOTS) {
        let position = placed.point(k.vec3(meshes.contacts, slot, contact::POSITION));
        let normal = placed.direction(k.vec3(meshes.contacts, slot, contact::NORMAL));
        k.store_vec3(meshes.contacts, slot, contact::POSITION, position);
        k.store_vec3(meshes.contacts, slot, contact::NORMAL, normal);
    }
}
