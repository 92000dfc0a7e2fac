//! `ReferenceSurface`: another surface, and the distance of points from it as a colour.
use super::color::ColorRamp;
use crate::budget::{Job, JobError};
use crate::explicit::{Bvh, Mesh};
use crate::math::greater;
use glam::DVec3;

/// Another surface, from which the distance of each point is shown.
#[derive(Clone, Copy, Debug)]
pub struct ReferenceSurface<'a> {
    /// The other surface.
    pub mesh: &'a Mesh,
    /// The distance of the last colour, which is used for larger distances, too.
    pub most: f64,
}

/// The tree over the other surface, and the scale.
pub(super) struct HeatMap {
    bvh: Bvh,
    most: f64,
    ramp: ColorRamp,
}

impl HeatMap {
    pub fn new(against: ReferenceSurface, job: &Job) -> Result<Self, JobError> {
        let bvh = Bvh::build(against.mesh, job)?;
        Ok(Self { bvh, most: against.most, ramp: ColorRamp::new() })
    }

    /// The colour of a point.
    pub fn at(&self, point: [f64; 3]) -> DVec3 {
        let distance =
            self.bvh.closest_point(point).map_or(f64::INFINITY, |closest| closest.distance_sq.sqrt());
        let share = distance / self.most;
        // 0/0 counts as distance 0 on a scale without extent.
        let share = if share < 1.0 || distance == 0.0 { greater(share, 0.0) } else { 1.0 };
        self.ramp.at(share)
    }
}

#[cfg(test)]
mod tests {
    use super::super::color::RAMP;
    use super::super::color::srgb_to_linear;
    use super::*;

    #[test]
    fn colours_run_from_the_first_to_the_last() {
        let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
        let heat = HeatMap::new(ReferenceSurface { mesh: &mesh, most: 2.0 }, &Job::default()).unwrap();
        let at = |z: f64| heat.at([0.25, 0.25, z]);
        assert_eq!(
            (at(0.0), at(2.0), at(7.0)),
            (srgb_to_linear(RAMP[0]), srgb_to_linear(RAMP[4]), srgb_to_linear(RAMP[4]))
        );
        assert_eq!(at(-1.0), srgb_to_linear(RAMP[2]));
        let brightness: Vec<f64> =
            (0..=20).map(|i| at(0.1 * f64::from(i)).dot(DVec3::new(0.2, 0.7, 0.1))).collect();
        assert!(brightness.windows(2).all(|pair| pair[1] < pair[0]), "{brightness:?}");
    }

    #[test]
    fn no_distance_is_the_first_colour_even_without_a_scale() {
        let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
        let heat = HeatMap::new(ReferenceSurface { mesh: &mesh, most: 0.0 }, &Job::default()).unwrap();
        assert_eq!(heat.at([0.25, 0.25, 0.0]), srgb_to_linear(RAMP[0]));
        assert_eq!(heat.at([0.25, 0.25, 1e-9]), srgb_to_linear(RAMP[4]));
    }
}
