//! Offsets, shells and displacements.
use super::grown;
use crate::implicit::outside::{is_empty_outside, lowest};
use crate::implicit::shapes::{InvalidShape, finite, not_negative, positive};
use crate::implicit::{Distance, DistanceQuality, Expr, Field, Tape};
use crate::math::Box3;

/// The share by which the lowest value of a range may be below the exact one. Derived: a few hundred
/// operations, each rounded by a unit, are off by less than 2⁻⁴⁰.
const ROUNDED: f64 = 1.0 / (1_u64 << 40) as f64;

impl Field {
    /// The shape grown by a distance, or shrunk by a negative one: `a − by`.
    ///
    /// Grown from an exact distance it is every point that is nearer than `by`, and exact outside; a bound
    /// inside. Shrunk from an exact distance it is every point deeper than that, and exact inside; a bound
    /// outside. From a bound it is more than the first (within the box grown by as much, corners cut so), or
    /// less than the second.
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
            let held = self.with_box_bound("an offset")?;
            let inside = weaker(inside, DistanceQuality::Bound);
            return Ok(Self::from_parts(held.expr() - by, &[&held])
                .known_distance(Distance { outside, inside })
                .known_bounds(grown(held.bounds(), by)));
        }
        if inside == DistanceQuality::Sign {
            return Err(InvalidShape::NeedsDistance { operation: "an offset", side: "inside" });
        }
        let outside = weaker(outside, DistanceQuality::Bound);
        Ok(Self::from_parts(self.expr() - by, &[self])
            .known_distance(Distance { outside, inside })
            .known_bounds(self.bounds()))
    }

    /// A wall around the surface, half of `thickness` to each side of it: `|a| − thickness/2`. Exact outside
    /// where the value was exact on both sides, else a bound.
    ///
    /// # Errors
    /// When the thickness is not a finite number above 0, or the value has only a sign on a side.
    pub fn shell(&self, thickness: f64) -> Result<Self, InvalidShape> {
        let half = 0.5 * positive("a shell's thickness", thickness)?;
        if self.distance().inside == DistanceQuality::Sign {
            return Err(InvalidShape::NeedsDistance { operation: "a shell", side: "inside" });
        }
        let held = self.with_box_bound("a shell")?;
        let distance = Distance { outside: self.distance().weakest(), inside: DistanceQuality::Bound };
        Ok(Self::from_parts(held.expr().abs() - half, &[&held])
            .known_distance(distance)
            .known_bounds(grown(held.bounds(), half)))
    }

    /// The value with an expression added to it, which takes off at most `amplitude` anywhere. What is left
    /// is a sign: nothing is known of the expression's slope.
    ///
    /// The amplitude is checked where ranges can: for the expression over all of space, and for the whole
    /// shape outside of its box. Where the expression is found to reach deeper than `amplitude` the box is as
    /// large as it needs to be. Where ranges say nothing (an expression without a lowest value, a user's
    /// function) the amplitude is a promise, which [`Field::evidence`] lists.
    ///
    /// # Errors
    /// When the amplitude is not a finite number, 0 or above, or the value has only a sign outside.
    ///
    /// ```
    /// use chordal::budget::Evidence;
    /// use chordal::implicit::{Expr, shapes::sphere};
    /// let [x, ..] = Expr::axes();
    /// let waves = sphere(1.0)?.displaced(&((x * 9.0).sin() * 0.5), 0.1)?; // five times more than was said
    /// assert_eq!(waves.evidence(), Evidence::Proved);
    /// assert!(waves.bounds().max[0] >= 1.5);
    /// # Ok::<(), chordal::implicit::shapes::InvalidShape>(())
    /// ```
    pub fn displaced(&self, by: &Expr, amplitude: f64) -> Result<Self, InvalidShape> {
        let amplitude = not_negative("a displacement's amplitude", amplitude)?;
        let held = self.with_box_bound("a displacement")?;
        let mut displaced = Self::from_parts(held.expr() + by, &[&held]);
        // Outside of the box by as much the value was that much at least.
        let within = |depth: f64| grown(held.bounds(), depth);
        let depth = lowest(&Tape::new(by)).map(|low| if low < 0.0 { -low } else { 0.0 });
        // Ranges are rounded outward: half a unit beyond the amplitude is no other depth.
        let deeper = |depth: f64| depth > amplitude * (1.0 + ROUNDED);
        match depth {
            Some(depth) if !deeper(depth) => {
                let depth = if depth > amplitude { depth } else { amplitude };
                Ok(displaced.known_bounds(within(depth)))
            }
            _ if is_empty_outside(&displaced.tape(), &within(amplitude)) => {
                Ok(displaced.known_bounds(within(amplitude)))
            }
            Some(depth) => Ok(displaced.known_bounds(within(depth))),
            None => {
                displaced
                    .promise(format!("a displacement takes off no more than its amplitude, {amplitude}"));
                Ok(displaced.known_bounds(within(amplitude)))
            }
        }
    }

    /// The same shape with a value that is at least the distance to its box, if that is finite: so the box,
    /// grown by a length, holds every point with a value up to it. An exact distance has that already.
    pub(super) fn with_box_bound(&self, operation: &'static str) -> Result<Self, InvalidShape> {
        match self.distance().outside {
            DistanceQuality::Sign => Err(InvalidShape::NeedsDistance { operation, side: "outside" }),
            DistanceQuality::Exact => Ok(self.as_distance()),
            DistanceQuality::Bound => {
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
                // A wall is above the value only where that is not inside, so where it is negative nothing
                // changes …
                let sign = self.sign().clone();
                Ok(Self::from_parts(value, &[&self.as_distance()])
                    .known_sign(sign)
                    .known_distance(self.distance())
                    .known_bounds(self.bounds()))
            }
        }
    }
}

fn weaker(a: DistanceQuality, b: DistanceQuality) -> DistanceQuality {
    if a < b { a } else { b }
}
