//! `FaceCutter`: inserts vertices into the edges of faces: the face is cut, and its neighbours are left
//! unchanged.
use super::mend_builder::{AttributeSource, MendBuilder, MendFace, MendRow};
use crate::Mesh;
use crate::check::has_zero_area;
use crate::explicit::Domain;
use crate::math::lesser;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// A vertex that becomes a corner in the middle of a half-edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct VertexInsertion {
    pub half_edge: u32,
    pub row: u32,
}

/// Decides which insertions a face can take, and builds the faces into which it is cut.
pub(super) struct FaceCutter<'a> {
    mesh: &'a Mesh,
    id: &'a dyn Fn(u32) -> u32,
    /// The number of faces at each edge between two positions, for edges with an end that is inserted
    /// somewhere.
    edges: BTreeMap<[u32; 2], u32>,
    has_vertex_streams: bool,
    /// New rows of vertices between two others.
    new_rows: BTreeMap<(u32, [u32; 2]), u32>,
}

impl<'a> FaceCutter<'a> {
    /// For these insertions, into a mesh without the faces for which `is_left_out` is true.
    pub fn new(
        mesh: &'a Mesh,
        id: &'a dyn Fn(u32) -> u32,
        insertions: &[VertexInsertion],
        is_left_out: impl Fn(u32) -> bool,
    ) -> Self {
        let inserted: BTreeSet<u32> = insertions.iter().map(|insertion| id(insertion.row)).collect();
        let mut edges = BTreeMap::new();
        for (_, face) in (0..).zip(mesh.faces()).filter(|(face, _)| !is_left_out(*face)) {
            let [a, b, c] = face.map(id);
            for edge in [[a, b], [b, c], [c, a]] {
                // Every new edge ends at an inserted vertex, so no other edge can get a third face.
                if edge.iter().any(|end| inserted.contains(end)) {
                    *edges.entry(sorted(edge)).or_insert(0) += 1;
                }
            }
        }
        let has_vertex_streams = mesh.attributes().iter().any(|stream| stream.domain == Domain::Vertex);
        Self { mesh, id, edges, has_vertex_streams, new_rows: BTreeMap::new() }
    }

    /// Cuts one face at these insertions, which are all different. Returns `false` and keeps the face if an
    /// edge would get a third face, or have two equal ends, or if a face with area would give one without.
    pub fn cut(&mut self, face: u32, insertions: &[VertexInsertion], draft: &mut MendBuilder) -> bool {
        let corners = self.mesh.faces()[face as usize];
        // 1. The vertices along each side, from its start to its end, with their parameters on it.
        let mut sides: [Vec<(f64, u32)>; 3] = Default::default();
        for insertion in insertions {
            let k = insertion.half_edge as usize % 3;
            let ends = [corners[k], corners[(k + 1) % 3]];
            sides[k].push((self.parameter_on_edge(insertion.row, ends), insertion.row));
        }
        // Different vertices may have the same rounded parameter.
        sides.iter_mut().for_each(|side| side.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))));
        // 2. The polygon: corners and the vertices between them, as old rows.
        let mut polygon: Vec<CutCorner> = Vec::new();
        for k in 0..3 {
            polygon.push(CutCorner { row: corners[k], side: k, t: 0.0 });
            polygon.extend(sides[k].iter().map(|&(t, row)| CutCorner { row, side: k, t }));
        }
        let triangles = triangulate([sides[0].len(), sides[1].len(), sides[2].len()]);
        let has_area =
            |corners: [u32; 3]| !has_zero_area(corners.map(|row| self.mesh.positions()[row as usize]));
        let keeps_area = !has_area(corners) || triangles.iter().all(|t| has_area(t.map(|i| polygon[i].row)));
        if !(keeps_area && self.keeps_manifold(&polygon, &triangles)) {
            draft.faces.push(MendFace::from_mesh(self.mesh, face));
            return false;
        }
        // 3. The faces.
        let rows: Vec<u32> = polygon.iter().map(|corner| self.corner_row(corner, corners, draft)).collect();
        let source_of = |corner: &CutCorner| {
            let ends = [corner.side, (corner.side + 1) % 3].map(|k| 3 * face + k as u32);
            if corner.t == 0.0 {
                AttributeSource::from_row(ends[0])
            } else {
                AttributeSource::between(ends, corner.t)
            }
        };
        for triangle in &triangles {
            draft.faces.push(MendFace {
                rows: triangle.map(|i| rows[i]),
                source: face,
                corners: triangle.map(|i| source_of(&polygon[i])),
            });
        }
        true
    }

    /// The parameter of a vertex between two rows, from 0 to 1.
    fn parameter_on_edge(&self, row: u32, ends: [u32; 2]) -> f64 {
        let at = |row: u32| DVec3::from(self.mesh.positions()[row as usize]);
        let [a, b] = ends.map(at);
        let along = b - a;
        // Scaled, so that squares stay in the range of f64; the factor cancels in t.
        let size = along.abs().max_element();
        let (along, from_a) = (along / size, (at(row) - a) / size);
        let t = from_a.dot(along) / along.dot(along);
        // Strictly inside, since parameter 0 stands for a corner of the face; only rounding can move it to an end.
        if t > f64::MIN_POSITIVE { lesser(t, 1.0) } else { f64::MIN_POSITIVE }
    }

    /// Whether no edge gets a third face. If so, counts the edges of the new faces.
    fn keeps_manifold(&mut self, around: &[CutCorner], triangles: &[[usize; 3]]) -> bool {
        let ids: Vec<u32> = around.iter().map(|corner| (self.id)(corner.row)).collect();
        if (0..ids.len()).any(|i| ids[..i].contains(&ids[i])) {
            return false;
        }
        let n = around.len();
        // The existing sides are already counted; an edge inside belongs to two of the new faces.
        // Only corners have t = 0, so a side of the polygon between two of them is an uncut side of
        // the face.
        let was_there = |i: usize, j: usize| around[i].t == 0.0 && around[j].t == 0.0;
        let mut added: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        for triangle in triangles {
            for k in 0..3 {
                let (i, j) = (triangle[k], triangle[(k + 1) % 3]);
                let is_side = (i + 1) % n == j || (j + 1) % n == i;
                if !(is_side && was_there(i, j)) {
                    *added.entry(sorted([ids[i], ids[j]])).or_insert(0) += 1;
                }
            }
        }
        if added.iter().any(|(edge, n)| self.edges.get(edge).unwrap_or(&0) + n > 2) {
            return false;
        }
        for (edge, n) in added {
            *self.edges.entry(edge).or_insert(0) += n;
        }
        true
    }

    /// The row of a polygon corner: the old row if rows carry no attributes, otherwise a new one with the
    /// attributes of the side at that point.
    fn corner_row(&mut self, corner: &CutCorner, corners: [u32; 3], draft: &mut MendBuilder) -> u32 {
        if corner.t == 0.0 || !self.has_vertex_streams {
            return corner.row;
        }
        let ends = [corners[corner.side], corners[(corner.side + 1) % 3]];
        let source = AttributeSource::between(ends, corner.t);
        let MendRow { at, label, .. } = draft.rows[corner.row as usize];
        *self
            .new_rows
            .entry((corner.row, ends))
            .or_insert_with(|| draft.add_row(MendRow { at, label, source }))
    }
}

