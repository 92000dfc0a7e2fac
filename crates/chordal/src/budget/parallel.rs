//! Parallel work on the threads of a [`Job`]: order and results are those of one thread.
use super::Job;
use std::sync::{Mutex, PoisonError};

/// `f(0, &items[0]), f(1, &items[1]), …` in order, on as many threads as the job allows.
///
/// The result is the same on any number of threads as long as `f` depends on its arguments alone. Without the
/// feature `threads`, or if the machine grants no thread, the caller's thread does all the work. A cancelled
/// job still runs `f` for every item: an `f` that takes long checks [`Job::is_cancelled`] and returns early.
///
/// Cost: one task for every few items; threads are started once per process and number of threads.
///
/// ```
/// use chordal::budget::{Job, par_map};
/// let squares = par_map(&Job::default().with_threads(3), &[1, 2, 3], |i, x| i as i32 + x * x);
/// assert_eq!(squares, [1, 5, 11]);
/// ```
pub fn par_map<T: Sync, R: Send>(job: &Job, items: &[T], f: impl Fn(usize, &T) -> R + Sync) -> Vec<R> {
    if !is_shared(job, items.len()) {
        return items.iter().enumerate().map(|(i, item)| f(i, item)).collect();
    }
    // Parts of neighbouring items: joined in order, they are in the order of the items whichever
    // thread ends first.
    let size = items.len().div_ceil(MOST_TASKS);
    let parts: Vec<Mutex<Vec<R>>> = items.chunks(size).map(|_| Mutex::default()).collect();
    for_each(job, parts.len(), &|k| {
        let first = k * size;
        let end = if items.len() - first < size { items.len() } else { first + size };
        let results = items[first..end].iter().enumerate().map(|(i, item)| f(first + i, item)).collect();
        *parts[k].lock().unwrap_or_else(PoisonError::into_inner) = results;
    });
    let mut results = Vec::with_capacity(items.len());
    for part in parts {
        results.append(&mut part.into_inner().unwrap_or_else(PoisonError::into_inner));
    }
    results
}

/// [`par_map`] over items that `f` consumes: for the few large parts into which a recursion splits its input.
pub(crate) fn par_map_owned<T: Send, R: Send>(job: &Job, items: Vec<T>, f: impl Fn(T) -> R + Sync) -> Vec<R> {
    if !is_shared(job, items.len()) {
        return items.into_iter().map(f).collect();
    }
    let slots: Vec<Mutex<(Option<T>, Option<R>)>> =
        items.into_iter().map(|item| Mutex::new((Some(item), None))).collect();
    for_each(job, slots.len(), &|k| {
        let lock = || slots[k].lock().unwrap_or_else(PoisonError::into_inner);
        let item = lock().0.take();
        let result = item.map(&f);
        lock().1 = result;
    });
    slots.into_iter().filter_map(|slot| slot.into_inner().unwrap_or_else(PoisonError::into_inner).1).collect()
}

/// The largest number of tasks of one call: enough that the threads end at nearly the same time.
const MOST_TASKS: usize = 256;

/// Whether `n` items are spread over more than one thread.
fn is_shared(job: &Job, n: usize) -> bool {
    cfg!(feature = "threads") && job.threads != 1 && n > 1
}

/// `task(0), …, task(n - 1)` on the threads of a job, in any order.
///
/// All that [`par_map`] does with rayon is behind this non-generic function: compiled for each of the hundred
/// closures of this crate, rayon's own code was half of the crate's functions and a third of its code.
fn for_each(job: &Job, n: usize, task: &(dyn Fn(usize) + Sync)) {
    #[cfg(feature = "threads")]
    job.enter(&mut || {
        use rayon::prelude::*;
        if has_threads() {
            (0..n).into_par_iter().for_each(task);
        } else {
            (0..n).for_each(task);
        }
    });
    #[cfg(not(feature = "threads"))]
    {
        let _ = job;
        (0..n).for_each(task);
    }
}

impl Job {
    /// Runs `work` with one set of threads that every [`par_map`] of the same number of threads shares: use
    /// it around many small steps.
    pub fn run<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        let (mut work, mut result) = (Some(work), None);
        self.enter(&mut || result = work.take().map(|work| work()));
        result.expect("the work was done")
    }

    /// [`Job::run`] for work that is called once and keeps its own result.
    fn enter(&self, work: &mut (dyn FnMut() + Send)) {
        #[cfg(all(feature = "threads", target_family = "wasm"))]
        be_a_pool();
        #[cfg(feature = "threads")]
        {
            // Without a number of threads the host's own pool is right; inside a pool of this size nothing
            // has to be done. No result depends on it: `par_map` keeps the order.
            let fits =
                rayon::current_thread_index().is_some() && rayon::current_num_threads() == self.threads;
            if self.threads != 0 && !fits {
                // If the machine grants no more threads, the work runs on the current ones.
                if let Some(pool) = thread_pool(self.threads) {
                    return pool.install(work);
                }
            }
        }
        work();
    }
}

