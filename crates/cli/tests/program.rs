//! The program from outside: what it prints, what it writes, and what it refuses.

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::contains;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Stdio};
use tempfile::TempDir;

const DOUBLE_PENDULUM: &str = r#"<mujoco model="double">
  <option timestep="0.004"/>
  <worldbody>
    <body name="upper">
      <joint name="shoulder" type="hinge" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0 0 -1" size="0.05"/>
      <body name="lower" pos="0 0 -1">
        <joint name="elbow" type="hinge" axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 -1" size="0.05"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="motor" joint="elbow"/></actuator>
  <keyframe><key name="raised" qpos="1.5 0.5" qvel="0 2" ctrl="0.25"/></keyframe>
</mujoco>
"#;

fn kinetarium(folder: &TempDir) -> Command {
    let mut command = Command::cargo_bin("kinetarium").unwrap();
    command.current_dir(folder).env_remove("KINETARIUM_ISA");
    command
}

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("double.xml"), DOUBLE_PENDULUM).unwrap();
    folder
}

/// Array of an npz file: shape and numbers.
fn array(path: &Path, name: &str) -> (Vec<u64>, Vec<f64>) {
    let mut zip = zip::ZipArchive::new(File::open(path).unwrap()).unwrap();
    let npy = npyz::NpyFile::new(zip.by_name(&format!("{name}.npy")).unwrap()).unwrap();
    (npy.shape().to_vec(), npy.into_vec().unwrap())
}

fn names(path: &Path, name: &str) -> Vec<String> {
    let mut zip = zip::ZipArchive::new(File::open(path).unwrap()).unwrap();
    let npy = npyz::NpyFile::new(zip.by_name(&format!("{name}.npy")).unwrap()).unwrap();
    npy.into_vec().unwrap()
}

#[test]
fn headless_and_without_a_command_the_pendula_run() {
    let folder = folder();
    let summary = [
        "1024",
        "featherstone (auto: the joints form a tree)",
        "world-steps/s",
        "real-time factor",
        "energy drift",
        "kinetarium-out/pendula.npz",
    ];
    let mut run = kinetarium(&folder).arg("--headless").assert().success();
    for part in summary {
        run = run.stdout(contains(part));
    }
    for extension in ["npz", "csv", "png", "svg"] {
        let path = folder
            .path()
            .join("kinetarium-out/pendula")
            .with_extension(extension);
        assert!(
            fs::metadata(&path).unwrap().len() > 1000,
            "{}",
            path.display()
        );
    }
}

#[test]
fn a_file_runs_and_its_trajectory_reads_back() {
    let folder = folder();
    let options = "run double.xml --worlds 20 --seconds 1 --every 0.1 --record 3 --perturb 0.05 \
                   --solver featherstone --integrator rk4 --precision f64 --threads 2 --out results";
    kinetarium(&folder)
        .args(options.split_whitespace())
        .assert()
        .success()
        .stdout(contains("f64"));
    let npz = folder.path().join("results/double.npz");

    let (shape, time) = array(&npz, "time");
    assert_eq!(shape, [11]);
    assert!(
        time.iter()
            .enumerate()
            .all(|(i, t)| (t - 0.1 * i as f64).abs() < 1e-12),
        "{time:?}"
    );
    let (shape, position) = array(&npz, "joint_position");
    assert_eq!(shape, [11, 3, 2]);
    assert_eq!(position[..2], [0.0, 0.0], "world 0 starts as the file says");
    assert!(
        position[2..6].iter().all(|q| *q != 0.0 && q.abs() <= 0.05),
        "the others apart"
    );
    assert_eq!(array(&npz, "joint_velocity").0, [11, 3, 2]);
    let (shape, bodies) = array(&npz, "body_position");
    assert_eq!(shape, [11, 3, 2, 3]);
    assert_eq!(
        bodies[3..6],
        [0.0, 0.0, -1.0],
        "the elbow, in world 0 at the start"
    );
    assert_eq!(array(&npz, "body_orientation").0, [11, 3, 2, 4]);
    let (shape, energy) = array(&npz, "energy");
    assert_eq!(shape, [11, 3]);
    let drift = energy
        .chunks(3)
        .map(|row| (row[1] - energy[1]).abs())
        .fold(0.0, f64::max);
    assert!(drift < 1e-8, "{drift}");
    let (shape, diverged) = array(&npz, "diverged_at");
    assert_eq!(shape, [3]);
    assert!(diverged.iter().all(|t| t.is_nan()), "{diverged:?}");
    assert_eq!(names(&npz, "coordinate_names"), ["shoulder", "elbow"]);
    assert_eq!(names(&npz, "dof_names"), ["shoulder", "elbow"]);
    assert_eq!(names(&npz, "body_names"), ["upper", "lower"]);
}

