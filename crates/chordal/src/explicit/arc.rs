//! `Arc`: an arc of an ellipse in the plane or in space.
use super::AffineMap;
use crate::math::{DoubleDouble, add_up, greater, lesser, mul_up};
use std::f64::consts::PI;
use std::fmt;

/// An arc of an ellipse: `centre + cos(a)·axes[0] + sin(a)·axes[1]`, where `a` runs from `start_rad` over
/// `sweep_rad`.
///
/// The axes may differ in length and need not be orthogonal; a circle has orthogonal axes of equal length.
/// The two ends are stored separately, so that the arc joins its neighbours bit for bit.
///
/// ```
/// use chordal::explicit::Arc;
/// let quarter = Arc::new([0.0, 0.0], [[2.0, 0.0], [0.0, 2.0]], 0.0, std::f64::consts::FRAC_PI_2)?;
/// let [x, y] = quarter.at(0.5);
/// assert!((x - 2.0_f64.sqrt()).abs() < 1e-15 && (y - x).abs() < 1e-15);
/// # Ok::<(), chordal::explicit::parametric::InvalidArc>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc<const D: usize> {
    centre: [f64; D],
    axes: [[f64; D]; 2],
    start_rad: f64,
    sweep_rad: f64,
    ends: [[f64; D]; 2],
    slack: f64,
}

/// The shape of an arc between two points, with the parameters of SVG.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SvgArcShape {
    /// The two semi-axes of the ellipse; their signs are ignored.
    pub radii: [f64; 2],
    /// The angle of the first semi-axis, from the first axis of the plane towards the second.
    pub rotation_rad: f64,
    /// Whether the arc takes more than half of the ellipse.
    pub large: bool,
    /// Whether the angle increases along the arc, from the first axis of the plane towards the second.
    pub positive: bool,
}

impl<const D: usize> Arc<D> {
    /// An arc by its centre, axes and angles.
    ///
    /// # Errors
    /// When a number is not finite, or the sweep exceeds a full turn.
    pub fn new(
        centre: [f64; D],
        axes: [[f64; D]; 2],
        start_rad: f64,
        sweep_rad: f64,
    ) -> Result<Self, InvalidArc> {
        let mut arc = Self { centre, axes, start_rad, sweep_rad, ends: [centre; 2], slack: 0.0 };
        arc.ends = [arc.round(0.0), arc.round(1.0)];
        // 2π rounded to a number is below 2π; it counts as a full turn.
        if !arc.is_finite() || start_rad.abs() > 4.0 * PI || sweep_rad.abs() > 2.0 * PI {
            return Err(InvalidArc);
        }
        Ok(arc)
    }

    /// The same arc with exactly these end points. They should be within rounding of its own: their distance
    /// is added to [`Arc::slack`].
    #[must_use]
    pub fn with_ends(mut self, ends: [[f64; D]; 2]) -> Self {
        let moved = [0, 1].map(|i| distance_up(ends[i], self.ends[i]));
        self.slack = add_up(self.slack, greater(moved[0], moved[1]));
        self.ends = ends;
        self
    }

    /// The start and the end point.
    #[must_use]
    pub fn ends(&self) -> [[f64; D]; 2] {
        self.ends
    }

    /// The centre of the ellipse.
    #[must_use]
    pub fn centre(&self) -> [f64; D] {
        self.centre
    }

    /// The vectors from the centre to the points of the ellipse at angle 0 and at a right angle.
    #[must_use]
    pub fn axes(&self) -> [[f64; D]; 2] {
        self.axes
    }

    /// The angle at the start.
    #[must_use]
    pub fn start_rad(&self) -> f64 {
        self.start_rad
    }

    /// The angle from the start to the end; its sign gives the direction.
    #[must_use]
    pub fn sweep_rad(&self) -> f64 {
        self.sweep_rad
    }

    /// The largest distance of the exact arc from these numbers.
    #[must_use]
    pub fn slack(&self) -> f64 {
        self.slack
    }

    /// The point at `t`, 0 at the start and 1 at the end.
    #[must_use]
    pub fn at(&self, t: f64) -> [f64; D] {
        if t == 0.0 {
            self.ends[0]
        } else if t == 1.0 {
            self.ends[1]
        } else {
            self.round(t)
        }
    }

    fn round(&self, t: f64) -> [f64; D] {
        let offset = self.direction(self.angle(t));
        std::array::from_fn(|k| self.centre[k] + offset[k])
    }

    /// The angle at `t`.
    pub(crate) fn angle(&self, t: f64) -> f64 {
        self.start_rad + self.sweep_rad * t
    }

    /// The vector from the centre to the point at an angle.
    pub(crate) fn direction(&self, angle_rad: f64) -> [f64; D] {
        let (sin, cos) = libm::sincos(angle_rad);
        let [u, v] = self.axes;
        std::array::from_fn(|k| cos * u[k] + sin * v[k])
    }

