//! The arrow from points to a path of cubics near them.
use super::curves::chord::{coordinate_reach, rounding_at};
use super::curves::flatten::refuse_flushing;
use super::fitting::point_path::PointPath;
use super::fitting::spans::{SplineFit, SplineTruth, spline};
use crate::budget::{Bounded, Failure, Job, Metric, Reference};
use crate::explicit::{Bezier, Curve, CurveEnds};
use crate::math::{distance, greater};

/// A path of few cubics within a distance of a sequence of points.
///
/// **Bound.** The largest distance from a point to the path, *proved*, rounding included: the metric is
/// [`Metric::OneSided`]. Between two points the path may be farther from both. `at_least` is 0.
///
/// **Path.** It starts at the first and ends at the last point (a closed path, at the first, or at a corner), and pieces
/// meet at points. They have the same direction there (G1, up to rounding), except at corners. Repeated points are merged;
/// a single point gives a path that is a point. Between two corners the path is a line if a line is near enough.
///
/// **Method.** The direction at a joint comes from a polynomial of degree 3 fitted to the points around it; each
/// piece is the cubic with these directions that is nearest to its points, and is as long as the tolerance allows. For
/// noisy points, give the corners by their indices: between them every angle is large.
///
/// **Cost.** O(n log n) time at most: each span is fitted a number of times that is the logarithm of its size.
///
/// # Errors
/// [`Failure::Refused`]: no points, a number that is not finite or beyond 1e150, a corner whose index is no point's or an
/// angle beyond 180 degrees, a length below rounding, more pieces or bytes than the job allows, an environment that flushes
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
/// solver, and a search for the longest spans instead of halving.
pub fn points_to_spline<const D: usize>(
    points: &[[f64; D]],
    ends: CurveEnds,
    fit: &SplineFit,
    job: &Job,
) -> Result<Bounded<Curve<D>>, Failure<Curve<D>>> {
    refuse_flushing()?;
    let path = PointPath::new(points, ends == CurveEnds::Closed, &fit.corners)?;
    let truth = SplineTruth { length: fit.length, reference: Reference::InputPoints, judge: &farthest_point };
    let mut path_of_cubics = spline(&path, &truth, job)?;
    path_of_cubics.bound.metric = Metric::OneSided;
    Ok(path_of_cubics)
}

/// The largest distance between a point and the point of the cubic at its parameter.
fn farthest_point<const D: usize>(points: &[[f64; D]], cubic: &Bezier<D>, parameters: &[f64]) -> f64 {
    let reach = greater(coordinate_reach(points), coordinate_reach(&cubic.control));
    let distances = points.iter().zip(parameters).map(|(p, t)| distance(cubic.at(*t), *p));
    let larger = |most: f64, d: f64| if d.is_nan() { f64::INFINITY } else { greater(d, most) };
    // The rounding of an evaluation is a sixteenth of `rounding_at`, which is meant for chords; that of the distance is less.
    (distances.fold(0.0, larger) + rounding_at(reach)).next_up()
}
