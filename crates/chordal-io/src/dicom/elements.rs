//! `DicomElements`: the data elements of a file or of an item in order. Those inside a sequence are its
//! value.
use crate::grow::push;
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
/// The most items of a sequence, of which an empty one has 8 bytes, and takes many more as a frame. Chosen: the
/// masks of 1,000 segments in 1,000 slices.
const MOST_ITEMS: usize = 1 << 20;

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
    /// The encoding inside a sequence of unknown type, the same in every file.
    ///
    /// Source: NEMA, *DICOM PS3.5*, 2024, 6.2.2.
    const INSIDE_UNKNOWN: Self = Self { endian: Endian::Little, is_explicit: false };
}

/// One element.
#[derive(Clone, Copy, Debug)]
pub(super) struct DicomElement<'a> {
    pub tag: [u16; 2],
    /// Its bytes: all items if it is a sequence, or if the value is fragmented.
    pub value: &'a [u8],
    /// The byte at which the value starts.
    pub at: usize,
    /// Whether its value is fragmented, as compressed pictures are.
    pub is_in_pieces: bool,
    /// Whether its type says that it holds words of 16 bits.
    pub has_words: bool,
    /// The encoding of the items in it.
    inner: DicomSyntax,
}

/// The byte after the signature of a DICOM file.
pub(super) fn after_mark(bytes: &[u8]) -> Option<usize> {
    let end = PREAMBLE + MAGIC.len();
    (bytes.get(PREAMBLE..end)? == MAGIC).then_some(end)
}

/// The items of a fragmented value: for each the byte at which it starts, and its bytes.
///
/// # Errors
/// If an item has no explicit length.
pub(super) fn fragments<'a>(element: &DicomElement<'a>) -> Result<Vec<(usize, &'a [u8])>, ReadError> {
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
        let at = element.at + inner.at;
        push(&mut items, (at, inner.take(head.length as usize)?))?;
    }
    Ok(items)
}

/// The elements from a byte on.
#[derive(Clone, Copy)]
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
    has_words: bool,
    inner: DicomSyntax,
}

impl<'a> DicomElements<'a> {
    pub(super) fn new(bytes: &'a [u8], at: usize, syntax: DicomSyntax) -> Self {
        Self { bytes, at, syntax }
    }

    /// The byte of the next element.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// The encoding of the elements.
    pub(super) fn syntax(&self) -> DicomSyntax {
        self.syntax
    }

    /// The items of a sequence that is one of these elements, each as its own elements.
    ///
    /// # Errors
    /// If an item is truncated, or is none, or there are too many.
    pub(super) fn items(&self, sequence: &DicomElement<'a>) -> Result<Vec<Self>, ReadError> {
        let end = sequence.at + sequence.value.len();
        let mut inner = Self { bytes: &self.bytes[..end], at: sequence.at, syntax: sequence.inner };
        let mut items = Vec::new();
        while inner.at < end {
            let at = inner.at;
            let head = inner.head()?;
            if head.tag == SEQUENCE_END {
                break;
            }
            if head.tag != ITEM {
                let message = "a sequence holds something that is no item";
                return Err(ReadError::new("bad-header", FileLocation::Byte(at as u64), message));
            }
            if items.len() == MOST_ITEMS {
                let message = format!("a sequence has more than {} items", grouped(MOST_ITEMS as u64));
                return Err(ReadError::new("too-large", FileLocation::Byte(at as u64), message));
            }
            let start = inner.at;
            let end = if head.length == UNDEFINED {
                inner.pass_elements()?
            } else {
                inner.take(head.length as usize)?;
                inner.at
            };
            push(&mut items, Self { bytes: &self.bytes[..end], at: start, syntax: sequence.inner })?;
        }
        Ok(items)
    }

    /// Skips the elements of an item of unknown length with its end, and returns the byte where they end.
    fn pass_elements(&mut self) -> Result<usize, ReadError> {
        loop {
            let at = self.at;
            match self.next()? {
                Some(element) if element.tag == ITEM_END => return Ok(at),
                Some(_) => {}
                None => {
                    let message = "the file is cut off: an item of a sequence has no end";
                    return Err(ReadError::new("truncated", FileLocation::Byte(at as u64), message));
                }
            }
        }
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
        let ElementHead { tag, has_words, inner, .. } = head;
        let element = |value, is_in_pieces| DicomElement { tag, value, at, is_in_pieces, has_words, inner };
        if head.length == UNDEFINED {
            self.pass_items(inner)?;
            return Ok(Some(element(&self.bytes[at..self.at], !head.is_sequence)));
        }
        let value = self.take(head.length as usize)?;
        Ok(Some(element(value, false)))
    }

    /// Skips the items, encoded as `inner`, of a sequence of unknown length, and all sequences inside.
    fn pass_items(&mut self, inner: DicomSyntax) -> Result<(), ReadError> {
        // The end tags of the open sequences and of the open items of unknown length, each with the encoding
        // around it.
        let mut open = vec![(SEQUENCE_END, self.syntax)];
        self.syntax = inner;
        while let Some((end, around)) = open.last().copied() {
            let at = self.at;
            let head = self.head()?;
            if head.tag == end {
                self.syntax = around;
                open.pop();
            } else if head.length != UNDEFINED {
                self.take(head.length as usize)?;
            } else if open.len() >= DEEPEST {
                let message = format!("sequences are nested deeper than {DEEPEST} levels");
                return Err(ReadError::new("too-deep", FileLocation::Byte(at as u64), message));
            } else {
                open.push((if head.tag == ITEM { ITEM_END } else { SEQUENCE_END }, self.syntax));
                self.syntax = head.inner;
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
                has_words: false,
                inner: self.syntax,
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
        let inner = if kind == b"UN" { DicomSyntax::INSIDE_UNKNOWN } else { self.syntax };
        Ok(ElementHead { tag, length, is_sequence, has_words: kind == b"OW", inner })
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
