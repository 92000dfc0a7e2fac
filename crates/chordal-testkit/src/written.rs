//! Files of the tree that tests compare with the tables that they are written from.
use std::path::{Path, PathBuf};

/// A path from the root of the tree.
#[must_use]
pub fn path_in_tree(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// Asserts that a file of the tree holds `text`; if the variable `switch` is set, it is written first.
///
/// # Panics
/// If it holds another text, or cannot be written.
pub fn assert_written(switch: &str, path: &str, text: &str) {
    let path = path_in_tree(path);
    if std::env::var_os(switch).is_some() {
        std::fs::write(&path, text).expect("a writable file");
    }
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(written == text, "{} is not what the table says: {switch}=1 writes it anew", path.display());
}
