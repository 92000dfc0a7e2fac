//! `drop_degenerate`: drops faces without area, so that closed surfaces stay closed.
use super::cut_faces::{FaceCutter, VertexInsertion};
use super::mend_builder::{MendBuilder, MendFace, check_limits};
use super::mended_mesh::MendedMesh;
use crate::Mesh;
use crate::budget::{Bound, Evidence, Job, JobError, Reference, Tolerance};
use crate::check::{Finding, Goal, Witness, deviation, has_zero_area};
use crate::explicit::{Topology, Twin, Twins, previous_in_face};
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// The most passes over the faces: a row of faces without area, each on the longest edge of the
/// next, is removed from its end.
const ROUNDS: usize = 64;

/// The fraction of the diagonal up to which distances from the remaining surface are not resolved. Chosen:
/// less would take time to resolve the rounding of proofs.
const CLOSE: f64 = 1024.0 * f64::EPSILON;

/// Drops every face whose corners lie exactly on one line.
///
/// - A face with two corners at one position is simply dropped; its neighbours already share an edge.
/// - Of any other face the middle corner lies inside its longest edge. It becomes a corner of the faces
///   across that edge, which are cut there: so the face is dropped, and no crack opens. If an edge would
///   get a third face by that, or if the middle corner has the coordinates of an end without being the same
///   position (weld first), the face stays and is reported.
///
/// Attributes of new corners are as for [`resolve_t_junctions`](super::resolve_t_junctions). The changes are
/// `dropped_faces` and `left_faces`.
///
/// **Bound.** 0 as long as each segment that such a face covered is still covered by edges of other faces.
/// For a segment that nothing else covers, its distance from the remaining surface; if nothing remains, there
/// is no bound.
///
/// O(n log n).
///
/// # Errors
/// [`JobError`] if the job is cancelled or its memory limit is too low.
///
/// ```
/// use chordal::{Job, Mesh, check, explicit::Topology, mend};
/// let corners = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 2.0, 0.0], [1.0, 0.0, 0.0], [1.0, -2.0, 0.0]];
/// // The second face has no area: its third corner lies on its first edge.
/// let mesh = Mesh::new(corners, vec![[0, 1, 2], [1, 0, 3], [0, 4, 3], [3, 4, 1]])?;
/// let mended = mend::drop_degenerate(&mesh, Topology::Indices, &Job::default())?;
/// assert_eq!(mended.mesh.faces(), [[3, 1, 2], [3, 2, 0], [0, 4, 3], [3, 4, 1]]);
/// assert_eq!(mended.bound.at_most(), Some(0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn drop_degenerate(mesh: &Mesh, topology: Topology, job: &Job) -> Result<MendedMesh, JobError> {
    check_limits(mesh, job)?;
    let mut dropped = Finding::default();
    for face in (0..mesh.faces().len() as u32).filter(|&face| has_zero_area(mesh.corners(face as usize))) {
        dropped.add(|| Witness::face(mesh, face));
    }
    if dropped.is_none() {
        return Ok(MendedMesh::unchanged(mesh));
    }
    let mut mended = None;
    for _ in 0..ROUNDS {
        if job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        let Some(next) = drop_pass(mended.as_ref().unwrap_or(mesh), topology)? else { break };
        mended = Some(next);
    }
    let mended = mended.unwrap_or_else(|| mesh.clone());
    let mut left_faces = Finding::default();
    for face in (0..mended.faces().len() as u32).filter(|&face| has_zero_area(mended.corners(face as usize)))
    {
        left_faces.add(|| Witness::face(&mended, face));
    }
    // No pass creates more faces without area than it drops.
    dropped.count = dropped.count.saturating_sub(left_faces.count);
    let bound = coverage_bound(mesh, &mended, job)?;
    let changes = [("dropped_faces", dropped), ("left_faces", left_faces)];
    Ok(MendedMesh { bound, ..MendedMesh::exact(mended, changes) })
}

