//! Approximates a rational piece by cubics, from its start to its end, each over as long a span as its bound allows.
use super::hermite::fit;
use super::least_squares::solve;
use super::rational_error::{RUN, RationalPart, RunFactors};
use crate::convert::curves::chord::coordinate_reach;
use crate::explicit::Bezier;
use crate::explicit::nurbs::RationalBezier;
use crate::math::{difference, greater, length, lesser};

/// Points of a span to which the cubic is fitted, its ends included. Chosen: several times the freedom of a cubic.
const SAMPLES: usize = 14;
/// The most trials for the end of a span. Chosen: bounds fall with the sixth power of its size, so that three or four
/// suffice.
const TRIALS: u32 = 64;

/// The cubics, and the largest bound of one.
#[derive(Debug)]
pub(crate) struct CubicSpans<const D: usize> {
    pub cubics: Vec<Bezier<D>>,
    pub at_most: f64,
}

/// The reason why there are no cubics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SpanFailure {
    /// More than allowed.
    TooMany,
    /// Not even the shortest span is near enough.
    BelowPrecision,
    Cancelled,
}

/// A rational piece that is divided into spans.
struct RationalSpans<'a, const D: usize> {
    curve: &'a RationalBezier<D>,
    factors: RunFactors,
    reach: f64,
}

/// A span's end and the direction there.
#[derive(Clone, Copy)]
struct SpanEnd<const D: usize> {
    at: f64,
    point: [f64; D],
    direction: [f64; D],
}

/// Few cubics by a greedy choice, each within `allowed` of the piece; at most `most` of them.
pub(crate) fn cubics<const D: usize>(
    curve: &RationalBezier<D>,
    allowed: f64,
    most: u64,
    is_cancelled: impl Fn() -> bool,
) -> Result<CubicSpans<D>, SpanFailure> {
    let mut points = curve.control();
    points.extend(curve.ends());
    let spans =
        RationalSpans { curve, factors: RunFactors::new(curve.degree()), reach: coordinate_reach(&points) };
    let mut spans_so_far = CubicSpans { cubics: Vec::new(), at_most: 0.0 };
    let mut from = spans.end_at(0.0);
    let mut step = 1.0;
    while from.at < 1.0 {
        if is_cancelled() {
            return Err(SpanFailure::Cancelled);
        }
        if spans_so_far.cubics.len() as u64 >= most {
            return Err(SpanFailure::TooMany);
        }
        let (cubic, bound, to) = spans.longest(&from, step, allowed).ok_or(SpanFailure::BelowPrecision)?;
        spans_so_far.at_most = greater(bound, spans_so_far.at_most);
        spans_so_far.cubics.push(cubic);
        step = to.at - from.at;
        from = to;
    }
    Ok(spans_so_far)
}

impl<const D: usize> RationalSpans<'_, D> {
    fn end_at(&self, at: f64) -> SpanEnd<D> {
        let [tangent, _] = self.curve.derivatives(at);
        let speed = length(tangent);
        // If control points coincide, or weights make the derivative nearly vanish, the tangent is unreliable, and points
        // nearby give the direction. Chosen: a millionth of the piece's size.
        let direction = if speed > 1e-6 * self.reach && speed.is_finite() {
            tangent.map(|x| x / speed)
        } else {
            self.towards(at, 1.0 / 64.0).unwrap_or([0.0; D])
        };
        SpanEnd { at, point: self.curve.at(at), direction }
    }

    /// The direction between two points of the piece on both sides of `at`, or on one side at the piece's ends.
    fn towards(&self, at: f64, step: f64) -> Option<[f64; D]> {
        let (a, b) = (greater(0.0, at - step), lesser(at + step, 1.0));
        let chord = difference(self.curve.at(b), self.curve.at(a));
        let norm = length(chord);
        (norm > 0.0 && norm.is_finite()).then(|| chord.map(|x| x / norm))
    }

    /// The longest span found from an end on; `step` is a guess of its width.
    fn longest(&self, from: &SpanEnd<D>, step: f64, allowed: f64) -> Option<(Bezier<D>, f64, SpanEnd<D>)> {
        let mut best: Option<(Bezier<D>, f64, SpanEnd<D>)> = None;
        let (mut good, mut bad) = (from.at, f64::INFINITY);
        let mut at = lesser(from.at + 1.25 * step, 1.0);
        // A short rest would be a span of its own.
        if 1.0 - at < 0.25 * step {
            at = 1.0;
        }
        for _ in 0..TRIALS {
            if at <= from.at || at.is_nan() {
                break;
            }
            let to = self.end_at(at);
            let (cubic, bound) = self.span(from, &to);
            let ratio = libm::cbrt((allowed / bound).sqrt());
            if bound <= allowed {
                good = at;
                best = Some((cubic, bound, to));
                if at >= 1.0 {
                    break;
                }
            } else {
                bad = at;
            }
            // The sixth root predicts the end at which the bound would be just small enough; since predictions from afar are
            // unreliable, the step is limited.
            let ratio = if ratio > 0.0 { lesser(ratio, 2.0) } else { 0.5 };
            let next = from.at + (at - from.at) * greater(0.99 * ratio, 0.1);
            let next = lesser(next, 1.0);
            let inside = next > good && next < bad;
            at = if inside { next } else { 0.5 * (good + lesser(bad, 1.0)) };
            // Chosen: two hundredths more of a span are not worth a trial.
            if best.is_some() && lesser(at, bad) - good < 0.02 * (good - from.at) {
                break;
            }
        }
        best
    }

    /// The cubic of a span, and its bound.
    fn span(&self, from: &SpanEnd<D>, to: &SpanEnd<D>) -> (Bezier<D>, f64) {
        let width = to.at - from.at;
        let part = RationalPart {
            weighted: self.curve.weighted().part(from.at, to.at),
            weights: self.curve.weights().part(from.at, to.at),
            reach: self.reach,
        };
        let own = |i: usize| i as f64 / (SAMPLES - 1) as f64;
        let points: Vec<[f64; D]> = (0..SAMPLES)
            .map(|i| match i {
                0 => from.point,
                _ if i == SAMPLES - 1 => to.point,
                _ => self.curve.at(from.at + width * own(i)),
            })
            .collect();
        let straight = straight(from.point, to.point);
        if points.iter().all(|p| *p == points[0]) {
            return (straight, self.factors.distance(&part, &straight, &even_run()));
        }
        let fitted = fit(&points, &[from.direction, to.direction]);
        let run = run_through(&fitted.places, own).unwrap_or_else(even_run);
        let bound = self.factors.distance(&part, &fitted.cubic, &run);
        (fitted.cubic, bound)
    }
}

