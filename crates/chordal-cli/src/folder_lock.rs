//! `FolderLock`: one job alone writes a folder. The lock is that of a file beside the folder, which the system
//! gives back when the job ends, however it ends.
use crate::overwrite::parent;
use crate::signal;
use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

/// The lock of a folder. Its file `.NAME.chordal-lock` stands beside the folder, so that it stays when the
/// folder is exchanged, and is removed at the end; one that a kill leaves is in nobody's way.
pub struct FolderLock {
    path: PathBuf,
    file: File,
    is_held: bool,
}

impl FolderLock {
    /// Locks a folder, which need not exist.
    ///
    /// # Errors
    /// [`io::ErrorKind::WouldBlock`] when another job has it; others when the file cannot be written.
    pub fn acquire(folder: &Path) -> io::Result<Self> {
        let name = folder.file_name().map(OsStr::to_string_lossy).unwrap_or_default();
        let path = parent(folder).join(format!(".{name}.chordal-lock"));
        // The one who had it may remove its file between the two steps. Chosen: that often in a row is another
        // fault.
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

    /// Whether there is a lock: some file systems have none.
    pub fn is_held(&self) -> bool {
        self.is_held
    }
}

/// What is said where another file has the name by the time of the lock. No call here ends so by itself.
const REPLACED: io::ErrorKind = io::ErrorKind::Interrupted;

/// Opens and locks the file of this name, and says whether that is a lock.
fn open_locked(path: &Path) -> io::Result<(File, bool)> {
    let file = OpenOptions::new().write(true).create(true).truncate(false).open(path)?;
    let is_held = match file.try_lock() {
        Ok(()) => true,
        Err(TryLockError::WouldBlock) => return Err(io::ErrorKind::WouldBlock.into()),
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => false,
        Err(TryLockError::Error(error)) => return Err(error),
    };
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
        // Removed while it is locked, so that nobody has locked it since. Where a file cannot be told from
        // another of its name, it stays.
        if cfg!(unix) {
            let _ = fs::remove_file(&self.path);
        }
        signal::forget_unfinished(&self.path);
        let _ = self.file.unlock();
    }
}
