//! `SurfaceMapping`: cells that map two surfaces onto each other, face by face, and the bound that follows.
//!
//! Let `S` be the source and `M` the result, in this module as abstract surfaces: triangles that are glued where
//! [`FanSurface`] says so. `K` is made of cells: every face of `S` is cut into triangles, glued along the edges of `S`
//! where the cut edges are the same. `ρ` and `ψ` map every cell affinely, to points of `S` and to points of `M`;
//! images may be degenerate. At a point `k = Σ λᵢ kᵢ` of a cell, `|ρ(k) − ψ(k)| ≤ Σ λᵢ |ρ(kᵢ) − ψ(kᵢ)|`, which is at
//! most the largest displacement at the corners of the cell. That is all that is used about distances.
//!
//! *Cells.* Corners are the vertices of `S`, each with its image, a point of the closed face that is its label;
//! crossings, a point of an edge of `S` with a point of an edge of `M`; and cones. Along an edge of `S` its walk
//! (`paths.rs`) leaves the label of one end through edges of `M`, one crossing for each, and ends in the label of the
//! other, with parameters in ascending order. Around a face of `S` the walks of its three edges are a closed word of
//! half-edges of `M`. Equal neighbours of opposite directions cancel, which matches crossings without interleaving.
//! Matched ones are joined by chords, which therefore do not cross.
//! - If nothing is left, every piece between chords has all its corners in one face of `M`, a convex set, and is cut
//!   into a fan. `ρ` maps the fans onto the convex face of `S`.
//! - Otherwise some half-edges that follow each other are spokes of one vertex `w` of `M`, whose faces close around it.
//!   A cone `k` is added with `ψ(k) = w` and any `ρ(k)` in the face: between two spokes that follow each other the border
//!   runs in a face that has both, so `w` is a corner of it, and `k` with that part of the border is cut into cells in
//!   that face. What is left of the face of `S`, as an abstract disk, has in place of that part a border that goes around
//!   `w` the other way, through the other spokes; all its points have `ρ = ρ(k)` and `ψ = w`. Its word is cut into cells
//!   in the same way, until none is left. A turn is chosen where that makes the word shorter.
//! - Where no turn does, the face has no cells, and is left to the search.
//!
//! `ρ` maps the disk to the convex face, and once around its border, so it is onto it, wherever the cones are. So all of
//! a face of `S` with cells is near `M`: within the largest displacement at its corners, crossings and cones.
//!
//! *The way back.* Let `C = ψ(K)` as a chain modulo 2: how often cells cover each point. Its border is in the images
//! of those edges of `S` that an odd number of faces with cells have. Call the faces of `M` through which walks of such
//! edges pass, with the labels of their ends, *touched*. Inside a face that is not touched the number is constant; and
//! it is equal in two such faces that share an edge, since no point of the edge is in the image of a walk that touches
//! neither. It is counted at a vertex `w` all of whose faces are not touched and close around it. To count there, move
//! images of vertices a little into their labels and crossings a little into their edges: that changes the chain in
//! touched faces alone. Then cells meet `w` only where it is that of a cone, around which the spokes of the border and
//! those of the other way run once in all: each face around is covered once, the one way around or the other. If the
//! number of cones at `w` is odd, each of those faces is covered, and all of it is near `S`: within the largest
//! displacement at corners of cells that lie in it.
//!
//! No predicate and no rounded number decides about the topology: labels, walks and words are indices. Displacements
//! are rounded up (`crossing.rs`, `distance.rs`), for points that are exact as given by their weights and parameters.
//!
//! Source: the composition of maps and its bound at vertices, J. Cohen, D. Manocha, M. Olano, *Simplifying polygonal
//! models using successive mappings*, 1997, where maps are bijections; that a degree is enough is derived here.
use super::super::distance::distance_up;
use super::far_points::FarPoints;
use super::images::VertexImage;
use super::paths::EdgePaths;
use super::surface::{FanSurface, NONE};
use crate::budget::{Job, par_map};
use crate::explicit::{DisjointSets, next_in_face, previous_in_face};
use crate::math::{greater, lesser};

