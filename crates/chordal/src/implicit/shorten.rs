//! Fewer terms for a region: where one branch of a minimum, smooth or not, or maximum always wins, the other is left out.
use super::graph::{Graph, Term};
use super::leaf::LeafError;
use super::number::Number;
use super::op::Binary;
use super::sources::{Source, boxed};
use crate::math::{Box3, Interval, sub_down};

/// What is known of a term in the region.
#[derive(Clone, Copy, PartialEq)]
enum Choice {
    /// It is needed as it is.
    Itself,
    First,
    Second,
}

impl Graph {
    /// The range of the value in a box, and the terms that are enough there, if they are at most seven eighths.
    pub(super) fn shortened(&self, bounds: &Box3) -> Result<(Interval, Option<Self>), LeafError> {
        let terms = self.terms();
        let mut ranges: Vec<Interval> = Vec::with_capacity(terms.len());
        let mut choices = vec![Choice::Itself; terms.len()];
        let mut chosen = false;
        for (k, term) in terms.iter().enumerate() {
            let of = |number: &u32| ranges[*number as usize];
            let range = match term {
                Term::Const(value) => Interval::constant(*value),
                Term::Axis(axis) => boxed(bounds, usize::from(*axis)),
                Term::Unary(op, a) => Interval::unary(*op, of(a)),
                Term::Binary(op, a, b) => {
                    choices[k] = choice(*op, of(a), of(b));
                    chosen |= choices[k] != Choice::Itself;
                    Interval::binary(*op, of(a), of(b))
                }
                Term::Leaf(leaf, at) => {
                    let range = Interval::of_leaf(&**leaf, &[at.each_ref().map(of)])?;
                    range.first().copied().unwrap_or(Interval::UNKNOWN)
                }
            };
            ranges.push(range);
        }
        let value = ranges.last().copied().unwrap_or(Interval::UNKNOWN);
        Ok((value, if chosen { self.without_losers(&choices) } else { None }))
    }

    /// The terms that are still needed. One pass backward finds them, one forward copies them.
    fn without_losers(&self, choices: &[Choice]) -> Option<Self> {
        let terms = self.terms();
        let mut needed = vec![false; terms.len()];
        let mut n_kept = 0;
        if let Some(root) = needed.last_mut() {
            *root = true;
        }
        for (k, term) in terms.iter().enumerate().rev() {
            if !needed[k] {
                continue;
            }
            n_kept += usize::from(choices[k] == Choice::Itself);
            match (term, choices[k]) {
                (Term::Binary(_, a, _), Choice::First) | (Term::Unary(_, a), _) => needed[*a as usize] = true,
                (Term::Binary(_, _, b), Choice::Second) => needed[*b as usize] = true,
                (Term::Binary(_, a, b), Choice::Itself) => {
                    needed[*a as usize] = true;
                    needed[*b as usize] = true;
                }
                (Term::Leaf(_, at), _) => at.iter().for_each(|part| needed[*part as usize] = true),
                (Term::Const(_) | Term::Axis(_), _) => {}
            }
        }
        if n_kept > terms.len() - terms.len() / 8 {
            return None;
        }
        let mut number = vec![0_u32; terms.len()];
        let mut kept = Vec::with_capacity(n_kept);
        for (k, term) in terms.iter().enumerate().filter(|(k, _)| needed[*k]) {
            let new = |old: &u32| number[*old as usize];
            let copy = match (term, choices[k]) {
                (Term::Binary(_, a, _), Choice::First) => {
                    number[k] = new(a);
                    continue;
                }
                (Term::Binary(_, _, b), Choice::Second) => {
                    number[k] = new(b);
                    continue;
                }
                (Term::Const(value), _) => Term::Const(*value),
                (Term::Axis(axis), _) => Term::Axis(*axis),
                (Term::Unary(op, a), _) => Term::Unary(*op, new(a)),
                (Term::Binary(op, a, b), Choice::Itself) => Term::Binary(*op, new(a), new(b)),
                (Term::Leaf(leaf, at), _) => Term::Leaf(leaf.clone(), at.each_ref().map(new)),
            };
            number[k] = kept.len() as u32;
            kept.push(copy);
        }
        // The root may be another term's value now, which then has to be last.
        let root = number.last().copied()? as usize;
        kept.truncate(root + 1);
        Some(Self::of_terms(kept))
    }
}

/// Which operand alone decides, if both have a value everywhere.
fn choice(op: Binary, a: Interval, b: Interval) -> Choice {
    if !(a.is_defined() && b.is_defined()) {
        return Choice::Itself;
    }
    let (is_zero, never) = (a.lo() == 0.0 && a.hi() == 0.0, a.lo() > 0.0 || a.hi() < 0.0);
    match op {
        Binary::Min if a.hi() < b.lo() => Choice::First,
        Binary::Min if b.hi() < a.lo() => Choice::Second,
        Binary::Max if a.lo() > b.hi() => Choice::First,
        Binary::Max if b.lo() > a.hi() => Choice::Second,
        // Exact numbers between the ends are 1 apart as well, so that nothing is taken off.
        Binary::SmoothMin if sub_down(b.lo(), a.hi()) >= 1.0 => Choice::First,
        Binary::SmoothMin if sub_down(a.lo(), b.hi()) >= 1.0 => Choice::Second,
        Binary::And if never => Choice::Second,
        Binary::And if is_zero => Choice::First,
        Binary::Or if never => Choice::First,
        Binary::Or if is_zero => Choice::Second,
        _ => Choice::Itself,
    }
}
