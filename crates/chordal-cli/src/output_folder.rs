//! Writes an output folder atomically: it is written under a temporary name, synced, and exchanged with the
//! old folder in one step.
//!
//! ```text
//! before:  out/ = old files    .chordal-out-12-0.tmp/ = new files
//! after:   out/ = new files    .chordal-out-12-0.tmp/ = old files, then removed
//! ```
//!
//! If the system cannot exchange two folders, first the old one is renamed, then the new one. A kill between
//! the two steps leaves the old folder as `.chordal-….old.tmp`; the next run restores its name before
//! anything else. Any other kill leaves at most a folder `.chordal-….tmp`, which the next run for the same
//! folder removes, and an empty lock file.
//!
//! Only files with names that the verb writes are ever removed. A folder with any other file is refused.
use crate::fault::{Fault, plainly};
use crate::folder_lock::FolderLock;
use crate::host;
use crate::overwrite::{self, OverwritePolicy};
use crate::signal;
use crate::temp_output::{self, keep_permissions, unwritable};
use chordal_io::{FileSet, WriteError};
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Whether the verb writes files of a name into its folder.
pub type OwnNames = fn(&str) -> bool;

/// An output folder that is locked, with a temporary folder until it is written.
pub struct OutputFolder {
    place: FolderPlace,
    // Fields are dropped in order: the temporary folder is removed before the lock is released.
    temp: TempFolder,
    _lock: FolderLock,
}

/// A folder that may be written, and the policy for its current files.
#[derive(Clone, Debug)]
pub struct FolderPlace {
    /// The path, without a `/` at the end.
    path: PathBuf,
    existing: OverwritePolicy,
    is_own: OwnNames,
}

/// The current state of the output's path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FolderState {
    Missing,
    Empty,
    /// Only files of the verb, which may be replaced.
    Own,
}

impl FolderPlace {
    /// Checks a folder, as far as possible before the work.
    ///
    /// # Errors
    /// If it is no folder, a link, the working folder or a mount point, or contains files that the verb does
    /// not write or may not replace.
    pub fn new(arg: &Path, existing: OverwritePolicy, is_own: OwnNames) -> Result<Self, Fault> {
        let unreadable = |error: io::Error| fault_at(arg, &plainly(&error));
        let path: PathBuf = match arg.file_name() {
            Some(_) => arg.components().collect(),
            // "." and ".." are no names that a folder could be renamed to.
            None => arg.canonicalize().map_err(unreadable)?,
        };
        let place = Self { path, existing, is_own };
        // A folder that is missing is created by a rename, which neither rule concerns.
        if place.state()? != FolderState::Missing {
            place.refuse_fixed()?;
        }
        Ok(place)
    }

