//! The measured deviation between a path and its polyline: the largest gap found, and its location.
use crate::explicit::{Curve, Polyline};
use crate::math::{difference, length, lesser};

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

/// Samples between two vertices before the search refines the best one: a cubic is farthest from its chord at
/// one or two parameters.
const SAMPLES: u32 = 8;
/// Each golden-section step keeps 0.618 of the interval: 30 of them leave a millionth.
const STEPS: u32 = 30;

/// The largest distance found from a point of the path to the segment of its own part of the polyline: a
/// measurement, from below, and correct to about 12 digits for cubics and arcs.
///
/// The polyline carries its parameters, as those of
/// [`curve_to_polyline`](../convert/fn.curve_to_polyline.html) do; a point of the path between two vertices
/// is compared with the segment between them. `None` when there is no segment or no parameters.
///
/// 40 evaluations a segment.
///
/// ```
/// use chordal::{Bezier, Budget, Job, check, convert};
/// let arch = Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] };
/// let made = convert::curve_to_polyline_evenly(&arch.into(), &Budget::segments(1), &Job::default()).unwrap();
/// let gap = check::curves::largest_gap(&arch.into(), &made.shape).unwrap();
/// assert_eq!(gap.on_curve, [0.5, 0.75]);
/// assert_eq!((gap.distance, made.bound.at_most().unwrap() > 0.75), (0.75, true));
/// ```
#[must_use]
pub fn largest_gap<const D: usize>(curve: &Curve<D>, polyline: &Polyline<D>) -> Option<Gap<D>> {
    let end = curve.segments().len() as f64;
    let mut worst: Option<Gap<D>> = None;
    for (i, segment) in polyline.segments().enumerate() {
        let from = *polyline.places.get(i)?;
        let to = polyline.places.get(i + 1).copied().unwrap_or(end);
        let gap_at = |place: f64| {
            let on_curve = curve.at(place);
            let on_polyline = closest_on_segment(on_curve, segment);
            Gap { distance: length(difference(on_curve, on_polyline)), place, on_curve, on_polyline }
        };
        let gap = farthest(gap_at, from, to);
        if worst.as_ref().is_none_or(|worst| gap.distance > worst.distance) {
            worst = Some(gap);
        }
    }
    worst
}

/// Takes the best of some samples and refines it by golden-section search (J. Kiefer, 1953).
fn farthest<const D: usize>(gap_at: impl Fn(f64) -> Gap<D>, from: f64, to: f64) -> Gap<D> {
    let at = |i: u32| from + (to - from) * f64::from(i) / f64::from(SAMPLES);
    let mut best = (1..SAMPLES).map(|i| (i, gap_at(at(i)))).fold((1, gap_at(at(1))), |best, found| {
        if found.1.distance > best.1.distance { found } else { best }
    });
    let (mut low, mut high) = (at(best.0 - 1), at(best.0 + 1));
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    for _ in 0..STEPS {
        let (a, b) = (gap_at(high - golden * (high - low)), gap_at(low + golden * (high - low)));
        if a.distance > b.distance {
            high = b.place;
        } else {
            low = a.place;
        }
        for found in [a, b] {
            if found.distance > best.1.distance {
                best.1 = found;
            }
        }
    }
    best.1
}

/// The distance from a point to the closest point of a polyline; infinite when it has no points.
#[must_use]
pub fn distance_to_polyline<const D: usize>(point: [f64; D], polyline: &Polyline<D>) -> f64 {
    let to_first = polyline.points.first().map_or(f64::INFINITY, |first| length(difference(point, *first)));
    polyline.segments().fold(to_first, |least, segment| {
        let far = length(difference(point, closest_on_segment(point, segment)));
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
