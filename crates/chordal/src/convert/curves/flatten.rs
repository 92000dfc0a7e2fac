//! `Flattener`: flattens many paths under one budget, with a tolerance and a bound for each piece.
use super::piece::{Chords, rounding};
use crate::budget::{Bound, Bounded, Budget, Failure, Job, Lens, Pixels, Reference, RefusalCode, par_map};
use crate::convert::budget_search::{Approximation, too_close, within_budget};
use crate::convert::ladder::LengthLadder;
use crate::explicit::nurbs::HEAVIEST;
use crate::explicit::{Curve, CurveSegment, Polyline};
use crate::math::{Box3, add_up, flushes_subnormals, greater, lesser, mul_up, sub_down};

/// The placement of the ends of segments on each piece of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Spacing {
    /// Nearly as few segments as the budget allows.
    #[default]
    Fewest,
    /// Equal steps of the parameter.
    Even,
}

/// The failure of flattening, with the best polylines if there are any.
pub(crate) type FlatteningFailure<const D: usize> = Failure<Vec<Polyline<D>>>;

/// The error that is allowed for each piece.
#[derive(Clone, Copy)]
struct CurveAllowance {
    length: Option<f64>,
    pixels: Option<(Pixels, Lens)>,
}

/// A piece of one of the paths.
struct PathPiece<'a, const D: usize> {
    chords: Chords<'a, D>,
    bounds: Box3,
    /// The error of the piece itself, without any chord: rounding, and the error of the path's data.
    rounding_error: f64,
    /// How much of `rounding_error` comes from the arc's slack.
    arc_slack: f64,
    /// How much of `rounding_error` comes from the path's slack.
    path_slack: f64,
    path: usize,
}

/// A piece split into chords.
struct FlattenedPiece {
    places: Vec<f64>,
    /// The deviation of the worst chord, everything included.
    at_most: f64,
    /// The parameter of the curve's farthest point from its chord.
    worst: f64,
}

/// Refuses a path with numbers that allow no proof.
pub(crate) fn refuse_extremes<const D: usize, T>(curve: &Curve<D>, index: usize) -> Result<(), Failure<T>> {
    refuse_flushing()?;
    for piece in curve.segments() {
        let [low, high] = piece.bounds();
        let is_in_range = |p: &[f64; D]| p.iter().all(|x| x.abs() < LARGEST);
        // The centre of a short arc may be far away.
        let has_valid_data = match piece {
            CurveSegment::Arc(arc) => is_in_range(&arc.centre()) && arc.axes().iter().all(is_in_range),
            CurveSegment::Rational(curve) => {
                curve.control_weights().iter().all(|w| *w < HEAVIEST && *w > 1.0 / HEAVIEST)
            }
            CurveSegment::Line(_) | CurveSegment::Cubic(_) => true,
        };
        let is_valid = piece.is_finite()
            && is_in_range(&low)
            && is_in_range(&high)
            && has_valid_data
            && curve.slack() < LARGEST;
        if !is_valid {
            let message = format!(
                "path {index} has a number that is not finite, a coordinate beyond {LARGEST:e}, or a weight beyond {HEAVIEST:e} or its inverse"
            );
            return Err(Failure::refused(RefusalCode::NotFinite, message));
        }
    }
    Ok(())
}

/// Refuses an environment that flushes subnormals, in which nothing can be proved.
pub(crate) fn refuse_flushing<T>() -> Result<(), Failure<T>> {
    if flushes_subnormals() {
        let message = "this process flushes subnormal numbers to zero, so nothing can be proved in it";
        return Err(Failure::refused(RefusalCode::FlushesSubnormals, message));
    }
    Ok(())
}

/// The paths, prepared for flattening.
pub(crate) struct Flattener<'a, const D: usize> {
    curves: &'a [Curve<D>],
    job: &'a Job,
    spacing: Spacing,
    parts: Vec<PathPiece<'a, D>>,
}

