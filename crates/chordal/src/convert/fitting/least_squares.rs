//! Small systems of linear equations, as in least squares problems.

/// The solution of `matrix · x = right` for several right sides, by elimination with partial pivoting; `None` if the
/// matrix is numerically singular.
pub(super) fn solve<const N: usize, const M: usize>(
    mut matrix: [[f64; N]; N],
    mut right: [[f64; M]; N],
) -> Option<[[f64; M]; N]> {
    for column in 0..N {
        let pivot = (column..N).reduce(|best, row| {
            if matrix[row][column].abs() > matrix[best][column].abs() { row } else { best }
        })?;
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        let divisor = matrix[column][column];
        // Written so that NaN is refused, too.
        if !(divisor.abs() > 0.0 && divisor.is_finite()) {
            return None;
        }
        for row in column + 1..N {
            let factor = matrix[row][column] / divisor;
            let (upper, lower) = matrix.split_at_mut(row);
            for (x, above) in lower[0].iter_mut().zip(&upper[column]).skip(column) {
                *x -= factor * above;
            }
            let (upper, lower) = right.split_at_mut(row);
            for (x, above) in lower[0].iter_mut().zip(&upper[column]) {
                *x -= factor * above;
            }
        }
    }
    for row in (0..N).rev() {
        let (solved, later) = right.split_at_mut(row + 1);
        for (k, x) in solved[row].iter_mut().enumerate() {
            let sum_of_known =
                later.iter().zip(&matrix[row][row + 1..]).fold(0.0, |sum, (y, factor)| sum + factor * y[k]);
            *x = (*x - sum_of_known) / matrix[row][row];
        }
    }
    right.as_flattened().iter().all(|x| x.is_finite()).then_some(right)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_are_solved_and_singular_ones_are_not() {
        // x + y + z = 6, y = 2, 2x + z = 5 and the same times 10.
        let matrix = [[1.0, 1.0, 1.0], [0.0, 1.0, 0.0], [2.0, 0.0, 1.0]];
        let solved = solve(matrix, [[6.0, 60.0], [2.0, 20.0], [5.0, 50.0]]);
        assert_eq!(solved, Some([[1.0, 10.0], [2.0, 20.0], [3.0, 30.0]]));
        assert_eq!(solve([[1.0, 2.0], [2.0, 4.0]], [[1.0], [2.0]]), None);
    }
}
