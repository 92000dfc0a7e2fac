//! `ScreenMesh`: the vertices of a mesh on the screen of a camera; triangles that leave the screen are
//! clipped.
use super::raster_triangle::{MOST, RasterVertex, STEPS};
use crate::budget::{Camera, Job, JobError, Projection, Refusal, RefusalCode, View, par_map};
use crate::explicit::Mesh;
use crate::math::{greater, lesser};
use glam::DVec3;

/// The guard band: triangles are clipped this many pixels from the middle of the screen, far outside every
/// screen, so that nearly none are.
const GUARD_PX: f64 = (1 << 21) as f64;
/// The most columns or rows of a screen: fixed-point numbers can hold them and the guard band.
pub(super) const MOST_PX: u32 = 1 << 20;
/// The least depth relative to that of the farthest vertex: depths this small are mostly rounding, so they
/// are clipped even if the near plane is at 0. Derived: a depth loses some 4 · 2⁻⁵³ of it.
const LEAST_DEPTH: f64 = 1.0 / (1_u64 << 50) as f64;
/// Vertices or triangles a task: enough to hide the overhead of a task.
pub(super) const CHUNK: usize = 8192;

/// A mesh before a camera.
pub(super) struct ScreenMesh<'a> {
    pub mesh: &'a Mesh,
    camera: RasterCamera,
    /// One for each vertex.
    vertices: Vec<RasterVertex>,
    /// Columns and rows of the screen.
    pub size: [i64; 2],
}

/// The eye and the projection of a point.
struct RasterCamera {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    parallel: bool,
    /// A power of two that keeps differences in range.
    shrink: f64,
    near: f64,
    /// The largest offset from the axis at depth 1 (or at any depth, for parallel rays) within the guard
    /// band.
    slope: f64,
    /// Pixels per unit of that offset.
    focal: f64,
    middle: [f64; 2],
    /// The divisor of depths.
    reach: f64,
}

/// The planes of the clipped space: the near plane and the guard band's four.
const PLANES: usize = 5;

impl RasterCamera {
    fn new(camera: &Camera, mesh: &Mesh) -> Result<Self, JobError> {
        let refused = |message: String| JobError::Refused(Refusal::new(RefusalCode::Unsupported, message));
        View::Camera(*camera).checked().map_err(|wrong| refused(wrong.to_string()))?;
        let axes = camera.axes().ok_or_else(|| refused("the camera has no axes".to_owned()))?;
        let [right, up, forward] = axes.map(DVec3::from);
        let bounds = mesh.bounds();
        let values = bounds.min.iter().chain(&bounds.max).chain(&camera.eye).filter(|x| x.is_finite());
        // Differences of two such values, and sums of three of those, stay in range. It is a power of two, so
        // scaling does not round.
        let shrink = if values.into_iter().any(|x| x.abs() > f64::MAX / 16.0) { 0.0625 } else { 1.0 };
        let [width, height] = [camera.screen.width_px, camera.screen.height_px].map(f64::from);
        let (parallel, focal) = match camera.projection {
            Projection::Perspective { fov_y_deg } => {
                (false, 0.5 * height / libm::tan(fov_y_deg * (std::f64::consts::PI / 360.0)))
            }
            Projection::Orthographic { height: length } => (true, height / length / shrink),
        };
        if !(focal.is_finite() && focal > 0.0) {
            return Err(refused("the field of view is too narrow or too wide for numbers".to_owned()));
        }
        let mut seat = Self {
            eye: DVec3::from(camera.eye) * shrink,
            right,
            up,
            forward,
            parallel,
            shrink,
            near: camera.near * shrink,
            slope: GUARD_PX / focal,
            focal,
            middle: [0.5 * width, 0.5 * height],
            reach: 1.0,
        };
        let far = |sum: f64, row: &u32| {
            let size = seat.to_eye_space(mesh.positions()[*row as usize]).abs().max_element();
            greater(size, sum)
        };
        // Only vertices with a face: others would make the least depth larger than the shape needs.
        let reach = mesh.faces().iter().flatten().fold(0.0, far);
        seat.reach = if reach > 0.0 { reach } else { 1.0 };
        let least = if parallel { 0.0 } else { LEAST_DEPTH * seat.reach };
        seat.near = greater(seat.near, least);
        Ok(seat)
    }

    /// A point in eye space: its distances to the right of the eye, above it and before it.
    fn to_eye_space(&self, point: [f64; 3]) -> DVec3 {
        let to = DVec3::from(point) * self.shrink - self.eye;
        DVec3::new(self.right.dot(to), self.up.dot(to), self.forward.dot(to))
    }

    /// The signed distance of a point in eye space from a plane, positive inside.
    fn plane_distance(&self, plane: usize, p: DVec3) -> f64 {
        let slack = if self.parallel { self.slope } else { self.slope * p.z };
        match plane {
            0 => p.z - self.near,
            1 => slack - p.x,
            2 => slack + p.x,
            3 => slack - p.y,
            _ => slack + p.y,
        }
    }

