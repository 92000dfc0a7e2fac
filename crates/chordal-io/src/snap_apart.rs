//! `snap_apart`: rounds positions to those that a format stores, without merging vertices that no edge joins.
use crate::format::Format;
use crate::snap::{CoordinateOverflow, snap};
use crate::snapped_mesh::{SnappedMesh, distance_up};
use chordal::Mesh;
use chordal::explicit::position_id_by_bits;
use chordal::math::{greater, lesser};
use std::collections::{BTreeMap, BTreeSet, HashSet};

/// As [`snap`], but if rounding moves vertices that no edge joins to the same position, they get neighbouring
/// positions instead. Otherwise two sheets that are closer to each other than single precision can resolve
/// would share edges in the file, and a manifold surface would read back as non-manifold. Vertices joined by
/// an edge may still merge, since that only removes triangles and connects nothing new.
///
/// Such a vertex moves by the last digit of its largest coordinate for each vertex that it is separated from;
/// `moved_at_most` includes this. For formats that store positions about an origin, vertices are not
/// separated. Linear in vertices and faces.
///
/// # Errors
/// As for [`snap`].
///
/// ```
/// use chordal::Mesh;
/// use chordal_io::{Format, snap, snap_apart};
/// // Two triangles, 1e-12 apart, that share no vertex.
/// let sheet = |z: f64| [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]];
/// let corners = [sheet(1.0), sheet(1.0 + 1e-12)].concat();
/// let mesh = Mesh::new(corners, vec![[0, 2, 1], [3, 4, 5]])?;
/// let tied = snap(&mesh, Format::Stl)?.mesh;
/// assert_eq!(tied.positions()[0], tied.positions()[3]);
/// let apart = snap_apart(&mesh, Format::Stl)?.mesh;
/// assert!(apart.positions()[0][2] < apart.positions()[3][2]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn snap_apart(mesh: &Mesh, format: Format) -> Result<SnappedMesh, CoordinateOverflow> {
    let plain = snap(mesh, format)?;
    if plain.moved_at_most == 0.0 || plain.origin != [0.0; 3] {
        return Ok(plain);
    }
    let ids = position_id_by_bits(mesh.positions());
    let rounded = position_id_by_bits(plain.mesh.positions());
    let root = roots(mesh, &ids, &rounded);
    let groups = merged_roots(mesh, &root, &rounded);
    if groups.is_empty() {
        return Ok(plain);
    }
    let places = separate_positions(mesh, &plain.mesh, &groups)?;
    let mut positions = plain.mesh.positions().to_vec();
    let mut moved_at_most = plain.moved_at_most;
    for (row, position) in positions.iter_mut().enumerate() {
        if let Some(place) = places.get(&root[row]) {
            *position = *place;
            moved_at_most = greater(distance_up(mesh.positions()[row], *place), moved_at_most);
        }
    }
    let mesh = mesh.with_positions(positions).map_err(|_| CoordinateOverflow { value: f64::INFINITY })?;
    Ok(SnappedMesh { mesh, moved_at_most, ..plain })
}

/// For each row the first row that it is connected to by edges within its rounded position.
fn roots(mesh: &Mesh, ids: &[u32], rounded: &[u32]) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..ids.len() as u32).collect();
    // Union–find with path halving; the smaller row becomes the root, so that the order does not matter.
    fn root(parent: &mut [u32], mut row: u32) -> u32 {
        while parent[row as usize] != row {
            parent[row as usize] = parent[parent[row as usize] as usize];
            row = parent[row as usize];
        }
        row
    }
    for [a, b, c] in mesh.faces() {
        for (from, to) in [(*a, *b), (*b, *c), (*c, *a)] {
            if rounded[from as usize] != rounded[to as usize] {
                continue;
            }
            let ends = [from, to].map(|row| root(&mut parent, ids[row as usize]));
            let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
            parent[high as usize] = low;
        }
    }
    ids.iter().map(|row| root(&mut parent, *row)).collect()
}

/// The most vertices at one position that are separated; more are left merged, since a shape smaller than the
/// last digits cannot be kept. Chosen: more than meet where two creases cross.
const MOST: usize = 8;

/// For each rounded position, the roots that are merged there although no edges connect them.
fn merged_roots(mesh: &Mesh, root: &[u32], rounded: &[u32]) -> Vec<Vec<u32>> {
    let mut at: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
    // Rows without a face cannot connect anything.
    for row in mesh.faces().iter().flatten().map(|row| *row as usize) {
        at.entry(rounded[row]).or_default().insert(root[row]);
    }
    at.into_values()
        .filter(|roots| (2..=MOST).contains(&roots.len()))
        .map(|roots| roots.into_iter().collect())
        .collect()
}

