//! Actuators: their ranges, their rotors, and those that do nothing.

use crate::common::{lenient, lines, read};

/// MuJoCo's ranges act where the lower end is below the upper one. 0 0, its default, is none, and takes back what is
/// inherited, whether `autolimits` is on or off.
#[test]
fn ranges_of_0_0_are_none() {
    for (compiler, empty) in [("true", "0 0"), ("true", "1 1"), ("false", "0 0")] {
        let loaded = read(&format!(
            "<mujoco><compiler autolimits='{compiler}'/>
             <default><joint range='0 90' actuatorfrcrange='-1 1'/><tendon range='0 1'/>
               <motor ctrlrange='-1 1' forcerange='-2 2'/></default>
             <worldbody><body>
               <joint name='j' range='{empty}' actuatorfrcrange='{empty}'/><geom size='0.1'/>
             </body></worldbody>
             <tendon><fixed range='{empty}'><joint joint='j' coef='1'/></fixed></tendon>
             <actuator><motor joint='j' ctrlrange='{empty}' forcerange='{empty}'/></actuator></mujoco>"
        ));
        assert_eq!(loaded.model.joints[0].dofs[0].limit, None);
        let actuator = &loaded.model.actuators[0];
        let ranges = (actuator.control_range, actuator.force_range);
        assert_eq!(ranges, (None, None), "{empty}");
    }
}

/// The force is clamped to its own range, and behind the gear to its joint's, whether these meet or not.
#[test]
fn forces_are_clamped_to_the_range_of_the_joint_at_last() {
    let second = "<motor joint='j' gear='0'/>";
    for (own, other, expected) in [
        ("gear='-2' forcerange='-.25 5'", "", (-0.25, 0.5)),
        ("forcerange='5 10'", "", (1.0, 1.0)),
        ("forcerange='5 10' gear='-2'", "", (0.5, 0.5)),
        ("forcerange='-10 -5'", "", (-1.0, -1.0)),
        ("", second, (-1.0, 1.0)),
    ] {
        let loaded = read(&format!(
            "<mujoco><worldbody><body><joint name='j' actuatorfrcrange='-1 1'/><geom size='1'/></body></worldbody>
             <actuator><motor joint='j' {own}/>{other}</actuator></mujoco>"
        ));
        let found = loaded.model.actuators[0].force_range;
        assert_eq!(found, Some(expected), "{own}");
        assert_eq!(loaded.warnings, []);
    }
}

/// What MuJoCo 4.0 makes of `ctrlrange` and `inheritrange` at several levels.
#[test]
fn the_last_of_two_ranges_of_a_control_holds() {
    let inherited = "<position inheritrange='1'/>";
    let range = "range='-1 1'";
    let servo = "biastype='affine' gainprm='2' biasprm='0 -2'";
    let general = format!("<general joint='j' ctrlrange='-3 3' {servo}/>");
    let no_servo = "<general joint='j' ctrlrange='-3 3' inheritrange='1'/>";
    let own = "<position joint='j' inheritrange='2'/>";
    let unlimited = "<position joint='j' ctrllimited='false'/>";
    for (default, joint, actuator, expected) in [
        (inherited, range, "<position joint='j'/>", Some((-1.0, 1.0))),
        (
            inherited,
            range,
            "<position joint='j' ctrlrange='-3 3'/>",
            Some((-3.0, 3.0)),
        ),
        (
            inherited,
            range,
            "<position joint='j' ctrlrange='0 0'/>",
            None,
        ),
        (
            inherited,
            range,
            "<position joint='j' inheritrange='0'/>",
            None,
        ),
        (inherited, range, unlimited, None),
        (inherited, range, "<motor joint='j'/>", None),
        (
            "<position ctrlrange='-3 3'/>",
            range,
            own,
            Some((-2.0, 2.0)),
        ),
        (
            "<general inheritrange='1'/>",
            range,
            general.as_str(),
            Some((-1.0, 1.0)),
        ),
        ("", range, no_servo, Some((-3.0, 3.0))),
        // The joint's range is taken whether it limits the joint or not.
        ("", "range='-1 1' limited='false'", own, Some((-2.0, 2.0))),
    ] {
        for flag in ["enable", "disable"] {
            let loaded = read(&format!(
                "<mujoco><compiler angle='radian'/><option><flag limit='{flag}'/></option>
                 <default>{default}</default>
                 <worldbody><body><joint name='j' {joint}/><geom size='0.1'/></body></worldbody>
                 <actuator>{actuator}</actuator></mujoco>"
            ));
            let found = loaded.model.actuators[0].control_range;
            assert_eq!(found, expected, "{default} {joint} {actuator}");
        }
    }
}

