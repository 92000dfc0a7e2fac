//! `split_non_manifold`: splits a surface at edges with three faces or more and at positions with several
//! fans.
use super::mend_builder::{AttributeSource, MendBuilder, MendFace, MendRow, check_limits};
use super::mended_mesh::MendedMesh;
use super::radial::{RadialFace, pair_faces};
use crate::Mesh;
use crate::budget::{Job, JobError};
use crate::check::{Finding, Witness};
use crate::explicit::{DisjointSets, Topology, Twin, Twins, next_in_face, previous_in_face};
use std::collections::BTreeMap;

/// Splits the surface where it is not manifold: afterwards no edge has more than two faces, and the faces at
/// each position are one fan.
///
/// - Of the faces along an edge with three or more, two stay together if only the inside is between them, by
///   their exact angles around the edge: two cubes that touch along an edge become two cubes. A face without
///   such a partner gets a boundary there.
/// - Each further fan at a position gets a new position, with new rows for the attributes.
///
/// Nothing moves, so the copies coincide: bound 0. They are separated by [`Mesh::position_id`] or by their
/// rows, so [`Topology::Positions`] ties them again; examine the result with [`Topology::Indices`]. The
/// changes are `split_edges` and `split_vertices`, each new position once.
///
/// Linear, except for a sort of the faces along each such edge.
///
/// # Errors
/// [`JobError`] if the job is cancelled or its memory limit is too low.
///
/// ```
/// use chordal::{Job, Mesh, check, explicit::Topology, mend};
/// let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
/// let hourglass = Mesh::new(corners, vec![[0, 1, 2], [0, 3, 4]])?;
/// let mended = mend::split_non_manifold(&hourglass, Topology::Indices, &Job::default())?;
/// assert_eq!((mended.mesh.faces()[1], mended.count("split_vertices")), ([5, 3, 4], 1));
/// assert!(check::validity(&mended.mesh, Topology::Indices).manifold());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn split_non_manifold(mesh: &Mesh, topology: Topology, job: &Job) -> Result<MendedMesh, JobError> {
    check_limits(mesh, job)?;
    let ids = topology.ids(mesh);
    let id = |row: u32| ids.as_ref().map_or(row, |ids| ids[row as usize]);
    let twins = Twins::with_ids(mesh, ids.as_deref());
    let corner_row = |h: u32| mesh.faces()[h as usize / 3][h as usize % 3];
    let corner_fans = CornerFans { mesh, twins: &twins, id: &|h| id(corner_row(h)) };
    let fans = corner_fans.fans(job)?;

    let mut split_edges = Finding::default();
    twins.non_manifold_edges().for_each(|edge| split_edges.add(|| Witness::edge(mesh, edge)));
    let mut draft = MendBuilder::without_faces(mesh);
    draft.rows.iter_mut().zip(0..).for_each(|(row, i)| row.label = id(i));
    // 1. A label for each fan: the first fan at a position keeps the label of the position.
    let n = mesh.positions().len() as u32;
    let mut label_of_fan = vec![u32::MAX; 3 * mesh.faces().len()];
    let mut is_taken = vec![false; n as usize];
    let mut split_vertices = Finding::default();
    let mut next_label = n;
    // 2. A row for each row and fan: the first fan at a row keeps the row.
    let mut fan_of_row = vec![u32::MAX; n as usize];
    let mut copies: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    for face in 0..mesh.faces().len() as u32 {
        let mut mend_face = MendFace::from_mesh(mesh, face);
        for k in 0..3 {
            let h = 3 * face + k as u32;
            if twins.get(h) == Twin::Collapsed {
                continue;
            }
            let (fan, row) = (fans[h as usize], mend_face.rows[k]);
            let label = &mut label_of_fan[fan as usize];
            if *label == u32::MAX {
                let position = id(row);
                *label = position;
                if std::mem::replace(&mut is_taken[position as usize], true) {
                    *label = next_label;
                    next_label += 1;
                    split_vertices.add(|| Witness::vertex(mesh, row));
                }
            }
            let fan_of_row = &mut fan_of_row[row as usize];
            if *fan_of_row == u32::MAX {
                *fan_of_row = fan;
                draft.rows[row as usize].label = *label;
            } else if *fan_of_row != fan {
                let at = mesh.positions()[row as usize];
                let copy = MendRow { at, label: *label, source: AttributeSource::from_row(row) };
                mend_face.rows[k] = *copies.entry((row, fan)).or_insert_with(|| draft.add_row(copy));
            }
        }
        draft.faces.push(mend_face);
    }
    if split_vertices.is_none() && split_edges.is_none() {
        return Ok(MendedMesh::unchanged(mesh));
    }
    // 3. A face with two corners at one position is in no fan, and keeps the position's label.
    for face in draft.faces.iter_mut().filter(|face| twins.get(3 * face.source) == Twin::Collapsed) {
        for row in &mut face.rows {
            let (label, source) = (id(*row), *row);
            if draft.rows[source as usize].label != label {
                let copy = MendRow { label, ..draft.rows[source as usize] };
                *row = *copies.entry((source, u32::MAX)).or_insert_with(|| {
                    draft.rows.push(copy);
                    draft.rows.len() as u32 - 1
                });
            }
        }
    }
    let changes = [("split_edges", split_edges), ("split_vertices", split_vertices)];
    Ok(MendedMesh::exact(draft.finish()?, changes))
}

