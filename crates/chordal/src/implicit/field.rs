//! `Field`: a signed number for every point, negative inside, with what is known of it.
use super::distance::Distance;
use super::expr::Expr;
use super::tape::Tape;
use crate::math::Box3;

/// A shape as a rule: the points where its expression is negative.
///
/// Beside the expression it carries what proofs and queries need to know: what the value is worth as a distance, and a
/// box outside of which nothing is inside.
///
/// ```
/// use chordal::implicit::{Distance, Expr, Field};
/// use chordal::math::Box3;
/// let [x, y, z] = Expr::axes();
/// let sphere = Field::new((x.square() + y.square() + z.square()).sqrt() - 1.0)
///     .with_distance(Distance::EXACT)
///     .with_bounds(Box3 { min: [-1.0; 3], max: [1.0; 3] });
/// let mut values = [0.0; 2];
/// sphere.tape().at(&[[0.0; 3], [0.0, 0.0, 3.0]], &mut values)?;
/// assert_eq!(values, [-1.0, 2.0]);
/// # Ok::<(), chordal::implicit::LeafError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Field {
    expr: Expr,
    sign: Option<Expr>,
    distance: Distance,
    bounds: Box3,
}

impl Field {
    /// All of space, as far as [`Field::bounds`] is concerned.
    pub const EVERYWHERE: Box3 = Box3 { min: [f64::NEG_INFINITY; 3], max: [f64::INFINITY; 3] };

    /// The field of an expression of which nothing is known.
    #[must_use]
    pub fn new(expr: Expr) -> Self {
        Self { expr, sign: None, distance: Distance::SIGN, bounds: Self::EVERYWHERE }
    }

    /// The same, with the caller's word for what the value is worth as a distance.
    #[must_use]
    pub fn with_distance(self, distance: Distance) -> Self {
        Self { distance, ..self }
    }

    /// The same, with the caller's word that nothing outside of the box is inside the shape.
    #[must_use]
    pub fn with_bounds(self, bounds: Box3) -> Self {
        Self { bounds, ..self }
    }

    /// The same, with the caller's word that `sign` is negative exactly where the value is, and positive exactly where that is.
    ///
    /// A distance often has kinks on the surface itself (that of a box is made of an outer and an inner part which meet
    /// there), where ranges of its gradient say little. An expression that runs smoothly through 0, such as a maximum of
    /// planes, has the same shape, and lets proofs through.
    #[must_use]
    pub fn with_sign(self, sign: Expr) -> Self {
        Self { sign: Some(sign), ..self }
    }

    /// An expression that is negative exactly where the value is, for what needs the surface and not the distance:
    /// that of [`Field::with_sign`], else the value's own.
    #[must_use]
    pub fn sign(&self) -> &Expr {
        self.sign.as_ref().unwrap_or(&self.expr)
    }

    /// Whether [`Field::sign`] is an expression of its own.
    #[must_use]
    pub fn has_sign(&self) -> bool {
        self.sign.is_some()
    }

    /// Whether [`Field::sign`] is another expression than the value.
    pub(super) fn has_own_sign(&self) -> bool {
        self.sign.as_ref().is_some_and(|sign| sign.address() != self.expr.address())
    }

    /// The number of every point.
    #[must_use]
    pub fn expr(&self) -> &Expr {
        &self.expr
    }

    /// What the value is worth as a distance.
    #[must_use]
    pub fn distance(&self) -> Distance {
        self.distance
    }

    /// A closed box that holds every point of the shape; infinite in directions where none is known.
    #[must_use]
    pub fn bounds(&self) -> Box3 {
        self.bounds
    }

    /// The field made ready for evaluation. Cost: linear in the distinct parts of the expression; keep it.
    #[must_use]
    pub fn tape(&self) -> Tape {
        Tape::of(&self.expr)
    }
}
