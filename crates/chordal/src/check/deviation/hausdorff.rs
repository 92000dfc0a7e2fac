//! The branch-and-bound search for the Hausdorff distance: each round visits all open pieces of both surfaces
//! and compares them with the lower bound from the start of the round.
//!
//! Tasks of a round share nothing, so threads cannot change the result. Between rounds the lower bound rises
//! to the farthest point that any piece has found.
use super::cover::{Cover, CoverLimits, CoverScratch, cover};
use super::distance_surface::{DistanceSample, DistanceSurface};
use super::shared::VertexDistances;
use super::subtriangle::MeshSubtriangle;
use crate::budget::{Job, par_map};
use crate::math::{add_up, greater, lesser, sub_down};
use std::collections::VecDeque;

/// Pieces in one task.
const CHUNK: usize = 512;
/// Bisections of one piece in the first round; each later round allows twice as many, up to [`MOST_CUTS`].
const FIRST_CUTS: u32 = 4;
const MOST_CUTS: u32 = 256;
/// The search stops after this many bisections for each face of both surfaces; surfaces of fewer than
/// [`FEW_FACES`] faces get the bisections of so many.
const CUTS_A_FACE: u64 = 64;
const FEW_FACES: u64 = 1 << 14;
/// Work units of one bisection, and of one face before any. Derived: both take three microseconds, as a
/// vertex does.
const POINTS_A_CUT: u64 = 64;

/// The goal of the search.
#[derive(Clone, Copy, Debug)]
pub(super) struct HausdorffGoal {
    /// The upper bound may exceed the lower one by this share of it …
    pub relative: f64,
    /// … or by this length.
    pub absolute: f64,
    /// Rounding decides about lengths below this one.
    pub floor: f64,
    /// If given, only decides on which side of this limit the distance is.
    pub max: Option<LimitInterval>,
}

/// A limit in a rounded frame: distances between its two ends are undecided.
#[derive(Clone, Copy, Debug)]
pub(super) struct LimitInterval {
    /// Distances up to this are within the limit.
    within: f64,
    /// Distances above this are beyond it.
    beyond: f64,
}

impl LimitInterval {
    /// A limit for surfaces that rounding displaced by at most `displacement` together.
    pub fn around(limit: f64, displacement: f64) -> Self {
        if displacement == 0.0 {
            return Self { within: limit, beyond: limit };
        }
        // Twice, to cover the roundings of the way back.
        Self { within: sub_down(limit, 2.0 * displacement), beyond: add_up(limit, 2.0 * displacement) }
    }

    /// Distances up to this are within the limit, rounding included.
    pub fn within(&self) -> f64 {
        self.within
    }
}

impl HausdorffGoal {
    /// The upper bound that suffices for every point if the distance of some point is `least`.
    pub fn sufficient_distance(&self, least: f64) -> f64 {
        match self.max {
            // The two sides of the limit cannot be told apart within the rounding, so nothing closer is
            // required.
            Some(limit) => greater(limit.within, least + self.floor),
            None => greater(least * (1.0 + self.relative), least + greater(self.absolute, self.floor)),
        }
    }
}

/// The farthest point of one surface from the other that was found so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct FarthestSample {
    pub at: [f64; 3],
    /// A lower bound on its distance.
    pub at_least: f64,
}

/// One direction of the search.
pub(super) struct OneSidedSearch<'a> {
    surface: &'a DistanceSurface<'a>,
    other: &'a DistanceSurface<'a>,
    pub farthest: FarthestSample,
    /// An upper bound on the distance of all points outside the open pieces.
    pub settled: f64,
    /// Whether the frame may have displaced the compared faces. Faces that both surfaces share lose nothing.
    pub is_displaced: bool,
    open: Vec<MeshSubtriangle>,
}

/// The result of one task of a round.
struct HausdorffBatchResult {
    settled: f64,
    open: Vec<MeshSubtriangle>,
    farthest: Option<(DistanceSample, f64)>,
    cuts: u64,
}

impl HausdorffBatchResult {
    /// Records a sample for a surface point at most `slack` away; returns its upper bound.
    fn record(&mut self, corner: DistanceSample, slack: f64) -> f64 {
        self.farthest = farther_of(self.farthest, Some((corner, slack)));
        corner.up
    }
}

