//! `<sensor>` (XML reference, "sensor"): what is measured, and where.
//!
//! Readings are MuJoCo's `sensordata`, but for what the model does otherwise: quaternions are x, y, z, w, angles of
//! joints that turn without end are in [−π, π], and a rangefinder that meets nothing reads its largest range.

use super::Context;
use super::actuator::Motors;
use super::joint::Kind;
use super::tree::{Tree, TreeJoint, taken, unknown};
use crate::error::FormatError;
use crate::fuse::Fusion;
use crate::names::Taken;
use crate::report::Report;
use crate::xml::Element;
use glam::{DQuat, DVec3};
use model::{Axes, BodyId, Geometry, JointId, JointKind, Measurand, Mount, Pose, Sensor, Shape};
use std::collections::HashSet;

/// Attributes of all sensors that are read.
const KNOWN: &[&str] = &["name", "noise", "cutoff", "interval", "user"];
const UNUSED: &[(&str, &str)] = &[
    ("nsample", "readings have no history"),
    ("interp", "readings have no history"),
    ("delay", "readings are told at once"),
];
/// Attributes that name what is measured.
const OBJECTS: &[&str] = &[
    "site", "joint", "actuator", "body", "objtype", "objname", "reftype", "refname", "camera",
    "data",
];
/// Sensors that are not read.
const OTHERS: &[&str] = &[
    "magnetometer",
    "camprojection",
    "tendonpos",
    "tendonvel",
    "actuatorpos",
    "actuatorvel",
    "tendonactuatorfrc",
    "jointlimitpos",
    "jointlimitvel",
    "jointlimitfrc",
    "tendonlimitpos",
    "tendonlimitvel",
    "tendonlimitfrc",
    "framexaxis",
    "frameyaxis",
    "framezaxis",
    "framelinacc",
    "frameangacc",
    "subtreelinvel",
    "subtreeangmom",
    "insidesite",
    "distance",
    "normal",
    "fromto",
    "contact",
    "e_potential",
    "e_kinetic",
    "clock",
    "tactile",
    "user",
    "plugin",
];

/// Reads all sensors into the tree's table, after its bodies, joints and actuators.
pub(super) fn read(
    root: &Element,
    tree: &mut Tree,
    motors: &Motors,
    fusion: &Fusion,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<(), FormatError> {
    let sections = root.children_named("sensor");
    let elements: Vec<_> = sections.flat_map(|section| &section.children).collect();
    check_names(&elements)?;
    let mut sensors = Vec::new();
    for element in elements {
        if !context.physics.on("sensor") {
            report.note(element, "sensor", "left out, for its flag is off");
            continue;
        }
        let mut reader = Reader {
            element,
            tree,
            motors,
            fusion,
            report,
        };
        if let Some(sensor) = reader.sensor()? {
            sensors.push((sensor, element.name.as_str()));
        }
    }
    let mut taken = Taken::by(sensors.iter().map(|(sensor, _)| &sensor.name));
    for (mut sensor, kind) in sensors {
        taken.fill(&mut sensor.name, kind);
        tree.parts.sensors.push(sensor);
    }
    Ok(())
}

fn check_names(elements: &[&Element]) -> Result<(), FormatError> {
    let mut names = HashSet::new();
    for element in elements {
        let name = element.get("name").unwrap_or_default();
        if !name.is_empty() && !names.insert(name) {
            return Err(taken(element, "sensor", name));
        }
    }
    Ok(())
}

/// One element, and what it is read by.
struct Reader<'a> {
    element: &'a Element,
    tree: &'a Tree,
    motors: &'a Motors,
    fusion: &'a Fusion,
    report: &'a mut Report,
}

