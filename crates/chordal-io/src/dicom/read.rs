//! Reads a DICOM series.
use super::elements::after_mark;
use super::file::{DicomFile, PixelFile};
use super::masks::labels_of;
use super::series::{DicomSeries, DicomSlice};
use super::slice_list::FIRST;
use crate::files::FileOpener;
use crate::grow::{push, push_large, with_room};
use crate::text::show;
use crate::volume::count::size_of;
use crate::volume::data_files::DataFiles;
use crate::volume::element::{Endian, SampleType};
use crate::volume::inflate::check_ratio;
use crate::volume::samples::{self, SampleLayout};
use crate::volume::stream::SampleStream;
use crate::warnings::Warnings;
use crate::{Axis, Content, FileLocation, Frame, Limits, ReadError, ReadOutcome, Volume};
use chordal::budget::advice::{Message, Setting};
use chordal::implicit::{Affine3, Grid, Samples};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Reads a file with several frames as [`read_with`] reads a list of slices. Refuses a single slice, which is
/// no volume, and a list of slices, which needs their files.
///
/// # Errors
/// As [`read_with`]; a slice is refused with a message that says what to do.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    read_with(bytes, None, limits)
}

/// Reads the slices in a list ([`super::slice_list`]) as one volume, in the patient's coordinates "LPS", in
/// millimetres. Slices are sorted by their positions along the normal, and slope and intercept are applied.
/// Files that are not slices are counted, and so are those of other series that are no part of a volume. Of
/// several series, sorted by identifier, stack and time, [`Limits::index`] chooses one. The masks of a
/// segmentation become labels; each file of masks is a series of its own.
///
/// # Errors
/// If slices are missing, at the same position, at unequal steps, of different sizes, packed in a way that is
/// not read, or truncated; the message begins with the file. If there are several series and none is chosen;
/// the message lists them.
pub fn read_with(
    bytes: &[u8],
    open: Option<&mut FileOpener<'_>>,
    limits: &Limits,
) -> Result<ReadOutcome, ReadError> {
    let mut warnings = Warnings::default();
    let (mut files, mut refused) = (Vec::new(), Vec::new());
    match bytes.strip_prefix(FIRST) {
        Some(names) => {
            let mut beside = DataFiles::new(open, bytes.len() as u64, limits.bytes);
            files_of(names, &mut beside, (limits, &mut warnings), (&mut files, &mut refused))?;
        }
        None => files.push(single(bytes, limits)?),
    }
    if files.is_empty()
        && let Some(RefusedFile { error, .. }) = refused.first()
    {
        return Err(error.clone());
    }
    let slices = choose(&files, limits)?;
    let first = slices[0];
    check_refused(refused, &first.file.series, &mut warnings)?;
    let n_indexed = slices.iter().filter(|slice| slice.file.has_palette).count() as u64;
    let message = "slices hold numbers of colours in a palette, which were read as they are";
    warnings.count_all("palette-numbers", n_indexed, message);
    let element = first.file.format.element;
    let is_map = first.file.segments.is_map && matches!(element, SampleType::U8 | SampleType::U16);
    let (size, samples, affine) = if element == SampleType::Bool || is_map {
        labels_of(slices, limits, &mut warnings)?
    } else {
        volume_of(slices, limits, &mut warnings)?
    };
    samples::count_not_finite(&samples, &mut warnings);
    let grid = Grid::new(size, samples, affine)
        .map_err(|error| ReadError::new("bad-size", FileLocation::File, error.to_string()))?;
    // Millimetres, defined by the standard.
    let frame = Frame { up: Some(Axis::Z), metres_per_unit: Some(0.001), ..Frame::default() };
    let name = crate::volume::name_of(first.file.description.as_bytes());
    let labels = first.file.segments.labels();
    let volume = Volume { frame, name, space: Some("LPS".to_owned()), labels, ..Volume::from_grid(grid) };
    Ok(ReadOutcome { content: Content::Volume(volume), warnings: warnings.into_list() })
}

/// A file with pixels that is no part of a volume.
struct RefusedFile {
    series: String,
    error: ReadError,
}

/// Counts the files that were refused, if none of them is of the chosen series: a folder may also hold pictures
/// of the screen, and series that are not read.
fn check_refused(refused: Vec<RefusedFile>, series: &str, warnings: &mut Warnings) -> Result<(), ReadError> {
    for RefusedFile { series: other, error } in refused {
        if other == series {
            return Err(error);
        }
        warnings.count("files-refused", || {
            let words = Message::from("files of other series that are no part of a volume were not read: ");
            (FileLocation::File, words.message(&error.message))
        });
    }
    Ok(())
}

/// The files in a list, and those that are refused, without those that are no slices.
fn files_of<'a>(
    names: &[u8],
    beside: &mut DataFiles<'_, '_>,
    (limits, warnings): (&Limits, &mut Warnings),
    (files, refused): (&mut Vec<DicomFile<'a>>, &mut Vec<RefusedFile>),
) -> Result<(), ReadError> {
    let names = crate::text::text_of(names)?;
    let names = std::str::from_utf8(names)
        .map_err(|_| ReadError::new("not-utf8", FileLocation::File, "a name in the list is not UTF-8"))?;
    for (line, name) in names.lines().enumerate().filter(|(_, name)| !name.is_empty()) {
        // The first line is the signature.
        let place = FileLocation::Line(line as u64 + 2);
        let bytes = beside.fetch(name, &place)?;
        match DicomFile::read(name, Cow::Owned(bytes), limits).map_err(|error| error.within(name))? {
            Some(PixelFile::Read(file)) => push_large(files, *file)?,
            Some(PixelFile::Refused { series, error }) => {
                push(refused, RefusedFile { series, error: error.within(name) })?;
            }
            None => warnings.count("files-ignored", || {
                (place, format!("files that are no slices were not read, {} first", show(name.as_bytes())))
            }),
        }
    }
    Ok(())
}

