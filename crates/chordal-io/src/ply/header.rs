//! The header of a PLY file: its elements and their properties.
use crate::certificate::CertificateComments;
use crate::text::{LineTokens, TextLines, grouped, integer, show};
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, ReadError};
use chordal::budget::advice::Message;
use serde_json::Value;

/// The most elements that a header may declare. Chosen: far more than any writer uses.
const MOST_ELEMENTS: usize = 256;
/// The most properties of an element. Chosen: scanners write some tens, splat files some hundreds.
const MOST_PROPERTIES: usize = 4096;

/// The encoding of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PlyEncoding {
    Text,
    Little,
    Big,
}

/// The type of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PlyScalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
    /// A type of which only the size is known, so that it can be skipped.
    Opaque(u8),
}

/// The type names of 1990, the later ones with sizes, and those that some tools add.
const NAMES: [(&str, PlyScalar); 26] = [
    ("char", PlyScalar::I8),
    ("int8", PlyScalar::I8),
    ("uchar", PlyScalar::U8),
    ("uint8", PlyScalar::U8),
    ("short", PlyScalar::I16),
    ("int16", PlyScalar::I16),
    ("ushort", PlyScalar::U16),
    ("uint16", PlyScalar::U16),
    ("int", PlyScalar::I32),
    ("int32", PlyScalar::I32),
    ("uint", PlyScalar::U32),
    ("uint32", PlyScalar::U32),
    ("float", PlyScalar::F32),
    ("float32", PlyScalar::F32),
    ("double", PlyScalar::F64),
    ("float64", PlyScalar::F64),
    ("float16", PlyScalar::Opaque(2)),
    ("float128", PlyScalar::Opaque(16)),
    ("int64", PlyScalar::Opaque(8)),
    ("uint64", PlyScalar::Opaque(8)),
    ("int128", PlyScalar::Opaque(16)),
    ("uint128", PlyScalar::Opaque(16)),
    ("int256", PlyScalar::Opaque(32)),
    ("uint256", PlyScalar::Opaque(32)),
    ("int512", PlyScalar::Opaque(64)),
    ("uint512", PlyScalar::Opaque(64)),
];

impl PlyScalar {
    fn from_name(name: &[u8]) -> Option<Self> {
        NAMES.iter().find(|row| row.0.as_bytes() == name).map(|row| row.1)
    }

    /// Bytes of one number in a binary body.
    pub(super) fn size(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
            Self::Opaque(size) => u64::from(size),
        }
    }

    /// The lowest and highest value of an integer type.
    pub(super) fn range(self) -> Option<(i64, i64)> {
        match self {
            Self::I8 => Some((-0x80, 0x7f)),
            Self::U8 => Some((0, 0xff)),
            Self::I16 => Some((-0x8000, 0x7fff)),
            Self::U16 => Some((0, 0xffff)),
            Self::I32 => Some((-0x8000_0000, 0x7fff_ffff)),
            Self::U32 => Some((0, 0xffff_ffff)),
            Self::F32 | Self::F64 | Self::Opaque(_) => None,
        }
    }
}

/// One value, or a list with its length before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PlyPropertyType {
    One(PlyScalar),
    List { length: PlyScalar, item: PlyScalar },
}

#[derive(Clone, Debug)]
pub(super) struct PlyProperty {
    pub(super) name: String,
    pub(super) shape: PlyPropertyType,
}

#[derive(Clone, Debug)]
pub(super) struct PlyElement {
    pub(super) name: String,
    pub(super) rows: u64,
    pub(super) properties: Vec<PlyProperty>,
    pub(super) line: u64,
}

#[derive(Debug)]
pub(super) struct PlyHeader {
    pub(super) encoding: PlyEncoding,
    pub(super) elements: Vec<PlyElement>,
    pub(super) certificate: Option<Value>,
    /// Where the body starts, and how many lines precede it.
    pub(super) body: usize,
    pub(super) lines: u64,
}

fn error(line: u64, code: &'static str, message: impl Into<Message>) -> ReadError {
    ReadError::new(code, FileLocation::Line(line), message)
}

impl PlyHeader {
    /// Parses the header at the start of `bytes`; blank lines and a byte order mark may precede it.
    pub(super) fn read(bytes: &[u8], limits: &Limits, warnings: &mut Warnings) -> Result<Self, ReadError> {
        let mut reader = PlyHeaderReader::default();
        let mut lines = TextLines::new(bytes);
        let mut cr_only = false;
        loop {
            let before = lines.offset();
            let Some((line, text)) = lines.next() else {
                let message = "the file ends in its header: there is no 'end_header'";
                return Err(ReadError::new("truncated", FileLocation::Byte(before as u64), message));
            };
            if text.len() > limits.header_line {
                let n = grouped(text.len() as u64);
                let message =
                    format!("a header line of {n} bytes is over the limit of {}", limits.header_line);
                return Err(error(line, "line-too-long", message));
            }
            let text = text.strip_prefix(&[0xef, 0xbb, 0xbf]).filter(|_| line == 1).unwrap_or(text);
            if !reader.has_magic {
                let end = before + text.len();
                cr_only = bytes.get(end) == Some(&b'\r') && bytes.get(end + 1) != Some(&b'\n');
            }
            if reader.line(line, text, limits)? {
                // If a header uses lone CRs, an LF after the last one is the first byte of a binary body.
                let cr_end = before + text.len() + 1;
                let body = if cr_only && reader.is_binary() { cr_end } else { lines.offset() };
                return reader.finish(line, body, warnings);
            }
        }
    }
}

#[derive(Default)]
struct PlyHeaderReader {
    has_magic: bool,
    encoding: Option<PlyEncoding>,
    elements: Vec<PlyElement>,
    certificate: CertificateComments,
}

