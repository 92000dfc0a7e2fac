//! `Piece`: a rectangle of a bicubic sheet about a query, and what is proved of its distance to it.
//!
//! With `Q` the sheet minus the query, `D = |Q|²/2`, and everything over the unit square:
//!
//! **By a plane.** For any direction `n` of length 1 no point of `Q` is nearer than the least `n·c` of its control points `c`. With `n`
//! from the query to the nearest point that is known, this is off by the square of the piece's size.
//!
//! **By convexity.** Let `H` be the second derivative of `D`: `H_uu = |Q_u|² + Q·Q_uu`, `H_vv` alike, `H_uv = Q_u·Q_v + Q·Q_uv`. Where
//! `H_uu ≥ a > 0`, `H_vv ≥ c > 0` and `|H_uv| ≤ b` all over the square, `2b|xy| ≤ b·(x²√(a/c) + y²√(c/a))` gives, with
//! `κ = 1 − b/√(ac)` where that is above 0, for any two places that are `(x, y)` apart
//!
//! `D ≥ D₀ + (g_u·x + κ·a·x²/2) + (g_v·y + κ·c·y²/2)`,
//!
//! `D₀` and `g` at the first. Each bracket is at least `−g²/(2κa)`, and at least the lesser of `g·x` at the two ends of the square. At
//! the nearest point both are 0 but for rounding. The ranges come from control points: `|Q_u|` is at least the least part of those
//! along their mean, `Q·Q_uu` at least the least `w·d − r·|d|` over the control points `d` of `Q_uu` where all of `Q` is within `r` of `w`.
//!
//! **Rounding**, with `ρ` the largest coordinate of the control points and `u = ε/2`. A point by Bernstein's weights sees at most 16
//! roundings of terms that add up to `ρ`: `8ε·ρ` along each axis, `14ε·ρ` in all. A halving rounds three times, `1.5ε·ρ` along each axis.
//! Differences are rounded by `u` of themselves, so that a tangent is off by `20ε` of the longest one, `T`; `g` by
//! `16ε·ρ·T + 24ε·|w|·T ≤ 58ε·ρ·T`. The second derivatives are off by `8ε·T` and 16 roundings. The shares of `ε` below are more than this.
use crate::explicit::bernstein;
use glam::DVec3;

/// Where a piece is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub sheet: u32,
    pub u: [f64; 2],
    pub v: [f64; 2],
}

impl Place {
    /// Where a place of the piece is in the sheet.
    pub fn at(&self, [s, t]: [f64; 2]) -> [f64; 2] {
        let within = |[from, to]: [f64; 2], x: f64| if x == 1.0 { to } else { from + (to - from) * x };
        [within(self.u, s), within(self.v, t)]
    }

    /// The halves along an axis.
    pub fn halves(&self, axis: usize) -> [Self; 2] {
        let halves = |[from, to]: [f64; 2]| [[from, 0.5 * (from + to)], [0.5 * (from + to), to]];
        if axis == 0 {
            halves(self.u).map(|u| Self { u, ..*self })
        } else {
            halves(self.v).map(|v| Self { v, ..*self })
        }
    }
}

/// A rectangle of a sheet minus a query.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// Rows of control points, as in a patch.
    control: [[DVec3; 4]; 4],
    /// The largest coordinate of them.
    size: f64,
    /// How far a point may be off by rounding.
    pub off: f64,
    pub place: Place,
    /// A place that may be near the nearest.
    guess: Option<[f64; 2]>,
}

/// The nearest place of a piece that was found, and what is known of all of it.
pub(super) struct Seen {
    pub at: [f64; 2],
    /// The point there.
    pub point: DVec3,
    /// It is at most this far.
    pub up: f64,
    /// No point of the piece is nearer than this.
    pub down: f64,
}

/// Roundings as shares of ε; derived above.
const OF_POINT: f64 = 16.0 * f64::EPSILON;
const OF_HALVES: f64 = 3.0 * f64::EPSILON;
const OF_SLOPE: f64 = 64.0 * f64::EPSILON;
const OF_LENGTH: f64 = 8.0 * f64::EPSILON;

/// A certificate of convexity with less than this to spare is worth little; chosen.
const LEAST_KAPPA: f64 = 1.0 / 64.0;
/// Newton's method from a good start takes four or five; chosen.
const MOST_STEPS: u32 = 12;

impl Piece {
    /// Of control points in the coordinates of the query.
    pub fn new(control: &[[[f64; 3]; 4]; 4], about: DVec3, (off, place): (f64, Place)) -> Self {
        let control = control.map(|row| row.map(|point| DVec3::from(point) - about));
        Self::of(control, off, place)
    }

