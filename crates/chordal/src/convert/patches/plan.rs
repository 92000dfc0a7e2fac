//! Splits patches into tiles and chooses their tessellation rates, so that few triangles meet the budget.
//!
//! A tile is a rectangle of one patch's parameter plane with `n × m` equal cells. The number of cells that a
//! rectangle needs is about `bound/tolerance`, so a rectangle is halved if its halves together need fewer.
//! None of this has to be exact: [`super::tile`] proves each tile afterwards, and cells are added where they are
//! missing.
use super::adjacency::PatchCorner;
use super::allowance::{Allowance, InfeasibleTolerance};
use super::cell_estimate::{CellEstimate, CellEstimator, TessellationRates};
use super::patch_tile::{PatchTile, PatchTileMesh};
use super::seams::TileSeams;
use super::subpatch::{Subpatch, SubpatchShape};
use crate::explicit::Patch;
use crate::math::{Box3, sub_down};

/// Tiles with their seams, not yet proved.
pub(crate) struct TilePlan<'a> {
    pub(crate) subpatches: Vec<Subpatch<'a>>,
    pub(crate) tiles: Vec<PatchTile>,
    pub(crate) seams: TileSeams,
    /// The fewest cells in each direction, by sheet, that keep edges of different curves apart.
    pub(crate) min_cells: Vec<u32>,
    /// By sheet: the factor by which the tolerance of extraordinary subpatches is reduced, because proofs were worse than
    /// expected; 1 at first.
    pub(crate) safety_factors: Vec<f64>,
}

/// A plan with its finished tiles, and the sheets that are kept in the next plan.
pub(super) struct PlanBefore<'a> {
    pub(super) plan: TilePlan<'a>,
    pub(super) done: Vec<Option<PatchTileMesh>>,
    /// By sheet.
    pub(super) is_kept: Vec<bool>,
}

/// A rectangle with fewer cells is never halved. Chosen: the stitching would cost as many triangles as it saves.
const FEWEST_CELLS_TO_HALVE: f64 = 6.0;
/// A rectangle with more cells is always halved. Chosen: then threads can share the work.
const MOST_CELLS: f64 = 4096.0;
/// Halving must reduce the cells to this fraction. Chosen: tiles of different rates cost triangles where they
/// meet.
const WORTH_HALVING: f64 = 0.93;

/// A direction with fewer cells is not halved. Chosen: its halves would have one cell at most.
const FEWEST_EACH_WAY: f64 = 2.0;
/// The narrowest tile: one cell of this width bends by less than 60·2⁻⁶⁰ sizes, which is less than rounding.
/// So the parameters of tiles, and one minus those, are exact.
const NARROWEST: f64 = 1.0 / (1 << 30) as f64;

fn is_broad([from, to]: [f64; 2]) -> bool {
    to - from > NARROWEST
}

/// A whole subpatch as one cell.
fn single_cell(subpatch: &Subpatch<'_>, tolerance: f64) -> PatchTile {
    let (u, v, corners) = (subpatch.u, subpatch.v, [PatchCorner::Plain; 4]);
    let (n, m, rising) = (1, 1, true);
    PatchTile {
        sheet: subpatch.sheet,
        subpatch: 0,
        u,
        v,
        n,
        m,
        rising,
        corners,
        tolerance,
        planned: tolerance,
        safety_factor: 1.0,
    }
}

/// A tile whose normals vary in one spot is halved in each direction with at least this many cells. Chosen: with fewer
/// cells there is little to gain.
const CELLS_TO_HALVE: u32 = 8;

/// Halves a tile in each direction in which it has many cells.
pub(crate) fn split_tile(tile: &PatchTile) -> Vec<PatchTile> {
    let halves = |[from, to]: [f64; 2], n: u32| {
        let middle = 0.5 * (from + to);
        match n >= CELLS_TO_HALVE && is_broad([from, to]) {
            true => vec![([from, middle], n.div_ceil(2)), ([middle, to], n.div_ceil(2))],
            false => vec![([from, to], n)],
        }
    };
    let mut parts = Vec::new();
    for (v, m) in halves(tile.v, tile.m) {
        parts.extend(halves(tile.u, tile.n).into_iter().map(|(u, n)| PatchTile { u, v, n, m, ..*tile }));
    }
    parts
}

