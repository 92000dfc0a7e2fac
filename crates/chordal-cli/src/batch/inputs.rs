//! The files of a batch: patterns and folders, expanded, each with its path below the output folder.
use super::glob::{has_wildcard, matches};
use crate::fault::{Fault, plainly};
use chordal_io::Format;
use chordal_verbs::extension;
use std::collections::BTreeSet;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

/// One input file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct BatchFile {
    /// The path below the output folder, without `.` and `..`.
    pub relative: PathBuf,
    /// The path of the file.
    pub path: PathBuf,
}

/// The files, ordered by their relative paths.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BatchInputs {
    /// The files, each once.
    pub files: BTreeSet<BatchFile>,
    /// The number of files in given folders that were skipped because of an unknown extension.
    pub left_out: u64,
}

impl BatchInputs {
    /// Expands files, folders, and patterns whose parts contain `*` and `?`, or are `**` for any folders.
    /// Nothing below `output` is an input, and wildcards do not follow links to folders. The relative path of
    /// a file is its path as given or found; with `base` relative to it; without `base`, if the path is
    /// absolute or contains `..`, relative to its part before the first wildcard.
    ///
    /// # Errors
    /// If nothing matches, a folder cannot be read, or a file is not below `base`.
    pub fn expand(inputs: &[PathBuf], base: Option<&Path>, output: &Path) -> Result<Self, Fault> {
        let mut walk = FolderWalk { output: output.canonicalize().ok(), ..FolderWalk::default() };
        let mut batch = Self::default();
        for input in inputs {
            walk.found.clear();
            let start = walk.expand_one(input)?;
            if walk.found.is_empty() {
                let message = format!("{}: no file matches", input.display());
                return Err(Fault::input("no-input", message));
            }
            for path in std::mem::take(&mut walk.found) {
                let relative = relative_path(&path, &start, base)?;
                batch.files.insert(BatchFile { relative, path });
            }
        }
        batch.left_out = walk.left_out;
        Ok(batch)
    }
}

/// The path of a file's output below the output folder.
fn relative_path(path: &Path, start: &Path, base: Option<&Path>) -> Result<PathBuf, Fault> {
    let path = plain(path);
    let below = match base {
        Some(base) => path.strip_prefix(plain(base)).map_err(|_| {
            Fault::usage(format!("{} is not below --base {}", path.display(), base.display()))
        })?,
        None if path.components().all(|part| matches!(part, Component::Normal(_))) => &path,
        None => path.strip_prefix(plain(start)).unwrap_or(&path),
    };
    if below.components().all(|part| matches!(part, Component::Normal(_))) {
        return Ok(below.to_owned());
    }
    Err(Fault::usage(format!("{}: the path leads out of its folder with ..: set --base", path.display())))
}

/// A path without `.`.
fn plain(path: &Path) -> PathBuf {
    path.components().filter(|part| *part != Component::CurDir).collect()
}

/// The state of a search through folders.
#[derive(Debug, Default)]
struct FolderWalk {
    /// The output folder, which is not entered.
    output: Option<PathBuf>,
    found: BTreeSet<PathBuf>,
    left_out: u64,
}

impl FolderWalk {
    /// Expands one name, and returns the part of it without wildcards.
    fn expand_one(&mut self, input: &Path) -> Result<PathBuf, Fault> {
        let io_fault = |error: &io::Error| unreadable(input, error);
        // As it is first: the name of a file may contain wildcards itself.
        match fs::metadata(input) {
            Ok(found) if found.is_dir() => {
                self.known_files(input)?;
                return Ok(input.to_owned());
            }
            Ok(_) => {
                self.found.insert(input.to_owned());
                return Ok(input.parent().unwrap_or(Path::new("")).to_owned());
            }
            Err(error) if !input.to_str().is_some_and(has_wildcard) => return Err(io_fault(&error)),
            Err(_) => {}
        }
        let parts: Vec<&OsStr> = input.components().map(Component::as_os_str).collect();
        let is_wild = |part: &&OsStr| part.to_str().is_some_and(has_wildcard);
        let n_fixed = parts.iter().position(is_wild).unwrap_or(parts.len());
        let start: PathBuf = parts[..n_fixed].iter().collect();
        self.expand_parts(&start, &parts[n_fixed..])?;
        Ok(start)
    }

