//! The continuity (Cⁿ, Gⁿ) between the pieces of a path.
use crate::explicit::{Curve, CurveSegment};
use crate::math::{difference, distance, dot, greater, length, lesser};

/// The continuity between two pieces of a path.
///
/// *Parametric* continuity compares derivatives by the parameter: C1 and C2 depend on the speed of each
/// piece. *Geometric* continuity compares what is visible: G1 the direction, G2 the curvature as well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Join<const D: usize> {
    /// The piece that starts at the join; the previous one ends there. 0 is the join between the last and the
    /// first piece of a closed path.
    pub piece: usize,
    /// The point where it starts.
    pub at: [f64; D],
    /// The distance between the end of one piece and the start of the other.
    pub position_gap: f64,
    /// The angle between their directions, 0 to π; `None` if a piece has no direction because it is a
    /// point.
    pub angle_rad: Option<f64>,
    /// The curvatures before and after (1/radius, ≥ 0); `None` if a first derivative is zero.
    pub curvatures: [Option<f64>; 2],
    /// The length of the difference of the curvature vectors; `None` if one is missing.
    pub curvature_gap: Option<f64>,
    /// Cn: derivatives up to the nth are equal, up to the rounding of the control points; `None` for a gap,
    /// at most 2.
    pub parametric: Option<u8>,
    /// Gn: the same for position (0), direction (1) and curvature (2).
    pub geometric: Option<u8>,
}

/// Rounding of the derivatives of pieces whose control points are rounded by half a step each: the first
/// derivative is a difference times 3, the second three terms times 6 that add up to 24. In units of ε times
/// the size, doubled for both sides and for the control points of splines, which are sums of a few rounded
/// terms themselves.
pub(super) const FIRST: f64 = 32.0;
pub(super) const SECOND: f64 = 256.0;

/// All joins of a path: between neighbouring pieces, and for a closed path also between its last and first
/// piece.
///
/// A direction is that of the first derivative or, if that is zero, of the next nonzero one: the visible
/// direction. Lines have zero curvature.
///
/// ```
/// use chordal::{check, explicit::{Curve, CurveEnds, CurveSegment, spline}};
/// let path = spline::natural(&[[0.0, 0.0], [1.0, 2.0], [3.0, 1.0], [4.0, 4.0]])?;
/// assert!(check::curves::joins(&path).iter().all(|join| join.parametric == Some(2)));
/// let corner = [CurveSegment::Line([[0.0, 0.0], [1.0, 0.0]]), CurveSegment::Line([[1.0, 0.0], [1.0, 1.0]])];
/// let join = check::curves::joins(&Curve::new(corner.to_vec(), CurveEnds::Open).unwrap())[0];
/// assert_eq!((join.geometric, join.angle_rad), (Some(0), Some(std::f64::consts::FRAC_PI_2)));
/// # Ok::<(), chordal::explicit::spline::InvalidSpline>(())
/// ```
#[must_use]
pub fn joins<const D: usize>(curve: &Curve<D>) -> Vec<Join<D>> {
    let pieces = curve.segments();
    let inner = (1..pieces.len()).map(|i| join([&pieces[i - 1], &pieces[i]], [1.0; 2], i));
    // The seam is the join at parameter 0 of the closed path, so it comes first.
    let seam = match pieces {
        [first, .., last] | [first @ last] if curve.is_closed() => Some(join([last, first], [1.0; 2], 0)),
        _ => None,
    };
    seam.into_iter().chain(inner).collect()
}

