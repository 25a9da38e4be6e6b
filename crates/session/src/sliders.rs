//! Sliders of drives and actuators: what they set, in which unit, and how far they go.

use crate::describe::axis;
use crate::protocol::Slider;
use model::{Actuator, Dof, Model};
use std::f64::consts::PI;

/// Ranges of angles [rad] and ways [m], and of their speeds [rad/s, m/s], where the model names none.
const TURN: f64 = PI;
const WAY: f64 = 1.0;
const TURNING: f64 = 10.0;
const GOING: f64 = 2.0;

/// What drives a degree of freedom: targets, and stiffness and damping where `gains` can be set.
pub(crate) fn of_drive(dof: &Dof, angular: bool, gains: bool) -> Vec<Slider> {
    let [position, speed, stiffness, damping] = if angular {
        ["rad", "rad/s", "N·m/rad", "N·m·s/rad"]
    } else {
        ["m", "m/s", "N/m", "N·s/m"]
    };
    let free = if angular { TURN } else { WAY };
    let fastest = if angular { TURNING } else { GOING };
    let range = dof
        .limit
        .map_or([-free, free], |limit| [limit.lower, limit.upper]);
    let (k, d) = (dof.drive.stiffness, dof.drive.damping);
    let gain = |name, label, unit, most| Slider {
        logarithmic: true,
        ..slider(name, label, unit, [0.0, most])
    };
    let all = [
        slider("position", "Target", position, range).help("Where the drive takes the joint."),
        gain(
            "stiffness",
            "Stiffness",
            stiffness,
            f64::max(100.0, 10.0 * k),
        )
        .help("How hard the drive holds the target."),
        slider("velocity", "Speed", speed, [-fastest, fastest])
            .help("How fast the drive moves the joint."),
        gain("damping", "Damping", damping, f64::max(10.0, 10.0 * d))
            .help("How hard the drive holds the speed."),
    ];
    let set = |slider: &Slider| gains || !slider.logarithmic;
    all.into_iter().filter(set).collect()
}

/// The control of an actuator.
pub(crate) fn of_actuator(model: &Model, actuator: &Actuator) -> Slider {
    let (servo, angular) = (Servo::of(actuator), is_angular(model, actuator));
    let factor = actuator.gain * actuator.gear;
    let force = if angular { "N·m" } else { "N" };
    let (unit, what) = match (servo, angular) {
        (Servo::Position, true) => ("rad", "where it takes the joint".to_owned()),
        (Servo::Position, false) => ("m", "where it takes the joint".to_owned()),
        (Servo::Velocity, true) => ("rad/s", "how fast it moves the joint".to_owned()),
        (Servo::Velocity, false) => ("m/s", "how fast it moves the joint".to_owned()),
        (Servo::Force, _) if factor == 1.0 => (force, "what it acts on the joint with".to_owned()),
        (Servo::Force, _) => ("", format!("{factor} {force} on the joint for each 1")),
        (Servo::Other, _) => ("", "a bare number".to_owned()),
    };
    let (lower, upper) = control_range(model, actuator);
    Slider {
        strict: actuator.control_range.is_some(),
        ..slider("value", &actuator.name, unit, [lower, upper])
    }
    .help(&format!(
        "Control of the actuator {}: {what}.",
        actuator.name
    ))
}

/// The range of an actuator's controls; where it names none, the one that its slider has.
pub(crate) fn control_range(model: &Model, actuator: &Actuator) -> (f64, f64) {
    let angular = is_angular(model, actuator);
    let free = || {
        let free = match Servo::of(actuator) {
            Servo::Position => {
                let dof = &model.joints[actuator.joint.0].dofs[actuator.dof];
                if let Some(limit) = dof.limit {
                    let ends = [limit.lower, limit.upper].map(|q| actuator.gear * q);
                    return (ends[0].min(ends[1]), ends[0].max(ends[1]));
                }
                if angular { TURN } else { WAY }
            }
            Servo::Velocity if angular => TURNING,
            Servo::Velocity => GOING,
            Servo::Force | Servo::Other => 1.0,
        };
        (-free, free)
    };
    actuator.control_range.unwrap_or_else(free)
}

/// What the control of an actuator is.
#[derive(Clone, Copy, PartialEq)]
enum Servo {
    Position,
    Velocity,
    Force,
    Other,
}

impl Servo {
    /// By the terms of its force, gain · u + bias₁ · l + bias₂ · l̇: a servo's is zero where l or l̇ is u.
    fn of(actuator: &Actuator) -> Self {
        let (gain, [constant, k, d]) = (actuator.gain, actuator.bias);
        match (k, d) {
            _ if constant != 0.0 || gain == 0.0 => Self::Other,
            (0.0, 0.0) => Self::Force,
            (0.0, d) if gain == -d => Self::Velocity,
            (k, _) if gain == -k => Self::Position,
            _ => Self::Other,
        }
    }
}

fn is_angular(model: &Model, actuator: &Actuator) -> bool {
    axis(&model.joints[actuator.joint.0], actuator.dof).0
}

fn slider(name: &str, label: &str, unit: &str, [min, max]: [f64; 2]) -> Slider {
    Slider {
        name: name.into(),
        label: label.into(),
        unit: unit.into(),
        help: String::new(),
        min,
        max,
        logarithmic: false,
        strict: false,
    }
}

impl Slider {
    fn help(mut self, help: &str) -> Self {
        self.help = help.into();
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::{JointId, examples};

    fn told(of: impl Fn(JointId) -> Actuator) -> Slider {
        let model = examples::room().unwrap();
        let joint = model.joints.iter().position(|joint| joint.name == "hinge");
        of_actuator(&model, &of(JointId(joint.unwrap())))
    }

    #[test]
    fn controls_have_the_unit_of_what_they_are() {
        let motor = told(|joint| Actuator::motor("m", joint));
        assert_eq!((motor.unit.as_str(), motor.strict), ("N·m", false));
        let geared = told(|joint| Actuator {
            gear: 100.0,
            control_range: Some((-0.4, 0.4)),
            ..Actuator::motor("m", joint)
        });
        assert_eq!((geared.unit.as_str(), geared.strict), ("", true));
        assert!(geared.help.contains("100 N·m"), "{}", geared.help);
        assert_eq!((geared.min, geared.max), (-0.4, 0.4));
        assert_eq!(
            told(|joint| Actuator::position("p", joint, 5.0, 0.5)).unit,
            "rad"
        );
        assert_eq!(
            told(|joint| Actuator::velocity("v", joint, 5.0)).unit,
            "rad/s"
        );
        let odd = told(|joint| Actuator {
            bias: [0.0, -1.0, 0.0],
            gain: 3.0,
            ..Actuator::motor("o", joint)
        });
        assert_eq!(odd.unit, "");
    }

    #[test]
    fn a_servo_without_a_range_goes_as_far_as_its_joint() {
        let model = examples::room().unwrap();
        let limited = (0..model.joints.len()).find(|&j| {
            let dofs = &model.joints[j].dofs;
            dofs.len() == 1 && dofs[0].limit.is_some()
        });
        let joint = JointId(limited.unwrap());
        let limit = model.joints[joint.0].dofs[0].limit.unwrap();
        let servo = Actuator {
            gear: -2.0,
            ..Actuator::position("p", joint, 5.0, 0.5)
        };
        let slider = of_actuator(&model, &servo);
        assert_eq!(
            (slider.min, slider.max),
            (-2.0 * limit.upper, -2.0 * limit.lower)
        );
    }
}
