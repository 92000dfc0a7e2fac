//! `ScriptError`: an error in a script, with its position.
use std::fmt;

/// A stable error code, a source position, and one sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScriptError {
    /// Stable, for programs: `script-syntax`, `script-error`, `script-limit`, `script-value`,
    /// `script-file`, `unknown-parameter` or `cancelled`.
    pub code: &'static str,
    /// Line and column, counted from 1, if the position is known.
    pub place: Option<(u64, u64)>,
    /// The cause, in one sentence.
    pub message: String,
    /// The line of the script, if the position is known.
    pub line: Option<String>,
}

impl ScriptError {
    pub(crate) fn new(code: &'static str, message: impl Into<String>) -> Self {
        Self { code, place: None, message: message.into(), line: None }
    }

    /// The same as an error of a file that a script loads: name and position become part of the sentence.
    pub(crate) fn of_file(self, name: &str) -> Self {
        if name.is_empty() {
            return self;
        }
        let message = match self.place {
            Some((line, column)) => format!("{name}, line {line}, column {column}: {}", self.message),
            None if self.message.starts_with(name) => self.message.clone(),
            None => format!("{name}: {}", self.message),
        };
        Self { place: None, line: None, message, ..self }
    }

    /// Adds the position of a byte offset in the text.
    pub(crate) fn at(self, text: &str, offset: usize) -> Self {
        let (line, column) = position(text, offset);
        self.in_line(text, line, column)
    }

    /// Adds a position, counted from 0.
    pub(crate) fn in_line(self, text: &str, line: usize, column: usize) -> Self {
        let shown = text.lines().nth(line).map(|shown| shown.chars().take(LONGEST_LINE).collect());
        Self { place: Some((line as u64 + 1, column as u64 + 1)), line: shown, ..self }
    }

    /// The line with a mark below the column; `None` if either is unknown or the column is beyond the end
    /// that is kept.
    #[must_use]
    pub fn excerpt(&self) -> Option<String> {
        let (line, (_, column)) = (self.line.as_ref()?, self.place?);
        let before = usize::try_from(column - 1).ok().filter(|before| *before <= line.chars().count())?;
        // Tabs stay tabs, so that the mark lines up.
        let space: String = line.chars().take(before).map(|c| if c == '\t' { c } else { ' ' }).collect();
        Some(format!("{line}\n{space}^"))
    }
}

/// Line and column of a byte offset, counted from 0.
pub(crate) fn position(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let start = before.rfind('\n').map_or(0, |at| at + 1);
    (before.matches('\n').count(), before[start..].chars().count())
}

/// The most characters of a line that an error carries. Chosen: longer than lines of readable code.
const LONGEST_LINE: usize = 200;

impl fmt::Display for ScriptError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place {
            Some((line, column)) => write!(f, "line {line}, column {column}: {}", self.message),
            None => f.write_str(&self.message),
        }
    }
}

impl std::error::Error for ScriptError {}
