//! Which shapes of a model may touch, and who carries them.

use super::tables::{Solid, found};
use super::{Corners, Meshes};
use crate::SolverError;
use collide::{Route, kind};
use model::{CollisionFilter, Geometry, Model, Pose, Shape, ShapeId};
use std::ops::Range;

/// What carries a shape, as a solver sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Seat {
    /// Row of the carrier.
    pub row: usize,
    /// Group of carriers that share a frame. What does not move sits in the row of that number,
    /// and is seen from every group.
    pub group: usize,
    /// Placement of the body in the carrier's frame.
    pub place: Pose,
    /// Mass [kg] of what moves with the carrier's group; infinite for what does not move.
    pub mass: f64,
}

impl Seat {
    fn moves(&self) -> bool {
        self.mass.is_finite()
    }
}

/// A pair of shapes, A first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub route: Route,
    pub shapes: [ShapeId; 2],
    /// Rows of the sights.
    pub rows: [usize; 2],
    /// The seat that its slots belong to.
    pub mover: Seat,
    /// One is a sensor, or both: told, and never solved.
    senses: bool,
    /// Both move.
    between: bool,
    /// A moves and B does not.
    pub flip: bool,
    pub mass: f64,
    pub slot: usize,
}

impl Pair {
    /// The list that its slots are named in.
    pub fn list(&self) -> usize {
        match (self.senses, self.between) {
            (true, _) => found::SENSED,
            (false, true) => found::BETWEEN,
            (false, false) => found::FIXED,
        }
    }
}

/// A shape as seen from a group of seats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sight {
    pub shape: ShapeId,
    pub seat: Seat,
    pub seen: usize,
    /// A mesh as a plane sees it, which takes it for its convex hull.
    pub as_hull: bool,
}

/// The pairs of a model, by kernel, and their slots, by the carrier that they belong to.
#[derive(Clone, Debug)]
pub(crate) struct ContactPlan {
    pub(super) sights: Vec<Sight>,
    pub(super) pairs: Vec<Pair>,
    /// Row of the pair of each slot.
    pub(super) slots: Vec<usize>,
    /// Carrier of each slot.
    movers: Vec<usize>,
    pub(super) between: usize,
    pub(super) sensed: usize,
    pub(super) corners: Corners,
    pub(super) meshes: Meshes,
}

impl ContactPlan {
    /// Whether anything that does not move has another side that what moves could get to.
    pub(crate) fn has_thin(&self, model: &Model) -> bool {
        let plane = |s: &ShapeId| matches!(model.shapes[s.0].geometry, Geometry::Plane { .. });
        let thin = |pair: &Pair| pair.list() == found::FIXED && !pair.shapes.iter().any(plane);
        self.pairs.iter().any(thin)
    }

    /// Whether any surfaces that press resist twisting or rolling on each other.
    pub(crate) fn grips(&self, model: &Model) -> bool {
        self.shapes()[..self.sensed].iter().any(|&[a, b]| {
            let surface = model.contact_material(a, b);
            surface.torsional_friction > 0.0 || surface.rolling_friction > 0.0
        })
    }

    /// No contacts.
    pub(crate) fn empty() -> Self {
        Self {
            sights: Vec::new(),
            pairs: Vec::new(),
            slots: Vec::new(),
            movers: Vec::new(),
            between: 0,
            sensed: 0,
            corners: Corners::default(),
            meshes: Meshes::default(),
        }
    }

    /// Finds the pairs; `seat` tells who carries a shape.
    ///
    /// # Errors
    /// A shape that no kernel collides.
    pub(crate) fn new(
        model: &Model,
        solver: &'static str,
        seat: impl Fn(&Shape) -> Seat,
    ) -> Result<Self, SolverError> {
        let mut plan = Self::empty();
        for (a, b) in CollisionFilter::new(model).pairs() {
            let shapes = [a, b].map(|s| &model.shapes[s.0]);
            let senses = shapes.iter().any(|shape| shape.sensor);
            let [first, second] = shapes.map(|shape| Solid::new(shape, solver));
            let (first, second) = (first?, second?);
            let Some(route) = Route::of(first.kind, second.kind) else {
                continue;
            };
            let (a, b) = if first.comes_before(&second) {
                (a, b)
            } else {
                (b, a)
            };
            let seats = [a, b].map(|s| seat(&model.shapes[s.0]));
            let as_hull = route == Route::PlaneHull && first.kind.max(second.kind) == kind::MESH;
            plan.add(route, [a, b], seats, [senses, as_hull]);
        }
        plan.assign_slots();
        let seen = |as_hull| {
            let sights = plan.sights.iter().filter(move |s| s.as_hull == as_hull);
            sights.map(|s| &model.shapes[s.shape.0].geometry)
        };
        let meshes = Meshes::new(seen(false));
        let hulls = seen(false).filter(|geometry| matches!(geometry, Geometry::Hull(_)));
        let corners = Corners::new(seen(true).chain(hulls), |count| count);
        (plan.meshes, plan.corners) = (meshes, corners);
        Ok(plan)
    }

