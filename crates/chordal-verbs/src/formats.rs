//! What the verbs need to know of formats.
use chordal::explicit::Topology;
use chordal_io::Format;

/// Whether triangles can be written in that format.
///
/// ```
/// use chordal_io::Format;
/// use chordal_verbs::formats::holds_triangles;
/// assert!(holds_triangles(Format::Glb) && !holds_triangles(Format::Bpt));
/// ```
#[must_use]
pub fn holds_triangles(format: Format) -> bool {
    matches!(format, Format::Obj | Format::Ply | Format::Stl | Format::Glb)
}

/// The names of the formats that triangles can be written in, as in "obj, ply, stl, glb".
#[must_use]
pub fn mesh_names() -> String {
    let names: Vec<_> =
        Format::all().filter(|format| holds_triangles(*format)).map(|f| f.to_string()).collect();
    names.join(", ")
}

/// What makes two vertices of such a file one position: the file's own indices where it has some, else their bits.
#[must_use]
pub fn topology(format: Format) -> Topology {
    match format {
        Format::Stl | Format::Glb => Topology::Positions,
        Format::Obj | Format::Ply | Format::Bpt | Format::Teaset | Format::Json => Topology::Indices,
    }
}
