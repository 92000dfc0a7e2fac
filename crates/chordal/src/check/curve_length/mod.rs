//! `CurveLength`: the lengths of paths and splines, and the parameters at which a length is reached,
//! enclosed.
mod speed;

use crate::budget::Tolerance;
use crate::explicit::nurbs::NurbsCurve;
use crate::explicit::{Curve, CurveSegment};
use crate::math::{Interval, PriorityItem, flushes_subnormals, greater, lesser};
use speed::SpeedPiece;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The length of a path or a spline along its parameter, in intervals that contain the exact values.
///
/// The curve is taken exactly as its numbers say: [`Curve::slack`] is ignored, since curves that are near
/// each other may differ in length by any amount. Hence a spline is measured itself, and not the path of
/// rounded pieces that [`NurbsCurve::to_curve`] gives.
///
/// The speed is integrated by Taylor polynomials about the middle of each part, whose last coefficient is
/// taken over the whole part, all in intervals. Parts are halved until their errors are small enough. If the
/// speed comes near 0, as in a cusp, the bound is its range, and parts get short.
///
/// ```
/// use chordal::{check::curves::CurveLength, explicit::nurbs::NurbsCurve};
/// let circle = NurbsCurve::circle([0.0, 0.0], [[1.0, 0.0], [0.0, 1.0]])?;
/// let length = CurveLength::from_nurbs(&circle, None);
/// assert!(length.total().contains(std::f64::consts::TAU) && length.total().width() < 1e-12);
/// // A quarter of the way lies a quarter of the turn.
/// let place = length.place_at(std::f64::consts::FRAC_PI_2).unwrap();
/// assert!(place.lo() - 1e-15 <= 0.25 && 0.25 <= place.hi() + 1e-15 && place.width() < 1e-12);
/// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
/// ```
///
/// *Cost.* Some ten parts of ten microseconds each for a piece of low degree without a tolerance; some
/// hundred parts if a piece has a cusp or very uneven weights.
///
/// Source: G. Corliss, L. Rall, *Adaptive, self-validating numerical quadrature*, 1987.
#[derive(Clone, Debug)]
pub struct CurveLength<const D: usize> {
    pieces: Vec<SpeedPiece<D>>,
    /// The start and the end of each piece, in the parameter of the whole curve.
    ranges: Vec<[f64; 2]>,
    parts: Vec<LengthPart>,
}

/// A part of a piece, in order along the curve.
#[derive(Clone, Copy, Debug)]
struct LengthPart {
    piece: usize,
    from: f64,
    to: f64,
    length: Interval,
    /// The length from the start of the curve to the start of the part.
    before: Interval,
}

/// Without a tolerance the errors of the parts sum up to this share of the length of the control polygon, or
/// to the rounding, which is larger for high degrees. Chosen: a smaller share gives more parts.
const NEAR: f64 = 64.0 * f64::EPSILON;

/// A part whose relative error is below this is settled: the rounding of a part of low degree. Measured.
const SETTLED: f64 = 32.0 * f64::EPSILON;

/// A part whose relative error is below this, and which halving does not improve, is as narrow as rounding
/// permits. Chosen: far above the largest measured rounding, 1e-13 for degrees up to 7, and far below the
/// error that a few halvings of a converging part leave.
const ROUNDED: f64 = 1e-9;

/// The most halvings of one piece. Chosen: after so many, a part with a bounded speed is as short as
/// rounding.
const DEEPEST: u32 = 60;

/// The most parts of a curve for each of its pieces. Chosen: it bounds the time of a curve whose parts do not
/// converge.
const MOST_PARTS: usize = 1 << 12;

impl<const D: usize> CurveLength<D> {
    /// The length of a path, within `tolerance` or, without one, as narrow as rounding permits: relative to
    /// the length some hundred ε. A place is a parameter of [`Curve::at`].
    ///
    /// If intervals stay wider, as for weights that differ by many orders of magnitude, they still hold. If
    /// subnormal numbers are flushed to zero, or numbers overflow, they reach to ∞.
    #[must_use]
    pub fn from_curve(curve: &Curve<D>, tolerance: Option<Tolerance>) -> Self {
        let pieces = curve.segments().iter().map(SpeedPiece::of_segment).collect::<Vec<_>>();
        let ranges = (0..pieces.len()).map(|k| [k as f64, (k + 1) as f64]).collect();
        let rough_length = curve.segments().iter().map(polygon_length).sum();
        Self::new(pieces, ranges, rough_length, tolerance)
    }

