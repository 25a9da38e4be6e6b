//! Readers of robot files: MuJoCo's MJCF and ROS's URDF, each into a checked [`Model`].
//!
//! ```no_run
//! use kinetarium_formats as formats;
//!
//! let loaded = formats::load("robot.xml".as_ref(), &formats::Options::default())?;
//! println!("{} bodies", loaded.model.bodies.len());
//! for warning in &loaded.warnings {
//!     println!("{warning}");
//! }
//! # Ok::<(), formats::FormatError>(())
//! ```
//!
//! What a file uses and this crate does not support is never dropped in silence:
//! where leaving it out would change the motion it is an error (a warning with
//! [`Options::lenient`]), otherwise a [`Warning`], listed once per kind.
//!
//! Files keep their axes: both formats are Z up, and so are the models.

#![forbid(unsafe_code)]

mod culprits;
mod error;
mod files;
mod fuse;
mod impedance;
mod inertia;
mod joint_space;
mod limit;
mod mesh_paths;
mod meshes;
pub mod mjcf;
mod names;
mod pieces;
mod report;
pub mod urdf;
mod xml;

pub use error::{FormatError, Place};
pub use files::{Files, Folder, InMemory};
pub use report::Warning;

use model::Model;
use std::path::Path;

/// How a file is read.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Options {
    /// Turns "this is not supported and would change the physics" from an error into a warning.
    pub lenient: bool,
    /// What becomes of meshes that collide, or that a body has its mass from.
    pub meshes: Meshes,
    /// URDF only, and refused for MJCF: the root link floats freely. By default it is fixed to the world.
    pub floating_base: bool,
}

/// What becomes of meshes that collide, or that a body has its mass from. Those that are only seen are
/// named by their files in any case, and those that are written in the file stay what they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Meshes {
    /// They are named by their files, too; contacts of them are refused by the solvers. Those that are written in the file
    /// are taken as they are.
    #[default]
    Named,
    /// Each is read and stays what it is, a surface of triangles that is touched from outside, whether
    /// it moves or not. `.obj` and `.stl` files.
    Exact,
    /// Each is read and becomes its convex hull, as in MuJoCo: what was hollow is filled, but weighs nothing unless the
    /// file says so. `.obj` and `.stl` files.
    ConvexHull,
    /// Each is read and becomes convex pieces that together are nearly what it is: faster than
    /// triangles where bodies move, and what is hollow stays so but for a hundredth. The first piece
    /// has the place and name of the shape, the others stand after all shapes, with names that end in
    /// `_1`, `_2` and so on. It weighs what its surface holds. `.obj` and `.stl` files. Needs the feature
    /// `decomposition`, and is an error without. Meshes that touch nothing stay what they are.
    Pieces,
}

/// A model, and what of its file was left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The model.
    pub model: Model,
    /// What was ignored, once per kind of thing, by file and line.
    pub warnings: Vec<Warning>,
}

/// Reads a file. Its root element decides the format: `<mujoco>` or `<robot>`.
///
/// # Errors
/// The file (or one it includes) cannot be read, is malformed, uses what is not
/// supported and would change the physics, or describes an impossible model.
pub fn load(path: &Path, options: &Options) -> Result<Loaded, FormatError> {
    let (folder, file) = Folder::around(path);
    let text = files::read(&folder, &file)?;
    parse(&text, &folder.path(&file), &folder, options)
}

/// Reads a text as [`load`] does; `file` names it in messages, `files` finds what it includes.
///
/// # Errors
/// As [`load`].
pub fn parse(
    text: &str,
    file: &str,
    files: &dyn Files,
    options: &Options,
) -> Result<Loaded, FormatError> {
    let root = xml::parse(text, file)?;
    match root.name.as_str() {
        "mujoco" | "mujocoinclude" if options.floating_base => Err(root.invalid(
            "a floating base is asked for, which is for URDF files",
            "leave that out (--floating-base), and give the body a <freejoint/>",
        )),
        "mujoco" | "mujocoinclude" => mjcf::read(root, files, options),
        "robot" => urdf::read(&root, files, options),
        _ => Err(root.invalid(
            "the root element names no known format",
            "MJCF files start with <mujoco>, URDF files with <robot>",
        )),
    }
}
