//! Where things are: overlaps, casts and neighbours among boxes along the axes.
//!
//! A [`Space`] holds one [`Aabb`] per object and a [`Structure`] that finds
//! candidates among them. All structures answer alike, to the last bit; they
//! differ in speed, as BENCHMARKS.md shows.
//!
//! | structure | for |
//! |---|---|
//! | [`Auto`] | whichever of the next three suits the motion |
//! | [`Bvh`] | nearly everything: objects of any size, moving or not, every query |
//! | [`SweepAndPrune`] | pairs among up to a thousand objects that jump |
//! | [`Grid`] | pairs among many objects of like size that jump |
//! | [`Octree`] | objects that come and go: the cheapest build and update, slow queries |
//! | [`KdTree`], [`Bsp`] | objects of like size that rest, in little memory |
//!
//! [`Worlds`] holds many worlds of the same objects, side by side in lanes. A [`PairCache`] keeps the
//! pairs of objects that move little from one call to the next.
//!
//! Queries are exact for boxes. For the shapes inside, a [`CastTest`] or a
//! [`ClosestTest`] decides: a closure, as in the last line here.
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
//!
//! let only_even = |i: u32, cast: &Cast, limit: f32| {
//!     let aabb = space.boxes().get(i);
//!     if i % 2 == 0 { cast.against(aabb, limit) } else { None }
//! };
//! assert_eq!(space.cast_all(&ray, &only_even).len(), 2);
//! # Ok::<(), kinetarium_space::SpaceError>(())
//! ```

#![forbid(unsafe_code)]

mod aabb;
pub mod auto;
mod boxes;
pub mod bsp;
pub mod bvh;
mod cast;
mod error;
pub mod grid;
pub mod halves;
pub mod kd_tree;
pub mod octree;
mod pair_cache;
mod pairs;
mod query;
mod space;
mod stack;
mod structure;
pub mod sweep_and_prune;
pub mod worlds;

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
pub use pair_cache::PairCache;
pub use pairs::Pair;
pub use query::{CastTest, ClosestTest, Hit, Neighbor};
pub use space::Space;
pub use structure::Structure;
pub use sweep_and_prune::SweepAndPrune;
pub use worlds::{LaneBox, LaneRay, Near, ScenePair, WorldHits, WorldRays, Worlds};
