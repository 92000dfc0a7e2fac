//! SLC, `.slc`: volumes of VolVis with samples of one byte, plain or as runs.
//!
//! Source: R. Avila, T. He, L. Hong, A. Kaufman and others, *VolVis: A Diversified Volume Visualization System*,
//! 1994; the layout as VTK's reader of the format takes it.
use crate::grow::out_of_memory;
use crate::text::{finite, grouped, integer, is_space, show};
use crate::volume::count::size_of;
use crate::volume::element::SampleType;
use crate::warnings::Warnings;
use crate::{Content, FileLocation, Limits, ReadError, ReadOutcome, Volume};
use chordal::implicit::{Affine3, Grid, Samples};

/// The number that a file starts with.
const MAGIC: &[u8] = b"11111";
/// The lower seven bits of a run's first byte hold its length. If the eighth bit is set, that many samples
/// follow; if not, one sample follows, which is repeated that many times.
const LENGTH: u8 = 0x7f;

/// Reads an SLC volume: its samples at multiples of its steps, from the origin. The icon in the file is
/// skipped.
///
/// # Errors
/// [`ReadError`] at the byte, for an invalid header, samples that do not have 8 bits, or runs that are
/// truncated or exceed their slice.
///
/// ```
/// use chordal_io::{Content, Limits, slc};
/// let file = b"11111\n2 2 2 8\n1 1 2.5\n0 0 0 0\n1 1 X\x01\x02\x03\x00\x01\x02\x03\x04\x05\x06\x07";
/// let Content::Volume(volume) = slc::read(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(volume.grid.sample([1, 0, 1]), 5.0);
/// assert_eq!(volume.grid.affine().at([1.0, 0.0, 1.0]), [1.0, 0.0, 2.5]);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let mut warnings = Warnings::default();
    let mut cursor = SlcCursor { bytes, at: 0 };
    let magic = cursor.token("its number")?;
    if magic != MAGIC {
        let message = format!("an .slc file starts with 11111, not {}", show(magic));
        return Err(ReadError::new("bad-magic", FileLocation::Byte(0), message));
    }
    let place = cursor.place();
    let declared = [cursor.integer("a size")?, cursor.integer("a size")?, cursor.integer("a size")?];
    let bits = cursor.integer("the bits of a sample")?;
    if bits != 8 {
        let message = format!("samples of {bits} bits are not read: those of an .slc file have 8");
        return Err(ReadError::new("unsupported-type", place, message));
    }
    let size = size_of(declared, SampleType::U8, &place, limits)?;
    let steps = [cursor.step()?, cursor.step()?, cursor.step()?];
    // The unit, the source of the volume, and its modification: no known reader uses these numbers.
    for what in ["a unit", "an origin", "a modification"] {
        cursor.integer(what)?;
    }
    let packing_at = cursor.place();
    let packing = cursor.integer("a compression")?;
    cursor.skip_icon()?;
    let samples = match packing {
        0 => cursor.plain(size)?,
        1 => cursor.runs(size)?,
        other => {
            let message = format!("compression {other} is not known: 0 is none, 1 are runs");
            return Err(ReadError::new("unsupported", packing_at, message));
        }
    };
    let left = bytes.len() - cursor.at;
    if left > 0 {
        warnings.count("trailing-bytes", || {
            (cursor.place(), format!("{} bytes after the samples were skipped", grouped(left as u64)))
        });
    }
    let [x, y, z] = steps;
    let affine = Affine3::new([[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0]])
        .map_err(|error| ReadError::new("singular", place.clone(), error.to_string()))?;
    let grid = Grid::new(size, Samples::U8(samples), affine)
        .map_err(|error| ReadError::new("bad-size", place, error.to_string()))?;
    Ok(ReadOutcome { content: Content::Volume(Volume::from_grid(grid)), warnings: warnings.into_list() })
}

/// Whether bytes start like an SLC file: the magic number, then four more numbers.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    let mut cursor = SlcCursor { bytes, at: 0 };
    cursor.token("").is_ok_and(|magic| magic == MAGIC)
        && (0..3).all(|_| cursor.integer("").is_ok_and(|n| n > 0))
        && cursor.integer("").is_ok_and(|bits| bits == 8)
}

