//! The files of VTK: surfaces as XML (PolyData `.vtp`, UnstructuredGrid `.vtu`) and in the legacy form
//! (`.vtk`), and volumes as XML (ImageData `.vti`).
pub(crate) mod array_place;
mod attributes;
mod cell_list;
mod cell_types;
mod data_array;
pub(crate) mod encoded_bytes;
mod image_extent;
mod image_pieces;
pub(crate) mod image_read;
mod legacy_arrays;
mod legacy_image;
mod legacy_read;
mod legacy_reader;
mod lz4;
mod names;
pub(crate) mod number_array;
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

/// The start of the first line of a legacy file, in lower case.
const LEGACY_MAGIC: &[u8] = b"# vtk datafile version";

/// Whether the content begins like a legacy file.
pub(crate) fn looks_legacy(bytes: &[u8]) -> bool {
    bytes.get(..LEGACY_MAGIC.len()).is_some_and(|start| start.eq_ignore_ascii_case(LEGACY_MAGIC))
}

/// The bytes in which the root's tag must be. Chosen: a declaration and a comment may precede it.
const LOOKED_AT: usize = 4096;

/// The text from the root of a VTK XML file on, if it is one.
fn root(text: &[u8]) -> Option<&[u8]> {
    let head = &text[..text.len().min(LOOKED_AT)];
    let root = memchr::memmem::find(head, b"<VTKFile").filter(|_| text.starts_with(b"<"))?;
    Some(&text[root..])
}

/// Whether the text is a VTK XML file of any data set.
pub(crate) fn looks_any_xml(text: &[u8]) -> bool {
    root(text).is_some()
}

/// Whether the text is a VTK XML file of a data set.
pub(crate) fn looks_xml(text: &[u8], data_set: &str) -> bool {
    root(text).is_some_and(|tag| {
        let tag = &tag[..memchr::memchr(b'>', &tag[..tag.len().min(LOOKED_AT)]).unwrap_or(0)];
        ['"', '\''].iter().any(|quote| {
            memchr::memmem::find(tag, format!("type={quote}{data_set}{quote}").as_bytes()).is_some()
        })
    })
}
