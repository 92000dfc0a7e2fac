//! A bicubic patch: sixteen control points and their weights, the curve that slides across, and triangles
//! within a pixel budget.
use super::answer::ExhibitAnswer;
use super::plane::or_text;
use super::request::ExhibitRequest;
use super::shapes::{from_quads, mesh_from};
use chordal::budget::camera::{Camera, Projection, Screen};
use chordal::budget::{Pixels, View};
use chordal::convert::patches_to_mesh;
use chordal::explicit::parametric::bernstein;
use chordal::{Bezier, Budget, Job, Patch};
use serde_json::{Value, json};

/// Steps along each side of the surface on which weights are painted. Chosen: it looks smooth.
const STEPS: u32 = 24;
/// Steps of a curve. Chosen: it looks smooth.
const CURVE: u32 = 32;
/// The pixel budget.
const PIXELS: [f64; 2] = [0.1, 32.0];
/// The picture: the initial size and the lens of the figure.
const SCREEN: Screen = Screen { width_px: 720, height_px: 480 };
const FOV_Y_DEG: f64 = 28.0; // as in studio/src/viewer/view.ts

/// Answers `{"control": [[x, y, z] × 16], "u": 0.5, "v": 0.5, "chosen": 5, "pixels": 1, "eye": …, "target": …}`:
/// the point at u and v with its sixteen weights, the weight of the chosen control point all over the
/// surface, and the triangles that keep the error below `pixels` from there; none if the eye is too close.
pub(super) fn patch(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["control", "u", "v", "chosen", "pixels", "eye", "target"])?;
    let control = request.points::<3>("control", [16, 16])?;
    let patch = Patch { control: std::array::from_fn(|i| std::array::from_fn(|j| control[4 * i + j])) };
    let [u, v] = [request.number("u", [0.0, 1.0])?, request.number("v", [0.0, 1.0])?];
    let chosen = request.number("chosen", [0.0, 15.0])? as usize;
    let pixels = or_text(Pixels::new(request.number("pixels", PIXELS)?))?;
    let view = View::Camera(Camera {
        eye: request.point("eye")?,
        target: request.point("target")?,
        up: [0.0, 0.0, 1.0],
        near: 0.0,
        projection: Projection::Perspective { fov_y_deg: FOV_Y_DEG },
        screen: SCREEN,
    });
    let weight = |row: usize, u: f64, v: f64| bernstein(v)[row / 4] * bernstein(u)[row % 4];
    let weights: Vec<f64> = (0..16).map(|row| weight(row, u, v)).collect();
    let mut answer = ExhibitAnswer::default();
    let (mut positions, mut normals, mut painted) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..=STEPS {
        for j in 0..=STEPS {
            let [u, v] = [j, i].map(|i| f64::from(i) / f64::from(STEPS));
            positions.push(patch.at(u, v));
            // Where points coincide there is none; the light of its neighbours hides that.
            normals.push(patch.normal(u, v).unwrap_or_default());
            painted.push(weight(chosen, u, v));
        }
    }
    let corner = |i: u32, j: u32| i * (STEPS + 1) + j;
    let quads: Vec<[u32; 4]> = (0..STEPS * STEPS)
        .map(|cell| (cell / STEPS, cell % STEPS))
        .map(|(i, j)| [corner(i, j), corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j)])
        .collect();
    let surface = answer.mesh(&mesh_from(positions, from_quads(&quads))?);
    let normals = answer.floats(normals.as_flattened());
    let painted = answer.floats(&painted);
    // The curve for this v has control points on the curves of the columns.
    let columns: [Bezier<3>; 4] =
        std::array::from_fn(|j| Bezier { control: std::array::from_fn(|i| patch.control[i][j]) });
    let sliding = Bezier { control: columns.map(|column| column.at(v)) };
    let line = |curve: &Bezier<3>| -> Vec<[f64; 3]> {
        (0..=CURVE).map(|i| curve.at(f64::from(i) / f64::from(CURVE))).collect()
    };
    let rails: Vec<Value> = columns.iter().map(|column| answer.floats(line(column).as_flattened())).collect();
    let slid = answer.floats(line(&sliding).as_flattened());
    let job = Job::default();
    let meshed = patches_to_mesh(&[patch], &Budget::pixels(pixels, view), &job).ok();
    let triangles = meshed.map(|meshed| {
        json!({
            "mesh": answer.mesh(&meshed.shape),
            "count": meshed.shape.faces().len(),
            "bound": meshed.bound.at_most(),
            "evidence": meshed.bound.evidence().as_str(),
        })
    });
    answer.facts = json!({
        "surface": surface,
        "normals": normals,
        "painted": painted,
        "point": patch.at(u, v),
        "tangents": patch.tangents(u, v),
        "normal": patch.normal(u, v),
        "weights": weights,
        "sum": weights.iter().sum::<f64>(),
        "chosen": weights[chosen],
        "rails": rails,
        "sliding": sliding.control,
        "slid": slid,
        "triangles": triangles,
    });
    Ok(answer)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts_of(u: f64, v: f64, pixels: f64) -> Value {
        let control: Vec<[f64; 3]> =
            (0..16).map(|row| [f64::from(row % 4), f64::from(row / 4), f64::from(row * row % 7)]).collect();
        let question = json!({
            "exhibit": "patch", "control": control, "u": u, "v": v, "chosen": 6, "pixels": pixels,
            "eye": [1.5, -9.0, 6.0], "target": [1.5, 1.5, 2.0],
        });
        patch(&ExhibitRequest::parse(question.to_string().as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn the_weights_blend_the_point_and_the_sliding_curve_meets_it() {
        let facts = facts_of(0.3, 0.8, 1.0);
        assert!((facts["sum"].as_f64().unwrap() - 1.0).abs() < 8.0 * f64::EPSILON);
        assert_eq!(facts["chosen"], facts["weights"][6]);
        let control: [[f64; 3]; 4] = serde_json::from_value(facts["sliding"].clone()).unwrap();
        let [met, point] =
            [Bezier { control }.at(0.3), serde_json::from_value(facts["point"].clone()).unwrap()];
        assert!((0..3).all(|k| (met[k] - point[k]).abs() < 32.0 * f64::EPSILON), "{met:?} {point:?}");
    }

    #[test]
    fn half_the_pixels_take_about_twice_the_triangles_with_a_proved_bound() {
        let [coarse, fine] = [2.0, 0.5].map(|pixels| facts_of(0.5, 0.5, pixels)["triangles"].clone());
        let count = |facts: &Value| facts["count"].as_u64().unwrap();
        assert!(count(&fine) > 2 * count(&coarse), "{} {}", count(&fine), count(&coarse));
        assert!(fine["bound"].as_f64() < coarse["bound"].as_f64());
        assert_eq!(fine["evidence"], json!("proved"));
    }
}
