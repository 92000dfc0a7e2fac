//! The transform of a prim: a list of operations, the first of which is the outermost.
//!
//! Source: Pixar Animation Studios, *UsdGeomXformOp* and *UsdGeomXformable*, openusd.org, 2024.
use super::stage::{StagePrim, UsdStage};
use crate::ReadError;
use crate::matrix::{IDENTITY, product, sine_cosine};

/// The operation that discards the transforms of ancestors.
const RESET: &str = "!resetXformStack!";
/// The prefix of an inverted operation.
const INVERT: &str = "!invert!";

/// The transform of a prim to its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LocalTransform {
    /// Column-major.
    pub matrix: [f64; 16],
    /// Whether the transform is relative to the world instead.
    pub is_reset: bool,
}

impl UsdStage<'_, '_> {
    /// The transform of a prim.
    ///
    /// # Errors
    /// If a value is damaged or not finite, or a matrix that must be inverted is singular.
    pub(super) fn transform(&self, prim: &StagePrim) -> Result<LocalTransform, ReadError> {
        let mut local = LocalTransform { matrix: IDENTITY, is_reset: false };
        let order = self.words(prim, "xformOpOrder")?;
        for operation in order {
            if &*operation == RESET {
                local = LocalTransform { matrix: IDENTITY, is_reset: true };
                continue;
            }
            let name = operation.strip_prefix(INVERT).unwrap_or(&operation);
            let is_inverted = name.len() < operation.len();
            let Some(matrix) = self.operation(prim, name)? else {
                let what = "transforms name operations that are not there or not known";
                self.note("transform-skipped", what, &format!("{name} of {}", prim.path));
                continue;
            };
            let matrix = if is_inverted { inverse(&matrix) } else { Some(matrix) };
            let matrix = matrix.map(|matrix| product(&local.matrix, &matrix));
            local.matrix = matrix.filter(|matrix| matrix.iter().all(|x| x.is_finite())).ok_or_else(|| {
                let message = format!("{}.{operation} is not finite, or has no inverse", prim.path);
                ReadError::new("bad-transform", self.place(prim), message)
            })?;
        }
        let bottom = [local.matrix[3], local.matrix[7], local.matrix[11], local.matrix[15]];
        if bottom != [0.0, 0.0, 0.0, 1.0] {
            let message = format!("the transform of {} is a projection", prim.path);
            return Err(ReadError::new("bad-transform", self.place(prim), message));
        }
        Ok(local)
    }

    /// The matrix of an operation.
    fn operation(&self, prim: &StagePrim, name: &str) -> Result<Option<[f64; 16]>, ReadError> {
        let Some(rest) = name.strip_prefix("xformOp:") else { return Ok(None) };
        let kind = rest.split(':').next().unwrap_or(rest);
        let Some(numbers) = self.numbers(prim, name)? else { return Ok(None) };
        let one = numbers.first::<1>().map(|[x]| x);
        let three = numbers.first::<3>();
        Ok(match kind {
            "translate" => three.map(translation),
            "scale" => three.map(scaling),
            "translateX" | "translateY" | "translateZ" => one.map(|x| translation(on_axis(kind, x, 0.0))),
            "scaleX" | "scaleY" | "scaleZ" => one.map(|x| scaling(on_axis(kind, x, 1.0))),
            "rotateX" | "rotateY" | "rotateZ" => one.map(|x| rotation(kind.as_bytes()[6], x)),
            "rotateXYZ" | "rotateXZY" | "rotateYXZ" | "rotateYZX" | "rotateZXY" | "rotateZYX" => {
                // The rotation about the first axis is applied first.
                three.map(|degrees| {
                    let axes = kind.as_bytes()[6..].iter();
                    axes.fold(IDENTITY, |so_far, axis| {
                        product(&rotation(*axis, degrees[usize::from(axis - b'X')]), &so_far)
                    })
                })
            }
            "orient" => numbers.first::<4>().and_then(quaternion_matrix),
            // The file's rows, for row vectors, are our columns for column vectors.
            "transform" => numbers.first::<16>(),
            _ => None,
        })
    }
}

/// A number on the axis at the end of a name, another number on the other axes.
fn on_axis(name: &str, value: f64, other: f64) -> [f64; 3] {
    let axis = name.as_bytes().last().map_or(0, |letter| letter.wrapping_sub(b'X'));
    std::array::from_fn(|k| if k == usize::from(axis) { value } else { other })
}

fn translation([x, y, z]: [f64; 3]) -> [f64; 16] {
    let mut matrix = IDENTITY;
    matrix[12..15].copy_from_slice(&[x, y, z]);
    matrix
}

