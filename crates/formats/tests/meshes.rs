//! Meshes as they are, as their convex hulls and in pieces: which become them, what they weigh, and what
//! can be wrong; and height fields.

use glam::{DMat3, DVec3};
use kinetarium_formats::{FormatError, InMemory, Loaded, Meshes, Options, parse};
use model::{Geometry, Hull, MassProperties, Shape, TriangleMesh};
use std::fs;

/// A cube of half size 1 about (0, 0, 1), with a pit in its upper face that its hull fills.
const CUBE: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0
v -1 -1 2\nv 1 -1 2\nv 1 1 2\nv -1 1 2\nv 0 0 1
f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8
f 5 6 9\nf 6 7 9\nf 7 8 9\nf 8 5 9\n";

const HULLS: Options = Options {
    lenient: false,
    meshes: Meshes::ConvexHull,
    floating_base: false,
};

const EXACT: Options = Options {
    meshes: Meshes::Exact,
    ..HULLS
};

const PIECES: Options = Options {
    meshes: Meshes::Pieces,
    ..HULLS
};

fn read(text: &str, options: &Options) -> Result<Loaded, FormatError> {
    let flat = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let deep = CUBE.replace("v 0 0 1\n", "v 0 0 0.2\n");
    let open = CUBE.split("f 5").next().unwrap();
    let files = InMemory::new([
        ("meshes/cube.obj", CUBE),
        ("meshes/deep.obj", deep.as_str()),
        ("meshes/open.obj", open),
        ("robot/cube.obj", CUBE),
        ("meshes/flat.obj", flat),
        ("meshes/broken.stl", "solid"),
        ("fake.png", "no picture"),
    ]);
    parse(text, "robot.xml", &files, options)
}

fn shape<'a>(loaded: &'a Loaded, name: &str) -> &'a Shape {
    let named = |s: &&Shape| s.name == name;
    loaded.model.shapes.iter().find(named).unwrap()
}

fn is_mesh(shape: &Shape) -> bool {
    matches!(shape.geometry, Geometry::MeshFile { .. })
}

fn hull(shape: &Shape) -> &Hull {
    match &shape.geometry {
        Geometry::Hull(hull) => hull,
        other => panic!("{other:?}"),
    }
}

/// Geoms on a body that is free; their mesh is 40 cm × 20 cm × 20 cm.
fn mjcf(geoms: &str) -> String {
    format!(
        r#"<mujoco><compiler meshdir="meshes"/>
        <asset><mesh file="cube.obj" scale=".2 .1 .1"/></asset>
        <worldbody><body><freejoint/>{geoms}</body></worldbody></mujoco>"#
    )
}

const SEEN: &str = r#"name="seen" type="mesh" mesh="cube" contype="0" conaffinity="0""#;

