//! The matrices of COLLADA's transforms, column-major.
use crate::matrix::{IDENTITY, cross, sine_cosine};
use chordal::math::unit;

/// The kind of a transform element, which comes with numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TransformKind {
    Matrix,
    Translate,
    Rotate,
    Scale,
    LookAt,
}

impl TransformKind {
    /// The kind of an element.
    pub(super) fn from_element(name: &str) -> Option<Self> {
        Some(match name {
            "matrix" => Self::Matrix,
            "translate" => Self::Translate,
            "rotate" => Self::Rotate,
            "scale" => Self::Scale,
            "lookat" => Self::LookAt,
            _ => return None,
        })
    }

    /// The number of its numbers.
    pub(super) fn n_numbers(self) -> usize {
        match self {
            Self::Matrix => 16,
            Self::Translate | Self::Scale => 3,
            Self::Rotate => 4,
            Self::LookAt => 9,
        }
    }

    /// The matrix, or `None` if the numbers are invalid.
    pub(super) fn matrix(self, numbers: &[f64]) -> Option<[f64; 16]> {
        let mut matrix = IDENTITY;
        match (self, numbers) {
            // The file stores the matrix by rows.
            (Self::Matrix, rows) => {
                for (i, value) in matrix.iter_mut().enumerate() {
                    *value = *rows.get(4 * (i % 4) + i / 4)?;
                }
            }
            (Self::Translate, [x, y, z]) => matrix[12..15].copy_from_slice(&[*x, *y, *z]),
            (Self::Scale, [x, y, z]) => (matrix[0], matrix[5], matrix[10]) = (*x, *y, *z),
            (Self::Rotate, [x, y, z, degrees]) => return rotation([*x, *y, *z], *degrees),
            (Self::LookAt, [ex, ey, ez, tx, ty, tz, ux, uy, uz]) => {
                return look_at([*ex, *ey, *ez], [*tx, *ty, *tz], [*ux, *uy, *uz]);
            }
            _ => return None,
        }
        Some(matrix)
    }
}

/// A rotation about an axis, by Rodrigues' formula.
fn rotation(axis: [f64; 3], degrees: f64) -> Option<[f64; 16]> {
    if degrees == 0.0 {
        return Some(IDENTITY);
    }
    let [x, y, z] = unit(axis)?;
    let [s, c] = sine_cosine(degrees);
    let t = 1.0 - c;
    let columns = [
        [t * x * x + c, t * x * y + s * z, t * x * z - s * y],
        [t * x * y - s * z, t * y * y + c, t * y * z + s * x],
        [t * x * z + s * y, t * y * z - s * x, t * z * z + c],
    ];
    Some(from_columns(columns, [0.0; 3]))
}

/// The transform of a viewer at `eye` who looks along −z at `target`.
fn look_at(eye: [f64; 3], target: [f64; 3], up: [f64; 3]) -> Option<[f64; 16]> {
    let back = unit(std::array::from_fn(|k| eye[k] - target[k]))?;
    let right = unit(cross(up, back))?;
    Some(from_columns([right, cross(back, right), back], eye))
}

fn from_columns(columns: [[f64; 3]; 3], origin: [f64; 3]) -> [f64; 16] {
    let mut matrix = IDENTITY;
    for (column, values) in matrix.chunks_exact_mut(4).zip(columns.into_iter().chain([origin])) {
        // Adding 0 turns −0 into 0.
        column[..3].copy_from_slice(&values.map(|value| value + 0.0));
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrix::product;

    #[test]
    fn matrices_are_those_of_the_specification() {
        let at = |m: [f64; 16], p: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|k| m[k] * p[0] + m[4 + k] * p[1] + m[8 + k] * p[2] + m[12 + k])
        };
        let rows: Vec<f64> = (0..16).map(f64::from).collect();
        assert_eq!(TransformKind::Matrix.matrix(&rows).unwrap()[12..15], [3.0, 7.0, 11.0]);
        let quarter = TransformKind::Rotate.matrix(&[0.0, 0.0, 2.0, 90.0]).unwrap();
        assert_eq!(at(quarter, [1.0, 0.0, 5.0]), [0.0, 1.0, 5.0]);
        assert_eq!(TransformKind::Rotate.matrix(&[0.0; 4]), Some(IDENTITY));
        assert_eq!(TransformKind::Rotate.matrix(&[0.0, 0.0, 0.0, 1.0]), None);
        let look = TransformKind::LookAt.matrix(&[1.0, 2.0, 3.0, 1.0, 2.0, 0.0, 0.0, 5.0, 0.0]).unwrap();
        assert_eq!(at(look, [0.5, 0.25, -1.0]), [1.5, 2.25, 2.0]);
        assert_eq!(product(&quarter, &IDENTITY), quarter);
    }
}
