//! `Csg`: the sign of a field as a CSG tree of primitives.
//!
//! A field's surface depends only on its sign. The sign of `min(a, b)` is that of the union of `a` and `b`,
//! of `max(a, b)` that of the intersection, of `−a` that of the complement. So minima, maxima, negations,
//! absolute values, and sums and products with constants are expanded from the root down; the terms below
//! them are the primitives. In most models each is smooth on its own, its zero set crosses others at creases
//! and corners, and its values have their own units.
mod affine_terms;
mod branches;
mod convexity;
mod evaluator;
mod level;
mod materials;
mod subgraph;
mod tree;

pub use convexity::Curvature;
pub use evaluator::{DualRange, PrimitiveEvaluator};
pub use materials::{BlendPart, CsgMaterials, MaterialChoice};
pub use tree::{CsgNode, CsgRestriction, CsgTree, Membership};

use super::graph::{ExprGraph, Term};
use super::op::{Binary, Unary};
use super::tape::Tape;
use crate::budget::Evidence;
use crate::math::greater;
use affine_terms::AffineTerms;
pub(crate) use level::LevelFunction;
use level::{LevelSet, LevelTable, MonotoneOp};
use materials::{MaterialsBuilder, OperandMaterial};
use std::collections::HashMap;
use subgraph::{mark_of, subgraph_terms, unmarked};

/// A field's sign as unions and intersections of primitives and their complements.
///
/// It describes the set `{F < 0}` with its boundary regularized: where `a` and its complement `−a` meet, like
/// two stacked boxes at their common face, there is no surface. Two parallel planes are treated as one if
/// they differ only by rounding, by at most 2⁻⁴⁸ of the largest numbers in both: a part of height 0.6 around
/// the origin and one of height 0.2 around 0.4 meet, though their floating-point numbers differ, and still do
/// after both are turned by 30°. Bounds of meshes add the difference.
///
/// ```
/// use chordal::implicit::shapes;
/// use chordal::implicit::csg::{Csg, CsgNode};
/// let block = shapes::cuboid([2.0, 2.0, 1.0])?.difference(&shapes::cylinder(0.4, 2.0)?);
/// let csg = Csg::from_expr(block.sign());
/// // Six planes of the box; the side of the cylinder and its two ends.
/// assert_eq!(csg.primitives().len(), 9);
/// # Ok::<(), chordal::implicit::shapes::InvalidShape>(())
/// ```
#[derive(Clone, Debug)]
pub struct Csg {
    primitives: Vec<Primitive>,
    tree: CsgTree,
    materials: Option<CsgMaterials>,
    weld: f64,
}

/// A function whose sign alone counts.
#[derive(Clone, Debug)]
pub struct Primitive {
    tape: Tape,
    is_total: bool,
    curvature: Curvature,
    /// Its zero set, as a level of a term of the full expression.
    level: Option<LevelSet>,
}

impl Primitive {
    fn new(graph: ExprGraph, level: Option<LevelSet>) -> Self {
        let (is_total, curvature) = (is_total(graph.terms()), Curvature::from_terms(graph.terms()));
        Self { tape: Tape::from_graph(graph), is_total, curvature, level }
    }

    /// The function.
    #[must_use]
    pub fn tape(&self) -> &Tape {
        &self.tape
    }

    /// Whether it is defined at every point. Then an interval contains all values even if it is not
    /// continuous.
    #[must_use]
    pub fn is_total(&self) -> bool {
        self.is_total
    }

    /// Its curvature, as far as its terms show.
    #[must_use]
    pub fn curvature(&self) -> Curvature {
        self.curvature
    }

    /// Whether the two zero sets never meet, because they are two different levels of one function.
    #[must_use]
    pub fn is_parallel_to(&self, other: &Self) -> bool {
        matches!((self.level, other.level), (Some(a), Some(b)) if a.is_parallel_to(&b))
    }

    /// The function of which it is a level, if known.
    pub(crate) fn level_function(&self) -> Option<LevelFunction> {
        self.level.map(|level| level.function())
    }

    /// Whether both vanish on planes with the same normal.
    pub(crate) fn is_plane_along(&self, other: &Self) -> bool {
        matches!((self.level, other.level), (Some(a), Some(b)) if a.is_plane_along(&b))
    }

    /// The level at which it vanishes, of the function that it shares with the primitives parallel to it.
    pub(crate) fn height(&self) -> f64 {
        self.level.map_or(0.0, |level| level.height())
    }

