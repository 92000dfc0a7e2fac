//! A bound on the difference between a spline of frames along a path and the frames that do not rotate about it.
//!
//! The path is `X/W`, and `D = X′W − XW′` its direction: `T = D/|D|`. The spline has numerators `σ, ρ, τ` for the vectors to
//! the side, up and ahead, with a denominator `w`. From `ρ/w` comes a frame that is exactly perpendicular to the path: `r`,
//! along `q = ρ/w − (ρ·T/w)·T`, and `r×T`. All quantities below are polynomials, and their Bernstein coefficients in
//! intervals bound them over a piece.
//!
//! *Vectors.* `ρ/w` differs from `r` by its part along the path, `ρ·D/(w|D|)`, and by its length, with
//! `| |q| − 1 | ≤ | |q|² − 1 |`. `σ/w` has a part along the path, `σ·D/(w|D|)`, and a part along `r`, from `σ·ρ/w²`; the rest
//! of its length is along `r×T`, since `σ·(ρ×D) > 0`. `τ/w` has a part across the path, `|τ×D|/(w|D|)`; the rest of its
//! length is along the path, since `τ·D > 0`.
//!
//! *Twist.* A frame that does not rotate about the path has `r′·(T×r) = 0` (R. L. Bishop, 1975). Any other frame is such a
//! frame, turned about `T` by the integral of `ω = r′·(T×r)`. For the frame above
//! `ω = (|D|²·det(ρ′, D, ρ) − (ρ·D)·det(D′, D, ρ)) / (|D|·(|ρ|²|D|² − (ρ·D)²))`,
//! and its numerator vanishes as the spline approaches a frame that does not rotate. The integral of `|ω|` over all pieces
//! before bounds the angle between the two, and so the distance of two unit vectors. If a twist is spread evenly over the
//! length, `k` for each unit, `ω − k|D|/W²` replaces `ω`.
//!
//! *Joins.* If the direction jumps by `α` between two pieces (a rounding), the frame is turned by the least rotation that
//! takes one direction to the other. `ρ/w` is the same on both sides. Its parts across the two directions differ by `2α` of
//! a length next to 1, unit vectors along them by `4α`, and the rotation adds another `α`; `8α` covers the sum.
use super::interval_polynomial::{IntervalPolynomial, IntervalVector, cross, dot, largest};
use crate::explicit::nurbs::EnclosedPiece;
use crate::math::{Interval, add_up, exponent, greater, mul_up, power_of_two};

/// The errors of frames over a piece.
#[derive(Clone, Copy, Debug)]
pub(in crate::convert) struct FrameError {
    /// Points of the path.
    pub position: f64,
    /// The unit vectors to the side, up, and ahead.
    pub vectors: [f64; 3],
    /// The growth of the twist's angle, in radians.
    pub twist: f64,
    /// The directions at both ends, of any length.
    pub directions: [[Interval; 3]; 2],
}

/// Halvings of a piece until its direction is known not to vanish. Chosen: a sixteenth of an arc is nearly straight.
const HALVINGS: usize = 4;

/// The errors of a piece of the spline of frames (point, side, up, ahead) over its piece of the path, both relative to one
/// origin, for a given twist per unit of length. `None` if the path may stop, or if the vectors may not form a frame.
pub(in crate::convert) fn frame_error(
    path: &EnclosedPiece<3>,
    frames: &EnclosedPiece<12>,
    spread: f64,
) -> Option<FrameError> {
    halved(path, frames, spread, HALVINGS)
}

fn halved(
    path: &EnclosedPiece<3>,
    frames: &EnclosedPiece<12>,
    spread: f64,
    left: usize,
) -> Option<FrameError> {
    if let Some(error) = whole(path, frames, spread) {
        return Some(error);
    }
    let next = left.checked_sub(1)?;
    let half = |a: f64, b: f64| halved(&path.part(a, b), &frames.part(a, b), spread, next);
    let (first, second) = (half(0.0, 0.5)?, half(0.5, 1.0)?);
    Some(FrameError {
        position: greater(first.position, second.position),
        vectors: std::array::from_fn(|k| greater(first.vectors[k], second.vectors[k])),
        twist: add_up(first.twist, second.twist),
        directions: [first.directions[0], second.directions[1]],
    })
}

