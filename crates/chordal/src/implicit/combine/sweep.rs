//! From planar shapes to solids: extrusion and revolution.
use super::common;
use super::fillet::round_blend;
use super::profile::without_axis;
use super::transform::bounds_at_most;
use crate::implicit::construction::Construction;
use crate::implicit::shapes::{InvalidShape, axis_distance, positive, slabs};
use crate::implicit::{Distance, DistanceQuality, Expr, Field};
use crate::math::{Box3, Interval, add_up, greater, lesser, mul_up, sqrt_up};

impl Field {
    /// A planar shape (one that does not depend on z) extruded to half of `height` above and below 0. The
    /// distance quality of the value stays the same. For a solid, the section at z = 0 is extruded.
    ///
    /// # Errors
    /// When the height is not a finite number above 0.
    ///
    /// ```
    /// use chordal::implicit::shapes::rectangle;
    /// let block = rectangle([2.0, 4.0])?.extruded(6.0)?;
    /// assert_eq!(block.expr().at([4.0, 0.0, 7.0]).unwrap(), 5.0);
    /// # Ok::<(), chordal::implicit::shapes::InvalidShape>(())
    /// ```
    pub fn extruded(&self, height: f64) -> Result<Self, InvalidShape> {
        let half = 0.5 * positive("a height", height)?;
        let [x, y, z] = Expr::axes();
        let flat = self.at(&[x, y, Expr::constant(0.0)]);
        let cap = z.abs() - half;
        let value = slabs(&[flat.expr().clone(), cap.clone()]);
        let slab = Box3 {
            min: [f64::NEG_INFINITY, f64::NEG_INFINITY, -half],
            max: [f64::INFINITY, f64::INFINITY, half],
        };
        let Box3 { min, max } = self.bounds();
        let endless = Box3 { min: [min[0], min[1], f64::NEG_INFINITY], max: [max[0], max[1], f64::INFINITY] };
        Ok(Self::from_parts(value, &[self])
            .known_sign(flat.sign().max(&cap))
            .with_depth(flat.depth().is_some())
            .known_distance(slice_distance(self))
            .known_bounds(common(endless, slab))
            .known_construction(self.construction().and_then(|solids| solids.extruded(half)))
            .known_slack(self.slice_slack()))
    }

    /// The slack of its section at z = 0: unknown for a solid, whose surface may be flat there.
    fn slice_slack(&self) -> f64 {
        if self.slack() > 0.0 && self.tape().axes()[2] { f64::INFINITY } else { self.slack() }
    }

    /// Like [`Field::extruded`], with the edges of both ends cut off at 45°, `bevel` wide and high: over a
    /// point with a depth below `bevel` in the planar shape, the solid ends `bevel − depth` before the plane
    /// of the end.
    ///
    /// The depth is the shape's value. If that is only a bound, the cut may be wider by the difference
    /// between the distance and the bound. The result's value is a bound.
    ///
    /// # Errors
    /// When the height or the bevel is not a finite number above 0, the bevel not less than half of the
    /// height, or the value only a sign inside.
    ///
    /// ```
    /// use chordal::implicit::shapes::rectangle;
    /// let tile = rectangle([4.0, 4.0])?.extruded_with_bevel(2.0, 0.5)?;
    /// assert!(tile.expr().at([1.7, 0.0, 0.7]).unwrap() < 0.0);
    /// assert!(tile.expr().at([1.8, 0.0, 0.8]).unwrap() > 0.0);
    /// # Ok::<(), chordal::implicit::shapes::InvalidShape>(())
    /// ```
    pub fn extruded_with_bevel(&self, height: f64, bevel: f64) -> Result<Self, InvalidShape> {
        let (plain, [depth, below]) = self.extruded_with_depths(height, ("a bevel", bevel))?;
        // The shape's value and |z| each grow by at most 1 per unit of length, in perpendicular directions:
        // the sum by √2.
        let cut = depth + below + bevel;
        let scaled = &cut * std::f64::consts::FRAC_1_SQRT_2.next_down();
        // At 45° a larger depth raises and widens the solid by the same amount: √2 in total.
        let slack = plain.slack();
        let slack = if slack == 0.0 { 0.0 } else { mul_up(slack, std::f64::consts::SQRT_2.next_up()) };
        Ok(self.with_edges_cut(&plain, [&scaled, &cut]).known_slack(slack))
    }

