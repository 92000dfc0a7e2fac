//! Work on the threads of a [`Job`]: order and results are those of one thread.
use super::Job;

/// `f(0, &items[0]), f(1, &items[1]), …` in order, on as many threads as the job allows.
///
/// The result is the same on any number of threads as long as `f` depends on its arguments alone. Without the
/// feature `threads`, or when the machine grants no thread, the caller's own thread does all of it. A job that is
/// cancelled still runs `f` for every item: an `f` that takes long asks [`Job::is_cancelled`] and returns early.
///
/// Cost: one task a few items; threads are started once a process for each number of threads.
///
/// ```
/// use chordal::budget::{Job, par_map};
/// let squares = par_map(&Job::default().with_threads(3), &[1, 2, 3], |i, x| i as i32 + x * x);
/// assert_eq!(squares, [1, 5, 11]);
/// ```
pub fn par_map<T: Sync, R: Send>(job: &Job, items: &[T], f: impl Fn(usize, &T) -> R + Sync) -> Vec<R> {
    #[cfg(feature = "threads")]
    if job.threads != 1 && items.len() > 1 {
        use rayon::prelude::*;
        return job.run(|| items.par_iter().enumerate().map(|(i, item)| f(i, item)).collect());
    }
    let _ = job;
    items.iter().enumerate().map(|(i, item)| f(i, item)).collect()
}

/// [`par_map`] over items that `f` consumes: for the few large parts into which a recursion cuts its input.
pub(crate) fn par_map_owned<T: Send, R: Send>(job: &Job, items: Vec<T>, f: impl Fn(T) -> R + Sync) -> Vec<R> {
    #[cfg(feature = "threads")]
    if job.threads != 1 && items.len() > 1 {
        use rayon::prelude::*;
        return job.run(|| items.into_par_iter().map(&f).collect());
    }
    let _ = job;
    items.into_iter().map(f).collect()
}

impl Job {
    /// Runs `work` where every [`par_map`] of the same number of threads shares one set of threads: start them once
    /// around many small steps.
    pub fn run<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        #[cfg(feature = "threads")]
        {
            // Without a number of threads the host's own pool is right; inside a pool of this size there is one. No
            // result depends on it: `par_map` keeps the order.
            let fits =
                rayon::current_thread_index().is_some() && rayon::current_num_threads() == self.threads;
            if self.threads != 0 && !fits {
                // A machine that grants no more threads leaves the work to those that there are.
                if let Some(pool) = pool_of(self.threads) {
                    return pool.install(work);
                }
            }
        }
        work()
    }
}

/// The pool with that many threads, started once a process: starting one takes 40 µs, which is as long as a small
/// mesh takes.
#[cfg(feature = "threads")]
fn pool_of(threads: usize) -> Option<std::sync::Arc<rayon::ThreadPool>> {
    use std::collections::BTreeMap;
    use std::sync::{Arc, Mutex, PoisonError};
    static POOLS: Mutex<BTreeMap<usize, Arc<rayon::ThreadPool>>> = Mutex::new(BTreeMap::new());
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(pool) = pools.get(&threads) {
        return Some(Arc::clone(pool));
    }
    let pool = Arc::new(rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok()?);
    pools.insert(threads, Arc::clone(&pool));
    Some(pool)
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
