//! `BernsteinRow`: a polynomial of any degree in Bernstein form, with vectors as coefficients.
/// The coefficients of a polynomial over `[0, 1]`, one more than its degree.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BernsteinRow<const N: usize>(pub Vec<[f64; N]>);

impl<const N: usize> BernsteinRow<N> {
    /// The value and the first two derivatives at `t`; at 0 and 1 the value is an end coefficient.
    pub fn jet(&self, t: f64) -> [[f64; N]; 3] {
        let degree = self.0.len() - 1;
        let (mut first, mut second) = ([0.0; N], [0.0; N]);
        let value = with_copy(&self.0, |row| {
            for n in (1..=degree).rev() {
                // `row` has the n + 1 coefficients of a polynomial of degree n.
                if n == 2 {
                    let scale = (degree * (degree - 1)) as f64;
                    second =
                        std::array::from_fn(|k| scale * ((row[2][k] - row[1][k]) - (row[1][k] - row[0][k])));
                }
                if n == 1 {
                    first = std::array::from_fn(|k| degree as f64 * (row[1][k] - row[0][k]));
                }
                step(&mut row[..=n], t);
            }
            row[0]
        });
        [value, first, second]
    }

    /// The value at `t`.
    pub fn at(&self, t: f64) -> [f64; N] {
        with_copy(&self.0, |row| to_value(row, t))
    }

    /// The coefficients over the part from `a` to `b`, which lie in `[0, 1]`.
    pub fn part(&self, a: f64, b: f64) -> Self {
        let mut part = self.0.clone();
        with_copy(&self.0, |scratch| part_of(&mut part, scratch, [a, b]));
        Self(part)
    }
}

/// Turns coefficients into those over the part from `a` to `b`; `scratch` must have the same length.
#[inline(always)]
fn part_of<const N: usize>(row: &mut [[f64; N]], scratch: &mut [[f64; N]], [a, b]: [f64; 2]) {
    // The blossom with some arguments `a` and the others `b`: after n − k steps at a, the remaining ones at
    // b, from the right end on.
    let degree = row.len() - 1;
    for k in (0..=degree).rev() {
        let copy = &mut scratch[..=k];
        copy.copy_from_slice(&row[..=k]);
        let value = to_value(copy, b);
        if k > 0 {
            step(&mut row[..=k], a);
        }
        row[k] = value;
    }
}

/// The value at `t` of coefficients, which are overwritten.
#[inline(always)]
fn to_value<const N: usize>(row: &mut [[f64; N]], t: f64) -> [f64; N] {
    for n in (1..row.len()).rev() {
        step(&mut row[..=n], t);
    }
    row[0]
}

/// Rows up to this length are copied without an allocation. Chosen: of degree 7, higher than files have.
const SHORT: usize = 8;

/// Runs `run` with a copy of a row.
#[inline(always)]
fn with_copy<const N: usize, R>(row: &[[f64; N]], run: impl FnOnce(&mut [[f64; N]]) -> R) -> R {
    if row.len() > SHORT {
        return run(&mut row.to_vec());
    }
    let mut copy = [[0.0; N]; SHORT];
    copy[..row.len()].copy_from_slice(row);
    run(&mut copy[..row.len()])
}

/// One step of de Casteljau's algorithm: one coefficient fewer.
#[inline(always)]
fn step<const N: usize>(row: &mut [[f64; N]], t: f64) {
    // Like `lerp`, in loops that every optimization level unrolls.
    let s = 1.0 - t;
    for i in 0..row.len() - 1 {
        let next = row[i + 1];
        for (x, y) in row[i].iter_mut().zip(next) {
            *x = s * *x + t * y;
        }
    }
}

/// The binomial coefficients `n` over 0 to `n`.
pub(crate) fn binomials(n: usize) -> Vec<f64> {
    let mut row = vec![1.0];
    for k in 0..n {
        row.push(row[k] * (n - k) as f64 / (k + 1) as f64);
    }
    row
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_derivatives_are_those_of_the_polynomial() {
        // t³ − 2t² + 3t − 1, by its coefficients in Bernstein form.
        let at = |t: f64| t * t * t - 2.0 * t * t + 3.0 * t - 1.0;
        let row = BernsteinRow(vec![[-1.0], [0.0], [1.0 / 3.0], [1.0]]);
        for t in [0.0, 0.3, 1.0] {
            let [value, first, second] = row.jet(t);
            assert!((value[0] - at(t)).abs() < 1e-15 && row.at(t) == value);
            assert!((first[0] - (3.0 * t * t - 4.0 * t + 3.0)).abs() < 1e-14);
            assert!((second[0] - (6.0 * t - 4.0)).abs() < 1e-14);
        }
        let part = row.part(0.25, 0.75);
        for t in [0.0, 0.4, 1.0] {
            assert!((part.at(t)[0] - at(0.25 + 0.5 * t)).abs() < 1e-15);
        }
        assert_eq!(row.part(0.0, 1.0), row);
        assert_eq!(binomials(5), [1.0, 5.0, 10.0, 10.0, 5.0, 1.0]);
    }
}