/// A file that is not in a list: one with several frames.
fn single<'a>(bytes: &'a [u8], limits: &Limits) -> Result<DicomFile<'a>, ReadError> {
    if after_mark(bytes).is_none() {
        let message = "a DICOM file has the letters DICM at byte 128";
        return Err(ReadError::new("bad-magic", FileLocation::Byte(128), message));
    }
    match DicomFile::read("", Cow::Borrowed(bytes), limits)? {
        Some(PixelFile::Read(file)) if file.frames.len() > 1 => Ok(*file),
        Some(PixelFile::Refused { error, .. }) => Err(error),
        _ => {
            let message =
                "this is one file of a series, and one slice is no volume: give the folder with all of them";
            Err(ReadError::new("flat-volume", FileLocation::File, message))
        }
    }
}

/// What tells series apart: the identifier, the file if it is one of masks, whose segments have numbers of its
/// own, the stack and the time.
type SeriesKey<'a> = (&'a str, &'a str, &'a str, u32);

/// The slices of the only series, or of the chosen one.
fn choose<'a>(files: &'a [DicomFile<'a>], limits: &Limits) -> Result<Vec<DicomSlice<'a>>, ReadError> {
    let mut by_series: BTreeMap<SeriesKey<'a>, Vec<DicomSlice<'a>>> = BTreeMap::new();
    for file in files {
        for number in 0..file.frames.len() {
            let slice = DicomSlice { file, number };
            let frame = slice.frame();
            let masks = if file.segments.is_empty() { "" } else { file.name.as_str() };
            let stack = frame.stack.as_deref().unwrap_or("");
            let key = (file.series.as_str(), masks, stack, frame.time.unwrap_or(0));
            push(by_series.entry(key).or_default(), slice)?;
        }
    }
    let refused = |code, message: Message| Err(ReadError::new(code, FileLocation::File, message));
    let n = by_series.len();
    let listed = || {
        let one = |(number, (key, slices)): (usize, (&SeriesKey<'_>, &Vec<DicomSlice<'_>>))| {
            let (_, masks, stack, time) = key;
            let name = show(slices[0].file.description.as_bytes());
            let masks =
                if masks.is_empty() { String::new() } else { format!(", file {}", show(masks.as_bytes())) };
            let stack =
                if stack.is_empty() { String::new() } else { format!(", stack {}", show(stack.as_bytes())) };
            let time = if *time == 0 { String::new() } else { format!(", time {time}") };
            format!("{number}: {name}{masks}{stack}{time} with {} slices", slices.len())
        };
        by_series.iter().take(MOST_LISTED).enumerate().map(one).collect::<Vec<_>>().join(", ")
    };
    match limits.index {
        _ if n == 0 => refused("no-slices", "no file in the list is a slice of DICOM".into()),
        None if n > 1 => {
            let message = Message::from(format!("there are {n} series, {}: ", listed()))
                .setting(Setting::Index)
                .words(" names one");
            refused("several-volumes", message)
        }
        index => {
            let index = index.unwrap_or(0);
            let missing = format!("there is no series {index}, counted from 0: {}", listed());
            let chosen = usize::try_from(index).ok().and_then(|index| by_series.into_values().nth(index));
            chosen.map_or_else(|| refused("no-such-volume", missing.into()), Ok)
        }
    }
}

/// The most series that a message lists. Chosen: a page of text.
const MOST_LISTED: usize = 50;

/// The volume of slices that hold numbers.
fn volume_of(
    slices: Vec<DicomSlice<'_>>,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<([usize; 3], Samples, Affine3), ReadError> {
    let series = DicomSeries::new(slices, warnings)?;
    let format = series.slices[0].file.format;
    let sizes = [format.columns as i64, format.rows as i64, series.slices.len() as i64];
    let size = size_of(sizes, format.element, &FileLocation::File, limits)?;
    Ok((size, samples_of(&series, size, limits, warnings)?, series.affine))
}

/// All samples, scaled.
fn samples_of(
    series: &DicomSeries<'_>,
    size: [usize; 3],
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<Samples, ReadError> {
    let format = series.slices[0].file.format;
    let (mut stored, mut declared) = (0_u64, 0_u64);
    for slice in &series.slices {
        let (file_stored, file_declared) = slice.file.sizes();
        let n = slice.file.frames.len() as u64;
        (stored, declared) = (stored + file_stored / n, declared + file_declared / n);
    }
    check_ratio(Some(declared), stored, &FileLocation::File)?;
    let mut body = Vec::new();
    for slice in &series.slices {
        let appended = slice.file.append_samples(slice.number, &mut body);
        appended.map_err(|error| error.within(&slice.name()))?;
    }
    let layout = SampleLayout::volumes(format.element, Endian::Little, size);
    let stored = samples::read(&mut SampleStream::plain(&body, 0), &layout, limits, warnings)?;
    drop(body);
    let scale_of = |slice: &DicomSlice<'_>| (slice.frame().slope, slice.frame().inter);
    let scale = scale_of(&series.slices[0]);
    if series.slices.iter().all(|slice| scale_of(slice) == scale) {
        return if scale == (1.0, 0.0) { Ok(stored) } else { samples::scaled(&stored, scale.0, scale.1) };
    }
    let mut values = with_room(stored.len())?;
    let n_slice = stored.len() / series.slices.len();
    for (k, slice) in series.slices.iter().enumerate() {
        let (slope, inter) = scale_of(slice);
        values.extend((0..n_slice).map(|i| slope * stored.get(k * n_slice + i) + inter));
    }
    Ok(Samples::F64(values))
}
