//! `Bezier`: a cubic Bézier curve in the plane or in space.

/// A cubic Bézier curve with its four control points, in `D` dimensions.
///
/// ```
/// use chordal::Bezier;
/// let arch = Bezier { control: [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]] };
/// assert_eq!(arch.at(0.5), [0.5, 0.75]);
/// let levels = arch.de_casteljau(0.5);
/// assert_eq!(levels.point, [0.5, 0.75]);
/// assert_eq!(levels.first, [[0.0, 0.5], [0.5, 1.0], [1.0, 0.5]]);
/// ```
///
/// Source: P. Bézier and P. de Casteljau, as in G. Farin, *Curves and Surfaces for CAGD*, 5th ed., 2002, ch.
/// 4–5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bezier<const D: usize> {
    /// The control points. The curve starts at the first and ends at the last.
    pub control: [[f64; D]; 4],
}

/// De Casteljau's construction at one parameter: levels of three points, two, and one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeCasteljau<const D: usize> {
    /// Points on the three sides of the control polygon.
    pub first: [[f64; D]; 3],
    /// Points on the two segments between those; the line through them is tangent to the curve.
    pub second: [[f64; D]; 2],
    /// The point on the curve.
    pub point: [f64; D],
}

/// The four cubic Bernstein polynomials at `t`: each is ≥ 0 and their sum is 1 for `0 ≤ t ≤ 1`.
#[inline(always)]
#[must_use]
pub fn bernstein(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s * s * s, 3.0 * (s * s * t), 3.0 * (s * t * t), t * t * t]
}

/// The linear interpolation between `a` and `b` at `t`; exactly `a` at 0 and exactly `b` at 1.
#[inline]
pub(crate) fn lerp<const D: usize>(a: [f64; D], b: [f64; D], t: f64) -> [f64; D] {
    let s = 1.0 - t;
    std::array::from_fn(|k| s * a[k] + t * b[k])
}

impl<const D: usize> Bezier<D> {
    /// The point at `t` by the Bernstein form.
    #[inline]
    #[must_use]
    pub fn at(&self, t: f64) -> [f64; D] {
        let [w0, w1, w2, w3] = bernstein(t);
        let [p0, p1, p2, p3] = self.control;
        std::array::from_fn(|k| (w0 * p0[k] + w1 * p1[k]) + (w2 * p2[k] + w3 * p3[k]))
    }

    /// The point at `t` by repeated linear interpolation, with all its levels.
    #[must_use]
    pub fn de_casteljau(&self, t: f64) -> DeCasteljau<D> {
        let [p0, p1, p2, p3] = self.control;
        let first = [lerp(p0, p1, t), lerp(p1, p2, t), lerp(p2, p3, t)];
        let second = [lerp(first[0], first[1], t), lerp(first[1], first[2], t)];
        DeCasteljau { first, second, point: lerp(second[0], second[1], t) }
    }

    /// The first derivative at `t`.
    #[must_use]
    pub fn tangent(&self, t: f64) -> [f64; D] {
        let p = &self.control;
        let s = 1.0 - t;
        let (w0, w1, w2) = (3.0 * s * s, 6.0 * s * t, 3.0 * t * t);
        std::array::from_fn(|k| {
            w0 * (p[1][k] - p[0][k]) + w1 * (p[2][k] - p[1][k]) + w2 * (p[3][k] - p[2][k])
        })
    }

    /// The second derivative at `t`.
    #[must_use]
    pub fn second_derivative(&self, t: f64) -> [f64; D] {
        let p = &self.control;
        let (w0, w1) = (6.0 * (1.0 - t), 6.0 * t);
        std::array::from_fn(|k| {
            let d0 = (p[0][k] - p[1][k]) - (p[1][k] - p[2][k]);
            let d1 = (p[1][k] - p[2][k]) - (p[2][k] - p[3][k]);
            w0 * d0 + w1 * d1
        })
    }

    /// The two parts left and right of `t`, each reparametrized to `[0, 1]`.
    #[must_use]
    pub fn split(&self, t: f64) -> [Self; 2] {
        let DeCasteljau { first, second, point } = self.de_casteljau(t);
        [
            Self { control: [self.control[0], first[0], second[0], point] },
            Self { control: [point, second[1], first[2], self.control[3]] },
        ]
    }

    /// The blossom: the symmetric, three-fold affine form with `blossom(t, t, t) = at(t)`.
    ///
    /// Source: L. Ramshaw, *Blossoming: a connect-the-dots approach to splines*, 1987.
    #[must_use]
    pub fn blossom(&self, a: f64, b: f64, c: f64) -> [f64; D] {
        let [p0, p1, p2, p3] = self.control;
        let first = [lerp(p0, p1, a), lerp(p1, p2, a), lerp(p2, p3, a)];
        lerp(lerp(first[0], first[1], b), lerp(first[1], first[2], b), c)
    }

    /// The part between `t0` and `t1`, reparametrized to `[0, 1]`.
    #[must_use]
    pub fn part(&self, t0: f64, t1: f64) -> Self {
        Self {
            control: [
                self.blossom(t0, t0, t0),
                self.blossom(t0, t0, t1),
                self.blossom(t0, t1, t1),
                self.blossom(t1, t1, t1),
            ],
        }
    }

    /// The same curve in reverse.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let [a, b, c, d] = self.control;
        Self { control: [d, c, b, a] }
    }

    /// The lowest and highest coordinates of the control points. The curve lies between them for `0 ≤ t ≤ 1`.
    #[must_use]
    pub fn bounds(&self) -> [[f64; D]; 2] {
        let end = |pick: fn(f64, f64) -> bool| {
            std::array::from_fn(|k| {
                self.control.iter().map(|p| p[k]).reduce(|a, b| if pick(a, b) { a } else { b }).unwrap_or(0.0)
            })
        };
        [end(|a, b| a < b), end(|a, b| a > b)]
    }

    /// Whether all four control points are equal, so that the curve is a point.
    #[must_use]
    pub fn is_point(&self) -> bool {
        self.control.iter().all(|p| *p == self.control[0])
    }
}
