//! `LoopMesher`: splits sides until every leaf is within its allowance.
use super::cell::{LoopCell, LoopCellShape};
use super::leaf::{LeafBound, LoopLeaf, LoopVertex};
use crate::budget::{Failure, Job, Progress, RefusalCode, par_map};
use crate::convert::patches::allowance::{
    Allowance, InfeasibleTolerance, TessellationFailure, refuse_tolerance,
};
use crate::convert::patches::texcoords::SheetTexcoords;
use crate::explicit::{LimitSheet, LimitSurface};
use crate::math::{Orientation, greater, orient2d};
use std::collections::{BTreeMap, BTreeSet};

/// A limit surface of triangles, with one initial leaf per sheet.
pub(crate) struct LoopMesher<'a> {
    cells: Vec<LoopCell<'a>>,
    leaves: Vec<LoopLeaf>,
    vertices: Vec<LoopVertex>,
    /// Lines below this number are edges of the cage.
    pub(crate) n_edges: u32,
    job: &'a Job,
    /// The same sheets in the texture plane.
    pub(crate) texcoords: Option<&'a SheetTexcoords<'a>>,
}

/// Leaves that are proved to be within their allowance.
pub(crate) struct CertifiedLeaves<'a> {
    pub(crate) cells: Vec<LoopCell<'a>>,
    pub(crate) vertices: Vec<LoopVertex>,
    pub(crate) leaves: Vec<(LoopLeaf, LeafBound)>,
    pub(crate) texcoords: Option<&'a SheetTexcoords<'a>>,
}

/// The largest number of passes; each halves the width of the worst leaf in one direction.
const MOST_PASSES: usize = 400;
/// The narrowest leaf, in its longer direction: 2⁻⁴⁰ of a sheet is below any useful length. In the other
/// direction parameters may be rounded in the end, by less than the proof allows.
const NARROWEST: f64 = 1.0 / (1_u64 << 40) as f64;
/// Rounds of flipping diagonals between new leaves after each pass. Chosen: a third would flip few.
const FLIPS: usize = 2;
/// A diagonal is flipped if the worse of both leaves improves by this factor. Chosen: smaller gains save no triangles.
const WORTH_A_FLIP: f64 = 0.97;
/// If a leaf misses its tolerance by this factor, more than its worst side is split at once. Chosen: it needs several
/// splits anyway.
const FAR_OFF: f64 = 8.0;
/// Then the sides with at least this fraction of the worst bending are split. Chosen: they would be split soon.
const ALSO_BENT: f64 = 0.6;
/// The weight of a side shared with an extraordinary leaf. Chosen: less than 1, since all sides of that leaf would be
/// split.
const UNWANTED: f64 = 0.5;

