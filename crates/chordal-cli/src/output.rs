//! Writing a file so that its name only ever shows a complete one: written aside, synced, renamed.
//!
//! What a kill at any moment can leave behind is a file `.chordal-….tmp` beside the output; never half an
//! output. Outputs of several files are in `output_set.rs` and `output_folder.rs`. Refused, with exit code 4
//! and before any work: an output that is the input, that exists (unless `--force`), or that is a folder, a
//! device or a symbolic link. A link is refused even with `--force`: replacing it and writing through it are
//! both surprising, and naming the file itself costs nothing.
use crate::console::check_stdout;
use crate::fault::{Fault, plainly};
use crate::input::InputSource;
use crate::signal;
use chordal_io::WriteError;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// What happens to a file that already has the output's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OverwritePolicy {
    /// It stays, and the command fails.
    Keep,
    /// It is replaced, as a whole and at the end.
    Replace,
}

/// Where output goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OutputTarget {
    /// `-`.
    Stdout,
    /// A file.
    File {
        /// Its name.
        path: PathBuf,
        /// What happens to a file that already has it.
        existing: OverwritePolicy,
    },
}

/// What fills an output.
pub type OutputWriter<'a> = &'a mut dyn FnMut(&mut dyn Write) -> Result<(), WriteError>;

impl OutputTarget {
    /// `-` is stdout; anything else is a path, checked now as far as that is possible: the work may take
    /// long, and a folder that cannot be written should be known before.
    ///
    /// # Errors
    /// When the output cannot, or should not, be written.
    pub fn prepare(arg: &Path, existing: OverwritePolicy, input: &InputSource) -> Result<Self, Fault> {
        if arg.as_os_str() == "-" {
            return Ok(Self::Stdout);
        }
        refuse_input(arg, input)?;
        refuse_occupied(arg, existing)?;
        drop(TempOutput::create(arg)?);
        Ok(Self::File { path: arg.to_owned(), existing })
    }

    /// The name in messages and reports.
    pub fn name(&self) -> String {
        match self {
            Self::Stdout => "stdout".to_owned(),
            Self::File { path, .. } => path.display().to_string(),
        }
    }

    /// Writes what `fill` makes, all or nothing, and returns the number of bytes.
    ///
    /// # Errors
    /// When `fill` or the system fails; then whatever had the name before still has it.
    pub fn write(&self, fill: OutputWriter) -> Result<u64, Fault> {
        let name = self.name();
        let failed = |error: WriteError| unwritable(&name, &error);
        match self {
            Self::Stdout => {
                check_stdout()?;
                let mut bytes = Vec::new();
                fill(&mut bytes).map_err(failed)?;
                let mut stdout = io::stdout().lock();
                stdout.write_all(&bytes).and_then(|()| stdout.flush()).map_err(|e| failed(e.into()))?;
                Ok(bytes.len() as u64)
            }
            Self::File { path, existing } => {
                let mut aside = TempOutput::create(path)?;
                let bytes = aside.fill(fill).map_err(failed)?;
                aside.commit(path, *existing)?;
                Ok(bytes)
            }
        }
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

/// Refuses an output that is the input.
///
/// # Errors
/// Then.
pub fn refuse_input(output: &Path, input: &InputSource) -> Result<(), Fault> {
    let InputSource::File(input) = input else { return Ok(()) };
    if !is_same_file(input, output) {
        return Ok(());
    }
    Err(Fault::output("output-is-input", format!("{}: the output is the input", output.display())))
}

/// Whether both names lead to one file, by whatever links.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let id = |path| fs::metadata(path).map(|m| (m.dev(), m.ino()));
        matches!((id(a), id(b)), (Ok(a), Ok(b)) if a == b)
    }
    #[cfg(not(unix))]
    matches!((fs::canonicalize(a), fs::canonicalize(b)), (Ok(a), Ok(b)) if a == b)
}

