//! `PointPath`: a sequence of points with lengths and corners, and the direction of a smooth path through them.
use super::least_squares::solve;
use crate::budget::{Failure, RefusalCode};
use crate::convert::curves::flatten::LARGEST;
use crate::math::{difference, distance, dot, greater, length};
use std::ops::Range;

/// The corners of a path through points, at which it is not smooth.
#[derive(Clone, Debug, PartialEq)]
pub enum Corners {
    /// The points at which the angle between the segments before and after is larger than this.
    Sharper {
        /// Between 0 and 180.
        deg: f64,
    },
    /// The points with these indices.
    At(Vec<usize>),
}

/// Points without repetitions. A closed path has its first point at the end again.
#[derive(Debug)]
pub(crate) struct PointPath<const D: usize> {
    pub points: Vec<[f64; D]>,
    pub closed: bool,
    /// The length up to each point.
    lengths: Vec<f64>,
    /// The points at which smooth runs start and end, in order: corners and the ends of an open path. For a closed path
    /// without corners, its first and its last point.
    stops: Vec<usize>,
    /// Whether it is closed and has no corner.
    smooth: bool,
}

/// The most points on either side by which a direction is computed. Chosen: more points would hardly change it.
const SIDE: usize = 16;

impl<const D: usize> PointPath<D> {
    /// A path through points, cut at its corners.
    ///
    /// # Errors
    /// If there is no point, a number is not finite or too large, or a corner's index or angle is out of range.
    pub fn new<T>(points: &[[f64; D]], closed: bool, corners: &Corners) -> Result<Self, Failure<T>> {
        let is_in_range = |p: &[f64; D]| p.iter().all(|x| x.abs() < LARGEST);
        if let Some(index) = points.iter().position(|p| !is_in_range(p)) {
            let message = format!("point {index} has a number that is not finite or beyond {LARGEST:e}");
            return Err(Failure::refused(RefusalCode::NotFinite, message));
        }
        if points.is_empty() {
            return Err(Failure::refused(RefusalCode::Empty, "a path needs a point"));
        }
        let mut distinct: Vec<usize> = Vec::with_capacity(points.len() + 1);
        for index in 0..points.len() {
            if distinct.last().is_none_or(|last| points[*last] != points[index]) {
                distinct.push(index);
            }
        }
        while closed && distinct.len() > 1 && points[distinct[0]] == points[distinct[distinct.len() - 1]] {
            distinct.pop();
        }
        let is_corner = are_corners(points, &distinct, closed, corners)?;
        // A closed path starts at a corner, if it has one.
        let first = if closed { is_corner.iter().position(|is| *is).unwrap_or(0) } else { 0 };
        let n = distinct.len();
        let in_order = |i: usize| (i + first) % n;
        let mut path = Self {
            points: (0..n).map(|i| points[distinct[in_order(i)]]).collect(),
            closed: closed && n > 1,
            lengths: vec![0.0],
            stops: (0..n).filter(|i| is_corner[in_order(*i)]).collect(),
            smooth: closed && n > 1 && !is_corner.contains(&true),
        };
        if path.closed {
            path.points.push(path.points[0]);
        }
        let last = path.points.len() - 1;
        if path.stops.first() != Some(&0) {
            path.stops.insert(0, 0);
        }
        if path.stops.last() != Some(&last) {
            path.stops.push(last);
        }
        let mut sum = 0.0;
        for pair in path.points.windows(2) {
            sum += distance(pair[1], pair[0]);
            path.lengths.push(sum);
        }
        Ok(path)
    }

    /// The smooth runs, each from a stop to the next.
    pub fn runs(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        self.stops.windows(2).map(|pair| [pair[0], pair[1]])
    }

    /// Whether the path is closed and smooth at its first point, too.
    pub fn is_smooth(&self) -> bool {
        self.smooth
    }

    /// The length between two points.
    pub fn length(&self, [from, to]: [usize; 2]) -> f64 {
        self.lengths[to] - self.lengths[from]
    }

    /// The direction at a point: that of the cubic polynomial in the path's length that fits best to the points of the smooth
    /// run within a length on the given sides.
    pub fn direction(&self, at: usize, reach: f64, sides: Range<f64>) -> [f64; D] {
        let near = self.near(at, reach, &sides);
        let far = near.iter().fold(0.0, |far: f64, (u, _)| greater(far, u.abs()));
        let size = near.iter().fold(0.0, |size: f64, (_, p)| greater(size, length(*p)));
        if !(far > 0.0 && size > 0.0) {
            return [0.0; D];
        }
        let scaled: Vec<(f64, [f64; D])> = near.iter().map(|(u, p)| (u / far, p.map(|x| x / size))).collect();
        let slope = match scaled.len() {
            0..=2 => slope::<2, D>(&scaled),
            3 => slope::<3, D>(&scaled),
            _ => slope::<4, D>(&scaled),
        };
        // The direction of the best line, if no polynomial can be fitted.
        let chord = scaled.iter().fold([0.0; D], |sum, (u, p)| std::array::from_fn(|k| sum[k] + u * p[k]));
        let slope = slope.filter(|slope| dot(*slope, *slope) > 0.0).unwrap_or(chord);
        let speed = length(slope);
        if speed > 0.0 && speed.is_finite() { slope.map(|x| x / speed) } else { [0.0; D] }
    }

