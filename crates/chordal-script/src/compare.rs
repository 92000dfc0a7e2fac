//! Metered comparison of numbers, texts and lists of them. Lists of lists are not compared: nested lists that
//! share sublists have exponentially many elements.
use crate::language::CallError;
use crate::meter::Meter;
use crate::values::{elements, fault, number};
use starlark::eval::Evaluator;
use starlark::values::Value;
use starlark::values::dict::DictRef;
use std::cmp::Ordering;

/// Whether two values are equal.
pub(crate) fn equal<'v>(
    a: Value<'v>,
    b: Value<'v>,
    eval: &mut Evaluator<'v, '_, '_>,
) -> starlark::Result<bool> {
    let (Some(left), Some(right)) = (elements(a), elements(b)) else { return equal_simple(a, b, eval) };
    // As in Python, a list and a tuple are never equal.
    if a.get_type() != b.get_type() || left.len() != right.len() {
        return Ok(false);
    }
    for (a, b) in left.iter().zip(right) {
        if elements(*a).is_some() || elements(*b).is_some() {
            return Err(fault(CallError("lists of lists cannot be compared".to_owned())));
        }
        if !equal_simple(*a, *b, eval)? {
            return Ok(false);
        }
    }
    Ok(true)
}

fn equal_simple<'v>(a: Value<'v>, b: Value<'v>, eval: &mut Evaluator<'v, '_, '_>) -> starlark::Result<bool> {
    let length = a.unpack_str().map_or(0, str::len);
    Meter::charge(eval, 1 + length)?;
    if elements(a).is_some() || elements(b).is_some() {
        return Ok(false);
    }
    if number(a).is_some() || a.unpack_str().is_some() || a.unpack_bool().is_some() || a.is_none() {
        a.equals(b)
    } else {
        // Others, such as shapes, equal only themselves: comparing their terms could take any time.
        Ok(a.ptr_eq(b))
    }
}

/// Orders two numbers or two texts.
pub(crate) fn order<'v>(
    a: Value<'v>,
    b: Value<'v>,
    eval: &mut Evaluator<'v, '_, '_>,
) -> starlark::Result<Ordering> {
    let texts = a.unpack_str().zip(b.unpack_str());
    Meter::charge(eval, 1 + texts.map_or(0, |(a, _)| a.len()))?;
    if texts.is_some() || number(a).is_some() && number(b).is_some() {
        return a.compare(b);
    }
    Err(fault(CallError(format!("{} and {} cannot be ordered", a.get_type(), b.get_type()))))
}

/// Whether a value may be the key of a dictionary: a text, number or truth value, which are quick to compare.
pub(crate) fn is_key(value: Value) -> bool {
    value.unpack_str().is_some() || number(value).is_some() || value.unpack_bool().is_some()
}

/// Whether a list, dictionary or text contains a value.
pub(crate) fn contains<'v>(
    list: Value<'v>,
    value: Value<'v>,
    eval: &mut Evaluator<'v, '_, '_>,
) -> starlark::Result<bool> {
    if let Some((text, part)) = list.unpack_str().zip(value.unpack_str()) {
        Meter::charge(eval, text.len() + part.len())?;
        return Ok(text.contains(part));
    }
    if let Some(entries) = DictRef::from_value(list) {
        Meter::charge(eval, 1 + value.unpack_str().map_or(0, str::len))?;
        // Any other value has no hash, or one that takes long to compute.
        return Ok(is_key(value) && entries.get(value)?.is_some());
    }
    let Some(list) = elements(list) else {
        return Err(fault(CallError(format!(
            "'in' needs a list, dictionary or string, not {}",
            list.get_type()
        ))));
    };
    for element in list {
        if equal(*element, value, eval)? {
            return Ok(true);
        }
    }
    Ok(false)
}
