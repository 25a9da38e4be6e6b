//! What a world remembers of its contacts from step to step.
//!
//! It is impulses, of small steps and of a step. So a state also holds how long these were: with a snapshot it may come to
//! a simulation in steps of other lengths, for which [`Impulse::fit`] changes it.

use super::layout::{Impulse, state as body};
use super::sums::{self, SumTables};
use super::tables::POINTS;
use glam::DVec3;
use numbers::{Cpu, Float, PerWorld};

/// Fields of a remembered contact; see [`Cached`](super::Cached).
pub mod remembered {
    /// Colliding shapes A and B.
    pub const SHAPES: usize = 0;
    /// How many points there are.
    pub const POINTS: usize = 2;
    /// From A to B.
    pub const NORMAL: usize = 3;
    /// [`Cached::drag`](super::Cached::drag).
    pub const DRAG: usize = 6;
    /// [`Cached::twist`](super::Cached::twist).
    pub const TWIST: usize = 9;
    /// [`Cached::drag_sum`](super::Cached::drag_sum).
    pub const DRAG_SUM: usize = 12;
    /// [`Cached::twist_sum`](super::Cached::twist_sum).
    pub const TWIST_SUM: usize = 15;
    /// The first point.
    pub const POINT: usize = 18;
    /// Numbers of a point: position, gap, feature, impulse, sum.
    pub const POINT_WIDTH: usize = 7;
    /// Of these, the gap and the feature.
    pub const GAP: usize = 3;
    /// Of these, the sum.
    pub const SUM: usize = 6;
    /// Numbers in a row.
    pub const WIDTH: usize = POINT + super::POINTS * POINT_WIDTH;
}

use remembered as field;

/// Numbers in the row of a contact.
pub const REMEMBERED: usize = remembered::WIDTH;

/// A contact as a world remembers it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cached<T> {
    /// Colliding shapes A and B, as [`Impulse::shapes`] counts them.
    pub shapes: [u32; 2],
    /// From A to B.
    pub normal: [T; 3],
    /// Impulse of friction at the centre of pressure in the last small step [N·s].
    pub drag: [T; 3],
    /// Angular impulse against twisting and rolling in the last small step [N·m·s].
    pub twist: [T; 3],
    /// The sum of drags over the last step [N·s]; over its part, until the [parts before](Self::add) are added.
    pub drag_sum: [T; 3],
    /// The sum of twists over the last step, or its part [N·m·s].
    pub twist_sum: [T; 3],
    /// The points, of which the first [`count`](Self::count) are.
    pub points: [CachedPoint<T>; POINTS],
    /// How many points there are.
    pub count: usize,
}

/// A point of a [`Cached`] contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(missing_docs)]
pub struct CachedPoint<T> {
    pub position: [T; 3],
    pub gap: T,
    pub feature: T,
    /// Impulse along the normal in the last small step [N·s].
    pub impulse: T,
    /// The sum of impulses over the last step, or its part [N·s].
    pub sum: T,
}

