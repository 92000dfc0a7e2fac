//! Inside or outside, and normals: for many points at once.
use super::super::{Dual, LeafError, Tape};
use crate::math::unit;

/// Whether each point is inside: where the value is negative. A value of 0 is outside, and so is NaN.
///
/// # Errors
/// When a leaf fails.
///
/// ```
/// use chordal::implicit::Expr;
/// use chordal::implicit::evaluation::Tape;
/// use chordal::implicit::query::contains;
/// let [x, y, _] = Expr::axes();
/// let disc = Tape::new(&(x.square() + y.square() - 1.0));
/// assert_eq!(contains(&disc, &[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]])?, [true, false, false]);
/// # Ok::<(), chordal::implicit::leaves::LeafError>(())
/// ```
pub fn contains(tape: &Tape, points: &[[f64; 3]]) -> Result<Vec<bool>, LeafError> {
    let mut values = vec![0.0; points.len()];
    tape.at(points, &mut values)?;
    Ok(values.into_iter().map(|value| value < 0.0).collect())
}

/// The unit vector of steepest increase at each point: outward on the surface. `None` if the gradient
/// vanishes or is not finite.
///
/// # Errors
/// When a leaf fails.
///
/// ```
/// use chordal::implicit::Expr;
/// use chordal::implicit::evaluation::Tape;
/// use chordal::implicit::query::normals;
/// let [x, y, z] = Expr::axes();
/// let ball = Tape::new(&(x.square() + y.square() + z.square() - 1.0));
/// assert_eq!(normals(&ball, &[[0.0, 0.0, 1.0], [0.0; 3]])?, [Some([0.0, 0.0, 1.0]), None]);
/// # Ok::<(), chordal::implicit::leaves::LeafError>(())
/// ```
pub fn normals(tape: &Tape, points: &[[f64; 3]]) -> Result<Vec<Option<[f64; 3]>>, LeafError> {
    let mut slopes = vec![Dual { value: 0.0, gradient: [0.0; 3] }; points.len()];
    tape.gradient_at(points, &mut slopes)?;
    Ok(slopes.iter().map(|slope| unit(slope.gradient)).collect())
}

pub(super) fn along(origin: [f64; 3], direction: [f64; 3], t: f64) -> [f64; 3] {
    std::array::from_fn(|k| origin[k] + direction[k] * t)
}
