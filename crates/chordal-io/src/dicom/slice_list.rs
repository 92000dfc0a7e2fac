//! The list of the files in a folder, which represents the slices in it.

/// The first line of a list.
pub(super) const FIRST: &[u8] = b"#dicom-slices\n";

/// The list of the files in a folder, in the form that [`super::read_with`] takes: a folder has no bytes, but
/// its list has. Names with a line break cannot be listed and are left out.
#[must_use]
pub fn slice_list<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<u8> {
    let mut list = FIRST.to_vec();
    for name in names.into_iter().filter(|name| !name.contains(['\n', '\r'])) {
        list.extend_from_slice(name.as_bytes());
        list.push(b'\n');
    }
    list
}

/// Whether bytes are a slice, or a list of slices.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    bytes.starts_with(FIRST) || super::elements::after_mark(bytes).is_some()
}
