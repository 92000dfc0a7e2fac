//! `PatchMesher`: plans tiles for an allowance, proves them, and adds cells until all meet it.
use super::adjacency::{PatchAdjacency, SideBoundary};
use super::allowance::{
    Allowance, InfeasibleTolerance, OutlineAllowance, TessellationFailure, refuse_tolerance,
};
use super::patch_tile::{self, PatchTile, PatchTileMesh};
use super::plan::{self, PlanBefore, TilePlan};
use super::refine::{normal_deviation_ratio, raised_safety_factors, refine_missed};
use super::seams::{SeamLine, SeamSpan, TileSeams};
use super::subpatch::{PatchSurface, Subpatch, SubpatchKind, SubpatchShape};
use super::{assemble, extraordinary_tile, texcoords, tile, tile_border};
use crate::budget::{Bound, Bounded, Failure, Job, Lens, Progress, RefusalCode, par_map};
use crate::check;
use crate::explicit::{Mesh, PatchSide};
use crate::math::{greater, lesser, sub_down};

/// A surface with the data that are needed to mesh it within any allowance.
pub(crate) struct PatchMesher<'a, 's> {
    pub(super) sheets: &'s (dyn PatchSurface<'a> + 's),
    pub(super) adjacency: &'s PatchAdjacency,
    pub(super) job: &'s Job,
}

/// Tiles that are proved to be within their tolerance.
pub(crate) struct CertifiedTiles<'a> {
    pub(super) subpatches: Vec<Subpatch<'a>>,
    pub(super) tiles: Vec<(PatchTile, PatchTileMesh)>,
    pub(super) seams: TileSeams,
    pub(super) safety_factors: Vec<f64>,
}

/// The most refinement rounds. Chosen: three are usual, and every round adds cells where they are
/// missing.
const MOST_ROUNDS: usize = 64;

/// A tile whose safety factor exceeds this will not be proved. Chosen; its square if an angle is limited, since a
/// triangle that is a millionth as long deviates by that much less.
const MOST_STRAIN: f64 = 1e6;

/// Tiles at which a lower bound of the distance is measured, at two points each. Chosen: it costs 20 ns a triangle.
const SAMPLED_TILES: usize = 12;

impl<'a, 's> PatchMesher<'a, 's> {
    pub(crate) fn new(
        sheets: &'s (dyn PatchSurface<'a> + 's),
        adjacency: &'s PatchAdjacency,
        job: &'s Job,
    ) -> Self {
        Self { sheets, adjacency, job }
    }

    /// The longest diagonal of a sheet's hull; 1 if all sheets are points.
    pub(crate) fn longest_diagonal(&self) -> f64 {
        let longest = self.sheets.longest_diagonal();
        if longest > 0.0 { longest } else { 1.0 }
    }

    /// Whether a side of a tile is on a side of its sheet that is one point.
    pub(super) fn has_pole(&self, tile: &PatchTile, side: PatchSide) -> bool {
        let ends = [(tile.v[0], 0.0), (tile.u[1], 1.0), (tile.v[1], 1.0), (tile.u[0], 0.0)];
        let (at, end) = ends[side as usize];
        at == end && matches!(self.adjacency.sides[tile.sheet as usize][side as usize], SideBoundary::Point)
    }

    /// The tiles, after halving those whose normals still miss the limit although they have many cells: their
    /// normals vary in one spot. `None` if there is no such tile.
    fn split_where_normals_deviate(
        &self,
        planned: &TilePlan<'a>,
        done: &[Option<PatchTileMesh>],
        allowance: &Allowance,
    ) -> Option<Vec<PatchTile>> {
        let varies_in_spot = |(tile, done): (&PatchTile, &Option<PatchTileMesh>)| {
            let misses = done.as_ref().is_some_and(|done| normal_deviation_ratio(done, allowance) > 0.0);
            misses && plan::split_tile(tile).len() > 1
        };
        let is_split: Vec<bool> = planned.tiles.iter().zip(done).map(varies_in_spot).collect();
        is_split.contains(&true).then(|| {
            let cut = |(tile, varies_in_spot): (&PatchTile, bool)| {
                if varies_in_spot { plan::split_tile(tile) } else { vec![*tile] }
            };
            planned.tiles.iter().zip(is_split).flat_map(cut).collect()
        })
    }

