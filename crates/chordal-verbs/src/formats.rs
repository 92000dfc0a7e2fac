//! Lists of the file formats for the verbs and their messages.
use crate::Shape;
use chordal::budget::advice::{Message, Setting};
use chordal_io::Format;

/// The names of the formats that hold triangles, as in "obj, ply, stl, glb".
#[must_use]
pub fn mesh_names() -> String {
    names_where(Format::holds_triangles).join(", ")
}

/// The names of the formats with a property, in the order of the table. Sentences take their lists of formats from here, so
/// that they stay true when formats are added.
#[must_use]
pub fn names_where(is_so: impl Fn(Format) -> bool) -> Vec<String> {
    Format::all().filter(|format| is_so(*format)).map(|format| format.to_string()).collect()
}

/// A list in a sentence, the last two joined by `word`.
///
/// ```
/// use chordal_io::Format;
/// use chordal_verbs::formats::{in_words, names_where};
/// assert_eq!(in_words(&names_where(Format::holds_volumes), "and"), "npy and nrrd");
/// ```
#[must_use]
pub fn in_words(names: &[String], word: &str) -> String {
    match names.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} {word} {last}", others.join(", ")),
        Some((only, _)) => only.clone(),
        None => String::new(),
    }
}

/// A list of the extensions of formats with a property, with their dots, as in ".json or .svg".
#[must_use]
pub fn extensions_where(is_so: impl Fn(Format) -> bool, word: &str) -> String {
    let dotted: Vec<String> = names_where(is_so).iter().map(|name| format!(".{name}")).collect();
    in_words(&dotted, word)
}

/// The names of the formats that `mesh` can write.
#[must_use]
pub fn output_names() -> String {
    names_where(|format| format.holds_triangles() || format.holds_polylines()).join(", ")
}

/// The names of all formats that can be written.
#[must_use]
pub fn writable_names() -> String {
    names_where(|format| format.holds_triangles() || format.holds_polylines() || format.holds_volumes())
        .join(", ")
}

/// The names of all formats: every format can be read.
#[must_use]
pub fn readable_names() -> String {
    names_where(|_| true).join(", ")
}

/// Refuses a format that cannot hold the shape, in a sentence with an alternative.
pub(crate) fn check_output(shape: &Shape, to: Format) -> Result<(), Message> {
    match shape {
        _ if !to.holds_triangles() && !to.holds_polylines() => {
            let is_drawn = matches!(shape, Shape::Drawing(_) | Shape::Curves(_) | Shape::Field(_));
            let names = if is_drawn { output_names() } else { mesh_names() };
            let why = if to.holds_volumes() { "holds samples alone" } else { "is only read" };
            Err(format!("{to} {why}; what can be written is {names}").into())
        }
        Shape::Patches { .. } | Shape::Surfaces { .. } | Shape::Scene(_) if !to.holds_triangles() => {
            Err(format!("{} become triangles, which {to} does not hold; {} do", shape.kind(), mesh_names())
                .into())
        }
        Shape::Field(implicit) if !to.holds_triangles() && implicit.field.tape().axes()[2] => Err(format!(
            "fields that depend on z become triangles, which {to} does not hold; {} do",
            mesh_names()
        )
        .into()),
        Shape::Cage(_) if !to.holds_triangles() => {
            Err(format!("cages become polygons or triangles, which {to} does not hold; {} do", mesh_names())
                .into())
        }
        Shape::Volume(_) if !to.holds_triangles() => {
            Err(format!("volumes become triangles, which {to} does not hold; {} do", mesh_names()).into())
        }
        Shape::Curves(_) if !to.holds_polylines() => Err(format!(
            "curves in space enclose no area to fill with triangles: write polylines, to {} instead of {to}",
            in_words(&names_where(Format::holds_space_curves), "or")
        )
        .into()),
        _ => Ok(()),
    }
}

/// The message for shapes that are not triangles, with an alternative. `done` is the operation, as a participle.
pub(crate) fn only_triangles(done: &str, kinds: &str) -> Message {
    let message = Message::from(format!("only triangles can be {done}, not {kinds}: mesh them first"));
    match kinds {
        "cages" => {
            message.words("; ").value(Setting::Surface, "faceted").words(" takes the polygons as triangles")
        }
        _ => message,
    }
}
