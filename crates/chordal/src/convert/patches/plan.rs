//! `Plan`: how patches are cut into tiles, and into how many cells each tile, so that the fewest triangles meet the budget.
//!
//! A tile is a rectangle of one patch's parameter plane with `n × m` equal cells. The number of cells that a
//! rectangle needs is about `bound/tolerance`, so a rectangle is halved where its halves together need fewer. None
//! of this has to be right: [`super::tile`] proves each tile afterwards and asks for more cells where they lack.
use super::bend::{Bend, Hessian, ROUNDING, across, worst_mix};
use crate::budget::{Pixels, View};
use crate::explicit::Patch;
use crate::math::Box3;
use glam::DVec3;

/// What a place of the shape may lose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Allowance {
    pub(crate) length: Option<f64>,
    pub(crate) pixels: Option<(Pixels, View)>,
}

impl Allowance {
    /// The length that may be lost in `place`; `None` where the eye is too close for any.
    pub(crate) fn at(&self, place: &Box3) -> Option<f64> {
        let by_view = match &self.pixels {
            Some((pixels, view)) => view.length_of(*pixels, place)?,
            None => f64::MAX,
        };
        let by_length = self.length.unwrap_or(f64::MAX);
        Some(if by_length < by_view { by_length } else { by_view })
    }
}

/// Why no mesh can meet an allowance, and near where.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Obstacle {
    /// The eye is so near that no length is small enough.
    TooClose(Box3),
    /// Rounding alone loses this length.
    BelowRounding(Box3, f64),
}

/// A rectangle of one patch with its cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tile {
    pub(crate) patch: u32,
    /// Start and end, dyadic numbers.
    pub(crate) u: [f64; 2],
    pub(crate) v: [f64; 2],
    /// Cells along u and along v.
    pub(crate) n: u32,
    pub(crate) m: u32,
    /// Whether cells are cut from their first corner to the opposite one (or between the other two).
    pub(crate) rising: bool,
    /// The length that this place may lose, rounding taken off.
    pub(crate) tolerance: f64,
    /// By how much its proof came out worse than its probe, 1 at first.
    pub(crate) strain: f64,
}

/// First and second derivatives at the corners and the middle of a tile.
pub(crate) struct Probe {
    places: [(DVec3, DVec3, Hessian); 5],
    bend: Bend,
}

/// The rates of a tile and the (real) number of cells that they come from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rates {
    pub(crate) n: u32,
    pub(crate) m: u32,
    pub(crate) rising: bool,
    pub(crate) cells: f64,
}

impl Probe {
    pub(crate) fn new(part: &Patch) -> Self {
        let bend = Bend::new(part);
        let place = |u: f64, v: f64| {
            let [by_u, by_v] = part.tangents(u, v).map(DVec3::from);
            (by_u, by_v, bend.at(u, v))
        };
        let corner = |i: usize, j: usize| {
            // At a corner the derivatives are differences of control points.
            let q = |a: usize, b: usize| {
                DVec3::from(part.control[if i == 0 { a } else { 3 - a }][if j == 0 { b } else { 3 - b }])
            };
            let (su, sv) = (if j == 0 { 3.0 } else { -3.0 }, if i == 0 { 3.0 } else { -3.0 });
            let (by_u, by_v) = (su * (q(0, 1) - q(0, 0)), sv * (q(1, 0) - q(0, 0)));
            let uu = 6.0 * ((q(0, 0) - q(0, 1)) - (q(0, 1) - q(0, 2)));
            let vv = 6.0 * ((q(0, 0) - q(1, 0)) - (q(1, 0) - q(2, 0)));
            let uv = su * sv * ((q(1, 1) - q(1, 0)) - (q(0, 1) - q(0, 0)));
            (by_u, by_v, Hessian { uu, uv, vv })
        };
        Self { places: [corner(0, 0), corner(0, 1), corner(1, 0), corner(1, 1), place(0.5, 0.5)], bend }
    }

