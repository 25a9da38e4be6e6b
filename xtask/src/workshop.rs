//! The repository as a workplace: its root, the shell, and the tools that are installed on demand.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use xshell::{Shell, cmd};

/// What every command selects that compiles the engine for tests and examples. A crate has the features that all
/// packages selected ask for, and each set of features compiles the engine anew. What is measured beside Rapier has no
/// tests, and Rapier takes a minute and a half of a core to compile.
pub const ENGINE: [&str; 5] = [
    "--workspace",
    "--exclude",
    "kinetarium-collide",
    "--exclude",
    "kinetarium-bench-rapier",
];

/// What is left out there, too: by itself it has features that program and Python package do without.
pub const COLLIDE: [&str; 2] = ["--package", "kinetarium-collide"];

/// Where the dynamic linker looks for libraries.
pub const LIBRARIES: &str = "LD_LIBRARY_PATH";

/// A shell at the repository's root.
pub struct Workshop {
    pub sh: Shell,
    pub root: PathBuf,
}

impl Workshop {
    pub fn open() -> Result<Self> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .parent()
            .context("xtask lies in the repository's root")?;
        let sh = Shell::new()?;
        sh.change_dir(root);
        Ok(Self {
            sh,
            root: root.to_path_buf(),
        })
    }

    /// The folder cargo builds into.
    pub fn target(&self) -> PathBuf {
        std::env::var_os("CARGO_TARGET_DIR")
            .map_or_else(|| self.root.join("target"), |dir| self.root.join(dir))
    }

    /// Builds the program; returns where it is. With the features that the Python package asks for, so that what both
    /// are made of is compiled once; the package itself takes a minute, and `pip` compiles it with options of its own.
    pub fn program(&self) -> Result<PathBuf> {
        cmd!(
            self.sh,
            "cargo build --quiet --release --package kinetarium-cli --package kinetarium-python --bin kinetarium"
        )
        .run()?;
        Ok(self.target().join("release/kinetarium"))
    }

    /// Builds an example; returns where it is.
    pub fn example(&self, name: &str) -> Result<PathBuf> {
        cmd!(
            self.sh,
            "cargo build --quiet --release {ENGINE...} --example {name}"
        )
        .run()?;
        Ok(self.target().join("release/examples").join(name))
    }

    /// Makes sure that `program` can be run, by installing Debian's `package` where that is allowed.
    pub fn need_program(&self, program: &str, package: &str) -> Result<()> {
        if self.has(program) {
            return Ok(());
        }
        self.install(package).with_context(|| {
            format!("`{program}` is missing: install the Debian package `{package}`")
        })
    }

    /// Makes sure that the Rust standard library for `target` is there.
    pub fn need_rust_target(&self, target: &str) -> Result<()> {
        let libraries = cmd!(self.sh, "rustc --print target-libdir --target {target}")
            .quiet()
            .read()?;
        if Path::new(&libraries).is_dir() {
            return Ok(());
        }
        cmd!(self.sh, "rustup target add {target}").run().with_context(|| {
            format!("the Rust standard library for {target} is missing and rustup could not fetch it")
        })
    }

    /// The Python of a virtual environment with the pinned peers in it.
    pub fn peers_python(&self) -> Result<PathBuf> {
        self.environment("venv", "tests/peers/requirements.txt")
    }

    /// The Python of a virtual environment in `target/FOLDER`, made when missing or outdated, with what the file
    /// `requirements` pins.
    fn environment(&self, folder: &str, requirements: &str) -> Result<PathBuf> {
        let venv = self.root.join("target").join(folder);
        let python = venv.join("bin/python");
        let pinned = self.sh.read_file(requirements)?;
        let stamp = venv.join("requirements.txt");
        if self
            .sh
            .read_file(&stamp)
            .is_ok_and(|installed| installed == pinned)
        {
            return Ok(python);
        }
        self.need_program("python3", "python3")?;
        if cmd!(self.sh, "python3 -c 'import ensurepip'")
            .quiet()
            .ignore_stderr()
            .run()
            .is_err()
        {
            self.install("python3-venv")?;
        }
        cmd!(self.sh, "python3 -m venv --clear {venv}").run()?;
        cmd!(
            self.sh,
            "{python} -m pip install --quiet --disable-pip-version-check -r {requirements}"
        )
        .run()
        .with_context(|| {
            format!("{requirements} could not be installed; is the package index reachable?")
        })?;
        self.sh.write_file(&stamp, pinned)?;
        Ok(python)
    }

    /// The Python of the peers with the package of this repository, as users install it.
    pub fn python_with_package(&self) -> Result<PathBuf> {
        self.with_package(self.peers_python()?)
    }

    /// Another with the package, and with the oldest releases that it takes.
    pub fn python_of_the_oldest(&self) -> Result<PathBuf> {
        self.with_package(self.environment("oldest", "tests/oldest/requirements.txt")?)
    }

    /// Another with the package, with torch, jax and Stable-Baselines3.
    pub fn python_that_learns(&self) -> Result<PathBuf> {
        self.with_package(self.environment("learning", "tests/learning/requirements.txt")?)
    }

    fn with_package(&self, python: PathBuf) -> Result<PathBuf> {
        let quietly = ["--quiet", "--disable-pip-version-check"];
        cmd!(
            self.sh,
            "{python} -m pip install {quietly...} --force-reinstall --no-deps ."
        )
        .run()?;
        Ok(python)
    }

    /// The folder of what stands in for CUDA's driver and compiler: crates/cuda/tests/driver.
    pub fn cuda_driver(&self) -> Result<PathBuf> {
        let folder = self.sh.create_dir(self.root.join("target/cuda"))?;
        for library in ["cuda", "nvrtc"] {
            let source = format!("crates/cuda/tests/driver/{library}.cpp");
            let built = folder.join(format!("lib{library}.so"));
            let options = ["-std=c++17", "-O1", "-Wall", "-Wextra", "-Werror"];
            cmd!(
                self.sh,
                "g++ {options...} -fPIC -shared -o {built} {source}"
            )
            .run()?;
        }
        Ok(folder)
    }

    /// Writes MuJoCo's reference dynamics, one JSON file a model, and, in folders of their own, its
    /// falls, its derivatives of a step and its sensors; returns the folder of all.
    pub fn write_peers(&self) -> Result<PathBuf> {
        let python = self.peers_python()?;
        let folder = self.root.join("target/peers");
        cmd!(
            self.sh,
            "{python} tests/peers/reference_dynamics.py --out {folder}"
        )
        .run()?;
        cmd!(
            self.sh,
            "{python} tests/peers/falls.py --out {folder}/falls"
        )
        .run()?;
        cmd!(
            self.sh,
            "{python} tests/peers/transitions.py --out {folder}/transitions"
        )
        .run()?;
        cmd!(
            self.sh,
            "{python} tests/peers/sensors.py --out {folder}/sensors"
        )
        .run()?;
        Ok(folder)
    }

    fn has(&self, program: &str) -> bool {
        cmd!(self.sh, "which {program}")
            .quiet()
            .ignore_stdout()
            .ignore_stderr()
            .run()
            .is_ok()
    }

    pub fn install(&self, package: &str) -> Result<()> {
        if !self.has("apt-get") {
            bail!("there is no apt-get here");
        }
        let administrator = &self.as_administrator()?;
        let apt = [
            "env",
            "DEBIAN_FRONTEND=noninteractive",
            "apt-get",
            "--quiet",
        ];
        cmd!(self.sh, "env {administrator...} {apt...} update").run()?;
        let options = ["install", "--yes", "--no-install-recommends"];
        Ok(cmd!(
            self.sh,
            "env {administrator...} {apt...} {options...} {package}"
        )
        .run()?)
    }

    /// What to put before a command so that it runs with an administrator's rights.
    fn as_administrator(&self) -> Result<Vec<&'static str>> {
        match cmd!(self.sh, "id -u").quiet().read()?.as_str() {
            "0" => Ok(vec![]),
            _ if self.has("sudo") => Ok(vec!["sudo", "--non-interactive"]),
            _ => bail!("neither root nor sudo here"),
        }
    }
}
