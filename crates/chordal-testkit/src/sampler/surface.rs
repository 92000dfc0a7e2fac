//! The truth: bicubic patches from their control points, and the distance of points from them.
use super::box_tree::{Bounds, BoxTree, around};
use super::triangles::closest_on_triangle;
use super::vector::{Point, add, distance, dot, norm, scale, sub};

/// Four rows of four control points; `u` runs along a row, `v` from row to row.
pub type Control = [[Point; 4]; 4];

/// Patches to which distances are asked.
pub struct Surface {
    /// The patches.
    pub patches: Vec<Control>,
    /// The cells of all patches.
    parts: Vec<PatchCell>,
    tree: BoxTree,
    /// Distances below this are rounding.
    pub floor: f64,
}

/// A point of the surface that is close to some other point.
#[derive(Clone, Copy, Debug)]
pub struct Foot {
    /// How far it is from that other point.
    pub distance: f64,
    /// Its patch.
    pub patch: usize,
    /// Its parameters.
    pub uv: [f64; 2],
}

/// Cells a side into which each patch is cut for the search; a power of two.
const CELLS: usize = 16;

fn weights(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s * s * s, 3.0 * t * s * s, 3.0 * t * t * s, t * t * t]
}

fn slopes(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [-3.0 * s * s, 3.0 * s * (1.0 - 3.0 * t), 3.0 * t * (2.0 - 3.0 * t), 3.0 * t * t]
}

fn bends(t: f64) -> [f64; 4] {
    [6.0 * (1.0 - t), 6.0 * (3.0 * t - 2.0), 6.0 * (1.0 - 3.0 * t), 6.0 * t]
}

fn line(p: &[Point; 4], w: [f64; 4]) -> Point {
    std::array::from_fn(|k| p[0][k] * w[0] + p[1][k] * w[1] + p[2][k] * w[2] + p[3][k] * w[3])
}

/// The point at `(u, v)`.
pub fn evaluate(control: &Control, [u, v]: [f64; 2]) -> Point {
    let along = weights(u);
    line(&control.map(|row| line(&row, along)), weights(v))
}

/// The control points of the middle halves: `[left, right]` of four points.
fn halve(line: [Point; 4]) -> [[Point; 4]; 2] {
    let middle = |a: Point, b: Point| scale(add(a, b), 0.5);
    let [a, b, c, d] = line;
    let (ab, bc, cd) = (middle(a, b), middle(b, c), middle(c, d));
    let (abc, bcd) = (middle(ab, bc), middle(bc, cd));
    let m = middle(abc, bcd);
    [[a, ab, abc, m], [m, bcd, cd, d]]
}

fn transposed(c: &Control) -> Control {
    std::array::from_fn(|i| std::array::from_fn(|j| c[j][i]))
}

fn halves_u(c: &Control) -> [Control; 2] {
    let rows = c.map(halve);
    [0, 1].map(|k| rows.map(|row| row[k]))
}

/// The quarters of a patch with the corner of each in the unit square of halves.
pub fn quarters(c: &Control) -> [(Control, [f64; 2]); 4] {
    let [left, right] = halves_u(c);
    let [a, b] = halves_u(&transposed(&left)).map(|h| transposed(&h));
    let [d, e] = halves_u(&transposed(&right)).map(|h| transposed(&h));
    [(a, [0.0, 0.0]), (b, [0.0, 0.5]), (d, [0.5, 0.0]), (e, [0.5, 0.5])]
}

/// The parts of a patch over `CELLS × CELLS` cells, row by row.
fn cells(control: &Control) -> Vec<Control> {
    let mut parts = vec![(*control, [0.0, 0.0], 1.0)];
    for _ in 0..CELLS.ilog2() {
        let cut = |(part, [u, v], side): (Control, [f64; 2], f64)| {
            quarters(&part).map(|(q, at)| (q, [u + side * at[0], v + side * at[1]], side / 2.0))
        };
        parts = parts.into_iter().flat_map(cut).collect();
    }
    parts.sort_by(|a, b| (a.1[1], a.1[0]).partial_cmp(&(b.1[1], b.1[0])).expect("finite"));
    parts.into_iter().map(|(part, ..)| part).collect()
}

fn size(control: &Control) -> f64 {
    control.iter().flatten().map(|p| norm(*p)).fold(0.0, f64::max)
}

/// How far a part is at most from the two triangles over its corners `[a, b, c]` and `[a, c, d]`: a control
/// point minus its place on the bilinear surface is a control point of the difference, which stays in their
/// hull; and a bilinear surface leaves the triangles by a quarter of its twist.
fn unevenness(part: &Control) -> f64 {
    let [a, b, c, d] = corners(part);
    let bilinear = |i: usize, j: usize| {
        let (u, v) = (j as f64 / 3.0, i as f64 / 3.0);
        let lower = add(scale(a, 1.0 - u), scale(b, u));
        add(scale(lower, 1.0 - v), scale(add(scale(d, 1.0 - u), scale(c, u)), v))
    };
    let off = |n: usize| distance(part[n / 4][n % 4], bilinear(n / 4, n % 4));
    (0..16).map(off).fold(0.0, f64::max) + 0.25 * norm(sub(add(a, c), add(b, d)))
}

