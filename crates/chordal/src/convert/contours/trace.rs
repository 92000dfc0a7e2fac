//! Marching squares on the blocks of a lattice that a field's curve may pass.
use crate::budget::{Job, par_map};
use crate::convert::cubes::marching_squares::square_segments;
use crate::implicit::{LeafError, Tape};
use crate::math::{Box3, greater};
use std::sync::Arc;

/// Squares along the side of a block.
const BLOCK: u32 = 16;
/// Points along the side of a block.
const POINTS: usize = BLOCK as usize + 1;
/// The most squares along a side of the lattice: edge numbers easily fit 64 bits.
const MOST: f64 = 65_536.0;
/// Crossings stay this fraction of an edge, exactly 2⁻²⁰, away from its ends, so that no two coincide.
const MARGIN: f64 = 1.0 / 1_048_576.0;
/// Bisections of an edge: its crossing is known to 2⁻³² of the edge.
const HALVINGS: usize = 32;

/// Squares of one size over a rectangle of the plane z = 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContourLattice {
    origin: [f64; 2],
    pub step: f64,
    /// Blocks along each axis.
    blocks: [u32; 2],
}

impl ContourLattice {
    /// Squares of side `step` that cover a box with one more all around; `None` if they are too many, or if
    /// coordinates cannot distinguish them.
    pub fn covering(bounds: &Box3, step: f64) -> Option<Self> {
        let reach = bounds.min.iter().chain(&bounds.max).fold(0.0, |m: f64, x| greater(x.abs(), m));
        // Exactly 2¹² steps of the largest coordinate.
        if step < 4096.0 * f64::EPSILON * reach {
            return None;
        }
        // The origin avoids round numbers: a curve with such coordinates would cross edges exactly at their ends.
        let aside = [1.618_034, 1.381_966];
        let origin = [0, 1].map(|k| bounds.min[k] - step * aside[k]);
        let mut blocks = [0; 2];
        for k in 0..2 {
            let squares = (bounds.max[k] - origin[k]) / step + 2.0;
            // False for NaN, too.
            let few = squares < MOST;
            if !few {
                return None;
            }
            blocks[k] = (squares / f64::from(BLOCK)).ceil() as u32;
        }
        Some(Self { origin, step, blocks })
    }

    fn at(&self, axis: usize, number: u32) -> f64 {
        self.origin[axis] + self.step * f64::from(number)
    }

    /// The box of some blocks, widened on all sides.
    pub fn bounds(&self, place: [u32; 2], size: u32, pad: f64) -> Box3 {
        let end = |k: usize, n: u32| self.at(k, n * BLOCK);
        Box3 {
            min: [(end(0, place[0]) - pad).next_down(), (end(1, place[1]) - pad).next_down(), 0.0],
            max: [(end(0, place[0] + size) + pad).next_up(), (end(1, place[1] + size) + pad).next_up(), 0.0],
        }
    }

    /// The square that contains a point.
    pub fn square(&self, p: [f64; 2]) -> [i64; 2] {
        [0, 1].map(|k| ((p[k] - self.origin[k]) / self.step).floor() as i64)
    }

    /// The number of the edge along an axis from a point of the lattice.
    fn edge(&self, axis: usize, [i, j]: [u32; 2]) -> u64 {
        2 * (u64::from(i) + (u64::from(self.blocks[0] * BLOCK) + 1) * u64::from(j)) + axis as u64
    }
}

/// A block that the curve may pass.
pub(super) struct ContourBlock {
    pub place: [u32; 2],
    /// The field's tape, pruned to the surroundings of the block.
    pub tape: Arc<Tape>,
    /// The crossed edges that the block owns, with their crossings.
    crossings: Vec<(u64, [f64; 2])>,
    /// From edge to edge, with inside on the left.
    links: Vec<(u64, u64)>,
    /// The links as rows of crossings.
    pub segments: Vec<[u32; 2]>,
}

