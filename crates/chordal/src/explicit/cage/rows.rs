//! Rows of grids: loops without branches over contiguous memory. The rules of the cubic B-spline are applied
//! along columns and then along rows, which gives the same surface for a quarter of the sums.
use super::values::{Real, mid};

/// The weights of a point itself and of each of its two neighbours along a line.
pub(super) type LineStencil<T> = [T; 2];

/// The midpoints between two rows.
#[inline(always)]
pub(super) fn middles<T: Real, const K: usize>(a: &[[T; K]], b: &[[T; K]], out: &mut [[T; K]]) {
    let half = T::from_f64(0.5);
    let (a, b) = (a.as_flattened(), b.as_flattened());
    for ((out, a), b) in out.as_flattened_mut().iter_mut().zip(a).zip(b) {
        *out = half * (*a + *b);
    }
}

/// A row after a round, from itself and its two neighbours.
#[inline(always)]
pub(super) fn between<T: Real, const K: usize>(
    [centre, side]: LineStencil<T>,
    row: &[[T; K]],
    others: [&[[T; K]]; 2],
    out: &mut [[T; K]],
) {
    let (row, a, b) = (row.as_flattened(), others[0].as_flattened(), others[1].as_flattened());
    for (((out, row), a), b) in out.as_flattened_mut().iter_mut().zip(row).zip(a).zip(b) {
        *out = centre * *row + side * (*a + *b);
    }
}

/// The points between the ends of a row after a round, a midpoint first.
#[inline(always)]
pub(super) fn spread<T: Real, const K: usize>(weights: LineStencil<T>, row: &[[T; K]], out: &mut [[T; K]]) {
    let Some((first, out)) = out.split_first_mut() else { return };
    *first = mid(row[0], row[1]);
    for (out, row) in out.chunks_exact_mut(2).zip(row.windows(3)) {
        out[0] = moved(weights, row[1], [row[0], row[2]]);
        out[1] = mid(row[1], row[2]);
    }
}

/// A point after a round, from itself and its two neighbours.
#[inline(always)]
pub(super) fn moved<T: Real, const K: usize>(
    [centre, side]: LineStencil<T>,
    p: [T; K],
    [a, b]: [[T; K]; 2],
) -> [T; K] {
    std::array::from_fn(|k| centre * p[k] + side * (a[k] + b[k]))
}

/// The borders of a grid without its corners: row 0, the last column, the last row, column 0; and the corners
/// in the same order.
pub(super) struct GridBorders<'a, T, const K: usize> {
    pub sides: [&'a [[T; K]]; 4],
    pub corners: [[T; K]; 4],
}

/// The points inside a grid after a round, row by row, from the points inside and the borders before the
/// round.
#[inline(always)]
pub(super) fn divide<T: Real, const K: usize>(
    weights: LineStencil<T>,
    borders: &GridBorders<T, K>,
    inside: &[[T; K]],
    (line, out): (&mut [[T; K]], &mut [[T; K]]),
) {
    let [low, right, high, left] = borders.sides;
    let inner = low.len();
    let (n, wide) = (inner + 1, 2 * inner + 1);
    let line = &mut line[..n + 1];
    let row = |r: usize| match r {
        0 => low,
        _ if r == n => high,
        _ => &inside[(r - 1) * inner..][..inner],
    };
    let at = |column: &[[T; K]], ends: [usize; 2], r: usize| match r {
        0 => borders.corners[ends[0]],
        _ if r == n => borders.corners[ends[1]],
        _ => column[r - 1],
    };
    let (first, last) = (|r| at(left, [0, 3], r), |r| at(right, [1, 2], r));
    for (y, out) in out.chunks_exact_mut(wide).enumerate() {
        // Even rows of the result lie between two old rows, odd ones on an old row: the border is
        // not part of the result, so the first one is between.
        let r = y / 2;
        if y % 2 == 0 {
            line[0] = mid(first(r), first(r + 1));
            middles(row(r), row(r + 1), &mut line[1..n]);
            line[n] = mid(last(r), last(r + 1));
        } else {
            line[0] = moved(weights, first(r + 1), [first(r), first(r + 2)]);
            between(weights, row(r + 1), [row(r), row(r + 2)], &mut line[1..n]);
            line[n] = moved(weights, last(r + 1), [last(r), last(r + 2)]);
        }
        spread(weights, line, out);
    }
}
