//! What a kernel sees of a shape.

use numbers::{Machine, Mat3, Pose, Real, Vec3};

/// Kinds of shapes. In a pair the shape of the lower kind is A. What a size has beyond what its kind
/// says counts only for how large the shape is thought to be.
pub mod kind {
    /// The half space below y = 0. Size: unused.
    pub const PLANE: usize = 0;
    /// Size: radius.
    pub const SPHERE: usize = 1;
    /// A cylinder with round caps along y. Size: radius, half of the whole height, caps included.
    pub const CAPSULE: usize = 2;
    /// Along y. Size: radius, half height.
    pub const CYLINDER: usize = 3;
    /// Along y, base at −half height, apex at +half height. Size: radius of the base, half height.
    pub const CONE: usize = 4;
    /// Size: half extents.
    pub const BOX: usize = 5;
    /// Size: half axes.
    pub const ELLIPSOID: usize = 6;
    /// The convex hull of a range of vertices about a point inside. Size: half extents of its box
    /// about that point.
    pub const HULL: usize = 7;
    /// How many kinds are convex solids.
    pub const CONVEX: usize = 8;
    /// Triangles of a [mesh](crate::mesh) about the middle of its box. Size: half extents of that.
    pub const MESH: usize = CONVEX;
}

/// A shape of a known kind, placed in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed<R> {
    /// Half sizes [m]; see [`kind`].
    pub size: Vec3<R>,
    /// Where its centre is [m].
    pub position: Vec3<R>,
    /// Its axes in the world, as columns.
    pub axes: Mat3<R>,
}

impl<R: Real> Placed<R> {
    /// From half sizes [m] and pose.
    #[inline(always)]
    pub fn new(size: Vec3<R>, pose: Pose<R>) -> Self {
        Self {
            size,
            position: pose.p,
            axes: pose.q.to_mat3(),
        }
    }
    /// A point of its frame, in the world.
    #[inline(always)]
    pub fn point(&self, x: Vec3<R>) -> Vec3<R> {
        self.axes * x + self.position
    }
    /// A point of the world, in its frame.
    #[inline(always)]
    pub fn local_point(&self, x: Vec3<R>) -> Vec3<R> {
        self.local_direction(x - self.position)
    }
    /// A direction of its frame, in the world.
    #[inline(always)]
    pub fn direction(&self, d: Vec3<R>) -> Vec3<R> {
        self.axes * d
    }
    /// A direction of the world, in its frame.
    #[inline(always)]
    pub fn local_direction(&self, d: Vec3<R>) -> Vec3<R> {
        self.axes.transpose_mul(d)
    }
    /// Half the length of a capsule's axis [m].
    #[inline(always)]
    pub fn half_segment(&self) -> R {
        (self.size.y - self.size.x).max(R::zero())
    }
}

/// A shape whose kind is read from a table.
#[derive(Debug)]
pub struct Solid<M: Machine> {
    /// One of [`kind`].
    pub kind: M::I,
    /// Sizes and place.
    pub placed: Placed<M::R>,
    /// Its rows in the [`Tables`](crate::Tables): the first, and the one after the last. Of a mesh: the
    /// range of its groups.
    pub rows: [M::I; 2],
}

impl<M: Machine> Clone for Solid<M> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<M: Machine> Copy for Solid<M> {}

/// 1 or −1, with the sign of `x`; 1 for zero.
#[inline(always)]
pub(crate) fn sign<R: Real>(x: R) -> R {
    R::select(x.lt(R::zero()), -R::one(), R::one())
}

/// Number of a corner of a box, from its side (±1) along each axis.
#[inline(always)]
pub(crate) fn corner_number<R: Real>(side: Vec3<R>) -> R {
    // (s + 1)/2 is the binary digit.
    let sum = side.dot(Vec3::new(R::one(), R::lit(2.0), R::lit(4.0)));
    (sum + R::lit(7.0)) * R::lit(0.5)
}
