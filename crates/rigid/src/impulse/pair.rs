//! Shapes and pairs of them, a lane each.
//!
//! A pair is to [`ContactTables`] what a world with two shapes is: so the kernels for pairs are those
//! of every solver, and a register holds sixteen pairs of the same two kinds. Of a mesh a lane has the
//! triangles that are near its solid, and no others.

use super::memory::{Cached, CachedPoint};
use super::tables::{POINTS, global};
pub use crate::contacts::MARGIN;
use crate::contacts::tables::{
    found, pair_field, pair_link, placed_field, shape_field, shape_link, slot,
};
use crate::contacts::{ContactTables, narrow_phase_in_parts, store_placed};
use crate::lists::Lists;
pub use collide::FAR;
use collide::Route;
use collide::mesh::{MeshData, Triangle};
use numbers::machine::Links;
use numbers::machine::space::{Parameter, Scratch, State};
use numbers::{Float, Machine, Pose, Real, Table};

/// Fields of a shape's constants.
pub mod solid {
    /// Placement in its body's own frame.
    pub const POSE: usize = 0;
    /// Half sizes; see [`collide::kind`].
    pub const SIZE: usize = 7;
    /// Half of the box about it, along its own axes [m].
    pub const EXTENT: usize = 10;
    /// Radius of the ball that holds it [m].
    pub const RADIUS: usize = 13;
    /// Half of what it is thin [m].
    pub const THICKNESS: usize = 14;
    /// Numbers in a row.
    pub const WIDTH: usize = 15;
}

/// Fields of a shape in its place.
pub mod placed {
    use crate::contacts::tables::placed_field;
    /// Centre [m].
    pub const POSITION: usize = placed_field::POSITION;
    /// Its orientation in the world.
    pub const ORIENTATION: usize = placed_field::ORIENTATION;
    /// How far the shape can get within the step [m].
    pub const WAY: usize = placed_field::WAY;
    /// That, and the radius of the ball that holds the shape [m].
    pub const REACH: usize = placed_field::REACH;
    /// Half of the box, along the world's axes, that holds it throughout the step [m].
    pub const EXTENT: usize = placed_field::WIDTH;
    /// Numbers in a row.
    pub const WIDTH: usize = EXTENT + 3;
}

/// Tables of [`place`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeTables {
    /// Velocity and spin of the body.
    pub motion: Table<Scratch, 6>,
    /// Its acceleration and angular acceleration by all but contacts.
    pub force: Table<Scratch, 6>,
    /// Its centre and orientation.
    pub pose: Table<Scratch, 7>,
    /// One row: see [`solid`].
    pub solid: Table<Parameter, { solid::WIDTH }>,
    /// One row: see [`global`].
    pub global: Table<Parameter, { global::WIDTH }>,
    /// One row: see [`placed`].
    pub placed: Table<State, { placed::WIDTH }>,
}

impl ShapeTables {
    /// The layout; inlined, so that kernels know every offset when they are compiled.
    #[inline(always)]
    pub fn new() -> Self {
        let (mut state, mut scratch, mut parameters) = (0, 0, 0);
        Self {
            motion: Table::place(&mut scratch, 1),
            force: Table::place(&mut scratch, 1),
            pose: Table::place(&mut scratch, 1),
            global: Table::place(&mut parameters, 1),
            solid: Table::place(&mut parameters, 1),
            placed: Table::place(&mut state, 1),
        }
    }
}

impl Default for ShapeTables {
    fn default() -> Self {
        Self::new()
    }
}

