//! The report: one object for every verb. `docs/schema/report.schema.json` describes it.
//!
//! The *certificate* is deterministic: same input, version and budget give the same bytes. So it holds no
//! clock, no path and no thread count, and can be embedded in the file. *Run* describes this one execution.
mod attributes;
mod boolean;
mod bound;
mod budget;
mod cage;
mod certificate;
mod deviation;
mod distance_grid;
mod drawing;
mod field;
mod findings;
mod history;
mod input;
mod inspection;
mod levels;
mod message_text;
mod nurbs_edges;
mod offset;
mod output;
mod overshade;
mod part_check;
mod repairs;
mod scene_check;
mod smoothing;
mod source;
mod surface;
mod surface_edges;
mod validity;
mod validity_counts;
mod verb_facts;
mod volume;

pub use attributes::AttributeFacts;
pub use boolean::{BooleanFacts, BooleanOperandFacts};
pub use bound::{BoundFacts, OpenPlaceFacts, OpenPlacesFacts};
pub use budget::{BudgetFacts, ViewFacts};
pub(crate) use cage::linear_name;
pub use cage::{CageFacts, PolygonFacts, RefinementFacts, SharpnessFacts};
pub use certificate::Certificate;
pub use deviation::{DeviationFacts, OneSidedFacts, Verdict};
pub use distance_grid::{DistanceGridFacts, InterpolantFacts, SolidFacts};
pub use drawing::{DrawingFacts, JoinCounts, PathJoinFacts, PieceCounts};
pub use field::{FieldFacts, LineCostFacts};
pub use findings::{FindingFacts, SentenceFacts, cures_of_all};
pub(crate) use history::gap;
pub use history::{
    ComposedFacts, HistoryFacts, HistoryStart, PlaceFacts, StepBound, StepFacts, StepInput, StepOutput,
};
pub use input::{FrameFacts, InputFacts, InputFileFacts, WarningFacts};
pub use inspection::{EmbeddedCertificate, GeometrySizes, Inspection, PartFacts};
pub use levels::{LevelChoiceFacts, LevelFacts, LevelsFacts};
use message_text::{message_option, message_text, message_texts};
pub use nurbs_edges::{NurbsEdgeFacts, NurbsJoinFacts, NurbsLineFacts};
pub use offset::OffsetFacts;
pub use output::{Output, PolylineFacts, TriangleFacts};
pub use overshade::{OvershadeFacts, ShadingFacts};
pub use part_check::WitnessFacts;
use part_check::witness_facts;
pub(crate) use part_check::{CheckDepth, CountError};
pub use repairs::{ChangeFacts, RepairFacts};
pub use smoothing::SmoothingFacts;
pub(crate) use source::sources_in;
pub use source::{SourceFacts, SourceFileFacts};
pub use surface::{ComponentFacts, MOST_COMPONENTS, OpenSeamFacts, SurfaceFacts};
pub use surface_edges::{
    EdgeFacts, EdgeMaximumFacts, GeometricEdgeCounts, MOST_EDGES, ParametricEdgeCounts, SurfaceEdgeFacts,
};
pub(crate) use validity::CountedTriangles;
pub use validity::{OtherCounts, PartValidity, ValidityFacts};
pub use validity_counts::ValidityCounts;
pub use verb_facts::VerbFacts;
pub use volume::{LabelFacts, MOST_LABELS, SuggestedLevelFacts, VolumeFacts};

use serde::Serialize;
use serde_json::Value;

/// The name of this version of the report. Its meaning never changes; additions get a new number.
pub const SCHEMA: &str = "chordal.report/1";

/// The run of a verb and the facts about the result. A front end spells the settings in it before it shows them; in the
/// schema of reports they are options of the command.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// The reproducible part: the facts about the result.
    pub certificate: Certificate,
    /// The result of a verb that builds nothing.
    #[serde(flatten)]
    pub examined: Option<ExaminationFacts>,
    /// This run.
    pub run: RunFacts,
}

impl Report {
    /// The report of a run.
    #[must_use]
    pub fn new(certificate: Certificate, run: RunFacts) -> Self {
        Self { schema: SCHEMA, certificate, examined: None, run }
    }

    /// The description of the input; only from `inspect`.
    #[must_use]
    pub fn inspection(&self) -> Option<&Inspection> {
        match &self.examined {
            Some(ExaminationFacts::Inspection(inspection)) => Some(inspection),
            _ => None,
        }
    }

    /// The distance between two shapes; only from `deviation`.
    #[must_use]
    pub fn deviation(&self) -> Option<&DeviationFacts> {
        match &self.examined {
            Some(ExaminationFacts::Deviation(facts)) => Some(facts),
            _ => None,
        }
    }

    /// The report as JSON, with its keys in order.
    #[must_use]
    pub fn to_value(&self) -> Value {
        to_value(self)
    }
}

/// The result of a verb that builds nothing, under a key of its own in the report.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ExaminationFacts {
    /// The description of an input.
    Inspection(Box<Inspection>),
    /// The distance between two shapes.
    Deviation(Box<DeviationFacts>),
}

/// The facts as JSON. These structs hold numbers, texts and lists with texts as keys, all of which JSON can represent; a
/// number that is not finite becomes null.
pub(crate) fn to_value(facts: &impl Serialize) -> Value {
    serde_json::to_value(facts).unwrap_or_default()
}

/// This run of a verb. Front ends fill in the fields that only they know.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RunFacts {
    /// The verb.
    pub verb: &'static str,
    /// The name of the input.
    pub input: Option<String>,
    /// The name of the output.
    pub output: Option<String>,
    /// The size of the output.
    pub bytes: Option<u64>,
    /// The triangles of the input; `None` for other shapes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub input_triangles: Option<u64>,
    /// Seconds from the first byte read to the last byte written.
    pub seconds: Option<f64>,
    /// The peak memory of the process.
    pub peak_bytes: Option<u64>,
    /// The number of threads.
    pub threads: Option<u64>,
    /// Points at which user functions were evaluated; `None` if there is no such function.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub evaluations: Option<u64>,
    /// The cost of each line of a script, if requested; the whole script is the last entry.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lines: Option<Vec<LineCostFacts>>,
}
