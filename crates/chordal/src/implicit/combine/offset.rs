//! Offsets, shells and displacements.
use super::grown;
use crate::implicit::shapes::{InvalidShape, finite, not_negative, positive};
use crate::implicit::{Distance, Expr, Field, Quality};
use crate::math::Box3;

impl Field {
    /// The shape grown by a distance, or shrunk by a negative one: `a − by`.
    ///
    /// Grown from an exact distance it is every point that is nearer than `by`, and exact outside; a bound inside. Shrunk
    /// from an exact distance it is every point deeper than that, and exact inside; a bound outside. From a bound it is
    /// more than the first (within the box grown by as much, corners cut so), or less than the second.
    ///
    /// # Errors
    /// When `by` is not finite, or the value has only a sign on the side that it moves into.
    pub fn offset(&self, by: f64) -> Result<Self, InvalidShape> {
        let by = finite("an offset", by)?;
        if by == 0.0 {
            return Ok(self.clone());
        }
        let Distance { outside, inside } = self.distance();
        if by > 0.0 {
            let held = self.held("an offset")?;
            let inside = weaker(inside, Quality::Bound);
            return Ok(Self::new(held.expr() - by)
                .with_distance(Distance { outside, inside })
                .with_bounds(grown(held.bounds(), by)));
        }
        if inside == Quality::Sign {
            return Err(InvalidShape::NeedsDistance { operation: "an offset", side: "inside" });
        }
        let outside = weaker(outside, Quality::Bound);
        Ok(Self::new(self.expr() - by).with_distance(Distance { outside, inside }).with_bounds(self.bounds()))
    }

    /// A wall around the surface, half of `thickness` to each side of it: `|a| − thickness/2`. Exact outside where the
    /// value was exact on both sides, else a bound.
    ///
    /// # Errors
    /// When the thickness is not a finite number above 0, or the value has only a sign on a side.
    pub fn shell(&self, thickness: f64) -> Result<Self, InvalidShape> {
        let half = 0.5 * positive("a shell's thickness", thickness)?;
        if self.distance().inside == Quality::Sign {
            return Err(InvalidShape::NeedsDistance { operation: "a shell", side: "inside" });
        }
        let held = self.held("a shell")?;
        let distance = Distance { outside: self.distance().weakest(), inside: Quality::Bound };
        Ok(Self::new(held.expr().abs() - half)
            .with_distance(distance)
            .with_bounds(grown(held.bounds(), half)))
    }

    /// The value with an expression added to it, which the caller promises to be at most `amplitude` in size. What is
    /// left is a sign: nothing is known of the expression's slope.
    ///
    /// # Errors
    /// When the amplitude is not a finite number, 0 or above, or the value has only a sign outside.
    pub fn displaced(&self, by: &Expr, amplitude: f64) -> Result<Self, InvalidShape> {
        let amplitude = not_negative("a displacement's amplitude", amplitude)?;
        let held = self.held("a displacement")?;
        Ok(Self::new(held.expr() + by).with_bounds(grown(held.bounds(), amplitude)))
    }

    /// The same shape with a value that is at least the distance to its box, if that is finite: so the box, grown by a
    /// length, holds every point with a value up to it. An exact distance has that already.
    pub(super) fn held(&self, operation: &'static str) -> Result<Self, InvalidShape> {
        match self.distance().outside {
            Quality::Sign => Err(InvalidShape::NeedsDistance { operation, side: "outside" }),
            Quality::Exact => Ok(self.clone()),
            Quality::Bound => {
                let Box3 { min, max } = self.bounds();
                let mut walls = Vec::new();
                for (k, axis) in Expr::axes().iter().enumerate() {
                    if max[k].is_finite() {
                        walls.push(axis - max[k]);
                    }
                    if min[k].is_finite() {
                        walls.push(Expr::constant(min[k]) - axis);
                    }
                }
                let value = walls.iter().fold(self.expr().clone(), |value, wall| value.max(wall));
                // A wall is above the value only where that is not inside, so where it is negative nothing changes …
                let sign = self.sign().clone();
                Ok(Self::new(value).with_sign(sign).with_distance(self.distance()).with_bounds(self.bounds()))
            }
        }
    }
}

fn weaker(a: Quality, b: Quality) -> Quality {
    if a < b { a } else { b }
}
