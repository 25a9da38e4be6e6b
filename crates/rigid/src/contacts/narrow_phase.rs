//! From the placements of the carriers to the points of contact.

use super::kept::{Touch, touches};
use super::tables::{
    ContactTables, found, pair_field, placed_field, shape_field, shape_link, slot, slot_link,
};
use collide::mesh::{Surface, contact, mesh_convex, mesh_mesh};
use collide::{FAR, Kernel, Placed, Route, Solid, kernel};
use numbers::machine::space::Writable;
use numbers::machine::{Held, Hold, Index};
use numbers::spatial::Spatial;
use numbers::{Cell, Machine, Pose, Real, Table, Vec3};

/// Gap [m] up to which a point is looked at even if nothing moves.
pub const MARGIN: f64 = 1e-3;

/// Where a solver's carriers are, and how they move.
pub(crate) trait Places<M: Machine> {
    /// Placement of a carrier in the frame of its group.
    fn place(&self, k: &M, row: M::I) -> Pose<M::R>;
    /// Velocity of a carrier about the origin of its group's frame.
    fn twist(&self, k: &M, row: M::I) -> Spatial<M::R>;
    /// Origin of a group's frame in the world.
    fn origin(&self, k: &M, group: M::I) -> Vec3<M::R>;
}

/// Fills the slots: the points that two shapes could reach within the step and a safe margin.
///
/// Needs [`place_shapes`].
#[inline(always)]
pub(crate) fn narrow_phase<M: Machine>(k: &mut M, t: &ContactTables) {
    macro_rules! meet {
        ($($_name:ident $kernel:ident;)+) => { $(t.meet::<M, kernel::$kernel>(k);)+ };
    }
    collide::with_kernels!(meet);
    t.meet_mesh(k);
    t.meet_meshes(k);
}

/// As [`narrow_phase`], each kernel as a function that is called.
pub(crate) fn narrow_phase_in_parts<M: Machine>(k: &mut M, t: &ContactTables) {
    #[inline(never)]
    fn part<M: Machine, K: Kernel>(k: &mut M, t: &ContactTables) {
        t.meet::<M, K>(k);
    }
    #[inline(never)]
    fn mesh<M: Machine>(k: &mut M, t: &ContactTables) {
        t.meet_mesh(k);
    }
    #[inline(never)]
    fn meshes<M: Machine>(k: &mut M, t: &ContactTables) {
        t.meet_meshes(k);
    }
    macro_rules! meet {
        ($($_name:ident $kernel:ident;)+) => { $(part::<M, kernel::$kernel>(k, t);)+ };
    }
    collide::with_kernels!(meet);
    mesh(k, t);
    meshes(k, t);
}

