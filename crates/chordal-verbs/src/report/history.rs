//! The history of a result: every step since the first file, each with its bound, and their sum.
use super::{BoundFacts, OffsetFacts};
use crate::scene::placements::{IDENTITY, Matrix4, largest_stretch, smallest_stretch};
use chordal::budget::{Bound, Evidence, Metric, Reference};
use serde::{Deserialize, Serialize};

/// The steps that led to a result, as far back as the certificates of the inputs prove them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HistoryFacts {
    /// Why there is no earlier step.
    pub begins: HistoryStart,
    /// The steps, the last of which built this result.
    pub steps: Vec<StepFacts>,
    /// The sum of the bounds of all steps: from the first input to this result; `None` if a step has no bound.
    pub total: Option<StepBound>,
}

/// The reason why a history does not go back further.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HistoryStart {
    /// "no-certificate" for an input from another program. Or the reason why the certificate of the input does not fit this
    /// step: "unreadable", "no-history", "seal", "geometry", "unit", "kind", "surface", "bound", "several-inputs". Or
    /// "composed" if the inputs of the first step have histories of their own, "long" if these go too far back.
    pub code: String,
    /// The reason in one sentence.
    pub reason: String,
}

impl HistoryStart {
    pub(crate) fn new(code: &str, reason: impl Into<String>) -> Self {
        Self { code: code.to_owned(), reason: reason.into() }
    }
}

/// One step of a history.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepFacts {
    /// The verb.
    pub verb: String,
    /// The version of Chordal.
    pub version: String,
    /// The files that it read: one, or several that were combined.
    pub inputs: Vec<StepInput>,
    /// The places of the inputs, if they were moved, rotated, scaled or put next to each other before the step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub composed: Option<ComposedFacts>,
    /// The other surface of the input that it wrote; its bound is against that.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub offset: Option<OffsetFacts>,
    /// The file that it wrote.
    pub output: StepOutput,
    /// The bound of the output against the input; `None` if nothing is known of it.
    pub bound: Option<StepBound>,
}

/// A file that a step read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepInput {
    /// The kind of shape.
    pub kind: String,
    /// The format.
    pub format: String,
    /// The SHA-256 of the bytes; for a shape that was never a file, of its geometry or formula, `None` if it has no digest.
    pub sha256: Option<String>,
    /// The SHA-256 of the bytes of the files beside it that were read.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<String>,
}

/// Triangles that are put together: the inputs of a step, each moved by maps, with their histories.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ComposedFacts {
    /// The history of each input.
    pub origins: Vec<HistoryFacts>,
    /// The places of the inputs, in the order of their triangles.
    pub places: Vec<PlaceFacts>,
    /// The largest distance of the triangles that the step read from their exact places.
    pub rounding: f64,
}

/// The place of an input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaceFacts {
    /// The index of the input.
    pub input: usize,
    /// The affine map of the input: the first three rows of its matrix, row by row; `None` if it is not moved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<[f64; 12]>,
}

impl PlaceFacts {
    /// The map as a matrix, column by column.
    pub(crate) fn matrix(&self) -> Matrix4 {
        let Some(rows) = self.map else { return IDENTITY };
        std::array::from_fn(|k| match (k % 4, k / 4) {
            (3, column) => f64::from(u8::from(column == 3)),
            (row, column) => rows[4 * row + column],
        })
    }

    /// The largest factor by which the map lengthens, rounded up.
    pub(crate) fn longest(&self) -> f64 {
        largest_stretch(&self.matrix())
    }
}

impl ComposedFacts {
    /// The bound of all of it against the first shapes of the inputs, moved by the maps; `None` if an input has no bound.
    pub(crate) fn bound(&self) -> Option<Bound> {
        let input_bounds: Vec<Option<Bound>> =
            self.origins.iter().map(HistoryFacts::bound_of_input).collect();
        let mut total: Option<Bound> = None;
        for place in &self.places {
            let placed = input_bounds
                .get(place.input)?
                .as_ref()?
                .stretched(smallest_stretch(&place.matrix()), place.longest());
            total = Some(total.map_or(placed.clone(), |total| total.beside(&placed)));
        }
        let total = total.unwrap_or(Bound::exact(Reference::InputTriangles));
        let is_length = self.rounding >= 0.0 && self.rounding.is_finite();
        is_length.then(|| total.moved_by(self.rounding))
    }

    /// The contradiction in the histories of the inputs, if there is one.
    fn flaw(&self, n_inputs: usize) -> Option<String> {
        if self.origins.len() != n_inputs || self.places.iter().any(|place| place.input >= n_inputs) {
            return Some("the composition does not match the inputs of the step".to_owned());
        }
        if !(self.rounding >= 0.0 && self.rounding.is_finite()) {
            return Some("the stated rounding is not a length".to_owned());
        }
        self.origins.iter().find_map(HistoryFacts::flaw)
    }
}

