//! `PatchMesher`: plans tiles for an allowance, proves them, and adds cells until all meet it.
use super::adjacency::{PatchAdjacency, PatchCorner, SideBoundary};
use super::allowance::{Allowance, InfeasibleTolerance, TessellationFailure, refuse_tolerance};
use super::assemble;
use super::cell_estimate::CellEstimator;
use super::extraordinary_tile;
use super::plan::{self, PatchTile};
use super::refine::{normal_deviation_ratio, raised_safety_factors, refine_missed};
use super::seams::{SeamLine, SeamSpan, TileSeams};
use super::subpatch::{PatchSurface, Subpatch, SubpatchKind, SubpatchShape};
use super::texcoords;
use super::tile::{self, PatchTileMesh};
use super::tile_border;
use super::tile_counts;
use crate::budget::{Bound, Bounded, Failure, Job, Progress, RefusalCode, par_map};
use crate::check;
use crate::explicit::{Mesh, PatchSide};
use crate::math::{greater, lesser, sub_down};

/// A surface with everything that is needed to mesh it within any allowance.
pub(crate) struct PatchMesher<'a> {
    sheets: &'a dyn PatchSurface,
    adjacency: PatchAdjacency,
    job: &'a Job,
}

/// Tiles with their seams, not yet proved.
pub(crate) struct TilePlan<'a> {
    pub(crate) subpatches: Vec<Subpatch<'a>>,
    pub(crate) tiles: Vec<PatchTile>,
    pub(crate) seams: TileSeams,
    /// The fewest cells in each direction, by sheet, that keep edges of different curves apart.
    pub(crate) min_cells: Vec<u32>,
    /// By sheet: how much worse the proof of extraordinary subpatches was than expected; 1 at first.
    pub(crate) safety_factors: Vec<f64>,
}

/// Tiles that are proved to be within their tolerance.
pub(crate) struct CertifiedTiles<'a> {
    subpatches: Vec<Subpatch<'a>>,
    tiles: Vec<(PatchTile, PatchTileMesh)>,
    seams: TileSeams,
}

/// The largest number of refinement rounds; three are usual, and every round adds cells where they are
/// missing.
const MOST_ROUNDS: usize = 64;

/// A proof that was this much worse than its estimate will not succeed. Its square where an angle is limited:
/// a triangle that is a millionth as long as another deviates by that much less.
const MOST_STRAIN: f64 = 1e6;

/// Tiles at which the distance is measured from below, at two points each: 20 ns a triangle.
const SAMPLED_TILES: usize = 12;

impl<'a> PatchMesher<'a> {
    pub(crate) fn new(sheets: &'a dyn PatchSurface, job: &'a Job) -> Self {
        Self { sheets, adjacency: sheets.adjacency(), job }
    }

    /// The longest diagonal of a sheet's hull; 1 where all sheets are points.
    pub(crate) fn longest_diagonal(&self) -> f64 {
        let longest = self.sheets.longest_diagonal();
        if longest > 0.0 { longest } else { 1.0 }
    }

    /// Whether a side of a tile is on a side of its sheet that is one point.
    fn has_pole(&self, tile: &PatchTile, side: PatchSide) -> bool {
        let ends = [(tile.v[0], 0.0), (tile.u[1], 1.0), (tile.v[1], 1.0), (tile.u[0], 0.0)];
        let (at, end) = ends[side as usize];
        at == end && matches!(self.adjacency.sides[tile.sheet as usize][side as usize], SideBoundary::Point)
    }

