//! `GlbLevel`: several levels of detail in one GLB, by `MSFT_lod`.
use super::document::{GltfDocument, GltfPart, plain_for};
use super::write::{pack_beside, pack_embedded, write_file};
use super::{LOD, node_list};
use crate::side_file::side_stem;
use crate::{FileSet, Scene, SceneAssets, WriteError};
use serde_json::{Map, Value, json};
use std::io::Write;

/// One level of detail.
#[derive(Clone, Copy, Debug)]
pub struct GlbLevel<'a> {
    /// The scene of the level.
    pub scene: &'a Scene,
    /// The certificate of the level.
    pub certificate: Option<&'a Value>,
    /// The least share of the screen, 0 to 1, that the object covers where this level is shown. Below it the
    /// next level is shown, and nothing after the last.
    pub coverage: f64,
}

/// Writes levels of detail as one GLB 2.0, finest first, the same bytes for the same levels.
///
/// Each level is written as [`super::write`] writes a scene, below a node of its own. The scene of the file
/// shows the first level. Its node names the nodes of the other levels by the extension `MSFT_lod`, and has
/// the screen coverages as its extra `MSFT_screencoverage`. The extension is not required, so a viewer that
/// does not know it shows the first level. The certificates go to `asset.extras.chordal.levels`, one for each
/// level, `null` where there is none. Materials are those of the first level, and animations are left out. A
/// single level is written as by [`super::write`].
///
/// # Errors
/// As for [`super::write`]; also when there is no level, and for coverages that are not from 0 to 1 or do not
/// decrease.
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::glb::{GlbLevel, write_levels};
/// use chordal_io::{Frame, Scene};
/// let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let fine = Mesh::new(corners.clone(), vec![[0, 1, 2], [0, 2, 3]])?;
/// let coarse = Mesh::new(corners[..3].to_vec(), vec![[0, 1, 2]])?;
/// let scenes = [fine, coarse].map(|mesh| Scene::from_mesh("", mesh, Frame::default()));
/// let levels = [(0, 0.25), (1, 0.0)]
///     .map(|(i, coverage)| GlbLevel { scene: &scenes[i], certificate: None, coverage });
/// let mut bytes = Vec::new();
/// write_levels(&levels, &mut bytes)?;
/// assert_eq!(&bytes[..4], b"glTF");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Source: Microsoft, MSFT_lod, glTF 2.0 vendor extension, 2017.
pub fn write_levels(levels: &[GlbLevel<'_>], out: &mut dyn Write) -> Result<(), WriteError> {
    check(levels)?;
    if let [only] = levels {
        return super::write(only.scene, only.certificate, out);
    }
    let assets = levels[0].scene.assets_for_gltf(plain_for);
    with_levels(levels, &assets, |document, json| write_file(document, json, out))
}

/// Writes the same as [`write_levels`] as a glTF of JSON alone, as [`super::write_embedded`] does.
///
/// # Errors
/// As for [`write_levels`], but there is no limit of 4 GiB.
pub fn write_levels_embedded(levels: &[GlbLevel<'_>], out: &mut dyn Write) -> Result<(), WriteError> {
    check(levels)?;
    if let [only] = levels {
        return super::write_embedded(only.scene, only.certificate, out);
    }
    let assets = levels[0].scene.assets_for_gltf(plain_for);
    with_levels(levels, &assets, |document, json| pack_embedded(document, json, out))
}

/// Writes the same as [`write_levels`] as a glTF of JSON with files beside it, as [`super::write_files`] does.
///
/// # Errors
/// As for [`write_levels`], but there is no limit of 4 GiB.
pub fn write_levels_files<'a>(levels: &[GlbLevel<'a>], stem: &str) -> Result<FileSet<'a>, WriteError> {
    check(levels)?;
    if let [only] = levels {
        return super::write_files(only.scene, only.certificate, stem);
    }
    let stem = side_stem(stem);
    let prefix = format!("{stem}_");
    let first: &'a Scene = levels[0].scene;
    let assets = first.assets_for_gltf(plain_for).with_pictures_beside(&prefix);
    let pack = |document: &GltfDocument<'_>, json| pack_beside(document, json, &stem);
    let mut files: FileSet<'a> = with_levels(levels, &assets, pack)?;
    files.beside.extend(first.assets.picture_files(&prefix));
    Ok(files)
}

/// Makes the document of all levels for a writer.
fn with_levels<T>(
    levels: &[GlbLevel<'_>],
    assets: &SceneAssets,
    write: impl FnOnce(&GltfDocument<'_>, Map<String, Value>) -> Result<T, WriteError>,
) -> Result<T, WriteError> {
    let shapes = levels
        .iter()
        .map(|level| {
            let shape = |part| GltfPart::from_part(part, &level.scene.frame);
            level.scene.parts.iter().map(shape).collect::<Result<Vec<_>, _>>()
        })
        .collect::<Result<Vec<_>, _>>()?;
    let mut document = GltfDocument::new(assets);
    let mut list = Vec::new();
    let mut tops = Vec::new();
    for ((i, level), shapes) in levels.iter().enumerate().zip(&shapes) {
        for (part, shape) in level.scene.parts.iter().zip(shapes) {
            document.add_part(part, shape)?;
        }
        let top = list.len();
        let nodes = document.nodes(level.scene, top + 1)?;
        let mut object = json!({});
        if !nodes.roots.is_empty() {
            object["children"] = json!(nodes.roots);
        }
        list.push(node_list::with_name(&format!("level {i}"), object));
        list.extend(nodes.list);
        tops.push(top);
    }
    let coverages: Vec<f64> = levels.iter().map(|level| level.coverage + 0.0).collect();
    list[0]["extensions"] = json!({ LOD: { "ids": tops[1..] } });
    list[0]["extras"] = json!({ "MSFT_screencoverage": coverages });
    let certificates: Vec<Value> =
        levels.iter().map(|level| level.certificate.cloned().unwrap_or(Value::Null)).collect();
    let certificate = json!({ "levels": certificates });
    let nodes = node_list::NodeList { list, roots: vec![0], first: 1 };
    let json = document.json(&nodes, Some(&certificate), Some(LOD));
    write(&document, json)
}

fn check(levels: &[GlbLevel<'_>]) -> Result<(), WriteError> {
    let refused = |what: String| Err(WriteError::Unsupported(what));
    if levels.is_empty() {
        return refused("there is no level to write".to_owned());
    }
    if let Some(i) = levels.iter().position(|level| !(0.0..=1.0).contains(&level.coverage)) {
        return refused(format!(
            "level {i} is shown from {} of the screen on, not 0 to 1",
            levels[i].coverage
        ));
    }
    match levels.windows(2).position(|pair| pair[1].coverage >= pair[0].coverage) {
        Some(i) => refused(format!("level {} is not shown on less of the screen than level {i}", i + 1)),
        None => Ok(()),
    }
}
