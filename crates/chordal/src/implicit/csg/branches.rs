//! `ContinuousBranches`: a primitive with steps as several functions without, one for each combination of
//! step values.
//!
//! In a box in which it jumps once, `round(x)` has two values, k and k + 1, and each makes a function without
//! a step. The primitive equals one or the other at each point, so both intervals together contain all of its
//! values. They are far tighter than one interval for all numbers from k to k + 1: in a repeated shape,
//! `x − round(x)` would be any number from −1/2 to 1/2. If each step has one value throughout the box, the
//! primitive is one of these functions, with its gradient.
use crate::implicit::graph::{parts, reachable};
use crate::implicit::op::{Binary, Unary};
use crate::implicit::{ExprGraph, LeafError, Tape, Term};
use crate::math::{Box3, Interval};
use std::collections::HashMap;

/// The most functions that are evaluated for a box instead of the primitive. Chosen: a corner where steps
/// along all three axes meet.
const MOST: usize = 8;
/// The most terms in all functions of a primitive; beyond, boxes are evaluated with the primitive itself.
/// Defined: some hundred megabytes.
const MOST_TERMS: usize = 1 << 20;

/// Integers below this are exact as floats.
const LEAST_INEXACT: f64 = (1_u64 << 53) as f64;

/// A primitive with steps.
#[derive(Clone, Debug)]
pub(super) struct ContinuousBranches {
    terms: Vec<Term>,
    steps: Vec<StepTerm>,
    /// The functions built so far.
    pub functions: Vec<Tape>,
    /// By the values of the steps.
    numbers: HashMap<Vec<i64>, u32>, // No order depends on it.
}

/// A term with steps, and the function that it rounds.
#[derive(Clone, Debug)]
struct StepTerm {
    term: u32,
    rounded: Tape,
    how: RoundingMode,
}

#[derive(Clone, Copy, Debug)]
enum RoundingMode {
    Down,
    Up,
    Nearest,
    /// Down; the term is the remainder of the operand after division by this number.
    Remainder(f64),
}

impl ContinuousBranches {
    /// None if there are no steps, or if some are not roundings or remainders or depend on each other.
    pub fn from_terms(terms: &[Term]) -> Option<Self> {
        let mut steps = Vec::new();
        let mut depends = vec![false; terms.len()];
        for (k, term) in terms.iter().enumerate() {
            let how = match term {
                Term::Unary(Unary::Floor, _) => Some(RoundingMode::Down),
                Term::Unary(Unary::Ceil, _) => Some(RoundingMode::Up),
                Term::Unary(Unary::Round, _) => Some(RoundingMode::Nearest),
                Term::Binary(Binary::Mod, _, b) => match terms[*b as usize] {
                    Term::Const(period) if period > 0.0 && period.is_finite() => {
                        Some(RoundingMode::Remainder(period))
                    }
                    _ => return None,
                },
                Term::Unary(Unary::Not, _) | Term::Binary(Binary::Compare | Binary::And | Binary::Or, ..) => {
                    return None;
                }
                _ => None,
            };
            let is_above = parts(term).any(|part| depends[part as usize]);
            depends[k] = is_above || how.is_some();
            if let (Some(how), Some(operand)) = (how, parts(term).next()) {
                if is_above {
                    return None;
                }
                steps.push(StepTerm { term: k as u32, rounded: how.tape(terms, operand), how });
            }
        }
        let terms = terms.to_vec();
        let numbers = HashMap::new(); // No order depends on it.
        (!steps.is_empty()).then_some(Self { terms, steps, functions: Vec::new(), numbers })
    }

    /// For each box the indices of functions; at each point of the box the primitive equals one of them. None
    /// if there are too many.
    pub fn over(&mut self, boxes: &[Box3]) -> Result<Vec<Option<Vec<u32>>>, LeafError> {
        let mut values: Vec<Vec<[i64; 2]>> = Vec::with_capacity(self.steps.len());
        for step in &self.steps {
            let mut ranges = vec![Interval::UNKNOWN; boxes.len()];
            step.rounded.over(boxes, &mut ranges)?;
            values.push(ranges.iter().map(|range| step.how.values(*range)).collect());
        }
        let of_box = |at: usize| {
            let ends: Vec<[i64; 2]> = values.iter().map(|of_step| of_step[at]).collect();
            self.functions_of(&ends)
        };
        Ok((0..boxes.len()).map(of_box).collect())
    }

    fn functions_of(&mut self, ends: &[[i64; 2]]) -> Option<Vec<u32>> {
        let count = ends.iter().map(|[a, b]| b.saturating_sub(*a).saturating_add(1) as usize);
        if count.fold(1, usize::saturating_mul) > MOST {
            return None;
        }
        let mut functions = Vec::new();
        let mut at: Vec<i64> = ends.iter().map(|[a, _]| *a).collect();
        loop {
            functions.push(self.function(&at)?);
            // The next combination of values.
            let Some(step) = (0..at.len()).find(|k| at[*k] < ends[*k][1]) else { return Some(functions) };
            at[step] += 1;
            (0..step).for_each(|k| at[k] = ends[k][0]);
        }
    }

