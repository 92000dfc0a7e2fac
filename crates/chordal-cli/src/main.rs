//! The `chordal` program.
use std::process::ExitCode;

/// Runs before `main`: Rust's runtime opens `/dev/null` in place of a closed stdout.
#[cfg(unix)]
#[ctor::ctor]
fn look_at_stdout() {
    chordal_cli::look_at_stdout();
}

fn main() -> ExitCode {
    ExitCode::from(chordal_cli::run(std::env::args_os()))
}
