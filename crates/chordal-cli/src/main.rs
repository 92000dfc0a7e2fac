//! The `chordal` program.
use std::process::ExitCode;

/// Before the runtime opens something in the place of a stdout that is closed.
#[cfg(unix)]
#[ctor::ctor]
fn look_at_stdout() {
    chordal_cli::look_at_stdout();
}

fn main() -> ExitCode {
    ExitCode::from(chordal_cli::run(std::env::args_os()))
}