/// A corner of the polygon: an old row, its side, and its parameter on the side; 0 at the side's start.
struct CutCorner {
    row: u32,
    side: usize,
    t: f64,
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    if a < b { [a, b] } else { [b, a] }
}

/// Triangulates a triangle with these numbers of vertices inside its sides, so that no triangle lies along a
/// side; gives the indices of the corners in boundary order.
fn triangulate(inside: [usize; 3]) -> Vec<[usize; 3]> {
    let n = 3 + inside.iter().sum::<usize>();
    // The first side with inner vertices, and the corners of the polygon from there on: a … b … c … .
    let Some(first) = (0..3).find(|&k| inside[k] > 0) else { return vec![[0, 1, 2]] };
    let start = first + inside[..first].iter().sum::<usize>();
    let on = |k: usize| inside[(first + k) % 3];
    let at = |i: usize| (start + i) % n;
    let b = on(0) + 1;
    let c = b + on(1) + 1;
    //              c
    //            / | \ \
    //      3.   /  |  \  \   2.       1. fans around c over the vertices of the first side
    //          /   | 1. \  \          2. from its last vertex to the second side, b … c
    //         a ─ 1 ─ … ─ on(0) ─ b   3. from its first vertex to the third side, c … a
    //
    // No triangle has all its corners on one side, so none is without area.
    let mut triangles = Vec::with_capacity(n - 2);
    // 1. From the segments between the vertices inside the first side to the corner across.
    triangles.extend((1..on(0)).map(|i| [at(i), at(i + 1), at(c)]));
    // 2. From the last of these vertices to the second side, and from the first of them to the third.
    triangles.extend((b..c).map(|i| [at(on(0)), at(i), at(i + 1)]));
    triangles.extend((c..n).map(|i| [at(1), at(i), at(i + 1)]));
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_triangle_is_a_disc_without_triangles_along_its_sides() {
        for inside in (0..64).map(|code| [code % 4, code / 4 % 4, code / 16]) {
            let n = 3 + inside.iter().sum::<usize>();
            let triangles = triangulate(inside);
            assert_eq!(triangles.len(), n - 2, "{inside:?}");
            let mut edges: Vec<(usize, usize)> =
                triangles.iter().flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]).collect();
            let all = edges.clone();
            edges.retain(|&(i, j)| !all.contains(&(j, i)));
            edges.sort_unstable();
            let around: Vec<_> = (0..n).map(|i| (i, (i + 1) % n)).collect();
            assert_eq!(edges, around, "{inside:?}");
            let mut side = Vec::new();
            for (k, count) in inside.into_iter().enumerate() {
                side.extend(vec![1 << k; count + 1]);
            }
            // The sides that a vertex lies on, as bits: a corner lies on two.
            let corner = |i: usize| if i == 0 || side[i] != side[i - 1] { side[(i + n - 1) % n] } else { 0 };
            let on = |i: usize| side[i] | corner(i);
            assert!(
                triangles.iter().all(|t| on(t[0]) & on(t[1]) & on(t[2]) == 0),
                "{inside:?}: {triangles:?}"
            );
        }
    }
}