/// Squares of differences must stay below 1e308.
pub(crate) const LARGEST: f64 = 1e150;
/// Peak bytes per point: its coordinates and its parameter, twice.
const BYTES_PER_POINT: f64 = 64.0;
/// Up to this many segments a count is reached by the greedy method, which gives smaller bounds with the same number of
/// segments. Measured: a larger bound with more segments then occurs in 16 of 400 series of hard curves instead of 20
/// (`tests/curve_referee/counts.rs`).
const COUNTED: u64 = 4096;
/// A rational piece's deviation is computed to within its rounding error divided by this; smaller tolerances are
/// refused. Chosen: its roundings are about 1, and the rounding error is 64 times a square of at least 5.
const ROUNDED: f64 = 256.0;
/// Lengths per octave in the geometric series of candidate lengths. Chosen, as for patches.
const RUNGS: u32 = 32;
/// Octaves of the series. Chosen: it extends below the rounding of any shape.
const OCTAVES: u32 = 120;

impl<'a, const D: usize> Flattener<'a, D> {
    /// The pieces of some paths, with their rounding errors.
    ///
    /// # Errors
    /// If a number is not finite or too large, or in an environment that flushes subnormals.
    pub(crate) fn new(
        curves: &'a [Curve<D>],
        job: &'a Job,
        spacing: Spacing,
    ) -> Result<Self, FlatteningFailure<D>> {
        refuse_flushing()?;
        let mut parts = Vec::new();
        for (index, curve) in curves.iter().enumerate() {
            refuse_extremes(curve, index)?;
            for piece in curve.segments() {
                let [low, high] = piece.bounds();
                let piece_error = match piece {
                    CurveSegment::Line(_) => 0.0,
                    CurveSegment::Cubic(_) | CurveSegment::Rational(_) => rounding(piece),
                    CurveSegment::Arc(arc) => add_up(rounding(piece), arc.slack()),
                };
                let rounding_error =
                    if curve.slack() > 0.0 { add_up(piece_error, curve.slack()) } else { piece_error };
                let bounds = Box3 { min: to_3d(low), max: to_3d(high) };
                let arc_slack = if let CurveSegment::Arc(arc) = piece { arc.slack() } else { 0.0 };
                parts.push(PathPiece {
                    chords: Chords::new(piece),
                    bounds,
                    rounding_error,
                    arc_slack,
                    path_slack: curve.slack(),
                    path: index,
                });
            }
        }
        Ok(Self { curves, job, spacing, parts })
    }

    /// The polylines within a budget.
    pub(crate) fn flatten(&self, budget: &Budget) -> Result<Bounded<Vec<Polyline<D>>>, FlatteningFailure<D>> {
        if !budget.limits_polylines() {
            let message = "a budget for curves needs a length, pixels at a view, or a number of segments";
            return Err(Failure::refused(RefusalCode::Budget, message));
        }
        if budget.angle_deg.is_some() {
            let message = "curves cannot be cut to an angle yet; give a length or pixels";
            return Err(Failure::refused(RefusalCode::Unsupported, message));
        }
        let allowance = CurveAllowance {
            length: budget.length.map(|length| length.get()),
            pixels: budget.pixels.map(|px| (px.pixels, px.view.lens())),
        };
        within_budget(&CurveApproximation { paths: self, allowance }, budget, budget.segments)
    }

    /// The most segments that the job allows.
    fn limit(&self) -> u64 {
        self.job.triangle_limit.min((self.job.memory_limit as f64 / BYTES_PER_POINT) as u64)
    }

