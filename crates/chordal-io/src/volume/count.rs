//! The number of samples that a header declares, checked before anything is allocated.
use super::element::SampleType;
use crate::text::grouped;
use crate::{FileLocation, Limits, ReadError};

/// The most samples along one axis. Chosen: a larger number means a broken header.
const MOST_ALONG: u64 = (1 << 31) - 1;

/// The size of a lattice, checked against the limits.
///
/// # Errors
/// If an axis has no cell or too many, or the samples exceed the limit of bytes.
pub(crate) fn size_of(
    declared: [i64; 3],
    element: SampleType,
    place: &FileLocation,
    limits: &Limits,
) -> Result<[usize; 3], ReadError> {
    let mut n_samples: u64 = 1;
    for (axis, n) in declared.into_iter().enumerate() {
        along(axis, n, place)?;
        if n == 1 {
            let message =
                format!("axis {axis} has 1 sample and so no cell; a volume has 2 or more along each axis");
            return Err(ReadError::new("flat-volume", place.clone(), message));
        }
        n_samples = n_samples.checked_mul(n as u64).ok_or_else(|| too_many(declared, place))?;
    }
    let bytes =
        n_samples.checked_mul(element.bytes_in_memory() as u64).ok_or_else(|| too_many(declared, place))?;
    if bytes > limits.bytes {
        let [x, y, z] = declared;
        let message = format!(
            "{x} x {y} x {z} samples take {} bytes, which is over the limit of {}",
            grouped(bytes),
            grouped(limits.bytes)
        );
        return Err(ReadError::new("too-large", place.clone(), message));
    }
    if usize::try_from(bytes).is_err() {
        return Err(too_many(declared, place));
    }
    Ok(declared.map(|n| n as usize))
}

/// Checks that the number of samples along an axis is plausible.
pub(crate) fn along(axis: usize, n: i64, place: &FileLocation) -> Result<u64, ReadError> {
    let wrong = |why: String| Err(ReadError::new("bad-size", place.clone(), why));
    match n {
        0 => wrong(format!("axis {axis} has 0 samples; a volume has 2 or more along each axis")),
        n if n < 0 => wrong(format!("axis {axis} has {n} samples, which is negative")),
        n if n as u64 > MOST_ALONG => wrong(format!(
            "axis {axis} has {} samples; {} are the most",
            grouped(n as u64),
            grouped(MOST_ALONG)
        )),
        n => Ok(n as u64),
    }
}

fn too_many([x, y, z]: [i64; 3], place: &FileLocation) -> ReadError {
    ReadError::new(
        "too-large",
        place.clone(),
        format!("{x} x {y} x {z} samples are more than can be counted"),
    )
}