fn scaling([x, y, z]: [f64; 3]) -> [f64; 16] {
    let mut matrix = IDENTITY;
    (matrix[0], matrix[5], matrix[10]) = (x, y, z);
    matrix
}

/// A rotation about an axis, X, Y or Z. Quarters of a turn are exact.
fn rotation(axis: u8, degrees: f64) -> [f64; 16] {
    let [sin, cos] = sine_cosine(degrees);
    let (i, j) = match axis {
        b'X' => (1, 2),
        b'Y' => (2, 0),
        _ => (0, 1),
    };
    let mut matrix = IDENTITY;
    matrix[5 * i] = cos;
    matrix[5 * j] = cos;
    matrix[4 * i + j] = sin;
    matrix[4 * j + i] = -sin;
    matrix
}

/// The rotation of a quaternion, real part first, of any length. `None` for zero.
pub(super) fn quaternion_matrix(q: [f64; 4]) -> Option<[f64; 16]> {
    let [w, x, y, z] = q;
    let square = w * w + x * x + y * y + z * z;
    if !(square > 0.0 && square.is_finite()) {
        return None;
    }
    // The square takes the quaternion's length out of the products below, without a root.
    let s = 2.0 / square;
    let mut matrix = IDENTITY;
    matrix[0] = 1.0 - s * (y * y + z * z);
    matrix[1] = s * (x * y + w * z);
    matrix[2] = s * (x * z - w * y);
    matrix[4] = s * (x * y - w * z);
    matrix[5] = 1.0 - s * (x * x + z * z);
    matrix[6] = s * (y * z + w * x);
    matrix[8] = s * (x * z + w * y);
    matrix[9] = s * (y * z - w * x);
    matrix[10] = 1.0 - s * (x * x + y * y);
    Some(matrix)
}

/// The matrix of a translation, a rotation and a scale.
pub(super) fn compose(at: [f64; 3], turn: [f64; 16], size: [f64; 3]) -> [f64; 16] {
    product(&translation(at), &product(&turn, &scaling(size)))
}

/// The inverse of an affine matrix, if it has one.
fn inverse(m: &[f64; 16]) -> Option<[f64; 16]> {
    let column = |k: usize| [m[4 * k], m[4 * k + 1], m[4 * k + 2]];
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let (a, b, c) = (column(0), column(1), column(2));
    if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
        return None;
    }
    // Special cases to keep exactness: a translation only changes its sign, an axis-aligned scale only its
    // size.
    let is_diagonal = (0..3).all(|i| (0..3).all(|j| i == j || m[4 * i + j] == 0.0));
    let rows = if is_diagonal {
        [[1.0 / a[0], 0.0, 0.0], [0.0, 1.0 / b[1], 0.0], [0.0, 0.0, 1.0 / c[2]]]
    } else {
        let rows = [cross(b, c), cross(c, a), cross(a, b)];
        let determinant = a[0] * rows[0][0] + a[1] * rows[0][1] + a[2] * rows[0][2];
        rows.map(|row| row.map(|x| x / determinant))
    };
    let mut out = IDENTITY;
    for (r, row) in rows.iter().enumerate() {
        for k in 0..3 {
            out[4 * k + r] = row[k];
        }
        // Subtracted from 0 instead of negated, so that a zero has no sign.
        out[12 + r] = 0.0 - ((row[0] * m[12] + row[1] * m[13]) + row[2] * m[14]);
    }
    out.iter().all(|x| x.is_finite()).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inverse_undoes_a_transform() {
        let turn = quaternion_matrix([1.0, 2.0, -3.0, 0.5]).unwrap();
        let matrix = compose([4.0, -5.0, 6.0], turn, [2.0, 0.5, -3.0]);
        let one = product(&matrix, &inverse(&matrix).unwrap());
        assert!(one.iter().zip(&IDENTITY).all(|(a, b)| (a - b).abs() < 1e-14), "{one:?}");
        let moved = translation([0.1, 0.2, 0.3]);
        assert_eq!(inverse(&moved), Some(translation([-0.1, -0.2, -0.3])));
        assert_eq!(inverse(&scaling([1.0, 0.0, 1.0])), None);
    }

    #[test]
    fn quarters_of_a_turn_are_exact() {
        assert_eq!(rotation(b'Z', 90.0)[..2], [0.0, 1.0]);
        assert_eq!(rotation(b'X', -270.0)[5..7], [0.0, 1.0]);
        assert_eq!(rotation(b'Y', 720.0), IDENTITY);
    }
}
