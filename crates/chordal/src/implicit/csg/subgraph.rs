//! The terms of a part of a graph, without the marks of materials.
use crate::implicit::Term;
use crate::implicit::graph::parts;
use crate::implicit::material::{MaterialMark, SurfaceMaterial};
use std::collections::HashMap;

/// The material of a term that is a mark, and the marked term.
pub(super) fn mark_of(terms: &[Term], term: u32) -> Option<(&SurfaceMaterial, u32)> {
    let Term::Leaf(leaf, [below, ..]) = &terms[term as usize] else { return None };
    MaterialMark::from_leaf(leaf).map(|mark| (&mark.0, *below))
}

/// The term below all marks.
pub(super) fn unmarked(terms: &[Term], mut term: u32) -> u32 {
    while let Some((_, below)) = mark_of(terms, term) {
        term = below;
    }
    term
}

/// The terms that `root` depends on, with `root` last, without marks.
pub(super) fn subgraph_terms(terms: &[Term], root: u32) -> Vec<Term> {
    let root = unmarked(terms, root);
    let mut number: HashMap<u32, u32> = HashMap::new(); // No order depends on it.
    let mut needed = vec![root];
    let mut open = vec![root];
    number.insert(root, 0);
    while let Some(term) = open.pop() {
        for part in parts(&terms[term as usize]).map(|part| unmarked(terms, part)) {
            if number.insert(part, 0).is_none() {
                needed.push(part);
                open.push(part);
            }
        }
    }
    // In the order of the whole list, in which operands come first.
    needed.sort_unstable();
    needed.iter().enumerate().for_each(|(new, old)| {
        number.insert(*old, new as u32);
    });
    let new = |old: &u32| number[&unmarked(terms, *old)];
    let copy = |old: &u32| match &terms[*old as usize] {
        Term::Const(value) => Term::Const(*value),
        Term::Axis(axis) => Term::Axis(*axis),
        Term::Unary(op, a) => Term::Unary(*op, new(a)),
        Term::Binary(op, a, b) => Term::Binary(*op, new(a), new(b)),
        Term::Leaf(leaf, at) => Term::Leaf(leaf.clone(), at.each_ref().map(new)),
    };
    needed.iter().map(copy).collect()
}
