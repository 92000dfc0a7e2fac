//! Writes a document with the files that it references: all are written under temporary names and synced,
//! then renamed, the document last.
//!
//! If one of them may not be written, all are refused before any is renamed. If they replace old files, the
//! old document is moved away first: a kill between the renames never leaves a document with files of another
//! one. A rename that fails undoes those before it.
//!
//! ```text
//! move away:     a.gltf, a.bin     (the old document first)
//! put in place:  a.bin, a.gltf     (the new document last)
//! ```
use crate::console::Console;
use crate::fault::{Fault, plainly};
use crate::output::OutputTarget;
use crate::output_set::OutputSetArgs;
use crate::overwrite::{OverwritePolicy, exists, is_same_file, parent, refuse_occupied};
use crate::signal;
use crate::temp_output::{
    OutputWriter, TempOutput, keep_permissions, rename_to_new, sync_folder, unwritable,
};
use chordal_io::{FileSet, WriteError};
use chordal_verbs::report::Certificate;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

impl OutputSetArgs {
    /// Writes the result of a verb: as one file by `one`, or as several by `several`, which takes the stem of
    /// their names. Returns the number of bytes. Files that were read, as the certificate lists them, are not
    /// replaced.
    ///
    /// # Errors
    /// If the output cannot, or may not, be written; then existing files are unchanged.
    pub fn write<'a>(
        &self,
        to: &SetPlace<'_>,
        certificate: &Certificate,
        one: OutputWriter,
        several: impl FnOnce(&str) -> Result<FileSet<'a>, WriteError>,
    ) -> Result<u64, Fault> {
        let SetPlace { target, input, beside, console, names_files } = *to;
        let OutputTarget::File { path, existing } = target else {
            if names_files {
                let message = "the materials of an OBJ are separate files, which stdout cannot hold: they were left out";
                console.warn(&target.name(), &[message]);
            }
            return target.write(one);
        };
        // The stem of a file names those beside it, so that only several files need one.
        if !self.is_separate && !names_files {
            return target.write(one);
        }
        let stem = path.file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default();
        let set = several(&stem).map_err(|error| unwritable(&target.name(), &error))?;
        let folder = parent(input);
        let mut read: Vec<PathBuf> =
            certificate.input.files.iter().map(|file| folder.join(&file.path)).collect();
        // Files below an allowed folder are relative to that one.
        read.extend(beside.iter().cloned().chain([input.to_owned()]));
        write_set(path, *existing, &set, &read)
    }
}

/// The destination of a verb's result.
pub struct SetPlace<'a> {
    /// The document.
    pub target: &'a OutputTarget,
    /// The file that was read.
    pub input: &'a Path,
    /// The possible paths of the files that it references.
    pub beside: &'a [PathBuf],
    /// Prints warnings about omitted files.
    pub console: &'a Console,
    /// Whether the document references other files even without `--separate`.
    pub names_files: bool,
}

/// A file that was written under a temporary name.
struct StagedFile {
    new: TempOutput,
    path: PathBuf,
    /// The temporary name of the old file while others are renamed, if there is one.
    old: Option<TempOutput>,
}

/// Writes a document and its files, none of which may be one that was read.
fn write_set(
    document: &Path,
    existing: OverwritePolicy,
    set: &FileSet<'_>,
    read: &[PathBuf],
) -> Result<u64, Fault> {
    let folder = parent(document);
    let beside = set.beside.iter().map(|file| (folder.join(&file.name), &*file.bytes));
    let files: Vec<(PathBuf, &[u8])> = beside.chain([(document.to_owned(), &*set.document)]).collect();
    let refuse = || {
        files.iter().try_for_each(|(path, _)| {
            if read.iter().any(|input| is_same_file(input, path)) {
                let message = format!("{}: the output is a file of the input", path.display());
                return Err(Fault::output("output-is-input", message));
            }
            refuse_occupied(path, existing)
        })
    };
    refuse()?;
    let mut bytes = 0;
    let mut staged = Vec::with_capacity(files.len());
    for (path, content) in &files {
        let mut new = TempOutput::create(path)?;
        let written = new.fill(&mut |out| Ok(out.write_all(content)?));
        bytes += written.map_err(|error| unwritable(&path.display().to_string(), &error))?;
        // The place for the old file is an empty file of this process, so that no other one can take its
        // name before the rename replaces it.
        let old = if path.exists() { Some(TempOutput::create(path)?) } else { None };
        staged.push(StagedFile { new, path: path.clone(), old });
    }
    // Checked again, since it may have changed during the writing.
    refuse()?;
    signal::without_interruption(|| commit(&staged, existing))?;
    if let Some(last) = staged.last() {
        // All are in one folder, so that one sync is for all of their names.
        sync_folder(&last.path);
    }
    Ok(bytes)
}

