//! `DicomAttributes`: the elements of a file or of an item that a volume needs, by their tags.
use super::elements::{DicomElement, DicomElements};
use crate::grow::push;
use crate::text::{finite, show, trim};
use crate::{FileLocation, ReadError};

/// The tag of an element: its group and its number.
pub(super) type DicomTag = [u16; 2];

pub(super) const DESCRIPTION: DicomTag = [0x0008, 0x103E];
pub(super) const SPACING_BETWEEN: DicomTag = [0x0018, 0x0088];
pub(super) const SERIES: DicomTag = [0x0020, 0x000E];
pub(super) const POSITION: DicomTag = [0x0020, 0x0032];
pub(super) const ORIENTATION: DicomTag = [0x0020, 0x0037];
pub(super) const STACK: DicomTag = [0x0020, 0x9056];
pub(super) const FRAME_CONTENT: DicomTag = [0x0020, 0x9111];
pub(super) const PLANE_POSITION: DicomTag = [0x0020, 0x9113];
pub(super) const PLANE_ORIENTATION: DicomTag = [0x0020, 0x9116];
pub(super) const TIME_INDEX: DicomTag = [0x0020, 0x9128];
pub(super) const SAMPLES: DicomTag = [0x0028, 0x0002];
pub(super) const COLOR_MODEL: DicomTag = [0x0028, 0x0004];
pub(super) const FRAMES: DicomTag = [0x0028, 0x0008];
pub(super) const ROWS: DicomTag = [0x0028, 0x0010];
pub(super) const COLUMNS: DicomTag = [0x0028, 0x0011];
pub(super) const SPACING: DicomTag = [0x0028, 0x0030];
pub(super) const BITS_ALLOCATED: DicomTag = [0x0028, 0x0100];
pub(super) const BITS_STORED: DicomTag = [0x0028, 0x0101];
pub(super) const HIGH_BIT: DicomTag = [0x0028, 0x0102];
pub(super) const IS_SIGNED: DicomTag = [0x0028, 0x0103];
pub(super) const INTERCEPT: DicomTag = [0x0028, 0x1052];
pub(super) const SLOPE: DicomTag = [0x0028, 0x1053];
pub(super) const VALUE_TABLE: DicomTag = [0x0028, 0x3000];
pub(super) const PIXEL_MEASURES: DicomTag = [0x0028, 0x9110];
pub(super) const VALUE_TRANSFORMATION: DicomTag = [0x0028, 0x9145];
pub(super) const SEGMENTATION_KIND: DicomTag = [0x0062, 0x0001];
pub(super) const SEGMENTS: DicomTag = [0x0062, 0x0002];
pub(super) const SEGMENT_NUMBER: DicomTag = [0x0062, 0x0004];
pub(super) const SEGMENT_LABEL: DicomTag = [0x0062, 0x0005];
pub(super) const SEGMENT_COLOR: DicomTag = [0x0062, 0x000D];
pub(super) const LARGEST_FRACTION: DicomTag = [0x0062, 0x000E];
pub(super) const SEGMENT_OF_FRAME: DicomTag = [0x0062, 0x000A];
pub(super) const SEGMENT_REFERENCE: DicomTag = [0x0062, 0x000B];
pub(super) const SHARED_GROUPS: DicomTag = [0x5200, 0x9229];
pub(super) const GROUPS_OF_FRAMES: DicomTag = [0x5200, 0x9230];
pub(super) const LONG_OFFSETS: DicomTag = [0x7FE0, 0x0001];
pub(super) const PIXELS: DicomTag = [0x7FE0, 0x0010];

/// The tags that are kept.
const USED: [DicomTag; 37] = [
    DESCRIPTION,
    SPACING_BETWEEN,
    SERIES,
    POSITION,
    ORIENTATION,
    STACK,
    FRAME_CONTENT,
    PLANE_POSITION,
    PLANE_ORIENTATION,
    TIME_INDEX,
    SAMPLES,
    COLOR_MODEL,
    FRAMES,
    ROWS,
    COLUMNS,
    SPACING,
    BITS_ALLOCATED,
    BITS_STORED,
    HIGH_BIT,
    IS_SIGNED,
    INTERCEPT,
    SLOPE,
    VALUE_TABLE,
    PIXEL_MEASURES,
    VALUE_TRANSFORMATION,
    SEGMENTATION_KIND,
    SEGMENTS,
    SEGMENT_NUMBER,
    SEGMENT_LABEL,
    SEGMENT_COLOR,
    LARGEST_FRACTION,
    SEGMENT_OF_FRAME,
    SEGMENT_REFERENCE,
    SHARED_GROUPS,
    GROUPS_OF_FRAMES,
    LONG_OFFSETS,
    PIXELS,
];

