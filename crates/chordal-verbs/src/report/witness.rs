//! `WitnessFacts`: one occurrence of a defect, in the report.
use serde::Serialize;

/// One occurrence of a defect. All numbers are rows of the part's arrays.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WitnessFacts {
    /// The name of its count.
    pub of: &'static str,
    /// The index of the part.
    pub part: u64,
    /// The part of the second triangle, if two placements intersect.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other_part: Option<u64>,
    /// Rows of the positions.
    pub vertices: Vec<u32>,
    /// Rows of the triangles.
    pub faces: Vec<u32>,
    /// A point there, in the part's own coordinates; in world coordinates if two placements intersect.
    pub at: [f64; 3],
}
