//! The header of a NRRD file: lines of `field: value`, `key:=value` and `# comment`, up to an empty line.
use super::{CERTIFICATE, MAGIC};
use crate::certificate::CertificateComments;
use crate::text::{LineTokens, TextLines, finite, integer, number, number_error, show, trim};
use crate::volume::element::{Endian, SampleType};
use crate::volume::label_table::SegmentKeys;
use crate::{FileLocation, Limits, ReadError};
use chordal::budget::advice::Message;

/// A value with its line number.
#[derive(Clone, Debug)]
pub(super) struct NrrdField<T> {
    pub value: T,
    pub line: u64,
}

/// How samples are encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NrrdEncoding {
    Raw,
    Text,
    Gzip,
}

/// The fields of the header; fields that do not describe the samples were skipped.
#[derive(Default)]
pub(super) struct NrrdHeader {
    pub element: Option<SampleType>,
    pub endian: Option<Endian>,
    pub encoding: Option<NrrdEncoding>,
    pub dimension: Option<NrrdField<i64>>,
    pub sizes: Option<NrrdField<Vec<i64>>>,
    pub space: Option<NrrdField<String>>,
    pub space_dimension: Option<NrrdField<i64>>,
    /// One step for each axis; `None` for an axis outside space.
    pub directions: Option<NrrdField<Vec<Option<[f64; 3]>>>>,
    pub origin: Option<NrrdField<[f64; 3]>>,
    /// The spacing of each axis; NaN for an axis outside space.
    pub spacings: Option<NrrdField<Vec<f64>>>,
    pub mins: Option<u64>,
    pub kinds: Option<NrrdField<Vec<String>>>,
    pub units: Option<NrrdField<Vec<String>>>,
    pub content: String,
    pub line_skip: u64,
    pub byte_skip: i64,
    pub certificate: CertificateComments,
    pub segments: SegmentKeys,
    /// The last line that was read, where missing fields are reported.
    pub last_line: u64,
    /// The byte at which the samples start.
    pub end: usize,
}

fn header_error(line: u64, message: impl Into<Message>) -> ReadError {
    ReadError::new("bad-header", FileLocation::Line(line), message)
}

fn unsupported(line: u64, message: impl Into<Message>) -> ReadError {
    ReadError::new("unsupported", FileLocation::Line(line), message)
}

impl NrrdHeader {
    /// Parses the header at the start of a file.
    ///
    /// # Errors
    /// At the line that is invalid or not supported.
    pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Self, ReadError> {
        let magic = bytes.get(..8).filter(|magic| magic.starts_with(MAGIC));
        if !magic.is_some_and(|magic| (b'1'..=b'5').contains(&magic[7])) {
            let start = show(&bytes[..bytes.len().min(8)]);
            let message = format!("a .nrrd file starts with NRRD0001 to NRRD0005, not {start}");
            return Err(ReadError::new("bad-magic", FileLocation::Line(1), message));
        }
        let mut fields = Self::default();
        let mut seen: Vec<Vec<u8>> = Vec::new();
        let mut lines = TextLines::new(bytes);
        while let Some((line, text)) = lines.next() {
            fields.last_line = line;
            if text.len() > limits.header_line {
                let message = format!("a line of more than {} bytes", limits.header_line);
                return Err(ReadError::new("line-too-long", FileLocation::Line(line), message));
            }
            if text.is_empty() {
                fields.end = lines.offset();
                return Ok(fields);
            }
            if line > 1 {
                fields.set_field(line, text, &mut seen)?;
            }
        }
        Err(ReadError::new(
            "truncated",
            FileLocation::Line(fields.last_line),
            "the header has no empty line at its end",
        ))
    }

    fn set_field(&mut self, line: u64, text: &[u8], seen: &mut Vec<Vec<u8>>) -> Result<(), ReadError> {
        if text.starts_with(b"#") {
            return Ok(());
        }
        let colon = memchr::memchr(b':', text);
        let colon =
            colon.ok_or_else(|| header_error(line, format!("{} is no field of a header", show(text))))?;
        let (name, value) = (&text[..colon], &text[colon + 1..]);
        // `key:=value` is no field but a pair of the program that wrote it.
        if let Some(value) = value.strip_prefix(b"=") {
            if name == CERTIFICATE.as_bytes() {
                self.certificate.take(&unescaped(value), FileLocation::Line(line));
            }
            self.segments.take(name, &unescaped(value));
            return Ok(());
        }
        // Many fields have two spellings, as `line skip` and `lineskip`.
        let name: Vec<u8> = name.iter().filter(|b| **b != b' ').map(u8::to_ascii_lowercase).collect();
        if name.is_empty() || seen.contains(&name) {
            return Err(header_error(
                line,
                format!("field {} is there twice, or without a name", show(&name)),
            ));
        }
        // Chosen: the format has some thirty fields.
        if seen.len() > 100 {
            return Err(header_error(line, "more than 100 fields"));
        }
        self.field(&name, line, trim(value))?;
        seen.push(name);
        Ok(())
    }

