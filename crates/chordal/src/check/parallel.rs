//! Parallel execution of two closures or of all chunks of a slice; the results do not depend on the number of
//! threads.
#[cfg(feature = "threads")]
use crate::budget::has_threads;
use crate::budget::{Job, par_map};

/// For fewer triangles than this, waking another thread takes longer than the work. Derived: at 55 ns each
/// ([`super::validity`]) they take a fifth of a millisecond; to wake a thread and to wait for it took a fifth
/// of that, measured on a scene of 30,000 parts, most of whose time it was.
#[cfg(feature = "threads")]
const WORTH_A_THREAD: usize = 4096;

/// Runs both; in parallel with the feature `threads` if there are many triangles.
#[cfg(feature = "threads")]
pub(super) fn both<A: Send, B: Send>(
    n_triangles: usize,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    if n_triangles < WORTH_A_THREAD || !has_threads() { (a(), b()) } else { rayon::join(a, b) }
}

/// Runs both, one after the other.
#[cfg(not(feature = "threads"))]
pub(super) fn both<A, B>(_n_triangles: usize, a: impl FnOnce() -> A, b: impl FnOnce() -> B) -> (A, B) {
    (a(), b())
}

/// Applies `f` to every chunk of `size` items and the index of its first item; results are in the order of
/// the chunks. For linear-time counts that hold no memory and need no cancellation. The threads are those of
/// the job whose [`Job::run`] contains the call, or the host's.
pub(super) fn over_chunks<T: Sync, R: Send>(
    items: &[T],
    size: usize,
    f: impl Fn(usize, &[T]) -> R + Sync,
) -> Vec<R> {
    let chunks: Vec<&[T]> = items.chunks(size).collect();
    par_map(&Job::default(), &chunks, |number, chunk| f(number * size, chunk))
}
