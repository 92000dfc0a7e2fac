//! `CellEstimator`: a cheap estimate of how many cells a rectangle of a patch needs, from nine sample points.
//!
//! It affects only the number of triangles, never the bound: [`super::tile`] proves every tile afterwards. At
//! each sample point the bound of [`super::derivative_bound`] is split in two. The part along the surface
//! normal is a quadratic form in the cell's sides and cheap to evaluate for many cell shapes. The rest is
//! computed once, for the cell shape that suits the rectangle best, and assumed to grow with the cell's area.
use super::derivative_bound::{Hessian, across, max_barycentric_quadratic};
use crate::explicit::Patch;
use crate::math::{greater, lesser};
use glam::DVec3;

/// Sample points of a 3 × 3 lattice.
const PLACES: usize = 9;

/// Cell shapes that are tried around the balanced one, as factors of its `√(width/height)`. Measured: finer steps
/// save less than 1 % of the triangles on the teapot and on random patches.
const STEPS: [f64; 3] = [0.65, 1.0, 1.55];

/// Every step with both diagonals.
const SHAPES: usize = 2 * STEPS.len();

/// The contribution of third derivatives to the bound, as a fraction of their products with the sides of a cell.
/// Measured on the cages of the tests: three times this share takes 8 % more triangles at a thousandth and 14 % at a
/// hundredth; three fifths of it take as many, and 2 % more.
const SHARE_OF_THIRD: f64 = 0.02;

/// The largest number of cells in one direction of one tile; more are reached by halving the tile.
const MOST_RATE: f64 = 16_777_216.0;

/// The second derivatives along the normal, and the remainder, at nine sample points.
pub(crate) struct CellEstimator {
    /// All lengths here are those of the patch times this factor. They are about 1, so that neither huge nor
    /// tiny patches leave the range of f64 where four lengths are multiplied.
    scale: f64,
    uu: [f64; PLACES],
    uv: [f64; PLACES],
    vv: [f64; PLACES],
    /// By diagonal: the bound beyond the normal part, for a cell of area 1.
    rest: [[f64; PLACES]; 2],
    /// Estimates of the third derivatives.
    third: [f64; 4],
    /// `√(width/height)` of the cell with equal bending in both directions.
    balanced: f64,
}

/// The estimated number of cells (a real number, at least 1), their shape, and the effect of halving.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellEstimate {
    pub(crate) cells: f64,
    /// `√(width/height)` of a cell, in parameters.
    ratio: f64,
    rising: bool,
    /// Cells after halving along u and along v, as a fraction of `cells`.
    pub(crate) after_halving: [f64; 2],
}

impl CellEstimate {
    /// Cells along u and along v.
    pub(crate) fn each_way(&self) -> [f64; 2] {
        let side = self.cells.sqrt();
        [side / self.ratio, side * self.ratio]
    }
}

/// The number of cells along u and v, and the diagonal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TessellationRates {
    pub(crate) n: u32,
    pub(crate) m: u32,
    pub(crate) rising: bool,
}

impl CellEstimator {
    /// Builds the estimator from the control points of the rectangle's part.
    pub(crate) fn new(part: &Patch) -> Self {
        let scale = power_of_two_over(part.size());
        let places = derivatives(part, scale);
        let mut probe = Self {
            scale,
            uu: [0.0; PLACES],
            uv: [0.0; PLACES],
            vv: [0.0; PLACES],
            rest: [[0.0; PLACES]; 2],
            third: third_differences(&places),
            balanced: balanced_aspect(&places),
        };
        // The balanced cell, limited to the rectangle: for a cell that extends far beyond it, sliding would seem
        // to help less than it really does if the surface folds over itself.
        let square = probe.balanced * probe.balanced;
        let (du, dv) = if square > 1.0 { (1.0, 1.0 / square) } else { (square, 1.0) };
        for (k, (by_u, by_v, hessian)) in places.iter().enumerate() {
            let normal = by_u.cross(*by_v).normalize_or_zero();
            (probe.uu[k], probe.uv[k], probe.vv[k]) =
                (0.5 * hessian.uu.dot(normal), hessian.uv.dot(normal), 0.5 * hessian.vv.dot(normal));
            let along_u = across(hessian.half_along(du, 0.0), *by_u * du);
            let along_v = across(hessian.half_along(0.0, dv), *by_v * dv);
            for (diagonal, sign) in [(0, 1.0), (1, -1.0)] {
                let bend = hessian.half_along(du, sign * dv);
                let full = max_barycentric_quadratic(
                    along_u,
                    along_v,
                    across(bend, *by_u * du + *by_v * (sign * dv)),
                );
                let rest = full - probe.normal_part(k, [du * du, sign * du * dv, dv * dv]);
                probe.rest[diagonal][k] = if rest > 0.0 { rest / (du * dv) } else { 0.0 };
            }
        }
        probe
    }

