//! Which kernel answers for which pair of kinds.

use crate::solid::kind::{BOX, CAPSULE, CONE, CYLINDER, ELLIPSOID, PLANE, SPHERE};
use crate::{Manifold, Solid, Tables, pair};
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
    SphereSphere,
    SphereCapsule,
    SphereCylinder,
    SphereCone,
    SphereBox,
    CapsuleCapsule,
}

impl Route {
    /// All of them.
    pub const ALL: [Self; 12] = [
        Self::PlaneSphere,
        Self::PlaneCapsule,
        Self::PlaneCylinder,
        Self::PlaneCone,
        Self::PlaneBox,
        Self::PlaneEllipsoid,
        Self::SphereSphere,
        Self::SphereCapsule,
        Self::SphereCylinder,
        Self::SphereCone,
        Self::SphereBox,
        Self::CapsuleCapsule,
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
            (SPHERE, SPHERE) => Self::SphereSphere,
            (SPHERE, CAPSULE) => Self::SphereCapsule,
            (SPHERE, CYLINDER) => Self::SphereCylinder,
            (SPHERE, CONE) => Self::SphereCone,
            (SPHERE, BOX) => Self::SphereBox,
            (CAPSULE, CAPSULE) => Self::CapsuleCapsule,
            _ => return None,
        })
    }

    /// How many points its manifolds have at most.
    pub fn points(self) -> usize {
        match self {
            Self::PlaneCapsule | Self::CapsuleCapsule => 2,
            Self::PlaneCylinder | Self::PlaneCone | Self::PlaneBox => 4,
            _ => 1,
        }
    }

    /// Contact of A and B, whose kinds are those of the route, the lower one first.
    #[inline(always)]
    pub fn manifold<M: Machine>(
        self,
        _k: &M,
        _tables: Tables,
        a: &Solid<M>,
        b: &Solid<M>,
    ) -> Manifold<M::R> {
        let (a, b) = (&a.placed, &b.placed);
        match self {
            Self::PlaneSphere => pair::plane_sphere(a, b),
            Self::PlaneCapsule => pair::plane_capsule(a, b),
            Self::PlaneCylinder => pair::plane_cylinder(a, b),
            Self::PlaneCone => pair::plane_cone(a, b),
            Self::PlaneBox => pair::plane_box(a, b),
            Self::PlaneEllipsoid => pair::plane_ellipsoid(a, b),
            Self::SphereSphere => pair::sphere_sphere(a, b),
            Self::SphereCapsule => pair::sphere_capsule(a, b),
            Self::SphereCylinder => pair::sphere_cylinder(a, b),
            Self::SphereCone => pair::sphere_cone(a, b),
            Self::SphereBox => pair::sphere_box(a, b),
            Self::CapsuleCapsule => pair::capsule_capsule(a, b),
        }
    }
}