/// A shape in its place, and how far it gets within the step.
#[inline(always)]
pub fn place<M: Machine>(k: &mut M, t: &ShapeTables) {
    let only = k.index(0);
    let h = k.load(t.global, only, global::STEP) * k.load(t.global, only, global::STEPS);
    let body = k.pose(t.pose, only, 0);
    let pose: Pose<M::R> = body * k.pose(t.solid, only, solid::POSE);
    let (v, w) = (k.vec3(t.motion, only, 0), k.vec3(t.motion, only, 3));
    let speed = (v + w.cross(pose.p - body.p)).length();
    let gained = k.vec3(t.force, only, 0).length() * h;
    let spun = k.vec3(t.force, only, 3).length() * h;
    let radius = k.load(t.solid, only, solid::RADIUS);
    let rates = [speed + gained, w.length() + spun];
    let way = store_placed(k, t.placed, only, pose, rates, radius, h);
    let axes = pose.q.to_mat3();
    let extent = k.vec3(t.solid, only, solid::EXTENT);
    let across = axes.y.abs().fma(extent.y, axes.z.abs() * extent.z);
    let [x, y, z] = axes.x.abs().fma(extent.x, across).to_array();
    let reach = [
        x.min(radius) + way,
        y.min(radius) + way,
        z.min(radius) + way,
    ];
    k.write(t.placed, only, placed::EXTENT, reach);
}

/// A shape as the kernels for pairs read it.
#[derive(Clone, Copy, Debug)]
pub struct Placed<T> {
    /// Half sizes.
    pub size: [T; 3],
    /// See [`placed`].
    pub placed: [T; placed::WIDTH],
}

/// Some triangles of a mesh.
#[derive(Clone, Copy, Debug, Default)]
pub struct Near<'a> {
    /// All of the mesh.
    pub all: &'a [Triangle],
    /// Which of them.
    pub numbers: &'a [u32],
}

