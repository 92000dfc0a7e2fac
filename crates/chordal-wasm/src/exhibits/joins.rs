//! Two cubics that meet as C0, C1 or C2: the join, the comb of their curvature, and stripes that a surface
//! swept from them reflects.
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

/// Teeth of the comb of each curve.
const TEETH: usize = 28;
/// The picture of the stripes; its rows are whole words.
const PICTURE: Screen = Screen { width_px: 320, height_px: 104 };
/// The surface is within this of the swept one: where a pixel is a thirtieth of a unit no stripe shows it.
const TOLERANCE: f64 = 4e-3;
/// How the profile that is swept along rises across, and by how much.
const ARCH: [f64; 4] = [0.0, 1.5, 1.5, 0.0];

/// Answers `{"first": [[x, y] × 4], "second": …, "keep": "C1", "scale": 1.0}`: the second curve made to
/// continue the first, how they meet, their combs, and a picture of the stripes.
pub(super) fn joins(asked: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    asked.only(&["first", "second", "keep", "scale"])?;
    let [first, second] = [cubic(asked, "first")?, cubic(asked, "second")?];
    let keep = match asked.word("keep", &["C0", "C1", "C2"])? {
        "C0" => Continuity::C0,
        "C1" => Continuity::C1,
        _ => Continuity::C2,
    };
    let scale = asked.number("scale", [0.0, 100.0])?;
    let second = second.continuing(&first, keep);
    let pieces = [first, second].map(CurveSegment::Cubic);
    let met = join([&pieces[0], &pieces[1]], [1.0; 2], 1);
    let comb = |curve: Bezier<2>| -> Vec<Value> {
        let told = |tooth: &Tooth| json!({ "on_curve": tooth.on_curve, "tip": tooth.tip, "curvature": tooth.curvature });
        curvature_comb(&curve.into(), TEETH, scale).iter().flatten().map(told).collect()
    };
    let mut answer = ExhibitAnswer::default();
    let stripes = stripes([first, second])?;
    let stripes = answer.rows(&stripes);
    answer.facts = json!({
        "second": second.control,
        "class": met.parametric,
        "geometric": met.geometric,
        "angle_deg": met.angle_rad.map(f64::to_degrees),
        "curvatures": met.curvatures,
        "curvature_gap": met.curvature_gap,
        "combs": [comb(first), comb(second)],
        "stripes": { "width": PICTURE.width_px, "height": PICTURE.height_px, "grey": stripes },
    });
    Ok(answer)
}

fn cubic(asked: &ExhibitRequest, key: &str) -> Result<Bezier<2>, String> {
    let points = asked.points::<2>(key, [4, 4])?;
    Ok(Bezier { control: [points[0], points[1], points[2], points[3]] })
}

/// The curves are swept along an arch that stands across them, so that y is height, and the surface is seen
/// from straight above: the picture reaches from the start of the first curve to the end of the second. Four
/// grey pixels a word, row by row from the top.
fn stripes(curves: [Bezier<2>; 2]) -> Result<Vec<u32>, String> {
    let [from, to] = [curves[0].control[0][0], curves[1].control[3][0]];
    if to <= from {
        return Err("the second curve ends right of where the first one starts".to_owned());
    }
    let height = (to - from) * f64::from(PICTURE.height_px) / f64::from(PICTURE.width_px);
    // Stripes run by height along the second axis. The curves are turned against it by the
    // angle of the triangle of sides 3, 4 and 5, so that stripes run across the join.
    let turned = |x: f64, y: f64| [0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y];
    // A tenth more than the picture shows, on either side.
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
    let made = patches_to_mesh(&curves.map(patch), &Budget::length(length), &job)
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
    let picture = render(&made.shape, &options, &job).map_err(|error| format!("{error:?}"))?;
    let grey: Vec<u8> = picture.rgba.chunks_exact(4).map(|pixel| pixel[1]).collect();
    Ok(grey.chunks_exact(4).map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]])).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(keep: &str, x: f64, y: f64) -> Value {
        let question = format!(
            r#"{{"exhibit": "joins", "first": [[1, 1], [2, 4], [{x}, {y}], [6, 4]],
                "second": [[6, 4], [8, 3], [9, 1], [11, 2]], "keep": "{keep}", "scale": 1}}"#
        );
        joins(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn what_is_kept_stays_and_the_rest_breaks() {
        // The second curve continues the first with both derivatives where its end stands at (4, 5).
        assert_eq!(asked("C0", 4.0, 5.0)["class"], json!(1));
        let kink = asked("C0", 4.0, 4.0);
        assert_eq!((&kink["class"], kink["angle_deg"].as_f64().unwrap() > 20.0), (&json!(0), true));
        let jump = asked("C1", 4.0, 4.0);
        assert_eq!((&jump["class"], jump["curvature_gap"].as_f64().unwrap() > 0.01), (&json!(1), true));
        assert_eq!(asked("C2", 4.0, 4.0)["class"], json!(2));
        assert_eq!(asked("C2", 3.0, 6.5)["class"], json!(2));
    }
}
