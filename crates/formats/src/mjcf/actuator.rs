//! `<actuator>` (XML reference, "actuator"): motors and servos that act on joints.

use super::Context;
use super::defaults::inherit;
use super::joint::{Kind, linear};
use super::servo::Servo;
use super::tree::{Tree, TreeJoint, taken};
use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;
use model::Actuator;
use std::collections::HashSet;

/// Elements that set one another's defaults.
pub(super) const KINDS: &[&str] = &["general", "motor", "position", "velocity"];
/// Elements that are not supported.
pub(super) const OTHERS: &[&str] = &[
    "intvelocity",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "plugin",
    "pid",
    "orientation",
    "dcmotor",
];
const KNOWN: &[&str] = &[
    "name",
    "class",
    "group",
    "ctrlrange",
    "user",
    "ctrllimited",
    "forcelimited",
    "forcerange",
    "lengthrange",
    "gear",
    "damping",
    "armature",
    "cranklength",
    "joint",
    "jointinparent",
    "tendon",
    "slidersite",
    "cranksite",
    "site",
    "refsite",
    "nsample",
    "interp",
    "delay",
];
const GENERAL: &[&str] = &[
    "dyntype",
    "gaintype",
    "biastype",
    "dynprm",
    "gainprm",
    "biasprm",
    "body",
    "actdim",
    "actearly",
    "actlimited",
    "actrange",
    "inheritrange",
    "input",
    "velrange",
    "ffrange",
];
const POSITION: &[&str] = &["kp", "kv", "dampratio", "timeconst", "inheritrange"];
const VELOCITY: &[&str] = &["kv"];

/// What is known of the actuators besides the model's table.
#[derive(Default)]
pub(super) struct Motors {
    /// For each actuator of the file, whether it is in the model.
    pub kept: Vec<bool>,
    /// Names of those of the file.
    pub names: HashSet<String>,
    /// Rows of position servos that are damped by a ratio of the critical damping.
    pub damping_ratios: Vec<(usize, f64)>,
}