#[test]
fn the_table_holds_the_same_numbers() {
    let folder = folder();
    let options = "run double.xml --worlds 2 --record 2 --seconds 0.2 --every 0.1 --perturb 0.1";
    kinetarium(&folder)
        .args(options.split_whitespace())
        .assert()
        .success();
    let path = folder.path().join("kinetarium-out/double");
    let (_, position) = array(&path.with_extension("npz"), "joint_position");
    let mut table = csv::Reader::from_path(path.with_extension("csv")).unwrap();
    let columns = table.headers().unwrap().clone();
    let column = |name: &str| columns.iter().position(|c| c == name).unwrap();
    let (world, elbow) = (column("world"), column("position.elbow"));
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    assert_eq!(
        rows.iter()
            .map(|row| row[world].to_owned())
            .collect::<Vec<_>>()
            .join(""),
        "010101"
    );
    let elbows: Vec<f64> = rows.iter().map(|row| row[elbow].parse().unwrap()).collect();
    assert_eq!(elbows, position.chunks(2).map(|q| q[1]).collect::<Vec<_>>());
}

#[test]
fn a_keyframe_sets_positions_velocities_and_controls() {
    let folder = folder();
    let run = |name: &str| {
        let options = format!("run double.xml --keyframe {name} --seconds 0.1");
        kinetarium(&folder)
            .args(options.split_whitespace())
            .assert()
    };
    run("raised").success();
    let npz = folder.path().join("kinetarium-out/double.npz");
    assert_eq!(array(&npz, "joint_position").1[..2], [1.5, 0.5]);
    assert_eq!(array(&npz, "joint_velocity").1[..2], [0.0, 2.0]);
    run("risen")
        .code(2)
        .stderr(contains("did you mean \"raised\"?"));
}

#[test]
fn the_same_seed_gives_the_same_files() {
    let folder = folder();
    let run = |seed: &str, threads: &str, out: &str| {
        let options = "run double.xml --worlds 40 --record 40 --seconds 0.5 --perturb 0.1 --quiet";
        let more = ["--seed", seed, "--threads", threads, "--out", out];
        let run = kinetarium(&folder)
            .args(options.split_whitespace())
            .args(more)
            .assert();
        run.success().stdout("").stderr("");
        array(
            &folder.path().join(out).join("double.npz"),
            "joint_position",
        )
        .1
    };
    let first = run("7", "1", "a");
    assert_eq!(first, run("7", "2", "b"));
    assert_ne!(first, run("8", "2", "c"));
}

#[test]
fn every_solver_and_integrator_runs() {
    let folder = folder();
    for options in [
        "--solver xpbd --iterations 2",
        "--integrator explicit-euler",
        "--integrator verlet",
        "--isa portable --substeps 2",
    ] {
        let run = kinetarium(&folder)
            .args([
                "pendula",
                "--links",
                "2",
                "--worlds",
                "3",
                "--seconds",
                "0.1",
            ])
            .args(options.split_whitespace())
            .assert();
        run.success().stdout(contains("diverged worlds   none"));
    }
}

const SCENES: [&str; 11] = [
    "balls",
    "billiards",
    "collide",
    "dominoes",
    "tower",
    "pyramid",
    "card_house",
    "pile",
    "terrain",
    "ragdolls",
    "room",
];

#[test]
fn every_scene_runs() {
    let folder = folder();
    for name in SCENES {
        let run = kinetarium(&folder)
            .args(["example", name, "--seconds", "0.05"])
            .assert();
        run.success()
            .stdout(contains("diverged worlds   none").and(contains("energy change")))
            .stdout(contains(format!("kinetarium-out/{name}.png")));
    }
}