impl<'a> LoopMesher<'a> {
    pub(crate) fn new(limit: &LimitSurface<'_>, sheets: &'a [LimitSheet], job: &'a Job) -> Self {
        let (cage, table) = (limit.cage(), limit.edges());
        let n_edges = table.ends.len() as u32;
        let mut number = vec![u32::MAX; cage.positions().len()];
        let (mut cells, mut leaves, mut vertices) = (Vec::new(), Vec::new(), Vec::new());
        for (index, sheet) in sheets.iter().enumerate() {
            let Some(triangle) = sheet.triangle() else { continue };
            let (face, _) = limit.face_of(index);
            let cell = LoopCell {
                sheet: index as u32,
                shape: LoopCellShape::from_triangle(triangle),
                begin: [0.0; 2],
                scale: 1.0,
            };
            let mut own = [0; 3];
            for (k, vertex) in cage.face(face).iter().enumerate() {
                let number = &mut number[*vertex as usize];
                if *number == u32::MAX {
                    *number = vertices.len() as u32;
                    let place = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]][k];
                    vertices
                        .push(LoopVertex { at: cell.shape.point(place), off: cell.shape.rounding_error() });
                }
                own[k] = *number;
            }
            let lines = [0, 1, 2].map(|k| table.of_corner[cage.begin(face) + k]);
            leaves.push(LoopLeaf::whole_cell(cells.len() as u32, own, lines));
            cells.push(cell);
        }
        Self { cells, leaves, vertices, texcoords: None, n_edges, job }
    }

    /// The longest diagonal of a sheet's hull, at least the error of rounding; 1 if all sheets are points.
    pub(crate) fn longest_diagonal(&self) -> f64 {
        let longest = self.cells.iter().fold(0.0_f64, |most, cell| {
            most.max(cell.bounding_box().diagonal()).max(cell.shape.rounding_error())
        });
        if longest > 0.0 { longest } else { 1.0 }
    }

    /// An estimate of the least number of triangles for an allowance, from whole sheets.
    pub(crate) fn estimate(&self, allowance: &Allowance) -> Result<f64, TessellationFailure> {
        let of_leaf = |leaf: &LoopLeaf| -> Result<f64, InfeasibleTolerance> {
            let cell = &self.cells[leaf.cell as usize];
            let (leaf_bound, sides) = match leaf.certify(cell, &self.vertices, allowance) {
                Ok(leaf_bound) => (leaf_bound, leaf_bound.sides),
                Err(refused) => match refused.0 {
                    InfeasibleTolerance::TooClose(_) => return Ok(1.0),
                    obstacle => return Err(obstacle),
                },
            };
            let Some(allowed) = allowance.at(&leaf_bound.place).filter(|_| !leaf_bound.is_met) else {
                return Ok(1.0);
            };
            if matches!(cell.shape, LoopCellShape::Extraordinary(_)) {
                return Ok(1.0);
            }
            // A side that bends by w is cut into √(w / 4 tolerances) parts; two directions are enough to
            // count.
            let cuts = sides.map(|bend| {
                let cuts = (0.25 * bend / allowed).sqrt();
                greater(cuts, 1.0)
            });
            let most = cuts.iter().fold(1.0_f64, |most, x| most.max(*x));
            let least = cuts.iter().fold(most, |least, x| least.min(*x));
            Ok(most * least)
        };
        let parts = par_map(self.job, &self.leaves, |_, leaf| of_leaf(leaf));
        parts.into_iter().try_fold(0.0, |sum, part| Ok(sum + part.map_err(refuse_tolerance)?))
    }

    /// Splits sides until every leaf is within its allowance; `None` if that takes more than `most` triangles.
    pub(crate) fn refine(
        &self,
        allowance: &Allowance,
        most: u64,
    ) -> Result<Option<CertifiedLeaves<'a>>, TessellationFailure> {
        let mut work = LoopRefinement {
            cells: self.cells.clone(),
            vertices: self.vertices.clone(),
            leaves: self.leaves.iter().map(|leaf| (*leaf, None)).collect(),
            n_edges: self.n_edges,
        };
        for _ in 0..MOST_PASSES {
            if self.job.is_cancelled() {
                return Err(Failure::Cancelled);
            }
            if work.leaves.len() as u64 > most {
                return Ok(None);
            }
            work.certify_new(allowance, self.job)?;
            self.job.report(Progress {
                stage: "tessellate",
                done: work
                    .leaves
                    .iter()
                    .filter(|(_, leaf_bound)| leaf_bound.is_some_and(|leaf_bound| leaf_bound.is_met))
                    .count() as u64,
                total: work.leaves.len() as u64,
            });
            let marked = work.sides_to_split(allowance);
            if marked.is_empty() {
                let leaves =
                    work.leaves.into_iter().filter_map(|(leaf, leaf_bound)| Some((leaf, leaf_bound?)));
                let (cells, vertices) = (work.cells, work.vertices);
                return Ok(Some(CertifiedLeaves {
                    cells,
                    vertices,
                    leaves: leaves.collect(),
                    texcoords: self.texcoords,
                }));
            }
            work.split(marked, self.job);
            for _ in 0..FLIPS {
                work.flip(self.job);
            }
        }
        Err(too_small())
    }
}

impl CertifiedLeaves<'_> {
    pub(crate) fn bound(&self) -> f64 {
        self.leaves.iter().fold(0.0, |most, (_, leaf_bound)| greater(leaf_bound.bound, most))
    }
}

fn too_small() -> TessellationFailure {
    let message = "the budget is so small that rounding hides whether it is met";
    Failure::refused(RefusalCode::BelowPrecision, message)
}

/// The sides to split, by line and vertices, and the new vertex of each.
type SideSplits = BTreeMap<[u32; 3], u32>;

