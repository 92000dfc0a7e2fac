//! The GLB writer.
use super::level_set::GlbLevels;
use super::pack::{files_of, pack_embedded, with_document, write_file};
use crate::{FileSet, Scene, WriteError};
use serde_json::Value;
use std::io::Write;

/// Writes a scene as GLB 2.0, the same bytes for the same scene.
///
/// Positions are f32 about the part's origin, as in [`crate::snap()`]: a snapped mesh is kept to the last
/// bit, another one is rounded as `snap` would. Indices are u16 up to 65535 vertices, then u32. Attributes
/// are written as f32; normals and tangents are scaled to unit length, and one without a direction becomes an
/// axis. Vertices are duplicated where attributes of corners and faces differ. Faces
/// without a material get a plain one, two-sided where the mesh has a boundary, unless
/// [`crate::SceneAssets::keeps_bare_faces`] says that glTF has them without. The certificate goes to `asset.extras.chordal`.
///
/// glTF is y-up and in metres, and v of its texture coordinates runs down: it is written as 1 - v where
/// [`crate::Frame::texture_origin`] says that it runs up. A z-up scene gets a root node with the exact matrix
/// (x, y, z) → (x, z, −y), and a known unit other than the metre a node that scales. An unknown frame is left
/// alone. A part without triangles leaves its node without a mesh.
///
/// Beside the scene, only split meshes take memory.
///
/// # Errors
/// [`WriteError::Io`] when the sink fails. [`WriteError::Unsupported`] when coordinates overflow single
/// precision, no part has a triangle and some have points, an attribute has values or a width that glTF lacks, nodes
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
    let levels = GlbLevels { certificate, ..GlbLevels::one(scene) };
    with_document(&levels, |document, json| write_file(document, json, out))
}

/// Writes the same as [`write`] as a glTF of JSON alone, with its buffer as base64 in a data URI. It takes a
/// third more bytes than a GLB, and as much memory as the file has.
///
/// # Errors
/// As for [`write`], but there is no limit of 4 GiB.
pub fn write_embedded(
    scene: &Scene,
    certificate: Option<&Value>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let levels = GlbLevels { certificate, ..GlbLevels::one(scene) };
    with_document(&levels, |document, json| pack_embedded(document, json, out))
}

/// Writes the same as [`write`] as a glTF of JSON with files beside it: its buffer, called `stem` with `.bin`,
/// and each picture once, called `stem` with `_image_0.png` and so on. In these names, what some system does
/// not allow is an underscore.
///
/// # Errors
/// As for [`write`], but there is no limit of 4 GiB.
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
