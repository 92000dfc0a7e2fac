//! Starlark values of the language: shapes, formulas and functions.
use crate::files::MAIN;
use crate::language::{Arg, CallError, Function, operate};
use crate::meter::Meter;
use allocative::Allocative;
use starlark::eval::{Arguments, Evaluator};
use starlark::values::float::UnpackFloat;
use starlark::values::list::ListRef;
use starlark::values::tuple::TupleRef;
use starlark::values::{
    Heap, NoSerialize, ProvidesStaticType, StarlarkPagablePanic, StarlarkValue, UnpackValue, Value,
    ValueLike, starlark_value,
};
use std::fmt;

/// A shape or a formula.
#[derive(Debug, ProvidesStaticType, NoSerialize, StarlarkPagablePanic, Allocative)]
pub(crate) struct StarlarkShape(#[allocative(skip)] pub Arg);
starlark::starlark_simple_value!(StarlarkShape);

impl fmt::Display for StarlarkShape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.kind())
    }
}

#[starlark_value(type = "shape")]
impl<'v> StarlarkValue<'v> for StarlarkShape {
    fn minus(&self, heap: Heap<'v>) -> starlark::Result<Value<'v>> {
        // The meter is out of reach here: the additional term is charged when the value is used. Until then
        // the limit on loop iterations bounds how many there are.
        match operate("neg", &self.0, &self.0) {
            Some(result) => Ok(heap.alloc(Self(result.map_err(fault)?))),
            None => Err(undefined_operator("neg", &self.0, &self.0)),
        }
    }
}

/// The hint of an operator with an operand of None.
const NOTHING_HINT: &str = ": None is the result of a function without 'return'";

/// The error for an operator that is undefined for these values.
pub(crate) fn undefined_operator(operator: &str, a: &Arg, b: &Arg) -> starlark::Error {
    let hint = match (operator, a, b) {
        ("+", Arg::Shape(_), Arg::Shape(_)) => ": use | to unite shapes",
        (_, Arg::Shape(_), Arg::Number(_)) | (_, Arg::Number(_), Arg::Shape(_)) => {
            ": use scale(), offset() or move() to change a shape by a number"
        }
        (_, Arg::Nothing, _) | (_, _, Arg::Nothing) => NOTHING_HINT,
        _ => "",
    };
    let message = match operator {
        "neg" => format!("'-' is not defined for {}", a.kind()),
        _ => format!("'{operator}' is not defined for {} and {}{hint}", a.kind(), b.kind()),
    };
    fault(CallError(message))
}

pub(crate) fn fault(fault: CallError) -> starlark::Error {
    starlark::Error::new_other(fault)
}

/// A function of the language.
#[derive(Debug, ProvidesStaticType, NoSerialize, StarlarkPagablePanic, Allocative)]
pub(crate) struct StarlarkFunction(#[allocative(skip)] pub &'static Function);
starlark::starlark_simple_value!(StarlarkFunction);

impl fmt::Display for StarlarkFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.name)
    }
}

#[starlark_value(type = "function")]
impl<'v> StarlarkValue<'v> for StarlarkFunction {
    fn invoke(
        &self,
        _me: Value<'v>,
        args: &Arguments<'v, '_>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        Meter::charge(eval, args.len()?)?;
        let mut by_position = Vec::new();
        for value in args.positions(eval.heap())? {
            by_position.push(charged_arg(value, eval)?);
        }
        let mut by_name = Vec::new();
        for (name, value) in args.names_map()? {
            by_name.push((name.as_str().to_owned(), charged_arg(value, eval)?));
        }
        let meter = Meter::from_eval(eval);
        // Only lines of the main script are shown; a place in a loaded file would be taken for one
        // of them.
        let location = eval.call_stack_top_location().filter(|location| location.filename() == MAIN);
        let offset = location.map(|location| location.span.begin().get() as usize);
        if let Some(offset) = offset.filter(|_| self.0.moves_by_bound(&by_position, &by_name)) {
            meter.bounded.borrow_mut().push(offset);
        }
        let notes = &mut meter.notes.borrow_mut();
        let result = self.0.call_within(by_position, by_name, meter.job, notes).map_err(fault)?;
        if let Some(offset) = offset {
            meter.keep_step(offset, &result);
        }
        to_starlark(result, eval)
    }
}

/// Converts a value of the language to a Starlark value.
pub(crate) fn to_starlark<'v>(value: Arg, eval: &mut Evaluator<'v, '_, '_>) -> starlark::Result<Value<'v>> {
    match value {
        Arg::Number(number) => Ok(eval.heap().alloc(number)),
        value => {
            Meter::from_eval(eval).charge_arg(&value)?;
            Ok(eval.heap().alloc(StarlarkShape(value)))
        }
    }
}

/// Converts a Starlark value to one of the language; reading lists is charged as work.
fn charged_arg<'v>(value: Value<'v>, eval: &mut Evaluator<'v, '_, '_>) -> starlark::Result<Arg> {
    if let Some(list) = elements(value) {
        Meter::charge(eval, list.len())?;
        // `arg_of` copies the lists in a list as well, and no deeper ones.
        for inner in list.iter().filter_map(|inner| elements(*inner)) {
            Meter::charge(eval, inner.len())?;
        }
    }
    let arg = arg_of(value);
    // The result of a unary minus has not been charged yet.
    if arg.weight() > Meter::from_eval(eval).limits.terms {
        Meter::from_eval(eval).charge_arg(&arg)?;
    }
    Ok(arg)
}

/// The elements of a list or a tuple.
pub(crate) fn elements<'v>(value: Value<'v>) -> Option<&'v [Value<'v>]> {
    ListRef::from_value(value)
        .map(ListRef::content)
        .or_else(|| TupleRef::from_value(value).map(TupleRef::content))
}

/// Converts a Starlark value to one of the language. No function takes lists of lists of lists.
pub(crate) fn arg_of(value: Value) -> Arg {
    arg_within(value, 2)
}

/// Converts a value with lists that are nested up to the given depth.
fn arg_within(value: Value, depth: u32) -> Arg {
    if let Some(StarlarkShape(shape)) = value.downcast_ref() {
        shape.clone()
    } else if let Some(number) = number(value) {
        Arg::Number(number)
    } else if let Some(truth) = value.unpack_bool() {
        Arg::Truth(truth)
    } else if value.is_none() {
        Arg::Nothing
    } else if let Some(text) = value.unpack_str() {
        Arg::Text(text.chars().take(LONGEST_NAME).collect())
    } else if let Some(list) = elements(value).filter(|_| depth > 0) {
        Arg::List(list.iter().map(|value| arg_within(*value, depth - 1)).collect())
    } else {
        Arg::Other(match value.get_type() {
            "list" | "tuple" => "a list of lists of lists".to_owned(),
            other => format!("a {other}"),
        })
    }
}

/// A number, whole or not; True is not one.
pub(crate) fn number(value: Value) -> Option<f64> {
    if value.unpack_bool().is_some() {
        return None;
    }
    UnpackFloat::unpack_value(value).ok().flatten().map(|number| number.0)
}

/// The most characters of a text argument; the rest is cut off. Chosen: longer than any name or colour.
const LONGEST_NAME: usize = 200;
