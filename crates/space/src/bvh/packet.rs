//! Sweeps that are alike go down the tree together, one in each lane.
//!
//! A node is opened when any lane meets it, so that a node is fetched, and the
//! stack is kept, once for 16 sweeps (Wald et al. 2001, "Interactive rendering
//! with coherent ray tracing"). Sweeps that are not alike would drag each other
//! along, and go alone.

use super::{Bvh, NONE, OBJECT};
use crate::cast::{SLACK, Sweep};
use crate::stack::Stack;
use glam::{Vec3, Vec4};
use numbers::dispatch::{Job, run_registers};
use numbers::{Lanes, LanesMask};

/// Sweeps in a packet.
const LANES: usize = 16;
/// Sweeps are alike when the cosine between their directions is at least this,
const ALIKE: f32 = 0.95;
/// and their origins are not farther apart than this share of the scene.
const TOGETHER: f32 = 0.02;

impl Bvh {
    pub(super) fn visit_many_swept(
        &self,
        sweeps: &[Sweep],
        limits: &[f32],
        visit: &mut impl FnMut(usize, u32) -> f32,
    ) {
        let reach = TOGETHER * self.nodes[0].bounds().extent().max_element();
        for (group, (sweeps, limits)) in sweeps.chunks(LANES).zip(limits.chunks(LANES)).enumerate()
        {
            let mut visit = |lane: usize, object| visit(LANES * group + lane, object);
            if let (Ok(sweeps), Ok(limits)) = (sweeps.try_into(), limits.try_into())
                && self.isa.width::<f32>() == LANES
                && are_alike(sweeps, reach)
            {
                let job = PacketJob {
                    bvh: self,
                    sweeps,
                    limits,
                    visit: &mut visit,
                };
                run_registers(self.isa, job);
                continue;
            }
            for (lane, (sweep, limit)) in sweeps.iter().zip(limits).enumerate() {
                self.visit_swept(sweep, *limit, &mut |object| visit(lane, object));
            }
        }
    }
}

fn are_alike(sweeps: &[Sweep; LANES], reach: f32) -> bool {
    let (first, toward) = (sweeps[0], sweeps[0].direction().normalize_or_zero());
    sweeps[1..].iter().all(|s| {
        let angle = s.direction().normalize_or_zero().dot(toward);
        angle >= ALIKE && (s.lower - first.lower).abs().max_element() <= reach
    })
}

struct PacketJob<'a, V> {
    bvh: &'a Bvh,
    sweeps: &'a [Sweep; LANES],
    limits: &'a [f32; LANES],
    visit: &'a mut V,
}

impl<V: FnMut(usize, u32) -> f32> Job for PacketJob<'_, V> {
    type Scalar = f32;
    type Output = ();

    #[inline(always)]
    fn run<R: Lanes<Scalar = f32>>(self) {
        let upper = gather::<R>(self.sweeps, |s| s.upper);
        let lower = gather::<R>(self.sweeps, |s| s.lower);
        let inverse = gather::<R>(self.sweeps, |s| s.inverse);
        let mut limits = *self.limits;
        let mut limit = load::<R>(&limits);
        let toward = self.sweeps[0].direction().to_array().map(Vec4::splat);

        let mut stack = Stack::<u32, 96>::with(0);
        while let Some(at) = stack.pop() {
            let node = &self.bvh.nodes[at as usize];
            // Children in the order in which the first sweep passes their middles.
            let middle = |axis: usize| (node.low[axis] + node.high[axis]) * toward[axis];
            let order = in_order((middle(0) + middle(1) + middle(2)).to_array());
            let mut inner = [NONE; 4];
            let mut count = 0;
            for slot in order {
                let child = node.child[slot];
                if child == NONE {
                    continue;
                }
                let mut enter = R::zero();
                let mut leave = limit;
                for axis in 0..3 {
                    let a = (R::splat(node.low[axis][slot]) - upper[axis]) * inverse[axis];
                    let b = (R::splat(node.high[axis][slot]) - lower[axis]) * inverse[axis];
                    enter = enter.max(a.min(b));
                    leave = leave.min(a.max(b));
                }
                let met = enter.le(leave * R::lit(SLACK.into()));
                if !met.any() {
                    continue;
                }
                if child & OBJECT == 0 {
                    inner[count] = child;
                    count += 1;
                    continue;
                }
                let met = store(R::select(met, R::one(), R::zero()));
                for lane in 0..LANES {
                    if met[lane] != 0.0 {
                        limits[lane] = (self.visit)(lane, child & !OBJECT);
                    }
                }
                limit = load::<R>(&limits);
            }
            inner[..count]
                .iter()
                .rev()
                .for_each(|child| stack.push(*child));
        }
    }
}

/// The four slots, that with the least key first.
#[inline(always)]
fn in_order(keys: [f32; 4]) -> [usize; 4] {
    let mut order = [0, 1, 2, 3];
    for (i, j) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
        if keys[order[j]] < keys[order[i]] {
            order.swap(i, j);
        }
    }
    order
}

/// A vector of each sweep, in lanes.
#[inline(always)]
fn gather<R: Lanes<Scalar = f32>>(sweeps: &[Sweep; LANES], of: impl Fn(&Sweep) -> Vec3) -> [R; 3] {
    let mut lanes = [[0.0; LANES]; 3];
    for (i, sweep) in sweeps.iter().enumerate() {
        let v = of(sweep);
        (lanes[0][i], lanes[1][i], lanes[2][i]) = (v.x, v.y, v.z);
    }
    [load(&lanes[0]), load(&lanes[1]), load(&lanes[2])]
}

#[inline(always)]
fn load<R: Lanes<Scalar = f32>>(lanes: &[f32; LANES]) -> R {
    bytemuck::pod_read_unaligned(bytemuck::bytes_of(lanes))
}

#[inline(always)]
fn store<R: Lanes<Scalar = f32>>(x: R) -> [f32; LANES] {
    bytemuck::pod_read_unaligned(bytemuck::bytes_of(&x))
}