    fn of(control: [[DVec3; 4]; 4], off: f64, place: Place) -> Self {
        let size = control.as_flattened().iter().fold(0.0, |most, c| larger(most, c.abs().max_element()));
        // Its own rounding is that of the differences, or of the halves; the place is not off.
        Self { control, size, off: off + OF_HALVES * size, place, guess: None }
    }

    /// Looks for the nearest point and proves what it can.
    pub fn look(&self) -> Seen {
        let net = Net::of(&self.control);
        let (at, jet) = self.descend(&net);
        let length = jet.point.length();
        let up = length * (1.0 + OF_LENGTH) + OF_POINT * self.size + self.off;
        let plane = self.beyond(jet.point);
        let convex = self.by_convexity(&net, at, &jet).unwrap_or(0.0);
        Seen { at, point: jet.point, up, down: larger(plane, convex) }
    }

    /// How far all of it lies beyond the plane across a direction; 0 where it does not.
    pub fn beyond(&self, direction: DVec3) -> f64 {
        beyond(self.control.as_flattened(), direction, self.size) - self.off
    }

    /// About its middle.
    pub fn middle(&self) -> DVec3 {
        0.25 * ((self.control[1][1] + self.control[1][2]) + (self.control[2][1] + self.control[2][2]))
    }

    /// The halves across the longer direction.
    pub fn halves(&self, seen: &Seen) -> [Self; 2] {
        let c = &self.control;
        let longest = |along: &dyn Fn(usize, usize) -> DVec3| {
            (0..4).flat_map(|i| (0..3).map(move |j| (i, j))).fold(0.0, |most, (i, j)| {
                let square = along(i, j).length_squared();
                larger(most, square)
            })
        };
        let wide = longest(&|i, j| c[i][j + 1] - c[i][j]);
        let high = longest(&|i, j| c[j + 1][i] - c[j][i]);
        let axis = usize::from(high > wide);
        let turned = |c: &[[DVec3; 4]; 4]| std::array::from_fn(|i| std::array::from_fn(|j| c[j][i]));
        let rows = if axis == 0 { *c } else { turned(c) }.map(split);
        let places = self.place.halves(axis);
        [0, 1].map(|half| {
            let control: [[DVec3; 4]; 4] = rows.map(|row| row[half]);
            let control = if axis == 0 { control } else { turned(&control) };
            let mut at = seen.at;
            at[axis] = 2.0 * at[axis] - half as f64;
            let guess = (at[axis] >= 0.0 && at[axis] <= 1.0).then_some(at);
            Self { guess, ..Self::of(control, self.off, places[half]) }
        })
    }

    /// Newton's method for the nearest place, from the guess or the nearest control point, kept in the square.
    fn descend(&self, net: &Net) -> ([f64; 2], Jet) {
        let mut at = self.guess.unwrap_or_else(|| {
            let squares = self.control.as_flattened().iter().map(|c| c.length_squared()).enumerate();
            let (nearest, _) =
                squares.fold((0, f64::INFINITY), |least, now| if now.1 < least.1 { now } else { least });
            [(nearest % 4) as f64 / 3.0, (nearest / 4) as f64 / 3.0]
        });
        let mut jet = net.jet(at);
        for _ in 0..MOST_STEPS {
            let Some(step) = jet.step(at) else { break };
            let square = jet.point.length_squared();
            let mut share = 1.0;
            // Halved where it leads away.
            let better = (0..4).find_map(|_| {
                let next = [0, 1].map(|k| clamp(at[k] + share * step[k]));
                share *= 0.5;
                let jet = net.jet(next);
                (jet.point.length_squared() < square).then_some((next, jet))
            });
            let Some((next, there)) = better else { break };
            let moved = larger((next[0] - at[0]).abs(), (next[1] - at[1]).abs());
            (at, jet) = (next, there);
            // Nothing is left that could be seen; two digits above rounding.
            if moved < 64.0 * f64::EPSILON {
                break;
            }
        }
        (at, jet)
    }

    /// The distance from below where it is convex.
    fn by_convexity(&self, net: &Net, at: [f64; 2], jet: &Jet) -> Option<f64> {
        let (a, c, kappa) = net.convexity(jet.point)?;
        let tangents = [longest(net.by_u.as_flattened()), longest(net.by_v.as_flattened())];
        let length = jet.point.length() * (1.0 - OF_LENGTH) - OF_POINT * self.size;
        let mut square = if length > 0.0 { length * length } else { return None };
        for (k, curvature) in [a, c].into_iter().enumerate() {
            let slope = jet.point.dot(jet.first[k]);
            let off = OF_SLOPE * tangents[k] * self.size;
            let steep = slope.abs() + off;
            let inside = steep * steep / (2.0 * kappa * curvature);
            let ends = larger((slope + off) * at[k], (off - slope) * (1.0 - at[k]));
            let ends = if ends > 0.0 { ends } else { 0.0 };
            let loss = if inside < ends { inside } else { ends };
            square -= 2.0 * loss * (1.0 + OF_LENGTH);
        }
        (square > 0.0).then(|| square.sqrt() * (1.0 - OF_LENGTH) - self.off)
    }
}