struct LoopRefinement<'a> {
    cells: Vec<LoopCell<'a>>,
    vertices: Vec<LoopVertex>,
    leaves: Vec<(LoopLeaf, Option<LeafBound>)>,
    n_edges: u32,
}

impl<'a> LoopRefinement<'a> {
    /// Certifies new leaves.
    fn certify_new(&mut self, allowance: &Allowance, job: &Job) -> Result<(), TessellationFailure> {
        let open: Vec<usize> = (0..self.leaves.len()).filter(|i| self.leaves[*i].1.is_none()).collect();
        let leaf_bounds = par_map(job, &open, |_, i| {
            let leaf = &self.leaves[*i].0;
            let cell = &self.cells[leaf.cell as usize];
            let is_narrow = leaf.width(cell) < NARROWEST;
            match leaf.certify(cell, &self.vertices, allowance) {
                Ok(leaf_bound) if !leaf_bound.is_met && is_narrow => Err(too_small()),
                Err(refused) => match *refused {
                    // Smaller leaves may be farther from the eye.
                    (InfeasibleTolerance::TooClose(_), leaf_bound) if !is_narrow => Ok(leaf_bound),
                    (obstacle, _) => Err(refuse_tolerance(obstacle)),
                },
                Ok(leaf_bound) => Ok(leaf_bound),
            }
        });
        for (i, leaf_bound) in open.into_iter().zip(leaf_bounds) {
            self.leaves[i].1 = Some(leaf_bound?);
        }
        Ok(())
    }

    /// The sides to split. For extraordinary leaves these are all sides or none; for other leaves far above their allowance
    /// the sides with the largest bending. For every other leaf it is one side, the worst first, and no other side of its
    /// neighbour in the same pass: that one split may suffice for both.
    fn sides_to_split(&self, allowance: &Allowance) -> SideSplits {
        let mut marked = SideSplits::new();
        let is_rough =
            |leaf: &LoopLeaf| matches!(self.cells[leaf.cell as usize].shape, LoopCellShape::Extraordinary(_));
        let extraordinary: Vec<&LoopLeaf> =
            self.leaves.iter().map(|(leaf, _)| leaf).filter(|leaf| is_rough(leaf)).collect();
        let rough_sides: BTreeSet<[u32; 3]> =
            extraordinary.iter().flat_map(|leaf| [0, 1, 2].map(|side| leaf.side(side))).collect();
        // The factor, the leaf, and the side.
        let mut single_sides: Vec<(f64, usize, [u32; 3])> = Vec::new();
        for (index, (leaf, leaf_bound)) in self.leaves.iter().enumerate() {
            let Some(leaf_bound) = leaf_bound.as_ref().filter(|leaf_bound| !leaf_bound.is_met) else {
                continue;
            };
            let is_shared = [0, 1, 2].map(|side| rough_sides.contains(&leaf.side(side)));
            let bends =
                [0, 1, 2].map(|side| leaf_bound.sides[side] * if is_shared[side] { UNWANTED } else { 1.0 });
            let worst = (1..3).fold(0, |worst, side| if bends[side] > bends[worst] { side } else { worst });
            let is_far =
                allowance.at(&leaf_bound.place).is_none_or(|allowed| leaf_bound.bound > FAR_OFF * allowed);
            if is_far || is_rough(leaf) {
                let split = (0..3).filter(|side| bends[*side] >= ALSO_BENT * bends[worst] || is_rough(leaf));
                split.for_each(|side| _ = marked.insert(leaf.side(side), u32::MAX));
            } else if is_shared[worst] {
                marked.insert(leaf.side(worst), u32::MAX);
            } else {
                single_sides.push((bends[worst], index, leaf.side(worst)));
            }
        }
        // A split extraordinary leaf may split a side of the next one, and so on.
        loop {
            let before = marked.len();
            for leaf in &extraordinary {
                let sides = [0, 1, 2].map(|side| leaf.side(side));
                if sides.iter().any(|side| marked.contains_key(side)) {
                    sides.iter().for_each(|side| _ = marked.entry(*side).or_insert(u32::MAX));
                }
            }
            if marked.len() == before {
                break;
            }
        }
        let mut owners: BTreeMap<[u32; 3], Vec<usize>> =
            single_sides.iter().map(|(_, _, side)| (*side, Vec::new())).collect();
        let mut is_busy = vec![false; self.leaves.len()];
        for (index, (leaf, _)) in self.leaves.iter().enumerate() {
            for side in 0..3 {
                let side = leaf.side(side);
                is_busy[index] |= marked.contains_key(&side);
                if let Some(owners) = owners.get_mut(&side) {
                    owners.push(index);
                }
            }
        }
        // The worst first. A leaf that changes now is judged again before another of its sides is split.
        single_sides.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        for (_, _, side) in single_sides {
            let owners = &owners[&side];
            if owners.iter().all(|owner| !is_busy[*owner]) {
                owners.iter().for_each(|owner| is_busy[*owner] = true);
                marked.insert(side, u32::MAX);
            }
        }
        marked
    }

