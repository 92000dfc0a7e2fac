//! `LocalTolerance`: the allowed distance from the original during simplification, uniform or by position, in
//! the coordinates of a `ReductionFrame`.
use crate::budget::ErrorLimit;
use crate::check::{RegionTolerance, ToleranceField};
use crate::math::{Box3, exponent, greater, power_of_two};

/// World to local coordinates: subtract the middle of the mesh, times a power of two that scales the extent
/// to 1 or less.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReductionFrame {
    origin: [f64; 3],
    scale: f64,
}

impl ReductionFrame {
    pub fn from_bounds(bounds: &Box3) -> Self {
        // Halved before the difference, which might overflow.
        let half = (0..3).map(|k| 0.5 * bounds.max[k] - 0.5 * bounds.min[k]);
        let half = half.fold(0.0, |most, x| greater(x, most));
        // A scale and its inverse are normal numbers.
        Self { origin: bounds.centre(), scale: power_of_two(-exponent(half).clamp(-1000, 1000)) }
    }

    pub fn in_frame(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| (p[k] - self.origin[k]) * self.scale)
    }

    pub fn in_world(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| p[k] / self.scale + self.origin[k])
    }

    /// A local box in world coordinates, rounded.
    pub fn world_box(&self, local: &Box3) -> Box3 {
        Box3 { min: self.in_world(local.min), max: self.in_world(local.max) }
    }

    /// A world length in this frame.
    pub fn local_length(&self, world: f64) -> f64 {
        world * self.scale
    }

    /// A length in this frame in world units.
    pub fn world_length(&self, local: f64) -> f64 {
        local / self.scale
    }
}

/// The allowed distance of the simplified surface from the original, in local coordinates.
///
/// If it varies, every point has its own length. That holds during simplification only; the final
/// proof uses the least one over all points of a piece.
#[derive(Clone, Debug)]
pub(super) struct LocalTolerance {
    /// The least tolerance of all positions.
    least: f64,
    least_sq: f64,
    varying: Option<VaryingTolerance>,
}

#[derive(Clone, Debug)]
struct VaryingTolerance {
    limit: ErrorLimit,
    frame: ReductionFrame,
    /// The fraction of the limit that is used during simplification.
    share: f64,
    /// By sample: the square of its tolerance.
    samples: Vec<f64>,
}

impl LocalTolerance {
    /// A uniform tolerance.
    pub fn uniform(length: f64) -> Self {
        Self { least: length, least_sq: length * length, varying: None }
    }

    /// A fraction of a limit that depends on the position, for samples at the given points.
    pub fn varying(
        allowed: &ErrorLimit,
        (frame, share): (ReductionFrame, f64),
        samples: &[[f64; 3]],
    ) -> Self {
        let mut by_place = VaryingTolerance { limit: *allowed, frame, share, samples: Vec::new() };
        let square = |p: &[f64; 3]| {
            let length = by_place.length(&Box3 { min: *p, max: *p });
            length * length
        };
        by_place.samples = samples.iter().map(square).collect();
        let least = by_place.length(&Box3::from_points(samples));
        Self { least, least_sq: least * least, varying: Some(by_place) }
    }

    /// The tolerance for all points of a box.
    pub fn for_box(&self, bounds: &Box3) -> f64 {
        self.varying.as_ref().map_or(self.least, |by_place| by_place.length(bounds))
    }

    /// Whether a point may be this far from the original; takes the squared distance.
    #[inline]
    pub fn holds(&self, point: [f64; 3], distance_sq: f64) -> bool {
        // Within the least tolerance the place does not matter.
        distance_sq <= self.least_sq
            || self.varying.as_ref().is_some_and(|by_place| {
                let length = by_place.length(&Box3 { min: point, max: point });
                distance_sq <= length * length
            })
    }

    /// [`LocalTolerance::holds`] for a sample.
    #[inline]
    pub fn holds_sample(&self, sample: u32, distance_sq: f64) -> bool {
        distance_sq <= self.least_sq
            || self.varying.as_ref().is_some_and(|by_place| distance_sq <= by_place.samples[sample as usize])
    }

    /// Whether all points of a box may be this far from the original; the box is computed only if it is
    /// needed.
    #[inline]
    pub fn holds_in_box(&self, bounds: impl FnOnce() -> Box3, distance: f64) -> bool {
        distance <= self.least
            || self.varying.as_ref().is_some_and(|by_place| distance <= by_place.length(&bounds()))
    }

    /// Whether nothing may move in a box because the eye is too close.
    pub fn is_too_close(&self, bounds: &Box3) -> bool {
        let by_place = self.varying.as_ref();
        by_place.is_some_and(|by_place| by_place.limit.at(&by_place.frame.world_box(bounds)).is_none())
    }

    /// Whether the tolerance is uniform and less than a length.
    #[inline]
    pub fn is_less_than(&self, length: f32) -> bool {
        self.is_constant() && self.least < f64::from(length)
    }

    /// Whether the tolerance excludes any distance.
    pub fn is_finite(&self) -> bool {
        self.least < f64::INFINITY
    }

    /// Whether the tolerance is uniform.
    pub fn is_constant(&self) -> bool {
        self.varying.is_none()
    }
}

impl VaryingTolerance {
    fn length(&self, bounds: &Box3) -> f64 {
        let length = self.limit.at(&self.frame.world_box(bounds));
        length.map_or(0.0, |length| self.frame.local_length(self.share * length))
    }
}

impl ToleranceField for LocalTolerance {
    #[inline]
    fn over_triangle(&self, triangle: [[f64; 3]; 3], _: f64) -> RegionTolerance {
        let enough = match &self.varying {
            Some(by_place) => by_place.length(&Box3::from_points(&triangle)),
            None => self.least,
        };
        RegionTolerance { tolerance: enough, sight: None }
    }
}
