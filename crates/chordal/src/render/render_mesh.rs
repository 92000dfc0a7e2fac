//! `RenderMesh`: a mesh prepared for rays.
use super::camera::RayGenerator;
use super::light::{OcclusionTest, ShadingPoint};
use super::line_depths::LineDepths;
use super::normals::ShadingNormals;
use super::options::{CullMode, RenderOptions, RenderStyle};
use super::traced_surface::{TracedRay, TracedSurface};
use crate::budget::{Job, JobError, Screen};
use crate::explicit::{Bvh, HitSides, Mesh, Ray, face_normal};
use crate::implicit::query::BeamCounts;
use glam::DVec3;

/// A mesh, its tree, and its shading normals.
pub(super) struct RenderMesh<'a> {
    mesh: &'a Mesh,
    bvh: Bvh,
    normals: ShadingNormals<'a>,
    sides: HitSides,
    lines: LineDepths,
    /// The height above the surface at which secondary rays start.
    ray_offset: f64,
}

impl<'a> RenderMesh<'a> {
    pub fn new(
        mesh: &'a Mesh,
        options: &RenderOptions,
        (eye, screen): (&RayGenerator, Screen),
        job: &Job,
    ) -> Result<Self, JobError> {
        let bvh = Bvh::build(mesh, job)?;
        let normals = match options.show {
            RenderStyle::Flat | RenderStyle::Wire | RenderStyle::Overshade => ShadingNormals::Flat,
            RenderStyle::Shaded | RenderStyle::Normals | RenderStyle::Zebra => {
                ShadingNormals::from_mesh(mesh, job)
            }
        };
        // Chosen: a millionth of the extent is far above the rounding of hits (10⁻¹⁵ of it), and far below a pixel.
        let ray_offset = 1e-6 * bvh.bounds().diagonal();
        let sides = match options.cull {
            CullMode::None => HitSides::Both,
            CullMode::Back => HitSides::Front,
            CullMode::Front => HitSides::Back,
        };
        let lines = LineDepths::new(mesh, eye, screen, job);
        Ok(Self { mesh, bvh, normals, sides, lines, ray_offset })
    }

    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// The first triangle that the ray meets and that is not culled.
    fn intersect(&self, ray: &Ray) -> Option<ShadingPoint> {
        let hit = self.bvh.first_hit_on(ray, self.sides)?;
        let face = hit.face as usize;
        let corners = self.mesh.corners(face).map(DVec3::from);
        let w = hit.barycentric;
        let at = corners[0] * w[0] + corners[1] * w[1] + corners[2] * w[2];
        let front = face_normal(self.mesh.corners(face)).map_or(DVec3::ZERO, DVec3::from);
        let flat = if hit.front { front } else { -front };
        let mut spot = ShadingPoint {
            face,
            at,
            depth: hit.t,
            origin: at + flat * self.ray_offset,
            flat,
            normal: flat,
            front: hit.front,
        };
        if let Some(normals) = self.normals.corners(self.mesh, face) {
            let sum = normals[0] * w[0] + normals[1] * w[1] + normals[2] * w[2];
            // Seen from the back, the surface is shaded by its opposite normals. Given normals may
            // also be on the wrong side of the triangle.
            let side = if sum.dot(flat) < 0.0 { -1.0 } else { 1.0 };
            let normal = (sum * side).normalize_or_zero();
            // If the normals have length 0, or are not finite, the triangle's normal is used.
            if normal.is_finite() && normal != DVec3::ZERO {
                spot.normal = facing_normal(normal, flat, DVec3::from(ray.direction));
                spot.origin =
                    self.smooth_origin(at, corners, normals.map(|n| n * side), w) + flat * self.ray_offset;
            }
        }
        Some(spot)
    }

    /// The point moved outward onto the smooth surface that the normals describe, so that its facets cast no
    /// shadows on themselves (shadow terminator).
    ///
    /// Source: J. Hanika, *Hacking the shadow terminator*, Ray Tracing Gems II, 2021.
    fn smooth_origin(&self, at: DVec3, corners: [DVec3; 3], normals: [DVec3; 3], w: [f64; 3]) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for k in 0..3 {
            let normal = normals[k].normalize_or_zero();
            let below = (at - corners[k]).dot(normal);
            if below < 0.0 {
                sum -= normal * (below * w[k]);
            }
        }
        if sum.is_finite() { at + sum } else { at }
    }
}

impl OcclusionTest for &RenderMesh<'_> {
    fn is_occluded(&mut self, origin: DVec3, direction: DVec3) -> bool {
        self.bvh.any_hit(&Ray::new(origin.into(), direction.into()))
    }
}

impl TracedSurface for RenderMesh<'_> {
    type Error = JobError;

    fn trace(&self, rays: &[Ray], _: &mut BeamCounts) -> Result<Vec<TracedRay>, JobError> {
        Ok(rays.iter().map(|ray| TracedRay { spot: self.intersect(ray), uncertain: false }).collect())
    }

    fn with_occlusion<R>(&self, work: impl Fn(&mut dyn OcclusionTest) -> R) -> Result<R, JobError> {
        Ok(work(&mut &*self))
    }

    fn ray_offset(&self) -> f64 {
        self.ray_offset
    }

    fn nearest_line(&self, pixel: [i64; 2]) -> f64 {
        self.lines.at(pixel)
    }

    fn corners(&self, spot: &ShadingPoint) -> Option<[[f64; 3]; 3]> {
        Some(self.mesh.corners(spot.face))
    }
}

/// The normal. If it points away although the triangle is visible, it is turned until it is perpendicular to
/// the ray.
pub(super) fn facing_normal(normal: DVec3, flat: DVec3, direction: DVec3) -> DVec3 {
    let away = normal.dot(direction);
    if away <= 0.0 {
        return normal;
    }
    let turned = (normal - direction * (away / direction.length_squared())).normalize_or_zero();
    if turned == DVec3::ZERO { flat } else { turned }
}
