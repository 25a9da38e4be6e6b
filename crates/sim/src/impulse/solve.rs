//! The small steps: impulses, colour by colour, between motions of the bodies.

use super::jobs::{Batch, Bodies, BodyRows, BodyStage, ContactStage, Contacts};
use super::team::{Barrier, together};
use super::world::Workspace;
use crate::jobs;
use numbers::{Float, Memory};
use rigid::impulse::{
    Cached, CachedPoint, ContactTables, Impulse, POINTS, Surface, contact, global, manifold, point,
};
use std::ops::Range;

/// Contacts in lanes; kept from step to step for its memory only.
pub(super) struct Solve<T> {
    numbers: Memory<T>,
    /// Bodies of each batch.
    bodies: Vec<[Vec<u32>; 2]>,
    ends: Vec<([u32; 2], usize)>,
}

impl<T: Float> Default for Solve<T> {
    fn default() -> Self {
        Self {
            numbers: Memory::new(0, 1, 1),
            bodies: Vec::new(),
            ends: Vec::new(),
        }
    }
}

/// How to solve the contacts of a step.
pub(super) struct Solver<'a, T> {
    pub impulse: &'a Impulse,
    pub parameters: &'a [T],
    pub lane: jobs::Lane,
    pub width: usize,
    pub team: usize,
    pub globals: &'a [T; global::WIDTH],
}

/// What one thread works on.
struct Share<'a, T> {
    batches: Vec<Batch<'a, T>>,
    /// Of each colour, its batches among them.
    colours: Vec<Range<usize>>,
    /// Bodies.
    index: &'a [u32],
}

/// A lane of a block.
struct Lane<'a, T> {
    numbers: &'a mut [T],
    width: usize,
    lane: usize,
}

impl<T: Float> Lane<'_, T> {
    fn put(&mut self, at: usize, x: &[T]) {
        for (i, x) in x.iter().enumerate() {
            self.numbers[(at + i) * self.width + self.lane] = *x;
        }
    }
}

/// Contacts for each thread below which one thread is faster.
const WORTH_SHARING: usize = 128;

