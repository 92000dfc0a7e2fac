//! A camera on a closed path, C1 or C2: where it is, how fast, and how it is accelerated at every moment.
use super::answer::ExhibitAnswer;
use super::plane::or_text;
use super::request::ExhibitRequest;
use super::shapes::{CUBE, from_quads, mesh_from};
use chordal::Mesh;
use chordal::explicit::CurveEnds;
use chordal::explicit::spline::{Knots, catmull_rom, periodic};
use chordal::math::elementary::atan2;
use serde_json::{Value, json};

/// Moments on each piece. Chosen: that of a picture, at sixty a second and 1.5 seconds a piece.
const MOMENTS: usize = 90;
/// The distance, in units, of the point that the camera looks at.
const AHEAD: f64 = 3.0; // chosen: far enough to look along the road
/// The acceleration that a hanging weight follows by 45 degrees. Chosen: that of the tightest bend at first.
const GRAVITY: f64 = 12.0;
/// Places of the blocks beside the road, with their heights.
const BLOCKS: [[f64; 3]; 14] = [
    [1.2, 0.9, 1.1],
    [3.4, 0.7, 0.7],
    [6.2, 0.6, 1.3],
    [9.2, 0.8, 0.8],
    [11.3, 2.2, 1.4],
    [11.2, 5.4, 0.9],
    [9.6, 7.3, 1.2],
    [6.4, 7.4, 0.8],
    [3.1, 7.3, 1.5],
    [0.8, 6.2, 0.8],
    [0.7, 3.4, 1.2],
    [4.2, 4.1, 1.6],
    [6.3, 3.7, 0.9],
    [8.2, 4.3, 1.3],
];

/// Answers `{"points": [[x, y] × 4 to 10], "kind": "C1" | "C2"}`: the closed path through the points, each
/// piece in the same time; at each moment the place, velocity, acceleration, and the direction of the view;
/// and the jump of the acceleration at each point.
pub(super) fn ride(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["points", "kind"])?;
    let points = request.points::<2>("points", [4, 10])?;
    let path = match request.word("kind", &["C1", "C2"])? {
        "C1" => or_text(catmull_rom(&points, Knots::Uniform, CurveEnds::Closed))?,
        _ => or_text(periodic(&points))?,
    };
    let pieces = path.segments();
    let size = |[x, y]: [f64; 2]| (x * x + y * y).sqrt();
    let (mut places, mut speeds, mut pushes) = (Vec::new(), Vec::new(), Vec::new());
    let (mut azimuths, mut tilts, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
    for piece in pieces {
        for i in 0..MOMENTS {
            let t = i as f64 / MOMENTS as f64;
            let (place, speed, push) = (piece.at(t), piece.tangent(t), piece.second_derivative(t));
            let fast = size(speed);
            // To the left of the motion.
            let sideways = if fast > 0.0 { (speed[0] * push[1] - speed[1] * push[0]) / fast } else { 0.0 };
            places.push(place);
            speeds.push(speed);
            pushes.push(push);
            azimuths.push(atan2(-speed[1], -speed[0]).to_degrees());
            tilts.push(atan2(sideways, GRAVITY).to_degrees());
            sizes.push(size(push));
        }
    }
    let jump = |i: usize| {
        let (before, after) = (&pieces[(i + pieces.len() - 1) % pieces.len()], &pieces[i]);
        let (a, b) = (before.second_derivative(1.0), after.second_derivative(0.0));
        size([b[0] - a[0], b[1] - a[1]])
    };
    let jumps: Vec<f64> = (0..pieces.len()).map(jump).collect();
    let largest = jumps
        .iter()
        .enumerate()
        .fold((0.0, 0), |most, (i, jump)| if *jump > most.0 { (*jump, i) } else { most });
    let mut answer = ExhibitAnswer::default();
    let mut floats = |rows: &[[f64; 2]]| -> Value { answer.floats(rows.as_flattened()) };
    let (places, speeds, pushes) = (floats(&places), floats(&speeds), floats(&pushes));
    let [azimuths, tilts, sizes_of] = [&azimuths, &tilts, &sizes].map(|row| answer.floats(row));
    let most = sizes.iter().fold(0.0, |most, x| if *x > most { *x } else { most });
    let blocks = answer.mesh(&blocks()?);
    answer.facts = json!({
        "places": places,
        "speeds": speeds,
        "pushes": pushes,
        "azimuths": azimuths,
        "tilts": tilts,
        "sizes": sizes_of,
        "most": most,
        "ahead": AHEAD,
        "moments": MOMENTS,
        "jumps": jumps,
        "largest": largest.0,
        "at": largest.1,
        // Rounding of sums of a few hundred units; see `check::curves::Join`.
        "is_smooth": largest.0 <= 1024.0 * f64::EPSILON * most,
        "blocks": blocks,
    });
    Ok(answer)
}

fn blocks() -> Result<Mesh, String> {
    let mut positions = Vec::new();
    let mut quads = Vec::new();
    for [x, y, height] in BLOCKS {
        let start = positions.len() as u32;
        positions.extend((0..8_u32).map(|i| {
            let bit = |k: u32| f64::from(i >> k & 1);
            [x + 0.4 * bit(0) - 0.2, y + 0.4 * bit(1) - 0.2, height * bit(2)]
        }));
        quads.extend(CUBE.map(|quad| quad.map(|i| start + i)));
    }
    mesh_from(positions, from_quads(&quads))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn acceleration_jumps_on_a_c1_path_and_not_on_a_c2_path() {
        let facts = ["C1", "C2"].map(|kind| {
            let points = [[1, 1], [6, 2], [11, 1], [10, 6], [6, 5], [2, 7]];
            let question = json!({ "exhibit": "ride", "points": points, "kind": kind });
            ride(&ExhibitRequest::parse(question.to_string().as_bytes()).unwrap().1).unwrap().facts
        });
        assert!(facts[0]["largest"].as_f64().unwrap() > 5.0, "{}", facts[0]["jumps"]);
        assert_eq!([&facts[0]["is_smooth"], &facts[1]["is_smooth"]], [&json!(false), &json!(true)]);
    }
}