    fn is_clipped(&self, p: DVec3) -> bool {
        !(0..PLANES).all(|plane| self.plane_distance(plane, p) >= 0.0)
    }

    /// The position on the screen, rounded to the nearest step; halves go down and to the right.
    fn to_screen(&self, p: DVec3) -> RasterVertex {
        let depth = if self.parallel { 1.0 } else { p.z };
        let position =
            [self.middle[0] + self.focal * (p.x / depth), self.middle[1] - self.focal * (p.y / depth)];
        let at = position.map(|pixels| {
            let steps = (pixels * STEPS as f64 + 0.5).floor();
            let steps = greater(steps, -MOST);
            (lesser(steps, MOST)) as i32
        });
        let nearness = if self.parallel { -p.z / self.reach } else { self.reach / p.z };
        RasterVertex { at, nearness }
    }

    /// The point at which the segment from `a` to `b` meets a plane, the same for both directions, so that
    /// neighbours are clipped alike.
    fn clip_edge(&self, plane: usize, a: DVec3, b: DVec3) -> DVec3 {
        let less = (0..3).map(|k| a[k].total_cmp(&b[k])).find(|order| order.is_ne());
        let (a, b) = if less == Some(std::cmp::Ordering::Greater) { (b, a) } else { (a, b) };
        let (at_a, at_b) = (self.plane_distance(plane, a), self.plane_distance(plane, b));
        let mut point = a + (b - a) * (at_a / (at_a - at_b));
        // Rounding could leave it on the wrong side of the near plane, and the projection divides
        // by `z`.
        if plane == 0 {
            point.z = self.near;
        }
        point
    }
}

impl<'a> ScreenMesh<'a> {
    pub fn new(mesh: &'a Mesh, camera: &Camera, job: &Job) -> Result<Self, JobError> {
        let seat = RasterCamera::new(camera, mesh)?;
        let chunks: Vec<&[[f64; 3]]> = mesh.positions().chunks(CHUNK).collect();
        let spots = par_map(job, &chunks, |_, chunk| {
            if job.is_cancelled() {
                return Vec::new();
            }
            let vertex_on_screen = |point: &[f64; 3]| {
                let eye_point = seat.to_eye_space(*point);
                if seat.is_clipped(eye_point) {
                    // A mark: triangles with such a vertex are clipped in the space of the eye.
                    RasterVertex { at: [0; 2], nearness: f64::NAN }
                } else {
                    seat.to_screen(eye_point)
                }
            };
            chunk.iter().map(vertex_on_screen).collect()
        });
        if job.is_cancelled() {
            return Err(JobError::Cancelled);
        }
        let size = [camera.screen.width_px, camera.screen.height_px].map(i64::from);
        Ok(Self { mesh, camera: seat, vertices: spots.concat(), size })
    }

    /// The triangles on the screen of a face: none, the face itself, or a fan around the first corner of its
    /// part between the planes.
    pub fn clipped_triangles(&self, face: usize, mut each: impl FnMut(&[RasterVertex; 3])) {
        let corners = self.mesh.faces()[face];
        let vertices = corners.map(|row| self.vertices[row as usize]);
        if !vertices.iter().any(|spot| spot.nearness.is_nan()) {
            return each(&vertices);
        }
        let mut polygon: Vec<DVec3> = corners
            .iter()
            .map(|row| self.camera.to_eye_space(self.mesh.positions()[*row as usize]))
            .collect();
        for plane in 0..PLANES {
            polygon = self.clip_polygon(plane, &polygon);
        }
        let spots: Vec<RasterVertex> = polygon.iter().map(|p| self.camera.to_screen(*p)).collect();
        for pair in spots.get(1..).unwrap_or(&[]).windows(2) {
            each(&[spots[0], pair[0], pair[1]]);
        }
    }

    /// The part of a convex polygon inside a plane.
    ///
    /// Source: I. Sutherland and G. Hodgman, *Reentrant polygon clipping*, 1974.
    fn clip_polygon(&self, plane: usize, polygon: &[DVec3]) -> Vec<DVec3> {
        let mut clipped = Vec::with_capacity(polygon.len() + 1);
        for (k, a) in polygon.iter().enumerate() {
            let b = polygon[(k + 1) % polygon.len()];
            let [a_in, b_in] = [*a, b].map(|p| self.camera.plane_distance(plane, p) >= 0.0);
            if a_in {
                clipped.push(*a);
            }
            if a_in != b_in {
                clipped.push(self.camera.clip_edge(plane, *a, b));
            }
        }
        clipped
    }

    /// Whether the eye is on the front side of the plane through a point with that normal.
    pub fn sees_front(&self, point: [f64; 3], normal: DVec3) -> bool {
        let to = if self.camera.parallel {
            self.camera.forward
        } else {
            DVec3::from(point) * self.camera.shrink - self.camera.eye
        };
        normal.dot(to) <= 0.0
    }

    /// The axes to the right of the screen, up on it, and towards the eye.
    pub fn axes(&self) -> [DVec3; 3] {
        [self.camera.right, self.camera.up, -self.camera.forward]
    }
}