    /// Builds and proves every tile. A tile that misses its tolerance gets more cells, and it and its
    /// neighbours are built again. Then patches with coinciding edges (two chords between the same two
    /// vertices, which happens when cells are very few) get more cells too.
    pub(crate) fn prove(
        &self,
        planned: TilePlan<'a>,
        allowance: &Allowance,
    ) -> Result<CertifiedTiles<'a>, TessellationFailure> {
        let done = vec![None; planned.tiles.len()];
        self.prove_pending(planned, done, allowance)
    }

    /// [`Self::prove`] for a plan of which some tiles are built and proved already.
    pub(super) fn prove_pending(
        &self,
        mut planned: TilePlan<'a>,
        mut done: Vec<Option<PatchTileMesh>>,
        allowance: &Allowance,
    ) -> Result<CertifiedTiles<'a>, TessellationFailure> {
        for round in 0..MOST_ROUNDS {
            self.check_cells(&planned.tiles)?;
            // Extraordinary subpatches first: if one of them has to be divided, the plan changes, and the other tiles
            // would have been built in vain.
            self.build_pending(&planned, &mut done, allowance, SubpatchKind::Extraordinary)?;
            if let Some(safety_factors) = raised_safety_factors(&planned, &done, allowance) {
                let is_kept = planned.safety_factors.iter().zip(&safety_factors).map(|(old, new)| old == new);
                let before = PlanBefore { is_kept: is_kept.collect(), done, plan: planned };
                (planned, done) = self.plan_from(before, allowance, safety_factors)?;
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
            // Edges are compared only once all tiles have met their tolerance, since tiles to be built again
            // have no triangles.
            if !missed && !self.separate_edges(&mut planned, &mut done) {
                let tiles = planned
                    .tiles
                    .into_iter()
                    .zip(done)
                    .filter_map(|(tile, done)| Some((tile, done?)))
                    .collect();
                let TilePlan { subpatches, seams, safety_factors, .. } = planned;
                return Ok(CertifiedTiles { subpatches, tiles, seams, safety_factors });
            }
            let changed = planned.seams.set_rates(&planned.tiles, &planned.subpatches, self.adjacency);
            done.iter_mut().zip(changed).filter(|(_, changed)| *changed).for_each(|(done, _)| *done = None);
        }
        Err(Failure::refused(
            RefusalCode::BelowPrecision,
            "the budget is so small that rounding hides whether it is met",
        ))
    }

    /// Refuses a plan with too many cells, so that a wrong estimate of a rate cannot cause unlimited work.
    fn check_cells(&self, tiles: &[PatchTile]) -> Result<(), TessellationFailure> {
        let triangles: f64 = tiles.iter().map(|tile| 2.0 * f64::from(tile.n) * f64::from(tile.m)).sum();
        let limit = self.job.triangle_limit as f64;
        // Twice the limit, since strips between tiles of different rates have more or fewer triangles than the cells
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
        let pending: Vec<usize> = (0..tiles.len()).filter(is_open).collect();
        let built = par_map(self.job, &pending, |_, &i| {
            let subpatch = &subpatches[tiles[i].subpatch as usize];
            (!self.job.is_cancelled()).then(|| {
                let done = tile::build(i, &tiles[i], subpatch, seams);
                let turn = allowance
                    .normal_deviation
                    .map(|_| tile::normal_deviation((i, &tiles[i]), subpatch, seams, &done));
                PatchTileMesh { normal_deviation: turn, ..done }
            })
        });
        for (i, built) in pending.iter().zip(built) {
            done[*i] = Some(built.ok_or(Failure::Cancelled)?);
        }
        self.job.report(Progress {
            stage: "tessellate",
            done: tiles.len() as u64,
            total: tiles.len() as u64,
        });
        Ok(())
    }

    /// Adds cells to sheets with a triangle that has a vertex twice, a segment that no triangle covers, or an
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
            // An edge within a tile is in two triangles, and one along a curve is in one triangle of each
            // sheet there. Two curves must not have a segment in common.
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

    /// The segments on shared curves, sorted by their two vertices, with the number of sheets that meet there.
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

    /// Gives tiles the normals on their borders, if they have none yet.
    fn add_normals(&self, proved: &mut CertifiedTiles<'_>) {
        let CertifiedTiles { subpatches, tiles, seams, .. } = proved;
        let pending: Vec<usize> =
            (0..tiles.len()).filter(|i| tiles[*i].1.border_normals.is_empty()).collect();
        let normals = par_map(self.job, &pending, |_, &i| {
            let tile = &tiles[i].0;
            let subpatch = &subpatches[tile.subpatch as usize];
            assemble::normals_on_border(subpatch, self.adjacency, seams, (i, tile))
        });
        pending.into_iter().zip(normals).for_each(|(i, normals)| tiles[i].1.border_normals = normals);
    }

    /// The mesh with its bound; also in pixels, if the allowance has a view.
    pub(crate) fn finish(&self, proved: &mut CertifiedTiles<'_>, allowance: &Allowance) -> Bounded<Mesh> {
        self.add_normals(proved);
        let CertifiedTiles { subpatches, tiles, seams, .. } = proved;
        let (subpatches, tiles, seams) = (&*subpatches, &*tiles, &*seams);
        let most = tiles.iter().fold(0.0, |most, (_, done)| greater(done.bound, most));
        let mesh = assemble::assemble(seams, tiles);
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
            // The distance of two unit vectors is twice the sine of half the angle between them.
            let most = turns.fold(0.0, |most, turn| greater(turn, most));
            2.0 * libm::asin(if most < 2.0 { 0.5 * most } else { 1.0 }).to_degrees()
        });
        bound.pixels = allowance.pixels.and_then(|(_, lens)| {
            tiles.iter().try_fold(0.0, |worst, (_, done)| {
                let pixels = lens.scale_at(&done.place).pixels_of(done.bound)?;
                Some(greater(pixels, worst))
            })
        });
        Bounded { shape: mesh, bound }
    }
}

