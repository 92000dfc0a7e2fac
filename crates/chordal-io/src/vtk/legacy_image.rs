//! Reads the volumes of legacy VTK files, STRUCTURED_POINTS.
use super::attributes::{ArrayRows, NamedArray};
use super::legacy_arrays::LegacyArrays;
use super::legacy_reader::{LegacyReader, lower};
use super::number_array::NumberArray;
use crate::grow::with_room;
use crate::text::{finite, grouped, integer, show};
use crate::volume::count::{along, size_of};
use crate::volume::element::{Endian, SampleType};
use crate::volume::samples::{self, SampleLayout};
use crate::volume::stream::SampleStream;
use crate::warnings::Warnings;
use crate::{Content, FileLocation, Frame, Limits, ReadError, ReadOutcome, Volume};
use chordal::budget::advice::{Message, Setting};
use chordal::implicit::{Affine3, Grid, Samples};

/// An array with one number per sample, found in a first pass.
struct Candidate {
    name: String,
    is_of_cells: bool,
}

/// Reads a volume, from the keyword after the name of the data set on: the first scalars of the points, else
/// the only array with one number per point; [`Limits::index`] selects another. If there are no arrays at
/// points, those at cells are read, at the centres of the cells, with a warning.
///
/// # Errors
/// At the line, or the byte of a binary file; also if the choice of the array is ambiguous.
pub(super) fn read(mut reader: LegacyReader<'_>, limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let mut warnings = Warnings::default();
    let lattice = LegacyLattice::read(&mut reader, &mut warnings)?;
    let place = lattice.place.clone();
    for (axis, n) in lattice.size.into_iter().enumerate() {
        along(axis, n, &place)?;
    }
    // Arrays are read twice, for their names and for their numbers, so that only one is in memory at a time.
    let mut candidates = Vec::new();
    let mut scalars = None;
    // Warnings are those of the second pass, or each would count twice.
    let first = reader.clone();
    lattice.each_array(first, &mut Warnings::default(), &mut scalars, &mut |array, is_of_cells| {
        if array.width == 1 {
            crate::grow::push(&mut candidates, Candidate { name: array.name.to_owned(), is_of_cells })?;
        }
        Ok(())
    })?;
    let chosen = choose(&candidates, scalars.as_deref(), limits, &place)?;
    let others: Vec<&str> =
        candidates.iter().enumerate().filter(|(i, _)| *i != chosen).map(|(_, c)| &*c.name).collect();
    warnings.count_many("arrays-ignored", others.len() as u64, || {
        let first = show(others[0].as_bytes());
        (place.clone(), format!("other arrays of the file were not read, {first} first"))
    });
    let Candidate { name, is_of_cells } = &candidates[chosen];
    let size = lattice.size.map(|n| n - i64::from(*is_of_cells));
    let mut read = None;
    let mut ordinal = 0;
    lattice.each_array(reader, &mut warnings, &mut None, &mut |array, _| {
        if array.width == 1 {
            if ordinal == chosen {
                let size = size_of(size, array.kind, &array.place.location(), limits)?;
                read = Some((samples_of(array, size, limits)?, size));
            }
            ordinal += 1;
        }
        Ok(())
    })?;
    let Some((samples, size)) = read else {
        return Err(ReadError::new("no-samples", place, "the file has no arrays"));
    };
    if *is_of_cells {
        warnings.count("cell-samples", || {
            (place.clone(), "samples belong to cells: each is taken to be at the centre of its cell")
        });
    }
    samples::count_not_finite(&samples, &mut warnings);
    let grid = Grid::new(size, samples, lattice.affine(*is_of_cells)?)
        .map_err(|error| ReadError::new("bad-size", place, error.to_string()))?;
    let name = crate::volume::name_of(name.as_bytes());
    let volume = Volume { frame: Frame::default(), name, ..Volume::from_grid(grid) };
    Ok(ReadOutcome { content: Content::Volume(volume), warnings: warnings.into_list() })
}