    /// The path of a file in the folder.
    pub fn join(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Whether a file is in the folder.
    pub fn holds(&self, file: &Path) -> bool {
        let at = overwrite::parent(file).canonicalize();
        matches!((at, self.path.canonicalize()), (Ok(at), Ok(own)) if at == own)
    }

    /// Creates the parent folders, locks the folder, removes left-overs, and creates the temporary folder.
    ///
    /// # Errors
    /// If another job writes the folder, or its parent cannot be written.
    pub fn open(self) -> Result<OutputFolder, Fault> {
        let parent = overwrite::parent(&self.path);
        fs::create_dir_all(parent).map_err(|error| self.unwritable_parent(&error))?;
        let lock = FolderLock::acquire(&self.path).map_err(|error| match error.kind() {
            io::ErrorKind::WouldBlock => Fault::output(
                "output-in-use",
                format!("{}: another job is writing this folder", self.path.display()),
            ),
            _ => self.unwritable_parent(&error),
        })?;
        // Without a lock, a temporary folder may be that of a job that is still at work.
        if lock.is_held() {
            self.sweep();
        }
        // Again: the sweep may just have put an old folder back, whose files are not to be replaced
        // unasked.
        self.state()?;
        let temp = TempFolder::create(&self)?;
        Ok(OutputFolder { place: self, temp, _lock: lock })
    }

    /// The state of the folder, if it may be replaced.
    fn state(&self) -> Result<FolderState, Fault> {
        let name = self.path.display();
        let metadata = match fs::symlink_metadata(&self.path) {
            Ok(metadata) => metadata,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(FolderState::Missing),
            Err(error) => return Err(fault_at(&self.path, &plainly(&error))),
        };
        if metadata.is_symlink() {
            let message = format!("{name}: this is a symbolic link; name the folder that it leads to");
            return Err(Fault::output("output-is-link", message));
        }
        if !metadata.is_dir() {
            return Err(Fault::output(
                "output-is-no-folder",
                format!("{name}: this is a file, not a folder"),
            ));
        }
        let names = self.own_names(&self.path)?;
        match (names.first(), self.existing) {
            (None, _) => Ok(FolderState::Empty),
            (Some(_), OverwritePolicy::Replace) => Ok(FolderState::Own),
            (Some(first), OverwritePolicy::Keep) => Err(Fault::output(
                "output-exists",
                format!("{}: the folder exists; --force replaces all of it", self.join(first).display()),
            )),
        }
    }

    /// The sorted names in a folder; an error if one is not the verb's.
    fn own_names(&self, folder: &Path) -> Result<Vec<String>, Fault> {
        let unreadable = |error: io::Error| fault_at(&self.path, &plainly(&error));
        let mut names = Vec::new();
        for entry in fs::read_dir(folder).map_err(unreadable)? {
            let entry = entry.map_err(unreadable)?;
            let (is_file, name) = (entry.file_type().is_ok_and(|kind| kind.is_file()), entry.file_name());
            match name.to_str().filter(|name| is_file && (self.is_own)(name)) {
                Some(name) => names.push(name.to_owned()),
                None => {
                    return Err(Fault::output(
                        "output-not-own",
                        format!(
                            "{}: this file was not written by this command, and the folder would be replaced as a \
                            whole; name another folder",
                            self.path.join(name).display()
                        ),
                    ));
                }
            }
        }
        names.sort();
        Ok(names)
    }

    /// Refuses a mount point, which cannot be renamed, and the working folder, which would vanish under its
    /// users.
    fn refuse_fixed(&self) -> Result<(), Fault> {
        let is_working = matches!(
            (std::env::current_dir().and_then(|folder| folder.canonicalize()), self.path.canonicalize()),
            (Ok(working), Ok(own)) if working == own
        );
        let what = if is_working {
            "the working folder"
        } else if is_mount_point(&self.path) {
            "a mount point"
        } else {
            return Ok(());
        };
        let name = self.path.display();
        Err(Fault::output(
            "output-is-fixed",
            format!("{name}: this is {what}, which cannot be replaced as a whole; name a folder inside it"),
        ))
    }

    fn unwritable_parent(&self, error: &io::Error) -> Fault {
        let parent = overwrite::parent(&self.path).display();
        fault_at(&self.path, &format!("cannot write into {parent}: {}", plainly(error)))
    }

    /// The prefix of the names of temporary folders.
    fn temp_prefix(&self) -> String {
        let name = self.path.file_name().map(OsStr::to_string_lossy).unwrap_or_default();
        format!(".chordal-{name}-")
    }

    /// Restores or removes what killed jobs left of this folder. Only the holder of the lock may do so.
    fn sweep(&self) {
        let Ok(entries) = fs::read_dir(overwrite::parent(&self.path)) else { return };
        let prefix = self.temp_prefix();
        for entry in entries.flatten() {
            let name = entry.file_name();
            let rest = name.to_str().and_then(|name| name.strip_prefix(&prefix)?.strip_suffix(".tmp"));
            let Some(rest) = rest.filter(|_| entry.file_type().is_ok_and(|kind| kind.is_dir())) else {
                continue;
            };
            let (numbers, is_old) = rest.strip_suffix(OLD).map_or((rest, false), |numbers| (numbers, true));
            // Exactly two numbers: the prefix also fits the left-overs of a folder whose name goes on
            // with `-` and a number.
            let is_number = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
            if !numbers.split_once('-').is_some_and(|(a, b)| is_number(a) && is_number(b)) {
                continue;
            }
            // Beside a new folder, the old one is what the kill left no time to remove.
            let is_missing = !self.path.exists();
            if is_old && is_missing {
                let _ = fs::rename(entry.path(), &self.path);
            } else {
                remove_own(&entry.path(), self.is_own);
            }
        }
    }
}

/// The suffix, before `.tmp`, of an old folder while the new one is renamed.
const OLD: &str = ".old";

/// Removes the verb's files, and the folder if it is empty then.
fn remove_own(folder: &Path, is_own: OwnNames) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_file && entry.file_name().to_str().is_some_and(is_own) {
            let _ = fs::remove_file(entry.path());
        }
    }
    let _ = fs::remove_dir(folder);
}

