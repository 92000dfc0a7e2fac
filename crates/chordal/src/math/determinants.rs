//! Exact signs of small integer determinants, and the sign of a zero determinant after a symbolic
//! perturbation.
//!
//! Entries are below 2⁵³ in absolute value, so they are exact as doubles. A floating-point filter decides the
//! sign if rounding cannot change it; otherwise 256-bit integers decide.
use std::cmp::Ordering;

/// Half the distance from 1 to the next double.
const U: f64 = f64::EPSILON / 2.0;
/// The relative error of a determinant of rank 3, with respect to the sum of its absolute terms. Derived:
/// each term has 2 products, 1 difference and 2 sums, so 5 roundings, and as many in the sum that it is
/// compared with; 12 is more than both together.
const ERROR_3: f64 = 12.0 * U;
/// The same for rank 4. Derived: by pairs of rows a term has 2 roundings in either factor, a product and 5
/// sums, so 10; 24 is more than those and as many in the sum that it is compared with.
const ERROR_4: f64 = 24.0 * U;

/// An integer of 256 bits in two's complement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Int256 {
    high: i128,
    low: u128,
}

impl Int256 {
    const ZERO: Self = Self { high: 0, low: 0 };

    /// `a · b` for factors below 2¹²⁷.
    fn product(a: i128, b: i128) -> Self {
        const MASK: u128 = (1 << 64) - 1;
        let (x, y) = (a.unsigned_abs(), b.unsigned_abs());
        let ([x1, x0], [y1, y0]) = ([x >> 64, x & MASK], [y >> 64, y & MASK]);
        let low = x0 * y0;
        // Each middle product is below 2¹²⁷, since the upper halves are below 2⁶³.
        let middle = x1 * y0 + x0 * y1 + (low >> 64);
        let size = Self { high: (x1 * y1 + (middle >> 64)) as i128, low: middle << 64 | low & MASK };
        if (a < 0) == (b < 0) { size } else { size.negated() }
    }

    fn negated(self) -> Self {
        let (low, carry) = (!self.low).overflowing_add(1);
        Self { high: (!self.high).wrapping_add(i128::from(carry)), low }
    }

    fn plus(self, other: Self) -> Self {
        let (low, carry) = self.low.overflowing_add(other.low);
        Self { high: self.high.wrapping_add(other.high).wrapping_add(i128::from(carry)), low }
    }

    fn sign(self) -> Ordering {
        if self.high == 0 { self.low.cmp(&0) } else { self.high.cmp(&0) }
    }

    /// The nearest double up to two roundings.
    fn to_f64(self) -> f64 {
        /// 2¹²⁸.
        const RADIX: f64 = 340_282_366_920_938_463_463_374_607_431_768_211_456.0;
        if self.high < 0 {
            return -self.negated().to_f64();
        }
        self.high as f64 * RADIX + self.low as f64
    }
}

/// The determinant of rank 2, exactly.
fn determinant2(a: [i64; 2], b: [i64; 2]) -> i128 {
    i128::from(a[0]) * i128::from(b[1]) - i128::from(a[1]) * i128::from(b[0])
}

/// The determinant of rank 3, exactly.
fn determinant3([a, b, c]: [[i64; 3]; 3]) -> Int256 {
    let minor = |i: usize, j: usize| determinant2([b[i], b[j]], [c[i], c[j]]);
    let term = |k: usize, i: usize, j: usize| Int256::product(minor(i, j), i128::from(a[k]));
    term(0, 1, 2).plus(term(1, 2, 0)).plus(term(2, 0, 1))
}

/// The determinant of rank 4, exactly, by the minors of its two pairs of rows.
fn determinant4([a, b, c, d]: [[i64; 4]; 4]) -> Int256 {
    // Columns of the first pair, the other columns, and whether the term is negative.
    const PAIRS: [([usize; 2], [usize; 2], bool); 6] = [
        ([0, 1], [2, 3], false),
        ([0, 2], [1, 3], true),
        ([0, 3], [1, 2], false),
        ([1, 2], [0, 3], false),
        ([1, 3], [0, 2], true),
        ([2, 3], [0, 1], false),
    ];
    // Products of two entries are below 2¹⁰⁶, so a minor is below 2¹⁰⁷ and fits in an i128; a term
    // is below 2²¹⁴, and all six together fit in 256 bits.
    let minor = |p: &[i64; 4], q: &[i64; 4], [i, j]: [usize; 2]| determinant2([p[i], p[j]], [q[i], q[j]]);
    PAIRS.iter().fold(Int256::ZERO, |sum, (first, second, negative)| {
        let term = Int256::product(minor(&a, &b, *first), minor(&c, &d, *second));
        sum.plus(if *negative { term.negated() } else { term })
    })
}

/// The sign of a determinant of rank 2.
pub(crate) fn sign2([a, b]: [[i64; 2]; 2]) -> Ordering {
    determinant2(a, b).cmp(&0)
}

