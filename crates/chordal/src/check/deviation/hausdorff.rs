//! The branch-and-bound search: rounds over all open pieces of both surfaces, each against the lower bound at
//! its start.
//!
//! Tasks of a round share nothing, so threads cannot change the result. Between rounds the lower bound rises
//! to the farthest point that any piece has found.
use super::cover::{Cover, CoverLimits, CoverScratch, cover};
use super::distance_surface::DistanceSurface;
use super::shared::VertexDistances;
use super::subtriangle::{DistanceSample, MeshSubtriangle};
use crate::budget::{Job, par_map};
use crate::math::{add_up, greater, lesser, sub_down};
use std::collections::VecDeque;

/// Pieces in one task.
const CHUNK: usize = 512;
/// Bisections of one piece in the first round; twice as many in each following round, up to [`MOST_CUTS`].
const FIRST_CUTS: u32 = 4;
const MOST_CUTS: u32 = 256;
/// The most bisections in all, as a multiple of the faces of both surfaces and at least so many times
/// [`FEW_FACES`]; after that the search stops.
const CUTS_A_FACE: u64 = 64;
const FEW_FACES: u64 = 1 << 14;
/// Points that take as long as a bisection, or as a face before any. Derived: of three microseconds, as a vertex takes.
const POINTS_A_CUT: u64 = 64;

/// The goal of the search.
#[derive(Clone, Copy, Debug)]
pub(super) struct HausdorffGoal {
    /// The upper bound may exceed the lower one by this share of it …
    pub relative: f64,
    /// … or by this length.
    pub absolute: f64,
    /// Closer together than this, rounding decides.
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
    /// A limit for surfaces that rounding displaced by at most `moved` together.
    pub fn around(limit: f64, moved: f64) -> Self {
        if moved == 0.0 {
            return Self { within: limit, beyond: limit };
        }
        // Twice, to cover the roundings of the way back.
        Self { within: sub_down(limit, 2.0 * moved), beyond: add_up(limit, 2.0 * moved) }
    }

    /// Distances up to this are within the limit, rounding included.
    pub fn within(&self) -> f64 {
        self.within
    }
}

impl HausdorffGoal {
    /// The distance that suffices for every point when some point has `least`.
    pub fn sufficient_distance(&self, least: f64) -> f64 {
        match self.max {
            // Closer to the limit than rounding allows, nothing is required.
            Some(limit) => greater(limit.within, least + self.floor),
            None => greater(least * (1.0 + self.relative), least + greater(self.absolute, self.floor)),
        }
    }
}

/// The farthest point found of one surface from the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct FarthestSample {
    pub at: [f64; 3],
    /// A lower bound on its distance.
    pub at_least: f64,
}

/// One direction of the search.
pub(super) struct OneSidedSearch<'a> {
    own: &'a DistanceSurface<'a>,
    other: &'a DistanceSurface<'a>,
    pub farthest: FarthestSample,
    /// An upper bound on the distance of all points outside of open pieces.
    pub settled: f64,
    /// Whether the frame may have displaced what is bounded: faces that both surfaces share lose nothing.
    pub is_displaced: bool,
    open: Vec<MeshSubtriangle>,
}

/// The result of one task of a round.
struct HausdorffBatchResult {
    settled: f64,
    open: Vec<MeshSubtriangle>,
    seen: Option<(DistanceSample, f64)>,
    cuts: u64,
}

impl HausdorffBatchResult {
    /// Records a sample that represents a surface point at most `off` away; returns its upper bound.
    fn see(&mut self, corner: DistanceSample, off: f64) -> f64 {
        self.seen = farther_of(self.seen, Some((corner, off)));
        corner.up
    }
}

/// The limits of one round.
#[derive(Clone, Copy)]
struct HausdorffRound {
    terms: CoverLimits,
    cuts: u32,
}

impl<'a> OneSidedSearch<'a> {
    pub fn new(
        own: &'a DistanceSurface<'a>,
        other: &'a DistanceSurface<'a>,
        vertices: &VertexDistances,
    ) -> Self {
        let mut this = Self {
            own,
            other,
            farthest: FarthestSample { at: [0.0; 3], at_least: 0.0 },
            settled: 0.0,
            is_displaced: !vertices.faces.is_empty(),
            open: Vec::new(),
        };
        if let Some(far) = vertices.farthest() {
            this.farthest.at = far.at;
            this.see(far, 0.0);
        }
        this
    }

