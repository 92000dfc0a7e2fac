//! `DicomSlice`: the attributes of one file that a volume needs.
use super::elements::{DicomElement, DicomElements, DicomSyntax, after_mark};
use super::run_lengths;
use crate::text::{finite, show, trim};
use crate::volume::element::{Endian, SampleType};
use crate::{FileLocation, ReadError};

/// The storage format of a slice's samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SliceFormat {
    pub columns: u64,
    pub rows: u64,
    pub bits_stored: u64,
    pub high_bit: u64,
    pub element: SampleType,
    pub endian: Endian,
}

/// A slice; its samples are in the bytes of its file.
#[derive(Clone, Debug)]
pub(super) struct DicomSlice {
    pub series: String,
    pub description: String,
    pub format: SliceFormat,
    /// The first byte of the samples.
    pub start: usize,
    pub n_bytes: usize,
    /// The samples, if they were compressed in the file.
    pub unpacked: Option<Vec<u8>>,
    pub position: [f64; 3],
    /// The directions of rows and of columns.
    pub orientation: [f64; 6],
    /// The distance of rows, and of columns.
    pub spacing: [f64; 2],
    pub slope: f64,
    pub inter: f64,
}

/// The attributes found in a file.
#[derive(Default)]
struct SliceAttributes<'a> {
    all: Vec<DicomElement<'a>>,
}

/// The tags of the attributes that are used.
const SERIES: [u16; 2] = [0x0020, 0x000E];
const DESCRIPTION: [u16; 2] = [0x0008, 0x103E];
const POSITION: [u16; 2] = [0x0020, 0x0032];
const ORIENTATION: [u16; 2] = [0x0020, 0x0037];
const SAMPLES: [u16; 2] = [0x0028, 0x0002];
const FRAMES: [u16; 2] = [0x0028, 0x0008];
const ROWS: [u16; 2] = [0x0028, 0x0010];
const COLUMNS: [u16; 2] = [0x0028, 0x0011];
const SPACING: [u16; 2] = [0x0028, 0x0030];
const BITS_ALLOCATED: [u16; 2] = [0x0028, 0x0100];
const BITS_STORED: [u16; 2] = [0x0028, 0x0101];
const HIGH_BIT: [u16; 2] = [0x0028, 0x0102];
const IS_SIGNED: [u16; 2] = [0x0028, 0x0103];
const INTERCEPT: [u16; 2] = [0x0028, 0x1052];
const SLOPE: [u16; 2] = [0x0028, 0x1053];
const PIXELS: [u16; 2] = [0x7FE0, 0x0010];
const USED: [[u16; 2]; 16] = [
    SERIES,
    DESCRIPTION,
    POSITION,
    ORIENTATION,
    SAMPLES,
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
    PIXELS,
];
/// The encoding of the data set.
const TRANSFER_SYNTAX: [u16; 2] = [0x0002, 0x0010];

impl DicomSlice {
    /// The slice in a file; `None` if the file is not DICOM, or has no picture.
    ///
    /// # Errors
    /// If it is truncated, compressed, or lacks attributes that place its samples.
    pub(super) fn read(bytes: &[u8]) -> Result<Option<Self>, ReadError> {
        let Some(start) = after_mark(bytes) else { return Ok(None) };
        let mut meta = DicomElements::new(bytes, start, DicomSyntax::META);
        let mut syntax = None;
        while meta.next_group() == Some(0x0002) {
            let Some(element) = meta.next()? else { break };
            if element.tag == TRANSFER_SYNTAX {
                syntax = Some(syntax_of(&element)?);
            }
        }
        let (syntax, packing) = syntax.ok_or_else(|| {
            ReadError::new(
                "bad-header",
                FileLocation::Byte(start as u64),
                "the file names no transfer syntax",
            )
        })?;
        let mut attributes = SliceAttributes::default();
        let mut elements = DicomElements::new(bytes, meta.at(), syntax);
        while let Some(element) = elements.next()? {
            if USED.contains(&element.tag) {
                attributes.all.push(element);
            }
            if element.tag == PIXELS {
                break;
            }
        }
        let Some(pixels) = attributes.get(PIXELS) else { return Ok(None) };
        let is_runs = packing == Some(RUN_LENGTHS);
        if let Some(name) = packing.filter(|_| !is_runs) {
            let message = format!("pixels packed as {name} are not read: save the series uncompressed");
            return Err(ReadError::new("packed-pixels", FileLocation::Byte(pixels.at as u64), message));
        }
        attributes.slice(&pixels, (syntax.endian, is_runs)).map(Some)
    }
}

