//! The threads that a verb works on, and how many there are.

/// Runs a verb on the machine's threads, which the library starts when it needs them.
#[cfg(not(all(target_family = "wasm", feature = "threads")))]
pub fn run_verb<R>(work: impl FnOnce() -> R) -> R {
    work()
}

/// Runs a verb on this thread and on those that the page has ready, `RAYON_NUM_THREADS` in all, and lets them end
/// with it, so that the page has them for the next one.
///
/// This thread works too. So nothing waits for a thread of which the page is still loading the program, and a verb
/// runs where there is none.
#[cfg(all(target_family = "wasm", feature = "threads"))]
pub fn run_verb<R>(work: impl FnOnce() -> R) -> R {
    /// Twice what Rust gives a thread elsewhere: a module has no guard below a stack, which nothing may overflow.
    const STACK_BYTES: usize = 4 << 20;
    // If the page grants fewer, the library works with this thread alone.
    let pool = rayon::ThreadPoolBuilder::new().use_current_thread().stack_size(STACK_BYTES).build();
    let result = work();
    drop(pool);
    result
}

/// The number of threads of a job that names none.
#[cfg(not(all(target_family = "wasm", feature = "threads")))]
pub fn available() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// The number of threads of a job that names none.
#[cfg(all(target_family = "wasm", feature = "threads"))]
pub fn available() -> usize {
    rayon::current_num_threads()
}
