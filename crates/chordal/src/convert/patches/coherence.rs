//! Keeps tiles from one view to the next.
//!
//! A tile's proof is a length and does not depend on the view. At the next view a tile *holds* if that length is still
//! allowed over its box. A sheet is planned anew if one of its tiles does not hold, or if about half of its triangles
//! would suffice; otherwise its tiles stay. If a tile that stays has new vertices on its border, because a neighbour was
//! planned anew, it is built and proved again, for the length that is allowed now. The others are reused unchanged: all
//! data on which their proof depends, their part of the surface, their cells and the vertices on their border, are equal
//! bit for bit. So the bound of the mesh is proved for this view, like that of a mesh built from nothing.
use super::allowance::{Allowance, TessellationFailure};
use super::mesher::{CertifiedTiles, PatchMesher};
use super::plan::{self, PlanBefore, TilePlan};
use crate::budget::{Bounded, Failure, RefusalCode};
use crate::explicit::Mesh;
use crate::math::greater;

/// The share of the allowed length for which tiles are planned. Chosen: smaller takes more triangles, larger holds for
/// fewer views while the eye comes nearer.
const SHARE: f64 = 0.75;

/// A sheet is planned anew if less than this share of its cells would suffice. Chosen; the number of a tile's cells is
/// inversely proportional to its length.
const FEW: f64 = 0.5;

impl<'a> PatchMesher<'a, '_> {
    /// The mesh for an allowance, built from the tiles of an earlier mesh as far as they hold, and its tiles.
    pub(crate) fn mesh_from(
        &self,
        before: Option<CertifiedTiles<'a>>,
        allowance: &Allowance,
    ) -> Result<(Bounded<Mesh>, CertifiedTiles<'a>), TessellationFailure> {
        let planned = Allowance { share: SHARE, ..*allowance };
        let mut proved = match self.tiles_from(before, &planned, allowance) {
            // The share reserved for later views may be needed now, for rounding or the job's limits.
            Err(Failure::Refused(refusal)) if refusal.code != RefusalCode::TooClose => {
                self.tiles_from(None, allowance, allowance)
            }
            other => other,
        }?;
        Ok((self.finish(&mut proved, allowance), proved))
    }

    fn tiles_from(
        &self,
        before: Option<CertifiedTiles<'a>>,
        planned: &Allowance,
        allowance: &Allowance,
    ) -> Result<CertifiedTiles<'a>, TessellationFailure> {
        let Some(before) = before else {
            return self.prove(self.plan_within_limits(planned)?, planned);
        };
        let mut before = PlanBefore::from_tiles(before);
        let mut safety_factors = before.plan.safety_factors.clone();
        before.mark_kept(allowance, &mut safety_factors);
        let (plan, done) = self.plan_from(before, planned, safety_factors)?;
        self.prove_pending(plan, done, planned)
    }
}

impl<'a> PlanBefore<'a> {
    fn from_tiles(tiles: CertifiedTiles<'a>) -> Self {
        let CertifiedTiles { subpatches, tiles, seams, safety_factors } = tiles;
        let (tiles, mut done): (Vec<_>, Vec<_>) =
            tiles.into_iter().map(|(tile, done)| (tile, Some(done))).unzip();
        done.iter_mut().flatten().for_each(|done| done.is_kept = true);
        let is_kept = vec![true; safety_factors.len()];
        let plan = TilePlan { subpatches, tiles, seams, min_cells: vec![1; is_kept.len()], safety_factors };
        Self { plan, done, is_kept }
    }

