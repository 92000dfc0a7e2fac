//! Closest points of paths and splines, with proved distances.
//!
//! Relative to the query, a piece is `V(t)/W(t)`. The coefficients of `|V|²` and of `W²` in Bernstein form
//! bound the squared distance: if `|V|²ᵢ ≥ λ·(W²)ᵢ` for all of them, then `|V|² ≥ λ·W²` along the piece.
//! Pieces are halved, best first; the bound converges to the distance with the square of the length of a
//! part. Ends of parts are points of the curve and bound the distance from above. All arithmetic is on
//! intervals, so that rounding is covered.
//!
//! Source: X.-D. Chen et al., *Computing the minimum distance between a point and a NURBS curve*, 2008 (the
//! squared distance in Bernstein form).
use crate::budget::Tolerance;
use crate::explicit::nurbs::{BernsteinFactors, EnclosedPiece, NurbsCurve};
use crate::explicit::{Curve, CurveSegment};
use crate::math::{
    Interval, PriorityItem, add_up, exponent, flushes_subnormals, greater, lesser, power_of_two, sub_down,
};
use std::collections::BinaryHeap;

/// The closest point of a path or a spline to a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveClosestPoint<const D: usize> {
    /// The closest point found, rounded.
    pub point: [f64; D],
    /// Its position on the path ([`Curve::at`]), or its parameter on the spline, rounded.
    pub place: f64,
    /// Lower bound for the distance of the entire curve; proved, rounding included.
    pub at_least: f64,
    /// Upper bound for the distance of the curve; proved, rounding included.
    pub at_most: f64,
}

/// The most parts that are halved. Chosen: enough for some dozen equally close points.
const MOST_PARTS: usize = 1 << 14;

/// The bounds are as close as rounding permits when they differ by less than this, for each coefficient of a
/// piece and in units of the largest coordinate relative to the query. Measured on curves of degree 5: 20
/// without weights and 28 with them.
const NEAR: f64 = 32.0 * f64::EPSILON;

impl<const D: usize> Curve<D> {
    /// The closest point of the path to `p`; `None` if `p` is not finite.
    ///
    /// Two bounds enclose the distance of the exact path, [`Curve::slack`] included. They are within
    /// `tolerance` of each other, or, without one, as close as rounding permits: `32(p + 1)·ε` times the
    /// largest coordinate of a control point relative to the query, for pieces of degree `p`. If very many
    /// points are nearly equally close, they may stay farther apart but still hold. Among equally close
    /// points any may be returned, but always the same one. If subnormal numbers are flushed to zero, the
    /// bounds are 0 and ∞.
    ///
    /// *Cost.* All pieces are evaluated, some microseconds each, and some hundred parts of the closest ones:
    /// measured 0.5 to 2 ms for five pieces of degree 5, and up to 100 ms if weights differ by orders of
    /// magnitude.
    ///
    /// ```
    /// use chordal::{Bezier, explicit::Curve};
    /// let arch = Curve::from(Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] });
    /// let closest = arch.closest_point([0.5, 1.0], None).unwrap();
    /// assert!(closest.at_least <= 0.25 && 0.25 <= closest.at_most && closest.at_most - closest.at_least < 1e-14);
    /// assert!((closest.place - 0.5).abs() < 1e-6);
    /// ```
    #[must_use]
    pub fn closest_point(&self, p: [f64; D], tolerance: Option<Tolerance>) -> Option<CurveClosestPoint<D>> {
        let mut pieces = Vec::new();
        let mut slack = self.slack();
        for segment in self.segments() {
            pieces.extend(EnclosedPiece::of_segment(segment, p));
            if let CurveSegment::Arc(arc) = segment {
                slack =
                    greater(slack, if arc.slack() == 0.0 { 0.0 } else { add_up(self.slack(), arc.slack()) });
            }
        }
        if pieces.is_empty() {
            // A path of one point has no pieces; a line of length 0 stands for it.
            let start = self.start();
            pieces.extend(EnclosedPiece::of_segment(&CurveSegment::Line([start; 2]), p));
        }
        let closest = search(pieces, p, tolerance)?;
        let place = self.place_of(closest.piece, closest.at);
        let (at_least, at_most) = if slack == 0.0 {
            (closest.at_least, closest.at_most)
        } else {
            (greater(sub_down(closest.at_least, slack), 0.0), add_up(closest.at_most, slack))
        };
        Some(CurveClosestPoint { point: self.at(place), place, at_least, at_most })
    }

