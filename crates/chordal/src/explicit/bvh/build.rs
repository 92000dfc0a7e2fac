//! Builds the tree top down; each node is split where the binned surface area heuristic is smallest.
use super::frame::{BvhFrame, down, up};
use super::sah_split::{BvhPrimitive, PrimitiveBounds, cut};
use super::{Bvh, BvhNode, BvhTriangle, LAST, LEAF, NONE, WIDTH};
use crate::budget::{Job, par_map, par_map_owned};
use crate::explicit::Mesh;
use crate::math::{Box3, greater, lesser, sub_down, sub_up};

/// The most triangles in a leaf. Measured on 1 M triangles: from 2 to 8 queries differ by less than the
/// machine's noise, and 4 needs a quarter less memory than 2.
pub(super) const LEAF_SIZE: usize = 4;
/// The depth in nodes up to which the heuristic decides. Below, nodes are split into equal quarters, 16
/// levels of which are enough for 2³² triangles.
pub(super) const DEEPEST_BY_COST: u32 = 24;
/// Larger subtrees are separate tasks. Chosen: some milliseconds of work.
const TASK: usize = 1 << 14;

/// The tree over all faces; `None` when the job is cancelled.
pub(super) fn build(mesh: &Mesh, job: &Job) -> Option<Bvh> {
    let bounds = used_bounds(mesh);
    if bounds.is_empty() {
        let frame = BvhFrame { scale: 1.0, middle: [0.0; 3] };
        let local = bounds;
        return Some(Bvh {
            frame,
            bounds,
            local,
            nodes: Vec::new(),
            triangles: Vec::new(),
            corners: Vec::new(),
        });
    }
    let frame = BvhFrame::from_bounds(&bounds);
    let chunks: Vec<usize> = (0..mesh.faces().len()).step_by(TASK).collect();
    let mut prims = par_map(job, &chunks, |_, from| prims(mesh, &frame, *from)).concat();
    let extent = PrimitiveBounds::new(&prims);
    let mut nodes = job.run(|| subtree(&mut prims, BuildRange { extent, first: 0, depth: 0 }, job));
    nodes.shrink_to_fit();
    if job.is_cancelled() {
        return None;
    }
    let (triangles, corners) = in_leaf_order(mesh, &frame, &prims, &nodes);
    let [min, max] = [frame.local(frame.scaled(bounds.min))[0], frame.local(frame.scaled(bounds.max))[1]];
    Some(Bvh { frame, bounds, local: Box3 { min, max }, nodes, triangles, corners })
}

pub(super) fn used_bounds(mesh: &Mesh) -> Box3 {
    let mut bounds = Box3::EMPTY;
    for face in mesh.faces() {
        for i in face {
            bounds = bounds.with(mesh.positions()[*i as usize]);
        }
    }
    bounds
}

/// The boxes of the chunk of faces that starts at `from`.
fn prims(mesh: &Mesh, frame: &BvhFrame, from: usize) -> Vec<BvhPrimitive> {
    let to = mesh.faces().len().min(from + TASK);
    (from..to).map(|face| prim(mesh, frame, face)).collect()
}

/// The box of one face in local coordinates, rounded outward twice: by the shift to the middle and to f32.
fn prim(mesh: &Mesh, frame: &BvhFrame, face: usize) -> BvhPrimitive {
    let [a, b, c] = mesh.corners(face).map(|p| frame.scaled(p));
    let lowest = |k: usize| {
        let ab = lesser(a[k], b[k]);
        lesser(ab, c[k])
    };
    let highest = |k: usize| {
        let ab = greater(a[k], b[k]);
        greater(ab, c[k])
    };
    BvhPrimitive::new(
        std::array::from_fn(|k| down(sub_down(lowest(k), frame.middle[k]))),
        std::array::from_fn(|k| up(sub_up(highest(k), frame.middle[k]))),
        face as u32,
    )
}

/// A run of triangles in the tree: its bounds, its start in the order of the leaves, and its depth.
#[derive(Clone, Copy)]
struct BuildRange {
    extent: PrimitiveBounds,
    first: u32,
    depth: u32,
}

/// A part of a node's triangles.
struct BuildRecord<'a> {
    prims: &'a mut [BvhPrimitive],
    range: BuildRange,
}

/// The nodes over `prims`, the root first; large parts are built as tasks and appended in order.
fn subtree(prims: &mut [BvhPrimitive], range: BuildRange, job: &Job) -> Vec<BvhNode> {
    if prims.len() <= TASK {
        let mut nodes = Vec::with_capacity(prims.len() / 5 + 1);
        emit(prims, range, &mut nodes);
        return nodes;
    }
    if job.is_cancelled() {
        return Vec::new();
    }
    let parts = quarter(prims, range);
    let root = node(&parts);
    let below = par_map_owned(job, parts, |part| {
        if part.prims.len() <= LEAF_SIZE { Vec::new() } else { subtree(part.prims, part.range, job) }
    });
    let mut nodes = Vec::with_capacity(1 + below.iter().map(Vec::len).sum::<usize>());
    nodes.push(root);
    for (lane, mut part) in below.into_iter().enumerate() {
        if part.is_empty() {
            continue;
        }
        let offset = nodes.len() as u32;
        // Inner children are numbered within their part. Leaves are numbers of triangles, which
        // already count from the first of all.
        for child in part.iter_mut().flat_map(|n| n.child.iter_mut()).filter(|c| **c & LEAF == 0) {
            *child += offset;
        }
        nodes[0].child[lane] = offset;
        nodes.append(&mut part);
    }
    nodes
}

