//! `Tape`: an expression made ready to be evaluated for many points or boxes at once.
use super::block::Lane;
use super::expr::Expr;
use super::graph::{Graph, Term};
use super::leaf::{Leaf, LeafError};
use super::machine::Run;
use super::number::Range;
use super::program::Program;
use super::slope::Slope;
use super::sources::{boxed, inside, sloped};
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
    plan: Arc<Plan>,
}

/// What is to be run for a batch: first what leaves are asked at, then the rest.
#[derive(Debug)]
struct Plan {
    /// A leaf that is asked at what other leaves say comes in a later stage.
    stages: Vec<Stage>,
    last: Program,
}

/// Leaves that are asked at the same time, and what computes the three coordinates of each.
#[derive(Debug)]
struct Stage {
    program: Program,
    leaves: Vec<Arc<dyn Leaf>>,
}

impl Plan {
    /// What leaves need is computed in the stage before them; what is needed on both sides of a leaf is computed twice.
    fn of(terms: &[Term]) -> Self {
        let mut stage_of = vec![0_usize; terms.len()];
        let mut stages: Vec<Vec<u32>> = Vec::new();
        for (k, term) in terms.iter().enumerate() {
            let of = |part: &u32| stage_of[*part as usize];
            stage_of[k] = match term {
                Term::Const(_) | Term::Axis(_) => 0,
                Term::Unary(_, a) => of(a),
                Term::Binary(_, a, b) => of(a).max(of(b)),
                Term::Leaf(_, at) => at.iter().map(of).fold(0, usize::max) + 1,
            };
            if let Term::Leaf(..) = term {
                stages.resize_with(stages.len().max(stage_of[k]), Vec::new);
                stages[stage_of[k] - 1].push(k as u32);
            }
        }
        let order: Vec<u32> = stages.iter().flatten().copied().collect();
        let mut input_of = vec![0_u32; if order.is_empty() { 0 } else { terms.len() }];
        for (column, leaf) in order.iter().enumerate() {
            input_of[*leaf as usize] = column as u32 + 3;
        }
        let program =
            |outputs: &[u32]| Program::of(terms, outputs, &|leaf| input_of[leaf as usize], order.len() + 3);
        let stage = |leaves: &Vec<u32>| {
            let parts = |leaf: &u32| match &terms[*leaf as usize] {
                Term::Leaf(leaf, at) => (Arc::clone(leaf), *at),
                _ => unreachable!("only leaves are put into stages"),
            };
            let (leaves, at): (Vec<_>, Vec<_>) = leaves.iter().map(parts).unzip();
            Stage { program: program(at.as_flattened()), leaves }
        };
        Self { stages: stages.iter().map(stage).collect(), last: program(&[terms.len() as u32 - 1]) }
    }
}

impl Tape {
    /// The tape of an expression. Cost: linear in its distinct parts.
    #[must_use]
    pub fn of(expr: &Expr) -> Self {
        Self::of_graph(Graph::of(expr))
    }

    /// The tape of the terms of an expression.
    #[must_use]
    pub fn of_graph(graph: Graph) -> Self {
        let plan = Plan::of(graph.terms());
        Self { graph: Arc::new(graph), plan: Arc::new(plan) }
    }

    /// The terms that it evaluates.
    #[must_use]
    pub fn graph(&self) -> &Graph {
        &self.graph
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
        self.run(points.len(), |k, row| points[row][k], |row, value| out[row] = value)
    }

    /// The value at each point, given by the columns of their coordinates: what [`Tape::at`] does for points that are kept so.
    ///
    /// # Errors
    /// What a leaf says.
    pub fn at_columns(&self, points: [&[f64]; 3], out: &mut [f64]) -> Result<(), LeafError> {
        self.run(out.len(), |k, row| points[k][row], |row, value| out[row] = value)
    }

