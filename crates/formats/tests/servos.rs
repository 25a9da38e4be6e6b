//! The laws of actuators whose classes have settings for several kinds of them, as MuJoCo 4.0 has them.

use kinetarium_formats::{InMemory, Options, parse};
use model::Actuator;

fn actuator(default: &str, actuator: &str) -> Actuator {
    let text = format!(
        "<mujoco><compiler angle='radian'/><default>{default}</default><worldbody><body>
           <joint name='j' axis='0 1 0' armature='1' range='-1 1'/><geom size='0.1'/>
         </body></worldbody><actuator>{actuator}</actuator></mujoco>"
    );
    let read = parse(
        &text,
        "robot.xml",
        &InMemory::default(),
        &Options::default(),
    );
    let loaded = read.unwrap_or_else(|error| panic!("{default} {actuator}: {error}"));
    loaded.model.actuators[0].clone()
}

/// Gains of the control, and biases: `actuator_gainprm` and `actuator_biasprm`, this where its type is not none. A
/// shortcut goes on from the innermost class that one of its kind, or a `general`, was the last to set.
#[test]
fn shortcuts_of_other_kinds_leave_no_gains() {
    #[rustfmt::skip]
    let cases = [
        ("<position kp='50' kv='3'/><velocity kv='5'/>", "<general joint='j'/>", 5.0, [0.0, 0.0, -5.0]),
        ("<position kp='50' kv='3'/><velocity kv='5'/>", "<position joint='j'/>", 1.0, [0.0, -1.0, 0.0]),
        ("<position kp='50' kv='3'/><velocity kv='5'/>", "<velocity joint='j'/>", 5.0, [0.0, 0.0, -5.0]),
        ("<position kp='50' kv='3'/><velocity kv='5'/>", "<motor joint='j'/>", 1.0, [0.0, 0.0, 0.0]),
        ("<velocity kv='5'/><position kp='50' kv='3'/>", "<position joint='j'/>", 50.0, [0.0, -50.0, -3.0]),
        ("<velocity kv='5'/><position kp='50' kv='3'/>", "<velocity joint='j'/>", 1.0, [0.0, 0.0, -1.0]),
        ("<velocity kv='5'/><position kp='50' kv='3'/>", "<motor joint='j'/>", 1.0, [0.0, 0.0, 0.0]),
        ("<position kp='50'/>", "<general joint='j'/>", 50.0, [0.0, -50.0, 0.0]),
        ("<position kp='50'/>", "<position joint='j' kv='2'/>", 50.0, [0.0, -50.0, -2.0]),
        ("<position kp='50'/>", "<velocity joint='j'/>", 1.0, [0.0, 0.0, -1.0]),
        ("<position kp='50'/>", "<velocity joint='j' kv='2'/>", 2.0, [0.0, 0.0, -2.0]),
        ("<position kp='50'/>", "<general joint='j' biasprm='9'/>", 50.0, [9.0, -50.0, 0.0]),
        ("<velocity kv='5'/>", "<general joint='j'/>", 5.0, [0.0, 0.0, -5.0]),
        ("<velocity kv='5'/>", "<position joint='j'/>", 1.0, [0.0, -1.0, 0.0]),
        ("<velocity kv='5'/>", "<position joint='j' kp='2'/>", 2.0, [0.0, -2.0, 0.0]),
        ("<general gainprm='7' biasprm='1 -3 -1'/>", "<general joint='j'/>", 7.0, [0.0, 0.0, 0.0]),
        ("<general gainprm='7' biasprm='1 -3 -1'/>", "<position joint='j'/>", 7.0, [0.0, -7.0, -1.0]),
        ("<general gainprm='7' biasprm='1 -3 -1'/>", "<velocity joint='j'/>", 7.0, [0.0, 0.0, -7.0]),
        ("<general gainprm='7' biasprm='1 -3 -1'/>", "<motor joint='j'/>", 1.0, [0.0, 0.0, 0.0]),
        ("<velocity kv='9'/><general gear='1'/>", "<position joint='j'/>", 9.0, [0.0, -9.0, -9.0]),
        ("<velocity kv='9'/><general gear='1'/>", "<velocity joint='j'/>", 9.0, [0.0, 0.0, -9.0]),
        ("<general gaintype='affine' gainprm='3'/>", "<position joint='j'/>", 1.0, [0.0, -1.0, 0.0]),
        ("<general gaintype='affine' gainprm='3'/>", "<velocity joint='j'/>", 1.0, [0.0, 0.0, -1.0]),
        ("<muscle/>", "<position joint='j'/>", 1.0, [0.0, -1.0, 0.0]),
        ("<muscle/>", "<velocity joint='j'/>", 1.0, [0.0, 0.0, -1.0]),
        ("<muscle/>", "<motor joint='j'/>", 1.0, [0.0, 0.0, 0.0]),
        ("<position kp='50' kv='3'/><default class='s'><velocity kv='4'/></default>", "<general class='s' joint='j'/>", 4.0, [0.0, 0.0, -4.0]),
        ("<position kp='50' kv='3'/><default class='s'><velocity kv='4'/></default>", "<position class='s' joint='j'/>", 50.0, [0.0, -50.0, -3.0]),
        ("<position kp='50' kv='3'/><default class='s'><velocity kv='4'/></default>", "<velocity class='s' joint='j'/>", 4.0, [0.0, 0.0, -4.0]),
        ("<general gainprm='7'/><default class='s'><position/><velocity/></default>", "<position class='s' joint='j'/>", 7.0, [0.0, -7.0, 0.0]),
        ("<general gainprm='7'/><default class='s'><position/><velocity/></default>", "<velocity class='s' joint='j'/>", 7.0, [0.0, 0.0, -7.0]),
        ("<general gainprm='7'/><position kv='3'/><default class='s'><motor/></default>", "<position class='s' joint='j'/>", 7.0, [0.0, -7.0, -3.0]),
        ("<general gainprm='7'/><position kv='3'/><default class='s'><motor/></default>", "<velocity class='s' joint='j'/>", 1.0, [0.0, 0.0, -1.0]),
        ("<position kp='50' kv='3'/><default class='s'><general gainprm='4'/></default>", "<position class='s' joint='j'/>", 4.0, [0.0, -4.0, -3.0]),
        ("<position kp='50' kv='3'/><default class='s'><general gainprm='4'/></default>", "<velocity class='s' joint='j'/>", 4.0, [0.0, 0.0, -4.0]),
        ("<velocity kv='2'/><default class='s'><position kp='4'/><velocity/></default>", "<position class='s' joint='j'/>", 1.0, [0.0, -1.0, 0.0]),
        ("<velocity kv='2'/><default class='s'><position kp='4'/><velocity/></default>", "<velocity class='s' joint='j'/>", 2.0, [0.0, 0.0, -2.0]),
        ("<position kp='50' kv='3'/><default class='s'><general gaintype='affine' gainprm='3'/></default>", "<position class='s' joint='j'/>", 50.0, [0.0, -50.0, -3.0]),
        ("<position kp='50' kv='3'/><default class='s'><general gaintype='affine' gainprm='3'/></default>", "<velocity class='s' joint='j'/>", 1.0, [0.0, 0.0, -1.0]),
        ("<position dampratio='1'/><general gainprm='7'/>", "<position joint='j'/>", 7.0, [0.0, -7.0, -5.335648461334018]),
        ("<general gainprm='5' biastype='affine' biasprm='0 -5 0.2'/>", "<general joint='j'/>", 5.0, [0.0, -5.0, -0.9018891997664217]),
    ];
    for (default, element, gain, bias) in cases {
        let found = actuator(default, element);
        assert_eq!(found.gain, gain, "{default} {element}");
        for (found, expected) in found.bias.iter().zip(bias) {
            let near = (found - expected).abs() < 1e-9;
            assert!(near, "{default} {element}: {found}, not {expected}");
        }
    }
}