#[test]
fn balls_bounce_to_e_squared_of_their_height() {
    let folder = folder();
    let options = "example balls --worlds 17 --record 17 --seconds 0.9 --every 0.01 --perturb 1e-4";
    kinetarium(&folder)
        .args(options.split_whitespace())
        .assert()
        .success();
    let npz = folder.path().join("kinetarium-out/balls.npz");
    let names = names(&npz, "body_names");
    let (shape, position) = array(&npz, "body_position");
    assert_eq!(shape, [91, 17, 5, 3]);
    for (ball, name) in names.iter().enumerate() {
        let e: f64 = name.trim_start_matches("e_").parse().unwrap();
        // All reach the floor after 0.45 s, and rise until e times as long later.
        let row = (100.0 * (1.0 + e) * (2.0_f64 / 9.81).sqrt()).round() as usize;
        for world in 0..17 {
            let height = position[((row.min(90) * 17 + world) * 5 + ball) * 3 + 1] - 0.1;
            // Without restitution the landing is that of a spring and damper.
            let tolerance = if e == 0.0 { 0.03 } else { 0.015 };
            assert!((height - e * e).abs() < tolerance, "{name}: {height}");
        }
    }
}

#[test]
fn dominoes_fall_to_the_last() {
    let folder = folder();
    kinetarium(&folder)
        .args(["example", "dominoes", "--seconds", "2.5"])
        .assert()
        .success();
    let npz = folder.path().join("kinetarium-out/dominoes.npz");
    let position = array(&npz, "body_position").1;
    let last = &position[position.len() - 3 * 20..];
    for (i, place) in last.chunks(3).enumerate() {
        assert!(place[1] < 0.07, "domino {i} stands at {}", place[1]);
    }
}

#[test]
fn equal_balls_change_places() {
    let folder = folder();
    kinetarium(&folder)
        .args(["example", "billiards", "--seconds", "2"])
        .assert()
        .success();
    let npz = folder.path().join("kinetarium-out/billiards.npz");
    let names = names(&npz, "body_names");
    let velocity = array(&npz, "joint_velocity").1;
    let end = &velocity[velocity.len() - 6 * names.len()..];
    let of = |name: &str| {
        let body = names.iter().position(|n| n == name).unwrap();
        [end[6 * body], end[6 * body + 2]]
    };
    let near = |name: &str, x: f64, z: f64| {
        let [u, w] = of(name);
        assert!((u - x).hypot(w - z) < 0.03, "{name}: {u} {w}");
    };
    near("straight", 0.0, 0.0);
    near("straight_hit", 1.0, 0.0);
    // Half a ball off centre, the line of centres lies at 30° to the motion.
    let (cos, sin) = (0.75_f64.sqrt(), 0.5);
    near("oblique_hit", cos * cos, -cos * sin);
    near("oblique", sin * sin, cos * sin);
    for i in 0..4 {
        near(&format!("row_{i}"), 0.0, 0.0);
    }
    near("row_4", 1.0, 0.0);
}

#[test]
fn info_tells_what_is_in_a_file() {
    let folder = folder();
    let parts = [
        "double: 2 bodies, 2 joints, 2 degrees of freedom",
        "time step         0.004 s",
        "keyframes         raised",
        "featherstone (auto: the joints form a tree)",
        "elbow",
    ];
    let mut info = kinetarium(&folder)
        .args(["info", "double.xml"])
        .assert()
        .success();
    for part in parts {
        info = info.stdout(contains(part));
    }
}

#[test]
fn how_others_reach_the_page_is_printed() {
    let folder = folder();
    let mut server = std::process::Command::new(env!("CARGO_BIN_EXE_kinetarium"))
        .args("view --no-browser --port 0 --address 0.0.0.0 --device cpu".split(' '))
        .current_dir(&folder)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let out = server.stdout.take().unwrap();
    let lines: Vec<String> = BufReader::new(out).lines().take(3).flatten().collect();
    server.kill().unwrap();
    server.wait().unwrap();
    let (_, token) = lines[0].split_once("/?token=").unwrap();
    assert_eq!(lines[1], "Stop with Ctrl+C.");
    assert!(lines[2].starts_with("From elsewhere") && lines[2].ends_with(token));
}

/// A page that is served until it is dropped.
struct Served {
    process: Child,
    /// Host and port.
    address: String,
}

impl Served {
    /// By the program with such arguments; the address is what it prints first.
    fn by(folder: &TempDir, arguments: &[&str]) -> Self {
        let mut process = std::process::Command::new(env!("CARGO_BIN_EXE_kinetarium"))
            .args(arguments)
            .current_dir(folder)
            // No browser is found there.
            .env("PATH", "")
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        let out = process.stdout.take().unwrap();
        BufReader::new(out).read_line(&mut line).unwrap();
        let address = line.trim().trim_start_matches("http://");
        let address = address.trim_end_matches('/').to_owned();
        Self { process, address }
    }
    fn socket(&self, request: &str) -> TcpStream {
        let mut socket = TcpStream::connect(&self.address).unwrap();
        let host = &self.address;
        write!(socket, "GET {request} HTTP/1.1\r\nHost: {host}\r\n").unwrap();
        socket
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.process.kill().unwrap();
        self.process.wait().unwrap();
    }
}

