//! Offsets, shells and displacements.
use super::grown;
use crate::implicit::outside::{is_empty_outside, lowest};
use crate::implicit::shapes::{InvalidShape, finite, not_negative, positive};
use crate::implicit::{Distance, DistanceQuality, Expr, Field, Tape};
use crate::math::{Box3, greater, lesser};

/// The fraction by which the lowest value of an interval may be below the exact one. Derived: a few hundred
/// operations, each rounded by a unit, are off by less than 2⁻⁴⁰.
const ROUNDED: f64 = 1.0 / (1_u64 << 40) as f64;

impl Field {
    /// The shape grown by a distance, or shrunk by a negative one: `a − by`.
    ///
    /// Grown from an exact distance, it is every point nearer than `by`: exact outside, a bound inside.
    /// Shrunk from an exact distance, it is every point deeper than `-by`: exact inside, a bound outside.
    /// From a bound, the grown shape contains these points (within the box grown by as much, so corners are
    /// cut), and the shrunk shape is contained in them.
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
            let limited = self.with_box_bound("an offset")?;
            let slack = self.slack_of_distance(outside);
            // If the value is less than the distance, the grown shape may also end at the box.
            let solids = self.construction().filter(|_| outside == DistanceQuality::Exact);
            let inside = weaker(inside, DistanceQuality::Bound);
            return Ok(Self::from_parts(limited.expr() - by, &[&limited])
                .known_distance(Distance { outside, inside })
                .known_bounds(grown(limited.bounds(), by))
                .known_construction(solids.and_then(|solids| solids.offset(by)))
                .known_slack(slack));
        }
        if inside == DistanceQuality::Sign {
            return Err(InvalidShape::NeedsDistance { operation: "an offset", side: "inside" });
        }
        let outside = weaker(outside, DistanceQuality::Bound);
        let slack = self.slack_of_distance(inside);
        let shrunk = Self::from_parts(self.expr() - by, &[self]).known_slack(slack);
        // The value has kinks where the nearest side changes; the planes of a box have none.
        let shrunk = match self.depth() {
            Some(depth) if self.has_own_sign() => shrunk.known_depth(depth - by),
            _ => shrunk,
        };
        let construction = self.construction().and_then(|solids| solids.offset(by));
        let shrunk = shrunk.known_construction(construction);
        Ok(shrunk.known_distance(Distance { outside, inside }).known_bounds(self.bounds()))
    }

    /// The slack of an offset: along an exact distance, a surface moves by the same length as that of the
    /// ideal shape.
    fn slack_of_distance(&self, quality: DistanceQuality) -> f64 {
        if quality == DistanceQuality::Exact || self.slack() == 0.0 { self.slack() } else { f64::INFINITY }
    }

    /// A wall around the surface, with half of `thickness` on each side of it: `|a| − thickness/2`. The value
    /// is exact outside if it was exact on both sides, otherwise a bound.
    ///
    /// # Errors
    /// When the thickness is not a finite number above 0, or the value has only a sign on a side.
    pub fn shell(&self, thickness: f64) -> Result<Self, InvalidShape> {
        let half = 0.5 * positive("a shell's thickness", thickness)?;
        if self.distance().inside == DistanceQuality::Sign {
            return Err(InvalidShape::NeedsDistance { operation: "a shell", side: "inside" });
        }
        let limited = self.with_box_bound("a shell")?;
        let distance = Distance { outside: self.distance().weakest(), inside: DistanceQuality::Bound };
        let slack = self.slack_of_distance(self.distance().weakest());
        let wall = Self::from_parts(limited.expr().abs() - half, &[&limited]).known_slack(slack);
        // Within half of the thickness outside, and no deeper than that inside.
        let wall = match limited.depth() {
            Some(depth) if limited.has_own_sign() => {
                wall.known_sign((limited.expr() - half).max(&(-depth - half)))
            }
            _ => wall,
        };
        Ok(wall.known_distance(distance).known_bounds(grown(limited.bounds(), half)))
    }

    /// The value plus an expression that lowers it by at most `amplitude` anywhere. The result is only a
    /// sign, because the expression's slope is unknown.
    ///
    /// Interval arithmetic checks the amplitude where possible: for the expression over all of space, and for
    /// the displaced shape outside of its box. If the expression reaches deeper than `amplitude`, the box
    /// grows as needed. If intervals prove nothing (an expression without a lowest value, a user's function),
    /// the amplitude is a promise, which [`Field::evidence`] lists.
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
        let limited = self.with_box_bound("a displacement")?;
        let mut displaced = Self::from_parts(limited.expr() + by, &[&limited]);
        // Outside the box grown by a depth, the value was at least that depth.
        let within = |depth: f64| grown(limited.bounds(), depth);
        let depth = lowest(&Tape::new(by)).map(|low| if low < 0.0 { -low } else { 0.0 });
        // Intervals are rounded outward: half a unit beyond the amplitude does not count as deeper.
        let deeper = |depth: f64| depth > amplitude * (1.0 + ROUNDED);
        match depth {
            Some(depth) if !deeper(depth) => {
                let depth = greater(depth, amplitude);
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

    /// The same shape with a value that is at least the distance to its box, if that is finite. So the box
    /// grown by a length contains every point with a value up to that length. An exact distance is so
    /// already.
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
                // A wall exceeds the value only outside the shape, so negative values do not change.
                let sign = self.sign().clone();
                Ok(Self::from_parts(value, &[&self.as_distance()])
                    .known_sign(sign)
                    .with_depth(self.depth().is_some())
                    .known_distance(self.distance())
                    .known_bounds(self.bounds()))
            }
        }
    }
}

fn weaker(a: DistanceQuality, b: DistanceQuality) -> DistanceQuality {
    lesser(a, b)
}
