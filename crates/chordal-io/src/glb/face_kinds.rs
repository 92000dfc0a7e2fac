//! `FileFaceKinds`: the properties of a file's primitives, and the face groups that represent them.
use super::format::FIRST_MODE_OF_TRIANGLES;
use super::json::JsonValue;
use crate::FaceKind;
use crate::assets::{VARIANTS, plain_material};
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// The materials of a file and the properties of its primitives.
pub(super) struct FileFaceKinds {
    /// The materials, then one for bare faces that have properties, then duplicates of others.
    pub materials: Vec<Value>,
    pub kinds: BTreeMap<usize, FaceKind>,
    /// By mesh and primitive: the group of its faces; 0 if there is no material, or the plain one that the
    /// writer gives to bare faces.
    pub groups: Vec<Vec<usize>>,
    /// Whether some faces have no material.
    pub has_bare_faces: bool,
}

/// A primitive with triangles: its material, and its other properties.
struct PaintedFaces {
    mesh: usize,
    primitive: usize,
    material: Option<usize>,
    properties: Map<String, Value>,
}

impl FileFaceKinds {
    /// Reads the primitives of a file's meshes; `materials` are those of the file.
    pub fn from_meshes(meshes: &[JsonValue], mut materials: Vec<Value>) -> Self {
        let n = materials.len();
        let mut groups: Vec<Vec<usize>> =
            meshes.iter().map(|mesh| vec![0; primitives_of(mesh).len()]).collect();
        let painted = painted_faces(meshes, n);
        let has_bare_faces = painted.iter().any(|faces| faces.material.is_none());
        // Marks refer to materials by their index in the file, so materials cannot be removed.
        if !has_bare_faces && !has_marks(meshes) && painted.iter().all(|faces| faces.properties.is_empty()) {
            let numbers = without_plain(&mut materials);
            for faces in painted {
                groups[faces.mesh][faces.primitive] = faces.material.map_or(0, |material| numbers[material]);
            }
            return Self { materials, kinds: BTreeMap::new(), groups, has_bare_faces };
        }
        if painted.iter().any(|faces| faces.material.is_none() && !faces.properties.is_empty()) {
            // A copy of glTF's default: bare faces with properties need a group.
            materials.push(json!({}));
        }
        // A material that some faces have without properties stays for these: faces with properties
        // get a copy. Otherwise the first kind may take the material itself.
        let silent = painted.iter().filter(|faces| faces.properties.is_empty());
        let mut taken: BTreeSet<usize> = silent.filter_map(|faces| faces.material).collect();
        let mut kinds = BTreeMap::new();
        let mut kind_indices: BTreeMap<(usize, String), usize> = BTreeMap::new();
        for PaintedFaces { mesh, primitive, material, properties } in painted {
            groups[mesh][primitive] = if properties.is_empty() {
                material.map_or(0, |material| material + 1)
            } else {
                // `n` is the copy of the default that was pushed above.
                let material = material.unwrap_or(n);
                // Properties are JSON, which has no order; their text has.
                let key = (material, Value::Object(properties.clone()).to_string());
                1 + *kind_indices.entry(key).or_insert_with(|| {
                    let idx = if taken.insert(material) { material } else { materials.len() };
                    if idx == materials.len() {
                        materials.push(materials[material].clone());
                    }
                    kinds.insert(idx, FaceKind { material, properties });
                    idx
                })
            };
        }
        Self { materials, kinds, groups, has_bare_faces }
    }
}

fn primitives_of(mesh: &JsonValue) -> &[JsonValue] {
    mesh.get("primitives").and_then(JsonValue::items).unwrap_or_default()
}

/// Whether a primitive is points or lines.
fn is_marks(primitive: &JsonValue) -> bool {
    let mode = primitive.get("mode").and_then(JsonValue::integer);
    mode.and_then(|mode| u64::try_from(mode).ok()).is_some_and(|mode| mode < FIRST_MODE_OF_TRIANGLES)
}

/// Whether some mesh has points or lines.
fn has_marks(meshes: &[JsonValue]) -> bool {
    meshes.iter().flat_map(primitives_of).any(is_marks)
}

/// The primitives with triangles of a file with `n_materials` materials.
fn painted_faces(meshes: &[JsonValue], n_materials: usize) -> Vec<PaintedFaces> {
    let mut painted = Vec::new();
    for (mesh, object) in meshes.iter().enumerate() {
        for (primitive, object) in primitives_of(object).iter().enumerate() {
            if is_marks(object) {
                continue;
            }
            let material = object.get("material").and_then(JsonValue::integer);
            let material = material.and_then(|material| usize::try_from(material).ok());
            let material = material.filter(|material| *material < n_materials);
            painted.push(PaintedFaces { mesh, primitive, material, properties: properties_of(object) });
        }
    }
    painted
}

/// The properties of a primitive that are kept: its extras, and its materials in variants.
pub(super) fn properties_of(primitive: &JsonValue) -> Map<String, Value> {
    let mut properties = Map::new();
    if let Some(extras) = primitive.get("extras") {
        properties.insert("extras".to_owned(), extras.to_value());
    }
    if let Some(variants) = primitive.get("extensions").and_then(|extensions| extensions.get(VARIANTS)) {
        properties.insert("extensions".to_owned(), json!({ VARIANTS: variants.to_value() }));
    }
    properties
}

/// Removes the materials that the writer would give to bare faces. Returns the group of each material.
fn without_plain(materials: &mut Vec<Value>) -> Vec<usize> {
    let plain = [plain_material(false), plain_material(true)];
    let (mut groups, mut n_kept) = (Vec::with_capacity(materials.len()), 0);
    materials.retain(|material| {
        let is_kept = !plain.contains(material);
        n_kept += usize::from(is_kept);
        groups.push(if is_kept { n_kept } else { 0 });
        is_kept
    });
    groups
}
