//! The laws of cubic curves: one test suite for every implementation, run by
//! [`curve_laws!`](crate::curve_laws).
//!
//! Lengths are compared in units in the last place (ulp) of the curve's size, its largest absolute
//! coordinate. One evaluation is three levels of `(1−t)·a + t·b`, each with four roundings of at most half an
//! ulp, most of which cancel.
use super::Bezier;
use crate::math::greater;

/// The operations of a cubic Bézier curve in `D` dimensions that the laws need.
pub trait CubicCurve<const D: usize>: Sized {
    /// The curve with these control points.
    fn from_control(control: [[f64; D]; 4]) -> Self;
    /// The control points.
    fn control(&self) -> [[f64; D]; 4];
    /// The point at `t` by the Bernstein form.
    fn at(&self, t: f64) -> [f64; D];
    /// The point at `t` by repeated linear interpolation.
    fn by_de_casteljau(&self, t: f64) -> [f64; D];
    /// The first derivative at `t`.
    fn tangent(&self, t: f64) -> [f64; D];
    /// The parts left and right of `t`.
    fn split(&self, t: f64) -> [Self; 2];
    /// The blossom, symmetric and affine in each of its three arguments.
    fn blossom(&self, a: f64, b: f64, c: f64) -> [f64; D];
}

impl<const D: usize> CubicCurve<D> for Bezier<D> {
    fn from_control(control: [[f64; D]; 4]) -> Self {
        Self { control }
    }
    fn control(&self) -> [[f64; D]; 4] {
        self.control
    }
    fn at(&self, t: f64) -> [f64; D] {
        Self::at(self, t)
    }
    fn by_de_casteljau(&self, t: f64) -> [f64; D] {
        self.de_casteljau(t).point
    }
    fn tangent(&self, t: f64) -> [f64; D] {
        Self::tangent(self, t)
    }
    fn split(&self, t: f64) -> [Self; 2] {
        Self::split(self, t)
    }
    fn blossom(&self, a: f64, b: f64, c: f64) -> [f64; D] {
        Self::blossom(self, a, b, c)
    }
}

/// Builds a module with one test for each law, on random curves of a type that implements
/// [`CubicCurve`](crate::explicit::laws::CubicCurve).
///
/// ```
/// chordal::curve_laws!(bezier_in_space, chordal::Bezier<3>, 3);
/// ```
#[macro_export]
macro_rules! curve_laws {
    ($name:ident, $curve:ty, $dimension:literal) => {
        mod $name {
            #[allow(unused_imports)]
            use super::*;
            $crate::curve_laws!(@each $curve, $dimension,
                weights_are_at_least_0_and_sum_to_1, starts_and_ends_at_its_end_points,
                leaves_and_arrives_along_its_legs, stays_inside_its_hull,
                bernstein_equals_de_casteljau, halves_evaluate_to_the_whole, blossom_is_symmetric_and_affine);
        }
    };
    (@each $curve:ty, $dimension:literal, $($law:ident),+) => {
        $(#[test]
        fn $law() {
            $crate::explicit::laws::$law::<$curve, $dimension>();
        })+
    };
}

/// Two evaluations of one point differ by at most this many ulp. Derived.
const SAME: f64 = 4.0;
/// A split before the evaluation adds its rounding, and that of the parameter: up to 3·eps times the slope,
/// which is at most 2 sizes. Derived.
const DERIVED: f64 = 16.0;

/// xorshift64*: sufficient for test data, and the same on every machine.
struct XorShift64(u64);

const SEED: u64 = 0x9e37_79b9_7f4a_7c15;