/// The curves of a field on a lattice.
pub(super) struct TracedContours {
    pub lattice: ContourLattice,
    pub blocks: Vec<ContourBlock>,
    pub points: Vec<[f64; 2]>,
    /// Closed lines, as rows of points.
    pub lines: Vec<Vec<u32>>,
}

/// Traces the curves of a field. Ranges are taken over blocks widened by `pad`; the pruned tapes are valid
/// there.
pub(super) fn trace(
    tape: &Tape,
    lattice: ContourLattice,
    pad: f64,
    job: &Job,
) -> Result<Option<TracedContours>, LeafError> {
    let longest = lattice.blocks.iter().fold(1, |m, n| greater(*n, m));
    let mut size = longest.next_power_of_two();
    let mut blocks = vec![([0; 2], Arc::new(tape.clone()))];
    while size > 1 && !blocks.is_empty() {
        size /= 2;
        let parts = par_map(job, &blocks, |_, (place, tape)| {
            if job.is_cancelled() {
                Ok(Vec::new())
            } else {
                subdivide_blocks(*place, tape, &lattice, size, pad)
            }
        });
        blocks = parts.into_iter().collect::<Result<Vec<_>, _>>()?.concat();
    }
    let sampled = par_map(job, &blocks, |_, (place, tape)| {
        if job.is_cancelled() { Ok(None) } else { sample_block(*place, tape, &lattice).map(Some) }
    });
    if job.is_cancelled() {
        return Ok(None);
    }
    let mut blocks: Vec<ContourBlock> =
        sampled.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
    let mut crossings: Vec<(u64, [f64; 2])> =
        blocks.iter_mut().flat_map(|block| std::mem::take(&mut block.crossings)).collect();
    crossings.sort_unstable_by_key(|crossing| crossing.0);
    let row = |edge: u64| crossings.binary_search_by_key(&edge, |crossing| crossing.0).ok();
    let mut next = vec![u32::MAX; crossings.len()];
    for block in &mut blocks {
        for (from, to) in std::mem::take(&mut block.links) {
            // The block with the edge was dropped by its range, but a neighbour has found a crossing on it.
            let (Some(from), Some(to)) = (row(from), row(to)) else { return Err(contradiction()) };
            next[from] = to as u32;
            block.segments.push([from as u32, to as u32]);
        }
    }
    if next.contains(&u32::MAX) {
        return Err(contradiction());
    }
    // Each crossing has one link to the next, so the links form closed lines.
    let mut seen = vec![false; next.len()];
    let mut lines = Vec::new();
    for start in 0..next.len() {
        let mut line = Vec::new();
        let mut at = start;
        while !seen[at] {
            seen[at] = true;
            line.push(at as u32);
            at = next[at] as usize;
        }
        if !line.is_empty() {
            lines.push(line);
        }
    }
    Ok(Some(TracedContours {
        lattice,
        blocks,
        points: crossings.into_iter().map(|crossing| crossing.1).collect(),
        lines,
    }))
}

fn contradiction() -> LeafError {
    LeafError::new(
        "a leaf contradicts itself: a value lies outside of the range that it gave for a box around the point",
    )
}

type BlockTape = ([u32; 2], Arc<Tape>);

/// The quarters of some blocks that the curve may pass.
fn subdivide_blocks(
    place: [u32; 2],
    tape: &Arc<Tape>,
    lattice: &ContourLattice,
    size: u32,
    pad: f64,
) -> Result<Vec<BlockTape>, LeafError> {
    let mut quarters = Vec::new();
    for n in 0..4 {
        let quarter = [place[0] + (n & 1) * size, place[1] + (n >> 1) * size];
        if (0..2).any(|k| quarter[k] >= lattice.blocks[k]) {
            continue;
        }
        let (range, pruned) = tape.prune(&lattice.bounds(quarter, size, pad))?;
        let at_border = (0..2).any(|k| quarter[k] == 0 || quarter[k] + size >= lattice.blocks[k]);
        // If a part of the expression has no value, the range says nothing. The border of the lattice is
        // outside.
        if range.is_defined() && (range.lo() >= 0.0 || range.hi() < 0.0 && !at_border) {
            continue;
        }
        quarters.push((quarter, pruned.map_or_else(|| Arc::clone(tape), Arc::new)));
    }
    Ok(quarters)
}

