//! The arrow from curves to polylines: nearly the fewest segments, or equal steps, proved.
use super::curves::flatten::{Flattener, Spacing};
use crate::budget::{Bounded, Budget, Failure, Job};
use crate::explicit::{Curve, Polyline};

/// Flattens a path to a polyline within a budget, with nearly as few segments as possible.
///
/// **Bound.** Two-sided Hausdorff distance between the path, taken exactly as given, and the polyline,
/// *proved*, rounding and [`Curve::slack`] included. `at_least` is the distance at one point of the path. With
/// a budget of pixels the bound is also given in pixels at the view; a plane path lies in the plane z = 0.
///
/// **Polyline.** Every vertex lies on the path, in the path's order, and every end of a piece is a vertex. No two
/// consecutive points are equal; a closed path gives a closed polyline. A path that is one point gives one
/// point.
///
/// **Budgets.** A length, pixels at a view, a number of segments, or several of these. If only a number of
/// segments is given, a ladder of lengths is tried and the best polyline is returned.
///
/// **Cost.** 50 to 300 ns a segment, more if there are few; 32 bytes a point.
/// [`BezierCutter`](super::batch::BezierCutter) takes a quarter to a half of that.
///
/// # Errors
/// [`Failure::Refused`]: a budget that limits no polyline, a number that is not finite or beyond 1e150, more
/// segments or bytes than the job allows (refused before the work starts), a budget below rounding, an eye too
/// close, an environment that flushes subnormals. [`Failure::Unmet`] with the best polyline: the length or the
/// pixels need more segments than the budget allows, or the path has more pieces. [`Failure::Cancelled`].
///
/// ```
/// use chordal::{Bezier, Budget, Job, Tolerance, convert};
/// let arch = Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] };
/// let flat = |tol| {
///     let budget = Budget::length(Tolerance::new(tol).unwrap());
///     convert::curve_to_polyline(&arch.into(), &budget, &Job::default()).unwrap()
/// };
/// let (coarse, fine) = (flat(1e-2), flat(1e-4));
/// assert!(fine.bound.at_most().unwrap() <= 1e-4);
/// // A hundredth of the error costs ten times the segments.
/// assert_eq!((coarse.shape.n_segments(), fine.shape.n_segments()), (9, 87));
/// ```
///
/// Source: the chord's error in closed form (`convert/curves/chord.rs`); for uniform steps G. Wang, 1984.
pub fn curve_to_polyline<const D: usize>(
    curve: &Curve<D>,
    budget: &Budget,
    job: &Job,
) -> Result<Bounded<Polyline<D>>, Failure<Polyline<D>>> {
    flatten_curve(curve, budget, job, Spacing::Fewest)
}

/// Like [`curve_to_polyline`], with equal parameter steps in each piece: more segments, in less time.
///
/// A path of one piece and a budget of `n` segments alone give exactly `n` steps.
///
/// # Errors
/// As for [`curve_to_polyline`].
///
/// ```
/// use chordal::{Bezier, Budget, Job, convert};
/// let arch = Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] };
/// let even = |n| {
///     let bounded = convert::curve_to_polyline_evenly(&arch.into(), &Budget::segments(n), &Job::default()).unwrap();
///     bounded.bound.at_most().unwrap()
/// };
/// assert!((even(64) / even(128) - 4.0).abs() < 0.1); // twice the segments, a quarter of the error
/// ```
pub fn curve_to_polyline_evenly<const D: usize>(
    curve: &Curve<D>,
    budget: &Budget,
    job: &Job,
) -> Result<Bounded<Polyline<D>>, Failure<Polyline<D>>> {
    flatten_curve(curve, budget, job, Spacing::Even)
}

/// Flattens many paths at once, each into its own polyline, in their order, on all threads of the job.
///
/// The bound holds for each path and its polyline; a budget of segments limits their total.
///
/// # Errors
/// As for [`curve_to_polyline`]. An empty list is no error: it gives no polyline and a bound of 0.
pub fn curves_to_polylines<const D: usize>(
    curves: &[Curve<D>],
    budget: &Budget,
    job: &Job,
    spacing: Spacing,
) -> Result<Bounded<Vec<Polyline<D>>>, Failure<Vec<Polyline<D>>>> {
    job.run(|| Flattener::new(curves, job, spacing)?.flatten(budget))
}

fn flatten_curve<const D: usize>(
    curve: &Curve<D>,
    budget: &Budget,
    job: &Job,
    spacing: Spacing,
) -> Result<Bounded<Polyline<D>>, Failure<Polyline<D>>> {
    let only = |mut polylines: Vec<Polyline<D>>| polylines.pop().unwrap_or_default();
    let flattened = Flattener::new(std::slice::from_ref(curve), job, spacing).and_then(|f| f.flatten(budget));
    match flattened {
        Ok(polylines) => Ok(polylines.map(only)),
        Err(Failure::Unmet(best)) => Err(Failure::Unmet(Box::new(best.map(only)))),
        Err(Failure::Refused(refusal)) => Err(Failure::Refused(refusal)),
        Err(Failure::Cancelled) => Err(Failure::Cancelled),
    }
}