/// Chooses the array to read.
fn choose(
    candidates: &[Candidate],
    scalars: Option<&str>,
    limits: &Limits,
    place: &FileLocation,
) -> Result<usize, ReadError> {
    let has_points = candidates.iter().any(|array| !array.is_of_cells);
    let selectable: Vec<usize> =
        (0..candidates.len()).filter(|i| candidates[*i].is_of_cells != has_points).collect();
    let names = || {
        let shown: Vec<String> = selectable.iter().map(|i| show(candidates[*i].name.as_bytes())).collect();
        shown.join(", ")
    };
    if let Some(index) = limits.index {
        let one = usize::try_from(index).ok().and_then(|index| selectable.get(index).copied());
        return one.ok_or_else(|| {
            let message = format!("there is no array {index}, counted from 0: the arrays are {}", names());
            ReadError::new("no-such-volume", place.clone(), message)
        });
    }
    let active = selectable.iter().copied().find(|i| Some(&*candidates[*i].name) == scalars);
    match (active, selectable.as_slice()) {
        (Some(one), _) => Ok(one),
        (None, [one]) => Ok(*one),
        (None, []) => {
            let message = "the file has no array of one number a sample";
            Err(ReadError::new("no-samples", place.clone(), message))
        }
        (None, all) => {
            let message = Message::from(format!("the file holds {} arrays, {}: ", all.len(), names()))
                .setting(Setting::Index)
                .words(format_args!(" names one, from 0 to {}", all.len() - 1));
            Err(ReadError::new("several-volumes", place.clone(), message))
        }
    }
}

/// The samples of an array, in the type that the file gives them.
fn samples_of(array: &NamedArray<'_>, size: [usize; 3], limits: &Limits) -> Result<Samples, ReadError> {
    let packed;
    let (bytes, endian) = match &array.numbers {
        NumberArray::Packed { bytes, endian, .. } => (&**bytes, *endian),
        NumberArray::Reals(list) if array.kind == SampleType::F32 => {
            return Ok(Samples::F32(converted(list, |x| *x as f32)?));
        }
        NumberArray::Reals(list) => return Ok(Samples::F64(converted(list, |x| *x)?)),
        // Numbers from text were checked against the range of their type.
        NumberArray::Integers(list) => match array.kind {
            SampleType::U8 | SampleType::Bool => return Ok(Samples::U8(converted(list, |x| *x as u8)?)),
            SampleType::I8 => return Ok(Samples::I8(converted(list, |x| *x as i8)?)),
            SampleType::U16 => return Ok(Samples::U16(converted(list, |x| *x as u16)?)),
            SampleType::I16 => return Ok(Samples::I16(converted(list, |x| *x as i16)?)),
            SampleType::U32 => return Ok(Samples::U32(converted(list, |x| *x as u32)?)),
            SampleType::I32 => return Ok(Samples::I32(converted(list, |x| *x as i32)?)),
            _ => {
                packed = converted(list, |x| x.to_le_bytes())?;
                (packed.as_flattened(), Endian::Little)
            }
        },
    };
    let layout = SampleLayout::volumes(array.kind, endian, size);
    samples::read(&mut SampleStream::plain(bytes, 0), &layout, limits, &mut Warnings::default())
}

fn converted<T, U>(list: &[T], to: impl Fn(&T) -> U) -> Result<Vec<U>, ReadError> {
    let mut converted = with_room(list.len())?;
    converted.extend(list.iter().map(to));
    Ok(converted)
}

/// The lattice of the samples.
struct LegacyLattice {
    size: [i64; 3],
    /// The index of the first point.
    low: [i64; 3],
    origin: [f64; 3],
    spacing: [f64; 3],
    /// The location of its size.
    place: FileLocation,
}

