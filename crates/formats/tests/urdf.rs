//! A URDF robot with every kind of joint.

use glam::{DMat3, DVec3};
use kinetarium_formats::{InMemory, Loaded, Options, Warning, load, parse};
use model::{AxisKind, BodyKind, Geometry, Joint, JointKind, Model, Pose, UpAxis};
use std::path::Path;

fn arm(options: &Options) -> Loaded {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models/arm.urdf");
    load(&path, options).unwrap_or_else(|error| panic!("{error}"))
}

fn joint<'a>(model: &'a Model, name: &str) -> &'a Joint {
    model
        .joints
        .iter()
        .find(|joint| joint.name == name)
        .expect("the joint")
}

fn close(a: DVec3, b: DVec3) -> bool {
    a.abs_diff_eq(b, 1e-12)
}

#[test]
fn bodies() {
    let model = arm(&Options::default()).model;
    assert_eq!(model.up_axis, UpAxis::Z);
    assert_eq!(model.gravity, DVec3::new(0.0, 0.0, -9.81));
    let bodies: Vec<_> = model
        .bodies
        .iter()
        .map(|b| (b.name.as_str(), b.kind))
        .collect();
    let (fixed, moving) = (BodyKind::Static, BodyKind::Dynamic);
    // The camera has no mass: it became part of the upper arm.
    let expected = [
        ("world", fixed),
        ("base", fixed),
        ("upper", moving),
        ("finger", moving),
        ("disc", moving),
        ("puck", moving),
        ("drone", moving),
    ];
    assert_eq!(bodies, expected);
    assert_eq!(model.bodies[1].pose, Pose::at(DVec3::new(0.0, 0.0, 0.5)));

    // Turned by 90° about x: y becomes z.
    let upper = &model.bodies[2];
    assert_eq!(upper.mass, 2.0);
    assert_eq!(upper.center, DVec3::new(0.0, 0.0, 0.25));
    let inertia = DMat3::from_diagonal(DVec3::new(0.02, 0.04, 0.03));
    assert!(
        upper.inertia.abs_diff_eq(inertia, 1e-12),
        "{}",
        upper.inertia
    );
}

#[test]
fn revolute_and_prismatic() {
    let model = arm(&Options::default()).model;
    let shoulder = joint(&model, "shoulder");
    assert_eq!(shoulder.kind, JointKind::Revolute);
    assert_eq!(shoulder.axes[0].direction, DVec3::Y);
    let child = model.bodies[2].pose;
    assert!(close(child.position, DVec3::new(0.0, 0.0, 1.0)));
    assert!(close(child.direction(DVec3::X), DVec3::Y));
    let dof = &shoulder.dofs[0];
    assert_eq!((dof.damping, dof.friction_loss), (0.4, 0.2));
    assert_eq!(dof.drive.effort_limit, 30.0);
    let limit = dof.limit.expect("a limit");
    assert_eq!((limit.lower, limit.upper), (-1.0, 1.5));
    // Critically damped, with MuJoCo's standard time constant, 20 ms, half way down its impedance.
    let time = 0.02 * 0.95 / 0.925;
    assert!((limit.damping / limit.stiffness - 2.0 * time).abs() < 1e-12);

    let slider = joint(&model, "slider");
    assert_eq!(
        (slider.kind, slider.axes[0].kind),
        (JointKind::Prismatic, AxisKind::Linear)
    );
    assert_eq!(slider.parent.map(|id| id.0), Some(2));
    assert!(close(
        slider.parent_frame.position,
        DVec3::new(0.1, 0.0, 0.3)
    ));
    assert!(close(
        model.bodies[3].pose.position,
        DVec3::new(0.0, 0.1, 1.3)
    ));
}

#[test]
fn planar_floating_and_mimic() {
    let model = arm(&Options::default()).model;
    let table = joint(&model, "table");
    assert_eq!(table.kind, JointKind::PlaneXz);
    // The normal is z; both frames turn alike, so the puck lies as it was drawn.
    assert!(close(table.parent_frame.direction(DVec3::Y), DVec3::Z));
    assert_eq!(
        table.parent_frame.orientation,
        table.child_frame.orientation
    );
    assert_eq!(joint(&model, "flight").kind, JointKind::Free);
    assert!(close(
        model.bodies[6].pose.position,
        DVec3::new(0.0, 0.0, 3.0)
    ));
    let coupling = &model.couplings[0];
    assert_eq!(model.joints[coupling.joint.0].name, "wheel");
    assert_eq!(model.joints[coupling.other.0].name, "slider");
    assert_eq!((coupling.ratio, coupling.offset), (-3.0, 0.2));
}

