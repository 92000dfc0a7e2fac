//! Expressions evaluated term by term, one number at a time: slow and simple, the oracle of [`super::Tape`].
use super::dual::Dual;
use super::graph::{ExprGraph, Term};
use super::inputs::{LeafScalar, box_side, seed_dual, to_triples};
use super::leaf::{Leaf, LeafError};
use super::number::Scalar;
use crate::math::{Box3, Interval};

/// [`super::Tape::at`].
///
/// # Errors
/// When a leaf fails.
pub fn at(graph: &ExprGraph, points: &[[f64; 3]]) -> Result<Vec<f64>, LeafError> {
    columns(graph, &|k, row| points[row][k], points.len())
}

/// [`super::Tape::at_f32`].
///
/// # Errors
/// When a leaf fails.
pub fn at_f32(graph: &ExprGraph, points: &[[f32; 3]]) -> Result<Vec<f32>, LeafError> {
    columns(graph, &|k, row| points[row][k], points.len())
}

/// [`super::Tape::gradient_at`].
///
/// # Errors
/// When a leaf fails.
pub fn gradient_at(graph: &ExprGraph, points: &[[f64; 3]]) -> Result<Vec<Dual<f64>>, LeafError> {
    columns(graph, &|k, row| seed_dual(points[row][k], k), points.len())
}

/// [`super::Tape::over`].
///
/// # Errors
/// When a leaf fails.
pub fn over(graph: &ExprGraph, boxes: &[Box3]) -> Result<Vec<Interval>, LeafError> {
    columns(graph, &|k, row| box_side(&boxes[row], k), boxes.len())
}

/// [`super::Tape::gradient_over`].
///
/// # Errors
/// When a leaf fails.
pub fn gradient_over(graph: &ExprGraph, boxes: &[Box3]) -> Result<Vec<Dual<Interval>>, LeafError> {
    columns(graph, &|k, row| seed_dual(box_side(&boxes[row], k), k), boxes.len())
}

/// Evaluates every term for every row; returns the last column.
fn columns<N: Scalar + LeafScalar>(
    graph: &ExprGraph,
    axis: &dyn Fn(usize, usize) -> N,
    rows: usize,
) -> Result<Vec<N>, LeafError> {
    let mut columns: Vec<Vec<N>> = Vec::with_capacity(graph.terms().len());
    for term in graph.terms() {
        let column = |number: &u32| &columns[*number as usize];
        let next = match term {
            Term::Const(value) => vec![N::constant(*value); rows],
            Term::Axis(k) => (0..rows).map(|row| axis(usize::from(*k), row)).collect(),
            Term::Unary(op, a) => column(a).iter().map(|a| N::unary(*op, *a)).collect(),
            Term::Binary(op, a, b) => {
                column(a).iter().zip(column(b)).map(|(a, b)| N::binary(*op, *a, *b)).collect()
            }
            Term::Leaf(leaf, at) => {
                let leaf: &dyn Leaf = &**leaf;
                let at = at.each_ref().map(|a| column(a).as_slice());
                N::from_leaf(leaf, &to_triples(at))?
            }
        };
        columns.push(next);
    }
    Ok(columns.pop().unwrap_or_default())
}
