//! `name_lines`: which lines of a script made the surfaces that touch where a proof did not end.
use crate::ShapeLine;
use chordal::budget::Bound;

/// A line is said to have made a surface that passes a contact nearer than this fraction of the open place. Chosen: what
/// found the contact comes as near.
const NEAR: f64 = 2e-3;

/// Adds the lines of the first two shapes that pass through each contact: what combines them comes later.
pub(crate) fn name_lines(bound: &mut Bound, lines: &[ShapeLine]) {
    let Some(open) = bound.open.as_deref_mut() else { return };
    for place in &mut open.largest {
        let Some(contact) = &mut place.contact else { continue };
        let (at, near) = (contact.at, NEAR * place.size);
        let passes = |shape: &&ShapeLine| {
            shape.field.sign().at(at).is_ok_and(|value| value.abs() <= near && value.is_finite())
        };
        let mut through = lines.iter().filter(passes).map(|shape| shape.line);
        contact.lines = through.next().zip(through.next()).map(|(a, b)| [a, b]);
    }
}