    /// Like [`Field::extruded`], with the edges of both ends rounded to a radius: over a point with a depth
    /// below the radius in the planar shape, the solid ends on a quarter of a circle, which touches the side
    /// and the plane of the end.
    ///
    /// The depth is the shape's value, as for [`Field::extruded_with_bevel`], and the result's value is a
    /// bound. If the shape is narrower than twice the radius, the rounded edges meet in a ridge.
    ///
    /// # Errors
    /// As for [`Field::extruded_with_bevel`], with the radius in place of the bevel.
    ///
    /// ```
    /// use chordal::implicit::shapes::rectangle;
    /// let tile = rectangle([4.0, 4.0])?.extruded_with_round_edges(2.0, 0.5)?;
    /// // On the circle around (1.5, 0.5), and off it.
    /// assert!(tile.expr().at([1.85, 0.0, 0.85]).unwrap() < 0.0);
    /// assert!(tile.expr().at([1.86, 0.0, 0.86]).unwrap() > 0.0);
    /// # Ok::<(), chordal::implicit::shapes::InvalidShape>(())
    /// ```
    pub fn extruded_with_round_edges(&self, height: f64, radius: f64) -> Result<Self, InvalidShape> {
        let named = ("a rounded edge's radius", radius);
        let (plain, [depth, below]) = self.extruded_with_depths(height, named)?;
        let cut = -round_blend(&-depth, &-below, radius);
        Ok(self.with_edges_cut(&plain, [&cut, &cut]))
    }

    /// The plain extrusion, the value of the planar shape, and that of the planes of both ends, if a width is
    /// below half of the height and the value measures depth.
    fn extruded_with_depths(
        &self,
        height: f64,
        (name, width): (&'static str, f64),
    ) -> Result<(Self, [Expr; 2]), InvalidShape> {
        let half = 0.5 * positive("a height", height)?;
        let width = positive(name, width)?;
        if width >= half {
            return Err(InvalidShape::Number(format!(
                "{name} is {width}, and must be less than half of the height, {half}"
            )));
        }
        if self.distance().inside == DistanceQuality::Sign {
            return Err(InvalidShape::NeedsDistance { operation: name, side: "inside" });
        }
        let [x, y, z] = Expr::axes();
        let flat = self.at(&[x, y, Expr::constant(0.0)]);
        Ok((self.extruded(height)?, [flat.expr().clone(), z.abs() - half]))
    }

    /// The plain extrusion, minus the points where a value, or its sign expression, is above 0: the cut
    /// edges.
    fn with_edges_cut(&self, plain: &Self, [value, sign]: [&Expr; 2]) -> Self {
        let weak = |quality: DistanceQuality| lesser(quality, DistanceQuality::Bound);
        let Distance { outside, inside } = slice_distance(self);
        Self::from_parts(plain.expr().max(value), &[self])
            .known_sign(plain.sign().max(sign))
            .known_distance(Distance { outside: weak(outside), inside: weak(inside) })
            .known_bounds(plain.bounds())
    }

    /// A planar shape revolved about its y axis, which becomes the z axis: the point (x, y) becomes the
    /// circle of radius x at the height y. Points at negative x have no effect.
    ///
    /// If the profile ends at the axis only, by a side of a polygon or of a rectangle, that side is no
    /// boundary of the solid: the solid contains the axis, although the profile does not.
    ///
    /// Exact distances stay exact if the shape's box does not touch the axis. If it touches, the value is
    /// exact only outside; if it crosses, it is a bound.
    #[must_use]
    pub fn revolved(&self) -> Self {
        let [x, y, z] = Expr::axes();
        let zero = Expr::constant(0.0);
        let profile = without_axis(self.sign());
        // If the profile has no separate sign expression, its leaf serves for both.
        let value = if self.has_own_sign() { self.expr() } else { &profile };
        let value = value.with_axes([(x.square() + y.square()).sqrt(), z.clone(), zero.clone()]);
        let sign = profile.with_axes([axis_distance(), z, zero]);
        let Box3 { min, max } = self.bounds();
        let weak = |q: DistanceQuality| lesser(q, DistanceQuality::Bound);
        let Distance { outside, inside } = slice_distance(self);
        // What lies beyond the axis is cut off, and a side on the axis is none of the solid: there the
        // profile's distance may be less than the solid's.
        let distance = Distance {
            outside: if min[0] >= 0.0 { outside } else { weak(outside) },
            inside: if min[0] > 0.0 { inside } else { weak(inside) },
        };
        let bounds = if self.bounds().is_empty() || max[0] < 0.0 {
            Box3::EMPTY
        } else {
            Box3 { min: [-max[0], -max[0], min[1]], max: [max[0], max[0], max[1]] }
        };
        let turned = Self::from_parts(value, &[self]);
        turned
            .known_sign(sign)
            .known_distance(distance)
            .known_bounds(bounds)
            .known_construction(self.construction().and_then(Construction::revolved))
            .known_slack(if min[0] >= 0.0 || self.slack() == 0.0 {
                self.slice_slack()
            } else {
                f64::INFINITY
            })
    }
}

/// The distance quality in the plane z = 0: a solid's value is only a bound there.
fn slice_distance(field: &Field) -> Distance {
    if field.tape().axes()[2] { bounds_at_most(field.distance()) } else { field.distance() }
}

/// The largest distance of a box from the z axis, rounded up.
pub(super) fn farthest(bounds: &Box3) -> f64 {
    let side = |k: usize| {
        let (low, high) = (bounds.min[k].abs(), bounds.max[k].abs());
        greater(low, high)
    };
    let [x, y] = [side(0), side(1)].map(|s| Interval::new(0.0, s).unwrap_or(Interval::ENTIRE));
    add_up(sqrt_up((x.square() + y.square()).hi()), 0.0)
}
