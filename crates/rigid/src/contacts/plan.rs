//! Which shapes of a model may touch, and who carries them.

use super::tables::{Solid, found};
use super::{Corners, Meshes};
use crate::SolverError;
use collide::{Route, kind};
use model::{CollisionFilter, Geometry, Material, Model, Pose, Shape, ShapeId};
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// Points of contact that tables have room for, at most: a world of that many takes half a gigabyte in single precision.
const MOST_POINTS: usize = 1 << 20;

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

/// Rows of the sights, by what tells them apart: the shape, the group that it is seen from, and whether as a hull.
type Known = HashMap<(ShapeId, usize, bool), usize>;

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
    /// Any surfaces that press resist more while they stick than while they slide.
    pub(super) sticks: bool,
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

    /// Whether things may touch that no joints hold together.
    pub(crate) fn has_strangers(&self) -> bool {
        let strangers = |pair: &Pair| {
            let [a, b] = pair.rows.map(|row| self.sights[row].seat.group);
            pair.list() == found::BETWEEN && a != b
        };
        self.pairs.iter().any(strangers)
    }

    /// Whether any surfaces that press resist twisting or rolling on each other.
    pub(crate) fn grips(&self, model: &Model) -> bool {
        self.any_surface(model, |surface| {
            surface.torsional_friction > 0.0 || surface.rolling_friction > 0.0
        })
    }

    /// Whether any surfaces that press are such.
    fn any_surface(&self, model: &Model, is: impl Fn(&Material) -> bool) -> bool {
        let solid = self.pairs.iter().filter(|pair| !pair.senses);
        let mut surfaces = solid.map(|p| model.contact_material(p.shapes[0], p.shapes[1]));
        surfaces.any(|surface| is(&surface))
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
            sticks: false,
            corners: Corners::default(),
            meshes: Meshes::default(),
        }
    }

    /// Whether tables have room for a model's points of contact, as far as its shapes have kernels.
    pub(crate) fn has_room(model: &Model) -> bool {
        let kind = |shape: &Shape| Solid::new(shape, "").ok().map(|solid| solid.kind);
        let kinds = Vec::from_iter(model.shapes.iter().map(kind));
        let mut left = MOST_POINTS;
        CollisionFilter::new(model).pairs().all(|(a, b)| {
            let route = kinds[a.0].zip(kinds[b.0]);
            let route = route.and_then(|(a, b)| Route::of(a, b));
            let rest = left.checked_sub(route.map_or(0, Route::points));
            left = rest.unwrap_or(0);
            rest.is_some()
        })
    }

    /// Finds the pairs; `seat` tells who carries a shape.
    ///
    /// # Errors
    /// A shape that no kernel collides; more points of contact than tables have room for.
    pub(crate) fn new(
        model: &Model,
        solver: &'static str,
        seat: impl Fn(&Shape) -> Seat,
    ) -> Result<Self, SolverError> {
        let (mut plan, mut known, mut points) = (Self::empty(), Known::new(), 0);
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
            plan.add(route, [a, b], seats, [senses, as_hull], &mut known);
            points += route.points();
            if points > MOST_POINTS {
                return Err(SolverError::TooManyContacts {
                    solver,
                    shapes: model.shapes.len(),
                    most: MOST_POINTS,
                });
            }
        }
        plan.assign_slots();
        plan.sticks = plan.any_surface(model, |surface| surface.sticking() > surface.friction);
        let mut once = HashSet::new();
        let sights = plan.sights.iter().map(|s| (s.shape, s.as_hull));
        let shapes = Vec::from_iter(sights.filter(|seen| once.insert(*seen)));
        let seen = |as_hull| {
            let shapes = shapes.iter().filter(move |s| s.1 == as_hull);
            shapes.map(|(shape, _)| &model.shapes[shape.0].geometry)
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
        known: &mut Known,
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
            let sight = Sight {
                shape: shapes[i],
                seat: seats[i],
                seen: mover.group,
                as_hull: as_hull && i == 1,
            };
            let key = (sight.shape, sight.seen, sight.as_hull);
            *known.entry(key).or_insert_with(|| {
                self.sights.push(sight);
                self.sights.len() - 1
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

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, DVec3};
    use model::{Builder, Hull, TriangleMesh};

    /// So many free boxes and hulls, above a plane and a field of heights.
    fn many(bodies: usize) -> Model {
        let mut world = Builder::new("many");
        let ground = world.object("ground");
        ground.scenery(Geometry::Plane {
            half_x: 0.0,
            half_z: 0.0,
        });
        let field = TriangleMesh::height_field(&[vec![0.0; 2], vec![0.0; 2]], DVec2::ONE);
        ground.scenery(Geometry::Mesh(field.unwrap()));
        let object = world.object("bodies");
        for i in 0..bodies {
            let half = DVec3::new(0.1, 0.2, 0.3 + 1e-3 * i as f64);
            let corners = [
                DVec3::ZERO,
                half.x * DVec3::X,
                half.y * DVec3::Y,
                half.z * DVec3::Z,
            ];
            let geometry = match i % 3 {
                0 => Geometry::Hull(Hull::new(&corners).unwrap()),
                _ => Geometry::Box { half },
            };
            object.body(format!("body_{i}")).shape(geometry);
        }
        world.build().unwrap()
    }

    /// Each body in a row and a group of its own, after those of what does not move.
    fn seat(model: &Model, shape: &Shape) -> Seat {
        let (row, group, mass) = match shape.body {
            Some(body) => (model.bodies.len() + body.0, body.0, 1.0 + body.0 as f64),
            None => (0, 0, f64::INFINITY),
        };
        Seat {
            row,
            group,
            place: Pose::IDENTITY,
            mass,
        }
    }

    /// Sights are numbered as pairs first see them, and none twice, which a search through all of them says, too.
    #[test]
    fn every_shape_is_seen_once_from_every_group() {
        let model = many(120);
        let plan = ContactPlan::new(&model, "none", |shape| seat(&model, shape)).unwrap();
        let mut pairs = plan.pairs.clone();
        pairs.sort_by_key(|pair| {
            let [a, b] = pair.shapes;
            (a.min(b), a.max(b))
        });
        assert_eq!(pairs.len(), 120 * 119 / 2 + 2 * 120);
        let mut sights: Vec<Sight> = Vec::new();
        for pair in &pairs {
            for (side, shape) in pair.shapes.into_iter().enumerate() {
                let mut seat = seat(&model, &model.shapes[shape.0]);
                if !seat.moves() {
                    (seat.row, seat.group) = (pair.mover.group, pair.mover.group);
                }
                let sight = Sight {
                    shape,
                    seat,
                    seen: pair.mover.group,
                    as_hull: false,
                };
                let known = sights.iter().position(|s| *s == sight);
                let row = known.unwrap_or(sights.len());
                assert_eq!(pair.rows[side], row);
                if known.is_none() {
                    sights.push(sight);
                }
            }
        }
        assert_eq!(plan.sights, sights);
        // Each third body is a hull of four corners, and no two are alike.
        assert_eq!(plan.corners.rows(), 4 * 120 / 3);
    }

    #[test]
    fn more_points_than_there_is_room_for_are_refused() {
        let model = many(1500);
        let refused = ContactPlan::new(&model, "xpbd", |shape| seat(&model, shape)).unwrap_err();
        let told = refused.to_string();
        assert!(
            told.contains("1502 shapes") && told.contains("1048576"),
            "{told}"
        );
        assert!(told.contains("use the solver `impulse`"), "{told}");
        assert!(!ContactPlan::has_room(&model));
        assert!(ContactPlan::has_room(&many(30)));
    }
}
