//! `BernsteinRow`: a polynomial of any degree in Bernstein form, with vectors as coefficients.
use crate::explicit::bezier::lerp;

/// The coefficients of a polynomial over `[0, 1]`, one more than its degree.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BernsteinRow<const N: usize>(pub Vec<[f64; N]>);

impl<const N: usize> BernsteinRow<N> {
    /// The value and the first two derivatives at `t`; at 0 and 1 the value is an end coefficient.
    pub fn jet(&self, t: f64) -> [[f64; N]; 3] {
        let degree = self.0.len() - 1;
        let mut left = self.0.clone();
        let (mut first, mut second) = ([0.0; N], [0.0; N]);
        for n in (1..=degree).rev() {
            // `left` has the n + 1 coefficients of a polynomial of degree n.
            if n == 2 {
                let scale = (degree * (degree - 1)) as f64;
                second =
                    std::array::from_fn(|k| scale * ((left[2][k] - left[1][k]) - (left[1][k] - left[0][k])));
            }
            if n == 1 {
                first = std::array::from_fn(|k| degree as f64 * (left[1][k] - left[0][k]));
            }
            step(&mut left[..=n], t);
        }
        [left[0], first, second]
    }

    /// The value at `t`.
    pub fn at(&self, t: f64) -> [f64; N] {
        let mut left = self.0.clone();
        for n in (1..left.len()).rev() {
            step(&mut left[..=n], t);
        }
        left[0]
    }

    /// The coefficients over the part from `a` to `b`, which lie in `[0, 1]`.
    pub fn part(&self, a: f64, b: f64) -> Self {
        let degree = self.0.len() - 1;
        // The blossom with some arguments `a` and the others `b`: after k steps at b, from the left end on at a.
        let mut with_b = self.0.clone();
        let mut made = Vec::with_capacity(degree + 1);
        for k in 0..=degree {
            let mut rest = with_b[..=degree - k].to_vec();
            for n in (1..rest.len()).rev() {
                step(&mut rest[..=n], a);
            }
            made.push(rest[0]);
            if k < degree {
                step(&mut with_b[..=degree - k], b);
            }
        }
        Self(made)
    }
}

/// One step of de Casteljau's algorithm: one coefficient fewer.
fn step<const N: usize>(row: &mut [[f64; N]], t: f64) {
    for i in 0..row.len() - 1 {
        row[i] = lerp(row[i], row[i + 1], t);
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
