//! The distance from a mesh of those parts of faces that have no triangle in it: triangles that sewing made flat, and
//! edges of loops that enclose nothing.
use crate::explicit::DisjointSets;
use crate::math::{distance, greater, lesser};
use std::collections::BTreeMap;

/// The most vertices of a mesh for a search of the nearest. Chosen: any vertex gives a bound.
const MOST_COMPARED: usize = 1 << 12;

/// A connected set of flat triangles.
#[derive(Default)]
struct LooseComponent {
    /// A bound for the length of a walk within the set.
    longest_walk: f64,
    is_attached: bool,
    vertex: u32,
}

/// A bound for the distance of the points of flat triangles from a mesh; edges and points have a corner twice or thrice.
///
/// Most flat triangles consist of sides of the mesh. The others are reached from its vertices by walks along connected
/// sets.
pub(super) fn uncovered(flat: &[[u32; 3]], mesh: &[[u32; 3]], positions: &[[f64; 3]]) -> f64 {
    if flat.is_empty() {
        return 0.0;
    }
    let sides_of = |[a, b, c]: [u32; 3]| {
        // A vertex counts as a side with equal ends.
        [[a, b], [b, c], [c, a], [a, a], [b, b], [c, c]].map(|[a, b]| if a < b { [a, b] } else { [b, a] })
    };
    let mut is_flat = vec![false; positions.len()];
    flat.as_flattened().iter().for_each(|vertex| is_flat[*vertex as usize] = true);
    let mut sides: Vec<[u32; 2]> = mesh.iter().flat_map(|t| sides_of(*t)).collect();
    sides.retain(|side| side.iter().all(|vertex| is_flat[*vertex as usize]));
    sides.sort_unstable();
    let has = |side: [u32; 2]| sides.binary_search(&side).is_ok();

    let mut sets = DisjointSets::new(positions.len());
    let open: Vec<[u32; 3]> = flat.iter().copied().filter(|t| !sides_of(*t).into_iter().all(has)).collect();
    for [a, b, c] in &open {
        sets.union(*a, *b);
        sets.union(*a, *c);
    }
    let mut components: BTreeMap<u32, LooseComponent> = BTreeMap::new();
    for [a, b, c] in open {
        let component = components.entry(sets.find(a)).or_default();
        let side = |a: u32, b: u32| distance(positions[a as usize], positions[b as usize]);
        // A walk crosses each triangle once, by no more than its longest side.
        component.longest_walk += greater(greater(side(a, b), side(b, c)), side(c, a));
        component.is_attached |= [a, b, c].into_iter().any(|vertex| has([vertex, vertex]));
        component.vertex = a;
    }
    let step = mesh.len().div_ceil(MOST_COMPARED).max(1);
    let to_mesh = |vertex: u32| {
        let to = |other: u32| distance(positions[vertex as usize], positions[other as usize]);
        mesh.iter().step_by(step).map(|t| to(t[0])).fold(f64::INFINITY, lesser)
    };
    let farthest = components.values().fold(0.0, |farthest: f64, component| {
        let jump = if component.is_attached { 0.0 } else { to_mesh(component.vertex) };
        greater(farthest, component.longest_walk + jump)
    });
    // Derived: 4 roundings for each length, and the roundings of the sum.
    farthest * (1.0 + (8.0 + flat.len() as f64) * f64::EPSILON)
}

#[cfg(test)]
mod tests {
    use super::uncovered;

    #[test]
    fn a_side_costs_nothing_and_a_chain_its_length() {
        let positions = [0.0, 1.0, 0.5, 2.0, 4.0, 9.0].map(|x| [x, if x == 0.5 { 1.0 } else { 0.0 }, 0.0]);
        let mesh = [[0, 1, 2]];
        let off = |flat: &[[u32; 3]]| uncovered(flat, &mesh, &positions);
        assert_eq!(off(&[]), 0.0);
        assert_eq!(off(&[[0, 1, 1], [2, 2, 2]]), 0.0);
        let near = |found: f64, wanted: f64| found >= wanted && found < wanted * (1.0 + 1e-12);
        assert!(near(off(&[[1, 3, 3], [3, 4, 3], [0, 2, 2]]), 3.0));
        // From the first vertex, and then on.
        assert!(near(off(&[[4, 5, 4]]), 4.0 + 5.0));
    }
}
