//! The report: one object for every verb. `docs/schema/report.schema.json` describes it.
//!
//! The *certificate* is deterministic: same input, version and budget give the same bytes. So it holds no
//! clock, no path and no thread count, and can be embedded in the file. *Run* describes this one execution.
mod attributes;
mod bound;
mod budget;
mod cage;
mod deviation;
mod distance_grid;
mod drawing;
mod field;
mod findings;
mod inspection;
mod levels;
mod message_text;
mod overshade;
mod part_check;
mod repairs;
mod scene_check;
mod surface;
mod validity;
mod validity_counts;
mod volume;
mod witness;

pub use attributes::AttributeFacts;
pub use bound::BoundFacts;
pub use budget::{BudgetFacts, ViewFacts};
pub(crate) use cage::linear_name;
pub use cage::{CageFacts, PolygonFacts, RefinementFacts, SharpnessFacts};
pub use deviation::{DeviationFacts, OneSidedFacts, Verdict};
pub use distance_grid::{DistanceGridFacts, SolidFacts};
pub use drawing::{DrawingFacts, JoinCounts, KinkFacts, PieceCounts};
pub use field::FieldFacts;
pub use findings::{FindingFacts, cures_of_all};
pub use inspection::{EmbeddedCertificate, GeometrySizes, Inspection, PartFacts};
pub use levels::{LevelChoiceFacts, LevelFacts, LevelsFacts};
use message_text::{message_option, message_text, message_texts};
pub use overshade::{OvershadeFacts, ShadingFacts};
use part_check::witness_facts;
pub(crate) use part_check::{CheckDepth, CountError};
pub use repairs::{ChangeFacts, RepairFacts};
pub use surface::{ComponentFacts, MOST_COMPONENTS, SurfaceFacts};
pub(crate) use validity::CountedTriangles;
pub use validity::{OtherCounts, PartValidity, ValidityFacts};
pub use validity_counts::ValidityCounts;
pub use volume::{LabelFacts, MOST_LABELS, SuggestedLevelFacts, VolumeFacts};
pub use witness::WitnessFacts;

use crate::{Input, Shape};
use chordal::Mesh;
use chordal::budget::advice::{Message, Setting};
use chordal::explicit::{Curve, CurveSegment, Topology};
use chordal_io::{Axis, Format, Frame, Polylines, Warning};
use serde::Serialize;
use serde_json::Value;

/// The name of this version of the report. Its meaning never changes; additions get a new number.
pub const SCHEMA: &str = "chordal.report/1";

/// What a verb did and what is known of the result. A shell has the settings in it spelled before it shows
/// them; the schema of reports has them as options of the command.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// The reproducible part: what holds of the result.
    pub certificate: Certificate,
    /// The description of the input; only from `inspect`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inspection: Option<Inspection>,
    /// The distance between two shapes; only from `deviation`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deviation: Option<DeviationFacts>,
    /// This run.
    pub run: RunFacts,
}

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
            refined: None,
            baked: None,
            attributes: Vec::new(),
            levels: None,
            overshade: None,
            notes: assumed_region(input).into_iter().collect(),
        }
    }

    /// As JSON, with its keys in order.
    #[must_use]
    pub fn to_value(&self) -> Value {
        to_value(self)
    }
}

impl Report {
    /// The report of a run.
    #[must_use]
    pub fn new(certificate: Certificate, run: RunFacts) -> Self {
        Self { schema: SCHEMA, certificate, inspection: None, deviation: None, run }
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

/// These structs hold numbers, texts and lists with texts as keys, all of which JSON can represent; a number
/// that is not finite becomes null.
pub(crate) fn to_value(facts: &impl Serialize) -> Value {
    serde_json::to_value(facts).unwrap_or_default()
}

/// The input.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct InputFacts {
    /// The kind of shape, as in "patches".
    pub kind: &'static str,
    /// The format of the bytes.
    pub format: String,
    /// The SHA-256 of the bytes, in hexadecimal.
    pub sha256: String,
    /// Irregularities in the bytes.
    pub warnings: Vec<WarningFacts>,
}

impl InputFacts {
    pub(crate) fn from_input(input: &Input) -> Self {
        Self {
            kind: input.shape.kind(),
            format: input.format.to_string(),
            sha256: input.sha256.clone(),
            warnings: input.warnings.iter().map(WarningFacts::new).collect(),
        }
    }
}

/// An irregularity of a file, counted.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct WarningFacts {
    /// A stable code, for programs.
    pub code: &'static str,
    /// How often it occurs.
    pub count: u64,
    /// Its first position.
    pub place: String,
    /// One sentence.
    #[serde(serialize_with = "message_text")]
    pub message: Message,
}

