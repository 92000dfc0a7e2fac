//! `OffsetPatch`: a rectangle of a bicubic sheet relative to a query, with proved bounds of its distance.
//!
//! With `Q` the sheet minus the query, `D = |Q|²/2`, and all parameters in the unit square:
//!
//! **By a plane.** For any direction `n` of length 1 no point of `Q` is nearer than the smallest `n·c` of its
//! control points `c`. With `n` from the query to the nearest known point, the error is of the order of the
//! square of the piece's size.
//!
//! **By convexity.** Let `H` be the second derivative of `D`: `H_uu = |Q_u|² + Q·Q_uu`, `H_vv` alike,
//! `H_uv = Q_u·Q_v + Q·Q_uv`. If `H_uu ≥ a > 0`, `H_vv ≥ c > 0` and `|H_uv| ≤ b` on the entire square,
//! `2b|xy| ≤ b·(x²√(a/c) + y²√(c/a))` gives, with `κ = 1 − b/√(ac)` if that is above 0, for any two parameter
//! points whose difference is `(x, y)`
//!
//! `D ≥ D₀ + (g_u·x + κ·a·x²/2) + (g_v·y + κ·c·y²/2)`,
//!
//! `D₀` and `g` at the first point. Each bracket is at least `−g²/(2κa)`, and at least the smaller of `g·x`
//! at the two ends of the square. At the closest point both are 0 up to rounding. The ranges come from
//! control points: `|Q_u|` is at least the smallest component of its control points along their mean.
//! `Q·Q_uu` is at least the smallest `w·d − r·|d|` over the control points `d` of `Q_uu`, if all of `Q` is
//! within `r` of `w`.
//!
//! **Rounding**, with `ρ` the largest coordinate of the control points and `u = ε/2`. A point by Bernstein
//! weights has at most 16 roundings of terms that add up to `ρ`: `8ε·ρ` along each axis, `14ε·ρ` in all. A
//! halving rounds three times, `1.5ε·ρ` along each axis. Differences are rounded by `u` of themselves, so
//! that a tangent is off by `20ε` of the longest one, `T`; `g` by `16ε·ρ·T + 24ε·|w|·T ≤ 58ε·ρ·T`. The second
//! derivatives are off by `8ε·T` and 16 roundings. The multiples of `ε` below are larger than these.
use crate::explicit::bernstein;
use crate::math::{greater, lesser};
use glam::DVec3;

/// The parameter rectangle of a piece in its sheet.
#[derive(Clone, Copy, Debug)]
pub(super) struct SheetRectangle {
    pub sheet: u32,
    pub u: [f64; 2],
    pub v: [f64; 2],
}

impl SheetRectangle {
    /// The sheet parameters of a point given by parameters of the piece.
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
pub(super) struct OffsetPatch {
    /// Rows of control points, as in a patch.
    control: [[DVec3; 4]; 4],
    /// Their largest coordinate.
    size: f64,
    /// The largest error of a point by rounding.
    pub error: f64,
    pub place: SheetRectangle,
    /// Parameters that may be near those of the closest point.
    guess: Option<[f64; 2]>,
}

/// The closest point found on a piece, and bounds for the entire piece.
pub(super) struct PatchDistance {
    pub at: [f64; 2],
    /// The point there.
    pub point: DVec3,
    /// Upper bound for the distance.
    pub up: f64,
    /// Lower bound: no point of the piece is nearer.
    pub down: f64,
}

/// Roundings as multiples of ε; derived above.
const OF_POINT: f64 = 16.0 * f64::EPSILON;
const OF_HALVES: f64 = 3.0 * f64::EPSILON;
const OF_SLOPE: f64 = 64.0 * f64::EPSILON;
const OF_LENGTH: f64 = 8.0 * f64::EPSILON;

/// Convexity certificates with a smaller margin are dropped. Chosen: they prove little.
const LEAST_KAPPA: f64 = 1.0 / 64.0;
/// The most steps of Newton's method. Chosen: from a good start it takes four or five.
const MOST_STEPS: u32 = 12;

impl OffsetPatch {
    /// A piece from control points in the same coordinates as the query, `about`.
    pub fn new(control: &[[[f64; 3]; 4]; 4], about: DVec3, error: f64, place: SheetRectangle) -> Self {
        let control = control.map(|row| row.map(|point| DVec3::from(point) - about));
        Self::from_control(control, error, place)
    }

