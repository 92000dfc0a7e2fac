//! `ArrayPlace`: the position of an array, converted to a location only on request: to count the lines before
//! each array would read the text once for each.
use crate::FileLocation;
use crate::xml_text::place;

/// A position in a file.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ArrayPlace<'a> {
    /// An offset in a text.
    Text(&'a str, usize),
    /// An offset in the file.
    Byte(u64),
    /// The line of an offset in the file.
    Line(&'a [u8], usize),
}

impl ArrayPlace<'_> {
    /// The location.
    pub(crate) fn location(self) -> FileLocation {
        match self {
            Self::Text(text, at) => place(text, at),
            Self::Byte(byte) => FileLocation::Byte(byte),
            Self::Line(bytes, at) => {
                let newlines = memchr::memchr_iter(b'\n', &bytes[..at.min(bytes.len())]).count();
                FileLocation::Line(newlines as u64 + 1)
            }
        }
    }

    /// The position `n` bytes further, if bytes are counted.
    pub(crate) fn after(self, n: usize) -> Self {
        match self {
            Self::Byte(byte) => Self::Byte(byte + n as u64),
            other => other,
        }
    }
}
