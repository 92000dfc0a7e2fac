//! `StudioLights`: the lights around a mesh, and the shading of its surface.
use super::color::srgb_to_linear;
use super::options::UpAxis;
use super::sample_pattern::{SamplePattern, tangents};
use crate::budget::Camera;
use crate::math::{Box3, greater, lesser};
use glam::DVec3;

/// The radius of the lamp over its distance: soft shadows, as from a large window.
const LAMP_RADIUS: f64 = 0.16;
/// The light of the lamp, of the sky straight above, at the horizon and from the ground.
const LAMP_LIGHT: f64 = 0.78;
const SKY_LIGHT: [f64; 3] = [0.56, 0.40, 0.26];
/// The light from directions in which the sky is hidden, since the hiding surface is lit too.
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

/// The shape in the studio.
#[derive(Clone, Copy)]
pub(super) struct StudioShape {
    pub bounds: Box3,
    pub up: UpAxis,
    pub material: Material,
}

/// A lamp over the viewer's left shoulder, a sky, and the ground.
pub(super) struct StudioLights {
    up: DVec3,
    lamp: DVec3,
    lamp_axes: [DVec3; 2],
    /// The height of the ground along `up`.
    ground: f64,
    /// The middle of the ground's shadow, and the distance from it at which the shadow fades out.
    middle: DVec3,
    fade_radius: f64,
    front: DVec3,
    back: DVec3,
    material: Material,
    open_sky: CosineTable,
    open_lamp: CosineTable,
}

/// A smooth step: 0 up to `low`, 1 from `high` on.
fn smoothstep([low, high]: [f64; 2], t: f64) -> f64 {
    let x = (t - low) / (high - low);
    let x = if x > 0.0 { lesser(x, 1.0) } else { 0.0 };
    x * x * (3.0 - 2.0 * x)
}