/// A pair as the kernels read it.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a, T> {
    /// A and B.
    pub shapes: [&'a Placed<T>; 2],
    /// Their corners about their centres [m], three numbers each.
    pub corners: [&'a [T]; 2],
    /// Of those that meet as meshes, the triangles that are near the other.
    pub triangles: [Near<'a>; 2],
    /// The direction from A to B in which they touched last; zero where that is not known.
    pub known: [T; 3],
    /// The gap [m] that their surfaces keep.
    pub margin: T,
}

/// Where a lane has the numbers of its pair, for who fills lanes by other means than
/// [`PairTables::fill`] and [`PairTables::read`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PairPlaces {
    /// Of A and of B, among the parameters: half sizes.
    pub size: [usize; 2],
    /// Of A and of B, in the scratch: what [`place`] found, up to [`placed::REACH`].
    pub placed: [usize; 2],
    /// Among the parameters: the first corner of A, the first of B, and one past its last.
    pub corners: [usize; 3],
    /// Among the parameters: the gap that the surfaces keep.
    pub margin: usize,
    /// Among the parameters: the direction in which they touched last.
    pub known: usize,
    /// In the scratch: how many points are listed.
    pub listed: usize,
    /// In the scratch: the first point, and how many there are. See [`point_place`].
    pub points: [usize; 2],
    /// Among the parameters, where B is met as a mesh: the box of its only group, that of its only cluster, its triangles,
    /// and their vertices.
    pub mesh: [usize; 4],
}

/// Fields of a point that the kernels for pairs have found.
pub mod point_place {
    pub use crate::contacts::tables::slot::{DISTANCE, FEATURE, NORMAL, POSITION, WIDTH};
}

/// The tables for pairs of two kinds, a pair a lane.
#[derive(Clone, Debug, PartialEq)]
pub struct PairTables {
    route: Route,
    tables: ContactTables,
    links: Vec<u32>,
    /// The parameters that pairs have in common, and zeros.
    common: Vec<f64>,
    scratch: usize,
    /// Rows of A's corners, and of all.
    corners: [usize; 2],
    /// How many triangles of each there is room for.
    triangles: [usize; 2],
}

impl PairTables {
    /// The layout for A and B of these kinds, which the route must be the one of, and with so many
    /// corners each; of what meets as a mesh, with room for so many triangles.
    pub fn new(route: Route, kinds: [usize; 2], sizes: [usize; 2]) -> Self {
        let (mut parameters, mut links, mut scratch) = (0, 0, 0);
        let [a, b] = sizes;
        let (corners, triangles) = match route {
            Route::Mesh => ([a, a], [0, b]),
            Route::Meshes => ([0, 0], sizes),
            _ => ([a, a + b], [0, 0]),
        };
        let mesh = MeshData::room(&triangles);
        let vertices = corners[1] + mesh.vertex_rows();
        let points = route.points();
        let mut capacities = [0; found::LISTS];
        capacities[found::FIXED] = points;
        let mut routes = [1; Route::ALL.len() + 1];
        for (first, other) in routes.iter_mut().zip(Route::ALL) {
            *first = usize::from(route < other);
        }
        let tables = ContactTables {
            shapes: 2,
            slots: points,
            between: 0,
            sensed: points,
            sticks: false,
            routes,
            shape: Table::place(&mut parameters, 2),
            shape_links: Links::place(&mut links, 2),
            pair: Table::place(&mut parameters, 1),
            pair_links: Links::place(&mut links, 1),
            slot_links: Links::place(&mut links, points),
            placed: Table::place(&mut scratch, 2),
            slot: Table::place(&mut scratch, points),
            found: Lists::place(&capacities, &mut links, &mut scratch),
            kernels: collide::Tables::place(&mut parameters, vertices, &mut scratch)
                .remembering(&mut parameters),
            meshes: mesh.place(&mut parameters, &mut links, &mut scratch),
        };
        let mut numbers = vec![0; links];
        for (row, kind) in kinds.into_iter().enumerate() {
            numbers[tables.shape_links.at(row, shape_link::KIND)] = kind as u32;
        }
        let (of_a, of_b) = match route {
            // Each has one group of triangles, after the corners of what has none.
            Route::Mesh => ([0, a], [0, 1]),
            Route::Meshes => ([0, 1], [1, 2]),
            _ => ([0, a], corners),
        };
        for (row, range) in [of_a, of_b].into_iter().enumerate() {
            let at = tables.shape_links.at(row, shape_link::CORNERS);
            numbers[at] = range[0] as u32;
            numbers[at + 1] = range[1] as u32;
        }
        numbers[tables.pair_links.at(0, pair_link::B)] = 1;
        let mut common = vec![0.0; parameters];
        let (vertices, first) = (tables.kernels.vertices, corners[1]);
        mesh.write(&tables.meshes, vertices, first, &mut common, &mut numbers);
        Self {
            route,
            tables,
            links: numbers,
            common,
            scratch,
            corners,
            triangles,
        }
    }
    /// Where a lane has the numbers of its pair.
    pub fn places(&self) -> PairPlaces {
        let t = &self.tables;
        let first = t.kernels.vertices.start();
        let [a, all] = self.corners;
        let [groups, clusters, triangles] = t.meshes.places();
        PairPlaces {
            size: [0, 1].map(|row| t.shape.at(row, shape_field::SIZE)),
            placed: [0, 1].map(|row| t.placed.at(row, 0)),
            corners: [first, first + 3 * a, first + 3 * all],
            margin: t.pair.at(0, pair_field::MARGIN),
            known: t.kernels.known.map_or(0, |known| known.at(0, 0)),
            listed: t.found.length_at(found::FIXED),
            points: [t.slot.at(0, 0), self.route.points()],
            mesh: [groups, clusters, triangles, first + 3 * all],
        }
    }
    /// Has its kernel meet the pairs, as a function that is called.
    pub fn meet_in_parts<M: Machine>(&self, k: &mut M) {
        narrow_phase_in_parts(k, &self.tables);
    }
    /// What the kernels for pairs take.
    pub fn contacts(&self) -> &ContactTables {
        &self.tables
    }
    /// Whole numbers.
    pub fn links(&self) -> &[u32] {
        &self.links
    }
    /// Numbers a lane in parameters and scratch.
    pub fn lengths(&self) -> [usize; 2] {
        [self.common.len(), self.scratch]
    }
    /// Writes what pairs have in common into all lanes.
    pub fn begin<T: Float>(&self, width: usize, parameters: &mut [T]) {
        if self.triangles != [0, 0] {
            for (lanes, x) in parameters.chunks_exact_mut(width).zip(&self.common) {
                lanes.fill(T::from_f64(*x));
            }
        }
    }
    /// Writes a lane's pair, of which nothing is found yet.
    pub fn fill<T: Float>(
        &self,
        lane: usize,
        width: usize,
        pair: &Pair<'_, T>,
        parameters: &mut [T],
        scratch: &mut [T],
    ) {
        let t = &self.tables;
        for (row, shape) in pair.shapes.into_iter().enumerate() {
            let size = t.shape.at(row, shape_field::SIZE);
            for (i, x) in shape.size.iter().enumerate() {
                parameters[(size + i) * width + lane] = *x;
            }
            let at = t.placed.at(row, 0);
            for (i, x) in shape.placed[..placed_field::WIDTH].iter().enumerate() {
                scratch[(at + i) * width + lane] = *x;
            }
        }
        scratch[t.found.length_at(found::FIXED) * width + lane] = T::zero();
        for i in 0..self.route.points() {
            scratch[t.slot.at(i, slot::DISTANCE) * width + lane] = T::from_f64(FAR);
        }
        let first = t.kernels.vertices.start();
        let [a, all] = self.corners;
        let corners = [&pair.corners[0][..3 * a], &pair.corners[1][..3 * (all - a)]];
        for (i, x) in corners.into_iter().flatten().enumerate() {
            parameters[(first + i) * width + lane] = *x;
        }
        parameters[t.pair.at(0, pair_field::MARGIN) * width + lane] = pair.margin;
        if let Some(known) = t.kernels.known {
            for (i, x) in pair.known.into_iter().enumerate() {
                parameters[known.at(0, i) * width + lane] = x;
            }
        }
        let [a, b] = self.triangles;
        for (triangles, rows) in pair.triangles.into_iter().zip([0..a, a..a + b]) {
            t.meshes.put(
                triangles
                    .numbers
                    .iter()
                    .map(|t| &triangles.all[*t as usize]),
                rows,
                (t.kernels.vertices, all),
                (lane, width),
                parameters,
            );
        }
    }
    /// Whether it is worth its while to ask first which pairs are near, by [`ContactTables::apart`].
    pub fn takes_long(&self) -> bool {
        matches!(
            self.route,
            Route::BoxBox | Route::SphereConvex | Route::Convex
        )
    }
    /// How far [m] a lane's pair is apart at least, as [`ContactTables::apart`] has found.
    pub fn apart<T: Float>(&self, lane: usize, width: usize, scratch: &[T]) -> T {
        scratch[self.tables.slot.at(0, slot::DISTANCE) * width + lane]
    }
    /// Adds a lane's contacts: its points that are near enough to matter, those of one normal together.
    pub fn read<T: Float>(
        &self,
        lane: usize,
        width: usize,
        scratch: &[T],
        shapes: [u32; 2],
        to: &mut Vec<Cached<T>>,
    ) {
        let first = to.len();
        for i in 0..self.route.points() {
            let from = self.tables.slot.at(i, 0);
            let get = |field: usize| scratch[(from + field) * width + lane];
            let gap = get(slot::DISTANCE);
            if gap.to_f64() >= 0.5 * FAR {
                continue;
            }
            let vec3 = |field: usize| [get(field), get(field + 1), get(field + 2)];
            let normal = vec3(slot::NORMAL);
            let joins = |c: &Cached<T>| c.count < POINTS && is_one(c.normal, normal);
            let place = (first..to.len()).find(|place| joins(&to[*place]));
            let place = place.unwrap_or_else(|| {
                to.push(Cached {
                    shapes,
                    normal,
                    ..Cached::default()
                });
                to.len() - 1
            });
            let contact = &mut to[place];
            contact.points[contact.count] = CachedPoint {
                position: vec3(slot::POSITION),
                gap,
                feature: get(slot::FEATURE),
                ..CachedPoint::default()
            };
            contact.count += 1;
        }
    }
}

/// Whether two unit vectors are the same, within what a triangle's own normal is known to.
fn is_one<T: Float>(m: [T; 3], n: [T; 3]) -> bool {
    let apart = (0..3).map(|i| (m[i] - n[i]).to_f64().powi(2));
    apart.sum::<f64>() < ONE * ONE
}

/// Angle [rad] within which normals are one.
pub const ONE: f64 = 1e-4;
