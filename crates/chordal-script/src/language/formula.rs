//! Formulas: expressions in x, y and z, and the operators and functions on them.
use super::bind::{BoundArgs, Function, FunctionParameter, ParameterKind, required};
use super::transforms::RADIANS;
use super::{Arg, CallError, Formula, Solid};
use chordal::implicit::evaluation::{Binary, Unary};
use chordal::implicit::shapes::InvalidShape;
use chordal::implicit::{Expr, Field};

/// Functions of numbers and formulas, and conversions from formulas to shapes.
pub(super) const FORMULAS: &[Function] = &[
    Function {
        name: "field",
        parameters: &[formula("formula")],
        about: "The shape of all points where the formula is negative.",
        distance: "sign only",
        make: |args| {
            let formula = args.formula(0)?;
            let weight = formula.weight.saturating_add(1);
            Ok(Arg::Shape(Solid { field: Field::new(formula.expr), weight, step_weight: 1 }))
        },
    },
    unary_function("sqrt", "The square root.", |args| unary(args, Unary::Sqrt)),
    unary_function("exp", "The exponential function.", |args| unary(args, Unary::Exp)),
    unary_function("log", "The natural logarithm.", |args| unary(args, Unary::Ln)),
    unary_function("sin", "The sine of an angle in radians.", |args| unary(args, Unary::Sin)),
    unary_function("cos", "The cosine of an angle in radians.", |args| unary(args, Unary::Cos)),
    unary_function("tan", "The tangent of an angle in radians.", |args| unary(args, Unary::Tan)),
    unary_function("asin", "The arcsine, in radians.", |args| unary(args, Unary::Asin)),
    unary_function("acos", "The arccosine, in radians.", |args| unary(args, Unary::Acos)),
    unary_function("atan", "The arctangent, in radians.", |args| unary(args, Unary::Atan)),
    binary_function(
        "atan2",
        ["y", "x"],
        "The angle of the point (x, y) from the x axis, in radians.",
        |args| binary(args, Binary::Atan2),
    ),
    unary_function("floor", "The largest integer that is not above the value.", |args| {
        unary(args, Unary::Floor)
    }),
    unary_function("ceil", "The smallest integer that is not below the value.", |args| {
        unary(args, Unary::Ceil)
    }),
    binary_function("minimum", ["a", "b"], "The smaller of two values.", |args| binary(args, Binary::Min)),
    binary_function("maximum", ["a", "b"], "The larger of two values.", |args| binary(args, Binary::Max)),
    unary_function("radians", "An angle in degrees, converted to radians.", |args| {
        operate("*", args.any(0), &Arg::Number(RADIANS))
            .unwrap_or_else(|| Err(args.fault("needs a number or a formula")))
    }),
];

const fn formula(name: &'static str) -> FunctionParameter {
    required(name).of(ParameterKind::Formula)
}

const fn unary_function(
    name: &'static str,
    about: &'static str,
    make: fn(&BoundArgs) -> Result<Arg, CallError>,
) -> Function {
    const VALUE: &[FunctionParameter] = &[formula("value")];
    Function { name, parameters: VALUE, about, distance: "", make }
}

const fn binary_function(
    name: &'static str,
    names: [&'static str; 2],
    about: &'static str,
    make: fn(&BoundArgs) -> Result<Arg, CallError>,
) -> Function {
    const YX: &[FunctionParameter] = &[formula("y"), formula("x")];
    const AB: &[FunctionParameter] = &[formula("a"), formula("b")];
    // A `const fn` cannot compare strings.
    let parameters = if names[0].len() == 1 && names[0].as_bytes()[0] == b'y' { YX } else { AB };
    Function { name, parameters, about, distance: "", make }
}

fn unary(args: &BoundArgs, op: Unary) -> Result<Arg, CallError> {
    if let Arg::Number(value) = args.any(0) {
        return Ok(Arg::Number(op.apply(*value)));
    }
    let formula = args.formula(0)?;
    Ok(formula.with_expr(Expr::unary(op, &formula.expr), None))
}

fn binary(args: &BoundArgs, op: Binary) -> Result<Arg, CallError> {
    if let (Arg::Number(a), Arg::Number(b)) = (args.any(0), args.any(1)) {
        return Ok(Arg::Number(op.apply(*a, *b)));
    }
    let (a, b) = (args.formula(0)?, args.formula(1)?);
    Ok(a.with_expr(Expr::binary(op, &a.expr, &b.expr), Some(&b)))
}

impl Formula {
    fn from_arg(arg: &Arg) -> Option<Self> {
        match arg {
            Arg::Formula(formula) => Some(formula.clone()),
            Arg::Number(value) => Some(Self { expr: Expr::constant(*value), weight: 1 }),
            _ => None,
        }
    }

    fn with_expr(&self, expr: Expr, other: Option<&Self>) -> Arg {
        let weight = self.weight.saturating_add(other.map_or(0, |other| other.weight)).saturating_add(1);
        Arg::Formula(Self { expr, weight })
    }
}

impl BoundArgs {
    /// An error about this call.
    pub(super) fn fault(&self, predicate: &str) -> CallError {
        CallError(format!("{}() {predicate}", self.name()))
    }

    /// The result of a call that built a field from a shape and a formula.
    pub(super) fn formula_result(
        &self,
        field: Result<Field, InvalidShape>,
        solid: &Solid,
        formula: &Formula,
    ) -> Result<Arg, CallError> {
        let result = self.shape_result(field, &[solid])?;
        Ok(match result {
            Arg::Shape(solid) => {
                Arg::Shape(Solid { weight: solid.weight.saturating_add(formula.weight), ..solid })
            }
            other => other,
        })
    }
}

/// Applies an operator to two values, of which one is a shape or a formula, or both are numbers. Returns
/// `None` if the operator is undefined for them. `abs` and `neg` use the first value alone.
#[must_use]
pub fn operate(operator: &str, a: &Arg, b: &Arg) -> Option<Result<Arg, CallError>> {
    if let (Arg::Shape(a), Arg::Shape(b)) = (a, b) {
        let field = match operator {
            "|" => a.field.union(&b.field),
            "&" => a.field.intersection(&b.field),
            "-" => a.field.difference(&b.field),
            _ => return None,
        };
        /// A sum, a minimum and a sign of each.
        const STEP_WEIGHT: u64 = 8;
        let weight = a.weight.saturating_add(b.weight).saturating_add(STEP_WEIGHT);
        return Some(Ok(Arg::Shape(Solid { field, weight, step_weight: STEP_WEIGHT })));
    }
    let op = match operator {
        "+" => Binary::Add,
        "-" => Binary::Sub,
        "*" => Binary::Mul,
        "/" => Binary::Div,
        "neg" | "abs" => {
            let op = if operator == "neg" { Unary::Neg } else { Unary::Abs };
            return match a {
                Arg::Number(value) => Some(Ok(Arg::Number(op.apply(*value)))),
                Arg::Formula(formula) => Some(Ok(formula.with_expr(Expr::unary(op, &formula.expr), None))),
                _ => None,
            };
        }
        _ => return None,
    };
    if let (Arg::Number(a), Arg::Number(b)) = (a, b) {
        return Some(Ok(Arg::Number(op.apply(*a, *b))));
    }
    let (a, b) = (Formula::from_arg(a)?, Formula::from_arg(b)?);
    Some(Ok(a.with_expr(Expr::binary(op, &a.expr, &b.expr), Some(&b))))
}
