//! The inputs of programs: coordinates of points and boxes, and values of leaves.
use super::dual::{Dual, GeneralizedDerivative};
use super::leaf::{Leaf, LeafAnswer, LeafError};
use super::number::{Scalar, TapeInterval};
use crate::math::{Box3, Interval};

/// A number type in which leaves can be evaluated.
pub(super) trait LeafScalar: Scalar {
    /// The values of the leaf at each of these triples of coordinates.
    fn from_leaf(leaf: &dyn Leaf, at: &[[Self; 3]]) -> Result<Vec<Self>, LeafError>;
}

/// The coordinate `k` with its derivatives.
#[inline(always)]
pub(super) fn seed_dual<N: GeneralizedDerivative>(value: N, k: usize) -> Dual<N> {
    let derivative = |axis: usize| N::constant(if axis == k { 1.0 } else { 0.0 });
    N::unify_decorations(Dual { value, gradient: [0, 1, 2].map(derivative) })
}

/// The side of a box along axis `k`.
#[inline(always)]
pub(super) fn box_side(bounds: &Box3, k: usize) -> Interval {
    Interval::new(bounds.min[k], bounds.max[k]).unwrap_or(Interval::UNKNOWN)
}

/// Three columns as triples.
pub(super) fn to_triples<N: Copy>(at: [&[N]; 3]) -> Vec<[N; 3]> {
    (0..at[0].len()).map(|row| [at[0][row], at[1][row], at[2][row]]).collect()
}

impl LeafScalar for f64 {
    fn from_leaf(leaf: &dyn Leaf, at: &[[Self; 3]]) -> Result<Vec<Self>, LeafError> {
        let mut values = vec![0.0; at.len()];
        leaf.at(at, &mut values)?;
        Ok(values)
    }
}

impl LeafScalar for f32 {
    fn from_leaf(leaf: &dyn Leaf, at: &[[Self; 3]]) -> Result<Vec<Self>, LeafError> {
        let points: Vec<[f64; 3]> = at.iter().map(|p| p.map(f64::from)).collect();
        Ok(f64::from_leaf(leaf, &points)?.into_iter().map(|value| value as Self).collect())
    }
}

impl LeafScalar for Dual<f64> {
    fn from_leaf(leaf: &dyn Leaf, at: &[[Self; 3]]) -> Result<Vec<Self>, LeafError> {
        let points: Vec<[f64; 3]> = at.iter().map(|p| p.map(|s| s.value)).collect();
        let values = f64::from_leaf(leaf, &points)?;
        let gradients = leaf_gradients(leaf, &points)?;
        let slope = |i: usize| Self {
            value: values[i],
            gradient: chain(&gradients[i], &at[i], |a, b| a * b, |a, b| a + b),
        };
        Ok((0..at.len()).map(slope).collect())
    }
}

impl LeafScalar for Interval {
    fn from_leaf(leaf: &dyn Leaf, at: &[[Self; 3]]) -> Result<Vec<Self>, LeafError> {
        let boxes: Vec<Box3> = at.iter().map(box_of).collect();
        let mut ranges = vec![Self::UNKNOWN; boxes.len()];
        let answer = leaf.over(&boxes, &mut ranges)?;
        for (range, sides) in ranges.iter_mut().zip(at) {
            // Without an answer all numbers are possible; without defined coordinates the value is undefined.
            let claims = sides.iter().all(|side| side.is_defined());
            *range = match answer {
                LeafAnswer::None => Self::UNKNOWN,
                LeafAnswer::Given if claims => *range,
                LeafAnswer::Given => range.undefined(),
            };
        }
        Ok(ranges)
    }
}

impl LeafScalar for TapeInterval {
    fn from_leaf(leaf: &dyn Leaf, at: &[[Self; 3]]) -> Result<Vec<Self>, LeafError> {
        let sides: Vec<[Interval; 3]> = at.iter().map(|p| p.map(Self::interval)).collect();
        Ok(Interval::from_leaf(leaf, &sides)?.into_iter().map(Self::from_interval).collect())
    }
}

impl LeafScalar for Dual<Interval> {
    fn from_leaf(leaf: &dyn Leaf, at: &[[Self; 3]]) -> Result<Vec<Self>, LeafError> {
        let sides: Vec<[Interval; 3]> = at.iter().map(|p| p.map(|s| s.value)).collect();
        let ranges = Interval::from_leaf(leaf, &sides)?;
        let boxes: Vec<Box3> = sides.iter().map(box_of).collect();
        let mut gradients = vec![[Interval::UNKNOWN; 3]; boxes.len()];
        if leaf.gradient_over(&boxes, &mut gradients)? == LeafAnswer::None {
            gradients.fill([Interval::UNKNOWN; 3]);
        }
        let slope = |i: usize| {
            let gradient = chain(&gradients[i], &at[i], |a, b| a * b, |a, b| a + b);
            Interval::unify_decorations(Self { value: ranges[i], gradient })
        };
        Ok((0..boxes.len()).map(slope).collect())
    }
}

/// A leaf's derivatives along x, y and z from those along its own coordinates.
fn chain<N: Copy>(
    outer: &[N; 3],
    inner: &[Dual<N>; 3],
    mul: impl Fn(N, N) -> N,
    add: impl Fn(N, N) -> N,
) -> [N; 3] {
    [0, 1, 2].map(|axis| {
        let term = |k: usize| mul(outer[k], inner[k].gradient[axis]);
        add(add(term(0), term(1)), term(2))
    })
}

fn box_of(sides: &[Interval; 3]) -> Box3 {
    Box3 { min: sides.map(Interval::lo), max: sides.map(Interval::hi) }
}

/// The gradients that the leaf returns, or those of a linear function through four samples around each point.
fn leaf_gradients(leaf: &dyn Leaf, points: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, LeafError> {
    const CORNERS: [[f64; 3]; 4] = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let mut gradients = vec![[0.0; 3]; points.len()];
    if leaf.gradient_at(points, &mut gradients)? == LeafAnswer::Given {
        return Ok(gradients);
    }
    let step = leaf.difference_step();
    let around: Vec<[f64; 3]> =
        points.iter().flat_map(|p| CORNERS.map(|c| std::array::from_fn(|k| p[k] + step * c[k]))).collect();
    let mut values = vec![0.0; around.len()];
    leaf.at(&around, &mut values)?;
    for (gradient, four) in gradients.iter_mut().zip(values.chunks_exact(4)) {
        // The columns of the corners are orthogonal, so that each slope is a sum by itself.
        *gradient = std::array::from_fn(|k| {
            let sum = (four[0] * CORNERS[0][k] + four[1] * CORNERS[1][k])
                + (four[2] * CORNERS[2][k] + four[3] * CORNERS[3][k]);
            sum / (4.0 * step)
        });
    }
    Ok(gradients)
}
