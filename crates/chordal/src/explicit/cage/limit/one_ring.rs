//! `OneRing`: the quads, or for Loop's scheme the triangles, around a vertex whose neighbourhood is the same
//! after every round, with the vertex's limit point and tangents. Loop's part is in [`super::loop_one_ring`].
//!
//! Sources: M. Halstead, M. Kass, T. DeRose, *Efficient, fair interpolation using Catmull-Clark surfaces*,
//! 1993 (the limit of a smooth vertex: n² of it, 4 of each neighbour, 1 of each vertex across); H. Biermann,
//! A. Levin, D. Zorin, *Piecewise smooth subdivision surfaces with normal control*, 2000 (tangents on
//! creases; but theirs are for rules modified so that everything shrinks by a half, and are re-derived here
//! for the usual rules).
use super::super::vertex_rule::{CagePoint, plus};
use super::super::{INFINITELY_SHARP, Scheme};
use super::face_one_ring::{CageTopology, FaceOneRing};
use crate::explicit::patch::{front, largest};
use crate::math::dot;
use crate::math::elementary::{cos, sin};
use std::f64::consts::{PI, TAU};

/// The rule of the vertex in every round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum VertexKind {
    Smooth,
    /// The edge with this index is sharp and ends at the vertex.
    Dart(usize),
    /// The first and the last edge are sharp.
    Crease,
    /// The vertex is on a crease to these neighbours, with faces around it that are not in this ring:
    /// surfaces meet in a seam.
    Seam([CagePoint; 2]),
    Corner,
}

/// A vertex and, counter-clockwise, its neighbours and the vertices diagonally across its quads.
#[derive(Clone, Debug)]
pub(super) struct OneRing {
    pub(super) kind: VertexKind,
    /// Whether the scheme is Loop's.
    is_loop: bool,
    pub(super) here: CagePoint,
    /// As many as quads if they close around the vertex, otherwise one more.
    pub(super) edges: Vec<CagePoint>,
    /// One for each quad or triangle; unused for triangles.
    pub(super) faces: Vec<CagePoint>,
    /// The index of the quad that is the face of the ring.
    own: usize,
}

