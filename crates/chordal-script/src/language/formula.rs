//! Formulas: expressions in x, y and z, and what operators and functions of numbers make of them.
use super::bind::{Function, Given, needed};
use super::place::RADIANS;
use super::{Arg, Fault, Formula, Solid};
use chordal::implicit::shapes::InvalidShape;
use chordal::implicit::{Binary, Expr, Field, Unary};

/// Functions of numbers and formulas, and the way from formulas to shapes.
pub(super) const FORMULAS: &[Function] = &[
    Function {
        name: "field",
        parameters: &[needed("formula")],
        about: "The points where a formula is negative.",
        distance: "a sign",
        make: |given| {
            let formula = given.formula(0)?;
            let weight = formula.weight.saturating_add(1);
            Ok(Arg::Shape(Solid { field: Field::new(formula.expr), weight, own: 1 }))
        },
    },
    of_one("sqrt", "The square root.", |given| unary(given, Unary::Sqrt)),
    of_one("exp", "The exponential function.", |given| unary(given, Unary::Exp)),
    of_one("log", "The natural logarithm.", |given| unary(given, Unary::Ln)),
    of_one("sin", "The sine of an angle in radians.", |given| unary(given, Unary::Sin)),
    of_one("cos", "The cosine of an angle in radians.", |given| unary(given, Unary::Cos)),
    of_one("tan", "The tangent of an angle in radians.", |given| unary(given, Unary::Tan)),
    of_one("asin", "The angle of a sine.", |given| unary(given, Unary::Asin)),
    of_one("acos", "The angle of a cosine.", |given| unary(given, Unary::Acos)),
    of_one("atan", "The angle of a tangent.", |given| unary(given, Unary::Atan)),
    of_two("atan2", ["y", "x"], "The angle of a point.", |given| binary(given, Binary::Atan2)),
    of_one("floor", "The largest whole number that is not above.", |given| unary(given, Unary::Floor)),
    of_one("ceil", "The smallest whole number that is not below.", |given| unary(given, Unary::Ceil)),
    of_two("minimum", ["a", "b"], "The smaller of two.", |given| binary(given, Binary::Min)),
    of_two("maximum", ["a", "b"], "The larger of two.", |given| binary(given, Binary::Max)),
    of_one("radians", "An angle given in degrees.", |given| {
        operate("*", given.any(0), &Arg::Number(RADIANS))
            .unwrap_or_else(|| Err(given.fault("needs a number or a formula")))
    }),
];

const fn of_one(name: &'static str, about: &'static str, make: fn(&Given) -> Result<Arg, Fault>) -> Function {
    const VALUE: &[super::Parameter] = &[needed("value")];
    Function { name, parameters: VALUE, about, distance: "", make }
}

const fn of_two(
    name: &'static str,
    names: [&'static str; 2],
    about: &'static str,
    make: fn(&Given) -> Result<Arg, Fault>,
) -> Function {
    const YX: &[super::Parameter] = &[needed("y"), needed("x")];
    const AB: &[super::Parameter] = &[needed("a"), needed("b")];
    let parameters = if names[0].len() == 1 && names[0].as_bytes()[0] == b'y' { YX } else { AB };
    Function { name, parameters, about, distance: "", make }
}

fn unary(given: &Given, op: Unary) -> Result<Arg, Fault> {
    if let Arg::Number(value) = given.any(0) {
        return Ok(Arg::Number(op.of(*value)));
    }
    let formula = given.formula(0)?;
    Ok(formula.then(Expr::unary(op, &formula.expr), None))
}

fn binary(given: &Given, op: Binary) -> Result<Arg, Fault> {
    if let (Arg::Number(a), Arg::Number(b)) = (given.any(0), given.any(1)) {
        return Ok(Arg::Number(op.of(*a, *b)));
    }
    let (a, b) = (given.formula(0)?, given.formula(1)?);
    Ok(a.then(Expr::binary(op, &a.expr, &b.expr), Some(&b)))
}

impl Formula {
    fn of(arg: &Arg) -> Option<Self> {
        match arg {
            Arg::Formula(formula) => Some(formula.clone()),
            Arg::Number(value) => Some(Self { expr: Expr::constant(*value), weight: 1 }),
            _ => None,
        }
    }

    fn then(&self, expr: Expr, other: Option<&Self>) -> Arg {
        let weight = self.weight.saturating_add(other.map_or(0, |other| other.weight)).saturating_add(1);
        Arg::Formula(Self { expr, weight })
    }
}

impl Given {
    /// A sentence about this call.
    pub(super) fn fault(&self, what: &str) -> Fault {
        Fault(format!("{}() {what}", self.name()))
    }

    /// A shape made of one and a formula.
    pub(super) fn made_of(
        &self,
        field: Result<Field, InvalidShape>,
        solid: &Solid,
        formula: &Formula,
    ) -> Result<Arg, Fault> {
        let made = self.made(field, &[solid])?;
        Ok(match made {
            Arg::Shape(solid) => {
                Arg::Shape(Solid { weight: solid.weight.saturating_add(formula.weight), ..solid })
            }
            other => other,
        })
    }
}

/// What an operator makes of two values of which one is a shape or a formula, or both are numbers; nothing where it has no
/// meaning. `abs` and `neg` look at the first alone.
#[must_use]
pub fn operate(operator: &str, a: &Arg, b: &Arg) -> Option<Result<Arg, Fault>> {
    if let (Arg::Shape(a), Arg::Shape(b)) = (a, b) {
        let field = match operator {
            "|" => a.field.union(&b.field),
            "&" => a.field.intersection(&b.field),
            "-" => a.field.difference(&b.field),
            _ => return None,
        };
        /// A sum, a minimum and a sign of each.
        const OWN: u64 = 8;
        let weight = a.weight.saturating_add(b.weight).saturating_add(OWN);
        return Some(Ok(Arg::Shape(Solid { field, weight, own: OWN })));
    }
    let op = match operator {
        "+" => Binary::Add,
        "-" => Binary::Sub,
        "*" => Binary::Mul,
        "/" => Binary::Div,
        "neg" | "abs" => {
            let op = if operator == "neg" { Unary::Neg } else { Unary::Abs };
            return match a {
                Arg::Number(value) => Some(Ok(Arg::Number(op.of(*value)))),
                Arg::Formula(formula) => Some(Ok(formula.then(Expr::unary(op, &formula.expr), None))),
                _ => None,
            };
        }
        _ => return None,
    };
    if let (Arg::Number(a), Arg::Number(b)) = (a, b) {
        return Some(Ok(Arg::Number(op.of(*a, *b))));
    }
    let (a, b) = (Formula::of(a)?, Formula::of(b)?);
    Some(Ok(a.then(Expr::binary(op, &a.expr, &b.expr), Some(&b))))
}
