//! Triangles of a field divided where they are too far from its surface, and nowhere else.
//!
//! In rounds: an edge is split where its middle is farther away than what is aimed at, or a crease that it chords:
//! on the surface over its middle, or on the crease, where the planes that the field looks like from the edge's two
//! sides meet, provided the field is near 0 there. A triangle whose edges are good and whose middle is not is split along its longest edge.
//! Triangles follow by the number of their split edges. All this aims and proves nothing: the mesh stays closed and manifold
//! because edges are split for both their triangles, and how far it is from the surface is for `check` to say.
mod edges;

use super::ask::Ask;
use super::planes::between;
use crate::budget::Job;
use crate::explicit::Mesh;
use crate::implicit::{LeafError, Tape};
use crate::math::{cross, difference, dot, length};
use edges::{Cut, Edge, look};

type Point = [f64; 3];

/// Rounds at most: each halves what it splits.
const ROUNDS: usize = 14;
/// A triangle is split along its longest edge as well where that is longer than so many of the longest split one.
const LONG: f64 = 3.0;
/// Division is given up where there are more than so many triangles for each that there was,
const GROWTH: usize = 3;
/// and so many.
const FEW: usize = 2000;
/// No vertex.
const NONE: u32 = u32::MAX;

/// Divides triangles until all seem to be within `aim` of the surface, but for those whose vertices could not be put on it. `None`
/// where that takes several times as many, since the cells were too large then, and when the job is cancelled.
pub(super) fn refine(tape: &Tape, mesh: &Mesh, aim: f64, job: &Job) -> Result<Option<Mesh>, LeafError> {
    let ask = Ask { tape, job };
    let mut work = Work {
        positions: mesh.positions().to_vec(),
        faces: mesh.faces().to_vec(),
        fresh: vec![true; mesh.faces().len()],
        stuck: vec![false; mesh.positions().len()],
    };
    let most = GROWTH * mesh.faces().len() + FEW;
    for _ in 0..ROUNDS {
        if job.is_cancelled() || work.faces.len() > most {
            return Ok(None);
        }
        if !work.round(&ask, aim)? {
            break;
        }
    }
    let mesh = Mesh::new(work.positions, work.faces);
    Ok(Some(mesh.expect("vertices are checked to be finite, and faces to have them")))
}

struct Work {
    positions: Vec<Point>,
    faces: Vec<[u32; 3]>,
    /// Triangles that nobody has looked at.
    fresh: Vec<bool>,
    /// Vertices that could not be put on the surface: edges from them are left as they are.
    stuck: Vec<bool>,
}

/// An edge by numbers: its vertices, the lower first, and the half edges `3·face + corner` of both its triangles.
struct Known {
    ends: [u32; 2],
    halves: [u32; 2],
}

impl Work {
    /// One round; whether anything was split.
    fn round(&mut self, ask: &Ask, aim: f64) -> Result<bool, LeafError> {
        let known = self.edges();
        let edges: Vec<Edge> = known.iter().map(|edge| self.edge(edge)).collect();
        let cuts = look(ask, &edges, aim)?;
        // The edge of each half edge, where it was looked at.
        let mut edge_of = vec![NONE; 3 * self.faces.len()];
        for (k, edge) in known.iter().enumerate() {
            edge.halves.iter().for_each(|half| edge_of[*half as usize] = k as u32);
        }
        let free = |edge: &Known| edge.ends.iter().all(|v| !self.stuck[*v as usize]);
        let mut split: Vec<bool> =
            known.iter().zip(&cuts).map(|(edge, cut)| cut.error > aim && free(edge)).collect();
        self.middles(ask, &edge_of, aim, &mut split)?;
        self.longest(&edge_of, &mut split);
        if split.iter().all(|split| !split) {
            return Ok(false);
        }
        self.apply(ask, &Plan { known: &known, cuts: &cuts, split: &split, edge_of: &edge_of })?;
        Ok(true)
    }

