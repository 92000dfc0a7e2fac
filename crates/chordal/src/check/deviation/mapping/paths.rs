//! `EdgePaths`: for every edge of the source a walk over faces of the result, from the image of one end to that
//! of the other.
use super::crossing::Crossing;
use super::images::{Carrier, VertexImage};
use super::surface::{FanSurface, MOST_AROUND, NONE};
use crate::budget::{Job, par_map};
use crate::explicit::{distance_sq_to_triangle, next_in_face, previous_in_face};
use crate::math::{cross, difference, dot, greater, lesser, unit};
use std::cell::Cell;

/// The walks of all edges, in one list.
pub(super) struct EdgePaths {
    /// By half-edge of the source that represents its edge: the start of its walk in the list; one more entry
    /// at the end.
    first: Vec<u32>,
    /// Half-edges of the result through which the walks leave a face.
    pub crossed: Vec<u32>,
    /// The distance of the two points of each crossing, rounded up.
    pub up: Vec<f64>,
    /// By half-edge: whether its edge has a walk.
    has_walk: Vec<bool>,
}

impl EdgePaths {
    /// The range of an edge's walk in the lists; `None` if it has none.
    pub fn of(&self, edge: u32) -> Option<std::ops::Range<usize>> {
        let h = edge as usize;
        self.has_walk[h].then(|| self.first[h] as usize..self.first[h + 1] as usize)
    }

    /// The points of the source and of the result that are crossing `i` of the list, rounded, each with a
    /// bound on the rounding.
    pub fn at(&self, i: u32, source: &FanSurface, result: &FanSurface) -> [([f64; 3], f64); 2] {
        let edge = self.first.partition_point(|first| *first <= i) as u32 - 1;
        let [u, v] = [source.at(source.start(edge)), source.at(source.end(edge))];
        let (mut t, mut s, mut across) = (0.0, 0.0, [u, v]);
        for g in &self.crossed[self.first[edge as usize] as usize..=i as usize] {
            across = [result.at(result.start(*g)), result.at(result.end(*g))];
            let crossing = Crossing::nearest([u, v], across, t);
            (t, s) = (crossing.t, crossing.s);
        }
        // Each coordinate has a difference of at most twice the largest one, a product and a sum: 2.5 ε of that
        // at most, and √3 of it in space.
        let point = |[a, b]: [[f64; 3]; 2], t: f64| {
            let largest = a.iter().chain(&b).fold(0.0, |most, x| greater(x.abs(), most));
            (std::array::from_fn(|k| a[k] + t * (b[k] - a[k])), 8.0 * f64::EPSILON * largest)
        };
        [point([u, v], t), point(across, s)]
    }
}

/// Half-edges in one task.
const CHUNK: usize = 3 << 12;

/// Walks for all edges. If a walk is within `enough`, no other is tried.
pub(super) fn edge_paths(
    source: &FanSurface,
    result: &FanSurface,
    images: &[VertexImage],
    (enough, job): (f64, &Job),
) -> EdgePaths {
    let normals: Vec<_> = (0..result.n_faces() as u32).map(|face| normal(result.corners(face))).collect();
    let n = 3 * source.n_faces();
    let starts: Vec<usize> = (0..n).step_by(CHUNK).collect();
    let parts = par_map(job, &starts, |_, start| {
        let mut walker =
            PathFinder { source, result, images, normals: &normals, enough, steps: Cell::new(MOST_STEPS) };
        let end = lesser(start + CHUNK, n);
        let mut part = PathPart::default();
        for h in *start as u32..end as u32 {
            part.first.push(part.crossed.len() as u32);
            // One walk for each edge, from the half-edge that stands for it.
            let has_walk = !job.is_cancelled() && source.edge(h) == h && walker.find(h, &mut part);
            part.has_walk.push(has_walk);
        }
        part
    });
    let (mut first, mut has_walk) = (Vec::with_capacity(n + 1), Vec::with_capacity(n));
    let n_crossed = parts.iter().map(|part| part.crossed.len()).sum();
    let (mut crossed, mut up) = (Vec::with_capacity(n_crossed), Vec::with_capacity(n_crossed));
    for part in parts {
        // Each part has counted from its own beginning.
        first.extend(part.first.iter().map(|at| at + crossed.len() as u32));
        crossed.extend(part.crossed);
        up.extend(part.up);
        has_walk.extend(part.has_walk);
    }
    first.push(crossed.len() as u32);
    EdgePaths { first, crossed, up, has_walk }
}

