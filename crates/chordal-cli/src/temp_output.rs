//! `TempOutput`: a file so that its name only ever shows a complete one: written aside, synced, renamed.
//!
//! What a kill at any moment can leave behind is a file `.chordal-….tmp` beside the output; never half an
//! output. Outputs of several files are in `output_set.rs` and `output_folder.rs`.
use crate::fault::{Fault, plainly};
use crate::host;
use crate::overwrite::{OverwritePolicy, exists, parent, refuse_occupied};
use crate::signal;
use chordal_io::WriteError;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// What fills an output.
pub type OutputWriter<'a> = &'a mut dyn FnMut(&mut dyn Write) -> Result<(), WriteError>;

/// A file beside the output, removed again unless it is committed.
pub struct TempOutput {
    file: File,
    path: PathBuf,
}

impl TempOutput {
    /// Creates it in the folder of `output`, under a name that nothing has.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn create(output: &Path) -> Result<Self, Fault> {
        let folder = parent(output);
        let failed = |error: &io::Error| {
            let what = format!("{}: cannot write into {}", output.display(), folder.display());
            Fault::output("unwritable", format!("{what}: {}", plainly(error)))
        };
        // Another process can have the name only if it had this one's number before and was killed.
        for attempt in 0..1000 {
            let path = folder.join(format!(".chordal-{}-{attempt}.tmp", host::process_number()));
            match signal::create_unfinished(&path, Box::new(signal::remove_file), || File::create_new(&path))
            {
                Ok(file) => return Ok(Self { file, path }),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(failed(&error)),
            }
        }
        Err(failed(&io::ErrorKind::AlreadyExists.into()))
    }

    /// Its own name.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes what `fill` makes, down to the disk, and returns the number of bytes.
    ///
    /// # Errors
    /// When `fill` or the system fails.
    pub fn fill(&mut self, fill: OutputWriter) -> Result<u64, WriteError> {
        let mut buffer = BufWriter::with_capacity(1 << 20, &self.file);
        fill(&mut buffer)?;
        buffer.flush()?;
        drop(buffer);
        self.file.sync_all()?;
        Ok(self.file.metadata()?.len())
    }

    /// Gives the file its name, in one step.
    pub fn commit(self, output: &Path, existing: OverwritePolicy) -> Result<(), Fault> {
        // Asked again: the work may have taken long.
        refuse_occupied(output, existing)?;
        let renamed = signal::without_interruption(|| match existing {
            OverwritePolicy::Replace => {
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
        // After a commit the name is gone and there is nothing to remove.
        let _ = fs::remove_file(&self.path);
        signal::forget_unfinished(&self.path);
    }
}

/// Who could read the old file or folder can read the new one. Where that cannot be kept, the data still is.
pub fn keep_permissions(old: &Path, new: &Path) {
    if let Ok(old) = fs::metadata(old) {
        let _ = fs::set_permissions(new, old.permissions());
    }
}

/// Renames only if nothing has the new name: a hard link cannot replace, a rename would.
///
/// # Errors
/// When the system fails, or something has the name.
pub fn rename_to_new(from: &Path, to: &Path) -> io::Result<()> {
    match fs::hard_link(from, to) {
        Ok(()) => fs::remove_file(from),
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Err(error),
        // A file system without hard links.
        Err(_) if !to.exists() => fs::rename(from, to),
        Err(_) => Err(io::ErrorKind::AlreadyExists.into()),
    }
}

/// Makes the new name itself survive a power cut, where the system lets a folder be synced.
pub fn sync_folder(inside: &Path) {
    if let Ok(folder) = File::open(parent(inside)) {
        let _ = folder.sync_all();
    }
}

/// The fault of an output that cannot be written.
pub fn unwritable(name: &str, error: &WriteError) -> Fault {
    let text = match error {
        WriteError::Io(error) => plainly(error),
        WriteError::Unsupported(message) => message.clone(),
    };
    Fault::output("unwritable", format!("{name}: {text}"))
}
