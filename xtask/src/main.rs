//! `cargo xtask`: tests, benchmarks and checks of the whole repository.
#![forbid(unsafe_code)]

mod asm;
mod bench;
mod docs;
mod page;
mod python;
mod stages;
mod test;
mod units;
mod workshop;

use std::process::ExitCode;

use anyhow::{Result, bail};
use bench::Group;
use workshop::Workshop;

const HELP: &str = "\
Usage: cargo xtask COMMAND

  test [--list] [STAGE…]   install what is missing, then run every stage (or only those named)
  bench [robots|piles|queries|cameras|page|python] [--repetitions N]
                           measure robots beside MuJoCo, piles beside Rapier, cameras, the page, and Python, or one
                           of them, and rewrite the tables in BENCHMARKS.md
  gpu-bench [--device gpu|gpu:NAME|cuda|cuda:NUMBER] [--worlds COUNT,COUNT…] [--only SCENES]
                           measure a graphics card, and tell where the program is that another machine can run
  asm                      disassemble the SIMD entries of the release program; fail on stray calls
  docs [--check]           build the documentation into target/site, with live examples; look at it in Chromium
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
        ["gpu-bench", options @ ..] => bench::gpu(&workshop, options)?,
        ["bench", options @ ..] => {
            let named = |name: &str| Group::ALL.into_iter().find(|group| group.name() == name);
            let (groups, rest) = match options {
                [name, rest @ ..] if named(name).is_some() => {
                    (named(name).into_iter().collect(), rest)
                }
                rest => (Group::ALL.to_vec(), rest),
            };
            let repetitions = match rest {
                [] => bench::DEFAULT_REPETITIONS,
                ["--repetitions", count] => count.parse()?,
                other => bail!("unknown options `{}` of bench\n\n{HELP}", other.join(" ")),
            };
            bench::run(&workshop, &groups, repetitions)?;
        }
        ["asm"] => asm::check(&workshop)?,
        ["docs"] => println!("{}", docs::build(&workshop)?.display()),
        ["docs", "--check"] => docs::check(&workshop, &docs::build(&workshop)?)?,
        ["peers"] => println!("{}", workshop.write_peers()?.display()),
        ["help" | "--help" | "-h"] | [] => println!("{HELP}"),
        other => bail!("unknown command `{}`\n\n{HELP}", other.join(" ")),
    }
    Ok(())
}