#[derive(Default)]
struct PathPart {
    first: Vec<u32>,
    crossed: Vec<u32>,
    up: Vec<f64>,
    has_walk: Vec<bool>,
}

struct PathFinder<'a> {
    source: &'a FanSurface,
    result: &'a FanSurface,
    images: &'a [VertexImage],
    normals: &'a [[f64; 3]],
    enough: f64,
    /// The remaining steps of long walks in this task, shared by all of them.
    steps: Cell<usize>,
}

/// A point of an edge of the source and its image.
#[derive(Clone, Copy)]
struct PathEnd {
    at: [f64; 3],
    image: VertexImage,
}

/// The best walk so far.
struct BestPath {
    crossed: Vec<u32>,
    up: f64,
}

/// Faces that one walk crosses at most once the steps of its task are used up. Chosen: faces that need longer
/// walks are left to the search.
const MOST_CROSSED: usize = 200;
/// The same before that: fans of needles need long walks. Chosen: larger values find more walks, and cost
/// time.
const MOST_CROSSED_WHILE_FEW: usize = 1 << 14;
/// The steps that walks of more than [`MOST_CROSSED`] faces take together in one task. Chosen: 256 for each
/// edge.
const MOST_STEPS: usize = 1 << 20;
/// An edge is halved at most so often to find a walk. Chosen: larger values find more walks, and cost time.
const MOST_HALVINGS: u32 = 6;
/// The share of the way to the other end at which a point is located, to find the face toward that end.
/// Chosen: small, so that the point is still in the faces around its start.
const TOWARD: f64 = 0.01;

