//! Op lists: a field as the steps that compute it, one a line, in the text of fidget's virtual machine.
use crate::text::{Lines, grouped, number, show, text_of, why_no_number};
use crate::warnings::Warnings;
use crate::{Content, Frame, Limits, Loaded, Place, ReadError};
use chordal::implicit::{Binary, Expr, Field, Unary};
use chordal::math::Box3;
use std::collections::HashMap;

/// The part of space that op lists are drawn for.
pub const REGION: Box3 = Box3 { min: [-1.0; 3], max: [1.0; 3] };

/// The field of an op list. A line is `name op argument…`; the last line is the value, negative inside. What starts with
/// `#` is a comment.
///
/// `const` takes a number, `var-x`, `var-y` and `var-z` nothing, the other operations one or two names of earlier lines.
/// Nothing is said of what the value is worth as a distance, so it counts as a sign. The format says no size; by fidget's
/// custom the shape is looked at in [`REGION`].
///
/// # Errors
/// [`ReadError`] at line and column: an operation that there is none of, a name that is unknown or given twice, too many
/// arguments or too few, a number that is none or not finite; and for a text without any step.
///
/// ```
/// use chordal_io::{Content, Limits, vm};
/// let disc = b"# a disc\nx var-x\ny var-y\nxx square x\nyy square y\nr add xx yy\none const 0.25\nd sub r one\n";
/// let Content::Field { field, .. } = vm::read(disc, &Limits::default())?.content else { unreachable!() };
/// let mut value = [0.0];
/// field.tape().at(&[[0.0; 3]], &mut value).unwrap();
/// assert_eq!((value, field.tape().axes()), ([-0.25], [true, true, false]));
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
///
/// Source: M. Keeter, "Massively Parallel Rendering of Complex Closed-Form Implicit Surfaces", 2020, and the models of
/// his fidget.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<Loaded, ReadError> {
    let text = text_of(bytes)?;
    let axes = Expr::axes();
    // Only looked up: no order depends on it.
    let mut steps: HashMap<&[u8], Step> = HashMap::new();
    let mut last = None;
    for (line, text) in Lines::new(text) {
        let mut words = Line::new(line, text);
        let Some((name, at)) = words.next() else { continue };
        if steps.len() as u64 >= limits.rows {
            let message = format!("more steps than the limit of {}", grouped(limits.rows));
            return Err(ReadError::new("too-large", at, message));
        }
        let expr = step(&mut words, &axes, &mut steps)?;
        if let Some((word, at)) = words.next() {
            let message = format!("{} is one argument too many", show(word));
            return Err(ReadError::new("argument-count", at, message));
        }
        let step = Step { expr: expr.clone(), line, used: false };
        steps.try_reserve(1).map_err(|_| ReadError::new("memory", at.clone(), "no memory for more steps"))?;
        if let Some(before) = steps.insert(name, step) {
            let message = format!("{} is the name of line {} already", show(name), before.line);
            return Err(ReadError::new("name-twice", at, message));
        }
        last = Some((expr, name));
    }
    let Some((value, name)) = last else {
        return Err(ReadError::new("empty", Place::File, "there is no step: no line is 'name op argument…'"));
    };
    let mut warnings = Warnings::default();
    let unused =
        || steps.iter().filter(|(other, step)| !step.used && **other != name).map(|(_, step)| step.line);
    let first = unused().min().unwrap_or(0);
    warnings.count_many("unused-steps", unused().count() as u64, || {
        (Place::Line(first), "steps that nothing uses".to_owned())
    });
    let content = Content::Field { field: Field::new(value), region: Some(REGION), frame: Frame::default() };
    Ok(Loaded { content, warnings: warnings.into_list() })
}

/// What a name stands for.
struct Step {
    expr: Expr,
    line: u64,
    used: bool,
}

/// The expression that follows a name.
// Names are only looked up: no order depends on the map.
fn step(words: &mut Line, axes: &[Expr; 3], steps: &mut HashMap<&[u8], Step>) -> Result<Expr, ReadError> {
    let (op, at) = words.expect(|| "an operation after the name".to_owned())?;
    let name = std::str::from_utf8(op).unwrap_or("");
    if name == "const" {
        let (token, at) = words.expect(|| "a number after 'const'".to_owned())?;
        let value =
            number(token).ok_or_else(|| ReadError::new("not-a-number", at.clone(), why_no_number(token)))?;
        if !value.is_finite() {
            let message = format!("number {} is not finite, or over the limit of 1.8e308", show(token));
            return Err(ReadError::new("not-finite", at, message));
        }
        return Ok(Expr::constant(value));
    }
    if let Some(k) = ["var-x", "var-y", "var-z"].iter().position(|axis| *axis == name) {
        return Ok(axes[k].clone());
    }
    let mut argument = || {
        let (token, at) = words.expect(|| format!("the arguments of '{name}'"))?;
        let Some(step) = steps.get_mut(token) else {
            let message = format!("{} is no name of an earlier line", show(token));
            return Err(ReadError::new("unknown-name", at, message));
        };
        step.used = true;
        Ok(step.expr.clone())
    };
    if let Some((op, _)) = Unary::ALL.iter().find(|row| row.1 == name) {
        return Ok(Expr::unary(*op, &argument()?));
    }
    if let Some((op, _)) = Binary::ALL.iter().find(|row| row.1 == name) {
        let a = argument()?;
        return Ok(Expr::binary(*op, &a, &argument()?));
    }
    Err(ReadError::new("unknown-operation", at, format!("{} is no operation", show(op))))
}

/// The words of one line with their places, up to a comment.
struct Line<'a> {
    line: u64,
    text: &'a [u8],
    at: usize,
}

impl<'a> Line<'a> {
    fn new(line: u64, text: &'a [u8]) -> Self {
        Self { line, text, at: 0 }
    }

    fn next(&mut self) -> Option<(&'a [u8], Place)> {
        let rest = &self.text[self.at..];
        let start = self.at + rest.iter().position(|b| !crate::text::is_space(*b))?;
        let rest = &self.text[start..];
        if rest[0] == b'#' {
            return None;
        }
        let end = rest.iter().position(|b| crate::text::is_space(*b)).unwrap_or(rest.len());
        self.at = start + end;
        Some((&rest[..end], self.place(start)))
    }

    /// The place of a byte of the line. Bytes that continue a character are no column of their own.
    fn place(&self, offset: usize) -> Place {
        let before = self.text[..offset].iter().filter(|b| **b & 0xc0 != 0x80).count();
        Place::LineColumn { line: self.line, column: 1 + before as u64 }
    }

    fn expect(&mut self, what: impl FnOnce() -> String) -> Result<(&'a [u8], Place), ReadError> {
        self.next().ok_or_else(|| {
            ReadError::new("argument-count", self.place(self.at), format!("the line ends before {}", what()))
        })
    }
}

/// Whether the first line that says anything is a step that needs no other.
pub(crate) fn looks_like(text: &[u8]) -> bool {
    let first = Lines::new(text).find_map(|(line, text)| {
        let mut words = Line::new(line, text);
        words.next().map(|_| words)
    });
    let Some(mut words) = first else { return false };
    match (words.next().map(|w| w.0), words.next().map(|w| w.0)) {
        (Some(b"const"), Some(number)) => crate::text::number(number).is_some() && words.next().is_none(),
        (Some(b"var-x" | b"var-y" | b"var-z"), None) => true,
        _ => false,
    }
}
