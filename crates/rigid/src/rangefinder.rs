//! How far rays get from a place on a body, or in the world, before they meet a shape.
//!
//! A kernel of its own, not of a solver: it reads what a solver has reported, which is its input, and writes a distance for
//! each ray.
//! The rays go along fixed directions of the place's frame. So the shapes are looked through one by one: where the frame
//! is in a shape's is worked out once, and each ray then takes a turn of its direction and one line against one solid.
//! Rays that pass the ball about a shape, or have met something before it, leave it out.

use crate::Sheet;
use crate::contacts::tables::Solid;
use crate::output::{OutputTables, body};
use crate::tables::Filler;
use collide::kind;
use collide::ray::kernel::{Line, Span};
use collide::ray::surface::{SurfaceData, SurfaceTables};
use glam::DVec3;
use model::{Geometry, Model, Mount, Shape};
use numbers::machine::Links;
use numbers::machine::space::{Input, Output, Parameter, Scratch};
use numbers::{Machine, Mat3, Pose, Real, Table, Vec3};
use std::ops::Range;

/// What is farther [m] is not met: 2⁵⁰, some 1e15, of which single precision has the square.
pub const FARTHEST: f64 = (1_u64 << 50) as f64;

/// Fields of [`Tables::shape`].
mod shape_field {
    /// Half sizes; see [`collide::kind`].
    pub const SIZE: usize = 0;
    /// Placement on its carrier.
    pub const POSE: usize = 3;
    /// Radius of the ball about its centre that holds it.
    pub const RADIUS: usize = 10;
    pub const WIDTH: usize = 11;
}

/// Fields of [`Tables::shape_links`].
mod shape_link {
    /// Row of the body that carries it, or how many there are.
    pub const CARRIER: usize = 0;
    /// The first of a hull's faces, or of a mesh's groups.
    pub const FIRST: usize = 1;
    /// One past the last.
    pub const END: usize = 2;
    pub const WIDTH: usize = 3;
}

/// Fields of [`Tables::seen`]: the rays' frame in a shape's.
mod seen_field {
    pub const ORIGIN: usize = 0;
    /// By columns.
    pub const AXES: usize = 3;
    pub const WIDTH: usize = 12;
}

/// Where the numbers lie.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Tables {
    /// Of all worlds, as the solver has reported them.
    bodies: Table<Input, { body::WIDTH }>,
    /// How many there are.
    count: usize,
    /// The body that carries the rays.
    carrier: Option<usize>,
    /// Where they start on it, or in the world.
    mount: Table<Parameter, 7>,
    /// How far they may go.
    range: Table<Parameter>,
    rays: usize,
    direction: Table<Parameter, 3>,
    /// First shape of each kind, and one past the last.
    kinds: [usize; kind::MESH + 2],
    shape: Table<Parameter, { shape_field::WIDTH }>,
    shape_links: Links<{ shape_link::WIDTH }>,
    surfaces: SurfaceTables,
    seen: Table<Scratch, { seen_field::WIDTH }>,
    distance: Table<Output>,
}

/// Rays from one place of a model, compiled to tables.
#[derive(Clone, Debug, PartialEq)]
pub struct Rangefinder {
    tables: Tables,
    sheet: Sheet,
}

/// The shapes that rays from a mount may meet.
fn seen<'a>(model: &'a Model, mount: &Mount) -> impl Iterator<Item = &'a Shape> {
    let carrier = mount.body;
    let own = move |shape: &Shape| shape.body.is_some() && shape.body == carrier;
    let shapes = model.shapes.iter();
    shapes.filter(move |shape| !shape.sensor && !own(shape))
}

/// The shapes that rays from a mount may meet, kind after kind.
struct Scene<'a> {
    solids: Vec<(&'a Shape, Solid)>,
    surfaces: SurfaceData,
    /// Of each solid, its faces or groups.
    rows: Vec<Range<usize>>,
}

