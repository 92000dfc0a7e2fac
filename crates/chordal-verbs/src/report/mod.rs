//! The report: one object for every verb. `docs/schema/report.schema.json` describes it.
//!
//! The *certificate* is deterministic: same input, version and budget give the same bytes, so it holds no clock, no
//! path and no count of threads, and can travel in the file. *Run* is for the reader of the moment.
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
use chordal::explicit::{Curve, CurveSegment, Topology};
use chordal_io::{Axis, Format, Frame, Polylines, Warning};
use serde::Serialize;
use serde_json::Value;

/// The name of this version of the report. What it means is never changed; what is added gets a new number.
pub const SCHEMA: &str = "chordal.report/1";

/// What a verb did and what is known of the result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// What holds of the result, wherever and whenever it was made.
    pub certificate: Certificate,
    /// What the input is; only from `inspect`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inspection: Option<Inspection>,
    /// How far two shapes are apart; only from `deviation`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deviation: Option<DeviationFacts>,
    /// This run.
    pub run: RunFacts,
}

/// What holds of a result, wherever and whenever it was made.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Certificate {
    /// The version of Chordal.
    pub version: &'static str,
    /// What went in.
    pub input: InputFacts,
    /// The space that all lengths and points are in.
    pub frame: FrameFacts,
    /// What could be lost; none where nothing was asked.
    pub budget: Option<BudgetFacts>,
    /// What was lost; none where nothing was made.
    pub bound: Option<BoundFacts>,
    /// What came out; none where nothing was made.
    pub output: Option<Output>,
    /// Whether the triangles are sound; none where there are none to be.
    pub valid: Option<ValidityFacts>,
    /// Whether those of the input were; only from `mend`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub valid_before: Option<ValidityFacts>,
    /// What was mended, in the order in which it was; only from `mend`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mended: Vec<RepairFacts>,
    /// How a cage was refined; only where its polygons were.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refined: Option<RefinementFacts>,
    /// The lattice that was made; only from `bake`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub baked: Option<DistanceGridFacts>,
    /// How far attributes went off where triangles were simplified; only from `mesh`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub attributes: Vec<AttributeFacts>,
    /// The levels of detail that were made; only from `lod`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub levels: Option<LevelsFacts>,
    /// What a graphics processor shades; only from `render --show overshade`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub overshade: Option<OvershadeFacts>,
    /// What else a reader should know, in sentences.
    pub notes: Vec<String>,
}

impl Certificate {
    /// What is known before anything was made.
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
            notes: assumed_region(input).map(str::to_owned).into_iter().collect(),
        }
    }

    /// As JSON, with its keys in order.
    #[must_use]
    pub fn to_value(&self) -> Value {
        to_value(self)
    }
}

impl Report {
    /// A report of a run.
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

/// What is assumed where a format does not say what part of space its field is for.
fn assumed_region(input: &Input) -> Option<&'static str> {
    let Shape::Field(implicit) = &input.shape else { return None };
    let assumed = input.format == Format::Vm && implicit.region == Some(chordal_io::vm::REGION);
    assumed.then_some(
        "an op list says no size: it is looked at from -1 to 1 along each axis; --region says otherwise",
    )
}

/// These structs hold numbers, texts and lists with texts as keys, all of which JSON can say; a number that is not
/// finite becomes null.
pub(crate) fn to_value(facts: &impl Serialize) -> Value {
    serde_json::to_value(facts).unwrap_or_default()
}

/// What went in.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct InputFacts {
    /// The kind of shape, as in "patches".
    pub kind: &'static str,
    /// The format of the bytes.
    pub format: String,
    /// The SHA-256 of the bytes, in hexadecimal.
    pub sha256: String,
    /// What was odd about the bytes.
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

/// Something odd about a file, counted.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct WarningFacts {
    /// Stable, for programs.
    pub code: &'static str,
    /// How often.
    pub count: u64,
    /// Where it was seen first.
    pub place: String,
    /// One sentence.
    pub message: String,
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

/// The space that lengths and points are in.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameFacts {
    /// The axis that is up, "y" or "z", if that is known.
    pub up: Option<&'static str>,
    /// The length of one unit, if that is known.
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

/// What came out.
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
    /// The counts of triangles, where there are some.
    #[must_use]
    pub fn triangles(&self) -> Option<&TriangleFacts> {
        match self {
            Self::Triangles(facts) => Some(facts),
            Self::Polylines(_) | Self::Polygons(_) => None,
        }
    }

    /// The counts of polylines, where there are some.
    #[must_use]
    pub fn polylines(&self) -> Option<&PolylineFacts> {
        match self {
            Self::Triangles(_) | Self::Polygons(_) => None,
            Self::Polylines(facts) => Some(facts),
        }
    }

    /// The counts of polygons, where there are some.
    #[must_use]
    pub fn polygons(&self) -> Option<&PolygonFacts> {
        match self {
            Self::Polygons(facts) => Some(facts),
            Self::Triangles(_) | Self::Polylines(_) => None,
        }
    }
}

/// What there is of polylines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PolylineFacts {
    /// Polylines.
    pub polylines: u64,
    /// Points; the first of a closed polyline once.
    pub points: u64,
    /// Segments, with those that close.
    pub segments: u64,
}

impl PolylineFacts {
    /// The counts of all polylines.
    #[must_use]
    pub fn from_polylines(polylines: &Polylines) -> Self {
        let [points, segments] = polylines.counts();
        Self { polylines: polylines.len() as u64, points, segments }
    }

    /// The counts of curves that are all straight, as they read back from a file of polylines; none for others.
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

/// What there is of triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct TriangleFacts {
    /// Rows of positions; vertices that differ only in attributes count apart.
    pub vertices: u64,
    /// Distinct positions, by the meaning of that word that `valid` has too.
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

/// This run of a verb. Shells fill in what only they know.
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
    /// From the first byte read to the last byte written.
    pub seconds: Option<f64>,
    /// The most memory that the process held.
    pub peak_bytes: Option<u64>,
    /// Threads that were used.
    pub threads: Option<u64>,
    /// Points at which functions of the user's were evaluated; none where there is no such function.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub evaluations: Option<u64>,
}
