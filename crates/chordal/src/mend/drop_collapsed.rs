//! `drop_collapsed`: drops faces with two equal corners, for formats that forbid them.
use super::drop_degenerate::coverage_bound;
use super::mend_builder::{MendBuilder, MendFace, check_limits};
use super::mended_mesh::MendedMesh;
use crate::Mesh;
use crate::budget::{Job, JobError};
use crate::check::{Finding, Witness};
use crate::explicit::Topology;

/// Drops every face that has two of its corners at one position.
///
/// Its neighbours already share an edge, so no crack opens. Other faces without area stay: they keep closed
/// surfaces closed, and [`drop_degenerate`](super::drop_degenerate) cuts their neighbours. The change is
/// `dropped_faces`.
///
/// **Bound.** 0 as long as the segments that such faces covered are still edges of other faces. For a segment
/// that is not, its distance from the remaining surface; if nothing remains, there is no bound.
///
/// O(n log n).
///
/// # Errors
/// [`JobError`] if the job is cancelled or its memory limit is too low.
///
/// ```
/// use chordal::{Job, Mesh, explicit::Topology, mend};
/// let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(corners, vec![[0, 1, 2], [1, 2, 2]])?;
/// let mended = mend::drop_collapsed(&mesh, Topology::Indices, &Job::default())?;
/// assert_eq!(mended.mesh.faces(), [[0, 1, 2]]);
/// assert_eq!(mended.bound.at_most(), Some(0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn drop_collapsed(mesh: &Mesh, topology: Topology, job: &Job) -> Result<MendedMesh, JobError> {
    check_limits(mesh, job)?;
    let ids = topology.ids(mesh);
    let is_collapsed = |face: u32| {
        let [a, b, c] =
            mesh.faces()[face as usize].map(|row| ids.as_ref().map_or(row, |ids| ids[row as usize]));
        a == b || b == c || c == a
    };
    let mut dropped = Finding::default();
    let n_faces = mesh.faces().len() as u32;
    for face in (0..n_faces).filter(|face| is_collapsed(*face)) {
        dropped.add(|| Witness::face(mesh, face));
    }
    if dropped.is_none() {
        return Ok(MendedMesh::unchanged(mesh));
    }
    let mut draft = MendBuilder::without_faces(mesh);
    draft
        .faces
        .extend((0..n_faces).filter(|face| !is_collapsed(*face)).map(|face| MendFace::from_mesh(mesh, face)));
    let mended = draft.finish()?;
    let bound = coverage_bound(mesh, &mended, job)?;
    Ok(MendedMesh { bound, ..MendedMesh::exact(mended, [("dropped_faces", dropped)]) })
}