impl OneRing {
    /// The one-ring of a corner of a ring's face; `None` if its neighbourhood will change: faces of another
    /// size, or sharpness that ends.
    pub fn around_corner(ring: &FaceOneRing, parts: &CageTopology, corner: usize) -> Option<Self> {
        let cage = ring.cage();
        let vertex = cage.corners[corner];
        let vertex_sharpness = parts.sharp.vertices[vertex as usize];
        let sharpness = |edge: u32| parts.sharp.edges[edge as usize];
        let around = parts.incidence.edges(vertex as usize);
        let ends = |x: f64| x > 0.0 && x < INFINITELY_SHARP;
        let others_end = around.iter().any(|edge| ends(sharpness(*edge)));
        if ends(vertex_sharpness) || others_end {
            return None;
        }
        let is_loop = cage.scheme == Scheme::Loop;
        let n = if is_loop { 3 } else { 4 };
        // The edges of a face before and after the vertex, and the other vertices of the face.
        let sides = |face: u32| {
            let vertices = cage.face(face as usize);
            let k = vertices.iter().position(|v| *v == vertex).filter(|_| vertices.len() == n)?;
            let begin = cage.begin(face as usize);
            let before = (k + n - 1) % n;
            let (next, last) = (parts.edges.of_corner[begin + k], parts.edges.of_corner[begin + before]);
            Some((next, last, vertices[(k + 1) % n], vertices[(k + 2) % n], vertices[before]))
        };
        let across = |edge: u32, face: u32| {
            let on = parts.edges.faces(edge as usize);
            (on.len() == 2).then(|| if on[0] == face { on[1] } else { on[0] })
        };
        let is_cut = |edge: u32| sharpness(edge) >= INFINITELY_SHARP;
        let first_edge = parts.edges.of_corner[corner];
        let n_cut = around.iter().filter(|edge| is_cut(**edge)).count();
        let is_dart = n_cut == 1 && vertex_sharpness == 0.0;
        // Walk backwards, clockwise, to a cut.
        let mut begin = (0, first_edge);
        if n_cut > 0 && !is_dart {
            for _ in 0..around.len() {
                if is_cut(begin.1) {
                    break;
                }
                let face = across(begin.1, begin.0)?;
                begin = (face, sides(face)?.0);
            }
        }
        let mut fan = Self {
            kind: VertexKind::Smooth,
            is_loop,
            here: cage.positions[vertex as usize],
            edges: vec![],
            faces: vec![],
            own: 0,
        };
        let at = |v: u32| cage.positions[v as usize];
        // The neighbours along a crease that does not consist of the first and the last edge.
        let seam = |ends: Option<[u32; 2]>| {
            let cut: Vec<u32> = around.iter().copied().filter(|edge| is_cut(*edge)).collect();
            let &[a, b] = &cut[..] else { return None };
            let is_own = ends.is_some_and(|ends| ends == [a, b] || ends == [b, a]);
            let other = |edge: u32| {
                let ends = parts.edges.ends[edge as usize];
                at(if ends[0] == vertex { ends[1] } else { ends[0] })
            };
            (!is_own).then(|| VertexKind::Seam([other(a), other(b)]))
        };
        let (mut face, mut dart, mut first) = (begin.0, None, None);
        for _ in 0..=around.len() {
            let (next, last, after, corner, before) = sides(face)?;
            if face == 0 {
                fan.own = fan.faces.len();
            }
            first = first.or(Some(next));
            if is_cut(next) {
                dart = Some(fan.edges.len());
            }
            fan.edges.push(at(after));
            fan.faces.push(at(corner));
            // The only cut of a dart ends inside the surface, so the walk passes it and closes.
            if is_cut(last) && !is_dart {
                fan.edges.push(at(before));
                let seam = || seam(first.map(|first| [first, last])).unwrap_or(VertexKind::Crease);
                fan.kind = if vertex_sharpness > 0.0 || n_cut > 2 { VertexKind::Corner } else { seam() };
                return Some(fan);
            }
            face = across(last, face)?;
            if face == begin.0 {
                fan.kind = match dart.filter(|_| is_dart) {
                    _ if vertex_sharpness > 0.0 => VertexKind::Corner,
                    Some(edge) => VertexKind::Dart(edge),
                    None => seam(None).unwrap_or(VertexKind::Smooth),
                };
                return Some(fan);
            }
        }
        None
    }

    /// The one-ring after a round.
    fn refined(&self) -> Self {
        let (edges, faces) = if self.is_loop {
            (self.refined_neighbours_loop(), self.faces.clone())
        } else {
            self.refined_neighbours()
        };
        let crease = |[a, b]: [CagePoint; 2]| plus(plus(self.here.map(|x| 0.75 * x), 0.125, a), 0.125, b);
        let here = match self.kind {
            VertexKind::Corner => self.here,
            VertexKind::Crease => crease([self.edges[0], self.edges[self.edges.len() - 1]]),
            VertexKind::Seam(ends) => crease(ends),
            VertexKind::Smooth | VertexKind::Dart(_) if self.is_loop => self.smooth_point_loop(),
            VertexKind::Smooth | VertexKind::Dart(_) => {
                let n = self.edges.len() as f64;
                let share = 1.0 / (n * n);
                let start = self.here.map(|x| (n - 2.0) / n * x);
                self.edges.iter().chain(&faces).fold(start, |sum, p| plus(sum, share, *p))
            }
        };
        let kind = match self.kind {
            // Along a sharp edge, the next point after a round is its middle.
            VertexKind::Seam(ends) => {
                VertexKind::Seam(ends.map(|end| [0, 1, 2].map(|k| 0.5 * self.here[k] + 0.5 * end[k])))
            }
            kind => kind,
        };
        Self { here, edges, faces, kind, ..*self }
    }

