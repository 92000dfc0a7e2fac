//! `Tape`: an expression compiled for evaluation at many points or boxes at once.
use super::block::BlockScalar;
use super::dual::Dual;
use super::expr::Expr;
use super::graph::{ExprGraph, Term};
use super::inputs::{box_side, seed_dual, to_triples};
use super::interpreter::ProgramRun;
use super::leaf::{Leaf, LeafError};
use super::number::TapeInterval;
use super::program::Program;
use crate::budget::Evidence;
use crate::math::{Box3, Interval};
use std::sync::Arc;

/// An expression as a list of instructions, evaluated for many points at once. Each leaf is called once for
/// all points.
///
/// Values are those of f64 operations in the order of the expression, the same bits on every platform.
/// Intervals contain every value that the exact expression takes in a box, rounding included.
#[derive(Clone, Debug)]
pub struct Tape {
    graph: Arc<ExprGraph>,
    plan: Arc<EvaluationPlan>,
}

/// The programs of a batch: the stages that evaluate leaves, then the last program.
#[derive(Debug)]
struct EvaluationPlan {
    /// A leaf whose coordinates depend on other leaves is in a later stage.
    stages: Vec<LeafStage>,
    last: Program,
}

/// Leaves that are evaluated together, and the program that computes the three coordinates of each.
#[derive(Debug)]
struct LeafStage {
    program: Program,
    leaves: Vec<Arc<dyn Leaf>>,
}

impl EvaluationPlan {
    /// Terms that leaves need are computed in the stage before them. Terms needed before and after a leaf are
    /// computed twice.
    fn new(terms: &[Term]) -> Self {
        let mut stage_of = vec![0_usize; terms.len()];
        let mut stages: Vec<Vec<u32>> = Vec::new();
        for (k, term) in terms.iter().enumerate() {
            let stage = |part: &u32| stage_of[*part as usize];
            stage_of[k] = match term {
                Term::Const(_) | Term::Axis(_) => 0,
                Term::Unary(_, a) => stage(a),
                Term::Binary(_, a, b) => stage(a).max(stage(b)),
                Term::Leaf(_, at) => at.iter().map(stage).fold(0, usize::max) + 1,
            };
            if let Term::Leaf(..) = term {
                stages.resize_with(stages.len().max(stage_of[k]), Vec::new);
                stages[stage_of[k] - 1].push(k as u32);
            }
        }
        let order: Vec<u32> = stages.iter().flatten().copied().collect();
        let mut input_of = vec![0_u32; if order.is_empty() { 0 } else { terms.len() }];
        for (column, leaf) in order.iter().enumerate() {
            // The first three inputs are the coordinates.
            input_of[*leaf as usize] = column as u32 + 3;
        }
        let program = |outputs: &[u32]| {
            Program::compile(terms, outputs, &|leaf| input_of[leaf as usize], order.len() + 3)
        };
        let stage = |leaves: &Vec<u32>| {
            let parts = |leaf: &u32| match &terms[*leaf as usize] {
                Term::Leaf(leaf, at) => (Arc::clone(leaf), *at),
                _ => unreachable!("only leaves are put into stages"),
            };
            let (leaves, at): (Vec<_>, Vec<_>) = leaves.iter().map(parts).unzip();
            LeafStage { program: program(at.as_flattened()), leaves }
        };
        Self { stages: stages.iter().map(stage).collect(), last: program(&[terms.len() as u32 - 1]) }
    }
}

/// Tapes with at most this many terms, and tapes for few points, are evaluated without pruning. Chosen:
/// pruning takes about as long as evaluating a tape at a hundred points.
const SHORT: usize = 64;
const FEW: usize = 256;

impl Tape {
    /// Compiles an expression. Cost: linear in its distinct subexpressions.
    #[must_use]
    pub fn new(expr: &Expr) -> Self {
        Self::from_graph(ExprGraph::from_expr(expr))
    }

    /// Compiles the terms of an expression.
    #[must_use]
    pub fn from_graph(graph: ExprGraph) -> Self {
        let plan = EvaluationPlan::new(graph.terms());
        Self { graph: Arc::new(graph), plan: Arc::new(plan) }
    }

    /// The terms that the tape evaluates.
    #[must_use]
    pub fn graph(&self) -> &ExprGraph {
        &self.graph
    }

    /// The number of terms.
    #[must_use]
    pub fn len(&self) -> usize {
        self.graph.terms().len()
    }

