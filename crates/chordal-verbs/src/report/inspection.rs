//! The description of an input in the report; only from `inspect`.
use super::{
    CageFacts, Certificate, DrawingFacts, FieldFacts, FindingFacts, NurbsEdgeFacts, PathJoinFacts,
    SourceFacts, SurfaceEdgeFacts, TriangleFacts, VolumeFacts, sources_in, to_value,
};
use crate::output::file_rows::rows_of;
use crate::{Input, Shape};
use chordal::Mesh;
use chordal::convert::gpu::IndexBuffer;
use chordal::explicit::{cache_misses, cache_order, position_id_by_bits};
use chordal::math::Box3;
use chordal_io::{Format, Scene, VertexRows};
use serde::Serialize;
use serde_json::Value;
use std::borrow::Cow;

/// The description of an input.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inspection {
    /// The size of the file in bytes.
    pub bytes: u64,
    /// The lowest and highest coordinates of the vertices, or of the control points; `None` for an empty
    /// shape.
    #[serde(rename = "box")]
    pub bounds: Option<[[f64; 3]; 2]>,
    /// The number of patches; `None` for other shapes.
    pub patches: Option<u64>,
    /// The smoothness at the edges between patches; absent for other shapes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub edges: Option<SurfaceEdgeFacts>,
    /// The number of NURBS surfaces; absent for other shapes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surfaces: Option<u64>,
    /// The smoothness of NURBS surfaces across their knots and common edges; absent for other shapes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface_edges: Option<NurbsEdgeFacts>,
    /// The parts of a scene; `None` for other shapes.
    pub parts: Option<Vec<PartFacts>>,
    /// The facts of curves; `None` for other shapes.
    pub drawing: Option<DrawingFacts>,
    /// The facts of a cage; absent for other shapes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cage: Option<CageFacts>,
    /// The facts of a volume; absent for other shapes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub volume: Option<VolumeFacts>,
    /// The facts of a field; `None` for other shapes.
    pub field: Option<FieldFacts>,
    /// The memory of the triangles; `None` for other shapes.
    pub sizes: Option<GeometrySizes>,
    /// The defects of the triangles, the most severe first; `None` for other shapes.
    pub findings: Option<Vec<FindingFacts>>,
    /// The certificate embedded in the file, and whether it still fits; `None` if there is none.
    pub found: Option<EmbeddedCertificate>,
}

/// One part of a scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PartFacts {
    /// Its name in the file.
    pub name: String,
    /// Its triangles.
    #[serde(flatten)]
    pub counts: TriangleFacts,
    /// The number of its placements in the scene.
    pub instances: u64,
    /// The triangles that are drawn for it: all of them at each placement.
    pub drawn: u64,
}

/// Bytes of positions and indices, without attributes: three single-precision numbers a position, and indices of 16 bits if
/// they fit, otherwise of 32.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct GeometrySizes {
    /// With shared vertices and indexed triangles; in a file without indices, equal corners are one vertex.
    pub indexed_bytes: u64,
    /// With three vertices a triangle.
    pub unindexed_bytes: u64,
    /// The average cache miss ratio: vertices that a graphics processor computes for each triangle, in the
    /// file's order, with a first-in, first-out cache of [`CACHE`]; 0 without triangles.
    pub acmr: f64,
    /// The same in Chordal's cache-optimised order.
    pub acmr_ordered: f64,
}

/// The vertices of the simulated cache. Chosen: few enough for any graphics processor.
const CACHE: u32 = 16;

/// A certificate that was found in a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EmbeddedCertificate {
    /// The certificate, as embedded in the file.
    pub certificate: Value,
    /// The counts that do not match the triangles of the file, as JSON pointers into the certificate; empty
    /// for an unchanged file. Matching counts do not prove the bound.
    pub differs: Vec<String>,
}