fn whole(path: &EnclosedPiece<3>, frames: &EnclosedPiece<12>, spread: f64) -> Option<FrameError> {
    let denominator = |weights: &Option<crate::explicit::nurbs::IntervalRow<1>>| {
        let one = || IntervalPolynomial::constant(1.0);
        weights.as_ref().map_or_else(one, |row| IntervalPolynomial::coordinate(row, 0))
    };
    let (w_path, w) = (denominator(&path.weights), denominator(&frames.weights));
    let [least_path, least] = [&w_path, &w].map(|w| w.range().lo());
    if least_path <= 0.0 || least <= 0.0 {
        return None;
    }
    // 1. Points.
    let x = IntervalPolynomial::vector(&path.points, 0);
    let point = IntervalPolynomial::vector(&frames.points, 0);
    let apart: IntervalVector = std::array::from_fn(|k| x[k].times(&w).minus(&point[k].times(&w_path)));
    let position = quotient(largest(&apart), &[least_path, least]);
    // 2. The direction, scaled to a length next to 1, so that its squares stay in range.
    let (w_slope, is_plain) = (w_path.derivative(), path.weights.is_none());
    let direction: IntervalVector = std::array::from_fn(|k| {
        let slope = x[k].derivative();
        if is_plain { slope } else { slope.times(&w_path).minus(&x[k].times(&w_slope)) }
    });
    let size = largest(&direction);
    if !(size > 0.0 && size.is_finite()) {
        return None;
    }
    let unit = power_of_two(-exponent(size));
    let direction = direction.map(|d| d.scaled(unit));
    let square = dot(&direction, &direction);
    let speed = square.range().sqrt().lo();
    // NaN is not above 0.
    if !(square.range().lo() > 0.0 && speed > 0.0) {
        return None;
    }
    // 3. Vectors.
    let [side, up, ahead] = [3, 6, 9].map(|from| IntervalPolynomial::vector(&frames.points, from));
    let w_square = w.times(&w);
    let along = dot(&up, &direction);
    let long = |v: &IntervalVector| quotient(dot(v, v).minus(&w_square).range().magnitude(), &[least, least]);
    let part = |x: &IntervalPolynomial| quotient(x.range().magnitude(), &[least, speed]);
    let a = part(&along);
    let up_long = add_up(long(&up), mul_up(a, a));
    let up_off = add_up(a, up_long);
    // The vectors must be nearly orthonormal for the steps below.
    if up_off.is_nan() || up_off >= 0.25 {
        return None;
    }
    let b = part(&dot(&side, &direction));
    // |q| is above 3/4.
    let c = quotient(
        add_up(quotient(dot(&side, &up).range().magnitude(), &[least, least]), mul_up(a, b)),
        &[0.75],
    );
    let side_off = sum(&[b, c, long(&side), mul_up(b, b), mul_up(c, c)]);
    let d = quotient(largest(&cross(&ahead, &direction)), &[least, speed]);
    let ahead_off = sum(&[d, long(&ahead), mul_up(d, d)]);
    let turn = cross(&up, &direction);
    let is_same_way = dot(&side, &turn).range().lo() > 0.0 && dot(&ahead, &direction).range().lo() > 0.0;
    if !(is_same_way && side_off < 0.25 && ahead_off < 0.25) {
        return None;
    }
    // 4. Twist: det(a, D, ρ) = a·(D×ρ) = −a·(ρ×D).
    let up_slope: IntervalVector = up.each_ref().map(IntervalPolynomial::derivative);
    let bend: IntervalVector = direction.each_ref().map(IntervalPolynomial::derivative);
    let numerator = along.times(&dot(&bend, &turn)).minus(&square.times(&dot(&up_slope, &turn)));
    let across = dot(&up, &up).times(&square).minus(&along.times(&along));
    let mut below = vec![speed, across.range().lo()];
    let numerator = if spread == 0.0 {
        numerator
    } else {
        // ω does not depend on the size of the direction; |D| does, and `direction` has been scaled.
        let wanted = square.times(&across).scaled(spread).scaled(1.0 / unit);
        let w_square = w_path.times(&w_path);
        below.extend([least_path, least_path]);
        numerator.times(&w_square).minus(&wanted)
    };
    if below.iter().any(|x| *x <= 0.0) {
        return None;
    }
    let twist = quotient(numerator.range().magnitude(), &below);
    let directions = [0, 1].map(|end| direction.each_ref().map(|d| d.ends()[end]));
    let all = [position, side_off, up_off, ahead_off, twist];
    let error = FrameError { position, vectors: [side_off, up_off, ahead_off], twist, directions };
    all.iter().all(|x| x.is_finite()).then_some(error)
}

/// Divided by numbers above 0, rounded up.
fn quotient(x: f64, by: &[f64]) -> f64 {
    by.iter().fold(x, |x, by| crate::math::div_up(x, *by))
}

fn sum(all: &[f64]) -> f64 {
    all.iter().fold(0.0, |sum, x| add_up(sum, *x))
}

/// The largest angle between two directions, in radians; infinite if it may be a right angle.
pub(in crate::convert) fn turn_between(a: &[Interval; 3], b: &[Interval; 3]) -> f64 {
    let product = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    let square = |v: &[Interval; 3]| v[0].square() + v[1].square() + v[2].square();
    let crossed = square(&[product(1, 2), product(2, 0), product(0, 1)]).sqrt();
    let cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let sine = crossed / (square(a).sqrt() * square(b).sqrt());
    // An angle below a right angle is at most π/2 times its sine; 1.6 is above π/2.
    if cosine.lo() > 0.0 && sine.is_defined() { mul_up(1.6, sine.hi()) } else { f64::INFINITY }
}

/// The largest angle about the path between the frame at the start of a piece and the frame of an up vector, in radians.
pub(in crate::convert) fn start_turn(
    frames: &EnclosedPiece<12>,
    direction: &[Interval; 3],
    up: [f64; 3],
) -> f64 {
    let up = up.map(Interval::point);
    let own: [Interval; 3] = std::array::from_fn(|k| frames.points.0[0][6 + k]);
    let dot = |a: &[Interval; 3], b: &[Interval; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let across = |v: &[Interval; 3]| -> [Interval; 3] {
        let part = dot(v, direction) / dot(direction, direction);
        std::array::from_fn(|k| v[k] - part * direction[k])
    };
    turn_between(&across(&up), &across(&own))
}