    /// The bound along the normal at one sample point, scaled, for a cell with the squares and product
    /// `[du², ±du·dv, dv²]`.
    #[inline(always)]
    fn normal_part(&self, k: usize, [uu, uv, vv]: [f64; 3]) -> f64 {
        let (a, b) = (self.uu[k] * uu, self.vv[k] * vv);
        let (c, a, b) = ((a + self.uv[k] * uv + b).abs(), a.abs(), b.abs());
        // Like `max_barycentric_quadratic`, but without branches and less exact, since only an estimate is needed.
        let most = greater(a, b);
        let most = greater(c, most);
        // x·y + y·z + z·x is the denominator of the closed form, and the maximum is inside the triangle if
        // all three are positive.
        let (x, y, z) = (b + c - a, c + a - b, a + b - c);
        let inside = (a * b * c) / (x * y + y * z + z * x);
        if x > 0.0 && y > 0.0 && z > 0.0 { inside } else { 0.25 * most }
    }

    #[inline(always)]
    fn remainder(&self, du: f64, dv: f64) -> f64 {
        let [uuu, uuv, uvv, vvv] = self.third;
        let (uu, uv, vv) = (du * uuu + dv * uuv, du * uuv + dv * uvv, du * uvv + dv * vvv);
        (du * du * uu + 2.0 * du * dv * uv + dv * dv * vv) * SHARE_OF_THIRD
    }

    /// The bound, scaled, of cells of `du × dv` everywhere in the rectangle.
    fn bound(&self, du: f64, dv: f64, rising: bool) -> f64 {
        let sign = if rising { 1.0 } else { -1.0 };
        let rest = &self.rest[usize::from(!rising)];
        let squares = [du * du, sign * du * dv, dv * dv];
        let mut places = [0.0; PLACES];
        for k in 0..PLACES {
            places[k] = self.normal_part(k, squares) + rest[k] * du * dv;
        }
        largest(&places, 0..PLACES) + self.remainder(du, dv)
    }

