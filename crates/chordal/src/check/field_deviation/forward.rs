//! The search from the points of a mesh to the surface of a field: the order in which pieces are bounded, and
//! its end.
//!
//! The sufficient distance depends on the farthest known point, so the pieces that seem farthest come first:
//! a round processes the upper part of the open pieces, and probes lower bounds for the farthest
//! ([`super::probe`]). Every bound is valid at any time; once the allowed work is used up, the result is the
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

/// The most pieces in addition to the faces: a multiple of the faces plus a constant, at most
/// [`MOST_PIECES`], which fit into a gigabyte. Then the search stops.
const PIECES_A_FACE: usize = 24;
const FEW_PIECES: usize = 1 << 17;
const MOST_PIECES: usize = 1 << 22;
/// Work units of one piece: its box is searched with the whole field. Measured on unions of ten solids.
const POINTS_A_PIECE: u64 = 64;
/// A piece split this often without any surface point nearby is given up, since there is none to be found.
const LOST: u32 = 6;
/// A piece is split up to this often for a bound tighter than required, as long as half of the work is left
/// for other pieces.
const EAGER: u32 = 5;
/// The share of the limit for that tighter bound: a bound just below the limit leaves no margin for the other
/// direction. Measured: with ⅓ a sphere's proof took twice as long, and columns were none the better.
const TIGHT: f64 = 0.7;
/// On settled pieces the residual is tightened if it may exceed this share of the sufficient distance.
const LOOSE: f64 = 0.6;
/// Pieces whose centroids are probed in one round, and in one task.
const PROBED: usize = 32;
const PROBED_AT_ONCE: usize = 4;
/// A round processes the pieces above this fraction between the sufficient distance and the largest bound.
const UPPER_PART: f64 = 0.5;

type OpenSubtriangles = Vec<(FieldSubtriangle, SubtriangleBounds)>;