    /// The neighbours and the vertices across quads after a round.
    fn refined_neighbours(&self) -> (Vec<CagePoint>, Vec<CagePoint>) {
        let mean = |points: &[CagePoint]| {
            let share = 1.0 / points.len() as f64;
            points.iter().fold([0.0; 3], |sum, p| plus(sum, share, *p))
        };
        let (n_edges, n_faces) = (self.edges.len(), self.faces.len());
        let is_closed = n_edges == n_faces;
        let edge = |k: usize| self.edges[k % n_edges];
        let centres: Vec<CagePoint> =
            (0..n_faces).map(|k| mean(&[self.here, edge(k), edge(k + 1), self.faces[k]])).collect();
        let edges = (0..n_edges).map(|k| {
            let is_end = !is_closed && (k == 0 || k + 1 == n_edges);
            if is_end || self.kind == VertexKind::Dart(k) {
                return mean(&[self.here, edge(k)]);
            }
            mean(&[self.here, edge(k), centres[(k + n_faces - 1) % n_faces], centres[k % n_faces]])
        });
        (edges.collect(), centres)
    }

    /// The vertex's limit point.
    pub fn limit(&self) -> CagePoint {
        let crease = |[a, b]: [CagePoint; 2]| [0, 1, 2].map(|k| (4.0 * self.here[k] + (a[k] + b[k])) / 6.0);
        match self.kind {
            VertexKind::Corner => self.here,
            VertexKind::Crease => crease([self.edges[0], self.edges[self.edges.len() - 1]]),
            VertexKind::Seam(ends) => crease(ends),
            VertexKind::Smooth if self.is_loop => self.limit_point_loop(),
            VertexKind::Smooth => {
                let n = self.edges.len() as f64;
                let share = 1.0 / (n * (n + 5.0));
                let start = self.here.map(|x| n / (n + 5.0) * x);
                let sum = self.edges.iter().fold(start, |sum, p| plus(sum, 4.0 * share, *p));
                self.faces.iter().fold(sum, |sum, p| plus(sum, share, *p))
            }
            VertexKind::Dart(_) => (0..ROUNDS_TO_LIMIT).fold(self.clone(), |fan, _| fan.refined()).here,
        }
    }

    /// The same, relative to its limit point.
    fn centred(&self) -> Self {
        let limit = self.limit();
        let about = |p: &CagePoint| [0, 1, 2].map(|k| p[k] - limit[k]);
        let kind = match self.kind {
            VertexKind::Seam(ends) => VertexKind::Seam(ends.map(|end| about(&end))),
            kind => kind,
        };
        Self {
            kind,
            here: about(&self.here),
            edges: self.edges.iter().map(about).collect(),
            faces: self.faces.iter().map(about).collect(),
            ..*self
        }
    }

