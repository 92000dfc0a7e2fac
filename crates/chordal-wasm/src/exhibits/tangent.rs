//! A texture on a triangle: the tangent, bitangent and normal that its coordinates give.
use super::answer::ExhibitAnswer;
use super::plane::or_text;
use super::request::ExhibitRequest;
use super::shapes::mesh_from;
use chordal::Mesh;
use chordal::explicit::{
    Attribute, Domain, Semantic, Shading, Topology, Triangle, interpolate, with_normals, with_tangents,
};
use serde_json::json;

/// The texture, from its upper row: a checker with an F, which shows a reflection.
const TEXTURE: [&str; 8] =
    [".#.#.#.#", "#FFFFF#.", ".F.#.#.#", "#FFFF.#.", ".F.#.#.#", "#F#.#.#.", ".F.#.#.#", "#.#.#.#."];
const SIDE: i64 = TEXTURE.len() as i64;

/// Answers `{"corners": [[x, y, z] × 3], "uv": [[u, v] × 3]}`: the triangle cut at the cells of the texture,
/// which repeats; the tangents by MikkTSpace, and the derivatives of the position by u and v. v runs up.
pub(super) fn tangent(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["corners", "uv"])?;
    let corners = request.points::<3>("corners", [3, 3])?;
    let uv = request.points::<2>("uv", [3, 3])?;
    let mesh = mesh_from(corners.clone(), vec![[0, 1, 2]])?;
    let looks = Attribute {
        semantic: Semantic::TexCoord(0),
        domain: Domain::Vertex,
        width: 2,
        values: uv.as_flattened().to_vec(),
    };
    let mesh = or_text(mesh.with_attribute(looks))?;
    let mesh = or_text(with_normals(&mesh, Topology::Indices, Shading::Flat))?;
    let with = with_tangents(&mesh, 0).ok_or("the triangle has no normals or no coordinates")?;
    let with = or_text(with)?;
    let row = with.attribute(&Semantic::Tangent).map(|rows| rows.row(0).to_vec()).unwrap_or_default();
    let (tangent, sign) = ([row[0], row[1], row[2]], row[3]);
    let space = Triangle { corners: [corners[0], corners[1], corners[2]] };
    let plane = Triangle { corners: [uv[0], uv[1], uv[2]] };
    let normal = space.normal();
    let area = plane.signed_area();
    let is_mapped = area != 0.0 && normal.is_some();
    let bitangent = normal.map(|n| cross(n, tangent).map(|x| sign * x));
    // The position is affine in u and v, so a derivative is a difference over a step of one.
    let at = |point: [f64; 2]| {
        let mut place = [0.0; 3];
        let weights = plane.barycentric(point)?;
        interpolate([&corners[0], &corners[1], &corners[2]], weights, &mut place);
        Some(place)
    };
    let step = |du: f64, dv: f64| -> Option<[f64; 3]> {
        let (from, to) = (at(uv[0])?, at([uv[0][0] + du, uv[0][1] + dv])?);
        Some(std::array::from_fn(|k| to[k] - from[k]))
    };
    let along = [step(1.0, 0.0), step(0.0, 1.0)];
    let (cells, groups) = if is_mapped { textured(&corners, &plane)? } else { (mesh.clone(), vec![0]) };
    let mut answer = ExhibitAnswer::default();
    let shown = answer.mesh(&cells);
    let groups = answer.rows(&groups);
    answer.facts = json!({
        "mesh": shown,
        "of": groups,
        "texture": TEXTURE.map(|row| row.bytes().map(group).collect::<Vec<_>>()),
        "is_mapped": is_mapped,
        "tangent": tangent,
        "bitangent": bitangent,
        "normal": normal,
        "sign": sign,
        "along": along,
        "lengths": along.map(|step| step.map(|v| v.iter().map(|x| x * x).sum::<f64>().sqrt())),
        "uv_area": area,
        "middle": std::array::from_fn::<f64, 3, _>(|k| (corners[0][k] + corners[1][k] + corners[2][k]) / 3.0),
    });
    Ok(answer)
}

/// 0 for a light cell, 1 for a dark one, 2 for the F.
fn group(cell: u8) -> u32 {
    match cell {
        b'.' => 0,
        b'#' => 1,
        _ => 2,
    }
}

