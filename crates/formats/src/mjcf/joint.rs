//! `<joint>` and `<freejoint>` (XML reference, "body/joint"): one joint of the model for all the
//! joints of a body.

use super::Context;
use super::orientation::direction;
use crate::error::FormatError;
use crate::impedance::Impedance;
use crate::limit::Softness;
use crate::report::Report;
use crate::xml::Element;
use glam::DVec3;
use model::{Axis, AxisKind, BodyId, Dof, Joint, JointKind, Pose};

pub(super) const KNOWN: &[&str] = &[
    "name",
    "type",
    "group",
    "pos",
    "axis",
    "springdamper",
    "limited",
    "actuatorfrclimited",
    "solreflimit",
    "solimplimit",
    "stiffness",
    "range",
    "actuatorfrcrange",
    "margin",
    "ref",
    "springref",
    "springyield",
    "armature",
    "damping",
    "frictionloss",
    "user",
    "actuatorgravcomp",
];
pub(super) const UNUSED: &[(&str, &str)] = &[
    ("solreffriction", "dry friction is not softened"),
    ("solimpfriction", "dry friction is not softened"),
];
const FREE_JOINT: &[&str] = &["name", "group", "align", "user"];

/// MuJoCo's kinds of joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Free,
    Ball,
    Slide,
    Hinge,
}

impl Kind {
    /// Numbers in MuJoCo's qpos.
    pub fn coordinates(self) -> usize {
        match self {
            Self::Free => 7,
            Self::Ball => 4,
            Self::Slide | Self::Hinge => 1,
        }
    }
    /// Numbers in MuJoCo's qvel.
    pub fn degrees_of_freedom(self) -> usize {
        match self {
            Self::Free => 6,
            Self::Ball => 3,
            Self::Slide | Self::Hinge => 1,
        }
    }
}

/// A joint of the file.
pub(super) struct FileJoint {
    /// Its element, with inherited attributes.
    pub element: Element,
    pub kind: Kind,
    /// Position and axis in the body's frame.
    pub anchor: DVec3,
    pub axis: DVec3,
    pub reference: f64,
    /// What acts along each of its degrees of freedom; the limit comes later, for it needs the masses.
    pub dof: Dof,
    pub softness: Softness,
    /// The range that the file gives, whether it limits the coordinate or not.
    pub span: Option<(f64, f64)>,
    /// Where the limit begins to act: the range, narrowed by the margin.
    pub range: Option<(f64, f64)>,
    /// Time constant [s] and damping ratio of its spring and damper, instead of theirs.
    pub spring_damper: Option<[f64; 2]>,
    /// Range of the actuators' force on it; none of balls and free joints, as in MuJoCo.
    pub force_range: Option<(f64, f64)>,
}