/// Whether the caller runs on a pool's threads, or the host's pool has any: if the machine grants none, rayon
/// panics at the first use of that pool.
#[cfg(all(feature = "threads", not(target_family = "wasm")))]
fn has_threads() -> bool {
    use std::{error::Error, sync::OnceLock};
    static HOST: OnceLock<bool> = OnceLock::new();
    // No result depends on it: `par_map` keeps the order. Of the errors of `build_global`, only a failure of
    // the machine has a source; the other one says that the host has already started the pool.
    rayon::current_thread_index().is_some()
        || *HOST.get_or_init(|| match rayon::ThreadPoolBuilder::new().build_global() {
            Ok(()) => true,
            Err(error) => error.source().is_none(),
        })
}

/// The pool with that many threads, started once per process: starting one takes 40 µs, as long as a small
/// mesh takes. A forked process has none of its parent's threads, and starts its own.
#[cfg(all(feature = "threads", not(target_family = "wasm")))]
fn thread_pool(threads: usize) -> Option<std::sync::Arc<rayon::ThreadPool>> {
    use std::collections::BTreeMap;
    use std::sync::Arc;
    static POOLS: Mutex<BTreeMap<(u32, usize), Arc<rayon::ThreadPool>>> = Mutex::new(BTreeMap::new());
    let key = (std::process::id(), threads);
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(pool) = pools.get(&key) {
        return Some(Arc::clone(pool));
    }
    let pool = Arc::new(rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok()?);
    pools.insert(key, Arc::clone(&pool));
    Some(pool)
}

/// A module has the threads of the pool in which it was called, and no others: its host has no more ready.
#[cfg(all(feature = "threads", target_family = "wasm"))]
fn has_threads() -> bool {
    rayon::current_thread_index().is_some() // No order depends on it.
}

/// Makes the calling thread a pool of one, unless it is in a pool: where a dependency asks for threads, rayon would
/// otherwise start some, which the host does not have.
#[cfg(all(feature = "threads", target_family = "wasm"))]
fn be_a_pool() {
    let is_outside = rayon::current_thread_index().is_none(); // No order depends on it.
    if is_outside {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
        // It is as long there as the thread.
        std::mem::forget(pool);
    }
}

/// None beside the one in which the module was called.
#[cfg(all(feature = "threads", target_family = "wasm"))]
fn thread_pool(_threads: usize) -> Option<std::sync::Arc<rayon::ThreadPool>> {
    None
}

/// For fewer triangles than this, waking another thread takes longer than the work. Derived: at 55 ns each
/// (`check::validity`) they take a fifth of a millisecond; to wake a thread and to wait for it took a fifth
/// of that, measured on a scene of 30,000 parts, most of whose time it was.
#[cfg(feature = "threads")]
const WORTH_A_THREAD: usize = 4096;

/// Runs both; in parallel with the feature `threads` if there are many triangles.
#[cfg(feature = "threads")]
pub(crate) fn both<A: Send, B: Send>(
    n_triangles: usize,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    if n_triangles < WORTH_A_THREAD || !has_threads() { (a(), b()) } else { rayon::join(a, b) }
}

/// Runs both, one after the other.
#[cfg(not(feature = "threads"))]
pub(crate) fn both<A, B>(_n_triangles: usize, a: impl FnOnce() -> A, b: impl FnOnce() -> B) -> (A, B) {
    (a(), b())
}

/// Applies `f` to every chunk of `size` items and the index of its first item; results are in the order of
/// the chunks. For linear-time counts that hold no memory and need no cancellation. The threads are those of
/// the job whose [`Job::run`] contains the call, or the host's.
pub(crate) fn over_chunks<T: Sync, R: Send>(
    items: &[T],
    size: usize,
    f: impl Fn(usize, &[T]) -> R + Sync,
) -> Vec<R> {
    let chunks: Vec<&[T]> = items.chunks(size).collect();
    par_map(&Job::default(), &chunks, |number, chunk| f(number * size, chunk))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_order_on_any_number_of_threads() {
        let items: Vec<u64> = (0..10_000).collect();
        let expected: Vec<u64> = items.iter().map(|x| x * x + x).collect();
        for threads in [0, 1, 2, 3, 8] {
            let job = Job::default().with_threads(threads);
            assert_eq!(par_map(&job, &items, |i, x| x * x + i as u64), expected, "{threads} threads");
        }
    }

    #[test]
    fn owned_items_keep_their_order_and_a_panic_comes_through() {
        for (threads, n) in [(1, 5), (2, 1), (3, 700)] {
            let job = Job::default().with_threads(threads);
            let items: Vec<String> = (0..n).map(|i| i.to_string()).collect();
            assert_eq!(par_map_owned(&job, items.clone(), |item| item), items);
            let fall = || par_map(&job, &items, |i, _| assert_ne!(i + 1, n, "the last one"));
            assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(fall)).is_err());
        }
    }

    #[test]
    fn nested_calls_share_the_pool_and_finish() {
        let job = Job::default().with_threads(2);
        let rows: Vec<u64> = (0..50).collect();
        let sums = par_map(&job, &rows, |_, row| par_map(&job, &rows, |_, x| row * x).iter().sum::<u64>());
        assert!(sums.iter().zip(&rows).all(|(sum, row)| *sum == row * 1225));
    }

    #[test]
    fn run_gives_the_result_of_the_work_with_the_threads_asked_for() {
        let job = Job::default().with_threads(3);
        assert_eq!(job.run(|| par_map(&job, &[1, 2], |i, x| i + x)), [1, 3]);
        #[cfg(feature = "threads")]
        assert_eq!(job.run(rayon::current_num_threads), 3);
    }
}
