//! Applies the transforms of a scene.
use super::placements::part_placements;
use chordal::budget::advice::Message;
use chordal::math::greater;
use chordal_io::{Format, Node, Part, Scene, WriteError};
use serde_json::{Map, Value};

/// A scene with its transforms applied, and a bound for the rounding of that.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TransformedScene {
    /// The scene.
    pub scene: Scene,
    /// No vertex is further than this from its position in exact arithmetic.
    pub moved_at_most: f64,
    /// Parts without a placement, which are dropped.
    pub left_out: usize,
}

impl TransformedScene {
    /// A scene whose transforms are not applied.
    pub fn unchanged(scene: Scene) -> Self {
        Self { scene, moved_at_most: 0.0, left_out: 0 }
    }

    /// The note on parts that were left out.
    pub fn note(&self) -> Option<Message> {
        (self.left_out > 0)
            .then(|| format!("parts that no node shows were left out ({}x)", self.left_out).into())
    }
}

/// Whether a skin or morph targets pose a part of the scene at rest.
pub(crate) fn is_posed(scene: &Scene) -> bool {
    let poses = scene.rest_poses();
    (0..scene.nodes.len()).any(|node| poses.is_posed(node))
}

/// The scene as a format can hold it: unchanged, or with its transforms applied if the format has no nodes, or no skins for
/// a scene with skins.
///
/// # Errors
/// As for [`flatten`].
pub(crate) fn flatten_for(scene: Scene, to: Format) -> Result<TransformedScene, WriteError> {
    let holds_skins = to.is_gltf();
    let stays = to.has_nodes() && (holds_skins || !is_posed(&scene));
    if stays { Ok(TransformedScene::unchanged(scene)) } else { flatten(scene) }
}

/// The scene for formats without nodes: one part for each placement, in world coordinates.
///
/// A scene without transforms, in which every part has one placement, is left as it is.
///
/// # Errors
/// If the nodes are not a tree, or take coordinates out of range.
pub(crate) fn flatten(scene: Scene) -> Result<TransformedScene, WriteError> {
    let places = part_placements(&scene);
    let mut times = vec![0; scene.parts.len()];
    places.iter().for_each(|place| times[place.part] += 1);
    if places.iter().all(|place| place.is_identity) && times.iter().all(|times| *times == 1) {
        return Ok(TransformedScene::unchanged(scene));
    }
    let moved_at_most = places.iter().filter(|place| !place.is_identity).fold(0.0, |most, place| {
        let moved = place.rounding(&scene.parts[place.part]);
        greater(moved, most)
    });
    let indexed = scene.parts.iter().all(|part| part.indexed);
    let poses = scene.rest_poses();
    let mut flat = Scene {
        frame: scene.frame,
        groups: scene.groups.clone(),
        assets: scene.assets.clone(),
        ..Scene::default()
    };
    for (place, (name, mesh)) in places.iter().zip(scene.world_meshes()?) {
        let (part, node) = (&scene.parts[place.part], &scene.nodes[place.node]);
        let at = flat.parts.len();
        let mesh = mesh.into_owned();
        let is_posed = poses.is_posed(place.node);
        let mut properties = part.properties.clone();
        let mut node_properties = properties_beside_transform(node);
        if is_posed {
            // The mesh is in its pose now.
            ["skin", "weights"].iter().for_each(|key| drop(node_properties.shift_remove(*key)));
            properties.iter_mut().for_each(|properties| drop(properties.shift_remove("weights")));
        }
        // Points and lines are not moved: flattened scenes are only written to formats without points and lines, or without
        // nodes.
        let (name_of_part, marks) = (part.name.clone(), part.marks.clone());
        flat.parts.push(Part { mesh, indexed, name: name_of_part, properties, marks, ..Part::default() });
        flat.nodes.push(Node {
            name: name.to_owned(),
            part: Some(at),
            properties: node_properties.into(),
            ..Node::default()
        });
        flat.roots.push(at);
    }
    let left_out = times.iter().filter(|times| **times == 0).count();
    Ok(TransformedScene { scene: flat, moved_at_most, left_out })
}

/// The properties of a node without its transform.
fn properties_beside_transform(node: &Node) -> Map<String, Value> {
    let is_transform = |key: &str| matches!(key, "translation" | "rotation" | "scale");
    node.properties
        .iter()
        .filter(|(key, _)| !is_transform(key))
        .map(|(k, v)| (k.clone(), v.clone()))
        .collect()
}
