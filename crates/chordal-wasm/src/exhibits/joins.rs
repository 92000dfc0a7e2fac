//! Two cubics that meet with C0, C1 or C2: the join, the combs of their curvature, and zebra stripes of a
//! surface swept from them.
use super::answer::ExhibitAnswer;
use super::request::ExhibitRequest;
use chordal::budget::camera::{Camera, Projection, Screen};
use chordal::check::curves::{Tooth, curvature_comb, join};
use chordal::convert::patches_to_mesh;
use chordal::explicit::CurveSegment;
use chordal::explicit::parametric::Continuity;
use chordal::render::{Background, RenderOptions, RenderStyle, UpAxis, Viewpoint, render};
use chordal::{Bezier, Budget, Job, Patch, Tolerance};
use serde_json::{Value, json};

/// The number of teeth of each comb. Chosen: dense enough to look like a curve.
const TEETH: usize = 28;
/// The picture of the stripes; its rows are multiples of four pixels.
const PICTURE: Screen = Screen { width_px: 480, height_px: 156 };
/// The tolerance of the surface. Chosen: a pixel is a fiftieth of a unit, so no stripe shows it.
const TOLERANCE: f64 = 4e-3;
/// The heights of the control points of the arch that the curves are swept along.
const ARCH: [f64; 4] = [0.0, 1.5, 1.5, 0.0];

/// Answers `{"first": [[x, y] × 4], "second": …, "keep": "C1", "scale": 1.0}`: the second curve as a
/// continuation of the first, their join, their combs, and a picture of the stripes.
pub(super) fn joins(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    let (mut answer, curves) = joined(request)?;
    let stripes = answer.rows(&stripes(curves)?);
    answer.facts["stripes"] =
        json!({ "width": PICTURE.width_px, "height": PICTURE.height_px, "grey": stripes });
    Ok(answer)
}

/// The same without the picture, and so without all that draws it.
pub(super) fn without_stripes(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    Ok(joined(request)?.0)
}

fn joined(request: &ExhibitRequest) -> Result<(ExhibitAnswer, [Bezier<2>; 2]), String> {
    request.only(&["first", "second", "keep", "scale"])?;
    let [first, second] = [cubic(request, "first")?, cubic(request, "second")?];
    let keep = match request.word("keep", &["C0", "C1", "C2"])? {
        "C0" => Continuity::C0,
        "C1" => Continuity::C1,
        _ => Continuity::C2,
    };
    let scale = request.number("scale", [0.0, 100.0])?;
    let second = second.continuing(&first, keep);
    let pieces = [first, second].map(CurveSegment::Cubic);
    let join_facts = join([&pieces[0], &pieces[1]], [1.0; 2], 1);
    let comb = |curve: Bezier<2>| -> Vec<Value> {
        let tooth_json = |tooth: &Tooth| json!({ "on_curve": tooth.on_curve, "tip": tooth.tip, "curvature": tooth.curvature });
        curvature_comb(&curve.into(), TEETH, scale).iter().flatten().map(tooth_json).collect()
    };
    let facts = json!({
        "second": second.control,
        "class": join_facts.parametric,
        "geometric": join_facts.geometric,
        "angle_deg": join_facts.angle_rad.map(f64::to_degrees),
        "curvatures": join_facts.curvatures,
        "curvature_gap": join_facts.curvature_gap,
        "combs": [comb(first), comb(second)],
    });
    Ok((ExhibitAnswer::new(facts), [first, second]))
}

fn cubic(request: &ExhibitRequest, key: &str) -> Result<Bezier<2>, String> {
    let points = request.points::<2>(key, [4, 4])?;
    Ok(Bezier { control: [points[0], points[1], points[2], points[3]] })
}

/// The stripes: the curves are swept along an arch across them, with y as height, and the surface is seen
/// from above. The picture reaches from the start of the first curve to the end of the second. Four grey
/// pixels a word, row by row from the top.
fn stripes(curves: [Bezier<2>; 2]) -> Result<Vec<u32>, String> {
    let [from, to] = [curves[0].control[0][0], curves[1].control[3][0]];
    if to <= from {
        return Err("the second curve has to end right of the start of the first one".to_owned());
    }
    let height = (to - from) * f64::from(PICTURE.height_px) / f64::from(PICTURE.width_px);
    // Stripes depend on the second axis. The curves are rotated by the angle of the triangle with sides 3, 4
    // and 5, so that stripes cross the join.
    let turned = |x: f64, y: f64| [0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y];
    // The surface is wider than the picture by a tenth on either side.
    let across = |i: usize| 0.6 * height * (i as f64 * 2.0 / 3.0 - 1.0);
    let patch = |curve: Bezier<2>| Patch {
        control: std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let [x, y] = curve.control[j];
                let [a, b] = turned(x - f64::midpoint(from, to), across(i));
                [a, b, y + ARCH[i]]
            })
        }),
    };
    let length = Tolerance::new(TOLERANCE).map_err(|error| error.to_string())?;
    let job = Job::default();
    let surface = patches_to_mesh(&curves.map(patch), &Budget::length(length), &job)
        .map_err(|failure| failure.to_string())?;
    let [up_x, up_y] = turned(0.0, 1.0);
    let camera = Camera {
        eye: [0.0, 0.0, 100.0],
        target: [0.0; 3],
        up: [up_x, up_y, 0.0],
        near: 0.0,
        projection: Projection::Orthographic { height },
        screen: PICTURE,
    };
    let options = RenderOptions {
        show: RenderStyle::Zebra,
        viewpoint: Viewpoint::Camera(camera),
        up: UpAxis::Y,
        background: Background::Transparent,
        samples: 2,
        ..RenderOptions::sized(PICTURE.width_px, PICTURE.height_px)
    };
    let picture = render(&surface.shape, &options, &job).map_err(|error| format!("{error:?}"))?;
    let grey: Vec<u8> = picture.rgba.chunks_exact(4).map(|pixel| pixel[1]).collect();
    Ok(grey
        .chunks_exact(4)
        // An answer has arrays of 32-bit numbers alone: each holds four pixels.
        .map(|pixels| u32::from_le_bytes([pixels[0], pixels[1], pixels[2], pixels[3]]))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts_of(keep: &str, x: f64, y: f64) -> Value {
        let question = format!(
            r#"{{"exhibit": "joins", "first": [[1, 1], [2, 4], [{x}, {y}], [6, 4]],
                "second": [[6, 4], [8, 3], [9, 1], [11, 2]], "keep": "{keep}", "scale": 1}}"#
        );
        joins(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn what_is_kept_stays_and_the_rest_breaks() {
        // If the third point is at (4, 5), the second curve continues the first with both derivatives.
        assert_eq!(facts_of("C0", 4.0, 5.0)["class"], json!(1));
        let kink = facts_of("C0", 4.0, 4.0);
        assert_eq!((&kink["class"], kink["angle_deg"].as_f64().unwrap() > 20.0), (&json!(0), true));
        let jump = facts_of("C1", 4.0, 4.0);
        assert_eq!((&jump["class"], jump["curvature_gap"].as_f64().unwrap() > 0.01), (&json!(1), true));
        assert_eq!(facts_of("C2", 4.0, 4.0)["class"], json!(2));
        assert_eq!(facts_of("C2", 3.0, 6.5)["class"], json!(2));
    }
}