/// The group of a cell, counted from the lower left; the texture repeats.
fn group_at(column: i64, row: i64) -> u32 {
    let line = TEXTURE[(SIDE - 1 - row.rem_euclid(SIDE)) as usize];
    group(line.as_bytes()[column.rem_euclid(SIDE) as usize])
}

/// The triangle in parts of one cell each, and the group of each face.
fn textured(corners: &[[f64; 3]], plane: &Triangle<2>) -> Result<(Mesh, Vec<u32>), String> {
    let scaled = plane.corners.map(|p| p.map(|x| SIDE as f64 * x));
    let range = |k: usize| {
        let (low, high) = scaled.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
            (if p[k] < low { p[k] } else { low }, if p[k] > high { p[k] } else { high })
        });
        low.floor() as i64..high.ceil() as i64
    };
    let (mut positions, mut faces, mut groups) = (Vec::new(), Vec::new(), Vec::new());
    for row in range(1) {
        for column in range(0) {
            let cell = [column, row].map(|i| i as f64);
            let mut part = scaled.to_vec();
            for k in 0..2 {
                part = clipped(&part, |p| p[k] - cell[k]);
                part = clipped(&part, |p| cell[k] + 1.0 - p[k]);
            }
            let start = positions.len() as u32;
            for point in &part {
                let mut place = [0.0; 3];
                let weights = plane.barycentric(point.map(|x| x / SIDE as f64)).unwrap_or_default();
                interpolate([&corners[0], &corners[1], &corners[2]], weights, &mut place);
                positions.push(place);
            }
            for i in 2..part.len() as u32 {
                // The order of the corners in space is that of the parts in the texture, so each part has it.
                faces.push([start, start + i - 1, start + i]);
                groups.push(group_at(column, row));
            }
        }
    }
    Ok((mesh_from(positions, faces)?, groups))
}

/// The part of a convex polygon where a linear function is not negative.
fn clipped(ring: &[[f64; 2]], height: impl Fn([f64; 2]) -> f64) -> Vec<[f64; 2]> {
    let mut kept = Vec::new();
    for (i, p) in ring.iter().enumerate() {
        let q = ring[(i + 1) % ring.len()];
        let (here, next) = (height(*p), height(q));
        if here >= 0.0 {
            kept.push(*p);
        }
        if here * next < 0.0 {
            let t = here / (here - next);
            kept.push(std::array::from_fn(|k| p[k] + t * (q[k] - p[k])));
        }
    }
    kept
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i] * b[j] - a[j] * b[i]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal::check::validity;
    use serde_json::Value;

    fn facts_of(uv: [[f64; 2]; 3]) -> Value {
        let question =
            json!({ "exhibit": "tangent", "corners": [[0, 0, 0], [2, 0, 0], [0, 2, 0]], "uv": uv });
        tangent(&ExhibitRequest::parse(question.to_string().as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn a_mirrored_texture_has_the_other_hand_and_a_collapsed_one_no_tangent() {
        let plain = facts_of([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
        assert_eq!((&plain["tangent"], &plain["sign"]), (&json!([1.0, 0.0, 0.0]), &json!(1.0)));
        assert_eq!(
            (&plain["bitangent"], &plain["along"]),
            (&json!([0.0, 1.0, 0.0]), &json!([[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]))
        );
        let mirrored = facts_of([[1.0, 0.0], [0.0, 0.0], [1.0, 1.0]]);
        assert_eq!((&mirrored["tangent"], &mirrored["sign"]), (&json!([-1.0, 0.0, 0.0]), &json!(-1.0)));
        let bitangent: Vec<f64> = serde_json::from_value(mirrored["bitangent"].clone()).unwrap();
        assert_eq!(bitangent, [0.0, 1.0, 0.0]);
        assert_eq!(facts_of([[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]])["is_mapped"], json!(false));
    }

    #[test]
    fn the_parts_cover_the_triangle_once() {
        let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 1.0], [0.5, 2.0, 0.0]];
        for uv in [[[0.1, -0.2], [1.3, 0.4], [0.2, 0.9]], [[0.9, 0.1], [0.1, 0.1], [0.6, 1.4]]] {
            let (mesh, groups) = textured(&corners, &Triangle { corners: uv }).unwrap();
            let area = Triangle { corners }.area();
            assert!(
                (validity(&mesh, Topology::Indices).measure.area - area).abs() < 1e-12 * area,
                "roundings of about a hundred sums"
            );
            assert_eq!(groups.len(), mesh.faces().len());
        }
    }
}
