//! The shapes and pairs of a model as flat tables.

use super::plan::{ContactPlan, Pair, Sight};
use crate::SolverError;
use crate::lists::Lists;
use crate::tables::{Filler, UNBOUNDED};
use collide::mesh::MeshTables;
use collide::{Route, kind};
use glam::DVec3;
use model::{Geometry, Model, Pose, Shape};
use numbers::Table;
use numbers::machine::Links;
use numbers::machine::space::{Parameter, Scratch};
use std::collections::HashMap;

/// Fields of [`ContactTables::shape`].
pub(crate) mod shape_field {
    /// Half sizes; see [`collide::kind`].
    pub const SIZE: usize = 0;
    /// Placement in the frame of its seat.
    pub const POSE: usize = 3;
    /// Radius of the ball about its centre that holds it.
    pub const RADIUS: usize = 10;
    pub const WIDTH: usize = 11;
}

/// Fields of [`ContactTables::shape_links`].
pub(crate) mod shape_link {
    /// Row of the [`Places`](super::super::Places) that carries it.
    pub const SEAT: usize = 0;
    /// Group of seats whose frame that place is given in.
    pub const OWN: usize = 1;
    /// Group of seats in whose frame the pair is looked at.
    pub const SEEN: usize = 2;
    pub const KIND: usize = 3;
    /// The first of a hull's corners, and the one after the last; of a mesh's groups of triangles.
    pub const CORNERS: usize = 4;
    /// One of [`round`](super::round).
    pub const ROUND: usize = 6;
    pub const WIDTH: usize = 7;
}

/// Which turns of a shape its points of contact do not go along with, but for those of spheres and capsules.
pub(crate) mod round {
    /// None: they are at corners, and edges.
    pub const NOT: usize = 0;
    /// Those about its axis y.
    pub const ABOUT_AXIS: usize = 1;
    /// All.
    pub const ABOUT_ALL: usize = 2;
}

/// Fields of [`ContactTables::placed`].
pub(crate) mod placed_field {
    pub const POSITION: usize = 0;
    pub const ORIENTATION: usize = 3;
    /// How far the shape can get within the step, beyond its radius.
    pub const WAY: usize = 7;
    /// The same with its radius.
    pub const REACH: usize = 8;
    pub const WIDTH: usize = 9;
}

/// Fields of [`ContactTables::pair`].
pub(crate) mod pair_field {
    pub const FRICTION: usize = 0;
    // Restitution, stiffness, damping, the mass [kg] that the contact moves, and added mass follow.
    /// Gap [m] that the surfaces keep.
    pub const MARGIN: usize = 6;
    /// Torsional friction coefficient [m].
    pub const TORSION: usize = 7;
    // Rolling friction coefficient [m] follows.
    /// Approach [m/s] beyond which the spring would let the shapes through each other.
    pub const FASTEST: usize = 9;
    /// 2/5 m R² [kg·m²], of the mass m that the contact moves and the largest half extent R of the shape that moves; of
    /// two, B's.
    pub const INERTIA: usize = 10;
    /// Friction coefficient of what sticks.
    pub const STICKING: usize = 11;
    /// Radius of spheres and capsules [m], else 0, and half of the margin: of the shape that the normal points to, and
    /// of the other.
    pub const ROUNDING: usize = 12;
    pub const WIDTH: usize = 14;
}

/// Fields of [`ContactTables::pair_links`].
pub(crate) mod pair_link {
    /// Rows of [`ContactTables::shape`].
    pub const A: usize = 0;
    pub const B: usize = 1;
    pub const SLOT: usize = 2;
    /// 1 if A is the one that moves, so that the normal has to be turned.
    pub const FLIP: usize = 3;
    /// One of [`found`](super::found).
    pub const LIST: usize = 4;
    /// Row of the shape that the normal points to, then of the other.
    pub const SIDES: usize = 5;
    pub const WIDTH: usize = 7;
}

/// The lists of [`ContactTables::found`].
pub(crate) mod found {
    /// Of pairs of which one moves.
    pub const FIXED: usize = 0;
    /// Of pairs of which both move.
    pub const BETWEEN: usize = 1;
    /// The two above, which are to be solved.
    pub const SOLID: usize = 2;
    /// Of sensors.
    pub const SENSED: usize = 2;
    pub const LISTS: usize = 3;
}

