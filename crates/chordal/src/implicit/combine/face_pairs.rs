//! Blends of two expressions, face by face: finds the pairs of faces that meet in a region, and builds the
//! expression of their blends.
use super::distribute_blend::{ExactSign, MOST_LOOKS, find_extremum};
use crate::implicit::op::{Binary, Unary};
use crate::implicit::{Expr, ExprGraph, Tape, Term};
use crate::math::{Box3, Interval};
use std::cell::Cell;

/// The blend of two faces.
pub(super) enum FaceBlend {
    /// A blend that adds nothing to their union.
    Sharp(Expr),
    /// A blend with a seam, at most the smaller of the two.
    Round(Expr),
}

/// The result of a blend in a region.
enum RegionBlend {
    /// It is below 0 throughout.
    Below,
    /// It is nowhere below 0.
    Above,
    /// It adds nothing to the union.
    Sharp(Expr),
    Round(Expr),
}

/// The blends of all pairs of faces of two expressions, as minima and maxima that follow those of the
/// expressions. In the region it is below 0 where a seam of this size or either shape is; beyond, it has no
/// meaning. None if there is no seam.
pub(super) fn distribute_faces(
    a: &Expr,
    b: &Expr,
    blend: &dyn Fn(&Expr, &Expr) -> FaceBlend,
    size: f64,
    region: &Box3,
) -> Option<Expr> {
    let (n_left, steps, groups) = (MOST_FACE_PAIRS, MOST_STEPS.into(), None);
    let mut pairs = FacePairs { blend, size, region, left: n_left, steps, groups };
    match pairs.distribute([a, b], false, 0) {
        RegionBlend::Round(blended) => Some(blended),
        // Either shape covers the entire region, or the seam does.
        RegionBlend::Below => Some(Expr::constant(-size)),
        RegionBlend::Above | RegionBlend::Sharp(_) => None,
    }
}

/// The most pairs of faces. Chosen: a part of some hundred faces with another of few faces; most pairs are
/// dropped again because they are nowhere near each other.
const MOST_FACE_PAIRS: usize = 4096;

/// The most terms that are evaluated in search of pairs that are near each other. Chosen: some milliseconds.
const MOST_STEPS: usize = 1 << 20;
/// The most nested choices, each of which is a recursive call. Chosen: far less than the smallest stack
/// holds.
const MOST_DEPTH: u32 = 256;

struct FacePairs<'a> {
    blend: &'a dyn Fn(&Expr, &Expr) -> FaceBlend,
    size: f64,
    region: &'a Box3,
    left: usize,
    steps: Cell<usize>,
    /// The planes of each operand among the operands of the enclosing maximum, if there is one.
    groups: Option<[Vec<PlaneForm>; 2]>,
}

impl FacePairs<'_> {
    fn range(&self, expr: &Expr) -> Interval {
        if self.steps.get() == 0 {
            return Interval::UNKNOWN;
        }
        let (mut range, tape) = ([Interval::UNKNOWN], Tape::new(expr));
        self.steps.set(self.steps.get().saturating_sub(tape.len()));
        let ends = self.region.min.iter().chain(&self.region.max);
        // Leaves may be user functions that cannot handle unbounded boxes.
        if tape.has_leaves() && !ends.into_iter().all(|x| x.is_finite()) {
            return Interval::UNKNOWN;
        }
        // A leaf that fails says nothing about its range.
        if tape.over(&[*self.region], &mut range).is_err() || !range[0].is_defined() {
            return Interval::UNKNOWN;
        }
        range[0]
    }

    fn distribute(&mut self, [a, b]: [&Expr; 2], below_max: bool, depth: u32) -> RegionBlend {
        // A blend is at most the smaller of the two.
        if self.range(a).hi() < 0.0 || self.range(b).hi() < 0.0 {
            return RegionBlend::Below;
        }
        let extremum = |expr: &Expr| {
            let mut looks = MOST_LOOKS;
            find_extremum(expr, ExactSign::Faces, &mut looks)
        };
        let is_leaf = self.left == 0 || depth == MOST_DEPTH || self.steps.get() == 0;
        let choice = if is_leaf { None } else { extremum(a).map(|choice| (choice, true)) };
        let choice = match choice {
            None if !is_leaf => extremum(b).map(|choice| (choice, false)),
            some => some,
        };
        let Some((choice, is_first)) = choice else { return self.pair(a, b) };
        self.left -= 1;
        let below = below_max || !choice.is_min;
        // Only the outermost maximum has a group.
        let opens_group = !choice.is_min && self.groups.is_none();
        if opens_group {
            self.groups = Some([a, b].map(planes_of_maximum));
        }
        let [p, q] = choice
            .parts
            .each_ref()
            .map(|part| self.distribute(if is_first { [part, b] } else { [a, part] }, below, depth + 1));
        if opens_group {
            self.groups = None;
        }
        if choice.is_min { least(p, q, below_max) } else { most(p, q) }
    }

    fn pair(&self, a: &Expr, b: &Expr) -> RegionBlend {
        // Of two parallel planes of a maximum, the outer one is the blend of both, and no blend with it is
        // larger.
        let is_outer = |plane: &Expr, other: usize| {
            let (Some(groups), Some(plane)) = (&self.groups, PlaneForm::from_expr(plane)) else {
                return false;
            };
            groups[other].iter().any(|inner| plane.is_outside(inner))
        };
        let (blended, is_sharp) = match (self.blend)(a, b) {
            _ if is_outer(a, 1) => (a.clone(), true),
            _ if is_outer(b, 0) => (b.clone(), true),
            FaceBlend::Sharp(union) => (union, true),
            // Nothing is added if they differ by more than the size of a seam.
            FaceBlend::Round(round) => (round, self.range(&(a - b)).abs().lo() >= self.size),
        };
        let range = self.range(&blended);
        match (range.hi() < 0.0, range.lo() >= 0.0, is_sharp) {
            (true, ..) => RegionBlend::Below,
            (_, true, _) => RegionBlend::Above,
            (.., true) => RegionBlend::Sharp(blended),
            _ => RegionBlend::Round(blended),
        }
    }
}

