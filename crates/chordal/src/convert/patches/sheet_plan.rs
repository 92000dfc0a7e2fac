//! Plans the tiles of all sheets, or of some sheets while the tiles of the others are reused with their proofs.
use super::adjacency::PatchCorner;
use super::allowance::{Allowance, InfeasibleTolerance, TessellationFailure, refuse_tolerance};
use super::cell_estimate::CellEstimator;
use super::mesher::PatchMesher;
use super::patch_tile::{PatchTile, PatchTileMesh};
use super::plan::{self, PlanBefore, TilePlan};
use super::seams::TileSeams;
use super::subpatch::{Subpatch, SubpatchShape};
use crate::budget::{Failure, RefusalCode, par_map};
use crate::explicit::PatchSide;
use crate::math::lesser;

/// One sheet of a plan: its subpatches, and its tiles with their indices in the previous plan, if they were in it.
#[derive(Default)]
struct SheetPlan<'a> {
    subpatches: Vec<Subpatch<'a>>,
    tiles: Vec<(PatchTile, Option<usize>)>,
}

/// A plan with its finished tiles.
type PendingPlan<'a> = (TilePlan<'a>, Vec<Option<PatchTileMesh>>);

/// Peak memory in bytes per triangle, everything included; measured on the teapot at 1e6 triangles.
pub(super) const BYTES_PER_TRIANGLE: f64 = 200.0;

