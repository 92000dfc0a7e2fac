//! Nearest points of patches and limit surfaces: enclosures that hold, as plain samples and closed forms see
//! them.

mod cages;
mod closed;
mod deviation;
mod patches;

use crate::cages::corpus;
use chordal::explicit::query::SurfaceClosestPoint;
use chordal_testkit::sampler::{Point, distance};

/// A foot is right where its own place is as near as it says, and no sample is nearer than it says.
/// `rounding` is what the referee's own points may be off.
pub(crate) fn judge(foot: &SurfaceClosestPoint, p: Point, at: Point, samples: &[Point], rounding: f64) {
    let said = format!("{foot:?} of {p:?}");
    assert!(0.0 <= foot.at_least && foot.at_least <= foot.at_most, "{said}");
    assert!(distance(at, p) <= foot.at_most + rounding, "{} at its place: {said}", distance(at, p));
    assert!(distance(at, foot.point) <= 2.0 * rounding, "{at:?} is not its point: {said}");
    let nearest = samples.iter().map(|q| distance(*q, p)).fold(f64::INFINITY, f64::min);
    assert!(nearest >= foot.at_least - rounding, "a sample at {nearest}: {said}");
}
