//! Bodies about the centres of mass of their trees, in lanes.
//!
//! A body of mass m stands at x, turned by R, with its centre at c = x + R c₀. Its tree has its centre at
//! C = Σ m c / Σ m, and the arm between is d = c − C. About C and along the world's axes the body has (Featherstone,
//! *Rigid Body Dynamics Algorithms*, 2008, chapter 2)
//!
//! ```text
//! inertia   R I₀ Rᵀ + m (d·d 1 − d dᵀ),  m d,  m
//! velocity  ω,  v + ω × (C − x)
//! ```

use crate::Simulation;
use crate::jobs::Lane;
use model::{Body, BodyId, BodyKind, Model};
use numbers::dispatch::Job;
use numbers::machine::space::Output;
use numbers::spatial::Inertia;
use numbers::{Float, Lanes, Memory, Quat, Real, SymMat3, Table, Vec3};
use rigid::body;

/// What is worked out of each tree or body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Spatial {
    /// C of the tree.
    Center,
    /// Inertia about C.
    Inertia,
    /// Velocity at C.
    Velocity,
}

impl Spatial {
    /// Numbers in a row.
    pub fn width(self) -> usize {
        match self {
            Self::Center => 3,
            Self::Inertia => 10,
            Self::Velocity => 6,
        }
    }
}

/// Which bodies have one centre of mass.
pub(crate) struct Trees {
    /// Row of the first body of each body's tree.
    root: Vec<usize>,
    /// Of how many bodies there are rows to be worked out.
    rows: usize,
}

impl Trees {
    /// One tree of all bodies, and one row of it, if there are any.
    pub fn one(model: &Model) -> Self {
        Self {
            root: vec![0; model.bodies.len()],
            rows: model.bodies.len().min(1),
        }
    }
    /// The trees that joints make of bodies, and a row for each body.
    pub fn of_each_body(model: &Model) -> Self {
        let mut root: Vec<usize> = (0..model.bodies.len()).collect();
        for id in model.order() {
            let parent = model
                .carrier(*id)
                .and_then(|j| model.joints[j.0].parent)
                .filter(|BodyId(parent)| model.bodies[*parent].kind == BodyKind::Dynamic);
            if let Some(BodyId(parent)) = parent {
                root[id.0] = root[parent];
            }
        }
        let rows = root.len();
        Self { root, rows }
    }
}

/// Fields of a row of masses.
mod mass {
    pub const MASS: usize = 0;
    /// c₀ in the body's frame, 3.
    pub const CENTER: usize = 1;
    /// I₀ about it, along the body's axes, xx, yy, zz, xy, xz, yz.
    pub const INERTIA: usize = 4;
    pub const WIDTH: usize = 10;
}

/// Writes a world's masses into its lane.
fn put_masses<T: Float>(model: &Model, lane: usize, masses: &mut Memory<T>) {
    let dynamic = |(_, body): &(usize, &Body)| body.kind == BodyKind::Dynamic;
    for (row, body) in model.bodies.iter().enumerate().filter(dynamic) {
        let (c, i) = (body.center, body.inertia);
        let numbers = [
            body.mass, c.x, c.y, c.z, i.x_axis.x, i.y_axis.y, i.z_axis.z, i.y_axis.x, i.z_axis.x,
            i.z_axis.y,
        ];
        for (field, x) in numbers.into_iter().enumerate() {
            masses.set(lane, row * mass::WIDTH + field, T::from_f64(x));
        }
    }
}

impl<T: Float> Simulation<T> {
    /// Works something out for each tree or body: `out[world − first][row][number]`, of the worlds from the first
    /// of a block on, of as many as there is room for.
    pub(crate) fn work_out(&self, what: Spatial, trees: &Trees, first: usize, out: &mut [T]) {
        if trees.root.is_empty() {
            // Nothing is nowhere: at the origin, as of what has no mass.
            out.fill(T::zero());
            return;
        }
        let lanes = self.output.width();
        let lane = Lane {
            isa: self.isa,
            single: lanes == 1,
        };
        let (bodies, numbers) = (trees.root.len(), trees.rows * what.width());
        let one_block = |length| Memory::<T>::new(lanes, length, lanes);
        let mut masses = one_block(bodies * mass::WIDTH);
        let mut centers = one_block(bodies * CENTER_WIDTH);
        let mut rows = one_block(numbers);
        for (i, out) in out.chunks_mut(lanes * numbers).enumerate() {
            let start = first + i * lanes;
            // The spare lanes of the last block repeat its last world.
            let worlds = (start..start + lanes).map(|w| w.min(self.worlds() - 1));
            if i == 0 || self.has_own_models() {
                for (lane, world) in worlds.enumerate() {
                    put_masses(self.world_model(world), lane, &mut masses);
                }
            }
            lane.run(Work {
                what,
                root: &trees.root,
                table: self.output_tables.body,
                output: self.output.block(start / lanes),
                masses: masses.scalars(),
                centers: centers.scalars_mut(),
                rows: rows.scalars_mut(),
            });
            for (lane, world) in out.chunks_exact_mut(numbers).enumerate() {
                for (x, row) in world.iter_mut().zip(rows.scalars().chunks_exact(lanes)) {
                    *x = row[lane];
                }
            }
        }
    }
}

