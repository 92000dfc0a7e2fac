//! Writes polygons as OFF.
use super::write::{end_header, put_numbers};
use crate::{Polygons, WriteError};
use serde_json::Value;
use std::io::{BufWriter, Write};

/// Writes the vertices and polygons of a cage as OFF text, with positions as the shortest decimals that read
/// back to the same f64.
///
/// OFF has no subdivision tags; [`crate::losses_of_polygons`] lists the losses. The certificate is in
/// comments.
///
/// # Errors
/// [`WriteError`] if the sink fails, or the certificate is too long.
///
/// ```
/// use chordal::explicit::Cage;
/// use chordal_io::{Frame, Polygons, off};
/// let square = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let cage = Cage::new(square, [[0, 1, 2, 3]])?;
/// let mut file = Vec::new();
/// off::write_polygons(&Polygons::from_cage(cage, Frame::default()), None, &mut file)?;
/// assert_eq!(file, b"OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_polygons(
    polygons: &Polygons,
    certificate: Option<&Value>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let cage = &polygons.cage;
    let mut out = BufWriter::new(out);
    writeln!(out, "OFF")?;
    end_header(certificate, [cage.positions().len() as u64, cage.n_faces() as u64], &mut out)?;
    let mut line = Vec::new();
    for position in cage.positions() {
        line.clear();
        put_numbers(&mut line, position);
        line.push(b'\n');
        out.write_all(line.trim_ascii_start())?;
    }
    for face in cage.faces() {
        write!(out, "{}", face.len())?;
        face.iter().try_for_each(|vertex| write!(out, " {vertex}"))?;
        writeln!(out)?;
    }
    out.flush()?;
    Ok(())
}
