//! The GLB reader.
use super::assets::AssetReader;
use super::json::{self, JsonValue};
use super::leniency::{ForgivenIssues, detach_shown_children};
use super::lint::{self, GltfLint};
use super::lod_nodes::LodNodes;
use super::model::{GltfModel, item};
use super::parts::PartReader;
use super::report::GlbWarnings;
use super::{DECODED_PER_BYTE, INSTANCING, LOD};
use super::{container, deformation, external, instances, meshopt, packed_views, transform};
use crate::assets::SceneAssets;
use crate::files::FileOpener;
use crate::text::is_space;
use crate::{
    Axis, Content, FileLocation, Frame, Limits, MATERIAL, Node, ReadError, ReadOutcome, Scene, TextureOrigin,
};
use serde_json::Value;

/// The most bytes that one object of the JSON takes once it is read: a node with its transform takes the
/// most.
const OBJECT_BYTES: u64 = 512;

/// Extensions that are read, or do not change the triangles; `*` matches any ending.
const HARMLESS: [&str; 17] = [
    "KHR_mesh_quantization",
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
/// What gltf-validator calls an error, anywhere in the file, is refused with its code and JSON pointer, but for
/// what viewers accept; [`Limits::conformance`] refuses that too, or turns errors into warnings if the
/// triangles can be read all the same. Each mesh of the
/// file becomes one part, with the triangles of all its primitives; vertices at bit-identical positions are
/// tied. Positions are exactly the stored numbers, in the mesh's own space; nodes carry the transforms and
/// [`crate::Scene::world_meshes`] applies them. The frame is y-up and in metres. The certificate comes from
/// `asset.extras.chordal`.
///
/// Lists, strips and fans are read with any accessor of the format, also sparse and quantized ones. Points and
/// lines, and animations of anything but nodes, are counted as warnings; materials, textures, cameras, lights,
/// skins and extras of nodes go to [`Scene::assets`] and the nodes, as they are. Weights of joints and morph
/// targets become attributes of vertices that can be blended; positions are those at rest. The
/// reader never opens other files or the network; [`crate::read_with`] opens files beside it. Of levels of
/// detail by `MSFT_lod` the first is read, and the others are counted. The certificate is that of the first,
/// where [`super::write_levels`] wrote one for each.
///
/// Views that are compressed by `EXT_meshopt_compression` or `KHR_meshopt_compression` are unpacked. A node
/// with `EXT_mesh_gpu_instancing` gets a child for each instance, without a name, which shows the node's part;
/// the node itself shows none.
///
/// Linear in the size of the file and of what is decoded from it; the latter stays below [`Limits::bytes`].
///
/// # Errors
/// [`ReadError`] with the byte or the JSON pointer: the container or the JSON is broken, a limit is exceeded,
/// an unknown extension is required (Draco), a compressed view is broken, the triangles need another file, or
/// an error of gltf-validator.
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

/// As [`read`], and opens the buffers and pictures that are in other files, where there is an opener.
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
        container::GlbChunks { json: bytes, json_at: 0, bin: None }
    } else {
        container::chunks(bytes, limits, &mut report)?
    };
    let json = parse_json(&chunks, limits)?;
    check_rows(&json, limits)?;
    let mut quota = decode_quota(bytes.len(), limits);
    let mut lint = GltfLint::new(&json, quota);
    let Some(mut model) = lint::parse(&mut lint, &json, chunks.bin) else {
        let issue = lint.issues.swap_remove(0);
        return Err(ReadError::new(issue.code, issue.place, issue.message));
    };
    check_extensions(&model, &mut report)?;
    if let Some(open) = open {
        external::open_files(&mut model, &mut lint, open, limits, &mut report)?;
        quota = decode_quota(bytes.len() + model.n_external(), limits);
    }
    quota = packed_views::unpack(&mut model, &mut lint, quota)?;
    check_zeros(&model, limits, quota)?;
    lint::link(&mut lint, &mut model);
    let forgiven = ForgivenIssues::judge(lint.issues, limits, &mut report)?;
    let lower = LodNodes::new(&json, &model)?;
    let mut placing = GlbWarnings::default();
    let mut assets = AssetReader::new(&json, &model, quota);
    let mut scene = read_scene(&model, &lower, &mut assets, &mut placing);
    let (kept, numbers) = keep_first_levels(&mut scene, &model, &lower);
    quota = instances::place(&mut scene, &model, &numbers, (limits, quota), &mut placing)?;
    count_unseen(&scene, &kept, &mut placing);
    scene.assets = Box::new(assets.assets(|node| numbers.get(node).copied().flatten())?);
    let (mut materials, groups) = assets.materials();
    forgiven.clamp_factors(&mut materials, &groups);
    if !materials.is_empty() {
        let name = |material: &Value| material["name"].as_str().unwrap_or_default().to_owned();
        let names = std::iter::once(String::new()).chain(materials.iter().map(name)).collect();
        scene.groups.insert(MATERIAL.to_owned(), names);
    }
    scene.assets.materials = materials;
    let properties: Vec<_> = kept.iter().map(|mesh| assets.mesh_properties(*mesh)).collect();
    report.append(assets.into_report());
    let are_sound = drop_unsound_assets(&mut scene, &forgiven.unsound, &mut report);
    let mut parts = PartReader::new(&model, &groups, limits, quota);
    scene.parts = kept.into_iter().map(|mesh| parts.part(mesh)).collect::<Result<Vec<_>, _>>()?;
    if are_sound {
        for (part, properties) in scene.parts.iter_mut().zip(properties) {
            part.properties = Some(properties).filter(|map| !map.is_empty()).map(Box::new);
        }
    }
    report.append(parts.report);
    deformation::drop_dangling_references(&mut scene, &mut report);
    report.append(placing);
    scene.frame = Frame {
        up: Some(Axis::Y),
        metres_per_unit: Some(1.0),
        texture_origin: Some(TextureOrigin::UpperLeft),
    };
    scene.certificate = certificate(&json, &lower);
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

