//! `name_lines`: the lines of a script that made the surfaces at a contact where a proof failed.
use crate::ShapeLine;
use chordal::budget::Bound;
use chordal::implicit::evaluation::Tape;
use chordal::math::greater;

/// A line's surface passes a contact if it is nearer than this fraction of the open place. Chosen: the search for contacts
/// comes as near.
const NEAR: f64 = 2e-3;
/// Two shapes have the same surface at a contact if their values, up to the sign, are equal at points around it, this
/// fraction of the open place away. Chosen: surfaces that touch bend away from each other within that distance, and edges
/// where they are cut or joined are mostly farther.
const AROUND: f64 = 1.0 / 256.0;
/// Values are equal if they differ by less than this, relative to the larger one. Chosen: far above rounding.
const SAME: f64 = 1e-9;

/// The shape of a line near a contact: the sizes of its values at points around it.
struct PassingLine {
    line: u64,
    around: [f64; 6],
}

/// Adds to each contact the lines of the first two shapes that pass through it and differ around it. A solid differs there
/// from a solid that it touches, but not from a solid that is cut out of it, or from a combination that it is part of. If
/// no two differ, as for faces that lie against each other, adds the lines of the first two shapes.
pub(crate) fn name_lines(bound: &mut Bound, lines: &[ShapeLine]) {
    let Some(open) = bound.open.as_deref_mut() else { return };
    for place in &mut open.largest {
        let Some(contact) = &mut place.contact else { continue };
        let passing = passing_lines(lines, contact.at, place.size);
        let differing = first_that_differ(
            passing
                .iter()
                .enumerate()
                .filter(|(k, shape)| {
                    // The last shape of a line stands for its intermediate ones.
                    passing.get(k + 1).is_none_or(|next| next.line != shape.line)
                })
                .map(|(_, shape)| shape),
        )
        .or_else(|| first_that_differ(passing.iter()));
        let first_two = || Some([passing.first()?, passing.get(1)?]);
        contact.lines = differing.or_else(first_two).map(|two| two.map(|shape| shape.line));
    }
}

/// The shapes whose surface passes a contact in an open place of a given size, in their order.
fn passing_lines(lines: &[ShapeLine], at: [f64; 3], size: f64) -> Vec<PassingLine> {
    let aside = |k: usize| {
        let by = if k < 3 { AROUND * size } else { -AROUND * size };
        [0, 1, 2].map(|axis| if axis == k % 3 { at[axis] + by } else { at[axis] })
    };
    let points: Vec<[f64; 3]> = std::iter::once(at).chain((0..6).map(aside)).collect();
    let passing = |shape: &ShapeLine| {
        let mut values = [0.0; 7];
        Tape::new(shape.field.sign()).at(&points, &mut values).ok()?;
        let [here, around @ ..] = values;
        let passes = here.abs() <= NEAR * size && values.iter().all(|value| value.is_finite());
        passes.then_some(PassingLine { line: shape.line, around: around.map(f64::abs) })
    };
    lines.iter().filter_map(passing).collect()
}

/// The first pair, by its second shape, of shapes that differ.
fn first_that_differ<'a>(shapes: impl Iterator<Item = &'a PassingLine>) -> Option<[&'a PassingLine; 2]> {
    let mut before: Vec<&PassingLine> = Vec::new();
    for shape in shapes {
        if let Some(other) = before.iter().find(|other| differ(other, shape)) {
            return Some([other, shape]);
        }
        before.push(shape);
    }
    None
}

fn differ(a: &PassingLine, b: &PassingLine) -> bool {
    a.around.iter().zip(&b.around).any(|(x, y)| (x - y).abs() > SAME * greater(*x, *y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal::budget::proof::{OpenPlace, OpenPlaces, SurfaceContact};
    use chordal::budget::{Evidence, Reference};
    use chordal::implicit::Field;
    use chordal::implicit::shapes::{cuboid, cylinder};

    fn lines_at(at: [f64; 3], shapes: &[&Field]) -> Option<[u64; 2]> {
        let numbered: Vec<(u64, &Field)> = (1..).zip(shapes.iter().copied()).collect();
        lines_of(at, &numbered)
    }

    fn lines_of(at: [f64; 3], shapes: &[(u64, &Field)]) -> Option<[u64; 2]> {
        let contact = Some(SurfaceContact { at, is_flush: false, lines: None });
        let place = OpenPlace { at, size: 20.0, area: 1.0, contact };
        let mut bound = Bound::with_evidence(0.0, None, Evidence::Measured { samples: 1 }, Reference::Field);
        bound.open = Some(Box::new(OpenPlaces::new(vec![place], 1.0)));
        let line = |(line, field): &(u64, &Field)| ShapeLine { line: *line, field: (*field).clone() };
        let lines: Vec<ShapeLine> = shapes.iter().map(line).collect();
        name_lines(&mut bound, &lines);
        bound.open.unwrap().largest[0].contact.unwrap().lines
    }

    #[test]
    fn a_pocket_and_the_post_in_it_are_named_and_not_the_pocket_and_what_it_is_cut_from() {
        let body = cuboid([40.0, 24.0, 15.0]).unwrap();
        let pocket = cuboid([36.0, 20.0, 15.0]).unwrap().moved([0.0, 0.0, 2.0]).unwrap();
        let tray = body.difference(&pocket);
        let post = cylinder(3.0, 13.0).unwrap();
        let moved = post.moved([14.0, 7.0, 0.0]).unwrap();
        let whole = tray.union(&moved);
        let shapes = [&body, &pocket, &tray, &post, &moved, &whole];
        assert_eq!(lines_at([14.0, 10.0, 1.0], &shapes), Some([2, 5]));
        assert_eq!(lines_at([14.0, 9.0, 1.0], &shapes), None);
    }

    #[test]
    fn what_a_line_moves_is_not_told_from_where_it_was_before() {
        let body = cuboid([40.0, 24.0, 15.0]).unwrap();
        let pocket = cuboid([36.0, 20.0, 15.0]).unwrap();
        let post = cylinder(3.0, 13.0).unwrap().moved([14.0, 7.0, 0.0]).unwrap();
        let moved = pocket.moved([0.0, 0.0, 2.0]).unwrap();
        let shapes = [(1, &body), (2, &pocket), (2, &moved), (3, &body.difference(&moved)), (4, &post)];
        // In the corner of floor and wall the pocket differs from the pocket before it was moved.
        let at_corner = [14.0, 10.0, -5.5];
        assert_eq!(lines_of(at_corner, &shapes), Some([2, 4]));
        // All in one line.
        assert_eq!(lines_of(at_corner, &[(1, &moved), (1, &post), (1, &moved.union(&post))]), Some([1, 1]));
    }

    #[test]
    fn of_faces_that_lie_against_each_other_the_first_two_are_named() {
        let low = cuboid([10.0; 3]).unwrap();
        let high = low.moved([0.0, 0.0, 10.0]).unwrap();
        assert_eq!(lines_at([1.0, 2.0, 5.0], &[&low, &high, &low.union(&high)]), Some([1, 2]));
    }
}