/// The first number of `gear` counts, squared, for all degrees of freedom of a joint: MuJoCo 4.0's mass matrix and
/// passive forces.
#[test]
fn rotors_reflect_on_all_of_a_joint() {
    for (kind, count, gear, factor) in [
        ("hinge", 1, "3", 9.0),
        ("ball", 3, "0 2 0", 0.0),
        ("ball", 3, "3", 9.0),
        ("free", 6, "0 0 0 5", 0.0),
        ("free", 6, "3", 9.0),
    ] {
        let model = read(&format!(
            "<mujoco><worldbody><body><joint name='j' type='{kind}'/><geom size='1'/></body></worldbody>
             <actuator><motor joint='j' armature='2' damping='5' gear='{gear}'/></actuator></mujoco>"
        ))
        .model;
        let found = model.joints[0].dofs.iter();
        let found: Vec<_> = found.map(|dof| (dof.armature, dof.damping)).collect();
        assert_eq!(
            found,
            vec![(2.0 * factor, 5.0 * factor); count],
            "{kind} {gear}"
        );
    }
}

/// As in MuJoCo 4.0, where an `orientation` has no rotor; a tendon's is left out with it.
#[test]
fn rotors_of_actuators_that_are_left_out_stay() {
    let rotor = "armature='2' damping='5' gear='3'";
    for (kind, actuator, factor) in [
        ("hinge", format!("<muscle joint='j' {rotor}/>"), 9.0),
        ("hinge", format!("<pid joint='j' {rotor}/>"), 9.0),
        (
            "hinge",
            format!("<general joint='j' dyntype='integrator' {rotor}/>"),
            9.0,
        ),
        (
            "hinge",
            format!("<position joint='j' timeconst='1' {rotor}/>"),
            9.0,
        ),
        ("ball", format!("<position joint='j' {rotor}/>"), 9.0),
        ("ball", format!("<motor jointinparent='j' {rotor}/>"), 9.0),
        ("ball", "<orientation joint='j' class='c'/>".to_owned(), 0.0),
        ("hinge", format!("<motor tendon='t' {rotor}/>"), 0.0),
    ] {
        let loaded = lenient(&format!(
            "<mujoco><default><default class='c'><general {rotor}/></default></default>
             <worldbody><body><joint name='j' type='{kind}'/><geom size='1'/></body></worldbody>
             <actuator>{actuator}</actuator></mujoco>"
        ));
        assert_eq!(
            loaded.warnings.len(),
            1,
            "{actuator}: {:?}",
            loaded.warnings
        );
        for dof in &loaded.model.joints[0].dofs {
            let found = (dof.armature, dof.damping);
            assert_eq!(found, (2.0 * factor, 5.0 * factor), "{actuator}");
        }
    }
}

/// They exert no force in MuJoCo, but their rotors go along.
#[test]
fn actuators_that_are_switched_off_are_noted() {
    for (option, told) in [
        (
            "<option actuatorgroupdisable='2'/>",
            "its group is in `actuatorgroupdisable`",
        ),
        (
            "<option><flag actuation='disable'/></option>",
            "the flag `actuation` is off",
        ),
    ] {
        let loaded = read(&format!(
            "<mujoco>{option}<default><motor group='2'/></default>
             <worldbody><body><joint name='j' actuatorfrcrange='-1 1'/><geom size='1'/></body></worldbody>
             <actuator><motor joint='j' armature='3' damping='2'/><motor tendon='t'/></actuator></mujoco>"
        ));
        let told = format!("robot.xml:3: <motor>: actuator: left out, for {told}");
        assert_eq!(lines(&loaded.warnings), [told]);
        assert_eq!(loaded.model.actuators, []);
        let dof = &loaded.model.joints[0].dofs[0];
        assert_eq!((dof.armature, dof.damping), (3.0, 2.0));
    }
}

/// MuJoCo's actuators are of group 0 unless they say otherwise.
#[test]
fn groups_of_actuators_without_actuators_may_be_switched_off() {
    let text = |group: &str| {
        format!(
            "<mujoco><option actuatorgroupdisable='1 3'/><worldbody><body><joint name='j'/><geom size='1'/></body>
             </worldbody><actuator><motor joint='j'/><motor joint='j' group='{group}'/></actuator></mujoco>"
        )
    };
    let loaded = read(&text("2"));
    assert_eq!(
        (loaded.model.actuators.len(), loaded.warnings.len()),
        (2, 0)
    );
    let loaded = lenient(&text("3"));
    assert_eq!(
        (loaded.model.actuators.len(), loaded.warnings.len()),
        (1, 1)
    );
}
