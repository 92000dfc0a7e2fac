//! `NodeList`: the nodes of a GLB, which place its meshes.
use super::instanced_nodes::{InstancedNodes, remove_instances};
use super::level_hosts::{animated_nodes, is_replaceable};
use super::stored_positions::StoredPositions;
use super::{LOD, transform};
use crate::forest::check_forest;
use crate::{Axis, Frame, Node, Scene, WriteError};
use serde_json::{Map, Value, json};

/// A part as it was written.
pub(super) struct PartMesh {
    /// Its mesh, unless it is empty.
    pub mesh: Option<usize>,
    /// How its positions are stored.
    pub positions: StoredPositions,
    /// Whether its vertices have joint weights.
    pub has_skin: bool,
    /// The number of its morph targets.
    pub n_targets: usize,
}

impl PartMesh {
    /// Whether any node can show its mesh without an extra transform.
    fn is_plain(&self) -> bool {
        self.mesh.is_some() && self.positions.is_plain() && !self.has_skin && self.n_targets == 0
    }
}

/// The nodes of a file, and its root nodes.
pub(super) struct NodeList {
    pub list: Vec<Value>,
    pub roots: Vec<usize>,
    /// By node of the scene its index in the file; that of an instance is not used.
    pub number: Vec<usize>,
}

/// The coarser levels of the parts, which nodes refer to by `MSFT_lod`.
pub(super) struct NodeLevels<'a> {
    /// By part: its coarser meshes as written, the finest first. Empty if it has one level.
    pub coarser: Vec<Vec<PartMesh>>,
    /// By node: for each level of its part the least fraction of the screen.
    pub coverages: &'a [Vec<f64>],
}

/// Lists the nodes of a scene in the same order, one for each; but instances are written as one instanced
/// node again, if that is possible. Before them come the nodes that rotate and scale the scene's frame, after
/// them the nodes that place a mesh about its origin if its own node cannot, and those that show coarser
/// levels.
pub(super) fn nodes(
    scene: &Scene,
    shown: &[PartMesh],
    levels: &NodeLevels<'_>,
) -> Result<NodeList, WriteError> {
    check_forest(scene)?;
    let mut frame = frame_nodes(scene.frame)?;
    // A frame without content would be an empty node.
    if scene.roots.is_empty() {
        frame.clear();
    }
    let first = frame.len();
    let is_animated = animated_nodes(scene);
    let may_show = |part: usize| {
        let has_one_level = levels.coarser.get(part).is_none_or(Vec::is_empty);
        has_one_level && shown.get(part).is_some_and(PartMesh::is_plain)
    };
    let instanced = InstancedNodes::of(scene, may_show, &is_animated);
    let number = instanced.numbers(first);
    // The numbers of the nodes in the document:
    //
    //      0 … first               the frame's nodes
    //      … first + n_written     one for each node of the scene, without places of instances
    //      …                       further links of chains, then coarser levels
    let n_written = instanced.is_place.iter().filter(|is_place| !**is_place).count();
    let mut extra = Vec::new();
    let mut hosts = Vec::new();
    let mut list = Vec::with_capacity(n_written);
    for (i, node) in scene.nodes.iter().enumerate().filter(|(i, _)| !instanced.is_place[*i]) {
        let place = node.part.or(instanced.part[i]).and_then(|p| shown.get(p));
        let coarser = node.part.and_then(|p| levels.coarser.get(p)).map_or(&[][..], |coarser| coarser);
        let is_moved = is_animated[i];
        let mut properties = (*node.properties).clone();
        if instanced.part[i].is_none() {
            remove_instances(&mut properties);
        }
        let children = node.children.iter().filter(|child| !instanced.is_place[**child]);
        let children: Vec<usize> = children.map(|child| number[*child]).collect();
        let described = DescribedNode { node, properties, children };
        let NodeChain { links, has_transform } = chain(described, place, coarser, is_moved)
            .ok_or_else(|| WriteError::Unsupported(format!("glTF cannot hold the transform of node {i}")))?;
        let next = first + n_written + extra.len();
        let mut links = links.into_iter().enumerate().map(|(k, link)| link.object(k + next));
        list.extend(links.next().map(|object| with_name(&node.name, object)));
        let n_before = extra.len();
        extra.extend(links);
        if !coarser.is_empty() {
            // The last node of the chain shows the mesh.
            let host = if extra.len() == n_before { number[i] - first } else { n_written + extra.len() - 1 };
            hosts.push(LevelHost { node: i, host, has_transform, coarser });
        }
    }
    list.extend(extra);
    for host in &hosts {
        let coverages = levels.coverages.get(host.node).map_or(&[][..], |coverages| coverages);
        host.add_levels(&scene.nodes[host.node].name, coverages, first, &mut list);
    }
    let mut roots = scene.roots.iter().map(|root| number[*root]).collect();
    // From the innermost node of the frame outward: each takes the roots so far and becomes the
    // only root.
    for (i, node) in frame.iter_mut().enumerate().rev() {
        node["children"] = json!(std::mem::replace(&mut roots, vec![i]));
    }
    Ok(NodeList { list: [frame, list].concat(), roots, number })
}

/// A node of the file whose mesh has coarser levels.
struct LevelHost<'a> {
    /// Its index in the scene.
    node: usize,
    /// The index in the list of the node that shows the mesh.
    host: usize,
    /// Whether that node also has the transform of the scene's node.
    has_transform: bool,
    coarser: &'a [PartMesh],
}