impl StudioLights {
    /// The lights, placed relative to the camera's right, up and forward axes.
    pub fn new(shape: &StudioShape, camera: &Camera, pattern: &SamplePattern) -> Self {
        let StudioShape { bounds, up, material } = *shape;
        let top = DVec3::from(up.direction());
        let [right, above, forward] =
            camera.axes().unwrap_or([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]);
        let (right, above, forward) = (DVec3::from(right), DVec3::from(above), DVec3::from(forward));
        // Level and towards the viewer; if seen from straight above, downwards in the picture.
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
            // A thousandth of the size below the lowest point, so that the contact is seen and flat meshes
            // are not hidden.
            ground: low.dot(top) - 1e-3 * size,
            middle: low * 0.5 + high * 0.5,
            fade_radius: 4.0 * size,
            front: srgb_to_linear(front),
            back: srgb_to_linear(back),
            material,
            open_sky: open_sky(pattern),
            open_lamp: open_lamp(pattern),
        }
    }

    /// The light of the sky in a direction.
    fn sky_radiance(&self, direction: DVec3) -> f64 {
        sky_radiance(direction.dot(self.up))
    }

    /// The shares of the light that reach a point, from the given directions of the sky and points of the
    /// lamp.
    pub fn shares(
        &self,
        shadows: &mut dyn OcclusionTest,
        point: &LitPoint,
        sky: impl ExactSizeIterator<Item = DVec3>,
        lamp: impl Iterator<Item = [f64; 2]>,
    ) -> LightShares {
        let n = sky.len() as f64;
        let (mut open, mut seen, mut hidden) = (0.0, 0.0, 0.0);
        for direction in sky {
            let light = self.sky_radiance(direction);
            open += light;
            // There is no sky below the plane of the triangle.
            if direction.dot(point.flat) <= 0.0 || shadows.is_occluded(point.origin, direction) {
                hidden += 1.0;
            } else {
                seen += light;
            }
        }
        LightShares {
            sky: seen / open,
            hidden: hidden / n,
            lamp: self.lamp_sum(shadows, point, lamp).share(),
        }
    }

    /// The light of some points of the lamp.
    pub fn lamp_sum(
        &self,
        shadows: &mut dyn OcclusionTest,
        point: &LitPoint,
        lamp: impl Iterator<Item = [f64; 2]>,
    ) -> LampSum {
        let mut sum = LampSum::default();
        for [x, y] in lamp {
            let direction = self.lamp + (self.lamp_axes[0] * x + self.lamp_axes[1] * y) * LAMP_RADIUS;
            let light = point.normal.dot(direction);
            // A point of the lamp behind the smooth surface gives no light and counts on neither
            // side, so that the share is 1 where nothing is in the way.
            if light > 0.0 {
                sum.open += light;
                if direction.dot(point.flat) > 0.0 && !shadows.is_occluded(point.origin, direction) {
                    sum.seen += light;
                }
            }
        }
        sum
    }

    /// The light of sky and lamp that arrives at a surface with this normal, and the light without any
    /// occlusion.
    fn irradiance(&self, normal: DVec3, shares: LightShares) -> [f64; 2] {
        let sky = self.open_sky.at(normal.dot(self.up));
        let lamp = self.open_lamp.at(normal.dot(self.lamp));
        [sky * shares.sky + HIDDEN_LIGHT * shares.hidden + lamp * shares.lamp, sky + lamp]
    }

    /// The direction in which a glazed surface mirrors its surroundings; `None` for other surfaces.
    pub fn mirrored(&self, spot: &ShadingPoint, direction: DVec3) -> Option<DVec3> {
        if self.material == Material::Paper {
            return None;
        }
        let toward = direction.normalize();
        let cos = -toward.dot(spot.normal);
        let mirrored = toward + spot.normal * (2.0 * cos);
        // Near silhouettes a smooth normal mirrors into the triangle; the curved surface that it approximates
        // does not.
        let into = mirrored.dot(spot.flat);
        Some(if into < 0.0 { mirrored - spot.flat * (2.0 * into) } else { mirrored })
    }

    /// The light that a point sends back along a ray.
    pub fn shade(
        &self,
        shadows: &mut dyn OcclusionTest,
        spot: &ShadingPoint,
        direction: DVec3,
        shares: LightShares,
    ) -> DVec3 {
        let albedo = if spot.front { self.front } else { self.back };
        let diffuse = albedo * self.irradiance(spot.normal, shares)[0];
        let Some(mirrored) = self.mirrored(spot, direction) else { return diffuse };
        let seen = if shadows.is_occluded(spot.origin, mirrored) {
            // The mirrored point is on the shape itself, in about the same light; without light it would look
            // like a slit.
            diffuse
        } else {
            DVec3::splat(
                self.sky_radiance(mirrored) + GLINT_LIGHT * smoothstep(GLINT_COS, mirrored.dot(self.lamp)),
            )
        };
        // Source: C. Schlick, *An inexpensive BRDF model for physically-based rendering*, 1994.
        let grazing = 1.0 - greater(-direction.normalize().dot(spot.normal), 0.0);
        let share = GLAZE + (GLAZE_GRAZING - GLAZE) * (grazing * grazing) * (grazing * grazing) * grazing;
        diffuse * (1.0 - share) + seen * share
    }

    /// Converts the light of a point with the studio's own colour to that of another colour.
    pub fn recolor(&self, lit: DVec3, spot: &ShadingPoint, color: DVec3) -> DVec3 {
        lit / if spot.front { self.front } else { self.back } * color
    }

    /// The point at which a ray meets the ground from above, unless the shadow has faded out there.
    pub fn ground(&self, origin: DVec3, direction: DVec3) -> Option<GroundPoint> {
        let (height, slope) = (origin.dot(self.up) - self.ground, direction.dot(self.up));
        if height <= 0.0 || slope >= 0.0 {
            return None;
        }
        let at = origin + direction * (-height / slope);
        let fade = smoothstep([0.5 * self.fade_radius, self.fade_radius], (at - self.middle).length());
        (fade < 1.0).then_some(GroundPoint { at, fade })
    }

    /// A point of the ground, to be lit.
    pub fn lit_ground(&self, ground: &GroundPoint, ray_offset: f64) -> LitPoint {
        LitPoint { origin: ground.at + self.up * ray_offset, normal: self.up, flat: self.up }
    }

    /// The fraction of the ground's light that the mesh does not hide.
    pub fn ground_share(&self, ground: &GroundPoint, shares: LightShares) -> f64 {
        let [received, open] = self.irradiance(self.up, shares);
        let share = received / open;
        share + (1.0 - share) * ground.fade
    }
}

/// The light of the sky in a direction of the given height.
fn sky_radiance(height: f64) -> f64 {
    let [zenith, horizon, ground] = SKY_LIGHT;
    if height < 0.0 { horizon + (horizon - ground) * height } else { horizon + (zenith - horizon) * height }
}

/// A function of the cosine of an angle, tabulated.
struct CosineTable(Vec<f64>);

impl CosineTable {
    /// Steps from −1 to 1: the error of a chord over one step is less than a byte of a picture shows.
    const STEPS: usize = 256;

