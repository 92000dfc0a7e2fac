//! Parallel execution of two closures or of all chunks of a slice; the results do not depend on the number of
//! threads.
use crate::budget::{Job, par_map};

/// Runs both, in parallel with the feature `threads`.
#[cfg(feature = "threads")]
pub(super) fn both<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    rayon::join(a, b)
}

/// Runs both, one after the other.
#[cfg(not(feature = "threads"))]
pub(super) fn both<A, B>(a: impl FnOnce() -> A, b: impl FnOnce() -> B) -> (A, B) {
    (a(), b())
}

/// Applies `f` to every chunk of `size` items and the index of its first item; results are in the order of
/// the chunks. For linear-time counts that hold no memory and need no cancellation. The threads are those of
/// the job in whose [`Job::run`] the caller is, or the host's.
pub(super) fn over_chunks<T: Sync, R: Send>(
    items: &[T],
    size: usize,
    f: impl Fn(usize, &[T]) -> R + Sync,
) -> Vec<R> {
    let chunks: Vec<&[T]> = items.chunks(size).collect();
    par_map(&Job::default(), &chunks, |number, chunk| f(number * size, chunk))
}
