//! `LegacyReader`: the words and arrays of a legacy VTK file, as text or binary.
use super::array_place::ArrayPlace;
use super::number_array::NumberArray;
use crate::text::{IntegerError, grouped, integer, is_space, show};
use crate::volume::element::{Endian, SampleType};
use crate::{Limits, ReadError};
use std::borrow::Cow;

/// The type of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LegacyType {
    Number(SampleType),
    /// Eight per byte.
    Bits,
    Strings,
}

/// The type for a name in a file, in lower case.
///
/// Source: Kitware, *VTK File Formats*, 2005–2024; `vtkDataReader` of VTK 9. A `long` has 8 bytes, as on all
/// systems but Windows; a `vtkIdType` is written as an `int`.
fn type_of(name: &str) -> Option<LegacyType> {
    Some(LegacyType::Number(match name {
        "unsigned_char" | "vtktypeuint8" => SampleType::U8,
        "char" | "signed_char" | "vtktypeint8" => SampleType::I8,
        "unsigned_short" | "vtktypeuint16" => SampleType::U16,
        "short" | "vtktypeint16" => SampleType::I16,
        "unsigned_int" | "vtktypeuint32" => SampleType::U32,
        "int" | "vtkidtype" | "vtktypeint32" => SampleType::I32,
        "unsigned_long" | "unsigned_long_long" | "vtktypeuint64" => SampleType::U64,
        "long" | "long_long" | "vtktypeint64" => SampleType::I64,
        "float" => SampleType::F32,
        "double" => SampleType::F64,
        "bit" => return Some(LegacyType::Bits),
        "string" | "utf8_string" => return Some(LegacyType::Strings),
        _ => return None,
    }))
}

/// A cursor over a file.
#[derive(Clone, Debug)]
pub(super) struct LegacyReader<'a> {
    bytes: &'a [u8],
    at: usize,
    pub is_binary: bool,
    header_line: usize,
}

impl<'a> LegacyReader<'a> {
    /// Reads the first lines: the version, a title, and whether the file is binary.
    ///
    /// # Errors
    /// If they are not those of VTK.
    pub(super) fn new(bytes: &'a [u8], limits: &Limits) -> Result<Self, ReadError> {
        let mut reader = Self { bytes, at: 0, is_binary: false, header_line: limits.header_line };
        let first = reader.line()?.to_ascii_lowercase();
        if !first.starts_with(super::LEGACY_MAGIC) {
            return Err(reader.error_at(
                0,
                "not-vtk",
                "the first line is not '# vtk DataFile Version'".into(),
            ));
        }
        reader.line()?;
        let start = reader.at;
        let form = reader.word("ASCII or BINARY")?;
        reader.is_binary = match &*lower(form) {
            "ascii" => false,
            "binary" => true,
            _ => {
                let message = format!("{} is neither ASCII nor BINARY", show(form));
                return Err(reader.error_at(start, "not-vtk", message));
            }
        };
        reader.end_line();
        Ok(reader)
    }

