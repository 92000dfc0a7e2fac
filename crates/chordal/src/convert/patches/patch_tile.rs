//! `PatchTile`: a rectangle of a subpatch with its cells, how many triangles it has, and its mesh.
use super::adjacency::PatchCorner;
use crate::explicit::PatchSide;
use crate::math::Box3;

/// A rectangle of one subpatch with its cells, in the parameters of the sheet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PatchTile {
    pub(crate) sheet: u32,
    /// The index of its subpatch.
    pub(crate) subpatch: u32,
    /// Start and end, dyadic numbers.
    pub(crate) u: [f64; 2],
    pub(crate) v: [f64; 2],
    /// Cells along u and along v.
    pub(crate) n: u32,
    pub(crate) m: u32,
    /// Whether the diagonal of cells runs from their first corner to the opposite one, instead of between the other
    /// two.
    pub(crate) rising: bool,
    /// The kinds of its corners, in the order of the sides that start there.
    pub(crate) corners: [PatchCorner; 4],
    /// The allowed length here, less rounding.
    pub(crate) tolerance: f64,
    /// The tolerance for which its cells were planned.
    pub(crate) planned: f64,
    /// The factor by which the estimate's tolerance is reduced, because proofs were worse than estimates; 1 at first.
    pub(crate) safety_factor: f64,
}

impl PatchTile {
    /// Whether one of its sides is on the border of its sheet.
    pub(crate) fn is_on_border(&self, side: PatchSide) -> bool {
        match side {
            PatchSide::Bottom => self.v[0] == 0.0,
            PatchSide::Right => self.u[1] == 1.0,
            PatchSide::Top => self.v[1] == 1.0,
            PatchSide::Left => self.u[0] == 0.0,
        }
    }

    /// The half of a side of its sheet that contains it, in the order of the parameter.
    pub(crate) fn half(&self, side: PatchSide) -> usize {
        let span = if matches!(side, PatchSide::Bottom | PatchSide::Top) { self.u } else { self.v };
        usize::from(span[0] >= 0.5)
    }
}

/// A finished tile. Local vertices: the border counter-clockwise from corner (0, 0), then inner rows.
#[derive(Clone)]
pub(crate) struct PatchTileMesh {
    /// Triangles by local vertices; triangles that a pole makes degenerate are left out.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Positions and unit normals of the inner vertices; a zero normal if the patch has none.
    pub(crate) inner: Vec<[f64; 3]>,
    pub(crate) inner_normals: Vec<[f64; 3]>,
    /// The largest distance, rounding included.
    pub(crate) bound: f64,
    /// The triangle with the largest bound: the patch's parameters at its corners.
    pub(crate) worst: [[f64; 2]; 3],
    /// The largest distance found between the unit normals of the triangles and those of the surface; set if the
    /// budget limits an angle.
    pub(crate) normal_deviation: Option<f64>,
    /// Whether there are too few cells: a triangle has the same vertex twice without a pole, or a triangle that a
    /// pole makes a segment is left out and no other triangle has that segment.
    pub(crate) too_few: bool,
    /// The surface's unit normals at the vertices of its border, in the order of the border; zero where there is none.
    /// Empty until the mesh is assembled.
    pub(crate) border_normals: Vec<[f64; 3]>,
    /// A box around its part of the surface.
    pub(crate) place: Box3,
    /// Whether it was built for an earlier view.
    pub(crate) is_kept: bool,
}

/// The number of triangles of a tile with `counts` segments on its sides, of which `poles` have no length: by
/// Euler, 2·inner + border − 2, less the degenerate ones.
pub(crate) fn count_triangles(tile: &PatchTile, counts: [u32; 4], poles: [bool; 4]) -> u64 {
    let [n, m] = cell_counts(tile, counts).map(u64::from);
    let border: u64 = counts.iter().map(|c| u64::from(*c)).sum();
    let flat: u64 = counts.iter().zip(poles).filter(|c| c.1).map(|c| u64::from(*c.0)).sum();
    (2 * (n - 1) * (m - 1) + border - 2).saturating_sub(flat)
}

/// Cells in each direction, given the segments on the sides. A tile without inner vertices can only join two opposite
/// sides, so tiles whose other sides have several segments get at least two cells in each direction.
pub(super) fn cell_counts(tile: &PatchTile, [bottom, right, top, left]: [u32; 4]) -> [u32; 2] {
    if tile.m == 1 && left == 1 && right == 1 {
        [tile.n, 1]
    } else if tile.n == 1 && bottom == 1 && top == 1 {
        [1, tile.m.max(2)]
    } else {
        [tile.n.max(2), tile.m.max(2)]
    }
}

/// The parameters of the inner vertices in the tile's unit square, for these segment counts of its sides.
pub(super) fn inner_places(tile: &PatchTile, counts: [u32; 4]) -> impl Iterator<Item = [f64; 2]> {
    let [n, m] = cell_counts(tile, counts);
    let at = |k: u32, n: u32| f64::from(k) / f64::from(n);
    (1..m).flat_map(move |j| (1..n).map(move |i| [at(i, n), at(j, m)]))
}