impl FieldDeviationSearch<'_> {
    /// Bounds the distance of all points of the mesh. `least` is a known lower bound for either direction,
    /// and `share` the part of the goal's gap that may be used.
    pub fn forward(&self, least: f64, share: f64) -> Result<ForwardDistance, JobError> {
        let aim = |result: &ForwardDistance| self.aim(greater(least, result.least), share);
        let faces = self.mesh.faces();
        let relative = self.goal.max.is_none();
        let mut result = ForwardDistance {
            least: 0.0,
            residuals: vec![0.0; faces.len()],
            most: 0.0,
            at: self.mesh.corners(0)[0],
            unresolved: 0,
        };
        let mut pieces_left = faces.len() + (PIECES_A_FACE * faces.len() + FEW_PIECES).min(MOST_PIECES);
        let reserve = pieces_left / 2;
        let mut batch: Vec<FieldSubtriangle> = (0..faces.len())
            .map(|face| FieldSubtriangle::from_face(self.mesh.corners(face), face as u32))
            .collect();
        let mut open: OpenSubtriangles = Vec::new();
        let mut witnesses = None;
        loop {
            self.check_cancelled()?;
            let mut bounds = self.bound_batch(&batch, aim(&result))?;
            pieces_left = pieces_left.saturating_sub(batch.len());
            self.job.count_work(POINTS_A_PIECE * batch.len() as u64);
            // The loop goes on to its end, which settles all open pieces with the bounds that they
            // have.
            if self.job.is_over() {
                pieces_left = 0;
            }
            for bounds in &bounds {
                if bounds.at_least > result.least {
                    (result.least, result.at) = (bounds.at_least, bounds.at);
                }
            }
            self.assign_balls(&batch, &mut bounds, &mut witnesses)?;
            open.extend(batch.drain(..).zip(bounds));
            let enough = aim(&result);
            self.probe(&mut open, &mut result, enough)?;
            // Beyond the limit no tighter bound is needed, and the bounds so far are final.
            let beyond = self.goal.max.is_some_and(|max| result.least > max.get());
            let enough = aim(&result);
            let tight = if relative { enough } else { greater(1.15 * result.least, TIGHT * enough) };
            // The first cuts of a piece tighten the result beyond the goal, as long as half of all
            // pieces is left for those that miss it.
            let eager = |piece: &FieldSubtriangle| piece.cuts() < EAGER && pieces_left > reserve;
            let wanted = |piece: &FieldSubtriangle| if eager(piece) { tight } else { enough };
            let (next, done): (OpenSubtriangles, OpenSubtriangles) =
                open.into_iter().partition(|(piece, bounds)| {
                    let lost = bounds.at_most == f64::INFINITY && piece.cuts() >= LOST;
                    let goes_on = piece.cuts() < MOST_CUTS && pieces_left > 0 && !beyond && !lost;
                    bounds.at_most > wanted(piece) && goes_on
                });
            let mut done = done;
            self.tighten(&mut done, enough)?;
            done.iter().for_each(|(piece, bounds)| result.settle(piece, bounds));
            open = next;
            if open.is_empty() {
                return Ok(result);
            }
            let level = round_threshold(&open, enough);
            let (now, later): (OpenSubtriangles, OpenSubtriangles) =
                open.into_iter().partition(|(_, bounds)| bounds.at_most > level || bounds.at_most <= enough);
            now.into_iter().for_each(|(piece, bounds)| piece.subdivide(&bounds, &mut batch));
            open = later;
        }
    }

    /// Tightens the residuals of settled pieces: over their search boxes the field may be much larger than on
    /// the pieces, and the heights of columns in the other direction depend on it.
    fn tighten(&self, done: &mut OpenSubtriangles, enough: f64) -> Result<(), JobError> {
        let chunk = if self.tape.has_leaves() { LEAF_CHUNK } else { CHUNK };
        let indices: Vec<usize> = (0..done.len()).collect();
        let chunks: Vec<&[usize]> = indices.chunks(chunk).collect();
        let parts = par_map(self.job, &chunks, |_, some| -> Result<Vec<f64>, LeafError> {
            let some: Vec<(FieldSubtriangle, f64)> =
                some.iter().map(|k| (done[*k].0.clone().without_margin(), done[*k].1.residual)).collect();
            self.residuals_of(&some, enough)
        });
        let parts: Result<Vec<Vec<f64>>, LeafError> = parts.into_iter().collect();
        for ((_, bounds), residual) in done.iter_mut().zip(parts.map_err(leaf_failure)?.concat()) {
            // NaN is no bound.
            bounds.residual = lesser(bounds.residual, residual);
        }
        Ok(())
    }

    /// The largest |F| on each of some pieces without a margin, given known residuals.
    fn residuals_of(&self, some: &[(FieldSubtriangle, f64)], enough: f64) -> Result<Vec<f64>, LeafError> {
        let tape =
            self.local_tape(some.iter().fold(Box3::EMPTY, |all, (piece, _)| all.union(piece.search_box())))?;
        let middles: Vec<[f64; 3]> = some.iter().map(|(piece, _)| piece.middle()).collect();
        let mut slopes = vec![Dual { value: 0.0, gradient: [0.0; 3] }; some.len()];
        tape.gradient_at(&middles, &mut slopes)?;
        // A length as a value of F, by the slope at the middle. A wrong estimate costs pieces, not
        // the proof.
        let wanted = |n: usize| LOOSE * enough * length(slopes[n].gradient);
        let is_loose = |n: &usize| some[*n].1 > wanted(*n);
        let mut most: Vec<f64> = some.iter().map(|(_, bounds)| *bounds).collect();
        let mut open: Vec<(usize, FieldSubtriangle)> =
            (0..some.len()).filter(is_loose).map(|n| (n, some[n].0.clone())).collect();
        open.iter().for_each(|(n, _)| most[*n] = 0.0);
        for round in 0..=EAGER {
            let pieces: Vec<FieldSubtriangle> = open.iter().map(|(_, piece)| piece.clone()).collect();
            let bounds = from_mesh::bound_all(&tape, &pieces)?;
            let mut next = Vec::new();
            for ((n, piece), bounds) in open.into_iter().zip(bounds) {
                if bounds.residual > wanted(n) && round < EAGER {
                    next.extend(piece.halves().map(|half| (n, half)));
                // In the last round every residual counts as it is.
                } else {
                    let residual = if bounds.residual.is_nan() { f64::INFINITY } else { bounds.residual };
                    most[n] = greater(most[n], residual);
                }
            }
            open = next;
        }
        Ok(most)
    }

    /// Assigns the best sampled surface point to each piece without an upper bound.
    fn assign_balls(
        &self,
        pieces: &[FieldSubtriangle],
        bounds: &mut [SubtriangleBounds],
        witnesses: &mut Option<SurfaceBalls>,
    ) -> Result<(), JobError> {
        for (piece, bounds) in pieces.iter().zip(bounds) {
            let lost = bounds.at_most == f64::INFINITY;
            if lost && (self.goal.max.is_none() || piece.cuts() > 3) {
                if witnesses.is_none() {
                    let sampled = SurfaceBalls::sample_box(&self.tape, &self.bounds).map_err(leaf_failure)?;
                    *witnesses = Some(sampled);
                }
                let nearest = witnesses.as_ref().and_then(|witnesses| witnesses.nearest(&piece.corners));
                bounds.tighten(piece, nearest);
            }
        }
        Ok(())
    }

    /// Probes the centroids of the pieces that may be farthest: their bounds from slopes may be far from
    /// tight.
    fn probe(
        &self,
        open: &mut OpenSubtriangles,
        result: &mut ForwardDistance,
        enough: f64,
    ) -> Result<(), JobError> {
        let early = if self.goal.max.is_none() { 0 } else { 4 };
        let mut far: Vec<usize> = (0..open.len())
            .filter(|k| {
                let (piece, bounds) = &open[*k];
                piece.cuts() >= early
                    && bounds.at_most > enough
                    && bounds.at_most < f64::INFINITY
                    && !bounds.probed
            })
            .collect();
        let most = |k: &usize| open[*k].1.at_most;
        if far.len() > PROBED {
            far.select_nth_unstable_by(PROBED, |a, b| most(b).total_cmp(&most(a)).then(a.cmp(b)));
            far.truncate(PROBED);
        }
        // Back in the order of the pieces, so that tasks, and the first of equal results, do not
        // depend on the selection.
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
        let mut probes: Vec<(DistanceProbe, Option<SurfaceBall>)> = Vec::new();
        for part in parts {
            let (probed, witnesses) = part.map_err(leaf_failure)?;
            probes.extend(probed.into_iter().zip(witnesses));
        }
        self.job.count_work(POINTS_A_BOX * probes.iter().map(|(probed, _)| probed.n_boxes).sum::<u64>());
        for (k, (probed, witness)) in far.into_iter().zip(probes) {
            let (piece, bounds) = &mut open[k];
            bounds.probed = true;
            let least = sub_down(probed.at_least, piece.slack());
            if least > bounds.at_least {
                bounds.at_least = least;
            }
            if least > result.least {
                (result.least, result.at) = (least, bounds.at);
            }
            bounds.tighten(piece, witness);
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
            let mut bounds = from_mesh::bound_all(&tape, pieces)?;
            self.refine_bounds(pieces, &mut bounds, enough)?;
            Ok(bounds)
        };
        let parts = par_map(self.job, &chunks, look);
        let parts: Result<Vec<Vec<SubtriangleBounds>>, LeafError> = parts.into_iter().collect();
        Ok(parts.map_err(leaf_failure)?.concat())
    }

    /// Tightens bounds by other means. Uses the full tape, since points outside the pruned tape's box are
    /// evaluated.
    fn refine_bounds(
        &self,
        pieces: &[FieldSubtriangle],
        bounds: &mut [SubtriangleBounds],
        enough: f64,
    ) -> Result<(), LeafError> {
        let tape = &self.tape;
        let relative = self.goal.max.is_none();
        // From the cheapest to the dearest, each only for the pieces that the ones before it leave.
        let mut lost: Vec<usize> = (0..pieces.len()).filter(|k| bounds[*k].at_most > enough).collect();
        refine_some(&lost, pieces, bounds, |selected, bounds| {
            from_mesh::bound_along_gradient(tape, selected, bounds)
        })?;
        lost.retain(|k| bounds[*k].at_most > enough);
        refine_some(&lost, pieces, bounds, |selected, bounds| {
            from_mesh::bound_by_shift(tape, selected, bounds, enough)
        })?;
        lost.retain(|k| bounds[*k].at_most > enough && (relative || pieces[*k].cuts() > 3));
        let near: Vec<usize> =
            lost.iter().copied().filter(|k| pieces[*k].cuts() > 3 && pieces[*k].is_within(enough)).collect();
        refine_some(&near, pieces, bounds, |selected, bounds| {
            from_mesh::bound_by_samples(tape, selected, bounds, enough)
        })?;
        // If the distance is small compared to the size of the piece, a surface point does not settle it.
        lost.retain(|k| bounds[*k].at_most > greater(enough, 0.5 * pieces[*k].extent()));
        refine_some(&lost, pieces, bounds, |selected, bounds| {
            let points: Vec<[f64; 3]> = selected.iter().map(|piece| piece.middle()).collect();
            let sizes: Vec<f64> = selected.iter().map(|piece| piece.extent()).collect();
            for ((piece, bounds), witness) in
                selected.iter().zip(bounds).zip(project_to_surface(tape, &points, &sizes)?)
            {
                bounds.tighten(piece, witness);
            }
            Ok(())
        })
    }

    /// The tape for a box, pruned if that pays.
    fn local_tape(&self, bounds: Box3) -> Result<Tape, LeafError> {
        if self.tape.has_leaves() || self.tape.len() < 16 {
            return Ok(self.tape.clone());
        }
        Ok(self.tape.prune(&bounds)?.1.unwrap_or_else(|| self.tape.clone()))
    }
}

impl ForwardDistance {
    fn settle(&mut self, piece: &FieldSubtriangle, bounds: &SubtriangleBounds) {
        let residual = &mut self.residuals[piece.face as usize];
        *residual =
            greater(*residual, if bounds.residual.is_nan() { f64::INFINITY } else { bounds.residual });
        self.most = greater(self.most, bounds.at_most);
        self.unresolved += u64::from(bounds.at_most == f64::INFINITY);
    }
}

/// The upper bound above which pieces are processed in a round.
fn round_threshold(open: &OpenSubtriangles, enough: f64) -> f64 {
    let finite = open.iter().map(|(_, bounds)| bounds.at_most).filter(|most| *most < f64::INFINITY);
    let most = finite.fold(enough, greater);
    enough + UPPER_PART * (most - enough)
}