impl LegacyLattice {
    /// Reads up to the data of points or cells.
    fn read(reader: &mut LegacyReader<'_>, warnings: &mut Warnings) -> Result<Self, ReadError> {
        let place = reader.place().location();
        let mut lattice = Self { size: [0; 3], low: [0; 3], origin: [0.0; 3], spacing: [1.0; 3], place };
        while let Some(word) = reader.peek() {
            let keyword = lower(word);
            if matches!(&*keyword, "point_data" | "cell_data") {
                break;
            }
            reader.next();
            match &*keyword {
                "dimensions" => {
                    lattice.place = reader.place().location();
                    lattice.size = whole_numbers(reader)?;
                }
                "extent" => {
                    lattice.place = reader.place().location();
                    let [x, to_x, y, to_y, z, to_z] = whole_numbers(reader)?;
                    lattice.low = [x, y, z];
                    lattice.size = [[x, to_x], [y, to_y], [z, to_z]]
                        .map(|[low, high]| high.checked_sub(low).and_then(|n| n.checked_add(1)).unwrap_or(0));
                }
                "spacing" | "aspect_ratio" => lattice.spacing = real_numbers(reader)?,
                "origin" => lattice.origin = real_numbers(reader)?,
                "field" => LegacyArrays::new(reader, warnings).skip_field()?,
                "metadata" => LegacyArrays::new(reader, warnings).skip_metadata()?,
                _ => {
                    let message = format!("{} is no keyword of VTK here", show(word));
                    return Err(reader.error("unknown-keyword", message));
                }
            }
        }
        if lattice.size == [0; 3] {
            return Err(reader.error("bad-header", "no DIMENSIONS stand before the data".to_owned()));
        }
        Ok(lattice)
    }

    /// Passes each array of numbers to `sink`, with a flag for arrays of cells; `scalars` is the name of the
    /// first scalars.
    fn each_array(
        &self,
        mut reader: LegacyReader<'_>,
        warnings: &mut Warnings,
        scalars: &mut Option<String>,
        sink: &mut dyn FnMut(&NamedArray<'_>, bool) -> Result<(), ReadError>,
    ) -> Result<(), ReadError> {
        let count =
            |size: [i64; 3]| size.iter().try_fold(1_u64, |all, n| all.checked_mul(u64::try_from(*n).ok()?));
        while let Some(word) = reader.next() {
            let (is_of_cells, expected) = match &*lower(word) {
                "point_data" => (false, count(self.size)),
                "cell_data" => (true, count(self.size.map(|n| n - 1))),
                "metadata" => {
                    LegacyArrays::new(&mut reader, warnings).skip_metadata()?;
                    continue;
                }
                _ => {
                    let message = format!("{} is no keyword of VTK here", show(word));
                    return Err(reader.error("unknown-keyword", message));
                }
            };
            let n = reader.count("the number of rows")?;
            if expected != Some(n) {
                let [x, y, z] = self.size;
                let what = if is_of_cells { "cells" } else { "points" };
                let message = format!("data for {} {what}, and there are {x} x {y} x {z} points", grouped(n));
                return Err(reader.error("count-mismatch", message));
            }
            let n = usize::try_from(n).unwrap_or(usize::MAX);
            let rows = if is_of_cells { ArrayRows::Cells(n, &[]) } else { ArrayRows::Points(n) };
            let mut arrays = LegacyArrays::new(&mut reader, warnings);
            arrays.read(rows, 0, &mut |array, _, _| sink(array, is_of_cells))?;
            if let (None, Some(name)) = (&scalars, arrays.first_scalars) {
                *scalars = Some(name);
            }
        }
        Ok(())
    }

    fn affine(&self, is_of_cells: bool) -> Result<Affine3, ReadError> {
        // A cell's centre is half a step after its lowest point.
        let half = if is_of_cells { 0.5 } else { 0.0 };
        let rows = [0, 1, 2].map(|k| {
            let mut row = [0.0; 4];
            row[k] = self.spacing[k];
            row[3] = self.origin[k] + self.spacing[k] * (self.low[k] as f64 + half);
            row
        });
        Affine3::new(rows).map_err(|error| ReadError::new("singular", self.place.clone(), error.to_string()))
    }
}

fn whole_numbers<const N: usize>(reader: &mut LegacyReader<'_>) -> Result<[i64; N], ReadError> {
    let mut values = [0; N];
    for number in &mut values {
        let word = reader.word("a number of points")?;
        *number = integer(word)
            .map_err(|_| reader.error("not-a-number", format!("{} is not a whole number", show(word))))?;
    }
    Ok(values)
}

fn real_numbers(reader: &mut LegacyReader<'_>) -> Result<[f64; 3], ReadError> {
    let mut values = [0.0; 3];
    for number in &mut values {
        let place = reader.place();
        *number = finite(reader.word("a number")?, || place.location())?;
    }
    Ok(values)
}
