//! What is told of things that are not read.

use crate::common::{lenient, lines, read};

#[test]
fn unused_things_are_listed_once_with_their_first_line() {
    let loaded = read(
        r#"<mujoco>
             <option integrator="RK4"/>
             <worldbody>
               <light pos="0 0 3"/>
               <light pos="0 0 4"/>
               <camera mode="targetbody"/>
               <body><joint solimpfriction="0.8"/><geom size="1"/></body>
               <body><joint solimpfriction="0.9"/><geom size="1"/></body>
             </worldbody>
             <sensor><clock/></sensor>
           </mujoco>"#,
    );
    assert_eq!(
        lines(&loaded.warnings),
        [
            "robot.xml:2: <option>: attribute `integrator`: the integrator is chosen when the \
             simulation is made",
            "robot.xml:6: <camera>: cameras of mode `targetbody`: not read: cameras do not turn by themselves",
            "robot.xml:7: <joint>: attribute `solimpfriction`: dry friction is not softened",
            "robot.xml:10: <clock>: sensors of this kind: not read",
        ]
    );
}

#[test]
fn lenient_turns_missing_physics_into_warnings() {
    let loaded = lenient(
        r#"<mujoco>
             <option density="1000" viscosity="0.1"/>
             <worldbody>
               <body gravcomp="1">
                 <joint name="j" damping="1 2 3"/>
                 <geom size="0.1"/>
               </body>
             </worldbody>
             <actuator>
               <muscle tendon="t" armature="1"/>
               <motor name="kept" joint="j"/>
             </actuator>
             <keyframe><key ctrl="5 7"/></keyframe>
           </mujoco>"#,
    );
    let features: Vec<_> = loaded
        .warnings
        .iter()
        .map(|w| (w.element.as_str(), w.line))
        .collect();
    let expected = [
        ("option", 2),
        ("option", 2),
        ("body", 4),
        ("joint", 5),
        ("muscle", 10),
    ];
    assert_eq!(features, expected);
    assert_eq!(loaded.model.actuators[0].name, "kept");
    assert_eq!(loaded.model.keyframes[0].control, [7.0]);
    assert_eq!(loaded.model.joints[0].dofs[0].damping, 1.0);
}

#[test]
fn tendons_without_force_are_noted() {
    let fixed = "<tendon><fixed><joint joint='a' coef='1'/></fixed></tendon>";
    let body = "<body><joint name='a'/><geom size='1'/></body>";
    let loaded = read(&format!(
        "<mujoco><worldbody>{body}</worldbody>{fixed}</mujoco>"
    ));
    assert_eq!(
        lines(&loaded.warnings),
        ["robot.xml:1: <fixed>: tendons: exert no force; not read"]
    );
}

#[test]
fn planes_that_move_are_noted() {
    let body = |joint: &str| {
        let plane = "<geom type='plane' size='1 1 1'/>";
        let loaded = read(&format!(
            "<mujoco><worldbody>{plane}<body>{joint}<geom size='1'/>\n{plane}</body></worldbody></mujoco>"
        ));
        lines(&loaded.warnings)
    };
    let told = "robot.xml:2: <geom>: a plane of a body that moves: a half space that goes along with it; MuJoCo refuses \
                it";
    assert_eq!(body("<joint/>"), [told]);
    assert_eq!(body(""), [""; 0]);
}

#[test]
fn times_of_keyframes_are_noted() {
    let key = |key: &str| {
        let text = format!("<mujoco><keyframe>\n<key {key}/></keyframe></mujoco>");
        lines(&read(&text).warnings)
    };
    let told = "robot.xml:2: <key>: attribute `time`: simulations start at 0";
    assert_eq!(key("time='2.5'"), [told]);
    assert_eq!(key("time='0'"), [""; 0]);
}

/// A skin among the assets, and one where bodies deform.
#[test]
fn skins_are_noted() {
    for section in ["asset", "deformable"] {
        let skin = "<skin name='s' vertex='0 0 0'>\n<bone body='b'/></skin>";
        let text = format!("<mujoco><{section}>\n{skin}</{section}></mujoco>");
        let told = "robot.xml:2: <skin>: skins: only seen; not read";
        assert_eq!(lines(&read(&text).warnings), [told]);
    }
}

#[test]
fn empty_sections_say_nothing() {
    let loaded = read("<mujoco><deformable/><extension/></mujoco>");
    assert_eq!(lines(&loaded.warnings), [""; 0]);
}

#[test]
fn flexible_bodies_and_plugins_are_left_out_leniently() {
    let deformable = "<deformable><flex><contact/></flex><skin/></deformable>";
    let extension = "<extension><plugin><instance/></plugin></extension>";
    let loaded = lenient(&format!("<mujoco>{deformable}{extension}</mujoco>"));
    let elements: Vec<_> = loaded.warnings.iter().map(|w| w.element.as_str()).collect();
    assert_eq!(elements, ["skin", "flex", "plugin"]);
}
