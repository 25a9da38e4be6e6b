//! Which geoms touch, and with what surfaces.

use crate::common::{lenient, lines, read};
use glam::DVec3;
use kinetarium_formats::{InMemory, Loaded, Options, parse};
use model::{BodyId, CollisionFilter, Combine, Geometry, Model, ShapeId, Softness};

/// It replaces the surfaces of all geoms.
#[test]
fn an_override_of_contacts_is_refused() {
    let text = r#"<mujoco><option o_solref="0.1 1"><flag override="enable"/></option></mujoco>"#;
    let files = InMemory::default();
    let error = parse(text, "robot.xml", &files, &Options::default()).expect_err("another contact");
    let told = "<flag>: one surface for all contacts (flag `override`) is not supported";
    assert!(error.to_string().contains(told), "{error}");
    assert_eq!(lenient(text).warnings.len(), 2);
}

/// A pair that says the same again counts once.
#[test]
fn pairs_may_be_repeated() {
    let text = |again: &str| {
        format!(
            "<mujoco><worldbody><geom name='a' size='1'/><body><freejoint/><geom name='b' size='1'/></body></worldbody>\
             <contact><pair geom1='a' geom2='b' margin='0.1'/>\n{again}</contact></mujoco>"
        )
    };
    let once = read(&text(""));
    for again in [
        "<pair geom1='a' geom2='b' margin='.1'/>",
        "<pair name='c' geom1='b' geom2='a' margin='0.1' condim='3'/>",
    ] {
        let twice = read(&text(again));
        assert_eq!(twice.model, once.model);
        let told = "robot.xml:2: <pair>: a pair that repeats an earlier one: it counts once; MuJoCo makes each of its \
                    contacts twice, which is a little stiffer";
        assert_eq!(lines(&twice.warnings), [told]);
    }
}

#[test]
fn geoms_have_colours_friction_and_collide() {
    let model = read(
        r#"<mujoco>
             <asset><material name="red" rgba="1 0 0 1"/></asset>
             <default><geom condim="6" friction="0.7 0.02"/>
               <default class="blue"><geom rgba="0 0 1 1"/></default>
               <default class="hidden"><geom group="3"/></default>
             </default>
             <worldbody>
               <geom size="1" material="red"/>
               <geom size="1" material="red" rgba="0 1 0 0.5" contype="0" conaffinity="0"/>
               <geom type="plane" size="3 4 0.1"/>
               <geom size="1" class="blue"/>
               <geom size="1" material="red" class="hidden"/>
             </worldbody>
           </mujoco>"#,
    )
    .model;
    let [ball, ghost, plane, inherited, hidden] = &model.shapes[..] else {
        panic!("five shapes")
    };
    assert_eq!(ball.color, Some([1.0, 0.0, 0.0, 1.0]));
    assert_eq!(ghost.color, Some([0.0, 1.0, 0.0, 0.5]));
    assert_eq!(plane.color, None);
    assert_eq!(inherited.color, Some([0.0, 0.0, 1.0, 1.0]));
    assert_eq!(hidden.color.map(|c| c[3]), Some(0.0));
    assert_eq!((ball.collides, ghost.collides), (true, false));
    let m = ball.material;
    let friction = [m.friction, m.torsional_friction, m.rolling_friction];
    assert_eq!(friction, [0.7, 0.02, 0.0001]);
    assert_eq!(
        plane.geometry,
        Geometry::Plane {
            half_x: 3.0,
            half_z: 4.0
        }
    );
    assert!(plane.pose.direction(DVec3::Y).abs_diff_eq(DVec3::Z, 1e-12));
}

#[test]
fn contact_masks_are_the_shapes_kinds() {
    let model = read(
        "<mujoco><worldbody><geom size='1'/><geom size='1' contype='6' conaffinity='-1'/>\
         <geom size='1' contype='4294967295' conaffinity='0'/></worldbody></mujoco>",
    );
    assert!(model.warnings.is_empty());
    let shapes = model.model.shapes.iter();
    let masks: Vec<_> = shapes.map(|s| (s.membership, s.collides_with)).collect();
    assert_eq!(masks, [(1, 1), (6, u32::MAX), (u32::MAX, 0)]);
}

