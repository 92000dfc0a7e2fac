//! The GLB reader.
use super::assets::AssetReader;
use super::dangling_references::drop_dangling_references;
use super::json::{self, JsonValue};
use super::leniency::ForgivenIssues;
use super::lint::{self, GltfLint};
use super::model::{GltfModel, GltfPrimitive};
use super::node_tree::NodeTree;
use super::parts::PartReader;
use super::report::GlbWarnings;
use super::{DECODED_PER_BYTE, GltfPacking, INSTANCING, LOD, QUANTIZATION};
use super::{container, draco, external, meshopt, packed_views};
use crate::files::FileOpener;
use crate::text::is_space;
use crate::{Axis, Content, FileLocation, Frame, Limits, ReadError, ReadOutcome, TextureOrigin};
use serde_json::Value;

/// The most bytes that one JSON object takes in memory after reading. Derived: a node with its transform
/// takes the most.
const OBJECT_BYTES: u64 = 512;

/// Extensions that are supported, or do not change the triangles; `*` matches any ending.
const HARMLESS: [&str; 18] = [
    draco::DRACO,
    QUANTIZATION,
    "KHR_materials_*",
    "KHR_texture_*",
    "KHR_lights_*",
    "KHR_animation_pointer",
    "KHR_xmp*",
    "EXT_texture_*",
    "EXT_lights_*",
    "EXT_materials_*",
    "EXT_mesh_manifold",
    "MSFT_texture_dds",
    LOD,
    INSTANCING,
    meshopt::NAMES[0],
    meshopt::NAMES[1],
    "ADOBE_materials_*",
    "AGI_*",
];

/// Reads GLB 2.0.
///
/// Errors of gltf-validator anywhere in the file are refused with their code and JSON pointer, except those
/// that viewers accept. Depending on [`Limits::conformance`], those are refused too, or all errors are
/// warnings if the triangles can still be read. Each mesh of the file becomes one part, with the triangles of
/// all its primitives; vertices at bit-identical positions share one position id. Positions are exactly the
/// stored numbers, in the mesh's own space; nodes carry the transforms and [`crate::Scene::world_meshes`]
/// applies them. The frame is y-up and in metres. The certificate comes from `asset.extras.chordal`.
///
/// Lists, strips and fans are read with any accessor of the format, also sparse and quantized ones. Points
/// and lines are passed through ([`crate::Part::marks`]) and counted in a warning, as are animations of
/// anything but nodes. Materials, textures, cameras, lights, skins and extras of nodes go unchanged to
/// [`Scene::assets`] and the nodes. Joint weights and morph targets become vertex attributes that can be
/// blended; positions are those at rest. The reader never opens other files or the network;
/// [`crate::read_with`] opens files beside it. Of levels of detail by `MSFT_lod` the one of [`Limits::level`]
/// is read, usually the first, and the others are counted. If [`super::write_levels`] wrote a certificate for
/// each level, the one of this level is read.
///
/// Views compressed by `EXT_meshopt_compression` or `KHR_meshopt_compression` are unpacked. A node with
/// `EXT_mesh_gpu_instancing` gets a child without a name for each instance, which shows the node's part; the
/// node itself shows none.
///
/// Linear in the size of the file and of the data decoded from it; the latter stays below [`Limits::bytes`].
///
/// # Errors
/// [`ReadError`] with the byte or the JSON pointer, if the container or the JSON is broken, a limit is
/// exceeded, an unknown extension is required, a compressed view or primitive is broken, the triangles need
/// another file, or gltf-validator would report an error.
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::{Content, Frame, Limits, Scene, glb};
///
/// let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let mut bytes = Vec::new();
/// glb::write(&Scene::from_mesh("triangle", mesh.clone(), Frame::default()), None, &mut bytes)?;
/// let loaded = glb::read(&bytes, &Limits::default())?;
/// let Content::Scene(scene) = loaded.content else { unreachable!() };
/// assert_eq!(scene.parts[0].mesh, mesh);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    read_with(bytes, None, limits)
}