impl WarningFacts {
    fn new(warning: &Warning) -> Self {
        Self {
            code: warning.code,
            count: warning.count,
            place: warning.place.to_string(),
            message: warning.message.clone(),
        }
    }
}

/// The frame of lengths and points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameFacts {
    /// The up axis, "y" or "z", where it is known.
    pub up: Option<&'static str>,
    /// The length of one unit in metres, where it is known.
    pub metres_per_unit: Option<f64>,
}

impl FrameFacts {
    pub(crate) fn new(frame: &Frame) -> Self {
        let up = frame.up.map(|axis| match axis {
            Axis::Y => "y",
            Axis::Z => "z",
        });
        Self { up, metres_per_unit: frame.metres_per_unit }
    }
}

/// The counts of an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum Output {
    /// Triangles.
    Triangles(TriangleFacts),
    /// Polylines.
    Polylines(PolylineFacts),
    /// Polygons.
    Polygons(PolygonFacts),
}

impl Output {
    /// The counts of triangles, if the output is triangles.
    #[must_use]
    pub fn triangles(&self) -> Option<&TriangleFacts> {
        match self {
            Self::Triangles(facts) => Some(facts),
            Self::Polylines(_) | Self::Polygons(_) => None,
        }
    }

    /// The counts of polylines, if the output is polylines.
    #[must_use]
    pub fn polylines(&self) -> Option<&PolylineFacts> {
        match self {
            Self::Triangles(_) | Self::Polygons(_) => None,
            Self::Polylines(facts) => Some(facts),
        }
    }

    /// The counts of polygons, if the output is polygons.
    #[must_use]
    pub fn polygons(&self) -> Option<&PolygonFacts> {
        match self {
            Self::Polygons(facts) => Some(facts),
            Self::Triangles(_) | Self::Polylines(_) => None,
        }
    }
}

/// The counts of polylines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PolylineFacts {
    /// Polylines.
    pub polylines: u64,
    /// Points; the first of a closed polyline counts once.
    pub points: u64,
    /// Segments, including the closing ones.
    pub segments: u64,
}

impl PolylineFacts {
    /// The counts of all polylines.
    #[must_use]
    pub fn from_polylines(polylines: &Polylines) -> Self {
        let [points, segments] = polylines.counts();
        Self { polylines: polylines.len() as u64, points, segments }
    }

    /// The counts of curves that are all straight, as they read back from a file of polylines; `None` for
    /// others.
    #[must_use]
    pub fn from_straight_curves<const D: usize>(curves: &[Curve<D>]) -> Option<Self> {
        let mut facts = Self { polylines: curves.len() as u64, ..Self::default() };
        for curve in curves {
            if !curve.segments().iter().all(|piece| matches!(piece, CurveSegment::Line(_))) {
                return None;
            }
            let segments = curve.segments().len() as u64;
            facts.segments += segments;
            facts.points += if curve.is_closed() { segments } else { segments + 1 };
        }
        Some(facts)
    }
}

/// The counts of triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct TriangleFacts {
    /// Rows of positions; vertices that differ only in attributes count separately.
    pub vertices: u64,
    /// Distinct positions, as defined by the topology in `valid`.
    pub positions: u64,
    /// Triangles.
    pub triangles: u64,
}

impl TriangleFacts {
    /// The counts of one mesh.
    #[must_use]
    pub fn from_mesh(mesh: &Mesh, topology: Topology) -> Self {
        let n_vertices = mesh.positions().len();
        let positions = topology.ids(mesh).map_or(n_vertices, |ids| {
            let mut used = vec![false; n_vertices];
            ids.iter().for_each(|id| used[*id as usize] = true);
            used.iter().filter(|used| **used).count()
        });
        Self {
            vertices: n_vertices as u64,
            positions: positions as u64,
            triangles: mesh.faces().len() as u64,
        }
    }
}

/// This run of a verb. Front ends fill in what only they know.
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
    /// Seconds from the first byte read to the last byte written.
    pub seconds: Option<f64>,
    /// The peak memory of the process.
    pub peak_bytes: Option<u64>,
    /// The number of threads.
    pub threads: Option<u64>,
    /// Points at which user functions were evaluated; `None` where there is no such function.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub evaluations: Option<u64>,
}
