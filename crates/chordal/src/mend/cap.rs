//! Triangulates one hole so that no edge of the mesh gets a third face.
use crate::check::has_zero_area;
use crate::explicit::{face_normal, triangulate};
use crate::math::{Orientation, cross, difference, dot, length, orient3d};

/// The most corners for which the triangulation of least area is computed: n³/6 steps, 0.2 ms at
/// 64, measured.
const MOST_EXACT: usize = 64;

/// Triangles over the corners of a loop, by index, all with area; `None` if every triangulation that was
/// tried uses a chord that is not free, or has a triangle without area. `is_free` says whether an edge may
/// join two corners that are not neighbours.
///
/// A flat loop is triangulated as a polygon. Any other loop gets the triangulation of least area if it has
/// few corners, and is triangulated as a polygon otherwise.
///
/// Source: G. Barequet and M. Sharir, *Filling gaps in the boundary of a polyhedron*, 1995.
pub(super) fn cap(points: &[[f64; 3]], is_free: &dyn Fn(usize, usize) -> bool) -> Option<Vec<[usize; 3]>> {
    let as_polygon = || {
        let polygon = triangulate::polygon(points);
        let triangles: Vec<_> = polygon.triangles.iter().map(|t| t.map(|i| i as usize)).collect();
        chords_are_free(points.len(), &triangles, is_free).then_some((triangles, polygon.folded))
    };
    let have_area =
        |triangles: &Vec<[usize; 3]>| !triangles.iter().any(|t| has_zero_area(t.map(|i| points[i])));
    // The polygon of a flat loop is exact if no triangle of it is folded, which a loop that crosses
    // itself cannot avoid.
    if is_flat(points)
        && let Some((triangles, 0)) = as_polygon()
        && have_area(&triangles)
    {
        return Some(triangles);
    }
    let triangles = if points.len() <= MOST_EXACT {
        least_area(points, is_free)
    } else {
        as_polygon().map(|(triangles, _)| triangles)
    };
    triangles.filter(have_area)
}

fn chords_are_free(n: usize, triangles: &[[usize; 3]], is_free: &dyn Fn(usize, usize) -> bool) -> bool {
    let sides = triangles.iter().flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]);
    sides.filter(|&(i, j)| (i + 1) % n != j && (j + 1) % n != i).all(|(i, j)| is_free(i, j))
}

/// Whether all points lie in one plane, exactly.
fn is_flat(points: &[[f64; 3]]) -> bool {
    let [a, others @ ..] = points else { return true };
    let Some(b) = others.iter().find(|p| *p != a) else { return true };
    let Some(c) = others.iter().find(|p| !has_zero_area([*a, *b, **p])) else { return true };
    others.iter().all(|p| orient3d(*a, *b, *c, *p) == Orientation::Flat)
}

/// The cost of a triangulation: triangles without area, then folded triangles, then its area.
type TriangulationCost = (u32, u32, f64);

fn plus(a: TriangulationCost, b: TriangulationCost) -> TriangulationCost {
    (a.0 + b.0, a.1 + b.1, a.2 + b.2)
}

/// The best triangulation, by dynamic programming over the parts that chords cut off.
fn least_area(points: &[[f64; 3]], is_free: &dyn Fn(usize, usize) -> bool) -> Option<Vec<[usize; 3]>> {
    let n = points.len();
    // A triangle is folded if it faces against the loop as a whole.
    let up = loop_normal(points);
    let cost = |t: [usize; 3]| -> TriangulationCost {
        let [a, b, c] = t.map(|i| points[i]);
        let folds = face_normal([a, b, c]).is_some_and(|normal| dot(normal, up) < 0.0);
        let flat = has_zero_area([a, b, c]);
        // Compared in this order, since no saving of area makes up for a face without area or a
        // fold. Twice the area, which has the same order.
        (u32::from(flat), u32::from(folds), length(cross(difference(b, a), difference(c, a))))
    };
    // By corners i and j: the best cost of the part of the loop between them, which ends with their chord,
    // and its third corner.
    let mut best: Vec<Option<(TriangulationCost, usize)>> = vec![None; n * n];
    for i in 0..n - 1 {
        best[i * n + i + 1] = Some(((0, 0, 0.0), i));
    }
    for width in 2..n {
        for i in 0..n - width {
            let j = i + width;
            // The chord from the first corner to the last is a side of the loop, and needs no room.
            if width < n - 1 && !is_free(i, j) {
                continue;
            }
            for k in i + 1..j {
                let (Some(left), Some(right)) = (best[i * n + k], best[k * n + j]) else { continue };
                let sum = plus(plus(left.0, right.0), cost([i, k, j]));
                let entry = &mut best[i * n + j];
                if entry.is_none_or(|(least, _)| sum < least) {
                    *entry = Some((sum, k));
                }
            }
        }
    }
    best[n - 1]?;
    let mut triangles = Vec::with_capacity(n - 2);
    let mut open = vec![[0, n - 1]];
    while let Some([i, j]) = open.pop() {
        if let (true, Some((_, k))) = (j > i + 1, best[i * n + j]) {
            triangles.push([i, k, j]);
            open.extend([[k, j], [i, k]]);
        }
    }
    Some(triangles)
}

/// A direction from which the loop is counter-clockwise.
pub(super) fn loop_normal(points: &[[f64; 3]]) -> [f64; 3] {
    points.windows(2).skip(1).fold([0.0; 3], |sum, pair| {
        let term = cross(difference(pair[0], points[0]), difference(pair[1], points[0]));
        std::array::from_fn(|k| sum[k] + term[k])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SADDLE: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.1], [1.0, 1.0, 0.0], [0.0, 1.0, 0.1]];

    #[test]
    fn a_chord_that_is_taken_is_not_used() {
        let crosses = |made: &[[usize; 3]]| made.iter().any(|t| t.contains(&0) && t.contains(&2));
        let all = cap(&SADDLE, &|_, _| true).unwrap();
        let other = !crosses(&all);
        let rest = cap(&SADDLE, &|i, j| ((i, j) == (0, 2)) == other).unwrap();
        assert_ne!(crosses(&all), crosses(&rest));
        assert_eq!(cap(&SADDLE, &|_, _| false), None);
    }

    #[test]
    fn the_least_area_is_found() {
        // A skyline: up and down along one side.
        let bent: Vec<[f64; 3]> = (0..12)
            .map(|i| {
                let angle = f64::from(i) / 12.0 * std::f64::consts::TAU;
                [libm::cos(angle), libm::sin(angle), if i % 3 == 0 { 0.7 } else { 0.0 }]
            })
            .collect();
        let area = |made: &[[usize; 3]]| -> f64 {
            made.iter()
                .map(|t| t.map(|i| bent[i]))
                .map(|[a, b, c]| length(cross(difference(b, a), difference(c, a))))
                .sum()
        };
        let best = least_area(&bent, &|_, _| true).unwrap();
        assert_eq!(best.len(), 10);
        for start in 0..12 {
            let fan: Vec<[usize; 3]> =
                (1..11).map(|i| [start, (start + i) % 12, (start + i + 1) % 12]).collect();
            assert!(area(&best) <= area(&fan), "the fan at {start} is smaller");
        }
    }
}
