//! The 256 cases of marching cubes, made from one rule for faces.
//!
//! Corners of a cell are numbered by bits (x 1, y 2, z 4), edges 0–3 run along x, 4–7 along y, 8–11 along z,
//! each group in the order of its lower corner. On each face the surface is cut by segments that depend on
//! the four signs of that face alone: **every run of inside corners is cut off by itself**, so two inside
//! corners across a face's diagonal are not joined. Both cells at a face see the same signs, hence the same
//! segments, and each segment ends on two crossed edges. So
//! 1. in a cell each crossed edge belongs to two faces with one segment each: segments form closed loops, and
//!    every crossed edge is in exactly one loop;
//! 2. a loop is filled by triangles whose diagonals join edges without a common face. There are such triangles
//!    for all loops of all cells: a search finds them when the table is made, and would panic otherwise. So a
//!    diagonal lies in the inside of the cell, belongs to one loop, and no other cell has the same edge;
//! 3. hence every edge has two triangles, except segments on faces of only one cell. Around the vertex of a
//!    lattice edge each of its cells adds one fan, from one of its faces to the next: a disc, or a half disc at
//!    the border.
//!
//! So the mesh is a closed manifold up to the border of the lattice, from combinatorics alone, whatever the
//! positions.
use std::sync::LazyLock;

/// The two corners of each edge, the lower one first.
pub(in crate::convert) const EDGES: [[u8; 2]; 12] =
    [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

/// The corners of each face, counter-clockwise as seen from outside of the cell.
const FACES: [[u8; 4]; 6] =
    [[4, 6, 2, 0], [1, 3, 7, 5], [1, 5, 4, 0], [2, 6, 7, 3], [2, 3, 1, 0], [4, 5, 7, 6]];

/// The most triangles in a cell.
pub(in crate::convert) const MOST: usize = 5;

/// The triangles that a cell of certain signs adds to the mesh.
#[derive(Clone, Copy)]
pub(in crate::convert) struct CubeCase {
    /// The number of triangles.
    pub triangles: u8,
    /// Their edges; counter-clockwise seen from outside of the shape, in a space that is not mirrored.
    pub corners: [[u8; 3]; MOST],
    /// For each edge the offset of its vertex from the cell's running counter: the edges along y and z at x + 1
    /// come after those at x, if these are crossed too.
    pub ahead: [u32; 12],
    /// The increments of the running counters after the cell.
    pub grows: [u32; 12],
}

/// All cases by the bits of their inside corners; in `mirrored` every triangle is turned around, for mirrored
/// lattices.
pub(in crate::convert) struct CaseTable {
    pub upright: [CubeCase; 256],
    pub mirrored: [CubeCase; 256],
}

/// The table, built on first use in less than a millisecond.
pub(in crate::convert) static TABLE: LazyLock<CaseTable> = LazyLock::new(|| {
    let upright: [CubeCase; 256] = std::array::from_fn(|signs| case(signs as u8));
    let mut mirrored = upright;
    for case in &mut mirrored {
        case.corners.iter_mut().for_each(|t| t.swap(1, 2));
    }
    CaseTable { upright, mirrored }
});

/// Whether the two ends of an edge are on different sides.
pub(in crate::convert) fn is_crossed(signs: u8, edge: usize) -> bool {
    let [a, b] = EDGES[edge];
    (signs >> a ^ signs >> b) & 1 == 1
}

fn case(signs: u8) -> CubeCase {
    let mut corners = [[0; 3]; MOST];
    let mut triangles = 0;
    for ring in loops(signs) {
        let filled = fill(&ring).expect("every loop of the table has diagonals inside the cell");
        for triangle in filled {
            corners[triangles] = triangle;
            triangles += 1;
        }
    }
    let crossed = |edge: usize| u32::from(is_crossed(signs, edge));
    let mut ahead = [0; 12];
    let mut grows: [u32; 12] = std::array::from_fn(crossed);
    for edge in [4, 6, 8, 10] {
        ahead[edge + 1] = crossed(edge);
        grows[edge + 1] = crossed(edge);
    }
    CubeCase { triangles: triangles as u8, corners, ahead, grows }
}

fn edge_between(a: u8, b: u8) -> u8 {
    let ends = if a < b { [a, b] } else { [b, a] };
    EDGES.iter().position(|edge| *edge == ends).map_or(u8::MAX, |edge| edge as u8)
}

/// The closed loops of crossed edges on the faces of a cell.
fn loops(signs: u8) -> Vec<Vec<u8>> {
    let mut next = [u8::MAX; 12];
    for face in FACES {
        let inside = |i: usize| signs >> face[i % 4] & 1 == 1;
        let edge = |i: usize| edge_between(face[i % 4], face[(i + 1) % 4]);
        // Each run of inside corners gives one segment: from the edge behind its last corner to the edge
        // before its first one.
        for out in (0..4).filter(|&i| inside(i) && !inside(i + 1)) {
            // Back along the run of inside corners to its start.
            let run = (1..4).find(|back| !inside(out + 4 - back)).unwrap_or(1);
            next[usize::from(edge(out))] = edge(out + 4 - run);
        }
    }
    let mut loops = Vec::new();
    let mut seen = [false; 12];
    for start in 0..12_u8 {
        let mut ring = Vec::new();
        let mut at = start;
        while next[usize::from(at)] != u8::MAX && !seen[usize::from(at)] {
            seen[usize::from(at)] = true;
            ring.push(at);
            at = next[usize::from(at)];
        }
        if !ring.is_empty() {
            loops.push(ring);
        }
    }
    loops
}

/// Whether two edges lie on one face.
fn share_a_face(a: u8, b: u8) -> bool {
    FACES.iter().any(|face| {
        let has = |edge: u8| EDGES[usize::from(edge)].iter().all(|corner| face.contains(corner));
        has(a) && has(b)
    })
}

/// Fills a loop with triangles; their diagonals join edges that share no face.
fn fill(ring: &[u8]) -> Option<Vec<[u8; 3]>> {
    if ring.len() < 3 {
        return Some(Vec::new());
    }
    let last = ring.len() - 1;
    (1..last).find_map(|k| {
        let good = |a: usize, b: usize| b - a == 1 || !share_a_face(ring[a], ring[b]);
        if !good(0, k) || !good(k, last) {
            return None;
        }
        let mut triangles = fill(&ring[..=k])?;
        triangles.extend(fill(&ring[k..])?);
        triangles.push([ring[0], ring[last], ring[k]]);
        Some(triangles)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_use_each_crossed_edge_and_only_those() {
        for signs in 0..=255_u8 {
            let case = &TABLE.upright[usize::from(signs)];
            let used: Vec<u8> = case.corners[..usize::from(case.triangles)].concat();
            for edge in 0..12 {
                assert_eq!(used.contains(&(edge as u8)), is_crossed(signs, edge), "{signs} {edge}");
            }
        }
    }

    #[test]
    fn opposite_cells_have_no_fewer_than_one_triangle() {
        assert_eq!(TABLE.upright[0].triangles, 0);
        assert_eq!(TABLE.upright[255].triangles, 0);
        assert!((1..255).all(|signs| TABLE.upright[signs].triangles > 0));
    }
}
