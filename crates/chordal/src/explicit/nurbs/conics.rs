//! Bézier curves of any degree, and arcs of conics, which are exact with weights.
use super::NurbsCurve;
use super::knots::{InvalidNurbs, KnotVector};
use std::f64::consts::{FRAC_PI_2, TAU};

impl<const D: usize> NurbsCurve<D> {
    /// The Bézier curve with these control points, over the domain from 0 to 1: its degree is one less than
    /// their number.
    ///
    /// # Errors
    /// When there are fewer than 2 points or more than 31, or a number is not finite.
    ///
    /// ```
    /// use chordal::explicit::nurbs::NurbsCurve;
    /// let arch = NurbsCurve::bezier(vec![[0.0, 0.0], [1.0, 2.0], [2.0, 0.0]])?;
    /// assert_eq!(arch.at(0.5), [1.0, 1.0]);
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    pub fn bezier(control: Vec<[f64; D]>) -> Result<Self, InvalidNurbs> {
        let n = control.len();
        if n < 2 {
            return Err(InvalidNurbs::TooFew { degree: 1, points: n });
        }
        Self::new(KnotVector::clamped(n - 1, n)?, control, vec![1.0; n])
    }

    /// An arc of a conic section from `points[0]` to `points[2]`, whose end tangents meet in `points[1]`,
    /// given by its weight at that point: part of an ellipse below 1, of a parabola at 1, of a hyperbola
    /// above.
    ///
    /// # Errors
    /// When the weight is not above 0 or a number not finite.
    ///
    /// ```
    /// use chordal::explicit::nurbs::NurbsCurve;
    /// let quarter = NurbsCurve::conic([[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], 0.5_f64.sqrt())?;
    /// let [x, y] = quarter.at(0.25);
    /// assert!((x.hypot(y) - 1.0).abs() < 1e-15);
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    pub fn conic(points: [[f64; D]; 3], weight: f64) -> Result<Self, InvalidNurbs> {
        Self::new(KnotVector::clamped(2, 3)?, points.to_vec(), vec![1.0, weight, 1.0])
    }

    /// The arc `centre + cos(a)·axes[0] + sin(a)·axes[1]`, where `a` runs from `start_rad` over `sweep_rad`:
    /// of an ellipse by two conjugate half-axes, or of a circle. The domain is from 0 to the number of its
    /// pieces.
    ///
    /// It has one piece for each quarter of a turn, at most four, so that weights stay above 0.7. A sweep of
    /// 2π or −2π, in f64, is closed to the bit. If the angles are multiples of a quarter turn, the points are
    /// exact; otherwise sines and cosines are rounded, and the arc is off by a few units in the last place of
    /// the largest coordinate.
    ///
    /// # Errors
    /// When a number is not finite, the sweep is 0, or it exceeds a full turn.
    ///
    /// ```
    /// use chordal::explicit::nurbs::NurbsCurve;
    /// let half = NurbsCurve::arc([1.0, 0.0], [[2.0, 0.0], [0.0, 2.0]], 0.0, std::f64::consts::PI)?;
    /// assert_eq!((half.at(0.0), half.at(1.0), half.at(2.0)), ([3.0, 0.0], [1.0, 2.0], [-1.0, 0.0]));
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    pub fn arc(
        centre: [f64; D],
        axes: [[f64; D]; 2],
        start_rad: f64,
        sweep_rad: f64,
    ) -> Result<Self, InvalidNurbs> {
        if let Some(index) = [start_rad, sweep_rad].iter().position(|x| !x.is_finite()) {
            return Err(InvalidNurbs::NotFinite { what: "angle", index });
        }
        if sweep_rad == 0.0 || sweep_rad.abs() > TAU {
            return Err(InvalidNurbs::Sweep(sweep_rad));
        }
        // A computed quarter turn may be a few roundings longer.
        let quarters = sweep_rad.abs() / FRAC_PI_2;
        let n = (quarters - 4.0 * f64::EPSILON * quarters).ceil();
        let half = 0.5 * sweep_rad / n;
        let corner = libm::cos(half);
        let point = |i: usize| -> [f64; D] {
            let (sin, cos) = sin_cos(start_rad + half * i as f64);
            // The corner lies where the tangents meet.
            let out = if i.is_multiple_of(2) { 1.0 } else { 1.0 / corner };
            std::array::from_fn(|k| centre[k] + (out * cos * axes[0][k] + out * sin * axes[1][k]))
        };
        let mut control: Vec<[f64; D]> = (0..=2 * n as usize).map(point).collect();
        if sweep_rad.abs() == TAU
            && let Some(last) = control.len().checked_sub(1)
        {
            control[last] = control[0];
        }
        let weights = (0..control.len()).map(|i| if i.is_multiple_of(2) { 1.0 } else { corner }).collect();
        let mut knots = vec![0.0; 3];
        (1..n as usize).for_each(|k| knots.extend([k as f64; 2]));
        knots.extend([n; 3]);
        Self::new(KnotVector::new(2, knots)?, control, weights)
    }
}

/// The sine and cosine; next to a multiple of a quarter turn, those of the multiple.
fn sin_cos(angle_rad: f64) -> (f64, f64) {
    let quarters = angle_rad / FRAC_PI_2;
    // An angle that is meant to be a multiple is off by the rounding of two sums.
    let nearest = quarters.round();
    if (quarters - nearest).abs() <= 2.0 * f64::EPSILON * quarters.abs() && nearest.abs() <= 64.0 {
        return match (nearest as i64).rem_euclid(4) {
            0 => (0.0, 1.0),
            1 => (1.0, 0.0),
            2 => (0.0, -1.0),
            _ => (-1.0, 0.0),
        };
    }
    libm::sincos(angle_rad)
}