/// The limits of one round.
#[derive(Clone, Copy)]
struct HausdorffRound {
    limits: CoverLimits,
    cuts: u32,
}

impl<'a> OneSidedSearch<'a> {
    pub fn new(
        surface: &'a DistanceSurface<'a>,
        other: &'a DistanceSurface<'a>,
        vertices: &VertexDistances,
    ) -> Self {
        let mut this = Self {
            surface,
            other,
            farthest: FarthestSample { at: [0.0; 3], at_least: 0.0 },
            settled: 0.0,
            is_displaced: !vertices.faces.is_empty(),
            open: Vec::new(),
        };
        if let Some(far) = vertices.farthest() {
            this.farthest.at = far.at;
            this.record(far, 0.0);
        }
        this
    }

    /// Raises the lower bound by a sample for a surface point at most `slack` away.
    fn record(&mut self, corner: DistanceSample, slack: f64) {
        // The upper bound is known already, and costs nothing; the lower bound is a search.
        if corner.up <= self.farthest.at_least {
            return;
        }
        let least = self.other.distance_down(corner.at);
        let least = if slack == 0.0 { least } else { (least - slack).next_down() };
        if least > self.farthest.at_least {
            self.farthest = FarthestSample { at: corner.at, at_least: least };
        }
    }

    /// An upper bound on the distance from the surface to the other.
    pub fn at_most(&self) -> f64 {
        self.open.iter().fold(self.settled, |most, piece| greater(most, piece.at_most))
    }

    /// Merges the results of a round's tasks in the order of the tasks; returns the number of bisections.
    fn merge_batches(&mut self, results: Vec<HausdorffBatchResult>) -> u64 {
        let mut cuts = 0;
        let mut farthest: Option<(DistanceSample, f64)> = None;
        self.open.clear();
        for part in results {
            self.settled = greater(self.settled, part.settled);
            self.open.extend(part.open);
            cuts += part.cuts;
            farthest = farther_of(farthest, part.farthest);
        }
        if let Some((corner, slack)) = farthest {
            self.record(corner, slack);
        }
        cuts
    }
}

fn farther_of(
    a: Option<(DistanceSample, f64)>,
    b: Option<(DistanceSample, f64)>,
) -> Option<(DistanceSample, f64)> {
    // Of equals, the first: tasks are merged in their order, so the witness is the same on any number
    // of threads.
    match (a, b) {
        (Some((p, _)), Some((q, _))) => {
            if q.up > p.up {
                b
            } else {
                a
            }
        }
        (a, b) => a.or(b),
    }
}

