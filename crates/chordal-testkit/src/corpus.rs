//! Files that others made, which are no part of this tree. `CHORDAL_DATA` says where their folder is; without
//! it they are looked for in `../shared/data` beside the checkout. A test that does not find its files says
//! so loudly and ends.
use std::path::{Path, PathBuf};

/// Where the folder of foreign files should be.
fn root() -> PathBuf {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data");
    std::env::var_os("CHORDAL_DATA").map_or_else(|| beside.into(), PathBuf::from)
}

/// A file or folder of the corpus by its path in there, `""` being the whole; `None`, and a loud word, where
/// it is not.
pub fn find(path: &str) -> Option<PathBuf> {
    let found = root().join(path);
    if found.exists() {
        return Some(found);
    }
    eprintln!("SKIPPED: there is no {}; CHORDAL_DATA says where the foreign files are", found.display());
    None
}

/// Every file below a folder, in order.
///
/// # Panics
/// Panics where a folder cannot be read.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let (mut open, mut found) = (vec![folder.to_owned()], Vec::new());
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() { open.push(path) } else { found.push(path) }
        }
    }
    found.sort();
    found
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
