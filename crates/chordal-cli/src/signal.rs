//! What Ctrl-C and SIGTERM do: stop the job, remove the unfinished file, exit with 130.
use crate::fault::Exit;
use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The unfinished file. Whoever holds the lock may rename or remove it; the handler holds it until the exit, so that
/// no file is committed after "interrupted" was said.
static UNFINISHED: Mutex<Option<PathBuf>> = Mutex::new(None);

fn unfinished() -> MutexGuard<'static, Option<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Names the file that a signal removes, or none.
pub fn remove_on_exit(path: Option<PathBuf>) {
    *unfinished() = path;
}

/// Runs `commit` such that a signal comes either before it or after it.
pub fn not_within<T>(commit: impl FnOnce() -> T) -> T {
    let guard = unfinished();
    let done = commit();
    drop(guard);
    done
}

/// Installs the handler. It does not wait for the job, which could be in a long step or in a blocking read.
///
/// A second handler, or a system without signals, is no reason to fail: then the system's own handling stays, and
/// what a kill leaves behind is at most the unfinished file under its own name.
pub fn install(cancel: Arc<AtomicBool>) {
    let _ = ctrlc::set_handler(move || {
        cancel.store(true, Ordering::Relaxed);
        let mut path = unfinished();
        if let Some(path) = path.take() {
            let _ = std::fs::remove_file(path);
        }
        let _ = writeln!(std::io::stderr(), "chordal: interrupted");
        std::process::exit(Exit::Interrupted as i32);
    });
}