impl PlyHeaderReader {
    fn is_binary(&self) -> bool {
        self.encoding.is_some_and(|e| e != PlyEncoding::Text)
    }

    /// Reads one line. Returns true for the last one.
    fn line(&mut self, line: u64, text: &[u8], limits: &Limits) -> Result<bool, ReadError> {
        let mut tokens = LineTokens::new(text);
        let Some(word) = tokens.next() else { return Ok(false) };
        if !self.has_magic {
            if word != b"ply" {
                return Err(error(line, "not-ply", format!("{} where 'ply' should stand", show(word))));
            }
            self.has_magic = true;
            return Ok(false);
        }
        match word {
            b"format" => self.format(line, tokens)?,
            b"comment" => {
                if let Some(text) = tokens.rest().strip_prefix(b"chordal ") {
                    self.certificate.take(text, FileLocation::Line(line));
                }
            }
            b"obj_info" => {}
            b"element" => self.element(line, tokens, limits)?,
            b"property" => self.property(line, tokens)?,
            b"end_header" => return Ok(true),
            _ => {
                return Err(error(
                    line,
                    "not-a-header",
                    format!("{} is no line of a PLY header", show(word)),
                ));
            }
        }
        Ok(false)
    }

    fn format(&mut self, line: u64, mut tokens: LineTokens) -> Result<(), ReadError> {
        let name = tokens.next().unwrap_or_default();
        let encoding = match name {
            b"ascii" => PlyEncoding::Text,
            b"binary_little_endian" => PlyEncoding::Little,
            b"binary_big_endian" => PlyEncoding::Big,
            _ => {
                let message =
                    format!("format {} is not ascii, binary_little_endian or binary_big_endian", show(name));
                return Err(error(line, "format-unsupported", message));
            }
        };
        let version = tokens.next().unwrap_or_default();
        if version != b"1.0" {
            let message = format!("version {} is not supported; only 1.0 is", show(version));
            return Err(error(line, "version-unsupported", message));
        }
        if self.encoding.replace(encoding).is_some() {
            return Err(error(line, "duplicate-format", "the format is given twice"));
        }
        Ok(())
    }

    fn element(&mut self, line: u64, mut tokens: LineTokens, limits: &Limits) -> Result<(), ReadError> {
        let name = name(line, &mut tokens, "element")?;
        let count = tokens.next().unwrap_or_default();
        let rows = integer(count).ok().and_then(|n| u64::try_from(n).ok()).ok_or_else(|| {
            let message = format!("element '{name}': {} is not a number of rows below 2^63", show(count));
            error(line, "not-a-count", message)
        })?;
        if rows > limits.rows {
            return Err(crate::assemble::too_many_rows(FileLocation::Line(line), "rows", rows, limits.rows));
        }
        if self.elements.iter().any(|e| e.name == name) {
            return Err(error(line, "duplicate-element", format!("element '{name}' is declared twice")));
        }
        if self.elements.len() >= MOST_ELEMENTS {
            let message = format!("more elements than the limit of {MOST_ELEMENTS}");
            return Err(error(line, "too-many-elements", message));
        }
        self.elements.push(PlyElement { name, rows, properties: Vec::new(), line });
        Ok(())
    }

    fn property(&mut self, line: u64, mut tokens: LineTokens) -> Result<(), ReadError> {
        let mut scalar = || {
            let name = tokens.next().unwrap_or_default();
            let unknown =
                || error(line, "type-unknown", format!("{} is no type whose size is known", show(name)));
            if name == b"list" { Ok(None) } else { PlyScalar::from_name(name).map(Some).ok_or_else(unknown) }
        };
        let twice = || error(line, "type-unknown", "a list of lists is not supported");
        let shape = match scalar()? {
            Some(one) => PlyPropertyType::One(one),
            None => PlyPropertyType::List {
                length: scalar()?.ok_or_else(twice)?,
                item: scalar()?.ok_or_else(twice)?,
            },
        };
        if let PlyPropertyType::List { length, .. } = shape
            && length.range().is_none()
        {
            return Err(error(
                line,
                "type-unknown",
                "the length of a list must be an integer of 8 to 32 bits",
            ));
        }
        let name = name(line, &mut tokens, "property")?;
        let Some(element) = self.elements.last_mut() else {
            return Err(error(line, "no-element", format!("property '{name}' stands before any element")));
        };
        if element.properties.iter().any(|p| p.name == name) {
            let message = format!("property '{name}' of element '{}' is declared twice", element.name);
            return Err(error(line, "duplicate-property", message));
        }
        if element.properties.len() >= MOST_PROPERTIES {
            let message = format!("more properties than the limit of {MOST_PROPERTIES}");
            return Err(error(line, "too-many-properties", message));
        }
        element.properties.push(PlyProperty { name, shape });
        Ok(())
    }

    fn finish(self, lines: u64, body: usize, warnings: &mut Warnings) -> Result<PlyHeader, ReadError> {
        let Self { encoding, elements, certificate, .. } = self;
        let encoding = encoding.ok_or_else(|| error(lines, "no-format", "the header names no format"))?;
        let certificate = certificate.finish(warnings);
        Ok(PlyHeader { encoding, elements, certificate, body, lines })
    }
}

/// Parses the name of an element or property; all characters of a header are printable.
fn name(line: u64, tokens: &mut LineTokens, what: &str) -> Result<String, ReadError> {
    let token = tokens.next().unwrap_or_default();
    match std::str::from_utf8(token) {
        Ok(name) if !name.is_empty() && !name.chars().any(char::is_control) => Ok(name.to_owned()),
        _ => Err(error(line, "no-name", format!("{} is no name of an {what}", show(token)))),
    }
}
