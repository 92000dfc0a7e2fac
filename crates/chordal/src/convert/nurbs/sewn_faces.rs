//! Decides which vertices become one, so that no face vanishes.
//!
//! If a face is smaller or thinner than the sewing length, its vertices are united with each other through the vertices
//! of its neighbours. If a face would vanish by this, unions are taken by their distance, the least first, and unions of
//! two of its own places are left out.
use super::sew::{SewnVertices, TrimmedFace};
use super::trim_cells::FaceTriangles;
use crate::explicit::DisjointSets;
use crate::math::{Box3, distance};
use std::collections::BTreeMap;

/// In a face that would vanish, vertices within this fraction of its diagonal are one place. Chosen: far above rounding,
/// and too small to be seen.
const OWN_PLACE: f64 = 1e-6;
/// Rounds of the search for faces that would vanish. Chosen: each round follows chains of neighbours one face farther.
const ROUNDS: usize = 8;

/// A vertex that may not be united with others of its face.
#[derive(Clone, Copy)]
struct KeptVertex {
    vertex: u32,
    face: u32,
}

/// By vertex of all loops: the first vertex of its set.
pub(super) fn same_vertices(
    faces: &[TrimmedFace<'_>],
    triangles: &[FaceTriangles],
    sewn: &SewnVertices,
) -> Vec<u32> {
    let (first, mut unions) = (&sewn.first, sewn.near.clone());
    let positions: Vec<[f64; 3]> = faces.iter().flat_map(|face| face.positions.iter().copied()).collect();
    let distance = |a: u32, b: u32| distance(positions[a as usize], positions[b as usize]);
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
        // Until now all unions were taken, in any order.
        if round == 0 {
            unions.sort_by(|a, b| distance(a[0], a[1]).total_cmp(&distance(b[0], b[1])).then(a.cmp(b)));
        }
        let mut sets = DisjointSets::new(positions.len());
        let mut members: BTreeMap<u32, Vec<KeptVertex>> = BTreeMap::new();
        for index in kept.keys() {
            let first_vertex = first[*index as usize];
            for vertex in first_vertex..first_vertex + faces[*index as usize].positions.len() as u32 {
                members.insert(vertex, vec![KeptVertex { vertex, face: *index }]);
            }
        }
        for [a, b] in &unions {
            let roots = [sets.find(*a), sets.find(*b)];
            if roots[0] == roots[1] {
                continue;
            }
            // United, two places of such a face would be one, and it would vanish again.
            let [kept_in_a, other] = roots.map(|root| members.get(&root).map_or(&[][..], Vec::as_slice));
            let is_kept = kept_in_a.iter().any(|a| {
                let differs = |b: &KeptVertex| distance(a.vertex, b.vertex) > kept[&a.face];
                other.iter().any(|b| a.face == b.face && differs(b))
            });
            if is_kept {
                continue;
            }
            let united: Vec<KeptVertex> =
                roots.iter().filter_map(|root| members.remove(root)).flatten().collect();
            sets.union(*a, *b);
            if !united.is_empty() {
                members.insert(sets.find(*a), united);
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
        // A vertex within a face is no vertex of another.
        let at = corners.map(|k| if k < n_border { Ok(leader(k)) } else { Err(k) });
        at[0] == at[1] || at[1] == at[2] || at[2] == at[0]
    })
}
