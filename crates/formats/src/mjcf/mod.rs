//! MJCF, the files of MuJoCo.
//!
//! Written from MuJoCo's XML reference and modeling guide (version 4.0); the names of their sections
//! are cited where they are followed. Everything that MuJoCo's compiler derives (masses and inertias
//! of geoms, frames, defaults) comes out the same; see the tests against MuJoCo.
//!
//! How the file maps to a model:
//!
//! - A body without joints is welded to its parent by a `fixed` joint; it is static where nothing
//!   above it moves. Geoms of the world belong to no body.
//! - One joint of a body is a `revolute`, `prismatic`, `ball` or `free` joint; several are one `d6`
//!   joint that carries the body's name, with each joint's name at its degree of freedom. So the
//!   coordinates are MuJoCo's qpos, except that quaternions are x, y, z, w.
//! - A free body without children gets the frame of its inertia where `align` or `alignfree` asks for it, and the very axes
//!   that MuJoCo takes, so that keyframes hold.
//! - Joint ranges, narrowed by their margin, become soft limits, springs and dampers that carry an inertia along.
//! - Bodies without mass or inertia that are welded to others are fused with them; names that are lost are listed.
//! - Geoms touch that MuJoCo lets touch: `contype` and `conaffinity` are a shape's kinds; bodies that
//!   are welded together, or of which one carries the other, are kept apart unless one is welded to
//!   the world; `<exclude>` and `<pair>` hold. Contacts have MuJoCo's friction and margins, and the
//!   softness of `solref` and `solimp` for the mass that it sees in the bodies at the start, softened by pyramids of
//!   friction as there; where `condim`, `priority` or `solmix` make them differ from what two materials make of
//!   each other, the model names the pair, which follows its shapes where they get another friction.
//! - Sensors of joints, actuators, frames and subtrees' centres, inertial units, forces, torques, touch and
//!   rangefinders are in the model's list ([`Parts::sensors`]), with their noise, cutoff and interval.
//! - Meshes whose points are written in the file are surfaces of triangles, or, without faces, convex hulls.
//! - Solids are fitted to meshes as in MuJoCo, whose files are read for that whatever they become where they collide.
//! - Cameras keep their names, places and fields of view; those of mode `track` go along with their body and do
//!   not turn with it.
//! - Equality constraints `connect` and `weld` become joints that close a loop, `joint` a coupling, or, of one joint alone,
//!   a spring that holds it, as stiff as MuJoCo's constraint is at half its width. A constraint that has the name of a joint has
//!   a number behind it.
//!
//! # Limitations
//!
//! - Cones of friction are round; what slides on the edges of MuJoCo's pyramids is pressed by some of them only.
//! - The impedance of `solimp` and `solimplimit` grows with the depth. Here contacts have at all depths what they
//!   have under twice the weight of the mass they see, and limits and joints that are held at a value what they have at half
//!   the width: heavier loads press further in than in MuJoCo, and lighter ones less. With MuJoCo's standard `solimp` a load
//!   that deflects a held joint by a thousandth [m or rad] or more there deflects it 1.58 times as far here, and small ones 0.71
//!   times.
//! - An exclusion of a fused body holds for the body that it is fused with.
//! - A ball joint stands alone on its body, is not limited, has no spring, and takes motors about one axis at a time.
//! - Refused unless lenient: drag by a fluid, gravity compensation, tendons that exert force, muscles
//!   and other actuators with a state, plugins, flexible bodies, polynomial springs, springs and limits of
//!   ball joints, `<replicate>`, `<attach>` and the like, and mass from a height field or from the volume of
//!   a mesh whose surface is open, unless it becomes its hull ([`Options::meshes`]). So is static mass of both where
//!   `settotalmass` counts it.
//! - Meshes weigh what their `inertia` says, once they are read, whatever they become; but `legacy`, which is MuJoCo's
//!   default, is `exact` here. In MuJoCo it is more where faces of the mesh look at its middle, which is noted. An open
//!   surface that becomes its hull weighs what that does.
//! - What `boundmass` gives a body without mass is at its origin; MuJoCo has it at `pos` from there.
//! - `actuatorfrcrange` narrows the force of the one actuator of its joint, and `actuatorfrc` tells it so; MuJoCo
//!   clamps the joint's force alone.
//! - `touch` is of all contacts of the site's body. What other sensors measure, and of rangefinders other `data` than
//!   the distance, is not read, and listed; nor is `subtreecom` where static bodies are in the subtree, but for frames
//!   that hold nothing: static bodies have no mass here.
//! - A rangefinder in the world sees what else is in the world; MuJoCo's sees bodies alone. A plane is the half space below
//!   it for rays as for contacts; pictures and MuJoCo's rays end it at its `size`, and the latter meet it from above alone.
//! - Cameras of mode `trackcom` go along with their body's origin; those that aim at a body, and orthographic ones,
//!   are left out.
//! - Meshes that are built in, or made by a plugin, are refused where they are used, unless lenient.
//! - A height field is its surface; MuJoCo's is solid down to its base.