    /// The first derivative at `t`.
    #[must_use]
    pub fn tangent(&self, t: f64) -> [f64; D] {
        let (sin, cos) = libm::sincos(self.angle(t));
        let [u, v] = self.axes;
        std::array::from_fn(|k| self.sweep_rad * (cos * v[k] - sin * u[k]))
    }

    /// The second derivative at `t`.
    #[must_use]
    pub fn second_derivative(&self, t: f64) -> [f64; D] {
        let inwards = self.direction(self.angle(t));
        inwards.map(|x| -(self.sweep_rad * self.sweep_rad) * x)
    }

    /// The same arc in reverse.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self {
            start_rad: self.start_rad + self.sweep_rad,
            sweep_rad: -self.sweep_rad,
            ends: [self.ends[1], self.ends[0]],
            // The sum of the angles is rounded by half a step; the sweep turns that into a length.
            slack: add_up(self.slack, mul_up(16.0 * f64::EPSILON, self.reach())),
            ..*self
        }
    }

    /// The lowest and highest coordinates of a box that contains the arc: the box of its ends and of the
    /// points where the tangents at the ends of eight equal parts meet.
    #[must_use]
    pub fn bounds(&self) -> [[f64; D]; 2] {
        let eighth = self.sweep_rad / 8.0;
        let secant = 1.0 / libm::cos(eighth / 2.0);
        // As for an evaluated point: convert/curves/chord.rs derives less than 16 half steps.
        let rounding = 16.0 * f64::EPSILON * self.reach();
        let [mut low, mut high] = [self.ends[0]; 2];
        let mut widen = |p: [f64; D], by: f64| {
            for k in 0..D {
                low[k] = lesser(p[k] - by, low[k]);
                high[k] = greater(p[k] + by, high[k]);
            }
        };
        widen(self.ends[1], 0.0);
        for part in 0..8 {
            let towards = self.direction(self.start_rad + (f64::from(part) + 0.5) * eighth);
            widen(std::array::from_fn(|k| self.centre[k] + secant * towards[k]), rounding);
        }
        [low, high]
    }

    /// The largest sum of a coordinate of the centre and those of both axes, in absolute values.
    fn reach(&self) -> f64 {
        (0..D).fold(0.0, |most, k| {
            let reach = self.centre[k].abs() + self.axes[0][k].abs() + self.axes[1][k].abs();
            greater(reach, most)
        })
    }

    pub(crate) fn is_finite(&self) -> bool {
        let [u, v] = self.axes;
        let points = [self.centre, u, v, self.ends[0], self.ends[1]];
        points.as_flattened().iter().chain(&[self.start_rad, self.sweep_rad]).all(|x| x.is_finite())
    }

    /// The arc under an affine map.
    #[must_use]
    pub fn transformed(&self, map: &AffineMap<D>) -> Self {
        Self {
            centre: map.point(self.centre),
            axes: self.axes.map(|axis| map.vector(axis)),
            ends: self.ends.map(|end| map.point(end)),
            slack: mul_up(map.stretch(), self.slack),
            ..*self
        }
    }
}

impl Arc<2> {
    /// The arc between two points of an ellipse with given axes and direction, as in SVG. Radii that are too
    /// short are scaled up until they reach. Rounding is included in [`Arc::slack`]: it can matter where the
    /// arc is nearly half of a rotated ellipse, whose centre is then ill-conditioned.
    ///
    /// # Errors
    /// When a number is not finite, a radius is 0, or the points are equal: SVG draws a line or nothing then.
    ///
    /// Source: W3C, *SVG 2*, appendix B.2, *Elliptical arc implementation notes*.
    pub fn through(from: [f64; 2], to: [f64; 2], shape: &SvgArcShape) -> Result<Self, InvalidArc> {
        let way = [0, 1].map(|k| DoubleDouble::two_sum(to[k], -from[k]));
        Self::spanning([from, to], way, shape)
    }

    /// The same arc from its start and the step to its end. The sum of the two may be rounded, the shape of
    /// the arc is not: near half an ellipse that rounding would move the centre far more than the end.
    ///
    /// # Errors
    /// As for [`Arc::through`].
    ///
    /// ```
    /// use chordal::explicit::Arc;
    /// use chordal::explicit::parametric::SvgArcShape;
    /// let half = SvgArcShape { radii: [1.0, 1.0], rotation_rad: 0.0, large: false, positive: true };
    /// let arc = Arc::through_step([0.3, 0.1], [2.0, 0.0], &half)?;
    /// let [x, y] = arc.centre();
    /// assert!((x - 1.3).abs() < 1e-15 && y == 0.1 && arc.slack() < 1e-13);
    /// # Ok::<(), chordal::explicit::parametric::InvalidArc>(())
    /// ```
    pub fn through_step(from: [f64; 2], step: [f64; 2], shape: &SvgArcShape) -> Result<Self, InvalidArc> {
        let to = [0, 1].map(|k| from[k] + step[k]);
        Self::spanning([from, to], step.map(DoubleDouble::from_f64), shape)
    }