/// Runs both directions until both meet the goal; `false` if they do not, or the job was cancelled.
pub(super) fn search(
    directions: &mut [OneSidedSearch; 2],
    vertices: &[VertexDistances; 2],
    query: &HausdorffQuery,
    job: &Job,
) -> bool {
    let n_faces: u64 = directions.iter().map(|d| d.surface.mesh().faces().len() as u64).sum();
    let most_cuts = lesser(CUTS_A_FACE * greater(n_faces, FEW_FACES), job.work_left() / POINTS_A_CUT);
    job.count_work(POINTS_A_CUT * n_faces);
    probe_some_faces(directions, vertices, query, job);
    let (mut cuts, mut cuts_per_piece) = (0, FIRST_CUTS);
    let mut first = true;
    loop {
        let n_open: u64 = directions.iter().map(|direction| direction.open.len() as u64).sum();
        // The remaining bisections are divided evenly among all open pieces, so that a piece which never settles
        // does not take what the others need.
        let cuts_allowed = most_cuts.saturating_sub(cuts) / (n_open + 1) + 1;
        let cuts_allowed =
            if cuts_allowed < u64::from(cuts_per_piece) { cuts_allowed as u32 } else { cuts_per_piece };
        let cuts_before = cuts;
        let least = greater(directions[0].farthest.at_least, directions[1].farthest.at_least);
        let enough = reachable_bound(query.goal, directions, least);
        if query.goal.max.is_some_and(|limit| least > limit.beyond) {
            // The distance is beyond the limit, which is all that was wanted; open pieces stay open.
            for k in 0..2 {
                if first {
                    directions[k].open = all_subtriangles(directions[k].surface, &vertices[k]);
                    bound_all(&mut directions[k]);
                }
            }
            return true;
        }
        for k in 0..2 {
            let limits = CoverLimits {
                tolerance: enough,
                most_faces: query.most_faces(&directions[k], first),
                reach: query.reach,
            };
            let round = HausdorffRound { limits, cuts: cuts_allowed };
            let results = if first {
                over_faces(&directions[k], &vertices[k], &vertices[k].faces, round, job)
            } else {
                over_pieces(&directions[k], round, job)
            };
            cuts += directions[k].merge_batches(results);
        }
        first = false;
        if job.is_cancelled() {
            return false;
        }
        let least_before = least;
        let least = greater(directions[0].farthest.at_least, directions[1].farthest.at_least);
        let wanted = query.goal.sufficient_distance(least);
        let enough = reachable_bound(query.goal, directions, least);
        // A piece whose upper bound exceeded the old lower bound may be settled by the new one.
        for direction in directions.iter_mut() {
            let open = std::mem::take(&mut direction.open);
            let (done, open): (Vec<_>, Vec<_>) = open.into_iter().partition(|piece| piece.at_most <= enough);
            direction.settled =
                done.iter().fold(direction.settled, |most, piece| greater(most, piece.at_most));
            direction.open = open;
        }
        if directions.iter().all(|direction| direction.open.is_empty()) {
            return enough <= wanted;
        }
        job.count_work(POINTS_A_CUT * (cuts - cuts_before));
        // The next round would do the same again.
        let stuck = cuts == cuts_before && least == least_before;
        if cuts > most_cuts || stuck {
            return false;
        }
        cuts_per_piece = lesser(2 * cuts_per_piece, MOST_CUTS);
    }
}

/// The upper bound that can be reached: pieces too small to be bisected may keep it above the one that
/// suffices.
fn reachable_bound(wanted: HausdorffGoal, directions: &[OneSidedSearch; 2], least: f64) -> f64 {
    greater(wanted.sufficient_distance(least), greater(directions[0].settled, directions[1].settled))
}

/// The most faces of each direction that are sampled first, to raise the lower bound. Larger values cost more
/// before the first round; smaller ones miss far points.
const PILOT: usize = 1 << 10;

/// Samples some faces for far points, so that most pieces are settled at their first visit later.
fn probe_some_faces(
    directions: &mut [OneSidedSearch; 2],
    vertices: &[VertexDistances; 2],
    query: &HausdorffQuery,
    job: &Job,
) {
    let least = greater(directions[0].farthest.at_least, directions[1].farthest.at_least);
    let enough = query.goal.sufficient_distance(least);
    for (direction, vertices) in directions.iter_mut().zip(vertices) {
        // Evenly spread, since neighbours are about equally far.
        let every = vertices.faces.len() / PILOT + 1;
        let faces: Vec<u32> = vertices.faces.iter().step_by(every).copied().collect();
        let limits = CoverLimits {
            tolerance: enough,
            most_faces: query.most_faces(direction, true),
            reach: query.reach,
        };
        let results = over_faces(direction, vertices, &faces, HausdorffRound { limits, cuts: 0 }, job);
        let farthest = results.into_iter().fold(None, |farthest, part| farther_of(farthest, part.farthest));
        if let Some((corner, slack)) = farthest {
            direction.record(corner, slack);
        }
    }
}

/// The parameters of the whole search.
pub(super) struct HausdorffQuery {
    pub goal: HausdorffGoal,
    /// The largest coordinate of both surfaces.
    pub reach: f64,
}

impl HausdorffQuery {
    /// The most faces that a search for a cover may visit: the fewer the pieces, the more faces for each.
    fn most_faces(&self, direction: &OneSidedSearch, first: bool) -> usize {
        let (n_own, n_other) = (direction.surface.mesh().faces().len(), direction.other.mesh().faces().len());
        let pieces = if first { n_own } else { direction.open.len() };
        LEAST_COVER + COVERS * (n_own + n_other) / (pieces + 1)
    }
}