    /// The number of cells that meet `tolerance`. At a fixed shape the bound falls with the number of cells,
    /// so `cells = bound/tolerance` for the best shape.
    pub(crate) fn estimate(&self, tolerance: f64) -> CellEstimate {
        let tolerance = tolerance * self.scale;
        let mut best = [f64::INFINITY; 5];
        let mut shape = (self.balanced, true);
        for option in 0..SHAPES {
            let (ratio, rising) = (self.balanced * STEPS[option / 2], option % 2 == 0);
            let (sign, rest) = if rising { (1.0, &self.rest[0]) } else { (-1.0, &self.rest[1]) };
            let squares = [ratio * ratio, sign, 1.0 / (ratio * ratio)];
            let mut bounds = [0.0; PLACES];
            for k in 0..PLACES {
                bounds[k] = self.normal_part(k, squares) + rest[k];
            }
            let column = |j: usize| largest(&[bounds[j], bounds[j + 3], bounds[j + 6]], 0..3);
            let row = |i: usize| largest(&bounds, 3 * i..3 * i + 3);
            let (columns, rows) = ([column(0), column(1), column(2)], [row(0), row(1), row(2)]);
            // The whole rectangle, then its left, right, lower and upper half; the middle column or row is in
            // two of them.
            let halves = [
                greater(columns[0], greater(columns[1], columns[2])),
                greater(columns[0], columns[1]),
                greater(columns[1], columns[2]),
                greater(rows[0], rows[1]),
                greater(rows[1], rows[2]),
            ];
            if halves[0] < best[0] {
                shape = (ratio, rising);
            }
            for (best, half) in best.iter_mut().zip(halves) {
                *best = lesser(half, *best);
            }
        }
        let (ratio, rising) = shape;
        let scale = (best[0] / tolerance).sqrt();
        // Each direction has at least one cell; if that is more than needed, the other direction has to make up for it
        // alone. Two rounds, because the remainder falls with the cube of the cell's size and not with its square.
        let at_least_one = |x: f64| greater(x, 1.0);
        let (mut n, mut m) = (at_least_one(scale / ratio), at_least_one(scale * ratio));
        for _ in 0..2 {
            let more = (self.bound(1.0 / n, 1.0 / m, rising) / tolerance).sqrt();
            (n, m) = match (n > 1.0, m > 1.0) {
                (true, false) => (at_least_one(n * more), at_least_one(more)),
                (false, true) => (at_least_one(more), at_least_one(m * more)),
                _ => (at_least_one(n * more), at_least_one(m * more)),
            };
        }
        let (cells, ratio) = (n * m, (m / n).sqrt());
        let share = |a: f64, b: f64| if best[0] > 0.0 { 0.5 * (a + b) / best[0] } else { 1.0 };
        CellEstimate {
            cells,
            ratio,
            rising,
            after_halving: [share(best[1], best[2]), share(best[3], best[4])],
        }
    }

    /// The fewest whole cells near the estimate.
    pub(crate) fn rates(&self, need: &CellEstimate, tolerance: f64) -> TessellationRates {
        let tolerance = tolerance * self.scale;
        let clamp = |x: f64| {
            if x > MOST_RATE {
                MOST_RATE
            } else if x > 1.0 {
                x
            } else {
                1.0
            }
        };
        let mut n = clamp((need.cells.sqrt() / need.ratio).floor());
        let mut best: Option<(f64, f64)> = None;
        // With one column too few, very many rows may be needed, or no number may be enough. So columns are added
        // until a number of rows near the expected one suffices, and once more after that.
        for _ in 0..64 {
            let settled = best.is_some();
            if let Some(m) = self.rows(n, need, tolerance)
                && best.is_none_or(|best| n * m < best.0 * best.1)
            {
                best = Some((n, m));
            }
            if settled || n >= MOST_RATE {
                break;
            }
            n = clamp((n * 1.03).floor() + 1.0);
        }
        let (n, m) = best.unwrap_or((n, clamp((need.cells / n).ceil())));
        TessellationRates { n: n as u32, m: m as u32, rising: need.rising }
    }

    /// The fewest rows that suffice with `n` columns, if that is at most about twice as many as expected.
    fn rows(&self, n: f64, need: &CellEstimate, tolerance: f64) -> Option<f64> {
        let fits = |m: f64| self.bound(1.0 / n, 1.0 / m, need.rising) <= tolerance;
        let expected = (need.cells / n).ceil();
        let mut m = greater(expected, 1.0);
        while !fits(m) {
            m = (m * 1.07).ceil();
            if m > 2.0 * expected + 2.0 || m > MOST_RATE {
                return None;
            }
        }
        while m > 1.0 && fits(m - 1.0) {
            m -= 1.0;
        }
        Some(m)
    }
}

fn largest(list: &[f64], range: std::ops::Range<usize>) -> f64 {
    list[range].iter().fold(0.0, |most, x| greater(*x, most))
}

