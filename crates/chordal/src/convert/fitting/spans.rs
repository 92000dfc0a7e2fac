//! `SpanSearch`: cubics through a sequence of points, each over as many points as its bound allows.
use super::hermite::{fit, foot};
use super::point_path::PointPath;
use crate::budget::{Bound, Bounded, Failure, Job, Reference, RefusalCode, Tolerance};
use crate::explicit::{Bezier, Curve, CurveSegment};
use crate::math::{difference, distance, greater, length, lesser};

pub use super::point_path::Corners;

/// The largest distance of a spline from points or from a polyline, and its corners.
#[derive(Clone, Debug, PartialEq)]
pub struct SplineFit {
    /// The largest distance.
    pub length: Tolerance,
    /// The points at which it is not smooth.
    pub corners: Corners,
}

impl SplineFit {
    /// Within a length, with corners where points turn by more than 30 degrees.
    #[must_use]
    pub fn within(length: Tolerance) -> Self {
        // Chosen: the angle between the sides of a regular polygon with 12 corners.
        Self { length, corners: Corners::Sharper { deg: 30.0 } }
    }
}

/// Bytes of a point with its length, its parameter and its cubic.
const BYTES_PER_POINT: u64 = 256;
/// The most points of a span to which a cubic is fitted; the bound covers all points. Chosen: more points would hardly
/// change the cubic.
const FITTED: usize = 48;
/// The shares of a span by which the directions at its ends are computed; the first one that gives a cubic within the
/// tolerance is taken. Chosen: noise needs more, bends need less; with the first alone a polyline of one cubic took two
/// (`tests/fitting/polylines.rs`).
const WINDOWS: [f64; 2] = [0.25, 0.08];
/// The first guess of the number of segments in a span. Chosen: it is doubled or halved as needed.
const FIRST: usize = 8;

/// A bound of the distance of points from a cubic, by their parameters on it.
pub(crate) type SpanJudge<'a, const D: usize> = &'a dyn Fn(&[[f64; D]], &Bezier<D>, &[f64]) -> f64;

/// The shape to which a spline is fitted, and the largest distance from it.
pub(crate) struct SplineTruth<'a, const D: usize> {
    pub length: Tolerance,
    pub reference: Reference,
    pub judge: SpanJudge<'a, D>,
}

/// A cubic over the points up to an index, the direction there, and its bound.
#[derive(Clone, Copy, Debug)]
struct FittedSpan<const D: usize> {
    to: usize,
    cubic: Bezier<D>,
    direction: [f64; D],
    bound: f64,
}

/// The smooth run in which spans are searched.
struct SpanSearch<'a, const D: usize> {
    path: &'a PointPath<D>,
    judge: SpanJudge<'a, D>,
    allowed: f64,
    /// The last point of the run.
    end: usize,
    /// The direction there, if it is given.
    end_direction: Option<[f64; D]>,
}