    /// The position of the next byte.
    pub(super) fn place(&self) -> ArrayPlace<'a> {
        self.place_at(self.at)
    }

    fn place_at(&self, at: usize) -> ArrayPlace<'a> {
        if self.is_binary { ArrayPlace::Byte(at as u64) } else { ArrayPlace::Line(self.bytes, at) }
    }

    /// An error at the next byte.
    pub(super) fn error(&self, code: &'static str, message: String) -> ReadError {
        self.error_at(self.at, code, message)
    }

    fn error_at(&self, at: usize, code: &'static str, message: String) -> ReadError {
        ReadError::new(code, self.place_at(at).location(), message)
    }

    /// The rest of the line, without its end.
    pub(super) fn line(&mut self) -> Result<&'a [u8], ReadError> {
        let rest = &self.bytes[self.at..];
        let end = memchr::memchr(b'\n', rest);
        let line = &rest[..end.unwrap_or(rest.len())];
        if line.len() > self.header_line {
            let message =
                format!("a line of more than the limit of {} bytes", grouped(self.header_line as u64));
            return Err(self.error("line-too-long", message));
        }
        self.at += end.map_or(rest.len(), |end| end + 1);
        Ok(line)
    }

    /// Moves past the end of the line.
    pub(super) fn end_line(&mut self) {
        let rest = &self.bytes[self.at..];
        self.at += memchr::memchr(b'\n', rest).map_or(rest.len(), |end| end + 1);
    }

    /// The next word, if there is one.
    pub(super) fn next(&mut self) -> Option<&'a [u8]> {
        let start = self.at + self.bytes[self.at..].iter().position(|b| !is_space(*b))?;
        let rest = &self.bytes[start..];
        let n = rest.iter().position(|b| is_space(*b)).unwrap_or(rest.len());
        self.at = start + n;
        Some(&rest[..n])
    }

    /// Peeks at the next word.
    pub(super) fn peek(&self) -> Option<&'a [u8]> {
        self.clone().next()
    }

    /// Whether another word is on the line.
    pub(super) fn line_goes_on(&self) -> bool {
        let next = self.bytes[self.at..].iter().find(|b| !is_space(**b) || **b == b'\n');
        next.is_some_and(|byte| *byte != b'\n')
    }

    /// A required word.
    pub(super) fn word(&mut self, what: &str) -> Result<&'a [u8], ReadError> {
        self.next().ok_or_else(|| self.error("truncated", format!("the file ends before {what}")))
    }

    /// A name, in which characters may be escaped as in %20.
    pub(super) fn name(&mut self, what: &str) -> Result<String, ReadError> {
        let word = self.word(what)?;
        let digit = |byte: Option<&u8>| byte.and_then(|b| char::from(*b).to_digit(16));
        let (mut name, mut at) = (Vec::new(), 0);
        while let Some(byte) = word.get(at) {
            match (byte, digit(word.get(at + 1)), digit(word.get(at + 2))) {
                (b'%', Some(high), Some(low)) => {
                    name.push((high * 16 + low) as u8);
                    at += 3;
                }
                _ => {
                    name.push(*byte);
                    at += 1;
                }
            }
        }
        Ok(String::from_utf8_lossy(&name).into_owned())
    }

    /// A count.
    pub(super) fn count(&mut self, what: &str) -> Result<u64, ReadError> {
        let word = self.word(what)?;
        match integer(word) {
            Ok(value) if value >= 0 => Ok(value as u64),
            Ok(_) | Err(IntegerError::TooLarge) => {
                let message = format!("{what}: {} is no possible count", show(word));
                Err(self.error("count-out-of-range", message))
            }
            Err(IntegerError::Spelling) => {
                Err(self.error("not-a-number", format!("{what}: {} is not a whole number", show(word))))
            }
        }
    }

    /// The name of a type.
    pub(super) fn kind(&mut self) -> Result<LegacyType, ReadError> {
        let word = self.word("a type")?;
        type_of(&lower(word))
            .ok_or_else(|| self.error("type-unknown", format!("{} is none of the types of VTK", show(word))))
    }

    /// Numbers, `n` rows of `width`. In a binary file they begin on the next line.
    ///
    /// # Errors
    /// If there are too few, or one is not a number of the type.
    pub(super) fn numbers(
        &mut self,
        n: u64,
        width: u64,
        kind: SampleType,
    ) -> Result<NumberArray<'a>, ReadError> {
        let n = n.saturating_mul(width);
        if self.is_binary {
            self.end_line();
            let taken = self.take(n.saturating_mul(kind.width() as u64))?;
            return Ok(NumberArray::Packed { kind, endian: Endian::Big, bytes: Cow::Borrowed(taken) });
        }
        self.check_words(n)?;
        let start = self.clone();
        let tokens = std::iter::from_fn(|| self.next()).take(n as usize);
        let numbers = NumberArray::from_tokens(tokens, n as usize, kind);
        let numbers =
            numbers.map_err(|bad| start.error_at(bad.at(start.bytes), bad.code, bad.message.clone()))?;
        if numbers.len() as u64 != n {
            let message =
                format!("{} numbers were to follow, and {} do", grouped(n), grouped(numbers.len() as u64));
            return Err(self.error("truncated", message));
        }
        Ok(numbers)
    }

    /// Skips an array that is not numeric.
    pub(super) fn skip(&mut self, n: u64, width: u64, kind: LegacyType) -> Result<(), ReadError> {
        let n = n.saturating_mul(width);
        match (kind, self.is_binary) {
            (LegacyType::Number(kind), true) => {
                self.end_line();
                self.take(n.saturating_mul(kind.width() as u64)).map(|_| ())
            }
            (LegacyType::Bits, true) => {
                self.end_line();
                self.take(n.div_ceil(8)).map(|_| ())
            }
            (LegacyType::Strings, true) => {
                self.end_line();
                (0..n).try_for_each(|_| self.skip_string())
            }
            (LegacyType::Strings, false) => {
                self.end_line();
                (0..n).try_for_each(|_| {
                    if self.at == self.bytes.len() {
                        return Err(self.error("truncated", "the file ends before this text".to_owned()));
                    }
                    self.end_line();
                    Ok(())
                })
            }
            (_, false) => {
                self.check_words(n)?;
                (0..n).try_for_each(|_| self.word("this number").map(|_| ()))
            }
        }
    }

    /// Skips a text with its length before it; the two highest bits encode the number of bytes of the length.
    fn skip_string(&mut self) -> Result<(), ReadError> {
        let first = self.take(1)?[0];
        let low = u64::from(first & 0x3f);
        let more = match first >> 6 {
            3 => 0,
            2 => 1,
            1 => 3,
            _ => 7,
        };
        let n = self.take(more)?.iter().fold(low, |n, byte| n << 8 | u64::from(*byte));
        self.take(n).map(|_| ())
    }

    /// Refuses a number of words that cannot follow, at a character and a space each.
    fn check_words(&self, n: u64) -> Result<(), ReadError> {
        let left = (self.bytes.len() - self.at) as u64;
        if n > left / 2 + 1 {
            let message = format!("{} numbers were to follow in {} bytes", grouped(n), grouped(left));
            return Err(self.error("truncated", message));
        }
        Ok(())
    }

    fn take(&mut self, n: u64) -> Result<&'a [u8], ReadError> {
        let left = self.bytes.len() - self.at;
        if n > left as u64 {
            let message = format!("{} bytes were to follow, and {} do", grouped(n), grouped(left as u64));
            return Err(self.error("truncated", message));
        }
        let taken = &self.bytes[self.at..self.at + n as usize];
        self.at += n as usize;
        Ok(taken)
    }
}

/// A word in lower case, for comparison with keywords. Invalid UTF-8, which no keyword has, is replaced.
pub(super) fn lower(word: &[u8]) -> String {
    /// Chosen: longer words are not keywords.
    const MOST: usize = 64;
    String::from_utf8_lossy(&word[..word.len().min(MOST)]).to_ascii_lowercase()
}
