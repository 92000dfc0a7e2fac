//! `fill_holes`: fills the holes that boundary loops enclose.
use super::cap::{cap, loop_normal};
use super::mend_builder::{AttributeSource, MendBuilder, MendFace, MendRow, check_limits};
use super::mended_mesh::MendedMesh;
use crate::Mesh;
use crate::budget::{Job, JobError, Metric};
use crate::check::{Finding, Witness, boundary_path, has_zero_area};
use crate::explicit::{DisjointSets, Topology, Twin, Twins, face_normal, next_in_face};
use crate::math::{Orientation, dot, orient3d};
use std::collections::BTreeSet;

/// The holes to fill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoleSelection {
    /// All holes. The outer boundary of an open sheet is a hole as well, unless the sheet is flat.
    All,
    /// Holes with at most this many edges.
    UpTo(usize),
}

/// Fills the holes: each boundary loop of consistently wound faces gets faces of the same winding.
///
/// A flat loop is triangulated as a polygon; any other with the least area if it has up to 64 edges, and as a
/// polygon otherwise. If that would give an edge of the mesh a third face, or a face no area, the loop gets a
/// vertex in its middle and a fan around it. A loop that passes a position twice is split there and filled in
/// parts. New faces have the attributes of the face at the first edge of their loop, and their corners have
/// those of the vertices there; no row is changed.
///
/// Not filled: loops with more edges than `holes` says; the outer boundary of a sheet that is exactly flat (as
/// a single triangle is), since the new faces would lie on the sheet; loops on one line; chains of
/// boundary edges that end at an edge with three faces or more, or meet faces of inconsistent winding
/// ([`split_non_manifold`](super::split_non_manifold) and [`orient`](super::orient) repair these first).
///
/// **Bound.** One-sided, from the input to the result: 0, since the whole input surface is kept. The new
/// faces are as far from the input as the hole is wide. That is no error, since there was no surface. If
/// no hole was filled, the bound is 0 in both directions. The changes are `filled_holes`, `added_faces`,
/// `added_vertices`, `left_holes`; a witness is the first edge of a loop. Remaining holes are counted as
/// [`check::validity`](crate::check::validity) counts loops and chains: a loop that visits a position twice
/// counts once, and so does one that changes its winding.
///
/// A new face may cross the surface if a loop winds around it:
/// [`check::self_intersections`](crate::check::self_intersections) finds that.
///
/// Linear in the mesh; n³ for a loop of n ≤ 64 edges, n log n for a longer one.
///
/// # Errors
/// [`JobError`] if the job is cancelled or its memory limit is too low.
///
/// ```
/// use chordal::{Job, Mesh, check, explicit::Topology, mend};
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let open = Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3]])?;
/// let mended = mend::fill_holes(&open, Topology::Indices, mend::HoleSelection::UpTo(3), &Job::default())?;
/// assert_eq!(mended.mesh.faces()[3], [3, 2, 0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fill_holes(
    mesh: &Mesh,
    topology: Topology,
    holes: HoleSelection,
    job: &Job,
) -> Result<MendedMesh, JobError> {
    check_limits(mesh, job)?;
    let ids = topology.ids(mesh);
    let id = |row: u32| ids.as_ref().map_or(row, |ids| ids[row as usize]);
    let twins = Twins::with_ids(mesh, ids.as_deref());
    let rim = MeshBoundary { mesh, twins: &twins, id: &id };
    let (loops, mut unfilled) = rim.loops();
    let sheets = FlatComponents::new(mesh, &twins);
    let most = match holes {
        HoleSelection::All => usize::MAX,
        HoleSelection::UpTo(most) => most,
    };
    // Grows with each filled hole: an edge that one hole has used is not free for the next.
    let mut edges = rim.edges_on_loops(&loops);
    let mut draft = MendBuilder::without_faces(mesh);
    draft.add_all_faces();
    let (n_faces, n_rows) = (draft.faces.len(), draft.rows.len());
    let mut filled = Finding::default();
    let (mut added_faces, mut added_vertices) = (Finding::default(), Finding::default());
    for hole in loops {
        if job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        let first = hole[0];
        if hole.len() > most
            || sheets.has_as_outer_boundary(&hole, mesh)
            || !rim.fill(&hole, &mut edges, &mut draft)
        {
            unfilled.push(first);
            continue;
        }
        filled.add(|| Witness::edge(mesh, &[first]));
    }
    let left_holes = rim.chains_of(&unfilled);
    if filled.is_none() {
        return Ok(MendedMesh::exact(mesh.clone(), [("left_holes", left_holes)]));
    }
    let (new_faces, new_rows) = (n_faces..draft.faces.len(), n_rows..draft.rows.len());
    let filled_mesh = draft.finish()?;
    new_faces.for_each(|face| added_faces.add(|| Witness::face(&filled_mesh, face as u32)));
    new_rows.for_each(|row| added_vertices.add(|| Witness::vertex(&filled_mesh, row as u32)));
    let changes = [
        ("filled_holes", filled),
        ("added_faces", added_faces),
        ("added_vertices", added_vertices),
        ("left_holes", left_holes),
    ];
    let mut mended = MendedMesh::exact(filled_mesh, changes);
    // New faces may be far from the input, as the doc says, so only one direction is bounded.
    mended.bound.metric = Metric::OneSided;
    Ok(mended)
}

