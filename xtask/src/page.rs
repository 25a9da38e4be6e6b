//! The page, and the engine in a browser.

use crate::workshop::Workshop;
use anyhow::{Context, Result, ensure};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use xshell::cmd;

/// Rust's name for a browser.
const BROWSER: &str = "wasm32-unknown-unknown";

/// Builds the engine for browsers; returns where it is.
pub fn engine(workshop: &Workshop) -> Result<PathBuf> {
    workshop.need_rust_target(BROWSER)?;
    cmd!(
        workshop.sh,
        "cargo build --quiet --release --package kinetarium-wasm --target {BROWSER}"
    )
    .run()?;
    let file = format!("{BROWSER}/release/kinetarium_wasm.wasm");
    Ok(workshop.target().join(file))
}

/// All examples do the same in a browser's engine as in scalars here, to the bit.
pub fn same_bits(workshop: &Workshop) -> Result<()> {
    let engine = engine(workshop)?;
    let sh = &workshop.sh;
    let there = cmd!(sh, "node xtask/frames.mjs {engine}").read()?;
    let frames = workshop.example("frames")?;
    let here = cmd!(sh, "{frames}")
        .env("KINETARIUM_ISA", "portable")
        .read()?;
    ensure!(there == here, "in a browser:\n{there}\nhere:\n{here}");
    Ok(())
}

/// Lints, types, unit tests, and a build that must equal the committed one.
pub fn check(workshop: &Workshop) -> Result<()> {
    let sh = &workshop.sh;
    let _inside = sh.push_dir("web");
    install(workshop)?;
    cmd!(sh, "npm run --silent lint").run()?;
    cmd!(sh, "npm run --silent test").run()?;
    // Beside the committed one, which the program holds: were that written anew, the program would be compiled anew.
    let built = workshop.target().join("page");
    cmd!(
        sh,
        "npm run --silent build -- --outDir {built} --emptyOutDir"
    )
    .run()?;
    ensure!(
        sh.read_file(built.join("index.html"))? == sh.read_file("dist/index.html")?,
        "web/dist is not what `npm run build` makes in web: commit the new one"
    );
    Ok(())
}

/// The page in a browser, with both kinds of engine.
pub fn browse(workshop: &Workshop) -> Result<()> {
    let sh = &workshop.sh;
    let engine = engine(workshop)?;
    let program = workshop.program()?;
    let _inside = sh.push_dir("web");
    install(workshop)?;
    cmd!(sh, "npm run --silent e2e -- --engine {engine}").run()?;
    let server = Server::start(&program)?;
    let url = &server.url;
    // The page is the same; what differs is how it is connected. The server has no card.
    let only = "^(?!.*card).*(load|hundred|slider|restart|rebuild|replicas|physics|two pages|scrub|save picture|reload|\
                keyboard|malformed|robot|program says)";
    Ok(cmd!(sh, "npm run --silent e2e -- --url {url} --only {only}").run()?)
}

/// Installs the packages that a folder's lock file names. Not with `npm ci`, which wants those of all other
/// systems to exist, too.
pub fn install(workshop: &Workshop) -> Result<()> {
    cmd!(
        workshop.sh,
        "npm install --silent --no-save --no-audit --no-fund"
    )
    .run()
    .context("npm packages could not be installed; is the package index reachable?")
}

/// Makes sure that there is a Vulkan driver, if only Mesa's that computes on the CPU.
pub fn need_vulkan(workshop: &Workshop) -> Result<()> {
    let drivers = Path::new("/usr/share/vulkan/icd.d");
    if std::fs::read_dir(drivers).is_ok_and(|mut found| found.next().is_some()) {
        return Ok(());
    }
    workshop.install("mesa-vulkan-drivers")
}

/// `kinetarium view`, until it is dropped.
struct Server {
    process: Child,
    url: String,
}

impl Server {
    fn start(program: &PathBuf) -> Result<Self> {
        let mut process = Command::new(program)
            .args(["view", "--no-browser", "--port", "0"])
            .stdout(Stdio::piped())
            .spawn()?;
        let out = process.stdout.take().context("its output was asked for")?;
        let mut url = String::new();
        BufReader::new(out).read_line(&mut url)?;
        let url = url.trim().to_owned();
        Ok(Self { process, url })
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // It may have ended by itself, which is as well.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
