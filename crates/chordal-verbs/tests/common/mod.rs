//! The files of the corpus that the tests of verbs share.
use chordal_testkit::corpus;
use std::path::PathBuf;

/// All files of at most so many bytes in the corpus' folders of meshes, in order; empty, and said so, where
/// there is no corpus.
pub fn files(most_bytes: u64) -> Vec<PathBuf> {
    let folders = ["mesh", "topology", "batch"].into_iter().filter_map(corpus::find);
    let mut found: Vec<PathBuf> = folders.flat_map(|folder| corpus::files(&folder)).collect();
    found.retain(|path| {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
        ["obj", "ply", "stl", "glb"].contains(&extension.as_str())
            && path.metadata().unwrap().len() <= most_bytes
    });
    found.sort();
    found
}