#[test]
fn shapes() {
    let model = arm(&Options::default()).model;
    let [cylinder, cuboid, sphere] = &model.shapes[..] else {
        panic!("three shapes, without the visual that nobody can read")
    };
    assert_eq!(
        cylinder.geometry,
        Geometry::Cylinder {
            radius: 0.2,
            half_height: 0.5
        }
    );
    assert!(close(cylinder.pose.direction(DVec3::Y), DVec3::Z));
    assert!(cylinder.collides && cuboid.collides && !sphere.collides);
    assert_eq!(cuboid.color, None, "its link has no visual that is read");
    assert_eq!(cylinder.color, None, "its link has none");
    assert_eq!(
        cuboid.geometry,
        Geometry::Box {
            half: DVec3::new(0.05, 0.1, 0.25)
        }
    );
    assert_eq!(sphere.body.map(|id| id.0), Some(2));
    assert!(close(sphere.pose.position, DVec3::new(0.1, 0.0, 0.2)));
}

/// A visual hides what collides, and has its material's colour.
#[test]
fn a_link_looks_like_its_visuals() {
    let text = r#"<robot name="r"><material name="blue"><color rgba="0 0 1 1"/></material><link name="a">
        <collision><geometry><box size="1 1 1"/></geometry></collision>
        <visual><geometry><sphere radius="1"/></geometry><material name="blue"/></visual></link></robot>"#;
    let model = kinetarium_formats::parse(
        text,
        "robot.urdf",
        &kinetarium_formats::InMemory::default(),
        &Options::default(),
    );
    let shapes = &model.unwrap().model.shapes;
    assert_eq!(shapes[0].color, Some([0.0; 4]));
    assert_eq!(shapes[1].color, Some([0.0, 0.0, 1.0, 1.0]));
}

#[test]
fn warnings() {
    let warnings = arm(&Options::default()).warnings;
    let found: Vec<_> = warnings
        .iter()
        .map(|w: &Warning| (w.element.as_str(), w.line))
        .collect();
    let expected = [
        ("limit", 22),
        ("safety_controller", 24),
        ("mesh", 34),
        ("link", 44),
        ("transmission", 93),
        ("gazebo", 94),
    ];
    assert_eq!(found, expected);
}

/// The root has no mass, so with a floating base it takes up the base that is fixed to it.
#[test]
fn floating_base() {
    let model = arm(&Options {
        floating_base: true,
        ..Options::default()
    })
    .model;
    assert_eq!(model.bodies[0].name, "world");
    assert_eq!(
        (model.bodies[0].kind, model.bodies[0].mass),
        (BodyKind::Dynamic, 5.0)
    );
    assert_eq!(model.bodies[0].center, DVec3::new(0.0, 0.0, 0.5));
    assert_eq!(
        (model.joints[0].kind, model.joints[0].parent),
        (JointKind::Free, None)
    );
    assert_eq!(model.bodies.len(), 6);
    // Named as in MJCF: after the body.
    let free = &model.joints[0];
    assert_eq!(free.name, "world");
    let dofs: Vec<_> = free.dofs.iter().map(|dof| dof.name.as_str()).collect();
    let expected = [
        "world_0", "world_1", "world_2", "world_3", "world_4", "world_5",
    ];
    assert_eq!(dofs, expected);
}

/// A joint may have the name of the root link.
#[test]
fn a_floating_base_has_a_name_of_its_own() {
    let inertial = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";
    let text = format!(
        "<robot name='r'><link name='base'>{inertial}</link><link name='arm'>{inertial}</link>\
         <joint name='base' type='floating'><parent link='base'/><child link='arm'/></joint></robot>"
    );
    let options = Options {
        floating_base: true,
        ..Options::default()
    };
    let model = parse(&text, "r.urdf", &InMemory::default(), &options)
        .expect("a model")
        .model;
    let names: Vec<_> = model
        .joints
        .iter()
        .map(|joint| joint.name.as_str())
        .collect();
    assert_eq!(names, ["base_2", "base"]);
    assert_eq!(model.joints[0].dofs[5].name, "base_2_5");
}