/// The file that a step wrote.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepOutput {
    /// The kind of shape.
    pub kind: String,
    /// The format.
    pub format: String,
    /// The digest of its geometry in the frame of the certificate; `None` if the format does not hold all of it.
    pub geometry: Option<String>,
}

/// The part of a bound that adds up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepBound {
    /// The distance is at least this.
    pub at_least: f64,
    /// The distance is at most this; `None` without an upper bound.
    pub at_most: Option<f64>,
    /// "proved", "proved-if", "measured" or "estimated".
    pub evidence: String,
    /// The assumptions of a proof, for "proved-if".
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub assumptions: Vec<String>,
    /// The number of samples, for "measured".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub samples: Option<u64>,
    /// The metric of the distance.
    pub metric: String,
    /// The reference: the true shape.
    pub reference: String,
}

impl StepBound {
    /// The part of a bound that adds up.
    #[must_use]
    pub fn new(bound: &Bound) -> Self {
        Self::from_facts(&BoundFacts::new(bound))
    }

    pub(crate) fn from_facts(facts: &BoundFacts) -> Self {
        Self {
            at_least: facts.at_least,
            at_most: facts.at_most,
            evidence: facts.evidence.to_owned(),
            assumptions: facts.assumptions.clone(),
            samples: facts.samples,
            metric: facts.metric.to_owned(),
            reference: facts.reference.to_owned(),
        }
    }

    /// The bound in these facts, if they are valid: a file may contain anything.
    #[must_use]
    pub fn bound(&self) -> Option<Bound> {
        let evidence = match (&self.evidence[..], &self.assumptions[..], self.samples) {
            ("proved", [], None) => Evidence::Proved,
            ("proved-if", [_, ..], None) => Evidence::ProvedIf(self.assumptions.clone()),
            ("measured", [], Some(samples)) => Evidence::Measured { samples },
            ("estimated", [], None) => Evidence::Estimated,
            _ => return None,
        };
        let metrics = [Metric::Hausdorff, Metric::Parametric, Metric::OneSided, Metric::Solid];
        let metric = metrics.into_iter().find(|metric| metric.as_str() == self.metric)?;
        let references = [
            Reference::Curves,
            Reference::InputPoints,
            Reference::BezierPatches,
            Reference::NurbsSurfaces,
            Reference::LimitSurface,
            Reference::InputTriangles,
            Reference::Field,
            Reference::Trilinear,
            Reference::Boolean,
            Reference::Several,
        ];
        let reference = references.into_iter().find(|reference| reference.as_str() == self.reference)?;
        let is_sound = self.at_least >= 0.0
            && self.at_least.is_finite()
            && self.at_most.is_some() == evidence.bounds_above()
            && self.at_most.is_none_or(|most| self.at_least <= most && most.is_finite());
        is_sound.then(|| {
            let mut bound = Bound::with_evidence(self.at_least, self.at_most, evidence, reference);
            bound.metric = metric;
            bound
        })
    }
}

impl HistoryFacts {
    /// The history of steps, with the sum of their bounds.
    pub(crate) fn new(begins: HistoryStart, steps: Vec<StepFacts>) -> Self {
        let total = sum(&steps);
        Self { begins, steps, total }
    }

    /// The contradiction in the history itself, whatever the files are, if there is one: a step that does not continue the
    /// one before it, or a wrong sum.
    pub(crate) fn flaw(&self) -> Option<String> {
        if let Some(broken) = self.steps.windows(2).find_map(|pair| gap(&pair[0], &pair[1])) {
            return Some(broken.reason);
        }
        let Some(first) = self.steps.first() else {
            return self.total.is_some().then(|| "there is a bound, and no step".to_owned());
        };
        if let Some(flaw) = first.composed.as_ref().and_then(|composed| composed.flaw(first.inputs.len())) {
            return Some(flaw);
        }
        (self.total != sum(&self.steps)).then(|| "the sum of the bounds of the steps is different".to_owned())
    }

    /// All inputs in the history, including those of nested histories.
    pub(crate) fn inputs(&self) -> Vec<&StepInput> {
        let mut inputs = Vec::new();
        let mut open = vec![self];
        while let Some(history) = open.pop() {
            for step in &history.steps {
                inputs.extend(&step.inputs);
                open.extend(step.composed.iter().flat_map(|composed| &composed.origins));
            }
        }
        inputs
    }

    /// The depth of nested histories, this one included.
    pub(crate) fn depth(&self) -> usize {
        let composed_steps = self.steps.iter().filter_map(|step| step.composed.as_ref());
        1 + composed_steps.flat_map(|composed| &composed.origins).map(Self::depth).max().unwrap_or(0)
    }

