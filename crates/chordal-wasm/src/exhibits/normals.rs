//! Normals of faces, of vertices, or of vertices split at hard edges.
use super::answer::ExhibitAnswer;
use super::request::ExhibitRequest;
use super::shapes;
use chordal::explicit::{NormalWeight, Semantic, Shading, Topology, Triangle, with_normals};
use serde_json::{Value, json};

/// Bytes of a vertex with position and normal, in single precision.
const VERTEX_BYTES: usize = 24; // defined: 3 × 4 bytes each

/// Answers `{"shape": "cube", "crease_deg": 30}`: the shape with one normal a vertex; vertices are split at
/// edges sharper than the angle.
pub(super) fn normals(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["shape", "crease_deg"])?;
    let mesh = shapes::by_name(request.word("shape", &["teapot", "cube", "cylinder", "ball"])?)?;
    let angle_rad = request.number("crease_deg", [0.0, 180.0])?.to_radians();
    let shading = Shading::Crease { angle_rad, weight: NormalWeight::Angle };
    let creased = with_normals(&mesh, Topology::Indices, shading).map_err(|error| error.to_string())?;
    let mut answer = ExhibitAnswer::default();
    let shown = answer.mesh(&creased);
    let normals: Value = match creased.attribute(&Semantic::Normal) {
        Some(normals) => answer.floats(&normals.values),
        None => Value::Null,
    };
    let face_normals: Vec<[f64; 3]> = (0..mesh.faces().len())
        .map(|face| Triangle::from_face(&mesh, face).normal().unwrap_or_default())
        .collect();
    let face_normals = answer.floats(face_normals.as_flattened());
    answer.facts = json!({
        "mesh": shown,
        "normals": normals,
        "face_normals": face_normals,
        "vertices": creased.positions().len(),
        "positions": creased.n_positions(),
        "triangles": creased.faces().len(),
        "bytes": VERTEX_BYTES * creased.positions().len(),
    });
    Ok(answer)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vertices(shape: &str, crease_deg: f64) -> u64 {
        let question = format!(r#"{{"exhibit": "normals", "shape": "{shape}", "crease_deg": {crease_deg}}}"#);
        let facts = normals(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts;
        facts["vertices"].as_u64().unwrap()
    }

    #[test]
    fn a_cube_has_24_vertices_where_its_edges_are_hard_and_8_where_they_are_not() {
        assert_eq!((vertices("cube", 30.0), vertices("cube", 89.0), vertices("cube", 91.0)), (24, 24, 8));
        assert_eq!((vertices("ball", 180.0), vertices("ball", 0.0)), (162, 960));
        assert!(vertices("cylinder", 40.0) > vertices("cylinder", 100.0));
        assert!(vertices("cylinder", 0.0) > vertices("cylinder", 40.0));
    }
}
