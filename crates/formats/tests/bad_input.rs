//! Malformed and unsupported files: each is refused with the file, the line and the remedy.

use kinetarium_formats::{InMemory, Options, parse};

/// The error of reading a text called `robot.xml`, as the user sees it.
fn error(text: &str) -> String {
    let files = InMemory::new([
        (
            "part.xml",
            "<mujoco><worldbody><body/></worldbody></mujoco>",
        ),
        ("empty.xml", "<mujoco/>"),
        ("broken.xml", "<mujoco>\n<worldbody>\n</mujoco>"),
        (
            "circle.xml",
            "<mujoco><include file=\"circle.xml\"/></mujoco>",
        ),
    ]);
    match parse(text, "robot.xml", &files, &Options::default()) {
        Ok(_) => panic!("read without an error: {text}"),
        Err(error) => error.to_string(),
    }
}

fn check(cases: &[(&str, &str)]) {
    let mut wrong = Vec::new();
    for (text, expected) in cases {
        let error = error(text);
        if error != *expected {
            wrong.push(format!("in   {text}\ngot  {error}\nnot  {expected}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn not_xml() {
    check(XML);
}

#[test]
fn wrong_mjcf() {
    check(MJCF);
}

#[test]
fn unsupported_mjcf() {
    check(UNSUPPORTED);
}

#[test]
fn wrong_urdf() {
    check(URDF);
}

const XML: &[(&str, &str)] = &[
    (
        "",
        "robot.xml:1:1: not well-formed XML (the document does not have a root node); correct the text there",
    ),
    (
        "hello",
        "robot.xml:1:1: not well-formed XML (unknown token); correct the text there",
    ),
    (
        "<mujoco>",
        "robot.xml:1:9: not well-formed XML (the root node was opened but never closed); correct the text there",
    ),
    (
        "<mujoco>\n  <worldbody>\n</mujoco>",
        "robot.xml:3:1: not well-formed XML (expected 'worldbody' tag, not 'mujoco'); correct the text there",
    ),
    (
        "<mujoco a=\"1\" a=\"2\"/>",
        "robot.xml:1:15: not well-formed XML (attribute 'a' at 1:15 is already defined); correct the text there",
    ),
    (
        "<!DOCTYPE x [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;\">]>\n<mujoco>&b;</mujoco>",
        "robot.xml:1:1: <!DOCTYPE>: document type definitions are not read; remove the line",
    ),
    (
        "<?xml version=\"1.0\"?>\n <!DOCTYPE mujoco>\n<mujoco/>",
        "robot.xml:2:2: <!DOCTYPE>: document type definitions are not read; remove the line",
    ),
    (
        "<?x <!DOCTYPE?><!--> no <!DOCTYPE -->\n<!-- -->\n  <!DOCTYPE mujoco>\n<mujoco/>",
        "robot.xml:3:3: <!DOCTYPE>: document type definitions are not read; remove the line",
    ),
    (
        "\u{feff}<!DOCTYPE mujoco>\n<mujoco/>",
        "robot.xml:1:2: <!DOCTYPE>: document type definitions are not read; remove the line",
    ),
    (
        "<sdf/>",
        "robot.xml:1:1: <sdf>: the root element names no known format; MJCF files start with <mujoco>, URDF files with <robot>",
    ),
    (
        "<mujoco>\n<worldbody>\n<geom size=\"1",
        "robot.xml:3:14: not well-formed XML (unexpected end of stream); correct the text there",
    ),
];

const MJCF: &[(&str, &str)] = &[
    (
        "<mujoco><worldbody><geom size=\"1\" contype=\"4294967296\"/></worldbody></mujoco>",
        "robot.xml:1:35: <geom>: attribute `contype` is 4294967296, which has more than 32 bits; write a number from -2147483648 to 4294967295",
    ),
    (
        "<mujoco><worldbody><geom size=\"1\" conaffinity=\"-2147483649\"/></worldbody></mujoco>",
        "robot.xml:1:35: <geom>: attribute `conaffinity` is -2147483649, which has more than 32 bits; write a number from -2147483648 to 4294967295",
    ),
    (
        "<mujoco><worldbody><geom size=\"1\" condim=\"2\"/></worldbody></mujoco>",
        "robot.xml:1:35: <geom>: attribute `condim` is 2; write 1, 3, 4 or 6",
    ),
    (
        "<mujoco><worldbody><geom size=\"1\" solref=\"0.1 -1\"/></worldbody></mujoco>",
        "robot.xml:1:35: <geom>: attribute `solref` has a positive number and one that is not; write time constant and damping ratio, both positive, or −stiffness and −damping",
    ),
    (
        "<mujoco><contact><touch/></contact></mujoco>",
        "robot.xml:1:18: <touch>: contact holds no such element; remove it",
    ),
    (
        "<mujoco><contact><exclude body1=\"world\" body2=\"hand\"/></contact></mujoco>",
        "robot.xml:1:41: <exclude>: attribute `body2` names `hand`, but no body has this name; correct the name",
    ),
    (
        "<mujoco><contact><exclude body1=\"world\"/></contact></mujoco>",
        "robot.xml:1:18: <exclude>: attribute `body2` is missing; write body2=\"…\"",
    ),
    (
        "<mujoco><contact><pair geom1=\"palm\"/></contact></mujoco>",
        "robot.xml:1:24: <pair>: attribute `geom1` names `palm`, but no geom has this name; correct the name",
    ),
    (
        "<mujoco><worldbody><geom name=\"a\" size=\"1\"/><body><freejoint/><geom name=\"b\" size=\"1\"/></body></worldbody>\
         <contact><pair geom1=\"a\" geom2=\"b\"/>\n<pair geom1=\"b\" geom2=\"a\" margin=\"1\"/></contact></mujoco>",
        "robot.xml:2:1: <pair>: an earlier pair of the same geoms says otherwise; keep one of them",
    ),
    (
        "<mujoco>\n<wordlbody/>\n</mujoco>",
        "robot.xml:2:1: <wordlbody>: `wordlbody` is no section of a MuJoCo file; correct its spelling, or remove it",
    ),
    (
        "<mujoco><compiler coordinate=\"global\"/></mujoco>",
        "robot.xml:1:19: <compiler>: attribute `coordinate` is `global`, which MuJoCo no longer reads either; write the file in local coordinates: load it once with MuJoCo 2.3.3 or older and save it",
    ),
    (
        "<mujoco><compiler angle=\"grad\"/></mujoco>",
        "robot.xml:1:19: <compiler>: attribute `angle` is `grad`; write one of: degree, radian",
    ),
    (
        "<mujoco><compiler eulerseq=\"xq\"/></mujoco>",
        "robot.xml:1:19: <compiler>: attribute `eulerseq` is `xq`; write three letters of x, y, z (axes that turn along) or X, Y, Z (axes that stay)",
    ),
    (
        "<mujoco><option impratio=\"0\"/></mujoco>",
        "robot.xml:1:17: <option>: attribute `impratio` is 0; write a positive number such as 1",
    ),
    (
        "<mujoco><option timestep=\"0\"/></mujoco>",
        "robot.xml:1:17: <option>: attribute `timestep` is 0; write a positive number of seconds such as 0.002",
    ),
    (
        "<mujoco><option gravity=\"0 0 nan\"/></mujoco>",
        "robot.xml:1:17: <option>: attribute `gravity` holds `nan`, which is not a finite number; write numbers such as 1, -0.5 or 2e-3, separated by blanks",
    ),
    (
        "<mujoco><option gravity=\"0 -9.81\"/></mujoco>",
        "robot.xml:1:17: <option>: attribute `gravity` holds 2 numbers; write 3, separated by blanks",
    ),
    (
        "<mujoco><option><flag gravity=\"off\"/></option></mujoco>",
        "robot.xml:1:23: <flag>: attribute `gravity` is `off`; write one of: enable, disable",
    ),
    (
        "<mujoco><include file=\"none.xml\"/></mujoco>",
        "robot.xml:1:18: <include>: attribute `file` names `none.xml`, which cannot be read (entity not found); give its path relative to the folder of the main file, or of the one that includes it",
    ),
    (
        "<mujoco><include file=\".\"/></mujoco>",
        "robot.xml:1:18: <include>: attribute `file` names `.`, which cannot be read (entity not found); give its path relative to the folder of the main file, or of the one that includes it",
    ),
    (
        "<mujoco><include/></mujoco>",
        "robot.xml:1:9: <include>: attribute `file` is missing; write file=\"…\"",
    ),
    (
        "<mujoco><include file=\"empty.xml\"/></mujoco>",
        "empty.xml:1:1: <mujoco>: the included file is empty; remove the include",
    ),
    (
        "<mujoco><include file=\"part.xml\"/>\n<include file=\"part.xml\"/></mujoco>",
        "robot.xml:2:10: <include>: attribute `file` names `part.xml`, which is already part of the model; include each file once, and no file from within itself",
    ),
    (
        "<mujoco><include file=\"part.xml\"/>\n<include file=\"./part.xml\"/></mujoco>",
        "robot.xml:2:10: <include>: attribute `file` names `./part.xml`, which is already part of the model; include each file once, and no file from within itself",
    ),
    (
        "<mujoco><include file=\"circle.xml\"/></mujoco>",
        "circle.xml:1:18: <include>: attribute `file` names `circle.xml`, which is already part of the model; include each file once, and no file from within itself",
    ),
    (
        "<mujoco><include file=\"robot.xml\"/></mujoco>",
        "robot.xml:1:18: <include>: attribute `file` names `robot.xml`, which is already part of the model; include each file once, and no file from within itself",
    ),
    (
        "<mujoco><include file=\"broken.xml\"/></mujoco>",
        "broken.xml:3:1: not well-formed XML (expected 'worldbody' tag, not 'mujoco'); correct the text there",
    ),
    (
        "<mujoco><default><default><geom/></default></default></mujoco>",
        "robot.xml:1:18: <default>: attribute `class` is missing; write class=\"…\"",
    ),
    (
        "<mujoco><default><default class=\"a\"/>\n<default class=\"a\"/></default></mujoco>",
        "robot.xml:2:10: <default>: attribute `class` is `a`, the name of another class; rename one of them",
    ),
    (
        "<mujoco><worldbody>\n<geom size=\"1\" class=\"none\"/></worldbody></mujoco>",
        "robot.xml:2:16: <geom>: attribute `class` names the default class `none`, which does not exist; define it in <default>, or correct the name",
    ),
    (
        "<mujoco><worldbody>\n<body childclass=\"none\"/></worldbody></mujoco>",
        "robot.xml:2:7: <body>: attribute `childclass` names the default class `none`, which does not exist; define it in <default>, or correct the name",
    ),
    (
        "<mujoco><worldbody><joint/></worldbody></mujoco>",
        "robot.xml:1:20: <joint>: the world does not move and has no mass; put this into a body",
    ),
    (
        "<mujoco><worldbody><body><jiont/></body></worldbody></mujoco>",
        "robot.xml:1:26: <jiont>: a body holds no such element; remove it",
    ),
    (
        "<mujoco><worldbody><body>\n<freejoint/></body></worldbody></mujoco>",
        "robot.xml:1:20: <body>: the body moves but has no mass; give it an inertial element or solid shapes with density, or fix it to a body with mass",
    ),
    (
        "<mujoco><worldbody><body><freejoint/><geom size=\"1\"/>\n<body><freejoint/><geom size=\"1\"/>\
         </body></body></worldbody></mujoco>",
        "robot.xml:2:7: <freejoint>: a free joint is only for children of the world; move the body out of its parent, or use other joints",
    ),
    (
        "<mujoco><worldbody><body><freejoint/><joint/><geom size=\"1\"/></body></worldbody></mujoco>",
        "robot.xml:1:20: <body>: it has a free joint and other joints; remove the others: a free joint already moves in every way",
    ),
    (
        "<mujoco><worldbody><body><joint type=\"ball\"/><joint type=\"slide\"/><geom size=\"1\"/>\
         </body></worldbody></mujoco>",
        "robot.xml:1:20: <body>: it has a ball joint and other joints, which this engine does not stack; put the others on a body of small mass between this one and its parent, or use hinges",
    ),
    (
        "<mujoco><worldbody><body mocap=\"true\"><frame><freejoint/></frame><geom size=\"1\"/></body></worldbody></mujoco>",
        "robot.xml:1:26: <body>: attribute `mocap` is for bodies without joints; remove its joints, or `mocap`",
    ),
    (
        "<mujoco><worldbody><body><body mocap=\"true\"/></body></worldbody></mujoco>",
        "robot.xml:1:32: <body>: attribute `mocap` is for children of the world; move the body to the world",
    ),
    (
        "<mujoco><worldbody><body><joint/><joint/><joint/><joint/><geom size=\"1\"/></body>\
         </worldbody></mujoco>",
        "robot.xml:1:20: <body>: it has 0 slides and 4 hinges, more than 3 of a kind; put some of them on a body of small mass between this one and its parent",
    ),
    (
        "<mujoco><worldbody><body>\n<joint axis=\"0 0 0\"/><geom size=\"1\"/></body></worldbody></mujoco>",
        "robot.xml:2:8: <joint>: attribute `axis` has no direction; write a vector that is not zero",
    ),
    (
        "<mujoco><worldbody><body><joint range=\"2 1\"/><geom size=\"1\"/></body></worldbody></mujoco>",
        "robot.xml:1:33: <joint>: attribute `range` has its lower end 2 above its upper end 1; swap them",
    ),
    (
        "<mujoco><worldbody><body><joint limited=\"true\"/><geom size=\"1\"/></body></worldbody></mujoco>",
        "robot.xml:1:33: <joint>: attribute `limited` is true, but there is no `range`; write range=\"lower upper\"",
    ),
    (
        "<mujoco><worldbody><body><joint limited=\"true\" range=\"0 0\"/><geom size=\"1\"/></body></worldbody></mujoco>",
        "robot.xml:1:33: <joint>: attribute `limited` is true, but `range` is 0 0; write range=\"lower upper\"",
    ),
    (
        "<mujoco><compiler autolimits=\"false\"/><worldbody><body><joint range=\"0 1\"/>\
         <geom size=\"1\"/></body></worldbody></mujoco>",
        "robot.xml:1:63: <joint>: attribute `range` is given without `limited`, while the compiler's autolimits is false; write limited=\"true\" or limited=\"false\"",
    ),
    (
        "<mujoco><worldbody><body><joint damping=\"-1\"/><geom size=\"1\"/></body></worldbody></mujoco>",
        "robot.xml:1:33: <joint>: attribute `damping` is -1, below zero; write zero or a positive number",
    ),
    (
        "<mujoco><worldbody><body><joint solreflimit=\"0.1 -1\"/><geom size=\"1\"/></body>\
         </worldbody></mujoco>",
        "robot.xml:1:33: <joint>: attribute `solreflimit` has a positive number and one that is not; write time constant and damping ratio, both positive, or −stiffness and −damping",
    ),
    (
        "<mujoco><worldbody><body><joint range=\"0 1\" margin=\"3\"/><geom size=\"1\"/></body>\
         </worldbody></mujoco>",
        "robot.xml:1:45: <joint>: attribute `margin` leaves nothing of the range; write a margin below half the range",
    ),
    (
        "<mujoco><worldbody><body name=\"a\"/>\n<body name=\"a\"/></worldbody></mujoco>",
        "robot.xml:2:7: <body>: attribute `name` is `a`, the name of another body; rename one of them",
    ),
    (
        "<mujoco><worldbody><body><joint name=\"j\"/><geom size=\"1\"/></body>\n<body>\
         <joint name=\"j\"/><geom size=\"1\"/></body></worldbody></mujoco>",
        "robot.xml:2:14: <joint>: attribute `name` is `j`, the name of another joint; rename one of them",
    ),
    (
        "<mujoco><worldbody><geom name=\"a\" size=\"1\"/>\n<body><geom name=\"a\" size=\"1\"/></body></worldbody></mujoco>",
        "robot.xml:2:13: <geom>: attribute `name` is `a`, the name of another geom; rename one of them",
    ),
    (
        "<mujoco><worldbody><site name=\"a\"/>\n<site name=\"a\"/></worldbody></mujoco>",
        "robot.xml:2:7: <site>: attribute `name` is `a`, the name of another site; rename one of them",
    ),
    (
        "<mujoco><asset><mesh file=\"seen/a.obj\"/>\n<mesh file=\"a.stl\"/></asset></mujoco>",
        "robot.xml:2:1: <mesh>: it is called `a` after its file, as another mesh is; give one of them a name",
    ),
    (
        "<mujoco><asset><mesh file=\"a.obj\"/>\n<mesh name=\"a\" file=\"b.obj\"/></asset></mujoco>",
        "robot.xml:2:7: <mesh>: attribute `name` is `a`, the name of another mesh; rename one of them",
    ),
    (
        "<mujoco><asset><hfield name=\"a\"/>\n<hfield name=\"a\"/></asset></mujoco>",
        "robot.xml:2:9: <hfield>: attribute `name` is `a`, the name of another height field; rename one of them",
    ),
    (
        "<mujoco><worldbody><site fromto=\"0 0 0 1 1 1\"/></worldbody></mujoco>",
        "robot.xml:1:26: <site>: attribute `fromto` is given for a sphere; use it with capsule, cylinder, box or ellipsoid; otherwise give pos and size",
    ),
    (
        "<mujoco><worldbody><geom type=\"cone\"/></worldbody></mujoco>",
        "robot.xml:1:26: <geom>: attribute `type` is `cone`; write one of: plane, hfield, sphere, capsule, ellipsoid, cylinder, box, mesh, sdf",
    ),
    (
        "<mujoco><worldbody><geom type=\"box\" size=\"1 2\"/></worldbody></mujoco>",
        "robot.xml:1:37: <geom>: attribute `size` holds 2 numbers; write size=\"half-x half-y half-z\" with positive numbers for a box",
    ),
    (
        "<mujoco><worldbody><geom size=\"-1\"/></worldbody></mujoco>",
        "robot.xml:1:26: <geom>: attribute `size` holds -1; write size=\"radius\" with positive numbers for a sphere",
    ),
    (
        "<mujoco><worldbody><geom/></worldbody></mujoco>",
        "robot.xml:1:20: <geom>: attribute `size` holds 0 numbers; write size=\"radius\" with positive numbers for a sphere",
    ),
    (
        "<mujoco><worldbody><geom type=\"sphere\" size=\"1\" fromto=\"0 0 0 1 1 1\"/></worldbody></mujoco>",
        "robot.xml:1:49: <geom>: attribute `fromto` is given for a sphere; use it with capsule, cylinder, box or ellipsoid; otherwise give pos and size",
    ),
    (
        "<mujoco><worldbody><geom type=\"capsule\" size=\"1\" fromto=\"0 0 1 0 0 1\"/></worldbody></mujoco>",
        "robot.xml:1:50: <geom>: attribute `fromto` joins a point to itself; give two different points",
    ),
    (
        "<mujoco><worldbody><geom size=\"1\" quat=\"1 0 0 0\" euler=\"0 0 0\"/></worldbody></mujoco>",
        "robot.xml:1:50: <geom>: attribute `euler` gives an orientation, and so does `quat`; keep one of them",
    ),
    (
        "<mujoco><worldbody><geom size=\"1\" quat=\"0 0 0 0\"/></worldbody></mujoco>",
        "robot.xml:1:35: <geom>: attribute `quat` is a quaternion of length zero; write 1 0 0 0 for no rotation",
    ),
    (
        "<mujoco><worldbody><geom size=\"1\" xyaxes=\"1 0 0 2 0 0\"/></worldbody></mujoco>",
        "robot.xml:1:35: <geom>: attribute `xyaxes` has no direction; write a vector that is not zero",
    ),
    (
        "<mujoco><worldbody><geom type=\"mesh\" mesh=\"m\"/></worldbody></mujoco>",
        "robot.xml:1:38: <geom>: attribute `mesh` names `m`, which is no mesh asset; define it in <asset>, or correct the name",
    ),
    (
        "<mujoco><worldbody><body><inertial pos=\"0 0 0\" mass=\"1\"/></body></worldbody></mujoco>",
        "robot.xml:1:26: <inertial>: neither `diaginertia` nor `fullinertia` is given; write diaginertia=\"Ixx Iyy Izz\" [kg·m²]",
    ),
    (
        "<mujoco><worldbody><body><inertial mass=\"1\" diaginertia=\"1 1 1\"/></body></worldbody></mujoco>",
        "robot.xml:1:26: <inertial>: attribute `pos` is missing; write pos=\"…\"",
    ),
    (
        "<mujoco><worldbody><body><inertial pos=\"0 0 0\" mass=\"-1\" diaginertia=\"1 1 1\"/></body>\
         </worldbody></mujoco>",
        "robot.xml:1:48: <inertial>: attribute `mass` is -1, below zero; write zero or a positive number",
    ),
    (
        "<mujoco><worldbody><body>\n<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 3\"/></body>\
         </worldbody></mujoco>",
        "robot.xml:1:20: <body>: its principal moments of inertia 1, 1, 3 belong to no solid: the largest exceeds the sum of the others; correct them, or set balanceinertia=\"true\" in <compiler>",
    ),
    (
        "<mujoco><worldbody><body><inertial pos=\"0 0 0\" mass=\"1\" fullinertia=\"1 1 1 0 0 5\"/>\
         </body></worldbody></mujoco>",
        "robot.xml:1:20: <body>: its inertia has the negative principal moment -3.999999999999999; correct the inertia; its matrix must be positive definite",
    ),
    (
        "<mujoco><actuator>\n<motor joint=\"none\"/></actuator></mujoco>",
        "robot.xml:2:8: <motor>: attribute `joint` names `none`, but no joint has this name; correct the name",
    ),
    (
        "<mujoco><actuator><motor/></actuator></mujoco>",
        "robot.xml:1:19: <motor>: attribute `joint` is missing; write joint=\"…\"",
    ),
    (
        "<mujoco><actuator><moter/></actuator></mujoco>",
        "robot.xml:1:19: <moter>: this is no actuator; correct its spelling",
    ),
    (
        "<mujoco><actuator><position joint=\"j\" ctrlrange=\"0 1\" inheritrange=\"1\"/></actuator></mujoco>",
        "robot.xml:1:55: <position>: attribute `inheritrange` stands beside `ctrlrange`; keep one of them",
    ),
    (
        "<mujoco><equality><weld body1=\"none\"/></equality></mujoco>",
        "robot.xml:1:25: <weld>: attribute `body1` names `none`, but no body has this name; correct the name",
    ),
    (
        "<mujoco><equality><connect site1=\"a\" site2=\"b\"/></equality></mujoco>",
        "robot.xml:1:28: <connect>: attribute `site1` names `a`, but no site has this name; correct the name",
    ),
    (
        "<mujoco><keyframe><key qpos=\"1 2\"/></keyframe></mujoco>",
        "robot.xml:1:24: <key>: attribute `qpos` holds 2 numbers; write 0, separated by blanks",
    ),
    (
        "<mujoco><keyframe><frame/></keyframe></mujoco>",
        "robot.xml:1:19: <frame>: a keyframe section holds keys only; write <key …/>",
    ),
    (
        "<mujoco><worldbody><body><joint>\n<geom size=\"1\"/></joint></body></worldbody></mujoco>",
        "robot.xml:2:1: <geom>: <joint> holds no such element; correct its spelling, or put it where it belongs",
    ),
    (
        "<mujoco><worldbody><body><frame><body><geom><geom/></geom></body></frame></body></worldbody></mujoco>",
        "robot.xml:1:45: <geom>: <geom> holds no such element; correct its spelling, or put it where it belongs",
    ),
    (
        "<mujoco><default><geom><joint/></geom></default></mujoco>",
        "robot.xml:1:24: <joint>: <geom> holds no such element; correct its spelling, or put it where it belongs",
    ),
    (
        "<mujoco><visual><mop/></visual></mujoco>",
        "robot.xml:1:17: <mop>: <visual> holds no such element; correct its spelling, or put it where it belongs",
    ),
    (
        "<mujoco><deformable><skni/></deformable></mujoco>",
        "robot.xml:1:21: <skni>: <deformable> holds no such element; correct its spelling, or put it where it belongs",
    ),
    (
        "<mujoco><extension><plugn/></extension></mujoco>",
        "robot.xml:1:20: <plugn>: <extension> holds no such element; correct its spelling, or put it where it belongs",
    ),
    (
        "<mujoco><tendon><fixed><site site=\"a\"/></fixed></tendon></mujoco>",
        "robot.xml:1:24: <site>: <fixed> holds no such element; correct its spelling, or put it where it belongs",
    ),
    (
        "<mujoco><default><default class=\"a\">\n<jiont damping=\"1\"/></default></default></mujoco>",
        "robot.xml:2:1: <jiont>: a default class holds no such element; correct its spelling, or remove it",
    ),
    (
        "<mujoco><worldbody><body><joint name=\"j\"/><geom size=\"1\"/></body></worldbody><tendon><fixed>\n<joint joint=\"k\" coef=\"1\"/></fixed></tendon></mujoco>",
        "robot.xml:2:8: <joint>: attribute `joint` names `k`, but no joint has this name; correct the name",
    ),
    (
        "<mujoco><worldbody><body><freejoint name=\"j\"/><geom size=\"1\"/></body></worldbody><tendon><fixed><joint joint=\"j\" coef=\"1\"/></fixed></tendon></mujoco>",
        "robot.xml:1:104: <joint>: attribute `joint` names a ball or free joint; name a hinge or a slide",
    ),
    (
        "<mujoco><tendon><spatial><site site=\"a\"/></spatial></tendon></mujoco>",
        "robot.xml:1:32: <site>: attribute `site` names `a`, but no site has this name; correct the name",
    ),
    (
        "<mujoco><worldbody><geom size=\"1\" friction=\"1 -2\"/></worldbody></mujoco>",
        "robot.xml:1:35: <geom>: attribute `friction` holds -2, below zero; write zero or positive numbers",
    ),
    (
        "<mujoco><worldbody><geom size=\"1\" solref=\"0 1\"/></worldbody></mujoco>",
        "robot.xml:1:35: <geom>: attribute `solref` has a positive number and one that is not; write time constant and damping ratio, both positive, or −stiffness and −damping",
    ),
    (
        "<mujoco><worldbody><body><freejoint/>\n<geom size=\"1\"/></body>\n <body name=\"flat\"><freejoint/><inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"0 0 0\"/></body></worldbody></mujoco>",
        "robot.xml:3:2: body \"flat\": its smallest principal moment of inertia is 0 kg·m², but all three must be above zero; check the signs and units",
    ),
    (
        "<mujoco><worldbody>\n<body><joint/><geom size=\"1e200\"/></body></worldbody></mujoco>",
        "robot.xml:2:1: body \"body_1\": mass [kg] is inf; give a finite number",
    ),
    (
        "<mujoco><worldbody><geom type=\"capsule\" size=\"1\" pos=\"0 0 1\" fromto=\"0 0 0 0 0 1\"/></worldbody></mujoco>",
        "robot.xml:1:50: <geom>: attribute `pos` stands beside `fromto`; keep one of them",
    ),
    (
        "<mujoco><worldbody><body><joint springdamper=\"0 1\"/><geom size=\"1\"/></body></worldbody></mujoco>",
        "robot.xml:1:33: <joint>: attribute `springdamper` has a number that is not positive; write a time constant and a damping ratio, or 0 0 for none",
    ),
    (
        "<mujoco><option integrator=\"RK5\"/></mujoco>",
        "robot.xml:1:17: <option>: attribute `integrator` is `RK5`; write one of: Euler, RK4, implicit, implicitfast, discrete",
    ),
    (
        "<mujoco><option solver=\"newton\"/></mujoco>",
        "robot.xml:1:17: <option>: attribute `solver` is `newton`; write one of: PGS, CG, Newton",
    ),
    (
        "<mujoco><option actuatorgroupdisable=\"1 40\"/></mujoco>",
        "robot.xml:1:17: <option>: attribute `actuatorgroupdisable` holds 40; write whole numbers from 0 to 30",
    ),
];

const UNSUPPORTED: &[(&str, &str)] = &[
    (
        "<mujoco><worldbody><body><joint springdamper=\"1 1\" damping=\"0 2\"/><geom size=\"1\"/></body></worldbody></mujoco>",
        "robot.xml:1:26: <joint>: nonlinear damping is not supported, and leaving it out would change the physics; keep its first coefficient only, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><worldbody><geom size=\"1\" solref=\"-100 0\"/></worldbody></mujoco>",
        "robot.xml:1:20: <geom>: a contact without spring or damper is not supported, and leaving it out would change the physics; write a solref whose numbers are both positive, or both negative, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><worldbody><geom name=\"a\" size=\"1\"/><body><freejoint/><geom name=\"b\" size=\"1\"/></body></worldbody>\
         <contact><pair geom1=\"a\" geom2=\"b\" friction=\"0.5\"/></contact></mujoco>",
        "robot.xml:1:116: <pair>: friction that differs by direction is not supported, and leaving it out would change the physics; write the same coefficient for both directions, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco>\n<option density=\"1.2\"/></mujoco>",
        "robot.xml:2:1: <option>: drag by a fluid (`density`) is not supported, and leaving it out would change the physics; set density and viscosity to 0 for a simulation in vacuum, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><deformable>\n<flex name=\"cloth\"/></deformable></mujoco>",
        "robot.xml:2:1: <flex>: a flexible body is not supported, and leaving it out would change the physics; remove it from the file, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><extension>\n<plugin plugin=\"mujoco.pid\"/></extension></mujoco>",
        "robot.xml:2:1: <plugin>: a plugin is not supported, and leaving it out would change the physics; remove it and what refers to it, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><worldbody><body gravcomp=\"1\"><joint/><geom size=\"1\"/></body></worldbody></mujoco>",
        "robot.xml:1:20: <body>: gravity compensation is not supported, and leaving it out would change the physics; set gravcomp to 0, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><worldbody><geom size=\"1\" dampign=\"2\"/></worldbody></mujoco>",
        "robot.xml:1:35: <geom>: attribute `dampign` is not supported, and leaving it out would change the physics; correct its spelling if it is misspelt, remove it if it is not needed, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><worldbody>\n<replicate count=\"3\"/></worldbody></mujoco>",
        "robot.xml:2:1: <replicate>: <replicate> is not supported, and leaving it out would change the physics; load the file with MuJoCo and save it: that writes it out, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><worldbody><body><joint damping=\"1 2\"/><geom size=\"1\"/></body></worldbody></mujoco>",
        "robot.xml:1:26: <joint>: nonlinear damping is not supported, and leaving it out would change the physics; keep its first coefficient only, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><worldbody><body><joint type=\"ball\" range=\"0 9\"/><geom size=\"1\"/></body>\
         </worldbody></mujoco>",
        "robot.xml:1:26: <joint>: a limit of a ball joint is not supported, and leaving it out would change the physics; use three hinges with limits, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><worldbody><body><joint type=\"free\" springdamper=\"1 1\"/><geom size=\"1\"/></body></worldbody></mujoco>",
        "robot.xml:1:26: <joint>: a spring at a ball or free joint is not supported, and leaving it out would change the physics; write damping instead of springdamper, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><worldbody><site colour=\"1\"/></worldbody></mujoco>",
        "robot.xml:1:26: <site>: attribute `colour` is not supported, and leaving it out would change the physics; correct its spelling if it is misspelt, remove it if it is not needed, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><asset><mesh file=\"m.stl\" scale=\"1 2 3\" refquat=\"1 0 0 1\"/></asset></mujoco>",
        "robot.xml:1:16: <mesh>: a scale that differs along the axes of `refquat` is not supported, and leaving it out would change the physics; write the same scale for all axes, or scale the mesh in its file, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><asset><mesh file=\"m.stl\"/></asset><worldbody><body><joint/>\
         <geom type=\"mesh\" mesh=\"m\"/></body></worldbody></mujoco>",
        "robot.xml:1:69: <geom>: mass from the volume of a mesh is not supported, and leaving it out would change the physics; take meshes as they are where their surfaces are closed (--meshes exact), or as their convex hulls (--meshes hull), give the body an <inertial> element, or this geom mass=\"0\", or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><actuator><muscle joint=\"j\"/></actuator></mujoco>",
        "robot.xml:1:19: <muscle>: an actuator of kind muscle is not supported, and leaving it out would change the physics; use motor, position, velocity or general, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><actuator><motor tendon=\"t\"/></actuator></mujoco>",
        "robot.xml:1:19: <motor>: transmission by `tendon` is not supported, and leaving it out would change the physics; let the actuator act on a joint, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><default><position delay=\"0.1\"/></default><actuator><motor joint=\"j\"/></actuator></mujoco>",
        "robot.xml:1:61: <motor>: delay of the control is not supported, and leaving it out would change the physics; set delay to 0, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><default><motor gaer=\"2\"/></default><actuator><motor joint=\"j\"/></actuator></mujoco>",
        "robot.xml:1:25: <motor>: attribute `gaer` is not supported, and leaving it out would change the physics; correct its spelling if it is misspelt, remove it if it is not needed, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><actuator><position joint=\"j\" timeconst=\"1\"/></actuator></mujoco>",
        "robot.xml:1:19: <position>: activation dynamics `filterexact` is not supported, and leaving it out would change the physics; set dyntype to none, or timeconst to 0, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><tendon><fixed stiffness=\"3\"/></tendon></mujoco>",
        "robot.xml:1:17: <fixed>: a tendon that exerts force is not supported, and leaving it out would change the physics; remove the tendon's stiffness, damping, friction, armature and range, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><equality><tendon tendon1=\"t\"/></equality></mujoco>",
        "robot.xml:1:19: <tendon>: an equality constraint of kind tendon is not supported, and leaving it out would change the physics; remove it, or use connect, weld or joint, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><default><default class=\"a\">\n<geom sise=\"1\"/></default></default></mujoco>",
        "robot.xml:2:7: <geom>: attribute `sise` is not supported, and leaving it out would change the physics; correct its spelling if it is misspelt, remove it if it is not needed, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><default clas=\"a\"/></mujoco>",
        "robot.xml:1:18: <default>: attribute `clas` is not supported, and leaving it out would change the physics; correct its spelling if it is misspelt, remove it if it is not needed, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><worldbody><body><joint type=\"ball\" stiffness=\"3\"/><geom size=\"1\"/></body></worldbody></mujoco>",
        "robot.xml:1:26: <joint>: a spring at a ball or free joint is not supported, and leaving it out would change the physics; set stiffness to 0, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><worldbody><body><joint actuatorfrcrange=\"1 2\"/><geom size=\"1\"/><body><joint name=\"j\"/><geom size=\"1\"/></body></body></worldbody><actuator>\n<motor joint=\"j\"/></actuator></mujoco>",
        "robot.xml:1:26: <joint>: `actuatorfrcrange` without 0 at a joint on which no actuator acts is not supported, and leaving it out would change the physics; remove it, or widen it to 0, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><compiler settotalmass=\"9\"/><asset><mesh file=\"m.stl\"/></asset><worldbody><body>\n<geom type=\"mesh\" mesh=\"m\"/></body></worldbody></mujoco>",
        "robot.xml:2:1: <geom>: mass from the volume of a mesh is not supported, and leaving it out would change the physics; take meshes as they are where their surfaces are closed (--meshes exact), or as their convex hulls (--meshes hull), give the body an <inertial> element, or this geom mass=\"0\", or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><worldbody><body><joint name=\"j\" type=\"ball\"/><geom size=\"1\"/></body></worldbody><actuator>\n<motor jointinparent=\"j\" gear=\"1\"/></actuator></mujoco>",
        "robot.xml:2:1: <motor>: an actuator of a ball or free joint along its parent's axes (`jointinparent`) is not supported, and leaving it out would change the physics; name it by `joint`: its axes turn with the body, or load leniently (--lenient) to go on without it",
    ),
    (
        "<mujoco><asset><hfield name=\"h\" nrow=\"2\" ncol=\"2\" size=\"1 1 1 1\"/></asset><worldbody><body><freejoint/>\n<geom type=\"hfield\" hfield=\"h\"/></body></worldbody></mujoco>",
        "robot.xml:2:1: <geom>: mass from a height field is not supported, and leaving it out would change the physics; give the body an <inertial> element, or this geom mass=\"0\", or load leniently (--lenient) to go on without it",
    ),
];

const URDF: &[(&str, &str)] = &[
    (
        "<robot/>",
        "robot.xml:1:1: <robot>: the robot has no link; add <link name=\"…\">",
    ),
    (
        "<robot><link/></robot>",
        "robot.xml:1:8: <link>: attribute `name` is missing; write name=\"…\"",
    ),
    (
        "<robot><link name=\"a\"/>\n<link name=\"a\"/></robot>",
        "robot.xml:2:7: <link>: attribute `name` is `a`, the name of another link; rename one of them",
    ),
    (
        "<robot><link name=\"a\"/>\n<link name=\"b\"/></robot>",
        "robot.xml:2:1: <link>: it hangs on no joint, and neither does the link `a`; join the two: a robot has one root link",
    ),
    (
        "<robot><link name=\"a\"/><joint name=\"j\" type=\"fixed\"/></robot>",
        "robot.xml:1:24: <joint>: it has no <parent>; add <parent link=\"…\"/>",
    ),
    (
        "<robot><link name=\"a\"/><joint name=\"j\" type=\"fixed\"><parent link=\"a\"/>\n\
         <child link=\"b\"/></joint></robot>",
        "robot.xml:2:8: <child>: attribute `link` names `b`, but no link has this name; correct the name",
    ),
    (
        "<robot><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"hinge\"><parent link=\"a\"/>\
         <child link=\"b\"/></joint></robot>",
        "robot.xml:1:56: <joint>: attribute `type` is `hinge`; write one of: revolute, continuous, prismatic, fixed, floating, planar",
    ),
    (
        "<robot><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"fixed\"><parent link=\"a\"/>\
         <child link=\"b\"/></joint><joint name=\"k\" type=\"fixed\"><parent link=\"b\"/>\
         <child link=\"a\"/></joint></robot>",
        "robot.xml:1:1: <robot>: every link is the child of a joint, so the joints go in a circle; remove the joint that closes the circle",
    ),
    (
        "<robot><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"fixed\"><parent link=\"a\"/>\
         <child link=\"b\"/></joint>\n<joint name=\"k\" type=\"fixed\"><parent link=\"a\"/>\
         <child link=\"b\"/></joint></robot>",
        "robot.xml:2:1: <joint>: its child already hangs on the joint at line 1; give each link one parent: URDF describes trees only",
    ),
    (
        "<robot><link name=\"r\"/><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"fixed\">\
         <parent link=\"a\"/><child link=\"b\"/></joint><joint name=\"k\" type=\"fixed\">\
         <parent link=\"b\"/><child link=\"a\"/></joint></robot>",
        "robot.xml:1:24: <link>: it does not hang on the root link: its joints go in a circle; remove the joint that closes the circle",
    ),
    (
        "<robot><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"revolute\">\
         <parent link=\"a\"/><child link=\"b\"/></joint></robot>",
        "robot.xml:1:40: <joint>: a revolute or prismatic joint needs a limit; add <limit lower=… upper=… effort=… velocity=…/>, or make the joint continuous",
    ),
    (
        "<robot><link name=\"a\"/>\n<link name=\"b\"/><joint name=\"j\" type=\"continuous\">\
         <parent link=\"a\"/><child link=\"b\"/></joint></robot>",
        "robot.xml:2:1: <link>: the body moves but has no mass; give it an inertial element or solid shapes with density, or fix it to a body with mass",
    ),
    (
        "<robot><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"continuous\">\
         <parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 0 0\"/></joint></robot>",
        "robot.xml:1:115: <axis>: attribute `xyz` has no direction; write a vector that is not zero",
    ),
    (
        "<robot><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"prismatic\">\
         <parent link=\"a\"/><child link=\"b\"/>\n<limit lower=\"1\" upper=\"0\"/></joint></robot>",
        "robot.xml:2:8: <limit>: attribute `lower` is 1, above the upper end 0; swap them",
    ),
    (
        "<robot><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"continuous\">\
         <parent link=\"a\"/><child link=\"b\"/><dynamics dampnig=\"1\"/></joint></robot>",
        "robot.xml:1:119: <dynamics>: attribute `dampnig` is not supported, and leaving it out would change the physics; correct its spelling if it is misspelt, remove it if it is not needed, or load leniently (--lenient) to go on without it",
    ),
    (
        "<robot><link name=\"a\"><inertial/></link></robot>",
        "robot.xml:1:23: <inertial>: it has no <mass>; add <mass …/>",
    ),
    (
        "<robot><link name=\"a\"><inertial><mass value=\"1\"/></inertial></link></robot>",
        "robot.xml:1:23: <inertial>: it has no <inertia>; add <inertia …/>",
    ),
    (
        "<robot><link name=\"a\"><inertial><mass value=\"1\"/><inertia ixx=\"1\"/></inertial></link></robot>",
        "robot.xml:1:50: <inertia>: attribute `iyy` is missing; write iyy=\"…\"",
    ),
    (
        "<robot><link name=\"a\"><visual/></link></robot>",
        "robot.xml:1:23: <visual>: it has no geometry; add <geometry> with box, cylinder, sphere or mesh",
    ),
    (
        "<robot><link name=\"a\"><visual><geometry/></visual></link></robot>",
        "robot.xml:1:31: <geometry>: it is empty; add box, cylinder, sphere or mesh",
    ),
    (
        "<robot><link name=\"a\"><visual><geometry><box size=\"1 1\"/></geometry></visual></link></robot>",
        "robot.xml:1:46: <box>: attribute `size` holds 2 numbers; write 3, separated by blanks",
    ),
    (
        "<robot><link name=\"a\"><visual><geometry><sphere radius=\"0\"/></geometry></visual></link></robot>",
        "robot.xml:1:49: <sphere>: attribute `radius` is 0; write a positive number of metres",
    ),
    (
        "<robot><link name=\"a\"><visual><geometry><torus/></geometry></visual></link></robot>",
        "robot.xml:1:41: <torus>: geometry of kind `torus` is not supported, and leaving it out would change the physics; use box, cylinder, sphere, capsule or mesh, or load leniently (--lenient) to go on without it",
    ),
    (
        "<robot><link name=\"a\"/><link name=\"b\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" \
         iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link><joint name=\"j\" \
         type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/>\n<mimic joint=\"x\"/></joint></robot>",
        "robot.xml:2:8: <mimic>: attribute `joint` names `x`, but no moving joint has this name; name another joint",
    ),
    (
        "<robot><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/>\n<dynamic damping=\"1\"/></joint></robot>",
        "robot.xml:2:1: <dynamic>: such an element in <joint> is not supported, and leaving it out would change the physics; correct its spelling if it is misspelt, remove it if it is not needed, or load leniently (--lenient) to go on without it",
    ),
    (
        "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\">\n<xacro:macro name=\"leg\"><link name=\"b\"/></xacro:macro><link name=\"a\"/></robot>",
        "robot.xml:2:1: <xacro:macro>: such an element in <robot> is not supported, and leaving it out would change the physics; expand the file: xacro robot.xacro > robot.urdf, or load leniently (--lenient) to go on without it",
    ),
    (
        "<robot><link name=\"a\"><inertail/></link></robot>",
        "robot.xml:1:23: <inertail>: such an element in <link> is not supported, and leaving it out would change the physics; correct its spelling if it is misspelt, remove it if it is not needed, or load leniently (--lenient) to go on without it",
    ),
    (
        "<robot><link name=\"a\"><visual><geometry><sphere radius=\"1\"><box/></sphere></geometry></visual></link></robot>",
        "robot.xml:1:60: <box>: such an element in <sphere> is not supported, and leaving it out would change the physics; correct its spelling if it is misspelt, remove it if it is not needed, or load leniently (--lenient) to go on without it",
    ),
    (
        "<robot><link name=\"a\"/><jiont/></robot>",
        "robot.xml:1:24: <jiont>: such an element in <robot> is not supported, and leaving it out would change the physics; correct its spelling if it is misspelt, remove it if it is not needed, or load leniently (--lenient) to go on without it",
    ),
];
