//! `LodNodes`: the nodes that `MSFT_lod` declares as coarser levels of detail, which are not part of the
//! scene.
use super::LOD;
use super::json::JsonValue;
use super::model::{GltfModel, item};
use crate::{FileLocation, ReadError};
use std::collections::BTreeMap;

/// The coarser levels of detail that each node refers to.
#[derive(Default)]
pub(super) struct LodNodes {
    /// The coarser levels of a node, for nodes that have some.
    ids: BTreeMap<usize, Vec<usize>>,
    /// Whether a node is a coarser level of some node.
    is_named: Vec<bool>,
    /// The number of pairs of a node and a coarser level.
    pub n_levels: u64,
    /// The first node that has coarser levels.
    pub first: Option<usize>,
}

impl LodNodes {
    /// Reads the levels of all nodes.
    ///
    /// # Errors
    /// At the pointer, if a referenced node does not exist, or a node is among its own descendants through
    /// levels, children or both.
    pub fn new(json: &JsonValue, model: &GltfModel<'_>) -> Result<Self, ReadError> {
        let mut lower = Self { is_named: vec![false; model.nodes.len()], ..Self::default() };
        let nodes = json.get("nodes").and_then(JsonValue::items).unwrap_or_default();
        for (i, node) in nodes.iter().enumerate() {
            let Some(lod) = node.get("extensions").and_then(|extensions| extensions.get(LOD)) else {
                continue;
            };
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

    /// The children of a node, then its coarser levels.
    fn next<'a>(&'a self, model: &'a GltfModel<'_>, node: usize) -> impl Iterator<Item = usize> + 'a {
        let n = self.is_named.len();
        let children = item(&model.nodes, Some(node)).map_or(&[][..], |node| &node.children);
        let children = children.iter().flatten().copied().filter(move |child| *child < n);
        children.chain(self.ids.get(&node).into_iter().flatten().copied())
    }

    /// A node with levels that is on a cycle of levels and children, or reachable from one.
    fn cycle(&self, model: &GltfModel<'_>) -> Option<usize> {
        self.first?;
        // Repeatedly removes nodes without predecessors. The nodes that remain are on cycles or reachable
        // from them.
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
        // Cycles of children alone were already refused.
        let left = |node: &usize| n_before[*node] > 0;
        (0..self.is_named.len()).filter(left).find(|node| self.ids.contains_key(node))
    }

    /// The most coarser levels of any node.
    pub fn most(&self) -> usize {
        self.ids.values().map(Vec::len).max().unwrap_or(0)
    }

    /// For each node with coarser levels: the node that replaces it at a level, counted from 0, the finest.
    pub fn at_level(&self, level: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let lower =
            move |ids: &Vec<usize>| level.min(ids.len()).checked_sub(1).and_then(|k| ids.get(k).copied());
        self.ids.iter().filter_map(move |(node, ids)| Some((*node, lower(ids)?)))
    }

    /// Whether a node is a coarser level of another one.
    pub fn is_named(&self, node: usize) -> bool {
        self.is_named[node]
    }

    /// For each node whether it is only a coarser level, and therefore left out of a scene with these roots.
    pub fn hidden_nodes(&self, model: &GltfModel<'_>, roots: &[usize]) -> Vec<bool> {
        let n = self.is_named.len();
        let mut hidden = vec![false; n];
        let mut open: Vec<usize> = self.ids.values().flatten().copied().collect();
        while let Some(node) = open.pop() {
            if !std::mem::replace(&mut hidden[node], true) {
                open.extend(self.next(model, node));
            }
        }
        // A level may itself be part of the scene, or below a node that is; then it is shown as
        // well.
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