/// The supported compression.
const RUN_LENGTHS: &str = "run lengths";

/// The encoding of the data set, and the name of the compression of its pixels.
fn syntax_of(element: &DicomElement<'_>) -> Result<(DicomSyntax, Option<&'static str>), ReadError> {
    let little = |is_explicit| DicomSyntax { endian: Endian::Little, is_explicit };
    let uid = text_of(element);
    let packed = |name| Ok((little(true), Some(name)));
    match uid.as_str() {
        "1.2.840.10008.1.2" => Ok((little(false), None)),
        "1.2.840.10008.1.2.1" => Ok((little(true), None)),
        "1.2.840.10008.1.2.2" => Ok((DicomSyntax { endian: Endian::Big, is_explicit: true }, None)),
        "1.2.840.10008.1.2.5" => packed(RUN_LENGTHS),
        "1.2.840.10008.1.2.4.50" | "1.2.840.10008.1.2.4.51" => packed("JPEG"),
        "1.2.840.10008.1.2.4.57" | "1.2.840.10008.1.2.4.70" => packed("lossless JPEG"),
        "1.2.840.10008.1.2.4.80" | "1.2.840.10008.1.2.4.81" => packed("JPEG-LS"),
        "1.2.840.10008.1.2.4.90" | "1.2.840.10008.1.2.4.91" => packed("JPEG 2000"),
        other => {
            let message = format!("the transfer syntax {} is not read", show(other.as_bytes()));
            Err(ReadError::new("unsupported", FileLocation::Byte(element.at as u64), message))
        }
    }
}

fn text_of(element: &DicomElement<'_>) -> String {
    let end = element.value.iter().position(|b| *b == 0).unwrap_or(element.value.len());
    String::from_utf8_lossy(trim(&element.value[..end])).into_owned()
}

