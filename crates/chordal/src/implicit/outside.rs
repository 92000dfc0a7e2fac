//! Interval tests that an expression is nowhere negative outside a box.
use super::leaf::LeafError;
use super::tape::Tape;
use crate::math::{Box3, Interval};

/// The most boxes that are evaluated. Chosen: a question that some dozen boxes leave open is seldom answered
/// by more.
const MOST_BOXES: usize = 1 << 10;
/// The most interval steps. Chosen: a hundred terms in ten thousand boxes, far less than a mesh takes.
const MOST_STEPS: usize = 1 << 20;

/// Whether the value is proved to be defined and nowhere negative outside `bounds`. `false` proves nothing.
/// Cost: at most [`MOST_STEPS`]. Leaves are not evaluated: they may be user functions that cannot handle
/// unbounded boxes.
pub(super) fn is_empty_outside(tape: &Tape, bounds: &Box3) -> bool {
    let mut waiting = slabs(bounds);
    if bounds.is_empty() || tape.has_leaves() && !waiting.is_empty() {
        return false;
    }
    let limit = (MOST_STEPS / tape.len()).clamp(16, MOST_BOXES); // 16: the six sides, halved once or so
    let mut n_seen = 0;
    while !waiting.is_empty() {
        n_seen += waiting.len();
        let Ok(ranges) = over(tape, &waiting) else { return false };
        let open: Vec<Box3> =
            waiting.iter().zip(&ranges).filter(|(_, range)| !holds(**range)).map(|(b, _)| *b).collect();
        if n_seen + 2 * open.len() > limit {
            return open.is_empty();
        }
        waiting = open.iter().flat_map(|part| halves(part, bounds)).collect();
    }
    true
}

/// The lowest value that interval arithmetic proves, if the expression is defined everywhere and has no leaf.
pub(super) fn lowest(tape: &Tape) -> Option<f64> {
    if tape.has_leaves() {
        return None;
    }
    let everywhere = Box3 { min: [f64::NEG_INFINITY; 3], max: [f64::INFINITY; 3] };
    let range = over(tape, &[everywhere]).ok()?[0];
    (range.is_defined() && range.lo() > f64::NEG_INFINITY).then(|| range.lo())
}

fn over(tape: &Tape, boxes: &[Box3]) -> Result<Vec<Interval>, LeafError> {
    let mut ranges = vec![Interval::UNKNOWN; boxes.len()];
    tape.over(boxes, &mut ranges)?;
    Ok(ranges)
}

/// An undefined value proves nothing: a choice between it and a number may give either.
fn holds(range: Interval) -> bool {
    range.is_defined() && range.lo() >= 0.0
}

/// The outside of a box: on each side the slab that is not covered by the slabs before it.
fn slabs(bounds: &Box3) -> Vec<Box3> {
    let mut slabs = Vec::new();
    let mut remaining = Box3 { min: [f64::NEG_INFINITY; 3], max: [f64::INFINITY; 3] };
    for k in 0..3 {
        for (end, below) in [(bounds.min[k], true), (bounds.max[k], false)] {
            if end.is_finite() {
                let mut slab = remaining;
                if below {
                    slab.max[k] = end
                } else {
                    slab.min[k] = end
                }
                slabs.push(slab);
            }
        }
        (remaining.min[k], remaining.max[k]) = (bounds.min[k], bounds.max[k]);
    }
    slabs
}

/// The two halves of a box: cut across an unbounded side, if there is one, else across the longest side.
fn halves(part: &Box3, bounds: &Box3) -> [Box3; 2] {
    let cuts: [f64; 3] =
        std::array::from_fn(|k| cut([part.min[k], part.max[k]], [bounds.min[k], bounds.max[k]]));
    // Unbounded sides take turns: the one with the nearest cut goes first.
    let rank = |k: usize| {
        let length = part.max[k] - part.min[k];
        if length.is_finite() { (1, -length) } else { (0, (cuts[k] - cuts_from(bounds, k)).abs()) }
    };
    let first = |a: usize, b: usize| if rank(b) < rank(a) { b } else { a };
    let k = first(first(0, 1), 2);
    let (mut low, mut high) = (*part, *part);
    (low.max[k], high.min[k]) = (cuts[k], cuts[k]);
    [low, high]
}

/// The position of the cut of a side: in the middle, or, if unbounded, as far beyond its end as that is from
/// the box, so that successive cuts double the distance.
fn cut([low, high]: [f64; 2], bounds: [f64; 2]) -> f64 {
    let (centre, size) = middle_and_size(bounds);
    match (low.is_finite(), high.is_finite()) {
        (true, true) => low + 0.5 * (high - low),
        (true, false) => low + ((low - centre).abs() + size),
        (false, true) => high - ((high - centre).abs() + size),
        (false, false) => centre,
    }
}

fn cuts_from(bounds: &Box3, k: usize) -> f64 {
    middle_and_size([bounds.min[k], bounds.max[k]]).0
}

/// The middle and length of a side; 0 and 1 for an unbounded one.
fn middle_and_size([low, high]: [f64; 2]) -> (f64, f64) {
    let size = high - low;
    if size.is_finite() { (low + 0.5 * size, size) } else { (0.0, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::implicit::Expr;

    fn cube(half: f64) -> Box3 {
        Box3 { min: [-half; 3], max: [half; 3] }
    }

    #[test]
    fn a_ball_is_within_any_box_around_it_and_no_smaller_one() {
        let [x, y, z] = Expr::axes();
        let ball = Tape::new(&(x.square() + y.square() + z.square() - 1.0));
        assert!(is_empty_outside(&ball, &cube(1.0 + 1e-12)));
        assert!(!is_empty_outside(&ball, &cube(1.0 - 1e-12)));
        assert!(!is_empty_outside(&ball, &Box3::EMPTY));
        let endless = Box3 { min: [f64::NEG_INFINITY; 3], max: [f64::INFINITY; 3] };
        assert!(is_empty_outside(&ball, &endless));
    }

    #[test]
    fn finds_what_only_smaller_boxes_show() {
        // The interval of the sum over an unbounded side is unbounded; over halves it is not.
        let [x, y, z] = Expr::axes();
        let waves = (x.clone() * 3.0).sin() + (x.clone() * 3.0).cos() * 0.5;
        let bump = x.square() + y.square() + z.square() - 1.0 - waves * 0.25;
        assert!(is_empty_outside(&Tape::new(&bump), &cube(1.25)));
        assert!(!is_empty_outside(&Tape::new(&(bump - 2.0)), &cube(1.25)));
    }

    #[test]
    fn an_undefined_value_is_not_shown_to_be_empty() {
        let [x, ..] = Expr::axes();
        assert!(!is_empty_outside(&Tape::new(&(x.sqrt() + 1.0)), &cube(1.0)));
        assert_eq!(lowest(&Tape::new(&x.sqrt())), None);
        assert_eq!(lowest(&Tape::new(&x)), None);
        let low = lowest(&Tape::new(&(x.sin() * 0.5))).expect("a sine has ends");
        assert!(low <= -0.5 && low > -0.5 - 1e-12);
    }
}