    /// The edges of triangles that are fresh, in the order of their vertices.
    fn edges(&self) -> Vec<Known> {
        let mut halves: Vec<(u64, u32)> = Vec::with_capacity(3 * self.faces.len());
        for (f, face) in self.faces.iter().enumerate() {
            for c in 0..3 {
                let (a, b) = (face[c], face[(c + 1) % 3]);
                let (low, high) = if a < b { (a, b) } else { (b, a) };
                halves.push((u64::from(low) << 32 | u64::from(high), (3 * f + c) as u32));
            }
        }
        halves.sort_unstable();
        let twins = halves.chunk_by(|a, b| a.0 == b.0).filter(|pair| pair.len() == 2);
        twins
            .filter(|pair| pair.iter().any(|half| self.fresh[half.1 as usize / 3]))
            .map(|pair| Known {
                ends: [(pair[0].0 >> 32) as u32, pair[0].0 as u32],
                halves: [pair[0].1, pair[1].1],
            })
            .collect()
    }

    fn at(&self, vertex: u32) -> Point {
        self.positions[vertex as usize]
    }

    fn edge(&self, known: &Known) -> Edge {
        let across = known.halves.map(|half| {
            let (face, corner) = (half as usize / 3, half as usize % 3);
            self.at(self.faces[face][(corner + 2) % 3])
        });
        Edge { ends: known.ends.map(|v| self.at(v)), across }
    }

    fn corners(&self, face: usize) -> [Point; 3] {
        self.faces[face].map(|v| self.at(v))
    }

    /// Splits the longest edge of fresh triangles with good edges whose middles are too far.
    fn middles(&self, ask: &Ask, edge_of: &[u32], aim: f64, split: &mut [bool]) -> Result<(), LeafError> {
        let whole = |edge: u32| edge != NONE && !split[edge as usize];
        let free = |f: usize| self.faces[f].iter().all(|v| !self.stuck[*v as usize]);
        let good = |f: &usize| {
            self.fresh[*f] && free(*f) && edge_of[3 * f..3 * f + 3].iter().all(|edge| whole(*edge))
        };
        let faces: Vec<usize> = (0..self.faces.len()).filter(good).collect();
        let middles: Vec<Point> = faces.iter().map(|f| middle(self.corners(*f))).collect();
        for ((face, middle), plane) in faces.iter().zip(&middles).zip(ask.planes(&middles)?) {
            if plane.is_some_and(|plane| plane.over(*middle).abs() > aim) {
                split[edge_of[3 * face + longest(self.corners(*face))] as usize] = true;
            }
        }
        Ok(())
    }

    /// Marks long edges of triangles that are split elsewhere, so that triangles keep some shape.
    fn longest(&self, edge_of: &[u32], split: &mut [bool]) {
        let mut more = Vec::new();
        for face in 0..self.faces.len() {
            let edges = [0, 1, 2].map(|c| edge_of[3 * face + c]);
            let marked = |c: usize| edges[c] != NONE && split[edges[c] as usize];
            if !(0..3).any(marked) {
                continue;
            }
            let corners = self.corners(face);
            let size = |c: usize| length(difference(corners[(c + 1) % 3], corners[c]));
            let k = longest(corners);
            let most = (0..3).filter(|c| marked(*c)).map(size).fold(0.0, |a, b| if b > a { b } else { a });
            if edges[k] != NONE && !marked(k) && size(k) > LONG * most {
                more.push(edges[k]);
            }
        }
        more.into_iter().for_each(|k| split[k as usize] = true);
    }

