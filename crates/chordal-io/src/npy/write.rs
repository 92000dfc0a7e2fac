//! Writes `.npy`.
use super::MAGIC;
use super::read::reversed;
use crate::{Volume, WriteError};
use chordal::implicit::{Affine3, Samples, SparseGrid};
use std::io::Write;

/// Writes the samples as an array of version 1, little-endian. If the volume was read from such a file, `a[i,
/// j, k]` is the sample at x = i, y = j, z = k. Otherwise it is the sample of lattice index (i, j, k), in
/// Fortran order. Spacing, origin and unit are not written, since the format has no room for them;
/// [`crate::nrrd`] holds them.
///
/// # Errors
/// If the sink fails.
///
/// ```
/// use chordal::implicit::{Affine3, Grid, Samples};
/// use chordal_io::{Content, Limits, Volume, npy};
/// let grid = Grid::new([2, 3, 2], Samples::I16((0..12).collect()), Affine3::IDENTITY)?;
/// let (volume, mut file) = (Volume::from_grid(grid), Vec::new());
/// npy::write(&volume, &mut file)?;
/// let Content::Volume(read) = npy::read(&file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(read, volume);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(volume: &Volume, out: &mut dyn Write) -> Result<(), WriteError> {
    let [x, y, z] = volume.grid.size();
    let (order, shape) =
        if same_axes(volume.grid.affine(), &reversed()) { ("False", [z, y, x]) } else { ("True", [x, y, z]) };
    let types = match volume.grid.samples() {
        Samples::U8(_) => "|u1",
        Samples::I8(_) => "|i1",
        Samples::U16(_) => "<u2",
        Samples::I16(_) => "<i2",
        Samples::U32(_) => "<u4",
        Samples::I32(_) => "<i4",
        Samples::F32(_) => "<f4",
        Samples::F64(_) => "<f8",
        _ => return Err(WriteError::Unsupported("npy holds no samples of that type".to_owned())),
    };
    write_header((types, order), shape, out)?;
    write_samples(volume.grid.samples(), out)
}

/// Writes samples in bricks with the same bytes as [`write`] for dense ones, without a dense copy in memory.
///
/// # Errors
/// If the sink fails.
///
/// ```
/// use chordal::implicit::{Affine3, Grid, Samples, SparseGrid};
/// use chordal_io::{Volume, npy};
/// let dense = Grid::new([2, 9, 2], Samples::F64((0..36).map(f64::from).collect()), Affine3::IDENTITY)?;
/// let (mut a, mut b) = (Vec::new(), Vec::new());
/// npy::write(&Volume::from_grid(dense.clone()), &mut a)?;
/// npy::write_sparse(&SparseGrid::from_grid(&dense, 1.0), &mut b)?;
/// assert_eq!(a.len(), b.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_sparse(grid: &SparseGrid, out: &mut dyn Write) -> Result<(), WriteError> {
    write_header(("<f8", "True"), grid.size(), out)?;
    write_bricks(grid, out)
}

fn write_header(
    (types, order): (&str, &str),
    [x, y, z]: [usize; 3],
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let mut header =
        format!("{{'descr': '{types}', 'fortran_order': {order}, 'shape': ({x}, {y}, {z}), }}").into_bytes();
    // Magic, version and length take 10 bytes. Samples start at a multiple of 64, after a line feed.
    let padding = 63 - (10 + header.len()) % 64;
    header.resize(header.len() + padding, b' ');
    header.push(b'\n');
    out.write_all(MAGIC)?;
    out.write_all(&[1, 0])?;
    // The length is at most some hundred bytes.
    out.write_all(&(header.len() as u16).to_le_bytes())?;
    out.write_all(&header)?;
    Ok(())
}

/// Whether the axes of two lattices have the same directions, whatever their steps.
fn same_axes(a: &Affine3, b: &Affine3) -> bool {
    let along = |step: [f64; 3]| step.map(|x| if x == 0.0 { 0.0 } else { x.signum() });
    a.steps().map(along) == b.steps().map(along)
}

/// Writes the bytes of all samples, little-endian.
pub(crate) fn write_samples(samples: &Samples, out: &mut dyn Write) -> Result<(), WriteError> {
    fn put<const N: usize, T: Copy>(
        values: &[T],
        bytes: impl Fn(T) -> [u8; N],
        out: &mut dyn Write,
    ) -> Result<(), WriteError> {
        let mut buffer = Vec::with_capacity(N * CHUNK.min(values.len()));
        for chunk in values.chunks(CHUNK) {
            buffer.clear();
            chunk.iter().for_each(|x| buffer.extend_from_slice(&bytes(*x)));
            out.write_all(&buffer)?;
        }
        Ok(())
    }
    match samples {
        Samples::U8(all) => put(all, u8::to_le_bytes, out),
        Samples::I8(all) => put(all, i8::to_le_bytes, out),
        Samples::U16(all) => put(all, u16::to_le_bytes, out),
        Samples::I16(all) => put(all, i16::to_le_bytes, out),
        Samples::U32(all) => put(all, u32::to_le_bytes, out),
        Samples::I32(all) => put(all, i32::to_le_bytes, out),
        Samples::F32(all) => put(all, f32::to_le_bytes, out),
        Samples::F64(all) => put(all, f64::to_le_bytes, out),
        _ => Err(WriteError::Unsupported("samples of that type cannot be written".to_owned())),
    }
}

/// Writes the bytes of all samples of a grid in bricks, row by row; the first index varies fastest.
pub(crate) fn write_bricks(grid: &SparseGrid, out: &mut dyn Write) -> Result<(), WriteError> {
    let [nx, ny, nz] = grid.size();
    let mut row = Vec::with_capacity(8 * nx);
    for k in 0..nz {
        for j in 0..ny {
            row.clear();
            (0..nx).for_each(|i| row.extend_from_slice(&grid.sample([i, j, k]).to_le_bytes()));
            out.write_all(&row)?;
        }
    }
    Ok(())
}

/// The number of samples written at once. Chosen: larger values take more memory.
const CHUNK: usize = 1 << 13;
