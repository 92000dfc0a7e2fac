//! `TracedSurface`: what rays are traced against, a mesh or a field; and what a ray of the picture sees.
use super::light::{GroundPoint, LitPoint, OcclusionTest, StudioLights};
use super::render_mesh::ShadingPoint;
use crate::budget::JobError;
use crate::explicit::Ray;
use crate::implicit::query::BeamCounts;
use glam::DVec3;

/// A surface that rays are traced against.
pub(super) trait TracedSurface: Sync {
    /// Why no ray could be traced.
    type Error: From<JobError> + Send;

    /// What each ray meets first.
    fn trace(&self, rays: &[Ray], counts: &mut BeamCounts) -> Result<Vec<TracedRay>, Self::Error>;

    /// The result of `work`, which asks for occlusion. It may be called twice: see [`OcclusionTest`].
    fn with_occlusion<R>(&self, work: impl Fn(&mut dyn OcclusionTest) -> R) -> Result<R, Self::Error>;

    /// By how much shadow rays start off the ground.
    fn ray_offset(&self) -> f64;

    /// The depth of the nearest outline or crease in a pixel, +∞ without one: it may be too thin to be met by
    /// the ray through the pixel's middle.
    fn nearest_line(&self, pixel: [i64; 2]) -> f64;

    /// The corners of the triangle that is seen, if the surface has triangles.
    fn corners(&self, spot: &ShadingPoint) -> Option<[[f64; 3]; 3]>;
}

/// The result of a ray of the picture.
pub(super) struct TracedRay {
    pub spot: Option<ShadingPoint>,
    /// Whether something may have been missed.
    pub uncertain: bool,
}

/// What a ray of the picture sees.
pub(super) enum SeenPoint {
    Nothing,
    Ground(GroundPoint),
    Surface(ShadingPoint),
}

/// Surfaces are one where their normals differ by less than 20° (its cosine), and points of it where the line between
/// them is within 20° of both planes (its sine).
const SAME_COS: f64 = 0.94;
const SAME_SIN: f64 = 0.342;

impl SeenPoint {
    /// Whether both are points of one smooth surface, so that what is between them may be interpolated.
    pub fn is_one_with(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Nothing, Self::Nothing) | (Self::Ground(_), Self::Ground(_)) => true,
            (Self::Surface(a), Self::Surface(b)) => {
                let d = b.at - a.at;
                let off = SAME_SIN * SAME_SIN * d.length_squared();
                let [from_a, from_b] = [d.dot(a.normal), d.dot(b.normal)];
                a.front == b.front
                    && a.normal.dot(b.normal) >= SAME_COS
                    && from_a * from_a <= off
                    && from_b * from_b <= off
            }
            _ => false,
        }
    }

    /// The depth, +∞ behind all surfaces.
    pub fn depth(&self) -> f64 {
        match self {
            Self::Surface(spot) => spot.depth,
            _ => f64::INFINITY,
        }
    }

    /// The point whose light decides its colour.
    pub fn lit(&self, studio: &StudioLights, ray_offset: f64) -> Option<LitPoint> {
        match self {
            Self::Nothing => None,
            Self::Ground(ground) => Some(studio.lit_ground(ground, ray_offset)),
            Self::Surface(ShadingPoint { origin, normal, flat, .. }) => {
                Some(LitPoint { origin: *origin, normal: *normal, flat: *flat })
            }
        }
    }
}

/// The direction of a ray.
pub(super) fn direction_of(ray: &Ray) -> DVec3 {
    DVec3::from(ray.direction)
}