/// How far the hull of points lies beyond the plane across a direction, as seen from the origin; 0 where it does not. Three products and
/// two sums of at most `size`, and the quotient: 4ε of it each, with room.
pub(super) fn beyond(hull: &[DVec3], direction: DVec3, size: f64) -> f64 {
    let length = direction.length();
    if !(length > 0.0 && length.is_finite()) {
        return 0.0;
    }
    let unit = direction / length;
    let least = hull.iter().fold(f64::INFINITY, |least, point| {
        let along = unit.dot(*point);
        if along < least { along } else { least }
    });
    let least = least - OF_LENGTH * size;
    if least > 0.0 { least * (1.0 - OF_LENGTH) } else { 0.0 }
}

/// The control points of a piece, and of its derivatives.
struct Net<'a> {
    points: &'a [[DVec3; 4]; 4],
    by_u: [[DVec3; 3]; 4],
    by_v: [[DVec3; 4]; 3],
    uu: [[DVec3; 2]; 4],
    uv: [[DVec3; 3]; 3],
    vv: [[DVec3; 4]; 2],
}

impl<'a> Net<'a> {
    fn of(points: &'a [[DVec3; 4]; 4]) -> Self {
        let by_u: [[DVec3; 3]; 4] =
            std::array::from_fn(|i| std::array::from_fn(|j| 3.0 * (points[i][j + 1] - points[i][j])));
        let by_v: [[DVec3; 4]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|j| 3.0 * (points[i + 1][j] - points[i][j])));
        Self {
            points,
            uu: std::array::from_fn(|i| std::array::from_fn(|j| 2.0 * (by_u[i][j + 1] - by_u[i][j]))),
            uv: std::array::from_fn(|i| std::array::from_fn(|j| 3.0 * (by_u[i + 1][j] - by_u[i][j]))),
            vv: std::array::from_fn(|i| std::array::from_fn(|j| 2.0 * (by_v[i + 1][j] - by_v[i][j]))),
            by_u,
            by_v,
        }
    }

    fn jet(&self, [s, t]: [f64; 2]) -> Jet {
        let (cubic, quadric, linear) =
            (bernstein, |x: f64| [(1.0 - x) * (1.0 - x), 2.0 * x * (1.0 - x), x * x], |x: f64| [1.0 - x, x]);
        let (u3, u2, u1) = (cubic(s), quadric(s), linear(s));
        let (v3, v2, v1) = (cubic(t), quadric(t), linear(t));
        Jet {
            point: combined(self.points, &v3, &u3),
            first: [combined(&self.by_u, &v3, &u2), combined(&self.by_v, &v2, &u3)],
            second: [
                combined(&self.uu, &v3, &u1),
                combined(&self.uv, &v2, &u2),
                combined(&self.vv, &v1, &u3),
            ],
        }
    }

    /// `a`, `c` and `κ` of the module's notes, where all of the piece is convex to the query.
    fn convexity(&self, middle: DVec3) -> Option<(f64, f64, f64)> {
        let radius =
            self.points.as_flattened().iter().fold(0.0, |most, c| larger(most, (*c - middle).length()));
        let reach = middle.length() + radius;
        let (wide, high) = (longest(self.by_u.as_flattened()), longest(self.by_v.as_flattened()));
        let bent = |net: &[DVec3]| {
            net.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), d| {
                let (along, spread) = (middle.dot(*d), radius * d.length());
                let (low, high) = (along - spread, along + spread);
                (if low < least { low } else { least }, larger(most, high))
            })
        };
        let slack =
            |size: f64, net: &[DVec3], tangent: f64| OF_SLOPE * (size + reach * (tangent + longest(net)));
        let (uu, uv, vv) = (self.uu.as_flattened(), self.uv.as_flattened(), self.vv.as_flattened());
        let (by_u, by_v) = (Fan::of(self.by_u.as_flattened()), Fan::of(self.by_v.as_flattened()));
        let a = by_u.least * by_u.least + bent(uu).0 - slack(wide * wide, uu, wide);
        let c = by_v.least * by_v.least + bent(vv).0 - slack(high * high, vv, high);
        if !(a > 0.0 && c > 0.0) {
            return None;
        }
        let (low, most) = bent(uv);
        let across = by_u.mean.dot(by_v.mean);
        let spread =
            by_u.mean.length() * by_v.spread + by_v.mean.length() * by_u.spread + by_u.spread * by_v.spread;
        let b = larger((across - spread + low).abs(), (across + spread + most).abs())
            + slack(wide * high, uv, wide + high);
        let kappa = 1.0 - b / (a * c).sqrt() * (1.0 + OF_LENGTH);
        (kappa > LEAST_KAPPA).then_some((a, c, kappa - OF_LENGTH))
    }
}