    fn from_control(control: [[DVec3; 4]; 4], error: f64, place: SheetRectangle) -> Self {
        let size =
            control.as_flattened().iter().fold(0.0, |largest, c| greater(largest, c.abs().max_element()));
        // Its own rounding is that of the differences, or of the halvings; the query has no error.
        Self { control, size, error: error + OF_HALVES * size, place, guess: None }
    }

    /// Searches for the closest point and proves bounds.
    pub fn bound_distance(&self) -> PatchDistance {
        let net = ControlNet::new(&self.control);
        let (at, jet) = self.descend(&net);
        let length = jet.point.length();
        let up = length * (1.0 + OF_LENGTH) + OF_POINT * self.size + self.error;
        let plane = self.plane_bound(jet.point);
        let convex = self.convexity_bound(&net, at, &jet).unwrap_or(0.0);
        PatchDistance { at, point: jet.point, up, down: greater(plane, convex) }
    }

    /// The distance of the entire piece beyond the plane perpendicular to a direction; 0 if it is not beyond.
    pub fn plane_bound(&self, direction: DVec3) -> f64 {
        hull_plane_bound(self.control.as_flattened(), direction, self.size) - self.error
    }

    /// A point near the middle of the piece.
    pub fn middle(&self) -> DVec3 {
        0.25 * ((self.control[1][1] + self.control[1][2]) + (self.control[2][1] + self.control[2][2]))
    }

    /// The halves, split across the longer direction.
    pub fn halves(&self, closest: &PatchDistance) -> [Self; 2] {
        let c = &self.control;
        let longest = |along: &dyn Fn(usize, usize) -> DVec3| {
            (0..4).flat_map(|i| (0..3).map(move |j| (i, j))).fold(0.0, |largest, (i, j)| {
                let square = along(i, j).length_squared();
                greater(largest, square)
            })
        };
        let wide = longest(&|i, j| c[i][j + 1] - c[i][j]);
        let high = longest(&|i, j| c[j + 1][i] - c[j][i]);
        let axis = usize::from(high > wide);
        let turned = |c: &[[DVec3; 4]; 4]| std::array::from_fn(|i| std::array::from_fn(|j| c[j][i]));
        let rows = if axis == 0 { *c } else { turned(c) }.map(split);
        let rectangles = self.place.halves(axis);
        [0, 1].map(|half| {
            let control: [[DVec3; 4]; 4] = rows.map(|row| row[half]);
            let control = if axis == 0 { control } else { turned(&control) };
            // The point found for the whole starts the search in the half that holds it; the other
            // half starts at its control points.
            let mut at = closest.at;
            at[axis] = 2.0 * at[axis] - half as f64;
            let guess = (at[axis] >= 0.0 && at[axis] <= 1.0).then_some(at);
            Self { guess, ..Self::from_control(control, self.error, rectangles[half]) }
        })
    }

    /// Newton's method for the closest point, from the guess or the nearest control point, clamped to the
    /// square.
    fn descend(&self, net: &ControlNet) -> ([f64; 2], OffsetJet) {
        let mut at =
            self.guess.unwrap_or_else(|| {
                let squares = self.control.as_flattened().iter().map(|c| c.length_squared()).enumerate();
                let (nearest, _) = squares.fold((0, f64::INFINITY), |nearest, candidate| {
                    if candidate.1 < nearest.1 { candidate } else { nearest }
                });
                [(nearest % 4) as f64 / 3.0, (nearest / 4) as f64 / 3.0]
            });
        let mut jet = net.jet(at);
        for _ in 0..MOST_STEPS {
            let Some(step) = jet.step(at) else { break };
            let square = jet.point.length_squared();
            let mut share = 1.0;
            // The step is halved if it leads away.
            let better = (0..4).find_map(|_| {
                let next = [0, 1].map(|k| clamp(at[k] + share * step[k]));
                share *= 0.5;
                let jet = net.jet(next);
                (jet.point.length_squared() < square).then_some((next, jet))
            });
            let Some((next, next_jet)) = better else { break };
            let moved = greater((next[0] - at[0]).abs(), (next[1] - at[1]).abs());
            (at, jet) = (next, next_jet);
            // Two digits above rounding: a smaller step has no visible effect.
            if moved < 64.0 * f64::EPSILON {
                break;
            }
        }
        (at, jet)
    }

