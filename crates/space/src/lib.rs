//! Where things are: overlaps, casts and neighbours among boxes along the axes.
//!
//! A [`Space`] holds one [`Aabb`] per object and a [`Structure`] that finds
//! candidates among them. All structures answer alike, to the last bit; they
//! differ in speed.
//!
//! ```
//! use glam::Vec3;
//! use kinetarium_space::{Aabb, Bvh, Cast, Space};
//!
//! let at = |x: f32| Aabb::around(Vec3::new(x, 0.0, 0.0), Vec3::splat(0.5));
//! let space = Space::<Bvh>::new(&[at(0.0), at(0.9), at(5.0)])?;
//! assert_eq!(space.pairs().len(), 1);
//!
//! let ray = Cast::ray(Vec3::new(9.0, 0.0, 0.0), Vec3::NEG_X)?;
//! let hit = space.cast(&ray, space.boxes()).unwrap();
//! assert_eq!((hit.object, hit.time), (2, 3.5));
//! # Ok::<(), kinetarium_space::SpaceError>(())
//! ```

#![forbid(unsafe_code)]

mod aabb;
mod auto;
mod boxes;
mod bsp;
mod bvh;
mod cast;
mod error;
mod grid;
mod halves;
mod kd_tree;
mod octree;
mod pairs;
mod query;
mod space;
mod stack;
mod structure;
mod sweep_and_prune;
mod worlds;

pub use aabb::Aabb;
pub use auto::Auto;
pub use boxes::Boxes;
pub use bsp::Bsp;
pub use bvh::Bvh;
pub use cast::Cast;
pub use error::SpaceError;
pub use grid::Grid;
pub use kd_tree::KdTree;
pub use octree::Octree;
pub use pairs::Pair;
pub use query::{CastTest, ClosestTest, Hit, Neighbor};
pub use space::Space;
pub use structure::Structure;
pub use sweep_and_prune::SweepAndPrune;
pub use worlds::{LaneBox, LaneRay, Near, ScenePair, WorldHits, WorldRays, Worlds};