    /// The position on the path of a parameter on one of its pieces; an arc has several pieces.
    fn place_of(&self, piece: usize, at: f64) -> f64 {
        let mut before = 0;
        for (index, segment) in self.segments().iter().enumerate() {
            let n = match segment {
                CurveSegment::Arc(arc) => crate::explicit::nurbs::arc_pieces(arc) as usize,
                _ => 1,
            };
            if piece < before + n {
                let t = match segment {
                    CurveSegment::Arc(arc) => {
                        // The angle of a point of a rational quadratic: the tangent of half the angle is
                        // linear in the parameter.
                        let half = 0.5 * arc.sweep_rad() / n as f64;
                        let angle = half + 2.0 * libm::atan(libm::tan(0.5 * half) * (2.0 * at - 1.0));
                        let share = if half == 0.0 { at } else { angle / (2.0 * half) };
                        ((piece - before) as f64 + share) / n as f64
                    }
                    _ => at,
                };
                return index as f64 + greater(lesser(t, 1.0), 0.0);
            }
            before += n;
        }
        0.0
    }
}

impl<const D: usize> NurbsCurve<D> {
    /// The closest point of the curve to `p`; `None` if `p` is not finite. The bounds and their limits are
    /// those of [`Curve::closest_point`]; they hold for this curve itself, not for its rounded pieces.
    ///
    /// ```
    /// use chordal::explicit::nurbs::NurbsCurve;
    /// let circle = NurbsCurve::circle([0.0, 0.0], [[1.0, 0.0], [0.0, 1.0]])?;
    /// let closest = circle.closest_point([3.0, 4.0], None).unwrap();
    /// assert!(closest.at_least <= 4.0 && 4.0 <= closest.at_most && closest.at_most - closest.at_least < 1e-13);
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    #[must_use]
    pub fn closest_point(&self, p: [f64; D], tolerance: Option<Tolerance>) -> Option<CurveClosestPoint<D>> {
        let pieces = (0..self.knots().n_pieces()).map(|k| EnclosedPiece::of_nurbs(self, k, p)).collect();
        let closest = search(pieces, p, tolerance)?;
        let place = self.knots().parameter(closest.piece, closest.at);
        let CurvePlace { at_least, at_most, .. } = closest;
        Some(CurveClosestPoint { point: self.at(place), place, at_least, at_most })
    }
}

/// The result of a search.
struct CurvePlace {
    piece: usize,
    at: f64,
    at_least: f64,
    at_most: f64,
}

/// A part of a piece.
struct CurvePart<const D: usize> {
    piece: usize,
    from: f64,
    to: f64,
    rows: EnclosedPiece<D>,
}