/// The flat components of a mesh: faces connected by edges that lie exactly in one plane.
struct FlatComponents {
    /// A representative face of each face's component.
    root: Vec<u32>,
    is_flat: Vec<bool>,
}

impl FlatComponents {
    fn new(mesh: &Mesh, twins: &Twins) -> Self {
        let n = mesh.faces().len();
        let mut pieces = DisjointSets::new(n);
        for h in 0..twins.len() as u32 {
            if let Twin::Pair(t) | Twin::Flipped(t) = twins.get(h) {
                pieces.union(h / 3, t / 3);
            }
        }
        let root: Vec<u32> = (0..n as u32).map(|face| pieces.find(face)).collect();
        let corners = |face: usize| mesh.faces()[face].map(|row| mesh.positions()[row as usize]);
        let (mut plane, mut is_flat) = (vec![None; n], vec![true; n]);
        // The first face with area spans the plane of its piece; faces without area have none.
        for face in (0..n).filter(|face| !has_zero_area(corners(*face))) {
            plane[root[face] as usize].get_or_insert(face);
        }
        for (face, &piece) in root.iter().enumerate() {
            if let Some([a, b, c]) = plane[piece as usize].map(corners) {
                is_flat[piece as usize] &=
                    corners(face).iter().all(|p| orient3d(a, b, c, *p) == Orientation::Flat);
            }
        }
        Self { root, is_flat }
    }

    /// Whether the loop is the outer boundary of a flat component: it runs in the same direction as the
    /// faces, while the loop of a hole runs in the opposite one. Faces that fill an outer boundary would lie
    /// on the component.
    fn has_as_outer_boundary(&self, hole: &[u32], mesh: &Mesh) -> bool {
        let face = hole[0] / 3;
        if !self.is_flat[self.root[face as usize] as usize] {
            return false;
        }
        let at = |h: u32| mesh.positions()[mesh.faces()[h as usize / 3][h as usize % 3] as usize];
        let around: Vec<_> = hole.iter().map(|&h| at(h)).collect();
        let up = face_normal([0, 1, 2].map(|k| at(3 * face + k)));
        // A face without area leaves the direction open; then the loop isn't filled.
        up.is_none_or(|up| dot(up, loop_normal(&around)) > 0.0)
    }
}

/// The boundary of a mesh.
struct MeshBoundary<'a> {
    mesh: &'a Mesh,
    twins: &'a Twins,
    id: &'a dyn Fn(u32) -> u32,
}