impl ContactTables {
    /// The kernels for pairs that the model needs: what [`meet`](Self::meet) is to be called with, or
    /// [`meet_mesh`](Self::meet_mesh), or [`meet_meshes`](Self::meet_meshes).
    pub fn routes(&self) -> impl Iterator<Item = Route> {
        let needed =
            |route: &Route| self.routes[*route as usize] < self.routes[*route as usize + 1];
        Route::ALL.into_iter().filter(needed)
    }
    /// Fills the slots of the pairs of one kernel.
    #[inline(always)]
    pub fn meet<M: Machine, K: Kernel>(&self, k: &mut M) {
        // A copy on the stack: offsets stay in registers, whatever is written meanwhile.
        let t = *self;
        let route = K::ROUTE as usize;
        let (begin, end) = (k.index(t.routes[route]), k.index(t.routes[route + 1]));
        for pair in k.range(begin, end) {
            meet::<M, K>(k, &t, pair);
        }
    }
    /// Writes into the first slot how far [m] the two convex solids of the first pair are apart at least.
    #[inline(always)]
    pub fn apart<M: Machine>(&self, k: &mut M) {
        let first = k.index(0);
        let [row_a, row_b] = k.link_row(self.pair_links, first);
        let (a, b) = (solid(k, self, row_a), solid(k, self, row_b));
        let gap = collide::apart(k, self.kernels, &a, &b);
        let margin = k.load(self.pair, first, pair_field::MARGIN);
        k.store(self.slot, first, slot::DISTANCE, gap - margin);
    }
    /// What a slot that is listed holds, in the world, with a force [N].
    #[inline(always)]
    pub(crate) fn touch<M: Machine>(
        &self,
        k: &M,
        places: &impl Places<M>,
        s: M::I,
        force: Vec3<M::R>,
    ) -> Touch<M::R> {
        let [x, y, z, l, m, n, distance, feature] = k.read(self.slot, s, 0);
        let origin = places.origin(k, k.link(self.slot_links, s, slot_link::GROUP));
        Touch {
            position: Vec3::new(x, y, z) + origin,
            normal: Vec3::new(l, m, n),
            distance,
            feature,
            force: Vec3::select(touches(distance), force, Vec3::zero()),
        }
    }
    /// True in the lanes where a slot that is listed may come to press.
    #[inline(always)]
    pub(crate) fn near<M: Machine>(&self, k: &M, s: M::I) -> <M::R as Real>::Mask {
        touches(k.load(self.slot, s, slot::DISTANCE))
    }
    /// No slot is listed.
    #[inline(always)]
    pub(crate) fn clear<M: Machine>(&self, k: &mut M) {
        for list in 0..found::LISTS {
            self.found.clear(k, list);
        }
    }
    /// Fills a slot, and lists it where it is near in any lane.
    #[inline(always)]
    fn find<M: Machine>(&self, k: &mut M, list: M::I, s: M::I, numbers: [M::R; slot::WIDTH]) {
        let near = touches(numbers[slot::DISTANCE]);
        if let Some(_branch) = k.if_any(near) {
            k.write(self.slot, s, 0, numbers);
            self.found.append(k, list, s);
        }
    }
    /// Fills the slots of the pairs of a solid and a mesh.
    #[inline(always)]
    pub fn meet_mesh<M: Machine>(&self, k: &mut M) {
        self.meet_with_mesh(k, Route::Mesh);
    }
    /// Fills the slots of the pairs of two meshes.
    #[inline(always)]
    pub fn meet_meshes<M: Machine>(&self, k: &mut M) {
        self.meet_with_mesh(k, Route::Meshes);
    }
    #[inline(always)]
    fn meet_with_mesh<M: Machine>(&self, k: &mut M, route: Route) {
        let (t, first) = (*self, route as usize);
        let (begin, end) = (k.index(t.routes[first]), k.index(t.routes[first + 1]));
        for pair in k.range(begin, end) {
            meet_with_mesh(k, &t, pair, route);
        }
    }
}

/// Shapes in the frames that their pairs are looked at in, and how far they get within `h` [s]; no slot is
/// listed yet.
#[inline(always)]
pub(crate) fn place_shapes<M: Machine>(
    k: &mut M,
    t: &ContactTables,
    places: &impl Places<M>,
    h: M::R,
) {
    t.clear(k);
    for row in k.count(t.shapes) {
        let [seat, own, seen] = k.link_row::<_, { shape_link::KIND }>(t.shape_links, row);
        let pose = places.place(k, seat) * k.pose(t.shape, row, shape_field::POSE);
        let twist = places.twist(k, seat);
        let speed = twist.linear + twist.angular.cross(pose.p);
        let shift = places.origin(k, own) - places.origin(k, seen);
        let rates = [speed.length(), twist.angular.length()];
        let radius = k.load(t.shape, row, shape_field::RADIUS);
        let seen = Pose::new(pose.p + shift, pose.q);
        store_placed(k, t.placed, row, seen, rates, radius, h);
    }
}

