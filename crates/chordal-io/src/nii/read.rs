//! Reads `.nii` and `.nii.gz`.
use super::header::{self, NiftiHeader, header_error};
use super::label_table::{MOST_BYTES, label_table};
use super::orientation::affine;
use crate::files::{FileOpener, SAME_STEM};
use crate::volume::count::{along, size_of};
use crate::volume::data_files::DataFiles;
use crate::volume::inflate::{InflateReader, MAGIC, check_ratio};
use crate::volume::samples::{self, SampleLayout};
use crate::volume::stream::SampleStream;
use crate::warnings::Warnings;
use crate::{Axis, Content, FileLocation, Frame, Limits, ReadError, ReadOutcome, Volume};
use chordal::budget::Unit;
use chordal::budget::advice::{Message, Setting};
use chordal::implicit::{Grid, Samples};

/// Reads the volume of a NIfTI file, gzipped or not, in patient coordinates: x to the right, y to the front,
/// z to the head ("RAS"). The affine map is the file's sform, else its qform, else its plain steps. Numbers
/// are scaled as the header states. In a file of several volumes, [`Limits::index`] chooses one.
///
/// Memory grows with the unpacked bytes, which are limited by [`Limits::bytes`] and by the size that the
/// header declares.
///
/// # Errors
/// [`ReadError`] at the byte: of the unpacked file for errors in the header, of the packed file for errors in
/// samples.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    read_with(bytes, None, limits)
}

/// As [`read`], also for the header of a pair of files (`.hdr`) with the samples in the file of the same name
/// with the extension `.img`, packed or not.
pub(crate) fn read_with(
    bytes: &[u8],
    open: Option<&mut FileOpener<'_>>,
    limits: &Limits,
) -> Result<ReadOutcome, ReadError> {
    let mut warnings = Warnings::default();
    let mut stream = if bytes.starts_with(&MAGIC) {
        SampleStream::Packed(InflateReader::gzip(bytes, 0))
    } else {
        SampleStream::plain(bytes, 0)
    };
    let mut first = [0; header::MOST];
    // Headers of version 1 are shorter, and samples may follow at once.
    let n = match &mut stream {
        SampleStream::Plain { file, .. } => {
            let n = file.len().min(header::MOST);
            first[..n].copy_from_slice(&file[..n]);
            n
        }
        packed => packed.fill(&mut first[..348])?,
    };
    let n = if is_wide(&first) && n == 348 { n + stream.fill(&mut first[348..])? } else { n };
    let header = NiftiHeader::read(&first[..n])?;
    let (size, layout) = layout(&header, limits)?;
    let affine = affine(&header, &mut warnings)?;
    let header_end = if is_wide(&first) { header::MOST } else { 348 };
    let beside = header.is_pair.then(|| samples_beside(bytes.len() as u64, open, limits)).transpose()?;
    let (read, after) = match &beside {
        None => {
            let read = if let SampleStream::Plain { .. } = stream { 0 } else { n as u64 };
            (read, skip_to_samples(&mut stream, read, &header)?)
        }
        Some(samples) => {
            // The bytes after a header in its own file; the file is plain here, since a packed one was
            // unpacked before.
            let after = bytes.iter().copied().take(MOST_BYTES as usize).collect();
            stream = if samples.starts_with(&MAGIC) {
                SampleStream::Packed(InflateReader::gzip(samples, 0))
            } else {
                SampleStream::plain(samples, 0)
            };
            skip_to_samples(&mut stream, 0, &header)?;
            (0, after)
        }
    };
    if let SampleStream::Packed(_) = stream {
        let n_packed = beside.as_ref().map_or(bytes.len(), Vec::len) as u64;
        check_ratio(layout.bytes(), n_packed, &FileLocation::Byte(header.dim_at as u64))?;
    }
    // For a plain file the header itself is read again.
    let beyond = header_end - read as usize;
    let (labels, unread) = label_table(after.get(beyond..).unwrap_or(&[]), header.endian, limits);
    if let Some(error) = unread {
        warnings.count("labels-skipped", || {
            (FileLocation::Byte(read), format!("the names of labels cannot be read: {}", error.message))
        });
    }
    check_bits(&header, &mut warnings);
    let stored = samples::read(&mut stream, &layout, limits, &mut warnings)?;
    let samples = scaled(stored, &header, &mut warnings)?;
    samples::count_not_finite(&samples, &mut warnings);
    let grid = Grid::new(size, samples, affine)
        .map_err(|error| header_error("bad-size", header.dim_at, error.to_string()))?;
    let metres_per_unit = unit(&header, &mut warnings);
    let volume = Volume {
        frame: Frame { up: Some(Axis::Z), metres_per_unit, ..Frame::default() },
        name: header.name,
        space: Some("RAS".to_owned()),
        labels,
        ..Volume::from_grid(grid)
    };
    Ok(ReadOutcome { content: Content::Volume(volume), warnings: warnings.into_list() })
}

/// The file that holds the samples of a separate header.
fn samples_beside(
    n_bytes: u64,
    open: Option<&mut FileOpener<'_>>,
    limits: &Limits,
) -> Result<Vec<u8>, ReadError> {
    let place = FileLocation::File;
    let Some(open) = open else {
        let message =
            "the samples are in the .img beside this header, which is not at hand: only the header was given";
        return Err(ReadError::new("detached", place, message));
    };
    let mut fetch = |extension: &str| {
        let name = format!("{SAME_STEM}{extension}");
        DataFiles::new(Some(&mut *open), n_bytes, limits.bytes).fetch(&name, &place)
    };
    match fetch("img") {
        Err(error) if error.code == "missing-file" => fetch("img.gz").map_err(|error| {
            let message =
                "the samples are in the .img or the .img.gz beside this header, and neither can be read";
            if error.code == "missing-file" { ReadError { message: message.into(), ..error } } else { error }
        }),
        read => read,
    }
}

