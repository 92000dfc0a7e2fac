//! The files of VTK that hold surfaces: PolyData and UnstructuredGrid as XML (`.vtp`, `.vtu`), and the legacy form
//! (`.vtk`).
mod array_place;
mod attributes;
mod cell_list;
mod cell_types;
mod data_array;
mod encoded_bytes;
mod legacy_arrays;
mod legacy_read;
mod legacy_reader;
mod lz4;
mod names;
mod number_array;
mod scene;
mod surface;
mod vtp_layout;
mod write;
mod write_polygons;
mod xml_document;
mod xml_read;

pub use legacy_read::read;
pub(crate) use write::keeps;
pub use write::write;
pub use write_polygons::write_polygons;
pub use xml_read::read as read_xml;

/// The start of the first line of a legacy file, in small letters.
const LEGACY_MAGIC: &[u8] = b"# vtk datafile version";

/// Whether the content begins as a legacy file does.
pub(crate) fn looks_legacy(bytes: &[u8]) -> bool {
    bytes.get(..LEGACY_MAGIC.len()).is_some_and(|start| start.eq_ignore_ascii_case(LEGACY_MAGIC))
}

/// Whether the text is a VTK XML file of a data set.
pub(crate) fn looks_xml(text: &[u8], data_set: &str) -> bool {
    /// Where the root of a file begins: a declaration and a comment may stand before it.
    const LOOKED_AT: usize = 4096;
    let head = &text[..text.len().min(LOOKED_AT)];
    let Some(root) = memchr::memmem::find(head, b"<VTKFile") else { return false };
    let tag = &text[root..];
    let tag = &tag[..memchr::memchr(b'>', &tag[..tag.len().min(LOOKED_AT)]).unwrap_or(0)];
    text.starts_with(b"<")
        && ['"', '\''].iter().any(|quote| {
            memchr::memmem::find(tag, format!("type={quote}{data_set}{quote}").as_bytes()).is_some()
        })
}
