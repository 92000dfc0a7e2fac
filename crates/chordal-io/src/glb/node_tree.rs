//! `NodeTree`: the nodes of the scene that is shown, without coarser levels of detail and with all instances.
use super::json::JsonValue;
use super::lod_nodes::LodNodes;
use super::model::{GltfModel, GltfNodeMore, item};
use super::report::GlbWarnings;
use super::{LOD, instances, trs};
use crate::{FileLocation, Limits, Node, RareValue, ReadError, Scene};
use std::collections::BTreeSet;

/// The kept nodes of a file, and their meshes.
pub(super) struct NodeTree {
    /// The nodes, without their properties; a node's part is an index into `meshes`.
    pub scene: Scene,
    /// The meshes of the file that become parts: all except those that only coarser levels show.
    pub meshes: Vec<usize>,
    /// By node of the file: its index among the kept nodes.
    pub number_of: Vec<Option<usize>>,
    /// Whether nodes were cut from their parents, so that joints may have no common root.
    pub has_cut_nodes: bool,
    /// The most coarser levels of detail of any node.
    pub n_lower: usize,
    /// The number of bytes that may still be used.
    pub left: u64,
    pub report: GlbWarnings,
}

impl NodeTree {
    /// Reads the nodes. The roots are those of the default scene, else of the first scene, else all nodes
    /// without parents. Nodes and their instances may take `left` bytes.
    ///
    /// # Errors
    /// If levels of detail form a cycle, instances cannot be placed, or a limit is exceeded.
    pub fn new(
        json: &JsonValue,
        model: &GltfModel<'_>,
        limits: &Limits,
        left: u64,
    ) -> Result<Self, ReadError> {
        let lower = LodNodes::new(json, model)?;
        let mut report = GlbWarnings::default();
        let n = model.nodes.len();
        let mut nodes: Vec<Node> = model.nodes.iter().map(|_| Node::default()).collect();
        let mut has_parent = vec![false; n];
        for (i, node) in model.nodes.iter().enumerate() {
            let Some(node) = node else { continue };
            let mut children: Vec<usize> =
                node.children.iter().flatten().copied().filter(|child| *child < n).collect();
            children.shrink_to_fit();
            children.iter().for_each(|child| has_parent[*child] = true);
            nodes[i] = Node {
                name: node.name.to_owned(),
                matrix: node.more.as_deref().map(matrix_of).unwrap_or_default(),
                children,
                part: node.mesh.filter(|mesh| *mesh < model.meshes.len()),
                ..Node::default()
            };
        }
        // A mesh that a chosen level replaces is no longer shown.
        let mut replaced = vec![false; model.meshes.len()];
        for (node, level) in lower.at_level(limits.level) {
            let Some(replacement) = item(&model.nodes, Some(level)) else { continue };
            nodes[node].part.iter().for_each(|mesh| replaced[*mesh] = true);
            nodes[node].matrix = replacement.more.as_deref().map(matrix_of).unwrap_or_default();
            nodes[node].part = replacement.mesh.filter(|mesh| *mesh < model.meshes.len());
        }
        let shown = model.scene.or(if model.scenes.is_empty() { None } else { Some(0) });
        let mut roots = match item(&model.scenes, shown) {
            Some(scene) => scene.nodes.iter().flatten().flatten().copied().filter(|node| *node < n).collect(),
            None => (0..n).filter(|i| !has_parent[*i] && !lower.is_named(*i)).collect::<Vec<_>>(),
        };
        let has_cut_nodes = detach_shown_children(&mut nodes, &mut roots);
        if let Some(first) = lower.first {
            let place = FileLocation::Pointer(format!("/nodes/{first}/extensions/{LOD}"));
            let what = "lower levels of detail were left out: the first one was read";
            report.add_many("lower-levels-skipped", lower.n_levels, place, what);
        }
        let mut scene = Scene { nodes, roots, ..Scene::default() };
        let (meshes, number_of) = keep_first_levels(&mut scene, model, (&lower, replaced));
        let left = instances::place(&mut scene, model, &number_of, (limits, left), &mut report)?;
        count_unseen(&scene, &meshes, &mut report);
        let n_lower = lower.most();
        Ok(Self { scene, meshes, number_of, has_cut_nodes, n_lower, left, report })
    }
}

