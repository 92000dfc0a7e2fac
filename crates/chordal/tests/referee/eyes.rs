//! Eyes: where they are, where they look, and where they see a point. No code of the library's views.
use super::frame::frame;
use chordal::budget::camera::{Projection, Screen};
use chordal_testkit::Random;
use chordal_testkit::sampler::{
    Bounds, Control, Point, add, around, distance, distance_to_bounds, dot, quarters, scale, sub,
};

/// An eye with its picture.
pub struct Eye {
    pub at: Point,
    /// Right, up, forward.
    pub axes: [Point; 3],
    pub lens: Lens,
    /// What is nearer is not drawn.
    pub near: f64,
}

/// How directions become pixels.
#[derive(Clone, Copy, Debug)]
pub struct Lens {
    pub projection: Projection,
    pub screen: Screen,
}

impl Lens {
    /// A pinhole of 5 to 120 degrees.
    pub fn pinhole(r: &mut Random) -> Self {
        Self { projection: Projection::Perspective { fov_y_deg: r.between(5.0, 120.0) }, screen: screen(r) }
    }

    /// Half the picture's width and height in pixels.
    fn half(&self) -> [f64; 2] {
        [f64::from(self.screen.width_px) / 2.0, f64::from(self.screen.height_px) / 2.0]
    }

    /// Pixels for one unit: of X/z through a pinhole, of length with parallel rays.
    fn focal(&self) -> f64 {
        match self.projection {
            Projection::Perspective { fov_y_deg } => self.half()[1] / (fov_y_deg.to_radians() / 2.0).tan(),
            Projection::Orthographic { height } => 2.0 * self.half()[1] / height,
        }
    }

    /// The direction, with axes right, up, forward, that is seen at a place of the picture, -1 to 1 each way.
    fn ray(&self, place: [f64; 2]) -> Point {
        let [x, y] = [0, 1].map(|k| place[k] * self.half()[k] / self.focal());
        [x, y, 1.0]
    }
}

fn screen(r: &mut Random) -> Screen {
    let (width_px, height_px) = [(1920, 1080), (640, 480), (300, 900), (1000, 1000)][r.below(4)];
    Screen { width_px, height_px }
}

/// A place of the picture: anywhere, in a corner, or in the middle.
pub fn place(r: &mut Random) -> [f64; 2] {
    match r.below(4) {
        0 => [0.0, 0.0],
        1 => [[1.0, -1.0][r.below(2)], [1.0, -1.0][r.below(2)]].map(|x| 0.999 * x),
        _ => [r.between(-1.0, 1.0), r.between(-1.0, 1.0)],
    }
}

impl Eye {
    /// An eye that sees `point` at a place of its picture.
    pub fn aimed(at: Point, point: Point, lens: Lens, r: &mut Random) -> Self {
        let ray = lens.ray(place(r));
        // The turn that brings the ray, and any direction across it, to where they belong.
        let (from, to) = (frame(r, ray), frame(r, sub(point, at)));
        let turned = |axis: usize| (0..3).fold([0.0; 3], |sum, k| add(sum, scale(to[k], from[k][axis])));
        Self { at, axes: [0, 1, 2].map(turned), lens, near: 0.0 }
    }

    /// Where a point is on the picture, in pixels from its middle; `None` behind the eye.
    pub fn project(&self, point: Point) -> Option<[f64; 2]> {
        let [x, y, z] = self.axes.map(|axis| dot(sub(point, self.at), axis));
        let focal = self.lens.focal();
        match self.lens.projection {
            Projection::Perspective { .. } => (z > 0.0).then(|| [focal * x / z, focal * y / z]),
            Projection::Orthographic { .. } => Some([focal * x, focal * y]),
        }
    }

    /// Whether a point is drawn.
    fn sees(&self, point: Point) -> bool {
        let deep = dot(sub(point, self.at), self.axes[2]) >= self.near;
        let inside = |[x, y]: [f64; 2]| x.abs() <= self.lens.half()[0] && y.abs() <= self.lens.half()[1];
        deep && self.project(point).is_some_and(inside)
    }

    /// How far two points that should be one are apart on the picture; 0 where neither is on it.
    pub fn apart(&self, a: Point, b: Point) -> f64 {
        if !self.sees(a) && !self.sees(b) {
            return 0.0;
        }
        match (self.project(a), self.project(b)) {
            (Some([ax, ay]), Some([bx, by])) => ((ax - bx).powi(2) + (ay - by).powi(2)).sqrt(),
            _ => f64::INFINITY,
        }
    }
}

/// A box around patches, tight to about a part in 1e4: the hulls of their 16 × 16 parts.
pub fn box_of(controls: &[Control]) -> Bounds {
    let mut parts = controls.to_vec();
    for _ in 0..4 {
        parts = parts.iter().flat_map(|part| quarters(part).map(|(quarter, _)| quarter)).collect();
    }
    around(parts.into_iter().flatten().flatten())
}

/// The place from `point` in a direction that is `away` from the box.
pub fn step_out(bounds: &Bounds, point: Point, direction: Point, away: f64) -> Point {
    let at = |t: f64| add(point, scale(direction, t));
    let (mut near, mut far) =
        (0.0, 2.0 * away + 2.0 * distance(bounds[0], bounds[1]) + 2.0 * distance(bounds[0], point));
    for _ in 0..80 {
        let middle = 0.5 * (near + far);
        if distance_to_bounds(bounds, at(middle)) < away { near = middle } else { far = middle }
    }
    at(far)
}