impl<'a> Scene<'a> {
    fn of(model: &'a Model, mount: &Mount) -> Option<Self> {
        // Only the name of a file is no solid.
        let solid = |shape| Some((shape, Solid::new(shape, "rangefinder").ok()?));
        let solids = seen(model, mount).map(solid);
        let mut solids = solids.collect::<Option<Vec<_>>>()?;
        solids.sort_by_key(|(_, solid)| solid.kind);
        let mut surfaces = SurfaceData::default();
        let mut rows: Vec<Range<usize>> = Vec::with_capacity(solids.len());
        for (nth, (Shape { geometry, .. }, _)) in solids.iter().enumerate() {
            let mut before = solids[..nth].iter();
            let known = before.position(|(other, _)| other.geometry == *geometry);
            rows.push(match (known, geometry) {
                (Some(known), _) => rows[known].clone(),
                (_, Geometry::Hull(hull)) => surfaces.add_hull(hull, geometry.center()),
                (_, Geometry::Mesh(mesh)) => surfaces.add_mesh(mesh),
                _ => 0..0,
            });
        }
        Some(Self {
            solids,
            surfaces,
            rows,
        })
    }
    /// How many rows the surfaces of all solids have, at most.
    fn surface_rows(&self) -> usize {
        let rows = |(Shape { geometry, .. }, _): &(&Shape, _)| match geometry {
            Geometry::Hull(hull) => hull.faces().count(),
            // With the clusters and groups that these are in.
            Geometry::Mesh(mesh) => 2 * mesh.triangles().len(),
            _ => 0,
        };
        self.solids.iter().map(rows).sum()
    }
}

impl Rangefinder {
    /// How many tests a ray from a mount takes, about: one for each shape, and for a mesh the root of its triangles, in each
    /// lane, as each one's ray passes others.
    pub fn tests(model: &Model, mount: &Mount, lanes: usize) -> f64 {
        let of = |shape: &Shape| match &shape.geometry {
            Geometry::Mesh(mesh) => 1.0 + lanes as f64 * (mesh.triangles().len() as f64).sqrt(),
            _ => 1.0,
        };
        seen(model, mount).map(of).sum()
    }

    /// Of rays along these directions of unit length, in the frame of a mount, that go no farther than `range` [m]. They
    /// pass through sensors and through the shapes of the body that carries them.
    ///
    /// `None` where they may meet a mesh that is the name of its file only.
    pub fn new(
        model: &Model,
        outputs: &OutputTables,
        mount: &Mount,
        directions: &[DVec3],
        range: f64,
    ) -> Option<Self> {
        let scene = Scene::of(model, mount)?;
        let (mut parameters, mut links, mut scratch) = (0, 0, 0);
        let before = |kind| scene.solids.iter().filter(|(_, s)| s.kind < kind).count();
        let shapes = scene.solids.len();
        let tables = Tables {
            bodies: Table::place(&mut outputs.body.start(), model.bodies.len()),
            count: model.bodies.len(),
            carrier: mount.body.map(|body| body.0),
            mount: Table::place(&mut parameters, 1),
            range: Table::place(&mut parameters, 1),
            rays: directions.len(),
            direction: Table::place(&mut parameters, directions.len()),
            kinds: std::array::from_fn(before),
            shape: Table::place(&mut parameters, shapes),
            shape_links: Links::place(&mut links, shapes),
            surfaces: scene.surfaces.place(&mut parameters, &mut links),
            seen: Table::place(&mut scratch, shapes),
            distance: Table::place(&mut 0, directions.len()),
        };
        let mut f = Filler::new(parameters, links);
        f.pose(tables.mount, 0, 0, mount.pose);
        f.number(tables.range, 0, 0, range.min(FARTHEST));
        for (row, direction) in directions.iter().enumerate() {
            f.vec3(tables.direction, row, 0, *direction);
        }
        tables.fill(&scene, &mut f);
        // Each ray once for every shape and all rows of its surface, in loops over shapes.
        let rounds = (directions.len() + 1) * (1 + shapes + scene.surface_rows());
        let sheet = Sheet::new(f, [directions.len(), scratch], rounds);
        Some(Self { tables, sheet })
    }

    /// How many rays, and distances of each world.
    pub fn rays(&self) -> usize {
        self.tables.rays
    }
    /// What it is compiled to.
    pub fn sheet(&self) -> &Sheet {
        &self.sheet
    }
    /// Where in the parameters the direction of a ray lies, x, y, z.
    pub fn direction(&self, ray: usize) -> usize {
        self.tables.direction.at(ray, 0)
    }

    /// Writes how far [m] each ray gets: to where it first meets a shape, 0 where it starts in a solid, or its whole range.
    #[inline(always)]
    pub fn measure<M: Machine>(&self, k: &mut M) {
        // A copy on the stack: offsets stay in registers, whatever is written meanwhile.
        let t = self.tables;
        let range = k.load(t.range, k.index(0), 0);
        for ray in k.count(t.rays) {
            k.store(t.distance, ray, 0, range);
        }
        t.place(k);
        t.meet::<M, HalfSpace>(k);
        t.meet::<M, Sphere>(k);
        t.meet::<M, Capsule>(k);
        t.meet::<M, Cylinder>(k);
        t.meet::<M, Cone>(k);
        t.meet::<M, Cuboid>(k);
        t.meet::<M, Ellipsoid>(k);
        t.meet::<M, Hull>(k);
        t.meet_meshes(k);
    }
}

