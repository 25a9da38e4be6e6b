//! How far solids are apart, and when one that moves meets another, in double precision: what queries ask.
//!
//! These are no kernels: a query meets one shape of one world at a time, and branches. Where one of the two
//! is a plane or a sphere, the answer is a closed form; of other pairs it is that of the kernels'
//! search for the largest gap, run in one lane.

mod advancement;
mod point;
mod triangle;

pub use advancement::first_touch;
pub use point::outside;
pub use triangle::nearest_on_triangle;

use crate::convex::{Way, nearest_or_deepest};
use crate::gjk::Cores;
use crate::support::{radius, support};
use crate::{Form, Placed, Solid, Tables, kind};
use glam::DVec3;
use model::{Geometry, Hull, Pose};
use numbers::dispatch::{Isa, Job, run_single};
use numbers::{Cpu, Known, Lanes, Machine, Quat, Shared, Vec3};

/// A convex solid, the half space below a plane, or a triangle, in its place.
#[derive(Clone, Copy, Debug)]
pub struct Convex<'a> {
    kind: usize,
    placed: Placed<f64>,
    corners: Corners<'a>,
}

/// Of what has corners: those of a hull, or of a triangle from its middle [m].
#[derive(Clone, Copy, Debug)]
enum Corners<'a> {
    None,
    Hull(&'a Hull),
    Triangle([DVec3; 3]),
}

/// The way from A to B.
#[derive(Clone, Copy, Debug)]
pub struct Separation {
    /// The gap between the surfaces [m]; negative where they overlap: then what A must be moved by, against
    /// the normal, to be free.
    pub distance: f64,
    /// Unit vector from A to B.
    pub normal: DVec3,
    /// The point of B nearest to A, or deepest in it [m].
    pub on_b: DVec3,
}

impl Separation {
    /// The same, seen with A and B exchanged.
    fn swapped(self) -> Self {
        Self {
            distance: self.distance,
            normal: -self.normal,
            on_b: self.on_b - self.distance * self.normal,
        }
    }
}

/// What is outside of a solid's surface.
#[derive(Clone, Copy, Debug)]
pub struct Outside {
    /// From the surface [m]; negative inside.
    pub distance: f64,
    /// Unit vector out of the surface at its nearest point.
    pub normal: DVec3,
}

impl<'a> Convex<'a> {
    /// A geometry in its place. `None` for meshes, which are not convex.
    pub fn new(geometry: &'a Geometry, pose: Pose) -> Option<Self> {
        let form = Form::of(geometry).filter(|form| form.kind < kind::CONVEX)?;
        let corners = match geometry {
            Geometry::Hull(hull) => Corners::Hull(hull),
            _ => Corners::None,
        };
        Some(Self {
            kind: form.kind,
            placed: placed(form.size, pose * form.pose),
            corners,
        })
    }

    /// A triangle, of which both sides are outside.
    pub fn triangle(corners: [DVec3; 3]) -> Self {
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let arms = corners.map(|corner| corner - middle);
        let size = arms
            .map(DVec3::abs)
            .into_iter()
            .fold(DVec3::ZERO, DVec3::max);
        Self {
            kind: kind::HULL,
            placed: placed(size, Pose::at(middle)),
            corners: Corners::Triangle(arms),
        }
    }

    /// A point.
    fn point(at: DVec3) -> Self {
        Self {
            kind: kind::SPHERE,
            placed: placed(DVec3::ZERO, Pose::at(at)),
            corners: Corners::None,
        }
    }

    /// The same, elsewhere by so much [m].
    #[must_use]
    pub fn moved(mut self, by: DVec3) -> Self {
        self.placed.position = to_kernels(self.center() + by);
        self
    }

    /// Its centre [m]; of a plane a point of it.
    fn center(&self) -> DVec3 {
        from_kernels(self.placed.position)
    }

    /// A length [m] by which it is large; 0 for a plane.
    fn size(&self) -> f64 {
        self.placed.size.length()
    }

    /// Its corners from its centre, in its own frame, three numbers each.
    fn arms(&self) -> Vec<f64> {
        match self.corners {
            Corners::None => Vec::new(),
            Corners::Hull(hull) => hull.arms().flat_map(|arm| arm.to_array()).collect(),
            Corners::Triangle(arms) => arms.iter().flat_map(|arm| arm.to_array()).collect(),
        }
    }
}

/// How far A and B are apart. `None` for two planes.
///
/// Distances are never too large by more than 1e-10 of them, and, of 1e-6 sizes and less, too small by up to 1e-8 sizes.
/// Normals of round solids are known to 1e-5.
///
/// Where they overlap by more than a tenth of the smaller one, the way out is not the shortest in up to one
/// of a hundred poses; see [the crate](crate#limits).
pub fn separation(isa: Isa, a: &Convex<'_>, b: &Convex<'_>) -> Option<Separation> {
    Some(match (a.kind, b.kind) {
        (kind::PLANE, kind::PLANE) => return None,
        (kind::PLANE, _) => above(isa, a, b),
        (_, kind::PLANE) => above(isa, b, a).swapped(),
        (kind::SPHERE, _) => beside(isa, a, b),
        (_, kind::SPHERE) => beside(isa, b, a).swapped(),
        _ => between(isa, a, b),
    })
}

