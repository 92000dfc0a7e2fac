//! Tape pruning: if one operand of a minimum or maximum always wins in a region, the other is left out.
//!
//! A first pass, from the leaves to the root, computes the interval of every term. A second one, from the
//! root, computes for every term the values above and below which it does not affect the result. So in a
//! chain of blends, each ball is compared with the nearest one of all, not only with its neighbours in the
//! chain. Suppose that values of `m = smin(a, b)` of `T` and above do not affect the result. Then `a` does
//! not affect it if it is at least `T + 5/4`: where `b < T + 1/4`, `a` is 1 above `b`, so that `m = b`;
//! elsewhere `m ≥ min(a, b) − 1/4 ≥ T` with `a`, and also without it, when `m` is `b`. And `a` has no effect
//! from `max b + 1` on.
use super::graph::{ExprGraph, Term};
use super::inputs::{LeafScalar, box_side};
use super::leaf::LeafError;
use super::number::Scalar;
use super::op::{Binary, Unary};
use super::program::box_distance_terms;
use crate::math::{
    Box3, Interval, add_up, div_down, div_up, greater, lesser, mul_down, mul_up, sub_down, sub_up,
};

/// The replacement of a term in the region.
#[derive(Clone, Copy, PartialEq)]
enum OperandChoice {
    /// The term is needed unchanged.
    Itself,
    First,
    Second,
}

impl ExprGraph {
    /// The interval of the value in a box, and the terms that suffice there, if they are at most seven
    /// eighths of all.
    pub(super) fn prune(&self, bounds: &Box3) -> Result<(Interval, Option<Self>), LeafError> {
        let terms = self.terms();
        let mut ranges: Vec<Interval> = Vec::with_capacity(terms.len());
        for term in terms {
            let range_of = |number: &u32| ranges[*number as usize];
            let range = match term {
                Term::Const(value) => Interval::constant(*value),
                Term::Axis(axis) => box_side(bounds, usize::from(*axis)),
                Term::Unary(op, a) => Interval::unary(*op, range_of(a)),
                Term::Binary(op, a, b) => Interval::binary(*op, range_of(a), range_of(b)),
                Term::Leaf(leaf, at) => {
                    let range = Interval::from_leaf(&**leaf, &[at.each_ref().map(range_of)])?;
                    range.first().copied().unwrap_or(Interval::UNKNOWN)
                }
            };
            ranges.push(range);
        }
        let value = ranges.last().copied().unwrap_or(Interval::UNKNOWN);
        let choices = choices(terms, &ranges);
        let chosen = choices.iter().any(|choice| *choice != OperandChoice::Itself);
        Ok((value, if chosen { self.copy_needed(&choices) } else { None }))
    }

