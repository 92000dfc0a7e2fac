//! Expressions evaluated term by term, one number at a time: slow and plain, the oracle of [`super::Tape`].
use super::graph::{Graph, Term};
use super::leaf::{Leaf, LeafError};
use super::number::Number;
use super::slope::Slope;
use super::sources::{Source, boxed, inside, sloped};
use crate::math::{Box3, Interval};

/// [`super::Tape::at`].
///
/// # Errors
/// What a leaf says.
pub fn at(graph: &Graph, points: &[[f64; 3]]) -> Result<Vec<f64>, LeafError> {
    columns(graph, &|k, row| points[row][k], points.len())
}

/// [`super::Tape::at_f32`].
///
/// # Errors
/// What a leaf says.
pub fn at_f32(graph: &Graph, points: &[[f32; 3]]) -> Result<Vec<f32>, LeafError> {
    columns(graph, &|k, row| points[row][k], points.len())
}

/// [`super::Tape::gradient_at`].
///
/// # Errors
/// What a leaf says.
pub fn gradient_at(graph: &Graph, points: &[[f64; 3]]) -> Result<Vec<Slope<f64>>, LeafError> {
    columns(graph, &|k, row| sloped(points[row][k], k), points.len())
}

/// [`super::Tape::over`].
///
/// # Errors
/// What a leaf says.
pub fn over(graph: &Graph, boxes: &[Box3]) -> Result<Vec<Interval>, LeafError> {
    columns(graph, &|k, row| boxed(&boxes[row], k), boxes.len())
}

/// [`super::Tape::gradient_over`].
///
/// # Errors
/// What a leaf says.
pub fn gradient_over(graph: &Graph, boxes: &[Box3]) -> Result<Vec<Slope<Interval>>, LeafError> {
    columns(graph, &|k, row| sloped(boxed(&boxes[row], k), k), boxes.len())
}

/// Every term for every row; the last term's column.
fn columns<N: Number + Source>(
    graph: &Graph,
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
                N::of_leaf(leaf, &inside(at))?
            }
        };
        columns.push(next);
    }
    Ok(columns.pop().unwrap_or_default())
}
