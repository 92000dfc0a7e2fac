//! `Mesher`: plans tiles for an allowance, proves them, and asks for more cells until all hold.
use super::assemble;
use super::bend::rounding;
use super::plan::{self, Allowance, Obstacle, Tile};
use super::probe::Probe;
use super::quilt::{Corner, Quilt, Seam};
use super::seams::{Line, Piece, Seams};
use super::tile::{self, Done};
use crate::budget::{Bound, Bounded, Code, Failure, Job, Progress, Reference, par_map};
use crate::check;
use crate::explicit::{Mesh, Patch, Side};
use crate::math::{Box3, sub_down};

pub(crate) type Failed = Failure<Mesh>;

/// The patches with what is needed to mesh them to any allowance.
pub(crate) struct Mesher<'a> {
    patches: &'a [Patch],
    quilt: Quilt,
    job: &'a Job,
}

/// Tiles with their seams, not yet proved.
pub(crate) struct Planned {
    tiles: Vec<Tile>,
    seams: Seams,
    /// Fewest cells each way, by patch, that keep edges of different curves apart.
    least: Vec<u32>,
}

/// Tiles that are proved to be within their tolerance.
pub(crate) struct Proved {
    tiles: Vec<(Tile, Done)>,
    seams: Seams,
}

/// Rounds of asking for more cells; three are usual, and every round adds cells where they lack.
const MOST_ROUNDS: usize = 64;

/// A proof that came out this much worse than its probe will not come out.
const MOST_STRAIN: f64 = 1e6;

/// Tiles at which the distance is measured from below, at two places each: 20 ns a triangle.
const SAMPLED_TILES: usize = 12;

impl<'a> Mesher<'a> {
    pub(crate) fn new(patches: &'a [Patch], job: &'a Job) -> Self {
        Self { patches, quilt: Quilt::new(patches), job }
    }

    /// The longest diagonal of a patch's hull; 1 where all patches are points.
    pub(crate) fn longest_diagonal(&self) -> f64 {
        // No shorter than what rounding may lose, so that patches that are all but points meet the first rung.
        let own = |patch: &Patch| {
            let (diagonal, lost) = (patch.hull().diagonal(), rounding(patch));
            if diagonal > lost { diagonal } else { lost }
        };
        let longest = self.patches.iter().map(own);
        let longest = longest.fold(0.0, |longest, d| if d > longest { d } else { longest });
        if longest > 0.0 { longest } else { 1.0 }
    }

    fn patch_of(&self, tile: &Tile) -> &Patch {
        &self.patches[tile.patch as usize]
    }

    /// Whether a side of a tile is on a side of its patch that is one point.
    fn has_pole(&self, tile: &Tile, side: Side) -> bool {
        let ends = [(tile.v[0], 0.0), (tile.u[1], 1.0), (tile.v[1], 1.0), (tile.u[0], 0.0)];
        let (at, end) = ends[side as usize];
        at == end && matches!(self.quilt.seams[tile.patch as usize][side as usize], Seam::Point)
    }

    /// About how many triangles an allowance needs; cheap where that is fewer than `enough`.
    pub(crate) fn estimate(&self, allowance: &Allowance, enough: f64) -> Result<f64, Failed> {
        let rough = par_map(self.job, self.patches, |_, patch| {
            let tolerance = plan::tolerance(patch, (allowance, rounding(patch)))?;
            Ok(2.0 * Probe::new(patch).need(tolerance).cells)
        });
        let rough = total(rough)?;
        if rough < enough {
            return Ok(rough);
        }
        total(par_map(self.job, self.patches, |_, patch| plan::estimate(patch, allowance)))
    }

