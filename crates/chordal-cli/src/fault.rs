//! `Fault`: an error that ends the command, with lines for people and an exit code for programs.
use chordal_verbs::MeshFailure;
use std::fmt;

/// The exit codes. They are part of the interface: scripts test them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// A check failed.
    CheckFailed = 1,
    /// The command line is invalid.
    Usage = 2,
    /// The input cannot be read, or is not supported.
    Input = 3,
    /// The output cannot be written.
    Output = 4,
    /// The budget was not met, or cannot be.
    Budget = 5,
    /// A claim of a certificate was neither re-proved nor refuted.
    NotProved = 6,
    /// A signal stopped the command.
    Interrupted = 130,
}

/// The most error lines that are printed. Chosen: more would push the first off a screen.
const MOST_LINES: usize = 10;

/// One or more sentences and the exit code.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The exit code.
    pub exit: Exit,
    /// Stable, for programs, as in "index-out-of-range".
    pub code: &'static str,
    /// One sentence each, as in `teapot.bpt: line 3: …`.
    pub lines: Vec<String>,
    /// Whether a report was printed to stdout before, as for a failed check or with `--keep-best`.
    pub reported: bool,
}

impl Fault {
    /// A fault of one sentence.
    pub fn new(exit: Exit, code: &'static str, line: impl Into<String>) -> Self {
        Self { exit, code, lines: vec![line.into()], reported: false }
    }

    /// An invalid command line.
    pub fn usage(line: impl Into<String>) -> Self {
        Self::new(Exit::Usage, "usage", line)
    }

    /// An input that cannot be read.
    pub fn input(code: &'static str, line: impl Into<String>) -> Self {
        Self::new(Exit::Input, code, line)
    }

    /// An output that cannot be written.
    pub fn output(code: &'static str, line: impl Into<String>) -> Self {
        Self::new(Exit::Output, code, line)
    }

    /// A verb that failed on an input.
    pub fn from_failure(input: &str, failure: &MeshFailure) -> Self {
        let exit = match failure.exit_code() {
            2 => Exit::Usage,
            3 => Exit::Input,
            4 => Exit::Output,
            130 => return Self::interrupted(),
            _ => Exit::Budget,
        };
        Self::new(exit, failure.code(), format!("{input}: {failure}"))
    }

    /// A signal stopped the command. There is no line, since the signal handler prints one.
    pub fn interrupted() -> Self {
        Self { exit: Exit::Interrupted, code: "cancelled", lines: Vec::new(), reported: false }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for line in self.lines.iter().take(MOST_LINES) {
            writeln!(f, "chordal: {line}")?;
        }
        match self.lines.len().saturating_sub(MOST_LINES) {
            0 => Ok(()),
            n_more => writeln!(f, "chordal: and {n_more} more"),
        }
    }
}

/// A system error for the middle of a sentence: in lower case and without its number.
pub fn plainly(error: &std::io::Error) -> String {
    let text = error.to_string();
    let text = text.split(" (os error").next().unwrap_or(&text);
    let mut letters = text.chars();
    letters
        .next()
        .map_or_else(String::new, |first| first.to_lowercase().collect::<String>() + letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shows_one_line_each_and_at_most_ten() {
        let lines = (0..13).map(|i| format!("f: line {i}")).collect();
        let fault = Fault { lines, ..Fault::input("x", "") };
        let shown = fault.to_string();
        assert_eq!(shown.lines().count(), 11);
        assert!(shown.starts_with("chordal: f: line 0\n"));
        assert!(shown.ends_with("chordal: and 3 more\n"));
    }

    #[test]
    fn says_a_system_error_in_the_middle_of_a_sentence() {
        let error = std::io::Error::from_raw_os_error(2);
        assert_eq!(plainly(&error), "no such file or directory");
    }
}
