//! Bicubic Bézier patches to triangles: adaptive, crack-free by shared index, proved.
use super::patches::plan::{self, Allowance, Probe, Tile};
use super::patches::quilt::Quilt;
use super::patches::seams::Seams;
use super::patches::tile::{self, Done};
use super::patches::{assemble, bend::ROUNDING};
use crate::budget::{Bound, Bounded, Budget, Code, Failure, Job, Progress, Reference, Tolerance, par_map};
use crate::explicit::{Mesh, Patch};
use crate::math::Box3;

type Failed = Failure<Mesh>;

/// PLACEHOLDER
pub fn patches_to_mesh(patches: &[Patch], budget: &Budget, job: &Job) -> Result<Bounded<Mesh>, Failed> {
    check_input(patches, budget)?;
    let patches: Vec<Patch> = patches.iter().map(positive_zeros).collect();
    let mesher = Mesher { quilt: Quilt::new(&patches), patches: &patches, budget, job };
    job.run(|| mesher.run())
}

fn check_input(patches: &[Patch], budget: &Budget) -> Result<(), Failed> {
    if !budget.has_limit() {
        return Err(Failure::refused(
            Code::Budget,
            "a budget needs a length, pixels at a view, or a number of triangles",
        ));
    }
    if budget.angle_deg.is_some() {
        return Err(Failure::refused(
            Code::Unsupported,
            "patches cannot be meshed to an angle yet; use a length or pixels",
        ));
    }
    if patches.is_empty() {
        return Err(Failure::refused(Code::Empty, "there are no patches"));
    }
    if let Some(index) = patches.iter().position(|patch| !patch.is_finite()) {
        return Err(Failure::refused(
            Code::NotFinite,
            format!("patch {index} has a control point that is not finite"),
        ));
    }
    // Second and third derivatives multiply coordinates by up to 150, and squares of them must stay finite.
    if let Some(index) = patches.iter().position(|patch| patch.size() > 1e150) {
        return Err(Failure::refused(Code::NotFinite, format!("patch {index} has coordinates beyond 1e150")));
    }
    Ok(())
}

/// −0 and 0 are the same place; equal bits make equal curves.
fn positive_zeros(patch: &Patch) -> Patch {
    Patch { control: patch.control.map(|row| row.map(|p| p.map(|x| x + 0.0))) }
}

struct Mesher<'a> {
    patches: &'a [Patch],
    quilt: Quilt,
    budget: &'a Budget,
    job: &'a Job,
}

/// Tiles with their seams, not yet proved.
struct Planned {
    tiles: Vec<Tile>,
    seams: Seams,
}

/// Tiles that are proved to be within their tolerance.
struct Proved {
    tiles: Vec<(Tile, Done)>,
    seams: Seams,
}

/// Rounds of asking for more cells; three are usual, and every round adds cells where they lack.
const MOST_ROUNDS: usize = 64;

impl Mesher<'_> {
    fn run(&self) -> Result<Bounded<Mesh>, Failed> {
        let allowance = self.allowance();
        let planned = self.plan(&allowance)?;
        let proved = self.prove(planned)?;
        Ok(self.finish(&proved))
    }

    fn allowance(&self) -> Allowance {
        Allowance {
            length: self.budget.length.map(Tolerance::get),
            pixels: self.budget.pixels.map(|p| (p.pixels, p.view)),
        }
    }

    fn patch_of(&self, tile: &Tile) -> &Patch {
        &self.patches[tile.patch as usize]
    }

    fn plan(&self, allowance: &Allowance) -> Result<Planned, Failed> {
        let cut = par_map(self.job, self.patches, |i, patch| plan::cut(i as u32, patch, allowance));
        let mut tiles = Vec::new();
        for list in cut {
            tiles.extend(list.map_err(|place| too_close(&place))?);
        }
        let mut seams = Seams::new(&self.quilt, &tiles);
        seams.set_rates(&tiles, self.patches, &self.quilt);
        Ok(Planned { tiles, seams })
    }

    /// Builds and proves every tile; a tile that misses its tolerance gets more cells, and it and its neighbours are
    /// built again.
    fn prove(&self, planned: Planned) -> Result<Proved, Failed> {
        let Planned { mut tiles, mut seams } = planned;
        let mut done: Vec<Option<Done>> = vec![None; tiles.len()];
        for round in 0..MOST_ROUNDS {
            let open: Vec<usize> = (0..tiles.len()).filter(|i| done[*i].is_none()).collect();
            let built = par_map(self.job, &open, |_, &i| {
                (!self.job.is_cancelled())
                    .then(|| tile::build(i, &tiles[i], self.patch_of(&tiles[i]), &seams))
            });
            for (i, built) in open.iter().zip(built) {
                done[*i] = Some(built.ok_or(Failure::Cancelled)?);
            }
            let finished = (tiles.len() - open.len()) as u64;
            self.job.report(Progress { stage: "tessellate", done: finished, total: tiles.len() as u64 });
            let failed: Vec<usize> = open
                .into_iter()
                .filter(|&i| {
                    done[i].as_ref().is_some_and(|d| d.bound > tiles[i].tolerance + self.rounding(&tiles[i]))
                })
                .collect();
            if failed.is_empty() {
                let tiles =
                    tiles.into_iter().zip(done).filter_map(|(tile, done)| Some((tile, done?))).collect();
                return Ok(Proved { tiles, seams });
            }
            for &i in &failed {
                let bound = done[i].take().map_or(0.0, |d| d.bound);
                self.ask_for_more(&mut tiles[i], bound, round);
            }
            let changed = seams.set_rates(&tiles, self.patches, &self.quilt);
            done.iter_mut().zip(changed).filter(|(_, changed)| *changed).for_each(|(done, _)| *done = None);
        }
        Err(Failure::refused(
            Code::BelowPrecision,
            "the budget is so small that rounding hides whether it is met",
        ))
    }

    fn rounding(&self, tile: &Tile) -> f64 {
        ROUNDING * self.patch_of(tile).size()
    }

    /// More cells for a tile whose bound came out as `bound`: as many as would have met the tolerance if the probe
    /// had been wrong by as much everywhere, and at least one row or column.
    fn ask_for_more(&self, tile: &mut Tile, bound: f64, round: usize) {
        let part = self.patch_of(tile).part(tile.u, tile.v);
        tile.strain *= bound / tile.tolerance * if round < 3 { 1.01 } else { 1.1 };
        let rates = Probe::new(&part).rates(tile.tolerance / tile.strain);
        let before = (tile.n, tile.m);
        (tile.n, tile.m, tile.rising) = (rates.n.max(tile.n), rates.m.max(tile.m), rates.rising);
        if (tile.n, tile.m) == before {
            if tile.n < tile.m { tile.m += 1 } else { tile.n += 1 }
        }
    }

    fn finish(&self, proved: &Proved) -> Bounded<Mesh> {
        let most = proved
            .tiles
            .iter()
            .fold(0.0, |most, (_, done)| if done.bound > most { done.bound } else { most });
        let mesh = assemble::assemble(self.patches, &self.quilt, &proved.seams, &proved.tiles);
        Bounded { shape: mesh, bound: Bound::proved(0.0, most, Reference::BezierPatches) }
    }
}

fn too_close(place: &Box3) -> Failed {
    let [x, y, z] = place.centre();
    Failure::refused(
        Code::TooClose,
        format!(
            "no length meets the budget near ({x}, {y}, {z}): the eye is too close, or the budget is below rounding"
        ),
    )
}