    fn add(
        &mut self,
        route: Route,
        shapes: [ShapeId; 2],
        mut seats: [Seat; 2],
        [senses, as_hull]: [bool; 2],
    ) {
        let [a, b] = seats;
        let (flip, mover) = match (a.moves(), b.moves()) {
            (false, false) => return,
            (true, false) => (true, a),
            _ => (false, b),
        };
        for seat in seats.iter_mut().filter(|s| !s.moves()) {
            (seat.row, seat.group) = (mover.group, mover.group);
        }
        let mass = match (a.moves(), b.moves()) {
            (true, true) if a.group != b.group => a.mass * b.mass / (a.mass + b.mass),
            _ => mover.mass,
        };
        let rows = [0, 1].map(|i| {
            self.sight(Sight {
                shape: shapes[i],
                seat: seats[i],
                seen: mover.group,
                as_hull: as_hull && i == 1,
            })
        });
        self.pairs.push(Pair {
            route,
            shapes,
            rows,
            mover,
            senses,
            between: a.moves() && b.moves(),
            flip,
            mass,
            slot: 0,
        });
    }

    /// Row of a sight, new or known.
    fn sight(&mut self, sight: Sight) -> usize {
        let known = self.sights.iter().position(|s| *s == sight);
        known.unwrap_or_else(|| {
            self.sights.push(sight);
            self.sights.len() - 1
        })
    }

    /// Slots carrier by carrier, those of sensors last; pairs kernel by kernel.
    fn assign_slots(&mut self) {
        self.pairs
            .sort_by_key(|p| (p.senses, p.between, p.mover.row));
        let mut end = 0;
        for pair in &mut self.pairs {
            pair.slot = end;
            end += pair.route.points();
            if !pair.senses {
                self.sensed = end;
                if !pair.between {
                    self.between = end;
                }
            }
            self.movers.resize(end, pair.mover.row);
        }
        self.pairs.sort_by_key(|p| (p.route, p.slot));
        self.slots = vec![0; end];
        for (row, pair) in self.pairs.iter().enumerate() {
            self.slots[pair.slot..][..pair.route.points()].fill(row);
        }
    }

    /// The shapes of each slot; its normal points to the second.
    pub(crate) fn shapes(&self) -> Vec<[ShapeId; 2]> {
        let pairs = self.slots.iter().map(|&pair| &self.pairs[pair]);
        pairs
            .map(|p| {
                let [a, b] = p.shapes;
                if p.flip { [b, a] } else { [a, b] }
            })
            .collect()
    }

    /// How many slots each list of [`found`] may name.
    pub(super) fn capacities(&self) -> [usize; found::LISTS] {
        let all = self.slots.len();
        [self.between, self.sensed - self.between, all - self.sensed]
    }

    /// The slots between a carrier and what does not move.
    pub(crate) fn slots_of(&self, row: usize) -> Range<usize> {
        let fixed = &self.movers[..self.between];
        let begin = fixed.partition_point(|&mover| mover < row);
        begin
            ..begin
                + fixed[begin..]
                    .iter()
                    .take_while(|&&mover| mover == row)
                    .count()
    }

    /// The slots of solid pairs of which both move, with the carriers of A and B.
    pub(crate) fn between_slots(&self) -> impl Iterator<Item = (usize, Seat, Seat)> {
        (self.between..self.sensed).map(|slot| {
            let [a, b] = self.pairs[self.slots[slot]].rows;
            (slot, self.sights[a].seat, self.sights[b].seat)
        })
    }
}
