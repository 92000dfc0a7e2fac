//! Packs the document of a scene, with coarser levels of its parts, as GLB, as JSON, or as JSON with files
//! beside it.
use super::document::GltfDocument;
use super::gltf_part::{GltfPart, plain_for};
use super::level_set::GlbLevels;
use super::node_list::NodeLevels;
use super::{BIN_CHUNK, JSON_CHUNK, MAGIC};
use crate::losses::refuse_points_alone;
use crate::side_file::{side_stem, uri_of};
use crate::{CoordinateOverflow, FileSet, Part, Scene, SceneAssets, SideFile, WriteError};
use serde_json::{Map, Value};
use std::borrow::Cow;
use std::io::Write;

/// The files of a scene with levels: a JSON glTF with its buffer and pictures beside it.
pub(super) fn files_of<'a>(
    scene: &'a Scene,
    levels: &GlbLevels<'_>,
    stem: &str,
) -> Result<FileSet<'a>, WriteError> {
    let stem = side_stem(stem);
    let prefix = format!("{stem}_");
    let assets = scene.assets_for_gltf(plain_for).with_pictures_beside(&prefix);
    let pack = |document: &GltfDocument<'_>, json| pack_beside(document, json, &stem);
    let mut files: FileSet<'a> = with_assets(levels, &assets, pack)?;
    files.beside.extend(scene.assets.picture_files(&prefix));
    Ok(files)
}

/// Builds the document of a scene with levels and passes it to a writer.
pub(super) fn with_document(
    levels: &GlbLevels<'_>,
    write: impl FnOnce(&GltfDocument<'_>, Map<String, Value>) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    with_assets(levels, &levels.scene.assets_for_gltf(plain_for), write)
}

/// The same with these assets.
fn with_assets<T>(
    levels: &GlbLevels<'_>,
    assets: &SceneAssets,
    write: impl FnOnce(&GltfDocument<'_>, Map<String, Value>) -> Result<T, WriteError>,
) -> Result<T, WriteError> {
    let GlbLevels { scene, coarser, coverages, certificate } = levels;
    refuse_points_alone(&scene.parts)?;
    let shapes = gltf_parts(&scene.parts, scene)?;
    let coarser_shapes = coarser.iter().map(|parts| gltf_parts(parts, scene));
    let coarser_shapes = coarser_shapes.collect::<Result<Vec<_>, _>>()?;
    let mut document = GltfDocument::new(assets, scene.packing);
    if scene.parts.len() > 1 {
        document.share_rows();
    }
    for (part, shape) in scene.parts.iter().zip(&shapes) {
        document.add_part(part, shape)?;
    }
    let mut added = Vec::with_capacity(coarser.len());
    for (parts, shapes) in coarser.iter().zip(&coarser_shapes) {
        let meshes = parts.iter().zip(shapes).map(|(part, shape)| document.part_mesh(part, shape));
        added.push(meshes.collect::<Result<Vec<_>, _>>()?);
    }
    let mut nodes = document.nodes(scene, &NodeLevels { coarser: added, coverages })?;
    document.add_animations(scene, &mut nodes);
    let json = document.json(scene, &nodes, *certificate);
    write(&document, json)
}

/// Parts of a scene in the form that glTF can hold.
fn gltf_parts<'a>(parts: &'a [Part], scene: &Scene) -> Result<Vec<GltfPart<'a>>, WriteError> {
    parts.iter().map(|part| GltfPart::from_part(part, &scene.frame, scene.packing)).collect()
}

/// Writes the JSON with the buffer embedded.
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

/// The JSON, and the buffer beside it. Pictures are embedded or separate, as in the document's assets.
fn pack_beside(
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
