//! The `chordal` program.
use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(chordal_cli::run(std::env::args_os()))
}
