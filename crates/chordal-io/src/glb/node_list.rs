//! `NodeList`: the nodes of a GLB, which place its meshes.
use super::transform;
use crate::forest::check_forest;
use crate::{Axis, Frame, Node, Scene, WriteError};
use serde_json::{Map, Value, json};

/// What was written for a part.
pub(super) struct PartMesh {
    /// Its mesh, unless it is empty.
    pub mesh: Option<usize>,
    /// The point about which its positions are stored.
    pub origin: [f64; 3],
    /// Whether its vertices follow joints.
    pub has_skin: bool,
    /// Its morph targets.
    pub n_targets: usize,
}

/// The nodes of a file, and those of them without a parent.
pub(super) struct NodeList {
    pub list: Vec<Value>,
    pub roots: Vec<usize>,
    /// The number of the scene's first node in the file.
    pub first: usize,
}

/// Lists the nodes of a scene, one for each in the same order. Before them come the nodes that rotate and
/// scale the scene's frame, after them those that place a mesh about its origin where its node cannot. In the
/// file they follow `n_before` other nodes.
pub(super) fn nodes(scene: &Scene, shown: &[PartMesh], n_before: usize) -> Result<NodeList, WriteError> {
    check_forest(scene)?;
    let mut frame = frame_nodes(scene.frame)?;
    // A frame without content would be an empty node.
    if scene.roots.is_empty() {
        frame.clear();
    }
    let first = n_before + frame.len();
    let mut extra = Vec::new();
    let mut list = Vec::with_capacity(scene.nodes.len());
    for (i, node) in scene.nodes.iter().enumerate() {
        let place = node.part.and_then(|p| shown.get(p));
        let links = chain(node, place)
            .ok_or_else(|| WriteError::Unsupported(format!("glTF cannot hold the transform of node {i}")))?;
        let next = first + scene.nodes.len() + extra.len();
        let mut links = links.into_iter().enumerate().map(|(k, link)| link.object(k + next, first));
        list.extend(links.next().map(|object| with_name(&node.name, object)));
        extra.extend(links);
    }
    let mut roots = scene.roots.iter().map(|r| first + r).collect();
    for (i, node) in frame.iter_mut().enumerate().rev() {
        node["children"] = json!(std::mem::replace(&mut roots, vec![n_before + i]));
    }
    Ok(NodeList { list: [frame, list, extra].concat(), roots, first })
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

/// One of the glTF nodes that a node of the scene becomes.
struct NodeLink<'a> {
    properties: Map<String, Value>,
    /// The children that the scene gives it.
    children: &'a [usize],
    /// Whether the next link is a child too.
    goes_on: bool,
}

impl NodeLink<'_> {
    fn object(mut self, next: usize, first: usize) -> Value {
        let mut children: Vec<usize> = self.children.iter().map(|c| first + c).collect();
        children.extend(self.goes_on.then_some(next));
        if !children.is_empty() {
            self.properties.insert("children".to_owned(), json!(children));
        }
        Value::Object(self.properties)
    }
}

/// The glTF nodes for a node, outermost first; `None` when its transform has shear.
fn chain<'a>(node: &'a Node, place: Option<&PartMesh>) -> Option<Vec<NodeLink<'a>>> {
    let mut properties = node.properties.clone();
    let transform = match transform::own_properties(&mut properties, &node.matrix) {
        Some(transform) => vec![transform],
        None => transform::node_properties(&node.matrix)?,
    };
    let mut links: Vec<_> = transform
        .into_iter()
        .map(|properties| NodeLink { properties, children: &[], goes_on: false })
        .collect();
    let inner = links.last_mut()?;
    inner.children = &node.children;
    inner.properties.extend(properties);
    let has_skin = place.is_some_and(|place| place.mesh.is_some() && place.has_skin);
    if !has_skin {
        inner.properties.shift_remove("skin");
    }
    if place.is_none_or(|place| place.mesh.is_none() || place.n_targets == 0) {
        inner.properties.shift_remove("weights");
    }
    if let Some(PartMesh { mesh: Some(mesh), origin, .. }) = place {
        // An origin must not move the node's children, nor be applied before the node's own transform.
        let own = *origin != [0.0; 3] && !(inner.properties.is_empty() && node.children.is_empty());
        if own {
            links.push(NodeLink { properties: Map::new(), children: &[], goes_on: false });
        }
        let properties = &mut links.last_mut()?.properties;
        if *origin != [0.0; 3] {
            properties.insert("translation".to_owned(), json!(origin));
        }
        properties.insert("mesh".to_owned(), json!(mesh));
    }
    let n_links = links.len();
    links.iter_mut().take(n_links - 1).for_each(|link| link.goes_on = true);
    Some(links)
}

/// The object with its name first, unless the name is empty.
pub(super) fn with_name(name: &str, object: Value) -> Value {
    let mut all = Map::new();
    if !name.is_empty() {
        all.insert("name".to_owned(), json!(name));
    }
    if let Value::Object(object) = object {
        all.extend(object);
    }
    Value::Object(all)
}
