//! Triply periodic minimal surfaces: gyroid, Schwarz' P, Schwarz' D.
//!
//! Each is a trigonometric sum `g` of the coordinates times `k = 2π/period` whose gradient is at most `√3·k`:
//!
//! - Gyroid: `∂g/∂x = k (cos x cos y − sin z sin x)`; by Cauchy and Schwarz its square is at most
//!   `k² (cos² y + sin² z)`, and the three add up to `3k²`.
//! - P: each derivative is a sine times `k`.
//! - D, as `cos z sin A + sin z cos B` with `A = x + y`, `B = x − y`: the squared gradient is `k²` times
//!   `(cos z cos B − sin z sin A)² + 2 cos² z cos² A + 2 sin² z sin² B`, a quadratic form in
//!   `(cos z, sin z)`. With `u = sin² A`, `v = cos² B` its largest eigenvalue is at most 3, for
//!   `1 + u + v − 2(u − v)² ≥ 0` on `[0, 1]²`.
//!
//! All three reach `√3·k`.
use super::{InvalidShape, finite, positive};
use crate::implicit::{Distance, Expr, Field};
use crate::math::{div_down, mul_up, sqrt_up};

/// The half of space on one side of the gyroid: where `sin x cos y + sin y cos z + sin z cos x < level`, with
/// one period every `period`. The value is a bound: the sum divided by its largest slope. A [`Field::shell`]
/// of it is a wall.
///
/// # Errors
/// When the period is not a finite number above 0, or the level not a finite number.
///
/// Source: A. Schoen, *Infinite periodic minimal surfaces without self-intersections*, 1970.
pub fn gyroid(period: f64, level: f64) -> Result<Field, InvalidShape> {
    let [[sx, cx], [sy, cy], [sz, cz]] = waves(period)?;
    scaled(sx * &cy + sy * &cz + sz * &cx, period, level)
}

/// The half of space where `cos x + cos y + cos z < level`, with one period every `period`. The value is a
/// bound.
///
/// # Errors
/// As for [`gyroid`].
pub fn schwarz_p(period: f64, level: f64) -> Result<Field, InvalidShape> {
    let [[_, cx], [_, cy], [_, cz]] = waves(period)?;
    scaled(cx + cy + cz, period, level)
}

/// The half of space where
/// `sin x sin y sin z + sin x cos y cos z + cos x sin y cos z + cos x cos y sin z < level`, with one period
/// every `period`. The value is a bound.
///
/// # Errors
/// As for [`gyroid`].
pub fn diamond(period: f64, level: f64) -> Result<Field, InvalidShape> {
    let [[sx, cx], [sy, cy], [sz, cz]] = waves(period)?;
    // cos z · sin(x + y) + sin z · cos(x − y), multiplied out.
    let first = &cz * (&sx * &cy + &cx * &sy);
    let second = &sz * (&cx * &cy + &sx * &sy);
    scaled(first + second, period, level)
}

fn frequency(period: f64) -> f64 {
    std::f64::consts::TAU / period
}

/// The sine and cosine of each coordinate, in radians of its period.
fn waves(period: f64) -> Result<[[Expr; 2]; 3], InvalidShape> {
    let k = frequency(positive("a period", period)?);
    positive("a period's frequency", k)?;
    Ok(Expr::axes().map(|axis| {
        let angle = axis * k;
        [Expr::sin(&angle), Expr::cos(&angle)]
    }))
}

fn scaled(sum: Expr, period: f64, level: f64) -> Result<Field, InvalidShape> {
    let level = finite("a level", level)?;
    let steepest = mul_up(frequency(period), sqrt_up(3.0));
    let value = (sum - level) * div_down(1.0, steepest);
    Ok(Field::new(value).known_distance(Distance::BOUND))
}