/// Where a shape is, and how far [m] it gets within `h` [s], at a speed and a rate of turning; returns
/// that way.
#[inline(always)]
pub(crate) fn store_placed<M: Machine, S: Writable, const W: usize>(
    k: &mut M,
    placed: Table<S, W>,
    row: M::I,
    pose: Pose<M::R>,
    [speed, spin]: [M::R; 2],
    radius: M::R,
    h: M::R,
) -> M::R {
    // What turns gets no farther than its radius lets it, however fast.
    let turn = (spin * h).min(M::R::lit(2.0));
    let way = h.fma(speed, radius * turn);
    k.store_pose(placed, row, placed_field::POSITION, pose);
    k.write(placed, row, placed_field::WAY, [way, radius + way]);
    way
}

/// The slots of one pair.
#[inline(always)]
fn meet<M: Machine, K: Kernel>(k: &mut M, t: &ContactTables, pair: M::I) {
    let [row_a, row_b] = k.link_row(t.pair_links, pair);
    let margin = k.load(t.pair, pair, pair_field::MARGIN);
    let reach = reach(k, t, row_a, row_b, margin);
    let near = near(k, t, K::ROUTE, row_a, row_b, reach);
    if let Some(_branch) = k.if_any(near) {
        let (a, b) = (solid(k, t, row_a), solid(k, t, row_b));
        if K::ROUTE != Route::CapsuleCapsule {
            fill::<M, K>(k, t, pair, margin, [&a, &b]);
        } else if let Some(_branch) = k.if_any(near & side_by_side(&a.placed, &b.placed, reach)) {
            fill::<M, K>(k, t, pair, margin, [&a, &b]);
        }
    }
}

/// Runs the kernel of a pair that is near, and fills its slots.
#[inline(always)]
fn fill<M: Machine, K: Kernel>(
    k: &mut M,
    t: &ContactTables,
    pair: M::I,
    margin: M::R,
    [a, b]: [&Solid<M>; 2],
) {
    let [row_a, row_b, first, flip, list] = k.link_row(t.pair_links, pair);
    let way = way(k, t, row_a, row_b);
    let manifold = K::manifold(k, t.kernels, a, b);
    let mut normal = manifold.normal.hold(k);
    if let Some(_branch) = k.when(k.equals(flip, 1)) {
        normal.set(-manifold.normal);
    }
    for i in 0..K::ROUTE.points() {
        let point = manifold.points[i];
        let row = first.offset(i);
        let distance = point.distance - margin;
        let distance = M::R::select(distance.lt(way), distance, M::R::lit(FAR));
        let [x, y, z] = point.position.to_array();
        let [l, m, n] = normal.get().to_array();
        t.find(k, list, row, [x, y, z, l, m, n, distance, point.feature]);
    }
}

/// Where the ball about either of two capsules overlaps the other capsule: fewer than where the two balls do,
/// whose radii together are `reach`, and found sooner than the nearest points.
#[inline(always)]
fn side_by_side<R: Real>(a: &Placed<R>, b: &Placed<R>, reach: R) -> R::Mask {
    let apart = b.position - a.position;
    beside(a, apart, reach) & beside(b, -apart, reach)
}

/// Where a ball at `way` from the centre of a capsule overlaps it; `reach` is their radii together.
#[inline(always)]
fn beside<R: Real>(capsule: &Placed<R>, way: Vec3<R>, reach: R) -> R::Mask {
    let half = capsule.half_segment();
    let along = capsule.axes.y.dot(way).clamp(-half, half);
    let rest = capsule.axes.y.fma(-along, way);
    rest.length_squared().lt((reach - half).squared())
}