/// Fields of [`ContactTables::slot`].
pub(crate) mod slot {
    /// Midway between the surfaces, in the frame the pair is looked at in [m].
    pub const POSITION: usize = 0;
    /// Unit vector towards the shape that moves.
    pub const NORMAL: usize = 3;
    /// Gap less the margin that the surfaces keep [m], or [`FAR`](collide::FAR).
    pub const DISTANCE: usize = 6;
    /// What touches what; see [`collide::Contact::feature`].
    pub const FEATURE: usize = 7;
    /// Numbers in a row.
    pub const WIDTH: usize = 8;
}

/// Fields of [`ContactTables::slot_links`].
pub(crate) mod slot_link {
    /// Row of [`ContactTables::pair`].
    pub const PAIR: usize = 0;
    /// Row of the carrier that moves; of two, B's.
    pub const MOVER: usize = 1;
    /// Group of that carrier.
    pub const GROUP: usize = 2;
    pub const WIDTH: usize = 3;
}

/// Where the numbers of shapes, pairs and slots lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactTables {
    pub(crate) shapes: usize,
    pub(crate) slots: usize,
    /// Slots from here on are of pairs of which both move.
    pub(crate) between: usize,
    /// Slots from here on are of sensors, which are told and never solved.
    pub(crate) sensed: usize,
    /// True if any surfaces that press resist more while they stick than while they slide.
    pub(crate) sticks: bool,
    /// First pair of each kernel, and one past the last.
    pub(crate) routes: [usize; Route::ALL.len() + 1],
    pub(crate) shape: Table<Parameter, { shape_field::WIDTH }>,
    pub(crate) shape_links: Links<{ shape_link::WIDTH }>,
    pub(crate) pair: Table<Parameter, { pair_field::WIDTH }>,
    pub(crate) pair_links: Links<{ pair_link::WIDTH }>,
    pub(crate) slot_links: Links<{ slot_link::WIDTH }>,
    pub(crate) placed: Table<Scratch, { placed_field::WIDTH }>,
    pub(crate) slot: Table<Scratch, { slot::WIDTH }>,
    /// The slots that are near: see [`found`].
    pub(crate) found: Lists,
    pub(crate) kernels: collide::Tables,
    pub(crate) meshes: MeshTables,
}

/// A shape as the kernels have it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solid {
    /// One of [`collide::kind`].
    pub kind: usize,
    /// Half sizes [m].
    pub size: DVec3,
    /// Radius [m] of the ball about its centre that holds it.
    pub radius: f64,
    /// The kernels' frame in that of the shape's carrier.
    pub pose: Pose,
}

impl Solid {
    /// # Errors
    /// A shape that no kernel collides.
    pub fn new(shape: &Shape, solver: &'static str) -> Result<Self, SolverError> {
        let (kind, size, radius) = match shape.geometry {
            Geometry::Plane { .. } => (kind::PLANE, DVec3::ZERO, 0.0),
            Geometry::Sphere { radius } => (kind::SPHERE, DVec3::new(radius, 0.0, 0.0), radius),
            Geometry::Capsule {
                radius: r,
                half_height: h,
            } => (kind::CAPSULE, DVec3::new(r, h, 0.0), r.max(h)),
            Geometry::Cylinder {
                radius: r,
                half_height: h,
            } => (kind::CYLINDER, DVec3::new(r, h, 0.0), r.hypot(h)),
            Geometry::Cone {
                radius: r,
                half_height: h,
            } => (kind::CONE, DVec3::new(r, h, 0.0), r.hypot(h)),
            Geometry::Box { half } => (kind::BOX, half, half.length()),
            Geometry::Ellipsoid { half } => (kind::ELLIPSOID, half, half.max_element()),
            Geometry::Hull(ref hull) => (kind::HULL, hull.half_extents(), hull.radius()),
            Geometry::Mesh(ref mesh) => {
                let half = mesh.half_extents();
                (kind::MESH, half, half.length())
            }
            Geometry::MeshFile { ref file, .. } => {
                let name = match (shape.name.as_str(), shape.body) {
                    ("", Some(body)) => format!("{file}, of the body at row {}", body.0),
                    ("", None) => format!("{file}, of the world"),
                    (name, _) => name.to_owned(),
                };
                return Err(SolverError::Unsupported {
                    solver,
                    what: "contacts of the mesh",
                    name,
                    remedy: "have meshes read (--meshes exact, or --meshes hull for their convex hulls), \
                             use solids, let the shape not collide, or switch contacts off",
                });
            }
        };
        Ok(Self {
            kind,
            size,
            radius,
            pose: shape.pose * Pose::at(shape.geometry.center()),
        })
    }

    /// Whether it is A of a pair: what has the lower kind, and of two meshes the smaller one.
    pub fn comes_before(&self, other: &Self) -> bool {
        let meshes = [self.kind, other.kind] == [kind::MESH; 2];
        self.kind < other.kind || self.kind == other.kind && !(meshes && other.radius < self.radius)
    }
}

