//! `RayGenerator`: the ray through a position in the picture; and the camera that frames a mesh.
use super::options::{RenderOptions, UpAxis};
use crate::budget::{Camera, Job, JobError, Projection, Refusal, RefusalCode, Screen, View};
use crate::explicit::{Mesh, Ray};
use crate::math::{greater, length, lesser};
use glam::DVec3;

/// The vertical field of view of the automatic viewpoint: a short telephoto, which keeps proportions.
const FOV_Y_DEG: f64 = 30.0;
/// Its direction, as angles to the right of the front and above it.
const AZIMUTH_DEG: f64 = 30.0;
const ELEVATION_DEG: f64 = 22.0;
/// The fraction of the picture's height and width that the mesh fills.
const FILL: f64 = 0.84;

/// The camera of the automatic viewpoint: three-quarters from the front, with all positions that faces use
/// inside the picture, and a margin.
///
/// ```
/// use chordal::Mesh;
/// use chordal::budget::camera::Screen;
/// use chordal::render::{UpAxis, frame};
/// let mesh = Mesh::new(vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]], vec![[0, 1, 2]]).unwrap();
/// let camera = frame(&mesh, UpAxis::Z, Screen { width_px: 640, height_px: 480 });
/// assert!(camera.eye[1] < 0.0 && camera.eye[2] > 0.0);
/// ```
#[must_use]
pub fn frame(mesh: &Mesh, up: UpAxis, screen: Screen) -> Camera {
    let used = || mesh.faces().iter().flatten().map(|i| DVec3::from(mesh.positions()[*i as usize]));
    frame_points(used, up, screen)
}

/// [`frame`] for any points.
pub(super) fn frame_points<I: Iterator<Item = DVec3>>(
    used: impl Fn() -> I,
    up: UpAxis,
    screen: Screen,
) -> Camera {
    let [azimuth, elevation] = [AZIMUTH_DEG, ELEVATION_DEG].map(f64::to_radians);
    let (sin_a, cos_a) = (libm::sin(azimuth), libm::cos(azimuth));
    let (sin_e, cos_e) = (libm::sin(elevation), libm::cos(elevation));
    let (top, front) = (DVec3::from(up.direction()), DVec3::from(up.front()));
    let side = top.cross(front);
    let towards_eye = (front * cos_a + side * sin_a) * cos_e + top * sin_e;
    let forward = -towards_eye;
    let right = forward.cross(top).normalize();
    let above = right.cross(forward);
    let tan_y = libm::tan(FOV_Y_DEG.to_radians() / 2.0) * FILL;
    let tan_x = tan_y * f64::from(screen.width_px) / f64::from(screen.height_px.max(1));
    // Any point near the mesh: differences from it keep their digits far from the origin.
    let centre = used().next().unwrap_or(DVec3::ZERO);
    // A point p at depth d is inside if |p·right| ≤ tan·d. In the eye's coordinates these are four
    // half-planes, each pushed out by one point. Opposite ones meet at the nearest eye for that axis; the
    // farther one serves both.
    let farthest = |slope: &dyn Fn(DVec3) -> f64| {
        used().map(|p| slope(p - centre)).fold(f64::NEG_INFINITY, |a, b| greater(b, a))
    };
    let ends = |axis: DVec3, tan: f64| {
        [1.0, -1.0].map(|sign| farthest(&|p| sign * axis.dot(p) - tan * forward.dot(p)))
    };
    let (x, y) = (ends(right, tan_x), ends(above, tan_y));
    //           ╲             ╱          The two planes that touch the points from both sides meet in the
    //            ╲   · · ·   ╱          eye that is as near as this axis permits.
    //             ╲ · · · · ╱
    //              ╲       ╱
    //               ╲     ╱
    //                 eye
    let depth = [(x, tan_x), (y, tan_y)].map(|([a, b], tan)| -(a + b) / (2.0 * tan));
    let depth = lesser(depth[0], depth[1]);
    let middle = |[a, b]: [f64; 2]| 0.5 * (a - b);
    let nearest = -farthest(&|p| -forward.dot(p));
    let offset = right * middle(x) + above * middle(y) + forward * depth;
    let size = nearest - depth;
    let (eye, distance) = if offset.is_finite() && size > 0.0 {
        (centre + offset, size)
    } else {
        // There are no faces, or all are in one point: the eye is one unit away.
        (centre + towards_eye, 1.0)
    };
    Camera {
        eye: eye.into(),
        target: (eye + forward * distance).into(),
        up: up.direction(),
        near: 0.0,
        projection: Projection::Perspective { fov_y_deg: FOV_Y_DEG },
        screen,
    }
}

/// A camera prepared for rays. Columns run along `x`, rows along `y` from the top; the middle of the first
/// pixel is (0.5, 0.5).
#[derive(Clone, Copy, Debug)]
pub(super) struct RayGenerator {
    /// The ray origin for position (0, 0), and its change per pixel.
    origin: DVec3,
    origin_by: [DVec3; 2],
    /// The same for the direction. Its component along the line of sight is 1, so `t` is depth.
    direction: DVec3,
    direction_by: [DVec3; 2],
    near: f64,
    eye: DVec3,
    forward: DVec3,
    perspective: bool,
}

