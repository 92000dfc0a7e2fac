//! Completions and manual pages, generated from the definition of the command line.
use crate::cli::Cli;
use crate::console::print;
use crate::fault::{Fault, plainly};
use clap::CommandFactory;
use clap_complete::Shell;
use std::path::Path;

/// Prints the completion script of a shell.
pub fn completions(shell: Shell) -> Result<(), Fault> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "chordal", &mut script);
    print(&String::from_utf8_lossy(&script))
}

/// Writes `chordal.1` and one page per verb into `folder`.
pub fn man(folder: &Path) -> Result<(), Fault> {
    let written = std::fs::create_dir_all(folder)
        .and_then(|()| clap_mangen::generate_to(Cli::command().disable_help_subcommand(true), folder));
    written.map_err(|error| Fault::output("unwritable", format!("{}: {}", folder.display(), plainly(&error))))
}