    /// Always false: a tape has a value.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Which of x, y and z the value depends on.
    #[must_use]
    pub fn axes(&self) -> [bool; 3] {
        self.graph.axes()
    }

    /// Whether the tape has leaves, which should be called for many points at once.
    #[must_use]
    pub fn has_leaves(&self) -> bool {
        self.graph.terms().iter().any(|term| matches!(term, Term::Leaf(..)))
    }

    /// The evidence of proofs that depend on [`Tape::over`]: the weakest of the leaves.
    #[must_use]
    pub fn evidence(&self) -> Evidence {
        let leaves = self.graph.terms().iter().filter_map(|term| match term {
            Term::Leaf(leaf, _) => Some(leaf.evidence()),
            _ => None,
        });
        leaves.fold(Evidence::Proved, |weakest, leaf| weakest.weaker(&leaf))
    }

    /// The value at each point; NaN where the expression is undefined.
    ///
    /// # Errors
    /// When a leaf fails.
    pub fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        self.run(points.len(), |k, row| points[row][k], |row, value| out[row] = value)
    }

    /// [`Tape::at`] for many scattered points: boxes around them are halved, each with a shorter tape, as
    /// long as that pays. The values are the same wherever the expression is defined.
    ///
    /// # Errors
    /// When a leaf fails.
    pub fn at_many(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        // A leaf is called once for all points, so these stay together.
        if self.has_leaves() {
            return self.at(points, out);
        }
        let mut rows: Vec<u32> = (0..points.len() as u32).collect();
        let mut todo = vec![(self.clone(), 0..rows.len())];
        let (mut part_points, mut values) = (Vec::new(), Vec::new());
        while let Some((tape, range)) = todo.pop() {
            let part = &mut rows[range.clone()];
            part_points.clear();
            part_points.extend(part.iter().map(|row| points[*row as usize]));
            if tape.len() <= SHORT || part.len() <= FEW {
                values.resize(part_points.len(), 0.0);
                tape.at(&part_points, &mut values)?;
                part.iter().zip(&values).for_each(|(row, value)| out[*row as usize] = *value);
                continue;
            }
            let bounds = Box3::from_points(&part_points);
            let tape = tape.prune(&bounds)?.1.unwrap_or(tape);
            let size: [f64; 3] = std::array::from_fn(|k| bounds.max[k] - bounds.min[k]);
            let axis = (1..3).fold(0, |longest, k| if size[k] > size[longest] { k } else { longest });
            let half = part.len() / 2;
            let by_axis = |a: &u32, b: &u32| points[*a as usize][axis].total_cmp(&points[*b as usize][axis]);
            part.select_nth_unstable_by(half, by_axis);
            let middle = range.start + half;
            todo.push((tape.clone(), middle..range.end));
            todo.push((tape, range.start..middle));
        }
        Ok(())
    }

    /// [`Tape::at`] for points given by the columns of their coordinates.
    ///
    /// # Errors
    /// When a leaf fails.
    pub fn at_columns(&self, points: [&[f64]; 3], out: &mut [f64]) -> Result<(), LeafError> {
        self.run(out.len(), |k, row| points[k][row], |row, value| out[row] = value)
    }

    /// The value at each point, in f32 throughout, for pictures and previews. Leaves are evaluated in f64.
    ///
    /// # Errors
    /// When a leaf fails.
    pub fn at_f32(&self, points: &[[f32; 3]], out: &mut [f32]) -> Result<(), LeafError> {
        self.run(points.len(), |k, row| points[row][k], |row, value| out[row] = value)
    }

    /// [`Tape::at_f32`] for points given by the columns of their coordinates.
    ///
    /// # Errors
    /// When a leaf fails.
    pub fn at_columns_f32(&self, points: [&[f32]; 3], out: &mut [f32]) -> Result<(), LeafError> {
        self.run(out.len(), |k, row| points[k][row], |row, value| out[row] = value)
    }

    /// The value and the gradient at each point. At a kink the gradient is that of one side. A leaf without a
    /// gradient is sampled around the point, see [`Leaf::difference_step`].
    ///
    /// # Errors
    /// When a leaf fails.
    pub fn gradient_at(&self, points: &[[f64; 3]], out: &mut [Dual<f64>]) -> Result<(), LeafError> {
        self.run(points.len(), |k, row| seed_dual(points[row][k], k), |row, value| out[row] = value)
    }

    /// An interval of the values in each box. It contains the values of the exact expression, and those that
    /// [`Tape::at`] returns for points of the box, unless they overflow or come from a choice between a
    /// number and NaN. An interval that is not defined says nothing about points where a part of the
    /// expression is undefined.
    ///
    /// # Errors
    /// When a leaf fails.
    pub fn over(&self, boxes: &[Box3], out: &mut [Interval]) -> Result<(), LeafError> {
        let axis = |k: usize, row: usize| TapeInterval::side(boxes[row].min[k], boxes[row].max[k]);
        self.run(boxes.len(), axis, |row, value| out[row] = value.interval())
    }

    /// An interval of the values in each box, and of each partial derivative. At kinks these cover all
    /// generalized gradients (Clarke's), so that the mean value theorem holds with them. All four are defined
    /// or none is.
    ///
    /// # Errors
    /// When a leaf fails.
    pub fn gradient_over(&self, boxes: &[Box3], out: &mut [Dual<Interval>]) -> Result<(), LeafError> {
        let axis = |k: usize, row: usize| seed_dual(box_side(&boxes[row], k), k);
        self.run(boxes.len(), axis, |row, value| out[row] = value)
    }

    /// The interval of the values in a box, and a shorter tape with the same values inside the box. It leaves
    /// out the operands of minima (smooth or not) and maxima that never win there. None if that saves less
    /// than an eighth.
    ///
    /// # Errors
    /// When a leaf fails.
    pub fn prune(&self, bounds: &Box3) -> Result<(Interval, Option<Self>), LeafError> {
        let (range, graph) = self.graph.prune(bounds)?;
        Ok((range, graph.map(Self::from_graph)))
    }

    /// Evaluates every row: `axis` gives coordinate `k` of a row, `put` receives its value. Each leaf is
    /// called once for all rows.
    fn run<N: BlockScalar>(
        &self,
        rows: usize,
        axis: impl Fn(usize, usize) -> N,
        mut put: impl FnMut(usize, N),
    ) -> Result<(), LeafError> {
        let mut columns: Vec<Vec<N>> = Vec::new();
        for LeafStage { program, leaves } in &self.plan.stages {
            let mut coordinates = vec![vec![N::constant(0.0); rows]; program.outputs.len()];
            let keep = |k: usize, row: usize, value: N| coordinates[k][row] = value;
            ProgramRun { program, rows, axis: &axis, columns: &columns, put: keep }.dispatch();
            for (leaf, at) in leaves.iter().zip(coordinates.chunks_exact(3)) {
                // Later stages read the columns of earlier ones.
                columns.push(N::from_leaf(&**leaf, &to_triples([&at[0], &at[1], &at[2]]))?);
            }
        }
        let put = |_, row: usize, value: N| put(row, value);
        ProgramRun { program: &self.plan.last, rows, axis: &axis, columns: &columns, put }.dispatch();
        Ok(())
    }
}

