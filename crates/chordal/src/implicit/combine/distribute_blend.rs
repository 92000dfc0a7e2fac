//! Rewrites blends of minima and maxima as minima and maxima of blends.
//!
//! A smooth minimum grows with both of its operands, so `smin(max(p, q), b) = max(smin(p, b), smin(q, b))`,
//! and likewise for minima. The remaining pieces are smooth, and the creases are where they meet: a fillet
//! along a polyhedron has creases of its own.
use crate::implicit::Expr;
use crate::implicit::expr::ExprKind;
use crate::implicit::op::{Binary, Unary};

/// The most pieces of one expression; an expression with more is left unchanged. Chosen: a blend of two
/// polyhedra.
const MOST_PIECES: usize = 128;
/// The most nodes that are visited to find one minimum or maximum. Chosen: chains of blends grow by one at a
/// time, and each node is visited again.
pub(super) const MOST_LOOKS: usize = 256;

/// The values that must be exact; for all others the sign is enough.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ExactSign {
    Positive,
    Negative,
    All,
    /// None: only the faces matter.
    Faces,
}

impl ExactSign {
    fn mirrored(self) -> Self {
        match self {
            Self::Positive => Self::Negative,
            Self::Negative => Self::Positive,
            same => same,
        }
    }

    /// The same for an operand that is multiplied by `k`.
    fn times(self, k: f64) -> Self {
        if k < 0.0 { self.mirrored() } else { self }
    }
}

/// A minimum or maximum of two expressions.
pub(super) struct Extremum {
    pub is_min: bool,
    pub parts: [Expr; 2],
}

impl Extremum {
    fn map(self, map: impl Fn(&Expr) -> Expr) -> Self {
        let [a, b] = &self.parts;
        Self { parts: [map(a), map(b)], ..self }
    }

    /// The same below a decreasing operation.
    fn flipped(self) -> Self {
        Self { is_min: !self.is_min, ..self }
    }
}

/// A blend of two expressions as minima and maxima of blends of their pieces. The blend must grow with both
/// operands. The result has the blend's sign wherever both operands are above 0; where one is below, only the
/// sign of the pieces is meaningful. None if both are one piece.
pub(super) fn distribute_blend(a: &Expr, b: &Expr, blend: &dyn Fn(&Expr, &Expr) -> Expr) -> Option<Expr> {
    let mut n_left = MOST_PIECES;
    let blended = distribute([a, b], blend, &mut n_left);
    (n_left < MOST_PIECES).then_some(blended)
}

fn distribute([a, b]: [&Expr; 2], blend: &dyn Fn(&Expr, &Expr) -> Expr, n_left: &mut usize) -> Expr {
    if *n_left == 0 {
        return blend(a, b);
    }
    let extremum = |expr: &Expr| {
        let mut looks = MOST_LOOKS;
        find_extremum(expr, ExactSign::Positive, &mut looks)
    };
    let (choice, is_first) = match extremum(a) {
        Some(choice) => (choice, true),
        None => match extremum(b) {
            Some(choice) => (choice, false),
            None => return blend(a, b),
        },
    };
    // Each choice doubles the pieces, so all levels share one count.
    *n_left -= 1;
    let [p, q] = choice
        .parts
        .each_ref()
        .map(|part| distribute(if is_first { [part, b] } else { [a, part] }, blend, n_left));
    if choice.is_min { p.min(&q) } else { p.max(&q) }
}

