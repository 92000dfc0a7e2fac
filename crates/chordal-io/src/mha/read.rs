//! Reads `.mha` and `.mhd`.
use super::fields::MetaFields;
use super::header::{MetaEncoding, MetaHeader};
use super::orientation::{affine, space};
use super::sample_files::{SampleFile, SampleFileNames, SampleFiles};
use crate::files::FileOpener;
use crate::nii::chosen_volume;
use crate::volume::count::{along, size_of};
use crate::volume::data_files::DataFiles;
use crate::volume::element::Endian;
use crate::volume::inflate::{InflateReader, check_ratio};
use crate::volume::samples::{self, SampleLayout, TrailingBytes};
use crate::volume::stream::SampleStream;
use crate::volume::text_bytes::{check_count, text_bytes};
use crate::warnings::Warnings;
use crate::{Content, FileLocation, Limits, ReadError, ReadOutcome, Volume};
use chordal::implicit::{Grid, Samples};

/// Reads the volume of a MetaImage whose samples are in the same file. The offset, the spacing and the
/// directions place the samples. If the header gives the anatomical orientation, space is "LPS": x to the
/// patient's left, y to the back, z to the head, as in ITK.
///
/// A fourth axis makes several volumes; [`Limits::index`] chooses one.
///
/// # Errors
/// [`ReadError`] at the line of the header, or at the byte; also for samples in another file, which
/// [`read_with`] reads, and for several channels, which are not a volume.
///
/// ```
/// use chordal_io::{Content, Limits, mha};
/// let file = b"ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementSpacing = 1 2 3\nOffset = 10 0 0\n\
///              ElementType = MET_UCHAR\nElementDataFile = LOCAL\n\x00\x01\x02\x03\x04\x05\x06\x07";
/// let Content::Volume(volume) = mha::read(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(volume.grid.sample([1, 0, 1]), 5.0);
/// assert_eq!(volume.grid.affine().at([1.0, 0.0, 1.0]), [11.0, 0.0, 3.0]);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    read_with(bytes, None, limits)
}

/// As [`read`], with the files that hold the samples: one, or one for each slice. They are below the folder
/// of the header.
///
/// # Errors
/// As for [`read`]; also if a file is not available.
pub fn read_with(
    bytes: &[u8],
    open: Option<&mut FileOpener<'_>>,
    limits: &Limits,
) -> Result<ReadOutcome, ReadError> {
    let mut warnings = Warnings::default();
    let fields = MetaFields::read(bytes, limits)?;
    let header = MetaHeader::read(&fields, &mut warnings)?;
    let sizes = &header.sizes;
    for (axis, n) in sizes.iter().enumerate() {
        along(axis, *n, &header.sizes_place)?;
    }
    let size = size_of([sizes[0], sizes[1], sizes[2]], header.element, &header.sizes_place, limits)?;
    let affine = affine(&fields, sizes.len(), &mut warnings)?;
    let (frame, space) = space(&fields, &mut warnings)?;
    // Numbers in text are converted to bytes in this order.
    let endian = if header.encoding == MetaEncoding::Text { Endian::Little } else { header.endian };
    let mut layout = SampleLayout::volumes(header.element, endian, size);
    // Sizes were checked to be positive.
    layout.of = sizes.get(3).map_or(1, |n| *n as u64);
    layout.index = chosen_volume(layout.of, limits, &header.sizes_place)?;
    let files = SampleFileNames { bytes, fields: &fields, sizes, limits }.read()?;
    let mut decoder = SampleDecoder { header: &header, layout, limits, warnings: &mut warnings };
    let mut beside = DataFiles::new(open, bytes.len() as u64, limits.bytes);
    let samples = match files {
        SampleFiles::Local => decoder.local(bytes, fields.end)?,
        SampleFiles::One(file) => decoder.read_one_file(&file, &mut beside)?,
        SampleFiles::Each(files) => decoder.read_files(&files, &mut beside)?,
    };
    samples::count_not_finite(&samples, &mut warnings);
    let grid = Grid::new(size, samples, affine)
        .map_err(|error| ReadError::new("bad-size", header.sizes_place, error.to_string()))?;
    let name = fields.get("Name").map_or_else(String::new, |field| crate::volume::name_of(field.value));
    let volume = Volume { frame, name, space, ..Volume::from_grid(grid) };
    Ok(ReadOutcome { content: Content::Volume(volume), warnings: warnings.into_list() })
}

/// The context in which samples are decoded.
struct SampleDecoder<'d> {
    header: &'d MetaHeader,
    /// The samples of all files together.
    layout: SampleLayout,
    limits: &'d Limits,
    warnings: &'d mut Warnings,
}

/// Converts the stream of one file.
type StreamReader<T> = fn(&mut SampleStream, &SampleLayout, &Limits, &mut Warnings) -> Result<T, ReadError>;

