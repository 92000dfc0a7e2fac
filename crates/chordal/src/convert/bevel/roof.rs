//! `Roof`: triangles for the height of a bevel over a region, with a proved error for each.
//!
//! The height at a point is its distance to the border, and no more than the bevel's width. It is a minimum of distances
//! to edges. These are convex functions, which bounds the height above the plane through a triangle's corners, and they
//! are above linear functions, which bounds the height below it.
use super::border::{BorderTree, nearest};
use super::plane::PlaneTriangulation;
use crate::budget::{Failure, Job, RefusalCode};
use crate::explicit::Mesh;
use crate::math::{difference, distance, dot, greater, length, lesser};

/// The error, as a share of a length, that computed distances may have. Chosen: far above rounding, and too small to be
/// seen; points that are placed by it are no part of the proof.
const NEAR: f64 = 1e-9;
/// Rounds of halving for a place on a ray or an edge. Chosen: 2⁻⁴⁰ of it is below `NEAR`.
const ROUNDS: u32 = 40;
/// Points within an edge at which a triangle is compared with the height. Chosen: only the place of new points depends on
/// them.
const SAMPLES: u32 = 7;
/// Halvings of the turn at a corner. Chosen: the error of 2⁸ pieces of half a turn is below 2·10⁻⁵ of the width.
const MOST_TURNS: u32 = 8;

/// The triangles with the height at each point.
pub(super) struct Roof<'j> {
    pub plane: PlaneTriangulation,
    pub heights: Vec<f64>,
    tree: BorderTree,
    width: f64,
    /// The largest error that rounding may add to a triangle.
    pub rounding: f64,
    /// The allowed error of each triangle.
    allowed: f64,
    job: &'j Job,
}

/// The goal of a roof.
#[derive(Clone, Copy, Debug)]
pub(super) struct RoofLimits {
    pub width: f64,
    pub rounding: f64,
    pub allowed: f64,
}

/// The end of a ray from a corner.
#[derive(Clone, Copy, Debug)]
struct RayEnd {
    point: u32,
    /// Whether the height there is the whole width.
    is_top: bool,
}

/// The direction of a vector; none if it is too short.
fn unit(v: [f64; 2]) -> Option<[f64; 2]> {
    // Derived: below it, squares lose digits that the proof needs.
    const SHORTEST: f64 = 1e-150;
    let long = length(v);
    if long > SHORTEST && long.is_finite() { Some([v[0] / long, v[1] / long]) } else { None }
}

fn along(a: [f64; 2], b: [f64; 2], t: f64) -> [f64; 2] {
    [0, 1].map(|k| a[k] + t * (b[k] - a[k]))
}

impl<'j> Roof<'j> {
    /// The roof over triangles; their border has the region on its left and meets no point twice.
    pub fn new(
        points: Vec<[f64; 2]>,
        faces: &[[u32; 3]],
        border: &[[u32; 2]],
        limits: RoofLimits,
        job: &'j Job,
    ) -> Self {
        let tree = BorderTree::new(border.iter().map(|edge| edge.map(|i| points[i as usize])).collect());
        let plane = PlaneTriangulation::new(points, faces);
        let RoofLimits { width, rounding, allowed } = limits;
        let mut roof = Self { heights: Vec::new(), plane, tree, width, rounding, allowed, job };
        let mut heights: Vec<f64> = roof.plane.points.iter().map(|p| roof.height(*p)).collect();
        // Exactly 0 at the border.
        border.iter().for_each(|edge| heights[edge[0] as usize] = 0.0);
        roof.heights = heights;
        roof
    }

    fn height(&self, p: [f64; 2]) -> f64 {
        lesser(self.width, self.tree.nearest(p).0)
    }

    fn point(&self, i: u32) -> [f64; 2] {
        self.plane.points[i as usize]
    }

    fn insert(&mut self, near: u32, p: [f64; 2]) -> Option<u32> {
        let new = self.plane.insert(near, p)?;
        self.heights.push(self.height(p));
        Some(new)
    }

    /// Puts points at the bends of the roof: on the bisector of each corner, and around corners that are turned inwards; and
    /// edges along these bends and along the top.
    pub fn bend(&mut self, border: &[[u32; 2]]) -> Result<(), Failure<Mesh>> {
        let n = self.plane.points.len();
        let (mut before, mut after) = (vec![u32::MAX; n], vec![u32::MAX; n]);
        for [a, b] in border {
            after[*a as usize] = *b;
            before[*b as usize] = *a;
        }
        // By corner: the ends of its first and its last ray.
        let mut ends: Vec<Option<[RayEnd; 2]>> = vec![None; n];
        for [corner, _] in border {
            if self.job.is_cancelled() {
                return Err(Failure::Cancelled);
            }
            let (a, c) = (before[*corner as usize], after[*corner as usize]);
            let mut last: Option<RayEnd> = None;
            for ray in self.rays([a, *corner, c].map(|i| self.point(i))) {
                let end = self.cast(*corner, ray);
                if let (Some(last), Some(end)) = (last, end)
                    && last.is_top
                    && end.is_top
                {
                    self.plane.fix(last.point, end.point);
                }
                let pair = &mut ends[*corner as usize];
                if let Some(end) = end {
                    *pair = Some([pair.map_or(end, |pair| pair[0]), end]);
                }
                last = end;
            }
        }
        // Along an edge, the border of the top runs from the last ray of its start to the first of its end.
        for [a, b] in border {
            if let (Some([_, from]), Some([to, _])) = (ends[*a as usize], ends[*b as usize])
                && from.is_top
                && to.is_top
            {
                self.plane.fix(from.point, to.point);
            }
        }
        Ok(())
    }

