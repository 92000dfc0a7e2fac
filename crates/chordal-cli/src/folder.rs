//! Folders as inputs: a series of DICOM slices, or a tileset.
use chordal_io::{Format, dicom};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The list of the files in a folder, if one of them is a DICOM slice.
pub fn list_slices(folder: &Path) -> Option<Vec<u8>> {
    if !folder.is_dir() {
        return None;
    }
    let mut names = Vec::new();
    for entry in folder.read_dir().ok()?.flatten() {
        let is_file = std::fs::metadata(entry.path()).is_ok_and(|metadata| metadata.is_file());
        let name = entry.file_name().to_str().map(str::to_owned);
        names.extend(name.filter(|name| is_file && !name.starts_with('.')));
    }
    names.sort();
    let has_slice = names.iter().any(|name| is_slice(&folder.join(name)));
    has_slice.then(|| dicom::slice_list(names.iter().map(String::as_str)))
}

/// The path of a folder's `tileset.json`, as written by `lod`.
pub fn tileset_in(folder: &Path) -> Option<PathBuf> {
    let list = folder.join("tileset.json");
    (folder.is_dir() && list.is_file()).then_some(list)
}

fn is_slice(path: &Path) -> bool {
    /// Derived: a DICOM file begins with a preamble of 128 bytes and the magic `DICM`.
    const HEAD: u64 = 132;
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head));
    read.is_ok() && Format::sniff(&head).is_some_and(Format::is_slice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Folder;

    #[test]
    fn a_folder_is_listed_where_it_holds_a_slice() {
        let folder = Folder::new("slices");
        folder.file("b.txt", "text");
        assert_eq!(list_slices(folder.as_ref()), None);
        let slice = [&[0; 128][..], b"DICM"].concat();
        std::fs::write(folder.path("a"), slice).unwrap();
        std::fs::create_dir(folder.path("c")).unwrap();
        assert_eq!(list_slices(folder.as_ref()).unwrap(), dicom::slice_list(["a", "b.txt"]));
        assert_eq!(list_slices(&folder.path("a")), None);
    }
}
