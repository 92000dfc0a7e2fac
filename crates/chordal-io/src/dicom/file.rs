//! `DicomFile`: one file of a series, with the frames in it, one or many.
use super::attributes::{
    COLOR_MODEL, DESCRIPTION, DicomAttributes, FRAMES, GROUPS_OF_FRAMES, LONG_OFFSETS, PIXELS, SERIES,
    SHARED_GROUPS, VALUE_TABLE, missing, text_of,
};
use super::elements::{DicomElement, DicomElements, DicomSyntax, after_mark};
use super::frame_facts::FrameFacts;
use super::pixel_pieces::PixelPieces;
use super::segment_table::SegmentTable;
use super::slice::SliceFormat;
use super::transfer_syntax::{PixelPacking, TransferSyntax};
use crate::grow::with_room;
use crate::text::{grouped, show};
use crate::unpack_cap::UnpackCap;
use crate::volume::element::{Endian, SampleType};
use crate::volume::inflate::InflateReader;
use crate::{FileLocation, Limits, ReadError};
use std::borrow::Cow;
use std::ops::Range;

/// The element that names the transfer syntax.
const TRANSFER_SYNTAX: [u16; 2] = [0x0002, 0x0010];

/// A file with at least one frame.
pub(super) struct DicomFile<'a> {
    /// Its name in a list of files, or empty.
    pub name: String,
    /// The bytes that places of pixels refer to: the file, or its inflated data set.
    bytes: Cow<'a, [u8]>,
    pub series: String,
    pub description: String,
    pub format: SliceFormat,
    pub frames: Vec<DicomFrame>,
    pub segments: SegmentTable,
    /// Whether samples are numbers of colours in a palette, and not of segments.
    pub has_palette: bool,
    packing: PixelPacking,
    pixels: PixelPlaces,
}

/// A file with pixels.
pub(super) enum PixelFile<'a> {
    Read(Box<DicomFile<'a>>),
    /// One that is no part of a volume, with its series and the reason.
    Refused {
        series: String,
        error: ReadError,
    },
}

/// What a file says about its frames.
struct FileParts {
    format: SliceFormat,
    frames: Vec<DicomFrame>,
    segments: SegmentTable,
    pixels: PixelPlaces,
}

/// One frame of a file.
#[derive(Clone, Debug)]
pub(super) struct DicomFrame {
    pub position: [f64; 3],
    pub orientation: [f64; 6],
    pub spacing: [f64; 2],
    pub between: Option<f64>,
    pub slope: f64,
    pub inter: f64,
    pub stack: Option<String>,
    pub time: Option<u32>,
    pub segment: Option<u16>,
}

/// The places of all frames' pixels.
enum PixelPlaces {
    /// One after another, from a byte on.
    Plain {
        start: usize,
        n_bytes: usize,
    },
    Packed(PixelPieces),
}