    fn spanning(
        [from, to]: [[f64; 2]; 2],
        way: [DoubleDouble; 2],
        shape: &SvgArcShape,
    ) -> Result<Self, InvalidArc> {
        let radii = shape.radii.map(f64::abs);
        // A circle has no rotation, and its centre is most exact without one.
        let rotation = if radii[0] == radii[1] { 0.0 } else { shape.rotation_rad };
        let (sin, cos) = if rotation == 0.0 { (0.0, 1.0) } else { libm::sincos(rotation) };
        let finite = [from, to, radii, [sin, cos]].as_flattened().iter().all(|x| x.is_finite());
        // Beyond these, squares of their ratios overflow or underflow.
        let sane = |x: f64| x > 1e-140 && x < 1e140;
        if !finite || way.iter().all(|x| x.hi == 0.0) || !radii.iter().all(|r| sane(*r)) {
            return Err(InvalidArc);
        }
        // 1. Half the vector from the end to the start, in the frame of the axes and in units of the radii.
        let half = way.map(|x| DoubleDouble { hi: -x.hi / 2.0, lo: -x.lo / 2.0 });
        let turned = [
            half[0]
                .times(DoubleDouble::from_f64(cos))
                .plus(half[1].times(DoubleDouble::from_f64(sin)))
                .over(radii[0]),
            half[1]
                .times(DoubleDouble::from_f64(cos))
                .minus(half[0].times(DoubleDouble::from_f64(sin)))
                .over(radii[1]),
        ];
        // 2. The unit circle's squared radius minus its square: the square of the centre's height over the
        //    chord.
        let square = turned[0].times(turned[0]).plus(turned[1].times(turned[1]));
        let left = DoubleDouble::from_f64(1.0).minus(square);
        let (height_sq, grown) = if left.hi > 0.0 { (left.hi, 1.0) } else { (0.0, square.hi.sqrt()) };
        let half_chord = if grown > 1.0 { 1.0 } else { square.hi.sqrt() };
        let p = [turned[0].hi / grown, turned[1].hi / grown];
        let length = (p[0] * p[0] + p[1] * p[1]).sqrt();
        // 3. The centre is on the left of the chord for a small arc that turns to the left.
        let side = if shape.large == shape.positive { -1.0 } else { 1.0 };
        let height = side * height_sq.sqrt();
        let c = [height * p[1] / length, -height * p[0] / length];
        let towards = if shape.large { -height_sq.sqrt() } else { height_sq.sqrt() };
        let sweep = 2.0 * libm::atan2(half_chord, towards);
        let start = libm::atan2(p[1] - c[1], p[0] - c[0]);
        // 4. Back to the plane.
        let [rx, ry] = radii.map(|r| r * grown);
        let axes = [[cos * rx, sin * rx], [-sin * ry, cos * ry]];
        let centre = [0, 1].map(|k| (from[k] / 2.0 + to[k] / 2.0) + (c[0] * axes[0][k] + c[1] * axes[1][k]));
        let sweep = if shape.positive { sweep } else { -sweep };
        let arc = Self::new(centre, axes, start, sweep)?.with_ends([from, to]);
        // 5. The square height is known to 2⁻⁹⁶, or, when sine and cosine of the rotation were rounded (each
        //    by less than one unit in the last place), to 8 ε times what they rotate, in units of the shorter
        //    radius: a flat ellipse is the most sensitive to a rotation. Its root is off by that over the
        //    height, and never by more than its own root. The rest is plain rounding.
        let shorter = lesser(radii[0], radii[1]);
        let turned_over = (half[0].hi.abs() + half[1].hi.abs()) / shorter;
        let known = if sin == 0.0 {
            16.0 * f64::EPSILON * f64::EPSILON
        } else {
            8.0 * f64::EPSILON * (1.0 + turned_over)
        };
        let by_slope = known / height.abs();
        let of_height = lesser(by_slope, known.sqrt());
        let longest = greater(rx, ry);
        let rounding = mul_up(32.0 * f64::EPSILON, add_up(longest, arc.reach()));
        let slack = add_up(arc.slack, add_up(mul_up(2.0 * of_height, longest), rounding));
        Ok(Self { slack, ..arc })
    }
}

/// Numbers that do not form an arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InvalidArc;

impl fmt::Display for InvalidArc {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an arc needs finite numbers, radii greater than 0, two ends that differ, and at most one full turn")
    }
}

impl std::error::Error for InvalidArc {}

