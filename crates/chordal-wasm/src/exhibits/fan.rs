//! A polygon cut into n − 2 triangles: by diagonals that somebody chooses, by a fan, by ear clipping.
use super::answer::ExhibitAnswer;
use super::plane::raised;
use super::request::ExhibitRequest;
use chordal::explicit::polygons::{fan as fan_of, is_convex};
use chordal::explicit::{Triangle, triangulate};
use chordal::math::exact::{Orientation, orient2d};
use serde_json::{Value, json};

/// The most corners of the polygon.
const MOST: usize = 12;

/// Answers `{"points": [[x, y] × 3 to 12], "apex": 0, "cuts": [[i, j], …]}`: the fan from the corner `apex`,
/// the triangles of the library's ear clipping, and the pieces after the cuts, with the diagonals that can
/// still be cut. A cut that is no diagonal of a piece is left out.
pub(super) fn fan(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["points", "apex", "cuts"])?;
    let points = request.points::<2>("points", [3, MOST])?;
    let n = points.len();
    let apex = request.number("apex", [0.0, n as f64 - 1.0])? as usize;
    let cuts = request.points::<2>("cuts", [0, MOST])?;
    let area = |face: &[u32; 3]| Triangle { corners: face.map(|i| points[i as usize]) }.signed_area();
    let fanned: Vec<[u32; 3]> =
        fan_of(n as u32).into_iter().map(|face| face.map(|i| (i + apex as u32) % n as u32)).collect();
    // A fan has the polygon's signed area, whatever its shape.
    let total: f64 = fanned.iter().map(area).sum();
    let is_folded = |face: &&[u32; 3]| area(face) * total < 0.0;
    let ears = triangulate::polygon(&points.iter().map(|p| raised(*p)).collect::<Vec<_>>());
    let mut pieces: Vec<Vec<usize>> =
        vec![if total < 0.0 { (0..n).rev().collect() } else { (0..n).collect() }];
    let mut made: Vec<[usize; 2]> = Vec::new();
    for cut in cuts {
        let ends = cut.map(|i| i as usize);
        let found = pieces.iter().position(|ring| split(&points, ring, ends).is_some());
        if let Some((i, halves)) = found.and_then(|i| Some((i, split(&points, &pieces[i], ends)?))) {
            pieces.splice(i..=i, halves);
            made.push(ends);
        }
    }
    let allowed: Vec<[usize; 2]> = (0..n)
        .flat_map(|i| (i + 1..n).map(move |j| [i, j]))
        .filter(|ends| pieces.iter().any(|ring| split(&points, ring, *ends).is_some()))
        .collect();
    let triangles = |faces: &[[u32; 3]]| -> Value {
        json!({ "triangles": faces, "folded": faces.iter().filter(is_folded).count(),
            "is_folded": faces.iter().map(|face| is_folded(&face)).collect::<Vec<_>>() })
    };
    Ok(ExhibitAnswer::new(json!({
        "needed": n - 2,
        "is_convex": is_convex(&points),
        "area": total.abs(),
        // Ear clipping folds a triangle only if the polygon crosses itself.
        "is_simple": ears.is_exact(),
        "fan": triangles(&fanned),
        "ears": triangles(&ears.triangles),
        "pieces": pieces,
        "made": made,
        "allowed": allowed,
        "cut_off": pieces.iter().filter(|ring| ring.len() == 3).count(),
    })))
}

/// The two parts of a ring on either side of a diagonal, if it is one: inside the ring, touching it only at
/// its ends. Exact. Rings are counter-clockwise.
fn split(points: &[[f64; 2]], ring: &[usize], ends: [usize; 2]) -> Option<[Vec<usize>; 2]> {
    let n = ring.len();
    let [a, b] = ends.map(|end| ring.iter().position(|i| *i == end));
    let (a, b) = (a?, b?);
    let (a, b) = if a < b { (a, b) } else { (b, a) };
    if b - a < 2 || b - a == n - 1 {
        return None;
    }
    let at = |i: usize| points[ring[i % n]];
    let (p, q) = (at(a), at(b));
    let is_inside =
        is_in_cone([at(a + n - 1), p, at(a + 1)], q) && is_in_cone([at(b + n - 1), q, at(b + 1)], p);
    let mut sides = (0..n).filter(|i| ![a, b].contains(i) && ![a, b].contains(&((i + 1) % n)));
    let is_free = is_inside && sides.all(|i| !touches([p, q], [at(i), at(i + 1)]));
    let halves = [ring[a..=b].to_vec(), ring[b..].iter().chain(&ring[..=a]).copied().collect()];
    is_free.then_some(halves)
}

