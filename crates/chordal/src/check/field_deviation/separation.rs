//! Whether a triangle certainly misses a box.
//!
//! Source: T. Akenine-Möller, *Fast 3D triangle-box overlap testing*, 2001, for the axes. Any separating axis
//! is valid, so only the comparison along it has to allow for rounding.
use crate::math::{Box3, cross, difference, greater};

/// Rounding of a comparison, relative to the largest coordinate times the axis: derived, some ten roundings
/// of numbers up to twice that.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Whether no point of the triangle is in the box; `false` if that is uncertain.
pub(super) fn is_separated(bounds: &Box3, corners: &[[f64; 3]; 3]) -> bool {
    let outside = |k: usize| {
        corners.iter().all(|p| p[k] < bounds.min[k]) || corners.iter().all(|p| p[k] > bounds.max[k])
    };
    if (0..3).any(outside) {
        return true;
    }
    let centre = bounds.centre();
    let half: [f64; 3] = std::array::from_fn(|k| 0.5 * (bounds.max[k] - bounds.min[k]));
    let local = corners.map(|p| difference(p, centre));
    let coordinates = corners.as_flattened().iter().chain(&bounds.min).chain(&bounds.max);
    let reach = coordinates.fold(0.0, |most: f64, x| greater(x.abs(), most));
    let separates = |axis: [f64; 3]| {
        let along = local.map(|p| axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2]);
        let size = axis[0].abs() + axis[1].abs() + axis[2].abs();
        let radius = (0..3).fold(0.0, |sum, k| sum + axis[k].abs() * half[k]);
        let far = radius + ROUNDING * size * reach;
        along.iter().all(|x| *x > far) || along.iter().all(|x| *x < -far)
    };
    // Two convex bodies are apart along a normal of a face of either, or along a product of two of
    // their edges. Those of the box were tried above; here come the triangle's normal and the
    // products of its sides with the axes.
    let sides: [[f64; 3]; 3] = std::array::from_fn(|k| difference(local[(k + 1) % 3], local[k]));
    if separates(cross(sides[0], sides[1])) {
        return true;
    }
    sides
        .iter()
        .any(|[x, y, z]| separates([0.0, *z, -y]) || separates([-z, 0.0, *x]) || separates([*y, -x, 0.0]))
}
