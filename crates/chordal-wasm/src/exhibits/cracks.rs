//! Two adjacent patches: tessellated separately they crack, tessellated once along the shared side they do
//! not.
use super::answer::ExhibitAnswer;
use super::request::ExhibitRequest;
use super::shapes::{mesh_from, teapot};
use chordal::budget::View;
use chordal::budget::camera::{Camera, Projection, Screen};
use chordal::check::curves::{distance_to_polyline, largest_gap};
use chordal::check::validity;
use chordal::convert::patches_to_mesh;
use chordal::explicit::parametric::PatchSide;
use chordal::explicit::{Curve, CurveEnds, CurveSegment, Polyline, Topology};
use chordal::math::Box3;
use chordal::{Budget, Job, Mesh, Patch, Tolerance};
use serde_json::json;

/// The range of the segments of a side.
const COUNTS: [f64; 2] = [1.0, 16.0];
/// The picture in which a crack is measured in pixels: the initial size and the lens of the figure.
const SCREEN: Screen = Screen { width_px: 720, height_px: 480 };
const FOV_Y_DEG: f64 = 28.0; // as in studio/src/viewer/view.ts
/// The samples of each segment at which the width of the crack is measured. Chosen: more hardly change it.
const SAMPLES: u32 = 16;

/// Answers `{"left": 3, "right": 4, "cut": "own" | "shared", "patches": "hill" | "spout", "eye": [x, y, z],
/// "target": …}`: two patches that share a side, and the width of the crack there. With "own" each patch is
/// a grid of its own number; with "shared" both are meshed together, with the error of the second number as
/// the tolerance.
pub(super) fn cracks(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["left", "right", "cut", "patches", "eye", "target"])?;
    let counts = [request.number("left", COUNTS)? as u32, request.number("right", COUNTS)? as u32];
    let [eye, target] = [request.point::<3>("eye")?, request.point::<3>("target")?];
    let patches = match request.word_or("patches", &["hill", "spout"], "hill")? {
        "spout" => spout(),
        _ => hill(),
    };
    let curve = CurveSegment::Cubic(patches[1].side(PatchSide::Left));
    let curve = Curve::new(vec![curve], CurveEnds::Open).map_err(|error| error.to_string())?;
    let sides = counts.map(|count| side(&curve, count));
    let errors = sides.each_ref().map(|side| largest_gap(&curve, side).map_or(0.0, |gap| gap.distance));
    let (mesh, seams) = match request.word("cut", &["own", "shared"])? {
        "own" => (grids(&patches, counts)?, sides),
        _ => {
            let length = Tolerance::new(errors[1]).map_err(|error| error.to_string())?;
            let mesh = patches_to_mesh(&patches, &Budget::length(length), &Job::default())
                .map_err(|failure| failure.to_string())?
                .shape;
            let seam = seam_of(&mesh);
            (mesh, [seam.clone(), seam])
        }
    };
    let crack = widest(&seams);
    let has_point = |seam: &Polyline<3>, point: &[f64; 3]| seam.points.contains(point);
    let lonely = seams[0].points.iter().filter(|p| !has_point(&seams[1], p)).count()
        + seams[1].points.iter().filter(|p| !has_point(&seams[0], p)).count();
    let view = View::Camera(Camera {
        eye,
        target,
        up: [0.0, 0.0, 1.0],
        near: 0.0,
        projection: Projection::Perspective { fov_y_deg: FOV_Y_DEG },
        screen: SCREEN,
    });
    let place = Box3 { min: crack.1, max: crack.1 };
    let valid = validity(&mesh, Topology::Positions);
    // The patch of each face: the shared side is at x = 0.
    let patch_of_face: Vec<u32> = (0..mesh.faces().len())
        .map(|face| u32::from(mesh.corners(face).iter().map(|p| p[0]).sum::<f64>() > 0.0))
        .collect();
    let mut answer = ExhibitAnswer::default();
    let (shown, patch_of_face) = (answer.mesh(&mesh), answer.rows(&patch_of_face));
    let seams = seams.map(|seam| answer.floats(seam.points.as_flattened()));
    answer.facts = json!({
        "mesh": shown,
        "of": patch_of_face,
        "seams": seams,
        "width": crack.0,
        "at": crack.1,
        "pixels": if crack.0 == 0.0 { Some(0.0) } else { view.pixels_of(crack.0, &place) },
        "lonely": lonely,
        "components": valid.components,
        "boundary_loops": valid.boundary_loops,
        "triangles": mesh.faces().len(),
        "off": errors,
    });
    Ok(answer)
}

/// Two patches that share an arch at x = 0.
fn hill() -> [Patch; 2] {
    let patch = |from: f64, heights: [f64; 4]| Patch {
        control: std::array::from_fn(|i| {
            let y = 4.0 * (i as f64 / 3.0) - 2.0;
            let arch = [0.0, 2.6, 2.6, 0.0][i];
            std::array::from_fn(|j| [from + j as f64, y, arch * heights[j] - 0.8])
        }),
    };
    [patch(-3.0, [0.25, 0.6, 1.0, 1.0]), patch(0.0, [1.0, 1.0, 0.6, 0.25])]
}