    /// The bound on triangles that are halves of cells of `du × dv`, as far as the probed places tell.
    fn bound(&self, du: f64, dv: f64, rising: bool) -> f64 {
        let sign = if rising { 1.0 } else { -1.0 };
        let most = self.places.iter().fold(0.0, |most, (by_u, by_v, hessian)| {
            let along_u = across(hessian.half_along(du, 0.0), *by_u * du);
            let along_v = across(hessian.half_along(0.0, dv), *by_v * dv);
            let diagonal = across(hessian.half_along(du, sign * dv), *by_u * du + *by_v * (sign * dv));
            let bound = worst_mix(along_u, along_v, diagonal);
            if bound > most { bound } else { most }
        });
        most + self.bend.remainder(du, dv)
    }

    /// The rates with the fewest cells whose bound is at most `tolerance`, with at most `MOST_RATE` each way.
    pub(crate) fn rates(&self, tolerance: f64) -> Rates {
        let (ratio, rising, cells) = self.best_ratio(tolerance);
        let scale = cells.sqrt();
        let whole = |x: f64| {
            if x > MOST_RATE {
                MOST_RATE
            } else if x > 1.0 {
                x.ceil()
            } else {
                1.0
            }
        };
        let (n, m) = (whole(scale * ratio), whole(scale / ratio));
        // Rounded up one way, the other way may need less, and the reverse.
        let wide = self.fewest(n, tolerance, |n, m| self.bound(1.0 / n, 1.0 / m, rising));
        let tall = self.fewest(m, tolerance, |m, n| self.bound(1.0 / n, 1.0 / m, rising));
        let low = if n > 1.0 { n - 1.0 } else { 1.0 };
        let narrow = self.fewest(low, tolerance, |n, m| self.bound(1.0 / n, 1.0 / m, rising));
        let (n, m) = [(tall, m), (low, narrow)]
            .into_iter()
            .fold((n, wide), |best, new| if new.0 * new.1 < best.0 * best.1 { new } else { best });
        let cells = if scale * ratio < 1.0 || scale / ratio < 1.0 { n * m } else { cells };
        Rates { n: n as u32, m: m as u32, rising, cells }
    }

    /// The fewest cells of one way with which the bound meets the tolerance, given those of the other way.
    fn fewest(&self, given: f64, tolerance: f64, bound: impl Fn(f64, f64) -> f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        while bound(given, high) > tolerance && high < MOST_RATE {
            (low, high) = (high, 2.0 * high);
        }
        while high - low > 1.0 {
            let middle = ((low + high) * 0.5).floor();
            if bound(given, middle) <= tolerance { high = middle } else { low = middle }
        }
        high
    }

    /// The best `√(n/m)`, the diagonal, and the number of cells (a real number, at least 1): for a fixed ratio
    /// the bound falls with the number of cells, so `n·m = bound(ratio)/tolerance`.
    fn best_ratio(&self, tolerance: f64) -> (f64, bool, f64) {
        let (u, v) = self.places.iter().fold((0.0_f64, 0.0_f64), |(u, v), (by_u, by_v, hessian)| {
            let (bend_u, bend_v) = (across(hessian.uu, *by_u), across(hessian.vv, *by_v));
            (if bend_u > u { bend_u } else { u }, if bend_v > v { bend_v } else { v })
        });
        // Equal shares for both directions; clamped where a direction does not bend at all.
        let balanced = (u / v).sqrt().sqrt();
        let balanced = if balanced.is_nan() { 1.0 } else { balanced.clamp(1.0 / 64.0, 64.0) };
        let mut best = (1.0, true, f64::INFINITY);
        for step in RATIO_STEPS {
            let ratio = balanced * step;
            for rising in [true, false] {
                let cells = self.bound(ratio, 1.0 / ratio, rising) / tolerance;
                if cells < best.2 {
                    best = (ratio, rising, cells);
                }
            }
        }
        // A direction has at least one cell, so a ratio beyond the number of cells wastes nothing.
        if best.2 > 1.0 { best } else { (1.0, best.1, 1.0) }
    }
}

/// Cells one way of one tile; more are had by halving.
const MOST_RATE: f64 = 16_777_216.0;

/// Tried around the balanced ratio; finer steps won less than 1 % on the teapot and on random patches.
const RATIO_STEPS: [f64; 5] = [0.5, 0.707, 1.0, 1.414, 2.0];

/// A rectangle with fewer cells is never halved: the stitching would cost what it wins.
const FEWEST_CELLS_TO_HALVE: f64 = 6.0;
/// A rectangle with more cells is always halved, so that threads can share the work.
const MOST_CELLS: f64 = 4096.0;
/// Halving has to save this share of the cells, since tiles of unlike rates cost triangles where they meet.
const WORTH_HALVING: f64 = 0.93;

