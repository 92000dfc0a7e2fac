//! One cell of marching cubes: eight signs, their triangles, and the ambiguous faces.
use super::answer::ExhibitAnswer;
use super::plane::{once, or_text};
use super::request::ExhibitRequest;
use super::shapes;
use chordal::check::{Goal, deviation, validity};
use chordal::convert::{Polygonize, grid_to_mesh};
use chordal::explicit::Topology;
use chordal::implicit::{Affine3, Grid, Samples};
use chordal::{Budget, Job, Mesh, Tolerance};
use serde_json::{Value, json};
use std::sync::OnceLock;

/// The number of sign patterns. Signs are bits, 1 for inside; corner `i` has its coordinates in the bits of
/// `i`.
const PATTERNS: u32 = 256; // derived: two for each of eight corners
/// A tolerance that every mesh of the cell meets.
const ANY: f64 = 2.0; // derived: the diagonal is √3
/// The relative gap of the measured error.
const GOAL: Goal = Goal { relative: 0.01, absolute: None, max: None }; // chosen: two digits are shown

/// Answers `{"look": "cube", "signs": 9}`: the triangles, the ambiguous faces, and the readings that were not
/// taken. A single inside corner may be the corner of a box: then also the distance by which its triangle
/// cuts it off.
pub(super) fn one_cube(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["look", "signs"])?;
    let signs = request.number("signs", [0.0, f64::from(PATTERNS - 1)])? as u32;
    static ALL: OnceLock<Patterns> = OnceLock::new();
    let patterns = once(&ALL, Patterns::counted)?;
    let mesh = meshed(signs)?;
    let faces: Vec<[u32; 4]> = ambiguous(signs).collect();
    let mut answer = ExhibitAnswer::default();
    let shown = mesh.as_ref().map(|mesh| answer.mesh(mesh));
    let other: Vec<f64> = faces.iter().flat_map(|face| other_reading(signs, *face)).flatten().collect();
    answer.facts = json!({
        "look": "cube",
        "signs": signs,
        "mesh": shown,
        "triangles": mesh.as_ref().map_or(0, |mesh| mesh.faces().len()),
        "pieces": mesh.as_ref().map_or(0, |mesh| validity(mesh, Topology::Indices).components),
        "faces": faces,
        "other": answer.floats(&other),
        "readings": 1_u32 << faces.len(),
        "patterns": PATTERNS,
        "patterns_with_two": patterns.with_two,
        "most_triangles": patterns.most_triangles,
        "lost": tip_lost(signs, mesh.as_ref())?,
    });
    Ok(answer)
}

/// Counts over all patterns.
struct Patterns {
    /// The number of patterns with an ambiguous face.
    with_two: usize,
    most_triangles: usize,
}

impl Patterns {
    fn counted() -> Result<Self, String> {
        let mut counts = Self { with_two: 0, most_triangles: 0 };
        for signs in 0..PATTERNS {
            counts.with_two += usize::from(ambiguous(signs).next().is_some());
            let triangles = meshed(signs)?.map_or(0, |mesh| mesh.faces().len());
            counts.most_triangles = counts.most_triangles.max(triangles);
        }
        Ok(counts)
    }
}

fn is_inside(signs: u32, corner: u32) -> bool {
    signs >> corner & 1 == 1
}

/// The position of a corner; the cell has side 1 and is centred at the origin.
fn place(corner: u32) -> [f64; 3] {
    [0, 1, 2].map(|k| f64::from(corner >> k & 1) - 0.5)
}

/// The surface in the cell, from samples of −1 and 1; `None` if all corners are on one side.
fn meshed(signs: u32) -> Result<Option<Mesh>, String> {
    if signs == 0 || signs == PATTERNS - 1 {
        return Ok(None);
    }
    let values = (0..8).map(|corner| if is_inside(signs, corner) { -1.0 } else { 1.0 }).collect();
    let place = or_text(Affine3::cubes([-0.5; 3], 1.0))?;
    let grid = or_text(Grid::new([2; 3], Samples::F64(values), place))?;
    // Any length is allowed: only the triangles of the case matter.
    let budget = Budget::length(or_text(Tolerance::new(ANY))?);
    Ok(Some(
        or_text(grid_to_mesh(&grid, &Polygonize::below(0.0).open(), Some(&budget), &Job::default()))?.shape,
    ))
}

/// The ambiguous faces: the signs alternate around them.
fn ambiguous(signs: u32) -> impl Iterator<Item = [u32; 4]> {
    shapes::CUBE.into_iter().filter(move |face| {
        let [a, b, c, d] = face.map(|corner| is_inside(signs, corner));
        a == c && b == d && a != b
    })
}

