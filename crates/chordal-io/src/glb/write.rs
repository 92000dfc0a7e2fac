//! The GLB writer.
use super::level_set::GlbLevels;
use super::pack::{files_of, pack_embedded, with_document, write_file};
use crate::{FileSet, Scene, WriteError};
use serde_json::Value;
use std::io::Write;

/// Writes a scene as GLB 2.0. The same scene gives the same bytes.
///
/// Positions are f32 about the part's origin, as in [`crate::snap()`]: a snapped mesh keeps every bit, any
/// other is rounded as `snap` would. Indices are u16 up to 65535 vertices, then u32. Attributes are written
/// as f32; normals and tangents are scaled to unit length, and one without a direction becomes an axis.
/// Vertices are duplicated if attributes of their corners or faces differ. Faces without a material get a
/// plain one, two-sided if the mesh has a boundary, unless [`crate::SceneAssets::keeps_bare_faces`] is set.
/// The certificate goes to `asset.extras.chordal`.
///
/// glTF is y-up and in metres, and v of its texture coordinates runs down: it is written as (1 - v) if
/// [`crate::Frame::texture_origin`] says that v runs up. A z-up scene gets a root node with the exact matrix
/// (x, y, z) → (x, z, −y), and a known unit other than the metre gets a node that scales. An unknown frame is
/// left alone. A part without triangles leaves its node without a mesh.
///
/// Apart from the scene, only split meshes take memory.
///
/// # Errors
/// [`WriteError::Io`] if the sink fails. [`WriteError::Unsupported`] if coordinates overflow single
/// precision, no part has a triangle and some have points, an attribute has values or a width that glTF does
/// not support, nodes are not a forest, a transform has shear, or the file would exceed 4 GiB.
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
    let levels = GlbLevels { certificate, ..GlbLevels::one(scene) };
    with_document(&levels, |document, json| write_file(document, json, out))
}

/// Writes the same as [`write`] as a single JSON glTF, with its buffer as base64 in a data URI. The file is a
/// third larger than a GLB, and is held in memory as a whole.
///
/// # Errors
/// As for [`write`], but without the limit of 4 GiB.
pub fn write_embedded(
    scene: &Scene,
    certificate: Option<&Value>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let levels = GlbLevels { certificate, ..GlbLevels::one(scene) };
    with_document(&levels, |document, json| pack_embedded(document, json, out))
}

/// Writes the same as [`write`] as a JSON glTF with files beside it: its buffer, called `stem` with `.bin`,
/// and each picture once, called `stem` with `_image_0.png` and so on. In these names, characters that some
/// system does not allow become underscores.
///
/// # Errors
/// As for [`write`], but without the limit of 4 GiB.
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::{Frame, Scene, glb};
/// let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let scene = Scene::from_mesh("triangle", mesh, Frame::default());
/// let files = glb::write_files(&scene, None, "triangle")?;
/// assert_eq!(files.beside[0].name, "triangle.bin");
/// assert_eq!(files.beside[0].bytes.len(), 3 * 12 + 8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_files<'a>(
    scene: &'a Scene,
    certificate: Option<&Value>,
    stem: &str,
) -> Result<FileSet<'a>, WriteError> {
    files_of(scene, &GlbLevels { certificate, ..GlbLevels::one(scene) }, stem)
}
