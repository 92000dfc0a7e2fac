//! The `chordal` command: translates arguments into verbs. It holds no geometry.
mod args;
mod clock;
mod common;
mod docs;
mod fault;
mod input;
mod inspect;
mod mesh;
mod numbers;
mod output;
mod render;
mod signal;
mod studio;
mod summary;
mod talk;

use args::{Cli, Verb};
use clap::Parser;
use clap::error::ErrorKind;
use fault::{Exit, Fault};
use serde_json::json;
use std::io::Write;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return refuse_arguments(&error),
    };
    let json = wants_json(&cli.verb);
    let done = match cli.verb {
        Verb::Mesh(args) => mesh::run(&args),
        Verb::Inspect(args) => inspect::run(&args),
        Verb::Render(args) => render::run(&args),
        Verb::Studio(args) => studio::run(&args),
        Verb::Completions { shell } => docs::completions(shell),
        Verb::Man { output } => docs::man(&output),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(fault) => fail(&fault, json),
    }
}

fn wants_json(verb: &Verb) -> bool {
    match verb {
        Verb::Mesh(args) => args.talk.json,
        Verb::Inspect(args) => args.talk.json,
        Verb::Render(args) => args.talk.json,
        Verb::Studio(_) | Verb::Completions { .. } | Verb::Man { .. } => false,
    }
}

/// Says what went wrong on stderr and, for programs, as an object on stdout, unless a report stands there already.
fn fail(fault: &Fault, json: bool) -> ExitCode {
    let _ = write!(std::io::stderr(), "{fault}");
    if json && !fault.reported {
        let error = json!({ "code": fault.code, "exit": fault.exit as u8, "messages": fault.lines });
        let report = json!({ "schema": chordal_verbs::report::SCHEMA, "error": error });
        let _ = writeln!(std::io::stdout(), "{report:#}");
    }
    ExitCode::from(fault.exit as u8)
}

/// Help goes to stdout with 0; anything else is one sentence and 2.
fn refuse_arguments(error: &clap::Error) -> ExitCode {
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        // A reader that has seen enough of the help closes the pipe, which is no failure.
        let _ = error.print();
        return ExitCode::SUCCESS;
    }
    if error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        let _ = error.print();
        return ExitCode::from(Exit::Usage as u8);
    }
    let shown = error.to_string();
    let sentence: Vec<&str> = shown
        .trim_start_matches("error: ")
        .lines()
        .take_while(|line| !line.trim().is_empty())
        .map(str::trim)
        .collect();
    let sentence = sentence.join(" ") + " (see --help)";
    let _ = write!(std::io::stderr(), "{}", Fault::usage(sentence));
    ExitCode::from(Exit::Usage as u8)
}
