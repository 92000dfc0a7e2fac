//! Python's common built-in functions, metered against the script's limits.
use crate::compare::{is_key, order};
use crate::files::{FileError, FileUse, FontText, check_name};
use crate::language::{Arg, CallError, operate};
use crate::meter::Meter;
use crate::operators::of_numbers;
use crate::parameter::Parameter;
use crate::texts::text_of;
use crate::values::{StarlarkShape, arg_of, elements, fault, number, to_starlark};
use chordal::math::Box3;
use starlark::collections::SmallMap;
use starlark::environment::GlobalsBuilder;
use starlark::eval::Evaluator;
use starlark::values::dict::{AllocDict, DictRef};
use starlark::values::none::NoneType;
use starlark::values::tuple::UnpackTuple;
use starlark::values::{Value, ValueLike};
use starlark::{starlark_module, values::list::AllocList, values::tuple::AllocTuple};
use std::cmp::Ordering;

/// All values that a loop over `value` would yield.
fn iterate<'v>(value: Value<'v>, eval: &mut Evaluator<'v, '_, '_>) -> starlark::Result<Vec<Value<'v>>> {
    if let Some(entries) = DictRef::from_value(value) {
        let keys: Vec<Value<'v>> = entries.keys().collect();
        drop(entries);
        Meter::charge(eval, keys.len())?;
        return Ok(keys);
    }
    let Some(list) = elements(value) else {
        return Err(fault(CallError(format!("{} is not a list", arg_of(value).kind()))));
    };
    Meter::charge(eval, list.len())?;
    Ok(list.to_vec())
}

/// The smallest or largest value, by the given order.
fn extremum<'v>(
    values: UnpackTuple<Value<'v>>,
    wanted: Ordering,
    eval: &mut Evaluator<'v, '_, '_>,
) -> starlark::Result<Value<'v>> {
    let values = match values.items.as_slice() {
        [list] => iterate(*list, eval)?,
        values => values.to_vec(),
    };
    let Some((first, rest)) = values.split_first() else {
        return Err(fault(CallError("max() and min() need at least one value".to_owned())));
    };
    let mut best = *first;
    for value in rest {
        // Only strictly better ones, so that the first of equal values is returned, as in Python.
        if order(*value, best, eval)? == wanted {
            best = *value;
        }
    }
    Ok(best)
}

/// The value as a whole number, or an error.
fn as_integer(value: Value) -> starlark::Result<i32> {
    value
        .unpack_i32()
        .ok_or_else(|| fault(CallError(format!("a whole number is needed, not {}", arg_of(value).kind()))))
}

/// The error of a function whose file cannot be used.
fn unusable(function: &str, name: &str, why: &str) -> starlark::Error {
    starlark::Error::new_other(FileError(format!("{function}(): '{name}' cannot be used: {why}")))
}

/// The alignments of text, and the share of each line's advance width that lies left of x = 0.
const ALIGNMENTS: [(&str, f64); 3] = [("left", 0.0), ("center", 0.5), ("right", 1.0)];

/// An entry of the dictionary that `box_of` returns.
type BoxRow = (&'static str, Vec<f64>);

/// The entries that `box_of` returns for a box, or the reason why it has none.
fn box_rows(bounds: &Box3) -> Result<[BoxRow; 4], &'static str> {
    if bounds.is_empty() {
        return Err("needs a shape with points, but this one is empty");
    }
    let has_ends = |k: usize| bounds.min[k].is_finite() && bounds.max[k].is_finite();
    // A 2D shape is unbounded along z, and 2D points have two coordinates.
    let n_axes = if bounds.min[2].is_infinite() && bounds.max[2].is_infinite() { 2 } else { 3 };
    if !(0..n_axes).all(has_ends) {
        return Err("needs a shape with known bounds, but this one has none on some side: \
                    intersect it with a box");
    }
    let row = |name, value: &dyn Fn(usize) -> f64| (name, (0..n_axes).map(value).collect());
    let centre = bounds.centre();
    Ok([
        row("min", &|k| bounds.min[k]),
        row("max", &|k| bounds.max[k]),
        row("size", &|k| bounds.max[k] - bounds.min[k]),
        row("center", &|k| centre[k]),
    ])
}

