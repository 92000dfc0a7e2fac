//! The lines `Key = value` at the start of a MetaImage.
use crate::text::{LineTokens, TextLines, finite, integer, show, trim};
use crate::{FileLocation, Limits, ReadError};
use chordal::budget::advice::Message;

/// The last key of a header: the samples follow, or the names of their files.
pub(super) const LAST_KEY: &str = "ElementDataFile";
/// The most fields. Chosen: programs copy hundreds of entries of a DICOM file into a header.
const MOST_FIELDS: usize = 10_000;

/// A value with its line number.
#[derive(Clone, Copy, Debug)]
pub(super) struct MetaField<'a> {
    pub key: &'a str,
    pub value: &'a [u8],
    pub line: u64,
}

impl<'a> MetaField<'a> {
    pub(super) fn place(&self) -> FileLocation {
        FileLocation::Line(self.line)
    }

    pub(super) fn wrong(&self, message: impl Into<Message>) -> ReadError {
        ReadError::new("bad-header", self.place(), message)
    }

    /// Its value as shown in messages.
    pub(super) fn shown(&self) -> String {
        show(self.value)
    }

    /// Its only whole number.
    pub(super) fn integer(&self) -> Result<i64, ReadError> {
        integer(self.value)
            .map_err(|_| self.wrong(format!("{} {} is no whole number", self.key, self.shown())))
    }

    /// Its whole numbers.
    pub(super) fn integers(&self) -> Result<Vec<i64>, ReadError> {
        let one = |token: &[u8]| {
            integer(token).map_err(|_| self.wrong(format!("{} is no whole number", show(token))))
        };
        LineTokens::new(self.value).map(one).collect()
    }

    /// Its finite numbers, `n` of them.
    pub(super) fn numbers(&self, n: usize) -> Result<Vec<f64>, ReadError> {
        let values: Result<Vec<f64>, _> =
            LineTokens::new(self.value).map(|token| finite(token, || self.place())).collect();
        let values = values?;
        if values.len() != n {
            return Err(self.wrong(format!("{} has {} numbers; {n} are expected", self.key, values.len())));
        }
        Ok(values)
    }

    /// Whether its value is true: "True", "T" or "1".
    pub(super) fn truth(&self) -> Result<bool, ReadError> {
        match self.value.to_ascii_lowercase().as_slice() {
            b"true" | b"t" | b"1" => Ok(true),
            b"false" | b"f" | b"0" => Ok(false),
            _ => Err(self.wrong(format!("{} is True or False, not {}", self.key, self.shown()))),
        }
    }

    /// The words of its value, if it is text.
    pub(super) fn text(&self) -> Result<&'a str, ReadError> {
        std::str::from_utf8(self.value)
            .map_err(|_| self.wrong(format!("{} {} is not UTF-8", self.key, self.shown())))
    }
}

/// All lines of a header.
pub(super) struct MetaFields<'a> {
    all: Vec<MetaField<'a>>,
    /// The last line that was read.
    pub last_line: u64,
    /// The byte after the last line.
    pub end: usize,
}

impl<'a> MetaFields<'a> {
    /// The lines up to the one that says where the samples are.
    ///
    /// # Errors
    /// At a line that is not a field, or repeats one; at the end if the last key is missing.
    pub(super) fn read(bytes: &'a [u8], limits: &Limits) -> Result<Self, ReadError> {
        let mut fields = Self { all: Vec::new(), last_line: 0, end: 0 };
        let mut seen = std::collections::BTreeSet::new();
        let mut lines = TextLines::new(bytes);
        while let Some((line, text)) = lines.next() {
            fields.last_line = line;
            let wrong =
                |message: String| Err(ReadError::new("bad-header", FileLocation::Line(line), message));
            if text.len() > limits.header_line {
                let message = format!("a line of more than {} bytes", limits.header_line);
                return Err(ReadError::new("line-too-long", FileLocation::Line(line), message));
            }
            if trim(text).is_empty() {
                continue;
            }
            let Some((key, value)) = field(text) else {
                return wrong(format!("{} is no field of a MetaImage, as in 'NDims = 3'", show(text)));
            };
            // Comments are the only key that may be repeated.
            if !seen.insert(key) && key != "Comment" {
                return wrong(format!("field '{key}' is there twice"));
            }
            if fields.all.len() == MOST_FIELDS {
                return wrong(format!("more than {MOST_FIELDS} fields"));
            }
            fields.all.push(MetaField { key, value, line });
            if key == LAST_KEY {
                fields.end = lines.offset();
                return Ok(fields);
            }
        }
        Err(fields.missing(LAST_KEY))
    }

    pub(super) fn get(&self, key: &str) -> Option<MetaField<'a>> {
        self.all.iter().find(|field| field.key == key).copied()
    }

    /// A required field.
    pub(super) fn need(&self, key: &str) -> Result<MetaField<'a>, ReadError> {
        self.get(key).ok_or_else(|| self.missing(key))
    }

    /// The field with one of several synonymous names.
    pub(super) fn one_of(&self, keys: &[&str]) -> Result<Option<MetaField<'a>>, ReadError> {
        let mut matching = self.all.iter().filter(|field| keys.contains(&field.key));
        let Some(first) = matching.next() else { return Ok(None) };
        match matching.find(|other| other.value != first.value) {
            Some(other) => Err(other.wrong(format!(
                "{} differs from {} in line {}, which means the same",
                other.key, first.key, first.line
            ))),
            None => Ok(Some(*first)),
        }
    }

    /// The fields with other keys than these.
    pub(super) fn others(&self, known: &[&str]) -> impl Iterator<Item = &MetaField<'a>> {
        self.all.iter().filter(|field| !known.contains(&field.key))
    }

    fn missing(&self, key: &str) -> ReadError {
        let place = FileLocation::Line(self.last_line.max(1));
        ReadError::new("bad-header", place, format!("the header has no '{key}'"))
    }
}

/// The key and the value of a line.
fn field(line: &[u8]) -> Option<(&str, &[u8])> {
    let at = memchr::memchr(b'=', line)?;
    let key = std::str::from_utf8(trim(&line[..at])).ok()?;
    let is_key = |c: char| !c.is_control() && c != '\u{fffd}';
    (!key.is_empty() && key.chars().all(is_key)).then_some((key, trim(&line[at + 1..])))
}

/// Whether bytes look like a MetaImage: fields from the first line on, including the number of axes.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    /// The possible first keys of a header, the usual one first.
    const FIRST: [&str; 4] = ["ObjectType", "NDims", "Comment", "DimSize"];
    /// Chosen: comments at the start may be long.
    const MOST_LINES: usize = 50;
    let mut lines = TextLines::new(bytes).filter(|(_, line)| !trim(line).is_empty()).take(MOST_LINES);
    let key = |line: &'_ [u8]| field(line).map(|(key, _)| key.to_owned());
    let first = lines.next().and_then(|(_, line)| key(line));
    let Some(first) = first.filter(|first| FIRST.contains(&first.as_str())) else { return false };
    first == "NDims" || lines.map_while(|(_, line)| key(line)).any(|key| key == "NDims")
}
