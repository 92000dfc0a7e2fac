//! Winding and culling: flipped triangles show their back, so culling opens holes there.
use super::answer::ExhibitAnswer;
use super::request::ExhibitRequest;
use super::shapes;
use chordal::Mesh;
use chordal::check::validity;
use chordal::explicit::Topology;
use chordal::explicit::query::facing;
use serde_json::json;

/// Answers `{"shape": "ball", "flipped": [face, …], "eye": [x, y, z]}`: the ball with these faces flipped,
/// the triangles that culling omits from that eye, and the properties that the flipped faces break.
pub(super) fn culling(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["shape", "flipped", "eye"])?;
    let mesh = match request.word("shape", &["ball"])? {
        "ball" => shapes::ball(1)?,
        other => shapes::by_name(other)?,
    };
    let flipped = request.rows("flipped", mesh.faces().len())?;
    let eye = request.point::<3>("eye")?;
    let mut faces = mesh.faces().to_vec();
    flipped.iter().for_each(|face| faces[*face as usize].swap(1, 2));
    let turned = Mesh::new(mesh.positions().to_vec(), faces).map_err(|error| error.to_string())?;
    // A mesh of the flipped faces only: those that face away now are the holes.
    let flipped_mesh = flipped.iter().map(|face| turned.faces()[*face as usize]).collect();
    let flipped_mesh =
        Mesh::new(mesh.positions().to_vec(), flipped_mesh).map_err(|error| error.to_string())?;
    let (sides, holes) = (facing(&turned, eye), facing(&flipped_mesh, eye));
    let valid = validity(&turned, Topology::Indices);
    let mut answer = ExhibitAnswer::default();
    let shown = answer.mesh(&turned);
    answer.facts = json!({
        "mesh": shown,
        "triangles": turned.faces().len(),
        "front": sides.front,
        "back": sides.back,
        "on_edge": sides.on_edge,
        "back_share": sides.back_share(),
        "holes": holes.back,
        "inconsistent_edges": valid.inconsistent_edges.count,
        "oriented": valid.oriented,
        "closed": valid.closed,
        "signed_volume": valid.measure.signed_volume,
    });
    Ok(answer)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts_of(flipped: &str) -> serde_json::Value {
        let question =
            format!(r#"{{"exhibit": "culling", "shape": "ball", "flipped": {flipped}, "eye": [9, 1, 2]}}"#);
        culling(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn culling_leaves_out_about_half_and_a_turned_triangle_breaks_three_edges() {
        let unflipped = facts_of("[]");
        assert_eq!((&unflipped["inconsistent_edges"], &unflipped["holes"]), (&json!(0), &json!(0)));
        let share = unflipped["back_share"].as_f64().unwrap();
        assert!((0.4..0.65).contains(&share), "{share}");
        let holes: u64 = (0..80)
            .map(|face| {
                let flipped = facts_of(&format!("[{face}]"));
                assert_eq!(flipped["inconsistent_edges"], json!(3), "{face}");
                flipped["holes"].as_u64().unwrap()
            })
            .sum();
        assert_eq!(json!(holes), unflipped["front"]);
    }
}
