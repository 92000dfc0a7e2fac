//! `Arc`: an arc of an ellipse in the plane or in space.
use super::AffineMap;
use crate::math::{add_up, greater, lesser, mul_up};
use std::f64::consts::PI;
use std::fmt;

/// An arc of an ellipse: `centre + cos(a)·axes[0] + sin(a)·axes[1]`, where `a` runs from `start_rad` over
/// `sweep_rad`.
///
/// The axes may differ in length and need not be orthogonal; a circle has orthogonal axes of equal length.
/// The two ends are stored separately, so that the arc joins its neighbours bit for bit. An arc of at most
/// half an ellipse that was built [from its ends](Arc::through) is also evaluated from them, and not from its
/// centre, which may be millions of chords away.
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
    chord_form: Option<ChordForm<D>>,
}

/// An arc of at most half an ellipse by its ends `A` and `B`, half its sweep `δ` and the vector `w` from the
/// centre to its middle. With `τ = sin(δt)cos(δ(1−t))/sin δ`, its point at `t` is
/// `(1−τ)·A + τ·B + 2 sin(δt) sin(δ(1−t))·w`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ChordForm<const D: usize> {
    pub to_middle: [f64; D],
    pub half_rad: f64,
}

/// A part of an arc relative to its middle: half its angle, the vector from the centre to its middle, and the
/// derivative by the angle there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ArcPart<const D: usize> {
    pub(crate) half_rad: f64,
    pub(crate) to_middle: [f64; D],
    pub(crate) along: [f64; D],
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
        let mut arc =
            Self { centre, axes, start_rad, sweep_rad, ends: [centre; 2], slack: 0.0, chord_form: None };
        arc.ends = [arc.evaluate(0.0), arc.evaluate(1.0)];
        // The exact 2π exceeds its f64, which counts as a full turn.
        if !arc.is_finite() || start_rad.abs() > 4.0 * PI || sweep_rad.abs() > 2.0 * PI {
            return Err(InvalidArc);
        }
        Ok(arc)
    }

    /// The same arc, given by its ends and its chord form: it is at most half an ellipse.
    pub(super) fn with_chord_form(self, ends: [[f64; D]; 2], chord_form: ChordForm<D>) -> Self {
        Self { ends, chord_form: Some(chord_form), ..self }
    }

    /// The same arc with `more` added to its slack.
    pub(super) fn with_more_slack(self, more: f64) -> Self {
        Self { slack: add_up(self.slack, more), ..self }
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

    /// The largest distance between the exact arc and this one.
    #[must_use]
    pub fn slack(&self) -> f64 {
        self.slack
    }

    /// The point at `t`, 0 at the start and 1 at the end.
    #[must_use]
    pub fn at(&self, t: f64) -> [f64; D] {
        // Ends may have been set by `with_ends`: the formula would miss them by a rounding, and
        // neighbours would no longer meet.
        if t == 0.0 {
            self.ends[0]
        } else if t == 1.0 {
            self.ends[1]
        } else {
            self.evaluate(t)
        }
    }

    /// The point at `t` by the formula, even at the ends.
    pub(super) fn evaluate(&self, t: f64) -> [f64; D] {
        let Some(form) = self.chord_form else {
            let offset = self.direction(self.start_rad + self.sweep_rad * t);
            return std::array::from_fn(|k| self.centre[k] + offset[k]);
        };
        let half = form.half_rad;
        let (sin_a, cos_a) = libm::sincos(half * t);
        let (sin_b, cos_b) = libm::sincos(half * (1.0 - t));
        let sin_half = libm::sin(half);
        // The weights of the ends are ≥ 0 for up to half an ellipse and add up to sin(a + b) /
        // sin(half) = 1. So a flat arc loses no digits, as it would by adding a long offset to a
        // distant centre.
        let (to_a, to_b, lift) = (sin_b * cos_a / sin_half, sin_a * cos_b / sin_half, 2.0 * sin_a * sin_b);
        let [a, b] = self.ends;
        std::array::from_fn(|k| (to_a * a[k] + to_b * b[k]) + lift * form.to_middle[k])
    }

    /// The vector from the centre to the point at an angle.
    fn direction(&self, angle_rad: f64) -> [f64; D] {
        let (sin, cos) = libm::sincos(angle_rad);
        let [u, v] = self.axes;
        std::array::from_fn(|k| cos * u[k] + sin * v[k])
    }

    /// The part between the parameters `a` and `b`. The derivative is in the direction of the arc.
    pub(crate) fn part_about_middle(&self, a: f64, b: f64) -> ArcPart<D> {
        let Some(form) = self.chord_form else {
            let middle = self.start_rad + self.sweep_rad * (0.5 * (a + b));
            let half_rad = 0.5 * (self.sweep_rad * (b - a)).abs();
            let turn = if self.sweep_rad < 0.0 { -PI / 2.0 } else { PI / 2.0 };
            return ArcPart {
                half_rad,
                to_middle: self.direction(middle),
                along: self.direction(middle + turn),
            };
        };
        // This form knows no centre, which may be too far away for its digits. With w from the
        // centre to the arc's middle and v along the chord, both as long as half axes, all points
        // are cos·w + sin·v apart from the centre.
        let (sin, cos) = libm::sincos(form.half_rad * ((a - 0.5) + (b - 0.5)));
        let half_axis_per_chord = 0.5 / libm::sin(form.half_rad);
        let w = form.to_middle;
        let v: [f64; D] = std::array::from_fn(|k| half_axis_per_chord * (self.ends[1][k] - self.ends[0][k]));
        ArcPart {
            half_rad: form.half_rad * (b - a),
            to_middle: std::array::from_fn(|k| cos * w[k] + sin * v[k]),
            along: std::array::from_fn(|k| cos * v[k] - sin * w[k]),
        }
    }

    /// The first derivative at `t`.
    #[must_use]
    pub fn tangent(&self, t: f64) -> [f64; D] {
        self.part_about_middle(t, t).along.map(|x| self.sweep_rad.abs() * x)
    }

    /// The second derivative at `t`.
    #[must_use]
    pub fn second_derivative(&self, t: f64) -> [f64; D] {
        let outwards = self.part_about_middle(t, t).to_middle;
        outwards.map(|x| -(self.sweep_rad * self.sweep_rad) * x)
    }

    /// The same arc in reverse.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self {
            start_rad: self.start_rad + self.sweep_rad,
            sweep_rad: -self.sweep_rad,
            ends: [self.ends[1], self.ends[0]],
            slack: match self.chord_form {
                // The chord form uses no angle sum.
                Some(_) => self.slack,
                // Derived: the summed angle is off by half a step, which moves points by that angle times the radius.
                None => add_up(self.slack, mul_up(16.0 * f64::EPSILON, self.magnitude())),
            },
            ..*self
        }
    }

    /// The lowest and highest coordinates of a box that contains the arc: the box of its ends and of the
    /// points where the tangents at the ends of eight equal parts meet.
    #[must_use]
    pub fn bounds(&self) -> [[f64; D]; 2] {
        // The same rounding as for an evaluated point: convert/curves/chord.rs derives less than 16 half
        // steps.
        let rounding = 16.0 * f64::EPSILON * self.magnitude();
        let [mut low, mut high] = [self.ends[0]; 2];
        let mut widen = |p: [f64; D], by: f64| {
            for k in 0..D {
                low[k] = lesser(p[k] - by, low[k]);
                high[k] = greater(p[k] + by, high[k]);
            }
        };
        widen(self.ends[1], 0.0);
        //           ×        the tangents meet beyond the middle, by the secant of the half angle less 1,
        //         · · ·      in units of the distance from the centre
        //       ·       ·    A part of an eighth turns by less than half a circle, so it lies in the triangle.
        for part in 0..8 {
            let (a, b) = (f64::from(part) / 8.0, f64::from(part + 1) / 8.0);
            let ArcPart { half_rad, to_middle, .. } = self.part_about_middle(a, b);
            // The secant minus 1, without cancellation.
            let sin = libm::sin(0.5 * half_rad);
            let beyond = 2.0 * sin * sin / libm::cos(half_rad);
            let middle = self.evaluate(0.5 * (a + b));
            widen(std::array::from_fn(|k| middle[k] + beyond * to_middle[k]), rounding);
        }
        [low, high]
    }

    /// The largest sum of absolute values from which a coordinate is computed.
    fn magnitude(&self) -> f64 {
        self.magnitudes().into_iter().fold(0.0, greater)
    }

    /// For each coordinate the sum of the absolute values from which it is computed: of the centre and both
    /// axes, or of the farther end and the arc's height over its chord.
    pub(crate) fn magnitudes(&self) -> [f64; D] {
        let Some(form) = self.chord_form else {
            let [u, v] = self.axes;
            return std::array::from_fn(|k| self.centre[k].abs() + u[k].abs() + v[k].abs());
        };
        let sin = libm::sin(0.5 * form.half_rad);
        let [a, b] = self.ends;
        std::array::from_fn(|k| greater(a[k].abs(), b[k].abs()) + 2.0 * sin * sin * form.to_middle[k].abs())
    }

    pub(crate) fn is_finite(&self) -> bool {
        let [u, v] = self.axes;
        let to_middle = self.chord_form.map_or([0.0; D], |form| form.to_middle);
        let points = [self.centre, u, v, self.ends[0], self.ends[1], to_middle];
        points.as_flattened().iter().chain(&[self.start_rad, self.sweep_rad]).all(|x| x.is_finite())
    }

    /// The arc under an affine map. If the centre and axes are far beyond the arc, their rounding is included
    /// in its slack.
    #[must_use]
    pub fn transformed(&self, map: &AffineMap<D>) -> Self {
        let offset = map.offset.iter().fold(0.0, |sum, x| add_up(sum, x.abs()));
        let through = add_up(mul_up(map.stretch(), mul_up(D as f64, self.magnitude())), offset);
        // The rounding of points (`Curve::transformed`), for a centre and two axes.
        let rounding = mul_up(16.0 * (D * D) as f64 * f64::EPSILON, through);
        let slack = mul_up(map.stretch(), self.slack);
        // The chord form doesn't use the centre. An arc of more than half a turn reaches to
        // opposite sides of its centre, which is then no farther away than the arc itself.
        Self {
            centre: map.point(self.centre),
            axes: self.axes.map(|axis| map.vector(axis)),
            ends: self.ends.map(|end| map.point(end)),
            slack: if self.chord_form.is_some() || self.sweep_rad.abs() > PI {
                slack
            } else {
                add_up(slack, rounding)
            },
            chord_form: self
                .chord_form
                .map(|form| ChordForm { to_middle: map.vector(form.to_middle), half_rad: form.half_rad }),
            ..*self
        }
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
    fn more_than_a_turn_is_refused() {
        assert_eq!(Arc::<2>::new([0.0; 2], [[1.0, 0.0], [0.0, 1.0]], 0.0, 7.0), Err(InvalidArc));
    }
}