impl Reader<'_> {
    /// The sensor; `None` where it was noted and left out.
    fn sensor(&mut self) -> Result<Option<Sensor>, FormatError> {
        let element = self.element;
        if OTHERS.contains(&element.name.as_str()) {
            return Ok(self.leave_out("sensors of this kind"));
        }
        self.report
            .check_attributes(element, &[KNOWN, OBJECTS].concat(), UNUSED)?;
        let Some(measurand) = self.measurand()? else {
            return Ok(None);
        };
        let positive = |x: &f64| *x > 0.0;
        let interval = element.list("interval", 1, 2)?;
        let period = interval.map(|interval| interval[0]).filter(positive);
        // Quaternions are of unit length whatever is said.
        let turns = matches!(
            measurand,
            Measurand::Orientation { .. } | Measurand::BallOrientation { .. }
        );
        let cutoff = element.non_negative("cutoff")?.filter(positive);
        Ok(Some(Sensor {
            rate: period.map(f64::recip).filter(|rate| rate.is_finite()),
            noise: element.non_negative("noise")?.unwrap_or(0.0),
            cutoff: cutoff.filter(|_| !turns),
            ..Sensor::new(element.get("name").unwrap_or_default(), measurand)
        }))
    }

    fn leave_out<T>(&mut self, what: &str) -> Option<T> {
        self.report.note(self.element, what, "not read");
        None
    }

    fn measurand(&mut self) -> Result<Option<Measurand>, FormatError> {
        Ok(match self.element.name.as_str() {
            "jointpos" => self.axis(|joint, axis| Measurand::JointPosition { joint, axis })?,
            "jointvel" => self.axis(|joint, axis| Measurand::JointVelocity { joint, axis })?,
            "jointactuatorfrc" => {
                self.axis(|joint, axis| Measurand::JointEffort { joint, axis })?
            }
            "ballquat" => self.ball(|joint| Measurand::BallOrientation { joint })?,
            "ballangvel" => self.ball(|joint| Measurand::BallVelocity { joint })?,
            "actuatorfrc" => self.actuator_force()?,
            "accelerometer" => Some(Measurand::Acceleration {
                mount: self.site()?,
            }),
            "velocimeter" => Some(Measurand::Velocity {
                mount: self.site()?,
                axes: Axes::Own,
            }),
            "gyro" => Some(Measurand::AngularVelocity {
                mount: self.site()?,
                axes: Axes::Own,
            }),
            "force" => self.reaction(|joint, frame| Measurand::Force { joint, frame })?,
            "torque" => self.reaction(|joint, frame| Measurand::Torque { joint, frame })?,
            "touch" => self.touch()?,
            "rangefinder" => self.rangefinder()?,
            "framepos" => {
                self.pose(|mount, relative_to| Measurand::Position { mount, relative_to })?
            }
            "framequat" => self.orientation()?,
            "framelinvel" => self.velocity(|mount, axes| Measurand::Velocity { mount, axes })?,
            "frameangvel" => {
                self.velocity(|mount, axes| Measurand::AngularVelocity { mount, axes })?
            }
            "subtreecom" => self.center_of_mass()?,
            _ => {
                let remedy = "correct its spelling, or remove it";
                return Err(self.element.invalid("this is no sensor", remedy));
            }
        })
    }

    fn joint(&self, kinds: &[Kind], remedy: &str) -> Result<&TreeJoint, FormatError> {
        let joint = self.tree.joint(self.element, "joint")?;
        if kinds.contains(&joint.file.kind) {
            return Ok(joint);
        }
        let problem = "names a joint of another kind than is measured";
        Err(self.element.invalid_attribute("joint", problem, remedy))
    }
    fn axis(
        &self,
        of: impl Fn(JointId, usize) -> Measurand,
    ) -> Result<Option<Measurand>, FormatError> {
        let joint = self.joint(&[Kind::Hinge, Kind::Slide], "name a hinge or slide joint")?;
        Ok(Some(of(joint.joint, joint.dof)))
    }
    fn ball(&self, of: impl Fn(JointId) -> Measurand) -> Result<Option<Measurand>, FormatError> {
        let joint = self.joint(&[Kind::Ball], "name a ball joint")?;
        Ok(Some(of(joint.joint)))
    }

    fn actuator_force(&mut self) -> Result<Option<Measurand>, FormatError> {
        let name = self.element.require("actuator")?;
        let mut actuators = self.tree.parts.actuators.iter();
        let row = actuators.position(|a| !name.is_empty() && a.name == name);
        if let Some(actuator) = row {
            self.note_joint_range(actuator);
            return Ok(Some(Measurand::ActuatorForce { actuator }));
        }
        if self.motors.names.contains(name) {
            return Ok(self.leave_out("of an actuator that is left out"));
        }
        if self.report.is_lenient() {
            return Ok(self.leave_out("of an actuator that is not there"));
        }
        let names = self.motors.names.iter().map(String::as_str);
        Err(unknown(self.element, "actuator", "actuator", names))
    }

    /// MuJoCo clamps the joint's force, not the actuator's, to the joint's range.
    fn note_joint_range(&mut self, actuator: usize) {
        let actuator = &self.tree.parts.actuators[actuator];
        let is_its = |j: &&TreeJoint| (j.joint, j.dof) == (actuator.joint, actuator.dof);
        let joint = self.tree.joints.iter().find(is_its);
        if joint.is_some_and(|joint| joint.file.force_range.is_some()) {
            let meaning = "within the joint's `actuatorfrcrange`; MuJoCo tells the force before it is clamped to that";
            self.report.note(self.element, "actuatorfrc", meaning);
        }
    }

    fn site(&self) -> Result<Mount, FormatError> {
        let (body, pose) = self.tree.site(self.element, "site")?;
        Ok(Mount { body, pose })
    }

    /// Of the joint that carries the site's body.
    fn reaction(
        &mut self,
        of: impl Fn(JointId, Pose) -> Measurand,
    ) -> Result<Option<Measurand>, FormatError> {
        let Mount { body, pose } = self.site()?;
        let joints = self.tree.parts.joints.iter();
        let carrier = joints
            .enumerate()
            .find(|(_, joint)| !joint.closes_loop && Some(joint.child) == body)
            .filter(|(_, joint)| joint.kind != JointKind::Free);
        let Some((row, joint)) = carrier else {
            return Ok(self.leave_out("at a body that no joint holds"));
        };
        if self.fusion.takes_up(joint.child) {
            return Ok(self.leave_out("at a body that is fused with its parent"));
        }
        Ok(Some(of(JointId(row), pose)))
    }

    fn touch(&mut self) -> Result<Option<Measurand>, FormatError> {
        let Some(body) = self.site()?.body else {
            return Ok(self.leave_out("at a site of the world"));
        };
        let meaning = "of all contacts of the body, not of those within the site alone";
        self.report.note(self.element, "touch", meaning);
        Ok(Some(Measurand::Touch { body }))
    }

    fn center_of_mass(&mut self) -> Result<Option<Measurand>, FormatError> {
        let body = self.tree.body(self.element, "body")?;
        if body.is_some_and(|body| self.fusion.takes_up(body)) {
            return Ok(self.leave_out("of a body that is fused with its parent"));
        }
        if self.has_static_parts(body) {
            return Ok(self.leave_out("of static bodies, which have no mass here"));
        }
        Ok(Some(Measurand::CenterOfMass { body }))
    }

    /// Whether static bodies of a subtree change its centre of mass: those that may weigh (the mass of their meshes is
    /// not known), and those that stand between its body and what moves, for no joint carries them.
    fn has_static_parts(&self, of: Option<BodyId>) -> bool {
        let parts = &self.tree.parts;
        let mut inside: Vec<bool> = Vec::new();
        for (row, parent) in self.tree.parents.iter().enumerate() {
            let below = parent.is_some_and(|parent| inside[parent.0]);
            inside.push(below || of.is_none_or(|of| of.0 == row));
        }
        let is_static = |id: &BodyId| inside[id.0] && !self.tree.moves(Some(*id));
        // Whether a body carries any that moves.
        let mut leads = vec![false; inside.len()];
        for (row, parent) in self.tree.parents.iter().enumerate().rev() {
            if let Some(parent) = parent {
                leads[parent.0] |= leads[row] || self.tree.moves(Some(BodyId(row)));
            }
        }
        let between = |id: BodyId| leads[id.0] && of.is_some_and(|of| of != id);
        let changes = |id: BodyId| parts.bodies[id.0].mass > 0.0 || between(id);
        let mut bodies = (0..inside.len()).map(BodyId).filter(is_static);
        let is_mesh = |shape: &&Shape| {
            use Geometry::{Hull, Mesh, MeshFile};
            matches!(shape.geometry, Hull(_) | Mesh(_) | MeshFile { .. })
        };
        let meshes = parts.shapes.iter().filter(is_mesh);
        let mut of_meshes = meshes.filter_map(|shape| shape.body);
        bodies.any(changes) || of_meshes.any(|id| is_static(&id))
    }

    /// MuJoCo's goes along z.
    fn rangefinder(&mut self) -> Result<Option<Measurand>, FormatError> {
        let data = self.element.get("data").unwrap_or("dist");
        if self.element.has("camera") || data.split_ascii_whitespace().ne(["dist"]) {
            return Ok(self.leave_out("rangefinders that tell more than one distance"));
        }
        let mount = self.site()?;
        let along = Pose::new(DVec3::ZERO, DQuat::from_rotation_arc(DVec3::X, DVec3::Z));
        let mount = mount.at(mount.pose * along);
        Ok(Some(Measurand::Distance { mount }))
    }

    /// The frame that two attributes name.
    fn frame(&mut self, kind: &str, name: &str) -> Result<Option<Mount>, FormatError> {
        let (element, tree) = (self.element, self.tree);
        let words = ["body", "xbody", "geom", "site", "camera"];
        element.require(kind)?;
        match element.word(kind, &words)?.unwrap_or_default() {
            "xbody" => Ok(Some(Mount {
                body: tree.body(element, name)?,
                pose: Pose::IDENTITY,
            })),
            "body" => {
                let body = tree.body(element, name)?;
                let center = body.map_or(DVec3::ZERO, |id| tree.parts.bodies[id.0].center);
                Ok(Some(Mount {
                    body,
                    pose: Pose::at(center),
                }))
            }
            "site" => {
                let (body, pose) = tree.site(element, name)?;
                Ok(Some(Mount { body, pose }))
            }
            "geom" => {
                let shape = &tree.parts.shapes[tree.geom(element, name)?.0];
                let solid = !matches!(
                    shape.geometry,
                    Geometry::Mesh { .. } | Geometry::MeshFile { .. } | Geometry::Hull { .. }
                );
                if !solid {
                    return Ok(self.leave_out("the frame of a mesh"));
                }
                Ok(Some(Mount {
                    body: shape.body,
                    pose: Pose::at(shape.pose.position),
                }))
            }
            _ => Ok(self.leave_out("the frame of a camera")),
        }
    }
    /// The frame of reference; the world if none is named.
    fn reference(&mut self) -> Result<Option<Mount>, FormatError> {
        if !self.element.has("reftype") && !self.element.has("refname") {
            return Ok(Some(Mount::default()));
        }
        if self.turned_otherwise("reftype") {
            return Ok(
                self.leave_out("a frame of reference that is a geom's or along principal axes")
            );
        }
        self.frame("reftype", "refname")
    }
    /// Whether only the origin of a frame is known: principal axes have no order, and geoms may lie along other
    /// axes here.
    fn turned_otherwise(&self, kind: &str) -> bool {
        matches!(self.element.get(kind), Some("body" | "geom"))
    }

    fn pose(
        &mut self,
        of: impl Fn(Mount, Mount) -> Measurand,
    ) -> Result<Option<Measurand>, FormatError> {
        let frame = self.frame("objtype", "objname")?;
        let reference = self.reference()?;
        Ok(frame
            .zip(reference)
            .map(|(frame, reference)| of(frame, reference)))
    }
    fn orientation(&mut self) -> Result<Option<Measurand>, FormatError> {
        if self.turned_otherwise("objtype") {
            self.frame("objtype", "objname")?;
            return Ok(self.leave_out("the orientation of a geom or of principal axes"));
        }
        self.pose(|mount, relative_to| Measurand::Orientation { mount, relative_to })
    }
    fn velocity(
        &mut self,
        of: impl Fn(Mount, Axes) -> Measurand,
    ) -> Result<Option<Measurand>, FormatError> {
        let frame = self.frame("objtype", "objname")?;
        let reference = self.reference()?;
        if reference.is_some_and(|r| r != Mount::default()) {
            return Ok(self.leave_out("a velocity relative to a frame"));
        }
        Ok(frame
            .zip(reference)
            .map(|(frame, _)| of(frame, Axes::World)))
    }
}
