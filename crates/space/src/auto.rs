//! Whichever structure suits.
//!
//! Measured over 10² … 10⁶ objects (BENCHMARKS.md), the hierarchy is the fastest at
//! every query, and at pairs after motions shorter than the objects. Its one
//! weakness is its build. So where most objects jump at each update, sweep and
//! prune is taken for few objects, and the grid for many, if they are of like
//! size and not crowded.
//!
//! Costs are those of the structure taken, and O(n) an update to watch the motion;
//! memory 12 bytes an object more.

use crate::cast::Sweep;
use crate::{Aabb, Boxes, Bvh, Grid, Pair, Structure, SweepAndPrune};
use glam::Vec3;

/// Up to so many jumping objects sweep and prune is faster than the grid.
const FEW: usize = 1000;
/// A grid with more comparisons an object than this loses to the hierarchy.
const CROWDED: f32 = 24.0;
/// Objects jump when more than this share has moved farther than its own size,
/// and rest again when less than the other has.
const JUMPING: f32 = 0.5;
const RESTING: f32 = 0.1;

/// The structures it takes.
#[derive(Clone, Debug)]
enum Chosen {
    Bvh(Bvh),
    SweepAndPrune(SweepAndPrune),
    Grid(Grid),
}

/// Takes the structure that suits the number of objects, their sizes and their motion.
#[derive(Clone, Debug)]
pub struct Auto {
    chosen: Chosen,
    jumping: bool,
    /// Objects when the choice was made.
    count: usize,
    /// Where each object was.
    centers: Vec<Vec3>,
}

/// Does the same with whichever structure was chosen.
macro_rules! with {
    ($chosen:expr, $structure:ident => $work:expr) => {
        match $chosen {
            Chosen::Bvh($structure) => $work,
            Chosen::SweepAndPrune($structure) => $work,
            Chosen::Grid($structure) => $work,
        }
    };
}

impl Auto {
    /// The name of the structure in use.
    pub fn chosen(&self) -> &'static str {
        fn name<S: Structure>(_: &S) -> &'static str {
            S::NAME
        }
        with!(&self.chosen, s => name(s))
    }

    fn choose(boxes: &Boxes, jumping: bool) -> Self {
        let count = boxes.count();
        let chosen = match (jumping, count <= FEW) {
            (false, _) => Chosen::Bvh(Bvh::build(boxes)),
            (true, true) => Chosen::SweepAndPrune(SweepAndPrune::build(boxes)),
            (true, false) => {
                let grid = Grid::build(boxes);
                if grid.comparisons() <= CROWDED * count as f32 {
                    Chosen::Grid(grid)
                } else {
                    Chosen::Bvh(Bvh::build(boxes))
                }
            }
        };
        let centers = boxes.all().iter().map(Aabb::center).collect();
        Self {
            chosen,
            jumping,
            count,
            centers,
        }
    }

    /// The share of the bounded objects that have moved farther than their own size.
    fn watch(&mut self, boxes: &Boxes) -> f32 {
        let (mut far, mut all) = (0_u32, 0_u32);
        for (object, aabb) in boxes.bounded() {
            let before = std::mem::replace(&mut self.centers[object as usize], aabb.center());
            far +=
                u32::from(before.distance_squared(aabb.center()) > aabb.extent().length_squared());
            all += 1;
        }
        far as f32 / all.max(1) as f32
    }

    /// Chooses again where the number of objects has changed by half or more.
    fn count_again(&mut self, boxes: &Boxes) {
        if boxes.count() > self.count + self.count / 2 + 64 || boxes.count() < self.count / 2 {
            *self = Self::choose(boxes, self.jumping);
        }
    }
}

impl Structure for Auto {
    const NAME: &'static str = "auto";

    fn build(boxes: &Boxes) -> Self {
        Self::choose(boxes, false)
    }

    fn refresh(&mut self, boxes: &Boxes) {
        let share = self.watch(boxes);
        let jumping = share > if self.jumping { RESTING } else { JUMPING };
        if jumping == self.jumping {
            with!(&mut self.chosen, s => s.refresh(boxes));
        } else {
            *self = Self::choose(boxes, jumping);
        }
    }

    fn inserted(&mut self, boxes: &Boxes, object: u32) {
        self.centers.resize(boxes.all().len(), Vec3::ZERO);
        self.centers[object as usize] = boxes.get(object).center();
        with!(&mut self.chosen, s => s.inserted(boxes, object));
        self.count_again(boxes);
    }

    fn removed(&mut self, boxes: &Boxes, object: u32, old: &Aabb) {
        with!(&mut self.chosen, s => s.removed(boxes, object, old));
        self.count_again(boxes);
    }

    fn relocated(&mut self, boxes: &Boxes, object: u32, old: &Aabb) {
        self.centers[object as usize] = boxes.get(object).center();
        with!(&mut self.chosen, s => s.relocated(boxes, object, old));
    }

    fn overlap(&self, boxes: &Boxes, region: &Aabb, visit: &mut impl FnMut(u32)) {
        with!(&self.chosen, s => s.overlap(boxes, region, visit));
    }

    fn sweep(&self, boxes: &Boxes, sweep: &Sweep, limit: f32, visit: &mut impl FnMut(u32) -> f32) {
        with!(&self.chosen, s => s.sweep(boxes, sweep, limit, visit));
    }

    fn sweep_many(
        &self,
        boxes: &Boxes,
        sweeps: &[Sweep],
        limits: &[f32],
        visit: &mut impl FnMut(usize, u32) -> f32,
    ) {
        with!(&self.chosen, s => s.sweep_many(boxes, sweeps, limits, visit));
    }

    fn approach(&self, boxes: &Boxes, point: Vec3, limit: f32, visit: &mut impl FnMut(u32) -> f32) {
        with!(&self.chosen, s => s.approach(boxes, point, limit, visit));
    }

    fn pairs(&self, boxes: &Boxes, found: &mut Vec<Pair>) {
        with!(&self.chosen, s => s.pairs(boxes, found));
    }

    fn memory(&self) -> usize {
        size_of_val(&self.centers[..]) + with!(&self.chosen, s => s.memory())
    }
}