/// Numbers of a tree: Σ m c, then C; and Σ m.
const CENTER_WIDTH: usize = 4;

/// A block of worlds.
struct Work<'a, T> {
    what: Spatial,
    root: &'a [usize],
    table: Table<Output, { body::WIDTH }>,
    output: &'a [T],
    /// `[body][number][lane]`, see [`mass`].
    masses: &'a [T],
    /// `[body][number][lane]`; those of a tree are its first body's.
    centers: &'a mut [T],
    /// `[row][number][lane]`, what is worked out.
    rows: &'a mut [T],
}

impl<T: Float> Job for Work<'_, T> {
    type Scalar = T;
    type Output = ();
    const WIDEST: bool = false;
    #[inline(always)]
    fn run<R: Lanes<Scalar = T>>(self) {
        let placed = Placed::<R> {
            table: self.table,
            output: bytemuck::cast_slice(self.output),
            masses: bytemuck::cast_slice(self.masses),
        };
        let centers: &mut [R] = bytemuck::cast_slice_mut(self.centers);
        find_centers(&placed, self.root, centers);
        let rows: &mut [R] = bytemuck::cast_slice_mut(self.rows);
        let rows = rows.chunks_exact_mut(self.what.width()).enumerate();
        for (b, row) in rows {
            let center = vector(centers, self.root[b] * CENTER_WIDTH);
            match self.what {
                Spatial::Center => put(row, center.to_array()),
                Spatial::Inertia => put(row, placed.inertia(b, center)),
                Spatial::Velocity => put(row, placed.velocity(b, center)),
            }
        }
    }
}

/// Writes the first numbers of a row. A loop, for what copies slices is a function that is not inlined.
#[inline(always)]
fn put<R: Copy, const N: usize>(row: &mut [R], numbers: [R; N]) {
    for (to, x) in row[..N].iter_mut().zip(numbers) {
        *to = x;
    }
}

#[inline(always)]
fn vector<R: Real>(numbers: &[R], at: usize) -> Vec3<R> {
    Vec3::new(numbers[at], numbers[at + 1], numbers[at + 2])
}

/// C of every tree; the origin where nothing of it has mass.
#[inline(always)]
fn find_centers<R: Real>(placed: &Placed<'_, R>, root: &[usize], centers: &mut [R]) {
    for number in centers.iter_mut() {
        *number = R::zero();
    }
    for (b, root) in root.iter().enumerate() {
        let sum = &mut centers[root * CENTER_WIDTH..][..CENTER_WIDTH];
        let m = placed.mass(b);
        let c = placed.center(b).fma(m, vector(sum, 0));
        put(sum, [c.x, c.y, c.z, sum[3] + m]);
    }
    for sum in centers.chunks_exact_mut(CENTER_WIDTH) {
        let m = sum[3];
        let share = R::select(m.gt(R::zero()), m.recip(), R::zero());
        let c = vector(sum, 0) * share;
        put(sum, c.to_array());
    }
}

/// Where bodies are, how they move, and their masses.
struct Placed<'a, R> {
    table: Table<Output, { body::WIDTH }>,
    output: &'a [R],
    masses: &'a [R],
}

impl<R: Real> Placed<'_, R> {
    #[inline(always)]
    fn vector(&self, b: usize, field: usize) -> Vec3<R> {
        vector(self.output, self.table.at(b, field))
    }
    #[inline(always)]
    fn orientation(&self, b: usize) -> Quat<R> {
        let q = &self.output[self.table.at(b, body::ORIENTATION)..][..4];
        Quat::new(q[0], q[1], q[2], q[3])
    }
    #[inline(always)]
    fn mass(&self, b: usize) -> R {
        self.masses[b * mass::WIDTH + mass::MASS]
    }
    /// c.
    #[inline(always)]
    fn center(&self, b: usize) -> Vec3<R> {
        let arm = vector(self.masses, b * mass::WIDTH + mass::CENTER);
        self.vector(b, body::POSITION) + self.orientation(b).rotate(arm)
    }
    #[inline(always)]
    fn inertia(&self, b: usize, center: Vec3<R>) -> [R; 10] {
        let own = &self.masses[b * mass::WIDTH + mass::INERTIA..][..6];
        let own = SymMat3::from_array([own[0], own[1], own[2], own[3], own[4], own[5]]);
        let own = own.rotated(self.orientation(b).to_mat3());
        let (m, d) = (self.mass(b), self.center(b) - center);
        let [xx, yy, zz, xy, xz, yz] = Inertia::rigid(m, d, own).i.to_array();
        let md = d * m;
        [xx, yy, zz, xy, xz, yz, md.x, md.y, md.z, m]
    }
    #[inline(always)]
    fn velocity(&self, b: usize, center: Vec3<R>) -> [R; 6] {
        let angular = self.vector(b, body::ANGULAR_VELOCITY);
        let arm = center - self.vector(b, body::POSITION);
        let v = angular.cross_plus(arm, self.vector(b, body::VELOCITY));
        [angular.x, angular.y, angular.z, v.x, v.y, v.z]
    }
}
