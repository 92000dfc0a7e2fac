//! Levels of detail in the report.
use super::{AttributeFacts, ViewFacts};
use serde::Serialize;

/// The levels, their switch distances, and the level shown at some distances.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LevelsFacts {
    /// The largest error on the screen, in pixels.
    pub pixels: f64,
    /// The screen and the lens for which distances hold; its distance is that of the finest level.
    pub view: ViewFacts,
    /// The hysteresis: the factor on a coarser level's own distance from which on it takes over.
    pub hysteresis: f64,
    /// The levels, the finest first.
    pub levels: Vec<LevelFacts>,
    /// The level shown at some distances, the nearest first.
    pub shown: Vec<LevelChoiceFacts>,
}

/// One level of the shape.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LevelFacts {
    /// Its triangles.
    pub triangles: u64,
    /// Its rows of positions.
    pub vertices: u64,
    /// Its distance from the true shape is at least this.
    pub at_least: f64,
    /// Its distance from the true shape is at most this.
    pub at_most: f64,
    /// The evidence: proved, or proved under the assumptions of the certificate's bound.
    pub evidence: &'static str,
    /// The distance to the box from which on it may be shown, anywhere on the screen; `None` if no distance is far enough.
    pub distance: Option<f64>,
    /// The number of its files.
    pub tiles: u64,
    /// The digest of its geometry; `None` if it is cut in space, into files with a digest each.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub geometry: Option<String>,
    /// The deviations of attributes from those of the input, if these have limits.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub attributes: Vec<AttributeFacts>,
}

/// The level shown at a distance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LevelChoiceFacts {
    /// The distance from the eye to the box.
    pub distance: f64,
    /// The diagonal of the box on the screen, in pixels.
    pub covers_px: f64,
    /// The level, 0 the finest.
    pub level: usize,
    /// Its triangles.
    pub triangles: u64,
    /// No point is farther off than this many pixels; `None` if the eye is too close for a bound.
    pub pixels: Option<f64>,
}