/// The sign of a determinant of rank 3.
pub(crate) fn sign3(rows: [[i64; 3]; 3]) -> Ordering {
    let [a, b, c] = rows.map(|row| row.map(|x| x as f64));
    let (mut sum, mut size) = (0.0, 0.0);
    for (k, i, j) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        let (p, q) = (b[i] * c[j], b[j] * c[i]);
        sum += a[k] * (p - q);
        size += a[k].abs() * (p.abs() + q.abs());
    }
    filtered_sign(sum, ERROR_3 * size).unwrap_or_else(|| determinant3(rows).sign())
}

/// The sign of a determinant of rank 4.
pub(crate) fn sign4(rows: [[i64; 4]; 4]) -> Ordering {
    let [a, b, c, d] = rows.map(|row| row.map(|x| x as f64));
    // `size` sums the terms without their signs, cancelled parts included: rounding errors are a
    // share of that, not of the determinant, which may be 0.
    let (mut sum, mut size) = (0.0, 0.0);
    let mut add = |[i, j]: [usize; 2], [k, l]: [usize; 2], sign: f64| {
        let (p, q) = (a[i] * b[j], a[j] * b[i]);
        let (r, s) = (c[k] * d[l], c[l] * d[k]);
        sum += sign * ((p - q) * (r - s));
        size += (p.abs() + q.abs()) * (r.abs() + s.abs());
    };
    add([0, 1], [2, 3], 1.0);
    add([0, 2], [1, 3], -1.0);
    add([0, 3], [1, 2], 1.0);
    add([1, 2], [0, 3], 1.0);
    add([1, 3], [0, 2], -1.0);
    add([2, 3], [0, 1], 1.0);
    filtered_sign(sum, ERROR_4 * size).unwrap_or_else(|| determinant4(rows).sign())
}

/// The sign of a number whose error is at most `error`, if that decides it.
fn filtered_sign(sum: f64, error: f64) -> Option<Ordering> {
    if sum > error {
        Some(Ordering::Greater)
    } else if sum < -error {
        Some(Ordering::Less)
    } else {
        None
    }
}

/// The barycentric coordinates at which two functions that are linear on a triangle vanish, from their values
/// at its corners, up to a few roundings. `None` if they do not meet in one point.
pub(crate) fn common_zero3([a, b]: [[i64; 3]; 2]) -> Option<[f64; 3]> {
    let minor = |i: usize, j: usize| determinant2([a[i], a[j]], [b[i], b[j]]);
    let weights = [minor(1, 2), minor(2, 0), minor(0, 1)];
    // Six products below 2¹⁰⁶ cannot overflow.
    let sum = weights[0] + weights[1] + weights[2];
    (sum != 0).then(|| weights.map(|w| w as f64 / sum as f64))
}

/// [`common_zero3`] for three functions on a tetrahedron.
pub(crate) fn common_zero4(rows: [[i64; 4]; 3]) -> Option<[f64; 4]> {
    const OTHERS: [[usize; 3]; 4] = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];
    // The minors with alternating signs are orthogonal to each row, since a determinant with a
    // repeated row is 0. So all common zeros are multiples of this one vector.
    let weights: [Int256; 4] = std::array::from_fn(|k| {
        let minor = determinant3(rows.map(|row| OTHERS[k].map(|i| row[i])));
        if k % 2 == 0 { minor } else { minor.negated() }
    });
    let sum = weights.iter().fold(Int256::ZERO, |sum, w| sum.plus(*w));
    (sum != Int256::ZERO).then(|| weights.map(|w| w.to_f64() / sum.to_f64()))
}