    /// The needed terms: one pass backward finds them, one forward copies them.
    fn copy_needed(&self, choices: &[OperandChoice]) -> Option<Self> {
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
            n_kept += usize::from(choices[k] == OperandChoice::Itself);
            match (term, choices[k]) {
                (Term::Binary(_, a, _), OperandChoice::First) | (Term::Unary(_, a), _) => {
                    needed[*a as usize] = true
                }
                (Term::Binary(_, _, b), OperandChoice::Second) => needed[*b as usize] = true,
                (Term::Binary(_, a, b), OperandChoice::Itself) => {
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
        let mut copies = Vec::with_capacity(n_kept);
        for (k, term) in terms.iter().enumerate().filter(|(k, _)| needed[*k]) {
            let new = |old: &u32| number[*old as usize];
            let copy = match (term, choices[k]) {
                // A term that is replaced gets the number of what replaces it.
                (Term::Binary(_, a, _), OperandChoice::First) => {
                    number[k] = new(a);
                    continue;
                }
                (Term::Binary(_, _, b), OperandChoice::Second) => {
                    number[k] = new(b);
                    continue;
                }
                (Term::Const(value), _) => Term::Const(*value),
                (Term::Axis(axis), _) => Term::Axis(*axis),
                (Term::Unary(op, a), _) => Term::Unary(*op, new(a)),
                (Term::Binary(op, a, b), OperandChoice::Itself) => Term::Binary(*op, new(a), new(b)),
                (Term::Leaf(leaf, at), _) => Term::Leaf(leaf.clone(), at.each_ref().map(new)),
            };
            number[k] = copies.len() as u32;
            copies.push(copy);
        }
        // The root may have been replaced by an earlier term, which then has to be last.
        let root = number.last().copied()? as usize;
        copies.truncate(root + 1);
        Some(Self::from_terms(copies))
    }
}

/// Values of a term that do not affect the result: those from `above` on, and those up to `below`.
#[derive(Clone, Copy)]
struct PruningBounds {
    above: f64,
    below: f64,
}

impl PruningBounds {
    /// Every value has an effect.
    const NONE: Self = Self { above: f64::INFINITY, below: f64::NEG_INFINITY };
    /// No use has been visited yet.
    const UNUSED: Self = Self { above: f64::NEG_INFINITY, below: f64::INFINITY };

    /// The values without effect in either of two uses.
    fn both(self, other: Self) -> Self {
        Self { above: greater(self.above, other.above), below: lesser(self.below, other.below) }
    }

    fn mirrored(self) -> Self {
        Self { above: -self.below, below: -self.above }
    }

    /// The same, with all values from `above` on without effect.
    fn from(self, above: f64) -> Self {
        Self { above: lesser(above, self.above), ..self }
    }

    /// Whether the operand with this interval can be left out: of a minimum, one above the bound; of a
    /// maximum, one below it.
    fn leaves_out(self, op: Binary, range: Interval) -> bool {
        match op {
            Binary::Min | Binary::SmoothMin | Binary::RoundMin => range.lo() >= self.above,
            Binary::Max => range.hi() <= self.below,
            _ => false,
        }
    }
}

/// For each term the operand that suffices, from the root down.
fn choices(terms: &[Term], ranges: &[Interval]) -> Vec<OperandChoice> {
    let mut choices = vec![OperandChoice::Itself; terms.len()];
    // Terms that run as one step are kept together: its slopes are tighter than those of single terms.
    let mut is_within_step = vec![false; terms.len()];
    for term in terms {
        box_distance_terms(terms, term).into_iter().for_each(|part| is_within_step[part as usize] = true);
    }
    let mut silences = vec![PruningBounds::UNUSED; terms.len()];
    if let Some(root) = silences.last_mut() {
        *root = PruningBounds::NONE;
    }
    // All uses of a term come after it, so its bounds are final when it is reached.
    for (k, term) in terms.iter().enumerate().rev() {
        let silence = silences[k];
        let mut use_of = |part: &u32, silence: PruningBounds| {
            let bounds = &mut silences[*part as usize];
            *bounds = bounds.both(silence);
        };
        let constant = |part: &u32| match terms[*part as usize] {
            Term::Const(value) if value.is_finite() => Some(value),
            _ => None,
        };
        match term {
            Term::Const(_) | Term::Axis(_) => {}
            Term::Unary(Unary::Neg, a) => use_of(a, silence.mirrored()),
            Term::Unary(_, a) => use_of(a, PruningBounds::NONE),
            Term::Leaf(_, at) => at.iter().for_each(|a| use_of(a, PruningBounds::NONE)),
            Term::Binary(op, a, b) => {
                let ranges_ab = [ranges[*a as usize], ranges[*b as usize]];
                let [for_a, for_b] = operand_silences(*op, silence, ranges_ab, [constant(a), constant(b)]);
                let operand = choice(*op, ranges_ab, [for_a, for_b]);
                choices[k] = if is_within_step[k] { OperandChoice::Itself } else { operand };
                match choices[k] {
                    OperandChoice::Itself => {
                        use_of(a, for_a);
                        use_of(b, for_b);
                    }
                    // The node is replaced by its operand.
                    OperandChoice::First => use_of(a, silence),
                    OperandChoice::Second => use_of(b, silence),
                }
            }
        }
    }
    choices
}

/// The values of the operands that have no effect, from those of the result that have none.
fn operand_silences(
    op: Binary,
    silence: PruningBounds,
    [a, b]: [Interval; 2],
    constants: [Option<f64>; 2],
) -> [PruningBounds; 2] {
    if !(a.is_defined() && b.is_defined()) {
        return [PruningBounds::NONE; 2];
    }
    let PruningBounds { above, below } = silence;
    match (op, constants) {
        // Strictly beyond: of equal numbers the second is taken, which may be the other zero.
        (Binary::Min, _) => [b, a].map(|other| silence.from(other.hi().next_up())),
        // max(a, b) = −min(−a, −b).
        (Binary::Max, _) => [b, a].map(|other| silence.mirrored().from((-other.lo()).next_up()).mirrored()),
        // The result is at most the minimum, so values without effect below stay without effect.
        (Binary::SmoothMin | Binary::RoundMin, _) => [b, a]
            .map(|other| PruningBounds { above: add_up(above, 1.25), below }.from(add_up(other.hi(), 1.0))),
        (Binary::Add, [None, Some(k)]) => [shifted(silence, k), PruningBounds::NONE],
        (Binary::Add, [Some(k), None]) => [PruningBounds::NONE, shifted(silence, k)],
        (Binary::Sub, [None, Some(k)]) => [shifted(silence, -k), PruningBounds::NONE],
        (Binary::Sub, [Some(k), None]) => [PruningBounds::NONE, shifted(silence.mirrored(), -k)],
        (Binary::Mul, [None, Some(k)]) if k > 0.0 => [scaled(silence, k), PruningBounds::NONE],
        (Binary::Mul, [Some(k), None]) if k > 0.0 => [PruningBounds::NONE, scaled(silence, k)],
        (Binary::Div, [None, Some(k)]) if k > 0.0 => {
            [PruningBounds { above: mul_up(above, k), below: mul_down(below, k) }, PruningBounds::NONE]
        }
        _ => [PruningBounds::NONE; 2],
    }
}

/// The bounds of `a` from those of `a + k`; one step outward covers the rounding of the sum too.
fn shifted(silence: PruningBounds, k: f64) -> PruningBounds {
    PruningBounds { above: sub_up(silence.above, k).next_up(), below: sub_down(silence.below, k).next_down() }
}

/// The bounds of `a` from those of `k · a`.
fn scaled(silence: PruningBounds, k: f64) -> PruningBounds {
    PruningBounds { above: div_up(silence.above, k).next_up(), below: div_down(silence.below, k).next_down() }
}

/// The operand that alone decides, if both are defined everywhere.
fn choice(op: Binary, [a, b]: [Interval; 2], [for_a, for_b]: [PruningBounds; 2]) -> OperandChoice {
    if !(a.is_defined() && b.is_defined()) {
        return OperandChoice::Itself;
    }
    let (is_zero, never) = (a.lo() == 0.0 && a.hi() == 0.0, a.lo() > 0.0 || a.hi() < 0.0);
    match op {
        // One of them stays if neither has an effect.
        _ if for_b.leaves_out(op, b) => OperandChoice::First,
        _ if for_a.leaves_out(op, a) => OperandChoice::Second,
        Binary::And if never => OperandChoice::Second,
        Binary::And if is_zero => OperandChoice::First,
        Binary::Or if never => OperandChoice::First,
        Binary::Or if is_zero => OperandChoice::Second,
        _ => OperandChoice::Itself,
    }
}

#[cfg(test)]
mod tests {
    use crate::implicit::{Dual, Expr, Tape};
    use crate::math::Box3;
    use chordal_testkit::Random;

    fn ball(random: &mut Random) -> Expr {
        let ([x, y, z], [a, b, c]) = (Expr::axes(), random.point());
        ((x - a).square() + (y - b).square() + (z - c).square()).sqrt() - 0.1
    }

    /// Balls in a chain of unions, blends, intersections with complements, offsets and scales.
    fn chain(random: &mut Random, n: usize, blends_only: bool) -> Expr {
        let mut chain = ball(random);
        for _ in 0..n {
            let ball = ball(random);
            chain = match if blends_only { 0.0 } else { 8.0 * random.unit() } {
                0.0..3.0 => chain.smooth_min(&ball, 0.05),
                3.0..4.0 => -((-chain).smooth_min(&ball, 0.05)),
                4.0..5.0 => chain.min(&ball),
                5.0..6.0 => chain.max(&-ball),
                6.0..7.0 => Expr::constant(0.02) - (ball.max(&(chain * -1.25)) / 1.25),
                _ => (chain + 0.3).min(&(ball + 0.3)) - 0.3,
            };
        }
        chain
    }

    /// Values and gradients of the pruned tape are those of the full tape, bit for bit, everywhere in the
    /// box.
    fn same_in(tape: &Tape, bounds: &Box3, random: &mut Random) -> Option<usize> {
        let shorter = tape.prune(bounds).unwrap().1?;
        let points: Vec<[f64; 3]> = (0..60)
            .map(|_| [0, 1, 2].map(|k| bounds.min[k] + random.unit() * (bounds.max[k] - bounds.min[k])))
            .collect();
        let none = Dual { value: 0.0, gradient: [0.0; 3] };
        let (mut full, mut pruned) = (vec![none; 60], vec![none; 60]);
        tape.gradient_at(&points, &mut full).unwrap();
        shorter.gradient_at(&points, &mut pruned).unwrap();
        assert_eq!(full, pruned);
        Some(shorter.len())
    }

    #[test]
    fn leaving_out_terms_without_effect_changes_no_value() {
        let mut random = Random::new(5);
        let mut n_shorter = 0;
        for case in 0..300 {
            let tape = Tape::new(&chain(&mut random, 20, false));
            let half = [0.5, 0.1, 0.02][case % 3];
            let middle = random.point();
            let bounds = Box3 { min: middle.map(|x| x - half), max: middle.map(|x| x + half) };
            n_shorter += usize::from(same_in(&tape, &bounds, &mut random).is_some());
        }
        assert!(n_shorter > 150, "{n_shorter}");
    }

    #[test]
    fn a_ball_of_a_chain_of_blends_is_compared_with_the_nearest_of_all() {
        let mut random = Random::new(9);
        let tape = Tape::new(&chain(&mut random, 200, true));
        let mut steps = 0;
        for _ in 0..20 {
            let middle = random.point_within(0.8);
            let bounds = Box3 { min: middle.map(|x| x - 0.05), max: middle.map(|x| x + 0.05) };
            steps += same_in(&tape, &bounds, &mut random).expect("most balls are far");
        }
        // 200 balls of 17 steps; some ten of them reach into a box.
        assert!(steps / 20 < tape.len() / 6, "{} of {}", steps / 20, tape.len());
    }
}
