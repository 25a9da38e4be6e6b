//! Rows of constraints on the tree's own factor.
//!
//! The articulated-body algorithm factors the inertia of the whole tree, with its springs, dampers
//! and contacts with the ground: M = (L D) Lᵀ in the order in which it eliminates the degrees of
//! freedom. A row of a Jacobian J, the velocity of a node B less that of a node A along one direction d at x,
//! becomes
//!
//! ```text
//! y = D^-½ L⁻¹ Jᵀ      (walk inwards with the wrench w of d at x:  u = Sᵀ w,  y = u / √D,  w ← w − U u / D)
//! ```
//!
//! which has entries on the paths from the two nodes to the world only, and J M⁻¹ Jᵀ = Y Yᵀ. Where the paths
//! meet, the wrenches of both sides are added, and walk on as one: y is linear in w. Impulses λ are added up as
//! z = Yᵀ λ, so that the velocity of any row is what it was, and y · z more. In the end one walk outwards turns z
//! into accelerations: q̇ᵢ = zᵢ / √Dᵢ − Uᵢᵀ v / Dᵢ.

use super::contact::rate;
use super::tables::{Tables, couple_link, dof, frame, node_link};
use numbers::machine::{Held, Hold, Index};
use numbers::spatial::Spatial;
use numbers::{Machine, Mat3, Real, Vec3};

/// Fields of [`Tables::response`], a row for each degree of freedom.
pub(crate) mod response {
    /// z.
    pub const Z: usize = 0;
    /// 1 / √D.
    pub const ROOT: usize = 1;
    /// y of a row that is set against others; else zero.
    pub const ROW: usize = 2;
    pub const WIDTH: usize = 3;
}

/// The degrees of freedom that move either node of a pair: A's own, B's own, then those of both.
#[derive(Clone, Copy)]
pub(super) struct Path<I> {
    names: I,
    own_a: I,
    own: I,
    entries: I,
}

impl<I: Index> Path<I> {
    /// That of a row of [`Tables::couple_links`].
    #[inline(always)]
    pub fn of<M: Machine<I = I>>(k: &M, t: &Tables, couple: I) -> Self {
        Self {
            names: k.link(t.couple_links, couple, couple_link::ENTRY_BEGIN),
            own_a: k.link(t.couple_links, couple, couple_link::OWN_A),
            own: k.link(t.couple_links, couple, couple_link::OWN),
            entries: k.link(t.couple_links, couple, couple_link::ENTRIES),
        }
    }
    /// The entries in turn.
    #[inline(always)]
    pub fn entries<M: Machine<I = I>>(&self, k: &M) -> M::Rounds {
        k.range(k.index(0), self.entries)
    }
    /// First of A's own entries, and one past the last.
    #[inline(always)]
    pub fn own_of_a<M: Machine<I = I>>(&self, k: &M) -> [I; 2] {
        [k.index(0), self.own_a]
    }
    /// The same of B's own.
    #[inline(always)]
    pub fn own_of_b(&self) -> [I; 2] {
        [self.own_a, self.own]
    }
    /// The same of those that both share.
    #[inline(always)]
    pub fn shared(&self) -> [I; 2] {
        [self.own, self.entries]
    }
    /// Degree of freedom of an entry.
    #[inline(always)]
    pub fn dof<M: Machine<I = I>>(&self, k: &M, t: &Tables, entry: I) -> I {
        k.link(t.entry_links, self.names.plus(entry), 0)
    }
}

/// Where the y of three rows are kept.
pub(super) trait Keep<M: Machine> {
    /// Those of an entry of the path.
    fn keep(&self, k: &mut M, entry: M::I, y: Vec3<M::R>);
}

/// Where A's tree has a point that is at `x` in B's.
#[inline(always)]
pub(super) fn seen_from_a<M: Machine>(
    k: &M,
    t: &Tables,
    couple: M::I,
    x: Vec3<M::R>,
) -> Vec3<M::R> {
    let [a, b] = k.link_row::<_, 2>(t.couple_links, couple);
    x + (k.vec3(t.point, b, 0) - k.vec3(t.point, a, 0))
}

/// Nothing presses on any node yet.
#[inline(always)]
pub(super) fn clear<M: Machine>(k: &mut M, t: &Tables) {
    for n in k.count(t.trees + t.nodes) {
        k.store_spatial(t.pressure, n, 0, Spatial::zero());
    }
}

/// Lets a wrench act on B, whose force is at x, and its reaction on A.
#[inline(always)]
pub(super) fn press<M: Machine>(
    k: &mut M,
    t: &Tables,
    couple: M::I,
    x: Vec3<M::R>,
    wrench: Spatial<M::R>,
) {
    let Spatial {
        angular: m,
        linear: f,
    } = wrench;
    let x_a = seen_from_a(k, t, couple, x);
    let a = k.link(t.couple_links, couple, couple_link::NODE_A);
    let b = k.link(t.couple_links, couple, couple_link::NODE_B);
    let sum = k.spatial(t.pressure, b, 0) + Spatial::new(x.cross_plus(f, m), f);
    k.store_spatial(t.pressure, b, 0, sum);
    let sum = k.spatial(t.pressure, a, 0) - Spatial::new(x_a.cross_plus(f, m), f);
    k.store_spatial(t.pressure, a, 0, sum);
}