/// The lowest point of a solid above a plane.
fn above(isa: Isa, plane: &Convex<'_>, solid: &Convex<'_>) -> Separation {
    let normal = from_kernels(plane.placed.axes.y);
    let lowest = run_single(isa, Farthest(solid, -normal));
    Separation {
        distance: normal.dot(lowest - plane.center()),
        normal,
        on_b: lowest,
    }
}

/// A sphere and a solid of any kind.
fn beside(isa: Isa, sphere: &Convex<'_>, solid: &Convex<'_>) -> Separation {
    let center = sphere.center();
    let Outside { distance, normal } = outside(isa, solid, center);
    Separation {
        distance: distance - sphere.placed.size.x,
        normal: -normal,
        on_b: center - distance * normal,
    }
}

/// Any other two.
fn between(isa: Isa, a: &Convex<'_>, b: &Convex<'_>) -> Separation {
    let [normal, on_core, measures] = run_single(isa, Search([a, b]));
    let [gap, radius_a, radius_b] = measures.to_array();
    Separation {
        distance: gap - radius_a - radius_b,
        normal,
        on_b: a.center() + on_core - radius_b * normal,
    }
}

/// The point of a solid that lies farthest in a direction [m].
struct Farthest<'a>(&'a Convex<'a>, DVec3);

impl Job for Farthest<'_> {
    type Scalar = f64;
    type Output = DVec3;
    const WIDEST: bool = false;
    #[inline(always)]
    fn run<R: Lanes<Scalar = f64>>(self) -> DVec3 {
        let arms = self.0.arms();
        let k = machine::<R>(&arms);
        let (solid, tables) = (solid(&k, self.0, 0), tables(arms.len() / 3));
        let d = vector::<R>(self.1);
        let core = support(&k, tables, &solid, d);
        first(d.fma(radius(&k, &solid), core) + solid.placed.position)
    }
}

/// The direction of the largest gap from A's core to B's, the point of B's core that is nearest to A's, from A's
/// centre, and the gap, with what surrounds the cores of A and B [m].
struct Search<'a>([&'a Convex<'a>; 2]);

impl Job for Search<'_> {
    type Scalar = f64;
    type Output = [DVec3; 3];
    const WIDEST: bool = false;
    #[inline(always)]
    fn run<R: Lanes<Scalar = f64>>(self) -> [DVec3; 3] {
        let mut arms = self.0[0].arms();
        let rows = arms.len() / 3;
        arms.extend(self.0[1].arms());
        let k = machine::<R>(&arms);
        let [a, b] = [solid(&k, self.0[0], 0), solid(&k, self.0[1], rows)];
        let cores = Cores {
            tables: tables(arms.len() / 3),
            a: &a,
            b: &b,
            offset: b.placed.position - a.placed.position,
        };
        let Way { n, gap, on_b } = nearest_or_deepest(&k, &cores);
        let measures = Vec3::new(gap, radius(&k, &a), radius(&k, &b));
        [first(n), first(on_b), first(measures)]
    }
}

/// A machine with corners for its parameters.
#[inline(always)]
fn machine<R: Lanes<Scalar = f64>>(corners: &[f64]) -> Cpu<'_, R, Shared<'_, R>> {
    Cpu {
        state: &mut [],
        input: &[],
        output: &mut [],
        scratch: &mut [],
        parameters: Shared(corners),
        links: &[],
    }
}

#[inline(always)]
fn tables(corners: usize) -> Tables {
    Tables::place(&mut 0, corners, &mut 0)
}

/// A solid as kernels read it, with its corners from a row on.
#[inline(always)]
fn solid<M: Machine<R: Lanes<Scalar = f64>>>(k: &M, convex: &Convex<'_>, row: usize) -> Solid<M> {
    let corners = match convex.corners {
        Corners::None => 0,
        Corners::Hull(hull) => hull.vertices().len(),
        Corners::Triangle(_) => 3,
    };
    let Placed {
        size,
        position,
        axes,
    } = convex.placed;
    let splat = |v: Vec3<f64>| vector(from_kernels(v));
    Solid {
        kind: k.index(convex.kind),
        placed: Placed {
            size: splat(size),
            position: splat(position),
            axes: numbers::Mat3::from_columns(splat(axes.x), splat(axes.y), splat(axes.z)),
        },
        rows: [k.index(row), k.index(row + corners)],
    }
}

#[inline(always)]
fn vector<R: Lanes<Scalar = f64>>(v: DVec3) -> Vec3<R> {
    Vec3::new(R::splat(v.x), R::splat(v.y), R::splat(v.z))
}

#[inline(always)]
fn first<R: Known<Scalar = f64>>(v: Vec3<R>) -> DVec3 {
    DVec3::new(v.x.first(), v.y.first(), v.z.first())
}

fn placed(size: DVec3, pose: Pose) -> Placed<f64> {
    let [x, y, z, w] = pose.orientation.to_array();
    let pose = numbers::Pose::new(to_kernels(pose.position), Quat::new(x, y, z, w));
    Placed::new(to_kernels(size), pose)
}

fn to_kernels(v: DVec3) -> Vec3<f64> {
    Vec3::new(v.x, v.y, v.z)
}

fn from_kernels(v: Vec3<f64>) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}
