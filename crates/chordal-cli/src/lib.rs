//! The `chordal` command: translates arguments into verbs. It holds no geometry.
//!
//! It is a library so that the program of this crate and that of the Python package are the same.
mod args;
mod bake;
#[cfg(not(target_family = "wasm"))]
mod batch;
mod beside;
mod boolean;
mod carried;
mod cli;
mod clock;
mod console;
mod convert;
mod deadline;
mod deviation;
mod docs;
mod execution;
mod fault;
mod folder;
mod folder_lock;
mod host;
mod input;
mod inspect;
mod inspect_text;
mod language;
mod line_costs;
mod load;
mod lod;
pub mod memory;
mod mend;
mod mesh;
mod numbers;
mod options;
mod output;
mod output_folder;
mod output_format;
mod output_set;
mod output_set_write;
mod output_write;
mod overwrite;
mod program;
mod progress;
mod render;
mod require;
#[cfg(not(target_family = "wasm"))]
mod signal;
#[cfg(target_family = "wasm")]
#[path = "no_signal.rs"]
mod signal;
pub mod spelling;
mod stdout_at_start;
#[cfg(not(target_family = "wasm"))]
mod studio;
mod summary;
mod temp_output;
mod threads;
mod verb_run;
mod verify;
mod volume;
mod volume_text;
mod watch;

#[cfg(not(target_family = "wasm"))]
use batch::BatchCommand;
pub use beside::read_beside;
use clap::Parser;
use clap::error::ErrorKind;
use cli::{Cli, Verb};
use fault::{Exit, Fault};
pub use program::Program;
use std::ffi::OsString;
use std::io::Write;
pub use stdout_at_start::look_at_stdout;

/// Runs the command with these arguments, of which the first is the program's name, and returns the exit
/// code.
///
/// It takes over the process: it writes to stdout and stderr, and once a verb has started, SIGINT and SIGTERM
/// end the process with 130.
pub fn run(args: impl IntoIterator<Item = OsString>) -> u8 {
    run_started_by(args, &Program::own())
}

/// As [`run`], with the words that start the command again, which `batch` does for each file.
#[cfg_attr(target_family = "wasm", expect(unused_variables, reason = "there is no batch"))]
pub fn run_started_by(args: impl IntoIterator<Item = OsString>, program: &Program) -> u8 {
    // First, since a file that is opened earlier could get the descriptor of a closed stdout.
    look_at_stdout();
    // Before parsing, since parsing allocates and may abort.
    signal::end_aborts_with_a_code();
    let cli = match Cli::try_parse_from(args) {
        Ok(cli) => cli,
        Err(error) => return refuse_arguments(&error),
    };
    let json = wants_json(&cli.verb);
    if json {
        console::report_aborts();
    }
    let result = threads::run_verb(|| match cli.verb {
        Verb::Mesh(args) if args.watch => watch::run(&args),
        Verb::Mesh(args) => mesh::run(&args),
        Verb::Lod(args) => lod::run(&args),
        Verb::Inspect(args) => inspect::run(&args),
        Verb::Deviation(args) => deviation::run(&args),
        Verb::Verify(args) => verify::run(&args),
        Verb::Mend(args) => mend::run(&args),
        Verb::Bake(args) => bake::run(&args),
        Verb::Convert(args) => convert::run(&args),
        Verb::Render(args) => render::run(&args),
        #[cfg(not(target_family = "wasm"))]
        Verb::Batch(args) => batch::run(&args, BatchCommand { program, check: &check_words }),
        #[cfg(not(target_family = "wasm"))]
        Verb::Studio(args) => studio::run(&args),
        Verb::Language(args) => language::run(&args),
        Verb::Completions { shell } => docs::completions(shell),
        Verb::Man { output } => docs::man(&output),
    });
    match result {
        Ok(()) => 0,
        Err(fault) => console::fail(&fault, json),
    }
}

fn wants_json(verb: &Verb) -> bool {
    match verb {
        Verb::Mesh(args) => args.console.json,
        Verb::Lod(args) => args.console.json,
        Verb::Inspect(args) => args.console.json,
        Verb::Deviation(args) => args.console.json,
        Verb::Verify(args) => args.console.json,
        Verb::Mend(args) => args.console.json,
        Verb::Bake(args) => args.console.json,
        Verb::Convert(args) => args.console.json,
        Verb::Render(args) => args.console.json,
        #[cfg(not(target_family = "wasm"))]
        Verb::Batch(args) => args.console.json,
        #[cfg(not(target_family = "wasm"))]
        Verb::Studio(_) => false,
        Verb::Language(args) => args.json,
        Verb::Completions { .. } | Verb::Man { .. } => false,
    }
}

/// Prints help to stdout and returns 0; for an error prints one sentence and returns 2.
fn refuse_arguments(error: &clap::Error) -> u8 {
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        // A pager may close the pipe early, which is no failure.
        let _ = error.print();
        return 0;
    }
    if error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        let _ = error.print();
        return Exit::Usage as u8;
    }
    let _ = write!(std::io::stderr(), "{}", Fault::usage(sentence_of(error)));
    Exit::Usage as u8
}

fn sentence_of(error: &clap::Error) -> String {
    let message = error.to_string();
    let sentence: Vec<&str> = message
        .trim_start_matches("error: ")
        .lines()
        .take_while(|line| !line.trim().is_empty())
        .map(str::trim)
        .collect();
    sentence.join(" ") + " (see --help)"
}

/// Refuses words that are not a valid command line of a batch.
#[cfg(not(target_family = "wasm"))]
fn check_words(words: Vec<OsString>) -> Result<(), Fault> {
    let cli = Cli::try_parse_from(words).map_err(|error| match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            Fault::usage("--help and --version cannot be options of a batch: run the verb with them")
        }
        _ => Fault::usage(sentence_of(&error)),
    })?;
    match cli.verb {
        Verb::Mesh(args) if args.watch => {
            Err(Fault::usage("--watch never ends, so it cannot be an option of a batch"))
        }
        _ => Ok(()),
    }
}
