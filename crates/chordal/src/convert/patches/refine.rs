//! Refines tiles that miss their tolerance: more cells, or a finer subdivision of their sheet.
use super::allowance::Allowance;
use super::cell_estimate::CellEstimator;
use super::patch_tile::{PatchTile, PatchTileMesh};
use super::plan::TilePlan;
use super::subpatch::{SubpatchKind, SubpatchShape};
use crate::explicit::Patch;
use crate::math::greater;
use glam::DVec3;

/// Adds cells to every tile that misses its tolerance: as many as would meet it if the estimate is wrong by the same
/// factor everywhere, and at least one row or column. Returns whether there was such a tile.
pub(crate) fn refine_missed(
    planned: &mut TilePlan<'_>,
    done: &mut [Option<PatchTileMesh>],
    round: usize,
    allowance: &Allowance,
) -> bool {
    let TilePlan { subpatches, tiles, .. } = planned;
    let mut missed = false;
    for (tile, slot) in tiles.iter_mut().zip(done) {
        let subpatch = &subpatches[tile.subpatch as usize];
        let SubpatchShape::Bezier(patch) = &subpatch.shape else { continue };
        let rounding = subpatch.rounding_error();
        let Some(done) = slot else { continue };
        let by_bound = match done.bound > tile.tolerance + rounding {
            true => (done.bound - rounding) / tile.tolerance,
            false => 0.0,
        };
        let by_turn = normal_deviation_ratio(done, allowance);
        let ratio = greater(by_bound, by_turn);
        if ratio == 0.0 {
            continue;
        }
        missed = true;
        *slot = None;
        let part = subpatch.tile_patch(patch, tile);
        if by_turn > 0.0 && tile.safety_factor > LARGEST_STRAIN_BY_TURN {
            let [long, tall] = cell(&part, tile);
            // Halves the cells along their longer side, or along both.
            tile.n *= if tall > 2.0 * long { 1 } else { 2 };
            tile.m *= if long > 2.0 * tall { 1 } else { 2 };
            continue;
        }
        tile.safety_factor *= ratio * if round < 3 { 1.01 } else { 1.1 };
        let probe = CellEstimator::new(&part);
        let reduced = tile.tolerance / tile.safety_factor;
        let rates = probe.rates(&probe.estimate(reduced), reduced);
        let before = (tile.n, tile.m);
        (tile.n, tile.m, tile.rising) = (rates.n.max(tile.n), rates.m.max(tile.m), rates.rising);
        // At least one more cell, or the tile would stay as it is.
        if (tile.n, tile.m) == before {
            *(if tile.n < tile.m { &mut tile.m } else { &mut tile.n }) += 1;
        }
    }
    missed
}

/// If a tile with this safety factor still misses the angle, its cells have the wrong shape, because the estimate only
/// considers distances. Chosen: tiles of the right shape need less.
const LARGEST_STRAIN_BY_TURN: f64 = 16.0;

/// The width and height of the cells of a tile, from its corners.
fn cell(part: &Patch, tile: &PatchTile) -> [f64; 2] {
    let corner = |i: usize, j: usize| DVec3::from(part.control[j][i]);
    let [a, b, c, d] = [corner(0, 0), corner(3, 0), corner(3, 3), corner(0, 3)];
    let along = |x: f64, y: f64, n: u32| (x + y) / f64::from(n);
    [along((b - a).length(), (c - d).length(), tile.n), along((d - a).length(), (c - b).length(), tile.m)]
}

/// The factor by which a tile must reduce its distance if its normals miss the limit; 0 if they do not.
/// A triangle's distance falls with the square of its normal's deviation. The factor allows at most twice as many cells
/// in each direction at once, since in folds normals do not converge.
pub(crate) fn normal_deviation_ratio(done: &PatchTileMesh, allowance: &Allowance) -> f64 {
    match (done.normal_deviation, allowance.normal_deviation) {
        (Some(turn), Some(allowed)) if turn > allowed => {
            let ratio = turn / allowed;
            if ratio < 2.0 { ratio * ratio } else { 4.0 }
        }
        _ => 0.0,
    }
}

/// The safety factors, raised for sheets whose extraordinary subpatches miss their tolerance, so that these
/// are subdivided; `None` if there are none.
pub(crate) fn raised_safety_factors(
    planned: &TilePlan<'_>,
    done: &[Option<PatchTileMesh>],
    allowance: &Allowance,
) -> Option<Vec<f64>> {
    let TilePlan { subpatches, tiles, safety_factors, .. } = planned;
    let (mut safety_factors, mut missed) = (safety_factors.clone(), false);
    for (tile, done) in tiles.iter().zip(done) {
        let subpatch = &subpatches[tile.subpatch as usize];
        let Some(done) = done.as_ref().filter(|_| subpatch.kind() == SubpatchKind::Extraordinary) else {
            continue;
        };
        let (rounding, bound) = (subpatch.rounding_error(), done.bound);
        let by_turn = normal_deviation_ratio(done, allowance);
        if bound > tile.tolerance + rounding || by_turn > 0.0 {
            missed = true;
            let by_bound = (bound - rounding) / tile.tolerance;
            let ratio = greater(by_bound, by_turn);
            // Only a small factor at once: a large corner that is cut off deviates by far more than the next
            // smaller one would.
            safety_factors[tile.sheet as usize] *=
                if ratio < LEAST_STRAIN { LEAST_STRAIN } else { MOST_STRAIN_AT_ONCE };
        }
    }
    missed.then_some(safety_factors)
}

/// The factor for a sheet whose extraordinary subpatch missed the tolerance by less than this factor. Chosen: a halving
/// gains a factor of 4.
const LEAST_STRAIN: f64 = 1.25;
/// The factor for all other sheets. Chosen, as above.
const MOST_STRAIN_AT_ONCE: f64 = 2.0;
