//! `Folder`: a temporary folder of a test.
use std::path::{Path, PathBuf};

/// A temporary folder of a test, removed at its end.
#[derive(Debug)]
pub struct Folder(PathBuf);

impl Folder {
    /// An empty folder. `name` has to be unique among the tests of a program.
    ///
    /// # Panics
    /// If it cannot be created.
    pub fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("chordal-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("a folder for temporary files");
        Self(path)
    }

    /// The name of the folder.
    pub fn name(&self) -> &str {
        self.0.file_name().and_then(|name| name.to_str()).unwrap_or("")
    }

    /// The path of a file in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// The same as text.
    ///
    /// # Panics
    /// If the path of the system's temporary folder is not Unicode.
    pub fn text(&self, name: &str) -> String {
        self.path(name).to_str().expect("Unicode").to_owned()
    }

    /// Writes a file and returns its path as text.
    ///
    /// # Panics
    /// If it cannot be written.
    pub fn file(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        std::fs::write(self.path(name), content).expect("a writable file");
        self.text(name)
    }

    /// The sorted names of its entries.
    ///
    /// # Panics
    /// If it cannot be read.
    pub fn names(&self) -> Vec<String> {
        names(&self.0)
    }
}

impl AsRef<Path> for Folder {
    fn as_ref(&self) -> &Path {
        &self.0
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The sorted names of the entries of a folder.
///
/// # Panics
/// If it cannot be read.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<_> =
        entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("Unicode")).collect();
    names.sort();
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_gone_with_its_files() {
        let folder = Folder::new("gone");
        assert_eq!(folder.file("a", "b"), folder.text("a"));
        assert_eq!((folder.names(), folder.as_ref().is_dir()), (vec!["a".to_owned()], true));
        let path = folder.as_ref().to_owned();
        drop(folder);
        assert!(!path.exists());
    }
}
