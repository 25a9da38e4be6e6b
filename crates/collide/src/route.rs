//! Which kernel answers for which pair of kinds.

use crate::solid::kind::{BOX, CAPSULE, CONE, CYLINDER, ELLIPSOID, HULL, PLANE, SPHERE};
use crate::{Manifold, Solid, Tables, box_box, convex_convex, pair};
use numbers::Machine;

/// A kernel for pairs of kinds. A solver keeps one list of pairs for each, and loops over it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs)]
pub enum Route {
    PlaneSphere,
    PlaneCapsule,
    PlaneCylinder,
    PlaneCone,
    PlaneBox,
    PlaneEllipsoid,
    PlaneHull,
    SphereSphere,
    SphereCapsule,
    SphereCylinder,
    SphereCone,
    SphereBox,
    CapsuleCapsule,
    BoxBox,
    /// Any other two convex solids.
    Convex,
}

impl Route {
    /// All of them.
    pub const ALL: [Self; 15] = [
        Self::PlaneSphere,
        Self::PlaneCapsule,
        Self::PlaneCylinder,
        Self::PlaneCone,
        Self::PlaneBox,
        Self::PlaneEllipsoid,
        Self::PlaneHull,
        Self::SphereSphere,
        Self::SphereCapsule,
        Self::SphereCylinder,
        Self::SphereCone,
        Self::SphereBox,
        Self::CapsuleCapsule,
        Self::BoxBox,
        Self::Convex,
    ];

    /// The kernel for two [`kind`](crate::kind)s in any order; the shape of the lower kind is A.
    ///
    /// `None` for two planes, which never meet in a way that a body could resolve.
    pub fn of(first: usize, second: usize) -> Option<Self> {
        Some(match (first.min(second), first.max(second)) {
            (PLANE, SPHERE) => Self::PlaneSphere,
            (PLANE, CAPSULE) => Self::PlaneCapsule,
            (PLANE, CYLINDER) => Self::PlaneCylinder,
            (PLANE, CONE) => Self::PlaneCone,
            (PLANE, BOX) => Self::PlaneBox,
            (PLANE, ELLIPSOID) => Self::PlaneEllipsoid,
            (PLANE, HULL) => Self::PlaneHull,
            (SPHERE, SPHERE) => Self::SphereSphere,
            (SPHERE, CAPSULE) => Self::SphereCapsule,
            (SPHERE, CYLINDER) => Self::SphereCylinder,
            (SPHERE, CONE) => Self::SphereCone,
            (SPHERE, BOX) => Self::SphereBox,
            (CAPSULE, CAPSULE) => Self::CapsuleCapsule,
            (BOX, BOX) => Self::BoxBox,
            (SPHERE.., SPHERE..) => Self::Convex,
            _ => return None,
        })
    }

    /// How many points its manifolds have at most.
    pub fn points(self) -> usize {
        match self {
            Self::PlaneCapsule | Self::CapsuleCapsule => 2,
            Self::PlaneCylinder | Self::PlaneCone | Self::PlaneBox | Self::PlaneHull => 4,
            Self::BoxBox | Self::Convex => 4,
            _ => 1,
        }
    }

    /// Contact of A and B, whose kinds are those of the route, the lower one first.
    #[inline(always)]
    pub fn manifold<M: Machine>(
        self,
        k: &mut M,
        tables: Tables,
        a: &Solid<M>,
        b: &Solid<M>,
    ) -> Manifold<M::R> {
        let solids = (a, b);
        let (a, b) = (&a.placed, &b.placed);
        match self {
            Self::PlaneSphere => pair::plane_sphere(a, b),
            Self::PlaneCapsule => pair::plane_capsule(a, b),
            Self::PlaneCylinder => pair::plane_cylinder(a, b),
            Self::PlaneCone => pair::plane_cone(a, b),
            Self::PlaneBox => pair::plane_box(a, b),
            Self::PlaneEllipsoid => pair::plane_ellipsoid(a, b),
            Self::PlaneHull => pair::plane_hull(k, tables, a, solids.1),
            Self::SphereSphere => pair::sphere_sphere(a, b),
            Self::SphereCapsule => pair::sphere_capsule(a, b),
            Self::SphereCylinder => pair::sphere_cylinder(a, b),
            Self::SphereCone => pair::sphere_cone(a, b),
            Self::SphereBox => pair::sphere_box(a, b),
            Self::CapsuleCapsule => pair::capsule_capsule(a, b),
            Self::BoxBox => box_box(k, tables, solids.0, solids.1),
            Self::Convex => convex_convex(k, tables, solids.0, solids.1),
        }
    }
}