    /// Whether it falls as that function grows.
    pub(crate) fn falls(&self) -> bool {
        self.level.is_some_and(|level| level.falls())
    }
}

/// The most nodes of a tree; an expression that would have more is one primitive. Defined: some megabytes.
const MOST_NODES: usize = 1 << 16;
/// The most terms of all primitives together, per term of the full expression, besides [`MOST_NODES`]: shared
/// parts are copied into each primitive.
const MOST_COPIES: usize = 32;

impl Csg {
    /// The tree of an expression. Cost: linear in its terms, and in their copies where primitives share them.
    #[must_use]
    pub fn from_expr(sign: &super::Expr) -> Self {
        Self::from_graph(&ExprGraph::with_materials(sign))
    }

    /// The tree of the terms of an expression.
    #[must_use]
    pub fn from_graph(graph: &ExprGraph) -> Self {
        let mut builder = CsgBuilder::new(graph.terms());
        builder.build().unwrap_or_else(|| builder.single())
    }

    /// The primitives, by index.
    #[must_use]
    pub fn primitives(&self) -> &[Primitive] {
        &self.primitives
    }

    /// The tree that joins them.
    #[must_use]
    pub fn tree(&self) -> &CsgTree {
        &self.tree
    }

    /// The materials of the primitives, if any has one.
    #[must_use]
    pub fn materials(&self) -> Option<&CsgMaterials> {
        self.materials.as_ref()
    }

    /// The largest distance between levels that were merged.
    pub(crate) fn weld(&self) -> f64 {
        self.weld
    }

    /// The evidence of proofs by intervals of the primitives: the weakest of all.
    #[must_use]
    pub fn evidence(&self) -> Evidence {
        self.primitives
            .iter()
            .fold(Evidence::Proved, |weakest, primitive| weakest.weaker(&primitive.tape.evidence()))
    }
}

/// The operations above a term, from the innermost to the root: a linked list with shared tails.
#[derive(Clone, Copy, Debug)]
struct ChainLink {
    op: MonotoneOp,
    /// The next operation; [`NOTHING`] at the root.
    next: u32,
}

const NOTHING: u32 = u32::MAX;

/// A term with the operations above it.
#[derive(Clone, Copy, Debug)]
struct CsgOperand {
    term: u32,
    above: u32,
    falls: bool,
    /// Its number is 0 if there is none yet.
    material: OperandMaterial,
}

enum CsgBuildStep {
    Visit(CsgOperand),
    Emit(CsgNode),
}

/// A term and the operations with constants above it, without their signs. Two primitives with equal keys are
/// the same, or complements.
type ChainKey = (u32, u32);

struct CsgBuilder<'a> {
    terms: &'a [Term],
    above: Vec<ChainLink>,
    chains: HashMap<(u8, u64, u32), u32>,     // No order depends on it.
    literals: HashMap<ChainKey, (u32, bool)>, // No order depends on it.
    levels: LevelTable,
    affine: AffineTerms,
    weld: f64,
    /// Differences of two terms, with the earlier term first.
    mirrored: HashMap<(u32, u32), u32>, // No order depends on it.
    primitives: Vec<Primitive>,
    nodes: Vec<CsgNode>,
    materials: MaterialsBuilder,
    n_copied: usize,
}

impl<'a> CsgBuilder<'a> {
    fn new(terms: &'a [Term]) -> Self {
        let difference = |(number, term): (usize, &Term)| match *term {
            Term::Binary(Binary::Sub, a, b) if a < b => Some(((a, b), number as u32)),
            _ => None,
        };
        Self {
            terms,
            mirrored: terms.iter().enumerate().filter_map(difference).collect(),
            above: Vec::new(),
            chains: HashMap::new(),   // No order depends on it.
            literals: HashMap::new(), // No order depends on it.
            levels: LevelTable::default(),
            affine: AffineTerms::new(terms),
            weld: 0.0,
            primitives: Vec::new(),
            nodes: Vec::new(),
            materials: MaterialsBuilder::default(),
            n_copied: 0,
        }
    }