impl Expr {
    /// The value at one point. This compiles a tape each time; for many points compile one yourself, see
    /// [`Tape::at`].
    ///
    /// # Errors
    /// When a leaf fails.
    pub fn at(&self, point: [f64; 3]) -> Result<f64, LeafError> {
        let mut value = [0.0];
        Tape::new(self).at(&[point], &mut value)?;
        Ok(value[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::implicit::op::Unary::{Exp, Ln};

    #[test]
    fn a_logarithm_of_a_sum_of_exponentials_is_one_step_that_does_not_overflow() {
        let [x, y, z] = Expr::axes();
        let exp = |a: &Expr| Expr::unary(Exp, a);
        let sum = Expr::unary(Ln, &(exp(&x) + exp(&y) + exp(&(&z * 2.0))));
        let graph = ExprGraph::from_expr(&sum);
        let is_exp = |term: &Term| matches!(term, Term::Unary(Exp | Ln, _));
        assert!(!graph.terms().iter().any(is_exp), "{graph:?}");
        let ([a, b, c], tape) = ([0.3_f64, -0.7, 0.2], Tape::new(&sum));
        let mut values = [0.0; 2];
        tape.at(&[[a, b, c], [1000.0, 3.0, 500.0]], &mut values).unwrap();
        let expected = (a.exp() + b.exp() + (2.0 * c).exp()).ln();
        assert!((values[0] - expected).abs() < 4.0 * f64::EPSILON, "{values:?}");
        assert!((values[1] - (1000.0 + 2.0_f64.ln())).abs() < 1e-12, "{values:?}");
        // A sum with another term stays as it is.
        let other = ExprGraph::from_expr(&Expr::unary(Ln, &(exp(&x) + &y)));
        assert_eq!(other.terms().iter().filter(|term| is_exp(term)).count(), 2);
    }
}