impl LevelHost<'_> {
    /// Appends a node for each coarser level, placed as the finest, and refers to them.
    fn add_levels(&self, name: &str, coverages: &[f64], first: usize, list: &mut Vec<Value>) {
        let mut level_node = list[self.host].as_object().cloned().unwrap_or_default();
        for key in ["name", "extras", "extensions", "children"] {
            level_node.shift_remove(key);
        }
        if !self.has_transform {
            level_node.shift_remove("translation");
            level_node.shift_remove("scale");
        }
        let mut ids = Vec::with_capacity(self.coarser.len());
        for (k, part) in self.coarser.iter().enumerate() {
            let mut properties = level_node.clone();
            part.positions.place(&mut properties);
            properties.insert("mesh".to_owned(), json!(part.mesh));
            if !part.has_skin {
                properties.shift_remove("skin");
            }
            ids.push(first + list.len());
            let name = if name.is_empty() { String::new() } else { format!("{name} level {}", k + 1) };
            list.push(with_name(&name, Value::Object(properties)));
        }
        list[self.host]["extensions"] = json!({ LOD: { "ids": ids } });
        list[self.host]["extras"]["MSFT_screencoverage"] = json!(coverages);
    }
}

/// The nodes that map the scene's frame to glTF's, outermost first.
fn frame_nodes(frame: Frame) -> Result<Vec<Value>, WriteError> {
    let mut nodes = Vec::new();
    if frame.up == Some(Axis::Z) {
        nodes.push(json!({ "name": "z up", "matrix": transform::Z_UP_TO_Y_UP }));
    }
    match frame.metres_per_unit {
        None | Some(1.0) => {}
        Some(unit) if unit.is_normal() && unit > 0.0 => {
            nodes.push(json!({ "name": "metres per unit", "scale": [unit, unit, unit] }));
        }
        Some(unit) => return Err(WriteError::Unsupported(format!("a unit of {unit} m is no length"))),
    }
    Ok(nodes)
}

/// One of the glTF nodes that represent a node of the scene.
struct NodeLink {
    properties: Map<String, Value>,
    /// Its children in the scene, by their indices in the file.
    children: Vec<usize>,
    /// Whether the next node of the chain is also a child.
    goes_on: bool,
}

impl NodeLink {
    fn object(mut self, next: usize) -> Value {
        let mut children = self.children;
        children.extend(self.goes_on.then_some(next));
        if !children.is_empty() {
            self.properties.insert("children".to_owned(), json!(children));
        }
        Value::Object(self.properties)
    }
}

/// The chain of glTF nodes for a node of the scene, outermost first.
struct NodeChain {
    links: Vec<NodeLink>,
    /// Whether the last one has the node's transform, and not only the origin of its mesh.
    has_transform: bool,
}

/// A node with its properties in the file.
struct DescribedNode<'a> {
    node: &'a Node,
    properties: Map<String, Value>,
    /// The indices of its children in the file.
    children: Vec<usize>,
}

/// The glTF nodes for a node; `None` if its transform has shear.
fn chain(
    described: DescribedNode<'_>,
    place: Option<&PartMesh>,
    coarser: &[PartMesh],
    is_moved: bool,
) -> Option<NodeChain> {
    let DescribedNode { node, mut properties, children } = described;
    let transform = match transform::own_properties(&mut properties, &node.matrix) {
        Some(transform) => vec![transform],
        None => transform::node_properties(&node.matrix)?,
    };
    let mut links: Vec<_> = transform
        .into_iter()
        .map(|properties| NodeLink { properties, children: Vec::new(), goes_on: false })
        .collect();
    let inner = links.last_mut()?;
    inner.children = children;
    inner.properties.extend(properties);
    let has_skin = place.is_some_and(|place| place.mesh.is_some() && place.has_skin);
    if !has_skin {
        inner.properties.shift_remove("skin");
    }
    if place.is_none_or(|place| place.mesh.is_none() || place.n_targets == 0) {
        inner.properties.shift_remove("weights");
    }
    let mut has_transform = !inner.properties.is_empty();
    if let Some(PartMesh { mesh: Some(mesh), positions, .. }) = place {
        // The transform of the stored positions must affect neither the node's children nor the order of its
        // own transform.
        let has_place =
            std::iter::once(positions).chain(coarser.iter().map(|p| &p.positions)).any(|p| !p.is_plain());
        let is_bare = inner.properties.is_empty() && node.children.is_empty() && !is_moved;
        if has_place && !is_bare || !coarser.is_empty() && !is_replaceable(node, is_moved) {
            let of_mesh = ["skin", "weights"];
            // They belong to the mesh, and glTF allows them only on the node that has it.
            let moved = of_mesh.map(|key| (key.to_owned(), inner.properties.shift_remove(key)));
            let moved = moved.into_iter().filter_map(|(key, value)| Some((key, value?)));
            let properties = Map::from_iter(moved);
            links.push(NodeLink { properties, children: Vec::new(), goes_on: false });
            has_transform = false;
        }
        let properties = &mut links.last_mut()?.properties;
        positions.place(properties);
        properties.insert("mesh".to_owned(), json!(mesh));
    }
    let n_links = links.len();
    links.iter_mut().take(n_links - 1).for_each(|link| link.goes_on = true);
    Some(NodeChain { links, has_transform })
}

/// The object with its name first, unless the name is empty.
pub(super) fn with_name(name: &str, object: Value) -> Value {
    let mut named = Map::new();
    if !name.is_empty() {
        named.insert("name".to_owned(), json!(name));
    }
    if let Value::Object(object) = object {
        named.extend(object);
    }
    Value::Object(named)
}
