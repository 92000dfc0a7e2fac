//! `Certificate`: what holds of a result whatever the machine and the time, for the report and for the file.
use super::history::gap;
use super::message_text::message_texts;
use super::{
    AttributeFacts, BooleanFacts, BoundFacts, BudgetFacts, DistanceGridFacts, FrameFacts, HistoryFacts,
    HistoryStart, InputFacts, LevelsFacts, Output, OvershadeFacts, RefinementFacts, RepairFacts,
    SmoothingFacts, StepBound, StepFacts, StepOutput, ValidityFacts, to_value,
};
use crate::origin::InputOrigin;
use crate::seal::seal_of;
use crate::{Input, Shape};
use chordal::budget::advice::{Cure, Message, Setting};
use chordal_io::{BENT_POLYGONS, Format, most_certificate_bytes};
use serde::{Serialize, Serializer};
use serde_json::Value;

/// The reproducible facts of a result, independent of the machine and the time.
///
/// Of a result that was made, the last key is its seal: see [`seal_of`].
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(remote = "Self")]
pub struct Certificate {
    /// The version of Chordal.
    pub version: &'static str,
    /// The input.
    pub input: InputFacts,
    /// The frame of all lengths and points.
    pub frame: FrameFacts,
    /// The budget; `None` where there is none.
    pub budget: Option<BudgetFacts>,
    /// The verb that makes the result.
    #[serde(skip)]
    verb: &'static str,
    /// Where the input comes from.
    #[serde(skip)]
    origin: InputOrigin,
    /// The bound; `None` where nothing was made.
    pub bound: Option<BoundFacts>,
    /// The counts of the output; `None` where nothing was made.
    pub output: Option<Output>,
    /// The validity of the triangles; `None` for other results.
    pub valid: Option<ValidityFacts>,
    /// The validity of the input's triangles; only from `mend`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub valid_before: Option<ValidityFacts>,
    /// The repairs, in the order of application; only from `mend`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mended: Vec<RepairFacts>,
    /// What was combined; only where several shapes were.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub boolean: Option<BooleanFacts>,
    /// How a mask was smoothed; only where it was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smoothed: Option<SmoothingFacts>,
    /// How a cage was refined; only where its polygons are the result.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refined: Option<RefinementFacts>,
    /// The distance grid; only from `bake`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub baked: Option<DistanceGridFacts>,
    /// The attribute deviation of simplified triangles; only from `mesh`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub attributes: Vec<AttributeFacts>,
    /// The levels of detail; only from `lod`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub levels: Option<LevelsFacts>,
    /// The shading cost on a graphics processor; only from a rendering that was asked for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub overshade: Option<OvershadeFacts>,
    /// The steps from the first input to this result; only of what was made to be written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub history: Option<HistoryFacts>,
    /// Further notes for the reader, in sentences.
    #[serde(serialize_with = "message_texts")]
    pub notes: Vec<Message>,
    /// Those of the notes that say why triangles stay which the budget seems to let go: people see them without asking.
    #[serde(skip)]
    pub stayed: Vec<Message>,
    /// Those of the notes that say what may be wrong with the result: people see them without asking.
    #[serde(skip)]
    pub warned: Vec<Message>,
}