    /// Tiles and rates for an allowance.
    pub(crate) fn plan(&self, allowance: &Allowance) -> Result<Planned, Failed> {
        let cut = par_map(self.job, self.patches, |i, patch| {
            if self.job.is_cancelled() { Ok(Vec::new()) } else { plan::cut(i as u32, patch, allowance) }
        });
        if self.job.is_cancelled() {
            return Err(Failure::Cancelled);
        }
        let mut tiles = Vec::new();
        for list in cut {
            tiles.extend(list.map_err(refuse)?);
        }
        for tile in &mut tiles {
            let ends = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| (tile.u[i], tile.v[j]));
            let known = self.quilt.meetings[tile.patch as usize];
            let places = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
            let poles = Side::ALL.map(|side| self.has_pole(tile, side));
            tile.corners = std::array::from_fn(|k| match known[k] {
                kind if kind != Corner::Plain && ends[k] == places[k] => kind,
                // All vertices of a pole are one: an edge from any of them is one edge.
                _ if poles[k] || poles[(k + 3) % 4] => Corner::Whole,
                _ => Corner::Plain,
            });
        }
        let mut seams = Seams::new(&self.quilt, &tiles);
        seams.set_rates(&tiles, self.patches, &self.quilt);
        Ok(Planned { tiles, seams, least: vec![1; self.patches.len()] })
    }

    /// Builds and proves every tile; a tile that misses its tolerance gets more cells, and it and its neighbours are
    /// built again. Then patches whose edges fall together (two chords between the same two vertices, which happens
    /// when cells are very few) get more cells too.
    pub(crate) fn prove(&self, mut planned: Planned) -> Result<Proved, Failed> {
        let mut done: Vec<Option<Done>> = vec![None; planned.tiles.len()];
        for round in 0..MOST_ROUNDS {
            self.check_cells(&planned.tiles)?;
            self.build_open(&planned, &mut done)?;
            let missed = self.ask_for_more(&mut planned.tiles, &mut done, round);
            if planned.tiles.iter().any(|tile| tile.strain > MOST_STRAIN) {
                break;
            }
            let cells: f64 = planned.tiles.iter().map(|tile| f64::from(tile.n) * f64::from(tile.m)).sum();
            if cells > self.job.triangle_limit as f64 {
                let message = format!(
                    "the budget needs more than {:.1e} triangles, the limit",
                    self.job.triangle_limit
                );
                return Err(Failure::refused(Code::TooManyTriangles, message));
            }
            if !missed && !self.part_edges(&mut planned, &mut done) {
                let tiles = planned
                    .tiles
                    .into_iter()
                    .zip(done)
                    .filter_map(|(tile, done)| Some((tile, done?)))
                    .collect();
                return Ok(Proved { tiles, seams: planned.seams });
            }
            let changed = planned.seams.set_rates(&planned.tiles, self.patches, &self.quilt);
            done.iter_mut().zip(changed).filter(|(_, changed)| *changed).for_each(|(done, _)| *done = None);
        }
        Err(Failure::refused(
            Code::BelowPrecision,
            "the budget is so small that rounding hides whether it is met",
        ))
    }

    /// That no guess of a rate, however wrong, lets the work run away.
    fn check_cells(&self, tiles: &[Tile]) -> Result<(), Failed> {
        let triangles: f64 = tiles.iter().map(|tile| 2.0 * f64::from(tile.n) * f64::from(tile.m)).sum();
        let limit = self.job.triangle_limit as f64;
        // Twice, since strips between tiles of unlike rates have more or fewer triangles than the cells there.
        if triangles > 2.0 * limit {
            let message =
                format!("the budget needs about {triangles:.1e} triangles; the limit is {limit:.1e}");
            return Err(Failure::refused(Code::TooManyTriangles, message));
        }
        Ok(())
    }

    fn build_open(&self, planned: &Planned, done: &mut [Option<Done>]) -> Result<(), Failed> {
        let Planned { tiles, seams, .. } = planned;
        let open: Vec<usize> = (0..tiles.len()).filter(|i| done[*i].is_none()).collect();
        let built = par_map(self.job, &open, |_, &i| {
            (!self.job.is_cancelled()).then(|| tile::build(i, &tiles[i], self.patch_of(&tiles[i]), seams))
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

    /// More cells for every tile that misses its tolerance: as many as would have met it if the probe had been
    /// wrong by as much everywhere, and at least one row or column. Whether there was any.
    fn ask_for_more(&self, tiles: &mut [Tile], done: &mut [Option<Done>], round: usize) -> bool {
        let mut missed = false;
        for (tile, slot) in tiles.iter_mut().zip(done) {
            let patch = self.patch_of(tile);
            let rounding = rounding(patch);
            let allowed = tile.tolerance + rounding;
            let Some(bound) = slot.as_ref().map(|done| done.bound).filter(|bound| *bound > allowed) else {
                continue;
            };
            missed = true;
            *slot = None;
            tile.strain *= (bound - rounding) / tile.tolerance * if round < 3 { 1.01 } else { 1.1 };
            let probe = Probe::new(&patch.part(tile.u, tile.v));
            let wanted = tile.tolerance / tile.strain;
            let rates = probe.rates(&probe.need(wanted), wanted);
            let before = (tile.n, tile.m);
            (tile.n, tile.m, tile.rising) = (rates.n.max(tile.n), rates.m.max(tile.m), rates.rising);
            if (tile.n, tile.m) == before {
                *(if tile.n < tile.m { &mut tile.m } else { &mut tile.n }) += 1;
            }
        }
        missed
    }

    /// More cells for patches with a triangle that has a vertex twice, a segment that no triangle has, or an edge that
    /// is not only its own. Whether there was any. Three cells each way with their corners whole are always enough, so
    /// few are looked at.
    fn part_edges(&self, planned: &mut Planned, done: &mut [Option<Done>]) -> bool {
        let tiles = planned.tiles.iter().zip(done.iter());
        let too_few = tiles.filter(|(_, done)| done.as_ref().is_some_and(|done| done.too_few));
        let mut again: Vec<u32> = too_few.map(|(tile, _)| tile.patch).collect();
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
        again.iter().for_each(|patch| planned.least[*patch as usize] += 1);
        for (tile, done) in planned.tiles.iter_mut().zip(done) {
            let least = planned.least[tile.patch as usize];
            if tile.n < least || tile.m < least {
                (tile.n, tile.m) = (tile.n.max(least), tile.m.max(least));
                *done = None;
            }
        }
        !again.is_empty()
    }

    /// Segments on shared curves, sorted by their two vertices, with the number of patches that meet there.
    fn shared_segments(&self, seams: &Seams) -> Vec<(u32, u32, usize)> {
        let mut list = Vec::new();
        for piece in &seams.pieces {
            let Line::Edge(edge) = piece.line else { continue };
            let uses = self.quilt.edges[edge as usize].uses.len();
            list.extend(segments(piece).map(|(a, b)| (a, b, uses)));
        }
        list.sort_unstable();
        list
    }

    /// The mesh with its bound; pixels at the view of the allowance.
    pub(crate) fn finish(&self, proved: &Proved, allowance: &Allowance) -> Bounded<Mesh> {
        let Proved { tiles, seams } = proved;
        let most =
            tiles.iter().fold(0.0, |most, (_, done)| if done.bound > most { done.bound } else { most });
        let mesh = assemble::assemble(self.patches, &self.quilt, seams, tiles);
        let (least, at) = self.measure(tiles, &mesh);
        let least = if least < most { least } else { most };
        let mut bound = Bound::proved(least, most, Reference::BezierPatches);
        bound.at = at;
        bound.pixels = allowance.pixels.and_then(|(_, lens)| {
            tiles.iter().try_fold(0.0, |worst, (tile, done)| {
                let place = self.patch_of(tile).part(tile.u, tile.v).hull();
                let pixels = lens.sight(&place).pixels_of(done.bound)?;
                Some(if pixels > worst { pixels } else { worst })
            })
        });
        Bounded { shape: mesh, bound }
    }

    /// The distance from below and its place: at the middles of the worst triangles and of their sides.
    fn measure(&self, tiles: &[(Tile, Done)], mesh: &Mesh) -> (f64, Option<[f64; 3]>) {
        let mut order: Vec<usize> = (0..tiles.len()).collect();
        order.sort_by(|a, b| tiles[*b].1.bound.total_cmp(&tiles[*a].1.bound).then(a.cmp(b)));
        let mut samples = Vec::new();
        let mut off = 0.0;
        for &i in order.iter().take(SAMPLED_TILES) {
            let (tile, done) = &tiles[i];
            let patch = self.patch_of(tile);
            let slack = rounding(patch);
            off = if slack > off { slack } else { off };
            let [a, b, c] = done.worst;
            // The bound is reached in the middle of a triangle or of the side that is longest in parameters.
            let length_sq =
                |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]);
            let sides = [(a, b), (b, c), (c, a)];
            let longest = sides
                .into_iter()
                .reduce(|s, t| if length_sq(s.0, s.1) < length_sq(t.0, t.1) { t } else { s });
            let (p, q) = longest.unwrap_or((a, b));
            samples.push(patch.at(0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])));
            samples.push(patch.at((a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0));
        }
        match check::surface_at_least(&samples, mesh) {
            Some((least, at)) => {
                let least = sub_down(least, off);
                (if least > 0.0 { least } else { 0.0 }, Some(samples[at]))
            }
            None => (0.0, samples.first().copied()),
        }
    }
}