    /// None if the tree or its primitives would be too large.
    fn build(&mut self) -> Option<Csg> {
        let root = self.root();
        let mut steps = vec![CsgBuildStep::Visit(root)];
        while let Some(step) = steps.pop() {
            if self.nodes.len() + steps.len() > MOST_NODES
                || self.n_copied > MOST_NODES + MOST_COPIES * self.terms.len()
            {
                return None;
            }
            match step {
                CsgBuildStep::Emit(node) => {
                    self.materials.push_operator();
                    self.nodes.push(node);
                }
                CsgBuildStep::Visit(operand) => match self.operands(operand) {
                    Some((operands, is_union)) => {
                        let n = operands.len() as u32;
                        let node = if is_union { CsgNode::Union(n) } else { CsgNode::Intersection(n) };
                        steps.push(CsgBuildStep::Emit(node));
                        // In reverse, so that the operands leave the stack in their order.
                        steps.extend(operands.into_iter().rev().map(CsgBuildStep::Visit));
                    }
                    None => {
                        let node = self.literal(operand);
                        self.nodes.push(node);
                    }
                },
            }
        }
        Some(self.finish())
    }

    fn root(&self) -> CsgOperand {
        CsgOperand {
            term: self.terms.len() as u32 - 1,
            above: NOTHING,
            falls: false,
            material: OperandMaterial::default(),
        }
    }

    fn finish(&mut self) -> Csg {
        let tree = CsgTree::new(std::mem::take(&mut self.nodes));
        let materials = std::mem::take(&mut self.materials).finish();
        Csg { primitives: std::mem::take(&mut self.primitives), tree, materials, weld: self.weld }
    }

    /// The full expression as one primitive.
    fn single(&mut self) -> Csg {
        *self = Self::new(self.terms);
        let root = self.root();
        self.add_materials(root);
        let graph = self.graph_of(root);
        self.primitives.push(Primitive::new(graph, None));
        self.nodes.push(CsgNode::Primitive(0));
        self.finish()
    }

    /// The operands of the union or intersection at `operand`, with nested operators of the same kind merged;
    /// None for a primitive.
    fn operands(&mut self, operand: CsgOperand) -> Option<(Vec<CsgOperand>, bool)> {
        let ([a, b], is_union) = self.split(operand)?;
        let mut open = vec![b, a];
        let mut operands = Vec::new();
        while let Some(next) = open.pop() {
            match self.split(next) {
                Some(([a, b], same)) if same == is_union && operands.len() < MOST_NODES => {
                    open.extend([b, a]);
                }
                _ => operands.push(next),
            }
        }
        Some((operands, is_union))
    }

    /// The two operands of a minimum or maximum below operations with constants.
    fn split(&mut self, mut operand: CsgOperand) -> Option<([CsgOperand; 2], bool)> {
        loop {
            let (op, term) = match self.terms[operand.term as usize] {
                Term::Binary(op @ (Binary::Min | Binary::Max), a, b) => {
                    // Below an operation that falls, a minimum becomes a maximum.
                    let is_union = (op == Binary::Min) != operand.falls;
                    return Some(([a, b].map(|term| CsgOperand { term, ..operand }), is_union));
                }
                Term::Unary(Unary::Abs, a) => {
                    // |a| is the maximum of a and −a.
                    let mirrored = CsgOperand {
                        above: self.push(MonotoneOp::Neg, operand.above),
                        falls: !operand.falls,
                        term: a,
                        ..operand
                    };
                    return Some(([CsgOperand { term: a, ..operand }, mirrored], operand.falls));
                }
                Term::Unary(Unary::Neg, a) => (MonotoneOp::Neg, a),
                Term::Binary(op, a, b) => self.with_constant(op, a, b)?,
                Term::Leaf(..) => {
                    let (mark, below) = mark_of(self.terms, operand.term)?;
                    // The outermost mark counts.
                    if operand.material.number == 0 {
                        operand.material =
                            OperandMaterial { number: self.materials.number(mark), cuts: operand.falls };
                    }
                    operand.term = below;
                    continue;
                }
                _ => return None,
            };
            operand = CsgOperand {
                term,
                above: self.push(op, operand.above),
                falls: operand.falls != op.falls(),
                ..operand
            };
        }
    }