mod actuator;
mod align;
mod assets;
mod body;
mod camera;
mod compiler;
mod contact;
mod content;
mod defaults;
mod equality;
mod fitted;
mod geom;
mod height_field;
mod hold;
mod include;
mod inertial;
mod joint;
mod keyframe;
mod light;
mod mesh_mass;
mod nesting;
mod option;
mod orientation;
mod principal_frame;
mod sections;
mod sensor;
mod servo;
mod shell;
mod site;
mod softening;
mod surface;
mod tendon;
mod tree;
mod written_mesh;

use crate::culprits::Culprits;
use crate::error::FormatError;
use crate::files::Files;
use crate::fuse::Fusion;
use crate::joint_space::JointSpace;
use crate::meshes::MeshReader;
use crate::report::Report;
use crate::xml::{self, Element};
use crate::{Loaded, Options, names};
use model::{Model, Parts, UpAxis};
use std::collections::HashSet;

/// What the whole file is read by.
struct Context<'a> {
    compiler: compiler::Compiler,
    physics: option::Physics,
    defaults: defaults::Defaults,
    assets: assets::Assets,
    meshes: MeshReader<'a>,
    /// Names of the geoms that `<pair>`s are of.
    paired: HashSet<&'a str>,
}

/// Reads a text; `file` names it in messages, `files` finds what it includes.
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
    if root.name != "mujoco" {
        return Err(root.invalid("the root element is not <mujoco>", "give an MJCF file"));
    }
    read(root, files, options)
}

pub(crate) fn read(
    root: Element,
    files: &dyn Files,
    options: &Options,
) -> Result<Loaded, FormatError> {
    let root = include::assemble(root, files)?;
    let mut report = Report::new(options.lenient);
    sections::check(&root, &mut report)?;
    nesting::check(&root)?;
    let compiler = compiler::Compiler::read(&root, &mut report)?;
    let defaults = defaults::Defaults::read(&root, &mut report)?;
    let context = Context {
        assets: assets::Assets::read(&root, &compiler, &defaults, &mut report)?,
        physics: option::Physics::read(&root, &mut report)?,
        meshes: MeshReader::new(files, options.meshes),
        paired: contact::paired(&root).collect(),
        compiler,
        defaults,
    };
    let mut tree = body::read(&root, &context, &mut report)?;
    let fusion = Fusion::plan(&tree.parts, &tree.elements)?;
    scale_total_mass(&mut tree.parts, context.compiler.total_mass);
    tendon::check(&root, &tree, &context, &mut report)?;
    let motors = actuator::read(&root, &mut tree, &context, &mut report)?;
    let space = JointSpace::new(&tree.parts);
    contact::read(&root, &mut tree, &space, &context, &mut report)?;
    softening::apply(&mut tree, &motors, &space, &context);
    keyframe::read(&root, &mut tree, &motors, &mut report)?;
    sensor::read(&root, &mut tree, &motors, &fusion, &context, &mut report)?;
    equality::read(&root, &mut tree, &space, &context, &mut report)?;

    let mut parts = tree.parts;
    let stem = root
        .place
        .file
        .rsplit(['/', '\\'])
        .next()
        .unwrap_or_default();
    let stem = stem.rsplit_once('.').map_or(stem, |(stem, _)| stem);
    parts.name = root.get("model").unwrap_or(stem).to_owned();
    parts.up_axis = UpAxis::Z;
    parts.gravity = context.physics.gravity;
    parts.time_step = context.physics.time_step;
    crate::mesh_paths::resolve(&mut parts, files);
    names::complete(&mut parts);
    let joints = tree.joints.iter().map(|j| (j.joint, &j.file.element));
    let culprits = Culprits::new(&parts, &tree.elements, joints);
    fusion.tell(&parts, &tree.elements, &mut report);
    fusion.apply(&mut parts);
    let model = Model::new(parts)
        .and_then(|model| contact::mix(model, &tree.surfaces, &context))
        .and_then(|model| context.meshes.pieces.take_apart(model))
        .map_err(|error| culprits.locate(&root.place.file, error))?;
    Ok(Loaded {
        model,
        warnings: report.into_warnings(),
    })
}

/// `settotalmass`: scales the masses and inertias of all bodies.
fn scale_total_mass(parts: &mut Parts, total: Option<f64>) {
    let mass: f64 = parts.bodies.iter().map(|body| body.mass).sum();
    let Some(total) = total.filter(|_| mass > 0.0) else {
        return;
    };
    for body in &mut parts.bodies {
        body.mass *= total / mass;
        body.inertia *= total / mass;
    }
}