fn corners(c: &Control) -> [Point; 4] {
    [c[0][0], c[0][3], c[3][3], c[3][0]]
}

/// The distance of `p` from two triangles over four corners.
fn distance_to_corners(p: Point, [a, b, c, d]: [Point; 4]) -> f64 {
    let to = |t| distance(p, closest_on_triangle(p, t));
    to([a, b, c]).min(to([a, c, d]))
}

/// One cell of a patch.
struct PatchCell {
    control: Control,
    unevenness: f64,
    /// So nearly a parallelogram in the plane that a point close by has one foot only.
    is_tame: bool,
}

impl PatchCell {
    fn new(control: Control) -> Self {
        let unevenness = unevenness(&control);
        let [a, b, c, d] = corners(&control);
        let shortest = [(a, b), (b, c), (c, d), (d, a)]
            .map(|(p, q)| distance(p, q))
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        Self { control, unevenness, is_tame: 16.0 * unevenness < shortest }
    }

    fn distance_below(&self, p: Point) -> f64 {
        distance_to_corners(p, corners(&self.control)) - self.unevenness
    }
}

impl Surface {
    /// The surface of these patches.
    pub fn new(patches: Vec<Control>) -> Self {
        let size = patches.iter().map(size).fold(0.0, f64::max);
        // Halving rounds by some units in the last place, which the boxes take in.
        let slack = 64.0 * f64::EPSILON * size;
        let wide = |[low, high]: Bounds| [low.map(|x| x - slack), high.map(|x| x + slack)];
        let parts: Vec<PatchCell> = patches.iter().flat_map(cells).map(PatchCell::new).collect();
        let boxes: Vec<Bounds> =
            parts.iter().map(|part| wide(around(part.control.iter().flatten().copied()))).collect();
        Self { tree: BoxTree::new(&boxes), parts, patches, floor: slack }
    }

    /// A foot near the best one. Its distance is an upper bound of the true one: parts of the surface that
    /// could be nearer are searched from their middle by Newton's method, which finds a local minimum.
    pub fn nearest(&self, p: Point, guess: Option<Foot>) -> Foot {
        let far = Foot { distance: f64::INFINITY, patch: 0, uv: [0.5; 2] };
        let mut found = guess.map_or(far, |g| self.slide(p, g.patch, g.uv));
        self.tree.visit(p, found.distance, |item, _| {
            let part = &self.parts[item];
            if part.distance_below(p) >= found.distance {
                return found.distance;
            }
            let (patch, [u, v]) = corner_of(item);
            let middle = [u + 0.5 / CELLS as f64, v + 0.5 / CELLS as f64];
            let inside = (0..2).all(|k| (found.uv[k] - middle[k]).abs() < 0.5 / CELLS as f64);
            if part.is_tame && inside && found.patch == patch && found.distance.is_finite() {
                return found.distance;
            }
            let next = self.slide(p, patch, middle);
            if next.distance < found.distance {
                found = next;
            }
            found.distance
        });
        found
    }

    /// Newton's method on the squared distance within the unit square, damped where it does not descend.
    pub fn slide(&self, p: Point, patch: usize, uv: [f64; 2]) -> Foot {
        let control = &self.patches[patch];
        let mut foot = Foot { distance: distance(evaluate(control, uv), p), patch, uv };
        let mut damping = 0.0;
        for _ in 0..24 {
            let Some(step) = newton_step(control, p, foot.uv, damping) else { break };
            let uv = [0, 1].map(|k| (foot.uv[k] + step[k]).clamp(0.0, 1.0));
            let away = distance(evaluate(control, uv), p);
            if away < foot.distance {
                let gain = foot.distance - away;
                foot = Foot { distance: away, patch, uv };
                damping *= 0.1;
                // Below the gap of a proof by far.
                if gain <= 1e-7 * away {
                    break;
                }
            } else {
                // Below 1e-3 of the trace a damping changes nothing; above 1e6 the step has become nothing.
                damping = if damping == 0.0 { 1e-2 } else { damping * 16.0 };
                if damping > 1e6 || uv == foot.uv {
                    break;
                }
            }
        }
        foot
    }