    /// The length of a spline, as [`CurveLength::from_curve`]; a place is its parameter.
    #[must_use]
    pub fn from_nurbs(curve: &NurbsCurve<D>, tolerance: Option<Tolerance>) -> Self {
        let n = curve.knots().n_pieces();
        let pieces = (0..n).map(|k| SpeedPiece::of_nurbs(curve, k)).collect();
        let ranges = (0..n).map(|k| curve.knots().piece(k)).collect();
        let rough_length = points_length(curve.control());
        Self::new(pieces, ranges, rough_length, tolerance)
    }

    fn new(
        pieces: Vec<SpeedPiece<D>>,
        ranges: Vec<[f64; 2]>,
        rough_length: f64,
        tolerance: Option<Tolerance>,
    ) -> Self {
        let goal = greater(tolerance.map_or(0.0, |t| 0.5 * t.get()), NEAR * rough_length);
        let part = |piece: usize, [from, to]: [f64; 2], depth: u32| {
            let part_length = SpeedPiece::length(&pieces[piece], from, to);
            let before = Interval::point(0.0);
            PriorityItem {
                bound: part_length.width(),
                item: (LengthPart { piece, from, to, length: part_length, before }, depth),
            }
        };
        let mut open: BinaryHeap<_> = (0..pieces.len()).map(|piece| part(piece, [0.0, 1.0], 0)).collect();
        let mut parts = Vec::new();
        let (mut waiting, mut settled, most) = (width_of(&open), 0.0, pieces.len() * MOST_PARTS);
        // The widest part first. A part that does not get narrower is limited by rounding, and stays.
        // Settled parts keep their error. If they have used up the goal, the others are still
        // refined to a quarter of it, and no further, since the sum would not get much smaller.
        while waiting > greater(goal - settled, 0.25 * goal) && open.len() + parts.len() < most {
            let Some(PriorityItem { bound, item: (widest, depth) }) = open.pop() else { break };
            let middle = 0.5 * (widest.from + widest.to);
            let halves = [[widest.from, middle], [middle, widest.to]]
                .map(|range| part(widest.piece, range, depth + 1));
            let narrower = halves[0].bound + halves[1].bound;
            // Halving a range halves its error; for polynomials it reduces the error more.
            let is_rounding = narrower > 0.6 * bound && bound <= ROUNDED * widest.length.hi();
            if depth >= DEEPEST || bound <= SETTLED * widest.length.hi() || is_rounding {
                (waiting, settled) = (waiting - bound, settled + bound);
                parts.push(widest);
                continue;
            }
            open.extend(halves);
            // Infinite widths cannot be subtracted; sums are recomputed now and then, since roundings add up.
            let is_new = bound.is_infinite() || open.len().is_power_of_two();
            waiting = if is_new { width_of(&open) } else { waiting + (narrower - bound) };
        }
        parts.extend(open.into_iter().map(|open| open.item.0));
        parts.sort_by(|a, b| (a.piece, a.from).partial_cmp(&(b.piece, b.from)).unwrap_or(Ordering::Equal));
        let mut before = Interval::point(0.0);
        for part in &mut parts {
            part.before = before;
            let sum = before + part.length;
            // Lengths do not decrease along the curve, which sums rounded down may violate.
            before = Interval::from_endpoints(greater(sum.lo(), before.lo()), sum.hi());
        }
        Self { pieces, ranges, parts }
    }

    /// The length of the whole curve.
    #[must_use]
    pub fn total(&self) -> Interval {
        if flushes_subnormals() {
            return unknown();
        }
        self.parts.last().map_or(Interval::point(0.0), |part| positive(part.before + part.length))
    }

    /// The length from the start to a place; outside the curve, to the nearer end.
    #[must_use]
    pub fn up_to(&self, place: f64) -> Interval {
        if flushes_subnormals() {
            return unknown();
        }
        let after = self.ranges.partition_point(|range| range[0] <= place);
        let Some(piece) = after.checked_sub(1) else { return Interval::point(0.0) };
        if place >= self.ranges[piece][1] {
            // The end of the last piece: any other piece ends where the next one starts.
            return self.total();
        }
        let [from, to] = self.ranges[piece].map(Interval::point);
        // The parameter within the piece lies between two numbers, and lengths grow with it.
        let local = (Interval::point(place) - from) / (to - from);
        let [low, high] = [local.lo(), local.hi()].map(|at| greater(lesser(at, 1.0), 0.0));
        let low = self.up_to_local(piece, low);
        if low.1 == high { low.0 } else { low.0.hull(self.up_to_local(piece, high).0) }
    }

    /// The length from the start to a parameter of a piece, with that parameter.
    fn up_to_local(&self, piece: usize, at: f64) -> (Interval, f64) {
        let next = self.parts.partition_point(|part| (part.piece, part.from) <= (piece, at));
        let part = self.parts[next.saturating_sub(1)];
        let length = if at <= part.from {
            part.before
        } else if at >= part.to {
            part.before + part.length
        } else {
            // The whole part is at least as long as any part of it.
            let rest_length = self.pieces[piece].length(part.from, at);
            part.before + rest_length.intersection(Interval::from_endpoints(0.0, part.length.hi()))
        };
        (positive(length), at)
    }

