//! Texts: what values look like, and texts with values put into them.
use crate::language::CallError;
use crate::meter::Meter;
use crate::values::{arg_of, elements, fault, number};
use starlark::eval::Evaluator;
use starlark::values::Value;

/// A value as a text: numbers as they are written, lists within brackets, shapes by their kind.
pub(crate) fn text_of<'v>(value: Value<'v>, eval: &mut Evaluator<'v, '_, '_>) -> starlark::Result<String> {
    text_within(value, 2, eval)
}

fn text_within<'v>(
    value: Value<'v>,
    lists: u32,
    eval: &mut Evaluator<'v, '_, '_>,
) -> starlark::Result<String> {
    if let Some(text) = value.unpack_str() {
        Meter::charge(eval, text.len())?;
        return Ok(text.to_owned());
    }
    if number(value).is_some() || value.unpack_bool().is_some() || value.is_none() {
        return Ok(value.to_str());
    }
    let Some(list) = elements(value).filter(|_| lists > 0) else {
        return Ok(arg_of(value).kind().to_owned());
    };
    Meter::charge(eval, list.len())?;
    let parts = list.iter().map(|part| text_within(*part, lists - 1, eval));
    let parts = parts.collect::<starlark::Result<Vec<_>>>()?.join(", ");
    let [open, close] = if value.get_type() == "tuple" { ["(", ")"] } else { ["[", "]"] };
    let comma = if value.get_type() == "tuple" && list.len() == 1 { "," } else { "" };
    Ok(format!("{open}{parts}{comma}{close}"))
}

/// The most digits after the point. Defined: a double has no more that mean anything.
const MOST_DIGITS: usize = 17;

/// `template % values`: `%s` any value, `%d` a number without its fraction, `%f` or `%.2f` with so many digits,
/// `%%` the sign itself.
pub(crate) fn formatted<'v>(
    template: &str,
    values: Value<'v>,
    eval: &mut Evaluator<'v, '_, '_>,
) -> starlark::Result<String> {
    let wrong = |what: &str| fault(CallError(what.to_owned()));
    Meter::charge(eval, template.len())?;
    let all: Vec<Value<'v>> = match elements(values).filter(|_| values.get_type() == "tuple") {
        Some(all) => all.to_vec(),
        None => vec![values],
    };
    let (mut next, mut made) = (all.iter(), String::new());
    let mut rest = template;
    while let Some((before, after)) = rest.split_once('%') {
        made.push_str(before);
        let (digits, after) = match after.strip_prefix('.') {
            Some(after) => {
                let n = after.bytes().take_while(u8::is_ascii_digit).count();
                let digits = after[..n].parse().ok().filter(|digits| *digits <= MOST_DIGITS);
                (Some(digits.ok_or_else(|| wrong("'%.' is followed by 0 to 17, as in '%.2f'"))?), &after[n..])
            }
            None => (None, after),
        };
        let kind =
            after.chars().next().ok_or_else(|| wrong("a text ends with '%': write '%%' for the sign"))?;
        rest = &after[kind.len_utf8()..];
        if kind == '%' {
            made.push('%');
            continue;
        }
        let value = *next.next().ok_or_else(|| wrong("the text has more '%' than there are values"))?;
        let of_number = || number(value).ok_or_else(|| wrong("'%d' and '%f' need a number"));
        match kind {
            's' => made.push_str(&text_of(value, eval)?),
            'd' => made.push_str(&format!("{:.0}", of_number()?.trunc())),
            // Six as in Python. Defined by C.
            'f' => made.push_str(&format!("{:.*}", digits.unwrap_or(6), of_number()?)),
            _ => return Err(wrong("a text is filled in at '%s', '%d', '%f' and '%.2f'")),
        }
        Meter::charge(eval, made.len() / 64)?;
    }
    if next.next().is_some() {
        return Err(wrong("there are more values than '%' in the text"));
    }
    made.push_str(rest);
    Ok(made)
}
