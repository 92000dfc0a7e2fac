//! Metered operators. A single operator of Starlark can allocate a list of 16 GB before any limit is checked,
//! so every operator is called through this module.
use crate::compare::{contains, equal, order};
use crate::language::{CallError, operate};
use crate::meter::{Meter, exceeded};
use crate::texts::formatted;
use crate::values::{StarlarkShape, arg_of, elements, fault, number, to_starlark, undefined_operator};
use allocative::Allocative;
use starlark::eval::{Arguments, Evaluator};
use starlark::values::{
    Heap, NoSerialize, ProvidesStaticType, StarlarkPagablePanic, StarlarkValue, Value, ValueLike,
    starlark_value,
};
use std::cmp::Ordering;
use std::fmt;

/// Every binary operator but `and` and `or`, which evaluate one operand at a time.
pub(crate) const OPERATORS: [&str; 19] = [
    "+", "-", "*", "/", "//", "%", "|", "&", "^", "<<", ">>", "==", "!=", "<", ">", "<=", ">=", "in",
    "not in",
];

/// An operator, called by the program as a function of two values.
#[derive(Debug, ProvidesStaticType, NoSerialize, StarlarkPagablePanic, Allocative)]
pub(crate) struct StarlarkOperator(#[allocative(skip)] pub &'static str);
starlark::starlark_simple_value!(StarlarkOperator);

impl fmt::Display for StarlarkOperator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }
}

#[starlark_value(type = "operator")]
impl<'v> StarlarkValue<'v> for StarlarkOperator {
    fn invoke(
        &self,
        _me: Value<'v>,
        args: &Arguments<'v, '_>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        let [a, b] = args.positional(eval.heap())?;
        let truth = match self.0 {
            "==" => equal(a, b, eval)?,
            "!=" => !equal(a, b, eval)?,
            "<" => order(a, b, eval)? == Ordering::Less,
            ">" => order(a, b, eval)? == Ordering::Greater,
            "<=" => order(a, b, eval)? != Ordering::Greater,
            ">=" => order(a, b, eval)? != Ordering::Less,
            "in" => contains(b, a, eval)?,
            "not in" => !contains(b, a, eval)?,
            operator => return apply(operator, a, b, eval),
        };
        Ok(Value::new_bool(truth))
    }
}

fn apply<'v>(
    operator: &'static str,
    a: Value<'v>,
    b: Value<'v>,
    eval: &mut Evaluator<'v, '_, '_>,
) -> starlark::Result<Value<'v>> {
    if a.downcast_ref::<StarlarkShape>().is_some() || b.downcast_ref::<StarlarkShape>().is_some() {
        let (left, right) = (arg_of(a), arg_of(b));
        return match operate(operator, &left, &right) {
            Some(result) => to_starlark(result.map_err(fault)?, eval),
            None => Err(undefined_operator(operator, &left, &right)),
        };
    }
    if number(a).is_some() && number(b).is_some() {
        return of_numbers(operator, a, b, eval.heap());
    }
    if let (Some(template), "%") = (a.unpack_str(), operator) {
        let text = formatted(template, b, eval)?;
        return Ok(eval.heap().alloc(text));
    }
    let length =
        |value: Value<'v>| value.unpack_str().map(str::len).or_else(|| elements(value).map(<[_]>::len));
    match (operator, length(a), length(b)) {
        ("+", Some(left), Some(right)) if a.get_type() == b.get_type() => {
            // Before the interpreter allocates the result, which may be as large as the limit of
            // its heap.
            Meter::charge(eval, left.saturating_add(right))?;
            a.add(b, eval.heap())
        }
        ("*", Some(length), None) | ("*", None, Some(length)) => {
            let times = if number(a).is_some() { a.unpack_i32() } else { b.unpack_i32() };
            let Some(times) = times else { return Err(undefined_operator(operator, &arg_of(a), &arg_of(b))) };
            // A negative number gives an empty list.
            Meter::charge(eval, length.saturating_mul(usize::try_from(times).unwrap_or(0)))?;
            a.mul(b, eval.heap())
        }
        _ => Err(undefined_operator(operator, &arg_of(a), &arg_of(b))),
    }
}

/// Applies an operator to two numbers.
pub(crate) fn of_numbers<'v>(
    operator: &'static str,
    a: Value<'v>,
    b: Value<'v>,
    heap: Heap<'v>,
) -> starlark::Result<Value<'v>> {
    // The largest whole number. Chosen: Starlark's have no limit, so repeated products would grow without
    // end.
    const MOST: f64 = (1_u64 << 60) as f64;
    let large = |value: Value| value.get_type() == "int" && number(value).is_none_or(|n| n.abs() > MOST);
    if large(a) || large(b) {
        return Err(exceeded("whole numbers above 2^60 are not supported".to_owned()));
    }
    match operator {
        "+" => a.add(b, heap),
        "-" => a.sub(b, heap),
        "*" => a.mul(b, heap),
        "/" => a.div(b, heap),
        "//" => a.floor_div(b, heap),
        "%" => a.percent(b, heap),
        _ => Err(fault(CallError(format!("'{operator}' is not defined for numbers")))),
    }
}