/// `inheritrange` belongs to the law, `ctrlrange` to all kinds.
#[test]
fn ranges_of_the_joint_are_inherited_as_gains_are() {
    let joint_s = "<position inheritrange='1'/>";
    let inner = |settings: &str| format!("{joint_s}<default class='s'>{settings}</default>");
    let own = "<position joint='j'/>";
    let of_class = "<position class='s' joint='j'/>";
    let general = "<general class='s' joint='j'/>";
    for (default, element, expected) in [
        (format!("{joint_s}<velocity/>"), own, None),
        (
            format!("{joint_s}<motor ctrlrange='-3 3'/>"),
            own,
            Some((-3.0, 3.0)),
        ),
        (
            format!("<motor ctrlrange='-3 3'/>{joint_s}"),
            own,
            Some((-1.0, 1.0)),
        ),
        (
            format!("{joint_s}<general gear='1'/>"),
            own,
            Some((-1.0, 1.0)),
        ),
        (
            "<general inheritrange='1'/>".to_owned(),
            own,
            Some((-1.0, 1.0)),
        ),
        (
            "<general inheritrange='1' gaintype='affine'/>".to_owned(),
            own,
            None,
        ),
        (inner("<velocity/>"), of_class, Some((-1.0, 1.0))),
        (inner("<velocity/>"), general, None),
        (
            inner("<motor ctrlrange='-3 3'/>"),
            general,
            Some((-3.0, 3.0)),
        ),
        (
            inner("<general ctrlrange='-3 3'/>"),
            general,
            Some((-1.0, 1.0)),
        ),
    ] {
        let found = actuator(&default, element).control_range;
        assert_eq!(found, expected, "{default} {element}");
    }
}
