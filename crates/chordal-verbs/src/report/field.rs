//! What a field is: only `inspect` says it.
use crate::{ImplicitShape, Parameter};
use chordal::budget::Evidence;
use chordal::math::Box3;
use serde::Serialize;

/// What there is of a field.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FieldFacts {
    /// 2 where the value does not depend on z, else 3.
    pub dimensions: u32,
    /// The distinct terms of its expression.
    pub terms: u64,
    /// What its value is worth as a distance where it is not negative: exact distance, lower bound or sign.
    pub outside: &'static str,
    /// The same where it is negative.
    pub inside: &'static str,
    /// What proofs about it are worth.
    pub evidence: &'static str,
    /// What that rests on without being checked: a sentence each.
    pub assumptions: Vec<String>,
    /// The lowest and highest coordinates between which all of it is known to be; null where none is known.
    pub reach: [[Option<f64>; 3]; 2],
    /// The box that it is cut off at, if there is one.
    pub region: Option<[[f64; 3]; 2]>,
    /// What its script can be given.
    pub parameters: Vec<Parameter>,
}

impl FieldFacts {
    pub(super) fn new(implicit: &ImplicitShape) -> Self {
        let field = &implicit.field;
        let tape = field.tape();
        let Box3 { min, max } = field.bounds();
        let evidence = field.evidence();
        let known = |x: f64| x.is_finite().then_some(x);
        Self {
            dimensions: if tape.axes()[2] { 3 } else { 2 },
            terms: tape.len() as u64,
            outside: field.distance().outside.as_str(),
            inside: field.distance().inside.as_str(),
            evidence: evidence.as_str(),
            assumptions: if let Evidence::ProvedIf(sentences) = evidence { sentences } else { Vec::new() },
            reach: [min.map(known), max.map(known)],
            region: implicit.region.map(|region| [region.min, region.max]),
            parameters: implicit.parameters.clone(),
        }
    }
}
