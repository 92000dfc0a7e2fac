//! A shape cut off at a box.
use super::common;
use crate::implicit::{Expr, Field};
use crate::math::Box3;

impl Field {
    /// The part of the shape within a box, closed by the sides of the box that it may reach. What is left of
    /// the value is a sign. With a box that has no end the shape stays as it is there.
    ///
    /// ```
    /// use chordal::implicit::{Expr, Field};
    /// use chordal::math::Box3;
    /// let [x, ..] = Expr::axes();
    /// let cube = Box3 { min: [-1.0; 3], max: [1.0; 3] };
    /// let half = Field::new(x).clipped(cube);
    /// assert_eq!(half.bounds().max, [1.0; 3]);
    /// assert!(half.expr().at([-2.0, 0.0, 0.0]).unwrap() > 0.0);
    /// assert!(half.expr().at([-0.5, 0.0, 2.0]).unwrap() > 0.0);
    /// ```
    #[must_use]
    pub fn clipped(&self, region: Box3) -> Self {
        self.within(region, 3)
    }

    /// [`Field::clipped`] along x and y alone: for a shape of the plane, which stays one. Its box ends along
    /// z as the region does.
    #[must_use]
    pub fn cropped(&self, region: Box3) -> Self {
        self.within(region, 2)
    }

    /// Cut off along so many axes.
    fn within(&self, region: Box3, axes: usize) -> Self {
        let known = self.bounds();
        let mut sign = self.sign().clone();
        for (k, axis) in Expr::axes().iter().enumerate().take(axes) {
            // The field comes second, so that where it has no value there is none, which is outside.
            if region.min[k] > known.min[k] {
                sign = (Expr::constant(region.min[k]) - axis).max(&sign);
            }
            if region.max[k] < known.max[k] {
                sign = (axis - region.max[k]).max(&sign);
            }
        }
        // What the value was worth as a distance is not asked of it any more.
        Self::from_parts(sign, &[self]).known_bounds(common(known, region))
    }
}
