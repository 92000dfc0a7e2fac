//! Reads `.npy`.
use super::header::NpyHeader;
use crate::volume::count::size_of;
use crate::volume::samples::{self, SampleLayout};
use crate::volume::stream::SampleStream;
use crate::warnings::Warnings;
use crate::{Content, Limits, ReadError, ReadOutcome, Volume};
use chordal::implicit::{Affine3, Grid};

/// Reads the volume of an array `a[i, j, k]`. Its sample is at x = i, y = j, z = k, whichever index varies
/// fastest in memory; samples are neither rotated nor copied.
///
/// 64-bit integers become 32 bits if all of them fit, else f64 if that holds all of them exactly.
///
/// # Errors
/// [`ReadError`] at the byte: for arrays that do not have three axes, and arrays of records, of complex
/// numbers, or of Python objects, which are never executed.
///
/// ```
/// use chordal_io::{Content, Limits, npy};
/// let mut file = b"\x93NUMPY\x01\x00\x3e\x00".to_vec();
/// file.extend(format!("{:<61}\n", "{'descr': '|u1', 'fortran_order': False, 'shape': (2, 2, 2)}").bytes());
/// file.extend([0, 1, 2, 3, 4, 5, 6, 7]);
/// let Content::Volume(volume) = npy::read(&file, &Limits::default())?.content else { unreachable!() };
/// // a[1, 0, 0] is the fifth number. Its lattice index is [0, 0, 1], since the last index of `a` runs fastest.
/// assert_eq!(volume.grid.sample([0, 0, 1]), 4.0);
/// assert_eq!(volume.grid.affine().at([0.0, 0.0, 1.0]), [1.0, 0.0, 0.0]);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let mut warnings = Warnings::default();
    let header = NpyHeader::read(bytes, limits)?;
    let shape: [i64; 3] = header.shape.as_slice().try_into().map_err(|_| wrong_axes(&header))?;
    // The first index of a grid varies fastest, as in Fortran; in the order of C it is the last.
    let declared = if header.fortran_order { shape } else { [shape[2], shape[1], shape[0]] };
    let size = size_of(declared, header.element, &header.shape_place, limits)?;
    if let Some(index) = limits.index.filter(|index| *index > 0) {
        let message = format!("there is one volume, so that index {index} is none");
        return Err(ReadError::new("no-such-volume", header.shape_place, message));
    }
    let layout = SampleLayout::volumes(header.element, header.endian, size);
    let mut stream = SampleStream::plain(bytes, header.end);
    let samples = samples::read(&mut stream, &layout, limits, &mut warnings)?;
    samples::count_not_finite(&samples, &mut warnings);
    let affine = if header.fortran_order { Affine3::IDENTITY } else { reversed() };
    let grid = Grid::new(size, samples, affine)
        .map_err(|error| ReadError::new("bad-size", header.shape_place, error.to_string()))?;
    Ok(ReadOutcome { content: Content::Volume(Volume::from_grid(grid)), warnings: warnings.into_list() })
}

/// Maps lattice index (k, j, i) to the point (i, j, k).
pub(super) fn reversed() -> Affine3 {
    let rows = [[0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]];
    // A permutation is never singular.
    Affine3::new(rows).unwrap_or(Affine3::IDENTITY)
}

fn wrong_axes(header: &NpyHeader) -> ReadError {
    let n = header.shape.len();
    let more = match n {
        2 => "; an image is one slice: stack several, as in np.stack(slices)",
        4.. => "; save one volume, as in a[0]",
        _ => "",
    };
    let message = format!("an array of {n} axes is no volume: three are expected, as in a[i, j, k]{more}");
    ReadError::new("not-3d", header.shape_place.clone(), message)
}
