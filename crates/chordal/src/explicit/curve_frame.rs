//! Curvature and torsion of paths and splines.
use super::nurbs::NurbsCurve;
use super::{Curve, CurveSegment};
use crate::math::{cross, dot, exponent, greater, length, power_of_two};

/// The signed curvature of a plane curve with these derivatives, positive for a left turn; `None` if its
/// speed is 0.
fn signed([first, second]: [[f64; 2]; 2]) -> Option<f64> {
    let (first, second, scale) = scaled(first, second)?;
    let speed = length(first);
    finite((first[0] * second[1] - first[1] * second[0]) / (speed * speed * speed) * scale)
}

/// The curvature of a space curve with these derivatives.
fn unsigned([first, second]: [[f64; 3]; 2]) -> Option<f64> {
    let (first, second, scale) = scaled(first, second)?;
    let speed = length(first);
    finite(length(cross(first, second)) / (speed * speed * speed) * scale)
}

/// The torsion of a curve with these derivatives; `None` if it does not bend.
fn twist([first, second, third]: [[f64; 3]; 3]) -> Option<f64> {
    let (first, second, scale) = scaled(first, second)?;
    let third = third.map(|x| x * scale);
    let normal = cross(first, second);
    let across = dot(normal, normal);
    // Like curvature, torsion is one over a length, so it scales the same way.
    if across > 0.0 { finite(dot(normal, third) / across * scale) } else { None }
}

/// Both derivatives times a power of two that makes the first about 1 long, and that power. `None` if the
/// first is 0.
fn scaled<const D: usize>(first: [f64; D], second: [f64; D]) -> Option<([f64; D], [f64; D], f64)> {
    let largest = first.iter().fold(0.0, |largest: f64, x| greater(x.abs(), largest));
    let scale = power_of_two(-exponent(largest));
    (largest > 0.0).then(|| (first.map(|x| x * scale), second.map(|x| x * scale), scale))
}

fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

impl<const D: usize> CurveSegment<D> {
    /// The third derivative at `t`.
    #[must_use]
    pub fn third_derivative(&self, t: f64) -> [f64; D] {
        match self {
            Self::Line(_) => [0.0; D],
            Self::Cubic(cubic) => {
                let [a, b, c, d] = cubic.control;
                std::array::from_fn(|k| {
                    6.0 * (((d[k] - c[k]) - (c[k] - b[k])) - ((c[k] - b[k]) - (b[k] - a[k])))
                })
            }
            Self::Arc(arc) => arc.tangent(t).map(|x| -(arc.sweep_rad() * arc.sweep_rad()) * x),
            Self::Rational(curve) => curve.third_derivative(t),
        }
    }
}

fn jet<const D: usize>(curve: &Curve<D>, s: f64) -> Option<[[f64; D]; 3]> {
    let (piece, t) = curve.locate(s)?;
    let segment = &curve.segments()[piece];
    Some([segment.tangent(t), segment.second_derivative(t), segment.third_derivative(t)])
}

impl Curve<2> {
    /// The curvature at `s` ([`Curve::at`]): one over the radius of the osculating circle, positive where the
    /// path turns left. `None` where its speed is 0, as in a cusp. At a join it is the curvature of the piece
    /// that starts there.
    ///
    /// ```
    /// use chordal::{Bezier, explicit::Curve};
    /// let arch = Curve::from(Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] });
    /// // In the middle the first derivative is (3/2, 0) and the second (0, −6).
    /// assert_eq!(arch.curvature(0.5), Some(-6.0 / 2.25));
    /// ```
    #[must_use]
    pub fn curvature(&self, s: f64) -> Option<f64> {
        let [first, second, _] = jet(self, s)?;
        signed([first, second])
    }
}

impl Curve<3> {
    /// The curvature at `s` ([`Curve::at`]), at least 0: one over the radius of the osculating circle. `None`
    /// where the speed is 0, as in a cusp. At a join it is the curvature of the piece that starts there.
    #[must_use]
    pub fn curvature(&self, s: f64) -> Option<f64> {
        let [first, second, _] = jet(self, s)?;
        unsigned([first, second])
    }

    /// The torsion at `s`: the rate at which the osculating plane turns with the length of the path, positive
    /// as in a right-handed screw. `None` where the path does not bend.
    #[must_use]
    pub fn torsion(&self, s: f64) -> Option<f64> {
        twist(jet(self, s)?)
    }
}

impl NurbsCurve<2> {
    /// The curvature at a parameter: one over the radius of the osculating circle, positive where the curve
    /// turns left. `None` where its speed is 0, as in a cusp. At a knot it is the curvature to its right.
    ///
    /// ```
    /// use chordal::explicit::nurbs::NurbsCurve;
    /// let circle = NurbsCurve::circle([0.0, 0.0], [[4.0, 0.0], [0.0, 4.0]])?;
    /// assert!((circle.curvature(0.3).unwrap() - 0.25).abs() < 1e-14);
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    #[must_use]
    pub fn curvature(&self, t: f64) -> Option<f64> {
        let derivatives = self.derivatives(t, 2);
        signed([derivatives[1], derivatives[2]])
    }
}

impl NurbsCurve<3> {
    /// The curvature at a parameter, at least 0: one over the radius of the osculating circle. `None` where
    /// the speed is 0, as in a cusp. At a knot it is the curvature to its right.
    #[must_use]
    pub fn curvature(&self, t: f64) -> Option<f64> {
        let derivatives = self.derivatives(t, 2);
        unsigned([derivatives[1], derivatives[2]])
    }

    /// The torsion at a parameter: the rate at which the osculating plane turns with the length of the curve,
    /// positive as in a right-handed screw. `None` where the curve does not bend.
    ///
    /// ```
    /// use chordal::explicit::nurbs::NurbsCurve;
    /// // (t, t², t³): the torsion at 0 is 3.
    /// let third = 1.0 / 3.0;
    /// let twisted = NurbsCurve::bezier(vec![[0.0; 3], [third, 0.0, 0.0], [2.0 * third, third, 0.0], [1.0; 3]])?;
    /// assert!((twisted.torsion(0.0).unwrap() - 3.0).abs() < 1e-14);
    /// # Ok::<(), chordal::explicit::nurbs::InvalidNurbs>(())
    /// ```
    #[must_use]
    pub fn torsion(&self, t: f64) -> Option<f64> {
        let derivatives = self.derivatives(t, 3);
        twist([derivatives[1], derivatives[2], derivatives[3]])
    }
}
