//! Libraries of kernels have no test target, which would compile all of them once more. Their private modules with unit
//! tests are compiled by themselves, by a file in `tests/` that names their paths; a module that none names would
//! never be tested.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use serde::Deserialize;
use xshell::{Shell, cmd};

use crate::workshop::Workshop;

#[derive(Deserialize)]
pub struct Metadata {
    pub packages: Vec<Package>,
}

#[derive(Deserialize)]
pub struct Package {
    pub targets: Vec<Target>,
}

#[derive(Deserialize)]
pub struct Target {
    pub name: String,
    pub kind: Vec<String>,
    test: bool,
    src_path: PathBuf,
}

impl Metadata {
    /// What cargo knows of the packages here.
    pub fn read(sh: &Shell) -> Result<Self> {
        let metadata = cmd!(sh, "cargo metadata --format-version 1 --no-deps")
            .quiet()
            .read()?;
        serde_json::from_str(&metadata).context("cargo metadata is not what it was")
    }
}

/// Fails on unit tests that no target compiles.
pub fn check(workshop: &Workshop) -> Result<()> {
    let sh = &workshop.sh;
    for package in Metadata::read(sh)?.packages {
        for target in package.targets.iter().filter(|target| !target.test) {
            if target.kind.iter().any(|kind| kind == "lib") {
                check_library(sh, &target.src_path)?;
            }
        }
    }
    Ok(())
}

fn check_library(sh: &Shell, root: &Path) -> Result<()> {
    let source = root.parent().context("a library's root is in a folder")?;
    let tests = source.with_file_name("tests");
    let mut named = String::new();
    for file in sh.read_dir(tests)?.iter().filter(|path| path.is_file()) {
        named += &sh.read_file(file)?;
    }
    for file in files(sh, source)? {
        if sh.read_file(&file)?.contains("#[cfg(test)]") {
            let path = Path::new("../src").join(file.strip_prefix(source)?);
            ensure!(
                named.contains(&format!("#[path = \"{}\"]", path.display())),
                "nothing runs the unit tests of {}: name it in tests/, as crates/sim/tests/parts.rs does",
                file.display()
            );
        }
    }
    Ok(())
}

/// All files in a folder and in those in it.
fn files(sh: &Shell, folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for path in sh.read_dir(folder)? {
        if path.is_dir() {
            found.extend(files(sh, &path)?);
        } else {
            found.push(path);
        }
    }
    Ok(found)
}
