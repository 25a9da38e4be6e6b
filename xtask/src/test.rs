//! `cargo xtask test`: everything that must hold, in order of cost.

use anyhow::{Result, ensure};
use xshell::cmd;

use crate::asm;
use crate::docs;
use crate::page;
use crate::python;
use crate::stages::{self, Stage};
use crate::units::{self, Metadata};
use crate::workshop::{COLLIDE, ENGINE, LIBRARIES, Workshop};

const NEON: &str = "aarch64-unknown-linux-musl";
const WASM: &str = "wasm32-wasip1";

const STAGES: &[Stage] = &[
    Stage {
        name: "tools",
        purpose: "install what is missing",
        run: tools,
    },
    Stage {
        name: "format",
        purpose: "rustfmt on Rust, ruff on Python",
        run: format,
    },
    Stage {
        name: "clippy",
        purpose: "no warning in any target",
        run: clippy,
    },
    Stage {
        name: "test",
        purpose: "unit and integration tests; fuzz corpora",
        run: test,
    },
    Stage {
        name: "peers",
        purpose: "loading, dynamics, derivatives, falls and sensors of gymnasium's models, against MuJoCo",
        run: peers,
    },
    Stage {
        name: "doc",
        purpose: "documentation builds without warnings, its examples run",
        run: doc,
    },
    Stage {
        name: "neon",
        purpose: "numbers on aarch64 under qemu",
        run: neon,
    },
    Stage {
        name: "wasm",
        purpose: "numbers on wasm32 with simd128 under Node; the engine for browsers, bit for bit",
        run: wasm,
    },
    Stage {
        name: "page",
        purpose: "lints and tests of the page; what is committed is what is built",
        run: page::check,
    },
    Stage {
        name: "cameras",
        purpose: "a graphics card sees what rays see, if only Mesa's on the CPU",
        run: cameras,
    },
    Stage {
        name: "gpu",
        purpose: "a graphics card steps worlds as the CPU does, if only Mesa's on the CPU",
        run: gpu,
    },
    Stage {
        name: "cuda",
        purpose: "the same by CUDA, bit for bit, with a driver that computes on the CPU; NVRTC takes the kernels",
        run: cuda,
    },
    Stage {
        name: "browser",
        purpose: "the page in Chromium, before a server and with an engine of its own, on a card too",
        run: page::browse,
    },
    Stage {
        name: "asm",
        purpose: "no stray call in the SIMD entries",
        run: asm::check,
    },
    Stage {
        name: "docs",
        purpose: "the documentation is built, its links hold, and its examples run in Chromium",
        run: docs,
    },
    Stage {
        name: "python",
        purpose: "`pip install .`, its tests, its docstrings' examples, its types",
        run: python::check,
    },
    Stage {
        name: "program",
        purpose: "the built-in example, and a file it has not seen",
        run: program,
    },
    Stage {
        name: "examples",
        purpose: "every example runs",
        run: examples,
    },
];

/// Run only when they are named.
const BY_NAME: &[Stage] = &[
    Stage {
        name: "learning",
        purpose: "Stable-Baselines3 and the example that learns, with torch (5 GB), and arrays shared with torch and jax: only when named",
        run: python::learn,
    },
    Stage {
        name: "oldest",
        purpose: "the Python package's tests with the oldest NumPy, Gymnasium and Matplotlib: only when named",
        run: python::with_oldest,
    },
    Stage {
        name: "sanitizer",
        purpose: "the Python package's tests with an engine that watches its memory: only when named",
        run: python::sanitize,
    },
];

pub fn list() {
    for stage in STAGES.iter().chain(BY_NAME) {
        println!("{:<10} {}", stage.name, stage.purpose);
    }
}

pub fn run(workshop: &Workshop, names: &[&str]) -> Result<()> {
    stages::run(STAGES, BY_NAME, names, workshop)
}

fn tools(workshop: &Workshop) -> Result<()> {
    workshop.need_program("qemu-aarch64", "qemu-user")?;
    workshop.need_program("node", "nodejs")?;
    workshop.need_program("npm", "npm")?;
    workshop.need_program("chromium", "chromium")?;
    workshop.need_program("objdump", "binutils")?;
    workshop.need_program("g++", "g++")?;
    workshop.need_rust_target(NEON)?;
    workshop.need_rust_target(WASM)?;
    workshop.peers_python()?;
    Ok(())
}

