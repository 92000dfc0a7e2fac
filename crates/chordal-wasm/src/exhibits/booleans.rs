//! A block minus a drill: by the textbook method for meshes, and as a field that the library meshes.
use super::answer::ExhibitAnswer;
use super::bsp::{self, Facet};
use super::plane::or_text;
use super::request::ExhibitRequest;
use super::shapes;
use chordal::check::validity;
use chordal::convert::field_to_mesh;
use chordal::explicit::Topology;
use chordal::implicit::Field;
use chordal::implicit::shapes::{cuboid, prism};
use chordal::math::elementary::sin_cos;
use chordal::{Budget, Failure, Job, Mesh, Tolerance};
use serde_json::json;
use std::collections::BTreeMap;

/// Half the sides of the block.
const BLOCK: [f64; 3] = [1.3, 1.0, 0.5];
/// The sides of the drill and its radius.
const SIDES: u32 = 24;
const RADIUS: f64 = 0.42;
/// Its height: it always reaches out of the top.
const HEIGHT: f64 = 2.0;
/// The error of the field's mesh.
const CLOSE: f64 = 0.01; // chosen: below a pixel of the figure

/// Answers `{"way": "textbook", "place": [x, y], "tip": z, "tilt": radians}`: the block without the drill; the middle of
/// its lowest face is at `place` and `tip`.
pub(super) fn booleans(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["way", "place", "tip", "tilt"])?;
    let way = request.word("way", &["textbook", "field"])?;
    let [x, y] = request.point::<2>("place")?;
    let tip = request.number("tip", [-0.8, 0.3])?;
    let tilt = request.number("tilt", [0.0, 0.2])?;
    let tool = Drill { at: [x, y, tip], tilt };
    let drill = tool.mesh()?;
    let naive = textbook(&block()?, &drill)?;
    // Asked for alone: to mesh a field takes a thousand times as long.
    let sound = if way == "field" { Some(tool.field_mesh()?) } else { None };
    let mesh = sound.as_ref().unwrap_or(&naive);
    let shown = validity(mesh, Topology::Indices);
    let open = unpaired(mesh);
    let mut answer = ExhibitAnswer::default();
    let [drawn, drill] = [mesh, &drill].map(|mesh| answer.mesh(mesh));
    answer.facts = json!({
        "mesh": drawn,
        "edges": answer.edges(mesh.positions(), mesh.faces()),
        "drill": drill,
        "open": answer.floats(open.as_flattened()),
        "open_edges": open.len() / 2,
        "closed": shown.closed,
        "triangles": mesh.faces().len(),
        "textbook": unpaired(&naive).len() / 2,
        "field": sound.as_ref().map(|mesh| unpaired(mesh).len() / 2),
        "volume": shown.measure.signed_volume,
        "close": bsp::CLOSE,
    });
    Ok(answer)
}

/// The ends of all edges that do not have two triangles, one in each direction.
fn unpaired(mesh: &Mesh) -> Vec<[f64; 3]> {
    let mut counts: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    for face in mesh.faces() {
        for k in 0..3 {
            let [a, b] = [face[k], face[(k + 1) % 3]];
            *counts.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
        }
    }
    let open = counts.iter().filter(|(_, count)| **count != 0);
    open.flat_map(|(ends, _)| ends.map(|row| mesh.positions()[row as usize])).collect()
}

fn textbook(block: &Mesh, drill: &Mesh) -> Result<Mesh, String> {
    let facets = |mesh: &Mesh| {
        let corners = |face: &[u32; 3]| face.map(|row| mesh.positions()[row as usize]).to_vec();
        mesh.faces().iter().filter_map(|face| Facet::new(corners(face))).collect::<Vec<_>>()
    };
    let (positions, faces) = bsp::triangles(&bsp::difference(facets(block), facets(drill)));
    shapes::mesh_from(positions, faces)
}

fn block() -> Result<Mesh, String> {
    let corners =
        (0..8_u32).map(|i| [0, 1, 2].map(|k| BLOCK[k as usize] * (f64::from(i >> k & 1) * 2.0 - 1.0)));
    shapes::mesh_from(corners.collect(), shapes::from_quads(&shapes::CUBE))
}

/// A prism that stands on its tip, tilted about the y axis.
struct Drill {
    at: [f64; 3],
    tilt: f64,
}

impl Drill {
    fn mesh(&self) -> Result<Mesh, String> {
        let (sin, cos) = sin_cos(self.tilt);
        let mut positions = Vec::new();
        for z in [0.0, HEIGHT] {
            for i in 0..SIDES {
                let (y, x) = sin_cos(std::f64::consts::TAU * f64::from(i) / f64::from(SIDES));
                let [x, y] = [RADIUS * x, RADIUS * y];
                let [ax, ay, az] = self.at;
                positions.push([ax + cos * x + sin * z, ay + y, az - sin * x + cos * z]);
            }
        }
        let sides = (0..SIDES).map(|i| [i, (i + 1) % SIDES, SIDES + (i + 1) % SIDES, SIDES + i]);
        let mut faces = shapes::from_quads(&sides.collect::<Vec<_>>());
        faces.extend((1..SIDES - 1).map(|i| [0, i + 1, i]));
        faces.extend((1..SIDES - 1).map(|i| [SIDES, SIDES + i, SIDES + i + 1]));
        shapes::mesh_from(positions, faces)
    }

    /// The block without it, by one line: max(a, −b).
    fn field_mesh(&self) -> Result<Mesh, String> {
        let block: Field = or_text(cuboid(BLOCK.map(|half| 2.0 * half)))?;
        let standing = or_text(or_text(prism(SIDES, RADIUS, HEIGHT))?.moved([0.0, 0.0, 0.5 * HEIGHT]))?;
        let tilted = or_text(standing.rotated_deg([0.0, 1.0, 0.0], self.tilt.to_degrees()))?;
        let drill = or_text(tilted.moved(self.at))?;
        let budget = Budget::length(or_text(Tolerance::new(CLOSE))?);
        // A wall of a hundred-thousandth cannot be proved to that error by so few triangles; the mesh is as closed.
        // A draft: here it is asked whether the mesh is closed, not how exact it is.
        let job = Job::default();
        job.finish();
        let meshed = field_to_mesh(&block.difference(&drill), &budget, &job);
        Ok(or_text(meshed.or_else(Failure::best_effort))?.shape)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(way: &str, tip: f64, tilt: f64) -> serde_json::Value {
        let question =
            json!({ "exhibit": "booleans", "way": way, "place": [0.3, 0.1], "tip": tip, "tilt": tilt });
        booleans(&ExhibitRequest::parse(question.to_string().as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn the_textbook_method_is_right_in_general_places_and_the_field_everywhere() {
        let mut n_cracked = 0;
        for tilt in [0.0, 0.000_03, 0.000_1, 0.1] {
            assert_eq!(at("textbook", -0.2, tilt)["textbook"], 0, "{tilt}");
            for tip in [-0.499_98, -0.499_99, -0.5, -0.500_01, -0.500_02] {
                let facts = at("field", tip, tilt);
                assert_eq!((&facts["field"], &facts["closed"]), (&json!(0), &json!(true)), "{tip} {tilt}");
                n_cracked += u32::from(facts["textbook"] != 0);
            }
        }
        assert!(n_cracked > 5, "{n_cracked}");
    }
}