    /// The value at each point, in f32 throughout: for pictures and previews. Leaves are asked in f64.
    ///
    /// # Errors
    /// What a leaf says.
    pub fn at_f32(&self, points: &[[f32; 3]], out: &mut [f32]) -> Result<(), LeafError> {
        self.run(points.len(), |k, row| points[row][k], |row, value| out[row] = value)
    }

    /// [`Tape::at_f32`] for points given by the columns of their coordinates.
    ///
    /// # Errors
    /// What a leaf says.
    pub fn at_columns_f32(&self, points: [&[f32]; 3], out: &mut [f32]) -> Result<(), LeafError> {
        self.run(out.len(), |k, row| points[k][row], |row, value| out[row] = value)
    }

    /// The value and the gradient at each point. Where there is a kink the gradient is that of one side. A leaf that
    /// does not know its gradient is sampled around the point, see [`Leaf::difference_step`].
    ///
    /// # Errors
    /// What a leaf says.
    pub fn gradient_at(&self, points: &[[f64; 3]], out: &mut [Slope<f64>]) -> Result<(), LeafError> {
        self.run(points.len(), |k, row| sloped(points[row][k], k), |row, value| out[row] = value)
    }

    /// A range of the values in each box. It holds the values of the exact expression, and those that [`Tape::at`] returns
    /// for points of the box, unless they overflow or come from a choice between a number and NaN: a range that is not
    /// defined says nothing of points where a part of the expression has no value.
    ///
    /// # Errors
    /// What a leaf says.
    pub fn over(&self, boxes: &[Box3], out: &mut [Interval]) -> Result<(), LeafError> {
        let axis = |k: usize, row: usize| Range::side(boxes[row].min[k], boxes[row].max[k]);
        self.run(boxes.len(), axis, |row, value| out[row] = value.interval())
    }

    /// A range of the values in each box, and of each partial derivative: of all generalized gradients (Clarke's) where
    /// there are kinks, so that the mean value theorem holds with them. All four are defined or none is.
    ///
    /// # Errors
    /// What a leaf says.
    pub fn gradient_over(&self, boxes: &[Box3], out: &mut [Slope<Interval>]) -> Result<(), LeafError> {
        let axis = |k: usize, row: usize| sloped(boxed(&boxes[row], k), k);
        self.run(boxes.len(), axis, |row, value| out[row] = value)
    }

    /// The range of the values in a box, and a shorter tape that has the same values inside of it, where one branch of a
    /// minimum, smooth or not, or maximum always wins there. None where that leaves out less than an eighth.
    ///
    /// # Errors
    /// What a leaf says.
    pub fn shortened(&self, bounds: &Box3) -> Result<(Interval, Option<Self>), LeafError> {
        let (range, graph) = self.graph.shortened(bounds)?;
        Ok((range, graph.map(Self::of_graph)))
    }

    /// Evaluates every row: `axis` has the coordinate `k` of one, `put` takes its value. A leaf is asked once, for all.
    fn run<N: Lane>(
        &self,
        rows: usize,
        axis: impl Fn(usize, usize) -> N,
        mut put: impl FnMut(usize, N),
    ) -> Result<(), LeafError> {
        let mut columns: Vec<Vec<N>> = Vec::new();
        for Stage { program, leaves } in &self.plan.stages {
            let mut places = vec![vec![N::constant(0.0); rows]; program.outputs.len()];
            let keep = |k: usize, row: usize, value: N| places[k][row] = value;
            Run { program, rows, axis: &axis, columns: &columns, put: keep }.dispatch();
            for (leaf, at) in leaves.iter().zip(places.chunks_exact(3)) {
                columns.push(N::of_leaf(&**leaf, &inside([&at[0], &at[1], &at[2]]))?);
            }
        }
        let put = |_, row: usize, value: N| put(row, value);
        Run { program: &self.plan.last, rows, axis: &axis, columns: &columns, put }.dispatch();
        Ok(())
    }
}
