//! Builds [`Contours`]: edges, the boundary edges of the shape, and the tree over
//! them.
use super::contours::{ContourBvhNode, ContourEdge, ContourFill, Contours};
use super::{InvalidShape, finite_point};
use crate::implicit::Distance;
use crate::math::{Orientation, greater, lesser, orient2d};

/// Edges in a leaf of the tree.
const LEAF: usize = 4;

impl Contours {
    /// The contours through these points, each closed. If edges meet only at corners that they share,
    /// contours that do not bound the filled region (such as one inside another of the same direction) are
    /// left out, and the value is the exact distance. Otherwise the value is a bound: an edge may run inside
    /// the shape.
    ///
    /// # Errors
    /// When a coordinate is not a finite number below 1e150, or no contour has three corners.
    pub fn new(contours: &[Vec<[f64; 2]>], fill: ContourFill) -> Result<Self, InvalidShape> {
        let mut largest = 0.0;
        for x in contours.iter().flatten().flatten() {
            finite_point("a contour's coordinate", [*x])?;
            largest = greater(x.abs(), largest);
        }
        // Defined: squares of differences stay finite.
        if largest >= 1e150 {
            return Err(InvalidShape::Number(format!(
                "a contour's coordinate is {largest}, and must be below 1e150"
            )));
        }
        let edges = edges(contours);
        if edges.is_empty() {
            return Err(InvalidShape::Number("no contour has three different corners in a row".into()));
        }
        let (edges, is_simple) = orient_edges(edges, fill);
        if edges.is_empty() {
            return Err(InvalidShape::Number("the contours enclose nothing".into()));
        }
        let (nodes, order) = tree(&edges);
        let bounds = nodes.first().map_or([[0.0; 2]; 2], |root| [root.min, root.max]);
        let distance = if is_simple { Distance::EXACT } else { Distance::BOUND };
        Ok(Self { edges, nodes, order, largest, fill, distance, bounds })
    }
}

/// The edges of all contours with at least three different successive corners.
fn edges(contours: &[Vec<[f64; 2]>]) -> Vec<ContourEdge> {
    let mut edges = Vec::new();
    for (contour, points) in contours.iter().enumerate() {
        let mut corners = points.clone();
        corners.dedup();
        while corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        let n = corners.len();
        if n < 3 {
            continue;
        }
        let first = edges.len();
        let row = |k: usize| (first + k % n) as u32;
        edges.extend((0..n).map(|k| ContourEdge {
            a: corners[k],
            b: corners[(k + 1) % n],
            contour: contour as u32,
            before: row(k + n - 1),
            after: row(k + 1),
            outside: 0,
        }));
    }
    edges
}

/// Builds the tree over the edges: nodes, and the order of the edges in their runs.
fn tree(edges: &[ContourEdge]) -> (Vec<ContourBvhNode>, Vec<u32>) {
    let mut order: Vec<u32> = (0..edges.len() as u32).collect();
    let mut nodes = Vec::new();
    // A range of the order, and the node whose second child it becomes.
    let mut waiting = vec![(0..edges.len(), None)];
    while let Some((run, parent)) = waiting.pop() {
        let at = nodes.len();
        if let Some(parent) = parent {
            let parent: &mut ContourBvhNode = &mut nodes[parent];
            parent.second = at as u32;
        }
        let (mut min, mut max) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for row in &order[run.clone()] {
            let edge = &edges[*row as usize];
            for (p, k) in [(edge.a, 0), (edge.a, 1), (edge.b, 0), (edge.b, 1)] {
                min[k] = lesser(p[k], min[k]);
                max[k] = greater(p[k], max[k]);
            }
        }
        nodes.push(ContourBvhNode { min, max, run: [run.start as u32, run.end as u32], second: 0 });
        if run.len() > LEAF {
            let axis = usize::from(max[1] - min[1] > max[0] - min[0]);
            let middle = |row: &u32| edges[*row as usize].a[axis] + edges[*row as usize].b[axis];
            let half = run.len() / 2;
            order[run.clone()]
                .select_nth_unstable_by(half, |l, r| middle(l).total_cmp(&middle(r)).then(l.cmp(r)));
            // The first half is taken from the stack next, so that the first child follows its parent.
            waiting.push((run.start + half..run.end, Some(at)));
            waiting.push((run.start..run.start + half, None));
        }
    }
    (nodes, order)
}

/// Only the contours that bound the filled region, each edge with the side of its outside; and whether that
/// was possible, which it is unless edges meet elsewhere than at corners that they share.
fn orient_edges(mut edges: Vec<ContourEdge>, fill: ContourFill) -> (Vec<ContourEdge>, bool) {
    let (nodes, order) = tree(&edges);
    let full = Contours::from_parts(edges.clone(), nodes, order, fill);
    if !is_simple(&full) {
        return (edges, false);
    }
    let mut start = 0;
    let mut boundary = Vec::new();
    while start < edges.len() {
        let contour = edges[start].contour;
        let n = edges[start..].iter().take_while(|edge| edge.contour == contour).count();
        // At one of its points, since the others wind alike around all of it.
        let winding_of_others = full.winding(edges[start].a, |edge| edge.contour != contour);
        let counter_clockwise = turns_left(&edges, start..start + n);
        let [left, right] = if counter_clockwise {
            [winding_of_others + 1, winding_of_others]
        } else {
            [winding_of_others, winding_of_others - 1]
        };
        let is_inside = [left, right].map(|winding| fill.holds(winding));
        if is_inside[0] != is_inside[1] {
            let offset = boundary.len() as u32;
            for edge in &mut edges[start..start + n] {
                edge.outside = if is_inside[0] { 1 } else { -1 };
                edge.before = edge.before - start as u32 + offset;
                edge.after = edge.after - start as u32 + offset;
            }
            boundary.extend_from_slice(&edges[start..start + n]);
        }
        start += n;
    }
    (boundary, true)
}

