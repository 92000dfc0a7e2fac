//! The threads that work runs on, such that a process that was forked gets its own.
use pyo3::Python;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::sync::{Arc, Mutex, PoisonError};

/// The pool with the process that it belongs to.
///
/// A fork takes only the thread that asked for it along. The pool of a child is then a ruin that answers
/// nobody, so it is left where it is and the child starts another. The lock is taken only by threads that
/// hold Python's own, and given back before that is: nobody else can have it at the moment of a fork.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// The threads of this process.
///
/// # Errors
/// When the system grants none.
pub(crate) fn pool(_attached: Python<'_>) -> Result<Arc<ThreadPool>, ThreadPoolBuildError> {
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if let Some((of, pool)) = &*pool
        && *of == process
    {
        return Ok(Arc::clone(pool));
    }
    let new = Arc::new(ThreadPoolBuilder::new().thread_name(|n| format!("chordal-{n}")).build()?);
    // To end the threads of a pool means to wake them, and those of a parent are not there to wake.
    std::mem::forget(pool.replace((process, Arc::clone(&new))));
    Ok(new)
}
