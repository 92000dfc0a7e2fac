//! One shape as a field and as the mesh of its outline.
use super::answer::ExhibitAnswer;
use super::plane::{Region, below, distance_to, loops, once, or_text, raised, regions, value_at};
use super::request::ExhibitRequest;
use chordal::convert::{Spacing, curves_to_polylines};
use chordal::explicit::polygons::winding_number;
use chordal::explicit::{Arc, Curve, CurveEnds, CurveSegment, Polyline};
use chordal::implicit::Field;
use chordal::implicit::query::normals;
use chordal::implicit::shapes::rounded_rectangle;
use chordal::math::elementary::sin_cos;
use chordal::math::exact::{Orientation, orient2d};
use chordal::{Budget, Job, Tolerance};
use serde_json::json;
use std::f64::consts::FRAC_PI_2;
use std::sync::OnceLock;

/// The range of the tolerance.
const LENGTHS: [f64; 2] = [0.005, 1.0]; // defined: what the slider offers
/// The level curves that are drawn, besides the outline.
const LEVELS: [f64; 7] = [3.0, 2.5, 2.0, 1.5, 1.0, 0.5, 0.0];

/// Answers `{"point": [x, y], "length": 0.1}`: value, distance, normal and winding of the point in the field
/// and in the mesh.
pub(super) fn field(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["point", "length"])?;
    let point = request.point::<2>("point")?;
    let length = or_text(Tolerance::new(request.number("length", LENGTHS)?))?;
    let shape = frame()?;
    let tape = shape.tape();
    let outline = [contour([4.4, 2.9], 2.2)?, contour([3.0, 1.5], 0.8)?.reversed()];
    let job = Job::default();
    let outline_mesh =
        or_text(curves_to_polylines(&outline, &Budget::length(length), &job, Spacing::Fewest))?;
    let lines = &outline_mesh.shape;
    let distance = distance_to(lines)?.tape();
    let normal = |tape| or_text(normals(tape, &[raised(point)])).map(|normals| normals[0]);
    let windings: Vec<Option<i32>> = lines.iter().map(|line| winding_number(&line.points, point)).collect();
    let winding = windings.iter().try_fold(0, |sum, turns| turns.map(|turns| sum + turns));
    let [value, mesh_value] = [value_at(&tape, point)?, value_at(&distance, point)?];
    let mut answer = ExhibitAnswer::default();
    static DRAWN: OnceLock<Vec<Region>> = OnceLock::new();
    let levels = regions(&mut answer, once(&DRAWN, || below(shape.expr(), &LEVELS, 0.125))?);
    answer.facts = json!({
        "levels": levels,
        "value": value,
        "normal": normal(&tape)?,
        "quality": { "outside": shape.distance().outside.as_str(), "inside": shape.distance().inside.as_str() },
        "mesh": {
            "loops": loops(&mut answer, lines),
            "edges": lines.iter().map(Polyline::n_segments).sum::<usize>(),
            "bound": outline_mesh.bound.at_most(),
            "distance": mesh_value,
            "normal": normal(&distance)?,
            "winding": winding,
            "crossings": crossings(lines, point),
        },
        "apart": (value - mesh_value).abs(),
    });
    Ok(answer)
}

/// The angle by which the frame is turned.
const TURN_DEG: f64 = 14.0; // chosen: so that no side is level

/// One contour of the frame, by half its width and height and the radius of its corners: the same curve as
/// the zero set of the field.
fn contour(half: [f64; 2], radius: f64) -> Result<Curve<2>, String> {
    let (sin, cos) = sin_cos(TURN_DEG.to_radians());
    let turned = |[x, y]: [f64; 2]| [cos * x - sin * y, sin * x + cos * y];
    let axes = [turned([radius, 0.0]), turned([0.0, radius])];
    let mut arcs = Vec::new();
    for (k, [x, y]) in [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].into_iter().enumerate() {
        let centre = turned([x * (half[0] - radius), y * (half[1] - radius)]);
        let start = k as f64 * FRAC_PI_2;
        arcs.push(or_text(Arc::new([centre[0] + 6.0, centre[1] + 4.0], axes, start, FRAC_PI_2))?);
    }
    let mut pieces = Vec::new();
    for (k, arc) in arcs.iter().enumerate() {
        let before = arcs[(k + 3) % 4].ends()[1];
        pieces.push(CurveSegment::Line([before, arc.ends()[0]]));
        pieces.push(CurveSegment::Arc(*arc));
    }
    or_text(Curve::new(pieces, CurveEnds::Closed))
}

/// A rounded frame around a hole.
fn frame() -> Result<Field, String> {
    let frame = or_text(or_text(rounded_rectangle([7.4, 4.4], 1.5))?.shell(1.4))?;
    or_text(or_text(frame.rotated_deg([0.0, 0.0, 1.0], TURN_DEG))?.moved([6.0, 4.0, 0.0]))
}

/// The crossings of the ray to the right with edges, each +1 or −1 by the direction of the edge: their sum is
/// the winding number.
fn crossings(lines: &[Polyline<2>], point: [f64; 2]) -> Vec<([f64; 2], i32)> {
    let mut list = Vec::new();
    for [from, to] in lines.iter().flat_map(Polyline::segments) {
        // A corner at the height of the point counts as below it, so that it belongs to one crossing and
        // not to two.
        let [is_low, was_low] = [to[1] <= point[1], from[1] <= point[1]];
        let side = orient2d(from, to, point);
        let turn = match (was_low, is_low, side) {
            (true, false, Orientation::Front) => 1,
            (false, true, Orientation::Back) => -1,
            _ => continue,
        };
        let share = (point[1] - from[1]) / (to[1] - from[1]);
        list.push(([from[0] + share * (to[0] - from[0]), point[1]], turn));
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sign_and_winding_agree_and_the_distances_are_within_the_bound() {
        for (point, is_inside) in
            [([6.0, 4.0], false), ([9.3, 4.6], true), ([1.0, 1.0], false), ([3.0, 3.0], true)]
        {
            let question = json!({ "exhibit": "field", "point": point, "length": 0.1 }).to_string();
            let facts = field(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts;
            let mesh = &facts["mesh"];
            assert_eq!(facts["value"].as_f64().unwrap() < 0.0, is_inside);
            assert_eq!(mesh["winding"], json!(i32::from(is_inside)));
            let signs =
                mesh["crossings"].as_array().unwrap().iter().map(|crossing| crossing[1].as_i64().unwrap());
            assert_eq!(signs.sum::<i64>(), i64::from(is_inside));
            assert!(facts["apart"].as_f64() <= mesh["bound"].as_f64() && mesh["bound"].as_f64() <= Some(0.1));
            assert!(mesh["edges"].as_u64().unwrap() > 20);
        }
    }
}