    /// The lower bound for the distance if the squared distance is convex.
    fn convexity_bound(&self, net: &ControlNet, at: [f64; 2], jet: &OffsetJet) -> Option<f64> {
        let (a, c, kappa) = net.convexity(jet.point)?;
        let tangents = [longest(net.by_u.as_flattened()), longest(net.by_v.as_flattened())];
        let length = jet.point.length() * (1.0 - OF_LENGTH) - OF_POINT * self.size;
        let mut square = if length > 0.0 { length * length } else { return None };
        for (k, curvature) in [a, c].into_iter().enumerate() {
            let slope = jet.point.dot(jet.first[k]);
            let error = OF_SLOPE * tangents[k] * self.size;
            let steep = slope.abs() + error;
            // Both `inside` and `ends` bound the loss, so the smaller one counts: the first is better near a minimum
            // inside the square, the second at its border.
            let inside = steep * steep / (2.0 * kappa * curvature);
            let ends = greater((slope + error) * at[k], (error - slope) * (1.0 - at[k]));
            let ends = greater(ends, 0.0);
            let loss = lesser(inside, ends);
            square -= 2.0 * loss * (1.0 + OF_LENGTH);
        }
        (square > 0.0).then(|| square.sqrt() * (1.0 - OF_LENGTH) - self.error)
    }
}

/// The distance of the hull of points beyond the plane perpendicular to a direction, as seen from the origin;
/// 0 if the hull is not beyond it. Three products and two sums of at most `size`, and the quotient, round by
/// less than 4ε of it each.
pub(super) fn hull_plane_bound(hull: &[DVec3], direction: DVec3, size: f64) -> f64 {
    let length = direction.length();
    if !(length > 0.0 && length.is_finite()) {
        return 0.0;
    }
    let unit = direction / length;
    let lowest = hull.iter().fold(f64::INFINITY, |lowest, point| {
        let along = unit.dot(*point);
        lesser(along, lowest)
    });
    let lowest = lowest - OF_LENGTH * size;
    if lowest > 0.0 { lowest * (1.0 - OF_LENGTH) } else { 0.0 }
}

/// The control points of a piece and of its derivatives.
struct ControlNet<'a> {
    points: &'a [[DVec3; 4]; 4],
    by_u: [[DVec3; 3]; 4],
    by_v: [[DVec3; 4]; 3],
    uu: [[DVec3; 2]; 4],
    uv: [[DVec3; 3]; 3],
    vv: [[DVec3; 4]; 2],
}

impl<'a> ControlNet<'a> {
    fn new(points: &'a [[DVec3; 4]; 4]) -> Self {
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

    fn jet(&self, [s, t]: [f64; 2]) -> OffsetJet {
        let (cubic, quadric, linear) =
            (bernstein, |x: f64| [(1.0 - x) * (1.0 - x), 2.0 * x * (1.0 - x), x * x], |x: f64| [1.0 - x, x]);
        let (u3, u2, u1) = (cubic(s), quadric(s), linear(s));
        let (v3, v2, v1) = (cubic(t), quadric(t), linear(t));
        OffsetJet {
            point: combined(self.points, &v3, &u3),
            first: [combined(&self.by_u, &v3, &u2), combined(&self.by_v, &v2, &u3)],
            second: [
                combined(&self.uu, &v3, &u1),
                combined(&self.uv, &v2, &u2),
                combined(&self.vv, &v1, &u3),
            ],
        }
    }

    /// `a`, `c` and `κ` of the module's notes, if the squared distance to the query is convex on the entire
    /// piece.
    fn convexity(&self, middle: DVec3) -> Option<(f64, f64, f64)> {
        let radius = self
            .points
            .as_flattened()
            .iter()
            .fold(0.0, |largest, c| greater(largest, (*c - middle).length()));
        let reach = middle.length() + radius;
        let (wide, high) = (longest(self.by_u.as_flattened()), longest(self.by_v.as_flattened()));
        // The range of Q·d, for Q within `radius` of `middle`, over the control points d of a
        // second derivative.
        let bent = |net: &[DVec3]| {
            net.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lowest, highest), d| {
                let (along, spread) = (middle.dot(*d), radius * d.length());
                let (low, high) = (along - spread, along + spread);
                (lesser(low, lowest), greater(highest, high))
            })
        };
        // Roundings of both terms of H: the product of tangents, and Q times a second derivative.
        let slack =
            |size: f64, net: &[DVec3], tangent: f64| OF_SLOPE * (size + reach * (tangent + longest(net)));
        let (uu, uv, vv) = (self.uu.as_flattened(), self.uv.as_flattened(), self.vv.as_flattened());
        let (by_u, by_v) =
            (VectorCone::new(self.by_u.as_flattened()), VectorCone::new(self.by_v.as_flattened()));
        let a = by_u.shortest * by_u.shortest + bent(uu).0 - slack(wide * wide, uu, wide);
        let c = by_v.shortest * by_v.shortest + bent(vv).0 - slack(high * high, vv, high);
        if !(a > 0.0 && c > 0.0) {
            return None;
        }
        let (bent_low, bent_high) = bent(uv);
        let across = by_u.mean.dot(by_v.mean);
        // With p and q off the means m and n by at most r and s, p·q is off m·n by at most |m|·s +
        // |n|·r + r·s.
        let spread =
            by_u.mean.length() * by_v.spread + by_v.mean.length() * by_u.spread + by_u.spread * by_v.spread;
        let b = greater((across - spread + bent_low).abs(), (across + spread + bent_high).abs())
            + slack(wide * high, uv, wide + high);
        let kappa = 1.0 - b / (a * c).sqrt() * (1.0 + OF_LENGTH);
        (kappa > LEAST_KAPPA).then_some((a, c, kappa - OF_LENGTH))
    }
}

