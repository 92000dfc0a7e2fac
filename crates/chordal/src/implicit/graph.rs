//! `ExprGraph`: an expression as a list of distinct terms, whose operands are earlier terms.
use super::expr::{Expr, ExprKind};
use super::leaf::Leaf;
use super::material::MaterialMark;
use super::op::{Binary, Unary};
use std::collections::HashMap;
use std::sync::Arc;

/// One term. Operands are indices of earlier terms in the list.
#[derive(Clone, Debug)]
pub enum Term {
    /// A number.
    Const(f64),
    /// x, y or z.
    Axis(u8),
    /// An operation on a term.
    Unary(Unary, u32),
    /// An operation on two terms.
    Binary(Binary, u32, u32),
    /// The value of a leaf at the point given by three terms.
    Leaf(Arc<dyn Leaf>, [u32; 3]),
}

/// The distinct terms of an expression in evaluation order; the last is its value.
///
/// Equal terms are merged (common subexpressions), whether shared or written twice. Operations on constants
/// are evaluated in f64; the rounded result defines the true shape, like a number in a text. Other
/// simplifications change no value where the expression is defined: `a + 0`, `1 · a`, `−(−a)`, `| |a| |`,
/// `min(a, a)`; and `a · a` becomes `a²`, whose interval is known to be positive. The logarithm of a sum of
/// exponentials becomes [`Binary::LogSumExp`], the same number up to rounding: its exponentials do not
/// overflow, and the interval of its slope is that of a mean.
#[derive(Clone, Debug)]
pub struct ExprGraph {
    terms: Vec<Term>,
}

impl ExprGraph {
    /// The terms of an expression. Time and memory grow with the distinct subexpressions, not with the number
    /// of their uses.
    #[must_use]
    pub fn from_expr(expr: &Expr) -> Self {
        let mut builder = GraphBuilder::default();
        let root = builder.lower(expr);
        Self { terms: reachable(builder.terms, root) }
    }

    /// The same, with marks of materials as terms: each is a leaf with the value of its operand.
    pub(super) fn with_materials(expr: &Expr) -> Self {
        let mut builder = GraphBuilder { keeps_marks: true, ..GraphBuilder::default() };
        let root = builder.lower(expr);
        Self { terms: reachable(builder.terms, root) }
    }

    /// A graph from its terms, the last of which is the value.
    pub(super) fn from_terms(terms: Vec<Term>) -> Self {
        Self { terms }
    }

    /// The terms; the last one is the value.
    #[must_use]
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// Which of x, y and z the value depends on.
    #[must_use]
    pub fn axes(&self) -> [bool; 3] {
        let uses = |k: u8| self.terms.iter().any(|term| matches!(term, Term::Axis(a) if *a == k));
        [0, 1, 2].map(uses)
    }
}

/// The most exponentials in a sum whose logarithm becomes one term. Chosen: learned fields have some hundred.
const MOST_EXPONENTIALS: usize = 1024;

/// The key that equal terms share. A leaf, by its address, equals only itself.
#[derive(PartialEq, Eq, Hash)]
enum TermKey {
    Const(u64),
    Axis(u8),
    Unary(Unary, u32),
    Binary(Binary, u32, u32),
    Leaf(usize, [u32; 3]),
}

