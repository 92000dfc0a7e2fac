//! `SpeedPiece`: the speed of a piece of a curve, as Taylor polynomials in intervals, and its integral.
//!
//! With a parameter σ from 0 to 1 along a part, and `f` the speed,
//! `∫f = Σ cₖ·2⁻ᵏ/(k + 1) + cₘ(ξ)·2⁻ᵐ/(m + 1)` over even `k < m`, with the coefficients `cₖ` about the middle and `cₘ` one of
//! those about any place of the part: an interval around all of these contains it. That holds for each even `m`, and the
//! narrowest counts.
//!
//! Of a rational piece `N/W` the derivative is `n(N⁺W⁻ − N⁻W⁺)/W²`, where `N⁻` and `N⁺` have the coefficients of `N` without
//! the last and without the first: nothing cancels in the products that are left.
use crate::explicit::nurbs::{BernsteinFactors, EnclosedPiece, IntervalRow, NurbsCurve};
use crate::explicit::{Arc, CurveSegment};
use crate::math::{Interval, exponent, greater, power_of_two};

/// The order of the last coefficient, even. Measured on cubics: at 10 the number of parts times the work of one is least.
const ORDER: usize = 10;

/// The Taylor coefficients up to [`ORDER`].
type Series = [Interval; ORDER + 1];

/// A piece of a curve by its derivative.
#[derive(Clone, Debug)]
pub(super) enum SpeedPiece<const D: usize> {
    /// `h/w²`, or `h` without weights, and the length that is its unit.
    Rows { h: IntervalRow<D>, w: Option<IntervalRow<1>>, unit: f64 },
    /// An arc, whose axes are in units of a length.
    Arc { axes: [[f64; D]; 2], start_rad: f64, sweep_rad: f64, unit: f64 },
}

impl<const D: usize> SpeedPiece<D> {
    pub fn of_segment(segment: &CurveSegment<D>) -> Self {
        match segment {
            CurveSegment::Arc(arc) => Self::of_arc(arc),
            _ => {
                let [piece] = &mut EnclosedPiece::of_segment(segment, segment.start())[..] else {
                    unreachable!("all but arcs are one piece")
                };
                Self::of_piece(piece)
            }
        }
    }

    pub fn of_nurbs(curve: &NurbsCurve<D>, piece: usize) -> Self {
        // Relative to a point near the piece, so that large coordinates cost no digits.
        let origin = curve.at(curve.knots().piece(piece)[0]);
        let origin = if origin.iter().all(|x| x.is_finite()) { origin } else { [0.0; D] };
        Self::of_piece(&mut EnclosedPiece::of_nurbs(curve, piece, origin))
    }

    fn of_arc(arc: &Arc<D>) -> Self {
        let unit = unit_of(arc.axes().as_flattened().iter().copied());
        // Exact, except for numbers far below the unit.
        let axes = arc.axes();
        Self::Arc { axes, start_rad: arc.start_rad(), sweep_rad: arc.sweep_rad(), unit }
    }

    fn of_piece(piece: &mut EnclosedPiece<D>) -> Self {
        let unit = unit_of(piece.points.0.iter().enumerate().map(|(i, x)| {
            let most = x.iter().fold(0.0, |most: f64, x| greater(x.magnitude(), most));
            most / piece.weights.as_ref().map_or(1.0, |w| w.0[i][0].lo())
        }));
        piece.scale(Interval::point(unit));
        let Some(w) = piece.weights.take() else {
            let zero = || IntervalRow(vec![[Interval::point(0.0); D]]);
            return Self::Rows { h: piece.points.derivative().unwrap_or_else(zero), w: None, unit };
        };
        let (x, n) = (&piece.points.0, piece.points.degree());
        let factors = BernsteinFactors::new(n - 1, n - 1);
        let row = |k: usize| {
            factors.products(|i, j| {
                // Equal ones cancel.
                (i + 1 != j).then(|| x[i + 1][k] * w.0[j][0] - x[j][k] * w.0[i + 1][0])
            })
        };
        let rows: [Vec<Interval>; D] = std::array::from_fn(row);
        let degree = Interval::point(n as f64);
        let h = (0..=2 * n - 2).map(|i| std::array::from_fn(|k| degree * rows[k][i])).collect();
        Self::Rows { h: IntervalRow(h), w: Some(w), unit }
    }