    fn field(&mut self, name: &[u8], line: u64, value: &[u8]) -> Result<(), ReadError> {
        let whole_number =
            || integer(value).map_err(|_| header_error(line, format!("{} is no whole number", show(value))));
        match name {
            b"type" => self.element = Some(element(value, line)?),
            b"endian" => {
                self.endian = Some(match &value.to_ascii_lowercase()[..] {
                    b"little" => Endian::Little,
                    b"big" => Endian::Big,
                    _ => {
                        return Err(header_error(
                            line,
                            format!("endian is little or big, not {}", show(value)),
                        ));
                    }
                });
            }
            b"encoding" => self.encoding = Some(encoding(value, line)?),
            b"dimension" => self.dimension = Some(NrrdField { value: whole_number()?, line }),
            b"sizes" => {
                let sizes: Result<Vec<i64>, _> = LineTokens::new(value)
                    .map(|token| {
                        integer(token).map_err(|_| header_error(line, format!("{} is no size", show(token))))
                    })
                    .collect();
                self.sizes = Some(NrrdField { value: sizes?, line });
            }
            b"space" => {
                self.space = Some(NrrdField { value: String::from_utf8_lossy(value).into_owned(), line })
            }
            b"spacedimension" => self.space_dimension = Some(NrrdField { value: whole_number()?, line }),
            b"spacedirections" => {
                self.directions = Some(NrrdField { value: directions(value, line)?, line });
            }
            b"spaceorigin" => {
                let (origin, rest) = vector(value, line)?;
                if !trim(rest).is_empty() {
                    return Err(header_error(line, format!("{} follows the origin", show(rest))));
                }
                self.origin = Some(NrrdField { value: origin, line });
            }
            b"spacings" => {
                let spacings: Result<Vec<f64>, _> = LineTokens::new(value)
                    .map(|token| number(token).ok_or_else(|| header_error(line, number_error(token))))
                    .collect();
                self.spacings = Some(NrrdField { value: spacings?, line });
            }
            b"axismins" | b"axismaxs" => self.mins = Some(line),
            b"kinds" => {
                let kinds = LineTokens::new(value).map(|t| String::from_utf8_lossy(t).to_ascii_lowercase());
                self.kinds = Some(NrrdField { value: kinds.collect(), line });
            }
            b"spaceunits" | b"units" => {
                let units = quoted(value);
                // The units of space take precedence if both are given.
                if name == b"spaceunits" || self.units.is_none() {
                    self.units = Some(NrrdField { value: units, line });
                }
            }
            b"content" => self.content = crate::volume::name_of(value),
            b"lineskip" => {
                self.line_skip = u64::try_from(whole_number()?)
                    .map_err(|_| header_error(line, "a negative number of lines"))?;
            }
            b"byteskip" => {
                self.byte_skip = whole_number()?;
                if self.byte_skip < -1 {
                    return Err(header_error(
                        line,
                        "bytes to skip are 0 or more, or -1 to count from the file's end",
                    ));
                }
            }
            b"datafile" => {
                let name = show(value);
                let message = format!(
                    "the samples are in another file, {name}, and no reader opens a second file; save both as one .nrrd"
                );
                return Err(ReadError::new("detached", FileLocation::Line(line), message));
            }
            // Fields that do not describe the position or value of samples.
            b"blocksize" | b"min" | b"max" | b"oldmin" | b"oldmax" | b"number" | b"sampleunits"
            | b"labels" | b"thicknesses" | b"centers" | b"centerings" | b"measurementframe" => {}
            _ => return Err(header_error(line, format!("{} is no field that is known", show(name)))),
        }
        Ok(())
    }
}