/// The power of two that scales `size` to between 1 and 2, if that is a normal number.
fn power_of_two_over(size: f64) -> f64 {
    let exponent = (size.to_bits() >> 52) as i64 - 1023;
    f64::from_bits(((1023 - exponent.clamp(-1000, 1000)) as u64) << 52)
}

type SampleDerivatives = (DVec3, DVec3, Hessian);

/// First and second derivatives at the lattice: `v` and then `u` in {0, ½, 1}.
fn derivatives(part: &Patch, scale: f64) -> [SampleDerivatives; PLACES] {
    let q: [[DVec3; 4]; 4] = part.control.map(|row| row.map(|p| DVec3::from(p) * scale));
    let column = |j: usize| [q[0][j], q[1][j], q[2][j], q[3][j]];
    let lines: [[[DVec3; 3]; 3]; 4] = std::array::from_fn(|j| line(column(j)));
    let mut places =
        [(DVec3::ZERO, DVec3::ZERO, Hessian { uu: DVec3::ZERO, uv: DVec3::ZERO, vv: DVec3::ZERO }); PLACES];
    for i in 0..3 {
        let along = |order: usize| {
            line([lines[0][i][order], lines[1][i][order], lines[2][i][order], lines[3][i][order]])
        };
        let (value, slope, bend) = (along(0), along(1), along(2));
        for j in 0..3 {
            let hessian = Hessian { uu: value[j][2], uv: slope[j][1], vv: bend[j][0] };
            places[3 * i + j] = (value[j][1], slope[j][0], hessian);
        }
    }
    places
}

/// Value, first and second derivative of a cubic at 0, ½ and 1.
#[inline]
fn line([a, b, c, d]: [DVec3; 4]) -> [[DVec3; 3]; 3] {
    [
        [a, 3.0 * (b - a), 6.0 * (a - 2.0 * b + c)],
        [0.125 * (a + d) + 0.375 * (b + c), 0.75 * ((d - a) + (c - b)), 3.0 * ((a - b) + (d - c))],
        [d, 3.0 * (d - c), 6.0 * (b - 2.0 * c + d)],
    ]
}

/// Third derivatives, as differences of second derivatives across the rectangle.
fn third_differences(places: &[SampleDerivatives; PLACES]) -> [f64; 4] {
    let most = |step: usize, starts: [usize; 3], pick: fn(&Hessian) -> DVec3| {
        starts.iter().fold(0.0, |most: f64, &start| {
            let length = (pick(&places[start + 2 * step].2) - pick(&places[start].2)).length();
            greater(length, most)
        })
    };
    let (rows, columns) = ([0, 3, 6], [0, 1, 2]);
    [most(1, rows, |h| h.uu), most(3, columns, |h| h.uu), most(1, rows, |h| h.vv), most(3, columns, |h| h.vv)]
}

/// `√(width/height)` of the cell whose two sides have equal maximal bending.
fn balanced_aspect(places: &[SampleDerivatives; PLACES]) -> f64 {
    let across_sq = |bend: DVec3, chord: DVec3| {
        let (along, chord_sq, bend_sq) = (bend.dot(chord), chord.length_squared(), bend.length_squared());
        let across_sq = bend_sq - if chord_sq > 0.0 { along * along / chord_sq } else { 0.0 };
        // Chosen: at least a hundredth of the length, below which the difference is noise; only the cell shape
        // depends on it.
        greater(across_sq, 1e-4 * bend_sq)
    };
    let (u, v) = places.iter().fold((0.0, 0.0), |(u, v): (f64, f64), (by_u, by_v, hessian)| {
        let (bend_u, bend_v) = (across_sq(hessian.uu, *by_u), across_sq(hessian.vv, *by_v));
        (greater(bend_u, u), greater(bend_v, v))
    });
    // |S_uu|·width² = |S_vv|·height²; limited where a direction hardly bends at all.
    let ratio = (v / u).sqrt().sqrt().sqrt();
    if ratio.is_nan() { 1.0 } else { ratio.clamp(1.0 / 64.0, 64.0) }
}