impl Planned {
    /// The number of triangles that it will have, unless a proof asks for more.
    pub(crate) fn count(&self, mesher: &Mesher<'_>) -> u64 {
        let per_tile = self.tiles.iter().enumerate().map(|(i, tile)| {
            let counts = Side::ALL.map(|side| self.seams.count(i, side));
            let poles = Side::ALL.map(|side| mesher.has_pole(tile, side));
            tile::count_triangles(tile, counts, poles)
        });
        per_tile.sum()
    }
}

impl Proved {
    /// The number of its triangles.
    pub(crate) fn count(&self) -> u64 {
        self.tiles.iter().map(|(_, done)| done.triangles.len() as u64).sum()
    }

    /// The largest bound of its tiles.
    pub(crate) fn bound(&self) -> f64 {
        self.tiles.iter().fold(0.0, |most, (_, done)| if done.bound > most { done.bound } else { most })
    }
}

/// Whether a tile has so few cells that its edges may fall together.
fn is_coarse(tile: &Tile) -> bool {
    tile.n < 3 || tile.m < 3
}

/// The edges in coarse tiles that may fall together with others, sorted, with their patch, and those of other tiles that
/// have the same two vertices.
fn coarse_edges(planned: &Planned, done: &[Option<Done>]) -> Vec<(u32, u32, u32)> {
    let mut edges: Vec<(u32, u32, u32)> = Vec::new();
    let mut first_inner = planned.seams.positions.len() as u32;
    for (index, (tile, done)) in planned.tiles.iter().zip(done).enumerate() {
        let Some(done) = done.as_ref().filter(|_| is_coarse(tile)) else { continue };
        let border: Vec<u32> =
            tile::border(index, tile, &planned.seams).iter().map(|vertex| vertex.id).collect();
        // Inner vertices belong to this tile alone: their edges fall together only where its border meets itself.
        let inner = if has_twice(border.clone()) { done.inner.len() } else { 0 };
        let ids: Vec<u32> = border.into_iter().chain((first_inner..).take(inner)).collect();
        first_inner += inner as u32;
        for t in &done.triangles {
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                if let (Some(a), Some(b)) = (ids.get(a as usize), ids.get(b as usize)) {
                    edges.push((*a.min(b), *a.max(b), tile.patch));
                }
            }
        }
    }
    edges.sort_unstable();
    // Other tiles have edges with both ends on their border only on it.
    let known = edges.len();
    for (index, tile) in planned.tiles.iter().enumerate().filter(|(_, tile)| known > 0 && !is_coarse(tile)) {
        let pieces = Side::ALL.iter().flat_map(|side| planned.seams.chain(index, *side));
        for (a, b) in pieces.flat_map(|(piece, _)| segments(piece)) {
            if edges[..known].binary_search_by_key(&(a, b), |edge| (edge.0, edge.1)).is_ok() {
                edges.push((a, b, tile.patch));
            }
        }
    }
    edges.sort_unstable();
    edges
}

