//! Runs of short segments that are nearly straight become one.
//!
//! The points between the ends of a run are within some length of the segment between the ends. Then so is the whole
//! run, since the distance to a segment is convex. Along the run, the nearest point on the segment moves from one end
//! to the other without a jump, so that every point of the segment is as near to the run.
use crate::budget::{Bound, Bounded};
use crate::explicit::Polyline;
use crate::math::{add_up, greater, length_up, lesser, sub_down};

/// The lines with fewer segments, no farther away than `most` altogether; unchanged if they have no proved bound.
pub(super) fn without_straight_runs(
    lines: Bounded<Vec<Polyline<2>>>,
    most: f64,
) -> Bounded<Vec<Polyline<2>>> {
    let Some(at_most) = lines.bound.at_most() else { return lines };
    let reach = lines
        .shape
        .iter()
        .flat_map(|line| &line.points)
        .flatten()
        .fold(0.0, |reach: f64, x| greater(x.abs(), reach));
    // A dozen roundings of coordinates.
    let rounding = 32.0 * f64::EPSILON * reach + f64::MIN_POSITIVE;
    let allowance = sub_down(sub_down(most, at_most), rounding);
    if allowance.is_nan() || allowance <= rounding {
        return lines;
    }
    let mut added = 0.0;
    let mut shape = Vec::with_capacity(lines.shape.len());
    for line in &lines.shape {
        let (points, distance) = straightened(&line.points, sub_down(allowance, rounding));
        added = greater(add_up(distance, rounding), added);
        shape.push(Polyline { points, places: Vec::new(), closed: true });
    }
    let least = greater(sub_down(lines.bound.at_least(), added), 0.0);
    let (evidence, reference) = (lines.bound.evidence().clone(), lines.bound.reference.clone());
    let bound = Bound::with_evidence(least, Some(add_up(at_most, added)), evidence, reference);
    Bounded { shape, bound }
}

/// Some of the points of a closed line, and a bound for the distance of the others from the line through them.
fn straightened(points: &[[f64; 2]], most: f64) -> (Vec<[f64; 2]>, f64) {
    let n = points.len();
    let far = |k: usize| length_up([points[k][0] - points[0][0], points[k][1] - points[0][1]]);
    // The farthest point from any point is a corner of the hull.
    let first = (1..n).fold(0, |best, k| if far(k) > far(best) { k } else { best });
    let point = |k: usize| points[(first + k) % n];
    let distance_between = |a: usize, b: usize| {
        (a + 1..b).fold(0.0, |largest: f64, k| {
            greater(distance_to_segment(point(k), [point(a), point(b)]), largest)
        })
    };
    // A closed line keeps three points.
    let longest = n / 3;
    let (mut kept, mut largest, mut at) = (Vec::new(), 0.0, 0);
    while at < n {
        kept.push(point(at));
        let end = lesser(at + greater(longest, 1), n);
        // The step doubles as long as it fits; then the remaining interval is halved.
        let (mut good, mut bad, mut step) = (at + 1, end + 1, 2);
        while at + step < bad {
            if distance_between(at, at + step) > most {
                bad = at + step;
            } else {
                good = at + step;
                step *= 2;
            }
        }
        while bad - good > 1 {
            let middle = (good + bad) / 2;
            if distance_between(at, middle) > most { bad = middle } else { good = middle }
        }
        largest = greater(distance_between(at, good), largest);
        at = good;
    }
    (kept, largest)
}

fn distance_to_segment(p: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let (d, q) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let t = (q[0] * d[0] + q[1] * d[1]) / (d[0] * d[0] + d[1] * d[1]);
    let t = if t > 0.0 { lesser(t, 1.0) } else { 0.0 };
    length_up([q[0] - t * d[0], q[1] - t * d[1]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::Reference;

    #[test]
    fn sides_of_a_square_become_a_few_segments_and_the_bound_says_how_far() {
        let side = |k: u32| f64::from(k) / 100.0;
        let mut points: Vec<[f64; 2]> = (0..100).map(|k| [side(k), 0.0]).collect();
        points.extend((0..100).map(|k| [1.0, side(k)]));
        points.extend((0..100).map(|k| [1.0 - side(k), 1.0]));
        points.extend((0..100).map(|k| [0.0, 1.0 - side(k)]));
        points[50][1] = 1e-7;
        let line = Polyline { points, places: Vec::new(), closed: true };
        let made = Bounded { shape: vec![line], bound: Bound::proved(1e-3, 2e-3, Reference::Field) };
        let same = without_straight_runs(made.clone(), 2e-3);
        assert_eq!(same.shape, made.shape);
        let fewer = without_straight_runs(made, 2.5e-3);
        assert!(fewer.shape[0].n_segments() <= 8, "{:?}", fewer.shape);
        let bound = fewer.bound;
        assert!(bound.at_most().unwrap() > 2e-3 + 0.9e-7 && bound.at_most().unwrap() <= 2.5e-3, "{bound:?}");
        assert!(bound.at_least() <= 1e-3);
    }
}