fn search<const D: usize>(
    mut pieces: Vec<EnclosedPiece<D>>,
    p: [f64; D],
    tolerance: Option<Tolerance>,
) -> Option<CurvePlace> {
    if !p.iter().all(|x| x.is_finite()) {
        return None;
    }
    // A power of two, so that squares neither overflow nor underflow in relevant places.
    let reach = |piece: &EnclosedPiece<D>| {
        let weights = piece.weights.as_ref();
        let distance = |(i, x): (usize, &[Interval; D])| {
            let largest = x.iter().fold(0.0, |largest: f64, x| greater(x.magnitude(), largest));
            largest / weights.map_or(1.0, |w| w.0[i][0].hi())
        };
        piece.points.0.iter().enumerate().map(distance).fold(0.0, |largest: f64, x| greater(x, largest))
    };
    let farthest = pieces.iter().fold(0.0, |largest: f64, piece| greater(reach(piece), largest));
    let mut best = CurvePlace { piece: 0, at: 0.0, at_least: 0.0, at_most: f64::INFINITY };
    if flushes_subnormals() || !farthest.is_finite() {
        return Some(best);
    }
    let scale = Interval::point(power_of_two(-exponent(farthest)));
    let n_coefficients =
        pieces.iter().fold(0, |n_coefficients, piece| piece.points.0.len().max(n_coefficients));
    let close_enough = greater(tolerance.map_or(0.0, |t| t.get()), NEAR * n_coefficients as f64 * farthest);
    let mut factors: Vec<Option<BernsteinFactors>> = Vec::new();
    let mut open: BinaryHeap<PriorityItem<CurvePart<D>>> = BinaryHeap::new();
    let mut parts: Vec<CurvePart<D>> = Vec::new();
    for (piece, rows) in pieces.iter_mut().enumerate() {
        rows.scale(scale);
        let degree = rows.points.degree();
        if factors.len() <= degree {
            factors.resize(degree + 1, None);
        }
        factors[degree].get_or_insert_with(|| BernsteinFactors::new(degree, degree));
        parts.push(CurvePart { piece, from: 0.0, to: 1.0, rows: rows.clone() });
    }
    let nearer = |part: &CurvePart<D>, best: &mut CurvePlace| {
        let last = part.rows.points.degree();
        for (i, at) in [(0, part.from), (last, part.to)] {
            let distance = end_distance(&part.rows, i, scale).hi();
            if distance < best.at_most {
                *best = CurvePlace { piece: part.piece, at, at_most: distance, ..*best };
            }
        }
    };
    for part in &parts {
        nearer(part, &mut best);
    }
    let bound = |part: &CurvePart<D>| {
        let factors = factors[part.rows.points.degree()].as_ref();
        factors.map_or(0.0, |factors| distance_down(&part.rows, factors, scale))
    };
    // The heap gives the largest, and the nearest part is wanted.
    for part in parts {
        open.push(PriorityItem { bound: -bound(&part), item: part });
    }
    for _ in 0..MOST_PARTS {
        let Some(PriorityItem { bound: negative, item: part }) = open.pop() else { break };
        best.at_least = -negative;
        let middle = 0.5 * (part.from + part.to);
        // There is no number between neighbouring numbers.
        let is_shortest = middle <= part.from || middle >= part.to;
        if best.at_most - best.at_least <= close_enough || is_shortest {
            best.at_least = lesser(best.at_least, best.at_most);
            return Some(best);
        }
        for [from, to] in [[part.from, middle], [middle, part.to]] {
            // Computed from the entire piece: halves of halves would add up their roundings.
            let half = CurvePart { piece: part.piece, from, to, rows: pieces[part.piece].part(from, to) };
            nearer(&half, &mut best);
            let down = bound(&half);
            // A part is no nearer than the part it came from.
            let down = greater(down, -negative);
            if down <= best.at_most {
                open.push(PriorityItem { bound: -down, item: half });
            }
        }
    }
    // Every remaining part is at least this far; the dropped ones are farther than a point that was found.
    best.at_least = lesser(open.pop().map_or(best.at_most, |part| -part.bound), best.at_most);
    Some(best)
}

/// The distance of the end with coefficient `i`.
fn end_distance<const D: usize>(rows: &EnclosedPiece<D>, i: usize, scale: Interval) -> Interval {
    let square = rows.points.0[i].iter().fold(Interval::point(0.0), |sum, x| sum + x.square());
    let distance = square.sqrt() / scale;
    rows.weights.as_ref().map_or(distance, |w| distance / w.0[i][0])
}

/// A lower bound for the distance of all points of a part.
fn distance_down<const D: usize>(
    rows: &EnclosedPiece<D>,
    factors: &BernsteinFactors,
    scale: Interval,
) -> f64 {
    let x = &rows.points.0;
    let dot = |i: usize, j: usize| {
        // Use that a square is at least 0, which a product of two intervals does not imply.
        let product = |k: usize| if i == j { x[i][k].square() } else { x[i][k] * x[j][k] };
        (1..D).fold(product(0), |sum, k| sum + product(k))
    };
    let squares = factors.products(|i, j| Some(dot(i, j)));
    let shares: Vec<Interval> = match &rows.weights {
        None => squares,
        Some(weights) => {
            let w = &weights.0;
            let weight_products = factors.products(|i, j| Some(w[i][0] * w[j][0]));
            squares.iter().zip(&weight_products).map(|(square, weight)| *square / *weight).collect()
        }
    };
    let smallest = shares.iter().fold(f64::INFINITY, |smallest, share| lesser(share.lo(), smallest));
    let root = Interval::point(greater(smallest, 0.0)).sqrt() / scale;
    greater(root.lo(), 0.0)
}
