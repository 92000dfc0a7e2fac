//! Which vertices become one without a face that would vanish.
//!
//! What is smaller than sewing is near, or thinner, has its vertices united with each other through those of its neighbours.
//! Where nothing would be left of a face, unions count by their distance, the least first, and those that would unite two of
//! its own places are left out.
use super::sew::{SewnVertices, TrimmedFace};
use super::trim_cells::FaceTriangles;
use crate::explicit::DisjointSets;
use crate::math::{Box3, difference, length};
use std::collections::BTreeMap;

/// What of a face's diagonal is one place of it, where it would vanish. Chosen: far above rounding, far below what is seen.
const OWN_PLACE: f64 = 1e-6;
/// Rounds in which more faces are found that would vanish. Chosen: each is a chain of neighbours longer.
const ROUNDS: usize = 8;

/// A vertex that may not be united with others of its face.
#[derive(Clone, Copy)]
struct KeptVertex {
    vertex: u32,
    face: u32,
}

/// By vertex of all loops: the earliest that is the same.
pub(super) fn same_vertices(
    faces: &[TrimmedFace<'_>],
    triangles: &[FaceTriangles],
    sewn: &SewnVertices,
) -> Vec<u32> {
    let (first, mut unions) = (&sewn.first, sewn.near.clone());
    let positions: Vec<[f64; 3]> = faces.iter().flat_map(|face| face.positions.iter().copied()).collect();
    let distance = |a: u32, b: u32| length(difference(positions[a as usize], positions[b as usize]));
    let mut sets = DisjointSets::new(positions.len());
    unions.iter().for_each(|[a, b]| sets.union(*a, *b));
    let mut same: Vec<u32> = (0..positions.len() as u32).map(|vertex| sets.find(vertex)).collect();
    let mut kept: BTreeMap<u32, f64> = BTreeMap::new();
    for round in 0..ROUNDS {
        let before = kept.len();
        for (index, face) in faces.iter().enumerate() {
            let diagonal = Box3::from_points(&face.positions).diagonal();
            if diagonal > 0.0
                && is_flat(face, &triangles[index], |vertex| same[(first[index] + vertex) as usize])
            {
                kept.insert(index as u32, OWN_PLACE * diagonal);
            }
        }
        if kept.len() == before {
            break;
        }
        if round == 0 {
            unions.sort_by(|a, b| distance(a[0], a[1]).total_cmp(&distance(b[0], b[1])).then(a.cmp(b)));
        }
        let mut sets = DisjointSets::new(positions.len());
        let mut members: BTreeMap<u32, Vec<KeptVertex>> = BTreeMap::new();
        for index in kept.keys() {
            let own = first[*index as usize];
            for vertex in own..own + faces[*index as usize].positions.len() as u32 {
                members.insert(vertex, vec![KeptVertex { vertex, face: *index }]);
            }
        }
        for [a, b] in &unions {
            let roots = [sets.find(*a), sets.find(*b)];
            if roots[0] == roots[1] {
                continue;
            }
            let [one, other] = roots.map(|root| members.get(&root).map_or(&[][..], Vec::as_slice));
            let is_kept = one.iter().any(|a| {
                let differs = |b: &KeptVertex| distance(a.vertex, b.vertex) > kept[&a.face];
                other.iter().any(|b| a.face == b.face && differs(b))
            });
            if is_kept {
                continue;
            }
            let all: Vec<KeptVertex> =
                roots.iter().filter_map(|root| members.remove(root)).flatten().collect();
            sets.union(*a, *b);
            if !all.is_empty() {
                members.insert(sets.find(*a), all);
            }
        }
        same = (0..positions.len() as u32).map(|vertex| sets.find(vertex)).collect();
    }
    same
}

/// Whether no triangle of a face has three corners.
fn is_flat(face: &TrimmedFace<'_>, triangles: &FaceTriangles, leader: impl Fn(u32) -> u32) -> bool {
    let n_border = face.positions.len() as u32;
    triangles.triangles.iter().all(|(corners, _)| {
        // What is within a face is no vertex of another.
        let at = corners.map(|k| if k < n_border { Ok(leader(k)) } else { Err(k) });
        at[0] == at[1] || at[1] == at[2] || at[2] == at[0]
    })
}