/// One pass: the mesh without the faces that can be dropped at once; `None` if there are none.
fn drop_pass(mesh: &Mesh, topology: Topology) -> Result<Option<Mesh>, JobError> {
    let ids = topology.ids(mesh);
    let id = |row: u32| ids.as_ref().map_or(row, |ids| ids[row as usize]);
    let twins = Twins::with_ids(mesh, ids.as_deref());
    let n_faces = mesh.faces().len() as u32;
    let is_flat: Vec<bool> = (0..n_faces).map(|face| has_zero_area(mesh.corners(face as usize))).collect();
    let longest: Vec<Option<u32>> = (0..n_faces)
        .map(|face| if is_flat[face as usize] { longest_edge(mesh, face) } else { None })
        .collect();
    // 1. The dropped faces, and the vertex that each inserts across its longest edge.
    let mut insertions: Vec<VertexInsertion> = Vec::new();
    let mut goes = vec![false; mesh.faces().len()];
    for face in (0..n_faces).filter(|&face| is_flat[face as usize]) {
        // All half-edges of a face with two equal corners are marked alike.
        goes[face as usize] = twins.get(3 * face) == Twin::Collapsed;
        let (false, Some(h)) = (goes[face as usize], longest[face as usize]) else { continue };
        match twins.get(h) {
            // Nothing lies across that would have to be cut.
            Twin::Boundary => goes[face as usize] = true,
            Twin::Pair(t) | Twin::Flipped(t) => {
                // If two faces are on each other's longest edge, the first is dropped before the second.
                let is_mutual = longest[t as usize / 3] == Some(t) && face < t / 3;
                if !is_flat[t as usize / 3] || is_mutual {
                    goes[face as usize] = true;
                    insertions.push(VertexInsertion { half_edge: t, row: opposite_row(mesh, h) });
                }
            }
            // Several faces lie across, and cutting one of them would open a crack to the others.
            Twin::NonManifold | Twin::Collapsed => {}
        }
    }
    insertions.sort_unstable_by_key(|insertion| (insertion.half_edge, insertion.row));
    // 2. The faces across are cut; if one cannot be cut, the faces whose vertices it needed stay.
    let mut draft = MendBuilder::without_faces(mesh);
    let mut cutter = FaceCutter::new(mesh, &id, &insertions, |face| goes[face as usize]);
    let mut cut: BTreeMap<u32, Vec<MendFace>> = BTreeMap::new();
    for insertions_of_face in insertions.chunk_by(|a, b| a.half_edge / 3 == b.half_edge / 3) {
        let face = insertions_of_face[0].half_edge / 3;
        if cutter.cut(face, insertions_of_face, &mut draft) {
            cut.insert(face, std::mem::take(&mut draft.faces));
            continue;
        }
        // The cutter gave the face back uncut; step 3 adds it at its place.
        draft.faces.clear();
        for insertion in insertions_of_face {
            if let Twin::Pair(dropped_face) | Twin::Flipped(dropped_face) = twins.get(insertion.half_edge) {
                goes[dropped_face as usize / 3] = false;
            }
        }
    }
    if !goes.contains(&true) {
        return Ok(None);
    }
    // 3. All remaining faces in their order.
    for face in (0..n_faces).filter(|&face| !goes[face as usize]) {
        match cut.remove(&face) {
            Some(faces) => draft.faces.extend(faces),
            None => draft.faces.push(MendFace::from_mesh(mesh, face)),
        }
    }
    draft.finish().map(Some)
}

/// The half-edge opposite the middle corner of a face without area; `None` if that corner is at an end.
fn longest_edge(mesh: &Mesh, face: u32) -> Option<u32> {
    longest_side(mesh.corners(face as usize)).map(|side| 3 * face + side as u32)
}

