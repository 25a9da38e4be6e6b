//! URDF, the robot files of ROS.
//!
//! Written from the XML specifications at <https://wiki.ros.org/urdf/XML>. How the file maps to a
//! model:
//!
//! - The root link is static; with [`Options::floating_base`] it hangs on a `free` joint. Links that
//!   only `fixed` joints tie to a static root are static too.
//! - `revolute` and `continuous`, `prismatic`, `floating`, `planar` and `fixed` joints become
//!   `revolute`, `prismatic`, `free`, `plane_xz` (turned so that its y is the axis) and `fixed`. All
//!   coordinates start at zero.
//! - A joint's limits become soft ones, as stiff as MuJoCo's standard limits (time constant 20 ms,
//!   critically damped, for the inertia at the start).
//! - `effort` limits the joint's drive; `mimic` becomes a coupling, and is noted at a fixed joint, which follows nothing.
//! - Links without mass or inertia that are fixed to others are fused with them; names that are lost are listed.
//! - Collision geometry collides, visual geometry is only seen. Mesh files are named, not read, unless
//!   those that collide are asked for, exact or as hulls ([`Options::meshes`]). The package of a `package://`
//!   path is a folder of its name, beside the file or above. Of a link whose visuals cannot be read, the collision
//!   geometry is seen; meshes that cannot be are listed.
//! - Elements of other programs that say nothing about the motion, as `<gazebo>` and `<transmission>`, are noted;
//!   other ones, such as `<xacro:…>` that was not expanded, are refused unless lenient.

mod geometry;
mod joint;
mod link;
mod nesting;
mod tree;

use crate::culprits::Culprits;
use crate::error::FormatError;
use crate::files::Files;
use crate::fuse::Fusion;
use crate::joint_space::JointSpace;
use crate::limit::Softness;
use crate::meshes::MeshReader;
use crate::report::Report;
use crate::xml::{self, Element};
use crate::{Loaded, Options, mesh_paths, names};
use geometry::{Colors, Looks};
use glam::DVec3;
use model::{Model, Parts, UpAxis};
use tree::Robot;

/// Reads a text; `file` names it in messages, `files` resolves the paths of meshes.
///
/// # Errors
/// The text is malformed, uses what is not supported and would change the physics, or describes an
/// impossible model.
pub fn parse(
    text: &str,
    file: &str,
    files: &dyn Files,
    options: &Options,
) -> Result<Loaded, FormatError> {
    let root = xml::parse(text, file)?;
    if root.name != "robot" {
        return Err(root.invalid("the root element is not <robot>", "give a URDF file"));
    }
    read(&root, files, options)
}

pub(crate) fn read(
    root: &Element,
    files: &dyn Files,
    options: &Options,
) -> Result<Loaded, FormatError> {
    let mut report = Report::new(options.lenient);
    nesting::check(root, &mut report)?;
    let looks = Looks {
        colors: Colors::read(root)?,
        meshes: MeshReader::new(files, options.meshes),
    };
    let robot = Robot::read(root, &mut report)?;
    let mut parts = Parts {
        name: root.get("name").unwrap_or("robot").to_owned(),
        up_axis: UpAxis::Z,
        gravity: DVec3::new(0.0, 0.0, -9.81),
        ..Parts::default()
    };
    let tree = tree::build(
        &robot,
        options.floating_base,
        &looks,
        &mut parts,
        &mut report,
    )?;
    let fusion = Fusion::plan(&parts, &tree.elements)?;
    soften(&tree, &mut parts);
    joint::couple(&tree, &mut parts, &mut report)?;
    mesh_paths::resolve(&mut parts, files);
    names::complete(&mut parts);
    let joints = tree.joints.iter().map(|j| (j.id, j.element));
    let culprits = Culprits::new(&parts, &tree.elements, joints);
    fusion.tell(&parts, &tree.elements, &mut report);
    fusion.apply(&mut parts);
    let model = Model::new(parts)
        .and_then(|model| looks.meshes.pieces.take_apart(model))
        .map_err(|error| culprits.locate(&root.place.file, error))?;
    Ok(Loaded {
        model,
        warnings: report.into_warnings(),
    })
}

/// Turns the ranges of the joints into limits of force.
fn soften(tree: &tree::Tree, parts: &mut Parts) {
    let space = JointSpace::new(parts);
    for joint in &tree.joints {
        if let Some(range) = joint.range {
            let inertia = space.effective_inertia(joint.id.0, 0);
            let limit = Softness::default().limit(range, inertia, parts.time_step);
            parts.joints[joint.id.0].dofs[0].limit = Some(limit);
        }
    }
}