/// Appends the nodes over `prims`, the root first, and returns the root's index.
fn emit(prims: &mut [BvhPrimitive], range: BuildRange, nodes: &mut Vec<BvhNode>) -> u32 {
    let index = nodes.len();
    let parts = quarter(prims, range);
    nodes.push(node(&parts));
    for (lane, part) in parts.into_iter().enumerate() {
        if part.prims.len() > LEAF_SIZE {
            nodes[index].child[lane] = emit(part.prims, part.range, nodes);
        }
    }
    index as u32
}

/// The node over `parts`, with all of them as leaves.
fn node(parts: &[BuildRecord]) -> BvhNode {
    let mut node =
        BvhNode { bounds: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3], child: [NONE; WIDTH] };
    for (lane, part) in parts.iter().enumerate() {
        let bounds = &part.range.extent.bounds;
        for k in 0..3 {
            node.bounds[k][0][lane] = bounds.low[k];
            node.bounds[k][1][lane] = bounds.high[k];
        }
        node.child[lane] = LEAF | part.range.first;
    }
    node
}

/// Splits `prims` into up to four parts, always the one with the largest surface next. Another box in a node
/// costs nothing, so even leaves are split while lanes are free.
fn quarter(prims: &mut [BvhPrimitive], range: BuildRange) -> Vec<BuildRecord<'_>> {
    let mut parts = Vec::with_capacity(WIDTH);
    parts.push(BuildRecord { prims, range: BuildRange { depth: range.depth + 1, ..range } });
    while parts.len() < WIDTH {
        let Some(index) = largest(&parts, range.depth) else { break };
        let BuildRecord { prims, range } = parts.swap_remove(index);
        let by_cost = range.depth <= DEEPEST_BY_COST;
        let (middle, [left, right]) = cut(prims, by_cost.then_some(&range.extent));
        let (a, b) = prims.split_at_mut(middle);
        parts.push(BuildRecord { prims: a, range: BuildRange { extent: left, ..range } });
        parts.push(BuildRecord {
            prims: b,
            range: BuildRange { extent: right, first: range.first + middle as u32, ..range },
        });
    }
    parts.sort_by_key(|part| part.range.first);
    parts
}

fn largest(parts: &[BuildRecord], depth: u32) -> Option<usize> {
    let size = |part: &BuildRecord| {
        let n = part.prims.len();
        if depth >= DEEPEST_BY_COST { n as f32 } else { part.range.extent.bounds.area() }
    };
    let splittable = parts.iter().enumerate().filter(|(_, part)| part.prims.len() > 1);
    splittable
        .map(|(i, part)| (i, part.prims.len() > LEAF_SIZE, size(part)))
        // First parts that must be split, then parts that may be; among these the largest, and the first of
        // equals.
        .reduce(|a, b| if (b.1, b.2) > (a.1, a.2) { b } else { a })
        .map(|(i, ..)| i)
}

/// Triangles and scaled positions in the order of the leaves.
fn in_leaf_order(
    mesh: &Mesh,
    frame: &BvhFrame,
    prims: &[BvhPrimitive],
    nodes: &[BvhNode],
) -> (Vec<BvhTriangle>, Vec<[f64; 3]>) {
    const UNSEEN: u32 = u32::MAX;
    let mut row = vec![UNSEEN; mesh.positions().len()];
    let mut corners = Vec::new();
    let mut triangles: Vec<BvhTriangle> = Vec::with_capacity(prims.len());
    // Corners in the order of their first use, so that those of a leaf are near each other in
    // memory.
    for prim in prims {
        let indices = mesh.faces()[prim.face() as usize].map(|i| {
            let new_row = &mut row[i as usize];
            if *new_row == UNSEEN {
                *new_row = corners.len() as u32;
                corners.push(frame.scaled(mesh.positions()[i as usize]));
            }
            *new_row
        });
        triangles.push(BvhTriangle { corners: indices, face: prim.face() });
    }
    // A run ends where the next starts.
    for child in nodes.iter().flat_map(|n| n.child).filter(|c| c & LEAF != 0 && *c != NONE) {
        if let Some(before) = (child & !LEAF).checked_sub(1) {
            triangles[before as usize].face |= LAST;
        }
    }
    if let Some(last) = triangles.last_mut() {
        last.face |= LAST;
    }
    corners.shrink_to_fit();
    (triangles, corners)
}