/// As [`read`], and opens the buffers and pictures in other files if there is an opener.
pub(crate) fn read_with(
    bytes: &[u8],
    open: Option<&mut FileOpener<'_>>,
    limits: &Limits,
) -> Result<ReadOutcome, ReadError> {
    let mut report = GlbWarnings::default();
    if bytes.len() as u64 > limits.bytes {
        let what = format!("the file has {} bytes, the limit is {}", bytes.len(), limits.bytes);
        return Err(ReadError::new("too-large", FileLocation::File, what));
    }
    let chunks = if is_json(bytes) {
        container::GlbChunks { json: bytes, json_at: 0, container: container::GltfContainer::Json }
    } else {
        container::chunks(bytes, limits, &mut report)?
    };
    let json = parse_json(&chunks, limits)?;
    check_rows(&json, limits)?;
    let mut quota = decode_quota(bytes.len(), limits);
    let mut lint = GltfLint::new(&json, quota);
    let Some(mut model) = lint::parse(&mut lint, &json, chunks.container) else {
        let issue = lint.issues.swap_remove(0);
        return Err(ReadError::new(issue.code, issue.place, issue.message));
    };
    check_extensions(&model, &mut report)?;
    if let Some(open) = open {
        external::open_files(&mut model, &mut lint, open, limits, &mut report)?;
        quota = decode_quota(bytes.len() + model.n_external(), limits);
    }
    // Draco's streams may lie in packed views, so views are unpacked first. Only then are all rows
    // present that the linter checks.
    quota = packed_views::unpack(&mut model, &mut lint, quota)?;
    quota = draco::unpack(&mut model, &mut lint, limits, quota)?;
    check_zeros(&model, limits, quota)?;
    lint::link(&mut lint, &mut model);
    let forgiven = ForgivenIssues::judge(lint.issues, limits, &mut report)?;
    let mut tree = NodeTree::new(&json, &model, limits, quota)?;
    let assets = AssetReader::new(&json, &model, quota).read(&mut tree, &forgiven)?;
    report.append(assets.report);
    let NodeTree { mut scene, meshes, n_lower, left, report: placing, .. } = tree;
    let mut parts = PartReader::new(&model, &assets.groups, limits, left);
    scene.parts = meshes.into_iter().map(|mesh| parts.part(mesh)).collect::<Result<Vec<_>, _>>()?;
    for (part, properties) in scene.parts.iter_mut().zip(assets.properties) {
        part.properties = Some(properties).filter(|map| !map.is_empty()).map(Box::new);
    }
    for (part, marks) in scene.parts.iter_mut().zip(assets.marks) {
        part.marks = marks.into();
    }
    report.append(parts.report);
    drop_dangling_references(&mut scene, &mut report);
    report.append(placing);
    scene.frame = Frame {
        up: Some(Axis::Y),
        metres_per_unit: Some(1.0),
        texture_origin: Some(TextureOrigin::UpperLeft),
    };
    // A certificate may list more levels than any node has, or fewer. The larger number counts, so
    // that whoever verifies looks at all of them.
    let n_listed;
    (scene.certificate, n_listed) = certificate(&json, (n_lower > 0).then_some(limits.level));
    scene.coarser_levels = if n_lower == 0 { 0 } else { n_lower.max(n_listed.saturating_sub(1)) };
    scene.stored = stored(&model);
    Ok(ReadOutcome { content: Content::Scene(scene), warnings: report.warnings })
}

fn parse_json(chunks: &container::GlbChunks<'_>, limits: &Limits) -> Result<JsonValue, ReadError> {
    // A value takes at most sixteen times the bytes of its text, so this stays below the limit.
    let most = json::MAX_BYTES.min(limits.bytes / 16);
    if chunks.json.len() as u64 > most {
        let what = format!("the JSON has {} bytes, the limit is {most}", chunks.json.len());
        return Err(ReadError::new("too-large", FileLocation::Byte(chunks.json_at), what));
    }
    let json = JsonValue::parse(chunks.json, chunks.json_at, limits)?;
    if !matches!(json, JsonValue::Object(_)) {
        let place = FileLocation::Pointer("/".to_owned());
        return Err(ReadError::new("TYPE_MISMATCH", place, "the document is no object"));
    }
    Ok(json)
}

/// The most bytes that are decoded from a file and checked. Chosen: a quarter of a GiB in addition to the
/// share of its bytes is more than real files need, and keeps a small file from taking hours.
fn decode_quota(n_bytes: usize, limits: &Limits) -> u64 {
    limits.bytes.min((1 << 28) + DECODED_PER_BYTE * n_bytes as u64)
}

/// Whether a glTF is JSON and not a binary container.
fn is_json(bytes: &[u8]) -> bool {
    bytes.iter().find(|b| !is_space(**b)) == Some(&b'{')
}

