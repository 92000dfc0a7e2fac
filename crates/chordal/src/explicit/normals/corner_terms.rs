//! The normal of a face at each of its corners, times its weight there.
use super::angle::{angle_of, angles_of};
use super::face_normal;
use crate::math::{dot, greater, length};
use std::f64::consts::PI;

/// The weight of each face in the normal of a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalWeight {
    /// Its angle at the vertex: the result does not depend on the triangulation of the surface.
    #[default]
    Angle,
    /// Its area: large faces dominate, for example those beside the small faces of a rounded edge.
    Area,
    /// The same for all.
    Uniform,
}

/// The vector scaled to length 1; zero if it has no direction.
#[inline]
pub(super) fn unit_or_zero(v: [f64; 3]) -> [f64; 3] {
    let square = dot(v, v);
    // Squares of numbers between 1e-100 and 1e100, and sums of three of them, are far inside the range of f64.
    // Other vectors are scaled first.
    if square > 1e-200 && square < 1e200 {
        let factor = 1.0 / square.sqrt();
        return v.map(|x| x * factor);
    }
    let largest = v.iter().fold(0.0, |most: f64, x| greater(x.abs(), most));
    if !(largest > 0.0 && largest.is_finite()) {
        return [0.0; 3];
    }
    let scaled = v.map(|x| x / largest);
    let length = length(scaled);
    scaled.map(|x| x / length)
}

/// The normal of a face times its weight at each of its corners. `None` without area.
#[inline]
pub(super) fn corner_terms(
    corners: [[f64; 3]; 3],
    scale: f64,
    weight: NormalWeight,
) -> Option<[[f64; 3]; 3]> {
    let [a, b, c] = corners;
    let edge = |p: [f64; 3], q: [f64; 3]| [q[0] - p[0], q[1] - p[1], q[2] - p[2]];
    let (ab, ca) = (edge(a, b), edge(c, a));
    let cross = [ca[1] * ab[2] - ca[2] * ab[1], ca[2] * ab[0] - ca[0] * ab[2], ca[0] * ab[1] - ca[1] * ab[0]];
    let square = dot(cross, cross);
    let (ab_square, ca_square) = (dot(ab, ab), dot(ca, ca));
    // Rounding of the cross product is below 8 steps of the edges' product. If it could dominate, as for
    // needles, or if squares are near the ends of the range of f64, a slower method decides.
    if !(square > 1e-200 && square < 1e200 && square > 1e-24 * (ab_square * ca_square) && scale == 1.0) {
        return corner_terms_rescaled(corners, scale, weight);
    }
    let area = square.sqrt();
    Some(match weight {
        NormalWeight::Angle => {
            let factor = 1.0 / area;
            let normal = cross.map(|x| x * factor);
            // The sum of two sides is the third, reversed: bc = −(ab + ca).
            let dot_ca_ab = dot(ca, ab);
            let [at_a, at_b] = angles_of([-dot_ca_ab, ab_square + dot_ca_ab], area);
            // The remainder of half a turn, if positive.
            let remainder = PI - (at_a + at_b);
            let at_c = greater(remainder, 0.0);
            [at_a, at_b, at_c].map(|angle| normal.map(|x| x * angle))
        }
        NormalWeight::Area => [cross; 3],
        NormalWeight::Uniform => [cross.map(|x| x / area); 3],
    })
}

/// The same for triangles whose squares leave the range of f64, and for needles.
#[cold]
fn corner_terms_rescaled(corners: [[f64; 3]; 3], scale: f64, weight: NormalWeight) -> Option<[[f64; 3]; 3]> {
    let normal = face_normal(corners)?;
    let [a, b, c] = corners;
    let edge = |p: [f64; 3], q: [f64; 3]| {
        // Halved first: the difference of the largest numbers would overflow.
        let along: [f64; 3] = std::array::from_fn(|k| 0.5 * q[k] - 0.5 * p[k]);
        unit_or_zero(along)
    };
    let (ab, bc, ca) = (edge(a, b), edge(b, c), edge(c, a));
    let cross = |u: [f64; 3], v: [f64; 3]| {
        let w = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        length(w)
    };
    let angles = [[ca, ab], [ab, bc], [bc, ca]].map(|[u, v]| angle_of(-dot(u, v), cross(u, v)));
    let scaled_length = |p: [f64; 3], q: [f64; 3]| {
        let along: [f64; 3] = std::array::from_fn(|k| q[k] * scale - p[k] * scale);
        length(along)
    };
    let area = scaled_length(a, b) * scaled_length(a, c) * cross(ca, ab);
    Some(match weight {
        NormalWeight::Angle => angles.map(|angle| normal.map(|x| x * angle)),
        NormalWeight::Area => [normal.map(|x| x * area); 3],
        NormalWeight::Uniform => [normal; 3],
    })
}
