//! The reference surface: bicubic patches by their control points, and distances of points to them.
use super::box_tree::{Bounds, BoxTree, around};
use super::triangles::closest_on_triangle;
use super::vector::{Point, add, distance, dot, norm, scale, sub};

/// Four rows of four control points; `u` runs along a row, `v` from row to row.
pub type Control = [[Point; 4]; 4];

/// Patches for distance queries.
pub struct Surface {
    /// The patches.
    pub patches: Vec<Control>,
    /// The cells of all patches.
    parts: Vec<PatchCell>,
    tree: BoxTree,
    /// Distances below this may be due to rounding.
    pub floor: f64,
}

/// A point of the surface close to a query point.
#[derive(Clone, Copy, Debug)]
pub struct Foot {
    /// The distance from the query point.
    pub distance: f64,
    /// The index of the patch.
    pub patch: usize,
    /// The parameters.
    pub uv: [f64; 2],
}

/// The number of cells along each side of a patch, for the search. Chosen: a power of two, small enough that
/// most cells are nearly flat.
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

/// The control points of both halves of a curve, by de Casteljau's algorithm.
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

/// The quarters of a patch, each with its lowest parameters.
pub fn quarters(c: &Control) -> [(Control, [f64; 2]); 4] {
    let [left, right] = halves_u(c);
    let [a, b] = halves_u(&transposed(&left)).map(|h| transposed(&h));
    let [d, e] = halves_u(&transposed(&right)).map(|h| transposed(&h));
    [(a, [0.0, 0.0]), (b, [0.0, 0.5]), (d, [0.5, 0.0]), (e, [0.5, 0.5])]
}

/// The `CELLS × CELLS` cells of a patch, row by row.
fn cells(control: &Control) -> Vec<Control> {
    let mut parts = vec![(*control, [0.0, 0.0], 1.0)];
    for _ in 0..CELLS.ilog2() {
        let split = |(part, [u, v], side): (Control, [f64; 2], f64)| {
            quarters(&part).map(|(q, corner)| (q, [u + side * corner[0], v + side * corner[1]], side / 2.0))
        };
        parts = parts.into_iter().flat_map(split).collect();
    }
    parts.sort_by(|a, b| (a.1[1], a.1[0]).partial_cmp(&(b.1[1], b.1[0])).expect("finite"));
    parts.into_iter().map(|(part, ..)| part).collect()
}

fn size(control: &Control) -> f64 {
    control.iter().flatten().map(|p| norm(*p)).fold(0.0, f64::max)
}

/// The largest distance of a part from the triangles `[a, b, c]` and `[a, c, d]` of its corners. The
/// difference to the bilinear surface has the differences of the control points as its control points, and
/// stays in their hull. The bilinear surface is off the triangles by at most a quarter of its twist.
fn unevenness(part: &Control) -> f64 {
    let [a, b, c, d] = corners(part);
    let bilinear = |i: usize, j: usize| {
        let (u, v) = (j as f64 / 3.0, i as f64 / 3.0);
        let lower = add(scale(a, 1.0 - u), scale(b, u));
        add(scale(lower, 1.0 - v), scale(add(scale(d, 1.0 - u), scale(c, u)), v))
    };
    let deviation = |n: usize| distance(part[n / 4][n % 4], bilinear(n / 4, n % 4));
    (0..16).map(deviation).fold(0.0, f64::max) + 0.25 * norm(sub(add(a, c), add(b, d)))
}

fn corners(c: &Control) -> [Point; 4] {
    [c[0][0], c[0][3], c[3][3], c[3][0]]
}

/// The distance of `p` from the two triangles of four corners.
fn distance_to_corners(p: Point, [a, b, c, d]: [Point; 4]) -> f64 {
    let to = |t| distance(p, closest_on_triangle(p, t));
    to([a, b, c]).min(to([a, c, d]))
}

