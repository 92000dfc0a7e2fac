//! Twisted and bent shapes: turned about z by an angle that grows along an axis.
use super::sweep::farthest;
use super::transform::bounds_at_most;
use crate::implicit::shapes::{InvalidShape, finite};
use crate::implicit::{Distance, Expr, Field};
use crate::math::{Box3, add_up, mul_up, sqrt_up};

impl Field {
    /// The shape twisted about the z axis: turned by `radians` more per unit of height.
    ///
    /// The value is a bound if the shape's box is finite around the axis. It is divided by the largest
    /// stretch of the twist within the box's distance from the axis; points farther away take the value of
    /// the nearest point at that distance. Otherwise the value is only a sign.
    ///
    /// # Errors
    /// When the number is not finite.
    pub fn twisted(&self, radians: f64) -> Result<Self, InvalidShape> {
        let radians = finite("a twist", radians)?;
        let construction = self.construction().and_then(|solids| solids.twisted(radians));
        Ok(self.turning(2, radians).known_construction(construction))
    }

    /// The shape bent: turned about the z axis by `radians` more per unit along x, so that a rod along x
    /// becomes a spiral. Its distance quality is as for [`Field::twisted`].
    ///
    /// # Errors
    /// When the number is not finite.
    pub fn bent(&self, radians: f64) -> Result<Self, InvalidShape> {
        let radians = finite("a bend", radians)?;
        Ok(self.turning(0, radians))
    }

    /// Points turned back by `radians` times a coordinate.
    fn turning(&self, axis: usize, radians: f64) -> Self {
        if radians == 0.0 {
            return self.clone();
        }
        let back = |[x, y, z]: [Expr; 3], angle: Expr| {
            let (sin, cos) = (Expr::sin(&angle), Expr::cos(&angle));
            [&cos * &x + &sin * &y, &cos * &y - &sin * &x, z]
        };
        let axes = Expr::axes();
        let plain = self.at(&back(axes.clone(), &axes[axis] * radians));
        let reach = farthest(&self.bounds());
        let Box3 { min, max } = self.bounds();
        let bounds = if self.bounds().is_empty() {
            Box3::EMPTY
        } else {
            Box3 { min: [-reach, -reach, min[2]], max: [reach, reach, max[2]] }
        };
        if !reach.is_finite() || reach == 0.0 || self.bounds().is_empty() {
            return plain.known_distance(Distance::SIGN).known_bounds(bounds);
        }
        // Just beyond the box, where there is no point of the shape. A twist keeps the distance of points
        // from the axis.
        let rim = add_up(reach, mul_up(reach, 1.0 / 1024.0));
        // A turn by an angle of slope k stretches, at a distance r from the axis, by at most (kr + √(k²r² +
        // 4))/2 if the angle grows along the axis itself, and by at most 1 + kr in any direction.
        let pull = mul_up(radians.abs(), rim);
        let stretch = if axis == 2 {
            0.5 * add_up(pull, sqrt_up(add_up(mul_up(pull, pull), 4.0)))
        } else {
            add_up(1.0, pull)
        };
        let [x, y, z] = axes.clone();
        let from_axis = (x.square() + y.square()).sqrt();
        let share = Expr::constant(rim) / from_axis.max(&rim.into());
        let onto = [x * &share, y * &share, z];
        let angle = &onto[axis] * radians;
        // The projection to the rim brings a point no farther from any point inside it, so the value stays a
        // bound.
        let near = self.at(&back(onto, angle));
        let value = (near.expr() / stretch).max(&(from_axis - rim));
        Self::from_parts(value, &[self])
            .known_sign(plain.sign().clone())
            .known_distance(bounds_at_most(self.distance()))
            .known_bounds(bounds)
    }
}