/// The slots of a solid and a mesh, or of two; each point has a normal of its own.
#[inline(always)]
fn meet_with_mesh<M: Machine>(k: &mut M, t: &ContactTables, pair: M::I, route: Route) {
    let [row_a, row_b, first, flip, list] = k.link_row(t.pair_links, pair);
    let margin = k.load(t.pair, pair, pair_field::MARGIN);
    let reach = reach(k, t, row_a, row_b, margin);
    if let Some(_branch) = k.if_any(near(k, t, route, row_a, row_b, reach)) {
        let (a, b) = (solid(k, t, row_a), solid(k, t, row_b));
        let surface = Surface::of(&b);
        let way = way(k, t, row_a, row_b);
        if route == Route::Mesh {
            mesh_convex(k, t.kernels, &t.meshes, &a, &surface, margin + way);
        } else {
            let own = Surface::of(&a);
            mesh_mesh(k, t.kernels, &t.meshes, &own, &surface, margin + way);
        }
        let mut side = k.cell(M::R::one());
        if let Some(_branch) = k.when(k.equals(flip, 1)) {
            side.write(-M::R::one());
        }
        for point in k.count(route.points()) {
            let p: [M::R; contact::FEATURE + 1] = k.read(t.meshes.contacts, point, 0);
            let normal = k.vec3(t.meshes.contacts, point, contact::NORMAL) * side.read();
            let distance = p[contact::DISTANCE] - margin;
            let distance = M::R::select(distance.lt(way), distance, M::R::lit(FAR));
            let [l, m, n] = normal.to_array();
            let numbers = [p[0], p[1], p[2], l, m, n, distance, p[contact::FEATURE]];
            t.find(k, list, first.plus(point), numbers);
        }
    }
}

/// How far two shapes could come towards each other within the step, and a safe margin [m].
#[inline(always)]
fn way<M: Machine>(k: &M, t: &ContactTables, row_a: M::I, row_b: M::I) -> M::R {
    k.load(t.placed, row_a, placed_field::WAY)
        + k.load(t.placed, row_b, placed_field::WAY)
        + M::R::lit(MARGIN)
}

/// How far apart the centres of two shapes may be that come within `margin` of each other [m].
#[inline(always)]
fn reach<M: Machine>(k: &M, t: &ContactTables, row_a: M::I, row_b: M::I, margin: M::R) -> M::R {
    k.load(t.placed, row_a, placed_field::REACH)
        + k.load(t.placed, row_b, placed_field::REACH)
        + (margin + M::R::lit(MARGIN))
}

/// Where the balls about two shapes overlap, whose radii together are `reach`.
#[inline(always)]
fn near<M: Machine>(
    k: &M,
    t: &ContactTables,
    route: Route,
    row_a: M::I,
    row_b: M::I,
    reach: M::R,
) -> <M::R as Real>::Mask {
    let a = k.vec3(t.placed, row_a, placed_field::POSITION);
    let apart = k.vec3(t.placed, row_b, placed_field::POSITION) - a;
    if has_plane(route) {
        let plane = k.quat(t.placed, row_a, placed_field::ORIENTATION);
        plane.to_mat3().y.dot(apart).lt(reach)
    } else {
        apart.length_squared().lt(reach.squared())
    }
}

/// Whether A has no end.
#[inline(always)]
fn has_plane(route: Route) -> bool {
    matches!(
        route,
        Route::PlaneSphere
            | Route::PlaneCapsule
            | Route::PlaneCylinder
            | Route::PlaneCone
            | Route::PlaneBox
            | Route::PlaneEllipsoid
            | Route::PlaneHull
    )
}

#[inline(always)]
fn solid<M: Machine>(k: &M, t: &ContactTables, row: M::I) -> Solid<M> {
    Solid {
        kind: k.link(t.shape_links, row, shape_link::KIND),
        placed: Placed {
            size: k.vec3(t.shape, row, shape_field::SIZE),
            position: k.vec3(t.placed, row, placed_field::POSITION),
            axes: k.quat(t.placed, row, placed_field::ORIENTATION).to_mat3(),
        },
        rows: [
            k.link(t.shape_links, row, shape_link::CORNERS),
            k.link(t.shape_links, row, shape_link::CORNERS + 1),
        ],
    }
}