/// A bound for each face, from the cells.
pub(super) struct SurfaceMapping {
    /// By face of the source: no point of it is farther from the result; infinite if unknown.
    pub forward: Vec<f64>,
    /// By face of the result: no point of it is farther from the source; infinite if unknown.
    pub backward: Vec<f64>,
    /// The candidates for the farthest point of the source from the result, and of the result from the
    /// source.
    pub farthest: [FarPoints; 2],
}

/// Faces in one task.
const CHUNK: usize = 1 << 12;

/// The cells of some faces.
#[derive(Default)]
struct CellPart {
    forward: Vec<f64>,
    cones: Vec<Cone>,
}

/// A vertex of the result that is the image of a point in a face of the source.
#[derive(Clone, Copy)]
struct Cone {
    v: u32,
    up: f64,
}

/// Half-edges of a word that follow each other around one vertex of the result.
#[derive(Clone, Copy)]
struct Turn {
    v: u32,
    /// The index of the first one, and their number.
    from: usize,
    n: usize,
    /// Whether they start at the vertex; otherwise they end there.
    is_at_start: bool,
}

/// The most cones in one face. Chosen: faces that need more are left to the search.
const MOST_CONES: usize = 32;

/// Cuts every face of the source into cells.
pub(super) fn surface_mapping(
    source: &FanSurface,
    result: &FanSurface,
    images: &[VertexImage],
    (paths, job): (&EdgePaths, &Job),
) -> SurfaceMapping {
    let up = |(v, image): (usize, &VertexImage)| match image.face {
        NONE => f64::INFINITY,
        face => distance_up(source.at(v as u32), &result.corners(face)),
    };
    let vertex_up: Vec<f64> = images.iter().enumerate().map(up).collect();
    // Around an open vertex there is no other way to go, so it never takes a turn.
    let degree: Vec<u32> = (0..result.n_vertices() as u32)
        .map(|v| if result.is_open(v) { 0 } else { result.ring(v).count() as u32 })
        .collect();
    let faces: Vec<u32> = (0..source.n_faces() as u32).collect();
    let chunks: Vec<&[u32]> = faces.chunks(CHUNK).collect();
    let parts = par_map(job, &chunks, |_, faces| {
        let mut part = CellPart::default();
        let word = Vec::new();
        let mut cutter =
            CellCutter { source, result, images, paths, degree: &degree, vertex_up: &vertex_up, word };
        for face in *faces {
            let up = cutter.cut(*face, &mut part.cones).unwrap_or(f64::INFINITY);
            part.forward.push(up);
        }
        part
    });
    let forward: Vec<f64> = parts.iter().flat_map(|part| part.forward.iter().copied()).collect();
    let cones: Vec<Cone> = parts.into_iter().flat_map(|part| part.cones).collect();

    // The largest displacement in each face of the result.
    let mut backward = vec![0.0; result.n_faces()];
    let mut raise = |face: u32, up: f64| {
        let most: &mut f64 = &mut backward[face as usize];
        *most = greater(*most, up);
    };
    for (v, image) in images.iter().enumerate().filter(|(_, image)| image.face != NONE) {
        raise(image.face, vertex_up[v]);
    }
    // A crossing is on an edge, and thus in both of its faces.
    for (h, up) in paths.crossed.iter().zip(&paths.up) {
        raise(h / 3, *up);
        raise(result.twin(*h) / 3, *up);
    }
    for cone in &cones {
        result.ring(cone.v).for_each(|h| raise(h / 3, cone.up));
    }
    let covered = covered_faces(source, result, images, &Chain { paths, forward: &forward, cones: &cones });
    // Where the images don't cover a face, none of these displacements says anything about it.
    backward.iter_mut().zip(covered).for_each(|(up, covered)| {
        if !covered {
            *up = f64::INFINITY;
        }
    });
    let mut farthest = <[FarPoints; 2]>::default();
    let [of_source, of_result] = &mut farthest;
    for (v, up) in vertex_up.iter().enumerate() {
        of_source.add(*up, || (source.at(v as u32), 0.0));
    }
    for (i, up) in paths.up.iter().enumerate() {
        of_source.add(*up, || paths.at(i as u32, source, result)[0]);
        of_result.add(*up, || paths.at(i as u32, source, result)[1]);
    }
    for cone in &cones {
        of_result.add(cone.up, || (result.at(cone.v), 0.0));
    }
    SurfaceMapping { forward, backward, farthest }
}