/// Puts all files in place, or none.
fn commit(staged: &[StagedFile], existing: OverwritePolicy) -> Result<(), Fault> {
    let mut done: Vec<(&Path, &Path)> = Vec::new();
    let renamed = rename_all(staged, existing, &mut done);
    renamed.map_err(|(path, error)| {
        undo(staged, &done);
        match error.kind() {
            io::ErrorKind::AlreadyExists => exists(path),
            _ => Fault::output("unwritable", format!("{}: {}", path.display(), plainly(&error))),
        }
    })
}

/// Undoes renames. An old file whose rename cannot be undone keeps its recognizable temporary name.
fn undo(staged: &[StagedFile], done: &[(&Path, &Path)]) {
    for (from, to) in done.iter().rev() {
        if fs::rename(to, from).is_err() {
            staged
                .iter()
                .filter_map(|file| file.old.as_ref())
                .filter(|old| old.path() == *to)
                .for_each(TempOutput::keep);
        }
    }
}

/// Renames all files, and records each rename in `done`.
fn rename_all<'a>(
    staged: &'a [StagedFile],
    existing: OverwritePolicy,
    done: &mut Vec<(&'a Path, &'a Path)>,
) -> Result<(), (&'a Path, io::Error)> {
    // The document is last in the list: it is moved away first and put in place last.
    for file in staged.iter().rev() {
        if let Some(old) = &file.old {
            keep_permissions(&file.path, file.new.path());
            fs::rename(&file.path, old.path()).map_err(|error| (&*file.path, error))?;
            done.push((&file.path, old.path()));
        }
    }
    for file in staged {
        let (from, to) = (file.new.path(), &*file.path);
        match existing {
            OverwritePolicy::Replace => fs::rename(from, to),
            OverwritePolicy::Keep => rename_to_new(from, to),
        }
        .map_err(|error| (to, error))?;
        done.push((from, to));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_io::SideFile;
    use chordal_testkit::Folder;
    use std::borrow::Cow;

    fn set() -> FileSet<'static> {
        let file = |name: &str| SideFile { name: name.to_owned(), bytes: Cow::Borrowed(b"new") };
        FileSet { document: b"new".to_vec(), beside: vec![file("a.bin"), file("a_image_0.png")] }
    }

    #[test]
    fn one_file_that_exists_keeps_all_from_being_written() {
        let folder = Folder::new("set-exists");
        let old = folder.file("a_image_0.png", "old");
        let document = folder.path("a.gltf");
        let fault = write_set(&document, OverwritePolicy::Keep, &set(), &[]).unwrap_err();
        assert_eq!((fault.code, fault.lines[0].contains("a_image_0.png")), ("output-exists", true));
        assert_eq!(folder.names(), ["a_image_0.png"]);
        let fault =
            write_set(&document, OverwritePolicy::Replace, &set(), &[old.clone().into()]).unwrap_err();
        assert_eq!(fault.code, "output-is-input");
        assert_eq!(fs::read(&old).unwrap(), b"old");
        assert_eq!(write_set(&document, OverwritePolicy::Replace, &set(), &[]).unwrap(), 9);
        assert_eq!(folder.names(), ["a.bin", "a.gltf", "a_image_0.png"]);
        assert_eq!(fs::read(&old).unwrap(), b"new");
    }

    #[test]
    fn a_rename_that_fails_undoes_the_others() {
        let folder = Folder::new("set-undone");
        let paths = ["a.bin", "b.bin", "a.gltf"].map(|name| folder.path(name));
        fs::write(&paths[0], "old").unwrap();
        fs::write(&paths[2], "old").unwrap();
        let staged: Vec<StagedFile> = paths
            .iter()
            .map(|path| {
                let mut new = TempOutput::create(path).unwrap();
                new.fill(&mut |out| Ok(out.write_all(b"new")?)).unwrap();
                let old = path.exists().then(|| TempOutput::create(path).unwrap());
                StagedFile { new, path: path.clone(), old }
            })
            .collect();
        // A folder takes the name of the second file before the renames.
        fs::create_dir(&paths[1]).unwrap();
        assert_eq!(commit(&staged, OverwritePolicy::Replace).unwrap_err().code, "unwritable");
        drop(staged);
        assert_eq!(folder.names(), ["a.bin", "a.gltf", "b.bin"]);
        for kept in [&paths[0], &paths[2]] {
            assert_eq!(fs::read(kept).unwrap(), b"old");
        }
    }

    #[test]
    fn an_old_file_that_cannot_go_back_keeps_its_temporary_name() {
        let folder = Folder::new("set-not-undone");
        let path: PathBuf = folder.file("a.bin", "old").into();
        let old = TempOutput::create(&path).unwrap();
        fs::rename(&path, old.path()).unwrap();
        let kept = old.path().to_owned();
        // A folder takes the name of the file before it is back.
        fs::create_dir(&path).unwrap();
        let staged =
            [StagedFile { new: TempOutput::create(&path).unwrap(), path: path.clone(), old: Some(old) }];
        undo(&staged, &[(&path, &kept)]);
        drop(staged);
        assert_eq!(fs::read(&kept).unwrap(), b"old");
    }
}
