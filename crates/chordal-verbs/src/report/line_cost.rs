//! `LineCostFacts`: what a line of a script takes.
use super::BoundFacts;
use serde::Serialize;

/// What the shape of a line takes to be meshed by itself.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LineCostFacts {
    /// The number of the line, from 1; `None` for the shape of the whole script.
    pub line: Option<u64>,
    /// How often the line ran.
    pub times: u64,
    /// The triangles of its shape; `None` where it has no mesh.
    pub triangles: Option<u64>,
    /// How long that took.
    pub seconds: f64,
    /// The bound of the mesh.
    pub bound: Option<BoundFacts>,
    /// Why there is no mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}