#[test]
fn what_collides_is_a_hull_and_what_is_seen_a_mesh() {
    let solid = r#"<geom name="solid" type="mesh" mesh="cube" pos="0 0 3"/>"#;
    let text = mjcf(&format!(r#"<geom {SEEN} mass="0"/>{solid}"#));
    let loaded = read(&text, &HULLS).unwrap();
    assert!(is_mesh(shape(&loaded, "seen")));
    let solid = shape(&loaded, "solid");
    let center = DVec3::new(0.0, 0.0, 3.1);
    assert_eq!(hull(solid).vertices().len(), 8);
    assert!((solid.density / 1000.0 - 5.0 / 6.0).abs() < 1e-12);
    assert!(
        solid
            .pose
            .point(hull(solid).center())
            .abs_diff_eq(center, 1e-12)
    );
    // The body weighs what the mesh does.
    let exact = read(&text, &EXACT).unwrap();
    assert_eq!(loaded.model.bodies, exact.model.bodies);
    let warnings: Vec<_> = loaded.warnings.iter().map(ToString::to_string).collect();
    let told = "robot.xml:3: <geom>: mass from a mesh: it is that of what its surface holds";
    assert_eq!(warnings, [told]);
}

/// The hull of a box without a lid is the box.
#[test]
fn open_meshes_weigh_what_their_hulls_do() {
    let text = one_mesh(r#"file="open.obj""#);
    let loaded = read(&text, &HULLS).unwrap();
    let half = DVec3::splat(0.1);
    let cuboid = MassProperties::of(&Geometry::Box { half }, 1000.0).unwrap();
    let body = &loaded.model.bodies[0];
    assert!((body.mass / cuboid.mass - 1.0).abs() < 1e-12);
    assert!(body.center.abs_diff_eq(DVec3::new(0.0, 0.0, 0.1), 1e-12));
    assert!(
        body.inertia
            .abs_diff_eq(cuboid.inertia, 1e-12 * cuboid.mass)
    );
    let told = "robot.xml:2: <geom>: mass from a mesh that is open or inside out: it is that of its convex hull";
    let warnings: Vec<_> = loaded.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings, [told]);
}

/// MuJoCo 4.0 counts what stands still: 10 kg × 1 / (1 + 20/3) for the ball of 1 kg beside the mesh.
#[test]
fn meshes_that_stand_still_count_for_the_total_mass() {
    let text = r#"<mujoco><compiler settotalmass="10"/>
        <asset><mesh name="cube" file="meshes/cube.obj" scale=".1 .1 .1"/></asset>
        <worldbody><body><geom type="mesh" mesh="cube"/></body>
        <body><freejoint/><geom size=".1" mass="1"/></body></worldbody></mujoco>"#;
    for options in [EXACT, HULLS] {
        let loaded = read(text, &options).unwrap();
        let masses: Vec<_> = loaded.model.bodies.iter().map(|b| b.mass).collect();
        let expected = [8.695_652_173_9, 1.304_347_826_1];
        let near = |(found, expected): (&f64, f64)| (found - expected).abs() < 1e-9;
        assert!(masses.iter().zip(expected).all(near), "{masses:?}");
    }
}

/// A mesh that is only seen can give a body its mass, and stays a mesh.
#[test]
fn what_is_seen_can_weigh() {
    let text = mjcf(&format!(r#"<geom {SEEN} mass="3"/>"#));
    let loaded = read(&text, &HULLS).unwrap();
    assert!(is_mesh(shape(&loaded, "seen")));
    assert!((loaded.model.bodies[0].mass - 3.0).abs() < 1e-12);
    let refused = read(&text, &Options::default()).unwrap_err().to_string();
    let remedy = "as their convex hulls (--meshes hull)";
    assert!(refused.contains(remedy), "{refused}");
}

#[test]
fn geoms_of_one_mesh_share_its_hull() {
    let geom = r#"<geom type="mesh" mesh="cube"/>"#;
    let loaded = read(&mjcf(&geom.repeat(2)), &HULLS).unwrap();
    let corners = [0, 1].map(|i| hull(&loaded.model.shapes[i]).vertices().as_ptr());
    assert_eq!(corners[0], corners[1]);
}

/// How far a point is out of a hull: the most of its distances before the faces.
#[cfg(feature = "decomposition")]
fn outside(hull: &Hull, point: DVec3) -> f64 {
    let before = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| hull.vertices()[v as usize]);
        (b - a).cross(c - a).normalize().dot(point - a)
    };
    let all = hull.triangles().iter().map(before);
    all.fold(f64::NEG_INFINITY, f64::max)
}

/// The pit in the cube, 20 cm wide and 10 cm deep, stays one; and a pair is one of all pieces.
#[cfg(feature = "decomposition")]
#[test]
fn pieces_leave_hollow_what_is_and_weigh_what_the_surface_holds() {
    let text = r#"<mujoco><compiler meshdir="meshes"/>
        <asset><mesh name="cube" file="cube.obj" scale=".1 .1 .1"/></asset>
        <worldbody><geom name="floor" type="plane" size="1 1 1"/>
        <body><freejoint/><geom name="solid" type="mesh" mesh="cube" rgba="1 0 0 1"/></body></worldbody>
        <contact><pair geom1="floor" geom2="solid" friction=".3 .3 0 0 0"/></contact></mujoco>"#;
    let [whole, apart] = [EXACT, PIECES].map(|options| read(text, &options).unwrap().model);
    assert_eq!(apart.bodies[0].mass, whole.bodies[0].mass);
    assert_eq!(apart.bodies[0].inertia, whole.bodies[0].inertia);
    let named = |s: &&Shape| s.name.starts_with("solid");
    let pieces: Vec<_> = apart.shapes.iter().filter(named).collect();
    assert!(pieces.len() > 1);
    let names: Vec<_> = pieces.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names[..2], ["solid", "solid_1"]);
    // Above the pit's bottom by 3 cm and 6 cm, on its axis, where a whole hull is 7 cm and 4 cm deep, and
    // pieces as deep as a voxel is wide.
    let voxel = 0.2 / 64.0;
    for height in [0.13, 0.16] {
        let point = DVec3::new(0.0, 0.0, height);
        let out = pieces
            .iter()
            .map(|s| outside(hull(s), s.pose.inverse().point(point)));
        let nearest = out.fold(f64::INFINITY, f64::min);
        assert!(nearest > -voxel, "{height}: {nearest}");
    }
    for shape in &pieces {
        assert_eq!(
            (shape.body, shape.color),
            (pieces[0].body, Some([1.0, 0.0, 0.0, 1.0]))
        );
    }
    assert_eq!(apart.contact_pairs.len(), pieces.len());
    let material = |pair: &model::ContactPair| pair.material;
    let expected = material(&whole.contact_pairs[0]);
    assert!(
        apart
            .contact_pairs
            .iter()
            .all(|pair| material(pair) == expected)
    );
}

#[cfg(feature = "decomposition")]
#[test]
fn every_link_of_a_mesh_comes_apart() {
    let loaded = read(&urdf("robot/cube.obj"), &PIECES).unwrap();
    let hulls = loaded.model.shapes.iter().filter(|s| s.collides);
    assert!(hulls.clone().count() > 1);
    assert!(hulls.map(hull).all(|hull| hull.vertices().len() >= 4));
}

/// A program without the library says which feature brings it.
#[cfg(not(feature = "decomposition"))]
#[test]
fn pieces_ask_for_their_feature() {
    let text = mjcf(r#"<geom type="mesh" mesh="cube"/>"#);
    let refused = read(&text, &PIECES).unwrap_err().to_string();
    assert!(refused.contains("feature `decomposition`"), "{refused}");
    assert!(refused.contains("robot.xml:3"), "{refused}");
}

fn urdf(file: &str) -> String {
    let mesh = format!("<geometry><mesh filename='{file}' scale='.1 .1 .1'/></geometry>");
    format!(
        "<robot name='r'><link name='a'><visual name='seen'>{mesh}</visual>\
         <collision name='solid'>{mesh}</collision></link></robot>"
    )
}

#[test]
fn collision_meshes_of_urdf_are_hulls() {
    for file in ["meshes/cube.obj", "package://robot/cube.obj"] {
        let loaded = read(&urdf(file), &HULLS).unwrap();
        assert!(is_mesh(shape(&loaded, "seen")));
        assert_eq!(hull(shape(&loaded, "solid")).vertices().len(), 8);
        let loaded = read(&urdf(file), &Options::default()).unwrap();
        assert!(is_mesh(shape(&loaded, "solid")));
    }
}

/// A package is a folder above the file.
#[test]
fn packages_are_found_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let package = folder.path().join("arm_description");
    for inside in ["urdf/arms", "meshes"] {
        fs::create_dir_all(package.join(inside)).unwrap();
    }
    fs::write(package.join("meshes/cube.obj"), CUBE).unwrap();
    let robot = package.join("urdf/arms/arm.urdf");
    fs::write(&robot, urdf("package://arm_description/meshes/cube.obj")).unwrap();
    let loaded = kinetarium_formats::load(&robot, &HULLS).unwrap();
    assert_eq!(hull(shape(&loaded, "solid")).vertices().len(), 8);
    // What is only seen is named so that it can be read.
    for loaded in [
        loaded,
        kinetarium_formats::load(&robot, &Options::default()).unwrap(),
    ] {
        let Geometry::MeshFile { file, .. } = &shape(&loaded, "seen").geometry else {
            panic!("a mesh that is seen")
        };
        assert_eq!(fs::read_to_string(file).unwrap(), CUBE);
        assert_eq!(loaded.warnings, []);
    }
    fs::write(&robot, urdf("package://elsewhere/cube.obj")).unwrap();
    let loaded = kinetarium_formats::load(&robot, &Options::default()).unwrap();
    let [warning] = &loaded.warnings[..] else {
        panic!("{:?}", loaded.warnings)
    };
    let told = "no picture shows meshes that are not there; correct their paths (a package is a folder beside this \
                file, or above): package://elsewhere/cube.obj";
    assert_eq!(warning.message, told);
    let [solid] = &loaded.model.shapes[..] else {
        panic!("{:?}", loaded.model.shapes)
    };
    assert_eq!((solid.collides, solid.color), (true, Some([0.0; 4])));
}

/// What is only seen is not opened, but pictures would ask for it: told with places, and not seen.
#[test]
fn meshes_that_no_picture_can_show_are_told() {
    let missing = "no picture shows meshes that are not there; correct their paths (a package is a folder beside this \
                   file, or above)";
    let formats = match collide::mesh::is_known("a.glb") {
        true => ".obj, .stl or .glb",
        false => ".obj or .stl",
    };
    let unknown = format!(
        "no picture shows meshes that are in no format that is read here; convert them to {formats}"
    );
    let geom =
        |name: &str| format!(r#"<geom type="mesh" mesh="{name}" contype="0" conaffinity="0""#);
    let text = format!(
        r#"<mujoco><compiler meshdir="meshes"/><asset><mesh file="cube.obj"/><mesh file="lost.stl"/><mesh file="gone.obj"/>
        <mesh file="arm.dae"/></asset><worldbody>{}/>
        {lost}/>{lost} rgba="1 0 0 1"/>{lost} rgba="0 0 0 0"/>{lost} group="3"/>
        {}/>
        {}/></worldbody></mujoco>"#,
        geom("cube"),
        geom("gone"),
        geom("arm"),
        lost = geom("lost"),
    );
    let lines =
        |loaded: Loaded| -> Vec<_> { loaded.warnings.iter().map(ToString::to_string).collect() };
    let told = [
        format!("robot.xml:3: <geom>: {missing}: meshes/lost.stl; meshes/gone.obj (line 4)"),
        format!("robot.xml:5: <geom>: {unknown}: meshes/arm.dae"),
    ];
    let loaded = read(&text, &Options::default()).unwrap();
    let seen = |shape: &Shape| shape.color != Some([0.0; 4]);
    let seen: Vec<bool> = loaded.model.shapes.iter().map(seen).collect();
    assert_eq!(seen, [[true].as_slice(), &[false; 6]].concat());
    assert_eq!(lines(loaded), told);

    let told = |file: &str, why: &str| [format!("robot.xml:1: <mesh>: {why}: {file}")];
    let seen = |file| lines(read(&urdf(file), &Options::default()).unwrap());
    assert_eq!(seen("lost.obj"), told("lost.obj", missing));
    assert_eq!(seen("arm.dae"), told("arm.dae", &unknown));
    assert_eq!(seen("package://robot/cube.obj"), [""; 0]);
}

/// What collides takes the place of a visual that cannot be read, and stays hidden behind one that can.
#[test]
fn what_collides_is_seen_where_no_visual_is() {
    let link = |file: &str| {
        let text = format!(
            "<robot name='r'><link name='a'><visual><geometry><mesh filename='{file}'/></geometry></visual>\
             <collision><geometry><box size='1 1 1'/></geometry></collision></link></robot>"
        );
        let loaded = read(&text, &Options::default()).unwrap();
        loaded.model.shapes.clone()
    };
    for file in ["arm.dae", "lost.obj", "package://lost/cube.obj"] {
        let shapes = link(file);
        assert_eq!((shapes.len(), shapes[0].color), (1, None), "{file}");
    }
    let shapes = link("meshes/cube.obj");
    assert!(is_mesh(&shapes[0]));
    assert_eq!(shapes[1].color, Some([0.0; 4]));
}

#[test]
fn meshes_that_are_no_hulls_say_where_and_why() {
    let none = "lies in no folder beside this file or above; write its path, relative to this file";
    let cases = [
        (
            "none.obj",
            "the mesh none.obj cannot be read (entity not found); check the path",
        ),
        (
            "meshes/flat.obj",
            "has no convex hull: a convex hull needs 4 points or more, and 3",
        ),
        (
            "meshes/broken.stl",
            "the mesh meshes/broken.stl is broken: ",
        ),
        ("a.dae", "cannot be read"),
        ("package://robot/none.obj", none),
        ("http://robot/cube.obj", none),
    ];
    for (file, message) in cases {
        let error = read(&urdf(file), &HULLS).unwrap_err().to_string();
        let place = error.starts_with("robot.xml:1:") && error.contains("<mesh>: the mesh");
        assert!(place && error.contains(message), "{error}");
    }
    let shell = mjcf(r#"<geom type="mesh" mesh="cube" shellinertia="true"/>"#);
    let error = read(&shell, &HULLS).unwrap_err().to_string();
    assert!(error.contains("mass from the surface of a mesh"), "{error}");
}

fn surface(shape: &Shape) -> &TriangleMesh {
    match &shape.geometry {
        Geometry::Mesh(mesh) => mesh,
        other => panic!("{other:?}"),
    }
}

/// The pit of the cube stays a pit.
#[test]
fn what_collides_is_a_surface_where_meshes_are_to_be_exact() {
    let geom = r#"<geom name="solid" type="mesh" mesh="cube" pos="0 0 3"/>"#;
    let text = format!(
        r#"<mujoco><asset><mesh file="meshes/cube.obj" scale=".2 .1 .1"/></asset>
        <worldbody>{geom}<geom {SEEN}/>{}</worldbody></mujoco>"#,
        geom.replace("solid", "other")
    );
    let loaded = read(&text, &EXACT).unwrap();
    assert!(is_mesh(shape(&loaded, "seen")));
    let [solid, other] = ["solid", "other"].map(|name| shape(&loaded, name));
    let mesh = surface(solid);
    assert_eq!((mesh.vertices().len(), mesh.triangles().len()), (9, 14));
    let bottom = solid.pose.point(mesh.vertices()[8]);
    assert!(bottom.abs_diff_eq(DVec3::new(0.0, 0.0, 3.1), 1e-12));
    assert_eq!(mesh.vertices().as_ptr(), surface(other).vertices().as_ptr());
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);

    let loaded = read(&urdf("package://robot/cube.obj"), &EXACT).unwrap();
    assert!(is_mesh(shape(&loaded, "seen")));
    assert_eq!(surface(shape(&loaded, "solid")).triangles().len(), 14);
}

/// The pit of the cube, a third of half of it, weighs nothing.
#[test]
fn a_closed_surface_weighs_what_it_holds() {
    let text = mjcf(r#"<geom type="mesh" mesh="cube"/>"#);
    let loaded = read(&text, &EXACT).unwrap();
    let mass = 1000.0 * 0.4 * 0.2 * 0.2 * (1.0 - 1.0 / 6.0);
    assert!((loaded.model.bodies[0].mass / mass - 1.0).abs() < 1e-12);
    let told = loaded.warnings[0].to_string();
    assert!(
        told.contains("it is that of what its surface holds"),
        "{told}"
    );
}

/// A free body of one mesh at a tenth of its size, unless `scale` is in what is said of it.
fn one_mesh(mesh: &str) -> String {
    let scale = if mesh.contains("scale=") {
        ""
    } else {
        r#"scale=".1 .1 .1""#
    };
    format!(
        r#"<mujoco><compiler meshdir="meshes"/><asset><mesh name="mesh" {mesh} {scale}/></asset>
        <worldbody><body><freejoint/><geom type="mesh" mesh="mesh"/></body></worldbody></mujoco>"#
    )
}

/// Masses, centres and moments of MuJoCo 4.0.
#[test]
fn meshes_weigh_what_their_inertia_says() {
    let solid = DVec3::new(0.041_166_666_7, 0.041_166_666_7, 0.048);
    let surface = DVec3::new(2.604_533_881_8, 2.604_533_881_8, 2.777_123_616_6);
    for (inertia, mass, height, moments, told) in [
        (
            "exact",
            6.666_666_666_7,
            0.085,
            solid,
            "what its surface holds",
        ),
        (
            "legacy",
            6.666_666_666_7,
            0.085,
            solid,
            "what its surface holds",
        ),
        (
            "convex",
            8.0,
            0.1,
            DVec3::splat(0.053_333_333_3),
            "its convex hull",
        ),
        (
            "shell",
            256.568_542_494_9,
            0.099_108_371_5,
            surface,
            "its surface",
        ),
    ] {
        let text = one_mesh(&format!(r#"file="cube.obj" inertia="{inertia}""#));
        let loaded = read(&text, &EXACT).unwrap();
        let body = &loaded.model.bodies[0];
        assert!(
            (body.mass - mass).abs() < 1e-9 * mass,
            "{inertia}: {body:?}"
        );
        let center = DVec3::new(0.0, 0.0, height);
        assert!(body.center.abs_diff_eq(center, 1e-9), "{inertia}: {body:?}");
        let expected = DMat3::from_diagonal(moments);
        assert!(
            body.inertia.abs_diff_eq(expected, 1e-9),
            "{inertia}: {body:?}"
        );
        let warnings: Vec<_> = loaded.warnings.iter().map(ToString::to_string).collect();
        let expected = format!("robot.xml:2: <geom>: mass from a mesh: it is that of {told}");
        assert_eq!(warnings, [expected]);
    }
    let wrong = one_mesh(r#"file="cube.obj" inertia="hollow""#);
    let error = read(&wrong, &EXACT).unwrap_err().to_string();
    let remedy = "write one of: legacy, exact, convex, shell";
    assert!(error.contains(remedy), "{error}");
}

/// Whatever they become where they collide.
#[test]
fn hulls_weigh_what_the_inertia_of_their_mesh_says() {
    for inertia in ["exact", "legacy", "convex", "shell"] {
        for file in ["cube.obj", "deep.obj"] {
            let text = one_mesh(&format!(r#"file="{file}" inertia="{inertia}""#));
            let [exact, hull] = [EXACT, HULLS].map(|options| read(&text, &options).unwrap());
            assert_eq!(hull.model.bodies, exact.model.bodies, "{inertia} {file}");
            assert_eq!(hull.warnings, exact.warnings);
        }
    }
}

/// MuJoCo's `legacy` has 7.485 kg, for the pit's faces look at the middle, and `exact` 5.6 kg.
#[test]
fn hollow_meshes_are_told_that_mujoco_weighs_otherwise() {
    for (inertia, is_told) in [("", true), (r#"inertia="exact""#, false)] {
        let text = one_mesh(&format!(r#"file="deep.obj" {inertia}"#));
        let loaded = read(&text, &EXACT).unwrap();
        assert!((loaded.model.bodies[0].mass - 5.6).abs() < 1e-9);
        let hollow = |w: &kinetarium_formats::Warning| w.message.contains("a hollow mesh");
        assert_eq!(loaded.warnings.iter().any(hollow), is_told, "{inertia}");
    }
}

/// Centres of mass of MuJoCo 4.0, which moves a mesh by −refpos, turns it back by refquat, and scales it.
#[test]
fn the_frame_of_a_mesh_is_in_its_file() {
    let turned = r#"refpos="1 2 3" refquat="1 0 0 1""#;
    for (scale, frame, center) in [
        (".1 .1 .1", turned, [-0.2, 0.1, -0.215]),
        ("-.1 -.1 -.1", turned, [0.2, -0.1, 0.215]),
        (".1 .1 .3", turned, [-0.2, 0.1, -0.645]),
        (".1 .2 .3", r#"refpos="1 2 3""#, [-0.1, -0.4, -0.645]),
    ] {
        let text = one_mesh(&format!(r#"file="cube.obj" scale="{scale}" {frame}"#));
        let found = read(&text, &EXACT).unwrap().model.bodies[0].center;
        let center = DVec3::from_array(center);
        assert!(found.abs_diff_eq(center, 1e-12), "{scale} {frame}: {found}");
    }
}

/// A pair touches whatever the masks of its geoms are.
#[test]
fn meshes_that_touch_by_a_pair_alone_are_read() {
    let text = |flag: &str, pair: &str| {
        format!(
            r#"<mujoco><option><flag contact="{flag}"/></option>
            <asset><mesh name="cube" file="meshes/cube.obj"/></asset>
            <worldbody><geom name="floor" type="plane" size="1 1 1"/>
            <body><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><geom {SEEN}/></body></worldbody>
            <contact>{pair}</contact></mujoco>"#
        )
    };
    let pair = r#"<pair geom1="floor" geom2="seen"/>"#;
    let loaded = read(&text("enable", pair), &HULLS).unwrap();
    assert_eq!(hull(shape(&loaded, "seen")).vertices().len(), 8);
    for (flag, pair) in [("enable", ""), ("disable", pair)] {
        let loaded = read(&text(flag, pair), &HULLS).unwrap();
        assert!(is_mesh(shape(&loaded, "seen")));
    }
}

/// A surface that ends somewhere has no volume.
#[test]
fn an_open_surface_weighs_nothing() {
    let text = mjcf(r#"<geom type="mesh" mesh="cube"/>"#).replace("cube.obj", "flat.obj");
    let text = text.replace("<mesh file", r#"<mesh name="cube" file"#);
    let refused = read(&text, &EXACT).unwrap_err().to_string();
    let told = "robot.xml:3:38: <geom>: its mass is that of the mesh `cube`, which is open, or has faces wound \
                against their neighbours, along 3 edges, such as that from [0, 0, 0] to [0.2, 0, 0]; mend its file, write \
                inertia=\"convex\" or inertia=\"shell\" at its <mesh>, or give the body an <inertial> element";
    assert_eq!(refused, told);
}

/// Each remedy that is named helps.
#[test]
fn meshes_that_weigh_nothing_say_why() {
    let inside_out: String = CUBE
        .lines()
        .map(|line| match line.strip_prefix("f ") {
            Some(face) => format!(
                "f {}\n",
                face.split(' ').rev().collect::<Vec<_>>().join(" ")
            ),
            None => format!("{line}\n"),
        })
        .collect();
    let files = InMemory::new([("meshes/cube.obj", inside_out.as_str())]);
    let text = mjcf(r#"<geom type="mesh" mesh="cube"/>"#);
    let with = |text: &str, options: &Options| parse(text, "robot.xml", &files, options);
    let refused = with(&text, &EXACT).unwrap_err().to_string();
    let told = "robot.xml:3:38: <geom>: its mass is that of the mesh `cube`, which is inside out: its volume is \
                -1.333e-2 m³; turn its faces around in its file, write inertia=\"convex\" at its <mesh>, or give the body an \
                <inertial> element";
    assert_eq!(refused, told);
    let inertial = r#"<freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>"#;
    for mended in [
        text.replace("<mesh ", r#"<mesh inertia="convex" "#),
        text.replace("<freejoint/>", inertial),
    ] {
        with(&mended, &EXACT).unwrap();
    }
    read(&text, &EXACT).unwrap();
    // Left out, where the body weighs otherwise.
    let lenient = Options {
        lenient: true,
        ..EXACT
    };
    let also = text.replace("<freejoint/>", r#"<freejoint/><geom size=".1" mass="1"/>"#);
    let loaded = with(&also, &lenient).unwrap();
    assert_eq!(loaded.model.bodies[0].mass, 1.0);
    let told = loaded.warnings[0].to_string();
    assert!(
        told.contains("inside out") && told.ends_with("changes the physics"),
        "{told}"
    );

    let flat = text.replace(".2 .1 .1", ".2 .1 0");
    let refused = read(&flat, &EXACT).unwrap_err().to_string();
    assert!(
        refused.contains("which is flat: its volume is 0; correct its file, or `scale`"),
        "{refused}"
    );
}

/// A height field of 3 m × 2 m, 2 m high, a metre above the ground.
fn height_field(asset: &str) -> String {
    format!(
        r#"<mujoco><asset><hfield name="hills" size="1.5 1 2 .5" {asset}/></asset><worldbody>
        <geom name="ground" type="hfield" hfield="hills" pos="0 0 1"/></worldbody></mujoco>"#
    )
}

/// The heights at the corners of a height field's middle row and of its ends, above where they are, as
/// MuJoCo's rays find them.
fn corners(loaded: &Loaded) -> Vec<(f64, f64, f64)> {
    let ground = shape(loaded, "ground");
    let places = surface(ground).vertices().iter();
    let mut places: Vec<_> = places.map(|v| ground.pose.point(*v)).collect();
    places.sort_by(|p, q| (p.y, p.x).partial_cmp(&(q.y, q.x)).unwrap());
    let rounded = |x: f64| (1e4 * x).round() / 1e4 + 0.0;
    places
        .iter()
        .map(|p| (rounded(p.x), rounded(p.y), rounded(p.z)))
        .collect()
}

#[test]
fn height_fields_have_their_first_row_at_most_y() {
    let text = height_field(r#"nrow="3" ncol="4" elevation="0 1 2 3  4 5 6 7  8 9 10 12""#);
    let loaded = read(&text, &Options::default()).unwrap();
    let xs = [-1.5, -0.5, 0.5, 1.5];
    let rows = [
        (-1.0, [2.3333, 2.5, 2.6667, 3.0]),
        (0.0, [1.6667, 1.8333, 2.0, 2.1667]),
        (1.0, [1.0, 1.1667, 1.3333, 1.5]),
    ];
    let expected = rows
        .iter()
        .flat_map(|(y, zs)| (0..4).map(move |i| (xs[i], *y, zs[i])));
    assert_eq!(corners(&loaded), expected.collect::<Vec<_>>());
    // The front is up.
    let ground = shape(&loaded, "ground");
    assert!(ground.pose.direction(surface(ground).normal(0)).z > 0.1);
    let told = loaded
        .warnings
        .iter()
        .any(|w| w.to_string().contains("a surface here"));
    assert!(told, "{:?}", loaded.warnings);
}

/// The same heights as numbers and as a picture; in MuJoCo's own format the first row is at least y.
#[test]
fn height_fields_are_read_from_files() {
    let written = height_field(r#"nrow="2" ncol="3" elevation="3 4 8 0 1 2""#);
    let expected = corners(&read(&written, &Options::default()).unwrap());
    let folder = tempfile::tempdir().unwrap();
    let numbers = [0.0_f32, 1.0, 2.0, 3.0, 4.0, 8.0];
    let sizes = [2_i32, 3].map(i32::to_le_bytes).concat();
    let samples: Vec<_> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    fs::write(folder.path().join("hills.bin"), [sizes, samples].concat()).unwrap();
    let picture = |depth, greys: &[u8]| {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 3, 2);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(depth);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(greys).unwrap();
        writer.finish().unwrap();
        bytes
    };
    let small = picture(png::BitDepth::Eight, &[33, 34, 38, 30, 31, 32]);
    let deep: Vec<_> = [330_u16, 340, 380, 300, 310, 320]
        .into_iter()
        .flat_map(u16::to_be_bytes)
        .collect();
    let deep = picture(png::BitDepth::Sixteen, &deep);
    fs::write(folder.path().join("small.png"), small).unwrap();
    fs::write(folder.path().join("deep.png"), deep).unwrap();
    for name in ["hills.bin", "small.png", "deep.png"] {
        let file = folder.path().join("model.xml");
        fs::write(&file, height_field(&format!("file=\"{name}\""))).unwrap();
        let loaded = kinetarium_formats::load(&file, &Options::default()).unwrap();
        assert_eq!(corners(&loaded), expected, "{name}");
    }
}

/// A few bytes that say that they are a picture of 2⁴⁰ pixels.
#[test]
fn pictures_too_large_for_a_height_field_are_refused_unread() {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1 << 20, 1 << 20);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().unwrap();
    writer.write_chunk(png::chunk::IDAT, &[0]).unwrap();
    drop(writer);
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("huge.png"), bytes).unwrap();
    let file = folder.path().join("model.xml");
    fs::write(&file, height_field("file=\"huge.png\"")).unwrap();
    let refused = kinetarium_formats::load(&file, &Options::default());
    let error = refused.unwrap_err().to_string();
    assert!(
        error.contains("at most 262144 can be told apart"),
        "{error}"
    );
}

#[test]
fn height_fields_that_are_none_say_why() {
    let cases = [
        (
            r#"nrow="3" ncol="4" elevation="1 2""#,
            "attribute `elevation` holds 2 numbers; write 12",
        ),
        (
            r#"nrow="1" ncol="4""#,
            "attribute `nrow` is 1; write 2 or more",
        ),
        (
            r#"nrow="2" ncol="131074""#,
            "2 × 131074 samples make 262146 triangles, and at most 262144 can be told apart",
        ),
        (
            r#"nrow="3000000000" ncol="3000000000""#,
            "at most 262144 can be told apart",
        ),
        (
            r#"nrow="4096" ncol="4096""#,
            "at most 262144 can be told apart",
        ),
        (r#"ncol="4""#, "`nrow`"),
        (
            r#"nrow="2" ncol="2" elevation="1 2 nan 3""#,
            "holds `nan`, which is not a finite number",
        ),
        (
            r#"file="none.png""#,
            "the height field none.png cannot be read",
        ),
        (
            r#"file="robot/cube.obj""#,
            "the height field robot/cube.obj is broken: it says ",
        ),
        (
            r#"file="fake.png""#,
            "the height field fake.png is broken: ",
        ),
    ];
    for (asset, message) in cases {
        let error = read(&height_field(asset), &Options::default())
            .unwrap_err()
            .to_string();
        let place = error.starts_with("robot.xml:1:") && error.contains("<hfield>: ");
        assert!(place && error.contains(message), "{error}");
    }
    let size = height_field(r#"nrow="2" ncol="2""#).replace("1.5 1 2 .5", "1.5 1 0 .5");
    let error = read(&size, &Options::default()).unwrap_err().to_string();
    assert!(
        error.contains("attribute `size` holds 0; write four positive numbers"),
        "{error}"
    );
    let missing =
        height_field(r#"nrow="2" ncol="2""#).replace("hfield=\"hills\"", "hfield=\"hill\"");
    let error = read(&missing, &Options::default()).unwrap_err().to_string();
    assert!(
        error.contains("names `hill`, which is no height field"),
        "{error}"
    );
}
