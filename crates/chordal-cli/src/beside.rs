//! Reads files that an input references, but none outside of its folder.
use crate::fault::{Fault, plainly};
use crate::input::InputSource;
use std::io::ErrorKind;
use std::path::{Component, Path, PathBuf};

/// All bytes of the file at `path`, relative to the folder of the file `first`; at most `limit`.
///
/// # Errors
/// One sentence, if it is no regular file, cannot be read, is larger than `limit`, changes while it is read,
/// or is reached by a link out of the folder.
pub fn read_beside(first: &Path, path: &str, limit: u64) -> Result<Vec<u8>, String> {
    let full = below(first.parent().unwrap_or(Path::new("")), path)?;
    let without_name = |fault: Fault| {
        let line = fault.lines.into_iter().next().unwrap_or_default();
        line.rsplit_once(": ").map_or(line.clone(), |(_, what)| what.to_owned())
    };
    InputSource::File(full).read(limit).map_err(without_name)
}

/// As [`read_beside`], in the first of several folders that has the file; `None` if none has.
pub fn read_allowed(folders: &[PathBuf], path: &str, limit: u64) -> Option<Result<Vec<u8>, String>> {
    let folder = folders.iter().find(|folder| folder.join(path).exists())?;
    Some(read_beside(&folder.join("file"), path, limit))
}

/// The resolved path of a file below `folder`, refused if links lead out of it.
fn below(folder: &Path, path: &str) -> Result<PathBuf, String> {
    // The parent of a file in the working folder is the empty path.
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let resolved = |path: &Path| path.canonicalize().map_err(|error| plainly(&error));
    // WASI cannot resolve paths, and its host gives the module one folder, in which the page makes no links.
    let is_unsupported = |error: std::io::Error| error.kind() == ErrorKind::Unsupported;
    if cfg!(target_os = "wasi") || folder.canonicalize().is_err_and(is_unsupported) {
        let is_plain = Path::new(path).components().all(|part| matches!(part, Component::Normal(_)));
        return if is_plain {
            Ok(folder.join(path))
        } else {
            Err("the path leads out of the folder".to_owned())
        };
    }
    // Both sides are resolved: the folder itself may be reached by a link, which is no way out.
    let full = resolved(&folder.join(path))?;
    if full.starts_with(resolved(folder)?) {
        Ok(full)
    } else {
        Err("the path is a link that leads out of the folder".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Folder;

    #[test]
    fn links_out_of_the_folder_and_what_is_no_file_are_refused() {
        let outside = Folder::new("outside");
        let secret = outside.file("secret.bin", "secret");
        let folder = Folder::new("beside");
        let first = folder.file("a.gltf", "{}");
        let near = folder.file("a.bin", "near");
        let read = |path: &str, limit: u64| read_beside(Path::new(&first), path, limit);
        assert_eq!(read("a.bin", 100).unwrap(), b"near");
        assert!(read("a.bin", 3).unwrap_err().contains("limit"));
        assert_eq!(read("b.bin", 100).unwrap_err(), "no such file or directory");
        std::fs::create_dir(folder.path("c")).unwrap();
        assert!(read("c", 100).unwrap_err().contains("a folder"));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(&secret, folder.path("d.bin")).unwrap();
            assert!(read("d.bin", 100).unwrap_err().contains("out of the folder"));
            std::os::unix::fs::symlink(&near, folder.path("e.bin")).unwrap();
            assert_eq!(read("e.bin", 100).unwrap(), b"near");
        }
        #[cfg(not(unix))]
        assert!(!secret.is_empty() && !near.is_empty());
    }
}