/// Reads a joint with its inherited attributes; `frame` is the frame that it stands in.
pub(super) fn read(
    element: Element,
    frame: Pose,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<FileJoint, FormatError> {
    let kind = match element.word("type", &["free", "ball", "slide", "hinge"])? {
        _ if element.name == "freejoint" => Kind::Free,
        Some("free") => Kind::Free,
        Some("ball") => Kind::Ball,
        Some("slide") => Kind::Slide,
        _ => Kind::Hinge,
    };
    if element.name == "freejoint" {
        report.check_attributes(&element, FREE_JOINT, &[])?;
    } else {
        report.check_attributes(&element, KNOWN, UNUSED)?;
        refuse_plasticity(&element, report)?;
    }
    let turns = matches!(kind, Kind::Hinge | Kind::Ball);
    let angle = if turns { context.compiler.angle } else { 1.0 };
    let axis = match kind {
        Kind::Free | Kind::Ball => DVec3::Z,
        _ => direction(
            &element,
            "axis",
            element.vector("axis")?.unwrap_or(DVec3::Z),
        )?,
    };
    let anchor = element.vector("pos")?.unwrap_or(DVec3::ZERO);
    let [span, limits] = ranges(&element, kind, angle, context, report)?;
    let spring_damper = spring_damper(&element)?;
    let force_range = context
        .compiler
        .range(&element, "actuatorfrclimited", "actuatorfrcrange")?;
    Ok(FileJoint {
        kind,
        anchor: frame.point(anchor),
        axis: frame.direction(axis),
        reference: element.number("ref")?.unwrap_or(0.0) * angle,
        dof: dof(
            &element,
            kind,
            angle,
            spring_damper.is_some(),
            context,
            report,
        )?,
        softness: Softness {
            reference: solref(&element, "solreflimit")?,
            impedance: Impedance::read(&element, "solimplimit")?,
        },
        span,
        range: narrowed(&element, limits)?,
        spring_damper,
        force_range: force_range.filter(|_| matches!(kind, Kind::Hinge | Kind::Slide)),
        element,
    })
}

fn refuse_plasticity(element: &Element, report: &mut Report) -> Result<(), FormatError> {
    if element.number("springyield")?.unwrap_or(0.0) > 0.0 {
        report.refuse(element, "a spring that yields", "set springyield to 0")?;
    }
    Ok(())
}

/// What acts along each degree of freedom; where springdamper stands for them, without damping and stiffness.
fn dof(
    element: &Element,
    kind: Kind,
    angle: f64,
    spring_damper: bool,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<Dof, FormatError> {
    let physics = &context.physics;
    let mut dof = Dof {
        armature: element.non_negative("armature")?.unwrap_or(0.0),
        rest: element.number("springref")?.unwrap_or(0.0) * angle,
        ..Dof::default()
    };
    // Of both, springdamper stands for the first coefficient only.
    let stands = |x: f64| if spring_damper { 0.0 } else { x };
    if physics.on("damper") {
        dof.damping = stands(linear(element, "damping", report)?);
    }
    if physics.on("spring") {
        dof.stiffness = stands(linear(element, "stiffness", report)?);
    }
    if physics.on("frictionloss") {
        dof.friction_loss = element.non_negative("frictionloss")?.unwrap_or(0.0);
    }
    let springs = dof.stiffness != 0.0 || (spring_damper && physics.on("spring"));
    if matches!(kind, Kind::Free | Kind::Ball) {
        if springs {
            let remedy = match spring_damper {
                true => "write damping instead of springdamper",
                false => "set stiffness to 0",
            };
            report.refuse(element, "a spring at a ball or free joint", remedy)?;
        }
        (dof.stiffness, dof.rest) = (0.0, 0.0);
    }
    Ok(dof)
}

/// The first of up to three coefficients of a polynomial; the others must be zero.
pub(super) fn linear(
    element: &Element,
    name: &str,
    report: &mut Report,
) -> Result<f64, FormatError> {
    let coefficients = element.list(name, 1, 3)?.unwrap_or(vec![0.0]);
    if coefficients[0] < 0.0 {
        return Err(element.invalid_attribute(
            name,
            &format!("is {}, below zero", coefficients[0]),
            "write zero or a positive number",
        ));
    }
    if coefficients[1..].iter().any(|c| *c != 0.0) {
        let remedy = "keep its first coefficient only";
        report.refuse(element, &format!("nonlinear {name}"), remedy)?;
    }
    Ok(coefficients[0])
}

/// A solref attribute: both numbers above zero, or neither.
pub(super) fn solref(element: &Element, name: &str) -> Result<[f64; 2], FormatError> {
    let Some(numbers) = element.list(name, 1, 2)? else {
        return Ok([0.02, 1.0]);
    };
    let numbers = [numbers[0], numbers.get(1).copied().unwrap_or(1.0)];
    if numbers.iter().all(|x| *x > 0.0) || numbers.iter().all(|x| *x <= 0.0) {
        return Ok(numbers);
    }
    Err(element.invalid_attribute(
        name,
        "has a positive number and one that is not",
        "write time constant and damping ratio, both positive, or −stiffness and −damping",
    ))
}

/// Time constant and damping ratio; 0 0 is none.
fn spring_damper(element: &Element) -> Result<Option<[f64; 2]>, FormatError> {
    let given = element.numbers::<2>("springdamper")?;
    let given = given.filter(|numbers| *numbers != [0.0; 2]);
    if given.is_some_and(|numbers| numbers.iter().any(|x| *x <= 0.0)) {
        let problem = "has a number that is not positive";
        let remedy = "write a time constant and a damping ratio, or 0 0 for none";
        return Err(element.invalid_attribute("springdamper", problem, remedy));
    }
    Ok(given)
}

/// The range that is given, whether its limit acts or not, and the one that acts. MuJoCo leaves the first in the
/// unit of the file where it says that there is no limit.
fn ranges(
    element: &Element,
    kind: Kind,
    angle: f64,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<[Option<(f64, f64)>; 2], FormatError> {
    if kind == Kind::Free {
        return Ok([None; 2]);
    }
    let range = context.compiler.range(element, "limited", "range")?;
    let mut limits = range.map(|(lower, upper)| (lower * angle, upper * angle));
    let given = element
        .numbers::<2>("range")?
        .map(|[lower, upper]| (lower, upper));
    let span = limits.or(given.filter(|(lower, upper)| lower != upper));
    limits = limits.filter(|_| context.physics.on("limit"));
    if kind == Kind::Ball && limits.take().is_some() {
        let remedy = "use three hinges with limits";
        report.refuse(element, "a limit of a ball joint", remedy)?;
    }
    Ok([span, limits])
}

/// The range less the margin, at which the limit begins to act.
fn narrowed(
    element: &Element,
    limits: Option<(f64, f64)>,
) -> Result<Option<(f64, f64)>, FormatError> {
    let margin = element.number("margin")?.unwrap_or(0.0);
    let narrowed = limits.map(|(lower, upper)| (lower + margin, upper - margin));
    if narrowed.is_some_and(|(lower, upper)| lower > upper) {
        let remedy = "write a margin below half the range";
        return Err(element.invalid_attribute("margin", "leaves nothing of the range", remedy));
    }
    Ok(narrowed)
}

/// The joint of the model that a body's joints make together. `local` is the body's pose in the
/// parent, `pose` in the world.
///
/// The joint frame has the body's axes and lies at the first hinge or ball, so that only further
/// hinges elsewhere need an anchor of their own.
pub(super) fn assemble(
    body: &Element,
    joints: &[FileJoint],
    ends: (Option<BodyId>, BodyId),
    local: Pose,
    pose: Pose,
) -> Result<Joint, FormatError> {
    let kinds: Vec<Kind> = joints.iter().map(|joint| joint.kind).collect();
    let kind = joint_kind(body, &kinds)?;
    let (parent, child) = ends;
    if kind == JointKind::Free {
        if parent.is_some() {
            return Err(joints[0].element.invalid(
                "a free joint is only for children of the world",
                "move the body out of its parent, or use other joints",
            ));
        }
        return Ok(free(&joints[0], child, pose));
    }
    let turning = joints.iter().find(|joint| joint.kind != Kind::Slide);
    let anchor = turning.map_or(DVec3::ZERO, |joint| joint.anchor);
    let axes = joints
        .iter()
        .filter_map(|joint| axis(joint, anchor))
        .collect();
    let mut joint = Joint::new(String::new(), kind, parent, child, axes);
    joint.parent_frame = local * Pose::at(anchor);
    joint.child_frame = Pose::at(anchor);
    joint.dofs = dofs(joints);
    if let [single] = joints {
        joint.name = name(single);
    }
    Ok(joint)
}

fn joint_kind(body: &Element, kinds: &[Kind]) -> Result<JointKind, FormatError> {
    let count = |kind: Kind| kinds.iter().filter(|k| **k == kind).count();
    let (slides, hinges) = (count(Kind::Slide), count(Kind::Hinge));
    match kinds {
        [] => Ok(JointKind::Fixed),
        [Kind::Free] => Ok(JointKind::Free),
        [Kind::Ball] => Ok(JointKind::Ball),
        [Kind::Slide] => Ok(JointKind::Prismatic),
        [Kind::Hinge] => Ok(JointKind::Revolute),
        _ if kinds.contains(&Kind::Free) => Err(body.invalid(
            "it has a free joint and other joints",
            "remove the others: a free joint already moves in every way",
        )),
        _ if kinds.contains(&Kind::Ball) => Err(body.invalid(
            "it has a ball joint and other joints, which this engine does not stack",
            "put the others on a body of small mass between this one and its parent, or use hinges",
        )),
        _ if slides > 3 || hinges > 3 => Err(body.invalid(
            &format!("it has {slides} slides and {hinges} hinges, more than 3 of a kind"),
            "put some of them on a body of small mass between this one and its parent",
        )),
        _ => Ok(JointKind::D6),
    }
}

/// Frames that the joint stands in do nothing, as in MuJoCo.
fn free(joint: &FileJoint, child: BodyId, pose: Pose) -> Joint {
    let mut free = Joint::new(name(joint), JointKind::Free, None, child, Vec::new());
    let (p, q) = (pose.position, pose.orientation);
    free.initial = vec![p.x, p.y, p.z, q.x, q.y, q.z, q.w];
    free.dofs = dofs(std::slice::from_ref(joint));
    free
}

fn axis(joint: &FileJoint, origin: DVec3) -> Option<Axis> {
    let (kind, anchor) = match joint.kind {
        Kind::Hinge => (AxisKind::Angular, joint.anchor - origin),
        Kind::Slide => (AxisKind::Linear, DVec3::ZERO),
        Kind::Free | Kind::Ball => return None,
    };
    Some(Axis {
        kind,
        direction: joint.axis,
        anchor,
        reference: joint.reference,
    })
}

fn dofs(joints: &[FileJoint]) -> Vec<Dof> {
    let of = |joint: &FileJoint| {
        let n = joint.kind.degrees_of_freedom();
        let name = if n == 1 { name(joint) } else { String::new() };
        vec![
            Dof {
                name,
                ..joint.dof.clone()
            };
            n
        ]
    };
    joints.iter().flat_map(of).collect()
}

fn name(joint: &FileJoint) -> String {
    joint.element.get("name").unwrap_or_default().to_owned()
}