/// The path of cubics and lines through the points of a path, smooth except at corners.
pub(crate) fn spline<const D: usize>(
    path: &PointPath<D>,
    truth: &SplineTruth<'_, D>,
    job: &Job,
) -> Result<Bounded<Curve<D>>, Failure<Curve<D>>> {
    let (length, reference) = (truth.length, truth.reference.clone());
    let not_finite = |message: String| Failure::refused(RefusalCode::NotFinite, message);
    if path.points.len() < 2 {
        let shape = Curve::point(path.points[0]).map_err(|why| not_finite(why.to_string()))?;
        return Ok(Bounded { shape, bound: Bound::exact(reference) });
    }
    let bytes = (path.points.len() as u64).saturating_mul(BYTES_PER_POINT);
    if bytes > job.memory_limit {
        let limit = job.memory_limit;
        let message =
            format!("a spline of these points needs about {bytes} bytes of memory; the limit is {limit}");
        return Err(Failure::refused(RefusalCode::TooMuchMemory, message));
    }
    let last = path.points.len() - 1;
    // A smooth closed path has one direction at its start and end, computed from the points of an eighth of it.
    // Chosen: points enough for a mean, and all of them near.
    let around = path.is_smooth().then(|| path.direction(0, path.length([0, last]) / 16.0, -1.0..1.0));
    let (mut pieces, mut at_most) = (Vec::new(), 0.0);
    for [start, end] in path.runs() {
        let search =
            SpanSearch { path, judge: truth.judge, allowed: length.get(), end, end_direction: around };
        let (mut at, mut direction, mut guess) = (start, around, FIRST);
        while at < end {
            if job.is_cancelled() {
                return Err(Failure::Cancelled);
            }
            if pieces.len() as u64 >= job.triangle_limit {
                let message = format!("the spline needs more than {} pieces, the limit", job.triangle_limit);
                return Err(Failure::refused(RefusalCode::TooManyTriangles, message));
            }
            let span = search.longest(at, direction, guess);
            // Bounds are never NaN.
            if span.bound > length.get() {
                let message = format!(
                    "the tolerance {:e} is less than the possible rounding error at this distance from the origin, {:.3e}",
                    length.get(),
                    span.bound
                );
                return Err(Failure::refused(RefusalCode::BelowPrecision, message));
            }
            guess = span.to - at;
            let (piece, bound) = search.piece(&span, at, [start, end]);
            pieces.push(piece);
            at_most = greater(bound, at_most);
            (at, direction) = (span.to, Some(span.direction));
        }
    }
    let shape = Curve::new(pieces, path.closed.into()).map_err(|why| not_finite(why.to_string()))?;
    Ok(Bounded { shape, bound: Bound::proved(0.0, at_most, reference) })
}