/// The other reading of an ambiguous face. The mesher separates the inside corners; this one separates the
/// outside corners. Two segments, as their ends.
///
/// ```text
/// mesher       other reading
/// ●─╱─○        ●─╲─○     ● inside, ○ outside
/// ╱   ╱        ╲   ╲
/// ○─╱─●        ○─╲─●
/// ```
fn other_reading(signs: u32, face: [u32; 4]) -> Vec<[f64; 3]> {
    let between = |i: usize, j: usize| {
        let [p, q] = [place(face[i % 4]), place(face[j % 4])];
        std::array::from_fn(|k| 0.5 * (p[k] + q[k]))
    };
    let outside = (0..4).filter(|i| !is_inside(signs, face[*i]));
    outside.flat_map(|i| [between(i + 3, i), between(i, i + 1)]).collect()
}

/// If a single corner is inside: the distance of the mesh from a box whose corner is in the middle of the
/// cell and which gives the same signs.
fn tip_lost(signs: u32, mesh: Option<&Mesh>) -> Result<Option<Value>, String> {
    let Some(mesh) = mesh.filter(|_| signs.count_ones() == 1) else { return Ok(None) };
    let far = place(signs.trailing_zeros());
    // The three faces of the box, from its corner in the middle to the sides of the cell.
    let square = |k: usize| {
        let [i, j] = [(k + 1) % 3, (k + 2) % 3];
        [[0.0, 0.0], [far[i], 0.0], [far[i], far[j]], [0.0, far[j]]].map(|[x, y]| {
            let mut at = [0.0; 3];
            (at[i], at[j]) = (x, y);
            at
        })
    };
    let corners = (0..3).flat_map(square).collect();
    let quads: Vec<[u32; 4]> = (0..3).map(|k| [4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3]).collect();
    let truth = shapes::mesh_from(corners, shapes::from_quads(&quads))?;
    let measured = or_text(deviation(&truth, mesh, &GOAL, &Job::default()))?;
    Ok(measured.bound.at_most().map(Value::from))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn at(signs: u32) -> Value {
        let question = json!({ "exhibit": "squares", "look": "cube", "signs": signs }).to_string();
        one_cube(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn every_pattern_has_its_triangles_and_its_readings() {
        for (signs, triangles, faces, pieces) in [
            (0, 0, 0, 0),
            (1, 1, 0, 1),
            (3, 2, 0, 1),
            (9, 2, 1, 2),
            (129, 2, 0, 2),
            (15, 2, 0, 1),
            (105, 4, 6, 4),
        ] {
            let facts = at(signs);
            assert_eq!(facts["triangles"], json!(triangles), "{signs}");
            assert_eq!(facts["faces"].as_array().unwrap().len(), faces, "{signs}");
            assert_eq!(facts["pieces"], json!(pieces), "{signs}");
            assert_eq!(facts["readings"], json!(1 << faces), "{signs}");
        }
        // A sixth of the faces' 16 patterns alternates, 2 of 16, and one of six faces has to.
        let brute = (0..256_u32)
            .filter(|signs| {
                let bit = |x: u32, y: u32, z: u32| signs >> (x + 2 * y + 4 * z) & 1;
                let alternate = |f: &dyn Fn(u32, u32) -> u32| {
                    f(0, 0) == f(1, 1) && f(0, 1) == f(1, 0) && f(0, 0) != f(0, 1)
                };
                (0..2).any(|w| {
                    alternate(&|u, v| bit(w, u, v))
                        || alternate(&|u, v| bit(u, w, v))
                        || alternate(&|u, v| bit(u, v, w))
                })
            })
            .count();
        assert_eq!(at(9)["patterns_with_two"], json!(brute));
        assert_eq!(at(9)["most_triangles"], json!(5));
    }

    #[test]
    fn a_box_loses_its_tip_and_other_patterns_have_none() {
        for corner in 0..8 {
            let lost = at(1 << corner)["lost"].as_f64().unwrap();
            // From the middle to the plane through the middles of three edges of half a side.
            assert!((lost - 1.0 / 3.0_f64.sqrt()).abs() < 0.01, "{lost}");
        }
        assert_eq!(at(3)["lost"], Value::Null);
    }

    #[test]
    fn the_other_reading_is_never_a_border_of_the_mesh() {
        let key = |p: [f64; 3]| p.map(|x| (x * 4.0).round() as i64);
        for signs in 1..255 {
            let mesh = meshed(signs).unwrap().unwrap();
            let mut sides = BTreeMap::new();
            for face in mesh.faces() {
                for k in 0..3 {
                    let mut ends =
                        [face[k], face[(k + 1) % 3]].map(|row| key(mesh.positions()[row as usize]));
                    ends.sort_unstable();
                    *sides.entry(ends).or_insert(0) += 1;
                }
            }
            for face in ambiguous(signs) {
                for ends in other_reading(signs, face).chunks(2) {
                    let mut ends = [key(ends[0]), key(ends[1])];
                    ends.sort_unstable();
                    assert!(!sides.contains_key(&ends), "{signs}");
                }
            }
        }
    }
}
