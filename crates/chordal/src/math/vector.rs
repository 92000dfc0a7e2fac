//! Sums over the axes of vectors in any dimension, in the order of the axes.

/// `a · b`.
#[inline(always)]
pub(crate) fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).fold(0.0, |sum, k| sum + a[k] * b[k])
}

/// `a − b`.
#[inline(always)]
pub(crate) fn difference<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|k| a[k] - b[k])
}

/// `|a|`.
#[inline(always)]
pub(crate) fn length<const D: usize>(a: [f64; D]) -> f64 {
    dot(a, a).sqrt()
}

/// `|a − b|`.
#[inline(always)]
pub(crate) fn distance<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    length(difference(a, b))
}

/// `a × b`.
#[inline(always)]
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `v` scaled to length 1, or `None` if it has no direction: zero, infinite or NaN.
///
/// ```
/// use chordal::math::unit;
/// assert_eq!((unit([0.0, 3e300, 4e300]), unit([0.0; 3])), (Some([0.0, 0.6, 0.8]), None));
/// ```
#[inline]
pub fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let largest = v.iter().fold(0.0, |most, x| greater(x.abs(), most));
    if !(largest > 0.0 && v.iter().all(|x| x.is_finite())) {
        return None;
    }
    // Scale first, so that squares neither overflow nor vanish.
    let scaled = v.map(|x| x / largest);
    let length = length(scaled);
    Some(scaled.map(|x| x / length))
}

/// `v` divided by its length, and the length, for vectors whose squares neither overflow nor vanish; NaN for
/// zero.
#[inline(always)]
pub(crate) fn unit_and_length(v: [f64; 3]) -> ([f64; 3], f64) {
    let length = length(v);
    (v.map(|x| x / length), length)
}

/// The lesser of two numbers: `b` if they are equal or one is NaN, so that signs of zero are the same on
/// every platform; those of `f64::min` need not be.
///
/// ```
/// use chordal::math::lesser;
/// assert_eq!((lesser(1.0, 2.0), lesser(1.0, f64::NAN).is_nan(), lesser(f64::NAN, 1.0)), (1.0, true, 1.0));
/// ```
#[inline(always)]
pub fn lesser<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// The greater of two numbers: `b` if they are equal or one is NaN.
#[inline(always)]
pub fn greater<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}