fn has_twice(mut ids: Vec<u32>) -> bool {
    ids.sort_unstable();
    ids.windows(2).any(|pair| pair[0] == pair[1])
}

/// The pairs of neighbouring vertices on a piece, the smaller first; none on one that is a point.
fn segments(piece: &Piece) -> impl Iterator<Item = (u32, u32)> {
    let pair = |k: u32| (piece.vertex(k), piece.vertex(k + 1));
    (0..piece.n).map(pair).filter(|(a, b)| a != b).map(|(a, b)| (a.min(b), a.max(b)))
}

fn total(parts: Vec<Result<f64, Obstacle>>) -> Result<f64, Failed> {
    parts.into_iter().try_fold(0.0, |sum, part| Ok(sum + part.map_err(refuse)?))
}

fn refuse(obstacle: Obstacle) -> Failed {
    let centre = |place: Box3| place.centre().map(|x| format!("{x:.4}")).join(", ");
    match obstacle {
        Obstacle::TooClose(place) => {
            let place = centre(place);
            let message = format!(
                "the eye is too close to the shape near ({place}) for any bound in pixels; a camera can be given near=LENGTH"
            );
            Failure::refused(Code::TooClose, message)
        }
        Obstacle::BelowRounding(place, rounding) => {
            let place = centre(place);
            let message = format!(
                "rounding near ({place}) alone can lose {rounding:.1e}, so no mesh in double precision can be proved to meet the budget"
            );
            Failure::refused(Code::BelowPrecision, message)
        }
    }
}