    /// The directions of the roof's bends from a corner, with lengths that raise the height by 1.
    fn rays(&self, [a, b, c]: [[f64; 2]; 3]) -> Vec<[f64; 2]> {
        let (Some(first), Some(second)) = (unit(difference(b, a)), unit(difference(c, b))) else {
            return Vec::new();
        };
        let [m, n] = [first, second].map(|d| [-d[1], d[0]]);
        let is_inward = first[0] * second[1] - first[1] * second[0] < 0.0;
        let cosine = dot(m, n);
        if !is_inward {
            // The component of the ray along either normal is 1, so that the distances from both edges grow alike.
            let sum = [m[0] + n[0], m[1] + n[1]];
            // A spike that is only a rounding wide has no bisector.
            return if 1.0 + cosine > NEAR { vec![sum.map(|x| x / (1.0 + cosine))] } else { Vec::new() };
        }
        let mut rays = vec![m];
        self.turn([m, n], first, MOST_TURNS, &mut rays);
        // Both normals are so close that one ray in the middle replaces them.
        if rays.len() == 1 {
            return unit([m[0] + n[0], m[1] + n[1]]).into_iter().collect();
        }
        rays
    }

    /// Adds directions from the first of two to the second, so close that the arc between two is within the error.
    fn turn(&self, [m, n]: [[f64; 2]; 2], ahead: [f64; 2], left: u32, rays: &mut Vec<[f64; 2]>) {
        let middle = unit([m[0] + n[0], m[1] + n[1]]).unwrap_or(ahead);
        if left == 0 || self.width * (1.0 - dot(m, middle)) <= 0.5 * self.allowed {
            if left < MOST_TURNS {
                rays.push(n);
            }
            return;
        }
        self.turn([m, middle], ahead, left - 1, rays);
        self.turn([middle, n], ahead, left - 1, rays);
    }

    /// Puts a point at the end of a bend along a ray from a corner: at the top, or where another part of the border is as near.
    fn cast(&mut self, corner: u32, ray: [f64; 2]) -> Option<RayEnd> {
        let from = self.point(corner);
        let at = |t: f64| [from[0] + t * ray[0], from[1] + t * ray[1]];
        // At a corner that is turned inwards, the circles around points of the ray, through the corner, lie
        // one in the other: if it is nearest to a point, it is nearest to all before it, and bisection finds
        // the last.
        let holds = |t: f64| self.tree.nearest(at(t)).0 >= t * (1.0 - NEAR);
        let is_top = holds(self.width);
        let (mut low, mut high) = (0.0, self.width);
        if is_top {
            low = self.width;
        } else {
            for _ in 0..ROUNDS {
                let middle = 0.5 * (low + high);
                if holds(middle) { low = middle } else { high = middle }
            }
        }
        if low <= NEAR * self.width {
            return None;
        }
        let end = at(low);
        let near = self.plane.reached(corner, end)?;
        let point = self.insert(near, end)?;
        self.plane.fix(corner, point);
        Some(RayEnd { point, is_top })
    }

    /// Adds points until each triangle is within the error, or has no room for a point.
    ///
    /// # Errors
    /// When there are more triangles than the job allows, or it is cancelled.
    pub fn refine(&mut self) -> Result<(), Failure<Mesh>> {
        while let Some(t) = self.plane.changed.pop() {
            if self.error(t) <= self.allowed {
                continue;
            }
            if self.job.is_cancelled() {
                return Err(Failure::Cancelled);
            }
            // The solid has each triangle at the top and at the bottom, and walls.
            let n = 2 * self.plane.n_triangles() as u64;
            if n > self.job.triangle_limit {
                let message = format!(
                    "the bevel takes more than {n} triangles, and the limit is {}",
                    self.job.triangle_limit
                );
                return Err(Failure::refused(RefusalCode::TooManyTriangles, message));
            }
            // A point changes the triangle, so that it comes again; rounding may forbid the first points.
            let _ = self.put(t, self.worst_place(t))
                || self.put(t, self.longest_edge(t))
                || self.put(t, (None, self.centre(t)));
        }
        Ok(())
    }

