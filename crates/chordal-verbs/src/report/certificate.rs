//! `Certificate`: the facts about a result that do not depend on the machine and the time, for the report and for the file.
use super::history::gap;
use super::message_text::message_texts;
use super::verb_facts::VerbFacts;
use super::{
    BoundFacts, BudgetFacts, FrameFacts, HistoryFacts, HistoryStart, InputFacts, Output, SourceFacts,
    StepBound, StepFacts, StepOutput, ValidityFacts, to_value,
};
use crate::provenance::origin::InputOrigin;
use crate::provenance::seal::{SEAL, seal_of};
use crate::{Input, Shape};
use chordal::budget::advice::{Cure, Message, Setting};
use chordal_io::{BENT_POLYGONS, Format, most_certificate_bytes};
use serde::{Serialize, Serializer};
use serde_json::Value;

/// The reproducible facts of a result, independent of the machine and the time.
///
/// For a built result, the last key is its seal: see [`seal_of`].
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(remote = "Self")]
pub struct Certificate {
    /// The version of Chordal.
    pub version: &'static str,
    /// The input.
    pub input: InputFacts,
    /// The frame of all lengths and points.
    pub frame: FrameFacts,
    /// The budget; `None` if there is none.
    pub budget: Option<BudgetFacts>,
    /// The origin of the input.
    #[serde(skip)]
    origin: InputOrigin,
    /// The bound; `None` if nothing was built.
    pub bound: Option<BoundFacts>,
    /// The counts of the output; `None` if nothing was built.
    pub output: Option<Output>,
    /// The validity of the triangles; `None` for other results.
    pub valid: Option<ValidityFacts>,
    /// The facts of the verb that builds the result.
    #[serde(flatten)]
    pub verb: VerbFacts,
    /// The scripts at the beginning of the history, as the file carries them; a front end that is told to leave them out
    /// clears this.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<SourceFacts>,
    /// The steps from the first input to this result; only for results that can be written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub history: Option<HistoryFacts>,
    /// Further notes for the reader, in sentences.
    #[serde(serialize_with = "message_texts")]
    pub notes: Vec<Message>,
    /// The certificate that stands for this one in the file and in the report: that of the input, if its triangles were only
    /// written in another format.
    #[serde(skip)]
    pub(crate) kept: Option<Value>,
    /// The notes on why triangles are left that the budget seems to allow to remove; front ends show them by default.
    #[serde(skip)]
    pub stayed: Vec<Message>,
    /// The notes on possible flaws of the result; front ends show them by default.
    #[serde(skip)]
    pub warned: Vec<Message>,
}

