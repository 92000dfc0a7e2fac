//! What was combined by a boolean, in the report.
use super::{BoundFacts, InputFacts};
use serde::Serialize;

/// Solids that were combined, from left to right.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BooleanFacts {
    /// How they were cut along each other: "floating-point" or "rational".
    pub method: &'static str,
    /// All of them; the first is the input.
    pub operands: Vec<BooleanOperandFacts>,
}

/// One of the solids.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BooleanOperandFacts {
    /// "union", "difference" or "intersection"; `None` for the first.
    pub op: Option<&'static str>,
    /// Its file.
    pub input: InputFacts,
    /// The triangles that stood for it.
    pub triangles: u64,
    /// Those of the result that were cut from them.
    pub kept: u64,
    /// How far these triangles are from its true shape; `None` where they are its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bound: Option<BoundFacts>,
}