fn fault_at(path: &Path, what: &str) -> Fault {
    Fault::output("unwritable", format!("{}: {what}", path.display()))
}

#[cfg(unix)]
fn is_mount_point(folder: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let device = |path: &Path| fs::metadata(path).map(|metadata| metadata.dev());
    matches!((device(folder), device(overwrite::parent(folder))), (Ok(own), Ok(above)) if own != above)
}

#[cfg(not(unix))]
fn is_mount_point(_: &Path) -> bool {
    false
}

/// A folder beside the output, removed with its files unless it is renamed to the output.
struct TempFolder {
    path: PathBuf,
    is_own: OwnNames,
}

impl TempFolder {
    fn create(place: &FolderPlace) -> Result<Self, Fault> {
        // Beside the output and not in the system's folder for such files: only within a file system is a
        // rename one step.
        let (parent, prefix, is_own) = (overwrite::parent(&place.path), place.temp_prefix(), place.is_own);
        // A name is taken only if an earlier process of the same number was killed.
        for attempt in 0..1000 {
            let path = parent.join(format!("{prefix}{}-{attempt}.tmp", host::process_number()));
            let remove = Box::new(move |path: &Path| remove_own(path, is_own));
            match signal::create_unfinished(&path, remove, || fs::create_dir(&path)) {
                Ok(()) => return Ok(Self { path, is_own }),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(place.unwritable_parent(&error)),
            }
        }
        Err(place.unwritable_parent(&io::ErrorKind::AlreadyExists.into()))
    }

    /// Writes and syncs a file.
    fn write(&self, name: &str, bytes: &[u8]) -> Result<(), WriteError> {
        let path = self.path.join(name);
        // The signal handler removes the folder's files, so none may be created while it runs.
        let mut file = signal::without_interruption(|| File::create_new(&path))?;
        file.write_all(bytes)?;
        Ok(file.sync_all()?)
    }
}

impl Drop for TempFolder {
    fn drop(&mut self) {
        // After an exchange the old folder has this name; after a rename nothing has it.
        remove_own(&self.path, self.is_own);
        signal::forget_unfinished(&self.path);
    }
}

impl OutputFolder {
    /// Writes all files and puts the folder in place in one step. `document` is the name of the set's
    /// document. Returns the number of bytes.
    ///
    /// # Errors
    /// If the system fails, or the folder may not be replaced any more; then the old folder is unchanged.
    pub fn write(self, set: &FileSet<'_>, document: &str) -> Result<u64, Fault> {
        let mut bytes = 0;
        // The document last: whatever a kill leaves has no document that promises more files than there
        // are.
        let beside = set.beside.iter().map(|file| (&*file.name, &*file.bytes));
        for (name, content) in beside.chain([(document, &*set.document)]) {
            let written = self.temp.write(name, content);
            written.map_err(|error| unwritable(&self.place.join(name).display().to_string(), &error))?;
            bytes += content.len() as u64;
        }
        // The names in the folder have to be on the disk before the folder gets its name, and its name
        // before this is called done.
        temp_output::sync_folder(&self.temp.path.join(document));
        signal::without_interruption(|| self.commit())?;
        temp_output::sync_folder(&self.place.path);
        Ok(bytes)
    }

