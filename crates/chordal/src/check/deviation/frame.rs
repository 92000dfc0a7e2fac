//! `DeviationFrame`: coordinates in which two meshes lie around zero with an extent near 1, and a bound on
//! the rounding of the transform.
use crate::explicit::Mesh;
use crate::math::{
    Box3, DoubleDouble, add_down, add_up, div_down, div_up, greater, lesser, mul_up, sqrt_up, sub_down,
};
use std::borrow::Cow;

/// World to local coordinates: subtract the origin, multiply by a power of two.
#[derive(Clone, Copy, Debug)]
pub(super) struct DeviationFrame {
    origin: [f64; 3],
    scale: f64,
}

/// Exponents of extents for which squares and products of four lengths stay far inside the range of f64.
const EXPONENTS: std::ops::RangeInclusive<i32> = -100..=100;

/// A coordinate larger than this multiple of the extent loses digits by its position alone. Chosen: a larger
/// value loses more digits, a smaller one shifts, and so rounds, more meshes.
const FAR: f64 = 4.0;

impl DeviationFrame {
    /// A frame for shapes in `bounds`, which is not empty: that of the world if it suffices.
    pub fn around(bounds: &Box3) -> Self {
        // Halved before the difference, which might overflow.
        let half = (0..3).map(|k| 0.5 * bounds.max[k] - 0.5 * bounds.min[k]);
        let half = half.fold(0.0, |most, x| greater(x, most));
        let reach = bounds.min.iter().chain(&bounds.max);
        let reach = reach.fold(0.0, |most: f64, x| greater(x.abs(), most));
        let exponent = exponent(half);
        let origin = if reach > FAR * half { bounds.centre() } else { [0.0; 3] };
        let scale = if EXPONENTS.contains(&exponent) || half == 0.0 {
            1.0
        } else {
            // A scale and its inverse are both normal numbers.
            f64::from_bits(((1023 - exponent.clamp(-1000, 1000)) as u64) << 52)
        };
        Self { origin, scale }
    }

    pub fn is_world(&self) -> bool {
        self.origin == [0.0; 3] && self.scale == 1.0
    }

    /// The mesh in this frame, and the largest displacement of a vertex by rounding, in this frame; `None`
    /// if a coordinate overflows.
    pub fn local<'a>(&self, mesh: &'a Mesh) -> Option<(Cow<'a, Mesh>, f64)> {
        if self.is_world() {
            return Some((Cow::Borrowed(mesh), 0.0));
        }
        let (mut displacement, mut underflowed) = (0.0, false);
        let mut positions = Vec::with_capacity(mesh.positions().len());
        for p in mesh.positions() {
            let shifted: [f64; 3] = std::array::from_fn(|k| p[k] - self.origin[k]);
            let square = (0..3).fold(0.0, |sum, k| {
                let lost = DoubleDouble::two_sum(p[k], -self.origin[k]).lo;
                // Scaled first: squares of tiny lengths would be rounded up to far more.
                let lost = if lost == 0.0 { 0.0 } else { mul_up(lost.abs(), self.scale) };
                if lost == 0.0 { sum } else { add_up(sum, mul_up(lost, lost)) }
            });
            displacement = greater(square, displacement);
            // The scale is a power of two, so only an underflow is not undone by dividing.
            let scaled = shifted.map(|x| x * self.scale);
            underflowed |= (0..3).any(|k| scaled[k] / self.scale != shifted[k]);
            positions.push(scaled);
        }
        let displacement = if displacement == 0.0 { 0.0 } else { sqrt_up(displacement) };
        // Underflow moves a coordinate by at most half of the smallest number.
        let displacement = if underflowed { add_up(displacement, f64::MIN_POSITIVE) } else { displacement };
        // Positions that were equal stay equal, so only an overflow can be refused.
        Some((Cow::Owned(mesh.with_positions(positions).ok()?), displacement))
    }

    /// A length of this frame in world space, rounded down: exact except for underflow.
    pub fn length_down(&self, local: f64) -> f64 {
        let world = local / self.scale;
        // The inverse is exact: a number that is rounded here is below the normal ones, and its image is not.
        if world * self.scale > local { world.next_down() } else { world }
    }

    /// The same rounded up. No distance between two surfaces is larger than their common extent, which is
    /// finite; so an overflow by the last digits is capped.
    pub fn length_up(&self, local: f64) -> f64 {
        let world = local / self.scale;
        let world = if world * self.scale < local { world.next_up() } else { world };
        lesser(world, f64::MAX)
    }

    /// A world-space length in this frame.
    pub fn local_length(&self, world: f64) -> f64 {
        world * self.scale
    }

    /// A world-space box around all points within `radius` of the bounding box of some points of this frame,
    /// rounded outwards.
    pub fn world_box(&self, points: &[[f64; 3]], radius: f64) -> Box3 {
        let local = Box3::from_points(points);
        if self.is_world() && radius == 0.0 {
            return local;
        }
        let low = |k: usize| add_down(self.origin[k], div_down(sub_down(local.min[k], radius), self.scale));
        let high = |k: usize| add_up(self.origin[k], div_up(add_up(local.max[k], radius), self.scale));
        Box3 { min: std::array::from_fn(low), max: std::array::from_fn(high) }
    }

    /// A point of this frame in world space, rounded.
    pub fn world(&self, local: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| local[k] / self.scale + self.origin[k])
    }
}

/// The exponent `e` with `2^e ≤ |x| < 2^(e+1)`; −1023 for 0 and subnormal numbers.
fn exponent(x: f64) -> i32 {
    (x.to_bits() >> 52 & 0x7ff) as i32 - 1023
}
