//! `PlaneTriangulation`: triangles of a region in the plane, with points and edges inserted one by one, as near to a
//! Delaunay triangulation as the fixed edges allow.
use crate::math::{Orientation, orient2d};

const NONE: u32 = u32::MAX;
/// The most triangles of a walk to a point, and flips for a point or an edge. Chosen: most take tens; a longer walk is given
/// up, which costs triangles and no proof.
const MOST_STEPS: usize = 10_000;

/// Triangles whose corner `3 t + k` starts the edge to the next corner of the triangle `t`.
#[derive(Debug)]
pub(super) struct PlaneTriangulation {
    pub points: Vec<[f64; 2]>,
    pub corners: Vec<u32>,
    /// The corner of the same edge in the other direction; none at the border.
    twins: Vec<u32>,
    /// Whether the edge is fixed.
    fixed: Vec<bool>,
    /// A corner at each point.
    at: Vec<u32>,
    /// Triangles that have changed since they were last looked at.
    pub changed: Vec<u32>,
}

fn next(c: u32) -> u32 {
    if c % 3 == 2 { c - 2 } else { c + 1 }
}

fn previous(c: u32) -> u32 {
    if c.is_multiple_of(3) { c + 2 } else { c - 1 }
}

impl PlaneTriangulation {
    /// The triangulation with these counter-clockwise triangles; each edge has one or two of them.
    pub fn new(points: Vec<[f64; 2]>, faces: &[[u32; 3]]) -> Self {
        let corners: Vec<u32> = faces.iter().flatten().copied().collect();
        let n = corners.len();
        let mut edges: Vec<([u32; 2], u32)> = (0..n as u32)
            .map(|c| {
                let (a, b) = (corners[c as usize], corners[next(c) as usize]);
                ([a.min(b), a.max(b)], c)
            })
            .collect();
        edges.sort_unstable();
        let mut twins = vec![NONE; n];
        for pair in edges.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            twins[pair[0].1 as usize] = pair[1].1;
            twins[pair[1].1 as usize] = pair[0].1;
        }
        let mut at = vec![NONE; points.len()];
        for (c, point) in corners.iter().enumerate() {
            at[*point as usize] = c as u32;
        }
        let changed = (0..n as u32 / 3).collect();
        let mut triangulation = Self { points, corners, twins, fixed: vec![false; n], at, changed };
        let mut all = (0..n as u32).collect();
        triangulation.legalize(&mut all);
        triangulation
    }

    pub fn n_triangles(&self) -> usize {
        self.corners.len() / 3
    }

    pub fn triangle(&self, t: u32) -> [u32; 3] {
        [0, 1, 2].map(|k| self.corners[3 * t as usize + k])
    }

    pub fn is_border(&self, c: u32) -> bool {
        self.twins[c as usize] == NONE
    }

    /// The ends of an edge.
    pub fn ends(&self, c: u32) -> [u32; 2] {
        [self.corners[c as usize], self.corners[next(c) as usize]]
    }

    fn point(&self, c: u32) -> [f64; 2] {
        self.points[self.corners[c as usize] as usize]
    }

    fn side(&self, c: u32, p: [f64; 2]) -> Orientation {
        orient2d(self.point(c), self.point(next(c)), p)
    }

    fn link(&mut self, c: u32, corner: u32, twin: u32, fixed: bool) {
        self.corners[c as usize] = corner;
        self.twins[c as usize] = twin;
        self.fixed[c as usize] = fixed;
        self.at[corner as usize] = c;
        if twin != NONE {
            self.twins[twin as usize] = c;
        }
    }

    fn edge(&self, c: u32) -> (u32, bool) {
        (self.twins[c as usize], self.fixed[c as usize])
    }

    /// Turns an edge within its two triangles.
    fn flip(&mut self, c: u32) {
        //      r                r
        //    /   \            / | \
        //   p  c→  q    →    p  |  q      first: r, p, s; second: s, q, r
        //    \   /            \ | /
        //      s                s
        let d = self.twins[c as usize];
        let (p, q) = (self.corners[c as usize], self.corners[d as usize]);
        let (r, s) = (self.corners[previous(c) as usize], self.corners[previous(d) as usize]);
        let [rp, qr, ps, sq] = [previous(c), next(c), next(d), previous(d)].map(|edge| self.edge(edge));
        let (first, second) = (3 * (c / 3), 3 * (d / 3));
        self.link(first, r, rp.0, rp.1);
        self.link(first + 1, p, ps.0, ps.1);
        self.link(second, s, sq.0, sq.1);
        self.link(second + 1, q, qr.0, qr.1);
        self.link(first + 2, s, second + 2, false);
        self.link(second + 2, r, first + 2, false);
        self.changed.extend([c / 3, d / 3]);
    }

    /// Whether both triangles of an edge are one convex quad, so that it can be turned.
    fn can_flip(&self, c: u32) -> bool {
        let (d, fixed) = self.edge(c);
        if d == NONE || fixed {
            return false;
        }
        let (r, s) = (self.point(previous(c)), self.point(previous(d)));
        let (p, q) = (self.point(c), self.point(d));
        orient2d(r, p, s) == Orientation::Front && orient2d(s, q, r) == Orientation::Front
    }

    /// Turns edges from a list, and edges around them, until the circle of each triangle is empty up to rounding.
    fn legalize(&mut self, list: &mut Vec<u32>) {
        let mut steps_left = MOST_STEPS + 8 * list.len(); // measured: letters take one flip for each edge and less
        while let Some(c) = list.pop() {
            if steps_left == 0 || !self.can_flip(c) || !self.is_beyond_circle(c) {
                continue;
            }
            steps_left -= 1;
            let d = self.twins[c as usize];
            self.flip(c);
            let (first, second) = (3 * (c / 3), 3 * (d / 3));
            list.extend([first, first + 1, second, second + 1]);
        }
    }

    /// Whether the corner beyond an edge is within the circle of its triangle, clearly.
    fn is_beyond_circle(&self, c: u32) -> bool {
        let d = self.twins[c as usize];
        let s = self.point(previous(d));
        let [a, b, r] = [c, next(c), previous(c)].map(|c| {
            let p = self.point(c);
            [p[0] - s[0], p[1] - s[1]]
        });
        let square = |p: [f64; 2]| p[0] * p[0] + p[1] * p[1];
        let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
        let terms = [square(a) * cross(b, r), square(b) * cross(r, a), square(r) * cross(a, b)];
        let size: f64 = terms.iter().map(|x| x.abs()).sum();
        // Chosen: far above the rounding, so that no edge is turned back and forth for ever.
        terms.iter().sum::<f64>() > 1e-9 * size
    }

    /// The triangle that contains a point, reached from a triangle nearby; none beyond the border or far away.
    fn locate(&self, mut t: u32, p: [f64; 2]) -> Option<u32> {
        for _ in 0..MOST_STEPS {
            let behind = (3 * t..3 * t + 3).find(|c| self.side(*c, p) == Orientation::Back);
            match behind {
                None => return Some(t),
                Some(c) if self.is_border(c) => return None,
                Some(c) => t = self.twins[c as usize] / 3,
            }
        }
        None
    }

    /// Inserts a point; none if it is a corner, on the border or beyond, or not reached from the triangle.
    pub fn insert(&mut self, near: u32, p: [f64; 2]) -> Option<u32> {
        let t = self.locate(near, p)?;
        let flat: Vec<u32> = (3 * t..3 * t + 3).filter(|c| self.side(*c, p) == Orientation::Flat).collect();
        let new = u32::try_from(self.points.len()).ok().filter(|n| *n < NONE)?;
        let mut edges = match flat[..] {
            [] => {
                self.add(p);
                self.split_triangle(t, new)
            }
            [c] if !self.is_border(c) => {
                self.add(p);
                self.split_edge(c, new)
            }
            // At a corner, or on the border.
            _ => return None,
        };
        self.legalize(&mut edges);
        Some(new)
    }

    /// Inserts a point on an edge, as near to it as rounding allows; none if a triangle would be turned over, or at the border.
    pub fn split(&mut self, c: u32, p: [f64; 2]) -> Option<u32> {
        let d = self.twins[c as usize];
        if d == NONE {
            return None;
        }
        // The four other sides of both triangles stay on the same side of the point.
        let sides = [next(c), previous(c), next(d), previous(d)];
        if sides.iter().any(|side| self.side(*side, p) != Orientation::Front) {
            return None;
        }
        let new = u32::try_from(self.points.len()).ok().filter(|n| *n < NONE)?;
        self.add(p);
        let mut edges = self.split_edge(c, new);
        self.legalize(&mut edges);
        Some(new)
    }

    fn add(&mut self, p: [f64; 2]) {
        self.points.push(p);
        self.at.push(NONE);
    }

    /// A new triangle with corners that are not linked yet.
    fn grow(&mut self) -> u32 {
        let t = self.n_triangles() as u32;
        self.corners.extend([NONE; 3]);
        self.twins.extend([NONE; 3]);
        self.fixed.extend([false; 3]);
        t
    }

    /// Returns the edges around the point.
    fn split_triangle(&mut self, t: u32, new: u32) -> Vec<u32> {
        let [a, b, c] = self.triangle(t);
        let [ab, bc, ca] = [0, 1, 2].map(|k| self.edge(3 * t + k));
        let (u, v) = (self.grow(), self.grow());
        self.link(3 * t, a, ab.0, ab.1);
        self.link(3 * u, b, bc.0, bc.1);
        self.link(3 * v, c, ca.0, ca.1);
        for (this, after, end) in [(t, u, b), (u, v, c), (v, t, a)] {
            // From the end of its old edge to the point; the next triangle has the same edge in the other direction.
            self.link(3 * this + 1, end, 3 * after + 2, false);
            self.link(3 * after + 2, new, 3 * this + 1, false);
        }
        self.changed.extend([t, u, v]);
        vec![3 * t, 3 * u, 3 * v]
    }

    fn split_edge(&mut self, c: u32, new: u32) -> Vec<u32> {
        let d = self.twins[c as usize];
        let fixed = self.fixed[c as usize];
        let (p, q) = (self.corners[c as usize], self.corners[d as usize]);
        let (r, s) = (self.corners[previous(c) as usize], self.corners[previous(d) as usize]);
        let [rp, qr, ps, sq] = [previous(c), next(c), next(d), previous(d)].map(|edge| self.edge(edge));
        let (t1, t2, t3, t4) = (c / 3, d / 3, self.grow(), self.grow());
        // Around the point: p to it from r's side, r to q, q to s, s to p.
        for (t, from, to, edge) in [(t1, r, p, rp), (t3, q, r, qr), (t2, s, q, sq), (t4, p, s, ps)] {
            self.link(3 * t, from, edge.0, edge.1);
            self.corners[3 * t as usize + 1] = to;
            self.corners[3 * t as usize + 2] = new;
        }
        // The spoke at the end of a triangle's edge is at the start of the edge of the next triangle but one.
        for (this, after, end, is_fixed) in
            [(t1, t4, p, fixed), (t4, t2, s, false), (t2, t3, q, fixed), (t3, t1, r, false)]
        {
            self.link(3 * this + 1, end, 3 * after + 2, is_fixed);
            self.link(3 * after + 2, new, 3 * this + 1, is_fixed);
        }
        self.changed.extend([t1, t2, t3, t4]);
        vec![3 * t1, 3 * t2, 3 * t3, 3 * t4]
    }

    /// The corner at a point whose triangle contains the start of a direction, or whose edge runs along it.
    fn towards(&self, from: u32, to: [f64; 2]) -> Option<u32> {
        // 1. Back to the border, or once around.
        let first = self.at[from as usize];
        let mut c = first;
        loop {
            let before = self.twins[c as usize];
            if before == NONE {
                break;
            }
            c = next(before);
            if c == first {
                break;
            }
        }
        // 2. Forwards through the fan.
        let start = c;
        loop {
            let (a, b) = (self.point(next(c)), self.point(previous(c)));
            let o = self.point(c);
            // Half-open, so that a direction along an edge belongs to one triangle only.
            if orient2d(o, a, to) != Orientation::Back && orient2d(o, to, b) == Orientation::Front {
                return Some(c);
            }
            c = self.twins[previous(c) as usize];
            if c == NONE || c == start {
                return None;
            }
        }
    }

    /// The triangle at the end of a segment from a point; none if the segment leaves the region.
    pub fn reached(&self, from: u32, to: [f64; 2]) -> Option<u32> {
        let start = self.towards(from, to)?;
        let o = self.points[from as usize];
        let mut c = next(start);
        for _ in 0..MOST_STEPS {
            if self.side(c, to) != Orientation::Back {
                return Some(c / 3);
            }
            let beyond = self.twins[c as usize];
            if beyond == NONE {
                return None;
            }
            // The segment leaves by the edge that it crosses: left or right of the corner beyond.
            let apex = self.point(previous(beyond));
            c = if orient2d(o, to, apex) == Orientation::Front { next(beyond) } else { previous(beyond) };
        }
        None
    }

    /// Makes a segment between two points a fixed edge. If a fixed edge or a point is in its way, no edge stays changed.
    pub fn fix(&mut self, from: u32, to: u32) {
        let (o, end) = (self.points[from as usize], self.points[to as usize]);
        // After a flip, other edges may still be in the way.
        for _ in 0..MOST_STEPS {
            let Some(start) = self.towards(from, end) else { return };
            for edge in [start, previous(start)] {
                let ends = self.ends(edge);
                if ends.contains(&from) && ends.contains(&to) {
                    self.fixed[edge as usize] = true;
                    let twin = self.twins[edge as usize];
                    if twin != NONE {
                        self.fixed[twin as usize] = true;
                    }
                    return;
                }
            }
            // The first crossing edge that can be turned, from the start on.
            let mut c = next(start);
            let turned = loop {
                if self.twins[c as usize] == NONE || self.fixed[c as usize] || self.corners[c as usize] == to
                {
                    break None;
                }
                if self.can_flip(c) {
                    break Some(c);
                }
                let beyond = self.twins[c as usize];
                let apex = previous(beyond);
                if self.corners[apex as usize] == to {
                    break None;
                }
                // The side by which the line leaves the triangle beyond.
                c = match orient2d(o, end, self.point(apex)) {
                    Orientation::Front => next(beyond),
                    Orientation::Back => previous(beyond),
                    Orientation::Flat => break None,
                };
            };
            let Some(c) = turned else { return };
            self.flip(c);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(made: &PlaneTriangulation) -> f64 {
        let twice = |t: u32| {
            let [a, b, c] = made.triangle(t).map(|i| made.points[i as usize]);
            let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            assert!(area > 0.0);
            area
        };
        0.5 * (0..made.n_triangles() as u32).map(twice).sum::<f64>()
    }

    /// Every edge is the twin of its twin, with the same ends and the same mark.
    fn check(made: &PlaneTriangulation) {
        for c in 0..made.corners.len() as u32 {
            let (twin, fixed) = made.edge(c);
            if twin != NONE {
                let [a, b] = made.ends(c);
                assert_eq!((made.ends(twin), made.edge(twin)), ([b, a], (c, fixed)));
            }
        }
        assert!((0..made.points.len()).all(|i| made.corners[made.at[i] as usize] == i as u32));
    }

    #[test]
    fn points_and_edges_are_taken_up_and_nothing_overlaps() {
        let square = vec![[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [0.0, 8.0]];
        let mut made = PlaneTriangulation::new(square, &[[0, 1, 2], [0, 2, 3]]);
        let seed = 5;
        println!("seed {seed}");
        let mut random = chordal_testkit::Random::new(seed);
        // On a lattice, so that points fall on edges and on each other.
        for _ in 0..300 {
            let p = [random.below(65) as f64 / 8.0, random.below(65) as f64 / 8.0];
            let is_known = made.points.contains(&p);
            let is_border = p.iter().any(|x| *x == 0.0 || *x == 8.0);
            assert_eq!(made.insert(0, p).is_none(), is_known || is_border, "{p:?}");
        }
        check(&made);
        assert!((area(&made) - 64.0).abs() < 1e-9);
        let mut n_fixed = 0;
        for _ in 0..200 {
            let [a, b] = [0, 1].map(|_| random.below(made.points.len()) as u32);
            if a != b {
                made.fix(a, b);
                check(&made);
                n_fixed += usize::from(
                    (0..made.corners.len() as u32).any(|c| made.ends(c) == [a, b] && made.edge(c).1),
                );
            }
        }
        assert!(n_fixed > 5, "{n_fixed}");
        assert!((area(&made) - 64.0).abs() < 1e-9);
    }
}
