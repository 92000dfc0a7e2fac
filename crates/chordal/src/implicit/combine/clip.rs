//! Shapes clipped to a box.
use super::common;
use crate::implicit::construction::{Construction, SolidForm};
use crate::implicit::{Expr, Field};
use crate::math::Box3;

impl Field {
    /// The part of the shape within a box, closed by the sides of the box that it may reach. The value
    /// becomes only a sign. Along infinite sides of the box the shape is not cut.
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

    /// [`Field::clipped`] along x and y alone: for a planar shape, which stays planar. Its bounds are still
    /// clipped along z.
    #[must_use]
    pub fn cropped(&self, region: Box3) -> Self {
        self.within(region, 2)
    }

    /// Clips along the first `axes` axes.
    fn within(&self, region: Box3, axes: usize) -> Self {
        let bounds = self.bounds();
        let mut sign = self.sign().clone();
        let mut sides = Vec::new();
        let mut side = |axis: usize, direction: f64, offset: f64| {
            let normal = std::array::from_fn(|k| if k == axis { direction } else { 0.0 });
            sides.extend(Construction::solid(SolidForm::HalfSpace { normal, offset }));
        };
        for (k, axis) in Expr::axes().iter().enumerate().take(axes) {
            // The field comes second: where it is undefined, so is the result, which counts as outside.
            if region.min[k] > bounds.min[k] {
                sign = (Expr::constant(region.min[k]) - axis).max(&sign);
                side(k, -1.0, -region.min[k]);
            }
            if region.max[k] < bounds.max[k] {
                sign = (axis - region.max[k]).max(&sign);
                side(k, 1.0, region.max[k]);
            }
        }
        // The value no longer bounds the distance.
        let construction = self.construction().and_then(|solids| solids.clipped(sides));
        let clipped = Self::from_parts(sign, &[self]).known_bounds(common(bounds, region));
        clipped.known_construction(construction).known_slack(self.slack())
    }
}
