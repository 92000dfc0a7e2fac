//! `StudioLights`: the lights around a mesh, and the shading of its surface.
use super::color::srgb_to_linear;
use super::options::UpAxis;
use super::render_mesh::ShadingPoint;
use super::sample_pattern::{PixelPattern, tangents};
use crate::budget::Camera;
use crate::math::{Box3, greater, lesser};
use glam::DVec3;

/// The radius of the lamp over its distance: soft shadows, as from a large window.
const LAMP_RADIUS: f64 = 0.16;
/// The light of the lamp, of the sky straight above, at the horizon and from the ground.
const LAMP_LIGHT: f64 = 0.78;
const SKY_LIGHT: [f64; 3] = [0.56, 0.40, 0.26];
/// The light from directions in which the sky is hidden: what hides it is lit too.
const HIDDEN_LIGHT: f64 = 0.07;
/// The reflectance of a glazed surface seen from the front: that of glass.
const GLAZE: f64 = 0.04;
/// The same at a grazing angle: below 1, since the glaze is not quite smooth.
const GLAZE_GRAZING: f64 = 0.6;
/// The light of the lamp in a mirror, and the cosines between which its mirror image fades out.
const GLINT_LIGHT: f64 = 3.2;
const GLINT_COS: [f64; 2] = [0.965, 0.992];

/// The colours of front and back faces, and of both under lines, in sRGB.
const FRONT: [u8; 3] = [219, 134, 84];
const BACK: [u8; 3] = [84, 126, 168];
const PAPER: [u8; 3] = [226, 229, 233];
const PAPER_BACK: [u8; 3] = [170, 192, 214];

/// The material of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Material {
    /// Coloured and glazed.
    Clay,
    /// Light and dull, as a base for lines.
    Paper,
}

/// A lamp over the viewer's left shoulder, a sky, and the ground.
pub(super) struct StudioLights {
    up: DVec3,
    lamp: DVec3,
    lamp_axes: [DVec3; 2],
    /// The height of the ground along `up`.
    ground: f64,
    /// The middle of the ground's shadow, and how far from it the shadow fades out.
    middle: DVec3,
    reach: f64,
    front: DVec3,
    back: DVec3,
    material: Material,
}

/// A smooth step: 0 up to `low`, 1 from `high` on.
fn smoothstep([low, high]: [f64; 2], t: f64) -> f64 {
    let x = (t - low) / (high - low);
    let x = if x > 0.0 { lesser(x, 1.0) } else { 0.0 };
    x * x * (3.0 - 2.0 * x)
}

impl StudioLights {
    /// The lights, placed relative to the camera's right, up and forward axes.
    pub fn new(bounds: &Box3, camera: &Camera, up: UpAxis, material: Material) -> Self {
        let top = DVec3::from(up.direction());
        let [right, above, forward] =
            camera.axes().unwrap_or([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]);
        let (right, above, forward) = (DVec3::from(right), DVec3::from(above), DVec3::from(forward));
        // Level and towards the viewer; seen from straight above, down in the picture.
        let level = |v: DVec3| (v - top * v.dot(top)).normalize_or_zero();
        let towards = if level(-forward) == DVec3::ZERO { level(-above) } else { level(-forward) };
        let lamp = (top * 1.15 - right * 0.75 + towards * 0.75).normalize();
        let [front, back] = match material {
            Material::Clay => [FRONT, BACK],
            Material::Paper => [PAPER, PAPER_BACK],
        };
        let (low, high, size) = if bounds.is_empty() {
            (DVec3::ZERO, DVec3::ZERO, 0.0)
        } else {
            (DVec3::from(bounds.min), DVec3::from(bounds.max), bounds.diagonal())
        };
        Self {
            up: top,
            lamp,
            lamp_axes: tangents(lamp),
            // A thousandth of the size below the lowest point: contact is seen, and flat meshes are not
            // hidden.
            ground: low.dot(top) - 1e-3 * size,
            middle: low * 0.5 + high * 0.5,
            reach: 4.0 * size,
            front: srgb_to_linear(front),
            back: srgb_to_linear(back),
            material,
        }
    }

    /// The light of the sky in a direction.
    fn sky_radiance(&self, direction: DVec3) -> f64 {
        let height = direction.dot(self.up);
        let [zenith, horizon, ground] = SKY_LIGHT;
        if height < 0.0 {
            horizon + (horizon - ground) * height
        } else {
            horizon + (zenith - horizon) * height
        }
    }

