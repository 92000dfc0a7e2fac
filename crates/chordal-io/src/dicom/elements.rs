//! `DicomElements`: the data elements of a file in order, without those inside sequences.
use crate::text::grouped;
use crate::volume::element::Endian;
use crate::{FileLocation, ReadError};

/// The bytes of the preamble, which four letters follow. Defined by the standard.
const PREAMBLE: usize = 128;
const MAGIC: &[u8] = b"DICM";
/// A length that is not known in advance: the end has a delimiter.
const UNDEFINED: u32 = 0xFFFF_FFFF;
/// The tags of items, of the end of an item, and of the end of a sequence.
const ITEM: [u16; 2] = [0xFFFE, 0xE000];
const ITEM_END: [u16; 2] = [0xFFFE, 0xE00D];
const SEQUENCE_END: [u16; 2] = [0xFFFE, 0xE0DD];
/// The deepest nesting of sequences. Chosen: structured reports have some ten levels.
const DEEPEST: usize = 64;

/// The start of a file's data set, and the encoding of its elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct DicomSyntax {
    pub endian: Endian,
    /// Whether each element states its type.
    pub is_explicit: bool,
}

impl DicomSyntax {
    /// The encoding of the elements before the data set, the same in every file.
    pub(super) const META: Self = Self { endian: Endian::Little, is_explicit: true };
}

/// One element.
#[derive(Clone, Copy, Debug)]
pub(super) struct DicomElement<'a> {
    pub tag: [u16; 2],
    /// Its bytes; empty for a sequence, and all items if the value is fragmented.
    pub value: &'a [u8],
    /// The byte at which the value starts.
    pub at: usize,
    /// Whether its value is fragmented, as compressed pictures are.
    pub is_in_pieces: bool,
}

/// The byte after the signature of a DICOM file.
pub(super) fn after_mark(bytes: &[u8]) -> Option<usize> {
    let end = PREAMBLE + MAGIC.len();
    (bytes.get(PREAMBLE..end)? == MAGIC).then_some(end)
}

/// The items of a fragmented value: for each its offset from the start of the value, and its bytes.
///
/// # Errors
/// If an item has no explicit length.
pub(super) fn items<'a>(element: &DicomElement<'a>) -> Result<Vec<(usize, &'a [u8])>, ReadError> {
    // Compressed pixels are little-endian in every syntax.
    let mut inner = DicomElements::new(element.value, 0, DicomSyntax::META);
    let mut items = Vec::new();
    while inner.at < element.value.len() {
        let head = inner.head()?;
        if head.tag == SEQUENCE_END {
            break;
        }
        if head.tag != ITEM || head.length == UNDEFINED {
            let place = FileLocation::Byte((element.at + inner.at) as u64);
            return Err(ReadError::new("bad-header", place, "a piece of packed pixels has no length"));
        }
        let at = inner.at;
        items.push((at, inner.take(head.length as usize)?));
    }
    Ok(items)
}

/// The elements from a byte on.
pub(super) struct DicomElements<'a> {
    bytes: &'a [u8],
    at: usize,
    syntax: DicomSyntax,
}

/// The tag and the length of an element.
struct ElementHead {
    tag: [u16; 2],
    length: u32,
    /// Whether the value is a sequence by its type.
    is_sequence: bool,
}

impl<'a> DicomElements<'a> {
    pub(super) fn new(bytes: &'a [u8], at: usize, syntax: DicomSyntax) -> Self {
        Self { bytes, at, syntax }
    }

    /// The byte of the next element.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// The group of the next element, if there is one.
    pub(super) fn next_group(&self) -> Option<u16> {
        self.bytes.get(self.at..self.at + 2).map(|two| u16::from_le_bytes(self.syntax.endian.array(two)))
    }

    /// The next element, or `None` at the end.
    ///
    /// # Errors
    /// If it is truncated, or sequences are nested too deep or never end.
    pub(super) fn next(&mut self) -> Result<Option<DicomElement<'a>>, ReadError> {
        if self.at == self.bytes.len() {
            return Ok(None);
        }
        let head = self.head()?;
        let at = self.at;
        let element = |value, is_in_pieces| DicomElement { tag: head.tag, value, at, is_in_pieces };
        if head.length == UNDEFINED {
            self.pass_items()?;
            let pieces = if head.is_sequence { &[] } else { &self.bytes[at..self.at] };
            return Ok(Some(element(pieces, !head.is_sequence)));
        }
        let value = self.take(head.length as usize)?;
        Ok(Some(element(if head.is_sequence { &[] } else { value }, false)))
    }

    /// Skips the items of a sequence of unknown length, and all sequences inside.
    fn pass_items(&mut self) -> Result<(), ReadError> {
        // The end tags of the open sequences and of the open items of unknown length.
        let mut open = vec![SEQUENCE_END];
        while let Some(end) = open.last().copied() {
            let at = self.at;
            let head = self.head()?;
            if head.tag == end {
                open.pop();
            } else if head.length != UNDEFINED {
                self.take(head.length as usize)?;
            } else if open.len() >= DEEPEST {
                let message = format!("sequences are nested deeper than {DEEPEST} levels");
                return Err(ReadError::new("too-deep", FileLocation::Byte(at as u64), message));
            } else {
                open.push(if head.tag == ITEM { ITEM_END } else { SEQUENCE_END });
            }
        }
        Ok(())
    }

    fn head(&mut self) -> Result<ElementHead, ReadError> {
        let endian = self.syntax.endian;
        let u16_of = |bytes: &[u8]| u16::from_le_bytes(endian.array(bytes));
        let u32_of = |bytes: &[u8]| u32::from_le_bytes(endian.array(bytes));
        let first = self.take(8)?;
        let tag = [u16_of(first), u16_of(&first[2..])];
        // Items and their delimiters have no type in any syntax.
        if !self.syntax.is_explicit || tag[0] == ITEM[0] {
            let length = u32_of(&first[4..]);
            // Without types, only sequences have an undefined length, and their items are skipped with them.
            return Ok(ElementHead {
                tag,
                length,
                is_sequence: length == UNDEFINED && tag != [0x7FE0, 0x0010],
            });
        }
        let kind = &first[4..6];
        let is_long =
            [b"OB", b"OD", b"OF", b"OL", b"OV", b"OW", b"SQ", b"SV", b"UC", b"UN", b"UR", b"UT", b"UV"]
                .iter()
                .any(|long| kind == *long);
        let length = if is_long { u32_of(self.take(4)?) } else { u32::from(u16_of(&first[6..])) };
        // An element of unknown type and length is a sequence.
        let is_sequence = kind == b"SQ" || kind == b"UN" && length == UNDEFINED;
        Ok(ElementHead { tag, length, is_sequence })
    }

    fn take(&mut self, n: usize) -> Result<&'a [u8], ReadError> {
        let end = self.at.checked_add(n).filter(|end| *end <= self.bytes.len()).ok_or_else(|| {
            let message = format!(
                "the file is cut off: an element needs {} bytes more than the {} that are there",
                grouped(n as u64),
                grouped((self.bytes.len() - self.at) as u64)
            );
            ReadError::new("truncated", FileLocation::Byte(self.at as u64), message)
        })?;
        let taken = &self.bytes[self.at..end];
        self.at = end;
        Ok(taken)
    }
}