fn matrix_of(more: &GltfNodeMore<'_>) -> RareValue<[f64; 16]> {
    let rotation = more.rotation.as_deref().copied().unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let translation = more.translation.as_deref().copied().unwrap_or_default();
    let trs = || trs::compose(translation, rotation, more.scale.as_deref().copied().unwrap_or([1.0; 3]));
    more.matrix.as_deref().copied().unwrap_or_else(trs).into()
}

/// Removes the nodes that are coarser levels of detail. Returns the meshes that become parts (all except
/// those that only such nodes show), and the new index of every kept node.
fn keep_first_levels(
    scene: &mut Scene,
    model: &GltfModel<'_>,
    (lower, replaced): (&LodNodes, Vec<bool>),
) -> (Vec<usize>, Vec<Option<usize>>) {
    let n_meshes = model.meshes.len();
    if lower.first.is_none() {
        return ((0..n_meshes).collect(), (0..scene.nodes.len()).map(Some).collect());
    }
    let hidden = lower.hidden_nodes(model, &scene.roots);
    // A mesh becomes no part only if a coarser level has it and no shown node; one that no node has
    // at all is kept.
    let (mut is_lower, mut is_seen) = (replaced, vec![false; n_meshes]);
    for (node, hidden) in scene.nodes.iter().zip(&hidden) {
        if let Some(mesh) = node.part {
            let list = if *hidden { &mut is_lower } else { &mut is_seen };
            list[mesh] = true;
        }
    }
    let kept: Vec<usize> = (0..n_meshes).filter(|mesh| is_seen[*mesh] || !is_lower[*mesh]).collect();
    let mut part_of = vec![None; n_meshes];
    kept.iter().enumerate().for_each(|(part, mesh)| part_of[*mesh] = Some(part));
    let mut number = vec![None; scene.nodes.len()];
    let shown = (0..hidden.len()).filter(|node| !hidden[*node]);
    shown.enumerate().for_each(|(new, old)| number[old] = Some(new));
    let renumber = |list: &[usize]| list.iter().filter_map(|node| number[*node]).collect();
    scene.roots = renumber(&scene.roots);
    let nodes = std::mem::take(&mut scene.nodes).into_iter().zip(&hidden).filter(|(_, hidden)| !**hidden);
    scene.nodes = nodes
        .map(|(node, _)| Node {
            children: renumber(&node.children),
            part: node.part.and_then(|mesh| part_of[mesh]),
            ..node
        })
        .collect();
    (kept, number)
}

/// Counts meshes that no node of the scene shows; `meshes` has the mesh of each part.
fn count_unseen(scene: &Scene, meshes: &[usize], report: &mut GlbWarnings) {
    let mut is_shown = vec![false; meshes.len()];
    let mut open = scene.roots.clone();
    while let Some(i) = open.pop() {
        if let Some(part) = scene.nodes[i].part {
            is_shown[part] = true;
        }
        open.extend(&scene.nodes[i].children);
    }
    for (mesh, _) in meshes.iter().zip(&is_shown).filter(|(_, shown)| !**shown) {
        let place = FileLocation::Pointer(format!("/meshes/{mesh}"));
        report.add("meshes-not-shown", place, "the scene does not show all meshes");
    }
}

/// Turns nodes into a forest if a scene lists some that are not roots. Such a node stays if its ancestors are
/// shown, else it is cut from them. Returns whether any was cut.
pub(super) fn detach_shown_children(nodes: &mut [Node], roots: &mut Vec<usize>) -> bool {
    let mut parent = vec![None; nodes.len()];
    for (i, node) in nodes.iter().enumerate() {
        node.children.iter().for_each(|child| parent[*child] = Some(i));
    }
    if roots.iter().all(|root| parent[*root].is_none()) {
        return false;
    }
    let mut is_root = vec![false; nodes.len()];
    roots.iter().for_each(|root| is_root[*root] = true);
    // Whether an ancestor is shown, from the top down.
    let mut is_covered = vec![false; nodes.len()];
    let mut open: Vec<usize> = (0..nodes.len()).filter(|node| parent[*node].is_none()).collect();
    while let Some(node) = open.pop() {
        for child in &nodes[node].children {
            is_covered[*child] = is_covered[node] || is_root[node];
            open.push(*child);
        }
    }
    roots.retain(|root| !is_covered[*root]);
    let is_cut = |node: usize| is_root[node] && !is_covered[node];
    let parents = roots.iter().filter_map(|root| parent[*root]).collect::<BTreeSet<_>>();
    parents.iter().for_each(|parent| nodes[*parent].children.retain(|child| !is_cut(*child)));
    !parents.is_empty()
}