    /// The length from one parameter to another; both are in `[0, 1]`, in this order.
    pub fn length(&self, from: f64, to: f64) -> Interval {
        let width = Interval::point(to) - Interval::point(from);
        let (middle, range, width, unit) = match self {
            Self::Rows { h, w, unit } => {
                let h = h.part(from, to);
                let h_series: [[Series; 2]; D] =
                    std::array::from_fn(|k| row_series(&IntervalRow(h.0.iter().map(|x| [x[k]]).collect())));
                let w_series = w.as_ref().map(|w| row_series(&w.part(from, to)));
                let [middle, range] = [0, 1].map(|which| {
                    speed(&h_series.map(|series| series[which]), w_series.map(|series| series[which]))
                });
                (middle, range, width, *unit)
            }
            Self::Arc { axes, start_rad, sweep_rad, unit } => {
                let sweep = Interval::point(*sweep_rad);
                let at = |t: Interval| Interval::point(*start_rad) + sweep * t;
                let [from, to] = [from, to].map(Interval::point);
                let middle = (from + to) * Interval::point(0.5);
                let series = |t: Interval| speed(&arc_series(axes, *unit, at(t), sweep * width), None);
                (series(middle), series(from.hull(to)), width * sweep.abs(), *unit)
            }
        };
        // Taylor's formula of any order holds, so all of them are intersected: on long parts the
        // low orders are narrower, on short ones the high orders.
        let mut narrowest = range[0];
        let mut sum = Interval::point(0.0);
        for m in (2..=ORDER).step_by(2) {
            // ∫ from −½ to ½ of σᵏ is 2⁻ᵏ/(k + 1) for even k, and 0 for odd k.
            let share =
                |k: usize| Interval::point(power_of_two(-(k as i32))) / Interval::point((k + 1) as f64);
            sum = sum + middle[m - 2] * share(m - 2);
            let integral = sum + range[m] * share(m);
            let common = narrowest.intersection(integral);
            // Never empty: both contain the exact value.
            narrowest = if common.is_empty() { narrowest } else { common };
        }
        let length = (narrowest * width / Interval::point(unit)).max(Interval::point(0.0));
        // An overflow makes the length unknown.
        if length.is_empty() || length.hi().is_nan() {
            Interval::from_endpoints(0.0, f64::INFINITY)
        } else {
            length
        }
    }
}

/// A power of two that scales the largest of some numbers to about 1.
fn unit_of(numbers: impl Iterator<Item = f64>) -> f64 {
    power_of_two(-exponent(numbers.fold(0.0, |most: f64, x| greater(x.abs(), most))))
}

/// The coefficients of a polynomial about ½, and intervals that contain those about any place from 0 to 1.
fn row_series(row: &IntervalRow<1>) -> [Series; 2] {
    let zero = Interval::point(0.0);
    let (mut middle, mut range) = ([zero; ORDER + 1], [zero; ORDER + 1]);
    let degree = row.degree();
    let mut row = row.clone();
    // C(degree, k), below 2⁵³ for k up to 10 and the highest degree, 58: exact.
    let mut binomial = 1.0;
    for k in 0..=ORDER.min(degree) {
        let factor = Interval::point(binomial);
        middle[k] = factor * row.middle()[0];
        range[k] = factor * row.range()[0];
        binomial = binomial * (degree - k) as f64 / (k + 1) as f64;
        row = IntervalRow(row.0.windows(2).map(|pair| [pair[1][0] - pair[0][0]]).collect());
    }
    [middle, range]
}

/// The coefficients of `cos(a)·v − sin(a)·u` for an angle `a` that grows by `step` over the part.
fn arc_series<const D: usize>(
    [u, v]: &[[f64; D]; 2],
    unit: f64,
    angle: Interval,
    step: Interval,
) -> [Series; D] {
    let unit = Interval::point(unit);
    let (sin, cos) = (Interval::sin(angle), Interval::cos(angle));
    // The derivatives of the cosine and the sine, in turn.
    let cosines = [cos, -sin, -cos, sin];
    let sines = [sin, cos, -sin, -cos];
    let mut coefficients = [[Interval::point(0.0); ORDER + 1]; D];
    let mut factor = Interval::point(1.0);
    for k in 0..=ORDER {
        for (axis, series) in coefficients.iter_mut().enumerate() {
            let [u, v] = [u[axis], v[axis]].map(|x| Interval::point(x) * unit);
            series[k] = factor * (cosines[k % 4] * v - sines[k % 4] * u);
        }
        factor = factor * step / Interval::point((k + 1) as f64);
    }
    coefficients
}

/// The coefficients of `|h|/w²`. If `|h|` may be 0, all except the first are unknown.
fn speed<const D: usize>(h: &[Series; D], w: Option<Series>) -> Series {
    let mut squares = [Interval::point(0.0); ORDER + 1];
    for series in h {
        for (k, sum) in squares.iter_mut().enumerate() {
            *sum = *sum + square_term(series, k);
        }
    }
    let mut root = [Interval::UNKNOWN; ORDER + 1];
    root[0] = squares[0].sqrt();
    // r·r = s: in order k, 2·r₀·rₖ = sₖ − Σ rᵢ·rₖ₋ᵢ over 0 < i < k. Where the speed may vanish, the
    // root is not differentiable.
    if root[0].lo() > 0.0 {
        for k in 1..=ORDER {
            let mut remainder = squares[k];
            for i in 1..k {
                remainder = remainder - root[i] * root[k - i];
            }
            root[k] = half_quotient(remainder, root[0]);
        }
    }
    let Some(w) = w else { return root };
    let below: Series = std::array::from_fn(|k| square_term(&w, k));
    let mut quotient = [Interval::UNKNOWN; ORDER + 1];
    // q·w² = r: in order k, q_k·(w²)₀ = rₖ − Σ (w²)ᵢ·qₖ₋ᵢ over 0 < i ≤ k.
    for k in 0..=ORDER {
        let mut remainder = root[k];
        for i in 1..=k {
            remainder = remainder - below[i] * quotient[k - i];
        }
        quotient[k] = remainder / below[0];
    }
    quotient
}

/// A coefficient of the square of a series.
fn square_term(x: &Series, k: usize) -> Interval {
    let mut twice = Interval::point(0.0);
    for i in 0..k.div_ceil(2) {
        twice = twice + x[i] * x[k - i];
    }
    let fourfold = twice + twice;
    if k.is_multiple_of(2) { fourfold + x[k / 2].square() } else { fourfold }
}

fn half_quotient(x: Interval, y: Interval) -> Interval {
    x / (y + y)
}
