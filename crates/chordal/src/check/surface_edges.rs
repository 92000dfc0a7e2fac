//! The edges of patches: the sides that are shared, and the smoothness of the surface there.
use super::PointTree;
use super::edge_join::{EdgeJoin, PatchSideId, apart, edge_join};
use crate::budget::over_chunks;
use crate::explicit::{Bezier, Patch, PatchSide, shared_sides};
use crate::math::{Box3, distance, lesser};
use std::cell::Cell;

/// The edges of patches, by the number of their sides.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceEdges {
    /// Edges at which two sides meet, in the order of the first sides.
    pub joins: Vec<EdgeJoin>,
    /// Sides without a neighbour.
    pub boundary: Vec<PatchSideId>,
    /// Three or more sides that are one curve; the smoothness of the surface there is not defined.
    pub branching: Vec<Vec<PatchSideId>>,
    /// Sides that are a single point.
    pub collapsed: Vec<PatchSideId>,
}

/// Sides without a neighbour meet with a gap if corresponding control points are within this share of the
/// shortest side of either patch. It is the share for open seams of meshes, and defined there.
const NEAR: f64 = 1.0 / 1024.0;
/// The most sides that are compared with one; if more are that near, they do not make one surface. Also keeps
/// the time of malicious files linear. Defined here.
const MOST_NEAR: usize = 64;
/// Edges measured in a task: about a millisecond.
const CHUNK: usize = 32;

/// Finds all edges of patches and measures the continuity of the two patches at each.
///
/// Two sides are one edge if their four control points are equal bit for bit, forwards or backwards; a side
/// that equals no other also meets one that nearly equals it, within a 1,024th of the shortest side of either
/// patch: a gap. A side that is only a part of its neighbour's side, as at a T-junction, is boundary.
///
/// Time: O(n log n) to find the edges, and up to 50 µs for each, shared among the threads of the host.
///
/// ```
/// use chordal::{Bezier, Patch, check};
/// let bent = Patch { control: std::array::from_fn(|i| std::array::from_fn(|j| {
///     [i as f64, j as f64, (i * j * j) as f64]
/// })) };
/// let edges = check::surfaces::surface_edges(&bent.halves_u());
/// assert_eq!((edges.joins.len(), edges.boundary.len()), (1, 6));
/// assert_eq!((edges.joins[0].parametric, edges.joins[0].geometric), (Some(2), Some(2)));
/// ```
#[must_use]
pub fn surface_edges(patches: &[Patch]) -> SurfaceEdges {
    let mut edges = SurfaceEdges::default();
    let mut pairs: Vec<[PatchSideId; 2]> = Vec::new();
    let mut alone: Vec<PatchSideId> = Vec::new();
    for uses in shared_sides(patches) {
        let ids: Vec<PatchSideId> =
            uses.iter().map(|used| PatchSideId { patch: used.sheet as usize, side: used.side }).collect();
        match ids[..] {
            [side] => alone.push(side),
            [first, second] => pairs.push([first, second]),
            _ => edges.branching.push(ids),
        }
    }
    let gaps = near_pairs(patches, &alone);
    let mut met = gaps.concat();
    met.sort_unstable();
    edges.boundary = alone.into_iter().filter(|side| met.binary_search(side).is_err()).collect();
    pairs.extend(gaps);
    pairs.sort_unstable();
    let measured = over_chunks(&pairs, CHUNK, |_, pairs| -> Vec<EdgeJoin> {
        pairs.iter().map(|pair| edge_join(patches, *pair)).collect()
    });
    edges.joins = measured.into_iter().flatten().collect();
    edges.collapsed = (0..patches.len())
        .flat_map(|patch| PatchSide::ALL.map(|side| PatchSideId { patch, side }))
        .filter(|id| patches[id.patch].side(id.side).is_point())
        .collect();
    edges
}

/// Pairs of these sides that nearly coincide, each the nearest of the other.
fn near_pairs(patches: &[Patch], alone: &[PatchSideId]) -> Vec<[PatchSideId; 2]> {
    let curves: Vec<Bezier<3>> = alone.iter().map(|id| patches[id.patch].side(id.side)).collect();
    let middles: Vec<[f64; 3]> = curves
        .iter()
        .map(|curve| std::array::from_fn(|k| curve.control.iter().fold(0.0, |sum, p| sum + 0.25 * p[k])))
        .collect();
    let near_distances: Vec<f64> = alone.iter().map(|id| NEAR * shortest_side(&patches[id.patch])).collect();
    let tree = PointTree::new(&middles);
    let nearest: Vec<Option<usize>> = (0..alone.len())
        .map(|i| {
            // Means of control points are no farther apart than the farthest pair of control points.
            let corner = |sign: f64| middles[i].map(|x| x + sign * near_distances[i]);
            let around = Box3 { min: corner(-1.0), max: corner(1.0) };
            let (n_seen, best) = (Cell::new(0), Cell::new(None::<(f64, usize)>));
            tree.any_in(&around, |j| {
                let j = j as usize;
                let distance = curve_distance(&curves[i], &curves[j]);
                let is_near = j != i && distance <= lesser(near_distances[i], near_distances[j]);
                // Equally near sides: the lower number, whatever the order of the tree.
                if is_near && best.get().is_none_or(|nearest| (distance, j) < nearest) {
                    best.set(Some((distance, j)));
                }
                n_seen.set(n_seen.get() + 1);
                // True stops the search. The best side until then is kept; it counts if it is mutual.
                n_seen.get() > MOST_NEAR
            });
            best.get().map(|(_, j)| j)
        })
        .collect();
    let mutual = |(i, j): (usize, &Option<usize>)| {
        j.filter(|j| i < *j && nearest[*j] == Some(i)).map(|j| [alone[i], alone[j]])
    };
    nearest.iter().enumerate().filter_map(mutual).collect()
}

/// The largest distance of corresponding control points, in the better of the two directions.
fn curve_distance(a: &Bezier<3>, b: &Bezier<3>) -> f64 {
    lesser(apart(&a.control, &b.control), apart(&a.control, &b.reversed().control))
}

/// The length of the control polygon of the shortest side that is not a point.
fn shortest_side(patch: &Patch) -> f64 {
    let polygon_length =
        |curve: Bezier<3>| curve.control.windows(2).fold(0.0, |sum, pair| sum + distance(pair[1], pair[0]));
    let sides = PatchSide::ALL.map(|side| patch.side(side)).into_iter().filter(|side| !side.is_point());
    sides.map(polygon_length).fold(f64::INFINITY, lesser)
}