impl<'a> SliceAttributes<'a> {
    fn get(&self, tag: [u16; 2]) -> Option<DicomElement<'a>> {
        self.all.iter().find(|element| element.tag == tag).copied()
    }

    fn need(&self, tag: [u16; 2], name: &str) -> Result<DicomElement<'a>, ReadError> {
        self.get(tag).filter(|element| !element.value.is_empty()).ok_or_else(|| {
            let message = format!("the slice has no {name}");
            ReadError::new("missing-attribute", FileLocation::File, message)
        })
    }

    fn text(&self, tag: [u16; 2]) -> String {
        self.get(tag).map_or_else(String::new, |element| text_of(&element))
    }

    /// The decimal numbers of an attribute, separated by backslashes.
    fn numbers<const N: usize>(&self, tag: [u16; 2], name: &str) -> Result<[f64; N], ReadError> {
        let element = self.need(tag, name)?;
        let place = || FileLocation::Byte(element.at as u64);
        let mut values = [0.0; N];
        let text = text_of(&element);
        let mut tokens = text.split('\\');
        for number in &mut values {
            let token = tokens.next().unwrap_or("");
            *number = finite(trim(token.as_bytes()), place)?;
        }
        match tokens.next() {
            None => Ok(values),
            Some(_) => {
                let message = format!("{name} {} has more than {N} numbers", show(text.as_bytes()));
                Err(ReadError::new("bad-header", place(), message))
            }
        }
    }

    /// A number of 16 bits.
    fn u16_value(&self, tag: [u16; 2], endian: Endian) -> Option<u64> {
        let value = self.get(tag)?.value;
        (value.len() >= 2).then(|| u64::from(u16::from_le_bytes(endian.array(value))))
    }

    fn slice(
        &self,
        pixels: &DicomElement<'_>,
        (endian, is_runs): (Endian, bool),
    ) -> Result<DicomSlice, ReadError> {
        let short = |tag, name: &str| {
            self.need(tag, name)?;
            self.u16_value(tag, endian)
                .ok_or_else(|| ReadError::new("bad-header", FileLocation::File, format!("{name} is cut off")))
        };
        let at = FileLocation::Byte(pixels.at as u64);
        let unsupported = |message: String| Err(ReadError::new("unsupported", at.clone(), message));
        let channels = self.u16_value(SAMPLES, endian).unwrap_or(1);
        if channels != 1 {
            let message = format!("{channels} samples a pixel are colours, and no volume");
            return Err(ReadError::new("several-channels", at, message));
        }
        let frames = self.text(FRAMES);
        if !matches!(frames.as_str(), "" | "1") {
            return unsupported(format!(
                "several frames in one file ({frames}) are not read: save one slice a file"
            ));
        }
        let bits = short(BITS_ALLOCATED, "BitsAllocated")?;
        let is_signed = self.u16_value(IS_SIGNED, endian).unwrap_or(0) == 1;
        let element = match (bits, is_signed) {
            (8, false) => SampleType::U8,
            (8, true) => SampleType::I8,
            (16, false) => SampleType::U16,
            (16, true) => SampleType::I16,
            (32, false) => SampleType::U32,
            (32, true) => SampleType::I32,
            _ => return unsupported(format!("samples of {bits} bits are not read: 8, 16 and 32 are")),
        };
        let bits_stored = self.u16_value(BITS_STORED, endian).unwrap_or(bits);
        let high_bit = self.u16_value(HIGH_BIT, endian).unwrap_or_else(|| bits_stored.saturating_sub(1));
        if bits_stored == 0 || high_bit >= bits || high_bit + 1 < bits_stored {
            let message = format!("{bits_stored} bits up to bit {high_bit} do not lie in {bits}");
            return Err(ReadError::new("bad-header", at, message));
        }
        if pixels.is_in_pieces != is_runs {
            let is = if is_runs {
                "are not in pieces, which packed ones are"
            } else {
                "are in pieces, which only packed ones are"
            };
            return unsupported(format!("the pixels {is}"));
        }
        let optional = |tag, name: &str, without: f64| match self.get(tag).filter(|e| !e.value.is_empty()) {
            None => Ok(without),
            Some(_) => self.numbers::<1>(tag, name).map(|one| one[0]),
        };
        let (columns, rows) = (short(COLUMNS, "Columns")?, short(ROWS, "Rows")?);
        let runs = || run_lengths::unpack(pixels, (columns * rows, element.width()), endian);
        let unpacked = is_runs.then(runs).transpose()?;
        Ok(DicomSlice {
            series: self.text(SERIES),
            description: self.text(DESCRIPTION),
            format: SliceFormat {
                columns,
                rows,
                bits_stored,
                high_bit,
                element,
                // Numbers of one byte have no byte order.
                endian,
            },
            start: pixels.at,
            n_bytes: pixels.value.len(),
            unpacked,
            position: self.numbers(POSITION, "ImagePositionPatient")?,
            orientation: self.numbers(ORIENTATION, "ImageOrientationPatient")?,
            spacing: self.numbers(SPACING, "PixelSpacing")?,
            slope: optional(SLOPE, "RescaleSlope", 1.0)?,
            inter: optional(INTERCEPT, "RescaleIntercept", 0.0)?,
        })
    }
}

impl SliceFormat {
    /// The bytes of a slice.
    pub(super) fn n_bytes(&self) -> u64 {
        // Rows and columns have 16 bits each.
        self.columns * self.rows * self.element.width() as u64
    }

    /// Appends the samples as little-endian bytes, without the unused bits.
    pub(super) fn decode(&self, bytes: &[u8], out: &mut Vec<u8>) -> Result<(), ReadError> {
        out.try_reserve(bytes.len()).map_err(|_| crate::grow::out_of_memory(out.len()))?;
        let width = self.element.width();
        let is_signed = matches!(self.element, SampleType::I8 | SampleType::I16 | SampleType::I32);
        // Both are counts of bits in a u64.
        let (left, right) = (63 - self.high_bit, 64 - self.bits_stored);
        for sample in bytes.chunks_exact(width) {
            let mut number = [0; 8];
            number[..width].copy_from_slice(sample);
            if self.endian == Endian::Big {
                number[..width].reverse();
            }
            let moved = u64::from_le_bytes(number) << left;
            let value = if is_signed { (moved as i64 >> right) as u64 } else { moved >> right };
            out.extend_from_slice(&value.to_le_bytes()[..width]);
        }
        Ok(())
    }
}
