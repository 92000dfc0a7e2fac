//! `DicomSeries`: the slices of one series, sorted along the normal, and their lattice.
use super::file::{DicomFile, DicomFrame};
use crate::matrix::cross;
use crate::text::show;
use crate::warnings::Warnings;
use crate::{FileLocation, ReadError};
use chordal::implicit::Affine3;

/// One slice: a frame of a file.
#[derive(Clone, Copy)]
pub(super) struct DicomSlice<'a> {
    pub file: &'a DicomFile<'a>,
    pub number: usize,
}

impl<'a> DicomSlice<'a> {
    pub(super) fn frame(&self) -> &'a DicomFrame {
        &self.file.frames[self.number]
    }

    /// The name for a message.
    pub(super) fn name(&self) -> String {
        self.file.name_of(self.number)
    }
}

/// Slices in order.
pub(super) struct DicomSeries<'a> {
    pub slices: Vec<DicomSlice<'a>>,
    pub affine: Affine3,
}

/// The largest difference of equal directions, which are written with some six digits. Chosen: ten times that
/// rounding.
const DIRECTION: f64 = 1e-4;
/// How far squared lengths of directions may be from 1, and their product from 0. Chosen: directions written to two
/// digits, far from those of another unit.
const SQUARE: f64 = 0.02;
/// How far a slice may be from its position, in steps. Chosen: positions are written to a hundredth of a step
/// or better.
pub(super) const PLACE: f64 = 0.01;
/// The deviation from which a warning is given, in steps. Chosen: a tenth of the allowed one.
const TOLD: f64 = 0.001;
/// The gap, in steps, that means a missing slice. Derived: halfway between one step and two.
const GAP: f64 = 1.5;

impl<'a> DicomSeries<'a> {
    /// Sorts the slices of one series.
    ///
    /// # Errors
    /// If they have different sizes, types or directions, are at the same position, or are not at equal
    /// steps.
    pub(super) fn new(mut slices: Vec<DicomSlice<'a>>, warnings: &mut Warnings) -> Result<Self, ReadError> {
        check_alike(&slices)?;
        let first = slices[0];
        let normal = normal_of(&first);
        // The sort is stable: slices at one position stay in the order of their files.
        slices.sort_by(|a, b| dot(a.frame().position, normal).total_cmp(&dot(b.frame().position, normal)));
        if slices.len() < 2 {
            let message = "the series has one slice; a volume has 2 or more along each axis";
            return Err(refused("flat-volume", &slices[0], message));
        }
        let (low, high) = (slices[0].frame().position, slices[slices.len() - 1].frame().position);
        let steps = (slices.len() - 1) as f64;
        check_gaps(&slices, normal)?;
        let step: [f64; 3] = std::array::from_fn(|k| (high[k] - low[k]) / steps);
        check_places(&slices, step, warnings)?;
        let affine = affine_of(&first, step, low)?;
        Ok(Self { slices, affine })
    }
}

/// The normal of a slice.
pub(super) fn normal_of(slice: &DicomSlice<'_>) -> [f64; 3] {
    let [a, b, c, d, e, f] = slice.frame().orientation;
    cross([a, b, c], [d, e, f])
}

/// The lattice of slices like `first` that are `step` apart, from `low` on.
///
/// # Errors
/// If the directions of the slice are no plane's, or flatten space.
pub(super) fn affine_of(first: &DicomSlice<'_>, step: [f64; 3], low: [f64; 3]) -> Result<Affine3, ReadError> {
    let DicomFrame { orientation: o, spacing, .. } = first.frame();
    let (along_row, along_column) = ([o[0], o[1], o[2]], [o[3], o[4], o[5]]);
    let lengths = [dot(along_row, along_row), dot(along_column, along_column)];
    let are_square = lengths.iter().all(|length| (length - 1.0).abs() <= SQUARE)
        && dot(along_row, along_column).abs() <= SQUARE;
    if !are_square || spacing.iter().any(|distance| *distance < 0.0) {
        let message = "the directions of rows and columns are not of length 1 and at a right angle, or the distance \
                       of their samples is below 0";
        return Err(refused("bad-header", first, message));
    }
    let row = |k: usize| [o[k] * spacing[1], o[3 + k] * spacing[0], step[k], low[k]];
    Affine3::new([row(0), row(1), row(2)]).map_err(|error| refused("singular", first, &error.to_string()))
}