fn least(p: RegionBlend, q: RegionBlend, below_max: bool) -> RegionBlend {
    use RegionBlend::{Above, Below, Round, Sharp};
    match (p, q) {
        (Below, _) | (_, Below) => Below,
        (Above, other) | (other, Above) => other,
        (Sharp(p), Sharp(q)) => Sharp(p.min(&q)),
        // A blend that adds nothing to the union can be left out, unless a maximum above needs it.
        (Sharp(_), Round(q)) | (Round(q), Sharp(_)) if !below_max => Round(q),
        (Round(p) | Sharp(p), Round(q) | Sharp(q)) => Round(p.min(&q)),
    }
}

fn most(p: RegionBlend, q: RegionBlend) -> RegionBlend {
    use RegionBlend::{Above, Below, Round, Sharp};
    match (p, q) {
        (Above, _) | (_, Above) => Above,
        (Below, other) | (other, Below) => other,
        (Sharp(p), Sharp(q)) => Sharp(p.max(&q)),
        (Round(p) | Sharp(p), Round(q) | Sharp(q)) => Round(p.max(&q)),
    }
}

/// The planes among the operands of a maximum of maxima.
fn planes_of_maximum(expr: &Expr) -> Vec<PlaneForm> {
    let (mut planes, mut open) = (Vec::new(), vec![expr.clone()]);
    while let Some(part) = open.pop() {
        let mut looks = MOST_LOOKS;
        match find_extremum(&part, ExactSign::Faces, &mut looks) {
            Some(choice) if !choice.is_min && planes.len() + open.len() < MOST_FACE_PAIRS => {
                open.extend(choice.parts);
            }
            Some(_) => {}
            None => planes.extend(PlaneForm::from_expr(&part)),
        }
    }
    planes
}

/// Gradients whose cosine is closer to 1 or −1 count as parallel. Chosen: turned faces are off by some
/// roundings, and a fillet along an edge of a millionth of a degree is invisible.
pub(super) const PARALLEL: f64 = 1.0 - 1.0 / (1_u64 << 40) as f64;

/// A linear expression: its gradient, and its value at the origin. Rounded, since it only guides choices.
pub(super) struct PlaneForm {
    pub slope: [f64; 3],
    offset: f64,
}

impl PlaneForm {
    /// None if the expression is not linear, or too large.
    pub fn from_expr(expr: &Expr) -> Option<Self> {
        /// Chosen: a plane that was moved and turned some times.
        const MOST_TERMS: usize = 256;
        let graph = ExprGraph::from_expr(expr);
        if graph.terms().len() > MOST_TERMS {
            return None;
        }
        let mut forms: Vec<Option<[f64; 4]>> = Vec::new();
        for term in graph.terms() {
            let at = |k: &u32| forms[*k as usize];
            let constant = |k: &u32| at(k).filter(|form| form[..3] == [0.0; 3]).map(|form| form[3]);
            let scaled = |k: &u32, by: f64| at(k).map(|form| form.map(|x| x * by));
            let sum_of = |a: &u32, b: &u32, sign: f64| {
                let (a, b) = (at(a)?, at(b)?);
                Some(std::array::from_fn(|k| a[k] + sign * b[k]))
            };
            forms.push(match term {
                Term::Const(c) => Some([0.0, 0.0, 0.0, *c]),
                Term::Axis(axis) => {
                    Some(std::array::from_fn(|k| if k == usize::from(*axis) { 1.0 } else { 0.0 }))
                }
                Term::Unary(Unary::Neg, a) => scaled(a, -1.0),
                Term::Binary(Binary::Add, a, b) => sum_of(a, b, 1.0),
                Term::Binary(Binary::Sub, a, b) => sum_of(a, b, -1.0),
                Term::Binary(Binary::Mul, a, b) => match (constant(a), constant(b)) {
                    (_, Some(by)) => scaled(a, by),
                    (Some(by), _) => scaled(b, by),
                    _ => None,
                },
                Term::Binary(Binary::Div, a, b) => constant(b).and_then(|by| scaled(a, 1.0 / by)),
                _ => None,
            });
        }
        let [x, y, z, offset] = forms.pop()??;
        let slope = [x, y, z];
        (slope != [0.0; 3]).then_some(Self { slope, offset })
    }

    /// The cosine of the angle between both gradients.
    pub fn cosine(&self, other: &Self) -> f64 {
        let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let squares = dot(&self.slope, &self.slope) * dot(&other.slope, &other.slope);
        dot(&self.slope, &other.slope) / squares.sqrt()
    }

    /// Whether it is below the other one everywhere, up to rounding: a plane farther out, or the same one.
    fn is_outside(&self, other: &Self) -> bool {
        /// Chosen: some dozen roundings.
        const CLOSE: f64 = 1.0 / (1_u64 << 44) as f64;
        let slope_gap = |k: usize| (self.slope[k] - other.slope[k]).abs();
        let size = 1.0 + self.offset.abs();
        (0..3).all(|k| slope_gap(k) <= CLOSE) && self.offset <= other.offset + CLOSE * size
    }
}
