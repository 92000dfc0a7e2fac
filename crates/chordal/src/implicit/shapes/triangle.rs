//! A thickened triangle: all points near it.
use super::{InvalidShape, finite_point, positive};
use crate::budget::Evidence;
use crate::implicit::{Distance, Expr, Field, Leaf, LeafAnswer, LeafError, Lipschitz};
use crate::math::{Box3, Interval, add_up, cross, difference, dot, greater, length, lesser, sub_down};
use std::sync::Arc;

/// All points nearer than half of `thickness` to the triangle with these corners. The value is the exact
/// distance up to rounding; for nearly collinear corners it is as accurate as their area.
///
/// # Errors
/// When a coordinate is not a finite number below 1e100, or the thickness not a finite number above 0.
pub fn triangle(corners: [[f64; 3]; 3], thickness: f64) -> Result<Field, InvalidShape> {
    for p in corners {
        finite_point("a triangle's corner", p)?;
        // Defined: products of four differences stay finite.
        if let Some(x) = p.iter().find(|x| x.abs() >= 1e100) {
            return Err(InvalidShape::Number(format!(
                "a triangle's coordinate is {x}, and must be below 1e100"
            )));
        }
    }
    let radius = 0.5 * positive("a triangle's thickness", thickness)?;
    let around = Box3::from_points(&corners);
    let bounds = Box3 {
        min: around.min.map(|x| sub_down(x, add_up(radius, f64::EPSILON * x.abs()))),
        max: around.max.map(|x| add_up(x, add_up(radius, f64::EPSILON * x.abs()))),
    };
    let largest = corners.iter().flatten().fold(0.0, |m: f64, x| greater(x.abs(), m));
    let leaf = Arc::new(TriangleDistance { corners, largest });
    let field = Field::new(Expr::leaf(leaf, Expr::axes()) - radius);
    Ok(field.known_distance(Distance::EXACT).known_bounds(bounds))
}

/// The distance to a triangle.
#[derive(Clone, Copy, Debug)]
struct TriangleDistance {
    corners: [[f64; 3]; 3],
    largest: f64,
}

impl TriangleDistance {
    /// `p` minus its closest point: the projection to the plane if that is in the triangle, otherwise the
    /// closest point of the edges.
    fn offset(&self, p: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = self.corners;
        let normal = cross(difference(b, a), difference(c, a));
        let square = dot(normal, normal);
        let within = |from: [f64; 3], to: [f64; 3]| {
            dot(cross(normal, difference(to, from)), difference(p, from)) > 0.0
        };
        if square > 0.0 && within(a, b) && within(b, c) && within(c, a) {
            let height = dot(difference(p, a), normal) / square;
            return normal.map(|x| x * height);
        }
        let edges = [[a, b], [b, c], [c, a]].map(|[from, to]| {
            let along = difference(to, from);
            let t = dot(difference(p, from), along) / dot(along, along);
            // NaN, for an edge without length, is not above 0.
            let t = if t > 0.0 { lesser(t, 1.0) } else { 0.0 };
            let offset: [f64; 3] = std::array::from_fn(|k| (p[k] - from[k]) - t * along[k]);
            (dot(offset, offset), offset)
        });
        edges.into_iter().reduce(|l, r| if r.0 < l.0 { r } else { l }).map_or(p, |closest| closest.1)
    }

    /// An upper bound on the rounding of [`Self::offset`] near `p`. If rounding puts a projection wrongly
    /// inside, the plane is used instead of an edge; that error grows as the triangle gets thinner (`thin`).
    fn rounding(&self, p: [f64; 3]) -> f64 {
        let [a, b, c] = self.corners;
        let (e, f) = (difference(b, a), difference(c, a));
        let size = p.iter().fold(self.largest, |m, x| greater(x.abs(), m));
        let thin = (length(e) + length(f)) * (length(e) + length(f)) / length(cross(e, f));
        // A flat triangle uses its edges alone.
        let thin = if thin.is_finite() { thin } else { 1.0 };
        add_up(256.0 * f64::EPSILON * size * thin, f64::MIN_POSITIVE)
    }
}

impl Leaf for TriangleDistance {
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        points.iter().zip(out).for_each(|(p, value)| *value = length(self.offset(*p)));
        Ok(())
    }

    fn gradient_at(&self, points: &[[f64; 3]], out: &mut [[f64; 3]]) -> Result<LeafAnswer, LeafError> {
        for (p, gradient) in points.iter().zip(out) {
            let offset = self.offset(*p);
            let length = length(offset);
            *gradient = offset.map(|x| if length > 0.0 { x / length } else { 0.0 });
        }
        Ok(LeafAnswer::Given)
    }

    fn over(&self, boxes: &[Box3], out: &mut [Interval]) -> Result<LeafAnswer, LeafError> {
        for (bounds, range) in boxes.iter().zip(out) {
            let (middle, error) = self.middle_and_error(bounds);
            let value = length(self.offset(middle));
            *range = Interval::new(sub_down(value, error), add_up(value, error)).unwrap_or(Interval::ENTIRE);
        }
        Ok(LeafAnswer::Given)
    }

    /// The offset from the closest point of a convex set is 1-Lipschitz.
    fn gradient_over(&self, boxes: &[Box3], out: &mut [[Interval; 3]]) -> Result<LeafAnswer, LeafError> {
        for (bounds, gradient) in boxes.iter().zip(out) {
            let (middle, error) = self.middle_and_error(bounds);
            let offset = self.offset(middle);
            let around =
                |x: f64| Interval::new(sub_down(x, error), add_up(x, error)).unwrap_or(Interval::ENTIRE);
            let unit = Interval::new(-1.0, 1.0).unwrap_or(Interval::ENTIRE);
            let size = around(length(offset));
            *gradient =
                offset.map(|x| if size.lo() > 0.0 { (around(x) / size).intersection(unit) } else { unit });
        }
        Ok(LeafAnswer::Given)
    }

    fn lipschitz(&self) -> Option<Lipschitz> {
        Some(Lipschitz { constant: 1.0, error: self.rounding([self.largest; 3]) })
    }

    fn evidence(&self) -> Evidence {
        Evidence::Proved
    }
}

impl TriangleDistance {
    /// The middle of a box, and a bound on the distance between the offsets of its points and the computed
    /// offset of the middle.
    fn middle_and_error(&self, bounds: &Box3) -> ([f64; 3], f64) {
        let middle = bounds.centre();
        let size = middle.iter().fold(0.0, |sum, x| sum + x.abs());
        // Includes the rounding of the middle.
        (middle, add_up(0.5 * bounds.diagonal(), add_up(self.rounding(middle), f64::EPSILON * size)))
    }
}
