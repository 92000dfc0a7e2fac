//! `ScriptSource`: the text of a script, the rewritten text that is parsed, and the map back to the script.
use crate::advice::with_missing_return;
use crate::error::position;
use crate::operators::OPERATORS;
use crate::other_tools::equivalent_of;
use crate::parentheses::Parentheses;
use crate::{ScriptError, nesting};
use starlark::codemap::Span;
use starlark::syntax::ast::AstAssignTarget;
use std::ops::Range;

/// A script's text and the rewritten text that is parsed instead: `a += b` becomes `a = a + (b)`, so that
/// every operator can be called through a metered function.
#[derive(Debug)]
pub(crate) struct ScriptSource {
    pub(crate) text: String,
    parentheses: Parentheses,
    /// The text that is parsed.
    pub(crate) rewritten: String,
    /// The differences between both texts, in order.
    edits: Vec<TextEdit>,
}

/// The range of an expression that is wrapped in a call, and the name of the function.
pub(crate) type MeteredPart = (Range<usize>, &'static str);

/// The range of a replaced part in the script, and of its replacement in the rewritten text.
#[derive(Debug)]
struct TextEdit {
    old: Range<usize>,
    new: Range<usize>,
}

/// A replacement of a range of bytes.
#[derive(Debug)]
pub(crate) struct TextChange {
    old: Range<usize>,
    new: String,
    /// The order among changes at the same position.
    rank: i64,
}

fn range(span: Span) -> Range<usize> {
    span.begin().get() as usize..span.end().get() as usize
}

impl ScriptSource {
    pub(crate) fn new(text: &str) -> Self {
        Self {
            text: text.to_owned(),
            parentheses: Parentheses::new(text),
            rewritten: text.to_owned(),
            edits: Vec::new(),
        }
    }

    /// Whether the parsed text differs from the script.
    pub(crate) fn is_changed(&self) -> bool {
        !self.edits.is_empty()
    }

    /// The range of an expression, with the parentheses of operands at its ends, but without those around all
    /// of it.
    pub(crate) fn extent(&self, span: Span) -> Range<usize> {
        self.parentheses.balanced(range(span))
    }

    /// Applies the changes.
    pub(crate) fn with_changes(self, changes: Vec<TextChange>) -> Self {
        let (rewritten, edits) = self.changed(&(0..self.text.len()), changes);
        Self { rewritten, edits, ..self }
    }

    /// Applies changes to a part of the text. Returns the new text and its edits.
    fn changed(&self, part: &Range<usize>, mut changes: Vec<TextChange>) -> (String, Vec<TextEdit>) {
        // At one position, closing brackets come before opening ones, the inner call closes first, and the
        // outer one opens first: `wrap` chooses the ranks so.
        changes.sort_by_key(|change| (change.old.start, change.rank));
        let (mut rewritten, mut edits, mut copied_to) = (String::new(), Vec::new(), part.start);
        for TextChange { old, new, .. } in changes {
            rewritten.push_str(&self.text[copied_to..old.start]);
            let start = rewritten.len();
            rewritten.push_str(&new);
            copied_to = old.end;
            edits.push(TextEdit { old, new: start..rewritten.len() });
        }
        rewritten.push_str(&self.text[copied_to..part.end]);
        (rewritten, edits)
    }

    /// Rewrites `a += b`.
    pub(crate) fn assignment(
        &self,
        target: &AstAssignTarget,
        operator: &str,
        statement: Span,
        calls: &[MeteredPart],
    ) -> Option<[TextChange; 2]> {
        let target = self.extent(target.span);
        // Calls in the target are metered as well: it is written twice in the new text, and the
        // copy has to be wrapped by itself.
        let first = calls.partition_point(|(part, _)| part.start < target.start);
        let inside = calls[first..].iter().take_while(|(part, _)| part.start <= target.end);
        let inside = inside.filter(|(part, _)| part.end <= target.end);
        let changes = inside.flat_map(|(part, function)| Self::wrap(part, function, "")).collect();
        let target_text = self.changed(&target, changes).0;
        let assignment = format!("{operator}=");
        let (mut start, end) = (target.end, range(statement).end);
        // Only spaces, comments, and line ends inside brackets can stand before the operator. A comment is
        // one token, so an operator in it is not found.
        while start < end && !self.text.get(start..end)?.starts_with(&assignment) {
            start = nesting::token_end(self.text.as_bytes(), start);
        }
        if start >= end {
            return None;
        }
        // The brackets keep line ends and comments of the target within the statement.
        let new = format!("= ({target_text}) {operator} (");
        Some([
            TextChange { old: start..start + assignment.len(), new, rank: 0 },
            TextChange { old: end..end, new: ")".to_owned(), rank: i64::MAX },
        ])
    }

    /// Wraps a range in a call, with more arguments after it.
    pub(crate) fn wrap(part: &Range<usize>, function: &str, more_args: &str) -> [TextChange; 2] {
        [
            //     f(a)(b)                       the callees are `f(a)` and, within it, `f`
            //     called__(called__(f)(a))(b)   both calls open at the same offset
            //
            // The outer of two calls has the larger end and thus opens first; the inner has the larger start
            // and thus closes first. All closing ranks are below all opening ones.
            TextChange {
                old: part.start..part.start,
                new: format!("{function}("),
                rank: i64::MAX / 2 - part.end as i64,
            },
            TextChange {
                old: part.end..part.end,
                new: format!("{more_args})"),
                rank: -(part.start as i64) - 1,
            },
        ]
    }

    /// The extent of the right operand, unless it is parenthesized.
    pub(crate) fn bare_right_operand(&self, [left, right]: [Span; 2]) -> Option<Range<usize>> {
        let (left, right) = (self.extent(left), self.extent(right));
        (!self.parentheses.opens_in(&(left.end..right.start))).then_some(right)
    }

    /// Maps an offset in the parsed text to one in the script.
    pub(crate) fn place(&self, offset: usize) -> usize {
        let before = self.edits.iter().take_while(|edit| edit.new.start <= offset).last();
        match before {
            Some(edit) if offset < edit.new.end => edit.old.start,
            Some(edit) => offset - edit.new.end + edit.old.end,
            None => offset,
        }
    }

    /// Lines and columns of offsets in the script, counted from 1; the offsets are in order.
    pub(crate) fn lines_and_columns(&self, offsets: &[usize]) -> Vec<(u64, u64)> {
        let (mut from, mut place) = (0, (0, 0));
        let mut places = Vec::with_capacity(offsets.len());
        for offset in offsets {
            let (lines, column) = position(&self.text[from..], offset - from);
            place = (place.0 + lines, if lines == 0 { place.1 + column } else { column });
            from = *offset;
            places.push((place.0 as u64 + 1, place.1 as u64 + 1));
        }
        places
    }

    pub(crate) fn error(&self, code: &'static str, message: impl Into<String>, span: Span) -> ScriptError {
        ScriptError::new(code, message).at(&self.text, self.place(span.begin().get() as usize))
    }

    /// An error of the interpreter with its position.
    pub(crate) fn translate_error(&self, code: &'static str, error: &starlark::Error) -> ScriptError {
        let message = error.without_diagnostic().to_string();
        let message: String = message.trim().replace('\n', " ").chars().take(LONGEST_MESSAGE).collect();
        let message = with_missing_return(with_equivalent(with_sensible_suggestion(message)), &self.text);
        match error.span() {
            Some(span) => self.error(code, message, span.span),
            None => ScriptError::new(code, message),
        }
    }
}

/// Names the equivalent of another tool's function in the message of an unknown name. The interpreter itself
/// only suggests names that are spelled alike.
fn with_equivalent(message: String) -> String {
    let name = message.strip_prefix("Variable `").and_then(|rest| rest.split('`').next());
    match name.and_then(|name| Some((name, equivalent_of(name)?))) {
        Some((name, equivalent)) if message.contains("not found") => {
            format!("Variable `{name}` not found: use {equivalent}")
        }
        _ => message,
    }
}

/// Drops the interpreter's "did you mean" where it is no help. It suggests whatever is one letter away: for a
/// name of one letter that is any other, so only the same letter in the other case is kept; and for any name
/// an operator, which is a function of the rewritten program by its own sign.
fn with_sensible_suggestion(message: String) -> String {
    let is_of_a_name = ["Variable `", "Module has no symbol `", "Object of type `"];
    let Some((unknown, rest)) = message.split_once(", did you mean `") else { return message };
    if !is_of_a_name.iter().any(|start| unknown.starts_with(start)) {
        return message;
    }
    let name = unknown.rsplit('`').nth(1).unwrap_or_default();
    let suggested = rest.strip_suffix("`?").unwrap_or(rest);
    let is_word =
        suggested.chars().all(|c| c.is_alphanumeric() || c == '_') && !OPERATORS.contains(&suggested);
    let is_near = name.chars().nth(1).is_some() || name.eq_ignore_ascii_case(suggested);
    if is_word && is_near { message } else { unknown.to_owned() }
}

/// The most characters of a message. Chosen: some lines of a terminal.
const LONGEST_MESSAGE: usize = 500;