/// Reads all actuators into the tree's table.
pub(super) fn read(
    root: &Element,
    tree: &mut Tree,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<Motors, FormatError> {
    let mut motors = Motors::default();
    for element in root
        .children_named("actuator")
        .flat_map(|section| &section.children)
    {
        let name = element.get("name").unwrap_or_default();
        if !name.is_empty() && !motors.names.insert(name.to_owned()) {
            return Err(taken(element, "actuator", name));
        }
        let row = tree.parts.actuators.len();
        let read = read_one(element, tree, context, report)?;
        motors.kept.push(read.is_some());
        let Some((actuator, damping_ratio)) = read else {
            continue;
        };
        motors
            .damping_ratios
            .extend(damping_ratio.map(|ratio| (row, ratio)));
        tree.parts.actuators.push(actuator);
    }
    limit_joint_forces(tree, &motors, context, report)?;
    Ok(motors)
}

/// Reads an actuator, and its damping ratio; `None` where it was noted and left out.
fn read_one(
    element: &Element,
    tree: &mut Tree,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<Option<(Actuator, Option<f64>)>, FormatError> {
    let supported = is_supported(element, report)?;
    if supported {
        report.check_attributes(element, &known(&element.name), &[])?;
    }
    let kinds = [KINDS, OTHERS].concat();
    let classes = context.defaults.classes(element, None, &kinds)?;
    let merged = inherit(element, &classes.concat());
    // What is not supported has been told already, whatever it acts on.
    if supported || merged.has("joint") || merged.has("jointinparent") {
        add_reflected(&merged, tree, context, report)?;
    }
    if !supported {
        return Ok(None);
    }
    if let Some(why) = idleness(&merged, context)? {
        report.note(element, "actuator", why);
        return Ok(None);
    }
    if merged.number("delay")?.unwrap_or(0.0) > 0.0 {
        report.refuse(element, "delay of the control", "set delay to 0")?;
    }
    let servo = Servo::of(element, &classes)?.checked(element, report)?;
    let Some(target) = target(&merged, tree, &servo, report)? else {
        return Ok(None);
    };
    let control_range = control_range(&merged, target.joint, &servo, context)?;
    let actuator = Actuator {
        name: element.get("name").unwrap_or_default().to_owned(),
        joint: target.joint.joint,
        dof: target.joint.dof + target.dof,
        gear: target.gear,
        gain: servo.gain,
        bias: servo.bias,
        control_range: control_range.filter(|_| context.physics.on("clampctrl")),
        force_range: context
            .compiler
            .range(&merged, "forcelimited", "forcerange")?,
    };
    Ok(Some((actuator, servo.damping_ratio())))
}

/// Why an actuator is left out that exerts no force, if it is.
fn idleness(element: &Element, context: &Context<'_>) -> Result<Option<&'static str>, FormatError> {
    let group = element.integer("group")?.unwrap_or(0);
    Ok(if !context.physics.on("actuation") {
        Some("left out, for the flag `actuation` is off")
    } else if context.physics.switched_off.contains(&group) {
        Some("left out, for its group is in `actuatorgroupdisable`")
    } else {
        None
    })
}

fn is_supported(element: &Element, report: &mut Report) -> Result<bool, FormatError> {
    match element.name.as_str() {
        name if KINDS.contains(&name) => Ok(true),
        name if OTHERS.contains(&name) => {
            let remedy = "use motor, position, velocity or general";
            report.refuse(element, &format!("an actuator of kind {name}"), remedy)?;
            Ok(false)
        }
        _ => Err(element.invalid("this is no actuator", "correct its spelling")),
    }
}

/// The attributes of a kind that is supported.
pub(super) fn known(kind: &str) -> Vec<&'static str> {
    let own = match kind {
        "general" => GENERAL,
        "position" => POSITION,
        "velocity" => VELOCITY,
        _ => &[],
    };
    [KNOWN, own].concat()
}

/// What an actuator acts on.
struct Target<'a> {
    joint: &'a TreeJoint,
    /// Which of the joint's degrees of freedom.
    dof: usize,
    gear: f64,
}

/// The joint that the actuator is at; `None` where it is at another thing, and that was noted.
fn joint<'a>(
    element: &Element,
    tree: &'a Tree,
    report: &mut Report,
) -> Result<Option<&'a TreeJoint>, FormatError> {
    for other in ["tendon", "site", "body", "cranksite", "slidersite"] {
        if element.has(other) {
            let feature = format!("transmission by `{other}`");
            report.refuse(element, &feature, "let the actuator act on a joint")?;
            return Ok(None);
        }
    }
    let attribute = match element.has("jointinparent") {
        true => "jointinparent",
        false => "joint",
    };
    tree.joint(element, attribute).map(Some)
}

/// The degree of freedom that the actuator acts on; `None` where it was noted and left out.
fn target<'a>(
    element: &Element,
    tree: &'a Tree,
    servo: &Servo,
    report: &mut Report,
) -> Result<Option<Target<'a>>, FormatError> {
    let Some(joint) = joint(element, tree, report)? else {
        return Ok(None);
    };
    let gear = element.list("gear", 1, 6)?.unwrap_or(vec![1.0]);
    let scalar = matches!(joint.file.kind, Kind::Hinge | Kind::Slide);
    if scalar {
        return Ok(Some(Target {
            joint,
            dof: 0,
            gear: gear[0],
        }));
    }
    let n = joint.file.kind.degrees_of_freedom();
    let acting: Vec<usize> = (0..n)
        .filter(|i| gear.get(*i).is_some_and(|g| *g != 0.0))
        .collect();
    match acting[..] {
        _ if element.has("jointinparent") => {
            let feature =
                "an actuator of a ball or free joint along its parent's axes (`jointinparent`)";
            report.refuse(
                element,
                feature,
                "name it by `joint`: its axes turn with the body",
            )?;
            Ok(None)
        }
        [i] if servo.bias == [0.0; 3] => Ok(Some(Target {
            joint,
            dof: i,
            gear: gear[i],
        })),
        _ => {
            let feature = "a servo, or more than one axis, at a ball or free joint";
            report.refuse(element, feature, "use one motor for each axis")?;
            Ok(None)
        }
    }
}

