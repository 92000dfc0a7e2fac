//! The search from the points of a mesh to the surface of a field: which pieces are bounded next, and when it
//! ends.
//!
//! The sufficient distance depends on the farthest known point, so the pieces that seem farthest come first:
//! a round processes the upper part of the open pieces, and probes lower bounds for the farthest
//! ([`super::probe`]). Every bound is valid at any time; when the allowed work is used up, the answer is the
//! largest upper bound of the remaining pieces.
use super::from_mesh::{self, FieldSubtriangle, MOST_CUTS, SubtriangleBounds};
use super::probe::{DistanceProbe, ProbeSharpness, probe_distances};
use super::surface_ball::{SurfaceBall, SurfaceBalls, project_to_surface};
use super::{CHUNK, FieldDeviationSearch, LEAF_CHUNK, POINTS_A_BOX, leaf_failure, refine_some};
use crate::budget::{JobError, par_map};
use crate::implicit::{Dual, LeafError, Tape};
use crate::math::{Box3, greater, length, lesser, sub_down};

/// The bounds for all points of the mesh.
pub(super) struct ForwardDistance {
    /// A lower bound: some point is this far.
    pub least: f64,
    /// The largest |F| on each face.
    pub residuals: Vec<f64>,
    pub most: f64,
    pub at: [f64; 3],
    pub unresolved: u64,
}

/// The most pieces beyond the faces themselves: a multiple of the faces plus a constant, at most
/// [`MOST_PIECES`], which is what a gigabyte holds. Then the search stops.
const PIECES_A_FACE: usize = 24;
const FEW_PIECES: usize = 1 << 17;
const MOST_PIECES: usize = 1 << 22;
/// Points that take as long as a piece: its box is searched with the whole field. Measured on unions of ten solids.
const POINTS_A_PIECE: u64 = 64;
/// Pieces split this often without any surface point nearby are given up: there is none to be found.
const LOST: u32 = 6;
/// So often a piece is split for a bound tighter than required, as long as half of the work is left for
/// others.
const EAGER: u32 = 5;
/// The share of the limit for that tighter bound: a bound just below the limit leaves no margin for the other
/// direction. Measured: with ⅓ a sphere's proof took twice as long, and columns were none the better.
const TIGHT: f64 = 0.7;
/// On settled pieces the residual is tightened where it may exceed this share of the sufficient distance.
const LOOSE: f64 = 0.6;
/// Pieces whose centroids are probed in a round, and in one task.
const PROBED: usize = 32;
const PROBED_AT_ONCE: usize = 4;
/// A round processes the pieces above this fraction between the sufficient distance and the largest bound.
const UPPER_PART: f64 = 0.5;

type OpenSubtriangles = Vec<(FieldSubtriangle, SubtriangleBounds)>;