struct CellCutter<'a> {
    source: &'a FanSurface,
    result: &'a FanSurface,
    images: &'a [VertexImage],
    paths: &'a EdgePaths,
    /// By vertex of the result: the number of its faces if they close around it, else 0.
    degree: &'a [u32],
    vertex_up: &'a [f64],
    word: Vec<u32>,
}

impl CellCutter<'_> {
    /// The largest displacement in the cells of a face; `None` if it has none.
    fn cut(&mut self, face: u32, cones: &mut Vec<Cone>) -> Option<f64> {
        let mut most = 0.0;
        self.word.clear();
        for h in 3 * face..3 * face + 3 {
            most = greater(most, self.vertex_up[self.source.start(h) as usize]);
            let edge = self.source.edge(h);
            // A walk is stored for one direction of its edge. From the other face it is read
            // backwards, and each crossing from its other side.
            let walk = self.paths.of(edge)?;
            most = self.paths.up[walk.clone()].iter().fold(most, |most, up| greater(most, *up));
            let crossed = &self.paths.crossed[walk];
            let [start, end] = [self.source.start(h), self.source.end(h)];
            let [mut current, last_face] = [start, end].map(|v| self.images[v as usize].face);
            for i in 0..crossed.len() {
                let g = if edge == h { crossed[i] } else { self.result.twin(crossed[crossed.len() - 1 - i]) };
                // The proof relies on walks that do go from face to face, so that is checked again here.
                if g / 3 != current {
                    return None;
                }
                current = self.result.twin(g) / 3;
                self.push(g);
            }
            if current != last_face {
                return None;
            }
        }
        if most == f64::INFINITY {
            return None;
        }
        let n_before = cones.len();
        let most = self.fill(face, most, cones);
        if most.is_none() {
            // Cones count only in faces with cells.
            cones.truncate(n_before);
        }
        most
    }

    /// Fills the word with cones; returns the largest displacement at them and at the corners before.
    fn fill(&mut self, face: u32, mut most: f64, cones: &mut Vec<Cone>) -> Option<f64> {
        // The word is cyclic, so a pair of opposite half-edges may be its first and last.
        for _ in 0..MOST_CONES {
            let mut word = &self.word[..];
            while let [first, middle @ .., last] = word
                && self.result.twin(*first) == *last
            {
                word = middle;
            }
            if word.is_empty() {
                return Some(most);
            }
            let turn = self.longest_turn(word)?;
            // word:   … a [s₁ s₂ … sₙ] b …     spokes of one vertex, from face to face
            // after:  b … a [the other spokes]   the same faces, the other way around
            let remaining =
                (turn.from + turn.n..turn.from + word.len()).map(|i| word[i % word.len()]).collect();
            let first = word[turn.from];
            self.word = remaining;
            // Go the other way around the vertex, from the same face to the same face.
            let mut h = first;
            for _ in turn.n..self.degree[turn.v as usize] as usize {
                let leaves = if turn.is_at_start { previous_in_face(h) } else { next_in_face(h) };
                self.push(leaves);
                h = self.result.twin(leaves);
            }
            let up = distance_up(self.result.at(turn.v), &self.source.corners(face));
            cones.push(Cone { v: turn.v, up });
            most = greater(most, up);
        }
        None
    }

    /// The turn that shortens a word the most when it goes the other way around its vertex.
    fn longest_turn(&self, word: &[u32]) -> Option<Turn> {
        let n = word.len();
        // Whether this half-edge and the next one start at the same vertex; otherwise both end at one.
        let at_start = |i: usize| word[(i + 1) % n] == next_in_face(self.result.twin(word[i % n]));
        // Start at an index where the vertex changes, so that no turn is cut in two; if it never does,
        // anywhere.
        let first = (0..n).find(|i| at_start(*i) != at_start(i + n - 1)).unwrap_or(0);
        let (mut best, mut i) = (None, 0);
        while i < n {
            let is_at_start = at_start(first + i);
            let mut steps = 1;
            while i + steps < n && at_start(first + i + steps) == is_at_start {
                steps += 1;
            }
            let from = (first + i) % n;
            let h = word[from];
            let v = if is_at_start { self.result.start(h) } else { self.result.end(h) };
            let around = self.degree[v as usize] as usize;
            // `steps` steps join one half-edge more than that, but never more than the word or the vertex
            // has.
            let spokes = lesser(lesser(steps + 1, n), around);
            let shorter = (2 * spokes).saturating_sub(around);
            if around > 0 && shorter > 0 && best.is_none_or(|(most, _)| shorter > most) {
                best = Some((shorter, Turn { v, from, n: spokes, is_at_start }));
            }
            i += steps;
        }
        best.map(|(_, turn)| turn)
    }

    fn push(&mut self, h: u32) {
        if self.word.last().is_some_and(|last| self.result.twin(*last) == h) {
            self.word.pop();
        } else {
            self.word.push(h);
        }
    }
}