impl SampleDecoder<'_> {
    /// Samples after the header, from byte `end` on.
    fn local(&mut self, bytes: &[u8], end: usize) -> Result<Samples, ReadError> {
        let start = match self.header.skip {
            Some(0) => end,
            Some(skip) => {
                let skip = usize::try_from(skip).ok().filter(|skip| (end..=bytes.len()).contains(skip));
                skip.ok_or_else(|| {
                    let message = format!("HeaderSize is no byte after the {end} bytes of the header");
                    ReadError::new("bad-header", FileLocation::File, message)
                })?
            }
            None => from_end(bytes, end, &self.layout)?,
        };
        let layout = self.layout;
        self.decode(&FileSamples { bytes, start, layout }, samples::read)
    }

    /// Samples in one other file.
    fn read_one_file(
        &mut self,
        file: &SampleFile,
        beside: &mut DataFiles<'_, '_>,
    ) -> Result<Samples, ReadError> {
        let bytes = beside.fetch(&file.name, &file.place())?;
        let layout = self.layout;
        let start = self.start(&bytes, &layout);
        let samples =
            start.and_then(|start| self.decode(&FileSamples { bytes: &bytes, start, layout }, samples::read));
        samples.map_err(|error| error.within(&file.name))
    }

    /// Samples in several other files, the same number in each.
    fn read_files(
        &mut self,
        files: &[SampleFile],
        beside: &mut DataFiles<'_, '_>,
    ) -> Result<Samples, ReadError> {
        let layout = self.layout;
        // The sizes of the header are within limits, and the number of files is a product of some of them.
        let n_samples = layout.inner * layout.of;
        let share = SampleLayout { inner: n_samples / files.len().max(1) as u64, of: 1, index: 0, ..layout };
        let mut joined = Vec::new();
        for file in files {
            let bytes = beside.fetch(&file.name, &file.place())?;
            let start = self.start(&bytes, &share);
            let piece = start.and_then(|start| {
                self.decode(&FileSamples { bytes: &bytes, start, layout: share }, samples::bytes)
            });
            let piece = piece.map_err(|error| error.within(&file.name))?;
            joined.try_reserve(piece.len()).map_err(|_| crate::grow::out_of_memory(joined.len()))?;
            joined.extend_from_slice(&piece);
        }
        samples::read(&mut SampleStream::plain(&joined, 0), &layout, self.limits, self.warnings)
    }

    /// The byte of a separate file at which its samples start.
    fn start(&self, bytes: &[u8], layout: &SampleLayout) -> Result<usize, ReadError> {
        let Some(skip) = self.header.skip else { return from_end(bytes, 0, layout) };
        let start = usize::try_from(skip).ok().filter(|skip| *skip <= bytes.len());
        start.ok_or_else(|| {
            let stream = SampleStream::plain(bytes, bytes.len());
            stream.truncated(0, layout.bytes().unwrap_or(u64::MAX))
        })
    }

    fn decode<T>(&mut self, file: &FileSamples<'_>, read: StreamReader<T>) -> Result<T, ReadError> {
        let FileSamples { bytes, start, layout } = file;
        let declared = layout.bytes().unwrap_or(u64::MAX);
        match self.header.encoding {
            MetaEncoding::Raw => {
                let mut stream = SampleStream::plain(bytes, *start);
                read(&mut stream, layout, self.limits, self.warnings)
            }
            MetaEncoding::Text => {
                let numbers = text_bytes(&bytes[*start..], layout.element, |at| {
                    FileLocation::Byte((start + at) as u64)
                })?;
                let width = layout.element.width() as u64;
                let end = || FileLocation::Byte(bytes.len() as u64);
                check_count(numbers.len() as u64 / width, declared / width, end)?;
                read(&mut SampleStream::plain(&numbers, 0), layout, self.limits, self.warnings)
            }
            MetaEncoding::Packed => {
                let packed = self.packed(bytes, *start)?;
                let place = FileLocation::Byte(*start as u64);
                check_ratio(Some(declared), packed.len() as u64, &place)?;
                let inflater = InflateReader::either(packed, *start as u64);
                read(&mut SampleStream::Packed(inflater), layout, self.limits, self.warnings)
            }
        }
    }

    /// The compressed bytes from `start` on: as many as the header states, else all.
    fn packed<'b>(&mut self, bytes: &'b [u8], start: usize) -> Result<&'b [u8], ReadError> {
        let rest = &bytes[start..];
        let Some(n) = self.header.n_packed else { return Ok(rest) };
        let packed = usize::try_from(n).ok().and_then(|n| rest.get(..n)).ok_or_else(|| {
            let stream = SampleStream::plain(bytes, bytes.len());
            stream.truncated(rest.len() as u64, n)
        })?;
        let place = FileLocation::Byte((start + packed.len()) as u64);
        let more = (rest.len() - packed.len()) as u64;
        TrailingBytes { more, place, is_exact: true }.check(self.limits, self.warnings)?;
        Ok(packed)
    }
}

/// Samples in the bytes of one file.
struct FileSamples<'b> {
    bytes: &'b [u8],
    start: usize,
    layout: SampleLayout,
}

/// The start of samples that end with the file.
fn from_end(bytes: &[u8], least: usize, layout: &SampleLayout) -> Result<usize, ReadError> {
    let declared = layout.bytes().and_then(|n| usize::try_from(n).ok());
    let start = declared.and_then(|n| bytes.len().checked_sub(n)).filter(|start| *start >= least);
    start.ok_or_else(|| {
        let stream = SampleStream::plain(bytes, bytes.len());
        stream.truncated((bytes.len() - least) as u64, layout.bytes().unwrap_or(u64::MAX))
    })
}