fn format(workshop: &Workshop) -> Result<()> {
    let sh = &workshop.sh;
    let python = workshop.peers_python()?;
    cmd!(sh, "cargo fmt --all --check").run()?;
    cmd!(sh, "{python} -m ruff check .").run()?;
    Ok(cmd!(sh, "{python} -m ruff format --check .").run()?)
}

fn clippy(workshop: &Workshop) -> Result<()> {
    let sh = &workshop.sh;
    // The program without features, as most build it: within the workspace, others switch them on.
    cmd!(sh, "cargo clippy --quiet -- --deny warnings").run()?;
    Ok(cmd!(
        sh,
        "cargo clippy --quiet --workspace --all-targets -- --deny warnings"
    )
    .run()?)
}

/// Tests that need MuJoCo's references are ignored elsewhere.
fn peers(workshop: &Workshop) -> Result<()> {
    let references = workshop.write_peers()?;
    Ok(cmd!(
        workshop.sh,
        "cargo test --quiet --release {ENGINE...} --test mujoco --test solvers --test endurance -- --ignored"
    )
    .env("KINETARIUM_PEERS", &references)
    .run()?)
}

fn test(workshop: &Workshop) -> Result<()> {
    units::check(workshop)?;
    cargo_test(workshop, &["--lib", "--bins", "--tests"])
}

fn doc(workshop: &Workshop) -> Result<()> {
    cmd!(workshop.sh, "cargo doc --quiet --workspace --no-deps")
        .env("RUSTDOCFLAGS", "--deny warnings")
        .run()?;
    cargo_test(workshop, &["--doc"])
}

/// Tests of such targets in every package.
fn cargo_test(workshop: &Workshop, targets: &[&str]) -> Result<()> {
    let sh = &workshop.sh;
    cmd!(sh, "cargo test --quiet --release {ENGINE...} {targets...}").run()?;
    Ok(cmd!(sh, "cargo test --quiet --release {COLLIDE...} {targets...}").run()?)
}

/// The musl target links with Rust's own linker and libraries, so no cross compiler is needed.
fn neon(workshop: &Workshop) -> Result<()> {
    let sh = &workshop.sh;
    Ok(cmd!(
        sh,
        "cargo test --quiet --package kinetarium-numbers --lib --tests --target {NEON}"
    )
    .env("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_MUSL_LINKER", "rust-lld")
    .env(
        "CARGO_TARGET_AARCH64_UNKNOWN_LINUX_MUSL_RUNNER",
        "qemu-aarch64",
    )
    .run()?)
}

/// A failing assertion aborts there, and captured output would be lost with it.
fn wasm(workshop: &Workshop) -> Result<()> {
    let runner = format!(
        "node --no-warnings {}",
        workshop.root.join("xtask/wasi.mjs").display()
    );
    cmd!(
        workshop.sh,
        "cargo test --quiet --package kinetarium-numbers --lib --tests --target {WASM} -- --nocapture"
    )
    .env("CARGO_TARGET_WASM32_WASIP1_RUNNER", runner)
    .env(
        "CARGO_TARGET_WASM32_WASIP1_RUSTFLAGS",
        "-Ctarget-feature=+simd128",
    )
    .run()?;
    page::same_bits(workshop)
}

fn cameras(workshop: &Workshop) -> Result<()> {
    page::need_vulkan(workshop)?;
    Ok(cmd!(
        workshop.sh,
        "cargo test --quiet --release {ENGINE...} --features kinetarium-render/gpu --test gpu --test ray_caster"
    )
    .env("KINETARIUM_GPU", "llvmpipe")
    .run()?)
}

/// What is left out on Mesa's driver: it takes 40 s and more to compile each but the last, and the others have most of their
/// kernels; the last does not agree there (ARCHITECTURE.md, "Graphics cards"). CUDA's stand-in takes all.
const NOT_ON_MESA: [&str; 16] = [
    "agreement::stones",
    "piles::solids_on_meshes",
    "piles::meshes_on_meshes",
    "scenes::collide",
    "scenes::dominoes",
    "scenes::room",
    "scenes::tower",
    "scenes::pyramid",
    "scenes::card_house",
    "scenes::arch",
    "scenes::pile",
    "scenes::ant",
    "scenes::humanoid",
    "scenes::linkage",
    "scenes::rover",
    "scenes::terrain",
];