fn pairs(model: &Model) -> Vec<(usize, usize)> {
    let filter = CollisionFilter::new(model);
    filter.pairs().map(|(a, b)| (a.0, b.0)).collect()
}

/// A trunk with a limb, which has a welded thumb; all overlap.
fn limb(option: &str, contact: &str) -> Loaded {
    read(&format!(
        "<mujoco><option>{option}</option><worldbody>\
         <body name='trunk'><freejoint/><geom name='trunk' size='1'/>\
         <body name='limb'><joint/><geom name='limb' size='1' solref='0.001 1'/>\
         <body name='thumb'><geom name='thumb' size='1' solref='0.001 1'/></body></body></body>\
         </worldbody><contact>{contact}</contact></mujoco>"
    ))
}

/// Whether a softness has this time constant at the end of MuJoCo's standard impedance.
#[track_caller]
fn assert_time(softness: Softness, expected: f64) {
    let Softness::Time {
        constant,
        ratio,
        impedance,
        ..
    } = softness
    else {
        panic!("{softness:?}")
    };
    assert!((constant * impedance / 0.95 - expected).abs() < 1e-15 && ratio == 1.0);
    assert!((0.9..=0.95).contains(&impedance), "{impedance}");
}

#[test]
fn flags_let_parents_touch_and_contacts_be_stiff() {
    assert_eq!(pairs(&limb("", "").model), []);
    let open = limb("<flag filterparent='disable' refsafe='disable'/>", "").model;
    assert_eq!(pairs(&open), [(0, 1), (0, 2)]);
    assert_time(open.shapes[1].material.softness, 0.001);
    let safe = limb("", "").model;
    assert_time(safe.shapes[1].material.softness, 2.0 * 0.002);
}

#[test]
fn pairs_touch_in_spite_of_joints_unless_contacts_are_off() {
    let pair = "<pair geom1='thumb' geom2='trunk' friction='0.2 0.2'/>";
    let model = limb("", pair).model;
    assert_eq!(pairs(&model), [(0, 2)]);
    let material = model.contact_material(ShapeId(0), ShapeId(2));
    assert_eq!((material.friction, material.torsional_friction), (0.2, 0.0));
    assert_time(material.softness, 0.02);
    let off = limb("<flag contact='disable'/>", pair).model;
    assert_eq!(pairs(&off), []);
    let still = limb("", "<pair geom1='thumb' geom2='thumb'/>");
    assert_eq!(
        lines(&still.warnings),
        ["robot.xml:1: <pair>: pair: left out, for its geoms never move against each other"]
    );
}

/// The mount is massless, and fused with the trunk.
#[test]
fn exclusions_of_fused_bodies_are_those_of_what_they_are_fused_with() {
    let model = read(
        "<mujoco><worldbody>\
         <body name='other'><freejoint/><geom size='1'/></body>\
         <body name='trunk'><freejoint/><geom size='1'/>\
         <body name='mount'><geom size='1' mass='0'/>\
         <body name='limb'><joint/><geom size='1'/></body></body></body>\
         </worldbody><contact><exclude body1='mount' body2='other'/>\
         <exclude body1='trunk' body2='mount'/></contact></mujoco>",
    )
    .model;
    assert_eq!(model.bodies.len(), 3);
    assert!(model.exclusions.contains(&(Some(BodyId(1)), BodyId(0))));
    assert_eq!(pairs(&model), [(0, 3)]);
}

#[test]
fn stiffness_and_damping_of_contacts_are_time_and_ratio() {
    let text = "<geom size='1' solref='-400 -20' solimp='0.6 0.6 0.01'/>";
    let model = read(&format!("<mujoco><worldbody>{text}</worldbody></mujoco>"));
    assert!(model.warnings.is_empty());
    let material = model.model.shapes[0].material;
    assert_eq!(material.combine, Combine::Maximum);
    assert_eq!(
        material.softness,
        Softness::Time {
            constant: 0.1,
            ratio: 0.5,
            impedance: 0.6,
            mass: None,
        }
    );
}