    /// The path lengths and offsets from a point to itself and to points near it.
    fn near(&self, at: usize, reach: f64, sides: &Range<f64>) -> Vec<(f64, [f64; D])> {
        let last = self.points.len() - 1;
        let mut near = vec![(0.0, [0.0; D])];
        for (side, is_on) in [(-1.0, sides.start < 0.0), (1.0, sides.end > 0.0)] {
            if !is_on {
                continue;
            }
            // The number of candidates on this side, from the nearest on: up to the next stop, or once around.
            let count = if self.smooth {
                last - 1
            } else if side < 0.0 {
                at - self.stops[self.stops.partition_point(|stop| *stop < at).saturating_sub(1)].min(at)
            } else {
                self.stops[self.stops.partition_point(|stop| *stop <= at).min(self.stops.len() - 1)].max(at)
                    - at
            };
            let candidate = |i: usize| -> (f64, usize) {
                let (whole, total) = (last, self.lengths[last]);
                if side < 0.0 {
                    let wraps = i > at;
                    let index = if wraps { at + whole - i } else { at - i };
                    let length = self.lengths[at] - self.lengths[index] + if wraps { total } else { 0.0 };
                    (length, index)
                } else {
                    let wraps = at + i > whole;
                    let index = if wraps { at + i - whole } else { at + i };
                    let length = self.lengths[index] - self.lengths[at] + if wraps { total } else { 0.0 };
                    (length, index)
                }
            };
            // The number within reach, by bisection; at least one.
            let (mut few, mut many) = (0, count + 1);
            while many - few > 1 {
                let middle = few + (many - few) / 2;
                if candidate(middle).0 <= reach { few = middle } else { many = middle }
            }
            let within = few.max(1).min(count);
            let step = within.div_ceil(SIDE).max(1);
            // From the farthest inwards, so that thinning keeps that one.
            let mut i = within;
            while i > 0 {
                let (length, index) = candidate(i);
                near.push((side * length, difference(self.points[index], self.points[at])));
                i = i.saturating_sub(step);
            }
        }
        near
    }
}

fn are_corners<const D: usize, T>(
    points: &[[f64; D]],
    distinct: &[usize],
    closed: bool,
    corners: &Corners,
) -> Result<Vec<bool>, Failure<T>> {
    let n = distinct.len();
    match corners {
        Corners::At(indices) => {
            if let Some(index) = indices.iter().find(|index| **index >= points.len()) {
                let message = format!("corner {index} is not one of the {} points", points.len());
                return Err(Failure::refused(RefusalCode::Budget, message));
            }
            let mut is_corner = vec![false; n];
            for index in indices {
                // A point that repeats the one before has been merged into it; the last ones of a closed path may repeat the first.
                let at = distinct.partition_point(|k| k <= index).saturating_sub(1);
                let at = if points[distinct[at]] == points[*index] { at } else { 0 };
                is_corner[at] = true;
            }
            Ok(is_corner)
        }
        Corners::Sharper { deg } => {
            if !(0.0..=180.0).contains(deg) {
                let message =
                    format!("the angle from which on a point is a corner is 0 to 180 degrees, not {deg}");
                return Err(Failure::refused(RefusalCode::Budget, message));
            }
            let least = libm::cos(deg.to_radians());
            let turns = |i: usize| {
                if n < 2 || !closed && (i == 0 || i + 1 == n) {
                    return false;
                }
                let [a, b, c] = [(i + n - 1) % n, i, (i + 1) % n].map(|i| points[distinct[i]]);
                let unit = |from: [f64; D], to: [f64; D]| {
                    let step = difference(to, from);
                    // By the largest component first, so that no square overflows or vanishes.
                    let size = step.iter().fold(0.0, |size: f64, x| greater(size, x.abs()));
                    let step = step.map(|x| x / size);
                    let norm = length(step);
                    step.map(|x| x / norm)
                };
                // At 180° nothing is a corner, not even by rounding.
                *deg < 180.0 && dot(unit(a, b), unit(b, c)) < least
            };
            Ok((0..n).map(turns).collect())
        }
    }
}

/// The slope at 0 of the polynomial with `N` coefficients that fits best to points, by least squares.
fn slope<const N: usize, const D: usize>(points: &[(f64, [f64; D])]) -> Option<[f64; D]> {
    let (mut matrix, mut right) = ([[0.0; N]; N], [[0.0; D]; N]);
    for (u, p) in points {
        let mut powers = [1.0; N];
        for i in 1..N {
            powers[i] = powers[i - 1] * u;
        }
        for i in 0..N {
            for j in 0..N {
                matrix[i][j] += powers[i] * powers[j];
            }
            for k in 0..D {
                right[i][k] += powers[i] * p[k];
            }
        }
    }
    solve(matrix, right).map(|solved| solved[1])
}