/// An expression as a minimum or maximum: the same sign everywhere, and the exact value where `exact` demands
/// it.
pub(super) fn find_extremum(expr: &Expr, exact: ExactSign, looks: &mut usize) -> Option<Extremum> {
    *looks = looks.checked_sub(1)?;
    match expr.kind() {
        // The box or ball that limits a bound lies beyond its surface, and needs no pieces of its own.
        ExprKind::Binary(Binary::Max, a, b) if is_bounding_term(b) => {
            Some(find_extremum(a, exact, looks)?.map(|part| part.max(b)))
        }
        ExprKind::Binary(op @ (Binary::Min | Binary::Max), a, b) => {
            Some(Extremum { is_min: *op == Binary::Min, parts: [a.clone(), b.clone()] })
        }
        ExprKind::Unary(Unary::Abs, a) => Some(Extremum { is_min: false, parts: [a.clone(), -a] }),
        ExprKind::Unary(Unary::Neg, a) => {
            Some(find_extremum(a, exact.mirrored(), looks)?.flipped().map(|part| -part))
        }
        ExprKind::At(below, at) => {
            Some(find_extremum(below, exact, looks)?.map(|part| part.with_axes(at.clone())))
        }
        ExprKind::Binary(Binary::SmoothMin, a, b) => {
            // A smooth minimum is at most either operand: where it is above 0, both operands are.
            let exact_parts = match exact {
                ExactSign::Positive => ExactSign::Positive,
                _ => ExactSign::All,
            };
            let blend = |part: &Expr, other: &Expr| Expr::binary(Binary::SmoothMin, part, other);
            match find_extremum(a, exact_parts, looks) {
                Some(of_a) => Some(of_a.map(|part| blend(part, b))),
                None => Some(find_extremum(b, exact_parts, looks)?.map(|part| blend(a, part))),
            }
        }
        ExprKind::Binary(Binary::Add, root, inside)
            if matches!(exact, ExactSign::Negative | ExactSign::Faces) =>
        {
            match largest_side(root, inside) {
                Some(largest) => find_extremum(largest, exact, looks),
                None => with_constant(expr, exact, looks),
            }
        }
        ExprKind::Leaf(..) => {
            let (mark, below) = expr.mark()?;
            Some(find_extremum(below, exact, looks)?.map(|part| part.marked(mark)))
        }
        _ => with_constant(expr, exact, looks),
    }
}

/// Whether it is a coordinate or a length minus a number, or a number minus a coordinate.
fn is_bounding_term(expr: &Expr) -> bool {
    let ExprKind::Binary(Binary::Sub, a, b) = expr.kind() else { return false };
    matches!(
        (a.kind(), b.kind()),
        (ExprKind::Axis(_) | ExprKind::Unary(Unary::Sqrt, _), ExprKind::Const(_))
            | (ExprKind::Const(_), ExprKind::Axis(_))
    )
}

/// A minimum or maximum below an operation with a constant.
fn with_constant(expr: &Expr, exact: ExactSign, looks: &mut usize) -> Option<Extremum> {
    let ExprKind::Binary(op, a, b) = expr.kind() else { return None };
    let (op, constant, below, is_first) = match (a.kind(), b.kind()) {
        (_, ExprKind::Const(k)) => (*op, *k, a, false),
        (ExprKind::Const(k), _) => (*op, *k, b, true),
        _ => return None,
    };
    let (exact, falls) = match op {
        Binary::Mul if constant != 0.0 => (exact.times(constant), constant < 0.0),
        Binary::Div if constant != 0.0 && !is_first => (exact.times(constant), constant < 0.0),
        // The sign of a sum depends on its operand's value, not only on its sign.
        Binary::Add => (ExactSign::All, false),
        Binary::Sub => (ExactSign::All, is_first),
        _ => return None,
    };
    let again = |part: &Expr| {
        let constant = Expr::constant(constant);
        if is_first { Expr::binary(op, &constant, part) } else { Expr::binary(op, part, &constant) }
    };
    let below = find_extremum(below, exact, looks)?.map(again);
    Some(if falls { below.flipped() } else { below })
}