/// The lower halves of two patches of the teapot, which share the lower side of its spout, at x = 0.
fn spout() -> [Patch; 2] {
    const SCALE: f64 = 2.0; // chosen: as large as the hill
    // In the file its left half is row 16 and its right one row 17, and the side that they share is at y = 0.
    let place = |[x, y, z]: [f64; 3]| [SCALE * y, SCALE * (2.5 - x), SCALE * (z - 1.5)];
    let placed = |patch: Patch| Patch { control: patch.control.map(|points| points.map(place)) };
    let patches = teapot();
    // Whole, they would share the upper side, too, and the crack of that would not be measured.
    let [[_, left], [right, _]] = [16, 17].map(|row: usize| patches[row].halves_u());
    [left, right].map(placed)
}

/// The side in equal steps.
fn side(curve: &Curve<3>, count: u32) -> Polyline<3> {
    let places: Vec<f64> = (0..=count).map(|i| f64::from(i) / f64::from(count)).collect();
    Polyline { points: places.iter().map(|t| curve.at(*t)).collect(), places, closed: false }
}

/// Each patch as a grid of its own.
fn grids(patches: &[Patch; 2], counts: [u32; 2]) -> Result<Mesh, String> {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for (patch, n) in patches.iter().zip(counts) {
        let start = positions.len() as u32;
        let step = |i: u32| f64::from(i) / f64::from(n);
        // In the direction of the shared side, against v.
        positions.extend((0..=n).flat_map(|i| (0..=n).map(move |j| patch.at(step(j), 1.0 - step(i)))));
        for i in 0..n {
            for j in 0..n {
                let [a, b] = [start + i * (n + 1) + j, start + (i + 1) * (n + 1) + j];
                faces.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
            }
        }
    }
    mesh_from(positions, faces)
}

/// The vertices of a mesh on the shared side, along which y only falls or only grows.
fn seam_of(mesh: &Mesh) -> Polyline<3> {
    // Exactly 0, as are all control points of the side.
    let mut points: Vec<[f64; 3]> = mesh.positions().iter().filter(|p| p[0] == 0.0).copied().collect();
    points.sort_by(|a, b| b[1].total_cmp(&a[1]));
    points.dedup();
    Polyline { points, places: Vec::new(), closed: false }
}

/// The largest sampled distance from a point of one seam to the other, and the point.
fn widest(seams: &[Polyline<3>; 2]) -> (f64, [f64; 3]) {
    let mut widest = (0.0, [0.0; 3]);
    for (seam, other) in [(&seams[0], &seams[1]), (&seams[1], &seams[0])] {
        for [a, b] in seam.segments() {
            for i in 0..=SAMPLES {
                let t = f64::from(i) / f64::from(SAMPLES);
                let point = std::array::from_fn(|k| (1.0 - t) * a[k] + t * b[k]);
                let distance = distance_to_polyline(point, other);
                // Points of the same segment differ by rounding, which is no crack.
                if distance > widest.0 + ROUNDING {
                    widest = (distance, point);
                }
            }
        }
    }
    widest
}

/// The rounding of points of a segment. Derived: 16 roundings of coordinates of at most 3.
const ROUNDING: f64 = 16.0 * 4.0 * f64::EPSILON;

#[cfg(test)]
mod tests {
    use super::*;

    fn facts_of(patches: &str, left: u32, right: u32, cut: &str) -> serde_json::Value {
        let question = format!(
            r#"{{"exhibit": "cracks", "left": {left}, "right": {right}, "cut": "{cut}", "patches": "{patches}",
                "eye": [6, -9, 5], "target": [0, 0, 0]}}"#
        );
        cracks(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn different_numbers_crack_and_one_shared_side_does_not() {
        for patches in ["hill", "spout"] {
            for (left, right) in [(3, 4), (3, 5), (3, 6), (4, 16), (5, 1)] {
                let own = facts_of(patches, left, right, "own");
                assert!(
                    own["pixels"].as_f64().unwrap() > 1.0 && own["lonely"].as_u64().unwrap() > 0,
                    "{own}"
                );
                assert_eq!(own["components"], json!(2));
                let shared = facts_of(patches, left, right, "shared");
                assert_eq!((&shared["pixels"], &shared["lonely"]), (&json!(0.0), &json!(0)));
                assert_eq!((&shared["components"], &shared["boundary_loops"]), (&json!(1), &json!(1)));
            }
            for n in 1..=16 {
                let same = facts_of(patches, n, n, "own");
                assert_eq!((&same["pixels"], &same["components"]), (&json!(0.0), &json!(1)), "{patches} {n}");
            }
        }
        // An arch of height 1.95 in the place of its chord.
        assert!((facts_of("hill", 5, 1, "own")["off"][1].as_f64().unwrap() - 0.75 * 2.6).abs() < 1e-9);
    }
}
