//! Objects, a structure over them, and all that can be asked.

use crate::cast::Sweep;
use crate::query::{CastTest, ClosestTest, Hit, Neighbor};
use crate::{Aabb, Boxes, Cast, Pair, SpaceError, Structure, pairs};
use glam::Vec3;
use rayon::prelude::*;

/// Objects in space, known by index, each with a box.
///
/// Answers are the same whatever the structure `S` and however many threads run.
/// Unbounded boxes are kept in a list that each query runs through: have few.
#[derive(Clone, Debug)]
pub struct Space<S> {
    boxes: Boxes,
    structure: S,
}

impl<S: Structure> Space<S> {
    /// Object i has the box `boxes[i]`.
    ///
    /// # Errors
    /// A box has a NaN or is inside out, or there are more than 2³⁰.
    pub fn new(boxes: &[Aabb]) -> Result<Self, SpaceError> {
        let boxes = Boxes::new(boxes)?;
        let structure = S::build(&boxes);
        Ok(Self { boxes, structure })
    }

    /// The objects' boxes; as a test, they stand for the objects.
    pub fn boxes(&self) -> &Boxes {
        &self.boxes
    }

    /// What finds the candidates.
    pub fn structure(&self) -> &S {
        &self.structure
    }

    /// Moves all objects: one box for each index, those of removed objects are ignored.
    ///
    /// # Errors
    /// As [`new`](Space::new), or the number of boxes is not that of the indices.
    pub fn update(&mut self, boxes: &[Aabb]) -> Result<(), SpaceError> {
        if self.boxes.replace(boxes)? {
            self.structure = S::build(&self.boxes);
        } else {
            self.structure.refresh(&self.boxes);
        }
        Ok(())
    }

    /// Adds an object; returns its index, which may be that of a removed one.
    ///
    /// # Errors
    /// The box has a NaN or is inside out, or there are 2³⁰ objects.
    pub fn insert(&mut self, aabb: Aabb) -> Result<u32, SpaceError> {
        let object = self.boxes.insert(aabb)?;
        if aabb.is_bounded() {
            self.structure.inserted(&self.boxes, object);
        }
        Ok(object)
    }

    /// Takes an object out.
    ///
    /// # Errors
    /// No object has this index.
    pub fn remove(&mut self, object: u32) -> Result<(), SpaceError> {
        let old = self.boxes.remove(object)?;
        if old.is_bounded() {
            self.structure.removed(&self.boxes, object, &old);
        }
        Ok(())
    }

    /// Moves one object.
    ///
    /// # Errors
    /// No object has this index, or the box has a NaN or is inside out.
    pub fn relocate(&mut self, object: u32, aabb: Aabb) -> Result<(), SpaceError> {
        let old = self.boxes.relocate(object, aabb)?;
        match (old.is_bounded(), aabb.is_bounded()) {
            (true, true) => self.structure.relocated(&self.boxes, object, &old),
            (true, false) => self.structure.removed(&self.boxes, object, &old),
            (false, true) => self.structure.inserted(&self.boxes, object),
            (false, false) => {}
        }
        Ok(())
    }

    /// All pairs whose boxes overlap (touching counts), in order, each once.
    pub fn pairs(&self) -> Vec<Pair> {
        let mut found = Vec::new();
        self.pairs_into(&mut found);
        found
    }

    /// As [`pairs`](Space::pairs), into a list that is emptied first.
    pub fn pairs_into(&self, found: &mut Vec<Pair>) {
        found.clear();
        self.structure.pairs(&self.boxes, found);
        let everywhere = self.boxes.unbounded();
        for &i in everywhere {
            let aabb = self.boxes.get(i);
            let others =
                (0..self.boxes.all().len() as u32).filter(|&j| self.boxes.get(j).overlaps(aabb));
            let once = others.filter(|j| i < *j || everywhere.binary_search(j).is_err());
            found.extend(once.map(|j| Pair::new(i, j)));
        }
        pairs::sort(found, self.boxes.all().len());
    }

