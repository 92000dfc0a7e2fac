//! The files of the corpus that the tests of verbs share.
use std::path::{Path, PathBuf};

/// All files of at most so many bytes below the corpus' folders of meshes, in order; empty, and said so, where there is
/// no corpus.
pub fn files(most_bytes: u64) -> Vec<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let root = std::env::var_os("CHORDAL_DATA").map_or(beside, Into::into);
    let mut folders: Vec<PathBuf> =
        ["mesh", "topology", "batch"].iter().map(|name| root.join(name)).collect();
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            let path = entry.path();
            let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
            if path.is_dir() {
                folders.push(path);
            } else if ["obj", "ply", "stl", "glb"].contains(&extension.as_str())
                && entry.metadata().unwrap().len() <= most_bytes
            {
                found.push(path);
            }
        }
    }
    if found.is_empty() {
        eprintln!("SKIPPED: no corpus at {}; set CHORDAL_DATA to where it is", root.display());
    }
    found.sort();
    found
}
