//! The matrix of a translation, a rotation and a scale.
use crate::matrix::IDENTITY;

/// The rotation of a unit quaternion (x, y, z, w), three columns.
pub(super) fn rotation_matrix([x, y, z, w]: [f64; 4]) -> [f64; 9] {
    [
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y + z * w),
        2.0 * (x * z - y * w),
        2.0 * (x * y - z * w),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z + x * w),
        2.0 * (x * z + y * w),
        2.0 * (y * z - x * w),
        1.0 - 2.0 * (x * x + y * y),
    ]
}

/// The matrix that scales, then rotates, then translates.
pub(super) fn compose(translation: [f64; 3], rotation: [f64; 4], scale: [f64; 3]) -> [f64; 16] {
    let r = rotation_matrix(rotation);
    let mut m = IDENTITY;
    for column in 0..3 {
        for row in 0..3 {
            m[4 * column + row] = r[3 * column + row] * scale[column];
        }
    }
    m[12..15].copy_from_slice(&translation);
    m
}