    /// The tolerance for the chords of a part.
    fn chord_tolerance(
        &self,
        part: &PathPiece<'_, D>,
        allowance: &CurveAllowance,
    ) -> Result<f64, FlatteningFailure<D>> {
        let mut length = allowance.length.unwrap_or(f64::INFINITY);
        if let Some((pixels, lens)) = allowance.pixels {
            let by_pixels =
                lens.scale_at(&part.bounds).length_of(pixels).ok_or_else(|| too_close("curve"))?;
            length = lesser(by_pixels, length);
        }
        if part.rounding_error == 0.0 {
            return Ok(length);
        }
        // One step less, because the sum of this tolerance and the part's own error is rounded up again.
        let remaining = sub_down(length.next_down(), part.rounding_error);
        // A rational piece's deviation has roundings that do not shrink with the chord: below them, no number of steps is
        // enough.
        let is_rational = matches!(part.chords, Chords::Rational(_));
        let least = if is_rational { part.rounding_error / ROUNDED } else { 0.0 };
        if remaining > least {
            return Ok(remaining);
        }
        let message = format!("the budget of {length:.3e} is smaller than {}", part.why_uncertain());
        Err(Failure::refused(RefusalCode::BelowPrecision, message))
    }

    /// Refuses, before the work starts, a budget that needs more than the job allows.
    fn check_limits(&self, allowance: &CurveAllowance) -> Result<(), FlatteningFailure<D>> {
        let mut needed = 0.0;
        for part in &self.parts {
            needed += part.chords.even_steps(self.chord_tolerance(part, allowance)?);
        }
        let segments = self.job.triangle_limit as f64;
        let memory = self.job.memory_limit as f64;
        if needed > segments {
            let message =
                format!("the budget needs about {needed:.1e} segments; the limit is {segments:.1e}");
            return Err(Failure::refused(RefusalCode::TooManyTriangles, message));
        }
        if needed * BYTES_PER_POINT > memory {
            let bytes = needed * BYTES_PER_POINT;
            let message =
                format!("the budget needs about {bytes:.1e} bytes of memory; the limit is {memory:.1e}");
            return Err(Failure::refused(RefusalCode::TooMuchMemory, message));
        }
        Ok(())
    }

    /// The chords of all parts; `None` if they have more than `most` segments.
    fn cut(
        &self,
        allowance: &CurveAllowance,
        most: u64,
    ) -> Result<Option<Vec<FlattenedPiece>>, FlatteningFailure<D>> {
        let lengths: Vec<f64> =
            self.parts.iter().map(|part| self.chord_tolerance(part, allowance)).collect::<Result<_, _>>()?;
        // If there would be far more chords than allowed, or than fit into memory, they are not placed at all.
        let in_memory = self.job.memory_limit as f64 / BYTES_PER_POINT;
        let most_steps = 64.0 * most as f64 + 64.0;
        let most_steps = lesser(most_steps, in_memory);
        let is_near = |length: f64, part: &PathPiece<'_, D>| part.chords.even_steps(length) <= most_steps;
        if most < u64::MAX && !self.parts.iter().zip(&lengths).all(|(part, length)| is_near(*length, part)) {
            return Ok(None);
        }
        let cuts = par_map(self.job, &self.parts, |index, part| {
            if self.job.is_cancelled() {
                return None;
            }
            let length = lengths[index];
            let places = match self.spacing {
                Spacing::Fewest if most <= COUNTED => part.chords.greedy(length),
                Spacing::Fewest => part.chords.fewest(length),
                Spacing::Even => part.chords.even(part.chords.even_steps(length) as u64),
            };
            Some(FlattenedPiece::new(part, places))
        });
        let cuts = cuts.into_iter().collect::<Option<Vec<_>>>().ok_or(Failure::Cancelled)?;
        let count: u64 = cuts.iter().map(FlattenedPiece::n_segments).sum();
        Ok((count <= most).then_some(cuts))
    }

