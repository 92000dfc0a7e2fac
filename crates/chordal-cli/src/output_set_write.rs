//! Writing a document with files beside it that it names: all are written aside and synced, then renamed, the
//! document last.
//!
//! They are refused together where one of them should not be written, before any is renamed. Where they replace
//! older ones, the older document goes first: a kill between the renames leaves no document whose files are
//! another's. A rename that fails undoes those before it.
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
    /// Writes what a verb made: as one file by `one`, or as several by `several`, which takes the stem of their
    /// names. Returns the number of bytes. The files that the certificate says were read are not replaced.
    ///
    /// # Errors
    /// When the output cannot, or should not, be written; then whatever had the names before still has them.
    pub fn write<'a>(
        &self,
        to: &SetPlace<'_>,
        certificate: &Certificate,
        one: OutputWriter,
        several: impl FnOnce(&str) -> Result<FileSet<'a>, WriteError>,
    ) -> Result<u64, Fault> {
        let SetPlace { target, input, console, names_files } = *to;
        let OutputTarget::File { path, existing } = target else {
            if names_files {
                let message = "the materials of an OBJ are in files beside it, which stdout cannot hold: they were left out";
                console.warn(&target.name(), &[message]);
            }
            return target.write(one);
        };
        if !self.separate && !names_files {
            return target.write(one);
        }
        let stem = path.file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default();
        let set = several(&stem).map_err(|error| unwritable(&target.name(), &error))?;
        let folder = parent(input);
        let mut read: Vec<PathBuf> =
            certificate.input.files.iter().map(|file| folder.join(&file.path)).collect();
        read.push(input.to_owned());
        write_set(path, *existing, &set, &read)
    }
}

/// Where a verb writes what it made.
pub struct SetPlace<'a> {
    /// The document.
    pub target: &'a OutputTarget,
    /// The file that was read.
    pub input: &'a Path,
    /// What is left out is told there.
    pub console: &'a Console,
    /// Whether the document names files beside it without being asked to.
    pub names_files: bool,
}

/// A file that was written aside.
struct StagedFile {
    new: TempOutput,
    path: PathBuf,
    /// The name of the older file while others are renamed, if there is one.
    old: Option<TempOutput>,
}

/// Writes a document and the files beside it, none of which may be one that was read.
fn write_set(
    document: &Path,
    existing: OverwritePolicy,
    set: &FileSet<'_>,
    read: &[PathBuf],
) -> Result<u64, Fault> {
    let folder = parent(document);
    let beside = set.beside.iter().map(|file| (folder.join(&file.name), &*file.bytes));
    let all: Vec<(PathBuf, &[u8])> = beside.chain([(document.to_owned(), &*set.document)]).collect();
    let refuse = || {
        all.iter().try_for_each(|(path, _)| {
            if read.iter().any(|input| is_same_file(input, path)) {
                let message = format!("{}: the output is a file of the input", path.display());
                return Err(Fault::output("output-is-input", message));
            }
            refuse_occupied(path, existing)
        })
    };
    refuse()?;
    let mut bytes = 0;
    let mut staged = Vec::with_capacity(all.len());
    for (path, content) in &all {
        let mut new = TempOutput::create(path)?;
        let written = new.fill(&mut |out| Ok(out.write_all(content)?));
        bytes += written.map_err(|error| unwritable(&path.display().to_string(), &error))?;
        let old = if path.exists() { Some(TempOutput::create(path)?) } else { None };
        staged.push(StagedFile { new, path: path.clone(), old });
    }
    // Asked again: writing may have taken long.
    refuse()?;
    signal::without_interruption(|| commit(&staged, existing))?;
    if let Some(last) = staged.last() {
        sync_folder(&last.path);
    }
    Ok(bytes)
}

/// Gives all files their names, or none.
fn commit(staged: &[StagedFile], existing: OverwritePolicy) -> Result<(), Fault> {
    let mut done: Vec<(&Path, &Path)> = Vec::new();
    let renamed = rename_all(staged, existing, &mut done);
    renamed.map_err(|(path, error)| {
        // What cannot be undone stays under a name that says what it is.
        done.iter().rev().for_each(|(from, to)| drop(fs::rename(to, from)));
        match error.kind() {
            io::ErrorKind::AlreadyExists => exists(path),
            _ => Fault::output("unwritable", format!("{}: {}", path.display(), plainly(&error))),
        }
    })
}

/// Renames, and says what was renamed.
fn rename_all<'a>(
    staged: &'a [StagedFile],
    existing: OverwritePolicy,
    done: &mut Vec<(&'a Path, &'a Path)>,
) -> Result<(), (&'a Path, io::Error)> {
    // The document is the last: the first to go, and the last to come.
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
        // By the time of the renames, a folder has the name of the second.
        fs::create_dir(&paths[1]).unwrap();
        assert_eq!(commit(&staged, OverwritePolicy::Replace).unwrap_err().code, "unwritable");
        drop(staged);
        assert_eq!(folder.names(), ["a.bin", "a.gltf", "b.bin"]);
        for kept in [&paths[0], &paths[2]] {
            assert_eq!(fs::read(kept).unwrap(), b"old");
        }
    }
}