    fn function(&mut self, at: &[i64]) -> Option<u32> {
        if let Some(number) = self.numbers.get(at) {
            return Some(*number);
        }
        if (self.functions.len() + 1) * self.terms.len() > MOST_TERMS {
            return None;
        }
        let number = self.functions.len() as u32;
        self.functions.push(Tape::from_graph(self.graph(at)));
        self.numbers.insert(at.to_vec(), number);
        Some(number)
    }

    /// The terms with these values of the steps. Only exact operations are carried out, so that intervals
    /// contain the primitive's values.
    fn graph(&self, at: &[i64]) -> ExprGraph {
        let mut terms: Vec<Term> = Vec::with_capacity(self.terms.len());
        let mut new_index: Vec<u32> = Vec::with_capacity(self.terms.len());
        let mut steps = self.steps.iter().zip(at).peekable();
        for (k, term) in self.terms.iter().enumerate() {
            let map_term = |old: &u32| new_index[*old as usize];
            let step = steps.next_if(|(step, _)| step.term == k as u32);
            let copy = match (step.map(|(step, value)| (step.how, *value as f64)), term) {
                (Some((RoundingMode::Remainder(period), times)), Term::Binary(_, a, _)) => {
                    // The product stays a term, so that intervals round it outwards.
                    let first = terms.len() as u32;
                    terms.extend([Term::Const(times), Term::Const(period)]);
                    terms.push(Term::Binary(Binary::Mul, first, first + 1));
                    Term::Binary(Binary::Sub, map_term(a), first + 2)
                }
                (Some((_, value)), _) => Term::Const(value),
                (None, Term::Unary(op, a)) => unary(&terms, *op, map_term(a)),
                (None, Term::Binary(op, a, b)) => binary(&terms, *op, map_term(a), map_term(b)),
                (None, Term::Leaf(leaf, at)) => Term::Leaf(leaf.clone(), at.each_ref().map(map_term)),
                (None, Term::Const(_) | Term::Axis(_)) => term.clone(),
            };
            terms.push(copy);
            new_index.push(terms.len() as u32 - 1);
        }
        let root = terms.len() as u32 - 1;
        ExprGraph::from_terms(reachable(terms, root))
    }
}

fn unary(terms: &[Term], op: Unary, a: u32) -> Term {
    match (op, &terms[a as usize]) {
        (Unary::Neg | Unary::Abs, Term::Const(value)) => Term::Const(op.apply(*value)),
        _ => Term::Unary(op, a),
    }
}

fn binary(terms: &[Term], op: Binary, a: u32, b: u32) -> Term {
    match (op, &terms[a as usize], &terms[b as usize]) {
        (Binary::Min | Binary::Max, Term::Const(x), Term::Const(y)) => Term::Const(op.apply(*x, *y)),
        // Small integers: exact.
        (Binary::Add | Binary::Sub, Term::Const(x), Term::Const(y)) if is_small(*x) && is_small(*y) => {
            Term::Const(op.apply(*x, *y))
        }
        _ => Term::Binary(op, a, b),
    }
}

fn is_small(x: f64) -> bool {
    x.fract() == 0.0 && x.abs() < f64::from(1_u32 << 31)
}

impl RoundingMode {
    /// The function that is rounded to an integer.
    fn tape(self, terms: &[Term], operand: u32) -> Tape {
        let mut terms = terms[..=operand as usize].to_vec();
        let mut root = operand;
        if let Self::Remainder(period) = self {
            // The list ends with the operand, so these are the next two terms.
            terms.extend([Term::Const(period), Term::Binary(Binary::Div, operand, operand + 1)]);
            root = operand + 2;
        }
        Tape::from_graph(ExprGraph::from_terms(reachable(terms, root)))
    }

    /// The first and last integer over an interval; all integers if the interval has no known values.
    fn values(self, range: Interval) -> [i64; 2] {
        if !range.is_defined() {
            return [i64::MIN, i64::MAX];
        }
        let rounded = |x: f64| match self {
            Self::Down | Self::Remainder(_) => x.floor(),
            Self::Up => x.ceil(),
            Self::Nearest => x.round(),
        };
        // Rounding is monotone, so the ends suffice.
        let ends = [range.lo(), range.hi()].map(rounded);
        let is_exact = ends.iter().all(|x| x.abs() < LEAST_INEXACT);
        if is_exact { ends.map(|x| x as i64) } else { [i64::MIN, i64::MAX] }
    }
}