    /// The operation, if one operand is a constant that keeps it monotone.
    fn with_constant(&self, op: Binary, a: u32, b: u32) -> Option<(MonotoneOp, u32)> {
        let constant = |term: u32| match self.terms[term as usize] {
            Term::Const(value) if value.is_finite() => Some(value),
            _ => None,
        };
        match (op, constant(a), constant(b)) {
            (Binary::Add, Some(k), None) => Some((MonotoneOp::Add(k), b)),
            (Binary::Add, None, Some(k)) => Some((MonotoneOp::Add(k), a)),
            (Binary::Sub, Some(k), None) => Some((MonotoneOp::From(k), b)),
            (Binary::Sub, None, Some(k)) => Some((MonotoneOp::Add(-k), a)),
            // A factor of 0 would keep no sign.
            (Binary::Mul, Some(k), None) if k != 0.0 => Some((MonotoneOp::Mul(k), b)),
            (Binary::Mul, None, Some(k)) if k != 0.0 => Some((MonotoneOp::Mul(k), a)),
            (Binary::Div, None, Some(k)) if k != 0.0 => Some((MonotoneOp::Div(k), a)),
            _ => None,
        }
    }

    /// The chain with another operation at its inner end; equal chains are stored once.
    fn push(&mut self, op: MonotoneOp, next: u32) -> u32 {
        let (kind, constant) = match op {
            MonotoneOp::Neg => (0, 0.0),
            MonotoneOp::Add(k) => (1, k),
            MonotoneOp::From(k) => (2, k),
            MonotoneOp::Mul(k) => (3, k),
            MonotoneOp::Div(k) => (4, k),
        };
        let number = self.above.len() as u32;
        let number = *self.chains.entry((kind, constant.to_bits(), next)).or_insert(number);
        if number as usize == self.above.len() {
            self.above.push(ChainLink { op, next });
        }
        number
    }

    /// The node of a primitive: new, or an earlier one or its complement.
    fn literal(&mut self, operand: CsgOperand) -> CsgNode {
        self.add_materials(operand);
        let (base, ops) = self.chain(operand);
        let plane = self.affine.family(base);
        let level = LevelSet::from_chain(base, &ops);
        let level = level.map(|level| plane.map_or(level, |plane| level.on_planes(&plane)));
        let (key, falls) = self.chain_key(base, &ops);
        let either = |number: u32, is_opposite: bool| {
            if is_opposite { CsgNode::Complement(number) } else { CsgNode::Primitive(number) }
        };
        if let Some((number, known_falls)) = self.literals.get(&key) {
            return either(*number, falls != *known_falls);
        }
        if let Some(same) = level.and_then(|level| self.levels.same(&level)) {
            // A rounded length is off by less than two steps.
            let steepness = plane.map_or(1.0, |plane| plane.steepness.next_down().next_down());
            let distance = if same.off == 0.0 { 0.0 } else { (same.off / steepness).next_up() };
            self.weld = greater(distance, self.weld);
            return either(same.primitive, same.is_opposite);
        }
        let graph = self.graph_of(operand);
        self.n_copied += graph.terms().len();
        let number = self.primitives.len() as u32;
        self.primitives.push(Primitive::new(graph, level));
        self.literals.insert(key, (number, falls));
        if let Some(level) = level {
            self.levels.insert(level, number);
        }
        CsgNode::Primitive(number)
    }

    /// A term and the operations above it up to their sign, and whether that sign is a minus. Rounding is
    /// symmetric, so `k − a` is the negative of `a − k` to the last bit, whatever follows.
    fn chain_key(&mut self, base: u32, ops: &[MonotoneOp]) -> (ChainKey, bool) {
        let mut falls = false;
        let mut plain = Vec::with_capacity(ops.len());
        for op in ops {
            let sign = if falls { -1.0 } else { 1.0 };
            plain.extend(match *op {
                MonotoneOp::Neg => None,
                MonotoneOp::Add(k) => Some(MonotoneOp::Add(sign * k)),
                MonotoneOp::From(k) => Some(MonotoneOp::Add(-sign * k)),
                MonotoneOp::Mul(k) => Some(MonotoneOp::Mul(k.abs())),
                MonotoneOp::Div(k) => Some(MonotoneOp::Div(k.abs())),
            });
            falls ^= op.falls();
        }
        // From the outermost operation on, since a chain grows at its inner end.
        let chain = plain.into_iter().rev().fold(NOTHING, |next, op| self.push(op, next));
        ((base, chain), falls)
    }

