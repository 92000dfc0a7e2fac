//! What stands for `signal` where there are no signals: whoever runs a module in a browser drops it, and its files.
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Creates an output.
pub fn create_unfinished<T>(
    _: &Path,
    _: Box<dyn Fn(&Path) + Send>,
    create: impl FnOnce() -> io::Result<T>,
) -> io::Result<T> {
    create()
}

/// A file is removed by its name.
pub fn remove_file(path: &Path) {
    let _ = std::fs::remove_file(path);
}

/// There is no list of what is unfinished.
pub fn forget_unfinished(_: &Path) {}

/// Runs `commit`.
pub fn without_interruption<T>(commit: impl FnOnce() -> T) -> T {
    commit()
}

/// A module that aborts has no code: whoever runs it sees the trap.
pub fn end_aborts_with_a_code() {}

/// Nothing is said before the trap.
pub fn say_of_aborts(_: String) {}

/// Nothing comes.
pub fn install(_: Arc<AtomicBool>) {}
