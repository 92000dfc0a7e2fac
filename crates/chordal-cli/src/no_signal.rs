//! Replaces `signal` in WebAssembly, which has no signals: stopping a module in a browser drops its files
//! with it.
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

/// Removes a file.
pub fn remove_file(path: &Path) {
    let _ = std::fs::remove_file(path);
}

/// There is no list of unfinished outputs.
pub fn forget_unfinished(_: &Path) {}

/// Runs `commit`.
pub fn without_interruption<T>(commit: impl FnOnce() -> T) -> T {
    commit()
}

/// An abort of a module is a trap, which has no exit code.
pub fn end_aborts_with_a_code() {}

/// Nothing is printed before a trap.
pub fn say_of_aborts(_: String) {}

/// No signal can arrive.
pub fn install(_: Arc<AtomicBool>) {}