/// Vectors about their mean.
struct Fan {
    mean: DVec3,
    /// No vector of the hull is farther from the mean.
    spread: f64,
    /// No vector of the hull is shorter.
    least: f64,
}

impl Fan {
    fn of(vectors: &[DVec3]) -> Self {
        let mean = vectors.iter().fold(DVec3::ZERO, |sum, v| sum + *v) / vectors.len() as f64;
        let unit = mean / mean.length();
        let (least, spread) = vectors.iter().fold((f64::INFINITY, 0.0), |(least, spread), v| {
            let along = unit.dot(*v);
            (if along < least { along } else { least }, larger(spread, (*v - mean).length()))
        });
        // Without a mean there is no direction, and nothing is above 0.
        Self { mean, spread, least: if least > 0.0 && least.is_finite() { least } else { 0.0 } }
    }
}

/// A point minus the query, and the derivatives there.
struct Jet {
    point: DVec3,
    first: [DVec3; 2],
    second: [DVec3; 3],
}

impl Jet {
    /// Newton's step in the square; none at a place from which nothing leads down.
    fn step(&self, at: [f64; 2]) -> Option<[f64; 2]> {
        let [a, b] = self.first;
        let slope = [self.point.dot(a), self.point.dot(b)];
        let is_free =
            |k: usize| !(slope[k] == 0.0 || at[k] <= 0.0 && slope[k] > 0.0 || at[k] >= 1.0 && slope[k] < 0.0);
        let flat = [a.dot(a), a.dot(b), b.dot(b)];
        let full: [f64; 3] = std::array::from_fn(|k| flat[k] + self.point.dot(self.second[k]));
        let alone = |k: usize| {
            let (full, flat) = (full[2 * k], flat[2 * k]);
            let curvature = if full > 0.0 { full } else { flat };
            if curvature > 0.0 { -slope[k] / curvature } else { 0.0 }
        };
        let step = match (is_free(0), is_free(1)) {
            (false, false) => return None,
            (true, false) => [alone(0), 0.0],
            (false, true) => [0.0, alone(1)],
            (true, true) => {
                let solved = |[uu, uv, vv]: [f64; 3]| {
                    let determinant = uu * vv - uv * uv;
                    // Far above what is left of a determinant of 0.
                    let is_sound = uu > 0.0 && vv > 0.0 && determinant > 1e-12 * uu * vv; // chosen
                    is_sound.then(|| {
                        [
                            (uv * slope[1] - vv * slope[0]) / determinant,
                            (uv * slope[0] - uu * slope[1]) / determinant,
                        ]
                    })
                };
                solved(full).or_else(|| solved(flat)).unwrap_or_else(|| [alone(0), alone(1)])
            }
        };
        let is_step = step.iter().all(|x| x.is_finite()) && step != [0.0; 2];
        is_step.then_some(step)
    }
}

fn combined<const M: usize, const N: usize>(
    net: &[[DVec3; N]; M],
    rows: &[f64; M],
    columns: &[f64; N],
) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for i in 0..M {
        let mut row = DVec3::ZERO;
        for j in 0..N {
            row += net[i][j] * columns[j];
        }
        sum += row * rows[i];
    }
    sum
}

/// The halves of a cubic.
fn split([a, b, c, d]: [DVec3; 4]) -> [[DVec3; 4]; 2] {
    let middle = |p: DVec3, q: DVec3| 0.5 * (p + q);
    let (ab, bc, cd) = (middle(a, b), middle(b, c), middle(c, d));
    let (abc, bcd) = (middle(ab, bc), middle(bc, cd));
    let all = middle(abc, bcd);
    [[a, ab, abc, all], [all, bcd, cd, d]]
}

fn longest(vectors: &[DVec3]) -> f64 {
    vectors.iter().fold(0.0, |most, v| larger(most, v.length_squared())).sqrt()
}

fn clamp(x: f64) -> f64 {
    if x > 0.0 { if x < 1.0 { x } else { 1.0 } } else { 0.0 }
}

pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