/// The largest of the signed distances to sides, if two terms are the parts of the distance to their box: the
/// length of the positive ones, and the largest if none is positive. It equals the distance where that is at
/// most 0, and has its sign.
fn largest_side<'a>(root: &'a Expr, inside: &'a Expr) -> Option<&'a Expr> {
    let is_zero = |expr: &Expr| matches!(expr.kind(), ExprKind::Const(k) if *k == 0.0);
    let (ExprKind::Unary(Unary::Sqrt, sum), ExprKind::Binary(Binary::Min, largest, zero)) =
        (root.kind(), inside.kind())
    else {
        return None;
    };
    // By address: equal sides that were built apart are taken for different ones.
    let mut above = Vec::new();
    let mut open = vec![sum];
    while let Some(part) = open.pop() {
        match part.kind() {
            ExprKind::Binary(Binary::Add, a, b) => open.extend([a, b]),
            ExprKind::Unary(Unary::Square, side) => match side.kind() {
                ExprKind::Binary(Binary::Max, side, zero) if is_zero(zero) => above.push(side.address()),
                _ => return None,
            },
            _ => return None,
        }
    }
    let mut sides = Vec::new();
    let mut open = vec![largest];
    while let Some(part) = open.pop() {
        match part.kind() {
            _ if above.contains(&part.address()) => sides.push(part.address()),
            ExprKind::Binary(Binary::Max, a, b) => open.extend([a, b]),
            _ => return None,
        }
    }
    above.sort_unstable();
    sides.sort_unstable();
    (is_zero(zero) && above == sides).then_some(largest)
}

#[cfg(test)]
mod tests {
    use crate::implicit::shapes::{cuboid, cylinder, ellipsoid, octahedron, sphere, tetrahedron};
    use crate::implicit::{Csg, Field};
    use chordal_testkit::Random;

    #[test]
    fn blends_in_pieces_have_the_sign_of_their_value() {
        let turned = |field: Field, by: f64| field.rotated_deg([1.0, 2.0, 3.0], by).unwrap();
        let solids = [
            turned(octahedron(0.7).unwrap(), 20.0),
            turned(tetrahedron(0.8).unwrap(), 50.0).moved([0.2, 0.1, 0.0]).unwrap(),
            turned(cuboid([1.0, 0.8, 0.6]).unwrap(), 75.0).moved([-0.2, 0.0, 0.1]).unwrap(),
            turned(cylinder(0.4, 1.1).unwrap(), 33.0),
            ellipsoid([0.3, 0.5, 0.9]).unwrap().moved([0.0, 0.3, 0.0]).unwrap(),
            sphere(0.5).unwrap().moved([0.4, 0.0, 0.3]).unwrap(),
        ];
        let mut random = Random::new(5);
        for (k, a) in solids.iter().enumerate() {
            for b in &solids[..k] {
                let union = a.smooth_union(b, 0.4).unwrap();
                let less = a.smooth_difference(b, 0.3).unwrap();
                let chain =
                    union.smooth_union(&solids[5], 0.2).unwrap().smooth_difference(&solids[4], 0.1).unwrap();
                for blend in [union, less, chain] {
                    for _ in 0..400 {
                        let at = random.point();
                        let [value, sign] = [blend.expr(), blend.sign()].map(|expr| expr.at(at).unwrap());
                        // A hundred roundings.
                        assert!(
                            (value < 0.0) == (sign < 0.0) || value.abs() < 2e-14,
                            "{k} {at:?} {value} {sign}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn polyhedra_are_blended_plane_by_plane() {
        let blend = octahedron(0.7).unwrap().smooth_union(&sphere(0.5).unwrap(), 0.2).unwrap();
        // Eight planes, the ball, and a blend of the ball with each plane.
        assert_eq!(Csg::from_expr(blend.sign()).primitives().len(), 17);
        // If a box is cut, in its inside, each of its sides is a piece.
        let cut = cuboid([1.0; 3]).unwrap().smooth_difference(&sphere(0.5).unwrap(), 0.2).unwrap();
        assert_eq!(Csg::from_expr(cut.sign()).primitives().len(), 13);
        // The distance to a box is smooth outside.
        let grown = cuboid([1.0; 3]).unwrap().smooth_union(&sphere(0.5).unwrap(), 0.2).unwrap();
        assert_eq!(Csg::from_expr(grown.sign()).primitives().len(), 8);
    }
}
