//! `Certificate`: what holds of a result whatever the machine and the time, for the report and for the file.
use super::message_text::message_texts;
use super::{
    AttributeFacts, BooleanFacts, BoundFacts, BudgetFacts, DistanceGridFacts, FrameFacts, InputFacts,
    LevelsFacts, Output, OvershadeFacts, RefinementFacts, RepairFacts, SmoothingFacts, ValidityFacts,
    to_value,
};
use crate::{Input, Shape};
use chordal::budget::advice::{Cure, Message, Setting};
use chordal_io::Format;
use serde::Serialize;
use serde_json::Value;

/// The reproducible facts of a result, independent of the machine and the time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Certificate {
    /// The version of Chordal.
    pub version: &'static str,
    /// The input.
    pub input: InputFacts,
    /// The frame of all lengths and points.
    pub frame: FrameFacts,
    /// The budget; `None` where there is none.
    pub budget: Option<BudgetFacts>,
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
    /// Further notes for the reader, in sentences.
    #[serde(serialize_with = "message_texts")]
    pub notes: Vec<Message>,
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
            notes: assumed_region(input).into_iter().collect(),
        }
    }

    /// Whether vertices became several at one place, which a format without indices of positions cannot hold.
    #[must_use]
    pub fn was_split(&self) -> bool {
        let split = Cure::SplitNonManifold.name();
        self.mended.iter().any(|facts| facts.cure == split && !facts.changes.is_empty())
    }

    /// As JSON, with its keys in order.
    #[must_use]
    pub fn to_value(&self) -> Value {
        to_value(self)
    }
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
