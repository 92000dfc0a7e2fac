//! Two things at once where the host has threads, one after the other where not: the results are the same.

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

/// `f` of every chunk of `size` items with the number of its first item, in the order of the chunks.
#[cfg(feature = "threads")]
pub(super) fn over_chunks<T: Sync, R: Send>(
    items: &[T],
    size: usize,
    f: impl Fn(usize, &[T]) -> R + Sync,
) -> Vec<R> {
    use rayon::prelude::*;
    items.par_chunks(size).enumerate().map(|(i, chunk)| f(i * size, chunk)).collect()
}

/// `f` of every chunk of `size` items with the number of its first item, in the order of the chunks.
#[cfg(not(feature = "threads"))]
pub(super) fn over_chunks<T, R>(items: &[T], size: usize, f: impl Fn(usize, &[T]) -> R) -> Vec<R> {
    items.chunks(size).enumerate().map(|(i, chunk)| f(i * size, chunk)).collect()
}
