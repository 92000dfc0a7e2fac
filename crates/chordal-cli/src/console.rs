//! Messages and progress on stderr, reports on stdout.
use crate::args::ConsoleArgs;
use crate::fault::{Exit, Fault, plainly};
use crate::{signal, stdout_at_start};
use serde::Serialize;
use serde_json::json;
use std::borrow::Cow;
use std::io::{self, IsTerminal, Write};

/// The verbosity and the form of the output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Console {
    json: bool,
    level: Verbosity,
}

/// How many messages are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Verbosity {
    Errors,
    Usual,
    More,
}

/// The most warnings that are printed unless `-v` is given. Chosen: more would push other messages off a
/// screen.
const MOST_LINES: usize = 10;

impl Console {
    /// A console with the options of the command line.
    pub fn new(args: &ConsoleArgs) -> Self {
        let level = match (args.quiet, args.verbose) {
            (true, _) => Verbosity::Errors,
            (_, true) => Verbosity::More,
            _ => Verbosity::Usual,
        };
        Self { json: args.json, level }
    }

    /// Prints warnings, unless quiet: the first ten, or all if verbose.
    pub fn warn(&self, name: &str, warnings: &[impl ToString]) {
        let shown = if self.level == Verbosity::More { warnings.len() } else { MOST_LINES };
        for warning in warnings.iter().take(shown) {
            self.message(Verbosity::Usual, &format!("{name}: warning: {}", warning.to_string()));
        }
        if warnings.len() > shown {
            self.message(
                Verbosity::Usual,
                &format!("{name}: warning: and {} more; -v lists them", warnings.len() - shown),
            );
        }
    }

    /// Prints a sentence, unless quiet.
    pub fn say(&self, text: &str) {
        self.message(Verbosity::Usual, text);
    }

    /// Prints an error that does not end the command.
    #[cfg(not(target_family = "wasm"))]
    pub fn failure(&self, text: &str) {
        self.message(Verbosity::Errors, text);
    }

    /// Whether progress can be shown on stderr.
    pub fn shows_progress(&self) -> bool {
        self.level != Verbosity::Errors && io::stderr().is_terminal()
    }

    /// Prints a sentence only if verbose.
    pub fn detail(&self, text: &str) {
        self.message(Verbosity::More, text);
    }

    /// Writes to stderr; a failure is ignored, since it could be reported nowhere.
    fn message(&self, from: Verbosity, text: &str) {
        if self.level >= from {
            let _ = writeln!(io::stderr(), "chordal: {}", printable(text));
        }
    }

    /// Prints the report as JSON, or its summary for people, to stdout. The summary goes to stderr if the
    /// output itself goes to stdout.
    ///
    /// # Errors
    /// If stdout cannot be written.
    pub fn result(&self, report: &impl Serialize, summary: &str, stdout: StdoutUse) -> Result<(), Fault> {
        match (self.json, stdout) {
            // Serialized directly to text: a `Value` in between takes twenty times its bytes. It cannot fail,
            // since all keys of reports are strings.
            (true, _) => print(&format!("{}\n", serde_json::to_string_pretty(report).unwrap_or_default())),
            (false, _) if self.level == Verbosity::Errors => Ok(()),
            (false, StdoutUse::Free) => print(&printable(summary)),
            (false, StdoutUse::HoldsData) => {
                let _ = io::stderr().write_all(printable(summary).as_bytes());
                Ok(())
            }
        }
    }
}

/// Whether stdout is free for a summary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StdoutUse {
    /// Nothing else is written to stdout.
    Free,
    /// The output is written to stdout.
    HoldsData,
}

/// Writes to stdout; a pipe that was closed early is an error like any other.
pub fn print(text: &str) -> Result<(), Fault> {
    check_stdout()?;
    let mut stdout = io::stdout().lock();
    stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
        .map_err(|error| Fault::output("unwritable", format!("stdout: {}", plainly(&error))))
}

/// Prints an error to stderr and, with `--json`, as an object to stdout, unless a report was printed before.
/// Returns the exit code.
pub fn fail(fault: &Fault, json: bool) -> u8 {
    // Once the handler has printed that the command was interrupted, no other error may follow.
    let _ = signal::without_interruption(|| write!(std::io::stderr(), "{}", printable(&fault.to_string())));
    if json && !fault.reported {
        let _ = std::io::stdout().write_all(error_report(fault).as_bytes());
    }
    fault.exit as u8
}

/// An error as JSON.
fn error_report(fault: &Fault) -> String {
    let error = json!({ "code": fault.code, "exit": fault.exit as u8, "messages": fault.lines });
    let report = json!({ "schema": chordal_verbs::report::SCHEMA, "error": error });
    format!("{report:#}\n")
}

/// Prepares the JSON error for an abort: once memory has run out, a report cannot be built any more.
pub fn report_aborts() {
    let message = "out of memory or stack overflow: set a lower --max-memory, so that the job ends with the best result \
    so far";
    signal::say_of_aborts(error_report(&Fault::new(Exit::Budget, "out-of-memory", message)));
}

/// The text with control characters escaped: file names may contain escape sequences of terminals.
pub fn printable(text: &str) -> Cow<'_, str> {
    let is_control = |c: char| c.is_control() && c != '\n' && c != '\t';
    if !text.contains(is_control) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        if is_control(c) { escaped.extend(c.escape_default()) } else { escaped.push(c) }
    }
    Cow::Owned(escaped)
}

/// Checks that stdout can be written. `/dev/null` counts as writable, however it was opened.
///
/// # Errors
/// If the process was started with stdout closed, or open only for reading.
pub fn check_stdout() -> Result<(), Fault> {
    let fault = |why: &str| Err(Fault::output("unwritable", format!("stdout: {why}")));
    match (stdout_at_start::was_closed(), stdout_at_start::cannot_be_written()) {
        (true, _) => fault("it is closed"),
        (_, true) => fault("it is not open for writing"),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escape_sequences_are_shown_and_not_sent() {
        assert_eq!(printable("a\u{1b}[31mb\n\t\u{e9}"), "a\\u{1b}[31mb\n\t\u{e9}");
        assert!(matches!(printable("plain"), Cow::Borrowed(_)));
    }
}
