//! `ArrayPlace`: where an array stands, which is turned into a location only when one is asked for: to count the
//! lines before each array would read the text once for each.
use crate::FileLocation;
use crate::xml_text::place;

/// A place in a file.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ArrayPlace<'a> {
    /// A byte of a text.
    Text(&'a str, usize),
    /// A byte of the file.
    Byte(u64),
    /// The line of a byte of the file.
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

    /// The place `n` bytes on, where bytes are counted.
    pub(crate) fn after(self, n: usize) -> Self {
        match self {
            Self::Byte(byte) => Self::Byte(byte + n as u64),
            other => other,
        }
    }
}
