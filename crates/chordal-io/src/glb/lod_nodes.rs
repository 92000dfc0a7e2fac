//! `LodNodes`: the nodes that `MSFT_lod` makes lower levels of detail, which are not part of the scene.
use super::LOD;
use super::json::JsonValue;
use super::model::{GltfModel, item};
use crate::{FileLocation, ReadError};
use std::collections::BTreeMap;

/// The lower levels of detail that each node names.
#[derive(Default)]
pub(super) struct LodNodes {
    /// The lower levels that a node names, for those that name some.
    ids: BTreeMap<usize, Vec<usize>>,
    /// Whether a node is a lower level of some node.
    is_named: Vec<bool>,
    /// Pairs of a node and one lower level.
    pub n_levels: u64,
    /// The first node that names some.
    pub first: Option<usize>,
}

impl LodNodes {
    /// Reads the levels of all nodes.
    ///
    /// # Errors
    /// At the pointer, where there is no such node, or a level leads back to itself: by its levels, its
    /// children or both.
    pub fn new(json: &JsonValue, model: &GltfModel<'_>) -> Result<Self, ReadError> {
        let mut lower = Self { is_named: vec![false; model.nodes.len()], ..Self::default() };
        let nodes = json.get("nodes").and_then(JsonValue::items).unwrap_or_default();
        for (i, node) in nodes.iter().enumerate() {
            let Some(lod) = node.get("extensions").and_then(|all| all.get(LOD)) else { continue };
            let pointer = format!("/nodes/{i}/extensions/{LOD}/ids");
            let wrong = |code, pointer, what| ReadError::new(code, FileLocation::Pointer(pointer), what);
            let Some(ids) = lod.get("ids").and_then(JsonValue::items).filter(|ids| !ids.is_empty()) else {
                let what = "MSFT_lod has no list of lower levels".to_owned();
                return Err(wrong("UNDEFINED_PROPERTY", pointer, what));
            };
            for (k, id) in ids.iter().enumerate() {
                let index = id.integer().and_then(|id| usize::try_from(id).ok());
                let Some(index) = index.filter(|index| item(&model.nodes, Some(*index)).is_some()) else {
                    let what = format!("level {} is no node of the file", k + 1);
                    return Err(wrong("UNRESOLVED_REFERENCE", format!("{pointer}/{k}"), what));
                };
                lower.ids.entry(i).or_default().push(index);
                lower.is_named[index] = true;
                lower.n_levels += 1;
            }
            lower.first = lower.first.or(Some(i));
        }
        match lower.cycle(model) {
            Some(node) => {
                let place = FileLocation::Pointer(format!("/nodes/{node}/extensions/{LOD}/ids"));
                Err(ReadError::new("lod-cycle", place, "levels of detail go in a circle from here"))
            }
            None => Ok(lower),
        }
    }

    /// The children of a node, then its lower levels.
    fn next<'a>(&'a self, model: &'a GltfModel<'_>, node: usize) -> impl Iterator<Item = usize> + 'a {
        let n = self.is_named.len();
        let children = item(&model.nodes, Some(node)).map_or(&[][..], |node| &node.children);
        let children = children.iter().flatten().copied().filter(move |child| *child < n);
        children.chain(self.ids.get(&node).into_iter().flatten().copied())
    }

    /// A node with levels on a cycle of levels and children, or behind one.
    fn cycle(&self, model: &GltfModel<'_>) -> Option<usize> {
        self.first?;
        // Removes nodes without predecessors until none is left, or all that are left are on cycles or behind
        // them.
        let mut n_before = vec![0_usize; self.is_named.len()];
        for node in 0..self.is_named.len() {
            self.next(model, node).for_each(|next| n_before[next] += 1);
        }
        let mut open: Vec<usize> = (0..self.is_named.len()).filter(|node| n_before[*node] == 0).collect();
        while let Some(node) = open.pop() {
            for next in self.next(model, node) {
                n_before[next] -= 1;
                if n_before[next] == 0 {
                    open.push(next);
                }
            }
        }
        // Children alone form no cycle, as was checked before.
        let left = |node: &usize| n_before[*node] > 0;
        (0..self.is_named.len()).filter(left).find(|node| self.ids.contains_key(node))
    }

    /// The most lower levels that a node names.
    pub fn most(&self) -> usize {
        self.ids.values().map(Vec::len).max().unwrap_or(0)
    }

    /// By node with lower levels: the one that stands for it in a level, counted from 0, the finest.
    pub fn at_level(&self, level: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let lower =
            move |ids: &Vec<usize>| level.min(ids.len()).checked_sub(1).and_then(|k| ids.get(k).copied());
        self.ids.iter().filter_map(move |(node, ids)| Some((*node, lower(ids)?)))
    }

    /// Whether a node is a lower level of another one.
    pub fn is_named(&self, node: usize) -> bool {
        self.is_named[node]
    }

    /// For each node whether it is only a lower level, and so left out of a scene with these roots.
    pub fn hidden_nodes(&self, model: &GltfModel<'_>, roots: &[usize]) -> Vec<bool> {
        let n = self.is_named.len();
        let mut hidden = vec![false; n];
        let mut open: Vec<usize> = self.ids.values().flatten().copied().collect();
        while let Some(node) = open.pop() {
            if !std::mem::replace(&mut hidden[node], true) {
                open.extend(self.next(model, node));
            }
        }
        let mut open = roots.to_vec();
        while let Some(node) = open.pop() {
            // Each node has one parent, so each is visited once.
            hidden[node] = false;
            let children = item(&model.nodes, Some(node)).map_or(&[][..], |node| &node.children);
            open.extend(children.iter().flatten().copied().filter(|child| *child < n));
        }
        hidden
    }
}
