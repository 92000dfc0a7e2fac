//! Whether three points are collinear, exactly: for all finite coordinates, even of very different
//! magnitudes.

/// Whether three points in space are collinear, including two or three equal ones. Exact.
///
/// A floating-point filter on three 2 × 2 determinants nearly always decides; otherwise they are summed as
/// integers.
///
/// ```
/// use chordal::check::is_collinear;
/// assert!(is_collinear([0.0; 3], [1.0; 3], [3.0; 3]));
/// assert!(!is_collinear([0.0; 3], [1.0; 3], [3.0, 3.0, 3.0_f64.next_up()]));
/// // In decimals they are on one line. What is stored is not.
/// assert!(!is_collinear([0.1, 0.1, 0.0], [0.2, 0.2, 0.0], [0.3, 0.1 + 0.2, 0.0]));
/// ```
///
/// Source: the filter is stage A of J. R. Shewchuk, *Adaptive precision floating-point arithmetic and fast
/// robust geometric predicates*, 1997.
#[must_use]
pub fn is_collinear(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> bool {
    let planes = [(0, 1), (1, 2), (2, 0)];
    let turn = |(x, y): (usize, usize)| [a, b, c].map(|p| [p[x], p[y]]);
    // The filter on all planes first: one certain turn suffices.
    !planes.iter().any(|&plane| turns_clearly(turn(plane)))
        && planes.iter().all(|&plane| is_straight(turn(plane)))
}

/// Whether a triangle has exactly no area.
#[must_use]
pub fn has_zero_area([a, b, c]: [[f64; 3]; 3]) -> bool {
    is_collinear(a, b, c)
}

/// Whether three points in the plane are certainly not collinear.
#[inline]
fn turns_clearly([a, b, c]: [[f64; 2]; 3]) -> bool {
    let (left, right) = ((a[0] - c[0]) * (b[1] - c[1]), (a[1] - c[1]) * (b[0] - c[0]));
    // With u = 2⁻⁵³ the rounding error of the determinant is at most (3 + 16u)·u·(|left| + |right|) (Shewchuk
    // 1997, eq. 15), and that much more where a product underflows: below 2⁻¹⁰⁷³, far below the smallest
    // normal number. Infinities from overflow make the comparison false.
    const U: f64 = f64::EPSILON / 2.0;
    (left - right).abs() > (3.0 + 16.0 * U) * U * (left.abs() + right.abs()) + f64::MIN_POSITIVE
}

/// Whether three points in the plane are exactly collinear: `(a − c) × (b − c) = 0`, expanded into products
/// of two coordinates, each an integer of at most 106 bits times a power of two.
fn is_straight([a, b, c]: [[f64; 2]; 3]) -> bool {
    let term = |x: f64, y: f64| {
        let ((mx, ex), (my, ey)) = (integer(x), integer(y));
        (i128::from(mx) * i128::from(my), ex + ey)
    };
    let minus = |(mantissa, exponent): (i128, i32)| (-mantissa, exponent);
    let mut terms = [
        term(a[0], b[1]),
        minus(term(a[0], c[1])),
        minus(term(c[0], b[1])),
        minus(term(a[1], b[0])),
        term(a[1], c[0]),
        term(c[1], b[0]),
    ];
    terms.sort_unstable_by_key(|term| term.1);
    // From the lowest power of two upwards: the sum so far must be a multiple of the next power, since all
    // later terms are. Six terms below 2¹⁰⁶ stay below 2¹⁰⁹.
    let (mut sum, mut exponent) = (0_i128, 0);
    for (mantissa, next) in terms {
        if sum != 0 {
            let shift = (next - exponent) as u32;
            if sum.trailing_zeros() < shift {
                return false;
            }
            sum >>= shift;
        }
        sum += mantissa;
        exponent = next;
    }
    sum == 0
}

/// A finite number as an integer of at most 53 bits and a power of two.
fn integer(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let (fraction, exponent) = ((bits & ((1 << 52) - 1)) as i64, (bits >> 52 & 0x7ff) as i32);
    let (mantissa, exponent) =
        if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) };
    (if x.is_sign_negative() { -mantissa } else { mantissa }, exponent)
}