/// The mean of vectors, and bounds for their hull.
struct VectorCone {
    mean: DVec3,
    /// No vector of the hull is farther from the mean than this.
    spread: f64,
    /// No vector of the hull is shorter than this.
    shortest: f64,
}

impl VectorCone {
    fn new(vectors: &[DVec3]) -> Self {
        let mean = vectors.iter().fold(DVec3::ZERO, |sum, v| sum + *v) / vectors.len() as f64;
        let unit = mean / mean.length();
        let (shortest, spread) = vectors.iter().fold((f64::INFINITY, 0.0), |(shortest, spread), v| {
            let along = unit.dot(*v);
            (lesser(along, shortest), greater(spread, (*v - mean).length()))
        });
        // A mean of zero has no direction, and proves no length above 0.
        Self { mean, spread, shortest: if shortest > 0.0 && shortest.is_finite() { shortest } else { 0.0 } }
    }
}

/// A point minus the query, and the derivatives there.
struct OffsetJet {
    point: DVec3,
    first: [DVec3; 2],
    second: [DVec3; 3],
}

impl OffsetJet {
    /// Newton's step in the square; None if no step decreases the distance.
    fn step(&self, at: [f64; 2]) -> Option<[f64; 2]> {
        let [a, b] = self.first;
        let slope = [self.point.dot(a), self.point.dot(b)];
        // A parameter at its limit is not free if the distance falls only beyond it.
        let is_free =
            |k: usize| !(slope[k] == 0.0 || at[k] <= 0.0 && slope[k] > 0.0 || at[k] >= 1.0 && slope[k] < 0.0);
        let flat = [a.dot(a), a.dot(b), b.dot(b)];
        // Newton's second derivatives; without the part that depends on the bending (Gauss and
        // Newton) they are never negative, and serve where the full ones do not lead downhill.
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
                    // Far above the rounding error of a determinant that is 0.
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

/// The two halves of a cubic.
fn split([a, b, c, d]: [DVec3; 4]) -> [[DVec3; 4]; 2] {
    let middle = |p: DVec3, q: DVec3| 0.5 * (p + q);
    let (ab, bc, cd) = (middle(a, b), middle(b, c), middle(c, d));
    let (abc, bcd) = (middle(ab, bc), middle(bc, cd));
    let middle_point = middle(abc, bcd);
    [[a, ab, abc, middle_point], [middle_point, bcd, cd, d]]
}

fn longest(vectors: &[DVec3]) -> f64 {
    vectors.iter().fold(0.0, |largest, v| greater(largest, v.length_squared())).sqrt()
}

fn clamp(x: f64) -> f64 {
    if x > 0.0 { lesser(x, 1.0) } else { 0.0 }
}
