//! Op lists: a field as a list of operations, one on each line, in the text format of fidget's virtual
//! machine.
use crate::text::{TextLines, grouped, number, number_error, show, text_of};
use crate::warnings::Warnings;
use crate::{Content, FileLocation, Frame, Limits, ReadError, ReadOutcome};
use chordal::implicit::evaluation::{Binary, Unary};
use chordal::implicit::{Expr, Field};
use chordal::math::Box3;
use std::collections::HashMap;

/// The box in which shapes of op lists are viewed.
pub const REGION: Box3 = Box3 { min: [-1.0; 3], max: [1.0; 3] };

/// Reads the field of an op list. A line is `name op argument…`. The value is the last line's, negative
/// inside. Text from `#` on is a comment.
///
/// `const` takes a number, `var-x`, `var-y` and `var-z` take nothing, the other operations one or two names
/// of earlier lines. The format does not define how the value relates to the distance, so only its sign is
/// used. It does not define a size either; as is customary with fidget, the shape is viewed in [`REGION`].
///
/// # Errors
/// [`ReadError`] at line and column, for an unknown operation, a name that is unknown or defined twice, too
/// many or too few arguments, or a number that is invalid or not finite; also for a text without operations.
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
/// Source: M. Keeter, "Massively Parallel Rendering of Complex Closed-Form Implicit Surfaces", 2020, and the
/// models of his fidget.
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let text = text_of(bytes)?;
    let axes = Expr::axes();
    // Only for lookups: no result depends on its order.
    let mut steps: HashMap<&[u8], VmBinding> = HashMap::new();
    let mut last = None;
    for (line, text) in TextLines::new(text) {
        let mut words = VmLine::new(line, text);
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
        let step = VmBinding { expr: expr.clone(), line, used: false };
        steps.try_reserve(1).map_err(|_| ReadError::new("memory", at.clone(), "no memory for more steps"))?;
        if let Some(before) = steps.insert(name, step) {
            let message = format!("{} is the name of line {} already", show(name), before.line);
            return Err(ReadError::new("name-twice", at, message));
        }
        last = Some((expr, name));
    }
    let Some((value, name)) = last else {
        return Err(ReadError::new(
            "empty",
            FileLocation::File,
            "there is no step: no line is 'name op argument…'",
        ));
    };
    let mut warnings = Warnings::default();
    // The least line, since the table has no order.
    let unused =
        || steps.iter().filter(|(other, step)| !step.used && **other != name).map(|(_, step)| step.line);
    let first = unused().min().unwrap_or(0);
    warnings.count_many("unused-steps", unused().count() as u64, || {
        (FileLocation::Line(first), "steps that nothing uses".to_owned())
    });
    let content = Content::Field { field: Field::new(value), region: Some(REGION), frame: Frame::default() };
    Ok(ReadOutcome { content, warnings: warnings.into_list() })
}

/// The expression that a name stands for.
struct VmBinding {
    expr: Expr,
    line: u64,
    used: bool,
}

/// Parses the expression that follows a name.
fn step(
    words: &mut VmLine,
    axes: &[Expr; 3],
    // Only for lookups: no result depends on its order.
    steps: &mut HashMap<&[u8], VmBinding>,
) -> Result<Expr, ReadError> {
    let (op, at) = words.expect(|| "an operation after the name".to_owned())?;
    let name = std::str::from_utf8(op).unwrap_or("");
    if name == "const" {
        let (token, at) = words.expect(|| "a number after 'const'".to_owned())?;
        let value =
            number(token).ok_or_else(|| ReadError::new("not-a-number", at.clone(), number_error(token)))?;
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

/// The words of one line with their locations, up to a comment.
struct VmLine<'a> {
    line: u64,
    text: &'a [u8],
    at: usize,
}

impl<'a> VmLine<'a> {
    fn new(line: u64, text: &'a [u8]) -> Self {
        Self { line, text, at: 0 }
    }

    fn next(&mut self) -> Option<(&'a [u8], FileLocation)> {
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

    /// The location of a byte of the line. Continuation bytes of UTF-8 do not count as columns.
    fn place(&self, offset: usize) -> FileLocation {
        let before = self.text[..offset].iter().filter(|b| **b & 0xc0 != 0x80).count();
        FileLocation::LineColumn { line: self.line, column: 1 + before as u64 }
    }

    fn expect(&mut self, what: impl FnOnce() -> String) -> Result<(&'a [u8], FileLocation), ReadError> {
        self.next().ok_or_else(|| {
            ReadError::new("argument-count", self.place(self.at), format!("the line ends before {}", what()))
        })
    }
}

/// Whether the first line that is not blank or a comment is an operation without operands.
pub(crate) fn looks_like(text: &[u8]) -> bool {
    let first = TextLines::new(text).find_map(|(line, text)| {
        let mut words = VmLine::new(line, text);
        words.next().map(|_| words)
    });
    let Some(mut words) = first else { return false };
    match (words.next().map(|w| w.0), words.next().map(|w| w.0)) {
        (Some(b"const"), Some(number)) => crate::text::number(number).is_some() && words.next().is_none(),
        (Some(b"var-x" | b"var-y" | b"var-z"), None) => true,
        _ => false,
    }
}