impl<'a> PatchMesher<'a, '_> {
    /// Tiles and rates for an allowance.
    pub(crate) fn plan(&self, allowance: &Allowance) -> Result<TilePlan<'a>, TessellationFailure> {
        let mut sheets = self.no_sheets();
        let safety_factors = vec![1.0; sheets.len()];
        let open = self.cut_sheets(&mut sheets, allowance, &safety_factors)?;
        self.cut_tiles(&mut sheets, open, allowance)?;
        Ok(self.join_sheets(sheets, safety_factors).0)
    }

    /// [`Self::plan`], but refuses plans that exceed the job's limits before the tiles are planned.
    pub(crate) fn plan_within_limits(
        &self,
        allowance: &Allowance,
    ) -> Result<TilePlan<'a>, TessellationFailure> {
        let mut sheets = self.no_sheets();
        let safety_factors = vec![1.0; sheets.len()];
        let open = self.cut_sheets(&mut sheets, allowance, &safety_factors)?;
        self.check_limits(&sheets, &open, allowance)?;
        self.cut_tiles(&mut sheets, open, allowance)?;
        Ok(self.join_sheets(sheets, safety_factors).0)
    }

    /// Plans with these safety factors. The kept sheets of the previous plan are reused, and with them their finished tiles
    /// if the vertices on the tile's border are still the same bit for bit.
    pub(super) fn plan_from(
        &self,
        before: PlanBefore<'a>,
        allowance: &Allowance,
        safety_factors: Vec<f64>,
    ) -> Result<PendingPlan<'a>, TessellationFailure> {
        let PlanBefore { plan, mut done, is_kept } = before;
        let mut sheets = self.no_sheets();
        let mut begin = vec![0; sheets.len()];
        for (index, subpatch) in plan.subpatches.into_iter().enumerate() {
            let sheet = subpatch.sheet as usize;
            let subpatches = &mut sheets[sheet].subpatches;
            if is_kept[sheet] {
                // The subpatches are listed sheet by sheet.
                begin[sheet] = if subpatches.is_empty() { index as u32 } else { begin[sheet] };
                subpatches.push(subpatch);
            }
        }
        let kept = plan.tiles.into_iter().enumerate().filter(|(_, tile)| is_kept[tile.sheet as usize]);
        for (index, tile) in kept {
            let subpatch = tile.subpatch - begin[tile.sheet as usize];
            sheets[tile.sheet as usize].tiles.push((PatchTile { subpatch, ..tile }, Some(index)));
        }
        let open = self.cut_sheets(&mut sheets, allowance, &safety_factors)?;
        self.check_limits(&sheets, &open, allowance)?;
        self.cut_tiles(&mut sheets, open, allowance)?;
        let (next, origins) = self.join_sheets(sheets, safety_factors);
        // Where a neighbour has changed the border of a kept tile, the tile's triangles are of no use.
        let take = |(index, origin): (usize, Option<usize>)| {
            let origin = origin.filter(|origin| next.seams.has_same_border(index, &plan.seams, *origin))?;
            done[origin].take()
        };
        let done = origins.into_iter().enumerate().map(take).collect();
        Ok((next, done))
    }

    fn no_sheets(&self) -> Vec<SheetPlan<'a>> {
        (0..self.sheets.count()).map(|_| SheetPlan::default()).collect()
    }

    /// Cuts the sheets that have none yet into subpatches, and returns their indices.
    fn cut_sheets(
        &self,
        sheets: &mut [SheetPlan<'a>],
        allowance: &Allowance,
        safety_factors: &[f64],
    ) -> Result<Vec<usize>, TessellationFailure> {
        let open: Vec<usize> =
            (0..sheets.len()).filter(|sheet| sheets[*sheet].subpatches.is_empty()).collect();
        let cut = par_map(self.job, &open, |_, &sheet| match self.job.is_cancelled() {
            true => Ok(Vec::new()),
            false => self.sheets.subpatches(sheet, allowance, safety_factors[sheet]),
        });
        self.not_cancelled()?;
        for (sheet, subpatches) in open.iter().zip(cut) {
            sheets[*sheet].subpatches = subpatches.map_err(refuse_tolerance)?;
        }
        Ok(open)
    }

    /// Cuts the subpatches of these sheets into tiles.
    fn cut_tiles(
        &self,
        sheets: &mut [SheetPlan<'a>],
        open: Vec<usize>,
        allowance: &Allowance,
    ) -> Result<(), TessellationFailure> {
        let cut = par_map(self.job, &open, |_, &sheet| {
            let mut tiles = Vec::new();
            for (index, subpatch) in sheets[sheet].subpatches.iter().enumerate() {
                if self.job.is_cancelled() {
                    break;
                }
                let sheet_tiles = plan::split_into_tiles(subpatch, allowance)?;
                tiles.extend(
                    sheet_tiles.into_iter().map(|tile| (PatchTile { subpatch: index as u32, ..tile }, None)),
                );
            }
            Ok(tiles)
        });
        self.not_cancelled()?;
        for (sheet, tiles) in open.into_iter().zip(cut) {
            sheets[sheet].tiles = tiles.map_err(refuse_tolerance)?;
        }
        Ok(())
    }

    fn not_cancelled(&self) -> Result<(), TessellationFailure> {
        if self.job.is_cancelled() { Err(Failure::Cancelled) } else { Ok(()) }
    }

    /// Refuses plans that exceed the job's limits, before the tiles of the open sheets are planned.
    fn check_limits(
        &self,
        sheets: &[SheetPlan<'a>],
        open: &[usize],
        allowance: &Allowance,
    ) -> Result<(), TessellationFailure> {
        let (triangles, memory) = (self.job.triangle_limit as f64, self.job.memory_limit as f64);
        let limit = lesser(triangles, memory / BYTES_PER_TRIANGLE);
        let kept = sheets.iter().flat_map(|sheet| &sheet.tiles);
        let kept: f64 = kept.map(|(tile, _)| 2.0 * f64::from(tile.n) * f64::from(tile.m)).sum();
        let total = |estimate: &(dyn Fn(&Subpatch<'_>) -> Result<f64, InfeasibleTolerance> + Sync)| {
            let parts = par_map(self.job, open, |_, &sheet| {
                sheets[sheet].subpatches.iter().try_fold(0.0, |sum, subpatch| Ok(sum + estimate(subpatch)?))
            });
            let sum = parts.into_iter().try_fold(kept, |sum, part| Ok(sum + part?));
            sum.map_err(refuse_tolerance)
        };
        // A quick estimate without halving; the exact one only if that exceeds the limit.
        let mut needed = total(&|subpatch| {
            let SubpatchShape::Bezier(patch) = &subpatch.shape else { return Ok(2.0) };
            let tolerance = plan::part_tolerance(patch, allowance, subpatch.rounding_error())?;
            Ok(2.0 * CellEstimator::new(patch).estimate(tolerance).cells)
        })?;
        if needed >= limit {
            needed = total(&|subpatch| plan::estimate(subpatch, allowance))?;
        }
        if needed > triangles {
            let message =
                format!("the budget needs about {needed:.1e} triangles; the limit is {triangles:.1e}");
            return Err(Failure::refused(RefusalCode::TooManyTriangles, message));
        }
        if needed > limit {
            let bytes = needed * BYTES_PER_TRIANGLE;
            let message =
                format!("the budget needs about {bytes:.1e} bytes of memory; the limit is {memory:.1e}");
            return Err(Failure::refused(RefusalCode::TooMuchMemory, message));
        }
        Ok(())
    }

    /// The plan of all sheets, and by tile its index in the previous plan, if it was in it.
    fn join_sheets(
        &self,
        sheets: Vec<SheetPlan<'a>>,
        safety_factors: Vec<f64>,
    ) -> (TilePlan<'a>, Vec<Option<usize>>) {
        let (mut subpatches, mut tiles, mut origins) = (Vec::new(), Vec::new(), Vec::new());
        for sheet in sheets {
            let begin = subpatches.len() as u32;
            subpatches.extend(sheet.subpatches);
            for (tile, origin) in sheet.tiles {
                tiles.push(PatchTile { subpatch: begin + tile.subpatch, ..tile });
                origins.push(origin);
            }
        }
        (self.lay_seams(subpatches, tiles, safety_factors), origins)
    }

    /// Builds the seams between the tiles.
    pub(super) fn lay_seams(
        &self,
        subpatches: Vec<Subpatch<'a>>,
        mut tiles: Vec<PatchTile>,
        safety_factors: Vec<f64>,
    ) -> TilePlan<'a> {
        for tile in &mut tiles {
            let ends = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| (tile.u[i], tile.v[j]));
            let kinds = self.adjacency.corner_kinds[tile.sheet as usize];
            let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
            let poles = PatchSide::ALL.map(|side| self.has_pole(tile, side));
            tile.corners = std::array::from_fn(|k| match kinds[k] {
                kind if kind != PatchCorner::Plain && ends[k] == corners[k] => kind,
                // All vertices of a pole are one, so edges from any of them coincide.
                _ if poles[k] || poles[(k + 3) % 4] => PatchCorner::Whole,
                _ => PatchCorner::Plain,
            });
        }
        let mut seams = TileSeams::new(self.adjacency, &tiles);
        seams.set_rates(&tiles, &subpatches, self.adjacency);
        let least = vec![1; self.sheets.count()];
        TilePlan { subpatches, tiles, seams, min_cells: least, safety_factors }
    }
}
