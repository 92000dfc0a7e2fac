//! The thread pool, of which each forked process gets its own.
use pyo3::Python;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::sync::{Arc, Mutex, PoisonError};

/// The pool with the process that it belongs to.
///
/// A fork copies only the thread that calls it. The pool of a child then has no running threads, so it is
/// leaked and the child starts another one. The lock is taken only by threads that hold the GIL, and released
/// before it: no other thread can hold it at the moment of a fork.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// The threads of this process.
///
/// # Errors
/// If the system starts no threads.
pub(crate) fn pool(_attached: Python<'_>) -> Result<Arc<ThreadPool>, ThreadPoolBuildError> {
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if let Some((owner, pool)) = &*pool
        && *owner == process
    {
        return Ok(Arc::clone(pool));
    }
    let new = Arc::new(ThreadPoolBuilder::new().thread_name(|n| format!("chordal-{n}")).build()?);
    // Leaked instead of dropped: dropping a pool waits for its threads, and those of the parent do not exist
    // here.
    std::mem::forget(pool.replace((process, Arc::clone(&new))));
    Ok(new)
}
