//! `Expr`: a number for every point of space, as an expression with shared subexpressions.
use super::leaf::Leaf;
use super::op::{Binary, Unary};
use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

/// An expression in the coordinates x, y and z. Copies share their nodes, so an expression that is used twice
/// is one node and is evaluated once. Only memory limits depth and sharing.
///
/// ```
/// use chordal::implicit::Expr;
/// let [x, y, z] = Expr::axes();
/// let sphere = (x.square() + y.square() + z.square()).sqrt() - 1.0;
/// assert_eq!(sphere.at([3.0, 0.0, 0.0])?, 2.0);
/// # Ok::<(), chordal::implicit::leaves::LeafError>(())
/// ```
#[derive(Clone)]
pub struct Expr(Arc<ExprNode>);

/// The root node of an expression.
#[derive(Clone)]
pub(super) enum ExprKind {
    Const(f64),
    /// x, y or z.
    Axis(u8),
    Unary(Unary, Expr),
    Binary(Binary, Expr, Expr),
    /// An expression with x, y and z replaced by other expressions.
    At(Expr, [Expr; 3]),
    Leaf(Arc<dyn Leaf>, [Expr; 3]),
}

struct ExprNode(ExprKind);

impl Drop for ExprNode {
    /// Drops the nodes in a loop: recursion over a chain of a million nodes would overflow the stack.
    fn drop(&mut self) {
        let mut pending = Vec::new();
        take_parts(&mut self.0, &mut pending);
        while let Some(part) = pending.pop() {
            if let Some(mut node) = Arc::into_inner(part.0) {
                take_parts(&mut node.0, &mut pending);
            }
        }
    }
}

fn take_parts(kind: &mut ExprKind, pending: &mut Vec<Expr>) {
    match std::mem::replace(kind, ExprKind::Const(0.0)) {
        ExprKind::Const(_) | ExprKind::Axis(_) => {}
        ExprKind::Unary(_, a) => pending.push(a),
        ExprKind::Binary(_, a, b) => pending.extend([a, b]),
        ExprKind::At(a, at) => {
            pending.push(a);
            pending.extend(at);
        }
        ExprKind::Leaf(_, at) => pending.extend(at),
    }
}

impl Expr {
    fn new(kind: ExprKind) -> Self {
        Self(Arc::new(ExprNode(kind)))
    }

    /// A constant.
    #[must_use]
    pub fn constant(value: f64) -> Self {
        Self::new(ExprKind::Const(value))
    }

    /// The coordinates x, y and z.
    #[must_use]
    pub fn axes() -> [Self; 3] {
        [0, 1, 2].map(|k| Self::new(ExprKind::Axis(k)))
    }

    /// An operation on one number.
    #[must_use]
    pub fn unary(op: Unary, a: &Self) -> Self {
        Self::new(ExprKind::Unary(op, a.clone()))
    }

    /// An operation on two numbers.
    #[must_use]
    pub fn binary(op: Binary, a: &Self, b: &Self) -> Self {
        Self::new(ExprKind::Binary(op, a.clone(), b.clone()))
    }

    /// The value of a leaf at the point with these three coordinates.
    #[must_use]
    pub fn leaf(leaf: Arc<dyn Leaf>, at: [Self; 3]) -> Self {
        Self::new(ExprKind::Leaf(leaf, at))
    }

    /// The expression with x, y and z replaced by other expressions, all at once.
    #[must_use]
    pub fn with_axes(&self, at: [Self; 3]) -> Self {
        Self::new(ExprKind::At(self.clone(), at))
    }

    /// The smaller one.
    #[must_use]
    pub fn min(&self, other: &Self) -> Self {
        Self::binary(Binary::Min, self, other)
    }

    /// The smaller one, with its kink rounded off over a width above 0: `min(a, b) − h²/(4·width)` with
    /// `h = max(width − |a − b|, 0)`. Its interval is as tight as those of the operands, however deeply such
    /// terms are nested.
    ///
    /// Source: I. Quilez, *Smooth minimum*.
    #[must_use]
    pub fn smooth_min(&self, other: &Self, width: f64) -> Self {
        Self::binary(Binary::SmoothMin, &(self / width), &(other / width)) * width
    }

