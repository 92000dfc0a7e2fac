//! `DicomSeries`: the slices of one series, sorted along the normal, and their lattice.
use super::slice::DicomSlice;
use crate::matrix::cross;
use crate::text::show;
use crate::warnings::Warnings;
use crate::{FileLocation, ReadError};
use chordal::implicit::Affine3;

/// A slice with the name and the bytes of its file.
pub(super) struct SliceFile {
    pub name: String,
    pub bytes: Vec<u8>,
    pub slice: DicomSlice,
}

/// Slices in order.
pub(super) struct DicomSeries {
    pub files: Vec<SliceFile>,
    pub affine: Affine3,
}

/// The largest difference of equal directions, which are written with some six digits. Chosen: ten times that
/// rounding.
const DIRECTION: f64 = 1e-4;
/// How far a slice may be from its position, in steps. Chosen: positions are written to a hundredth of a step
/// or better.
const PLACE: f64 = 0.01;
/// The deviation from which a warning is given, in steps. Chosen: a tenth of the allowed one.
const TOLD: f64 = 0.001;
/// The gap, in steps, that means a missing slice. Derived: halfway between one step and two.
const GAP: f64 = 1.5;

impl DicomSeries {
    /// Sorts the slices of one series.
    ///
    /// # Errors
    /// If they have different sizes, types or directions, are at the same position, or are not at equal
    /// steps.
    pub(super) fn new(mut files: Vec<SliceFile>, warnings: &mut Warnings) -> Result<Self, ReadError> {
        let first = &files[0].slice;
        let x: [f64; 3] = std::array::from_fn(|k| first.orientation[k]);
        let y: [f64; 3] = std::array::from_fn(|k| first.orientation[3 + k]);
        let normal = cross(x, y);
        let spacing = first.spacing;
        check_alike(&files)?;
        // The sort is stable: slices at one position stay in the order of their file names.
        files.sort_by(|a, b| dot(a.slice.position, normal).total_cmp(&dot(b.slice.position, normal)));
        let (low, high) = (files[0].slice.position, files[files.len() - 1].slice.position);
        let steps = (files.len() - 1) as f64;
        if files.len() < 2 {
            let message = "the series has one slice; a volume has 2 or more along each axis";
            return Err(refused("flat-volume", &files[0].name, message));
        }
        check_gaps(&files, normal)?;
        let step: [f64; 3] = std::array::from_fn(|k| (high[k] - low[k]) / steps);
        check_places(&files, step, warnings)?;
        let row = |k: usize| [x[k] * spacing[1], y[k] * spacing[0], step[k], low[k]];
        let affine = Affine3::new([row(0), row(1), row(2)])
            .map_err(|error| refused("singular", &files[0].name, &error.to_string()))?;
        Ok(Self { files, affine })
    }
}

fn refused(code: &'static str, file: &str, message: &str) -> ReadError {
    ReadError::new(code, FileLocation::File, message.to_owned()).within(file)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Checks that all slices have the size, the type and the directions of the first.
fn check_alike(files: &[SliceFile]) -> Result<(), ReadError> {
    let first = &files[0].slice;
    for file in files {
        let slice = &file.slice;
        let differs = |what: &str| {
            let message = format!("the slice has {what} than {}", show(files[0].name.as_bytes()));
            Err(refused("slices-differ", &file.name, &message))
        };
        let (a, b) = (&slice.format, &first.format);
        if (a.columns, a.rows) != (b.columns, b.rows) {
            return differs("another size");
        }
        if a.element != b.element {
            return differs("another type of samples");
        }
        if slice.orientation.iter().zip(first.orientation).any(|(a, b)| (a - b).abs() > DIRECTION) {
            return differs("other directions");
        }
        if slice.spacing.iter().zip(first.spacing).any(|(a, b)| (a - b).abs() > DIRECTION * b.abs()) {
            return differs("another spacing");
        }
    }
    Ok(())
}

/// Checks that no two slices are at the same position, and none is missing.
fn check_gaps(files: &[SliceFile], normal: [f64; 3]) -> Result<(), ReadError> {
    let along: Vec<f64> = files.iter().map(|file| dot(file.slice.position, normal)).collect();
    let mut sorted: Vec<f64> = along.windows(2).map(|two| two[1] - two[0]).collect();
    sorted.sort_by(f64::total_cmp);
    let usual = sorted[sorted.len() / 2];
    for (k, two) in along.windows(2).enumerate() {
        let gap = two[1] - two[0];
        let (a, b) = (&files[k].name, &files[k + 1].name);
        if gap.partial_cmp(&(PLACE * usual)) != Some(std::cmp::Ordering::Greater) {
            let message = format!("the slice is at the place of {}", show(a.as_bytes()));
            return Err(refused("same-place", b, &message));
        }
        if gap > GAP * usual {
            let message = format!(
                "slices are missing before it: {} is {gap} away, where others are {usual}",
                show(a.as_bytes())
            );
            return Err(refused("missing-slice", b, &message));
        }
    }
    Ok(())
}

/// Checks that slices are at equal steps along a line.
fn check_places(files: &[SliceFile], step: [f64; 3], warnings: &mut Warnings) -> Result<(), ReadError> {
    let low = files[0].slice.position;
    let length = dot(step, step).sqrt();
    let mut worst = 0.0;
    for (n, file) in files.iter().enumerate() {
        let offset: [f64; 3] =
            std::array::from_fn(|k| file.slice.position[k] - (low[k] + n as f64 * step[k]));
        let steps = dot(offset, offset).sqrt() / length;
        if steps > PLACE {
            let message = format!(
                "the slice is {steps:.3} steps from where equal steps would put it, and at most {PLACE} is read"
            );
            return Err(refused("uneven-slices", &file.name, &message));
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
