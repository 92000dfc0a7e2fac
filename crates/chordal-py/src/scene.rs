//! Scenes of triangles for Python: facts as JSON, numbers as arrays that are not copied.
use crate::array::{Array, ArrayData};
use crate::rows::ShownRows;
use crate::scene_state::{SceneState, attribute_names, scene_of};
use crate::source::Source;
use crate::{failure, work};
use chordal::budget::Unit;
use chordal_io::{Format, ImageContent, Scene, TextureOrigin};
use chordal_verbs::{Composed, Input, InputDigest, Shape, compose_input, join_input};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;
use serde_json::{Value, json};
use std::borrow::Cow;
use std::sync::Arc;

fn scene_in(input: &Input) -> Option<&Scene> {
    if let Shape::Scene(scene) = &input.shape { Some(scene) } else { None }
}

/// Names, sizes, attributes, nodes and materials of a scene, as JSON.
#[pyfunction]
pub(crate) fn scene_facts(py: Python<'_>, source: &Source) -> PyResult<String> {
    let scene = scene_in(source.input()).ok_or_else(|| failure::internal(py, "these are no triangles"))?;
    let parts: Value = scene
        .parts
        .iter()
        .map(|part| {
            let attributes: Value = part.mesh.attributes().iter().map(attribute_names).collect();
            json!({
                "name": part.name,
                "vertices": part.mesh.positions().len(),
                "faces": part.mesh.faces().len(),
                "attributes": attributes,
                "v_is_down": scene.frame.texture_origin == Some(TextureOrigin::UpperLeft),
            })
        })
        .collect();
    let nodes: Value = scene
        .nodes
        .iter()
        .map(|node| {
            json!({ "name": node.name, "matrix": *node.matrix, "children": node.children, "part": node.part })
        })
        .collect();
    let frame = &scene.frame;
    let facts = json!({
        "parts": parts,
        "nodes": nodes,
        "roots": scene.roots,
        "groups": scene.groups,
        "materials": scene.assets.materials,
        "images": scene.assets.images.len(),
        "textures": scene.assets.textures,
        "up": frame.up.map(chordal_io::Axis::letter),
        "metres_per_unit": frame.metres_per_unit,
    });
    Ok(facts.to_string())
}

/// An array of a part in its own coordinates: "vertices", "faces", "position_ids", or an attribute by its
/// index. Without a part, the "vertices" and "faces" of everything that is shown, in the scene's coordinates,
/// or an attribute of the only part in these coordinates.
#[pyfunction]
pub(crate) fn scene_array(
    py: Python<'_>,
    source: &Source,
    part: Option<usize>,
    name: &str,
    attribute: Option<usize>,
) -> PyResult<Array> {
    let unknown = || failure::internal(py, &format!("there is no {name}, or too much of it"));
    let Some(part) = part else {
        return attribute.map_or_else(|| shown_array(py, source, name), |k| shown_attribute(py, source, k));
    };
    let owner = source.input();
    let mesh = &scene_in(owner).and_then(|scene| scene.parts.get(part)).ok_or_else(unknown)?.mesh;
    if let Some(k) = attribute {
        mesh.attributes().get(k).ok_or_else(unknown)?;
    } else {
        // Python gets the indices where they lie, as signed numbers.
        i32::try_from(mesh.positions().len()).map_err(|_| unknown())?;
    }
    let (name, has_ids) = (name.to_owned(), mesh.position_id().is_some());
    if !matches!((name.as_str(), has_ids), ("vertices" | "faces" | "attribute", _) | ("position_ids", true)) {
        return Err(unknown());
    }
    Ok(Array::new(owner, move |input| {
        let Some(part) = scene_in(input).and_then(|scene| scene.parts.get(part)) else {
            return ArrayData::from_f64(&[], 3);
        };
        let mesh = &part.mesh;
        match (name.as_str(), attribute.and_then(|k| mesh.attributes().get(k))) {
            (_, Some(attribute)) => ArrayData::from_f64(&attribute.values, attribute.width),
            ("vertices", _) => ArrayData::from_f64(mesh.positions().as_flattened(), 3),
            ("faces", _) => ArrayData::from_u32_below_sign(mesh.faces().as_flattened(), 3),
            _ => ArrayData::from_u32_below_sign(mesh.position_id().unwrap_or_default(), 1),
        }
    }))
}

/// An attribute of the only part, in the scene's coordinates, repeated for each instance in the order of
/// [`shown_array`].
fn shown_attribute(py: Python<'_>, source: &Source, number: usize) -> PyResult<Array> {
    let scene = scene_in(source.input()).ok_or_else(|| failure::internal(py, "these are no triangles"))?;
    let meshes = scene.world_meshes().map_err(|error| failure::write(py, &error))?;
    // The first part: whoever asks has made sure that there is no other.
    if let [] | [(_, Cow::Borrowed(_))] = &meshes[..] {
        return scene_array(py, source, Some(0), "attribute", Some(number));
    }
    let mut rows = (0, Vec::new());
    for attribute in meshes.iter().filter_map(|(_, mesh)| mesh.attributes().get(number)) {
        rows.0 = attribute.width;
        rows.1.extend_from_slice(&attribute.values);
    }
    Ok(Array::new(&Arc::new(rows), |(width, values)| ArrayData::from_f64(values, *width)))
}

