//! The program `kinetarium`.

#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    kinetarium_cli::run_program(std::env::args_os()).into()
}
