//! `with_faces_split`: splits some faces of a mesh, and their neighbours as far as needed.
use crate::explicit::{InvalidMesh, Mesh};
use crate::math::{difference, dot};
use std::collections::BTreeMap;

/// The mesh with a vertex in the middle of the longest side of each of these faces. All faces at such a side are split at
/// the vertex, so that there are no T-junctions. The result has positions and faces only.
pub(super) fn with_faces_split(mesh: &Mesh, faces: &[u32]) -> Result<Mesh, InvalidMesh> {
    let mut positions = mesh.positions().to_vec();
    let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    let sides = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)]);
    for face in faces {
        let length_sq = |[a, b]: [u32; 2]| {
            let vector = difference(mesh.positions()[b as usize], mesh.positions()[a as usize]);
            dot(vector, vector)
        };
        let face_sides = sides(mesh.faces()[*face as usize]);
        let longest = face_sides
            .into_iter()
            .reduce(|best, side| if length_sq(side) > length_sq(best) { side } else { best });
        let Some([a, b]) = longest else { continue };
        middles.entry([a, b]).or_insert_with(|| {
            let (p, q) = (positions[a as usize], positions[b as usize]);
            positions.push(std::array::from_fn(|k| 0.5 * p[k] + 0.5 * q[k]));
            positions.len() as u32 - 1
        });
    }
    let mut cut = Vec::with_capacity(mesh.faces().len() + 2 * middles.len());
    for face in mesh.faces() {
        let [a, b, c] = *face;
        match sides(*face).map(|side| middles.get(&side).copied()) {
            [None, None, None] => cut.push(*face),
            [Some(m), None, None] => cut.extend([[a, m, c], [m, b, c]]),
            [None, Some(m), None] => cut.extend([[b, m, a], [m, c, a]]),
            [None, None, Some(m)] => cut.extend([[c, m, b], [m, a, b]]),
            // Of two middles, the corner between them is cut off, and the rest is halved.
            [Some(m), Some(n), None] => cut.extend([[m, b, n], [a, m, n], [a, n, c]]),
            [None, Some(m), Some(n)] => cut.extend([[m, c, n], [b, m, n], [b, n, a]]),
            [Some(n), None, Some(m)] => cut.extend([[m, a, n], [c, m, n], [c, n, b]]),
            [Some(m), Some(n), Some(o)] => cut.extend([[a, m, o], [m, b, n], [n, c, o], [m, n, o]]),
        }
    }
    Mesh::new(positions, cut)
}
