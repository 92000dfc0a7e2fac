//! Triangles over a grid of pixels: the signs of the edge functions at the centres, a rule for centres on an
//! edge, and colours blended from the corners.
use super::answer::ExhibitAnswer;
use super::plane::SIZE;
use super::request::ExhibitRequest;
use chordal::explicit::{Triangle, interpolate};
use chordal::math::exact::{Orientation, PointInTriangle, orient2d};
use serde_json::{Value, json};

/// The number of pixels in a row of the figure.
const COLUMNS: [f64; 2] = [6.0, 48.0];

/// Which triangle has a centre that lies on its edge.
#[derive(Clone, Copy)]
enum EdgeRule {
    /// One of the two that share the edge: the one to the right of a left edge, or below a top one.
    TopLeft,
    /// Both.
    Closed,
    /// Neither.
    Open,
}

/// Answers `{"corners": [[x, y] × 3 or 4], "colors": …, "columns": 24, "rule": "top-left" | "closed" | "open",
/// "pixel": [column, row]}`: the pixels of one triangle, or of two that share the edge from the first corner
/// to the third; rows count from below. Lengths are in pixels.
pub(super) fn pixels(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["corners", "colors", "columns", "rule", "pixel"])?;
    let columns = request.number("columns", COLUMNS)? as usize;
    let scale = columns as f64 / SIZE[0];
    let corners: Vec<[f64; 2]> =
        request.points::<2>("corners", [3, 4])?.into_iter().map(|p| p.map(|x| scale * x)).collect();
    let colors = request.points::<3>("colors", [corners.len(); 2])?;
    let rule = match request.word("rule", &["top-left", "closed", "open"])? {
        "top-left" => EdgeRule::TopLeft,
        "closed" => EdgeRule::Closed,
        _ => EdgeRule::Open,
    };
    let [column, row] = request.point::<2>("pixel")?;
    let all = [[0, 1, 2], [0, 2, 3]];
    let faces = &all[..corners.len() - 2];
    let triangle = |face: [usize; 3]| Triangle { corners: face.map(|i| corners[i]) };
    let rows = (SIZE[1] * scale) as usize;
    let (mut owners, mut signs, mut blends) = (Vec::new(), Vec::new(), Vec::new());
    let (mut covered, mut twice, mut missed) = (0, 0, 0);
    for at in (0..rows * columns).map(|i| centre((i % columns) as f64, (i / columns) as f64)) {
        let (mut owner, mut color, mut on_edges) = (0_u32, [0.0; 3], 0);
        for (i, face) in faces.iter().enumerate() {
            let triangle = triangle(*face);
            on_edges += usize::from(triangle.position(at) == PointInTriangle::Boundary);
            if is_filled(&triangle, at, rule) {
                owner |= 1 << i;
                if let Some(weights) = triangle.barycentric(at) {
                    interpolate(face.map(|i| &colors[i][..]), weights, &mut color);
                }
            }
        }
        covered += usize::from(owner != 0);
        twice += usize::from(owner == 3);
        // On an edge of both is on the shared one. Its ends are corners, where other edges matter too.
        missed += usize::from(owner == 0 && on_edges == 2 && !corners.contains(&at));
        signs
            .push(triangle(faces[0]).edge_functions(at).iter().fold(0, |code, edge| 3 * code + digit(*edge)));
        owners.push(owner);
        blends.push(color);
    }
    let areas: Vec<f64> = faces.iter().map(|face| triangle(*face).signed_area()).collect();
    let at = centre(column, row);
    let chosen: Vec<Value> = faces
        .iter()
        .map(|face| {
            let triangle = triangle(*face);
            json!({
                "edges": triangle.edge_functions(at),
                "weights": triangle.barycentric(at),
                "is_filled": is_filled(&triangle, at, rule),
            })
        })
        .collect();
    let mut answer = ExhibitAnswer::default();
    let (owners, signs) = (answer.rows(&owners), answer.rows(&signs));
    let blends = answer.floats(blends.as_flattened());
    answer.facts = json!({
        "columns": columns,
        "rows": rows,
        "owners": owners,
        "signs": signs,
        "colors": blends,
        "covered": covered,
        "twice": twice,
        "missed": missed,
        "area": areas.iter().fold(0.0, |sum, area| sum + area.abs()),
        // With opposite orientations they lie on the same side of the shared edge.
        "is_folded": areas.len() == 2 && areas[0] * areas[1] < 0.0,
        "chosen": chosen,
    });
    Ok(answer)
}

