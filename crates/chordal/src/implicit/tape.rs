//! `Tape`: an expression made ready to be evaluated for many points or boxes at once.
use super::expr::Expr;
use super::graph::{Graph, Term};
use super::leaf::{Answer, Leaf, LeafError};
use super::plain::{Number, Slope};
use crate::budget::Evidence;
use crate::math::{Box3, Interval};
use std::sync::Arc;

/// An expression as a list of steps, evaluated for many points at once. A leaf is asked once for all of them.
///
/// Values are those of f64 operations in the order of the expression, the same bits on every platform. Ranges hold every
/// value that the exact expression has in a box, rounding included.
#[derive(Clone, Debug)]
pub struct Tape {
    graph: Arc<Graph>,
}

impl Tape {
    /// The tape of an expression. Cost: linear in its distinct parts.
    #[must_use]
    pub fn of(expr: &Expr) -> Self {
        Self { graph: Arc::new(Graph::of(expr)) }
    }

    /// How many steps it has.
    #[must_use]
    pub fn len(&self) -> usize {
        self.graph.terms().len()
    }

    /// Never: a tape has a value.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Which of x, y and z the value depends on.
    #[must_use]
    pub fn axes(&self) -> [bool; 3] {
        self.graph.axes()
    }

    /// Whether it asks a leaf, which wants to be asked for many points at once.
    #[must_use]
    pub fn has_leaves(&self) -> bool {
        self.graph.terms().iter().any(|term| matches!(term, Term::Leaf(..)))
    }

    /// What proofs that rest on [`Tape::over`] are worth: the weakest of the leaves.
    #[must_use]
    pub fn evidence(&self) -> Evidence {
        let leaves = self.graph.terms().iter().filter_map(|term| match term {
            Term::Leaf(leaf, _) => Some(leaf.evidence()),
            _ => None,
        });
        leaves.fold(Evidence::Proved, |all, one| all.weaker(&one))
    }

