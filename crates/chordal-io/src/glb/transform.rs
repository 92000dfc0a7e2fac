//! Transforms of nodes: column-major matrices, and their glTF node properties.
use super::trs::{compose, rotation_matrix};
use crate::matrix::IDENTITY;
use chordal::math::greater;
use serde_json::{Map, Value, json};

/// (x, y, z) → (x, z, −y): maps z-up to y-up, without rounding.
pub(super) const Z_UP_TO_Y_UP: [f64; 16] =
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// The difference of column sums from which gltf-validator detects shear. Defined by the validator.
const SHEAR_LIMIT: f64 = 0.00005;

/// The properties of the nodes for a matrix, outermost first and at least one. `None` if it has shear, no
/// inverse (unless it only scales) or a perspective row.
///
/// One node is enough unless the validator, whose limit is absolute, would take the rounding of a large
/// matrix for shear. Then a first node holds the translation and a power of two, by which the second is
/// scaled down.
pub(super) fn node_properties(matrix: &[f64; 16]) -> Option<Vec<Map<String, Value>>> {
    // Adding zero removes the sign of −0, which JSON would show.
    let m = matrix.map(|x| x + 0.0);
    if m.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let linear = [&m[0..3], &m[4..7], &m[8..11]];
    let diagonal = (0..3).all(|i| (0..3).all(|j| i == j || linear[i][j] == 0.0));
    if diagonal && [m[3], m[7], m[11], m[15]] == [0.0, 0.0, 0.0, 1.0] {
        let scale = [m[0], m[5], m[10]];
        return Some(vec![place([m[12], m[13], m[14]], scale)]);
    }
    if is_trs(&m) {
        return Some(vec![object("matrix", json!(m))]);
    }
    let largest = linear.concat().into_iter().fold(0.0, |a, x| greater(x.abs(), a));
    // Masks out the fraction: a power of two, so scaling is exact.
    let power = f64::from_bits(largest.to_bits() & 0x7FF0_0000_0000_0000);
    if power == 0.0 {
        return None;
    }
    let mut inner = m;
    inner[12..15].fill(0.0);
    inner[..12].iter_mut().for_each(|x| *x /= power);
    is_trs(&inner).then(|| vec![place([m[12], m[13], m[14]], [power; 3]), object("matrix", json!(inner))])
}

/// Removes translation, rotation and scale from the properties of a node. They are returned if they produce
/// its matrix, bit for bit.
pub(super) fn own_properties(
    properties: &mut Map<String, Value>,
    matrix: &[f64; 16],
) -> Option<Map<String, Value>> {
    let mut trs = Map::new();
    for key in ["translation", "rotation", "scale"] {
        trs.extend(properties.shift_remove(key).map(|value| (key.to_owned(), value)));
    }
    let numbers = |key: &str, usual: &[f64]| -> Option<Vec<f64>> {
        let Some(value) = trs.get(key) else { return Some(usual.to_vec()) };
        let numbers: Option<Vec<f64>> = value.as_array()?.iter().map(Value::as_f64).collect();
        numbers.filter(|numbers| numbers.len() == usual.len())
    };
    let [t, r, s] = [
        numbers("translation", &[0.0; 3])?,
        numbers("rotation", &[0.0, 0.0, 0.0, 1.0])?,
        numbers("scale", &[1.0; 3])?,
    ];
    let composed = compose([t[0], t[1], t[2]], [r[0], r[1], r[2], r[3]], [s[0], s[1], s[2]]);
    (!trs.is_empty() && composed.map(f64::to_bits) == matrix.map(f64::to_bits)).then_some(trs)
}

/// Translation and scale, each omitted if it is the identity.
fn place(translation: [f64; 3], scale: [f64; 3]) -> Map<String, Value> {
    let mut map = Map::new();
    if translation != [0.0; 3] {
        map.insert("translation".to_owned(), json!(translation));
    }
    if scale != [1.0; 3] {
        map.insert("scale".to_owned(), json!(scale));
    }
    map
}

fn object(key: &str, value: Value) -> Map<String, Value> {
    std::iter::once((key.to_owned(), value)).collect()
}

/// Whether a matrix is the identity in single precision.
#[allow(clippy::cast_possible_truncation)]
pub(super) fn is_identity(matrix: &[f64; 16]) -> bool {
    matrix.map(|x| f64::from(x as f32)) == IDENTITY
}