/// The range of the control: given, or, of a servo of position, taken from the joint's.
fn control_range(
    element: &Element,
    target: &TreeJoint,
    servo: &Servo,
    context: &Context<'_>,
) -> Result<Option<(f64, f64)>, FormatError> {
    let mut range = servo.range;
    if servo.inherited > 0.0 && servo.holds_position() {
        let Some((lower, upper)) = target.file.span else {
            let problem = "asks for the range of a joint that has none";
            let remedy = "write ctrlrange instead";
            return Err(element.invalid_attribute("inheritrange", problem, remedy));
        };
        let middle = (lower + upper) / 2.0;
        let half = (upper - lower) / 2.0 * servo.inherited;
        range = [middle - half, middle + half];
    }
    context
        .compiler
        .acting(element, "ctrllimited", "ctrlrange", range)
}

/// Adds what the actuator's rotor adds to its joint, though the actuator be left out: inertia and damping times gear². As
/// in MuJoCo, the first number of `gear` counts for all degrees of freedom of a ball or free joint, and an `orientation`
/// has no rotor.
fn add_reflected(
    element: &Element,
    tree: &mut Tree,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<(), FormatError> {
    let armature = element.non_negative("armature")?.unwrap_or(0.0);
    let damping = match linear(element, "damping", report)? {
        damping if context.physics.on("damper") => damping,
        _ => 0.0,
    };
    if element.name == "orientation" || (armature, damping) == (0.0, 0.0) {
        return Ok(());
    }
    let Some(joint) = joint(element, tree, report)? else {
        return Ok(());
    };
    let gear2 = element
        .list("gear", 1, 6)?
        .map_or(1.0, |gear| gear[0] * gear[0]);
    let (id, first) = (joint.joint, joint.dof);
    let count = joint.file.kind.degrees_of_freedom();
    for dof in &mut tree.parts.joints[id.0].dofs[first..first + count] {
        dof.armature += gear2 * armature;
        dof.damping += gear2 * damping;
    }
    Ok(())
}

/// `actuatorfrcrange`: the range of all actuators' force on a joint, given to the one that there is.
fn limit_joint_forces(
    tree: &mut Tree,
    motors: &Motors,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<(), FormatError> {
    // MuJoCo clamps joints without actuators, too, once any joint has one.
    let clamps_all = !motors.kept.is_empty() && context.physics.on("actuation");
    for joint in &tree.joints {
        let Some((lower, upper)) = joint.file.force_range else {
            continue;
        };
        let on_it =
            |a: &&mut Actuator| (a.joint, a.dof) == (joint.joint, joint.dof) && a.gear != 0.0;
        let mut acting: Vec<&mut Actuator> =
            tree.parts.actuators.iter_mut().filter(on_it).collect();
        let element = &joint.file.element;
        match &mut acting[..] {
            [] if clamps_all && (lower > 0.0 || upper < 0.0) => {
                let feature = "`actuatorfrcrange` without 0 at a joint on which no actuator acts";
                report.refuse(element, feature, "remove it, or widen it to 0")?;
            }
            [] => {}
            [one] => narrow_force_range(one, lower, upper),
            _ => {
                let feature = "`actuatorfrcrange` at a joint with several actuators";
                report.refuse(element, feature, "give each a forcerange instead")?;
            }
        }
    }
    Ok(())
}

/// The force is clamped to its own range and then, behind the gear, to the joint's: where they do not meet, it is
/// the nearer end of the latter.
fn narrow_force_range(actuator: &mut Actuator, lower: f64, upper: f64) {
    let (a, b) = (lower / actuator.gear, upper / actuator.gear);
    let within = |force: f64| force.clamp(a.min(b), a.max(b));
    let (own_lower, own_upper) = actuator
        .force_range
        .unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    actuator.force_range = Some((within(own_lower), within(own_upper)));
}
