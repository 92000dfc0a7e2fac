//! `check_forest`: whether the nodes of a scene can be written.
use crate::{Scene, WriteError};

/// Checks that indices are in range, that each node has at most one parent, and that roots have none.
pub(crate) fn check_forest(scene: &Scene) -> Result<(), WriteError> {
    let broken = |what: String| Err(WriteError::Unsupported(format!("the scene is no forest: {what}")));
    let n = scene.nodes.len();
    let mut has_parent = vec![false; n];
    for (i, node) in scene.nodes.iter().enumerate() {
        if node.part.is_some_and(|p| p >= scene.parts.len()) {
            return broken(format!("node {i} shows a part that is not there"));
        }
        for &child in &node.children {
            match has_parent.get_mut(child) {
                Some(seen) if !*seen => *seen = true,
                _ => return broken(format!("child {child} of node {i} is not there or has another parent")),
            }
        }
    }
    let mut is_root = vec![false; n];
    for &root in &scene.roots {
        if root >= n || has_parent[root] || std::mem::replace(&mut is_root[root], true) {
            return broken(format!("root {root} is not there, is listed twice or has a parent"));
        }
    }
    // Each node has at most one parent, so a node that no parentless node reaches lies on a cycle.
    let mut open: Vec<usize> = (0..n).filter(|i| !has_parent[*i]).collect();
    let mut n_reached = 0;
    while let Some(i) = open.pop() {
        n_reached += 1;
        open.extend(&scene.nodes[i].children);
    }
    if n_reached < n { broken("nodes are their own ancestors".to_owned()) } else { Ok(()) }
}