/// Skips the bytes before the samples, and returns the start of them.
fn skip_to_samples(stream: &mut SampleStream, read: u64, header: &NiftiHeader) -> Result<Vec<u8>, ReadError> {
    let gap = header.offset - read;
    let mut after = vec![0; gap.min(MOST_BYTES) as usize];
    let n_after = stream.fill(&mut after)?;
    after.truncate(n_after);
    let skipped = n_after as u64 + stream.skip(gap - n_after as u64)?;
    if skipped < gap {
        let message = format!("the file ends after {} bytes, before its samples", read + skipped);
        return Err(ReadError::new("truncated", stream.place(), message));
    }
    Ok(after)
}

fn is_wide(first: &[u8; header::MOST]) -> bool {
    [first[0], first[1], first[2], first[3]] == 540_i32.to_le_bytes()
        || [first[0], first[1], first[2], first[3]] == 540_i32.to_be_bytes()
}

/// The size of one volume, and the layout of the chosen one.
fn layout(header: &NiftiHeader, limits: &Limits) -> Result<([usize; 3], SampleLayout), ReadError> {
    let place = FileLocation::Byte(header.dim_at as u64);
    let axes = header.dim[0];
    if !(1..=7).contains(&axes) {
        let message = format!("{axes} axes; a NIfTI file has 1 to 7");
        return Err(ReadError::new("bad-size", place, message));
    }
    let axes = axes as usize;
    let sizes = &header.dim[1..=axes];
    for (axis, n) in sizes.iter().enumerate() {
        along(axis, *n, &place)?;
    }
    // Programs pad the list of sizes with ones.
    let last = sizes.iter().rposition(|n| *n > 1).map_or(0, |last| last + 1);
    if last > 4 || axes < 3 {
        let sizes_text: Vec<String> = sizes.iter().map(ToString::to_string).collect();
        let sizes_text = sizes_text.join(" x ");
        let message = Message::from(format!(
            "{sizes_text} samples are no volume: three axes are expected, or four with "
        ))
        .setting(Setting::Index)
        .words(" for one volume of several");
        return Err(ReadError::new("not-3d", place, message));
    }
    let size = size_of([sizes[0], sizes[1], sizes[2]], header.element, &place, limits)?;
    let volumes = sizes.get(3).copied().unwrap_or(1) as u64;
    let index = chosen_volume(volumes, limits, &place)?;
    Ok((
        size,
        SampleLayout { of: volumes, index, ..SampleLayout::volumes(header.element, header.endian, size) },
    ))
}

/// The index of the chosen volume.
pub(crate) fn chosen_volume(volumes: u64, limits: &Limits, place: &FileLocation) -> Result<u64, ReadError> {
    match limits.index {
        None if volumes > 1 => {
            let message = Message::from(format!("the file holds {volumes} volumes: "))
                .setting(Setting::Index)
                .words(format_args!(" names one, from 0 to {}", volumes - 1));
            Err(ReadError::new("several-volumes", place.clone(), message))
        }
        Some(index) if index >= volumes => {
            let message = format!("there is no volume {index}: the file holds {volumes}, counted from 0");
            Err(ReadError::new("no-such-volume", place.clone(), message))
        }
        index => Ok(index.unwrap_or(0)),
    }
}

fn check_bits(header: &NiftiHeader, warnings: &mut Warnings) {
    let bits = 8 * header.element.width() as i64;
    if header.bits != bits {
        warnings.count("bits-differ", || {
            let message = format!("the header says {} bits a sample, its type has {bits}", header.bits);
            (FileLocation::Byte(header.bits_at as u64), message)
        });
    }
}

/// The samples, scaled as the header states. A slope of 0 means no scaling.
fn scaled(stored: Samples, header: &NiftiHeader, warnings: &mut Warnings) -> Result<Samples, ReadError> {
    let (slope, inter) = (header.slope, header.inter);
    if slope == 0.0 || (slope == 1.0 && inter == 0.0) {
        return Ok(stored);
    }
    if !slope.is_finite() || !inter.is_finite() {
        warnings.count("scaling-ignored", || {
            let message = format!("a scale of {slope} and {inter} means nothing: samples are as they stand");
            (FileLocation::Byte(header.slope_at as u64), message)
        });
        return Ok(stored);
    }
    samples::scaled(&stored, slope, inter)
}

/// The length of one unit in metres, by its code in the standard.
fn unit(header: &NiftiHeader, warnings: &mut Warnings) -> Option<f64> {
    match header.units & 7 {
        1 => Some(1.0),
        2 => Some(0.001),
        // A micrometre, exact to the last place.
        3 => Some(1e-6),
        _ => {
            warnings.count("no-unit", || {
                let unsaid = "the file does not say its unit, which is nearly always the millimetre: ";
                let message = Message::from(unsaid).value(Setting::Unit, Unit::Millimetre).words(" says so");
                (FileLocation::File, message)
            });
            None
        }
    }
}

/// Whether bytes start like a NIfTI file, gzipped or not.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    header::looks_like(&crate::volume::inflate::peek(bytes, 348))
}
