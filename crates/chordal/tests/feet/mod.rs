//! Nearest points of patches and limit surfaces: enclosures that hold, as plain samples and closed forms see them.

mod cages;
mod closed;
mod deviation;
mod patches;

use crate::cages::corpus;
use chordal::explicit::SurfaceClosestPoint;

pub(crate) type Point = [f64; 3];

pub(crate) fn distance(a: Point, b: Point) -> f64 {
    let square: f64 = (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum();
    square.sqrt()
}

/// Numbers that look random and are the same everywhere.
pub(crate) struct Random(pub u64);

impl Random {
    /// From −1 to 1.
    pub(crate) fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub(crate) fn point(&mut self, size: f64) -> Point {
        [0; 3].map(|_| size * self.signed())
    }
}

/// A foot is right where its own place is as near as it says, and no sample is nearer than it says. `rounding` is what the
/// referee's own points may be off.
pub(crate) fn judge(foot: &SurfaceClosestPoint, p: Point, at: Point, samples: &[Point], rounding: f64) {
    let said = format!("{foot:?} of {p:?}");
    assert!(0.0 <= foot.at_least && foot.at_least <= foot.at_most, "{said}");
    assert!(distance(at, p) <= foot.at_most + rounding, "{} at its place: {said}", distance(at, p));
    assert!(distance(at, foot.point) <= 2.0 * rounding, "{at:?} is not its point: {said}");
    let nearest = samples.iter().map(|q| distance(*q, p)).fold(f64::INFINITY, f64::min);
    assert!(nearest >= foot.at_least - rounding, "a sample at {nearest}: {said}");
}
