//! The GLB writer.
use super::document::{GltfDocument, GltfPart};
use super::{BIN_CHUNK, JSON_CHUNK, MAGIC};
use crate::{CoordinateOverflow, Scene, WriteError};
use serde_json::{Map, Value};
use std::io::Write;

/// Writes a scene as GLB 2.0, the same bytes for the same scene.
///
/// Positions are f32 about the part's origin, as in [`crate::snap()`]: a snapped mesh is kept to the last
/// bit, another one is rounded as `snap` would. Indices are u16 up to 65535 vertices, then u32. Attributes
/// are written as f32; normals and tangents are scaled to unit length, and one without a direction becomes an
/// axis. Vertices are duplicated where attributes of corners and faces differ. Meshes with a boundary get a
/// two-sided material. The certificate goes to `asset.extras.chordal`.
///
/// glTF is y-up and in metres. A z-up scene gets a root node with the exact matrix (x, y, z) → (x, z, −y),
/// and a known unit other than the metre a node that scales. An unknown frame is left alone. A part without
/// vertices leaves its node without a mesh.
///
/// Beside the scene, only split meshes take memory.
///
/// # Errors
/// [`WriteError::Io`] when the sink fails. [`WriteError::Unsupported`] when coordinates overflow single
/// precision, a part has vertices and no triangles, an attribute has values or a width that glTF lacks, nodes
/// are no forest, a transform has shear, or the file would exceed 4 GiB.
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::{Frame, Scene, glb};
///
/// let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let mut bytes = Vec::new();
/// glb::write(&Scene::from_mesh("triangle", mesh, Frame::default()), None, &mut bytes)?;
/// assert_eq!(&bytes[..4], b"glTF");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(scene: &Scene, certificate: Option<&Value>, out: &mut dyn Write) -> Result<(), WriteError> {
    let shapes = scene.parts.iter().map(GltfPart::from_part).collect::<Result<Vec<_>, _>>()?;
    let mut document = GltfDocument::default();
    for (part, shape) in scene.parts.iter().zip(&shapes) {
        document.add_part(part, shape)?;
    }
    let json = document.json(&document.nodes(scene, 0)?, certificate);
    write_file(&document, json, out)
}

/// Writes the header, the JSON chunk and the streams.
pub(super) fn write_file(
    document: &GltfDocument<'_>,
    json: Map<String, Value>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let json = Value::Object(json).to_string().into_bytes();
    let n_bin: u64 = document.streams.iter().map(|s| s.n_padded()).sum();
    let n_json = (json.len() as u64).div_ceil(4) * 4;
    let total = 12 + 8 + n_json + if n_bin == 0 { 0 } else { 8 + n_bin };
    let Ok(total) = u32::try_from(total) else {
        return Err(WriteError::Unsupported(format!(
            "GLB ends at 4 GiB, and this scene takes {total} bytes"
        )));
    };
    for word in [MAGIC, 2, total, n_json as u32, JSON_CHUNK] {
        out.write_all(&word.to_le_bytes())?;
    }
    out.write_all(&json)?;
    out.write_all(&b"   "[..n_json as usize - json.len()])?;
    if n_bin > 0 {
        out.write_all(&(n_bin as u32).to_le_bytes())?;
        out.write_all(&BIN_CHUNK.to_le_bytes())?;
        document.streams.iter().try_for_each(|stream| stream.write(out))?;
    }
    Ok(())
}

impl From<CoordinateOverflow> for WriteError {
    fn from(error: CoordinateOverflow) -> Self {
        Self::Unsupported(error.to_string())
    }
}