    /// Raises the lower bound by a sample that represents a surface point at most `off` away.
    fn see(&mut self, corner: DistanceSample, off: f64) {
        if corner.up <= self.farthest.at_least {
            return;
        }
        let least = self.other.distance_down(corner.at);
        let least = if off == 0.0 { least } else { (least - off).next_down() };
        if least > self.farthest.at_least {
            self.farthest = FarthestSample { at: corner.at, at_least: least };
        }
    }

    /// An upper bound on the distance from the surface to the other.
    pub fn at_most(&self) -> f64 {
        self.open.iter().fold(self.settled, |most, piece| greater(most, piece.known))
    }

    /// Merges the results of the tasks of a round in their order; returns the number of bisections.
    fn merge_batches(&mut self, found: Vec<HausdorffBatchResult>) -> u64 {
        let mut cuts = 0;
        let mut seen: Option<(DistanceSample, f64)> = None;
        self.open.clear();
        for part in found {
            self.settled = greater(self.settled, part.settled);
            self.open.extend(part.open);
            cuts += part.cuts;
            seen = farther_of(seen, part.seen);
        }
        if let Some((corner, off)) = seen {
            self.see(corner, off);
        }
        cuts
    }
}

fn farther_of(
    a: Option<(DistanceSample, f64)>,
    b: Option<(DistanceSample, f64)>,
) -> Option<(DistanceSample, f64)> {
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

/// Runs both directions until both meet the goal; false where they do not, or the job was cancelled.
pub(super) fn search(
    directions: &mut [OneSidedSearch; 2],
    vertices: &[VertexDistances; 2],
    asked: &HausdorffQuery,
    job: &Job,
) -> bool {
    let n_faces: u64 = directions.iter().map(|d| d.own.mesh().faces().len() as u64).sum();
    let most_cuts = lesser(CUTS_A_FACE * greater(n_faces, FEW_FACES), job.work_left() / POINTS_A_CUT);
    job.count_work(POINTS_A_CUT * n_faces);
    probe_some_faces(directions, vertices, asked, job);
    let (mut cuts, mut a_piece) = (0, FIRST_CUTS);
    let mut first = true;
    loop {
        let n_open: u64 = directions.iter().map(|direction| direction.open.len() as u64).sum();
        // The remaining bisections are divided among all pieces.
        let share = most_cuts.saturating_sub(cuts) / (n_open + 1) + 1;
        let share = if share < u64::from(a_piece) { share as u32 } else { a_piece };
        let cuts_before = cuts;
        let least = greater(directions[0].farthest.at_least, directions[1].farthest.at_least);
        let enough = reachable_bound(asked.goal, directions, least);
        if asked.goal.max.is_some_and(|limit| least > limit.beyond) {
            // The side of the limit is known; open pieces stay open.
            for k in 0..2 {
                if first {
                    directions[k].open = all_subtriangles(directions[k].own, &vertices[k]);
                    bound_all(&mut directions[k]);
                }
            }
            return true;
        }
        for k in 0..2 {
            let terms = CoverLimits {
                tolerance: enough,
                most_faces: asked.most_faces(&directions[k], first),
                reach: asked.reach,
            };
            let round = HausdorffRound { terms, cuts: share };
            let found = if first {
                over_faces(&directions[k], &vertices[k], &vertices[k].faces, round, job)
            } else {
                over_pieces(&directions[k], round, job)
            };
            cuts += directions[k].merge_batches(found);
        }
        first = false;
        if job.is_cancelled() {
            return false;
        }
        let least_before = least;
        let least = greater(directions[0].farthest.at_least, directions[1].farthest.at_least);
        let wanted = asked.goal.sufficient_distance(least);
        let enough = reachable_bound(asked.goal, directions, least);
        // A bound too large for the old lower bound may suffice for the new one.
        for direction in directions.iter_mut() {
            let open = std::mem::take(&mut direction.open);
            let (done, open): (Vec<_>, Vec<_>) = open.into_iter().partition(|piece| piece.known <= enough);
            direction.settled = done.iter().fold(direction.settled, |most, piece| greater(most, piece.known));
            direction.open = open;
        }
        if directions.iter().all(|direction| direction.open.is_empty()) {
            return enough <= wanted;
        }
        job.count_work(POINTS_A_CUT * (cuts - cuts_before));
        let stuck = cuts == cuts_before && least == least_before;
        if cuts > most_cuts || stuck {
            return false;
        }
        a_piece = lesser(2 * a_piece, MOST_CUTS);
    }
}

/// The distance that suffices when some point has `least`, or that of pieces too small to be bisected.
fn reachable_bound(wanted: HausdorffGoal, directions: &[OneSidedSearch; 2], least: f64) -> f64 {
    greater(wanted.sufficient_distance(least), greater(directions[0].settled, directions[1].settled))
}

/// Faces of each direction that are sampled first, to raise the lower bound.
const PILOT: usize = 1 << 10;

/// Samples some faces to find far points: later most pieces are then settled at once.
fn probe_some_faces(
    directions: &mut [OneSidedSearch; 2],
    vertices: &[VertexDistances; 2],
    asked: &HausdorffQuery,
    job: &Job,
) {
    let least = greater(directions[0].farthest.at_least, directions[1].farthest.at_least);
    let enough = asked.goal.sufficient_distance(least);
    for (direction, vertices) in directions.iter_mut().zip(vertices) {
        let every = vertices.faces.len() / PILOT + 1;
        let faces: Vec<u32> = vertices.faces.iter().step_by(every).copied().collect();
        let terms = CoverLimits {
            tolerance: enough,
            most_faces: asked.most_faces(direction, true),
            reach: asked.reach,
        };
        let found = over_faces(direction, vertices, &faces, HausdorffRound { terms, cuts: 0 }, job);
        let seen = found.into_iter().fold(None, |seen, part| farther_of(seen, part.seen));
        if let Some((corner, off)) = seen {
            direction.see(corner, off);
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
    /// The most faces a search for a cover may visit: many where there are few pieces to cover.
    fn most_faces(&self, direction: &OneSidedSearch, first: bool) -> usize {
        let (own, other) = (direction.own.mesh().faces().len(), direction.other.mesh().faces().len());
        let pieces = if first { own } else { direction.open.len() };
        LEAST_COVER + COVERS * (own + other) / (pieces + 1)
    }
}

/// The most faces that any search for a cover may visit.
const LEAST_COVER: usize = 1 << 12;
/// Beyond that, so many times all faces, divided among the pieces.
const COVERS: usize = 16;

fn all_subtriangles(own: &DistanceSurface, vertices: &VertexDistances) -> Vec<MeshSubtriangle> {
    vertices.faces.iter().map(|face| subtriangle_of(own, vertices, *face)).collect()
}

fn bound_all(direction: &mut OneSidedSearch) {
    for piece in &mut direction.open {
        piece.known = piece.bound_by_corners(direction.other, f64::INFINITY);
    }
}

fn subtriangle_of(own: &DistanceSurface, vertices: &VertexDistances, face: u32) -> MeshSubtriangle {
    let corners = own.mesh().faces()[face as usize].map(|row| vertices.corner(row));
    MeshSubtriangle { corners, off: 0.0, known: f64::INFINITY }
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
        let pieces = faces.iter().map(|face| subtriangle_of(direction.own, vertices, *face));
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
    let mut found = HausdorffBatchResult { settled: 0.0, open: Vec::new(), seen: None, cuts: 0 };
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
            let enough = round.terms.tolerance;
            piece.known = piece.bound_by_corners(other, enough);
            // A point that is too far raises the lower bound, against which the piece is then tried again.
            let mut cut = cuts < round.cuts;
            if piece.known > enough {
                match cover(&piece, other, round.terms, &mut scratch) {
                    Cover::Within(most) => piece.known = lesser(piece.known, most),
                    Cover::TooFar(at) => {
                        // Clipped three times: each moves it by at most 4.5 ε of the largest coordinate; see
                        // `ConvexClipper`.
                        let off = piece.off + f64::EPSILON * 16.0 * round.terms.reach; // rounded up
                        cut &= found.see(other.sample(at), off) <= enough;
                    }
                    Cover::None => {}
                }
            }
            if piece.known <= enough {
                found.settled = greater(found.settled, piece.known);
                continue;
            }
            if !cut {
                found.open.push(piece);
                continue;
            }
            match piece.halves(|at| other.sample(at)) {
                Some(halves) => {
                    cuts += 1;
                    if found.see(halves[0].corners[1], halves[0].off) <= enough {
                        waiting.extend(halves);
                    } else {
                        found.open.extend(halves);
                    }
                }
                // Too small to be bisected: its bound is final.
                None => found.settled = greater(found.settled, piece.known),
            }
        }
        found.cuts += u64::from(cuts);
    }
    found
}
