//! Exact predicates: the side on which a point lies, decided without rounding for all finite coordinates.
//!
//! In the usual range the answer comes from J. Shewchuk's adaptive expansions (crate `robust`). These are
//! exact as long as nothing overflows and no error term or error bound is subnormal. With every coordinate 0
//! or `2^low ≤ |x| ≤ 2^high`, all coordinates and their differences are multiples of `2^(low−52)`; a
//! predicate of degree `d` then handles multiples of `2^(d·(low−52))` and, in the smallest error bound,
//! numbers 2¹⁰³ times smaller, which must stay above 2⁻¹⁰²²; at the upper end, `d`-fold products of
//! differences, six of them together, must stay below 2¹⁰²⁴. That holds for `[2^−400, 2^500]` in the plane (d
//! = 2) and for `[2^−250, 2^300]` in space (d = 3). Outside that range, integers of any size decide: also
//! exactly, in some microseconds per call instead of some nanoseconds.
//!
//! Coordinates must be finite: for a NaN or an infinity there is no side, and the answer is
//! [`Orientation::Flat`].
//!
//! Source: J. R. Shewchuk, *Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
//! Predicates*, 1997.
use super::big_int::BigInt;
use robust::{Coord, Coord3D};
use std::cmp::Ordering;

/// The side on which the last point lies of the line or plane through the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Orientation {
    /// Left of the line; in front of the plane. The points run counter-clockwise.
    Front,
    /// Exactly on it, or the other points span no line or plane.
    Flat,
    /// Right of the line; behind the plane. The points run clockwise.
    Back,
}

/// The position of a point relative to a triangle in the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PointInTriangle {
    /// Inside, and not on a side.
    Inside,
    /// On a side or a corner, exactly.
    Boundary,
    /// Outside.
    Outside,
}

impl Orientation {
    /// The orientation after an odd permutation of the points.
    #[must_use]
    pub fn flipped(self) -> Self {
        match self {
            Self::Front => Self::Back,
            Self::Flat => Self::Flat,
            Self::Back => Self::Front,
        }
    }

    fn from_sign(determinant: f64) -> Self {
        if determinant > 0.0 {
            Self::Front
        } else if determinant < 0.0 {
            Self::Back
        } else {
            Self::Flat
        }
    }

    fn from_ordering(sign: Ordering) -> Self {
        match sign {
            Ordering::Greater => Self::Front,
            Ordering::Equal => Self::Flat,
            Ordering::Less => Self::Back,
        }
    }
}