impl<T: Float> Solver<'_, T> {
    pub fn run(&mut self, w: &mut Workspace<T>) {
        let t = ContactTables::new();
        let Workspace {
            contacts,
            colours,
            solve,
            rows,
            awake,
            masses,
            ..
        } = w;
        let surfaces: Vec<_> = contacts
            .iter()
            .map(|c| self.impulse.surface(c.shapes, self.parameters))
            .collect();
        solve.ends.clear();
        let row = |s: u32| self.impulse.shapes()[s as usize].row;
        let ends = contacts.iter().map(|c| (c.shapes.map(row), c.count));
        solve.ends.extend(ends);
        colours.paint(&solve.ends, self.impulse.rows(), self.width);
        self.make_room(solve, colours.batches.len(), &t);
        let bounces = surfaces.iter().any(|s| s.restitution > 0.0);
        let block = solve.numbers.block_size();
        let mut blocks = solve.numbers.scalars_mut().chunks_exact_mut(block);
        let mut batches = Vec::with_capacity(colours.batches.len());
        for (i, bodies) in solve.bodies[..colours.batches.len()].iter_mut().enumerate() {
            let Some(numbers) = blocks.next() else { break };
            let members = colours.batch(i);
            let points = self.fill(
                &t,
                members,
                contacts,
                &surfaces,
                &solve.ends,
                bodies,
                numbers,
            );
            batches.push((numbers, &*bodies, points));
        }
        let team = self.team.min(contacts.len() / WORTH_SHARING).max(1);
        let shares = shares(batches, &colours.colours, awake, team, self.width);
        together(shares, |barrier, _, share| {
            self.work(rows, masses, barrier, share, bounces);
        });
        let mut blocks = solve.numbers.scalars().chunks_exact(block);
        for (i, _) in colours.batches.iter().enumerate() {
            let Some(numbers) = blocks.next() else { break };
            for (lane, contact) in colours.batch(i).iter().enumerate() {
                self.read(&t, lane, numbers, &mut contacts[*contact as usize]);
            }
        }
    }

    fn make_room(&self, solve: &mut Solve<T>, batches: usize, t: &ContactTables) {
        let lanes = batches * self.width;
        let fits = solve.numbers.width() == self.width && solve.numbers.length() == t.length;
        if !fits || solve.numbers.worlds() < lanes {
            solve.numbers = Memory::new(lanes + lanes / 4 + self.width, t.length, self.width);
        }
        solve
            .bodies
            .resize_with(batches.max(solve.bodies.len()), Default::default);
    }

    /// Writes a batch; returns the most points that a contact has.
    #[allow(clippy::too_many_arguments)]
    fn fill(
        &self,
        t: &ContactTables,
        members: &[u32],
        contacts: &[Cached<T>],
        surfaces: &[Surface],
        ends: &[([u32; 2], usize)],
        bodies: &mut [Vec<u32>; 2],
        numbers: &mut [T],
    ) -> u32 {
        let mut points = 0;
        for (side, rows) in bodies.iter_mut().enumerate() {
            rows.clear();
            rows.extend(members.iter().map(|c| ends[*c as usize].0[side]));
            rows.resize(self.width, 0);
        }
        for (lane, &contact) in members.iter().enumerate() {
            let (contact, surface) = (&contacts[contact as usize], &surfaces[contact as usize]);
            self.write(t, lane, contact, surface, numbers);
            points = points.max(contact.count as u32);
        }
        points
    }

    fn write(
        &self,
        t: &ContactTables,
        lane: usize,
        touch: &Cached<T>,
        surface: &Surface,
        numbers: &mut [T],
    ) {
        let mut row = Lane {
            numbers,
            width: self.width,
            lane,
        };
        let at = |field| t.manifold.at(0, field);
        row.put(at(manifold::NORMAL), &touch.normal);
        let coefficients = [
            surface.friction,
            surface.restitution,
            surface.torsion,
            surface.rolling,
            surface.spring[0],
            surface.spring[1],
            surface.settling,
        ];
        for (i, x) in coefficients.into_iter().enumerate() {
            row.put(at(manifold::FRICTION + i), &[T::from_f64(x)]);
        }
        row.put(at(manifold::DRAG), &touch.drag);
        row.put(at(manifold::TWIST), &touch.twist);
        for i in 0..POINTS {
            let at = |field| t.point.at(i, field);
            let known = i < touch.count;
            // Points that are not lie where the first does, but far apart: they give nothing.
            let p = &touch.points[if known { i } else { 0 }];
            let none = CachedPoint::default();
            let given = if known { p } else { &none };
            row.put(at(point::ARM_A), &p.position);
            let gap = if known {
                p.gap
            } else {
                T::from_f64(contact::NOWHERE)
            };
            row.put(at(point::GAP), &[gap, given.impulse]);
        }
    }

    fn read(&self, t: &ContactTables, lane: usize, numbers: &[T], contact: &mut Cached<T>) {
        let get = |at: usize| numbers[at * self.width + lane];
        for axis in 0..3 {
            contact.drag[axis] = get(t.manifold.at(0, manifold::DRAG + axis));
            contact.twist[axis] = get(t.manifold.at(0, manifold::TWIST + axis));
        }
        for (i, p) in contact.points[..contact.count].iter_mut().enumerate() {
            p.impulse = get(t.point.at(i, point::IMPULSE));
        }
    }

    /// All small steps of one thread's share, in step with the others.
    fn work(
        &self,
        rows: &BodyRows<T>,
        masses: &[T],
        barrier: &Barrier,
        mut share: Share<'_, T>,
        bounces: bool,
    ) {
        let bodies = |index: &[u32], stage| {
            self.lane.run(Bodies {
                rows,
                index,
                masses,
                globals: self.globals,
                stage,
            });
            barrier.wait();
        };
        let contacts = |share: &mut Share<'_, T>, stage| {
            for range in share.colours.clone() {
                self.lane.run(Contacts {
                    rows,
                    batches: &mut share.batches,
                    range,
                    globals: self.globals,
                    stage,
                });
                barrier.wait();
            }
        };
        contacts(&mut share, ContactStage::Prepare);
        let steps = self.impulse.settings().contact_iterations;
        for step in 0..steps {
            bodies(share.index, BodyStage::Advance { again: step > 0 });
            if step == 0 {
                contacts(&mut share, ContactStage::WarmStart);
            }
            contacts(&mut share, ContactStage::Solve { pushing: true });
            bodies(share.index, BodyStage::Drift);
            contacts(&mut share, ContactStage::Solve { pushing: false });
        }
        if bounces {
            contacts(&mut share, ContactStage::Bounce);
        }
    }
}

/// Deals batches and bodies out, each thread a run of each colour.
fn shares<'a, T: Float>(
    batches: Vec<(&'a mut [T], &'a [Vec<u32>; 2], u32)>,
    colours: &[Range<usize>],
    awake: &'a [u32],
    team: usize,
    width: usize,
) -> Vec<Share<'a, T>> {
    let registers = awake.len() / width;
    let cut = |n: usize, member: usize| n * member / team;
    let mut shares: Vec<_> = (0..team)
        .map(|m| Share {
            batches: Vec::new(),
            colours: Vec::new(),
            index: &awake[cut(registers, m) * width..cut(registers, m + 1) * width],
        })
        .collect();
    let mut batches = batches.into_iter();
    for colour in colours {
        for (member, share) in shares.iter_mut().enumerate() {
            let count = cut(colour.len(), member + 1) - cut(colour.len(), member);
            let first = share.batches.len();
            let own = batches.by_ref().take(count);
            share
                .batches
                .extend(own.map(|(numbers, bodies, points)| Batch {
                    numbers,
                    bodies,
                    points,
                }));
            share.colours.push(first..share.batches.len());
        }
    }
    shares
}