impl<'a> DicomFile<'a> {
    /// Reads a file; `None` if it has no pixels, or is no DICOM at all. It is refused if a necessary attribute
    /// is missing, its pixels are packed in a way that is not read, or its frames have no positions.
    ///
    /// # Errors
    /// If it is truncated, or its elements cannot be told apart.
    pub(super) fn read(
        name: &str,
        mut bytes: Cow<'a, [u8]>,
        limits: &Limits,
    ) -> Result<Option<PixelFile<'a>>, ReadError> {
        let Some(start) = after_mark(&bytes) else { return Ok(None) };
        let mut meta = DicomElements::new(&bytes, start, DicomSyntax::META);
        let mut syntax = None;
        while meta.next_group() == Some(0x0002) {
            let Some(element) = meta.next()? else { break };
            if element.tag == TRANSFER_SYNTAX {
                syntax = Some(syntax_of(&element)?);
            }
        }
        let syntax = syntax.ok_or_else(|| {
            let place = FileLocation::Byte(start as u64);
            ReadError::new("bad-header", place, "the file names no transfer syntax")
        })?;
        let mut at = meta.at();
        if syntax.0.is_deflated {
            bytes = Cow::Owned(inflated(&bytes[at..], at as u64, limits)?);
            at = 0;
        }
        let attributes = DicomAttributes::read(DicomElements::new(&bytes, at, syntax.0.elements))?;
        let Some(pixels) = attributes.get(PIXELS) else { return Ok(None) };
        let series = attributes.text(SERIES);
        let parts = match FileParts::read(&attributes, &pixels, &syntax) {
            Ok(parts) => parts,
            Err(error) => return Ok(Some(PixelFile::Refused { series, error })),
        };
        let description = attributes.text(DESCRIPTION);
        let has_palette = attributes.text(COLOR_MODEL) == "PALETTE COLOR" && parts.segments.is_empty();
        if pixels.has_words && parts.format.endian == Endian::Big && parts.format.element.width() == 1 {
            bytes = Cow::Owned(with_words_turned(&bytes, pixels.at..pixels.at + pixels.value.len())?);
        }
        let FileParts { format, frames, segments, pixels } = parts;
        Ok(Some(PixelFile::Read(Box::new(Self {
            name: name.to_owned(),
            bytes,
            series,
            description,
            format,
            frames,
            segments,
            has_palette,
            packing: syntax.0.packing,
            pixels,
        }))))
    }

    /// The bytes that the samples of all frames take in the file, and as samples.
    pub(super) fn sizes(&self) -> (u64, u64) {
        let stored = match &self.pixels {
            PixelPlaces::Plain { n_bytes, .. } => *n_bytes,
            PixelPlaces::Packed(pieces) => pieces.n_bytes(),
        };
        (stored as u64, self.format.n_bytes().saturating_mul(self.frames.len() as u64))
    }

    /// The name of a frame for a message: that of its file, if it is the only one.
    pub(super) fn name_of(&self, frame: usize) -> String {
        match self.frames.len() {
            1 => self.name.clone(),
            _ if self.name.is_empty() => format!("frame {}", frame + 1),
            _ => format!("{}, frame {}", self.name, frame + 1),
        }
    }

    /// Appends the samples of a frame as little-endian bytes.
    ///
    /// # Errors
    /// If they are not as many as the size of the frame takes, or cannot be unpacked.
    pub(super) fn append_samples(&self, frame: usize, out: &mut Vec<u8>) -> Result<(), ReadError> {
        let n = self.format.n_bytes();
        match &self.pixels {
            PixelPlaces::Plain { start, n_bytes } => {
                let all = n.saturating_mul(self.frames.len() as u64);
                // An odd number of bytes is padded by one.
                if (*n_bytes as u64) < all || *n_bytes as u64 > all + all % 2 {
                    let message = format!("the slice has {n_bytes} bytes of samples; its size takes {all}");
                    return Err(ReadError::new("size-mismatch", FileLocation::Byte(*start as u64), message));
                }
                let begin = start + frame * n as usize;
                self.format.decode(&self.bytes[begin..begin + n as usize], out)
            }
            PixelPlaces::Packed(pieces) => {
                let (at, packed) = pieces.frame(&self.bytes, frame);
                let samples = super::packed_pixels::unpack(self.packing, (&packed, at), &self.format)?;
                self.format.decode(&samples, out)
            }
        }
    }

    /// Whether a sample of a frame of one bit a sample is set; the frames are one run of bits.
    pub(super) fn bit(&self, frame: usize, pixel: usize) -> bool {
        let PixelPlaces::Plain { start, .. } = self.pixels else { return false };
        let bit = frame as u64 * self.format.n_pixels() + pixel as u64;
        let byte = usize::try_from(bit / 8).ok().and_then(|at| self.bytes.get(start + at));
        byte.is_some_and(|byte| byte >> (bit % 8) & 1 == 1)
    }

    /// Checks that the bits of all frames are there, if they have one bit a sample.
    pub(super) fn check_bits(&self) -> Result<(), ReadError> {
        let (stored, samples) = self.sizes();
        if stored >= samples.div_ceil(8) {
            return Ok(());
        }
        let message = format!(
            "the frames have {} bytes of bits; their size takes {}",
            grouped(stored),
            grouped(samples.div_ceil(8))
        );
        Err(ReadError::new("size-mismatch", FileLocation::File, message))
    }
}

impl FileParts {
    /// Reads what a file of a transfer syntax says about its frames.
    fn read(
        attributes: &DicomAttributes<'_>,
        pixels: &DicomElement<'_>,
        syntax: &(TransferSyntax, String),
    ) -> Result<Self, ReadError> {
        let place = FileLocation::Byte(pixels.at as u64);
        if let PixelPacking::Unread(packing) = syntax.0.packing {
            let message = format!(
                "pixels packed as {packing} (transfer syntax {}) are not read: save the series uncompressed, as \
                 gdcmconv of GDCM and dcmconv of DCMTK do",
                syntax.1
            );
            return Err(ReadError::new("packed-pixels", place, message));
        }
        let is_packed = syntax.0.packing != PixelPacking::Plain;
        if pixels.is_in_pieces != is_packed {
            let is = if is_packed {
                "are not in pieces, which packed ones are"
            } else {
                "are in pieces, which only packed ones are"
            };
            return Err(ReadError::new("unsupported", place, format!("the pixels {is}")));
        }
        if !attributes.items(VALUE_TABLE)?.is_empty() {
            let message = "numbers that a table gives for samples (ModalityLUTSequence) are not read";
            return Err(ReadError::new("unsupported", place, message));
        }
        let format = SliceFormat::read(attributes, syntax.0.elements.endian, &place)?;
        let segments = SegmentTable::read(attributes)?;
        if format.element == SampleType::Bool && (segments.is_empty() || is_packed) {
            let message = "samples of 1 bit are read from segmentations alone, unpacked";
            return Err(ReadError::new("unsupported", place, message));
        }
        let mut frames = frames_of(attributes, pixels)?;
        if let Some(largest) = segments.largest {
            frames.iter_mut().for_each(|frame| frame.slope /= largest);
        }
        let places = if is_packed {
            let long = attributes.get(LONG_OFFSETS);
            PixelPlaces::Packed(PixelPieces::read(pixels, long.as_ref(), frames.len())?)
        } else {
            PixelPlaces::Plain { start: pixels.at, n_bytes: pixels.value.len() }
        };
        Ok(Self { format, frames, segments, pixels: places })
    }
}

