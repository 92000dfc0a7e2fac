//! `OffsetFacts`: the other surface of a solid that a result is.
use serde::{Deserialize, Serialize};

/// An offset of triangles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OffsetFacts {
    /// "outward", "inward", or "hollow": the solid's own surface, and the inward one as that of a cavity.
    pub kind: String,
    /// The distance, in the units of the input.
    pub distance: f64,
}