/// Share of the way through each other that two shapes may go while a spring stops them. Limbs of one tree that strike
/// each other may go farther than what flies into something else.
fn passable(plan: &ContactPlan, pair: &Pair) -> f64 {
    let [a, b] = pair.rows.map(|row| plan.sights[row].seat);
    let limbs = pair.list() != found::FIXED && a.group == b.group;
    if limbs { 1.0 } else { 0.25 }
}

/// Half of what a shape is thin [m]; without end of a plane.
pub(crate) fn thickness(geometry: &Geometry) -> f64 {
    let least = |half: DVec3| half.min_element();
    let half = geometry.half_extents().map_or(UNBOUNDED, least);
    match geometry {
        // Its middle is not where it is thick.
        Geometry::Cone { .. } => 0.5 * half,
        Geometry::Hull(hull) => hull.half_width(),
        _ => half,
    }
}

/// One of [`round`]. What an ellipsoid rolls on is taken to be as far from its centre as its contact.
fn roundness(geometry: &Geometry) -> usize {
    match geometry {
        Geometry::Cylinder { .. } | Geometry::Cone { .. } => round::ABOUT_AXIS,
        Geometry::Ellipsoid { .. } => round::ABOUT_ALL,
        _ => round::NOT,
    }
}

/// Radius [m] of what has the same all over; else 0.
fn rounding(geometry: &Geometry) -> f64 {
    match *geometry {
        Geometry::Sphere { radius } | Geometry::Capsule { radius, .. } => radius,
        _ => 0.0,
    }
}

/// What [`way_through`] asks of a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Thin {
    /// See [`thickness`].
    pub half: f64,
    /// Radius [m] of the ball that holds it.
    pub radius: f64,
    pub mesh: bool,
}

/// The way [m] on which two shapes get through each other: half of what both are thin. Of that a mesh has nothing, as it
/// is a surface; of two, the smaller one has what the box about it has.
pub(crate) fn way_through([a, b]: [Thin; 2]) -> f64 {
    match [a.mesh, b.mesh] {
        [false, false] => a.half + b.half,
        [true, false] => b.half,
        [false, true] => a.half,
        [true, true] if a.radius < b.radius => a.half,
        [true, true] => b.half,
    }
}

/// The approach [m/s] that a spring k with a damper d stops on a `way` [m] where it moves a mass m. It lets in by v / ω,
/// where ω² = k / m; with a damping ratio ζ = d / (2 m ω) of 1 and more, by v / (e ω) at most.
fn fastest(way: f64, [stiffness, damping, mass]: [f64; 3]) -> f64 {
    let critical = 4.0 * stiffness * mass;
    let damped = damping.powi(2) > critical * (1.0 - 1e-9);
    let share = if damped { std::f64::consts::E } else { 1.0 };
    (way * share * (stiffness / mass).sqrt()).min(UNBOUNDED)
}

/// The largest half extent [m] of a shape; 1 of a plane.
fn largest(shape: &Shape) -> f64 {
    let half = shape.geometry.half_extents();
    half.map_or(1.0, DVec3::max_element)
}

impl ContactTables {
    /// How many pairs there are.
    pub(crate) fn pairs(&self) -> usize {
        self.routes[Route::ALL.len()]
    }
    /// Lays the rows out at the ends of the three memories.
    pub(crate) fn place(
        plan: &ContactPlan,
        parameters: &mut usize,
        links: &mut usize,
        scratch: &mut usize,
    ) -> Self {
        let (shapes, pairs, slots) = (plan.sights.len(), plan.pairs.len(), plan.slots.len());
        let mut routes = [pairs; Route::ALL.len() + 1];
        for (first, route) in routes.iter_mut().zip(Route::ALL) {
            *first = plan.pairs.iter().filter(|p| p.route < route).count();
        }
        Self {
            shapes,
            slots,
            between: plan.between,
            sensed: plan.sensed,
            sticks: plan.sticks,
            routes,
            shape: Table::place(parameters, shapes),
            shape_links: Links::place(links, shapes),
            pair: Table::place(parameters, pairs),
            pair_links: Links::place(links, pairs),
            slot_links: Links::place(links, slots),
            placed: Table::place(scratch, shapes),
            slot: Table::place(scratch, slots),
            found: Lists::place(&plan.capacities(), links, scratch),
            kernels: collide::Tables::place(
                parameters,
                plan.corners.rows() + plan.meshes.data.vertex_rows(),
                scratch,
            ),
            meshes: plan.meshes.data.place(parameters, links, scratch),
        }
    }

