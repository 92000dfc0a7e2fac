//! `Sight`: the pixels of a camera's picture, for drawings in the plane of the picture.
use chordal::budget::camera::{Camera, Projection};
use chordal::math::{elementary::sin_cos, unit};

/// A camera prepared for projecting points.
pub(super) struct Sight {
    eye: [f64; 3],
    /// Right, down and forward.
    axes: [[f64; 3]; 3],
    middle: [f64; 2],
    /// Pixels of a unit at depth 1.
    focal: f64,
}

impl Sight {
    /// Fails if the camera looks nowhere, or with parallel rays.
    pub fn new(camera: &Camera) -> Result<Self, String> {
        let Projection::Perspective { fov_y_deg } = camera.projection else {
            return Err("a picture in perspective is needed".to_owned());
        };
        let ahead = std::array::from_fn(|k| camera.target[k] - camera.eye[k]);
        let forward = unit(ahead).ok_or("the eye is at its target")?;
        let right = unit(cross(forward, camera.up)).ok_or("the eye looks along the vertical")?;
        let (sin, cos) = sin_cos(0.5 * fov_y_deg.to_radians());
        let [width, height] = [camera.screen.width_px, camera.screen.height_px].map(f64::from);
        Ok(Self {
            eye: camera.eye,
            axes: [right, cross(forward, right), forward],
            middle: [0.5 * width, 0.5 * height],
            focal: 0.5 * height * cos / sin,
        })
    }

    /// Columns from the left, rows from the top, and the depth; `None` for a point that is not in front of the eye.
    pub fn pixel(&self, point: [f64; 3]) -> Option<[f64; 3]> {
        let from: [f64; 3] = std::array::from_fn(|k| point[k] - self.eye[k]);
        let [x, y, depth] = self.axes.map(|axis| dot(axis, from));
        let scale = self.focal / depth;
        (depth > 0.0).then(|| [self.middle[0] + scale * x, self.middle[1] + scale * y, depth])
    }
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