/// The cells as a chain.
struct Chain<'a> {
    paths: &'a EdgePaths,
    forward: &'a [f64],
    cones: &'a [Cone],
}

/// Whether each face of the result is covered by cells, proved.
fn covered_faces(
    source: &FanSurface,
    result: &FanSurface,
    images: &[VertexImage],
    chain: &Chain<'_>,
) -> Vec<bool> {
    // 1. Faces in which the border of the chain may lie.
    let has_cells = |h: u32| h != NONE && chain.forward[h as usize / 3] < f64::INFINITY;
    let mut touched = vec![false; result.n_faces()];
    for h in 0..3 * source.n_faces() as u32 {
        // An edge counts once. With cells on both of its sides, or on neither, its image is no
        // border of the chain.
        if source.edge(h) != h || has_cells(h) == has_cells(source.twin(h)) {
            continue;
        }
        for v in [source.start(h), source.end(h)] {
            touched[images[v as usize].face as usize] = true;
        }
        // A face with cells has the walks of all its edges.
        for g in &chain.paths.crossed[chain.paths.of(h).unwrap_or_default()] {
            touched[*g as usize / 3] = true;
            touched[result.twin(*g) as usize / 3] = true;
        }
    }
    // 2. Sets of faces that are covered equally often.
    let mut sets = DisjointSets::new(result.n_faces());
    for h in 0..3 * result.n_faces() as u32 {
        let t = result.twin(h);
        if t != NONE && !touched[h as usize / 3] && !touched[t as usize / 3] {
            sets.union(h / 3, t / 3);
        }
    }
    // 3. How often the faces of a set are covered, counted at vertices inside it.
    let mut turns = vec![0_u32; result.n_vertices()];
    chain.cones.iter().for_each(|cone| turns[cone.v as usize] += 1);
    let mut is_covered: Vec<Option<bool>> = vec![None; result.n_faces()];
    for v in 0..result.n_vertices() as u32 {
        if result.is_open(v) || result.ring(v).any(|h| touched[h as usize / 3]) {
            continue;
        }
        // Each cone covers each face around its vertex once, so their number modulo 2 is the
        // coverage.
        let is_odd = turns[v as usize] % 2 == 1;
        let entry = &mut is_covered[sets.find(result.outgoing(v) / 3) as usize];
        debug_assert!(
            entry.is_none_or(|covered| covered == is_odd),
            "the cells around vertex {v} do not agree"
        );
        // Vertices of a set that disagree would mean a fault in the program; then nothing is proved.
        *entry = Some(entry.unwrap_or(true) && is_odd);
    }
    (0..result.n_faces() as u32)
        .map(|face| !touched[face as usize] && is_covered[sets.find(face) as usize] == Some(true))
        .collect()
}
