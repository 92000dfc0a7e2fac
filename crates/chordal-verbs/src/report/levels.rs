//! Levels of detail, as a report says them.
use super::ViewFacts;
use serde::Serialize;

/// The levels that were made, from where each may be shown, and what is shown at some distances.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LevelsFacts {
    /// The most that may be lost on the screen, in pixels.
    pub pixels: f64,
    /// The screen and the lens that distances are for; the distance is that of the finest level.
    pub view: ViewFacts,
    /// How much farther out than its own distance a coarser level takes over.
    pub hysteresis: f64,
    /// The finest first.
    pub levels: Vec<LevelFacts>,
    /// What is shown at some distances, the nearest first.
    pub shown: Vec<LevelChoiceFacts>,
}

/// One level: what is shown of the whole where it is fine enough.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LevelFacts {
    /// Its triangles.
    pub triangles: u64,
    /// Its rows of positions.
    pub vertices: u64,
    /// It is at least this far from the true shape.
    pub at_least: f64,
    /// It is at most this far.
    pub at_most: f64,
    /// How that is known: proved, or proved on what the bound of the whole assumes.
    pub evidence: &'static str,
    /// From this distance to the box on it may be shown, anywhere on the screen; none where no distance is far enough.
    pub distance: Option<f64>,
    /// In how many files it is.
    pub tiles: u64,
}

/// What is shown at a distance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LevelChoiceFacts {
    /// From the eye to the box.
    pub distance: f64,
    /// The diagonal of the box on the screen, in pixels.
    pub covers_px: f64,
    /// The level, 0 the finest.
    pub level: usize,
    /// Its triangles.
    pub triangles: u64,
    /// No point is farther off than this many pixels; none where the eye is too close for a bound.
    pub pixels: Option<f64>,
}