impl MeshBoundary<'_> {
    fn row(&self, h: u32) -> u32 {
        self.mesh.faces()[h as usize / 3][h as usize % 3]
    }

    fn origin(&self, h: u32) -> u32 {
        (self.id)(self.row(h))
    }

    /// The boundary half-edge that follows this one, around the fan at its end; `None` if the fan does not
    /// end at the boundary, or if its faces are not consistently wound.
    fn next_boundary(&self, h: u32) -> Option<u32> {
        let mut next = next_in_face(h);
        loop {
            match self.twins.get(next) {
                Twin::Boundary => return Some(next),
                Twin::Pair(t) => next = next_in_face(t),
                Twin::Flipped(_) | Twin::NonManifold | Twin::Collapsed => return None,
            }
        }
    }

    /// Loops of boundary half-edges that pass no position twice, and one half-edge of every chain that is not
    /// a loop.
    fn loops(&self) -> (Vec<Vec<u32>>, Vec<u32>) {
        let (mut loops, mut broken) = (Vec::new(), Vec::new());
        let mut visited = vec![false; self.twins.len()];
        let mut index_in_loop = vec![u32::MAX; self.mesh.positions().len()];
        for start in 0..self.twins.len() as u32 {
            if visited[start as usize] || self.twins.get(start) != Twin::Boundary {
                continue;
            }
            let mut chain = vec![start];
            visited[start as usize] = true;
            let mut next = self.next_boundary(start);
            // A chain that meets a visited half-edge other than its start is no loop, and is
            // reported instead.
            while let Some(h) = next.filter(|&h| !visited[h as usize]) {
                visited[h as usize] = true;
                chain.push(h);
                next = self.next_boundary(h);
            }
            if next == Some(start) {
                self.split_at_repeats(&chain, &mut index_in_loop, &mut loops);
            } else {
                broken.push(start);
            }
        }
        (loops, broken)
    }

    /// The chains that contain at least one of these half-edges, each once.
    fn chains_of(&self, half_edges: &[u32]) -> Finding {
        let mut chains = Finding::default();
        let mut visited = vec![false; if half_edges.is_empty() { 0 } else { self.twins.len() }];
        for &h in half_edges {
            if !visited[h as usize] {
                chains.add(|| Witness::edge(self.mesh, &[h]));
                boundary_path(self.twins, h).into_iter().for_each(|h| visited[h as usize] = true);
            }
        }
        chains
    }

    /// Splits a loop at the positions to which it returns. `index_in_loop` is all `u32::MAX` before and
    /// after.
    fn split_at_repeats(&self, chain: &[u32], index_in_loop: &mut [u32], loops: &mut Vec<Vec<u32>>) {
        // A loop a b c d b e: at the second b, the part b c d becomes a loop of its own, and a b e
        // goes on.
        let mut open: Vec<u32> = Vec::new();
        for &h in chain {
            let position = self.origin(h);
            let before = index_in_loop[position as usize];
            if before != u32::MAX {
                let part = open.split_off(before as usize);
                part.iter().for_each(|&h| index_in_loop[self.origin(h) as usize] = u32::MAX);
                loops.push(part);
            }
            index_in_loop[position as usize] = open.len() as u32;
            open.push(h);
        }
        open.iter().for_each(|&h| index_in_loop[self.origin(h) as usize] = u32::MAX);
        loops.push(open);
    }

    /// All edges with both ends on a loop.
    fn edges_on_loops(&self, loops: &[Vec<u32>]) -> BTreeSet<[u32; 2]> {
        let mut on_loop = vec![false; self.mesh.positions().len()];
        loops.iter().flatten().for_each(|&h| on_loop[self.origin(h) as usize] = true);
        let mut edges = BTreeSet::new();
        for face in self.mesh.faces() {
            let [a, b, c] = face.map(self.id);
            for [a, b] in [[a, b], [b, c], [c, a]] {
                if on_loop[a as usize] && on_loop[b as usize] {
                    edges.insert(if a < b { [a, b] } else { [b, a] });
                }
            }
        }
        edges
    }

    /// Adds the faces of one hole and records their edges; `false` if it cannot be filled.
    fn fill(&self, hole: &[u32], edges: &mut BTreeSet<[u32; 2]>, draft: &mut MendBuilder) -> bool {
        if hole.len() < 3 {
            return false;
        }
        // In reverse order, since the new faces run against the edges of the faces around the hole.
        let around: Vec<u32> = hole.iter().rev().copied().collect();
        let ids: Vec<u32> = around.iter().map(|&h| self.origin(h)).collect();
        let points: Vec<[f64; 3]> =
            around.iter().map(|&h| self.mesh.positions()[self.row(h) as usize]).collect();
        let edge = |i: usize, j: usize| if ids[i] < ids[j] { [ids[i], ids[j]] } else { [ids[j], ids[i]] };
        let source = hole[0] / 3;
        let corner = |i: usize| (self.row(around[i]), AttributeSource::from_row(around[i]));
        let mut push = |corners: [(u32, AttributeSource); 3]| {
            let (rows, corners) = (corners.map(|c| c.0), corners.map(|c| c.1));
            draft.faces.push(MendFace { rows, source, corners });
        };
        if let Some(triangles) = cap(&points, &|i, j| !edges.contains(&edge(i, j))) {
            for t in triangles {
                push(t.map(corner));
                edges.extend([edge(t[0], t[1]), edge(t[1], t[2]), edge(t[2], t[0])]);
            }
            return true;
        }
        let n = points.len() as f64;
        // Divided before the sum, which may overflow.
        let at = std::array::from_fn(|k| points.iter().map(|p| p[k] / n).sum());
        let last = points[points.len() - 1];
        let sides = std::iter::once(&last).chain(&points).zip(&points);
        if sides.into_iter().any(|(p, q)| has_zero_area([*p, *q, at])) {
            return false;
        }
        let number = draft.rows.len() as u32;
        let middle = (number, corner(0).1);
        for i in 0..points.len() {
            let (rows, corners): (Vec<u32>, Vec<AttributeSource>) =
                [corner(i), corner((i + 1) % points.len()), middle].into_iter().unzip();
            draft.faces.push(MendFace {
                rows: [rows[0], rows[1], rows[2]],
                source,
                corners: [corners[0], corners[1], corners[2]],
            });
        }
        // Labels are numbers of rows, so that of the new row ties it to no other.
        draft.add_row(MendRow { at, label: number, source: AttributeSource::from_row(self.row(around[0])) });
        true
    }
}