    /// Calls `mean` with unit vectors at angles with these cosines to the z axis.
    fn new(mean: impl Fn(DVec3) -> f64) -> Self {
        let vector = |i: usize| {
            let cos = 2.0 * i as f64 / Self::STEPS as f64 - 1.0;
            DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos)
        };
        Self((0..=Self::STEPS).map(|i| mean(vector(i))).collect())
    }

    fn at(&self, cos: f64) -> f64 {
        let position = (0.5 * cos + 0.5) * Self::STEPS as f64;
        let position = if position > 0.0 { lesser(position, Self::STEPS as f64) } else { 0.0 };
        let step = (position as usize).min(Self::STEPS - 1);
        let part = position - step as f64;
        self.0[step] * (1.0 - part) + self.0[step + 1] * part
    }
}

/// The light of the whole sky on a surface, by the cosine of its normal with the upward direction.
fn open_sky(pattern: &SamplePattern) -> CosineTable {
    let directions = &pattern.light[0].sky;
    CosineTable::new(|normal| {
        let [right, up] = tangents(normal);
        let height = |[x, y, z]: &[f64; 3]| (right * *x + up * *y + normal * *z).z;
        directions.iter().map(|d| sky_radiance(height(d))).sum::<f64>() / directions.len() as f64
    })
}

/// The light of the whole lamp, by the cosine between its direction and the normal.
fn open_lamp(pattern: &SamplePattern) -> CosineTable {
    let points = &pattern.light[0].lamp;
    CosineTable::new(|normal| {
        let light =
            |[x, y]: &[f64; 2]| normal.dot(DVec3::new(LAMP_RADIUS * x, LAMP_RADIUS * y, 1.0).normalize());
        LAMP_LIGHT * points.iter().map(|p| greater(light(p), 0.0)).sum::<f64>() / points.len() as f64
    })
}

/// A point on the surface as a ray sees it.
pub(super) struct ShadingPoint {
    pub face: usize,
    /// The point, and its depth along the line of sight.
    pub at: DVec3,
    pub depth: f64,
    /// The origin of shadow rays.
    pub origin: DVec3,
    /// The unit normal of the triangle, towards the viewer.
    pub flat: DVec3,
    /// The unit shading normal, on the same side.
    pub normal: DVec3,
    /// Whether the front side is visible.
    pub front: bool,
}

impl ShadingPoint {
    /// The normal as a colour, with −1 … 1 as 0 … 1.
    pub fn normal_as_color(&self) -> DVec3 {
        self.normal * 0.5 + DVec3::splat(0.5)
    }
}

/// A point to be lit.
#[derive(Clone, Copy)]
pub(super) struct LitPoint {
    /// The origin of shadow rays.
    pub origin: DVec3,
    /// The shading normal, and the normal of the triangle.
    pub normal: DVec3,
    pub flat: DVec3,
}

/// A point of the ground under the mesh.
#[derive(Clone, Copy)]
pub(super) struct GroundPoint {
    pub at: DVec3,
    /// The share by which the shadow has faded out there: 0 to 1.
    pub fade: f64,
}

/// The shares of light that reach a point: of the sky's and of the lamp's light, and of the directions in
/// which the sky is hidden. Unlike the light itself they hardly depend on the normal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LightShares {
    pub sky: f64,
    pub hidden: f64,
    pub lamp: f64,
}

impl LightShares {
    /// Weighted by `weights`, whose sum is 1.
    pub fn mean<const N: usize>(shares: [Self; N], weights: [f64; N]) -> Self {
        let sum = |f: fn(&Self) -> f64| shares.iter().zip(weights).map(|(s, w)| f(s) * w).sum();
        Self { sky: sum(|s| s.sky), hidden: sum(|s| s.hidden), lamp: sum(|s| s.lamp) }
    }
}

/// The light of points of the lamp, with and without occlusion.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LampSum {
    pub seen: f64,
    pub open: f64,
}

impl LampSum {
    /// The visible share; 1 if there is no light.
    pub fn share(self) -> f64 {
        if self.open > 0.0 { self.seen / self.open } else { 1.0 }
    }
}

/// Tests whether the light is hidden. The rays never depend on the answers, so they may be collected first
/// and traced together: shading once with dummy answers gives all the rays, and once more with the true
/// answers gives the light.
pub(super) trait OcclusionTest {
    /// Whether a surface lies between a point and the light in a direction.
    fn is_occluded(&mut self, origin: DVec3, direction: DVec3) -> bool;
}
