//! The program `kinetarium`.

#![forbid(unsafe_code)]

mod arguments;
mod energy;
mod error;
mod npz;
mod output;
mod plot;
mod robot;
mod run;
mod shot;
mod summary;
mod table;
mod trajectory;
mod view;

use arguments::{Arguments, Command, Pendula, View};
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
    let arguments = Arguments::parse();
    match arguments.command {
        Some(Command::View(_)) if arguments.headless => Err(Error::Headless),
        Some(Command::View(arguments)) => view::view(arguments),
        Some(Command::Run(arguments)) => run::robot(&arguments),
        Some(Command::Example(arguments)) => run::example(&arguments),
        Some(Command::Pendula(arguments)) => run::pendula(&arguments),
        Some(Command::Info(arguments)) => robot::info(&arguments),
        Some(Command::Shot(arguments)) => shot::shot(&arguments),
        None if arguments.headless => run::pendula(&Pendula::parse_from(["kinetarium"])),
        None => view::view(View::parse_from(["kinetarium"])),
    }
}
