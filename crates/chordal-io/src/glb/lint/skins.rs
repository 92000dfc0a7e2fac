//! Rules for skins.
use super::GltfLint;
use super::buffers::{AccessorConstraint, AccessorUse, BufferViewUse, UseTable};
use super::extensions::ExtensionHost;
use crate::glb::format::{AccessorFormat, AccessorType, ComponentType};
use crate::glb::json::JsonValue;
use crate::glb::model::{GltfModel, GltfNode, GltfSkin, item};
use std::collections::BTreeSet;

/// The forest of nodes, numbered so that ancestry takes one comparison.
struct NodeForest {
    parent: Vec<Option<usize>>,
    root: Vec<usize>,
    /// The numbers of a node's first and last descendant, itself included.
    span: Vec<(usize, usize)>,
    /// For each k the ancestor 2ᵏ levels up, or the root (binary lifting): long walks up take few steps,
    /// however deep the tree.
    up: Vec<Vec<usize>>,
}

impl NodeForest {
    /// Builds the forest; `None` if nodes form cycles.
    fn from_model(model: &GltfModel<'_>) -> Option<Self> {
        let n = model.nodes.len();
        let mut parent = vec![None; n];
        let children = |i: usize| model.nodes[i].iter().flat_map(|node| node.children.iter().flatten());
        for i in 0..n {
            for &child in children(i).filter(|child| **child < n) {
                parent[child] = Some(i);
            }
        }
        let mut forest = Self { root: (0..n).collect(), span: vec![(0, 0); n], parent, up: Vec::new() };
        let mut number = 0;
        // A node is entered at its first visit and left at its second.
        let mut open: Vec<(usize, bool)> =
            (0..n).filter(|i| forest.parent[*i].is_none()).map(|i| (i, false)).collect();
        while let Some((i, left)) = open.pop() {
            if left {
                forest.span[i].1 = number;
                continue;
            }
            number += 1;
            forest.span[i].0 = number;
            open.push((i, true));
            for &child in children(i).filter(|child| **child < n) {
                // If a node has two parents, the validator counts only the last.
                if forest.parent[child] == Some(i) && forest.span[child].0 == 0 {
                    forest.root[child] = forest.root[i];
                    open.push((child, false));
                }
            }
        }
        // Nodes on a cycle are below no root, so the walk did not reach them.
        if number < n {
            return None;
        }
        let mut step: Vec<usize> = (0..n).map(|i| forest.parent[i].unwrap_or(i)).collect();
        // `step` leads 2ᵏ nodes up, a root to itself; no node is deeper than `n`, so more tables
        // are not needed.
        while n >> forest.up.len() > 0 {
            let twice = step.iter().map(|above| step[*above]).collect();
            forest.up.push(std::mem::replace(&mut step, twice));
        }
        Some(forest)
    }

    fn is_ancestor(&self, above: usize, below: usize) -> bool {
        let (first, last) = self.span[above];
        (first..=last).contains(&self.span[below].0)
    }

    /// The lowest common ancestor of two nodes; it may be one of them.
    fn lowest_common_ancestor(&self, a: usize, b: usize) -> Option<usize> {
        if self.root[a] != self.root[b] {
            return None;
        }
        if self.is_ancestor(a, b) {
            return Some(a);
        }
        // The highest ancestor that is not common is a child of the lowest common one.
        let mut below = a;
        // Jumps halve each time, so the longest goes first and each is taken at most once.
        for step in self.up.iter().rev() {
            if !self.is_ancestor(step[below], b) {
                below = step[below];
            }
        }
        self.parent[below]
    }
}

impl<'a> GltfLint<'a> {
    pub(super) fn skin(&mut self, map: &'a JsonValue) -> GltfSkin {
        let matrices = self.index(map, "inverseBindMatrices", false);
        let skeleton = self.index(map, "skeleton", false);
        let joints = self.indices(map, "joints", true);
        self.name(map);
        self.extensions(map, ExtensionHost::Other);
        GltfSkin { matrices, skeleton, joints }
    }

    pub(super) fn link_skins(&mut self, model: &GltfModel<'a>, uses: &mut UseTable) {
        if model.skins.is_empty() {
            return;
        }
        let forest = NodeForest::from_model(model);
        let mut common = vec![None; model.skins.len()];
        for (i, skin) in model.skins.iter().enumerate() {
            let Some(skin) = skin else { continue };
            self.within_path(&["skins".into(), i.into()], |lint| {
                lint.link_matrices(model, skin, uses);
                common[i] = lint.link_joints(skin, forest.as_ref());
            });
        }
        if let Some(forest) = &forest {
            self.scenes_of_skins(model, forest, &common);
        }
    }

