//! Pairs with a closed form. Each takes A and B in the order of their [kinds](crate::kind).

mod capsule;
pub(crate) mod nearest;
mod plane;
mod sphere;

pub use capsule::capsule_capsule;
pub use plane::{
    plane_box, plane_capsule, plane_cone, plane_cylinder, plane_ellipsoid, plane_hull, plane_sphere,
};
pub use sphere::{sphere_box, sphere_capsule, sphere_cone, sphere_cylinder, sphere_sphere};