    /// Splits these sides in the middle.
    fn split(&mut self, mut marked: SideSplits, job: &Job) {
        // Each vertex is computed from the first leaf with its side.
        let mut new_vertices: Vec<(usize, usize)> = Vec::with_capacity(marked.len());
        for (index, (leaf, _)) in self.leaves.iter().enumerate() {
            for side in 0..3 {
                if let Some(vertex) = marked.get_mut(&leaf.side(side)).filter(|vertex| **vertex == u32::MAX) {
                    *vertex = (self.vertices.len() + new_vertices.len()) as u32;
                    new_vertices.push((index, side));
                }
            }
        }
        let new_vertices = par_map(job, &new_vertices, |_, (index, side)| {
            let leaf = &self.leaves[*index].0;
            let shape = &self.cells[leaf.cell as usize].shape;
            LoopVertex { at: shape.point(leaf.middle(*side)), off: shape.rounding_error() }
        });
        self.vertices.extend(new_vertices);
        let leaves = std::mem::take(&mut self.leaves);
        self.leaves.reserve(leaves.len() + 2 * marked.len());
        for (leaf, leaf_bound) in leaves {
            let new = [0, 1, 2].map(|side| marked.get(&leaf.side(side)).copied());
            match (new, leaf_bound) {
                ([None, None, None], _) => self.leaves.push((leaf, leaf_bound)),
                ([Some(a), Some(b), Some(c)], _)
                    if matches!(self.cells[leaf.cell as usize].shape, LoopCellShape::Extraordinary(_)) =>
                {
                    self.quarter(&leaf, [a, b, c]);
                }
                (_, leaf_bound) => {
                    let bends = leaf_bound.map_or([1.0; 3], |leaf_bound| leaf_bound.sides);
                    self.halve(leaf, new, bends);
                }
            }
        }
    }

    /// Flips diagonals between new leaves of one cell if that brings them nearer to the surface.
    fn flip(&mut self, job: &Job) {
        let mut owners: BTreeMap<[u32; 3], Vec<(usize, usize)>> = BTreeMap::new();
        for (index, (leaf, leaf_bound)) in self.leaves.iter().enumerate() {
            // Only leaves without a bound, so that no proof is lost.
            if leaf_bound.is_none()
                && matches!(self.cells[leaf.cell as usize].shape, LoopCellShape::Polynomial(_))
            {
                let inside = self.interior_line(leaf);
                for side in (0..3).filter(|side| leaf.lines[*side] == inside) {
                    owners.entry(leaf.side(side)).or_default().push((index, side));
                }
            }
        }
        let pairs: Vec<[(usize, usize); 2]> = owners
            .into_values()
            .filter_map(|owners| <[_; 2]>::try_from(owners).ok())
            .filter(|[a, b]| self.leaves[a.0].0.cell == self.leaves[b.0].0.cell)
            .collect();
        let flipped = par_map(job, &pairs, |_, pair| self.flip_if_better(*pair));
        let mut better: Vec<(f64, usize, [LoopLeaf; 2])> = Vec::new();
        for (k, flipped) in flipped.into_iter().enumerate() {
            better.extend(flipped.map(|(gain, leaves)| (gain, k, leaves)));
        }
        // The best flips first; each leaf takes part in one.
        better.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut is_done = vec![false; self.leaves.len()];
        for (_, k, leaves) in better {
            let [(a, _), (b, _)] = pairs[k];
            if !is_done[a] && !is_done[b] {
                (is_done[a], is_done[b]) = (true, true);
                (self.leaves[a].0, self.leaves[b].0) = (leaves[0], leaves[1]);
            }
        }
    }

