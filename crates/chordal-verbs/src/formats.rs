//! The names that people and reports use for formats.
use chordal::explicit::Topology;
use chordal_io::Format;

const NAMES: [(Format, &str); 7] = [
    (Format::Bpt, "bpt"),
    (Format::Teaset, "teaset"),
    (Format::PatchJson, "patch-json"),
    (Format::Obj, "obj"),
    (Format::Ply, "ply"),
    (Format::Stl, "stl"),
    (Format::Glb, "glb"),
];

/// All names, in the order in which help lists them.
pub fn names() -> impl Iterator<Item = &'static str> {
    NAMES.iter().map(|row| row.1)
}

/// The names of the formats that triangles can be written in.
pub fn mesh_names() -> impl Iterator<Item = &'static str> {
    NAMES.iter().filter(|row| holds_triangles(row.0)).map(|row| row.1)
}

/// The name of a format.
#[must_use]
pub fn name(format: Format) -> &'static str {
    NAMES.iter().find(|row| row.0 == format).map_or("unnamed", |row| row.1)
}

/// The format of a name.
///
/// ```
/// use chordal_verbs::formats;
/// assert!(formats::names().all(|name| formats::by_name(name).map(formats::name) == Some(name)));
/// assert_eq!(formats::by_name("docx"), None);
/// ```
#[must_use]
pub fn by_name(name: &str) -> Option<Format> {
    NAMES.iter().find(|row| row.1.eq_ignore_ascii_case(name)).map(|row| row.0)
}

/// Whether triangles can be written in that format.
#[must_use]
pub fn holds_triangles(format: Format) -> bool {
    matches!(format, Format::Obj | Format::Ply | Format::Stl | Format::Glb)
}

/// What makes two vertices of such a file one position: the file's own indices where it has some, else their bits.
#[must_use]
pub fn topology(format: Format) -> Topology {
    match format {
        Format::Stl | Format::Glb => Topology::Positions,
        Format::Obj | Format::Ply | Format::Bpt | Format::Teaset | Format::PatchJson => Topology::Indices,
    }
}
