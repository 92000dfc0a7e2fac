//! Run-length encoded pixels of DICOM: one picture in several planes of bytes.
//!
//! Source: NEMA, *DICOM PS3.5*, 2024, annex G.
use crate::text::grouped;
use crate::volume::element::Endian;
use crate::{FileLocation, ReadError};

/// The header of a picture: 16 numbers of 32 bits, the number of segments and their offsets.
const HEADER: usize = 64;

/// The little-endian samples of the packed `picture`, which starts `at` a byte of the file: `n_pixels`
/// samples of `width` bytes.
///
/// # Errors
/// If the picture is truncated, or of another size than declared.
pub(super) fn unpack(
    (picture, at): (&[u8], usize),
    (n_pixels, width): (u64, usize),
) -> Result<Vec<u8>, ReadError> {
    let wrong =
        |code, at: usize, message: String| Err(ReadError::new(code, FileLocation::Byte(at as u64), message));
    let number = |k: usize| {
        let bytes = picture.get(4 * k..4 * k + 4)?;
        usize::try_from(u32::from_le_bytes(Endian::Little.array(bytes))).ok()
    };
    if picture.len() < HEADER {
        return wrong(
            "truncated",
            at,
            format!("the header of run lengths has {HEADER} bytes; {} are there", picture.len()),
        );
    }
    if number(0) != Some(width) {
        let message = format!("{} planes of bytes for samples of {width} bytes", number(0).unwrap_or(0));
        return wrong("bad-header", at, message);
    }
    // A byte of runs yields at most 64 samples, so the size is checked before memory is reserved.
    let n_pixels = usize::try_from(n_pixels).unwrap_or(usize::MAX);
    if n_pixels.checked_mul(width).is_none_or(|n| n / 64 > picture.len()) {
        return wrong("truncated", at, format!("{} packed bytes are too few", grouped(picture.len() as u64)));
    }
    let mut samples = crate::grow::with_room(n_pixels * width)?;
    samples.resize(n_pixels * width, 0);
    for plane in 0..width {
        let begin = number(1 + plane).unwrap_or(0);
        let end = if plane + 1 < width { number(2 + plane).unwrap_or(0) } else { picture.len() };
        let Some(runs) = picture.get(begin..end).filter(|_| begin >= HEADER) else {
            return wrong("bad-header", at, format!("plane {plane} is from byte {begin} to {end}"));
        };
        // The first plane has the most significant bytes.
        let n = fill(runs, samples.iter_mut().skip(width - 1 - plane).step_by(width));
        if n != n_pixels {
            let message =
                format!("plane {plane} has {} samples of {}", grouped(n as u64), grouped(n_pixels as u64));
            return wrong("size-mismatch", at + begin, message);
        }
    }
    Ok(samples)
}

/// Unpacks runs into bytes, and counts them. Only padding may follow the last byte.
fn fill<'a>(runs: &[u8], mut out: impl Iterator<Item = &'a mut u8>) -> usize {
    let (mut k, mut n) = (0, 0);
    while let Some(head) = runs.get(k) {
        // Up to 127, that number plus one literal bytes follow; from 129 on, one byte repeated 257 minus that
        // number times; 128 does nothing.
        let length = usize::from(*head);
        let (times, step) = match length {
            0..=127 => (length + 1, 1),
            128 => (0, 0),
            _ => (257 - length, 0),
        };
        for i in 0..times {
            let (Some(value), Some(place)) = (runs.get(k + 1 + i * step), out.next()) else { return n };
            *place = *value;
            n += 1;
        }
        k += 1 + if step == 1 { times } else { usize::from(length != 128) };
    }
    n
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_those_of_the_example_in_the_standard_and_stop_at_the_end() {
        let unpacked = |runs: &[u8], n: usize| {
            let mut out = vec![0; n];
            let filled = fill(runs, out.iter_mut());
            out.truncate(filled);
            out
        };
        assert_eq!(unpacked(&[2, 5, 6, 7, 254, 9, 128, 0, 1], 7), [5, 6, 7, 9, 9, 9, 1]);
        assert_eq!(unpacked(&[2, 5, 6], 7), [5, 6]);
        assert_eq!(unpacked(&[129, 3], 128), [3; 128]);
        assert_eq!(unpacked(&[250], 3), [0_u8; 0]);
        assert_eq!(unpacked(&[255, 4, 0], 9), [4, 4]);
    }
}