/// Whether a text is a glTF as JSON: an object with an `asset` that is not a tileset.
pub(crate) fn looks_like_json(text: &[u8]) -> bool {
    let names = |key: &[u8]| memchr::memmem::find(text, key).is_some();
    text.first() == Some(&b'{')
        && names(b"\"asset\"")
        && names(b"\"version\"")
        && !names(b"\"geometricError\"")
}

/// Checks that the lists fit into the limits.
fn check_rows(json: &JsonValue, limits: &Limits) -> Result<(), ReadError> {
    let most = limits.rows.min(limits.bytes / OBJECT_BYTES);
    for (key, value) in json.entries() {
        let n = value.items().map_or(0, <[_]>::len) as u64;
        if n > most {
            let what = format!("{n} objects exceed the limit of {most}");
            return Err(ReadError::new("too-many-rows", FileLocation::Pointer(format!("/{key}")), what));
        }
    }
    Ok(())
}

/// Checks rows without a view. They are zeros that take no bytes of the file, so only limits keep them from
/// growing.
fn check_zeros(model: &GltfModel<'_>, limits: &Limits, quota: u64) -> Result<(), ReadError> {
    let mut left = quota;
    for (i, accessor) in model.accessors.iter().enumerate() {
        let Some((accessor, count)) = accessor.as_ref().and_then(|a| Some((a, a.count?))) else { continue };
        if accessor.view.is_some() || accessor.unpacked.is_some() {
            continue;
        }
        let row = accessor.format().map_or(1, |format| format.row_length());
        let bytes = left.checked_sub(count.saturating_mul(row));
        left = match bytes {
            Some(left) if count <= limits.rows => left,
            _ => {
                let what = format!(
                    "{count} rows of zeros exceed the limits of {} rows and {} bytes",
                    limits.rows, quota
                );
                return Err(ReadError::new(
                    "too-many-rows",
                    FileLocation::Pointer(format!("/accessors/{i}/count")),
                    what,
                ));
            }
        };
    }
    Ok(())
}

/// How the file stores its numbers.
fn stored(model: &GltfModel<'_>) -> GltfPacking {
    let has_stream = model.views.iter().flatten().any(|view| view.packed.is_some());
    let is_draco =
        |primitive: &GltfPrimitive<'_>| primitive.draco.is_some() && !draco::has_plain_copy(model, primitive);
    let has_draco = model.meshes.iter().flatten().flat_map(|mesh| &mesh.primitives).any(is_draco);
    GltfPacking {
        is_compressed: has_stream || has_draco,
        is_quantized: model.extensions_used.contains(&QUANTIZATION),
    }
}

fn is_harmless(name: &str) -> bool {
    HARMLESS
        .iter()
        .any(|known| known.strip_suffix('*').map_or(name == *known, |start| name.starts_with(start)))
}

/// Refuses extensions that are required to read the triangles; counts other ignored ones.
fn check_extensions(model: &GltfModel<'_>, report: &mut GlbWarnings) -> Result<(), ReadError> {
    if let Some(i) = model.extensions_required.iter().position(|name| !is_harmless(name)) {
        let place = FileLocation::Pointer(format!("/extensionsRequired/{i}"));
        let what = format!("extension {} is required and not read", model.extensions_required[i]);
        return Err(ReadError::new("unsupported-extension", place, what));
    }
    for (i, name) in model.extensions_used.iter().enumerate().filter(|(_, name)| !is_harmless(name)) {
        let place = FileLocation::Pointer(format!("/extensionsUsed/{i}"));
        report.add("extension-ignored", place, format!("extension {name} was ignored"));
    }
    Ok(())
}

/// The certificate in a file: that of the first level, if there are several.
fn certificate(json: &JsonValue, level: Option<usize>) -> (Option<Value>, usize) {
    let extras = json.get("asset").and_then(|asset| asset.get("extras"));
    let Some(certificate) = extras.and_then(|extras| extras.get("chordal")) else { return (None, 0) };
    let levels = certificate.get("levels").and_then(JsonValue::items).filter(|_| level.is_some());
    let certificate = levels.map_or(Some(certificate), |levels| levels.get(level.unwrap_or(0)));
    let certificate =
        certificate.filter(|certificate| **certificate != JsonValue::Null).map(JsonValue::to_value);
    (certificate, levels.map_or(0, <[_]>::len))
}
