//! The numbers of cells, inner vertices and triangles of a tile for the segments on its sides, before it is built.
use super::plan::PatchTile;

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
