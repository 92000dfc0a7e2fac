//! Winding and culling: turned triangles show their back, and culling opens holes there.
use super::answer::ExhibitAnswer;
use super::request::ExhibitRequest;
use super::shapes;
use chordal::Mesh;
use chordal::check::validity;
use chordal::explicit::Topology;
use chordal::explicit::query::facing;
use serde_json::json;

/// Answers `{"shape": "ball", "flipped": [face, …], "eye": [x, y, z]}`: the ball with these faces turned, what
/// culling leaves out from that eye, and what the turned faces break.
pub(super) fn culling(asked: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    asked.only(&["shape", "flipped", "eye"])?;
    let mesh = match asked.word("shape", &["ball"])? {
        "ball" => shapes::ball(1)?,
        other => shapes::by_name(other)?,
    };
    let flipped = asked.rows("flipped", mesh.faces().len())?;
    let eye = asked.point::<3>("eye")?;
    let mut faces = mesh.faces().to_vec();
    flipped.iter().for_each(|face| faces[*face as usize].swap(1, 2));
    let turned = Mesh::new(mesh.positions().to_vec(), faces).map_err(|error| error.to_string())?;
    // The turned faces by themselves: those that the eye would see, and now does not, are the holes.
    let alone = flipped.iter().map(|face| turned.faces()[*face as usize]).collect();
    let alone = Mesh::new(mesh.positions().to_vec(), alone).map_err(|error| error.to_string())?;
    let (all, holes) = (facing(&turned, eye), facing(&alone, eye));
    let found = validity(&turned, Topology::Indices);
    let mut answer = ExhibitAnswer::default();
    let shown = answer.mesh(&turned);
    answer.facts = json!({
        "mesh": shown,
        "triangles": turned.faces().len(),
        "front": all.front,
        "back": all.back,
        "on_edge": all.on_edge,
        "back_share": all.back_share(),
        "holes": holes.back,
        "inconsistent_edges": found.inconsistent_edges.count,
        "oriented": found.oriented,
        "closed": found.closed,
        "signed_volume": found.measure.signed_volume,
    });
    Ok(answer)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(flipped: &str) -> serde_json::Value {
        let question =
            format!(r#"{{"exhibit": "culling", "shape": "ball", "flipped": {flipped}, "eye": [9, 1, 2]}}"#);
        culling(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn culling_leaves_out_about_half_and_a_turned_triangle_breaks_three_edges() {
        let whole = asked("[]");
        assert_eq!((&whole["inconsistent_edges"], &whole["holes"]), (&json!(0), &json!(0)));
        let share = whole["back_share"].as_f64().unwrap();
        assert!((0.4..0.65).contains(&share), "{share}");
        let holes: u64 = (0..80)
            .map(|face| {
                let one = asked(&format!("[{face}]"));
                assert_eq!(one["inconsistent_edges"], json!(3), "{face}");
                one["holes"].as_u64().unwrap()
            })
            .sum();
        assert_eq!(json!(holes), whole["front"]);
    }
}
