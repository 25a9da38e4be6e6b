//! Which kernel answers for which pair of kinds.

use crate::mesh::SLOTS;
use crate::solid::kind::{BOX, CAPSULE, CONE, CYLINDER, ELLIPSOID, HULL, MESH, PLANE, SPHERE};
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
    /// A convex solid and a mesh; see [`mesh_convex`](crate::mesh::mesh_convex).
    Mesh,
    /// Two meshes; see [`mesh_mesh`](crate::mesh::mesh_mesh).
    Meshes,
}

impl Route {
    /// All of them.
    pub const ALL: [Self; 18] = [
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
        Self::Mesh,
        Self::Meshes,
    ];

    /// The kernel for two [`kind`](crate::kind)s in any order; the shape of the lower kind is A.
    ///
    /// A plane sees of a mesh what is lowest, which is the same of its convex hull: that takes the
    /// mesh's place, with its vertices. `None` for two planes, which never meet in a way that a body
    /// could resolve, and for numbers that are no kind.
    pub fn of(first: usize, second: usize) -> Option<Self> {
        Some(match (first.min(second), first.max(second)) {
            (PLANE, SPHERE) => Self::PlaneSphere,
            (PLANE, CAPSULE) => Self::PlaneCapsule,
            (PLANE, CYLINDER) => Self::PlaneCylinder,
            (PLANE, CONE) => Self::PlaneCone,
            (PLANE, BOX) => Self::PlaneBox,
            (PLANE, ELLIPSOID) => Self::PlaneEllipsoid,
            (PLANE, HULL | MESH) => Self::PlaneHull,
            (SPHERE, SPHERE) => Self::SphereSphere,
            (SPHERE, CAPSULE) => Self::SphereCapsule,
            (SPHERE, CYLINDER) => Self::SphereCylinder,
            (SPHERE, CONE) => Self::SphereCone,
            (SPHERE, BOX) => Self::SphereBox,
            (CAPSULE, CAPSULE) => Self::CapsuleCapsule,
            (BOX, BOX) => Self::BoxBox,
            (SPHERE, CAPSULE..=HULL) => Self::SphereConvex,
            (CAPSULE..=HULL, CAPSULE..=HULL) => Self::Convex,
            (SPHERE..=HULL, MESH) => Self::Mesh,
            (MESH, MESH) => Self::Meshes,
            _ => return None,
        })
    }

    /// How many points its contacts have at most.
    pub fn points(self) -> usize {
        match self {
            Self::PlaneCapsule | Self::CapsuleCapsule => 2,
            Self::PlaneCylinder | Self::PlaneCone | Self::PlaneBox | Self::PlaneHull => 4,
            Self::BoxBox | Self::Convex => 4,
            Self::Mesh | Self::Meshes => SLOTS,
            _ => 1,
        }
    }
}

/// A [`Route`] of two convex solids as a type: who names it compiles that one kernel.
pub trait Kernel {
    /// The same as a value.
    const ROUTE: Route;
    /// Contact of A and B, whose kinds are those of the route, the lower one first.
    fn manifold<M: Machine>(
        k: &mut M,
        tables: Tables,
        a: &Solid<M>,
        b: &Solid<M>,
    ) -> Manifold<M::R>;
}

macro_rules! kernels {
    ($k:ident, $tables:ident, $a:ident, $b:ident: $($name:ident = $manifold:expr;)+) => {
        /// The kernels for pairs, each as a type.
        pub mod kernel {
            use super::*;
            $(
                #[doc = concat!("See [`Route::", stringify!($name), "`].")]
                #[derive(Clone, Copy, Debug)]
                pub struct $name;

                impl Kernel for $name {
                    const ROUTE: Route = Route::$name;
                    #[inline(always)]
                    fn manifold<M: Machine>(
                        $k: &mut M,
                        $tables: Tables,
                        $a: &Solid<M>,
                        $b: &Solid<M>,
                    ) -> Manifold<M::R> {
                        $manifold
                    }
                }
            )+
        }
    };
}

kernels! {
    _k, _tables, a, b:
    PlaneSphere = pair::plane_sphere(&a.placed, &b.placed);
    PlaneCapsule = pair::plane_capsule(&a.placed, &b.placed);
    PlaneCylinder = pair::plane_cylinder(&a.placed, &b.placed);
    PlaneCone = pair::plane_cone(&a.placed, &b.placed);
    PlaneBox = pair::plane_box(&a.placed, &b.placed);
    PlaneEllipsoid = pair::plane_ellipsoid(&a.placed, &b.placed);
    PlaneHull = pair::plane_hull(_k, _tables, &a.placed, b);
    SphereSphere = pair::sphere_sphere(&a.placed, &b.placed);
    SphereCapsule = pair::sphere_capsule(&a.placed, &b.placed);
    SphereCylinder = pair::sphere_cylinder(&a.placed, &b.placed);
    SphereCone = pair::sphere_cone(&a.placed, &b.placed);
    SphereBox = pair::sphere_box(&a.placed, &b.placed);
    CapsuleCapsule = pair::capsule_capsule(&a.placed, &b.placed);
    BoxBox = box_box(_k, _tables, a, b);
    SphereConvex = sphere_convex(_k, _tables, a, b);
    Convex = convex_convex(_k, _tables, a, b);
}

/// Calls a macro with every type in [`kernel`], each after a name for a module or a function of its own.
#[macro_export]
macro_rules! with_kernels {
    ($call:ident) => {
        $call! {
            plane_sphere PlaneSphere;
            plane_capsule PlaneCapsule;
            plane_cylinder PlaneCylinder;
            plane_cone PlaneCone;
            plane_box PlaneBox;
            plane_ellipsoid PlaneEllipsoid;
            plane_hull PlaneHull;
            sphere_sphere SphereSphere;
            sphere_capsule SphereCapsule;
            sphere_cylinder SphereCylinder;
            sphere_cone SphereCone;
            sphere_box SphereBox;
            capsule_capsule CapsuleCapsule;
            box_box BoxBox;
            sphere_convex SphereConvex;
            convex Convex;
        }
    };
}