/// A body's placement, its orientation scaled to unit length.
#[inline(always)]
fn placed<M: Machine>(k: &M, t: &Tables, row: M::I) -> Pose<M::R> {
    let pose = k.pose(t.bodies, row, body::POSITION);
    Pose::new(pose.p, pose.q.normalized())
}

/// A shape, and the rays' frame in its own.
struct Seen<M: Machine> {
    row: M::I,
    origin: Vec3<M::R>,
    axes: Mat3<M::R>,
    radius: M::R,
}

/// A ray's line in a shape's frame, from where it may enter the ball about that, so that far shapes cost no more digits
/// than they must.
struct Near<R: Real> {
    line: Line<R>,
    /// The distance of that point along the ray [m].
    start: R,
    /// What was met so far [m].
    known: R,
    /// Where the ray passes the ball before that.
    passes: R::Mask,
}

impl<M: Machine> Seen<M> {
    #[inline(always)]
    fn new(k: &M, t: &Tables, row: M::I) -> Self {
        let axes = seen_field::AXES;
        Self {
            row,
            origin: k.vec3(t.seen, row, seen_field::ORIGIN),
            axes: Mat3::from_columns(
                k.vec3(t.seen, row, axes),
                k.vec3(t.seen, row, axes + 3),
                k.vec3(t.seen, row, axes + 6),
            ),
            radius: k.load(t.shape, row, shape_field::RADIUS),
        }
    }
    /// Where any ray may reach it.
    #[inline(always)]
    fn reached(&self, range: M::R) -> <M::R as Real>::Mask {
        let reach = self.radius + range;
        self.origin.length_squared().le(reach * reach)
    }
    #[inline(always)]
    fn near(&self, k: &M, t: &Tables, ray: M::I) -> Near<M::R> {
        let direction = self.axes * k.vec3(t.direction, ray, 0);
        let foot = -self.origin.dot(direction);
        let nearest = direction.fma(foot, self.origin);
        let by = nearest.length_squared().le(self.radius * self.radius);
        let ahead = (foot + self.radius).ge(M::R::zero());
        let start = (foot - self.radius).max(M::R::zero());
        let known = k.load(t.distance, ray, 0);
        let line = Line {
            origin: direction.fma(start, self.origin),
            direction,
        };
        Near {
            line,
            start,
            known,
            passes: by & ahead & start.lt(known),
        }
    }
}

impl Tables {
    /// Writes the shapes.
    fn fill(&self, scene: &Scene<'_>, f: &mut Filler) {
        for (row, ((shape, solid), surface)) in scene.solids.iter().zip(&scene.rows).enumerate() {
            f.vec3(self.shape, row, shape_field::SIZE, solid.size);
            f.pose(self.shape, row, shape_field::POSE, solid.pose);
            let endless = solid.kind == kind::PLANE;
            let radius = if endless { FARTHEST } else { solid.radius };
            f.number(self.shape, row, shape_field::RADIUS, radius);
            let carrier = shape.body.map_or(self.count, |body| body.0);
            f.link(self.shape_links, row, shape_link::CARRIER, carrier);
            f.link(self.shape_links, row, shape_link::FIRST, surface.start);
            f.link(self.shape_links, row, shape_link::END, surface.end);
        }
        scene
            .surfaces
            .write(&self.surfaces, &mut f.parameters, &mut f.links);
    }

    /// Places the rays' frame in that of each shape.
    #[inline(always)]
    fn place<M: Machine>(&self, k: &mut M) {
        let mount = k.pose(self.mount, k.index(0), 0);
        let eye = match self.carrier {
            Some(body) => placed(k, self, k.index(body)) * mount,
            None => mount,
        };
        for row in k.count(self.kinds[kind::MESH + 1]) {
            let own = k.pose(self.shape, row, shape_field::POSE);
            let carrier = k.link(self.shape_links, row, shape_link::CARRIER);
            if let Some(_branch) = k.when(k.equals(carrier, self.count)) {
                self.see(k, row, own, eye);
            }
            if let Some(_branch) = k.when(k.less(carrier, k.index(self.count))) {
                let shape = placed(k, self, carrier) * own;
                self.see(k, row, shape, eye);
            }
        }
    }
    #[inline(always)]
    fn see<M: Machine>(&self, k: &mut M, row: M::I, shape: Pose<M::R>, eye: Pose<M::R>) {
        let axes = shape.q.to_mat3();
        let origin = axes.transpose_mul(eye.p - shape.p);
        let turn = (shape.q.conjugate() * eye.q).to_mat3();
        k.store_vec3(self.seen, row, seen_field::ORIGIN, origin);
        k.store_vec3(self.seen, row, seen_field::AXES, turn.x);
        k.store_vec3(self.seen, row, seen_field::AXES + 3, turn.y);
        k.store_vec3(self.seen, row, seen_field::AXES + 6, turn.z);
    }

