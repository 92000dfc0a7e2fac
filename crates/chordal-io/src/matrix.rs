//! Matrices of nodes, column-major, and the functions that build them.

/// The identity matrix.
pub(crate) const IDENTITY: [f64; 16] =
    [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// `a · b`. If one is the identity, the result is exactly the other, also for −0.
pub(crate) fn product(a: &[f64; 16], b: &[f64; 16]) -> [f64; 16] {
    if *a == IDENTITY {
        return *b;
    }
    if *b == IDENTITY {
        return *a;
    }
    std::array::from_fn(|i| {
        let (column, row) = (i / 4, i % 4);
        let term = |k: usize| a[4 * k + row] * b[4 * column + k];
        (term(0) + term(1)) + (term(2) + term(3))
    })
}

/// Degrees in a quarter of a turn.
const QUARTER: f64 = 90.0;

/// Sine and cosine of an angle in degrees, exact for quarters of a turn.
pub(crate) fn sine_cosine(degrees: f64) -> [f64; 2] {
    // `%` is exact.
    let turned = degrees % 360.0;
    let quarters = turned / QUARTER;
    if quarters != quarters.trunc() {
        let radians = turned.to_radians();
        return [libm::sin(radians), libm::cos(radians)];
    }
    match (quarters as i32).rem_euclid(4) {
        0 => [0.0, 1.0],
        1 => [1.0, 0.0],
        2 => [0.0, -1.0],
        _ => [-1.0, 0.0],
    }
}

/// The cross product.
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarters_of_a_turn_are_exact_and_all_else_is_near() {
        for turns in [-720.0, -360.0, 0.0, 360.0, 3600.0] {
            let quarters = [0.0, 90.0, 180.0, 270.0, -90.0].map(|degrees| sine_cosine(turns + degrees));
            assert_eq!(quarters, [[0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [-1.0, 0.0], [-1.0, 0.0]]);
        }
        for degrees in [-1e-20, 1e-20, 30.0, -45.0, 89.999, 1e6 + 0.5] {
            let [s, c] = sine_cosine(degrees);
            let truth = f64::to_radians(degrees % 360.0);
            assert!((s - truth.sin()).abs() < 1e-15 && (c - truth.cos()).abs() < 1e-15, "{degrees}");
        }
        assert!(sine_cosine(-1e-20)[0] < 0.0);
    }
}