/// Starts with no impulses.
#[inline(always)]
pub(super) fn begin<M: Machine>(k: &mut M, t: &Tables) {
    for v in k.count(t.dofs) {
        let root = k.load(t.dof, v, dof::INVERSE).sqrt();
        let zero = M::R::zero();
        k.write(t.response, v, response::Z, [zero, root, zero]);
    }
}

/// Wrenches of three rows on a node.
pub(super) type Wrenches<R> = [Spatial<R>; 3];

/// Those of forces along three directions at a point.
#[inline(always)]
pub(super) fn forces<R: Real>(x: Vec3<R>, e: Mat3<R>) -> Wrenches<R> {
    [
        Spatial::new(x.cross(e.x), e.x),
        Spatial::new(x.cross(e.y), e.y),
        Spatial::new(x.cross(e.z), e.z),
    ]
}

/// Those of moments about three directions.
#[inline(always)]
pub(super) fn moments<R: Real>(e: Mat3<R>) -> Wrenches<R> {
    [
        Spatial::new(e.x, Vec3::zero()),
        Spatial::new(e.y, Vec3::zero()),
        Spatial::new(e.z, Vec3::zero()),
    ]
}

/// y of three rows, given their wrenches on A and on B; returns their squares y · y.
#[inline(always)]
pub(super) fn rows<M: Machine>(
    k: &mut M,
    t: &Tables,
    path: Path<M::I>,
    to: &impl Keep<M>,
    [on_a, on_b]: [Wrenches<M::R>; 2],
) -> Vec3<M::R> {
    let mut square = Vec3::zero().hold(k);
    let mut a = hold(k, on_a);
    walk(k, t, path, to, path.own_of_a(k), &mut a, &mut square);
    let mut b = hold(k, on_b);
    walk(k, t, path, to, path.own_of_b(), &mut b, &mut square);
    let both = [
        a[0].get() + b[0].get(),
        a[1].get() + b[1].get(),
        a[2].get() + b[2].get(),
    ];
    let mut both = hold(k, both);
    walk(k, t, path, to, path.shared(), &mut both, &mut square);
    square.get()
}

#[inline(always)]
fn hold<M: Machine>(k: &M, [x, y, z]: Wrenches<M::R>) -> [Spatial<M::Cell>; 3] {
    [x.hold(k), y.hold(k), z.hold(k)]
}

/// Walks inwards along some of a path's entries with three wrenches.
#[inline(always)]
fn walk<M: Machine>(
    k: &mut M,
    t: &Tables,
    path: Path<M::I>,
    to_keep: &impl Keep<M>,
    [from, to]: [M::I; 2],
    wrenches: &mut [Spatial<M::Cell>; 3],
    square: &mut Vec3<M::Cell>,
) {
    let [one, two, three] = wrenches;
    for i in k.range(from, to) {
        let v = path.dof(k, t, i);
        let (axis, u) = (k.spatial(t.dof, v, dof::AXIS), k.spatial(t.dof, v, dof::U));
        let inverse = k.load(t.dof, v, dof::INVERSE);
        let along = Vec3::new(
            axis.dot(one.get()),
            axis.dot(two.get()),
            axis.dot(three.get()),
        );
        let share = along * -inverse;
        one.set(u.fma(share.x, one.get()));
        two.set(u.fma(share.y, two.get()));
        three.set(u.fma(share.z, three.get()));
        let y = along * k.load(t.response, v, response::ROOT);
        to_keep.keep(k, i, y);
        square.set(y.times(y) + square.get());
    }
}

/// Walks outwards: adds what z means to the accelerations.
#[inline(always)]
pub(super) fn respond<M: Machine>(k: &mut M, t: &Tables) {
    let rate = rate(k, t);
    for tree in k.count(t.trees) {
        k.store_spatial(t.frame, tree, frame::INCREMENT, Spatial::zero());
    }
    for n in k.range(k.index(t.trees), k.index(t.trees + t.nodes)) {
        let links = k.link_row::<_, { node_link::WIDTH }>(t.node_links, n);
        let mut a = k
            .spatial(t.frame, links[node_link::PARENT], frame::INCREMENT)
            .hold(k);
        let first = links[node_link::DOF_BEGIN];
        for v in k.range(first, first.plus(links[node_link::DOF_COUNT])) {
            let inverse = k.load(t.dof, v, dof::INVERSE);
            let [z, root] = k.read(t.response, v, response::Z);
            let u = k.spatial(t.dof, v, dof::U).dot(a.get());
            let more = z * rate * root - u * inverse;
            k.add(t.dof, v, dof::ACCELERATION, more);
            let moved = k.spatial(t.dof, v, dof::AXIS).fma(more, a.get());
            a.set(moved);
        }
        let a = a.get();
        k.store_spatial(t.frame, n, frame::INCREMENT, a);
        let sum = k.spatial(t.frame, n, frame::ACCELERATION) + a;
        k.store_spatial(t.frame, n, frame::ACCELERATION, sum);
    }
}
