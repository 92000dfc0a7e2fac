//! `InstancedNodes`: the nodes that are written as instances of one mesh, as they were read.
use super::INSTANCING;
use super::instances::places;
use crate::{Node, Scene};
use serde_json::{Map, Value};

/// The nodes of a scene that were read from instances (`EXT_mesh_gpu_instancing`) and have not changed since.
pub(super) struct InstancedNodes {
    /// By node: the part that the node's extension instances.
    pub part: Vec<Option<usize>>,
    /// By node: whether it represents such an instance, and is not written as a node.
    pub is_place: Vec<bool>,
}

impl InstancedNodes {
    /// Finds them: nodes with instance attributes whose last children match the rows. Children stay nodes if
    /// their part needs nodes of its own (`may_show` is false) or if they are animated.
    pub fn of(scene: &Scene, may_show: impl Fn(usize) -> bool, is_animated: &[bool]) -> Self {
        let n = scene.nodes.len();
        let mut instanced = Self { part: vec![None; n], is_place: vec![false; n] };
        for (i, node) in scene.nodes.iter().enumerate() {
            let Some((part, children)) = unchanged_instances(scene, node) else { continue };
            if may_show(part) && !children.iter().any(|child| is_animated[*child]) {
                instanced.part[i] = Some(part);
                children.iter().for_each(|child| instanced.is_place[*child] = true);
            }
        }
        instanced
    }

    /// By node its index among the written nodes, which come after `first` others; the index of an instance
    /// is not used.
    pub fn numbers(&self, first: usize) -> Vec<usize> {
        let mut next = first;
        let number = |is_place: &bool| {
            let index = next;
            next += usize::from(!is_place);
            index
        };
        self.is_place.iter().map(number).collect()
    }
}

/// The part that a node's extension instances, and the children that represent the instances.
fn unchanged_instances<'a>(scene: &Scene, node: &'a Node) -> Option<(usize, &'a [usize])> {
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

/// The attributes of the instances of a node, as accessor indices.
fn attributes_of(properties: &Map<String, Value>) -> Option<&Map<String, Value>> {
    properties.get("extensions")?.get(INSTANCING)?.get("attributes")?.as_object()
}

/// Removes the attributes of instances that are written as nodes.
pub(super) fn remove_instances(properties: &mut Map<String, Value>) {
    let Some(extensions) = properties.get_mut("extensions").and_then(Value::as_object_mut) else { return };
    if extensions.shift_remove(INSTANCING).is_some() && extensions.is_empty() {
        properties.shift_remove("extensions");
    }
}

/// Visits the accessor indices in the instanced nodes of a file.
pub(super) fn each_instance_accessor(nodes: &mut [Value], visit: &mut impl FnMut(&mut Value)) {
    for node in nodes {
        let Some(Value::Object(attributes)) = node
            .get_mut("extensions")
            .and_then(|extensions| extensions.get_mut(INSTANCING)?.get_mut("attributes"))
        else {
            continue;
        };
        attributes.values_mut().for_each(&mut *visit);
    }
}