#[test]
fn without_arguments_the_page_is_served_to_this_machine_alone() {
    let folder = folder();
    let served = Served::by(&folder, &[]);
    let (host, port) = served.address.split_once(':').unwrap();
    assert_eq!(host, "127.0.0.1");
    assert!(port.parse::<u16>().unwrap() > 0);
    let mut socket = served.socket("/");
    write!(socket, "Connection: close\r\n\r\n").unwrap();
    let mut answer = String::new();
    socket.read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    assert!(answer.contains(r#"name="kinetarium-engine" content="websocket""#));
}

#[test]
fn a_file_is_served_as_its_scene() {
    let folder = folder();
    let arguments = [
        "view",
        "double.xml",
        "--keyframe",
        "raised",
        "--worlds",
        "3",
        "--no-browser",
        "--port",
        "0",
        "--device",
        "cpu",
    ];
    let served = Served::by(&folder, &arguments);
    let mut socket = served.socket("/session");
    let upgrade = "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
        Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
    socket.write_all(upgrade.as_bytes()).unwrap();
    // Messages of a server are plain text between their lengths: the welcome, then the scene.
    let (mut said, mut some) = (String::new(), [0; 4096]);
    while !said.contains(r#""bounds""#) {
        let count = socket.read(&mut some).unwrap();
        assert!(count > 0, "{said}");
        said += &String::from_utf8_lossy(&some[..count]);
    }
    assert!(said.starts_with("HTTP/1.1 101"), "{said}");
    for part in [
        r#""type":"scene""#,
        r#""name":"double""#,
        r#""worlds":3"#,
        r#""elbow""#,
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
}

#[test]
fn what_cannot_be_shown_ends_with_2_and_says_why() {
    let folder = folder();
    let cases: [(&[&str], &str); 6] = [
        (&["view", "towr"], "no example `towr`; known are pendula"),
        (&["view", "missing.xml"], "missing.xml"),
        (&["view", "--headless"], "--headless shows nothing"),
        (&["view", "tower", "--worlds", "8"], "are for files"),
        (
            &["view", "--address", "192.0.2.1", "--port", "0"],
            "cannot listen at 192.0.2.1:0",
        ),
        (&["view", "--worlds", "0"], "0 is not in"),
    ];
    for (arguments, message) in cases {
        kinetarium(&folder)
            .args(arguments)
            .assert()
            .code(2)
            .stderr(contains(message));
    }
}

#[test]
fn help_shows_examples() {
    let folder = folder();
    kinetarium(&folder)
        .arg("--help")
        .assert()
        .success()
        .stdout(contains("Examples:").and(contains("info robot.xml")));
    kinetarium(&folder)
        .args(["run", "--help"])
        .assert()
        .success()
        .stdout(contains("--keyframe <NAME>"));
    let mut help = kinetarium(&folder)
        .args(["example", "--help"])
        .assert()
        .success();
    for name in SCENES {
        help = help.stdout(contains(format!("- {name}:")));
    }
}

#[test]
fn wrong_options_end_with_2_and_say_why() {
    let cases = [
        ("fly", "unrecognized subcommand 'fly'"),
        ("run", "<FILE>"),
        (
            "run double.xml --world 3",
            "a similar argument exists: '--worlds'",
        ),
        ("run double.xml --worlds 0", "0 is not in 1..=16777216"),
        ("run double.xml --worlds many", "invalid digit"),
        ("run double.xml --seconds -1", "it must be above zero"),
        ("run double.xml --seconds nan", "it must be finite"),
        (
            "run double.xml --seconds 1e-9",
            "--seconds 0.000000001 are no time step of 0.004 s",
        ),
        ("run double.xml --seconds 1e300", "or too many"),
        ("run double.xml --time-step 0", "it must be above zero"),
        (
            "run double.xml --solver magic",
            "possible values: auto, featherstone, xpbd, impulse",
        ),
        (
            "run double.xml --integrator leapfrog",
            "possible values: semi-implicit-euler",
        ),
        (
            "run double.xml --precision f16",
            "possible values: f32, f64",
        ),
        ("run double.xml --isa mmx", "unknown instruction set `mmx`"),
        (
            "run double.xml --device tpu",
            "unknown device `tpu`; known are cpu, auto, gpu",
        ),
        ("run double.xml --threads 100000", "is not in 0..=1024"),
        ("run double.xml --substeps 0", "is not in 1..=10000"),
        ("run double.xml --perturb -0.1", "it must not be negative"),
        (
            "run double.xml --record 2",
            "--record 2 is more than the 1 worlds there are",
        ),
        (
            "run double.xml --seconds 1e8 --every 0.004",
            "raise --every",
        ),
        (
            "run double.xml --iterations 50",
            "--iterations is for the solver xpbd, and this is simulated with featherstone",
        ),
        (
            "run double.xml --floating-base",
            "leave that out (--floating-base), and give the body a <freejoint/>",
        ),
        ("double.xml", "'kinetarium view double.xml' shows it"),
        ("tower", "'kinetarium view tower' shows it"),
        ("run tower", "use `kinetarium example tower`"),
        ("info tower", "use `kinetarium example tower`"),
        ("run ant", "use `kinetarium view ant`"),
        ("example", "<NAME>"),
        (
            "example towr",
            "possible values: balls, billiards, collide, dominoes, tower,",
        ),
        ("example towr", "a similar value exists: 'tower'"),
        ("pendula --links 0", "0 is not in 1..=1000"),
        (
            "pendula --start sideways",
            "possible values: hanging, horizontal, upright",
        ),
    ];
    let folder = folder();
    for (options, message) in cases {
        let run = kinetarium(&folder)
            .args(options.split_whitespace())
            .assert();
        run.code(2).stdout("").stderr(contains(message));
    }
    assert!(
        !folder.path().join("kinetarium-out").exists(),
        "nothing was written"
    );
}

#[test]
fn wrong_files_end_with_2_and_say_why() {
    let folder = folder();
    let file = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    file("cut.xml", "<mujoco><worldbody>");
    file("page.xml", "<html/>");
    file(
        "fluid.xml",
        &DOUBLE_PENDULUM.replace("<option ", "<option density=\"1000\" "),
    );
    for (name, message) in [
        ("missing.xml", "missing.xml: cannot be read"),
        ("/dev/zero", "more than 67108864 bytes"),
        ("cut.xml", "cut.xml:1:"),
        ("page.xml", "MJCF files start with <mujoco>"),
        ("fluid.xml", "or load leniently (--lenient)"),
    ] {
        for command in ["run", "info"] {
            kinetarium(&folder)
                .args([command, name])
                .assert()
                .code(2)
                .stdout("")
                .stderr(contains(message));
        }
    }
    let lenient = ["run", "fluid.xml", "--lenient", "--seconds", "0.1"];
    kinetarium(&folder)
        .args(lenient)
        .assert()
        .success()
        .stderr(contains("warning: fluid.xml:"));
}

#[test]
fn an_instruction_set_from_the_environment_is_checked() {
    let folder = folder();
    let mut run = kinetarium(&folder);
    run.env("KINETARIUM_ISA", "abacus")
        .args(["pendula", "--worlds", "2"]);
    run.assert()
        .code(2)
        .stderr(contains("unknown instruction set `abacus`"));
}

#[test]
fn a_folder_that_cannot_be_made_ends_with_2() {
    let folder = folder();
    let run = ["pendula", "--worlds", "2", "--out", "double.xml/results"];
    kinetarium(&folder)
        .args(run)
        .assert()
        .code(2)
        .stderr(contains("choose another with --out"));
}

#[test]
fn a_run_in_which_all_worlds_diverge_ends_with_1() {
    let folder = folder();
    let options =
        "pendula --links 3 --worlds 4 --time-step 0.5 --seconds 500 --integrator explicit-euler";
    kinetarium(&folder)
        .args(options.split_whitespace())
        .assert()
        .code(1)
        .stdout(contains("4 of 4"))
        .stderr(contains("all 4 worlds diverged").and(contains("lower --time-step")));
}

/// To a time step, however seldom a row is written.
#[test]
fn when_a_world_diverges_does_not_depend_on_the_rows() {
    let folder = folder();
    let run = |every: &str| {
        let options = "pendula --links 3 --worlds 4 --record 2 --time-step 0.5 --seconds 500 \
                       --integrator explicit-euler --quiet --every";
        kinetarium(&folder)
            .args(options.split_whitespace())
            .arg(every)
            .assert()
            .code(1);
        array(
            &folder.path().join("kinetarium-out/pendula.npz"),
            "diverged_at",
        )
    };
    let (shape, times) = run("0.5");
    assert_eq!(shape, [2]);
    assert!(times.iter().all(|t| *t > 0.0 && *t < 500.0), "{times:?}");
    assert_eq!(run("500").1, times);
}

/// A ball dropped on a plane lies there; without contacts it falls on.
#[test]
fn contacts_can_be_switched_off() {
    let folder = folder();
    let ball = r#"<mujoco><worldbody>
      <geom type="plane" size="1 1 1"/>
      <body pos="0 0 0.2"><freejoint/><geom type="sphere" size="0.1" condim="1"/></body>
    </worldbody></mujoco>"#;
    fs::write(folder.path().join("ball.xml"), ball).unwrap();
    let height = |options: &[&str]| {
        let mut command = kinetarium(&folder);
        let command = command.args(["run", "ball.xml", "--seconds", "1", "--quiet"]);
        command.args(options).assert().success();
        let file = folder.path().join("kinetarium-out/ball.npz");
        // Of the last row x, y, z; z points up.
        let (_, position) = array(&file, "body_position");
        position[position.len() - 1]
    };
    assert!((height(&[]) - 0.1).abs() < 0.01);
    assert!(height(&["--no-contacts"]) < -4.0);
}

/// The message names the shape, and the ways out.
#[test]
fn a_mesh_that_should_touch_is_refused() {
    let folder = folder();
    let rock = r#"<mujoco><asset><mesh name="rock" file="rock.stl"/></asset><worldbody>
      <geom type="plane" size="1 1 1"/>
      <body pos="0 0 1"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
        <geom name="rock" type="mesh" mesh="rock"/></body>
    </worldbody></mujoco>"#;
    fs::write(folder.path().join("rock.xml"), rock).unwrap();
    let mut command = kinetarium(&folder);
    let refused = command.args(["run", "rock.xml"]).assert().code(2);
    refused.stderr(contains("contacts of the mesh of `rock`").and(contains("--meshes hull")));
    let mut command = kinetarium(&folder);
    let command = command.args([
        "run",
        "rock.xml",
        "--no-contacts",
        "--seconds",
        "0.1",
        "--quiet",
    ]);
    command.assert().success();
}

/// One without a name is told by its file, and where it is; `info` knows before.
#[test]
fn a_mesh_without_a_name_is_told_by_its_file() {
    let folder = folder();
    let rock = r#"<mujoco><asset><mesh name="rock" file="rock.stl"/></asset><worldbody>
      <geom type="plane" size="1 1 1"/>
      <body name="boulder" pos="0 0 1"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
        <geom type="mesh" mesh="rock"/></body>
    </worldbody></mujoco>"#;
    fs::write(folder.path().join("rock.xml"), rock).unwrap();
    let refused = kinetarium(&folder)
        .args(["run", "rock.xml"])
        .assert()
        .code(2);
    refused.stderr(contains(
        "contacts of the mesh of `rock.stl, of the body at row 0`",
    ));
    let told = kinetarium(&folder).args(["info", "rock.xml"]).assert();
    told.success()
        .stdout(contains("shape 1 of boulder (rock.stl)").and(contains("--meshes exact")));
}

/// Links whose visuals no build reads are drawn as what of them collides.
#[test]
fn a_robot_whose_visuals_cannot_be_read_has_pictures() {
    let folder = folder();
    let arm = r#"<robot name="arm"><link name="base"/><link name="tip">
      <visual><geometry><mesh filename="tip.dae"/></geometry></visual>
      <collision><geometry><box size="1 1 1"/></geometry></collision>
      <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="hinge" type="continuous"><parent link="base"/><child link="tip"/></joint></robot>"#;
    fs::write(folder.path().join("arm.urdf"), arm).unwrap();
    kinetarium(&folder)
        .args("shot arm.urdf --size 64x40 --samples 1 --out shot.png".split(' '))
        .assert()
        .success()
        .stderr(contains("warning: arm.urdf:2: <mesh>").and(contains("tip.dae")));
    let (_, _, pixels) = picture(&folder.path().join("shot.png"));
    let colors: std::collections::HashSet<_> = pixels.chunks(3).collect();
    // The sky, and three faces of the box.
    assert!(colors.len() >= 4, "{}", colors.len());
}

/// As its convex hull, of the mass that its volume has, it falls on the ground and stays there.
#[test]
fn a_mesh_touches_as_its_hull() {
    let folder = folder();
    let rock = r#"<mujoco><asset><mesh name="rock" file="rock.obj" scale=".1 .1 .1"/></asset>
      <worldbody><geom type="plane" size="1 1 1"/>
      <body name="rock" pos="0 0 0.3" euler="20 10 0"><freejoint/><geom type="mesh" mesh="rock"/></body>
    </worldbody></mujoco>"#;
    let corners = "v 1 1 1\nv -1 -1 1\nv -1 1 -1\nv 1 -1 -1\n";
    let faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    fs::write(folder.path().join("rock.xml"), rock).unwrap();
    fs::write(folder.path().join("rock.obj"), corners.to_owned() + faces).unwrap();
    let mut command = kinetarium(&folder);
    let refused = command.args(["run", "rock.xml"]).assert().code(2);
    refused.stderr(contains("--meshes hull"));
    let mut command = kinetarium(&folder);
    let command = command.args(["run", "rock.xml", "--meshes", "hull", "--quiet"]);
    command.args(["--seconds", "2"]).assert().success();
    let (_, position) = array(
        &folder.path().join("kinetarium-out/rock.npz"),
        "body_position",
    );
    // A regular tetrahedron of edge √8 · 0.1 m lies on a face, with its centre a quarter of its
    // height above the ground: 0.1 / √3.
    let height = position[position.len() - 1];
    assert!((height - 0.1 / 3.0_f64.sqrt()).abs() < 1e-3, "{height}");
}

/// A ball in a smooth gutter of two triangles a side, sloping by 45°, lies √2 radii above its bottom, but for the
/// millimetre by which MuJoCo's standard softness gives way; on a body that slides along as well.
#[test]
fn a_mesh_touches_as_it_is() {
    let folder = folder();
    let gutter = |inside: &str| {
        format!(
            r#"<mujoco><asset><mesh name="gutter" file="gutter.obj"/></asset><worldbody>
            <body name="ball" pos="0.02 0 0.3"><freejoint/><geom size=".1" friction="0"/></body>
            <body>{inside}<geom name="gutter" type="mesh" mesh="gutter" friction="0"/></body>
            </worldbody></mujoco>"#
        )
    };
    let corners = "v -1 -1 1\nv -1 1 1\nv 0 -1 0\nv 0 1 0\nv 1 -1 1\nv 1 1 1\n";
    let faces = "f 1 3 2\nf 3 4 2\nf 3 5 4\nf 5 6 4\n";
    fs::write(folder.path().join("gutter.obj"), corners.to_owned() + faces).unwrap();
    let moves =
        r#"<joint type="slide" axis="0 1 0"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>"#;
    for (name, inside) in [("still", ""), ("moves", moves)] {
        fs::write(folder.path().join(format!("{name}.xml")), gutter(inside)).unwrap();
    }
    for name in ["still", "moves"] {
        let mut command = kinetarium(&folder);
        command
            .args(["run", &format!("{name}.xml")])
            .args(["--meshes", "exact", "--quiet", "--seconds", "4"])
            .assert()
            .success();
        let written = folder.path().join(format!("kinetarium-out/{name}.npz"));
        let (shape, position) = array(&written, "body_position");
        let last = &position[position.len() - 3 * shape[2] as usize..];
        assert!(
            last[0].abs() < 1e-3 && (last[2] - 0.1 * 2.0_f64.sqrt()).abs() < 2e-3,
            "{name}: {last:?}"
        );
    }
}

/// Width, height and pixels of a picture.
fn picture(path: &Path) -> (u32, u32, Vec<u8>) {
    let file = std::io::BufReader::new(File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    (info.width, info.height, pixels)
}

#[test]
fn a_shot_is_a_picture_of_the_scene_at_its_time() {
    let folder = folder();
    // From (0, −2, 1) towards the origin, as wide as pictures are without a camera of the file.
    let eye = r#"<worldbody><camera name="eye" pos="0 -2 1" xyaxes="1 0 0 0 1 2" fovy="34.377467707849395"/>"#;
    let eye = DOUBLE_PENDULUM.replace("<worldbody>", eye);
    fs::write(folder.path().join("eye.xml"), eye).unwrap();
    let mut shots = Vec::new();
    for options in [
        "shot dominoes",
        "shot dominoes --time 0.2",
        "shot double.xml --keyframe raised",
        "shot pendula --camera 0,-1,9:0,-1,0",
        "shot humanoid --time 0.3",
        "shot grid --time 0.3",
        "shot eye.xml --camera eye",
        "shot eye.xml --camera 0,-2,1:0,0,0",
        "shot eye.xml",
    ] {
        kinetarium(&folder)
            .args(options.split_whitespace())
            .args("--size 64x40 --samples 1 --out shot.png".split_whitespace())
            .assert()
            .success()
            .stdout(contains("64 × 40: shot.png"));
        let (width, height, pixels) = picture(&folder.path().join("shot.png"));
        assert_eq!((width, height, pixels.len()), (64, 40, 3 * 64 * 40));
        let colors: std::collections::HashSet<_> = pixels.chunks(3).collect();
        assert!(colors.len() > 12, "{options}: {}", colors.len());
        shots.push(pixels);
    }
    assert_ne!(shots[0], shots[1], "dominoes fall");
    // A world of the grid is the humanoid with random motors.
    assert_ne!(shots[4], shots[5], "motors move");
    assert_eq!(shots[6], shots[7], "the same camera");
    assert_ne!(shots[6], shots[8], "another camera");
}

/// It has no options for the solver, but `kinetarium run` does.
#[test]
fn a_shot_of_a_scene_that_diverges_ends_with_1() {
    let folder = folder();
    let fast = DOUBLE_PENDULUM.replace(r#"qvel="0 2""#, r#"qvel="0 1e8""#);
    fs::write(folder.path().join("fast.xml"), fast).unwrap();
    let options = "shot fast.xml --keyframe raised --time 0.1 --size 8x8";
    kinetarium(&folder)
        .args(options.split_whitespace())
        .assert()
        .code(1)
        .stderr(contains("diverged within 0.1 s: lower --time,").and(contains("kinetarium run")));
    assert!(!folder.path().join("picture.png").exists());
}

#[test]
fn a_shot_of_nothing_is_refused() {
    let folder = folder();
    for (options, message) in [
        ("shot domino", "no example `domino`; known are pendula"),
        ("shot none.xml", "none.xml: cannot be read"),
        ("shot tower --size 9", "write two numbers of pixels"),
        ("shot tower --size 0x9", "the camera's width is 0"),
        ("shot tower --camera 1,2,3", "write two points"),
        (
            "shot tower --camera 1,2,3:1,2,3",
            "give two, some way apart",
        ),
        ("shot tower --out tower.jpg", "ends in .png"),
        (
            "shot tower --camera eye",
            "no camera named \"eye\"; there are none",
        ),
        ("shot tower --time -1", "it must not be negative"),
        (
            "shot tower --device cuda",
            "known are cpu, auto, gpu, and gpu:NAME",
        ),
        // With cards and without.
        ("shot tower --device gpu:none", "graphics card"),
        (
            "shot double.xml --keyframe low",
            "there is no keyframe named \"low\"",
        ),
    ] {
        let arguments = options.split_whitespace();
        kinetarium(&folder)
            .args(arguments)
            .assert()
            .code(2)
            .stderr(contains(message));
        assert!(!folder.path().join("picture.png").exists(), "{options}");
    }
    // Told at once: no simulation has a billion seconds of time.
    let options = "shot tower --time 1e6 --out none/shot.png";
    kinetarium(&folder)
        .args(options.split_whitespace())
        .assert()
        .code(2)
        .stderr(contains("none/shot.png").and(contains("choose another with --out")));
}

#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn worlds_run_on_a_card_as_on_the_processor() {
    let folder = folder();
    let card = std::env::var("KINETARIUM_GPU").unwrap_or_default();
    let named = format!("gpu:{card}");
    let positions = [("cpu", ""), (&*named, &*card)].map(|(device, told)| {
        let run = "run double.xml --worlds 3 --seconds 0.2 --solver featherstone --keyframe raised";
        let mut command = kinetarium(&folder);
        command.args(run.split(' ')).args(["--device", device]);
        command.assert().success().stdout(contains(told));
        let npz = folder.path().join("kinetarium-out/double.npz");
        array(&npz, "joint_position")
    });
    let [(shape, here), (there, found)] = positions;
    assert_eq!(shape, there);
    let apart = here.iter().zip(&found).map(|(a, b)| (a - b).abs());
    let apart = apart.fold(0.0, f64::max);
    assert!(apart < 1e-4, "{apart:e}");
    assert!(here.iter().any(|x| x.abs() > 0.1));
}
