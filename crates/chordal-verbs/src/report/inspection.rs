//! What an input is: only `inspect` says it.
use super::{Certificate, DrawingFacts, FindingFacts, OutputFacts, to_value};
use crate::formats::topology;
use crate::written::rows_of;
use crate::{Input, Shape};
use chordal::math::Box3;
use chordal_io::{Format, Scene};
use serde::Serialize;
use serde_json::Value;

/// What an input is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inspection {
    /// The size of the file in bytes.
    pub bytes: u64,
    /// The lowest and highest coordinates of the vertices, or of the control points; none for an empty shape.
    #[serde(rename = "box")]
    pub bounds: Option<[[f64; 3]; 2]>,
    /// The number of patches; none for other shapes.
    pub patches: Option<u64>,
    /// The parts of a scene; none for other shapes.
    pub parts: Option<Vec<PartFacts>>,
    /// What there is of curves; none for other shapes.
    pub drawing: Option<DrawingFacts>,
    /// What the triangles take; none for other shapes.
    pub sizes: Option<Sizes>,
    /// What was found to be wrong with the triangles, the heaviest first; none for other shapes.
    pub findings: Option<Vec<FindingFacts>>,
    /// The certificate that travels in the file, and whether it still fits; none where there is none.
    pub found: Option<Found>,
}

/// One part of a scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PartFacts {
    /// Its name in the file.
    pub name: String,
    /// Its triangles.
    #[serde(flatten)]
    pub counts: OutputFacts,
    /// In how many places of the scene it stands.
    pub instances: u64,
}

/// Bytes of positions and indices, without attributes: three single-precision numbers a position, and indices of
/// 16 bits while they fit, else of 32.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Sizes {
    /// With every vertex once and triangles by index.
    pub indexed_bytes: u64,
    /// With three vertices a triangle.
    pub unindexed_bytes: u64,
}

/// A certificate that was found in a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Found {
    /// The certificate, as it stands in the file.
    pub certificate: Value,
    /// Which of its counts do not fit the triangles of the file, as JSON pointers into it; empty for a file that is
    /// as it was written. That the counts fit is no proof of the bound.
    pub differs: Vec<String>,
}

impl Inspection {
    /// What `input` is. The certificate holds what was counted of its triangles.
    #[must_use]
    pub fn of(input: &Input, counted: &Certificate) -> Self {
        // A scene that cannot be put in one space has no box.
        let bounds = input.shape.hull().unwrap_or(Box3::EMPTY);
        let scene = match &input.shape {
            Shape::Scene(scene) => Some(scene),
            Shape::Patches { .. } | Shape::Drawing(_) | Shape::Curves(_) => None,
        };
        let drawing = match &input.shape {
            Shape::Drawing(drawing) => Some(DrawingFacts::of(drawing)),
            Shape::Curves(curves) => Some(DrawingFacts::of(curves)),
            Shape::Patches { .. } | Shape::Scene(_) => None,
        };
        let certificate = match &input.shape {
            Shape::Scene(scene) => scene.certificate.clone(),
            Shape::Drawing(drawing) => drawing.certificate.clone(),
            Shape::Curves(curves) => curves.certificate.clone(),
            Shape::Patches { .. } => None,
        };
        let patches = match &input.shape {
            Shape::Patches { patches, .. } => Some(patches.len() as u64),
            Shape::Scene(_) | Shape::Drawing(_) | Shape::Curves(_) => None,
        };
        Self {
            bytes: input.n_bytes,
            bounds: (bounds != Box3::EMPTY).then_some([bounds.min, bounds.max]),
            patches,
            parts: scene.map(|scene| PartFacts::of_all(scene, input.format)),
            drawing,
            sizes: scene.map(Sizes::of),
            findings: counted.valid.as_ref().map(FindingFacts::of_all),
            found: certificate.map(|certificate| Found::of(certificate, counted)),
        }
    }
}

impl PartFacts {
    fn of_all(scene: &Scene, format: Format) -> Vec<Self> {
        let mut instances = vec![0; scene.parts.len()];
        scene.nodes.iter().filter_map(|node| node.part).for_each(|part| instances[part] += 1);
        let facts = |(part, instances): (&chordal_io::Part, u64)| Self {
            name: part.name.clone(),
            // A mesh whose rows cannot be merged has too many of them in any case.
            counts: rows_of(&part.mesh, format)
                .map_or_else(|_| OutputFacts::default(), |rows| OutputFacts::of(&rows, topology(format))),
            instances,
        };
        scene.parts.iter().zip(instances).map(facts).collect()
    }
}

impl Sizes {
    fn of(scene: &Scene) -> Self {
        scene.parts.iter().fold(Self::default(), |sum, part| {
            let (n_vertices, n_faces) = (part.mesh.positions().len() as u64, part.mesh.faces().len() as u64);
            // The largest 16-bit index means "restart" in glTF.
            let index_bytes = if n_vertices < u64::from(u16::MAX) { 2 } else { 4 };
            Self {
                indexed_bytes: sum.indexed_bytes + 12 * n_vertices + 3 * index_bytes * n_faces,
                unindexed_bytes: sum.unindexed_bytes + 36 * n_faces,
            }
        })
    }
}

impl Found {
    fn of(certificate: Value, counted: &Certificate) -> Self {
        let counted = [("/output", to_value(&counted.output)), ("/valid", to_value(&counted.valid))];
        let mut differs = Vec::new();
        for (at, counted) in counted {
            let said = certificate.pointer(at).and_then(Value::as_object);
            for (key, value) in said.into_iter().flatten() {
                let plain = !(value.is_object() || value.is_array());
                if plain && counted.get(key).is_some_and(|counted| counted != value) {
                    differs.push(format!("{at}/{key}"));
                }
            }
        }
        Self { certificate, differs }
    }
}
