//! Cuts a NURBS surface into bicubic patches, as few as a length allows in each direction.
use super::fit_error::ProductFactors;
use crate::budget::{Job, par_map};
use crate::explicit::Patch;
use crate::explicit::nurbs::{BernsteinRow, BezierNet, NurbsSurface, SurfaceJet};
use crate::math::{distance, greater, lesser};

/// Patches near a surface, and a bound for their distance from it.
pub(in crate::convert) struct FittedSurface {
    /// Row by row.
    pub patches: Vec<Patch>,
    pub at_most: f64,
    /// By direction and piece: its number of parts.
    pub cuts: [Vec<usize>; 2],
}

/// The most cuts of a piece in one direction. Chosen: errors go down with its fourth power, so that all digits of a
/// double are reached long before.
const MOST_CUTS: usize = 1 << 12;
/// The most rounds of cuts. Chosen: one round reaches the length once errors fall with the fourth power.
const MOST_ROUNDS: usize = 24;
/// More rounds than this without a nearer result end the search. Chosen: then the rest of the error is rounding.
const MOST_WORSE: usize = 2;
/// The share of the length for errors along one direction. Chosen: both add up, with a rest for the middle.
const ALONG: f64 = 0.4;
/// Points closer than this, relative to the largest coordinate, count as equal at the two ends of a closed direction or
/// along a side. Chosen: some roundings of evaluation; the bound holds in any case, since it is of the final patches.
const EQUAL: f64 = 1e-13;

/// A surface while its patches are fitted.
struct SurfaceFitter<'a> {
    net: BezierNet<'a>,
    factors: ProductFactors,
    /// By direction: whether the surface returns to its start.
    closes: [bool; 2],
    /// By direction and end: the point of this side, if all of it is one point.
    poles: [[Option<[f64; 3]>; 2]; 2],
    /// By direction and piece: its number of parts.
    cuts: [Vec<usize>; 2],
}

/// A rectangle of a piece, by indices of its parts.
#[derive(Clone, Copy)]
struct SubRectangle {
    piece: [usize; 2],
    part: [usize; 2],
}

/// Patches within a length of a surface, or the nearest that the limits allow.
pub(in crate::convert) fn fit(surface: &NurbsSurface, length: f64, job: &Job) -> FittedSurface {
    let mut fitter = SurfaceFitter::new(surface);
    let most = (job.memory_limit / PATCH_BYTES).min(job.triangle_limit);
    let (mut fitted, mut n_worse) = (fitter.patches(job), 0);
    let mut best = (fitted.clone(), fitter.cuts.clone());
    for _ in 0..MOST_ROUNDS {
        if farthest(&fitted) <= length || job.is_cancelled() || !fitter.cut_further(&fitted, length) {
            break;
        }
        let count = fitter.cuts.each_ref().map(|of| of.iter().sum::<usize>() as u64);
        if count[0].saturating_mul(count[1]) > most {
            break;
        }
        fitted = fitter.patches(job);
        n_worse = if farthest(&fitted) < farthest(&best.0) { 0 } else { n_worse + 1 };
        if n_worse == 0 {
            best = (fitted.clone(), fitter.cuts.clone());
        }
        if n_worse > MOST_WORSE {
            break;
        }
    }
    let (best, cuts) = best;
    FittedSurface {
        at_most: farthest(&best),
        patches: best.into_iter().map(|(patch, _)| patch).collect(),
        cuts,
    }
}

/// The patches of a surface, with these numbers of parts by direction and piece.
pub(in crate::convert) fn fit_parts(
    surface: &NurbsSurface,
    cuts: [Vec<usize>; 2],
    job: &Job,
) -> FittedSurface {
    let mut fitter = SurfaceFitter::new(surface);
    fitter.cuts = cuts;
    let fitted = fitter.patches(job);
    FittedSurface {
        at_most: farthest(&fitted),
        patches: fitted.into_iter().map(|(patch, _)| patch).collect(),
        cuts: fitter.cuts,
    }
}

/// The largest distance of patches; infinite if one is not known.
fn farthest(fitted: &[(Patch, f64)]) -> f64 {
    fitted.iter().fold(
        0.0,
        |far, (_, distance)| if distance.is_nan() { f64::INFINITY } else { greater(*distance, far) },
    )
}

