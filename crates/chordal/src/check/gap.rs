//! The measured deviation between a path and its polyline: the largest gap that was found, and its location.
use crate::explicit::{Curve, Polyline};
use crate::math::{difference, distance, dot, lesser};

/// A gap between a path and a polyline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap<const D: usize> {
    /// Its length.
    pub distance: f64,
    /// The parameter on the path (see [`Curve::at`]).
    pub place: f64,
    /// The point of the path.
    pub on_curve: [f64; D],
    /// The closest point of the polyline.
    pub on_polyline: [f64; D],
}

/// Equal steps between two vertices; in addition the parameters at which the path turns back along the
/// segment: a cubic is farthest from its chord at one or two parameters beside it, and at turns beyond its
/// ends.
const SAMPLES: u32 = 8;
/// Each golden-section step keeps 0.618 of an interval: 32 of them leave a fifth of a millionth.
const STEPS: u32 = 32;
/// Each bisection of a turn halves an interval: 40 of them leave a millionth of a millionth.
const HALVINGS: u32 = 40;

/// The largest distance found from a point of the path to the segment of its part of the polyline: a
/// measurement, from below, and correct to about 12 digits for cubics and arcs.
///
/// The polyline carries its parameters, as those of
/// [`curve_to_polyline`](../convert/fn.curve_to_polyline.html) do; a point of the path between two vertices
/// is compared with the segment between them, even if the path runs beyond an end of it and back. A part of
/// the path runs from one end of its segment to the other, so no point of the segment is farther from it than
/// that. `None` if there is no segment or no parameters.
///
/// 50 evaluations a segment, twice as many if the path turns back.
///
/// ```
/// use chordal::{Bezier, Budget, Job, check, convert};
/// let arch = Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] };
/// let bounded = convert::curve_to_polyline_evenly(&arch.into(), &Budget::segments(1), &Job::default()).unwrap();
/// let gap = check::curves::largest_gap(&arch.into(), &bounded.shape).unwrap();
/// assert_eq!(gap.on_curve, [0.5, 0.75]);
/// assert_eq!((gap.distance, bounded.bound.at_most().unwrap() > 0.75), (0.75, true));
/// ```
#[must_use]
pub fn largest_gap<const D: usize>(curve: &Curve<D>, polyline: &Polyline<D>) -> Option<Gap<D>> {
    let end = curve.segments().len() as f64;
    let mut worst: Option<Gap<D>> = None;
    for (i, segment) in polyline.segments().enumerate() {
        let from = *polyline.places.get(i)?;
        // A closed polyline has no vertex after its last segment, which ends where the path does.
        let to = polyline.places.get(i + 1).copied().unwrap_or(end);
        let gap_at = |parameter: f64| {
            let on_curve = curve.at(parameter);
            let on_polyline = closest_on_segment(on_curve, segment);
            Gap { distance: distance(on_curve, on_polyline), place: parameter, on_curve, on_polyline }
        };
        let gap = farthest(gap_at, &samples(curve, segment, [from, to]));
        if worst.as_ref().is_none_or(|worst| gap.distance > worst.distance) {
            worst = Some(gap);
        }
    }
    worst
}

/// The parameters to evaluate first, in order: equal steps, and between them the turns of the path along its
/// segment.
fn samples<const D: usize>(curve: &Curve<D>, [a, b]: [[f64; D]; 2], [from, to]: [f64; 2]) -> Vec<f64> {
    let mut parameters: Vec<f64> =
        (0..=SAMPLES).map(|i| from + (to - from) * f64::from(i) / f64::from(SAMPLES)).collect();
    let Some((index, _)) = curve.locate(f64::midpoint(from, to)) else { return parameters };
    let (piece, start, along) = (&curve.segments()[index], index as f64, difference(b, a));
    let speed = |parameter: f64| dot(piece.tangent(parameter - start), along);
    // The speed of a cubic along a line is quadratic: on either side of its extremum it has one zero at most.
    let ends = [from, to].map(|parameter| dot(piece.second_derivative(parameter - start), along));
    if ends[0] * ends[1] < 0.0 {
        let parameter = from + (to - from) * (ends[0] / (ends[0] - ends[1]));
        parameters.insert(parameters.partition_point(|other| *other < parameter), parameter);
    }
    let turns: Vec<f64> = parameters.windows(2).filter_map(|pair| zero(speed, [pair[0], pair[1]])).collect();
    for turn in turns {
        parameters.insert(parameters.partition_point(|other| *other < turn), turn);
    }
    parameters
}

