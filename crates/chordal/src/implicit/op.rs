//! The operations of expressions: their names, and their values on numbers.
use crate::math::elementary::{self, single};
use crate::math::{greater, lesser};

/// An operation on one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unary {
    /// `−a`.
    Neg,
    /// `|a|`.
    Abs,
    /// `1/a`; undefined at 0.
    Recip,
    /// `√a`; undefined below 0.
    Sqrt,
    /// `a²`.
    Square,
    /// The largest integer that is not above `a`; has jumps.
    Floor,
    /// The smallest integer that is not below `a`; has jumps.
    Ceil,
    /// The nearest integer, halves away from 0; has jumps.
    Round,
    /// The sine of `a` radians.
    Sin,
    /// The cosine of `a` radians.
    Cos,
    /// The tangent of `a` radians; undefined at its poles.
    Tan,
    /// The angle whose sine is `a`; undefined outside [−1, 1].
    Asin,
    /// The angle whose cosine is `a`; undefined outside [−1, 1].
    Acos,
    /// The angle whose tangent is `a`.
    Atan,
    /// `eᵃ`.
    Exp,
    /// The natural logarithm; undefined at 0 and below.
    Ln,
    /// 1 where `a` is 0, else 0; has jumps.
    Not,
}

/// An operation on two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Binary {
    /// `a + b`.
    Add,
    /// `a − b`.
    Sub,
    /// `a · b`.
    Mul,
    /// `a / b`; undefined where `b` is 0.
    Div,
    /// `a` where `a < b`, else `b`.
    Min,
    /// `a` where `a > b`, else `b`.
    Max,
    /// The smaller one with its kink rounded off: `min(a, b) − h²/4` with `h = max(1 − |a − b|, 0)`. It is
    /// nowhere above the minimum, and equals it if they differ by 1 or more.
    SmoothMin,
    /// The smaller one with its kink replaced by a quarter circle: `min(a, b) − h²/(1 + h + √(1 + 2h − h²))`
    /// with `h = max(1 − |a − b|, 0)`. It equals the minimum if they differ by 1 or more, and is 0 on the arc
    /// `(1 − a)² + (1 − b)² = 1` between (0, 1) and (1, 0).
    RoundMin,
    /// `ln(eᵃ + eᵇ)`: the maximum with its kink rounded off. It overflows only where the maximum does.
    LogSumExp,
    /// The angle of the point `(b, a)` from the first axis, in (−π, π]. Undefined at the origin; jumps at the
    /// negative axis.
    Atan2,
    /// The remainder of `a` divided by `|b|`, in [0, |b|); has jumps. Undefined where `b` is 0.
    Mod,
    /// −1, 0 or 1 as `a` is below, at or above `b`; has jumps.
    Compare,
    /// `b`, or 0 where `a` is 0; has jumps.
    And,
    /// `a`, or `b` where `a` is 0; has jumps.
    Or,
}