fn straight<const D: usize>(a: [f64; D], b: [f64; D]) -> Bezier<D> {
    let third = |near: [f64; D], far: [f64; D]| std::array::from_fn(|k| (2.0 * near[k] + far[k]) / 3.0);
    Bezier { control: [a, third(a, b), third(b, a), b] }
}

/// `φ(s) = s`.
fn even_run() -> [f64; RUN + 1] {
    std::array::from_fn(|i| i as f64 / RUN as f64)
}

/// The coefficients of the `φ` that maps the samples' parameters on the cubic to those on the piece, by least squares.
fn run_through(places: &[f64], own: impl Fn(usize) -> f64) -> Option<[f64; RUN + 1]> {
    const INNER: usize = RUN - 1;
    let (mut matrix, mut right) = ([[0.0; INNER]; INNER], [[0.0; 1]; INNER]);
    for (i, s) in places.iter().enumerate() {
        let basis = bernstein_of_run(*s);
        // The first coefficient is 0, and the last is 1.
        let residual = own(i) - basis[RUN];
        for j in 0..INNER {
            right[j][0] += basis[j + 1] * residual;
            for k in 0..INNER {
                matrix[j][k] += basis[j + 1] * basis[k + 1];
            }
        }
    }
    let solved = solve(matrix, right)?;
    let inner = |i: usize| greater(0.0, lesser(solved[i - 1][0], 1.0));
    Some(std::array::from_fn(|i| match i {
        0 => 0.0,
        RUN => 1.0,
        _ => inner(i),
    }))
}

/// The Bernstein polynomials of the degree of `φ`.
fn bernstein_of_run(s: f64) -> [f64; RUN + 1] {
    let mut row = [0.0; RUN + 1];
    row[0] = 1.0;
    for n in 1..=RUN {
        for i in (1..=n).rev() {
            row[i] = (1.0 - s) * row[i] + s * row[i - 1];
        }
        row[0] *= 1.0 - s;
    }
    row
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explicit::CurveSegment;
    use crate::explicit::nurbs::NurbsCurve;

    fn quarter() -> RationalBezier<2> {
        let circle = NurbsCurve::circle([0.0; 2], [[1.0, 0.0], [0.0, 1.0]]).unwrap().to_curve().unwrap();
        let CurveSegment::Rational(quarter) = &circle.segments()[0] else { panic!("a quarter") };
        quarter.clone()
    }

    fn n(allowed: f64) -> (usize, f64) {
        let spans = cubics(&quarter(), allowed, u64::MAX, || false).unwrap();
        (spans.cubics.len(), spans.at_most)
    }

    #[test]
    fn a_quarter_of_a_circle_takes_about_as_many_as_the_sixth_order_says() {
        let counts: Vec<(usize, f64)> = [2.6e-4, 1e-6, 1e-8, 1e-10].map(n).to_vec();
        eprintln!("{counts:?}");
        assert_eq!(counts[0].0, 1);
        // One cubic is off by 2e-4 at best; k of them by that over k⁶: 2.4, 5.2, 11.2.
        assert!(counts[1].0 <= 3 && counts[2].0 <= 6 && counts[3].0 <= 13, "{counts:?}");
    }

    #[test]
    fn the_bound_is_near_the_distance() {
        for allowed in [2.6e-4, 1e-6, 1e-8] {
            let spans = cubics(&quarter(), allowed, u64::MAX, || false).unwrap();
            let far = |c: &Bezier<2>| {
                let distances = (0..=1000).map(|i| (length(c.at(f64::from(i) / 1000.0)) - 1.0).abs());
                distances.fold(0.0, |most: f64, x| greater(most, x))
            };
            let most = spans.cubics.iter().map(far).fold(0.0, |most: f64, x| greater(most, x));
            eprintln!("{allowed}: {most} of {}", spans.at_most);
            assert!(most <= spans.at_most && spans.at_most < 1.5 * most, "{most} {}", spans.at_most);
        }
    }
}