impl Impulse {
    /// How many contacts a world remembers: no more than there is room for, whatever a snapshot says.
    pub fn remembered<T: Float>(&self, state: &[T]) -> usize {
        (state[self.remembered.at(0, 0)].to_f64() as usize).min(self.capacity)
    }
    /// One of them; they are in the order of their shapes, the lower ones first.
    pub fn recall<'a, T: Float>(&self, i: usize, state: &'a [T]) -> Recalled<'a, T> {
        Recalled(&state[self.memory.at(i, 0)..][..field::WIDTH])
    }
    /// Where a state holds how many contacts it remembers, how many there was no room for, and the first row of those
    /// that it remembers.
    pub fn memory_places(&self) -> [usize; 3] {
        let [count, forgotten] = [self.remembered, self.forgotten].map(|number| number.at(0, 0));
        [count, forgotten, self.memory.at(0, 0)]
    }
    /// Makes a state one that steps of the present length have led to: forces, torques and accelerations stay.
    pub fn fit<T: Float>(&self, state: &mut [T]) {
        let given_in = self.given_in.at(0, 0)..self.given_in.at(1, 0);
        let now = self.lengths_of_steps().map(T::from_f64);
        let before = &mut state[given_in];
        if before == now {
            return;
        }
        let times = [0, 1].map(|i| now[i] / before[i]);
        before.copy_from_slice(&now);
        for i in 0..self.remembered(state) {
            let mut contact = self.recall(i, state).contact();
            contact.stretch(times);
            contact.write(&mut state[self.memory.at(i, 0)..][..field::WIDTH]);
        }
        for tie in 0..self.ties() {
            self.stretch_tied(tie, times, state);
        }
        for row in 1..self.rows() {
            let own = &mut state[self.body_state(row)..][..body::WIDTH];
            for i in 0..6 {
                let (now, before) = (own[body::VELOCITY + i], own[body::BEFORE + i]);
                own[body::BEFORE + i] = now - (now - before) * times[1];
            }
        }
    }
    /// How many contacts there was no room for, since the world was reset.
    pub fn forgotten<T: Float>(&self, state: &[T]) -> f64 {
        state[self.forgotten.at(0, 0)].to_f64()
    }
    /// The rows of a world's state into which its contacts are to be [written](Cached::write). What there is no room
    /// for is left out: those that press come before all others.
    pub fn rows_for<'a, T: Float>(
        &self,
        contacts: &mut Vec<Cached<T>>,
        state: &'a mut [T],
    ) -> &'a mut [T] {
        let count = contacts.len().min(self.capacity);
        if count < contacts.len() {
            let lost = &mut state[self.forgotten.at(0, 0)];
            *lost = T::from_f64(lost.to_f64() + (contacts.len() - count) as f64);
            let presses = |contact: &Cached<T>| contact.presses() || contact.gave();
            let all = contacts.iter().filter(|contact| presses(contact)).count();
            let mut room = [count.saturating_sub(all), all.min(count)];
            contacts.retain(|contact| {
                let own = &mut room[usize::from(presses(contact))];
                let fits = *own > 0;
                *own -= usize::from(fits);
                fits
            });
        }
        state[self.remembered.at(0, 0)] = T::from_f64(count as f64);
        &mut state[self.memory.at(0, 0)..self.memory.at(count, 0)]
    }
}

