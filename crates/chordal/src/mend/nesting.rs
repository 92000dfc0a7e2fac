//! Inside how many other closed pieces each closed piece lies, decided exactly.
//!
//! A vertex of the piece is lifted off every coincidence by a shift (ε, ε², ε³), with ε smaller than any number, and the
//! triangles straight above it are counted by piece: an odd count means inside.
//!
//! Source: H. Edelsbrunner and E. P. Mücke, *Simulation of simplicity*, 1990.
use super::orient::Piece;
use crate::Mesh;
use crate::math::{Box3, Orientation, orient2d, orient3d};

/// Vertices of a piece that are asked, spread over its faces: a piece that only reaches into another is not inside it.
const SAMPLES: usize = 16;

/// For each piece, in how many of the others it lies.
pub(super) fn depths(mesh: &Mesh, pieces: &[&Piece]) -> Vec<usize> {
    if pieces.len() < 2 {
        return vec![0; pieces.len()];
    }
    let faces =
        (0..).zip(pieces).flat_map(|(piece, faces)| faces.faces.iter().map(move |&face| (face, piece)));
    let tree = Shadows::new(mesh, faces.collect());
    let mut odd = vec![false; pieces.len()];
    (0..).zip(pieces).map(|(number, piece)| tree.depth(mesh, (number, piece), &mut odd)).collect()
}

/// The triangles of all pieces, in nested boxes that are blind to height.
struct Shadows {
    /// Face and piece, those of one box side by side.
    faces: Vec<(u32, u32)>,
    nodes: Vec<Node>,
}

struct Node {
    bounds: Box3,
    start: usize,
    end: usize,
    /// The node to go on with when this one is left out.
    skip: usize,
}

/// Triangles a leaf, as in the other trees.
const LEAF: usize = 8;

impl Shadows {
    fn new(mesh: &Mesh, faces: Vec<(u32, u32)>) -> Self {
        let mut tree = Self { faces, nodes: Vec::new() };
        tree.build(mesh, 0, tree.faces.len());
        tree
    }

    /// Depth is the logarithm of the number of faces: every split is in the middle.
    fn build(&mut self, mesh: &Mesh, start: usize, end: usize) {
        let part = &mut self.faces[start..end];
        let corners = part.iter().flat_map(|&(face, _)| mesh.faces()[face as usize]);
        let bounds = Box3::around(corners.map(|row| &mesh.positions()[row as usize]));
        let node = self.nodes.len();
        self.nodes.push(Node { bounds, start, end, skip: 0 });
        if end - start > LEAF {
            let side = |k: usize| 0.5 * bounds.max[k] - 0.5 * bounds.min[k];
            let axis = usize::from(side(1) > side(0));
            let place = |face: u32| mesh.corners(face as usize).iter().map(|c| c[axis] / 3.0).sum::<f64>();
            let middle = (end - start) / 2;
            part.select_nth_unstable_by(middle, |a, b| place(a.0).total_cmp(&place(b.0)).then(a.cmp(b)));
            self.build(mesh, start, start + middle);
            self.build(mesh, start + middle, end);
        }
        self.nodes[node].skip = self.nodes.len();
    }

    /// In how many other pieces a piece lies, with all of its samples. Samples on the surface of another piece count only
    /// where all are. `odd` is all false, before and after.
    fn depth(&self, mesh: &Mesh, (number, piece): (u32, &Piece), odd: &mut [bool]) -> usize {
        let mut around: [Vec<Vec<usize>>; 2] = Default::default();
        for face in piece.faces.iter().step_by(piece.faces.len().div_ceil(SAMPLES)) {
            let mut touches = false;
            let mut met = Vec::new();
            self.above(mesh, mesh.corners(*face as usize)[0], |other, on_plane| {
                if other != number {
                    odd[other as usize] = !odd[other as usize];
                    touches |= on_plane;
                    met.push(other as usize);
                }
            });
            met.sort_unstable();
            met.dedup();
            let inside = met.iter().copied().filter(|&other| odd[other]).collect();
            met.iter().for_each(|&other| odd[other] = false);
            around[usize::from(touches)].push(inside);
        }
        let [clear, touching] = around;
        let samples = if clear.is_empty() { touching } else { clear };
        let Some((first, rest)) = samples.split_first() else { return 0 };
        first.iter().filter(|other| rest.iter().all(|inside| inside.contains(other))).count()
    }

    /// Calls `visit` with the piece of every triangle straight above `p`, and whether `p` lies in its plane.
    fn above(&self, mesh: &Mesh, p: [f64; 3], mut visit: impl FnMut(u32, bool)) {
        let mut next = 0;
        while let Some(node) = self.nodes.get(next) {
            let is_met = (0..2).all(|k| node.bounds.min[k] <= p[k] && p[k] <= node.bounds.max[k])
                && p[2] <= node.bounds.max[2];
            if is_met && next + 1 == node.skip {
                for &(face, piece) in &self.faces[node.start..node.end] {
                    let corners = mesh.corners(face as usize);
                    if is_under(corners, p)
                        && let (true, on_plane) = is_below(corners, p)
                    {
                        visit(piece, on_plane);
                    }
                }
            }
            next = if is_met { next + 1 } else { node.skip };
        }
    }
}

/// Whether `p`, shifted, is seen inside the triangle from above.
fn is_under(corners: [[f64; 3]; 3], p: [f64; 3]) -> bool {
    let flat = |q: [f64; 3]| [q[0], q[1]];
    let crosses = |k: usize| {
        let (mut low, mut high) = (corners[k], corners[(k + 1) % 3]);
        if (low[1] > p[1]) == (high[1] > p[1]) {
            return false;
        }
        if low[1] > high[1] {
            (low, high) = (high, low);
        }
        orient2d(flat(low), flat(high), flat(p)) == Orientation::Front
    };
    (0..3).filter(|&k| crosses(k)).count() % 2 == 1
}

/// Whether `p`, shifted, is below the plane of a triangle that is not upright, and whether it is on it unshifted.
fn is_below([a, b, c]: [[f64; 3]; 3], p: [f64; 3]) -> (bool, bool) {
    let normal = |i: usize, j: usize| orient2d([a[i], a[j]], [b[i], b[j]], [c[i], c[j]]);
    let up = normal(0, 1);
    let side = orient3d(a, b, c, p);
    let shifted = [side, normal(1, 2), normal(2, 0), up];
    let in_front = shifted.into_iter().find(|side| *side != Orientation::Flat);
    (in_front.is_some_and(|side| side != up), side == Orientation::Flat)
}
