//! The program `kinetarium`.

#![forbid(unsafe_code)]

mod arguments;
mod energy;
mod error;
mod npz;
mod output;
mod perturb;
mod plot;
mod robot;
mod run;
mod shot;
mod summary;
mod table;
mod trajectory;

use arguments::{Arguments, Command, Pendula};
use clap::Parser;
use error::Error;
use std::process::ExitCode;

fn main() -> ExitCode {
    match execute() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            error.exit_code()
        }
    }
}

fn execute() -> Result<(), Error> {
    match Arguments::parse().command {
        Some(Command::Run(arguments)) => run::robot(&arguments),
        Some(Command::Example(arguments)) => run::example(&arguments),
        Some(Command::Pendula(arguments)) => run::pendula(&arguments),
        Some(Command::Info(arguments)) => robot::info(&arguments),
        Some(Command::Shot(arguments)) => shot::shot(&arguments),
        None => run::pendula(&Pendula::parse_from(["kinetarium"])),
    }
}