/// The side of the line from `a` to `b` on which the point `c` lies: the sign of `(b − a) × (c − a)`,
/// exactly.
///
/// ```
/// use chordal::math::exact::{Orientation, orient2d};
/// assert_eq!(orient2d([0.0, 0.0], [1.0, 0.0], [0.5, 1e-300]), Orientation::Front);
/// assert_eq!(orient2d([0.1, 0.1], [0.2, 0.2], [0.3, 0.3]), Orientation::Flat);
/// ```
#[must_use]
pub fn orient2d(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Orientation {
    let points = [a, b, c];
    let coordinates = points.as_flattened();
    if exponents_in_range(coordinates, -400, 500) {
        let [a, b, c] = points.map(|[x, y]| Coord { x, y });
        Orientation::from_sign(robust::orient2d(a, b, c))
    } else if coordinates.iter().all(|x| x.is_finite()) {
        orient2d_wide(points)
    } else {
        Orientation::Flat
    }
}

/// The side of the plane through `a`, `b`, `c` on which the point `d` lies: the sign of
/// `((b − a) × (c − a)) · (d − a)`, exactly. In front of the plane, the three are seen counter-clockwise.
///
/// ```
/// use chordal::math::exact::{Orientation, orient3d};
/// let [a, b, c] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// assert_eq!(orient3d(a, b, c, [0.0, 0.0, 1.0]), Orientation::Front);
/// assert_eq!(orient3d(a, b, c, [5.0, 7.0, 0.0]), Orientation::Flat);
/// ```
#[must_use]
pub fn orient3d(a: [f64; 3], b: [f64; 3], c: [f64; 3], d: [f64; 3]) -> Orientation {
    let points = [a, b, c, d];
    let coordinates = points.as_flattened();
    if exponents_in_range(coordinates, -250, 300) {
        let [a, b, c, d] = points.map(|[x, y, z]| Coord3D { x, y, z });
        // Shewchuk's sign is positive below the plane, which is behind it in our terms.
        Orientation::from_sign(robust::orient3d(a, b, c, d)).flipped()
    } else if coordinates.iter().all(|x| x.is_finite()) {
        orient3d_wide(points)
    } else {
        Orientation::Flat
    }
}

/// The position of `point` relative to the triangle with these corners, in either orientation. A triangle
/// without area is its own boundary.
///
/// ```
/// use chordal::math::exact::{PointInTriangle, triangle_contains};
/// let triangle = [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]];
/// assert_eq!(triangle_contains(triangle, [1.0, 1.0]), PointInTriangle::Inside);
/// assert_eq!(triangle_contains(triangle, [2.0, 2.0]), PointInTriangle::Boundary);
/// assert_eq!(triangle_contains(triangle, [2.0, 2.0 + 1e-15]), PointInTriangle::Outside);
/// ```
#[must_use]
pub fn triangle_contains([a, b, c]: [[f64; 2]; 3], point: [f64; 2]) -> PointInTriangle {
    let sides = [orient2d(a, b, point), orient2d(b, c, point), orient2d(c, a, point)];
    let on_some = |side| sides.contains(&side);
    // The orientation of the triangle is unknown: only whether the sides agree counts. In front of
    // one side and behind another is outside in either orientation.
    match (on_some(Orientation::Front), on_some(Orientation::Back), on_some(Orientation::Flat)) {
        (true, true, _) => PointInTriangle::Outside,
        (_, _, false) => PointInTriangle::Inside,
        (true, _, true) | (_, true, true) => PointInTriangle::Boundary,
        // All four points are collinear, so the triangle is a segment, and the point is on it if it is inside
        // its bounding box.
        (false, false, true) => {
            let between = |k: usize| {
                let reached = |other: fn(f64, f64) -> bool| [a, b, c].iter().any(|p| other(p[k], point[k]));
                reached(|corner, x| corner <= x) && reached(|corner, x| corner >= x)
            };
            if between(0) && between(1) { PointInTriangle::Boundary } else { PointInTriangle::Outside }
        }
    }
}

/// The sign of `v · (b − a)`, exactly: the order of the points along a direction. Coordinates must be finite.
pub(crate) fn dot_sign(v: [f64; 2], a: [f64; 2], b: [f64; 2]) -> Ordering {
    let terms = [v[0] * b[0], v[1] * b[1], -(v[0] * a[0]), -(v[1] * a[1])];
    let sum = (terms[0] + terms[2]) + (terms[1] + terms[3]);
    // Each product and each of three sums has an error of half a unit in the last place: less than 4 ε of the
    // sum of the sizes, whose own rounding is smaller.
    let size: f64 = terms.iter().map(|term| term.abs()).sum();
    // In this range nothing overflows, and a product that underflows is wrong by far less than ε of
    // the sum.
    let clear = (1e-280..1e280).contains(&size);
    if clear && sum.abs() > 8.0 * f64::EPSILON * size {
        return if sum > 0.0 { Ordering::Greater } else { Ordering::Less };
    }
    let [v, a, b] = [v, a, b].map(|p| p.map(BigInt::from_f64));
    let along = |k: usize| &v[k] * &(&b[k] - &a[k]);
    (&along(0) - &-along(1)).sign()
}

/// Whether each number is 0 or has an absolute value in `[2^low, 2^high)`.
#[inline]
fn exponents_in_range(coordinates: &[f64], low: i32, high: i32) -> bool {
    coordinates.iter().all(|x| {
        let magnitude = x.to_bits() << 1;
        // The exponent is stored with 1023 added, 53 bits up after the shift in `magnitude`.
        let biased = (magnitude >> 53) as i32 - 1023;
        magnitude == 0 || (low <= biased && biased < high)
    })
}

fn orient2d_wide(points: [[f64; 2]; 3]) -> Orientation {
    let [a, b, c] = points.map(|p| p.map(BigInt::from_f64));
    let (abx, aby) = (&b[0] - &a[0], &b[1] - &a[1]);
    let (acx, acy) = (&c[0] - &a[0], &c[1] - &a[1]);
    Orientation::from_ordering((&(&abx * &acy) - &(&aby * &acx)).sign())
}

fn orient3d_wide(points: [[f64; 3]; 4]) -> Orientation {
    let [a, b, c, d] = points.map(|p| p.map(BigInt::from_f64));
    let from_a = |p: &[BigInt; 3]| -> [BigInt; 3] { std::array::from_fn(|k| &p[k] - &a[k]) };
    let (ab, ac, ad) = (from_a(&b), from_a(&c), from_a(&d));
    // The three terms of the triple product, by the coordinate of d.
    let [x, y, z] = [(1, 2, 0), (2, 0, 1), (0, 1, 2)]
        .map(|(i, j, k)| &(&(&ab[i] * &ac[j]) - &(&ab[j] * &ac[i])) * &ad[k]);
    Orientation::from_ordering((&(&x - &-y) - &-z).sign())
}
