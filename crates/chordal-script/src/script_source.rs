//! `ScriptSource`: the text of a script, what is parsed in its place, and the way back from there.
use crate::advice::with_missing_return;
use crate::error::position;
use crate::other_tools::here_instead;
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
    pub(crate) written: String,
    edits: Vec<TextEdit>,
}

/// The range of an expression that goes through a function, and which.
pub(crate) type MeteredPart = (Range<usize>, &'static str);

/// Bytes that replace others.
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
            written: text.to_owned(),
            edits: Vec::new(),
        }
    }

    /// Whether another text is parsed in its place.
    pub(crate) fn is_changed(&self) -> bool {
        !self.edits.is_empty()
    }

    /// An expression's range, without brackets around it and with those at its ends.
    pub(crate) fn extent(&self, span: Span) -> Range<usize> {
        self.parentheses.whole(range(span))
    }

    /// Applies the changes.
    pub(crate) fn with_changes(self, changes: Vec<TextChange>) -> Self {
        let (written, edits) = self.changed(&(0..self.text.len()), changes);
        Self { written, edits, ..self }
    }

    /// A part of the text with changes, and where they stand in it.
    fn changed(&self, part: &Range<usize>, mut changes: Vec<TextChange>) -> (String, Vec<TextEdit>) {
        // Of two that end at one position the inner one, which starts later, comes first.
        changes.sort_by_key(|change| (change.old.start, change.rank));
        let (mut written, mut edits, mut done) = (String::new(), Vec::new(), part.start);
        for TextChange { old, new, .. } in changes {
            written.push_str(&self.text[done..old.start]);
            let start = written.len();
            written.push_str(&new);
            done = old.end;
            edits.push(TextEdit { old, new: start..written.len() });
        }
        written.push_str(&self.text[done..part.end]);
        (written, edits)
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
        let first = calls.partition_point(|(part, _)| part.start < target.start);
        let inside = calls[first..].iter().take_while(|(part, _)| part.start <= target.end);
        let inside = inside.filter(|(part, _)| part.end <= target.end);
        let changes = inside.flat_map(|(part, through)| Self::wrap(part, through, "")).collect();
        let again = self.changed(&target, changes).0;
        let written = format!("{operator}=");
        let (mut start, end) = (target.end, range(statement).end);
        // Only spaces and line ends in brackets stand before the operator; comments are stepped over.
        while start < end && !self.text.get(start..end)?.starts_with(&written) {
            start = nesting::token_end(self.text.as_bytes(), start);
        }
        if start >= end {
            return None;
        }
        // In brackets, so that line ends and comments of the target stay within the statement.
        let new = format!("= ({again}) {operator} (");
        Some([
            TextChange { old: start..start + written.len(), new, rank: 0 },
            TextChange { old: end..end, new: ")".to_owned(), rank: i64::MAX },
        ])
    }

    /// Puts a range into a call, with more arguments after it.
    pub(crate) fn wrap(part: &Range<usize>, through: &str, more: &str) -> [TextChange; 2] {
        [
            // The outer one opens first and closes last.
            TextChange {
                old: part.start..part.start,
                new: format!("{through}("),
                rank: i64::MAX / 2 - part.end as i64,
            },
            TextChange { old: part.end..part.end, new: format!("{more})"), rank: -(part.start as i64) - 1 },
        ]
    }

    /// The extent of the right one of two operands, unless it stands in parentheses of its own.
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
        let (mut from, mut at) = (0, (0, 0));
        let mut found = Vec::with_capacity(offsets.len());
        for offset in offsets {
            let (lines, column) = position(&self.text[from..], offset - from);
            at = (at.0 + lines, if lines == 0 { at.1 + column } else { column });
            from = *offset;
            found.push((at.0 as u64 + 1, at.1 as u64 + 1));
        }
        found
    }

    pub(crate) fn error(&self, code: &'static str, what: impl Into<String>, span: Span) -> ScriptError {
        ScriptError::new(code, what).at(&self.text, self.place(span.begin().get() as usize))
    }

    /// An error of the interpreter with its position.
    pub(crate) fn translate_error(&self, code: &'static str, error: &starlark::Error) -> ScriptError {
        let message = error.without_diagnostic().to_string();
        let message: String = message.trim().replace('\n', " ").chars().take(LONGEST_MESSAGE).collect();
        let message = with_missing_return(with_name_of_here(message), &self.text);
        match error.span() {
            Some(span) => self.error(code, message, span.span),
            None => ScriptError::new(code, message),
        }
    }
}

/// The message of a name that is not known, with what does the same here where other tools have the name: the
/// interpreter offers what is spelled alike.
fn with_name_of_here(message: String) -> String {
    let name = message.strip_prefix("Variable `").and_then(|rest| rest.split('`').next());
    match name.and_then(|name| Some((name, here_instead(name)?))) {
        Some((name, here)) if message.contains("not found") => {
            format!("Variable `{name}` not found: here it is {here}")
        }
        _ => message,
    }
}

/// The most characters of a message.
const LONGEST_MESSAGE: usize = 500;