/// The most bytes that are decoded from a file and checked in it. A quarter of a GiB beside the share of its
/// bytes is beyond the needs of an honest file, and keeps a small one from taking hours.
fn decode_quota(n_bytes: usize, limits: &Limits) -> u64 {
    limits.bytes.min((1 << 28) + DECODED_PER_BYTE * n_bytes as u64)
}

/// Whether a glTF is JSON and not a binary container.
fn is_json(bytes: &[u8]) -> bool {
    bytes.iter().find(|b| !is_space(**b)) == Some(&b'{')
}

/// Whether a text is a glTF as JSON: an object with an `asset` that is no tileset.
pub(crate) fn looks_like_json(text: &[u8]) -> bool {
    let names = |key: &[u8]| memchr::memmem::find(text, key).is_some();
    text.first() == Some(&b'{')
        && names(b"\"asset\"")
        && names(b"\"version\"")
        && !names(b"\"geometricError\"")
}

/// Checks that the lists are short enough to be held.
fn check_rows(json: &JsonValue, limits: &Limits) -> Result<(), ReadError> {
    let most = limits.rows.min(limits.bytes / OBJECT_BYTES);
    for (key, value) in json.entries() {
        let n = value.items().map_or(0, <[_]>::len) as u64;
        if n > most {
            let what = format!("{n} objects pass the limit of {most}");
            return Err(ReadError::new("too-many-rows", FileLocation::Pointer(format!("/{key}")), what));
        }
    }
    Ok(())
}

