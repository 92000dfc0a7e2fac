//! `Field`: a signed number for every point, negative inside, with the known facts about it.
pub(super) mod construction;
mod periodic_pattern;

pub use periodic_pattern::Repeat;
pub(super) use periodic_pattern::{MOST_LISTED, PeriodicPattern};

use super::distance::Distance;
use super::expr::Expr;
use super::outside::is_empty_outside;
use super::promises::Promises;
use super::tape::Tape;
use crate::budget::Evidence;
use crate::math::{Box3, add_up, greater, sub_down};
use construction::Construction;
use std::sync::Arc;

/// An implicit shape: the set of points where an expression is negative.
///
/// Besides the expression, a field carries the facts that proofs and queries need: its distance quality, and
/// a box that contains the shape. Statements of the caller that could not be checked are kept as sentences;
/// [`Field::evidence`] lists them.
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
/// # Ok::<(), chordal::implicit::leaves::LeafError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Field {
    expr: Expr,
    sign: Option<Expr>,
    /// Whether the sign expression equals the value wherever the value is negative.
    sign_is_depth: bool,
    /// Whether a part has its own sign expression, with creases that the value does not show.
    has_creases: bool,
    /// Set for a shape that repeats without end, or nearly so.
    pattern: Option<Arc<PeriodicPattern>>,
    distance: Distance,
    bounds: Box3,
    promises: Promises,
    /// Promises about the value as a distance. Proofs depend on them only after an operation has used the
    /// distance.
    distance_promises: Promises,
    /// The solids that it is built from, if known.
    construction: Option<Construction>,
    /// The largest distance from the shape that it represents; infinite if unknown.
    slack: f64,
}

impl Field {
    /// All of space: the [`Field::bounds`] of a field without a known box.
    pub const EVERYWHERE: Box3 = Box3 { min: [f64::NEG_INFINITY; 3], max: [f64::INFINITY; 3] };

    /// The field of an expression without further facts.
    #[must_use]
    pub fn new(expr: Expr) -> Self {
        Self {
            expr,
            sign: None,
            sign_is_depth: false,
            has_creases: false,
            pattern: None,
            distance: Distance::SIGN,
            bounds: Self::EVERYWHERE,
            promises: Promises::default(),
            distance_promises: Promises::default(),
            construction: None,
            slack: 0.0,
        }
    }

    /// The field of an expression built from other fields. It inherits their promises and creases. Its slack
    /// is known only if the operation sets it.
    pub(super) fn from_parts(expr: Expr, parts: &[&Self]) -> Self {
        let mut field = Self::new(expr);
        if parts.iter().any(|part| part.slack > 0.0) {
            field.slack = f64::INFINITY;
        }
        for part in parts {
            field.has_creases |= part.has_creases;
            field.promises.extend(&part.promises);
            field.distance_promises.extend(&part.distance_promises);
        }
        field
    }

    /// The same, with the caller's promise of the distance quality. Proofs depend on it once an operation
    /// uses the distance, such as [`Field::offset`].
    #[must_use]
    pub fn with_distance(mut self, distance: Distance) -> Self {
        if distance != Distance::SIGN {
            let (outside, inside) = (distance.outside.as_str(), distance.inside.as_str());
            let sentence = format!(
                "as stated by the caller, the field's value is a distance: outside {outside}, inside {inside}"
            );
            self.distance_promises.add(sentence.into());
        }
        self.known_distance(distance)
    }

    /// The same, with the caller's promise that no point outside the box is inside the shape.
    ///
    /// If interval arithmetic proves this, it is no longer a promise. Intervals are rounded outward, so a box
    /// larger by 2⁻⁴⁰ of its largest coordinate is tried too; if only that box is proved, it becomes the
    /// bounds. Otherwise [`Field::evidence`] lists the promise. Cost: intervals in a thousand boxes at most.
    #[must_use]
    pub fn with_bounds(mut self, bounds: Box3) -> Self {
        let tape = Tape::new(self.sign());
        if is_empty_outside(&tape, &bounds) {
            return self.known_bounds(bounds);
        }
        let roomy = with_margin(&bounds);
        if is_empty_outside(&tape, &roomy) {
            return self.known_bounds(roomy);
        }
        let Box3 { min, max } = bounds;
        self.promise(format!("the field has no interior points outside the box from {min:?} to {max:?}"));
        self.known_bounds(bounds)
    }

    /// Whether intervals prove that no point outside a box is inside the shape.
    pub(crate) fn is_within(&self, bounds: &Box3) -> bool {
        is_empty_outside(&Tape::new(self.sign()), bounds)
    }

