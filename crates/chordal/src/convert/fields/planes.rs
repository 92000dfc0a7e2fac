//! What a field looks like near a point, and where two or three such planes meet.
use crate::implicit::Slope;
use crate::math::{cross, difference, dot, length};

type Point = [f64; 3];

/// The plane that a field looks like from a point.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    at: Point,
    /// The height of `at` over the plane.
    height: f64,
    /// The unit normal, outward.
    pub normal: Point,
}

/// Planes that turn less than this against each other, about 20°, make no crease; exactly a cosine of 0.94.
const TURN: f64 = 0.94;
/// Planes that turn more than this meet at a wedge too thin to compute with; exactly a cosine of −0.995.
const THIN: f64 = -0.995;
/// Three planes whose normals span less than this share of a cube have no corner that could be computed; exact.
const FLAT: f64 = 1.0 / 32.0;

impl Plane {
    /// `None` where there is no gradient.
    pub fn of(at: Point, slope: &Slope<f64>) -> Option<Self> {
        let size = length(slope.gradient);
        let height = slope.value / size;
        let normal = slope.gradient.map(|g| g / size);
        (height.is_finite() && normal.iter().all(|n| n.is_finite())).then_some(Self { at, height, normal })
    }

    /// The plane through a point with a normal of any length but 0.
    pub fn through(at: Point, normal: Point) -> Option<Self> {
        Self::of(at, &Slope { value: 0.0, gradient: normal })
    }

    /// How far a point is above.
    pub fn over(&self, p: Point) -> f64 {
        self.height + dot(self.normal, difference(p, self.at))
    }

    /// The next point of the plane.
    pub fn foot(&self, p: Point) -> Point {
        plus(p, -self.over(p), self.normal)
    }
}

/// The point of both planes that is next to `p`, where they make a crease.
pub(super) fn crease(p: Point, a: &Plane, b: &Plane) -> Option<Point> {
    let cosine = dot(a.normal, b.normal);
    if !(THIN..TURN).contains(&cosine) {
        return None;
    }
    let det = 1.0 - cosine * cosine;
    let (h, k) = (-a.over(p), -b.over(p));
    let along = |x: f64, y: f64| plus(plus(p, x, a.normal), y, b.normal);
    Some(along((h - cosine * k) / det, (k - cosine * h) / det))
}

/// The point of three planes, where they make a corner.
pub(super) fn corner(p: Point, planes: [&Plane; 3]) -> Option<Point> {
    let [a, b, c] = planes.map(|plane| plane.normal);
    let (bc, ca, ab) = (cross(b, c), cross(c, a), cross(a, b));
    let det = dot(a, bc);
    if det.abs() < FLAT {
        return None;
    }
    let [h, k, l] = planes.map(|plane| -plane.over(p) / det);
    Some(plus(plus(plus(p, h, bc), k, ca), l, ab))
}

/// a + t·d.
pub(super) fn plus(a: Point, t: f64, d: Point) -> Point {
    [a[0] + t * d[0], a[1] + t * d[1], a[2] + t * d[2]]
}

/// The share `t` of the way from a to b.
pub(super) fn between(a: Point, b: Point, t: f64) -> Point {
    plus(a, t, difference(b, a))
}
