//! What the verbs need to know of file formats.
use crate::Shape;
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

/// Whether polygons of any number of corners can be written in that format.
#[must_use]
pub fn holds_polygons(format: Format) -> bool {
    matches!(format, Format::Obj | Format::Ply)
}

/// The names of the formats that hold triangles, as in "obj, ply, stl, glb".
#[must_use]
pub fn mesh_names() -> String {
    let names: Vec<_> =
        Format::all().filter(|format| holds_triangles(*format)).map(|f| f.to_string()).collect();
    names.join(", ")
}

/// Whether polylines can be written in that format.
#[must_use]
pub fn holds_polylines(format: Format) -> bool {
    matches!(format, Format::Json | Format::Svg)
}

/// The names of the formats that `mesh` can write.
#[must_use]
pub fn output_names() -> String {
    let written = |format: &Format| holds_triangles(*format) || holds_polylines(*format);
    Format::all().filter(written).map(|f| f.to_string()).collect::<Vec<_>>().join(", ")
}

/// Refuses a format that cannot hold the shape, in a sentence with an alternative.
pub(crate) fn check_output(shape: &Shape, to: Format) -> Result<(), String> {
    match shape {
        _ if !holds_triangles(to) && !holds_polylines(to) => {
            Err(format!("{to} is only read; what can be written is {}", output_names()))
        }
        Shape::Patches { .. } | Shape::Scene(_) if !holds_triangles(to) => {
            Err(format!("{} become triangles, which {to} does not hold; {} do", shape.kind(), mesh_names()))
        }
        Shape::Field(implicit) if !holds_triangles(to) && implicit.field.tape().axes()[2] => Err(format!(
            "fields that depend on z become triangles, which {to} does not hold; {} do",
            mesh_names()
        )),
        Shape::Cage(_) if !holds_triangles(to) => {
            Err(format!("cages become polygons or triangles, which {to} does not hold; {} do", mesh_names()))
        }
        Shape::Volume(_) if !holds_triangles(to) => {
            Err(format!("volumes become triangles, which {to} does not hold; {} do", mesh_names()))
        }
        Shape::Curves(_) if !holds_polylines(to) => Err(format!(
            "curves in space enclose no area to fill with triangles: write polylines, to json instead of {to}"
        )),
        _ => Ok(()),
    }
}

/// The refusal of a shape that is not triangles, in a sentence with an alternative. `done` is the operation.
pub(crate) fn only_triangles(done: &str, kind: &str) -> String {
    let instead = match kind {
        "cage" => "; --surface faceted takes the polygons as triangles",
        _ => "",
    };
    format!("only triangles can be {done}, and these are {kind}: mesh them first{instead}")
}

/// How such a file identifies positions: by its own indices where it has some, else by their bits.
#[must_use]
pub fn topology(format: Format) -> Topology {
    match format {
        Format::Stl | Format::Glb => Topology::Positions,
        Format::Obj
        | Format::Ply
        | Format::Bpt
        | Format::Teaset
        | Format::Json
        | Format::Svg
        | Format::Vm
        | Format::Npy
        | Format::Nrrd
        | Format::Nii
        | Format::Star => Topology::Indices,
    }
}
