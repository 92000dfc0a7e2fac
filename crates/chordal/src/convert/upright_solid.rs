//! The solid between plane triangles and their copies at a height.
use crate::budget::{Failure, RefusalCode};
use crate::explicit::Mesh;

/// Positions and faces.
pub(super) type SolidTriangles = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// The solid over counter-clockwise triangles in the plane z = 0 that meet along whole edges.
///
/// # Errors
/// If it has more vertices than there are indices.
pub(super) fn upright_solid(
    positions: &[[f64; 3]],
    faces: &[[u32; 3]],
    height: f64,
) -> Result<SolidTriangles, Failure<Mesh>> {
    let flat = FanFaces::new(faces);
    let n_bottom = flat.origins.len();
    let n_top = u32::try_from(n_bottom).ok().filter(|n| *n < u32::MAX / 2).ok_or_else(|| {
        Failure::refused(RefusalCode::TooManyTriangles, "the solid has more vertices than 2^32 - 1")
    })?;
    let at = |z: f64| {
        flat.origins.iter().map(move |origin| {
            let [x, y, _] = positions[*origin as usize];
            [x, y, z]
        })
    };
    let solid_positions = at(0.0).chain(at(height)).collect();
    let top = |i: u32| i + n_top;
    let mut solid_faces = Vec::with_capacity(2 * (flat.faces.len() + flat.border.len()));
    solid_faces.extend(flat.faces.iter().map(|[a, b, c]| [*a, *c, *b]));
    solid_faces.extend(flat.faces.iter().map(|face| face.map(top)));
    // The region is on the left of its border, and the outside on the right.
    solid_faces.extend(flat.border.iter().flat_map(|[a, b]| [[*a, *b, top(*b)], [*a, top(*b), top(*a)]]));
    Ok((solid_positions, solid_faces))
}

/// Triangles whose vertices have one fan each: a vertex at which regions only touch becomes one vertex for each fan.
pub(super) struct FanFaces {
    pub faces: Vec<[u32; 3]>,
    /// By vertex: its old index.
    pub origins: Vec<u32>,
    /// The edges of a single triangle, in its direction.
    pub border: Vec<[u32; 2]>,
}

impl FanFaces {
    pub fn new(faces: &[[u32; 3]]) -> Self {
        // 1. Each edge with the corner at which it starts, sorted by the undirected edge.
        let corner = |face: usize, k: usize| 3 * face + k % 3;
        let mut edges: Vec<([u32; 2], usize)> = Vec::with_capacity(3 * faces.len());
        for (index, face) in faces.iter().enumerate() {
            edges.extend((0..3).map(|k| {
                let (a, b) = (face[k], face[(k + 1) % 3]);
                ([a.min(b), a.max(b)], corner(index, k))
            }));
        }
        edges.sort_unstable();
        // 2. Triangles that share an edge have common fans at its ends.
        let next = |c: usize| corner(c / 3, c % 3 + 1);
        let mut fans = DisjointCorners((0..3 * faces.len()).collect());
        let mut open = Vec::new();
        for pair in edges.chunk_by(|a, b| a.0 == b.0) {
            match pair {
                [(_, a), (_, b)] => {
                    // The two triangles run along the edge in opposite directions.
                    fans.join(*a, next(*b));
                    fans.join(next(*a), *b);
                }
                // An edge occurs once or twice, since the triangles do not overlap.
                single => open.extend(single.iter().map(|(_, c)| *c)),
            }
        }
        // 3. Numbers the fans in the order of the triangles.
        const NONE: u32 = u32::MAX;
        let mut number = vec![NONE; 3 * faces.len()];
        let mut origins = Vec::new();
        let mut of_corner = |c: usize| {
            let fan = fans.first(c);
            if number[fan] == NONE {
                number[fan] = origins.len() as u32;
                origins.push(faces[c / 3][c % 3]);
            }
            number[fan]
        };
        let split = (0..faces.len()).map(|face| [0, 1, 2].map(|k| of_corner(corner(face, k)))).collect();
        open.sort_unstable();
        let border = open.into_iter().map(|c| [of_corner(c), of_corner(next(c))]).collect();
        Self { faces: split, origins, border }
    }
}

/// Disjoint sets of corners: each corner points to another one of its set, or to itself.
struct DisjointCorners(Vec<usize>);

impl DisjointCorners {
    fn first(&mut self, mut corner: usize) -> usize {
        while self.0[corner] != corner {
            self.0[corner] = self.0[self.0[corner]];
            corner = self.0[corner];
        }
        corner
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.first(a), self.first(b));
        self.0[a.max(b)] = a.min(b);
    }
}