/// A position in the file.
struct SlcCursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> SlcCursor<'a> {
    fn place(&self) -> FileLocation {
        FileLocation::Byte(self.at as u64)
    }

    fn cut_off(&self, what: &str) -> ReadError {
        ReadError::new("truncated", self.place(), format!("the file ends before {what}"))
    }

    /// The next word of the header.
    fn token(&mut self, what: &str) -> Result<&'a [u8], ReadError> {
        let rest = &self.bytes[self.at..];
        let begin = rest.iter().position(|b| !is_space(*b)).ok_or_else(|| self.cut_off(what))?;
        let rest = &rest[begin..];
        let end = rest.iter().position(|b| is_space(*b)).unwrap_or(rest.len());
        self.at += begin + end;
        Ok(&rest[..end])
    }

    fn integer(&mut self, what: &str) -> Result<i64, ReadError> {
        let place = self.place();
        let token = self.token(what)?;
        integer(token).map_err(|_| {
            ReadError::new("bad-number", place, format!("{} is no whole number for {what}", show(token)))
        })
    }

    fn step(&mut self) -> Result<f64, ReadError> {
        let place = self.place();
        let step = finite(self.token("a step")?, || place.clone())?;
        if step > 0.0 {
            return Ok(step);
        }
        Err(ReadError::new("bad-spacing", place, format!("a step of {step} between samples is not above 0")))
    }

    /// A number, and the X after which its bytes begin.
    fn counted(&mut self, what: &str) -> Result<usize, ReadError> {
        let place = self.place();
        let rest = &self.bytes[self.at..];
        // A number of 64 bits has at most 20 digits, with a few blanks.
        let end = rest.iter().take(32).position(|b| *b == b'X').ok_or_else(|| {
            ReadError::new(
                "bad-header",
                place.clone(),
                format!("there is no X after the number of bytes of {what}"),
            )
        })?;
        let token = crate::text::trim(&rest[..end]);
        let n = integer(token).ok().and_then(|n| usize::try_from(n).ok());
        let n = n.ok_or_else(|| {
            ReadError::new("bad-number", place, format!("{} is no number of bytes of {what}", show(token)))
        })?;
        self.at += end + 1;
        Ok(n)
    }

    fn take(&mut self, n: usize, what: &str) -> Result<&'a [u8], ReadError> {
        let taken = self.bytes[self.at..].get(..n).ok_or_else(|| {
            let n_left = self.bytes.len() - self.at;
            let message = format!(
                "{what} is cut off: {} bytes are there, the file says {}",
                grouped(n_left as u64),
                grouped(n as u64)
            );
            ReadError::new("truncated", self.place(), message)
        })?;
        self.at += n;
        Ok(taken)
    }

    /// Skips the icon: its width and height, and a byte for red, green and blue of each pixel.
    fn skip_icon(&mut self) -> Result<(), ReadError> {
        let place = self.place();
        let width = self.integer("the width of the picture")?;
        let height = self.counted("the picture")?;
        let n = usize::try_from(width).ok().and_then(|width| width.checked_mul(height)?.checked_mul(3));
        let n = n.ok_or_else(|| {
            ReadError::new("bad-size", place, format!("a picture of {width} x {height} pixels is none"))
        })?;
        self.take(n, "the picture").map(|_| ())
    }

    fn plain(&mut self, size: [usize; 3]) -> Result<Vec<u8>, ReadError> {
        let samples = self.take(size.iter().product(), "the sample data")?;
        let mut copy = Vec::new();
        copy.try_reserve_exact(samples.len()).map_err(|_| out_of_memory(samples.len()))?;
        copy.extend_from_slice(samples);
        Ok(copy)
    }

    /// The slices, each as its number of bytes and its runs.
    fn runs(&mut self, [x, y, z]: [usize; 3]) -> Result<Vec<u8>, ReadError> {
        let mut samples = Vec::new();
        for slice in 0..z {
            let n = self.counted("a slice")?;
            let start = self.at;
            let runs = self.take(n, "a slice")?;
            let end = samples.len() + x * y;
            let at = |k: usize| FileLocation::Byte((start + k) as u64);
            let mut k = 0;
            // A length of 0 ends the slice, even before its last byte.
            while let Some(head) = runs.get(k).filter(|head| *head & LENGTH != 0) {
                let length = usize::from(head & LENGTH);
                // Checked before samples are stored: a byte yields at most 64 samples.
                if length > end - samples.len() {
                    let message =
                        format!("slice {slice} has more than its {} samples", grouped((x * y) as u64));
                    return Err(ReadError::new("bad-run", at(k), message));
                }
                samples.try_reserve(length).map_err(|_| out_of_memory(length))?;
                let is_copy = head & !LENGTH != 0;
                let n_stored = if is_copy { length } else { 1 };
                let stored = runs.get(k + 1..k + 1 + n_stored).ok_or_else(|| {
                    ReadError::new("truncated", at(k), format!("the last run of slice {slice} is cut off"))
                })?;
                if is_copy {
                    samples.extend_from_slice(stored);
                } else {
                    samples.resize(samples.len() + length, stored[0]);
                }
                k += 1 + n_stored;
            }
            if samples.len() < end {
                let message = format!(
                    "slice {slice} has {} samples less than its {}",
                    grouped((end - samples.len()) as u64),
                    grouped((x * y) as u64)
                );
                return Err(ReadError::new("truncated", at(k), message));
            }
        }
        Ok(samples)
    }
}