/// Refuses an output whose name is taken, unless by a file that may be replaced.
///
/// # Errors
/// When it should not be written.
pub fn refuse_occupied(path: &Path, existing: OverwritePolicy) -> Result<(), Fault> {
    let name = path.display();
    let Ok(metadata) = fs::symlink_metadata(path) else { return Ok(()) };
    let kind = metadata.file_type();
    if kind.is_symlink() {
        return Err(Fault::output(
            "output-is-link",
            format!("{name}: this is a symbolic link; name the file that it leads to"),
        ));
    }
    if !kind.is_file() {
        let what = if kind.is_dir() { "a folder" } else { "a device, pipe or socket" };
        return Err(Fault::output(
            "output-is-no-file",
            format!("{name}: this is {what}, not a file; '-' writes to stdout"),
        ));
    }
    match existing {
        OverwritePolicy::Replace => Ok(()),
        OverwritePolicy::Keep => Err(exists(path)),
    }
}

/// The fault of a file that may not be replaced.
pub fn exists(path: &Path) -> Fault {
    Fault::output("output-exists", format!("{}: the file exists; --force replaces it", path.display()))
}

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
            let path = folder.join(format!(".chordal-{}-{attempt}.tmp", std::process::id()));
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
    fn commit(self, output: &Path, existing: OverwritePolicy) -> Result<(), Fault> {
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

/// The folder that a path stands in.
pub fn parent(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::Exit;
    use chordal_testkit::Folder;

    #[test]
    fn h79_a_writer_that_fails_half_way_leaves_the_old_file_and_nothing_else() {
        let folder = Folder::new("output-fails");
        let path = folder.path("out.bin");
        fs::write(&path, "old").unwrap();
        let target = OutputTarget::prepare(&path, OverwritePolicy::Replace, &InputSource::Stdin).unwrap();
        let fault = target
            .write(&mut |out| {
                out.write_all(&[1; 100_000])?;
                Err(io::Error::from(io::ErrorKind::StorageFull).into())
            })
            .unwrap_err();
        assert_eq!(fault.exit, Exit::Output);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(folder.names(), ["out.bin"]);
    }

    #[test]
    fn replaces_a_file_only_when_told_to() {
        let folder = Folder::new("output-replaces");
        let path = folder.path("out.bin");
        let new = |existing| {
            OutputTarget::prepare(&path, existing, &InputSource::Stdin)?
                .write(&mut |out| Ok(out.write_all(b"new")?))
        };
        assert_eq!(new(OverwritePolicy::Keep).unwrap(), 3);
        fs::write(&path, "old").unwrap();
        assert_eq!(new(OverwritePolicy::Keep).unwrap_err().code, "output-exists");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(new(OverwritePolicy::Replace).unwrap(), 3);
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(folder.names(), ["out.bin"]);
    }

    #[test]
    fn keeps_a_file_that_appears_during_the_work() {
        let folder = Folder::new("output-appears");
        let path = folder.path("out.bin");
        let target = OutputTarget::prepare(&path, OverwritePolicy::Keep, &InputSource::Stdin).unwrap();
        let fault = target
            .write(&mut |out| {
                fs::write(&path, "somebody else's")?;
                Ok(out.write_all(b"mine")?)
            })
            .unwrap_err();
        assert_eq!(fault.code, "output-exists");
        assert_eq!(fs::read(&path).unwrap(), b"somebody else's");
        assert_eq!(folder.names(), ["out.bin"]);
    }

    #[test]
    fn an_output_folder_that_is_missing_is_known_before_the_work() {
        let path = std::env::temp_dir().join("chordal-no-such-folder/out.bin");
        let fault = OutputTarget::prepare(&path, OverwritePolicy::Replace, &InputSource::Stdin).unwrap_err();
        assert_eq!(fault.exit, Exit::Output);
        assert!(fault.lines[0].contains("no such file or directory"), "{fault}");
    }
}
