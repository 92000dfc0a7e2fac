//! `FolderLock`: lets only one job write a folder. It locks a file beside the folder; the system releases the
//! lock when the job ends, even by a kill.
use crate::overwrite::parent;
use crate::signal;
use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

/// The lock of a folder. Its file `.NAME.chordal-lock` is beside the folder, so that it stays when the folder
/// is exchanged. It is removed at the end; a file left by a kill is harmless.
pub struct FolderLock {
    path: PathBuf,
    file: File,
    is_held: bool,
}

impl FolderLock {
    /// Locks a folder, which need not exist.
    ///
    /// # Errors
    /// [`io::ErrorKind::WouldBlock`] if another job holds the lock; others if the file cannot be written.
    pub fn acquire(folder: &Path) -> io::Result<Self> {
        let name = folder.file_name().map(OsStr::to_string_lossy).unwrap_or_default();
        let path = parent(folder).join(format!(".{name}.chordal-lock"));
        // The previous holder may remove the file between opening and locking it. Chosen: so many times in a
        // row must have another cause.
        for _ in 0..100 {
            let locked =
                signal::create_unfinished(&path, Box::new(signal::remove_file), || open_locked(&path));
            match locked {
                Ok((file, is_held)) => return Ok(Self { path, file, is_held }),
                Err(error) if error.kind() == REPLACED => {}
                Err(error) => return Err(error),
            }
        }
        Err(io::ErrorKind::WouldBlock.into())
    }

    /// Whether the folder is really locked: some file systems have no locks.
    pub fn is_held(&self) -> bool {
        self.is_held
    }
}

/// The error if the path no longer names the locked file. No system call here returns it by itself.
const REPLACED: io::ErrorKind = io::ErrorKind::Interrupted;

/// Opens and locks the file; returns it and whether the file system has locks.
fn open_locked(path: &Path) -> io::Result<(File, bool)> {
    let file = OpenOptions::new().write(true).create(true).truncate(false).open(path)?;
    // Never waits: the other job may run for hours, and the user is told instead.
    let is_held = match file.try_lock() {
        Ok(()) => true,
        Err(TryLockError::WouldBlock) => return Err(io::ErrorKind::WouldBlock.into()),
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => false,
        Err(TryLockError::Error(error)) => return Err(error),
    };
    // The file that was opened may have been removed by its last holder since, and another one created:
    // both jobs would then hold a lock.
    if is_named(&file, path) { Ok((file, is_held)) } else { Err(REPLACED.into()) }
}

#[cfg(unix)]
fn is_named(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let id = |metadata: fs::Metadata| (metadata.dev(), metadata.ino());
    matches!((file.metadata().map(id), fs::metadata(path).map(id)), (Ok(a), Ok(b)) if a == b)
}

#[cfg(not(unix))]
fn is_named(_: &File, _: &Path) -> bool {
    true
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        // Removed while still locked, so that no other job can have locked it since. Elsewhere than on Unix
        // the file stays, since `is_named` cannot tell it from a later file of the same name.
        if cfg!(unix) {
            let _ = fs::remove_file(&self.path);
        }
        signal::forget_unfinished(&self.path);
        let _ = self.file.unlock();
    }
}
