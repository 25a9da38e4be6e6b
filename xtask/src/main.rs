//! `cargo xtask`: tests, benchmarks and checks of the whole repository.
#![forbid(unsafe_code)]

mod asm;
mod bench;
mod stages;
mod test;
mod workshop;

use std::process::ExitCode;

use anyhow::{Result, bail};
use workshop::Workshop;

const HELP: &str = "\
Usage: cargo xtask COMMAND

  test [--list] [STAGE…]   install what is missing, then run every stage (or only those named)
  bench [--repetitions N]  measure beside MuJoCo and Rapier and rewrite the tables in BENCHMARKS.md
  asm                      disassemble the SIMD entries of the release program; fail on stray calls
  peers                    write MuJoCo's reference dynamics to target/peers
  help                     print this text";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &[&str]) -> Result<()> {
    let workshop = Workshop::open()?;
    match arguments {
        ["test", "--list"] => test::list(),
        ["test", names @ ..] => test::run(&workshop, names)?,
        ["bench"] => bench::run(&workshop, bench::DEFAULT_REPETITIONS)?,
        ["bench", "--repetitions", count] => bench::run(&workshop, count.parse()?)?,
        ["asm"] => asm::check(&workshop)?,
        ["peers"] => println!("{}", workshop.write_peers()?.display()),
        ["help" | "--help" | "-h"] | [] => println!("{HELP}"),
        other => bail!("unknown command `{}`\n\n{HELP}", other.join(" ")),
    }
    Ok(())
}
