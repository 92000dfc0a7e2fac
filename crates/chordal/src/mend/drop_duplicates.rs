//! `drop_duplicates`: drops faces that have the three positions of an earlier one.
use super::mend_builder::{MendBuilder, MendFace, check_limits};
use super::mended_mesh::MendedMesh;
use crate::Mesh;
use crate::budget::{Job, JobError};
use crate::check::{Finding, Witness};
use crate::explicit::Topology;

/// The repeated faces to drop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Duplicates {
    /// Faces with the same winding as an earlier kept face of the same positions.
    SameWay,
    /// Faces of either winding: of all faces on three positions the first is kept.
    EitherWay,
}

/// Drops every face that has the three positions of an earlier one, as selected by `which`, with its
/// attributes. Faces with two corners at one position are left to
/// [`drop_degenerate`](super::drop_degenerate). The surface does not change: bound 0. The change is
/// `dropped_faces`.
///
/// O(n log n) at worst; about 0.2 s for 1,000,000 triangles.
///
/// # Errors
/// [`JobError`] if the job is cancelled or its memory limit is too low.
///
/// ```
/// use chordal::{Job, Mesh, explicit::Topology, mend};
/// let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(corners, vec![[0, 1, 2], [1, 2, 0], [0, 2, 1]])?;
/// let kept = |which| mend::drop_duplicates(&mesh, Topology::Indices, which, &Job::default());
/// assert_eq!(kept(mend::Duplicates::SameWay)?.mesh.faces(), [[0, 1, 2], [0, 2, 1]]);
/// assert_eq!(kept(mend::Duplicates::EitherWay)?.mesh.faces(), [[0, 1, 2]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn drop_duplicates(
    mesh: &Mesh,
    topology: Topology,
    which: Duplicates,
    job: &Job,
) -> Result<MendedMesh, JobError> {
    check_limits(mesh, job)?;
    let ids = topology.ids(mesh);
    let id = |row: u32| ids.as_ref().map_or(row, |ids| ids[row as usize]);
    let mut keys: Vec<([u32; 3], bool, u32)> = Vec::with_capacity(mesh.faces().len());
    for (face, rows) in (0..).zip(mesh.faces()) {
        // Whether the sorted rows are an odd permutation tells the two windings of a triple apart.
        let (key, is_odd) = sorted(rows.map(id));
        if key[0] != key[1] && key[1] != key[2] {
            keys.push((key, is_odd && which == Duplicates::SameWay, face));
        }
    }
    // The face comes last in the key, so the first of equal ones is the original.
    keys.sort_unstable();
    let mut repeats: Vec<(u32, u32)> = Vec::new();
    for same in keys.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        repeats.extend(same[1..].iter().map(|later| (later.2, same[0].2)));
    }
    repeats.sort_unstable();
    if repeats.is_empty() {
        return Ok(MendedMesh::unchanged(mesh));
    }
    let mut draft = MendBuilder::without_faces(mesh);
    let mut dropped = Finding::default();
    let mut next = repeats.iter().peekable();
    for face in 0..mesh.faces().len() as u32 {
        match next.next_if(|repeat| repeat.0 == face) {
            Some(&(face, original)) => dropped.add(|| Witness::repeated(mesh, face, original)),
            None => draft.faces.push(MendFace::from_mesh(mesh, face)),
        }
    }
    Ok(MendedMesh::exact(draft.finish()?, [("dropped_faces", dropped)]))
}

/// The numbers in ascending order, and whether that is an odd permutation.
fn sorted([mut a, mut b, mut c]: [u32; 3]) -> ([u32; 3], bool) {
    let mut is_odd = false;
    for _ in 0..2 {
        if a > b {
            (a, b, is_odd) = (b, a, !is_odd);
        }
        if b > c {
            (b, c, is_odd) = (c, b, !is_odd);
        }
    }
    ([a, b, c], is_odd)
}