/// Checks rows that lie in no view. They are zeros that take no bytes of the file, so only limits keep them
/// from growing.
fn check_zeros(model: &GltfModel<'_>, limits: &Limits, quota: u64) -> Result<(), ReadError> {
    let mut left = quota;
    for (i, accessor) in model.accessors.iter().enumerate() {
        let Some((accessor, count)) = accessor.as_ref().and_then(|a| Some((a, a.count?))) else { continue };
        if accessor.view.is_some() {
            continue;
        }
        let row = accessor.format().map_or(1, |format| format.row_length());
        let bytes = left.checked_sub(count.saturating_mul(row));
        left = match bytes {
            Some(left) if count <= limits.rows => left,
            _ => {
                let what = format!(
                    "{count} rows of zeros pass the limits of {} rows and {} bytes",
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

fn is_harmless(name: &str) -> bool {
    HARMLESS
        .iter()
        .any(|known| known.strip_suffix('*').map_or(name == *known, |start| name.starts_with(start)))
}

/// Refuses extensions without which the triangles cannot be understood; counts other ignored ones.
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

/// Leaves out what a forgiven issue may be about: a file that is written says nothing wrong. Whether what nodes
/// and meshes say stays.
fn drop_unsound_assets(scene: &mut Scene, codes: &[&str], report: &mut GlbWarnings) -> bool {
    if codes.is_empty() {
        return true;
    }
    let is_about_data = |code: &&str| {
        ["ACCESSOR_", "BUFFER_", "GLB_", meshopt::BROKEN_STREAM].iter().any(|kind| code.starts_with(kind))
            && !code.contains("ANIMATION")
    };
    let mut kept = Box::<SceneAssets>::default();
    let are_sound = codes.iter().all(is_about_data);
    if are_sound {
        kept.clone_from(&scene.assets);
        kept.animations.clear();
        kept.skins.clear();
        kept.accessors.clear();
    } else {
        scene.nodes.iter_mut().for_each(|node| node.properties.clear());
        scene.groups.remove(MATERIAL);
    }
    if kept != scene.assets {
        let what = "materials, cameras, lights and animations that may have errors were left out";
        report.add("assets-dropped", FileLocation::File, what);
        scene.assets = kept;
    }
    are_sound
}

/// The nodes, and the roots of the scene that is shown: the default one, else the first, else all nodes
/// without parents.
fn read_scene(
    model: &GltfModel<'_>,
    lower: &LodNodes,
    assets: &mut AssetReader<'_>,
    report: &mut GlbWarnings,
) -> Scene {
    let n = model.nodes.len();
    let mut nodes = Vec::with_capacity(n);
    let mut has_parent = vec![false; n];
    for (i, node) in model.nodes.iter().enumerate() {
        let Some(node) = node else {
            nodes.push(Node::default());
            continue;
        };
        let children: Vec<usize> =
            node.children.iter().flatten().copied().filter(|child| *child < n).collect();
        children.iter().for_each(|child| has_parent[*child] = true);
        let rotation = node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
        let trs = || {
            transform::compose(node.translation.unwrap_or_default(), rotation, node.scale.unwrap_or([1.0; 3]))
        };
        let part = node.mesh.filter(|mesh| *mesh < model.meshes.len());
        nodes.push(Node {
            name: node.name.to_owned(),
            matrix: node.matrix.as_deref().copied().unwrap_or_else(trs),
            children,
            part,
            properties: assets.node_properties(i),
        });
    }
    let shown = model.scene.or(if model.scenes.is_empty() { None } else { Some(0) });
    let mut roots = match item(&model.scenes, shown) {
        Some(scene) => scene.nodes.iter().flatten().flatten().copied().filter(|node| *node < n).collect(),
        None => (0..n).filter(|i| !has_parent[*i] && !lower.is_named(*i)).collect::<Vec<_>>(),
    };
    assets.has_cut_nodes = detach_shown_children(&mut nodes, &mut roots);
    if let Some(first) = lower.first {
        let place = FileLocation::Pointer(format!("/nodes/{first}/extensions/{LOD}"));
        let what = "lower levels of detail were left out: the first one was read";
        report.add_many("lower-levels-skipped", lower.n_levels, place, what);
    }
    Scene { nodes, roots, ..Scene::default() }
}

/// Removes the nodes that are lower levels of detail. Returns the meshes that become parts: all but those
/// that only such nodes show.
/// Also the new number of every node that stays.
fn keep_first_levels(
    scene: &mut Scene,
    model: &GltfModel<'_>,
    lower: &LodNodes,
) -> (Vec<usize>, Vec<Option<usize>>) {
    let n_meshes = model.meshes.len();
    if lower.first.is_none() {
        return ((0..n_meshes).collect(), (0..scene.nodes.len()).map(Some).collect());
    }
    let hidden = lower.hidden_nodes(model, &scene.roots);
    let (mut is_lower, mut is_seen) = (vec![false; n_meshes], vec![false; n_meshes]);
    for (node, hidden) in scene.nodes.iter().zip(&hidden) {
        if let Some(mesh) = node.part {
            let list = if *hidden { &mut is_lower } else { &mut is_seen };
            list[mesh] = true;
        }
    }
    let kept: Vec<usize> = (0..n_meshes).filter(|mesh| is_seen[*mesh] || !is_lower[*mesh]).collect();
    let mut part_of = vec![None; n_meshes];
    kept.iter().enumerate().for_each(|(part, mesh)| part_of[*mesh] = Some(part));
    let mut number = vec![None; scene.nodes.len()];
    let shown = (0..hidden.len()).filter(|node| !hidden[*node]);
    shown.enumerate().for_each(|(new, old)| number[old] = Some(new));
    let renumber = |list: &[usize]| list.iter().filter_map(|node| number[*node]).collect();
    scene.roots = renumber(&scene.roots);
    let nodes = std::mem::take(&mut scene.nodes).into_iter().zip(&hidden).filter(|(_, hidden)| !**hidden);
    scene.nodes = nodes
        .map(|(node, _)| Node {
            children: renumber(&node.children),
            part: node.part.and_then(|mesh| part_of[mesh]),
            ..node
        })
        .collect();
    (kept, number)
}

/// The certificate in a file: that of the first level, if there are several.
fn certificate(json: &JsonValue, lower: &LodNodes) -> Option<Value> {
    let extras = json.get("asset").and_then(|asset| asset.get("extras"));
    let found = extras.and_then(|extras| extras.get("chordal"))?;
    let levels = found.get("levels").and_then(JsonValue::items).filter(|_| lower.first.is_some());
    let found = levels.map_or(Some(found), <[_]>::first)?;
    (*found != JsonValue::Null).then(|| found.to_value())
}

/// Counts meshes that no node of the scene shows; each part is one of these meshes.
fn count_unseen(scene: &Scene, meshes: &[usize], report: &mut GlbWarnings) {
    let mut is_shown = vec![false; meshes.len()];
    let mut open = scene.roots.clone();
    while let Some(i) = open.pop() {
        if let Some(part) = scene.nodes[i].part {
            is_shown[part] = true;
        }
        open.extend(&scene.nodes[i].children);
    }
    for (mesh, _) in meshes.iter().zip(&is_shown).filter(|(_, shown)| !**shown) {
        let place = FileLocation::Pointer(format!("/meshes/{mesh}"));
        report.add("meshes-not-shown", place, "the scene does not show all meshes");
    }
}