    /// The smaller one, with its kink replaced by an arc: it equals the minimum if the operands differ by at
    /// least `radius`, and is 0 on the quarter of the circle of this radius around (`radius`, `radius`) that
    /// touches both axes of the plane of `self` and `other`. If the operands are distances to faces at a
    /// right angle, the arc is a circle of that radius. The result grows with both operands, and is
    /// 1-Lipschitz if both are.
    ///
    /// Source: I. Quilez, *Smooth minimum* (circular); derived here from the equation of the circle.
    #[must_use]
    pub fn round_min(&self, other: &Self, radius: f64) -> Self {
        Self::binary(Binary::RoundMin, &(self / radius), &(other / radius)) * radius
    }

    /// The larger one.
    #[must_use]
    pub fn max(&self, other: &Self) -> Self {
        Self::binary(Binary::Max, self, other)
    }

    /// The absolute value.
    #[must_use]
    pub fn abs(&self) -> Self {
        Self::unary(Unary::Abs, self)
    }

    /// The square.
    #[must_use]
    pub fn square(&self) -> Self {
        Self::unary(Unary::Square, self)
    }

    /// The square root.
    #[must_use]
    pub fn sqrt(&self) -> Self {
        Self::unary(Unary::Sqrt, self)
    }

    /// The sine.
    #[must_use]
    pub fn sin(&self) -> Self {
        Self::unary(Unary::Sin, self)
    }

    /// The cosine.
    #[must_use]
    pub fn cos(&self) -> Self {
        Self::unary(Unary::Cos, self)
    }

    /// Whether the expression, up to sign, constant factors and added constants, is a minimum, a maximum or an
    /// absolute value. Its zero set then consists of zero sets of other expressions.
    pub(super) fn is_choice(&self) -> bool {
        let mut at = self;
        loop {
            at = match at.kind() {
                ExprKind::Binary(Binary::Min | Binary::Max, ..) | ExprKind::Unary(Unary::Abs, _) => {
                    return true;
                }
                ExprKind::Unary(Unary::Neg, below) | ExprKind::At(below, _) => below,
                ExprKind::Binary(Binary::Add | Binary::Sub | Binary::Mul | Binary::Div, a, b) => {
                    match (a.kind(), b.kind()) {
                        (ExprKind::Const(_), _) => b,
                        (_, ExprKind::Const(_)) => a,
                        _ => return false,
                    }
                }
                ExprKind::Leaf(..) => match at.mark() {
                    Some((_, below)) => below,
                    None => return false,
                },
                _ => return false,
            };
        }
    }

    pub(super) fn kind(&self) -> &ExprKind {
        &self.0.0
    }

    /// An identifier of this node, valid as long as it lives.
    pub(super) fn address(&self) -> usize {
        Arc::as_ptr(&self.0) as usize
    }
}

impl fmt::Debug for Expr {
    /// Prints only the root: there may be a million nodes below it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.kind() {
            ExprKind::Const(value) => write!(f, "{value:?}"),
            ExprKind::Axis(k) => f.write_str(["x", "y", "z"][usize::from(*k)]),
            ExprKind::Unary(op, _) => write!(f, "{op:?}(…)"),
            ExprKind::Binary(op, ..) => write!(f, "{op:?}(…, …)"),
            ExprKind::At(..) => f.write_str("At(…)"),
            ExprKind::Leaf(leaf, _) => leaf.fmt(f),
        }
    }
}

impl From<f64> for Expr {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

impl From<&Expr> for Expr {
    fn from(expr: &Expr) -> Self {
        expr.clone()
    }
}

impl Neg for Expr {
    type Output = Self;
    fn neg(self) -> Self {
        Self::unary(Unary::Neg, &self)
    }
}

impl Neg for &Expr {
    type Output = Expr;
    fn neg(self) -> Expr {
        Expr::unary(Unary::Neg, self)
    }
}

macro_rules! arithmetic {
    ($($name:ident $method:ident),*) => {$(
        impl<T: Into<Expr>> $name<T> for Expr {
            type Output = Expr;
            fn $method(self, other: T) -> Expr {
                Expr::binary(Binary::$name, &self, &other.into())
            }
        }
        impl<T: Into<Expr>> $name<T> for &Expr {
            type Output = Expr;
            fn $method(self, other: T) -> Expr {
                Expr::binary(Binary::$name, self, &other.into())
            }
        }
    )*};
}
arithmetic!(Add add, Sub sub, Mul mul, Div div);