impl PathFinder<'_> {
    /// Adds the walk of the edge of `h`; `false` if none was found.
    fn find(&mut self, h: u32, part: &mut PathPart) -> bool {
        let [a, b] = [self.source.start(h), self.source.end(h)]
            .map(|v| PathEnd { at: self.source.at(v), image: self.images[v as usize] });
        if a.image.face == NONE || b.image.face == NONE {
            return false;
        }
        // The straight segment stays in the face, which is convex.
        if a.image.face == b.image.face {
            return true;
        }
        let mut best = BestPath { crossed: Vec::new(), up: f64::INFINITY };
        if let Some(g) = self.result.between(a.image.face, b.image.face) {
            let crossing = Crossing::nearest([a.at, b.at], self.ends(g), 0.0);
            if crossing.up <= self.enough {
                part.crossed.push(g);
                part.up.push(crossing.up);
                return true;
            }
            best = BestPath { crossed: vec![g], up: crossing.up };
        }
        self.improve(&a, &b, 0, &mut best);
        if best.up > self.enough {
            self.along_source(h, &a, &b, &mut best);
        }
        if best.up == f64::INFINITY {
            return false;
        }
        // Parameters ascend, as the proof requires: each crossing is searched from the previous one
        // on.
        let mut t = 0.0;
        for &g in &best.crossed {
            let crossing = Crossing::nearest([a.at, b.at], self.ends(g), t);
            t = crossing.t;
            part.crossed.push(g);
            part.up.push(crossing.up);
        }
        true
    }

    #[inline]
    fn ends(&self, g: u32) -> [[f64; 3]; 2] {
        [self.result.at(self.result.start(g)), self.result.at(self.result.end(g))]
    }

    /// Replaces the best walk by another one if that is closer.
    fn offer(&self, ends: [&PathEnd; 2], mut crossed: Vec<u32>, best: &mut BestPath) {
        cancel(&mut crossed, self.result);
        let edge = ends.map(|end| end.at);
        let (mut t, mut up) = (0.0, 0.0);
        for &g in &crossed {
            let crossing = Crossing::nearest(edge, self.ends(g), t);
            t = crossing.t;
            up = greater(up, crossing.up);
            // The bound only grows: this walk can no longer win.
            if up >= best.up {
                return;
            }
        }
        *best = BestPath { crossed, up };
    }

    /// Tries other walks until one is close enough.
    fn improve(&self, a: &PathEnd, b: &PathEnd, depth: u32, best: &mut BestPath) {
        // 1. The straight way, from the faces that lie toward each other.
        if let Some(crossed) = self.straight(a, b) {
            self.offer([a, b], crossed, best);
        }
        if best.up <= self.enough {
            return;
        }
        // 2. Around a vertex that both faces share, in either direction.
        let [f, g] = [a.image.face, b.image.face];
        for v in self.result.vertices(f) {
            if !self.result.vertices(g).contains(&v) {
                continue;
            }
            for way in [Way::Left, Way::Right] {
                if let Some(crossed) = self.around(v, [f, g], way) {
                    self.offer([a, b], crossed, best);
                }
            }
        }
        if best.up <= self.enough || depth >= MOST_HALVINGS {
            return;
        }
        // 3. Through the image of the midpoint, by halves.
        let at: [f64; 3] = std::array::from_fn(|k| 0.5 * (a.at[k] + b.at[k]));
        let [x, y] = [f, g].map(|face| VertexImage::on_face(at, face, self.result).descend(at, self.result));
        let middle = PathEnd { at, image: if y.distance_sq < x.distance_sq { y } else { x } };
        let half = |from: &PathEnd, to: &PathEnd| {
            let mut half = BestPath { crossed: Vec::new(), up: f64::INFINITY };
            if from.image.face == to.image.face {
                half.up = 0.0;
            } else {
                self.improve(from, to, depth + 1, &mut half);
            }
            (half.up < f64::INFINITY).then_some(half.crossed)
        };
        if let (Some(mut crossed), Some(second_half)) = (half(a, &middle), half(&middle, b)) {
            crossed.extend(second_half);
            self.offer([a, b], crossed, best);
        }
    }

    /// A walk over the faces cut by the plane through both images that contains the mean normal.
    fn straight(&self, a: &PathEnd, b: &PathEnd) -> Option<Vec<u32>> {
        let (f, g) = self.facing(a, b);
        let [m, n] = [f, g].map(|face| self.normals[face as usize]);
        let along = difference(b.image.at, a.image.at);
        let plane = cross(along, std::array::from_fn(|k| m[k] + n[k]));
        self.cut([a, b], [f, g], &Cut { plane, toward: along })
    }

    /// Offers walks over the faces cut by the plane through the edge of the source that contains its normal,
    /// in both directions: if the images of both ends are in flat faces that look away from each other, the
    /// normals there are of no use.
    fn along_source(&self, h: u32, a: &PathEnd, b: &PathEnd, best: &mut BestPath) {
        let t = self.source.twin(h);
        let [m, n] = [h, if t == NONE { h } else { t }].map(|h| normal(self.source.corners(h / 3)));
        let plane = cross(difference(b.at, a.at), std::array::from_fn(|k| m[k] + n[k]));
        let (f, g) = self.facing(a, b);
        let toward = cross(plane, self.normals[f as usize]);
        for toward in [toward, toward.map(|x| -x)] {
            if let Some(crossed) = self.cut([a, b], [f, g], &Cut { plane, toward }) {
                self.offer([a, b], crossed, best);
            }
        }
    }

    /// A walk over the faces that a plane cuts, from the image of one end to that of the other.
    fn cut(&self, [a, b]: [&PathEnd; 2], [f, g]: [u32; 2], cut: &Cut) -> Option<Vec<u32>> {
        let mut crossed = self.turn(a, a.image.face, f)?;
        self.walk([f, g], a.image.at, cut, &mut crossed)?;
        crossed.extend(self.turn(b, g, b.image.face)?);
        Some(crossed)
    }

    /// The faces around the two images that lie toward each other.
    fn facing(&self, a: &PathEnd, b: &PathEnd) -> (u32, u32) {
        let has = |carrier: Carrier, face: u32| match carrier {
            Carrier::Inside => false,
            Carrier::Edge(h) => {
                let t = self.result.twin(h);
                t != NONE && t / 3 == face
            }
            Carrier::Corner(h) => self.result.vertices(face).contains(&self.result.start(h)),
        };
        let (p, q) = (&a.image, &b.image);
        // Both images are corners of the result: a face that has both is crossed along its side,
        // and no edge is.
        if let (Carrier::Corner(h), Carrier::Corner(g)) = (p.carrier, q.carrier) {
            let other = self.result.start(g);
            let both = |h: &u32| self.result.vertices(*h / 3).contains(&other);
            if let Some(h) = self.result.ring(self.result.start(h)).find(both) {
                return (h / 3, h / 3);
            }
        }
        if has(p.carrier, q.face) {
            return (q.face, q.face);
        }
        if has(q.carrier, p.face) {
            return (p.face, p.face);
        }
        (self.toward(p, q.at), self.toward(q, p.at))
    }

    /// The face around an image that lies toward a point.
    fn toward(&self, from: &VertexImage, to: [f64; 3]) -> u32 {
        // A point a little on the way: the face that is nearest to it is the one the way leads
        // into.
        let m: [f64; 3] = std::array::from_fn(|k| from.at[k] + TOWARD * (to[k] - from.at[k]));
        let distance_to = |face: u32| distance_sq_to_triangle(m, self.result.corners(face));
        let nearer = |best: (f64, u32), face: u32| {
            let d = distance_to(face);
            if d < best.0 { (d, face) } else { best }
        };
        match from.carrier {
            Carrier::Inside => from.face,
            Carrier::Edge(h) => match self.result.twin(h) {
                NONE => from.face,
                t => nearer((distance_to(from.face), from.face), t / 3).1,
            },
            Carrier::Corner(h) => {
                let mut n = 0;
                let ring = self.result.ring(self.result.start(h)).take(self.most_crossed(MOST_AROUND));
                let face = ring
                    .inspect(|_| n += 1)
                    .map(|g| g / 3)
                    .fold((distance_to(from.face), from.face), nearer)
                    .1;
                self.count_steps(n);
                face
            }
        }
    }

    /// The shorter way around an image from one face to another.
    fn turn(&self, at: &PathEnd, from: u32, to: u32) -> Option<Vec<u32>> {
        if from == to {
            return Some(Vec::new());
        }
        if let Some(h) = self.result.between(from, to) {
            return Some(vec![h]);
        }
        let Carrier::Corner(h) = at.image.carrier else { return None };
        let ways = [Way::Left, Way::Right].map(|way| self.around(self.result.start(h), [from, to], way));
        match ways {
            [Some(x), Some(y)] => Some(if y.len() < x.len() { y } else { x }),
            [x, y] => x.or(y),
        }
    }

    /// The way around a vertex from one of its faces to another.
    fn around(&self, v: u32, [from, to]: [u32; 2], way: Way) -> Option<Vec<u32>> {
        //     ╲   ╱  h           `h` starts at v. To the left, the way leaves the face through the half-edge before h,
        //      ╲ ╱               which ends at v; its twin starts at v again. To the right, it leaves through h
        //       v                itself; the half-edge after the twin starts at v again.
        let mut h = (3 * from..3 * from + 3).find(|h| self.result.start(*h) == v)?;
        let mut crossed = Vec::new();
        for _ in 0..self.most_crossed(MOST_AROUND) {
            if h / 3 == to {
                self.count_steps(crossed.len());
                return Some(crossed);
            }
            let leaves = match way {
                Way::Left => previous_in_face(h),
                Way::Right => h,
            };
            let t = self.result.twin(leaves);
            if t == NONE {
                return None;
            }
            crossed.push(leaves);
            h = match way {
                Way::Left => t,
                Way::Right => next_in_face(t),
            };
        }
        self.count_steps(crossed.len());
        None
    }

    /// The number of faces that a walk may cross: `few`, or more as long as there are steps left.
    fn most_crossed(&self, few: usize) -> usize {
        if self.steps.get() > 0 { MOST_CROSSED_WHILE_FEW } else { few }
    }

    fn count_steps(&self, n: usize) {
        if n > MOST_CROSSED {
            self.steps.set(self.steps.get().saturating_sub(n));
        }
    }

    fn walk(&self, [f, g]: [u32; 2], from: [f64; 3], cut: &Cut, crossed: &mut Vec<u32>) -> Option<()> {
        if f == g {
            return Some(());
        }
        if let Some(h) = self.result.between(f, g) {
            crossed.push(h);
            return Some(());
        }
        let side = |v: u32| dot(cut.plane, difference(self.result.at(v), from));
        // The edge of the first face that the plane cuts farther on.
        let mut exit = (f64::NEG_INFINITY, NONE);
        for h in 3 * f..3 * f + 3 {
            let [u, v] = [self.result.start(h), self.result.end(h)];
            let [s, t] = [side(u), side(v)];
            if (s >= 0.0) == (t >= 0.0) {
                continue;
            }
            // Signs differ, so this divides by a sum of absolute values that is not 0.
            let share = s / (s - t);
            let [p, q] = [self.result.at(u), self.result.at(v)];
            let at: [f64; 3] = std::array::from_fn(|k| p[k] + share * (q[k] - p[k]) - from[k]);
            let far = dot(cut.toward, at);
            if far > exit.0 {
                exit = (far, h);
            }
        }
        let mut h = exit.1;
        if h == NONE {
            return None;
        }
        for n in 0..self.most_crossed(MOST_CROSSED) {
            let t = self.result.twin(h);
            if t == NONE {
                self.count_steps(n);
                return None;
            }
            crossed.push(h);
            if t / 3 == g {
                self.count_steps(n);
                return Some(());
            }
            // The plane entered the face between the ends of `t`, which it separates. It leaves
            // between the apex and the end on the other side.
            let apex = side(self.result.start(previous_in_face(t))) >= 0.0;
            let start = side(self.result.start(t)) >= 0.0;
            h = if apex == start { next_in_face(t) } else { previous_in_face(t) };
        }
        self.count_steps(crossed.len());
        None
    }
}

/// A plane through the point from which a walk starts.
struct Cut {
    /// The normal of the plane.
    plane: [f64; 3],
    /// The direction of the walk in the plane.
    toward: [f64; 3],
}

/// The normal of a triangle; zero for one without area.
fn normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    unit(cross(difference(b, a), difference(c, a))).unwrap_or([0.0; 3])
}

#[derive(Clone, Copy)]
enum Way {
    Left,
    Right,
}

/// Removes pairs of crossings that pass through an edge and straight back.
fn cancel(crossed: &mut Vec<u32>, surface: &FanSurface) {
    let mut n = 0;
    for i in 0..crossed.len() {
        let h = crossed[i];
        if n > 0 && surface.twin(crossed[n - 1]) == h {
            n -= 1;
        } else {
            crossed[n] = h;
            n += 1;
        }
    }
    crossed.truncate(n);
}