impl XorShift64 {
    fn unit(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn point<const D: usize>(&mut self, centre: f64, size: f64) -> [f64; D] {
        std::array::from_fn(|_| centre + size * (2.0 * self.unit() - 1.0))
    }

    /// Control points in general position, far from the origin, or coinciding, at scales from 1e-6 to 1e6.
    fn control<const D: usize>(&mut self, case: usize) -> [[f64; D]; 4] {
        // The tested scales, six orders of magnitude each way.
        let size = [1e-6, 1e-3, 1.0, 1e3, 1e6][case % 5];
        let centre = [0.0, 100.0 * size][case / 5 % 2];
        let mut control = std::array::from_fn(|_| self.point(centre, size));
        match case / 10 % 5 {
            1 => control[1] = control[0],
            2 => control[2] = control[1],
            3 => control = [control[0]; 4],
            4 => control[3] = control[0],
            _ => {}
        }
        control
    }
}

/// Calls `law` with curves, the ulp of the size of each, and parameters. A failure reports the seed.
fn for_curves<C: CubicCurve<D>, const D: usize>(law: impl Fn(&C, f64, f64) -> Result<(), String>) {
    let mut random = XorShift64(SEED);
    for case in 0..500 {
        let control = random.control(case);
        let curve = C::from_control(control);
        let size = control.as_flattened().iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        // Both ends, the middle, and the parameters next to the ends.
        let fixed = [0.0, 1.0, 0.5, f64::MIN_POSITIVE, 1.0 - f64::EPSILON];
        let parameters: Vec<f64> = fixed.into_iter().chain((0..15).map(|_| random.unit())).collect();
        for t in parameters {
            let broken = law(&curve, size.next_up() - size, t);
            assert!(
                broken.is_ok(),
                "{}; seed {SEED:#x}, case {case}, t = {t}, {control:?}",
                broken.unwrap_err()
            );
        }
    }
}

fn near<const D: usize>(what: &str, [a, b]: [[f64; D]; 2], slack: f64) -> Result<(), String> {
    let close = (0..D).all(|k| (a[k] - b[k]).abs() <= slack);
    if close { Ok(()) } else { Err(format!("{what}: {a:?} and {b:?} differ by more than {slack:e}")) }
}

fn blend<const D: usize>(a: [f64; D], b: [f64; D], t: f64) -> [f64; D] {
    std::array::from_fn(|k| (1.0 - t) * a[k] + t * b[k])
}

/// Each control point's weight, measured by moving that point alone, is ≥ 0, and the weights sum to 1.
///
/// # Panics
/// When the law is broken.
pub fn weights_are_at_least_0_and_sum_to_1<C: CubicCurve<D>, const D: usize>() {
    for_curves::<C, D>(|_, _, t| {
        let weight = |i: usize| {
            let control = std::array::from_fn(|j| [if i == j { 1.0 } else { 0.0 }; D]);
            C::from_control(control).at(t)[0]
        };
        let weights = [weight(0), weight(1), weight(2), weight(3)];
        let sum: f64 = weights.iter().sum();
        if weights.iter().any(|w| *w < 0.0) {
            return Err(format!("a weight is negative: {weights:?}"));
        }
        // In steps of 1, because the sum is close to 1.
        near("the sum of the weights", [[sum], [1.0]], SAME * f64::EPSILON)
    });
}

/// `B(0) = P0` and `B(1) = P3`, exactly.
///
/// # Panics
/// When the law is broken.
pub fn starts_and_ends_at_its_end_points<C: CubicCurve<D>, const D: usize>() {
    for_curves::<C, D>(|curve, _, _| {
        near("the start", [curve.at(0.0), curve.control()[0]], 0.0)?;
        near("the end", [curve.at(1.0), curve.control()[3]], 0.0)
    });
}

/// `B′(0) = 3(P1 − P0)` and `B′(1) = 3(P3 − P2)`.
///
/// # Panics
/// When the law is broken.
pub fn leaves_and_arrives_along_its_legs<C: CubicCurve<D>, const D: usize>() {
    for_curves::<C, D>(|curve, ulp, _| {
        let [p0, p1, p2, p3] = curve.control();
        let leg = |a: [f64; D], b: [f64; D]| std::array::from_fn(|k| 3.0 * (b[k] - a[k]));
        near("the first tangent", [curve.tangent(0.0), leg(p0, p1)], SAME * ulp)?;
        near("the last tangent", [curve.tangent(1.0), leg(p2, p3)], SAME * ulp)
    });
}

/// In each of several directions, no point of the curve is farther out than the farthest control point.
///
/// # Panics
/// When the law is broken.
pub fn stays_inside_its_hull<C: CubicCurve<D>, const D: usize>() {
    let mut random = XorShift64(SEED);
    let mut directions: Vec<[f64; D]> = (0..16).map(|_| random.point(0.0, 1.0 / D as f64)).collect();
    directions.extend(
        (0..D).flat_map(|k| [1.0, -1.0].map(|s| std::array::from_fn(|j| if j == k { s } else { 0.0 }))),
    );
    for_curves::<C, D>(|curve, ulp, t| {
        let point = curve.at(t);
        let out = |p: [f64; D], d: &[f64; D]| (0..D).map(|k| p[k] * d[k]).sum::<f64>();
        let outside = |d: &&[f64; D]| {
            let farthest = curve
                .control()
                .iter()
                .map(|p| out(*p, d))
                .fold(f64::NEG_INFINITY, |farthest, x| greater(x, farthest));
            out(point, d) > farthest + SAME * ulp
        };
        directions
            .iter()
            .find(outside)
            .map_or(Ok(()), |d| Err(format!("{point:?} leaves the hull towards {d:?}")))
    });
}

/// Both evaluations agree to 4 ulp of the size.
///
/// # Panics
/// When the law is broken.
pub fn bernstein_equals_de_casteljau<C: CubicCurve<D>, const D: usize>() {
    for_curves::<C, D>(|curve, ulp, t| {
        near("the point", [curve.at(t), curve.by_de_casteljau(t)], SAME * ulp)
    });
}

/// The two parts meet, keep the ends, and evaluate to points of the whole curve.
///
/// # Panics
/// When the law is broken.
pub fn halves_evaluate_to_the_whole<C: CubicCurve<D>, const D: usize>() {
    for_curves::<C, D>(|curve, ulp, t| {
        for cut in [0.5, t] {
            let [left, right] = curve.split(cut);
            near("where the parts meet", [left.control()[3], right.control()[0]], 0.0)?;
            near("the start of the left part", [left.control()[0], curve.control()[0]], 0.0)?;
            near("the end of the right part", [right.control()[3], curve.control()[3]], 0.0)?;
            for s in [0.25, 0.7] {
                near("the left part", [left.at(s), curve.at(cut * s)], DERIVED * ulp)?;
                near("the right part", [right.at(s), curve.at(cut + (1.0 - cut) * s)], DERIVED * ulp)?;
            }
        }
        Ok(())
    });
}

/// The blossom equals the curve on its diagonal and the control points at 0 and 1. It is the same in any
/// order of its arguments, and affine in each.
///
/// # Panics
/// When the law is broken.
pub fn blossom_is_symmetric_and_affine<C: CubicCurve<D>, const D: usize>() {
    for_curves::<C, D>(|curve, ulp, t| {
        let (a, b, c) = (t, 0.3, 0.85);
        let value = curve.blossom(a, b, c);
        for [x, y, z] in [[a, c, b], [b, a, c], [b, c, a], [c, a, b], [c, b, a]] {
            near("the order of arguments", [value, curve.blossom(x, y, z)], DERIVED * ulp)?;
        }
        near("the diagonal", [curve.blossom(t, t, t), curve.at(t)], DERIVED * ulp)?;
        near("the third control point", [curve.blossom(0.0, 1.0, 1.0), curve.control()[2]], 0.0)?;
        let between = blend(curve.blossom(a, b, 0.0), curve.blossom(a, b, 1.0), c);
        near("the last argument", [value, between], DERIVED * ulp)
    });
}