impl<const D: usize> SpanSearch<'_, D> {
    /// The longest span from a point on that is found to be allowed, by doubling or halving a guess and then bisection. If
    /// none is allowed, a span of one segment.
    fn longest(&self, from: usize, direction: Option<[f64; D]>, guess: usize) -> FittedSpan<D> {
        let most = self.end - from;
        let span = |n: usize| self.span(from, from + n, direction);
        let mut tried = guess.clamp(1, most);
        let mut good = span(tried);
        let mut bad = most + 1;
        if good.bound <= self.allowed {
            while tried < most {
                tried = (2 * tried).min(most);
                let next = span(tried);
                if next.bound <= self.allowed {
                    good = next;
                } else {
                    bad = tried;
                    break;
                }
            }
        } else {
            while tried > 1 && good.bound > self.allowed {
                bad = tried;
                tried /= 2;
                good = span(tried);
            }
        }
        // Here `good` is allowed, unless it has one segment; `bad` segments are too many, or beyond the run.
        while bad - (good.to - from) > 1 {
            let middle = (good.to - from) + (bad - (good.to - from)) / 2;
            let next = span(middle);
            if next.bound <= self.allowed { good = next } else { bad = middle }
        }
        good
    }

    /// The cubic over the points of a span.
    fn span(&self, from: usize, to: usize, direction: Option<[f64; D]>) -> FittedSpan<D> {
        let points = &self.path.points[from..=to];
        let mut best: Option<FittedSpan<D>> = None;
        for part in WINDOWS {
            let directions = self.directions([from, to], direction, part);
            let (cubic, bound) = match points.len() {
                2 => self.one_segment(points, &directions),
                _ => self.many(points, &directions),
            };
            let bound = if bound.is_nan() { f64::INFINITY } else { bound };
            if best.is_none_or(|best| bound < best.bound) {
                best = Some(FittedSpan { to, cubic, direction: directions[1], bound });
            }
            if bound <= self.allowed || points.len() == 2 {
                break;
            }
        }
        best.unwrap_or(FittedSpan {
            to,
            cubic: straight(points[0], points[0]),
            direction: [0.0; D],
            bound: f64::INFINITY,
        })
    }

    /// The directions at the ends of a span, by the points within a share of its length on each side, or within twice that on
    /// one side at the start or end of the run.
    fn directions(&self, [from, to]: [usize; 2], given: Option<[f64; D]>, part: f64) -> [[f64; D]; 2] {
        let reach = part * self.path.length([from, to]);
        let start = given.unwrap_or_else(|| self.path.direction(from, 2.0 * reach, 0.0..1.0));
        let end = if to < self.end {
            self.path.direction(to, reach, -1.0..1.0)
        } else {
            self.end_direction.unwrap_or_else(|| self.path.direction(to, 2.0 * reach, -1.0..0.0))
        };
        let chord = difference(self.path.points[to], self.path.points[from]);
        let far = length(chord);
        let or_chord = |d: [f64; D]| {
            if d.iter().any(|x| *x != 0.0) || far == 0.0 { d } else { chord.map(|x| x / far) }
        };
        [or_chord(start), or_chord(end)]
    }

    /// A cubic over one segment, with handles of a third of the segment, which are halved until it is allowed.
    fn one_segment(&self, points: &[[f64; D]], [u, v]: &[[f64; D]; 2]) -> (Bezier<D>, f64) {
        let (a, b) = (points[0], points[1]);
        let mut handle = distance(b, a) / 3.0;
        // A handle of 2⁻⁵² of a segment is lost in its rounding.
        for _ in 0..52 {
            let start = std::array::from_fn(|k| a[k] + handle * u[k]);
            let end = std::array::from_fn(|k| b[k] - handle * v[k]);
            let cubic = Bezier { control: [a, start, end, b] };
            let bound = (self.judge)(points, &cubic, &[0.0, 1.0]);
            if bound <= self.allowed {
                return (cubic, bound);
            }
            handle *= 0.5;
        }
        let cubic = straight(a, b);
        let bound = (self.judge)(points, &cubic, &[0.0, 1.0]);
        (cubic, bound)
    }

    fn many(&self, points: &[[f64; D]], directions: &[[f64; D]; 2]) -> (Bezier<D>, f64) {
        let last = points.len() - 1;
        if points.len() <= FITTED {
            let fitted = fit(points, directions);
            let places = in_order(fitted.places);
            return (fitted.cubic, (self.judge)(points, &fitted.cubic, &places));
        }
        let index = |i: usize| i * last / (FITTED - 1);
        let few: Vec<[f64; D]> = (0..FITTED).map(|i| points[index(i)]).collect();
        let fitted = fit(&few, directions);
        let mut places = Vec::with_capacity(points.len());
        for i in 1..FITTED {
            let (a, b) = (index(i - 1), index(i));
            for (k, point) in points[a..b].iter().enumerate() {
                // Points between those of the fit start from parameters between theirs.
                let part = k as f64 / (b - a) as f64;
                let near = (1.0 - part) * fitted.places[i - 1] + part * fitted.places[i];
                places.push(foot(&fitted.cubic, *point, near));
            }
        }
        places.push(1.0);
        places[0] = 0.0;
        let places = in_order(places);
        let bound = (self.judge)(points, &fitted.cubic, &places);
        (fitted.cubic, bound)
    }

    /// The piece of a span; a line if the span is a whole run between corners and the line is not much farther.
    fn piece(&self, span: &FittedSpan<D>, from: usize, run: [usize; 2]) -> (CurveSegment<D>, f64) {
        let points = &self.path.points[from..=span.to];
        let (a, b) = (points[0], points[points.len() - 1]);
        if [from, span.to] == run && self.end_direction.is_none() && a != b {
            let line = straight(a, b);
            let places = points.iter().map(|p| foot(&line, *p, 0.5)).collect();
            // A line is simpler, so its bound may be twice as large.
            let bound = (self.judge)(points, &line, &in_order(places));
            if bound <= lesser(2.0 * span.bound, self.allowed) {
                return (CurveSegment::Line([a, b]), bound);
            }
        }
        (CurveSegment::Cubic(span.cubic), span.bound)
    }
}

fn straight<const D: usize>(a: [f64; D], b: [f64; D]) -> Bezier<D> {
    let third = |near: [f64; D], far: [f64; D]| std::array::from_fn(|k| (2.0 * near[k] + far[k]) / 3.0);
    Bezier { control: [a, third(a, b), third(b, a), b] }
}

/// The parameters clamped so that they run from 0 to 1 and never decrease.
fn in_order(mut places: Vec<f64>) -> Vec<f64> {
    let mut least = 0.0;
    for place in &mut places {
        *place = greater(least, lesser(*place, 1.0));
        least = *place;
    }
    if let Some(first) = places.first_mut() {
        *first = 0.0;
    }
    if let Some(last) = places.last_mut() {
        *last = 1.0;
    }
    places
}