/// The data that determine which corners belong together.
struct CornerFans<'a> {
    mesh: &'a Mesh,
    twins: &'a Twins,
    /// The position at which a half-edge starts.
    id: &'a dyn Fn(u32) -> u32,
}

impl CornerFans<'_> {
    /// For every corner, by half-edge number, the first corner of its fan.
    fn fans(&self, job: &Job) -> Result<Vec<u32>, JobError> {
        let non_manifold: Vec<&[u32]> = self.twins.non_manifold_edges().collect();
        let mut partners: Vec<Vec<[u32; 2]>> =
            non_manifold.iter().map(|edge| self.radial_pairs(edge)).collect();
        // This terminates: each round but the last separates the faces of at least one more edge for good.
        loop {
            if job.is_cancelled() {
                return Err(JobError::Cancelled);
            }
            let mut sets = DisjointSets::new(self.twins.len());
            for h in 0..self.twins.len() as u32 {
                match self.twins.get(h) {
                    Twin::Pair(t) | Twin::Flipped(t) if t > h => self.join(&mut sets, h, t),
                    _ => {}
                }
            }
            partners.iter().flatten().for_each(|&[h, t]| self.join(&mut sets, h, t));
            // If a surface passes through both ends of an edge twice, its faces are joined again at the ends.
            // Then separate all of them along that edge, so that at most two of them share a fan at each end.
            let mut is_done = true;
            for (edge, partners) in non_manifold.iter().zip(&mut partners) {
                if !partners.is_empty() && self.is_still_non_manifold(edge, &mut sets) {
                    partners.clear();
                    is_done = false;
                }
            }
            if is_done {
                return Ok((0..self.twins.len() as u32).map(|h| sets.find(h)).collect());
            }
        }
    }

    fn join(&self, sets: &mut DisjointSets, h: u32, t: u32) {
        let (h_end, t_end) = (next_in_face(h), next_in_face(t));
        if (self.id)(h) == (self.id)(t) {
            sets.union(h, t);
            sets.union(h_end, t_end);
        } else {
            sets.union(h, t_end);
            sets.union(h_end, t);
        }
    }

    /// The half-edges of a non-manifold edge that stay together.
    fn radial_pairs(&self, edge: &[u32]) -> Vec<[u32; 2]> {
        let [a, b] = [edge[0], next_in_face(edge[0])];
        let at = |h: u32| self.mesh.corners(h as usize / 3)[h as usize % 3];
        let face = |&h: &u32| RadialFace {
            half_edge: h,
            apex: at(previous_in_face(h)),
            is_up: (self.id)(h) == (self.id)(a),
        };
        let mut faces: Vec<RadialFace> = edge.iter().map(face).collect();
        pair_faces([at(a), at(b)], &mut faces)
    }

    /// Whether three of the half-edges still run between the same two fans.
    fn is_still_non_manifold(&self, edge: &[u32], sets: &mut DisjointSets) -> bool {
        let mut ends: Vec<[u32; 2]> = edge
            .iter()
            .map(|&h| {
                let [a, b] = [h, next_in_face(h)].map(|corner| sets.find(corner));
                if a < b { [a, b] } else { [b, a] }
            })
            .collect();
        ends.sort_unstable();
        ends.windows(3).any(|three| three[0] == three[2])
    }
}