/// The join of `before` and `after`, whose parameters run over these `widths`; `piece` is only stored in the
/// result.
#[must_use]
pub fn join<const D: usize>(
    [before, after]: [&CurveSegment<D>; 2],
    widths: [f64; 2],
    piece: usize,
) -> Join<D> {
    let (end, start) = (before.end(), after.start());
    let size = size_of(before) + size_of(after);
    let scaled = |v: [f64; D], by: f64| v.map(|x| x / by);
    let first = [scaled(before.tangent(1.0), widths[0]), scaled(after.tangent(0.0), widths[1])];
    let second = [
        scaled(before.second_derivative(1.0), widths[0] * widths[0]),
        scaled(after.second_derivative(0.0), widths[1] * widths[1]),
    ];
    // Derivatives are divided by the width once or twice, and so is their rounding.
    let narrow = lesser(widths[0], widths[1]);
    // See FIRST.
    let rounding = [FIRST * f64::EPSILON * size / narrow, SECOND * f64::EPSILON * size / (narrow * narrow)];
    let position_gap = distance(end, start);
    let parametric = (position_gap == 0.0).then(|| {
        if distance(first[0], first[1]) > rounding[0] {
            0
        } else if distance(second[0], second[1]) > rounding[1] {
            1
        } else {
            2
        }
    });

    let directions = [direction(before, 1.0), direction(after, 0.0)];
    let angle_rad = directions[0].zip(directions[1]).map(|(a, b)| angle(a, b));
    let speeds = first.map(length);
    let slow = lesser(speeds[0], speeds[1]);
    let bent = [curvature(first[0], second[0]), curvature(first[1], second[1])];
    let curvature_gap = bent[0].zip(bent[1]).map(|(a, b)| distance(a, b));
    let curvatures = bent.map(|bent| bent.map(length));
    // Angles and curvatures are as accurate as the derivatives, relative to the speed.
    let angle_rounding = rounding[0] / slow;
    let curved = curvatures.iter().flatten().fold(0.0, |most, c| greater(*c, most));
    let curvature_rounding = (rounding[1] / slow + 4.0 * curved * rounding[0]) / slow;
    let geometric = (position_gap == 0.0).then(|| match (angle_rad, curvature_gap) {
        // Where the path stops, the directions are limits of unit length, and the speed is no measure of their
        // rounding.
        (Some(angle), _) if slow == 0.0 => u8::from(angle <= FIRST * f64::EPSILON),
        (Some(angle), Some(gap)) if angle <= angle_rounding => {
            if gap <= curvature_rounding {
                2
            } else {
                1
            }
        }
        _ => 0,
    });
    Join { piece, at: start, position_gap, angle_rad, curvatures, curvature_gap, parametric, geometric }
}

/// The direction of the piece at its end `t`, 0 or 1: towards the first control point that differs from that
/// end.
fn direction<const D: usize>(piece: &CurveSegment<D>, t: f64) -> Option<[f64; D]> {
    let control = match piece {
        CurveSegment::Cubic(cubic) => cubic.control,
        other => {
            let along = other.tangent(t);
            return (length(along) > 0.0).then_some(along);
        }
    };
    let elsewhere = |order: [usize; 4]| {
        let end = control[order[0]];
        order[1..].iter().map(|i| difference(control[*i], end)).find(|d| length(*d) > 0.0)
    };
    if t == 0.0 { elsewhere([0, 1, 2, 3]) } else { elsewhere([3, 2, 1, 0]).map(|d| d.map(|x| -x)) }
}

/// The curvature vector: the component of the second derivative normal to the first, over the square of the
/// speed.
fn curvature<const D: usize>(first: [f64; D], second: [f64; D]) -> Option<[f64; D]> {
    let square = dot(first, first);
    if square == 0.0 {
        return None;
    }
    let along = dot(second, first) / square;
    Some(std::array::from_fn(|k| (second[k] - along * first[k]) / square))
}

/// The angle between two directions, accurate near 0 and near π as well (W. Kahan, 2006).
pub(super) fn angle<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    let (la, lb) = (length(a), length(b));
    let (u, v) = (a.map(|x| x * lb), b.map(|x| x * la));
    let sum: [f64; D] = std::array::from_fn(|k| u[k] + v[k]);
    2.0 * libm::atan2(distance(u, v), length(sum))
}