fn ordered([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

pub(super) fn vec3<T: Float>(v: &[T; 3]) -> DVec3 {
    DVec3::from_array(v.map(T::to_f64))
}

/// A contact in the state of a world.
#[derive(Clone, Copy, Debug)]
pub struct Recalled<'a, T>(&'a [T]);

impl<T: Float> Recalled<'_, T> {
    /// Its colliding shapes.
    pub fn shapes(&self) -> [u32; 2] {
        let shape = |i: usize| self.0[field::SHAPES + i].to_f64() as u32;
        [shape(0), shape(1)]
    }
    /// What contacts are in the order of: their shapes, the lower first.
    pub fn key(&self) -> [u32; 2] {
        ordered(self.shapes())
    }
    /// From A to B.
    pub fn normal(&self) -> [T; 3] {
        self.vec3(field::NORMAL)
    }
    /// How many points it has.
    pub fn points(&self) -> usize {
        (self.0[field::POINTS].to_f64() as usize).min(POINTS)
    }
    fn vec3(&self, at: usize) -> [T; 3] {
        [self.0[at], self.0[at + 1], self.0[at + 2]]
    }
    /// One of its points.
    fn point(&self, i: usize) -> CachedPoint<T> {
        let at = field::POINT + i * field::POINT_WIDTH;
        CachedPoint {
            position: self.vec3(at),
            gap: self.0[at + 3],
            feature: self.0[at + 4],
            impulse: self.0[at + 5],
            sum: self.0[at + 6],
        }
    }
    /// All of it.
    pub fn contact(&self) -> Cached<T> {
        let mut contact = Cached {
            shapes: self.shapes(),
            normal: self.vec3(field::NORMAL),
            drag: self.vec3(field::DRAG),
            twist: self.vec3(field::TWIST),
            drag_sum: self.vec3(field::DRAG_SUM),
            twist_sum: self.vec3(field::TWIST_SUM),
            count: self.points(),
            ..Cached::default()
        };
        for i in 0..contact.count {
            contact.points[i] = self.point(i);
        }
        contact
    }
    /// Gives the impulses of its points to those of a contact that are the same: of the same
    /// features, or, where features have changed, in the same place within `near` [m].
    pub fn warm(&self, contact: &mut Cached<T>, near: f64) {
        contact.drag = self.vec3(field::DRAG);
        contact.twist = self.vec3(field::TWIST);
        let mut taken = [false; POINTS];
        let mut cold = [true; POINTS];
        for (point, cold) in contact.points[..contact.count].iter_mut().zip(&mut cold) {
            let feature = |i: &usize| self.0[field::POINT + i * field::POINT_WIDTH + 4];
            let same = |i: &usize| !taken[*i] && feature(i) == point.feature;
            if let Some(i) = (0..self.points()).find(same) {
                point.impulse = self.point(i).impulse;
                (taken[i], *cold) = (true, false);
            }
        }
        for (point, _) in contact.points[..contact.count]
            .iter_mut()
            .zip(cold)
            .filter(|p| p.1)
        {
            let distances = (0..self.points())
                .filter(|i| !taken[*i])
                .map(|i| (self.point(i).distance(point), i));
            if let Some((distance, i)) = distances.min_by(|a, b| a.0.total_cmp(&b.0))
                && distance < near
            {
                point.impulse = self.point(i).impulse;
                taken[i] = true;
            }
        }
    }
}

impl<T: Float> CachedPoint<T> {
    fn distance(&self, other: &Self) -> f64 {
        (vec3(&self.position) - vec3(&other.position)).length()
    }
}