/// The side opposite the middle one of three collinear corners, from corner k to corner k + 1; `None` if
/// that corner is at an end.
fn longest_side(corners: [[f64; 3]; 3]) -> Option<usize> {
    // On one line, the order of coordinates is the order along it, or its reverse.
    let order = |p: [f64; 3], q: [f64; 3]| p.partial_cmp(&q).unwrap_or(Ordering::Equal);
    let is_middle = |k: &usize| {
        let sides = [(k + 1) % 3, (k + 2) % 3].map(|other| order(corners[*k], corners[other]));
        sides[0] != Ordering::Equal && sides[0] == sides[1].reverse()
    };
    (0..3).find(is_middle).map(|middle| (middle + 1) % 3)
}

/// The row opposite a half-edge in its face.
fn opposite_row(mesh: &Mesh, half_edge: u32) -> u32 {
    let h = previous_in_face(half_edge);
    mesh.faces()[h as usize / 3][h as usize % 3]
}

/// The bits of a point, for finding equal coordinates.
type PointBits = [u64; 3];

fn point_bits(p: [f64; 3]) -> PointBits {
    p.map(|x| (x + 0.0).to_bits())
}

/// The distance from the points that the flat faces of `mesh` covered to the remaining surface. Faces that
/// were cut still cover the same points.
pub(super) fn coverage_bound(mesh: &Mesh, remaining: &Mesh, job: &Job) -> Result<Bound, JobError> {
    let flat = || {
        let corners = (0..mesh.faces().len()).map(|face| mesh.corners(face));
        corners.filter(|corners| has_zero_area(*corners))
    };
    // Only segments between corners of faces without area have to be found again, so the set stays
    // small.
    let ends: BTreeSet<PointBits> = flat().flatten().map(point_bits).collect();
    let mut edges: BTreeSet<[PointBits; 2]> = BTreeSet::new();
    for face in 0..remaining.faces().len() {
        let corners = remaining.corners(face).map(point_bits);
        for [p, q] in [[0, 1], [1, 2], [2, 0], [0, 0]].map(|edge| edge.map(|k| corners[k])) {
            if ends.contains(&p) && ends.contains(&q) {
                edges.extend([[p, q], [q, p], [p, p], [q, q]]);
            } else {
                edges.extend([p, q].into_iter().filter(|end| ends.contains(end)).map(|end| [end; 2]));
            }
        }
    }
    let is_covered = |corners: [[f64; 3]; 3]| {
        let [a, b, c] = corners.map(point_bits);
        let sides = [[a, b], [b, c], [c, a]].map(|edge| edges.contains(&edge));
        // The longest side covers the whole face, and so do the two others together. Rounded lengths cannot
        // tell which it is. If no corner is between the others, some are equal, and a side between two
        // different corners is as long as any.
        let has_length = |k: &usize| corners[*k] != corners[(*k + 1) % 3];
        let longest = longest_side(corners).or_else(|| (0..3).find(has_length)).unwrap_or(0);
        sides[longest] || (sides[(longest + 1) % 3] && sides[(longest + 2) % 3])
    };
    let bare: Vec<[[f64; 3]; 3]> = flat().filter(|corners| !is_covered(*corners)).collect();
    if bare.is_empty() {
        return Ok(Bound::exact(Reference::InputTriangles));
    }
    if remaining.faces().is_empty() {
        return Ok(Bound::with_evidence(0.0, None, Evidence::Estimated, Reference::InputTriangles));
    }
    // Both meshes share all other faces.
    let (mut positions, mut faces) = (remaining.positions().to_vec(), remaining.faces().to_vec());
    for corners in bare {
        let first = positions.len() as u32;
        positions.extend(corners);
        faces.push([first, first + 1, first + 2]);
    }
    let with_bare = Mesh::by_construction(positions, faces);
    let close = Tolerance::new(CLOSE * mesh.bounds().diagonal()).ok();
    let one_sided =
        deviation(&with_bare, remaining, &Goal { absolute: close, ..Goal::default() }, job)?.forward;
    Ok(Bound::proved(one_sided.at_least, one_sided.at_most, Reference::InputTriangles))
}
