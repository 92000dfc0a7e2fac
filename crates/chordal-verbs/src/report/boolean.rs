//! The operands of a boolean, in the report.
use super::{BoundFacts, InputFacts};
use serde::Serialize;

/// Solids that were combined, from left to right.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BooleanFacts {
    /// How they were cut along each other: "floating-point" or "rational".
    pub method: &'static str,
    /// All solids; the first is the input.
    pub operands: Vec<BooleanOperandFacts>,
}

/// One of the solids.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BooleanOperandFacts {
    /// "union", "difference" or "intersection"; `None` for the first.
    pub op: Option<&'static str>,
    /// Its file.
    pub input: InputFacts,
    /// The triangles of the solid before it was cut.
    pub triangles: u64,
    /// The triangles of the result that were cut from them.
    pub kept: u64,
    /// The bound of these triangles against the true shape; `None` if they are the shape itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bound: Option<BoundFacts>,
}