    /// The polylines with the smallest bound in the series with at most `most` segments.
    fn within_count(
        &self,
        most: u64,
        allowance: &CurveAllowance,
    ) -> Result<Bounded<Vec<Polyline<D>>>, FlatteningFailure<D>> {
        let most = most.min(self.limit());
        // A single piece in equal steps takes the whole count; no length has to be found.
        if let ([part], Spacing::Even) = (self.parts.as_slice(), self.spacing) {
            let places = part.chords.even(most.max(1));
            return Ok(self.finish(&[FlattenedPiece::new(part, places)], allowance));
        }
        let size = self.parts.iter().fold(0.0, |size: f64, part| {
            let diagonal = add_up(part.bounds.diagonal(), part.rounding_error);
            greater(diagonal, size)
        });
        let ladder = LengthLadder { size, per_octave: RUNGS, octaves: OCTAVES };
        let rung = |k: u32| CurveAllowance { length: Some(ladder.length(k)), pixels: None };
        // Finer rungs are below precision, too: the search ends there as if they had too many segments.
        let cut = |k: u32| match self.cut(&rung(k), most) {
            Err(Failure::Refused(refusal)) if refusal.code == RefusalCode::BelowPrecision => Ok(None),
            other => other,
        };
        let Some(mut best) = cut(0)? else {
            let cuts: Vec<FlattenedPiece> =
                self.parts.iter().map(|part| FlattenedPiece::new(part, part.chords.coarsest())).collect();
            return Err(Failure::Unmet(Box::new(self.finish(&cuts, allowance))));
        };
        ladder.finest(|k| {
            let Some(cuts) = cut(k)? else { return Ok(false) };
            // A finer rung may have the larger deviation, since chords are placed anew.
            if largest_deviation(&cuts) < largest_deviation(&best) {
                best = cuts;
            }
            Ok::<_, FlatteningFailure<D>>(true)
        })?;
        Ok(self.finish(&best, allowance))
    }

    /// The polylines of the flattened pieces, and their bound.
    fn finish(&self, cuts: &[FlattenedPiece], allowance: &CurveAllowance) -> Bounded<Vec<Polyline<D>>> {
        let mut rest = cuts;
        let mut polylines = Vec::with_capacity(self.curves.len());
        for curve in self.curves {
            let (own_cuts, other_cuts) = rest.split_at(curve.segments().len());
            polylines.push(polyline(curve, own_cuts));
            rest = other_cuts;
        }
        // The slack of a path counts even if none of its pieces has a deviation.
        let slack = self.curves.iter().fold(0.0, |a: f64, c| greater(c.slack(), a));
        let at_most = cuts.iter().fold(slack, |most, cut| greater(cut.at_most, most));
        let (at_least, at) = self.measured_deviation(cuts, &polylines);
        let mut bound = Bound::proved(lesser(at_least, at_most), at_most, Reference::Curves);
        bound.at = at;
        bound.pixels = allowance.pixels.and_then(|(_, lens)| {
            self.parts.iter().zip(cuts).try_fold(0.0, |most: f64, (part, cut)| {
                let pixels = lens.scale_at(&part.bounds).pixels_of(cut.at_most)?;
                Some(greater(pixels, most))
            })
        });
        Bounded { shape: polylines, bound }
    }

    /// A measured deviation: the distance of the worst piece's farthest point from its polyline, rounded
    /// down.
    fn measured_deviation(
        &self,
        cuts: &[FlattenedPiece],
        polylines: &[Polyline<D>],
    ) -> (f64, Option<[f64; 3]>) {
        let worst =
            cuts.iter().enumerate().fold(None, |worst: Option<(usize, &FlattenedPiece)>, (index, cut)| {
                match worst {
                    Some((_, before)) if before.at_most >= cut.at_most => worst,
                    _ => Some((index, cut)),
                }
            });
        let Some((index, cut)) = worst else { return (0.0, None) };
        let mut first = 0;
        for (curve, polyline) in self.curves.iter().zip(polylines) {
            if index < first + curve.segments().len() {
                let point = curve.segments()[index - first].at(cut.worst);
                let distance = crate::check::distance_to_polyline(point, polyline);
                let error = mul_up(2.0, self.parts[index].rounding_error);
                // The rounding of the square root and of the sums is below 4 ε.
                let at_least = sub_down(distance * (1.0 - 1e-15), error);
                return (greater(at_least, 0.0), Some(to_3d(point)));
            }
            first += curve.segments().len();
        }
        (0.0, None)
    }
}