impl Unary {
    /// All operations, with their names in the `.vm` text format.
    pub const ALL: [(Self, &'static str); 17] = [
        (Self::Neg, "neg"),
        (Self::Abs, "abs"),
        (Self::Recip, "recip"),
        (Self::Sqrt, "sqrt"),
        (Self::Square, "square"),
        (Self::Floor, "floor"),
        (Self::Ceil, "ceil"),
        (Self::Round, "round"),
        (Self::Sin, "sin"),
        (Self::Cos, "cos"),
        (Self::Tan, "tan"),
        (Self::Asin, "asin"),
        (Self::Acos, "acos"),
        (Self::Atan, "atan"),
        (Self::Exp, "exp"),
        (Self::Ln, "ln"),
        (Self::Not, "not"),
    ];

    /// The operation in f64, rounded; NaN where it is undefined.
    #[inline(always)]
    #[must_use]
    pub fn apply(self, a: f64) -> f64 {
        match self {
            Self::Neg => -a,
            Self::Abs => a.abs(),
            Self::Recip => 1.0 / a,
            Self::Sqrt => a.sqrt(),
            Self::Square => a * a,
            Self::Floor => a.floor(),
            Self::Ceil => a.ceil(),
            Self::Round => a.round(),
            Self::Sin => elementary::sin(a),
            Self::Cos => elementary::cos(a),
            Self::Tan => elementary::tan(a),
            Self::Asin => elementary::asin(a),
            Self::Acos => elementary::acos(a),
            Self::Atan => elementary::atan(a),
            Self::Exp => elementary::exp(a),
            Self::Ln => elementary::ln(a),
            Self::Not => f64::from(u8::from(a == 0.0)),
        }
    }

    /// The operation in f32, rounded; NaN where it is undefined.
    #[inline(always)]
    #[must_use]
    pub fn apply_f32(self, a: f32) -> f32 {
        match self {
            Self::Neg => -a,
            Self::Abs => a.abs(),
            Self::Recip => 1.0 / a,
            Self::Sqrt => a.sqrt(),
            Self::Square => a * a,
            Self::Floor => a.floor(),
            Self::Ceil => a.ceil(),
            Self::Round => a.round(),
            Self::Sin => single::sin(a),
            Self::Cos => single::cos(a),
            Self::Tan => single::tan(a),
            Self::Asin => single::asin(a),
            Self::Acos => single::acos(a),
            Self::Atan => single::atan(a),
            Self::Exp => single::exp(a),
            Self::Ln => single::ln(a),
            Self::Not => f32::from(u8::from(a == 0.0)),
        }
    }
}

impl Binary {
    /// All operations, with their names in the `.vm` text format.
    pub const ALL: [(Self, &'static str); 14] = [
        (Self::Add, "add"),
        (Self::Sub, "sub"),
        (Self::Mul, "mul"),
        (Self::Div, "div"),
        (Self::Min, "min"),
        (Self::Max, "max"),
        (Self::SmoothMin, "smooth-min"),
        (Self::RoundMin, "round-min"),
        (Self::LogSumExp, "log-sum-exp"),
        (Self::Atan2, "atan2"),
        (Self::Mod, "mod"),
        (Self::Compare, "compare"),
        (Self::And, "and"),
        (Self::Or, "or"),
    ];

    /// The operation in f64, rounded; NaN where it is undefined.
    #[inline(always)]
    #[must_use]
    pub fn apply(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => a + b,
            Self::Sub => a - b,
            Self::Mul => a * b,
            Self::Div => a / b,
            Self::Min if a < b => a,
            Self::Max if a > b => a,
            Self::Min | Self::Max => b,
            Self::SmoothMin => {
                let h = 1.0 - (a - b).abs();
                let h = greater(h, 0.0);
                // Not `Self::Min.apply`: a function that calls itself is not inlined.
                let low = lesser(a, b);
                low - 0.25 * (h * h)
            }
            Self::RoundMin => {
                let h = 1.0 - (a - b).abs();
                let h = greater(h, 0.0);
                let low = lesser(a, b);
                low - h * h / (1.0 + h + (1.0 + h * (2.0 - h)).sqrt())
            }
            Self::LogSumExp => {
                let (low, high) = if a < b { (a, b) } else { (b, a) };
                // The difference of two equal infinities would be NaN.
                let fall = if low == high { 0.0 } else { low - high };
                high + elementary::ln(1.0 + elementary::exp(fall))
            }
            Self::Atan2 => elementary::atan2(a, b),
            Self::Mod => a.rem_euclid(b),
            Self::Compare if a < b => -1.0,
            Self::Compare if a > b => 1.0,
            Self::Compare if a == b => 0.0,
            Self::Compare => f64::NAN,
            Self::And => {
                if a == 0.0 {
                    a
                } else {
                    b
                }
            }
            Self::Or => {
                if a == 0.0 {
                    b
                } else {
                    a
                }
            }
        }
    }

    /// The operation in f32, rounded; NaN where it is undefined.
    #[inline(always)]
    #[must_use]
    pub fn apply_f32(self, a: f32, b: f32) -> f32 {
        match self {
            Self::Add => a + b,
            Self::Sub => a - b,
            Self::Mul => a * b,
            Self::Div => a / b,
            Self::Min if a < b => a,
            Self::Max if a > b => a,
            Self::Min | Self::Max => b,
            Self::SmoothMin => {
                let h = 1.0 - (a - b).abs();
                let h = greater(h, 0.0);
                let low = lesser(a, b);
                low - 0.25 * (h * h)
            }
            Self::RoundMin => {
                let h = 1.0 - (a - b).abs();
                let h = greater(h, 0.0);
                let low = lesser(a, b);
                low - h * h / (1.0 + h + (1.0 + h * (2.0 - h)).sqrt())
            }
            Self::LogSumExp => {
                let (low, high) = if a < b { (a, b) } else { (b, a) };
                let fall = if low == high { 0.0 } else { low - high };
                high + single::ln(1.0 + single::exp(fall))
            }
            Self::Atan2 => single::atan2(a, b),
            Self::Mod => a.rem_euclid(b),
            Self::Compare if a < b => -1.0,
            Self::Compare if a > b => 1.0,
            Self::Compare if a == b => 0.0,
            Self::Compare => f32::NAN,
            Self::And => {
                if a == 0.0 {
                    a
                } else {
                    b
                }
            }
            Self::Or => {
                if a == 0.0 {
                    b
                } else {
                    a
                }
            }
        }
    }
}