impl FieldDeviationSearch<'_> {
    /// `least` is a lower bound known for either direction, and `share` the part of the goal's gap that may
    /// be used.
    pub fn forward(&self, least: f64, share: f64) -> Result<ForwardDistance, JobError> {
        let aim = |out: &ForwardDistance| self.aim(greater(least, out.least), share);
        let faces = self.mesh.faces();
        let relative = self.goal.max.is_none();
        let mut out = ForwardDistance {
            least: 0.0,
            residuals: vec![0.0; faces.len()],
            most: 0.0,
            at: self.mesh.corners(0)[0],
            unresolved: 0,
        };
        let mut left = faces.len() + (PIECES_A_FACE * faces.len() + FEW_PIECES).min(MOST_PIECES);
        let reserve = left / 2;
        let mut batch: Vec<FieldSubtriangle> = (0..faces.len())
            .map(|face| FieldSubtriangle::from_face(self.mesh.corners(face), face as u32))
            .collect();
        let mut open: OpenSubtriangles = Vec::new();
        let mut witnesses = None;
        loop {
            self.check_cancelled()?;
            let mut known = self.bound_batch(&batch, aim(&out))?;
            left = left.saturating_sub(batch.len());
            self.job.count_work(POINTS_A_PIECE * batch.len() as u64);
            if self.job.is_over() {
                left = 0;
            }
            for known in &known {
                if known.at_least > out.least {
                    (out.least, out.at) = (known.at_least, known.at);
                }
            }
            self.assign_balls(&batch, &mut known, &mut witnesses)?;
            open.extend(batch.drain(..).zip(known));
            let enough = aim(&out);
            self.probe(&mut open, &mut out, enough)?;
            // Beyond the limit nothing else matters, and the bounds so far are final.
            let beyond = self.goal.max.is_some_and(|max| out.least > max.get());
            let enough = aim(&out);
            let tight = if relative { enough } else { greater(1.15 * out.least, TIGHT * enough) };
            let eager = |piece: &FieldSubtriangle| piece.cuts() < EAGER && left > reserve;
            let wanted = |piece: &FieldSubtriangle| if eager(piece) { tight } else { enough };
            let (next, done): (OpenSubtriangles, OpenSubtriangles) =
                open.into_iter().partition(|(piece, known)| {
                    let lost = known.at_most == f64::INFINITY && piece.cuts() >= LOST;
                    let goes_on = piece.cuts() < MOST_CUTS && left > 0 && !beyond && !lost;
                    known.at_most > wanted(piece) && goes_on
                });
            let mut done = done;
            self.tighten(&mut done, enough)?;
            done.iter().for_each(|(piece, known)| out.settle(piece, known));
            open = next;
            if open.is_empty() {
                return Ok(out);
            }
            let level = round_threshold(&open, enough);
            let (now, later): (OpenSubtriangles, OpenSubtriangles) =
                open.into_iter().partition(|(_, known)| known.at_most > level || known.at_most <= enough);
            now.into_iter().for_each(|(piece, known)| piece.subdivide(&known, &mut batch));
            open = later;
        }
    }

    /// Tightens the field's largest value on settled pieces: in their search box it may be much larger, and
    /// the other direction measures its columns by it.
    fn tighten(&self, done: &mut OpenSubtriangles, enough: f64) -> Result<(), JobError> {
        let chunk = if self.tape.has_leaves() { LEAF_CHUNK } else { CHUNK };
        let all: Vec<usize> = (0..done.len()).collect();
        let chunks: Vec<&[usize]> = all.chunks(chunk).collect();
        let parts = par_map(self.job, &chunks, |_, some| -> Result<Vec<f64>, LeafError> {
            let some: Vec<(FieldSubtriangle, f64)> =
                some.iter().map(|k| (done[*k].0.clone().without_margin(), done[*k].1.residual)).collect();
            self.residuals_of(&some, enough)
        });
        let parts: Result<Vec<Vec<f64>>, LeafError> = parts.into_iter().collect();
        for ((_, known), strays) in done.iter_mut().zip(parts.map_err(leaf_failure)?.concat()) {
            // NaN is no bound.
            known.residual = lesser(known.residual, strays);
        }
        Ok(())
    }

    /// The largest |F| on each of some pieces without a margin, given known bounds.
    fn residuals_of(&self, some: &[(FieldSubtriangle, f64)], enough: f64) -> Result<Vec<f64>, LeafError> {
        let tape =
            self.local_tape(some.iter().fold(Box3::EMPTY, |all, (piece, _)| all.union(piece.search_box())))?;
        let middles: Vec<[f64; 3]> = some.iter().map(|(piece, _)| piece.middle()).collect();
        let mut slopes = vec![Dual { value: 0.0, gradient: [0.0; 3] }; some.len()];
        tape.gradient_at(&middles, &mut slopes)?;
        let wanted = |n: usize| LOOSE * enough * length(slopes[n].gradient);
        let is_loose = |n: &usize| some[*n].1 > wanted(*n);
        let mut most: Vec<f64> = some.iter().map(|(_, known)| *known).collect();
        let mut open: Vec<(usize, FieldSubtriangle)> =
            (0..some.len()).filter(is_loose).map(|n| (n, some[n].0.clone())).collect();
        open.iter().for_each(|(n, _)| most[*n] = 0.0);
        for round in 0..=EAGER {
            let pieces: Vec<FieldSubtriangle> = open.iter().map(|(_, piece)| piece.clone()).collect();
            let known = from_mesh::bound_all(&tape, &pieces)?;
            let mut next = Vec::new();
            for ((n, piece), known) in open.into_iter().zip(known) {
                if known.residual > wanted(n) && round < EAGER {
                    next.extend(piece.halves().map(|half| (n, half)));
                } else {
                    let strays = if known.residual.is_nan() { f64::INFINITY } else { known.residual };
                    most[n] = greater(most[n], strays);
                }
            }
            open = next;
        }
        Ok(most)
    }

    /// Assigns any surface point to pieces without an upper bound.
    fn assign_balls(
        &self,
        pieces: &[FieldSubtriangle],
        known: &mut [SubtriangleBounds],
        witnesses: &mut Option<SurfaceBalls>,
    ) -> Result<(), JobError> {
        for (piece, known) in pieces.iter().zip(known) {
            let lost = known.at_most == f64::INFINITY;
            if lost && (self.goal.max.is_none() || piece.cuts() > 3) {
                if witnesses.is_none() {
                    let all = SurfaceBalls::sample_box(&self.tape, &self.bounds).map_err(leaf_failure)?;
                    *witnesses = Some(all);
                }
                let nearest = witnesses.as_ref().and_then(|all| all.nearest(&piece.corners));
                known.tighten(piece, nearest);
            }
        }
        Ok(())
    }

    /// Probes the centroids of the pieces that may be farthest: bounds from the slope may be far from tight.
    fn probe(
        &self,
        open: &mut OpenSubtriangles,
        out: &mut ForwardDistance,
        enough: f64,
    ) -> Result<(), JobError> {
        let early = if self.goal.max.is_none() { 0 } else { 4 };
        let mut far: Vec<usize> = (0..open.len())
            .filter(|k| {
                let (piece, known) = &open[*k];
                piece.cuts() >= early
                    && known.at_most > enough
                    && known.at_most < f64::INFINITY
                    && !known.probed
            })
            .collect();
        let most = |k: &usize| open[*k].1.at_most;
        if far.len() > PROBED {
            far.select_nth_unstable_by(PROBED, |a, b| most(b).total_cmp(&most(a)).then(a.cmp(b)));
            far.truncate(PROBED);
        }
        far.sort_unstable();
        let chunks: Vec<&[usize]> =
            far.chunks(if self.tape.has_leaves() { PROBED } else { PROBED_AT_ONCE }).collect();
        let parts = par_map(self.job, &chunks, |_, some| -> Result<_, LeafError> {
            let points: Vec<[f64; 3]> = some.iter().map(|k| open[*k].0.middle()).collect();
            let most: Vec<f64> = some.iter().map(|k| open[*k].1.at_most).collect();
            let probed = probe_distances(&self.tape, &points, &most, ProbeSharpness::ROUGH)?;
            let towards: Vec<[f64; 3]> = probed.iter().map(|probed| probed.towards).collect();
            let sizes: Vec<f64> = probed.iter().map(|probed| 0.1 * probed.at_least).collect();
            Ok((probed, project_to_surface(&self.tape, &towards, &sizes)?))
        });
        let mut all: Vec<(DistanceProbe, Option<SurfaceBall>)> = Vec::new();
        for part in parts {
            let (probed, found) = part.map_err(leaf_failure)?;
            all.extend(probed.into_iter().zip(found));
        }
        self.job.count_work(POINTS_A_BOX * all.iter().map(|(probed, _)| probed.n_boxes).sum::<u64>());
        for (k, (probed, witness)) in far.into_iter().zip(all) {
            let (piece, known) = &mut open[k];
            known.probed = true;
            let least = sub_down(probed.at_least, piece.slack());
            if least > known.at_least {
                known.at_least = least;
            }
            if least > out.least {
                (out.least, out.at) = (least, known.at);
            }
            known.tighten(piece, witness);
        }
        Ok(())
    }

    fn bound_batch(
        &self,
        pieces: &[FieldSubtriangle],
        enough: f64,
    ) -> Result<Vec<SubtriangleBounds>, JobError> {
        let chunk = if self.tape.has_leaves() { LEAF_CHUNK } else { CHUNK };
        let chunks: Vec<&[FieldSubtriangle]> = pieces.chunks(chunk).collect();
        let look = |_: usize, pieces: &&[FieldSubtriangle]| -> Result<Vec<SubtriangleBounds>, LeafError> {
            let tape =
                self.local_tape(pieces.iter().fold(Box3::EMPTY, |all, piece| all.union(piece.search_box())))?;
            let mut known = from_mesh::bound_all(&tape, pieces)?;
            self.refine_bounds(pieces, &mut known, enough)?;
            Ok(known)
        };
        let parts = par_map(self.job, &chunks, look);
        let parts: Result<Vec<Vec<SubtriangleBounds>>, LeafError> = parts.into_iter().collect();
        Ok(parts.map_err(leaf_failure)?.concat())
    }

    /// Uses the full tape: the points evaluated here lie outside of the pruned tape's box.
    fn refine_bounds(
        &self,
        pieces: &[FieldSubtriangle],
        known: &mut [SubtriangleBounds],
        enough: f64,
    ) -> Result<(), LeafError> {
        let tape = &self.tape;
        let relative = self.goal.max.is_none();
        let mut lost: Vec<usize> = (0..pieces.len()).filter(|k| known[*k].at_most > enough).collect();
        refine_some(&lost, pieces, known, |of, known| from_mesh::bound_along_gradient(tape, of, known))?;
        lost.retain(|k| known[*k].at_most > enough);
        refine_some(&lost, pieces, known, |of, known| from_mesh::bound_by_shift(tape, of, known, enough))?;
        lost.retain(|k| known[*k].at_most > enough && (relative || pieces[*k].cuts() > 3));
        let near: Vec<usize> =
            lost.iter().copied().filter(|k| pieces[*k].cuts() > 3 && pieces[*k].is_within(enough)).collect();
        refine_some(&near, pieces, known, |of, known| from_mesh::bound_by_samples(tape, of, known, enough))?;
        // A surface point does not settle pieces whose distance is small compared to their size.
        lost.retain(|k| known[*k].at_most > greater(enough, 0.5 * pieces[*k].extent()));
        refine_some(&lost, pieces, known, |of, known| {
            let points: Vec<[f64; 3]> = of.iter().map(|piece| piece.middle()).collect();
            let sizes: Vec<f64> = of.iter().map(|piece| piece.extent()).collect();
            for ((piece, known), witness) in
                of.iter().zip(known).zip(project_to_surface(tape, &points, &sizes)?)
            {
                known.tighten(piece, witness);
            }
            Ok(())
        })
    }

    /// The tape for a box, pruned where that pays.
    fn local_tape(&self, bounds: Box3) -> Result<Tape, LeafError> {
        if self.tape.has_leaves() || self.tape.len() < 16 {
            return Ok(self.tape.clone());
        }
        Ok(self.tape.prune(&bounds)?.1.unwrap_or_else(|| self.tape.clone()))
    }
}

impl ForwardDistance {
    fn settle(&mut self, piece: &FieldSubtriangle, known: &SubtriangleBounds) {
        let strays = &mut self.residuals[piece.face as usize];
        *strays = greater(*strays, if known.residual.is_nan() { f64::INFINITY } else { known.residual });
        self.most = greater(self.most, known.at_most);
        self.unresolved += u64::from(known.at_most == f64::INFINITY);
    }
}

/// The upper bound above which pieces are processed in this round.
fn round_threshold(open: &OpenSubtriangles, enough: f64) -> f64 {
    let finite = open.iter().map(|(_, known)| known.at_most).filter(|most| *most < f64::INFINITY);
    let most = finite.fold(enough, greater);
    enough + UPPER_PART * (most - enough)
}
