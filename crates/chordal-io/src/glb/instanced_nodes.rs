//! `InstancedNodes`: which nodes are written as they were read, as one that shows its mesh at many places.
use super::INSTANCING;
use super::instances::places;
use crate::{Node, Scene};
use serde_json::{Map, Value};

/// The nodes of a scene that were read from instances (`EXT_mesh_gpu_instancing`) and still say what those said.
pub(super) struct InstancedNodes {
    /// By node: the part that it shows at the places of its extension.
    pub part: Vec<Option<usize>>,
    /// By node: whether it is one of those places, and no node of the file.
    pub is_place: Vec<bool>,
}

impl InstancedNodes {
    /// Finds them: the last children of a node with the attributes of instances, each where its row says. Of parts that
    /// need nodes of their own, which `may_show` refuses, and of what is animated, places stay nodes.
    pub fn of(scene: &Scene, may_show: impl Fn(usize) -> bool, is_animated: &[bool]) -> Self {
        let n = scene.nodes.len();
        let mut found = Self { part: vec![None; n], is_place: vec![false; n] };
        for (i, node) in scene.nodes.iter().enumerate() {
            let Some((part, children)) = kept(scene, node) else { continue };
            if may_show(part) && !children.iter().any(|child| is_animated[*child]) {
                found.part[i] = Some(part);
                children.iter().for_each(|child| found.is_place[*child] = true);
            }
        }
        found
    }

    /// By node its number among those that are written, which come after `first` others; that of a place is not used.
    pub fn numbers(&self, first: usize) -> Vec<usize> {
        let mut next = first;
        let number = |is_place: &bool| {
            let own = next;
            next += usize::from(!is_place);
            own
        };
        self.is_place.iter().map(number).collect()
    }
}

/// The part that a node shows at the places of its extension, and the children that stand for them.
fn kept<'a>(scene: &Scene, node: &'a Node) -> Option<(usize, &'a [usize])> {
    let attributes = attributes_of(&node.properties)?;
    let places = places(attributes, &scene.assets.accessors)?;
    let children = &node.children[node.children.len().checked_sub(places.len())?..];
    let part = scene.nodes.get(*children.first()?)?.part?;
    let is_trs = |key: &String| ["translation", "rotation", "scale"].contains(&key.as_str());
    let is_kept = |(child, place): (&usize, &[f64; 16])| {
        scene.nodes.get(*child).is_some_and(|child| {
            child.part == Some(part)
                && *child.matrix == *place
                && child.name.is_empty()
                && child.children.is_empty()
                && child.properties.keys().all(is_trs)
        })
    };
    (node.part.is_none() && children.iter().zip(&places).all(is_kept)).then_some((part, children))
}

/// The attributes of the instances of a node, by the numbers of their accessors.
fn attributes_of(properties: &Map<String, Value>) -> Option<&Map<String, Value>> {
    properties.get("extensions")?.get(INSTANCING)?.get("attributes")?.as_object()
}

/// Takes out the attributes of instances that are written as nodes.
pub(super) fn remove_instances(properties: &mut Map<String, Value>) {
    let Some(extensions) = properties.get_mut("extensions").and_then(Value::as_object_mut) else { return };
    if extensions.shift_remove(INSTANCING).is_some() && extensions.is_empty() {
        properties.shift_remove("extensions");
    }
}

/// Visits the numbers of accessors in the nodes of a file that show a mesh at many places.
pub(super) fn each_instance_accessor(nodes: &mut [Value], visit: &mut impl FnMut(&mut Value)) {
    for node in nodes {
        let Some(Value::Object(attributes)) =
            node.get_mut("extensions").and_then(|all| all.get_mut(INSTANCING)?.get_mut("attributes"))
        else {
            continue;
        };
        attributes.values_mut().for_each(&mut *visit);
    }
}
