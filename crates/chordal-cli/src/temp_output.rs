//! `TempOutput`: an output file that is written under a temporary name, synced and renamed, so that it is
//! never seen incomplete.
//!
//! A kill leaves at most a file `.chordal-….tmp` beside the output, never half an output. Outputs of several
//! files are in `output_set_write.rs` and `output_folder.rs`.
use crate::fault::{Fault, plainly};
use crate::host;
use crate::overwrite::{OverwritePolicy, exists, parent, refuse_occupied};
use crate::signal;
use chordal_io::WriteError;
use std::cell::Cell;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Writes the content of an output.
pub type OutputWriter<'a> = &'a mut dyn FnMut(&mut dyn Write) -> Result<(), WriteError>;

/// A file beside the output, removed again unless it is committed.
pub struct TempOutput {
    file: File,
    path: PathBuf,
    is_kept: Cell<bool>,
}

impl TempOutput {
    /// Creates the file in the folder of `output`, under an unused name.
    ///
    /// # Errors
    /// If the folder cannot be written.
    pub fn create(output: &Path) -> Result<Self, Fault> {
        let folder = parent(output);
        let failed = |error: &io::Error| {
            let what = format!("{}: cannot write into {}", output.display(), folder.display());
            Fault::output("unwritable", format!("{what}: {}", plainly(error)))
        };
        // A name is taken only if an earlier process of the same number was killed.
        for attempt in 0..1000 {
            let path = folder.join(format!(".chordal-{}-{attempt}.tmp", host::process_number()));
            match signal::create_unfinished(&path, Box::new(signal::remove_file), || File::create_new(&path))
            {
                Ok(file) => return Ok(Self { file, path, is_kept: Cell::new(false) }),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(failed(&error)),
            }
        }
        Err(failed(&io::ErrorKind::AlreadyExists.into()))
    }

    /// The temporary path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Leaves the file under its temporary name.
    pub fn keep(&self) {
        self.is_kept.set(true);
        signal::forget_unfinished(&self.path);
    }

    /// Writes the output of `fill`, syncs it, and returns the number of bytes.
    ///
    /// # Errors
    /// If `fill` or the system fails.
    pub fn fill(&mut self, fill: OutputWriter) -> Result<u64, WriteError> {
        let mut buffer = BufWriter::with_capacity(1 << 20, &self.file);
        fill(&mut buffer)?;
        buffer.flush()?;
        drop(buffer);
        // Before the rename: after a power cut, a new name with an empty file would be worse than the old
        // file.
        self.file.sync_all()?;
        Ok(self.file.metadata()?.len())
    }

    /// Renames the file to the output, in one step.
    pub fn commit(self, output: &Path, existing: OverwritePolicy) -> Result<(), Fault> {
        // Checked again, since it may have changed during the work.
        refuse_occupied(output, existing)?;
        let renamed = signal::without_interruption(|| match existing {
            OverwritePolicy::Replace => {
                // Before the rename, so that the output is never in place with wider permissions than it
                // had.
                keep_permissions(output, &self.path);
                fs::rename(&self.path, output)
            }
            OverwritePolicy::Keep => rename_to_new(&self.path, output),
        });
        renamed.map_err(|error| match error.kind() {
            io::ErrorKind::AlreadyExists => exists(output),
            _ => Fault::output("unwritable", format!("{}: {}", output.display(), plainly(&error))),
        })?;
        sync_folder(&self.path);
        Ok(())
    }
}

impl Drop for TempOutput {
    fn drop(&mut self) {
        if self.is_kept.get() {
            return;
        }
        // After a commit nothing has this name, and the removal fails harmlessly.
        let _ = fs::remove_file(&self.path);
        signal::forget_unfinished(&self.path);
    }
}

/// Copies the permissions of the old file or folder to the new one. A failure is ignored: the data matters
/// more.
pub fn keep_permissions(old: &Path, new: &Path) {
    if let Ok(old) = fs::metadata(old) {
        let _ = fs::set_permissions(new, old.permissions());
    }
}

/// Renames only if nothing has the new name. It uses a hard link, which fails if the name exists; a rename
/// would replace.
///
/// # Errors
/// If the system fails, or the name exists.
pub fn rename_to_new(from: &Path, to: &Path) -> io::Result<()> {
    match fs::hard_link(from, to) {
        // For a moment the file has both names; a kill there leaves the output complete, beside a
        // left-over.
        Ok(()) => fs::remove_file(from),
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Err(error),
        // A file system without hard links.
        Err(_) if !to.exists() => fs::rename(from, to),
        Err(_) => Err(io::ErrorKind::AlreadyExists.into()),
    }
}

/// Makes the new name survive a power cut, if the system can sync folders.
pub fn sync_folder(inside: &Path) {
    if let Ok(folder) = File::open(parent(inside)) {
        let _ = folder.sync_all();
    }
}

/// The error for an output that cannot be written.
pub fn unwritable(name: &str, error: &WriteError) -> Fault {
    let text = match error {
        WriteError::Io(error) => plainly(error),
        WriteError::Unsupported(message) => message.clone(),
    };
    Fault::output("unwritable", format!("{name}: {text}"))
}