pub(super) fn refused(code: &'static str, slice: &DicomSlice<'_>, message: &str) -> ReadError {
    ReadError::new(code, FileLocation::File, message.to_owned()).within(&slice.name())
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Checks that all slices have the size, the type and the directions of the first.
pub(super) fn check_alike(slices: &[DicomSlice<'_>]) -> Result<(), ReadError> {
    let first = slices[0].frame();
    for slice in slices {
        let frame = slice.frame();
        let differs = |what: &str| {
            let message = format!("the slice has {what} than {}", show(slices[0].name().as_bytes()));
            Err(refused("slices-differ", slice, &message))
        };
        let (a, b) = (&slice.file.format, &slices[0].file.format);
        if (a.columns, a.rows) != (b.columns, b.rows) {
            return differs("another size");
        }
        if a.element != b.element {
            return differs("another type of samples");
        }
        if frame.orientation.iter().zip(first.orientation).any(|(a, b)| (a - b).abs() > DIRECTION) {
            return differs("other directions");
        }
        if frame.spacing.iter().zip(first.spacing).any(|(a, b)| (a - b).abs() > DIRECTION * b.abs()) {
            return differs("another spacing");
        }
    }
    Ok(())
}

/// Checks that no two slices are at the same position, and none is missing.
fn check_gaps(slices: &[DicomSlice<'_>], normal: [f64; 3]) -> Result<(), ReadError> {
    let along: Vec<f64> = slices.iter().map(|slice| dot(slice.frame().position, normal)).collect();
    let mut sorted: Vec<f64> = along.windows(2).map(|two| two[1] - two[0]).collect();
    sorted.sort_by(f64::total_cmp);
    let usual = sorted[sorted.len() / 2];
    for (k, two) in along.windows(2).enumerate() {
        let gap = two[1] - two[0];
        let (a, b) = (&slices[k], &slices[k + 1]);
        if gap.partial_cmp(&(PLACE * usual)) != Some(std::cmp::Ordering::Greater) {
            let message = format!("the slice is at the place of {}", show(a.name().as_bytes()));
            return Err(refused("same-place", b, &message));
        }
        if gap > GAP * usual {
            let message = format!(
                "slices are missing before it: {} is {gap} away, where others are {usual}",
                show(a.name().as_bytes())
            );
            return Err(refused("missing-slice", b, &message));
        }
    }
    Ok(())
}

/// Checks that slices are at equal steps along a line.
fn check_places(slices: &[DicomSlice<'_>], step: [f64; 3], warnings: &mut Warnings) -> Result<(), ReadError> {
    let low = slices[0].frame().position;
    let length = dot(step, step).sqrt();
    let mut worst = 0.0;
    for (n, slice) in slices.iter().enumerate() {
        let offset: [f64; 3] =
            std::array::from_fn(|k| slice.frame().position[k] - (low[k] + n as f64 * step[k]));
        let steps = dot(offset, offset).sqrt() / length;
        if steps > PLACE {
            let message = format!(
                "the slice is {steps:.3} steps from where equal steps would put it, and at most {PLACE} is read"
            );
            return Err(refused("uneven-slices", slice, &message));
        }
        if steps > worst {
            worst = steps;
        }
    }
    if worst > TOLD {
        warnings.count("slices-moved", || {
            let message =
                format!("slices are not at equal steps: up to {worst:.4} of a step was taken for rounding");
            (FileLocation::File, message)
        });
    }
    Ok(())
}
