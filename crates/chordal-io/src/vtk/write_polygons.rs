//! Writes polygons as PolyData.
use super::vtp_layout::{VtpArray, VtpLayout, VtpSection, index_type, put_index};
use crate::{Polygons, WriteError};
use serde_json::Value;
use std::io::{BufWriter, Write};

/// Writes the vertices and polygons of a cage as VTK PolyData, as [`super::write`] does triangles.
///
/// VTK has no subdivision tags; [`crate::losses_of_polygons`] lists the losses.
///
/// # Errors
/// [`WriteError`] if the sink fails, or the certificate is too long.
///
/// ```
/// use chordal::explicit::Cage;
/// use chordal_io::{Frame, Polygons, vtk};
/// let square = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let cage = Cage::new(square, [[0, 1, 2, 3]])?;
/// let mut file = Vec::new();
/// vtk::write_polygons(&Polygons::from_cage(cage, Frame::default()), None, &mut file)?;
/// assert!(String::from_utf8_lossy(&file).contains("NumberOfPolys=\"1\""));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_polygons(
    polygons: &Polygons,
    certificate: Option<&Value>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let cage = &polygons.cage;
    let certificate = certificate.map(crate::certificate::text).transpose()?;
    let (n_points, n_polys) = (cage.positions().len() as u64, cage.n_faces() as u64);
    let n_corners: u64 = cage.faces().map(|face| face.len() as u64).sum();
    // One type for both lists: indices are below the number of points, ends reach that of corners.
    let index = index_type(if n_points > n_corners { n_points } else { n_corners });
    let index_bytes = if index == "Int32" { 4 } else { 8 };
    let array = |section, name: &str, kind, n_bytes| VtpArray {
        section,
        name: name.to_owned(),
        kind,
        width: if section == VtpSection::Points { 3 } else { 1 },
        n_bytes,
    };
    let arrays = vec![
        array(VtpSection::Points, "Points", "Float64", n_points * 24),
        array(VtpSection::Polys, "connectivity", index, n_corners * index_bytes),
        array(VtpSection::Polys, "offsets", index, n_polys * index_bytes),
    ];
    let layout = VtpLayout { n_points, n_polys, arrays, active: String::new(), certificate };
    let mut out = BufWriter::new(out);
    layout.write_head(&mut out)?;
    // Each appended array begins with its length in bytes.
    out.write_all(&layout.arrays[0].n_bytes.to_le_bytes())?;
    for x in cage.positions().as_flattened() {
        out.write_all(&x.to_le_bytes())?;
    }
    let mut row = Vec::new();
    let mut put = |list: &mut dyn Iterator<Item = u64>, n_bytes: u64| -> Result<(), WriteError> {
        out.write_all(&n_bytes.to_le_bytes())?;
        for value in list {
            row.clear();
            put_index(&mut row, index, value);
            out.write_all(&row)?;
        }
        Ok(())
    };
    put(&mut cage.faces().flatten().map(|corner| u64::from(*corner)), layout.arrays[1].n_bytes)?;
    let mut end = 0;
    let ends = cage.faces().map(|face| {
        end += face.len() as u64;
        end
    });
    put(&mut { ends }, layout.arrays[2].n_bytes)?;
    VtpLayout::write_end(&mut out)
}
