//! Unions, intersections and differences with rounded seams.
use super::distribute_blend::distribute_blend;
use super::grown;
use crate::implicit::shapes::{InvalidShape, positive};
use crate::implicit::{Distance, DistanceQuality, Expr, Field};

const BLEND: &str = "a blend";

impl Field {
    /// The union with its seam filled: `min(a, b) − h²/(4·radius)` with `h = max(radius − |a − b|, 0)`. It
    /// contains both shapes, extends at most a quarter of `radius` beyond them, and equals their union where
    /// the values differ by at least `radius`.
    ///
    /// The value is a bound, because its gradient is a weighted mean of both gradients. Both values must be
    /// distances or bounds outside.
    ///
    /// # Errors
    /// When the radius is not a finite number above 0, or a field has only a sign outside.
    ///
    /// Source: I. Quilez, *Smooth minimum*; the sign is derived here.
    pub fn smooth_union(&self, other: &Self, radius: f64) -> Result<Self, InvalidShape> {
        let radius = positive("a blend's radius", radius)?;
        let [first, second] = [self, other].map(|field| field.with_box_bound(BLEND));
        let (first, second) = (first?, second?);
        let (a, b) = (first.expr(), second.expr());
        let value = a.smooth_min(b, radius);
        let inside = self.distance().union(other.distance()).inside;
        let bounds = first.bounds().union(second.bounds());
        let blend = Self::from_parts(value, &[&first, &second]);
        // Where a and b differ by `radius`, the blend equals one of them, with its kinks on the surface. For
        // creases there are signs without kinks, and the blend's own surface is moved away from there: by
        // half of the further difference, with a smooth start. The slope of this term is below theirs, so the
        // sum grows with both.
        let start = 0.25 * radius;
        let away = |a: &Expr, b: &Expr| {
            let beyond = (a - b).abs() - (radius + start);
            a.smooth_min(b, radius) - (-beyond).smooth_min(&0.0.into(), start) * 0.5
        };
        let pieces = match distribute_blend(a, b, &away) {
            None if self.has_creases() || other.has_creases() => Some(away(a, b)),
            pieces_or_none => pieces_or_none,
        };
        let blend = match pieces {
            Some(pieces) => blend.replace_sign(self.sign().min(other.sign()).min(&pieces)),
            None => blend,
        };
        Ok(blend
            .known_distance(Distance { outside: DistanceQuality::Bound, inside })
            .known_bounds(grown(bounds, 0.25 * radius)))
    }

    /// The intersection with its edge rounded off: the complement of the [`Field::smooth_union`] of the
    /// complements. Needs distances or bounds inside.
    ///
    /// # Errors
    /// As for [`Field::smooth_union`], with the inside.
    pub fn smooth_intersection(&self, other: &Self, radius: f64) -> Result<Self, InvalidShape> {
        let blend = self
            .complement()
            .smooth_union(&other.complement(), radius)
            .map_err(complement_error)?
            .complement();
        // It only removes points.
        Ok(blend.known_bounds(self.intersection(other).bounds()))
    }

    /// The difference with its edge rounded off: the [`Field::smooth_intersection`] with the complement.
    ///
    /// # Errors
    /// As for [`Field::smooth_union`]: this field's inside and the other's outside are needed.
    pub fn smooth_difference(&self, other: &Self, radius: f64) -> Result<Self, InvalidShape> {
        self.smooth_intersection(&other.complement(), radius)
    }
}

/// The error of a complement.
fn complement_error(error: InvalidShape) -> InvalidShape {
    match error {
        InvalidShape::NeedsDistance { operation, .. } => {
            InvalidShape::NeedsDistance { operation, side: "inside" }
        }
        number => number,
    }
}