    /// Puts the folder in place.
    fn commit(&self) -> Result<(), Fault> {
        let (new, path) = (&self.temp.path, &self.place.path);
        // Checked again, since it may have changed during the work.
        match self.place.state()? {
            FolderState::Missing => fs::rename(new, path).map_err(|error| self.failed(&error)),
            FolderState::Empty => {
                // Before the new folder gets the name, so that it never has it with other permissions
                // than the old one.
                keep_permissions(path, new);
                // Only Unix renames over an empty folder. `remove_dir` removes only an empty one.
                let free = if cfg!(unix) { Ok(()) } else { fs::remove_dir(path) };
                free.and_then(|()| fs::rename(new, path)).map_err(|error| self.failed(&error))
            }
            FolderState::Own => {
                keep_permissions(path, new);
                match exchange(new, path) {
                    Ok(()) => {
                        // If another program added a file to the old folder meanwhile, exchange them back.
                        self.place.own_names(new).map(drop).inspect_err(|_| drop(exchange(new, path)))
                    }
                    Err(error) if is_unsupported(&error) => self.rename_both(),
                    Err(error) => Err(self.failed(&error)),
                }
            }
        }
    }

    /// Replaces the old folder in two steps; if the second fails, the first is undone.
    fn rename_both(&self) -> Result<(), Fault> {
        let (new, path) = (&self.temp.path, &self.place.path);
        // The name tells the next run's sweep that this is the old folder.
        let old = new.with_extension(format!("{}.tmp", &OLD[1..]));
        fs::rename(path, &old).map_err(|error| self.failed(&error))?;
        let renamed = self
            .place
            // Only now can nobody add a file by the old path; a foreign one undoes the step.
            .own_names(&old)
            .and_then(|_| fs::rename(new, path).map_err(|error| self.failed(&error)));
        match renamed {
            Ok(()) => remove_own(&old, self.place.is_own),
            Err(_) => drop(fs::rename(&old, path)),
        }
        renamed
    }

    fn failed(&self, error: &io::Error) -> Fault {
        match error.kind() {
            io::ErrorKind::ResourceBusy | io::ErrorKind::CrossesDevices => Fault::output(
                "output-is-fixed",
                format!(
                    "{}: the folder is in use by the system and cannot be replaced as a whole; name a folder inside it",
                    self.place.path.display()
                ),
            ),
            _ => fault_at(&self.place.path, &plainly(error)),
        }
    }
}

/// Exchanges the names of two folders in one step.
#[cfg(target_os = "linux")]
fn exchange(a: &Path, b: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    Ok(renameat_with(CWD, a, CWD, b, RenameFlags::EXCHANGE)?)
}

