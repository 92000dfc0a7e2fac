//! Two things at once, and all chunks of a slice at once, where the host has threads: the results are the same.
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

/// `f` of every chunk of `size` items with the number of its first item, in the order of the chunks. For counts in
/// linear time that hold nothing and are not worth a cancel. The threads are those of the job in whose [`Job::run`] the
/// caller stands, or the host's.
pub(super) fn over_chunks<T: Sync, R: Send>(
    items: &[T],
    size: usize,
    f: impl Fn(usize, &[T]) -> R + Sync,
) -> Vec<R> {
    let chunks: Vec<&[T]> = items.chunks(size).collect();
    par_map(&Job::default(), &chunks, |number, chunk| f(number * size, chunk))
}