/// On the one card that every machine has.
fn gpu(workshop: &Workshop) -> Result<()> {
    page::need_vulkan(workshop)?;
    let skipped = NOT_ON_MESA.map(|test| ["--skip", test]);
    let skipped = skipped.as_flattened();
    Ok(cmd!(
        workshop.sh,
        "cargo test --quiet --release {ENGINE...} --lib --test cards --test program -- --ignored {skipped...}"
    )
    .env("KINETARIUM_GPU", "llvmpipe")
    // What is compiled runs for a moment: better soon than fast.
    .env("GALLIVM_PERF", "nopt")
    // Two tests run side by side, each in a thread of its own: where threads of both meet, they take three times as long.
    .env("LP_NUM_THREADS", "1")
    .run()?)
}

/// Tests of piles on what stands in for CUDA's driver: g++ compiles all kernels for each of them, half a minute long.
const PILES_BY_CUDA: [&str; 5] = [
    "piles::a_world_that_diverges_harms_no_other",
    "piles::joints_agree_with_the_processor",
    "piles::solids_on_meshes",
    "piles::meshes_on_meshes",
    "reports::what_is_told_of_joints_is_what_the_processor_tells",
];

fn cuda(workshop: &Workshop) -> Result<()> {
    let sh = &workshop.sh;
    let driver = workshop.cuda_driver()?;
    for (targets, filters) in [
        (
            &["--test", "nvidia", "--test", "lost"][..],
            &["--skip", "piles::", "--skip", "reports::"][..],
        ),
        (&["--test", "nvidia"], &PILES_BY_CUDA),
    ] {
        cmd!(
            sh,
            "cargo test --quiet --release {ENGINE...} {targets...} -- --ignored {filters...}"
        )
        .env(LIBRARIES, &driver)
        .run()?;
    }
    let python = workshop.peers_python()?;
    let compiler = cmd!(sh, "{python} -c")
        .arg("import nvidia.cuda_nvrtc as nvrtc; print(nvrtc.__path__[0] + '/lib')")
        .read()?;
    Ok(cmd!(
        sh,
        "cargo test --quiet --release {ENGINE...} --test nvrtc -- --ignored"
    )
    .env(LIBRARIES, compiler)
    .run()?)
}

fn docs(workshop: &Workshop) -> Result<()> {
    let site = docs::build(workshop)?;
    docs::check(workshop, &site)
}

/// Runs the program as a newcomer would, in an empty folder, and expects its files and exit codes.
fn program(workshop: &Workshop) -> Result<()> {
    let sh = &workshop.sh;
    let kinetarium = workshop.program()?;
    let python = workshop.peers_python()?;
    let humanoid = cmd!(sh, "{python} -c")
        .arg("import gymnasium, pathlib; print(pathlib.Path(gymnasium.__file__).parent / 'envs/mujoco/assets/humanoid.xml')")
        .read()?;

    let folder = sh.create_dir(workshop.root.join("target/program"))?;
    sh.remove_path(&folder)?;
    let folder = sh.create_dir(folder)?;
    let _inside = sh.push_dir(&folder);
    cmd!(sh, "{kinetarium} --headless").run()?;
    cmd!(
        sh,
        "{kinetarium} shot {humanoid} --time 0.3 --out humanoid.png"
    )
    .run()?;
    cmd!(
        sh,
        "{kinetarium} run {humanoid} --worlds 64 --seconds 1 --solver featherstone --threads 2"
    )
    .run()?;
    let reader = workshop.root.join("tests/peers/read_trajectory.py");
    let trajectories = ["pendula", "humanoid"].map(|run| format!("kinetarium-out/{run}.npz"));
    cmd!(sh, "{python} {reader} {trajectories...}").run()?;
    let wrong = cmd!(sh, "{kinetarium} run missing.xml")
        .ignore_status()
        .ignore_stderr()
        .output()?;
    ensure!(
        wrong.status.code() == Some(2),
        "a missing file ended with {}, not with exit code 2",
        wrong.status
    );
    Ok(())
}

fn examples(workshop: &Workshop) -> Result<()> {
    let sh = &workshop.sh;
    for package in Metadata::read(sh)?.packages {
        for example in package
            .targets
            .iter()
            .filter(|target| target.kind.iter().any(|kind| kind == "example"))
        {
            let example = workshop.example(&example.name)?;
            cmd!(sh, "{example}").run()?;
        }
    }
    Ok(())
}