impl<T: Float> Cached<T> {
    /// What contacts are in the order of: their shapes, the lower first.
    pub fn key(&self) -> [u32; 2] {
        ordered(self.shapes)
    }
    /// Whether any of its points bears a load.
    pub fn presses(&self) -> bool {
        let loaded = |p: &CachedPoint<T>| p.impulse > T::zero();
        self.points[..self.count].iter().any(loaded)
    }
    /// Whether it has given anything in the step.
    pub fn gave(&self) -> bool {
        let loaded = |p: &CachedPoint<T>| p.sum > T::zero();
        self.points[..self.count].iter().any(loaded) || self.drag_sum != [T::zero(); 3]
    }
    /// It gives in each of so many small steps what it gave in the last one.
    pub fn persist(&mut self, small_steps: usize) {
        let steps = T::from_f64(small_steps as f64);
        self.drag_sum = self.drag.map(|x| x * steps);
        let turning = (self.pressed() - self.middle()).cross(vec3(&self.drag));
        let twist = (vec3(&self.twist) + turning) * small_steps as f64;
        self.twist_sum = twist.to_array().map(T::from_f64);
        for point in &mut self.points {
            point.sum = point.impulse * steps;
        }
    }
    /// What it gave in small steps, and in a step, that were so many times as long.
    fn stretch(&mut self, [small, whole]: [T; 2]) {
        self.drag = self.drag.map(|x| x * small);
        self.twist = self.twist.map(|x| x * small);
        self.drag_sum = self.drag_sum.map(|x| x * whole);
        self.twist_sum = self.twist_sum.map(|x| x * whole);
        for point in &mut self.points {
            point.impulse *= small;
            point.sum *= whole;
        }
    }
    /// It is no contact any more, and tells only what it gave.
    pub fn end(&mut self) {
        self.drag = [T::zero(); 3];
        self.twist = [T::zero(); 3];
        for point in &mut self.points {
            point.impulse = T::zero();
        }
    }
    /// Adds what a contact of the same shapes gave in the parts of the step before: see [`sums`].
    pub fn add(&mut self, before: &Self) {
        let t = SumTables::new();
        let mut rows = [0.0; 2 * REMEMBERED];
        for (row, contact) in rows.chunks_exact_mut(REMEMBERED).zip([&*self, before]) {
            let mut own = [T::zero(); REMEMBERED];
            contact.write(&mut own);
            row.copy_from_slice(&own.map(T::to_f64));
        }
        let mut k = Cpu {
            state: &mut rows,
            input: &[],
            output: &mut [],
            scratch: &mut [],
            parameters: PerWorld(&[]),
            links: &[],
        };
        sums::add(&mut k, &t);
        let vec3 = |at: usize| [0, 1, 2].map(|i| T::from_f64(rows[at + i]));
        self.drag_sum = vec3(field::DRAG_SUM);
        self.twist_sum = vec3(field::TWIST_SUM);
        for (i, point) in self.points[..self.count].iter_mut().enumerate() {
            point.sum = T::from_f64(rows[field::POINT + i * field::POINT_WIDTH + 6]);
        }
    }
    /// Its impulses acted `aside` [m] before its points, in one line with a centre of mass: what they would turn is taken
    /// off the torque that is told.
    pub fn acted_aside(&mut self, aside: [T; 3]) {
        let [impulse, told] = self.given(self.middle());
        let twist = vec3(&self.twist_sum);
        let turned = twist - vec3(&aside).cross(impulse);
        self.twist_sum = (twist + (turned - told)).to_array().map(T::from_f64);
    }
    /// Impulse, and angular impulse about a point, on B in the step.
    fn given(&self, about: DVec3) -> [DVec3; 2] {
        let (normal, drag) = (vec3(&self.normal), vec3(&self.drag_sum));
        let turning = vec3(&self.twist_sum) + (self.middle() - about).cross(drag);
        let points = self.points[..self.count].iter();
        points.fold([drag, turning], |[p, l], point| {
            let load = normal * point.sum.to_f64();
            [p + load, l + (vec3(&point.position) - about).cross(load)]
        })
    }
    /// Where friction acts: the centre of pressure in the last small step.
    fn pressed(&self) -> DVec3 {
        let points = self.points[..self.count].iter();
        let load = points.clone().map(|p| p.impulse.to_f64()).sum::<f64>();
        if load <= 0.0 {
            return self.middle();
        }
        let weighed = points.map(|p| vec3(&p.position) * p.impulse.to_f64());
        weighed.sum::<DVec3>() / load
    }
    /// Where friction is told to act: the mean of its points.
    pub(super) fn middle(&self) -> DVec3 {
        let points = &self.points[..self.count];
        points.iter().map(|p| vec3(&p.position)).sum::<DVec3>() / self.count as f64
    }
    /// Into a row of [`REMEMBERED`] numbers.
    pub fn write(&self, x: &mut [T]) {
        let whole = |n: f64| T::from_f64(n);
        x[field::SHAPES] = whole(f64::from(self.shapes[0]));
        x[field::SHAPES + 1] = whole(f64::from(self.shapes[1]));
        x[field::POINTS] = whole(self.count as f64);
        x[field::NORMAL..][..3].copy_from_slice(&self.normal);
        x[field::DRAG..][..3].copy_from_slice(&self.drag);
        x[field::TWIST..][..3].copy_from_slice(&self.twist);
        x[field::DRAG_SUM..][..3].copy_from_slice(&self.drag_sum);
        x[field::TWIST_SUM..][..3].copy_from_slice(&self.twist_sum);
        for (i, p) in self.points.iter().enumerate() {
            let row = &mut x[field::POINT + i * field::POINT_WIDTH..][..field::POINT_WIDTH];
            row[..3].copy_from_slice(&p.position);
            row[3..].copy_from_slice(&[p.gap, p.feature, p.impulse, p.sum]);
        }
    }
}