    /// Returns the common root of the joints.
    fn link_joints(&mut self, skin: &GltfSkin, forest: Option<&NodeForest>) -> Option<usize> {
        let mut common = None;
        let mut n_found = 0;
        for (k, joint) in skin.joints.iter().flatten().enumerate() {
            let Some(joint) = *joint else { continue };
            let exists = self.within("joints", |lint| lint.resolved("nodes", joint, k.into()));
            let (Some(forest), true) = (forest, exists) else { continue };
            n_found += 1;
            // A joint of another tree resets the common root, and the next joint starts again. The validator
            // works this way, so the last joints decide.
            common = match common {
                None => Some(joint),
                Some(above) => forest.lowest_common_ancestor(above, joint),
            };
        }
        if n_found > 0 && common.is_none() {
            self.issue_below("SKIN_NO_COMMON_ROOT", "joints", "the joints have no common root");
        }
        if let Some(skeleton) = skin.skeleton
            && self.resolved("nodes", skeleton, "skeleton".into())
            && let (Some(forest), Some(common)) = (forest, common)
            && !forest.is_ancestor(skeleton, common)
        {
            self.issue_below(
                "SKIN_SKELETON_INVALID",
                "skeleton",
                "the skeleton is no common root of the joints",
            );
        }
        common
    }

    fn link_matrices(&mut self, model: &GltfModel<'a>, skin: &GltfSkin, uses: &mut UseTable) {
        let Some(index) = skin.matrices else { return };
        if !self.resolved("accessors", index, "inverseBindMatrices".into()) {
            return;
        }
        let Some(accessor) = item(&model.accessors, Some(index)) else { return };
        self.use_accessor(uses, index, AccessorUse::InverseBindMatrices, "inverseBindMatrices");
        self.use_view(uses, accessor.view, BufferViewUse::InverseBindMatrices, "inverseBindMatrices");
        self.within("inverseBindMatrices", |lint| {
            if item(&model.views, accessor.view).is_some_and(|view| view.stride.is_some()) {
                lint.issue_here("SKIN_IBM_ACCESSOR_WITH_BYTESTRIDE", "bind matrices have no byteStride");
            }
            if accessor.format() == Some(AccessorFormat::plain(AccessorType::Mat4, ComponentType::F32)) {
                uses.constrain(index, AccessorConstraint::BindMatrices, lint.pointer(None));
            } else {
                lint.issue_here("SKIN_IBM_INVALID_FORMAT", "bind matrices are 4 x 4 floats");
            }
            let n_joints = skin.joints.as_ref().map_or(0, Vec::len) as u64;
            if let Some(count) = accessor.count.filter(|count| *count < n_joints) {
                let what = format!("{count} bind matrices for {n_joints} joints");
                lint.issue("INVALID_IBM_ACCESSOR_COUNT", None, || what);
            }
        });
    }

    /// Checks that the joints of a node's skin are in each scene that shows the node.
    fn scenes_of_skins(&mut self, model: &GltfModel<'a>, forest: &NodeForest, common: &[Option<usize>]) {
        let mut shown = vec![BTreeSet::new(); model.nodes.len()];
        for (s, scene) in model.scenes.iter().enumerate() {
            for node in scene.iter().flat_map(|scene| scene.nodes.iter().flatten()).flatten() {
                if let Some(scenes) = shown.get_mut(*node) {
                    scenes.insert(s);
                }
            }
        }
        // Caches compared pairs of roots, so that many nodes cost no more than one.
        let mut cache = std::collections::BTreeMap::new();
        for (i, node) in model.nodes.iter().enumerate() {
            let skin = node.as_ref().and_then(GltfNode::skin);
            let Some(joint) = skin.and_then(|s| common.get(s).copied().flatten()) else { continue };
            let (node_root, joints) = (forest.root[i], forest.root[joint]);
            if !*cache
                .entry((node_root, joints))
                .or_insert_with(|| shown[node_root].is_subset(&shown[joints]))
            {
                let what = "a scene shows the node and not its joints";
                self.within("nodes", |lint| lint.issue_below("NODE_SKIN_NO_SCENE", i, what));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_ancestors_are_those_that_walking_up_finds() {
        // Two trees; the parents form long and bushy branches.
        let n = 300;
        let parent = |i: usize| match i {
            0 | 150 => None,
            _ if i.is_multiple_of(3) => Some(if i > 150 { 150 + (i - 150) / 2 } else { i / 2 }),
            _ => Some(i - 1),
        };
        let children = |above: usize| (0..n).filter(|i| parent(*i) == Some(above)).map(Some).collect();
        let nodes: Vec<GltfNode<'_>> =
            (0..n).map(|i| GltfNode { children: children(i), ..GltfNode::default() }).collect();
        let model = GltfModel { nodes: nodes.into_iter().map(Some).collect(), ..GltfModel::default() };
        let forest = NodeForest::from_model(&model).expect("no loops");
        let chain = |i: usize| std::iter::successors(Some(i), |i| parent(*i)).collect::<Vec<_>>();
        for a in 0..n {
            let above = chain(a);
            for b in (0..n).step_by(7) {
                let expected = chain(b).into_iter().find(|i| above.contains(i));
                assert_eq!(forest.lowest_common_ancestor(a, b), expected, "{a} and {b}");
            }
        }
    }
}