impl TilePlan<'_> {
    /// The number of triangles of the mesh, if no proof needs more cells.
    pub(crate) fn count(&self, mesher: &PatchMesher<'_, '_>) -> u64 {
        let per_tile = self.tiles.iter().enumerate().map(|(i, tile)| {
            let counts = PatchSide::ALL.map(|side| self.seams.count(i, side));
            let poles = PatchSide::ALL.map(|side| mesher.has_pole(tile, side));
            let is_rough =
                matches!(self.subpatches[tile.subpatch as usize].shape, SubpatchShape::Extraordinary(_));
            if is_rough {
                extraordinary_tile::count_triangles(counts)
            } else {
                patch_tile::count_triangles(tile, counts, poles)
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

    /// The largest bound of the tiles that may contain the outline, as a length and in pixels; `None` if one has no
    /// pixels.
    pub(crate) fn error_at_outline(
        &self,
        outline: &OutlineAllowance,
        lens: Option<&Lens>,
    ) -> (f64, Option<f64>) {
        let (mut length, mut most) = (0.0, lens.map(|_| 0.0));
        for (tile, done) in &self.tiles {
            let subpatch = &self.subpatches[tile.subpatch as usize];
            let SubpatchShape::Bezier(patch) = &subpatch.shape else { continue };
            if outline.is_clear(&subpatch.tile_patch(patch, tile), subpatch.rounding_error()) {
                continue;
            }
            length = greater(done.bound, length);
            let pixels = lens.and_then(|lens| lens.scale_at(&done.place).pixels_of(done.bound));
            most = most.zip(pixels).map(|(most, pixels)| greater(pixels, most));
        }
        (length, most)
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
    let mut rounding = 0.0;
    for &i in order.iter().take(SAMPLED_TILES) {
        let (tile, done) = &tiles[i];
        let subpatch = &subpatches[tile.subpatch as usize];
        let slack = subpatch.rounding_error();
        rounding = greater(slack, rounding);
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
            let least = sub_down(least, rounding);
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
/// tiles with the same two vertices. Only new tiles and those that share two vertices with a new one are examined: for
/// the others an earlier view has shown that no edges coincide.
fn coarse_edges(planned: &TilePlan<'_>, done: &[Option<PatchTileMesh>]) -> Vec<(u32, u32, u32)> {
    let is_new = |index: usize| done[index].as_ref().is_none_or(|done| !done.is_kept);
    let borders: Vec<Vec<u32>> = (0..planned.tiles.len())
        .map(|index| {
            let border = tile_border::border(index, &planned.tiles[index], &planned.seams);
            border.iter().map(|vertex| vertex.id).collect()
        })
        .collect();
    let mut touched = vec![false; planned.seams.positions.len()];
    let new = (0..borders.len()).filter(|index| is_new(*index));
    new.flat_map(|index| &borders[index]).for_each(|vertex| touched[*vertex as usize] = true);
    let is_near = |index: &usize| {
        is_new(*index) || borders[*index].iter().filter(|vertex| touched[**vertex as usize]).count() >= 2
    };
    let near: Vec<usize> = (0..borders.len()).filter(is_near).collect();
    let mut edges: Vec<(u32, u32, u32)> = Vec::new();
    let mut first_inner = planned.seams.positions.len() as u32;
    for &index in &near {
        let tile = &planned.tiles[index];
        let Some(done) = done[index].as_ref().filter(|_| is_coarse(tile)) else { continue };
        // Inner vertices belong to this tile alone: their edges coincide only if the tile's border meets itself.
        let inner = if has_duplicate(borders[index].clone()) { done.inner.len() } else { 0 };
        let ids: Vec<u32> = borders[index].iter().copied().chain((first_inner..).take(inner)).collect();
        first_inner += inner as u32;
        for t in &done.triangles {
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                if let (Some(a), Some(b)) = (ids.get(a as usize), ids.get(b as usize)) {
                    edges.push((*a.min(b), *a.max(b), tile.sheet));
                }
            }
        }
    }
    let n_vertices = first_inner as usize;
    edges = sort_edges(&edges, n_vertices);
    // In other tiles, edges with both ends on the border run along it.
    let n_coarse = edges.len();
    for index in near.into_iter().filter(|index| n_coarse > 0 && !is_coarse(&planned.tiles[*index])) {
        let pieces = PatchSide::ALL.iter().flat_map(|side| planned.seams.chain(index, *side));
        for (a, b) in pieces.flat_map(|(piece, _)| segments(piece)) {
            if edges[..n_coarse].binary_search_by_key(&(a, b), |edge| (edge.0, edge.1)).is_ok() {
                edges.push((a, b, planned.tiles[index].sheet));
            }
        }
    }
    if edges.len() > n_coarse { sort_edges(&edges, n_vertices) } else { edges }
}

/// Sorts edges: first by their first vertex, with a counting sort.
fn sort_edges(edges: &[(u32, u32, u32)], n_vertices: usize) -> Vec<(u32, u32, u32)> {
    let mut sorted = assemble::sort_by_vertex(edges, n_vertices, |edge| edge.0);
    sorted.chunk_by_mut(|a, b| a.0 == b.0).for_each(<[_]>::sort_unstable);
    sorted
}

fn has_duplicate(mut ids: Vec<u32>) -> bool {
    ids.sort_unstable();
    ids.windows(2).any(|pair| pair[0] == pair[1])
}

/// The pairs of neighbouring vertices on a piece, the smaller first; none if the piece is a point.
fn segments(piece: &SeamSpan) -> impl Iterator<Item = (u32, u32)> {
    let pair = |k: u32| (piece.vertex(k), piece.vertex(k + 1));
    (0..piece.n).map(pair).filter(|(a, b)| a != b).map(|(a, b)| (a.min(b), a.max(b)))
}