/// The allowed length of a part, less rounding.
pub(crate) fn tolerance(
    place: Box3,
    allowance: &Allowance,
    rounding: f64,
) -> Result<f64, InfeasibleTolerance> {
    less_rounding(allowance.at(&place), place, rounding)
}

/// The allowed length of a Bézier part, less rounding.
pub(crate) fn part_tolerance(
    part: &Patch,
    allowance: &Allowance,
    rounding: f64,
) -> Result<f64, InfeasibleTolerance> {
    less_rounding(allowance.over(part, rounding), part.bounds(), rounding)
}

fn less_rounding(allowed: Option<f64>, place: Box3, rounding: f64) -> Result<f64, InfeasibleTolerance> {
    // Rounded down, so that tolerance and rounding together never exceed the allowed length.
    let tolerance = sub_down(allowed.ok_or(InfeasibleTolerance::TooClose(place))?, rounding);
    // If rounding takes most of the budget, noise would determine the number of cells.
    if tolerance < rounding {
        Err(InfeasibleTolerance::BelowRounding(place, rounding))
    } else {
        Ok(tolerance)
    }
}

/// The tiles of one subpatch, in the order of a depth-first walk.
pub(crate) fn split_into_tiles(
    subpatch: &Subpatch<'_>,
    allowance: &Allowance,
) -> Result<Vec<PatchTile>, InfeasibleTolerance> {
    let mut tiles = Vec::new();
    let rounding = subpatch.rounding_error();
    let patch = match &subpatch.shape {
        SubpatchShape::Bezier(patch) => **patch,
        SubpatchShape::Extraordinary(extraordinary) => {
            let tolerance = tolerance(Box3::from_points(extraordinary.ring().hull()), allowance, rounding)?;
            return Ok(vec![single_cell(subpatch, tolerance)]);
        }
    };
    let mut open = vec![TileCandidate::new(patch, subpatch.u, subpatch.v, allowance, rounding)?];
    while let Some(rectangle) = open.pop() {
        let by_estimate = rectangle.better_half().or_else(|| rectangle.longer_half());
        if let Some(half) = by_estimate.or_else(|| rectangle.half_beside_outline(allowance, rounding)) {
            let halves = rectangle.halve(half, allowance, rounding)?;
            // Estimates that are noise may not fall; without this test halving would then go on to the narrowest
            // tiles everywhere.
            let most = if by_estimate.is_some() { 1.2 } else { WORTH_HALVING };
            if halves[0].estimate.cells + halves[1].estimate.cells < most * rectangle.estimate.cells {
                open.extend(halves);
                continue;
            }
        }
        tiles.push(rectangle.tile(subpatch));
    }
    Ok(tiles)
}

/// The approximate number of triangles that a subpatch needs, without building tiles: rectangles are halved only while
/// that reduces it.
pub(crate) fn estimate(subpatch: &Subpatch<'_>, allowance: &Allowance) -> Result<f64, InfeasibleTolerance> {
    let rounding = subpatch.rounding_error();
    let SubpatchShape::Bezier(patch) = &subpatch.shape else { return Ok(2.0) };
    let mut open = vec![TileCandidate::new(**patch, subpatch.u, subpatch.v, allowance, rounding)?];
    let (mut cells, mut n_examined) = (0.0, 0);
    while let Some(rectangle) = open.pop() {
        n_examined += 1;
        match rectangle.better_half().filter(|_| n_examined < MOST_LOOKS) {
            Some(half) => open.extend(rectangle.halve(half, allowance, rounding)?),
            None => cells += rectangle.estimate.cells,
        }
    }
    Ok(2.0 * cells)
}

/// The most rectangles of one patch that an estimate examines. Chosen: an estimate should cost little beside the tile.
const MOST_LOOKS: usize = 256;