    /// All rays against all solids of a kind.
    #[inline(always)]
    fn meet<M: Machine, K: Kind>(&self, k: &mut M) {
        let (begin, end) = (
            k.index(self.kinds[K::KIND]),
            k.index(self.kinds[K::KIND + 1]),
        );
        let range = k.load(self.range, k.index(0), 0);
        for row in k.range(begin, end) {
            let shape = Seen::new(k, self, row);
            if let Some(_branch) = k.if_any(shape.reached(range)) {
                for ray in k.count(self.rays) {
                    let near = shape.near(k, self, ray);
                    if let Some(_branch) = k.if_any(near.passes) {
                        let span = K::span(k, self, row, &near.line);
                        let distance = near.start + span.enter.max(M::R::zero());
                        let met = near.passes
                            & span.enter.le(span.leave)
                            & span.leave.ge(M::R::zero())
                            & distance.lt(near.known);
                        k.store_where(met, self.distance, ray, 0, distance);
                    }
                }
            }
        }
    }

    /// All rays against all meshes.
    #[inline(always)]
    fn meet_meshes<M: Machine>(&self, k: &mut M) {
        let begin = k.index(self.kinds[kind::MESH]);
        let end = k.index(self.kinds[kind::MESH + 1]);
        let range = k.load(self.range, k.index(0), 0);
        for row in k.range(begin, end) {
            let shape = Seen::new(k, self, row);
            if let Some(_branch) = k.if_any(shape.reached(range)) {
                let groups = surface(k, self, shape.row);
                for ray in k.count(self.rays) {
                    let near = shape.near(k, self, ray);
                    if let Some(_branch) = k.if_any(near.passes) {
                        let left = near.known - near.start;
                        let first = self.surfaces.first_of_mesh(k, &near.line, groups, left);
                        let distance = near.start + first;
                        let met = near.passes & first.lt(left) & distance.lt(near.known);
                        k.store_where(met, self.distance, ray, 0, distance);
                    }
                }
            }
        }
    }
}

/// The rows of a hull or a mesh.
#[inline(always)]
fn surface<M: Machine>(k: &M, t: &Tables, row: M::I) -> [M::I; 2] {
    [
        k.link(t.shape_links, row, shape_link::FIRST),
        k.link(t.shape_links, row, shape_link::END),
    ]
}

/// A kind of convex solids.
trait Kind {
    /// One of [`kind`].
    const KIND: usize;
    /// Where a line is inside.
    fn span<M: Machine>(k: &M, t: &Tables, row: M::I, line: &Line<M::R>) -> Span<M::R>;
}

macro_rules! kinds {
    ($($name:ident $kind:ident |$line:ident, $size:ident| $span:expr;)+) => {$(
        struct $name;
        impl Kind for $name {
            const KIND: usize = kind::$kind;
            #[inline(always)]
            fn span<M: Machine>(k: &M, t: &Tables, row: M::I, $line: &Line<M::R>) -> Span<M::R> {
                let $size = k.vec3(t.shape, row, shape_field::SIZE);
                $span
            }
        }
    )+};
}

kinds! {
    HalfSpace PLANE |line, _size| line.half_space(Vec3::new(M::R::zero(), M::R::one(), M::R::zero()), M::R::zero());
    Sphere SPHERE |line, size| line.ball(M::R::zero(), size.x);
    Capsule CAPSULE |line, size| line.capsule(size.x, size.y - size.x);
    Cylinder CYLINDER |line, size| line.cylinder(size.x, size.y);
    Cone CONE |line, size| line.cone(size.x, size.y);
    Cuboid BOX |line, size| line.cuboid(size);
    Ellipsoid ELLIPSOID |line, size| line.ellipsoid(size);
}

/// The half spaces behind its faces.
struct Hull;

impl Kind for Hull {
    const KIND: usize = kind::HULL;
    #[inline(always)]
    fn span<M: Machine>(k: &M, t: &Tables, row: M::I, line: &Line<M::R>) -> Span<M::R> {
        t.surfaces.within_hull(k, line, surface(k, t, row))
    }
}