#[test]
fn materials_of_bodies_of_any_mass_mix_as_in_mujoco() {
    let ball = |mass: f64| format!("<body><freejoint/><geom size='1' mass='{mass}'/></body>");
    let balls: String = [0.1, 2.0, 30.0].map(ball).concat();
    let floor = "<geom type='plane' size='1 1 1'/>";
    let model = read(&format!(
        "<mujoco><worldbody>{floor}{balls}</worldbody></mujoco>"
    ))
    .model;
    assert_eq!(pairs(&model).len(), 6);
    assert!(model.contact_pairs.is_empty());
}

/// Where `condim` or `priority` mix a surface, it has the friction that its geoms are given later.
#[test]
fn mixed_surfaces_follow_the_friction_of_their_geoms() {
    let ball = |surface: &str| format!("<body><freejoint/><geom size='1' {surface}/></body>");
    let smooth = ball("condim='1' friction='0.9' solref='0.05 1'");
    let first = ball("priority='1' friction='0.3' solref='0.05 1'");
    let floor = "<geom type='plane' size='1 1 1' friction='0.7'/>";
    let model = read(&format!(
        "<mujoco><worldbody>{floor}{smooth}{smooth}{first}</worldbody></mujoco>"
    ))
    .model;
    let mixed = |model: &Model| {
        let shapes = [(0, 1), (1, 2), (0, 3), (1, 3)];
        shapes.map(|(a, b)| model.contact_material(ShapeId(a), ShapeId(b)).friction)
    };
    assert!(!model.contact_pairs.is_empty());
    assert_eq!(mixed(&model), [0.9, 0.0, 0.3, 0.3]);
    let mut parts = model.into_parts();
    for (shape, friction) in parts.shapes.iter_mut().zip([0.1, 0.05, 0.05, 0.2]) {
        shape.material.friction = friction;
        shape.material.restitution = 0.5;
    }
    let model = Model::new(parts).unwrap();
    assert_eq!(mixed(&model), [0.1, 0.0, 0.2, 0.2]);
    let bounces = |pair: &model::ContactPair| pair.material.restitution == 0.5;
    assert!(model.contact_pairs.iter().all(bounces));
}

/// Geoms whose surface is mixed touch no more than others once they are told apart, unless `<pair>` names them.
#[test]
fn mixed_surfaces_leave_masks_and_exclusions_in_force() {
    let ball = |name: &str| {
        format!("<body name='{name}'><freejoint/><geom name='{name}' size='1' condim='1'/></body>")
    };
    let balls: String = ["a", "b", "c"].map(ball).concat();
    let named = "<contact><pair geom1='b' geom2='c' condim='1'/></contact>";
    let floor = "<geom type='plane' size='1 1 1'/>";
    let text = format!("<mujoco><worldbody>{floor}{balls}</worldbody>{named}</mujoco>");
    let model = read(&text).model;
    assert_eq!(pairs(&model).len(), 6);
    let mut parts = model.into_parts();
    for shape in &mut parts.shapes[1..] {
        (shape.membership, shape.collides_with) = (2, 1);
    }
    parts.exclusions = vec![(None, BodyId(0))];
    let apart = Model::new(parts).unwrap();
    assert_eq!(pairs(&apart), [(0, 2), (0, 3), (2, 3)]);
}

/// A ball of 2 kg: a pyramid's edges make its contact p = μ² (1 + μ²) / (i (c − 1)) times as soft, a cone's do not.
#[test]
fn pyramids_of_friction_soften_contacts() {
    let mass = |option: &str, surface: &str| {
        let ball = format!("<geom size='1' mass='2' {surface}/>");
        let loaded = read(&format!(
            "<mujoco><option {option}/><worldbody><body><freejoint/>{ball}</body></worldbody></mujoco>"
        ));
        assert!(loaded.warnings.is_empty());
        match loaded.model.shapes[0].material.softness {
            Softness::Time { mass, .. } => mass.expect("a mass of its own"),
            spring @ Softness::Spring { .. } => panic!("{spring:?}"),
        }
    };
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12 * expected);
    near(mass("", ""), 2.0);
    near(mass("", "friction='2'"), 2.0 / 10.0);
    near(mass("", "friction='2' condim='6'"), 2.0 / 4.0);
    near(mass("", "friction='2' condim='1'"), 2.0);
    near(mass("", "friction='0'"), 2.0 / 1e-3);
    near(mass("impratio='5'", "friction='2'"), 2.0 / 2.0);
    near(mass("cone='elliptic'", "friction='2'"), 2.0);
}