/// The tiles of one patch, in the order of a depth-first walk.
pub(crate) fn cut(patch_idx: u32, patch: &Patch, allowance: &Allowance) -> Result<Vec<Tile>, Obstacle> {
    let mut tiles = Vec::new();
    let context = (allowance, ROUNDING * patch.size());
    let mut open = vec![Open::new(*patch, [0.0, 1.0], [0.0, 1.0], context)?];
    while let Some(rectangle) = open.pop() {
        match rectangle.cheaper_halves(context)? {
            Some(halves) => open.extend(halves),
            None if rectangle.rates.cells > MOST_CELLS => open
                .extend(rectangle.halved(rectangle.rates.n >= rectangle.rates.m, context)?.into_iter().rev()),
            None => tiles.push(rectangle.tile(patch_idx)),
        }
    }
    Ok(tiles)
}

/// About how many triangles a patch needs, without laying them: rectangles are halved only while that pays.
pub(crate) fn estimate(patch: &Patch, allowance: &Allowance) -> Result<f64, Obstacle> {
    let context = (allowance, ROUNDING * patch.size());
    let mut open = vec![Open::new(*patch, [0.0, 1.0], [0.0, 1.0], context)?];
    let (mut cells, mut looked_at) = (0.0, 0);
    while let Some(rectangle) = open.pop() {
        looked_at += 1;
        match rectangle.cheaper_halves(context)? {
            Some(halves) if looked_at < MOST_LOOKS => open.extend(halves),
            _ => cells += rectangle.rates.cells,
        }
    }
    Ok(2.0 * cells)
}

/// Rectangles of one patch that an estimate looks at before it takes the sum as it stands.
const MOST_LOOKS: usize = 256;

/// A rectangle that may still be halved.
struct Open {
    part: Patch,
    u: [f64; 2],
    v: [f64; 2],
    tolerance: f64,
    rates: Rates,
}

impl Open {
    fn new(
        part: Patch,
        u: [f64; 2],
        v: [f64; 2],
        (allowance, rounding): (&Allowance, f64),
    ) -> Result<Self, Obstacle> {
        let place = part.hull();
        let tolerance = allowance.at(&place).ok_or(Obstacle::TooClose(place))? - rounding;
        if tolerance <= 0.0 {
            return Err(Obstacle::BelowRounding(place, rounding));
        }
        let rates = Probe::new(&part).rates(tolerance);
        Ok(Self { part, u, v, tolerance, rates })
    }

    /// The halves, second first, where they need clearly fewer cells together.
    fn cheaper_halves(&self, context: (&Allowance, f64)) -> Result<Option<[Self; 2]>, Obstacle> {
        if self.rates.cells <= FEWEST_CELLS_TO_HALVE {
            return Ok(None);
        }
        let (by_u, by_v) = (self.halved(true, context)?, self.halved(false, context)?);
        let needs = |halves: &[Self; 2]| halves[0].rates.cells + halves[1].rates.cells;
        let (need_u, need_v) = (needs(&by_u), needs(&by_v));
        let (need, [first, second]) = if need_u < need_v { (need_u, by_u) } else { (need_v, by_v) };
        Ok((need < WORTH_HALVING * self.rates.cells).then_some([second, first]))
    }

    fn halved(&self, along_u: bool, context: (&Allowance, f64)) -> Result<[Self; 2], Obstacle> {
        let middle = |[a, b]: [f64; 2]| 0.5 * (a + b);
        let (u, v) = (self.u, self.v);
        if along_u {
            let [left, right] = self.part.halves_u();
            let cut = middle(u);
            Ok([Self::new(left, [u[0], cut], v, context)?, Self::new(right, [cut, u[1]], v, context)?])
        } else {
            let [low, high] = self.part.halves_v();
            let cut = middle(v);
            Ok([Self::new(low, u, [v[0], cut], context)?, Self::new(high, u, [cut, v[1]], context)?])
        }
    }

    fn tile(&self, patch: u32) -> Tile {
        let Rates { n, m, rising, .. } = self.rates;
        Tile { patch, u: self.u, v: self.v, n, m, rising, tolerance: self.tolerance, strain: 1.0 }
    }
}