#[cfg(not(target_os = "linux"))]
fn exchange(_: &Path, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Whether the system or the file system does not support the call, or not for these paths.
fn is_unsupported(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::Unsupported | io::ErrorKind::InvalidInput)
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_io::SideFile;
    use chordal_testkit::{Folder, names};
    use std::borrow::Cow;

    fn is_own(name: &str) -> bool {
        name == "list" || name.starts_with("tile_")
    }

    fn open(folder: &Folder, existing: OverwritePolicy) -> Result<OutputFolder, Fault> {
        FolderPlace::new(&folder.path("out/"), existing, is_own)?.open()
    }

    fn set(tiles: &[&str]) -> FileSet<'static> {
        let file = |name: &&str| SideFile { name: (*name).to_owned(), bytes: Cow::Borrowed(b"new") };
        FileSet { document: b"list".to_vec(), beside: tiles.iter().map(file).collect() }
    }

    #[test]
    fn a_folder_takes_the_place_of_another_with_all_its_files() {
        let folder = Folder::new("folder-whole");
        for (tiles, existing) in
            [(&["tile_0", "tile_1"][..], OverwritePolicy::Keep), (&["tile_0"], OverwritePolicy::Replace)]
        {
            assert_eq!(
                open(&folder, existing).unwrap().write(&set(tiles), "list").unwrap(),
                4 + 3 * tiles.len() as u64
            );
            assert_eq!(names(&folder.path("out")), [&["list"], tiles].concat());
            assert_eq!(folder.names(), ["out"]);
        }
        let Err(fault) = open(&folder, OverwritePolicy::Keep) else { panic!("replaced") };
        assert_eq!((fault.code, folder.names()), ("output-exists", vec!["out".to_owned()]));
    }

    #[test]
    fn what_is_somebody_elses_is_refused_by_name_and_stays() {
        let folder = Folder::new("folder-foreign");
        std::fs::create_dir(folder.path("out")).unwrap();
        open(&folder, OverwritePolicy::Keep).unwrap().write(&set(&["tile_0"]), "list").unwrap();
        folder.file("out/notes.txt", "mine");
        let Err(fault) = open(&folder, OverwritePolicy::Replace) else { panic!("replaced") };
        assert_eq!((fault.code, fault.lines[0].contains("notes.txt")), ("output-not-own", true));
        // The same if the file appears during the work, and after the last check.
        fs::remove_file(folder.path("out/notes.txt")).unwrap();
        let opened = open(&folder, OverwritePolicy::Replace).unwrap();
        folder.file("out/notes.txt", "mine");
        assert_eq!(opened.write(&set(&["tile_7"]), "list").unwrap_err().code, "output-not-own");
        let opened = |commit: fn(&OutputFolder) -> Result<(), Fault>| {
            fs::remove_file(folder.path("out/notes.txt")).unwrap();
            let opened = open(&folder, OverwritePolicy::Replace).unwrap();
            folder.file("out/notes.txt", "mine");
            commit(&opened)
        };
        assert_eq!(opened(OutputFolder::rename_both).unwrap_err().code, "output-not-own");
        assert_eq!(names(&folder.path("out")), ["list", "notes.txt", "tile_0"]);
        assert_eq!(folder.names(), ["out"]);
    }

    #[test]
    fn two_renames_do_what_an_exchange_does() {
        let folder = Folder::new("folder-renames");
        open(&folder, OverwritePolicy::Keep).unwrap().write(&set(&["tile_0"]), "list").unwrap();
        let opened = open(&folder, OverwritePolicy::Replace).unwrap();
        opened.temp.write("tile_1", b"new").unwrap();
        opened.rename_both().unwrap();
        drop(opened);
        assert_eq!(names(&folder.path("out")), ["tile_1"]);
        assert_eq!(folder.names(), ["out"]);
    }

    /// Left-overs of a kill between two renames and of others, beside folders that must not be removed.
    #[test]
    fn what_kills_leave_is_put_right() {
        let folder = Folder::new("folder-swept");
        for (name, file) in [
            (".chordal-out-12-0.old.tmp", "tile_9"),
            (".chordal-out-13-0.tmp", "tile_1"),
            (".chordal-out-13-1.tmp", "notes.txt"),
            (".chordal-other-13-0.tmp", "tile_1"),
            (".chordal-out-x-13-0.tmp", "tile_1"),
        ] {
            std::fs::create_dir(folder.path(name)).unwrap();
            folder.file(&format!("{name}/{file}"), "left");
        }
        let Err(fault) = open(&folder, OverwritePolicy::Keep) else { panic!("replaced") };
        assert_eq!(fault.code, "output-exists");
        assert_eq!(names(&folder.path("out")), ["tile_9"]);
        let rest = [".chordal-other-13-0.tmp", ".chordal-out-13-1.tmp", ".chordal-out-x-13-0.tmp", "out"];
        assert_eq!(folder.names(), rest);
        open(&folder, OverwritePolicy::Replace).unwrap().write(&set(&["tile_0"]), "list").unwrap();
        assert_eq!(names(&folder.path("out")), ["list", "tile_0"]);
        assert_eq!(folder.names(), rest);
    }

    #[test]
    fn a_second_job_is_refused_while_the_first_lasts() {
        let folder = Folder::new("folder-locked");
        let first = open(&folder, OverwritePolicy::Keep).unwrap();
        let Err(fault) = open(&folder, OverwritePolicy::Replace) else { panic!("two jobs") };
        assert_eq!(fault.code, "output-in-use");
        first.write(&set(&["tile_0"]), "list").unwrap();
        assert_eq!(folder.names(), ["out"]);
    }
}