/// Whether a simple contour runs counter-clockwise, by the turn at its lowest corner.
fn turns_left(edges: &[ContourEdge], run: std::ops::Range<usize>) -> bool {
    let lowest = run.reduce(|l, r| if edges[r].a < edges[l].a { r } else { l }).unwrap_or(0);
    let edge = &edges[lowest];
    orient2d(edges[edge.before as usize].a, edge.a, edge.b) == Orientation::Front
}

/// Whether no two edges meet except at corners that they share; exact.
fn is_simple(contours: &Contours) -> bool {
    (0..contours.edges.len() as u32).all(|row| {
        let edge = &contours.edges[row as usize];
        let low = |k: usize| lesser(edge.a[k], edge.b[k]);
        let high = |k: usize| greater(edge.a[k], edge.b[k]);
        let near = |node: &ContourBvhNode| (0..2).all(|k| node.min[k] <= high(k) && node.max[k] >= low(k));
        let mut clear = true;
        contours.descend(near, |other| {
            // Test each pair once.
            clear = clear && (other <= row || !meet(contours, row, other));
        });
        clear
    })
}

/// Whether two edges have a common point other than the corner between neighbours.
fn meet(contours: &Contours, row: u32, other: u32) -> bool {
    let (e, f) = (&contours.edges[row as usize], &contours.edges[other as usize]);
    let folds = |from: [f64; 2], corner: [f64; 2], to: [f64; 2]| {
        // The next edge runs back over this one: collinear, and on the same side of the corner along some
        // axis.
        orient2d(from, corner, to) == Orientation::Flat
            && (0..2).any(|k| {
                (from[k] > corner[k] && to[k] > corner[k]) || (from[k] < corner[k] && to[k] < corner[k])
            })
    };
    if e.after == other {
        return folds(e.a, e.b, f.b) || (f.after == row && folds(f.a, f.b, e.b));
    }
    if f.after == row {
        return folds(f.a, f.b, e.b);
    }
    let apart = |k: usize| {
        let low = |e: &ContourEdge| lesser(e.a[k], e.b[k]);
        let high = |e: &ContourEdge| greater(e.a[k], e.b[k]);
        low(e) > high(f) || low(f) > high(e)
    };
    let beside = |e: &ContourEdge, f: &ContourEdge| {
        let side = orient2d(e.a, e.b, f.a);
        side != Orientation::Flat && side == orient2d(e.a, e.b, f.b)
    };
    // Collinear edges with overlapping boxes overlap.
    !(apart(0) || apart(1) || beside(e, f) || beside(f, e))
}

/// The contours joined with their mirror image in `x = axis`, without the edges on that line. None if there
/// are no such edges, or contours reach beyond the line.
///
/// Each run of edges from the line back to it becomes a contour with its own mirror image. As chains these
/// are all edges and their images, minus the edges on the line, which cancel. So winding numbers off the line
/// stay the same.
pub(super) fn with_mirror_image(contours: &Contours, axis: f64) -> Option<Contours> {
    let edges = &contours.edges;
    let is_on = |edge: &ContourEdge| edge.a[0] == axis && edge.b[0] == axis;
    if contours.bounds[0][0] != axis || !edges.iter().any(is_on) {
        return None;
    }
    // Rounding moves only the mirror image, and points beyond the line are never evaluated.
    let mirrored = |p: &[f64; 2]| [axis - (p[0] - axis), p[1]];
    let mut joined = Vec::new();
    let mut row = 0;
    while row < edges.len() {
        let run =
            &edges[row..row + edges[row..].iter().take_while(|e| e.contour == edges[row].contour).count()];
        row += run.len();
        let Some(first) = run.iter().position(is_on) else {
            let points: Vec<[f64; 2]> = run.iter().map(|edge| edge.a).collect();
            joined.push(points.iter().rev().map(mirrored).collect());
            joined.push(points);
            continue;
        };
        let turned: Vec<&ContourEdge> = run[first..].iter().chain(&run[..first]).collect();
        for path in turned.split(|edge| is_on(edge)).filter(|path| !path.is_empty()) {
            let mut points = vec![path[0].a];
            points.extend(path.iter().map(|edge| edge.b));
            let image: Vec<[f64; 2]> = points[1..points.len() - 1].iter().rev().map(mirrored).collect();
            points.extend(image);
            joined.push(points);
        }
    }
    Contours::new(&joined, contours.fill).ok()
}

impl Contours {
    /// Contours for winding numbers only.
    fn from_parts(
        edges: Vec<ContourEdge>,
        nodes: Vec<ContourBvhNode>,
        order: Vec<u32>,
        fill: ContourFill,
    ) -> Self {
        Self { edges, nodes, order, largest: 0.0, fill, distance: Distance::BOUND, bounds: [[0.0; 2]; 2] }
    }
}
