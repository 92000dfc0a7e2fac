//! The arrow from points to a path of cubics that passes near them.
use super::curves::chord::{coordinate_reach, rounding_at};
use super::curves::flatten::refuse_flushing;
use super::fitting::point_path::PointPath;
use super::fitting::spans::{SplineFit, SplineTruth, spline};
use crate::budget::{Bounded, Failure, Job, Metric, Reference};
use crate::explicit::{Bezier, Curve, CurveEnds};
use crate::math::{difference, greater, length};

/// A path of few cubics within a distance of points in a row.
///
/// **Bound.** The largest distance from a point to the path, *proved*, rounding included: the metric is
/// [`Metric::OneSided`]. Between two points the path may be farther from both. `at_least` is 0.
///
/// **Path.** It starts and ends at the first and the last point (a closed one, at the first, or at a corner), and pieces
/// meet at points. There they have the same direction (G1, up to rounding), but at corners. Of points in a row that are
/// equal one counts; a single one gives a path that is a point. What two corners have between them is a line where one is
/// near enough.
///
/// **Method.** Directions where pieces meet come from the points about them, by a polynomial of degree 3 near them; each
/// piece is the cubic with these that is nearest to its points, and goes as far as the length allows. With noise, give the
/// corners by their indices: between noisy points every angle is large.
///
/// **Cost.** In time n log n at most: each span is fitted a number of times that is the logarithm of its size.
///
/// # Errors
/// [`Failure::Refused`]: no point, a number that is not finite or beyond 1e150, a corner that is no point or an angle
/// beyond 180 degrees, a length below rounding, more pieces or bytes than the job allows, an environment that flushes
/// subnormals. [`Failure::Cancelled`].
///
/// ```
/// use chordal::convert::splines::{SplineFit, points_to_spline};
/// use chordal::explicit::CurveEnds;
/// use chordal::{Job, Tolerance};
/// let wave: Vec<[f64; 2]> = (0..=200).map(|i| f64::from(i) / 20.0).map(|x| [x, x.sin()]).collect();
/// let near = |length| {
///     let fit = SplineFit::within(Tolerance::new(length).unwrap());
///     points_to_spline(&wave, CurveEnds::Open, &fit, &Job::default()).unwrap()
/// };
/// assert!(near(1e-3).bound.at_most().unwrap() <= 1e-3);
/// assert!(near(1e-3).shape.segments().len() < 12);
/// ```
///
/// Source: P. J. Schneider, *An algorithm for automatically fitting digitized curves*, 1990, with other directions, another
/// solver, and long spans by search instead of halving.
pub fn points_to_spline<const D: usize>(
    points: &[[f64; D]],
    ends: CurveEnds,
    fit: &SplineFit,
    job: &Job,
) -> Result<Bounded<Curve<D>>, Failure<Curve<D>>> {
    refuse_flushing()?;
    let path = PointPath::new(points, ends == CurveEnds::Closed, &fit.corners)?;
    let truth = SplineTruth { length: fit.length, reference: Reference::InputPoints, judge: &farthest_point };
    let mut made = spline(&path, &truth, job)?;
    made.bound.metric = Metric::OneSided;
    Ok(made)
}

/// The largest distance of a point from the place of the cubic that is its own.
fn farthest_point<const D: usize>(points: &[[f64; D]], cubic: &Bezier<D>, places: &[f64]) -> f64 {
    let reach = greater(coordinate_reach(points), coordinate_reach(&cubic.control));
    let far = points.iter().zip(places).map(|(p, s)| length(difference(cubic.at(*s), *p)));
    let more = |far: f64, one: f64| if one.is_nan() { f64::INFINITY } else { greater(one, far) };
    // An evaluation loses a sixteenth of what is allowed for a chord, and the distance less.
    (far.fold(0.0, more) + rounding_at(reach)).next_up()
}