    fn expand_parts(&mut self, folder: &Path, parts: &[&OsStr]) -> Result<(), Fault> {
        let Some((part, rest)) = parts.split_first() else { return Ok(()) };
        let Some(pattern) = part.to_str().filter(|text| has_wildcard(text)) else {
            let path = folder.join(part);
            // A path that does not exist does not match.
            if rest.is_empty() && fs::metadata(&path).is_ok_and(|found| !found.is_dir()) {
                self.found.insert(path);
            } else if !rest.is_empty() && path.is_dir() {
                self.expand_parts(&path, rest)?;
            }
            return Ok(());
        };
        if pattern == "**" {
            // At the end of a pattern it stands for all files below.
            let any = [OsStr::new("*")];
            self.expand_parts(folder, if rest.is_empty() { &any } else { rest })?;
        }
        for (name, path, kind) in entries(folder)? {
            let Some(name) = name.to_str() else { continue };
            match kind {
                EntryKind::Folder if pattern == "**" && matches("*", name) && !self.is_output(&path) => {
                    self.expand_parts(&path, parts)?;
                }
                EntryKind::Folder
                    if !rest.is_empty()
                        && pattern != "**"
                        && matches(pattern, name)
                        && !self.is_output(&path) =>
                {
                    self.expand_parts(&path, rest)?;
                }
                EntryKind::File if rest.is_empty() && pattern != "**" && matches(pattern, name) => {
                    self.found.insert(path);
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Finds all files below a folder with the extension of a known format.
    fn known_files(&mut self, folder: &Path) -> Result<(), Fault> {
        for (name, path, kind) in entries(folder)? {
            let text = name.to_string_lossy();
            match kind {
                _ if text.starts_with('.') => {}
                EntryKind::Folder if !self.is_output(&path) => self.known_files(&path)?,
                EntryKind::File if is_known(&text) => {
                    self.found.insert(path);
                }
                EntryKind::File => self.left_out += 1,
                EntryKind::Folder | EntryKind::LinkToFolder => {}
            }
        }
        Ok(())
    }

    fn is_output(&self, path: &Path) -> bool {
        self.output.is_some() && path.canonicalize().ok() == self.output
    }
}

/// Whether a file with this extension is a shape. A slice is only a part of one.
fn is_known(name: &str) -> bool {
    let format = extension(name).and_then(Format::from_packed_extension);
    format.is_some_and(|format| !format.is_slice())
}

/// The kind of an entry of a folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EntryKind {
    Folder,
    /// Never followed by a search, since it may lead to an ancestor.
    LinkToFolder,
    /// A file, a link to one, or a dangling link, which fails when it is read.
    File,
}

/// The entries of a folder, in order.
fn entries(folder: &Path) -> Result<Vec<(OsString, PathBuf, EntryKind)>, Fault> {
    let is_here = folder.as_os_str().is_empty();
    let failed = |error: io::Error| unreadable(folder, &error);
    let mut entries = Vec::new();
    match fs::read_dir(if is_here { Path::new(".") } else { folder }) {
        // The part before the first wildcard is no folder, so nothing matches.
        Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => {}
        Err(error) => return Err(failed(error)),
        Ok(list) => {
            for entry in list {
                let entry = entry.map_err(failed)?;
                let (name, path) = (entry.file_name(), folder.join(entry.file_name()));
                let kind = entry.file_type().map_err(failed)?;
                let kind = match (kind.is_dir(), kind.is_symlink()) {
                    (true, _) => EntryKind::Folder,
                    (_, true) if path.is_dir() => EntryKind::LinkToFolder,
                    _ => EntryKind::File,
                };
                entries.push((name, path, kind));
            }
        }
    }
    // Systems list them in any order.
    entries.sort_by(|a, b| a.0.cmp(&b.0));
    Ok(entries)
}

fn unreadable(path: &Path, error: &io::Error) -> Fault {
    Fault::input("unreadable", format!("{}: {}", path.display(), plainly(error)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Folder;

    fn expanded(folder: &Folder, patterns: &[&str]) -> Vec<String> {
        let patterns: Vec<PathBuf> = patterns.iter().map(|pattern| folder.path(pattern)).collect();
        let inputs = BatchInputs::expand(&patterns, Some(folder.as_ref()), &folder.path("out")).unwrap();
        inputs.files.iter().map(|file| file.relative.display().to_string()).collect()
    }

    #[test]
    fn patterns_and_folders_name_the_files_below_them() {
        let folder = Folder::new("batch-expand");
        for name in ["a/b/c", "out", ".hidden", "a/d.obj"] {
            fs::create_dir_all(folder.path(name)).unwrap();
        }
        for name in
            ["x.obj", "a/y.obj", "a/b/c/z.obj", "a/b/n.txt", "out/o.obj", ".hidden/h.obj", "a/[1].obj"]
        {
            fs::write(folder.path(name), "").unwrap();
        }
        assert_eq!(expanded(&folder, &["**/*.obj"]), ["a/[1].obj", "a/b/c/z.obj", "a/y.obj", "x.obj"]);
        assert_eq!(expanded(&folder, &["*.obj", "x.obj", "./x.obj"]), ["x.obj"]);
        assert_eq!(expanded(&folder, &["a/**/z.obj", "?/?.obj"]), ["a/b/c/z.obj", "a/y.obj"]);
        assert_eq!(expanded(&folder, &["a/b/**"]), ["a/b/c/z.obj", "a/b/n.txt"]);
        assert_eq!(expanded(&folder, &["a"]), ["a/[1].obj", "a/b/c/z.obj", "a/y.obj"]);
        let none = BatchInputs::expand(&[folder.path("*.ply")], None, &folder.path("out")).unwrap_err();
        assert_eq!(none.code, "no-input");
    }

    #[test]
    fn places_are_names_as_given_or_below_the_part_without_wildcards() {
        let at = |path: &str, start: &str, base: Option<&str>| {
            relative_path(Path::new(path), Path::new(start), base.map(Path::new)).ok()
        };
        let some = |text: &str| Some(PathBuf::from(text));
        assert_eq!(at("./a/b.obj", "a", None), some("a/b.obj"));
        assert_eq!(at("../a/b/c.obj", "../a", None), some("b/c.obj"));
        assert_eq!(at("/a/b/c.obj", "/a", None), some("b/c.obj"));
        assert_eq!(at("a/b/c.obj", "a", Some("./a")), some("b/c.obj"));
        assert_eq!(at("a/b/c.obj", "a", Some("d")), None);
        assert_eq!(at("../a/../../c.obj", "../a", None), None);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_a_folder_around_it_is_not_entered() {
        let folder = Folder::new("batch-loop");
        fs::create_dir_all(folder.path("a/b")).unwrap();
        fs::write(folder.path("a/b/x.obj"), "").unwrap();
        std::os::unix::fs::symlink(folder.path("a"), folder.path("a/b/loop")).unwrap();
        std::os::unix::fs::symlink(folder.path("a/b/x.obj"), folder.path("a/link.obj")).unwrap();
        for pattern in ["a", "**/*.obj", "a/**"] {
            assert_eq!(expanded(&folder, &[pattern]), ["a/b/x.obj", "a/link.obj"], "{pattern}");
        }
    }
}
