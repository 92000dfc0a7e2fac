//! Rows of grids: loops without branches over what lies in a row in memory. The cubic B-spline's rules are taken along columns and
//! then along rows, which is the same surface for a quarter of the sums.
use super::values::Real;

/// The shares of a point itself and of each of its two neighbours along a line.
pub(super) type Weights<T> = [T; 2];

/// The middles between two rows.
#[inline(always)]
pub(super) fn middles<T: Real, const K: usize>(a: &[[T; K]], b: &[[T; K]], out: &mut [[T; K]]) {
    let half = T::of(0.5);
    let (a, b) = (a.as_flattened(), b.as_flattened());
    for ((out, a), b) in out.as_flattened_mut().iter_mut().zip(a).zip(b) {
        *out = half * (*a + *b);
    }
}

/// A row between two others, after a round.
#[inline(always)]
pub(super) fn between<T: Real, const K: usize>(
    [own, side]: Weights<T>,
    row: &[[T; K]],
    others: [&[[T; K]]; 2],
    out: &mut [[T; K]],
) {
    let (row, a, b) = (row.as_flattened(), others[0].as_flattened(), others[1].as_flattened());
    for (((out, row), a), b) in out.as_flattened_mut().iter_mut().zip(row).zip(a).zip(b) {
        *out = own * *row + side * (*a + *b);
    }
}

/// What is between the ends of a row after a round: a middle first.
#[inline(always)]
pub(super) fn spread<T: Real, const K: usize>([own, side]: Weights<T>, row: &[[T; K]], out: &mut [[T; K]]) {
    let half = T::of(0.5);
    let mid = |a: &[T; K], b: &[T; K]| -> [T; K] { std::array::from_fn(|k| half * (a[k] + b[k])) };
    let Some((first, out)) = out.split_first_mut() else { return };
    *first = mid(&row[0], &row[1]);
    for (out, row) in out.chunks_exact_mut(2).zip(row.windows(3)) {
        out[0] = std::array::from_fn(|k| own * row[1][k] + side * (row[0][k] + row[2][k]));
        out[1] = mid(&row[1], &row[2]);
    }
}

/// The borders of a grid, from its first point to its last: row 0, the last column, the last row, column 0.
pub(super) struct Borders<T, const K: usize>(pub [Vec<[T; K]>; 4]);

/// The points inside of a grid after a round, row by row, from those before and its borders before.
#[inline(always)]
pub(super) fn divide<T: Real, const K: usize>(
    weights: Weights<T>,
    Borders([low, right, high, left]): &Borders<T, K>,
    inside: &[[T; K]],
    (line, out): (&mut [[T; K]], &mut [[T; K]]),
) {
    let n = left.len() - 1;
    let wide = 2 * n - 1;
    let (inner, line) = (n - 1, &mut line[..n + 1]);
    // A row without its ends.
    let row = |r: usize| match r {
        0 => &low[1..n],
        _ if r == n => &high[1..n],
        _ => &inside[(r - 1) * inner..][..inner],
    };
    for (y, out) in out.chunks_exact_mut(wide).enumerate() {
        let r = y / 2;
        if y % 2 == 0 {
            middles(row(r), row(r + 1), &mut line[1..n]);
            middles(&left[r..=r], &left[r + 1..=r + 1], &mut line[..1]);
            middles(&right[r..=r], &right[r + 1..=r + 1], &mut line[n..]);
        } else {
            between(weights, row(r + 1), [row(r), row(r + 2)], &mut line[1..n]);
            between(weights, &left[r + 1..=r + 1], [&left[r..=r], &left[r + 2..]], &mut line[..1]);
            between(weights, &right[r + 1..=r + 1], [&right[r..=r], &right[r + 2..]], &mut line[n..]);
        }
        spread(weights, line, out);
    }
}