/// Finds the signs of a block, and its crossed edges.
fn sample_block(
    place: [u32; 2],
    tape: &Arc<Tape>,
    lattice: &ContourLattice,
) -> Result<ContourBlock, LeafError> {
    let first = place.map(|n| n * BLOCK);
    let last = lattice.blocks.map(|n| n * BLOCK);
    let mut points = Vec::with_capacity(POINTS * POINTS);
    for j in 0..POINTS as u32 {
        points.extend(
            (0..POINTS as u32).map(|i| [lattice.at(0, first[0] + i), lattice.at(1, first[1] + j), 0.0]),
        );
    }
    let mut values = vec![0.0; points.len()];
    tape.at(&points, &mut values)?;
    let inside = |[i, j]: [u32; 2]| {
        let at = [first[0] + i, first[1] + j];
        // Samples at the border of the lattice count as outside, so that all lines are closed.
        let at_border = (0..2).any(|k| at[k] == 0 || at[k] == last[k]);
        !at_border && values[i as usize + POINTS * j as usize] < 0.0
    };
    let number = |(axis, [i, j]): (usize, [u32; 2])| lattice.edge(axis, [first[0] + i, first[1] + j]);
    let (mut edges, mut links) = (Vec::new(), Vec::new());
    for j in 0..BLOCK {
        for i in 0..BLOCK {
            for axis in 0..2 {
                let ahead = [i + u32::from(axis == 0), j + u32::from(axis == 1)];
                if inside([i, j]) != inside(ahead) {
                    edges.push((axis, [i, j], inside([i, j])));
                }
            }
            let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(inside);
            let sides = [(0, [i, j]), (1, [i + 1, j]), (0, [i, j + 1]), (1, [i, j])];
            square_segments(corners, |from, to| links.push((number(sides[from]), number(sides[to]))));
        }
    }
    let crossings = find_crossings(tape, lattice, first, &edges)?;
    let crossings = edges.iter().map(|(axis, at, _)| number((*axis, *at))).zip(crossings).collect();
    Ok(ContourBlock { place, tape: Arc::clone(tape), crossings, links, segments: Vec::new() })
}

/// Finds the crossings of edges, by bisecting all at once.
fn find_crossings(
    tape: &Tape,
    lattice: &ContourLattice,
    first: [u32; 2],
    edges: &[(usize, [u32; 2], bool)],
) -> Result<Vec<[f64; 2]>, LeafError> {
    let mut parts = vec![[0.0, 1.0]; edges.len()];
    let point = |(axis, [i, j], _): &(usize, [u32; 2], bool), part: f64| {
        let mut p = [lattice.at(0, first[0] + i), lattice.at(1, first[1] + j)];
        p[*axis] += part * lattice.step;
        p
    };
    let mut points = vec![[0.0; 3]; edges.len()];
    let mut values = vec![0.0; edges.len()];
    for _ in 0..HALVINGS {
        for ((edge, part), out) in edges.iter().zip(&parts).zip(&mut points) {
            let [x, y] = point(edge, 0.5 * (part[0] + part[1]));
            *out = [x, y, 0.0];
        }
        tape.at(&points, &mut values)?;
        for ((edge, part), value) in edges.iter().zip(&mut parts).zip(&values) {
            // The end whose side the middle has moves there.
            let end = usize::from((*value < 0.0) != edge.2);
            part[end] = 0.5 * (part[0] + part[1]);
        }
    }
    Ok(edges
        .iter()
        .zip(&parts)
        .map(|(edge, part)| point(edge, part[0].clamp(MARGIN, 1.0 - MARGIN)))
        .collect())
}
