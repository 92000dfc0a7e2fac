//! `contact_note`: the lines of a script whose surfaces touch where a proof did not end, and what helps.
use crate::ShapeLine;
use chordal::budget::Bound;
use chordal::budget::advice::Message;
use chordal::budget::proof::{OpenPlace, SurfaceContact};

/// A line is said to pass through a contact where its shape is nearer than this fraction of the open place. Chosen: what
/// found the contact comes as near.
const NEAR: f64 = 2e-3;

/// What is said of the largest open place at which two surfaces touch from opposite sides. That faces lie in one another is
/// mostly meant, and nothing has to be done about it.
pub(crate) fn contact_note(bound: &Bound, lines: &[ShapeLine]) -> Option<Message> {
    let tangent = |place: &OpenPlace| Some((*place, place.contact.filter(|contact| !contact.is_flush)?));
    let (place, SurfaceContact { at, .. }) = bound.open.as_deref()?.largest.iter().find_map(tangent)?;
    let [x, y, z] = at;
    let who = match lines_through(at, NEAR * place.size, lines)[..] {
        [a, b] if a == b => format!(" (line {a} of the script)"),
        [a, b] => format!(" (lines {a} and {b} of the script)"),
        _ => String::new(),
    };
    Some(
        format!(
            "two surfaces touch at ({x:.4}, {y:.4}, {z:.4}) without crossing each other{who}: where they should be joined, move \
             one into the other by a little more than the length; where they should be apart, leave as much between them"
        )
        .into(),
    )
}

/// The lines of the first two shapes that pass through a point: what combines them comes later.
fn lines_through(at: [f64; 3], near: f64, lines: &[ShapeLine]) -> Vec<u64> {
    let passes = |shape: &&ShapeLine| {
        shape.field.sign().at(at).is_ok_and(|value| value.abs() <= near && value.is_finite())
    };
    lines.iter().filter(passes).map(|shape| shape.line).take(2).collect()
}
