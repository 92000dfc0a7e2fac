//! What is said while working and afterwards: messages and progress on stderr, reports on stdout.
use crate::args::ConsoleArgs;
use crate::fault::{Exit, Fault, plainly};
use crate::{signal, stdout_at_start};
use serde::Serialize;
use serde_json::json;
use std::borrow::Cow;
use std::io::{self, IsTerminal, Write};

/// How much is said, and in which form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Console {
    json: bool,
    level: Verbosity,
}

/// How much is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Verbosity {
    Errors,
    Usual,
    More,
}

/// The most warning lines of one kind that are shown.
const MOST_LINES: usize = 10;

impl Console {
    /// As the command line says.
    pub fn new(args: &ConsoleArgs) -> Self {
        let level = match (args.quiet, args.verbose) {
            (true, _) => Verbosity::Errors,
            (_, true) => Verbosity::More,
            _ => Verbosity::Usual,
        };
        Self { json: args.json, level }
    }

    /// Warnings, unless quiet; the first ten, or all when more is to be said.
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

    /// A sentence, unless quiet.
    pub fn say(&self, text: &str) {
        self.message(Verbosity::Usual, text);
    }

    /// Something that went wrong while other things go on.
    #[cfg(not(target_family = "wasm"))]
    pub fn failure(&self, text: &str) {
        self.message(Verbosity::Errors, text);
    }

    /// Whether progress can be shown on stderr.
    pub fn shows_progress(&self) -> bool {
        self.level != Verbosity::Errors && io::stderr().is_terminal()
    }

    /// Something that only those who asked for more want to know.
    pub fn detail(&self, text: &str) {
        self.message(Verbosity::More, text);
    }

    /// To stderr. When that is closed there is nobody to tell.
    fn message(&self, from: Verbosity, text: &str) {
        if self.level >= from {
            let _ = writeln!(io::stderr(), "chordal: {}", printable(text));
        }
    }

    /// The result: the report as JSON, or its summary for people, on stdout; the summary goes to stderr where
    /// the data itself is on stdout.
    ///
    /// # Errors
    /// When stdout cannot be written.
    pub fn result(&self, report: &impl Serialize, summary: &str, stdout: StdoutUse) -> Result<(), Fault> {
        match (self.json, stdout) {
            // Text at once: the same as values in memory takes twenty times its bytes. Reports have texts as keys.
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
    /// Nothing else goes there.
    Free,
    /// The output goes there.
    HoldsData,
}

/// Writes to stdout; a pipe that closed early is a fault like any other.
pub fn print(text: &str) -> Result<(), Fault> {
    check_stdout()?;
    let mut stdout = io::stdout().lock();
    stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
        .map_err(|error| Fault::output("unwritable", format!("stdout: {}", plainly(&error))))
}

/// Says what went wrong on stderr and, for programs, as an object on stdout, unless a report stands there
/// already.
pub fn fail(fault: &Fault, json: bool) -> u8 {
    let _ = signal::without_interruption(|| write!(std::io::stderr(), "{}", printable(&fault.to_string())));
    if json && !fault.reported {
        let _ = std::io::stdout().write_all(error_report(fault).as_bytes());
    }
    fault.exit as u8
}

/// What went wrong, as an object for programs.
fn error_report(fault: &Fault) -> String {
    let error = json!({ "code": fault.code, "exit": fault.exit as u8, "messages": fault.lines });
    let report = json!({ "schema": chordal_verbs::report::SCHEMA, "error": error });
    format!("{report:#}\n")
}

/// Prepares what programs read where the system has no memory left: then none is left to write a report with.
pub fn report_aborts() {
    let message = "the system gave no more memory, or a stack ran over: allow less with --max-memory, so that the job ends with \
        the best that it has";
    signal::say_of_aborts(error_report(&Fault::new(Exit::Budget, "out-of-memory", message)));
}

/// The text without what terminals obey: names of files may hold escape sequences.
pub fn printable(text: &str) -> Cow<'_, str> {
    let is_control = |c: char| c.is_control() && c != '\n' && c != '\t';
    if !text.contains(is_control) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if is_control(c) { shown.extend(c.escape_default()) } else { shown.push(c) }
    }
    Cow::Owned(shown)
}

/// Fails where the process was started with stdout closed, or open only for reading. What goes to `/dev/null` was
/// written, however that is open.
///
/// # Errors
/// Then.
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
