//! The border of a tile: the vertices that it shares with others, in the order of its sides.
use super::patch_tile::PatchTile;
use super::seams::{SeamLine, TileSeams};
use crate::explicit::PatchSide;

/// A vertex that a tile shares with others.
#[derive(Clone, Copy)]
pub(crate) struct BorderVertex {
    pub(crate) id: u32,
    /// The side of the *patch* on which it lies, or that starts at it if it is a corner; `None` inside.
    pub(crate) side: Option<PatchSide>,
    /// On a side of no length.
    pub(crate) pole: bool,
}

/// The vertices on the border of a tile, counter-clockwise from its corner (0, 0).
pub(crate) fn border(index: usize, tile: &PatchTile, seams: &TileSeams) -> Vec<BorderVertex> {
    let mut list = Vec::new();
    for side in PatchSide::ALL {
        walk_side(index, tile, side, seams, |_, _, vertex| list.push(vertex));
    }
    list
}

/// Calls `visit` with the parameters in the tile and the vertex of every point on one side but the last.
pub(super) fn walk_side(
    index: usize,
    tile: &PatchTile,
    side: PatchSide,
    seams: &TileSeams,
    mut visit: impl FnMut(f64, f64, BorderVertex),
) {
    // The start and end of the tile's side on its line, in the order of the tile's parameter.
    let mut ends = [f64::NAN; 2];
    for (piece, backwards) in seams.chain(index, side) {
        let [from, to] = if backwards { [piece.span[1], piece.span[0]] } else { piece.span };
        ends = [if ends[0].is_nan() { from } else { ends[0] }, to];
    }
    let [low, high] =
        if matches!(side, PatchSide::Top | PatchSide::Left) { [ends[1], ends[0]] } else { ends };
    for (piece, backwards) in seams.chain(index, side) {
        for step in 0..piece.n {
            let k = if backwards { piece.n - step } else { step };
            let at = (piece.parameter(k) - low) / (high - low);
            let (u, v) = match side {
                PatchSide::Bottom => (at, 0.0),
                PatchSide::Right => (1.0, at),
                PatchSide::Top => (at, 1.0),
                PatchSide::Left => (0.0, at),
            };
            let pole = matches!(piece.line, SeamLine::Point(..));
            visit(u, v, BorderVertex { id: piece.vertex(k), side: side_of_patch(tile, u, v), pole });
        }
    }
}

/// The side of the patch at a point of the tile's border; a corner belongs to the side that starts there.
fn side_of_patch(tile: &PatchTile, u: f64, v: f64) -> Option<PatchSide> {
    let ends = |x: f64, [a, b]: [f64; 2]| (x == 0.0 && a == 0.0, x == 1.0 && b == 1.0);
    let ((left, right), (bottom, top)) = (ends(u, tile.u), ends(v, tile.v));
    if bottom && !right {
        Some(PatchSide::Bottom)
    } else if right && !top {
        Some(PatchSide::Right)
    } else if top && !left {
        Some(PatchSide::Top)
    } else {
        left.then_some(PatchSide::Left)
    }
}