#[starlark_module]
pub(crate) fn builtins(builder: &mut GlobalsBuilder) {
    const pi: f64 = std::f64::consts::PI;

    fn param<'v>(
        #[starlark(require = pos)] name: Value<'v>,
        #[starlark(require = pos)] default: Value<'v>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<f64> {
        let Some(default) = number(default).filter(|default| default.is_finite()) else {
            return Err(fault(CallError(format!(
                "param() needs a finite number as its default, not {}",
                arg_of(default).kind()
            ))));
        };
        let name = name.unpack_str().unwrap_or("");
        // Letters of any alphabet: a name is shown to people, and given back as it is.
        let plain = |c: char| c.is_alphanumeric() || c == '_';
        if name.is_empty() || name.chars().count() > 64 || !name.chars().all(plain) {
            return Err(fault(CallError(
                "param() needs a name of up to 64 letters, digits and '_'".to_owned(),
            )));
        }
        let meter = Meter::from_eval(eval);
        let value = meter.set.get(name).copied().unwrap_or(default);
        let mut parameters = meter.parameters.borrow_mut();
        match parameters.iter().find(|parameter| parameter.name == name) {
            // By bits: 0 and −0 are two defaults.
            Some(earlier) if earlier.default.to_bits() != default.to_bits() => {
                let message =
                    format!("parameter '{name}' has two defaults, {} and {default}", earlier.default);
                return Err(fault(CallError(message)));
            }
            Some(_) => {}
            None if parameters.len() >= 1000 => {
                return Err(fault(CallError("the script has more than 1,000 parameters".to_owned())));
            }
            None => parameters.push(Parameter { name: name.to_owned(), default, value }),
        }
        Ok(value)
    }

    fn mesh<'v>(
        #[starlark(require = pos)] name: Value<'v>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        let Some(name) = name.unpack_str() else {
            let message = format!("mesh() needs the name of a file, not {}", arg_of(name).kind());
            return Err(fault(CallError(message)));
        };
        check_name(name).map_err(|why| fault(CallError(format!("mesh(): {why}"))))?;
        let field = Meter::from_eval(eval).shape_of(name, FileUse::Mesh);
        let field = field.map_err(|why| unusable("mesh", name, &why))?;
        to_starlark(Arg::shape(field), eval)
    }

    fn called__<'v>(#[starlark(require = pos)] function: Value<'v>) -> starlark::Result<Value<'v>> {
        if function.get_type() == "function" {
            return Ok(function);
        }
        Err(fault(CallError(format!("{} cannot be called", arg_of(function).kind()))))
    }

    fn index__<'v>(#[starlark(require = pos)] index: Value<'v>) -> starlark::Result<Value<'v>> {
        if index.unpack_str().is_some() {
            return Ok(index);
        }
        as_integer(index).map(|_| index)
    }

    fn key__<'v>(#[starlark(args)] key: UnpackTuple<Value<'v>>) -> starlark::Result<Value<'v>> {
        // A key that is a tuple arrives as several arguments, since its parentheses become those of the call.
        let wrong = |found: &str| {
            fault(CallError(format!("the key of a dictionary must be a string or a number, not {found}")))
        };
        match key.items[..] {
            [key] if is_key(key) => Ok(key),
            [key] => Err(wrong(arg_of(key).kind())),
            _ => Err(wrong("a list")),
        }
    }

    fn print<'v>(
        #[starlark(args)] values: UnpackTuple<Value<'v>>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<NoneType> {
        let texts = values.items.iter().map(|value| text_of(*value, eval));
        let line = texts.collect::<starlark::Result<Vec<_>>>()?.join(" ");
        Meter::from_eval(eval).print(&line);
        Ok(NoneType)
    }

    fn check<'v>(
        #[starlark(require = pos)] condition: Value<'v>,
        #[starlark(require = pos)] message: Value<'v>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<NoneType> {
        // Every shape is true, so that a forgotten comparison would pass as a check that holds.
        if condition.downcast_ref::<StarlarkShape>().is_some() {
            return Err(fault(CallError(format!(
                "check() needs True or False, not {}",
                arg_of(condition).kind()
            ))));
        }
        if condition.to_bool() {
            return Ok(NoneType);
        }
        let message = text_of(message, eval)?;
        Err(fault(CallError(message.chars().take(400).collect())))
    }

    fn str<'v>(
        #[starlark(require = pos)] value: Value<'v>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<String> {
        text_of(value, eval)
    }

    fn svg<'v>(
        name: &str,
        tolerance: Value<'v>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        let Some(length) = number(tolerance).filter(|length| *length > 0.0 && length.is_finite()) else {
            return Err(fault(CallError("svg() needs a tolerance above 0".to_owned())));
        };
        check_name(name).map_err(|why| fault(CallError(format!("svg(): {why}"))))?;
        let file_use = FileUse::Drawing { tolerance: length };
        let field = Meter::from_eval(eval).shape_of(name, file_use);
        let field = field.map_err(|why| unusable("svg", name, &why))?;
        to_starlark(Arg::shape(field), eval)
    }

    fn text<'v>(
        text: &str,
        font: &str,
        tolerance: Value<'v>,
        em: Option<Value<'v>>,
        align: Option<Value<'v>>,
        #[starlark(kwargs)] axes: SmallMap<String, Value<'v>>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        let wrong = |why: String| fault(CallError(format!("text(): {why}")));
        let Some(tolerance) = number(tolerance).filter(|length| *length > 0.0 && length.is_finite()) else {
            return Err(wrong("the tolerance must be a number above 0".to_owned()));
        };
        let em = em.map_or(Some(1.0), number).filter(|em| *em > 0.0 && em.is_finite());
        let em = em.ok_or_else(|| wrong("em must be a number above 0".to_owned()))?;
        let align = align.map_or(Some("left"), |align| align.unpack_str());
        let Some((_, align)) = ALIGNMENTS.into_iter().find(|(name, _)| align == Some(*name)) else {
            return Err(wrong("align must be \"left\", \"center\" or \"right\"".to_owned()));
        };
        let coordinate = |(name, value): (String, Value<'v>)| match number(value) {
            Some(value) => Ok((name, value)),
            None if name == "halign" => Err(wrong("use align=, as in align=\"center\"".to_owned())),
            None => Err(wrong(format!("the axis {name} needs a number, not {}", arg_of(value).kind()))),
        };
        let axes = axes.into_iter().map(coordinate).collect::<starlark::Result<_>>()?;
        check_name(font).map_err(wrong)?;
        let file_use = FileUse::Letters(FontText { text: text.to_owned(), em, axes, tolerance, align });
        let field = Meter::from_eval(eval).shape_of(font, file_use);
        let field = field.map_err(|why| unusable("text", font, &why))?;
        to_starlark(Arg::shape(field), eval)
    }

    fn heightmap<'v>(
        name: &str,
        size: Value<'v>,
        height: Value<'v>,
        base: Value<'v>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        let wrong = |why: &str| fault(CallError(format!("heightmap(): {why}")));
        let length = |value: Value<'v>| number(value).filter(|length| *length > 0.0 && length.is_finite());
        let size = match elements(size) {
            Some([x, y]) => length(*x).zip(length(*y)),
            _ => None,
        };
        let Some((x, y)) = size else {
            return Err(wrong("size must be a list of two lengths above 0, along x and y"));
        };
        let (Some(height), Some(base)) = (length(height), length(base)) else {
            return Err(wrong(
                "height (of white above black) and base (below black) must be lengths above 0",
            ));
        };
        check_name(name).map_err(|why| wrong(&why))?;
        let file_use = FileUse::Heights { size: [x, y], height, base };
        let field = Meter::from_eval(eval).shape_of(name, file_use);
        let field = field.map_err(|why| unusable("heightmap", name, &why))?;
        to_starlark(Arg::shape(field), eval)
    }

    fn box_of<'v>(
        #[starlark(require = pos)] shape: Value<'v>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        let wrong = |why: &str| fault(CallError(format!("box_of() {why}")));
        let solid = match arg_of(shape) {
            Arg::Shape(solid) => solid,
            other => return Err(wrong(&format!("needs a shape, not {}", other.kind()))),
        };
        let rows = box_rows(&solid.field.bounds()).map_err(wrong)?;
        // Four lists of three numbers, and the dictionary.
        Meter::charge(eval, 20)?;
        let heap = eval.heap();
        Ok(heap.alloc(AllocDict(rows.map(|(name, numbers)| (name, heap.alloc(AllocList(numbers)))))))
    }

    fn last_operand__<'v>(
        #[starlark(require = pos)] value: Value<'v>,
        #[starlark(require = pos)] number: usize,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        let is_shape = matches!(value.downcast_ref(), Some(StarlarkShape(Arg::Shape(_))));
        // Scripts can call this function themselves, with any number.
        if let Some(is_cut) = Meter::from_eval(eval).cuts.borrow_mut().get_mut(number) {
            *is_cut |= is_shape;
        }
        Ok(value)
    }

    fn abs<'v>(
        #[starlark(require = pos)] value: Value<'v>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        if let Some(integer) = value.unpack_i32() {
            // In 64 bits, so that the most negative number has an absolute value.
            return Ok(eval.heap().alloc(i64::from(integer).abs()));
        }
        let arg = arg_of(value);
        match operate("abs", &arg, &arg) {
            Some(result) => to_starlark(result.map_err(fault)?, eval),
            None => Err(fault(CallError(format!("abs() is not defined for {}", arg.kind())))),
        }
    }

    fn r#bool(#[starlark(require = pos)] value: Value) -> starlark::Result<bool> {
        Ok(value.to_bool())
    }

    fn float(#[starlark(require = pos)] value: Value) -> starlark::Result<f64> {
        number(value)
            .ok_or_else(|| fault(CallError(format!("float() needs a number, not {}", arg_of(value).kind()))))
    }

    fn int(#[starlark(require = pos)] value: Value) -> starlark::Result<i32> {
        let number = number(value).filter(|n| n.abs() <= f64::from(i32::MAX));
        // In range: the cast cuts off the fraction.
        number.map(|n| n as i32).ok_or_else(|| {
            fault(CallError("int() needs a number whose absolute value is below 2^31".to_owned()))
        })
    }

    fn len(#[starlark(require = pos)] value: Value) -> starlark::Result<i32> {
        value.length()
    }

    fn fail(#[starlark(require = pos)] message: Value) -> starlark::Result<NoneType> {
        let message = message.unpack_str().unwrap_or("the script failed");
        Err(fault(CallError(message.chars().take(400).collect())))
    }

    fn range<'v>(
        #[starlark(require = pos)] first: Value<'v>,
        #[starlark(require = pos)] end: Option<Value<'v>>,
        #[starlark(require = pos)] step: Option<Value<'v>>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        let (start, end) = match end {
            None => (0, as_integer(first)?),
            Some(end) => (as_integer(first)?, as_integer(end)?),
        };
        let step = step.map_or(Ok(1), as_integer)?;
        if step == 0 {
            return Err(fault(CallError("range() needs a step other than 0".to_owned())));
        }
        let (span, stride) = (i64::from(end) - i64::from(start), i64::from(step));
        // In 64 bits, in which no difference of two 32-bit numbers overflows. A step away from the
        // end gives no numbers, as in Python.
        let count = if span.signum() == stride.signum() { (span.abs() - 1) / stride.abs() + 1 } else { 0 };
        // Before the list is made: its length is known.
        Meter::charge(eval, usize::try_from(count).unwrap_or(usize::MAX))?;
        let numbers = (0..count).map(|k| i64::from(start) + k * stride);
        Ok(eval.heap().alloc(AllocList(numbers)))
    }

    fn list<'v>(
        #[starlark(require = pos)] values: Option<Value<'v>>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        let values = values.map_or(Ok(Vec::new()), |values| iterate(values, eval))?;
        Ok(eval.heap().alloc(AllocList(values)))
    }

    fn tuple<'v>(
        #[starlark(require = pos)] values: Option<Value<'v>>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        let values = values.map_or(Ok(Vec::new()), |values| iterate(values, eval))?;
        Ok(eval.heap().alloc(AllocTuple(values)))
    }

    fn enumerate<'v>(
        #[starlark(require = pos)] values: Value<'v>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        let values = iterate(values, eval)?;
        // A pair and its two entries, and the entry of the list.
        Meter::charge(eval, 4 * values.len())?;
        let pairs = values.into_iter().enumerate().map(|(k, value)| (k as i32, value));
        Ok(eval.heap().alloc(AllocList(pairs)))
    }

    fn reversed<'v>(
        #[starlark(require = pos)] values: Value<'v>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        let values = iterate(values, eval)?;
        Ok(eval.heap().alloc(AllocList(values.into_iter().rev())))
    }

    fn zip<'v>(
        #[starlark(args)] lists: UnpackTuple<Value<'v>>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        let lists =
            lists.items.into_iter().map(|list| iterate(list, eval)).collect::<starlark::Result<Vec<_>>>()?;
        let count = lists.iter().map(Vec::len).min().unwrap_or(0);
        Meter::charge(eval, (3 + lists.len()).saturating_mul(count))?;
        let heap = eval.heap();
        let rows =
            (0..count).map(|k| heap.alloc(AllocTuple(lists.iter().map(|list| list[k]).collect::<Vec<_>>())));
        Ok(heap.alloc(AllocList(rows.collect::<Vec<_>>())))
    }

    fn sum<'v>(
        #[starlark(require = pos)] values: Value<'v>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        let mut sum = eval.heap().alloc(0);
        for value in iterate(values, eval)? {
            if value.downcast_ref::<StarlarkShape>().is_some()
                || sum.downcast_ref::<StarlarkShape>().is_some()
            {
                let Some(result) = operate("+", &arg_of(sum), &arg_of(value)) else {
                    return Err(fault(CallError(
                        "sum() adds numbers and formulas; union() combines shapes".to_owned(),
                    )));
                };
                sum = to_starlark(result.map_err(fault)?, eval)?;
            } else if number(value).is_some() {
                sum = of_numbers("+", sum, value, eval.heap())?;
            } else {
                return Err(fault(CallError(format!("sum() cannot add {}", arg_of(value).kind()))));
            }
        }
        Ok(sum)
    }

    fn max<'v>(
        #[starlark(args)] values: UnpackTuple<Value<'v>>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        extremum(values, Ordering::Greater, eval)
    }

    fn min<'v>(
        #[starlark(args)] values: UnpackTuple<Value<'v>>,
        eval: &mut Evaluator<'v, '_, '_>,
    ) -> starlark::Result<Value<'v>> {
        extremum(values, Ordering::Less, eval)
    }
}