/// An upper bound for the distance of two points, summed over the axes: squares of small distances could
/// underflow.
fn distance_up<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).fold(0.0, |sum, k| add_up(sum, (a[k] - b[k]).abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn through(from: [f64; 2], to: [f64; 2], radii: [f64; 2], deg: f64, flags: [bool; 2]) -> Arc<2> {
        let [large, positive] = flags;
        let shape = SvgArcShape { radii, rotation_rad: deg * PI / 180.0, large, positive };
        Arc::through(from, to, &shape).unwrap()
    }

    /// The distance of a point from the ellipse, in units of the radii.
    fn off(arc: &Arc<2>, p: [f64; 2]) -> f64 {
        let [u, v] = arc.axes();
        let d = [p[0] - arc.centre()[0], p[1] - arc.centre()[1]];
        let x = (d[0] * u[0] + d[1] * u[1]) / (u[0] * u[0] + u[1] * u[1]);
        let y = (d[0] * v[0] + d[1] * v[1]) / (v[0] * v[0] + v[1] * v[1]);
        (x * x + y * y - 1.0).abs()
    }

    #[test]
    fn all_four_arcs_between_two_points_run_from_end_to_end() {
        for deg in [0.0, 30.0, -200.0] {
            for flags in [[false, false], [false, true], [true, false], [true, true]] {
                let arc = through([1.0, 2.0], [3.0, 1.0], [3.0, 2.0], deg, flags);
                assert_eq!(arc.ends(), [[1.0, 2.0], [3.0, 1.0]]);
                assert_eq!(arc.sweep_rad().abs() > PI, flags[0], "{deg} {flags:?}");
                assert_eq!(arc.sweep_rad() > 0.0, flags[1]);
                assert!(arc.slack() < 1e-13, "{}", arc.slack());
                assert!(off(&arc, arc.ends()[0]) < 1e-14 && off(&arc, arc.ends()[1]) < 1e-14);
                // The ends of the formula are the given ends.
                for (t, end) in [(0.0, [1.0, 2.0]), (1.0, [3.0, 1.0])] {
                    let own = arc.round(t);
                    assert!((own[0] - end[0]).abs() + (own[1] - end[1]).abs() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn half_a_circle_is_known_to_the_last_digits_and_half_a_turned_ellipse_is_not() {
        let circle = through([0.0, 0.0], [2.0, 0.0], [1.0, 1.0], 17.0, [false, true]);
        assert_eq!(circle.centre(), [1.0, 0.0]);
        assert!(circle.slack() < 1e-13);
        let apex = circle.at(0.5);
        assert!((apex[0] - 1.0).abs() < 1e-15 && (apex[1] + 1.0).abs() < 1e-15);
        let long = [2.0 * libm::cos(0.3), 2.0 * libm::sin(0.3)];
        let turned = through([-long[0], -long[1]], long, [2.0, 1.0], 0.3 * 180.0 / PI, [false, true]);
        assert!(turned.slack() > 1e-9 && turned.slack() < 1e-6);
    }

    #[test]
    fn radii_that_are_too_short_grow() {
        let arc = through([-5.0, 0.0], [5.0, 0.0], [1.0, 1.0], 0.0, [false, true]);
        assert_eq!(arc.centre(), [0.0, 0.0]);
        assert_eq!(arc.axes(), [[5.0, 0.0], [0.0, 5.0]]);
        assert_eq!(arc.sweep_rad(), PI);
    }

    #[test]
    fn the_hull_holds_the_arc() {
        for (start, sweep) in [(0.0, 0.1), (1.0, 3.0), (2.0, -6.0), (-3.0, 2.0 * PI)] {
            let arc = Arc::new([3.0, 4.0], [[2.0, 1.0], [-0.5, 1.0]], start, sweep).unwrap();
            let [low, high] = arc.bounds();
            for i in 0..=1000 {
                let p = arc.at(f64::from(i) / 1000.0);
                assert!((0..2).all(|k| low[k] <= p[k] && p[k] <= high[k]));
            }
            assert!(high[0] - low[0] < 4.6);
        }
    }

    #[test]
    fn what_makes_no_arc_is_refused() {
        let shape = SvgArcShape { radii: [1.0, 0.0], rotation_rad: 0.0, large: false, positive: true };
        assert_eq!(Arc::through([0.0; 2], [1.0, 0.0], &shape), Err(InvalidArc));
        let round = SvgArcShape { radii: [1.0, 1.0], ..shape };
        assert_eq!(Arc::through([0.0; 2], [0.0; 2], &round), Err(InvalidArc));
        assert_eq!(Arc::through([f64::NAN; 2], [0.0; 2], &round), Err(InvalidArc));
        assert_eq!(Arc::<2>::new([0.0; 2], [[1.0, 0.0], [0.0, 1.0]], 0.0, 7.0), Err(InvalidArc));
    }
}
