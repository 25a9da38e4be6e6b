//! A body and all that it carries, as the pass over a tree sees it.

use super::tables::{Tables, motion};
use core::ops::Add;
use numbers::machine::{Held, Hold};
use numbers::spatial::{Inertia, Spatial};
use numbers::{Machine, Mat3, Real, SymMat3, Vec3};

/// Pivots below this are of a body without mass [kg, kg·m²].
pub(super) const TINY: f64 = 1e-20;

/// Inertia of a body with all that it carries, and what they pull with, about a point that moves
/// with the body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Subtree<R> {
    pub inertia: Inertia<R>,
    pub force: Spatial<R>,
}

/// A motion s that a joint allows: U = Iᴬ S, D = Sᵀ U, and Sᵀ p.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Column<R> {
    u: Spatial<R>,
    d: R,
    p: R,
}

impl<R: Real> Subtree<R> {
    /// A body without the parent's help: m at `c` from the point, with inertia `i` about it.
    #[inline(always)]
    pub fn rigid(m: R, c: Vec3<R>, i: SymMat3<R>) -> Self {
        Self {
            inertia: Inertia::rigid(m, c, i),
            force: Spatial::zero(),
        }
    }
    /// Moves by −e with the parent.
    #[inline(always)]
    pub fn corrected(self, e: Spatial<R>) -> Self {
        Self {
            force: self.force - self.inertia.apply(e),
            ..self
        }
    }
    /// A rotation about the unit vector `s`.
    #[inline(always)]
    pub fn turning(self, s: Vec3<R>) -> Column<R> {
        let Inertia { i, h, .. } = self.inertia;
        let u = Spatial::new(i * s, h.transpose_mul(s));
        Column {
            u,
            d: s.dot(u.angular),
            p: s.dot(self.force.angular),
        }
    }
    /// A shift along the unit vector `s`.
    #[inline(always)]
    pub fn sliding(self, s: Vec3<R>) -> Column<R> {
        let Inertia { h, m, .. } = self.inertia;
        let u = Spatial::new(h * s, m * s);
        Column {
            u,
            d: s.dot(u.linear),
            p: s.dot(self.force.linear),
        }
    }
    /// Lets a motion go, on which its laws pull.
    #[inline(always)]
    pub fn released<M: Machine<R = R>>(
        self,
        k: &mut M,
        t: &Tables,
        row: M::I,
        column: Column<R>,
    ) -> Self {
        let [push, give] = k.read(t.motion, row, motion::PUSH);
        let inverse = (column.d + give).max(R::lit(TINY)).recip();
        self.without(k, t, row, column.u, inverse, push - column.p)
    }
    /// Lets a compliant row, which has pushed before, give way by α/h² times its force.
    #[inline(always)]
    pub fn yielding<M: Machine<R = R>>(
        self,
        k: &mut M,
        t: &Tables,
        row: M::I,
        column: Column<R>,
        pushed: R,
        soft: R,
    ) -> Self {
        let inverse = soft / soft.fma(column.d, R::one());
        self.without(k, t, row, column.u, inverse, -(pushed + column.p))
    }
    /// Eliminates a motion, and keeps what is needed to find it outwards.
    #[inline(always)]
    fn without<M: Machine<R = R>>(
        self,
        k: &mut M,
        t: &Tables,
        row: M::I,
        u: Spatial<R>,
        inverse: R,
        push: R,
    ) -> Self {
        let way = push * inverse;
        k.store_spatial(t.motion, row, motion::U, u);
        k.write(t.motion, row, motion::INVERSE, [inverse, way]);
        Self {
            inertia: self.inertia.minus_outer(u, inverse),
            force: u.fma(way, self.force),
        }
    }
    /// Nothing where the mask holds.
    #[inline(always)]
    pub fn unless(self, mask: R::Mask) -> Self {
        let o = R::zero();
        let mut inertia = self.inertia.to_array();
        for x in &mut inertia {
            *x = R::select(mask, o, *x);
        }
        let Spatial { angular, linear } = self.force;
        let force = Spatial::new(
            Vec3::select(mask, Vec3::zero(), angular),
            Vec3::select(mask, Vec3::zero(), linear),
        );
        Self {
            inertia: Inertia::from_array(inertia),
            force,
        }
    }
    /// About a point from which the present one lies at `s`.
    #[inline(always)]
    pub fn about(self, s: Vec3<R>) -> Self {
        let Spatial { angular, linear } = self.force;
        Self {
            inertia: shifted(self.inertia, s),
            force: Spatial::new(angular + s.cross(linear), linear),
        }
    }
    /// How it moves where nothing holds it: δ = −Iᴬ⁻¹ p.
    #[inline(always)]
    pub fn loose(self) -> Spatial<R> {
        self.inertia.solve(-self.force, R::lit(TINY))
    }
    /// As it lies in `carried`.
    #[inline(always)]
    pub fn load<M: Machine<R = R>>(k: &M, t: &Tables, slot: M::I) -> Self {
        Self {
            inertia: k.inertia(t.carried, slot, 0),
            force: k.spatial(t.carried, slot, 21),
        }
    }
    #[inline(always)]
    pub fn store<M: Machine<R = R>>(&self, k: &mut M, t: &Tables, slot: M::I) {
        k.store_inertia(t.carried, slot, 0, self.inertia);
        k.store_spatial(t.carried, slot, 21, self.force);
    }
}

impl<R: Real> Add for Subtree<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            inertia: self.inertia + other.inertia,
            force: self.force + other.force,
        }
    }
}

/// A subtree on its way through a joint of several motions.
pub(crate) struct Passing<M: Machine> {
    inertia: Inertia<M::Cell>,
    force: Spatial<M::Cell>,
}

impl<M: Machine> Passing<M> {
    #[inline(always)]
    pub fn hold(k: &M, subtree: Subtree<M::R>) -> Self {
        Self {
            inertia: subtree.inertia.hold(k),
            force: subtree.force.hold(k),
        }
    }
    #[inline(always)]
    pub fn get(&self) -> Subtree<M::R> {
        Subtree {
            inertia: self.inertia.get(),
            force: self.force.get(),
        }
    }
    #[inline(always)]
    pub fn set(&mut self, subtree: Subtree<M::R>) {
        self.inertia.set(subtree.inertia);
        self.force.set(subtree.force);
    }
}

/// An inertia about another point, from which the present one lies at `s`:
/// H' = H + s× M and I' = I − H s× + s× H'ᵀ (Featherstone 2008, §2.13).
#[inline(always)]
fn shifted<R: Real>(a: Inertia<R>, s: Vec3<R>) -> Inertia<R> {
    let Inertia { i, h, m } = a;
    let (mx, my, mz) = m.columns();
    let moved = Mat3::from_columns(h.x + s.cross(mx), h.y + s.cross(my), h.z + s.cross(mz));
    let (old, new) = (h.transpose(), moved.transpose());
    let (a, b, c) = (s.cross(old.x), s.cross(old.y), s.cross(old.z));
    let (p, q, r) = (s.cross(new.x), s.cross(new.y), s.cross(new.z));
    let i = SymMat3 {
        xx: i.xx + (a.x + p.x),
        yy: i.yy + (b.y + q.y),
        zz: i.zz + (c.z + r.z),
        xy: i.xy + (a.y + q.x),
        xz: i.xz + (a.z + r.x),
        yz: i.yz + (b.z + r.y),
    };
    Inertia { i, h: moved, m }
}
