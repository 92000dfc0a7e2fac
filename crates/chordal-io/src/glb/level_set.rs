//! `GlbLevels`: the parts of a scene in several levels of detail.
use super::level_hosts::takes_levels;
use crate::{Part, Scene, WriteError};
use serde_json::Value;

/// A scene whose parts have coarser levels of detail.
#[derive(Clone, Copy, Debug)]
pub struct GlbLevels<'a> {
    /// The scene with the finest level of each part.
    pub scene: &'a Scene,
    /// By part: its coarser levels, the finest first. Empty for a part with one level; the whole list is
    /// empty if all parts have one. Parts for which [`takes_levels`](super::takes_levels) is false must have
    /// one.
    pub coarser: &'a [Vec<Part>],
    /// By node: for each level of its part the least fraction of the screen, 0 to 1, that the part covers
    /// while this level is shown. Below it the next level is shown, and nothing after the last. Empty for
    /// nodes whose part has one level.
    pub coverages: &'a [Vec<f64>],
    /// The certificate of the file.
    pub certificate: Option<&'a Value>,
}

impl<'a> GlbLevels<'a> {
    /// A scene with one level.
    #[must_use]
    pub fn one(scene: &'a Scene) -> Self {
        Self { scene, coarser: &[], coverages: &[], certificate: None }
    }

    /// Refuses levels that cannot be written.
    pub(super) fn check(&self) -> Result<(), WriteError> {
        let refused = |what: String| Err(WriteError::Unsupported(what));
        let GlbLevels { scene, coarser, coverages, .. } = self;
        let takes = takes_levels(scene);
        for (part, levels) in coarser.iter().enumerate() {
            if !levels.is_empty() && !takes.get(part).is_some_and(|takes| *takes) {
                return refused(format!("part {part} cannot have levels: skins or morph targets move it"));
            }
            if let Some(k) = levels.iter().position(|level| level.mesh.faces().is_empty()) {
                return refused(format!("level {} of part {part} has no triangle", k + 1));
            }
        }
        for (i, node) in scene.nodes.iter().enumerate() {
            let n_coarser = node.part.and_then(|part| coarser.get(part)).map_or(0, Vec::len);
            let node_coverages = coverages.get(i).map_or(&[][..], |node_coverages| node_coverages);
            if n_coarser > 0 && node_coverages.len() != n_coarser + 1 {
                return refused(format!(
                    "node {i} has {} screen coverages for {} levels",
                    node_coverages.len(),
                    n_coarser + 1
                ));
            }
            if let Some(k) = node_coverages.iter().position(|coverage| !(0.0..=1.0).contains(coverage)) {
                return refused(format!(
                    "level {k} of node {i} is shown from {} of the screen on, not 0 to 1",
                    node_coverages[k]
                ));
            }
            // A level that does not end before the next one begins would never be shown.
            if let Some(k) = node_coverages.windows(2).position(|pair| pair[1] >= pair[0]) {
                return refused(format!(
                    "level {} of node {i} is not shown on less of the screen than level {k}",
                    k + 1
                ));
            }
        }
        Ok(())
    }
}