    /// The term below all operations with constants, and these operations from it upward.
    fn chain(&self, operand: CsgOperand) -> (u32, Vec<MonotoneOp>) {
        let (mut base, mut ops) = (unmarked(self.terms, operand.term), Vec::new());
        while let Some((op, term)) = self.below(base) {
            ops.push(op);
            base = unmarked(self.terms, term);
        }
        // Collected from the top down, but a chain runs upward.
        ops.reverse();
        let mut above = operand.above;
        while above != NOTHING {
            let ChainLink { op, next } = self.above[above as usize];
            ops.push(op);
            above = next;
        }
        (base, ops)
    }

    /// Adds the materials of the primitive at `operand`.
    fn add_materials(&mut self, operand: CsgOperand) {
        self.materials.push_literal(self.terms, (operand.term, operand.falls), operand.material);
    }

    /// The operation with a constant at the root of a term, and its operand.
    fn below(&self, term: u32) -> Option<(MonotoneOp, u32)> {
        match (self.negated(term), &self.terms[term as usize]) {
            (Some(negated), _) => Some((MonotoneOp::Neg, negated)),
            (None, Term::Binary(op, a, b)) => self.with_constant(*op, *a, *b),
            _ => None,
        }
    }

    /// The term of which this one is the negative, to the last bit.
    fn negated(&self, term: u32) -> Option<u32> {
        match self.terms[term as usize] {
            Term::Unary(Unary::Neg, a) => Some(a),
            Term::Binary(Binary::Sub, a, b) if b < a => self.mirrored.get(&(b, a)).copied(),
            _ => None,
        }
    }

    /// The terms of a primitive.
    fn graph_of(&self, operand: CsgOperand) -> ExprGraph {
        let mut terms = subgraph_terms(self.terms, operand.term);
        let mut above = operand.above;
        while above != NOTHING {
            let ChainLink { op, next } = self.above[above as usize];
            let last = terms.len() as u32 - 1;
            let (constant, term): (Option<f64>, fn(u32, u32) -> Term) = match op {
                MonotoneOp::Neg => (None, |a, _| Term::Unary(Unary::Neg, a)),
                MonotoneOp::Add(k) => (Some(k), |a, k| Term::Binary(Binary::Add, a, k)),
                MonotoneOp::From(k) => (Some(k), |a, k| Term::Binary(Binary::Sub, k, a)),
                MonotoneOp::Mul(k) => (Some(k), |a, k| Term::Binary(Binary::Mul, a, k)),
                MonotoneOp::Div(k) => (Some(k), |a, k| Term::Binary(Binary::Div, a, k)),
            };
            terms.extend(constant.map(Term::Const));
            // The index of the constant, if there is one.
            let number = terms.len() as u32 - 1;
            terms.push(term(last, number));
            above = next;
        }
        ExprGraph::from_terms(terms)
    }
}

/// Whether every term is defined at every point: none divides by a value that may be 0, takes the root of a
/// value that may be negative, and so on. Leaves are trusted to be defined.
fn is_total(terms: &[Term]) -> bool {
    let mut not_negative = vec![false; terms.len()];
    for (k, term) in terms.iter().enumerate() {
        let of = |part: &u32| not_negative[*part as usize];
        let constant = |part: &u32| match terms[*part as usize] {
            Term::Const(value) => Some(value),
            _ => None,
        };
        let has_value = match term {
            Term::Const(value) => value.is_finite(),
            Term::Axis(_) | Term::Leaf(..) => true,
            Term::Unary(Unary::Sqrt, a) => of(a),
            Term::Unary(Unary::Recip | Unary::Tan | Unary::Asin | Unary::Acos | Unary::Ln, _) => false,
            Term::Unary(..) => true,
            Term::Binary(Binary::Div | Binary::Mod, _, b) => constant(b).is_some_and(|k| k != 0.0),
            Term::Binary(Binary::Atan2, ..) => false,
            Term::Binary(..) => true,
        };
        if !has_value {
            return false;
        }
        not_negative[k] = match term {
            Term::Const(value) => *value >= 0.0,
            Term::Unary(Unary::Square | Unary::Abs | Unary::Exp | Unary::Sqrt | Unary::Not, _) => true,
            Term::Binary(Binary::Add | Binary::Mul | Binary::Min, a, b) => of(a) && of(b),
            Term::Binary(Binary::Max, a, b) => of(a) || of(b),
            Term::Binary(Binary::Div, a, b) => of(a) && of(b),
            Term::Binary(Binary::Mod, ..) => true,
            _ => false,
        };
    }
    true
}

#[cfg(test)]
mod tests;
