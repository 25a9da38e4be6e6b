//! Which kernel answers for which pair of kinds.

use crate::solid::kind::{BOX, CAPSULE, CONE, CYLINDER, ELLIPSOID, HULL, PLANE, SPHERE};
use crate::{Manifold, Solid, Tables, box_box, convex_convex, pair, sphere_convex};
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
    /// A sphere and any other convex solid.
    SphereConvex,
    /// Any other two convex solids.
    Convex,
}

impl Route {
    /// All of them.
    pub const ALL: [Self; 16] = [
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
        Self::SphereConvex,
        Self::Convex,
    ];

    /// The kernel for two [`kind`](crate::kind)s in any order; the shape of the lower kind is A.
    ///
    /// `None` for two planes, which never meet in a way that a body could resolve, and for numbers
    /// that are no kind.
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
            (SPHERE, CAPSULE..=HULL) => Self::SphereConvex,
            (CAPSULE..=HULL, CAPSULE..=HULL) => Self::Convex,
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
        let (p, q) = (&a.placed, &b.placed);
        match self {
            Self::PlaneSphere => pair::plane_sphere(p, q),
            Self::PlaneCapsule => pair::plane_capsule(p, q),
            Self::PlaneCylinder => pair::plane_cylinder(p, q),
            Self::PlaneCone => pair::plane_cone(p, q),
            Self::PlaneBox => pair::plane_box(p, q),
            Self::PlaneEllipsoid => pair::plane_ellipsoid(p, q),
            Self::PlaneHull => pair::plane_hull(k, tables, p, b),
            Self::SphereSphere => pair::sphere_sphere(p, q),
            Self::SphereCapsule => pair::sphere_capsule(p, q),
            Self::SphereCylinder => pair::sphere_cylinder(p, q),
            Self::SphereCone => pair::sphere_cone(p, q),
            Self::SphereBox => pair::sphere_box(p, q),
            Self::CapsuleCapsule => pair::capsule_capsule(p, q),
            Self::BoxBox => box_box(k, tables, a, b),
            Self::SphereConvex => sphere_convex(k, tables, a, b),
            Self::Convex => convex_convex(k, tables, a, b),
        }
    }
}
