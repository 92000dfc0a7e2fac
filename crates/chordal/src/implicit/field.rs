//! `Field`: a signed number for every point, negative inside, with what is known of it.
use super::combine::Pattern;
use super::distance::Distance;
use super::expr::Expr;
use super::outside::is_empty_outside;
use super::promises::Promises;
use super::tape::Tape;
use crate::budget::Evidence;
use crate::math::{Box3, add_up, sub_down};
use std::sync::Arc;

/// A shape as a rule: the points where its expression is negative.
///
/// Beside the expression it carries what proofs and queries need to know: what the value is worth as a
/// distance, and a box outside of which nothing is inside. What of that rests on the word of whoever made the
/// field and could not be checked is kept as well, in sentences, and [`Field::evidence`] lists it.
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
    /// Whether the sign of a part is another expression that has creases where the value does not show them.
    has_creases: bool,
    /// Where it is a shape repeated without end, or all but that.
    pattern: Option<Arc<Pattern>>,
    distance: Distance,
    bounds: Box3,
    promises: Promises,
    /// Promises about what the value is worth as a distance: nothing rests on them until an operation uses
    /// the distance.
    distance_promises: Promises,
}

impl Field {
    /// All of space, as far as [`Field::bounds`] is concerned.
    pub const EVERYWHERE: Box3 = Box3 { min: [f64::NEG_INFINITY; 3], max: [f64::INFINITY; 3] };

    /// The field of an expression of which nothing is known.
    #[must_use]
    pub fn new(expr: Expr) -> Self {
        Self {
            expr,
            sign: None,
            has_creases: false,
            pattern: None,
            distance: Distance::SIGN,
            bounds: Self::EVERYWHERE,
            promises: Promises::default(),
            distance_promises: Promises::default(),
        }
    }

    /// The field of an expression made of other fields, with what was promised of them.
    pub(super) fn of_parts(expr: Expr, parts: &[&Self]) -> Self {
        let mut field = Self::new(expr);
        for part in parts {
            field.has_creases |= part.has_creases;
            field.promises.extend(&part.promises);
            field.distance_promises.extend(&part.distance_promises);
        }
        field
    }

    /// The same, with the caller's word for what the value is worth as a distance. Proofs rest on it once an
    /// operation uses the distance, such as [`Field::offset`].
    #[must_use]
    pub fn with_distance(mut self, distance: Distance) -> Self {
        if distance != Distance::SIGN {
            let (outside, inside) = (distance.outside.as_str(), distance.inside.as_str());
            let sentence = format!(
                "the value of a given field is worth what is said of it as a distance: outside {outside}, inside {inside}"
            );
            self.distance_promises.add(sentence.into());
        }
        self.known_distance(distance)
    }

    /// The same, with the caller's word that nothing outside of the box is inside the shape.
    ///
    /// Where ranges show that the word holds nothing rests on it any more: they are asked for the sides of
    /// the box, and for those of one that is larger by a 2⁻⁴⁰th of its size, which then is the box, since
    /// ranges are rounded outward. Otherwise it is a promise that [`Field::evidence`] lists. Cost: ranges in
    /// a thousand boxes at most.
    #[must_use]
    pub fn with_bounds(mut self, bounds: Box3) -> Self {
        let tape = Tape::of(self.sign());
        if is_empty_outside(&tape, &bounds) {
            return self.known_bounds(bounds);
        }
        let roomy = with_room(&bounds);
        if is_empty_outside(&tape, &roomy) {
            return self.known_bounds(roomy);
        }
        let Box3 { min, max } = bounds;
        self.promise(format!("nothing of a given field is inside beyond the box from {min:?} to {max:?}"));
        self.known_bounds(bounds)
    }

    /// The same, with the caller's word that `sign` is negative exactly where the value is, and positive
    /// exactly where that is: a promise that [`Field::evidence`] lists.
    ///
    /// A distance often has kinks on the surface itself (that of a box is made of an outer and an inner part
    /// which meet there), where ranges of its gradient say little. An expression that runs smoothly through
    /// 0, such as a maximum of planes, has the same shape, and lets proofs through.
    #[must_use]
    pub fn with_sign(mut self, sign: Expr) -> Self {
        self.promise("the second expression of a given field has the sign of its value everywhere".into());
        self.known_sign(sign)
    }

    /// One more thing that is taken at somebody's word.
    pub(super) fn promise(&mut self, sentence: String) {
        self.promises.add(sentence.into());
    }

    /// The same, for an operation that uses what the value is worth as a distance: from now on proofs rest on
    /// that too.
    pub(super) fn as_distance(&self) -> Self {
        let mut field = self.clone();
        field.promises.extend(&self.distance_promises);
        field
    }

    /// What the value is worth as a distance, where that is known and not promised.
    pub(crate) fn known_distance(self, distance: Distance) -> Self {
        Self { distance, ..self }
    }

    /// A box that holds the shape, where that is known and not promised.
    pub(crate) fn known_bounds(self, bounds: Box3) -> Self {
        Self { bounds, ..self }
    }

    /// Another expression of the same sign, where that is known and not promised.
    pub(crate) fn known_sign(self, sign: Expr) -> Self {
        let has_creases = self.has_creases || sign.is_choice();
        Self { has_creases, ..self.of_sign(sign) }
    }

    /// The same with an expression made of those of the parts, or of the value.
    pub(super) fn of_sign(self, sign: Expr) -> Self {
        Self { sign: Some(sign), ..self }
    }

    /// What a proof about the surface is worth: the weakest of the leaves of [`Field::sign`], and of what was
    /// promised where the field was made. Cost: linear in the distinct parts of the expression.
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
        Tape::of(self.sign()).evidence().weaker(&self.promises.evidence())
    }

    /// An expression that is negative exactly where the value is, for what needs the surface and not the distance:
    /// that of [`Field::with_sign`], else the value's own.
    #[must_use]
    pub fn sign(&self) -> &Expr {
        self.sign.as_ref().unwrap_or(&self.expr)
    }

    /// What it repeats without end, if it does.
    pub(super) fn pattern(&self) -> Option<&Pattern> {
        self.pattern.as_deref()
    }

    pub(super) fn of_pattern(self, pattern: Pattern) -> Self {
        Self { pattern: Some(Arc::new(pattern)), ..self }
    }

    /// An expression with the sign in a box.
    pub(super) fn sign_within(&self, bounds: &Box3) -> Expr {
        let listed = self.pattern().and_then(|pattern| pattern.sign_within(bounds));
        listed.unwrap_or_else(|| self.sign().clone())
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

    /// Whether the sign is that of several primitives, which may meet in creases.
    pub(super) fn has_creases(&self) -> bool {
        self.has_own_sign() && self.has_creases
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

/// The box with room for the rounding of ranges at its sides.
fn with_room(bounds: &Box3) -> Box3 {
    /// Derived: a range of some thousand steps is off by less than 2⁻⁴⁰ of its numbers.
    const ROOM: f64 = 1.0 / (1_u64 << 40) as f64;
    let ends = bounds.min.iter().chain(&bounds.max).map(|x| x.abs()).filter(|x| x.is_finite());
    let room = ROOM * ends.fold(0.0, |most, x| if x > most { x } else { most });
    Box3 { min: bounds.min.map(|x| sub_down(x, room)), max: bounds.max.map(|x| add_up(x, room)) }
}