/// A pending step: visit an expression in a frame (the terms that replace x, y and z), or finish it after its
/// operands.
enum LoweringTask<'a> {
    Visit(&'a Expr, u32),
    Finish(&'a Expr, u32),
    /// Visit the child of an `At`, whose frame is known after its three terms.
    Enter(&'a Expr, u32),
    /// Give the `At` the term of its child in the new frame.
    Leave(&'a Expr, u32),
}

#[derive(Default)]
struct GraphBuilder {
    /// Whether marks of materials become terms; otherwise their operands replace them.
    keeps_marks: bool,
    terms: Vec<Term>,
    // The maps are only looked up, never iterated.
    numbers: HashMap<TermKey, u32>,        // No order depends on it.
    lowered: HashMap<(usize, u32), u32>,   // No order depends on it.
    frame_numbers: HashMap<[u32; 3], u32>, // No order depends on it.
    frames: Vec<[u32; 3]>,
}

impl GraphBuilder {
    fn lower(&mut self, expr: &Expr) -> u32 {
        let axes = [0, 1, 2].map(|k| self.term(TermKey::Axis(k), || Term::Axis(k)));
        let world = self.frame(axes);
        let mut tasks = vec![LoweringTask::Visit(expr, world)];
        while let Some(task) = tasks.pop() {
            match task {
                LoweringTask::Visit(expr, frame) => {
                    if !self.lowered.contains_key(&(expr.address(), frame)) {
                        self.visit(expr, frame, &mut tasks);
                    }
                }
                LoweringTask::Finish(expr, frame) => {
                    let number = self.finish(expr, frame);
                    self.lowered.insert((expr.address(), frame), number);
                }
                LoweringTask::Enter(expr, frame) => {
                    let ExprKind::At(child, at) = expr.kind() else { continue };
                    let inner = self.inner_frame(at, frame);
                    tasks.push(LoweringTask::Leave(expr, frame));
                    tasks.push(LoweringTask::Visit(child, inner));
                }
                LoweringTask::Leave(expr, frame) => {
                    let ExprKind::At(child, at) = expr.kind() else { continue };
                    // Frames are numbered once: this is the one that the child was lowered in.
                    let inner = self.inner_frame(at, frame);
                    let number = self.lowered[&(child.address(), inner)];
                    self.lowered.insert((expr.address(), frame), number);
                }
            }
        }
        self.lowered[&(expr.address(), world)]
    }

    fn visit<'a>(&mut self, expr: &'a Expr, frame: u32, tasks: &mut Vec<LoweringTask<'a>>) {
        tasks.push(if matches!(expr.kind(), ExprKind::At(..)) {
            LoweringTask::Enter(expr, frame)
        } else {
            LoweringTask::Finish(expr, frame)
        });
        match expr.kind() {
            ExprKind::Const(_) | ExprKind::Axis(_) => {}
            ExprKind::Unary(_, a) => tasks.push(LoweringTask::Visit(a, frame)),
            // The first operand is on top of the stack, so it is lowered first.
            ExprKind::Binary(_, a, b) => {
                tasks.extend([LoweringTask::Visit(b, frame), LoweringTask::Visit(a, frame)])
            }
            ExprKind::At(_, at) | ExprKind::Leaf(_, at) => {
                tasks.extend(at.iter().rev().map(|a| LoweringTask::Visit(a, frame)));
            }
        }
    }

    fn finish(&mut self, expr: &Expr, frame: u32) -> u32 {
        let lowered = |e: &Expr| self.lowered[&(e.address(), frame)];
        match expr.kind() {
            ExprKind::Const(value) => self.constant(*value),
            ExprKind::Axis(k) => self.frames[frame as usize][usize::from(*k)],
            ExprKind::Unary(op, a) => {
                let a = lowered(a);
                self.unary(*op, a)
            }
            ExprKind::Binary(op, a, b) => {
                let (a, b) = (lowered(a), lowered(b));
                self.binary(*op, a, b)
            }
            ExprKind::At(..) => unreachable!("an At is entered and left"),
            ExprKind::Leaf(leaf, [at, ..])
                if !self.keeps_marks && MaterialMark::from_leaf(leaf).is_some() =>
            {
                lowered(at)
            }
            ExprKind::Leaf(leaf, at) => {
                let at = at.each_ref().map(lowered);
                let address = Arc::as_ptr(leaf).cast::<()>() as usize;
                self.term(TermKey::Leaf(address, at), || Term::Leaf(Arc::clone(leaf), at))
            }
        }
    }

    fn inner_frame(&mut self, at: &[Expr; 3], frame: u32) -> u32 {
        let terms = at.each_ref().map(|a| self.lowered[&(a.address(), frame)]);
        self.frame(terms)
    }

    fn frame(&mut self, terms: [u32; 3]) -> u32 {
        let next = self.frames.len() as u32;
        let number = *self.frame_numbers.entry(terms).or_insert(next);
        if number == next {
            self.frames.push(terms);
        }
        number
    }

    fn term(&mut self, key: TermKey, make: impl FnOnce() -> Term) -> u32 {
        let next = self.terms.len() as u32;
        let number = *self.numbers.entry(key).or_insert(next);
        if number == next {
            self.terms.push(make());
        }
        number
    }

    fn constant(&mut self, value: f64) -> u32 {
        self.term(TermKey::Const(value.to_bits()), || Term::Const(value))
    }

    fn value_of(&self, number: u32) -> Option<f64> {
        if let Term::Const(value) = self.terms[number as usize] { Some(value) } else { None }
    }

    fn unary(&mut self, op: Unary, a: u32) -> u32 {
        if let Some(value) = self.value_of(a) {
            return self.constant(op.apply(value));
        }
        if let (Unary::Ln, Some(log)) = (op, self.log_of(a)) {
            return log;
        }
        match (op, &self.terms[a as usize]) {
            (Unary::Neg, Term::Unary(Unary::Neg, inner)) => *inner,
            (Unary::Abs, Term::Unary(Unary::Abs | Unary::Square | Unary::Sqrt | Unary::Exp, _)) => a,
            (Unary::Abs | Unary::Square, Term::Unary(Unary::Neg | Unary::Abs, inner)) => {
                let inner = *inner;
                self.unary(op, inner)
            }
            _ => self.term(TermKey::Unary(op, a), || Term::Unary(op, a)),
        }
    }

    /// The logarithm of `sum`, if that is one of exponentials.
    fn log_of(&mut self, sum: u32) -> Option<u32> {
        let mut open = vec![sum];
        let mut logs = Vec::new();
        while let Some(part) = open.pop() {
            match &self.terms[part as usize] {
                Term::Unary(Unary::Exp, log) => logs.push(*log),
                // The left operand is on top, so that logarithms come in the order of the sum.
                Term::Binary(Binary::Add, a, b) => open.extend([*b, *a]),
                _ => return None,
            }
            // Shared operands can double the number of terms at each level of the sum.
            if logs.len() + open.len() > MOST_EXPONENTIALS {
                return None;
            }
        }
        logs.into_iter().reduce(|sum, log| self.binary(Binary::LogSumExp, sum, log))
    }

    fn binary(&mut self, op: Binary, a: u32, b: u32) -> u32 {
        let (left, right) = (self.value_of(a), self.value_of(b));
        if let (Some(left), Some(right)) = (left, right) {
            return self.constant(op.apply(left, right));
        }
        match op {
            Binary::Add if left == Some(0.0) => return b,
            Binary::Add | Binary::Sub if right == Some(0.0) => return a,
            Binary::Mul if left == Some(1.0) => return b,
            Binary::Mul | Binary::Div if right == Some(1.0) => return a,
            Binary::Min | Binary::Max if a == b => return a,
            Binary::Mul if a == b => return self.unary(Unary::Square, a),
            _ => {}
        }
        // Sums and products are commutative. Minima and maxima are not, if an operand is undefined.
        let either = matches!(op, Binary::Add | Binary::Mul);
        let (a, b) = if either && b < a { (b, a) } else { (a, b) };
        self.term(TermKey::Binary(op, a, b), || Term::Binary(op, a, b))
    }
}

/// The terms that the root depends on, with the root last.
pub(super) fn reachable(terms: Vec<Term>, root: u32) -> Vec<Term> {
    let mut used = vec![false; terms.len()];
    used[root as usize] = true;
    for k in (0..terms.len()).rev().filter(|k| *k <= root as usize) {
        if used[k] {
            parts(&terms[k]).for_each(|part| used[part as usize] = true);
        }
    }
    let mut number = vec![0_u32; terms.len()];
    let mut copies = Vec::new();
    for (k, term) in terms.into_iter().enumerate().filter(|(k, _)| used[*k]) {
        number[k] = copies.len() as u32;
        let new = |old: u32| number[old as usize];
        copies.push(match term {
            Term::Const(_) | Term::Axis(_) => term,
            Term::Unary(op, a) => Term::Unary(op, new(a)),
            Term::Binary(op, a, b) => Term::Binary(op, new(a), new(b)),
            Term::Leaf(leaf, at) => Term::Leaf(leaf, at.map(new)),
        });
    }
    copies
}

pub(super) fn parts(term: &Term) -> impl Iterator<Item = u32> {
    let (parts, n) = match term {
        Term::Const(_) | Term::Axis(_) => ([0; 3], 0),
        Term::Unary(_, a) => ([*a, 0, 0], 1),
        Term::Binary(_, a, b) => ([*a, *b, 0], 2),
        Term::Leaf(_, at) => (*at, 3),
    };
    parts.into_iter().take(n)
}
