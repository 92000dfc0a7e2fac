//! The arrow from polylines to paths of cubics.
//!
//! The vertices of a span have increasing parameters on its cubic, from 0 for the first to 1 for the last. So each segment
//! has its own part of the cubic, and the parts together are the cubic. A part and its segment are compared in two ways:
//! by the distances of the ends plus the part's deviation from its own chord ([`super::curves::chord`]); and as
//! polynomials with the same parameter, whose difference is bounded by its largest coefficient. Both bounds hold in both
//! directions, and the smaller one is taken.
use super::curves::chord::{CubicChords, coordinate_reach, rounding_at};
use super::curves::flatten::refuse_flushing;
use super::fitting::point_path::PointPath;
use super::fitting::spans::{SplineFit, SplineTruth, spline};
use crate::budget::{Bounded, Failure, Job, Reference};
use crate::explicit::{Bezier, Curve, Polyline};
use crate::math::{greater, length, lesser};

/// A path of few cubics within a distance of a polyline.
///
/// **Bound.** Two-sided Hausdorff distance between the polyline, as a set of points, and the path, *proved*, rounding
/// included. `at_least` is 0.
///
/// **Path.** Pieces meet at vertices, and have the same direction there (G1, up to rounding), except at corners. A single
/// segment that no cubic with these directions fits becomes a cubic with short handles. Lines between two corners stay
/// lines. Repeated vertices are merged; a polyline that is one point gives a path that is a point.
///
/// **Cost.** O(n log n) time at most: each span is fitted a number of times that is the logarithm of its size.
///
/// # Errors
/// As for [`points_to_spline`](super::splines::points_to_spline).
///
/// ```
/// use chordal::convert::curve_to_polyline;
/// use chordal::convert::splines::{SplineFit, polyline_to_spline};
/// use chordal::{Bezier, Budget, Job, Tolerance};
/// let (arch, length) = (Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] }, Tolerance::new(1e-3)?);
/// let fine = Budget::length(Tolerance::new(1e-5)?);
/// let line = curve_to_polyline(&arch.into(), &fine, &Job::default()).unwrap();
/// assert!(line.shape.n_segments() > 200);
/// let spline = polyline_to_spline(&line.shape, &SplineFit::within(length), &Job::default()).unwrap();
/// assert!(spline.shape.segments().len() <= 3);
/// // Curve → polyline → spline: the lengths add.
/// assert!(line.bound.then(&spline.bound).at_most().unwrap() <= 1.01e-3);
/// # Ok::<(), chordal::budget::InvalidTolerance>(())
/// ```
///
/// Source: as for [`points_to_spline`](super::splines::points_to_spline).
pub fn polyline_to_spline<const D: usize>(
    line: &Polyline<D>,
    fit: &SplineFit,
    job: &Job,
) -> Result<Bounded<Curve<D>>, Failure<Curve<D>>> {
    refuse_flushing()?;
    let path = PointPath::new(&line.points, line.closed, &fit.corners)?;
    let truth = SplineTruth { length: fit.length, reference: Reference::Curves, judge: &farthest_part };
    spline(&path, &truth, job)
}

/// The largest distance between a segment and its part of the cubic.
fn farthest_part<const D: usize>(points: &[[f64; D]], cubic: &Bezier<D>, parameters: &[f64]) -> f64 {
    let reach = greater(coordinate_reach(points), coordinate_reach(&cubic.control));
    let chords = CubicChords::new(cubic);
    let mut worst = 0.0;
    for (ends, range) in points.windows(2).zip(parameters.windows(2)) {
        let (a, b) = (ends[0], ends[1]);
        let control = cubic.part(range[0], range[1]).control;
        let distance = |i: usize| {
            let t = i as f64 / 3.0;
            length(std::array::from_fn::<f64, D, _>(|k| control[i][k] - ((1.0 - t) * a[k] + t * b[k])))
        };
        let at_ends = greater(distance(0), distance(3));
        let inside = greater(distance(1), distance(2));
        let by_chord = at_ends + chords.deviation(range[0], range[1]).at_most;
        let deviation = lesser(by_chord, greater(at_ends, inside));
        if deviation.is_nan() {
            return f64::INFINITY;
        }
        worst = greater(deviation, worst);
    }
    // Derived in `curves/chord.rs`: rounding of a part's control points and differences is less than that of a chord.
    (worst + rounding_at(reach)).next_up()
}