/// Paths as polylines.
struct CurveApproximation<'a, 'f, const D: usize> {
    paths: &'f Flattener<'a, D>,
    allowance: CurveAllowance,
}

impl<const D: usize> Approximation for CurveApproximation<'_, '_, D> {
    type Shape = Vec<Polyline<D>>;

    fn by_error(&self, most: u64) -> Result<Option<Bounded<Vec<Polyline<D>>>>, FlatteningFailure<D>> {
        if most > self.paths.limit() {
            self.paths.check_limits(&self.allowance)?;
        }
        let cuts = self.paths.cut(&self.allowance, most)?;
        Ok(cuts.map(|cuts| self.paths.finish(&cuts, &self.allowance)))
    }

    fn by_count(&self, most: u64) -> Result<Bounded<Vec<Polyline<D>>>, FlatteningFailure<D>> {
        self.paths.within_count(most, &self.allowance)
    }

    fn count(polylines: &Vec<Polyline<D>>) -> u64 {
        polylines.iter().map(|polyline| polyline.n_segments() as u64).sum()
    }
}

impl<const D: usize> PathPiece<'_, D> {
    /// A phrase about the largest part of the piece's own error, for a message.
    fn why_uncertain(&self) -> String {
        let (all, path) = (self.rounding_error, self.path);
        let [x, y] = [0, 1].map(|k| 0.5 * self.bounds.min[k] + 0.5 * self.bounds.max[k]);
        if 2.0 * self.arc_slack > all {
            let slack = self.arc_slack;
            format!(
                "the uncertainty {slack:.3e} of an arc of path {path} near ({x}, {y}): its ends, radii and rounded rotation make it nearly half an ellipse, or its ellipse is very flat"
            )
        } else if 2.0 * self.path_slack > all {
            let slack = self.path_slack;
            format!(
                "the rounding already in path {path}, {slack:.3e} (relative coordinates, rotations of arcs, transforms)"
            )
        } else {
            format!("the possible rounding error {all:.3e} at this distance from the origin")
        }
    }
}

impl FlattenedPiece {
    fn new<const D: usize>(part: &PathPiece<'_, D>, places: Vec<f64>) -> Self {
        let worst = part.chords.worst(&places);
        let at_most = if part.rounding_error > 0.0 { add_up(worst.0, part.rounding_error) } else { worst.0 };
        Self { places, at_most, worst: worst.1 }
    }

    fn n_segments(&self) -> u64 {
        self.places.len() as u64 - 1
    }
}

fn largest_deviation(cuts: &[FlattenedPiece]) -> f64 {
    cuts.iter().fold(0.0, |most: f64, cut| greater(cut.at_most, most))
}

/// The points of a path at the parameters of its flattened pieces.
fn polyline<const D: usize>(curve: &Curve<D>, cuts: &[FlattenedPiece]) -> Polyline<D> {
    let n: usize = cuts.iter().map(|cut| cut.places.len()).sum();
    let mut line = Polyline {
        points: Vec::with_capacity(n + 1),
        places: Vec::with_capacity(n + 1),
        closed: curve.is_closed(),
    };
    line.points.push(curve.start());
    line.places.push(0.0);
    for (index, (piece, cut)) in curve.segments().iter().zip(cuts).enumerate() {
        for t in &cut.places[1..] {
            let point = piece.at(*t);
            if line.points.last() != Some(&point) {
                line.points.push(point);
                line.places.push(index as f64 + t);
            }
        }
    }
    // The last point of a closed path is its first.
    if line.closed && line.points.len() > 1 {
        line.points.pop();
        line.places.pop();
    }
    line
}

/// A 2D or 3D point as a 3D point.
fn to_3d<const D: usize>(p: [f64; D]) -> [f64; 3] {
    std::array::from_fn(|k| p.get(k).copied().unwrap_or(0.0))
}
