//! A cage that is pulled: its limit surface, creases at chosen edges, and what one of its corners influences.
use super::answer::ExhibitAnswer;
use super::plane::or_text;
use super::request::ExhibitRequest;
use super::shapes::{CUBE, from_quads, mesh_from};
use chordal::explicit::Cage;
use chordal::explicit::subdivision::INFINITELY_SHARP;
use serde_json::json;

/// Steps along each side of a sheet of the limit surface. Chosen: it looks smooth, and follows a drag.
const STEPS: u32 = 10;

/// Answers `{"corners": [[x, y, z] × 8], "creases": [0, 3], "chosen": 7}`: the limit surface of a cube with
/// these corners and creased edges, and the share of the chosen corner in each of its points.
pub(super) fn pull(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["corners", "creases", "chosen"])?;
    let corners = request.points::<3>("corners", [8, 8])?;
    let edges = edges();
    let creases = request.rows("creases", edges.len())?;
    let chosen = request.number("chosen", [0.0, 7.0])? as usize;
    let creased: Vec<([u32; 2], f64)> =
        creases.iter().map(|edge| (edges[*edge as usize], INFINITELY_SHARP)).collect();
    let caged = |corners: Vec<[f64; 3]>| -> Result<Cage, String> {
        or_text(or_text(Cage::new(corners, CUBE))?.with_creases(&creased))
    };
    // The surface is linear in the corners: with 1 at the chosen one and 0 at the others its points are the
    // weights.
    let shares: Vec<[f64; 3]> = (0..8).map(|row| [f64::from(u8::from(row == chosen)), 0.0, 0.0]).collect();
    let (cage, shares) = (caged(corners)?, caged(shares)?);
    let (limit, share_of) = (or_text(cage.limit())?, or_text(shares.limit())?);
    let (mut positions, mut normals, mut weights) = (Vec::new(), Vec::new(), Vec::new());
    let mut quads = Vec::new();
    for i in 0..limit.n_sheets() {
        let start = positions.len() as u32;
        let (sheet, weighted) = (or_text(limit.sheet(i))?, or_text(share_of.sheet(i))?);
        for row in 0..=STEPS {
            for column in 0..=STEPS {
                let [u, v] = [column, row].map(|i| f64::from(i) / f64::from(STEPS));
                let jet = or_text(sheet.at(u, v))?;
                positions.push(jet.point);
                // Where the cage is folded flat there is none; the light of its neighbours hides that.
                normals.push(jet.normal.unwrap_or_default());
                weights.push(or_text(weighted.at(u, v))?.point[0]);
            }
        }
        quads.extend((0..STEPS * STEPS).map(|cell| {
            let a = start + cell / STEPS * (STEPS + 1) + cell % STEPS;
            [a, a + 1, a + STEPS + 2, a + STEPS + 1]
        }));
    }
    let largest = weights.iter().fold(0.0, |most, w| if *w > most { *w } else { most });
    let touched = weights.iter().filter(|w| **w > 0.0).count();
    let mut answer = ExhibitAnswer::default();
    let count = positions.len();
    let mesh = answer.mesh(&mesh_from(positions, from_quads(&quads))?);
    let normals = answer.floats(normals.as_flattened());
    let weights = answer.floats(&weights);
    answer.facts = json!({
        "limit": mesh,
        "normals": normals,
        "weights": weights,
        "edges": edges,
        "largest": largest,
        "touched": touched as f64 / count as f64,
        "points": count,
    });
    Ok(answer)
}

/// The twelve edges of the cube: its corners differ in one bit.
fn edges() -> Vec<[u32; 2]> {
    let bits =
        |row: u32| [1, 2, 4].into_iter().filter(move |bit| row & bit == 0).map(move |bit| [row, row | bit]);
    (0..8).flat_map(bits).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    fn facts_of(creases: &[u32]) -> Value {
        let corners: Vec<[f64; 3]> =
            (0..8).map(|i: u32| [0, 1, 2].map(|k| f64::from(i >> k & 1) * 2.0 - 1.0)).collect();
        let question = json!({ "exhibit": "pull", "corners": corners, "creases": creases, "chosen": 7 });
        pull(&ExhibitRequest::parse(question.to_string().as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn a_corner_moves_its_own_point_by_three_eighths_and_by_all_once_its_edges_are_creased() {
        assert_eq!(edges().len(), 12);
        let close = |facts: &Value, expected: f64| {
            let largest = facts["largest"].as_f64().unwrap();
            assert!((largest - expected).abs() < 1e-12, "{largest}"); // some tens of roundings
        };
        // The limit of a vertex of three edges: n / (n + 5) of itself.
        close(&facts_of(&[]), 3.0 / 8.0);
        let at_corner: Vec<u32> = (0..12).filter(|i| edges()[*i as usize].contains(&7)).collect();
        close(&facts_of(&at_corner[..2]), 2.0 / 3.0);
        close(&facts_of(&at_corner), 1.0);
    }
}
