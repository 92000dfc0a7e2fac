//! The GLB writer.
use super::document::{GltfDocument, GltfPart, plain_for};
use super::{BIN_CHUNK, JSON_CHUNK, MAGIC};
use crate::side_file::{side_stem, uri_of};
use crate::{CoordinateOverflow, FileSet, Scene, SceneAssets, SideFile, WriteError};
use serde_json::{Map, Value};
use std::borrow::Cow;
use std::io::Write;

/// Writes a scene as GLB 2.0, the same bytes for the same scene.
///
/// Positions are f32 about the part's origin, as in [`crate::snap()`]: a snapped mesh is kept to the last
/// bit, another one is rounded as `snap` would. Indices are u16 up to 65535 vertices, then u32. Attributes
/// are written as f32; normals and tangents are scaled to unit length, and one without a direction becomes an
/// axis. Vertices are duplicated where attributes of corners and faces differ. Meshes with a boundary get a
/// two-sided material. The certificate goes to `asset.extras.chordal`.
///
/// glTF is y-up and in metres, and v of its texture coordinates runs down: it is written as 1 - v where
/// [`crate::Frame::texture_origin`] says that it runs up. A z-up scene gets a root node with the exact matrix (x, y, z) → (x, z, −y),
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
    with_document(scene, certificate, |document, json| write_file(document, json, out))
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
    with_document(scene, certificate, |document, json| pack_embedded(document, json, out))
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
    let stem = side_stem(stem);
    let prefix = format!("{stem}_");
    let assets = scene.assets_for_gltf(plain_for).with_pictures_beside(&prefix);
    let pack = |document: &GltfDocument<'_>, json| pack_beside(document, json, &stem);
    let mut files: FileSet<'a> = with_assets(scene, &assets, certificate, pack)?;
    files.beside.extend(scene.assets.picture_files(&prefix));
    Ok(files)
}

/// Makes the document of a scene for a writer.
fn with_document(
    scene: &Scene,
    certificate: Option<&Value>,
    write: impl FnOnce(&GltfDocument<'_>, Map<String, Value>) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    with_assets(scene, &scene.assets_for_gltf(plain_for), certificate, write)
}

/// The same with these assets.
fn with_assets<T>(
    scene: &Scene,
    assets: &SceneAssets,
    certificate: Option<&Value>,
    write: impl FnOnce(&GltfDocument<'_>, Map<String, Value>) -> Result<T, WriteError>,
) -> Result<T, WriteError> {
    let shapes = scene
        .parts
        .iter()
        .map(|part| GltfPart::from_part(part, &scene.frame))
        .collect::<Result<Vec<_>, _>>()?;
    let mut document = GltfDocument::new(assets);
    for (part, shape) in scene.parts.iter().zip(&shapes) {
        document.add_part(part, shape)?;
    }
    let nodes = document.nodes(scene, 0)?;
    document.add_animations(scene, nodes.first);
    let json = document.json(&nodes, certificate, None);
    write(&document, json)
}

/// Writes the JSON with the buffer in it.
pub(super) fn pack_embedded(
    document: &GltfDocument<'_>,
    mut json: Map<String, Value>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    set_buffer_uri(&mut json, || {
        Ok("data:application/octet-stream;base64,".to_owned() + &base64(&buffer_of(document)?))
    })?;
    serde_json::to_writer(&mut *out, &json).map_err(std::io::Error::from)?;
    Ok(())
}

/// The JSON, and the buffer beside it. Pictures are where the assets of the document say.
pub(super) fn pack_beside(
    document: &GltfDocument<'_>,
    mut json: Map<String, Value>,
    stem: &str,
) -> Result<FileSet<'static>, WriteError> {
    let name = format!("{stem}.bin");
    set_buffer_uri(&mut json, || Ok(uri_of(&name)))?;
    let mut beside = Vec::new();
    if json.contains_key("buffers") {
        beside.push(SideFile { name, bytes: Cow::Owned(buffer_of(document)?) });
    }
    Ok(FileSet { document: Value::Object(json).to_string().into_bytes(), beside })
}

fn set_buffer_uri(
    json: &mut Map<String, Value>,
    uri: impl FnOnce() -> Result<String, WriteError>,
) -> Result<(), WriteError> {
    if let Some(buffer) = json.get_mut("buffers").and_then(|buffers| buffers.get_mut(0)) {
        buffer["uri"] = Value::String(uri()?);
    }
    Ok(())
}

fn buffer_of(document: &GltfDocument<'_>) -> Result<Vec<u8>, WriteError> {
    let mut bytes = Vec::new();
    document.streams.iter().try_for_each(|stream| stream.write(&mut bytes))?;
    Ok(bytes)
}

/// The bytes in base64, padded (RFC 4648, section 4).
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |k: usize| u32::from(group.get(k).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for k in 0..4 {
            let digit = char::from(DIGITS[(bits >> (18 - 6 * k)) as usize & 63]);
            text.push(if k <= group.len() { digit } else { '=' });
        }
    }
    text
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
