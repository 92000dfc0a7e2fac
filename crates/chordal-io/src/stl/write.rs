//! Writes binary STL.
use super::binary::{FACET, HEAD};
use crate::instances::part_instances;
use crate::text::grouped;
use crate::{Scene, WriteError};
use chordal::explicit::face_normal;
use serde_json::Value;
use std::io::{BufWriter, Write};

/// Writes a scene as binary STL: every corner as three floats, every facet with the normal of its rounded
/// corners.
///
/// Transforms of nodes are applied, and all parts become one. STL has only 80 free bytes, too few for a
/// certificate, so none is written. [`crate::losses`] lists the other losses.
///
/// # Errors
/// [`WriteError`] if the sink fails, a node is invalid, a coordinate overflows an f32, or there are 2³²
/// facets or more.
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::{Frame, Scene, stl};
/// let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let mut file = Vec::new();
/// stl::write(&Scene::from_triangle_soup("", mesh, Frame::default()), None, &mut file)?;
/// assert_eq!(file.len(), 84 + 50);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(scene: &Scene, certificate: Option<&Value>, out: &mut dyn Write) -> Result<(), WriteError> {
    let _ = certificate;
    let parts = part_instances(scene)?;
    let n_facets: u64 = parts.iter().map(|p| p.part.mesh.faces().len() as u64).sum();
    let count = u32::try_from(n_facets).map_err(|_| {
        let message =
            format!("{} facets are over the limit of STL, {}", grouped(n_facets), grouped(u32::MAX.into()));
        WriteError::Unsupported(message)
    })?;
    let mut out = BufWriter::new(out);
    // It must not start with `solid`, or some readers take the file for text.
    let mut head = [b' '; HEAD];
    head[..19].copy_from_slice(b"binary STL, chordal");
    head[HEAD - 4..].copy_from_slice(&count.to_le_bytes());
    out.write_all(&head)?;
    for part in &parts {
        let order = part.order();
        for face in part.part.mesh.faces() {
            let mut corners = [[0.0; 3]; 3];
            for (slot, corner) in corners.iter_mut().zip(order) {
                *slot = rounded(part.position(face[corner] as usize)?)?;
            }
            let normal = face_normal(corners).unwrap_or_default();
            let mut facet = [0; FACET];
            let numbers = normal.iter().chain(corners.as_flattened());
            for (bytes, x) in facet.as_chunks_mut().0.iter_mut().zip(numbers) {
                *bytes = (*x as f32).to_le_bytes();
            }
            out.write_all(&facet)?;
        }
    }
    out.flush()?;
    Ok(())
}

/// A position rounded to single precision.
fn rounded(position: [f64; 3]) -> Result<[f64; 3], WriteError> {
    let single = |k: usize| f64::from(position[k] as f32);
    let rounded = [single(0), single(1), single(2)];
    match rounded.iter().position(|x| !x.is_finite()) {
        None => Ok(rounded),
        Some(k) => Err(WriteError::Unsupported(format!(
            "coordinate {:e} is over the limit of STL, {:e}",
            position[k],
            f32::MAX
        ))),
    }
}