impl RayGenerator {
    /// `None` if the camera has no axes.
    pub fn new(camera: &Camera) -> Option<Self> {
        let [right, up, forward] = camera.axes()?.map(DVec3::from);
        let eye = DVec3::from(camera.eye);
        let (width, height) = (f64::from(camera.screen.width_px), f64::from(camera.screen.height_px));
        // From the middle to the upper left corner of the picture, where rows and columns start.
        let corner = |by: [DVec3; 2]| -(by[0] * (0.5 * width) + by[1] * (0.5 * height));
        let zero = [DVec3::ZERO; 2];
        let near = camera.near;
        Some(match camera.projection {
            Projection::Perspective { fov_y_deg } => {
                let pixel = 2.0 * libm::tan(fov_y_deg.to_radians() / 2.0) / height;
                let by = [right * pixel, -up * pixel];
                let direction = forward + corner(by);
                let (origin_by, perspective) = (zero, true);
                Self { origin: eye, origin_by, direction, direction_by: by, near, eye, forward, perspective }
            }
            Projection::Orthographic { height: length } => {
                let pixel = length / height;
                let by = [right * pixel, -up * pixel];
                let origin = eye + corner(by);
                let (direction, direction_by, perspective) = (forward, zero, false);
                Self { origin, origin_by: by, direction, direction_by, near, eye, forward, perspective }
            }
        })
    }

    /// The ray through a position in the picture.
    pub fn ray(&self, [x, y]: [f64; 2]) -> Ray {
        let origin = self.origin + self.origin_by[0] * x + self.origin_by[1] * y;
        let direction = self.direction + self.direction_by[0] * x + self.direction_by[1] * y;
        Ray { origin: origin.into(), direction: direction.into(), t_min: self.near, t_max: f64::INFINITY }
    }

    /// The position of a point in the picture, and its depth along the line of sight.
    pub fn project(&self, p: [f64; 3]) -> [f64; 3] {
        let from = DVec3::from(p) - self.eye;
        let depth = from.dot(self.forward);
        let (by, at) = if self.perspective {
            (self.direction_by, from / depth - self.direction)
        } else {
            (self.origin_by, DVec3::from(p) - self.origin)
        };
        let [x, y] = by.map(|by| at.dot(by) / by.length_squared());
        [x, y, depth]
    }

    /// The direction in which a point is seen, of any length.
    pub fn look(&self, p: [f64; 3]) -> DVec3 {
        if self.perspective { DVec3::from(p) - self.eye } else { self.forward }
    }

    /// The distances in the picture from the point at which a ray meets a triangle to the triangle's edges.
    /// For the edge opposite each corner: the distance in pixels, and the height of the triangle above that
    /// edge in pixels.
    ///
    /// The triple product of a ray with two points vanishes if the ray meets the line through them. It is
    /// linear in the position, so its value over the length of its gradient is the distance in the picture,
    /// perspective included. The three products are in proportion to the barycentric weights, so their sum
    /// over the gradient is the height.
    pub fn edge_distances(&self, ray: &Ray, corners: [[f64; 3]; 3]) -> [[f64; 2]; 3] {
        let origin = DVec3::from(ray.origin);
        let direction = DVec3::from(ray.direction);
        let p = corners.map(|c| DVec3::from(c) - origin);
        let products: [[f64; 2]; 3] = std::array::from_fn(|k| {
            let (a, b) = (p[(k + 1) % 3], p[(k + 2) % 3]);
            let plane = a.cross(b);
            // If the origin moves by δ, (a − δ) × (b − δ)·d changes by (a − b) × δ·d.
            let gradient = [0, 1].map(|axis| {
                plane.dot(self.direction_by[axis]) + (a - b).cross(self.origin_by[axis]).dot(direction)
            });
            let length = length(gradient);
            [plane.dot(direction), length]
        });
        let sum = products[0][0] + products[1][0] + products[2][0];
        products.map(|[value, gradient]| [value.abs() / gradient, sum.abs() / gradient])
    }
}

/// The most samples along a pixel's side.
const MOST_SAMPLES: u32 = 16;

/// The ray generator, if camera and options are valid.
pub(super) fn ray_generator(
    camera: &Camera,
    options: &RenderOptions,
    job: &Job,
) -> Result<RayGenerator, JobError> {
    let refused = |code, message: String| JobError::Refused(Refusal::new(code, message));
    View::Camera(*camera).checked().map_err(|wrong| refused(RefusalCode::Unsupported, wrong.to_string()))?;
    let eye = RayGenerator::new(camera)
        .ok_or_else(|| refused(RefusalCode::Unsupported, "the camera has no axes".into()))?;
    if options.samples == 0 || options.samples > MOST_SAMPLES {
        let message =
            format!("samples along a pixel's side are 1 to {MOST_SAMPLES}, not {}", options.samples);
        return Err(refused(RefusalCode::Unsupported, message));
    }
    let Screen { width_px: width, height_px: height } = camera.screen;
    // Each tile is stored twice, by itself and in the picture; a mesh has a depth of lines in each pixel.
    let bytes = (12 * u64::from(width)).saturating_mul(u64::from(height));
    if bytes > job.memory_limit {
        let message =
            format!("{width}x{height} pixels need {bytes} bytes; the limit is {}", job.memory_limit);
        return Err(refused(RefusalCode::TooMuchMemory, message));
    }
    Ok(eye)
}