    /// The bound of an input against its first shape: without steps it is that shape itself.
    fn bound_of_input(&self) -> Option<Bound> {
        match &self.total {
            Some(total) => total.bound(),
            None => self.steps.is_empty().then(|| Bound::exact(Reference::InputTriangles)),
        }
    }
}

/// The sum of the bounds of successive steps: the upper ends add up, and the weakest evidence stays.
pub(crate) fn sum(steps: &[StepFacts]) -> Option<StepBound> {
    let mut total = match steps.first()?.composed.as_ref() {
        Some(composed) => Some(composed.bound()?),
        None => None,
    };
    for step in steps {
        let next = step.bound.as_ref()?.bound()?;
        total = Some(total.map_or(next.clone(), |total| total.then(&next)));
    }
    total.map(|total| StepBound::new(&total))
}

/// The reason why a step does not continue the one before it, whatever the files are; `None` if it does.
pub(crate) fn gap(before: &StepFacts, next: &StepFacts) -> Option<HistoryStart> {
    if next.composed.is_some() {
        let reason = format!(
            "{} read triangles that were composed of parts, which have histories of their own",
            next.verb
        );
        return Some(HistoryStart::new("composed", reason));
    }
    let [input] = &next.inputs[..] else {
        let n = next.inputs.len();
        return Some(HistoryStart::new(
            "several-inputs",
            format!(
                "{} combined {n} inputs, and a bound of one of them is not a bound of the result",
                next.verb
            ),
        ));
    };
    if input.kind != before.output.kind {
        let reason = format!(
            "the file was written as {} and read as {}: the bounds are of different shapes",
            before.output.kind, input.kind
        );
        return Some(HistoryStart::new("kind", reason));
    }
    let chains = match (&input.kind[..], next.bound.as_ref().map(|bound| &bound.reference[..])) {
        ("triangles", Some("input triangles")) | ("volume", Some("trilinear interpolant")) => true,
        // The region inside of outlines may change by more than the outlines.
        ("drawing" | "curves", Some("curves")) => next.output.kind == input.kind,
        // Refused below, with a reason of its own.
        (_, None) => true,
        _ => false,
    };
    if !chains {
        let reason = format!("the bound of {} is not against the {} of its input", next.verb, input.kind);
        return Some(HistoryStart::new("bound", reason));
    }
    (before.bound.is_none() || next.bound.is_none()).then(|| {
        let verb = if before.bound.is_none() { &before.verb } else { &next.verb };
        HistoryStart::new(
            "bound",
            format!("nothing bounds the distance between the input and output of {verb}"),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(at_most: f64, reference: Reference) -> StepFacts {
        let input =
            StepInput { kind: "triangles".into(), format: "ply".into(), sha256: None, files: Vec::new() };
        StepFacts {
            verb: "mesh".into(),
            version: String::new(),
            inputs: vec![input],
            composed: None,
            offset: None,
            output: StepOutput { kind: "triangles".into(), format: "ply".into(), geometry: None },
            bound: Some(StepBound::new(&Bound::proved(0.0, at_most, reference))),
        }
    }

    #[test]
    fn the_sum_is_that_of_bounds() {
        let steps = [step(0.1, Reference::Field), step(0.2, Reference::InputTriangles)];
        let total = sum(&steps).unwrap();
        assert!(total.at_most >= Some(0.1 + 0.2) && total.at_most < Some(0.300_001));
        assert_eq!((&total.reference[..], &total.evidence[..]), ("field", "proved"));
        assert!(gap(&steps[0], &steps[1]).is_none());
        // A bound against a field does not continue one of triangles.
        assert_eq!(gap(&steps[1], &steps[0]).unwrap().code, "bound");
    }

    #[test]
    fn several_inputs_break_the_chain() {
        let (first, mut next) = (step(0.1, Reference::Field), step(0.1, Reference::InputTriangles));
        next.inputs.push(next.inputs[0].clone());
        assert_eq!(gap(&first, &next).unwrap().code, "several-inputs");
    }

    #[test]
    fn what_is_no_bound_is_none() {
        let good = StepBound::new(&Bound::proved(0.1, 0.2, Reference::Field));
        assert!(good.bound().is_some());
        for bad in [
            StepBound { at_least: -1.0, ..good.clone() },
            StepBound { at_least: 0.3, ..good.clone() },
            StepBound { at_most: None, ..good.clone() },
            StepBound { evidence: "measured".into(), samples: Some(9), ..good.clone() },
            StepBound { evidence: "proved-if".into(), ..good.clone() },
            StepBound { evidence: "certain".into(), ..good.clone() },
            StepBound { metric: "none".into(), ..good.clone() },
            StepBound { reference: "".into(), ..good },
        ] {
            assert!(bad.bound().is_none(), "{bad:?}");
        }
    }
}
