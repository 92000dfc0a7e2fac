//! The operations of expressions as functions of GLSL, on values and on values with gradients. The formulas are those of
//! `implicit/op.rs` and `implicit/dual.rs`.
use crate::implicit::{Binary, Unary};
use std::cmp::Ordering;

/// An operation that is written as a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GlslHelper {
    Unary(Unary),
    Binary(Binary),
}

impl Ord for GlslHelper {
    fn cmp(&self, other: &Self) -> Ordering {
        self.name().cmp(&other.name())
    }
}

impl PartialOrd for GlslHelper {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl GlslHelper {
    /// The end of its name.
    pub fn name(self) -> String {
        let name = match self {
            Self::Unary(op) => Unary::ALL.into_iter().find(|(other, _)| *other == op).map(|(_, name)| name),
            Self::Binary(op) => Binary::ALL.into_iter().find(|(other, _)| *other == op).map(|(_, name)| name),
        };
        name.unwrap_or_default().replace('-', "_")
    }

    /// The function of GLSL for values, if there is one.
    pub fn builtin(self) -> Option<&'static str> {
        match self {
            Self::Unary(op) => match op {
                Unary::Abs => Some("abs"),
                Unary::Sqrt => Some("sqrt"),
                Unary::Floor => Some("floor"),
                Unary::Ceil => Some("ceil"),
                Unary::Sin => Some("sin"),
                Unary::Cos => Some("cos"),
                Unary::Tan => Some("tan"),
                Unary::Asin => Some("asin"),
                Unary::Acos => Some("acos"),
                Unary::Atan => Some("atan"),
                Unary::Exp => Some("exp"),
                Unary::Ln => Some("log"),
                Unary::Neg | Unary::Recip | Unary::Square | Unary::Round | Unary::Not => None,
            },
            Self::Binary(op) => match op {
                Binary::Min => Some("min"),
                Binary::Max => Some("max"),
                Binary::Atan2 => Some("atan"),
                _ => None,
            },
        }
    }

    /// Its result for the values `a` and `b`, as an expression of GLSL.
    fn value(self) -> &'static str {
        match self {
            Self::Unary(op) => match op {
                Unary::Neg => "-a",
                Unary::Abs => "abs(a)",
                Unary::Recip => "1.0 / a",
                Unary::Sqrt => "sqrt(a)",
                Unary::Square => "a * a",
                Unary::Floor => "floor(a)",
                Unary::Ceil => "ceil(a)",
                // Halves away from 0, which the function of GLSL does not promise.
                Unary::Round => "sign(a) * floor(abs(a) + 0.5)",
                Unary::Sin => "sin(a)",
                Unary::Cos => "cos(a)",
                Unary::Tan => "tan(a)",
                Unary::Asin => "asin(a)",
                Unary::Acos => "acos(a)",
                Unary::Atan => "atan(a)",
                Unary::Exp => "exp(a)",
                Unary::Ln => "log(a)",
                Unary::Not => "a == 0.0 ? 1.0 : 0.0",
            },
            Self::Binary(op) => match op {
                Binary::Add => "a + b",
                Binary::Sub => "a - b",
                Binary::Mul => "a * b",
                Binary::Div => "a / b",
                Binary::Min => "min(a, b)",
                Binary::Max => "max(a, b)",
                Binary::SmoothMin => "min(a, b) - 0.25 * h * h",
                Binary::RoundMin => "min(a, b) - h * h / (1.0 + h + sqrt(1.0 + h * (2.0 - h)))",
                Binary::LogSumExp => "max(a, b) + log(1.0 + exp(-abs(a - b)))",
                Binary::Atan2 => "atan(a, b)",
                Binary::Mod => "a - abs(b) * floor(a / abs(b))",
                Binary::Compare => "a < b ? -1.0 : a > b ? 1.0 : 0.0",
                Binary::And => "a == 0.0 ? a : b",
                Binary::Or => "a == 0.0 ? b : a",
            },
        }
    }

    /// A statement that defines a value of its own, for both functions.
    fn preparation(self) -> &'static str {
        match self {
            Self::Binary(Binary::SmoothMin | Binary::RoundMin) => "float h = max(1.0 - abs(a - b), 0.0); ",
            _ => "",
        }
    }

    /// Its gradient from the values `a`, `b` and `value`, and the gradients `da` and `db`.
    fn gradient(self) -> &'static str {
        match self {
            Self::Unary(op) => match op {
                Unary::Neg => "-da",
                Unary::Abs => "a < 0.0 ? -da : da",
                Unary::Recip => "-value * value * da",
                // At 0 a length has a kink, of which this is a generalized gradient.
                Unary::Sqrt => "value > 0.0 ? da / (2.0 * value) : vec3(0.0)",
                Unary::Square => "2.0 * a * da",
                Unary::Floor | Unary::Ceil | Unary::Round | Unary::Not => "vec3(0.0)",
                Unary::Sin => "cos(a) * da",
                Unary::Cos => "-sin(a) * da",
                Unary::Tan => "(1.0 + value * value) * da",
                Unary::Asin => "da / sqrt(1.0 - a * a)",
                Unary::Acos => "-da / sqrt(1.0 - a * a)",
                Unary::Atan => "da / (1.0 + a * a)",
                Unary::Exp => "value * da",
                Unary::Ln => "da / a",
            },
            Self::Binary(op) => match op {
                Binary::Add => "da + db",
                Binary::Sub => "da - db",
                Binary::Mul => "da * b + a * db",
                Binary::Div => "(da - value * db) / b",
                Binary::Min => "a < b ? da : db",
                Binary::Max => "a > b ? da : db",
                Binary::SmoothMin => "mix(db, da, clamp(0.5 - 0.5 * (a - b), 0.0, 1.0))",
                Binary::RoundMin => {
                    "mix(db, da, 0.5 - 0.5 * clamp(a - b, -1.0, 1.0) / sqrt(2.0 - (1.0 - h) * (1.0 - h)))"
                }
                Binary::LogSumExp => "mix(db, da, 1.0 / (1.0 + exp(b - a)))",
                Binary::Atan2 => "(b * da - a * db) / (a * a + b * b)",
                Binary::Mod => "da - floor((a - value) / b + 0.5) * db",
                Binary::Compare => "vec3(0.0)",
                Binary::And => "a == 0.0 ? da : db",
                Binary::Or => "a == 0.0 ? db : da",
            },
        }
    }

    /// The function on values.
    pub fn of_values(self, prefix: &str) -> String {
        let (name, value, preparation) = (self.name(), self.value(), self.preparation());
        let parameters = if matches!(self, Self::Unary(_)) { "float a" } else { "float a, float b" };
        format!("float {prefix}_{name}({parameters}) {{ {preparation}return {value}; }}\n")
    }

    /// The function on values with gradients.
    pub fn of_duals(self, prefix: &str) -> String {
        let (name, value, preparation, gradient) =
            (self.name(), self.value(), self.preparation(), self.gradient());
        let (parameters, parts) = match self {
            Self::Unary(_) => ("vec4 u", "float a = u.w; vec3 da = u.xyz; "),
            Self::Binary(_) => ("vec4 u, vec4 v", "float a = u.w, b = v.w; vec3 da = u.xyz, db = v.xyz; "),
        };
        format!(
            "vec4 {prefix}_{name}({parameters}) {{\n    {parts}{preparation}float value = {value};\n    \
             return vec4({gradient}, value);\n}}\n"
        )
    }
}