/// The centre of a pixel.
fn centre(column: f64, row: f64) -> [f64; 2] {
    [column + 0.5, row + 0.5]
}

/// The sign of an edge function: 0 if negative, 1 if zero, 2 if positive.
fn digit(edge: f64) -> u32 {
    u32::from(edge >= 0.0) + u32::from(edge > 0.0)
}

/// Whether a triangle has a centre. Corners may run either way round; all decisions are exact.
fn is_filled(triangle: &Triangle<2>, at: [f64; 2], rule: EdgeRule) -> bool {
    let [a, b, c] = triangle.corners;
    let [a, b, c] = match orient2d(a, b, c) {
        Orientation::Front => [a, b, c],
        Orientation::Back => [a, c, b],
        Orientation::Flat => return false,
    };
    [[a, b], [b, c], [c, a]].into_iter().all(|[from, to]| match (orient2d(from, to, at), rule) {
        (Orientation::Front, _) | (Orientation::Flat, EdgeRule::Closed) => true,
        (Orientation::Back, _) | (Orientation::Flat, EdgeRule::Open) => false,
        // The inside is left of an edge: so one that goes down is a left edge, and one that goes straight to
        // the left is a top edge.
        (Orientation::Flat, EdgeRule::TopLeft) => to[1] < from[1] || to[1] == from[1] && to[0] < from[0],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal::budget::camera::{Camera, Projection, Screen};
    use chordal::check::shading::overshade;
    use chordal::explicit::query::HitSides;
    use chordal::{Job, Mesh};

    fn facts_of(corners: &[[f64; 2]], rule: &str) -> Value {
        let question = json!({
            "exhibit": "pixels", "corners": corners, "colors": vec![[1, 0, 0]; corners.len()], "columns": 24,
            "rule": rule, "pixel": [3, 3],
        });
        pixels(&ExhibitRequest::parse(question.to_string().as_bytes()).unwrap().1).unwrap().facts
    }

    /// Corners and the middle of the shared edge are centres of pixels.
    const SQUARE: [[f64; 2]; 4] = [[1.25, 1.25], [6.25, 1.25], [6.25, 6.25], [1.25, 6.25]];

    #[test]
    fn two_triangles_that_share_an_edge_have_each_pixel_once() {
        let counts = |rule: &str| {
            let facts = facts_of(&SQUARE, rule);
            ["covered", "twice", "missed"].map(|name| facts[name].as_u64().unwrap())
        };
        // 10 by 10 pixels; 11 centres lie on the shared diagonal, its ends among them.
        assert_eq!(counts("top-left"), [100, 0, 0]);
        assert_eq!(counts("closed"), [121, 11, 0]);
        assert_eq!(counts("open"), [72, 0, 9]);
    }

    #[test]
    fn the_rule_is_that_of_the_rasterizer_of_check() {
        for corners in [[[1.0, 1.25], [10.5, 2.0], [5.25, 7.25]], [[2.25, 6.75], [2.25, 0.75], [9.75, 6.75]]]
        {
            let mesh = Mesh::new(corners.map(|[x, y]| [x, y, 0.0]).to_vec(), vec![[0, 1, 2]]).unwrap();
            let camera = Camera {
                eye: [6.0, 4.0, 10.0],
                target: [6.0, 4.0, 0.0],
                up: [0.0, 1.0, 0.0],
                near: 0.0,
                projection: Projection::Orthographic { height: 8.0 },
                screen: Screen { width_px: 24, height_px: 16 },
            };
            let shaded = overshade(&mesh, &camera, HitSides::Both, &Job::default()).unwrap();
            assert_eq!(facts_of(&corners, "top-left")["covered"], json!(shaded.covered_px));
        }
    }
}
