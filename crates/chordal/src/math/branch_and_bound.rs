//! `branch_and_bound`: the largest bound over the pieces of a shape; the piece with the largest bound is
//! divided repeatedly. `PriorityItem`: such a piece in a queue.
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The largest bound over pieces that together form the shape: the piece with the largest bound is divided
/// repeatedly, until it is settled or `most_pieces` pieces have been divided.
///
/// `is_settled` receives the worst piece and the number of pieces divided so far. `divide` pushes the parts
/// of a piece; if it pushes none, the piece is dropped. 0 if no piece remains.
///
/// # Errors
/// The errors of `divide`.
pub(crate) fn branch_and_bound<T, E>(
    mut open: BinaryHeap<PriorityItem<T>>,
    most_pieces: usize,
    mut is_settled: impl FnMut(&PriorityItem<T>, usize) -> bool,
    mut divide: impl FnMut(T, &mut BinaryHeap<PriorityItem<T>>) -> Result<(), E>,
) -> Result<f64, E> {
    // The piece on top has the largest bound, which therefore holds for all pieces together: the
    // loop may stop before any division and still return a valid bound.
    for n_divided in 0..most_pieces {
        let Some(worst) = open.pop() else { return Ok(0.0) };
        if is_settled(&worst, n_divided) {
            return Ok(worst.bound);
        }
        divide(worst.item, &mut open)?;
    }
    Ok(open.pop().map_or(0.0, |worst| worst.bound))
}

/// An item that is ordered by its bound alone.
pub(crate) struct PriorityItem<T> {
    pub bound: f64,
    pub item: T,
}

impl<T> PartialEq for PriorityItem<T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<T> Eq for PriorityItem<T> {}

impl<T> PartialOrd for PriorityItem<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> Ord for PriorityItem<T> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An interval of `x·(1 − x)`, bounded by its ends and its width.
    fn interval(low: f64, high: f64) -> PriorityItem<[f64; 2]> {
        let value = |x: f64| x * (1.0 - x);
        PriorityItem { bound: value(low).max(value(high)) + 0.5 * (high - low), item: [low, high] }
    }

    fn largest(most_pieces: usize) -> f64 {
        let is_settled = |worst: &PriorityItem<[f64; 2]>, _| worst.item[1] - worst.item[0] < 1e-6;
        let divide = |[low, high]: [f64; 2], open: &mut BinaryHeap<_>| {
            let middle = low.midpoint(high);
            open.extend([interval(low, middle), interval(middle, high)]);
            Ok::<_, ()>(())
        };
        branch_and_bound(BinaryHeap::from([interval(0.0, 0.9)]), most_pieces, is_settled, divide).unwrap()
    }

    #[test]
    fn the_bound_never_falls_below_the_largest_value_and_reaches_it() {
        let bounds = [0, 1, 2, 10, 100, 100_000].map(largest);
        assert!(bounds.windows(2).all(|pair| pair[1] <= pair[0]), "{bounds:?}");
        assert!(bounds.iter().all(|bound| *bound >= 0.25));
        assert!(bounds[5] < 0.250_001);
    }

    #[test]
    fn without_pieces_the_bound_is_zero() {
        let no_pieces = BinaryHeap::<PriorityItem<()>>::new();
        assert_eq!(branch_and_bound(no_pieces, 5, |_, _| false, |(), _| Err(())), Ok(0.0));
    }
}
