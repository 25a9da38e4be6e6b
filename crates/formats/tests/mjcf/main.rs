//! What MJCF files become beyond the numbers that MuJoCo agrees on: warnings, leniency, includes,
//! loops, couplings, fused bodies, colours and meshes.

mod actuators;
mod attributes;
mod bodies;
mod common;
mod contacts;
mod equality;
mod fitted;
mod includes;
mod joints;
mod scenery;
#[path = "../common/sizes.rs"]
mod sizes;
mod warnings;
mod written_meshes;