/// The memory of a patch with its bound, and of its triangles while it is meshed.
const PATCH_BYTES: u64 = 2048;

impl<'a> SurfaceFitter<'a> {
    fn new(surface: &'a NurbsSurface) -> Self {
        let net = surface.bezier_net();
        let [n, m] = net.n_pieces();
        let bounds = surface.bounds();
        let reach = bounds.min.iter().chain(&bounds.max).fold(0.0, |far: f64, x| greater(x.abs(), far));
        // If the surface closes, the coefficients of one side are near those of the other.
        let near = |a: [f64; 3], b: [f64; 3]| distance(a, b) <= EQUAL * reach;
        let sides = net.sides();
        let is_closed = |k: usize| {
            let [from, to] = &sides[k];
            from.iter().zip(to).all(|(a, b)| near(point(a), point(b)) && (a[3] - b[3]).abs() <= EQUAL * a[3])
        };
        let pole = |side: &Vec<[f64; 4]>| {
            let first = point(&side[0]);
            side.iter().all(|x| near(point(x), first)).then_some(first)
        };
        let poles = sides.each_ref().map(|ends| ends.each_ref().map(pole));
        let factors = ProductFactors::new(net.degrees(), reach);
        Self { closes: [0, 1].map(is_closed), poles, factors, cuts: [vec![1; n], vec![1; m]], net }
    }

    /// All parts, row by row.
    fn parts(&self) -> Vec<SubRectangle> {
        let [along_u, along_v] = self.cuts.each_ref().map(|cuts| {
            let of = |(piece, n): (usize, &usize)| (0..*n).map(move |part| (piece, part));
            cuts.iter().enumerate().flat_map(of).collect::<Vec<_>>()
        });
        let row = |(b, t): (usize, usize)| {
            along_u.iter().map(move |(a, s)| SubRectangle { piece: [*a, b], part: [*s, t] })
        };
        along_v.iter().copied().flat_map(row).collect()
    }

    /// The patches of all parts, each with its distance.
    fn patches(&self, job: &Job) -> Vec<(Patch, f64)> {
        par_map(job, &self.parts(), |_, part| self.patch(*part))
    }

