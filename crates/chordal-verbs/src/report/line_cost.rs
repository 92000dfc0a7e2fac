//! `LineCostFacts`: the cost of a line of a script.
use super::BoundFacts;
use serde::Serialize;

/// The cost of meshing the shape of a line by itself.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LineCostFacts {
    /// The number of the line, from 1; `None` for the shape of the whole script.
    pub line: Option<u64>,
    /// How often the line ran.
    pub times: u64,
    /// The triangles of its shape; `None` if it has no mesh.
    pub triangles: Option<u64>,
    /// The time for the mesh.
    pub seconds: f64,
    /// The bound of the mesh.
    pub bound: Option<BoundFacts>,
    /// Why there is no mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}
