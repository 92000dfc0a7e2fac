//! `BvhFrame`: the coordinates of the boxes of a [`Bvh`](super::Bvh).
use crate::math::{Box3, exponent, greater, power_of_two, sub_down, sub_up};

/// World → scaled: times a power of two, which changes no digit. Scaled → local: minus the middle of the
/// mesh. In local coordinates the mesh lies within `[−1, 1]³`, for any position and scale.
#[derive(Clone, Copy, Debug)]
pub(super) struct BvhFrame {
    /// A power of two.
    pub scale: f64,
    /// The middle of the mesh in scaled coordinates.
    pub middle: [f64; 3],
}

impl BvhFrame {
    /// The frame of a mesh within `bounds`, which are not empty.
    pub fn from_bounds(bounds: &Box3) -> Self {
        // Halved before the difference, which might overflow otherwise.
        let half = (0..3).map(|k| 0.5 * bounds.max[k] - 0.5 * bounds.min[k]);
        let centre = bounds.centre();
        // For a mesh without extent, use the rounding of its position, so that scaled coordinates stay
        // finite.
        let rounding = centre.iter().map(|c| c.abs() * f64::EPSILON);
        let extent = half.chain(rounding).fold(0.0, |largest, x| greater(x, largest));
        // Beyond 2^±900 a scale and its inverse leave no range for distances larger or smaller than the mesh.
        let scale = power_of_two(-(exponent(extent) + 1).clamp(-900, 900));
        Self { scale, middle: centre.map(|c| c * scale) }
    }

    /// The exact product with a power of two.
    #[inline]
    pub fn scaled(&self, p: [f64; 3]) -> [f64; 3] {
        p.map(|x| x * self.scale)
    }

    /// Lower and upper bounds for the local coordinates of a scaled point.
    #[inline]
    pub fn local(&self, scaled: [f64; 3]) -> [[f64; 3]; 2] {
        [
            std::array::from_fn(|k| sub_down(scaled[k], self.middle[k])),
            std::array::from_fn(|k| sub_up(scaled[k], self.middle[k])),
        ]
    }
}

/// A box in local f32 coordinates: low, high.
pub(super) type LocalBox = [[f32; 3]; 2];

/// The largest f32 that is at most `x`.
#[inline]
pub(super) fn down(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) > x { near.next_down() } else { near }
}

/// The smallest f32 that is at least `x`.
#[inline]
pub(super) fn up(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x { near.next_up() } else { near }
}
