//! `GltfPart`: a part in the form that glTF can hold, and the streams of its vertices.
use super::packing::GltfPacking;
use super::primitive_mesh::PrimitiveMesh;
use super::split::split;
use super::stored_positions::{StoredPositions, storage_of};
use super::streams::AccessorStream;
use super::vertex_storage::VertexStorage;
use crate::assets::plain_material;
use crate::draw_order::in_draw_order;
use crate::{Frame, Marks, Part, Scene, TextureOrigin, WriteError};
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, InvalidMesh, Semantic};
use serde_json::Value;
use std::borrow::Cow;

/// A part in the form that glTF can hold.
pub(super) struct GltfPart<'a> {
    pub mesh: Cow<'a, Mesh>,
    pub primitives: Vec<PrimitiveMesh>,
    pub positions: StoredPositions,
    /// How attributes are stored, if they are quantized.
    pub storage: Option<VertexStorage>,
    /// Whether v of its texture coordinates is flipped: glTF's runs down.
    pub turns_v: bool,
}

impl<'a> GltfPart<'a> {
    pub fn from_part(part: &'a Part, frame: &Frame, packing: GltfPacking) -> Result<Self, WriteError> {
        let too_large = |error: InvalidMesh| WriteError::Unsupported(error.to_string());
        let mut mesh = split(&part.mesh).map_err(too_large)?;
        if packing.is_compressed {
            mesh = Cow::Owned(in_draw_order(&mesh).map_err(too_large)?);
        }
        let mut storage = storage_of(part, packing);
        if let Some(storage) = storage.as_mut().filter(|_| part.marks.iter().any(Marks::is_moved)) {
            // A skin or morph targets move the vertices from their own positions, not from those after the
            // node's transform.
            storage.lattice = None;
        }
        let positions = StoredPositions::new(&mesh, storage);
        let primitives = PrimitiveMesh::of(&mesh).map_err(too_large)?;
        Ok(Self { mesh, primitives, positions, storage, turns_v: frame.turns_v(TextureOrigin::UpperLeft) })
    }
}

/// The attributes of a mesh. Texture and colour sets are renumbered from zero without gaps, as glTF demands.
pub(super) fn streams_of(
    mesh: &Mesh,
    says: impl Fn(&Attribute) -> bool,
) -> Result<Vec<AccessorStream<'_>>, WriteError> {
    let mut sorted: Vec<_> =
        mesh.attributes().iter().filter(|attribute| attribute.domain == Domain::Vertex).collect();
    // Skins and morph targets are written separately.
    sorted.retain(|attribute| !matches!(attribute.semantic, Semantic::Blended(_)));
    sorted.sort_by_key(|attribute| match attribute.semantic {
        Semantic::Normal => (0, 0),
        Semantic::Tangent => (1, 0),
        Semantic::TexCoord(set) => (2, set),
        Semantic::Color(set) => (3, set),
        Semantic::Group(_) | Semantic::Custom(_) | Semantic::Blended(_) => (4, 0),
    });
    let (mut texture_sets, mut colour_sets) = (0, 0);
    let mut streams = Vec::with_capacity(sorted.len());
    let is_of_sets =
        |attribute: &Attribute| matches!(attribute.semantic, Semantic::Color(_) | Semantic::TexCoord(_));
    let same_kind = |a: &Attribute, b: &Attribute| {
        matches!(a.semantic, Semantic::Color(_)) == matches!(b.semantic, Semantic::Color(_))
    };
    for (i, attribute) in sorted.iter().copied().enumerate() {
        // A set may be left out only with all sets after it, or the numbers would have gaps.
        let mut rest = sorted[i..].iter().filter(|one| is_of_sets(one) && same_kind(one, attribute));
        let is_written = !is_of_sets(attribute) || rest.any(|one| says(one));
        let counter = match attribute.semantic {
            Semantic::Color(_) => &mut colour_sets,
            _ => &mut texture_sets,
        };
        if is_written {
            streams.push(AccessorStream::attribute(attribute, *counter)?);
        }
        // Counted even if it was left out: nothing of its kind follows then.
        if matches!(attribute.semantic, Semantic::Color(_) | Semantic::TexCoord(_)) {
            *counter += 1;
        }
    }
    Ok(streams)
}

/// The material of faces for which only a name is known, the same for all parts of a scene.
pub(super) fn plain_for(scene: &Scene) -> Value {
    plain_material(scene.parts.iter().any(|part| is_open(&part.mesh)))
}

/// Whether an edge has a triangle on one side only. Vertices at one position count as one.
pub(super) fn is_open(mesh: &Mesh) -> bool {
    let mut edges = Vec::with_capacity(3 * mesh.faces().len());
    for face in mesh.faces() {
        let [a, b, c] = face.map(|v| mesh.position_of(v));
        for (from, to) in [(a, b), (b, c), (c, a)] {
            if from != to {
                edges.push(if from < to { (from, to) } else { (to, from) });
            }
        }
    }
    edges.sort_unstable();
    edges.chunk_by(|a, b| a == b).any(|same| same.len() == 1)
}
