//! The truth: bicubic patches from their control points, and the distance of points from them.
use super::tree::{Bounds, Tree, around};
use super::triangles::closest_on_triangle;
use super::vector::{Point, add, distance, dot, length, scale, sub};

/// Four rows of four control points; `u` runs along a row, `v` from row to row.
pub type Control = [[Point; 4]; 4];

/// Patches to which distances are asked.
pub struct Surface {
    pub patches: Vec<Control>,
    tree: Tree,
}

/// A point of the surface that is close to some other point.
#[derive(Clone, Copy, Debug)]
pub struct Foot {
    pub distance: f64,
    pub patch: usize,
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

fn tensor(control: &Control, u: [f64; 4], v: [f64; 4]) -> Point {
    let mut sum = [0.0; 3];
    for (row, &wv) in control.iter().zip(&v) {
        let line: Point = std::array::from_fn(|k| {
            row[0][k] * u[0] + row[1][k] * u[1] + row[2][k] * u[2] + row[3][k] * u[3]
        });
        sum = add(sum, scale(line, wv));
    }
    sum
}

/// The point at `(u, v)`.
pub fn evaluate(control: &Control, [u, v]: [f64; 2]) -> Point {
    tensor(control, weights(u), weights(v))
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
    control.iter().flatten().map(|p| length(*p)).fold(0.0, f64::max)
}

/// How far a part is at most from the two triangles over its corners `[a, b, c]` and `[a, c, d]`: a control point
/// minus its place on the bilinear surface is a control point of the difference, which stays in their hull; and
/// a bilinear surface leaves the triangles by a quarter of its twist.
fn unevenness(part: &Control) -> f64 {
    let [a, b, c, d] = [part[0][0], part[0][3], part[3][3], part[3][0]];
    let bilinear = |i: usize, j: usize| {
        let (u, v) = (j as f64 / 3.0, i as f64 / 3.0);
        let lower = add(scale(a, 1.0 - u), scale(b, u));
        add(scale(lower, 1.0 - v), scale(add(scale(d, 1.0 - u), scale(c, u)), v))
    };
    let off = |n: usize| distance(part[n / 4][n % 4], bilinear(n / 4, n % 4));
    (0..16).map(off).fold(0.0, f64::max) + 0.25 * length(sub(add(a, c), add(b, d)))
}

impl Surface {
    pub fn new(patches: Vec<Control>) -> Self {
        // Halving rounds by some units in the last place, which the boxes take in.
        let slack = 1e-14 * patches.iter().map(size).fold(0.0, f64::max);
        let wide = |[low, high]: Bounds| [low.map(|x| x - slack), high.map(|x| x + slack)];
        let parts = patches.iter().flat_map(cells);
        let boxes: Vec<Bounds> = parts.map(|part| wide(around(part.into_iter().flatten()))).collect();
        Self { tree: Tree::new(&boxes), patches }
    }

    /// A foot near the best one. Its distance is an upper bound of the true one: parts of the surface that could
    /// be nearer are searched from their middle by Newton's method, which finds a local minimum.
    pub fn nearest(&self, p: Point, guess: Option<Foot>) -> Foot {
        let far = Foot { distance: f64::INFINITY, patch: 0, uv: [0.5; 2] };
        let mut found = guess.map_or(far, |g| self.slide(p, g.patch, g.uv));
        self.tree.visit(p, found.distance, |item, _| {
            let (patch, cell) = (item / (CELLS * CELLS), item % (CELLS * CELLS));
            let middle = [cell % CELLS, cell / CELLS].map(|c| (c as f64 + 0.5) / CELLS as f64);
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

    /// Looks for a point of the surface nearer to `p` than `goal`, by branch and bound over quarters of the patches.
    pub fn search(&self, p: Point, goal: f64) -> Search {
        let root = |(patch, c): (usize, &Control)| (*c, patch, [0.0; 2], 1.0);
        let mut stack: Vec<(Control, usize, [f64; 2], f64)> =
            self.patches.iter().enumerate().map(root).collect();
        for _ in 0..100_000 {
            let Some((part, patch, [u, v], side)) = stack.pop() else { return Search::Beyond };
            let corners = [part[0][0], part[0][3], part[3][3], part[3][0]];
            let [a, b, c, d] = corners;
            let to = |t| distance(p, closest_on_triangle(p, t));
            if to([a, b, c]).min(to([a, c, d])) - unevenness(&part) >= goal {
                continue;
            }
            if let Some(n) = (0..4).find(|&n| distance(corners[n], p) < goal) {
                let [du, dv] = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]][n];
                return Search::Nearer(self.slide(p, patch, [u + du, v + dv]));
            }
            let cut =
                |(q, at): (Control, [f64; 2])| (q, patch, [u + side * at[0], v + side * at[1]], side / 2.0);
            stack.extend(quarters(&part).map(cut));
        }
        Search::Undecided
    }

    /// A foot whose distance is at most the part `gap` above the true one, which branch and bound proves; `None`
    /// where its effort does not suffice.
    pub fn proved_nearest(&self, p: Point, guess: Option<Foot>, gap: f64) -> Option<Foot> {
        let mut found = self.nearest(p, guess);
        for _ in 0..64 {
            match self.search(p, found.distance * (1.0 - gap)) {
                Search::Beyond => return Some(found),
                Search::Nearer(foot) => found = foot,
                Search::Undecided => break,
            }
        }
        None
    }
}

/// What a search for a nearer point came to.
pub enum Search {
    /// Proved: there is none.
    Beyond,
    /// One is there; the foot is near it.
    Nearer(Foot),
    /// The effort did not suffice.
    Undecided,
}

fn newton_step(control: &Control, p: Point, [u, v]: [f64; 2], damping: f64) -> Option<[f64; 2]> {
    let (wu, wv, su, sv) = (weights(u), weights(v), slopes(u), slopes(v));
    let away = sub(tensor(control, wu, wv), p);
    let (du, dv) = (tensor(control, su, wv), tensor(control, wu, sv));
    let gradient = [dot(away, du), dot(away, dv)];
    // Against a wall of the unit square only what leads away from it counts.
    let free =
        [(u, gradient[0]), (v, gradient[1])].map(|(t, g)| !((t <= 0.0 && g > 0.0) || (t >= 1.0 && g < 0.0)));
    let first = [dot(du, du), dot(du, dv), dot(dv, dv)];
    let second = [
        dot(away, tensor(control, bends(u), wv)),
        dot(away, tensor(control, su, sv)),
        dot(away, tensor(control, wu, bends(v))),
    ];
    let full: [f64; 3] = std::array::from_fn(|k| first[k] + second[k]);
    let definite = |h: &[f64; 3]| h[0] > 0.0 && h[2] > 0.0 && h[0] * h[2] - h[1] * h[1] > 0.0;
    let hessian = if definite(&full) { full } else { first };
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