    /// The objects whose boxes overlap `region` (touching counts), in order.
    pub fn overlap(&self, region: &Aabb) -> Vec<u32> {
        let mut found = Vec::new();
        if region.is_bounded() {
            self.structure
                .overlap(&self.boxes, region, &mut |i| found.push(i));
            let unbounded = self.boxes.unbounded().iter();
            found.extend(unbounded.filter(|i| self.boxes.get(**i).overlaps(region)));
            found.sort_unstable();
        } else {
            let all = 0..self.boxes.all().len() as u32;
            found.extend(all.filter(|i| self.boxes.get(*i).overlaps(region)));
        }
        found
    }

    /// The first hit; of equally early ones, the one with the lowest index.
    pub fn cast(&self, cast: &Cast, test: &impl CastTest) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        let mut visit = |object| consider(cast, test, object, &mut best);
        let limit = self
            .boxes
            .unbounded()
            .iter()
            .fold(cast.limit(), |_, i| visit(*i));
        self.structure
            .sweep(&self.boxes, &Sweep::new(cast), limit, &mut visit);
        best
    }

    /// Every object hit, in order of time, then of index.
    pub fn cast_all(&self, cast: &Cast, test: &impl CastTest) -> Vec<Hit> {
        let mut hits = Vec::new();
        let mut visit = |object| {
            if let Some(time) = test.hit(object, cast, cast.limit())
                && (0.0..=cast.limit()).contains(&time)
            {
                hits.push(Hit { object, time });
            }
            cast.limit()
        };
        self.boxes.unbounded().iter().for_each(|i| _ = visit(*i));
        self.structure
            .sweep(&self.boxes, &Sweep::new(cast), cast.limit(), &mut visit);
        hits.sort_unstable_by(|x, y| x.time.total_cmp(&y.time).then(x.object.cmp(&y.object)));
        hits.dedup_by_key(|hit| hit.object);
        hits
    }

    /// The `k` objects nearest to `point` and not farther than `within` [m], the
    /// nearest first; of equally near ones, those with the lowest indices.
    ///
    /// Nothing is near a point that has a NaN or lies beyond 10¹⁵ m.
    pub fn nearest(
        &self,
        point: Vec3,
        k: usize,
        within: f32,
        test: &impl ClosestTest,
    ) -> Vec<Neighbor> {
        let mut near: Vec<Neighbor> = Vec::with_capacity(k.min(64));
        if k == 0 || !Aabb::new(point, point).is_bounded() || within.is_nan() || within < 0.0 {
            return near;
        }
        let within = (within * within).min(f32::MAX);
        let mut visit = |object| {
            let closest = test.closest(object, point);
            let distance_squared = closest.distance_squared(point);
            let found = Neighbor {
                object,
                point: closest,
                distance_squared,
            };
            if distance_squared <= within
                && let Err(place) = near.binary_search_by_key(&found.rank(), Neighbor::rank)
                && place < k
            {
                near.truncate(k - 1);
                near.insert(place, found);
            }
            if near.len() < k {
                within
            } else {
                near[k - 1].distance_squared
            }
        };
        let limit = self.boxes.unbounded().iter().fold(within, |_, i| visit(*i));
        self.structure
            .approach(&self.boxes, point, limit, &mut visit);
        near
    }

    /// The object nearest to `point` and not farther than `within` [m], and its nearest point.
    pub fn closest(&self, point: Vec3, within: f32, test: &impl ClosestTest) -> Option<Neighbor> {
        self.nearest(point, 1, within, test).pop()
    }

    /// Visits the objects whose boxes a cast may meet, the early ones first as far as that is cheap: for
    /// answers that need more than a [`CastTest`] can tell. `visit` returns the time after which hits no longer count.
    ///
    /// Every object whose box the cast meets by then is visited. Others may be, and some more than once, though none
    /// by a [`Bvh`](crate::Bvh).
    pub fn sweep(&self, cast: &Cast, mut visit: impl FnMut(u32) -> f32) {
        let unbounded = self.boxes.unbounded().iter();
        let limit = unbounded.fold(cast.limit(), |_, i| visit(*i));
        self.structure
            .sweep(&self.boxes, &Sweep::new(cast), limit, &mut visit);
    }

    /// Visits the objects whose boxes are not farther than `within` [m] from a point, the near ones first as far as
    /// that is cheap: for answers that need more than a [`ClosestTest`] can tell. `visit` returns the distance [m]
    /// beyond which objects no longer count.
    ///
    /// Others may be visited, and some more than once, though none by a [`Bvh`](crate::Bvh). None is near a point that
    /// has a NaN or lies beyond 10¹⁵ m.
    pub fn approach(&self, point: Vec3, within: f32, mut visit: impl FnMut(u32) -> f32) {
        if !Aabb::new(point, point).is_bounded() {
            return;
        }
        let square = |distance: f32| (distance * distance).min(f32::MAX);
        let unbounded = self.boxes.unbounded().iter();
        let limit = unbounded.fold(square(within), |_, i| square(visit(*i)));
        let mut visit = |object| square(visit(object));
        self.structure
            .approach(&self.boxes, point, limit, &mut visit);
    }

    /// [`cast`](Space::cast) for many, in threads; answer i belongs to `casts[i]`. Runs
    /// of 16 casts that are alike, as those of neighbouring pixels are, go together in lanes.
    pub fn cast_batch(&self, casts: &[Cast], test: &impl CastTest) -> Vec<Option<Hit>> {
        let mut answers = vec![None; casts.len()];
        let parts = answers.par_chunks_mut(CHUNK).zip(casts.par_chunks(CHUNK));
        parts.for_each(|(answers, casts)| self.cast_chunk(casts, test, answers));
        answers
    }

    fn cast_chunk(&self, casts: &[Cast], test: &impl CastTest, answers: &mut [Option<Hit>]) {
        let sweeps: Vec<Sweep> = casts.iter().map(Sweep::new).collect();
        let mut visit = |i: usize, object| consider(&casts[i], test, object, &mut answers[i]);
        let unbounded = self.boxes.unbounded();
        let limit =
            |(i, cast): (usize, &Cast)| unbounded.iter().fold(cast.limit(), |_, o| visit(i, *o));
        let limits: Vec<f32> = casts.iter().enumerate().map(limit).collect();
        self.structure
            .sweep_many(&self.boxes, &sweeps, &limits, &mut visit);
    }

    /// [`cast_all`](Space::cast_all) for many, in threads.
    pub fn cast_all_batch(&self, casts: &[Cast], test: &impl CastTest) -> Vec<Vec<Hit>> {
        batch(casts, |cast| self.cast_all(cast, test))
    }

    /// [`overlap`](Space::overlap) for many, in threads.
    pub fn overlap_batch(&self, regions: &[Aabb]) -> Vec<Vec<u32>> {
        batch(regions, |region| self.overlap(region))
    }

    /// [`nearest`](Space::nearest) for many, in threads.
    pub fn nearest_batch(
        &self,
        points: &[Vec3],
        k: usize,
        within: f32,
        test: &impl ClosestTest,
    ) -> Vec<Vec<Neighbor>> {
        batch(points, |point| self.nearest(*point, k, within, test))
    }
}

/// A thread takes so many casts at a time.
const CHUNK: usize = 64;

/// Tests one more object; returns the time after which hits no longer count.
#[inline(always)]
fn consider(cast: &Cast, test: &impl CastTest, object: u32, best: &mut Option<Hit>) -> f32 {
    let limit = best.map_or(cast.limit(), |b| b.time);
    if let Some(time) = test.hit(object, cast, limit)
        && (0.0..=limit).contains(&time)
        && best.is_none_or(|b| (time, object) < (b.time, b.object))
    {
        *best = Some(Hit { object, time });
        return time;
    }
    limit
}

/// Answers in the order of the questions; few enough are answered by one thread.
fn batch<Q: Sync, A: Send>(questions: &[Q], answer: impl Fn(&Q) -> A + Send + Sync) -> Vec<A> {
    questions
        .par_iter()
        .with_min_len(CHUNK)
        .map(answer)
        .collect()
}