/// The sign of a determinant whose rows are perturbed by constants: row `k` by `sense[k]`·ε`[order[k]]`, with
/// 1 ≫ ε₀ ≫ ε₁ ≫ … > 0.
///
/// Terms with two of the constants vanish, since their rows are equal. So if the determinant is 0, the sign
/// is that of the first row in the order whose replacement by its sense gives a nonzero determinant. It is 0
/// only if the functions have too few independent directions to meet in one point.
pub(crate) fn perturbed_sign<const N: usize>(
    rows: [[i64; N]; N],
    order: [u32; N],
    sense: [i64; N],
    sign: impl Fn([[i64; N]; N]) -> Ordering,
) -> Ordering {
    let first = sign(rows);
    if first != Ordering::Equal {
        return first;
    }
    let mut by_order: [usize; N] = std::array::from_fn(|k| k);
    by_order.sort_unstable_by_key(|k| order[*k]);
    for k in by_order {
        // A determinant is linear in each row, so this is the coefficient of that row's constant.
        let mut moved = rows;
        moved[k] = [sense[k]; N];
        let sign = sign(moved);
        if sign != Ordering::Equal {
            return sign;
        }
    }
    Ordering::Equal
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::big_int::BigInt;

    /// Entries are below 2 to this power.
    const ENTRY_BITS: u32 = 53;

    fn random(state: &mut u64) -> u64 {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        *state
    }

    /// By Laplace expansion on integers of any size.
    fn determinant(rows: &[Vec<i64>]) -> BigInt {
        if rows.len() == 1 {
            return BigInt::from_f64(rows[0][0] as f64);
        }
        let mut sum = BigInt::from_f64(0.0);
        for k in 0..rows.len() {
            let minor: Vec<Vec<i64>> = rows[1..]
                .iter()
                .map(|row| row.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, x)| *x).collect())
                .collect();
            let term = &BigInt::from_f64(rows[0][k] as f64) * &determinant(&minor);
            sum = if k % 2 == 0 { &sum - &-term } else { &sum - &term };
        }
        sum
    }

    fn expected<const N: usize>(rows: &[[i64; N]; N]) -> Ordering {
        determinant(&rows.iter().map(|row| row.to_vec()).collect::<Vec<_>>()).sign()
    }

    /// Rows of which the last depends on the others, nearly or exactly.
    fn nearly_singular<const N: usize>(state: &mut u64) -> [[i64; N]; N] {
        let bits = 1 + random(state) % u64::from(ENTRY_BITS - 4);
        let mut rows = [[0_i64; N]; N];
        for row in rows.iter_mut().take(N - 1) {
            for x in row.iter_mut() {
                *x = (random(state) % (1 << bits)) as i64 - (1 << bits >> 1);
            }
        }
        let factors: [i64; N] = std::array::from_fn(|_| (random(state) % 5) as i64 - 2);
        rows[N - 1] = std::array::from_fn(|k| (0..N - 1).map(|i| factors[i] * rows[i][k]).sum());
        let shift = random(state) % 3;
        if shift > 0 {
            rows[N - 1][(random(state) % N as u64) as usize] += shift as i64 * 2 - 3;
        }
        rows
    }

    #[test]
    fn signs_are_those_of_integers_of_any_size() {
        let mut state = 17;
        let mut n_zero = 0;
        for _ in 0..20_000 {
            let rows = nearly_singular::<2>(&mut state);
            assert_eq!(sign2(rows), expected(&rows), "{rows:?}");
            let rows = nearly_singular::<3>(&mut state);
            assert_eq!(sign3(rows), expected(&rows), "{rows:?}");
            let rows = nearly_singular::<4>(&mut state);
            assert_eq!(sign4(rows), expected(&rows), "{rows:?}");
            n_zero += u32::from(sign4(rows) == Ordering::Equal);
        }
        assert!(n_zero > 1000, "exact zeros were among them");
        let largest = (1 << ENTRY_BITS) - 1;
        let largest = [
            [largest, largest, largest, -largest],
            [largest, largest, -largest, largest],
            [largest, -largest, largest, largest],
            [-largest, largest, largest, largest],
        ];
        assert_eq!(sign4(largest), expected(&largest));
    }

    #[test]
    fn small_determinants_all_agree() {
        let entry = |code: usize, k: u32| (code / 3_usize.pow(k) % 3) as i64 - 1;
        for code in 0..3_usize.pow(9) {
            let rows: [[i64; 3]; 3] =
                std::array::from_fn(|i| std::array::from_fn(|j| entry(code, (3 * i + j) as u32)));
            assert_eq!(sign3(rows), expected(&rows));
        }
    }

    #[test]
    fn a_perturbation_is_that_of_small_numbers() {
        let mut state = 5;
        for _ in 0..20_000 {
            let rows: [[i64; 3]; 3] =
                [[0; 3]; 3].map(|row| row.map(|_: i64| (random(&mut state) % 5) as i64 - 2));
            let sense: [i64; 3] = [0; 3].map(|_| if random(&mut state).is_multiple_of(2) { 1 } else { -1 });
            let mut order = [3, 7, 8];
            order.rotate_left((random(&mut state) % 3) as usize);
            let scaled: [[i64; 3]; 3] = std::array::from_fn(|k| {
                let rank = [3, 7, 8].iter().position(|x| *x == order[k]).expect("it is one of them");
                // 2⁻¹², 2⁻²⁴ and 2⁻³⁶ of the entries' unit, which is more than all minors of the later ones.
                rows[k].map(|x| (x << 36) + sense[k] * (1 << (24 - 12 * rank)))
            });
            assert_eq!(
                perturbed_sign(rows, order, sense, sign3),
                expected(&scaled),
                "{rows:?} {order:?} {sense:?}"
            );
        }
    }

    #[test]
    fn meeting_points_are_where_functions_vanish() {
        let mut state = 11;
        for _ in 0..10_000 {
            let rows: [[i64; 4]; 3] =
                [[0; 4]; 3].map(|row| row.map(|_: i64| (random(&mut state) % (1 << 20)) as i64 - (1 << 19)));
            let Some(at) = common_zero4(rows) else { continue };
            let size: f64 = at.iter().map(|w| w.abs()).sum();
            for row in rows {
                let value: f64 = row.iter().zip(at).map(|(x, w)| *x as f64 * w).sum();
                assert!(value.abs() <= 1e-8 * size, "{value}");
            }
            let Some(at) = common_zero3([0, 1].map(|k| [rows[k][0], rows[k][1], rows[k][2]])) else {
                continue;
            };
            let size: f64 = at.iter().map(|w| w.abs()).sum();
            for row in &rows[..2] {
                let value: f64 = row.iter().zip(at).map(|(x, w)| *x as f64 * w).sum();
                assert!(value.abs() <= 1e-8 * size, "{value}");
            }
        }
    }
}