/// The direction in which a rectangle is halved.
#[derive(Clone, Copy, PartialEq)]
enum ParameterAxis {
    U,
    V,
}

/// A rectangle that may still be halved.
struct TileCandidate {
    part: Patch,
    u: [f64; 2],
    v: [f64; 2],
    tolerance: f64,
    estimator: CellEstimator,
    estimate: CellEstimate,
}

impl TileCandidate {
    fn new(
        part: Patch,
        u: [f64; 2],
        v: [f64; 2],
        allowance: &Allowance,
        rounding: f64,
    ) -> Result<Self, InfeasibleTolerance> {
        let tolerance = part_tolerance(&part, allowance, rounding)?;
        let probe = CellEstimator::new(&part);
        let need = probe.estimate(tolerance);
        Ok(Self { part, u, v, tolerance, estimator: probe, estimate: need })
    }

    /// The direction in which halves need fewer cells, if halving is worth it. A direction with one cell has one in each
    /// half as well, so halving it doubles the cells whatever the bound is.
    fn better_half(&self) -> Option<ParameterAxis> {
        let [wide, tall] = self.estimate.after_halving;
        let [n, m] = self.estimate.each_way();
        let share = |share: f64, cells: f64, span: [f64; 2]| {
            if cells > FEWEST_EACH_WAY && is_broad(span) { share } else { 1.0 }
        };
        let (wide, tall) = (share(wide, n, self.u), share(tall, m, self.v));
        let (half, share) = if wide <= tall { (ParameterAxis::U, wide) } else { (ParameterAxis::V, tall) };
        (self.estimate.cells > FEWEST_CELLS_TO_HALVE && share < WORTH_HALVING).then_some(half)
    }

    /// The direction with more cells, if there are too many cells for one thread.
    fn longer_half(&self) -> Option<ParameterAxis> {
        let [n, m] = self.estimate.each_way();
        let (half, span) = if n >= m { (ParameterAxis::U, self.u) } else { (ParameterAxis::V, self.v) };
        (self.estimate.cells > MOST_CELLS && is_broad(span)).then_some(half)
    }

    /// The direction with more cells, if the outline may cross the rectangle: one of the halves may be clear of it.
    fn half_beside_outline(&self, allowance: &Allowance, rounding: f64) -> Option<ParameterAxis> {
        let outline = allowance.outline.as_ref()?;
        let [n, m] = self.estimate.each_way();
        let (half, span) = if n >= m { (ParameterAxis::U, self.u) } else { (ParameterAxis::V, self.v) };
        let is_large = self.estimate.cells > FEWEST_CELLS_TO_HALVE && is_broad(span);
        (is_large && !outline.is_clear(&self.part, rounding)).then_some(half)
    }

    /// The second half, then the first, which is examined next.
    fn halve(
        &self,
        half: ParameterAxis,
        allowance: &Allowance,
        rounding: f64,
    ) -> Result<[Self; 2], InfeasibleTolerance> {
        let middle = |[a, b]: [f64; 2]| 0.5 * (a + b);
        let (u, v) = (self.u, self.v);
        if half == ParameterAxis::U {
            let [left, right] = self.part.halves_u();
            let cut = middle(u);
            Ok([
                Self::new(right, [cut, u[1]], v, allowance, rounding)?,
                Self::new(left, [u[0], cut], v, allowance, rounding)?,
            ])
        } else {
            let [low, high] = self.part.halves_v();
            let cut = middle(v);
            Ok([
                Self::new(high, u, [cut, v[1]], allowance, rounding)?,
                Self::new(low, u, [v[0], cut], allowance, rounding)?,
            ])
        }
    }

    fn tile(&self, subpatch: &Subpatch<'_>) -> PatchTile {
        let TessellationRates { n, m, rising } = self.estimator.rates(&self.estimate, self.tolerance);
        PatchTile { u: self.u, v: self.v, n, m, rising, ..single_cell(subpatch, self.tolerance) }
    }
}