/// The number of faces that every search for a cover may visit.
const LEAST_COVER: usize = 1 << 12;
/// Further visits for all pieces together, as a multiple of the faces of both surfaces.
const COVERS: usize = 16;

fn all_subtriangles(surface: &DistanceSurface, vertices: &VertexDistances) -> Vec<MeshSubtriangle> {
    vertices.faces.iter().map(|face| subtriangle_of(surface, vertices, *face)).collect()
}

fn bound_all(direction: &mut OneSidedSearch) {
    for piece in &mut direction.open {
        piece.at_most = piece.bound_by_corners(direction.other, f64::INFINITY);
    }
}

fn subtriangle_of(surface: &DistanceSurface, vertices: &VertexDistances, face: u32) -> MeshSubtriangle {
    let corners = surface.mesh().faces()[face as usize].map(|row| vertices.corner(row));
    MeshSubtriangle { corners, slack: 0.0, at_most: f64::INFINITY }
}

fn over_faces(
    direction: &OneSidedSearch,
    vertices: &VertexDistances,
    faces: &[u32],
    round: HausdorffRound,
    job: &Job,
) -> Vec<HausdorffBatchResult> {
    let chunks: Vec<&[u32]> = faces.chunks(CHUNK).collect();
    par_map(job, &chunks, |_, faces| {
        let pieces = faces.iter().map(|face| subtriangle_of(direction.surface, vertices, *face));
        run_batch(pieces, direction.other, round, job)
    })
}

fn over_pieces(direction: &OneSidedSearch, round: HausdorffRound, job: &Job) -> Vec<HausdorffBatchResult> {
    let chunks: Vec<&[MeshSubtriangle]> = direction.open.chunks(CHUNK).collect();
    par_map(job, &chunks, |_, pieces| run_batch(pieces.iter().cloned(), direction.other, round, job))
}

fn run_batch(
    pieces: impl Iterator<Item = MeshSubtriangle>,
    other: &DistanceSurface,
    round: HausdorffRound,
    job: &Job,
) -> HausdorffBatchResult {
    let mut result = HausdorffBatchResult { settled: 0.0, open: Vec::new(), farthest: None, cuts: 0 };
    let mut scratch = CoverScratch::default();
    // First in, first out: when the bisections run out, the remaining pieces are of similar size.
    let mut waiting = VecDeque::new();
    for piece in pieces {
        if job.is_cancelled() {
            break;
        }
        let mut cuts = 0;
        waiting.push_back(piece);
        while let Some(mut piece) = waiting.pop_front() {
            let enough = round.limits.tolerance;
            piece.at_most = piece.bound_by_corners(other, enough);
            // A point that is too far raises the lower bound; the piece is then compared with the raised one.
            let mut cut = cuts < round.cuts;
            if piece.at_most > enough {
                match cover(&piece, other, round.limits, &mut scratch) {
                    Cover::Within(most) => piece.at_most = lesser(piece.at_most, most),
                    Cover::TooFar(at) => {
                        // The point was clipped up to three times, each of which moves it by at most 4.5 ε of
                        // the largest coordinate; see `ConvexClipper`.
                        let slack = piece.slack + f64::EPSILON * 16.0 * round.limits.reach; // rounded up
                        cut &= result.record(other.sample(at), slack) <= enough;
                    }
                    Cover::None => {}
                }
            }
            if piece.at_most <= enough {
                result.settled = greater(result.settled, piece.at_most);
                continue;
            }
            if !cut {
                result.open.push(piece);
                continue;
            }
            match piece.halves(|at| other.sample(at)) {
                Some(halves) => {
                    cuts += 1;
                    // The new point may raise the lower bound above what was enough; then the
                    // halves wait for the next round, which compares with the new one.
                    if result.record(halves[0].corners[1], halves[0].slack) <= enough {
                        waiting.extend(halves);
                    } else {
                        result.open.extend(halves);
                    }
                }
                // Too small to be bisected, so its bound is final.
                None => result.settled = greater(result.settled, piece.at_most),
            }
        }
        result.cuts += u64::from(cuts);
    }
    result
}