    /// Two tangents of the limit surface at the vertex, whose cross product points to its front; accurate to
    /// about six digits at the end of a crease and at corners of several quads.
    pub fn tangents(&self) -> [CagePoint; 2] {
        if let Some(tangents) = self.is_loop.then(|| self.limit_tangents_loop()).flatten() {
            return tangents;
        }
        let sum = |points: &[CagePoint], weight: &dyn Fn(usize) -> f64| {
            points.iter().enumerate().fold([0.0; 3], |sum, (k, p)| plus(sum, weight(k), *p))
        };
        let add = |a: CagePoint, b: CagePoint| [0, 1, 2].map(|k| a[k] + b[k]);
        let (n, last) = (self.faces.len(), self.edges.len() - 1);
        let to = |k: usize| [0, 1, 2].map(|i| self.edges[k % self.edges.len()][i] - self.here[i]);
        match self.kind {
            VertexKind::Corner if n == 1 => [to(0), to(1)],
            VertexKind::Smooth if n > 2 => {
                let turn = TAU / n as f64;
                let share = 1.0 / (4.0 * eigenvalue(turn) - 1.0);
                [0, 1].map(|shift| {
                    let wave = |k: usize| cos(((k + n - shift) % n) as f64 * turn);
                    let edges = sum(&self.edges, &|k| 4.0 * wave(k));
                    add(edges, sum(&self.faces, &|k| share * (wave(k) + wave(k + 1))))
                })
            }
            VertexKind::Crease if n == 1 => {
                let along = [0, 1, 2].map(|k| self.edges[0][k] - self.edges[1][k]);
                [along, add(to(0), to(1))]
            }
            VertexKind::Crease => {
                let along = [0, 1, 2].map(|k| self.edges[0][k] - self.edges[last][k]);
                // The left eigenvector of the round's matrix: sines over the quads, and the resulting weights
                // of the ends and the vertex by two linear equations, whose determinant is (λ − 1)(λ − 1/4).
                let turn = PI / n as f64;
                let lambda = eigenvalue(turn);
                let wave = |k: usize| if k == 0 || k == n { 0.0 } else { sin(k as f64 * turn) };
                let face = |k: usize| (wave(k) + wave(k + 1)) / (4.0 * lambda - 1.0);
                let p = 0.25 * (wave(1) + face(0));
                let q = (0..n).map(|k| 1.5 * wave(k) + 0.25 * face(k)).sum::<f64>();
                let determinant = (lambda - 1.0) * (lambda - 0.25);
                let ends = (0.125 * q - (0.75 - lambda) * p) / determinant;
                let vertex_term = self.here.map(|x| x * (p - (0.5 - lambda) * q) / determinant);
                let edges = sum(&self.edges, &|k| if k == 0 || k == last { ends } else { 4.0 * wave(k) });
                let faces = sum(&self.faces, &face);
                [along, add(vertex_term, add(edges, faces))]
            }
            _ => {
                let mut fan = self.centred();
                for round in 1..=ROUNDS_TO_LIMIT {
                    fan = fan.refined();
                    // Doubled, so that no number becomes too small.
                    fan.here = fan.here.map(|x| 2.0 * x);
                    let twice = |p: &mut CagePoint| *p = p.map(|x| 2.0 * x);
                    fan.edges.iter_mut().chain(&mut fan.faces).for_each(twice);
                    if let VertexKind::Seam(ends) = &mut fan.kind {
                        ends.iter_mut().for_each(twice);
                    }
                    if self.kind != VertexKind::Corner && round % ROUNDS_TO_CENTRE == 0 {
                        fan = fan.centred();
                    }
                }
                let tangents = [0, 1].map(|k| {
                    let edge = fan.edges[(self.own + k) % fan.edges.len()];
                    [0, 1, 2].map(|i| edge[i] - fan.here[i])
                });
                // Between two quads of a corner the edge rotates into the plane of the outer ones, as slowly
                // as one over the number of rounds: the weights of both grow relative to that of the edge
                // itself.
                let (turning, outer) =
                    (self.kind == VertexKind::Corner && n == 2 && last == 2, [to(0), to(2)]);
                match front(outer[0], outer[1]) {
                    (unit, area) if turning && area > LEAST_AREA * largest(outer[0]) * largest(outer[1]) => {
                        let agrees = dot(unit, front(tangents[0], tangents[1]).0) > 0.0;
                        if agrees { outer } else { [outer[1], outer[0]] }
                    }
                    _ => tangents,
                }
            }
        }
    }
}

/// The factor by which a round shrinks the wave of this angle from quad to quad.
fn eigenvalue(turn: f64) -> f64 {
    (5.0 + cos(turn) + cos(0.5 * turn) * (2.0 * (9.0 + cos(turn))).sqrt()) / 16.0
}

/// Two directions that span less than this fraction of their lengths count as one. Chosen: far above
/// rounding.
pub(super) const LEAST_AREA: f64 = 1e-6;

/// Rounds after which the distance of neighbours is as small as rounding. Derived: 0.66⁹⁰ < 2⁻⁵³, and around
/// any vertex distances shrink at least by 0.655 per round, the limit for many quads.
const ROUNDS_TO_LIMIT: usize = 90;

/// Rounds after which the offset of the centre by rounding, a thousand times larger after so many doublings,
/// is removed.
const ROUNDS_TO_CENTRE: usize = 10;
