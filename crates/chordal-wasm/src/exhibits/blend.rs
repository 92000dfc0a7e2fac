//! Two discs united with a sharp or a filled seam, and the distance to the result.
use super::answer::ExhibitAnswer;
use super::plane::{below, distance_to, loops, or_text, outline, regions, value_at};
use super::request::ExhibitRequest;
use chordal::implicit::Field;
use chordal::implicit::shapes::circle;
use serde_json::json;

/// The level curves that are drawn.
const LEVELS: [f64; 9] = [3.0, 2.5, 2.0, 1.5, 1.0, 0.5, 0.0, -0.5, -1.0];
/// The radii of the discs.
const RADII: [f64; 2] = [1.7, 1.2];
/// The range of the width of the blend.
const WIDTHS: [f64; 2] = [0.0, 4.0]; // defined: what the slider offers
/// The tolerance of the outline to which the true distance is measured.
const CLOSE: f64 = 0.002; // chosen: a tenth of a pixel of the figure

/// Answers `{"balls": [[x, y], [x, y]], "width": 1.5, "point": [x, y]}`: the blend, its value and the true distance.
pub(super) fn blend(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["balls", "width", "point"])?;
    let balls = request.points::<2>("balls", [2, 2])?;
    let width = request.number("width", WIDTHS)?;
    let point = request.point::<2>("point")?;
    let disc = |k: usize| or_text(or_text(circle(RADII[k]))?.moved([balls[k][0], balls[k][1], 0.0]));
    let [a, b] = [disc(0)?, disc(1)?];
    let sharp = a.union(&b);
    let shape = if width > 0.0 { or_text(a.smooth_union(&b, width))? } else { sharp.clone() };
    let truth_lines = outline(&shape, CLOSE)?;
    let truth = value_at(&distance_to(&truth_lines)?.tape(), point)?;
    let value = |field: &Field| value_at(&field.tape(), point);
    let levels = below(shape.expr(), &LEVELS, 0.125)?;
    let mut answer = ExhibitAnswer::default();
    let drawn = regions(&mut answer, &levels);
    answer.facts = json!({
        "levels": drawn,
        "outline": loops(&mut answer, &truth_lines),
        "sharp": loops(&mut answer, &outline(&sharp, 0.01)?), // chosen: half a pixel of the figure
        "radii": RADII,
        "of": [value(&a)?, value(&b)?],
        "min": value(&sharp)?,
        "value": value(&shape)?,
        "truth": truth,
        // At the surface both are 0, except for the error of the outline.
        "share": (truth.abs() > 4.0 * CLOSE).then_some(value(&shape)? / truth),
        "most_added": 0.25 * width,
        "pieces": truth_lines.len(),
        "quality": { "outside": shape.distance().outside.as_str(), "inside": shape.distance().inside.as_str() },
    });
    Ok(answer)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(balls: [[f64; 2]; 2], width: f64, point: [f64; 2]) -> serde_json::Value {
        let question = json!({ "exhibit": "blend", "balls": balls, "width": width, "point": point });
        blend(&ExhibitRequest::parse(question.to_string().as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn a_blend_adds_at_most_a_quarter_of_its_width_and_its_value_is_a_bound_outside() {
        let balls = [[4.0, 4.0], [7.2, 4.0]];
        for i in 0..48 {
            let point = [0.25 + 0.25 * f64::from(i), 5.6 - 0.05 * f64::from(i)];
            let facts = at(balls, 2.0, point);
            let number = |name: &str| facts[name].as_f64().unwrap();
            assert!(number("value") <= number("min") && number("value") >= number("min") - 0.5 - 1e-12); // rounding
            if number("truth") > 0.0 {
                assert!(number("value") <= number("truth") + CLOSE, "{point:?}");
            }
        }
        // The gap of 0.3 is bridged by the blend alone.
        assert_eq!(
            [at(balls, 0.0, [1.0, 1.0]), at(balls, 2.0, [1.0, 1.0])].map(|facts| facts["pieces"].clone()),
            [json!(2), json!(1)]
        );
        assert_eq!(at(balls, 2.0, [1.0, 1.0])["quality"]["outside"], "lower bound");
    }
}
