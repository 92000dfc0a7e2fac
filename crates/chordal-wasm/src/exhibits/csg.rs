//! Two shapes combined by minimum and maximum, and the regions where the value is no distance.
use super::answer::ExhibitAnswer;
use super::plane::{Latest, Region, below, distance_to, latest, or_text, outline, regions, value_at};
use super::request::ExhibitRequest;
use chordal::implicit::shapes::{circle, rectangle};
use chordal::implicit::{Expr, Field};
use serde_json::json;
use std::sync::Mutex;

/// The level curves that are drawn.
const LEVELS: [f64; 12] = [3.0, 2.5, 2.0, 1.5, 1.0, 0.5, 0.0, -0.5, -1.0, -1.5, -2.0, -2.5];
/// The tolerance of the outline to which the true distance is measured.
const CLOSE: f64 = 0.0001; // chosen: a hundredth of a pixel of the figure, so that ratios are right to a thousandth
/// The difference from which on the value counts as no distance.
const SHOWS: f64 = 0.03; // chosen: two pixels of the figure

/// The result of an operation, with its figures.
struct Combined {
    parts: [Field; 2],
    shape: Field,
    distance: Field,
    levels: Vec<Region>,
    /// The regions where value and distance differ by more than [`SHOWS`].
    wrong: Vec<Region>,
    outlines: [Vec<Region>; 2],
}

const OPERATIONS: [&str; 3] = ["union", "intersection", "difference"];

/// Answers `{"operation": "union", "parts": [[x, y], [x, y]], "point": [x, y]}`: the value and the true distance at the point, and the
/// regions where they differ.
pub(super) fn csg(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["operation", "parts", "point"])?;
    let operation = request.word("operation", &OPERATIONS)?;
    let parts = request.points::<2>("parts", [2, 2])?;
    let point = request.point::<2>("point")?;
    static MADE: Latest<(String, Vec<[f64; 2]>), Combined> = Mutex::new(None);
    let combination = latest(&MADE, (operation.to_owned(), parts.clone()), || combined(operation, &parts))?;
    let Combined { shape, distance, .. } = &*combination;
    let [value, truth] = [value_at(&shape.tape(), point)?, value_at(&distance.tape(), point)?];
    let [a, b] =
        [value_at(&combination.parts[0].tape(), point)?, value_at(&combination.parts[1].tape(), point)?];
    let mut answer = ExhibitAnswer::default();
    let levels = regions(&mut answer, &combination.levels);
    let wrong = regions(&mut answer, &combination.wrong);
    let [first_outline, second_outline] = &combination.outlines;
    let outlines = [regions(&mut answer, first_outline), regions(&mut answer, second_outline)];
    answer.facts = json!({
        "levels": levels,
        "wrong": wrong,
        "parts": outlines,
        "of": [a, b],
        "value": value,
        "truth": truth,
        // At the surface both are 0, except for the error of the outline.
        "share": (truth.abs() > 2.0 * CLOSE).then(|| value / truth),
        "quality": { "outside": shape.distance().outside.as_str(), "inside": shape.distance().inside.as_str() },
    });
    Ok(answer)
}

fn combined(operation: &str, parts: &[[f64; 2]]) -> Result<Combined, String> {
    let at = |k: usize| [parts[k][0], parts[k][1], 0.0];
    let disc = or_text(or_text(circle(2.5))?.moved(at(0)))?;
    let slab = or_text(or_text(rectangle([5.0, 2.8]))?.rotated_deg([0.0, 0.0, 1.0], 18.0))?;
    let slab = or_text(slab.moved(at(1)))?;
    let shape = match operation {
        "union" => disc.union(&slab),
        "intersection" => disc.intersection(&slab),
        _ => disc.difference(&slab),
    };
    // An outline that is missing means that two parts have nothing in common.
    let lines = outline(&shape, CLOSE).map_err(|_| "the parts have nothing in common".to_owned())?;
    let distance = distance_to(&lines)?;
    let differs: Expr = Expr::constant(SHOWS) - (shape.expr() - distance.expr()).abs();
    Ok(Combined {
        levels: below(shape.expr(), &LEVELS, 0.125)?,
        wrong: below(&differs, &[0.0], 0.0625)?,
        outlines: [below(disc.expr(), &[0.0], 0.125)?, below(slab.expr(), &[0.0], 0.0625)?],
        parts: [disc, slab],
        shape,
        distance,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(operation: &str, point: [f64; 2]) -> serde_json::Value {
        let parts = [[4.6, 4.3], [7.2, 3.8]];
        let question =
            json!({ "exhibit": "csg", "operation": operation, "parts": parts, "point": point }).to_string();
        csg(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn the_value_is_never_more_than_the_distance_and_less_where_the_library_says_bound() {
        for operation in ["union", "intersection", "difference"] {
            let mut less = [false; 2];
            for i in 0..96 {
                let facts = at(operation, [f64::from(i % 12) + 0.5, f64::from(i / 12) + 0.5]);
                let [value, truth] = ["value", "truth"].map(|name| facts[name].as_f64().unwrap());
                assert!(value.abs() <= truth.abs() + 2.0 * CLOSE, "{operation} {i}: {value} {truth}");
                less[usize::from(value < 0.0)] |= value.abs() < truth.abs() - 0.1;
                for (side, is_less) in ["outside", "inside"].iter().zip(less) {
                    assert!(!is_less || facts["quality"][side] == "lower bound", "{operation} {side}");
                }
            }
            assert!(less.contains(&true), "{operation}");
        }
    }
}