/// Whether the way from the corner in the middle to a point begins inside.
///
/// Source: J. O'Rourke, *Computational Geometry in C*, 1998, section 1.6.
fn is_in_cone([before, here, after]: [[f64; 2]; 3], to: [f64; 2]) -> bool {
    let is_left = |a, b, c| orient2d(a, b, c) == Orientation::Front;
    let is_not_right = |a, b, c| orient2d(a, b, c) != Orientation::Back;
    if is_not_right(before, here, after) {
        is_left(here, to, before) && is_left(to, here, after)
    } else {
        !(is_not_right(here, to, after) && is_not_right(to, here, before))
    }
}

/// Whether two segments have a point in common.
fn touches([p, q]: [[f64; 2]; 2], [a, b]: [[f64; 2]; 2]) -> bool {
    let sides = [orient2d(p, q, a), orient2d(p, q, b), orient2d(a, b, p), orient2d(a, b, q)];
    if sides == [Orientation::Flat; 4] {
        // On one line: their boxes tell.
        return (0..2).all(|k| {
            let overlap = |x: [f64; 2], y: [f64; 2]| x.iter().any(|s| y.iter().any(|t| s >= t));
            overlap([p[k], q[k]], [a[k], b[k]]) && overlap([a[k], b[k]], [p[k], q[k]])
        });
    }
    sides[0] != sides[1] && sides[2] != sides[3]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts_of(points: &[[f64; 2]], apex: usize, cuts: &[[usize; 2]]) -> Value {
        let question = json!({ "exhibit": "fan", "points": points, "apex": apex, "cuts": cuts });
        fan(&ExhibitRequest::parse(question.to_string().as_bytes()).unwrap().1).unwrap().facts
    }

    const HEXAGON: [[f64; 2]; 6] = [[4.0, 1.0], [7.0, 1.0], [9.0, 4.0], [7.0, 7.0], [4.0, 7.0], [2.0, 4.0]];
    /// An L; corner 3 is concave.
    const ELL: [[f64; 2]; 6] = [[1.0, 1.0], [9.0, 1.0], [9.0, 3.0], [4.0, 3.0], [4.0, 7.0], [1.0, 7.0]];

    #[test]
    fn any_diagonals_that_do_not_cross_give_n_minus_2() {
        let facts = facts_of(&HEXAGON, 0, &[]);
        assert_eq!((&facts["needed"], facts["allowed"].as_array().unwrap().len()), (&json!(4), 9));
        // 1–4 crosses 0–2 not, but 0–3: it is left out.
        let facts = facts_of(&HEXAGON, 0, &[[0, 2], [0, 3], [1, 4], [3, 5]]);
        assert_eq!((&facts["cut_off"], &facts["made"]), (&json!(4), &json!([[0, 2], [0, 3], [3, 5]])));
        assert_eq!(facts["allowed"], json!([]));
    }

    #[test]
    fn a_fan_folds_at_a_concave_corner_and_ears_never_do() {
        for apex in 0..6 {
            let facts = facts_of(&ELL, apex, &[]);
            // Only the concave corner, and the one opposite to it, see all others.
            assert_eq!(facts["fan"]["folded"] == json!(0), [0, 3].contains(&apex), "{apex}");
            assert_eq!((&facts["ears"]["folded"], &facts["is_convex"]), (&json!(0), &json!(false)));
            assert_eq!(facts["ears"]["triangles"].as_array().unwrap().len(), 4);
        }
        // Reversed, it is the same polygon. 2–4 would run outside.
        let mut reversed = ELL;
        reversed.reverse();
        for facts in [facts_of(&ELL, 0, &[[2, 4]]), facts_of(&reversed, 0, &[[3, 1]])] {
            assert_eq!((&facts["made"], &facts["cut_off"]), (&json!([]), &json!(0)));
        }
        assert_eq!(facts_of(&HEXAGON, 2, &[])["fan"]["folded"], json!(0));
    }
}