/// A separate position for each root of each group, in their order along the axis of their largest extent.
fn separate_positions(
    mesh: &Mesh,
    plain: &Mesh,
    groups: &[Vec<u32>],
) -> Result<BTreeMap<u32, [f64; 3]>, CoordinateOverflow> {
    let bits = |p: [f64; 3]| p.map(|x| (x + 0.0).to_bits());
    // Only for membership: no result depends on its order.
    let mut taken: HashSet<[u64; 3]> = plain.positions().iter().map(|p| bits(*p)).collect();
    let mut places = BTreeMap::new();
    for group in groups {
        let exact = |root: &u32| mesh.positions()[*root as usize];
        let common = plain.positions()[group[0] as usize];
        let spread = |k: usize| {
            let low = group.iter().fold(f64::INFINITY, |least, root| lesser(exact(root)[k], least));
            group.iter().fold(f64::NEG_INFINITY, |most, root| greater(exact(root)[k], most)) - low
        };
        // Along it the exact positions differ the most, so their order there is the surest.
        let axis = (1..3).fold(0, |best, k| if spread(k) > spread(best) { k } else { best });
        let mut order = group.clone();
        order.sort_by(|a, b| exact(a)[axis].total_cmp(&exact(b)[axis]).then(a.cmp(b)));
        // The middle vertex keeps the common position x, the others the single-precision numbers beside it:
        //   exact    … a  b  c …       all three round to x
        //   stored   x⁻    x    x⁺
        let mut x = common[axis] as f32;
        for _ in 0..order.len() / 2 {
            x = x.next_down();
        }
        // The group gives up its common place, so that one of its vertices can have it.
        taken.remove(&bits(common));
        for root in order {
            let mut place = common;
            place[axis] = f64::from(x);
            // Another vertex may be there already; further up something is free, and the order is
            // kept.
            while !taken.insert(bits(place)) {
                x = x.next_up();
                place[axis] = f64::from(x);
            }
            if !place[axis].is_finite() {
                return Err(CoordinateOverflow { value: common[axis] });
            }
            places.insert(root, place);
        }
    }
    Ok(places)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box as twelve triangles.
    fn cuboid(low: [f64; 3], high: [f64; 3]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        let at = |i: usize| std::array::from_fn(|k| if i >> k & 1 == 1 { high[k] } else { low[k] });
        let quads: [[u32; 4]; 6] =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
        let faces = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        ((0..8).map(at).collect(), faces)
    }

    #[test]
    fn boxes_that_are_nearer_than_the_digits_stay_two_manifolds() {
        let (mut points, mut faces) = cuboid([0.1; 3], [1.3; 3]);
        // Edge to edge, and 1e-10 apart.
        let (others, more) = cuboid([1.3 + 1e-10, 1.3 + 1e-10, 0.1], [2.7, 2.7, 1.3]);
        faces.extend(more.iter().map(|face| face.map(|row| row + 8)));
        points.extend(others);
        let mesh = Mesh::new(points, faces).unwrap();
        let manifold = |mesh: &Mesh| {
            let found = chordal::check::validity(mesh, chordal::explicit::Topology::Positions);
            found.non_manifold_edges.count == 0 && found.boundary_edges.count == 0
        };
        assert!(!manifold(&snap(&mesh, Format::Stl).unwrap().mesh));
        let apart = snap_apart(&mesh, Format::Stl).unwrap();
        assert!(manifold(&apart.mesh));
        // Single precision has steps of 1.2e-7 here.
        assert!(apart.moved_at_most < 2.5e-7, "{}", apart.moved_at_most);
        for (from, to) in mesh.positions().iter().zip(apart.mesh.positions()) {
            assert!(distance_up(*from, *to) <= apart.moved_at_most);
            assert!(to.iter().all(|x| f64::from(*x as f32) == *x));
        }
        assert_eq!(snap(&apart.mesh, Format::Stl).unwrap().moved_at_most, 0.0);
    }

    #[test]
    fn ends_of_an_edge_may_still_become_one() {
        let corners = vec![[1.0, 0.0, 0.1], [1.0 + 1e-12, 0.0, 0.1], [0.0, 1.0, 0.0]];
        let mesh = Mesh::new(corners, vec![[0, 1, 2]]).unwrap();
        assert_eq!(snap_apart(&mesh, Format::Stl), snap(&mesh, Format::Stl));
    }
}
