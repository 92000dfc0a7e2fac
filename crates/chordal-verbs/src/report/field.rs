//! Fields, and the cost of the lines of a script, in the report; only from `inspect`.
use super::BoundFacts;
use crate::{ImplicitShape, Parameter};
use chordal::budget::Evidence;
use chordal::math::Box3;
use serde::Serialize;

/// The facts about a field.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FieldFacts {
    /// 2 if the value does not depend on z, otherwise 3.
    pub dimensions: u32,
    /// The distinct terms of its expression.
    pub terms: u64,
    /// How its value relates to the distance where it is not negative: exact distance, lower bound or sign.
    pub outside: &'static str,
    /// How its value relates to the distance where it is negative.
    pub inside: &'static str,
    /// The evidence of proofs about it.
    pub evidence: &'static str,
    /// The unchecked assumptions of that evidence: a sentence each.
    pub assumptions: Vec<String>,
    /// The lowest and highest coordinates of its known extent; null if unknown.
    pub reach: [[Option<f64>; 3]; 2],
    /// The box that clips it, if there is one.
    pub region: Option<[[f64; 3]; 2]>,
    /// The parameters of its script.
    pub parameters: Vec<Parameter>,
}

impl FieldFacts {
    pub(super) fn new(implicit: &ImplicitShape) -> Self {
        let field = &implicit.field;
        let tape = field.tape();
        let Box3 { min, max } = field.bounds();
        let evidence = field.evidence();
        let finite = |x: f64| x.is_finite().then_some(x);
        Self {
            dimensions: if tape.axes()[2] { 3 } else { 2 },
            terms: tape.len() as u64,
            outside: field.distance().outside.as_str(),
            inside: field.distance().inside.as_str(),
            evidence: evidence.as_str(),
            assumptions: if let Evidence::ProvedIf(sentences) = evidence { sentences } else { Vec::new() },
            reach: [min.map(finite), max.map(finite)],
            region: implicit.region.map(|region| [region.min, region.max]),
            parameters: implicit.parameters.clone(),
        }
    }
}

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
