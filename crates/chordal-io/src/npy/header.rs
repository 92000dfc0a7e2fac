//! The header of a `.npy` file: a Python dictionary of three entries, parsed without Python.
use super::MAGIC;
use crate::text::{show, trim};
use crate::volume::element::{Endian, SampleType};
use crate::{FileLocation, Limits, ReadError};
use chordal::budget::advice::Message;

/// The fields of the header.
pub(super) struct NpyHeader {
    pub element: SampleType,
    pub endian: Endian,
    /// Whether the first index varies fastest.
    pub fortran_order: bool,
    pub shape: Vec<i64>,
    /// The location of the shape.
    pub shape_place: FileLocation,
    /// The byte at which samples start.
    pub end: usize,
}

fn header_error(at: usize, message: impl Into<Message>) -> ReadError {
    ReadError::new("bad-header", FileLocation::Byte(at as u64), message)
}

impl NpyHeader {
    /// Parses the header at the start of a file.
    ///
    /// # Errors
    /// If it is not a header, or has an unsupported sample type.
    pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Self, ReadError> {
        let cut = || {
            let message = format!("the file ends in its header, after {} bytes", bytes.len());
            ReadError::new("truncated", FileLocation::Byte(bytes.len() as u64), message)
        };
        if !bytes.starts_with(MAGIC) {
            let message =
                format!("a .npy file starts with \\x93NUMPY, not {}", show(&bytes[..bytes.len().min(6)]));
            return Err(ReadError::new("bad-magic", FileLocation::Byte(0), message));
        }
        let version = *bytes.get(6).ok_or_else(cut)?;
        // Version 2 only has a longer length, and version 3 only another encoding of names, which
        // no supported type has.
        let (start, length) = match (version, bytes.get(8..10), bytes.get(8..12)) {
            (1, Some(n), _) => (10, u32::from(u16::from_le_bytes([n[0], n[1]]))),
            (2 | 3, _, Some(n)) => (12, u32::from_le_bytes([n[0], n[1], n[2], n[3]])),
            (1..=3, ..) => return Err(cut()),
            _ => {
                return Err(header_error(
                    6,
                    format!("version {version} of .npy is not known; 1, 2 and 3 are"),
                ));
            }
        };
        let length = length as usize;
        if length > limits.header_line {
            let message = format!("a header of {length} bytes is over the limit of {}", limits.header_line);
            return Err(header_error(8, message));
        }
        let end = start + length;
        let text = bytes.get(start..end).ok_or_else(cut)?;
        NpyDictionary { text, at: 0, start }.read(end)
    }
}

/// A parser for the dictionary, from left to right.
struct NpyDictionary<'a> {
    text: &'a [u8],
    at: usize,
    /// The byte of the file at which the text starts.
    start: usize,
}

impl<'a> NpyDictionary<'a> {
    fn read(mut self, end: usize) -> Result<NpyHeader, ReadError> {
        let (mut types, mut order, mut shape) = (None, None, None);
        self.expect(b'{')?;
        while !self.takes(b'}') {
            let at = self.place();
            let key = self.quoted()?;
            self.expect(b':')?;
            let value = self.place();
            match key {
                b"descr" => types = Some(self.element()?),
                b"fortran_order" => order = Some(self.truth()?),
                b"shape" => shape = Some((self.tuple()?, FileLocation::Byte(value as u64))),
                other => {
                    return Err(header_error(at, format!("{} is no entry of a .npy header", show(other))));
                }
            }
            // NumPy writes a comma after the last entry, too.
            if !self.takes(b',') {
                self.expect(b'}')?;
                break;
            }
        }
        if !trim(&self.text[self.at..]).is_empty() {
            return Err(header_error(self.place(), "something follows the header's closing brace"));
        }
        let missing = |what: &str| header_error(self.start, format!("the header has no '{what}'"));
        let (element, endian) = types.ok_or_else(|| missing("descr"))?;
        let fortran_order = order.ok_or_else(|| missing("fortran_order"))?;
        let (shape, shape_place) = shape.ok_or_else(|| missing("shape"))?;
        Ok(NpyHeader { element, endian, fortran_order, shape, shape_place, end })
    }

    fn place(&self) -> usize {
        self.start + self.at
    }

    fn skip_spaces(&mut self) {
        while self.text.get(self.at).is_some_and(|b| crate::text::is_space(*b)) {
            self.at += 1;
        }
    }