impl Certificate {
    /// The certificate of an input, before anything is built.
    #[must_use]
    pub fn from_input(input: &Input) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            input: InputFacts::from_input(input),
            frame: FrameFacts::new(input.shape.frame()),
            budget: None,
            origin: InputOrigin::from_input(input),
            bound: None,
            output: None,
            valid: None,
            verb: VerbFacts::Mesh {},
            sources: Vec::new(),
            history: None,
            notes: assumed_region(input).into_iter().chain(bent_polygons(input)).collect(),
            kept: None,
            stayed: Vec::new(),
            warned: Vec::new(),
        }
    }

    /// Whether vertices were copied at one place; a format without indices of positions cannot hold that.
    #[must_use]
    pub fn was_split(&self) -> bool {
        let split = Cure::SplitNonManifold.name();
        self.verb.repairs().iter().any(|facts| facts.cure == split && !facts.changes.is_empty())
    }

    /// Adds the step that built a result to the history of the input: the kind and the format of the output, and the digest
    /// of its geometry.
    pub(crate) fn conclude(&mut self, (kind, format): (&str, Format), geometry: Option<String>) {
        let boolean = self.verb.boolean();
        // A boolean lists all of its operands, of which this origin is only the first one's.
        let composed = self.origin.composed.as_ref().filter(|_| boolean.is_none());
        let mut step = StepFacts {
            verb: self.verb.name().to_owned(),
            version: self.version.to_owned(),
            inputs: match (boolean, composed) {
                (Some(facts), _) => facts.operands.iter().map(|operand| operand.input.of_step()).collect(),
                (None, Some(composed)) => composed.inputs().to_vec(),
                (None, None) => vec![self.input.of_step()],
            },
            composed: composed.map(|composed| composed.facts().clone()),
            offset: self.verb.offset().cloned(),
            output: StepOutput { kind: kind.to_owned(), format: format.to_string(), geometry },
            bound: self.bound.as_ref().map(StepBound::from_facts),
        };
        let InputOrigin { steps, begins, .. } = &self.origin;
        let (mut steps, mut begins) = (steps.clone(), begins.clone());
        if let Some(broken) = steps.last().and_then(|before| gap(before, &step)) {
            // The result is as good as ever: only its distance from the first shape is not known any more.
            (steps, begins) = (Vec::new(), broken);
        }
        // The other half of the room in the file is for other facts.
        let most = most_certificate_bytes(format).map_or(LONGEST, |most| most / 2);
        if n_bytes(&steps) + n_bytes(&step) > most {
            let reason = "the history is longer than this file holds: it begins at the input of this step";
            self.notes.push(reason.into());
            (steps, begins) = (Vec::new(), HistoryStart::new("long", reason));
            // Without its parts the step reads the input as it is, whose digest is that of the triangles themselves.
            if step.composed.take().is_some() {
                step.inputs = vec![self.input.of_step()];
            }
        }
        steps.push(step);
        let history = HistoryFacts::new(begins, steps);
        if format.carries_sources() {
            // A history that had to begin anew has no script any more.
            let digests: Vec<_> =
                history.inputs().into_iter().filter_map(|input| input.sha256.clone()).collect();
            let is_input = |source: &&SourceFacts| digests.contains(&source.sha256);
            self.sources = self.origin.sources.iter().filter(is_input).cloned().collect();
        }
        self.history = Some(history);
    }

    /// Removes the scripts, so that the file carries none.
    pub fn leave_out_sources(&mut self) {
        self.sources.clear();
        let Some(kept) = &mut self.kept else { return };
        if kept.as_object_mut().is_some_and(|facts| facts.remove("sources").is_some()) {
            kept[SEAL] = seal_of(kept).into();
        }
    }

    /// Adds the scripts of another operand, so that the file carries them as well.
    #[cfg(feature = "booleans")]
    pub(crate) fn add_sources_of(&mut self, input: &Input) {
        for source in InputOrigin::from_input(input).sources {
            if !self.origin.sources.contains(&source) {
                self.origin.sources.push(source);
            }
        }
    }

    /// Whether the certificate of the input is for the geometry that was read, so that its history can be continued.
    pub(crate) fn has_earlier_steps(&self) -> bool {
        !self.origin.steps.is_empty() || self.origin.composed.is_some()
    }

    /// The history for a part of a file that has a bound of its own, as a level of detail: the same history up to the input.
    pub(crate) fn history_to(
        &self,
        bound: &BoundFacts,
        written: (&str, Format),
        geometry: Option<String>,
    ) -> Option<HistoryFacts> {
        let mut part_certificate = Self { bound: Some(bound.clone()), ..self.clone() };
        part_certificate.conclude(written, geometry);
        part_certificate.history
    }

    /// The certificate as JSON, with its keys in order.
    #[must_use]
    pub fn to_value(&self) -> Value {
        to_value(self)
    }
}

impl Serialize for Certificate {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if let Some(kept) = &self.kept {
            return kept.serialize(serializer);
        }
        if self.history.is_none() {
            return Self::serialize(self, serializer);
        }
        let plain = Unsealed(self);
        let seal = serde_json::to_value(&plain).map(|value| seal_of(&value)).unwrap_or_default();
        Sealed { plain, seal }.serialize(serializer)
    }
}

/// The number of bytes of facts as JSON.
fn n_bytes(facts: &impl Serialize) -> usize {
    // Half of the range, since two of these are added.
    serde_json::to_string(facts).map_or(usize::MAX / 2, |text| text.len())
}

/// The most bytes of a history if a format has no limit. Chosen: enough for some ten thousand places.
const LONGEST: usize = 4 << 20;

/// A certificate without its seal.
struct Unsealed<'a>(&'a Certificate);

impl Serialize for Unsealed<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Certificate::serialize(self.0, serializer)
    }
}

/// A certificate with its seal.
#[derive(Serialize)]
struct Sealed<'a> {
    #[serde(flatten)]
    plain: Unsealed<'a>,
    seal: String,
}

/// A note on polygons that another program may cut differently: the bound is against the triangles of this cut.
fn bent_polygons(input: &Input) -> impl Iterator<Item = Message> {
    input.warnings.iter().filter(|warning| warning.code == BENT_POLYGONS).map(|warning| {
        let n = warning.count;
        Message::from(format!("{n} {}", if n == 1 { "polygon: " } else { "polygons: " }))
            .words(&warning.message)
    })
}

/// The note on the assumed region, if a format does not state the region of its field.
fn assumed_region(input: &Input) -> Option<Message> {
    let Shape::Field(implicit) = &input.shape else { return None };
    let assumed = input.format == Format::Vm && implicit.region == Some(chordal_io::vm::REGION);
    assumed.then(|| {
        Message::from("an op list has no size: it is taken from -1 to 1 along each axis; ")
            .setting(Setting::Region)
            .words(" sets another region")
    })
}
