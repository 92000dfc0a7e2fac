//! `ReadError`, `Warning` and `WriteError`: what is wrong with a file or a shape, and where.
use chordal::budget::advice::{Message, Spell, Spelling};
use std::fmt;

/// A location in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileLocation {
    /// The file as a whole.
    File,
    /// An offset in bytes from its start.
    Byte(u64),
    /// A line, counted from 1.
    Line(u64),
    /// A character of a text that may have long lines.
    LineColumn {
        /// The line, counted from 1.
        line: u64,
        /// The character in it, counted from 1.
        column: u64,
    },
    /// A row of a named list, counted from 0.
    Row {
        /// The list, as in "vertex".
        list: &'static str,
        /// The row.
        row: u64,
    },
    /// A JSON pointer (RFC 6901).
    Pointer(String),
}

impl fmt::Display for FileLocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => f.write_str("file"),
            Self::Byte(offset) => write!(f, "byte {offset}"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::LineColumn { line, column } => write!(f, "line {line}, column {column}"),
            Self::Row { list, row } => write!(f, "{list} {row}"),
            Self::Pointer(pointer) => write!(f, "{pointer}"),
        }
    }
}

/// Why a file is refused: a stable code, a location, and one sentence with the value and the limit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadError {
    /// Stable code for programs, as in "index-out-of-range".
    pub code: &'static str,
    /// The location of the error.
    pub place: FileLocation,
    /// The error, with the value and the limit.
    pub message: Message,
}

impl ReadError {
    /// An error at a location.
    pub fn new(code: &'static str, place: FileLocation, message: impl Into<Message>) -> Self {
        Self { code, place, message: message.into() }
    }

    /// The same error, of a file inside or beside the input file; the message begins with the name of that
    /// file.
    pub(crate) fn within(self, name: &str) -> Self {
        let message = Message::from(format!("{}: ", name.escape_default())).message(&self.message);
        Self { message, ..self }
    }
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            FileLocation::File => f.write_str(&self.message),
            place => write!(f, "{place}: {}", self.message),
        }
    }
}

impl std::error::Error for ReadError {}

impl Spell for ReadError {
    fn spell(&mut self, spelling: &dyn Spelling) {
        self.message.spell(spelling);
    }
}

/// Something in a file that was repaired, skipped or odd: counted, with its first location.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// Stable code for programs, as in "unused-vertices".
    pub code: &'static str,
    /// The number of occurrences.
    pub count: u64,
    /// The first location.
    pub place: FileLocation,
    /// One sentence.
    pub message: Message,
}

impl Warning {
    /// The sentence with the count, the location, and the settings that it advises.
    ///
    /// ```
    /// use chordal::budget::advice::{Message, Setting};
    /// use chordal_io::{FileLocation, Warning};
    /// let message = Message::from("millimetres were taken; ").setting(Setting::Unit).words(" says another");
    /// let warning = Warning { code: "unit", count: 1, place: FileLocation::File, message };
    /// assert_eq!(warning.counted(), "millimetres were taken; 'unit' says another (1x)");
    /// ```
    #[must_use]
    pub fn counted(&self) -> Message {
        let message = self.message.clone();
        match &self.place {
            FileLocation::File => message.words(format_args!(" ({}x)", self.count)),
            place => message.words(format_args!(" ({}x, first at {place})", self.count)),
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.counted().fmt(f)
    }
}

impl Spell for Warning {
    fn spell(&mut self, spelling: &dyn Spelling) {
        self.message.spell(spelling);
    }
}

/// Why a shape cannot be written.
#[derive(Debug)]
pub enum WriteError {
    /// The sink failed.
    Io(std::io::Error),
    /// The format cannot hold the shape.
    Unsupported(String),
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => error.fmt(f),
            Self::Unsupported(message) => f.write_str(message),
        }
    }
}

impl std::error::Error for WriteError {}

impl From<std::io::Error> for WriteError {
    fn from(error: std::io::Error) -> Self {
        Self::Io(error)
    }
}