/// The zero of a function, by bisection; `None` if it has the same sign at both ends.
fn zero(value: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> Option<f64> {
    let (first, last) = (value(low), value(high));
    if first * last >= 0.0 {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        if value(middle) * first > 0.0 { low = middle } else { high = middle }
    }
    Some(f64::midpoint(low, high))
}

/// Refines each sample that is no nearer than its neighbours by golden-section search (J. Kiefer, 1953), and
/// returns the best gap.
fn farthest<const D: usize>(gap_at: impl Fn(f64) -> Gap<D>, parameters: &[f64]) -> Gap<D> {
    let gaps: Vec<Gap<D>> = parameters.iter().map(|place| gap_at(*place)).collect();
    let far = |i: usize| gaps[i].distance;
    let peaks = (1..gaps.len() - 1).filter(|i| far(*i) >= far(i - 1) && far(*i) >= far(i + 1));
    peaks.fold(gaps[0], |best, i| {
        let refined_gap = refined(&gap_at, [parameters[i - 1], parameters[i + 1]], gaps[i]);
        if refined_gap.distance > best.distance { refined_gap } else { best }
    })
}

/// The best gap between two parameters at which it is no better than at one between them, which is kept until
/// a better one is found.
fn refined<const D: usize>(
    gap_at: impl Fn(f64) -> Gap<D>,
    [mut low, mut high]: [f64; 2],
    mut best: Gap<D>,
) -> Gap<D> {
    let short = (3.0 - 5.0_f64.sqrt()) / 2.0;
    for _ in 0..STEPS {
        // The next point is tried in the longer of the two parts, at the golden ratio.
        let is_after = high - best.place > best.place - low;
        let (end, place) = if is_after { (high, best.place) } else { (low, best.place) };
        let candidate = gap_at(place + short * (end - place));
        // The remaining interval lies between the neighbours of the better of the two.
        if candidate.distance > best.distance {
            if is_after {
                low = best.place
            } else {
                high = best.place
            }
            best = candidate;
        } else if is_after {
            high = candidate.place;
        } else {
            low = candidate.place;
        }
    }
    best
}

/// The distance from a point to the closest point of a polyline; infinite if it has no points.
#[must_use]
pub fn distance_to_polyline<const D: usize>(point: [f64; D], polyline: &Polyline<D>) -> f64 {
    let to_first = polyline.points.first().map_or(f64::INFINITY, |first| distance(point, *first));
    polyline.segments().fold(to_first, |least, segment| {
        let far = distance(point, closest_on_segment(point, segment));
        lesser(far, least)
    })
}

fn closest_on_segment<const D: usize>(p: [f64; D], [a, b]: [[f64; D]; 2]) -> [f64; D] {
    let along: [f64; D] = std::array::from_fn(|k| b[k] - a[k]);
    let (mut dot, mut square) = (0.0, 0.0);
    for k in 0..D {
        dot += (p[k] - a[k]) * along[k];
        square += along[k] * along[k];
    }
    // The second test also catches a segment of length zero.
    if dot >= square {
        b
    } else if dot > 0.0 {
        std::array::from_fn(|k| a[k] + (dot / square) * along[k])
    } else {
        a
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explicit::Bezier;

    /// A cubic and its chain at equal steps.
    fn even(control: [[f64; 2]; 4], n: u32) -> (Curve<2>, Polyline<2>) {
        let cubic = Bezier { control };
        let places: Vec<f64> = (0..=n).map(|i| f64::from(i) / f64::from(n)).collect();
        let points = places.iter().map(|place| cubic.at(*place)).collect();
        (Curve::from(cubic), Polyline { points, places, closed: false })
    }

    #[test]
    fn a_curve_that_runs_beyond_its_chain_and_back_is_seen() {
        // On a line: x' = 12 (1 − 6 t + 6 t²), so the curve turns at (3 ± √3) / 6, between the vertices at 1/5 and
        // 2/5 and again between those at 3/5 and 4/5, each time just beyond the outer one.
        let x = |t: f64| {
            let s = 1.0 - t;
            5.0 * s * s * s + 27.0 * t * s * s + 3.0 * t * t * s + 5.0 * t * t * t
        };
        let turn = (3.0 - 3.0_f64.sqrt()) / 6.0;
        let control = [[5.0, 3.0], [9.0, 3.0], [1.0, 3.0], [5.0, 3.0]];
        let (curve, chain) = even(control, 5);
        let gap = largest_gap(&curve, &chain).unwrap();
        let truth = x(turn) - x(0.2);
        assert!(truth > 2.5e-3 && (gap.distance - truth).abs() < 1e-13, "{gap:?}, {truth}");
        assert!(gap.on_polyline == chain.points[1] || gap.on_polyline == chain.points[4], "{gap:?}");
        // The first part alone, with its vertex just before the turn and just beyond it.
        for off in [-1e-5, 1e-5, 3e-3] {
            let part = Bezier { control }.part(0.0, turn + off);
            let chain =
                Polyline { points: vec![part.at(0.0), part.at(1.0)], places: vec![0.0, 1.0], closed: false };
            let gap = largest_gap(&Curve::from(part), &chain).unwrap();
            let beyond = if off > 0.0 { x(turn) - x(turn + off) } else { 0.0 };
            assert!((gap.distance - beyond).abs() < 1e-13, "{off}: {gap:?}, {beyond}");
        }
    }

    #[test]
    fn no_sample_of_a_curve_is_farther_from_its_part_of_the_chain() {
        // Points of a coarse lattice: many of these curves are straight, turn back, or have a cusp.
        let mut state = 20_261_127_u64;
        let mut next = |n: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % n
        };
        for _ in 0..300 {
            let control = std::array::from_fn(|_| [next(4) as f64, next(2) as f64]);
            let n = 1 + next(7) as u32;
            let (curve, chain) = even(control, n);
            let gap = largest_gap(&curve, &chain).unwrap();
            for (i, segment) in chain.segments().enumerate() {
                for k in 0..=500 {
                    let p = curve.at((i as f64 + f64::from(k) / 500.0) / f64::from(n));
                    let far = distance(p, closest_on_segment(p, segment));
                    assert!(far <= gap.distance + 1e-12, "{control:?}, {n}: {far} against {gap:?}");
                }
            }
        }
    }

    #[test]
    fn the_distance_to_a_polyline_is_that_to_its_nearest_place() {
        let polyline =
            Polyline { points: vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]], places: Vec::new(), closed: false };
        for (point, far) in [([1.0, 1.0], 1.0), ([-3.0, -4.0], 5.0), ([2.0, 2.5], 0.5), ([1.0, 0.0], 0.0)] {
            assert_eq!(distance_to_polyline(point, &polyline), far);
        }
        let closed = Polyline { closed: true, ..polyline };
        assert!((distance_to_polyline([1.0, 1.0], &closed)).abs() < 1e-15);
        assert_eq!(distance_to_polyline([0.0, 0.0], &Polyline::<2>::default()), f64::INFINITY);
    }
}
