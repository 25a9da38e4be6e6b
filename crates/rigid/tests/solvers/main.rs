//! The solvers of trees in one world. One program, so that each is compiled once for it, not once for each file.

mod contact;
mod dual;
mod falls;
mod ground;
mod guesses;
mod hull;
mod loops;
mod mesh;
mod run;
#[path = "../scene/mod.rs"]
#[allow(dead_code)] // some of its models are for other tests
mod scene;
mod xpbd_contact;
