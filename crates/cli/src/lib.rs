//! The program `kinetarium`, to be run by whoever starts it: `main.rs`, or Python.

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
use std::ffi::OsString;

/// Runs the program with a command line, its name first; what went wrong is on standard error.
pub fn run_program(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(told) => {
            let told = arguments::with_tip(told);
            // Where nobody listens, nobody is told.
            let _ = told.print();
            return u8::try_from(told.exit_code()).unwrap_or(1);
        }
    };
    match execute(arguments) {
        Ok(()) => 0,
        Err(error) => {
            eprintln!("error: {error}");
            error.exit_code()
        }
    }
}

fn execute(arguments: Arguments) -> Result<(), Error> {
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
