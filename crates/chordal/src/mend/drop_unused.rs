//! `drop_unused`: drops vertices that no face uses.
use super::mend_builder::{MendBuilder, check_limits};
use super::mended_mesh::MendedMesh;
use crate::Mesh;
use crate::budget::{Job, JobError};
use crate::check::{Finding, Witness};

/// Drops every row of the positions that no face uses, and renumbers the others in their order. The surface
/// does not change: bound 0. The change is `dropped_vertices`.
///
/// # Errors
/// [`JobError`] if the job is cancelled or its memory limit is too low.
///
/// ```
/// use chordal::{Job, Mesh, mend};
/// let mesh = Mesh::new(vec![[9.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[1, 2, 3]])?;
/// let mended = mend::drop_unused(&mesh, &Job::default())?;
/// assert_eq!((mended.mesh.faces()[0], mended.count("dropped_vertices")), ([0, 1, 2], 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn drop_unused(mesh: &Mesh, job: &Job) -> Result<MendedMesh, JobError> {
    check_limits(mesh, job)?;
    let mut used = vec![false; mesh.positions().len()];
    mesh.faces().as_flattened().iter().for_each(|&row| used[row as usize] = true);
    let mut dropped = Finding::default();
    for (row, _) in (0..).zip(&used).filter(|(_, used)| !**used) {
        dropped.add(|| Witness::vertex(mesh, row));
    }
    if dropped.is_none() {
        return Ok(MendedMesh::unchanged(mesh));
    }
    Ok(MendedMesh::exact(with_rows(mesh, &used)?, [("dropped_vertices", dropped)]))
}

/// The mesh with only the rows in `keep`, which include all rows that its faces use.
fn with_rows(mesh: &Mesh, keep: &[bool]) -> Result<Mesh, JobError> {
    let mut draft = MendBuilder::without_faces(mesh);
    let mut number = Vec::with_capacity(keep.len());
    let mut next = 0;
    for &keep in keep {
        number.push(next);
        next += u32::from(keep);
    }
    let mut flags = keep.iter();
    draft.rows.retain(|_| flags.next().copied().unwrap_or(false));
    draft.add_all_faces();
    draft.faces.iter_mut().for_each(|face| face.rows = face.rows.map(|row| number[row as usize]));
    draft.finish()
}