    fn apply(&mut self, ask: &Ask, plan: &Plan) -> Result<(), LeafError> {
        let first = self.positions.len();
        let mut vertex_of = vec![NONE; plan.known.len()];
        // Where each new vertex lies when nothing is moved.
        let mut plain = Vec::new();
        for (k, edge) in plan.known.iter().enumerate().filter(|(k, _)| plan.split[*k]) {
            vertex_of[k] = self.positions.len() as u32;
            let [a, b] = edge.ends.map(|v| self.at(v));
            let place = plan.cuts[k].place;
            plain.push(between(a, b, 0.5));
            self.positions.push(if place.iter().all(|x| x.is_finite()) { place } else { between(a, b, 0.5) });
        }
        self.stuck.resize(self.positions.len(), false);
        let faces = std::mem::take(&mut self.faces);
        self.fresh.clear();
        for (f, face) in faces.iter().enumerate() {
            let cut = [0, 1, 2].map(|c| match plan.edge_of[3 * f + c] {
                NONE => NONE,
                edge => vertex_of[edge as usize],
            });
            self.divide(*face, cut);
            // What was looked at and left whole is done with.
            self.fresh.resize(self.faces.len(), cut != [NONE; 3]);
        }
        self.unfold(ask, first, &plain)
    }

    /// The triangles of one whose edges have new vertices.
    fn divide(&mut self, [a, b, c]: [u32; 3], cut: [u32; 3]) {
        match cut {
            [NONE, NONE, NONE] => self.faces.push([a, b, c]),
            [p, NONE, NONE] => self.faces.extend([[a, p, c], [p, b, c]]),
            [NONE, p, NONE] => self.faces.extend([[b, p, a], [p, c, a]]),
            [NONE, NONE, p] => self.faces.extend([[c, p, b], [p, a, b]]),
            [p, q, NONE] => self.tip(b, [q, c, a, p]),
            [NONE, p, q] => self.tip(c, [q, a, b, p]),
            [q, NONE, p] => self.tip(a, [q, b, c, p]),
            [p, q, r] => self.faces.extend([[a, p, r], [p, b, q], [r, q, c], [p, q, r]]),
        }
    }

    /// A triangle cut across: the tip, and the rest `p q r s`, of which `p` and `s` are on the edges from the tip, along its
    /// shorter diagonal.
    fn tip(&mut self, tip: u32, [p, q, r, s]: [u32; 4]) {
        self.faces.push([tip, p, s]);
        let size = |a: u32, b: u32| length(difference(self.at(a), self.at(b)));
        let faces = if size(p, r) <= size(q, s) { [[p, q, r], [p, r, s]] } else { [[p, q, s], [q, r, s]] };
        self.faces.extend(faces);
    }

    /// Puts new vertices back to where they change no shape where a triangle around them would look inward.
    fn unfold(&mut self, ask: &Ask, first: usize, plain: &[Point]) -> Result<(), LeafError> {
        let near: Vec<usize> =
            (0..self.faces.len()).filter(|f| self.faces[*f].iter().any(|v| *v as usize >= first)).collect();
        let middles: Vec<Point> = near.iter().map(|f| middle(self.corners(*f))).collect();
        for (face, plane) in near.iter().zip(ask.planes(&middles)?) {
            let [a, b, c] = self.corners(*face);
            let normal = cross(difference(b, a), difference(c, a));
            if plane.is_some_and(|plane| dot(normal, plane.normal) < 0.0) {
                for v in self.faces[*face].into_iter().filter(|v| *v as usize >= first) {
                    self.positions[v as usize] = plain[v as usize - first];
                    self.stuck[v as usize] = true;
                }
            }
        }
        Ok(())
    }
}

/// What a round does.
struct Plan<'a> {
    known: &'a [Known],
    cuts: &'a [Cut],
    split: &'a [bool],
    edge_of: &'a [u32],
}

fn middle([a, b, c]: [Point; 3]) -> Point {
    [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0)
}

/// The corner from which the longest edge runs; the first of equals.
fn longest(corners: [Point; 3]) -> usize {
    let size = [0, 1, 2].map(|c| length(difference(corners[(c + 1) % 3], corners[c])));
    (1..3).fold(0, |best, c| if size[c] > size[best] { c } else { best })
}
