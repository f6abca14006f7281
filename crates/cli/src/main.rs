//! Command `amberfield`.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(amberfield_cli::command(std::env::args_os()))
}