    /// The most useful place for a new point in a triangle, with its edge if it is on one: at the largest difference between
    /// the height and the plane, otherwise in the middle of the longest edge.
    fn worst_place(&self, t: u32) -> (Option<u32>, [f64; 2]) {
        let corners = self.plane.triangle(t);
        let at = corners.map(|i| self.point(i));
        let heights = corners.map(|i| self.heights[i as usize]);
        let mut best = (0.25 * self.allowed, None);
        for k in 0..3 {
            if self.plane.is_border(3 * t + k as u32) {
                continue;
            }
            let (a, b) = (at[k], at[(k + 1) % 3]);
            let (from, to) = (heights[k], heights[(k + 1) % 3]);
            let error_at = |s: f64| (self.height(along(a, b, s)) - (from + s * (to - from))).abs();
            let step = 1.0 / f64::from(SAMPLES + 1);
            for i in 1..=SAMPLES {
                let s = f64::from(i) * step;
                if error_at(s) > best.0 {
                    // At a bend the error has a kink: it falls on both sides of the best sample.
                    let (mut low, mut high) = (s - step, s + step);
                    for _ in 0..ROUNDS {
                        let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
                        if error_at(left) < error_at(right) { low = left } else { high = right }
                    }
                    let top = 0.5 * (low + high);
                    let s = if error_at(top) > error_at(s) { top } else { s };
                    best = (error_at(s), Some((Some(3 * t + k as u32), along(a, b, s))));
                }
            }
        }
        let middle = self.centre(t);
        let mean = (heights[0] + heights[1] + heights[2]) / 3.0;
        if (self.height(middle) - mean).abs() > best.0 {
            return (None, middle);
        }
        if let (_, Some(place)) = best { place } else { self.longest_edge(t) }
    }

    fn centre(&self, t: u32) -> [f64; 2] {
        let at = self.plane.triangle(t).map(|i| self.point(i));
        [0, 1].map(|k| (at[0][k] + at[1][k] + at[2][k]) / 3.0)
    }

    /// The middle of the longest edge that is not on the border; the centre if all are.
    fn longest_edge(&self, t: u32) -> (Option<u32>, [f64; 2]) {
        let mut best = (0.0, (None, self.centre(t)));
        for c in (3 * t..3 * t + 3).filter(|c| !self.plane.is_border(*c)) {
            let [a, b] = self.plane.ends(c).map(|i| self.point(i));
            if distance(a, b) > best.0 {
                best = (distance(a, b), (Some(c), along(a, b, 0.5)));
            }
        }
        best.1
    }

    /// Puts a point into a triangle, on its edge if one is given. Returns whether that was possible.
    fn put(&mut self, t: u32, (edge, p): (Option<u32>, [f64; 2])) -> bool {
        match edge {
            Some(edge) if self.plane.split(edge, p).is_some() => {
                self.heights.push(self.height(p));
                true
            }
            Some(_) => false,
            None => self.insert(t, p).is_some(),
        }
    }

    /// A bound for the difference between the height over a triangle and its plane, rounding included.
    pub fn error(&self, t: u32) -> f64 {
        let corners = self.plane.triangle(t);
        let at = corners.map(|i| self.point(i));
        let heights = corners.map(|i| self.heights[i as usize]);
        let most = greater(greater(heights[0], heights[1]), heights[2]);
        let mix = |a: f64, b: f64, c: f64| a * (1.0 / 3.0) + b * (1.0 / 3.0) + c * (1.0 / 3.0);
        let centre = [0, 1].map(|k| mix(at[0][k], at[1][k], at[2][k]));
        let middles = [0, 1, 2].map(|k| along(at[k], at[(k + 1) % 3], 0.5));
        let seen = [centre, at[0], at[1], at[2], middles[0], middles[1], middles[2]];
        let low = [0, 1].map(|k| lesser(lesser(at[0][k], at[1][k]), at[2][k]));
        let high = [0, 1].map(|k| greater(greater(at[0][k], at[1][k]), at[2][k]));
        // 1. The height is no more than the width, nor than the distance to any edge. That is convex, so it is highest above
        // the plane at a corner.
        let worst = |values: [f64; 3]| greater(greater(values[0], values[1]), values[2]);
        let mut above = worst(heights.map(|h| self.width - h));
        // 2. The distance to an edge is no less than the length along any direction from the nearer of its ends: a linear
        // function for each end. The best of a few directions counts; edges farther away than the plane is high do not.
        let mut below = 0.0;
        self.tree.each_near([low, high], most + self.rounding, |edge| {
            above =
                lesser(above, worst([0, 1, 2].map(|k| distance(nearest(edge, at[k]), at[k]) - heights[k])));
            let normal = unit(difference(edge[1], edge[0])).map(|d| [-d[1], d[0]]);
            let sides = [normal, normal.map(|n| n.map(|x| -x))];
            let directions =
                seen.iter().map(|p| unit(difference(*p, nearest(edge, *p)))).chain(sides).flatten();
            let least = directions.fold(most, |least, u| {
                let under = |k: usize| {
                    let way = lesser(dot(u, difference(at[k], edge[0])), dot(u, difference(at[k], edge[1])));
                    heights[k] - way
                };
                lesser(least, worst([under(0), under(1), under(2)]))
            });
            below = greater(below, least);
        });
        greater(greater(above, below), 0.0) + self.rounding
    }
}
