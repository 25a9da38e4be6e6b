//! The Python package.

use crate::page;
use crate::workshop::{LIBRARIES, Workshop};
use anyhow::{Result, ensure};
use std::path::{Path, PathBuf};
use xshell::cmd;

/// As users install it, from the folder of this repository.
pub fn check(workshop: &Workshop) -> Result<()> {
    let python = workshop.python_with_package()?;
    run_tests(workshop, &python, &[])?;
    let sh = &workshop.sh;
    cmd!(
        sh,
        "{python} -m pytest --quiet --doctest-modules --pyargs kinetarium"
    )
    .run()?;
    cmd!(sh, "{python} -m mypy.stubtest kinetarium._engine").run()?;
    // What only later releases of Python have is found, too.
    let oldest = "--python-version=3.10";
    Ok(cmd!(sh, "{python} -m mypy --strict {oldest} python/kinetarium").run()?)
}

/// Its tests with the oldest releases of what it needs.
pub fn with_oldest(workshop: &Workshop) -> Result<()> {
    run_tests(workshop, &workshop.python_of_the_oldest()?, &[])
}

/// Its tests that are skipped for want of torch and jax.
pub fn learn(workshop: &Workshop) -> Result<()> {
    let python = workshop.python_that_learns()?;
    // Several threads of torch wait for each other where something else runs, too.
    let tests = ["learning", "dlpack"].map(|name| format!("python/tests/test_{name}.py"));
    Ok(cmd!(workshop.sh, "{python} -m pytest --quiet {tests...}")
        .env("OMP_NUM_THREADS", "1")
        .run()?)
}

/// Its tests with an engine that finds overflows, broken preconditions of unsafe functions (as all that is compiled for
/// debugging does), and what is read or written beside the heap's allocations or after they are freed.
pub fn sanitize(workshop: &Workshop) -> Result<()> {
    let python = workshop.python_with_package()?;
    let folder = workshop.target().join("sanitizer");
    let package = folder.join("package");
    workshop.sh.remove_path(&package)?;
    workshop.sh.create_dir(&package)?;
    cmd!(workshop.sh, "cp -r python/kinetarium {package}").run()?;
    let engine = sanitized_engine(workshop, &folder)?;
    workshop
        .sh
        .copy_file(engine, package.join("kinetarium/_engine.abi3.so"))?;
    let watched = [
        ("PYTHONPATH", package),
        ("PYTHONMALLOC", "malloc".into()),
        ("LD_PRELOAD", sanitizer(workshop, &folder)?),
        // Python itself frees little when it ends.
        ("ASAN_OPTIONS", "detect_leaks=0".into()),
    ];
    run_tests(workshop, &python, &watched)
}

fn run_tests(workshop: &Workshop, python: &Path, environment: &[(&str, PathBuf)]) -> Result<()> {
    let sh = &workshop.sh;
    page::need_vulkan(workshop)?;
    cmd!(sh, "{python} -m pytest --quiet python/tests")
        .env("KINETARIUM_GPU", "llvmpipe")
        .envs(environment.iter().map(|(name, x)| (name, x)))
        .run()?;
    Ok(
        cmd!(sh, "{python} -m pytest --quiet python/tests/test_device.py")
            .env(LIBRARIES, workshop.cuda_driver()?)
            .env("KINETARIUM_GPU", "cuda")
            .envs(environment.iter().map(|(name, x)| (name, x)))
            .run()?,
    )
}

/// The engine with AddressSanitizer, an unstable option of the compiler.
///
/// The heap is watched, by calls; the stack is not: kernels become functions of thousands of variables, each of which
/// would be fenced in.
fn sanitized_engine(workshop: &Workshop, folder: &Path) -> Result<PathBuf> {
    let sh = &workshop.sh;
    let target = cmd!(sh, "rustc --print host-tuple").read()?;
    let flags = [
        "-C no-vectorize-slp",
        "-Z sanitizer=address",
        "-C llvm-args=-asan-stack=0",
        "-C llvm-args=-asan-instrumentation-with-call-threshold=0",
    ];
    // With a target named, what runs while compiling is compiled as ever.
    cmd!(
        sh,
        "cargo build --quiet --package kinetarium-python --target {target} --target-dir {folder}"
    )
    .env("RUSTC_BOOTSTRAP", "1")
    .env("RUSTFLAGS", flags.join(" "))
    .run()?;
    let engine = folder.join(target).join("debug/lib_engine.so");
    let needs = cmd!(sh, "nm --dynamic --undefined-only {engine}").read()?;
    ensure!(needs.contains("__asan_store"), "nothing watches {engine:?}");
    Ok(engine)
}

/// The library that the sanitizer's calls go to. The compiler brings it for programs only: with a part that starts
/// before all else, which a library cannot have.
fn sanitizer(workshop: &Workshop, folder: &Path) -> Result<PathBuf> {
    let sh = &workshop.sh;
    let libraries = cmd!(sh, "rustc --print target-libdir").read()?;
    let (parts, library) = (folder.join("sanitizer.a"), folder.join("libsanitizer.so"));
    cmd!(sh, "cp {libraries}/librustc-stable_rt.asan.a {parts}").run()?;
    cmd!(sh, "ar d {parts} asan_preinit.cpp.o").run()?;
    // Python's other packages throw exceptions, which it looks at: so it must know of them from the start.
    let others = ["-Wl,--no-as-needed", "-lstdc++", "-lm"];
    cmd!(
        sh,
        "cc -shared -o {library} -Wl,--whole-archive {parts} -Wl,--no-whole-archive {others...}"
    )
    .run()?;
    Ok(library)
}
