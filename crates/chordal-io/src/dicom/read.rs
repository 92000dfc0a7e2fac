//! Reads a DICOM series.
use super::elements::after_mark;
use super::series::{DicomSeries, SliceFile};
use super::slice::DicomSlice;
use super::slice_list::FIRST;
use crate::files::FileOpener;
use crate::text::show;
use crate::volume::count::size_of;
use crate::volume::data_files::DataFiles;
use crate::volume::element::Endian;
use crate::volume::samples::{self, SampleLayout};
use crate::volume::stream::SampleStream;
use crate::warnings::Warnings;
use crate::{Axis, Content, FileLocation, Frame, Limits, ReadError, ReadOutcome, Volume};
use chordal::budget::advice::{Message, Setting};
use chordal::implicit::{Grid, Samples};
use std::collections::BTreeMap;

/// Refuses a single file: a slice alone is not a volume, and a list of slices needs their files
/// ([`read_with`]).
///
/// # Errors
/// Always; the message says what the file is, and what to do.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    read_with(bytes, None, limits)
}

/// Reads the slices in a list ([`super::slice_list`]) as one volume, in the patient's coordinates "LPS", in
/// millimetres. Slices are sorted by their positions along the normal, and slope and intercept are applied.
/// Files that are not slices are counted. Of several series, sorted by identifier, [`Limits::index`] chooses
/// one.
///
/// # Errors
/// If slices are missing, at the same position, at unequal steps, of different sizes, compressed, or
/// truncated; the message begins with the file. If there are several series and none is chosen; the message
/// lists them.
pub fn read_with(
    bytes: &[u8],
    open: Option<&mut FileOpener<'_>>,
    limits: &Limits,
) -> Result<ReadOutcome, ReadError> {
    let Some(names) = bytes.strip_prefix(FIRST) else { return Err(not_a_list(bytes)) };
    let names = crate::text::text_of(names)?;
    let names = std::str::from_utf8(names)
        .map_err(|_| ReadError::new("not-utf8", FileLocation::File, "a name in the list is not UTF-8"))?;
    let mut warnings = Warnings::default();
    let mut beside = DataFiles::new(open, bytes.len() as u64, limits.bytes);
    let mut by_series: BTreeMap<String, Vec<SliceFile>> = BTreeMap::new();
    for (line, name) in names.lines().enumerate().filter(|(_, name)| !name.is_empty()) {
        // The first line is the signature.
        let place = FileLocation::Line(line as u64 + 2);
        let bytes = beside.fetch(name, &place)?;
        match DicomSlice::read(&bytes).map_err(|error| error.within(name))? {
            Some(slice) => {
                let files = by_series.entry(slice.series.clone()).or_default();
                crate::grow::push_large(files, SliceFile { name: name.to_owned(), bytes, slice })?;
            }
            None => warnings.count("files-ignored", || {
                (place, format!("files that are no slices were not read, {} first", show(name.as_bytes())))
            }),
        }
    }
    let series = DicomSeries::new(choose(by_series, limits)?, &mut warnings)?;
    let samples = samples_of(&series, limits, &mut warnings)?;
    let first = &series.files[0].slice;
    let size = [first.format.columns as usize, first.format.rows as usize, series.files.len()];
    samples::count_not_finite(&samples, &mut warnings);
    let grid = Grid::new(size, samples, series.affine)
        .map_err(|error| ReadError::new("bad-size", FileLocation::File, error.to_string()))?;
    // Millimetres, defined by the standard.
    let frame = Frame { up: Some(Axis::Z), metres_per_unit: Some(0.001), ..Frame::default() };
    let name = crate::volume::name_of(first.description.as_bytes());
    let volume = Volume { frame, name, space: Some("LPS".to_owned()), ..Volume::from_grid(grid) };
    Ok(ReadOutcome { content: Content::Volume(volume), warnings: warnings.into_list() })
}

fn not_a_list(bytes: &[u8]) -> ReadError {
    if after_mark(bytes).is_none() {
        let message = "a DICOM file has the letters DICM at byte 128";
        return ReadError::new("bad-magic", FileLocation::Byte(128), message);
    }
    match DicomSlice::read(bytes) {
        Ok(_) => {
            let message =
                "this is one file of a series, and one slice is no volume: give the folder with all of them";
            ReadError::new("flat-volume", FileLocation::File, message)
        }
        Err(error) => error,
    }
}

/// The slices of the only series, or of the chosen one.
fn choose(by_series: BTreeMap<String, Vec<SliceFile>>, limits: &Limits) -> Result<Vec<SliceFile>, ReadError> {
    let refused = |code, message: Message| Err(ReadError::new(code, FileLocation::File, message));
    let n = by_series.len();
    let listed = || {
        let one = |(number, files): (usize, &Vec<SliceFile>)| {
            let name = show(files[0].slice.description.as_bytes());
            format!("{number}: {name} with {} slices", files.len())
        };
        by_series.values().enumerate().map(one).collect::<Vec<_>>().join(", ")
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

/// All samples, scaled.
fn samples_of(series: &DicomSeries, limits: &Limits, warnings: &mut Warnings) -> Result<Samples, ReadError> {
    let first = &series.files[0].slice;
    let sizes = [first.format.columns as i64, first.format.rows as i64, series.files.len() as i64];
    let size = size_of(sizes, first.format.element, &FileLocation::File, limits)?;
    let mut body = Vec::new();
    for SliceFile { name, bytes, slice } in &series.files {
        let stored = || &bytes[slice.start..slice.start + slice.n_bytes];
        let pixels = slice.unpacked.as_deref().unwrap_or_else(stored);
        let n = slice.format.n_bytes();
        // An odd number of bytes is padded by one.
        if (pixels.len() as u64) < n || pixels.len() as u64 > n + n % 2 {
            let message = format!("the slice has {} bytes of samples; its size takes {n}", pixels.len());
            let place = FileLocation::Byte(slice.start as u64);
            return Err(ReadError::new("size-mismatch", place, message).within(name));
        }
        slice.format.decode(&pixels[..n as usize], &mut body)?;
    }
    let layout = SampleLayout::volumes(first.format.element, Endian::Little, size);
    let stored = samples::read(&mut SampleStream::plain(&body, 0), &layout, limits, warnings)?;
    drop(body);
    let scale = (first.slope, first.inter);
    if series.files.iter().all(|file| (file.slice.slope, file.slice.inter) == scale) {
        return if scale == (1.0, 0.0) { Ok(stored) } else { samples::scaled(&stored, scale.0, scale.1) };
    }
    let mut values = crate::grow::with_room(stored.len())?;
    let n_slice = stored.len() / series.files.len();
    for (k, file) in series.files.iter().enumerate() {
        let value = |i: usize| file.slice.slope * stored.get(k * n_slice + i) + file.slice.inter;
        values.extend((0..n_slice).map(value));
    }
    Ok(Samples::F64(values))
}