/// The attributes found in a file or an item.
pub(super) struct DicomAttributes<'a> {
    source: DicomElements<'a>,
    all: Vec<DicomElement<'a>>,
}

/// The text of an element: up to its first NUL, trimmed.
pub(super) fn text_of(element: &DicomElement<'_>) -> String {
    let end = element.value.iter().position(|b| *b == 0).unwrap_or(element.value.len());
    String::from_utf8_lossy(trim(&element.value[..end])).into_owned()
}

impl<'a> DicomAttributes<'a> {
    /// The attributes among elements, up to the pixels.
    pub(super) fn read(source: DicomElements<'a>) -> Result<Self, ReadError> {
        let mut elements = source;
        let mut all = Vec::new();
        while let Some(element) = elements.next()? {
            // Only the first of a tag counts.
            if USED.contains(&element.tag) && all.iter().all(|one: &DicomElement<'_>| one.tag != element.tag)
            {
                push(&mut all, element)?;
            }
            if element.tag == PIXELS {
                break;
            }
        }
        Ok(Self { source, all })
    }

    pub(super) fn get(&self, tag: DicomTag) -> Option<DicomElement<'a>> {
        self.all.iter().find(|element| element.tag == tag).copied()
    }

    fn filled(&self, tag: DicomTag) -> Option<DicomElement<'a>> {
        self.get(tag).filter(|element| !element.value.is_empty())
    }

    /// The items of a sequence; none if it is missing.
    pub(super) fn items(&self, tag: DicomTag) -> Result<Vec<DicomElements<'a>>, ReadError> {
        self.get(tag).map_or_else(|| Ok(Vec::new()), |sequence| self.source.items(&sequence))
    }

    /// The attributes of the first item of a sequence.
    pub(super) fn first_item(&self, tag: DicomTag) -> Result<Option<Self>, ReadError> {
        self.items(tag)?.first().map(|item| Self::read(*item)).transpose()
    }

    pub(super) fn text(&self, tag: DicomTag) -> String {
        self.get(tag).map_or_else(String::new, |element| text_of(&element))
    }

    /// The decimal numbers of an attribute, separated by backslashes; `None` if it is missing or empty.
    pub(super) fn numbers<const N: usize>(
        &self,
        tag: DicomTag,
        name: &str,
    ) -> Result<Option<[f64; N]>, ReadError> {
        let Some(element) = self.filled(tag) else { return Ok(None) };
        let place = || FileLocation::Byte(element.at as u64);
        let mut values = [0.0; N];
        let text = text_of(&element);
        let mut tokens = text.split('\\');
        for number in &mut values {
            let token = tokens.next().unwrap_or("");
            *number = finite(trim(token.as_bytes()), place)?;
        }
        match tokens.next() {
            None => Ok(Some(values)),
            Some(_) => {
                let message = format!("{name} {} has more than {N} numbers", show(text.as_bytes()));
                Err(ReadError::new("bad-header", place(), message))
            }
        }
    }

    /// A decimal number.
    pub(super) fn decimal(&self, tag: DicomTag, name: &str) -> Result<Option<f64>, ReadError> {
        Ok(self.numbers::<1>(tag, name)?.map(|[number]| number))
    }

    /// A number of 16 bits.
    pub(super) fn short(&self, tag: DicomTag) -> Option<u64> {
        self.shorts(tag).map(|[number]| u64::from(number))
    }

    /// Numbers of 16 bits.
    pub(super) fn shorts<const N: usize>(&self, tag: DicomTag) -> Option<[u16; N]> {
        let value = self.get(tag)?.value;
        let endian = self.source.syntax().endian;
        let number = |k: usize| u16::from_le_bytes(endian.array(&value[2 * k..]));
        (value.len() >= 2 * N).then(|| std::array::from_fn(number))
    }

    /// A number of 32 bits.
    pub(super) fn long(&self, tag: DicomTag) -> Option<u32> {
        let value = self.get(tag)?.value;
        (value.len() >= 4).then(|| u32::from_le_bytes(self.source.syntax().endian.array(value)))
    }

    /// A number of 16 bits that must be there.
    ///
    /// # Errors
    /// If it is missing or cut off.
    pub(super) fn need_short(&self, tag: DicomTag, name: &str) -> Result<u64, ReadError> {
        self.filled(tag).ok_or_else(|| missing(name))?;
        self.short(tag)
            .ok_or_else(|| ReadError::new("bad-header", FileLocation::File, format!("{name} is cut off")))
    }
}

/// The error of an attribute that is missing.
pub(super) fn missing(name: &str) -> ReadError {
    ReadError::new("missing-attribute", FileLocation::File, format!("the slice has no {name}"))
}
