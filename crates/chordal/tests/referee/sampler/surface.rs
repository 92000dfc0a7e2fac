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

/// Cells a side into which each patch is cut for the search.
const CELLS: usize = 12;

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

/// A box around the part of a patch over one cell: the samples of a 3 × 3 grid, widened by how far the part can
/// be from their bilinear interpolation (second differences bound second derivatives; `h²·M/8` for each step).
fn cell_bounds(control: &Control, cell: [usize; 2]) -> Bounds {
    let step = 1.0 / CELLS as f64;
    let at = |i: usize, j: usize| {
        evaluate(
            control,
            [(cell[0] as f64 + i as f64 / 2.0) * step, (cell[1] as f64 + j as f64 / 2.0) * step],
        )
    };
    let [low, high] = around((0..9).map(|n| at(n % 3, n / 3)));
    let slack = (step / 2.0).powi(2) * flatness(control) + 1e-14 * size(control);
    [low.map(|x| x - slack), high.map(|x| x + slack)]
}

fn size(control: &Control) -> f64 {
    control.iter().flatten().map(|p| length(*p)).fold(0.0, f64::max)
}

/// `sup |S − bilinear| ≤ (Muu + Mvv)/8` over a unit square: with `Muu ≤ 6·max|second difference|`.
fn flatness(control: &Control) -> f64 {
    let bend = |c: &Control| {
        let second = |l: &[Point; 4], j: usize| length(add(sub(l[j], l[j + 1]), sub(l[j + 2], l[j + 1])));
        c.iter().flat_map(|l| [second(l, 0), second(l, 1)]).fold(0.0, f64::max)
    };
    6.0 / 8.0 * (bend(control) + bend(&transposed(control)))
}

impl Surface {
    pub fn new(patches: Vec<Control>) -> Self {
        let cells = |patch: &Control| {
            let patch = *patch;
            (0..CELLS * CELLS).map(move |n| cell_bounds(&patch, [n % CELLS, n / CELLS]))
        };
        let boxes: Vec<Bounds> = patches.iter().flat_map(cells).collect();
        Self { tree: Tree::new(&boxes), patches }
    }

    /// The largest distance of a control point from the origin: what rounding errors are relative to.
    pub fn size(&self) -> f64 {
        self.patches.iter().map(size).fold(0.0, f64::max)
    }

    /// A foot near the best one. Its distance is an upper bound of the true one: parts of the surface that could
    /// be nearer are searched from their middle by Newton's method, which finds a local minimum.
    pub fn nearest(&self, p: Point, guess: Option<Foot>) -> Foot {
        let far = Foot { distance: f64::INFINITY, patch: 0, uv: [0.5; 2] };
        let mut found = guess.map_or(far, |g| self.slide(p, g.patch, g.uv));
        self.tree.visit(p, found.distance, |item, _| {
            let (patch, cell) = (item / (CELLS * CELLS), item % (CELLS * CELLS));
            let middle = [cell % CELLS, cell / CELLS].map(|c| (c as f64 + 0.5) / CELLS as f64);
            // The best foot lies in or next to this cell: the same valley.
            let same = found.patch == patch
                && found.distance.is_finite()
                && (0..2).all(|k| (found.uv[k] - middle[k]).abs() < 1.25 / CELLS as f64);
            if !same {
                let next = self.slide(p, patch, middle);
                if next.distance < found.distance {
                    found = next;
                }
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

    /// A bound from below on the distance of `p`, by branch and bound over quarters of the patches, stopped when
    /// nothing can be nearer than `goal`: so either a proof that all of the surface is at least `goal` away
    /// (true), or a point that is nearer (false), or no decision within the effort (false).
    pub fn is_beyond(&self, p: Point, goal: f64) -> bool {
        let mut stack: Vec<(Control, u32)> = self.patches.iter().map(|c| (*c, 0)).collect();
        let mut effort = 200_000;
        while let Some((part, depth)) = stack.pop() {
            let [a, b, c, d] = [part[0][0], part[0][3], part[3][3], part[3][0]];
            let nearest = |t| distance(p, closest_on_triangle(p, t));
            let chord = nearest([a, b, c]).min(nearest([a, c, d]));
            // The part is within `slack` of the two triangles: bilinear plus the mixed term of Filip's bound.
            let twist = twist(&part);
            let slack = flatness(&part) + 9.0 / 4.0 * twist;
            if chord - slack >= goal {
                continue;
            }
            effort -= 1;
            if [a, b, c, d].iter().any(|q| distance(*q, p) < goal) || depth > 40 || effort == 0 {
                return false;
            }
            stack.extend(quarters(&part).map(|(q, _)| (q, depth + 1)));
        }
        true
    }
}

/// The largest mixed first difference of the control points.
fn twist(c: &Control) -> f64 {
    let mixed =
        |i: usize, j: usize| length(sub(sub(c[i + 1][j + 1], c[i + 1][j]), sub(c[i][j + 1], c[i][j])));
    (0..9).map(|n| mixed(n / 3, n % 3)).fold(0.0, f64::max)
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