/// Whether a matrix is a translation, a rotation and a scale by gltf-validator's test: it decomposes the
/// matrix in single precision and compares the largest column sum of the recomposed matrix.
///
/// Source: glTF-Validator, NODE_MATRIX_NON_TRS.
#[allow(clippy::cast_possible_truncation)]
pub(super) fn is_trs(matrix: &[f64; 16]) -> bool {
    let m = matrix.map(|x| f64::from(x as f32));
    let determinant = determinant(&m);
    if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] || determinant == 0.0 {
        return false;
    }
    let single = |x: f64| f64::from(x as f32);
    let length = |c: usize| (m[c] * m[c] + m[c + 1] * m[c + 1] + m[c + 2] * m[c + 2]).sqrt();
    let mut scale = [length(0), length(4), length(8)];
    if determinant < 0.0 {
        scale[0] = -scale[0];
    }
    let rotation: [f64; 9] = std::array::from_fn(|k| single(m[k / 3 * 4 + k % 3] * (1.0 / scale[k / 3])));
    let quaternion = quaternion(&rotation).map(single);
    let mut again = rotation_matrix(quaternion);
    for (c, column) in again.chunks_exact_mut(3).enumerate() {
        column.iter_mut().for_each(|x| *x = single(single(*x) * single(scale[c])));
    }
    let largest_sum = |columns: &[f64], width: usize, last: f64| {
        let sums = columns.chunks_exact(width).map(|c| c.iter().map(|x| x.abs()).sum::<f64>());
        sums.fold(last, |a, sum| greater(sum, a))
    };
    let last = m[12].abs() + m[13].abs() + m[14].abs() + 1.0;
    (largest_sum(&again, 3, last) - largest_sum(&m[..12], 4, last)).abs() < SHEAR_LIMIT
}

fn determinant(m: &[f64; 16]) -> f64 {
    let minor = |a: usize, b: usize| m[4 + a] * m[8 + b] - m[4 + b] * m[8 + a];
    m[0] * minor(1, 2) - m[1] * minor(0, 2) + m[2] * minor(0, 1)
}

/// The quaternion (x, y, z, w) of a rotation matrix, column-major.
fn quaternion(r: &[f64; 9]) -> [f64; 4] {
    let trace = r[0] + r[4] + r[8];
    if trace > 0.0 {
        let root = (trace + 1.0).sqrt();
        let half = 0.5 / root;
        return [(r[5] - r[7]) * half, (r[6] - r[2]) * half, (r[1] - r[3]) * half, 0.5 * root];
    }
    let i = if r[0] < r[4] {
        if r[4] < r[8] { 2 } else { 1 }
    } else if r[0] < r[8] {
        2
    } else {
        0
    };
    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
    let root = (r[4 * i] - r[4 * j] - r[4 * k] + 1.0).sqrt();
    let half = 0.5 / root;
    let mut q = [0.0; 4];
    q[i] = 0.5 * root;
    q[3] = (r[3 * j + k] - r[3 * k + j]) * half;
    q[j] = (r[3 * i + j] + r[3 * j + i]) * half;
    q[k] = (r[3 * i + k] + r[3 * k + i]) * half;
    q
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_rotation_becomes_two_exact_nodes() {
        let matrix = compose([5.0, 6.0, 7.0], [0.18, 0.36, 0.54, 0.739_188_744_5], [2500.0, 2500.0, 2500.0]);
        let nodes = node_properties(&matrix).expect("no shear");
        assert_eq!(nodes.len(), 2);
        assert_eq!(nodes[0]["scale"], json!([2048.0, 2048.0, 2048.0]));
        for k in 0..12 {
            assert_eq!(nodes[1]["matrix"][k].as_f64().map(|x| x * 2048.0), Some(matrix[k]));
        }
    }

    #[test]
    fn shear_and_flat_matrices_have_no_properties() {
        let mut shear = IDENTITY;
        shear[4] = 0.5;
        assert_eq!(node_properties(&shear), None);
        // A scale of 0 is allowed alone; combined with a rotation, the matrix has no inverse to find the
        // rotation from.
        let mut flat = IDENTITY;
        flat[10] = 0.0;
        assert_eq!(node_properties(&flat).expect("a scale")[0]["scale"], json!([1.0, 1.0, 0.0]));
        flat[1] = 1.0;
        assert_eq!(node_properties(&flat), None);
        let mut perspective = IDENTITY;
        perspective[3] = 0.1;
        assert_eq!(node_properties(&perspective), None);
    }

    #[test]
    fn the_identity_says_nothing_and_a_mirror_is_a_scale() {
        assert_eq!(node_properties(&IDENTITY), Some(vec![Map::new()]));
        let mut mirror = IDENTITY;
        mirror[0] = -1.0;
        assert_eq!(node_properties(&mirror).expect("a scale")[0]["scale"], json!([-1.0, 1.0, 1.0]));
        assert!(is_trs(&Z_UP_TO_Y_UP));
    }
}