    /// About how many triangles an allowance needs; cheap where that is fewer than `enough`.
    pub(crate) fn estimate(&self, allowance: &Allowance, enough: f64) -> Result<f64, TessellationFailure> {
        let numbers: Vec<usize> = (0..self.sheets.count()).collect();
        let over = |one: &(dyn Fn(&Subpatch<'_>) -> Result<f64, InfeasibleTolerance> + Sync)| {
            total(par_map(self.job, &numbers, |_, &sheet| {
                self.sheets
                    .subpatches(sheet, allowance, 1.0)?
                    .iter()
                    .try_fold(0.0, |sum, subpatch| Ok(sum + one(subpatch)?))
            }))
        };
        let extraordinary = over(&|subpatch| {
            let SubpatchShape::Bezier(patch) = &subpatch.shape else { return Ok(2.0) };
            let tolerance = plan::tolerance(patch.bounds(), allowance, subpatch.rounding_error())?;
            Ok(2.0 * CellEstimator::new(patch).estimate(tolerance).cells)
        })?;
        if extraordinary < enough {
            return Ok(extraordinary);
        }
        over(&|subpatch| plan::estimate(subpatch, allowance))
    }

    /// Tiles and rates for an allowance.
    pub(crate) fn plan(&self, allowance: &Allowance) -> Result<TilePlan<'a>, TessellationFailure> {
        self.plan_with_safety_factors(allowance, vec![1.0; self.sheets.count()], None)
    }