    /// Two leaves with the flipped diagonal, if that is better, and the factor of improvement.
    fn flip_if_better(&self, [(first, s), (second, t)]: [(usize, usize); 2]) -> Option<(f64, [LoopLeaf; 2])> {
        let (one, two) = (&self.leaves[first].0, &self.leaves[second].0);
        let inside = self.interior_line(one);
        // Counter-clockwise a, d, b, c, with the diagonal from a to b.
        //        c                c
        //      /   \            / | \
        //     a --- b    →     a  |  b
        //      \   /            \ | /
        //        d                d
        let [(a, b), (c, d)] = [(s, (s + 1) % 3), ((s + 2) % 3, (t + 2) % 3)];
        let part = |places: [[f64; 2]; 3], vertices: [u32; 3], lines: [u32; 3]| LoopLeaf {
            cell: one.cell,
            places,
            vertices,
            lines,
        };
        let (at, ids) = (one.places, one.vertices);
        let (far, far_id) = (two.places[d], two.vertices[d]);
        let flipped = [
            part(
                [at[a], far, at[c]],
                [ids[a], far_id, ids[c]],
                [two.lines[(t + 1) % 3], inside, one.lines[(s + 2) % 3]],
            ),
            part(
                [far, at[b], at[c]],
                [far_id, ids[b], ids[c]],
                [two.lines[(t + 2) % 3], one.lines[(s + 1) % 3], inside],
            ),
        ];
        let is_turned = |leaf: &LoopLeaf| {
            let [p, q, r] = leaf.places;
            orient2d(p, q, r) == Orientation::Front
        };
        if !flipped.iter().all(is_turned) {
            return None;
        }
        let worse = |leaves: [&LoopLeaf; 2]| {
            let [a, b] = leaves
                .map(|leaf| leaf.second_derivative_bound(&self.cells[leaf.cell as usize], &self.vertices));
            greater(a, b)
        };
        let (before, after) = (worse([one, two]), worse([&flipped[0], &flipped[1]]));
        (after < WORTH_A_FLIP * before).then_some((after / before, flipped))
    }

    fn interior_line(&self, leaf: &LoopLeaf) -> u32 {
        self.n_edges + self.cells[leaf.cell as usize].sheet
    }

    /// Splits a leaf that covers a whole extraordinary cell into quarters.
    fn quarter(&mut self, leaf: &LoopLeaf, [ab, bc, ca]: [u32; 3]) {
        let ([a, b, c], [l, m, n]) = (leaf.vertices, leaf.lines);
        let i = self.interior_line(leaf);
        let parts = [
            ([a, ab, ca], [l, i, n]),
            ([ab, b, bc], [l, m, i]),
            ([ca, bc, c], [i, m, n]),
            ([bc, ca, ab], [i, i, i]),
        ];
        let cells = self.cells[leaf.cell as usize].quarters();
        for (cell, (vertices, lines)) in cells.into_iter().zip(parts) {
            self.leaves.push((LoopLeaf::whole_cell(self.cells.len() as u32, vertices, lines), None));
            self.cells.push(cell);
        }
    }

    /// Halves a leaf at the middle of the side with the largest bending, and its halves if they must be split.
    fn halve(&mut self, leaf: LoopLeaf, new: [Option<u32>; 3], bends: [f64; 3]) {
        let worst =
            (0..3).filter(|side| new[*side].is_some()).reduce(|a, b| if bends[b] > bends[a] { b } else { a });
        let Some((side, vertex)) = worst.and_then(|side| Some((side, new[side]?))) else {
            self.leaves.push((leaf, None));
            return;
        };
        let (next, last) = ((side + 1) % 3, (side + 2) % 3);
        let (place, inside) = (leaf.middle(side), self.interior_line(&leaf));
        // Each half keeps one end of the side, and has the middle in place of the other.
        let (mut first, mut second) = (leaf, leaf);
        (first.vertices[next], first.places[next], first.lines[next]) = (vertex, place, inside);
        (second.vertices[side], second.places[side], second.lines[last]) = (vertex, place, inside);
        let (mut of_first, mut of_second) = ([None; 3], [None; 3]);
        of_first[last] = new[last];
        of_second[next] = new[next];
        self.halve(first, of_first, bends);
        self.halve(second, of_second, bends);
    }
}