impl Certificate {
    /// The certificate of an input, before anything is made.
    #[must_use]
    pub fn from_input(input: &Input) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            input: InputFacts::from_input(input),
            frame: FrameFacts::new(input.shape.frame()),
            budget: None,
            verb: "mesh",
            origin: InputOrigin::from_input(input),
            bound: None,
            output: None,
            valid: None,
            valid_before: None,
            mended: Vec::new(),
            boolean: None,
            smoothed: None,
            refined: None,
            baked: None,
            attributes: Vec::new(),
            levels: None,
            overshade: None,
            history: None,
            notes: assumed_region(input).into_iter().chain(bent_polygons(input)).collect(),
            stayed: Vec::new(),
            warned: Vec::new(),
        }
    }

    /// Whether vertices became several at one place, which a format without indices of positions cannot hold.
    #[must_use]
    pub fn was_split(&self) -> bool {
        let split = Cure::SplitNonManifold.name();
        self.mended.iter().any(|facts| facts.cure == split && !facts.changes.is_empty())
    }

    /// The same for another verb than `mesh`.
    pub(crate) fn by(self, verb: &'static str) -> Self {
        Self { verb, ..self }
    }

    /// Adds the step that made a result to the history of the input: the kind and the format of what was written,
    /// and the digest of its geometry.
    pub(crate) fn conclude(&mut self, (kind, format): (&str, Format), geometry: Option<String>) {
        let composed = self.origin.composed.as_ref().filter(|_| self.boolean.is_none());
        let mut step = StepFacts {
            verb: self.verb.to_owned(),
            version: self.version.to_owned(),
            inputs: match (&self.boolean, composed) {
                (Some(facts), _) => facts.operands.iter().map(|operand| operand.input.of_step()).collect(),
                (None, Some(composed)) => composed.inputs().to_vec(),
                (None, None) => vec![self.input.of_step()],
            },
            composed: composed.map(|composed| composed.facts().clone()),
            output: StepOutput { kind: kind.to_owned(), format: format.to_string(), geometry },
            bound: self.bound.as_ref().map(StepBound::from_facts),
        };
        let InputOrigin { steps, begins, .. } = &self.origin;
        let (mut steps, mut begins) = (steps.clone(), begins.clone());
        if let Some(broken) = steps.last().and_then(|before| gap(before, &step)) {
            (steps, begins) = (Vec::new(), broken);
        }
        // Half of what there is room for: the rest is of other facts.
        let most = most_certificate_bytes(format).map_or(LONGEST, |most| most / 2);
        if n_bytes(&steps) + n_bytes(&step) > most {
            let reason =
                "the history is longer than this file holds: it begins at what was read for this step";
            self.notes.push(reason.into());
            (steps, begins) = (Vec::new(), HistoryStart::new("long", reason));
            if step.composed.take().is_some() {
                step.inputs = vec![self.input.of_step()];
            }
        }
        steps.push(step);
        self.history = Some(HistoryFacts::new(begins, steps));
    }

    /// Whether the certificate of the input speaks of what was read, so that its steps may be added to.
    pub(crate) fn has_earlier_steps(&self) -> bool {
        !self.origin.steps.is_empty() || self.origin.composed.is_some()
    }

    /// What a file holds that has a bound of its own, as a level of detail has: the same history up to the input.
    pub(crate) fn history_to(
        &self,
        bound: &BoundFacts,
        written: (&str, Format),
        geometry: Option<String>,
    ) -> Option<HistoryFacts> {
        let mut own = Self { bound: Some(bound.clone()), ..self.clone() };
        own.conclude(written, geometry);
        own.history
    }

    /// As JSON, with its keys in order.
    #[must_use]
    pub fn to_value(&self) -> Value {
        to_value(self)
    }
}

impl Serialize for Certificate {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.history.is_none() {
            return Self::serialize(self, serializer);
        }
        let plain = Unsealed(self);
        let seal = serde_json::to_value(&plain).map(|value| seal_of(&value)).unwrap_or_default();
        Sealed { plain, seal }.serialize(serializer)
    }
}

/// The bytes that facts take as JSON.
fn n_bytes(facts: &impl Serialize) -> usize {
    serde_json::to_string(facts).map_or(usize::MAX / 2, |text| text.len())
}

/// The most bytes of a history, where a format has no limit. Chosen: some ten thousand places.
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

/// What is said of polygons that another program may cut otherwise: whoever reads the bound has to know what it is against.
fn bent_polygons(input: &Input) -> impl Iterator<Item = Message> {
    input.warnings.iter().filter(|warning| warning.code == BENT_POLYGONS).map(|warning| {
        let n = warning.count;
        Message::from(format!("{n} {}", if n == 1 { "polygon: " } else { "polygons: " }))
            .words(&warning.message)
    })
}

/// The note on the assumed region, where a format does not state the region of its field.
fn assumed_region(input: &Input) -> Option<Message> {
    let Shape::Field(implicit) = &input.shape else { return None };
    let assumed = input.format == Format::Vm && implicit.region == Some(chordal_io::vm::REGION);
    assumed.then(|| {
        Message::from("an op list says no size: it is looked at from -1 to 1 along each axis; ")
            .setting(Setting::Region)
            .words(" says otherwise")
    })
}