    /// Plans with these safety factors. Sheets whose factor has not changed are taken from the plan `before`.
    fn plan_with_safety_factors(
        &self,
        allowance: &Allowance,
        safety_factors: Vec<f64>,
        before: Option<TilePlan<'a>>,
    ) -> Result<TilePlan<'a>, TessellationFailure> {
        type SheetTiles<'a> = (Vec<Subpatch<'a>>, Vec<PatchTile>);
        let mut cut: Vec<SheetTiles<'a>> = (0..safety_factors.len()).map(|_| Default::default()).collect();
        if let Some(before) = before {
            let is_kept =
                |sheet: u32| before.safety_factors[sheet as usize] == safety_factors[sheet as usize];
            // The subpatches are listed sheet by sheet.
            let mut begin = vec![0; safety_factors.len()];
            for (index, subpatch) in before.subpatches.into_iter().enumerate() {
                let own = &mut cut[subpatch.sheet as usize].0;
                if own.is_empty() {
                    begin[subpatch.sheet as usize] = index as u32;
                }
                if is_kept(subpatch.sheet) {
                    own.push(subpatch);
                }
            }
            for tile in before.tiles.into_iter().filter(|tile| is_kept(tile.sheet)) {
                let subpatch = tile.subpatch - begin[tile.sheet as usize];
                cut[tile.sheet as usize].1.push(PatchTile { subpatch, ..tile });
            }
        }
        let open: Vec<usize> = (0..safety_factors.len()).filter(|sheet| cut[*sheet].0.is_empty()).collect();
        let made = par_map(self.job, &open, |_, &sheet| {
            if self.job.is_cancelled() {
                return Ok((Vec::new(), Vec::new()));
            }
            let subpatches = self.sheets.subpatches(sheet, allowance, safety_factors[sheet])?;
            let mut tiles = Vec::new();
            for (index, subpatch) in subpatches.iter().enumerate() {
                let begin = tiles.len();
                tiles.extend(plan::split_into_tiles(subpatch, allowance)?);
                tiles[begin..].iter_mut().for_each(|tile| tile.subpatch = index as u32);
            }
            Ok((subpatches, tiles))
        });
        if self.job.is_cancelled() {
            return Err(Failure::Cancelled);
        }
        for (sheet, made) in open.into_iter().zip(made) {
            cut[sheet] = made.map_err(refuse_tolerance)?;
        }
        let (mut subpatches, mut tiles) = (Vec::new(), Vec::new());
        for (own, cut) in cut {
            let begin = subpatches.len() as u32;
            subpatches.extend(own);
            tiles.extend(cut.into_iter().map(|tile| PatchTile { subpatch: begin + tile.subpatch, ..tile }));
        }
        Ok(self.lay_seams(subpatches, tiles, safety_factors))
    }

    /// Builds the seams between the tiles.
    fn lay_seams(
        &self,
        subpatches: Vec<Subpatch<'a>>,
        mut tiles: Vec<PatchTile>,
        safety_factors: Vec<f64>,
    ) -> TilePlan<'a> {
        for tile in &mut tiles {
            let ends = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| (tile.u[i], tile.v[j]));
            let known = self.adjacency.corner_kinds[tile.sheet as usize];
            let places = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
            let poles = PatchSide::ALL.map(|side| self.has_pole(tile, side));
            tile.corners = std::array::from_fn(|k| match known[k] {
                kind if kind != PatchCorner::Plain && ends[k] == places[k] => kind,
                // All vertices of a pole are one, so edges from any of them coincide.
                _ if poles[k] || poles[(k + 3) % 4] => PatchCorner::Whole,
                _ => PatchCorner::Plain,
            });
        }
        let mut seams = TileSeams::new(&self.adjacency, &tiles);
        seams.set_rates(&tiles, &subpatches, &self.adjacency);
        let least = vec![1; self.sheets.count()];
        TilePlan { subpatches, tiles, seams, min_cells: least, safety_factors }
    }

    /// The tiles, with those halved whose normals still miss the limit although they have many cells: their
    /// normals vary in one spot. `None` where there is no such tile.
    fn split_where_normals_deviate(
        &self,
        planned: &TilePlan<'a>,
        done: &[Option<PatchTileMesh>],
        allowance: &Allowance,
    ) -> Option<Vec<PatchTile>> {
        let is_odd = |(tile, done): (&PatchTile, &Option<PatchTileMesh>)| {
            let misses = done.as_ref().is_some_and(|done| normal_deviation_ratio(done, allowance) > 0.0);
            misses && plan::split_tile(tile).len() > 1
        };
        let odd: Vec<bool> = planned.tiles.iter().zip(done).map(is_odd).collect();
        odd.contains(&true).then(|| {
            let cut = |(tile, is_odd): (&PatchTile, bool)| {
                if is_odd { plan::split_tile(tile) } else { vec![*tile] }
            };
            planned.tiles.iter().zip(odd).flat_map(cut).collect()
        })
    }

    /// Builds and proves every tile. A tile that misses its tolerance gets more cells, and it and its
    /// neighbours are built again. Then patches with coinciding edges (two chords between the same two
    /// vertices, which happens when cells are very few) get more cells too.
    pub(crate) fn prove(
        &self,
        mut planned: TilePlan<'a>,
        allowance: &Allowance,
    ) -> Result<CertifiedTiles<'a>, TessellationFailure> {
        let mut done: Vec<Option<PatchTileMesh>> = vec![None; planned.tiles.len()];
        for round in 0..MOST_ROUNDS {
            self.check_cells(&planned.tiles)?;
            // Extraordinary subpatches first: while one of them has to be divided, the others would be built
            // in vain.
            self.build_pending(&planned, &mut done, allowance, SubpatchKind::Extraordinary)?;
            if let Some(safety_factors) = raised_safety_factors(&planned, &done, allowance) {
                planned = self.plan_with_safety_factors(allowance, safety_factors, Some(planned))?;
                done = vec![None; planned.tiles.len()];
                continue;
            }
            self.build_pending(&planned, &mut done, allowance, SubpatchKind::Bezier)?;
            if let Some(tiles) = self.split_where_normals_deviate(&planned, &done, allowance) {
                planned = self.lay_seams(planned.subpatches, tiles, planned.safety_factors);
                done = vec![None; planned.tiles.len()];
                continue;
            }
            let missed = refine_missed(&mut planned, &mut done, round, allowance);
            let most =
                if allowance.normal_deviation.is_some() { MOST_STRAIN * MOST_STRAIN } else { MOST_STRAIN };
            if let Some(tile) = planned.tiles.iter().find(|tile| tile.safety_factor > most) {
                let subpatch = &planned.subpatches[tile.subpatch as usize];
                if allowance.normal_deviation.is_some() {
                    return Err(refuse_tolerance(InfeasibleTolerance::NoConvergence(subpatch.hull(tile))));
                }
                break;
            }
            let cells: f64 = planned.tiles.iter().map(|tile| f64::from(tile.n) * f64::from(tile.m)).sum();
            if cells > self.job.triangle_limit as f64 {
                let message = format!(
                    "the budget needs more than {:.1e} triangles, the limit",
                    self.job.triangle_limit
                );
                return Err(Failure::refused(RefusalCode::TooManyTriangles, message));
            }
            if !missed && !self.separate_edges(&mut planned, &mut done) {
                let tiles = planned
                    .tiles
                    .into_iter()
                    .zip(done)
                    .filter_map(|(tile, done)| Some((tile, done?)))
                    .collect();
                return Ok(CertifiedTiles { subpatches: planned.subpatches, tiles, seams: planned.seams });
            }
            let changed = planned.seams.set_rates(&planned.tiles, &planned.subpatches, &self.adjacency);
            done.iter_mut().zip(changed).filter(|(_, changed)| *changed).for_each(|(done, _)| *done = None);
        }
        Err(Failure::refused(
            RefusalCode::BelowPrecision,
            "the budget is so small that rounding hides whether it is met",
        ))
    }

    /// Refuses a plan with too many cells, so that a wrong estimate of a rate cannot let the work run away.
    fn check_cells(&self, tiles: &[PatchTile]) -> Result<(), TessellationFailure> {
        let triangles: f64 = tiles.iter().map(|tile| 2.0 * f64::from(tile.n) * f64::from(tile.m)).sum();
        let limit = self.job.triangle_limit as f64;
        // Twice, since strips between tiles of different rates have more or fewer triangles than the cells
        // there.
        if triangles > 2.0 * limit {
            let message =
                format!("the budget needs about {triangles:.1e} triangles; the limit is {limit:.1e}");
            return Err(Failure::refused(RefusalCode::TooManyTriangles, message));
        }
        Ok(())
    }

    fn build_pending(
        &self,
        planned: &TilePlan<'_>,
        done: &mut [Option<PatchTileMesh>],
        allowance: &Allowance,
        kind: SubpatchKind,
    ) -> Result<(), TessellationFailure> {
        let TilePlan { subpatches, tiles, seams, .. } = planned;
        let is_open =
            |i: &usize| done[*i].is_none() && subpatches[tiles[*i].subpatch as usize].kind() == kind;
        let open: Vec<usize> = (0..tiles.len()).filter(is_open).collect();
        let built = par_map(self.job, &open, |_, &i| {
            let subpatch = &subpatches[tiles[i].subpatch as usize];
            (!self.job.is_cancelled()).then(|| {
                let done = tile::build(i, &tiles[i], subpatch, seams);
                let turn = allowance
                    .normal_deviation
                    .map(|_| tile::normal_deviation((i, &tiles[i]), subpatch, seams, &done));
                PatchTileMesh { normal_deviation: turn, ..done }
            })
        });
        for (i, built) in open.iter().zip(built) {
            done[*i] = Some(built.ok_or(Failure::Cancelled)?);
        }
        self.job.report(Progress {
            stage: "tessellate",
            done: tiles.len() as u64,
            total: tiles.len() as u64,
        });
        Ok(())
    }

    /// Adds cells to sheets with a triangle that has a vertex twice, a segment that no triangle has, or an
    /// edge that coincides with another. Returns whether there were any. Three cells in each direction with
    /// whole corners are always enough, so few tiles are examined.
    fn separate_edges(&self, planned: &mut TilePlan<'_>, done: &mut [Option<PatchTileMesh>]) -> bool {
        let tiles = planned.tiles.iter().zip(done.iter());
        let too_few = tiles.filter(|(_, done)| done.as_ref().is_some_and(|done| done.too_few));
        let mut again: Vec<u32> = too_few.map(|(tile, _)| tile.sheet).collect();
        let coarse = coarse_edges(planned, done);
        let shared = if coarse.is_empty() { Vec::new() } else { self.shared_segments(&planned.seams) };
        for run in coarse.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let key = (run[0].0, run[0].1);
            let curves = &shared[shared.partition_point(|s| (s.0, s.1) < key)..];
            let allowed = match curves.iter().take_while(|s| (s.0, s.1) == key).collect::<Vec<_>>()[..] {
                [] => 2,
                [one] => one.2,
                _ => 0,
            };
            if run.len() > allowed {
                again.extend(run.iter().map(|edge| edge.2));
            }
        }
        again.sort_unstable();
        again.dedup();
        again.iter().for_each(|sheet| planned.min_cells[*sheet as usize] += 1);
        for (tile, done) in planned.tiles.iter_mut().zip(done) {
            let least = planned.min_cells[tile.sheet as usize];
            if tile.n < least || tile.m < least {
                (tile.n, tile.m) = (tile.n.max(least), tile.m.max(least));
                *done = None;
            }
        }
        !again.is_empty()
    }

    /// Segments on shared curves, sorted by their two vertices, with the number of sheets that meet there.
    fn shared_segments(&self, seams: &TileSeams) -> Vec<(u32, u32, usize)> {
        let mut list = Vec::new();
        for piece in &seams.pieces {
            let SeamLine::Edge(edge) = piece.line else { continue };
            let uses = self.adjacency.edges[edge as usize].uses.len();
            list.extend(segments(piece).map(|(a, b)| (a, b, uses)));
        }
        list.sort_unstable();
        list
    }

    /// The mesh with its bound; pixels at the view of the allowance.
    pub(crate) fn finish(&self, proved: &CertifiedTiles<'_>, allowance: &Allowance) -> Bounded<Mesh> {
        let CertifiedTiles { subpatches, tiles, seams } = proved;
        let most = tiles.iter().fold(0.0, |most, (_, done)| greater(done.bound, most));
        let mesh = assemble::assemble(subpatches, &self.adjacency, seams, tiles);
        let mesh = texcoords::with_texcoords(mesh, self.sheets, subpatches, seams, tiles, self.job);
        let (least, at) = measure_lower_bound(subpatches, tiles, &mesh);
        let least = lesser(least, most);
        let mut bound = Bound::proved(least, most, self.sheets.reference());
        bound.at = at;
        bound.angle_deg = allowance.normal_deviation.map(|_| {
            let turns = tiles.iter().enumerate().map(|(i, (tile, done))| {
                let subpatch = &subpatches[tile.subpatch as usize];
                done.normal_deviation
                    .unwrap_or_else(|| tile::normal_deviation((i, tile), subpatch, seams, done))
            });
            let most = turns.fold(0.0, |most, turn| greater(turn, most));
            2.0 * libm::asin(if most < 2.0 { 0.5 * most } else { 1.0 }).to_degrees()
        });
        bound.pixels = allowance.pixels.and_then(|(_, lens)| {
            tiles.iter().try_fold(0.0, |worst, (tile, done)| {
                let place = subpatches[tile.subpatch as usize].hull(tile);
                let pixels = lens.scale_at(&place).pixels_of(done.bound)?;
                Some(greater(pixels, worst))
            })
        });
        Bounded { shape: mesh, bound }
    }
}