    /// The same, with the caller's promise that `sign` is negative exactly where the value is negative, and
    /// positive exactly where the value is positive. [`Field::evidence`] lists the promise.
    ///
    /// A distance often has kinks on the surface itself, where intervals of its gradient say little: the
    /// distance to a box consists of an outer and an inner part that meet there. An expression that passes
    /// smoothly through 0, such as a maximum of planes, has the same shape and allows proofs.
    #[must_use]
    pub fn with_sign(mut self, sign: Expr) -> Self {
        self.promise("the sign expression has the sign of the field's value everywhere".into());
        self.known_sign(sign)
    }

    /// The same field with its expressions replaced by others of the same values.
    pub(super) fn map_expressions(&self, map: impl Fn(&Expr) -> Expr + Copy) -> Self {
        let expr = map(&self.expr);
        // A sign that is the value stays so: `has_own_sign` compares addresses.
        let sign = match &self.sign {
            Some(sign) if sign.address() == self.expr.address() => Some(expr.clone()),
            other => other.as_ref().map(map),
        };
        let pattern = self.pattern().map(|pattern| Arc::new(pattern.map_expressions(map)));
        Self { expr, sign, pattern, ..self.clone() }
    }

    /// Adds a promise.
    pub(super) fn promise(&mut self, sentence: String) {
        self.promises.add(sentence.into());
    }

    /// The same, as a stand-in for another shape: proofs about it hold under this promise.
    pub(crate) fn standing_for(mut self, sentence: String) -> Self {
        self.promise(sentence);
        self
    }

    /// The same, for a field built from numbers of other fields: proofs depend on the promises about those.
    pub(super) fn with_promises_of(mut self, parts: &[Self]) -> Self {
        parts.iter().for_each(|part| self.promises.extend(&part.promises));
        // Two hulls differ by no more than the shapes that they enclose.
        self.slack = parts.iter().fold(self.slack, |most, part| greater(most, part.slack));
        self
    }

    /// The same, as an approximation of another shape, as polygons approximate curves: every point inside
    /// exactly one of the two shapes is within `slack` of their surfaces, and if the value is a distance, its
    /// error is at most `slack`.
    ///
    /// [`Field::slack`] keeps it through later operations: moves, turns and extrusions leave it unchanged,
    /// scales change it, and a combination has the largest one of its parts. A point inside exactly one of
    /// the combined shape and its ideal is within that distance of the surface of a *part*, which other parts
    /// may hide.
    #[must_use]
    pub fn with_slack(self, slack: f64) -> Self {
        Self { slack: greater(self.slack, slack), ..self }
    }

    /// The largest distance from the shape that it approximates: see [`Field::with_slack`]. 0 if it is itself
    /// the true shape, infinite after an operation whose effect on the slack is unknown, such as a blend.
    ///
    /// ```
    /// use chordal::implicit::shapes::rectangle;
    /// let drawn = rectangle([2.0, 1.0])?.with_slack(0.01);
    /// assert_eq!(drawn.extruded(3.0)?.moved([5.0, 0.0, 0.0])?.slack(), 0.01);
    /// assert!((0.03..0.0301).contains(&drawn.scaled([3.0, -2.0, 1.0])?.slack()));
    /// assert_eq!(drawn.extruded(3.0)?.twisted(0.1)?.slack(), f64::INFINITY);
    /// # Ok::<(), chordal::implicit::shapes::InvalidShape>(())
    /// ```
    #[must_use]
    pub fn slack(&self) -> f64 {
        self.slack
    }

    /// Sets the slack, for an operation that knows it.
    pub(super) fn known_slack(self, slack: f64) -> Self {
        Self { slack, ..self }
    }

    /// The same, for an operation that uses the distance: from now on proofs also depend on the promises
    /// about it.
    pub(super) fn as_distance(&self) -> Self {
        let mut field = self.clone();
        field.promises.extend(&self.distance_promises);
        field
    }

    /// Sets the distance quality, if it is known and not promised.
    pub(crate) fn known_distance(self, distance: Distance) -> Self {
        Self { distance, ..self }
    }

    /// Sets a box that contains the shape, if it is known and not promised.
    pub(crate) fn known_bounds(self, bounds: Box3) -> Self {
        Self { bounds, ..self }
    }

    /// Sets another expression of the same sign, if that is known and not promised.
    pub(crate) fn known_sign(self, sign: Expr) -> Self {
        let has_creases = self.has_creases || sign.is_choice();
        Self { has_creases, ..self.replace_sign(sign) }
    }

    /// The same, for an expression that also equals the value wherever the value is negative: for a box, the
    /// largest signed distance to its planes, which equals the box's distance only inside.
    pub(super) fn known_depth(self, sign: Expr) -> Self {
        Self { sign_is_depth: true, ..self.known_sign(sign) }
    }

    /// Sets a sign expression that is built from those of the parts, or from the value.
    pub(super) fn replace_sign(self, sign: Expr) -> Self {
        Self { sign: Some(sign), sign_is_depth: false, ..self }
    }