    /// Looks for a point of the surface nearer to `p` than `goal`, by branch and bound over quarters of the
    /// cells.
    fn search(&self, p: Point, goal: f64) -> SearchAnswer {
        let mut answer = SearchAnswer::Beyond;
        let mut effort = 20_000;
        self.tree.visit(p, goal, |item, best| {
            match search_part(&self.parts[item].control, corner_of(item).1, p, goal, &mut effort) {
                CellAnswer::Beyond => return best,
                CellAnswer::Nearer(uv) => answer = SearchAnswer::Nearer(self.slide(p, corner_of(item).0, uv)),
                CellAnswer::Undecided => answer = SearchAnswer::Undecided,
            }
            // Nothing more is to be visited.
            0.0
        });
        answer
    }

    /// A foot whose distance is at most the part `gap` above the true one, which branch and bound proves;
    /// `None` where its effort does not suffice. Below the floor there is nothing to prove.
    pub fn proved_nearest(&self, p: Point, guess: Option<Foot>, gap: f64) -> Option<Foot> {
        let mut found = self.nearest(p, guess);
        for _ in 0..64 {
            if found.distance <= self.floor {
                return Some(found);
            }
            match self.search(p, found.distance * (1.0 - gap)) {
                SearchAnswer::Beyond => return Some(found),
                SearchAnswer::Nearer(foot) => found = foot,
                SearchAnswer::Undecided => break,
            }
        }
        None
    }
}

/// The patch of a cell and its lowest parameters.
fn corner_of(item: usize) -> (usize, [f64; 2]) {
    let (patch, cell) = (item / (CELLS * CELLS), item % (CELLS * CELLS));
    (patch, [cell % CELLS, cell / CELLS].map(|c| c as f64 / CELLS as f64))
}

/// The search in one cell, given with its lowest parameters, for a point nearer to `p` than `goal`.
fn search_part(cell: &Control, at: [f64; 2], p: Point, goal: f64, effort: &mut u32) -> CellAnswer {
    let mut stack = vec![(*cell, at, 1.0 / CELLS as f64)];
    while let Some((part, [u, v], side)) = stack.pop() {
        let corners = corners(&part);
        if distance_to_corners(p, corners) - unevenness(&part) >= goal {
            continue;
        }
        if let Some(n) = (0..4).find(|&n| distance(corners[n], p) < goal) {
            return CellAnswer::Nearer([u + [0.0, side, side, 0.0][n], v + [0.0, 0.0, side, side][n]]);
        }
        if *effort == 0 {
            return CellAnswer::Undecided;
        }
        *effort -= 1;
        stack.extend(quarters(&part).map(|(q, [du, dv])| (q, [u + side * du, v + side * dv], side / 2.0)));
    }
    CellAnswer::Beyond
}

/// What a search in one cell came to.
enum CellAnswer {
    Beyond,
    /// There is one at these parameters.
    Nearer([f64; 2]),
    Undecided,
}

/// What a search for a nearer point came to.
enum SearchAnswer {
    /// Proved: there is none.
    Beyond,
    /// One is there; the foot is near it.
    Nearer(Foot),
    /// The effort did not suffice.
    Undecided,
}

fn newton_step(control: &Control, p: Point, [u, v]: [f64; 2], damping: f64) -> Option<[f64; 2]> {
    // Each row at u, once for the value and twice for its derivatives; then all of them along v.
    let rows = [weights(u), slopes(u), bends(u)].map(|w| control.map(|row| line(&row, w)));
    let (wv, sv) = (weights(v), slopes(v));
    let away = sub(line(&rows[0], wv), p);
    let (du, dv) = (line(&rows[1], wv), line(&rows[0], sv));
    let gradient = [dot(away, du), dot(away, dv)];
    // Against a wall of the unit square only what leads away from it counts.
    let free =
        [(u, gradient[0]), (v, gradient[1])].map(|(t, g)| !((t <= 0.0 && g > 0.0) || (t >= 1.0 && g < 0.0)));
    let first = [dot(du, du), dot(du, dv), dot(dv, dv)];
    let second =
        [dot(away, line(&rows[2], wv)), dot(away, line(&rows[1], sv)), dot(away, line(&rows[0], bends(v)))];
    let full: [f64; 3] = std::array::from_fn(|k| first[k] + second[k]);
    let definite = |h: &[f64; 3]| h[0] > 0.0 && h[2] > 0.0 && h[0] * h[2] - h[1] * h[1] > 0.0;
    let hessian = if definite(&full) { full } else { first };
    // Some tens of roundings of the trace, so that it can be divided by.
    let lift = (damping + 1e-14) * (first[0] + first[2]);
    let [a, b, d] = [hessian[0] + lift, hessian[1], hessian[2] + lift];
    match free {
        [true, true] => {
            let det = a * d - b * b;
            (det > 0.0).then(|| {
                [(b * gradient[1] - d * gradient[0]) / det, (b * gradient[0] - a * gradient[1]) / det]
            })
        }
        [true, false] => (a > 0.0).then(|| [-gradient[0] / a, 0.0]),
        [false, true] => (d > 0.0).then(|| [0.0, -gradient[1] / d]),
        [false, false] => None,
    }
}