impl TilePlan<'_> {
    /// The number of triangles of the mesh, unless a proof needs more cells.
    pub(crate) fn count(&self, mesher: &PatchMesher<'_>) -> u64 {
        let per_tile = self.tiles.iter().enumerate().map(|(i, tile)| {
            let counts = PatchSide::ALL.map(|side| self.seams.count(i, side));
            let poles = PatchSide::ALL.map(|side| mesher.has_pole(tile, side));
            let is_rough =
                matches!(self.subpatches[tile.subpatch as usize].shape, SubpatchShape::Extraordinary(_));
            if is_rough {
                extraordinary_tile::count_triangles(counts)
            } else {
                tile_counts::count_triangles(tile, counts, poles)
            }
        });
        per_tile.sum()
    }
}

impl CertifiedTiles<'_> {
    /// The number of its triangles.
    pub(crate) fn count(&self) -> u64 {
        self.tiles.iter().map(|(_, done)| done.triangles.len() as u64).sum()
    }

    /// The largest bound of its tiles.
    pub(crate) fn bound(&self) -> f64 {
        self.tiles.iter().fold(0.0, |most, (_, done)| greater(done.bound, most))
    }
}

/// The measured lower bound of the distance and its location: at the middles of the worst triangles and of
/// their sides.
fn measure_lower_bound(
    subpatches: &[Subpatch<'_>],
    tiles: &[(PatchTile, PatchTileMesh)],
    mesh: &Mesh,
) -> (f64, Option<[f64; 3]>) {
    let mut order: Vec<usize> = (0..tiles.len()).collect();
    order.sort_by(|a, b| tiles[*b].1.bound.total_cmp(&tiles[*a].1.bound).then(a.cmp(b)));
    let mut samples = Vec::new();
    let mut off = 0.0;
    for &i in order.iter().take(SAMPLED_TILES) {
        let (tile, done) = &tiles[i];
        let subpatch = &subpatches[tile.subpatch as usize];
        let slack = subpatch.rounding_error();
        off = greater(slack, off);
        let [a, b, c] = done.worst;
        // The bound is reached in the middle of a triangle or of the side that is longest in parameters.
        let length_sq =
            |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]);
        let sides = [(a, b), (b, c), (c, a)];
        let longest =
            sides.into_iter().reduce(|s, t| if length_sq(s.0, s.1) < length_sq(t.0, t.1) { t } else { s });
        let (p, q) = longest.unwrap_or((a, b));
        samples.push(subpatch.at(0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])));
        samples.push(subpatch.at((a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0));
    }
    match check::surface_at_least(&samples, mesh) {
        Some((least, at)) => {
            let least = sub_down(least, off);
            (greater(least, 0.0), Some(samples[at]))
        }
        None => (0.0, samples.first().copied()),
    }
}