    /// The same, if the sign expression is known to equal the value wherever the value is negative.
    pub(super) fn with_depth(self, is_depth: bool) -> Self {
        Self { sign_is_depth: is_depth && self.sign.is_some(), ..self }
    }

    /// An expression with the sign of the value that equals the value wherever it is negative. It decides
    /// whether a point is deeper than a length, and shows the creases.
    pub(super) fn depth(&self) -> Option<&Expr> {
        match &self.sign {
            None => Some(&self.expr),
            Some(sign) => self.sign_is_depth.then_some(sign),
        }
    }

    /// The evidence of a proof about the surface: the weakest among the leaves of [`Field::sign`] and the
    /// promises about the field. Cost: linear in the distinct subexpressions.
    ///
    /// ```
    /// use chordal::budget::Evidence;
    /// use chordal::implicit::{Expr, Field};
    /// use chordal::math::Box3;
    /// let [x, y, z] = Expr::axes();
    /// let ball = Field::new(x.square() + y.square() + z.square() - 1.0);
    /// let cube = |half: f64| Box3 { min: [-half; 3], max: [half; 3] };
    /// assert_eq!(ball.clone().with_bounds(cube(1.0)).evidence(), Evidence::Proved); // ranges show it
    /// assert!(matches!(ball.with_bounds(cube(0.5)).evidence(), Evidence::ProvedIf(_)));
    /// ```
    #[must_use]
    pub fn evidence(&self) -> Evidence {
        Tape::new(self.sign()).evidence().weaker(&self.promises.evidence())
    }

    /// The evidence of a proof that uses the value as a distance of the quality [`Field::distance`]: the
    /// weakest among the leaves of the value, the promises about it, and those about the field.
    #[must_use]
    pub fn distance_evidence(&self) -> Evidence {
        self.tape().evidence().weaker(&self.as_distance().promises.evidence())
    }

    /// An expression that is negative exactly where the value is, for uses that need the surface and not the
    /// distance: that of [`Field::with_sign`], else the value itself.
    #[must_use]
    pub fn sign(&self) -> &Expr {
        self.sign.as_ref().unwrap_or(&self.expr)
    }

    /// How the shape is built from solids, if it is a combination of some: see [`Construction`].
    #[must_use]
    pub fn construction(&self) -> Option<&Construction> {
        self.construction.as_ref()
    }

    /// Sets how the shape is built from solids, if known.
    pub(super) fn known_construction(self, construction: Option<Construction>) -> Self {
        Self { construction, ..self }
    }

    /// The pattern that it repeats without end, if any.
    pub(super) fn pattern(&self) -> Option<&PeriodicPattern> {
        self.pattern.as_deref()
    }

    pub(super) fn with_pattern(self, pattern: PeriodicPattern) -> Self {
        Self { pattern: Some(Arc::new(pattern)), ..self }
    }

    /// An expression with the same sign inside the box.
    pub(super) fn sign_within(&self, bounds: &Box3) -> Expr {
        let listed = self.pattern().and_then(|pattern| pattern.sign_within(bounds));
        listed.unwrap_or_else(|| self.sign().clone())
    }

    /// Whether [`Field::sign`] has been set.
    #[must_use]
    pub fn has_sign(&self) -> bool {
        self.sign.is_some()
    }

    /// Whether [`Field::sign`] is an expression other than the value.
    pub(super) fn has_own_sign(&self) -> bool {
        self.sign.as_ref().is_some_and(|sign| sign.address() != self.expr.address())
    }

    /// Whether the sign combines several primitives, which may meet in creases.
    pub(super) fn has_creases(&self) -> bool {
        self.has_own_sign() && self.has_creases
    }

    /// The expression of the value.
    #[must_use]
    pub fn expr(&self) -> &Expr {
        &self.expr
    }

    /// The distance quality of the value.
    #[must_use]
    pub fn distance(&self) -> Distance {
        self.distance
    }

    /// A closed box that contains the shape; infinite in directions without a known bound.
    #[must_use]
    pub fn bounds(&self) -> Box3 {
        self.bounds
    }

    /// The field compiled for evaluation. Cost: linear in the distinct subexpressions; keep the result.
    #[must_use]
    pub fn tape(&self) -> Tape {
        Tape::new(&self.expr)
    }
}

/// The box with a margin for the rounding of intervals at its sides.
fn with_margin(bounds: &Box3) -> Box3 {
    /// Derived: an interval after some thousand steps is off by less than 2⁻⁴⁰ of its numbers.
    const MARGIN: f64 = 1.0 / (1_u64 << 40) as f64;
    let ends = bounds.min.iter().chain(&bounds.max).map(|x| x.abs()).filter(|x| x.is_finite());
    let margin = MARGIN * ends.fold(0.0, |most, x| greater(x, most));
    Box3 { min: bounds.min.map(|x| sub_down(x, margin)), max: bounds.max.map(|x| add_up(x, margin)) }
}