    /// Writes shapes, pairs and slots.
    ///
    /// # Errors
    /// A shape that no kernel collides.
    pub(crate) fn fill(
        &self,
        model: &Model,
        plan: &ContactPlan,
        solver: &'static str,
        f: &mut Filler,
    ) -> Result<(), SolverError> {
        let mut corners = HashMap::new();
        for (row, sight) in plan.sights.iter().enumerate() {
            let shape = &model.shapes[sight.shape.0];
            let solid = Solid::new(shape, solver)?;
            f.vec3(self.shape, row, shape_field::SIZE, solid.size);
            f.pose(
                self.shape,
                row,
                shape_field::POSE,
                sight.seat.place * solid.pose,
            );
            f.number(self.shape, row, shape_field::RADIUS, solid.radius);
            f.link(self.shape_links, row, shape_link::SEAT, sight.seat.row);
            f.link(self.shape_links, row, shape_link::OWN, sight.seat.group);
            f.link(self.shape_links, row, shape_link::SEEN, sight.seen);
            let kind = if sight.as_hull {
                kind::HULL
            } else {
                solid.kind
            };
            f.link(self.shape_links, row, shape_link::KIND, kind);
            let round = roundness(&shape.geometry);
            f.link(self.shape_links, row, shape_link::ROUND, round);
            let rows = corners
                .entry((sight.shape, kind))
                .or_insert_with(|| match kind {
                    kind::MESH => plan.meshes.of(&shape.geometry),
                    _ => plan.corners.of(&shape.geometry),
                });
            f.link(self.shape_links, row, shape_link::CORNERS, rows.start);
            f.link(self.shape_links, row, shape_link::CORNERS + 1, rows.end);
        }
        plan.corners.fill(self.kernels.vertices, f);
        plan.meshes.data.write(
            &self.meshes,
            self.kernels.vertices,
            plan.corners.rows(),
            &mut f.parameters,
            &mut f.links,
        );
        let thin = |sight: &Sight| {
            let geometry = &model.shapes[sight.shape.0].geometry;
            let half = geometry.half_extents().unwrap_or(DVec3::INFINITY);
            Thin {
                half: thickness(geometry),
                radius: half.length(),
                mesh: matches!(geometry, Geometry::Mesh(_)),
            }
        };
        let thin = Vec::from_iter(plan.sights.iter().map(thin));
        for (row, pair) in plan.pairs.iter().enumerate() {
            f.link(self.pair_links, row, pair_link::A, pair.rows[0]);
            f.link(self.pair_links, row, pair_link::B, pair.rows[1]);
            f.link(self.pair_links, row, pair_link::SLOT, pair.slot);
            f.link(
                self.pair_links,
                row,
                pair_link::FLIP,
                usize::from(pair.flip),
            );
            f.link(self.pair_links, row, pair_link::LIST, pair.list());
            let sides = if pair.flip { [0, 1] } else { [1, 0] };
            for (i, side) in sides.into_iter().enumerate() {
                f.link(self.pair_links, row, pair_link::SIDES + i, pair.rows[side]);
            }
            let material = model.contact_material(pair.shapes[0], pair.shapes[1]);
            let shapes = pair.shapes.map(|s| &model.shapes[s.0]);
            let (stiffness, damping) = material.softness.spring(pair.mass);
            let added = material.softness.added_mass(pair.mass);
            let way = way_through(pair.rows.map(|row| thin[row]));
            let fastest = fastest(way, [stiffness, damping, pair.mass + added]);
            let numbers = [
                material.friction,
                material.restitution,
                stiffness,
                damping,
                pair.mass,
                added,
                material.margin,
                material.torsional_friction,
                material.rolling_friction,
                passable(plan, pair) * fastest,
                0.4 * pair.mass * largest(shapes[sides[0]]).powi(2),
                material.sticking(),
                rounding(&shapes[sides[0]].geometry) + 0.5 * material.margin,
                rounding(&shapes[sides[1]].geometry) + 0.5 * material.margin,
            ];
            f.numbers(self.pair, row, 0, &numbers);
        }
        self.found.fill(&plan.capacities(), f);
        for (row, &pair) in plan.slots.iter().enumerate() {
            f.link(self.slot_links, row, slot_link::PAIR, pair);
            f.link(
                self.slot_links,
                row,
                slot_link::MOVER,
                plan.pairs[pair].mover.row,
            );
            f.link(
                self.slot_links,
                row,
                slot_link::GROUP,
                plan.pairs[pair].mover.group,
            );
        }
        Ok(())
    }
}
