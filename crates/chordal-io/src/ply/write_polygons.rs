//! Writes polygons as PLY.
use super::CERTIFICATE;
use crate::certificate::write_comments;
use crate::{Polygons, WriteError};
use serde_json::Value;
use std::io::{BufWriter, Write};

/// Writes the vertices and polygons of a cage as binary little-endian PLY: positions as doubles, indices as
/// 32-bit.
///
/// PLY has no subdivision tags; [`crate::losses_of_polygons`] lists the losses. The certificate is in
/// comments.
///
/// # Errors
/// [`WriteError`] if the sink fails, or the certificate is too long.
///
/// ```
/// use chordal::explicit::Cage;
/// use chordal_io::{Frame, Polygons, ply};
/// let square = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let cage = Cage::new(square, [[0, 1, 2, 3]])?;
/// let mut file = Vec::new();
/// ply::write_polygons(&Polygons::from_cage(cage, Frame::default()), None, &mut file)?;
/// assert!(file.ends_with(&[4, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_polygons(
    polygons: &Polygons,
    certificate: Option<&Value>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let cage = &polygons.cage;
    let mut out = BufWriter::new(out);
    writeln!(out, "ply\nformat binary_little_endian 1.0")?;
    write_comments(CERTIFICATE, certificate, &mut out)?;
    writeln!(out, "element vertex {}", cage.positions().len())?;
    ["x", "y", "z"].iter().try_for_each(|name| writeln!(out, "property double {name}"))?;
    let most = cage.faces().map(<[u32]>::len).max().unwrap_or(0);
    let is_short = most <= usize::from(u8::MAX);
    let count = if is_short { "uchar" } else { "uint" };
    writeln!(out, "element face {}\nproperty list {count} uint vertex_indices\nend_header", cage.n_faces())?;
    for x in cage.positions().as_flattened() {
        out.write_all(&x.to_le_bytes())?;
    }
    for face in cage.faces() {
        let n = (face.len() as u32).to_le_bytes();
        out.write_all(if is_short { &n[..1] } else { &n })?;
        face.iter().try_for_each(|vertex| out.write_all(&vertex.to_le_bytes()))?;
    }
    out.flush()?;
    Ok(())
}