    /// All places at which the length from the start may be `length`: one place, known to some roundings, or
    /// a stretch along which the curve stands still. `None` if the curve is certainly shorter, or if the
    /// length is negative or not finite.
    ///
    /// *Cost.* Some hundred parts of the curve.
    #[must_use]
    pub fn place_at(&self, length: f64) -> Option<Interval> {
        let is_reached = length >= 0.0 && length.is_finite() && length <= self.total().hi();
        let (first, last) = (self.parts.first()?, self.parts.last()?);
        if !is_reached {
            return None;
        }
        let ends = [(first.piece, first.from), (last.piece, last.to)];
        if flushes_subnormals() {
            return Some(self.place(ends[0]).hull(self.place(ends[1])));
        }
        // The length is certainly shorter before one end, and certainly longer after the other.
        let shorter = self.parts.partition_point(|part| part.before.hi() < length);
        let longer = self.parts.partition_point(|part| part.before.lo() <= length);
        let low = self.parts[shorter.saturating_sub(1)];
        let high = self.parts[longer.saturating_sub(1)];
        let from = self.halved(low, |length_to| length_to.hi() < length, |is_shorter| is_shorter);
        let to = self.halved(high, |length_to| length_to.lo() > length, |is_longer| !is_longer);
        Some(self.place((low.piece, from[0])).hull(self.place((high.piece, to[1]))))
    }

    /// Halves a part until its ends are neighbours: the test holds at one end, and need not at the other.
    fn halved(
        &self,
        part: LengthPart,
        test: impl Fn(Interval) -> bool,
        goes_on_after: impl Fn(bool) -> bool,
    ) -> [f64; 2] {
        let (mut from, mut to) = (part.from, part.to);
        for _ in 0..DEEPEST {
            let middle = 0.5 * (from + to);
            if !(from < middle && middle < to) {
                break;
            }
            if goes_on_after(test(self.up_to_local(part.piece, middle).0)) {
                from = middle;
            } else {
                to = middle;
            }
        }
        [from, to]
    }

    /// The place of a parameter of a piece, with its rounding.
    fn place(&self, (piece, at): (usize, f64)) -> Interval {
        let [from, to] = self.ranges[piece];
        match at {
            0.0 => Interval::point(from),
            1.0 => Interval::point(to),
            _ => {
                let (at, from, to) = (Interval::point(at), Interval::point(from), Interval::point(to));
                from + at * (to - from)
            }
        }
    }
}

/// The sum of the widths of the open parts.
fn width_of(open: &BinaryHeap<PriorityItem<(LengthPart, u32)>>) -> f64 {
    open.iter().fold(0.0, |sum, part| sum + part.bound)
}

fn positive(length: Interval) -> Interval {
    length.max(Interval::point(0.0))
}

/// Any length.
fn unknown() -> Interval {
    positive(Interval::ENTIRE)
}

/// The approximate length of a piece: the length of its control polygon.
fn polygon_length<const D: usize>(segment: &CurveSegment<D>) -> f64 {
    match segment {
        CurveSegment::Line(ends) => points_length(ends),
        CurveSegment::Cubic(cubic) => points_length(&cubic.control),
        CurveSegment::Arc(arc) => {
            let points: Vec<[f64; D]> = (0..=8).map(|k| arc.at(f64::from(k) / 8.0)).collect();
            points_length(&points)
        }
        CurveSegment::Rational(curve) => points_length(&curve.control()),
    }
}

fn points_length<const D: usize>(points: &[[f64; D]]) -> f64 {
    let step = |pair: &[[f64; D]]| -> f64 {
        let square: f64 = (0..D).map(|k| (pair[1][k] - pair[0][k]) * (pair[1][k] - pair[0][k])).sum();
        square.sqrt()
    };
    points.windows(2).map(step).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explicit::Bezier;

    #[test]
    fn few_parts_make_the_length_of_a_smooth_piece_and_more_that_of_a_cusp() {
        let parts = |control: [[f64; 2]; 4]| {
            let length = CurveLength::from_curve(&Curve::from(Bezier { control }), None);
            assert!(length.total().width() < 1e-12, "{}", length.total());
            length.parts.len()
        };
        // Measured: 32 and 219.
        let smooth = parts([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]);
        let cusp = parts([[0.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0, 0.0]]);
        assert!(smooth <= 40 && cusp <= 260 && smooth < cusp, "{smooth} {cusp}");
    }
}
