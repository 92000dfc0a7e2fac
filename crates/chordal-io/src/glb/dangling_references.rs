//! Removes references to joint weights or morph targets that no mesh of the file has.
use super::deformation::{has_skin, targets_of};
use super::report::GlbWarnings;
use crate::{FileLocation, Scene};
use serde_json::{Map, Value};

/// Removes references to joint weights or morph targets that no mesh has.
pub(super) fn drop_dangling_references(scene: &mut Scene, report: &mut GlbWarnings) {
    let n_targets: Vec<usize> = scene.parts.iter().map(|part| targets_of(&part.mesh).len()).collect();
    let is_skinned: Vec<bool> = scene.parts.iter().map(|part| has_skin(&part.mesh)).collect();
    let n_weights = |properties: &Map<String, Value>| {
        // A list with anything but numbers counts as empty. Both are refused below, even for a mesh
        // without targets: glTF has no empty lists.
        let numbers = |weights: &Vec<Value>| weights.iter().all(Value::is_number).then_some(weights.len());
        properties.get("weights").map(|weights| weights.as_array().and_then(numbers).unwrap_or(0))
    };
    let mut n_lost = 0;
    for (part, n_targets) in scene.parts.iter_mut().zip(&n_targets) {
        if let Some(properties) = &mut part.properties
            && n_weights(properties).is_some_and(|n| n == 0 || n != *n_targets)
        {
            properties.shift_remove("weights");
            n_lost += 1;
        }
    }
    let mut n_unskinned = 0;
    for node in &mut scene.nodes {
        let own_targets = node.part.map_or(0, |part| n_targets[part]);
        if n_weights(&node.properties).is_some_and(|n| n == 0 || n != own_targets) {
            node.properties.shift_remove("weights");
            n_lost += 1;
        }
        let skin = node.properties.get("skin").map(Value::as_u64);
        let is_there = |skin: Option<u64>| skin.is_some_and(|skin| skin < scene.assets.skins.len() as u64);
        if skin.is_some_and(|skin| !is_there(skin) || !node.part.is_some_and(|part| is_skinned[part])) {
            node.properties.shift_remove("skin");
            n_unskinned += 1;
        }
    }
    // Runs after the parts were read: only then is it known which morph targets were kept.
    let is_kept = |channel: &Value| {
        let target = &channel["target"];
        let node = target["node"].as_u64().and_then(|node| scene.nodes.get(usize::try_from(node).ok()?));
        target["path"] != "weights" || node.and_then(|node| node.part).is_some_and(|part| n_targets[part] > 0)
    };
    scene.assets.animations.retain_mut(|animation| {
        let Some(channels) = animation["channels"].as_array_mut() else { return false };
        channels.retain(is_kept);
        !channels.is_empty()
    });
    report.add_many("morph-targets-ignored", n_lost, FileLocation::File, "some morph targets were not kept");
    report.add_many("skins-ignored", n_unskinned, FileLocation::File, "some skins were not kept");
}
