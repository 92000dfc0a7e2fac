//! Whether all points of a triangle are farther from a mesh than the radius, or all nearer.
use super::{OffsetSource, centroid, hull};
use crate::check::distance_up;
use crate::explicit::{closest_on_segments, nearest_on_triangle};
use crate::math::{
    Box3, add_down, add_up, cross, difference, distance, dot, greater, length_up, lesser, mul_down, mul_up,
    sub_down,
};

/// The most bisections of a triangle. Chosen: planes between convex sets exist, so that pieces are needed only where
/// rounding hides them.
const MOST_CUTS: usize = 32;

/// The same where all points are to be near: pieces are about as large as the source's faces. Chosen.
const MOST_NEAR_CUTS: usize = 1024;

/// What is known of a piece of a triangle.
enum PieceProof {
    Holds,
    /// One of its points is on the wrong side, so that nothing can be proved.
    Fails,
    Unknown,
}

/// Whether a triangle is proved to be farther from all faces of the source than its radius.
pub(super) fn is_clear(triangle: [[f64; 3]; 3], source: &OffsetSource) -> bool {
    let mut faces = Vec::new();
    let mut row = 0;
    let reach = add_up(source.radius, rounding_of_pieces(&triangle));
    holds_in_pieces(triangle, MOST_CUTS, |piece| {
        if is_piece_clear(piece, reach, source, &mut faces) {
            return PieceProof::Holds;
        }
        let is_wrong = |p: &[f64; 3], row: &mut u32| source.value(*p, row) <= 0.0;
        let fails = is_wrong(&centroid(*piece), &mut row) || piece.iter().any(|p| is_wrong(p, &mut row));
        if fails { PieceProof::Fails } else { PieceProof::Unknown }
    })
}

/// Whether all points of a triangle are proved to be nearer to the source than its radius: the distance to one face is
/// convex, so that it is largest at a corner of a piece.
pub(super) fn is_near(triangle: [[f64; 3]; 3], source: &OffsetSource) -> bool {
    let mut row = 0;
    let radius = sub_down(source.radius, rounding_of_pieces(&triangle));
    holds_in_pieces(triangle, MOST_NEAR_CUTS, |piece| {
        let Some((away, nearest)) = source.bvh.distance_with_hint(centroid(*piece), row) else {
            return PieceProof::Fails;
        };
        row = nearest;
        let (_, face) = source.bvh.triangle_of(nearest);
        let face = source.mesh.corners(face as usize);
        if piece.iter().all(|corner| distance_up(*corner, &face) < radius) {
            PieceProof::Holds
        } else if away >= source.radius || piece.iter().any(|p| source.value(*p, &mut row) >= 0.0) {
            PieceProof::Fails
        } else {
            PieceProof::Unknown
        }
    })
}

fn holds_in_pieces(
    triangle: [[f64; 3]; 3],
    most_cuts: usize,
    mut look: impl FnMut(&[[f64; 3]; 3]) -> PieceProof,
) -> bool {
    let mut open = vec![triangle];
    let mut cuts = 0;
    while let Some(piece) = open.pop() {
        match look(&piece) {
            PieceProof::Holds => {}
            PieceProof::Unknown if cuts < most_cuts => {
                cuts += 1;
                open.extend(halves(piece));
            }
            PieceProof::Unknown | PieceProof::Fails => return false,
        }
    }
    true
}

/// How far the pieces of a triangle may be beside it: middles are rounded, once for each of at most 1024 cuts.
fn rounding_of_pieces(triangle: &[[f64; 3]; 3]) -> f64 {
    let largest = triangle.as_flattened().iter().fold(0.0, |most, x| greater(x.abs(), most));
    2.0 * MOST_NEAR_CUTS as f64 * f64::EPSILON * largest
}

/// The halves of a triangle by its longest side.
fn halves(corners: [[f64; 3]; 3]) -> [[[f64; 3]; 3]; 2] {
    let side = |k: usize| distance(corners[k], corners[(k + 1) % 3]);
    let longest = (1..3).fold(0, |longest, k| if side(k) > side(longest) { k } else { longest });
    let [a, b, c] = [0, 1, 2].map(|k| corners[(longest + k) % 3]);
    let middle = std::array::from_fn(|k| 0.5 * a[k] + 0.5 * b[k]);
    [[a, middle, c], [middle, b, c]]
}

fn is_piece_clear(piece: &[[f64; 3]; 3], reach: f64, source: &OffsetSource, faces: &mut Vec<u32>) -> bool {
    let Box3 { min, max } = hull(piece);
    let bounds = Box3 { min: min.map(|x| sub_down(x, reach)), max: max.map(|x| add_up(x, reach)) };
    faces.clear();
    source.bvh.faces_in_box(&bounds, |face| faces.push(face));
    let [a, b, c] = *piece;
    let normal = cross(difference(b, a), difference(c, a));
    faces.iter().all(|face| {
        let other = source.mesh.corners(*face as usize);
        is_between(normal, piece, &other, reach)
            || is_between(normal.map(|x| -x), piece, &other, reach)
            || is_between(nearest_way(piece, &other), piece, &other, reach)
    })
}

/// Whether a slab of the width `reach` across `n` separates two triangles, rounding included.
fn is_between(n: [f64; 3], piece: &[[f64; 3]; 3], other: &[[f64; 3]; 3], reach: f64) -> bool {
    let dot_down = |p: &[f64; 3]| (0..3).fold(0.0, |sum, k| add_down(sum, mul_down(n[k], p[k])));
    let dot_up = |p: &[f64; 3]| (0..3).fold(0.0, |sum, k| add_up(sum, mul_up(n[k], p[k])));
    let low = piece.iter().map(dot_down).fold(f64::INFINITY, lesser);
    let high = other.iter().map(dot_up).fold(f64::NEG_INFINITY, greater);
    sub_down(low, high) > mul_up(reach, length_up(n))
}

/// The way from the nearest point of one triangle to that of another.
fn nearest_way(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> [f64; 3] {
    let mut best = (f64::INFINITY, [0.0; 3]);
    let mut consider = |way: [f64; 3]| {
        let square = dot(way, way);
        if square < best.0 {
            best = (square, way);
        }
    };
    for p in a {
        consider(difference(*p, nearest_on_triangle(*p, *b)));
    }
    for q in b {
        consider(difference(nearest_on_triangle(*q, *a), *q));
    }
    let at =
        |[p, q]: [[f64; 3]; 2], t: f64| -> [f64; 3] { std::array::from_fn(|k| p[k] + t * (q[k] - p[k])) };
    for i in 0..3 {
        let one = [a[i], a[(i + 1) % 3]];
        for j in 0..3 {
            let two = [b[j], b[(j + 1) % 3]];
            let [s, t] = closest_on_segments(one, two, 0.0);
            consider(difference(at(one, s), at(two, t)));
        }
    }
    best.1
}
