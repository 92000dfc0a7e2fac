//! `TracedSurface`: the surface against which rays are traced, a mesh or a field; and the points that rays of
//! the picture see.
use super::light::{GroundPoint, LitPoint, OcclusionTest, ShadingPoint, StudioLights};
use crate::budget::JobError;
use crate::explicit::Ray;
use crate::implicit::query::BeamCounts;
use glam::DVec3;

/// A surface against which rays are traced.
pub(super) trait TracedSurface: Sync {
    /// The reason why no ray could be traced.
    type Error: From<JobError> + Send;

    /// The first hit of each ray.
    fn trace(&self, rays: &[Ray], counts: &mut BeamCounts) -> Result<Vec<TracedRay>, Self::Error>;

    /// The result of `work`, which queries occlusion. It may be called twice: see [`OcclusionTest`].
    fn with_occlusion<R>(&self, work: impl Fn(&mut dyn OcclusionTest) -> R) -> Result<R, Self::Error>;

    /// The height at which shadow rays start above the ground.
    fn ray_offset(&self) -> f64;

    /// The depth of the nearest outline or crease in a pixel, +∞ without one. It may be too thin to be met by
    /// the ray through the pixel's middle.
    fn nearest_line(&self, pixel: [i64; 2]) -> f64;

    /// The corners of the visible triangle, if the surface has triangles.
    fn corners(&self, spot: &ShadingPoint) -> Option<[[f64; 3]; 3]>;
}

/// The result of a ray of the picture.
pub(super) struct TracedRay {
    pub spot: Option<ShadingPoint>,
    /// Whether the ray may have missed a part of the surface.
    pub uncertain: bool,
}

/// The point that a ray of the picture sees.
pub(super) enum SeenPoint {
    Nothing,
    Ground(GroundPoint),
    Surface(ShadingPoint),
}

/// Points belong to one smooth surface if their normals differ by less than 20° (its cosine), and if the line
/// between them is within 20° of both tangent planes (its sine).
const SAME_COS: f64 = 0.94;
const SAME_SIN: f64 = 0.342;

impl SeenPoint {
    /// Whether both are points of one smooth surface, so that values between them may be interpolated.
    pub fn is_one_with(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Nothing, Self::Nothing) | (Self::Ground(_), Self::Ground(_)) => true,
            (Self::Surface(a), Self::Surface(b)) => {
                let d = b.at - a.at;
                // Two parallel walls behind each other have equal normals; the line between their
                // points is not along them.
                let most_sq = SAME_SIN * SAME_SIN * d.length_squared();
                let [from_a, from_b] = [d.dot(a.normal), d.dot(b.normal)];
                a.front == b.front
                    && a.normal.dot(b.normal) >= SAME_COS
                    && from_a * from_a <= most_sq
                    && from_b * from_b <= most_sq
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

    /// The point whose light determines the colour.
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