    /// The value at each point; NaN where the expression has none.
    ///
    /// # Errors
    /// What a leaf says.
    pub fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        let columns = self.columns(
            points.len(),
            |k, row| points[row][k],
            |leaf, at: [&[f64]; 3]| {
                let points: Vec<[f64; 3]> = (0..at[0].len()).map(|i| [0, 1, 2].map(|k| at[k][i])).collect();
                let mut values = vec![0.0; points.len()];
                leaf.at(&points, &mut values).map(|()| values)
            },
        )?;
        out.copy_from_slice(&columns);
        Ok(())
    }

    /// The value and the gradient at each point. Where there is a kink the gradient is that of one side. A leaf that
    /// does not know its gradient is sampled around the point, see [`Leaf::difference_step`].
    ///
    /// # Errors
    /// What a leaf says.
    pub fn gradient_at(&self, points: &[[f64; 3]], out: &mut [Slope<f64>]) -> Result<(), LeafError> {
        let axis = |k: usize, row: usize| {
            let mut slope = Slope::constant(points[row][k]);
            slope.gradient[k] = 1.0;
            slope
        };
        let columns = self.columns(points.len(), axis, |leaf, at: [&[Slope<f64>]; 3]| {
            let places: Vec<[f64; 3]> = (0..at[0].len()).map(|i| [0, 1, 2].map(|k| at[k][i].value)).collect();
            let mut values = vec![0.0; places.len()];
            leaf.at(&places, &mut values)?;
            let gradients = leaf_gradients(leaf, &places)?;
            let slope = |i: usize| {
                let d = |axis: usize| {
                    let term = |k: usize| gradients[i][k] * at[k][i].gradient[axis];
                    (term(0) + term(1)) + term(2)
                };
                Slope { value: values[i], gradient: [d(0), d(1), d(2)] }
            };
            Ok((0..places.len()).map(slope).collect())
        })?;
        out.copy_from_slice(&columns);
        Ok(())
    }

    /// A range of the values in each box.
    ///
    /// # Errors
    /// What a leaf says.
    pub fn over(&self, boxes: &[Box3], out: &mut [Interval]) -> Result<(), LeafError> {
        let axis = |k: usize, row: usize| side(&boxes[row], k);
        let columns = self.columns(boxes.len(), axis, |leaf, at: [&[Interval]; 3]| {
            let boxes: Vec<Box3> = (0..at[0].len()).map(|i| box_of([0, 1, 2].map(|k| at[k][i]))).collect();
            let defined = |i: usize| (0..3).all(|k| at[k][i].is_defined());
            let mut ranges = vec![Interval::UNKNOWN; boxes.len()];
            let answer = leaf.over(&boxes, &mut ranges)?;
            for (i, range) in ranges.iter_mut().enumerate() {
                if answer == Answer::None {
                    *range = Interval::UNKNOWN;
                } else if !defined(i) {
                    *range = range.undefined();
                }
            }
            Ok(ranges)
        })?;
        out.copy_from_slice(&columns);
        Ok(())
    }

    /// A range of the values in each box, and of each partial derivative: of all generalized gradients (Clarke's) where
    /// there are kinks, so that the mean value theorem holds with them.
    ///
    /// # Errors
    /// What a leaf says.
    pub fn gradient_over(&self, boxes: &[Box3], out: &mut [Slope<Interval>]) -> Result<(), LeafError> {
        let axis = |k: usize, row: usize| {
            let mut slope = Slope::constant(0.0);
            slope.value = side(&boxes[row], k);
            slope.gradient[k] = Interval::point(1.0);
            slope
        };
        let columns = self.columns(boxes.len(), axis, |leaf, at: [&[Slope<Interval>]; 3]| {
            let boxes: Vec<Box3> =
                (0..at[0].len()).map(|i| box_of([0, 1, 2].map(|k| at[k][i].value))).collect();
            let mut ranges = vec![Interval::UNKNOWN; boxes.len()];
            let mut gradients = vec![[Interval::UNKNOWN; 3]; boxes.len()];
            if leaf.over(&boxes, &mut ranges)? == Answer::None {
                ranges.fill(Interval::UNKNOWN);
            }
            if leaf.gradient_over(&boxes, &mut gradients)? == Answer::None {
                gradients.fill([Interval::UNKNOWN; 3]);
            }
            let slope = |i: usize| {
                let d = |axis: usize| {
                    let term = |k: usize| gradients[i][k] * at[k][i].gradient[axis];
                    (term(0) + term(1)) + term(2)
                };
                let defined = (0..3).all(|k| at[k][i].value.is_defined());
                let value = if defined { ranges[i] } else { ranges[i].undefined() };
                Slope { value, gradient: [d(0), d(1), d(2)] }
            };
            Ok((0..boxes.len()).map(slope).collect())
        })?;
        out.copy_from_slice(&columns);
        Ok(())
    }

    /// The range of the values in a box, and a shorter tape that has the same values inside of it, where one branch of a
    /// minimum or maximum always wins there.
    ///
    /// # Errors
    /// What a leaf says.
    pub fn shortened(&self, bounds: &Box3) -> Result<(Interval, Option<Self>), LeafError> {
        let mut range = [Interval::UNKNOWN];
        self.over(std::slice::from_ref(bounds), &mut range)?;
        Ok((range[0], None))
    }

    /// Every term for every row; the last term's column.
    fn columns<N: Number>(
        &self,
        rows: usize,
        axis: impl Fn(usize, usize) -> N,
        leaf_of: impl Fn(&dyn Leaf, [&[N]; 3]) -> Result<Vec<N>, LeafError>,
    ) -> Result<Vec<N>, LeafError> {
        let mut columns: Vec<Vec<N>> = Vec::with_capacity(self.len());
        for term in self.graph.terms() {
            let column = |number: &u32| &columns[*number as usize];
            let next = match term {
                Term::Const(value) => vec![N::constant(*value); rows],
                Term::Axis(k) => (0..rows).map(|row| axis(usize::from(*k), row)).collect(),
                Term::Unary(op, a) => column(a).iter().map(|a| N::unary(*op, a)).collect(),
                Term::Binary(op, a, b) => {
                    column(a).iter().zip(column(b)).map(|(a, b)| N::binary(*op, a, b)).collect()
                }
                Term::Leaf(leaf, at) => leaf_of(&**leaf, at.each_ref().map(|a| column(a).as_slice()))?,
            };
            columns.push(next);
        }
        Ok(columns.pop().unwrap_or_default())
    }
}

/// The leaf's own gradients, or those of a linear function through four samples around each point.
fn leaf_gradients(leaf: &dyn Leaf, points: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, LeafError> {
    const CORNERS: [[f64; 3]; 4] = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let mut gradients = vec![[0.0; 3]; points.len()];
    if leaf.gradient_at(points, &mut gradients)? == Answer::Given {
        return Ok(gradients);
    }
    let step = leaf.difference_step();
    let around: Vec<[f64; 3]> =
        points.iter().flat_map(|p| CORNERS.map(|c| std::array::from_fn(|k| p[k] + step * c[k]))).collect();
    let mut values = vec![0.0; around.len()];
    leaf.at(&around, &mut values)?;
    for (gradient, four) in gradients.iter_mut().zip(values.chunks_exact(4)) {
        *gradient = std::array::from_fn(|k| {
            let sum = (four[0] * CORNERS[0][k] + four[1] * CORNERS[1][k])
                + (four[2] * CORNERS[2][k] + four[3] * CORNERS[3][k]);
            sum / (4.0 * step)
        });
    }
    Ok(gradients)
}

fn side(bounds: &Box3, k: usize) -> Interval {
    Interval::new(bounds.min[k], bounds.max[k]).unwrap_or(Interval::UNKNOWN)
}

fn box_of(sides: [Interval; 3]) -> Box3 {
    Box3 { min: sides.map(Interval::lo), max: sides.map(Interval::hi) }
}