impl Inspection {
    /// Describes `input`. The certificate holds the counts of its triangles.
    #[must_use]
    pub fn from_input(input: &Input, counted: &Certificate) -> Self {
        // A scene whose transforms cannot be applied has no box.
        let bounds = input.shape.bounds().unwrap_or(Box3::EMPTY);
        let endless = bounds.min.iter().chain(&bounds.max).any(|x| !x.is_finite());
        let scene = match &input.shape {
            Shape::Scene(scene) => Some(scene),
            Shape::Patches { .. }
            | Shape::Surfaces { .. }
            | Shape::Cage(_)
            | Shape::Drawing(_)
            | Shape::Curves(_)
            | Shape::Field(_)
            | Shape::Volume(_) => None,
        };
        let drawing = match &input.shape {
            Shape::Drawing(drawing) => Some(DrawingFacts::from_curves(drawing)),
            Shape::Curves(curves) => Some(DrawingFacts::from_curves(curves)),
            Shape::Patches { .. }
            | Shape::Surfaces { .. }
            | Shape::Scene(_)
            | Shape::Cage(_)
            | Shape::Field(_)
            | Shape::Volume(_) => None,
        };
        let field = match &input.shape {
            Shape::Field(implicit) => Some(FieldFacts::new(implicit)),
            Shape::Patches { .. }
            | Shape::Surfaces { .. }
            | Shape::Scene(_)
            | Shape::Cage(_)
            | Shape::Drawing(_)
            | Shape::Curves(_)
            | Shape::Volume(_) => None,
        };
        let certificate = match &input.shape {
            Shape::Scene(scene) => scene.certificate.clone(),
            Shape::Cage(polygons) => polygons.certificate.clone(),
            Shape::Drawing(drawing) => drawing.certificate.clone(),
            Shape::Curves(curves) => curves.certificate.clone(),
            Shape::Volume(sampled) => sampled.volume.certificate.clone(),
            Shape::Patches { .. } | Shape::Surfaces { .. } | Shape::Field(_) => None,
        };
        let (patches, surfaces) = match &input.shape {
            Shape::Patches { patches, .. } => (Some(patches), None),
            Shape::Surfaces { surfaces, .. } => (None, Some(surfaces)),
            Shape::Scene(_)
            | Shape::Cage(_)
            | Shape::Drawing(_)
            | Shape::Curves(_)
            | Shape::Field(_)
            | Shape::Volume(_) => (None, None),
        };
        Self {
            bytes: input.n_bytes,
            bounds: (bounds != Box3::EMPTY && !endless).then_some([bounds.min, bounds.max]),
            patches: patches.map(|patches| patches.len() as u64),
            edges: patches.map(|patches| SurfaceEdgeFacts::from_patches(patches)),
            surfaces: surfaces.map(|surfaces| surfaces.len() as u64),
            surface_edges: surfaces.map(|surfaces| NurbsEdgeFacts::from_surfaces(surfaces)),
            parts: scene.map(|scene| PartFacts::list(scene, input.format)),
            drawing,
            cage: if let Shape::Cage(polygons) = &input.shape {
                Some(CageFacts::new(polygons))
            } else {
                None
            },
            volume: if let Shape::Volume(sampled) = &input.shape {
                Some(VolumeFacts::new(sampled))
            } else {
                None
            },
            field,
            sizes: scene.map(|scene| GeometrySizes::from_scene(scene, input.format)),
            findings: counted.valid.as_ref().map(FindingFacts::list),
            found: certificate.map(|certificate| EmbeddedCertificate::new(certificate, counted)),
        }
    }
}

impl Inspection {
    /// The worst joins of a drawing, kinks first; none for other shapes.
    #[must_use]
    pub fn worst_joins(&self) -> &[PathJoinFacts] {
        self.drawing.as_ref().map_or(&[], |drawing| &drawing.worst)
    }
}

impl PartFacts {
    fn list(scene: &Scene, format: Format) -> Vec<Self> {
        let mut instances = vec![0; scene.parts.len()];
        scene.nodes.iter().filter_map(|node| node.part).for_each(|part| instances[part] += 1);
        let facts = |(part, instances): (&chordal_io::Part, u64)| Self {
            drawn: part.mesh.faces().len() as u64 * instances,
            name: part.name.clone(),
            // A mesh whose rows cannot be merged has too many of them in any case.
            counts: rows_of(&part.mesh, format).map_or_else(
                |_| TriangleFacts::default(),
                |rows| TriangleFacts::from_mesh(&rows, format.topology()),
            ),
            instances,
        };
        scene.parts.iter().zip(instances).map(facts).collect()
    }
}

impl GeometrySizes {
    fn from_scene(scene: &Scene, format: Format) -> Self {
        let mut sizes = Self::default();
        let (mut n_faces, mut misses, mut misses_ordered) = (0, 0, 0);
        for part in &scene.parts {
            let (n_vertices, faces) = rows(&part.mesh, format);
            let (faces, n) = (&faces[..], faces.len() as u64);
            let index_bytes = if IndexBuffer::fit_16_bits(n_vertices) { 2 } else { 4 };
            sizes.indexed_bytes += 12 * n_vertices as u64 + 3 * index_bytes * n;
            sizes.unindexed_bytes += 36 * n;
            let ordered: Vec<_> = cache_order(faces).iter().map(|face| faces[*face as usize]).collect();
            n_faces += n;
            misses += cache_misses(faces, CACHE);
            misses_ordered += cache_misses(&ordered, CACHE);
        }
        let ratio = |misses: u64| if n_faces == 0 { 0.0 } else { misses as f64 / n_faces as f64 };
        (sizes.acmr, sizes.acmr_ordered) = (ratio(misses), ratio(misses_ordered));
        sizes
    }
}

/// The number of vertices, and the triangles by their rows. If the file has no indices, equal corners are one vertex: its
/// rows, one for each corner of each triangle, imply no order or size.
fn rows(mesh: &Mesh, format: Format) -> (usize, Cow<'_, [[u32; 3]]>) {
    if format.vertex_rows() != VertexRows::Soup {
        return (mesh.positions().len(), mesh.faces().into());
    }
    let ids = position_id_by_bits(mesh.positions());
    let n_vertices = ids.iter().enumerate().filter(|(row, id)| *row == **id as usize).count();
    let faces: Vec<_> = mesh.faces().iter().map(|face| face.map(|row| ids[row as usize])).collect();
    (n_vertices, faces.into())
}

impl EmbeddedCertificate {
    /// The scripts that the file carries.
    #[must_use]
    pub fn sources(&self) -> Vec<SourceFacts> {
        sources_in(&self.certificate)
    }

    fn new(certificate: Value, counted: &Certificate) -> Self {
        let recounted = [("/output", to_value(&counted.output)), ("/valid", to_value(&counted.valid))];
        let mut differs = Vec::new();
        for (at, actual) in recounted {
            let stated = certificate.pointer(at).and_then(Value::as_object);
            for (key, value) in stated.into_iter().flatten() {
                let is_plain = !(value.is_object() || value.is_array());
                if is_plain && actual.get(key).is_some_and(|actual| actual != value) {
                    differs.push(format!("{at}/{key}"));
                }
            }
        }
        Self { certificate, differs }
    }
}
