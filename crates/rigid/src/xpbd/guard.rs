//! Worlds that diverge keep their last finite state.

use super::laws;
use super::tables::{Tables, global};
use crate::contacts::forget_torques;
use numbers::functions::finite;
use numbers::spatial::Spatial;
use numbers::{Cell, Machine, Pose, Quat, Real, Vec3};

/// Positions beyond this are taken for diverged [m].
const FAR: f64 = 1e9;
/// And so are quaternions longer than this, which a pass has turned by several radians.
const LONG: f64 = 2.0;

/// What the bodies of a world are like at the end of a substep.
pub(crate) struct Survey<M: Machine> {
    /// Largest square of a speed, of a distance, of a quaternion, and the sum of all, which is
    /// finite if they are.
    fastest: M::Cell,
    farthest: M::Cell,
    longest: M::Cell,
    sum: M::Cell,
}

impl<M: Machine> Survey<M> {
    #[inline(always)]
    pub fn new(k: &M) -> Self {
        let zero = M::R::zero();
        Self {
            fastest: k.cell(zero),
            farthest: k.cell(zero),
            longest: k.cell(zero),
            sum: k.cell(zero),
        }
    }
    #[inline(always)]
    pub fn restart(&mut self) {
        let zero = M::R::zero();
        self.fastest.write(zero);
        self.farthest.write(zero);
        self.longest.write(zero);
        self.sum.write(zero);
    }
    /// Notes a body.
    #[inline(always)]
    pub fn note(&mut self, pose: Pose<M::R>, twist: Spatial<M::R>) {
        let v = twist.linear.length_squared();
        let w = twist.angular.length_squared();
        let (far, turned) = (pose.p.length_squared(), pose.q.dot(pose.q));
        self.fastest.write(self.fastest.read().max(v).max(w));
        self.farthest.write(self.farthest.read().max(far));
        self.longest.write(self.longest.read().max(turned));
        self.sum.write(self.sum.read() + ((v + w) + (far + turned)));
    }
    /// Notes all bodies anew.
    #[inline(always)]
    pub fn repeat(&mut self, k: &M, t: &Tables) {
        self.restart();
        for row in k.range(k.index(1), k.index(t.rows)) {
            self.note(k.pose(t.pose, row, 0), k.spatial(t.twist, row, 0));
        }
    }
}

/// A lane that has diverged, now or before, keeps its last finite state, and passes on no forces.
#[inline(always)]
pub(crate) fn guard<M: Machine>(k: &mut M, t: &Tables, survey: &Survey<M>) {
    let world = k.index(0);
    let zero = M::R::zero();
    let limit = k.load(t.global, world, global::SPEED_LIMIT);
    let slow = survey.fastest.read().le(limit.squared());
    let near = survey.farthest.read().le(M::R::lit(FAR * FAR));
    let near = near & survey.longest.read().le(M::R::lit(LONG * LONG));
    let fine = slow & near & finite(survey.sum.read());
    let fine = M::R::select(fine, k.load(t.alive, world, 0), zero);
    k.store(t.alive, world, 0, fine);
    let lost = fine.same(M::R::zero());
    if let Some(_branch) = k.if_any(lost) {
        k.store_pose(t.pose, world, 0, Pose::identity());
        k.store_spatial(t.twist, world, 0, Spatial::zero());
        for row in k.range(k.index(1), k.index(t.rows)) {
            restore(k, t, row, lost);
        }
        laws::reset_speeds(k, t, lost);
        for c in k.count(t.closings) {
            let passed = k.spatial(t.multiplier, c, 0);
            k.store_spatial(t.multiplier, c, 0, unless(lost, passed));
        }
        for row in k.count(t.rows) {
            let moved = k.spatial(t.moved, row, 0);
            k.store_spatial(t.moved, row, 0, unless(lost, moved));
        }
        if t.touches() {
            t.kept.forget(k, lost);
            if t.grips {
                forget_torques(k, (t.gripped, t.contacts.sensed), lost);
            }
        }
    }
}

/// Zero where the mask holds.
#[inline(always)]
fn unless<R: Real>(mask: R::Mask, x: Spatial<R>) -> Spatial<R> {
    Spatial::new(
        Vec3::select(mask, Vec3::zero(), x.angular),
        Vec3::select(mask, Vec3::zero(), x.linear),
    )
}

#[inline(always)]
fn restore<M: Machine>(k: &mut M, t: &Tables, row: M::I, lost: <M::R as Real>::Mask) {
    let (now, saved) = (k.pose(t.pose, row, 0), k.pose(t.saved_pose, row, 0));
    let p = Vec3::select(lost, saved.p, now.p);
    k.store_pose(
        t.pose,
        row,
        0,
        Pose::new(p, Quat::select(lost, saved.q, now.q)),
    );
    let (now, saved) = (k.spatial(t.twist, row, 0), k.spatial(t.before, row, 0));
    let angular = Vec3::select(lost, saved.angular, now.angular);
    let linear = Vec3::select(lost, saved.linear, now.linear);
    k.store_spatial(t.twist, row, 0, Spatial::new(angular, linear));
}