/// The vertices or faces of everything that is shown; not copied if the scene shows one part untransformed.
fn shown_array(py: Python<'_>, source: &Source, name: &str) -> PyResult<Array> {
    let unknown = || failure::internal(py, &format!("there are no {name}, or too many"));
    let scene = scene_in(source.input()).ok_or_else(unknown)?;
    let rows = ShownRows::from_scene(scene).map_err(|error| failure::write(py, &error))?;
    let Some(rows) = rows else { return scene_array(py, source, Some(0), name, None) };
    ShownRows::array(&Arc::new(rows), name).ok_or_else(unknown)
}

/// The bytes of an image of a scene; `None` for one in another file.
#[pyfunction]
pub(crate) fn scene_image<'py>(
    py: Python<'py>,
    source: &Source,
    number: usize,
) -> Option<Bound<'py, PyBytes>> {
    match &scene_in(source.input())?.assets.images.get(number)?.content {
        ImageContent::Bytes(bytes) => Some(PyBytes::new(py, bytes)),
        ImageContent::Uri(_) => None,
    }
}

/// The bound of a composed scene, from the known bounds of the subtrees of some nodes.
#[pyfunction]
pub(crate) fn composed_bound(py: Python<'_>, source: &Source, known: Vec<(usize, f64)>) -> PyResult<f64> {
    let input = Arc::clone(source.input());
    let bound = work::run(py, None, move |_| Some(chordal_verbs::composed_bound(scene_in(&input)?, &known)))?;
    bound.ok_or_else(|| failure::internal(py, "these are no triangles"))
}

/// The same scene with the histories of its parts: those of the subtrees of some nodes or, without nodes, of
/// the inputs that were joined in order.
#[pyfunction]
pub(crate) fn scene_of_parts(
    py: Python<'_>,
    source: &Source,
    parts: Vec<PyRef<'_, Source>>,
    nodes: Option<Vec<usize>>,
) -> PyResult<Source> {
    let input = Arc::clone(source.input());
    let parts: Vec<Arc<Input>> = parts.iter().map(|part| Arc::clone(part.input())).collect();
    let composed = work::run(py, None, move |_| {
        let input = Input::clone(&input);
        let parts = parts.iter().map(|part| &**part);
        match nodes {
            Some(nodes) => compose_input(input, &nodes.into_iter().zip(parts).collect::<Vec<_>>()),
            None => join_input(input, &parts.collect::<Vec<_>>()),
        }
    })?;
    let composed = composed.map_err(|error| failure::write(py, &error))?;
    Ok(Source::from_input(composed, Vec::new()))
}

/// A text and blocks of bytes.
type StateBytes<'py> = (String, Vec<Bound<'py, PyBytes>>);

/// The state of a scene, from which [`scene_of_state`] restores it.
#[pyfunction]
pub(crate) fn scene_state<'py>(py: Python<'py>, source: &Source) -> PyResult<StateBytes<'py>> {
    let input = Arc::clone(source.input());
    let state = work::run(py, None, move |_| {
        let SceneState { mut facts, blocks } = SceneState::from_scene(scene_in(&input)?);
        facts["format"] = input.format.to_string().into();
        facts["n_bytes"] = input.n_bytes.into();
        facts["sha256"] = input.sha256().into();
        facts["composed"] = serde_json::to_value(input.composed.as_deref()).unwrap_or_default();
        Some((facts.to_string(), blocks))
    })?;
    let (text, blocks) = state.ok_or_else(|| failure::internal(py, "these are no triangles"))?;
    Ok((text, blocks.iter().map(|block| PyBytes::new(py, block)).collect()))
}

/// The scene of a state. Missing fields have the defaults of files; without a digest of a file, that of the
/// geometry is used.
#[pyfunction]
pub(crate) fn scene_of_state(
    py: Python<'_>,
    text: &str,
    blocks: Vec<PyBackedBytes>,
    unit: Option<&str>,
) -> PyResult<Source> {
    let facts: Value = serde_json::from_str(text).map_err(|error| failure::argument("state", error))?;
    let metres_per_unit = crate::spec::parse_argument::<Unit>("unit", unit)?.map(Unit::metres);
    let format = facts["format"].as_str().unwrap_or("ply").parse::<Format>();
    let format = format.map_err(|error| failure::argument("state", error))?;
    let input = work::run(py, None, move |_| {
        let n_bytes = blocks.iter().map(|block| block.len() as u64).sum::<u64>();
        let digest =
            facts["sha256"].as_str().map_or_else(InputDigest::default, |known| known.to_owned().into());
        let n_bytes = facts["n_bytes"].as_u64().unwrap_or(n_bytes);
        let mut scene = scene_of(&facts, &blocks)?;
        scene.frame.metres_per_unit = metres_per_unit.or(scene.frame.metres_per_unit);
        let composed: Option<Composed> =
            serde_json::from_value(facts["composed"].clone()).map_err(|error| error.to_string())?;
        let composed = composed.map(Arc::new);
        Ok(Input { n_bytes, digest, composed, ..Input::made(Shape::Scene(scene), format) })
    })?;
    input
        .map(|input| Source::from_input(input, Vec::new()))
        .map_err(|error: String| failure::argument("faces", error))
}
