//! Values as text, and formatting with `%`.
use crate::language::CallError;
use crate::meter::Meter;
use crate::values::{arg_of, elements, fault, number};
use starlark::eval::Evaluator;
use starlark::values::Value;

/// A value as text: numbers as Starlark prints them, lists in brackets, shapes by their kind.
pub(crate) fn text_of<'v>(value: Value<'v>, eval: &mut Evaluator<'v, '_, '_>) -> starlark::Result<String> {
    text_within(value, 2, eval)
}

/// The text of a value with lists that are nested up to the given depth; deeper ones are named by their kind.
fn text_within<'v>(
    value: Value<'v>,
    depth: u32,
    eval: &mut Evaluator<'v, '_, '_>,
) -> starlark::Result<String> {
    if let Some(text) = value.unpack_str() {
        Meter::charge(eval, text.len())?;
        return Ok(text.to_owned());
    }
    if number(value).is_some() || value.unpack_bool().is_some() || value.is_none() {
        return Ok(value.to_str());
    }
    let Some(list) = elements(value).filter(|_| depth > 0) else {
        return Ok(arg_of(value).kind().to_owned());
    };
    Meter::charge(eval, list.len())?;
    let items = list.iter().map(|item| text_within(*item, depth - 1, eval));
    let items = items.collect::<starlark::Result<Vec<_>>>()?.join(", ");
    let [open, close] = if value.get_type() == "tuple" { ["(", ")"] } else { ["[", "]"] };
    // As in Python, where (1) is a number and (1,) a tuple.
    let comma = if value.get_type() == "tuple" && list.len() == 1 { "," } else { "" };
    Ok(format!("{open}{items}{comma}{close}"))
}

/// The most digits after the decimal point. Defined: 17 significant digits identify any double.
const MOST_DIGITS: usize = 17;

/// `template % values`: `%s` takes any value, `%d` a number without its fraction, `%f` or `%.2f` a number
/// with that many digits after the point; `%%` is a percent sign.
pub(crate) fn formatted<'v>(
    template: &str,
    values: Value<'v>,
    eval: &mut Evaluator<'v, '_, '_>,
) -> starlark::Result<String> {
    let wrong = |message: &str| fault(CallError(message.to_owned()));
    Meter::charge(eval, template.len())?;
    // A list is one value for one placeholder; only a tuple stands for several, as in Python.
    let values: Vec<Value<'v>> = match elements(values).filter(|_| values.get_type() == "tuple") {
        Some(items) => items.to_vec(),
        None => vec![values],
    };
    let (mut values, mut text) = (values.iter(), String::new());
    let mut rest = template;
    while let Some((before, after)) = rest.split_once('%') {
        text.push_str(before);
        let (digits, after) = match after.strip_prefix('.') {
            Some(after) => {
                let n = after.bytes().take_while(u8::is_ascii_digit).count();
                let digits = after[..n].parse().ok().filter(|digits| *digits <= MOST_DIGITS);
                (
                    Some(digits.ok_or_else(|| {
                        wrong("'%.' must be followed by a number from 0 to 17, as in '%.2f'")
                    })?),
                    &after[n..],
                )
            }
            None => (None, after),
        };
        let kind = after
            .chars()
            .next()
            .ok_or_else(|| wrong("a string ends with '%': write '%%' for a percent sign"))?;
        rest = &after[kind.len_utf8()..];
        if kind == '%' {
            text.push('%');
            continue;
        }
        let value =
            *values.next().ok_or_else(|| wrong("the string has more placeholders than there are values"))?;
        let needed_number = || number(value).ok_or_else(|| wrong("'%d' and '%f' need a number"));
        match kind {
            's' => text.push_str(&text_of(value, eval)?),
            'd' => text.push_str(&format!("{:.0}", needed_number()?.trunc())),
            // Six digits, as in Python. Defined by the C standard.
            'f' => text.push_str(&format!("{:.*}", digits.unwrap_or(6), needed_number()?)),
            _ => return Err(wrong("the placeholders of a string are '%s', '%d', '%f' and '%.2f'")),
        }
        Meter::charge(eval, text.len() / 64)?;
    }
    if values.next().is_some() {
        return Err(wrong("there are more values than placeholders in the string"));
    }
    text.push_str(rest);
    Ok(text)
}