    /// The light on a surface, given the normal to shade by and the triangle's own.
    fn irradiance(
        &self,
        shadows: &mut impl OcclusionTest,
        origin: DVec3,
        normals: [DVec3; 2],
        rays: PixelRay,
    ) -> Irradiance {
        let [normal, flat] = normals;
        let mut found = Irradiance { sky: 0.0, lamp: 0.0, open_sky: 0.0, open_lamp: 0.0 };
        let directions = rays.pattern.sky(rays.ray, normal);
        let share = 1.0 / directions.len() as f64;
        for direction in directions {
            let light = self.sky_radiance(direction) * share;
            found.open_sky += light;
            // There is no sky below the triangle's own plane.
            let hidden = direction.dot(flat) <= 0.0 || shadows.is_occluded(origin, direction);
            found.sky += if hidden { HIDDEN_LIGHT * share } else { light };
        }
        let points = rays.pattern.lamp(rays.ray);
        let share = LAMP_LIGHT / points.len() as f64;
        for [x, y] in points {
            let direction = self.lamp + (self.lamp_axes[0] * x + self.lamp_axes[1] * y) * LAMP_RADIUS;
            let light = normal.dot(direction.normalize()) * share;
            if light > 0.0 {
                found.open_lamp += light;
                if direction.dot(flat) > 0.0 && !shadows.is_occluded(origin, direction) {
                    found.lamp += light;
                }
            }
        }
        found
    }

    /// The light that a point sends along a ray.
    pub fn shade(
        &self,
        shadows: &mut impl OcclusionTest,
        spot: &ShadingPoint,
        direction: DVec3,
        rays: PixelRay,
    ) -> DVec3 {
        let albedo = if spot.front { self.front } else { self.back };
        let found = self.irradiance(shadows, spot.origin, [spot.normal, spot.flat], rays);
        let diffuse = albedo * (found.sky + found.lamp);
        if self.material == Material::Paper {
            return diffuse;
        }
        let toward = direction.normalize();
        let cos = -toward.dot(spot.normal);
        let mirrored = toward + spot.normal * (2.0 * cos);
        // Near silhouettes a smooth normal mirrors into the triangle; the curved surface that it stands for
        // does not.
        let into = mirrored.dot(spot.flat);
        let mirrored = if into < 0.0 { mirrored - spot.flat * (2.0 * into) } else { mirrored };
        let seen = if shadows.is_occluded(spot.origin, mirrored) {
            // The shape itself, in about the same light; without light it would look like a slit.
            diffuse
        } else {
            DVec3::splat(
                self.sky_radiance(mirrored) + GLINT_LIGHT * smoothstep(GLINT_COS, mirrored.dot(self.lamp)),
            )
        };
        // Source: C. Schlick, *An inexpensive BRDF model for physically-based rendering*, 1994.
        let off = 1.0 - greater(cos, 0.0);
        let share = GLAZE + (GLAZE_GRAZING - GLAZE) * (off * off) * (off * off) * off;
        diffuse * (1.0 - share) + seen * share
    }

    /// Converts the light of a point with the studio's own colour to that of another colour.
    pub fn recolor(&self, lit: DVec3, spot: &ShadingPoint, color: DVec3) -> DVec3 {
        lit / if spot.front { self.front } else { self.back } * color
    }

    /// Where a ray meets the ground from above: the fraction of light that the mesh leaves there.
    pub fn ground(
        &self,
        shadows: &mut impl OcclusionTest,
        origin: DVec3,
        direction: DVec3,
        rays: PixelRay,
    ) -> Option<f64> {
        let (height, slope) = (origin.dot(self.up) - self.ground, direction.dot(self.up));
        if height <= 0.0 || slope >= 0.0 {
            return None;
        }
        let at = origin + direction * (-height / slope);
        let fade = smoothstep([0.5 * self.reach, self.reach], (at - self.middle).length());
        if fade >= 1.0 {
            return None;
        }
        let found = self.irradiance(shadows, at + self.up * shadows.ray_offset(), [self.up, self.up], rays);
        let share = (found.sky + found.lamp) / (found.open_sky + found.open_lamp);
        Some(share + (1.0 - share) * fade)
    }
}

/// Tests whether the light is hidden. The rays never depend on the answers, so they may be collected first
/// and traced together: shading once with made-up answers gives all the rays, and once more with the true
/// answers gives the light.
pub(super) trait OcclusionTest {
    /// Whether something lies between a point and the light in a direction.
    fn is_occluded(&mut self, origin: DVec3, direction: DVec3) -> bool;
    /// By how much rays start off the ground.
    fn ray_offset(&self) -> f64;
}

/// One of a pixel's rays.
#[derive(Clone, Copy)]
pub(super) struct PixelRay<'a> {
    pub pattern: PixelPattern<'a>,
    pub ray: usize,
}

/// Light from the sky and from the lamp, and the same without occlusion.
struct Irradiance {
    sky: f64,
    lamp: f64,
    open_sky: f64,
    open_lamp: f64,
}