    fn takes(&mut self, byte: u8) -> bool {
        self.skip_spaces();
        let is = self.text.get(self.at) == Some(&byte);
        self.at += usize::from(is);
        is
    }

    fn expect(&mut self, byte: u8) -> Result<(), ReadError> {
        if self.takes(byte) {
            return Ok(());
        }
        Err(header_error(self.place(), format!("'{}' is missing", char::from(byte))))
    }

    fn quoted(&mut self) -> Result<&'a [u8], ReadError> {
        self.skip_spaces();
        let mark = self.text.get(self.at).copied().filter(|b| matches!(b, b'\'' | b'"'));
        let mark = mark.ok_or_else(|| header_error(self.place(), "a text in quotes is missing"))?;
        let rest = &self.text[self.at + 1..];
        let end = rest.iter().position(|b| *b == mark);
        let end = end.ok_or_else(|| header_error(self.place(), "a quote is not closed"))?;
        self.at += end + 2;
        Ok(&rest[..end])
    }

    /// A word of letters, digits and signs.
    fn word(&mut self) -> &'a [u8] {
        self.skip_spaces();
        let rest = &self.text[self.at..];
        let is_letter = |b: &u8| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'-' | b'_' | b'.');
        let end = rest.iter().position(|b| !is_letter(b)).unwrap_or(rest.len());
        self.at += end;
        &rest[..end]
    }

    fn truth(&mut self) -> Result<bool, ReadError> {
        let at = self.place();
        match self.word() {
            b"True" => Ok(true),
            b"False" => Ok(false),
            other => Err(header_error(at, format!("fortran_order is True or False, not {}", show(other)))),
        }
    }

    fn tuple(&mut self) -> Result<Vec<i64>, ReadError> {
        self.expect(b'(')?;
        let mut sizes = Vec::new();
        while !self.takes(b')') {
            let at = self.place();
            let word = self.word();
            // Python 2 wrote long numbers with an L.
            let digits = word.strip_suffix(b"L").unwrap_or(word);
            let number = crate::text::integer(digits)
                .map_err(|_| header_error(at, format!("{} is no number of samples", show(word))))?;
            // NumPy arrays have at most 64 axes.
            if sizes.len() == 64 {
                return Err(header_error(at, "more than 64 axes"));
            }
            sizes.push(number);
            if !self.takes(b',') {
                self.expect(b')')?;
                break;
            }
        }
        Ok(sizes)
    }

    fn element(&mut self) -> Result<(SampleType, Endian), ReadError> {
        self.skip_spaces();
        let at = self.place();
        if self.text.get(self.at) == Some(&b'[') {
            return Err(ReadError::new("unsupported-type", FileLocation::Byte(at as u64), STRUCTURED));
        }
        let text = self.quoted()?;
        let unsupported = |why: &str| {
            ReadError::new("unsupported-type", FileLocation::Byte(at as u64), format!("{} {why}", show(text)))
        };
        let (endian, rest) = match text {
            [b'>', rest @ ..] => (Endian::Big, rest),
            // No byte order (`|`) is right for single bytes; others are refused below.
            [b'<' | b'|', rest @ ..] => (Endian::Little, rest),
            _ => return Err(unsupported("does not say its byte order: '<', '>' or '|' comes first")),
        };
        let element = match rest {
            b"b1" => SampleType::Bool,
            b"u1" => SampleType::U8,
            b"i1" => SampleType::I8,
            b"u2" => SampleType::U16,
            b"i2" => SampleType::I16,
            b"u4" => SampleType::U32,
            b"i4" => SampleType::I32,
            b"u8" => SampleType::U64,
            b"i8" => SampleType::I64,
            b"f2" => SampleType::F16,
            b"f4" => SampleType::F32,
            b"f8" => SampleType::F64,
            [b'O', ..] => {
                return Err(unsupported("holds Python objects: they would have to be run to be read"));
            }
            [b'c', ..] => return Err(unsupported("holds complex numbers; save the part that is meant")),
            _ => {
                return Err(unsupported(
                    "is no type of numbers that is read: b1, i1 to i8, u1 to u8, f2 to f8",
                ));
            }
        };
        if text[0] == b'|' && element.width() > 1 {
            return Err(unsupported("does not say its byte order, which a number of several bytes has"));
        }
        Ok((element, endian))
    }
}

const STRUCTURED: &str = "the array is one of records; save one of their fields";