/// The bytes of a file with the two bytes of each word in a range exchanged: in big-endian words the second
/// sample, or the second eight bits, comes first.
fn with_words_turned(bytes: &[u8], range: Range<usize>) -> Result<Vec<u8>, ReadError> {
    let mut turned = with_room(bytes.len())?;
    turned.extend_from_slice(bytes);
    turned[range].chunks_exact_mut(2).for_each(<[u8]>::reverse);
    Ok(turned)
}

/// The transfer syntax that a file names.
fn syntax_of(element: &DicomElement<'_>) -> Result<(TransferSyntax, String), ReadError> {
    let uid = text_of(element);
    let Some(syntax) = TransferSyntax::from_uid(&uid) else {
        let message = format!("the transfer syntax {} is not read", show(uid.as_bytes()));
        return Err(ReadError::new("unsupported", FileLocation::Byte(element.at as u64), message));
    };
    Ok((syntax, uid))
}

/// The frames of a file, with what it says about each.
fn frames_of(file: &DicomAttributes<'_>, pixels: &DicomElement<'_>) -> Result<Vec<DicomFrame>, ReadError> {
    let top = FrameFacts::of_file(file)?;
    let shared = match file.first_item(SHARED_GROUPS)? {
        Some(item) => FrameFacts::of_groups(&item)?,
        None => FrameFacts::default(),
    };
    let wider = shared.or(&top);
    let groups = file.items(GROUPS_OF_FRAMES)?;
    let declared = file.text(FRAMES);
    let n = if declared.is_empty() { Some(1) } else { declared.parse::<usize>().ok() };
    // Every frame has its own position, so the number is that of the items of the file, and never a large one
    // that a small file declares.
    let is_single = n == Some(1) && groups.len() <= 1;
    if !is_single && n != Some(groups.len()) {
        let place = FileLocation::Byte(pixels.at as u64);
        let message = if groups.is_empty() {
            let shown = show(declared.as_bytes());
            format!(
                "the file has {shown} frames and does not say where each is, as enhanced CT and MR do: save one \
                 slice a file"
            )
        } else {
            format!("the file has {} frames, and places for {}", show(declared.as_bytes()), groups.len())
        };
        return Err(ReadError::new("unsupported", place, message));
    }
    if groups.is_empty() {
        return Ok(vec![DicomFrame::from_facts(wider)?]);
    }
    let mut frames = with_room(groups.len())?;
    for group in groups {
        let own = FrameFacts::of_groups(&DicomAttributes::read(group)?)?;
        frames.push(DicomFrame::from_facts(own.or(&wider))?);
    }
    Ok(frames)
}

impl DicomFrame {
    fn from_facts(facts: FrameFacts) -> Result<Self, ReadError> {
        Ok(Self {
            position: facts.position.ok_or_else(|| missing("ImagePositionPatient"))?,
            orientation: facts.orientation.ok_or_else(|| missing("ImageOrientationPatient"))?,
            spacing: facts.spacing.ok_or_else(|| missing("PixelSpacing"))?,
            between: facts.between,
            slope: facts.slope.unwrap_or(1.0),
            inter: facts.inter.unwrap_or(0.0),
            stack: facts.stack,
            time: facts.time,
            segment: facts.segment,
        })
    }
}

/// A deflated data set, unpacked within the limits. Its last byte may be padding.
fn inflated(packed: &[u8], at: u64, limits: &Limits) -> Result<Vec<u8>, ReadError> {
    /// The bytes that are unpacked between two checks of the limits.
    const STEP: usize = 1 << 16;
    let mut reader = InflateReader::deflate(packed, at);
    let (mut bytes, mut step) = (Vec::new(), vec![0; STEP]);
    loop {
        let n = reader.fill(&mut step)?;
        crate::grow::extend(&mut bytes, &step[..n])?;
        let refuse = |code, message| Err(ReadError::new(code, reader.place(), message));
        if bytes.len() as u64 > limits.bytes {
            return refuse(
                "too-large",
                format!("the data set unpacks to more than {}", grouped(limits.bytes)),
            );
        }
        if UnpackCap::VOLUME.is_too_dense(bytes.len() as u64, packed.len() as u64) {
            let why = UnpackCap::VOLUME.too_dense(packed.len() as u64);
            return refuse("too-dense", format!("the data set {why}"));
        }
        if n < STEP {
            return Ok(bytes);
        }
    }
}