    /// Finds the sheets whose tiles hold and are not too many, and gives these tiles the length that is allowed now.
    fn mark_kept(&mut self, allowance: &Allowance, safety_factors: &mut [f64]) {
        let TilePlan { subpatches, tiles, .. } = &mut self.plan;
        // By sheet: the cells of its tiles, and the cells that would suffice.
        let mut cells = vec![[0.0; 2]; self.is_kept.len()];
        for (tile, done) in tiles.iter_mut().zip(&self.done) {
            let (sheet, rounding) =
                (tile.sheet as usize, subpatches[tile.subpatch as usize].rounding_error());
            let tolerance = done.as_ref().and_then(|done| {
                let tolerance = plan::tolerance(done.place, allowance, rounding).ok()?;
                (done.bound <= tolerance + rounding).then_some(tolerance)
            });
            let Some(tolerance) = tolerance else {
                self.is_kept[sheet] = false;
                continue;
            };
            tile.tolerance = tolerance;
            let n_cells = f64::from(tile.n) * f64::from(tile.m);
            cells[sheet][0] += n_cells;
            cells[sheet][1] += n_cells * (tile.planned / tolerance);
        }
        for (sheet, [present, enough]) in cells.into_iter().enumerate() {
            if self.is_kept[sheet] && greater(enough, 1.0) < FEW * present {
                self.is_kept[sheet] = false;
                // The factor was found for smaller subpatches.
                safety_factors[sheet] = 1.0;
            }
        }
    }
}

impl CertifiedTiles<'_> {
    pub(crate) fn n_tiles(&self) -> u64 {
        self.tiles.len() as u64
    }

    /// The number of tiles that were reused.
    pub(crate) fn n_kept(&self) -> u64 {
        self.tiles.iter().filter(|(_, done)| done.is_kept).count() as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::{Job, Pixels, View};
    use crate::convert::patches::patch_tile::PatchTileMesh;
    use crate::convert::patches::subpatch::{BezierPatches, PatchSurface};
    use crate::convert::patches::tile;
    use crate::explicit::Patch;

    /// Sixteen patches that share sides, parts of one patch with hills.
    fn patches() -> BezierPatches {
        let mut whole = Patch::flat([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        let heights = [0.0, 0.7, -0.4, 0.1, 0.3, 0.9, -0.8, 0.2, 0.5, -0.6, 0.4, 0.0, -0.2, 0.6, 0.1, 0.3];
        whole
            .control
            .as_flattened_mut()
            .iter_mut()
            .zip(heights)
            .for_each(|(point, height)| point[2] = height);
        let quarters = |patch: &Patch| {
            let halves = patch.halves_u();
            halves.iter().flat_map(Patch::halves_v).collect::<Vec<_>>()
        };
        BezierPatches(quarters(&whole).iter().flat_map(quarters).collect())
    }

    #[test]
    fn kept_tiles_are_those_that_would_be_built() {
        let (surface, job) = (patches(), Job::default());
        let adjacency = surface.adjacency();
        let mesher = PatchMesher::new(&surface, &adjacency, &job);
        let (mut tiles, mut kept) = (None, 0);
        for k in 0..30 {
            let (x, y) = (2.5 - 0.05 * f64::from(k), 0.04 * f64::from(k));
            let view: View = format!("800x600 fov=50 eye={x},{y},0.7 target=0.5,0.5,0").parse().unwrap();
            let allowance = Allowance {
                pixels: Some((Pixels::new(0.5).unwrap(), view.lens())),
                ..Allowance::from_length(f64::MAX)
            };
            let (mesh, made) = mesher.mesh_from(tiles, &allowance).unwrap();
            assert!(mesh.bound.pixels.unwrap() <= 0.5);
            for (index, (place, done)) in made.tiles.iter().enumerate() {
                let anew = tile::build(index, place, &made.subpatches[place.subpatch as usize], &made.seams);
                assert_eq!(anew.triangles, done.triangles);
                let bits = |tile: &PatchTileMesh| {
                    let numbers = [&tile.inner, &tile.inner_normals].map(|list| list.as_flattened().to_vec());
                    numbers.concat().iter().chain([&tile.bound]).map(|x| x.to_bits()).collect::<Vec<_>>()
                };
                assert_eq!(bits(&anew), bits(done), "frame {k}, tile {index}");
                assert!(done.bound <= allowance.at(&done.place).unwrap());
            }
            kept += made.n_kept();
            tiles = Some(made);
        }
        assert!(kept > 100, "{kept}");
    }
}
