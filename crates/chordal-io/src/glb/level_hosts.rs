//! The parts and nodes of a scene that can have coarser levels by `MSFT_lod`.
use super::deformation::{has_skin, targets_of};
use crate::{Node, Scene};
use serde_json::Value;

/// By part: whether nodes can refer to coarser levels of it. Not if it has morph targets, whose weights
/// animations set at one node; nor if it has a skin and a node has more than the part, since a child that
/// took a mesh with a skin would be below its root, where viewers may move it twice.
#[must_use]
pub fn takes_levels(scene: &Scene) -> Vec<bool> {
    let parts = scene.parts.iter();
    let mut takes: Vec<bool> = parts.clone().map(|part| targets_of(&part.mesh).is_empty()).collect();
    let has_skin: Vec<bool> = parts.map(|part| has_skin(&part.mesh)).collect();
    for (node, is_moved) in scene.nodes.iter().zip(animated_nodes(scene)) {
        if let Some(part) = node.part.filter(|part| has_skin.get(*part) == Some(&true)) {
            takes[part] &= is_replaceable(node, is_moved);
        }
    }
    takes
}

/// By node: whether an animation moves it, or the vertices of a skin follow it.
pub(super) fn animated_nodes(scene: &Scene) -> Vec<bool> {
    let mut is_animated = vec![false; scene.nodes.len()];
    let channels = scene.assets.animations.iter().filter_map(|animation| animation["channels"].as_array());
    for channel in channels.flatten() {
        let node = channel["target"]["node"].as_u64().and_then(|node| usize::try_from(node).ok());
        if let Some(is_animated) = node.and_then(|node| is_animated.get_mut(node)) {
            *is_animated = true;
        }
    }
    let joints = scene.assets.skins.iter().filter_map(|skin| skin["joints"].as_array());
    for joint in joints.flatten().filter_map(|joint| usize::try_from(joint.as_u64()?).ok()) {
        if let Some(is_animated) = is_animated.get_mut(joint) {
            *is_animated = true;
        }
    }
    is_animated
}

/// Whether a viewer that supports levels may replace a node and its descendants by a coarser level.
pub(super) fn is_replaceable(node: &Node, is_moved: bool) -> bool {
    let is_transform = |key: &str| ["translation", "rotation", "scale"].contains(&key);
    let is_plain = |(key, value): (&String, &Value)| match key.as_str() {
        "skin" => true,
        "extras" => value.is_object(),
        other => is_transform(other),
    };
    node.children.is_empty() && !is_moved && node.properties.iter().all(is_plain)
}
