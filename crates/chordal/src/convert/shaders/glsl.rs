//! GLSL ES 3.00: numbers as `float`, and numbers with derivatives as `vec4`, the gradient in xyz and the value in w.
use super::glsl_helpers::GlslHelper;
use super::statements::{ShaderPrinter, TermText};
use crate::implicit::{Binary, Unary};
use std::collections::BTreeSet;

/// A number as GLSL reads it, in parentheses if it is negative.
pub fn glsl_number(value: f64) -> String {
    let single = value as f32;
    if single.is_nan() {
        return "uintBitsToFloat(0x7fc00000u)".to_owned();
    }
    if single.is_infinite() {
        let bits = if single > 0.0 { "0x7f800000u" } else { "0xff800000u" };
        return format!("uintBitsToFloat({bits})");
    }
    // The shortest text that gives the same number back.
    if single.is_sign_negative() && single != 0.0 {
        format!("({single:?})")
    } else {
        format!("{:?}", single.abs())
    }
}

/// Prints values.
pub struct GlslValues<'a> {
    /// The prefix of the helpers' names.
    pub name: &'a str,
    /// The helpers that the statements call.
    pub helpers: BTreeSet<GlslHelper>,
}

/// Prints values with their gradients.
pub struct GlslDuals<'a> {
    /// The prefix of the helpers' names.
    pub name: &'a str,
    /// The helpers that the statements call.
    pub helpers: BTreeSet<GlslHelper>,
}

fn infix(a: &TermText, operator: &str, b: &TermText) -> TermText {
    TermText::infix(format!("{} {operator} {}", a.operand(), b.operand()))
}

impl GlslValues<'_> {
    fn call(&mut self, helper: GlslHelper, arguments: &[&TermText]) -> TermText {
        let texts: Vec<&str> = arguments.iter().map(|argument| argument.text.as_str()).collect();
        let texts = texts.join(", ");
        match helper.builtin() {
            Some(builtin) => TermText::atom(format!("{builtin}({texts})")),
            None => {
                self.helpers.insert(helper);
                TermText::atom(format!("{}_{}({texts})", self.name, helper.name()))
            }
        }
    }
}

impl ShaderPrinter for GlslValues<'_> {
    fn number(&self, value: f64) -> TermText {
        TermText { is_number: true, ..TermText::atom(glsl_number(value)) }
    }

    fn axis(&self, axis: u8) -> TermText {
        TermText::atom(["p.x", "p.y", "p.z"][usize::from(axis)])
    }

    fn unary(&mut self, op: Unary, a: &TermText) -> TermText {
        match op {
            Unary::Neg => TermText::infix(format!("-{}", a.operand())),
            Unary::Square => infix(a, "*", a),
            _ => self.call(GlslHelper::Unary(op), &[a]),
        }
    }

    fn binary(&mut self, op: Binary, a: &TermText, b: &TermText) -> TermText {
        match op {
            Binary::Add => infix(a, "+", b),
            Binary::Sub => infix(a, "-", b),
            Binary::Mul => infix(a, "*", b),
            Binary::Div => infix(a, "/", b),
            _ => self.call(GlslHelper::Binary(op), &[a, b]),
        }
    }

    fn declaration(&self, name: &str, value: &str) -> String {
        format!("float {name} = {value};")
    }
}

/// A number as a value without derivatives. Integers, so that the only texts with points are numbers of the expression.
fn dual(a: &TermText) -> TermText {
    if a.is_number { TermText::atom(format!("vec4(0, 0, 0, {})", a.text)) } else { a.clone() }
}

impl GlslDuals<'_> {
    fn call(&mut self, helper: GlslHelper, arguments: &[&TermText]) -> TermText {
        let texts: Vec<String> = arguments.iter().map(|argument| dual(argument).text).collect();
        self.helpers.insert(helper);
        TermText::atom(format!("{}_{}({})", self.name, helper.name(), texts.join(", ")))
    }
}

impl ShaderPrinter for GlslDuals<'_> {
    fn number(&self, value: f64) -> TermText {
        TermText { is_number: true, ..TermText::atom(glsl_number(value)) }
    }

    fn axis(&self, axis: u8) -> TermText {
        TermText::atom(["vec4(1, 0, 0, p.x)", "vec4(0, 1, 0, p.y)", "vec4(0, 0, 1, p.z)"][usize::from(axis)])
    }

    fn unary(&mut self, op: Unary, a: &TermText) -> TermText {
        match op {
            Unary::Neg => TermText::infix(format!("-{}", dual(a).operand())),
            _ => self.call(GlslHelper::Unary(op), &[a]),
        }
    }

    fn binary(&mut self, op: Binary, a: &TermText, b: &TermText) -> TermText {
        match op {
            Binary::Add => infix(&dual(a), "+", &dual(b)),
            Binary::Sub => infix(&dual(a), "-", &dual(b)),
            Binary::Mul if a.is_number || b.is_number => infix(a, "*", b),
            Binary::Div if b.is_number => infix(a, "/", b),
            _ => self.call(GlslHelper::Binary(op), &[a, b]),
        }
    }

    fn declaration(&self, name: &str, value: &str) -> String {
        format!("vec4 {name} = {value};")
    }
}
