//! Outputs that may not be replaced: refused with exit code 4, before any work and again at its end.
//!
//! Refused are the input, an existing file (unless `--force`), a folder, a device and a symbolic link. A link
//! is refused even with `--force`: replacing it and writing through it are both surprising, and the user can
//! name the file itself.
use crate::fault::Fault;
use crate::input::InputSource;
use std::fs;
use std::path::Path;

/// What happens to an existing file of the output's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OverwritePolicy {
    /// It stays, and the command fails.
    Keep,
    /// It is replaced at the end, atomically.
    Replace,
}

impl OverwritePolicy {
    /// The policy with `--force`, or without.
    pub fn from_force(is_forced: bool) -> Self {
        if is_forced { Self::Replace } else { Self::Keep }
    }
}

/// Refuses an output that is the input.
///
/// # Errors
/// If both are one file.
pub fn refuse_input(output: &Path, input: &InputSource) -> Result<(), Fault> {
    let InputSource::File(input) = input else { return Ok(()) };
    if !is_same_file(input, output) {
        return Ok(());
    }
    Err(Fault::output("output-is-input", format!("{}: the output is the input", output.display())))
}

/// Whether both paths are one file, even through links.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        // By the numbers of the file and not by its path: a hard link is the same file under another one.
        let id = |path| fs::metadata(path).map(|m| (m.dev(), m.ino()));
        matches!((id(a), id(b)), (Ok(a), Ok(b)) if a == b)
    }
    #[cfg(not(unix))]
    matches!((fs::canonicalize(a), fs::canonicalize(b)), (Ok(a), Ok(b)) if a == b)
}

/// Refuses an output whose path exists, unless it is a file that may be replaced.
///
/// # Errors
/// If it may not be replaced.
pub fn refuse_occupied(path: &Path, existing: OverwritePolicy) -> Result<(), Fault> {
    let name = path.display();
    // Of the link itself, which a check of its target would miss. A path that cannot be looked at fails
    // when it is written.
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

/// The error for a file that may not be replaced.
pub fn exists(path: &Path) -> Fault {
    Fault::output("output-exists", format!("{}: the file exists; --force replaces it", path.display()))
}

/// The folder of a path.
pub fn parent(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}