/// Links without mass, and one without inertia, on a link that moves: told with places, and weighed as a whole.
#[test]
fn fused_links_are_listed_and_weigh() {
    let joint = |child: &str, kind: &str, parent: &str, origin: &str| {
        format!(
            "<joint name='to_{child}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>\
             <origin {origin}/></joint>"
        )
    };
    let inertial = |mass: &str, moment: &str| {
        format!(
            "<inertial><origin xyz='0 0 .1'/><mass value='{mass}'/>\
             <inertia ixx='{moment}' iyy='{moment}' izz='{moment}' ixy='0' ixz='0' iyz='0'/></inertial>"
        )
    };
    let text = format!(
        "<robot name='r'><link name='base'/>\n<link name='wrist'>{}</link>\n<link name='load'>{}</link>\n\
         <link name='tool0'/>{}{}{}</robot>",
        inertial("2", "0.5"),
        inertial("0.5", "0"),
        joint("wrist", "floating", "base", ""),
        joint("load", "fixed", "wrist", "xyz='.4 0 0'"),
        joint(
            "tool0",
            "fixed",
            "load",
            "xyz='0 .2 0' rpy='0 0 3.141592653589793'"
        ),
    );
    let loaded =
        parse(&text, "r.urdf", &InMemory::default(), &Options::default()).expect("a model");
    let [warning] = &loaded.warnings[..] else {
        panic!("{:?}", loaded.warnings)
    };
    assert_eq!((warning.line, warning.element.as_str()), (3, "link"));
    let listed = ": \"load\" in \"wrist\" at (0.4 0 0), (0 0 0 1); \
                  \"tool0\" in \"wrist\" at (0.4 0.2 0), (0 0 1 0) (line 4)";
    assert!(warning.message.ends_with(listed), "{warning}");
    // Two masses 0.4 m apart: the reduced mass m M/(m + M) at that distance adds to the inertia across it.
    let wrist = &loaded.model.bodies[1];
    assert_eq!((wrist.name.as_str(), wrist.mass), ("wrist", 2.5));
    assert!(close(wrist.center, DVec3::new(0.08, 0.0, 0.1)));
    let across = 0.5 + 0.4 * 0.4 * (2.0 * 0.5 / 2.5);
    let inertia = DMat3::from_diagonal(DVec3::new(0.5, across, across));
    assert!(
        wrist.inertia.abs_diff_eq(inertia, 1e-12),
        "{}",
        wrist.inertia
    );
}

#[test]
fn capsules_and_loose_geometry() {
    let text = "<robot name='r'><link name='a'><collision><geometry><capsule radius='0.1' \
                length='0.4'/></geometry></collision><visual><geometry><torus/></geometry></visual>\
                </link></robot>";
    let options = Options {
        lenient: true,
        ..Options::default()
    };
    let loaded = parse(text, "r.urdf", &InMemory::default(), &options).expect("a model");
    let [capsule] = &loaded.model.shapes[..] else {
        panic!("one shape")
    };
    assert_eq!(
        capsule.geometry,
        Geometry::Capsule {
            radius: 0.1,
            half_height: 0.30000000000000004
        }
    );
    assert_eq!(loaded.warnings.len(), 1);
}

#[test]
fn elements_of_other_programs_are_noted() {
    let text = |inner: &str| {
        format!(
            "<robot name='r' xmlns:drake='https://drake.mit.edu'><link name='a'/>{inner}</robot>"
        )
    };
    let read = |text: &str, lenient: bool| {
        let options = Options {
            lenient,
            ..Options::default()
        };
        parse(text, "r.urdf", &InMemory::default(), &options)
    };
    let known = text("<ros2_control/><sensor/><gazebo><plugin/></gazebo><extension/>");
    assert_eq!(read(&known, false).expect("a model").warnings.len(), 4);
    // Not one of URDF's own joints, whatever its name.
    let unknown = text("<drake:joint name='j' type='universal'/>");
    let error = read(&unknown, false).expect_err("an element that is not known");
    assert!(
        error
            .to_string()
            .contains("<drake:joint>: such an element in <robot>"),
        "{error}"
    );
    let warnings = read(&unknown, true).expect("a model").warnings;
    assert_eq!(
        warnings[0].to_string(),
        "r.urdf:1: <drake:joint>: such an element in <robot>: left out although it changes the physics"
    );
}

/// Under the root, which stands still or floats.
#[test]
fn mimic_of_a_fixed_joint_is_noted() {
    let mass = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";
    let link = |name: &str| format!("<link name='{name}'>{mass}</link>");
    let joint = |name: &str, kind: &str, inner: &str| {
        format!(
            "<joint name='{name}' type='{kind}'><parent link='a'/><child link='{name}'/>\n{inner}</joint>"
        )
    };
    let links = ["a", "b", "c"].map(link).concat();
    let joints = joint("b", "continuous", "") + &joint("c", "fixed", "<mimic joint='b'/>");
    let text = format!("<robot name='r'>{links}{joints}</robot>");
    for floating_base in [false, true] {
        let options = Options {
            floating_base,
            ..Options::default()
        };
        let loaded = parse(&text, "r.urdf", &InMemory::default(), &options).expect("a model");
        assert!(loaded.model.couplings.is_empty());
        let warnings: Vec<_> = loaded.warnings.iter().map(ToString::to_string).collect();
        let told =
            "r.urdf:3: <mimic>: mimic of a fixed joint: left out, for such a joint does not move";
        assert_eq!(warnings, [told]);
    }
}