fn size_of<const D: usize>(piece: &CurveSegment<D>) -> f64 {
    piece.bounds().as_flattened().iter().fold(0.0, |most: f64, x| greater(x.abs(), most))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explicit::{Arc, Bezier, CurveEnds};

    fn cubic(control: [[f64; 2]; 4]) -> CurveSegment<2> {
        CurveSegment::Cubic(Bezier { control })
    }

    /// An arch, and a second one whose first three control points are given.
    fn meets(b: [[f64; 2]; 3]) -> Join<2> {
        let before = cubic([[0.0, 0.0], [0.0, 1.0], [1.0, 2.0], [2.0, 2.0]]);
        join([&before, &cubic([b[0], b[1], b[2], [4.0, 0.0]])], [1.0; 2], 7)
    }

    #[test]
    fn each_class_is_told_by_what_it_asks_for() {
        let classes = |b| {
            let join = meets(b);
            (join.parametric, join.geometric)
        };
        assert_eq!(classes([[2.0, 2.0], [3.0, 2.0], [4.0, 2.0]]), (Some(1), Some(1)));
        // b2 = 4·p3 − 4·p2 + p1 makes it C2.
        assert_eq!(classes([[2.0, 2.0], [3.0, 2.0], [4.0, 1.0]]), (Some(2), Some(2)));
        // The same direction at twice the speed, with the curvature kept: G2 and only C0.
        assert_eq!(classes([[2.0, 2.0], [4.0, 2.0], [4.0, -2.0]]), (Some(0), Some(2)));
        assert_eq!(classes([[2.0, 2.0], [4.0, 2.0], [5.0, 2.0]]), (Some(0), Some(1)));
        assert_eq!(classes([[2.0, 2.0], [2.0, 3.0], [5.0, 2.0]]), (Some(0), Some(0)));
        assert_eq!(classes([[2.0, 2.5], [3.0, 2.5], [4.0, 2.0]]), (None, None));
        assert_eq!(meets([[2.0, 2.5], [3.0, 2.5], [4.0, 2.0]]).position_gap, 0.5);
        assert_eq!(meets([[2.0, 2.0], [2.0, 3.0], [5.0, 2.0]]).angle_rad, Some(std::f64::consts::FRAC_PI_2));
    }

    #[test]
    fn a_line_runs_smoothly_into_a_circle_and_its_curvature_jumps() {
        let line = CurveSegment::Line([[-1.0, -2.0], [0.0, -2.0]]);
        let arc = Arc::new([0.0, 0.0], [[2.0, 0.0], [0.0, 2.0]], -std::f64::consts::FRAC_PI_2, 1.0).unwrap();
        let arc = CurveSegment::Arc(arc.with_ends([[0.0, -2.0], arc.ends()[1]]));
        let join = join([&line, &arc], [1.0; 2], 1);
        assert_eq!(join.geometric, Some(1));
        assert_eq!(join.curvatures[0], Some(0.0));
        assert!((join.curvature_gap.unwrap() - 0.5).abs() < 1e-15);
    }

    #[test]
    fn a_doubled_control_point_does_not_hide_the_direction() {
        let before = cubic([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [1.0, 0.0]]);
        let after = cubic([[1.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 5.0]]);
        let join = join([&before, &after], [1.0; 2], 1);
        assert_eq!((join.angle_rad, join.geometric), (Some(std::f64::consts::FRAC_PI_2), Some(0)));
        assert_eq!((join.curvatures, join.curvature_gap), ([None; 2], None));
        let point = cubic([[1.0, 0.0]; 4]);
        assert_eq!(super::join([&before, &point], [1.0; 2], 1).angle_rad, None);
    }

    #[test]
    fn a_closed_path_has_a_seam() {
        let loop_of_one =
            Curve::new(vec![cubic([[0.0, 0.0], [3.0, 3.0], [-3.0, 3.0], [0.0, 0.0]])], CurveEnds::Closed)
                .unwrap();
        let joins = joins(&loop_of_one);
        assert_eq!((joins.len(), joins[0].piece, joins[0].geometric), (1, 0, Some(0)));
    }
}
