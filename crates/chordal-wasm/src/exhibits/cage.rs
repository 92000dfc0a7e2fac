//! Catmull–Clark: a cage, its rounds of subdivision, its limit surface, and the error of each round.
use super::answer::ExhibitAnswer;
use super::request::ExhibitRequest;
use super::shapes::{from_quads, mesh_from};
use chordal::check::vertex_deviation;
use chordal::explicit::{Cage, InvalidCage};
use chordal::{Job, Mesh};
use serde_json::json;

/// Rounds.
const LEVELS: [f64; 2] = [0.0, 5.0];
/// The sharpness of the crease: the rounds in which its edges follow the rule of creases.
const SHARPNESS: [f64; 2] = [0.0, 6.0];
/// Steps along each side of a sheet of the limit surface. Chosen: the distance is measured at 6174 points.
const STEPS: u32 = 20;
/// The edges that are creased: the rim of the foot.
const RIM: [[u32; 2]; 4] = [[0, 1], [1, 2], [2, 3], [3, 0]];

/// Answers `{"level": 2, "sharpness": 1.5}`: the cage, its polygons after `level` rounds, its limit surface,
/// and for each round so far the distance of the farthest point of the limit surface.
pub(super) fn cage(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["level", "sharpness"])?;
    let level = request.number("level", LEVELS)? as u32;
    let sharpness = request.number("sharpness", SHARPNESS)?;
    let text = |error: InvalidCage| error.to_string();
    let cage = bottle(sharpness).map_err(text)?;
    let job = Job::default();
    let mut errors: Vec<f64> = Vec::new();
    let mut rounds = vec![cage.clone()];
    for _ in 0..level {
        let next = rounds[rounds.len() - 1].refined_times(1).map_err(text)?;
        rounds.push(next);
    }
    let (limit, normals) = limit_mesh(&cage)?;
    let mut distances = Vec::new();
    for round in &rounds {
        distances =
            vertex_deviation(&limit, &triangles(round)?, &job).map_err(|error| format!("{error:?}"))?;
        errors.push(distances.iter().fold(0.0, |most, far| if *far > most { *far } else { most }));
    }
    let round = &rounds[level as usize];
    let mut answer = ExhibitAnswer::default();
    let mesh = answer.mesh(&triangles(round)?);
    let edges = edges_of(round);
    let edges = answer.floats(edges.as_flattened());
    let control = edges_of(&cage);
    let control = answer.floats(control.as_flattened());
    let rim: Vec<[f64; 3]> = RIM.iter().flatten().map(|row| cage.positions()[*row as usize]).collect();
    let rim = answer.floats(rim.as_flattened());
    let limit = answer.mesh(&limit);
    let normals = answer.floats(normals.as_flattened());
    let (distances, points) = (answer.floats(&distances), distances.len());
    answer.facts = json!({
        "mesh": mesh,
        "edges": edges,
        "cage": control,
        "rim": rim,
        "limit": limit,
        "limit_normals": normals,
        "distances": distances,
        "errors": errors,
        "points": points,
        "faces": round.n_faces(),
        "vertices": round.positions().len(),
        "cage_faces": cage.n_faces(),
    });
    Ok(answer)
}

/// A bottle: a foot, a shoulder and a neck, of 14 quads.
fn bottle(sharpness: f64) -> Result<Cage, InvalidCage> {
    // Half width and height of each ring of vertices.
    let rings = [(1.2, -1.6), (1.2, 0.1), (0.55, 0.7), (0.65, 1.8)];
    let corner =
        |(half, z): (f64, f64)| [[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]];
    let positions: Vec<[f64; 3]> = rings.into_iter().flat_map(corner).collect();
    let mut faces = vec![vec![3, 2, 1, 0], vec![12, 13, 14, 15]];
    for ring in 0..3 {
        let low = 4 * ring;
        faces.extend((0..4).map(|i| {
            let next = (i + 1) % 4;
            vec![low + i, low + next, low + 4 + next, low + 4 + i]
        }));
    }
    let cage = Cage::new(positions, &faces)?;
    if sharpness > 0.0 { cage.with_creases(&RIM.map(|ends| (ends, sharpness))) } else { Ok(cage) }
}

/// Two triangles for each quad.
fn triangles(cage: &Cage) -> Result<Mesh, String> {
    let quads: Vec<[u32; 4]> = cage.faces().map(|f| [f[0], f[1], f[2], f[3]]).collect();
    mesh_from(cage.positions().to_vec(), from_quads(&quads))
}

/// The ends of each edge, once.
fn edges_of(cage: &Cage) -> Vec<[f64; 3]> {
    let at = |row: u32| cage.positions()[row as usize];
    let sides =
        cage.faces().flat_map(|face| (0..face.len()).map(move |i| [face[i], face[(i + 1) % face.len()]]));
    // The surface is closed, so each edge occurs once in each direction.
    sides.filter(|[a, b]| a < b).flat_map(|[a, b]| [at(a), at(b)]).collect()
}

/// Points of the limit surface with its normals, sheet by sheet.
fn limit_mesh(cage: &Cage) -> Result<(Mesh, Vec<[f64; 3]>), String> {
    let text = |error: InvalidCage| error.to_string();
    let limit = cage.limit().map_err(text)?;
    let (mut positions, mut normals, mut quads) = (Vec::new(), Vec::new(), Vec::new());
    for sheet in 0..limit.n_sheets() {
        let (sheet, start) = (limit.sheet(sheet).map_err(text)?, positions.len() as u32);
        for i in 0..=STEPS {
            for j in 0..=STEPS {
                let [u, v] = [j, i].map(|i| f64::from(i) / f64::from(STEPS));
                let jet = sheet.at(u, v).map_err(text)?;
                positions.push(jet.point);
                // Only the end of a crease has no normal; the light of its neighbours hides that.
                normals.push(jet.normal.unwrap_or_default());
            }
        }
        for i in 0..STEPS {
            for j in 0..STEPS {
                let [a, b] = [start + i * (STEPS + 1) + j, start + (i + 1) * (STEPS + 1) + j];
                quads.push([a, a + 1, b + 1, b]);
            }
        }
    }
    Ok((mesh_from(positions, from_quads(&quads))?, normals))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(level: u32, sharpness: f64) -> Vec<f64> {
        let question = format!(r#"{{"exhibit": "cage", "level": {level}, "sharpness": {sharpness}}}"#);
        let facts = cage(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts;
        assert_eq!(facts["faces"], json!(14 * 4_u32.pow(level)));
        facts["errors"].as_array().unwrap().iter().map(|error| error.as_f64().unwrap()).collect()
    }

    #[test]
    fn each_round_leaves_about_a_quarter() {
        let smooth = errors(4, 0.0);
        assert_eq!(smooth.len(), 5);
        for pair in smooth.windows(2).skip(1) {
            assert!((3.0..5.0).contains(&(pair[0] / pair[1])), "{smooth:?}");
        }
        let sharp = errors(3, 6.0);
        assert!(sharp[3] < sharp[2] && sharp[2] < sharp[1], "{sharp:?}");
    }
}