/// Whether a tile has so few cells that its edges may coincide.
fn is_coarse(tile: &PatchTile) -> bool {
    tile.n < 3 || tile.m < 3
}

/// The edges in coarse tiles that may coincide with others, sorted, with their patch, and the edges of other
/// tiles with the same two vertices.
fn coarse_edges(planned: &TilePlan<'_>, done: &[Option<PatchTileMesh>]) -> Vec<(u32, u32, u32)> {
    let mut edges: Vec<(u32, u32, u32)> = Vec::new();
    let mut first_inner = planned.seams.positions.len() as u32;
    for (index, (tile, done)) in planned.tiles.iter().zip(done).enumerate() {
        let Some(done) = done.as_ref().filter(|_| is_coarse(tile)) else { continue };
        let border: Vec<u32> =
            tile_border::border(index, tile, &planned.seams).iter().map(|vertex| vertex.id).collect();
        // Inner vertices belong to this tile alone: their edges coincide only where its border meets itself.
        let inner = if has_duplicate(border.clone()) { done.inner.len() } else { 0 };
        let ids: Vec<u32> = border.into_iter().chain((first_inner..).take(inner)).collect();
        first_inner += inner as u32;
        for t in &done.triangles {
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                if let (Some(a), Some(b)) = (ids.get(a as usize), ids.get(b as usize)) {
                    edges.push((*a.min(b), *a.max(b), tile.sheet));
                }
            }
        }
    }
    edges.sort_unstable();
    // Other tiles have edges with both ends on their border only along it.
    let known = edges.len();
    for (index, tile) in planned.tiles.iter().enumerate().filter(|(_, tile)| known > 0 && !is_coarse(tile)) {
        let pieces = PatchSide::ALL.iter().flat_map(|side| planned.seams.chain(index, *side));
        for (a, b) in pieces.flat_map(|(piece, _)| segments(piece)) {
            if edges[..known].binary_search_by_key(&(a, b), |edge| (edge.0, edge.1)).is_ok() {
                edges.push((a, b, tile.sheet));
            }
        }
    }
    edges.sort_unstable();
    edges
}

fn has_duplicate(mut ids: Vec<u32>) -> bool {
    ids.sort_unstable();
    ids.windows(2).any(|pair| pair[0] == pair[1])
}

/// The pairs of neighbouring vertices on a piece, the smaller first; none where the piece is a point.
fn segments(piece: &SeamSpan) -> impl Iterator<Item = (u32, u32)> {
    let pair = |k: u32| (piece.vertex(k), piece.vertex(k + 1));
    (0..piece.n).map(pair).filter(|(a, b)| a != b).map(|(a, b)| (a.min(b), a.max(b)))
}

fn total(parts: Vec<Result<f64, InfeasibleTolerance>>) -> Result<f64, TessellationFailure> {
    parts.into_iter().try_fold(0.0, |sum, part| Ok(sum + part.map_err(refuse_tolerance)?))
}