/// One cell of a patch.
struct PatchCell {
    control: Control,
    unevenness: f64,
    /// Whether the cell is so nearly a planar parallelogram that a point close by has only one foot.
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
        // Subdivision rounds by some units in the last place, which the boxes have to include.
        let slack = 64.0 * f64::EPSILON * size;
        let widened = |[low, high]: Bounds| [low.map(|x| x - slack), high.map(|x| x + slack)];
        let parts: Vec<PatchCell> = patches.iter().flat_map(cells).map(PatchCell::new).collect();
        let boxes: Vec<Bounds> =
            parts.iter().map(|part| widened(around(part.control.iter().flatten().copied()))).collect();
        Self { tree: BoxTree::new(&boxes), parts, patches, floor: slack }
    }

    /// A foot that is probably the nearest. Its distance is an upper bound of the true one: cells that could
    /// be nearer are searched from their middle by Newton's method, which finds only a local minimum.
    pub fn nearest(&self, p: Point, guess: Option<Foot>) -> Foot {
        let far = Foot { distance: f64::INFINITY, patch: 0, uv: [0.5; 2] };
        let mut best = guess.map_or(far, |g| self.slide(p, g.patch, g.uv));
        self.tree.visit(p, best.distance, |item, _| {
            let part = &self.parts[item];
            if part.distance_below(p) >= best.distance {
                return best.distance;
            }
            let (patch, [u, v]) = corner_of(item);
            let middle = [u + 0.5 / CELLS as f64, v + 0.5 / CELLS as f64];
            let inside = (0..2).all(|k| (best.uv[k] - middle[k]).abs() < 0.5 / CELLS as f64);
            if part.is_tame && inside && best.patch == patch && best.distance.is_finite() {
                return best.distance;
            }
            let next = self.slide(p, patch, middle);
            if next.distance < best.distance {
                best = next;
            }
            best.distance
        });
        best
    }

    /// Newton's method on the squared distance within the unit square, with damping if a step does not
    /// descend.
    pub fn slide(&self, p: Point, patch: usize, uv: [f64; 2]) -> Foot {
        let control = &self.patches[patch];
        let mut foot = Foot { distance: distance(evaluate(control, uv), p), patch, uv };
        let mut damping = 0.0;
        for _ in 0..24 {
            let Some(step) = newton_step(control, p, foot.uv, damping) else { break };
            let uv = [0, 1].map(|k| (foot.uv[k] + step[k]).clamp(0.0, 1.0));
            let next = distance(evaluate(control, uv), p);
            if next < foot.distance {
                let gain = foot.distance - next;
                foot = Foot { distance: next, patch, uv };
                damping *= 0.1;
                // Chosen: far below the gap of a proof.
                if gain <= 1e-7 * next {
                    break;
                }
            } else {
                // Damping below 1e-3 of the trace has no effect; above 1e6 the step vanishes.
                damping = if damping == 0.0 { 1e-2 } else { damping * 16.0 };
                if damping > 1e6 || uv == foot.uv {
                    break;
                }
            }
        }
        foot
    }

    /// Searches for a point of the surface nearer to `p` than `goal`, by branch and bound over quarters of
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
            // A best distance of 0 ends the search.
            0.0
        });
        answer
    }

    /// A foot whose distance is proved to exceed the true one by at most the share `gap`, by branch and
    /// bound; `None` if the effort does not suffice. Distances below the floor need no proof.
    pub fn proved_nearest(&self, p: Point, guess: Option<Foot>, gap: f64) -> Option<Foot> {
        let mut best = self.nearest(p, guess);
        for _ in 0..64 {
            if best.distance <= self.floor {
                return Some(best);
            }
            match self.search(p, best.distance * (1.0 - gap)) {
                SearchAnswer::Beyond => return Some(best),
                SearchAnswer::Nearer(foot) => best = foot,
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

/// Searches a cell for a point nearer to `p` than `goal`; `at` are the lowest parameters of the cell.
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

/// The result of a search in one cell.
enum CellAnswer {
    Beyond,
    /// A nearer point has these parameters.
    Nearer([f64; 2]),
    Undecided,
}

/// The result of a search for a nearer point.
enum SearchAnswer {
    /// It is proved that there is none.
    Beyond,
    /// There is one; the foot is near it.
    Nearer(Foot),
    /// The effort did not suffice.
    Undecided,
}

fn newton_step(control: &Control, p: Point, [u, v]: [f64; 2], damping: f64) -> Option<[f64; 2]> {
    // Every row at u, with its value and two derivatives; then these along v.
    let rows = [weights(u), slopes(u), bends(u)].map(|w| control.map(|row| line(&row, w)));
    let (wv, sv) = (weights(v), slopes(v));
    let offset = sub(line(&rows[0], wv), p);
    let (du, dv) = (line(&rows[1], wv), line(&rows[0], sv));
    let gradient = [dot(offset, du), dot(offset, dv)];
    // A parameter on the border of the unit square is fixed if the descent would leave the square.
    let free =
        [(u, gradient[0]), (v, gradient[1])].map(|(t, g)| !((t <= 0.0 && g > 0.0) || (t >= 1.0 && g < 0.0)));
    let first = [dot(du, du), dot(du, dv), dot(dv, dv)];
    let second = [
        dot(offset, line(&rows[2], wv)),
        dot(offset, line(&rows[1], sv)),
        dot(offset, line(&rows[0], bends(v))),
    ];
    let full: [f64; 3] = std::array::from_fn(|k| first[k] + second[k]);
    let definite = |h: &[f64; 3]| h[0] > 0.0 && h[2] > 0.0 && h[0] * h[2] - h[1] * h[1] > 0.0;
    let hessian = if definite(&full) { full } else { first };
    // At least some tens of roundings of the trace, so that the determinant is not zero.
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
