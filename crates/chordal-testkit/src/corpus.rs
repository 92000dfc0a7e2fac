//! The corpus: files of other projects, which are not part of this repository. `CHORDAL_DATA` is the path of
//! its folder; the default is `../shared/data` beside the checkout. A test whose files are missing prints so
//! and ends.
use std::path::{Path, PathBuf};

/// The folder of the corpus.
fn root() -> PathBuf {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data");
    std::env::var_os("CHORDAL_DATA").map_or_else(|| beside.into(), PathBuf::from)
}

/// A file or folder of the corpus by its path, `""` being the corpus itself; `None` with a message on stderr
/// if it does not exist.
pub fn find(path: &str) -> Option<PathBuf> {
    let full = root().join(path);
    if full.exists() {
        return Some(full);
    }
    eprintln!("SKIPPED: there is no {}; set CHORDAL_DATA to the folder of the foreign files", full.display());
    None
}

/// Every file below a folder, sorted.
///
/// # Panics
/// If a folder cannot be read.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let (mut open, mut files) = (vec![folder.to_owned()], Vec::new());
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() { open.push(path) } else { files.push(path) }
        }
    }
    files.sort();
    files
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Folder;

    #[test]
    fn what_is_not_there_is_nothing() {
        assert_eq!(find("no such folder/no such file"), None);
    }

    #[test]
    fn files_of_all_folders_come_in_order() {
        let folder = Folder::new("corpus");
        for name in ["b", "a/c", "a/b/d"] {
            std::fs::create_dir_all(folder.path(name).parent().unwrap()).unwrap();
            folder.file(name, "");
        }
        assert_eq!(files(folder.as_ref()), ["a/b/d", "a/c", "b"].map(|name| folder.path(name)));
    }
}