/// Replaces `\n` and `\\` in values of keys by a line feed and a backslash.
fn unescaped(value: &[u8]) -> Vec<u8> {
    let mut text = Vec::with_capacity(value.len());
    let mut bytes = value.iter();
    while let Some(byte) = bytes.next() {
        match (byte, bytes.as_slice().first()) {
            (b'\\', Some(b'n')) => {
                bytes.next();
                text.push(b'\n');
            }
            (b'\\', Some(b'\\')) => {
                bytes.next();
                text.push(b'\\');
            }
            _ => text.push(*byte),
        }
    }
    text
}

/// Parses `"mm" "mm" "mm"`.
fn quoted(value: &[u8]) -> Vec<String> {
    let texts = value.split(|b| *b == b'"').skip(1).step_by(2);
    texts.map(|text| String::from_utf8_lossy(text).trim().to_owned()).collect()
}

/// Parses `(1,0,0) none (0,1,0)`.
fn directions(value: &[u8], line: u64) -> Result<Vec<Option<[f64; 3]>>, ReadError> {
    let mut rest = trim(value);
    let mut steps = Vec::new();
    while !rest.is_empty() {
        // Chosen: files have fewer axes.
        if steps.len() == 16 {
            return Err(header_error(line, "more than 16 axes"));
        }
        if let Some(after) = rest.strip_prefix(b"none") {
            steps.push(None);
            rest = trim(after);
        } else {
            let (direction, after) = vector(rest, line)?;
            steps.push(Some(direction));
            rest = trim(after);
        }
    }
    Ok(steps)
}

/// Parses `(1,0,0)` at the start of a text. Returns the rest too.
fn vector(text: &[u8], line: u64) -> Result<([f64; 3], &[u8]), ReadError> {
    let text = trim(text);
    let inner = text.strip_prefix(b"(").and_then(|rest| {
        let end = memchr::memchr(b')', rest)?;
        Some((&rest[..end], &rest[end + 1..]))
    });
    let (inner, rest) =
        inner.ok_or_else(|| header_error(line, format!("{} is no vector as (1,0,0)", show(text))))?;
    let mut vector = [0.0; 3];
    let mut n = 0;
    for part in inner.split(|b| *b == b',') {
        if n == 3 {
            return Err(unsupported(line, "a vector of more than three numbers: space has three axes"));
        }
        vector[n] = finite(trim(part), || FileLocation::Line(line))?;
        n += 1;
    }
    if n < 3 {
        return Err(unsupported(line, format!("a vector of {n} numbers: space has three axes")));
    }
    Ok((vector, rest))
}

fn encoding(value: &[u8], line: u64) -> Result<NrrdEncoding, ReadError> {
    match &value.to_ascii_lowercase()[..] {
        b"raw" => Ok(NrrdEncoding::Raw),
        b"txt" | b"text" | b"ascii" => Ok(NrrdEncoding::Text),
        b"gz" | b"gzip" => Ok(NrrdEncoding::Gzip),
        _ => Err(unsupported(line, format!("encoding {} is not read: raw, gzip and text are", show(value)))),
    }
}

fn element(value: &[u8], line: u64) -> Result<SampleType, ReadError> {
    let words: Vec<&[u8]> = LineTokens::new(value).collect();
    let name = words.join(&b' ').to_ascii_lowercase();
    Ok(match &name[..] {
        b"signed char" | b"int8" | b"int8_t" => SampleType::I8,
        b"uchar" | b"unsigned char" | b"uint8" | b"uint8_t" => SampleType::U8,
        b"short" | b"short int" | b"signed short" | b"signed short int" | b"int16" | b"int16_t" => {
            SampleType::I16
        }
        b"ushort" | b"unsigned short" | b"unsigned short int" | b"uint16" | b"uint16_t" => SampleType::U16,
        b"int" | b"signed int" | b"int32" | b"int32_t" => SampleType::I32,
        b"uint" | b"unsigned int" | b"uint32" | b"uint32_t" => SampleType::U32,
        b"longlong"
        | b"long long"
        | b"long long int"
        | b"signed long long"
        | b"signed long long int"
        | b"int64"
        | b"int64_t" => SampleType::I64,
        b"ulonglong" | b"unsigned long long" | b"unsigned long long int" | b"uint64" | b"uint64_t" => {
            SampleType::U64
        }
        b"float" => SampleType::F32,
        b"double" => SampleType::F64,
        _ => {
            let message =
                format!("samples of type {} are not read: whole numbers, float and double are", show(value));
            return Err(ReadError::new("unsupported-type", FileLocation::Line(line), message));
        }
    })
}