    /// The patch of a part and its distance.
    fn patch(&self, part: SubRectangle) -> (Patch, f64) {
        let corners = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|end| self.corner(part, end));
        let scale = [0, 1].map(|k| 1.0 / (3.0 * self.cuts[k][part.piece[k]] as f64));
        let patch = hermite_patch(&corners, scale);
        let [[a, b], [c, d]] = [0, 1].map(|k| {
            let n = self.cuts[k][part.piece[k]] as f64;
            [part.part[k] as f64 / n, (part.part[k] + 1) as f64 / n]
        });
        let rows: Vec<BernsteinRow<4>> = self.net.rows(part.piece).iter().map(|row| row.part(a, b)).collect();
        let distance = self.factors.distance(&rows_part(&rows, c, d), &patch);
        (patch, distance)
    }

    /// The position and derivatives at a corner; at a seam the derivatives along it are taken from its first side.
    fn corner(&self, SubRectangle { piece, part }: SubRectangle, end: [usize; 2]) -> SurfaceJet {
        let step = [0, 1].map(|k| part[k] + end[k]);
        let parameter = |k: usize| step[k] as f64 / self.cuts[k][piece[k]] as f64;
        let places = [0, 1].map(parameter);
        let mut jet = self.net.jet(piece, places);
        let is_last = |k: usize| piece[k] + 1 == self.cuts[k].len() && step[k] == self.cuts[k][piece[k]];
        let is_first = |k: usize| piece[k] == 0 && step[k] == 0;
        for k in 0..2 {
            if self.closes[k] && is_last(k) {
                let (mut first, mut at) = (piece, places);
                (first[k], at[k]) = (0, 0.0);
                let there = self.net.jet(first, at);
                jet.position = there.position;
                if k == 0 { jet.v = there.v } else { jet.u = there.u }
            }
        }
        // The position set last is that of the far end of a seam, which differs by rounding.
        if self.closes == [true; 2] && is_last(0) && is_last(1) {
            jet.position = self.net.jet([0; 2], [0.0; 2]).position;
        }
        for k in 0..2 {
            let pole = match (is_first(k), is_last(k)) {
                (true, _) => self.poles[k][0],
                (_, true) => self.poles[k][1],
                _ => None,
            };
            if let Some(point) = pole {
                jet.position = point;
                // The derivative along the side is 0.
                if k == 0 { jet.v = [0.0; 3] } else { jet.u = [0.0; 3] }
            }
        }
        jet
    }

    /// Cuts pieces in the directions of parts that are too far; whether any was cut.
    fn cut_further(&mut self, fitted: &[(Patch, f64)], most: f64) -> bool {
        let mut cuts = self.cuts.clone();
        for (part, (patch, distance)) in self.parts().into_iter().zip(fitted) {
            if *distance <= most {
                continue;
            }
            let errors = self.errors_along(part, patch);
            let allowance = ALONG * most;
            let is_clear = errors.iter().any(|error| *error > allowance);
            for k in 0..2 {
                let now = self.cuts[k][part.piece[k]] as f64;
                // Errors go with the fourth power of the size. Without a clear error at the sides, it is between
                // them.
                let factor = if errors[k] > allowance { (errors[k] / allowance).sqrt().sqrt() } else { 1.0 };
                let factor = if is_clear { factor } else { 1.25 };
                let more = (now * lesser(factor, 8.0)).ceil();
                let more = if factor > 1.0 { greater(more, now + 1.0) } else { now };
                let best = &mut cuts[k][part.piece[k]];
                *best = (*best).max(more as usize).min(MOST_CUTS);
            }
        }
        let is_more = cuts != self.cuts;
        self.cuts = cuts;
        is_more
    }

    /// The larger distance of the middles of the patch's sides along `u` from the surface's points there, and the same
    /// along `v`.
    fn errors_along(&self, SubRectangle { piece, part }: SubRectangle, patch: &Patch) -> [f64; 2] {
        let parameter = |k: usize, at: f64| (part[k] as f64 + at) / self.cuts[k][piece[k]] as f64;
        let error_at = |u: f64, v: f64| {
            let there = self.net.jet(piece, [parameter(0, u), parameter(1, v)]).position;
            distance(there, patch.at(u, v))
        };
        let [bottom, top, left, right] =
            [error_at(0.5, 0.0), error_at(0.5, 1.0), error_at(0.0, 0.5), error_at(1.0, 0.5)];
        [greater(bottom, top), greater(left, right)]
    }
}

fn point(x: &[f64; 4]) -> [f64; 3] {
    [x[0] / x[3], x[1] / x[3], x[2] / x[3]]
}

/// The rows of the part of a piece between two parameters across the rows.
fn rows_part(rows: &[BernsteinRow<4>], c: f64, d: f64) -> Vec<BernsteinRow<4>> {
    let width = rows[0].0.len();
    let columns: Vec<BernsteinRow<4>> =
        (0..width).map(|i| BernsteinRow(rows.iter().map(|row| row.0[i]).collect()).part(c, d)).collect();
    (0..rows.len()).map(|j| BernsteinRow(columns.iter().map(|column| column.0[j]).collect())).collect()
}

/// The patch with these positions and derivatives at its corners, the latter scaled by `[du, dv]`; each control point
/// of a side depends on that side's ends alone.
fn hermite_patch(corners: &[SurfaceJet; 4], [du, dv]: [f64; 2]) -> Patch {
    let control = |i: usize, j: usize| -> [f64; 3] {
        let (right, top) = (i > 1, j > 1);
        let at = &corners[usize::from(right) + 2 * usize::from(top)];
        let (u, v) = (if right { -du } else { du }, if top { -dv } else { dv });
        let (inner_u, inner_v) = (i == 1 || i == 2, j == 1 || j == 2);
        std::array::from_fn(|k| match (inner_u, inner_v) {
            (false, false) => at.position[k],
            (true, false) => at.position[k] + u * at.u[k],
            (false, true) => at.position[k] + v * at.v[k],
            (true, true) => at.position[k] + u * at.u[k] + v * at.v[k] + u * v * at.uv[k],
        })
    };
    Patch { control: std::array::from_fn(|j| std::array::from_fn(|i| control(i, j))) }
}
